r"""Interior points for the programs of both bounds; the factor of strength moves along.

.. math:: \max \theta: \quad A \sigma = f_0 + \theta f_1, \quad s = h(F) - \theta e - G(F) \sigma
\in Q

with multipliers y of equilibrium and z in Q of the strength.  Steps of Mehrotra in the scaling of
Nesterov and Todd lead to normal equations :math:`A H^{-1} A^T`, a stiffness matrix.  For a limit
load :math:`\theta` is its multiplier and e = 0.  For a factor of safety it is the share e of
strength that is left, which is bounded where multipliers are not (friction alone resists any load),
and F is moved until none is left.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from .elements import Program
from .strength import FLAT

MOST = 80
_SIGNS = np.array([1.0, -1.0, -1.0])
#: Largest factor of the search: a structure with so much less strength does not depend on it.
HIGHEST = 100.0
#: Distance from the aim of which the gap keeps a share: points at the surface of their cones cannot
#: follow the factor.
_CENTRED = 0.1
#: Share of the way to the surface of the cones that a step goes.
_STEP = 0.98
#: Distance from the aim, as a share of the accuracy, at which the factor is right.
_HIT = 0.1
#: Residuals of the normalisation and of the strength, also as a share of each, below which
#: certificates do the rest.
_FEASIBLE = (1e-4, 1e-5)
#: Round-off of stresses, as a share of the largest, by which those of no strength may exceed it.
_ROUND_OFF = 1e-13
#: Largest change of the factor in a step.
_CHANGE = 0.2
#: Relative residual at which solutions of the normal equations are refined no more, and how often
#: they are.
_REFINED, _REFINEMENTS = 1e-9, 3
#: Least size of that compliance, as a share of the median, where the strength is so many times the
#: median: a pile in the ground (c = 7,500 and 32) has so little that round-off rules (0 and .01: no
#: lower bound; .1: 1.347, 1.485).
_AMONG_WEAK, _STRONG = 0.1, 10.0
#: Share of its depth within the cone that a multiplier keeps where it is made to follow from the
#: strains.
_DEEP = 0.5
#: Steps without progress after which round-off is said to rule.
_STALLED = 2


@dataclass(frozen=True)
class Solution:
    """Last iterate."""

    theta: float  # objective
    factor: float
    stress: ndarray  # (n_points, 3)
    velocity: ndarray  # (m,)
    metric: ndarray  # inverse Hessian at the points, (n_points, 3, 3): compliance of the stresses
    inner: list[ndarray]  # velocities of earlier iterates, farther inside of the flow rule
    iterations: int  # number of systems that were factored


@dataclass(frozen=True)
class Goal:
    """Aim of an iteration."""

    factor: float  # of strength, to begin with or to stay at
    aim: float  # objective at which the factor is right
    moving: bool  # the factor is sought; otherwise it stays, and the load is multiplied
    # compliance to the mean stress where strength does not depend on it: then an augmented
    # Lagrangian
    volume: float
    fixed: float = 1.0  # factor of strength that is not reduced
    far: bool = True  # stresses begin at the size that the fixed loads need


def solve(program: Program, goal: Goal, accuracy: float) -> Solution:
    """Iterate until the gap is this share of the objective, or round-off rules."""
    path = _Path(program, goal, accuracy)
    while path.iterations < MOST and path.F <= HIGHEST and not path.arrived():
        try:
            path.step()
        except (ArithmeticError, np.linalg.LinAlgError):  # no more accuracy to be had
            break
    return path.solution()


class _Path:
    """Iterates, and data of a step."""

    def __init__(self, program: Program, goal: Goal, accuracy: float) -> None:
        self.program, self.goal, self.F, self.accuracy = program, goal, goal.factor, accuracy
        self.moving = goal.moving
        cones = self.cones = program.cones
        n = program.n_points
        self.second = cones.at[n:]
        self._set_factor(self.F)
        least = 1e-3 * (float(np.median(self.h)) or 1.0)
        self.e = (self.h + least) * self.moving
        self.f0 = program.dead + program.live * self.moving
        self.f1 = program.live * (not self.moving)
        self.theta, self.y, self.sigma = 0.0, np.zeros(program.size), np.zeros((n, 3))
        self.s, self.z = np.zeros((2, len(cones.at), 3))
        self.s[:, 0] = self.h + least + (self._carried() if goal.far and not self.moving else 0.0)
        self.z[:, 0] = 1.0 / len(cones.at) / (self.h + least)
        self.metric = np.zeros((n, 3, 3))
        self.inner: list[ndarray] = []
        self.iterations, self._stalled, self._best = 0, 0, np.inf
        # where z follows from the strains alone: all of it, or all but its first component
        one = np.ones(n, bool)
        one[self.second] = False
        self.steep = np.abs(cones.k[:n]).max(axis=1) * 2 >= FLAT
        self.flat_second = ~self.steep[self.second]
        self.soft = one & ~self.steep

    def _carried(self) -> float:
        """Return the largest elastic stress under fixed loads: with less to begin with, steps
        remain short.

        A block of 2.4 times the cohesion of the ground takes 80 iterations and finds nothing
        without it, 8 to 18 with it; one of .036 times 38 and 26 without it, 13 and 11 with it.
        """
        whole = np.broadcast_to(np.eye(3), (self.program.n_points, 3, 3))
        velocity = (
            self.program.factor(whole)(self.program.dead) if self.program.dead.any() else self.y
        )
        return float(np.abs(self.program.strains(velocity)).max(initial=0.0))

    def _set_factor(self, factor: float) -> None:
        self.F = factor
        self.G, self.h, self.dh, self.dq = self.cones.at_factor(factor, self.goal.fixed)

    def gathered(self, x: ndarray) -> ndarray:
        """Return the sum over the cones of every point."""
        n = self.program.n_points
        total = x[:n].copy()
        np.add.at(total, self.second, x[n:])
        return total

    @property
    def away(self) -> float:
        """Distance of the objective from its aim."""
        return abs(self.theta - self.goal.aim) if self.moving else 0.0

    def residuals(self) -> None:
        """Compute residuals of equilibrium, strength, flow rule and normalisation."""
        program, s, z = self.program, self.s, self.z
        self.rc = s + _times(self.G, self.sigma[self.cones.at])
        self.rc[:, 0] += self.theta * self.e - self.h
        self.rp = program.forces(self.sigma) - self.f0 - self.theta * self.f1
        self.rd = program.strains(self.y) + self.gathered(_by(self.G, z))
        self.rt = float(-1.0 - self.f1 @ self.y + self.e @ z[:, 0])
        self.gap = float((s * z).sum())

    def arrived(self) -> bool:
        """Return True if the gap is small, or no progress is made any more."""
        self.residuals()
        size = 1.0 if self.moving else max(self.theta, 1e-9)
        round_off = _ROUND_OFF * np.abs(self.sigma).max(initial=0.0)
        within = _depth(self.s - self.rc) > -_FEASIBLE[1] * np.minimum(self.h, 1.0) - round_off
        feasible = (
            abs(self.rt) < _FEASIBLE[0] and np.abs(self.rc).max() < _FEASIBLE[1] and within.all()
        )
        if self.gap < self.accuracy * size and self.away < _HIT * self.accuracy and feasible:
            return True
        worth = self.gap / size + self.away + abs(self.rt)
        self._stalled = 0 if worth < 0.9 * self._best or worth > 1e-2 else self._stalled + 1
        self._best = min(self._best, float(worth))
        if self.gap < size:
            self.inner.append(self.y)
        return self._stalled > _STALLED

    def step(self) -> None:
        """Take a predictor and a corrector."""
        self.iterations += 1
        scaled = self.scaled = _scaling(self.s, self.z)
        self._factor()
        n_cones, point = len(self.s), scaled.point
        mu = self.gap / n_cones
        first = self._direction(-point)
        a = min(1.0, _longest_step(self.s, first.s), _longest_step(self.z, first.z))
        right = -_product(point, point) - _product(
            _times(scaled.inverse, first.s), _times(scaled.W, first.z)
        )
        right[:, 0] += max(max((1 - a) ** 3, 1e-8) * mu, min(mu, _CENTRED * self.away / n_cones))
        d = self._direction(_quotient(right, point))
        a = min(1.0, _STEP * min(_longest_step(self.s, d.s), _longest_step(self.z, d.z)))
        self.sigma, self.y, self.theta = (
            self.sigma + a * d.sigma,
            self.y + a * d.y,
            self.theta + a * d.theta,
        )
        self.s, self.z = self.s + a * d.s, self.z + a * d.z
        if d.factor:
            self._set_factor(self.F + a * d.factor)
        self._mend()

    def _factor(self) -> None:
        """Factor the normal equations; compute responses to the objective and to the factor."""
        scaled, G = self.scaled, self.G
        H = self.gathered(np.matmul(np.matmul(G.transpose(0, 2, 1), scaled.squared), G))
        trace = np.trace(H, axis1=1, axis2=2)[:, None, None]
        H += trace * 1e-13 * np.eye(3)
        volume = self.program.volume[self.soft]
        strong = self.h[: self.program.n_points] > _STRONG * np.median(self.h)
        size = np.maximum(trace, _AMONG_WEAK * np.median(trace) * strong[:, None, None])[self.soft]
        H[self.soft] += self.goal.volume * size * volume[:, :, None] * volume[:, None, :] / 2
        if not np.isfinite(H).all():
            raise ArithmeticError("a point has reached the surface of its cone")
        self.metric = np.linalg.inv(H)
        self._inverse = self.program.factor(self.metric)
        self._pull = self.gathered(_by(G, scaled.squared[:, :, 0] * self.e[:, None]))
        r = _times(self.metric, self._pull)
        self._y2 = self._solve(self.program.forces(r) + self.f1)
        self._s2 = r - _times(self.metric, self.program.strains(self._y2))
        self._pivot = (
            (self.e**2 * scaled.squared[:, 0, 0]).sum()
            - (self._pull * self._s2).sum()
            + self.f1 @ self._y2
        )
        self._by_factor = None
        if self.moving and self.iterations > 4 and self.gap < 1.0:
            growth = self.dq * (self.cones.k * self.sigma[self.cones.at]).sum(1) - self.dh
            u = scaled.squared[:, :, 0] * growth[:, None]
            turn = (self.dq * self.z[:, 0])[:, None] * self.cones.k
            self._by_factor = (*self._response(u, self.gathered(turn), 0.0, 0.0), u, growth, turn)

    def _solve(self, b: ndarray) -> ndarray:
        """Solve the normal equations, refined."""
        y = self._inverse(b)
        for _ in range(_REFINEMENTS):
            r = b - self.program.forces(_times(self.metric, self.program.strains(y)))
            if np.abs(r).max() < _REFINED * np.abs(b).max():
                break
            y = y + self._inverse(r)
        return y

    def _response(
        self, u: ndarray, rd: ndarray, rp: ndarray | float, rt: float
    ) -> tuple[ndarray, ndarray, float]:
        """Return changes of stress, velocity and objective that remove some residuals."""
        r = _times(self.metric, -rd - self.gathered(_by(self.G, u)))
        y = self._solve(self.program.forces(r) + rp)
        s = r - _times(self.metric, self.program.strains(y))
        theta = (-rt - self.e @ u[:, 0] - (self._pull * s).sum() + self.f1 @ y) / self._pivot
        return s - theta * self._s2, y - theta * self._y2, theta

    def _direction(self, q: ndarray) -> _Direction:
        """Return Newton's direction to the scaled point plus q."""
        scaled = self.scaled
        u = _times(scaled.squared, self.rc + _times(scaled.W, q))
        sigma, y, theta = self._response(u, self.rd, self.rp, self.rt)
        factor, rc, turn = 0.0, self.rc, None
        if self._by_factor is not None:
            by_sigma, by_y, by_theta, by_u, growth, by_turn = self._by_factor
            factor = float(
                np.clip(
                    (self.goal.aim - self.theta - theta) / by_theta,
                    -_CHANGE * self.F,
                    _CHANGE * self.F,
                )
            )
            sigma, y, theta = (
                sigma + factor * by_sigma,
                y + factor * by_y,
                theta + factor * by_theta,
            )
            u, rc, turn = u + factor * by_u, rc.copy(), factor * by_turn
            rc[:, 0] += factor * growth
        change = _times(self.G, sigma[self.cones.at])
        change[:, 0] += self.e * theta
        z = u + _times(scaled.squared, change)
        self._follow_flow(z, -self.rd - self.program.strains(y), turn)
        return _Direction(sigma, y, theta, -rc - change, z, factor)

    def _follow_flow(self, z: ndarray, strain: ndarray, turn: ndarray | None) -> None:
        """Compute z from the strains: the flow rule then holds to round-off."""
        n, cones, second = self.program.n_points, self.cones, self.second
        if turn is not None:
            strain = strain - self.gathered(turn)
        at = n + np.flatnonzero(self.flat_second)
        z[at, 0] = (strain[cones.at[at]] * self.program.volume[cones.at[at]]).sum(1)
        strain = strain.copy()
        np.subtract.at(strain, second, _by(self.G[n:], z[n:]))
        q = np.where(self.steep, (self.G[:n, 0] * self.program.volume).sum(1), 1.0)
        z[:n, 0] = np.where(self.steep, (strain * self.program.volume).sum(1) / q, z[:n, 0])
        left = strain - self.G[:n, 0] * z[:n, :1]
        R = cones.R[:n]
        size = (R**2).sum(2)  # rows are orthogonal
        z[:n, 1:] = -np.einsum("nij,nj->ni", R, left) / size

    def _mend(self) -> None:
        """Restore the flow rule at points deep enough within their cones: short steps leave it
        violated elsewhere.
        """
        n, change = self.program.n_points, np.zeros_like(self.z)
        self._follow_flow(
            change, -self.program.strains(self.y) - self.gathered(_by(self.G, self.z)), None
        )
        fits = _depth(self.z + change) > _DEEP * _depth(self.z)
        whole = fits[:n].copy()
        np.logical_and.at(whole, self.second, fits[n:])
        self.z += np.where(whole[self.cones.at, None], change, 0.0)

    def solution(self) -> Solution:
        """Return the last iterate."""
        return Solution(
            self.theta, self.F, self.sigma, self.y, self.metric, self.inner, self.iterations
        )


