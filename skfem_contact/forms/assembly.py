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
from typing import Literal, NamedTuple, cast

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix
from skfem import CellBasis, ElementHex1, ElementQuad1

from ..errors import Remark
from ..materials.spectral import principal_stresses
from ..sparse import constant, with_data
from .base import Coordinates

#: Strain measures.
Measure = Literal["full", "b_bar", "f_bar"]
#: Share of the symmetric companion in a damped tangent: more of it makes Newton's method slow, less
#: lets it stall.
_DAMPING = 0.2
#: Poisson's ratio from which elements of corner nodes alone are remarked on: triangles under a
#: strip as wide as four of them settle by 4, 10, 16, 23 and 49 % too little at .40, .48, .49, .495
#: and .499.
_TIGHT = 0.485
#: Mean stresses that swing in elements, over the largest shear stresses: 9 and 33 on slopes of clay
#: of 60 degrees, 12 and 10 % too strong, with 2 and 4 ElementQuad2 of nine points along them, and a
#: million in a ring of straight sides, whose pressure has no limit; .15 with ElementQuadS2 of four
#: points, .3 in a ring of sand that does not dilate, 1.5 below a rough strip in rectangles. Of a
#: strip of rubber that is bent to half a circle, 30 in ElementQuad2 whose moment is 32 % too high,
#: 8 for 7 % in ElementTriP2 of six points.
SWING = 4.0
#: Shear stress as a share of the mean stress that is round-off.
_NO_SHEAR = 1e-9
#: Elements of a batch: its B, DB and BᵀDB stay in the processor's cache.
_CHUNK = 512


class StrainOperator(NamedTuple):
    """Strain-displacement matrices of all elements and the weights of their integration points.

    Attributes
    ----------
    B
        Shape (n_elements, n_points, 4, n_local_dofs); rows xx, yy, zz, xy (engineering shear). In
        space 6 rows: xx, yy, zz, xy, yz, zx.
    weight
        Quadrature weight times Jacobian (times the radius in axial symmetry), (n_elements,
        n_points).
    """

    B: ndarray
    weight: ndarray


def strain_of(
    basis: CellBasis,
    strain: str | None,
    coordinates: str | None,
    flows: bool,
    kinematics: str = "small",
) -> tuple[Measure, Coordinates]:
    """Return strain measure and coordinate system as given, or as suits mesh and material.

    Raises
    ------
    ValueError
        Other words, axial symmetry of a mesh in space, B-bar in axial symmetry or with finite
        kinematics, F-bar with small ones or of other elements than Quad1 and Hex1.
    """
    system = _coordinates_of(basis, coordinates)
    if kinematics not in ("small", "finite"):
        raise ValueError(f"kinematics must be 'small' or 'finite', not {kinematics!r}")
    element = getattr(basis.elem, "elem", basis.elem)  # flow has elements without components
    corners = isinstance(element, (ElementQuad1, ElementHex1))
    if kinematics == "finite":
        return _finite_strain(strain, flows and corners, corners), system
    return _small_strain(strain, flows and corners, system == "axisymmetric"), system


def _small_strain(strain: str | None, locks: bool, axial: bool) -> Measure:
    """Return the measure of small strains: B-bar by default where full strains would lock."""
    if strain == "f_bar":
        raise ValueError("strain 'f_bar' needs kinematics='finite'; take 'full' or 'b_bar'")
    if strain not in (None, "full", "b_bar"):
        raise ValueError(f"strain must be 'full' or 'b_bar', not {strain!r}")
    if axial and strain == "b_bar":
        raise ValueError(
            "there is no strain 'b_bar' in axial symmetry: take elements of second order"
        )
    if strain is not None:
        return cast(Measure, strain)
    if locks and not axial:
        return "b_bar"
    return "full"


def _coordinates_of(basis: CellBasis, given: str | None) -> Coordinates:
    """Return the coordinate system as given, or the first one that suits the mesh."""
    known = {2: ("plane", "axisymmetric"), 3: ("space",)}[basis.mesh.dim()]
    coordinates = known[0] if given is None else given
    if coordinates not in known:
        raise ValueError(
            f"coordinates of a {type(basis.mesh).__name__} must be "
            f"{' or '.join(map(repr, known))}, not {given!r}"
        )
    return cast(Coordinates, coordinates)


def _finite_strain(strain: str | None, locks: bool, corners: bool) -> Measure:
    """Return the strain measure of finite kinematics, by default F-bar where elements lock."""
    if strain is None:
        if locks:
            return "f_bar"
        return "full"
    if strain == "b_bar":
        raise ValueError("strain 'b_bar' is of small kinematics: take strain='f_bar'")
    if strain not in ("full", "f_bar"):
        raise ValueError(f"strain must be 'full' or 'f_bar', not {strain!r}")
    if strain == "f_bar" and not corners:
        raise ValueError(
            "strain 'f_bar' is for ElementQuad1 and ElementHex1: other elements take 'full'"
        )
    return cast(Measure, strain)


