"""Water at given rates: rain, wells and sources, in steady flow and in consolidation."""

from __future__ import annotations

import warnings
from contextlib import suppress
from copy import copy

import numpy as np
import pytest
from scipy.sparse import diags
from scipy.special import exp1
from skfem import Basis, ElementHex1, ElementQuad1, MeshHex, MeshQuad

import skfem_contact as sc
from tests.tools.flows import steady
from tests.tools.helpers import vector_basis

#: Permeability and unit weight of water.
K, WATER = 1e-5, 10.0


def heads(mesh):
    return Basis(mesh, ElementHex1() if mesh.dim() == 3 else ElementQuad1())


def strip(length=40.0, height=10.0, n=1):
    return MeshQuad.init_tensor(
        np.linspace(0, length, 40 * n + 1), np.linspace(0, height, 20 * n + 1)
    ).with_defaults()


@pytest.mark.parametrize(("n", "tolerance"), [(1, 5e-4), (2, 2.5e-4)])
def test_rain_between_two_ditches(n, tolerance):
    """[X] N. K. Girinskii: the integral of h - y over the depth is (h0² + N x (L - x) / k) / 2 for
    any surface.
    """
    rain, level, length = 1e-6, 3.0, 40.0
    ditches = {"left": level, "right": level}
    water = sc.water.Flow(heads(strip(n=n)), K, unit_weight=WATER).steady(
        sc.water.Conditions(head=ditches, flux={"top": rain}, seepage_face=list(ditches))
    )
    assert water.discharge("top") == pytest.approx(
        rain * length, rel=1e-9
    )  # the balance of the iteration
    for name in ditches:
        assert water.discharge(name) == pytest.approx(-0.5 * rain * length, rel=1e-9)
    y = np.linspace(0, 10, 4001)
    above = np.maximum(water.head_at(np.array([np.full_like(y, 0.5 * length), y])) - y, 0.0)
    exact = 0.5 * (level**2 + 0.25 * rain / K * length**2)
    # the ramp lets some water flow sideways above the surface: measured 4.4e-4 and 2.0e-4
    assert np.trapezoid(above, y) == pytest.approx(exact, rel=tolerance)


def test_rain_that_the_ground_does_not_take():
    """[X] Rain that floods the surface to its ends: the flow is that under a level there, the rest
    runs off.
    """
    mesh, ditches = strip(), {"left": 3.0, "right": 3.0}
    rule = {"unit_weight": WATER, "seepage_face": list(ditches)}
    rained = steady(heads(mesh), K, ditches, flux={"top": 1e3 * K}, **rule)
    flooded = steady(heads(mesh), K, {**ditches, "top": 10.0}, **rule)
    np.testing.assert_allclose(rained.head, flooded.head, atol=1e-9)
    enters = rained.discharge("top")
    assert enters == pytest.approx(-rained.discharge("left") - rained.discharge("right"), rel=1e-9)
    assert enters == pytest.approx(np.maximum(flooded.inflow, 0.0).sum(), rel=1e-9)


@pytest.mark.parametrize("dim", [2, 3])
def test_well_in_a_confined_layer(dim):
    """[X] Uniform flow to a screen: the drawdown is Q L / (k A)."""
    lines = [*[np.linspace(0, 4, 7), np.linspace(0, 2, 4)][: dim - 1], np.linspace(-3, -2, 4)]
    mesh = (MeshHex if dim == 3 else MeshQuad).init_tensor(*lines)
    mesh = mesh.with_boundaries({"far": lambda x: x[0] == 0.0, "screen": lambda x: x[0] == 4.0})
    area, pumped = 2.0 if dim == 3 else 1.0, 1e-4
    water = sc.water.Flow(heads(mesh), K, unit_weight=WATER).steady(
        sc.water.Conditions(head={"far": 45.0}, wells={"screen": pumped})
    )
    np.testing.assert_allclose(water.head, 45.0 - pumped / (K * area) * mesh.p[0], rtol=1e-12)
    assert water.discharge("screen") == pytest.approx(-pumped, rel=1e-12)


