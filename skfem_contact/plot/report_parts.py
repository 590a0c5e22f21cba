"""Contents of a report, whatever its format: figures, stages, diagrams, searches, pictures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from ..display import Table
from ..results.cuts import Cuts
from ..results.fields import basis_of, has_solids, solids
from ..results.result import COLUMNS, Result, rows_of
from ..results.stage import StageResult
from ..units import labelled
from .contour import Contours, contours, cutaway
from .diagram import diagram
from .mechanism import load_curve, mechanism
from .model import Shade, drawn
from .sheet import PACKED, close, png
from .shells import shells

_KINDS = {".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg", ".gif": "gif", ".svg": "svg+xml"}
#: Dots per inch of figures.
_DPI = 150
#: Width of the picture of a field in pixels.
_WIDE = 900


def facts_of(result: Result, table: Table, searches: Mapping[str, Any]) -> dict[str, str]:
    """Return the figures at the top: stages, size of the model, displacement, factors, time."""
    # Collect sizes, and the extremes of displacements.
    last = result[-1]
    found = {"stages": f"{len(result)}", "degrees of freedom": f"{len(last.x)}"}
    if last.fraction < 1.0:
        found["stages"] = f"stopped at {last.fraction:.0%} of '{last.name}'"
    if has_solids(last):
        n_elements = sum(form.basis.nelems for form in solids(last).values())
        found["elements"] = f"{n_elements}"
    if "displacement" in table.head:
        largest = np.nanmax(table["displacement"])
        found[labelled("largest displacement", "length")] = f"{largest:.4g}"

    # Collect factors and times.
    for stage, search in searches.items():
        bound = "at least "
        if search.stop.shows_limit:
            bound = ""
        found[f"{search.what}, {stage}{error_of(search)}"] = f"{bound}{search.value:.3f}"
    seconds = sum(stage.seconds for stage in result)
    found["time"] = f"{seconds:.1f} s"
    return found


def error_of(search: Any) -> str:
    """Return in words how much the mesh adds to the value of a search, and its proven bounds."""
    text = f", {search.error} too high" if search.error else ""
    if search.proven is not None:
        text += f", proven {search.proven.lower:.3f} to {search.proven.upper:.3f}"
    return text


def stages_of(
    result: Result, colors: Mapping[str, Shade], quantity: str
) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield the name, the changes and the pictures of each stage."""
    # Choose the common scale of plane pictures.
    with_solids = [stage for stage in result if has_solids(stage)]
    space = bool(with_solids) and basis_of(with_solids[0]).mesh.dim() == 3
    common: Contours | None = None
    if with_solids and not space:
        common = contours(with_solids, quantity)

    # Draw the model and the field of each stage.
    before: list[str] = []
    for stage in result:
        if space:
            pictures = {}
        else:
            pictures = {f"{stage.name}: model": drawn(stage, colors)}
        if has_solids(stage):
            pictures |= {f"{stage.name}: {quantity}": _field(stage, quantity, common)}
        yield stage.name, _changes(stage, before), pictures
        before = list(stage.states)


def _field(stage: StageResult, quantity: str, common: Contours | None) -> Any:
    """Return the picture of a field, in the plane on the common scale of all stages."""
    if common is None:
        return cutaway(stage, quantity)
    levels = common.scale.levels
    ends = float(levels[0]), float(levels[-1])
    plotter = contours([stage], quantity, limits=ends).draw(None, False, None, False, width=_WIDE)
    if plotter is None:
        return None
    pixels = plotter.screenshot(None, return_img=True)
    close(plotter)
    return png(pixels)


def _changes(stage: StageResult, before: list[str]) -> str:
    """Return in words new and removed forms, and how the stage was found."""
    new = [name for name in stage.states if name not in before]
    removed = [name for name in before if name not in stage.states]
    words = []
    if new:
        kind = "active"
        if before:
            kind = "new"
        words.append(f"{kind}: {', '.join(new)}")
    if removed:
        words.append(f"removed: {', '.join(removed)}")
    if stage.fraction == 1.0:
        load = ""
    else:
        load = f"stopped at {stage.fraction:.1%} of its load; "
    increments = _counted(len(stage.iterations), "increment")
    iterations = _counted(sum(stage.iterations), "iteration")
    words.append(f"{load}{increments}, {iterations}, residual {stage.residual:.0e}")
    return ". ".join(words) + "."


