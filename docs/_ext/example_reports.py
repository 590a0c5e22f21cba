"""Reports of a pit, a slope and a pile, written where the gallery has run their examples."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import skfem_contact as sc

REPORTS = Path(__file__).parents[1] / "_static" / "reports"


def pit(file: Path, names: dict[str, Any]) -> None:
    """Write the report of the anchored wall with its factor of safety."""
    found = {"dig 2": names["found"]}
    names["result"].report(file, title="An anchored wall", searches=found)


def slope(file: Path, names: dict[str, Any]) -> None:
    """Write the report of the slope with two water levels."""
    stage = sc.Stage("water", water=names["levels"])
    result = names["model"].run([stage], progress=False)
    result.report(file, title="A slope in two layers", searches={"water": names["wet"]})


def pile(file: Path, names: dict[str, Any]) -> None:
    """Write the report of the pile by p-y curves with its largest force."""
    found = {"push": names["found"]}
    names["result"].report(file, title="A laterally loaded pile", searches=found)


MAKERS = {
    "plot_anchored_wall.py": pit,
    "plot_slope_with_water.py": slope,
    "plot_pile_by_curves.py": pile,
}


def write(block: tuple, variables: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Write the report of an example after its last block, which has its figures as ``row``.

    The gallery calls this after each block, as if it collected pictures: none is added."""
    make = MAKERS.get(Path(variables["src_file"]).name)
    names = variables["example_globals"]
    if make is not None and "row" in names:
        REPORTS.mkdir(exist_ok=True)
        sc.set_units("kN", "m")
        make(REPORTS / f"{make.__name__}.html", names)
    return ""
