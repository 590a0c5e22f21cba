"""Consolidation of ground with air in its pores: limits without air and without strain,
equilibrium, and tangent.
"""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.integrate import quad
from skfem import Basis, ElementQuad1, ElementTriP1, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
from skfem_contact.water.pore_storage import _upward
from tests.tools.helpers import check_tangent_of_water, two_soils, vector_basis

WATER = 10.0
LOAM = sc.water.VanGenuchten(alpha=3.35, n=2.0, content=(0.102, 0.368))
SILT = sc.water.VanGenuchten(alpha=1.0, n=3.0, content=(0.05, 0.4))
SAND = sc.water.BrooksCorey(entry=0.1, index=2.0, content=(0.05, 0.4))
QUIET = {"progress": False}
pytestmark = pytest.mark.filterwarnings(
    "ignore:.*(no pore pressure is held|no water can leave|less than h² / 3 c_v)"
)


def column(element: str = "P2", n: int = 20, height: float = 1.0) -> Basis:
    kind = MeshTri if element[0] == "P" else MeshQuad
    mesh = kind.init_tensor(np.array([0.0, 0.1]), np.linspace(0, height, n + 1)).with_defaults()
    return vector_basis(mesh, element, intorder=2)


def pores(basis: Basis, retention=LOAM, start=1.0, k: float = 0.08, **options) -> sc.PoreWater:
    return sc.PoreWater(basis, k, retention=retention, start=start, unit_weight=WATER, **options)


def model(
    basis: Basis, water: sc.PoreWater, E: float, drained: str | None = "bottom", **forms
) -> sc.Model:
    strain = "b_bar" if isinstance(basis.elem.elem, ElementQuad1) else "full"
    solid = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0), strain=strain)
    fixed = [sc.box_supports(basis, base="rollers"), *([water.dofs(drained)] if drained else [])]
    return sc.Model({"soil": solid, "water": water, **forms}, fixed)


def lowered(
    drained: sc.Model, head: float, duration: float, name: str = "lower", **options
) -> sc.Stage:
    """A stage in whose first step the head at the bottom falls to a value, and stays there."""
    return sc.Stage(
        name,
        prescribed=drained.forms["water"].prescribed({"bottom": WATER * (head - 1.0)}),
        duration=duration,
        **options,
    )


# -- limits


@pytest.mark.slow
def test_rigid_ground_drains_by_richards() -> None:
    """[N] Ground that hardly strains has the heads of `Flow.in_time`: within .1 % after its
    water has drained.
    """
    basis = column()
    drained = model(basis, pores(basis), 1e7)
    result = drained.run(
        [lowered(drained, -1.0, 1e-6), lowered(drained, -1.0, 1.0, "wait")], **QUIET
    )
    head = (
        basis.mesh.p[1]
        + (1.0 - basis.mesh.p[1])
        + result[-1].forms["water"].pressure(result[-1].x) / WATER
    )
    rigid = sc.water.Flow(
        Basis(basis.mesh, ElementTriP1()), 0.08, unit_weight=WATER, retention=LOAM
    ).in_time(sc.water.Conditions(suction={"bottom": 1.0}), times=[0.0, 1.0], start=1.0, error=5e-3)
    assert np.abs(rigid[-1].head - head).max() < 1e-3 * np.ptp(
        rigid[-1].head
    )  # steps of second order in both
    water, state = result[-1].forms["water"], result[-1].states["water"]
    assert water.volume(state) == pytest.approx(rigid.entered[-1], rel=1e-3)
    assert water.volume(state) == pytest.approx(water.inflow(state, "bottom"), rel=1e-8)


@pytest.mark.slow
def test_rain_on_dry_ground() -> None:
    """[N] All rain enters, and its front is that of `Flow.in_time`: within 1 % of the head."""
    basis = column()
    water = pores(basis, start=-1.0)
    wet = model(basis, water, 1e5, None, rain=sc.water.Inflow(water, {"top": 0.05}))
    stage = wet.run([sc.Stage("rain", duration=1.0, increments=10)], **QUIET)[-1]
    assert water.volume(stage.states["water"]) == pytest.approx(0.005, rel=1e-8)
    rigid = sc.water.Flow(
        Basis(basis.mesh, ElementTriP1()), 0.08, unit_weight=WATER, retention=LOAM
    ).in_time(sc.water.Conditions(flux={"top": 0.05}), times=[0.0, 1.0], start=-1.0, error=5e-3)
    head = -1.0 + stage.forms["water"].pressure(stage.x) / WATER
    assert np.abs(rigid[-1].head - head).max() < 0.01 * np.ptp(rigid[-1].head)


