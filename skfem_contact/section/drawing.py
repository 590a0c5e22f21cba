"""Sections from drawings: layers of a DXF file become areas, lifts, walls, water and loads by
rules.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray

from ..checks import format_point, positive
from .curves import TEXTS, Chain, chain_of, entities, joined, open_gap, plane, snapped
from .outline import Outline
from .section import Section

#: Metres of the units of drawings, by their number in the file and by name.
_NUMBERS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 14: "dm"}
_METRES = {"in": 0.0254, "ft": 0.3048, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0}
#: Corners nearer than this share of the drawing are one point, and gaps of outlines up to it are
#: closed.
_SNAP = 1e-5
#: Drawings farther from the origin than so many times their size are moved to it: coordinates lose
#: digits there.
_FAR = 20.0
#: What a rule may make of a layer: closed outlines, then lines, then what is no part of the mesh.
_CLOSED, _OPEN, _BESIDE = (
    ("area", "body", "lift", "hole"),
    ("top", "line", "slit", "load"),
    ("water", "ignore"),
)


@dataclass(frozen=True)
class Drawing:
    """A drawing that was read.

    Attributes
    ----------
    section
        Its :class:`Section`, in metres.
    stages
        Names of areas, lifts and lines by the number of their stage, the number at the end of their
        layer's name.
    water
        Points of the water table (n, 2) by the name of its layer.
    loads
        Names of the lines of the section that are loaded.
    origin
        Point of the drawing, in metres, that is the origin of the section.
    remarks
        What was left out, closed, moved or not understood, in words.
    """

    section: Section
    stages: dict[int, tuple[str, ...]]
    water: dict[str, ndarray] = field(default_factory=dict)
    loads: tuple[str, ...] = ()
    origin: tuple[float, float] = (0.0, 0.0)
    remarks: tuple[str, ...] = ()


class _Layer(NamedTuple):
    """Curves and texts of a layer of the drawing, and what a rule makes of it."""

    name: str
    kind: str
    chains: list[Chain]
    texts: list[tuple[str, ndarray]]


def from_dxf(
    file: str | Path,
    rules: Mapping[str, str],
    size: float,
    *,
    unit: str | None = None,
    bottom: float | None = None,
    **more: Any,
) -> Drawing:
    """Read a section from a drawing.

    Lines, polylines, arcs, circles, ellipses, splines and inserted blocks are read. Ends that meet
    are joined, gaps up to 1e-5 of the drawing are closed, doubles are left out. Ellipses and
    splines become chords.

    Parameters
    ----------
    file
        DXF file.
    rules
        What the layers of the drawing are, by patterns of their names such as ``"DIG *"``; the
        first one counts, and capitals do not. Closed outlines are an ``"area"``, a ``"body"``,
        which is an area that touches by contact alone, a ``"lift"`` or a ``"hole"``. Lines are the
        ``"top"`` of a layer of ground, which reaches down to the next one, a ``"line"`` such as a
        geogrid, a ``"slit"`` such as a wall whose sides slip, or a ``"load"``. ``"water"`` is the
        water table. ``"ignore"``: nothing.
    size
        Size of elements in metres.
    unit
        ``"mm"``, ``"cm"``, ``"dm"``, ``"m"``, ``"in"`` or ``"ft"``; by default that of the file.
    bottom
        Height of the lower end of the ground below the last ``"top"``, in metres, in the section's
        coordinates.
    more
        Further arguments of :class:`Section`.

    Returns
    -------
    Drawing
        Names are those of the layers. Where texts of the same layer lie in its outlines they are
        the names.

    Raises
    ------
    ValueError
        No unit, outlines that are open by more than a gap, outlines without one of the texts,
        layers without outlines, unknown rules, and what :class:`Section` refuses.
    ImportError
        ezdxf is missing: install the extra ``drawing``.

    Examples
    --------
    >>> import os, tempfile, ezdxf
    >>> import skfem_contact as sc
    >>> document = ezdxf.new(units=ezdxf.units.M)
    >>> ground = document.modelspace().add_lwpolyline([(0, 0), (9, 0), (9, 4), (0, 4)], close=True)
    >>> ground.dxf.layer = "clay"
    >>> document.saveas(file := os.path.join(tempfile.mkdtemp(), "ground.dxf"))
    >>> sc.section.from_dxf(file, {"clay": "area"}, size=2.).section
    <Section areas: clay>
    """
    for pattern, kind in rules.items():
        if kind not in (*_CLOSED, *_OPEN, *_BESIDE):
            there = ", ".join((*_CLOSED, *_OPEN, *_BESIDE))
            raise ValueError(f"the rule of '{pattern}' is {kind!r}; there are {there}")
    remarks: list[str] = []
    document = _load(file)
    layers, origin = _in_metres(_read(document, rules, remarks), _unit_of(document, unit), remarks)
    near = _SNAP * _size(layers)
    layers = _snapped(layers, near)
    shapes = {
        name: shape for layer in layers for name, shape in _shapes(layer, near, remarks).items()
    }
    kinds = {name: kind for layer in layers for name, kind in _names(layer, shapes)}
    areas = _tops(
        {name: shapes[name] for name, kind in kinds.items() if kind == "top"}, bottom, near
    )
    tops = list(areas)
    areas |= {name: shapes[name] for name, kind in kinds.items() if kind in ("area", "body")}
    options: dict[str, Any] = {
        "lifts": {name: shapes[name] for name, kind in kinds.items() if kind == "lift"},
        "holes": {name: shapes[name] for name, kind in kinds.items() if kind == "hole"},
        "lines": {
            name: shapes[name] for name, kind in kinds.items() if kind in ("line", "slit", "load")
        },
        "slits": [name for name, kind in kinds.items() if kind == "slit"],
        "bodies": [name for name, kind in kinds.items() if kind == "body"],
        "replace": [
            *tops[1:],
            *(name for name, kind in kinds.items() if kind == "body" or (kind == "area" and tops)),
        ],
    }
    water = {
        name: np.vstack([outline.points for outline in shapes[name]])
        for name, kind in kinds.items()
        if kind == "water"
    }
    stages: dict[int, tuple[str, ...]] = {}
    for name in kinds:
        if number := re.search(r"(\d+)$", name):
            stages[int(number[1])] = (*stages.get(int(number[1]), ()), name)
    loads = tuple(name for name, kind in kinds.items() if kind == "load")
    return Drawing(
        Section(areas, positive(size, "size"), **(options | more)),
        dict(sorted(stages.items())),
        water,
        loads,
        origin,
        tuple(remarks),
    )


def _load(file: str | Path) -> Any:
    """Open a drawing."""
    try:
        from ezdxf.filemanagement import readfile
        from ezdxf.lldxf.const import DXFError
    except ModuleNotFoundError as error:
        raise ImportError(
            "drawings are read by ezdxf, which is not installed: "
            'pip install "skfem-contact[drawing]"'
        ) from error
    try:
        return readfile(str(file))
    except FileNotFoundError:
        raise
    except (DXFError, OSError) as error:
        raise ValueError(f"{file} is not a DXF file: {error}") from error


def _unit_of(document: Any, unit: str | None) -> float:
    """Return the metres of a drawing's unit."""
    name = unit or _NUMBERS.get(int(document.header.get("$INSUNITS", 0)))
    if name not in _METRES:
        raise ValueError(
            f"the drawing has no unit: give one, unit='m' ({', '.join(_METRES)})"
            if unit is None
            else f"unit must be one of {', '.join(_METRES)}, not {unit!r}"
        )
    return _METRES[name]


