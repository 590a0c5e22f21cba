"""Seepage where it is hard: contrasts, dry and flooded ground, units, mirrors, refinement, sharp retention."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from helpers import distorted
from skfem import Basis, ElementQuad1, ElementTriP1, MeshQuad, MeshTri

import skfem_contact as sc

ELEMENTS = {MeshTri: ElementTriP1, MeshQuad: ElementQuad1}


def dam(kind=MeshTri, n: int = 20, size: float = 10.0, up: float = 0.0):
    """A square dam with a core in its middle fifth and a boundary all around."""
    mesh = kind.init_tensor(np.linspace(0, size, n + 1), up + np.linspace(0, size, n + 1)).with_defaults()
    return mesh.with_subdomains({"core": lambda x: abs(x[0] / size - 0.5) < 0.1,
                                 "shell": lambda x: abs(x[0] / size - 0.5) > 0.1})  # fmt: skip


def flow(mesh, heads, k=1.0, face="right", **options) -> sc.water.Seepage:
    """Seepage without any warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return sc.water.seepage(Basis(mesh, ELEMENTS[type(mesh)]()), k, heads, seepage_face=face,
                                unit_weight=9.81, **options)


@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
@pytest.mark.parametrize("core", [1e-3, 0.1, 1e2, 1e5, 1e8])
def test_core_of_another_permeability(core, kind):
    """[X] Sum of L / k of the zones; a contrast of 1e8 leaves 1e8 times the round-off between in and outflow."""
    water = flow(dam(kind), {"left": 10.0}, {"core": core, "shell": 1.0})
    # elements of .5 m in a core of 2 m through which the free surface falls by 10 m
    assert water.discharge("left") == pytest.approx(50 / (8 + 2 / core), rel=0.01)
    assert water.discharge("right") == pytest.approx(-water.discharge("left"), rel=1e-8 if core < 1e6 else 1e-5)


@pytest.mark.parametrize("core", [1e-8, 1e-6, 1e-5])
def test_tight_core(core):
    """[X] Drained ground behind a tight core is as good as dry: with it the user is warned, without it all is well."""
    mesh, k = dam(), {"core": core, "shell": 1.0}
    with pytest.warns(sc.AnalysisWarning, match=r"flows off through dry ground at .*; leave drained ground out"):
        sc.water.seepage(Basis(mesh, ElementTriP1()), k, {"left": 10.0}, seepage_face="right", unit_weight=9.81)
    mesh = mesh.with_subdomains({"wet": lambda x: x[0] < 6})
    mesh = mesh.with_boundaries({"drained": mesh.facets_satisfying(lambda x: np.isclose(x[0], 6))})
    wet = Basis(mesh, ElementTriP1()).with_elements("wet")
    water = sc.water.seepage(wet, k, {"left": 10.0}, seepage_face="drained", unit_weight=9.81)
    assert water.discharge("left") == pytest.approx(50 / (4 + 2 / core), rel=5e-3)
    assert water.discharge("drained") == pytest.approx(-water.discharge("left"), rel=1e-8)


def test_layers_of_another_permeability():
    """Flow in a layer 1e8 times as permeable, on top or below: it carries all, and nothing is lost."""
    for wet in (lambda x: x[1] > 5, lambda x: x[1] < 5):
        mesh = dam().with_subdomains({"sand": wet, "clay": lambda x, wet=wet: ~wet(x)})
        water = flow(mesh, {"left": 10.0}, {"sand": 1e8, "clay": 1.0})
        assert water.discharge("right") == pytest.approx(-water.discharge("left"), rel=1e-8)
        # Charny's integral over the lower layer, full of water, and over the upper one
        assert water.discharge("left") == pytest.approx(1e8 * (3.75 if wet([0, 0]) else 1.25), rel=0.01)


def test_dry_dam():
    """Water at the base alone, or none: nothing flows, and pressures are not negative."""
    for names, face in ((["left", "right"], ()), (["left"], "right"), (["bottom"], ["left", "right"])):
        water = flow(dam(), dict.fromkeys(names, 0.0), face=face)
        assert np.abs(water.inflow).max() < 1e-12
        assert (water.pressure >= 0).all() and water.pressure.max() < 1e-9


