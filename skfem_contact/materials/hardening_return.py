"""Return mapping of the Hardening Soil in principal stresses.

Stresses, and the scale of the stiffness, are defined in :mod:`.hardening_stiffness`. The variables
of a point are the shear multiplier L and the cap multiplier C, both times the scale, the sine of
the mobilised dilatancy, and the scale. As in :mod:`.pyramid` an edge is a face whose two meeting
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
from .local_newton import damped_newton, take
from .plastic import ROUND_OFF

# Newton's method takes its last step below the first residual, and the second is then reached: it
# converges quadratically. Residuals are relative to the largest trial stress.
_LAST_STEP = 1e-7
_SOLVED = 1e-11
_ITERATIONS = 12
_HALVINGS = 6
# Positions of c1, c2 and c3 among c1, c3 and c2, and the reverse.
_SORTED = [0, 2, 1]
# Averages of c1, c3 and c2, in this order, on the face, the edge c2 = c3 and the edge c1 = c2.
_AVERAGES = np.array(
    [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.0, 0.5, 0.5]],
        [[0.5, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 0.5]],
    ]
)
# Modes in the order in which they are tried: after the likely one, and after a face where c2 is
# above c1.
_ORDER = np.array(((0, 1, 2), (1, 0, 2), (2, 0, 1), (0, 2, 1)))
_TO_MAJOR = 3
# Positions in this order, each with the cap or without it, that are tried at once, and the shares
# in which the solution of an increment is followed: four where Newton's method fails in one. A
# handful of points is left after the first attempt, whose iterations cost as much as those of a
# hundred. The points that remain are halved: 2,000 points near a free surface under strains of 1e-3
# take 1.0 s so, 2.4 s with 20 iterations and 12 shares.
_ATTEMPTS = (
    (1, ((0, True),)),
    (1, ((1, True),)),
    (1, ((2, True), (0, False), (1, False), (2, False))),
    (4, tuple(product(range(3), (True, False)))),
)


class _Modes(NamedTuple):
    """Faces and edges to which points return: 0 the face, 1 the edge c2 = c3, 2 the edge c1 = c2.

    The averages belong to c1, c3 and c2, in this order, (3, n).
    """

    number: NDArray[np.intp]
    share: Array  # of the stress that meets each one in its average
    pull: Array  # change of the averages by the shear multiplier, over mu
    wider: Array  # their change by the multiplier times the dilatancy, over mu
    w: Array  # direction of the cap's deviatoric measure

    @classmethod
    def of(cls, number: NDArray[np.intp], k: Constants) -> _Modes:
        """Return the modes of points by their numbers."""
        share = 1 - _AVERAGES.diagonal(axis1=1, axis2=2)
        pull = _AVERAGES @ (1, -1, 0)
        wider = _AVERAGES @ (1, 1, 0)
        w = _AVERAGES @ (1, -k.lode, k.lode - 1)
        return cls(number, *(values.T[:, number] for values in (share, pull, wider, w)))

    def trial(self, t: Points, scale: Array, k: Constants) -> _Trial:
        """Return the trial stresses."""
        frame = t.trial(scale)
        both = np.array((frame.values, frame.along(t.push)))
        both = -both[:, [2, 0, 1]]
        both[0] += k.shift
        c = both[0]
        size = np.maximum(np.abs(c[0]), np.abs(c[1]))
        averages, q, p = self.averaged(both)
        return _Trial(c, size, (averages[0], q[0], p[0]), (averages[1], q[1], p[1]))

    def averaged(self, c: Array) -> tuple[Array, Array, Array]:
        """Return averages of c1, c3 and c2, (..., 3, n), q and p, or derivatives of them."""
        meeting = np.empty_like(c)
        meeting[..., :2, :] = c[..., 2:, :]
        meeting[..., 2, :] = np.where(self.number == 2, c[..., 0, :], c[..., 1, :])
        q = (self.w * c).sum(axis=-2)
        p = c.sum(axis=-2) / 3
        return c + self.share * (meeting - c), q, p


class _Trial(NamedTuple):
    """Trial stresses c1, c3 and c2, and the largest."""

    c: Array
    size: Array
    averages: tuple[Array, Array, Array]  # with q and p
    rates: tuple[Array, Array, Array]  # their derivatives by the scale


class _Slopes(NamedTuple):
    """Derivatives of stresses (..., n_stresses, n), of q and of p (..., n)."""

    c: Array
    q: Array
    p: Array


class _State(NamedTuple):
    """Averages of c1, c3 and c2, q and p, and derivatives."""

    c: Array
    q: Array
    p: Array
    slopes: _Slopes  # by multipliers and dilatancy
    softening: Array  # dq_trial / dq
    compressed: Array  # dp / dp_trial
    by_q: Array  # -dc / dq, (3, n)
    by_p: Array  # -dc / dp

    def by_trial(self, dc: Array, dq: Array, dp: Array) -> _Slopes:
        """Return derivatives by changes of the trial stresses, (..., 3, n), of q and of p."""
        dq = dq / self.softening
        dp = dp * self.compressed
        crushed = self.by_q * dq[..., None, :] + self.by_p * dp[..., None, :]
        return _Slopes(dc - crushed, dq, dp)


def _state(z: Array, trial: _Trial, modes: _Modes, k: Constants) -> _State:
    """Return the stresses of the variables z, (4, n), and their derivatives.

    With N = 4 mu / M^2, the bulk modulus K and the flow (w q / M^2 + p / 3) of the cap

        q = (q_trial - L push) / (1 + N w.w C),    p = (p_trial + K s L) / (1 + 2 K C)
        c = c_trial - L (mu pull - s (mu wider + lambda)) - C (N w q + 2 K p)
    """
    L, C, s = z[:3]
    w = modes.w
    N = 4 * k.mu / k.cap_slope
    K = k.lam + 2 * k.mu / 3

    # compute q and p; in tension the cap is not active
    softer = N * (w * w).sum(axis=0)
    steeper = k.mu * (w[0] + w[1])
    push = k.mu * (w[0] - w[1]) - s * steeper
    alpha = 1 + softer * C
    beta = 1 + 2 * K * C
    c, q, p = trial.averages
    q = (q - L * push) / alpha
    p = (p + K * s * L) / beta
    compressed = (p > 0) / beta
    p = np.maximum(p, 0.0)
    dq = np.array((-push, -softer * q, steeper * L)) / alpha
    dp = np.array((K * s, -2 * K * p, K * L)) * compressed

    # compute the stresses
    across = N * w
    wider = k.mu * modes.wider + k.lam
    pull = k.mu * modes.pull - s * wider
    crush = across * q + 2 * K * p
    by_q = C * across
    by_p = 2 * K * C
    dc = -(by_q * dq[:, None] + by_p * dp[:, None])  # (3 variables, 3 stresses, n)
    dc[0] -= pull
    dc[1] -= crush
    dc[2] += L * wider
    stresses = c - L * pull - C * crush
    return _State(stresses, q, p, _Slopes(dc, dq, dp), alpha, compressed, by_q, by_p)


class _Residual(NamedTuple):
    """Residuals of shear, cap, flow and scale, (4, n), and their derivatives by stresses."""

    values: Array
    active: NDArray[np.bool_]  # shear and cap, (2, n)
    error: Array  # largest one, relative
    to_least: Array  # of shear by c3
    to_gamma: Array  # of shear by the multiplier
    to_q: Array  # of the cap
    to_p: Array
    to_cap: Array  # of the cap by its multiplier
    to_major: Array  # of the flow by c1
    to_minor: Array  # of the flow by c3
    to_memory: Array  # of shear and cap by the logarithm of the scale, (2, n)
    to_scale: Array  # of the scale by c3


def _residual(
    z: Array,
    t: Points,
    trial: _Trial,
    k: Constants,
    state: _State,
    with_cap: NDArray[np.bool_] | bool = True,
) -> _Residual:
    """Return the residuals of a state.

        c1 - c3 - q(c3, gamma) = 0,    ln(sqrt(q^2 / M^2 + p^2) / p_p) = 0,
        s - sin(psi_m) = 0,    scale - factor (scale_0 + scale(c3)) / 2 = 0

    The sine s is compared with :meth:`Constants.dilatancy`.
    """
    L, C, s, scale = z
    c1, c3 = state.c[:2]
    q = state.q
    p = state.p

    # compute the limits of shear and cap
    reached = k.scale(c3)
    rate = t.faster / scale
    strength, to_least, to_gamma = k.shear_strength(c3, t.gamma + L * rate, reached)
    least = (1e-12 * trial.size) ** 2
    radius = np.sqrt(q * q / k.cap_slope + p * p + least)
    bound, harder = k.hardened(t.cap, 2 * p * C * rate)
    dilatancy, to_major, to_minor = k.dilatancy(c1, c3, to_gamma == 0)

    # collect the residuals; the multiplier of an inactive mechanism is its error
    values = np.array(
        (
            c1 - c3 - strength,
            np.log(radius / bound),
            s - dilatancy,
            scale - 0.5 * t.factor * (t.scale + reached),
        )
    )
    active = (values[:2] > 0) | (z[:2] > 0)
    active[1] &= with_cap
    bulk = k.lam + 2 * k.mu / 3
    shear_rest = np.where(active[0], values[0], k.mu * L)
    shear_error = np.abs(shear_rest) / trial.size
    cap_error = np.abs(np.where(active[1], values[1], bulk * C))
    error = np.maximum(shear_error, np.maximum(cap_error, np.abs(values[2])))
    error = np.maximum(error, np.abs(values[3]) / scale)

    # differentiate them
    squares = radius * radius
    harder = 2 * harder / bound * rate
    shear_memory = np.where(active[0], to_gamma * L * rate, 0.0)
    cap_memory = np.where(active[1], harder * p * C, 0.0)
    return _Residual(
        values,
        active,
        error,
        to_least=1 + to_least,
        to_gamma=to_gamma * rate,
        to_q=q / (k.cap_slope * squares),
        to_p=p / squares - harder * C,
        to_cap=harder * p,
        to_major=to_major,
        to_minor=to_minor,
        to_memory=np.array((shear_memory, cap_memory)),
        to_scale=-0.5 * t.factor * k.scale_slope(c3, reached),
    )


def _rows(slopes: _Slopes, r: _Residual) -> Array:
    """Return the derivatives of the residuals of shear, cap and flow, (3, ..., n).

    The residual of an inactive mechanism has none.
    """
    c1 = slopes.c[..., 0, :]
    c3 = slopes.c[..., 1, :]
    shear = np.where(r.active[0], c1 - r.to_least * c3, 0.0)
    cap = r.to_q * slopes.q + r.to_p * slopes.p
    cap = np.where(r.active[1], cap, 0.0)
    dilatancy = r.to_minor * c3 - r.to_major * c1
    return np.array((shear, cap, dilatancy))


def _matrix(state: _State, r: _Residual) -> Array:
    """Return d residual / d (L, C, sine), (3, 3, n); an inactive multiplier is itself."""
    A = _rows(state.slopes, r)
    A[0, 0] = np.where(r.active[0], A[0, 0] - r.to_gamma, 1.0)
    A[1, 1] = np.where(r.active[1], A[1, 1] - r.to_cap, 1.0)
    A[2, 2] += 1
    return A


def _solve(A: Array, b: Array) -> Array:
    """Return the solutions of A x = b for right-hand sides (m, 3, n), by Cramer's rule."""
    (a, d, g), (m, e, h), (n, f, i) = A  # rows
    adjugate = np.array(
        (
            (e * i - h * f, g * f - d * i, d * h - g * e),
            (h * n - m * i, a * i - g * n, g * m - a * h),
            (m * f - e * n, d * n - a * f, a * e - d * m),
        )
    )
    first = A[0] * adjugate[:, 0]
    det = first.sum(axis=0)
    det = np.where(det == 0, np.nan, det)
    products = adjugate * b[:, None]  # (m, 3, 3, n)
    return products.sum(axis=2) / det


