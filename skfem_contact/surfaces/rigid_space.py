"""Rigid obstacles in space: surfaces of second-order facets that no unknown moves."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementTetP1,
    ElementTetP2,
    ElementVector,
    Mesh,
    MeshQuad1,
    MeshQuad2,
    MeshTet,
)

from ..errors import look_up
from .shape import Shape
from .surface import Surface
from .topology import adjacent
from .vectors import across, dot, unit

#: Facets on a quarter of a circle: they are round to 1e-6 of the radius.
_QUARTER = 12
#: Nodes nearer to each other than this share of the surface are one.
_SAME = 1e-6


def rigid_plane(point: ArrayLike, normal: ArrayLike, width: float, name: str = "obstacle") -> Surface:
    """A rigid square of a plane.

    Parameters
    ----------
    point
        Its middle, (x, y, z).
    normal
        Direction of its free side.
    width
        Length of its sides.
    name
        For messages.

    Raises
    ------
    ValueError
        A width that is not positive, a normal without direction, or a point that is no finite (x, y, z).

    Examples
    --------
    >>> from skfem_contact import rigid_plane
    >>> round(float(rigid_plane((0., 0., 0.), (0., 0., 1.), width=4.).area.sum()), 12)
    16.0
    """
    _check(name, width=width)
    axes = _axes(name, normal)
    middle = _place(name, point)
    corners = 0.5 * width * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return _surface(name, middle + corners @ axes[:2], np.arange(4)[None], Shape.of_facets(ElementHex1()))


def rigid_sphere(center: ArrayLike, radius: float, hole: bool = False, name: str = "obstacle") -> Surface:
    """A rigid ball, or a round hole in a rigid body.

    Parameters
    ----------
    center, radius
        Centre (x, y, z) and radius.
    hole
        Whether the body is outside of the sphere.
    name
        For messages.

    Raises
    ------
    ValueError
        A radius that is not positive, or a centre that is no finite (x, y, z).

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import rigid_sphere
    >>> bool(abs(rigid_sphere((0., 0., 0.), 2.).area.sum() / (16 * np.pi) - 1) < 1e-6)
    True
    """
    _check(name, radius=radius)
    sides = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            def on_cube(u: ndarray, v: ndarray, axis: int = axis, side: float = side) -> ndarray:
                x = np.stack((np.tan(u), np.tan(v), np.full_like(u, side)), axis=1)
                return unit(np.roll(x, axis + 1, axis=1))
            sides.append(_patch(on_cube, (-np.pi / 4, np.pi / 4), (-np.pi / 4, np.pi / 4), _QUARTER, _QUARTER))
    points, facets = _joined(sides)
    corners = points[facets[:, :4]]  # in the middle of an arc, and of all four: round to the fourth order of the size
    points[facets[:, 4:8]] = unit(corners + np.roll(corners, -1, axis=1))
    points[facets[:, 8]] = unit(corners.sum(axis=1))
    return _surface(name, _place(name, center) + radius * points, facets, Shape.of_facets(ElementHex2()),
                    lambda x: (x - _place(name, center)) * (-1.0 if hole else 1.0))


def rigid_cylinder(start: ArrayLike, end: ArrayLike, radius: float, hole: bool = False, name: str = "obstacle"
                   ) -> Surface:
    """The round side of a rigid cylinder, or of a round hole in a rigid body.

    Parameters
    ----------
    start, end
        Ends of its axis, (x, y, z).
    radius
        Its radius.
    hole
        Whether the body is outside of the cylinder.
    name
        For messages.

    Raises
    ------
    ValueError
        A radius that is not positive, or ends that coincide or are no finite (x, y, z).

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import rigid_cylinder
    >>> bool(abs(rigid_cylinder((0., 0., 0.), (0., 0., 3.), 1.).area.sum() / (6 * np.pi) - 1) < 1e-6)
    True
    """
    _check(name, radius=radius)
    start, end = _place(name, start), _place(name, end)
    axes, length = _axes(name, end - start), float(np.linalg.norm(end - start))

    def around(u: ndarray, v: ndarray) -> ndarray:
        return start + np.stack((radius * np.cos(u), radius * np.sin(u), v), axis=1) @ axes

    rows = max(1, round(length / radius * _QUARTER / (np.pi / 2)))
    points, facets = _joined([_patch(around, (0.0, 2 * np.pi), (0.0, length), 4 * _QUARTER, rows)])
    return _surface(name, points, facets, Shape.of_facets(ElementHex2()),
                    lambda x: ((x - start) - np.outer((x - start) @ axes[2], axes[2])) * (-1.0 if hole else 1.0))


def rigid_cone(apex: ArrayLike, axis: ArrayLike, slope: float, radius: float, name: str = "obstacle") -> Surface:
    """A rigid cone; its free side is the one that the apex points to.

    Parameters
    ----------
    apex
        Its tip, (x, y, z).
    axis
        Direction from the tip into the cone.
    slope
        Height over radius: the tangent of the angle between its side and the plane across its axis.
    radius
        Largest radius.
    name
        For messages.

    Raises
    ------
    ValueError
        A slope or radius that is not positive, an axis without direction, or an apex that is no finite (x, y, z).

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import rigid_cone
    >>> cone = rigid_cone((0., 0., 0.), (0., 0., 1.), slope=.1, radius=2.)
    >>> bool(abs(cone.area.sum() / (4 * np.pi * np.sqrt(1.01)) - 1) < 1e-5)
    True
    """
    _check(name, slope=slope, radius=radius)
    axes, tip = _axes(name, axis), _place(name, apex)
    n = 4 * _QUARTER

    def place(angle: ndarray, r: ndarray) -> ndarray:
        angle = angle * 2 * np.pi / n
        return tip + np.stack((r * np.cos(angle), r * np.sin(angle), slope * r), axis=2) @ axes

    # triangles of six nodes in the plane of angle and radius: one up to the tip, two on each piece of a ring
    inner, outer = np.array([(.5, 0), (1, 1), (0, 1)]), np.array([(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)])
    rings = np.concatenate([inner[None], *(outer.reshape(2, 3, 2) + np.array([0, k]) for k in range(1, _QUARTER))])
    corners = (rings[:, None] + np.stack((np.arange(n), np.zeros(n)), axis=1)[:, None]).reshape(-1, 3, 2)
    nodes = np.concatenate((corners, 0.5 * (corners + np.roll(corners, -1, axis=1))), axis=1)
    at_tip = nodes[:, 0, 1] == 0.0  # its sides are rays, at the angles of their ends
    nodes[at_tip, 3, 0], nodes[at_tip, 5, 0] = nodes[at_tip, 1, 0], nodes[at_tip, 2, 0]
    places = place(nodes[..., 0], nodes[..., 1] * radius / _QUARTER)
    points, facets = _joined([(places.reshape(-1, 3), np.arange(places[..., 0].size).reshape(-1, 6))])
    return _surface(name, points, facets, Shape.of_facets(ElementTetP2()), lambda x: np.tile(-axes[2], (len(x), 1)))


def rigid_surface(mesh: Mesh, boundary: str, name: str | None = None) -> Surface:
    """A rigid body with the shape of a named boundary of a mesh in space.

    Parameters
    ----------
    mesh
        A mesh of tetrahedra or hexahedra, of first order; the rigid body is where its elements are.
    boundary
        Name of the boundary.
    name
        For messages; by default that of the boundary.

    Raises
    ------
    ValueError
        There is no such boundary, or it is no surface.

    Examples
    --------
    >>> from skfem import MeshHex
    >>> from skfem_contact import rigid_surface
    >>> len(rigid_surface(MeshHex().refined(1).with_defaults(), "top").facets)
    4
    """
    look_up(boundary, mesh.boundaries or {}, "boundary")
    element = ElementTetP1() if isinstance(mesh, MeshTet) else ElementHex1()
    found = Surface.from_boundary(Basis(mesh, ElementVector(element), intorder=1), boundary)
    return Surface.of(name or boundary, np.full(found.dofs.shape, -1), found.nodes, found.facets, found.shape,
                      found.neighbours)


def _patch(function: Callable[[ndarray, ndarray], ndarray], u: tuple[float, float], v: tuple[float, float], rows: int,
           columns: int) -> tuple[ndarray, ndarray]:
    """Points (n, 3) and facets of nine nodes on a map of a rectangle of parameters."""
    mesh = MeshQuad2.from_mesh(MeshQuad1.init_tensor(np.linspace(*u, rows + 1), np.linspace(*v, columns + 1)))
    return function(*mesh.doflocs), mesh.dofs.element_dofs.T


def _joined(patches: list[tuple[ndarray, ndarray]]) -> tuple[ndarray, ndarray]:
    """Patches as one: points that coincide become one."""
    points = np.concatenate([part[0] for part in patches])
    starts = np.cumsum([0] + [len(part[0]) for part in patches])
    facets = np.concatenate([part[1] + start for part, start in zip(patches, starts[:-1], strict=True)])
    rounded = np.round(points / (_SAME * np.ptp(points, axis=0).max()))
    _, first, number = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    return points[first], number.ravel()[facets]


def _surface(name: str, points: ndarray, facets: ndarray, shape: Shape,
             outward: Callable[[ndarray], ndarray] | None = None) -> Surface:
    """A rigid surface whose facets are turned so that their normals agree with an outward direction."""
    corners = len(shape.corners)
    if outward is not None:
        normal = across(points[facets[:, [1, corners - 1]]] - points[facets[:, [0]]])
        wrong = dot(normal, outward(points[facets[:, :corners]].mean(axis=1))) < 0
        facets = np.where(wrong[:, None], facets[:, _mirror(shape)], facets)
    return Surface.of(name, np.full(points.shape, -1), points, facets, shape, adjacent(facets[:, :corners], name))


def _mirror(shape: Shape) -> ndarray:
    """Numbers of the nodes of a facet that is gone around the other way."""
    mirrored = shape.nodes[:, ::-1]  # the two local coordinates change places
    return np.argmin(np.abs(mirrored[:, None] - shape.nodes).sum(axis=2), axis=1)


def _axes(name: str, direction: ArrayLike) -> ndarray:
    """Three axes, the rows of (3, 3), of which the last has a direction."""
    last = _place(name, direction)
    if not last.any():
        raise ValueError(f"'{name}': a direction must have a length, unlike {direction!r}")
    last = last / np.linalg.norm(last)
    first = unit((np.eye(3) - np.outer(last, last))[[np.argmin(np.abs(last))]])[0]
    return np.stack((first, np.cross(last, first), last))


def _place(name: str, point: ArrayLike) -> ndarray:
    place = np.asarray(point, float)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise ValueError(f"'{name}': a place or direction must be a finite (x, y, z), not {point!r}")
    return place


def _check(name: str, **lengths: float) -> None:
    for what, value in lengths.items():
        if not 0 < value < np.inf:
            raise ValueError(f"'{name}': the {what} must be positive, not {value!r}")
