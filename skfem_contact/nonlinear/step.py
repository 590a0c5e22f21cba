"""Step: an increment of load and prescribed displacements, and the search for its equilibrium."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..arrays import max_abs
from ..checks import trusted_calls
from ..errors import NoEquilibrium, NotConverged
from ..forms.base import Response
from ..solvers.direct import REFINE, SingularSystem, Solve
from .accelerated import Accelerated
from .forcing import Forcing
from .newton import FAR, Evaluation, Newton, Problem, Search, iterate
from .system import System

logger = logging.getLogger("skfem_contact")


@dataclass(frozen=True)
class Equilibrium:
    """A converged increment.

    Attributes
    ----------
    x, states
        Displacements, (N,), and candidate states by form.
    residuals
        History of the residual.
    equilibria
        Number of equilibria that the increment took.
    forces
        Internal forces by form, (N,).
    responses
        Responses of the forms, until the equilibrium is accepted.
    """

    x: ndarray
    states: dict[str, Any]
    residuals: tuple[float, ...]
    equilibria: int = 1
    forces: Mapping[str, ndarray] = field(default_factory=dict, repr=False)
    responses: Mapping[str, Response] = field(default_factory=dict, repr=False)

    @property
    def iterations(self) -> int:
        """Number of linear systems solved."""
        return len(self.residuals) - 1


@dataclass(frozen=True)
class Attempt:
    """One attempt to find the equilibrium of a step.

    Attributes
    ----------
    searches
        Line searches to try, one after the other.
    elastic
        Norm of the displacements that the load causes by elasticity; by default the norm of the
        first iteration's displacements, or of `x` if it is larger.
    at_least, damp
        As for :func:`~skfem_contact.nonlinear.newton.iterate`.
    leaves
        End the iterations where contact goes back and forth and other forms help.
    begins
        The increment begins: forms may improve the first iteration from `x`, see
        :meth:`~skfem_contact.roles.Regularised.foreseen`.
    """

    searches: tuple[Search, ...] = ("residual", "energy")
    elastic: float = 0.0
    at_least: int = 0
    damp: bool = False
    leaves: bool = True
    begins: bool = False


@dataclass(frozen=True)
class Step:
    """An increment to be solved.

    Attributes
    ----------
    system
        Forms, supports and linear solver.
    x, states
        The last accepted displacements and states.
    load, prescribed
        External forces, (N,), and values of the fixed dofs.
    start
        Displacements to start from; by default `x`.
    before
        Accepted displacements before `x`, from which `start` is extrapolated.
    """

    system: System
    x: ndarray
    states: Mapping[str, Any]
    load: ndarray
    prescribed: ndarray
    start: ndarray | None = None
    before: ndarray | None = None

    def equilibrium(self, settings: Newton, attempt: Attempt = Attempt()) -> Equilibrium:
        """Find the displacements at which load and internal forces balance.

        Raises
        ------
        NoEquilibrium, NotConverged
            No equilibrium exists; none was found. The message names the largest unbalanced force.
        """
        balance = _Balance(self, settings, attempt)
        start = self.x if self.start is None else self.start
        spent: tuple[float, ...] = ()
        for search in attempt.searches:
            balance.prepare(search)
            try:
                # no name for the first evaluation: its tangent would stay in memory
                first = [balance.begin(start)]
                with trusted_calls():
                    now, norms = iterate(
                        first.pop(),
                        balance,
                        settings,
                        search,
                        at_least=attempt.at_least,
                        damp=attempt.damp,
                    )
            except NotConverged as error:
                error.residuals = spent = spent + error.residuals[1 if spent else 0 :]
                last = search == attempt.searches[-1]
                if isinstance(error, NoEquilibrium) or last or error.cycle:
                    raise
                logger.info("no equilibrium by the %s: %s", search, error)
            else:
                residuals = spent + norms[1 if spent else 0 :]
                forces = {name: response.force for name, response in now.responses.items()}
                return Equilibrium(
                    now.z, now.states, residuals, forces=forces, responses=now.responses
                )
        raise ValueError("there is no line search to try")


class _Balance(Problem):
    """Balance of load and internal forces of a step."""

    def __init__(self, step: Step, settings: Newton, attempt: Attempt) -> None:
        self._step = step
        self._settings = settings
        self._attempt = attempt
        self._elastic = attempt.elastic or None  # unknown before the first iteration
        self._regular: csr_matrix | None = None  # the last tangent that was regular
        self._forcing: Forcing | None = None
        self._predicts = True  # stresses, see `forms.predicted_stress`

    def prepare(self, search: Search) -> None:
        """Prepare for a search.

        Where bodies yield, linear systems are solved only as accurately as it needs. The first
        search alone predicts stresses: where they lead astray, others follow the law.
        """
        inexact = self._step.system.yields and search in ("residual", "either", "full")
        self._predicts = search == self._attempt.searches[0]
        self._forcing = None
        if inexact:
            self._forcing = Forcing(self._settings.tolerance)

    def evaluate(self, z: ndarray) -> Evaluation:
        step = self._step
        new = step.system.evaluate(z, step.states, step.load)
        lag = max_abs(step.prescribed - z[step.system.fixed])
        return replace(new, lag=float(lag))

    def begin(self, z: ndarray) -> Evaluation:
        """Return the evaluation to begin with.

        Stresses of an extrapolated start are far off, at the displacements `x` they are right.
        """
        first = self.evaluate(z)
        step = self._step
        unknown = [n for n, r in first.responses.items() if not np.isfinite(r.force).all()]
        if unknown:
            text = f"the forces of {unknown} are not finite where the increment starts"
            if step.start is not None:  # extrapolated too far
                raise NotConverged(text, step.x)
            raise ValueError(f"{text}: examine a law of your own with testing.check_material")
        if step.start is None or not first.predictions or not self._predicts:
            return first
        return step.system.begun(first, step.x, step.before)

    def along(self, now: Evaluation, step: ndarray, length: float) -> Evaluation:
        new = self.evaluate(now.z + length * step)
        if not self._predicts:
            return new
        return self._step.system.followed(new, now, step, length)

    def direction(self, now: Evaluation, damped: bool) -> ndarray:
        """Return the Newton step.

        Where the tangent is singular, far out on a mechanism, the last regular one takes its place.
        """
        system = self._step.system
        if self._forcing is None:
            rtol = REFINE
        else:
            rtol = self._forcing.at(now)
        K = system.tangent(now, damped)

        # Move the fixed dofs, and balance the forces by which they pull at the others.
        step = np.zeros_like(now.z)
        right = now.residual
        lag = self._step.prescribed - now.z[system.fixed]
        if lag.any():
            step[system.fixed] = lag
            right = right - K @ step
        try:
            change = system.factor(K)(right, rtol)
            self._regular = K  # not its factors, which would be in memory next to the new ones
        except SingularSystem:
            if self._regular is None:
                raise
            change = system.factor(self._regular)(right, rtol)
        step = step + change
        if self._elastic is None:
            moves = system.layout.displacements
            moved = float(np.linalg.norm((now.z + step - self._step.x)[moves]))
            self._elastic = max(moved, float(np.linalg.norm(self._step.x[moves])))
        return step

    def accelerated(self, now: Evaluation, note: Callable[[Evaluation], None]) -> Evaluation:
        # in the plane and beside contact accelerated iterations stall
        system = self._step.system
        in_space = len(system.layout.coordinates) == 3
        alone = system.layout.scale is None  # no fields besides displacements
        if not (in_space and alone and system.yields) or system.unilateral:
            return now
        accelerated = Accelerated(self, self.preconditioner, self._settings.tolerance, note)
        return accelerated.solve(now)

    def preconditioner(self, now: Evaluation) -> Solve:
        """Return the solver of a matrix that is regular where the tangent leads nowhere."""
        system = self._step.system
        return system.factor(system.stiffened(now))

    def far(self, now: Evaluation) -> bool:
        moved = now.z - self._step.x
        size = np.linalg.norm(moved[self._step.system.layout.displacements])
        assert self._elastic is not None
        times = size / self._elastic
        releases_energy = now.residual @ moved > 0.0
        return bool((times > FAR and releases_energy) or times > FAR**2)

    def leaves(self, visited: list[ndarray]) -> bool:
        step = self._step
        if not self._attempt.leaves:
            return False
        return step.system.out_of(visited, step.states, step.load) is not step.system

    def improved(self, new: Evaluation) -> Evaluation:
        step = self._step
        if not self._attempt.begins or step.start is not None:
            return new
        z = step.system.foreseen(new.z, step.x, None, step.states)
        if z is new.z:
            return new
        return self.evaluate(z)
