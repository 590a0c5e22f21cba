"""Every example beside the benchmarks runs, passes its own checks and ends with its
figures.
"""

from __future__ import annotations

import json
import math
import os
import re
import runpy
import shutil
import sys
from itertools import chain
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import pytest

import skfem_contact as sc

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.slow

SCRIPTS = sorted((ROOT / "examples").glob("[0-9]*_*/plot_*.py"))
#: Folder of a built gallery, which has run the examples with their checks: its pages hold what they
#: printed.
GALLERY = os.environ.get("BUILT_GALLERY")
KEYS = {"method", "n", "unknowns", "error", "cpu_s", "iterations"}


@pytest.fixture(autouse=True)
def bounds_beside() -> None:
    """Keep the bounds that searches compute unasked."""


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_example_runs_and_ends_with_its_figures(
    script: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The last line is one JSON object that names the case and holds at least one row of
    figures.
    """
    output = _printed_in_gallery(script) if GALLERY else _run(script, tmp_path, monkeypatch, capsys)
    figures = json.loads(output.splitlines()[-1])
    assert figures["case"]
    assert figures["rows"]
    for row in figures["rows"]:
        assert set(row) >= KEYS
        assert row["error"] is None or 0.0 <= row["error"] < math.inf


@pytest.mark.skipif(not GALLERY, reason="the gallery writes the reports")
def test_reports_of_the_guide_are_written() -> None:
    """The gallery has written each report to which the guide links."""
    guide = (ROOT / "docs" / "guide" / "results.md").read_text(encoding="utf-8")
    linked = re.findall(r"_static/(reports/\w+\.html)", guide)
    assert len(linked) == 3
    for report in linked:
        assert (ROOT / "docs" / "_static" / report).is_file()


def _printed_in_gallery(script: Path) -> str:
    """Return the figures on the page of an example, which holds no warning of numpy."""
    page = (ROOT / str(GALLERY) / script.parent.name / f"{script.stem}.rst").read_text(
        encoding="utf-8"
    )
    assert "RuntimeWarning: " not in page
    return "\n".join(
        line.strip() for line in page.splitlines() if line.lstrip().startswith('{"case": ')
    )


def _run(
    script: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> str:
    """Run an example as a script in a folder of its own; return what it prints."""
    matplotlib.use("Agg")
    monkeypatch.chdir(folder)
    data = ("*.msh", "*.dxf", "*.ags", "*.dat", "*.frd")
    for given in chain.from_iterable(map(script.parent.glob, data)):
        shutil.copy(given, folder)
    monkeypatch.syspath_prepend(script.parent)  # as for a script that is run
    monkeypatch.setattr(sys, "argv", [str(script)])
    monkeypatch.setattr(plt, "show", lambda: None)
    try:
        runpy.run_path(str(script), run_name="__main__")
    finally:
        plt.close("all")
        sc.set_units()
    return capsys.readouterr().out
