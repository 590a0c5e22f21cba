"""Reference pages made from the package itself, so that no public name can be forgotten.

A page carries the docstring of its module and a table of the public names.
"""

from __future__ import annotations

import importlib
import inspect
import re
from pathlib import Path

from sphinx.errors import ConfigError

import skfem_contact
import skfem_contact.plot as plot

#: A link to the page of a name, its module and the name, and what comes before that name in the
#: place on the page.
BACK = re.compile(r"(reference/generated/)((?:\w+\.)*)(\w+)\.html#(?:\w+\.)*?\3(?=[.\"])")
#: Titles of the pages, in their order, and the modules of each; the first one's docstring opens the
#: page.
ROOMS = {
    "Models and stages": ("model", "stages"),
    "Meshes": ("mesh", "layout"),
    "Sections from a sketch": ("section",),
    "Boreholes and soundings": ("ground",),
    "Forms": ("forms", "roles"),
    "Materials": ("materials",),
    "Contact": ("contact", "surfaces"),
    "Beams and shells": ("beams", "shells", "curves"),
    "Laboratory tests": ("laboratory",),
    "Rigid obstacles": ("rigid",),
    "Loads": ("loads",),
    "Water": ("water",),
    "Inertia": ("dynamics",),
    "Results": ("results", "collapse", "limit_analysis", "units"),
    "Design": ("design",),
    "Pictures": ("plot",),
    "Equilibrium and errors": ("nonlinear", "solvers", "errors", "versions"),
    "Checks of own laws and forms": ("testing",),
}
#: Names that no module of the top level exports, but that a method returns or refers to.
FURTHER = {
    "collapse": ["skfem_contact.collapse.result.CollapseResult"],
    "limit_analysis": [
        "skfem_contact.limit_analysis.Bounds",
        "skfem_contact.limit_analysis.bounds",
    ],
    "laboratory": [
        f"skfem_contact.laboratory.{name}"
        for name in (
            "ElementTest",
            "PathStep",
            "isotropic",
            "oedometer",
            "simple_shear",
            "triaxial",
        )
    ],
}


def found(name: str) -> object:
    """Return the object of a qualified name; modules may be attributes of the package."""
    parts = name.split(".")
    this = skfem_contact
    for number, part in enumerate(parts[1:], 2):
        this = getattr(this, part, None) or importlib.import_module(".".join(parts[:number]))
    return this


def public_names() -> dict[str, list[str]]:
    """Return the qualified public names by module, subpackages as a whole."""
    names: dict[str, list[str]] = {module: list(further) for module, further in FURTHER.items()}
    for name in skfem_contact.__all__:
        if inspect.ismodule(room := getattr(skfem_contact, name)):
            own = [one for one in room.__all__ if one not in skfem_contact.__all__]
            names.setdefault(name, []).extend(f"{room.__name__}.{one}" for one in own)
            continue
        module = getattr(skfem_contact, name).__module__.split(".")[1]
        names.setdefault(module, []).append(f"skfem_contact.{name}")
    names["plot"] = [f"skfem_contact.plot.{name}" for name in plot.__all__]
    homeless = set(names).difference(*ROOMS.values())
    if homeless:
        raise ConfigError(
            f"public names of {sorted(homeless)} have no page: add the modules to ROOMS"
        )
    return names


def page(title: str, module: str, names: list[str]) -> str:
    """The reStructuredText of one page."""
    introduction = inspect.getdoc(found(f"skfem_contact.{module}"))
    rows = "\n".join(f"   ~{name}" for name in names)
    return (
        f"{title}\n{'=' * len(title)}\n\n{introduction}\n\n"
        f".. autosummary::\n   :toctree: .\n   :nosignatures:\n\n{rows}\n"
    )


def topic(title: str, file: str, names: list[str]) -> str:
    """A section of the index: the names of a page with their summaries."""
    rows = []
    for name in names:
        summary = str(inspect.getdoc(found(name))).split("\n\n")[0].replace("\n", " ")
        summary = (
            re.sub(r":\w+:`~?([^`]*)`", r"\1", summary).replace("``", "`").replace("|", "&#124;")
        )
        rows.append(f"| {{py:obj}}`{name.rpartition('.')[2]} <{name}>` | {summary} |")
    return "\n".join(
        [f"## {{doc}}`{title} </reference/generated/{file}>`", "", "| | |", "|:--|:--|", *rows, ""]
    )


def write_pages(app, config) -> None:
    """Write the pages before Sphinx looks for its sources."""
    folder = Path(app.srcdir, "reference", "generated")
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.rst"):
        old.unlink()
    names = public_names()
    topics = []
    for number, (title, modules) in enumerate(ROOMS.items()):
        here = [name for module in modules for name in names.get(module, [])]
        if here:
            (folder / f"{number:02}_{modules[0]}.rst").write_text(
                page(title, modules[0], here), encoding="utf-8"
            )
            topics.append(topic(title, f"{number:02}_{modules[0]}", here))
    index = Path(app.srcdir, "_build", "generated", "topics.md")
    index.parent.mkdir(parents=True, exist_ok=True)
    index.write_text("\n".join(topics), encoding="utf-8")


def to_anchors(body: str) -> str:
    """Links from the source of a module back to its reference, each to the module that its page is
    named by.

    Sphinx takes one module for all names of a source, though some are public elsewhere.
    """
    return BACK.sub(r"\1\2\3.html#\2\3", body)


def mend_links(app, pagename: str, templatename: str, context: dict, doctree) -> None:
    """Mend the links of a page that shows a source."""
    if pagename.startswith("_modules/"):
        context["body"] = to_anchors(context["body"])


def setup(app):
    """Register the extension."""
    app.connect("config-inited", write_pages)
    app.connect("html-page-context", mend_links)
    return {"parallel_read_safe": True}
