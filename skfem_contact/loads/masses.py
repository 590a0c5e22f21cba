"""Matrices of masses, times the acceleration of gravity."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array
from skfem import CellBasis

from ..layout import elements_of
from .vectors import by_element


def weight_matrix(body: Any, factors: ndarray, consistent: bool) -> csr_matrix:
    """Return the matrix of masses times the acceleration of gravity, (N, N).

    Parameters
    ----------
    body
        Solid form with a unit weight.
    factors : ndarray, shape (n_elements,)
        Factors of the elements.
    consistent
        False for scaled diagonals of the consistent matrix (Hinton, Rock and Zienkiewicz 1976),
        which are positive for elements of second order too.
    """
    basis = body.basis
    dim = basis.mesh.dim()
    elements = elements_of(basis)
    density = factors * by_element(basis.mesh, body.unit_weight)[elements]

    # Integrate products of shape functions exactly on straight elements
    has_corners_only = basis.Nbfun == dim * len(basis.mesh.t)
    order = 4
    if has_corners_only:
        order = 2
    fine = CellBasis(
        basis.mesh,
        basis.elem,
        mapping=basis.mapping,
        intorder=order,
        elements=elements,
        dofs=basis.dofs,
    )
    volume = fine.dx * density[:, None]
    if body.coordinates == "axisymmetric":
        volume = volume * np.asarray(fine.global_coordinates())[0]
    shapes = []
    for (function,) in fine.basis[::dim]:
        values = np.asarray(function)[0]
        shapes.append(values.reshape(-1, volume.shape[1])[0])
    N = np.array(shapes)  # (n_nodes, n_points)
    nodes = basis.element_dofs[::dim]  # dofs of the first component

    if not consistent:
        # m_i = M_ii / sum_j M_jj times the mass of the element
        diagonal = np.einsum("iq,iq,eq->ie", N, N, volume)
        share = diagonal / np.where(density > 0.0, diagonal.sum(axis=0), 1.0)
        masses = share * volume.sum(axis=1)
        at_nodes = np.bincount(nodes.ravel(), masses.ravel(), minlength=basis.N)
        values = np.zeros(basis.N)
        for c in range(dim):
            values += np.roll(at_nodes, c)
        return csr_matrix(diags_array(values))

    # M_ij = integral of N_i N_j for each component
    blocks = np.einsum("iq,jq,eq->ije", N, N, volume)
    rows = np.broadcast_to(nodes[:, None], blocks.shape).ravel()
    columns = np.broadcast_to(nodes[None], blocks.shape).ravel()
    data = blocks.ravel()
    total = csr_matrix((basis.N, basis.N))
    for c in range(dim):
        entries = data, (rows + c, columns + c)
        total = total + coo_matrix(entries, shape=(basis.N, basis.N)).tocsr()
    return csr_matrix(total)
