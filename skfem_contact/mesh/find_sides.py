"""Sides of elements by their corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from skfem import Mesh

from .boundaries import Sides
from .content import cached, node_keys
from .kinds import Floats, Integers

#: Words for groups of sides, by the dimension of the mesh.
_WORDS = {2: ("lines", "curve", "sides"), 3: ("faces", "surface", "sides")}


def named_sides(mesh: Mesh, corners: Integers, groups: dict[str, Integers]) -> dict[str, Sides]:
    """Return the sides of elements that groups name, seen from the elements behind them.

    The outward normal of that element points to the right of a line in the plane, and to where the
    corners go round anticlockwise in space.

    Parameters
    ----------
    mesh
        Mesh without tags.
    corners
        Corners of the elements of sides, (n, corners).
    groups
        Numbers of the elements of sides by names.
    """
    # Find the sides of all groups at once.
    is_named = np.zeros(len(corners), dtype=bool)
    for members in groups.values():
        is_named[members] = True
    place = np.cumsum(is_named) - 1
    if not is_named.all():
        corners = corners[is_named]
    elements, local = _behind(mesh, corners)
    # Divide them by groups.
    found = {}
    for name, members in groups.items():
        own = place[members]
        stray = np.count_nonzero(elements[own] < 0)
        if stray:
            words = _WORDS[mesh.dim()]
            raise ValueError(
                f"{stray} of {len(members)} {words[0]} of {words[1]} '{name}' are not "
                f"{words[2]} of elements: make them such in the mesh, or leave '{name}' out of the "
                "file"
            )
        found[name] = Sides(elements[own], local[own], oriented=True)
    return found


def sides_between(mesh: Mesh, nodes: Integers) -> Sides:
    """Return the sides all of whose corners are among nodes: outer ones if possible."""
    chosen = _mask(mesh.nvertices, nodes)
    if chosen.all():
        nothing = np.zeros(0, np.int32)
        return Sides(nothing, nothing, oriented=False)
    # An inner side belongs to two elements.
    elements, local, corners = _sides_among(mesh, chosen)
    keys = node_keys(corners)
    _, first, count = np.unique(keys, return_index=True, return_counts=True)
    if (count == 1).any():
        first = first[count == 1]
    return Sides(elements[first], local[first], oriented=False)


def _behind(mesh: Mesh, corners: Integers) -> tuple[Integers, Integers]:
    """Return the elements behind sides and the numbers of their sides, (n,), -1 where none is."""
    elements = np.full(len(corners), -1, dtype=np.int32)
    local = elements.copy()
    if corners.shape[1] != len(mesh.elem.refdom.facets[0]) or len(corners) == 0:
        return elements, local
    # Look up the keys among the ones of element sides, all of whose corners occur.
    near, number, nodes = _sides_among(mesh, _mask(mesh.doflocs.shape[1], corners))
    keys = node_keys(nodes)
    order = np.argsort(keys)
    keys = np.append(keys[order], np.zeros(2, keys.dtype))
    # Ascending keys are found several times faster.
    wanted = node_keys(corners)
    ascending = np.argsort(wanted)
    wanted = wanted[ascending]
    place = np.searchsorted(keys[:-2], wanted)
    exists = keys[place] == wanted
    known = ascending[exists]
    place = place[exists]
    first = order[place]
    elements[known] = near[first]
    local[known] = number[first]
    # Of two elements take the one from which the normal of the side points away.
    inner = keys[place + 1] == wanted[exists]
    if not inner.any():
        return elements, local
    known = known[inner]
    first = first[inner]
    sides = corners[known]
    middles = mesh.p[:, mesh.t[:, near[first]]].mean(axis=1)
    outward = mesh.p[:, sides].mean(axis=2) - middles
    inward = (normals(mesh.p[:, sides]) * outward).sum(axis=0) < 0
    second = order[place[inner][inward] + 1]
    elements[known[inward]] = near[second]
    local[known[inward]] = number[second]
    return elements, local


def _mask(count: int, nodes: Integers) -> NDArray[np.bool_]:
    """Return True for the numbers below a count that are among nodes; -1 is none."""
    chosen = np.zeros(count + 1, dtype=bool)
    chosen[nodes.ravel(order="K")] = True
    return chosen[:-1]


def _sides_among(mesh: Mesh, chosen: NDArray[np.bool_]) -> tuple[Integers, Integers, Integers]:
    """Return elements, numbers and corners of all sides whose corners are chosen nodes."""
    # Leave out most elements: one of so many corners must be chosen, as a side has the others.
    sides = mesh.elem.refdom.facets
    first = mesh.t[: len(mesh.t) - len(sides[0]) + 1]
    parts = [np.zeros(0, dtype=np.intp)]
    for piece in cached(mesh.t.shape[1]):
        nodes = first[:, piece].astype(np.intp)
        may_be = np.logical_or.reduce(chosen[nodes], axis=0)
        parts.append(piece.start + np.flatnonzero(may_be))
    near = np.concatenate(parts)
    t = mesh.t.take(near, axis=1)
    is_chosen = chosen.take(t)
    # Take each side of the others.
    elements = []
    local = []
    corners = []
    for number, side in enumerate(sides):
        found = np.flatnonzero(np.logical_and.reduce([is_chosen[corner] for corner in side]))
        elements.append(near.take(found).astype(np.int32))
        local.append(np.full(len(found), number, dtype=np.int32))
        corners.append(np.array([t[corner].take(found) for corner in side]).T)
    return np.concatenate(elements), np.concatenate(local), np.concatenate(corners)


def normals(x: Floats) -> Floats:
    """Return normals of sides, (dim, n), of any length, from their corners, (dim, n, corners)."""
    if len(x) == 2:
        along = x[:, :, 1] - x[:, :, 0]
        return np.array((along[1], -along[0]))
    # Diagonals of quadrilaterals, edges of triangles
    first = (0, 2)
    second = (1, 3)
    if x.shape[2] == 3:
        first = (0, 1)
        second = (0, 2)
    one = x[:, :, first[1]] - x[:, :, first[0]]
    other = x[:, :, second[1]] - x[:, :, second[0]]
    return np.cross(one, other, axis=0)
