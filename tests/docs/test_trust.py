"""The page on trust names the thresholds of the code, and the cheat sheet all names at the top."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import pytest

import skfem_contact as sc

GUIDE = Path(__file__).parents[2] / "docs" / "guide"
ROWS = re.findall(r"`([\w.]+)\.(\w+) = ([\d.]+)`", (GUIDE / "trust.md").read_text(encoding="utf-8"))


@pytest.mark.parametrize("module, name, value", ROWS, ids=[name for _, name, _ in ROWS])
def test_threshold_is_that_of_the_code(module: str, name: str, value: str) -> None:
    """[X] A threshold that changes must change on the page as well."""
    assert getattr(import_module(f"skfem_contact.{module}"), name) == float(value)


def test_all_thresholds_are_found() -> None:
    assert len(ROWS) == 23


def test_cheat_sheet_has_all_names() -> None:
    """Each public name stands on the page; errors and parts of others, which no script begins with,
    need not.
    """
    text = (GUIDE / "cheat_sheet.md").read_text(encoding="utf-8")
    further = {
        "AnalysisWarning",
        "Field",
        "Internal",
        "NoEquilibrium",
        "NotConverged",
        "Response",
        "Cuts",
        "Surface",
        "mesh",
        "water_load",
    }
    assert not [
        name for name in sc.__all__ if name not in further and not re.search(rf"\b{name}\b", text)
    ]
