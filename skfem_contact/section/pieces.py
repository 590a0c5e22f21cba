"""Pieces into which the outlines of a section cut each other: faces of areas, curves of lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, product
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ..checks import format_point
from ..errors import warn
from .kernel import ONE_POINT, add_curves, add_face
from .outline import Outline

Outlines = Mapping[str, tuple[Outline, ...]]
#: Share of the length of a line that round-off may move out of the areas.
_ROUND_OFF = 1e-9
#: Share of the section's size up to which a distance of areas is a slip: 2 cm of 20 m. It would
#: have elements as small.
_SLIP = 1e-3


@dataclass(frozen=True)
class Plan:
    """Outlines of a section that were checked one by one."""

    areas: Outlines
    lifts: Outlines
    holes: Outlines
    lines: Outlines
    below: Outline | None
    replacing: frozenset[str]
    bodies: frozenset[str]
    shift: ndarray


@dataclass(frozen=True)
class Pieces:
    """Faces with their area and lift, "" for none; curves of lines and of the sides of holes."""

    faces: dict[int, tuple[str, str]]
    lines: dict[str, list[int]]
    holes: dict[str, list[int]]


class _Shape(NamedTuple):
    """Face or curve of an outline: its kind and name, dimension and number."""

    kind: str
    name: str
    tag: tuple[int, int]


#: Names of the outlines that hold a face, by kind: area, lift, hole, and below the surface.
Owners = Mapping[str, list[str]]


def cut_up(gmsh: Any, plan: Plan) -> Pieces:
    """Cut all outlines into pieces in the current model and check that they fit."""
    occ = gmsh.model.occ
    shapes = _added(occ, plan)
    tags = [shape.tag for shape in shapes]
    parts = [tags]
    if len(tags) > 1:
        parts = occ.fragment(tags, [])[1]
    occ.synchronize()
    owners, lines = _owners(plan, shapes, parts)

    # Keep the faces of the section
    sides = {face: sides_of(gmsh, face) for face in owners}
    faces = _faces(gmsh, plan, owners)
    borders: set[int] = set()
    ground = {}
    for face, (area, _) in faces.items():
        borders.update(sides[face])
        if area not in plan.bodies:
            ground[face] = sides[face]
    _check_together(gmsh, plan, ground, faces)

    # Take the sides of holes, of which the first one counts in a face
    holes: dict[str, list[int]] = {name: [] for name in plan.holes}
    for face, kinds in owners.items():
        if "hole" in kinds:
            holes[kinds["hole"][0]] += [curve for curve in sides[face] if curve in borders]
    pieces = Pieces(faces, lines, holes)
    _check_curves(gmsh, plan, pieces)
    return pieces


def _added(occ: Any, plan: Plan) -> list[_Shape]:
    """Add the faces and curves of all outlines to the current model."""
    shapes = []

    def add(kind: str, name: str, outline: Outline) -> None:
        shapes.append(_Shape(kind, name, (2, add_face(occ, outline, plan.shift))))

    # Add faces in the order in which later ones replace earlier ones.
    for kind, outlines in (("area", plan.areas), ("lift", plan.lifts), ("hole", plan.holes)):
        for name, pieces in outlines.items():
            for outline in pieces:
                add(kind, name, outline)
    if plan.below:
        add("below", "", plan.below)
    # Add the curves of lines.
    for name, pieces in plan.lines.items():
        for outline in pieces:
            for curve in add_curves(occ, outline, plan.shift):
                shapes.append(_Shape("line", name, (1, curve)))
    return shapes


def _owners(
    plan: Plan, shapes: Sequence[_Shape], parts: Sequence[Sequence[tuple[int, int]]]
) -> tuple[dict[int, dict[str, list[str]]], dict[str, list[int]]]:
    """Return the owners of all faces by kind, and the curves of all lines, from their pieces."""
    owners: dict[int, dict[str, list[str]]] = {}
    lines: dict[str, list[int]] = {name: [] for name in plan.lines}
    for shape, pieces in zip(shapes, parts):
        for _, piece in pieces:
            if shape.kind == "line":
                lines[shape.name].append(piece)
                continue
            known = owners.setdefault(piece, {}).setdefault(shape.kind, [])
            if shape.name not in known:
                known.append(shape.name)
    return owners, lines


def _faces(gmsh: Any, plan: Plan, owners: Mapping[int, Owners]) -> dict[int, tuple[str, str]]:
    """Return the faces of the section with area and lift; remove the others from the model."""
    faces = {}
    others = []
    remaining = {("area", name) for name in plan.areas} | {("lift", name) for name in plan.lifts}
    for face, kinds in owners.items():
        labels = _area_and_lift(gmsh, plan, face, kinds)
        if labels:
            faces[face] = labels
            remaining -= set(zip(("area", "lift"), labels))
        else:
            others.append((2, face))
    gmsh.model.removeEntities(others, recursive=False)

    # Refuse areas and lifts without a face
    for kind, names in (("area", plan.areas), ("lift", plan.lifts)):
        for name in names:
            if (kind, name) in remaining:
                raise ValueError(
                    f"nothing is left of the {kind} '{name}': others, holes or the surface "
                    "replace all"
                )
    return faces


def _area_and_lift(gmsh: Any, plan: Plan, face: int, kinds: Owners) -> tuple[str, str] | None:
    """Return the area and the lift of a face, None outside of the section."""
    # Leave out holes and what lies above the surface.
    if "hole" in kinds or (plan.below and "below" not in kinds):
        return None
    # The last of several areas counts if it may replace the others.
    areas = kinds.get("area", [])
    lifts = kinds.get("lift", [])
    if not set(areas[1:]) <= plan.replacing:
        raise ValueError(
            f"the areas {_listed(areas)} overlap{_where(gmsh, plan, face)}: change their "
            f"outlines, or let the later one replace the earlier one: replace=['{areas[-1]}']"
        )
    if not areas:
        if lifts:
            raise ValueError(f"the lift '{lifts[0]}' leaves the areas{_where(gmsh, plan, face)}")
        return None
    # Bodies have no lifts, and lifts do not overlap.
    area = areas[-1]
    if area in plan.bodies or not lifts:
        return area, ""
    if len(lifts) > 1:
        raise ValueError(f"the lifts {_listed(lifts)} overlap{_where(gmsh, plan, face)}")
    return area, lifts[0]


def sides_of(gmsh: Any, face: int) -> list[int]:
    """Return the curves round a face."""
    return [abs(int(curve)) for curve in gmsh.model.getAdjacencies(2, face)[1]]


def _check_together(
    gmsh: Any,
    plan: Plan,
    sides: Mapping[int, list[int]],
    faces: Mapping[int, tuple[str, str]],
) -> None:
    """Refuse faces of the ground that nearly hang together, and warn of faces farther apart."""
    # Find the faces that hang together with the first one by common curves
    if len(sides) < 2:
        return
    curves = np.concatenate(list(sides.values()))
    counts = [len(around) for around in sides.values()]
    rows = np.repeat(np.arange(len(sides)), counts)
    shared = coo_matrix((np.ones(len(curves)), (rows, curves)))
    label = connected_components(shared @ shared.T, directed=False)[1]
    if not label.any():
        return
    first_part = []
    others = []
    for face, part in zip(sides, label):
        if part == 0:
            first_part.append(face)
        else:
            others.append(face)

    # Measure their distance from the others
    gaps = []
    for first, second in product(first_part, others):
        gaps.append((gmsh.model.occ.getDistance(2, first, 2, second), first, second))
    (distance, x, y, *_), first, second = min(gaps)
    if distance > ONE_POINT:
        how = f"are {distance:.4g} apart"
    else:
        how = "touch in a point"
    problem = (
        f"the areas '{faces[first][0]}' and '{faces[second][0]}' do not hang together: they {how} "
        f"near {format_point(np.array([x, y]) + plan.shift)}"
    )
    corners = np.vstack([outline.points for outline in chain(*plan.areas.values())])
    if distance < _SLIP * np.ptp(corners, axis=0).max():
        raise ValueError(
            f"{problem}: let them share a line, or name what touches by contact alone in bodies="
        )
    warn(f"{problem}; each needs supports of its own, or is named in bodies=")


def _check_curves(gmsh: Any, plan: Plan, pieces: Pieces) -> None:
    """Refuse lines outside of the section and holes that cut nothing; remove stray curves."""
    occ = gmsh.model.occ
    # Collect the curves that bound faces or lie in them.
    used: set[int] = set()
    for face in pieces.faces:
        used.update(sides_of(gmsh, face), _inside(gmsh, face))

    # Lines must lie in the areas.
    for name, outlines in plan.lines.items():
        length = sum(outline.length for outline in outlines)
        outside = sorted(set(pieces.lines[name]) - used)
        excess = sum(occ.getMass(1, curve) for curve in outside)
        if excess > _ROUND_OFF * length:
            middle = np.array(occ.getCenterOfMass(1, outside[0])[:2]) + plan.shift
            raise ValueError(
                f"{excess:.4g} of the {length:.4g} of line '{name}' lie outside of the areas, "
                f"near {format_point(middle)}"
            )
    # Holes must cut something out.
    for name, curves in pieces.holes.items():
        if not curves:
            raise ValueError(
                f"the hole '{name}' cuts nothing: it lies outside of the areas or in another hole"
            )
    # Remove what is left over.
    strays = []
    for _, curve in gmsh.model.getEntities(1):
        if curve not in used:
            strays.append((1, curve))
    gmsh.model.removeEntities(strays, recursive=True)


def _inside(gmsh: Any, face: int) -> list[int]:
    """Return the curves inside a face."""
    return [int(tag) for dim, tag in gmsh.model.mesh.getEmbedded(2, face) if dim == 1]


def _listed(names: Sequence[str]) -> str:
    return " and ".join(f"'{name}'" for name in names)


def _where(gmsh: Any, plan: Plan, face: int) -> str:
    """Return size and coordinates of a face in words."""
    occ = gmsh.model.occ
    centre = np.array(occ.getCenterOfMass(2, face)[:2]) + plan.shift
    return f" by an area of {occ.getMass(2, face):.3g} near {format_point(centre)}"
