"""Tables that notebooks show."""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


def html_table(head: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "") -> str:
    """A table of texts and figures in HTML; figures stand on the right.

    Examples
    --------
    >>> html_table(["stage", "load"], [["dig & fill", "100%"]])
    '<table><thead><tr><th>stage</th><th>load</th></tr></thead><tbody>...dig &amp; fill...</tbody></table>'
    """
    def cell(value: object) -> str:
        text = str(value)
        side = "right" if text[:1].lstrip("-−").isdigit() or text in ("", "–", "inf") else "left"
        return f'<td style="text-align:{side}">{escape(text)}</td>'

    body = "".join(f"<tr>{''.join(map(cell, row))}</tr>" for row in rows)
    above = f"<caption>{escape(caption)}</caption>" if caption else ""
    return (f"<table>{above}<thead><tr>{''.join(f'<th>{escape(title)}</th>' for title in head)}</tr></thead>"
            f"<tbody>{body}</tbody></table>")
