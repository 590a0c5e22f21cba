"""How densely packages are written, one column for each folder of a package.

    python -m tests.tools.density skfem_contact [folder ...]

tokens              names, numbers, strings and operators of the code, without docstrings
tokens a line       tokens over the lines that hold any
dense functions     functions of six lines or more with over 15 tokens a line, per cent
expressions         decisions in expressions (conditional expressions, comprehensions and their
                    conditions, and/or) over decisions in statements (if, for, while, except, with)
tuple assignments   assignments ``a, b = x, y``, per cent
complexity > 10     functions with more than ten decisions, in statements or expressions
at most             largest number of decisions in a function
comments            per 1000 tokens
phrases             "those of", "that of", "beside", "what", "there" per 10,000 words of docstrings
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
from collections import Counter
from pathlib import Path

STATEMENT = (ast.If, ast.For, ast.While, ast.ExceptHandler, ast.With, ast.Match, ast.Assert)
CODE = (tokenize.NAME, tokenize.NUMBER, tokenize.OP, tokenize.STRING)
PHRASES = r"\b(?:those (?:of|that|with|which)|that of|beside|what|there)\b"
SHORTEST, DENSE, MANY = 6, 15, 10


def decisions(node: ast.AST) -> tuple[int, int]:
    """Count the decisions of a node in expressions and in statements."""
    inside = outside = 0
    for part in ast.walk(node):
        if isinstance(part, ast.IfExp):
            inside += 1
        elif isinstance(part, ast.comprehension):
            inside += 1 + len(part.ifs)
        elif isinstance(part, ast.BoolOp):
            inside += len(part.values) - 1
        elif isinstance(part, STATEMENT):
            outside += 1
    return inside, outside


class Count:
    """Sums over the files of a package; test modules are left out."""

    def __init__(self, folder: Path) -> None:
        self.tokens = self.lines = self.comments = self.inside = self.outside = 0
        self.assignments = self.tuples = 0
        self.is_dense: list[bool] = []
        self.sizes: list[tuple[int, str]] = []
        self.docstrings: list[str] = []
        for file in sorted(folder.rglob("*.py")):
            name = file.relative_to(folder)
            if "tests" not in name.parts and not file.name.startswith("test_"):
                self.add(name.as_posix(), file.read_text(encoding="utf-8"))

    def add(self, name: str, source: str) -> None:
        """Add a file."""
        tree = ast.parse(source)
        of_docstrings = self.add_docstrings(tree)

        # Count the tokens of each line.
        of_line: Counter[int] = Counter()
        for token in tokenize.generate_tokens(io.StringIO(source).readline):
            line = token.start[0]
            if line not in of_docstrings:
                of_line[line] += token.type in CODE
                self.comments += token.type == tokenize.COMMENT
        of_line = +of_line
        self.tokens += of_line.total()
        self.lines += len(of_line)

        inside, outside = decisions(tree)
        self.inside += inside
        self.outside += outside
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign):
                target, value = node.targets[0], node.value
                self.assignments += 1
                self.tuples += isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
            elif isinstance(node, ast.FunctionDef):
                body = range(node.body[0].lineno, (node.end_lineno or 0) + 1)
                counts = [of_line[line] for line in body if of_line[line]]
                if len(counts) >= SHORTEST:
                    self.is_dense.append(sum(counts) > DENSE * len(counts))
                self.sizes.append((sum(decisions(node)), f"{name}:{node.lineno} {node.name}"))

    def add_docstrings(self, tree: ast.Module) -> set[int]:
        """Keep the docstrings of a file, and return their lines."""
        lines: set[int] = set()
        for node in ast.walk(tree):
            if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
                text = ast.get_docstring(node)
                if text:
                    self.docstrings.append(text)
                    lines.update(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
        return lines

    def figures(self) -> dict[str, float]:
        """Compute the rows of the table."""
        text = " ".join(self.docstrings).lower()
        words = len(re.findall(r"[a-z]+", text))
        sizes = [size for size, _ in self.sizes] or [0]
        return {
            "tokens": self.tokens,
            "tokens a line": round(self.tokens / max(self.lines, 1), 1),
            "dense functions": round(100 * sum(self.is_dense) / max(len(self.is_dense), 1), 1),
            "expressions": round(self.inside / max(self.outside, 1), 2),
            "tuple assignments": round(100 * self.tuples / max(self.assignments, 1), 1),
            "complexity > 10": sum(size > MANY for size in sizes),
            "at most": max(sizes),
            "comments": round(1000 * self.comments / max(self.tokens, 1), 1),
            "phrases": round(1e4 * len(re.findall(PHRASES, text)) / max(words, 1), 1),
        }


def main(folders: list[str]) -> None:
    """Print the table, and the most complex functions of the first folder."""
    counts = {Path(folder).resolve().name: Count(Path(folder)) for folder in folders}
    columns = {name: count.figures() for name, count in counts.items()}
    print(f"{'':18}" + "".join(f"{name:>16}" for name in columns))
    for row in next(iter(columns.values())):
        print(f"{row:18}" + "".join(f"{figures[row]:>16,}" for figures in columns.values()))
    largest = sorted(next(iter(counts.values())).sizes, reverse=True)[:12]
    print("most decisions:", "; ".join(f"{name} {size}" for size, name in largest if size > MANY))


if __name__ == "__main__":
    main(sys.argv[1:] or ["skfem_contact"])
