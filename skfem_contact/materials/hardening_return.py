"""Return mapping of the Hardening Soil in principal stresses.

Stresses, and the scale of the stiffness, are those of :mod:`.hardening_stiffness`. The variables of a point are the
shear multiplier L and the cap multiplier C, both times the scale, the sine of the mobilised dilatancy, and the scale.
As in :mod:`.pyramid` an edge is a face whose two meeting principal stresses are averaged. An admissible result fulfils
the yield and flow conditions of all mechanisms, keeps the order of the principal stresses, and on an edge the
multipliers of both meeting faces are not negative.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .base import Array
from .hardening_stiffness import Constants, Points, beyond_apex, likely_modes
from .plastic import ROUND_OFF

# Newton's method takes its last step below the first residual, and the second is then reached: it converges
# quadratically. Residuals are relative to the largest trial stress.
_LAST_STEP, _SOLVED = 1e-7, 1e-11
_ITERATIONS, _HALVINGS = 12, 6
# Shares in which the solution of an increment is followed, where Newton's method fails in one. What is left is halved:
# 2,000 points near a free surface under strains of 1e-3 take 1.0 s so, 2.4 s with 20 iterations and 12 shares.
_STEPS = 1, 4


class _Trial(NamedTuple):
    """Averaged trial stresses (3, n), their q of the cap and p, and the derivatives of these by the scale."""

    c: Array
    q: Array
    p: Array
    size: Array
    rate: tuple[Array, Array, Array]


class _Mode(NamedTuple):
    """Face or edge: averaging of the principal stresses (3, 3), direction of the cap's deviatoric measure (3,)."""

    averaging: Array
    w: Array

    def trial(self, t: Points, scale: Array, k: Constants) -> _Trial:
        """Return the trial stresses of this mode."""
        frame = t.trial(scale)
        c, change = k.shift - frame.values[::-1], -frame.along(t.push)[::-1]
        size = np.maximum(np.abs(c[0]), np.abs(c[2]))
        return _Trial(self.averaging @ c, self.w @ c, c.mean(axis=0), size,
                      (self.averaging @ change, self.w @ change, change.mean(axis=0)))


def modes(lode: float) -> tuple[_Mode, _Mode, _Mode]:
    """Return the face, the edge c2 = c3 and the edge c1 = c2."""
    minor, major = np.eye(3), np.eye(3)
    minor[1:, 1:] = major[:2, :2] = 0.5
    w = np.array([1, lode - 1, -lode])
    return _Mode(np.eye(3), w), _Mode(minor, minor @ w), _Mode(major, major @ w)


class _Slope(NamedTuple):
    """Derivatives of the principal stresses (n_stresses, n), of q and of p by a variable."""

    c: Array
    q: Array
    p: Array


class _State(NamedTuple):
    """Principal stresses, invariants of the cap, and their derivatives by multipliers and dilatancy, by the trial."""

    c: Array
    q: Array
    p: Array
    slopes: tuple[_Slope, _Slope, _Slope]
    by_trial: Callable[[Array, Array, Array], _Slope]


def _state(z: Array, t: _Trial, mode: _Mode, k: Constants, wanted: tuple[int, ...] = (0, 2)) -> _State:
    """Return the wanted principal stresses of the variables z, (4, n), and their derivatives."""
    L, C, s = z[:3]
    (first, _, last), w, N, K = mode.averaging, mode.w, 4 * k.mu / k.cap_slope, k.lam + 2 * k.mu / 3
    w_first, w_last, ww = float(w @ first), float(w @ last), float(w @ w)
    alpha, beta = 1 + N * C * ww, 1 + 2 * K * C
    push = k.mu * ((1 - s) * w_first - (1 + s) * w_last)
    q, p = (t.q - L * push) / alpha, (t.p + K * s * L) / beta
    open_ = (p > 0) / beta  # no cap in tension
    p = np.maximum(p, 0.0)
    pairs = (-push / alpha, K * s * open_), (q * (-N * ww) / alpha, -2 * K * p / beta), \
        (k.mu * (w_first + w_last) * L / alpha, K * L * open_)
    c, dc = t.c[list(wanted)], np.empty((3, len(wanted), L.size))
    for i, n in enumerate(wanted):
        pull = k.mu * (first[n] * (1 - s) - last[n] * (1 + s)) - k.lam * s
        crush = N * w[n] * q + 2 * K * p
        c[i] -= L * pull + C * crush
        for j, (dq, dp) in enumerate(pairs):
            dc[j, i] = -C * (N * w[n] * dq + 2 * K * dp)
        dc[0, i] -= pull
        dc[1, i] -= crush
        dc[2, i] += L * (k.mu * (first[n] + last[n]) + k.lam)

    def by_trial(dc: Array, dq: Array, dp: Array) -> _Slope:
        dq, dp = dq / alpha, dp * open_
        return _Slope(np.array([dc[n] - C * (N * w[n] * dq + 2 * K * dp) for n in wanted]), dq, dp)

    slopes = tuple(_Slope(d, *pair) for d, pair in zip(dc, pairs))
    return _State(c, q, p, slopes, by_trial)  # type: ignore[arg-type]


