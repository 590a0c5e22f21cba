"""Sphinx configuration: MyST pages, numpydoc reference, executed gallery."""

import os
import sys
from pathlib import Path

import pyvista
from sphinx_gallery.sorting import ExplicitOrder

import skfem_contact

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "skfem_contact"
author = "skfem_contact developers"
copyright = author
release = version = skfem_contact.__version__

extensions = [
    "benchmark_tables",
    "gallery_output",
    "myst_parser",
    "numpydoc",
    "public_names",
    "reference_pages",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "sphinx-mathjax-offline",
]
exclude_patterns = ["_build", "gallery/**/*.ipynb", "gallery/**/*.py", "gallery/**/*.zip"]
templates_path = ["_templates"]

html_theme = "pydata_sphinx_theme"
html_title = f"skfem_contact {version}"
html_favicon = "_static/favicon.svg"
html_context = {"default_mode": "auto"}
html_static_path = ["_static"]
html_css_files = ["custom.css"]
html_show_sourcelink = True
html_theme_options = {
    "navbar_align": "left",
    "header_links_before_dropdown": 8,
    "logo": {"text": f"skfem_contact {version}"},
    "navbar_persistent": ["search-button"],  # its field would need a second row
    "navbar_end": ["theme-switcher"],
    "show_prev_next": True,
    "secondary_sidebar_items": ["page-toc", "sourcelink"],
    "footer_start": ["copyright"],
    "footer_end": ["sphinx-version"],
}
html_sidebars = {
    "installation": [],
    "find_example": [],
    "changelog": [],
    "contributing": [],
    "benchmarks": [],
}

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

autosummary_generate = True
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
python_maximum_signature_line_length = 88
numpydoc_show_class_members = False  # the class template lists them

pyvista.OFF_SCREEN = pyvista.BUILDING_GALLERY = True
os.environ |= {
    "PYVISTA_OFF_SCREEN": "true",
    "PYVISTA_BUILDING_GALLERY": "true",
}  # for the processes of the gallery

#: Chapters of the gallery by their numbers.
CHAPTERS = sorted(
    (
        f"../examples/{folder.name}"
        for folder in (Path(__file__).parents[1] / "examples").glob("[0-9]*_*")
    ),
    key=lambda path: (int(path.split("/")[-1].split("_")[0]), path),
)

sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"/plot_",
    "ignore_pattern": r"(^|/)(?!plot_)[^/]*\.py$",
    "subsection_order": ExplicitOrder([*CHAPTERS, "../examples/benchmarks"]),
    "within_subsection_order": "NumberOfCodeLinesSortKey",
    "image_scrapers": ("pyvista", "matplotlib", "example_reports.write"),
    "capture_repr": ("__repr__",),
    "ignore_repr_types": r"matplotlib|pyvista|skfem_contact\.plot",
    "remove_config_comments": True,
    "backreferences_dir": "gallery/backreferences",
    "doc_module": ("skfem_contact",),
    "reference_url": {"skfem_contact": None},
    "inspect_global_variables": False,
    "reset_modules": ("matplotlib", "gallery_output.reset_units"),
    "show_signature": False,
    "download_all_examples": False,
    "write_computation_times": False,
    "parallel": 2,
    "plot_gallery": True,
}


def skip_tuple_fields(app, what, name, obj, skip, options):
    """Leave out the fields of a named tuple: its docstring has told what they are."""
    return skip or (type(obj).__name__ == "_tuplegetter")


def setup(app):
    """Connect our handlers; formulas without a network only name a file, so pages are read by
    several processes."""
    app.connect("autodoc-skip-member", skip_tuple_fields)
    app.extensions["sphinx-mathjax-offline"].parallel_read_safe = True
