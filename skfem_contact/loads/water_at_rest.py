"""Water at rest: the pressure of a level, a seepage or values at vertices, and its load vector."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
import scipy
from numpy import ndarray
from skfem import CellBasis, FacetBasis, LinearForm, Mesh
from skfem.generic_utils import OrientedBoundary

from ..arrays import max_abs, row_norms
from ..checks import facets_of, finite, format_point, look_up, names_of, tags_with
from ..errors import warn
from ..layout import elements_of, facet_counts, linear_element
from .sides import Sides, facing
from .vectors import Body, Load, basis_of, hydrostatic

#: Pressure of water, positive: a function of coordinates (2, ...), or values at the nodes of the
#: mesh, (n_nodes,).
Pressure = Callable[[ndarray], ndarray] | ndarray

#: Facets that look up by more than this are a surface that can be under water.
_UPWARDS = 0.01
#: Pressure over the largest one that is round-off.
_DRY = 1e-9
#: Water differs on both sides of a slit if its pressures do by more than this share of the largest.
_DIFFERS = 0.05
#: Suction over the largest pressure that is round-off.
_SUCTION = 1e-6
#: Distance of facets that coincide, over their size.
_SAME = 1e-6
#: Distance of a side of a beam from the facet it faces, over the size of the facet: farther ones
#: lie above the ground.
_OFF = 0.1


@runtime_checkable
class SteadyFlow(Protocol):
    """Steady flow of water, with heads and pressures at the vertices of a mesh."""

    basis: CellBasis
    head: ndarray
    pressure: ndarray

    def head_at(self, x: ndarray, outside: ndarray | None = None) -> ndarray:
        """Return the head at coordinates; outside of the ground the given one."""

    def pressure_at(self, x: ndarray, head: ndarray | None = None) -> ndarray:
        """Return the pressure at coordinates, also under a given head."""


def water_load(body: Body, pressure: Pressure, boundaries: str | Sequence[str] = ()) -> Load:
    """Return the load vector of water in the pores and on boundaries, (N,).

    Stresses are then effective: the total stress is the effective stress less the pore pressure in
    all directions. Soils below the water table get their saturated unit weight.

    Parameters
    ----------
    body
        Basis of the porous elements, such as ``basis.with_elements({"sand", "gravel"})``, or a
        solid form, whose coordinate system counts.
    pressure
        Pressure of the water: a function of the coordinates such as :func:`hydrostatic`, or values
        at the nodes of the mesh, (n_nodes,), for example from a seepage analysis.
    boundaries
        Names of boundaries on which the water presses from outside: the surface of ground that is
        under water, and both sides of a contact, whose pressure is then effective.

    Raises
    ------
    ValueError
        Unknown or empty boundary, or values that are not as many as the nodes.

    Warns
    -----
    AnalysisWarning
        There is water above a surface on which no pressure acts.

    Examples
    --------
    Flooded ground of a unit weight of 20 keeps its buoyant weight.

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(1).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> outline = ["top", "bottom", "left", "right"]
    >>> water = sc.water_load(basis, sc.hydrostatic(5., unit_weight=10.), outline)
    >>> round(float((sc.weight(basis, 20.) + water).sum()), 9)
    -10.0
    """
    # Find the boundaries, none of which is empty.
    basis, axisymmetric = basis_of(body)
    mesh = basis.mesh
    names = names_of(boundaries)
    parts = [facets_of(mesh, name) for name in names]
    facets = np.unique(np.concatenate([np.zeros(0, int), *parts]))
    # Add the load of the pores, and of the water that presses from outside, once where names
    # overlap.
    _warn_of_flooding(basis, pressure, facets)
    load = pore_load(basis, at_points(basis, pressure), axisymmetric)
    if len(facets):
        outside = FacetBasis(mesh, basis.elem, facets=facets)
        pressing = np.maximum(at_points(outside, pressure), 0.0)
        load = load + face_load(outside, pressing, axisymmetric)
    if not load.any():
        warn("there is no water: the pressure is zero everywhere")
    return Load.of(load, axisymmetric)


def loads_at_rest(
    solids: Mapping[str, Any],
    forms: Iterable[Any],
    water: Any,
    unit_weight: float | None,
) -> Iterator[ndarray]:
    """Yield the loads of water in the pores and on all sides of active bodies, and on other forms.

    The pressure acts on every facet that bounds the active elements: free surfaces, excavated
    faces, both sides of contacts. Levels by region apply to the elements of these regions, a
    seepage to the elements of its basis: others are dry. A facet of a body without pores, and a
    side of a beam, take the head of the nearest facet of a porous body.
    """
    first = next(iter(solids.values()))
    mesh = first.basis.mesh
    axisymmetric = first.coordinates == "axisymmetric"
    pressure = as_pressure(water, mesh, unit_weight)

    # Fill the pores.
    grounds = [form for form in solids.values() if form.porous]
    for ground in grounds:
        inside = in_elements(ground.basis, pressure, ground.elements)
        _warn_of_suction(pressure, inside)
        yield pore_load(ground.basis, inside, axisymmetric)

    # Press on the facets of the active bodies.
    outside = FacetBasis(mesh, first.basis.elem, facets=_bounding(mesh, solids.values()))
    wet = np.concatenate([np.zeros(0, int), *(ground.elements for ground in grounds)])
    porous = np.isin(outside.tind, wet)
    pressing = np.maximum(_on_facets(outside, pressure, porous), 0.0)  # suction is inside only
    yield face_load(outside, pressing, axisymmetric)

    # Press on the sides of beams.
    beams = [np.zeros((0, mesh.dim()))]

    def on_sides(points: ndarray, normals: ndarray, sizes: ndarray) -> ndarray:
        beams.append(points)
        sides = Sides(points, normals, sizes)
        return np.maximum(_on_sides(outside, pressure, porous, sides), 0.0)

    for form in forms:
        load = form.water_load(on_sides)
        if load is not None:
            yield load
    if not callable(pressure):
        _check_slits(outside, porous, pressing.mean(axis=1), np.concatenate(beams))


def as_pressure(water: Any, mesh: Mesh, unit_weight: float | None) -> Any:
    """Return a seepage, a function of coordinates or values at vertices, or a mapping by region."""
    if isinstance(water, str):
        # Look up water by region.
        raise ValueError(f"the water of the start is {water}: give the first stage its `water`")
    if isinstance(water, Mapping):
        for name in water:
            look_up(name, mesh.subdomains or {}, "subdomain")
        by_region = {}
        for name, level in water.items():
            by_region[name] = as_pressure(getattr(level, "pressure", level), mesh, unit_weight)
        return by_region
    # Return what already is a pressure.
    given = isinstance(water, SteadyFlow) or callable(water)
    if given or np.shape(water) == (mesh.nvertices,):
        return water
    # A level needs the unit weight of water.
    if unit_weight is None:
        raise ValueError(
            "a water level needs the unit weight of water: give the model `water_unit_weight`, or "
            f"pressures at the {mesh.nvertices} vertices"
        )
    return hydrostatic(water, unit_weight=unit_weight)


def pressures(water: Any, mesh: Mesh, unit_weight: float | None) -> Any:
    """Return water at rest by coordinates or at vertices, or a mapping of these by region."""
    pressure = as_pressure(water, mesh, unit_weight)
    if not isinstance(pressure, Mapping):
        return getattr(pressure, "pressure", pressure)
    return {name: getattr(part, "pressure", part) for name, part in pressure.items()}


def one_pressure(water: Any, mesh: Mesh, unit_weight: float | None) -> Any:
    """Return water at rest as a function of coordinates or values at vertices, for bounds."""
    pressure = as_pressure(water, mesh, unit_weight)
    if isinstance(pressure, Mapping):
        raise ValueError(
            "bounds beside a search know water with one pressure, but it is by region: leave out "
            "`certify`, and take `model.bounds(water=...)`"
        )
    return getattr(pressure, "pressure", pressure)


def at_nodes(solid: Any, water: Any, unit_weight: float | None) -> ndarray:
    """Return the pressure in the elements of a porous solid at their nodes, (n_elements, n)."""
    basis = solid.basis
    corners = np.asarray(basis.elem.elem.doflocs).T
    quadrature = (corners, np.ones(corners.shape[1]))
    nodal = CellBasis(basis.mesh, basis.elem, elements=solid.elements, quadrature=quadrature)
    return in_elements(nodal, as_pressure(water, basis.mesh, unit_weight), solid.elements)


def in_elements(basis: CellBasis, pressure: Any, elements: ndarray) -> ndarray:
    """Return the pressure of water in given elements at their integration points."""
    if not isinstance(pressure, SteadyFlow):
        return _by_region(basis, pressure, elements)
    values, wet = _in_seepage(basis, pressure, elements, at_points(basis, pressure.head))
    # Dry pores have suction.
    suction = at_points(basis, np.minimum(np.nan_to_num(pressure.pressure), 0.0))
    dry = wet[:, None] & (values == 0.0)
    return values + np.where(dry, suction, 0.0)


def _on_facets(outside: FacetBasis, pressure: Any, porous: ndarray) -> ndarray:
    """Return the pressure at the integration points of facets, some of porous elements."""
    seepage = isinstance(pressure, SteadyFlow)
    if not seepage and not isinstance(pressure, Mapping):
        return at_points(outside, pressure)
    faced = facing(Sides.of(outside), porous)
    owner = np.asarray(outside.tind)[faced]
    if not seepage:
        return _by_region(outside, pressure, owner)
    # Continue the head of faced ground to facets above the ground, such as facets of walls.
    head = at_points(outside, pressure.head)
    wet = np.isin(owner, elements_of(pressure.basis))
    above = wet & (faced != np.arange(len(faced)))
    if above.any():
        x = np.asarray(outside.global_coordinates())[:, above]
        faced_head = head[faced[above]].mean(axis=1)
        head[above] = pressure.head_at(x, faced_head[:, None])
    return _in_seepage(outside, pressure, owner, head)[0]


def _in_seepage(
    basis: CellBasis | FacetBasis,
    seepage: SteadyFlow,
    elements: ndarray,
    head: ndarray,
) -> tuple[ndarray, ndarray]:
    """Return the pressure of a head at integration points, and which elements are porous."""
    x = np.asarray(basis.global_coordinates())  # (dim, n, n_points)
    wet = np.isin(elements, elements_of(seepage.basis))
    values = np.zeros(x.shape[1:])
    values[wet] = seepage.pressure_at(x[:, wet], head[wet])
    return values, wet


def _by_region(basis: CellBasis | FacetBasis, pressure: Any, elements: ndarray) -> ndarray:
    """Return the pressure at integration points by the region of given elements."""
    if not isinstance(pressure, Mapping):
        return at_points(basis, pressure)
    values = np.zeros(basis.dx.shape)
    for name, given in pressure.items():
        here = np.isin(elements, basis.mesh.subdomains[name])
        values[here] = at_points(basis, given)[here]
    return values


def _on_sides(outside: FacetBasis, pressure: Any, porous: ndarray, sides: Sides) -> ndarray:
    """Return the pressure at the middles of sides that are no facets, (n,).

    A side takes the pressure of the facet of porous ground that it faces, and is dry without one.
    """
    if callable(pressure):
        return np.asarray(pressure(sides.middle.T))
    around = Sides.of(outside).followed_by(sides)
    none = np.zeros(len(sides.size), bool)
    faced = facing(around, np.append(porous, none))[len(porous) :]
    faces = faced < len(porous)
    values = np.zeros(len(faced))
    values[faces] = _beside_facets(outside, pressure, faced[faces], sides.middle[faces])
    return values


def _beside_facets(outside: FacetBasis, pressure: Any, facets: ndarray, points: ndarray) -> ndarray:
    """Return the pressure at points (n, 2) by the nearest points of facets (n,) of the ground."""
    mesh = outside.mesh
    owner = outside.tind[facets]
    ends = mesh.facets[:, outside.find[facets]]
    # Find the nearest point a + s (b - a) of each facet.
    a, b = mesh.p[:, ends].transpose(1, 2, 0)
    along = b - a
    s = ((points - a) * along).sum(axis=1) / (along**2).sum(axis=1)
    s = np.clip(s, 0.0, 1.0)
    nearest = np.stack((1.0 - s, s))
    values = np.zeros(len(points))
    # Continue the head of a seepage.
    if isinstance(pressure, SteadyFlow):
        wet = np.isin(owner, elements_of(pressure.basis))
        head = (nearest * pressure.head[ends]).sum(axis=0)
        values[wet] = pressure.pressure_at(points[wet].T, head[wet])
        return values
    # Take levels at the points, and values at vertices at the nearest points.
    distance = row_norms(a + s[:, None] * along - points)
    off = distance > _OFF * row_norms(along)
    if isinstance(pressure, Mapping):
        by_region = pressure
    else:
        by_region = {"": pressure}
    for name, given in by_region.items():
        if name:
            here = np.isin(owner, mesh.subdomains[name])
        else:
            here = np.full(len(points), True)
        if callable(given):
            values[here] = given(points[here].T)
            continue
        values[here] = (nearest * given[ends]).sum(axis=0)[here]
        unknown = here & off & (values > 0.0)
        if unknown.any():
            raise ValueError(
                "pressures at the vertices do not say what presses on a beam above the ground, at "
                f"{format_point(points[unknown][0])}: give water levels or a seepage"
            )
    return values


def at_points(basis: CellBasis | FacetBasis, pressure: Pressure) -> ndarray:
    """Return the pressure at the integration points."""
    if callable(pressure):
        return finite(pressure(np.asarray(basis.global_coordinates())), "the pressure")
    n = basis.mesh.nvertices
    if np.shape(pressure) != (n,):
        raise ValueError(f"the pressure has shape {np.shape(pressure)}; the mesh has {n} nodes")
    linear = basis.with_element(linear_element(basis.mesh))
    return np.asarray(linear.interpolate(np.asarray(pressure)))


def pore_load(basis: CellBasis, pressure: ndarray, axisymmetric: bool) -> ndarray:
    """Return the load vector of a pore pressure at the integration points, (N,)."""
    axes = range(basis.mesh.dim())

    @LinearForm
    def in_pores(v, w):  # type: ignore[no-untyped-def]
        volume = sum(v.grad[c, c] for c in axes)
        return w.p * (w.x[0] * volume + v[0] if axisymmetric else volume)

    return np.asarray(in_pores.assemble(basis, p=pressure))


def face_load(outside: FacetBasis, pressure: ndarray, axisymmetric: bool) -> ndarray:
    """Return the load vector of a pressure at the integration points of facets, (N,)."""
    axes = range(outside.mesh.dim())

    @LinearForm
    def from_outside(v, w):  # type: ignore[no-untyped-def]
        radius = 1.0
        if axisymmetric:
            radius = w.x[0]
        return -radius * w.p * sum(v[c] * w.n[c] for c in axes)

    return np.asarray(from_outside.assemble(outside, p=pressure))


def _bounding(mesh: Mesh, solids: Iterable[Any]) -> OrientedBoundary:
    """Return the facets that bound the elements of some bodies, seen from these elements."""
    active = np.zeros(mesh.nelements, bool)
    for form in solids:
        active[form.elements] = True
    first = active[mesh.f2t[0]]
    second = active[mesh.f2t[1]] & (mesh.f2t[1] >= 0)
    facets = np.flatnonzero(first != second)
    return OrientedBoundary(facets, second[facets].astype(int))


def _warn_of_suction(pressure: Any, inside: ndarray) -> None:
    """Report a user's function of coordinates that gives suction."""
    given = callable(pressure) and getattr(pressure, "__self__", None) is None
    if given and inside.min() < -_SUCTION * max_abs(inside):
        warn(
            f"the function of the water has pressures down to {inside.min():.3g}: this suction "
            "counts as strength; return np.maximum(pressure, 0) where it is not meant"
        )


