"""Heads at which the water of every node balances, with a free surface and seepage faces."""
from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags

from ..analysis.linear import DirectSolver
from ..analysis.newton import NotConverged
from .conditions import Conditions
from .darcy import DarcyFlow
from .retention import Retention

logger = logging.getLogger("skfem_contact")

#: Elements and their retention.
Laws = Sequence[tuple[ndarray, Retention]]

#: The transition between wet and dry is this many times as wide at first and shrinks by the ratio of the numbers;
#: the ratio is reduced where Newton's method fails. On rectangular dams of 200 to 13,000 triangles ratios of 2, 4 and
#: 16 take 22 to 38, 18 to 26 and 18 to 30 iterations in all.
_WIDEST, _RATIO, _LEAST_RATIO = 16.0, 4.0, 1.02
#: Unbalanced water over what enters, at the end and at the widths before it.
_BALANCED, _NEARLY = 1e-10, 1e-2
_ITERATIONS, _SHORTEST, _DECREASE = 25, 1.0 / 64.0, 1e-4


@dataclass(frozen=True)
class Balance:
    """Heads in balance.

    Attributes
    ----------
    head
        (N,).
    inflow
        Water that enters from outside at the nodes, (N,).
    relative
        Relative permeability at the integration points.
    iterations
        Of Newton's method at every width of the transition, the first with all ground saturated.
    """

    head: ndarray
    inflow: ndarray
    relative: ndarray
    iterations: tuple[int, ...]


class _Unbalanced(RuntimeError):
    """Newton's method did not converge."""


class WaterBalance:
    """Newton's method for the heads; at seepage faces either the pressure or the flow is zero.

    Parameters
    ----------
    flow, given
        Flow and conditions.
    tie
        Heads of all nodes from those of the nodes that are not tied to others, (N, N).
    places
        Of the nodes, (dim, N).
    """

    def __init__(self, flow: DarcyFlow, given: Conditions, tie: csr_matrix, places: ndarray) -> None:
        self.flow, self.given, self.tie = flow, given, tie
        diagonal = (tie.T @ flow.saturated @ tie).diagonal()
        self._idle = diagonal == 0.0  # tied nodes, and those of no porous element
        self._diagonal = np.where(self._idle, diagonal.max(), diagonal)
        self._face = given.face & ~self._idle
        self._solver = DirectSolver(places, np.arange(len(diagonal)))
        self._tolerance = 1e-12 * float(np.ptp(places, axis=1).max())

    def solve(self, laws: Laws) -> Balance:
        """Heads: saturated first, then with a transition between wet and dry that gets narrower.

        Raises
        ------
        NotConverged
            Not even small changes of the width lead to a balance.
        """
        given = self.given
        head = np.where(given.held, given.head, np.nanmax(given.head))
        head, leaking, count = self._newton(head, self._face, (), _BALANCED)
        iterations, wider, ratio = [count], _WIDEST * _RATIO, _RATIO
        if (head >= self.flow.elevation - self._tolerance)[self.flow.dofs].all():
            laws, wider = (), 1.0
        while wider > 1.0:
            width = max(1.0, wider / ratio)
            softer = [(part, law.softer(width)) for part, law in laws]
            try:
                head, leaking, count = self._newton(head, leaking, softer, _BALANCED if width == 1.0 else _NEARLY)
            except _Unbalanced as reason:
                count, ratio, width = _ITERATIONS, np.sqrt(ratio), wider
                logger.info("seepage: no balance with a transition %.3g times as wide: %s", width, reason)
                if ratio < _LEAST_RATIO:
                    raise NotConverged(f"the water does not balance with a transition between wet and dry that is less "
                                       f"than {wider:.3g} times as wide as asked for: {reason}; give a wider one, or "
                                       "refine the mesh at the free surface", head) from None
            iterations.append(count)
            wider = width
        relative = self.flow.relative(head, laws)[0]
        return Balance(head, self.tie.T @ self.flow.inflow(head, relative), relative, tuple(iterations))

    def _newton(self, head: ndarray, leaking: ndarray, laws: Laws, tolerance: float) -> tuple[ndarray, ndarray, int]:
        """Heads in balance, the nodes of faces that leak, and the number of iterations."""
        flow = self.flow
        for iteration in range(1, _ITERATIONS + 1):
            fixed = self.given.held | leaking | self._idle
            head = self._step(self.tie @ np.where(leaking, flow.elevation, head), fixed, laws)
            relative = flow.relative(head, laws)[0]
            inflow, round_off = self.tie.T @ flow.inflow(head, relative), flow.round_off(head, relative)
            unbalanced = float(np.linalg.norm(inflow[~fixed]))
            now = np.where(leaking, inflow <= round_off, self._face & (head > flow.elevation + self._tolerance))
            settled = bool((now == leaking).all())
            if settled and unbalanced <= max(tolerance * np.linalg.norm(inflow), np.linalg.norm(round_off)):
                return head, leaking, iteration
            leaking = now
        raise _Unbalanced(f"{unbalanced / float(np.linalg.norm(inflow)):.1e} of the water is out of balance after "
                          f"{_ITERATIONS} iterations" if settled else "the seepage faces go to and fro")

    def _step(self, head: ndarray, fixed: ndarray, laws: Laws) -> ndarray:
        """Heads after a step of Newton's method, shortened until less water is out of balance."""
        flow = self.flow

        def unbalanced(head: ndarray) -> ndarray:
            return np.where(fixed, 0.0, self.tie.T @ flow.inflow(head, flow.relative(head, laws)[0]))

        before = unbalanced(head)
        tangent = self.tie.T @ flow.tangent(head, *flow.relative(head, laws)) @ self.tie
        matrix = diags(np.where(fixed, 0.0, 1.0)) @ tangent + diags(np.where(fixed, self._diagonal, 0.0))
        change = self.tie @ self._solver.factor(matrix.tocsr())(-before)
        share, size = 1.0, float(np.linalg.norm(before))
        while share > _SHORTEST:
            if np.linalg.norm(unbalanced(head + share * change)) <= (1.0 - _DECREASE * share) * size:
                break
            share *= 0.5
        return head + share * change
