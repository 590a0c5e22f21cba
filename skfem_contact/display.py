"""Output in terminals and notebooks: progress bars and tables."""
from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

from tqdm.auto import tqdm


def progress_bar(show: bool | None, **options: Any) -> Any:
    """Return a bar of tqdm, as a widget in a notebook; shown by default in terminals and notebooks."""
    if show is None:
        show = sys.stderr.isatty() or any(cls.__module__ == "tqdm.notebook" for cls in tqdm.__mro__)
    return tqdm(disable=not show, **options)


def html_table(head: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "") -> str:
    """Format a table of texts and figures as HTML, figures aligned on the right."""
    def cell(value: object) -> str:
        text = str(value)
        side = "right" if text[:1].lstrip("-−").isdigit() or text in ("", "–", "inf") else "left"
        return f'<td style="text-align:{side}">{escape(text)}</td>'

    body = "".join(f"<tr>{''.join(map(cell, row))}</tr>" for row in rows)
    above = f"<caption>{escape(caption)}</caption>" if caption else ""
    return (f"<table>{above}<thead><tr>{''.join(f'<th>{escape(title)}</th>' for title in head)}</tr></thead>"
            f"<tbody>{body}</tbody></table>")
