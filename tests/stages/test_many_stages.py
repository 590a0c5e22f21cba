"""Runs of many stages begin at once."""

from __future__ import annotations

import sys
import time

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.scenes import halves

ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


@pytest.mark.slow
def test_many_stages_begin_at_once():
    """The checks of ten times as many stages take ten times as long, not a hundred times."""
    basis = halves()
    model = sc.Model(
        {"both": sc.SolidForm(basis, ELASTIC)}, [basis.get_dofs(f"{k}:bottom").all() for k in "lr"]
    )

    def stop(stage):
        raise KeyboardInterrupt

    def seconds(n):
        stages = [sc.Stage(f"{k}", basis.zeros()) for k in range(n)]
        began = time.process_time()
        with pytest.raises(KeyboardInterrupt):
            model.run(stages, on_increment=stop, progress=False)
        return time.process_time() - began

    seconds(1)
    assert seconds(10_000) < 30.0 * seconds(1_000)


def test_an_increment_costs_as_much_after_many():
    """Checks of arguments do not go through the increments that have been accepted before."""
    basis = halves()
    model = sc.Model(
        {"both": sc.SolidForm(basis, ELASTIC)}, [basis.get_dofs(f"{k}:bottom").all() for k in "lr"]
    )
    load = sc.weight(basis, 1.0)
    count = 0
    counts = []

    def called(frame, event, argument):
        nonlocal count
        count += event in ("call", "c_call")

    def accepted(stage):
        counts.append(count)

    sys.setprofile(called)
    try:
        model.run([sc.Stage("load", load, increments=400)], on_increment=accepted, progress=False)
    finally:
        sys.setprofile(None)
    calls = np.diff(counts)
    assert len(calls) == 399
    # a few increments update the bar of progress
    assert np.median(calls[300:]) == np.median(calls[5:100])
