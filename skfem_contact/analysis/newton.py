"""Newton's method with a line search for a sum of forms; it tells a stall from a collapse."""
from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..assembly import Response
from .linear import SingularSystem

logger = logging.getLogger("skfem_contact")

#: The line search accepts what is not worse than the worst of this many last residuals: contact that opens,
#: closes and slips on its way to the solution raises the residual now and then.
_MEMORY = 4
_SHORTEST = 1.0 / 16.0
#: The tangent is damped for the rest of an increment when so many iterations have not halved the residual.
_PATIENCE = 4
#: An equilibrium that is farther away than so many elastic displacements is none.
_FAR = 100.0


class Form(Protocol):
    """Whatever carries load: solids and contact pairs answer the same calls."""

    def initial_state(self) -> Any: ...

    def assemble(self, x: ndarray, state: Any) -> Response: ...

    def settle(self, x: ndarray, accepted: Any, candidate: Any) -> Any | None: ...

    def summary(self, state: Any) -> str: ...

    def remarks(self, state: Any) -> list[str]: ...


class NotConverged(RuntimeError):
    """Newton's method found no equilibrium; whether there is one remains open.

    Attributes
    ----------
    result
        The stages and increments that were accepted before, as far as they came.
    x
        The displacements that were reached, (N,).
    residuals
        History of the residual.
    """

    result: Any = None

    def __init__(self, message: str, x: ndarray | None = None, residuals: Sequence[float] = ()) -> None:
        super().__init__(message)
        self.x, self.residuals = x, tuple(residuals)


class Collapse(NotConverged):
    """There is no equilibrium within any displacement worth the name: the bodies collapse under this load.

    Internal forces that grow with the displacements are monotone: at any displacement x they leave a residual
    r, and every equilibrium x* lies beyond, r . (x* - x) >= 0.  From the start x_0 of the increment it is at least
    r . (x - x_0) / \\|r\\| away.  Once this exceeds a hundred times the displacements that the load causes by
    elasticity, there is none.  With associated flow the bound is rigorous; with friction and non-associated flow it
    says that a mechanism was found along which the load does more work than the bodies resist.
    """


@dataclass(frozen=True)
class Newton:
    """Settings of Newton's method.

    Parameters
    ----------
    tolerance
        Norm of the residual over the largest norm among the load and the forms' forces.
    max_iterations
        After so many iterations the increment has failed.

    Examples
    --------
    >>> from skfem_contact import Newton
    >>> Newton(tolerance=1e-10).max_iterations
    25
    """

    tolerance: float = 1e-8
    max_iterations: int = 25


@dataclass(frozen=True)
class Equilibrium:
    """A converged increment: displacements, candidate states and the history of the residual."""

    x: ndarray
    states: dict[str, Any]
    residuals: tuple[float, ...]

    @property
    def iterations(self) -> int:
        """Number of linear systems solved."""
        return len(self.residuals) - 1


@dataclass(frozen=True)
class Trial:
    """What the forms answer to a vector of unknowns.

    Attributes
    ----------
    z
        Unknowns: displacements, and whatever else is sought.
    responses
        Answers of the forms.
    residual
        Load less internal forces, zero at the fixed unknowns, (N,).
    norm
        Its norm, relative to the largest norm among the load and the forms' forces.
    lag
        How much the unknowns differ from what is prescribed.
    """

    z: ndarray
    responses: dict[str, Response]
    residual: ndarray
    norm: float
    lag: float = 0.0

    def tangent(self, damped: bool) -> csr_matrix:
        """Tangent of all forms together."""
        matrices = [r.damped if damped else r.stiffness for r in self.responses.values()]
        total = matrices[0]
        for matrix in matrices[1:]:
            total = total + matrix
        return total

    @property
    def states(self) -> dict[str, Any]:
        """Candidate states."""
        return {name: response.state for name, response in self.responses.items()}


