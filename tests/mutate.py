"""One-token mutations of the package, drawn at random: tests must fail for nearly all of them.

    python -m tests.mutate --sample 300 --seed 1 [--room contact] [--jobs 2] [--resume FILE]
    python -m tests.mutate --sample 300 --seed 1 --first 101 --last 200    # a part of the sample

A mutation changes one token of a copy of the package: a sign, a factor, a comparison, an index, a
tolerance.  The sample is stable: the rank of a mutation follows from its statement and function, so
that an edit elsewhere leaves it as it is.

The tests named after its file run first, then the tests of its room, then tests of other rooms that
import the file or name what it defines, then slow tests.  Each run is for the mutations that pass
the one before.  A mutation that passes all of them survives.  A survivor is either caught by a new
test or has no effect; ``--again`` tries the survivors again after tests have been added.  Mutations
without effect are listed in ``mutations_without_effect.jsonl``, each with a reason, and not tried.

The first run needs a few seconds for a mutation: the package is imported once, and the code of its
functions changed (:mod:`tests.tools.forked`).  Later runs are of those tests alone that reach the
token, the quickest ones before others.  What tests reach is found once, without a mutation
(:mod:`tests.tools.reached`), and again where the file of the mutation has changed.  It is kept
beside the file of ``--resume``, to which outcomes are appended: what is in it is not tried again.
Process times and memory are limited by Unix.
"""

from __future__ import annotations

import argparse
import ast
import bisect
import collections
import contextlib
import functools
import hashlib
import importlib.util
import itertools
import json
import keyword
import os
import queue
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import tokenize
import zlib
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple, TypeGuard

import pytest

from tests.tools import forked, reached

ROOT = Path(__file__).parents[1]
ROOMS = (
    "beams",
    "collapse",
    "contact",
    "design",
    "dynamics",
    "forms",
    "ground",
    "limit_analysis",
    "materials",
    "mesh",
    "results",
    "stages",
    "water",
)
#: Test of the defaults of all public names.
DEFAULTS = "tests/test_defaults.py"
#: Mutations without effect: a place and a reason in a line.
WITHOUT_EFFECT = Path("tests/mutations_without_effect.jsonl")
#: Process time of tests with a mutation: ``LEAST + SLOWER * (time without)`` seconds.
LEAST, SLOWER = 30.0, 3.0
#: Process time of the tests of a mutation that run first, in seconds.
QUICK = 3.0

OPERATORS = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
OPERATORS |= {"<": ">=", ">": "<=", "<=": ">", ">=": "<", "==": "!=", "!=": "=="}
OPERATORS |= {"&": "|", "|": "&", "**": "*"}
PREFIXES = {"-": "+", "~": "", "not": ""}
WORDS = {"and": "or", "or": "and", "True": "False", "False": "True"}
FUNCTIONS = {"min": "max", "minimum": "maximum", "argmin": "argmax", "any": "all", "sin": "cos"}
FUNCTIONS |= {new: old for old, new in FUNCTIONS.items()}
#: Parts that compute nothing.
COMPUTE_NOTHING = (ast.Raise, ast.Import, ast.ImportFrom, ast.JoinedStr)
#: Keywords that change no result.
NO_RESULT = ("strict", "stacklevel", "check_finite", "repr")
#: Lines of a summary of pytest with the name of a test that fails.
FAILED = re.compile(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", re.MULTILINE)
#: Floats below are tolerances.
TOLERANCE = 1e-3


#: Line and column of a token.
Position = tuple[int, int]


class Place(NamedTuple):
    """Where a token is, whatever is around its statement.

    The number of the token counts on through equal statements of the function.
    """

    file: str
    name: str  # qualified name of the function or class
    statement: str
    number: int

    def rank(self, seed: int) -> bytes:
        """Return a random number that follows from the place."""
        return hashlib.sha256(repr((seed, *self)).encode()).digest()


class Mutation(NamedTuple):
    """A token of a file of the package, and the token in its place; columns count from zero."""

    file: str
    line: int
    column: int
    old: str
    new: str
    place: Place

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}: {self.old} -> {self.new or '(nothing)'}"

    @property
    def room(self) -> str:
        """Folder of the file, or the name of a file at the top."""
        return Path(self.file).parts[0].removesuffix(".py")

    def applied(self, source: str) -> str:
        """Replace the token."""
        lines = source.splitlines(keepends=True)
        line = lines[self.line - 1]
        assert line.startswith(self.old, self.column)
        lines[self.line - 1] = line[: self.column] + self.new + line[self.column + len(self.old) :]
        return "".join(lines)


