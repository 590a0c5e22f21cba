"""Limit load and load-displacement curve by indirect continuation."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from ..display import progress_bar
from ..errors import NotConverged
from ..forms.base import Form
from ..limit_analysis import beside
from ..materials.reduction import Flow, check_reduction
from ..nonlinear.line_search import Search
from ..nonlinear.newton import Newton
from ..nonlinear.system import System
from ..results.result import Result, StageResult
from ..solvers.threads import single_threaded
from .continuation import GROWTH, follow, last_stage, loaded_start
from .history import Point, SearchLog
from .result import LOAD, CollapseResult, conclude

_CUTS = 10
#: Growth of the steps where friction lags behind by one of them.
_SMALL_GROWTH = 1.5


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
               tol: float = 0.005, step: float = 1.0, highest: float = np.inf, flow: Flow = "given",
               newton: Newton | None = None, solver: Any = None, progress: bool | None = None,
               longest: float = np.inf, until: float = 0.0, certify: bool | Mapping[str, Any] = False
               ) -> CollapseResult:
    """Multiply a load until the structure collapses.

    The work of the reference load is prescribed and its multiplier follows, until the curve of the multiplier
    over the work has levelled off.  The curve goes on where a load-controlled analysis ends.

    Parameters
    ----------
    forms, fixed, solver, progress
        As for :func:`strength_reduction`.
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
        Flow rule, see :func:`reduced_strength`.  With psi < phi the law as given takes hundreds of iterations or
        stalls; one that is ``"lagged"`` (Krabbenhoft and others 2012) does not, but must start from equilibrium with
        its own friction, and in long steps it carries more than the given law: `longest` keeps them short.
    newton
        Settings of Newton's method; by default the residual is at most 0.03 ``tol`` of the load.
    longest
        Work of the longest step over that of the first one.  Steps grow up to it; without it, until the end.
    until
        The curve does not end at a peak or plateau before a displacement is as large as this.
    certify
        Whether to prove bounds as well, as in :func:`strength_reduction`; water is that of the start.

    Raises
    ------
    ValueError
        No load, or bad input.
    NotConverged
        No step was small enough to begin with.

    Warns
    -----
    AnalysisWarning
        The search has shown no limit, and it may be higher: :attr:`CollapseResult.stop` says why.  Or the value lies
        outside of the proven bounds by more than `tol`.

    Examples
    --------
    A square of cohesive soil (c = 10) that can spread carries 2 c:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> column = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=.3, c=10., phi=0.), strain="b_bar")
    >>> fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    >>> load = basis.zeros()
    >>> load[basis.get_dofs("top").nodal["u^2"]] = -np.array([.25, .25, .5])
    >>> print(f"{sc.Model({'soil': column}, fixed).limit_load(load).multiplier:.3f}")
    20.000
    """
    check_reduction(1.0, flow)
    if not tol > 0 or not step > 0 or not longest > 0:
        raise ValueError(f"tol, step and longest must be positive, not {tol!r}, {step!r} and {longest!r}")
    given, system, origin, reference = loaded_start(forms, fixed, load, start, solver)
    if flow != "given":
        system = system.with_forms({name: form.reduced(1.0, flow, form.strengths)
                                    for name, form in system.forms.items()})
    last = last_stage(start)
    dead = np.zeros(system.size) if last is None else last.load
    proven = beside(certify, given, system.fixed, dead, reference, flow=flow, progress=progress)
    branch = _Load(system, dead, reference)
    newton = newton or Newton(tolerance=0.03 * tol, max_iterations=30)
    with progress_bar(progress, desc=LOAD, bar_format="{desc} {postfix} {elapsed}") as bar:
        log = SearchLog(system.forms, bar, origin)
        points = [origin, _first(branch, origin, step, newton, log)]
        found = follow(branch, reference, points, newton, tol, log, relative=True, highest=highest,
                       growth=_SMALL_GROWTH if flow == "lagged" else GROWTH, longest=longest * points[-1].work,
                       until=until)
    end = found.points[-1]
    result = conclude(LOAD, found, end, system, branch.at(end.parameter)[1], log.steps, "continuation", flow)
    return result.beside(proven, tol * abs(result.value), stacklevel=3)


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
