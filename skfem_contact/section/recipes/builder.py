"""Builder of ready sections: level layers, further areas, and arguments of the user on top."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...checks import number
from ..outline import Outline, rectangle
from ..section import Section, Shape

#: Layers from the top to the bottom: heights of the lower ends by name, or pairs of both.
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


def in_layers(
    x: Sequence[float],
    bottoms: Layers,
    *,
    size: float,
    more: Mapping[str, Any],
    top: float = 0.0,
    areas: Mapping[str, Shape] | None = None,
    **options: Any,
) -> Section:
    """Return a section of level layers and further areas; lifts, lines and sizes of `more` add."""
    for name, value in more.items():
        own = options.get(name)
        options[name] = {**own, **value} if isinstance(own, dict) else value
    return Section({**layers(x, top, bottoms), **(areas or {})}, size, **options)


def chosen(value: float | None, name: str, default: float) -> float:
    """Return a length, or its default where it is not given."""
    if value is None:
        return default
    return number(value, name)
