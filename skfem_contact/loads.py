"""Loads: ordinary scikit-fem load vectors."""
from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis, FacetBasis, LinearForm, Mesh

from .errors import AnalysisWarning, check_basis, facets_of, look_up, names_of, place
from .layout import elements_of, linear_element

#: Pressure of water, positive: a function of places (2, ...), or values at the nodes of the mesh, (n_nodes,).
Pressure = Callable[[ndarray], ndarray] | ndarray

#: Facets that look up by more than this are a surface on which water can stand.
_UPWARDS = 0.01


def weight(basis: CellBasis, unit_weights: float | Mapping[str, float],
           direction: Sequence[float] | None = None, axisymmetric: bool = False) -> ndarray:
    """Own weight of bodies as a load vector.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh.
    unit_weights
        Weight per volume: one number, or by subdomain; subdomains that are not named are weightless.
    direction
        Unit vector of gravity; by default against the last axis, y or, in three dimensions, z.
    axisymmetric
        Weight per radian about the axis x = 0, for solids with ``strain=axisymmetric``.

    Returns
    -------
    ndarray
        Nodal forces, (N,).

    Raises
    ------
    ValueError
        Unknown subdomain, an element that two of them give a weight, weights that are NaN or infinite, or a direction
        that is no unit vector.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1), ElementVector(ElementQuad1()))
    >>> float(sc.weight(basis, 20.).sum())
    -20.0
    """
    check_basis(basis)
    gamma = by_element(basis.mesh, unit_weights)[elements_of(basis)]
    field = np.broadcast_to(gamma[:, None], basis.dx.shape).copy()
    down = -np.eye(basis.mesh.dim())[-1] if direction is None else np.asarray(direction, dtype=float)
    if down.shape != (basis.mesh.dim(),) or not np.isclose(np.linalg.norm(down), 1.0, rtol=0.0, atol=1e-6):
        raise ValueError(f"direction must be a unit vector with {basis.mesh.dim()} components, not {direction!r}")

    @LinearForm
    def body_force(v, w):  # type: ignore[no-untyped-def]
        radius = w.x[0] if axisymmetric else 1.0
        return radius * w.gamma * np.einsum("c,c...->...", down, np.asarray(v))

    return np.asarray(body_force.assemble(basis, gamma=field))


def by_element(mesh: Mesh, values: float | Mapping[str, float], what: str = "weight", missing: float = 0.0) -> ndarray:
    """Values of all elements of a mesh, checked, (n_elements,): one number, or by subdomain."""
    everywhere = {"all": np.arange(mesh.nelements)}
    parts, given = (mesh.subdomains or {}, values) if isinstance(values, Mapping) else (everywhere, {"all": values})
    result, count = np.full(mesh.nelements, missing), np.zeros(mesh.nelements, dtype=int)
    for name, value in given.items():
        elements = look_up(name, parts, "subdomain")
        result[elements] = value
        count[elements] += 1
    if count.max() > 1:
        raise ValueError(f"{(count > 1).sum()} elements get their {what} twice: the subdomains {list(given)} overlap")
    if not np.isfinite(result[count > 0]).all():
        raise ValueError(f"{what}s must be finite numbers, not {values!r}")
    return result


def traction(basis: CellBasis, boundary: str, force: Sequence[float] | Callable[[ndarray], ArrayLike],
             axisymmetric: bool = False) -> ndarray:
    """Forces per area on a boundary as a load vector.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh.
    boundary
        Name of a boundary.
    force
        Force per area, (dim,), or a function of places (dim, ...) that gives it, (dim, ...).
    axisymmetric
        Force per radian about the axis x = 0, for solids with ``strain=axisymmetric``.

    Returns
    -------
    ndarray
        Nodal forces, (N,).

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
    check_basis(basis)
    surface = FacetBasis(basis.mesh, basis.elem, facets=facets_of(basis.mesh, boundary))
    x = np.asarray(surface.global_coordinates())
    shape = (basis.mesh.dim(), *x.shape[1:])
    values = np.asarray(force(x) if callable(force) else np.reshape(force, (-1, 1, 1)), float)
    if len(values) != shape[0] or not np.isfinite(values).all():
        raise ValueError(f"the force on '{boundary}' must have {shape[0]} finite components, not {force!r}")
    values = np.broadcast_to(values, shape) * (x[0] if axisymmetric else 1.0)

    @LinearForm
    def pushed(v, w):  # type: ignore[no-untyped-def]
        return sum(w[f"t{c}"] * v[c] for c in range(shape[0]))

    return np.asarray(pushed.assemble(surface, **{f"t{c}": values[c] for c in range(shape[0])}))


def hydrostatic(table: float | ArrayLike, unit_weight: float = 9.81) -> Callable[[ndarray], ndarray]:
    """Pressure of water at rest below a water table.

    Parameters
    ----------
    table
        Height of the water table, or its points (x, height), (n, 2), from left to right; it goes on level at both ends.
    unit_weight
        Of water (force per volume), positive.

    Returns
    -------
    callable
        The pressure at places (dim, ...): zero above the table, below it the depth times the unit weight. The last
        coordinate is the height.

    Raises
    ------
    ValueError
        A table that is no height and no points from left to right, or a unit weight that is not positive.

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
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all() or (np.diff(points[:, 0]) <= 0).any():
        raise ValueError("a water table is a height, or points (n, 2) from left to right")
    if not 0.0 < unit_weight < np.inf:
        raise ValueError(f"the unit weight of water must be positive, not {unit_weight!r}")
    return lambda x: unit_weight * np.maximum(np.interp(x[0], *points.T) - x[-1], 0.0)