def test_flooded_dam():
    """[X] Water above the dam on both sides: confined flow, one linear solution, whatever the face is called."""
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
    """Water that stands above the crest leaves through all of the face, and through the crest where that is one."""
    closed = flow(dam(), {"left": 11.0})
    assert closed.pressure[np.isclose(dam().p[0], 10)].max() < 1e-9
    over = flow(dam(), {"left": 11.0}, face=["right", "top"])
    assert over.discharge("top") < 0 and over.discharge("left") > closed.discharge("left")


def test_drained_everywhere():
    """All boundaries are seepage faces but the one with water: it leaves below, and only where it reaches."""
    water = flow(dam(), {"left": 6.0}, face=["right", "bottom", "top"])
    assert water.discharge("bottom") < 0 == pytest.approx(water.discharge("top"))
    assert water.inflow.sum() == pytest.approx(0.0, abs=1e-8 * water.discharge("left"))


@pytest.mark.parametrize(("length", "time", "height"), [(1e3, 1e-12, 0.0), (1e-3, 1e9, 0.0), (1.0, 1.0, 1e4)])
def test_units_and_datum(length, time, height):
    """[X] Other units of length and time and another zero of the heights scale the answer and nothing else."""
    k = {"core": 0.1, "shell": 1.0}
    base = flow(dam(n=10), {"left": 10.0, "right": 2.0}, k)
    other = flow(dam(n=10, size=10 * length, up=height), {"left": 10 * length + height, "right": 2 * length + height},
                 {name: value * length / time for name, value in k.items()})
    # the heights above a zero that is 1e4 away are known to 1e-12 of the dam's height
    np.testing.assert_allclose((other.head - height) / length, base.head, atol=1e-7)
    assert other.discharge("left") * time / length**2 == pytest.approx(base.discharge("left"), rel=1e-7)


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
    moved = kind(np.where(inner, distorted(mesh, rng, 0.1).p, mesh.p), mesh.t).with_boundaries(mesh.boundaries)
    assert flow(moved, {"left": 10.0, "right": 2.0}).discharge("left") == pytest.approx(4.8, rel=0.01)
    x = 5 * (1 + np.sign(t := np.linspace(-1, 1, 31)) * np.abs(t) ** 2.5)
    graded = kind.init_tensor(x, np.linspace(0, 10, 31)).with_defaults()
    assert flow(graded, {"left": 10.0, "right": 2.0}).discharge("left") == pytest.approx(4.8, rel=0.01)


@pytest.mark.parametrize("law", [sc.water.Ramp(0.1), sc.water.Ramp(4.0), sc.water.Ramp(least=1e-7),
                                 sc.water.Ramp(least=0.1), sc.water.VanGenuchten(0.5, 1.5),
                                 sc.water.VanGenuchten(10.0, 4.0)], ids=repr)  # fmt: skip
@pytest.mark.parametrize("kind", [MeshTri, MeshQuad])
def test_retention(law, kind):
    """Sharp and blunt transitions between wet and dry: what water the blunt ones let pass above is within 7 %."""
    water = flow(dam(kind), {"left": 10.0, "right": 2.0}, retention=law)
    assert water.discharge("left") == pytest.approx(4.8, rel=0.07)


def test_what_does_not_balance_is_warned_of(monkeypatch):
    """A transition that is wider than asked for is warned of; where none is found there is no answer."""
    from skfem_contact.water import balance

    limit = 1.2
    newton = balance.WaterBalance._newton

    def stubborn(self, now, laws, tolerance):
        if laws and laws[0][1].width < 0.5 * limit:
            raise balance.Unbalanced("it does not want to")
        return newton(self, now, laws, tolerance)

    monkeypatch.setattr(balance.WaterBalance, "_newton", stubborn)
    basis = Basis(dam(), ElementTriP1())
    with pytest.warns(sc.AnalysisWarning, match=r"wet and dry ground is 1\.2\d? times as wide as asked for"):
        water = sc.water.seepage(basis, 1.0, {"left": 10.0, "right": 2.0}, seepage_face="right", unit_weight=9.81)
    assert water.discharge("left") == pytest.approx(4.8, rel=2e-3)
    limit = np.inf
    with pytest.raises(sc.NotConverged, match="the water does not balance: it does not want to"):
        sc.water.seepage(basis, 1.0, {"left": 10.0, "right": 2.0}, seepage_face="right", unit_weight=9.81)
