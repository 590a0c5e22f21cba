"""Factor of safety by reduction of the strength."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..checks import names_of
from ..display import progress_bar
from ..errors import AnalysisWarning, NoEquilibrium, NotConverged, saying, warn
from ..forms.base import Form, Forms, States, part_names, reduced_parts, solids_of
from ..forms.roles import Body, Reducible, having, materials_of
from ..limit_analysis import Bounds, at_hand, beside
from ..materials.base import PLASTIC_STRAIN, Flow, check_reduction
from ..materials.mohr_coulomb import CohesiveFrictional
from ..nonlinear.newton import Evaluation, Newton, Search
from ..nonlinear.step import Attempt, Step
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult
from ..stages.setup import Setup
from ..stages.stage import AtRest, Force
from . import finer
from .accepted import Accepted
from .continuation import Branch, Course, SearchStart, follow, loaded_start, motion
from .mechanism import FACTOR, as_collapse, is_singular
from .result import (
    CollapseResult,
    Point,
    SearchLog,
    SearchResult,
    Stop,
    conclude,
    no_collapse_below,
)

logger = logging.getLogger("skfem_contact")

#: Factors at which the first equilibrium is sought, in turn.
_FIRST = (1.0, 0.7, 0.5, 0.35, 0.25)
#: Relative step of the difference quotient by the factor.
_DIFFERENCE = 1e-6
#: Residual over the tolerance of the factor, and with psi < phi: there 0.03 costs 145 iterations
#: for 91, 181 for 120 and 367 for 208 (ACADS 1(a), 1(c), 3(a)), and the factors differ by at most
#: 0.002.
_BALANCE = 0.03
_LOOSE = 0.1
#: ... and with a tension cut-off: there the thin mechanism of a vertical cut needs little residual,
#: and with .03 and a tolerance of .02 factors stop up to 1.8 % higher than those of the mesh.
_TORN = 0.01
#: Iterations of an equilibrium, likewise with a tension cut-off: on tall elements a vertical cut
#: takes 70 of them under its whole weight, and then its factor is found in 340 to 580; with 30 the
#: way from half of the strength takes 780, or stops at .75 or 1.12 of 1.32.
_ITERATIONS = 30
_OF_TORN = 120
#: Share of the tolerance that the curve's end may leave open.
_OPEN = 0.25
#: Work, as a share of the elastic work of the whole load and of what the residual's tolerance
#: leaves, from which it can be prescribed: a block that sticks does .6 times its residual, 1.1e-4,
#: without any motion.
_NOTICEABLE = 1e-4
#: First factor on a finer mesh, over the last one. The stresses of the last mesh begin the search:
#: meshes take 15 to 30 iterations, 90 to 130 from unstrained ground.
_BEGIN = 0.97
#: First step on a finer mesh, over the last factor.
_STEP = 0.01
#: Share of the largest force of water and loads that is round-off of their difference.
_ROUND_OFF = 1e-9
#: Error on the first mesh as a share of the tolerance: estimates alone are .4 to 1.2 times the
#: error of the seven published slopes. Later meshes show it by how much the factor falls.
_ALONE = 0.5
#: Elements beyond which a mesh is not refined any more.
_MOST_ELEMENTS = 60_000
_BY_RESIDUAL = 3.0


class _Strength(Branch):
    """Structure with its strength divided by a factor.

    The structure is known to be stable at all factors up to ``safe``, and at none from ``above``
    on.
    """

    lowest = 0.0

    def __init__(
        self,
        system: System,
        load: ndarray,
        targets: dict[str, tuple[str, ...]],
        flow: Flow,
    ) -> None:
        self.system = system
        self.load = load
        self.targets = targets
        self.flow = flow
        self.safe = 0.0
        self.above = np.inf
        self.with_contact = system.unilateral
        self.search: Search = "either" if self.with_contact else "step"

    @property
    def materials(self) -> list[Any]:
        """Materials of the reduced parts."""
        found = []
        for name, parts in self.targets.items():
            materials = materials_of(self.system.forms[name])
            found += [materials[part] for part in parts if part]
        return found

    @property
    def dilates_less(self) -> bool:
        """True if a reduced material dilates less than its friction under the given flow rule."""
        return self.flow == "given" and any(soil.dilates_less for soil in self.materials)

    @property
    def tears(self) -> bool:
        """True if a reduced material has a tension cut-off."""
        soils = []
        for soil in self.materials:
            if isinstance(soil, CohesiveFrictional):
                soils.append(soil)
        return any(soil.tension is not None for soil in soils)

    def is_convex(self, system: System) -> bool:
        """Return True if bodies minimise a convex potential: a second search repeats the first.

        Vertical cuts without tensile strength take 47 to 151 iterations for 47 to 226.
        """
        return system.symmetric and not self.with_contact and not self.dilates_less

    def bound(self, davis: CollapseResult) -> float:
        """Return a factor that no dilatancy reaches, where Radenkovic's theorem holds, or inf."""
        if not davis.stop.shows_limit:
            return np.inf
        for name, form in self.system.forms.items():
            if isinstance(form, Reducible):
                form = form.reduced(1.0, "associated", self.targets.get(name, ()))
            if not form.symmetric:
                return np.inf
        return max(material.associated_bound(davis.bracket[1]) for material in self.materials)

    def at(self, parameter: float) -> tuple[System, ndarray]:
        """Return forms of reduced strength, and the load."""
        return self.system.with_forms({**self.system.forms, **self._reduced(parameter)}), self.load

    def _reduced(self, factor: float) -> dict[str, Form]:
        """Return the forms that are reduced, at a factor."""
        reducible = having(self.system.forms, Reducible)
        return {
            name: reducible[name].reduced(factor, self.flow, parts)
            for name, parts in self.targets.items()
        }

    def slope(self, now: Evaluation, states: States) -> ndarray:
        """Return the difference quotient of the residual by the factor, of the reduced forms."""
        x = now.z[:-1]
        factor = now.z[-1]
        step = _DIFFERENCE * max(factor, _DIFFERENCE)
        weaker = self.system.with_forms(self._reduced(float(factor) + step))
        responses = weaker.responses(x, states)
        lost = sum(now.responses[name].force - each.force for name, each in responses.items())
        change = np.asarray(lost / step)
        change[self.system.fixed] = 0.0
        return change

    def equilibrium(
        self,
        start: Point,
        factor: float,
        newton: Newton,
        elastic: float = 0.0,
        searches: tuple[Search, ...] = ("energy", "residual"),
    ) -> Point:
        """Find the equilibrium at a factor from another point.

        Displacements far beyond the size of the elastic ones show a collapse.
        """
        system, load = self.at(factor)
        if factor <= self.safe:  # no collapse can be found
            searches = searches[:1]
        elif self.is_convex(system):
            searches = ("energy",)
        try:
            step = Step(system, start.x, start.states, load, start.x[system.fixed])
            result = step.equilibrium(newton, Attempt(searches, elastic, at_least=1, damp=True))
        except NotConverged as error:
            if is_singular(error):
                raise as_collapse(error, system, start.x, start.states, load, newton) from error
            raise
        work = start.work + system.work(load, result.x - start.x)
        return Point(result.x, result.states, factor, work, result.residuals)


