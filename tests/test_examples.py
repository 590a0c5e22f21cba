"""Every example of the first three chapters runs, passes its own checks and ends with its figures."""

from __future__ import annotations

import json
import math
import os
import runpy
import shutil
import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import pytest

ROOT = Path(__file__).parents[1]
CHAPTERS = ("1_first_steps", "1_short_scripts", "2_contact", "3_geotechnics")
SCRIPTS = [path for chapter in CHAPTERS for path in sorted((ROOT / "examples" / chapter).glob("plot_*.py"))]
#: Those of more than 20 s; where the gallery is built as well, it runs them and their checks.
LONG = {"plot_published_slopes", "plot_bounds_pile", "plot_embankment", "plot_drawdown", "plot_excavation_below_water"}
KEYS = {"method", "n", "unknowns", "error", "cpu_s", "iterations"}


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_example_runs_and_ends_with_its_figures(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The last line is one JSON object that names the case and holds at least one row of figures."""
    if script.stem in LONG and os.environ.get("GALLERY_RUNS_LONG_EXAMPLES"):
        pytest.skip("the gallery runs it")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    for mesh in script.parent.glob("*.msh"):
        shutil.copy(mesh, tmp_path)
    monkeypatch.syspath_prepend(script.parent)  # as for a script that is run
    monkeypatch.setattr(sys, "argv", [str(script)])
    monkeypatch.setattr(plt, "show", lambda: None)
    try:
        runpy.run_path(str(script), run_name="__main__")
    finally:
        plt.close("all")

    figures = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert figures["case"]
    assert figures["rows"]
    for row in figures["rows"]:
        assert set(row) >= KEYS
        assert row["error"] is None or 0.0 <= row["error"] < math.inf
