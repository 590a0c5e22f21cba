"""Fixed sparsity pattern, strain operators and batched kernels on top of a scikit-fem basis.

The tangent of a solid is ``sum_e B^T D B``.  Everything that does not change while Newton iterates is
computed once: the strain-displacement matrices, the sparse operator that maps stresses at all integration points
to forces, the pattern of the stiffness matrix and the slot that every entry of every element
matrix goes to.  An iteration then costs one batched ``matmul`` for the strain, one sparse product for the force
and one batched ``matmul`` over the elements whose tangent has changed.
"""
from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix
from skfem import CellBasis

_CHUNK = 512  # elements a batch: B, DB and BᵀDB of a batch stay in the processor's cache


class IncrementTooLarge(RuntimeError):
    """What a form's ``settle`` raises where it cannot tell what happened during an increment: it must be cut.

    Examples
    --------
    >>> from skfem_contact.assembly import IncrementTooLarge
    >>> issubclass(IncrementTooLarge, RuntimeError)
    True
    """


class Response:
    """What a form answers: the internal force and, when asked for, the candidate state and the tangent.

    Parameters
    ----------
    force
        Internal force, shape (N,).
    state
        Function that gives the state that holds once the step is accepted.
    stiffness
        Function that computes the tangent ``d force / d x``.
    damped
        Function that computes a matrix near the tangent with which Newton's method is less prone to stall; by
        default the tangent itself.
    round_off
        Norm of the forces that round-off may leave: equilibrium is not asked to be better.

    Notes
    -----
    The functions are called at the first access of :attr:`state`, :attr:`stiffness` and :attr:`damped` only, so
    that a line search pays for the force alone.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> from skfem_contact import Response
    >>> Response(np.zeros(2), lambda: None, lambda: csr_matrix(np.eye(2))).stiffness.shape
    (2, 2)
    """

    def __init__(self, force: ndarray, state: Callable[[], Any], stiffness: Callable[[], csr_matrix],
                 damped: Callable[[], csr_matrix] | None = None, round_off: float = 0.0) -> None:
        self.force, self.round_off = force, round_off
        self._state = state
        self._stiffness = stiffness
        self._damped = damped

    @cached_property
    def state(self) -> Any:
        """Candidate state; accepting a step is an assignment."""
        return self._state()

    @cached_property
    def stiffness(self) -> csr_matrix:
        """Tangent stiffness, a ``csr_matrix`` of shape (N, N)."""
        return self._stiffness()

    @cached_property
    def damped(self) -> csr_matrix:
        """The tangent, or a matrix near it with which Newton's method is less prone to stall."""
        return self.stiffness if self._damped is None else self._damped()


class StrainOperator(NamedTuple):
    """Strain-displacement matrices of all elements and the weights of their integration points.

    Attributes
    ----------
    B
        Shape (n_elements, n_points, 4, n_local_dofs); rows xx, yy, zz, xy (engineering shear). In three dimensions
        there are 6 rows: xx, yy, zz, xy, yz, zx.
    weight
        Quadrature weight times Jacobian (times the radius in axial symmetry), (n_elements, n_points).
    """

    B: ndarray
    weight: ndarray


def _gradients(basis: CellBasis) -> ndarray:
    """Gradients of the scalar shape functions, (n_elements, n_points, n_functions, dim)."""
    functions = [np.asarray(basis.basis[j][0].grad)[0] for j in range(0, basis.Nbfun, basis.mesh.dim())]
    return np.ascontiguousarray(np.stack(functions).transpose(2, 3, 0, 1))


