"""Mutations: which tokens change, and which of them tests catch."""

from __future__ import annotations

import ast
import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from tests import mutate
from tests.tools import forked, reached

MODULE = '''"""Sums, e.g. of 1 + 2."""

from __future__ import annotations


def total(values: list[float | None], *more: float, sign=-1) -> int | None:
    """Return 3 * x."""
    if values[0] < 1e-8 and not more:
        raise ValueError("1 < 2" if 1 < 2 else "")
    return max(*more, 2.0 * values[-1]) + 0.5
'''
TEST = """
import pytest
from skfem_contact.room.sums import total


def test_total():
    assert total([1.0, 3.0], 2.0) == 6.5


@pytest.mark.slow
def test_refused():
    with pytest.raises(ValueError):
        total([0.0])
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A package of one file, and its tests."""
    for folder in ("skfem_contact", "skfem_contact/room", "tests", "tests/room", "tests/tools"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "__init__.py").touch()
    (tmp_path / "pyproject.toml").write_text(
        '[tool.pytest.ini_options]\nmarkers = ["slow: long"]\n'
    )
    (tmp_path / "skfem_contact/room/sums.py").write_text(MODULE)
    (tmp_path / "tests/room/test_sums.py").write_text(TEST)
    (tmp_path / "tests/__init__.py").touch()
    for tool in (forked, reached):
        shutil.copy(str(tool.__file__), tmp_path / "tests/tools")
    # the server imports libraries that this package does not use: empty ones
    for name in forked.IMPORTED_ONCE:
        folder = tmp_path
        for part in name.split("."):
            folder = folder / part
            folder.mkdir(exist_ok=True)
            (folder / "__init__.py").touch()
    return tmp_path


def test_tokens_that_change(project: Path) -> None:
    """Signs, comparisons, factors, indices and tolerances; no annotations, texts or errors."""
    found = [(m.old, m.new) for m in mutate.mutations(project, "room/sums.py")]
    assert found == [
        *(("-", "+"), ("1", "2")),
        *(("0", "1"), ("<", ">="), ("1e-8", "1e-06"), ("and", "or"), ("not", "")),
        *(("max", "min"), ("2.0", "2.2"), ("*", "/"), ("-", "+"), ("1", "2"), ("+", "-")),
        ("0.5", "0.55"),
    ]


def test_samples_repeat(project: Path) -> None:
    first = mutate.drawn(project, ("room",), 5, seed=1)
    assert first == mutate.drawn(project, ("room",), 5, seed=1)
    assert len(first) == len(set(first)) == 5
    assert mutate.drawn(project, ("other",), 5, seed=1) == []


TWO = """
def total(values):
    found = 0
    for value in values:
        found += 2 * value
        found += 2 * value
    return found - 1


def mean(values):
    return total(values) / max(len(values), 1)
"""


@pytest.mark.parametrize(
    ("old", "new", "changed"),
    [
        ("    return total", "    # Divide\n    count = len(values)\n\n    return total", 0),
        ("total(values) / max(len(values), 1)", "total(\n    values\n) / max(len(values), 1)", 0),
        ("def mean(", "def middle(more=1):\n    return -more\n\n\ndef mean(", 0),
        ("values), 1)", "values), 2)", 3),
        ("found - 1", "found - 2", 2),
        ("found = 0", "", 1),
        ("def total", "def sum_of", 9),
    ],
)
@pytest.mark.one_in(2)
def test_samples_stay_when_other_statements_change(
    project: Path, old: str, new: str, changed: int
) -> None:
    """Ranks follow from the statement and its function: layout, comments and other statements do
    not matter.
    """
    file = project / "skfem_contact/room/sums.py"

    def ranks() -> list[bytes]:
        return [m.place.rank(4) for m in mutate.drawn(project, ("room",), 99, seed=4)]

    file.write_text(TWO)
    before = ranks()
    assert len(set(before)) == len(before) == 12
    file.write_text(TWO.replace(old, new))
    assert len({*before} - {*ranks()}) == changed
    # Those that stay keep their order
    kept = [rank for rank in ranks() if rank in before]
    assert kept == [rank for rank in before if rank in kept]


def test_mutations_without_effect_do_not_count(project: Path, monkeypatch, capsys) -> None:
    """They are told with their reasons and are not tried; one that the package no longer has is
    told, too.
    """
    monkeypatch.setattr(mutate, "ROOMS", ("room",))
    monkeypatch.setattr(mutate, "tried", lambda root, chosen, *more: dict.fromkeys(chosen))
    places = [m.place for m in mutate.drawn(project, ("room",), 99, seed=1)]
    rows = [[*places[2], "Sizes count alone."], [*places[3]._replace(name="sum"), "Gone."]]
    (project / mutate.WITHOUT_EFFECT).write_text("\n".join(map(json.dumps, rows)))
    assert mutate.main([], project) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("No effect: room/sums.py:")
    assert lines[0].endswith(": Sizes count alone.")
    assert "no longer has" in lines[1]
    assert lines[-1] == f"{len(places) - 1} of {len(places) - 1} mutations survive"
    # The line of a survivor is one of the list
    row = json.loads(lines[5])
    assert mutate.Place(*row[:4]) in places


def test_listed_mutations_are_in_the_package() -> None:
    """The list of mutations without effect follows the package, and gives reasons."""
    known = mutate.without_effect(mutate.ROOT)
    assert not mutate.stale(mutate.ROOT, known)
    assert all(reason.endswith(".") for reason in known.values())