class _Direction(NamedTuple):
    sigma: ndarray
    y: ndarray
    theta: float
    s: ndarray
    z: ndarray
    factor: float


def _depth(z: ndarray) -> ndarray:
    """Return the distance from the surface of the cones, (n,)."""
    return z[:, 0] - np.linalg.norm(z[:, 1:], axis=1)


def _times(matrices: ndarray, x: ndarray) -> ndarray:
    """Multiply matrices (n, 3, 3) by vectors (n, 3)."""
    return np.einsum("nij,nj->ni", matrices, x)


def _by(matrices: ndarray, x: ndarray) -> ndarray:
    """Multiply transposed matrices (n, 3, 3) by vectors (n, 3)."""
    return np.einsum("nij,ni->nj", matrices, x)


def _determinant(x: ndarray) -> ndarray:
    """Return s_0^2 - s_1^2 - s_2^2, factored so that little is lost at the surface."""
    radius = np.hypot(x[:, 1], x[:, 2])
    return (x[:, 0] - radius) * (x[:, 0] + radius)


def _product(x: ndarray, y: ndarray) -> ndarray:
    """Return the product of Jordan's algebra."""
    return np.column_stack([(x * y).sum(1), x[:, :1] * y[:, 1:] + y[:, :1] * x[:, 1:]])


