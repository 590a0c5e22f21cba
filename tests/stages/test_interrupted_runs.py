"""Runs that are stopped by hand."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import skfem_contact as sc
from skfem_contact.solvers import threads
from tests.tools.scenes import block_on_base


class Impatient(sc.Form):
    """A user who stops the run when it has been asked so many times."""

    def __init__(self, n, calls):
        self.K, self.calls = csr_matrix((n, n)), calls

    def assemble(self, x, state):
        self.calls -= 1
        if self.calls < 0:
            raise KeyboardInterrupt
        return sc.Response(self.K @ x, lambda: None, lambda: self.K)


def test_a_run_that_is_stopped_by_hand():
    """Ctrl-C carries what was accepted."""
    basis, forms, load, fixed = block_on_base()
    forms["user"] = Impatient(basis.N, 40)
    with pytest.raises(KeyboardInterrupt) as stop:
        sc.Model(forms, fixed).run(
            [sc.Stage("first", load), sc.Stage("long", 2 * load, increments=1000)], progress=False
        )
    assert 0.0 < stop.value.result["long"].fraction < 1.0


class Failing(sc.Form):
    """A spring of two dofs with a member that raises an error in its third stage."""

    size = 1

    def __init__(self, member=None, error=None):
        self.member, self.error, self.armed = member, error, False

    def _touched(self, member):
        if self.armed and member == self.member:
            raise self.error

    def initial_state(self, x=None):
        self._touched("initial_state")

    def assemble(self, x, state):
        self._touched("assemble")
        return sc.Response(2.0 * x, lambda: state, lambda: csr_matrix([[2.0]]))

    def outputs(self, x, state):
        self._touched("outputs")
        return sc.Outputs()


@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError("no space"), ZeroDivisionError()])
@pytest.mark.parametrize("member", ["initial_state", "assemble", "outputs", "observer", "solver"])
def test_whatever_ends_a_run_leaves_the_accepted_stages(member, error):
    """[X] An error in the third stage, wherever it is raised: two stages, x = F / k, are left."""
    form, late = Failing(member, error), Failing(member, error)

    def observe(increment):
        armed = increment.name == "b" and increment.fraction == 1.0
        form.armed = late.armed = armed or increment.name == "c"
        if increment.name == "c" and member == "observer":
            raise error

    def solver(A, b):
        form._touched("solver")
        return b / A.toarray()[0, 0]

    stages = [
        sc.Stage("a", np.array([1.0])),
        sc.Stage("b", np.array([2.0])),
        sc.Stage("c", np.array([3.0]), activate="late"),
    ]
    model = sc.Model({"spring": form, "late": late}, solver=solver)
    with pytest.raises(type(error)) as stop:
        model.run(stages, on_increment=observe, progress=False)
    result = stop.value.result
    assert [stage.name for stage in result.completed()][:2] == ["a", "b"]
    assert [float(stage.x[0]) for stage in result][:2] == pytest.approx([0.5, 1.0])
    form.member = late.member = None  # the model is as it was
    end = model.run(stages[2:], start=sc.results.Result(result.stages[:2]), progress=False)["c"]
    assert float(end.x[0]) == pytest.approx(0.75)


def test_a_run_that_is_stopped_at_its_end(monkeypatch):
    """[X] A run that is stopped when its last stage is done, while BLAS gets its threads back."""
    restored = threads.single_threaded.__exit__

    def stopped(*error):
        restored(*error)
        raise KeyboardInterrupt

    monkeypatch.setattr(
        type(threads.single_threaded), "__exit__", lambda self, *error: stopped(*error)
    )
    model = sc.Model({"spring": Failing()})
    with pytest.raises(KeyboardInterrupt) as stop:
        model.run([sc.Stage("a", np.array([1.0]))], progress=False)
    assert float(stop.value.result["a"].x[0]) == pytest.approx(0.5)


def test_stage_that_was_stopped_is_said_and_dropped_by_one_call():
    """A run that continues from a part of a stage says so; without it the stage is run again."""
    form = Failing("assemble", KeyboardInterrupt())
    model = sc.Model({"spring": form})
    stages = [sc.Stage("a", np.array([1.0])), sc.Stage("b", np.array([2.0]), increments=4)]

    def observe(increment):
        form.armed = increment.name == "b" and increment.fraction == 0.5

    with pytest.raises(KeyboardInterrupt) as stop:
        model.run(stages, on_increment=observe, progress=False)
    form.armed = False
    result = stop.value.result
    assert (len(result), result["b"].fraction) == (2, 0.5)
    with pytest.warns(sc.AnalysisWarning, match="ends at 50% of its stage 'b', from which"):
        model.run([sc.Stage("rest", np.array([2.0]))], start=result, progress=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        end = model.run(stages[1:], start=result.completed(), progress=False)
    assert [stage.fraction for stage in end] == [1.0, 1.0]
