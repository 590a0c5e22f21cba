"""Report of an analysis: one HTML file with model, stages, tables, pictures and remarks."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from datetime import datetime
from html import escape
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from string import Template
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from numpy import ndarray

from ..display import Table
from ..forms.base import solids_of
from ..forms.roles import materials_of
from ..results.cuts import Sections
from ..results.fields import basis_of, has_solids, solids
from ..results.result import COLUMNS, Result, rows_of
from ..results.stage import StageResult
from ..units import in_words
from ..versions import own_version, versions
from .contour import Contours, contours, cutaway
from .diagram import diagram
from .mechanism import load_curve, mechanism
from .model import Shade, drawn, shades
from .sheet import close

_KINDS = {".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg", ".gif": "gif", ".svg": "svg+xml"}
#: Stages side by side in a table: more of them continue below.
_COLUMNS = 8
#: Dots per inch of figures.
_DPI = 150
#: Width of the picture of a field in pixels.
_WIDE = 900
#: Names of a template.
_NAMES = (
    "title",
    "facts",
    "model",
    "stages",
    "table",
    "diagrams",
    "searches",
    "pictures",
    "remarks",
    "run",
    "versions",
    "footer",
)
#: Texts of empty parts.
_NOTHING = {
    "searches": "No strength reduction or limit load is part of this report.",
    "pictures": "There are no further pictures.",
    "remarks": "The forms have no remarks on the ends of the stages.",
}


def report(
    result: Result,
    file: str | Path,
    *,
    title: str = "Analysis",
    quantity: str = "u",
    sections: Mapping[str, Sections] | None = None,
    searches: Mapping[str, Any] | None = None,
    pictures: Mapping[str, Any] | None = None,
    template: str | Path | None = None,
) -> Path:
    """Write a report: one HTML file that needs nothing else, and that a browser prints to PDF.

    It holds the materials and other parts of the model, two pictures of each stage, the largest
    displacements and forces, diagrams of section forces, the searches, remarks and warnings of the
    run, versions and times.

    Parameters
    ----------
    result
        Result of an analysis, also one that stopped early or was read by
        :func:`~skfem_contact.load_result`.
    file
        Name of the file, ``.html``.
    title
        Title of the report.
    quantity
        Field that is drawn for every stage, on one scale.
    sections
        Cuts through solids by their names, whose section forces are reported like forces of beams.
    searches
        Strength reductions or limit loads by the stages from which they start.
    pictures
        Further pictures by their captions: figures of matplotlib, plotters, or names of files.
    template
        Template of your own: a text with ``$title``, ``$facts``, ``$model``, ``$stages``,
        ``$table``, ``$diagrams``, ``$searches``, ``$pictures``, ``$remarks``, ``$run``,
        ``$versions`` and ``$footer``, or some of them; ``$$`` is a dollar sign. By default
        ``skfem_contact/data/report.html`` of the package.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ValueError
        No stage, a form, stage or field that does not exist, a picture that is none, or a template
        with other names.

    Examples
    --------
    >>> import os, tempfile
    >>> import skfem_contact as sc
    >>> beam = sc.Beam(None, [[0., 0.], [1., 0.], [2., 0.]], EI=100., EA=1e4)
    >>> model = sc.Model({"beam": beam}, beam.dofs((0., 0.)))
    >>> result = model.run([sc.Stage("tip", model.forms["beam"].load((0., -3.), at=(2., 0.)))])
    >>> result.report(os.path.join(tempfile.mkdtemp(), "beam.html"), title="A cantilever").name
    'beam.html'
    """
    # Compute the table and the colours that several parts share.
    if not len(result):
        raise ValueError("a report needs a result with a stage")
    sections = sections or {}
    searches = searches or {}
    text = template_of(template)
    table = result.table(sections=sections, searches=searches)
    colors = shades(result)

    # Fill the template; empty parts say so.
    parts = {
        "pictures": _figures((pictures or {}).items()),
        "title": escape(title),
        "facts": _facts(result, table, searches),
        "model": _model(result, colors),
        "stages": "\n".join(_stages(result, colors, quantity)),
        "table": _by_stages(table),
        "diagrams": _figures(_diagrams(result, sections)),
        "searches": "\n".join(_searches(searches)),
        "remarks": _remarks(result),
        "run": _run(result),
        "versions": _pairs(versions()),
        "footer": escape(f"skfem_contact {own_version()}, {datetime.now():%Y-%m-%d %H:%M}"),
    }
    for name, words in _NOTHING.items():
        parts[name] = parts[name] or f'<p class="none">{words}</p>'
    Path(file).write_text(text.substitute(parts), encoding="utf-8")
    return Path(file)


def template_of(file: str | Path | None) -> Template:
    """Return a template with checked names, by default the template of the package."""
    package = files("skfem_contact") / "data" / "report.html"
    path = package if file is None else Path(file)
    text = Template(path.read_text(encoding="utf-8"))
    try:
        text.substitute(dict.fromkeys(_NAMES, ""))
    except (KeyError, ValueError) as error:
        raise ValueError(
            f"the template is wrong: {error}; its names are "
            f"{', '.join(f'${name}' for name in _NAMES)}, and $$ is a dollar sign"
        ) from error
    return text


def _facts(result: Result, table: Table, searches: Mapping[str, Any]) -> str:
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
        found[in_words("largest displacement", "length")] = f"{largest:.4g}"

    # Collect factors and times.
    for stage, search in searches.items():
        bound = "" if search.stop.shows_limit else "at least "
        found[f"{search.what}, {stage}"] = f"{bound}{search.value:.3f}"
    seconds = sum(stage.seconds for stage in result)
    found["time"] = f"{seconds:.1f} s"
    facts = [
        f'<div class="fact"><b>{escape(value)}</b><span>{escape(name)}</span></div>'
        for name, value in found.items()
    ]
    return "".join(facts)


def _model(result: Result, colors: Mapping[str, Shade]) -> str:
    """Return the materials and the other forms with their parameters."""
    # Collect the unit weights of the solids, and the forms that are no solids.
    weights: dict[str, Any] = {}
    others: dict[str, tuple[str, str, str]] = {}
    for stage in result:
        for name, solid in solids_of(stage.forms).items():
            if solid.materials:
                weights[name] = solid.unit_weight
        for name, form in stage.forms.items():
            if not materials_of(form):
                parameters = _listed(stage.outputs(name).parameters)
                others[name] = (name, type(form).__name__, parameters)

    # Write a table of each.
    rows = []
    for shade in colors.values():
        texts = (
            ", ".join(shade.names),
            shade.material.label,
            _weight(shade, weights),
            _parameters(shade.material),
        )
        cells = "".join(f"<td>{escape(text)}</td>" for text in texts)
        square = f'<i class="shade" style="background:{shade.color}"></i>'
        rows.append(f"<tr><td>{square}</td>{cells}</tr>")
    names = ("", "regions", "material", "unit weight", "parameters")
    head = "".join(f"<th>{name}</th>" for name in names)
    body = "".join(rows)
    tables = ""
    if rows:
        tables += f'<table class="text"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>'
    if others:
        tables += _plain(Table(("name", "kind", "parameters"), tuple(others.values())))
    return tables


def _plain(table: Table) -> str:
    """Return a table of texts, which are aligned on the left."""
    return table._repr_html_().replace("<table>", '<table class="text">')


def _weight(shade: Shade, weights: Mapping[str, Any]) -> str:
    """Return the unit weights of the regions of a material."""
    found: dict[Any, None] = {}
    for form, weight in weights.items():
        by_region = weight if isinstance(weight, Mapping) else {form: weight}
        found |= dict.fromkeys(by_region.get(name) for name in shade.names)
    return ", ".join(f"{weight:g}" for weight in found if weight is not None)


def _parameters(thing: Any) -> str:
    """Return the parameters of a material or interface law."""
    own = getattr(thing, "_law", thing)  # a material that does not derive from Material
    if not is_dataclass(own):
        return ""
    return _listed({part.name: getattr(own, part.name) for part in fields(own)})


def _listed(values: Mapping[str, Any]) -> str:
    """Return parameters in one line, without zeros and unlimited ones."""
    texts = []
    for name, value in values.items():
        if np.ndim(value) or value not in (0, None, np.inf, False, ""):
            texts.append(f"{name} {_value(value)}")
    return ", ".join(texts)


def _value(value: Any) -> str:
    if isinstance(value, ndarray):
        return f"{value.min():.4g} to {value.max():.4g}"
    if is_dataclass(value):
        return f"{type(value).__name__}({_parameters(value)})"
    if isinstance(value, tuple):
        return " and ".join(map(_value, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _stages(result: Result, colors: Mapping[str, Shade], quantity: str) -> Iterator[str]:
    """Yield each stage: its changes, the model, and a field on the scale of all stages."""
    # Choose the common scale of plane pictures.
    with_solids = [stage for stage in result if has_solids(stage)]
    space = bool(with_solids) and basis_of(with_solids[0]).mesh.dim() == 3
    common: Contours | None = None
    if with_solids and not space:
        common = contours(with_solids, quantity)

    # Draw the model and the field of each stage.
    before: list[str] = []
    for stage in result:
        pictures = {} if space else {f"{stage.name}: model": drawn(stage, colors)}
        if has_solids(stage):
            pictures |= {f"{stage.name}: {quantity}": _field(stage, quantity, common)}
        yield (
            f'<section class="stage"><h3>{escape(stage.name)}</h3><p>{_changes(stage, before)}</p>'
            f"{_figures(pictures.items())}</section>"
        )
        before = list(stage.states)


def _field(stage: StageResult, quantity: str, common: Contours | None) -> Any:
    """Return the picture of a field, in the plane on the common scale of all stages."""
    if common is None:
        return cutaway(stage, quantity)
    levels = common.scale.levels
    ends = float(levels[0]), float(levels[-1])
    image = BytesIO()
    plotter = contours([stage], quantity, limits=ends).draw(None, False, image, False, width=_WIDE)
    if plotter is None:
        return None
    close(plotter)
    return image.getvalue()


def _changes(stage: StageResult, before: list[str]) -> str:
    """Return in words new and removed forms, and how the stage was found."""
    new = [name for name in stage.states if name not in before]
    removed = [name for name in before if name not in stage.states]
    words = []
    if new:
        kind = "new" if before else "active"
        words.append(f"{kind}: {', '.join(new)}")
    if removed:
        words.append(f"removed: {', '.join(removed)}")
    load = "" if stage.fraction == 1.0 else f"stopped at {stage.fraction:.1%} of its load; "
    increments = _counted(len(stage.iterations), "increment")
    iterations = _counted(sum(stage.iterations), "iteration")
    words.append(f"{load}{increments}, {iterations}, residual {stage.residual:.0e}")
    return escape(". ".join(words) + ".")


def _counted(n: int, noun: str) -> str:
    return f"{n} {noun}" if n == 1 else f"{n} {noun}s"


def _by_stages(table: Table) -> str:
    """Return the table of stages with a column for each stage, some columns at a time."""
    names = [name for name in table.head if name != "stage" and not name.endswith(" at")]
    columns = zip(*table.texts(), strict=True)
    text = dict(zip(table.head, columns, strict=True))

    def cell(name: str, k: int) -> str:
        content = escape(text[name][k])
        coordinates = text.get(f"{name} at")
        if coordinates is not None and coordinates[k]:
            content += f"<small>{escape(coordinates[k])}</small>"
        return f"<td>{content}</td>"

    # Put some stages into each table.
    tables = []
    n_tables = -(-len(table) // _COLUMNS)
    for stages in np.array_split(np.arange(len(table)), n_tables):
        head = "".join(f"<th>{escape(text['stage'][k])}</th>" for k in stages)
        body = ""
        for name in names:
            cells = "".join(cell(name, k) for k in stages)
            body += f"<tr><th>{escape(in_words(name))}</th>{cells}</tr>"
        tables.append(
            f'<table class="stages"><thead><tr><th></th>{head}</tr></thead>'
            f"<tbody>{body}</tbody></table>"
        )
    return "\n".join(tables)


def _diagrams(result: Result, sections: Mapping[str, Sections]) -> Iterator[tuple[str, Any]]:
    """Yield section forces of plane beams and of cuts: their envelope, and the last stage's."""
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


