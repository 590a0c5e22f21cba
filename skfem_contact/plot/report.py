"""Report of an analysis: one HTML file with model, stages, tables, pictures, remarks and
versions.
"""

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
from ..results.cuts import Sections
from ..results.fields import basis_of, solids
from ..results.result import Result
from ..results.stage import StageResult
from ..versions import own_version, versions
from .contour import Contours, contours, cutaway
from .diagram import diagram
from .mechanism import load_curve, mechanism
from .model import Shade, drawn, shades
from .sheet import close
from .units import in_words

_KINDS = {".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg", ".gif": "gif", ".svg": "svg+xml"}
#: Stages side by side in a table: more of them continue below.
_COLUMNS = 8
#: Dots per inch, and pixels over the width of a field beside the model.
_DPI, _WIDE = 150, 900
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
#: What is written where there is nothing.
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
        Cuts through solids by their names, whose section forces are reported as those of beams.
    searches
        Strength reductions or limit loads by the stages from which they start.
    pictures
        Further pictures by their captions: what functions of this module return, other figures of
        matplotlib, or names of files.
    template
        Template of your own: a text with ``$title``, ``$facts``, ``$model``, ``$stages``,
        ``$table``, ``$diagrams``, ``$searches``, ``$pictures``, ``$remarks``, ``$run``,
        ``$versions`` and ``$footer``, or some of them; ``$$`` is a dollar sign. By default that of
        the package, ``skfem_contact/data/report.html``.

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
    if not len(result):
        raise ValueError("a report needs a result with a stage")
    sections, searches = sections or {}, searches or {}
    text = template_of(template)
    table, colors = result.table(sections=sections, searches=searches), shades(result)
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
    nothing = {name: f'<p class="none">{words}</p>' for name, words in _NOTHING.items()}
    html = text.substitute({name: part or nothing.get(name, "") for name, part in parts.items()})
    Path(file).write_text(html, encoding="utf-8")
    return Path(file)


def template_of(file: str | Path | None) -> Template:
    """Return a template, by default that of the package, whose names are checked before anything is
    drawn.
    """
    path = files("skfem_contact") / "data" / "report.html" if file is None else Path(file)
    text = Template(path.read_text(encoding="utf-8"))
    try:
        text.substitute(dict.fromkeys(_NAMES, ""))
    except (KeyError, ValueError) as error:
        raise ValueError(
            f"the template is wrong: {error}; its names are "
            f"{', '.join(f'${name}' for name in _NAMES)}, "
            "and $$ is a dollar sign"
        ) from error
    return text


def _facts(result: Result, table: Table, searches: Mapping[str, Any]) -> str:
    """Return the figures at the top: stages, size of the model, largest displacement, factors,
    time.
    """
    last = result[-1]
    reached = (
        f"{len(result)}"
        if last.fraction == 1.0
        else f"stopped at {last.fraction:.0%} of '{last.name}'"
    )
    found = {"stages": reached, "degrees of freedom": f"{len(last.x)}"}
    if any(form.materials for form in solids_of(last.forms).values()):
        found["elements"] = f"{sum(form.basis.nelems for form in solids(last).values())}"
    if "displacement" in table.head:
        found[in_words("largest displacement", "length")] = (
            f"{np.nanmax(table['displacement']):.4g}"
        )
    for stage, search in searches.items():
        bound = "" if search.stop.shows_limit else "at least "
        found[f"{search.what}, {stage}"] = f"{bound}{search.value:.3f}"
    found["time"] = f"{sum(stage.seconds for stage in result):.1f} s"
    return "".join(
        f'<div class="fact"><b>{escape(value)}</b><span>{escape(name)}</span></div>'
        for name, value in found.items()
    )


def _model(result: Result, colors: Mapping[str, Shade]) -> str:
    """Return the materials and the other forms with their parameters."""
    weights = {
        name: form.unit_weight
        for stage in result
        for name, form in solids_of(stage.forms).items()
        if form.materials
    }
    rows = [
        f'<tr><td><i class="shade" '
        f'style="background:{shade.color}"></i></td><td>{escape(", ".join(shade.names))}'
        f"</td><td>{escape(shade.material.label)}</td><td>{escape(_weight(shade, weights))}</td>"
        f"<td>{escape(_parameters(shade.material))}</td></tr>"
        for shade in colors.values()
    ]
    head = "".join(
        f"<th>{name}</th>" for name in ("", "regions", "material", "unit weight", "parameters")
    )
    others = {
        name: form for stage in result for name, form in stage.forms.items() if not form.materials
    }
    further = Table(
        ("name", "kind", "parameters"),
        tuple((name, type(form).__name__, _parameters(form)) for name, form in others.items()),
    )
    materials = (
        f'<table class="text"><thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table>'
    )
    return materials * bool(rows) + _plain(further) * bool(others)


