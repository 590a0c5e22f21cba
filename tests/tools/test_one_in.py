"""Families of which a part runs by default."""

from __future__ import annotations

import numpy as np
import pytest

PLACES = {1.0: 0, None: 1, 2.0: 2}


@pytest.mark.parametrize(("text", "number"), [("a", 1.0), pytest.param("b", None), ("a", 2.0)])
@pytest.mark.parametrize("turn", np.arange(2))
@pytest.mark.one_in(2)
def test_cells_take_turns(text, number, turn, request) -> None:
    """[X] Cells are slow whose indices add up to an odd number."""
    slow = request.node.get_closest_marker("slow") is not None
    assert slow == bool((PLACES[number] + turn) % 2)
    assert text == ("b" if number is None else "a")