def water_load(basis: CellBasis, pressure: Pressure, boundaries: str | Sequence[str] = ()) -> ndarray:
    """Load of water in the pores and on boundaries; with it solids carry the effective stress.

    The total stress is the effective stress less the pore pressure in all directions. Soils below the water table
    get their saturated unit weight.

    Parameters
    ----------
    basis
        Basis of what is porous: ``basis.with_elements({"sand", "gravel"})``, or the whole mesh.
    pressure
        Pressure of the water: a function of the place such as :func:`hydrostatic`, or values at the nodes of the
        mesh, (n_nodes,), for example from a seepage analysis.
    boundaries
        Names of boundaries on which the water presses from outside: the surface of ground that is under water, and
        both sides of a contact, which then carries the effective stress.

    Returns
    -------
    ndarray
        Nodal forces, (N,).

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
    check_basis(basis)
    axes = range(basis.mesh.dim())
    named = names_of(boundaries)
    facets = [look_up(name, basis.mesh.boundaries or {}, "boundary") for name in named]
    if empty := [name for name, part in zip(named, facets) if len(np.asarray(part)) == 0]:
        raise ValueError(f"water cannot press on the boundaries {empty}: they are empty")
    _warn_of_water(basis, pressure, np.concatenate([np.asarray(f) for f in facets]) if facets else np.zeros(0, int))

    @LinearForm
    def in_pores(v, w):  # type: ignore[no-untyped-def]
        return w.p * sum(v.grad[c, c] for c in axes)

    @LinearForm
    def from_outside(v, w):  # type: ignore[no-untyped-def]
        return -w.p * sum(v[c] * w.n[c] for c in axes)

    load = np.asarray(in_pores.assemble(basis, p=_at_points(basis, pressure)))
    for part in facets:
        outside = FacetBasis(basis.mesh, basis.elem, facets=np.asarray(part))
        load = load + np.asarray(from_outside.assemble(outside, p=_at_points(outside, pressure)))
    if not load.any():
        warnings.warn("there is no water: the pressure is zero everywhere", AnalysisWarning, stacklevel=2)
    return load


def _at_points(basis: CellBasis | FacetBasis, pressure: Pressure) -> ndarray:
    """The pressure at the integration points."""
    if callable(pressure):
        return np.asarray(pressure(np.asarray(basis.global_coordinates())))
    n = basis.mesh.nvertices
    if np.shape(pressure) != (n,):
        raise ValueError(f"the pressure has shape {np.shape(pressure)}; the mesh has {n} nodes")
    return np.asarray(basis.with_element(linear_element(basis.mesh)).interpolate(np.asarray(pressure)))


def _warn_of_water(basis: CellBasis, pressure: Pressure, pressed: ndarray) -> None:
    """Tell of surfaces under water without pressure: facets with porous ground below and none above."""
    mesh = basis.mesh
    count = np.bincount(mesh.t2f[:, elements_of(basis)].ravel(), minlength=mesh.nfacets)
    facets = np.setdiff1d(np.flatnonzero((count == 1) & (mesh.f2t[1] < 0)), pressed)
    if len(facets) == 0:
        return
    surface = FacetBasis(mesh, basis.elem, facets=facets)
    values = _at_points(surface, pressure)
    wet = (np.asarray(surface.normals)[-1] > _UPWARDS) & (values > 1e-9 * np.abs(values).max())
    if wet.any():
        where = place(np.asarray(surface.global_coordinates())[:, wet].T[0])
        names = [k for k, f in (mesh.boundaries or {}).items() if np.isin(facets[wet.any(axis=1)], f).any()]
        warnings.warn(f"there is water above the surface at {where} without pressure on it; pass its name "
                      f"in boundaries= ({', '.join(names) or 'it has none yet'})", AnalysisWarning, stacklevel=3)
