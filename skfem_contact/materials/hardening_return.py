"""Return mapping of the Hardening Soil in principal stresses.

Stresses are positive in compression here and measured from the apex of the failure cone, c1 >= c2 >= c3. The variables
of a point are the shear multiplier L, the cap multiplier C and the sine of the mobilised dilatancy. As in
:mod:`.pyramid` an edge is a face whose two meeting principal stresses are averaged. An admissible result fulfils the
yield and flow conditions of all mechanisms, keeps the order of the principal stresses, and on an edge the multipliers
of both meeting faces are not negative.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import IncrementTooLarge
from .base import Array
from .plastic import ROUND_OFF

#: Share of the reference stress below which the stiffness does not fall any more.
LEAST = 1e-3
# Newton's method takes its last step below the first residual, and the second is then reached: it converges
# quadratically. Residuals are relative to the largest trial stress.
_LAST_STEP, _SOLVED = 1e-7, 1e-11
_ITERATIONS, _HALVINGS = 60, 6


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

    def scale(self, least: Array) -> Array:
        """Return the ratio of a stiffness to its reference value at the least compression."""
        ratio = np.maximum(least, LEAST * self.reference) / self.reference
        return np.sqrt(ratio) if self.m == 0.5 else ratio**self.m

    def lame(self, least: Array) -> tuple[Array, Array]:
        """Return Lamé's constants of unloading at the least compression."""
        E = self.unloading * self.scale(least)
        return E * self.nu / ((1 + self.nu) * (1 - 2 * self.nu)), E / (2 * (1 + self.nu))

    def shear_strength(self, least: Array, gamma: Array) -> tuple[Array, Array, Array]:
        """Return the smaller of hyperbola and failure, and its derivatives to the least compression and to gamma."""
        at, scale = np.maximum(least, LEAST * self.reference), self.scale(least)
        a, b, qa = 2 / (self.initial * scale), 2 / (self.unloading * scale), self.asymptote * at
        linear = a - b + gamma / qa
        q = 2 * gamma / (linear + np.sqrt(linear * linear + 4 * b * gamma / qa))
        left = 1 / (1 - np.minimum(q, self.failure * at) / qa)
        soft = 1 / (a * left * left - b)
        to_least = np.where(least > at * (1 - 1e-12), soft * (self.m * gamma + a * (q * left) ** 2 / qa) / at, 0.0)
        failed = q >= self.failure * least
        return (np.where(failed, self.failure * least, q), np.where(failed, self.failure, to_least),
                np.where(failed, 0.0, soft))

    def hardened(self, cap: Array, volume: Array) -> tuple[Array, Array]:
        """Return the preconsolidation after a plastic compression, and its derivative."""
        rate = self.cap_modulus / self.reference**self.m
        if self.m == 1:
            new = cap * np.exp(rate * volume)
        else:
            new = cap * (1 + (1 - self.m) * rate * volume * cap ** (self.m - 1)) ** (1 / (1 - self.m))
        return new, rate * new**self.m

    def cap_stress(self, c: Array) -> Array:
        """Return the preconsolidation whose cap goes through principal stresses (3, n)."""
        q = c[0] + (self.lode - 1) * c[1] - self.lode * c[2]
        return np.sqrt(q * q / self.cap_slope + c.mean(axis=0) ** 2)


class _Points(NamedTuple):
    """Averaged trial stresses (3, n), their q of the cap and p, moduli and accepted memory of points."""

    c: Array
    q: Array
    p: Array
    lam: Array
    mu: Array
    gamma: Array
    cap: Array
    size: Array

    def take(self, at: NDArray[np.intp]) -> _Points:
        """Return some of the points."""
        return _Points(*(values[..., at] for values in self))


class _Mode(NamedTuple):
    """Face or edge: averaging of the principal stresses (3, 3), direction of the cap's deviatoric measure (3,)."""

    averaging: Array
    w: Array

    def points(self, trial: Array, lam: Array, mu: Array, gamma: Array, cap: Array) -> _Points:
        """Return the points of this mode."""
        size = np.abs(trial).max(axis=0)
        return _Points(self.averaging @ trial, self.w @ trial, trial.mean(axis=0), lam, mu, gamma, cap, size)