@pytest.mark.parametrize(
    ("element", "coordinates"), [("P2", "plane"), ("P1", "axisymmetric"), ("Q1", "plane")]
)
def test_saturated_ground_is_that_of_pore_water(element: str, coordinates: str) -> None:
    """[N] Below the water table the equations are linear: the same steps, displacements and
    pressures to 1e-10.
    """
    kind = MeshTri if element[0] == "P" else MeshQuad
    mesh = (
        kind.init_tensor(np.linspace(0, 1, 4), np.linspace(0, 1, 5))
        .with_defaults()
        .with_subdomains({"a": lambda x: x[0] < 0.5, "b": lambda x: x[0] >= 0.5})
    )
    basis = vector_basis(mesh, element, intorder=4)
    known = {"permeability": {"a": 1e-2, "b": (3e-2, 1e-2)}, "unit_weight": WATER, "storage": 1e-5}
    found = []
    laws = {"a": LOAM, "b": SAND}
    for water in (
        sc.PoreWater(basis, **known),
        sc.PoreWater(basis, **known, retention=laws, start=50.0),
    ):
        solid = sc.SolidForm(
            basis,
            sc.LinearElastic(E=1e3, nu=0.2),
            coordinates=coordinates,
            strain="b_bar" if element == "Q1" else "full",
        )
        load = sc.traction(solid, "top", (0.0, -10.0))
        forms = {"soil": solid, "water": water}
        found.append(
            sc.Model(forms, [basis.get_dofs("bottom").all(), water.dofs("top")]).run(
                [sc.Stage("load", load, duration=1e-2), sc.Stage("wait", load, duration=0.1)],
                **QUIET,
            )
        )
    linear, same = (result[-1] for result in found)
    first, (a, b) = linear.forms["water"].first, (stage.states["water"] for stage in (linear, same))
    assert [len(stage.iterations) for stage in found[0]] == [
        len(stage.iterations) for stage in found[1]
    ]
    np.testing.assert_allclose(
        same.x[:first], linear.x[:first], atol=1e-10 * np.abs(linear.x[:first]).max()
    )
    np.testing.assert_allclose(same.x[first:], linear.x[first:], atol=1e-10 * 10.0)  # of the load
    np.testing.assert_allclose(b.entered, a.entered, atol=1e-10 * np.abs(a.entered).max())


# -- equilibrium


@pytest.mark.parametrize("element", ["P2", "P1", "Q1"])
def test_settlement_by_suction(element: str) -> None:
    """[X] In the end suction and the loss of weight strain each point: settlement and water by
    quadrature.
    """
    basis = column(element, n=40)
    drained = model(basis, pores(basis, SILT, k=1e-2), 1e3)
    stage = drained.run([lowered(drained, 0.0, 1e5)], **QUIET)[-1]

    def strain(y: float) -> float:
        lost = (
            0.35
            * WATER
            * quad(lambda z: SILT.saturation(np.array([z]), np.ones(1))[0].item() - 1, y, 1)[0]
        )
        bishop = -SILT.saturation(np.array([y]), np.ones(1))[0].item() * WATER * y - WATER * (1 - y)
        return (bishop - lost) / 1e3

    def volume(y: float) -> float:
        filled = SILT.saturation(np.array([y]), np.ones(1))[0].item()
        return 0.35 * (filled - 1) + (0.05 + 0.35 * filled) / 0.4 * strain(y)

    settled = stage.x[basis.get_dofs("top").all("u^2")].mean()
    assert settled == pytest.approx(
        quad(strain, 0, 1)[0], rel=5e-4
    )  # 40 elements: the saturation is curved
    assert drained.forms["water"].volume(stage.states["water"]) / 0.1 == pytest.approx(
        quad(volume, 0, 1)[0], rel=1e-3
    )
    np.testing.assert_allclose(
        stage.forms["water"].pressure(stage.x), -WATER, rtol=1e-3
    )  # the last water leaves late


