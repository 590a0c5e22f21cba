"""Fixtures of all tests."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator

import numpy as np
import pytest


def pytest_collection_finish() -> None:
    """Leave modules and tests, which live to the end, to the garbage collector no more.

    It takes an eighth of the time of all tests otherwise.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark further cells of families as exhaustive.

    Of a family with the marker `one_in(n)` one in n cells stays, the others are slow as well. Of
    slow cells one in three stays. These are cells whose sum of indices is a multiple of n: as in a
    Latin square, values of several parameters take turns.
    """
    for item in items:
        place = sum(_indices(item))
        chosen = item.get_closest_marker("one_in")
        if chosen and place % chosen.args[0]:
            item.add_marker("slow")
            item.add_marker("exhaustive")
        elif item.get_closest_marker("slow") and place % 3:
            item.add_marker("exhaustive")


def _indices(item: pytest.Item) -> Iterator[int]:
    """Yield the place of the cell in each of its lists of parameters."""
    for given in item.iter_markers("parametrize"):
        names, cells = given.args[:2]
        names = names.split(",") if isinstance(names, str) else names
        own = [item.callspec.params[name.strip()] for name in names]
        for index, cell in enumerate(cells):
            if isinstance(cell, type(pytest.param())):
                cell = cell.values
            elif len(names) == 1:
                cell = (cell,)
            if all(map(_same, cell, own)):
                yield index
                break


def _same(one: object, other: object) -> bool:
    """Return whether two parameters are the same object or the same number or text."""
    simple = isinstance(one, str | int | float | np.generic) and isinstance(other, type(one))
    return one is other or (simple and one == other)


@pytest.fixture
def rng() -> np.random.Generator:
    """Random numbers that are the same in every run, so that a failure can be repeated."""
    return np.random.default_rng(20240229)


@pytest.fixture(autouse=True)
def bounds_beside(monkeypatch) -> None:
    """Leave out the bounds that searches compute unasked, in up to four times their own time.

    Modules that test these have a fixture of this name.
    """
    monkeypatch.setattr(
        "skfem_contact.collapse.strength.at_hand", lambda *args, **kwargs: (None, "")
    )


@pytest.fixture(autouse=True)
def figures_closed() -> Iterator[None]:
    """Close the figures that a test leaves open: Matplotlib warns of more than twenty."""
    yield
    pyplot = sys.modules.get("matplotlib.pyplot")
    if pyplot is not None:
        pyplot.close("all")


@pytest.fixture
def bars(monkeypatch) -> list[tuple[str, str, str]]:
    """Titles, notes and extremes of the colour bars of contour pictures."""
    import matplotlib.pyplot as plt

    found: list[tuple[str, str, str]] = []
    monkeypatch.setattr(
        "skfem_contact.plot.sheet.bar_figure",
        lambda scale, title, note, extremes, size, marks: (
            found.append((title, note, extremes)) or plt.figure()
        ),
    )
    return found
