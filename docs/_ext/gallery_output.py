"""The last line that an example prints is for programs: readers of the gallery do not see it."""

from __future__ import annotations

import re

import skfem_contact.plot as plot

#: An output block that holds nothing any more.
EMPTY = re.compile(r"^ \.\. rst-class:: sphx-glr-script-out\n\n \.\. code-block:: none\n\n\s*(?=\n \S|\n\S|\Z)", re.MULTILINE)


def without_figures(app, name: str, source: list[str]) -> None:
    """Take the line out of a gallery page."""
    if name.startswith("gallery/"):
        source[0] = EMPTY.sub("", re.sub(r'^ +\{"case": .*\}$\n?', "", source[0], flags=re.MULTILINE))


def reset_units(gallery_conf, name: str) -> None:
    """Units that an example has set are its own."""
    plot.set_units()


def setup(app):
    """Register the extension."""
    app.connect("source-read", without_figures)
    return {"parallel_read_safe": True}
