"""Strain operators: strains at the integration points from displacements."""
from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis, ElementHex1, ElementQuad1

#: Coordinate systems.
Coordinates = Literal["plane", "axisymmetric", "space"]
#: Strain measures.
Measure = Literal["full", "b_bar"]


class StrainOperator(NamedTuple):
    """Strain-displacement matrices of all elements and the weights of their integration points.

    Attributes
    ----------
    B
        Shape (n_elements, n_points, 4, n_local_dofs); rows xx, yy, zz, xy (engineering shear). In space there are
        6 rows: xx, yy, zz, xy, yz, zx.
    weight
        Quadrature weight times Jacobian (times the radius in axial symmetry), (n_elements, n_points).
    """

    B: ndarray
    weight: ndarray


def strain_of(basis: CellBasis, strain: str | None, coordinates: str | None, flows: bool
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
        raise ValueError(f"coordinates of a {type(basis.mesh).__name__} must be {' or '.join(map(repr, known))}, not "
                         f"{coordinates!r}")
    if strain not in (None, "full", "b_bar"):
        raise ValueError(f"strain must be 'full' or 'b_bar', not {strain!r}")
    axial = coordinates == "axisymmetric"
    if axial and strain == "b_bar":
        raise ValueError("there is no strain 'b_bar' in axial symmetry: take elements of second order")
    averaged = strain == "b_bar" or (strain is None and flows and not axial and has_corners_only(basis))
    return "b_bar" if averaged else "full", "axisymmetric" if axial else usual


def strain_operator(basis: CellBasis, strain: str, coordinates: str) -> StrainOperator:
    """Return the operator of a strain measure in a coordinate system."""
    full = {"plane": _plane_strain, "axisymmetric": _axisymmetric, "space": _in_space}[coordinates](basis)
    return full if strain == "full" else _b_bar(*full)


def has_corners_only(basis: CellBasis) -> bool:
    """Return True for quadrilaterals of four nodes and hexahedra of eight."""
    return isinstance(basis.elem.elem, (ElementQuad1, ElementHex1))


def _gradients(basis: CellBasis) -> ndarray:
    """Return gradients of the scalar shape functions, (n_elements, n_points, n_functions, dim)."""
    functions = [np.asarray(basis.basis[j][0].grad)[0] for j in range(0, basis.Nbfun, basis.mesh.dim())]
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

    Fully integrated four-node quadrilaterals and eight-node hexahedra lock when the soil flows at constant volume;
    with the averaged volumetric strain they do not. In plane strain the deviatoric part keeps its own out-of-plane
    component, so that the out-of-plane strain is zero on average over an element only.
    """
    volumetric = B[:, :, :3].sum(axis=2)
    mean = np.einsum("eq,eqb->eb", weight, volumetric) / weight.sum(axis=1)[:, None]
    B[:, :, :3] += ((mean[:, None] - volumetric) / 3.0)[:, :, None]
    return StrainOperator(B, weight)


def _axisymmetric(basis: CellBasis) -> StrainOperator:
    """Return strains in axial symmetry about x = 0: xx is radial, yy axial, zz the hoop strain u_x / x; per radian."""
    radius = np.asarray(basis.global_coordinates())[0]
    if not (radius > 0.0).all():
        raise ValueError(f"axial symmetry needs x >= 0, but there are elements at x = {radius.min():.4g}")
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


def plane_strain(basis: CellBasis) -> StrainOperator:
    """Return plane strains."""
    return strain_operator(basis, "full", "plane")


def axisymmetric(basis: CellBasis) -> StrainOperator:
    """Return strains in axial symmetry."""
    return strain_operator(basis, "full", "axisymmetric")
