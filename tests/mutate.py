"""``python -m tests.mutate`` changes one line of a copy of the package at a time: the tests must
fail each time.

``python -m tests.mutate limit_analysis`` tries the files whose path holds a text. The table of
lines is that of ``docs/contributing.md``.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
#: Seconds after which tests of a mutated package count as failed: it may iterate without end.
LONGEST = 600.0


class Mutation(NamedTuple):
    """Row of the table: a file, what the line computes, its unique text, a wrong one, and the tests
    that fail.
    """

    file: str
    what: str
    old: str
    new: str
    tests: str


def table() -> list[Mutation]:
    """Read the rows; each text must occur once in its file."""
    lines = (ROOT / "docs" / "contributing.md").read_text(encoding="utf-8").splitlines()
    rows = [
        [cell.strip().strip("`") for cell in line.strip("|").split(" | ")]
        for line in lines
        if ".py | " in line
    ]
    found = [Mutation(*row) for row in rows if len(row) == 5]
    for one in found:
        count = (ROOT / "skfem_contact" / one.file).read_text(encoding="utf-8").count(one.old)
        if count != 1 or one.old == one.new:
            raise ValueError(
                f"{one.file} holds {one.old!r} {count} times instead of once: choose another text"
            )
    return found


def survives(folder: Path, file: str, tests: str, old: str, new: str) -> bool:
    """Return whether the tests of a copy of the project pass with one text replaced."""
    path = folder / "skfem_contact" / file
    original = path.read_text(encoding="utf-8")
    path.write_text(original.replace(old, new), encoding="utf-8")
    parts = [name.partition("::") for name in tests.split()]
    names = [f"tests/{name}.py{colons}{test}" for name, colons, test in parts]
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *names]
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(folder)},
            timeout=LONGEST,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    except subprocess.TimeoutExpired:
        return False
    finally:
        path.write_text(original, encoding="utf-8")
    if done.returncode not in (0, 1):
        raise RuntimeError(
            f"{file}, {old!r}: pytest ends with status {done.returncode}, no test has failed"
        )
    return done.returncode == 0


def main(part: str = "") -> int:
    """Try all mutations of files whose path holds a text; return 1 if a mutation survives, else
    0.
    """
    chosen, survivors = [one for one in table() if part in one.file], 0
    with tempfile.TemporaryDirectory() as name:
        shutil.copytree(
            ROOT, name, dirs_exist_ok=True, ignore=shutil.ignore_patterns(".*", "_build", "gallery")
        )
        for tests in dict.fromkeys(one.tests for one in chosen):
            if not survives(Path(name), "__init__.py", tests, "", ""):
                raise RuntimeError(f"{tests} fail without a mutation")
        for file, _, old, new, tests in chosen:
            alive = survives(Path(name), file, tests, old, new)
            survivors += alive
            print(f"{'SURVIVES' if alive else 'caught':9}{file}: {new}", flush=True)
    print(f"{len(chosen)} mutations, {survivors} survive")
    return int(survivors > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