def plane_strain(basis: CellBasis) -> StrainOperator:
    """Plane strain: the out-of-plane strain is zero, the out-of-plane stress is not.

    Parameters
    ----------
    basis
        Basis of a two-dimensional vector element.

    Examples
    --------
    >>> from skfem import Basis, ElementTriP1, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> sc.plane_strain(Basis(MeshTri(), ElementVector(ElementTriP1()))).B.shape[2:]
    (4, 6)
    """
    if basis.mesh.dim() != 2:
        raise ValueError(f"plane strain of a {type(basis.mesh).__name__}: for bodies in space pass "
                         "strain=three_dimensional")
    G = _gradients(basis)
    B = np.zeros((*G.shape[:2], 4, 2 * G.shape[2]))
    B[:, :, 0, 0::2] = B[:, :, 3, 1::2] = G[..., 0]
    B[:, :, 1, 1::2] = B[:, :, 3, 0::2] = G[..., 1]
    return StrainOperator(B, np.asarray(basis.dx))


def b_bar(basis: CellBasis) -> StrainOperator:
    """Plane or three-dimensional strains, the volumetric one averaged over each element (Hughes' B-bar).

    Fully integrated four-node quadrilaterals and eight-node hexahedra lock when the soil flows at constant volume;
    with the averaged volumetric strain they do not.  In plane strain the deviatoric part keeps its own out-of-plane
    component, so the out-of-plane strain is zero on average over an element only.

    Parameters
    ----------
    basis
        Basis of a vector element.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> operator = sc.b_bar(Basis(MeshQuad(), ElementVector(ElementQuad1()), intorder=2))
    >>> bool(abs(operator.B[:, :, :3].sum(axis=2).std(axis=1)).max() < 1e-14)   # one volume strain an element
    True
    """
    B, weight = plane_strain(basis) if basis.mesh.dim() == 2 else three_dimensional(basis)
    volumetric = B[:, :, :3].sum(axis=2)
    mean = np.einsum("eq,eqb->eb", weight, volumetric) / weight.sum(axis=1)[:, None]
    B[:, :, :3] += ((mean[:, None] - volumetric) / 3.0)[:, :, None]
    return StrainOperator(B, weight)


def axisymmetric(basis: CellBasis) -> StrainOperator:
    """Axial symmetry about x = 0: xx is radial, yy axial, and zz the hoop strain u_x / x; forces are per radian.

    Loads must be per radian too: boundary forces with the radius as a factor, and
    ``weight(..., axisymmetric=True)``. On the axis the radial displacement has to be fixed.

    Parameters
    ----------
    basis
        Basis of a two-dimensional vector element on a mesh with x >= 0.

    Raises
    ------
    ValueError
        Elements beyond the axis.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> operator = sc.axisymmetric(Basis(MeshQuad(), ElementVector(ElementQuad1()), intorder=2))
    >>> round(float(operator.weight.sum()), 9)       # half a unit of area: volume per radian
    0.5
    """
    radius = np.asarray(basis.global_coordinates())[0]
    if not (radius > 0.0).all():
        raise ValueError(f"axial symmetry needs x >= 0, but there are elements at x = {radius.min():.4g}")
    B, weight = plane_strain(basis)
    values = np.stack([np.asarray(basis.basis[j][0])[0] for j in range(0, basis.Nbfun, 2)])
    B[:, :, 2, 0::2] = (values / radius).transpose(1, 2, 0)
    return StrainOperator(B, weight * radius)


def three_dimensional(basis: CellBasis) -> StrainOperator:
    """Strains in three dimensions: xx, yy, zz, xy, yz, zx (engineering shears).

    Parameters
    ----------
    basis
        Basis of a vector element on tetrahedra or hexahedra.

    Raises
    ------
    ValueError
        A plane basis.

    Examples
    --------
    >>> from skfem import Basis, ElementHex1, ElementVector, MeshHex
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshHex().refined(1), ElementVector(ElementHex1()), intorder=2)
    >>> sc.three_dimensional(basis).B.shape
    (8, 8, 6, 24)
    """
    if basis.mesh.dim() != 3:
        raise ValueError(f"three_dimensional is for tetrahedra and hexahedra, not for a {type(basis.mesh).__name__}")
    G = _gradients(basis)
    B = np.zeros((*G.shape[:2], 6, 3 * G.shape[2]))
    B[:, :, 0, 0::3] = B[:, :, 3, 1::3] = B[:, :, 5, 2::3] = G[..., 0]
    B[:, :, 1, 1::3] = B[:, :, 3, 0::3] = B[:, :, 4, 2::3] = G[..., 1]
    B[:, :, 2, 2::3] = B[:, :, 4, 1::3] = B[:, :, 5, 0::3] = G[..., 2]
    return StrainOperator(B, np.asarray(basis.dx))


