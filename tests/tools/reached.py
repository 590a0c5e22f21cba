"""Which tests reach which statements of the package: a pytest plugin for a copy with probes.

    python -m pytest -p tests.tools.reached --reached=FOLDER tests/contact

A segment is a run of statements of a function that is entered at its first one: up to the next
compound statement, and again after it.  A copy of the package with a probe at the start of each
segment runs as fast as the package.  One JSON file per test file has the process time of its tests
and, for each segment, the tests that reach it.
"""

from __future__ import annotations

import ast
import builtins
import json
import re
import time
import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest

FUNCTION = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
COMPOUND = (ast.If, ast.For, ast.While, ast.With, ast.Try, ast.Match)
#: What tests of a file share.
SHARED = re.compile(r"cache|scope=")
#: Segments that have been entered since the last test: file and first line.
HITS: set[str] = set()
#: A builtin name, for the package makes functions with the globals of other modules.
builtins._hit = HITS.add  # type: ignore[attr-defined]


# -- segments and probes


def blocks(node: ast.AST, inside: bool = False) -> Iterator[list[ast.stmt]]:
    """Yield the lists of statements inside of functions, outer ones first."""
    for field in ("body", "orelse", "finalbody"):
        statements = getattr(node, field, None)
        if inside and isinstance(statements, list) and not isinstance(node, ast.ClassDef):
            yield statements
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (ast.stmt, ast.excepthandler, ast.match_case)):
            yield from blocks(child, inside or isinstance(child, FUNCTION))


def starts(statements: list[ast.stmt]) -> list[int]:
    """Return the indices of the statements that begin a segment; a docstring does not."""
    if not statements:
        return []
    first = statements[0]
    is_text = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
    begins = [1] if is_text and len(statements) > 1 else [0]
    after = [k + 1 for k, one in enumerate(statements[:-1]) if isinstance(one, COMPOUND)]
    return begins + after


def segments(tree: ast.Module) -> list[tuple[int, int]]:
    """Return the first and the last line of each segment, inner ones last."""
    found = []
    for statements in blocks(tree):
        begins = starts(statements)
        for k, end in zip(begins, [*begins[1:], len(statements)]):
            found.append((statements[k].lineno, statements[end - 1].end_lineno or 0))
    return found


def segment_of(source: str, line: int) -> int | None:
    """Return the first line of the innermost segment of a line; None: it runs on import."""
    around = [(a, b) for a, b in segments(ast.parse(source)) if a <= line <= b]
    return min(around, key=lambda span: (span[1] - span[0], -span[0]))[0] if around else None


def probed(source: str, file: str) -> str:
    """Return the source of a module with a probe at the start of each segment."""
    tree = ast.parse(source)
    for statements in list(blocks(tree)):
        for k in reversed(starts(statements)):
            call = f"_hit({f'{file}:{statements[k].lineno}'!r})"
            statements[k:k] = ast.parse(call).body
    imports = ast.parse("import tests.tools.reached").body
    last = [k for k, one in enumerate(tree.body) if getattr(one, "module", "") == "__future__"]
    place = last[-1] + 1 if last else 0
    tree.body[place:place] = imports
    return ast.unparse(ast.fix_missing_locations(tree))


def add_probes(root: Path) -> None:
    """Put probes into the package of a copy of the project."""
    package = root / "skfem_contact"
    for path in package.rglob("*.py"):
        source = path.read_text(encoding="utf-8")
        file = path.relative_to(package).as_posix()
        path.write_text(probed(source, file), encoding="utf-8")


# -- the plugin


def file_of_record(folder: Path, root: Path, test_file: str, marked: str) -> Path:
    """Return the file that tells what a test file, as it is now, reaches."""
    version = zlib.crc32((root / test_file).read_bytes())
    name = f"{test_file}+{marked}+{version:08x}.json"
    return folder / name.replace("/", "+").replace(" ", "+")


class Recorder:
    """Process times and segments of tests, which are written at the end of a test file."""

    def __init__(self, folder: Path, root: Path, marked: str) -> None:
        self.folder, self.root, self.marked = folder, root, marked
        self.times: dict[str, float] = {}
        self.reached: dict[str, list[int]] = {}
        self.failed: set[str] = set()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item, nextitem: pytest.Item | None) -> object:
        """Record a test."""
        HITS.clear()
        began = time.process_time()
        outcome = yield
        for segment in HITS:
            self.reached.setdefault(segment, []).append(len(self.times))
        self.times[item.nodeid] = time.process_time() - began
        test_file = item.nodeid.split("::")[0]
        if nextitem is None or nextitem.nodeid.split("::")[0] != test_file:
            self.write(test_file)
        return outcome

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note which tests fail without a mutation: these prove nothing."""
        if report.failed:
            self.failed.add(report.nodeid)

    def write(self, test_file: str) -> None:
        """Write what the tests of a file have reached."""
        # Tests share what is cached, and count as reaching what any of them reaches
        if SHARED.search((self.root / test_file).read_text(encoding="utf-8")):
            self.reached = {key: [*range(len(self.times))] for key in self.reached}
        found = {"times": self.times, "reached": self.reached, "failed": sorted(self.failed)}
        path = file_of_record(self.folder, self.root, test_file, self.marked)
        path.write_text(json.dumps(found), encoding="utf-8")
        self.times, self.reached, self.failed = {}, {}, set()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the folder of the records."""
    parser.addoption("--reached", type=Path, help="folder of the records")


def pytest_configure(config: pytest.Config) -> None:
    """Record the tests from here on."""
    folder = config.getoption("--reached")
    if folder is not None:
        config.pluginmanager.register(Recorder(folder, config.rootpath, config.getoption("-m")))
