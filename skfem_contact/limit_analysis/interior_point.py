r"""Interior points for the programs of both bounds; the factor of strength moves along.

.. math:: \max \theta: \quad A \sigma = f_0 + \theta f_1, \quad s = h(F) - \theta e - G(F) \sigma
    \in Q

with multipliers y of equilibrium and z in Q of the strength. Steps of Mehrotra in the scaling of
Nesterov and Todd lead to normal equations :math:`A H^{-1} A^T`, a stiffness matrix. For a limit
load :math:`\theta` is its multiplier and e = 0. For a factor of safety it is the share e of
strength that remains, which is bounded where multipliers are not (friction alone resists any load),
and F is moved until none remains.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
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
#: Distance from the aim, as a share of the accuracy, at which the factor is right, and so the power
#: of the strength's residuals, by which the gap is wrong. In searches for a factor a limit of 1e-5
#: on these residuals themselves takes 1 to 7 more of 8 to 12 iterations. Bodies on joints need it:
#: a pile in the ground has an upper bound of 1.858 without, 1.562 with it.
_HIT = 0.1
#: Residual of the normalisation (and share of all first residuals), and of the strength (also as a
#: share of it), below which certificates do the rest.
_FEASIBLE = (1e-4, 1e-5)
#: Round-off of stresses, as a share of the largest, by which points of no strength may exceed it.
_ROUND_OFF = 1e-13
#: Largest change of the factor in a step.
_CHANGE = 0.2
#: Relative residual at which solutions of the normal equations are refined no more, and how often
#: they are, where bodies rest on joints. Without refinement brackets of such bodies stay open by a
#: half, and 7 of 150 stacks have no lower bound with 1e-9 and three times, 1 with these. Slopes and
#: footings gain nothing: refinement takes a sixth of their time.
_REFINED = 1e-12
_REFINEMENTS = 6
#: Least size of that compliance, as a share of the median, where the strength is so many times the
#: median: a pile in the ground (c = 7,500 and 32) has so little that round-off rules (0 and .01: no
#: lower bound; .1: 1.347, 1.485).
_AMONG_WEAK = 0.1
_STRONG = 10.0
#: Least stiffness of that compliance, as a share of the median of the joints: a block of clay that
#: slides on clay at 2.6 has so little that round-off rules (upper bound 11.8 with 0, 2.603 with
#: 1e-15, 2.6001 with 1e-13). That pile has 1.569 with 0, 1.544 with 1e-13; no lower bound with
#: 1e-12.
_BESIDE_JOINTS = 1e-13
#: Share of its depth within the cone that a multiplier keeps where it is made to follow from the
#: strains.
_DEEP = 0.5
#: Steps without progress after which round-off is said to rule.
_STALLED = 2
#: The next mesh begins from the first iterate after some whose gap is less than so many times the
#: objective, with residuals and a share of the first ones below the second number, mixed with a
#: share of the usual first iterate: later ones are too near to the surface of the cones. Slopes and
#: footings take .58 of the work (iterations times dofs to the 1.2); .60 without the mixture, .64
#: from the last iterate.
_EARLY = 2.0
_BALANCED = 0.2
_PASSED = 2
_MIXED = 0.1
#: Distance from convergence, in terms of the accuracy, at which an iteration that began from such
#: an iterate has failed and is repeated from the beginning.
_FAILED = 10.0
#: Iterations from such an iterate, at most: of 230 that began there 219 converged, in 5 to 17, and
#: the others stopped or stalled.
_MOST_NEAR = 30


class Iterate(NamedTuple):
    """Iterate that the iteration on another mesh may begin from."""

    theta: float  # objective
    factor: float
    stress: ndarray  # (n_points, 3)
    s: ndarray  # slack of the strength, within the cones, (n_cones, 3)
    z: ndarray  # its multipliers, within the cones, (n_cones, 3)


class Inner(NamedTuple):
    """Earlier iterate, farther inside of the strength and of the flow rule."""

    theta: float  # objective
    stress: ndarray  # (n_points, 3)
    velocity: ndarray  # (m,)


@dataclass(frozen=True)
class Solution:
    """Last iterate."""

    theta: float  # objective
    factor: float
    stress: ndarray  # (n_points, 3)
    velocity: ndarray  # (m,)
    metric: ndarray  # inverse Hessian at the points, (n_points, 3, 3): compliance of the stresses
    inner: list[Inner]  # earlier iterates
    iterations: int  # number of systems that were factored
    early: Iterate | None = None  # from which the next mesh may begin


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


def solve(
    program: Program,
    goal: Goal,
    accuracy: float,
    start: Iterate | None = None,
) -> Solution:
    """Iterate until the gap is this share of the objective, or round-off rules."""
    path = _Path(program, goal, accuracy)
    if start is None:
        path.run(MOST)
        return path.solution()
    # Begin from a given iterate; repeat from the beginning where that fails.
    path.begin(start)
    path.run(_MOST_NEAR)
    if path.remaining <= _FAILED * accuracy:
        return path.solution()
    again = solve(program, goal, accuracy)
    return replace(again, iterations=path.iterations + again.iterations)


class _Path:
    """Iterates, and data of a step."""

    def __init__(self, program: Program, goal: Goal, accuracy: float) -> None:
        self.program = program
        self.goal = goal
        self.accuracy = accuracy
        self.moving = goal.moving
        self.cones = program.cones
        n = program.n_points
        self.second = self.cones.at[n:]
        self._set_factor(goal.factor)

        # loads and share of strength that theta multiplies
        least = 1e-3 * (float(np.median(self.h)) or 1.0)
        self.e = (self.h + least) * self.moving
        self.f0 = program.dead + program.live * self.moving
        self.f1 = program.live * (not self.moving)

        # first iterate
        self.theta = 0.0
        self.y = np.zeros(program.size)
        self.sigma = np.zeros((n, 3))
        self.s, self.z = np.zeros((2, len(self.cones.at), 3))
        carried = 0.0
        if goal.far and not self.moving:
            carried = self._carried()
        self.s[:, 0] = self.h + least + carried
        self.z[:, 0] = 1.0 / len(self.cones.at) / (self.h + least)
        self.metric = np.zeros((n, 3, 3))
        self.inner: list[Inner] = []
        self.iterations = 0
        self._stalled = 0
        self._best = np.inf
        self._early: Iterate | None = None
        self._began_near = False
        self.unmoved = 1.0  # share of the first residuals that steps have left
        self.remaining = np.inf

        joints = [np.full(len(each.reduced), each.joint) for each in program.strengths]
        self.of_joints = np.concatenate(joints)

        # points where z follows from the strains alone: all of it, or all but its first component
        single = np.ones(n, bool)
        single[self.second] = False
        self.steep = np.abs(self.cones.k[:n]).max(axis=1) * 2 >= FLAT
        self.flat_second = ~self.steep[self.second]
        self.soft = single & ~self.steep

    def run(self, most: int) -> None:
        """Step until the end, or until round-off rules, at most so often."""
        while self.iterations < most and self.F <= HIGHEST and not self.arrived():
            try:
                with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # no solution
                    self.step()
            except (ArithmeticError, np.linalg.LinAlgError):  # no more accuracy to be had
                break

    def begin(self, start: Iterate) -> None:
        """Begin from an iterate, with the velocities whose strains fit its multipliers best.

        A share of the usual first iterate keeps it away from the surface of the cones (A. Skajaa,
        E. D. Andersen, Y. Ye, Mathematical Programming Computation 5 (2013) 1-25).
        """
        self._began_near = True
        self._set_factor(start.factor)
        self.theta = start.theta
        self.sigma = start.stress
        self.s = _MIXED * self.s + (1 - _MIXED) * start.s
        self.z = _MIXED * self.size * self.z + (1 - _MIXED) * start.z

        # A A^T y = -A G^T z
        whole = np.broadcast_to(np.eye(3), (self.program.n_points, 3, 3))
        flow = self.gathered(_by(self.G, self.z))
        self.y = -self.program.factor(whole)(self.program.forces(flow))

    def _carried(self) -> float:
        """Return the largest elastic stress under fixed loads.

        Steps remain short from less. A block of 2.4 times the cohesion of the ground takes 80
        iterations and finds nothing without it, 8 to 18 with it; one of .036 times 38 and 26
        without it, 13 and 11 with it.
        """
        velocity = self.y
        if self.program.dead.any():
            whole = np.broadcast_to(np.eye(3), (self.program.n_points, 3, 3))
            velocity = self.program.factor(whole)(self.program.dead)
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
    def size(self) -> float:
        """Objective that the gap is compared with."""
        return 1.0 if self.moving else max(self.theta, 1e-9)

    @property
    def away(self) -> float:
        """Distance of the objective from its aim."""
        if self.moving:
            return abs(self.theta - self.goal.aim)
        return 0.0

    def residuals(self) -> None:
        """Compute residuals of equilibrium, strength, flow rule and normalisation."""
        # r_c = s + G sigma + theta e - h
        sigma = self.sigma[self.cones.at]
        self.rc = self.s + _times(self.G, sigma)
        self.rc[:, 0] += self.theta * self.e - self.h

        # r_p = A sigma - f_0 - theta f_1
        forces = self.program.forces(self.sigma)
        self.rp = forces - self.f0 - self.theta * self.f1

        # r_d = A^T y + G^T z, and r_t = e z - f_1 y - 1
        multipliers = _by(self.G, self.z)
        flow = self.gathered(multipliers)
        self.rd = self.program.strains(self.y) + flow
        power = self.f1 @ self.y
        self.rt = float(-1.0 - power + self.e @ self.z[:, 0])
        products = self.s * self.z
        self.gap = float(products.sum())

    def arrived(self) -> bool:
        """Return True if the gap is small, or no progress is made any more."""
        self.residuals()
        size = self.size
        hit = self.away < _HIT * self.accuracy
        if self.gap < self.accuracy * size and hit and self._feasible():
            return True

        # count iterations without progress
        worth = self.gap / size + self.away + abs(self.rt) + self.unmoved
        self.remaining = float(worth)
        if worth < 0.9 * self._best or worth > 1e-2:
            self._stalled = 0
        else:
            self._stalled += 1
        self._best = min(self._best, self.remaining)
        if self.gap < size:
            self.inner.append(Inner(self.theta, self.sigma, self.y))
        self._keep_early()
        return self._stalled > _STALLED

    def _feasible(self) -> bool:
        """Return True if residuals are so small that certificates do the rest."""
        normal, strong = _FEASIBLE
        if not max(abs(self.rt), self.unmoved) < normal:
            return False
        round_off = _ROUND_OFF * np.abs(self.sigma).max(initial=0.0)
        slack = -strong * np.minimum(self.h, 1.0) - round_off
        if not (_depth(self.s - self.rc) > slack).all():
            return False
        if self.moving and not self.program.joints:
            error = np.abs(self.rc * self.z).sum()  # of the gap
            return bool(error < _HIT * self.accuracy)
        return bool(np.abs(self.rc).max() < strong)

    def _keep_early(self) -> None:
        """Keep the first iterate from which the next mesh may begin."""
        far = max(abs(self.rt), self.unmoved, self.away)
        passed = self._early is not None or self.iterations <= _PASSED
        if not passed and far < _BALANCED and self.gap < _EARLY * self.size:
            self._early = Iterate(self.theta, self.F, self.sigma, self.s, self.z)

    def step(self) -> None:
        """Take a predictor and a corrector."""
        self.iterations += 1
        scaled = self.scaled = _scaling(self.s, self.z)
        self._factor()
        n_cones = len(self.s)
        point = scaled.point
        mu = self.gap / n_cones

        # predictor to the surface of the cones, solved for beside the objective and the factor
        sides = [self._newton(-point), self._of_objective()]
        if self._turns():
            sides.append(self._of_factor())
        response, self._by_objective, *others = self._responses(sides)
        self._by_factor = others[0] if others else None
        first = self._direction(response)
        a = min(1.0, self._longest(first))

        # corrector: Mehrotra's second order, and the share of the gap that remains
        ds = _times(scaled.inverse, first.s)
        dz = _times(scaled.W, first.z)
        right = -_product(point, point) - _product(ds, dz)
        centring = max((1 - a) ** 3, 1e-8) * mu
        right[:, 0] += max(centring, min(mu, _CENTRED * self.away / n_cones))
        (response,) = self._responses([self._newton(_quotient(right, point))])
        d = self._direction(response)
        if not all(np.isfinite(part).all() for part in (d.sigma, d.y, d.s, d.z, d.theta)):
            raise ArithmeticError("the direction is not finite")

        # step, then restore the flow rule
        a = min(1.0, _STEP * self._longest(d))
        self.unmoved *= 1.0 - a
        self.sigma = self.sigma + a * d.sigma
        self.y = self.y + a * d.y
        self.theta = self.theta + a * d.theta
        self.s = self.s + a * d.s
        self.z = self.z + a * d.z
        if d.factor:
            self._set_factor(self.F + a * d.factor)
        self._mend()

    def _longest(self, d: _Direction) -> float:
        """Return the step to the surface of the cones."""
        return min(_longest_step(self.s, d.s), _longest_step(self.z, d.z))

    def _factor(self) -> None:
        """Factor the normal equations."""
        # H = sum G^T W^-2 G at every point, with a share of its trace
        squared = self.scaled.squared
        G = self.G
        GW = np.matmul(G.transpose(0, 2, 1), squared)  # (n_cones, 3, 3)
        H = self.gathered(np.matmul(GW, G))  # (n_points, 3, 3)
        trace = np.trace(H, axis1=1, axis2=2)
        trace = trace[:, None, None]
        H += trace * 1e-13 * np.eye(3)

        # compliance to the mean stress where strength does not depend on it
        volume = self.program.volume[self.soft]
        h = self.h[: self.program.n_points]
        strong = h > _STRONG * np.median(self.h)
        weakest = _AMONG_WEAK * np.median(trace)
        least = weakest * strong[:, None, None]
        size = self.goal.volume * np.maximum(trace, least)[self.soft]  # (n_soft, 1, 1)
        if self.of_joints.any():
            size = np.maximum(size, _BESIDE_JOINTS * np.median(trace[self.of_joints]))
        stiffness = size * volume[:, :, None]
        H[self.soft] += stiffness * volume[:, None, :] / 2
        if not np.isfinite(H).all():
            raise ArithmeticError("a point has reached the surface of its cone")
        self.metric = np.linalg.inv(H)  # (n_points, 3, 3)
        self._inverse = self.program.factor(self.metric)

    def _newton(self, q: ndarray) -> _Side:
        """Return the right-hand side of Newton's direction to the scaled point plus q."""
        scaled = self.scaled
        u = _times(scaled.squared, self.rc + _times(scaled.W, q))
        return _Side(u, self.rd, self.rp)

    def _of_objective(self) -> _Side:
        """Return the right-hand side of an objective that is less by one."""
        u = -self.scaled.squared[:, :, 0] * self.e[:, None]
        self._pull = self.gathered(_by(self.G, -u))
        return _Side(u, np.zeros_like(self.rd), self.f1)

    def _turns(self) -> bool:
        """Return True if the factor of strength changes in this step."""
        settled = self._began_near or self.iterations > 4
        return self.moving and settled and self.gap < 1.0

    def _of_factor(self) -> _Side:
        """Return the right-hand side of a factor that is greater by one."""
        sigma = self.sigma[self.cones.at]
        mean = _dot(self.cones.k, sigma)
        self._growth = self.dq * mean - self.dh
        u = self.scaled.squared[:, :, 0] * self._growth[:, None]
        self._turn = (self.dq * self.z[:, 0])[:, None] * self.cones.k
        return _Side(u, self.gathered(self._turn), np.zeros_like(self.rp))

    def _solve(self, b: ndarray) -> ndarray:
        """Solve the normal equations for b (n, m); on joints, refine as long as less is left."""
        y = self._inverse(b)
        if not self.program.joints:
            return y
        size = np.abs(b).max(axis=1)
        last = np.inf
        for _ in range(_REFINEMENTS):
            r = b - self.program.forces(self._stresses(self.program.strains(y)))
            left = (np.abs(r).max(axis=1) / np.maximum(size, 1e-300)).max()
            if left < _REFINED or left >= last:
                break
            y = y + self._inverse(r)
            last = left
        return y

    def _stresses(self, strains: Iterable[ndarray]) -> ndarray:
        """Return the stresses of some strains (n_points, 3), (n, n_points, 3)."""
        return np.stack([_times(self.metric, strain) for strain in strains])

    def _responses(self, sides: list[_Side]) -> list[_Response]:
        """Return changes of stress and velocity that remove some residuals, solved together."""
        # y of the normal equations; sigma = -H^-1 (r_d + G^T u + A^T y)
        r = self._stresses([-side.rd - self.gathered(_by(self.G, side.u)) for side in sides])
        y = self._solve(self.program.forces(r) + np.stack([side.rp for side in sides]))
        sigma = r - self._stresses(self.program.strains(y))

        # change of e z - f_1 y
        responses = []
        for side, s, v in zip(sides, sigma, y):
            power = self.e @ side.u[:, 0] + (self._pull * s).sum() - self.f1 @ v
            responses.append(_Response(side.u, s, v, float(power)))
        return responses

    def _direction(self, response: _Response) -> _Direction:
        """Return the direction of a response with changes of the objective and of the factor."""
        by_objective = self._by_objective
        theta = (self.rt + response.power) / by_objective.power
        sigma = response.sigma
        y = response.y
        u = response.u
        rc = self.rc
        factor = 0.0
        turn = None

        # change the factor so that the objective reaches its aim
        by_factor = self._by_factor
        if by_factor is not None:
            most = _CHANGE * self.F
            missing = self.goal.aim - self.theta - theta
            slope = by_factor.power / by_objective.power
            factor = float(np.clip(missing / slope, -most, most))
            sigma = sigma + factor * by_factor.sigma
            y = y + factor * by_factor.y
            theta = theta + factor * slope
            u = u + factor * by_factor.u
            turn = factor * self._turn
            rc = rc.copy()
            rc[:, 0] += factor * self._growth
        sigma = sigma - theta * by_objective.sigma
        y = y - theta * by_objective.y

        # s and z follow
        change = _times(self.G, sigma[self.cones.at])
        change[:, 0] += self.e * theta
        z = u + _times(self.scaled.squared, change)
        self._follow_flow(z, -self.rd - self.program.strains(y), turn)
        return _Direction(sigma, y, theta, s=-rc - change, z=z, factor=factor)

    def _follow_flow(self, z: ndarray, strain: ndarray, turn: ndarray | None) -> None:
        """Compute z from the strains: the flow rule then holds to round-off."""
        n = self.program.n_points
        volume = self.program.volume
        if turn is not None:
            strain = strain - self.gathered(turn)

        # second cones at points without friction, whose strain is taken off
        flat = n + np.flatnonzero(self.flat_second)
        point = self.cones.at[flat]
        z[flat, 0] = _dot(strain[point], volume[point])
        strain = strain.copy()
        np.subtract.at(strain, self.second, _by(self.G[n:], z[n:]))

        # first component by the change of volume with friction, the others by the shear
        q = self.G[:n, 0]
        per_volume = np.where(self.steep, _dot(q, volume), 1.0)
        change = _dot(strain, volume)
        z[:n, 0] = np.where(self.steep, change / per_volume, z[:n, 0])
        shear = strain - q * z[:n, :1]
        R = self.cones.R[:n]
        size = (R**2).sum(2)  # rows are orthogonal
        z[:n, 1:] = -np.einsum("nij,nj->ni", R, shear) / size

    def _mend(self) -> None:
        """Restore the flow rule at points deep within their cones; short steps violate it."""
        n = self.program.n_points
        change = np.zeros_like(self.z)
        flow = self.gathered(_by(self.G, self.z))
        missing = -self.program.strains(self.y) - flow
        self._follow_flow(change, missing, None)
        fits = _depth(self.z + change) > _DEEP * _depth(self.z)
        whole = fits[:n].copy()
        np.logical_and.at(whole, self.second, fits[n:])
        self.z += np.where(whole[self.cones.at, None], change, 0.0)

    def solution(self) -> Solution:
        """Return the last iterate."""
        return Solution(
            self.theta,
            self.F,
            stress=self.sigma,
            velocity=self.y,
            metric=self.metric,
            inner=self.inner,
            iterations=self.iterations,
            early=self._early,
        )