def _step(z: Array, trial: _Trial, state: _State, r: _Residual) -> Array:
    """Return Newton's step, (4, n): the scale by a Schur complement, then L, C and s."""
    # solve for L, C and s with the scale fixed, and for their derivatives by the scale
    by_scale = state.by_trial(*trial.rates)
    fixed = r.values[:3].copy()
    fixed[:2] = np.where(r.active, fixed[:2], z[:2])
    moving = _rows(by_scale, r)
    moving[:2] += r.to_memory / z[3]
    matrix = _matrix(state, r)
    first, second = _solve(matrix, np.array((fixed, moving)))

    # insert them into the equation of the scale
    pull = r.to_scale * state.slopes.c[:, 1]
    own = 1 + r.to_scale * by_scale.c[1] - (pull * second).sum(axis=0)
    own = np.where(own == 0, np.nan, own)
    missing = r.values[3] - (pull * first).sum(axis=0)
    change = missing / own
    others = second * change - first
    return np.array((*others, -change))


def _newton(
    t: Points,
    modes: _Modes,
    with_cap: NDArray[np.bool_],
    k: Constants,
    start: Array,
) -> tuple[Array, NDArray[np.intp]]:
    """Return the variables, (4, n), after Newton's method, and the points without a solution.

    Without the cap its multiplier stays zero.
    """

    def step(
        z: Array,
        t: Points,
        modes: _Modes,
        with_cap: NDArray[np.bool_],
    ) -> tuple[Array, Array]:
        trial = modes.trial(t, z[3], k)
        state = _state(z, trial, modes, k)
        residual = _residual(z, t, trial, k, state, with_cap)
        new = z + _step(z, trial, state, residual)
        solved = np.isfinite(new)
        if not solved.all():  # a singular matrix: no solution
            new = np.where(solved.all(axis=0), new, z)
        new = _limited(new, z, t, trial, k)
        return new - z, residual.error

    return damped_newton(step, start, (t, modes, with_cap), _LAST_STEP, _ITERATIONS, _HALVINGS)


