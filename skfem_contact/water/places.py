"""Values of a field of the nodes at any place."""
from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem import Mesh

from ..errors import place

#: Corners of the triangles of a quadrilateral and of the tetrahedra of a hexahedron, as in scikit-fem.
_PARTS = {(2, 3): ((0, 1, 2),), (2, 4): ((0, 1, 3), (1, 2, 3)), (3, 4): ((0, 1, 2, 3),),
          (3, 8): ((0, 1, 3, 4), (0, 3, 2, 4), (2, 3, 4, 6), (3, 4, 6, 7), (3, 4, 5, 7), (1, 3, 4, 5))}
#: So far outside of an element, in its own size, a place is inside by round-off; and so far beside its straight sides
#: where the sides of the mesh are curved.
_ROUND_OFF, _CURVED = 1e-9, 0.1
#: Elements that are tried, those with the nearest centres first: graded meshes have many near ones.
_TRIED = (8, 64, 512)


def simplices(mesh: Mesh, elements: ndarray) -> ndarray:
    """Triangles or tetrahedra that elements consist of, (dim + 1, n)."""
    t = mesh.t[:, elements]
    return np.hstack([t[list(part)] for part in _PARTS[mesh.dim(), len(t)]])


class Interpolation:
    """A field of the nodes, linear on the triangles or tetrahedra that the elements consist of."""

    def __init__(self, mesh: Mesh, elements: ndarray, values: ndarray) -> None:
        self._values, self._corners = values, simplices(mesh, elements)
        p = mesh.p[:, self._corners]
        self._origin = p[:, 0]
        self._inverse = np.linalg.inv((p[:, 1:] - p[:, :1]).transpose(2, 0, 1))
        self._tree = cKDTree(p.mean(axis=1).T)

    def __call__(self, x: ndarray) -> ndarray:
        """Values at places (dim, ...); ValueError for one that lies outside."""
        points = x.reshape(len(x), -1)
        result, lost = np.empty(points.shape[1]), np.arange(points.shape[1])
        for tried in (*(n for n in _TRIED if n < len(self._inverse)), len(self._inverse)):
            outside, values = self._among(points[:, lost], tried)
            found = outside <= (_ROUND_OFF if tried < _TRIED[-1] and tried < len(self._inverse) else _CURVED)
            result[lost[found]] = values[found]
            lost = lost[~found]
            if len(lost) == 0:
                return result.reshape(x.shape[1:])
        raise ValueError(f"{len(lost)} places lie outside of the porous ground, "
                         f"the first is {place(points[:, lost[0]])}")

    def _among(self, x: ndarray, tried: int) -> tuple[ndarray, ndarray]:
        """How far places lie outside of the best of the elements with the nearest centres, and the values there."""
        near = self._tree.query(x.T, tried)[1].reshape(x.shape[1], -1)
        outside, values = np.full(x.shape[1], np.inf), np.empty(x.shape[1])
        for candidate in near.T:
            local = np.einsum("nij,jn->in", self._inverse[candidate], x - self._origin[:, candidate])
            weights = np.vstack((1.0 - local.sum(axis=0), local))
            better = -weights.min(axis=0) < outside
            outside[better] = -weights.min(axis=0)[better]
            values[better] = (weights * self._values[self._corners[:, candidate]]).sum(axis=0)[better]
        return outside, values
