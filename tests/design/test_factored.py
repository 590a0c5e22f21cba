"""Models with design values: every law by its own factors, once, also in stages."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.design import EC7, factored
from skfem_contact.design.factored import divided, divided_interface

#: Different factors on all strengths.
OWN = replace(EC7["DA1-2"], name="own", phi=1.2, cohesion=1.5, undrained=1.4)


def tangent(phi):
    return np.tan(np.radians(phi))


@pytest.fixture
def model():
    """A block on a plate that yields, with friction between them."""
    line = np.linspace(0, 1, 3)
    grid = MeshQuad.init_tensor(line, line).with_defaults()
    mesh = sc.join_bodies({"plate": grid, "block": grid.translated((0.0, 1.0))})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soils = {
        "plate": sc.MohrCoulomb(E=1e4, nu=0.3, c=12.0, phi=30.0, psi=30.0),
        "block": sc.LinearElastic(E=1e5, nu=0.2),
    }
    solid = sc.SolidForm(basis, soils, unit_weight=10.0)
    skin = sc.ContactPair(basis, "block:bottom", "plate:top", sc.Coulomb(mu=0.6, adhesion=3.0))
    return sc.Model({"solid": solid, "skin": skin}, basis.get_dofs("plate:bottom").all())


def test_strengths_of_a_model(model):
    """[X] Cohesion, tangents and friction by their factors; the model stays as it is."""
    design = factored(model, OWN)
    soil = design.forms["solid"].materials["plate"]
    assert np.isclose(soil.c, 8.0)
    assert np.isclose(tangent(soil.phi), tangent(30.0) / 1.2)
    assert soil.psi == soil.phi
    assert design.forms["solid"].materials["block"] is model.forms["solid"].materials["block"]
    law = design.forms["skin"].law
    assert np.allclose((law.mu, law.adhesion), (0.5, 2.0))
    assert model.forms["skin"].law.mu == 0.6
    assert model.forms["solid"].materials["plate"].c == 12.0


def test_forms_of_stages_are_factored_once(model):
    """[X] A stage brings a characteristic soil beside one that has its design value."""
    design = factored(model, OWN)
    fill = sc.MohrCoulomb(E=1e4, nu=0.3, c=6.0, phi=20.0)
    changed = design.forms["solid"].with_materials({"block": fill})
    stages = [sc.Stage("weight"), sc.Stage("fill", change={"solid": changed})]
    result = design.run(stages)
    soils = result["fill"].forms["solid"].materials
    assert np.isclose(soils["block"].c, 4.0)
    assert np.isclose(soils["plate"].c, 8.0)
    again = design.run([sc.Stage("more")], start=result)
    assert np.isclose(again["more"].forms["solid"].materials["block"].c, 4.0)


def test_a_start_with_characteristic_values(model):
    """[X] A design run continues a characteristic one, whose changed forms get design values."""
    fill = sc.MohrCoulomb(E=1e4, nu=0.3, c=6.0, phi=20.0)
    changed = model.forms["solid"].with_materials({"block": fill})
    before = model.run([sc.Stage("weight"), sc.Stage("fill", change={"solid": changed})])
    after = factored(model, OWN).run([sc.Stage("design")], start=before)["design"]
    assert np.isclose(after.forms["solid"].materials["block"].c, 4.0)
    assert np.isclose(after.forms["solid"].materials["plate"].c, 8.0)
    assert before["fill"].forms["solid"].materials["plate"].c == 12.0


@pytest.mark.parametrize("undrained", [False, True])
def test_functions_of_the_coordinates_in_a_model(model, undrained):
    """[X] Cohesion and friction that vary with the coordinates, divided point by point."""
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=lambda x: 12.0 + x[1], phi=lambda x: 30.0 - x[0])
    if undrained:
        soil = sc.Undrained(soil, nu_undrained=0.495)
    given = model.forms["solid"].with_materials({"plate": soil})
    varied = sc.Model({"solid": given, "skin": model.forms["skin"]}, model.fixed)
    design = factored(varied, OWN).forms["solid"].materials["plate"]
    before = given.materials["plate"]
    if undrained:
        design, before = design.soil, before.soil
    assert np.ptp(before.c) > 0.5
    assert np.allclose(design.c, before.c / 1.5)
    assert np.allclose(tangent(design.phi), tangent(before.phi) / 1.2)


def test_excluded_parts(model):
    """[X] Excluded forms and regions keep their strength, unknown names are listed."""
    design = factored(model, OWN, exclude=["skin", "plate"])
    assert design.forms["skin"].law.mu == 0.6
    assert design.forms["solid"].materials["plate"].c == 12.0
    with pytest.raises(ValueError, match="no form or region of the model 'clay'"):
        factored(model, OWN, exclude="clay")


def test_every_law():
    """[X] Each law keeps its stiffness and its kind, and has its strength divided."""
    clay = divided(sc.Tresca(E=1e3, nu=0.3, c=14.0), OWN)
    assert np.isclose(clay.c, 10.0)
    by_depth = divided(sc.Tresca(E=1e3, nu=0.3, c=lambda x: 14.0 + x[1]), OWN)
    assert np.isclose(by_depth.c(np.array([0.0, 14.0])), 20.0)
    sand = sc.HardeningSoil(37e3, 29.6e3, 90e3, m=0.5, c=3.0, phi=40.0, psi=38.0)
    weaker = divided(sand, OWN)
    assert type(weaker) is sc.HardeningSoil and weaker.E50_ref == 37e3
    assert np.isclose(weaker.c, 2.0) and weaker.psi == weaker.phi
    undrained = divided(sc.Undrained(sand, nu_undrained=0.495), OWN)
    assert np.isclose(undrained.soil.c, 2.0) and undrained.nu_undrained == 0.495
    steel = divided(sc.VonMises(E=1e5, nu=0.3, strength=14.0), OWN)
    assert np.isclose(steel.strength, 10.0)
    rock = sc.HoekBrown.from_gsi(E=1e6, nu=0.25, sigma_ci=3e4, gsi=45.0, m_i=10.0)
    assert np.isclose(divided(rock, OWN).factor, 1.2)
    elastic = sc.LinearElastic(E=1.0, nu=0.0)
    assert divided(elastic, OWN) is elastic


@pytest.mark.parametrize("phi", [0.0, 30.0])
def test_tensile_strength_is_divided_like_cohesion(phi):
    """[X] As strength reduction divides it: a column whose cut-off is 7 is pulled apart at 7 over
    the factor.
    """
    soil = sc.MohrCoulomb(E=1e3, nu=0.3, c=14.0, phi=phi, psi=phi, tension=7.0)
    weaker = divided(soil, OWN)
    factor = OWN.cohesion if phi else OWN.undrained
    assert np.isclose(weaker.c, 14.0 / factor) and np.isclose(weaker.tension, 7.0 / factor)
    by_depth = divided(replace(soil, tension=lambda x: 7.0 + x[1]), OWN)
    assert np.isclose(by_depth.tension(np.array([0.0, 7.0])), 14.0 / factor)
    assert divided(replace(soil, tension=None), OWN).tension is None


def test_joints_and_adhesion_have_the_factors_of_soil():
    """[X] Cohesion and friction of joints by their own factors; adhesion without friction is that
    of undrained ground.
    """
    sets = (
        sc.Joint(dip=30.0, c=12.0, phi=25.0, psi=25.0, tension=3.0),
        sc.Joint(dip=-60.0, c=5.0, phi=0.0),
    )
    rock = divided(sc.JointedRock(E=1e6, nu=0.2, joints=sets), OWN)
    rough, smooth = rock.joints
    assert np.allclose((rough.c, rough.tension), (12.0 / OWN.cohesion, 3.0 / OWN.cohesion))
    assert np.isclose(tangent(rough.phi), tangent(25.0) / OWN.phi) and rough.psi == rough.phi
    assert (rough.dip, smooth.dip, smooth.phi) == (30.0, -60.0, 0.0)
    assert np.isclose(smooth.c, 5.0 / OWN.undrained)
    clay = divided_interface(sc.Coulomb(adhesion=7.0, tension=2.0), OWN)
    assert np.allclose(
        (clay.mu, clay.adhesion, clay.tension), (0.0, 7.0 / OWN.undrained, 2.0 / OWN.undrained)
    )


def test_a_slope_has_the_factor_over_the_partial_factor():
    """[X] With one factor on all strengths the over-design factor is the factor of safety over it.

    A vertical column that carries 2 c: both searches find their brackets, 0.01 wide.
    """
    basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()))
    soil = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=0.0))
    fixed = [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    model = sc.Model({"soil": soil}, fixed)
    load = model.traction("top", (0.0, -10.0))
    design = factored(model, replace(OWN, undrained=1.25))
    assert abs(design.strength_reduction(load).factor - 2.0 / 1.25) < 0.01


def test_laws_that_keep_their_strength(model):
    """A law without a strength to divide is named."""
    cam = sc.CamClay(kappa=0.02, lambda_=0.1, M=1.0, nu=0.3, p_ref=100.0)
    basis = model.forms["solid"].basis
    clay = sc.SolidForm(basis, {"plate": cam, "block": sc.LinearElastic(E=1.0, nu=0.0)})
    with pytest.warns(sc.AnalysisWarning, match=r"clay\.plate: CamClay keeps its strength"):
        factored(sc.Model({"clay": clay}), OWN)


def test_bodies_of_your_own_keep_their_strength(model):
    """A body of another class than SolidForm is named: its materials may come from anywhere."""

    class Own(sc.Form, sc.roles.Body):
        basis = model.forms["solid"].basis
        materials = MappingProxyType({"all": sc.Tresca(E=1e3, nu=0.3, c=10.0)})
        size = basis.N

        def assemble(self, x, state):
            raise NotImplementedError

    own = Own()
    with pytest.warns(sc.AnalysisWarning, match="own: the materials of Own keep their strength"):
        assert factored(sc.Model({"own": own}), OWN).forms["own"] is own
