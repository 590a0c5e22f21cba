"""Server that runs pytest in processes of its own; libraries and the package are imported once.

It reads one line of JSON per run: the arguments of pytest, the file for its output, a limit of
the process time in seconds, and the file of the package that has changed with its former source.
It answers with the exit status; minus the signal that ended the run.

A change within functions is made in the imported package, by their code.  Where the change is run
on import, the package is imported again.
"""

from __future__ import annotations

import collections
import gc
import importlib
import json
import os
import pkgutil
import resource
import signal
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any

import pytest

PACKAGE = "skfem_contact"
IMPORTED_ONCE = (
    "matplotlib.pyplot",
    "scipy.interpolate",
    "scipy.optimize",
    "scipy.sparse.linalg",
    "scipy.spatial",
    "skfem",
)
#: Seconds after which a run ends even if it waits.
LONGEST = 3600
#: Process time of a test without end; tests that are not marked as slow take 5 s at most.
LONGEST_TEST = 20.0
#: Address space of a run, in bytes: a changed size may ask for any memory.
MEMORY = 12 * 2**30
#: Exit status if pytest could not be run.
NO_RUN = 99
#: Flag of the code of functions, which the code of modules and classes does not have.
OPTIMIZED = 0x1


# -- changes of the imported package


def parts(code: CodeType) -> list[CodeType]:
    """List the code inside of code."""
    return [one for one in code.co_consts if isinstance(one, CodeType)]


def without_parts(code: CodeType) -> CodeType:
    """Return code of its own statements alone."""
    constants = tuple(one for one in code.co_consts if not isinstance(one, CodeType))
    return code.replace(co_consts=constants)


def changes(old: CodeType, new: CodeType) -> Iterator[tuple[CodeType, CodeType | None]]:
    """Yield the outermost functions that change, with their new code; None: it runs on import."""
    if old == new:
        return
    if old.co_flags & OPTIMIZED:
        yield old, new
        return
    if without_parts(old) != without_parts(new):
        yield old, None
    for before, after in zip(parts(old), parts(new)):
        yield from changes(before, after)


def all_changes(old: CodeType, new: CodeType) -> dict[CodeType, CodeType]:
    """Return the changes of a function and of the functions inside of it."""
    found = {old: new} if old != new else {}
    for before, after in zip(parts(old), parts(new)):
        found |= all_changes(before, after)
    return found


def replaced(old: CodeType, new: CodeType, run_on_import: set[CodeType]) -> bool:
    """Replace the code of functions by that of a changed module; False if this is not enough."""
    wanted: dict[CodeType, CodeType] = {}
    outermost = set()
    for before, after in changes(old, new):
        if after is None or before in run_on_import:
            return False
        outermost.add(before)
        wanted |= all_changes(before, after)
    functions = collections.defaultdict(list)
    for one in gc.get_objects():
        if isinstance(one, FunctionType) and one.__code__ in wanted:
            functions[one.__code__].append(one)
    if not outermost <= set(functions):
        return False
    for code, some in functions.items():
        for function in some:
            function.__code__ = wanted[code]
    return True


def change(file: str, before: str, run_on_import: set[CodeType]) -> None:
    """Bring the imported package to the present source of one of its files."""
    path = Path(PACKAGE, file)
    old, new = (
        compile(source, str(path), "exec", dont_inherit=True)
        for source in (before, path.read_text(encoding="utf-8"))
    )
    if replaced(old, new, run_on_import):
        return
    for name in [name for name in sys.modules if name.split(".")[0] == PACKAGE]:
        del sys.modules[name]


# -- runs


class Order:
    """The first case of each test before second ones, and an end to each test."""

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Sort the tests by the number of their case."""
        cases: collections.Counter[tuple[str, str]] = collections.Counter()
        number = {}
        for item in items:
            key = item.location[0], getattr(item, "originalname", item.name)
            number[item], cases[key] = cases[key], cases[key] + 1
        items.sort(key=number.__getitem__)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Any:
        """Limit the process time of a test."""
        limit = 0.0 if item.get_closest_marker("slow") else LONGEST_TEST  # zero: no limit
        signal.setitimer(signal.ITIMER_PROF, limit)
        return (yield)


def run(
    arguments: Sequence[str],
    output: str,
    seconds: int,
    changed: tuple[str, str] | None,
    run_on_import: set[CodeType],
) -> int:
    """Run pytest in another process; return its exit status."""
    process = os.fork()
    if process == 0:
        with open(output, "w", encoding="utf-8") as stream:
            os.dup2(stream.fileno(), 1)
            os.dup2(stream.fileno(), 2)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        signal.alarm(LONGEST)
        status = NO_RUN
        try:
            if changed:
                change(*changed, run_on_import)
            status = pytest.main([*arguments], plugins=[Order()] if changed else [])
            sys.stdout.flush()
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


def import_package() -> set[CodeType]:
    """Import all modules of the package; return the code that is run."""
    found: set[CodeType] = set()

    def note(frame: FrameType, event: str, value: object) -> None:
        """Note the code of the package."""
        if event == "call" and PACKAGE in frame.f_code.co_filename:
            found.add(frame.f_code)

    sys.setprofile(note)
    try:
        package = importlib.import_module(PACKAGE)
        for module in pkgutil.walk_packages(package.__path__, f"{PACKAGE}."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
    finally:
        sys.setprofile(None)
    return found


if __name__ == "__main__":
    for library in IMPORTED_ONCE:
        try:
            importlib.import_module(library)
        except ImportError:
            continue
    called = import_package()
    print("ready", flush=True)
    for line in sys.stdin:
        print(run(**json.loads(line), run_on_import=called), flush=True)