class _Residual(NamedTuple):
    """Residuals of shear, cap, flow and scale, active mechanisms (2, n), largest relative residual, slopes."""

    values: Array
    on: NDArray[np.bool_]
    error: Array
    slopes: tuple[Array, ...]
    to_memory: Array
    to_scale: Array


def _residual(z: Array, t: Points, trial: _Trial, k: Constants, at: _State, with_cap: bool = True) -> _Residual:
    """Return the residuals of a state."""
    L, C, s, scale = z
    c1, c3, q, p = at.c[0], at.c[1], at.q, at.p
    reached, rate = k.scale(c3), t.faster / scale
    strength, to_least, to_gamma = k.shear_strength(c3, t.gamma + L * rate, reached)
    radius = np.sqrt(q * q / k.cap_slope + p * p + (1e-12 * trial.size) ** 2)
    bound, harder = k.hardened(t.cap, 2 * p * C * rate)
    total = np.where(c1 + c3 > 0, c1 + c3, 1.0)
    mob = np.where(c1 + c3 > 0, np.clip((c1 - c3) / total, -0.5, 1.0), 1.0)
    rowe = np.where(to_gamma == 0, k.sin_psi, (mob - k.sin_cv) / (1 - mob * k.sin_cv))  # all of it at failure
    values = np.array((c1 - c3 - strength, np.log(radius / bound), s - np.clip(rowe, 0.0, k.sin_psi),
                       scale - 0.5 * t.factor * (t.scale + reached)))
    on = (values[:2] > 0) | (z[:2] > 0)
    on[1] &= with_cap
    error = np.maximum(np.abs(np.where(on[0], values[0], k.mu * L)) / trial.size,
                       np.maximum(np.abs(np.where(on[1], values[1], (k.lam + 2 * k.mu / 3) * C)), np.abs(values[2])))
    error = np.maximum(error, np.abs(values[3]) / scale)
    moving = (rowe > 0) & (rowe < k.sin_psi) & (c1 + c3 > 0)
    slope = np.where(moving, (1 - k.sin_cv**2) / ((1 - mob * k.sin_cv) ** 2 * total), 0.0)
    squares, harder = radius * radius, 2 * harder / bound * rate
    to_memory = np.array((np.where(on[0], to_gamma * L * rate, 0.0), np.where(on[1], harder * p * C, 0.0)))
    return _Residual(values, on, error,
                     (1 + to_least, to_gamma * rate, q / (k.cap_slope * squares), p / squares - harder * C, harder * p,
                      slope * (1 - mob), slope * (1 + mob)), to_memory, -0.5 * t.factor * k.scale_slope(c3, reached))


def _row(slope: _Slope, of: _Residual) -> list[Array]:
    """Return the derivatives of the residuals of shear, cap and flow; an inactive mechanism has none."""
    to_least, _, to_q, to_p, _, up, down = of.slopes
    dc1, dc3 = slope.c[0], slope.c[1]
    return [np.where(of.on[0], dc1 - to_least * dc3, 0.0), np.where(of.on[1], to_q * slope.q + to_p * slope.p, 0.0),
            down * dc3 - up * dc1]


def _matrix(at: _State, of: _Residual) -> list[list[Array]]:
    """Return the rows of d residual / d (L, C, sine) without that of the scale; an inactive multiplier is itself."""
    columns = [_row(slope, of) for slope in at.slopes]
    columns[0][0] = np.where(of.on[0], columns[0][0] - of.slopes[1], 1.0)
    columns[1][1] = np.where(of.on[1], columns[1][1] - of.slopes[4], 1.0)
    columns[2][2] = columns[2][2] + 1
    return [list(row) for row in zip(*columns)]


def _solve(A: list[list[Array]], b: list[list[Array]]) -> list[list[Array]]:
    """Return the solutions of A x = b, three variables, by Cramer's rule; b holds the right-hand sides."""
    (a, d, g), (m, e, h), (n, f, i) = A  # rows
    x, y, z = e * i - h * f, h * n - m * i, m * f - e * n
    det = a * x + d * y + g * z
    det = np.where(det == 0, np.nan, det)
    inverse = [[x, g * f - d * i, d * h - g * e], [y, a * i - g * n, g * m - a * h], [z, d * n - a * f, a * e - d * m]]
    return [[(row[0] * r[0] + row[1] * r[1] + row[2] * r[2]) / det for row in inverse] for r in b]


