"""Constants of the Hardening Soil, its stiffness by stress, elastic increments, modes of return.

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
from .local_newton import bracketed_root
from .plastic import ROUND_OFF
from .spectral import Frame, principal

#: Share of the reference stress below which the stiffness does not fall any more.
LEAST = 1e-3
# Iterations of an elastic increment, 2 to 6 are needed; growth of the stiffness beyond which it has
# no solution.
_ITERATIONS = 60
_LARGEST = 1e3
# Slope from which Newton's method is taken for it, and relative change that is its last one, by
# quadratic convergence.
_GOOD = 0.3
_LAST_STEP = 1e-8
# Steps of shear before the first iteration: 2, 3, 4 and 5 leave 1,109, 540, 761 and 972 evaluations
# of 64 points or fewer in a pit.
_SHEARS = 3


class Constants(NamedTuple):
    """Constants of the law."""

    shift: float  # c cot(phi)
    reference: float  # stress
    m: float
    initial: float  # modulus E_i
    unloading: float  # modulus E_ur
    lam: float  # Lamé's constants of unloading at the reference stress
    mu: float
    failure: float  # q_f / c3
    asymptote: float  # q_a / c3
    sin_cv: float
    sin_psi: float
    cap_slope: float  # M squared
    cap_modulus: float
    lode: float  # weight of c3 in the deviatoric measure of the cap

    def stiffness(self, ncomp: int) -> Array:
        """Return the elastic moduli of unloading at the reference stress, (ncomp, ncomp)."""
        components = np.r_[np.ones(3), np.full(ncomp - 3, 0.5)]
        D = 2 * self.mu * np.diag(components)
        D[:3, :3] += self.lam
        return D

    def scale(self, least: Array) -> Array:
        """Return the ratio of a stiffness to its reference value at the least compression."""
        ratio = np.maximum(least, LEAST * self.reference) / self.reference
        return ratio**self.m  # numpy takes the root where m is 0.5

    def scale_slope(self, least: Array, scale: Array) -> Array:
        """Return the derivative of a scale by the least compression."""
        floor = LEAST * self.reference
        return np.where(least > floor, self.m * scale / np.maximum(least, floor), 0.0)

    def shear_strength(
        self,
        least: Array,
        gamma: Array,
        scale: Array,
    ) -> tuple[Array, Array, Array]:
        """Return the smaller of hyperbola and failure, and its derivatives by c3 and gamma.

        With a = 2 / E_i and b = 2 / E_ur at a scale, the hyperbola q(gamma) fulfils

            gamma = a q / (1 - q / q_a) - b q
        """
        bounded = np.maximum(least, LEAST * self.reference)
        a = 2 / (self.initial * scale)
        b = 2 / (self.unloading * scale)
        qa = self.asymptote * bounded
        linear = a - b + gamma / qa
        q = 2 * gamma / (linear + np.sqrt(linear * linear + 4 * b * gamma / qa))

        # differentiate the hyperbola, not beyond failure
        growth = 1 / (1 - np.minimum(q, self.failure * bounded) / qa)
        to_gamma = 1 / (a * growth * growth - b)
        to_least = to_gamma * (self.m * gamma + a * (q * growth) ** 2 / qa) / bounded
        to_least = np.where(least > bounded * (1 - 1e-12), to_least, 0.0)
        failed = q >= self.failure * least
        return (
            np.where(failed, self.failure * least, q),
            np.where(failed, self.failure, to_least),
            np.where(failed, 0.0, to_gamma),
        )

    def dilatancy(
        self,
        c1: Array,
        c3: Array,
        failed: NDArray[np.bool_],
    ) -> tuple[Array, Array, Array]:
        """Return the sine of the mobilised dilatancy, and its derivatives by c1 and -c3.

        Before failure it is Rowe's, with sin(phi_m) = (c1 - c3) / (c1 + c3),

            sin(psi_m) = (sin(phi_m) - sin(phi_cv)) / (1 - sin(phi_m) sin(phi_cv))
        """
        total = c1 + c3
        pressed = total > 0
        total = np.where(pressed, total, 1.0)
        friction = np.minimum(np.maximum((c1 - c3) / total, -0.5), 1.0)
        friction = np.where(pressed, friction, 1.0)
        rest = 1 - friction * self.sin_cv
        rowe = np.where(failed, self.sin_psi, (friction - self.sin_cv) / rest)

        # differentiate it within its limits
        moving = (rowe > 0) & (rowe < self.sin_psi) & pressed
        slope = np.where(moving, (1 - self.sin_cv**2) / (rest * rest * total), 0.0)
        sine = np.minimum(np.maximum(rowe, 0.0), self.sin_psi)
        return sine, slope * (1 - friction), slope * (1 + friction)

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
    """Accepted states of points, and their strain increments as elastic stresses.

    At small strains the scale of the increment is stiffened by a factor, and plastic strains harden
    faster.
    """

    stress: Array  # (ncomp, n)
    push: Array  # elastic change of the stress at the scale 1, (ncomp, n)
    gamma: Array  # (n,)
    cap: Array
    scale: Array  # of the accepted stress
    factor: Array
    faster: Array

    def trial(self, scale: Array) -> Frame:
        """Return the principal axes and stresses of the elastic stress."""
        return principal(self.stress + scale * self.push)


def elastic_scale(t: Points, k: Constants) -> Array:
    """Return the scales x of elastic increments, x = factor (scale_0 + scale(c3(x))) / 2.

    The scale at the end is a concave function of the increment's scale: repeated insertion
    converges, and so does Newton's method from where its slope is good. Near the least stiffness
    steps that overshoot are bisected. Beyond the limit, without a solution, a point lies outside
    the cap.
    """
    start = t.factor * t.scale

    # x = (factor / 2) (scale + scale at the reached stress), solved for x.
    def missing(x: Array, t: Points) -> tuple[Array, Array, Array]:
        frame = t.trial(x)
        least = k.shift - frame.values[0]
        change = -frame.along(t.push)[0]
        reached = k.scale(least)
        excess = x - 0.5 * t.factor * (t.scale + reached)
        slope = 1 - 0.5 * t.factor * k.scale_slope(least, reached) * change
        good = slope > _GOOD
        return -excess, -np.where(good, slope, 1.0), np.where(good, _LAST_STEP, ROUND_OFF) * x

    # Begin at the scale of the start, which is the root where the stiffness is constant.
    return bracketed_root(missing, start, 0.5 * start, _LARGEST * start, (t,), _ITERATIONS)[0]


def likely_modes(t: Points, k: Constants) -> tuple[NDArray[np.intp], Array]:
    """Return modes by steps of shear and then one of the cap, and the variables after it, (4, n).

    0 is the face, 1 the edge c2 = c3 and 2 the edge c1 = c2: an edge is likely where the step
    exceeds the distance of the trial stresses. The variables are the multipliers of shear and cap,
    which the scale multiplies, the sine of the dilatancy, and the scale after the shear.
    """
    c, start = _sheared(t, k)
    shear, s, scale = start

    # take one step of the cap, F = ln((q^2 / M^2 + p^2) / p_p^2)
    w = np.array([1, k.lode - 1, -k.lode])
    K = k.lam + 2 * k.mu / 3
    p = np.maximum(c.mean(axis=0) + K / k.mu * s * shear, 0.0)
    q = w @ c - (1 + k.lode) * shear
    N = 4 * k.mu / k.cap_slope
    squares = q * q / k.cap_slope
    least = (LEAST * t.cap) ** 2  # the cap is far from smaller stresses
    radius = np.maximum(squares + p * p, least)
    softer = N * (w @ w) * squares + 2 * K * p * p
    softer = softer / radius
    rate = k.hardened(t.cap, 0.0 * p)[1]
    harder = 2 * p * rate * t.faster / (scale * t.cap)
    resistance = np.maximum(softer + harder, K * LEAST)
    excess = np.maximum(np.log(radius / t.cap**2), 0.0)
    multiplier = excess / (2 * resistance)

    # compare the change of the meeting stresses with their distance
    cap = N * q * multiplier
    to_minor = (1 + s) * shear + (2 * k.lode - 1) * cap
    to_major = (1 - s) * shear + (2 - k.lode) * cap
    minor = c[1] - c[2] <= to_minor
    major = c[0] - c[1] <= to_major
    mode = np.where(minor, 1, np.where(major, 2, 0))
    return mode, np.array((shear / k.mu, multiplier, s, scale))


def _sheared(t: Points, k: Constants) -> tuple[Array, Array]:
    """Return trial stresses c1, c2 and c3, and shear, dilatancy and scale, (3, n), by few steps.

    With the shear L, mu times its multiplier, the sine s of the dilatancy and r = lambda / mu

        c1 = c1_trial - L (1 - s - s r),    c3 = c3_trial + L (1 + s + s r)

    where an edge has the average of both meeting stresses, and half of 1 - s or 1 + s. A step of
    Newton's method of the shear keeps dilatancy and scale, which its stresses then give.
    """
    scale = t.factor * t.scale
    s = np.zeros_like(scale)
    shear = np.zeros_like(scale)
    r = k.lam / k.mu
    for _ in range(_SHEARS):
        # average the stresses that meet
        c = k.shift - t.trial(scale).values[::-1]
        on_minor = c[1] - c[2] <= (1 + s) * shear
        on_major = (c[0] - c[1] <= (1 - s) * shear) & ~on_minor
        first = np.where(on_major, 0.5 * (c[0] + c[1]), c[0])
        last = np.where(on_minor, 0.5 * (c[1] + c[2]), c[2])
        of_major = np.where(on_major, 0.5, 1.0)
        of_minor = np.where(on_minor, 0.5, 1.0)

        # take a step of the shear, c1 - c3 - q(c3, gamma) = 0
        fall = of_major * (1 - s) - s * r
        rise = of_minor * (1 + s) + s * r
        c3 = last + rise * shear
        rate = t.faster / (k.mu * scale)
        strength, to_least, to_gamma = k.shear_strength(c3, t.gamma + shear * rate, k.scale(c3))
        excess = first - fall * shear - c3 - strength
        step = excess / (fall + rise * (1 + to_least) + to_gamma * rate)
        shear = np.maximum(shear + step, 0.0)

        # insert its stresses into dilatancy and scale
        c1 = first - fall * shear
        c3 = last + rise * shear
        s = k.dilatancy(c1, c3, to_gamma == 0)[0]
        c3 = last + (of_minor * (1 + s) + s * r) * shear
        scale = 0.5 * t.factor * (t.scale + k.scale(c3))
    return c, np.array((shear, s, scale))


def beyond_apex(t: Points, scale: Array, k: Constants) -> NDArray[np.bool_]:
    """Return a mask of points whose shear would vanish in tension: no face or edge has a result."""
    c = k.shift - t.trial(scale).values[::-1]
    to_minor = (c[0] - 0.5 * (c[1] + c[2])) / (3 - k.sin_psi)
    to_major = (0.5 * (c[0] + c[1]) - c[2]) / (3 + k.sin_psi)
    multiplier = 2 * np.maximum(to_minor, to_major) / k.mu
    bulk = k.lam + 2 * k.mu / 3
    mean = c.mean(axis=0) + bulk * k.sin_psi * multiplier
    return mean <= 0