def _plain(table: Table) -> str:
    """Return a table of texts, which are aligned on the left."""
    return table._repr_html_().replace("<table>", '<table class="text">')


def _weight(shade: Shade, weights: Mapping[str, Any]) -> str:
    """Return the unit weights of the regions of a material."""
    found = {
        weight.get(name) if isinstance(weight, Mapping) else weight
        for form, weight in weights.items()
        for name in shade.names
        if name == form or (isinstance(weight, Mapping) and name in weight)
    }
    return ", ".join(f"{weight:g}" for weight in found if weight is not None)


def _parameters(thing: Any) -> str:
    """Return the parameters of a material, a law or another form, without those that are zero or
    unlimited.
    """
    own = getattr(thing, "_law", thing)  # a material that does not derive from Material
    values = (
        {f.name: getattr(own, f.name) for f in fields(own)}
        if is_dataclass(own)
        else thing.parameters
    )
    return ", ".join(
        f"{name} {_value(value)}"
        for name, value in values.items()
        if not (np.ndim(value) == 0 and value in (0, None, np.inf, False, ""))
    )


def _value(value: Any) -> str:
    if isinstance(value, ndarray):
        return f"{value.min():.4g} to {value.max():.4g}"
    if is_dataclass(value):
        return f"{type(value).__name__}({_parameters(value)})"
    if isinstance(value, tuple):
        return " and ".join(map(_value, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _stages(result: Result, colors: Mapping[str, Shade], quantity: str) -> Iterator[str]:
    """Yield each stage: what has changed, the model, and a field on the scale of all stages."""
    there, space = [stage for stage in result if _has_solids(stage)], False
    scale: Contours | None = None
    if there:
        space = basis_of(there[0]).mesh.dim() == 3
        scale = None if space else contours(there, quantity)
    before: list[str] = []
    for stage in result:
        pictures = {} if space else {f"{stage.name}: model": drawn(stage, colors)}
        if _has_solids(stage):
            pictures |= {f"{stage.name}: {quantity}": _field(stage, quantity, scale)}
        yield (
            f'<section class="stage"><h3>{escape(stage.name)}</h3><p>{_changes(stage, before)}</p>'
            f"{_figures(pictures.items())}</section>"
        )
        before = list(stage.states)


def _field(stage: StageResult, quantity: str, scale: Contours | None) -> Any:
    """Return the picture of a field, in the plane on a given scale."""
    if scale is None:
        return cutaway(stage, quantity)
    ends = float(scale.scale.levels[0]), float(scale.scale.levels[-1])
    image = BytesIO()
    plotter = contours([stage], quantity, limits=ends).draw(None, False, image, False, width=_WIDE)
    if plotter is None:
        return None
    close(plotter)
    return image.getvalue()


def _has_solids(stage: StageResult) -> bool:
    return any(form.materials for form in solids_of(stage.forms).values())


def _changes(stage: StageResult, before: list[str]) -> str:
    """Return in words what has become active and inactive, and how the stage was found."""
    now = list(stage.states)
    changes = {
        "new" if before else "active": [name for name in now if name not in before],
        "removed": [name for name in before if name not in now],
    }
    words = [f"{word}: {', '.join(names)}" for word, names in changes.items() if names]
    load = "" if stage.fraction == 1.0 else f"stopped at {stage.fraction:.1%} of its load; "
    words += [
        f"{load}{_counted(len(stage.iterations), 'increment')}, "
        f"{_counted(sum(stage.iterations), 'iteration')}, "
        f"residual {stage.residual:.0e}"
    ]
    return escape(". ".join(words) + ".")


def _counted(n: int, what: str) -> str:
    return f"{n} {what}{'s' * (n != 1)}"


def _by_stages(table: Table) -> str:
    """Return the table of stages with a column for each stage, some columns at a time."""
    rows = [name for name in table.head if name != "stage" and not name.endswith(" at")]
    text = dict(zip(table.head, zip(*table.texts(), strict=True), strict=True))

    def cell(name: str, k: int) -> str:
        where = text[f"{name} at"][k] if f"{name} at" in text else ""
        return (
            f"<td>{escape(text[name][k])}{f'<small>{escape(where)}</small>' if where else ''}</td>"
        )

    parts = []
    for chosen in np.array_split(np.arange(len(table)), -(-len(table) // _COLUMNS)):
        head = "".join(f"<th>{escape(text['stage'][k])}</th>" for k in chosen)
        body = "".join(
            f"<tr><th>{escape(in_words(name))}</th>{''.join(cell(name, k) for k in chosen)}</tr>"
            for name in rows
        )
        parts.append(
            f"<table "
            f'class="stages"><thead><tr><th></th>{head}</tr></thead><tbody>{body}</tbody></table>'
        )
    return "\n".join(parts)


def _diagrams(result: Result, sections: Mapping[str, Sections]) -> Iterator[tuple[str, Any]]:
    """Yield section forces of plane beams and of cuts: their envelope, and those of the last
    stage.
    """
    beams = [
        name
        for stage in result
        for name, state in stage.states.items()
        if (along := stage.forms[name].line_forces(state))
        and np.ndim(along[5]) == 1
        and np.any(along[5])
    ]
    for name in dict.fromkeys((*beams, *sections)):
        cuts, envelope = sections.get(name), result.envelope(name, sections.get(name))
        last = next(stage for stage in reversed(result.stages) if name in stage.states)
        forces = last.section_forces(name, cuts)
        if forces.axis is not None:  # in space
            continue
        series = {"smallest": envelope.smallest, "largest": envelope.largest, last.name: forces}
        text = (
            f"{name}: smallest and largest section forces of all stages, and those of '{last.name}'"
        )
        if cuts is not None and cuts.curvature.all():  # a ring
            yield from ((text, diagram(series, key, angle=cuts.position)) for key in "NM")
        else:
            yield text, diagram(series, upright=bool(np.ptp(forces.y) > 2.0 * np.ptp(forces.x)))


def _searches(searches: Mapping[str, Any]) -> Iterator[str]:
    """Yield the end of each search, its mechanism and its curve."""
    for stage, found in searches.items():
        lines = str(found).split("\n" + found._table())[0]
        pictures = {f"Curve of the {found.what}": load_curve(found)}
        if basis_of(found.end).mesh.dim() == 2:
            pictures = {"Mechanism": mechanism(found)} | pictures
        yield f"<h3>{escape(found.what)}, {escape(stage)}</h3><pre>{escape(lines)}</pre>{_figures(pictures.items())}"


def _remarks(result: Result) -> str:
    """Return the remarks on every stage."""
    found = {
        stage.name: "".join(f"<li>{escape(one)}</li>" for one in stage.remarks) for stage in result
    }
    return "".join(
        f"<h3>{escape(name)}</h3><ul>{items}</ul>" for name, items in found.items() if items
    )


def _run(result: Result) -> str:
    """Return increments, iterations and times of the stages."""
    return _plain(
        Table(
            ("stage", "increments", "iterations", "residual", "load", "seconds", "state"),
            tuple(
                (
                    s.name,
                    len(s.iterations),
                    sum(s.iterations),
                    f"{s.residual:.1e}",
                    f"{s.fraction:.0%}",
                    f"{s.seconds:.2f}",
                    "; ".join(f"{k}: {v}" for k, v in s.summary.items() if v),
                )
                for s in result
            ),
        )
    )


def _pairs(values: Mapping[str, str]) -> str:
    return f"<dl>{''.join(f'<dt>{escape(k)}</dt><dd>{escape(v)}</dd>' for k, v in values.items())}</dl>"


def _figures(pictures: Iterable[tuple[str, Any]]) -> str:
    """Return pictures with their captions side by side."""
    found = "".join(
        f"<figure>{_embedded(caption, picture)}<figcaption>{escape(caption)}</figcaption></figure>"
        for caption, picture in pictures
    )
    return f'<div class="figures">{found}</div>' if found else ""


def _embedded(caption: str, picture: Any) -> str:
    """Return a picture as part of the page."""
    kind = "png"
    if picture is None:
        return '<p class="none">This machine could not draw it: VTK needs OpenGL.</p>'
    if isinstance(picture, Figure):
        data = BytesIO()
        picture.savefig(data, dpi=_DPI, format="png")
        plt.close(picture)
        content = data.getvalue()
    elif isinstance(picture, bytes):
        content = picture
    elif isinstance(picture, (str, Path)):
        if Path(picture).suffix.lower() not in _KINDS or not Path(picture).is_file():
            raise ValueError(
                f"picture '{caption}': {picture} is no file with the end {', '.join(_KINDS)}"
            )
        kind, content = _KINDS[Path(picture).suffix.lower()], Path(picture).read_bytes()
    elif callable(png := getattr(picture, "_repr_png_", None)):
        content = png()
        close(picture)
    else:
        raise ValueError(
            f"picture '{caption}' is a {type(picture).__name__}: give a figure, a plotter or a file"
        )
    return f'<img alt="{escape(caption)}" src="data:image/{kind};base64,{b64encode(content).decode()}">'