def _limited(new: Array, z: Array, t: Points, trial: _Trial, k: Constants) -> Array:
    """Return the variables after Newton's step within their limits; change them in place."""
    # do not shear beyond the isotropic stress
    c1, c3, _ = trial.averages[0]
    largest = (c1 - c3) / (0.5 * k.mu)
    new[0] = np.minimum(new[0], largest)
    new[0] = np.maximum(new[0], 0.0)

    # take the step of the cap, which is nearly linear in its logarithm, in this logarithm
    bulk = 2 * k.lam + 4 / 3 * k.mu
    grown = 1 + bulk * z[1]
    change = new[1] - z[1]
    growth = bulk * change / grown
    growth = np.maximum(np.minimum(growth, 3.0), -3.0)
    compression = grown * np.exp(growth) - 1
    new[1] = np.maximum(compression, 0.0) / bulk

    # bound dilatancy and scale
    new[2] = np.maximum(new[2], 0.0)
    new[2] = np.minimum(new[2], k.sin_psi)
    least = np.maximum(0.5 * t.factor * t.scale, 0.3 * z[3])
    new[3] = np.maximum(new[3], least)
    new[3] = np.minimum(new[3], 3 * z[3])
    return new


def _followed(
    t: Points,
    modes: _Modes,
    with_cap: NDArray[np.bool_],
    k: Constants,
    steps: int,
    first: Array,
) -> Array:
    """Return the variables of Newton's method, followed through growing shares of the increment.

    The whole increment begins at the variables (4, n) of a first step: without shear the cap would
    be crushed by stresses that the shear relieves. Points without a solution on the way keep the
    variables of no increment.
    """
    none = np.zeros_like(first)
    none[3] = t.factor * t.scale
    z = none.copy()
    if steps == 1:
        z = first.copy()
        z[1] *= with_cap
    active = np.arange(t.gamma.size)
    push = t.push
    for step in range(steps):
        t = t._replace(push=push[:, active] * ((step + 1) / steps))
        z[:, active], failed = _newton(t, modes, with_cap, k, z[:, active])
        if failed.size:
            z[:, active[failed]] = none[:, active[failed]]
            kept = np.delete(np.arange(active.size), failed)
            t, modes, with_cap, active = take((t, modes, with_cap, active), kept)
    return z


