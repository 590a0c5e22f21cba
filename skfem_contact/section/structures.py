"""Sections of structures in level ground, y = 0, from a few numbers each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy import ndarray

from ..checks import finite, positive
from .earthworks import Layers, chosen, layers, merged
from .outline import Outline, circle, rectangle
from .section import Section


def trench(
    width: float,
    depth: float,
    bottoms: Layers,
    size: float,
    *,
    outer: float | Sequence[float],
    thickness: float,
    bedding: float | None = None,
    beyond: float | None = None,
    **more: Any,
) -> Section:
    """Return a trench that is filled over a pipe or a box: areas ``"backfill"`` and ``"pipe"``, a
    body.

    Parameters
    ----------
    width, depth
        Width and depth of the trench, whose middle is at x = 0.
    bottoms
        Layers, see :func:`layers`.
    size
        Size of elements.
    outer
        Outer diameter of a pipe, or outer width and height of a box.
    thickness
        Thickness of its walls; its inside is the hole ``"inside"``.
    bedding
        Height of the backfill below it; by default a tenth of the depth.
    beyond
        Ground on both sides of the trench; by default three times its depth.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.trench(2., 4., {"clay": -9.}, size=1.5, outer=1.2, thickness=.1)
    <Section areas: clay, backfill, pipe; holes: inside>
    """
    half = 0.5 * positive(width, "width")
    floor = chosen(bedding, "bedding", 0.1 * depth) - positive(depth, "depth")
    right = half + chosen(beyond, "beyond", 3.0 * depth)
    if np.ndim(outer):
        wide, high = finite(outer, "outer")
        shell = rectangle((-wide / 2, wide / 2), (floor, floor + high))
        inside = rectangle(
            (thickness - wide / 2, wide / 2 - thickness),
            (floor + thickness, floor + high - thickness),
        )
    else:
        radius = 0.5 * float(np.asarray(outer))
        shell, inside = (circle((0.0, floor + radius), r) for r in (radius, radius - thickness))
    areas = {
        **layers((-right, right), 0.0, bottoms),
        "backfill": rectangle((-half, half), (-depth, 0.0)),
        "pipe": shell,
    }
    options: dict[str, Any] = {
        "replace": ["backfill", "pipe"],
        "bodies": "pipe",
        "holes": {"inside": inside},
        "sizes": {"pipe": max(2.0 * thickness, size / 10.0)},
    }
    return Section(areas, size, **merged(options, more))


def three_centres(
    crown: float, side: float, angles: Sequence[float], centre: Sequence[float] = (0.0, 0.0)
) -> Outline:
    """Return the outline of a tunnel of three radii, which meet without kinks.

    Parameters
    ----------
    crown, side
        Radii of the crown and of the sides. That of the invert follows.
    angles
        Half of the angle of the crown, and angle of a side, in degrees.
    centre
        Centre of the crown.

    Examples
    --------
    Equal radii make a circle:

    >>> import skfem_contact as sc
    >>> f"{sc.section.three_centres(2., 2., (60., 80.)).area / 4:.6f}"
    '3.141593'
    """
    first, second = np.radians(finite(angles, "angles"))
    total = first + second
    if not 0.0 < first < total < np.pi:
        raise ValueError(f"angles are positive and below 180 degrees together, not {angles!r}")
    towards: list[ndarray] = [np.array([np.sin(a), np.cos(a)]) for a in (first, total)]
    joint = np.asarray(centre) + crown * towards[0]
    low = joint + side * (towards[1] - towards[0])
    mirror = (2.0 * centre[0], 0.0)
    across = np.array([-1.0, 1.0])
    points = [joint, across * joint + mirror, across * low + mirror, low]  # anticlockwise
    turns = np.array([2.0 * first, second, 2.0 * (np.pi - total), second])
    return Outline(points, np.tan(turns / 4.0))


def tunnel(
    outline: Outline,
    bottoms: Layers,
    size: float,
    *,
    width: float,
    fine: float | None = None,
    **more: Any,
) -> Section:
    """Return a tunnel in level ground: the lift ``"core"``, and the line ``"lining"`` round it.

    Parameters
    ----------
    outline
        Outline of the tunnel: :func:`circle` or :func:`three_centres`.
    bottoms
        Layers, see :func:`layers`.
    size, fine
        Size of elements, and that along the lining; by default a quarter of it.
    width
        Width of the ground, whose middle is at x = 0.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.tunnel(sc.section.circle((0., -12.), 3.), {"clay": -25.}, size=4., width=50.)
    <Section areas: clay; lifts: core; lines: lining>
    """
    right = 0.5 * positive(width, "width")
    options: dict[str, Any] = {
        "lifts": {"core": outline},
        "lines": {"lining": outline},
        "sizes": {"lining": chosen(fine, "fine", size / 4.0)},
    }
    return Section(layers((-right, right), 0.0, bottoms), size, **merged(options, more))


def footing(
    width: float,
    thickness: float,
    bottoms: Layers,
    size: float,
    *,
    depth: float = 0.0,
    beyond: float | None = None,
    fine: float | None = None,
    **more: Any,
) -> Section:
    """Return a footing with its middle at x = 0, a body.

    Parameters
    ----------
    width, thickness
        Its width and thickness.
    bottoms
        Layers, see :func:`layers`.
    size, fine
        Size of elements, and that of the footing; by default a tenth of its width.
    depth
        Depth of its base below the surface.
    beyond
        Ground on both sides; by default three times the width.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.footing(2., .5, {"clay": -6.}, size=2.)
    <Section areas: clay, footing>
    """
    half = 0.5 * positive(width, "width")
    right = half + chosen(beyond, "beyond", 3.0 * width)
    areas = {
        **layers((-right, right), 0.0, bottoms),
        "footing": rectangle((-half, half), (-depth, positive(thickness, "thickness") - depth)),
    }
    options: dict[str, Any] = {
        "bodies": "footing",
        "replace": "footing",
        "sizes": {"footing": chosen(fine, "fine", width / 10.0)},
    }
    return Section(areas, size, **merged(options, more))


def retaining_wall(
    height: float,
    base: float,
    bottoms: Layers,
    size: float,
    *,
    stem: float,
    slab: float,
    toe: float,
    depth: float,
    beyond: float | None = None,
    fine: float | None = None,
    **more: Any,
) -> Section:
    """Return a cantilever wall, a body, with the area ``"backfill"`` behind it, on its right.

    Parameters
    ----------
    height
        Height of the backfill above the ground in front, y = 0.
    base
        Width of the base slab.
    bottoms
        Layers, see :func:`layers`.
    size, fine
        Size of elements, and that of the wall; by default the thickness of the stem.
    stem, slab
        Thickness of the stem and of the slab.
    toe
        Length of the slab before the stem, whose front is at x = 0.
    depth
        Depth of the base below the ground in front.
    beyond
        Ground on both sides of the slab; by default three times the height of the wall.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.retaining_wall(4., 3., {"sand": -6.}, size=2., stem=.4, slab=.5, toe=.6, depth=1.)
    <Section areas: sand, backfill, wall>
    """
    heel, free = base - toe, chosen(beyond, "beyond", 3.0 * (height + depth))
    left, right = -toe - free, heel + free
    wall = [
        (-toe, -depth),
        (heel, -depth),
        (heel, slab - depth),
        (stem, slab - depth),
        (stem, height),
        (0.0, height),
        (0.0, slab - depth),
        (-toe, slab - depth),
    ]
    filled = [(0.0, -depth), (right, -depth), (right, height), (0.0, height)]
    areas = {**layers((left, right), 0.0, bottoms), "backfill": filled, "wall": wall}
    options: dict[str, Any] = {
        "bodies": "wall",
        "replace": ["backfill", "wall"],
        "sizes": {"wall": chosen(fine, "fine", stem)},
    }
    return Section(areas, size, **merged(options, more))


def pile(
    diameter: float,
    length: float,
    bottoms: Layers,
    size: float,
    *,
    radius: float | None = None,
    fine: float | None = None,
    **more: Any,
) -> Section:
    """Return a pile in a cylinder of ground, axisymmetric; the pile is a body.

    Parameters
    ----------
    diameter, length
        Those of the pile.
    bottoms
        Layers, see :func:`layers`.
    size, fine
        Size of elements, and that of the pile; by default half of its diameter.
    radius
        Radius of the ground; by default the length of the pile.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.pile(.6, 10., {"clay": -15.}, size=3.).coordinates
    'axisymmetric'
    """
    areas = {
        **layers((0.0, chosen(radius, "radius", positive(length, "length"))), 0.0, bottoms),
        "pile": rectangle((0.0, 0.5 * positive(diameter, "diameter")), (-length, 0.0)),
    }
    options: dict[str, Any] = {
        "bodies": "pile",
        "replace": "pile",
        "coordinates": "axisymmetric",
        "sizes": {"pile": chosen(fine, "fine", 0.5 * diameter)},
    }
    return Section(areas, size, **merged(options, more))
