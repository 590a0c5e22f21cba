"""Bodies for the stress tests: blocks above each other, in the plane and in space, and what their
contact carries.
"""

from __future__ import annotations

import numpy as np
from skfem import Basis

import skfem_contact as sc
from tests.tools import space
from tests.tools.helpers import grid, run_stages, traction, unknowns_of, vector_basis

#: The order of the residual that is left: far below the tolerances of the tests.
EXACT = sc.Newton(tolerance=1e-11, max_iterations=40)
#: What is called after every analysis with all that it was given, and its result: nothing, unless a
#: test asks for it.
afterwards: list = []
#: Elements along the lower and the upper block, by the number of dimensions.
_ELEMENTS = {2: (4, 5), 3: (2, 3)}


def blocks(
    n_lower: int | None = None,
    n_upper: int | None = None,
    gap: float = 0.0,
    overhang: float = 0.5,
    element: str = "Q1",
    mapped=None,
    dim: int = 2,
) -> Basis:
    """A unit block, "upper", above a wider one of height 1, "lower", whose top is at height 0."""
    meshes = {}
    for name, n, ends, bottom in (
        ("lower", n_lower or _ELEMENTS[dim][0], (-overhang, 1 + overhang), -1.0),
        ("upper", n_upper or _ELEMENTS[dim][1], (0.0, 1.0), gap),
    ):
        x = np.linspace(*ends, n + 1)
        height = np.linspace(bottom, bottom + 1, (n if dim == 2 else 2) + 1)
        mesh = grid(element, x, height) if dim == 2 else space.block(element, x, x, height)
        meshes[name] = mesh if mapped is None else mapped(mesh)
    return vector_basis(sc.join_bodies(meshes), element, intorder=2 if element == "Q1" else None)


def in_contact(
    basis: Basis, law=None, quadrature="nodal", E=(1e3, 1e3), nu: float = 0.3, **options
) -> dict:
    """The forms of two blocks."""
    materials = {"lower": sc.LinearElastic(E=E[0], nu=nu), "upper": sc.LinearElastic(E=E[1], nu=nu)}
    law = sc.Coulomb(0.3) if law is None else law
    return {
        "blocks": sc.SolidForm(basis, materials, "full"),
        "joint": sc.ContactPair(basis, "upper:bottom", "lower:top", law, quadrature, **options),
    }


def vector(basis: Basis, along_and_up) -> np.ndarray:
    """Components (dim,) of a vector (2,) in the plane of the first and the last axis."""
    return (
        np.array(along_and_up)
        if basis.mesh.dim() == 2
        else np.array([along_and_up[0], 0.0, along_and_up[1]])
    )


def displaced(basis: Basis, boundary: str, shift) -> np.ndarray:
    """Displacements that are a shift (2,) on one boundary and zero elsewhere."""
    x = basis.zeros()
    for k, part in enumerate(vector(basis, shift), 1):
        x[basis.get_dofs(boundary).all(f"u^{k}")] = part
    return x


def loaded(basis: Basis, boundary: str, force) -> np.ndarray:
    """Load vector of a uniform traction (2,), along and upwards."""
    return traction(basis, boundary, vector(basis, force))


def held(basis: Basis, *boundaries: str) -> np.ndarray:
    """All unknowns of boundaries."""
    return np.asarray(basis.get_dofs(set(boundaries)).all())


def guided(basis: Basis, *boundaries: str) -> np.ndarray:
    """Layout of columns that can move only upwards, and all of boundaries."""
    sides = [("left", "right"), ("front", "back")][: basis.mesh.dim() - 1]
    across = [
        basis.get_dofs({f"{body}:{side}" for body in ("lower", "upper") for side in pair}).all(
            f"u^{k}"
        )
        for k, pair in enumerate(sides, 1)
    ]
    return np.unique(np.concatenate((*across, held(basis, *boundaries))))


def force_on(forms: dict, stage, body: str = "upper") -> np.ndarray:
    """Resultant of the contact forces on a body, (dim,)."""
    basis = forms["blocks"].basis
    force = stage.forms["joint"].assemble(stage.x, stage.states["joint"]).force
    return -force[unknowns_of(basis, body)].sum(axis=0)


def along_and_up(forms: dict, stage) -> tuple[float, float]:
    """The same on the upper block: the first and the last component."""
    force = force_on(forms, stage)
    return float(force[0]), float(force[-1])


def run(forms: dict, stages, fixed, **options):
    """An analysis without a progress bar, to small residuals."""
    options = {"newton": EXACT, **options}
    result = run_stages(forms, stages, fixed, progress=False, **options)
    for look in afterwards:
        look(forms, stages, fixed, options, result)
    return result