# -- mutations of a file


def changed_number(text: str) -> str | None:
    """Return a number that differs: the next integer, 1.1 times a factor, 100 times a tolerance."""
    value = ast.literal_eval(text)
    if isinstance(value, int):
        return str(value + 1)
    if isinstance(value, float) and value:
        factor = 100.0 if value < TOLERANCE else 1.1
        return repr(float(f"{factor * value:.6g}"))
    return "0.1" if isinstance(value, float) else None


def changed(before: str, token: str, after: str) -> str | None:
    """Return another token, or None where there is none."""
    is_operand = before in (")", "]", "}") or (
        re.match(r"[\w.'\"]", before) is not None and not keyword.iskeyword(before)
    )
    if re.match(r"\d|\.\d", token):
        return changed_number(token)
    if token in WORDS:
        return WORDS[token]
    if token in FUNCTIONS:
        return FUNCTIONS[token] if after == "(" else None
    if token == "not" and before == "is":
        return None
    return OPERATORS.get(token) if is_operand else PREFIXES.get(token)


def is_warning(node: ast.AST) -> bool:
    """Whether a node is a call that warns, with its text."""
    return isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] == "warn"


def is_negative(node: ast.AST) -> TypeGuard[ast.UnaryOp]:
    """Whether a node is a negative number."""
    return (
        isinstance(node, ast.UnaryOp)
        and isinstance(node.op, ast.USub)
        and isinstance(node.operand, ast.Constant)
    )


