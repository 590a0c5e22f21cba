"""One-token mutations of the package, drawn at random: the tests must fail for nearly all of them.

    python -m tests.mutate --sample 300 --seed 1 [--room contact] [--jobs 2] [--resume FILE]

A mutation changes one token of a copy of the package: a sign, a factor, a comparison, an index, a
tolerance.  The tests of its room run first, then its slow tests, then the tests of other rooms that
import the file or name what it defines.  A mutation that passes all of them survives.  A survivor
is either caught by a new test or has no effect.  Outcomes are appended to the file of ``--resume``;
a run with the same file and seed leaves out what is in it.
"""

from __future__ import annotations

import argparse
import ast
import itertools
import json
import keyword
import os
import queue
import random
import re
import shutil
import subprocess
import sys
import tempfile
import tokenize
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
ROOMS = (
    "beams",
    "collapse",
    "contact",
    "forms",
    "limit_analysis",
    "materials",
    "results",
    "stages",
    "water",
)
#: Seconds after which the tests of a mutation count as failed: the package may iterate without end.
LONGEST = 3600.0

OPERATORS = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
OPERATORS |= {"<": ">=", ">": "<=", "<=": ">", ">=": "<", "==": "!=", "!=": "=="}
OPERATORS |= {"&": "|", "|": "&", "**": "*"}
PREFIXES = {"-": "+", "~": "", "not": ""}
WORDS = {"and": "or", "or": "and", "True": "False", "False": "True"}
FUNCTIONS = {"min": "max", "minimum": "maximum", "argmin": "argmax", "any": "all", "sin": "cos"}
FUNCTIONS |= {new: old for old, new in FUNCTIONS.items()}
#: Floats below are tolerances.
TOLERANCE = 1e-3


class Mutation(NamedTuple):
    """A token of a file of the package, and the token in its place; columns count from zero."""

    file: str
    line: int
    column: int
    old: str
    new: str

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


