"""Assembly of solids: strain operators, sparsity pattern and batched kernels on a scikit-fem basis.

The tangent of a solid is ``sum_e B^T D B``. Everything that does not change in Newton's iterations
is computed once: strain-displacement matrices, the sparse operator from stresses to forces, the
pattern of the stiffness matrix, and the slots of all element matrices. An iteration then costs one
batched ``matmul`` for the strain, one sparse product for the force, and one batched ``matmul`` over
the elements whose tangent has changed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix
from skfem import CellBasis, ElementHex1, ElementQuad1

from ..errors import Remark
from ..sparse import constant, with_data
from .base import Coordinates

#: Strain measures.
Measure = Literal["full", "b_bar"]
#: Share of the symmetric companion in a damped tangent: more of it makes Newton's method slow, less
#: lets it stall.
_DAMPING = 0.2
#: Poisson's ratio from which elements of corner nodes alone are remarked on: triangles under a
#: strip as wide as four of them settle by 4, 10, 16, 23 and 49 % too little at .40, .48, .49, .495
#: and .499.
_TIGHT = 0.485
_CHUNK = 512  # elements a batch: B, DB and BᵀDB of a batch stay in the processor's cache


class StrainOperator(NamedTuple):
    """Strain-displacement matrices of all elements and the weights of their integration points.

    Attributes
    ----------
    B
        Shape (n_elements, n_points, 4, n_local_dofs); rows xx, yy, zz, xy (engineering shear). In
        space there are 6 rows: xx, yy, zz, xy, yz, zx.
    weight
        Quadrature weight times Jacobian (times the radius in axial symmetry), (n_elements,
        n_points).
    """

    B: ndarray
    weight: ndarray


def strain_of(
    basis: CellBasis, strain: str | None, coordinates: str | None, flows: bool
) -> tuple[Measure, Coordinates]:
    """Return strain measure and coordinate system as given, or those that suit mesh and material.

    Raises
    ------
    ValueError
        Other words, axial symmetry of a mesh in space, or B-bar in axial symmetry.
    """
    usual: Coordinates = "plane" if basis.mesh.dim() == 2 else "space"
    known = ("plane", "axisymmetric") if usual == "plane" else ("space",)
    if coordinates is not None and coordinates not in known:
        raise ValueError(
            f"coordinates of a {type(basis.mesh).__name__} must be "
            f"{' or '.join(map(repr, known))}, not "
            f"{coordinates!r}"
        )
    if strain not in (None, "full", "b_bar"):
        raise ValueError(f"strain must be 'full' or 'b_bar', not {strain!r}")
    axial = coordinates == "axisymmetric"
    if axial and strain == "b_bar":
        raise ValueError(
            "there is no strain 'b_bar' in axial symmetry: take elements of second order"
        )
    usually = flows and not axial and isinstance(basis.elem.elem, (ElementQuad1, ElementHex1))
    averaged = strain == "b_bar" or (strain is None and usually)
    return "b_bar" if averaged else "full", "axisymmetric" if axial else usual


def strain_operator(basis: CellBasis, strain: str, coordinates: str) -> StrainOperator:
    """Return the operator of a strain measure in a coordinate system."""
    full = {"plane": _plane_strain, "axisymmetric": _axisymmetric, "space": _in_space}[coordinates](
        basis
    )
    return full if strain == "full" else _b_bar(*full)


def has_corners_only(basis: CellBasis) -> bool:
    """Return True for elements whose only nodes are their corners."""
    return basis.Nbfun == basis.mesh.dim() * len(basis.mesh.t)


def locking(
    basis: CellBasis, coordinates: Coordinates | None, yielded: float, D: ndarray
) -> Iterator[Remark]:
    """Yield remarks on elements of corner nodes alone with full strains: a share of points yields,
    or D resists volume.

    `D` : ndarray, shape (n_elements, r, r), are moduli in the rows of the strain operator that act,
    shear last.
    """
    if not has_corners_only(basis):
        return
    averaged = len(basis.mesh.t) == 2 ** basis.mesh.dim() and coordinates != "axisymmetric"
    instead = ('take strain="b_bar", or ' if averaged else "take ") + "elements of second order"
    if yielded:
        yield Remark(
            "locking",
            yielded,
            f"{yielded:.1%} of the points yield in elements of corner nodes alone, too "
            f"stiff and too strong where soil flows (collapse loads are 10 to 20 % too high): "
            f"{instead}",
        )
    if (nu := float((0.5 * D[:, 0, 1] / (D[:, 0, 1] + D[:, -1, -1])).max())) > _TIGHT:
        yield Remark(
            "volume",
            nu,
            f"Poisson's ratio is {nu:.4g}, of undrained ground that of soil and water: elements "
            "of corner nodes alone lock, settlements may be a few times too small and pressures "
            "too large: " + instead,
        )


def _gradients(basis: CellBasis) -> ndarray:
    """Return gradients of the scalar shape functions, (n_elements, n_points, n_functions, dim)."""
    functions = [
        np.asarray(basis.basis[j][0].grad)[0] for j in range(0, basis.Nbfun, basis.mesh.dim())
    ]
    return np.ascontiguousarray(np.stack(functions).transpose(2, 3, 0, 1))


def _plane_strain(basis: CellBasis) -> StrainOperator:
    """Return plane strains: the out-of-plane strain is zero, the out-of-plane stress is not."""
    G = _gradients(basis)
    B = np.zeros((*G.shape[:2], 4, 2 * G.shape[2]))
    B[:, :, 0, 0::2] = B[:, :, 3, 1::2] = G[..., 0]
    B[:, :, 1, 1::2] = B[:, :, 3, 0::2] = G[..., 1]
    return StrainOperator(B, np.asarray(basis.dx))


def _b_bar(B: ndarray, weight: ndarray) -> StrainOperator:
    """Average the volumetric strain over each element (Hughes' B-bar).

    Fully integrated four-node quadrilaterals and eight-node hexahedra lock when the soil flows at
    constant volume; with the averaged volumetric strain they do not. In plane strain the deviatoric
    part keeps its own out-of-plane component, so that the out-of-plane strain is zero on average
    over an element only.
    """
    volumetric = B[:, :, :3].sum(axis=2)
    mean = np.einsum("eq,eqb->eb", weight, volumetric) / weight.sum(axis=1)[:, None]
    B[:, :, :3] += ((mean[:, None] - volumetric) / 3.0)[:, :, None]
    return StrainOperator(B, weight)


def _axisymmetric(basis: CellBasis) -> StrainOperator:
    """Return strains in axial symmetry about x = 0: xx is radial, yy axial, zz the hoop strain u_x
    / x; per radian.
    """
    radius = np.asarray(basis.global_coordinates())[0]
    if not (radius > 0.0).all():
        raise ValueError(
            f"axial symmetry needs x >= 0, but there are elements at x = {radius.min():.4g}"
        )
    B, weight = _plane_strain(basis)
    values = np.stack([np.asarray(basis.basis[j][0])[0] for j in range(0, basis.Nbfun, 2)])
    B[:, :, 2, 0::2] = (values / radius).transpose(1, 2, 0)
    return StrainOperator(B, weight * radius)


def _in_space(basis: CellBasis) -> StrainOperator:
    """Return strains of tetrahedra and hexahedra: xx, yy, zz, xy, yz, zx (engineering shears)."""
    G = _gradients(basis)
    B = np.zeros((*G.shape[:2], 6, 3 * G.shape[2]))
    B[:, :, 0, 0::3] = B[:, :, 3, 1::3] = B[:, :, 5, 2::3] = G[..., 0]
    B[:, :, 1, 1::3] = B[:, :, 3, 0::3] = B[:, :, 4, 2::3] = G[..., 1]
    B[:, :, 2, 2::3] = B[:, :, 4, 1::3] = B[:, :, 5, 0::3] = G[..., 2]
    return StrainOperator(B, np.asarray(basis.dx))


def force_matrix(B: ndarray, weight: ndarray, element_dofs: ndarray, n: int) -> csr_matrix:
    """Return the matrix from stresses (ncomp, n_elements, n_points) to internal forces (n,):
    ``B^T`` times weights.

    Stored by rows, it multiplies a third faster than the transpose of the matrix of the strains.
    """
    data, indices, counts = [], [], []
    for component in range(B.shape[2]):
        used = np.flatnonzero(B[:, :, component].any(axis=(0, 1)))
        data.append((B[:, :, component, used] * weight[..., None]).ravel())
        indices.append(
            np.broadcast_to(element_dofs[used].T[:, None, :], (*weight.shape, len(used))).ravel()
        )
        counts.append(np.full(weight.size, len(used)))
    indptr = np.concatenate(([0], np.cumsum(np.concatenate(counts))))
    columns = csc_matrix(
        (np.concatenate(data), np.concatenate(indices).astype(np.int32), indptr.astype(np.int32)),
        shape=(n, len(indptr) - 1),
    )
    return columns.tocsr()


def element_stiffness(B: ndarray, D: ndarray) -> ndarray:
    """Compute ``sum_q B^T D B`` of every element, (n_elements, n_local_dofs, n_local_dofs).

    ``B`` is (n_elements, n_points, ncomp, n_local_dofs); ``D`` (n_elements, n_points, ncomp, ncomp)
    holds the weights.
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
    """Sparsity pattern of a basis and the slot of every entry of every element matrix in its CSR
    data.

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
        """Build the pattern of a basis whose displacement components follow each other node by
        node.
        """
        d = basis.mesh.dim()
        nodes = basis.element_dofs[0::d].T // d
        n_elements, n_local = nodes.shape
        n_nodes = basis.N // d
        rows = np.repeat(nodes, n_local, axis=1).ravel()
        columns = np.tile(nodes, (1, n_local)).ravel()
        graph = coo_matrix(
            (np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(n_nodes, n_nodes)
        ).tocsr()
        graph.sort_indices()
        ptr = graph.indptr.astype(np.int64)
        degree = np.diff(ptr)
        keys = np.repeat(np.arange(n_nodes, dtype=np.int64), degree) * n_nodes + graph.indices
        entry = np.searchsorted(keys, rows.astype(np.int64) * n_nodes + columns)

        # a node pair (r, c) becomes a d x d block: d rows of d degree(r) entries each
        first = d * d * ptr[rows] + d * (entry - ptr[rows])
        block = (
            first[:, None, None]
            + np.arange(d)[:, None] * d * degree[rows, None, None]
            + np.arange(d)
        )
        slots = block.reshape(n_elements, n_local, n_local, d, d).transpose(0, 1, 3, 2, 4)

        length = np.repeat(d * degree, d)  # of the rows
        indptr = np.concatenate(([0], np.cumsum(length)))
        pairs = (d * graph.indices[:, None] + np.arange(d)).ravel()
        within = np.arange(indptr[-1]) - np.repeat(indptr[:-1], length)
        indices = pairs[np.repeat(np.repeat(d * ptr[:-1], d), length) + within]
        return cls(
            _frozen(indptr),
            _frozen(indices),
            slots.astype(np.int32, order="C").reshape(n_elements, d * n_local, d * n_local),
        )

    def scatter(self, matrices: ndarray, elements: ndarray | slice = slice(None)) -> ndarray:
        """Sum element matrices as CSR data."""
        return np.bincount(
            self.slots[elements].ravel(), matrices.ravel(), minlength=len(self.indices)
        )

    def matrix(self, data: ndarray) -> csr_matrix:
        """Return the ``csr_matrix`` of these data, read-only; the pattern is shared, not copied."""
        return constant(with_data(self._empty, data))

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
    r"""Move tangents of non-associated flow, (n, ncomp, ncomp), towards a symmetric and positive
    neighbour.

    :math:`D = D_e P` with a projector P along the plastic flow. Its companion
    :math:`P^T D_e P = D^T D_e^{-1} D` resists all strains but the same flow, and is symmetric.
    """
    skew = np.abs(tangent - tangent.transpose(0, 2, 1)).max(axis=(1, 2))
    at = np.flatnonzero(skew > 1e-9 * np.abs(elasticity).max(axis=(1, 2)))
    new = tangent.copy()
    companion = tangent[at].transpose(0, 2, 1) @ np.linalg.solve(elasticity[at], tangent[at])
    new[at] += _DAMPING * (companion - tangent[at])
    return new