def modes(lode: float) -> tuple[_Mode, _Mode, _Mode]:
    """Return the face, the edge c2 = c3 and the edge c1 = c2."""
    minor, major = np.eye(3), np.eye(3)
    minor[1:, 1:] = major[:2, :2] = 0.5
    w = np.array([1, lode - 1, -lode])
    return _Mode(np.eye(3), w), _Mode(minor, minor @ w), _Mode(major, major @ w)


class _State(NamedTuple):
    """Principal stresses, invariants of the cap, and their derivatives.

    ``dq`` and ``dp`` are derivatives to the variables and to the q and p of the trial; ``dc`` (n_stresses, 5, n) are
    those of the stresses without the direct share of the averaged trial stresses.
    """

    c: Array
    q: Array
    p: Array
    dq: tuple[Array, ...]
    dp: tuple[Array, ...]
    dc: Array


def _state(z: Array, t: _Points, mode: _Mode, k: Constants, wanted: tuple[int, ...] = (0, 2)) -> _State:
    """Return the wanted principal stresses of the variables z, (3, n), and their derivatives."""
    L, C, s = z
    (first, _, last), w, N, K = mode.averaging, mode.w, 4 * t.mu / k.cap_slope, t.lam + 2 * t.mu / 3
    w_first, w_last, ww = float(w @ first), float(w @ last), float(w @ w)
    alpha, beta = 1 + N * C * ww, 1 + 2 * K * C
    push = t.mu * ((1 - s) * w_first - (1 + s) * w_last)
    q, p = (t.q - L * push) / alpha, (t.p + K * s * L) / beta
    open_ = (p > 0) / beta  # no cap in tension
    p = np.maximum(p, 0.0)
    zero = np.zeros(L.shape)
    dq = -push / alpha, -q * N * ww / alpha, t.mu * L * (w_first + w_last) / alpha, 1 / alpha, zero
    dp = K * s * open_, -2 * K * p / beta, K * L * open_, zero, open_
    c, dc = t.c[list(wanted)], np.empty((len(wanted), 5, L.size))
    for i, n in enumerate(wanted):
        pull = t.mu * (first[n] * (1 - s) - last[n] * (1 + s)) - t.lam * s
        deviator, mean = N * w[n], 2 * K
        crush = deviator * q + mean * p
        c[i] -= L * pull + C * crush
        for j in range(5):
            dc[i, j] = -C * (deviator * dq[j] + mean * dp[j])
        dc[i, 0] -= pull
        dc[i, 1] -= crush
        dc[i, 2] += L * (t.mu * (first[n] + last[n]) + t.lam)
    return _State(c, q, p, dq, dp, dc)


class _Residual(NamedTuple):
    """Residuals of shear, cap and flow (3, n), active mechanisms (2, n), largest relative residual, slopes."""

    values: Array
    on: NDArray[np.bool_]
    error: Array
    slopes: tuple[Array, ...]


def _residual(z: Array, t: _Points, k: Constants, at: _State, with_cap: bool = True) -> _Residual:
    """Return the residuals of a state."""
    L, C, s = z
    c1, c3, q, p, K = at.c[0], at.c[1], at.q, at.p, t.lam + 2 * t.mu / 3
    strength, to_least, to_gamma = k.shear_strength(c3, t.gamma + L)
    radius = np.sqrt(q * q / k.cap_slope + p * p + (1e-12 * t.size) ** 2)
    bound, harder = k.hardened(t.cap, 2 * p * C)
    total = np.where(c1 + c3 > 0, c1 + c3, 1.0)
    mob = np.where(c1 + c3 > 0, np.clip((c1 - c3) / total, -0.5, 1.0), 1.0)
    rowe = np.where(to_gamma == 0, k.sin_psi, (mob - k.sin_cv) / (1 - mob * k.sin_cv))  # all of it at failure
    values = np.stack((c1 - c3 - strength, np.log(radius / bound), s - np.clip(rowe, 0.0, k.sin_psi)))
    on = (values[:2] > 0) | (z[:2] > 0)
    on[1] &= with_cap
    error = np.maximum(np.abs(np.where(on[0], values[0], t.mu * L)) / t.size,
                       np.maximum(np.abs(np.where(on[1], values[1], K * C)), np.abs(values[2])))
    moving = (rowe > 0) & (rowe < k.sin_psi) & (c1 + c3 > 0)
    slope = np.where(moving, (1 - k.sin_cv**2) / ((1 - mob * k.sin_cv) ** 2 * total), 0.0)
    squares, harder = radius * radius, 2 * harder / bound
    return _Residual(values, on, error, (1 + to_least, to_gamma, q / (k.cap_slope * squares), p / squares - harder * C,
                                         harder * p, slope * (1 - mob), slope * (1 + mob)))