def _read(document: Any, rules: Mapping[str, str], remarks: list[str]) -> list[_Layer]:
    """Return the layers of a drawing that have a rule."""
    found: dict[str, _Layer] = {}
    there, skipped = list(entities(document.modelspace())), dict[str, dict[str, int]]()
    size = max(
        [
            1e-9,
            *(float(np.ptp(chain.points, axis=0).max()) for e in there if (chain := _safe(e, 1.0))),
        ]
    )
    for entity in there:
        name, kind = entity.dxf.layer, entity.dxftype()
        rule = next(
            (rule for pattern, rule in rules.items() if fnmatch(name.lower(), pattern.lower())),
            None,
        )
        if rule == "ignore":
            continue
        chain = _safe(entity, size)
        if rule is None or (chain is None and kind not in TEXTS):
            skipped.setdefault(name, {}).setdefault(kind, 0)
            skipped[name][kind] += 1
            continue
        layer = found.setdefault(name, _Layer(re.sub(r"[|:]", "-", name), rule, [], []))
        if chain:
            layer.chains.append(chain)
        else:
            text = entity.plain_text().strip() if kind == "MTEXT" else entity.dxf.text.strip()
            layer.texts.append((text, plane(entity.dxf.insert)))
    for name, kinds in skipped.items():
        ruled = any(fnmatch(name.lower(), pattern.lower()) for pattern in rules)
        listed = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
        remarks.append(
            f"layer '{name}': {listed} {'not understood' if ruled else 'without a rule'}"
        )
    if not any(layer.chains for layer in found.values()):
        raise ValueError(
            f"no curve of the drawing has a rule; its layers are {sorted(skipped) or 'empty'}"
        )
    return [layer for layer in found.values() if layer.chains]


def _safe(entity: Any, size: float) -> Chain | None:
    """Return the chain of a curve in the plane z = constant."""
    chain = chain_of(entity, size)
    if chain is not None and not np.isfinite(chain.points).all():
        raise ValueError(
            f"a {entity.dxftype()} on layer '{entity.dxf.layer}' has coordinates that are not "
            f"finite"
        )
    return chain


