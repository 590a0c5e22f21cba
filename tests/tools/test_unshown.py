"""Each public name and each option is in an example, a page or a doctest."""

from __future__ import annotations

import pytest

from tests.tools import unshown


@pytest.mark.slow
def test_all_names_and_options_are_shown() -> None:
    """The list that remains is empty; docs/guide/options.md is the place for special cases."""
    names, options = unshown.unshown()
    assert not names
    assert not options


def test_names_and_options_that_nothing_shows_are_found(monkeypatch) -> None:
    """[X] Without examples and pages all of them remain; a call or a paragraph takes one away."""
    seen = unshown.Shown(
        {"load_mesh"}, {("load_mesh", "factor")}, {"traction": 3}, [{"load_mesh", "split"}]
    )
    monkeypatch.setattr(unshown, "shown", lambda: seen)
    names, options = unshown.unshown()
    assert "sc.load_mesh" not in names and "sc.save_mesh" in names
    assert {"sc.load_mesh(plane)", "sc.load_mesh(name)"} <= set(options)
    assert not {"sc.load_mesh(factor)", "sc.load_mesh(split)"} & set(options)
