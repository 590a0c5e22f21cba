"""Output in terminals and notebooks: progress bars and tables."""
from __future__ import annotations

import csv
import io
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray
from tqdm.auto import tqdm

#: Figures below this are written without a power of ten.
_PLAIN = 1e7
#: Figures below this share of the largest one of a column are round-off.
_ZERO = 1e-12


def progress_bar(show: bool | None, **options: Any) -> Any:
    """Return a bar of tqdm, as a widget in a notebook; shown by default in terminals and notebooks."""
    if show is None:
        show = sys.stderr.isatty() or any(cls.__module__ == "tqdm.notebook" for cls in tqdm.__mro__)
    return tqdm(disable=not show, **options)


@dataclass(frozen=True)
class Table:
    """Table of a result: printed as text, shown by notebooks as HTML; ``table["M"]`` is a column as an array.

    Attributes
    ----------
    head
        Names of the columns.
    rows
        Values of each row: names and figures, NaN where there is none.
    caption
        Title of the table.

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

    @classmethod
    def of(cls, columns: Mapping[str, Sequence[Any] | ndarray], caption: str = "") -> Table:
        """Return a table of columns of one length by their names."""
        values = (part.tolist() if isinstance(part, ndarray) else part for part in columns.values())
        return cls(tuple(columns), tuple(zip(*values, strict=True)), caption)

    def __getitem__(self, column: str) -> ndarray:
        if column not in self.head:
            raise KeyError(f"there is no column '{column}'; existing: {list(self.head)}")
        return np.array([row[self.head.index(column)] for row in self.rows])

    def __len__(self) -> int:
        return len(self.rows)

    def __str__(self) -> str:
        texts = [self.head, *self._texts()]
        widths = [max(map(len, column)) for column in zip(*texts, strict=True)]
        lines = ("  ".join(text.rjust(n) if right else text.ljust(n) for text, n, right
                           in zip(row, widths, self._right, strict=True)).rstrip() for row in texts)
        return "\n".join((*([self.caption] if self.caption else ()), *lines))

    __repr__ = __str__  # in a terminal as in print

    def _repr_html_(self) -> str:
        def cells(tag: str, row: Sequence[str]) -> str:
            sides = ("right" if right else "left" for right in self._right)
            return "".join(f'<{tag} style="text-align:{side}">{escape(text)}</{tag}>'
                           for side, text in zip(sides, row, strict=True))

        body = "".join(f"<tr>{cells('td', row)}</tr>" for row in self._texts())
        above = f"<caption>{escape(self.caption)}</caption>" if self.caption else ""
        return f"<table>{above}<thead><tr>{cells('th', self.head)}</tr></thead><tbody>{body}</tbody></table>"

    def to_markdown(self) -> str:
        """Return the table in Markdown, figures with four digits and aligned on the right."""
        rule = "|" + "|".join("--:" if right else ":--" for right in self._right) + "|"
        head, *body = ("| " + " | ".join(text.replace("|", "\\|") for text in row) + " |"
                       for row in (self.head, *self._texts()))
        return "\n".join((head, rule, *body))

    def to_csv(self, file: str | Path | None = None) -> str:
        """Return comma-separated values with all digits, and write them to a file if one is given."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerows((self.head, *([None if _missing(value) else value for value in row] for row in self.rows)))
        if file is not None:
            Path(file).write_text(text.getvalue(), encoding="utf-8")
        return text.getvalue()

    def to_frame(self) -> Any:
        """Return the table as a data frame of pandas, which must be installed."""
        import pandas

        return pandas.DataFrame.from_records(list(self.rows), columns=list(self.head))

    @property
    def _right(self) -> list[bool]:
        """True for each column of figures, which is aligned on the right."""
        columns = [[text for text in column if text not in ("", "–")] for column in zip(*self._texts(), strict=True)]
        return [all(text.lstrip("<>= -−")[:1].isdigit() or text == "inf" for text in column) and bool(column)
                for column in columns] or [False] * len(self.head)

    def _texts(self) -> Iterable[list[str]]:
        sizes = [max((abs(v) for v in column if isinstance(v, float) and np.isfinite(v)), default=0.0)
                 for column in zip(*self.rows, strict=True)]
        return [[_written(value, size) for value, size in zip(row, sizes, strict=True)] for row in self.rows]


def _missing(value: Any) -> bool:
    return value is None or (isinstance(value, float) and np.isnan(value))


def _written(value: Any, size: float) -> str:
    """Return a figure with four digits, zero for the round-off of a column, a name as it is, a dash for nothing."""
    if _missing(value):
        return "–"
    if isinstance(value, float):
        value = 0.0 if abs(value) < _ZERO * size else value
        return f"{value + 0.0:.0f}" if 1e4 <= abs(value) < _PLAIN else f"{value + 0.0:.4g}"
    return str(value)