def _check_slits(outside: FacetBasis, porous: ndarray, pressing: ndarray, beams: ndarray) -> None:
    """Report slits without a beam whose sides have different pressures: nothing resists them."""
    # Find facets that lie on each other.
    sides = Sides(*(values[porous] for values in Sides.of(outside)))
    pressure = pressing[porous]
    distance = _SAME * sides.size.min(initial=np.inf)
    tree = scipy.spatial.cKDTree(sides.middle)
    first, second = tree.query_pairs(distance, output_type="ndarray").T
    if len(first) == 0:
        return
    # A beam between the sides resists the difference.
    if len(beams):
        to_beam = np.asarray(scipy.spatial.cKDTree(beams).query(sides.middle[first])[0])
    else:
        to_beam = np.full(len(first), np.inf)
    # Compare the pressures of opposite sides.
    cosine = np.einsum("nc,nc->n", sides.normal[first], sides.normal[second])
    open_ = (cosine < 0.0) & (to_beam > sides.size[first])
    lost = np.abs(pressure[first] - pressure[second]) * open_
    k = lost.argmax()
    if lost[k] > _DIFFERS * pressing.max():
        warn(
            f"water presses with {pressure[first[k]]:.3g} on one side of the slit at "
            f"{format_point(sides.middle[first[k]])} and with {pressure[second[k]]:.3g} on the "
            "other; no beam lies there to resist the difference: it is lost unless a Beam in the "
            "slit or a traction represents it"
        )


def _warn_of_flooding(basis: CellBasis, pressure: Pressure, pressed: ndarray) -> None:
    """Report surfaces under water without pressure on them."""
    # Find facets with porous ground below and none above.
    mesh = basis.mesh
    count = facet_counts(mesh, elements_of(basis))
    free = (count == 1) & (mesh.f2t[1] < 0)
    facets = np.setdiff1d(np.flatnonzero(free), pressed)
    if len(facets) == 0:
        return
    surface = FacetBasis(mesh, basis.elem, facets=facets)
    values = at_points(surface, pressure)
    upwards = np.asarray(surface.normals)[-1] > _UPWARDS
    wet = upwards & (values > _DRY * max_abs(values))
    if not wet.any():
        return
    where = format_point(np.asarray(surface.global_coordinates())[:, wet].T[0])
    flooded = facets[wet.any(axis=1)]
    names = tags_with(flooded, mesh.boundaries)
    warn(
        f"there is water above the surface at {where} without pressure on it; pass its name "
        f"in boundaries= ({', '.join(names) or 'it has none yet'})"
    )
