"""Certified bounds of factors of safety and limit loads, alone or for a search."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import Mesh, MeshTri

from ..arrays import max_abs
from ..checks import format_point, names_of
from ..display import progress_bar
from ..errors import AnalysisWarning, warn
from ..forms.base import dilate_less, solids_of
from ..loads import Pressure, by_element
from ..loads.water_at_rest import pressures
from ..solvers import single_threaded
from .certify import dissipation
from .model import AtRest, TractionLike, named_loads, vector_loads
from .reading import Problem, by_kind, read
from .result import Bounds
from .search import Bound, Search
from .triangles import Triangles

#: Bounds on the mesh of a search take .4 to 1.4 of its time where its dofs times iterations are so
#: many times the triangles: both take 1.0 to 1.8 ms a triangle on slopes of 1,400 to 3,500
#: quadratic triangles, a search 2.3 to 3.4 us a dof and iteration. With an estimate they cost half
#: as much again.
_CHEAP = 370.0
#: Triangles up to which the bounds of a coarse mesh are computed in any case, in about a second.
_FEW = 800
#: Arguments of :func:`bounds` that a search accepts.
_OPTIONS = ("water", "submerged", "gap", "elements", "seconds")


@single_threaded
def bounds(
    forms: Mapping[str, Any],
    fixed: ndarray,
    weight: float | Mapping[str, float] | None = None,
    *,
    tractions: Mapping[str, TractionLike] | None = None,
    water: Pressure | ArrayLike | Literal[False] | None = None,
    water_unit_weight: float | None = None,
    submerged: str | Collection[str] = (),
    seismic: float = 0.0,
    reduce: str | Collection[str] | None = None,
    exclude: str | Collection[str] = (),
    live: str | Collection[str] = (),
    flow: Literal["given", "associated"] = "given",
    gap: float = 0.01,
    elements: int = 20_000,
    seconds: float = np.inf,
    progress: bool | None = None,
) -> Bounds:
    """Compute proven bounds of the factor of safety, or of the limit load.

    The lower bound is a stress field in equilibrium with the loads that yields nowhere. The upper
    bound is a velocity field that obeys the flow rule, on which the loads do more work than the
    soil dissipates. Both fields are checked after the solver, to round-off. The theorems hold for
    associated flow, the upper bound for any flow. Elastic moduli, initial stresses and K0 do not
    matter.

    Parameters
    ----------
    forms
        Solids and contact pairs by name, in plane strain: Mohr-Coulomb, Tresca and von Mises
        materials. Elastic bodies count as rigid. Contact is closed where the meshed boundaries
        meet.
    fixed
        Dofs that are held, along whole facets.
    weight
        Weight per volume: one number, or by subdomain; by default the unit weights of the solids.
    tractions
        Forces per area on boundaries, (t_x, t_y) or a function of coordinates (2, n) with values
        (2, n).
    water
        Water at rest in the pores: a level, a line of points (n, 2), a seepage, a function of
        coordinates, or pressures at the vertices, positive, or a mapping of these by subdomain;
        False: none. Everything but rigid bodies has pores.
    water_unit_weight
        Unit weight of water, for levels and lines.
    submerged
        Boundaries on which the water presses from outside, see :func:`water_load`. On others it
        does not, unlike water of a stage, which presses on all boundaries below its level.
    seismic
        Horizontal acceleration, towards positive x, over gravity.
    reduce, exclude
        Names of forms and regions whose strength is reduced, or kept, as in
        :func:`strength_reduction`.
    live
        Boundaries in `tractions` whose forces are multiplied, or ``"weight"``: the bounds enclose
        the multiplier at collapse, and the strength is not reduced.
    flow
        ``"given"``: ``lower`` is an estimate where soil dilates less than its friction, with the
        associated soil of Davis, and where joints have friction, with joints that open;
        ``"associated"``: dilation equals friction.
    gap
        Difference of the bounds, as a share of their mean, at which the refinement ends.
    elements
        Largest number of triangles.
    seconds
        Processor time after which no further bound is begun, but for `safe` and the estimates.
    progress
        Show a progress bar; by default where the output is a terminal.

    Raises
    ------
    ValueError
        LimitModel without bounds (space, axial symmetry, other materials or forms), bad input, or
        no collapse.

    Warns
    -----
    AnalysisWarning
        A wide gap, a bound without proof (it is infinite), or fixed loads that alone cause a
        collapse.

    Examples
    --------
    A square of cohesive soil (c = 10) that can spread collapses at ``q = 2 c / F``:

    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri().refined(1).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> column = sc.SolidForm(basis, sc.Tresca(E=1e3, nu=.3, c=10.))
    >>> fixed = np.hstack([basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")])
    >>> found = sc.Model({"soil": column}, fixed).bounds(tractions={"top": (0., -10.)})
    >>> print(f"{found.lower:.3f} {found.upper:.3f}")
    2.000 2.000
    """
    # Check the flow, and take the weights of the forms where none are given.
    if flow not in ("given", "associated"):
        raise ValueError(f"flow must be 'given' or 'associated', not {flow!r}")
    gamma: Any = _own(forms) if weight is None else weight
    multiplied = names_of(live)
    pressure = None
    if water is not None and water is not False:
        pressure = pressures(water, _mesh_of(forms), water_unit_weight)
    # Loads by name are integrated on each mesh.
    loads = partial(
        named_loads,
        weight=gamma,
        tractions=dict(tractions or {}),
        water=pressure,
        submerged=names_of(submerged),
        seismic=seismic,
        live=multiplied,
    )
    associated = flow == "associated"
    problem = read(forms, fixed, loads, bool(multiplied), reduce, exclude, associated)
    return _bracket(problem, progress, gap, elements, seconds)


def _mesh_of(forms: Mapping[str, Any]) -> Mesh:
    """Return the mesh of the solids."""
    solids = solids_of(forms)
    if not solids:
        raise ValueError(f"bounds need a solid, but there are {list(forms)}")
    mesh: Mesh = next(iter(solids.values())).basis.mesh
    return mesh


def _own(forms: Mapping[str, Any]) -> ndarray | float:
    """Return the unit weights that the solids bring, (n_elements,), or zero."""
    weights: ndarray | None = None
    for form in solids_of(forms).values():
        if form.unit_weight is not None:
            mesh = form.basis.mesh
            if weights is None:
                weights = np.zeros(mesh.nelements)
            weights[form.elements] = by_element(mesh, form.unit_weight)[form.elements]
    if weights is None:
        return 0.0
    return weights


def beside(
    certify: bool | str | Mapping[str, Any],
    forms: Mapping[str, Any],
    fixed: ndarray,
    dead: ndarray,
    live: ndarray | None,
    reduce: str | Collection[str] | None = None,
    exclude: str | Collection[str] = (),
    flow: str = "given",
    progress: bool | None = None,
    at_rest: AtRest | None = None,
) -> Bounds | None:
    """Compute the bounds of a search with `certify`: True, or arguments of :func:`bounds`.

    Load vectors, (N,), are fixed, and multiplied or None where the strength is reduced. Water at
    rest is the water of the search.
    """
    # read the options
    if certify is False or certify == "auto":
        return None
    given: dict[str, Any] = {}
    if isinstance(certify, Mapping):
        given.update(certify)
    elif certify is not True:
        given["certify"] = certify
    if not set(given) <= set(_OPTIONS):
        raise ValueError(
            f"certify must be True, or arguments of bounds among {', '.join(_OPTIONS)}, not "
            f"{certify!r}"
        )

    # compute the bounds under the load vectors
    loads = partial(
        vector_loads,
        dead=dead,
        live=live,
        water=given.pop("water", None),
        submerged=names_of(given.pop("submerged", ())),
        at_rest=at_rest,
    )
    problem = read(forms, fixed, loads, live is not None, reduce, exclude, flow == "associated")
    return _bracket(problem, progress, **given)


def at_hand(
    forms: Mapping[str, Any],
    fixed: ndarray,
    dead: ndarray,
    reduce: str | Collection[str] | None,
    exclude: str | Collection[str],
    flow: str,
    work: float,
    coarse: bool,
    at_rest: AtRest,
) -> tuple[Bounds | None, str]:
    """Compute the bounds of a factor of safety on the mesh of its search.

    The `work` of the search counts dofs times iterations. Returns None and the reason where no
    upper bound is proven, or the bounds cost more than about the search, unless the mesh seems to
    be coarse.
    """
    # name what has no bounds at any cost
    try:
        by_kind(forms)
    except ValueError as reason:
        return None, str(reason)

    # compare their cost with the cost of the search
    solids = solids_of(forms)
    bases = [form.basis for form in solids.values()]
    triangles = sum(basis.nelems * len(basis.mesh.t) / 3 for basis in bases)
    cost = _CHEAP * triangles
    if flow == "given" and dilate_less(solids):  # an estimate as well
        cost *= 1.5
    if work < cost and not (coarse and triangles <= _FEW):
        return None, "they would take longer than the search (certify=True computes them)"
    loads = partial(vector_loads, dead=dead, live=None, at_rest=at_rest)
    try:
        problem = read(forms, fixed, loads, False, reduce, exclude, flow == "associated")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", AnalysisWarning)  # open ends were not asked for
            found = _bracket(problem, progress=False, elements=1)
    except ValueError as reason:
        return None, str(reason)
    if not np.isfinite(found.upper):
        return None, "no upper bound could be proven on the mesh of the search"
    return found, ""


def _bracket(
    problem: Problem,
    progress: bool | None,
    gap: float = 0.01,
    elements: int = 20_000,
    seconds: float = np.inf,
) -> Bounds:
    """Compute bounds; warn of open ends."""
    if not (0 < gap < np.inf) or not elements > 0 or not seconds > 0:
        raise ValueError(
            f"gap, elements and seconds must be positive, not {gap!r}, {elements!r} and {seconds!r}"
        )
    with progress_bar(progress, desc="bounds", bar_format="{desc} {postfix} {elapsed}") as bar:
        search = Search(problem, bar)
        search.run(gap, elements, seconds)
        davis = search.estimate(problem.davis)
        smooth = search.estimate(problem.smooth)
    _tell(search, gap)
    return _result(search, davis, smooth)


def _tell(search: Search, gap: float) -> None:
    """Warn about a search that did not reach its end."""
    # name the bounds without proof
    low = search.lower.proof.value
    high = search.upper.proof.value
    unproven = []
    if not np.isfinite(low):
        unproven.append("lower")
    if not np.isfinite(high):
        unproven.append("upper")

    # give the first reason that applies
    missing = search.problem.missing
    if missing == "cohesion" and not search.has_lower:
        warn(
            "soil without cohesion resists nothing at a free surface, and there is no lower bound: "
            f"give it a small cohesion; the upper bound is {high:.5g}{_meshes(search)}"
        )
    elif missing and not search.has_lower:
        warn(
            "no lower bound could be proven on these meshes: soil without tensile strength may "
            "resist nothing at a free surface; give it a small tension, or allow more `elements`; "
            f"the upper bound is {high:.5g}{_meshes(search)}"
        )
    elif search.overloaded:
        reason = f"they need {1 / search.fixed_factor:.4g} times the strength"
        if high < 0:
            reason = f"the multiplier is at most {high:.5g}"
        warn(f"the fixed loads alone cause a collapse: {reason}")
    elif unproven:
        warn(
            f"no {' and no '.join(unproven)} bound could be proven{_meshes(search)}"
            f"{_blocked(search)}{_held(search)}{_too_strong(search)}"
        )
    elif search.gap > gap:
        warn(
            f"the bounds [{low:.5g}, {high:.5g}] differ by {search.gap:.2%}, more than the "
            f"{gap:.2%} that were asked for: allow more `elements` or `seconds`"
            f"{_too_strong(search)}"
        )


def _meshes(search: Search) -> str:
    """Return the meshes that have been tried, for a message."""
    finest = max(each.elements for each in search.history)
    tried = dict.fromkeys(("lower", "upper"), 0)
    for each in search.history:
        tried[each.kind] += 1
    return (
        f" ({tried['lower']} meshes for the lower and {tried['upper']} for the upper one, of up to "
        f"{finest} triangles, in {search.history[-1].cpu:.3g} s)"
    )


def _too_strong(search: Search) -> str:
    """Return advice on parts of much more strength than others, for a message."""
    if not search.problem.strong:
        return ""
    return (
        "; with LinearElastic, what is much stronger than the rest would be rigid, and bounds "
        f"closer: {', '.join(search.problem.strong)}"
    )


def _held(search: Search) -> str:
    """Return the multiplier that the fixed loads need, for a message."""
    if not np.isfinite(search.least):
        return ""
    return (
        f"; the fixed loads need a multiplier of at least {search.least:.4g}, and stresses that "
        "balance them a finer mesh: allow more `elements`"
    )


def _blocked(search: Search) -> str:
    """Return the point where contact ends at a support, for a message.

    No velocity without jumps can begin at such a point.
    """
    # Find the corners of facets that are held in both directions.
    triangles = search.upper.triangles
    shape = search.problem.geometry
    tags = triangles.tags
    facets = triangles.mesh.facets
    first, second = (facets[:, tags["held", k]] for k in (0, 1))
    held = np.intersect1d(first, second)
    # Contact must not end there.
    sides = [held[:0]]
    for contact in search.model.contacts:
        for side in (contact.slave, contact.master):
            sides.append(facets[:, tags[side]].ravel())
    blocked = np.intersect1d(held, np.concatenate(sides))
    if not len(blocked):
        return ""
    point = triangles.mesh.p[:, blocked[0]]
    where = format_point(shape.centre + shape.size * point)
    return (
        f": contact ends at a support at {where}, where nothing can slide; hold one component there"
    )


def _result(search: Search, davis: float | None, smooth: float | None) -> Bounds:
    """Return the bounds in the user's units; an estimate replaces the lower bound."""
    problem = search.problem
    low = search.lower
    high = search.upper

    # return velocities and stresses to the nodes and corners
    velocity = (high.program.reduction.matrix @ high.proof.field).reshape(-1, 2).T
    at_corners = low.program.of_triangles(low.proof.field)
    stress = np.full((3, low.triangles.mesh.nelements, 3), np.nan)  # (3, n_elements, 3 corners)
    stress[:, low.program.soft] = problem.stress * at_corners.transpose(2, 0, 1)
    return Bounds(
        lower=float(low.proof.value if davis is None else davis),
        upper=float(high.proof.value),
        estimate=davis is not None or smooth is not None,
        safe=smooth,
        what="limit load" if search.live else "factor of safety",
        reduced=problem.reduced,
        mesh=_named(problem, high.triangles),
        mechanism=velocity / (max_abs(velocity) or 1.0),
        dissipation=_shares(high, search.live),
        stress_mesh=_named(problem, low.triangles),
        stress=stress,
        history=tuple(search.history),
        remarks=problem.remarks,
    )


def _named(problem: Problem, triangles: Triangles) -> MeshTri:
    """Return a mesh in the user's coordinates, with the names of the given mesh."""
    shape = problem.geometry
    # Keep the names of sides; elements keep those of the element that they come from.
    boundaries = {}
    for tag, facets in triangles.tags.items():
        if isinstance(tag, str):
            boundaries[tag] = facets
    subdomains = {}
    for name, part in (problem.mesh.subdomains or {}).items():
        subdomains[name] = np.flatnonzero(np.isin(triangles.origin, part))
    return MeshTri(
        shape.centre[:, None] + shape.size * triangles.mesh.p,
        triangles.mesh.t,
        validate=False,
        _boundaries=boundaries,
        _subdomains=subdomains,
    )


def _shares(high: Bound, live: bool) -> ndarray:
    """Return the share of the dissipation in every triangle; the rest is in contacts."""
    program = high.program
    proof = high.proof
    factor = 1.0
    if not live and np.isfinite(proof.value):
        factor = proof.value
    strain = program.strains(proof.field)
    spent = dissipation(program, strain, factor)
    whole = spent.sum() or 1.0
    shares = np.zeros(high.triangles.mesh.nelements)
    shares[program.soft] = program.of_triangles(spent).sum(axis=1) / whole
    return shares
