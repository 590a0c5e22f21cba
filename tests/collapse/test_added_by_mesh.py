"""Power that elements add to a mechanism, and its share of a factor or a limit load."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import MeshQuad

import skfem_contact as sc
from skfem_contact.collapse.mechanism import Lost, added_by_mesh, lost_power
from tests.tools.helpers import vector_basis

ANY = np.array([0.3, -0.1, 0.2, 0.05])


def lost(added, varied, strength=(10.0, 20.0, 30.0, 40.0)) -> Lost:
    """Return powers of four elements."""
    values = (np.array(each, float) for each in (added, varied, strength))
    return Lost(np.arange(4), *values)


@pytest.mark.parametrize("volume", [0.0, 1.0, -1.0, 2.0])
def test_power_of_strength_in_a_band_that_dilates(volume: float) -> None:
    """[X] tau (gamma^2 - eps_V^2) / gamma of even stresses and strains, times the area; none where
    the band opens without shear along it, and no part that the mesh adds.
    """
    basis = vector_basis(MeshQuad().refined(1).scaled((3.0, 2.0)), "Q1")
    form = sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0, psi=30.0))
    gamma, tau = 2.0, 20.0
    motion = basis.project(
        lambda x: np.stack((0.5 * (volume + gamma) * x[0], 0.5 * (volume - gamma) * x[1]))
    )
    start = form.initial_state()
    stress = np.broadcast_to(
        np.reshape([5.0, 5.0 - 2.0 * tau, -7.0, 0.0], (4, 1, 1)), start.stress.shape
    )
    bands = {"soil": np.full(stress.shape[1:], gamma)}
    found = lost_power({"soil": form}, bands, {"soil": replace(start, stress=stress)}, motion)
    expected = 6.0 * tau * (gamma**2 - volume**2) / gamma
    assert found.strength.sum() == pytest.approx(expected, rel=1e-12, abs=1e-12)
    # Round-off of stresses of 45.
    assert found.added == pytest.approx(np.zeros(4), abs=1e-12)
    assert np.isinf(found.varied).all()  # one strain in an element shows no variation


@pytest.mark.parametrize(("power", "share"), [(0, 1.0), (1, 0.0)])
def test_power_of_stresses_that_vary_in_elements(power: int, share: float) -> None:
    """[X] Stresses and strains that grow with x, in elements of width h: the stresses less their
    means have the power h^2 / 12 times area and slopes, none less means weighted with x, and
    linear stresses lose nothing by their projection.
    """
    mesh = MeshQuad.init_tensor(np.linspace(1.0, 4.0, 4), np.linspace(0.0, 2.0, 3))
    form = sc.SolidForm(vector_basis(mesh, "Q2", intorder=4), sc.LinearElastic(E=1e4, nu=0.3))
    motion = form.basis.project(lambda x: 0.5 * np.stack((x[0] ** 2, x[0] ** 2)))  # both strains x
    x = np.asarray(form.basis.global_coordinates())[0]
    stress = np.stack((3.0 * x - 1.0, 0.0 * x, 5.0 * x, 2.0 * x))
    state = replace(form.initial_state(), stress=stress)
    found = lost_power({"soil": form}, {"soil": x**power}, {"soil": state}, motion)
    # Round-off of powers of up to 50.
    assert found.varied.sum() == pytest.approx(share * 6.0 * (3.0 + 2.0) / 12.0, abs=1e-9)
    assert found.added == pytest.approx(np.zeros(6), abs=1e-9)


@pytest.mark.parametrize("varied", [ANY, np.full(4, np.inf)])
def test_share_of_the_mesh_has_no_unit(varied) -> None:
    """[X] Powers in other units, and of a larger whole with the same parts, give the same share."""
    share = added_by_mesh(lost(ANY, varied), None)
    assert 0.0 < share < 0.1
    for unit in (1e-6, 1e6):
        strength = unit * lost(ANY, varied).strength
        assert added_by_mesh(lost(unit * ANY, unit * varied, strength), None) == pytest.approx(
            share
        )
    twice = Lost(*(np.tile(each, 2) for each in lost(ANY, varied)))
    assert added_by_mesh(twice, None) == pytest.approx(share)


@pytest.mark.parametrize("varied", [ANY, np.full(4, np.inf)])
def test_stresses_that_lose_nothing_show_no_share_of_the_mesh(varied) -> None:
    """[X] Nothing is lost by the projection of the stresses, or less than nothing."""
    for added in (np.zeros(4), -ANY):
        assert added_by_mesh(lost(added, varied), None) == 0.0
