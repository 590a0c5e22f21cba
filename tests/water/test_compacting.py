"""Consolidation of ground whose permeability changes with its void ratio: an independent script,
limits, tangent.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from skfem import Basis, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
from tests.tools.helpers import check_tangent_of_water, two_soils, vector_basis

E, K, LOAD, WATER = 1e3, 1e-4, 100.0, 10.0
QUIET = {"progress": False}
pytestmark = pytest.mark.filterwarnings("ignore:.*less than h² / 3 c_v")


def column(element: str = "P2", n: int = 20, width: float = 0.1) -> Basis:
    kind = MeshTri if element[0] == "P" else MeshQuad
    mesh = kind.init_tensor(
        np.array([0.0, width]), 1 - np.linspace(1, 0, n + 1) ** 1.8
    ).with_defaults()
    return vector_basis(mesh, element, intorder=2)


def compacting(
    basis: Basis,
    change: float | dict[str, float] = 0.5,
    permeability: float = K,
    void_ratio: float | dict[str, float] = 1.0,
    **options,
) -> sc.PoreWater:
    by_strain = sc.water.Permeability(permeability, void_ratio, change)
    return sc.PoreWater(basis, by_strain, **{"unit_weight": WATER, **options})


def clay(basis: Basis, water: sc.PoreWater, *drained: str) -> tuple[sc.Model, np.ndarray]:
    """Model of a layer that drains at its top and at other boundaries, and its load."""
    strain = "b_bar" if basis.elem.elem.doflocs.shape[0] == 4 else "full"
    solid = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.0), strain=strain)
    fixed = [sc.box_supports(basis, base="rollers"), water.dofs("top", *drained)]
    return sc.Model({"clay": solid, "water": water}, fixed), sc.traction(solid, "top", (0.0, -LOAD))


def pressures(times: np.ndarray, change: float, n: int = 200) -> tuple[np.ndarray, np.ndarray]:
    """Heights and excess pressures by time of n cells of a layer of height 1, by the method of
    lines.
    """
    d, rate = 1.0 / n, np.log(10.0) * 2.0 / change

    def by_time(t: float, p: np.ndarray) -> np.ndarray:
        k = K / WATER * np.exp(rate * (p - LOAD) / E)
        drop = np.append(np.diff(p), -p[-1])
        between = np.append(
            0.5 * (k[1:] + k[:-1]), K / WATER * np.exp(rate * -LOAD / E) * 0.5 + 0.5 * k[-1]
        )
        flow = between * drop / np.append(np.full(n - 1, d), 0.5 * d)
        return E * np.diff(flow, prepend=0.0) / d

    found = solve_ivp(
        by_time,
        (0.0, times[-1]),
        np.full(n, LOAD),
        method="BDF",
        t_eval=times,
        rtol=1e-6,
        atol=1e-6,
    )
    return (np.arange(n) + 0.5) * d, found.y.T


@pytest.mark.parametrize("element", ["P2", "Q1"])
def test_layer_that_becomes_less_permeable(element: str) -> None:
    """[N] Settlement and pressures of a script of finite volumes, while k falls to .4 of what it
    was.
    """
    basis, times = column(element), np.array([5.0, 20.0, 60.0])
    model, load = clay(basis, compacting(basis))
    lengths = np.diff(times, prepend=0.0)
    stages = [
        sc.Stage("load", load, duration=1e-3),
        *(sc.Stage(f"{t:g}", load, duration=d) for t, d in zip(times, lengths, strict=True)),
    ]
    z, expected = pressures(times, 0.5)
    for stage, p in zip(list(model.run(stages, **QUIET))[1:], expected, strict=True):
        settlement = -stage.x[basis.get_dofs("top").all("u^2")].mean()
        assert settlement == pytest.approx(
            (LOAD - p.mean()) / E, rel=4e-3
        )  # steps in time: .1 % of the final one
        left = np.flatnonzero(basis.mesh.p[0] == 0.0)
        left = left[np.argsort(basis.mesh.p[1, left])]
        found = np.interp(z, basis.mesh.p[1, left], stage.forms["water"].pressure(stage.x)[left])
        assert (
            np.abs(found - p).max() < 0.02 * LOAD
        )  # beside the drain at first, where the pressure is steep
        last = stage.states["water"]
        assert stage.forms["water"].inflow(last, "top") == pytest.approx(
            stage.forms["water"].volume(last), rel=1e-8
        )


def test_permeability_that_hardly_changes_is_that_of_pore_water() -> None:
    """[N] With a change of the void ratio that never comes: the same steps and displacements."""
    basis, found = column(n=6), []
    for water in (sc.PoreWater(basis, K, unit_weight=WATER), compacting(basis, change=1e12)):
        model, load = clay(basis, water)
        found.append(
            model.run(
                [sc.Stage("load", load, duration=1.0), sc.Stage("wait", load, duration=20.0)],
                **QUIET,
            )
        )
    linear, same = found
    assert [len(stage.iterations) for stage in linear] == [len(stage.iterations) for stage in same]
    np.testing.assert_allclose(same[-1].x, linear[-1].x, atol=1e-9 * LOAD)


def test_flow_through_compacted_ground() -> None:
    """[X] Layers of .4 and .63 of the permeability conduct in series, after all excess of the load
    has gone.
    """
    mesh = (
        MeshTri.init_tensor(np.array([0.0, 0.1]), np.linspace(0, 1, 11))
        .with_defaults()
        .with_subdomains({"low": lambda x: x[1] < 0.5, "high": lambda x: x[1] > 0.5})
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    model, load = clay(basis, compacting(basis, {"low": 0.5, "high": 1.0}), "bottom")
    small = model.forms["water"].prescribed({"bottom": 1e-3})
    result = model.run(
        [
            sc.Stage("load", load, duration=1.0),
            sc.Stage("wait", load, duration=1e3),
            sc.Stage("drop", load, small, duration=1e3),
            sc.Stage("flow", load, small, duration=1e3),
        ],
        **QUIET,
    )
    entered = [stage.forms["water"].inflow(stage.states["water"], "bottom") for stage in result]
    factors = 10 ** (2.0 * -0.1 / np.array([0.5, 1.0]))
    expected = 0.1 * 1e3 * K / WATER * 1e-3 / (0.5 / factors).sum()
    assert entered[3] - entered[2] == pytest.approx(
        expected, rel=1e-3
    )  # the excess strains the ground by 1e-6


@pytest.mark.parametrize(
    ("element", "coordinates"), [("P2", "plane"), ("P1", "axisymmetric"), ("Q1", "plane")]
)
def test_tangent(element: str, coordinates: str) -> None:
    """[N] Central differences of forces and water, with layers, storage and stabilisation."""
    water = compacting(
        two_soils(element), {"a": 0.3, "b": 0.6}, void_ratio={"a": 0.8, "b": 1.6}, storage=1e-5
    )
    check_tangent_of_water(water, E, coordinates)


def test_saved_resumed_and_counted_anew(tmp_path) -> None:
    """[N] An analysis that is read from a file, or counts displacements anew, in the middle ends as
    in one go.
    """
    basis = column(n=5)
    model, load = clay(basis, compacting(basis))
    stages = [sc.Stage("load", load, duration=10.0), sc.Stage("wait", load, duration=30.0)]
    whole, first = model.run(stages, **QUIET), model.run(stages[:1], **QUIET)
    first.save(tmp_path / "first")
    later = model.run(stages[1:], start=sc.load_result(tmp_path / "first", model), **QUIET)
    np.testing.assert_allclose(later[-1].x, whole[-1].x, rtol=1e-9, atol=1e-12)
    top, anew = (
        basis.get_dofs("top").all("u^2"),
        model.run(stages[1:], start=first.reset(), **QUIET)[-1],
    )
    np.testing.assert_allclose(anew.x[top] + first[-1].x[top], whole[-1].x[top], rtol=1e-6)
    np.testing.assert_allclose(
        anew.states["water"].strain, whole[-1].states["water"].strain, rtol=1e-6
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"void_ratio": 0.0}, "void_ratio must be a finite number above 0"),
        ({"change": -0.5}, "change must be a finite number above 0"),
        ({"change": {"a": 0.5}}, "no subdomain 'a'"),
    ],
)
def test_bad_input(changes: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        compacting(column(n=2), **changes)


def test_water_of_another_kind() -> None:
    """Water whose void ratio changes with a stage, and ordinary water instead."""
    basis = column(n=2)
    model, load = clay(basis, compacting(basis))
    for other, reason in (
        (compacting(basis, 0.6), "its void ratio or the change is another"),
        (sc.PoreWater(basis, K, unit_weight=WATER), "its void ratio or the change is another"),
    ):
        stages = [
            sc.Stage("wait", load, duration=1.0),
            sc.Stage("other", load, duration=1.0, change={"water": other}),
        ]
        with pytest.raises(ValueError, match=reason):
            model.run(stages, **QUIET)


def test_voids_count_from_the_start() -> None:
    """[X] Displacements before the water is there do not change its permeability."""
    basis = column(n=2)
    model, _ = clay(basis, compacting(basis))
    water = model.forms["water"]
    x = np.random.default_rng(1).standard_normal(water.first + basis.mesh.nvertices)
    state = water.initial_state(x)
    assert not state.strain.any() and state.before.any()