def strain_operator(basis: CellBasis, strain: str, coordinates: str) -> StrainOperator:
    """Return the operator of a strain measure in a coordinate system."""
    builders = {"plane": _plane_strain, "axisymmetric": _axisymmetric, "space": _in_space}
    full = builders[coordinates](basis)
    if strain == "b_bar":
        return _b_bar(*full)
    return full


def has_corners_only(basis: CellBasis) -> bool:
    """Return True for elements whose only nodes are their corners."""
    return basis.Nbfun == basis.mesh.dim() * len(basis.mesh.t)


def locking(
    basis: CellBasis,
    coordinates: Coordinates | None,
    yielded: float,
    D: ndarray,
    finite: bool,
) -> Iterator[Remark]:
    """Yield remarks on elements of corner nodes alone, with full strains, that may lock.

    Parameters
    ----------
    yielded
        Share of the points that yield.
    D : ndarray, shape (n_elements, r, r)
        Moduli in the rows of the strain operator that act, shear last.
    finite
        True for finite kinematics.
    """
    if not has_corners_only(basis):
        return
    # Say what to take instead: B-bar and F-bar exist for quadrilaterals and hexahedra.
    dim = basis.mesh.dim()
    instead = "take elements of second order"
    if len(basis.mesh.t) == 2**dim and finite:
        instead = 'take strain="f_bar", or elements of second order'
    elif coordinates == "axisymmetric":
        instead = "take ElementTriP2 or ElementQuadS2 with intorder=2"
    elif len(basis.mesh.t) == 2**dim:
        instead = 'take strain="b_bar", or elements of second order'
    if yielded:
        yield Remark(
            "locking",
            yielded,
            f"{yielded:.1%} of the points yield in elements of corner nodes alone, too stiff and "
            f"too strong where soil flows (collapse loads are 10 to 20 % too high): {instead}",
        )
    # nu = lambda / (2 (lambda + G))
    lame = D[:, 0, 1]
    shear = D[:, -1, -1]
    nu = float((0.5 * lame / (lame + shear)).max())
    if nu > _TIGHT:
        yield Remark(
            "volume",
            nu,
            f"Poisson's ratio is {nu:.4g}, of undrained ground that of soil and water: elements "
            "of corner nodes alone lock, settlements may be a few times too small and pressures "
            f"too large: {instead}",
        )


def swing(basis: CellBasis, stress: ndarray, weight: ndarray, yields: bool = False) -> float:
    """Return mean stresses, less their linear part in elements, over the largest shear stresses.

    Both are averages with a weight, (n_elements, n_points). Shear stresses far below the mean ones
    are round-off and the result zero, unless it is known that the material yields there.
    """
    # Subtract the linear part of the mean stresses in each element.
    mean = stress[:3].mean(axis=0)
    at = basis.X
    linear = np.column_stack((np.ones(at.shape[1]), at.T))
    rest = mean - mean @ (linear @ np.linalg.pinv(linear)).T
    # Compare the rest with the largest shear stresses.
    largest, _, smallest = principal_stresses(stress)
    shear = 0.5 * (weight * (largest - smallest)).sum()
    least = 0.0 if yields else _NO_SHEAR * (weight * np.abs(mean)).sum()
    if shear <= least:
        return 0.0
    return float((weight * np.abs(rest)).sum() / shear)


def locked(basis: CellBasis, times: float) -> str:
    """Return a message about elements that lock, in which mean stresses swing."""
    return (
        f"{type(basis.elem.elem).__name__} of {basis.X.shape[1]} points, which lock: mean stresses "
        f"swing within elements by {times:.2g} times the shear stress"
    )


def shape_gradients(basis: CellBasis) -> ndarray:
    """Return gradients of the scalar shape functions, (n_elements, n_points, n_functions, dim)."""
    functions = basis.basis[:: basis.mesh.dim()]
    gradients = [np.asarray(field.grad)[0] for (field,) in functions]  # (dim, elements, points)
    return np.ascontiguousarray(np.stack(gradients).transpose(2, 3, 0, 1))