def left_out(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield the parts that compute nothing: annotations, imports, decorators, errors, texts."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.Raise, ast.Import, ast.ImportFrom, ast.JoinedStr)):
            yield node
        elif isinstance(node, ast.arg | ast.AnnAssign) and node.annotation:
            yield node.annotation
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield from node.decorator_list
            if isinstance(node, ast.FunctionDef) and node.returns:
                yield node.returns


def mutations(root: Path, file: str) -> list[Mutation]:
    """Collect all mutations of a file of the package."""
    path = root / "skfem_contact" / file
    source = path.read_text(encoding="utf-8")
    lines = source.splitlines()

    def place(line: int, column: int) -> tuple[int, int]:
        """Convert a position that counts bytes."""
        return line, len(lines[line - 1].encode()[:column].decode())

    spans = [
        (place(node.lineno, node.col_offset), place(node.end_lineno, node.end_col_offset))
        for node in left_out(ast.parse(source))
    ]
    with path.open("rb") as stream:
        tokens = [
            token
            for token in tokenize.tokenize(stream.readline)
            if token.type in (tokenize.NAME, tokenize.NUMBER, tokenize.OP, tokenize.STRING)
        ]
    found = []
    for before, token, after in zip(tokens, tokens[1:], [*tokens[2:], *tokens[-1:]], strict=False):
        new = changed(before.string, token.string, after.string)
        if new is None or any(start <= token.start < end for start, end in spans):
            continue
        found.append(Mutation(file, *token.start, token.string, new))
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
    """Draw mutations of some rooms, every token with the same probability."""
    package = root / "skfem_contact"
    files = sorted(path.relative_to(package).as_posix() for path in package.rglob("*.py"))
    pool = [
        mutation
        for file in files
        if Path(file).parts[0].removesuffix(".py") in rooms
        for mutation in mutations(root, file)
    ]
    random.Random(seed).shuffle(pool)
    return list(itertools.islice(filter(partial(is_read, root), pool), sample))


# -- tests of a mutation


def tests_of_room(root: Path, mutation: Mutation) -> list[str]:
    """List the test files of a room; those that are named after the file come first."""
    tests = root / "tests"
    stem = Path(mutation.file).stem
    files = [*tests.glob(f"{mutation.room}/test_*.py"), *tests.glob(f"test_{mutation.room}*.py")]
    files.sort(key=lambda path: (not path.stem.startswith(f"test_{stem}"), path))
    return [path.relative_to(root).as_posix() for path in files]


def tests_that_touch(root: Path, mutation: Mutation) -> list[str]:
    """List the test files of other rooms that import a file or name what it defines."""
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
    of_room = tests_of_room(root, mutation)
    files = []
    for test in sorted((root / "tests").rglob("test_*.py")):
        name = test.relative_to(root).as_posix()
        if (
            name not in of_room
            and not name.startswith("tests/docs/")
            and pattern.search(test.read_text(encoding="utf-8"))
        ):
            files.append(name)
    return files


class Copy:
    """A copy of the project, in which one mutation at a time is tried."""

    def __init__(self, root: Path, folder: Path) -> None:
        self.folder = folder
        ignored = shutil.ignore_patterns(".*", "_build", "gallery", "__pycache__")
        shutil.copytree(root, folder, dirs_exist_ok=True, ignore=ignored)

    def failure(self, tests: list[str], *options: str) -> str | None:
        """Return the first test that fails, what else ended the run, or None if all pass."""
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-rfE", "-p", "no:cacheprovider"]
        environment = {**os.environ, "PYTHONPATH": str(self.folder), "PYTHONDONTWRITEBYTECODE": "1"}
        environment.pop("PYTEST_ADDOPTS", None)  # options of the tests of this project
        try:
            done = subprocess.run(
                [*command, *options, *tests],
                cwd=self.folder,
                env=environment,
                timeout=LONGEST,
                capture_output=True,
                text=True,
            )
        except subprocess.TimeoutExpired:
            return "no end"
        if done.returncode in (0, 5):  # all pass, or no test is selected
            return None
        if done.returncode in (3, 4):
            raise RuntimeError(f"pytest ends with status {done.returncode}: {done.stdout[-2000:]}")
        named = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
        return named[1] if named else f"exit status {done.returncode}"

    def caught_by(self, mutation: Mutation) -> str | None:
        """Return the test that catches a mutation, or None."""
        path = self.folder / "skfem_contact" / mutation.file
        source = path.read_text(encoding="utf-8")
        path.write_text(mutation.applied(source), encoding="utf-8")
        of_room = tests_of_room(self.folder, mutation)
        if not of_room:
            raise ValueError(f"{mutation.file}: no tests for the room {mutation.room}")
        touching = tests_that_touch(self.folder, mutation)
        try:
            failed = self.failure(of_room, "-m", "not slow") or self.failure(of_room, "-m", "slow")
            if failed is None and touching:
                failed = self.failure(touching, "-m", "slow or not slow")
        finally:
            path.write_text(source, encoding="utf-8")
        named = failed is not None and failed.startswith("tests/")
        if named and self.failure([failed], "-m", "slow or not slow"):
            raise RuntimeError(f"{failed} fails without a mutation")
        return failed


# -- command line


def recorded(file: Path | None) -> dict[Mutation, str | None]:
    """Read what is in the file of a run."""
    if file is None or not file.exists():
        return {}
    rows = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    return {Mutation(*row["mutation"]): row["caught_by"] for row in rows}


def tried(
    root: Path, chosen: list[Mutation], jobs: int, file: Path | None
) -> dict[Mutation, str | None]:
    """Try mutations in parallel: by which tests they are caught."""
    outcomes = {key: test for key, test in recorded(file).items() if key in chosen}
    copies: queue.SimpleQueue[Copy] = queue.SimpleQueue()

    def outcome(mutation: Mutation) -> tuple[Mutation, str | None]:
        copy = copies.get()
        try:
            return mutation, copy.caught_by(mutation)
        finally:
            copies.put(copy)

    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(jobs) as pool:
        for k in range(jobs):
            copies.put(Copy(root, Path(folder) / str(k)))
        remaining = [mutation for mutation in chosen if mutation not in outcomes]
        for mutation, test in pool.map(outcome, remaining):
            outcomes[mutation] = test
            print(f"{test or 'SURVIVES'}: {mutation}", flush=True)
            if file is not None:
                with file.open("a", encoding="utf-8") as stream:
                    stream.write(json.dumps({"mutation": mutation, "caught_by": test}) + "\n")
    return outcomes


def main(arguments: list[str] | None = None, root: Path = ROOT) -> int:
    """Try a sample, print its survivors, and return 1 if more than one in twenty survives."""
    parser = argparse.ArgumentParser(prog="tests.mutate", description=__doc__.splitlines()[0])
    parser.add_argument("--sample", type=int, default=300, help="number of mutations")
    parser.add_argument("--seed", type=int, default=1, help="seed of the sample")
    parser.add_argument("--room", action="append", help="a room; several by repeating the option")
    parser.add_argument("--jobs", type=int, default=1, help="number of processes")
    parser.add_argument("--resume", type=Path, help="file of outcomes, which is continued")
    given = parser.parse_args(arguments)
    chosen = drawn(root, tuple(given.room or ROOMS), given.sample, given.seed)
    outcomes = tried(root, chosen, given.jobs, given.resume)
    survivors = sorted(mutation for mutation, test in outcomes.items() if test is None)
    print("\nSurvivors:" if survivors else "\nNo survivors.")
    for mutation in survivors:
        source = (root / "skfem_contact" / mutation.file).read_text(encoding="utf-8")
        print(f"{mutation}\n    {source.splitlines()[mutation.line - 1].strip()}")
    print(f"{len(survivors)} of {len(outcomes)} mutations survive")
    return int(len(survivors) > 0.05 * len(outcomes))


if __name__ == "__main__":
    sys.exit(main())