def _rows(at: _State, of: _Residual) -> list[list[Array]]:
    """Return the rows of d residual / d (variables, trial's c1, c3, q, p); an inactive multiplier is its residual."""
    to_least, to_gamma, to_q, to_p, volume, up, down = of.slopes
    rows = []
    for j in range(5):
        dc1, dc3 = at.dc[0, j], at.dc[1, j]
        rows.append([dc1 - to_least * dc3, to_q * at.dq[j] + to_p * at.dp[j], down * dc3 - up * dc1])
    rows[0][0] = rows[0][0] - to_gamma
    rows[1][1] = rows[1][1] - volume
    rows[2][2] = rows[2][2] + 1
    zero = np.zeros(to_least.shape)
    columns = [rows[0], rows[1], rows[2], [zero + 1, zero, -up], [-to_least, zero, down], rows[3], rows[4]]
    return [[np.where(of.on[i], column[i], float(i == j)) if i < 2 else column[i] for j, column in enumerate(columns)]
            for i in range(3)]


def _solve(A: list[list[Array]], b: list[list[Array]]) -> list[list[Array]]:
    """Return the solutions of A x = b, three variables, by Cramer's rule; b holds the right-hand sides."""
    (a, d, g), (m, e, h), (n, f, i) = A  # rows
    x, y, z = e * i - h * f, h * n - m * i, m * f - e * n
    det = a * x + d * y + g * z
    det = np.where(det == 0, np.nan, det)
    inverse = [[x, g * f - d * i, d * h - g * e], [y, a * i - g * n, g * m - a * h], [z, d * n - a * f, a * e - d * m]]
    return [[(row[0] * r[0] + row[1] * r[1] + row[2] * r[2]) / det for row in inverse] for r in b]


def _newton(t: _Points, mode: _Mode, k: Constants, with_cap: bool) -> Array:
    """Return the variables, (3, n), after Newton's method; points without a solution are those with a residual.

    A step is halved until the residual falls. Without the cap its multiplier stays zero.
    """
    z, base, step = (np.zeros((3, t.p.size)) for _ in range(3))
    limit, least = np.maximum(t.c[0] - t.c[2], 0.0) / (0.5 * t.mu), np.full(t.p.size, np.inf)
    open_, halved = np.arange(t.p.size), np.zeros(t.p.size, int)
    for _ in range(_ITERATIONS):
        here, at = z[:, open_], t.take(open_)
        state = _state(here, at, mode, k)
        residual = _residual(here, at, k, state, with_cap)
        better = (residual.error < least[open_]) | (halved[open_] >= _HALVINGS)
        rows = _rows(state, residual)
        right = [np.where(residual.on[0], residual.values[0], here[0]),
                 np.where(residual.on[1], residual.values[1], here[1]), residual.values[2]]
        (change,) = _solve([row[:3] for row in rows], [right])
        new, bulk = here - np.stack(change), 2 * at.lam + 4 / 3 * at.mu
        new[0] = np.clip(new[0], 0.0, limit[open_])
        grown = 1 + bulk * here[1]  # the cap is nearly linear in its logarithm
        new[1] = np.maximum(grown * np.exp(np.clip(bulk * (new[1] - here[1]) / grown, -3.0, 3.0)) - 1, 0.0) / bulk
        np.clip(new[2], 0.0, k.sin_psi, out=new[2])
        step[:, open_] = np.where(better, new - here, 0.5 * step[:, open_])
        base[:, open_] = np.where(better, here, base[:, open_])
        halved[open_] = np.where(better, 0, halved[open_] + 1)
        least[open_] = np.where(better, residual.error, least[open_])
        z[:, open_] = base[:, open_] + step[:, open_]
        open_ = open_[~(residual.error < _LAST_STEP)]
        if not open_.size:
            break
    return z


class Returned(NamedTuple):
    """Returned stresses (3, n), memory (n,), and d c / d strain (3, 3, n)."""

    c: Array
    gamma: Array
    cap: Array
    moduli: Callable[[], Array]


class _Part(NamedTuple):
    """Points that returned in one mode."""

    at: NDArray[np.intp]
    mode: _Mode
    points: _Points
    z: Array