def _plane_strain(basis: CellBasis) -> StrainOperator:
    """Return plane strains: the out-of-plane strain is zero, the out-of-plane stress is not."""
    G = shape_gradients(basis)
    B = np.zeros((*G.shape[:2], 4, 2 * G.shape[2]))
    B[:, :, 0, 0::2] = G[..., 0]  # xx
    B[:, :, 1, 1::2] = G[..., 1]  # yy
    B[:, :, 3, 0::2] = G[..., 1]  # xy
    B[:, :, 3, 1::2] = G[..., 0]
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
    change = (mean[:, None] - volumetric) / 3.0
    B[:, :, :3] += change[:, :, None]
    return StrainOperator(B, weight)


def _axisymmetric(basis: CellBasis) -> StrainOperator:
    """Return strains in axial symmetry about x = 0, with weights per radian.

    The component xx is radial, yy axial, and zz the hoop strain u_x / x.
    """
    radius = np.asarray(basis.global_coordinates())[0]
    if not (radius > 0.0).all():
        raise ValueError(
            f"axial symmetry needs x >= 0, but there are elements at x = {radius.min():.4g}"
        )
    # The strains of the plane, and the hoop strain N / r.
    B, weight = _plane_strain(basis)
    values = np.stack([np.asarray(field)[0] for (field,) in basis.basis[::2]])
    B[:, :, 2, 0::2] = (values / radius).transpose(1, 2, 0)
    return StrainOperator(B, weight * radius)


def _in_space(basis: CellBasis) -> StrainOperator:
    """Return strains of tetrahedra and hexahedra: xx, yy, zz, xy, yz, zx (engineering shears)."""
    G = shape_gradients(basis)
    B = np.zeros((*G.shape[:2], 6, 3 * G.shape[2]))
    # Normal strains u_i,i, and shears u_i,j + u_j,i.
    for i in range(3):
        B[:, :, i, i::3] = G[..., i]
    for row, (i, j) in enumerate(((0, 1), (1, 2), (2, 0)), start=3):
        B[:, :, row, i::3] = G[..., j]
        B[:, :, row, j::3] = G[..., i]
    return StrainOperator(B, np.asarray(basis.dx))


def force_matrix(B: ndarray, weight: ndarray, element_dofs: ndarray, n: int) -> csr_matrix:
    """Return the matrix from stresses (ncomp, n_elements, n_points) to internal forces, (n,).

    Its entries are ``B^T`` times weights. Stored by rows, it multiplies a third faster than the
    transpose of the matrix of the strains.
    """
    data = []
    indices = []
    counts = []
    # Collect weight B by component, without columns of zeros.
    for component in range(B.shape[2]):
        rows = B[:, :, component]
        used = np.flatnonzero(rows.any(axis=(0, 1)))
        dofs = element_dofs[used].T[:, None, :]
        data.append((rows[..., used] * weight[..., None]).ravel())
        indices.append(np.broadcast_to(dofs, (*weight.shape, len(used))).ravel())
        counts.append(np.full(weight.size, len(used)))
    # The rows of the transpose are stresses.
    indptr = np.concatenate(([0], np.cumsum(np.concatenate(counts))))
    entries = (
        np.concatenate(data),
        np.concatenate(indices).astype(np.int32),
        indptr.astype(np.int32),
    )
    return csc_matrix(entries, shape=(n, len(indptr) - 1)).tocsr()


def element_stiffness(B: ndarray, D: ndarray) -> ndarray:
    """Compute ``sum_q B^T D B`` of every element, (n_elements, n_local_dofs, n_local_dofs).

    ``B`` is (n_elements, n_points, ncomp, n_local_dofs); ``D`` (n_elements, n_points, ncomp, ncomp)
    holds the weights.
    """
    n_elements, n_points, ncomp, n_local = B.shape
    K = np.empty((n_elements, n_local, n_local))
    for start in range(0, n_elements, _CHUNK):
        batch = slice(start, start + _CHUNK)
        # Stack the points of an element: the sum over them becomes one matrix product.
        flat = B[batch].reshape(-1, n_points * ncomp, n_local)
        DB = np.matmul(D[batch], B[batch]).reshape(flat.shape)
        np.matmul(flat.transpose(0, 2, 1), DB, out=K[batch])
    return K