class Returned(NamedTuple):
    """Returned stresses (3, n), memory (n,), scale (n,), and `failed` points without a result.

    ``slopes()`` computes d c / d trial (3, 3, n), and d c / d ln(scale), (3, n).
    """

    c: Array
    gamma: Array
    cap: Array
    scale: Array
    failed: NDArray[np.intp]
    slopes: Callable[[], tuple[Array, Array]]


class _Part(NamedTuple):
    """Points that returned in one attempt, with their state and residual."""

    indices: NDArray[np.intp]
    kept: NDArray[np.intp]  # among the points of the attempt
    modes: _Modes
    state: _State
    residual: _Residual


def hardening_return(t: Points, k: Constants) -> Returned:
    """Return points outside of the yield surface; name the points without an admissible result."""
    n = t.gamma.size
    c = np.zeros((3, n))
    gamma = t.gamma.copy()
    cap = t.cap.copy()
    scale = 0.5 * t.factor * (t.scale + k.scale(np.zeros(n)))
    remaining = np.flatnonzero(~beyond_apex(t, scale, k))
    order, start = likely_modes(t, k)
    parts: list[_Part] = []
    for steps, attempts in _ATTEMPTS:
        if not remaining.size:
            break
        # solve for some modes of each remaining point
        orders, caps = np.array(attempts).T
        which = np.repeat(remaining, len(orders))
        points = take(t, which)
        modes = _Modes.of(_ORDER[order[remaining]][:, orders].ravel(), k)
        with_cap = np.tile(caps > 0, remaining.size)
        z = _followed(points, modes, with_cap, k, steps, start[:, which])
        values, memory, holds, known = _checked(z, points, modes, k)

        # keep the first admissible result of each point
        admissible = holds.reshape(-1, len(orders))
        found = admissible.any(axis=1)
        first = len(orders) * np.arange(remaining.size) + admissible.argmax(axis=1)
        kept = first[found]
        done = remaining[found]
        remaining = remaining[~found]
        parts.append(_Part(done, kept, modes, *known))
        c[:, done] = values[:, kept]
        gamma[done], cap[done] = memory[:, kept]
        scale[done] = z[3, kept]
        if len(parts) == 1:
            _learn(order, start, which, np.flatnonzero(~found), z, *known)
    return Returned(c, gamma, cap, scale, remaining, lambda: _slopes(parts, n))


