"""Rigid obstacles in the plane and in space.

In the plane they are lines, circles and level sets, in space planes, spheres, cylinders, cones and
meshes.  Every function takes a `name`, which messages use.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import (
    Basis,
    Element,
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

from ..arrays import row_norms
from ..checks import is_number
from .shape import Shape
from .smoothing import smoothed
from .surface import Surface
from .topology import adjacent, following
from .vectors import across, dot, unit

__all__ = ["circle", "cone", "cylinder", "level_set", "line", "mesh", "plane", "polyline", "sphere"]

#: Facets of a circle: smoothed, it is round to (1 - cos(pi/360))^2 / 2 = 7e-10 of its radius.
_FACETS = 360
#: Facets on a quarter of a circle in space: they are round to 1e-6 of the radius.
_QUARTER = 12
#: Nodes nearer to each other than this share of the surface are one.
_SAME = 1e-6


def line(start: tuple[float, float], end: tuple[float, float], name: str = "obstacle") -> Surface:
    """Return a rigid straight line; its free side lies to the left of its direction.

    Parameters
    ----------
    start, end
        Ends, (x, y).

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
    points = np.array(points, float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or not np.isfinite(points).all():
        raise ValueError(f"'{name}': points must be two or more finite (x, y)")
    # Each corner is followed by the next, the last by the first if closed.
    n = len(points)
    first = np.arange(n if closed else n - 1)
    second = (first + 1) % n
    facets = np.column_stack((first, second))
    if (points[first] == points[second]).all(axis=1).any():
        raise ValueError(f"'{name}': two corners that follow each other coincide")
    neighbours = following(len(facets), closed)
    return _rigid(name, points, facets, Shape.of_facets(ElementTriP1()), neighbours)


def circle(
    center: tuple[float, float],
    radius: float,
    hole: bool = False,
    name: str = "obstacle",
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
    # the smoothed polygon touches its facets' middles at size * cos and is round to the mean of
    # the radii there and at its joints: scale that out
    cosine = np.cos(np.pi / _FACETS)
    size = radius / (0.5 * cosine + 0.25 * (1.0 + cosine**2))
    angle = np.linspace(0, 2 * np.pi, _FACETS, endpoint=False)
    turn = -1.0
    if hole:
        turn = 1.0
    on_circle = np.column_stack((np.cos(angle), turn * np.sin(angle)))
    points = np.asarray(center) + size * on_circle
    return smoothed(polyline(points, closed=True, name=name))


def level_set(
    function: Callable[[ndarray, ndarray], ndarray],
    bounds: tuple[float, float, float, float],
    resolution: int = 200,
    name: str = "obstacle",
) -> Surface:
    """Return a rigid body where a function is negative, with its one zero line in a window.

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
    from contourpy import contour_generator  # few surfaces are curves of functions

    # trace the zero line on a grid
    x = np.linspace(xmin, xmax, resolution)
    y = np.linspace(ymin, ymax, resolution)
    X, Y = np.meshgrid(x, y)
    values = np.asarray(function(X, Y))
    if values.shape != X.shape or values.dtype.kind not in "biuf":
        raise ValueError(
            f"'{name}': the function of x and y, {X.shape}, must return numbers of that shape"
        )
    lines = contour_generator(X, Y, values).lines(0.0)
    if len(lines) != 1:
        raise ValueError(
            f"'{name}': the function has {len(lines)} zero lines in the window, not one"
        )
    points = np.asarray(lines[0])
    closed = bool(np.allclose(points[0], points[-1]))
    if closed:
        points = points[:-1]
    # merge points that coincide
    spacing = row_norms(np.diff(points, axis=0))
    points = points[np.concatenate(([True], spacing > 1e-6 * spacing.max()))]
    # turn the line so that the body lies to the right
    middle = 0.5 * (points[0] + points[1])
    along = points[1] - points[0]
    left = middle + np.array([-1.0, 1.0]) * along[::-1] * 1e-3
    if function(left[0], left[1]) < 0:
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
    # Corners counter-clockwise, seen against the normal.
    middle = _point(name, point)
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    corners = 0.5 * width * square
    points = middle + corners @ axes[:2]
    shape = Shape.of_facets(ElementHex1())
    facets = np.arange(4)[None]
    return _rigid(name, points, facets, shape, adjacent(facets, name))


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
    middle = _point(name, center)
    # project the six sides of a cube
    quarter = (-np.pi / 4, np.pi / 4)
    u, v, quads = _grid(quarter, quarter, _QUARTER, _QUARTER)
    sides = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            cube = np.stack((np.tan(u), np.tan(v), np.full_like(u, side)), axis=1)
            sides.append((unit(np.roll(cube, axis + 1, axis=1)), quads))
    points, facets = _joined(sides)
    # put the nodes of edges and facets in the middle of arcs: round to the fourth order of the size
    corners = points[facets[:, :4]]
    points[facets[:, 4:8]] = unit(corners + np.roll(corners, -1, axis=1))
    points[facets[:, 8]] = unit(corners.sum(axis=1))
    sign = 1.0
    if hole:
        sign = -1.0
    return _surface(
        name,
        middle + radius * points,
        facets=facets,
        element=ElementHex2(),
        outward=lambda x: (x - middle) * sign,
    )


def cylinder(
    start: ArrayLike,
    end: ArrayLike,
    radius: float,
    hole: bool = False,
    name: str = "obstacle",
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
    # Find the axis.
    _check(name, radius=radius)
    start = _point(name, start)
    end = _point(name, end)
    axes = _axes(name, end - start)
    length = float(np.linalg.norm(end - start))
    sign = 1.0
    if hole:
        sign = -1.0

    def outward(x: ndarray) -> ndarray:
        offset = x - start
        return (offset - np.outer(offset @ axes[2], axes[2])) * sign

    # Divide the side into quadrilaterals.
    rows = max(1, round(length / radius * _QUARTER / (np.pi / 2)))
    u, v, quads = _grid((0.0, 2 * np.pi), (0.0, length), 4 * _QUARTER, rows)
    local = np.stack((radius * np.cos(u), radius * np.sin(u), v), axis=1)
    x = start + local @ axes
    points, facets = _joined([(x, quads)])
    return _surface(name, points, facets=facets, element=ElementHex2(), outward=outward)


def cone(
    apex: ArrayLike,
    axis: ArrayLike,
    slope: float,
    radius: float,
    name: str = "obstacle",
) -> Surface:
    """Return a rigid cone; its free side is the one that the apex points to.

    Parameters
    ----------
    apex, axis : array_like, shape (3,)
        Its tip, and the direction from the tip into the body.
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
    axes = _axes(name, axis)
    tip = _point(name, apex)
    n = 4 * _QUARTER

    # corners of a sector's triangles as (angle, radius) in steps: one at the tip, two on each ring
    at_tip = [(0.5, 0), (1, 1), (0, 1)]
    triangles = [at_tip]
    for k in range(1, _QUARTER):
        triangles.append([(0, k), (1, k), (1, k + 1)])
        triangles.append([(0, k), (1, k + 1), (0, k + 1)])
    sector = np.array(triangles)  # (2 _QUARTER - 1, 3, 2)
    shift = np.stack((np.arange(n), np.zeros(n)), axis=1)  # (n, 2)
    corners = (sector[:, None] + shift[:, None]).reshape(-1, 3, 2)

    # add the middles; sides to the tip are rays, at the angles of their other ends
    following = np.roll(corners, -1, axis=1)
    middles = 0.5 * (corners + following)
    nodes = np.concatenate((corners, middles), axis=1)
    touches = nodes[:, 0, 1] == 0.0
    nodes[touches, 3, 0] = nodes[touches, 1, 0]
    nodes[touches, 5, 0] = nodes[touches, 2, 0]

    angle = nodes[..., 0] * 2 * np.pi / n
    r = nodes[..., 1] * radius / _QUARTER
    local = np.stack((r * np.cos(angle), r * np.sin(angle), slope * r), axis=2)  # (m, 6, 3)
    x = (tip + local @ axes).reshape(-1, 3)
    own = np.arange(len(x)).reshape(-1, 6)
    points, facets = _joined([(x, own)])
    return _surface(
        name,
        points,
        facets=facets,
        element=ElementTetP2(),
        outward=lambda x: np.tile(-axes[2], (len(x), 1)),
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
    if isinstance(mesh, MeshTet):
        element = ElementTetP1()
    else:
        element = ElementHex1()
    surface = Surface.from_boundary(Basis(mesh, ElementVector(element), intorder=1), boundary)
    return _rigid(
        name or boundary, surface.nodes, surface.facets, surface.shape, surface.neighbours
    )


def _grid(
    u: tuple[float, float],
    v: tuple[float, float],
    rows: int,
    columns: int,
) -> tuple[ndarray, ndarray, ndarray]:
    """Return parameters u and v, (n,), and facets of nine nodes, (m, 9), on a rectangle of them."""
    u_lines = np.linspace(*u, rows + 1)
    v_lines = np.linspace(*v, columns + 1)
    quads = MeshQuad2.from_mesh(MeshQuad1.init_tensor(u_lines, v_lines))
    return quads.doflocs[0], quads.doflocs[1], quads.dofs.element_dofs.T


def _joined(patches: list[tuple[ndarray, ndarray]]) -> tuple[ndarray, ndarray]:
    """Return points and facets of patches, with points that coincide merged."""
    numbered = []
    start = 0
    for x, facets in patches:
        numbered.append(facets + start)
        start += len(x)
    points = np.concatenate([x for x, _ in patches])
    facets = np.concatenate(numbered)
    # Merge points that agree in size.
    size = np.ptp(points, axis=0).max()
    rounded = np.round(points / (_SAME * size))
    _, first, number = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    return points[first], number.ravel()[facets]


def _surface(
    name: str,
    points: ndarray,
    facets: ndarray,
    element: Element,
    outward: Callable[[ndarray], ndarray],
) -> Surface:
    """Return a rigid surface with facets turned so that their normals point outward."""
    shape = Shape.of_facets(element)
    corners = len(shape.corners)
    x = points[facets[:, :corners]]  # (n_facets, corners, 3)
    normal = across(x[:, [1, -1]] - x[:, [0]])
    centre = x.mean(axis=1)
    wrong = dot(normal, outward(centre)) < 0
    # exchange the two local coordinates of facets on the wrong side
    mirrored = shape.nodes[:, ::-1]
    distance = np.abs(mirrored[:, None] - shape.nodes).sum(axis=2)
    mirror = np.argmin(distance, axis=1)
    facets = np.where(wrong[:, None], facets[:, mirror], facets)
    return _rigid(name, points, facets, shape, adjacent(facets[:, :corners], name))


def _rigid(
    name: str,
    points: ndarray,
    facets: ndarray,
    shape: Shape,
    neighbours: ndarray,
) -> Surface:
    """Return a surface of nodes that no dof moves."""
    return Surface.of(name, np.full(points.shape, -1), points, facets, shape, neighbours)


def _axes(name: str, direction: ArrayLike) -> ndarray:
    """Return three axes, the rows of an array of shape (3, 3), the last along a direction."""
    last = _point(name, direction)
    if not last.any():
        raise ValueError(f"'{name}': a direction must have a length, unlike {direction!r}")
    last = last / np.linalg.norm(last)
    # The axis that lies most across the direction comes first.
    across_last = np.eye(3) - np.outer(last, last)
    first = unit(across_last[[np.argmin(np.abs(last))]])[0]
    return np.stack((first, np.cross(last, first), last))


def _point(name: str, point: ArrayLike) -> ndarray:
    """Return a point or direction in space, (3,)."""
    x = np.asarray(point, float)
    if x.shape != (3,) or not np.isfinite(x).all():
        raise ValueError(
            f"'{name}': a point or direction must be a finite (x, y, z), not {point!r}"
        )
    return x


def _check(name: str, **lengths: float) -> None:
    """Refuse lengths that are not positive."""
    for what, value in lengths.items():
        if not 0 < value < np.inf:
            raise ValueError(f"'{name}': the {what} must be positive, not {value!r}")
