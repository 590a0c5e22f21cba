"""Limit load and load-displacement curve by indirect continuation."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from tqdm import tqdm

from ..errors import NotConverged
from ..forms import Form
from ..nonlinear.line_search import Search
from ..nonlinear.newton import Newton
from ..nonlinear.system import System
from ..solid import SolidForm
from ..solvers.threads import single_threaded
from ..stages.result import Result, StageResult
from ..stages.setup import build_system, check_load, left_by
from .continuation import GROWTH, Point, follow, starting_point
from .flow import Flow, associated_substitute, reduced_strength
from .history import SearchLog, Step, describe_mesh, shear_bands, table, warn_of_stall

_CUTS = 10
#: Growth of the steps where friction lags behind by one of them.
_SMALL_GROWTH = 1.5


@dataclass(frozen=True)
class LimitLoad:
    """Load multiplier at collapse and the curve to it; printed as a table.

    Attributes
    ----------
    multiplier
        Largest multiplier of the reference load with an equilibrium.
    bracket
        That multiplier, and what the last slope of the curve leaves room for.
    criterion
        What stopped the continuation.
    mesh
        Elements and unknowns.
    steps
        Every step.
    x, states
        Displacements and states at the end of the curve.
    load
        Whole load there, (N,).
    mechanism
        Displacement increment at collapse, its largest component is 1, (N,).
    bands
        In-plane shear strain of the mechanism by solid, (n_elements, n_points).
    path
        Multiplier and displacements of every equilibrium.
    """

    multiplier: float
    bracket: tuple[float, float]
    criterion: str
    mesh: str
    steps: tuple[Step, ...]
    x: ndarray = field(repr=False)
    states: Mapping[str, Any] = field(repr=False)
    load: ndarray = field(repr=False)
    mechanism: ndarray = field(repr=False)
    bands: Mapping[str, ndarray] = field(repr=False)
    path: tuple[tuple[float, ndarray], ...] = field(repr=False)

    @property
    def iterations(self) -> int:
        """Newton iterations of all steps, failed ones included."""
        return sum(step.iterations for step in self.steps)

    @property
    def curve(self) -> ndarray:
        """Work of the reference load, multiplier and largest displacement of all equilibria, (n, 3)."""
        return np.array([(t.work, t.parameter, t.displacement) for t in self.steps if t.outcome == "equilibrium"])

    @property
    def end(self) -> StageResult:
        """What the bodies carry at the end of the curve: a start for other analyses."""
        last = next(t for t in reversed(self.steps) if t.outcome == "equilibrium")
        return StageResult("limit load", self.x, self.load, self.states, (self.iterations,), last.residual)

    def __str__(self) -> str:
        return (f"limit load {self.multiplier:.4g} times the reference load, bracket "
                f"[{self.bracket[0]:.4g}, {self.bracket[1]:.4g}]\n"
                f"{self.mesh}; {self.iterations} Newton iterations\n"
                f"stopped by {self.criterion}\n{table(self.steps, 'multiplier')}")

    __repr__ = __str__  # a notebook would show the arrays


class _Load:
    """A constant load and a multiple of another one: a :class:`~.continuation.Branch`."""

    lowest = -np.inf
    search: Search = "energy"

    def __init__(self, system: System, dead: ndarray, reference: ndarray) -> None:
        self.system, self.dead, self.reference = system, dead, reference

    def at(self, parameter: float) -> tuple[System, ndarray]:
        """The forms, and the load at a multiplier."""
        return self.system, self.dead + parameter * self.reference


@single_threaded
def limit_load(forms: Mapping[str, Form], fixed: ndarray, load: ndarray, start: Result | StageResult | None = None,
               tol: float = 0.005, step: float = 1.0, highest: float = np.inf, flow: Flow | Literal["lagged"] = "given",
               newton: Newton | None = None, solver: Any = None, progress: bool | None = None,
               longest: float = np.inf, until: float = 0.0) -> LimitLoad:
    """Multiply a load until the structure collapses.

    The work of the reference load is prescribed and its multiplier follows, until the curve of the multiplier
    over the work has levelled off.  The curve goes on where a load-controlled analysis ends.

    Parameters
    ----------
    forms
        Solids and contact pairs by name; those that ``start`` does not hold are not there.
    fixed
        Unknowns that are held where they are.
    load
        Reference load, (N,).
    start
        Where to start: a result (its last stage) or a stage, whose load stays.  By default the bodies are
        unstrained and carry nothing.
    tol
        The curve ends when its last slope lets the multiplier rise by no more than this share.
    step
        First multiplier; it is halved until there is an equilibrium.
    highest
        The curve ends when the multiplier exceeds this.
    flow
        Flow rule, see :func:`reduced_strength`, or ``"lagged"``: as given, with the friction of the pressure at the
        start of each step (Krabbenhoft and others 2012). With psi < phi the given law takes hundreds
        of iterations or stalls; the lagged one does not, but must start from equilibrium with its own friction.
        In long steps it carries more than the given law; `longest` keeps them short.
    newton
        Settings of Newton's method; by default the residual is at most 0.03 ``tol`` of the load.
    solver
        A scikit-fem linear solver ``(A, b) -> x``.
    progress
        Show a progress bar; by default where the output is a terminal.
    longest
        Work of the longest step over that of the first one.  Steps grow up to it; without it, until the end.
    until
        The curve does not end at a peak or plateau before a displacement is as large as this.

    Raises
    ------
    ValueError
        No load, or bad input.
    NotConverged
        No step was small enough to begin with.

    Warns
    -----
    AnalysisWarning
        The search ended at a stall, and the limit load may be higher.

    Examples
    --------
    A square of cohesive soil (c = 10) that can spread carries 2 c:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> column = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=.3, c=10., phi=0.), strain=sc.b_bar)
    >>> fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    >>> load = basis.zeros()
    >>> load[basis.get_dofs("top").nodal["u^2"]] = -np.array([.25, .25, .5])
    >>> print(f"{sc.limit_load({'soil': column}, fixed, load).multiplier:.3f}")
    20.000
    """
    if not tol > 0 or not step > 0 or not longest > 0:
        raise ValueError(f"tol, step and longest must be positive, not {tol!r}, {step!r} and {longest!r}")
    last = start[-1] if isinstance(start, Result) else start
    system = build_system(*left_by(last, _flowing(forms, flow), fixed), solver)
    reference = check_load(load, system.unknowns)
    branch = _Load(system, np.zeros(system.size) if last is None else last.load, reference)
    newton = newton or Newton(tolerance=0.03 * tol, max_iterations=30)
    path: list[Point] = []
    with tqdm(desc="limit load", disable=None if progress is None else not progress,
              bar_format="{desc} {postfix} {elapsed}") as bar:
        log = SearchLog(bar)
        origin = starting_point(system, last)
        log.begin(origin)
        path = [origin, _first(branch, origin, step, newton, log)]
        curve = follow(branch, reference, path, newton, tol, log, relative=True, highest=highest,
                       growth=_SMALL_GROWTH if flow == "lagged" else GROWTH, longest=longest * path[-1].work,
                       until=until)
    multiplier, above = curve.limit
    warn_of_stall("limit load", multiplier, curve.criterion)
    end = curve.points[-1]
    mechanism = end.x - curve.points[-2].x
    mechanism = mechanism / (np.abs(mechanism).max() or 1.0)
    return LimitLoad(multiplier, (multiplier, above), curve.criterion, describe_mesh(system.forms),
                     tuple(log.steps), end.x, end.states, branch.at(end.parameter)[1], mechanism,
                     shear_bands(system.forms, mechanism), tuple((p.parameter, p.x) for p in curve.points))


def _flowing(forms: Mapping[str, Form], flow: Flow | Literal["lagged"]) -> dict[str, Form]:
    """The forms with their flow as it is assumed."""
    new = dict(forms)
    for name, form in forms.items():
        if isinstance(form, SolidForm) and flow != "given":
            soils = {region: soil for region, soil in form.materials.items() if hasattr(soil, "psi")}
            new[name] = form.with_materials({region: associated_substitute(soil) if flow == "lagged" else
                                             reduced_strength(soil, 1.0, flow) for region, soil in soils.items()})
    return new


def _first(branch: _Load, origin: Point, step: float, newton: Newton, log: SearchLog) -> Point:
    """The first loaded equilibrium."""
    for cut in range(_CUTS):
        multiplier = step * 0.5**cut
        system, load = branch.at(multiplier)
        try:
            found = system.equilibrium(origin.x, origin.states, load, origin.x[system.fixed], newton, ("energy",),
                                       at_least=1)
        except NotConverged as error:
            log.reject(multiplier, error, 0.0)
            continue
        point = Point(found.x, found.states, multiplier, system.work(branch.reference, found.x - origin.x),
                      found.residuals)
        log.accept(point)
        return point
    raise NotConverged(f"no equilibrium was found under {multiplier:g} times the reference load; is the structure "
                       "stable without it?")
