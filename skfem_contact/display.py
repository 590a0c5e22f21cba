"""Output in terminals and notebooks: progress bars and tables."""

from __future__ import annotations

import csv
import io
import logging
import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from pathlib import Path
from time import perf_counter
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy import ndarray
from tqdm import tqdm

from .units import unit_of

logger = logging.getLogger("skfem_contact")
#: Seconds between two lines of the log within a stage.
_SELDOM = 10.0
#: Figures below this are written without a power of ten.
_PLAIN = 1e7
#: Figures below this share of the largest one of a column are round-off.
_ZERO = 1e-12


def in_notebook() -> bool:
    """Return True in the kernel of a notebook, with or without widgets."""
    python = sys.modules.get("IPython")
    return python is not None and getattr(python.get_ipython(), "kernel", None) is not None


def progress_bar(show: bool | None, **options: Any) -> Any:
    """Return a bar of tqdm, by default shown in terminals and notebooks only."""
    if show is None:
        show = sys.stderr.isatty() or in_notebook()
    kind = _notebook_bar() if show and in_notebook() else tqdm
    return kind(disable=not show, **options)


def _notebook_bar() -> Any:
    """Return the class of bars in a notebook, whose import takes a while."""
    with warnings.catch_warnings():  # a notebook without widgets has bars of text
        warnings.filterwarnings("ignore", message="IProgress not found")
        from tqdm.auto import tqdm
    return tqdm