def _bent_beams(result: Result) -> Iterator[str]:
    """Yield the names of beams that have moments in the plane, once or more often."""
    for stage in result:
        for name in stage.states:
            along = stage.outputs(name).lines
            if along is not None:
                moment = along[5]
                if np.ndim(moment) == 1 and np.any(moment):
                    yield name


def _searches(searches: Mapping[str, Any]) -> Iterator[str]:
    """Yield the end of each search, its mechanism and its curve."""
    for stage, search in searches.items():
        lines = str(search).split("\n" + search._table())[0]
        pictures = {f"Curve of the {search.what}": load_curve(search)}
        if basis_of(search.end).mesh.dim() == 2:
            pictures = {"Mechanism": mechanism(search)} | pictures
        title = f"<h3>{escape(search.what)}, {escape(stage)}</h3>"
        yield f"{title}<pre>{escape(lines)}</pre>{_figures(pictures.items())}"


def _remarks(result: Result) -> str:
    """Return the remarks on every stage."""
    text = ""
    for stage in result:
        items = "".join(f"<li>{escape(remark)}</li>" for remark in stage.remarks)
        if items:
            text += f"<h3>{escape(stage.name)}</h3><ul>{items}</ul>"
    return text


def _run(result: Result) -> str:
    """Return increments, iterations and times of the stages."""
    *names, state = COLUMNS
    rows = []
    for stage, (*values, summary) in zip(result, rows_of(result), strict=True):
        rows.append((*values, f"{stage.seconds:.2f}", summary))
    return _plain(Table((*names, "seconds", state), tuple(rows)))