def test_well_with_a_radius():
    """[X] G. Thiem: the drawdown is Q ln(R / r) / 2 pi k b, in layers as well, whatever they take
    each.
    """
    r = np.geomspace(0.1, 50.0, 100)
    mesh = MeshQuad.init_tensor(r, np.linspace(0, 5, 6))
    mesh = mesh.with_boundaries({"screen": lambda x: x[0] < 0.1001, "far": lambda x: x[0] > 49.999})
    mesh = mesh.with_subdomains({"sand": lambda x: x[1] > 2.0, "silt": lambda x: x[1] < 2.0})
    pumped = 0.01 / (2 * np.pi)  # per radian
    water = sc.water.Flow(
        heads(mesh), {"sand": 1e-4, "silt": 2e-5}, unit_weight=WATER, coordinates="axisymmetric"
    ).steady(sc.water.Conditions(head={"far": 60.0}, wells={"screen": pumped}))
    drawdown = pumped / (3 * 1e-4 + 2 * 2e-5) * np.log(500.0)
    at = np.isclose(mesh.p[0], 0.1)
    # conductance of a linear element in r: (q + 1) ln(q) / 2 (q - 1) times the exact one, 3.3e-4
    # with q = 500^(1/99)
    np.testing.assert_allclose(60.0 - water.head[at], drawdown, rtol=5e-4)
    assert np.ptp(water.head[at]) < 1e-12
    assert water.discharge("screen", of="silt") == pytest.approx(-pumped * 4e-5 / 3.4e-4, rel=1e-6)


@pytest.mark.slow
def test_well_that_falls_dry_is_told():
    """More water than the head can drive to the top of the screen, with or without a balance."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 4, 13), np.linspace(0, 1, 5)).with_boundaries(
        {"screen": lambda x: x[0] == 0.0, "right": lambda x: x[0] == 4.0}
    )
    told = pytest.warns(
        sc.AnalysisWarning,
        match="well 'screen' falls dry: its level, -?[0-9.]+, lies below the top",
    )
    with told, suppress(sc.NotConverged):
        sc.water.Flow(heads(mesh), K, unit_weight=WATER).steady(
            sc.water.Conditions(head={"right": 1.5}, wells={"screen": 3e-6})
        )


def test_well_that_falls_dry_in_time_is_told():
    """The level at the end counts, and the height of the screen in space, not its width."""
    lengths = np.linspace(0, 2, 5), np.linspace(0, 0.5, 2), np.linspace(0, 1, 4)
    mesh = MeshHex.init_tensor(*lengths).with_boundaries(
        {"screen": lambda x: x[0] == 0.0, "right": lambda x: x[0] == 2.0}
    )
    loam = sc.water.VanGenuchten(alpha=3.35, n=2.0, least=1e-14, content=(0.102, 0.368))
    flow = sc.water.Flow(heads(mesh), K, unit_weight=WATER, retention=loam)

    def pumped(rate):
        conditions = sc.water.Conditions(head={"right": 1.3}, wells={"screen": rate})
        return flow.in_time(conditions, times=[0.0, 100.0], start=1.3)

    at = mesh.p[0] == 0.0
    level = 1.3 - 5e-7 * 2.0 / (0.5 * K)
    np.testing.assert_allclose(pumped(5e-7)[-1].head[at], level, rtol=1e-9)
    with pytest.warns(sc.AnalysisWarning, match="well 'screen' falls dry: its level, 0.97"):
        pumped(1e-6)


@pytest.mark.parametrize("coordinates", ["plane", "axisymmetric"])
def test_drain_with_a_resistance(coordinates):
    """[X] The resistances of ground and filter add up, and rain raises the head above the level by
    its flux.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 4, 9)).with_defaults()
    basis, area = Basis(mesh, ElementQuad1()), {"plane": 1.0, "axisymmetric": 0.5}[coordinates]
    options = {"drains": {"bottom": (5.0, 50.0)}, "unit_weight": 10.0, "coordinates": coordinates}
    water = steady(basis, 1e-2, {"top": 9.0}, **options)
    assert water.discharge("bottom") == pytest.approx(-area * 4.0 / (4.0 / 1e-2 + 50.0), rel=1e-9)
    still = steady(basis, 1e-2, {"top": 4.5}, **options)
    assert abs(still.discharge("bottom")) < 1e-12  # its level is higher, and no water enters
    options["drains"] = {"bottom": (1.0, 50.0)}
    rain = steady(basis, 1e-2, {}, flux={"top": 1e-3}, **options)
    at = mesh.p[1] == 0.0
    np.testing.assert_allclose(rain.head[at], 1.0 + 1e-3 * 50.0, rtol=1e-9)
    assert rain.discharge("bottom") == pytest.approx(-area * 1e-3, rel=1e-9)


