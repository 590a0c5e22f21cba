"""Sides to which the normals of facets point: alike for neighbours."""

from __future__ import annotations

import numpy as np
from numpy import ndarray

from ..arrays import row_norms
from ..checks import format_point
from ..sparse import parts_of
from ..surfaces.vectors import unit
from .element import SMOOTH, n_corners, normals


def _neighbours(points: ndarray, cells: ndarray, folds: bool) -> tuple[ndarray, ndarray]:
    """Return pairs of neighbours, (n, 2), also beyond folds or not, and which go round alike, (n,).

    Neighbours that go round alike pass the edge between them in opposite directions.
    """
    # Edges between two facets
    n = n_corners(cells)
    begin = cells[:, :n].ravel()
    end = np.roll(cells[:, :n], -1, axis=1).ravel()
    edges = np.sort(np.stack((begin, end)), axis=0)
    _, number, count = np.unique(edges, axis=1, return_inverse=True, return_counts=True)
    number = number.ravel()
    order = np.argsort(number, kind="stable")
    of_two = order[count[number[order]] == 2].reshape(-1, 2)

    # All of them, or those without a fold
    rises = begin < end
    alike = rises[of_two[:, 0]] != rises[of_two[:, 1]]
    facets = of_two // n
    if folds:
        return facets, alike
    normal = unit(normals(points[cells[:, :3]]))
    cosine = np.einsum("ij,ij->i", normal[facets[:, 0]], normal[facets[:, 1]])
    flat = np.where(alike, cosine, -cosine) > SMOOTH
    return facets[flat], alike[flat]


def check_alike(points: ndarray, cells: ndarray) -> None:
    """Refuse facets, (m, k), some of whose neighbours have their normals on the other side."""
    pairs, alike = _neighbours(points, cells, folds=False)
    if alike.all():
        return
    n = n_corners(cells)
    middle = points[cells[pairs[~alike][0, 0], :n]].mean(axis=0)
    raise ValueError(
        f"the normals of {(~alike).sum()} pairs of neighbouring cells of the shell point to "
        f"opposite sides, first at {format_point(middle)}: give all of them anticlockwise seen "
        "from one side, as the triangles of scikit-fem's `mesh.oriented()` are"
    )


def turned(points: ndarray, cells: ndarray) -> ndarray:
    """Return which facets, (m, k), to turn so that the normals of neighbours agree, (m,).

    Normals of facets that are connected, also round corners, point upwards in the mean, or where
    they are level along y or x; normals of a closed shell point away from its middle.
    """
    m = len(cells)
    if m == 0:
        return np.zeros(0, bool)

    # A graph of all facets as they are and turned: linked are those that agree
    pairs, alike = _neighbours(points, cells, folds=True)
    first, second = pairs.T
    other = np.where(alike, second, second + m)
    mirrored = np.where(alike, second + m, second)
    part = parts_of(2 * m, np.append(first, first + m), np.append(other, mirrored))

    # Of each part and its mirror image, the one whose normals point upwards or outwards
    triangles = points[cells[:, :3]]
    normal = normals(triangles)
    centre = triangles.mean(axis=1)
    order = np.argsort(part, kind="stable")
    turn = np.zeros(m, bool)
    done = np.zeros(m, bool)
    for members in np.split(order, np.flatnonzero(np.diff(part[order])) + 1):
        facets = members % m
        if done[facets].any():
            continue
        signs = np.where(members < m, 1.0, -1.0)
        wrong = _upwards(signs[:, None] * normal[facets], centre[facets]) < 0.0
        turn[facets] = (signs < 0.0) != wrong
        done[facets] = True
    return turn


def _upwards(normal: ndarray, centre: ndarray) -> float:
    """Return how far normals point upwards, or else along y or x, or else away from the middle."""
    total = normal.sum(axis=0)
    small = 1e-9 * row_norms(normal).sum()
    for component in total[::-1]:
        if abs(component) > small:
            return float(component)
    return float(np.einsum("ij,ij->", normal, centre - centre.mean(axis=0)))