def strain_matrix(B: ndarray, element_dofs: ndarray, n: int) -> csr_matrix:
    """Sparse matrix that maps displacements (N,) to strains, rows ordered (ncomp, n_elements, n_points)."""
    n_elements, n_points = B.shape[:2]
    data, indices, counts = [], [], []
    for component in range(B.shape[2]):
        used = np.flatnonzero(B[:, :, component].any(axis=(0, 1)))
        data.append(B[:, :, component, used].ravel())
        columns = np.broadcast_to(element_dofs[used].T[:, None, :], (n_elements, n_points, len(used)))
        indices.append(columns.ravel())
        counts.append(np.full(n_elements * n_points, len(used)))
    indptr = np.concatenate(([0], np.cumsum(np.concatenate(counts))))
    shape = (B.shape[2] * n_elements * n_points, n)
    return csr_matrix((np.concatenate(data), np.concatenate(indices).astype(np.int32), indptr.astype(np.int32)),
                      shape=shape)


def force_matrix(strain_matrix: csr_matrix, weight: ndarray) -> csr_matrix:
    """Sparse matrix that maps stresses, ordered as the strains, to the internal force (N,): ``B^T`` times weights.

    Stored by rows, it multiplies a third faster than the transpose of the strain matrix would.
    """
    matrix = strain_matrix.T.tocsr()
    matrix.data *= np.tile(weight.ravel(), strain_matrix.shape[0] // weight.size)[matrix.indices]
    return matrix


def element_stiffness(B: ndarray, D: ndarray) -> ndarray:
    """``sum_q B^T D B`` of every element, (n_elements, n_local_dofs, n_local_dofs).

    ``B`` is (n_elements, n_points, ncomp, n_local_dofs); ``D`` (n_elements, n_points, ncomp, ncomp) carries
    the weights already.
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

    Built from the graph of the nodes, once; it does not depend on values.

    Attributes
    ----------
    indptr, indices
        The CSR pattern, sorted columns; read-only, since all matrices share it.
    slots
        (n_elements, n_local_dofs, n_local_dofs) positions in the CSR data.
    """

    indptr: ndarray
    indices: ndarray
    slots: ndarray

    @classmethod
    def of(cls, basis: CellBasis) -> Pattern:
        """Pattern of a basis whose displacement components follow each other node by node."""
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
        """Sum of element matrices as CSR data."""
        return np.bincount(self.slots[elements].ravel(), matrices.ravel(), minlength=len(self.indices))

    def matrix(self, data: ndarray) -> csr_matrix:
        """The ``csr_matrix`` with these data; the pattern is shared, not copied."""
        return with_data(self._empty, data)

    @cached_property
    def _empty(self) -> csr_matrix:
        """A matrix of this pattern without data."""
        n = len(self.indptr) - 1
        matrix = csr_matrix((n, n))
        matrix.indices, matrix.indptr = self.indices, self.indptr
        matrix.has_sorted_indices = matrix.has_canonical_format = True
        return matrix


def with_data(pattern: csr_matrix, data: ndarray) -> csr_matrix:
    """The matrix with other data; the pattern is shared and, as it is known to be sound, not looked at."""
    matrix = copy(pattern)
    matrix.data = data
    return matrix


def _frozen(numbers: ndarray) -> ndarray:
    frozen = numbers.astype(np.int32)
    frozen.flags.writeable = False
    return frozen
