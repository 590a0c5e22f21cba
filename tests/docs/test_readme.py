"""The Python code of the README and the user guide runs as it is printed."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import matplotlib
import pytest

ROOT = Path(__file__).parents[2]
PAGES = [
    ROOT / "README.md",
    ROOT / "docs" / "index.md",
    *sorted((ROOT / "docs" / "guide").glob("*.md")),
]
CODE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.fixture(autouse=True)
def bounds_beside() -> None:
    """Keep the bounds that searches compute unasked."""


def python_code(page: Path) -> str:
    """The Python blocks of a page in one script."""
    return "\n".join(CODE.findall(page.read_text(encoding="utf-8")))


#: Pages whose code takes more than 1.5 s.
SLOW = ("collapse", "many_runs", "options", "results", "soil_tests", "water")
CASES = [
    pytest.param(page, id=page.stem, marks=[pytest.mark.slow] if page.stem in SLOW else [])
    for page in PAGES
    if python_code(page)
]


@pytest.mark.parametrize("page", CASES)
def test_code_of_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of a page build on each other; they may write files into the folder they run in."""
    if "sc.section" in python_code(page):
        pytest.importorskip(
            "gmsh", reason="gmsh or a system library is missing", exc_type=(ImportError, OSError)
        )
    matplotlib.use("Agg")
    monkeypatch.setenv("PYVISTA_OFF_SCREEN", "true")
    monkeypatch.chdir(tmp_path)
    script = tmp_path / f"{page.stem}.py"
    script.write_text(python_code(page), encoding="utf-8")
    runpy.run_path(str(script), run_name="__main__")


def test_first_plot_is_short() -> None:
    """Both blocks of the README reach a picture in at most 15 lines."""
    for block in CODE.findall((ROOT / "README.md").read_text(encoding="utf-8")):
        lines = [line for line in block.splitlines() if line.strip()]
        assert ".contour(" in lines[-1] and len(lines) <= 15


def test_links_of_the_package_index_are_absolute() -> None:
    """[X] All links of the README that is uploaded have a scheme, pictures the address of files."""
    module = runpy.run_path(str(ROOT / "docs" / "readme_of_index.py"))
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = module["with_absolute_links"](text, "me/soil", "v1")
    links = re.findall(r"(!?)\[[^\]]*\]\(([^)]+)\)", found)
    assert len(links) == len(re.findall(r"\]\(([^)]+)\)", text)) > 5
    for picture, target in links:
        assert target.startswith("https://raw.githubusercontent" if picture else "https://")
    assert "](https://github.com/me/soil/blob/v1/CONTRIBUTING.md)" in found
    assert (
        found.replace("https://github.com/me/soil/blob/v1/", "").replace(
            "https://raw.githubusercontent.com/me/soil/v1/", ""
        )
        == text
    )


def test_links_of_readme_lead_somewhere() -> None:
    """Links and pictures with a path are files of the repository."""
    links = re.findall(r"\]\(([^)]+)\)", (ROOT / "README.md").read_text(encoding="utf-8"))
    missing = [link for link in links if "://" not in link and not (ROOT / link).exists()]
    assert not missing
