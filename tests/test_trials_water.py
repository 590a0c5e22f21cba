"""Water that would give another result than intended is refused, or the result has a remark."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc


def ground(n: int = 8):
    """A layer with a basis, its solid and its water."""
    mesh = MeshTri.init_tensor(
        np.linspace(0, 4, 2 * n + 1), np.linspace(-2, 0, n + 1)
    ).with_defaults()
    mesh = mesh.with_subdomains({"left": lambda x: x[0] < 2, "right": lambda x: x[0] > 2})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    clay = sc.SolidForm(basis, sc.LinearElastic(E=8e3, nu=0.3))
    return basis, clay, sc.PoreWater(basis, permeability=2e-4, unit_weight=9.81)


def test_two_waters_of_the_same_elements():
    """Their storage and flow would add up; parts of the ground that share an interface may have a
    water each.
    """
    basis, clay, water = ground()
    again = sc.PoreWater(basis.with_elements("left"), permeability=2e-4, unit_weight=9.81)
    with pytest.raises(
        ValueError, match="'water': 'again' is PoreWater of 128 of the same elements"
    ):
        sc.Model({"clay": clay, "water": water, "again": again})
    other = sc.PoreWater(basis.with_elements("right"), permeability=2e-4, unit_weight=9.81)
    sc.Model({"clay": clay, "water": other, "again": again})


def test_water_of_another_mesh():
    _, clay, _ = ground()
    with pytest.raises(ValueError, match="the forms belong to different bases"):
        sc.Model({"clay": clay, "water": ground(7)[2]})


def test_pressures_that_are_prescribed_but_not_held():
    """They would do nothing; values of all dofs may be given, as in scikit-fem."""
    basis, clay, water = ground()
    fixed = sc.box_supports(basis, base="fixed")
    load = sc.traction(basis, "top", (0.0, -50.0))
    model = sc.Model({"clay": clay, "water": water}, [fixed, water.dofs("top")])
    below = model.forms["water"].prescribed({"bottom": 30.0})
    with pytest.warns(
        sc.AnalysisWarning, match="the pore pressure is prescribed at 17 dofs that are not held"
    ):
        model.run([sc.Stage("a", load, duration=1.0, prescribed=below)], progress=False)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stage = model.run([sc.Stage("a", load, duration=1.0)], progress=False)["a"]
        held = sc.Stage(
            "b", load, duration=1.0, prescribed=below, fixed=[fixed, water.dofs("top", "bottom")]
        )
        model.run([held], start=stage, progress=False)
        model.run(
            [sc.Stage("b", load, duration=1.0, prescribed=stage.x)], start=stage, progress=False
        )
    assert not any("prescribed" in str(w.message) for w in caught)


def test_a_load_on_pressures():
    """It would be water in every increment, whatever its length."""
    basis, clay, water = ground()
    model = sc.Model(
        {"clay": clay, "water": water}, [sc.box_supports(basis, base="fixed"), water.dofs("top")]
    )
    well = np.zeros(model.forms["water"].size)
    well[model.forms["water"].first] = 1e-3
    with pytest.raises(
        ValueError, match="stage 'well': the load acts on the pore pressure at 1 dofs"
    ):
        model.run([sc.Stage("well", well, duration=1.0)], progress=False)


@pytest.mark.parametrize("waters", [1, 2])
@pytest.mark.parametrize(
    ("part", "told"), [(5e-5, False), (5e-3, True), (0.55, True), (1.01, False)]
)
def test_elements_beside_an_inner_drain(part, told, waters):
    """[X] 0 <= p <= q in a column; while h² / 3 c_v of the first element beside drained sand lasts,
    p exceeds q.

    Before, in a time that the sand's pressures need as well, it does not, and there is no remark.
    The sand may have a water of its own.
    """
    q, k = 100.0, 1e-6
    mesh = MeshTri.init_tensor(np.array([0.0, 0.2]), np.linspace(-0.8, 2.0, 15)).with_defaults()
    mesh = mesh.with_subdomains({"clay": lambda x: x[1] > 0, "sand": lambda x: x[1] < 0})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=5e3, nu=0.0))}
    if waters == 1:
        forms["water"] = drain = sc.PoreWater(basis, {"clay": k, "sand": 1e4 * k}, unit_weight=10.0)
    else:
        forms["water"] = sc.PoreWater(basis.with_elements("clay"), k, unit_weight=10.0)
        forms["sand's"] = drain = sc.PoreWater(
            basis.with_elements("sand"), 1e4 * k, unit_weight=10.0
        )
    model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), drain.dofs("bottom")])
    limit = 0.2**2 / 3 / (5e3 * k / 10.0)
    stage = sc.Stage("load", sc.traction(basis, "top", (0.0, -q)), duration=part * limit)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stage = model.run([stage], progress=False)["load"]
    inside = mesh.p[1] > -1e-9
    assert (stage.forms["water"].pressure(stage.x)[inside].max() > 1.05 * q) == told
    # in the shortest time the sand's own elements at its drained bottom are not resolved
    assert any(f"h² / 3 c_v = {limit:.3g}" in str(w.message) for w in caught) == told


@pytest.mark.parametrize(("part", "told"), [(0.3, True), (1.01, False)])
def test_elements_beside_a_seepage_face(part, told):
    """[X] 0 <= p <= q in a column that drains by a seepage face: before h² / 3 c_v of its elements
    p exceeds q.
    """
    basis, clay, water = ground()
    forms = {"clay": clay, "water": water, "face": sc.water.SeepageFace(water, "top", 0.0)}
    model = sc.Model(forms, sc.box_supports(basis, base="rollers"))
    limit = 0.25**2 / 3 / (8e3 * 0.7 / 1.3 / 0.4 * 2e-4 / 9.81)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        load = model.traction("top", (0.0, -50.0))
        stage = model.run([sc.Stage("load", load, duration=part * limit)], progress=False)["load"]
    assert (stage.forms["water"].pressure(stage.x).max() > 1.05 * 50.0) == told
    assert any(f"h² / 3 c_v = {limit:.3g}" in str(w.message) for w in caught) == told


@pytest.mark.parametrize(("outside", "told"), [(50.0, False), (49.0, False), (25.0, True)])
def test_short_steps_without_a_jump(outside, told):
    """[X] A reservoir that rises presses on the ground as much as its water does in the pores:
    nothing flows.
    """
    basis, clay, water = ground()
    model = sc.Model({"clay": clay, "water": water}, [sc.box_supports(basis), water.dofs("top")])
    given = model.forms["water"].prescribed({"top": outside})
    limit = 0.25**2 / 3 / (8e3 * 0.7 / 1.3 / 0.4 * 2e-4 / 9.81)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        load = model.traction("top", (0.0, -50.0))
        stage = model.run(
            [sc.Stage("rise", load, prescribed=given, duration=0.2 * limit)], progress=False
        )["rise"]
    excess = stage.forms["water"].pressure(stage.x).max() / 50.0 - 1.0
    assert (excess > 0.05) == told and (excess > 1e-9) == (outside < 50.0)
    remarks = [str(w.message) for w in caught if "elements beside drains" in str(w.message)]
    assert bool(remarks) == told and all(
        "changes of pressure may be up to 37% too large" in text for text in remarks
    )


@pytest.mark.parametrize(("pressure", "told"), [(20.0, False), (40.0, True)])
def test_water_under_a_tight_block(pressure, told):
    """[X] Water that presses more than a block weighs, 24, lifts it; where tight contact holds the
    total it is told.
    """
    mesh = sc.join_bodies(
        {
            "bed": MeshTri.init_tensor(np.linspace(0, 2, 9), np.linspace(-1, 0, 5)).with_defaults(),
            "cap": MeshTri.init_tensor(np.linspace(0, 2, 7), np.linspace(0, 1, 4)).with_defaults(),
        }
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = sc.PoreWater(basis.with_elements("bed"), permeability=1e-3, unit_weight=1.0)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.2)),
        "water": water,
        "joint": sc.ContactPair(
            basis, slave="cap:bottom", master="bed:top", law=sc.Coulomb(mu=0.3)
        ),
    }
    sides = basis.get_dofs({"bed:left", "bed:right", "cap:left", "cap:right"}).all("u^1")
    model = sc.Model(forms, [basis.get_dofs("bed:bottom").all(), sides, water.dofs("bed:bottom")])
    own, given = (
        sc.weight(basis, {"cap": 24.0}),
        model.forms["water"].prescribed({"bed:bottom": pressure}),
    )
    stages = [
        sc.Stage("weight", own, duration=1e3),
        sc.Stage("water", own, prescribed=given, duration=1e4),
    ]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run(stages, progress=False)
    text = "under 'joint' the water presses with up to 40, and contact transfers 24 there in total"
    assert any(text in str(w.message) for w in caught) == told


@pytest.mark.parametrize("by", ["a stage", "another model", "a file"])
def test_drain_that_is_opened_later(by, tmp_path):
    """[X] Terzaghi: a layer that drains at its base is opened at its top too, and half consolidates
    by T = .197.
    """
    mesh = MeshTri.init_tensor(np.array([0.0, 0.2]), np.linspace(0, 2, 21)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    sides, water = (
        sc.box_supports(basis, base="rollers"),
        sc.PoreWater(basis, 1e-4, unit_weight=1.0),
    )
    forms = {"clay": sc.SolidForm(basis, sc.LinearElastic(E=8e3, nu=0.0)), "water": water}
    model = sc.Model(forms, [sides, water.dofs("bottom")])
    load = sc.traction(basis, "top", (0.0, -50.0))
    start = model.run([sc.Stage("load", load, duration=1e-3)], progress=False)
    open_, time = [sides, water.dofs("top", "bottom")], 0.197 / 0.8
    if by == "a file":
        start.save(tmp_path / "load.npz")
        start = sc.load_result(tmp_path / "load.npz", forms)
    if by == "another model":
        model = sc.Model(forms, open_)
    wait = sc.Stage("wait", load, duration=time, fixed=None if by == "another model" else open_)
    stage = model.run([wait], start=start, progress=False)["wait"]
    settled = -stage.x[basis.get_dofs("top").all("u^2")].mean() / (50.0 * 2.0 / 8e3)
    assert settled == pytest.approx(
        0.5, abs=0.01
    )  # what leaves while the load comes, in a step as long as h^2 / 8 c_v
    assert not stage.forms["water"].pressure(stage.x)[mesh.p[1] == 2.0].any()


def test_water_that_is_not_activated():
    """The start holds the ground alone: without `activate` it would settle at once, and nothing
    would tell so.
    """
    basis, clay, water = ground()
    fixed, load = sc.box_supports(basis, base="fixed"), sc.traction(basis, "top", (0.0, -50.0))
    start = sc.Model({"clay": clay}, fixed).run([sc.Stage("rest")], progress=False)
    model = sc.Model({"clay": clay, "water": water}, [fixed, water.dofs("top")])
    for active, duration in (((), 1.0), ((), 0.0), ("water", 1.0)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            model.run(
                [sc.Stage("load", load, duration=duration, activate=active)],
                start=start,
                progress=False,
            )
        told = any(
            "['water'] is not active in a stage with a duration" in str(w.message) for w in caught
        )
        assert told == (duration > 0.0 and not active)


@pytest.mark.parametrize(("line", "told"), [("inner", True), ("top", False), ("slit", False)])
def test_water_passes_through_a_bonded_beam(line, told):
    """A wall that shares nodes with porous ground on both sides is no boundary of its water, one in
    a slit is.
    """
    mesh = (
        MeshTri.init_tensor(np.linspace(0, 4, 5), np.linspace(-4, 0, 5))
        .with_defaults()
        .with_boundaries({"inner": lambda x: (x[0] == 2) & (x[1] > -2)}, boundaries_only=False)
    )
    mesh = sc.split_along(mesh, "inner") if line == "slit" else mesh
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    wall = sc.Beam(
        basis, "inner|left" if line == "slit" else line, EI=1e3, EA=1e6, bonded=line != "slit"
    )
    water = sc.PoreWater(basis, 1e-3, unit_weight=9.81)
    forms = {
        "clay": sc.SolidForm(basis, sc.LinearElastic(E=8e3, nu=0.3)),
        "wall": wall,
        "water": water,
    }
    if line == "slit":
        forms |= wall.contact(basis, sc.Coulomb(mu=0.3))
    model = sc.Model(forms, [sc.box_supports(basis), water.dofs("right")])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run(
            [sc.Stage("load", model.traction("left", (5.0, 0.0)), duration=1.0)], progress=False
        )
    assert any("water passes through 'wall'" in str(w.message) for w in caught) == told


@pytest.mark.parametrize("element", [ElementTriP2, ElementTriP1])
def test_consolidation_after_undrained_loading(element):
    """[X] Terzaghi: the pressure of Undrained clay is that of its water at first, and half is gone
    by T = .197.
    """
    mesh = MeshTri.init_tensor(np.array([0.0, 0.2]), np.linspace(0, 2, 21)).with_defaults()
    basis = Basis(mesh, ElementVector(element()), intorder=2)
    soil = sc.LinearElastic(E=8e3, nu=0.0)
    clay, water = sc.SolidForm(basis, soil), sc.PoreWater(basis, 1e-4, unit_weight=1.0)
    quick = clay.with_materials({"all": sc.Undrained(soil, nu_undrained=0.4999)})
    sides, load = sc.box_supports(basis, base="rollers"), sc.traction(basis, "top", (0.0, -50.0))
    start = sc.Model({"clay": quick}, sides).run([sc.Stage("load", load)], progress=False)
    model = sc.Model({"clay": clay, "water": water}, [sides, water.dofs("top")])
    wait = sc.Stage(
        "wait", load, duration=0.197 * 2.0**2 / 0.8, activate="water", increments=100, keep="all"
    )
    result = model.run([wait], start=start, progress=False)
    first = result["wait"].increments[0]
    pressure = first.forms["water"].pressure(first.x)
    np.testing.assert_allclose(
        pressure[mesh.p[1] < 1.5], 50.0, rtol=2e-3
    )  # the water of Undrained is compressible
    settled = -result["wait"].x[basis.get_dofs("top").all("u^2")].mean() / (50.0 * 2.0 / 8e3)
    assert settled == pytest.approx(0.5, abs=0.005)  # the allowed error in time


def test_drains_of_water_that_is_not_active():
    """They hold nothing: clay whose only drain belongs to a fill that comes later is sealed."""
    mesh = MeshTri.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 4, 9)).with_defaults()
    mesh = mesh.with_subdomains({"clay": lambda x: x[1] < 2, "fill": lambda x: x[1] > 2})
    basis, forms = Basis(mesh, ElementVector(ElementTriP2()), intorder=2), {}
    for name in ("clay", "fill"):
        part = basis.with_elements(name)
        forms |= {
            name: sc.SolidForm(part, sc.LinearElastic(E=8e3, nu=0.3), unit_weight=9.0),
            f"water of {name}": sc.PoreWater(part, 1e-3, unit_weight=9.81),
        }
    fixed = sc.box_supports(basis, base="rollers")
    model = sc.Model(forms, [fixed, forms["water of fill"].dofs("top")])
    fill = sc.Stage("fill", activate=["fill", "water of fill"], duration=1.0)
    with pytest.warns(
        sc.AnalysisWarning, match="stage 'clay'.*water of clay: no pore pressure is held"
    ):
        model.run([sc.Stage("clay", duration=1.0), fill], progress=False)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.run([sc.Stage("both", duration=1.0)], progress=False)
    assert not any("no pore pressure is held" in str(w.message) for w in caught)


@pytest.mark.parametrize(
    ("rate", "face", "ponds"), [(2.0, False, True), (2.0, True, False), (-0.5, False, False)]
)
def test_rain_that_the_ground_does_not_take(rate, face, ponds):
    """[X] Twice the permeability on a column that drains at its base: p at the top is 2 gamma_w H,
    as told.
    """
    basis, clay, water = ground()
    forms = {"clay": clay, "water": water, "rain": sc.water.Inflow(water, {"top": rate * 2e-4})}
    if face:
        forms["face"] = sc.water.SeepageFace(water, "top", 0.0)
    model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), water.dofs("bottom")])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stage = model.run([sc.Stage("rain", duration=1e5)], progress=False)["rain"]
    assert any("does not take ponds, 4 deep at (" in str(w.message) for w in caught) == ponds
    if not face:
        top = stage.forms["water"].pressure(stage.x)[basis.mesh.p[1] == 0.0]
        np.testing.assert_allclose(
            top, rate * 9.81 * 2.0, rtol=1e-3
        )  # a tenth of the allowed error in time


def test_level_beside_suction():
    """[X] The pressure at the start as `water=` is that of `water_load`; a level lacks its suction,
    which is told.
    """
    basis, clay, _ = ground()
    law = sc.water.VanGenuchten(alpha=0.5, n=2.0, content=(0.05, 0.4))
    moist = sc.water.UnsaturatedPoreWater(basis, 1e-3, retention=law, start=-1.0, unit_weight=9.81)
    fixed = [sc.box_supports(basis, base="rollers"), moist.dofs("bottom")]
    model = sc.Model({"clay": clay, "water": moist}, fixed, water_unit_weight=9.81)
    initial = model.forms["water"].initial
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        given = model.run([sc.Stage("rest", water=initial, duration=1e3)], progress=False)[-1]
        load = model.run(
            [sc.Stage("rest", sc.water_load(basis, initial), duration=1e3)], progress=False
        )[-1]
    np.testing.assert_allclose(given.x, load.x, atol=1e-12)
    with pytest.warns(
        sc.AnalysisWarning,
        match=f"none of the suction, up to {-initial.min():.3g}, with which 'water'",
    ):
        model.run([sc.Stage("rest", water=-1.0, duration=1e3)], progress=False)


def test_wet_fill_on_undrained_clay():
    """[X] The pressure of clay that stays Undrained is none of the water of a weightless fill that
    is placed on it.
    """
    mesh = MeshTri.init_tensor(np.array([0.0, 0.2]), np.linspace(0, 2, 11)).with_defaults()
    mesh = mesh.with_subdomains({"clay": lambda x: x[1] < 1, "fill": lambda x: x[1] > 1})
    mesh = mesh.with_boundaries({"middle": lambda x: x[1] == 1}, boundaries_only=False)
    basis, soil = (
        Basis(mesh, ElementVector(ElementTriP2()), intorder=2),
        sc.LinearElastic(E=8e3, nu=0.0),
    )
    forms = {
        "clay": sc.SolidForm(basis.with_elements("clay"), sc.Undrained(soil, nu_undrained=0.499)),
        "fill": sc.SolidForm(basis.with_elements("fill"), soil),
        "water": sc.PoreWater(basis.with_elements("fill"), 1e-4, unit_weight=1.0),
    }
    load = sc.traction(forms["clay"], "middle", (0.0, -50.0))
    model = sc.Model(forms, [sc.box_supports(basis, base="rollers"), forms["water"].dofs("top")])
    stages = [
        sc.Stage("load", load),
        sc.Stage("fill", load, activate=["fill", "water"], duration=0.1),
    ]
    stage = model.run(stages, progress=False)["fill"]
    assert np.nanmax(abs(stage.forms["water"].pressure(stage.x))) < 1e-6  # round-off of 50
    assert stage.pore_pressure("clay").max() == pytest.approx(50.0, rel=5e-3)


def test_ground_that_becomes_undrained_beside_its_water():
    """It has PoreWater already, which would count twice: a stage refuses it as the model does, or
    deactivates it.
    """
    basis, clay, water = ground()
    quick = {
        "clay": clay.with_materials(
            {"all": sc.Undrained(sc.LinearElastic(E=8e3, nu=0.3), nu_undrained=0.499)}
        )
    }
    model = sc.Model({"clay": clay, "water": water}, [sc.box_supports(basis), water.dofs("top")])
    start = model.run([sc.Stage("rest", duration=1.0)], progress=False)
    load = model.traction("top", lambda x: np.stack((0 * x[0], -50.0 * (x[0] < 2.0))))
    with pytest.raises(
        ValueError, match="'quick': 256 elements are Undrained and have PoreWater too"
    ):
        model.run(
            [sc.Stage("quick", load, change=quick, duration=1.0)], start=start, progress=False
        )
    stage = model.run(
        [sc.Stage("quick", load, change=quick, deactivate="water")], start=start, progress=False
    )["quick"]
    assert stage.pore_pressure("clay").max() > 25.0


def test_levels_beside_inclined_gravity():
    """[X] A level would stand along the last axis; as a function of the coordinates water is 10
    times the depth.
    """
    mesh = MeshTri.init_tensor(np.linspace(0, 2, 3), np.linspace(0, 4, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    model = sc.Model(
        {"soil": soil}, basis.get_dofs("right").all(), gravity=(1.0, 0.0), water_unit_weight=10.0
    )
    for level in (3.0, [(0.0, 3.0), (2.0, 3.0)]):
        with pytest.raises(
            ValueError, match=r"levels need gravity against the last axis, not \[1.0, 0.0\]"
        ):
            model.run([sc.Stage("rest", water=level)], progress=False)
    stage = model.run([sc.Stage("rest", water=lambda x: 10.0 * x[0])], progress=False)["rest"]
    np.testing.assert_allclose(
        stage.reactions().reshape(-1, 2).sum(axis=0), (-(20.0 - 10.0) * 8.0, 0.0), atol=1e-9
    )
