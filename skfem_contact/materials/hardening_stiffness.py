"""Constants of the Hardening Soil, its stiffness by stress, elastic increments, and the modes of
return that follow.

Stresses are positive in compression here and measured from the apex of the failure cone, c1 >= c2
>= c3. The elastic stiffness of an increment is the reference stiffness times a scale, the mean of
its values at both ends: reversed increments undo each other, and isotropic ones are exact for m =
0, 1/2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .base import Array
from .plastic import ROUND_OFF
from .spectral import Frame, principal

#: Share of the reference stress below which the stiffness does not fall any more.
LEAST = 1e-3
# Iterations of an elastic increment, 2 to 6 are needed; growth of the stiffness beyond which it has
# no solution.
_ITERATIONS, _LARGEST = 60, 1e3
# Slope from which Newton's method is taken for it, and relative change that is its last one, by
# quadratic convergence.
_GOOD, _LAST_STEP = 0.3, 1e-8


class Constants(NamedTuple):
    """Constants of the law: ``initial`` and ``unloading`` are moduli, ``failure`` is q_f / c3."""

    shift: float
    reference: float
    m: float
    initial: float
    unloading: float
    nu: float
    failure: float
    asymptote: float
    sin_cv: float
    sin_psi: float
    cap_slope: float  # squared
    cap_modulus: float
    lode: float

    @property
    def lam(self) -> float:
        """Lamé's first constant of unloading at the reference stress."""
        return self.unloading * self.nu / ((1 + self.nu) * (1 - 2 * self.nu))

    @property
    def mu(self) -> float:
        """Shear modulus of unloading at the reference stress."""
        return self.unloading / (2 * (1 + self.nu))

    def scale(self, least: Array) -> Array:
        """Return the ratio of a stiffness to its reference value at the least compression."""
        ratio = np.maximum(least, LEAST * self.reference) / self.reference
        return np.sqrt(ratio) if self.m == 0.5 else ratio**self.m

    def scale_slope(self, least: Array, scale: Array) -> Array:
        """Return the derivative of a scale by the least compression."""
        floor = LEAST * self.reference
        return np.where(least > floor, self.m * scale / np.maximum(least, floor), 0.0)

    def shear_strength(
        self, least: Array, gamma: Array, scale: Array
    ) -> tuple[Array, Array, Array]:
        """Return the smaller of hyperbola and failure, and its derivatives to the least compression
        and to gamma.
        """
        at = np.maximum(least, LEAST * self.reference)
        a, b, qa = 2 / (self.initial * scale), 2 / (self.unloading * scale), self.asymptote * at
        linear = a - b + gamma / qa
        q = 2 * gamma / (linear + np.sqrt(linear * linear + 4 * b * gamma / qa))
        left = 1 / (1 - np.minimum(q, self.failure * at) / qa)
        soft = 1 / (a * left * left - b)
        to_least = np.where(
            least > at * (1 - 1e-12), soft * (self.m * gamma + a * (q * left) ** 2 / qa) / at, 0.0
        )
        failed = q >= self.failure * least
        return (
            np.where(failed, self.failure * least, q),
            np.where(failed, self.failure, to_least),
            np.where(failed, 0.0, soft),
        )

    def hardened(self, cap: Array, volume: Array) -> tuple[Array, Array]:
        """Return the preconsolidation after a plastic compression, and its derivative."""
        rate = self.cap_modulus / self.reference**self.m
        if self.m == 1:
            new = cap * np.exp(rate * volume)
        else:
            new = cap * (1 + (1 - self.m) * rate * volume * cap**self.m / cap) ** (1 / (1 - self.m))
        return new, rate * new**self.m

    def cap_stress(self, c: Array) -> Array:
        """Return the preconsolidation whose cap goes through principal stresses (3, n)."""
        q = c[0] + (self.lode - 1) * c[1] - self.lode * c[2]
        return np.sqrt(q * q / self.cap_slope + c.mean(axis=0) ** 2)


class Points(NamedTuple):
    """Accepted stresses (ncomp, n), their elastic change at the scale 1, memory, and the accepted
    scale (n,).

    At small strains the scale of the increment is stiffened by a factor, and plastic strains harden
    faster.
    """

    stress: Array
    push: Array
    gamma: Array
    cap: Array
    scale: Array
    factor: Array
    faster: Array

    def take(self, at: NDArray[np.intp]) -> Points:
        """Return some of the points."""
        return Points(*(values[..., at] for values in self))

    def trial(self, scale: Array) -> Frame:
        """Return the principal axes and stresses of the elastic stress."""
        return principal(self.stress + scale * self.push)


