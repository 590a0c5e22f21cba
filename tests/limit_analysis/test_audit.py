"""Bounds of random slopes and footings, audited by scikit-fem's own elements."""

from __future__ import annotations

import warnings
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import Delaunay
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from skfem_contact.limit_analysis import Bounds
from tests.tools.helpers import bounds_of
from tests.tools.limit_analysis_audit import Ground, violations

#: Violations by round-off: of equilibrium, of the flow rule, and of the yield condition as a share
#: of the cohesion.
ROUND_OFF = 1e-12


def named(mesh: MeshTri) -> MeshTri:
    """Boundaries and two layers of a slope."""
    x, y = mesh.p
    low, left, right, high = y.min(), x.min(), x.max(), y.max()
    return mesh.with_boundaries(
        {
            "base": lambda p: p[1] < low + 1e-9,
            "sides": lambda p: (p[0] < left + 1e-9) | (p[0] > right - 1e-9),
            "crest": lambda p: p[1] > high - 1e-9,
        }
    ).with_subdomains({"upper": lambda p: p[1] > 0, "lower": lambda p: p[1] <= 0})


def outline_mesh(corners: list[tuple[float, float]], size: float) -> MeshTri:
    """Delaunay triangles of about a size within an outline that runs counterclockwise."""
    ring = np.array(corners)
    sides = list(zip(ring, np.roll(ring, -1, axis=0)))
    steps = [max(1, round(np.linalg.norm(b - a) / size)) for a, b in sides]
    edge = np.concatenate(
        [a + (b - a) * np.arange(n)[:, None] / n for (a, b), n in zip(sides, steps)]
    )
    low, high = ring.min(axis=0), ring.max(axis=0)
    grid = np.stack(
        np.meshgrid(*(np.arange(l + 0.37 * size, h, size) for l, h in zip(low, high))), -1
    ).reshape(-1, 2)
    grid[:, 0] += (
        0.5 * size * (np.round((grid[:, 1] - low[1]) / size) % 2)
    )  # rows in turn: no crossing lines
    far = np.linalg.norm(grid[:, None] - edge, axis=2).min(axis=1) > 0.6 * size
    points = np.concatenate([edge, grid[far & inside(grid, sides)]])
    t = Delaunay(points).simplices
    return MeshTri(points.T, np.ascontiguousarray(t[inside(points[t].mean(axis=1), sides)].T))


