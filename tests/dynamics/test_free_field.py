"""Free field: a box of ground moves like the column at its sides."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementTriP2,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc
from skfem_contact.materials.base import PLASTIC_STRAIN
from tests.dynamics.cases import QUIET

H, W, VS, DENSITY = 20.0, 40.0, 200.0, 2.0
ROCK = sc.Bedrock(unit_weight=25.0, vs=800.0)


def pulse(step=0.005):
    """Return a record of an outcrop whose velocity is a pulse of .2 m/s."""
    t = step * np.arange(200) - 0.15
    velocity = (1.0 - 2.0 * (np.pi * 5.0 * t) ** 2) * np.exp(-((np.pi * 5.0 * t) ** 2))
    return sc.Record(step, 0.2 * np.gradient(velocity, step))


def box(quadratic=False, soil=None, rock=ROCK, sides=True):
    """Return the model of a box of two soils, its basis and the supports in motion."""
    mesh = MeshQuad.init_tensor(np.linspace(0, W, 9), np.linspace(0, H, 11))
    element = ElementQuad1()
    if quadratic:
        mesh = MeshQuad.init_tensor(np.linspace(0, W, 5), np.linspace(0, H, 6)).to_meshtri()
        element = ElementTriP2()
    parts = {"low": lambda x: x[1] < 8.0, "high": lambda x: x[1] > 8.0}
    mesh = mesh.with_defaults().with_subdomains(parts)
    basis = Basis(mesh, ElementVector(element), intorder=4 if quadratic else 2)
    G = DENSITY * VS**2
    high = sc.LinearElastic(E=2.0 * G * 1.3, nu=0.3) if soil is None else soil
    soils = {"low": sc.LinearElastic(E=5.0 * G, nu=0.25), "high": high}
    ground = sc.SolidForm(basis, soils, unit_weight={"low": 22.0, "high": 20.0})
    forms = {"ground": ground}
    if rock is not None:
        forms["base"] = sc.ViscousBoundary(ground, "bottom", rock=rock)
    for side in ("left", "right"):
        if sides:
            forms[side] = sc.FreeField(ground, side, rock=rock)
    fixed = sc.box_supports(basis)
    moving = np.zeros(0, int) if rock is not None else basis.get_dofs("bottom").all()
    return sc.Model(forms, fixed, gravity_acceleration=10.0), basis, moving


def shaken(model, moving, damping=None, **more):
    """Return the stage of a pulse after gravity."""
    points = [(0.0, H), (W / 2, H)]
    settings = sc.Dynamic(0.005, rho_inf=0.9, damping=damping, points=points)
    stage = sc.Stage("shake", duration=0.6, dynamic=settings, base=pulse(), fixed=moving, **more)
    return model.run([sc.Stage("gravity"), stage], **QUIET)["shake"]


@pytest.mark.parametrize("quadratic", [False, True])
@pytest.mark.parametrize("rock", [ROCK, None])
def test_box_moves_like_a_column(quadratic, rock):
    """[X] Under a vertical wave the ground moves alike at the side and in the middle."""
    model, basis, moving = box(quadratic, rock=rock)
    found = shaken(model, moving, sc.Rayleigh(0.03, f=(2.0, 10.0)))
    side, middle = (found.history(x, "velocity").values for x in ((0.0, H), (W / 2, H)))
    largest = np.abs(middle).max()
    assert largest > 0.15
    # round-off and the tolerance of the statics; columns beside triangles are of rectangles, with
    # two of them in the shortest wave
    allowed = 0.06 * largest if quadratic else 1e-6 * largest
    np.testing.assert_allclose(side[:, 0], middle[:, 0], atol=allowed)
    assert np.abs(np.stack((side, middle))[:, :, 1]).max() < allowed
    # the column itself
    field = found.forms["left"].field
    top = found.layout.numbers([field])[field][-2]
    node = sc.dofs_at(basis, (0.0, H))[0, 0]
    assert found.x[top] == pytest.approx(found.x[node], rel=0.05 if quadratic else 1e-6)


def test_sides_alone_do_not_serve():
    """[X] Without the free field, dashpots at the sides hold the ground back."""
    model, _basis, moving = box(sides=False)
    ground = model.forms["ground"]
    forms = {**model.forms}
    for side in ("left", "right"):
        forms[side] = sc.ViscousBoundary(ground, side)
    plain = sc.Model(forms, model.fixed, gravity_acceleration=10.0)
    found = shaken(plain, moving)
    with_field = shaken(*box()[::2])
    side = found.history((0.0, H), "velocity").values[:, 0]
    exact = with_field.history((0.0, H), "velocity").values[:, 0]
    assert np.abs(side - exact).max() > 0.3 * np.abs(exact).max()


@pytest.mark.slow
def test_soil_yields_in_the_column_too():
    """[X] Clay without friction that yields: the box and its columns still move alike."""
    clay = sc.Tresca(E=2.0 * DENSITY * VS**2 * 1.3, nu=0.3, c=8.0)
    model, _basis, moving = box(soil=clay)
    start = model.k0_state(K0=1.0)
    settings = sc.Dynamic(0.005, rho_inf=0.9, points=[(0.0, H), (W / 2, H)])
    stage = sc.Stage("shake", duration=0.4, dynamic=settings, base=pulse(), fixed=moving)
    found = model.run([stage], start=start, **QUIET)["shake"]
    plastic = found.forms["ground"].variable(PLASTIC_STRAIN, found.states["ground"])
    assert (plastic > 0.0).mean() > 0.05
    side, middle = (found.history(x).values[:, 0] for x in ((0.0, H), (W / 2, H)))
    assert np.abs(side - middle).max() < 0.01 * np.abs(middle).max()


def test_results_are_saved(tmp_path):
    """[X] The state of the columns survives a file."""
    model, _basis, moving = box()
    settings = sc.Dynamic(0.005)
    stage = sc.Stage("shake", duration=0.05, dynamic=settings, base=pulse(), fixed=moving)
    result = model.run([sc.Stage("gravity"), stage], **QUIET)
    result.save(tmp_path / "shaken.npz")
    again = sc.load_result(tmp_path / "shaken.npz", model)
    np.testing.assert_array_equal(
        again["shake"].states["left"].stress, result["shake"].states["left"].stress
    )


def test_bad_sides():
    """[X] Sides that are not vertical, other coordinates and other models are refused."""
    model, basis, _ = box(sides=False)
    ground = model.forms["ground"]
    with pytest.raises(ValueError, match="'bottom' of a free field is not vertical"):
        sc.FreeField(ground, "bottom")
    disc = sc.SolidForm(
        basis, sc.LinearElastic(E=1e4, nu=0.3), coordinates="axisymmetric", unit_weight=20.0
    )
    with pytest.raises(ValueError, match="a free field is of plane ground, not axisymmetric"):
        sc.FreeField(disc, "left")
    other = sc.SolidForm(
        Basis(basis.mesh, ElementVector(ElementQuad1()), intorder=2),
        sc.LinearElastic(E=1e4, nu=0.3),
        unit_weight=20.0,
    )
    with pytest.raises(ValueError, match="the solid of its ground is not in the model"):
        sc.Model({"ground": other, "left": sc.FreeField(ground, "left")}, model.fixed)
