"""Results of searches for a collapse: how they ended, what they found, and what a user must know of them."""
from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy import ndarray

from ..display import html_table
from ..errors import AnalysisWarning
from ..forms.base import Form, solids_of
from ..limit_analysis import Bounds
from ..nonlinear.system import System
from ..results.result import StageResult
from .history import Point, Step

FACTOR, LOAD = "factor of safety", "limit load"


@dataclass(frozen=True)
class Stop:
    """Why a search ended.

    Attributes
    ----------
    kind
        ``"plateau"``: the curve has levelled off; ``"collapse"``: there is no equilibrium close above; these show the
        limit.  The others do not: ``"peak"``: the curve falls, and another path may lead higher; ``"stall"``: neither
        equilibrium nor collapse was found; ``"highest"``: the parameter reached the bound of the search; ``"steps"``:
        their number did.
    text
        What a reader should know of it.
    """

    kind: Literal["plateau", "collapse", "peak", "stall", "highest", "steps"]
    text: str

    @property
    def shows_limit(self) -> bool:
        """Whether the search has shown where the limit is."""
        return self.kind in ("plateau", "collapse")

    def __str__(self) -> str:
        return f"{self.kind}: {self.text}"


def no_collapse_below(highest: float) -> Stop:
    """The end of a search that has come to its bound."""
    return Stop("highest", f"there is no collapse below {highest:g}")


@dataclass(frozen=True)
class Found:
    """What a search ends with.

    Attributes
    ----------
    points
        Equilibria in the order they were found.
    stop
        Why it ends there.
    above
        The smallest parameter that is known not to be reached; infinite where nothing is known.
    motion
        Displacements at collapse, (N,); by default those from the last equilibrium but one to the last.
    """

    points: Sequence[Point]
    stop: Stop
    above: float = np.inf
    motion: ndarray | None = None

    @property
    def highest(self) -> Point:
        """The equilibrium of the largest parameter."""
        return max(self.points, key=lambda point: point.parameter)