def inside(x: np.ndarray, sides: list) -> np.ndarray:
    """Whether points (n, 2) lie within an outline, by the crossings of a ray."""
    odd = np.zeros(len(x), bool)
    for a, b in sides:
        spans = (a[1] > x[:, 1]) != (b[1] > x[:, 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            odd ^= spans & (x[:, 0] < (b[0] - a[0]) * (x[:, 1] - a[1]) / (b[1] - a[1]) + a[0])
    return odd


def slope_outline(
    run: float, crest: float, depth: float, beyond: float
) -> list[tuple[float, float]]:
    """A slope 10 high that falls to the right; its toe is the origin."""
    left = -run - crest
    if depth == 0:
        return [(left, 0.0), (0.0, 0.0), (-run, 10.0), (left, 10.0)]
    return [
        (left, -depth),
        (0.0, -depth),
        (beyond, -depth),
        (beyond, 0.0),
        (0.0, 0.0),
        (-run, 10.0),
        (left, 10.0),
        (left, 0.0),
    ]


def soil(random: np.random.Generator) -> sc.MohrCoulomb:
    """With friction or without, now and then with a tension cut-off."""
    c, phi = random.uniform(5, 40), random.choice([0.0, random.uniform(5, 35)])
    tension = random.choice([None, random.uniform(0, 0.5) * c])
    return sc.MohrCoulomb(E=1e5, nu=0.3, c=c, phi=phi, psi=phi, tension=tension)


def random_slope(seed: int) -> tuple[dict, Ground]:
    """Arguments of bounds, and what an audit needs: layers, surcharge, acceleration."""
    random = np.random.default_rng(seed)
    depth = random.choice([0.0, random.uniform(2, 8)])
    outline = slope_outline(
        random.uniform(2, 25), random.uniform(5, 12), depth, random.uniform(3, 8)
    )
    mesh = named(outline_mesh(outline, 4.0))
    soils = {name: soil(random) for name in ("upper", "lower") if len(mesh.subdomains[name])}
    weights = {name: random.uniform(15, 22) for name in soils}
    seismic, surcharge = (
        random.choice([0.0, random.uniform(0.05, 0.2)]),
        random.choice([0.0, random.uniform(1, 30)]),
    )
    tractions = {"crest": (0.0, -surcharge)} if surcharge else {}
    basis = Basis(mesh, ElementVector(random.choice([ElementTriP1(), ElementTriP2()])), intorder=2)
    fixed = np.hstack([basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1")])
    given = {
        "forms": {"soil": sc.SolidForm(basis, soils)},
        "fixed": fixed,
        "weight": weights,
        "seismic": seismic,
        "tractions": tractions,
        "gap": 0.1,
        "elements": 150,
    }
    body = {name: (seismic * weight, -weight) for name, weight in weights.items()}
    return given, Ground(soils, body, {"base": (0, 1), "sides": (0,)}, tractions)


def random_footing(seed: int) -> tuple[dict, Ground]:
    """A flexible strip on weightless or heavy ground beside a surcharge; its pressure is
    multiplied.
    """
    random = np.random.default_rng(seed)
    mesh = (
        MeshTri.init_tensor(np.linspace(0, 4, 9), np.linspace(-2, 0, 5))
        .with_boundaries(
            {
                "base": lambda p: p[1] < -2 + 1e-9,
                "sides": lambda p: (p[0] < 1e-9) | (p[0] > 4 - 1e-9),
                "foot": lambda p: (p[1] > -1e-9) & (p[0] < 1),
                "beside": lambda p: (p[1] > -1e-9) & (p[0] > 1),
            }
        )
        .with_subdomains({"ground": lambda p: p[1] < 1})
    )
    soils = {"ground": soil(random)}
    gamma, beside = (
        random.choice([0.0, random.uniform(10, 20)]),
        random.choice([0.0, random.uniform(1, 20)]),
    )
    tractions = {"foot": (0.0, -1.0)} | ({"beside": (0.0, -beside)} if beside else {})
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    fixed = np.hstack([basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1")])
    given = {
        "forms": {"soil": sc.SolidForm(basis, soils)},
        "fixed": fixed,
        "weight": gamma,
        "tractions": tractions,
        "live": "foot",
        "gap": 0.1,
        "elements": 250 if seed < 8 else 150,
    }
    return given, Ground(
        soils, {"ground": (0.0, -gamma)}, {"base": (0, 1), "sides": (0,)}, tractions
    )


def bounds(given: dict) -> Bounds:
    """Bounds on coarse meshes, whose gap does not matter."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "the bounds .* differ", sc.AnalysisWarning)
        return bounds_of(**given, progress=False)


@pytest.mark.parametrize("seed", range(50))
@pytest.mark.one_in(5)
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
@pytest.mark.one_in(4)
def test_footing(seed: int) -> None:
    """[X] The same with a multiplied load: the dissipation does not exceed the power at the upper
    bound.
    """
    given, ground = random_footing(seed)
    found = bounds(given)
    assert found.lower <= found.upper < 2 * found.lower
    for multiplier, names in (
        (found.lower, ("inside", "across", "boundary", "yielding")),
        (found.upper, ("supports", "flow")),
    ):
        loaded = ground._replace(tractions={**ground.tractions, "foot": (0.0, -multiplier)})
        wrong = violations(found, loaded, multiplier=True)
        assert max(getattr(wrong, name) for name in names) < ROUND_OFF
    assert wrong.dissipation < 1 + 1e-12
    check_history(found)


def check_history(found: Bounds) -> None:
    """No lower bound of any mesh exceeds an upper one, and none gets worse on a finer mesh."""
    lower, upper = ([c for c in found.history if c.kind == kind] for kind in ("lower", "upper"))
    assert max(c.value for c in lower) <= min(c.value for c in upper)
    for before, after in pairwise(lower):
        assert after.value > before.value * (1 - 1e-3)  # the solver's accuracy on coarse meshes
    for before, after in pairwise(upper):
        assert after.value < before.value * (1 + 1e-3)


def test_the_audit_sees_what_is_wrong() -> None:
    """[X] Stresses and velocities that are off by 1e-6 violate all that is looked at."""
    given, ground = random_slope(5)
    found = bounds(given)
    random = np.random.default_rng(1)
    noisy = replace(
        found,
        stress=found.stress * (1 + 1e-6 * random.standard_normal(found.stress.shape)),
        mechanism=found.mechanism + 1e-6 * random.standard_normal(found.mechanism.shape),
    )
    wrong = violations(noisy, ground)
    assert min(wrong.inside, wrong.across, wrong.boundary, wrong.supports, wrong.flow) > 1e-9
    assert violations(replace(found, lower=1.001 * found.lower), ground).yielding > 1e-5
    assert violations(replace(found, upper=0.999 * found.upper), ground).flow > 1e-5
