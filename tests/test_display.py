"""What notebooks show: tables and progress bars."""

from __future__ import annotations

import sys

import numpy as np

from skfem_contact.display import progress_bar
from skfem_contact.results import Result, StageResult


class Terminal:
    """An output that somebody looks at, or nobody does."""

    def __init__(self, seen):
        self.seen, self.text = seen, ""

    def isatty(self):
        return self.seen

    def write(self, text):
        self.text += text

    def flush(self):
        pass


def test_bars_are_shown_where_somebody_looks_on(monkeypatch):
    for seen, wish, shown in (
        (True, None, True),
        (False, None, False),
        (True, False, False),
        (False, True, True),
    ):
        terminal = Terminal(seen)
        monkeypatch.setattr(sys, "stderr", terminal)
        with progress_bar(wish, desc="gravity", total=1.0, file=terminal) as bar:
            bar.update(1.0)
        assert ("gravity" in terminal.text) == shown


def test_results_are_tables_in_notebooks():
    stage = StageResult(
        "dig & fill", np.zeros(2), np.zeros(2), {}, (3, 4), 1e-9, 1.0, {"soil": "2.0% yielded"}
    )
    table = Result((stage,))._repr_html_()
    assert '<td style="text-align:left">dig &amp; fill</td>' in table
    assert ">7</td>" in table and "soil: 2.0% yielded" in table
