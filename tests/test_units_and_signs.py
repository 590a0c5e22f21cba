"""Values in wrong units or with wrong signs: what is refused by name, and what is told."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import MeshTri

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis


def test_angles_in_radians():
    with pytest.warns(sc.AnalysisWarning, match=r"phi is 0.5236: angles are given in degrees"):
        sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=np.radians(30))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert (
            sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=30.0).reduced(50.0).phi < 1.0
        )  # derived, and meant


ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: sc.rigid.level_set(lambda x, y: x + y, (-1.0, 1.0, -1.0, 1.0), resolution=0),
            "at least 2, not 0",
        ),
        (
            lambda: sc.MatrixForm(np.ones((2, 3, 4))),
            r"square matrix, not an array of shape \(2, 3, 4\)",
        ),
        (lambda: column().k0_state(K0=0.5, unit_weights={}), "unit_weights names no subdomain"),
        (lambda: sc.testing.check_material(ELASTIC, ncomp=0), "ncomp must be one of 4, 6, not 0"),
        (
            lambda: (
                column()
                .run([sc.Stage("w")])[-1]
                .section_forces("soil", sc.Cuts.line((9, 1), (9, 0), 1))
            ),
            "at .9, 1",
        ),
        (
            lambda: column(gravity=(0.0, -9.81)),
            r"gravity must be a unit vector with 2 components, not \(0.0, -9.81\)",
        ),
        (lambda: column(seismic=(0.1, 0.1)), "seismic must be finite, with at most 1 components"),
        (lambda: column("axisymmetric", seismic=0.1), "weights act along the axis"),
        (lambda: column("axisymmetric", gravity=(0.6, -0.8)), "weights act along the axis"),
    ],
)
def test_nothing_given(call, message):
    """Grids without points, no weights, sections elsewhere, gravity of 9.81 or across an axis:
    refused by name.
    """
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sc.Coulomb(mu=20.0), "mu is 20: it is the tangent of the angle"),
        (
            lambda: sc.hydrostatic(2.0, unit_weight=1000.0),
            "unit weight of water is 1000, which is its density",
        ),
        (
            lambda: sc.PoreWater(column().forms["soil"].basis, 1e-4, unit_weight=1e3),
            "water is 1000, which is its density",
        ),
        (
            lambda: sc.water.Flow(column().forms["soil"].basis, 1e-5, unit_weight=1025.0).steady(
                sc.water.Conditions(head={"left": 1.0})
            ),
            "water is 1025",
        ),
        (lambda: column().k0_state(K0=50.0), "K0 is 50: it is the ratio"),
        (
            lambda: column(E=1.0).run([sc.Stage("weight")]),
            "small; are E and the loads in the same units",
        ),
        (
            lambda: column(seismic=-10.0),
            "seismic is -10.0: it is the acceleration over that of gravity",
        ),
        (lambda: column(unit_weight={"all": -18.0}), "unit weights are positive"),
        (
            lambda: sc.mesh.check_mesh(MeshTri().translated((5e3, 5e4))),
            r"lies at \(5000, 5e\+04\), .* move it by",
        ),
    ],
)
def test_slips_are_told(make, message):
    """Angles for coefficients, densities for weights, per cent for ratios, MPa beside kN."""
    with pytest.warns(sc.AnalysisWarning, match=message):
        make()


def column(coordinates: str = "plane", E: float = 1e4, unit_weight: float | dict = 20.0, **options):
    """Model of a body of 1 m under its own weight."""
    mesh = grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3)).with_subdomains(
        {"all": lambda x: x[0] > 0.0}
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    soil = sc.SolidForm(
        basis, sc.LinearElastic(E, 0.3), coordinates=coordinates, unit_weight=unit_weight
    )
    return sc.Model({"soil": soil}, sc.box_supports(basis), **options)


def test_sound_input_is_not_told(recwarn):
    sc.Coulomb(mu=[0.2, 5.0])
    sc.Coulomb(mu=1e6)
    sc.hydrostatic(2.0, unit_weight=9810.0)
    column(seismic=0.9)
    sc.mesh.check_mesh(MeshTri().translated((1e3, -1e3)))
    column().k0_state(K0=3.0)
    column().run([sc.Stage("weight")])
    assert not recwarn.list
