"""A slope that goes on for ever: a parallelogram whose sides are tied to each other."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import Basis

import skfem_contact as sc
from tests.tools.helpers import Springs, grid, vector_basis

BETA, DEPTH, GAMMA = 20.0, 3.0, 18.0


def ties(one: ndarray, other: ndarray, stiffness: float, n: int) -> Springs:
    """Stiff springs between pairs of unknowns."""
    ones, pairs = np.ones(len(one)), np.arange(len(one))
    stretch = csr_matrix(
        (np.append(ones, -ones), (np.append(pairs, pairs), np.append(one, other))), (len(one), n)
    )
    return Springs((stiffness * stretch.T @ stretch).tocsr())


def infinite_slope(
    soil: sc.MohrCoulomb, rows: int = 12, element: str = "Q2"
) -> tuple[Basis, dict, ndarray, ndarray]:
    """Basis, forms, fixed unknowns and weight of a layer on an inclined base; rows shrink towards
    the base.
    """
    heights = DEPTH * np.expm1(3.0 * np.linspace(0, 1, rows + 1)) / np.expm1(3.0)
    mesh = grid(element, np.array([0.0, 0.5]), heights)
    places = mesh.p.copy()
    places[1] += np.tan(np.radians(-BETA)) * places[0]
    mesh = type(mesh)(places, mesh.t).with_boundaries(mesh.boundaries)
    basis = vector_basis(mesh, element, intorder=4 if element != "Q1" else 2)
    tied = []
    for side in ("left", "right"):
        dofs = np.setdiff1d(basis.get_dofs(side).all(), basis.get_dofs("bottom").all())
        tied.append(dofs[np.lexsort((np.round(basis.doflocs[1, dofs], 9), dofs % 2))])
    forms = {
        "soil": sc.SolidForm(basis, soil, "b_bar" if element == "Q1" else "full"),
        "ties": ties(*tied, 1e3 * soil.E, basis.N),
    }
    return basis, forms, basis.get_dofs("bottom").all(), sc.weight(basis, GAMMA)
