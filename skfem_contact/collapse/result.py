"""Searches for a collapse: their steps, ends and results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..display import Table
from ..errors import NoEquilibrium, NotConverged, warn
from ..limit_analysis import Bounds
from ..nonlinear.system import System
from ..results.stage import StageResult
from .mechanism import (
    FACTOR,
    LOAD,
    added_by_mesh,
    describe_mesh,
    warn_of_errors,
    warn_of_mesh,
    warn_of_motion,
)


class PeakPassed(NotConverged):
    """Equilibrium below the last one: the step was too long, or the curve has a peak."""


@dataclass(frozen=True)
class Point:
    """Equilibrium on the curve of parameter over work: displacements, (N,), and states; see
    :class:`Step`.
    """

    x: ndarray
    states: Mapping[str, Any]
    parameter: float
    work: float = 0.0
    residuals: tuple[float, ...] = (0.0,)

    @property
    def iterations(self) -> int:
        """Number of tangents factored on the way from the last point to this one."""
        return len(self.residuals) - 1


def kind_of(error: NotConverged) -> Literal["collapse", "peak", "stall"]:
    """Return the outcome of a step that failed."""
    return (
        "collapse"
        if isinstance(error, NoEquilibrium)
        else "peak"
        if isinstance(error, PeakPassed)
        else "stall"
    )


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
        self._forms, self._bar, self._displacements = system.forms, bar, system.layout.displacements
        self.begin(origin)

    def begin(self, point: Point) -> None:
        """Count displacements and flow from a point."""
        self._origin, self._states = point.x, point.states

    def accept(self, point: Point) -> None:
        """Add an equilibrium."""
        self._add(
            Step(
                point.parameter,
                "equilibrium",
                point.iterations,
                point.residuals[-1],
                self.moved(point.x),
                self._yielding(point.states),
                point.work,
            )
        )
        self._states = point.states

    def reject(self, parameter: float, error: NotConverged, work: float) -> None:
        """Add a step without equilibrium."""
        self._add(
            Step(
                parameter,
                kind_of(error),
                max(len(error.residuals) - 1, 0),
                error.residuals[-1] if error.residuals else np.nan,
                self.moved(error.x),
                np.nan,
                work,
            )
        )

    def moved(self, x: ndarray | None) -> float:
        """Return the largest displacement from where counting began; pressures and multipliers do
        not count.
        """
        return (
            np.nan
            if x is None
            else float(np.abs((x - self._origin)[self._displacements]).max(initial=0.0))
        )

    @property
    def straight(self) -> bool:
        """True if no point of a solid has flowed in the last step: bars and joints make curves of
        straight pieces.
        """
        return self.steps[-1].yielding == 0.0

    def _yielding(self, states: Mapping[str, Any]) -> float:
        """Return the share of the points of all solids that have flowed since the last
        equilibrium.
        """
        flowed, points = np.sum(
            [f.yielding(self._states[k], states[k]) for k, f in self._forms.items()], axis=0
        )
        return float(flowed / points) if points else 0.0

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
        Two kinds show the limit. ``"plateau"``: the curve has levelled off; ``"collapse"``: there
        is no equilibrium close above. Four do not. ``"peak"``: the curve falls, and another path
        may lead higher; ``"stall"``: neither equilibrium nor collapse was found; ``"max_value"``:
        the parameter has exceeded `max_value`; ``"steps"``: the search took too many steps.
    text
        Explanation for a message.
    """

    kind: Literal["plateau", "collapse", "peak", "stall", "max_value", "steps"]
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
        Smallest parameter that is known not to be reached; infinite where nothing is known.
    motion
        Displacements at collapse, (N,); by default those from the last equilibrium but one to the
        last.
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
        That value, and the smallest one that is known not to be reached, by a collapse or by the
        last slope of the curve; infinite where nothing is known.
    stop
        Reason why the search ended.
    method, flow
        Method and flow rule as given.
    reduced
        Names of forms and regions whose strength was reduced.
    mesh
        Elements and dofs.
    steps
        All steps, failed ones included.
    end
        Equilibrium at the largest factor of a strength reduction, or at the end of the curve of a
        limit load: a start for other analyses. :attr:`x`, :attr:`states` and :attr:`load` are those
        of this equilibrium.
    mechanism
        Displacement increment at collapse, its largest component is 1, (N,).
    bands
        Largest shear strain of the mechanism by solid, in the plane for plane ones, (n_elements,
        n_points).
    added
        Estimated share of the value that the size of the elements adds, right to a factor of two in
        most scenes; up to three times too large under rigid strips on ground with friction and
        weight.
    path
        Factor or multiplier and displacements of every equilibrium.
    dilates_less
        True if soil has psi < phi: the value then depends on mesh and path.
    davis
        The search with the soils of Davis (procedure B), of a strength reduction with psi < phi:
        its factor is on the safe side.
    proven
        Proven bounds of the value, see ``certify``.
    """

    what: str
    value: float
    bracket: tuple[float, float]
    stop: Stop
    method: str
    flow: str
    reduced: tuple[str, ...]
    mesh: str
    steps: tuple[Step, ...]
    end: StageResult = field(repr=False)
    mechanism: ndarray = field(repr=False)
    bands: Mapping[str, ndarray] = field(repr=False)
    added: float
    path: tuple[tuple[float, ndarray], ...] = field(repr=False)
    dilates_less: bool = False
    davis: CollapseResult | None = field(default=None, repr=False)
    proven: Bounds | None = field(default=None, repr=False)

    @property
    def factor(self) -> float:
        """Value of a strength reduction."""
        return self.value

    @property
    def multiplier(self) -> float:
        """Value of a limit load."""
        return self.value

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
        """Work of the load, factor or multiplier, and largest displacement of all equilibria, (n,
        3).
        """
        return np.array(
            [
                (t.work, t.parameter, t.displacement)
                for t in self.steps
                if t.outcome == "equilibrium"
            ]
        )

    def __str__(self) -> str:
        reduced = f"reduced: {', '.join(self.reduced)}\n" if self.reduced else ""
        davis = (
            f"with psi < phi: {self.davis.value:.4g} after Davis, on the safe side\n"
            if self.davis
            else ""
        )
        proven = f"bounds: {str(self.proven).splitlines()[0]}\n" if self.proven else ""
        adds = f", whose size adds about {self.added:.0%}" if self.added >= 0.01 else ""
        return (
            f"{self.what} {self.value:.4g}, bracket [{self.bracket[0]:.4g}, "
            f"{self.bracket[1]:.4g}]\n{davis}{proven}"
            f"{self.method}, flow {self.flow}\n{reduced}{self.mesh}{adds}; {self.iterations} "
            f"Newton iterations\n"
            f"stopped by {self.stop}\n{self._table()}"
        )

    __repr__ = __str__  # a notebook would show the arrays

    def _repr_html_(self) -> str:
        rows = tuple(
            (
                f"{s.parameter:.5f}",
                s.outcome,
                s.iterations,
                f"{s.residual:.1e}",
                f"{s.displacement:.4g}",
                f"{s.yielding:.1%}",
            )
            for s in self.steps
        )
        head = str(self).split("\n" + self._table())[0]
        columns = ("value", "outcome", "iterations", "residual", "displacement", "yielding")
        return Table(columns, rows, head)._repr_html_()

    def _table(self) -> str:
        """Format the steps as lines; displacements and yielding only where there is equilibrium."""
        lines = [f"{'value':>10}  outcome      iterations  residual  displacement  yielding"]
        for s in self.steps:
            found = s.outcome == "equilibrium"
            moved, yielding = (
                (f"{s.displacement:.4g}", f"{s.yielding:.1%}") if found else ("–", "–")
            )
            lines.append(
                f"{s.parameter:10.5f}  {s.outcome:11}  {s.iterations:10d}  {s.residual:8.1e}  "
                f"{moved:>12}  "
                f"{yielding:>8}"
            )
        return "\n".join(lines)

    def _advice(self) -> str:
        """Return what may help where no limit was shown."""
        if self.stop.kind in ("max_value", "steps"):
            return "; elements of order 1 may lock (strain='b_bar'), or parts that are not reduced resist the load"
        if self.flow == "given" and self.dilates_less:
            safe = "" if self.davis is None else f", here {self.davis.value:.4g}"
            lagged = " or 'lagged'" if self.what == LOAD else ""
            return f"; with psi < phi a path may end like this: flow='davis_b'{lagged} continues (Davis is safe{safe})"
        return ""

    def beside(self, proven: Bounds | None, tolerance: float) -> CollapseResult:
        """Add bounds; warn of a search without limit, a factor below 1, a value beyond its
        bounds.
        """
        if not self.stop.shows_limit:
            warn(
                f"no collapse was shown: the search for the {self.what} ended at {self.value:.4g}, "
                f"stopped by "
                f"{self.stop}{self._advice()}"
            )
        elif self.what == FACTOR and self.value < 1.0:
            warn(
                f"the structure is unstable under its own load: its factor of safety is "
                f"{self.value:.3f}"
            )
        warn_of_motion(self.what, self.value, self.curve, tolerance, self.end)
        warn_of_mesh(
            self.what, self.value, self.added if self.stop.shows_limit else 0.0, proven, tolerance
        )
        return replace(self, proven=proven)


def conclude(
    what: str,
    found: SearchResult,
    last: Point,
    system: System,
    load: ndarray,
    steps: Sequence[Step],
    method: str,
    flow: str,
    reduced: tuple[str, ...] = (),
    davis: CollapseResult | None = None,
    multiplied: ndarray | None = None,
) -> CollapseResult:
    """Return the result of a search; other analyses start from the `last` equilibrium."""
    warn_of_errors(system, last.x, last.states)
    motion = found.points[-1].x - found.points[-2].x if found.motion is None else found.motion
    mechanism = motion / (np.abs(motion).max() or 1.0)
    bands = {
        name: band
        for name, form in system.forms.items()
        if (band := form.shear_strain(mechanism)) is not None
    }
    less = any(
        material.dilates_less
        for form in system.forms.values()
        for material in form.materials.values()
    )
    iterations = sum(step.iterations for step in steps)
    residual = next(step.residual for step in reversed(steps) if step.outcome == "equilibrium")
    released = {
        name: form.released(last.x, last.states[name]) for name, form in system.forms.items()
    }
    forms, states = ({name: pair[i] for name, pair in released.items()} for i in (0, 1))
    end = StageResult(
        what, last.x, load, states, (iterations,), residual, forms=forms, layout=system.layout
    )
    value = found.best.parameter
    power = None if multiplied is None else last.parameter * float(multiplied @ mechanism)
    return CollapseResult(
        what,
        value,
        (value, found.above),
        found.stop,
        method,
        flow,
        reduced,
        describe_mesh(system.forms),
        tuple(steps),
        end,
        mechanism,
        bands,
        added_by_mesh(system.forms, bands, last.states, mechanism, power),
        tuple((point.parameter, point.x) for point in found.points),
        less,
        davis,
    )
