"""Newton's method with a line search for a sum of forms."""
from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
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


class Form(Protocol):
    """Whatever carries load: solids and contact pairs answer the same calls."""

    def initial_state(self) -> Any: ...

    def assemble(self, x: ndarray, state: Any) -> Response: ...

    def settle(self, accepted: Any, candidate: Any) -> Any | None: ...

    def summary(self, state: Any) -> str: ...

    def remarks(self, state: Any) -> list[str]: ...


class NotConverged(RuntimeError):
    """Newton's method found no equilibrium.

    Attributes
    ----------
    result
        The stages and increments that were accepted before, as far as they came.
    """

    result: Any = None


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
class _Trial:
    x: ndarray
    responses: dict[str, Response]
    residual: ndarray
    norm: float


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

    def _evaluate(self, x: ndarray, states: Mapping[str, Any], load: ndarray) -> _Trial:
        responses = {name: form.assemble(x, states[name]) for name, form in self.forms.items()}
        residual = load - sum(r.force for r in responses.values())
        residual[self.fixed] = 0.0
        scale = max(np.linalg.norm(load), *(np.linalg.norm(r.force) for r in responses.values()))
        norm = float(np.linalg.norm(residual))
        return _Trial(x, responses, residual, norm / scale if scale > 0 else norm)

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
        NotConverged
            With the place and the size of the largest unbalanced force.
        """
        now = self._evaluate(x, states, load)
        norms = [now.norm]
        for _ in range(settings.max_iterations):
            lag = prescribed - now.x[self.fixed]
            if now.norm <= settings.tolerance and not lag.any():
                return Equilibrium(now.x, {k: r.state for k, r in now.responses.items()}, tuple(norms))
            step = self._direction(now, lag)
            now = self._search(now, step, norms, lambda trial: self._evaluate(trial, states, load))
            norms.append(now.norm)
            logger.debug("iteration %d: residual %.3e", len(norms) - 1, now.norm)
            if not np.isfinite(now.norm) or now.norm > 1e8:
                break
        if now.norm <= settings.tolerance:
            return Equilibrium(now.x, {k: r.state for k, r in now.responses.items()}, tuple(norms))
        raise NotConverged(self._why(now, norms))

    def _direction(self, now: _Trial, lag: ndarray) -> ndarray:
        K = _sum([r.stiffness for r in now.responses.values()])
        right = now.residual
        step = np.zeros_like(now.x)
        if lag.any():
            step[self.fixed] = lag
            right = right - K @ step
        try:
            return step + self.solver.factor(K)(right)
        except SingularSystem as error:
            raise NotConverged(f"the stiffness is singular: {error}") from error

    def _search(self, now: _Trial, step: ndarray, norms: list[float], evaluate: Callable[[ndarray], _Trial]) -> _Trial:
        """Halve the step while the residual is worse than all of the last few."""
        bound = max(norms[-_MEMORY:]) if len(norms) > 1 else np.inf
        best = trial = evaluate(now.x + step)
        length = 1.0
        while not trial.norm <= bound and length > _SHORTEST:
            length *= 0.5
            trial = evaluate(now.x + length * step)
            if not best.norm <= trial.norm:
                best = trial
        return best

    def _why(self, now: _Trial, norms: list[float]) -> str:
        worst = int(np.argmax(np.abs(now.residual)))
        names = [k for k, r in now.responses.items() if r.force[worst] != 0.0]
        history = ", ".join(f"{v:.1e}" for v in norms[-5:])
        return (f"no equilibrium after {len(norms) - 1} iterations; the residual went {history}; the largest "
                f"unbalanced force, {now.residual[worst]:.3g}, acts on unknown {worst} of {names}")


def _sum(matrices: list[csr_matrix]) -> csr_matrix:
    total = matrices[0]
    for matrix in matrices[1:]:
        total = total + matrix
    return total