def strength_reduction(
    setup: Setup,
    load: Force = None,
    *,
    start: Result | StageResult | None = None,
    water: AtRest = None,
    reduce: str | Collection[str] | None = None,
    exclude: str | Collection[str] = (),
    flow: Flow = "given",
    tolerance: float = 0.01,
    step: float = 0.1,
    max_value: float = 100.0,
    certify: bool | Literal["auto"] | Mapping[str, Any] = "auto",
    undrained: bool = False,
    refine: bool = False,
    progress: bool | None = None,
) -> CollapseResult:
    """Reduce the strength until the structure collapses under its load.

    The work of the load is prescribed and the factor follows, up to its plateau.

    Parameters
    ----------
    load
        External forces besides the weight of the forms and the water, (N,); by default the ones
        of ``start``.
    start
        Where to start: a result (its last stage) or a stage. By default the load is applied to
        the unstrained bodies first.
    water
        Water at rest, as of a :class:`Stage`; by default the water of ``start``; ``False``:
        none.
    reduce
        Names of forms and of regions whose strength is reduced, or one; by default all that
        have a strength: regions of solids, and friction and adhesion of contact pairs.
    exclude
        Names of forms and of regions that keep their strength, or one.
    flow
        Flow rule: ``"given"``, ``"associated"``, ``"davis_a"``, ``"davis_b"``, ``"davis_c"`` or
        ``"lagged"``, see
        :doc:`theory </theory/plasticity>`.
    tolerance
        Width of the bracket; the curve is followed until a quarter of it is left.
    step
        First step of the factor, at least `tolerance`: over less a curve looks like its
        plateau.
    max_value
        The search ends above this factor.
    certify
        Prove bounds as well, :attr:`CollapseResult.proven`. ``"auto"``: on the mesh of a plane
        search if that takes no more than about its time. True, or arguments of :meth:`bounds`
        such as ``{"gap": .02}``: on meshes of their own. The load must be a sum of weights and
        linear tractions on boundaries; water at rest is known.
    undrained
        Let no water flow in ground with :class:`PoreWater`: a collapse just after a quick
        change. By default its pressures stay: a collapse as slow as the drainage.
    refine
        Cut the elements along the mechanism and search again, until the estimated error of the
        mesh is below `tolerance`, for factors below 1 a share of them, and the factor falls by no
        more: on straight triangles, with solids alone. Later meshes begin with the stresses of the
        one before, unstrained; :attr:`CollapseResult.meshes` has the values of all of them, and the
        model of the last mesh is in :attr:`CollapseResult.end`.
    progress
        Show a progress bar; by default where the output is a terminal.

    Raises
    ------
    NotConverged
        No equilibrium was found to start from. Like every error that ends the search, a
        ``KeyboardInterrupt`` too, its attribute ``result`` holds the accepted part.

    Warns
    -----
    AnalysisWarning
        The factor is below 1, outside of the proven bounds, or needs displacements beyond a
        tenth of the model; no collapse was shown (:attr:`CollapseResult.stop`); elements lock;
        pressures are kept that have yet to drain.

    Examples
    --------
    A column of soil that can spread collapses at ``q = 2 c / F``, or under 2 c:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(1).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> column = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=.3, c=10., phi=0.))
    >>> fixed = [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    >>> model = sc.Model({"soil": column}, fixed)
    >>> load = model.traction("top", (0., -10.))
    >>> f"{model.strength_reduction(load).factor:.2f} {model.limit_load(load).multiplier:.2f}"
    '2.00 2.00'
    """
    check_reduction(1.0, flow)
    if not tolerance > 0 or not step > 0 or not max_value > 1:
        raise ValueError(
            "tolerance and step must be positive and max_value above 1, not "
            f"{tolerance!r}, {step!r} and {max_value!r}"
        )
    options = _Options(
        reduce,
        exclude,
        flow,
        tolerance,
        step,
        max_value,
        undrained,
        progress,
    )
    if not refine:
        return _whole(setup, load, start, water, options, certify)

    # search on meshes that are refined along the mechanism, then prove bounds on the last one
    last = _refined(setup, load, start, water, options)
    proven = beside(certify, live=None, progress=progress, **last.structure)
    return _concluded(last, proven, options, certify)


