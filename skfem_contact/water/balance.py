"""Heads at which the water of every node balances, with a free surface and seepage faces."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags
from skfem import CellBasis

from ..errors import NotConverged, warn
from ..solvers.direct import DirectSolver
from .boundary import NodalConditions, nodes_on
from .darcy import DarcyFlow
from .retention import Laws

logger = logging.getLogger("skfem_contact")

#: The transition between wet and dry is so many times as wide at first and shrinks by this ratio;
#: the square root of the ratio is tried where Newton's method fails. Rectangular dams of 200 to
#: 13,000 triangles take 10 to 22 iterations in all with a ratio of 4, 22 to 38 with 2. The flow is
#: integrated finer before the ratio falls to the patience: 50 random grounds with rain, wells and
#: drains take 38 iterations in the mean, 49 with a patience of 1.5.
_WIDEST = 16.0
_RATIO = 4.0
_LEAST_RATIO = 1.02
_PATIENCE = 2.0
#: Unbalanced water over what enters, at the end, at the widths before it, and in a step in time.
_BALANCED = 1e-10
_NEARLY = 1e-2
_IN_STEP = 1e-9
#: Multiples of the narrowest width that are tried where the water does not balance with the
#: requested one.
_WIDER = (1.0, 1.25, 1.6, 2.0, 4.0)
#: The line search accepts a residual below the worst of the last ones. Of 84 flows through zones
#: 1e-8 to 1e8 times as permeable, with ramps down to a hundredth of an element and van Genuchten's
#: curve, all balance with a memory of 5 and two do not with 1; shorter steps or fewer iterations
#: lose one or two as well.
_MEMORY = 5
_SHORTEST = 1.0 / 64.0
_DECREASE = 1e-4
_ITERATIONS = 25


class Balance(NamedTuple):
    """Heads in balance, inflow at the nodes, and relative permeability at integration points."""

    head: ndarray
    inflow: ndarray
    relative: ndarray
    iterations: tuple[int, ...]


@dataclass(frozen=True)
class _State:
    """Heads, nodes of seepage faces through which water leaves, and iterations of each width."""

    head: ndarray
    leaking: ndarray
    iterations: tuple[int, ...] = ()


class Unbalanced(RuntimeError):
    """Failure of Newton's method."""


