"""Searches that are stopped by hand, or by an error of a law or a solver."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.errors import NoEquilibrium

ERRORS = [KeyboardInterrupt(), RuntimeError("licence")]


class Failing(sc.MohrCoulomb):
    """Clay, F = 2 c / q under a load q, that raises an error after some updates of all copies."""

    calls = np.inf
    error: BaseException = KeyboardInterrupt()

    def update(self, strain_increment, stress, internal):
        Failing.calls -= 1
        if Failing.calls < 0:
            raise Failing.error
        return super().update(strain_increment, stress, internal)


@pytest.fixture
def column():
    """Model of a column that can spread, and the load of one on its top."""
    Failing.calls = np.inf
    mesh = MeshQuad().refined(1).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soil = sc.SolidForm(basis, Failing(E=1e3, nu=0.3, c=10.0, phi=0.0))
    fixed = [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    model = sc.Model({"soil": soil}, fixed)
    yield model, model.traction("top", (0.0, -1.0))
    Failing.calls = np.inf


def stopped(search, calls, error):
    """Result of a search whose law raises an error at its last update but some."""
    Failing.calls = np.inf
    before = Failing.calls = 10**6
    whole = search()
    used = before - Failing.calls
    Failing.calls, Failing.error = used - calls, error
    with pytest.raises(type(error)) as stop:
        search()
    Failing.calls = np.inf
    assert stop.value is error
    return whole, stop.value.result


@pytest.mark.parametrize("error", ERRORS)
@pytest.mark.parametrize("name", ["strength_reduction", "limit_load"])
@pytest.mark.one_in(2)
def test_accepted_equilibria_are_kept(column, name, error):
    """[X] All steps before the error, and the largest value among them below 2 c / q; the end
    starts another search.
    """
    model, load = column
    load = 10.0 * load if name == "strength_reduction" else load
    options = {"progress": False} | ({"certify": False} if name == "strength_reduction" else {})
    whole, part = stopped(lambda: getattr(model, name)(load, **options), 3, error)
    limit = 2.0 if name == "strength_reduction" else 20.0
    assert part.stop.kind == "interrupted" and type(error).__name__ in str(part)
    assert not part.stop.shows_limit
    n = len(part.steps)
    assert n >= 3
    # all digits; NaN, for nothing that yields, equals nothing from Python 3.13 on
    assert repr(part.steps) == repr(whole.steps[:n])
    equilibria = [step.parameter for step in part.steps if step.outcome == "equilibrium"]
    assert [value for value, _ in part.path] == equilibria
    assert part.value == max(value for value, _ in part.path)
    assert 0.4 * limit < part.value < 1.01 * limit
    assert part.bracket == (part.value, np.inf)
    again = getattr(model, name)(load if name == "limit_load" else None, start=part.end, **options)
    more = part.value if name == "limit_load" else 0.0  # the load of the start stays
    assert again.value + more == pytest.approx(limit, rel=0.01)


def test_nothing_accepted_is_the_start(column):
    """[X] An error in the first equilibrium leaves the start, for each search; `is_stable` too."""
    model, load = column
    start = model.run([sc.Stage("first", load)], progress=False)
    for search in (model.strength_reduction, model.limit_load, model.is_stable):
        for given in (None, start):
            Failing.calls, Failing.error = 0, ERRORS[1]
            with pytest.raises(RuntimeError) as stop:
                search(load, start=given)
            Failing.calls = np.inf
            kept = stop.value.result
            end = kept if search == model.is_stable else kept.end
            expected = np.zeros_like(load) if given is None else start[-1].x
            assert np.array_equal(end.x, expected)
            if search != model.is_stable:
                assert kept.steps == () and kept.value == 0.0
            assert model.is_stable(load, start=end)


def test_search_that_stops_by_itself(column):
    """[X] A structure that does not resist its load: the failed steps are in the error, with the
    displacements and residuals of the last one, which a run and a limit load have as well.
    """
    model, load = column
    with pytest.raises(NoEquilibrium, match="does not resist its load") as stop:
        model.strength_reduction(100.0 * load, progress=False)
    steps = stop.value.result.steps
    assert {step.outcome for step in steps} == {"collapse"}
    assert np.linalg.norm(stop.value.x) > 0.0
    assert len(stop.value.residuals) == steps[-1].iterations + 1

    weak = sc.Model(model.forms, model.fixed, newton=sc.Newton(max_iterations=1))
    stage = [sc.Stage("whole", 100.0 * load)]
    runs = (lambda: weak.run(stage, progress=False), lambda: weak.limit_load(load, step=1e9))
    for run in runs:
        with pytest.raises(sc.NotConverged) as stop:
            run()
        assert np.linalg.norm(stop.value.x) > 0.0
        assert len(stop.value.residuals) > 1


def test_error_of_a_solver(column):
    """[X] The same for a solver of the user, which fails after some calls."""
    model, load = column
    calls = 0

    def solver(A, b):
        nonlocal calls
        calls += 1
        if calls > 12:
            raise OSError("no licence")
        return spsolve(A.tocsc(), b)

    other = sc.Model(model.forms, model.fixed, solver=solver)
    with pytest.raises(OSError, match="no licence") as stop:
        other.limit_load(load, progress=False)
    assert 10.0 < stop.value.result.value <= 20.01
    assert stop.value.result.iterations > 3


def test_error_while_bounds_are_proven_keeps_the_search(column, monkeypatch):
    """[X] A search that is over is whole, though its bounds are not proven."""
    from skfem_contact.collapse import strength

    def fails(*args, **named):
        raise KeyboardInterrupt

    model, load = column
    monkeypatch.setattr(strength, "at_hand", fails)
    with pytest.raises(KeyboardInterrupt) as stop:
        model.strength_reduction(10.0 * load, progress=False)
    assert stop.value.result.stop.shows_limit
    assert stop.value.result.value == pytest.approx(2.0, rel=0.01)