def _in_metres(
    layers: list[_Layer], metres: float, remarks: list[str]
) -> tuple[list[_Layer], tuple[float, float]]:
    """Return layers in metres, near the origin, and where the origin was."""
    x = metres * np.vstack([chain.points for layer in layers for chain in layer.chains])
    low, high = x.min(axis=0), x.max(axis=0)
    origin = np.zeros(2)
    if np.abs(np.append(low, high)).max() > _FAR * (high - low).max():
        far = np.abs(0.5 * (low + high)) > _FAR * (high - low).max()
        origin = np.where(far, np.round(low), 0.0)
        remarks.append(f"moved: {format_point(origin)} m of the drawing is the origin")
    moved = [
        layer._replace(
            chains=[
                chain._replace(points=metres * chain.points - origin) for chain in layer.chains
            ],
            texts=[(text, metres * at - origin) for text, at in layer.texts],
        )
        for layer in layers
    ]
    return moved, (float(origin[0]), float(origin[1]))


def _snapped(layers: list[_Layer], near: float) -> list[_Layer]:
    """Return layers whose corners that are nearer than a distance are one point."""
    chains = iter(snapped([chain for layer in layers for chain in layer.chains], near))
    return [layer._replace(chains=[next(chains) for _ in layer.chains]) for layer in layers]


def _size(layers: list[_Layer]) -> float:
    return float(
        np.ptp(
            np.vstack([chain.points for layer in layers for chain in layer.chains]), axis=0
        ).max()
    )


def _shapes(layer: _Layer, near: float, remarks: list[str]) -> dict[str, list[Outline]]:
    """Return the outlines of a layer by name."""
    chains, doubles = joined(layer.chains, near)
    if doubles:
        remarks.append(f"layer '{layer.name}': {doubles} doubles left out")
    if layer.kind not in _CLOSED:
        texts = [text for text, _ in layer.texts]
        remarks += [f"layer '{layer.name}': text {texts} not understood"] if texts else []
        return {layer.name: [Outline(c.points, c.bulges, c.closed, layer.name) for c in chains]}
    if gaps := [open_gap(chain) for chain in chains if not chain.closed]:
        raise ValueError(
            f"{len(gaps)} of {len(chains)} outlines of layer '{layer.name}' are open, one "
            f"{gaps[0]}: "
            "close them, or give the layer another rule"
        )
    outlines = [Outline(chain.points, chain.bulges, True, layer.name) for chain in chains]
    if not layer.texts:
        return {layer.name: outlines}
    found: dict[str, list[Outline]] = {}
    for outline in outlines:
        inside = [text for text, at in layer.texts if _holds(outline, at)]
        if len(set(inside)) != 1:
            raise ValueError(
                f"an outline of layer '{layer.name}' near "
                f"{format_point(outline.points.mean(axis=0))} has "
                f"{len(set(inside))} texts {sorted(set(inside))}, but one names it"
            )
        found.setdefault(re.sub(r"[|:]", "-", inside[0]), []).append(outline)
    return found


def _holds(outline: Outline, at: ndarray) -> bool:
    """Return whether a point lies inside an outline, whose arcs are chords here."""
    a, b, _ = outline.chords()
    above = (a[:, 1] > at[1]) != (b[:, 1] > at[1])
    a, b = a[above], b[above]
    return bool(
        ((a[:, 0] + (at[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])) > at[0]).sum()
        % 2
    )


def _names(layer: _Layer, shapes: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the names that a layer gives, and its kind."""
    texts = (
        {re.sub(r"[|:]", "-", text) for text, _ in layer.texts} if layer.kind in _CLOSED else set()
    )
    return [
        (name, layer.kind) for name in (sorted(texts & shapes.keys()) if texts else [layer.name])
    ]


def _tops(tops: Mapping[str, list[Outline]], bottom: float | None, near: float) -> dict[str, Any]:
    """Return areas from their upper edges down to the bottom; lower ones replace the upper ones."""
    if not tops:
        return {}
    lines = {name: outlines[0] for name, outlines in tops.items()}
    if several := [
        name for name, outlines in tops.items() if len(outlines) > 1 or outlines[0].closed
    ]:
        raise ValueError(
            f"the upper edges of {several} must be one open line each, from the left to the right"
        )
    if bottom is None:
        raise ValueError(f"the areas {list(tops)} have an upper edge only: give their bottom=")
    ends = {name: np.sort(line.points[[0, -1], 0]) for name, line in lines.items()}
    left, right = next(iter(ends.values()))
    for name, (first, last) in ends.items():
        if max(abs(first - left), abs(last - right)) > near:
            raise ValueError(
                f"the upper edge of '{name}' reaches from x = {first:.6g} to {last:.6g}, that of "
                f"'{next(iter(ends))}' from {left:.6g} to {right:.6g}"
            )
    order = sorted(lines, key=lambda name: -float(np.vstack(lines[name].chords()[:2])[:, 1].mean()))
    areas: dict[str, Any] = {}
    for name in order:
        points, bulges = lines[name].points, lines[name].bulges
        if points[0, 0] > points[-1, 0]:
            points, bulges = points[::-1], -bulges[::-1]
        points = np.vstack((points, [(points[-1, 0], bottom), (points[0, 0], bottom)]))
        areas[name] = [Outline(points, np.append(bulges, np.zeros(3)), True, name)]
    return areas
