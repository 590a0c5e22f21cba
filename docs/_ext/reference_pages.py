"""One reference page per module, made from the package itself, so that no public name can be forgotten.

A module's page carries the first paragraph of the module's docstring and a table of its public names.
"""

from __future__ import annotations

import importlib
import importlib.util
import inspect
from pathlib import Path

import skfem_contact

#: Order and titles of the pages; names of any other module follow under that module's own name.
ROOMS = {
    "mesh": "Meshes",
    "solid": "Solid bodies",
    "materials": "Materials",
    "contact": "Contact",
    "analysis": "Analysis",
    "post": "Results",
    "plot": "Pictures",
    "assembly": "Assembly",
}


def public_names() -> dict[str, list[str]]:
    """Qualified public names of every room."""
    names: dict[str, list[str]] = {room: [] for room in ROOMS}
    for name in getattr(skfem_contact, "__all__", ()):
        thing = getattr(skfem_contact, name)
        if not inspect.ismodule(thing):
            room = thing.__module__.removeprefix("skfem_contact.").partition(".")[0]
            names.setdefault(room, []).append(f"skfem_contact.{name}")
    if importlib.util.find_spec("skfem_contact.plot"):
        plot = importlib.import_module("skfem_contact.plot")
        names["plot"] = [f"skfem_contact.plot.{name}" for name in plot.__all__]
    return {room: found for room, found in names.items() if found}


def page(room: str, names: list[str]) -> str:
    """The reStructuredText of one room."""
    title = ROOMS.get(room, room)
    module = importlib.import_module(f"skfem_contact.{room}")
    rows = "\n".join(f"   ~{name}" for name in names)
    return (
        f"{title}\n{'=' * len(title)}\n\n{inspect.getdoc(module)}\n\n"
        f".. autosummary::\n   :toctree: .\n   :nosignatures:\n\n{rows}\n"
    )


def write_pages(app, config) -> None:
    """Write the pages before Sphinx looks for its sources."""
    folder = Path(app.srcdir, "reference", "generated")
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.rst"):
        old.unlink()
    for number, (room, names) in enumerate(public_names().items()):
        (folder / f"{number}_{room}.rst").write_text(page(room, names), encoding="utf-8")


def setup(app):
    """Register the extension."""
    app.connect("config-inited", write_pages)
    return {"parallel_read_safe": True}
