"""Families of which a part runs by default."""

from __future__ import annotations

import numpy as np
import pytest

PLACES = {1.0: 0, None: 1, 2.0: 2}


@pytest.mark.parametrize(("text", "number"), [("a", 1.0), pytest.param("b", None), ("a", 2.0)])
@pytest.mark.parametrize("turn", np.arange(2))
@pytest.mark.one_in(2)
def test_cells_take_turns(text, number, turn, request) -> None:
    """[X] Cells are slow and exhaustive whose indices add up to an odd number."""
    marked = [request.node.get_closest_marker(name) is not None for name in ("slow", "exhaustive")]
    assert marked == 2 * [bool((PLACES[number] + turn) % 2)]
    assert text == ("b" if number is None else "a")


@pytest.mark.slow
@pytest.mark.parametrize("cell", range(4))
def test_two_of_three_slow_cells_are_exhaustive(cell, request) -> None:
    """[X] The first and the fourth of four slow cells are not."""
    assert (request.node.get_closest_marker("exhaustive") is not None) == bool(cell % 3)
