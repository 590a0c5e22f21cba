"""Forms, supports and a linear solver: the system whose equilibrium is sought."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..arrays import max_abs
from ..errors import Failure, IncrementTooLarge, NotConverged
from ..forms.base import Forms, Response, States, responses_of
from ..forms.predicted_stress import PredictedStress
from ..forms.roles import Body, Reducible, Regularised, Stiff, Timed, changed, having
from ..layout import Layout, others
from ..solvers.direct import REFINE, LinearSolver, Solve
from ..sparse import Scattering, Total, same_pattern, with_data
from .newton import Evaluation

_NONE: Mapping[str, Response] = MappingProxyType({})

#: Share of the load that may be lost in round-off.
_HIDDEN = 1e-6
#: Share of all forces, in scaled equations, by which a field without any is measured: the residual
#: then is round-off.
_FLOOR = 1e-4
#: Share of the elastic stiffness in the preconditioner of accelerated iterations: so many times the
#: residual, between two bounds. With .1 everywhere footings in space on sand without dilation
#: (phi 35 and 40, two stages, 27,783 and 46,875 dofs) take 261 iterations for 163, and one is cut
#: to eight increments: near equilibrium a large share hides the mechanism that forms. Elastic
#: stiffness alone comes no closer than a hundredth of the load.
_ELASTIC = 2.0
_SHARES = 0.003, 0.1
#: Largest displacement: squares of much larger ones overflow.
_ENDLESS = 1e100


class System:
    """Forms on a layout of dofs, some of which are fixed, with a linear solver."""

    def __init__(
        self,
        forms: Forms,
        layout: Layout,
        fixed: ndarray,
        solver: LinearSolver,
    ) -> None:
        self.forms = dict(forms)
        self.layout = layout
        self.fixed = fixed
        self.free = others(layout.size, fixed)
        #: True if an increment has been solved, and arguments of the forms have been checked.
        self.evaluated = False
        self._solver = solver
        self._total = Total()
        self._slots: defaultdict[str, Scattering] = defaultdict(Scattering)
        self._scale = layout.scale

    def with_forms(self, forms: Forms) -> System:
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
        return yields and self.unilateral

    @property
    def finite(self) -> bool:
        """True if bodies may turn and strain much."""
        return any(form.kinematics == "finite" for form in self.forms.values())

    @property
    def unilateral(self) -> bool:
        """True if contact or other forms act in one direction only."""
        return any(form.unilateral for form in having(self.forms, Regularised).values())

    @cached_property
    def yields(self) -> bool:
        """True if the tangent changes inside of bodies, not only in contact."""
        return any(form.changing is None for form in self.forms.values())

    @property
    def size(self) -> int:
        """Number of dofs."""
        return self.layout.size

    def factor(self, K: csr_matrix) -> Solve:
        """Factor K[free, free], and return the solver for any b.

        Where there are several fields, the factor is of scaled dofs.
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

    def responses(
        self, x: ndarray, states: States, known: Mapping[str, Response] = _NONE
    ) -> dict[str, Response]:
        """Return the responses of all forms at displacements, unless these have run away."""
        if not max_abs(x) < _ENDLESS:
            raise NotConverged("the iterations run away: the displacements are no numbers any more")
        try:
            missing = {name: form for name, form in self.forms.items() if name not in known}
            found = responses_of(missing, x, states, self._slots)
        except IncrementTooLarge as error:
            raise NotConverged(f"the increment is too large: {error}", x) from error
        found.update(known)
        return {name: found[name] for name in self.forms}

    def evaluate(
        self,
        x: ndarray,
        states: States,
        load: ndarray,
        known: Mapping[str, Response] = _NONE,
    ) -> Evaluation:
        """Evaluate all forms at displacements, but for responses there that are known."""
        responses = self.responses(x, states, known)
        residual = load - sum(r.force for r in responses.values())
        residual[self.fixed] = 0.0

        # Compare the residual of each field with its forces, less round-off; the worst one counts.
        norms = self.layout.norms
        loads = norms(load)
        size = self._sizes(loads, [response.measure for response in responses.values()])
        round_off = self._round_off(loads, responses.values())
        unbalanced = norms(residual)
        hidden = np.minimum(unbalanced, round_off) / size
        norm = (unbalanced - np.minimum(unbalanced, round_off)) / size
        worst = np.lexsort((hidden, norm))[-1]
        return Evaluation(
            x,
            responses,
            residual,
            norm=float(norm[worst]),
            hidden=float(hidden[worst]),
            scale=self._scale,
        )

    def _sizes(self, loads: ndarray, measures: Sequence[ndarray]) -> ndarray:
        """Return the norms that the residuals of the fields are compared with, (n_fields,).

        Where all forces of a field vanish, such as those of multipliers, the forces of all fields
        measure it.
        """
        norms = [self.layout.norms(values) for values in measures]
        sizes = np.max([loads, *norms], axis=0)
        if self._scale is not None:
            scales = self.layout.scales
            everywhere = max(float(np.linalg.norm(scales * each)) for each in norms)
            sizes = np.maximum(sizes, _FLOOR * everywhere / scales)
        return np.where(sizes > 0.0, sizes, 1.0)

    def _round_off(self, loads: ndarray, responses: Iterable[Response]) -> ndarray:
        """Return the norms of the forces that round-off may leave, (n_fields,).

        Displacements so large that their round-off hides the load are no equilibrium.
        """
        lost = np.zeros_like(loads)
        for response in responses:
            if isinstance(response.round_off, ndarray):
                lost += self.layout.norms(response.round_off)
            else:
                lost[0] += response.round_off
        return np.where(loads > 0.0, np.minimum(lost, _HIDDEN * loads), lost)

    def begun(self, first: Evaluation, x: ndarray, before: ndarray | None) -> Evaluation:
        """Return the evaluation with stresses that follow the ones of the accepted states.

        `x` and `before` are the displacements of these states and the ones before, if known.
        """
        share = 0.0
        if before is not None:
            last = x - before
            share = float((first.z - x) @ last / (last @ last))
        for prediction in first.predictions.values():
            if self._follows(prediction):
                prediction.begin(x, before, share)
        return self._predicted(first)

    def followed(
        self,
        new: Evaluation,
        now: Evaluation,
        step: ndarray,
        length: float,
    ) -> Evaluation:
        """Return an evaluation with the stresses that a step from another one predicts."""
        for name, prediction in new.predictions.items():
            if self._follows(prediction):
                prediction.follow(now.predictions[name], step, length)
        return self._predicted(new)

    def _follows(self, prediction: PredictedStress) -> bool:
        """Return True if predictions save iterations."""
        return prediction.beside_contact or not self.unilateral

    def _predicted(self, new: Evaluation) -> Evaluation:
        """Return the evaluation with the residual of the stresses that iterations predict."""
        predictions = [each for each in new.predictions.values() if each.made]
        if not predictions:
            return new
        residual = new.residual.copy()
        for prediction in predictions:
            force = prediction.force()
            residual[: len(force)] -= force
        residual[self.fixed] = 0.0
        return replace(new, predicted=residual)

    def tangent(self, now: Evaluation, damped: bool = False) -> csr_matrix:
        """Return the tangent of all forms together."""
        return self._total.of([r.damped if damped else r.stiffness for r in now.responses.values()])

    def stiffened(self, now: Evaluation) -> csr_matrix:
        """Return the tangent of all forms together, with a share of their elastic stiffness.

        The share falls with the residual (switched evolution relaxation).

        References
        ----------
        C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation, SIAM J.
        Numer. Anal. 35 (1998) 508-523.
        """
        share = float(np.clip(_ELASTIC * now.norm, *_SHARES))
        matrices = []
        for name, form in self.forms.items():
            tangent = now.responses[name].stiffness
            if isinstance(form, Stiff):
                elastic = form.elastic_stiffness
            else:
                elastic = None
            if elastic is not None and elastic is not tangent:
                tangent = _mixed(tangent, elastic, share)
            matrices.append(tangent)
        return self._total.of(matrices)

    def foreseen(
        self,
        start: ndarray,
        x: ndarray,
        before: ndarray | None,
        states: States,
    ) -> ndarray:
        """Return displacements to start from, with better values where forms know some.

        `start` is extrapolated from two displacements, or the first iteration from `x`.
        """
        for name, form in having(self.forms, Regularised).items():
            start = form.foreseen(start, x, before, states[name])
        return start

    def after(self, states: States, failures: Mapping[str, Failure]) -> System:
        """Return the system with the forms that begin an increment, after failures or without."""
        begun = {}
        for name, form in having(self.forms, Regularised).items():
            begun[name] = form.begin(states[name], failures.get(name))
        return self.with_forms({**self.forms, **begun})

    def out_of(self, cycle: Sequence[ndarray], states: States, load: ndarray) -> System:
        """Return the system with forms that leave a cycle of displacements, or this system."""
        visited = [self.evaluate(x, states, load).states for x in cycle]
        failures = {}
        for name in self.forms:
            failures[name] = Failure(False, tuple(found[name] for found in visited))
        return self.after(states, failures)


def _mixed(first: csr_matrix, second: csr_matrix, share: float) -> csr_matrix:
    """Return one matrix with a share of another, on the pattern of the first where they agree."""
    if same_pattern(first, second):
        return with_data(first, (1.0 - share) * first.data + share * second.data)
    return (1.0 - share) * first + share * second