class _Options(NamedTuple):
    """Arguments of a search, as of :func:`strength_reduction`."""

    reduce: str | Collection[str] | None
    exclude: str | Collection[str]
    flow: Flow
    tolerance: float
    step: float
    max_value: float
    undrained: bool
    progress: bool | None


class _Search(NamedTuple):
    """A search with its start, and the arguments of its bounds."""

    result: CollapseResult
    begun: SearchStart
    structure: dict[str, Any]
    accepted: Accepted
    free: bool


class _Prepared(NamedTuple):
    """Start of a search, the structure to reduce, and the arguments of its bounds."""

    begun: SearchStart
    branch: _Strength
    structure: dict[str, Any]
    accepted: Accepted
    free: bool


def _prepared(setup: Setup, load: Force, start: Any, water: AtRest, options: _Options) -> _Prepared:
    """Read the structure and its load."""
    # Put the load on the structure, and find what is reduced.
    o = options
    begun = loaded_start(setup, load, start, water, o.undrained, o.flow)
    forms = begun.system.forms
    whole = begun.weight + begun.load
    branch = _Strength(begun.system, whole, reduced_parts(forms, o.reduce, o.exclude), o.flow)
    if o.reduce is None:
        _warn_of_kept_strength(forms, o.exclude)
    # Keep what bounds of the same structure need.
    structure: dict[str, Any] = {
        "forms": begun.forms,
        "fixed": begun.system.fixed,
        "dead": whole,
        "reduce": o.reduce,
        "exclude": o.exclude,
        "flow": o.flow,
        "at_rest": begun.at_rest,
    }
    accepted = Accepted(FACTOR, begun, water)
    free = branch.dilates_less and not o.undrained
    return _Prepared(begun, branch, structure, accepted, free)


