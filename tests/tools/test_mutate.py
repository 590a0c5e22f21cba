"""Mutations: which tokens change, and which of them tests catch."""

from __future__ import annotations

import ast
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
    assert mutate.recorded(file, mutate.RUNS[0]) == {**outcomes, chosen[2]: None}
    assert mutate.recorded(file, mutate.RUNS[3]) == {
        chosen[0]: None,
        chosen[2]: outcomes[chosen[2]],
    }
    capsys.readouterr()
    assert mutate.tried(project, chosen, 1, file) == outcomes
    assert not capsys.readouterr().out

    # a test that is added catches what has survived
    added = "\n\ndef test_default():\n    assert total.__kwdefaults__ == {'sign': -1}\n"
    (project / "tests/room/test_sums.py").write_text(TEST + added)
    assert mutate.tried(project, chosen, 1, file) == outcomes
    default = chosen[0]
    assert "test_default" in str(mutate.tried(project, [default], 1, file, again=True)[default])


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
