"""Rigid obstacles: surfaces that no unknown moves."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy import ndarray
from skfem import ElementTriP1

from ..errors import is_number
from .shape import Shape
from .smoothing import smoothed
from .surface import Surface
from .topology import following

_FACETS = 360  # of a circle: once smoothed it is round to (1 - cos(pi/360))^2 / 2 = 7e-10 of its radius


def rigid_polyline(points: ndarray, closed: bool = False, name: str = "obstacle") -> Surface:
    """A rigid chain of straight lines; the body lies to the right of its direction.

    Parameters
    ----------
    points
        Corners, (n, 2).
    closed
        Whether the last corner is joined to the first.
    name
        For messages.

    Raises
    ------
    ValueError
        Fewer than two corners, corners that are no finite (x, y), or two that follow each other and coincide.

    Examples
    --------
    >>> from skfem_contact import rigid_polyline
    >>> floor = rigid_polyline([[5., 0.], [-5., 0.]])    # the free side is below
    >>> round(float(floor.area.sum()), 12)
    10.0
    """
    points = np.asarray(points, float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or not np.isfinite(points).all():
        raise ValueError(f"'{name}': points must be two or more finite (x, y)")
    n = len(points)
    first = np.arange(n if closed else n - 1)
    facets = np.column_stack((first, (first + 1) % n))
    if (points[facets[:, 0]] == points[facets[:, 1]]).all(axis=1).any():
        raise ValueError(f"'{name}': two corners that follow each other coincide")
    return Surface.of(name, np.full((n, 2), -1), points, facets, Shape.of_facets(ElementTriP1()),
                      following(len(facets), closed))


def rigid_line(start: tuple[float, float], end: tuple[float, float], name: str = "obstacle") -> Surface:
    """A rigid straight line; its free side lies to the left of the way from start to end.

    Parameters
    ----------
    start, end
        Its ends, (x, y).
    name
        For messages.

    Raises
    ------
    ValueError
        Ends that coincide or are no finite (x, y).

    Examples
    --------
    >>> from skfem_contact import rigid_line
    >>> round(float(rigid_line((-1., 0.), (1., 0.)).area.sum()), 12)      # the free side is above
    2.0
    """
    return rigid_polyline(np.array([start, end]), name=name)


def rigid_circle(center: tuple[float, float], radius: float, hole: bool = False, name: str = "obstacle") -> Surface:
    """A rigid disc, or a round hole in a rigid body.

    Parameters
    ----------
    center, radius
        Centre and radius, in units of length.
    hole
        Whether the body is outside of the circle.
    name
        For messages.

    Raises
    ------
    ValueError
        A radius that is not positive, or a centre that is no finite (x, y).

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import rigid_circle
    >>> drum = rigid_circle((0., 0.), 2.)
    >>> bool(abs(drum.area.sum() - 4 * np.pi) < 1e-3)
    True
    """
    if not is_number(radius, 0.0, np.inf):
        raise ValueError(f"'{name}': the radius must be positive, not {radius!r}")
    angle = np.linspace(0, 2 * np.pi, _FACETS, endpoint=False)
    # the smoothed polygon touches the middles of its facets' rounded joints at radius * cos(pi/n): scale that out
    size = radius / (0.5 * np.cos(np.pi / _FACETS) + 0.25 * (1.0 + np.cos(np.pi / _FACETS) ** 2))
    turn = 1.0 if hole else -1.0
    points = np.asarray(center) + size * np.column_stack((np.cos(angle), turn * np.sin(angle)))
    return smoothed(rigid_polyline(points, closed=True, name=name))


def rigid_level_set(function: Callable[[ndarray, ndarray], ndarray], bounds: tuple[float, float, float, float],
                    resolution: int = 200, name: str = "obstacle") -> Surface:
    """A rigid body where a function is negative; its surface is the one zero line in a window.

    Parameters
    ----------
    function
        Vectorised ``f(x, y)``, negative inside the body.
    bounds
        Window ``(xmin, xmax, ymin, ymax)`` to look in.
    resolution
        Points of the grid in each direction; the zero line is then smoothed.
    name
        For messages.

    Raises
    ------
    ValueError
        A window that is none, no zero line in it, or more than one.

    Examples
    --------
    >>> from skfem_contact import rigid_level_set
    >>> dune = rigid_level_set(lambda x, y: y - .1 * x**2, (-1., 1., -1., 1.))
    >>> dune.closed
    False
    """
    from contourpy import contour_generator

    xmin, xmax, ymin, ymax = bounds
    if not (xmin < xmax and ymin < ymax):
        raise ValueError(f"'{name}': a window has xmin < xmax and ymin < ymax, unlike {bounds}")
    x, y = np.linspace(xmin, xmax, resolution), np.linspace(ymin, ymax, resolution)
    X, Y = np.meshgrid(x, y)
    lines = contour_generator(X, Y, function(X, Y)).lines(0.0)
    if len(lines) != 1:
        raise ValueError(f"'{name}': the function has {len(lines)} zero lines in the window, not one")
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
    return smoothed(rigid_polyline(points, closed=closed, name=name))
