"""Pieces into which the outlines of a section cut each other: faces of one area each, and curves of
lines.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from ..checks import format_point
from ..errors import warn
from .kernel import ONE_POINT, add_curves, add_face
from .outline import Outline

Outlines = Mapping[str, tuple[Outline, ...]]
#: Share of the length of a line that may be lost by round-off.
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
    """Faces by number with their area and lift, "" for none; curves of lines and of the outlines of
    holes.
    """

    faces: dict[int, tuple[str, str]]
    lines: dict[str, list[int]]
    holes: dict[str, list[int]]


def cut_up(gmsh: Any, plan: Plan) -> Pieces:
    """Cut all outlines into pieces in the current model and check that they fit."""
    occ = gmsh.model.occ
    given: list[tuple[str, str, tuple[int, int]]] = []
    for kind, outlines in (("area", plan.areas), ("lift", plan.lifts), ("hole", plan.holes)):
        given += [
            (kind, name, (2, add_face(occ, outline, plan.shift)))
            for name, pieces in outlines.items()
            for outline in pieces
        ]
    if plan.below:
        given.append(("below", "", (2, add_face(occ, plan.below, plan.shift))))
    given += [
        ("line", name, (1, curve))
        for name, pieces in plan.lines.items()
        for outline in pieces
        for curve in add_curves(occ, outline, plan.shift)
    ]
    shapes = [shape for _, _, shape in given]
    parts = occ.fragment(shapes, [])[1] if len(shapes) > 1 else [shapes]
    occ.synchronize()

    owners: dict[int, dict[str, list[str]]] = {}
    curves: dict[str, list[int]] = {name: [] for name in plan.lines}
    for (kind, name, (dim, _)), cut in zip(given, parts):
        for _, piece in cut:
            if dim == 1:
                curves[name].append(piece)
            elif name not in (there := owners.setdefault(piece, {}).setdefault(kind, [])):
                there.append(name)
    sides = {face: sides_of(gmsh, face) for face in owners}
    faces = _faces(gmsh, plan, owners)
    _check_together(
        gmsh,
        plan,
        {face: sides[face] for face, (area, _) in faces.items() if area not in plan.bodies},
        faces,
    )
    borders = {curve for face in faces for curve in sides[face]}
    holes: dict[str, list[int]] = {name: [] for name in plan.holes}
    for face, kinds in owners.items():
        for name in kinds.get("hole", [])[:1]:
            holes[name] += [curve for curve in sides[face] if curve in borders]
    pieces = Pieces(faces, curves, holes)
    _check_curves(gmsh, plan, pieces)
    return pieces


def _faces(
    gmsh: Any, plan: Plan, owners: Mapping[int, Mapping[str, list[str]]]
) -> dict[int, tuple[str, str]]:
    """Return the faces of the section with their area and lift; remove the others from the
    model.
    """
    faces, others = {}, []
    for face, kinds in owners.items():
        areas, lifts = kinds.get("area", []), kinds.get("lift", [])
        gone = "hole" in kinds or (plan.below is not None and "below" not in kinds)
        if len(areas) > 1 and not set(areas[1:]) <= plan.replacing and not gone:
            raise ValueError(
                f"the areas {_named(areas)} overlap{_where(gmsh, plan, face)}: change their "
                f"outlines, or "
                f"let the later one replace the earlier one: replace=['{areas[-1]}']"
            )
        if areas and not gone:
            lifts = [] if areas[-1] in plan.bodies else lifts
            if len(lifts) > 1:
                raise ValueError(f"the lifts {_named(lifts)} overlap{_where(gmsh, plan, face)}")
            faces[face] = areas[-1], lifts[0] if lifts else ""
        elif lifts and not gone:
            raise ValueError(f"the lift '{lifts[0]}' leaves the areas{_where(gmsh, plan, face)}")
        else:
            others.append((2, face))
    gmsh.model.removeEntities(others, recursive=False)
    for kind, k, names in (("area", 0, plan.areas), ("lift", 1, plan.lifts)):
        if lost := [name for name in names if name not in {labels[k] for labels in faces.values()}]:
            raise ValueError(
                f"nothing is left of the {kind} '{lost[0]}': others, holes or the surface replace "
                f"all"
            )
    return faces


def sides_of(gmsh: Any, face: int) -> list[int]:
    """Return the curves round a face."""
    return [abs(int(curve)) for curve in gmsh.model.getAdjacencies(2, face)[1]]


def _check_together(
    gmsh: Any, plan: Plan, sides: Mapping[int, list[int]], faces: Mapping[int, tuple[str, str]]
) -> None:
    """Refuse faces of the ground, by their curves, that nearly hang together, and warn of those
    farther apart.
    """
    if len(sides) < 2:
        return
    face, curve = np.array(
        [(k, curve) for k, around in enumerate(sides.values()) for curve in around], int
    ).T
    shared = coo_matrix((np.ones(len(face)), (face, curve)))
    label = connected_components(shared @ shared.T, directed=False)[1]
    part, left = (
        [name for name, own in zip(sides, label) if (own == 0) == first] for first in (True, False)
    )
    if not left:
        return
    (away, x, y, *_), one, other = min(
        (gmsh.model.occ.getDistance(2, a, 2, b), a, b) for a in part for b in left
    )
    how = f"are {away:.4g} apart" if away > ONE_POINT else "touch in a point"
    text = (
        f"the areas '{faces[one][0]}' and '{faces[other][0]}' do not hang together: they {how} "
        f"near "
        f"{format_point(np.array([x, y]) + plan.shift)}"
    )
    corners = np.concatenate(
        [outline.points for outlines in plan.areas.values() for outline in outlines]
    )
    if away < _SLIP * np.ptp(corners, axis=0).max():
        raise ValueError(
            f"{text}: let them share a line, or name what touches by contact alone in bodies="
        )
    warn(f"{text}; each needs supports of its own, or is named in bodies=")


def _check_curves(gmsh: Any, plan: Plan, pieces: Pieces) -> None:
    """Refuse lines that leave the section and holes that cut nothing, and remove curves that belong
    to nothing.
    """
    there = {
        curve for face in pieces.faces for curve in (*sides_of(gmsh, face), *_inside(gmsh, face))
    }
    for name, outlines in plan.lines.items():
        length = sum(outline.length for outline in outlines)
        outside = [curve for curve in pieces.lines[name] if curve not in there]
        if (
            outside
            and (lost := sum(gmsh.model.occ.getMass(1, curve) for curve in outside))
            > _ROUND_OFF * length
        ):
            at = np.array(gmsh.model.occ.getCenterOfMass(1, outside[0])[:2]) + plan.shift
            raise ValueError(
                f"{lost:.4g} of the {length:.4g} of line '{name}' lie outside of the areas, "
                f"near {format_point(at)}"
            )
    if away := [name for name, curves in pieces.holes.items() if not curves]:
        raise ValueError(
            f"the hole '{away[0]}' cuts nothing: it lies outside of the areas or in another hole"
        )
    strays = [(1, curve) for _, curve in gmsh.model.getEntities(1) if curve not in there]
    gmsh.model.removeEntities(strays, recursive=True)


def _inside(gmsh: Any, face: int) -> list[int]:
    """Return the curves inside a face."""
    return [int(tag) for dim, tag in gmsh.model.mesh.getEmbedded(2, face) if dim == 1]


def _named(names: Sequence[str]) -> str:
    return " and ".join(f"'{name}'" for name in names)


def _where(gmsh: Any, plan: Plan, face: int) -> str:
    """Return size and coordinates of a face in words."""
    at = np.array(gmsh.model.occ.getCenterOfMass(2, face)[:2]) + plan.shift
    return f" by an area of {gmsh.model.occ.getMass(2, face):.3g} near {format_point(at)}"
