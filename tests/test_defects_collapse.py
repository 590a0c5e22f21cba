"""Searches for a collapse do not answer wrongly in silence: stalls, peaks, joints, contact in one
geometry.
"""

from __future__ import annotations

from contextlib import nullcontext
from functools import cache

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.contact.interface import ContactState
from tests.tools.helpers import analysis, grid


def supported(mesh):
    """Basis of quadratic triangles, and supports of the base and the sides."""
    x, y = mesh.p
    mesh = mesh.with_boundaries(
        {
            "base": lambda p: p[1] < y.min() + 1e-9,
            "sides": lambda p: (p[0] < x.min() + 1e-9) | (p[0] > x.max() - 1e-9),
        }
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    return basis, np.append(basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1"))


@pytest.mark.parametrize(("phi", "limit"), [(20.0, 0.5949), (40.0, 1.3716)])
def test_slope_without_cohesion(phi, limit):
    """[N] Points without pressure have no strength: the bracket holds what cohesions of 0.1 and
    0.01 tend to.
    """
    flat = MeshTri.init_tensor(np.linspace(0, 1, 13), np.linspace(0, 1, 5))
    height = 10 - 10 * np.clip((30 * flat.p[0] - 10) / 15, 0, 1) + 5
    basis, fixed = supported(MeshTri(np.stack((30 * flat.p[0], height * flat.p[1])), flat.t))
    forms = {"slope": sc.SolidForm(basis, sc.MohrCoulomb(E=1e5, nu=0.3, c=0.0, phi=phi, psi=phi))}
    with pytest.warns(sc.AnalysisWarning, match="unstable") if limit < 1.0 else nullcontext():
        found = sc.Model(forms, fixed).strength_reduction(sc.weight(basis, 20.0), progress=False)
    assert found.stop.kind == "collapse"
    assert found.bracket[0] < limit + 1e-4 and limit - 1e-4 < found.bracket[1] < 1.01 * limit


def steep(psi):
    """10 m of soil at 45 degrees, 5 m of ground below the toe, phi = 40 and little cohesion."""
    x = np.concatenate(
        (np.arange(0, 15, 2.5), 15 + np.linspace(0, 10, 7), 25 + np.linspace(0, 15, 7)[1:])
    )
    flat = MeshQuad.init_tensor(x, np.concatenate(([0, 3, 5], 5 + np.linspace(0, 10, 7)[1:])))
    surface = 5 + np.clip((flat.p[0] - 15) / 10, 0, 1) * 10
    y = np.where(flat.p[1] > 3, 3 + (flat.p[1] - 3) / 12 * (surface - 3), flat.p[1])
    basis, fixed = supported(MeshQuad(np.array([flat.p[0], y]), flat.t).to_meshtri(style="x"))
    forms = {"ground": sc.SolidForm(basis, sc.MohrCoulomb(E=5e4, nu=0.3, c=5.0, phi=40.0, psi=psi))}
    return forms, fixed, sc.weight(basis, 19.0)


@pytest.mark.filterwarnings("ignore:no collapse was shown")
def test_bracket_without_dilatancy():
    """[X] Radenkovic: no flow exceeds the associated factor, which follows from that of Davis."""
    free = analysis("strength_reduction", *steep(0.0), tolerance=0.005, progress=False)
    fixed_factors = analysis(
        "strength_reduction", *steep(0.0), tolerance=0.005, method="bracket", progress=False
    )
    associated = analysis("strength_reduction", *steep(40.0), tolerance=0.005, progress=False)
    low, high = free.bracket
    assert high - low > 1e-6
    assert free.davis.factor < low and fixed_factors.factor <= high
    # one soil: the bound is the associated factor; each curve may rise by a quarter of 0.005, 1.3
    # times that is left
    assert high == pytest.approx(associated.bracket[1], abs=0.005)
    assert f"{free.davis.value:.4g} after Davis" in str(free)


def test_limit_load_that_stalls_says_what_helps():
    """A strip footing, phi = 30 and psi = 0, one iteration a step: nothing is known above, the
    flows are named.
    """
    mesh = grid("P2", np.linspace(0, 6, 10), np.linspace(-3, 0, 5)).with_boundaries(
        {"foot": lambda p: (p[1] > -1e-9) & (p[0] < 1.4)}
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    bottom = basis.get_dofs(lambda p: p[1] < -3 + 1e-9).all()
    fixed = np.append(
        bottom, basis.get_dofs(lambda p: (p[0] < 1e-9) | (p[0] > 6 - 1e-9)).all("u^1")
    )
    load = LinearForm(lambda v, w: -v[1]).assemble(FacetBasis(mesh, basis.elem, facets="foot"))
    forms = {"soil": sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=30.0, psi=0.0))}
    with pytest.warns(sc.AnalysisWarning, match=r"psi < phi .* flow='davis_b' or 'lagged'"):
        found = sc.Model(forms, fixed, newton=sc.Newton(1.5e-4, 1)).limit_load(load, progress=False)
    assert found.stop.kind == "stall" and found.bracket[1] == np.inf
    assert sum(step.iterations for step in found.steps if step.outcome == "stall") <= 150 + 1


def test_joints_are_reduced_like_all_other_strength():
    """[X] A block on an incline of 1 : 4 with mu = 0.4 slides at 1.6."""
    base = MeshQuad.init_tensor(np.linspace(0, 4, 13), np.linspace(-1, 0, 4)).with_defaults()
    block = MeshQuad.init_tensor(np.linspace(1.5, 2.5, 5), np.linspace(0, 0.5, 3)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementQuad1()), intorder=2
    )
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=20.0, phi=30.0, psi=30.0)
    forms = {
        "base": sc.SolidForm(basis.with_elements("base"), soil, "b_bar"),
        "block": sc.SolidForm(basis.with_elements("block"), sc.LinearElastic(E=1e6, nu=0.2)),
        "joint": sc.ContactPair(
            basis, "block:bottom", "base:top", sc.Coulomb(mu=0.4), quadrature=2
        ),
    }
    angle = np.arctan(0.25)
    down = sc.weight(basis, {"base": 0.0, "block": 20.0}, direction=(np.sin(angle), -np.cos(angle)))
    found = sc.Model(forms, basis.get_dofs("base:bottom").all()).strength_reduction(
        down, progress=False
    )
    assert found.reduced == ("base.all", "joint")
    assert found.factor == pytest.approx(1.6, abs=0.01)  # tol