class Bars:
    """Bars of a run, one for every stage; where they are not shown, a line of the log now and then.

    Parameters
    ----------
    show
        Whether to show bars; None: in terminals and notebooks.
    stages
        Number of stages.
    """

    def __init__(self, show: bool | None, stages: int) -> None:
        self._show = show
        self._stages = stages
        self._number = 0
        self._name = ""
        self._bar = progress_bar(False)
        self._began = self._logged = perf_counter()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Show the bar of the next stage."""
        self._number += 1
        self._name = name
        with progress_bar(
            self._show,
            total=1.0,
            desc=f"{name} ({self._number}/{self._stages})",
            bar_format="{desc:20} {percentage:3.0f}% |{bar}|{postfix}",
        ) as self._bar:
            yield

    def update(self, share: float, increments: int, iterations: int, displacement: float) -> None:
        """Show the share of the stage, and its increments, iterations and displacement so far."""
        now = perf_counter()
        done = (self._number - 1 + share) / self._stages
        remaining = "?"  # in a jump of the load at the start of the first stage
        if done > 0.0:
            remaining = tqdm.format_interval(round((now - self._began) * (1.0 / done - 1.0)))
        text = (
            f"{increments} increments, {iterations} iterations, displacement {displacement:.3g}, "
            f"{remaining} left"
        )
        self._bar.update(share - self._bar.n)
        self._bar.set_postfix_str(text)
        if self._bar.disable and (share == 1.0 or now - self._logged > _SELDOM):
            number = f"{self._number} of {self._stages}"
            logger.info("stage '%s' (%s): %.0f%%, %s", self._name, number, 100 * share, text)
            self._logged = now


@dataclass(frozen=True)
class Table:
    """Table of a result, printed as text and shown by notebooks as HTML.

    ``table["M"]`` is a column as an array.

    Attributes
    ----------
    head
        Names of the columns.
    rows
        Values of each row: names and figures, NaN for none.
    caption
        Title of the table.
    units
        Unit of each column, empty for none, which follows its name where the table is shown;
        nothing if :func:`~skfem_contact.set_units` was not called.

    Examples
    --------
    >>> from skfem_contact.results import Table
    >>> table = Table.of({"stage": ["dig", "fill"], "strut": [-120.5, float("nan")]})
    >>> print(table.to_markdown())
    | stage | strut |
    |:--|--:|
    | dig | -120.5 |
    | fill | – |
    >>> table["strut"].tolist()
    [-120.5, nan]
    """

    head: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]
    caption: str = ""
    units: tuple[str, ...] = ()

    def __call__(self) -> Table:
        """Return the table, so that ``result.table()`` is right for every result.

        Results at points and checks of designs have it as a property, the others as a method.
        """
        return self

    @classmethod
    def of(
        cls,
        columns: Mapping[str, Sequence[Any] | ndarray],
        caption: str = "",
        kinds: Mapping[str, str] = MappingProxyType({}),
    ) -> Table:
        """Return a table of columns of one length by their names.

        Kinds of quantities by the names of columns, such as ``"length"`` or ``"stress"``, give the
        units.
        """
        values = (part.tolist() if isinstance(part, ndarray) else part for part in columns.values())
        units = tuple(unit_of(kinds.get(name, "")) for name in columns)
        return cls(tuple(columns), tuple(zip(*values, strict=True)), caption, units)

    @property
    def titles(self) -> tuple[str, ...]:
        """Names of the columns with their units."""
        if not self.units:
            return self.head
        pairs = zip(self.head, self.units, strict=True)
        return tuple(f"{name} [{unit}]" if unit else name for name, unit in pairs)

    def __getitem__(self, column: str) -> ndarray:
        if column not in self.head:
            raise KeyError(f"there is no column '{column}'; existing: {list(self.head)}")
        return np.array([row[self.head.index(column)] for row in self.rows])

    def __len__(self) -> int:
        return len(self.rows)

    def __str__(self) -> str:
        texts = [list(self.titles), *self.texts()]
        columns = []
        for column, right in zip(zip(*texts, strict=True), self._right, strict=True):
            width = max(map(len, column))
            if right:
                columns.append([text.rjust(width) for text in column])
            else:
                columns.append([text.ljust(width) for text in column])
        lines = ["  ".join(row).rstrip() for row in zip(*columns, strict=True)]
        if self.caption:
            lines.insert(0, self.caption)
        return "\n".join(lines)

    __repr__ = __str__  # in a terminal as in print

    def _repr_html_(self) -> str:
        sides = ["right" if right else "left" for right in self._right]

        def cells(tag: str, row: Sequence[str]) -> str:
            result = ""
            for side, text in zip(sides, row, strict=True):
                result += f'<{tag} style="text-align:{side}">{escape(text)}</{tag}>'
            return result

        head = f"<thead><tr>{cells('th', self.titles)}</tr></thead>"
        body = "".join(f"<tr>{cells('td', row)}</tr>" for row in self.texts())
        if self.caption:
            above = f"<caption>{escape(self.caption)}</caption>"
        else:
            above = ""
        return f"<table>{above}{head}<tbody>{body}</tbody></table>"

    def to_markdown(self) -> str:
        """Return the table in Markdown, figures with four digits and aligned on the right."""
        rule = "|" + "|".join("--:" if right else ":--" for right in self._right) + "|"
        lines = []
        for row in (self.titles, *self.texts()):
            cells = " | ".join(text.replace("|", "\\|") for text in row)
            lines.append(f"| {cells} |")
        lines.insert(1, rule)
        return "\n".join(lines)

    def to_csv(self, file: str | Path | None = None) -> str:
        """Return comma-separated values with all digits, and write them to a given file."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.titles)
        for row in self.rows:
            writer.writerow([None if _missing(value) else value for value in row])
        if file is not None:
            Path(file).write_text(text.getvalue(), encoding="utf-8")
        return text.getvalue()

    def to_frame(self) -> Any:
        """Return the table as a data frame of pandas, which must be installed.

        Its columns have their names without units, which are in ``frame.attrs["units"]``.
        """
        import pandas

        frame = pandas.DataFrame.from_records(list(self.rows), columns=list(self.head))
        frame.attrs["units"] = dict(zip(self.head, self.units))
        return frame

    @property
    def _right(self) -> list[bool]:
        """True for each column of figures, which is aligned on the right."""
        if not self.rows:
            return [False] * len(self.head)
        return [_are_figures(column) for column in zip(*self.texts(), strict=True)]

    def texts(self) -> list[list[str]]:
        """Return the cells as text: figures with four digits, a dash for nothing."""
        columns = [_written(column) for column in zip(*self.rows, strict=True)]
        return [list(row) for row in zip(*columns, strict=True)]


def _missing(value: Any) -> bool:
    """Return True for no value."""
    return value is None or (isinstance(value, float) and np.isnan(value))


def _are_figures(column: Sequence[str]) -> bool:
    """Return True for the texts of a column of figures."""
    texts = [text for text in column if text not in ("", "–")]
    figures = [text.lstrip("<>= -−")[:1].isdigit() or text == "inf" for text in texts]
    return bool(figures) and all(figures)


def _written(column: Sequence[Any]) -> list[str]:
    """Return the texts of a column.

    Figures have four digits, and zero stands for round-off; a dash stands for nothing.
    """
    figures = [abs(v) for v in column if isinstance(v, float) and np.isfinite(v)]
    size = max(figures, default=0.0)
    texts = []
    for value in column:
        if _missing(value):
            texts.append("–")
        elif not isinstance(value, float):
            texts.append(str(value))
        else:
            if abs(value) < _ZERO * size:
                figure = 0.0
            else:
                figure = value + 0.0
            plain = 1e4 <= abs(figure) < _PLAIN
            texts.append(f"{figure:.0f}" if plain else f"{figure:.4g}")
    return texts