class _Side(NamedTuple):
    """Right-hand side of a direction."""

    u: ndarray  # of the strength, times W^-2
    rd: ndarray  # of the flow rule
    rp: ndarray  # of equilibrium


class _Response(NamedTuple):
    """Response to a right-hand side at a constant objective."""

    u: ndarray
    sigma: ndarray
    y: ndarray
    power: float  # change of the normalisation


class _Direction(NamedTuple):
    """Change of an iterate."""

    sigma: ndarray
    y: ndarray
    theta: float
    s: ndarray
    z: ndarray
    factor: float


def _depth(z: ndarray) -> ndarray:
    """Return the distance from the surface of the cones, (n,)."""
    return z[:, 0] - _radius(z)


def _times(matrices: ndarray, x: ndarray) -> ndarray:
    """Multiply matrices (n, 3, 3) by vectors (n, 3)."""
    return np.einsum("nij,nj->ni", matrices, x)


def _dot(x: ndarray, y: ndarray) -> ndarray:
    """Return the scalar products of vectors (n, 3), (n,)."""
    return np.einsum("ni,ni->n", x, y)


def _radius(x: ndarray) -> ndarray:
    """Return the distance from the axis of the cones, (n,)."""
    return np.sqrt(x[:, 1] ** 2 + x[:, 2] ** 2)


