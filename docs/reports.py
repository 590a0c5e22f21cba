"""Write three reports for the documentation: a pit, a slope and a pile, from their examples.

``python docs/reports.py`` writes those that are missing to ``docs/_static/reports``, and so does
the build of the documentation."""

from __future__ import annotations

import contextlib
import io
import os
import runpy
import sys
import tempfile
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as plt

import skfem_contact as sc

DOCS = Path(__file__).parent
REPORTS = DOCS / "_static" / "reports"
EXAMPLES = DOCS.parent / "examples"


def write() -> list[Path]:
    """Run the examples and write the reports that are missing."""
    REPORTS.mkdir(exist_ok=True)
    written = []
    for name, make in MAKERS.items():
        file = REPORTS / f"{name}.html"
        written.append(file if file.is_file() else make(file))
    return written


def pit(file: Path) -> Path:
    """Write the report of the anchored wall with its factor of safety."""
    names = run("4_pits_and_walls/plot_anchored_wall.py")
    found = {"dig 2": names["found"]}
    return names["result"].report(file, title="An anchored wall", searches=found)


def slope(file: Path) -> Path:
    """Write the report of the slope with two water levels."""
    names = run("3_slopes/plot_slope_with_water.py")
    levels = {"sand": names["phreatic"], "clay": names["piezometric"]}
    result = names["model"].run([sc.Stage("water", water=levels)], progress=False)
    return result.report(file, title="A slope in two layers", searches={"water": names["wet"]})


def pile(file: Path) -> Path:
    """Write the report of the pile by p-y curves with its largest force."""
    names = run("5_foundations_and_piles/plot_pile_by_curves.py")
    found = {"push": names["found"]}
    return names["result"].report(file, title="A laterally loaded pile", searches=found)


MAKERS = {"pit": pit, "slope": slope, "pile": pile}


def run(example: str) -> dict[str, Any]:
    """Return the names of an example that is run in a folder of its own, without its output."""
    matplotlib.use("Agg")
    here, arguments = Path.cwd(), sys.argv
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        os.chdir(folder)
        sys.argv = [example]
        try:
            names = runpy.run_path(str(EXAMPLES / example), run_name="__main__")
        finally:
            os.chdir(here)
            sys.argv = arguments
            plt.close("all")
    sc.set_units("kN", "m")
    return names


if __name__ == "__main__":
    for written in write():
        print(written)