@pytest.mark.parametrize(
    ("drain", "message"),
    [
        ({"bottom": (1.0, 0.0)}, "resistance of drain 'bottom' must be a finite number above 0"),
        ({"left": (1.0, 5.0)}, "drain 'left' shares the node at .* with a head or another drain"),
        ({"nowhere": (1.0, 5.0)}, "boundary 'nowhere'"),
    ],
)
def test_wrong_drains(drain, message):
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 4, 9)).with_defaults()
    with pytest.raises(ValueError, match=message):
        sc.water.Flow(Basis(mesh, ElementQuad1()), 1e-2, unit_weight=10.0).steady(
            sc.water.Conditions(head={"top": 9.0}, drains=drain)
        )


def test_sources():
    """[X] A source w in a strip with both ends at zero: k h'' = -w, exact at the nodes."""
    mesh = strip(4.0, 1.0).with_subdomains({"all": lambda x: x[0] > -1.0})
    water = sc.water.Flow(heads(mesh), K, unit_weight=WATER).steady(
        sc.water.Conditions(head={"left": 9.0, "right": 9.0}, sources={"all": 2e-6})
    )
    np.testing.assert_allclose(water.head, 9.0 + 0.1 * mesh.p[0] * (4.0 - mesh.p[0]), rtol=1e-10)


def theis(r, t, pumped, transmissivity, storativity):
    return (
        pumped / (4 * np.pi * transmissivity) * exp1(r**2 * storativity / (4 * transmissivity * t))
    )


@pytest.mark.parametrize("increments", [1, 4])
def test_pumping_test_with_recovery(increments):
    """[X] C. V. Theis: drawdown at three distances while a well pumps and after it has stopped."""
    r = np.geomspace(0.05, 3000.0, 111)
    mesh = MeshQuad.init_tensor(r, np.array([0.0, 5.0]))
    sides = {
        "screen": lambda x: x[0] < 0.0501,
        "far": lambda x: x[0] > 2999.0,
        "bottom": lambda x: x[1] == 0.0,
    }
    mesh = mesh.with_boundaries(sides)
    basis = vector_basis(mesh, "Q1", intorder=2)
    k, b, stiffness, pumped = 1e-4, 5.0, 1e5, 0.01
    water = sc.PoreWater(basis, k, unit_weight=WATER, time_error=1e-3)
    forms = {
        "sand": sc.SolidForm(
            basis, sc.LinearElastic(E=stiffness, nu=0.0), coordinates="axisymmetric"
        ),
        "water": water,
        "well": sc.water.Inflow(water, {"screen": -pumped / (2 * np.pi * 0.05 * b)}),
    }
    fixed = [
        basis.get_dofs(elements=True).all("u^1"),
        basis.get_dofs("bottom").all("u^2"),
        water.dofs("far"),
    ]
    stages = [
        sc.Stage("pump", duration=6e4, increments=increments),
        sc.Stage("rest", duration=3e4, increments=increments, deactivate="well"),
    ]
    result = sc.Model(forms, fixed).run(stages, progress=False)
    T, S = k * b, WATER * b / stiffness
    for stage, exact in (
        ("pump", lambda r: theis(r, 6e4, pumped, T, S)),
        ("rest", lambda r: theis(r, 9e4, pumped, T, S) - theis(r, 3e4, pumped, T, S)),
    ):
        at = np.flatnonzero((mesh.p[0] > 1.0) & (mesh.p[0] < 30.0))
        drawdown = -result[stage].forms["water"].pressure(result[stage].x)[at] / WATER
        # the mesh has 1e-3 (elements grow by 1.11), the steps in time as much
        np.testing.assert_allclose(drawdown, exact(mesh.p[0, at]), rtol=3e-3)
    pumping = result["pump"].forms["water"].inflow(result["pump"].states["water"])
    assert pumping == pytest.approx(-pumped / (2 * np.pi) * 6e4, rel=1e-9)


