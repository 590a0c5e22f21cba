"""Models on meshes that are refined along a mechanism."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy import ndarray
from scipy.sparse.linalg import spsolve
from skfem import (
    Basis,
    BilinearForm,
    FacetBasis,
    LinearForm,
    Mesh,
    MeshQuad1,
    MeshQuad2,
    MeshTri1,
    MeshTri2,
)
from skfem.helpers import dot

from ..arrays import max_abs
from ..checks import format_point
from ..errors import AnalysisWarning, NotConverged
from ..forms.base import Forms, States, solids_of
from ..forms.roles import materials_of
from ..layout import elements_of
from ..materials.base import Material
from ..mesh.locate import Located, locate
from ..sparse import within
from ..stages.setup import Setup
from .mechanism import COARSE, lost_power
from .result import CollapseResult

#: Share of the power that the mesh adds in the elements that are cut. The slope in three layers of
#: Arai and Tagyo ends at the same factor with 5,900 elements for .5, 7,400 for .7, and 17,800 where
#: .8 of the whole power is cut.
_CUT = 0.5
#: Elements up to which a coarse mesh is cut once more to see what it adds. Slopes of 80 and 320
#: triangles take .4 s and 1.2 s for .15 s and .35 s, strips of 148 and 584 .4 s and 2.2 s for .25 s
#: and .8 s; one of 660 below a stiff footing 13 s for 5 s.
_FEW = 600
#: Order of the error by the size of the elements: 1.1 under strips on clay, .5 on steep slopes.
#: With this one the share is .94 to 1.35 of the true one on 13 strips on clay and on sand with phi
#: of 20 to 35 degrees, with and without weight, and .59 to 1.5 on 31 slopes of 30 to 70 degrees
#: with phi of 0 to 35 degrees, of 80 and 320 triangles, which add 2 to 34 %. There the estimate by
#: the stresses is .37 to 1.7 and .26 to 1.4. The second number is the largest share of a limit for
#: which it counts. On 20 slopes of quadrilaterals it is .61 to 1.11 (4 nodes, B-bar) and .77 to
#: 1.56 (8 nodes, 4 points), on 8 of 9 nodes with phi of 10 to 35 degrees .89 to 1.16. Slopes of
#: clay of 70 degrees have an order of .3: .55 and .43 by their fall alone, .55 and .52 with what
#: the finer mesh adds by its stresses.
_ORDER = 0.75
_MOST = 0.6
#: Force on nodes inside of the bodies, as a share of the largest, that is round-off.
_INSIDE = 1e-9
#: Reference coordinate of a point on a side, and distance of the middle of a straight side from it,
#: as a share of the size of the mesh.
_ON_SIDE = 1e-6
#: Meshes of second order, and the ones of their corners.
_OF_CORNERS: dict[type[Mesh], type[Mesh]] = {MeshTri2: MeshTri1, MeshQuad2: MeshQuad1}
#: Meshes whose elements can all be cut.
CUT = (MeshTri1, MeshQuad1)
S = TypeVar("S", bound=Setup)


class Finer(NamedTuple):
    """A model on a finer mesh, loads on top of weights and water, and states of its solids."""

    setup: Any
    loads: list[ndarray]
    states: dict[str, Any]


def check(
    setup: Setup,
    forms: Forms,
    undrained: bool,
    kinds: tuple[type[Mesh], ...] = (MeshTri1,),
) -> None:
    """Refuse models that cannot be built anew on a finer mesh, by the kind of their mesh."""
    # Only solids can be built anew.
    if undrained:
        raise ValueError("refine=True is for drained searches: leave out undrained=True")
    solids: dict[str, Any] = {}
    for name, form in forms.items():
        if not materials_of(form):
            raise ValueError(
                f"refine=True knows solids, but '{name}' is a {type(form).__name__}: refine the "
                "section along the mechanism, sizes={...}, and search again"
            )
        solids[name] = form
    # Elements with straight sides are divided, and weights act downwards.
    mesh = next(iter(solids.values())).basis.mesh
    if type(_straight(mesh)) not in kinds:
        raise ValueError(
            "refine=True cuts straight triangles, MeshTri or MeshTri2 with straight sides, but "
            f"this is a {type(mesh).__name__}"
        )
    setup.check_upright("refine=True needs")
    # Strengths must be known on the finer mesh as well.
    for name, form in solids.items():
        for region in form.regions:
            if region.material.undrained:
                raise ValueError(
                    f"refine=True begins finer meshes unstrained, but '{name}.{region.name}' is "
                    "Undrained: its strength follows from its stresses"
                )
            if region.material.slips_on_planes:
                raise ValueError(
                    f"refine=True does not know the error of a mesh in '{name}.{region.name}', "
                    "which slips along its joints alone: compare meshes by hand"
                )
            if _by_element(region.given or region.material):
                raise ValueError(
                    f"refine=True needs parameters as numbers or functions of the coordinates, but "
                    f"'{name}.{region.name}' has arrays by element"
                )


def _straight(mesh: Mesh) -> Mesh:
    """Return a mesh of second order by its corners, without names, if all its sides are straight.

    Other meshes are returned as they are.
    """
    kind = _OF_CORNERS.get(type(mesh))
    if kind is None:
        return mesh
    corners = kind(mesh.p[:, : mesh.nvertices], mesh.t)
    same = type(mesh).from_mesh(corners)
    away = np.abs(same.doflocs - mesh.doflocs).max()
    if away > _ON_SIDE * np.ptp(corners.p, axis=1).max():
        return mesh
    return corners


def check_water(water: Any) -> None:
    """Refuse pressures at the vertices of one mesh."""
    if water is not None and not callable(water) and np.ndim(water) == 1:
        raise ValueError(
            "refine=True needs water by its level, points, a seepage or a function, not pressures "
            "at the vertices of one mesh"
        )


def _by_element(material: Material) -> bool:
    """Return True if a parameter of a material is an array."""
    return any(isinstance(value, ndarray) for value in vars(material).values())


def added_by(
    search: Callable[[], CollapseResult], result: CollapseResult, tolerance: float
) -> float:
    """Return the share that a mesh adds: of a coarse mesh by a `search` with every element cut."""
    if not _is_coarse(result, tolerance):
        return result.added
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AnalysisWarning)
        try:
            refined = search()
        except (ValueError, NotConverged):  # not built anew, or without an equilibrium
            return result.added
    return added_by_fall(result, refined)


def _is_coarse(result: CollapseResult, tolerance: float) -> bool:
    """Return True if few elements add more to a limit than searches leave open."""
    elements = sum(form.basis.nelems for form in solids_of(result.end.forms).values())
    adds = result.added > max(COARSE, 2.0 * tolerance / result.value)
    return result.stop.shows_limit and adds and elements <= _FEW


def added_by_fall(result: CollapseResult, refined: CollapseResult) -> float:
    r"""Return the share that a mesh adds to a limit F, from the limit F' with every element cut.

    With an error of the order p the exact value is F - s F, and :math:`F / (F - s F) - 1` is the
    share, with :math:`s F = (F - F') / (1 - 2^{-p})`. It is within a factor of two of the true one
    for orders of .32 to 2.3, and at least the fall with what the finer mesh adds by its stresses.
    """
    fall = 1.0 - refined.value / result.value
    left = refined.added / (1.0 + refined.added)
    share = max(fall / (1.0 - 0.5**_ORDER), fall + (1.0 - fall) * left)
    if not refined.stop.shows_limit or not 0.0 < share < _MOST:
        return result.added
    return share / (1.0 - share)


def marked(end: Any, mechanism: ndarray, bands: Mapping[str, ndarray]) -> ndarray:
    """Return the elements of the mesh in which it adds most to the power of a mechanism."""
    lost = lost_power(end.forms, bands, end.states, mechanism)
    sizes = np.abs(lost.added)
    order = np.argsort(-sizes)
    share = np.cumsum(sizes[order]) / sizes.sum()
    return lost.elements[order[: int(np.searchsorted(share, _CUT)) + 1]]


def finer(
    setup: S,
    forms: Forms,
    fixed: ndarray,
    loads: Sequence[ndarray],
    states: States,
    cut: ndarray | None = None,
) -> Finer:
    """Return the model with some elements cut, loads on it, and the stresses and memory.

    Parameters
    ----------
    setup
        The model; its settings are kept.
    forms
        Active solids.
    fixed
        Supported dofs.
    loads
        Loads on top of weights and water, (N,): tractions on facets, and body forces of one value
        in each region.
    states
        States of the solids.
    cut
        Numbers of the elements that are cut, by default all.
    """
    # Cut the elements, and name parts and sides as before.
    solids: dict[str, Any] = dict(forms)
    first = next(iter(solids.values())).basis
    mesh = first.mesh
    corners = _straight(mesh)
    new = type(corners)(corners.p, corners.t).refined(1 if cut is None else cut)
    parent = _located(corners, new.p[:, new.t].mean(axis=1)).elements
    side = _sides(corners, new)
    subdomains = {}
    for name, part in (mesh.subdomains or {}).items():
        subdomains[name] = np.flatnonzero(np.isin(parent, part))
    boundaries = {}
    for name, facets in (mesh.boundaries or {}).items():
        boundaries[name] = np.flatnonzero(np.isin(side, np.asarray(facets)))
    named = new.with_subdomains(subdomains).with_boundaries(boundaries)

    # Build the solids and the supports.
    whole = Basis(named, first.elem, quadrature=first.quadrature)
    built = {}
    for name, form in solids.items():
        own = np.flatnonzero(np.isin(parent, form.elements))
        built[name] = form.on(whole.with_elements(own))
        if built[name] is None:
            raise ValueError(f"refine=True knows solids, but '{name}' is a {type(form).__name__}")
    held = _fixed(first, whole, side, fixed)
    model = type(setup)(
        built,
        held,
        solver=setup.solver,
        newton=setup.newton,
        seismic=setup.gravity[:-1].tolist(),
        water_unit_weight=setup.water_unit_weight,
    )
    carried = {}
    for name, form in solids.items():
        carried[name] = _carried(form, states[name], built[name], corners)
    on_finer = [_load(solids, built, whole, side, load[: first.N]) for load in loads]
    return Finer(model, on_finer, carried)


def _located(mesh: Mesh, points: ndarray) -> Located:
    """Return the elements that hold points (2, ...), and their reference coordinates, flat."""
    everything = np.arange(mesh.nelements)
    return locate(mesh, everything, points.reshape(2, -1).T, 0 * everything)


def _carried(old: Any, state: Any, new: Any, mesh: Mesh) -> Any:
    r"""Return the state of a solid on a finer mesh, unstrained.

    In each element stresses and memory are the linear functions of least squares of its points,
    :math:`v(\xi) = a + b \cdot \xi`.
    """
    # Fit linear functions in the elements of the mesh.
    known = np.concatenate((state.stress, state.internal))  # (n_values, n_elements, n_points)
    at = old.basis.X
    linear = np.column_stack((np.ones(at.shape[1]), at.T))
    fit = np.linalg.pinv(linear)  # (3, n_points)
    functions = np.einsum("ven,kn->vek", known, fit)

    # Evaluate them at the integration points of the finer elements.
    points = np.asarray(new.basis.global_coordinates())
    held = _located(mesh, points)
    rows = np.zeros(mesh.nelements, int)
    rows[old.elements] = np.arange(len(old.elements))
    at_point = functions[:, rows[held.elements]]  # (n_values, n_elements * n_points, 3)
    values = at_point[:, :, 0] + np.einsum("vpk,kp->vp", at_point[:, :, 1:], held.local)
    values = values.reshape(-1, *points.shape[1:])
    n = len(state.stress)
    begun = new.initial_state(stress=values[:n])
    return replace(begun, internal=values[n:])


def _sides(mesh: Mesh, new: Mesh) -> ndarray:
    """Return for each facet of a finer mesh the facet of the mesh that it is a part of, or -1."""
    held = _located(mesh, new.p[:, new.facets].mean(axis=1))
    xi, eta = held.local
    # scikit-fem's sides: corners (0, 1), (1, 2), (0, 2), or (0, 1), (1, 2), (2, 3), (0, 3)
    away = [eta, 1.0 - xi - eta, xi]
    if len(mesh.t) == 4:
        away = [eta, 1.0 - xi, 1.0 - eta, xi]
    distance = np.abs(away)
    local = distance.argmin(axis=0)
    on_side = distance[local, np.arange(len(local))] < _ON_SIDE
    return np.where(on_side, mesh.t2f[local, held.elements], -1)


def _fixed(old: Any, new: Any, side: ndarray, fixed: ndarray) -> ndarray:
    """Return the supported dofs of a finer mesh: on supported sides, and at supported nodes."""
    held = np.zeros(old.N, bool)
    held[fixed[fixed < old.N]] = True
    result = []

    # Support the sides all of whose nodes are supported in a direction.
    for k in range(2):
        sides = np.flatnonzero(_all_held(old, held, k))
        parts = np.flatnonzero(np.isin(side, sides))
        if len(parts):
            names = f"u^{k + 1}"
            result.append(new.get_dofs(parts).all(names))

    # Support single nodes at the same coordinates.
    for k in range(2):
        dofs = np.flatnonzero(held)
        dofs = dofs[dofs % 2 == k]
        candidates = np.arange(k, new.N, 2)
        keys = {tuple(point) for point in np.round(old.doflocs[:, dofs].T, 12)}
        points = np.round(new.doflocs[:, candidates].T, 12)
        same = [tuple(point) in keys for point in points]
        result.append(candidates[np.array(same, bool)])
    if result:
        return np.unique(np.concatenate(result))
    return np.zeros(0, int)


def _all_held(basis: Any, held: ndarray, component: int) -> ndarray:
    """Return the facets whose nodes are all held in a direction."""
    mesh = basis.mesh
    both = held[basis.nodal_dofs[component][mesh.facets]].all(axis=0)
    if len(basis.facet_dofs):
        both &= held[basis.facet_dofs[component]]
    return np.asarray(both)


#: Load vector of a density t, and mass.
_FORCE = LinearForm(lambda v, w: dot(w["t"], v))
_MASS = BilinearForm(lambda u, v, w: dot(u, v))


def _load(
    solids: Mapping[str, Any],
    built: Mapping[str, Any],
    whole: Any,
    side: ndarray,
    load: ndarray,
) -> ndarray:
    r"""Return the load on a finer mesh: tractions of the same densities.

    The tractions t of the sides solve :math:`\int t \cdot v = f(v)` on the sides of loaded nodes.
    """
    basis = next(iter(solids.values())).basis
    mesh = basis.mesh
    if not load.any():
        return np.zeros(whole.N)
    rest, total = _body_forces(solids, built, load, whole.N)

    # Find the sides of loaded nodes.
    loaded = np.abs(rest) > _INSIDE * max_abs(load)
    dofs = np.flatnonzero(loaded)
    if not len(dofs):
        return total
    boundary = mesh.boundary_facets()
    ends = loaded[basis.nodal_dofs].any(axis=0)[mesh.facets[:, boundary]]  # (2, n)
    facets = boundary[ends.all(axis=0)]  # not sides that touch a loaded side
    if len(basis.facet_dofs):
        facets = boundary[loaded[basis.facet_dofs[:, boundary]].any(axis=0)]
    inside = dofs
    if len(facets):
        inside = np.setdiff1d(dofs, basis.get_dofs(facets).all())
    if len(inside):
        where = format_point(basis.doflocs[:, inside[0]])
        raise ValueError(
            f"refine=True knows weights and tractions on boundaries, but the load acts at {where} "
            "inside of the bodies or on a point"
        )

    # Find their tractions and integrate these on the finer sides.
    on_sides = FacetBasis(mesh, basis.elem, facets=facets, intorder=4)
    own = basis.get_dofs(facets).all()
    M = within(_MASS.assemble(on_sides), own).tocsc()
    t = np.zeros(basis.N)
    t[own] = spsolve(M, rest[own])
    parts = np.flatnonzero(np.isin(side, facets))
    fine = FacetBasis(whole.mesh, whole.elem, facets=parts, intorder=4)
    at = np.asarray(fine.global_coordinates())  # (2, n_facets, n_points)
    located = _located(_straight(mesh), at)
    count = len(located.elements)
    shapes = []
    for i in range(len(basis.elem.elem.doflocs)):
        value = basis.elem.elem.lbasis(located.local, i)[0]
        shapes.append(np.broadcast_to(value, count))
    at_elements = np.argsort(elements_of(basis))[located.elements]
    nodal = t[basis.element_dofs[:, at_elements]].reshape(-1, 2, count)
    density = np.einsum("kn,kcn->cn", np.array(shapes), nodal).reshape(at.shape)
    return total + _FORCE.assemble(fine, t=density)


def _body_forces(
    solids: Mapping[str, Any],
    built: Mapping[str, Any],
    load: ndarray,
    size: int,
) -> tuple[ndarray, ndarray]:
    """Return a load less uniform forces of the regions, and these on the finer mesh, (N,)."""
    basis = next(iter(solids.values())).basis
    mesh = basis.mesh
    inner = np.ones(basis.N, bool)
    inner[basis.get_dofs(mesh.boundary_facets()).all()] = False
    total = np.zeros(size)
    if max_abs(load[inner]) <= _INSIDE * max_abs(load):
        return load, total

    # Fit one force in each region to the nodes inside.
    columns = []
    fine = []
    for name, form in solids.items():
        for old, new in zip(form.regions, built[name].regions, strict=True):
            for k in range(2):
                columns.append(_uniform(form, old, k))
                fine.append(_uniform(built[name], new, k))
    matrix = np.array(columns).T
    forces, *_ = np.linalg.lstsq(matrix[inner], load[inner], rcond=None)
    rest = load - matrix @ forces
    rest[np.abs(rest) <= 1e-9 * max_abs(load)] = 0.0
    return rest, np.array(fine).T @ forces


def _uniform(form: Any, region: Any, component: int) -> ndarray:
    """Return the load vector of a unit body force in a region, in axial symmetry per radian."""
    part = form.basis
    density = np.zeros((2, *form.weight.shape))
    density[component, region.elements] = 1.0
    if form.coordinates == "axisymmetric":
        density *= np.asarray(part.global_coordinates())[0]
    return np.asarray(_FORCE.assemble(part, t=density))