@dataclass(frozen=True)
class Pattern:
    """Sparsity pattern of a basis, and the slots of all element matrices in its CSR data.

    Attributes
    ----------
    indptr, indices
        CSR pattern with sorted columns; read-only, since all matrices share it.
    slots : ndarray, shape (n_elements, n_local_dofs, n_local_dofs)
        Positions in the CSR data.
    dim
        Number of displacement components of a node.
    """

    indptr: ndarray
    indices: ndarray
    slots: ndarray
    dim: int

    @classmethod
    def of(cls, basis: CellBasis) -> Pattern:
        """Build the pattern of a basis whose displacement components follow node by node."""
        d = basis.mesh.dim()
        n_nodes = basis.N // d
        nodes = basis.element_dofs[::d].T // d
        n_elements, n_local = nodes.shape

        # find the pattern of the nodes, and the slot of every pair of nodes of an element in it
        rows = np.repeat(nodes, n_local, axis=1).ravel()
        columns = np.tile(nodes, (1, n_local)).ravel()
        ones = np.ones(len(rows), dtype=np.int8)
        graph = coo_matrix((ones, (rows, columns)), shape=(n_nodes, n_nodes)).tocsr()
        graph.sort_indices()
        ptr = graph.indptr.astype(np.int64)
        degree = np.diff(ptr)
        row = np.repeat(np.arange(n_nodes, dtype=np.int64), degree)
        keys = row * n_nodes + graph.indices
        wanted = rows.astype(np.int64) * n_nodes + columns
        entry = np.searchsorted(keys, wanted)

        # a node pair (r, c) becomes a d x d block: d rows of d degree(r) entries each
        first = d * d * ptr[rows] + d * (entry - ptr[rows])
        row_length = d * degree[rows, None, None]
        i = np.arange(d)
        block = first[:, None, None] + i[:, None] * row_length + i  # (n_pairs, d, d)
        slots = block.reshape(n_elements, n_local, n_local, d, d)
        slots = slots.transpose(0, 1, 3, 2, 4).astype(np.int32, order="C")
        slots = slots.reshape(n_elements, d * n_local, d * n_local)

        # repeat the columns of a node in its d rows
        length = np.repeat(d * degree, d)
        indptr = np.concatenate(([0], np.cumsum(length)))
        dofs = d * graph.indices[:, None] + i
        start = np.repeat(d * ptr[:-1], d)
        start_of_row = np.repeat(indptr[:-1], length)
        within = np.arange(indptr[-1]) - start_of_row
        indices = dofs.ravel()[np.repeat(start, length) + within]
        return cls(_frozen(indptr), _frozen(indices), slots, d)

    def scatter(self, matrices: ndarray, elements: ndarray | slice = slice(None)) -> ndarray:
        """Sum element matrices as CSR data."""
        slots = self.slots[elements].ravel()
        return np.bincount(slots, matrices.ravel(), minlength=len(self.indices))

    def scatter_by_components(self, matrices: ndarray) -> ndarray:
        """Sum element matrices of other axes as CSR data.

        Their shape is (n_elements, n_nodes, d, d, n_nodes): node and component of the rows,
        component and node of the columns.
        """
        return np.bincount(self._by_components, matrices.ravel(), minlength=len(self.indices))

    @cached_property
    def _by_components(self) -> ndarray:
        """Slots of such matrices."""
        n_elements, n_local, _ = self.slots.shape
        d = self.dim
        slots = self.slots.reshape(n_elements, n_local // d, d, n_local // d, d)
        return np.ascontiguousarray(slots.transpose(0, 1, 2, 4, 3)).ravel()

    def matrix(self, data: ndarray) -> csr_matrix:
        """Return the ``csr_matrix`` of these data, read-only; the pattern is shared, not copied."""
        return constant(with_data(self._empty, data))

    @cached_property
    def _empty(self) -> csr_matrix:
        """Matrix of this pattern without data."""
        n = len(self.indptr) - 1
        matrix = csr_matrix((n, n))
        matrix.indices = self.indices
        matrix.indptr = self.indptr
        matrix.has_sorted_indices = True
        matrix.has_canonical_format = True
        return matrix


def _frozen(numbers: ndarray) -> ndarray:
    """Return a read-only copy of 32 bits."""
    frozen = numbers.astype(np.int32)
    frozen.flags.writeable = False
    return frozen


def damped(tangent: ndarray, elasticity: ndarray) -> ndarray:
    r"""Move tangents of non-associated flow towards a symmetric and positive neighbour.

    :math:`D = D_e P` with a projector P along the plastic flow. Its companion
    :math:`P^T D_e P = D^T D_e^{-1} D` resists all strains but the same flow, and is symmetric. All
    arrays have the shape (n, ncomp, ncomp).
    """
    # Find the tangents that are not symmetric.
    difference = tangent - tangent.transpose(0, 2, 1)
    skew = np.abs(difference).max(axis=(1, 2))
    size = np.abs(elasticity).max(axis=(1, 2))
    skewed = np.flatnonzero(skew > 1e-9 * size)
    D = tangent[skewed]
    # Move them by a share towards D^T D_e^-1 D, which is symmetric and positive.
    companion = D.transpose(0, 2, 1) @ np.linalg.solve(elasticity[skewed], D)
    new = tangent.copy()
    new[skewed] += _DAMPING * (companion - D)
    return new