def _learn(
    order: NDArray[np.intp],
    start: Array,
    points: NDArray[np.intp],
    wrong: NDArray[np.intp],
    z: Array,
    state: _State,
    residual: _Residual,
) -> None:
    """Begin the second attempt at the solutions of the first one that are not admissible.

    Where c2 exceeds c1 on a face, it is the one on the edge of both.
    """
    solved = wrong[residual.error[wrong] <= _SOLVED]
    at = points[solved]
    start[:, at] = z[:, solved]
    c1, _, c2 = state.c[:, solved]
    above = (order[at] == 0) & (c2 > c1)
    order[at[above]] = _TO_MAJOR


def _checked(
    z: Array,
    t: Points,
    modes: _Modes,
    k: Constants,
) -> tuple[Array, Array, NDArray[np.bool_], tuple[_State, _Residual]]:
    """Return stresses (3, n), memory (2, n), where they are admissible, state and residual."""
    # evaluate the solution
    trial = modes.trial(t, z[3], k)
    state = _state(z, trial, modes, k)
    residual = _residual(z, t, trial, k, state)
    L, C, s, scale = z
    c1, c3, c2 = state.c

    # check the order; as far as meeting stresses were apart, the multipliers of their faces differ
    round_off = 10 * ROUND_OFF * trial.size
    first, last, middle = trial.c
    faces = k.mu * L
    caps = 4 * k.mu / k.cap_slope * state.q * C
    on_minor = middle - last <= (1 + s) * faces + (2 * k.lode - 1) * caps + round_off
    on_major = first - middle <= (1 - s) * faces + (2 - k.lode) * caps + round_off
    above_minor = c2 >= c3 - round_off
    below_major = c1 >= c2 - round_off
    on_face = below_major & above_minor
    ordered = np.choose(modes.number, (on_face, on_minor, on_major))

    # collect stresses and memory, and accept solutions in the right order
    c2 = np.clip(c2, c3, np.maximum(c1, c3))
    rate = t.faster / scale
    cap = k.hardened(t.cap, 2 * state.p * C * rate)[0]
    solved = residual.error <= _SOLVED
    holds = solved & (c1 >= c3) & ordered
    memory = np.array((t.gamma + L * rate, cap))
    stress = np.array((c1, c2, c3))
    return stress, memory, holds, (state, residual)


def _slopes(parts: list[_Part], n: int) -> tuple[Array, Array]:
    """Return d c / d trial, (3, 3, n), at a fixed scale; d c / d ln(scale), (3, n), at a trial."""
    by_trial = np.zeros((3, 3, n))
    by_scale = np.zeros((3, n))
    for part in parts:
        indices, kept, modes, state, residual = part
        if kept.size < modes.number.size:
            modes, state, residual = take((modes, state, residual), kept)
        units = np.repeat(np.eye(3)[:, :, None], indices.size, axis=2)
        direct = state.by_trial(*modes.averaged(units))

        # solve for the changes of the variables by c1, c3 and c2 of the trial, and by the scale
        right = np.zeros((4, 3, indices.size))
        right[:3] = _rows(direct, residual).swapaxes(0, 1)
        right[3, :2] = residual.to_memory
        matrix = _matrix(state, residual)
        changes = _solve(matrix, right)  # (4, 3, n)

        # change the stresses with them
        change = -np.einsum("mvn,vsn->msn", changes, state.slopes.c)
        change = change[:, _SORTED]
        by_scale[:, indices] = change[3]
        for i, own, stresses in zip(_SORTED, change, direct.c):
            by_trial[:, i, indices] = own + stresses[_SORTED]
    return by_trial, by_scale
