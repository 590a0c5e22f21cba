"""Values at the nodes of porous ground: at any coordinates, and lines where they are zero."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem import Mesh

from ..checks import format_point

#: Corners of the triangles of a quadrilateral and of the tetrahedra of a hexahedron, as in
#: scikit-fem.
_PARTS = {
    (2, 3): ((0, 1, 2),),
    (2, 4): ((0, 1, 3), (1, 2, 3)),
    (3, 4): ((0, 1, 2, 3),),
    (3, 8): ((0, 1, 3, 4), (0, 3, 2, 4), (2, 3, 4, 6), (3, 4, 6, 7), (3, 4, 5, 7), (1, 3, 4, 5)),
}
#: A point is inside of an element if it lies outside by less than this, in sizes of the element:
#: round-off, and the distance of curved sides from straight ones. The finder of scikit-fem accepts
#: one unit of round-off only.
_ROUND_OFF, _CURVED = 1e-9, 0.1
#: Numbers of elements that are tried, the nearest centres first: graded meshes have many near ones.
_TRIED = (8, 64, 512)


def simplices(mesh: Mesh, elements: ndarray) -> ndarray:
    """Return the triangles or tetrahedra of elements, (dim + 1, n)."""
    t = mesh.t[:, elements]
    return np.hstack([t[list(part)] for part in _PARTS[mesh.dim(), len(t)]])


def interpolated(
    mesh: Mesh, elements: ndarray, nodal: ndarray, points: ndarray, beyond: ndarray | None
) -> ndarray:
    """Return nodal values at points (dim, n), linear on the simplices of elements; at points beyond
    them given ones.
    """
    corners = simplices(mesh, elements)
    p = mesh.p[:, corners]
    inverse = np.linalg.inv((p[:, 1:] - p[:, :1]).transpose(2, 0, 1))
    tree = cKDTree(p.mean(axis=1).T)
    result, lost = np.empty(points.shape[1]), np.arange(points.shape[1])
    for tried in (*(n for n in _TRIED if n < len(inverse)), len(inverse)):
        near = tree.query(points[:, lost].T, tried)[1].reshape(len(lost), -1)
        outside = np.full(len(lost), np.inf)
        for candidate in near.T:
            local = np.einsum(
                "nij,jn->in", inverse[candidate], points[:, lost] - p[:, 0, candidate]
            )
            weights = np.vstack((1.0 - local.sum(axis=0), local))
            better = -weights.min(axis=0) < outside
            outside[better] = -weights.min(axis=0)[better]
            result[lost[better]] = (weights * nodal[corners[:, candidate]]).sum(axis=0)[better]
        lost = lost[outside > (_ROUND_OFF if tried < min(_TRIED[-1], len(inverse)) else _CURVED)]
        if len(lost) == 0:
            return result
    if beyond is not None:
        result[lost] = beyond[lost]
        return result
    raise ValueError(
        f"{len(lost)} points lie outside of the porous ground, the first is "
        f"{format_point(points[:, lost[0]])}"
    )


def zero_lines(mesh: Mesh, elements: ndarray, values: ndarray) -> list[ndarray]:
    """Return polylines between nodes of negative and of other values, (n, 2) each, from left to
    right.
    """
    from matplotlib.figure import Figure  # half a second, for pictures only
    from matplotlib.tri import Triangulation

    if mesh.dim() != 2:
        raise ValueError("a free surface is a line in plane flow only")
    corners = simplices(mesh, elements).T
    negative = values[corners] < 0.0
    if negative.all() or not negative.any():
        return []
    x, y = mesh.p[:, : len(values)]
    lines = (
        Figure()
        .add_subplot()
        .tricontour(Triangulation(x, y, corners), np.nan_to_num(values), [0.0])
        .allsegs[0]
    )
    return sorted(
        map(_cleaned, lines), key=lambda line: -np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    )


def _cleaned(line: ndarray) -> ndarray:
    """Return a line from left to right, or from below, without points that coincide with the one
    before.
    """
    if tuple(line[-1]) < tuple(line[0]):
        line = line[::-1]
    kept = np.ones(len(line), dtype=bool)
    kept[1:] = np.linalg.norm(np.diff(line, axis=0), axis=1) > 1e-12 * np.ptp(line, axis=0).max()
    return line[kept] if kept.sum() > 1 else line