@pytest.mark.parametrize("by", ["level", "seepage"])
def test_water_under_suction_rests(by: str) -> None:
    """[X] Ground in equilibrium with its weight, its water and a suction above the table stays as
    it is.
    """
    basis = column(n=10)
    still = sc.water.Flow(basis, 0.08, unit_weight=WATER, retention=LOAM).steady(
        sc.water.Conditions(head={"left": 0.4})
    )
    drained = model(basis, pores(basis, start=0.4 if by == "level" else still), 1e3)
    initial, suction = drained.forms["water"].initial, basis.mesh.p[1] - 0.4
    np.testing.assert_allclose(
        initial, -WATER * suction * LOAM.saturation(suction, np.ones(1))[0], atol=1e-12
    )
    load = sc.weight(basis, 18.0) + sc.water_load(basis, initial)
    soil = sc.Model({"soil": drained.forms["soil"]}, sc.box_supports(basis, base="rollers"))
    start = soil.gravity_state(load)
    stage = drained.run(
        [sc.Stage("wait", load, duration=1e3, activate="water")], start=start, **QUIET
    )[-1]
    moved = stage.x[: basis.N] - start[-1].x[: basis.N]
    assert (
        np.abs(moved).max() < 1e-12 and np.abs(stage.forms["water"].pressure(stage.x)).max() < 1e-9
    )  # round-off
    assert abs(drained.forms["water"].volume(stage.states["water"])) < 1e-12


@pytest.mark.filterwarnings("ignore:the factor of safety .* too high")
@pytest.mark.parametrize(("start", "told"), [(0.4, True), (1.0, False), (1.5, False)])
def test_level_without_the_suction_of_the_start(start: float, told: bool, recwarn) -> None:
    """A level at rest has no suction above it: told with its size, and not of saturated ground."""
    basis = column(n=2)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0))
    forms = {"soil": soil, "water": pores(basis, start=start)}
    moist = sc.Model(forms, sc.box_supports(basis), water_unit_weight=WATER)
    moist.run([sc.Stage("wait", water=start, duration=1.0)], **QUIET)
    texts = [str(w.message) for w in recwarn if "has none of the suction" in str(w.message)]
    assert len(texts) == told
    if told:
        suction = -moist.forms["water"].initial.min()
        assert f"up to {suction:.3g}, with which 'water' begins" in texts[0]


@pytest.mark.slow
def test_suction_is_strength() -> None:
    """[N] A search with the water finds the factor of one with its Bishop pressure as a load."""
    mesh = MeshTri.init_tensor(np.linspace(0, 2, 9), np.linspace(0, 1, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = pores(basis, SILT, start=-0.5, k=1e-3)
    ground = {"soil": sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=2.0, phi=30.0, psi=30.0))}
    fixed = [basis.get_dofs("bottom").all(), basis.get_dofs("left").all("u^1")]
    wet = sc.Model({**ground, "water": water}, [*fixed, water.dofs("bottom")])
    load, options = sc.weight(basis, 18.0), {"certify": False, "tolerance": 2e-3, **QUIET}
    whole = load + sc.water_load(basis, wet.forms["water"].initial)
    result = wet.run([sc.Stage("cut", whole, duration=1e-3)], **QUIET)
    factor = wet.strength_reduction(start=result, **options).factor
    other = sc.Model(ground, fixed)
    assert factor == pytest.approx(
        other.strength_reduction(whole, **options).factor, rel=5e-3
    )  # of two searches
    assert factor > 1.1 * other.strength_reduction(load, **options).factor


# -- tangent, files and units


@pytest.mark.parametrize(
    ("element", "coordinates"), [("P2", "plane"), ("P1", "axisymmetric"), ("Q1", "plane")]
)
def test_tangent(element: str, coordinates: str) -> None:
    """[N] Central differences of forces and water, in part saturated, with layers, storage and
    stabilisation.
    """
    soils = {
        "retention": {"a": LOAM, "b": SAND},
        "start": 0.5,
        "unit_weight": WATER,
        "storage": 1e-5,
    }
    water = sc.PoreWater(two_soils(element), {"a": 1e-2, "b": (3e-2, 1e-2)}, **soils)
    form, x = check_tangent_of_water(water, 1e3, coordinates)
    state = form.initial_state(0.3 * x)
    assert form.assemble(x, state).state.stored == pytest.approx(
        form.initial_state(x).stored, rel=1e-12
    )


def test_saved_resumed_and_counted_anew(tmp_path) -> None:
    """[N] An analysis that is read from a file, or counts displacements anew, in the middle ends as
    in one go.
    """
    basis = column(n=5)
    drained = model(basis, pores(basis, SILT, k=1e-2, time_error=0.1), 1e3)
    stages = [lowered(drained, 0.0, 20.0), lowered(drained, 0.0, 1e3, "wait")]
    whole, first = drained.run(stages, **QUIET), drained.run(stages[:1], **QUIET)
    first.save(tmp_path / "first")
    later = drained.run(stages[1:], start=sc.load_result(tmp_path / "first", drained), **QUIET)
    np.testing.assert_allclose(later[-1].x, whole[-1].x, rtol=1e-9, atol=1e-12)
    anew = drained.run(stages[1:], start=first.reset(), **QUIET)[-1]
    top = basis.get_dofs("top").all("u^2")
    total = anew.x[top] + first[-1].x[top]
    np.testing.assert_allclose(
        total, whole[-1].x[top], rtol=1e-2
    )  # the pores count from the new shape
    assert water_of(anew) == pytest.approx(water_of(whole[-1]), rel=1e-2)


