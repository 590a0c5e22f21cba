"""Sections of structures in level ground: pipes, tunnels, footings, walls and piles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy import ndarray

from ...checks import positive, vector
from ..outline import Outline, circle, rectangle
from ..section import Section
from .builder import Layers, chosen, in_layers


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
    """Return a filled trench with a pipe or a box: areas ``"backfill"`` and ``"pipe"``, a body.

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
    # Find the floor of the trench and the edge of the ground.
    half = 0.5 * positive(width, "width")
    floor = chosen(bedding, "bedding", 0.1 * depth) - positive(depth, "depth")
    right = half + chosen(beyond, "beyond", 3.0 * depth)
    # Draw a box of two sizes, or a pipe of a diameter.
    if np.ndim(outer):
        wide, high = vector(outer, 2, "outer")
        shell = rectangle((-wide / 2, wide / 2), (floor, floor + high))
        inside = rectangle(
            (thickness - wide / 2, wide / 2 - thickness),
            (floor + thickness, floor + high - thickness),
        )
    else:
        radius = 0.5 * float(np.asarray(outer))
        centre = (0.0, floor + radius)
        shell = circle(centre, radius)
        inside = circle(centre, radius - thickness)
    return in_layers(
        (-right, right),
        bottoms,
        size=size,
        more=more,
        areas={"backfill": rectangle((-half, half), (-depth, 0.0)), "pipe": shell},
        replace=["backfill", "pipe"],
        bodies="pipe",
        holes={"inside": inside},
        sizes={"pipe": max(2.0 * thickness, size / 10.0)},
    )


def three_centres(
    crown: float,
    side: float,
    angles: Sequence[float],
    centre: Sequence[float] = (0.0, 0.0),
) -> Outline:
    """Return the outline of a tunnel of three radii, which meet without kinks.

    Parameters
    ----------
    crown, side
        Radii of the crown and of the sides. The radius of the invert follows.
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
    first, second = np.radians(vector(angles, 2, "angles"))
    middle = vector(centre, 2, "centre")
    total = first + second
    if not 0.0 < first < total < np.pi:
        raise ValueError(f"angles are positive and below 180 degrees together, not {angles!r}")
    # Right half: the arcs of crown and side meet in `upper`, the arcs of side and invert in `lower`
    at_upper: ndarray = np.array([np.sin(first), np.cos(first)])
    at_lower: ndarray = np.array([np.sin(total), np.cos(total)])
    upper = middle + crown * at_upper
    lower = upper + side * (at_lower - at_upper)

    # Mirror it about the middle, anticlockwise
    across = np.array([-1.0, 1.0])
    mirror = (2.0 * middle[0], 0.0)
    points = [upper, across * upper + mirror, across * lower + mirror, lower]
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
        Sizes of elements, and of elements along the lining; by default a quarter of the former.
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
    return in_layers(
        (-right, right),
        bottoms,
        size=size,
        more=more,
        lifts={"core": outline},
        lines={"lining": outline},
        sizes={"lining": chosen(fine, "fine", size / 4.0)},
    )


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
    """Return a footing with its middle at x = 0, a body: loads act on ``"footing:top"``.

    Parameters
    ----------
    width, thickness
        Its width and thickness.
    bottoms
        Layers, see :func:`layers`.
    size, fine
        Sizes of elements, and of elements of the footing; by default a tenth of its width.
    depth
        Depth of its base below the surface.
    beyond
        Ground on both sides; by default three times the width.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> section = sc.section.footing(2., .5, {"clay": -6.}, size=2.)
    >>> section
    <Section areas: clay, footing>
    >>> [name for name in section.mesh().boundaries if name.startswith("footing:")]
    ['footing:surface', 'footing:top', 'footing:sides']
    """
    half = 0.5 * positive(width, "width")
    right = half + chosen(beyond, "beyond", 3.0 * width)
    top = positive(thickness, "thickness") - depth
    return in_layers(
        (-right, right),
        bottoms,
        size=size,
        more=more,
        areas={"footing": rectangle((-half, half), (-depth, top))},
        bodies="footing",
        replace="footing",
        sizes={"footing": chosen(fine, "fine", width / 10.0)},
    )


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
        Sizes of elements, and of elements of the wall; by default the thickness of the stem.
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
    >>> wall = {"stem": .4, "slab": .5, "toe": .6, "depth": 1.}
    >>> sc.section.retaining_wall(4., 3., {"sand": -6.}, size=2., **wall)
    <Section areas: sand, backfill, wall>
    """
    # Find the edges of the ground, three heights beyond the heel and the toe.
    heel = base - toe
    free = chosen(beyond, "beyond", 3.0 * (height + depth))
    right = heel + free
    # Draw footing, stem and the ground behind.
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
    return in_layers(
        (-toe - free, right),
        bottoms,
        size=size,
        more=more,
        areas={"backfill": filled, "wall": wall},
        bodies="wall",
        replace=["backfill", "wall"],
        sizes={"wall": chosen(fine, "fine", stem)},
    )


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
        Diameter and length of the pile.
    bottoms
        Layers, see :func:`layers`.
    size, fine
        Sizes of elements, and of elements of the pile; by default half of its diameter.
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
    return in_layers(
        (0.0, chosen(radius, "radius", positive(length, "length"))),
        bottoms,
        size=size,
        more=more,
        areas={"pile": rectangle((0.0, 0.5 * positive(diameter, "diameter")), (-length, 0.0))},
        bodies="pile",
        replace="pile",
        coordinates="axisymmetric",
        sizes={"pile": chosen(fine, "fine", 0.5 * diameter)},
    )