def _whole(
    setup: Setup,
    load: Force,
    start: Any,
    water: AtRest,
    options: _Options,
    certify: Any,
) -> CollapseResult:
    """Search on the mesh of the model, with bounds."""
    prepared = _prepared(setup, load, start, water, options)
    with prepared.accepted:
        proven = beside(certify, live=None, progress=options.progress, **prepared.structure)
    found = _found(setup, prepared, water, options)
    # Without tensile strength the finer search takes several times as long; the stresses suffice.
    if not (prepared.free or prepared.branch.tears):
        with found.accepted:
            added = _added(setup, found, water, options)
        found = found._replace(result=replace(found.result, added=added))
    return _concluded(found, proven, options, certify)


def _added(setup: Setup, found: _Search, water: AtRest, options: _Options) -> float:
    """Return the share that the mesh adds."""
    result = found.result
    water = _water_of(found.begun, water)
    quiet = options._replace(progress=False)

    def refined() -> CollapseResult:
        """Search with every element cut, from a little below the factor without this share."""
        finer.check(setup, found.begun.forms, options.undrained, finer.CUT)
        finer.check_water(water)
        first = _BEGIN * result.value / (1.0 + result.added)
        cut, prepared = _on_finer(setup, found, water, quiet)
        return _found(cut, prepared, water, quiet, first).result

    return finer.added_by(refined, result, options.tolerance)


def _water_of(begun: SearchStart, water: AtRest) -> AtRest:
    """Return the water of a search, by default of its start."""
    if water is None and begun.begins.water is not None:
        return begun.begins.water
    return water


def _on_finer(
    setup: Setup,
    found: _Search,
    water: AtRest,
    options: _Options,
    cut: ndarray | None = None,
) -> tuple[Setup, _Prepared]:
    """Return the model with elements cut, by default all, and the start of its search."""
    begun = found.begun
    on_top = begun.load - setup.water_on(begun.forms, water)
    on_top[np.abs(on_top) < _ROUND_OFF * max_abs(begun.load)] = 0.0
    setup, (on_top,), states = finer.finer(
        setup,
        begun.forms,
        fixed=begun.system.fixed,
        loads=(on_top,),
        states=found.result.end.states,
        cut=cut,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AnalysisWarning)
        prepared = _prepared(setup, on_top, None, water, options)
    origin = replace(prepared.begun.origin, states=states)
    prepared = prepared._replace(begun=replace(prepared.begun, origin=origin))
    return setup, prepared


def _found(
    setup: Setup,
    prepared: _Prepared,
    water: AtRest,
    options: _Options,
    first: float = 0.0,
) -> _Search:
    """Search, after Davis first where dilatancy is less than friction.

    The first equilibrium is sought at a given factor, and the first step is short, on the meshes
    after the first one.
    """
    begun, branch, structure, accepted, free = prepared
    balance = _BALANCE
    most = _ITERATIONS
    if free:
        balance = _LOOSE
    elif branch.tears:
        balance = _TORN
        most = _OF_TORN
    newton = setup.newton or Newton(tolerance=balance * options.tolerance, max_iterations=most)
    least = max(options.step, options.tolerance)
    if first:
        least = _STEP * first
    shown = progress_bar(options.progress, desc=FACTOR, bar_format="{desc} {postfix} {elapsed}")
    with accepted, shown as bar:
        limits = _Limits(options.tolerance, least, options.max_value, bar, first)
        found = _search(branch, begun.origin, newton, limits, accepted, free)
    result = accepted.found = begun.ended(found, water)
    return _Search(result, begun, structure, accepted, free)