def _step(z: Array, trial: _Trial, at: _State, of: _Residual) -> Array:
    """Return Newton's step (4, n): the scale by a Schur complement, then the three other variables."""
    shear, cap, flow, scale = of.values
    by_scale = at.by_trial(*trial.rate)
    column = _row(by_scale, of)
    column[:2] = column[0] + of.to_memory[0] / z[3], column[1] + of.to_memory[1] / z[3]
    right = [np.where(of.on[0], shear, z[0]), np.where(of.on[1], cap, z[1]), flow]
    first, second = _solve(_matrix(at, of), [right, column])
    pull = [of.to_scale * slope.c[1] for slope in at.slopes]
    own = 1 + of.to_scale * by_scale.c[1] - sum(a * b for a, b in zip(pull, second))
    change = (scale - sum(a * b for a, b in zip(pull, first))) / np.where(own == 0, np.nan, own)
    return -np.array([*(a - b * change for a, b in zip(first, second)), change])


def _newton(t: Points, mode: _Mode, k: Constants, with_cap: bool, start: Array
            ) -> tuple[Array, NDArray[np.intp]]:
    """Return the variables, (4, n), after Newton's method, and the points without a solution.

    A step is halved until the residual falls. Without the cap its multiplier stays zero.
    """
    n, bulk = t.gamma.size, 2 * k.lam + 4 / 3 * k.mu
    result, open_, here, least, halved = start, np.arange(n), start, np.full(n, np.inf), np.zeros(n, int)
    base, step = here, np.zeros((4, n))
    for _ in range(_ITERATIONS):
        trial = mode.trial(t, here[3], k)
        state = _state(here, trial, mode, k)
        residual = _residual(here, t, trial, k, state, with_cap)
        better = (residual.error < least) | (halved >= _HALVINGS)
        new = here + _step(here, trial, state, residual)
        if not np.isfinite(new).all():
            new = np.where(np.isfinite(new).all(axis=0), new, here)  # a singular matrix: no solution
        new[0] = np.clip(new[0], 0.0, np.maximum(trial.c[0] - trial.c[2], 0.0) / (0.5 * k.mu))
        grown = 1 + bulk * here[1]  # the cap is nearly linear in its logarithm
        new[1] = np.maximum(grown * np.exp(np.clip(bulk * (new[1] - here[1]) / grown, -3.0, 3.0)) - 1, 0.0) / bulk
        np.clip(new[2], 0.0, k.sin_psi, out=new[2])
        new[3] = np.clip(new[3], np.maximum(0.5 * t.factor * t.scale, 0.3 * here[3]), 3 * here[3])
        step, base = np.where(better, new - here, 0.5 * step), np.where(better, here, base)
        halved, least = np.where(better, 0, halved + 1), np.where(better, residual.error, least)
        here = base + step
        left = np.flatnonzero(~(residual.error < _LAST_STEP))
        if left.size < open_.size:
            result[:, open_] = here
            if not left.size:
                return result, left
            open_, t, here, base, step = open_[left], t.take(left), here[:, left], base[:, left], step[:, left]
            halved, least = halved[left], least[left]
    result[:, open_] = here
    return result, open_


def _followed(t: Points, mode: _Mode, k: Constants, with_cap: bool, steps: int, sheared: Array) -> Array:
    """Return the variables of Newton's method at the end of growing shares of the increment, from each to the next.

    The whole increment begins at the multipliers of one step of shear (`sheared`): from none of it the cap would be
    crushed by stresses that the shear relieves. Points without a solution on the way keep those of no increment.
    """
    none = np.array((*np.zeros((3, t.gamma.size)), t.factor * t.scale))
    z, open_, end = none.copy(), np.arange(t.gamma.size), t.push
    z[0] = sheared if steps == 1 else 0.0
    for step in range(steps):
        t = t._replace(push=end[:, open_] * ((step + 1) / steps))
        z[:, open_], lost = _newton(t, mode, k, with_cap, z[:, open_])
        if lost.size:
            z[:, open_[lost]] = none[:, open_[lost]]
            kept = np.delete(np.arange(open_.size), lost)
            t, open_ = t.take(kept), open_[kept]
    return z