def water_of(stage) -> float:
    return stage.forms["water"].volume(stage.states["water"])


def test_units() -> None:
    """[X] In kN, m and days or in N, mm and hours the ground settles alike."""
    found = []
    for length, force, time in ((1.0, 1.0, 1.0), (1e3, 1e3, 24.0)):
        mesh = column(n=4).mesh.scaled(length)
        basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
        law = sc.water.VanGenuchten(alpha=1.0 / length, n=3.0, content=(0.05, 0.4))
        water = sc.PoreWater(
            basis,
            1e-2 * length / time,
            retention=law,
            start=length,
            unit_weight=WATER * force / length**3,
        )
        drained = model(basis, water, 1e3 * force / length**2)
        lower = drained.forms["water"].prescribed({"bottom": -WATER * force / length**2})
        stage = drained.run([sc.Stage("lower", prescribed=lower, duration=20.0 * time)], **QUIET)[
            -1
        ]
        found.append(stage.x[basis.get_dofs("top").all("u^2")].mean() / length)
    assert found[1] == pytest.approx(found[0], rel=1e-8)


# -- bad input


class Negative(sc.water.Retention):
    """A law beyond its range."""

    content = (0.0, 0.3)

    def saturation(self, suction, size):
        return 1.0 - suction, -np.ones_like(suction)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"retention": sc.water.VanGenuchten(2.0, 3.0)},
            r"retention has no content: give the residual",
        ),
        ({"retention": {"a": LOAM}}, "no subdomain 'a'"),
        ({"start": np.nan}, "start must be a Seepage or a finite number or a function"),
        ({"start": lambda x: np.ones(3)}, "the start must be a finite number"),
        ({"permeability": 0.0}, "permeability must be positive"),
        ({"storage": -1.0}, "storage must be finite and not negative"),
    ],
)
def test_bad_input(changes: dict, message: str) -> None:
    arguments = {
        "permeability": 1e-2,
        "retention": LOAM,
        "start": 1.0,
        "unit_weight": WATER,
    } | changes
    with pytest.raises(ValueError, match=message):
        sc.PoreWater(column(n=2), **arguments)


def test_bad_surroundings() -> None:
    """Saturations below zero, undrained soil beside the water, water whose law changes, and no
    model.
    """
    with pytest.raises(
        ValueError, match=re.escape("content is the residual and the saturated content of water")
    ):
        sc.water.VanGenuchten(2.0, 3.0, content=(-0.1, 0.4))
    basis = column(n=2)
    with pytest.raises(
        ValueError,
        match=r"contents of water at the start, from -0.15 to 0.15, are not between 0 and",
    ):
        model(basis, pores(basis, Negative(), start=lambda x: x[1] - 0.5 - x[1]), 1e3)
    with pytest.raises(ValueError, match="the model completes the water"):
        _ = pores(basis).initial
    undrained = sc.SolidForm(
        basis, sc.Undrained(sc.LinearElastic(E=1e3, nu=0.2), nu_undrained=0.49)
    )
    with pytest.raises(ValueError, match="is Undrained and has PoreWater too"):
        sc.Model({"soil": undrained, "water": pores(basis)}, basis.get_dofs("bottom").all())
    drained = model(basis, pores(basis), 1e3)
    linear = sc.PoreWater(basis, 0.08, unit_weight=WATER)
    for other, reason in (
        (pores(basis, SILT), "its retention or its start is another"),
        (linear, "its retention or its start is another"),
    ):
        stages = [
            sc.Stage("wait", duration=1.0),
            sc.Stage("other", duration=1.0, change={"water": other}),
        ]
        with pytest.raises(ValueError, match=reason):
            drained.run(stages, **QUIET)


def test_weight_by_corner_of_an_axisymmetric_ground() -> None:
    """[X] The unit weight on a ring from 1 to 3, 2 high: its volume 2 (3^2 - 1) / 2 per radian."""
    mesh = MeshQuad.init_tensor(np.linspace(1, 3, 4), np.linspace(0, 2, 3))
    basis = vector_basis(mesh, "Q1", intorder=3)
    corners = basis.with_element(ElementQuad1())
    for axisymmetric, volume in ((True, 8.0), (False, 4.0)):
        assert _upward(basis, corners, axisymmetric).sum() == pytest.approx(volume, rel=1e-12)