def _by(matrices: ndarray, x: ndarray) -> ndarray:
    """Multiply transposed matrices (n, 3, 3) by vectors (n, 3)."""
    return np.einsum("nij,ni->nj", matrices, x)


def _determinant(x: ndarray) -> ndarray:
    """Return s_0^2 - s_1^2 - s_2^2, factored so that little is lost at the surface."""
    radius = _radius(x)
    return (x[:, 0] - radius) * (x[:, 0] + radius)


def _product(x: ndarray, y: ndarray) -> ndarray:
    """Return the product of Jordan's algebra."""
    others = x[:, :1] * y[:, 1:] + y[:, :1] * x[:, 1:]
    return np.column_stack([_dot(x, y), others])


def _quotient(y: ndarray, x: ndarray) -> ndarray:
    """Return the vectors whose product with `x` is `y`."""
    first = _dot(_SIGNS * x, y) / _determinant(x)
    others = (y[:, 1:] - first[:, None] * x[:, 1:]) / x[:, :1]
    return np.column_stack([first, others])


def _longest_step(x: ndarray, d: ndarray) -> float:
    """Return the largest step from inner points x in directions d that leaves all inside.

    The determinant along the step is a t^2 + 2 b t + c.
    """
    a = _determinant(d)
    b = _dot(_SIGNS * x, d)
    c = _determinant(x)
    inside = b * b - a * c
    below = np.sqrt(np.maximum(inside, 0.0)) - b
    leaves = (inside >= -1e-12 * b * b) & (below > 0)  # along an axis it is zero, to round-off
    return float(np.min(c[leaves] / below[leaves], initial=np.inf))


