"""Forms, supports and a linear solver: the system whose equilibrium is sought."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..errors import Failure, IncrementTooLarge, NoEquilibrium, NotConverged
from ..forms.base import Form, Response, responses_of
from ..forms.roles import Body, Reducible, Regularised, Timed, changed, having
from ..layout import Layout, others
from ..solvers.direct import REFINE, LinearSolver, SingularSystem, Solve
from ..sparse import Total
from .forcing import Forcing
from .newton import FAR, Evaluation, Newton, Search, iterate

logger = logging.getLogger("skfem_contact")

#: Share of the load that may be lost in round-off.
_HIDDEN = 1e-6
#: Share of all forces, in scaled equations, by which a field without any is measured: the residual
#: then is round-off.
_FLOOR = 1e-4
#: Largest displacement: squares of much larger ones overflow.
_ENDLESS = 1e100


@dataclass(frozen=True)
class Equilibrium:
    """A converged increment: displacements, candidate states, history of the residual, number of
    equilibria it took.
    """

    x: ndarray
    states: dict[str, Any]
    residuals: tuple[float, ...]
    equilibria: int = 1

    @property
    def iterations(self) -> int:
        """Number of linear systems solved."""
        return len(self.residuals) - 1


class System:
    """Forms on a layout of dofs, some of which are fixed, with a linear solver."""

    def __init__(
        self, forms: Mapping[str, Form], layout: Layout, fixed: ndarray, solver: LinearSolver
    ) -> None:
        self.forms, self.layout, self.fixed = dict(forms), layout, fixed
        self.free = others(layout.size, fixed)
        self._solver, self._total = solver, Total()
        self._scale = layout.scale

    def with_forms(self, forms: Mapping[str, Form]) -> System:
        """Return the system with other forms on the same dofs; itself where they are the same."""
        if all(form is self.forms.get(name) for name, form in forms.items()):
            return self
        new = copy(self)
        new.forms = dict(forms)
        for known in ("symmetric", "yields", "yields_beside_contact"):
            vars(new).pop(known, None)
        return new

    def over(self, duration: float) -> System:
        """Return the system of a step in time; itself where no form depends on time."""
        return self.with_forms(changed(self.forms, Timed, lambda form: form.over(duration)))

    @cached_property
    def symmetric(self) -> bool:
        """True if the tangents of all forms are symmetric."""
        return all(form.symmetric for form in self.forms.values())

    @cached_property
    def yields_beside_contact(self) -> bool:
        """True if some material yields, and contact or other forms act in one direction only."""
        bodies = having(having(self.forms, Body), Reducible).values()
        yields = any(body.strengths for body in bodies)
        return yields and any(form.unilateral for form in having(self.forms, Regularised).values())

    @cached_property
    def yields(self) -> bool:
        """True if the tangent changes inside of bodies, not only in contact."""
        return any(form.changing is None for form in self.forms.values())

    @property
    def size(self) -> int:
        """Number of dofs."""
        return self.layout.size

    def factor(self, K: csr_matrix) -> Solve:
        """Factor K[free, free], in scaled dofs where there are several fields; return the solver
        for any b.
        """
        if self._scale is None:
            return self._solver.factor(K, self.symmetric)
        scale = self._scale
        solve = self._solver.factor(self._total.scaled(K, scale), self.symmetric)

        def scaled(b: ndarray, rtol: float = REFINE) -> ndarray:
            return scale * solve(scale * b, rtol)

        return scaled

    def work(self, load: ndarray, displacements: ndarray) -> float:
        """Return the work of a load on the free dofs."""
        return float(load[self.free] @ displacements[self.free])

    def responses(self, x: ndarray, states: Mapping[str, Any]) -> dict[str, Response]:
        """Return the responses of all forms at displacements, unless these have run away."""
        if not np.abs(x).max(initial=0.0) < _ENDLESS:
            raise NotConverged("the iterations run away: the displacements are no numbers any more")
        try:
            return responses_of(self.forms, x, states)
        except IncrementTooLarge as error:
            raise NotConverged(f"the increment is too large: {error}", x) from error

    def evaluate(self, x: ndarray, states: Mapping[str, Any], load: ndarray) -> Evaluation:
        """Evaluate all forms at displacements."""
        responses = self.responses(x, states)
        residual = load - sum(r.force for r in responses.values())
        residual[self.fixed] = 0.0
        everywhere = (
            0.0
            if self._scale is None
            else max(float(np.linalg.norm(self._scale * r.measure)) for r in responses.values())
        )
        norm, hidden = max(
            self._relative(part, residual, load, responses, everywhere)
            for part in self.layout.parts
            if part.stop > part.start
        )
        return Evaluation(x, responses, residual, norm, hidden=hidden, scale=self._scale)

    def _relative(
        self,
        part: slice,
        residual: ndarray,
        load: ndarray,
        responses: Mapping[str, Response],
        everywhere: float,
    ) -> tuple[float, float]:
        """Return the norm of a field's residual over its largest force, less possible round-off,
        and that round-off.
        """
        loaded = float(np.linalg.norm(load[part]))
        scale = max(loaded, *(float(np.linalg.norm(r.measure[part])) for r in responses.values()))
        if (
            self._scale is not None
        ):  # where all forces of a field vanish, as those of multipliers do, others measure it
            scale = max(scale, _FLOOR * everywhere / float(self._scale[part].max()))
        round_off = sum(r.lost(part) for r in responses.values())
        if (
            loaded > 0.0
        ):  # displacements so large that their round-off hides the load are no equilibrium
            round_off = min(round_off, _HIDDEN * loaded)
        norm, unit = float(np.linalg.norm(residual[part])), scale if scale > 0 else 1.0
        hidden = min(norm, round_off)
        return (norm - hidden) / unit, hidden / unit

    def tangent(self, now: Evaluation, damped: bool = False) -> csr_matrix:
        """Return the tangent of all forms together."""
        return self._total.of([r.damped if damped else r.stiffness for r in now.responses.values()])

    def equilibrium(
        self,
        x: ndarray,
        states: Mapping[str, Any],
        load: ndarray,
        prescribed: ndarray,
        settings: Newton,
        searches: Sequence[Search] = ("residual", "energy"),
        elastic: float = 0.0,
        at_least: int = 0,
        damp: bool = False,
        start: ndarray | None = None,
        leaves: bool = True,
        begins: bool = False,
    ) -> Equilibrium:
        """Find the displacements at which load and internal forces balance.

        Parameters
        ----------
        x, states
            The last accepted displacements and states.
        load, prescribed
            External forces, (N,), and values of the fixed dofs.
        searches
            Line searches to try, one after the other.
        elastic
            Norm of the displacements that the load causes by elasticity; by default the first
            step's, or that of `x` if it is larger.
        at_least, damp
            As for :func:`~skfem_contact.nonlinear.newton.iterate`.
        start
            Displacements to start from; by default `x`.
        leaves
            End the iterations where contact goes back and forth and other forms help.
        begins
            The increment begins: forms may improve the first step from `x`, see
            :meth:`~skfem_contact.Form.foreseen`.

        Raises
        ------
        NoEquilibrium, NotConverged
            There is no equilibrium; none was found. The message names the largest unbalanced force.
        """
        first: list[float] = [elastic] if elastic > 0.0 else []
        regular: list[csr_matrix] = []
        moves = self.layout.displacements

        def evaluate(z: ndarray) -> Evaluation:
            new = self.evaluate(z, states, load)
            return replace(new, lag=float(np.abs(prescribed - z[self.fixed]).max(initial=0.0)))

        def direction(now: Evaluation, damped: bool) -> ndarray:
            rtol = forcing.at(now) if inexact else REFINE
            step = self._direction(now, prescribed - now.z[self.fixed], damped, regular, rtol)
            if not first:
                first.append(
                    max(
                        float(np.linalg.norm((now.z + step - x)[moves])),
                        float(np.linalg.norm(x[moves])),
                    )
                )
            return step

        def first_step(new: Evaluation) -> Evaluation:
            z = self.foreseen(new.z, x, None, states) if begins and start is None else new.z
            return new if z is new.z else evaluate(z)

        spent: tuple[float, ...] = ()
        for search in searches:
            forcing, inexact = (
                Forcing(settings.tolerance),
                self.yields and search in ("residual", "either"),
            )
            try:
                # no name for the first new: its tangent would stay in memory
                now, norms = iterate(
                    evaluate(x if start is None else start),
                    evaluate,
                    direction,
                    settings,
                    search,
                    lambda now: self._far(now, x, first[0]),
                    at_least,
                    damp,
                    lambda seen: leaves and self.out_of(seen, states, load) is not self,
                    first_step,
                )
            except NotConverged as error:
                error.residuals = spent = spent + error.residuals[1 if spent else 0 :]
                if isinstance(error, NoEquilibrium) or search == searches[-1] or error.cycle:
                    raise
                logger.info("no equilibrium by the %s: %s", search, error)
            else:
                return Equilibrium(now.z, now.states, spent + norms[1 if spent else 0 :])
        raise ValueError("there is no line search to try")

    def _far(self, now: Evaluation, x: ndarray, elastic: float) -> bool:
        """Return True if displacements from `x` are far beyond elastic ones, on a way that releases
        energy.
        """
        moved = now.z - x
        times = np.linalg.norm(moved[self.layout.displacements]) / elastic
        return bool((times > FAR and now.residual @ moved > 0.0) or times > FAR**2)

    def foreseen(
        self, start: ndarray, x: ndarray, before: ndarray | None, states: Mapping[str, Any]
    ) -> ndarray:
        """Return a start that is extrapolated from two displacements, or a first step, with what
        forms know better.
        """
        for name, form in having(self.forms, Regularised).items():
            start = form.foreseen(start, x, before, states[name])
        return start

    def after(self, states: Mapping[str, Any], failures: Mapping[str, Failure]) -> System:
        """Return the system with the forms that begin an increment after failures."""
        begun = {
            name: form.begin(states[name], failures[name])
            for name, form in having(self.forms, Regularised).items()
        }
        return self.with_forms({**self.forms, **begun})

    def out_of(self, cycle: Sequence[ndarray], states: Mapping[str, Any], load: ndarray) -> System:
        """Return the system with forms that do not go back and forth between some displacements;
        itself without any.
        """
        seen = [self.evaluate(x, states, load).states for x in cycle]
        return self.after(
            states, {name: Failure(False, tuple(one[name] for one in seen)) for name in self.forms}
        )

    def _direction(
        self, now: Evaluation, lag: ndarray, damped: bool, regular: list[csr_matrix], rtol: float
    ) -> ndarray:
        """Return the Newton step; where the tangent is singular, far out on a mechanism, with the
        last regular one.
        """
        K = self.tangent(now, damped)
        right = now.residual
        step = np.zeros_like(now.z)
        if lag.any():
            step[self.fixed] = lag
            right = right - K @ step
        try:
            solve = self.factor(K)
            regular[:] = [K]  # not its factors, which would be in memory beside the next ones
        except SingularSystem:
            if not regular:
                raise
            solve = self.factor(regular[0])
        return step + solve(right, rtol)