@dataclass(frozen=True)
class CollapseResult:
    """A factor of safety or a limit load, and how it was found; printed as a table.

    Attributes
    ----------
    what
        ``"factor of safety"`` or ``"limit load"``.
    value
        Largest factor or multiplier with an equilibrium: :attr:`factor`, :attr:`multiplier`.
    bracket
        That value, and the smallest one that is known not to be reached: where collapse was shown, or what the last
        slope of the curve leaves room for; infinite where nothing is known.
    stop
        Why the search ended.
    method, flow
        As they were asked for.
    reduced
        Names of forms and regions whose strength was reduced.
    mesh
        Elements and unknowns.
    steps
        Every step.
    end
        What the bodies carry: at the largest factor of a strength reduction, at the end of the curve of a limit load.
        It is a start for other analyses; :attr:`x`, :attr:`states` and :attr:`load` are its own.
    mechanism
        Displacement increment at collapse, its largest component is 1, (N,).
    bands
        Largest shear strain of the mechanism by solid, in the plane for plane ones, (n_elements, n_points).
    path
        Factor or multiplier and displacements of every equilibrium.
    dilates_less
        Whether soil has psi < phi, so that the value depends on mesh and path.
    davis
        The search with the soils of Davis (procedure B), of a strength reduction with psi < phi: its factor is on the
        safe side.
    proven
        The bounds of the value, with ``certify=True``.
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
    path: tuple[tuple[float, ndarray], ...] = field(repr=False)
    dilates_less: bool = False
    davis: CollapseResult | None = field(default=None, repr=False)
    proven: Bounds | None = field(default=None, repr=False)

    @property
    def factor(self) -> float:
        """The value, of a strength reduction."""
        return self.value

    @property
    def multiplier(self) -> float:
        """The value, of a limit load."""
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
        """Work of the load, factor or multiplier, and largest displacement of all equilibria, (n, 3)."""
        return np.array([(t.work, t.parameter, t.displacement) for t in self.steps if t.outcome == "equilibrium"])

    def __str__(self) -> str:
        reduced = f"reduced: {', '.join(self.reduced)}\n" if self.reduced else ""
        davis = f"with psi < phi: {self.davis.value:.4g} after Davis, on the safe side\n" if self.davis else ""
        proven = f"bounds: {str(self.proven).splitlines()[0]}\n" if self.proven else ""
        return (f"{self.what} {self.value:.4g}, bracket [{self.bracket[0]:.4g}, {self.bracket[1]:.4g}]\n{davis}{proven}"
                f"{self.method}, flow {self.flow}\n{reduced}{self.mesh}; {self.iterations} Newton iterations\n"
                f"stopped by {self.stop}\n{self._table()}")

    __repr__ = __str__  # a notebook would show the arrays

    def _repr_html_(self) -> str:
        rows = [(f"{s.parameter:.5f}", s.outcome, s.iterations, f"{s.residual:.1e}", f"{s.displacement:.4g}",
                 f"{s.yielding:.1%}") for s in self.steps]
        head = str(self).split("\n" + self._table())[0]
        return html_table(("value", "outcome", "iterations", "residual", "displacement", "yielding"), rows, head)

    def _table(self) -> str:
        """The steps as lines; displacements and yielding only where there is equilibrium."""
        lines = [f"{'value':>10}  outcome      iterations  residual  displacement  yielding"]
        for s in self.steps:
            found = s.outcome == "equilibrium"
            moved, yielding = (f"{s.displacement:.4g}", f"{s.yielding:.1%}") if found else ("–", "–")
            lines.append(f"{s.parameter:10.5f}  {s.outcome:11}  {s.iterations:10d}  {s.residual:8.1e}  {moved:>12}  "
                         f"{yielding:>8}")
        return "\n".join(lines)

    def _advice(self) -> str:
        """What may help where no limit was shown."""
        if self.stop.kind in ("highest", "steps"):
            return "; elements of order 1 may lock (strain=b_bar), or what is not reduced carries the load"
        if self.flow == "given" and self.dilates_less:
            safe = "" if self.davis is None else f", here {self.davis.value:.4g}"
            lagged = " or 'lagged'" if self.what == LOAD else ""
            return f"; with psi < phi a path may end like this: flow='davis_b'{lagged} goes on (Davis is safe{safe})"
        return ""

    def beside(self, proven: Bounds | None, tol: float, stacklevel: int) -> CollapseResult:
        """The result with its bounds; warn of a search without limit, a factor below 1, a value beyond its bounds."""
        if not self.stop.shows_limit:
            warnings.warn(f"no collapse was shown: the search for the {self.what} ended at {self.value:.4g} with a "
                          f"{self.stop}{self._advice()}", AnalysisWarning, stacklevel=stacklevel + 1)
        elif self.what == FACTOR and self.value < 1.0:
            warnings.warn(f"the structure is unstable under its own load: its factor of safety is {self.value:.3f}",
                          AnalysisWarning, stacklevel=stacklevel + 1)
        if proven is None:
            return self
        where = f"the {self.what} {self.value:.4g} lies {{}} [{proven.lower:.4g}, {proven.upper:.4g}], its bounds: "
        if self.value > proven.upper + tol:
            warnings.warn(where.format("above") + "the mesh is too coarse, or elements of order 1 lock (strain=b_bar); "
                          "`proven.mesh` is a better one", AnalysisWarning, stacklevel=stacklevel + 1)
        elif self.value < proven.lower - tol and not proven.estimate:
            warnings.warn(where.format("below") + "the search ended too early, or the flow is not associated",
                          AnalysisWarning, stacklevel=stacklevel + 1)
        return replace(self, proven=proven)


def describe_mesh(forms: Mapping[str, Form]) -> str:
    """Elements and unknowns in one line, such as ``576 ElementTriP2, 2442 unknowns``."""
    bases = [form.basis for form in solids_of(forms).values()]
    count = Counter[str]()
    for basis in bases:
        count[type(basis.elem.elem).__name__] += basis.nelems
    elements = " and ".join(f"{n} {kind}" for kind, n in count.items())
    return f"{elements}, {bases[0].N} unknowns" if bases else "no elements"


def conclude(what: str, found: Found, last: Point, system: System, load: ndarray, steps: Sequence[Step], method: str,
             flow: str, reduced: tuple[str, ...] = (), davis: CollapseResult | None = None) -> CollapseResult:
    """The result of a search whose `last` equilibrium, with its forms and load, other analyses start from."""
    motion = found.points[-1].x - found.points[-2].x if found.motion is None else found.motion
    mechanism = motion / (np.abs(motion).max() or 1.0)
    bands = {name: band for name, form in system.forms.items() if (band := form.shear_strain(mechanism)) is not None}
    less = any(material.dilates_less for form in system.forms.values() for material in form.materials.values())
    iterations = sum(step.iterations for step in steps)
    residual = next(step.residual for step in reversed(steps) if step.outcome == "equilibrium")
    released = {name: form.released(last.x, last.states[name]) for name, form in system.forms.items()}
    forms, states = ({name: pair[i] for name, pair in released.items()} for i in (0, 1))
    end = StageResult(what, last.x, load, states, (iterations,), residual, forms=forms, layout=system.layout)
    value = found.highest.parameter
    return CollapseResult(what, value, (value, found.above), found.stop, method, flow, reduced,
                          describe_mesh(system.forms), tuple(steps), end, mechanism, bands,
                          tuple((point.parameter, point.x) for point in found.points), less, davis)
