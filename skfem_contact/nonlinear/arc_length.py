r"""Increments of given length along a path of equilibria, beyond limit points of the load.

A share :math:`\lambda` of the change of load and supports is found together with the displacements,
on a plane across the way that the increment is expected to take,

.. math:: r(u, \lambda) = 0, \qquad d \cdot (u - u_n) = d \cdot d ,

with the expected change d of the displacements (E. Riks, Int. J. Solids Struct. 15 (1979) 529-551;
M. A. Crisfield, Comput. Struct. 13 (1981) 55-62, for lengths of displacements alone). The plane is
linear, so that every step of Newton's method satisfies it. Two solutions with one factor of the
tangent give the step: one for the residual, one for the change of the load.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..checks import trusted_calls
from ..errors import NotConverged
from ..solvers.direct import SingularSystem, Solve
from .increment import Path, improved_forms, searches_of
from .newton import Evaluation, Newton, Problem, iterate
from .step import Equilibrium, Step
from .system import System

#: Equilibria in an increment, where forms follow the displacements.
_MOST = 10


@dataclass(frozen=True)
class OnPath:
    """Equilibrium on a path.

    Attributes
    ----------
    found
        The equilibrium.
    share
        Share of the load of the stage.
    """

    found: Equilibrium
    share: float


@dataclass(frozen=True)
class Arc:
    """An increment along a path.

    Attributes
    ----------
    system
        Forms as given, supports and linear solver.
    path
        Load and prescribed displacements at a share of the stage, linear in it.
    x, states, share
        The last equilibrium.
    """

    system: System
    path: Path
    x: ndarray
    states: Mapping[str, Any]
    share: float

    def tangent(self, change: float) -> ndarray:
        """Return the change of dofs and share, (N + 1,), for a change of the share alone."""
        problem = _OnPlane(self, self.system, self.states, np.zeros(len(self.x) + 1))
        now = problem.evaluate(np.append(self.x, self.share))
        K = self.system.tangent(now)
        try:
            drift = problem.drift(K, self.system.factor(K))
        except SingularSystem as error:
            raise NotConverged(str(error), self.x, (), int(error.dofs[0])) from error
        return change * np.append(drift, 1.0)

    def solve(self, ahead: ndarray, newton: Newton) -> OnPath:
        """Return the equilibrium on the plane across the change `ahead`, (N + 1,).

        Raises
        ------
        NotConverged
            None was found.
        """
        system = self.system.after(self.states, {})
        states = dict(self.states)
        z = np.append(self.x, self.share) + ahead
        search = searches_of(system, try_recovery=False)[0]
        residuals: tuple[float, ...] = ()
        for equilibria in range(1, _MOST + 1):
            # Find dofs and share together.
            problem = _OnPlane(self, system, states, ahead)
            with trusted_calls():
                now, norms = iterate(problem.evaluate(z), problem, newton, search)
            residuals += norms if not residuals else norms[1:]
            z = now.z
            forces = {name: response.force for name, response in now.responses.items()}
            found = Equilibrium(z[:-1], now.states, residuals, equilibria, forces)

            # Solve it once more where forms follow, such as multipliers of contact.
            load, prescribed = self.path(float(z[-1]))
            step = Step(system, self.x, states, load, prescribed)
            better = improved_forms(step, found, residuals)
            if not better:
                return OnPath(found, float(z[-1]))
            forms = {name: form for name, (form, _) in better.items()}
            states.update((name, state) for name, (_, state) in better.items())
            system = system.with_forms({**system.forms, **forms})
        raise NotConverged(
            f"the increment was solved {_MOST} times and {list(better)} still changes"
        )


class _OnPlane(Problem):
    """Equilibria of dofs and share, (N + 1,), on a plane across the expected change."""

    def __init__(self, arc: Arc, system: System, states: Mapping[str, Any], ahead: ndarray) -> None:
        self._arc = arc
        self._system = system
        self._states = states
        # Displacements alone have a length.
        self._across = np.zeros(len(arc.x))
        moves = system.layout.displacements
        self._across[moves] = ahead[:-1][moves]
        self._length = float(self._across @ self._across)
        load, prescribed = arc.path(1.0)
        first_load, first_prescribed = arc.path(0.0)
        self._change = load - first_load
        self._pushed = prescribed - first_prescribed

    def evaluate(self, z: ndarray) -> Evaluation:
        load, prescribed = self._arc.path(float(z[-1]))
        x = z[:-1].copy()
        x[self._system.fixed] = prescribed
        return replace(self._system.evaluate(x, self._states, load), z=np.append(x, z[-1]))

    def drift(self, K: csr_matrix, solve: Solve) -> ndarray:
        """Return the change of the dofs for the whole change of load and supports."""
        drift = np.zeros(len(self._change))
        drift[self._system.fixed] = self._pushed
        right = self._change
        if self._pushed.any():
            right = right - K @ drift
        return drift + solve(right)

    def direction(self, now: Evaluation, damped: bool) -> ndarray:
        K = self._system.tangent(now, damped)
        solve = self._system.factor(K)
        balance = solve(now.residual)
        drift = self.drift(K, solve)
        # Stay on the plane: d (u + balance + change * drift - u_n) = d d.
        missing = self._length - self._across @ (now.z[:-1] + balance - self._arc.x)
        slope = float(self._across @ drift)
        if slope == 0.0:
            raise NotConverged("the displacements do not depend on the load any more")
        change = missing / slope
        return np.append(balance + change * drift, change)