def test_parts_of_a_sample(project: Path, monkeypatch, capsys) -> None:
    """Parts are counted from one, with both ends, and join to the sample."""
    monkeypatch.setattr(mutate, "ROOMS", ("room",))
    monkeypatch.setattr(mutate, "tried", lambda root, chosen, *more: dict.fromkeys(chosen, "test"))
    size = len(mutate.drawn(project, ("room",), 99, seed=2))
    sizes = []
    for part in (["--last", "4"], ["--first", "5"], []):
        assert mutate.main(["--seed", "2", *part], project) == 0
        sizes.append(int(capsys.readouterr().out.splitlines()[-1].split()[2]))
    assert sizes == [4, size - 4, size]


@pytest.mark.slow
def test_survivors_and_resumed_runs(project: Path, capsys) -> None:
    """A default that no test uses survives until there is a test; a changed factor is caught, and
    not tried twice.
    """
    by_token = {(m.line, m.old): m for m in mutate.mutations(project, "room/sums.py")}
    chosen = [by_token[6, "-"], by_token[10, "2.0"], by_token[8, "<"]]
    file = project / "outcomes"
    outcomes = mutate.tried(project, chosen, 1, file)
    assert [outcomes[m] and outcomes[m].split("::")[-1] for m in chosen] == [
        None,
        "test_total",
        "test_refused",
    ]
    default, _, refused = (m.place for m in chosen)
    found = {m.place: test for m, test in outcomes.items()}
    assert mutate.recorded(file, mutate.RUNS[0]) == {**found, refused: None}
    assert mutate.recorded(file, mutate.RUNS[3]) == {default: None, refused: found[refused]}
    capsys.readouterr()
    assert mutate.tried(project, chosen, 1, file) == outcomes
    assert not capsys.readouterr().out

    # a test that is added catches what has survived
    added = "\n\ndef test_default():\n    assert total.__kwdefaults__ == {'sign': -1}\n"
    (project / "tests/room/test_sums.py").write_text(TEST + added)
    assert mutate.tried(project, chosen, 1, file) == outcomes
    again = mutate.tried(project, chosen[:1], 1, file, again=True)
    assert "test_default" in str(again[chosen[0]])

    # what tests reach follows the lines of the package
    package = project / "skfem_contact/room/sums.py"
    package.write_text(MODULE.replace("\n\ndef total", "SIZE = 3\n\n\ndef total"))
    file.unlink()
    moved = {m.place: m for m in mutate.mutations(project, "room/sums.py")}[refused]
    assert moved.line == chosen[2].line + 1
    assert "test_refused" in str(mutate.tried(project, [moved], 1, file)[moved])


SEGMENTS = '''
import math


def root(x):
    """Text."""
    if x < 0:
        raise ValueError
    else:
        y = math.sqrt(
            x
        )
    return y
'''


def test_segments() -> None:
    """A line belongs to the innermost run of statements; a condition to the one around it."""
    lines = {line: reached.segment_of(SEGMENTS, line) for line in (2, 7, 8, 11, 13)}
    assert lines == {2: None, 7: 7, 8: 8, 11: 10, 13: 13}


def test_names_of_failing_tests() -> None:
    """Names may have spaces; the message after the name is left out."""
    output = "ok\nFAILED tests/a.py::test_b[two words] - assert 1\nERROR tests/c.py\n"
    assert mutate.FAILED.findall(output) == ["tests/a.py::test_b[two words]", "tests/c.py"]


def test_probes() -> None:
    """Probes report the segments that are entered, and docstrings stay."""
    space: dict[str, Any] = {}
    exec(reached.probed(SEGMENTS, "roots.py"), space)
    reached.HITS.clear()
    assert space["root"](4.0) == 2.0
    assert {"roots.py:7", "roots.py:10", "roots.py:13"} == reached.HITS
    assert space["root"].__doc__ == "Text."


def test_parts_without_effect() -> None:
    """Warnings with their conditions, checks of lengths, and which negative length is left free."""
    source = """
warnings.warn("far" if x > 1 else "near", stacklevel=2)
pairs = zip(a, b, strict=True)
rows = x.reshape(-1, 3)
last = x[-1]
"""
    parts = {ast.unparse(node) for node in mutate.left_out(ast.parse(source))}
    assert parts == {ast.unparse(ast.parse(source).body[0]), "2", "True", "1"}


CHANGED = """
def factor(k=2.0):
    return [k * n for n in (1, 2)]

class Some:
    size = 3
    root = property(lambda self: self.size + 1)

START = factor()
"""


@pytest.mark.parametrize(
    ("old", "new", "value"),
    [
        ("k * n", "k / n", ([2.0, 1.0], 4)),
        ("size + 1", "size - 1", ([2.0, 4.0], 2)),
        ("k=2.0", "k=2.2", None),
        ("size = 3", "size = 4", None),
        ("", "", ([2.0, 4.0], 4)),
    ],
)
def test_code_of_functions_is_replaced(old: str, new: str, value: object) -> None:
    """The code of functions, also of properties, changes in place; a default and the body of a
    class are run on import, and so is a function that gives a constant of the module.
    """
    space: dict[str, Any] = {}
    before = compile(CHANGED, "changed.py", "exec")
    exec(before, space)
    after = compile(CHANGED.replace(old, new), "changed.py", "exec")
    assert forked.replaced(before, after, set()) is (value is not None)
    if value is not None:
        assert (space["factor"](), space["Some"]().root) == value
    if old == "k * n":
        assert not forked.replaced(before, after, {next(forked.changes(before, after))[0]})
