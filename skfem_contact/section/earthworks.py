"""Sections of slopes, embankments and pits from a few numbers each; heights are measured from the
ground, y = 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..checks import finite, number, positive
from .outline import Outline, rectangle
from .section import Section

#: Layers from the top to the bottom: the height of the lower end of each, by name, or pairs of
#: both.
Layers = Mapping[str, float] | Sequence[tuple[str, float]]


def layers(x: Sequence[float], top: float, bottoms: Layers) -> dict[str, list[Outline]]:
    """Return level layers as areas of a section.

    Parameters
    ----------
    x
        Abscissas of their left and right ends.
    top
        Height of their upper end.
    bottoms
        Heights of the lower ends of the layers by name, from the top to the bottom, or pairs of
        name and height: a soil may come twice.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> ground = sc.section.layers((0., 10.), 0., [("sand", -2.), ("clay", -5.), ("sand", -9.)])
    >>> {name: sum(outline.area for outline in outlines) for name, outlines in ground.items()}
    {'sand': 60.0, 'clay': 30.0}
    """
    areas: dict[str, list[Outline]] = {}
    upper = number(top, "top")
    for name, bottom in bottoms.items() if isinstance(bottoms, Mapping) else bottoms:
        if not number(bottom, f"the lower end of '{name}'") < upper:
            raise ValueError(
                f"the layer '{name}' ends at {bottom:g}, which is not below its upper end at "
                f"{upper:g}"
            )
        areas.setdefault(name, []).append(rectangle(x, (bottom, upper)))
        upper = bottom
    return areas


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
    run = positive(height, "height") / np.tan(np.radians(number(angle, "angle", 0.0, 90.0)))
    left, right = -chosen(crest, "crest", 2.0 * height), run + chosen(toe, "toe", 2.0 * height)
    surface = [(left, height), (0.0, height), (run, 0.0), (right, 0.0)]
    return Section(layers((left, right), height, bottoms), size, surface=surface, **more)


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
    """Return the right half of an embankment on level ground, of the area ``"fill"`` and lifts
    ``"lift 1"``, ...

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
        Level ground beside the toe; by default twice the half width of the base.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.embankment(4., 5., 2., {"clay": -8.}, size=2., lifts=2).parts
    {'remaining': ('clay',), 'lift 1': ('fill',), 'lift 2': ('fill',)}
    """
    base = positive(crest, "crest") + positive(run, "run") * positive(height, "height")
    levels = np.linspace(0.0, height, lifts + 1)
    widths = base - run * levels
    right = base + chosen(beyond, "beyond", 2.0 * base)
    ground = layers((0.0, right), 0.0, bottoms)
    fill = {"fill": [(0.0, 0.0), (base, 0.0), (crest, height), (0.0, height)]}
    placed = {
        f"lift {k + 1}": [
            (0.0, levels[k]),
            (widths[k], levels[k]),
            (widths[k + 1], levels[k + 1]),
            (0.0, levels[k + 1]),
        ]
        for k in range(lifts)
    }
    return Section({**ground, **fill}, size, **merged({"lifts": placed}, more))


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
        Size of elements, and that along the wall; by default a third of it.
    beyond
        Ground beside the wall; by default three times the depth of the wall.
    more
        Further arguments of :class:`Section`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.section.pit(10., [-2., -5.], -8., {"sand": -15.}, size=3.)
    <Section areas: sand; lifts: lift 1, lift 2; lines: wall>
    """
    levels = np.append(0.0, finite(floors, "floors"))
    heights = np.append(0.0, finite(wall, "wall"))
    if (
        (np.diff(levels) >= 0.0).any()
        or (np.diff(heights[heights < 0.0]) >= 0.0).any()
        or heights[-1] > levels[-1]
    ):
        raise ValueError(
            "heights of floors and of the wall must descend from 0, to the toe of the wall, not "
            f"{floors!r} and {wall!r}"
        )
    left, right = -positive(width, "width"), chosen(beyond, "beyond", -3.0 * heights[-1])
    lifts = {
        f"lift {k}": rectangle((left, 0.0), (levels[k], levels[k - 1]))
        for k in range(1, len(levels))
    }
    options: dict[str, Any] = {
        "lifts": lifts,
        "lines": {"wall": np.column_stack((0.0 * heights, heights))},
        "slits": "wall",
        "sizes": {"wall": chosen(fine, "fine", size / 3.0)},
    }
    return Section(layers((left, right), 0.0, bottoms), size, **merged(options, more))


def chosen(value: float | None, name: str, default: float) -> float:
    """Return a length, or its default where it is not given."""
    return default if value is None else number(value, name)


def merged(options: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    """Return arguments of a section with those of the user, whose lifts, lines and sizes come on
    top.
    """
    return options | {
        name: {**options[name], **value} if isinstance(options.get(name), dict) else value
        for name, value in more.items()
    }
