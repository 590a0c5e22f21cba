"""Ten tasks of every day are short: at most 40 lines of code each."""

from __future__ import annotations

import ast
import io
import tokenize
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
LINES = 40
#: Tasks and the examples that do them, with figures asserted against a hand calculation or bounds.
TASKS = {
    "anchored wall": "4_pits_and_walls/plot_anchored_wall",
    "strip with bearing capacity and bounds": "5_foundations_and_piles/plot_strip_bearing",
    "slope with phreatic and piezometric lines": "3_slopes/plot_slope_with_water",
    "gravity wall with sliding and overturning": "4_pits_and_walls/plot_gravity_wall",
    "tunnel with trough": "6_tunnels_and_pipes/plot_tunnel_trough",
    "embankment with factor in time": "7_water_and_consolidation/plot_embankment_factor",
    "laterally loaded pile by curves": "5_foundations_and_piles/plot_pile_by_curves",
    "mesh from another program": "1_first_steps/plot_block_on_sand",
    "eccentric footing with uplift": "5_foundations_and_piles/plot_footing_uplift",
    "own law and output": "9_extending/plot_own_joint",
}
_NO_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}


def lines_of_code(source: str) -> int:
    """Return the number of lines with code: without comments, docstrings and empty lines."""
    documented: set[int] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef) and ast.get_docstring(
            node
        ):
            text = node.body[0]
            documented.update(range(text.lineno, (text.end_lineno or text.lineno) + 1))
    code: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in _NO_CODE:
            code.update(range(token.start[0], token.end[0] + 1))
    return len(code - documented)


def test_lines_without_code_do_not_count() -> None:
    """[X] Three lines of code among comments, docstrings and empty lines."""
    source = '"""Title\n\nText."""\n\n# comment\nx = [\n    1,  # one\n]\n'
    assert lines_of_code(source) == 3


@pytest.mark.parametrize("task", TASKS)
def test_task_takes_at_most_forty_lines(task: str) -> None:
    """[X] The example of each task is short, and asserts its figures."""
    source = (EXAMPLES / f"{TASKS[task]}.py").read_text(encoding="utf-8")
    assert lines_of_code(source) <= LINES
    assert "assert " in source