def test_wrong_rates():
    """Rates that contradict something, with the place."""
    mesh = strip(4.0, 1.0).with_boundaries({"screen": lambda x: x[0] == 0.0})
    basis, level = heads(mesh), {"left": 1.5}

    def flow(head=level, **given):
        return steady(basis, K, head, unit_weight=WATER, **given)

    with pytest.raises(ValueError, match="boundary 'left' has a flux and a head at all its nodes"):
        flow(flux={"left": 1e-6})
    with pytest.raises(ValueError, match=r"well 'screen' shares the node at \(0, 0\) with a head"):
        flow(wells={"screen": 1e-6})
    with pytest.raises(
        ValueError, match="wells must be a dictionary of names, each a finite number"
    ):
        flow({"right": 1.5}, wells={"screen": np.nan})
    with pytest.raises(
        ValueError, match="the flux must be a finite number, or a function of coordinates"
    ):
        flow(flux={"top": lambda x: np.nan * x[0]})
    with pytest.raises(ValueError, match="subdomain"):
        flow(sources={"nowhere": 1e-6})
    with pytest.raises(ValueError, match="Inflow has neither flux nor sources"):
        sc.water.Inflow(sc.PoreWater(vector_basis(mesh, "Q1", intorder=2), K, unit_weight=WATER))


def column_of_clay(fixed=(), **rates):
    """A saturated column with water that enters at rates."""
    mesh = MeshQuad.init_tensor(np.array([0.0, 0.1]), np.linspace(0, 1, 6)).with_defaults()
    mesh = mesh.with_subdomains({"all": lambda x: x[0] > -1.0})
    basis = vector_basis(mesh, "Q1", intorder=2)
    pores = sc.PoreWater(basis, permeability=1e-4, unit_weight=WATER)
    forms = {
        "clay": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0)),
        "water": pores,
        "rain": sc.water.Inflow(pores, **rates),
    }
    model = sc.Model(
        forms, [sc.box_supports(basis, base="rollers"), *(pores.dofs(name) for name in fixed)]
    )
    return model.run([sc.Stage("rain", duration=10.0)], progress=False)


def test_rates_that_do_nothing_are_told() -> None:
    """Where the pressure is held a rate has no effect; in sealed ground its volume is told."""
    with pytest.raises(ValueError, match="the pressure is held at all nodes where water enters"):
        column_of_clay(["top"], flux={"top": 1e-6})
    with pytest.warns(sc.AnalysisWarning, match="of the rate acts where the pressure is held"):
        column_of_clay(["top", "bottom"], flux={"top": 1e-6}, sources={"all": 1e-6})
    with pytest.warns(
        sc.AnalysisWarning, match="2e-07 enter per time in ground that no water can leave"
    ):
        column_of_clay(flux={"top": 2e-6})
    with pytest.raises(ValueError, match="neither flux nor sources"):
        column_of_clay()


