"""Sections from drawings: rules make areas, lifts, walls, water and loads of layers."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..checks import format_point, positive
from .curves import TEXTS, Chain, chain_of, entities, joined, open_gap, position, snapped
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
#: Rules of layers with closed outlines.
_CLOSED = ("area", "body", "lift", "hole")
#: All rules: closed outlines, then lines, then layers outside of the mesh.
_RULES = (*_CLOSED, "top", "line", "slit", "load", "water", "ignore")


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
        Parts of the drawing that were left out, moved or not understood, in words.
    """

    section: Section
    stages: dict[int, tuple[str, ...]]
    water: dict[str, ndarray] = field(default_factory=dict)
    loads: tuple[str, ...] = ()
    origin: tuple[float, float] = (0.0, 0.0)
    remarks: tuple[str, ...] = ()


class _Layer(NamedTuple):
    """Curves and texts of a layer of the drawing, with its rule as its kind."""

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
    splines become arcs within 2e-5 of the size of the drawing.

    Parameters
    ----------
    file
        DXF file.
    rules
        Meaning of the layers by patterns of their names such as ``"DIG *"``; the first one counts,
        and capitals do not. Closed outlines are an ``"area"``, a ``"body"``,
        which is an area that touches by contact alone, a ``"lift"`` or a ``"hole"``. Lines are the
        ``"top"`` of a layer of ground, which reaches down to the next one, a ``"line"`` such as a
        geogrid, a ``"slit"`` such as a wall whose sides slip, or a ``"load"``. ``"water"`` is the
        water table. ``"ignore"``: nothing.
    size
        Size of elements in metres.
    unit
        ``"mm"``, ``"cm"``, ``"dm"``, ``"m"``, ``"in"`` or ``"ft"``; by default the file's unit.
    bottom
        Height of the lower end of the ground below the last ``"top"``, in metres, in the section's
        coordinates.
    more
        Further arguments of :class:`Section`.

    Returns
    -------
    Drawing
        Names are the names of the layers, or texts of the same layer in its outlines.

    Raises
    ------
    ValueError
        No unit, outlines that are open by more than a gap, outlines without one of the texts,
        layers without outlines, unknown rules, and all that :class:`Section` refuses.
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
        if kind not in _RULES:
            raise ValueError(f"the rule of '{pattern}' is {kind!r}; there are {', '.join(_RULES)}")

    # Read the layers
    remarks: list[str] = []
    document = _load(file)
    layers = _read(document, rules, remarks)
    layers, origin = _in_metres(layers, _unit_of(document, unit), remarks)
    near = _SNAP * float(np.ptp(_points(layers), axis=0).max())
    layers = _snapped(layers, near)

    # Name their outlines
    shapes: dict[str, list[Outline]] = {}
    kinds: dict[str, str] = {}
    for layer in layers:
        for name, outlines in _shapes(layer, near, remarks).items():
            shapes[name] = outlines
            kinds[name] = layer.kind

    def of(*wanted: str) -> dict[str, list[Outline]]:
        result = {}
        for name, kind in kinds.items():
            if kind in wanted:
                result[name] = shapes[name]
        return result

    # Make the section, whose areas replace what is drawn by upper edges
    ground = _ground(of("top"), bottom, near)
    replacing = of("body")
    if ground:
        replacing = of("area", "body")
    options: dict[str, Any] = {
        "lifts": of("lift"),
        "holes": of("hole"),
        "lines": of("line", "slit", "load"),
        "slits": list(of("slit")),
        "bodies": list(of("body")),
        "replace": [*list(ground)[1:], *replacing],
    }
    areas = ground | of("area", "body")
    section = Section(areas, positive(size, "size"), **(options | more))

    water = {}
    for name, outlines in of("water").items():
        water[name] = np.vstack([outline.points for outline in outlines])
    return Drawing(
        section,
        stages=_stages_of(kinds),
        water=water,
        loads=tuple(of("load")),
        origin=origin,
        remarks=tuple(remarks),
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
    if name in _METRES:
        return _METRES[name]
    known = ", ".join(_METRES)
    if unit is None:
        raise ValueError(f"the drawing has no unit: give one, unit='m' ({known})")
    raise ValueError(f"unit must be one of {known}, not {unit!r}")


def _left_out(layer: _Layer, name: str, kinds: Mapping[str, int]) -> str:
    """Return the remark on entities of a layer that are left out, by their kinds."""
    listed = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    why = "without a rule"
    if layer.kind:
        why = "not understood"
    return f"layer '{name}': {listed} {why}"


def _stages_of(names: Iterable[str]) -> dict[int, tuple[str, ...]]:
    """Sort names by the number of the stage at their end."""
    stages: dict[int, tuple[str, ...]] = {}
    for name in names:
        digits = re.search(r"\d+$", name)
        if digits:
            stage = int(digits[0])
            stages[stage] = (*stages.get(stage, ()), name)
    return dict(sorted(stages.items()))


def _read(document: Any, rules: Mapping[str, str], remarks: list[str]) -> list[_Layer]:
    """Return the layers of a drawing that have a rule and curves."""
    layers, skipped = _by_layer(document, rules)
    told = {name: _left_out(layers[name], name, kinds) for name, kinds in skipped.items()}
    remarks.extend(told.values())
    result = [layer for layer in layers.values() if layer.chains]
    if not result:
        not_understood = [text for name, text in told.items() if layers[name].kind]
        reasons = [f"its layers are {sorted(told) or 'empty'}", *not_understood]
        raise ValueError(
            f"no curve of the drawing has a rule; {'; '.join(reasons)}: draw outlines by lines, "
            "polylines, arcs, circles, ellipses or splines"
        )
    return result


def _by_layer(
    document: Any, rules: Mapping[str, str]
) -> tuple[dict[str, _Layer], dict[str, Counter[str]]]:
    """Return layers with their curves and texts, and the kinds of the entities left out."""
    drawn = list(entities(document.modelspace()))
    size = _size_of([entity for entity, _ in drawn])
    layers: dict[str, _Layer] = {}
    skipped: dict[str, Counter[str]] = {}
    for entity, name in drawn:
        rule = _rule_of(name, rules)
        if rule == "ignore":
            continue
        layer = layers.setdefault(name, _Layer(_name_of(name), rule or "", [], []))
        if not rule or not _add(layer, entity, size):
            skipped.setdefault(name, Counter())[entity.dxftype()] += 1
    return layers, skipped


def _add(layer: _Layer, entity: Any, size: float) -> bool:
    """Add a curve or a text to its layer; False for other entities."""
    chain = _chain_of(entity, size)
    if chain:
        layer.chains.append(chain)
        return True
    kind = entity.dxftype()
    if kind not in TEXTS:
        return False
    if kind == "MTEXT":
        text = entity.plain_text()
    else:
        text = entity.dxf.text
    layer.texts.append((_name_of(text.strip()), position(entity)))
    return True


def _rule_of(layer: str, rules: Mapping[str, str]) -> str | None:
    """Return the rule of the first pattern that a layer's name matches."""
    for pattern, rule in rules.items():
        if fnmatch(layer.lower(), pattern.lower()):
            return rule
    return None


def _name_of(text: str) -> str:
    """Return a text without the characters that names of a section may not have."""
    return re.sub(r"[|:]", "-", text)


def _size_of(drawn: list[Any]) -> float:
    """Return the largest extent of a curve."""
    size = 1e-9
    for entity in drawn:
        chain = _chain_of(entity, 1.0)
        if chain:
            size = max(size, float(np.ptp(chain.points, axis=0).max()))
    return size


def _chain_of(entity: Any, size: float) -> Chain | None:
    """Return the chain of a curve, whose points must be finite."""
    chain = chain_of(entity, size)
    if chain and not np.isfinite(chain.points).all():
        raise ValueError(
            f"a {entity.dxftype()} on layer '{entity.dxf.layer}' has coordinates that are not "
            f"finite"
        )
    return chain


def _in_metres(
    layers: list[_Layer], metres: float, remarks: list[str]
) -> tuple[list[_Layer], tuple[float, float]]:
    """Return layers in metres, near the origin, and where the origin was."""
    x = metres * _points(layers)
    low = x.min(axis=0)
    high = x.max(axis=0)
    size = (high - low).max()
    origin = np.zeros(2)
    # Move drawings in coordinates of a map to the origin, where round-off is small.
    if max_abs(x) > _FAR * size:
        far = np.abs(0.5 * (low + high)) > _FAR * size
        origin = np.where(far, np.round(low), 0.0)
        remarks.append(f"moved: {format_point(origin)} m of the drawing is the origin")
    # Scale and move all points.
    moved = []
    for layer in layers:
        new = layer._replace(chains=[], texts=[])
        for chain in layer.chains:
            new.chains.append(chain._replace(points=metres * chain.points - origin))
        for text, place in layer.texts:
            new.texts.append((text, metres * place - origin))
        moved.append(new)
    return moved, (float(origin[0]), float(origin[1]))


def _points(layers: list[_Layer]) -> ndarray:
    """Return the points of all curves."""
    return np.vstack([chain.points for layer in layers for chain in layer.chains])


def _snapped(layers: list[_Layer], near: float) -> list[_Layer]:
    """Return layers whose corners that are nearer than a distance are one point."""
    chains: list[Chain] = []
    for layer in layers:
        chains += layer.chains
    chains = snapped(chains, near)
    result = []
    for layer in layers:
        result.append(layer._replace(chains=chains[: len(layer.chains)]))
        chains = chains[len(layer.chains) :]
    return result


def _shapes(layer: _Layer, near: float, remarks: list[str]) -> dict[str, list[Outline]]:
    """Return the outlines of a layer by name."""
    # Join the curves; outlines must be closed.
    chains, doubles = joined(layer.chains, near)
    if doubles:
        remarks.append(f"layer '{layer.name}': {doubles} doubles left out")
    if layer.kind in _CLOSED:
        gaps = [open_gap(chain) for chain in chains if not chain.closed]
        if gaps:
            raise ValueError(
                f"{len(gaps)} of {len(chains)} outlines of layer '{layer.name}' are open, one "
                f"{gaps[0]}: close them, or give the layer another rule"
            )
    # Name outlines by the texts in them, or by the layer.
    outlines = [Outline(*chain, name=layer.name) for chain in chains]
    if layer.texts and layer.kind in _CLOSED:
        return _by_text(layer, outlines)
    if layer.texts:
        texts = [text for text, _ in layer.texts]
        remarks.append(f"layer '{layer.name}': text {texts} not understood")
    return {layer.name: outlines}


def _by_text(layer: _Layer, outlines: list[Outline]) -> dict[str, list[Outline]]:
    """Return the outlines of a layer by the one text inside each of them."""
    result: dict[str, list[Outline]] = {}
    for outline in outlines:
        inside = sorted({text for text, place in layer.texts if _contains(outline, place)})
        if len(inside) != 1:
            raise ValueError(
                f"an outline of layer '{layer.name}' near "
                f"{format_point(outline.points.mean(axis=0))} has {len(inside)} texts {inside}, "
                "but one names it"
            )
        result.setdefault(inside[0], []).append(outline)
    return dict(sorted(result.items()))


def _contains(outline: Outline, point: ndarray) -> bool:
    """Return whether a point lies inside an outline, whose arcs are chords here."""
    a, b, _ = outline.chords()
    above_a = a[:, 1] > point[1]
    above_b = b[:, 1] > point[1]
    x, y = a[above_a != above_b].T
    u, v = b[above_a != above_b].T
    crossings = x + (point[1] - y) / (v - y) * (u - x)
    return bool((crossings > point[0]).sum() % 2)


def _ground(
    tops: Mapping[str, list[Outline]], bottom: float | None, near: float
) -> dict[str, list[Outline]]:
    """Return areas from their upper edges down to the bottom; lower ones replace the upper ones."""
    if not tops:
        return {}
    several = []
    edges = {}
    for name, outlines in tops.items():
        edges[name] = outlines[0]
        if len(outlines) > 1 or outlines[0].closed:
            several.append(name)
    if several:
        raise ValueError(
            f"the upper edges of {several} must be one open line each, from the left to the right"
        )
    if bottom is None:
        raise ValueError(f"the areas {list(tops)} have an upper edge only: give their bottom=")

    # Compare their ends with the ends of the first one
    highest: dict[str, float] = {}
    given = next(iter(edges))
    left, right = np.sort(edges[given].points[[0, -1], 0])
    for name, edge in edges.items():
        first, last = np.sort(edge.points[[0, -1], 0])
        if max(abs(first - left), abs(last - right)) > near:
            raise ValueError(
                f"the upper edge of '{name}' reaches from x = {first:.6g} to {last:.6g}, that of "
                f"'{given}' from {left:.6g} to {right:.6g}"
            )
        ends = np.vstack(edge.chords()[:2])
        highest[name] = -float(ends[:, 1].mean())

    # Close them along the bottom, the highest one first
    areas: dict[str, list[Outline]] = {}
    for name in sorted(edges, key=highest.__getitem__):
        points = edges[name].points
        bulges = edges[name].bulges
        if points[0, 0] > points[-1, 0]:
            points = points[::-1]
            bulges = -bulges[::-1]
        points = np.vstack((points, [(points[-1, 0], bottom), (points[0, 0], bottom)]))
        areas[name] = [Outline(points, np.append(bulges, np.zeros(3)), True, name)]
    return areas
