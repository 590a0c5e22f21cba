"""Fixed sparsity pattern, strain operators and batched kernels on top of a scikit-fem basis.

The tangent of a solid is ``sum_e B^T D B``. Everything that does not change in Newton's iterations is computed once:
strain-displacement matrices, the sparse operator from stresses to forces, the pattern of the stiffness matrix, and the
slots of all element matrices. An iteration then costs one batched ``matmul`` for the strain, one sparse product for the
force, and one batched ``matmul`` over the elements whose tangent has changed.
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix
from skfem import CellBasis

from ..sparse import with_data

#: Share of the symmetric companion in a damped tangent: more of it makes Newton's method slow, less lets it stall.
_DAMPING = 0.2
_CHUNK = 512  # elements a batch: B, DB and BᵀDB of a batch stay in the processor's cache


def force_matrix(B: ndarray, weight: ndarray, element_dofs: ndarray, n: int) -> csr_matrix:
    """Return the matrix from stresses (ncomp, n_elements, n_points) to internal forces (n,): ``B^T`` times weights.

    Stored by rows, it multiplies a third faster than the transpose of the matrix of the strains.
    """
    data, indices, counts = [], [], []
    for component in range(B.shape[2]):
        used = np.flatnonzero(B[:, :, component].any(axis=(0, 1)))
        data.append((B[:, :, component, used] * weight[..., None]).ravel())
        indices.append(np.broadcast_to(element_dofs[used].T[:, None, :], (*weight.shape, len(used))).ravel())
        counts.append(np.full(weight.size, len(used)))
    indptr = np.concatenate(([0], np.cumsum(np.concatenate(counts))))
    columns = csc_matrix((np.concatenate(data), np.concatenate(indices).astype(np.int32), indptr.astype(np.int32)),
                         shape=(n, len(indptr) - 1))
    return columns.tocsr()


def element_stiffness(B: ndarray, D: ndarray) -> ndarray:
    """Compute ``sum_q B^T D B`` of every element, (n_elements, n_local_dofs, n_local_dofs).

    ``B`` is (n_elements, n_points, ncomp, n_local_dofs); ``D`` (n_elements, n_points, ncomp, ncomp) holds the weights.
    """
    n_elements, n_points, ncomp, n_local = B.shape
    K = np.empty((n_elements, n_local, n_local))
    for start in range(0, n_elements, _CHUNK):
        part = slice(start, start + _CHUNK)
        flat = B[part].reshape(-1, n_points * ncomp, n_local)
        DB = np.matmul(D[part], B[part]).reshape(flat.shape)
        np.matmul(flat.transpose(0, 2, 1), DB, out=K[part])
    return K


@dataclass(frozen=True)
class Pattern:
    """Sparsity pattern of a basis and the slot of every entry of every element matrix in its CSR data.

    Attributes
    ----------
    indptr, indices
        CSR pattern with sorted columns; read-only, since all matrices share it.
    slots : ndarray, shape (n_elements, n_local_dofs, n_local_dofs)
        Positions in the CSR data.
    """

    indptr: ndarray
    indices: ndarray
    slots: ndarray

    @classmethod
    def of(cls, basis: CellBasis) -> Pattern:
        """Build the pattern of a basis whose displacement components follow each other node by node."""
        d = basis.mesh.dim()
        nodes = basis.element_dofs[0::d].T // d
        n_elements, n_local = nodes.shape
        n_nodes = basis.N // d
        rows = np.repeat(nodes, n_local, axis=1).ravel()
        columns = np.tile(nodes, (1, n_local)).ravel()
        graph = coo_matrix((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(n_nodes, n_nodes)).tocsr()
        graph.sort_indices()
        ptr = graph.indptr.astype(np.int64)
        degree = np.diff(ptr)
        keys = np.repeat(np.arange(n_nodes, dtype=np.int64), degree) * n_nodes + graph.indices
        entry = np.searchsorted(keys, rows.astype(np.int64) * n_nodes + columns)

        # a node pair (r, c) becomes a d x d block: d rows of d degree(r) entries each
        first = d * d * ptr[rows] + d * (entry - ptr[rows])
        block = first[:, None, None] + np.arange(d)[:, None] * d * degree[rows, None, None] + np.arange(d)
        slots = block.reshape(n_elements, n_local, n_local, d, d).transpose(0, 1, 3, 2, 4)

        length = np.repeat(d * degree, d)  # of the rows
        indptr = np.concatenate(([0], np.cumsum(length)))
        pairs = (d * graph.indices[:, None] + np.arange(d)).ravel()
        within = np.arange(indptr[-1]) - np.repeat(indptr[:-1], length)
        indices = pairs[np.repeat(np.repeat(d * ptr[:-1], d), length) + within]
        return cls(_frozen(indptr), _frozen(indices), slots.astype(np.int32, order="C").reshape(
            n_elements, d * n_local, d * n_local))

    def scatter(self, matrices: ndarray, elements: ndarray | slice = slice(None)) -> ndarray:
        """Sum element matrices as CSR data."""
        return np.bincount(self.slots[elements].ravel(), matrices.ravel(), minlength=len(self.indices))

    def matrix(self, data: ndarray) -> csr_matrix:
        """Return the ``csr_matrix`` of these data; the pattern is shared, not copied."""
        return with_data(self._empty, data)

    @cached_property
    def _empty(self) -> csr_matrix:
        """Matrix of this pattern without data."""
        n = len(self.indptr) - 1
        matrix = csr_matrix((n, n))
        matrix.indices, matrix.indptr = self.indices, self.indptr
        matrix.has_sorted_indices = matrix.has_canonical_format = True
        return matrix


def _frozen(numbers: ndarray) -> ndarray:
    frozen = numbers.astype(np.int32)
    frozen.flags.writeable = False
    return frozen


def damped(tangent: ndarray, elasticity: ndarray) -> ndarray:
    r"""Move tangents of non-associated flow, (n, ncomp, ncomp), towards a symmetric and positive neighbour.

    :math:`D = D_e P` with a projector P along the plastic flow. Its companion :math:`P^T D_e P = D^T D_e^{-1} D`
    resists all strains but the same flow, and is symmetric.
    """
    skew = np.abs(tangent - tangent.transpose(0, 2, 1)).max(axis=(1, 2))
    at = np.flatnonzero(skew > 1e-9 * np.abs(elasticity).max(axis=(1, 2)))
    new = tangent.copy()
    companion = tangent[at].transpose(0, 2, 1) @ np.linalg.solve(elasticity[at], tangent[at])
    new[at] += _DAMPING * (companion - tangent[at])
    return new
