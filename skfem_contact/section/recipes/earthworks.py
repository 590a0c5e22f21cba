"""Sections of slopes, embankments and pits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...checks import finite, number, positive
from ..outline import rectangle
from ..section import Section
from .builder import Layers, chosen, in_layers


def slope(
    height: float,
    angle: float,
    bottoms: Layers,
    size: float,
    *,
    crest: float | None = None,
    toe: float | None = None,
    **more: Any,
) -> Section:
    """Return a slope that falls to the right from the height of its crest to 0.

    Parameters
    ----------
    height, angle
        Height, and angle in degrees.
    bottoms
        Layers, see :func:`layers`; the topmost one begins at the crest.
    size
        Size of elements.
    crest, toe
        Level ground behind the crest and before the toe; by default two heights each.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.slope(10., 26.6, {"fill": 0., "clay": -5.}, size=2.)
    <Section areas: fill, clay>
    """
    slope = np.tan(np.radians(number(angle, "angle", 0.0, 90.0)))
    run = positive(height, "height") / slope
    left = -chosen(crest, "crest", 2.0 * height)
    right = run + chosen(toe, "toe", 2.0 * height)
    surface = [(left, height), (0.0, height), (run, 0.0), (right, 0.0)]
    return in_layers((left, right), bottoms, size=size, more=more, top=height, surface=surface)


def embankment(
    height: float,
    crest: float,
    run: float,
    bottoms: Layers,
    size: float,
    *,
    lifts: int = 1,
    beyond: float | None = None,
    **more: Any,
) -> Section:
    """Return the right half of an embankment: area ``"fill"`` and lifts ``"lift 1"``, ...

    Parameters
    ----------
    height, crest
        Height, and half of the width of the crest.
    run
        Horizontal distance over the rise of its slope.
    bottoms
        Layers of the ground, see :func:`layers`.
    size
        Size of elements.
    lifts
        Number of lifts, which are numbered from the bottom.
    beyond
        Level ground before the toe; by default twice the half width of the base.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.embankment(4., 5., 2., {"clay": -8.}, size=2., lifts=2).parts
    {'remaining': ('clay',), 'lift 1': ('fill',), 'lift 2': ('fill',)}
    """
    # Compute the levels of the lifts, and half of their widths.
    base = positive(crest, "crest") + positive(run, "run") * positive(height, "height")
    levels = np.linspace(0.0, height, lifts + 1)
    widths = base - run * levels
    # Draw each lift as a trapezium.
    placed = {}
    for k in range(lifts):
        low, high = levels[k : k + 2]
        placed[f"lift {k + 1}"] = [
            (0.0, low),
            (widths[k], low),
            (widths[k + 1], high),
            (0.0, high),
        ]
    return in_layers(
        (0.0, base + chosen(beyond, "beyond", 2.0 * base)),
        bottoms,
        size=size,
        more=more,
        areas={"fill": [(0.0, 0.0), (base, 0.0), (crest, height), (0.0, height)]},
        lifts=placed,
    )


def pit(
    width: float,
    floors: Sequence[float],
    wall: float | Sequence[float],
    bottoms: Layers,
    size: float,
    *,
    beyond: float | None = None,
    fine: float | None = None,
    **more: Any,
) -> Section:
    """Return half of a pit on the left of a wall at x = 0, whose lifts are ``"lift 1"``, ...

    Parameters
    ----------
    width
        Half of the width of the pit.
    floors
        Heights of the floors of the lifts, from the top to the bottom: negative.
    wall
        Height of the toe of the wall, a slit with the name ``"wall"``; or heights of nodes for
        props and anchors and of the toe, ``(-2., -5., -14.)``.
    bottoms
        Layers, see :func:`layers`.
    size, fine
        Sizes of elements, and of elements along the wall; by default a third of the former.
    beyond
        Ground behind the wall; by default three times the depth of the wall.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.pit(10., [-2., -5.], -8., {"sand": -15.}, size=3.)
    <Section areas: sand; lifts: lift 1, lift 2; lines: wall>
    """
    # Check that floors and wall descend.
    levels = np.append(0.0, finite(floors, "floors"))
    heights = np.append(0.0, finite(wall, "wall"))
    below = heights[heights < 0.0]
    descending = (np.diff(levels) < 0.0).all() and (np.diff(below) < 0.0).all()
    if not descending or heights[-1] > levels[-1]:
        raise ValueError(
            "heights of floors and of the wall must descend from 0, to the toe of the wall, not "
            f"{floors!r} and {wall!r}"
        )
    # Dig in lifts between floors.
    left = -positive(width, "width")
    right = chosen(beyond, "beyond", -3.0 * heights[-1])
    lifts = {}
    for k in range(1, len(levels)):
        lifts[f"lift {k}"] = rectangle((left, 0.0), (levels[k], levels[k - 1]))
    return in_layers(
        (left, right),
        bottoms,
        size=size,
        more=more,
        lifts=lifts,
        lines={"wall": np.column_stack((0.0 * heights, heights))},
        slits="wall",
        sizes={"wall": chosen(fine, "fine", size / 3.0)},
    )
