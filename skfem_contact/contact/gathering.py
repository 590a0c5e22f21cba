"""Sums of what contact points contribute to the unknowns."""
from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..assembly import with_data


class Gathering:
    """Forces and tangents of points, added up; places in the matrix are found anew only for points on other nodes.

    Parameters
    ----------
    n
        Number of unknowns.

    Examples
    --------
    >>> import numpy as np
    >>> two_points = np.array([[0, 1], [1, -1]])      # -1: a rigid obstacle has no unknowns
    >>> gathering = Gathering(3)
    >>> gathering.force(two_points, np.ones((2, 2))).tolist()
    [1.0, 2.0, 0.0]
    >>> gathering.matrix(two_points, np.ones((2, 2, 2))).toarray()
    array([[1., 1., 0.],
           [1., 2., 0.],
           [0., 0., 0.]])
    """

    def __init__(self, n: int) -> None:
        self._n = n
        self._dofs: ndarray | None = None

    def force(self, dofs: ndarray, forces: ndarray) -> ndarray:
        """Sum of the points' forces, (n_points, m), on their unknowns, (n_points, m)."""
        moving = dofs >= 0
        return np.bincount(dofs[moving], forces[moving], minlength=self._n)

    def matrix(self, dofs: ndarray, matrices: ndarray) -> csr_matrix:
        """Sum of the points' matrices, (n_points, m, m)."""
        if self._dofs is None or not np.array_equal(dofs, self._dofs):
            self._find(dofs)
        data = np.bincount(self._slots, matrices[self._moving], minlength=len(self._pattern.indices))
        return with_data(self._pattern, data)

    def _find(self, dofs: ndarray) -> None:
        rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
        self._dofs, self._moving = dofs, (rows >= 0) & (columns >= 0)
        row = rows[self._moving].astype(np.int64)  # scikit-fem counts in 32 bits, too few for the product
        entries, self._slots = np.unique(row * self._n + columns[self._moving], return_inverse=True)
        row, column = np.divmod(entries, self._n)
        self._pattern = csr_matrix((np.ones(len(row)), (row, column)), shape=(self._n, self._n))
