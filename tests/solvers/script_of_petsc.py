"""Script of the tests of PETSc, which mpiexec starts: loads by PETSc, and without it."""

import sys

import numpy as np
from skfem import Basis, ElementHex1, ElementQuad1, ElementVector, MeshHex, MeshQuad

import skfem_contact as sc

petsc = sc.Petsc()
if "wrong" in sys.argv:
    raise ValueError("a wrong script")


def load_of_footing(solver):
    """Force on a footing that is pressed into sand by 2 mm."""
    side = np.linspace(0.0, 1.0, 6)
    mesh = MeshHex.init_tensor(side, side, side).with_boundaries(
        {"footing": lambda x: (x[2] == 1.0) & (x[0] < 0.3) & (x[1] < 0.3)}
    )
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    sand = sc.MohrCoulomb(E=2e4, nu=0.3, c=5.0, phi=30.0, psi=5.0)
    foot = basis.get_dofs("footing").all("u^3")
    down = basis.zeros()
    down[foot] = -0.002
    model = sc.Model(
        {"sand": sc.SolidForm(basis, sand, strain="b_bar", unit_weight=20.0)},
        np.union1d(sc.box_supports(basis), foot),
        solver=solver,
    )
    result = model.run([sc.Stage("down", prescribed=down)], progress=False)
    return result[-1].reactions()[foot].sum()


def push_of_block(solver):
    """Force that moves a block sideways by 1 mm on another one, with friction."""
    lower = MeshQuad.init_tensor(np.linspace(0.0, 2.0, 9), np.linspace(0.0, 0.5, 3))
    upper = MeshQuad.init_tensor(np.linspace(0.5, 1.5, 6), np.linspace(0.5, 1.0, 3))
    mesh = sc.join_bodies({"lower": lower.with_defaults(), "upper": upper.with_defaults()})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=0.4)),
    }
    top = basis.get_dofs("upper:top").all()
    moved = basis.zeros()
    moved[basis.get_dofs("upper:top").all("u^1")] = 0.001
    moved[basis.get_dofs("upper:top").all("u^2")] = -0.002
    fixed = np.union1d(basis.get_dofs("lower:bottom").all(), top)
    model = sc.Model(forms, fixed, solver=solver)
    result = model.run([sc.Stage("push", prescribed=moved)], progress=False)
    return result[-1].reactions()[top].sum()


for load in (load_of_footing, push_of_block):
    print(load(petsc), load(None))
