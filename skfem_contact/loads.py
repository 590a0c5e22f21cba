"""Loads: ordinary load vectors of scikit-fem."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis, FacetBasis, LinearForm, Mesh
from typing_extensions import override

from .checks import (
    check_basis,
    facets_of,
    finite,
    format_point,
    look_up,
    names_of,
    positive,
    unit_vector,
)
from .errors import warn
from .layout import elements_of, linear_element

#: Pressure of water, positive: a function of coordinates (2, ...), or values at the nodes of the
#: mesh, (n_nodes,).
Pressure = Callable[[ndarray], ndarray] | ndarray

#: A basis, or whatever has a basis and coordinates, as solid forms have.
Body = Any


class Domain(NamedTuple):
    """Elements of a basis in a coordinate system."""

    basis: CellBasis
    coordinates: str | None


#: Facets that look up by more than this are a surface that can be under water.
_UPWARDS = 0.01


def weight(
    body: Body,
    unit_weights: float | Mapping[str, float],
    direction: Sequence[float] | ndarray | None = None,
) -> Load:
    """Return the load vector of the weight of bodies, (N,).

    Parameters
    ----------
    body
        ``Basis`` of the mesh, or a solid form, whose coordinate system counts.
    unit_weights
        Weight per volume: one number, or by subdomain; subdomains that are not named are
        weightless.
    direction
        Unit vector of gravity; by default against the last axis, y or, in three dimensions, z.

    Raises
    ------
    ValueError
        Unknown subdomain, an element that two of them give a weight, weights that are NaN or
        infinite, or a direction that is no unit vector.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1), ElementVector(ElementQuad1()))
    >>> float(sc.weight(basis, 20.).sum())
    -20.0
    """
    basis, axisymmetric = _basis_of(body)
    gamma = by_element(basis.mesh, unit_weights)[elements_of(basis)]
    field = np.broadcast_to(gamma[:, None], basis.dx.shape).copy()
    dim = basis.mesh.dim()
    down = -np.eye(dim)[-1] if direction is None else unit_vector(direction, dim, "direction")

    @LinearForm
    def body_force(v, w):  # type: ignore[no-untyped-def]
        radius = w.x[0] if axisymmetric else 1.0
        return radius * w.gamma * np.einsum("c,c...->...", down, np.asarray(v))

    return Load.of(body_force.assemble(basis, gamma=field), axisymmetric)


class Load(ndarray):
    """Load vector that remembers the coordinate system it was integrated in."""

    coordinates: str | None = None

    def __array_finalize__(self, other: Any) -> None:
        self.coordinates = getattr(other, "coordinates", None)

    @override
    def __array_wrap__(self, array: Any, context: Any = None, *scalar: Any) -> Any:
        used = {
            one.coordinates for one in (context[1] if context else ()) if isinstance(one, Load)
        } - {None}
        if len(used) > 1:
            raise ValueError(
                "a load in plane coordinates cannot be combined with an axisymmetric one: make "
                "loads by "
                "the model, or from a solid form instead of a basis"
            )
        return super().__array_wrap__(array, context, *scalar)

    @classmethod
    def of(cls, values: Any, axisymmetric: bool) -> Load:
        """Return the vector with its coordinate system."""
        load = np.asarray(values).view(cls)
        load.coordinates = "axisymmetric" if axisymmetric else "plane"
        return load


def _basis_of(body: Body) -> tuple[CellBasis, bool]:
    """Return the basis of a body, checked, and True in axial symmetry."""
    basis = body if isinstance(body, CellBasis) else getattr(body, "basis", body)
    check_basis(basis)
    return basis, getattr(body, "coordinates", None) == "axisymmetric"


def by_element(
    mesh: Mesh, values: float | Mapping[str, float], what: str = "weight", missing: float = 0.0
) -> ndarray:
    """Return values of all elements of a mesh, checked, (n_elements,): one number, or by
    subdomain.
    """
    everywhere = {"all": np.arange(mesh.nelements)}
    parts, given = (
        (mesh.subdomains or {}, values)
        if isinstance(values, Mapping)
        else (everywhere, {"all": values})
    )
    result, count = np.full(mesh.nelements, missing), np.zeros(mesh.nelements, dtype=int)
    for name, value in given.items():
        elements = look_up(name, parts, "subdomain")
        result[elements] = value
        count[elements] += 1
    if count.max() > 1:
        raise ValueError(
            f"{(count > 1).sum()} elements get their {what} twice: the subdomains {list(given)} "
            f"overlap"
        )
    if not np.isfinite(result[count > 0]).all():
        raise ValueError(f"{what}s must be finite numbers, not {values!r}")
    return result


def weightless(body: Body, unit_weights: float | Mapping[str, float]) -> str:
    """Return which elements of a body get no weight, for a message; warn of weights that act
    upwards.
    """
    mesh, present = body.basis.mesh, elements_of(body.basis)
    given = by_element(mesh, unit_weights, "unit weight", np.nan)[present]
    missing = present[np.isnan(given)]
    if (given < 0.0).any():
        warn(
            f"unit weights are positive, and gravity acts against the last axis: {unit_weights} "
            f"acts upwards"
        )
    names = [name for name, part in (mesh.subdomains or {}).items() if np.isin(missing, part).any()]
    return f"{len(missing)} elements of the subdomains {names}" if len(missing) else ""


def traction(
    body: Body, boundary: str, force: Sequence[float] | Callable[[ndarray], ArrayLike]
) -> Load:
    """Return the load vector of forces per area on a boundary, (N,).

    Parameters
    ----------
    body
        ``Basis`` of the mesh, or a solid form, whose coordinate system counts.
    boundary
        Name of a boundary.
    force
        Force per area, (dim,), or a function of coordinates (dim, ...) that returns it, (dim, ...).

    Raises
    ------
    ValueError
        Unknown or empty boundary, or forces that are not finite or no (dim,).

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()))
    >>> float(sc.traction(basis, "top", (0., -35.)).sum())
    -35.0
    >>> strip = sc.traction(basis, "top", lambda x: (0. * x[0], -35. * (x[0] < .5)))    # on half of it
    >>> float(strip.sum())
    -17.5
    """
    basis, axisymmetric = _basis_of(body)
    surface = FacetBasis(basis.mesh, basis.elem, facets=facets_of(basis.mesh, boundary))
    x = np.asarray(surface.global_coordinates())
    shape = (basis.mesh.dim(), *x.shape[1:])
    values = np.atleast_1d(
        np.asarray(force(x) if callable(force) else np.reshape(force, (-1, 1, 1)), float)
    )
    if len(values) != shape[0] or not np.isfinite(values).all():
        raise ValueError(
            f"the force on '{boundary}' must have {shape[0]} finite components, not {force!r}"
        )
    values = np.broadcast_to(values, shape) * (x[0] if axisymmetric else 1.0)

    @LinearForm
    def pushed(v, w):  # type: ignore[no-untyped-def]
        return sum(w[f"t{c}"] * v[c] for c in range(shape[0]))

    return Load.of(
        pushed.assemble(surface, **{f"t{c}": values[c] for c in range(shape[0])}), axisymmetric
    )


def hydrostatic(
    table: float | ArrayLike, unit_weight: float = 9.81
) -> Callable[[ndarray], ndarray]:
    """Return the pressure of water at rest below a water table.

    Parameters
    ----------
    table
        Height of the water table, or its points (x, height), (n, 2), from left to right; level
        beyond its ends.
    unit_weight
        Of water (force per volume), positive.

    Returns
    -------
    callable
        The pressure at coordinates (dim, ...): zero above the table, below it the depth times the
        unit weight. The last coordinate is the height.

    Raises
    ------
    ValueError
        A table that is no height and no points from left to right, or a unit weight that is not
        positive.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> sc.hydrostatic(2., unit_weight=10.)(np.array([[0., 0.], [3., 1.]]))
    array([ 0., 10.])
    >>> float(sc.hydrostatic([(0, 2), (4, 0)], unit_weight=10.)(np.array([2., -1.])))
    20.0
    """
    points = np.asarray(table, dtype=float)
    if points.ndim == 0:
        points = np.array([[0.0, float(points)]])
    if (
        points.ndim != 2
        or points.shape[1] != 2
        or not np.isfinite(points).all()
        or (np.diff(points[:, 0]) <= 0).any()
    ):
        raise ValueError("a water table is a height, or points (n, 2) from left to right")
    weight_of_water(unit_weight)
    return lambda x: unit_weight * np.maximum(np.interp(x[0], *points.T) - x[-1], 0.0)


def weight_of_water(unit_weight: float) -> float:
    """Return the unit weight of water, which must be positive; warn of its density."""
    if 990.0 < positive(unit_weight, "unit_weight") < 1050.0:
        warn(
            f"the unit weight of water is {unit_weight:g}, which is its density in kg/m3: the "
            f"weight is 9.81 kN/m3"
        )
    return float(unit_weight)


def water_load(body: Body, pressure: Pressure, boundaries: str | Sequence[str] = ()) -> Load:
    """Return the load vector of water in the pores and on boundaries, (N,); stresses are then
    effective.

    The total stress is the effective stress less the pore pressure in all directions. Soils below
    the water table get their saturated unit weight.

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
    Flooded ground: what is left of its weight of 20 is its weight in water.

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> water = sc.water_load(basis, sc.hydrostatic(5., unit_weight=10.), ["top", "bottom", "left", "right"])
    >>> round(float((sc.weight(basis, 20.) + water).sum()), 9)
    -10.0
    """
    basis, axisymmetric = _basis_of(body)
    named = names_of(boundaries)
    facets = [look_up(name, basis.mesh.boundaries or {}, "boundary") for name in named]
    if empty := [name for name, part in zip(named, facets) if len(np.asarray(part)) == 0]:
        raise ValueError(f"water cannot press on the boundaries {empty}: they are empty")
    _warn_of_water(
        basis,
        pressure,
        np.concatenate([np.asarray(f) for f in facets]) if facets else np.zeros(0, int),
    )
    load = pore_load(basis, at_points(basis, pressure), axisymmetric)
    for part in facets:
        outside = FacetBasis(basis.mesh, basis.elem, facets=np.asarray(part))
        load = load + face_load(
            outside, np.maximum(at_points(outside, pressure), 0.0), axisymmetric
        )
    if not load.any():
        warn("there is no water: the pressure is zero everywhere")
    return Load.of(load, axisymmetric)


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
        radius = w.x[0] if axisymmetric else 1.0
        return -radius * w.p * sum(v[c] * w.n[c] for c in axes)

    return np.asarray(from_outside.assemble(outside, p=pressure))


def at_points(basis: CellBasis | FacetBasis, pressure: Pressure) -> ndarray:
    """Return the pressure at the integration points."""
    if callable(pressure):
        return finite(pressure(np.asarray(basis.global_coordinates())), "the pressure")
    n = basis.mesh.nvertices
    if np.shape(pressure) != (n,):
        raise ValueError(f"the pressure has shape {np.shape(pressure)}; the mesh has {n} nodes")
    return np.asarray(
        basis.with_element(linear_element(basis.mesh)).interpolate(np.asarray(pressure))
    )


def _warn_of_water(basis: CellBasis, pressure: Pressure, pressed: ndarray) -> None:
    """Warn about surfaces under water without pressure: facets with porous ground below and none
    above.
    """
    mesh = basis.mesh
    count = np.bincount(mesh.t2f[:, elements_of(basis)].ravel(), minlength=mesh.nfacets)
    facets = np.setdiff1d(np.flatnonzero((count == 1) & (mesh.f2t[1] < 0)), pressed)
    if len(facets) == 0:
        return
    surface = FacetBasis(mesh, basis.elem, facets=facets)
    values = at_points(surface, pressure)
    wet = (np.asarray(surface.normals)[-1] > _UPWARDS) & (values > 1e-9 * np.abs(values).max())
    if wet.any():
        where = format_point(np.asarray(surface.global_coordinates())[:, wet].T[0])
        names = [
            k
            for k, f in (mesh.boundaries or {}).items()
            if np.isin(facets[wet.any(axis=1)], f).any()
        ]
        warn(
            f"there is water above the surface at {where} without pressure on it; pass its name "
            f"in boundaries= ({', '.join(names) or 'it has none yet'})"
        )