def _concluded(
    search: _Search,
    proven: Bounds | None,
    options: _Options,
    certify: Any,
) -> CollapseResult:
    """Return the result with bounds; prove them on the mesh of the search where they are cheap."""
    result = search.result
    if certify == "auto" and not options.undrained:
        with search.accepted:
            proven, unproven = _cheap_bounds(
                result, search.free, options.tolerance, search.structure
            )
        result = replace(result, unproven=unproven)
    return result.beside(proven, options.tolerance)


def _refined(setup: Setup, load: Force, start: Any, water: AtRest, options: _Options) -> _Search:
    """Search again on finer meshes, until the error of the mesh is below the tolerance."""
    prepared = _prepared(setup, load, start, water, options)
    finer.check(setup, prepared.begun.forms, options.undrained)
    water = _water_of(prepared.begun, water)
    finer.check_water(water)
    history: list[tuple[int, float, float]] = []
    first = 0.0
    while True:
        # search; only the last mesh has warnings
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            found = _found(setup, prepared, water, options, first)
        result = found.result
        elements = sum(form.basis.nelems for form in solids_of(found.begun.forms).values())
        history.append((elements, result.value, result.added))
        error = result.added * result.value
        margin = options.tolerance * min(1.0, result.value)
        if len(history) > 1:
            fall = history[-2][1] - result.value
        else:
            fall = error / _ALONE
        is_last = max(error, fall) <= margin or not result.stop.shows_limit
        if is_last or elements > _MOST_ELEMENTS:
            break

        # cut the elements of the mechanism, and begin a little below the last factor
        cut = finer.marked(result.end, result.mechanism, result.bands)
        setup, prepared = _on_finer(setup, found, water, options, cut)
        first = _BEGIN * result.value
    for one in told:
        warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)
    return found._replace(result=replace(result, meshes=tuple(history)))


class _Limits(NamedTuple):
    """Tolerance, first step and largest value of a search, with its progress bar."""

    tolerance: float
    step: float
    max_value: float
    bar: Any
    first: float = 0.0


def _cheap_bounds(
    result: CollapseResult,
    free: bool,
    tolerance: float,
    structure: Mapping[str, Any],
) -> tuple[Bounds | None, str]:
    """Prove bounds if they cost less than the search, or return the reason why not."""
    iterations = result.iterations
    if result.davis is not None:
        iterations += result.davis.iterations
    work = float(len(result.x)) * iterations
    adds = result.stop.shows_limit and result.added * result.value > tolerance
    return at_hand(work=work, coarse=adds and not free, **structure)


def _warn_of_kept_strength(forms: Forms, exclude: str | Collection[str]) -> None:
    """Raise a warning of ground that yields under a law whose strength cannot be reduced."""
    excluded = set(names_of(exclude))
    kept = []
    for name, form in having(forms, Body).items():
        for region, material in form.materials.items():
            yields = PLASTIC_STRAIN in [variable.name for variable in material.internal]
            if yields and not material.reducible and excluded.isdisjoint((name, region)):
                kept.append(f"{name}.{region}, {material.label}")
    if kept:
        warn(
            f"{'; '.join(kept)}: this law keeps its strength, and the factor of safety is that of "
            "the other parts, too high where a mechanism passes through it; give it a law with c "
            "and phi, or name it in `exclude`"
        )


def _search(
    branch: _Strength,
    origin: Point,
    newton: Newton,
    limits: _Limits,
    accepted: Accepted,
    with_davis: bool = False,
) -> CollapseResult:
    """Search for the factor of one flow rule, with the search after Davis in front of it or not."""
    # search with Davis' soils of less strength: safe whatever the path
    davis = None
    if with_davis:
        weaker = _Strength(branch.system, branch.load, branch.targets, "davis_b")
        try:
            davis = _search(weaker, origin, newton, limits, accepted)
        except (ValueError, NotConverged) as error:
            # a material has no such flow, or no equilibrium to begin with exists
            logger.info("no factor after Davis: %s", error)
        else:
            branch.safe = davis.factor
            branch.above = branch.bound(davis)

    # find the first equilibrium, then the end of the curve
    log = SearchLog(branch.system, limits.bar, origin)
    accepted.follow(branch, log, branch.flow, part_names(branch.targets), davis)
    first = _first(branch, origin, newton, log, limits.first)
    result = _continued(branch, first, newton, *limits[:3], log)
    if np.isfinite(branch.above) and result.stop.kind != "collapse":
        result = replace(result, above=max(result.best.parameter, branch.above))
    system, load = branch.at(result.best.parameter)
    return conclude(
        FACTOR,
        result,
        last=result.best,
        system=system,
        load=load,
        steps=log.steps,
        flow=branch.flow,
        reduced=part_names(branch.targets),
        davis=davis,
    )