def _counted(n: int, noun: str) -> str:
    if n == 1:
        return f"{n} {noun}"
    return f"{n} {noun}s"


def diagrams_of(result: Result, sections: Mapping[str, Cuts]) -> Iterator[tuple[str, Any]]:
    """Yield section forces of plane beams and of cuts: their envelope, and the last stage's.

    Then follow moments of shells in the last stage that has them.
    """
    for name in dict.fromkeys((*_bent_beams(result), *sections)):
        cuts = sections.get(name)
        last = next(stage for stage in reversed(result.stages) if name in stage.states)
        envelope = result.envelope(name, cuts)
        forces = last.section_forces(name, cuts)
        if forces.axis is not None:  # in space
            continue

        # Draw them around a ring, or along a line that may be upright.
        series = {"smallest": envelope.smallest, "largest": envelope.largest, last.name: forces}
        text = (
            f"{name}: smallest and largest section forces of all stages, and those of '{last.name}'"
        )
        is_ring = cuts is not None and cuts.curvature.all()
        if is_ring:
            for quantity in "NM":
                yield text, diagram(series, quantity, angle=forces.position)
        else:
            upright = bool(np.ptp(forces.y) > 2.0 * np.ptp(forces.x))
            yield text, diagram(series, upright=upright)

    yield from _moments_of_shells(result)


def _moments_of_shells(result: Result) -> Iterator[tuple[str, Any]]:
    """Yield moments of shells, each in the last stage in which it is active."""
    last_stages = {name: stage for stage in result for name in stage.states if name in stage.forms}
    for name, stage in last_stages.items():
        if stage.outputs(name).triangles is not None:
            for quantity in ("m_1", "m_2"):
                text = f"{name}: moments {quantity} per length, '{stage.name}'"
                yield text, shells(stage, quantity, names=name)


def _bent_beams(result: Result) -> Iterator[str]:
    """Yield the names of beams that have moments in the plane, once or more often."""
    for stage in result:
        for name in stage.states:
            along = stage.outputs(name).lines
            if along is not None:
                moment = along[5]
                if np.ndim(moment) == 1 and np.any(moment):
                    yield name


def searches_of(searches: Mapping[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield the title, the end, and the pictures of each search."""
    for stage, search in searches.items():
        pictures = {f"Curve of the {search.what}": load_curve(search)}
        if has_solids(search.end) and basis_of(search.end).mesh.dim() == 2:
            pictures = {"Mechanism": mechanism(search)} | pictures
        yield f"{search.what}, {stage}", search.head, pictures


def run_of(result: Result) -> Table:
    """Return increments, iterations and times of the stages."""
    *names, state = COLUMNS
    rows = []
    for stage, (*values, summary) in zip(result, rows_of(result), strict=True):
        rows.append((*values, f"{stage.seconds:.2f}", summary))
    return Table((*names, "seconds", state), tuple(rows))


def image(caption: str, picture: Any) -> tuple[str, bytes]:
    """Return the kind and the content of the image of a picture, which is closed."""
    # Take pictures of bytes, figures of matplotlib and files.
    if isinstance(picture, bytes):
        return "png", picture
    if isinstance(picture, Figure):
        data = BytesIO()
        picture.savefig(data, dpi=_DPI, format="png", pil_kwargs={"compress_level": PACKED})
        plt.close(picture)
        return "png", data.getvalue()
    if isinstance(picture, (str, Path)):
        path = Path(picture)
        end = path.suffix.lower()
        if end not in _KINDS or not path.is_file():
            raise ValueError(
                f"picture '{caption}': {picture} is no file with the end {', '.join(_KINDS)}"
            )
        return _KINDS[end], path.read_bytes()

    # Take the picture that an object shows in a notebook.
    png = getattr(picture, "_repr_png_", None)
    if not callable(png):
        raise ValueError(
            f"picture '{caption}' is a {type(picture).__name__}: give a figure, a plotter or a file"
        )
    content = png()
    close(picture)
    return "png", content
