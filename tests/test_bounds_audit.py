"""Bounds of random slopes and footings, audited by scikit-fem's own elements."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from limit_analysis_audit import Ground, violations
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, MeshTri
from slope_meshes import slope_mesh

import skfem_contact as sc

#: Violations by round-off: of equilibrium, of the flow rule, and of the yield condition as a share of the cohesion.
ROUND_OFF = 1e-12


def named(mesh: MeshTri) -> MeshTri:
    """Boundaries and two layers of a slope."""
    x, y = mesh.p
    low, left, right, high = y.min(), x.min(), x.max(), y.max()
    return mesh.with_boundaries(
        {"base": lambda p: p[1] < low + 1e-9, "sides": lambda p: (p[0] < left + 1e-9) | (p[0] > right - 1e-9),
         "crest": lambda p: p[1] > high - 1e-9}
    ).with_subdomains({"upper": lambda p: p[1] > 0, "lower": lambda p: p[1] < 0})  # fmt: skip


def soil(random: np.random.Generator) -> sc.MohrCoulomb:
    """With friction or without, now and then with a tension cut-off."""
    c, phi = random.uniform(5, 40), random.choice([0.0, random.uniform(5, 35)])
    tension = random.choice([None, random.uniform(0, 0.5) * c])
    return sc.MohrCoulomb(E=1e5, nu=0.3, c=c, phi=phi, psi=phi, tension=tension)


def random_slope(seed: int) -> tuple[dict, Ground]:
    """Arguments of bounds, and what an audit needs: layers, surcharge, acceleration."""
    random = np.random.default_rng(seed)
    depth = random.choice([0.0, random.uniform(2, 8)])
    mesh = named(slope_mesh(random.uniform(2, 25), random.uniform(5, 12), depth, random.uniform(3, 8), 2))
    soils = {name: soil(random) for name in ("upper", "lower") if len(mesh.subdomains[name])}
    weights = {name: random.uniform(15, 22) for name in soils}
    seismic, surcharge = random.choice([0.0, random.uniform(0.05, 0.2)]), random.choice([0.0, random.uniform(1, 30)])
    tractions = {"crest": (0.0, -surcharge)} if surcharge else {}
    basis = Basis(mesh, ElementVector(random.choice([ElementTriP1(), ElementTriP2()])), intorder=2)
    fixed = np.hstack([basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1")])
    given = {"forms": {"soil": sc.SolidForm(basis, soils)}, "fixed": fixed, "weight": weights, "seismic": seismic,
             "tractions": tractions, "gap": 0.05, "elements": 300}  # fmt: skip
    body = {name: (seismic * weight, -weight) for name, weight in weights.items()}
    return given, Ground(soils, body, {"base": (0, 1), "sides": (0,)}, tractions)


def random_footing(seed: int) -> tuple[dict, Ground]:
    """A flexible strip on weightless or heavy ground beside a surcharge; its pressure is multiplied."""
    random = np.random.default_rng(seed)
    mesh = MeshTri.init_tensor(np.linspace(0, 4, 9), np.linspace(-2, 0, 5)).with_boundaries(
        {"base": lambda p: p[1] < -2 + 1e-9, "sides": lambda p: (p[0] < 1e-9) | (p[0] > 4 - 1e-9),
         "foot": lambda p: (p[1] > -1e-9) & (p[0] < 1), "beside": lambda p: (p[1] > -1e-9) & (p[0] > 1)}
    ).with_subdomains({"ground": lambda p: p[1] < 1})  # fmt: skip
    soils = {"ground": soil(random)}
    gamma, beside = random.choice([0.0, random.uniform(10, 20)]), random.choice([0.0, random.uniform(1, 20)])
    tractions = {"foot": (0.0, -1.0)} | ({"beside": (0.0, -beside)} if beside else {})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    fixed = np.hstack([basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1")])
    given = {"forms": {"soil": sc.SolidForm(basis, soils)}, "fixed": fixed, "weight": gamma, "tractions": tractions,
             "live": "foot", "gap": 0.05, "elements": 400}  # fmt: skip
    return given, Ground(soils, {"ground": (0.0, -gamma)}, {"base": (0, 1), "sides": (0,)}, tractions)


def bounds(given: dict) -> sc.Bounds:
    """Bounds on coarse meshes, whose gap does not matter."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the bounds .* differ", sc.AnalysisWarning)
        return sc.bounds(**given, progress=False)


@pytest.mark.parametrize("seed", range(50))
def test_slope(seed: int) -> None:
    """[X] Equilibrium, yield, flow rule and power, and lower bounds below all upper ones."""
    given, ground = random_slope(seed)
    found = bounds(given)
    assert found.lower < found.upper < 3 * found.lower
    wrong = violations(found, ground)
    assert max(wrong.inside, wrong.across, wrong.boundary) < ROUND_OFF
    assert max(wrong.yielding, wrong.flow, wrong.supports) < ROUND_OFF
    assert wrong.dissipation < 1 + 1e-12
    check_history(found)


@pytest.mark.parametrize("seed", range(20))
def test_footing(seed: int) -> None:
    """[X] The same with a multiplied load: the dissipation does not exceed the power at the upper bound."""
    given, ground = random_footing(seed)
    found = bounds(given)
    assert found.lower <= found.upper < 2 * found.lower
    for multiplier, names in ((found.lower, ("inside", "across", "boundary", "yielding")),
                              (found.upper, ("supports", "flow"))):  # fmt: skip
        loaded = ground._replace(tractions={**ground.tractions, "foot": (0.0, -multiplier)})
        wrong = violations(found, loaded, multiplier=True)
        assert max(getattr(wrong, name) for name in names) < ROUND_OFF
    assert wrong.dissipation < 1 + 1e-12
    check_history(found)


def check_history(found: sc.Bounds) -> None:
    """No lower bound of any mesh exceeds an upper one, and none gets worse on a finer mesh."""
    lower, upper = ([c for c in found.history if c.kind == kind] for kind in ("lower", "upper"))
    assert max(c.value for c in lower) <= min(c.value for c in upper)
    for before, after in zip(lower, lower[1:]):
        assert after.value > before.value * (1 - 1e-3)  # the solver's accuracy on coarse meshes
    for before, after in zip(upper, upper[1:]):
        assert after.value < before.value * (1 + 1e-3)
