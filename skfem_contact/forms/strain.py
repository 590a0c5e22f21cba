"""Strain operators: what a displacement strains at every integration point."""
from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis, ElementHex1, ElementQuad1


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


def strain_of(basis: CellBasis, flows: bool) -> Callable[[CellBasis], StrainOperator]:
    """The strain operator that suits an element: :func:`b_bar` where it would lock as a material flows, or plain.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> basis = Basis(MeshQuad(), ElementVector(ElementQuad1()), intorder=2)
    >>> strain_of(basis, flows=True) is b_bar, strain_of(basis, flows=False) is plane_strain
    (True, True)
    """
    if flows and has_corners_only(basis):
        return b_bar
    return plane_strain if basis.mesh.dim() == 2 else three_dimensional


def has_corners_only(basis: CellBasis) -> bool:
    """Whether the elements are quadrilaterals of four nodes, or hexahedra of eight."""
    return isinstance(basis.elem.elem, (ElementQuad1, ElementHex1))


def _gradients(basis: CellBasis) -> ndarray:
    """Gradients of the scalar shape functions, (n_elements, n_points, n_functions, dim)."""
    functions = [np.asarray(basis.basis[j][0].grad)[0] for j in range(0, basis.Nbfun, basis.mesh.dim())]
    return np.ascontiguousarray(np.stack(functions).transpose(2, 3, 0, 1))


def plane_strain(basis: CellBasis) -> StrainOperator:
    """Plane strain of a plane vector element: the out-of-plane strain is zero, the out-of-plane stress is not.

    Examples
    --------
    >>> from skfem import Basis, ElementTriP1, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> "full"(Basis(MeshTri(), ElementVector(ElementTriP1()))).B.shape[2:]
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

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> operator = "b_bar"(Basis(MeshQuad(), ElementVector(ElementQuad1()), intorder=2))
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

    Raises
    ------
    ValueError
        A basis in space, or elements beyond the axis.

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
    """Strains of tetrahedra and hexahedra: xx, yy, zz, xy, yz, zx (engineering shears).

    Raises
    ------
    ValueError
        A plane basis.

    Examples
    --------
    >>> from skfem import Basis, ElementHex1, ElementVector, MeshHex
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshHex().refined(1), ElementVector(ElementHex1()), intorder=2)
    >>> "full"(basis).B.shape
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