# -- contact in one geometry
# -------------------------------------------------------------------------------------------


@cache
def wall(stiffness, law):
    """Factor of a vertical cut of clay, 4 m, beside a slender wall that stands in the ground."""
    x = np.concatenate((np.linspace(-8, 0, 7), [0.4], 0.4 + np.linspace(0, 6, 6)[1:]))
    flat = MeshQuad.init_tensor(x, np.linspace(-6, 4, 11))
    middle = flat.p[:, flat.t].mean(axis=1)
    mesh = flat.restrict(np.flatnonzero((middle[0] < 0.4) | (middle[1] < 0))).to_meshtri(style="x")

    def in_wall(p):
        return (p[0] > 0) & (p[0] < 0.4) & (p[1] > -3)

    faces = {
        "left": lambda p: np.isclose(p[0], 0.0) & (p[1] > -3),
        "tip": lambda p: np.isclose(p[1], -3) & (p[0] > 0) & (p[0] < 0.4),
        "right": lambda p: np.isclose(p[0], 0.4) & (p[1] > -3) & (p[1] < 0),
    }
    mesh = mesh.with_boundaries(
        faces
        | {
            "bottom": lambda p: p[1] < -6 + 1e-9,
            "sides": lambda p: (p[0] < -8 + 1e-9) | (p[0] > 6.4 - 1e-9),
        },
        boundaries_only=False,
    )
    mesh = mesh.with_subdomains({"wall": in_wall, "clay": lambda p: ~in_wall(p)})
    mesh = sc.join_bodies(mesh, bodies={"ground": "clay", "wall": "wall"})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    forms = {
        "ground": sc.SolidForm(
            basis.with_elements("ground"), sc.Tresca(E=stiffness * 1e4, nu=0.3, c=25.0)
        ),
        "wall": sc.SolidForm(
            basis.with_elements("wall"), sc.LinearElastic(E=stiffness * 2e7, nu=0.2)
        ),
    }
    for face in faces:
        penalty = stiffness * 1e5, stiffness * 1e4
        forms[face] = sc.ContactPair(
            basis, f"ground:{face}", f"wall:{face}", law, "nodal", penalty=penalty
        )
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("sides").all("u^1"))
    return sc.Model(forms, fixed).strength_reduction(
        sc.weight(basis, {"clay": 19.0, "wall": 25.0}), tolerance=0.01, progress=False
    )


FRICTION = sc.Coulomb(mu=0.3)


def test_factor_with_contact_does_not_depend_on_stiffness():
    """[X] Collapse loads are rigid-plastic: one factor over 2,500-fold moduli and penalties, to
    within `tol`.
    """
    factors = [wall(stiffness, FRICTION).factor for stiffness in (0.02, 1.0, 50.0)]
    assert max(factors) - min(factors) <= 0.01


def test_weaker_joint_does_not_raise_the_factor():
    """[X] Friction after bond, no friction after friction; all curves end within a quarter of
    0.01.
    """
    bonded, rough, smooth = (wall(1.0, law).factor for law in (sc.Tied(), FRICTION, sc.Coulomb()))
    assert smooth <= rough + 0.0025 <= bonded + 0.005


def test_end_of_a_search_has_the_pairs_own_states():
    """What is found is shown as after any stage: contact pairs, their states and their
    tractions.
    """
    found = wall(1.0, FRICTION)
    assert type(found.states["left"]) is ContactState
    assert found.end.forms["left"].law.mu == pytest.approx(0.3 / found.factor)
    tractions = found.end.tractions("left")
    limit = found.end.forms["left"].law.mu * tractions.pressure
    assert (
        np.abs(tractions.shear) <= limit + 1e-9 * tractions.pressure.max()
    ).all() and tractions.pressure.max() > 0