class System:
    """Forms, supports and a linear solver.

    Parameters
    ----------
    forms
        Forms by name.
    fixed
        Unknowns whose values are prescribed.
    solver
        Linear solver: ``factor(K) -> solve``.
    """

    def __init__(self, forms: Mapping[str, Form], fixed: ndarray, free: ndarray, solver: Any) -> None:
        self.forms = dict(forms)
        self.fixed, self.free = fixed, free
        self.solver = solver

    def evaluate(self, x: ndarray, states: Mapping[str, Any], load: ndarray) -> Trial:
        """Answers of all forms at some displacements."""
        responses = {name: form.assemble(x, states[name]) for name, form in self.forms.items()}
        residual = load - sum(r.force for r in responses.values())
        residual[self.fixed] = 0.0
        scale = max(np.linalg.norm(load), *(np.linalg.norm(r.force) for r in responses.values()))
        norm = float(np.linalg.norm(residual))
        return Trial(x, responses, residual, norm / scale if scale > 0 else norm)

    def equilibrium(self, x: ndarray, states: Mapping[str, Any], load: ndarray, prescribed: ndarray,
                    settings: Newton) -> Equilibrium:
        """Find the displacements at which load and internal forces balance.

        Parameters
        ----------
        x, states
            The last accepted displacements and states.
        load
            External forces, (N,).
        prescribed
            Values of the fixed unknowns.

        Raises
        ------
        Collapse
            There is none.
        NotConverged
            With the place and the size of the largest unbalanced force.
        """
        first: list[ndarray] = []

        def evaluate(z: ndarray) -> Trial:
            trial = self.evaluate(z, states, load)
            return Trial(z, trial.responses, trial.residual, trial.norm,
                         float(np.abs(prescribed - z[self.fixed]).max(initial=0.0)))

        def direction(now: Trial, damped: bool) -> ndarray:
            step = self._direction(now, prescribed - now.z[self.fixed], damped)
            first.append(step)
            return step

        def far(now: Trial) -> bool:
            elastic = max(np.linalg.norm(first[0]), np.linalg.norm(x))
            return bool(now.lag == 0.0 and distance(now.residual, now.z - x) > _FAR * elastic)

        now, norms = iterate(evaluate(x), evaluate, direction, settings, far)
        return Equilibrium(now.z, now.states, norms)

    def _direction(self, now: Trial, lag: ndarray, damped: bool) -> ndarray:
        K = now.tangent(damped)
        right = now.residual
        step = np.zeros_like(now.z)
        if lag.any():
            step[self.fixed] = lag
            right = right - K @ step
        return step + self.solver.factor(K)(right)


def distance(residual: ndarray, moved: ndarray) -> float:
    """Least distance of any equilibrium from where the displacements started (see :class:`Collapse`)."""
    norm = np.linalg.norm(residual)
    return float(residual @ moved / norm) if norm > 0 else 0.0


def iterate(now: Trial, evaluate: Callable[[ndarray], Trial], direction: Callable[[Trial, bool], ndarray],
            settings: Newton, hopeless: Callable[[Trial], bool]) -> tuple[Trial, tuple[float, ...]]:
    """Newton's iterations: from a trial to one without residual, and the history of the residual.

    Parameters
    ----------
    now
        Where to start.
    evaluate
        Trial at some unknowns.
    direction
        Newton step at a trial, with the tangent or with the damped one.
    settings
        Tolerance and number of iterations.
    hopeless
        Whether a trial shows that there is no solution.

    Raises
    ------
    Collapse, NotConverged
        There is no solution; none was found.
    """
    norms, damped = [now.norm], False
    while not (now.norm <= settings.tolerance and now.lag == 0.0):
        if len(norms) > settings.max_iterations or not now.norm < 1e8:
            raise NotConverged(f"no equilibrium after {len(norms) - 1} iterations; {_why(now, norms)}", now.z, norms)
        try:
            step = direction(now, damped)
        except SingularSystem as error:
            raise NotConverged(f"the stiffness is singular: {error}", now.z, norms) from error
        now = _search(now, step, norms, evaluate)
        norms.append(now.norm)
        logger.debug("iteration %d: residual %.3e", len(norms) - 1, now.norm)
        if now.norm > settings.tolerance and hopeless(now):
            raise Collapse(f"there is no equilibrium: after {len(norms) - 1} iterations none is possible within "
                           f"{_FAR:g} times the elastic displacements; {_why(now, norms)}", now.z, norms)
        if len(norms) > _PATIENCE and now.norm > 0.5 * norms[-1 - _PATIENCE]:
            damped = True
    return now, tuple(norms)


def _search(now: Trial, step: ndarray, norms: list[float], evaluate: Callable[[ndarray], Trial]) -> Trial:
    """Halve the step while the residual is worse than all of the last few."""
    bound = max(norms[-_MEMORY:]) if len(norms) > 1 else np.inf
    best = trial = evaluate(now.z + step)
    length = 1.0
    while not trial.norm <= bound and length > _SHORTEST:
        length *= 0.5
        trial = evaluate(now.z + length * step)
        if not best.norm <= trial.norm:
            best = trial
    return best


def _why(now: Trial, norms: list[float]) -> str:
    worst = int(np.argmax(np.abs(now.residual)))
    names = [k for k, r in now.responses.items() if r.force[worst] != 0.0]
    history = ", ".join(f"{v:.1e}" for v in norms[-5:])
    return (f"the residual went {history}; the largest unbalanced force, {now.residual[worst]:.3g}, acts on unknown "
            f"{worst} of {names}")