def _pairs(values: Mapping[str, str]) -> str:
    items = [f"<dt>{escape(name)}</dt><dd>{escape(text)}</dd>" for name, text in values.items()]
    return f"<dl>{''.join(items)}</dl>"


def _figures(pictures: Iterable[tuple[str, Any]]) -> str:
    """Return pictures with their captions side by side."""
    found = ""
    for caption, picture in pictures:
        text = f"<figcaption>{escape(caption)}</figcaption>"
        found += f"<figure>{_embedded(caption, picture)}{text}</figure>"
    return f'<div class="figures">{found}</div>' if found else ""


def _embedded(caption: str, picture: Any) -> str:
    """Return a picture as part of the page."""
    if picture is None:
        return '<p class="none">This machine could not draw it: VTK needs OpenGL.</p>'
    kind, content = _image(caption, picture)
    data = b64encode(content).decode()
    return f'<img alt="{escape(caption)}" src="data:image/{kind};base64,{data}">'


def _image(caption: str, picture: Any) -> tuple[str, bytes]:
    """Return the kind and the content of the image of a picture, which is closed."""
    # Take pictures of bytes, figures of matplotlib and files.
    if isinstance(picture, bytes):
        return "png", picture
    if isinstance(picture, Figure):
        data = BytesIO()
        picture.savefig(data, dpi=_DPI, format="png")
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