def _first(
    branch: _Strength,
    origin: Point,
    newton: Newton,
    log: SearchLog,
    begin: float = 0.0,
) -> Point:
    """Return the first equilibrium: at a given factor, at 1, or below."""
    error: NotConverged | None = None
    # weaken the demand until an equilibrium exists
    factors: tuple[float, ...] = _FIRST
    if begin:
        factors = (begin, *(factor for factor in _FIRST if factor < begin))
    for factor in factors:
        if factor >= branch.above:
            continue
        try:
            point = branch.equilibrium(origin, factor, newton)
        except NotConverged as reason:
            error = reason
            log.reject(factor, reason, 0.0)
            continue
        point = replace(point, work=0.0)
        log.accept(point)
        log.begin(point)
        return point

    # say whether the structure collapses, or no equilibrium was found
    assert error is not None
    where = branch.system.layout.located(error.dof)
    most = f"{1 / _FIRST[-1]:g} times its strength"
    if isinstance(error, NoEquilibrium):
        raise saying(
            error, f"the structure does not resist its load even with {most}: {error}"
        ) from error
    raise saying(
        error,
        f"no equilibrium to start from was found, with up to {most}, and no collapse either; put "
        f"the load on in stages and give their result as `start`: {error}{where}",
    ) from error


def _continued(
    branch: _Strength,
    first: Point,
    newton: Newton,
    tolerance: float,
    step: float,
    max_value: float,
    log: SearchLog,
) -> SearchResult:
    """Approach the curve by fixed factors, then follow it."""
    points, failed = _approach(
        branch,
        first,
        newton,
        _OPEN * tolerance,
        step,
        max_value,
        log,
    )
    last = points[-1]
    if len(points) > 1:
        course = Course(_OPEN * tolerance, max_value=max_value)
        return follow(branch, branch.load, points, newton, course, log)
    if failed is None:
        return SearchResult(points, no_collapse_below(max_value), motion=np.zeros_like(last.x))

    # no work could be prescribed: the steps themselves enclose the factor
    collapsed = [step.parameter for step in log.steps if step.outcome == "collapse"]
    above = min(collapsed, default=np.inf)
    reason = "the bodies are elastic up to there"
    if any(step.yielding > 0.0 for step in log.steps):
        reason = "the first equilibrium is at its limit"
    kind: Literal["collapse", "stall"] = "stall"
    if above - last.parameter <= tolerance:
        kind = "collapse"
    return SearchResult(points, Stop(kind, reason), above, motion(last, failed))


def _approach(
    branch: _Strength,
    first: Point,
    newton: Newton,
    least: float,
    step: float,
    max_value: float,
    log: SearchLog,
) -> tuple[list[Point], NotConverged | None]:
    """Take fixed factors until the load does work; elastic bodies do not feel the factor."""
    # scale by the displacements under the whole load with the stiffness of the first point
    system, load = branch.at(first.parameter)
    begun = system.evaluate(first.x, first.states, load)
    response = system.factor(system.tangent(begun))(load)
    elastic = float(np.linalg.norm(response))
    share = max(_NOTICEABLE, _BY_RESIDUAL * newton.tolerance)
    noticeable = share * branch.system.work(branch.load, response)

    # lengthen the step after every equilibrium, halve it after every failure
    last = first
    while last.parameter <= max_value:
        factor = last.parameter + step
        try:
            # the collapse is still far: try the search that leads to it last
            point = branch.equilibrium(last, factor, newton, elastic, ("step", "energy"))
        except NotConverged as error:
            log.reject(factor, error, last.work)
            if step < least:
                return [last], error
            step *= 0.5
            continue
        log.accept(point)
        if point.work - first.work > noticeable:
            return [last, point], None
        last = point
        step *= 1.5
    return [last], None