def hardening_return(trial: Array, lam: Array, mu: Array, gamma: Array, cap: Array, k: Constants) -> Returned:
    """Return trial stresses (3, n), all of them outside; raise IncrementTooLarge where no result is admissible."""
    c, gamma, cap = trial.copy(), gamma.copy(), cap.copy()
    face, minor, major = modes(k.lode)
    apex = _beyond_apex(trial, lam, mu, k)
    c[:, apex] = 0.0
    open_, parts = np.flatnonzero(~apex), []
    for mode, with_cap in product((face, minor, major), (True, False)):
        points = mode.points(trial[:, open_], lam[open_], mu[open_], gamma[open_], cap[open_])
        z = _newton(points, mode, k, with_cap)
        values, memory, holds = _checked(z, points, mode, trial[:, open_], k)
        kept = np.flatnonzero(holds)
        parts.append(_Part(open_[kept], mode, points.take(kept), z[:, kept]))
        c[:, open_[kept]], (gamma[open_[kept]], cap[open_[kept]]) = values[:, kept], memory[:, kept]
        open_ = open_[~holds]
    if open_.size:
        raise IncrementTooLarge(f"{open_.size} of {trial.shape[1]} yielding points of HardeningSoil have no admissible "
                                f"stress: the first has the trial stresses {-trial[:, open_[0]]}")
    return Returned(c, gamma, cap, lambda: _moduli(parts, trial.shape[1], k))


def _beyond_apex(trial: Array, lam: Array, mu: Array, k: Constants) -> NDArray[np.bool_]:
    """Return a mask of the points whose shear would vanish in tension: no face or edge has a result."""
    to_minor = (trial[0] - 0.5 * (trial[1] + trial[2])) / (3 - k.sin_psi)
    to_major = (0.5 * (trial[0] + trial[1]) - trial[2]) / (3 + k.sin_psi)
    multiplier = 2 * np.maximum(to_minor, to_major) / mu
    return trial.mean(axis=0) + (lam + 2 * mu / 3) * k.sin_psi * multiplier <= 0


def _checked(z: Array, t: _Points, mode: _Mode, trial: Array, k: Constants
             ) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return stresses (3, n) and memory (2, n) of the variables, and where they are admissible."""
    state = _state(z, t, mode, k, (0, 2, 1))
    (L, C, s), (c1, c3, c2) = z, state.c
    round_off = 10 * ROUND_OFF * t.size
    holds = (_residual(z, t, k, state).error <= _SOLVED) & (c1 >= c3)
    faces, caps = t.mu * L, 4 * t.mu / k.cap_slope * state.q * C
    if mode.averaging[1, 1] == 1:
        holds &= (c1 >= c2 - round_off) & (c2 >= c3 - round_off)
        c2 = np.clip(c2, c3, np.maximum(c1, c3))
    elif mode.averaging[0, 0] == 1:  # as far as the meeting stresses were apart, the multipliers of their faces differ
        c2 = c3
        holds &= trial[1] - trial[2] <= (1 + s) * faces + (2 * k.lode - 1) * caps + round_off
    else:
        c2 = c1
        holds &= trial[0] - trial[1] <= (1 - s) * faces + (2 - k.lode) * caps + round_off
    return np.stack((c1, c2, c3)), np.stack((t.gamma + L, k.hardened(t.cap, 2 * state.p * C)[0])), holds


def _moduli(parts: list[_Part], n: int, k: Constants) -> Array:
    """Return d c / d strain, (3, 3, n), zero at the apex."""
    result = np.zeros((3, 3, n))
    for at, mode, t, z in parts:
        state = _state(z, t, mode, k, (0, 2, 1))
        rows = _rows(state, _residual(z, t, k, state))
        changes = _solve([row[:3] for row in rows], [[-row[j] for row in rows] for j in range(3, 7)])
        weights = np.stack((mode.averaging[0], mode.averaging[2], mode.w, np.full(3, 1 / 3)))
        for i, dc in zip((0, 2, 1), state.dc):
            gradient = mode.averaging[i][:, None] * np.ones(at.size)
            for j, (change, weight) in enumerate(zip(changes, weights)):
                slope = dc[0] * change[0] + dc[1] * change[1] + dc[2] * change[2]
                gradient += weight[:, None] * (slope if j < 2 else slope + dc[j + 1])
            result[i][:, at] = 2 * t.mu * gradient + t.lam * gradient.sum(axis=0)
    return result
