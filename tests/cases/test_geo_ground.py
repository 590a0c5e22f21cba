"""Ground at rest, silos and strips: cases J9, K1, K4 and a hydrostatic check of the water loads."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import FacetBasis, LinearForm

import skfem_contact as sc
from skfem_contact.contact.penalty import choose_penalties
from tests.tools.helpers import grid, vector_basis

QUIET = {"progress": False}
PENALTY = 1e9


def silo(mu: float):
    """An elastic column, 2 x 6, between two rigid walls that touch it; forms, load, fixed unknowns,
    basis.
    """
    basis = vector_basis(grid("Q2", np.linspace(0, 2, 5), np.linspace(0, 6, 13)), "Q2", intorder=4)
    walls = {
        "left": sc.rigid.line((0.0, 7.0), (0.0, -1.0)),
        "right": sc.rigid.line((2.0, -1.0), (2.0, 7.0)),
    }
    forms = {"column": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.3))}
    for side, wall in walls.items():
        forms[side] = sc.ContactPair(
            basis, side, wall, sc.Coulomb(mu=mu), quadrature=3, penalty=PENALTY
        )
    return basis, forms, sc.weight(basis, 20.0), basis.get_dofs("bottom").all("u^2")


def middle(basis) -> np.ndarray:
    """One node on the axis held aside, so that nothing floats."""
    return basis.nodal_dofs[0, (basis.mesh.p[0] == 1) & (basis.mesh.p[1] == 0)]


def test_smooth_silo():
    """[X] Case J9: between smooth rigid walls the ratio of the stresses is nu / (1 - nu).

    The walls are springs of the penalty k per area, in series with half the column, of stiffness E
    / (1 - nu^2) per width 1: the pressure is 1 / (1 + E / ((1 - nu^2) k)) of that between rigid
    walls, 1.1e-4 less.
    """
    basis, forms, load, fixed = silo(0.0)
    step = sc.Model(forms, np.append(fixed, middle(basis))).run(
        [sc.Stage("gravity", load)], **QUIET
    )["gravity"]
    stress = step.states["column"].stress
    y = np.asarray(basis.global_coordinates())[1]
    series = 1 + 1e5 / (1 - 0.3**2) / PENALTY
    # beside the base the column cannot follow the walls: a share of the 1.1e-4 of the largest
    # pressure, 51
    np.testing.assert_allclose(stress[1], -20 * (6 - y), atol=0.005)
    np.testing.assert_allclose(stress[0], -3 / 7 * 20 * (6 - y) / series, atol=0.005)
    skin = step.tractions("left")
    assert (skin.weight * skin.pressure).sum() == pytest.approx(3 / 7 * 20 * 18 / series, rel=1e-6)


@pytest.mark.parametrize("mu", [0.1, 0.3])
def test_rough_silo(mu):
    """[X] Case J9: friction on the walls and the base bear the weight together, exactly; the base
    less than all.
    """
    basis, forms, load, fixed = silo(mu)
    step = sc.Model(forms, np.append(fixed, middle(basis))).run(
        [sc.Stage("gravity", load, None, 4)], **QUIET
    )["gravity"]
    pairs = choose_penalties(forms)
    vertical = np.arange(basis.N) % 2 == 1
    forces = {name: form.assemble(step.x, step.states[name]).force for name, form in pairs.items()}
    friction = -sum(
        forces[side][vertical].sum() for side in ("left", "right")
    )  # on the column, downwards negative
    base = (sum(forces.values()) - load)[fixed].sum()
    assert friction > 0.05 * 240
    assert base + friction == pytest.approx(240.0, rel=1e-7)
    for side in ("left", "right"):
        skin = step.states[side]
        assert (np.abs(skin.traction[1]) <= mu * np.abs(skin.traction[0]) * (1 + 1e-9)).all()


def test_strip_load_on_a_half_plane():
    """[X] Case K4: stresses below a strip, with the exact displacements of the half-plane far away:
    here its stresses.

    The mesh ends where the half-plane's stresses act on it as loads; one node and a rotation are
    held.
    """
    a, q = 2.0, 100.0
    x = np.concatenate(
        (np.linspace(-8, -2, 13), np.linspace(-2, 2, 17)[1:-1], np.linspace(2, 8, 13))
    )
    mesh = grid("Q2", x, np.linspace(-8, 0, 17)).with_boundaries(
        {"strip": lambda p: (p[1] > -1e-9) & (abs(p[0]) < a)}
    )
    basis = vector_basis(mesh, "Q2", intorder=4)

    def stress(p):
        depth = -np.minimum(p[1], -1e-12)
        right, left = np.arctan2(p[0] + a, depth), np.arctan2(p[0] - a, depth)
        even = (np.sin(2 * right) - np.sin(2 * left)) / 2
        mean = q / np.pi * (right - left)
        shear = q / np.pi * (np.sin(right) ** 2 - np.sin(left) ** 2)
        return -(mean - q / np.pi * even), -(mean + q / np.pi * even), shear

    # signs of the closed form: (0, -2) and (3, -2)
    np.testing.assert_allclose(stress(np.array([0.0, -2.0])), (-18.1690, -81.8310, 0), atol=1e-4)
    np.testing.assert_allclose(
        np.abs(stress(np.array([3.0, -2.0]))), (24.8859, 21.3736, 21.0743), atol=1e-4
    )

    def traction(v, w):
        xx, yy, xy = stress(w.x)
        return v[0] * (xx * w.n[0] + xy * w.n[1]) + v[1] * (xy * w.n[0] + yy * w.n[1])

    ends = FacetBasis(mesh, basis.elem, facets=["left", "right", "bottom"], intorder=8)
    strip = FacetBasis(mesh, basis.elem, facets="strip", intorder=8)
    load = LinearForm(traction).assemble(ends) + LinearForm(lambda v, w: -q * v[1]).assemble(strip)
    corner = basis.nodal_dofs[:, (mesh.p[0] == 0) & (mesh.p[1] == -8)].ravel()
    fixed = np.append(corner, basis.nodal_dofs[0, (mesh.p[0] == 0) & (mesh.p[1] == 0)])
    form = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
    step = sc.Model({"ground": form}, fixed).run([sc.Stage("strip", load)], **QUIET)["strip"]
    places = np.asarray(basis.global_coordinates())
    inside = (places[1] < -1.0) & (places[1] > -7) & (np.abs(places[0]) < 7)
    for computed, exact in zip(step.states["ground"].stress[[0, 1, 3]], stress(places)):
        # the elements are half a metre wide, the strip ends two of them away
        np.testing.assert_allclose(computed[inside], exact[inside], atol=0.01 * q)


def test_buoyancy():
    """[X] A block under water is pushed up by the weight of the water in its place, whatever the
    depth.
    """
    for depth in (1.0, 50.0):
        basis = vector_basis(grid("P2", np.linspace(0, 2, 3), np.linspace(0, 1, 3)), "P2")
        sides = ["left", "right", "top", "bottom"]
        pressure = sc.hydrostatic(1.0 + depth, unit_weight=10.0)
        porous = sc.water_load(basis, pressure, sides)
        assert porous[1::2].sum() == pytest.approx(20.0, rel=1e-9)
        assert abs(porous[0::2].sum()) < 1e-9 * depth