def elastic_scale(t: Points, k: Constants) -> Array:
    """Return the scales of elastic increments.

    The scale at the end is a concave function of that of the increment: repeated insertion
    converges, and so does Newton's method from where its slope is good. Near the least stiffness
    steps that overshoot are bisected. Beyond the limit, without a solution, a point lies outside
    the cap.
    """
    result = t.factor * t.scale
    if k.m == 0.0:
        return result
    open_, here = np.arange(result.size), result.copy()
    low, high = 0.5 * here, _LARGEST * here
    for _ in range(_ITERATIONS):
        frame = t.trial(here)
        least, change = k.shift - frame.values[0], -frame.along(t.push)[0]
        reached = k.scale(least)
        excess = here - 0.5 * t.factor * (t.scale + reached)
        slope = 1 - 0.5 * t.factor * k.scale_slope(least, reached) * change
        low, high = np.where(excess <= 0, here, low), np.where(excess >= 0, here, high)
        new = here - excess / np.where(slope > _GOOD, slope, 1.0)
        new = np.where((new > low) & (new < high), new, 0.5 * (low + high))
        result[open_] = new
        left = np.flatnonzero(
            np.abs(new - here) > np.where(slope > _GOOD, _LAST_STEP, ROUND_OFF) * new
        )
        if not left.size:
            break
        open_, t, here, low, high = open_[left], t.take(left), new[left], low[left], high[left]
    return result


def likely_modes(t: Points, k: Constants) -> tuple[NDArray[np.intp], Array, Array]:
    """Return the modes in which points return by one step of shear and then of the cap, and both
    multipliers.

    0 is the face, 1 the edge c2 = c3 and 2 the edge c1 = c2: there the step exceeds the distance of
    the trial stresses. The step has no dilatancy and the scale of the accepted stresses, by which
    the multipliers are multiplied.
    """
    scale = t.factor * t.scale
    c = k.shift - t.trial(scale).values[::-1]
    strength, to_least, to_gamma = k.shear_strength(c[2], t.gamma, k.scale(c[2]))
    shear = np.maximum(c[0] - c[2] - strength, 0.0) / (
        2 + to_least + to_gamma * t.faster / (k.mu * scale)
    )
    w, p = np.array([1, k.lode - 1, -k.lode]), np.maximum(c.mean(axis=0), 0.0)
    q, N, K = w @ c - (1 + k.lode) * shear, 4 * k.mu / k.cap_slope, k.lam + 2 * k.mu / 3
    squares = q * q / k.cap_slope
    radius = np.maximum(squares + p * p, (LEAST * t.cap) ** 2)  # the cap is far where it is less
    softer = (N * (w @ w) * squares + 2 * K * p * p) / radius
    harder = 2 * p * k.hardened(t.cap, 0.0 * p)[1] * t.faster / (scale * t.cap)
    multiplier = np.maximum(np.log(radius / t.cap**2), 0.0) / (
        2 * np.maximum(softer + harder, K * LEAST)
    )
    cap = N * q * multiplier
    mode = np.where(
        c[1] - c[2] <= shear + (2 * k.lode - 1) * cap,
        1,
        np.where(c[0] - c[1] <= shear + (2 - k.lode) * cap, 2, 0),
    )
    return mode, shear / k.mu, multiplier


def beyond_apex(t: Points, scale: Array, k: Constants) -> NDArray[np.bool_]:
    """Return a mask of the points whose shear would vanish in tension: no face or edge has a
    result.
    """
    trial = k.shift - t.trial(scale).values[::-1]
    to_minor = (trial[0] - 0.5 * (trial[1] + trial[2])) / (3 - k.sin_psi)
    to_major = (0.5 * (trial[0] + trial[1]) - trial[2]) / (3 + k.sin_psi)
    multiplier = 2 * np.maximum(to_minor, to_major) / k.mu
    return trial.mean(axis=0) + (k.lam + 2 * k.mu / 3) * k.sin_psi * multiplier <= 0