def test_heave() -> None:
    """[X] Water that rises at a gradient i: the buoyant weight over i times the unit weight of
    water, in any part.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 4, 9)).with_defaults()
    mesh = mesh.with_subdomains(
        {
            "prism": lambda x: (x[0] < 1) & (x[1] > 2),
            "tight": lambda x: x[1] < 2,
            "open": lambda x: x[1] > 2,
        }
    )
    for axis in ("plane", "axisymmetric"):
        water = sc.water.Flow(heads(mesh), K, unit_weight=WATER, coordinates=axis).steady(
            sc.water.Conditions(head={"bottom": 6.0, "top": 4.0})
        )
        assert water.heave_factor("prism", 20.0) == pytest.approx(10.0 / (0.5 * WATER), rel=1e-9)
    layers = sc.water.Flow(heads(mesh), {"open": K, "tight": K / 9}, unit_weight=WATER).steady(
        sc.water.Conditions(head={"bottom": 6.0, "top": 4.0})
    )
    assert layers.heave_factor("open", 20.0) == pytest.approx(10.0 / (0.1 * WATER), rel=1e-9)
    down = sc.water.Flow(heads(mesh), K, unit_weight=WATER).steady(
        sc.water.Conditions(head={"bottom": 4.0, "top": 5.0})
    )
    assert down.heave_factor("prism", 20.0) == np.inf
    with pytest.raises(ValueError, match="saturated ground, more than 10"):
        down.heave_factor("prism", 9.0)
    with pytest.raises(ValueError, match="above the free surface"):
        sc.water.Flow(heads(mesh), K, unit_weight=WATER).steady(
            sc.water.Conditions(head={"left": 1.0, "right": 1.0})
        ).heave_factor("prism", 20.0)


@pytest.mark.parametrize(
    "given",
    [
        {"head": {"left": 3.0, "right": 5.0}},
        {"head": {"right": 5.0}, "flux": {"left": 1e-6}},
        {"head": {"right": 5.0}, "seepage_face": "left"},
    ],
)
def test_no_water_passes_through_an_axis(given):
    """There a head would be a well without a radius, whose discharge depends on the mesh alone."""
    with pytest.raises(ValueError, match="'left' lies on the axis and has no area"):
        steady(heads(strip()), K, **given, unit_weight=WATER, coordinates="axisymmetric")
    hollow = strip().translated((0.5, 0.0))
    assert steady(
        heads(hollow), K, **given, unit_weight=WATER, coordinates="axisymmetric"
    ).head.size


@pytest.mark.parametrize("axis", ["plane", "axisymmetric", "space"])
def test_uplift(axis) -> None:
    """[X] A slab under water at rest, and a plug of clay above a confined aquifer: weight over
    pressure, per area.
    """
    lines = [np.linspace(0, 4, 5), np.linspace(0, 3, 4), np.array([0, 1, 2, 3, 4.5, 5])]
    mesh = MeshHex.init_tensor(*lines) if axis == "space" else MeshQuad.init_tensor(*lines[::2])
    mesh = mesh.with_defaults().with_subdomains(
        {
            "sand": lambda x: x[-1] < 2,
            "clay": lambda x: (x[-1] > 2) & (x[-1] < 4.5) & (x[0] < 3),
            "slab": lambda x: (x[-1] > 4.5) & (x[0] < 3),
            "plug": lambda x: (x[-1] > 2) & (x[0] < 3),
            "bank": lambda x: (x[-1] > 2) & (x[0] > 3),
        }
    )
    mesh = mesh.with_boundaries(
        {
            "base": lambda x: (x[-1] == 2) & (x[0] < 3),
            "sole": lambda x: (x[-1] == 4.5) & (x[0] < 3),
            "outline": lambda x: (
                (x[0] < 3) & (abs(x[-1] - 3.25) > 1.2) & (x[-1] > 1.9) & (x[-1] < 4.6)
            ),
            "roof": lambda x: (x[-1] == 5) & (x[0] < 3),
        },
        boundaries_only=False,
    )
    basis, rule = (
        heads(mesh),
        {"unit_weight": WATER, "coordinates": None if axis == "space" else axis},
    )
    area = {"plane": 3.0, "axisymmetric": 4.5, "space": 9.0}[axis]  # of the slab, per radian
    ground = steady(basis.with_elements(["sand", "clay", "bank"]), K, {"right": 7.0}, **rule)
    assert ground.uplift_factor("sole", {"slab": 24.0}) == pytest.approx(
        0.5 * 24.0 / (2.5 * WATER), rel=1e-9
    )
    held = ground.uplift_factor("sole", {"slab": 24.0}, load=30.0 * area)
    assert held == pytest.approx((0.5 * 24.0 + 30.0) / (2.5 * WATER), rel=1e-9)
    plug = {"clay": 20.0, "slab": 24.0}
    aquifer = steady(basis.with_elements("sand"), K, {"right": 6.0}, **rule)
    for flow, head in ((aquifer, 6.0), (ground, 7.0)):  # the clay tight, or porous ground as well
        exact = (2.5 * 20.0 + 0.5 * 24.0) / ((head - 2.0) * WATER)
        assert flow.uplift_factor("base", plug) == pytest.approx(exact, rel=1e-9)
    buried = steady(basis.with_elements(["sand", "slab", "bank"]), K, {"right": 9.0}, **rule)
    assert buried.uplift_factor("outline", {"clay": 20.0}) == pytest.approx(20.0 / WATER, rel=1e-9)
    for bottom, weights, told in (
        ("roof", plug, "facets without porous ground"),
        ("floor", plug, "there is no boundary 'floor'"),
        ("base", {}, "what lies above, not {}"),
        ("base", {"loam": 20.0}, "there is no subdomain 'loam'"),
        ("base", {"clay": 20.0, "plug": 24.0}, "have more than one unit weight"),
    ):
        with pytest.raises(ValueError, match=told):
            aquifer.uplift_factor(bottom, weights)
    with pytest.raises(ValueError, match="no water presses upwards on boundary 'roof'"):
        steady(basis, K, {"right": 1.0}, **rule).uplift_factor("roof", plug)


class Filter(sc.Form, sc.roles.Couples, sc.roles.Timed, sc.roles.Draining):
    """Filter in front of a boundary: water leaves by the pressure over a resistance."""

    duration, second_order = 0.0, True

    def __init__(self, water, boundary, outflow):
        self.borrowed, self.outflow, self.leaks = (
            water.fields,
            outflow,
            water.dofs(boundary).indices,
        )

    def numbered(self, numbers):
        new = copy(self)
        new.at = numbers[self.borrowed[0]][self.leaks]
        return new

    def over(self, duration):
        new = copy(self)
        new.duration = duration
        return new

    def assemble(self, x, state):
        rate = np.zeros(len(x))
        rate[self.at] = -self.duration * self.outflow / len(self.at)
        return sc.Response(rate * x, lambda: None, lambda: diags(rate).tocsr())


def test_form_of_ones_own_that_lets_water_out():
    """[X] Behind a filter the pressure q decays by exp(-r E t / H): its leaks are no sealed
    ground.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 0.1, 2), np.linspace(0, 1, 5)).with_defaults()
    basis = vector_basis(mesh, "Q1", intorder=2)
    water = sc.PoreWater(basis, 1.0, unit_weight=WATER)
    forms = {
        "clay": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0)),
        "water": water,
        "filter": Filter(water, "top", 0.1 * 1e-5),
    }
    model = sc.Model(forms, sc.box_supports(basis, base="rollers"))
    load = model.traction("top", (0.0, -10.0))
    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=".*no water can leave")
        last = model.run(
            [sc.Stage("load", load, duration=1e-2), sc.Stage("wait", load, duration=100.0)],
            progress=False,
        )["wait"]
    pressure = last.forms["water"].pressure(last.x)
    np.testing.assert_allclose(
        pressure, 10.0 * np.exp(-1.0), rtol=2e-3
    )  # time_error, and the drop in the ground
