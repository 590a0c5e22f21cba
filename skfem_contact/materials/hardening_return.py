"""Return mapping of the Hardening Soil in principal stresses.

Stresses, and the scale of the stiffness, are those of :mod:`.hardening_stiffness`. The variables of
a point are the shear multiplier L and the cap multiplier C, both times the scale, the sine of the
mobilised dilatancy, and the scale. As in :mod:`.pyramid` an edge is a face whose two meeting
principal stresses are averaged. An admissible result fulfils the yield and flow conditions of all
mechanisms, keeps the order of the principal stresses, and on an edge the multipliers of both
meeting faces are not negative.
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

# Newton's method takes its last step below the first residual, and the second is then reached: it
# converges quadratically. Residuals are relative to the largest trial stress.
_LAST_STEP, _SOLVED = 1e-7, 1e-11
_ITERATIONS, _HALVINGS = 12, 6
# Positions of c1, c2 and c3 among c1, c3 and c2, and the reverse.
_SORTED = [0, 2, 1]
# Averages of c1, c3 and c2, in this order, on the face, the edge c2 = c3 and the edge c1 = c2.
_AVERAGES = (
    np.array(
        ((2, 0, 0, 0, 2, 0, 0, 0, 2), (2, 0, 0, 0, 1, 1, 0, 1, 1), (1, 0, 1, 0, 2, 0, 1, 0, 1))
    )
    / 2
)
_AVERAGES = _AVERAGES.reshape(3, 3, 3)
# Modes in the order in which they are tried after the likely one.
_ORDER = np.array(((0, 1, 2), (1, 0, 2), (2, 0, 1)))
# Shares in which the solution of an increment is followed, where Newton's method fails in one. What
# is left is halved: 2,000 points near a free surface under strains of 1e-3 take 1.0 s so, 2.4 s
# with 20 iterations and 12 shares.
_STEPS = 1, 4


class _Modes(NamedTuple):
    """Faces and edges to which points return: 0 the face, 1 the edge c2 = c3, 2 the edge c1 = c2.

    The averages are those of c1, c3 and c2, in this order, with a ``share`` of the stress that
    meets each. The shear multiplier changes them by mu times ``pull``, its product with the
    dilatancy by mu times ``wider``. ``w`` is the direction of the cap's deviatoric measure.
    """

    number: NDArray[np.intp]
    share: Array
    pull: Array
    wider: Array
    w: Array

    @classmethod
    def of(cls, number: NDArray[np.intp], k: Constants) -> _Modes:
        """Return the modes of points by their numbers."""
        share = 1 - _AVERAGES.diagonal(axis1=1, axis2=2)
        directions = (
            _AVERAGES @ direction for direction in ((1, -1, 0), (1, 1, 0), (1, -k.lode, k.lode - 1))
        )
        return cls(number, *(values.T[:, number] for values in (share, *directions)))

    def take(self, at: NDArray[np.intp]) -> _Modes:
        """Return the modes of some of the points."""
        return _Modes(self.number[at], *(values[:, at] for values in self[1:]))

    def trial(self, t: Points, scale: Array, k: Constants) -> _Trial:
        """Return the trial stresses."""
        frame = t.trial(scale)
        c, change = k.shift - frame.values[[2, 0, 1]], -frame.along(t.push)[[2, 0, 1]]
        return _Trial(
            c, np.maximum(np.abs(c[0]), np.abs(c[1])), self.averaged(c), self.averaged(change)
        )

    def averaged(self, c: Array) -> tuple[Array, Array, Array]:
        """Return the averages of c1, c3 and c2, q and p of principal stresses, or of their
        derivatives.
        """
        meeting = np.array((c[2], c[2], np.where(self.number == 2, c[0], c[1])))
        return c + self.share * (meeting - c), (self.w * c).sum(axis=0), c.sum(axis=0) / 3


class _Trial(NamedTuple):
    """Trial stresses c1, c3 and c2, the largest, averages with q and p, and the derivatives of
    these by the scale.
    """

    c: Array
    size: Array
    averages: tuple[Array, Array, Array]
    rates: tuple[Array, Array, Array]


class _Slopes(NamedTuple):
    """Derivatives of stresses (..., n_stresses, n), of q and of p (..., n)."""

    c: Array
    q: Array
    p: Array


class _State(NamedTuple):
    """Averages of c1, c3 and c2, q and p, their derivatives by multipliers and dilatancy, and those
    by the trial.
    """

    c: Array
    q: Array
    p: Array
    slopes: _Slopes
    by_trial: Callable[[Array, Array, Array], _Slopes]


def _state(z: Array, trial: _Trial, modes: _Modes, k: Constants) -> _State:
    """Return the stresses of the variables z, (4, n), and their derivatives."""
    L, C, s = z[:3]
    w, N, K = modes.w, 4 * k.mu / k.cap_slope, k.lam + 2 * k.mu / 3
    softer, steeper = N * (w * w).sum(axis=0), k.mu * (w[0] + w[1])
    alpha, beta, push = 1 + softer * C, 1 + 2 * K * C, k.mu * (w[0] - w[1]) - s * steeper
    c, q, p = trial.averages
    q, p = (q - L * push) / alpha, (p + K * s * L) / beta
    open_ = (p > 0) / beta  # no cap in tension
    p = np.maximum(p, 0.0)
    dq, dp = (
        np.array((-push, -softer * q, steeper * L)) / alpha,
        np.array((K * s, -2 * K * p, K * L)) * open_,
    )
    across, wider = N * w, k.mu * modes.wider + k.lam
    pull, crush = k.mu * modes.pull - s * wider, across * q + 2 * K * p
    dc = -C * (across * dq[:, None] + 2 * K * dp[:, None])
    dc[0] -= pull
    dc[1] -= crush
    dc[2] += L * wider

    def by_trial(dc: Array, dq: Array, dp: Array) -> _Slopes:
        dq, dp = dq / alpha, dp * open_
        return _Slopes(dc - C * (across * dq[..., None, :] + 2 * K * dp[..., None, :]), dq, dp)

    return _State(c - L * pull - C * crush, q, p, _Slopes(dc, dq, dp), by_trial)


class _Residual(NamedTuple):
    """Residuals of shear, cap, flow and scale, active mechanisms (2, n), largest relative residual,
    slopes.
    """

    values: Array
    on: NDArray[np.bool_]
    error: Array
    slopes: tuple[Array, ...]
    to_memory: Array
    to_scale: Array


def _residual(
    z: Array, t: Points, trial: _Trial, k: Constants, at: _State, with_cap: bool = True
) -> _Residual:
    """Return the residuals of a state."""
    L, C, s, scale = z
    c1, c3, q, p = at.c[0], at.c[1], at.q, at.p
    reached, rate = k.scale(c3), t.faster / scale
    strength, to_least, to_gamma = k.shear_strength(c3, t.gamma + L * rate, reached)
    radius = np.sqrt(q * q / k.cap_slope + p * p + (1e-12 * trial.size) ** 2)
    bound, harder = k.hardened(t.cap, 2 * p * C * rate)
    total, pressed = c1 + c3, c1 + c3 > 0
    total = np.where(pressed, total, 1.0)
    mob = np.where(pressed, np.minimum(np.maximum((c1 - c3) / total, -0.5), 1.0), 1.0)
    rowe = np.where(
        to_gamma == 0, k.sin_psi, (mob - k.sin_cv) / (1 - mob * k.sin_cv)
    )  # all of it at failure
    values = np.array(
        (
            c1 - c3 - strength,
            np.log(radius / bound),
            s - np.minimum(np.maximum(rowe, 0.0), k.sin_psi),
            scale - 0.5 * t.factor * (t.scale + reached),
        )
    )
    on = (values[:2] > 0) | (z[:2] > 0)
    on[1] &= with_cap
    error = np.maximum(
        np.abs(np.where(on[0], values[0], k.mu * L)) / trial.size,
        np.maximum(
            np.abs(np.where(on[1], values[1], (k.lam + 2 * k.mu / 3) * C)), np.abs(values[2])
        ),
    )
    error = np.maximum(error, np.abs(values[3]) / scale)
    moving = (rowe > 0) & (rowe < k.sin_psi) & pressed
    slope = np.where(moving, (1 - k.sin_cv**2) / ((1 - mob * k.sin_cv) ** 2 * total), 0.0)
    squares, harder = radius * radius, 2 * harder / bound * rate
    to_memory = np.array(
        (np.where(on[0], to_gamma * L * rate, 0.0), np.where(on[1], harder * p * C, 0.0))
    )
    return _Residual(
        values,
        on,
        error,
        (
            1 + to_least,
            to_gamma * rate,
            q / (k.cap_slope * squares),
            p / squares - harder * C,
            harder * p,
            slope * (1 - mob),
            slope * (1 + mob),
        ),
        to_memory,
        -0.5 * t.factor * k.scale_slope(c3, reached),
    )


def _rows(slopes: _Slopes, of: _Residual) -> Array:
    """Return the derivatives of the residuals of shear, cap and flow, (3, ..., n); an inactive
    mechanism has none.
    """
    to_least, _, to_q, to_p, _, up, down = of.slopes
    c1, c3 = slopes.c[..., 0, :], slopes.c[..., 1, :]
    return np.array(
        (
            np.where(of.on[0], c1 - to_least * c3, 0.0),
            np.where(of.on[1], to_q * slopes.q + to_p * slopes.p, 0.0),
            down * c3 - up * c1,
        )
    )


def _matrix(at: _State, of: _Residual) -> Array:
    """Return d residual / d (L, C, sine), (3, 3, n), without that of the scale; an inactive
    multiplier is itself.
    """
    A = _rows(at.slopes, of)
    A[0, 0] = np.where(of.on[0], A[0, 0] - of.slopes[1], 1.0)
    A[1, 1] = np.where(of.on[1], A[1, 1] - of.slopes[4], 1.0)
    A[2, 2] += 1
    return A


def _solve(A: Array, b: Array) -> Array:
    """Return the solutions of A x = b, three variables, by Cramer's rule; b holds the right-hand
    sides, (m, 3, n).
    """
    (a, d, g), (m, e, h), (n, f, i) = A  # rows
    inverse = np.array(
        (
            (e * i - h * f, g * f - d * i, d * h - g * e),
            (h * n - m * i, a * i - g * n, g * m - a * h),
            (m * f - e * n, d * n - a * f, a * e - d * m),
        )
    )
    det = (A[0] * inverse[:, 0]).sum(axis=0)
    return (inverse * b[:, None]).sum(axis=2) / np.where(det == 0, np.nan, det)


def _step(z: Array, trial: _Trial, at: _State, of: _Residual) -> Array:
    """Return Newton's step (4, n): the scale by a Schur complement, then the three other
    variables.
    """
    by_scale = at.by_trial(*trial.rates)
    right = np.array((of.values[:3], _rows(by_scale, of)))
    right[0, :2] = np.where(of.on, right[0, :2], z[:2])
    right[1, :2] += of.to_memory / z[3]
    first, second = _solve(_matrix(at, of), right)
    pull = of.to_scale * at.slopes.c[:, 1]
    own = 1 + of.to_scale * by_scale.c[1] - (pull * second).sum(axis=0)
    change = (of.values[3] - (pull * first).sum(axis=0)) / np.where(own == 0, np.nan, own)
    return np.array((*(second * change - first), -change))


def _newton(
    t: Points, modes: _Modes, k: Constants, with_cap: bool, start: Array
) -> tuple[Array, NDArray[np.intp]]:
    """Return the variables, (4, n), after Newton's method, and the points without a solution.

    A step is halved until the residual falls. Without the cap its multiplier stays zero.
    """
    n, bulk = t.gamma.size, 2 * k.lam + 4 / 3 * k.mu
    result, open_, here, least, halved = (
        start,
        np.arange(n),
        start,
        np.full(n, np.inf),
        np.zeros(n, int),
    )
    base, step = here, np.zeros((4, n))
    for _ in range(_ITERATIONS):
        trial = modes.trial(t, here[3], k)
        state = _state(here, trial, modes, k)
        residual = _residual(here, t, trial, k, state, with_cap)
        better = (residual.error < least) | (halved >= _HALVINGS)
        new = here + _step(here, trial, state, residual)
        if not np.isfinite(new).all():
            new = np.where(
                np.isfinite(new).all(axis=0), new, here
            )  # a singular matrix: no solution
        first, last, _ = trial.averages[0]
        new[0] = np.maximum(np.minimum(new[0], (first - last) / (0.5 * k.mu)), 0.0)
        grown = 1 + bulk * here[1]  # the cap is nearly linear in its logarithm
        growth = np.maximum(np.minimum(bulk * (new[1] - here[1]) / grown, 3.0), -3.0)
        new[1] = np.maximum(grown * np.exp(growth) - 1, 0.0) / bulk
        new[2] = np.minimum(np.maximum(new[2], 0.0), k.sin_psi)
        new[3] = np.minimum(
            np.maximum(new[3], np.maximum(0.5 * t.factor * t.scale, 0.3 * here[3])), 3 * here[3]
        )
        step, base = np.where(better, new - here, 0.5 * step), np.where(better, here, base)
        halved, least = np.where(better, 0, halved + 1), np.where(better, residual.error, least)
        here = base + step
        left = np.flatnonzero(~(residual.error < _LAST_STEP))
        if left.size < open_.size:
            result[:, open_] = here
            if not left.size:
                return result, left
            open_, t, modes = open_[left], t.take(left), modes.take(left)
            here, base, step, halved, least = (
                here[:, left],
                base[:, left],
                step[:, left],
                halved[left],
                least[left],
            )
    result[:, open_] = here
    return result, open_


def _followed(
    t: Points, modes: _Modes, k: Constants, with_cap: bool, steps: int, first: Array
) -> Array:
    """Return the variables of Newton's method at the end of growing shares of the increment, from
    each to the next.

    The whole increment begins at the multipliers (2, n) of a first step: without shear the cap
    would be crushed by stresses that the shear relieves. Points without a solution on the way keep
    those of no increment.
    """
    none = np.array((*np.zeros((3, t.gamma.size)), t.factor * t.scale))
    z, open_, end = none.copy(), np.arange(t.gamma.size), t.push
    if steps == 1:
        z[:2] = first * np.array(((1.0,), (with_cap,)))
    for step in range(steps):
        t = t._replace(push=end[:, open_] * ((step + 1) / steps))
        z[:, open_], lost = _newton(t, modes, k, with_cap, z[:, open_])
        if lost.size:
            z[:, open_[lost]] = none[:, open_[lost]]
            kept = np.delete(np.arange(open_.size), lost)
            t, modes, open_ = t.take(kept), modes.take(kept), open_[kept]
    return z


class Returned(NamedTuple):
    """Returned stresses (3, n), memory (n,), scale (n,), and the points without an admissible
    result.

    ``slopes()`` computes d c / d trial (3, 3, n), and d c / d ln(scale) beside it (3, n).
    """

    c: Array
    gamma: Array
    cap: Array
    scale: Array
    lost: NDArray[np.intp]
    slopes: Callable[[], tuple[Array, Array]]


class _Part(NamedTuple):
    """Points that returned in one attempt, with their state and residual where this is the last
    attempt.
    """

    at: NDArray[np.intp]
    modes: _Modes
    points: Points
    z: Array
    known: tuple[_State, _Residual] | None


def hardening_return(t: Points, k: Constants) -> Returned:
    """Return points, all of them outside of the yield surface; name those without an admissible
    result.
    """
    n = t.gamma.size
    c, gamma, cap = np.zeros((3, n)), t.gamma.copy(), t.cap.copy()
    scale = 0.5 * t.factor * (t.scale + k.scale(np.zeros(n)))
    left, parts = np.flatnonzero(~beyond_apex(t, scale, k)), []
    likely, *first = likely_modes(t, k)
    for steps, with_cap, attempt in product(_STEPS, (True, False), range(3)):
        if not left.size:
            break
        points, modes = t.take(left), _Modes.of(_ORDER[likely[left], attempt], k)
        z = _followed(points, modes, k, with_cap, steps, np.array(first)[:, left])
        values, memory, holds, known = _checked(z, points, modes, k)
        kept = np.flatnonzero(holds)
        done, left = left[kept], left[~holds]
        parts.append(
            _Part(done, modes.take(kept), points.take(kept), z[:, kept], None)
            if left.size
            else _Part(done, modes, points, z, known)
        )
        c[:, done], (gamma[done], cap[done]), scale[done] = (
            values[:, kept],
            memory[:, kept],
            z[3, kept],
        )
    return Returned(c, gamma, cap, scale, left, lambda: _slopes(parts, n, k))


def _checked(
    z: Array, t: Points, modes: _Modes, k: Constants
) -> tuple[Array, Array, NDArray[np.bool_], tuple[_State, _Residual]]:
    """Return stresses (3, n) and memory (2, n) of the variables, where they are admissible, state
    and residual.
    """
    trial = modes.trial(t, z[3], k)
    state = _state(z, trial, modes, k)
    residual = _residual(z, t, trial, k, state)
    (L, C, s, scale), (c1, c3, c2), mode = z, state.c, modes.number
    round_off, (first, last, middle) = 10 * ROUND_OFF * trial.size, trial.c
    faces, caps = k.mu * L, 4 * k.mu / k.cap_slope * state.q * C
    # as far as meeting stresses were apart, the multipliers of their faces differ
    ordered = np.where(
        mode == 1,
        middle - last <= (1 + s) * faces + (2 * k.lode - 1) * caps + round_off,
        np.where(
            mode == 2,
            first - middle <= (1 - s) * faces + (2 - k.lode) * caps + round_off,
            (c1 >= c2 - round_off) & (c2 >= c3 - round_off),
        ),
    )
    c2 = np.clip(c2, c3, np.maximum(c1, c3))
    rate = t.faster / scale
    memory = np.array((t.gamma + L * rate, k.hardened(t.cap, 2 * state.p * C * rate)[0]))
    holds = (residual.error <= _SOLVED) & (c1 >= c3) & ordered
    return np.array((c1, c2, c3)), memory, holds, (state, residual)


def _slopes(parts: list[_Part], n: int, k: Constants) -> tuple[Array, Array]:
    """Return d c / d trial, (3, 3, n), at a held scale, and d c / d ln(scale), (3, n), at a held
    trial.
    """
    by_trial, by_scale = np.zeros((3, 3, n)), np.zeros((3, n))
    for at, modes, t, z, known in parts:
        state, residual = known or _checked(z, t, modes, k)[3]
        units = np.repeat(np.eye(3)[:, :, None], at.size, axis=2)
        direct = [state.by_trial(*modes.averaged(unit)) for unit in units]
        memory = np.array((*residual.to_memory, np.zeros(at.size)))
        changes = _solve(
            _matrix(state, residual),
            np.array((*(_rows(slopes, residual) for slopes in direct), memory)),
        )
        change = -np.einsum("mvn,vsn->msn", changes, state.slopes.c)[:, _SORTED]
        by_scale[:, at] = change[3]
        for i, own, slopes in zip(_SORTED, change, direct):
            by_trial[:, i, at] = own + slopes.c[_SORTED]
    return by_trial, by_scale
