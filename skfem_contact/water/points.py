"""Values at the nodes of porous ground: at any coordinates, and lines where they are zero."""

from __future__ import annotations

import numpy as np
import scipy
from numpy import ndarray
from skfem import Mesh

from ..arrays import row_norms
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
_ROUND_OFF = 1e-9
_CURVED = 0.1
#: Numbers of elements that are tried, the nearest centres first: graded meshes have many near ones.
_TRIED = (8, 64, 512)


def simplices(mesh: Mesh, elements: ndarray) -> ndarray:
    """Return the triangles or tetrahedra of elements, (dim + 1, n)."""
    t = mesh.t[:, elements]
    parts = _PARTS[mesh.dim(), len(t)]
    return np.hstack([t[list(part)] for part in parts])


def interpolated(
    mesh: Mesh,
    elements: ndarray,
    nodal: ndarray,
    points: ndarray,
    beyond: ndarray | None,
) -> ndarray:
    """Return nodal values at points (dim, n), linear on the simplices of elements.

    Points beyond the elements have given values, or are refused.
    """
    corners = simplices(mesh, elements)
    p = mesh.p[:, corners]  # (dim, dim + 1, m)
    edges = p[:, 1:] - p[:, :1]
    inverse = np.linalg.inv(edges.transpose(2, 0, 1))
    tree = scipy.spatial.cKDTree(p.mean(axis=1).T)
    n_simplices = len(inverse)
    last = min(_TRIED[-1], n_simplices)
    result = np.empty(points.shape[1])
    remaining = np.arange(points.shape[1])
    # Try more and more simplices for the points that lie in none so far.
    for tried in (*(n for n in _TRIED if n < n_simplices), n_simplices):
        x = points[:, remaining]
        near = tree.query(x.T, tried)[1].reshape(len(remaining), -1)
        outside = np.full(len(remaining), np.inf)
        for candidate in near.T:
            # barycentric coordinates
            local = np.einsum("nij,jn->in", inverse[candidate], x - p[:, 0, candidate])
            weights = np.vstack((1.0 - local.sum(axis=0), local))
            off = -weights.min(axis=0)
            better = off < outside
            outside[better] = off[better]
            values = (weights * nodal[corners[:, candidate]]).sum(axis=0)
            result[remaining[better]] = values[better]
        tolerance = _CURVED
        if tried < last:
            tolerance = _ROUND_OFF
        remaining = remaining[outside > tolerance]
        if len(remaining) == 0:
            return result
    if beyond is None:
        raise ValueError(
            f"{len(remaining)} points lie outside of the porous ground, the first is "
            f"{format_point(points[:, remaining[0]])}"
        )
    result[remaining] = beyond[remaining]
    return result


def zero_lines(mesh: Mesh, elements: ndarray, values: ndarray) -> list[ndarray]:
    """Return lines between negative and other nodal values, (n, 2) each, from left to right."""
    from matplotlib.figure import Figure  # half a second, for pictures only
    from matplotlib.tri import Triangulation

    if mesh.dim() != 2:
        raise ValueError("a free surface is a line in plane flow only")
    corners = simplices(mesh, elements).T
    negative = values[corners] < 0.0
    if negative.all() or not negative.any():
        return []
    x, y = mesh.p[:, : len(values)]
    triangles = Triangulation(x, y, corners)
    contour = Figure().add_subplot().tricontour(triangles, np.nan_to_num(values), [0.0])
    lines = [_cleaned(line) for line in contour.allsegs[0]]
    return sorted(lines, key=lambda line: -_steps(line).sum())


def _steps(line: ndarray) -> ndarray:
    """Return the lengths of the pieces of a line, (n - 1,)."""
    return np.asarray(row_norms(np.diff(line, axis=0)))


def _cleaned(line: ndarray) -> ndarray:
    """Return a line from left to right, or from below, without points that coincide."""
    if tuple(line[-1]) < tuple(line[0]):
        line = line[::-1]
    kept = np.ones(len(line), dtype=bool)
    kept[1:] = _steps(line) > 1e-12 * np.ptp(line, axis=0).max()
    if kept.sum() > 1:
        return line[kept]
    return line
