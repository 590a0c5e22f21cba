"""The matrix of the normal equations: a stiffness matrix of elements, factored by the package's engines."""
from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..solvers.direct import Engine
from ..solvers.pardiso import Pardiso
from ..solvers.superlu import SuperLU

#: Shares of the diagonal that are added, one after the other, until the matrix has a factor: equations of the lower
#: bound depend on each other where two straight lines cross at a node.
_SHIFTS = (1e-14, 1e-11, 1e-8)


class Block(NamedTuple):
    """Operators of equal shape: B (n, n_points, 3, n_local), its points (n, n_points) and unknowns (n, n_local).

    An unknown of -1 is none.
    """

    B: ndarray
    points: ndarray
    dofs: ndarray


class NormalMatrix:
    """Sum of B^T D B over all points, for many D (n_points, 3, 3): pattern and order are found once.

    Parameters
    ----------
    blocks
        Operators.
    places
        Where the unknowns live, (2, m).
    """

    def __init__(self, blocks: list[Block], places: ndarray) -> None:
        self.blocks, n = blocks, places.shape[1]
        pairs = [np.broadcast_arrays(b.dofs[:, :, None], b.dofs[:, None, :]) for b in blocks]
        rows, columns = (np.concatenate([pair[i].ravel() for pair in pairs]) for i in (0, 1))
        self._kept = np.flatnonzero((rows >= 0) & (columns >= 0))
        rows, columns = rows[self._kept], columns[self._kept]
        graph = csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, n))
        self._engine = _engine()
        self._order = self._engine.order(graph, places)
        rank = np.empty(n, np.int64)
        rank[self._order] = np.arange(n)
        key, self._slot = np.unique(rank[rows] * n + rank[columns], return_inverse=True)
        row, column = np.divmod(key, n)
        self._indices = column.astype(np.int32)
        self._indptr = np.searchsorted(row, np.arange(n + 1)).astype(np.int32)
        self._diagonal = np.flatnonzero(row == column)

    def factor(self, D: ndarray) -> Callable[[ndarray], ndarray]:
        """Solution of (sum of B^T D B) y = b for any b (m,); ArithmeticError where there is no factor."""
        data = np.bincount(self._slot, self._stiffness(D).take(self._kept), len(self._indices))
        if not np.isfinite(data).all():
            raise ArithmeticError("the normal matrix is not finite")
        diagonal = data[self._diagonal]
        for shift in _SHIFTS:
            data[self._diagonal] = diagonal * (1.0 + shift)
            matrix = csr_matrix((data, self._indices, self._indptr), shape=2 * (len(self._order),))
            try:
                inverse = self._engine.factor(matrix, symmetric=True)
            except RuntimeError:
                continue
            return lambda b: self._back(inverse(np.ascontiguousarray(b[self._order])))
        raise ArithmeticError("the normal matrix is singular")

    def _back(self, x: ndarray) -> ndarray:
        y = np.empty_like(x)
        y[self._order] = x
        return y

    def _stiffness(self, D: ndarray) -> ndarray:
        """Entries of all elements, one after the other."""
        entries = []
        for B, points, dofs in self.blocks:
            n, width = dofs.shape
            flat = B.reshape(n, -1, width)
            DB = np.matmul(D[points], B).reshape(n, -1, width)
            entries.append(np.matmul(flat.transpose(0, 2, 1), DB).ravel())
        return np.concatenate(entries)


def _engine() -> Engine:
    """The fastest engine that is installed."""
    try:
        return Pardiso()
    except ImportError:
        return SuperLU()
