"""Searches for a collapse: their steps, ends and results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..display import Table
from ..errors import NoEquilibrium, NotConverged, warn
from ..forms.assembly import has_corners_only
from ..forms.base import Form, Forms, States, dilate_less
from ..forms.roles import Body, Reducible, having
from ..limit_analysis import Bounds
from ..nonlinear.system import System
from ..results.stage import StageResult
from .mechanism import (
    FACTOR,
    LOAD,
    added_by_mesh,
    describe_mesh,
    lost_power,
    power_of_contact,
    slips_on_planes,
    warn_of_errors,
    warn_of_locking,
    warn_of_mesh,
    warn_of_motion,
    warn_of_planes,
    within_bounds,
)


class PeakPassed(NotConverged):
    """Equilibrium below the last one: the step was too long, or the curve has a peak."""


@dataclass(frozen=True)
class Point:
    """Equilibrium on the curve of parameter over work, with displacements, (N,), and states."""

    x: ndarray
    states: States
    parameter: float
    work: float = 0.0
    residuals: tuple[float, ...] = (0.0,)

    @property
    def iterations(self) -> int:
        """Number of tangents factored on the way from the last point."""
        return len(self.residuals) - 1


def kind_of(error: NotConverged) -> Literal["collapse", "peak", "stall"]:
    """Return the outcome of a step that failed."""
    if isinstance(error, NoEquilibrium):
        return "collapse"
    if isinstance(error, PeakPassed):
        return "peak"
    return "stall"


def released(forms: Forms, last: Point) -> tuple[dict[str, Form], dict[str, Any]]:
    """Return forms whose geometry follows the displacements again, and their states at a point."""
    followed = dict(forms)
    states = dict(last.states)
    for name, form in having(forms, Reducible).items():
        followed[name], states[name] = form.released(last.x, last.states[name])
    return followed, states


@dataclass(frozen=True)
class Step:
    """Step of a search.

    Attributes
    ----------
    parameter
        Factor of safety or load multiplier.
    outcome
        ``"equilibrium"``, ``"collapse"``, ``"stall"``, or ``"peak"``: an equilibrium below the last
        one.
    iterations, residual
        Number of tangents factored, and relative residual at the end.
    displacement
        Largest displacement since the start.
    yielding
        Share of the points of all solids that flowed in this step.
    work
        Work of the reference load since the start.
    """

    parameter: float
    outcome: Literal["equilibrium", "collapse", "peak", "stall"]
    iterations: int
    residual: float
    displacement: float
    yielding: float
    work: float


class SearchLog:
    """Steps of a search, also shown in a progress bar."""

    def __init__(self, system: System, bar: Any, origin: Point) -> None:
        self.steps: list[Step] = []
        self.points: list[Point] = []  # all equilibria
        self._forms = system.forms
        self._bar = bar
        self._displacements = system.layout.displacements
        self.begin(origin)

    def begin(self, point: Point) -> None:
        """Count displacements and flow from a point."""
        self._origin = point.x
        self._states = point.states

    def accept(self, point: Point) -> None:
        """Add an equilibrium."""
        self.points.append(point)
        self._add(
            Step(
                point.parameter,
                "equilibrium",
                iterations=point.iterations,
                residual=point.residuals[-1],
                displacement=self.moved(point.x),
                yielding=self._yielding(point),
                work=point.work,
            )
        )
        self._states = point.states

    def reject(self, parameter: float, error: NotConverged, work: float) -> None:
        """Add a step without equilibrium."""
        self._add(
            Step(
                parameter,
                kind_of(error),
                iterations=max(len(error.residuals) - 1, 0),
                residual=error.residuals[-1] if error.residuals else np.nan,
                displacement=self.moved(error.x),
                yielding=np.nan,
                work=work,
            )
        )

    def moved(self, x: ndarray | None) -> float:
        """Return the largest displacement since the beginning, without other fields."""
        if x is None:
            return np.nan
        displacements = (x - self._origin)[self._displacements]
        return max_abs(displacements)

    @property
    def straight(self) -> bool:
        """True if no point of a solid has flowed in the last step.

        Bars and joints make curves of straight pieces.
        """
        return self.steps[-1].yielding == 0.0

    def _yielding(self, point: Point) -> float:
        """Return the share of all points that have flowed since the last equilibrium."""
        flowed = points = 0
        for name, form in self._forms.items():
            outputs = form.outputs(point.x[: form.size], point.states[name])
            found, total = outputs.yielding(self._states[name])
            flowed += found
            points += total
        if points:
            return float(flowed / points)
        return 0.0

    def _add(self, step: Step) -> None:
        self.steps.append(step)
        total = sum(s.iterations for s in self.steps)
        self._bar.set_postfix_str(f"{step.parameter:.4f} {step.outcome}, {total} iterations")


@dataclass(frozen=True)
class Stop:
    """Reason why a search ended.

    Attributes
    ----------
    kind
        Two kinds show the limit. ``"plateau"``: the curve has levelled off; ``"collapse"``: no
        equilibrium exists close above. Four do not. ``"peak"``: the curve falls, and another path
        may lead higher; ``"stall"``: neither equilibrium nor collapse was found; ``"max_value"``:
        the parameter has exceeded `max_value`; ``"steps"``: the search took too many steps. The
        ``result`` of an error that has ended a search has ``"interrupted"``.
    text
        Explanation for a message.
    """

    kind: Literal["plateau", "collapse", "peak", "stall", "max_value", "steps", "interrupted"]
    text: str

    @property
    def shows_limit(self) -> bool:
        """True if the search has shown the limit."""
        return self.kind in ("plateau", "collapse")

    def __str__(self) -> str:
        return f"{self.kind}: {self.text}"


def no_collapse_below(max_value: float) -> Stop:
    """Return the end of a search that has come to its bound."""
    return Stop("max_value", f"there is no collapse below {max_value:g}")


@dataclass(frozen=True)
class SearchResult:
    """Equilibria and end of a search.

    Attributes
    ----------
    points
        Equilibria in the order they were found.
    stop
        Reason why the search ended.
    above
        Smallest parameter that is known not to be reached, or inf.
    motion
        Displacements at collapse, (N,); by default from the last equilibrium but one to the last.
    """

    points: Sequence[Point]
    stop: Stop
    above: float = np.inf
    motion: ndarray | None = None

    @property
    def best(self) -> Point:
        """Equilibrium of the largest parameter."""
        return max(self.points, key=lambda point: point.parameter)


@dataclass(frozen=True)
class CollapseResult:
    """Factor of safety or limit load, with the steps of the search; printed as a table.

    Attributes
    ----------
    what
        ``"factor of safety"`` or ``"limit load"``.
    value
        Largest factor or multiplier with an equilibrium: :attr:`factor`, :attr:`multiplier`.
    bracket
        The value, and the smallest one that is known not to be reached, by a collapse, by the last
        slope of the curve or by a proven bound; infinite where nothing is known.
    stop
        Reason why the search ended.
    flow
        Flow rule as given.
    reduced
        Names of forms and regions whose strength was reduced.
    mesh
        Elements and dofs.
    steps
        All steps, failed ones included.
    end
        Equilibrium at the largest factor of a strength reduction, or at the end of the curve of a
        limit load: a start for other analyses. :attr:`x`, :attr:`states` and :attr:`load` belong
        to this equilibrium.
    mechanism
        Displacement increment at collapse, its largest component is 1, (N,).
    bands
        Largest shear strain of the mechanism by solid, in the plane for plane ones, (n_elements,
        n_points).
    added
        Estimated share of the value that the size of the elements adds, within proven bounds. The
        true one is .5 to 2 times this share on slopes, vertical cuts with and without tensile
        strength, and under even loads and rigid strips; up to 2.6 times on meshes of few elements
        that are not straight triangles or quadrilaterals of solids with tensile strength: these are
        cut once more to see it. NaN where rock slips along its joints.
    path
        Factor or multiplier and displacements of every equilibrium.
    dilates_less
        True if soil has psi < phi: the value then depends on mesh and path.
    davis
        The search with the soils of Davis (procedure B), of a strength reduction with psi < phi:
        its factor is on the safe side.
    proven
        Proven bounds of the value, see ``certify``.
    unproven
        Reason why ``certify="auto"`` has proven no bounds.
    meshes
        Elements, value and estimated share that the mesh adds, for every mesh of ``refine=True``.
    """

    what: str
    value: float
    bracket: tuple[float, float]
    stop: Stop
    flow: str
    reduced: tuple[str, ...]
    mesh: str
    steps: tuple[Step, ...]
    end: StageResult
    mechanism: ndarray
    bands: Mapping[str, ndarray]
    added: float
    path: tuple[tuple[float, ndarray], ...]
    dilates_less: bool = False
    davis: CollapseResult | None = None
    proven: Bounds | None = None
    unproven: str = ""
    meshes: tuple[tuple[int, float, float], ...] = ()

    @property
    def factor(self) -> float:
        """Value of a strength reduction."""
        return self.value

    @property
    def multiplier(self) -> float:
        """Value of a limit load."""
        return self.value

    @property
    def error(self) -> str:
        """Share that the mesh adds in words, empty below half of a per cent."""
        is_known = self.stop.shows_limit and self.added >= 0.005
        if is_known:
            return f"about {self.added:.1%}"
        return ""

    @property
    def x(self) -> ndarray:
        """Displacements, (N,)."""
        return self.end.x

    @property
    def states(self) -> Mapping[str, object]:
        """States of the forms."""
        return self.end.states

    @property
    def load(self) -> ndarray:
        """Whole load, (N,)."""
        return self.end.load

    @property
    def iterations(self) -> int:
        """Newton iterations of all steps, failed ones included."""
        return sum(step.iterations for step in self.steps)

    @property
    def curve(self) -> ndarray:
        """Work of the load, parameter and largest displacement of all equilibria, (n, 3)."""
        found = [step for step in self.steps if step.outcome == "equilibrium"]
        return np.array([(step.work, step.parameter, step.displacement) for step in found])

    def __str__(self) -> str:
        return f"{self.head}\n{self._table()}"

    __repr__ = __str__  # a notebook would show the arrays

    def _repr_html_(self) -> str:
        rows = tuple(
            (
                f"{step.parameter:.5f}",
                step.outcome,
                step.iterations,
                f"{step.residual:.1e}",
                f"{step.displacement:.4g}",
                f"{step.yielding:.1%}",
            )
            for step in self.steps
        )
        columns = ("value", "outcome", "iterations", "residual", "displacement", "yielding")
        return Table(columns, rows, self.head)._repr_html_()

    @property
    def head(self) -> str:
        """Value, bounds, flow, mesh and end of the search as lines, without its steps."""
        # Begin with value and bounds.
        low, high = self.bracket
        lines = [f"{self.what} {self.value:.4g}, bracket [{low:.4g}, {high:.4g}]"]
        if self.davis:
            lines.append(f"with psi < phi: {self.davis.value:.4g} after Davis, on the safe side")
        if self.proven:
            lines.append(f"bounds: {str(self.proven).splitlines()[0]}")
        elif self.unproven:
            lines.append(f"no bounds: {self.unproven}")
        # Add what belongs to the search.
        lines.append(f"flow {self.flow}")
        if self.reduced:
            lines.append(f"reduced: {', '.join(self.reduced)}")
        if self.error:
            adds = f", whose size adds {self.error}"
        else:
            adds = ""
        lines.append(f"{self.mesh}{adds}; {self.iterations} Newton iterations")
        if self.meshes:
            values = ", ".join(f"{value:.4g} with {n}" for n, value, _ in self.meshes)
            lines.append(f"refined: {values} elements")
        lines.append(f"stopped by {self.stop}")
        return "\n".join(lines)

    def _table(self) -> str:
        """Format the steps as lines; displacements and yielding at equilibria only."""
        lines = [f"{'value':>10}  outcome      iterations  residual  displacement  yielding"]
        for step in self.steps:
            moved = yielding = "–"
            if step.outcome == "equilibrium":
                moved = f"{step.displacement:.4g}"
                yielding = f"{step.yielding:.1%}"
            lines.append(
                f"{step.parameter:10.5f}  {step.outcome:11}  {step.iterations:10d}  "
                f"{step.residual:8.1e}  {moved:>12}  {yielding:>8}"
            )
        return "\n".join(lines)

    def _advice(self) -> str:
        """Return advice where no limit was shown, for a message."""
        # Ends without a limit have their own causes.
        bodies = having(self.end.forms, Body)
        for name, form in bodies.items():
            x = self.end.x[: form.size]
            for remark in form.outputs(x, self.end.states[name]).remarks:
                if remark.kind == "swing":
                    return f"; {name}: {remark.text}"
        if self.stop.kind in ("max_value", "steps"):
            others = "parts that are not reduced resist the load"
            if any(has_corners_only(form.basis) for form in bodies.values()):
                return f"; elements of corner nodes alone may lock, or {others}"
            return f"; {others}"
        for name, form in bodies.items():
            if self.stop.kind == "stall" and form.quadrature_advice:
                return f"; {name}: {form.quadrature_advice}"
        # A path without normality may end.
        if self.flow == "given" and self.dilates_less:
            if self.davis is None:
                safe = ""
            else:
                safe = f", here {self.davis.value:.4g}"
            lagged = ""
            if self.what == LOAD:
                lagged = " or 'lagged'"
            return (
                f"; with psi < phi a path may end like this: flow='davis_b'{lagged} continues "
                f"(Davis is safe{safe})"
            )
        return ""

    def beside(self, proven: Bounds | None, tolerance: float) -> CollapseResult:
        """Add bounds; warn of a search without limit, instability, and a value outside bounds."""
        # warn of a value that is no limit, or below one
        if not self.stop.shows_limit:
            warn(
                f"no collapse was shown: the search for the {self.what} ended at {self.value:.4g}, "
                f"stopped by {self.stop}{self._advice()}"
            )
        elif self.what == FACTOR and self.value < 1.0:
            warn(
                "the structure is unstable under its own load: its factor of safety is "
                f"{self.value:.3f}"
            )
        warn_of_motion(self.what, self.value, self.curve, tolerance, self.end)
        added = self.added
        if proven is not None:
            added = within_bounds(added, self.value, proven)
        told = added if self.stop.shows_limit else 0.0
        warn_of_mesh(self.what, self.value, told, proven, tolerance)

        # narrow the bracket by the upper bound
        above = self.bracket[1]
        if proven is not None and proven.upper >= self.value:
            above = min(above, proven.upper)
        return replace(self, added=added, proven=proven, bracket=(self.bracket[0], above))


def _bands(system: System, mechanism: ndarray) -> dict[str, ndarray]:
    """Return the largest shear strain of a mechanism by solid, (n_elements, n_points)."""
    bands = {}
    for name, form in having(system.forms, Body).items():
        band = form.shear_strain(mechanism)
        if band is not None:
            bands[name] = band
    return bands


def conclude(
    what: str,
    search: SearchResult,
    last: Point,
    system: System,
    load: ndarray,
    steps: Sequence[Step],
    flow: str,
    reduced: tuple[str, ...] = (),
    davis: CollapseResult | None = None,
    multiplied: ndarray | None = None,
) -> CollapseResult:
    """Return the result of a search; other analyses start from the `last` equilibrium."""
    warn_of_errors(system, last.x, last.states)

    # scale the mechanism and find its bands
    motion = search.motion
    if motion is None:
        motion = search.points[-1].x - search.points[-2].x
    mechanism = motion / (max_abs(motion) or 1.0)
    bands = _bands(system, mechanism)
    warn_of_locking(system.forms, bands, last.states, mechanism)
    power = None
    if multiplied is not None:
        power = last.parameter * float(multiplied @ mechanism)
    lost = lost_power(system.forms, bands, last.states, mechanism)
    contact = power_of_contact(system, last.states, mechanism, load)
    added = added_by_mesh(lost, power, contact)
    if slips_on_planes(system.forms, bands, mechanism):
        warn_of_planes(what)
        added = np.nan

    # make a stage of the last equilibrium, with geometry that follows the displacements again
    forms, states = released(system.forms, last)
    iterations = sum(step.iterations for step in steps)
    residual = next(step.residual for step in reversed(steps) if step.outcome == "equilibrium")
    end = StageResult(
        what,
        last.x,
        load=load,
        states=states,
        iterations=(iterations,),
        residual=residual,
        forms=forms,
        layout=system.layout,
    )

    # collect the result
    value = search.best.parameter
    return CollapseResult(
        what=what,
        value=value,
        bracket=(value, search.above),
        stop=search.stop,
        flow=flow,
        reduced=reduced,
        mesh=describe_mesh(system.forms),
        steps=tuple(steps),
        end=end,
        mechanism=mechanism,
        bands=bands,
        added=added,
        path=tuple((point.parameter, point.x) for point in search.points),
        dilates_less=dilate_less(system.forms),
        davis=davis,
    )
