"""Small scenes that tests of several rooms share."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
from skfem import (
    Basis,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.results import StageResult
from tests.tools.helpers import grid, vector_basis


def block_on_base(shift=0.0, stretch=1.0):
    """A block that rests on another one."""
    base = grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 1, 3))
    block = grid("Q1", np.linspace(1, 3, 6), np.linspace(1, 2, 3))
    mesh = (
        sc.join_bodies({"base": base, "block": block})
        .scaled((1.0, stretch))
        .translated((shift, 0.0))
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(basis, "block:bottom", "base:top", sc.Coulomb(0.4), quadrature=2),
    }
    return (
        basis,
        forms,
        sc.weight(basis, {"base": 0.0, "block": 20.0}),
        basis.get_dofs("base:bottom").all(),
    )


def pit():
    """Model of a pit of 2 m, and its stages: water, other strengths and another support come and
    stay.
    """
    mesh = (
        MeshTri.init_tensor(np.linspace(0, 8, 9), np.linspace(-4, 0, 5))
        .with_defaults()
        .with_subdomains(
            {
                "ground": lambda x: (x[0] > 3) | (x[1] < -2),
                "pit": lambda x: (x[0] < 3) & (x[1] > -2),
            }
        )
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=20.0, phi=20.0, psi=20.0)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), soil, unit_weight=18.0)
        for name in ("ground", "pit")
    }
    model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=10.0)
    weak = {
        name: form.with_materials({"all": replace(soil, c=10.0)}) for name, form in forms.items()
    }
    edge = sc.dofs_at(basis, (3.0, 0.0))
    top = model.traction("top", lambda x: np.stack((0.0 * x[0], -20.0 * (x[0] > 4.0))))
    return (
        model,
        weak,
        [
            sc.Stage("dug", deactivate="pit", water=-3.5),
            sc.Stage("weak", change=weak),
            sc.Stage("held", fixed=[model.fixed, edge]),
            sc.Stage("loaded", top),
        ],
    )


def sliding_blocks(gap: float, lower, upper, law: sc.Coulomb | None) -> tuple[dict, np.ndarray]:
    """A block of 4 m above a base that is held, with a joint or without."""
    base = MeshTri.init_tensor(np.linspace(0, 8, 9), np.linspace(-1, 0, 2)).with_defaults()
    block = MeshTri.init_tensor(np.linspace(2, 6, 6), np.linspace(gap, 1 + gap, 2)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementTriP2()), intorder=2
    )
    forms = {
        "base": sc.SolidForm(basis.with_elements("base"), lower),
        "block": sc.SolidForm(basis.with_elements("block"), upper),
    }
    if law is not None:
        forms["joint"] = sc.ContactPair(basis, "block:bottom", "base:top", law, "nodal")
    return forms, basis.get_dofs("base:bottom").all()


def disc(width=1.0, n=5):
    """A disc of height 1 between smooth walls, and the fixed dofs."""
    mesh = MeshQuad.init_tensor(np.linspace(0, width, n), np.linspace(0, 1, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    return basis, np.append(
        basis.get_dofs("bottom").all("u^2"), basis.get_dofs({"left", "right"}).all("u^1")
    )


def halves(right: float = 1.0):
    """Basis of two bodies, "l" and "r", of which the second begins at an abscissa."""
    side = np.linspace(0.0, 1.0, 3)
    mesh = sc.join_bodies({"l": grid("Q1", side, side), "r": grid("Q1", right + side, side)})
    return vector_basis(mesh, "Q1", intorder=2)


def layer_with_water(n: int = 8):
    """A layer with a basis, its solid and its water."""
    mesh = MeshTri.init_tensor(
        np.linspace(0, 4, 2 * n + 1), np.linspace(-2, 0, n + 1)
    ).with_defaults()
    mesh = mesh.with_subdomains({"left": lambda x: x[0] < 2, "right": lambda x: x[0] > 2})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    clay = sc.SolidForm(basis, sc.LinearElastic(E=8e3, nu=0.3))
    return basis, clay, sc.PoreWater(basis, permeability=2e-4, unit_weight=9.81)


def remarked(forms, stage, fixed) -> tuple[StageResult, str]:
    """A stage, and what is warned of of it."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = sc.Model(forms, fixed).run([stage], progress=False)
    return result[0], "; ".join(str(warning.message) for warning in caught)
