"""Report of an analysis: one HTML file with model, stages, tables, pictures and remarks."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from datetime import datetime
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from ..display import Table
from ..forms.base import solids_of
from ..forms.roles import materials_of
from ..results.cuts import Cuts
from ..results.result import Result
from ..versions import own_version, versions
from . import document, report_tables
from .model import Shade, shades
from .report_parts import diagrams_of, facts_of, image, run_of, searches_of, stages_of

#: Stages side by side in a table: more of them continue below.
_COLUMNS = 8
#: Names of a template.
_NAMES = (
    "title",
    "facts",
    "model",
    "parameters",
    "ground",
    "supports",
    "stages",
    "loads",
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
    "ground": "The first stage has no stresses at rest, and no stage has water.",
    "supports": "The supports are not known.",
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
    sections: Mapping[str, Cuts] | None = None,
    searches: Mapping[str, Any] | None = None,
    pictures: Mapping[str, Any] | None = None,
    template: str | Path | None = None,
) -> Path:
    """Write a report: one HTML file that needs nothing else, or a Word document.

    It holds the materials and other parts of the model with all parameters, supports, stresses at
    rest and water, two pictures of each stage, resultants of loads and reactions, the largest
    displacements and forces, diagrams of section forces, the searches with the error of the mesh,
    remarks and warnings of the run, versions and times. A browser prints the page to PDF.

    Parameters
    ----------
    result
        Result of an analysis, also one that stopped early or was read by
        :func:`~skfem_contact.load_result`.
    file
        Name of the file, ``.html``, or ``.docx`` where python-docx is installed.
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
        Template of your own: a text with ``$title``, ``$facts``, ``$model``, ``$parameters``,
        ``$ground``, ``$supports``, ``$stages``, ``$loads``, ``$table``, ``$diagrams``,
        ``$searches``, ``$pictures``, ``$remarks``, ``$run``, ``$versions`` and ``$footer``, or some
        of them; ``$$`` is a dollar sign. By default ``skfem_contact/data/report.html`` of the
        package. A ``.docx`` file has none.

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
    pictures = pictures or {}
    kind = Path(file).suffix.lower()
    word = kind == ".docx" and template is None
    if not word and kind not in (".html", ".htm"):
        raise ValueError(
            f"a report is an .html file, or a .docx file without template, not '{file}'"
        )
    if word:
        return document.write(
            result,
            Path(file),
            title,
            quantity,
            sections,
            searches,
            pictures,
        )
    text = template_of(template)
    table = result.table(sections=sections, searches=searches)
    colors = shades(result)

    # Fill the template; empty parts say so.
    parts = {
        "pictures": _figures(pictures.items()),
        "title": escape(title),
        "facts": _facts(facts_of(result, table, searches)),
        "model": _model(result, colors),
        "parameters": _plain(report_tables.parameters(result, colors)),
        "ground": _given(report_tables.at_rest(result), report_tables.water(result)),
        "supports": _given(report_tables.supports(result)),
        "loads": _given(report_tables.loads(result)),
        "stages": "\n".join(_stages(result, colors, quantity)),
        "table": _by_stages(table),
        "diagrams": _figures(diagrams_of(result, sections)),
        "searches": "\n".join(_searches(searches)),
        "remarks": _remarks(result),
        "run": _plain(run_of(result)),
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


def _facts(found: Mapping[str, str]) -> str:
    """Return the figures at the top of the page."""
    facts = []
    for name, value in found.items():
        facts.append(f'<div class="fact"><b>{escape(value)}</b><span>{escape(name)}</span></div>')
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


def _given(*tables: Table) -> str:
    """Return the tables that have rows."""
    return "".join(_plain(table) for table in tables if len(table))


def _weight(shade: Shade, weights: Mapping[str, Any]) -> str:
    """Return the unit weights of the regions of a material."""
    found: dict[Any, None] = {}
    for form, weight in weights.items():
        if isinstance(weight, Mapping):
            by_region = weight
        else:
            by_region = {form: weight}
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
            texts.append(f"{name} {report_tables.written(value)}")
    return ", ".join(texts)


def _stages(result: Result, colors: Mapping[str, Shade], quantity: str) -> Iterator[str]:
    """Yield each stage: its changes, the model, and a field on the scale of all stages."""
    for name, changes, pictures in stages_of(result, colors, quantity):
        yield (
            f'<section class="stage"><h3>{escape(name)}</h3><p>{escape(changes)}</p>'
            f"{_figures(pictures.items())}</section>"
        )


def _by_stages(table: Table) -> str:
    """Return the table of stages with a column for each stage, some columns at a time."""
    names = [name for name in table.head if name != "stage" and not name.endswith(" at")]
    columns = zip(*table.texts(), strict=True)
    text = dict(zip(table.head, columns, strict=True))
    titles = dict(zip(table.head, table.titles, strict=True))

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
            cells = "".join(cell(name, int(k)) for k in stages)
            body += f"<tr><th>{escape(titles[name])}</th>{cells}</tr>"
        tables.append(
            f'<table class="stages"><thead><tr><th></th>{head}</tr></thead>'
            f"<tbody>{body}</tbody></table>"
        )
    return "\n".join(tables)


def _searches(searches: Mapping[str, Any]) -> Iterator[str]:
    """Yield the end of each search, its mechanism and its curve."""
    for title, lines, pictures in searches_of(searches):
        text = f"<h3>{escape(title)}</h3><pre>{escape(lines)}</pre>"
        yield text + _figures(pictures.items())


def _remarks(result: Result) -> str:
    """Return the remarks on every stage."""
    text = ""
    for stage in result:
        items = "".join(f"<li>{escape(remark)}</li>" for remark in stage.remarks)
        if items:
            text += f"<h3>{escape(stage.name)}</h3><ul>{items}</ul>"
    return text


def _pairs(values: Mapping[str, str]) -> str:
    items = []
    for name, text in values.items():
        items.append(f"<dt>{escape(name)}</dt><dd>{escape(text)}</dd>")
    return f"<dl>{''.join(items)}</dl>"


def _figures(pictures: Iterable[tuple[str, Any]]) -> str:
    """Return pictures with their captions side by side."""
    found = ""
    for caption, picture in pictures:
        text = f"<figcaption>{escape(caption)}</figcaption>"
        found += f"<figure>{_embedded(caption, picture)}{text}</figure>"
    if found:
        return f'<div class="figures">{found}</div>'
    return ""


def _embedded(caption: str, picture: Any) -> str:
    """Return a picture as part of the page."""
    if picture is None:
        return '<p class="none">This machine could not draw it: VTK needs OpenGL.</p>'
    kind, content = image(caption, picture)
    data = b64encode(content).decode()
    return f'<img alt="{escape(caption)}" src="data:image/{kind};base64,{data}">'
