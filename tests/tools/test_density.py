"""The table of how densely packages are written."""

from __future__ import annotations

from pathlib import Path

from tests.tools.density import Count

SOURCE = '''"""What stands there: those of it."""
# a comment
def f(x, y):
    """Add numbers."""
    a, b = x, y
    c = a if b else [k for k in y if k]
    for k in c:
        if k and x:
            c = k
    return c
'''


def test_figures_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text(SOURCE)
    (tmp_path / "test_a.py").write_text("x, y = 1, 2\n")
    assert Count(tmp_path).figures() == {
        "tokens": 45,
        "tokens a line": 6.4,
        "dense functions": 0.0,
        "expressions": 2.0,
        "tuple assignments": 33.3,
        "complexity > 10": 0,
        "at most": 6,
        "comments": 22.2,
        "phrases": 3750.0,
    }