class WaterBalance:
    """Newton's method for the heads; at seepage faces either the pressure or the flow is zero.

    The matrix `tie`, (N, N), gives the heads of all nodes from those of the nodes that are not tied
    to others. What enters is the given supply, more where the head is held, and less at seepage
    faces.
    """

    def __init__(
        self,
        flow: DarcyFlow,
        given: NodalConditions,
        tie: csr_matrix,
        coordinates: ndarray,
    ) -> None:
        self.flow = flow
        self.given = given
        self.tie = tie
        diagonal = (tie.T @ flow.saturated @ tie).diagonal()
        # Nodes that are tied, or in no porous element, are idle.
        self._idle = diagonal == 0.0
        self._diagonal = np.where(self._idle, diagonal.max(), diagonal)
        self._face = given.face & ~self._idle
        self._solver = DirectSolver(coordinates, np.arange(len(diagonal)))
        self._tolerance = 1e-12 * float(np.ptp(coordinates, axis=1).max())

    def solve(self, laws: Laws, finer: Callable[[], DarcyFlow]) -> Balance:
        """Return the heads, or raise NotConverged; warn of a transition wider than requested.

        Where the water does not balance at the first attempts, the flow may become the finer one.
        """
        # Begin with saturated ground.
        given = self.given
        head = np.where(given.held, given.head, np.nanmax(given.known))
        now = self._newton(_State(head, self._face), (), _BALANCED)
        saturated = now.head >= self.flow.elevation - self._tolerance
        if saturated[self.flow.dofs].all():
            return self._balance(now, ())
        # Narrow the transition between wet and dry.
        reached, now = self._narrowed(now, laws, _WIDEST * _RATIO, _PATIENCE)
        if reached > 1.0:
            reached, now = self._slowly(now, laws, reached, finer())
        if reached > 1.0:
            warn(
                f"the transition between wet and dry ground is {reached:.3g} times as wide as "
                "asked for; with a narrower one the water did not balance; refine the mesh at the "
                "free surface"
            )
        return self._balance(now, _softer(laws, reached))

    def step(
        self,
        flow: DarcyFlow,
        given: NodalConditions,
        head: ndarray,
        leaking: ndarray,
        laws: Laws,
    ) -> tuple[Balance, ndarray]:
        """Return the balance of a flow near to heads, and leaking nodes, or raise Unbalanced."""
        new = copy(self)
        new.flow = flow
        new.given = given
        new._face = given.face & ~self._idle
        begin = self.tie @ np.where(given.held, given.head, head)
        now = new._newton(_State(begin, leaking & new._face), laws, _IN_STEP)
        return new._balance(now, laws), now.leaking

    def _balance(self, now: _State, laws: Laws) -> Balance:
        relative = self.flow.relative(now.head, laws)[0]
        inflow = self.tie.T @ self.flow.inflow(now.head, relative)
        return Balance(now.head, inflow, relative, now.iterations)

    def _supply(self, head: ndarray) -> ndarray:
        """Return the water that enters the free nodes, less the water that drains take."""
        return np.asarray(self.tie.T @ (self.given.supply - self.given.taken(head)))

    def _narrowed(
        self,
        now: _State,
        laws: Laws,
        reached: float,
        least: float,
    ) -> tuple[float, _State]:
        """Return the narrowest transition over the requested one, and heads near its balance.

        Its width shrinks by ratios down to the least one.
        """
        ratio = _RATIO
        while reached > 1.0 and ratio > least:
            wider = max(1.0, reached / ratio)
            tolerance = _BALANCED
            if wider > 1.0:
                tolerance = _NEARLY
            try:
                now = self._newton(now, _softer(laws, wider), tolerance)
                reached = wider
            except Unbalanced as failed:
                logger.info(
                    "seepage: no balance with a transition %.3g times as wide: %s", wider, failed
                )
                now = replace(now, iterations=(*now.iterations, _ITERATIONS))
                ratio = float(np.sqrt(ratio))
        return reached, now

    def _slowly(
        self,
        now: _State,
        laws: Laws,
        reached: float,
        finer: DarcyFlow,
    ) -> tuple[float, _State]:
        """Narrow the transition in smaller steps, or widen it, with the finer flow or this one."""
        for flow in (finer, self.flow):
            self.flow = flow
            narrowest, heads = self._narrowed(now, laws, reached, _LEAST_RATIO)
            if narrowest <= 1.0:
                return narrowest, heads
        self.flow = finer
        return self._instead(heads, laws, narrowest)

    def _instead(self, now: _State, laws: Laws, reached: float) -> tuple[float, _State]:
        """Return a wider transition for which the water balances, and the heads."""
        for wider in reached * np.array(_WIDER):
            try:
                return float(wider), self._newton(now, _softer(laws, float(wider)), _BALANCED)
            except Unbalanced as error:
                failed = error
        raise NotConverged(
            f"the water does not balance: {failed}; give a wider transition between wet and dry in "
            "retention=, or refine the mesh where the free surface is",
            now.head,
        )

    def _newton(self, now: _State, laws: Laws, tolerance: float) -> _State:
        """Return the state in which the water balances, or raise Unbalanced."""
        flow = self.flow
        head = now.head
        leaking = now.leaking
        residuals: list[float] = []
        # In saturated ground faces may open and close node by node.
        if laws:
            most = _ITERATIONS
        else:
            most = _ITERATIONS + int(self._face.sum())
        for iteration in range(1, most + 1):
            # Take a step with pressures of zero at leaking nodes.
            fixed = self.given.held | leaking | self._idle
            begin = self.tie @ np.where(leaking, flow.elevation, head)
            head = self._step(begin, fixed, laws, residuals)
            # Measure the water out of balance.
            relative = flow.relative(head, laws)[0]
            inflow = self.tie.T @ flow.inflow(head, relative)
            round_off = flow.round_off(head, relative)
            beyond = inflow - self._supply(head)
            unbalanced = float(np.linalg.norm(beyond[~fixed]))
            accepted = max(tolerance * flow.scale(head, inflow), float(np.linalg.norm(round_off)))
            # Close nodes at which water would enter, and open nodes under pressure.
            opening = self._face & (head > flow.elevation + self._tolerance)
            leaks = np.where(leaking, beyond <= round_off, opening)
            steady = bool((leaks == leaking).all())
            if steady and unbalanced <= accepted:
                return _State(head, leaking, (*now.iterations, iteration))
            leaking = leaks
        if not steady:
            raise Unbalanced("the seepage faces open and close again and again")
        raise Unbalanced(
            f"{unbalanced:.1g} of {np.linalg.norm(inflow):.2g} are too much after {most} iterations"
        )

    def _step(self, head: ndarray, fixed: ndarray, laws: Laws, residuals: list[float]) -> ndarray:
        """Take a step of Newton's method, halved until less water is out of balance."""
        flow = self.flow

        def moved(share: float) -> ndarray:
            return np.asarray(self.tie @ flow.moved(head, share * change, laws))

        def unbalanced(head: ndarray) -> ndarray:
            inflow = self.tie.T @ flow.inflow(head, flow.relative(head, laws)[0])
            return np.where(fixed, 0.0, inflow - self._supply(head))

        before = unbalanced(head)
        residuals.append(float(np.linalg.norm(before)))
        # Solve for the free nodes; fixed nodes keep a diagonal.
        taking = diags(self.given.taking(head))
        by_head = flow.tangent(head, *flow.relative(head, laws)) + taking
        tangent = self.tie.T @ by_head @ self.tie
        free = diags(np.where(fixed, 0.0, 1.0))
        matrix = free @ tangent + diags(np.where(fixed, self._diagonal, 0.0))
        change = self.tie @ self._solver.factor(matrix.tocsr())(-before)
        # Halve the step.
        worst = max(residuals[-_MEMORY:])
        share = 1.0
        while share > _SHORTEST:
            if np.linalg.norm(unbalanced(moved(share))) <= (1.0 - _DECREASE * share) * worst:
                break
            share *= 0.5
        return moved(share)


def _softer(laws: Laws, factor: float) -> Laws:
    return [(part, law.softer(factor)) for part, law in laws]


def warn_of_dry_wells(basis: CellBasis, wells: Mapping[str, float], head: ndarray) -> None:
    """Report wells whose level lies below the top of their screen."""
    for name in wells:
        nodes = nodes_on(basis, name)
        level = head[nodes[0]]
        top = basis.mesh.p[-1, nodes].max()
        if level < top:
            warn(
                f"well '{name}' falls dry: its level, {level:.4g}, lies below the top of its "
                f"screen, {top:.4g}, where water would flow freely; pump less, or give the level "
                "as its head with seepage_face="
            )
