"""Columns of layers at points of a site, and the section between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..checks import format_point, vector
from ..section import Section

#: Thickness, over the height of a section, below which a layer has no area.
_THIN = 1e-6


@dataclass(frozen=True)
class Column:
    """Layers below a point of the surface.

    Attributes
    ----------
    name
        Name of the borehole or sounding.
    position
        Easting and northing, or x alone, in m.
    level
        Height of the surface in m.
    layers
        Pairs of soil and height of the lower end of each layer, from the top to the bottom.
    remarks
        Rows that were left out, interpolated or corrected, in words.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> west = sc.ground.Column("B1", (0.0,), 2.0, (("sand", -1.0), ("clay", -9.0)))
    >>> west.soils
    ('sand', 'clay')
    """

    name: str
    position: tuple[float, ...]
    level: float
    layers: tuple[tuple[str, float], ...]
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        upper = self.level
        if not self.layers:
            raise ValueError(f"'{self.name}' has no layers")
        for soil, bottom in self.layers:
            if not bottom < upper:
                raise ValueError(
                    f"'{self.name}': the layer '{soil}' ends at {bottom:g}, which is not below "
                    f"{upper:g}"
                )
            upper = bottom

    @property
    def soils(self) -> tuple[str, ...]:
        """Soils from the top to the bottom; repeated ones are numbered, "sand", "sand 2"."""
        return _numbered([soil for soil, _ in self.layers])

    def renamed(self, names: Mapping[str, str]) -> Column:
        """Return a column with other names of soils; layers of one name that meet are joined."""
        layers: list[tuple[str, float]] = []
        for soil, bottom in self.layers:
            name = names.get(soil, soil)
            if layers and layers[-1][0] == name:
                layers.pop()
            layers.append((name, bottom))
        return replace(self, layers=tuple(layers))


def _numbered(soils: Sequence[str]) -> tuple[str, ...]:
    """Return names with numbers where they are repeated."""
    found: list[str] = []
    for soil in soils:
        count = 1 + sum(other == soil for other in soils[: len(found)])
        found.append(soil if count == 1 else f"{soil} {count}")
    return tuple(found)


def section(
    columns: Sequence[Column],
    size: float,
    *,
    along: tuple[ArrayLike, ArrayLike] | None = None,
    width: float = 0.0,
    bottom: float | None = None,
    **more: Any,
) -> Section:
    """Return the section through columns, whose layers are interpolated between them.

    Between two columns all boundaries of layers and the surface are straight. A layer that is in
    one of two neighbours only is wedged out at the other. Beyond the first and the last column
    boundaries are horizontal. **All between columns is interpolated, not measured**: it is for the
    engineer to judge whether layers of one name are one layer.

    Parameters
    ----------
    columns
        Columns in any order, such as boreholes and ``sounding.column(...)``. Their lowest layers
        reach down to the bottom of the section.
    size
        Size of elements in m.
    along
        Two points (easting, northing) of the line of the section, on which columns are projected;
        x of the section is the distance from the first. By default positions of one number, or
        the line through the first and the last column.
    width
        Distance for which the section continues beyond the first and the last column.
    bottom
        Height of the lower end; by default the column that ends highest decides.
    more
        Further arguments of :class:`skfem_contact.section.Section`.

    Returns
    -------
    Section
        Its areas have the names of the soils.

    Raises
    ------
    ValueError
        Fewer than two columns, columns at one point, or layers in different orders.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> west = sc.ground.Column("B1", (0.0,), 2.0, (("sand", -1.0), ("clay", -9.0)))
    >>> east = sc.ground.Column("B2", (30.0,), 0.0, (("clay", -8.0),))
    >>> sorted(sc.ground.section([west, east], size=2.0).areas)
    ['clay', 'sand']
    """
    if len(columns) < 2:
        raise ValueError(f"a section needs two columns or more, not {len(columns)}")
    x = _positions(columns, along)
    order = np.argsort(x)
    x = x[order]
    columns = [columns[k] for k in order]
    if np.diff(x).min() <= 0.0:
        raise ValueError(
            "columns lie at one point of the section: "
            f"{', '.join(column.name for column in columns)} at {format_point(x)}"
        )
    names = _order_of_layers(columns)
    depths = _boundaries(columns, names, bottom)  # (1 + n_layers, n_columns)
    if width > 0.0:
        left = [x[0] - width]
        right = [x[-1] + width]
        x = np.concatenate((left, x, right))
        depths = np.pad(depths, ((0, 0), (1, 1)), mode="edge")
    areas = {}
    for k, name in enumerate(names):
        outlines = _outlines(x, depths[k], depths[k + 1])
        if outlines:
            areas[name] = outlines
    return Section(areas, size, **more)


def _positions(columns: Sequence[Column], along: tuple[ArrayLike, ArrayLike] | None) -> ndarray:
    """Return the positions of columns along the section."""
    if along is None and all(len(column.position) == 1 for column in columns):
        return np.array([column.position[0] for column in columns])
    points = []
    for column in columns:
        points.append(vector(column.position, 2, f"the position of '{column.name}'"))
    start, end = (points[0], points[-1]) if along is None else along
    start = vector(start, 2, "the first point of along")
    direction = vector(end, 2, "the second point of along") - start
    length = np.linalg.norm(direction)
    if length == 0.0:
        raise ValueError("the line of the section has no length")
    return (np.array(points) - start) @ direction / length


def _order_of_layers(columns: Sequence[Column]) -> list[str]:
    """Return all soils from the top to the bottom; every column must have them in this order."""
    # Collect what lies below each soil.
    below: dict[str, set[str]] = {}
    for column in columns:
        for name in column.soils:
            below.setdefault(name, set())
        for upper, lower in pairwise(column.soils):
            below[upper].add(lower)
    # Take soils that nothing covers, one after the other.
    order: list[str] = []
    remaining = dict(below)
    while remaining:
        covered = set().union(*remaining.values())
        free = [name for name in remaining if name not in covered]
        if not free:
            raise ValueError(
                f"the layers {', '.join(remaining)} come in different orders in the columns: give "
                "those of one name that are different layers different names, with `renamed`"
            )
        order.append(free[0])
        del remaining[free[0]]
    return order


def _boundaries(columns: Sequence[Column], names: list[str], bottom: float | None) -> ndarray:
    """Return the heights of the surface and of the lower ends of all layers in every column."""
    ends = [column.layers[-1][1] for column in columns]
    lowest = max(ends) if bottom is None else float(bottom)
    found = []
    for column in columns:
        heights = dict(zip(column.soils, (z for _, z in column.layers)))
        heights[column.soils[-1]] = lowest
        levels = [column.level]
        for name in names:
            levels.append(max(min(heights.get(name, levels[-1]), levels[-1]), lowest))
        if column.level <= lowest:
            raise ValueError(f"'{column.name}' begins at {column.level:g}, below the bottom")
        found.append(levels)
    return np.array(found).T


def _outlines(x: ndarray, upper: ndarray, lower: ndarray) -> list[ndarray]:
    """Return the outlines of a layer between two lines, one for each part with a thickness."""
    thick = upper - lower > _THIN * np.ptp(np.concatenate((upper, lower)))
    outlines = []
    present = thick[:-1] | thick[1:]
    for start in np.flatnonzero(present & ~np.insert(present[:-1], 0, False)):
        gaps = np.flatnonzero(~present[start:])
        end = start + (gaps[0] if len(gaps) else len(present) - start)
        outlines += _without_necks(x[start : end + 1], upper, lower, thick, int(start))
    return outlines


def _without_necks(
    x: ndarray,
    upper: ndarray,
    lower: ndarray,
    thick: ndarray,
    start: int,
) -> list[ndarray]:
    """Return the outlines of a stretch, cut where the layer has no thickness at a column."""
    stop = start + len(x) - 1
    necks = [k for k in range(start + 1, stop) if not thick[k]]
    outlines = []
    for first, last in pairwise([start, *necks, stop]):
        here = slice(first, last + 1)
        xs = x[first - start : last - start + 1]
        top = np.column_stack((xs, upper[here]))
        base = np.column_stack((xs, lower[here]))[thick[here]]
        outlines.append(np.concatenate((base, top[::-1])))
    return outlines
