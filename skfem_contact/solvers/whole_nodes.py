"""Blocks of stiffness by whole nodes, with the rigid motions of bodies, for multigrid."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import bsr_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from ..layout import rigid_modes
from ..sparse import FreeBlock, with_data
from .direct import SingularSystem


class WholeNodes:
    """Block of K of all nodes with free dofs; their prescribed dofs keep the diagonal alone.

    Parameters
    ----------
    locations, free
        See :class:`DirectSolver`; the dofs are numbered by nodes.
    parts
        Slabs of equally many nodes, cut across the longest side of the mesh, by which the nodes
        are ordered.
    dim
        Dofs of a node, by default one for each axis; with 1 the block is that of the free dofs.
    """

    def __init__(
        self,
        locations: ndarray,
        free: ndarray,
        *,
        parts: int = 1,
        dim: int | None = None,
    ) -> None:
        self.dim = dim or len(locations)
        self._locations = locations
        nodes = np.unique(np.asarray(free) // self.dim)
        nodes = nodes[_slabs(locations[:, self.dim * nodes], parts)]
        self.dofs = (self.dim * nodes[:, None] + np.arange(self.dim)).ravel()
        self.fixed = ~np.isin(self.dofs, free)
        self._block = FreeBlock(self.dofs)
        self._couplings: tuple[ndarray, ndarray] | None = None
        self._order: tuple[ndarray, bsr_matrix] | None = None

    def gather(self, K: csr_matrix) -> csr_matrix:
        """Return the block of K, without all but the diagonal of prescribed dofs."""
        A = self._block.gather(K)
        if not np.isfinite(A.data).all():
            raise ValueError("the stiffness has entries that are not finite")
        if self._couplings is None or self._couplings[0] is not A.indices:
            row = np.repeat(np.arange(A.shape[0]), np.diff(A.indptr))
            fixed = self.fixed[row] | self.fixed[A.indices]
            self._couplings = A.indices, fixed & (row != A.indices)
        A.data[self._couplings[1]] = 0.0
        loose = np.flatnonzero(A.diagonal() == 0.0)
        if len(loose):
            raise SingularSystem(
                f"{len(loose)} dofs meet no stiffness, the first is {self.dofs[loose[0]]}",
                self.dofs[loose],
            )
        return A

    def taken(self, b: ndarray) -> ndarray:
        """Return the entries of b (N,) at the dofs of the block, zero where prescribed."""
        return np.where(self.fixed, 0.0, b[self.dofs])

    def placed(self, x: ndarray, size: int) -> ndarray:
        """Return x at its dofs among all, (N,), without the round-off at prescribed ones."""
        placed = np.zeros(size)
        placed[self.dofs] = x
        placed[self.dofs[self.fixed]] = 0.0
        return placed

    def blocks(self, A: csr_matrix) -> bsr_matrix:
        """Return the block of K in blocks of nodes; the order of its entries is kept."""
        if self._order is None or self._order[0] is not A.indices:
            numbers = with_data(A, np.arange(1, A.nnz + 1))
            self._order = A.indices, numbers.tobsr(2 * (self.dim,))
        order = self._order[1]
        data = np.append(0.0, A.data).take(order.data)
        return bsr_matrix((data, order.indices, order.indptr), shape=A.shape)

    def rigid_modes(self, blocks: bsr_matrix) -> tuple[ndarray, int]:
        """Return the rigid motions of all bodies, (n, 3) or (n, 6), and the number of bodies."""
        graph = csr_matrix((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr))
        count, body = connected_components(graph, directed=False)
        body = np.repeat(body, self.dim)
        modes = np.empty((len(body), self.dim * (self.dim + 1) // 2))
        for number in range(count):
            modes[body == number] = rigid_modes(self._locations, self.dofs[body == number])
        modes[self.fixed] = 0.0
        return modes, count


def _slabs(points: ndarray, parts: int) -> ndarray:
    """Return an order of points (dim, n) by slabs, and within them as they are."""
    n = points.shape[1]
    if parts == 1 or n == 0:
        return np.arange(n)
    longest = int(np.argmax(np.ptp(points, axis=1)))
    slab = np.empty(n, int)
    slab[np.argsort(points[longest], kind="stable")] = parts * np.arange(n) // n
    return np.argsort(slab, kind="stable")
