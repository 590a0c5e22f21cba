"""Bodies for the stress tests: blocks above each other, and what their contact carries."""

from __future__ import annotations

import numpy as np
from helpers import grid, unknowns_of, vector_basis
from skfem import Basis

import skfem_contact as sc

#: The order of the residual that is left: far below the tolerances of the tests.
EXACT = sc.Newton(tolerance=1e-11, max_iterations=40)


def blocks(
    n_lower: int = 4, n_upper: int = 5, gap: float = 0.0, overhang: float = 0.5, element: str = "Q1", mapped=None
) -> Basis:
    """A unit block, "upper", above a wider one of height 1, "lower", whose top is y = 0."""
    meshes = {
        "lower": grid(element, np.linspace(-overhang, 1 + overhang, n_lower + 1), np.linspace(-1, 0, n_lower + 1)),
        "upper": grid(element, np.linspace(0, 1, n_upper + 1), np.linspace(gap, 1 + gap, n_upper + 1)),
    }
    if mapped is not None:
        meshes = {name: mapped(mesh) for name, mesh in meshes.items()}
    return vector_basis(sc.join_bodies(meshes), element, intorder=2 if element == "Q1" else None)


def in_contact(basis: Basis, law=None, quadrature="nodal", E=(1e3, 1e3), nu: float = 0.3, **options) -> dict:
    """The forms of two blocks."""
    materials = {"lower": sc.LinearElastic(E=E[0], nu=nu), "upper": sc.LinearElastic(E=E[1], nu=nu)}
    law = sc.Coulomb(0.3) if law is None else law
    return {
        "blocks": sc.SolidForm(basis, materials),
        "joint": sc.ContactPair(basis, "upper:bottom", "lower:top", law, quadrature, **options),
    }


def displaced(basis: Basis, boundary: str, shift) -> np.ndarray:
    """Displacements that are a shift on one boundary and zero elsewhere."""
    x = basis.zeros()
    dofs = basis.get_dofs(boundary)
    x[dofs.all("u^1")], x[dofs.all("u^2")] = shift
    return x


def force_on(forms: dict, stage, body: str = "upper") -> np.ndarray:
    """Resultant of the contact forces on a body, (2,)."""
    forms = sc.choose_penalties(forms)
    basis = forms["blocks"].basis
    force = forms["joint"].assemble(stage.x, stage.states["joint"]).force
    return -force[unknowns_of(basis, body)].sum(axis=0)


def run(forms: dict, stages, fixed, **options):
    """An analysis without a progress bar, to small residuals."""
    return sc.run(forms, stages, fixed, **{"newton": EXACT, "progress": False, **options})