def _quotient(y: ndarray, x: ndarray) -> ndarray:
    """Return the vectors whose product with `x` is `y`."""
    first = (_SIGNS * x * y).sum(1) / _determinant(x)
    return np.column_stack([first, (y[:, 1:] - first[:, None] * x[:, 1:]) / x[:, :1]])


def _longest_step(x: ndarray, d: ndarray) -> float:
    """Return the largest step from inner points x in the directions d that leaves all of them
    inside.
    """
    a, b, c = _determinant(d), (_SIGNS * x * d).sum(1), _determinant(x)
    inside = b * b - a * c
    below = np.sqrt(np.maximum(inside, 0.0)) - b
    leaves = (inside >= -1e-12 * b * b) & (below > 0)  # along an axis it is zero, to round-off
    return float(np.min(c[leaves] / below[leaves], initial=np.inf))


class _Scaling(NamedTuple):
    """Symmetric W with W z = W^-1 s, its inverse, the inverse squared, (n, 3, 3), and the point W z
    (n, 3).
    """

    W: ndarray
    inverse: ndarray
    squared: ndarray
    point: ndarray


def _scaling(s: ndarray, z: ndarray) -> _Scaling:
    """Return the scaling of Nesterov and Todd of inner points s and z; ArithmeticError for other
    points.
    """
    squares = _determinant(s), _determinant(z)
    if not all((square > 0).all() for square in squares):
        raise ArithmeticError("a point has reached the surface of its cone")
    size_s, size_z = np.sqrt(squares)
    unit_s, unit_z = s / size_s[:, None], z / size_z[:, None]
    w = (unit_s + _SIGNS * unit_z) / np.sqrt(2 * (1 + (unit_s * unit_z).sum(1)))[:, None]
    V = np.empty((len(s), 3, 3))
    V[:, 0], V[:, 1:, 0] = w, w[:, 1:]
    V[:, 1:, 1:] = np.eye(2) + w[:, 1:, None] * w[:, None, 1:] / (1 + w[:, 0])[:, None, None]
    ratio = np.sqrt(size_s / size_z)[:, None, None]
    W, turned = ratio * V, _SIGNS * w
    squared = (2 * turned[:, :, None] * turned[:, None] - np.diag(_SIGNS)) / ratio**2
    return _Scaling(W, V * np.outer(_SIGNS, _SIGNS) / ratio, squared, np.einsum("nij,nj->ni", W, z))
