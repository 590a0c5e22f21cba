"""Public names and optional parameters that no example, page or doctest shows.

Run ``python -m tests.tools.unshown``. Names are the ones of the reference: of ``__all__`` of the
package and of its public rooms, with the methods and properties that their classes document,
without deprecated ones. An option is shown if it is passed in a call by the name of its function or
class, in an example, a doctest or the code of a page, or if a paragraph of a page names both.
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import skfem_contact as sc
from skfem_contact import limit_analysis, plot
from skfem_contact.collapse.result import CollapseResult

ROOT = Path(__file__).parents[2]
#: Classes that the package makes, whose fields are results and no options.
MADE = (
    "sc.NoEquilibrium",
    "sc.NotConverged",
    "sc.collapse.CollapseResult",
    "sc.design.Bearing",
    "sc.ground.Site",
    "sc.laboratory.ElementTest",
    "sc.laboratory.Fit",
    "sc.limit_analysis.Bounds",
    "sc.results.ContactReport",
    "sc.results.Envelope",
    "sc.results.PointValues",
    "sc.results.SectionForces",
    "sc.results.StageResult",
    "sc.results.Table",
    "sc.section.Drawing",
    "sc.water.PoreState",
)
#: Parameters that stand for further ones of another function.
_OPEN = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)


class Shown(NamedTuple):
    """What examples, doctests and pages show."""

    names: set[str]
    keywords: set[tuple[str, str]]  # name of the function, name of the parameter
    positions: dict[str, int]  # most positional arguments by the name of the function
    paragraphs: list[set[str]]  # words of the code within the paragraphs of pages


def public() -> dict[str, Any]:
    """Return the public functions, classes, methods and properties by their full names."""
    found: dict[str, Any] = {}
    rooms = {"sc": sc, "sc.plot": plot}
    for name in sc.__all__:
        thing = getattr(sc, name)
        if isinstance(thing, ModuleType):
            rooms[f"sc.{name}"] = thing
    for prefix, room in rooms.items():
        for name in room.__all__:
            _add(found, f"{prefix}.{name}", getattr(room, name))
    _add(found, "sc.collapse.CollapseResult", CollapseResult)
    _add(found, "sc.limit_analysis.Bounds", limit_analysis.Bounds)
    _add(found, "sc.limit_analysis.bounds", limit_analysis.bounds)
    return found


def _add(found: dict[str, Any], name: str, thing: Any) -> None:
    """Add a function, or a class with its public members, once."""
    if isinstance(thing, ModuleType) or any(thing is known for known in found.values()):
        return
    if "deprecated" in (thing.__doc__ or "").split("\n\n")[0].lower():  # kept for a release
        return
    found[name] = thing
    if not inspect.isclass(thing):
        return
    for member, value in vars(thing).items():
        plain = value.__func__ if isinstance(value, (classmethod, staticmethod)) else value
        own = inspect.isfunction(plain) or isinstance(plain, property)
        if own and not member.startswith("_") and plain.__doc__:
            found[f"{name}.{member}"] = value


def options(things: dict[str, Any]) -> Iterator[tuple[str, str, int]]:
    """Yield full name, optional parameter and position, -1 for keywords alone."""
    for name, thing in things.items():
        plain = thing.__func__ if isinstance(thing, (classmethod, staticmethod)) else thing
        if isinstance(plain, property) or not callable(plain) or name in MADE:
            continue
        try:
            parameters = list(inspect.signature(plain).parameters.values())
        except ValueError:  # built-in
            continue
        # The first parameter of a method is its object, also where it has another name
        owner = things.get(name.rpartition(".")[0])
        if inspect.isclass(owner) and not isinstance(thing, staticmethod):
            parameters = parameters[1:]
        for position, parameter in enumerate(parameters):
            if parameter.kind in _OPEN or parameter.default is parameter.empty:
                continue
            if parameter.name.startswith("_"):
                continue
            keyword = parameter.kind is parameter.KEYWORD_ONLY
            yield name, parameter.name, -1 if keyword else position


def shown() -> Shown:
    """Read the examples, the doctests of the package, and the pages."""
    found = Shown(set(), set(), {}, [])
    for path in sorted((ROOT / "examples").rglob("*.py")):
        _read_code(found, path.read_text(encoding="utf-8"))
    for path in sorted((ROOT / "skfem_contact").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
                _read_code(found, _doctest(ast.get_docstring(node) or ""))
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        text = path.read_text(encoding="utf-8")
        for block in re.findall(r"```\w*\n(.*?)```", text, re.S):
            _read_code(found, block)
        prose = re.sub(r"```\w*\n.*?```", "", text, flags=re.S)
        for paragraph in re.split(r"\n\s*\n|\n(?=[|*-] )", prose):
            code = " ".join(re.findall(r"`([^`]+)`", paragraph))
            found.paragraphs.append(set(re.findall(r"[A-Za-z_]\w*", code)))
    return found


def _doctest(text: str) -> str:
    """Return the code of a docstring's examples."""
    lines = re.findall(r"^\s*(?:>>>|\.\.\.) ?(.*)$", text, re.M)
    return "\n".join(lines)


def _read_code(found: Shown, code: str) -> None:
    """Add the names and calls of some code; what is no Python counts by its names."""
    found.names.update(re.findall(r"[A-Za-z_]\w*", code))
    try:
        tree = ast.parse(textwrap.dedent(code))
    except SyntaxError:
        return
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        called = node.func
        name = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
        for keyword in node.keywords:
            if keyword.arg:
                found.keywords.add((name, keyword.arg))
        found.positions[name] = max(found.positions.get(name, 0), len(node.args))


def unshown() -> tuple[list[str], list[str]]:
    """Return the names, and the options as "name(option)", that nothing shows."""
    things = public()
    seen = shown()
    words = seen.names.union(*seen.paragraphs)
    names = [name for name in things if name.rpartition(".")[2] not in words]
    missing = []
    for name, option, position in options(things):
        last = name.rpartition(".")[2]
        passed = (last, option) in seen.keywords or 0 <= position < seen.positions.get(last, 0)
        if not passed and not any(last in part and option in part for part in seen.paragraphs):
            missing.append(f"{name}({option})")
    return names, missing


def main() -> None:
    """Print the lists and their lengths."""
    things = public()
    names, missing = unshown()
    print(*names, *missing, sep="\n")
    n_options = len(list(options(things)))
    print(f"{len(names)} of {len(things)} names, {len(missing)} of {n_options} options")


if __name__ == "__main__":
    main()
