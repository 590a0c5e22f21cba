"""What readers of the gallery do not see: checks, the time that is taken, and the figures that are
for programs.

Sources and downloads keep them; pages lose statements that only check or collect, and the last line
that a script prints; warnings lose the path of the machine that built them. What is left is laid
out for the width of a page."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import textwrap
from collections.abc import Collection

import skfem_contact.plot as plot

#: Characters of a line of code on a page.
WIDTH = 92
#: A block of code, an output without lines, a last section without content, and the last line of a
#: script.
CODE = re.compile(r"^\.\. code-block:: Python\n\n\n?((?:(?: {4}.*)?\n)+)", re.MULTILINE)
SILENT = re.compile(
    r"^ ?\.\. rst-class:: sphx-glr-script-out\n\n ?\.\. code-block:: none\n\s*\n(?=\S)",
    re.MULTILINE,
)
NOTHING = re.compile(
    r"^(Figures|Checks)\n-+\n\s*\n(?=(?:\.\. GENERATED.*\n\s*)*\.\. rst-class:: sphx-glr-timing)",
    re.MULTILINE,
)
FIGURES = re.compile(r'^ +\{"case": .*\}$\n?', re.MULTILINE)
#: A warning with the path and the line of code of its place.
WARNING = re.compile(r"^( *)\S+\.py:\d+: (\w*Warning: .*)\n\1  .*\n", re.MULTILINE)
#: Statements that collect figures, by their beginning.
COLLECTS = re.compile(
    r"(rows\b|(begin|cpu\w*|cpu, \w+) = |print\(json\.dumps|import json$"
    r"|from time import process_time$)"
)

#: Imports that go as well unless something that stays uses them, as it is written there.
IMPORTS = {"import json": "json.", "from time import process_time": "process_time()"}


def needed(code: str) -> list[str]:
    """Imports that are used by what stays of the code of a page."""
    left = without_checks(code)
    return [line for line, use in IMPORTS.items() if use in left]


def without_checks(code: str, kept: Collection[str] = ()) -> str:
    """Code without assertions and without what collects figures; comments that stand above them go
    as well."""
    try:
        body = ast.parse(code).body
    except SyntaxError:
        return code
    lines = code.split("\n")
    for node in reversed(body):
        text = "\n".join(lines[node.lineno - 1 : node.end_lineno])
        if isinstance(node, ast.Assert) or (COLLECTS.match(text) and text not in kept):
            first = node.lineno - 1
            while first > 0 and lines[first - 1].startswith("#"):
                first -= 1
            del lines[first : node.end_lineno]
    return re.sub(r"  $", "", "\n".join(lines), flags=re.MULTILINE).strip("\n")


def narrow(code: str) -> str:
    """The code with lines that fit a page, where a formatter is installed; comments and docstrings
    are wrapped."""
    if all(len(line) <= WIDTH for line in code.split("\n")):
        return code
    lines: list[str] = []
    for line in code.split("\n"):
        indent = line[: len(line) - len(line.lstrip())]
        prose = {"# ": f"{indent}# ", '""': indent}.get(line.lstrip()[:2])
        wrapped = textwrap.wrap(
            line.strip(), WIDTH, initial_indent=indent, subsequent_indent=prose or ""
        )
        lines += [line] if prose is None or len(line) <= WIDTH else wrapped
    command = [
        sys.executable,
        "-m",
        "ruff",
        "format",
        "--isolated",
        "--line-length",
        str(WIDTH),
        "-",
    ]
    done = subprocess.run(command, input="\n".join(lines), capture_output=True, text=True)
    return done.stdout.strip("\n") if done.returncode == 0 and done.stdout else "\n".join(lines)


def for_readers(app, name: str, source: list[str]) -> None:
    """Take out of a gallery page what is not for readers."""
    if not name.startswith("gallery/"):
        return

    kept = needed("\n".join(map(textwrap.dedent, CODE.findall(source[0]))))

    def shown(match: re.Match) -> str:
        code = narrow(without_checks(textwrap.dedent(match.group(1)), kept))
        return (
            f".. code-block:: Python\n\n{textwrap.indent(code, '    ')}\n\n\n"
            if code.strip()
            else "\n"
        )

    text = CODE.sub(shown, WARNING.sub(r"\1\2\n", FIGURES.sub("", source[0])))
    source[0] = NOTHING.sub("", SILENT.sub("", text))


def reset_units(gallery_conf, name: str) -> None:
    """Units that an example has set are its own."""
    plot.set_units()


def setup(app):
    """Register the extension."""
    app.connect("source-read", for_readers)
    return {"parallel_read_safe": True}