def left_out(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield the parts that compute nothing: annotations, imports, decorators, errors, texts.

    So do keywords that ask for a check or a copy, and the place of a warning.  In ``reshape`` all
    negative lengths are one.
    """
    for node in ast.walk(tree):
        if isinstance(node, COMPUTE_NOTHING) or is_warning(node):
            yield node
        elif isinstance(node, ast.keyword) and node.arg in NO_RESULT:
            yield node.value
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("reshape"):
            yield from (n.operand for n in ast.walk(node) if is_negative(n))
        elif isinstance(node, ast.arg | ast.AnnAssign) and node.annotation:
            yield node.annotation
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield from node.decorator_list
            if isinstance(node, ast.FunctionDef) and node.returns:
                yield node.returns


def statements(node: ast.AST, name: str = "") -> Iterator[tuple[str, ast.stmt]]:
    """Yield the statements with the names of their functions and classes, outer ones first."""
    for child in ast.iter_child_nodes(node):
        inner = name
        if isinstance(child, ast.FunctionDef | ast.ClassDef):
            inner = f"{name}.{child.name}".lstrip(".")
        if isinstance(child, ast.stmt):
            yield inner, child
        yield from statements(child, inner)


def places(
    file: str, tokens: list[tokenize.TokenInfo], spans: list[tuple[str, Position, Position]]
) -> list[Place]:
    """Return the places of tokens; ``spans``: names, starts and ends of the statements."""
    # Find the innermost statement of each token
    starts = [token.start for token in tokens]
    owners = [-1] * len(tokens)
    for k, (_, start, end) in enumerate(spans):
        first, last = bisect.bisect_left(starts, start), bisect.bisect_left(starts, end)
        owners[first:last] = [k] * (last - first)
    # Join the tokens of each statement
    words = collections.defaultdict(list)
    for owner, token in zip(owners, tokens, strict=True):
        words[owner].append(token.string)
    texts = {owner: " ".join(some) for owner, some in words.items()}
    # Number them
    numbers: dict[tuple[str, str], int] = collections.Counter()
    found = []
    for owner in owners:
        key = spans[owner][0] if owner >= 0 else "", texts[owner]
        found.append(Place(file, *key, numbers[key]))
        numbers[key] += 1
    return found


def mutations(root: Path, file: str) -> list[Mutation]:
    """Collect all mutations of a file of the package."""
    path = root / "skfem_contact" / file
    source = path.read_text(encoding="utf-8")
    lines = source.splitlines()

    def span(node: ast.AST) -> tuple[Position, Position]:
        """Return the start and the end of a node; those of the tree count bytes."""
        ends = (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)
        start, end = ((k, len(lines[k - 1].encode()[:n].decode())) for k, n in ends)
        return start, end

    # Find what computes nothing, and the statements
    tree = ast.parse(source)
    nothing = [span(node) for node in left_out(tree)]
    spans = [(name, *span(node)) for name, node in statements(tree)]
    with path.open("rb") as stream:
        tokens = [
            token
            for token in tokenize.tokenize(stream.readline)
            if token.type in (tokenize.NAME, tokenize.NUMBER, tokenize.OP, tokenize.STRING)
        ]
    # Change the other tokens
    found = []
    following = [*tokens[2:], *tokens[-1:]]
    of_tokens = places(file, tokens, spans)[1:]
    for before, token, after, place in zip(tokens, tokens[1:], following, of_tokens):
        new = changed(before.string, token.string, after.string)
        if new is None or any(start <= token.start < end for start, end in nothing):
            continue
        found.append(Mutation(file, *token.start, token.string, new, place))
    return found


def is_read(root: Path, mutation: Mutation) -> bool:
    """Whether Python still reads the file of a mutation."""
    source = (root / "skfem_contact" / mutation.file).read_text(encoding="utf-8")
    try:
        compile(mutation.applied(source), mutation.file, "exec")
    except SyntaxError:
        return False
    return True


def drawn(root: Path, rooms: tuple[str, ...], sample: int, seed: int) -> list[Mutation]:
    """Draw mutations of some rooms, every token with the same probability: the first by rank."""
    package = root / "skfem_contact"
    files = sorted(path.relative_to(package).as_posix() for path in package.rglob("*.py"))
    pool = [
        mutation
        for file in files
        if Path(file).parts[0].removesuffix(".py") in rooms
        for mutation in mutations(root, file)
    ]
    pool.sort(key=lambda mutation: mutation.place.rank(seed))
    return list(itertools.islice(filter(functools.partial(is_read, root), pool), sample))


def without_effect(root: Path) -> dict[Place, str]:
    """Read the mutations without effect, with their reasons."""
    file = root / WITHOUT_EFFECT
    if not file.exists():
        return {}
    rows = map(json.loads, file.read_text(encoding="utf-8").splitlines())
    return {Place(*row[:4]): row[4] for row in rows}


def stale(root: Path, known: Iterable[Place]) -> list[Place]:
    """Return the places that the package does not have."""
    files = {place.file for place in known if (root / "skfem_contact" / place.file).exists()}
    present = {mutation.place for file in files for mutation in mutations(root, file)}
    return [place for place in known if place not in present]


# -- tests of a mutation


def tests_of_room(root: Path, mutation: Mutation) -> list[str]:
    """List the test files of a room."""
    tests = root / "tests"
    files = {*tests.glob(f"{mutation.room}/test_*.py"), *tests.glob(f"test_{mutation.room}*.py")}
    if not files:
        raise ValueError(f"{mutation.file}: no tests for the room {mutation.room}")
    return sorted(path.relative_to(root).as_posix() for path in files)


def tests_that_touch(root: Path, mutation: Mutation) -> list[str]:
    """List the test files that import a file or name what it defines."""
    path = root / "skfem_contact" / mutation.file
    tree = ast.parse(path.read_text(encoding="utf-8"))
    names = [
        node.name
        for node in tree.body
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
    ]
    module = mutation.file.removesuffix(".py").replace("/", ".")
    pattern = re.compile(
        rf"skfem_contact\.{re.escape(module)}\b|\b(?:{'|'.join(names) or '(?!)'})\b"
    )
    files = []
    for test in sorted((root / "tests").rglob("test_*.py")):
        name = test.relative_to(root).as_posix()
        if not name.startswith("tests/docs/") and pattern.search(test.read_text(encoding="utf-8")):
            files.append(name)
    return files


def tests_of_file(root: Path, mutation: Mutation) -> list[str]:
    """List the test files that are named after a file, or else those of its room that touch it.

    The examples in the docstrings of the file come first, and for what runs on import the record of
    defaults.
    """
    file = f"skfem_contact/{mutation.file}"
    source = (root / file).read_text(encoding="utf-8")
    first = [file] if ">>>" in source else []
    if reached.segment_of(source, mutation.line) is None and (root / DEFAULTS).exists():
        first.append(DEFAULTS)
    room = tests_of_room(root, mutation)
    named = [test for test in room if f"/test_{Path(mutation.file).stem}" in test]
    if not named:
        named = [test for test in tests_that_touch(root, mutation) if test in room]
    return [*first, *named]


def tests_of_rest(root: Path, mutation: Mutation) -> list[str]:
    """List the other test files of a room, those that touch the file first."""
    touching = tests_that_touch(root, mutation)
    others = {*tests_of_room(root, mutation)} - {*tests_of_file(root, mutation)}
    return sorted(others, key=lambda test: (test not in touching, test))


def tests_of_others(root: Path, mutation: Mutation) -> list[str]:
    """List the test files of other rooms that touch a file."""
    room = tests_of_room(root, mutation)
    return [test for test in tests_that_touch(root, mutation) if test not in room]


class Run(NamedTuple):
    """A run of tests of some files, with a mark."""

    name: str
    marked: str
    files: Callable[[Path, Mutation], list[str]]
    selected: bool = True  # tests that reach the token, instead of all

    def __str__(self) -> str:
        return f"{self.name}, {self.marked}"


#: Each run is for the mutations that pass the one before.
RUNS = (
    Run("file", "not slow", tests_of_file, selected=False),
    Run("room", "not slow", tests_of_rest),
    Run("other rooms", "not slow", tests_of_others),
    Run("room", "slow", tests_of_room),
    Run("other rooms", "slow", tests_of_others),
)


class Tests(NamedTuple):
    """Process times of tests that reach a mutation, by their names."""

    times: dict[str, float]

    @property
    def total(self) -> float:
        """Process time of all tests."""
        return sum(self.times.values())

    @property
    def quickest(self) -> list[str]:
        """Tests that take :data:`QUICK` together, and at least five."""
        names = sorted(self.times, key=self.times.__getitem__)
        totals = itertools.accumulate(self.times[name] for name in names)
        return [name for k, (name, t) in enumerate(zip(names, totals)) if k < 5 or t < QUICK]

    @property
    def others(self) -> list[str]:
        """All others, in the order of the time of their files."""
        files: dict[str, float] = collections.Counter()
        for name, seconds in self.times.items():
            files[name.split("::")[0]] += seconds
        quickest = set(self.quickest)
        names = [name for name in self.times if name not in quickest]
        return sorted(names, key=lambda name: files[name.split("::")[0]])


class Copy:
    """A copy of the project, in which one mutation at a time is tried."""

    def __init__(self, root: Path, folder: Path, with_probes: bool = False) -> None:
        self.folder, self.output = folder, folder / "output"
        ignored = shutil.ignore_patterns(".*", "_build", "gallery", "__pycache__")
        shutil.copytree(root, folder, dirs_exist_ok=True, ignore=ignored)
        if with_probes:
            reached.add_probes(folder)
        variables = {**os.environ, "PYTHONPATH": str(folder)}
        variables.pop("PYTEST_ADDOPTS", None)  # options of the tests of this project
        variables.pop("PYTHONDONTWRITEBYTECODE", None)  # files are compiled once
        self.server = subprocess.Popen(
            [sys.executable, "-m", "tests.tools.forked"],
            cwd=folder,
            env=variables,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        # The package is imported before any of its files is written
        assert self.server.stdout is not None and self.server.stdout.readline()

    def close(self) -> None:
        """End the server."""
        self.server.communicate()

    def run(
        self,
        tests: list[str],
        *options: str,
        seconds: float,
        changed: tuple[str, str] | None = None,
    ) -> tuple[int, str]:
        """Run tests within a process time; return the status and the output.

        ``changed``: a file of the package that has been written, and its former source.
        """
        assert self.server.stdin is not None and self.server.stdout is not None
        arguments = ["-q", "-rfE", "-p", "no:cacheprovider", *options, *tests]
        task = {
            "arguments": arguments,
            "output": str(self.output),
            "seconds": round(seconds),
            "changed": changed,
        }
        print(json.dumps(task), file=self.server.stdin, flush=True)
        status = int(self.server.stdout.readline())
        return status, self.output.read_text(encoding="utf-8", errors="replace")

    def write(self, file: str, source: str) -> None:
        """Write a file of the package, and remove what Python has compiled."""
        path = self.folder / "skfem_contact" / file
        path.write_text(source, encoding="utf-8")
        Path(importlib.util.cache_from_source(str(path))).unlink(missing_ok=True)

    def failure(
        self, tests: list[str], marked: str, seconds: float, changed: tuple[str, str] | None
    ) -> str | None:
        """Return the first test that fails, what else ended the run, or None if all pass."""
        if not tests:
            return None
        status, output = self.run(tests, "-x", "-m", marked, seconds=seconds, changed=changed)
        if status in (0, 5):  # all pass, or no test is selected
            return None
        named = FAILED.search(output)
        if named:
            return named[1]
        if status in (-signal.SIGXCPU, -signal.SIGKILL, -signal.SIGALRM, -signal.SIGPROF):
            return "no end"
        if status in (pytest.ExitCode.INTERNAL_ERROR, forked.NO_RUN):
            raise RuntimeError(f"pytest ends with status {status}: {output[-2000:]}")
        return f"exit status {status}"

    def failing(self, tests: set[str]) -> set[str]:
        """Return which of some tests fail without a mutation: these prove nothing."""
        output = self.run(sorted(tests), seconds=forked.LONGEST)[1] if tests else ""
        return set(FAILED.findall(output))

    def caught_by(self, mutation: Mutation, records: Records, run: Run) -> str | None:
        """Return the test that catches a mutation, or None."""
        source = (self.folder / "skfem_contact" / mutation.file).read_text(encoding="utf-8")
        changed = (mutation.file, source)
        self.write(mutation.file, mutation.applied(source))
        try:
            for tests, seconds in self.groups(mutation, records, run):
                failed = self.failure(tests, run.marked, seconds, changed)
                if failed:
                    return failed
            return None
        finally:
            self.write(mutation.file, source)

    def groups(
        self, mutation: Mutation, records: Records, run: Run
    ) -> Iterator[tuple[list[str], float]]:
        """Yield the tests of a run in groups, with limits of their process time."""
        files = run.files(self.folder, mutation)
        if not run.selected:
            yield files, forked.LONGEST
            return
        # Files with a record first; others one by one, since most mutations are caught early
        present = [file for file in files if records.has(mutation, file, run.marked)]
        missing = [file for file in files if file not in present]
        for some in (present, *([file] for file in missing)):
            tests = records.of(mutation, some, run.marked)
            for group in (tests.quickest, tests.others):
                yield group, LEAST + SLOWER * tests.total


class Records:
    """What the tests reach without a mutation: see :mod:`tests.tools.reached`."""

    def __init__(self, root: Path, copy: Path, folder: Path) -> None:
        self.root, self.folder, self._place = root, folder, copy
        self.busy = threading.Lock()
        folder.mkdir(parents=True, exist_ok=True)
        package = root / "skfem_contact"
        self.sources = {
            path.relative_to(package).as_posix(): zlib.crc32(path.read_bytes())
            for path in package.rglob("*.py")
        }

    @functools.cached_property
    def copy(self) -> Copy:
        """Copy of the project with probes."""
        return Copy(self.root, self._place, with_probes=True)

    def close(self) -> None:
        """End the server of the copy, if there is one."""
        if "copy" in self.__dict__:
            self.copy.close()

    def place(self, file: str, marked: str) -> Path:
        """Return the file of a record."""
        return reached.file_of_record(self.folder, self.root, file, marked)

    def read(self, file: str, marked: str) -> dict[str, Any]:
        """Read what a test file reaches."""
        return json.loads(self.place(file, marked).read_text(encoding="utf-8"))

    def has(self, mutation: Mutation, file: str, marked: str) -> bool:
        """Whether there is a record of a test file with the present source of the package."""
        if not self.place(file, marked).exists():
            return False
        return self.read(file, marked)["sources"].get(mutation.file) == self.sources[mutation.file]

    def record(self, mutation: Mutation, files: list[str], marked: str) -> None:
        """Run test files that have not been run yet."""
        missing = [file for file in files if not self.has(mutation, file, marked)]
        if not missing:
            return
        for place in (self.place(file, marked) for file in missing):
            place.unlink(missing_ok=True)
        print(f"without a mutation: {' '.join(missing)}, {marked}", flush=True)
        options = ("-p", "tests.tools.reached", f"--reached={self.folder}", "-m", marked)
        status, output = self.copy.run(missing, *options, seconds=forked.LONGEST)
        if status not in (0, 1, 5):
            raise RuntimeError(f"pytest ends with status {status}: {output[-2000:]}")
        for file in missing:
            found = {"times": {}, "reached": {}, "failed": []}  # no test is marked so
            if self.place(file, marked).exists():
                found = self.read(file, marked)
            found["sources"] = self.sources
            self.place(file, marked).write_text(json.dumps(found), encoding="utf-8")

    def of(self, mutation: Mutation, files: list[str], marked: str) -> Tests:
        """Return the tests that reach a mutation; all tests of the files if it runs on import."""
        # a job may record files anew that another one is about to read
        with self.busy:
            self.record(mutation, files, marked)
            records = {file: self.read(file, marked) for file in files}
        source = (self.root / "skfem_contact" / mutation.file).read_text(encoding="utf-8")
        line = reached.segment_of(source, mutation.line)
        times: dict[str, float] = {}
        for found in records.values():
            names = list(found["times"])
            indices = found["reached"].get(f"{mutation.file}:{line}", [])
            chosen = names if line is None else [names[k] for k in indices]
            times |= {name: found["times"][name] for name in chosen if name not in found["failed"]}
        return Tests(times)


# -- command line


def recorded(file: Path, run: Run) -> dict[Place, str | None]:
    """Read the outcomes of a run."""
    if not file.exists():
        return {}
    rows = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    return {Place(*row["place"]): row["caught_by"] for row in rows if row["run"] == str(run)}


def tried(
    root: Path, chosen: list[Mutation], jobs: int, file: Path, again: bool = False
) -> dict[Mutation, str | None]:
    """Try mutations in their order, run after run: by which tests they are caught."""
    outcomes: dict[Mutation, str | None] = dict.fromkeys(chosen)
    copies: queue.SimpleQueue[Copy] = queue.SimpleQueue()

    def outcome(mutation: Mutation, run: Run) -> tuple[Mutation, str | None]:
        copy = copies.get()
        try:
            return mutation, copy.caught_by(mutation, records, run)
        finally:
            copies.put(copy)

    with contextlib.ExitStack() as opened:
        folder = Path(opened.enter_context(tempfile.TemporaryDirectory()))
        records = Records(root, folder / "probes", file.with_suffix(".reached"))
        opened.callback(records.close)
        for k in range(jobs):
            copy = Copy(root, folder / str(k))
            opened.callback(copy.close)
            copies.put(copy)
        pool = opened.enter_context(ThreadPoolExecutor(jobs))
        for run in RUNS:
            known = recorded(file, run)
            outcomes |= {key: known[key.place] for key in chosen if known.get(key.place)}
            remaining = [
                mutation
                for mutation in chosen
                if outcomes[mutation] is None and (again or mutation.place not in known)
            ]
            for mutation, test in pool.map(functools.partial(outcome, run=run), remaining):
                outcomes[mutation] = test
                print(f"{test or f'PASSES ({run})'}: {mutation}", flush=True)
                row = {"place": mutation.place, "run": str(run), "caught_by": test}
                with file.open("a", encoding="utf-8") as stream:
                    stream.write(json.dumps(row) + "\n")
        prove_nothing = copy.failing({test for test in outcomes.values() if test and "::" in test})
    return {key: None if test in prove_nothing else test for key, test in outcomes.items()}


def main(arguments: list[str] | None = None, root: Path = ROOT) -> int:
    """Try a sample, print its survivors, and return 1 if more than one in twenty survives."""
    parser = argparse.ArgumentParser(prog="tests.mutate", description=__doc__.splitlines()[0])
    parser.add_argument("--sample", type=int, default=300, help="number of mutations")
    parser.add_argument("--seed", type=int, default=1, help="seed of the sample")
    parser.add_argument("--first", type=int, default=1, help="number of the first one to try")
    parser.add_argument("--last", type=int, help="number of the last one to try")
    parser.add_argument("--room", action="append", help="a room; several by repeating the option")
    parser.add_argument("--jobs", type=int, default=1, help="number of processes")
    parser.add_argument(
        "--resume", type=Path, default=Path(".mutations"), help="file of outcomes, continued"
    )
    parser.add_argument("--again", action="store_true", help="try survivors of the file again")
    given = parser.parse_args(arguments)
    sample = drawn(root, tuple(given.room or ROOMS), given.sample, given.seed)
    known = without_effect(root)
    drawn_ones = sample[given.first - 1 : given.last]
    chosen = [mutation for mutation in drawn_ones if mutation.place not in known]
    outcomes = tried(root, chosen, given.jobs, given.resume, given.again)
    # Tell the mutations without effect, with what no longer is one
    for mutation in sorted({*drawn_ones} - {*chosen}):
        print(f"No effect: {mutation}: {known[mutation.place]}")
    for place in stale(root, known):
        print(f"{WITHOUT_EFFECT}: the package no longer has {list(place)}; remove it")
    # Tell the survivors, each with its line in the list of those without effect
    survivors = sorted(mutation for mutation, test in outcomes.items() if test is None)
    print("\nSurvivors:" if survivors else "\nNo survivors.")
    for mutation in survivors:
        print(f"{mutation}\n    {json.dumps([*mutation.place, 'reason'])}")
    print(f"{len(survivors)} of {len(outcomes)} mutations survive")
    return int(len(survivors) > 0.05 * len(outcomes))


if __name__ == "__main__":
    sys.exit(main())
