"""Seepage where it is hard: contrasts, dry and flooded ground, units, mirrors, refinement, sharp
retention.
"""

from __future__ import annotations

import warnings
from contextlib import suppress

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementTriP1, MeshQuad, MeshTri

import skfem_contact as sc
from tests.tools.flows import steady
from tests.tools.helpers import distorted

ELEMENTS = {MeshTri: ElementTriP1, MeshQuad: ElementQuad1}


def dam(kind=MeshTri, n: int = 20, size: float = 10.0, up: float = 0.0):
    """A square dam with a core in its middle fifth and a boundary all around."""
    mesh = kind.init_tensor(
        np.linspace(0, size, n + 1), up + np.linspace(0, size, n + 1)
    ).with_defaults()
    return mesh.with_subdomains(
        {
            "core": lambda x: abs(x[0] / size - 0.5) < 0.1,
            "shell": lambda x: abs(x[0] / size - 0.5) > 0.1,
        }
    )


def flow(mesh, heads, k=1.0, face="right", **options) -> sc.water.Seepage:
    """Seepage without any warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return steady(
            Basis(mesh, ELEMENTS[type(mesh)]()),
            k,
            heads,
            seepage_face=face,
            unit_weight=9.81,
            **options,
        )


@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
@pytest.mark.parametrize("core", [1e-3, 0.1, 1e2, 1e5, 1e8])
@pytest.mark.one_in(3)
def test_core_of_another_permeability(core, kind):
    """[X] Sum of L / k of the zones; a contrast of 1e8 leaves 1e8 times the round-off between in
    and outflow.
    """
    water = flow(dam(kind), {"left": 10.0}, {"core": core, "shell": 1.0})
    # elements of .5 m in a core of 2 m through which the free surface falls by 10 m
    assert water.discharge("left") == pytest.approx(50 / (8 + 2 / core), rel=0.01)
    assert water.discharge("right") == pytest.approx(
        -water.discharge("left"), rel=1e-8 if core < 1e6 else 1e-5
    )


@pytest.mark.slow
@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
def test_tight_core_between_drained_shells(kind):
    """[X] Nearly all shells are dry and stay in the mesh: the discharge is that of Charny, without
    a warning.
    """
    water = flow(dam(kind), {"left": 10.0}, {"core": 1e-2, "shell": 1.0})
    assert water.discharge("left") == pytest.approx(50 / (8 + 2 / 1e-2), rel=2e-3)  # measured 1e-4
    assert sum(water.iterations) <= 180  # 77 to 106, 175 on finer meshes


@pytest.mark.parametrize("core", [1e-8, 1e-6, 1e-5])
def test_tight_core(core):
    """[X] Drained ground behind a tight core is as good as dry: with it the user is warned, without
    it all is well.
    """
    mesh, k = dam(), {"core": core, "shell": 1.0}
    with pytest.warns(
        sc.AnalysisWarning, match=r"flows off through dry ground at .*; leave drained ground out"
    ):
        sc.water.Flow(Basis(mesh, ElementTriP1()), k, unit_weight=9.81).steady(
            sc.water.Conditions(head={"left": 10.0}, seepage_face="right")
        )
    mesh = mesh.with_subdomains({"wet": lambda x: x[0] < 6})
    mesh = mesh.with_boundaries({"drained": mesh.facets_satisfying(lambda x: np.isclose(x[0], 6))})
    wet = Basis(mesh, ElementTriP1()).with_elements("wet")
    water = sc.water.Flow(wet, k, unit_weight=9.81).steady(
        sc.water.Conditions(head={"left": 10.0}, seepage_face="drained")
    )
    assert water.discharge("left") == pytest.approx(50 / (4 + 2 / core), rel=5e-3)
    assert water.discharge("drained") == pytest.approx(-water.discharge("left"), rel=1e-8)


def test_layers_of_another_permeability():
    """Flow in a layer 1e8 times as permeable, on top or below: it carries all, and nothing is
    lost.
    """
    for wet in (lambda x: x[1] > 5, lambda x: x[1] < 5):
        mesh = dam().with_subdomains({"sand": wet, "clay": lambda x, wet=wet: ~wet(x)})
        water = flow(mesh, {"left": 10.0}, {"sand": 1e8, "clay": 1.0})
        assert water.discharge("right") == pytest.approx(-water.discharge("left"), rel=1e-8)
        # Charny's integral over the lower layer, full of water, and over the upper one
        assert water.discharge("left") == pytest.approx(
            1e8 * (3.75 if wet([0, 0]) else 1.25), rel=0.01
        )


def test_dry_dam():
    """Water at the base alone, or none: nothing flows, and pressures are not negative."""
    for names, face in (
        (["left", "right"], ()),
        (["left"], "right"),
        (["bottom"], ["left", "right"]),
    ):
        water = flow(dam(), dict.fromkeys(names, 0.0), face=face)
        assert np.abs(water.inflow).max() < 1e-12
        assert (water.pressure >= 0).all() and water.pressure.max() < 1e-9


def test_flooded_dam():
    """[X] Water above the dam on both sides: confined flow, one linear solution, whatever the face
    is called.
    """
    for face in ((), "right"):
        water = flow(dam(), {"left": 14.0, "right": 12.0}, face=face)
        assert water.iterations == (1,)
        assert water.discharge("left") == pytest.approx(2.0, rel=1e-9)
        assert water.free_surface == []


def test_still_water():
    """One head everywhere: level water, no flow, whether the ground above it is drained or not."""
    for face in ((), ["right", "top"]):
        water = flow(dam(), {"left": 6.3}, face=face)
        assert np.abs(water.inflow).max() < (1e-9 if not face else np.inf)
        if not face:
            np.testing.assert_allclose(water.head, 6.3, rtol=1e-9)


def test_water_over_the_crest():
    """Water that stands above the crest leaves through all of the face, and through the crest where
    that is one.
    """
    closed = flow(dam(), {"left": 11.0})
    assert closed.pressure[np.isclose(dam().p[0], 10)].max() < 1e-9
    over = flow(dam(), {"left": 11.0}, face=["right", "top"])
    assert over.discharge("top") < 0 and over.discharge("left") > closed.discharge("left")


def test_drained_everywhere():
    """All boundaries are seepage faces but the one with water: it leaves below, and only where it
    reaches.
    """
    water = flow(dam(), {"left": 6.0}, face=["right", "bottom", "top"])
    assert water.discharge("bottom") < 0 == pytest.approx(water.discharge("top"))
    assert water.inflow.sum() == pytest.approx(0.0, abs=1e-8 * water.discharge("left"))


@pytest.mark.parametrize(
    ("length", "time", "height"), [(1e3, 1e-12, 0.0), (1e-3, 1e9, 0.0), (1.0, 1.0, 1e4)]
)
def test_units_and_datum(length, time, height):
    """[X] Other units of length and time and another zero of the heights scale the answer and
    nothing else.
    """
    k = {"core": 0.1, "shell": 1.0}
    base = flow(dam(n=10), {"left": 10.0, "right": 2.0}, k)
    other = flow(
        dam(n=10, size=10 * length, up=height),
        {"left": 10 * length + height, "right": 2 * length + height},
        {name: value * length / time for name, value in k.items()},
    )
    # the heights above a zero that is 1e4 away are known to 1e-12 of the dam's height
    np.testing.assert_allclose((other.head - height) / length, base.head, atol=1e-7)
    assert other.discharge("left") * time / length**2 == pytest.approx(
        base.discharge("left"), rel=1e-7
    )


def test_mirrored():
    """[X] The mirrored dam, and one whose elements run the other way round, leak the same."""
    base = flow(dam(n=10), {"left": 10.0, "right": 2.0}, {"core": 0.1, "shell": 1.0})
    mesh = MeshTri(np.stack((10 - dam(n=10).p[0], dam(n=10).p[1])), dam(n=10).t[::-1])
    mesh = mesh.with_defaults().with_subdomains(dam(n=10).subdomains)
    other = flow(mesh, {"right": 10.0, "left": 2.0}, {"core": 0.1, "shell": 1.0}, face="left")
    assert other.discharge("right") == pytest.approx(base.discharge("left"), rel=1e-8)
    np.testing.assert_allclose(other.head, base.head, atol=1e-7)


@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
def test_distorted_meshes(kind, rng):
    """[X] Elements of all shapes and of sizes from 1 to 50: the discharge stays that of the dam."""
    mesh = dam(kind)
    inner = ~np.isin(np.arange(mesh.nvertices), mesh.facets[:, mesh.boundary_facets()])
    moved = kind(np.where(inner, distorted(mesh, rng, 0.1).p, mesh.p), mesh.t).with_boundaries(
        mesh.boundaries
    )
    assert flow(moved, {"left": 10.0, "right": 2.0}).discharge("left") == pytest.approx(
        4.8, rel=0.01
    )
    x = 5 * (1 + np.sign(t := np.linspace(-1, 1, 31)) * np.abs(t) ** 2.5)
    graded = kind.init_tensor(x, np.linspace(0, 10, 31)).with_defaults()
    assert flow(graded, {"left": 10.0, "right": 2.0}).discharge("left") == pytest.approx(
        4.8, rel=0.01
    )


@pytest.mark.parametrize(
    "law",
    [
        sc.water.Ramp(0.1),
        sc.water.Ramp(4.0),
        sc.water.Ramp(least=1e-7),
        sc.water.Ramp(least=0.1),
        sc.water.VanGenuchten(0.5, 1.5),
        sc.water.VanGenuchten(10.0, 4.0),
    ],
    ids=repr,
)
@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
@pytest.mark.one_in(3)
def test_retention(law, kind):
    """Sharp and blunt transitions between wet and dry: what water the blunt ones let pass above is
    within 7 %.
    """
    water = flow(dam(kind), {"left": 10.0, "right": 2.0}, retention=law)
    assert water.discharge("left") == pytest.approx(4.8, rel=0.07)


def test_what_does_not_balance_is_warned_of(monkeypatch):
    """A transition that is wider than asked for is warned of; where none is found there is no
    answer.
    """
    from skfem_contact.water import balance

    limit = 1.2
    newton = balance.WaterBalance._newton

    def stubborn(self, now, laws, tolerance):
        if laws and laws[0][1].width < 0.5 * limit:
            raise balance.Unbalanced("it does not want to")
        return newton(self, now, laws, tolerance)

    monkeypatch.setattr(balance.WaterBalance, "_newton", stubborn)
    basis = Basis(dam(), ElementTriP1())
    with pytest.warns(
        sc.AnalysisWarning, match=r"wet and dry ground is 1\.2\d? times as wide as asked for"
    ):
        water = sc.water.Flow(basis, 1.0, unit_weight=9.81).steady(
            sc.water.Conditions(head={"left": 10.0, "right": 2.0}, seepage_face="right")
        )
    assert water.discharge("left") == pytest.approx(4.8, rel=2e-3)
    limit = np.inf
    with pytest.raises(sc.NotConverged, match="the water does not balance: it does not want to"):
        sc.water.Flow(basis, 1.0, unit_weight=9.81).steady(
            sc.water.Conditions(head={"left": 10.0, "right": 2.0}, seepage_face="right")
        )


def wet_strip(kind=MeshQuad, size: float = 1.0, mirrored: bool = False):
    """Ground of 40 by 10 m between two ditches, with the screen of a well on one side."""
    x, y = np.linspace(0, 40, 19) ** 1.2 / 40**0.2, np.linspace(0, 10, 9)
    mesh = kind.init_tensor(*(size * each for each in (40 - x[::-1] if mirrored else x, y)))
    near, far = ("right", "left") if mirrored else ("left", "right")
    sides = {"left": mesh.p[0].min(), "right": mesh.p[0].max()}
    at = sides[far]
    return mesh.with_boundaries(
        {
            "top": lambda x: x[1] > (10 - 1e-9) * size,
            "near": lambda x: abs(x[0] - sides[near]) < 1e-9 * size,
            "far": lambda x: (abs(x[0] - at) < 1e-9 * size) & (x[1] > 2.6 * size),
            "screen": lambda x: (abs(x[0] - at) < 1e-9 * size) & (x[1] < 2.6 * size),
        }
    )


def rained(mesh, rain=0.02, pumped=0.2, k=1.0, level=6.0, **options) -> sc.water.Seepage:
    """Flow under rain to a ditch and to a well, without any warning."""
    return flow(
        mesh,
        {"near": level},
        k,
        ["near", "far"],
        flux={"top": rain},
        wells={"screen": pumped},
        **options,
    )


@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
@pytest.mark.parametrize("rain", [1e-12, 1e-6, 1e-2, 1.0, 1e3])
def test_rain_of_any_rate(rain, kind):
    """[X] Rain of 1e-12 to 1e3 times the permeability: what the ground takes reaches the ditch and
    the well.
    """
    water = rained(wet_strip(kind), rain)
    through = {name: water.discharge(name) for name in ("near", "far", "top", "screen")}
    assert abs(sum(through.values())) <= 1e-8 * sum(map(abs, through.values()))
    assert through["screen"] == pytest.approx(-0.2, rel=1e-8)
    taken = min(rain, 0.1) * 40.0  # less than 0.1 enters in full
    assert taken * (1 - 1e-7) - 1e-9 < through["top"] <= rain * 40.0 * (1 + 1e-7) + 1e-9


@pytest.mark.parametrize("contrast", [1e-10, 1e10])
def test_contrast_of_ten_decades(contrast):
    """[X] Layers in series and side by side, 1e10 times as permeable as each other: harmonic and
    arithmetic means.
    """
    mesh = dam(n=10).with_subdomains({"a": lambda x: x[1] > 5, "b": lambda x: x[1] < 5})
    k = {"a": contrast, "b": 1.0}
    down = flow(mesh, {"top": 12.0, "bottom": 10.0}, k, face=())
    assert down.discharge("top") == pytest.approx(10 * 2.0 / (5 + 5 / contrast), rel=1e-6)
    along = flow(mesh, {"left": 14.0, "right": 12.0}, k, face=())
    # round-off of the tight layer is 1e-16 of the flow through the other one
    assert along.discharge("left") == pytest.approx(1.0 + contrast, rel=1e-9)
    assert along.discharge("right") == pytest.approx(-along.discharge("left"), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("pumped", [1.1, 5.0])
def test_wells_that_fall_dry(pumped):
    """More than the ground yields: the level in the well lies below its screen, with or without a
    balance.
    """
    told = pytest.warns(sc.AnalysisWarning, match=r"well 'screen' falls dry: its level, -?\d")
    with told, suppress(sc.NotConverged):
        sc.water.Flow(Basis(wet_strip(), ElementQuad1()), 1.0, unit_weight=9.81).steady(
            sc.water.Conditions(
                head={"near": 6.0}, wells={"screen": pumped}, seepage_face=["near", "far"]
            )
        )


@pytest.mark.parametrize(("length", "time"), [(1e3, 1e-9)])
def test_units_of_rain_and_wells(length, time):
    """[X] Rain, a well and their answer in other units of length and time."""
    base, other = (
        rained(wet_strip()),
        rained(
            wet_strip(size=length),
            0.02 * length / time,
            0.2 * length**2 / time,
            length / time,
            6.0 * length,
        ),
    )
    np.testing.assert_allclose(other.head / length, base.head, atol=1e-6)
    assert other.discharge("near") * time / length**2 == pytest.approx(
        base.discharge("near"), rel=1e-7
    )


def test_mirrored_rain_and_wells():
    """[X] The same to the left and to the right."""
    base, other = rained(wet_strip()), rained(wet_strip(mirrored=True))
    mesh, turned = base.basis.mesh, other.basis.mesh
    order, again = (
        np.lexsort((y, x.round(9))) for x, y in (mesh.p, (40 - turned.p[0], turned.p[1]))
    )
    np.testing.assert_allclose(other.head[again], base.head[order], atol=1e-7)
    assert other.discharge("near") == pytest.approx(base.discharge("near"), rel=1e-8)


def test_restart_in_the_middle():
    """A run in time that begins anew from its own middle ends as one that goes on, within the error
    of its steps.
    """
    sand = sc.water.VanGenuchten(1.5, 2.0, content=(0.05, 0.4))

    def run(times, start):
        return sc.water.Flow(
            Basis(wet_strip(), ElementQuad1()), 1e-5, unit_weight=9.81, retention=sand
        ).in_time(
            sc.water.Conditions(
                head={"near": 4.0},
                flux={"top": 2e-7},
                wells={"screen": 1e-7},
                seepage_face=["near", "far"],
            ),
            times=times,
            start=start,
            error=5e-3,
        )

    whole = run([0.0, 2e5, 4e5], 4.0)
    again = run([2e5, 4e5], whole[1])
    assert again.stored[0] == pytest.approx(whole.stored[1], rel=1e-8)
    assert again.stored[-1] == pytest.approx(whole.stored[-1], rel=1e-4)
    # of 10 m; measured 2e-4
    np.testing.assert_allclose(again[-1].head, whole[-1].head, atol=5e-3)
