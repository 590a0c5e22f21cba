"""The tools of the documentation: what pages leave out, what links, and what a browser stumbles
over.
"""

from __future__ import annotations

import ast
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
gallery_output = pytest.importorskip("gallery_output")

EXAMPLES = sorted((DOCS.parent / "examples").glob("*/plot_*.py"))
#: What Sphinx-Gallery leaves out.
IGNORED = re.compile(r"(?ms)^# sphinx_gallery_start_ignore.*?^# sphinx_gallery_end_ignore\n")

PAGE = """
Figures
-------

.. GENERATED FROM PYTHON SOURCE LINES 9-12

.. code-block:: Python


    import json
    from time import process_time
    begin = process_time()
    factor = 1.381
    # within the bracket
    assert 1.3 < factor < 1.4
    print(f"factor {factor}")
    print(json.dumps({"case": "slope"}))

.. rst-class:: sphx-glr-script-out

 .. code-block:: none

    factor 1.381
    {"case": "slope"}

"""


def test_readers_see_neither_checks_nor_figures():
    source = [PAGE]
    gallery_output.for_readers(None, "gallery/slope", source)
    assert '    factor = 1.381\n    print(f"factor {factor}")\n' in source[0]
    assert "    factor 1.381\n" in source[0]
    for hidden in ("assert", "json", "process_time", "case", "bracket"):
        assert hidden not in source[0]
    untouched = [PAGE]
    gallery_output.for_readers(None, "guide/stages", untouched)
    assert untouched == [PAGE]


def on_page(script: Path) -> ast.Module:
    """Return the code of an example that its page shows."""
    code = IGNORED.sub("", script.read_text(encoding="utf-8"))
    return ast.parse(gallery_output.without_checks(code, gallery_output.needed(code)))


def test_code_on_pages_imports_what_it_needs():
    """The clock and JSON are imported where something that is left uses them."""
    for script in EXAMPLES:
        page = on_page(script)
        used = {node.id for node in ast.walk(page) if isinstance(node, ast.Name)} & {
            "process_time",
            "json",
        }
        imported = {
            name.name
            for node in ast.walk(page)
            if isinstance(node, ast.Import | ast.ImportFrom)
            for name in node.names
        }
        assert used <= imported, script.stem


def test_every_example_is_found_by_its_task():
    """The page names each example once, with its chapter."""
    page = (DOCS / "find_example.md").read_text(encoding="utf-8")
    for script in EXAMPLES:
        assert page.count(f"</gallery/{script.parent.name}/{script.stem}>") == 1, script.stem


def test_links_to_examples_lead_somewhere():
    """Chapters and names of examples on pages and in examples exist."""
    known = {f"{script.parent.name}/{script.stem}" for script in EXAMPLES}
    for page in (*DOCS.rglob("*.md"), *EXAMPLES):
        if "_build" not in page.parts:
            text = page.read_text(encoding="utf-8")
            for chapter, name in re.findall(r"gallery/(\w+)/(?:images/sphx_glr_)?(plot_\w+)", text):
                assert f"{chapter}/{re.sub(r'_[0-9]{3}$', '', name)}" in known, (page, name)


def test_warnings_lose_the_path_of_the_machine():
    """What was warned stays, where in the builder's folders does not."""
    source = [
        " .. code-block:: none\n\n    /home/a/plot_b.py:65: AnalysisWarning: the joint is soft\n"
        "      result = sc.run(forms)\n    the table\n"
    ]
    gallery_output.for_readers(None, "gallery/b", source)
    assert source[0].endswith("none\n\n    AnalysisWarning: the joint is soft\n    the table\n")


def test_code_fits_the_page():
    options = ", ".join(f"option_{i}={i}" for i in range(8))
    long = f"found = strength_reduction(forms, fixed, load, {options})"
    assert max(map(len, gallery_output.narrow(long).split("\n"))) <= gallery_output.WIDTH
    assert gallery_output.narrow("x = 1") == "x = 1"


def test_names_of_the_reference_become_links():
    pytest.importorskip("sphinx")
    from public_names import target

    assert target("sc.Model(forms)") == target("skfem_contact.Model") == "skfem_contact.Model"
    assert target("ContactPair") == "skfem_contact.ContactPair"
    assert target("plot.contour(forms, stage)") == "skfem_contact.plot.contour"
    for other in ("run", "stages", "u^1", "numpy", "plot.show", "fixed="):
        assert target(other) is None


def test_sources_link_to_anchors_that_are_there():
    """A link takes the module from the name of its page; one that is right stays."""
    pytest.importorskip("sphinx")
    from reference_pages import to_anchors

    folder = "../reference/generated/skfem_contact.results"
    right = f'<a href="{folder}.Result.html#skfem_contact.results.Result.save">'
    assert (
        to_anchors(f'<a href="{folder}.Result.html#skfem_contact.Result.save">')
        == right
        == to_anchors(right)
    )
    assert (
        to_anchors(f'"{folder}.of.html#skfem_contact.of"')
        == f'"{folder}.of.html#skfem_contact.results.of"'
    )


SITE = {
    "index.html": "<main><p id='top'>Text</p><a href='good.html#here'>good</a> <a "
    "href='none.html'>broken</a>"
    " <a href='good.html#nowhere'>no place</a></main>",
    "good.html": "<main><h1 id='here'>Good</h1><p>A line that wraps.</p></main>",
    "cut.html": "<main><p style='width:90px;overflow:hidden;white-space:nowrap'>A line that goes "
    "on.</p></main>",
    "wide.html": "<main><div style='width:2000px'>wide</div></main>",
    "rows.html": "<header><a class='nav-link'>one</a><br><br><a class='nav-link'>two</a></header>",
    "bad.html": "<main><img src='none.png' "
    "alt='none'><script>console.error('trouble')</script></main>",
}


@pytest.mark.skipif(
    shutil.which("chromium") is None or shutil.which("chromedriver") is None,
    reason="needs Chromium",
)
def test_what_a_browser_stumbles_over(tmp_path):
    """A site of six pages with one fault of each kind; the good page is not named."""
    pytest.importorskip("selenium")
    for name, body in SITE.items():
        head = "<!doctype html><html><head><title>t</title><link rel='icon' href='data:,'></head>"
        (tmp_path / name).write_text(f"{head}<body>{body}</body></html>", encoding="utf-8")
    command = [
        sys.executable,
        str(DOCS / "check_pages.py"),
        str(tmp_path),
        "--out",
        str(tmp_path / "shots"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert done.returncode == 1, done.stderr
    *lines, last = done.stdout.splitlines()
    assert json.loads(last)["pages"] == 6
    for fault in (
        "index.html: broken link none.html",
        "index.html: no place #nowhere on good.html",
        "cut.html (wide, light): cut off",
        "rows.html (wide, light): navigation in rows",
        "wide.html (wide, light): stands out",
        "wide.html (narrow, dark): stands out",
        "bad.html (wide, light): missing picture",
        "bad.html (wide, light): console",
    ):
        assert any(line.startswith(fault) for line in lines), (fault, lines)
    assert not any(line.startswith("good.html") for line in lines)
    assert len(list((tmp_path / "shots").rglob("*.png"))) == 24