class _Scaling(NamedTuple):
    """Symmetric W with W z = W^-1 s, (n, 3, 3), its inverse, that squared, and W z, (n, 3)."""

    W: ndarray
    inverse: ndarray
    squared: ndarray
    point: ndarray


def _scaling(s: ndarray, z: ndarray) -> _Scaling:
    """Return the scaling of Nesterov and Todd; ArithmeticError for points that are not inner."""
    squares = _determinant(s), _determinant(z)
    if not all((square > 0).all() for square in squares):
        raise ArithmeticError("a point has reached the surface of its cone")
    size_s, size_z = np.sqrt(squares)
    unit_s = s / size_s[:, None]
    unit_z = z / size_z[:, None]

    # V = [[w_0, w'], [w', I + w w' / (1 + w_0)]] of the point w between both
    cosine = _dot(unit_s, unit_z)
    w = (unit_s + _SIGNS * unit_z) / np.sqrt(2 * (1 + cosine))[:, None]
    last = w[:, 1:]
    below = (1 + w[:, 0])[:, None, None]
    V = np.empty((len(s), 3, 3))
    V[:, 0] = w
    V[:, 1:, 0] = last
    dyads = last[:, :, None] * last[:, None]  # (n, 2, 2)
    V[:, 1:, 1:] = np.eye(2) + dyads / below

    # W = V sqrt(|s| / |z|), whose inverse has other signs
    ratio = np.sqrt(size_s / size_z)[:, None, None]
    W = ratio * V
    inverse = V * np.outer(_SIGNS, _SIGNS) / ratio
    turned = _SIGNS * w
    outer = 2 * turned[:, :, None] * turned[:, None]
    squared = (outer - np.diag(_SIGNS)) / ratio**2
    return _Scaling(W, inverse, squared, point=_times(W, z))
