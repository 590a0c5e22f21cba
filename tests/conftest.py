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
    """Mark as slow all but one in n cells of a family that says so.

    Cells stay whose sum of indices is a multiple of n: as in a Latin square, values of several
    parameters take turns.
    """
    for item in items:
        chosen = item.get_closest_marker("one_in")
        if chosen and sum(_indices(item)) % chosen.args[0]:
            item.add_marker("slow")


def _indices(item: pytest.Item) -> Iterator[int]:
    """Yield the index of the cell in each of its lists of parameters."""
    for given in item.iter_markers("parametrize"):
        names = given.args[0]
        first = names.split(",")[0].strip() if isinstance(names, str) else names[0]
        yield item.callspec.indices[first]


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
