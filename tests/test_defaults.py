"""Defaults of public names: a table on record, so that none changes unnoticed.

Run ``python -m tests.test_defaults`` to write the table again after new options.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.tools.unshown import public

TABLE = Path(__file__).with_name("defaults.txt")
#: Types of defaults whose text is their value.
PLAIN = (bool, int, float, str, tuple, type(None))


def options(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield the parameters of a function or class with their defaults, and plain attributes."""
    plain = value.__func__ if isinstance(value, classmethod | staticmethod) else value
    if isinstance(plain, property):
        return
    try:
        parameters = inspect.signature(plain).parameters.values()
    except (TypeError, ValueError):
        parameters = ()
    for one in parameters:
        if one.default is not one.empty:
            yield one.name, one.default
    if inspect.isclass(value):
        yield from ((key, given) for key, given in vars(value).items() if not key.startswith("_"))


def defaults() -> dict[str, str]:
    """Return the text of all plain defaults by the names of functions and parameters."""
    return {
        f"{name}.{option}": repr(default)
        for name, value in public().items()
        for option, default in options(value)
        if isinstance(default, PLAIN)
    }


def test_defaults_are_those_on_record() -> None:
    """A default that changes, changes results: write the table again if it is meant, with a line in
    the change log.  Options that are not in the table yet are not compared.
    """
    now = defaults()
    recorded = dict(line.split(" ", 1) for line in TABLE.read_text(encoding="utf-8").splitlines())
    changed = {
        name: (default, now[name])
        for name, default in recorded.items()
        if now.get(name, default) != default
    }
    assert not changed
    assert len(recorded) > 600
    assert len(recorded.keys() & now.keys()) > 0.9 * len(now)


if __name__ == "__main__":
    TABLE.write_text(
        "".join(f"{name} {default}\n" for name, default in sorted(defaults().items())),
        encoding="utf-8",
    )
