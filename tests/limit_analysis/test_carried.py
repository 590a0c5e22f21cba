"""Iterates of a mesh from which the interior points of a refinement begin."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from bound_cases import CASES

import skfem_contact as sc
from skfem_contact.limit_analysis import Bounds, interior_point, search
from tests.tools.helpers import bounds_of

FOOTING = "footing with c, q and weight"  # with a joint


def bracket(name: str, gap: float) -> Bounds:
    """Bounds of a case."""
    return bounds_of(**CASES[name][0], gap=gap, progress=False)


@pytest.fixture
def carries(monkeypatch) -> list[tuple]:
    """Iterates that were carried, their programs, and the results."""
    carried = search.carried
    seen = []

    def noted(iterate, coarse, fine, parent):
        result = carried(iterate, coarse, fine, parent)
        seen.append((iterate, coarse[1], fine[1], result))
        return result

    monkeypatch.setattr(search, "carried", noted)
    return seen


@pytest.mark.parametrize("name", ["Griffiths and Lane 1", FOOTING])
def test_carried_points_are_inside_of_their_cones(carries, name: str) -> None:
    """[X] All points are inside; the sum of multipliers times weight in the soil stays."""
    bracket(name, 0.15)
    assert carries
    for before, coarse, fine, after in carries:
        inside = [interior_point._depth(each) > 0 for each in (after.s, after.z)]
        assert np.all(inside)
        whole = before.z[: 3 * len(coarse.soft)].sum(0)
        parts = after.z[: 3 * len(fine.soft)].sum(0)
        assert parts == pytest.approx(whole, rel=1e-9, abs=1e-9 * np.abs(whole).max())


def test_carried_stresses_are_in_equilibrium(carries) -> None:
    """[X] Linear stresses of a lower bound balance the loads on the parts of its triangles too;
    those of an upper bound balance them for coarse velocities alone.
    """
    bracket("N_c, 20 degrees", 0.07)
    missing = []
    for before, _, fine, after in carries:
        load = before.theta * fine.live
        violation = np.abs(fine.forces(after.stress) - load).max()
        missing.append(violation / np.abs(load).max())
    lower = np.array(missing[1::2])  # after each upper bound a lower one
    assert len(lower) >= 2
    assert (lower < 1e-8).all()


@pytest.mark.slow
def test_meshes_that_begin_near_take_fewer_iterations(monkeypatch) -> None:
    """[X] The same bracket from the beginning of every mesh, with more iterations."""
    # the last mesh is as fine as the gap asks: both are refined alike here
    monkeypatch.setattr(search, "_SHARES", (0.5, 0.5))
    near = bracket("N_c, 20 degrees", 0.08)
    monkeypatch.setattr(search, "carried", lambda *args: None)
    far = bracket("N_c, 20 degrees", 0.08)
    assert near.lower == pytest.approx(far.lower, rel=2e-3)
    assert near.upper == pytest.approx(far.upper, rel=2e-3)
    iterations = [sum(each.iterations for each in found.history[2:]) for found in (near, far)]
    assert iterations[0] < 0.85 * iterations[1]


def test_a_start_that_fails_is_left(monkeypatch) -> None:
    """[X] From points at the surface of their cones the bounds are found from the beginning."""
    carried = search.carried

    def useless(*args):
        iterate = carried(*args)
        return iterate._replace(s=1e-12 * iterate.s[::-1], z=1e6 * iterate.z[::-1])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        found = bracket("Griffiths and Lane 1", 0.06)
        monkeypatch.setattr(search, "carried", useless)
        again = bracket("Griffiths and Lane 1", 0.06)
    # solvers stop at 3e-4
    assert again.lower == pytest.approx(found.lower, rel=1e-3)
    assert again.upper == pytest.approx(found.upper, rel=1e-3)


def test_a_near_start_that_takes_long_is_left(monkeypatch) -> None:
    """[X] Cut off, it adds its iterations to the ones from the beginning, and the bounds stay."""
    carried = search.carried
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        monkeypatch.setattr(interior_point, "_MOST_NEAR", 2)
        near = bracket("N_c, 20 degrees", 0.15)
        monkeypatch.setattr(search, "carried", lambda *args: carried(*args) and None)
        far = bracket("N_c, 20 degrees", 0.15)
    assert len(near.history) == len(far.history) > 2
    # the same iterations; the order of sums differs
    assert near.lower == pytest.approx(far.lower, rel=1e-6)
    assert near.upper == pytest.approx(far.upper, rel=1e-6)
    extra = [a.iterations - b.iterations for a, b in zip(near.history, far.history)]
    assert extra == [0, 0, *[2] * (len(extra) - 2)]