class Returned(NamedTuple):
    """Returned stresses (3, n), memory (n,), scale (n,), and the points without an admissible result.

    ``slopes()`` computes d c / d trial (3, 3, n), and d c / d ln(scale) beside it (3, n).
    """

    c: Array
    gamma: Array
    cap: Array
    scale: Array
    lost: NDArray[np.intp]
    slopes: Callable[[], tuple[Array, Array]]


class _Part(NamedTuple):
    """Points that returned in one mode, with their state and residual where none of those that were tried is left."""

    at: NDArray[np.intp]
    mode: _Mode
    points: Points
    z: Array
    known: tuple[_State, _Residual] | None


def hardening_return(t: Points, k: Constants) -> Returned:
    """Return points, all of them outside of the yield surface; name those without an admissible result."""
    n = t.gamma.size
    c, gamma, cap = np.zeros((3, n)), t.gamma.copy(), t.cap.copy()
    scale = 0.5 * t.factor * (t.scale + k.scale(np.zeros(n)))
    left, parts = ~beyond_apex(t, scale, k), []
    likely, sheared = likely_modes(t, scale, k)
    for steps, with_cap, first, (number, mode) in product(_STEPS, (True, False), (True, False),
                                                          enumerate(modes(k.lode))):
        open_ = np.flatnonzero(left & ((likely == number) == first))
        if not open_.size:
            continue
        points = t.take(open_)
        z = _followed(points, mode, k, with_cap, steps, sheared[open_])
        values, memory, holds, known = _checked(z, points, mode, k)
        kept = np.flatnonzero(holds)
        done = open_[kept]
        parts.append(_Part(done, mode, points, z, known) if kept.size == open_.size else
                     _Part(done, mode, points.take(kept), z[:, kept], None))
        c[:, done], (gamma[done], cap[done]), scale[done] = values[:, kept], memory[:, kept], z[3, kept]
        left[done] = False
    return Returned(c, gamma, cap, scale, np.flatnonzero(left), lambda: _slopes(parts, n, k))


def _checked(z: Array, t: Points, mode: _Mode, k: Constants
             ) -> tuple[Array, Array, NDArray[np.bool_], tuple[_State, _Residual]]:
    """Return stresses (3, n) and memory (2, n) of the variables, where they are admissible, state and residual."""
    trial = mode.trial(t, z[3], k)
    state = _state(z, trial, mode, k, (0, 2, 1))
    residual = _residual(z, t, trial, k, state)
    (L, C, s, scale), (c1, c3, c2) = z, state.c
    round_off, c = 10 * ROUND_OFF * trial.size, k.shift - t.trial(scale).values[::-1]
    holds = (residual.error <= _SOLVED) & (c1 >= c3)
    faces, caps = k.mu * L, 4 * k.mu / k.cap_slope * state.q * C
    if mode.averaging[1, 1] == 1:
        holds &= (c1 >= c2 - round_off) & (c2 >= c3 - round_off)
        c2 = np.clip(c2, c3, np.maximum(c1, c3))
    elif mode.averaging[0, 0] == 1:  # as far as the meeting stresses were apart, the multipliers of their faces differ
        c2 = c3
        holds &= c[1] - c[2] <= (1 + s) * faces + (2 * k.lode - 1) * caps + round_off
    else:
        c2 = c1
        holds &= c[0] - c[1] <= (1 - s) * faces + (2 - k.lode) * caps + round_off
    rate = t.faster / scale
    memory = np.array((t.gamma + L * rate, k.hardened(t.cap, 2 * state.p * C * rate)[0]))
    return np.array((c1, c2, c3)), memory, holds, (state, residual)


def _slopes(parts: list[_Part], n: int, k: Constants) -> tuple[Array, Array]:
    """Return d c / d trial, (3, 3, n), at a held scale, and d c / d ln(scale), (3, n), at a held trial."""
    by_trial, by_scale = np.zeros((3, 3, n)), np.zeros((3, n))
    for at, mode, t, z, known in parts:
        state, residual = known or _checked(z, t, mode, k)[3]
        one, none = np.ones(at.size), np.zeros(at.size)
        direct = [state.by_trial(mode.averaging[:, [i]] * one, mode.w[i] * one, one / 3) for i in range(3)]
        columns = [*(_row(slope, residual) for slope in direct), [*residual.to_memory, none]]
        changes = _solve(_matrix(state, residual), columns)
        for i, change in enumerate(changes):
            shear, cap, flow = (-a * b.c for a, b in zip(change, state.slopes))
            slope = shear + cap + flow
            if i < 3:
                by_trial[:, i, at] = (slope + direct[i].c)[[0, 2, 1]]
            else:
                by_scale[:, at] = slope[[0, 2, 1]]
    return by_trial, by_scale
