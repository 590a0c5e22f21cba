"""Load vectors of weights and tractions, and the pressure below a water table."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis, FacetBasis, LinearForm, Mesh
from typing_extensions import override

from ..checks import (
    check_basis,
    facets_of,
    look_up,
    positive,
    tags_with,
    unit_vector,
)
from ..errors import warn
from ..layout import elements_of

#: A basis, or an object with a basis and coordinates, such as a solid form.
Body = Any
#: Density of water in kg/m3, which is no unit weight.
_DENSITY = (990.0, 1050.0)


class Domain(NamedTuple):
    """Elements of a basis in a coordinate system."""

    basis: CellBasis
    coordinates: str | None


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
    basis, axisymmetric = basis_of(body)
    gamma = by_element(basis.mesh, unit_weights)[elements_of(basis)]
    field = np.broadcast_to(gamma[:, None], basis.dx.shape).copy()
    dim = basis.mesh.dim()
    if direction is None:
        down = -np.eye(dim)[-1]
    else:
        down = unit_vector(direction, dim, "direction")

    @LinearForm
    def body_force(v, w):  # type: ignore[no-untyped-def]
        radius = 1.0
        if axisymmetric:
            radius = w.x[0]
        return radius * w.gamma * np.einsum("c,c...->...", down, np.asarray(v))

    return Load.of(body_force.assemble(basis, gamma=field), axisymmetric)


class Load(ndarray):
    """Load vector that remembers the coordinate system it was integrated in."""

    coordinates: str | None = None

    def __array_finalize__(self, other: Any) -> None:
        self.coordinates = getattr(other, "coordinates", None)

    @override
    def __array_wrap__(self, array: Any, context: Any = None, *scalar: Any) -> Any:
        arguments = context[1] if context else ()
        systems = {each.coordinates for each in arguments if isinstance(each, Load)}
        if len(systems - {None}) > 1:
            raise ValueError(
                "a load in plane coordinates cannot be combined with an axisymmetric one: make "
                "loads by the model, or from a solid form instead of a basis"
            )
        return super().__array_wrap__(array, context, *scalar)

    @classmethod
    def of(cls, values: Any, axisymmetric: bool) -> Load:
        """Return the vector with its coordinate system."""
        load = np.asarray(values).view(cls)
        if axisymmetric:
            load.coordinates = "axisymmetric"
        else:
            load.coordinates = "plane"
        return load


def basis_of(body: Body) -> tuple[CellBasis, bool]:
    """Return the basis of a body, checked, and True in axial symmetry."""
    if isinstance(body, CellBasis):
        basis = body
    else:
        basis = getattr(body, "basis", body)
    check_basis(basis)
    return basis, getattr(body, "coordinates", None) == "axisymmetric"


def by_element(
    mesh: Mesh,
    values: float | Mapping[str, float],
    what: str = "weight",
    missing: float = 0.0,
) -> ndarray:
    """Return checked values of all elements, (n_elements,), from one number or by subdomain."""
    # One value for all is that of one part.
    if isinstance(values, Mapping):
        parts = mesh.subdomains or {}
        given = values
    else:
        parts = {"all": np.arange(mesh.nelements)}
        given = {"all": values}
    # Set the values by part, and count them.
    result = np.full(mesh.nelements, missing)
    count = np.zeros(mesh.nelements, dtype=int)
    for name, value in given.items():
        elements = look_up(name, parts, "subdomain")
        result[elements] = value
        count[elements] += 1
    # Refuse elements with two values, and values that are no numbers.
    if count.max() > 1:
        raise ValueError(
            f"{(count > 1).sum()} elements get their {what} twice: the subdomains {list(given)} "
            f"overlap"
        )
    if not np.isfinite(result[count > 0]).all():
        raise ValueError(f"{what}s must be finite numbers, not {values!r}")
    return result


def weightless(body: Body, unit_weights: float | Mapping[str, float]) -> str:
    """Return which elements of a body get no weight, for a message; warn of negative weights."""
    mesh = body.basis.mesh
    present = elements_of(body.basis)
    given = by_element(mesh, unit_weights, "unit weight", np.nan)[present]
    if (given < 0.0).any():
        warn(
            f"unit weights are positive, and gravity acts against the last axis: {unit_weights} "
            f"acts upwards"
        )
    missing = present[np.isnan(given)]
    if len(missing) == 0:
        return ""
    return f"{len(missing)} elements of the subdomains {tags_with(missing, mesh.subdomains)}"


def traction(
    body: Body, boundary: str, force: Sequence[float] | Callable[[ndarray], ArrayLike]
) -> Load:
    """Return the load vector of forces per undeformed area on a boundary, (N,).

    Their direction stays, however much the body turns; :class:`~skfem_contact.Pressure` follows it.

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
    >>> strip = sc.traction(basis, "top", lambda x: (0. * x[0], -35. * (x[0] < .5)))
    >>> float(strip.sum())
    -17.5
    """
    basis, axisymmetric = basis_of(body)
    surface = FacetBasis(basis.mesh, basis.elem, facets=facets_of(basis.mesh, boundary))
    x = np.asarray(surface.global_coordinates())  # (dim, n_facets, n_points)
    dim = len(x)
    if callable(force):
        given = force(x)
    else:
        given = np.reshape(force, (-1, 1, 1))
    values = np.atleast_1d(np.asarray(given, float))
    if len(values) != dim or not np.isfinite(values).all():
        shown = repr(force)
        if callable(force):
            shown = f"{values.ravel()[:4].tolist()}, the first values of its function"
        raise ValueError(
            f"the force on '{boundary}' must have {dim} finite components, not {shown}"
        )
    radius = 1.0
    if axisymmetric:
        radius = x[0]
    values = np.broadcast_to(values, x.shape) * radius
    components = {f"t{c}": values[c] for c in range(dim)}

    @LinearForm
    def pushed(v, w):  # type: ignore[no-untyped-def]
        return sum(w[f"t{c}"] * v[c] for c in range(dim))

    return Load.of(pushed.assemble(surface, **components), axisymmetric)


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
    polyline = points.ndim == 2 and points.shape[1] == 2 and np.isfinite(points).all()
    if not polyline or (np.diff(points[:, 0]) <= 0).any():
        raise ValueError("a water table is a height, or points (n, 2) from left to right")
    weight_of_water(unit_weight)
    position, height = points.T

    def pressure(x: ndarray) -> ndarray:
        depth = np.maximum(np.interp(x[0], position, height) - x[-1], 0.0)
        return unit_weight * depth

    return pressure


def weight_of_water(unit_weight: float) -> float:
    """Return the unit weight of water, which must be positive; warn of its density."""
    lightest, heaviest = _DENSITY
    if lightest < positive(unit_weight, "unit_weight") < heaviest:
        warn(
            f"the unit weight of water is {unit_weight:g}, which is its density in kg/m3: the "
            f"weight is 9.81 kN/m3"
        )
    return float(unit_weight)
