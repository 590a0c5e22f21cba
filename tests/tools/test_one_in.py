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
@pytest.mark.parametrize("cell", range(3))
def test_every_second_slow_cell_is_exhaustive(cell, request) -> None:
    """[X] The first and the third of three slow cells run without it."""
    assert (request.node.get_closest_marker("exhaustive") is not None) == bool(cell % 2)
