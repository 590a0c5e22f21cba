"""Forces and moments of shells at the corners of their triangles, for pictures and files."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags

from ..surfaces.vectors import unit
from .element import BENDING, MEMBRANE, SMOOTH, Triangles

#: Values at the corners by those at the middles of the sides (0, 1), (1, 2), (2, 0), if linear.
_BY_MIDDLES = np.array([[1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, 1.0]])


def averages(nodes: ndarray, triangles: Triangles) -> csr_matrix:
    """Return the shares of the corners of triangles in the value at a corner, (3 m, 3 m).

    A corner has the mean, by areas, of the triangles around its node, without those beyond a fold.

    Parameters
    ----------
    nodes
        Numbers of the nodes of the triangles, (m, 3).
    triangles
        Geometry.
    """
    # Neighbours of a corner: corners of triangles at its node, in about the same plane
    corners = np.arange(nodes.size)
    at_node = csr_matrix((np.ones(nodes.size), (corners, nodes.ravel())))
    pairs = (at_node @ at_node.T).tocoo()
    normal = np.repeat(unit(triangles.axes[:, 2]), 3, axis=0)
    cosine = np.einsum("ij,ij->i", normal[pairs.row], normal[pairs.col])
    weight = np.repeat(triangles.areas, 3)[pairs.col] * (cosine > SMOOTH)
    shares = csr_matrix((weight, (pairs.row, pairs.col)))
    total = np.asarray(shares.sum(axis=1)).ravel()
    return csr_matrix(diags(1.0 / total) @ shares)


def at_corners(force: ndarray, shares: csr_matrix) -> ndarray:
    """Return forces and moments per length at the corners of triangles, (m, 3, 6).

    Membrane forces are constant and moments linear in a triangle.

    Parameters
    ----------
    force
        Forces of :class:`~.shell.ShellState`, (m, 15).
    shares
        Of :func:`averages`.
    """
    # A point stands for a third of the moments
    membrane = np.repeat(force[:, None, MEMBRANE], 3, axis=1)
    bending = 3.0 * _BY_MIDDLES @ force[:, BENDING].reshape(-1, 3, 3)
    values = np.concatenate((membrane, bending), axis=2)
    return np.asarray(shares @ values.reshape(-1, 6)).reshape(-1, 3, 6)
