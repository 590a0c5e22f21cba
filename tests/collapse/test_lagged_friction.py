"""Limit loads of soil with psi < phi: friction from the pressure at the start of each step."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import FacetBasis, LinearForm

import skfem_contact as sc
from skfem_contact.materials import HardeningMohrCoulomb
from skfem_contact.materials.mohr_coulomb import AssociatedSubstitute
from tests.tools.helpers import analysis, grid, vector_basis

SOIL = sc.MohrCoulomb(E=1e3, nu=0.3, c=1.0, phi=30.0, psi=5.0)


def at_yield(soil, n=50):
    """Stresses on the yield surface, and the strain increments that follow them, (4, n, 1)."""
    random = np.random.default_rng(7)
    before = np.zeros((4, n, 1))
    before[:3] = -3.0
    strain = 0.02 * random.standard_normal((4, n, 1))
    update = soil.update(strain, before, np.zeros((1, n, 1)))
    return update, 1e-3 * random.standard_normal((4, n, 1))


def test_tangent_is_symmetric_and_that_of_the_stress():
    """[N] Derivative by central differences; associated flow makes it symmetric."""
    update, strain = at_yield(SOIL)
    law = AssociatedSubstitute(SOIL)
    out = law.update(strain, update.stress, update.internal)
    tangent = out.tangent()
    assert len(out.plastic) > 10
    scale = SOIL.E
    assert np.abs(tangent - tangent.transpose(0, 2, 1)).max() < 1e-9 * scale
    h = 1e-7
    for k in range(4):
        change = np.zeros_like(strain)
        change[k] = h
        plus, minus = (
            law.update(strain + s * change, update.stress, update.internal).stress for s in (1, -1)
        )
        slope = ((plus - minus) / (2 * h)).reshape(4, -1)[:, out.plastic]
        # a difference across a corner of the surface is no derivative: a few points may be wrong
        off = np.abs(slope - tangent[:, :, k].T).max(axis=0) > 1e-4 * scale
        assert off.mean() <= 0.1


def test_error_is_that_of_the_pressure():
    """[N] The stress after a step differs from the true law's in proportion to the change of the
    pressure.
    """
    update, strain = at_yield(SOIL)
    ratios = []
    for share in (1.0, 0.1):
        true, approximate = (
            law.update(share * strain, update.stress, update.internal).stress
            for law in (SOIL, AssociatedSubstitute(SOIL))
        )
        ratios.append(np.abs(approximate - true).max() / np.abs(true - update.stress).max())
    # of the order of sin(phi) - sin(psi) times the change of the stress, whatever the size of the
    # step
    assert max(ratios) < 1.0


def test_parameters_may_vary_by_element():
    """[N] Elements with the same soil answer alike, whether it is given once or for each of
    them.
    """
    update, strain = at_yield(SOIL, n=6)
    soil = sc.MohrCoulomb(E=np.full(6, 1e3), nu=0.3, c=np.ones(6), phi=np.full(6, 30.0), psi=5.0)
    one, many = (
        AssociatedSubstitute(s).update(strain, update.stress, update.internal).stress
        for s in (SOIL, soil)
    )
    assert np.abs(one - many).max() < 1e-12


def test_associated_soil_stays_as_it_is():
    """[X] With psi = phi there is nothing to lag behind, and other laws are refused."""
    associated = sc.MohrCoulomb(E=1e3, nu=0.3, c=1.0, phi=30.0, psi=30.0)
    assert type(associated.reduced(2.0, "lagged")) is sc.MohrCoulomb
    softening = HardeningMohrCoulomb(
        1e3, 0.3, c=2.0, c_end=1.0, phi=20.0, phi_end=20.0, strain_end=0.1
    )
    with pytest.raises(ValueError, match="'lagged' is for MohrCoulomb"):
        softening.reduced(1.0, "lagged")


def footing(psi: float, phi: float = 20.0):
    """A strip footing of half width 1 on weightless soil, c = 1, four-node elements."""
    x = np.concatenate((np.linspace(0, 1, 7), 1 + np.geomspace(0.18, 7, 12)))
    mesh = grid("Q1", x, -np.concatenate((np.geomspace(4, 0.18, 10), [0.0])))
    mesh = mesh.with_boundaries({"footing": lambda p: (p[1] > -1e-9) & (p[0] < 1.0)})
    basis = vector_basis(mesh, "Q1", intorder=3)
    forms = {
        "soil": sc.SolidForm(
            basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=phi, psi=psi), strain="b_bar"
        )
    }
    fixed = np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    pressure = LinearForm(lambda v, w: -v[1]).assemble(
        FacetBasis(mesh, basis.elem, facets="footing", intorder=3)
    )
    return forms, fixed, pressure


@pytest.mark.slow
def test_footing_without_dilatancy_in_few_iterations():
    """[B] The capacity with psi = 0 is below that with psi = phi, and no step fails on the way."""
    settings = {"tolerance": 0.01, "newton": sc.Newton(1e-3, 30), "progress": False}
    associated = analysis("limit_load", *footing(20.0), **settings)
    free = analysis("limit_load", *footing(0.0), flow="lagged", **settings)
    assert all(trial.outcome == "equilibrium" for trial in free.steps)
    assert free.iterations <= 150  # 100 or so; the given law takes 500 to 1000
    # both come to Prandtl's capacity from above as the mesh is refined, the associated one from
    # further away
    assert 14.835 < free.multiplier < associated.multiplier


@pytest.mark.slow
@pytest.mark.exhaustive
def test_short_steps_follow_the_given_law():
    """[N] phi = 30, psi = 0: with steps of no more than 4 times the first one both laws have the
    same capacity.

    In steps that grow to the end the friction of the pressure a step ago carries more.
    """
    settings = {"tolerance": 0.02, "newton": sc.Newton(3e-3, 30), "progress": False}
    short = {"step": 2.0, "max_step": 4.0, **settings}
    given = analysis("limit_load", *footing(0.0, 30.0), **short)
    lagging = analysis("limit_load", *footing(0.0, 30.0), flow="lagged", **short)
    growing = analysis("limit_load", *footing(0.0, 30.0), flow="lagged", **settings)
    steps = np.diff(lagging.curve[:, 0])
    assert steps.max() == pytest.approx(4 * steps[0])
    # 0.4 % apart; the residual's tolerance is 0.3 %, and curves without dilatancy oscillate by as
    # much
    assert lagging.multiplier == pytest.approx(given.multiplier, rel=0.01)
    assert growing.multiplier > 1.01 * lagging.multiplier


@pytest.mark.slow
def test_flow_of_a_limit_load():
    """[X] Davis' soil A carries as much as the associated soil of that strength."""
    forms, fixed, load = footing(0.0)
    davis = sc.Model(forms, fixed).limit_load(load, flow="davis_a", progress=False).multiplier
    weaker = forms["soil"].materials["all"].reduced(1.0, "davis_a")
    same = sc.Model({"soil": forms["soil"].with_materials({"all": weaker})}, fixed).limit_load(
        load, progress=False
    )
    assert davis == pytest.approx(same.multiplier, rel=1e-9)
