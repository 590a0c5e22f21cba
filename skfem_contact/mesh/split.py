"""Elements of several kinds divided into triangles or tetrahedra with conforming sides.

Every polygon and every body is divided from its corner of the lowest number: two elements divide
their common side in the same way.
"""

from __future__ import annotations

import numpy as np

from ..arrays import row_norms
from .content import Content, without_doubles
from .kinds import KINDS, Floats, Integers

#: Kinds that are divided, and the kind that results, by the dimension and the order.
_RESULT = {(2, 1): "triangle", (2, 2): "triangle6", (3, 1): "tetra"}


def split(content: Content) -> str:
    """Divide the elements of the highest dimension, and sides of bodies; return their kind."""
    # Find the kind of the parts.
    dim = content.dim
    kinds = []
    for kind in content.cells:
        if KINDS[kind].dim == dim and len(content.cells[kind]):
            kinds.append(kind)
    orders = {KINDS[kind].order for kind in kinds}
    result = _RESULT.get((dim, max(orders)), "")
    if len(orders) > 1 or not result:
        raise ValueError(
            f"elements of the kinds {', '.join(kinds)} are not split: in space all must be of "
            "first order, in the plane of one order"
        )
    # Divide the bodies, and their sides in space.
    _replace(content, kinds, result)
    if dim == 3:
        _replace(
            content, [kind for kind in ("triangle", "quad") if kind in content.cells], "triangle"
        )
    return result


def _replace(content: Content, kinds: list[str], result: str) -> None:
    """Replace the elements of some kinds by their parts, also in groups."""
    cells = []
    groups: dict[str, list[Integers]] = {}
    first = 0
    # Divide each kind, and keep its groups.
    for kind in kinds:
        parts, parent = _divided(content.cells.pop(kind), kind, content.points)
        cells.append(parts)
        for name, group in content.groups.items():
            members = group.pop(kind, None)
            if members is not None:
                groups.setdefault(name, []).append(first + np.flatnonzero(np.isin(parent, members)))
        first += len(parts)
    # Put the parts together.
    if cells:
        content.cells[result] = np.concatenate(cells)
        content.keys.pop(result, None)
        for name, members_of in groups.items():
            content.add(name, result, np.concatenate(members_of))
        without_doubles(content, result)


def _divided(cells: Integers, kind: str, points: Floats) -> tuple[Integers, Integers]:
    """Return the parts of elements and the numbers of the elements to which they belong."""
    every = np.arange(len(cells))
    if kind in ("triangle", "triangle6", "tetra"):
        return cells, every
    if kind == "quad":
        return _halves(cells, every, _shorter(cells, points))
    if kind == "quad9":
        return _halves_of_second_order(cells, every, _shorter(cells, points))
    return _pulled(cells, kind)


def _shorter(cells: Integers, points: Floats) -> np.ndarray:
    """Return True where the diagonal from the first corner is not the longer one.

    In the plane any diagonal conforms; of quadrilaterals on bodies the one from the lowest number.
    """
    x = points[cells[:, :4]]
    if np.ptp(x[..., 2]) == 0.0:
        first = row_norms(x[:, 2] - x[:, 0])
        second = row_norms(x[:, 3] - x[:, 1])
        return np.asarray(first <= second)
    return np.argmin(cells[:, :4], axis=1) % 2 == 0


def _halves(cells: Integers, every: Integers, from_first: np.ndarray) -> tuple[Integers, Integers]:
    """Return two triangles of each quadrilateral."""
    turned = _turned(cells[:, :4], from_first)
    parts = np.concatenate((turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]))
    return parts, np.tile(every, 2)


def _halves_of_second_order(
    cells: Integers, every: Integers, from_first: np.ndarray
) -> tuple[Integers, Integers]:
    """Return two triangles of six nodes; the node in the middle halves the diagonal."""
    corners = _turned(cells[:, :4], from_first)
    middles = _turned(cells[:, 4:8], from_first)
    all_nodes = np.hstack((corners, middles, cells[:, 8:]))
    lower = all_nodes[:, [0, 1, 2, 4, 5, 8]]
    upper = all_nodes[:, [0, 2, 3, 8, 6, 7]]
    return np.concatenate((lower, upper)), np.tile(every, 2)


def _turned(nodes: Integers, from_first: np.ndarray) -> Integers:
    """Return the nodes of quadrilaterals, (n, 4), from the second one on where not `from_first`."""
    return np.where(from_first[:, None], nodes, np.roll(nodes, -1, axis=1))


def _pulled(cells: Integers, kind: str) -> tuple[Integers, Integers]:
    """Return the tetrahedra between the lowest corner and the triangles of sides without it.

    The diagonal of a quadrilateral side starts at the lowest corner of that side.
    """
    # Pull all other sides to the lowest corner, so that neighbours divide their common side alike.
    shape = KINDS[kind]
    corners = cells[:, : shape.corners]
    lowest = np.argmin(corners, axis=1)
    parts = []
    parents = []
    for apex in range(shape.corners):
        chosen = np.flatnonzero(lowest == apex)
        if len(chosen) == 0:
            continue
        # Divide the sides that do not touch the corner.
        for side in shape.sides:
            if apex in side:
                continue
            faces = corners[chosen][:, list(side)]
            for triangle in _triangles(faces):
                parts.append(np.column_stack((triangle, corners[chosen, apex])))
                parents.append(chosen)
    return np.concatenate(parts), np.concatenate(parents)


def _triangles(faces: Integers) -> list[Integers]:
    """Return the triangles of sides, from their lowest corner."""
    if faces.shape[1] == 3:
        return [faces]
    start = np.argmin(faces, axis=1)
    around = (start[:, None] + np.arange(4)) % 4
    turned = np.take_along_axis(faces, around, axis=1)
    return [turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]]
