"""Rigid obstacles: lines, circles and level sets in the plane; planes, spheres, cylinders, cones
and meshes in space.

Every function takes a `name`, which messages use.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from contourpy import contour_generator
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementTetP1,
    ElementTetP2,
    ElementTriP1,
    ElementVector,
    MeshHex,
    MeshQuad1,
    MeshQuad2,
    MeshTet,
)

from ..checks import is_number, look_up
from .shape import Shape
from .smoothing import smoothed
from .surface import Surface
from .topology import adjacent, following
from .vectors import across, dot, unit

__all__ = ["circle", "cone", "cylinder", "level_set", "line", "mesh", "plane", "polyline", "sphere"]

_FACETS = (
    360  # of a circle: once smoothed it is round to (1 - cos(pi/360))^2 / 2 = 7e-10 of its radius
)
#: Facets on a quarter of a circle in space: they are round to 1e-6 of the radius.
_QUARTER = 12
#: Nodes nearer to each other than this share of the surface are one.
_SAME = 1e-6


def line(start: tuple[float, float], end: tuple[float, float], name: str = "obstacle") -> Surface:
    """Return a rigid straight line; its free side lies to the left of the way from start, (x, y),
    to end.

    Examples
    --------
    >>> from skfem_contact import rigid
    >>> round(float(rigid.line((-1., 0.), (1., 0.)).area.sum()), 12)      # the free side is above
    2.0
    """
    return polyline(np.array([start, end]), name=name)


def polyline(points: ndarray, closed: bool = False, name: str = "obstacle") -> Surface:
    """Return a rigid chain of straight lines; the body lies to the right of its direction.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Corners.
    closed : bool
        True if the last corner is joined to the first.

    Examples
    --------
    >>> from skfem_contact import rigid
    >>> rigid.polyline([[5., 0.], [-5., 0.]]).area.tolist()    # the free side is below
    [10.0]
    """
    points = np.asarray(points, float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or not np.isfinite(points).all():
        raise ValueError(f"'{name}': points must be two or more finite (x, y)")
    n = len(points)
    first = np.arange(n if closed else n - 1)
    facets = np.column_stack((first, (first + 1) % n))
    if (points[facets[:, 0]] == points[facets[:, 1]]).all(axis=1).any():
        raise ValueError(f"'{name}': two corners that follow each other coincide")
    return Surface.of(
        name,
        np.full((n, 2), -1),
        points,
        facets,
        Shape.of_facets(ElementTriP1()),
        following(len(facets), closed),
    )


def circle(
    center: tuple[float, float], radius: float, hole: bool = False, name: str = "obstacle"
) -> Surface:
    """Return a rigid disc, or a round hole in a rigid body.

    Parameters
    ----------
    center, radius
        Centre (x, y) and radius.
    hole : bool
        True if the body is outside of the circle.

    Examples
    --------
    >>> from skfem_contact import rigid
    >>> round(float(rigid.circle((0., 0.), 2.).area.sum()), 3)      # 4 pi
    12.566
    """
    if not is_number(radius, 0.0, np.inf):
        raise ValueError(f"'{name}': the radius must be positive, not {radius!r}")
    angle = np.linspace(0, 2 * np.pi, _FACETS, endpoint=False)
    # the smoothed polygon touches the middles of its facets' rounded joints at radius * cos(pi/n):
    # scale that out
    size = radius / (0.5 * np.cos(np.pi / _FACETS) + 0.25 * (1.0 + np.cos(np.pi / _FACETS) ** 2))
    turn = 1.0 if hole else -1.0
    points = np.asarray(center) + size * np.column_stack((np.cos(angle), turn * np.sin(angle)))
    return smoothed(polyline(points, closed=True, name=name))


def level_set(
    function: Callable[[ndarray, ndarray], ndarray],
    bounds: tuple[float, float, float, float],
    resolution: int = 200,
    name: str = "obstacle",
) -> Surface:
    """Return a rigid body where a function is negative; its surface is the one zero line in a
    window.

    Parameters
    ----------
    function
        Vectorised ``f(x, y)``, negative inside the body.
    bounds
        Window ``(xmin, xmax, ymin, ymax)``.
    resolution : int
        Points of the grid in each direction; the zero line is then smoothed.

    Examples
    --------
    >>> from skfem_contact import rigid
    >>> rigid.level_set(lambda x, y: y - .1 * x**2, (-1., 1., -1., 1.)).closed
    False
    """
    xmin, xmax, ymin, ymax = bounds
    if not (xmin < xmax and ymin < ymax):
        raise ValueError(f"'{name}': a window has xmin < xmax and ymin < ymax, unlike {bounds}")
    if resolution < 2:
        raise ValueError(f"'{name}': the resolution must be at least 2, not {resolution}")
    x, y = np.linspace(xmin, xmax, resolution), np.linspace(ymin, ymax, resolution)
    X, Y = np.meshgrid(x, y)
    lines = contour_generator(X, Y, function(X, Y)).lines(0.0)
    if len(lines) != 1:
        raise ValueError(
            f"'{name}': the function has {len(lines)} zero lines in the window, not one"
        )
    points = np.asarray(lines[0])
    closed = bool(np.allclose(points[0], points[-1]))
    points = points[:-1] if closed else points
    spacing = np.linalg.norm(np.diff(points, axis=0), axis=1)
    points = points[np.concatenate(([True], spacing > 1e-6 * spacing.max()))]
    middle = 0.5 * (points[0] + points[1])
    side = np.array([-1.0, 1.0]) * (points[1] - points[0])[::-1] * 1e-3
    left = middle + side
    if function(left[0], left[1]) < 0:  # the body must lie to the right
        points = points[::-1]
    return smoothed(polyline(points, closed=closed, name=name))


def plane(point: ArrayLike, normal: ArrayLike, width: float, name: str = "obstacle") -> Surface:
    """Return a rigid square of a plane.

    Parameters
    ----------
    point, normal, width
        Middle, (x, y, z), direction of the free side and length of the sides.

    Examples
    --------
    >>> from skfem_contact import rigid
    >>> round(float(rigid.plane((0., 0., 0.), (0., 0., 1.), width=4.).area.sum()), 12)
    16.0
    """
    _check(name, width=width)
    axes = _axes(name, normal)
    middle = _point(name, point)
    corners = 0.5 * width * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return _surface(
        name, middle + corners @ axes[:2], np.arange(4)[None], Shape.of_facets(ElementHex1())
    )


def sphere(center: ArrayLike, radius: float, hole: bool = False, name: str = "obstacle") -> Surface:
    """Return a rigid ball, or a round hole in a rigid body.

    Parameters
    ----------
    center, radius
        Centre (x, y, z) and radius.
    hole : bool
        True if the body is outside of the sphere.

    Examples
    --------
    >>> from skfem_contact import rigid
    >>> round(float(rigid.sphere((0., 0., 0.), 2.).area.sum()), 3)      # 16 pi
    50.265
    """
    _check(name, radius=radius)
    sides = []
    for axis in range(3):
        for side in (-1.0, 1.0):

            def on_cube(u: ndarray, v: ndarray, axis: int = axis, side: float = side) -> ndarray:
                x = np.stack((np.tan(u), np.tan(v), np.full_like(u, side)), axis=1)
                return unit(np.roll(x, axis + 1, axis=1))

            sides.append(
                _patch(
                    on_cube, (-np.pi / 4, np.pi / 4), (-np.pi / 4, np.pi / 4), _QUARTER, _QUARTER
                )
            )
    points, facets = _joined(sides)
    corners = points[
        facets[:, :4]
    ]  # in the middle of an arc, and of all four: round to the fourth order of the size
    points[facets[:, 4:8]] = unit(corners + np.roll(corners, -1, axis=1))
    points[facets[:, 8]] = unit(corners.sum(axis=1))
    return _surface(
        name,
        _point(name, center) + radius * points,
        facets,
        Shape.of_facets(ElementHex2()),
        lambda x: (x - _point(name, center)) * (-1.0 if hole else 1.0),
    )


def cylinder(
    start: ArrayLike, end: ArrayLike, radius: float, hole: bool = False, name: str = "obstacle"
) -> Surface:
    """Return the round side of a rigid cylinder, or of a round hole in a rigid body.

    Parameters
    ----------
    start, end, radius
        Ends of its axis, (x, y, z), and radius.
    hole : bool
        True if the body is outside of the cylinder.

    Examples
    --------
    >>> from skfem_contact import rigid
    >>> round(float(rigid.cylinder((0., 0., 0.), (0., 0., 3.), 1.).area.sum()), 4)      # 6 pi
    18.8496
    """
    _check(name, radius=radius)
    start, end = _point(name, start), _point(name, end)
    axes, length = _axes(name, end - start), float(np.linalg.norm(end - start))

    def around(u: ndarray, v: ndarray) -> ndarray:
        return start + np.stack((radius * np.cos(u), radius * np.sin(u), v), axis=1) @ axes

    rows = max(1, round(length / radius * _QUARTER / (np.pi / 2)))
    points, facets = _joined([_patch(around, (0.0, 2 * np.pi), (0.0, length), 4 * _QUARTER, rows)])
    return _surface(
        name,
        points,
        facets,
        Shape.of_facets(ElementHex2()),
        lambda x: (
            ((x - start) - np.outer((x - start) @ axes[2], axes[2])) * (-1.0 if hole else 1.0)
        ),
    )


def cone(
    apex: ArrayLike, axis: ArrayLike, slope: float, radius: float, name: str = "obstacle"
) -> Surface:
    """Return a rigid cone; its free side is the one that the apex points to.

    Parameters
    ----------
    apex, axis : array_like, shape (3,)
        Its tip, and the direction from there into the body.
    slope : float
        Height over radius: the tangent of the angle between its side and the plane across its axis.
    radius : float
        Largest radius.

    Examples
    --------
    >>> from skfem_contact import rigid
    >>> round(float(rigid.cone((0., 0., 0.), (0., 0., 1.), slope=.1, radius=2.).area.sum()), 3)
    12.629
    """
    _check(name, slope=slope, radius=radius)
    axes, tip = _axes(name, axis), _point(name, apex)
    n = 4 * _QUARTER

    def on_cone(angle: ndarray, r: ndarray) -> ndarray:
        angle = angle * 2 * np.pi / n
        return tip + np.stack((r * np.cos(angle), r * np.sin(angle), slope * r), axis=2) @ axes

    # triangles of six nodes in the plane of angle and radius: one up to the tip, two on each piece
    # of a ring
    inner, outer = (
        np.array([(0.5, 0), (1, 1), (0, 1)]),
        np.array([(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)]),
    )
    rings = np.concatenate(
        [inner[None], *(outer.reshape(2, 3, 2) + np.array([0, k]) for k in range(1, _QUARTER))]
    )
    corners = (rings[:, None] + np.stack((np.arange(n), np.zeros(n)), axis=1)[:, None]).reshape(
        -1, 3, 2
    )
    nodes = np.concatenate((corners, 0.5 * (corners + np.roll(corners, -1, axis=1))), axis=1)
    at_tip = nodes[:, 0, 1] == 0.0  # its sides are rays, at the angles of their ends
    nodes[at_tip, 3, 0], nodes[at_tip, 5, 0] = nodes[at_tip, 1, 0], nodes[at_tip, 2, 0]
    x = on_cone(nodes[..., 0], nodes[..., 1] * radius / _QUARTER)
    points, facets = _joined([(x.reshape(-1, 3), np.arange(x[..., 0].size).reshape(-1, 6))])
    return _surface(
        name,
        points,
        facets,
        Shape.of_facets(ElementTetP2()),
        lambda x: np.tile(-axes[2], (len(x), 1)),
    )


def mesh(mesh: MeshTet | MeshHex, boundary: str, name: str | None = None) -> Surface:
    """Return a rigid body with the shape of a named boundary of a mesh in space.

    Parameters
    ----------
    mesh : Mesh
        Mesh of tetrahedra or hexahedra, of first order; the rigid body is where its elements are.
    boundary : str
        Name of the boundary.

    Examples
    --------
    >>> from skfem import MeshHex
    >>> from skfem_contact import rigid
    >>> len(rigid.mesh(MeshHex().refined(1).with_defaults(), "top").facets)
    4
    """
    look_up(boundary, mesh.boundaries or {}, "boundary")
    element = ElementTetP1() if isinstance(mesh, MeshTet) else ElementHex1()
    found = Surface.from_boundary(Basis(mesh, ElementVector(element), intorder=1), boundary)
    return Surface.of(
        name or boundary,
        np.full(found.dofs.shape, -1),
        found.nodes,
        found.facets,
        found.shape,
        found.neighbours,
    )


def _patch(
    function: Callable[[ndarray, ndarray], ndarray],
    u: tuple[float, float],
    v: tuple[float, float],
    rows: int,
    columns: int,
) -> tuple[ndarray, ndarray]:
    """Return points, shape (n, 3), and facets of nine nodes on a map of a rectangle of
    parameters.
    """
    quads = MeshQuad2.from_mesh(
        MeshQuad1.init_tensor(np.linspace(*u, rows + 1), np.linspace(*v, columns + 1))
    )
    return function(*quads.doflocs), quads.dofs.element_dofs.T


def _joined(patches: list[tuple[ndarray, ndarray]]) -> tuple[ndarray, ndarray]:
    points = np.concatenate([part[0] for part in patches])
    starts = np.cumsum([0] + [len(part[0]) for part in patches])
    facets = np.concatenate(
        [part[1] + start for part, start in zip(patches, starts[:-1], strict=True)]
    )
    rounded = np.round(points / (_SAME * np.ptp(points, axis=0).max()))
    _, first, number = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    return points[first], number.ravel()[facets]


def _surface(
    name: str,
    points: ndarray,
    facets: ndarray,
    shape: Shape,
    outward: Callable[[ndarray], ndarray] | None = None,
) -> Surface:
    """Return a rigid surface with facets turned so that their normals agree with an outward
    direction.
    """
    corners = len(shape.corners)
    if outward is not None:
        normal = across(points[facets[:, [1, corners - 1]]] - points[facets[:, [0]]])
        wrong = dot(normal, outward(points[facets[:, :corners]].mean(axis=1))) < 0
        mirrored = shape.nodes[:, ::-1]  # the two local coordinates are exchanged
        mirror = np.argmin(np.abs(mirrored[:, None] - shape.nodes).sum(axis=2), axis=1)
        facets = np.where(wrong[:, None], facets[:, mirror], facets)
    return Surface.of(
        name, np.full(points.shape, -1), points, facets, shape, adjacent(facets[:, :corners], name)
    )


def _axes(name: str, direction: ArrayLike) -> ndarray:
    """Return three axes, the rows of an array of shape (3, 3), of which the last has a
    direction.
    """
    last = _point(name, direction)
    if not last.any():
        raise ValueError(f"'{name}': a direction must have a length, unlike {direction!r}")
    last = last / np.linalg.norm(last)
    first = unit((np.eye(3) - np.outer(last, last))[[np.argmin(np.abs(last))]])[0]
    return np.stack((first, np.cross(last, first), last))


def _point(name: str, point: ArrayLike) -> ndarray:
    x = np.asarray(point, float)
    if x.shape != (3,) or not np.isfinite(x).all():
        raise ValueError(
            f"'{name}': a point or direction must be a finite (x, y, z), not {point!r}"
        )
    return x


def _check(name: str, **lengths: float) -> None:
    for what, value in lengths.items():
        if not 0 < value < np.inf:
            raise ValueError(f"'{name}': the {what} must be positive, not {value!r}")
