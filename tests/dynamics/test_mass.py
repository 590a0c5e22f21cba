"""Masses, Rayleigh damping by region, and masses that are moved away from contact."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex2,
    ElementQuad1,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.dynamics.mass import accelerations, mass_and_damping, moved_from_contact, weights


@pytest.mark.parametrize("consistent", [False, True])
@pytest.mark.parametrize(
    "case",
    [
        (MeshQuad, ElementQuad1),
        (MeshQuad, ElementQuad2),
        (MeshTri, ElementTriP2),
        (MeshHex, ElementHex2),
    ],
)
def test_total_mass_and_positive_diagonal(case, consistent):
    """[X] The mass of each direction is density times volume, also where row sums vanish."""
    mesh, element = case
    mesh = mesh().refined(1)
    basis = Basis(mesh, ElementVector(element()), intorder=4)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.2), unit_weight=20.0)
    M = weights({"solid": solid}, sc.Model({"solid": solid}).layout, consistent)
    for c in range(mesh.dim()):
        one = np.zeros(basis.N)
        one[c :: mesh.dim()] = 1.0
        assert one @ M @ one == pytest.approx(20.0)
    assert M.diagonal().min() > 0.0
    assert abs(M - M.T).max() < 1e-14
    assert (M.nnz == basis.N) == (not consistent)


def test_mass_of_revolution_is_per_radian():
    """[X] A disc of radius 1 and height 1 has the volume 1/2 per radian."""
    basis = Basis(MeshQuad().refined(1), ElementVector(ElementQuad2()), intorder=4)
    soil = sc.LinearElastic(E=1.0, nu=0.2)
    disc = sc.SolidForm(basis, soil, coordinates="axisymmetric", unit_weight=20.0)
    for consistent in (False, True):
        assert disc.weight_matrix(consistent).sum() == pytest.approx(2 * 10.0)


def halves():
    """Return a square of two regions, and its model."""
    parts = {"lower": lambda x: x[1] < 0.5, "upper": lambda x: x[1] > 0.5}
    mesh = MeshQuad().refined(2).with_defaults().with_subdomains(parts)
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soils = {"lower": sc.LinearElastic(E=1e3, nu=0.2), "upper": sc.LinearElastic(E=5e3, nu=0.3)}
    solid = sc.SolidForm(basis, soils, unit_weight={"lower": 20.0, "upper": 16.0})
    return sc.Model({"soil": solid}, basis.get_dofs("bottom").all()), basis


def test_rayleigh_damping_by_region():
    """[X] Regions of equal factors add up to alpha M + beta K of the whole; others have none."""
    model, _ = halves()
    soil = model.forms["soil"]
    damping = sc.Rayleigh(0.04, f=(1.0, 4.0))
    found = {}
    for key, given in {
        "all": damping,
        "solid": {"soil": damping},
        "lower": {"lower": damping},
        "upper": {"upper": damping},
    }.items():
        settings = sc.Dynamic(0.1, damping=given)
        M, found[key] = mass_and_damping(model.forms, model.layout, settings, 10.0)
    whole = damping.alpha * M + damping.beta * soil.elastic_stiffness
    size = abs(whole).max()
    assert abs(found["all"] - whole).max() < 1e-13 * size
    assert abs(found["solid"] - whole).max() < 1e-13 * size
    assert abs(found["lower"] + found["upper"] - whole).max() < 1e-13 * size
    above = np.flatnonzero(soil.basis.doflocs[1] > 0.6)
    assert abs(found["lower"][above]).max() == 0.0
    with pytest.raises(ValueError, match="no region or solid to damp 'clay'"):
        mass_and_damping(
            model.forms, model.layout, sc.Dynamic(0.1, damping={"clay": damping}), 10.0
        )


@pytest.mark.parametrize("consistent", [False, True])
def test_moved_mass_keeps_the_total_and_the_symmetry(consistent):
    """[X] Contact nodes lose their mass, the total stays, and the centre moves along the normal."""
    mesh = MeshQuad.init_tensor(np.linspace(-1, 1, 9), np.linspace(0, 1, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2), unit_weight=20.0)
    plate = sc.rigid.line((-5.0, 0.0), (5.0, 0.0))
    pair = sc.ContactPair(basis, "bottom", plate, sc.Coulomb(mu=0.3))
    model = sc.Model({"solid": solid, "pair": pair}, basis.get_dofs("top").all())
    M = weights(model.forms, model.layout, consistent)
    (moved,) = moved_from_contact(model.forms, [M], consistent)
    low = basis.get_dofs("bottom").all()
    assert abs(moved[low]).sum() == 0.0
    one = np.zeros(basis.N)
    one[basis.nodal_dofs[0]] = 1.0
    assert one @ moved @ one == pytest.approx(one @ M @ one)
    x = np.zeros(basis.N)
    x[basis.nodal_dofs[0]] = mesh.p[0]
    assert one @ moved @ x == pytest.approx(0.0, abs=1e-12)
    assert abs(moved - moved.T).max() < 1e-13


def test_blocks_of_triangles_hardly_turn_in_free_fall():
    """[X] Without a floor a block falls by g t^2 / 2: with moved masses within 0.3 % everywhere,
    with masses that are kept to round-off.
    """
    mesh = MeshTri.init_tensor(*2 * [np.linspace(0, 1, 5)]).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    block = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.2), unit_weight=20.0)
    plate = sc.rigid.line((-5.0, -1.0), (5.0, -1.0))
    pair = sc.ContactPair(basis, "bottom", plate, sc.Coulomb(mu=0.3))
    model = sc.Model({"block": block, "pair": pair}, gravity_acceleration=9.81)
    way = 0.5 * 9.81 * 0.2**2
    for mass, contact_mass, most in (("lumped", "moved", 3e-3), ("consistent", "kept", 1e-9)):
        settings = sc.Dynamic(5e-3, mass=mass, contact_mass=contact_mass)
        stage = sc.Stage("fall", duration=0.2, dynamic=settings)
        x = model.run([stage], progress=False)["fall"].x
        assert np.abs(x[1::2] + way).max() < most * way


def test_accelerations_by_a_consistent_mass():
    """[X] M a is the force at free nodes, and supports have no acceleration."""
    model, basis = halves()
    M, _ = mass_and_damping(model.forms, model.layout, sc.Dynamic(0.1, mass="consistent"), 10.0)
    force = np.asarray(sc.traction(basis, "top", (1.0, -2.0)))
    a = accelerations(M, force, model.fixed)
    free = np.setdiff1d(np.arange(basis.N), model.fixed)
    np.testing.assert_allclose((M @ a)[free], force[free], atol=1e-13)
    assert not a[model.fixed].any()
