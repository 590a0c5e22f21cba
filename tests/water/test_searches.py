"""Searches for a collapse in ground with pore water that has just been dug: kept pressures, and no
drainage.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

CLAY = sc.MohrCoulomb(E=2e4, nu=0.3, c=10.0, phi=25.0, psi=0.0)


class Cut:
    """A slope 1:1 that is dug 4 m deep into 8 m of saturated clay, all weights below water."""

    def __init__(self) -> None:
        mesh = MeshTri.init_tensor(np.linspace(0, 16, 17), np.linspace(0, 8, 9)).with_defaults()
        x, y = mesh.p[:, mesh.t].mean(axis=1)
        away = (y > 4.0) & (y > x - 3.0)
        mesh = mesh.with_subdomains({"dug": np.flatnonzero(away), "stays": np.flatnonzero(~away)})
        sides = away[mesh.f2t[0]], np.where(mesh.f2t[1] >= 0, away[mesh.f2t[1]], True)
        free = np.setdiff1d(
            np.flatnonzero(sides[0] != sides[1]),
            np.concatenate([mesh.boundaries[name] for name in ("left", "right", "bottom")]),
        )
        crest = np.intersect1d(free, mesh.boundaries["top"])
        self.basis = Basis(
            mesh.with_boundaries({"free": free, "crest": crest}),
            ElementVector(ElementTriP2()),
            intorder=2,
        )
        self.ground = self.basis.with_elements("stays")
        self.held = sc.box_supports(self.basis)
        self.solids = {
            name: sc.SolidForm(self.basis.with_elements(name), CLAY, unit_weight=10.0)
            for name in ("stays", "dug")
        }
        self.start = sc.Model(self.solids, self.held).k0_state(K0=0.6)

    def dug(self, duration: float, drained: bool = True, soil=CLAY):
        """The model and the result of digging it."""
        water = sc.PoreWater(self.ground, permeability=1e-5, unit_weight=10.0)
        stays = sc.SolidForm(self.ground, soil, unit_weight=10.0)
        forms = self.solids | {"stays": stays} | ({} if soil.undrained else {"water": water})
        model = sc.Model(forms, [self.held, *([water.dofs("free")] if drained else [])])
        stage = sc.Stage(
            "cut", duration=duration, deactivate="dug", activate=() if soil.undrained else "water"
        )
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore", sc.AnalysisWarning
            )  # it is short beside drains, or sealed
            return model, model.run([stage], start=self.start, progress=False)


@pytest.fixture(scope="module")
def cut() -> Cut:
    return Cut()


@pytest.mark.slow
def test_factor_without_drainage(cut):
    """[N] Sealed ground that is dug at once, against `Undrained`; the pressures that stay belong to
    a safer slope.
    """
    sealed, dug = cut.dug(1e-3, drained=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nothing is kept, so that nothing is told
        warnings.filterwarnings(
            "ignore", ".* too high .*, for displacements do not jump", sc.AnalysisWarning
        )  # 4 %
        quick = sealed.strength_reduction(start=dug, undrained=True, progress=False)
    other, found = cut.dug(1e-3, drained=False, soil=sc.Undrained(CLAY, nu_undrained=0.499))
    expected = other.strength_reduction(start=found, progress=False).factor
    # .2 % measured: the tolerance of both searches is .4 %, and nu_u = .499 is not incompressible
    assert quick.factor == pytest.approx(expected, rel=6e-3) and quick.stop.shows_limit
    with pytest.warns(sc.AnalysisWarning, match="undrained=True"):
        kept = sealed.strength_reduction(start=dug, progress=False).factor
    assert kept > 1.08 * quick.factor
    pressures = sealed.forms["water"].pressure(quick.x) - dug[-1].forms["water"].pressure(dug[-1].x)
    assert np.nanmax(np.abs(pressures)) > 5.0  # they followed the collapse
    before, after = dug[-1].states["water"], quick.states["water"]
    # no water has moved between the nodes: to the search's own tolerance, beside what the cut has
    # squeezed
    np.testing.assert_allclose(after.stored, before.stored, atol=1e-6 * np.abs(quick.x).max())


def test_pressures_that_drains_hold_follow_as_well(cut):
    """[N] Without drainage it does not matter where water could leave; nothing left within the time
    of the cut.
    """
    model, dug = cut.dug(1e-3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        found = model.strength_reduction(start=dug, undrained=True, progress=False)
    pressures = model.forms["water"].pressure(found.x) - model.forms["water"].pressure(dug[-1].x)
    held = np.unique(cut.basis.mesh.facets[:, cut.basis.mesh.boundaries["free"]])
    assert found.stop.shows_limit and np.abs(pressures[held]).max() > 1.0


def test_old_cuts_are_not_told(cut):
    """[X] Once it has drained a cut has the factor of one that was dug drained, and nothing is
    told.
    """
    model, dug = cut.dug(1e7)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings(
            "ignore", ".* too high .*, for displacements do not jump", sc.AnalysisWarning
        )  # 4 %
        slow = model.strength_reduction(start=dug, progress=False).factor
    dry = sc.Model(cut.solids, cut.held)
    drained = dry.run([sc.Stage("cut", deactivate="dug")], start=cut.start, progress=False)
    assert slow == pytest.approx(
        dry.strength_reduction(start=drained, progress=False).factor, rel=2e-3
    )


def test_load_and_stability_without_drainage(cut):
    """[N] A load on the crest of the fresh cut, against `Undrained`."""
    model, dug = cut.dug(1e-3, drained=False)
    other, found = cut.dug(1e-3, drained=False, soil=sc.Undrained(CLAY, nu_undrained=0.499))
    load = model.traction("crest", (0.0, -1.0))
    loads = [
        each.limit_load(load, start=start, progress=False, **more).multiplier
        for each, start, more in ((model, dug, {"undrained": True}), (other, found, {}))
    ]
    assert loads[0] == pytest.approx(
        loads[1], rel=0.03
    )  # 1.7 % on a finer mesh: nu_u = .499 and 2 tolerances of .5 %
    assert model.is_stable(start=dug, undrained=True)
    assert not model.is_stable(1.2 * loads[0] * load, start=dug, undrained=True)


def test_bad_input(cut):
    model, dug = cut.dug(1e-3)
    with pytest.raises(ValueError, match="flow='davis_b'"):
        model.strength_reduction(start=dug, undrained=True, flow="davis_b", progress=False)
    dry = sc.Model(cut.solids, cut.held)
    with pytest.raises(ValueError, match="none is active"):
        dry.strength_reduction(start=cut.start, undrained=True, progress=False)
    with pytest.raises(ValueError, match="none is active"):
        dry.is_stable(start=cut.start, undrained=True)


@pytest.mark.slow
def test_bounds_beside_seepage():
    """[B] Bounds of a bank with seepage, its pressures linear in every triangle, and the search on
    a coarse mesh.
    """

    def surface(x):
        return np.interp(x, [2, 14, 18, 30], [1, 7, 7, 1])

    flat = MeshTri.init_tensor(np.linspace(0, 32, 33), np.linspace(0, 1, 6))
    mesh = MeshTri(np.stack((flat.p[0], surface(flat.p[0]) * flat.p[1])), flat.t).with_boundaries(
        {
            "base": lambda x: x[1] < 1e-9,
            "sides": lambda x: (x[0] < 1e-9) | (x[0] > 32 - 1e-9),
            "up": lambda x: (x[0] < 14) & (x[1] > surface(x[0]) - 1e-6),
            "down": lambda x: (x[0] > 18) & (x[1] > surface(x[0]) - 1e-6),
        }
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = sc.water.Flow(basis, 1e-6, unit_weight=9.81).steady(
        sc.water.Conditions(head={"up": 6.0}, seepage_face="down")
    )
    bank = sc.SolidForm(
        basis, sc.MohrCoulomb(E=3e4, nu=0.3, c=5.0, phi=30.0, psi=30.0), unit_weight=20.0
    )
    model = sc.Model(
        {"bank": bank}, [basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1")]
    )
    found = model.bounds(
        water=water.pressure, submerged="up", elements=2000, gap=0.05, progress=False
    )
    factor = model.strength_reduction(
        model.water_load(water.pressure, "up"), certify=False, progress=False
    ).factor
    assert found.lower < factor < 1.02 * found.upper  # the mesh is .9 % too strong
    assert 1.2 < found.lower < found.upper < 1.05 * found.lower


@pytest.mark.slow
def test_bounds_with_suction_beside_air():
    """[X] Suction on the surface that is named as submerged presses nowhere: the bounds without
    it.
    """
    mesh = MeshTri.init_tensor(np.linspace(0, 4, 9), np.linspace(0, 2, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    bank = sc.SolidForm(
        basis, sc.MohrCoulomb(E=3e4, nu=0.3, c=2.0, phi=25.0, psi=25.0), unit_weight=20.0
    )
    model = sc.Model(
        {"bank": bank}, [basis.get_dofs("bottom").all(), basis.get_dofs("left").all("u^1")]
    )
    options = {"water": lambda x: -5.0 + 0.0 * x[0], "elements": 300, "gap": 0.2, "progress": False}
    air, named = model.bounds(**options), model.bounds(**options, submerged=["top", "right"])
    np.testing.assert_allclose([named.lower, named.upper], [air.lower, air.upper], rtol=1e-6)
