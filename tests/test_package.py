"""The package as a whole: public names, their documentation, data files, imports."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from importlib import resources
from pathlib import Path

import pytest

import skfem_contact

ROOT = Path(__file__).parents[1]
NAMES = [name for name in skfem_contact.__all__ if not name.startswith("_")]


@pytest.mark.parametrize("name", NAMES)
def test_public_name_is_documented(name: str) -> None:
    """Every public class and function says what it is and shows an example."""
    thing = getattr(skfem_contact, name)
    assert inspect.getdoc(thing), f"{name} has no docstring"
    if inspect.isfunction(thing):
        assert ">>>" in thing.__doc__, f"{name} has no example"


@pytest.mark.parametrize("name", NAMES)
def test_public_function_is_typed(name: str) -> None:
    """Every argument and every result of a public function carries its type."""
    thing = getattr(skfem_contact, name)
    if inspect.isfunction(thing):
        hints = set(thing.__annotations__)
        assert hints == set(inspect.signature(thing).parameters) | {"return"}


def test_names_are_listed_once() -> None:
    """The list of public names has no duplicates."""
    assert len(set(skfem_contact.__all__)) == len(skfem_contact.__all__)


def test_data_are_part_of_the_package() -> None:
    """The demonstration's mesh is found without a path."""
    assert (resources.files("skfem_contact") / "data" / "culvert.msh").is_file()


def test_import_is_light() -> None:
    """The import needs no graphics, for a solver runs on machines without, and no library that few
    analyses use; it loads at most 450 modules besides scikit-fem.
    """
    heavy = {"pyvista", "vtk", "matplotlib.pyplot", "pandas"}
    heavy |= {"scipy.optimize", "scipy.signal", "scipy.spatial"}
    code = f"""if True:
        import sys, skfem
        before = set(sys.modules)
        import skfem_contact
        print({heavy} & set(sys.modules), len(set(sys.modules) - before))
        """
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    loaded, number = done.stdout.rsplit(maxsplit=1)
    assert loaded == "set()"
    assert int(number) <= 450


def test_version_is_the_same_everywhere() -> None:
    """The first version of the changelog and the citation are those of the package."""
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    versions = re.findall(r"^## \[([0-9.]+)\]", changes, re.MULTILINE)
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert versions[0] == skfem_contact.__version__
    assert f"\nversion: {skfem_contact.__version__}\n" in citation


def test_lines_of_the_changelog_are_short() -> None:
    """At most 15 words a change, from version 0.3 on."""
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split("## [0.2.0]")[0]
    for line in changes.splitlines():
        if line.startswith("- "):
            assert len(line[2:].split()) <= 15, line


@pytest.mark.parametrize(("former", "name"), [("Sections", "Cuts"), ("Rock", "Bedrock")])
def test_former_names_warn(former: str, name: str) -> None:
    """[X] A former name is its successor, with a warning; unknown names are no attributes."""
    with pytest.warns(DeprecationWarning, match=rf"use sc\.{name}"):
        assert getattr(skfem_contact, former) is getattr(skfem_contact, name)
    assert former not in NAMES
    with pytest.raises(AttributeError, match="no attribute 'Section'"):
        _ = skfem_contact.Section
