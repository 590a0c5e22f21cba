"""Lint of the prose: docstrings, comments and messages of the package, the pages and the README.

    python -m tests.prose [root folder] [part of a path ...]

A line is printed for every finding, and the exit status is 1 if there is one.  Code, mathematics,
tables and the lines of doctests are not prose.  Four rules hold: a docstring begins with a noun of
the field or a verb (ruff's rule D401 asks for the imperative in functions); a standard term stands
before a private one; old names are gone; sentences are short.
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
LONGEST = 22.0  # mean number of words in the sentences of a page, or of a room of the package
#: Pages that record the past keep its words.
_RECORDS = ("CHANGELOG.md", "docs/changelog.md")
_GENERATED = ("docs/_build", "docs/gallery", "docs/reference/generated")

_NEVER_FIRST = """
    what whether those that as where how which who whose why when is are was does do it its they
    them this these and but or not never nothing everything one's same from with by on of at if so
    because while here there more less other own
"""
#: No docstring begins with these.
NEVER_FIRST = frozenset(_NEVER_FIRST.split())

#: Private terms and the standard ones.  Ordinary meanings of a word are left out by what stands
#: beside it.
WORDS = {
    r"unknowns|(?:an|the|each|every|first|free|per|of) unknown": "dofs",
    r"(?<!decimal )(?<!takes )(?<!take )(?<!took )(?<!takes its )places": "coordinates",
    r"(?<!in )(?<!takes )(?<!take )(?<!taking )(?<!takes its )(?<!take its )(?<!took its )"
    r"(?<!decimal )(?<!taken )"
    r"(?<!to )(?<!one )place(?! the| a | it| them|holder)": "coordinates, position",
    r"behind the (?:displacements|dofs|unknowns)": "after the displacements",
    r"(?:is|are|was|were|be|being|has been) (?:not )?there"
    r"(?! (?:is|are|was|were|a|an|no|any|one)\b)|not there": "active, inactive",
    r"go(?:es|ing)? on(?: and on)?(?: otherwise)?|went on": "continues",
    r"answers?|answered|answering": "response, return value",
    r"tells?|told|telling": "reported",
    r"carry|carries|carried|bears?(?! (?:wall|plate))|borne": "resist, transfer, internal force",
    r"hangs? on|hanging on|hung on": "depends on",
    r"eas(?:ed|es|ing|ier)": "regularised, regularisation",
    r"moved back": "rebased",
    r"first geometry|held state": "linearised contact, fixed geometry",
    r"gives? way|gave way|giving way": "penalty compliance, yields",
    r"jacked|jacking": "prestressed",
    r"wetted": "submerged",
    r"stands?(?! for\b)": "is stable, is",
    r"tol": "tolerance",
    r"whereabouts|willy-nilly|the house|knows of": "plain words",
}
#: Old names, in code as well.
NAMES = {
    "RigidFooting": "RigidBoundary",
    "SpaceSectionForces": "SectionForces",
    "FirstGeometry": "linearised contact",
    "HeldState": "linearised contact",
    "Easing": "regularisation",
    "Answers": "a base class",
    "unknowns_at": "dofs_at",
    "reset_displacements": "reset",
    "goes_on": "continues",
    "goes_on_otherwise": "state_changes",
    "moved_back": "rebased",
    "first_geometry": "fixed_geometry",
    "all_unknowns": "Layout",
    "jacked": "prestressed",
    "Kw": "bulk_modulus_water",
    "first_behind": "Layout",
}
_WORDS = {
    re.compile(rf"(?<![\w.'’-])(?:{pattern})(?![\w-])", re.IGNORECASE): then
    for pattern, then in WORDS.items()
}
_NAMES = re.compile(rf"(?<!\w)({'|'.join(NAMES)})(?!\w)")
_CODE = re.compile(r"(?::\w+:|\{\w+\})?(`+)(?:(?!\1).)+\1_*|\$\$.*?\$\$|\$[^$]+\$", re.DOTALL)
_HEADINGS = re.compile(
    r"^\s*(Parameters|Returns|Yields|Raises|Warns|Attributes|See Also|Notes|Examples"
    r"|References)\s*$"
)
_FIELDS = ("Parameters", "Attributes", "Returns", "Yields", "Raises", "Warns", "See Also")


class Finding(NamedTuple):
    """A place in a file and what is wrong there."""

    path: str
    line: int
    word: str
    advice: str

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.word}: {self.advice}"


Line = tuple[int, str]  # its number and its text; an empty one ends a sentence


def without_code(lines: list[Line]) -> list[Line]:
    """Replace inline code and mathematics, which may run over several lines, by `X` and keep the
    numbers of lines.
    """
    text = _CODE.sub(
        lambda match: "X" + "\n" * match[0].count("\n"), "\n".join(line for _, line in lines)
    )
    return [(number, line) for (number, _), line in zip(lines, text.split("\n"), strict=True)]


def prose_of_docstring(text: str, first: int) -> list[Line]:
    """Keep the prose of a docstring: no code, no formula, no name of a parameter, no rule."""
    found: list[Line] = []
    section, margin, skipped = "", None, None
    lines = text.split("\n")
    indents = [len(line) - len(line.lstrip()) for line in lines[1:] if line.strip()]
    base = min(indents, default=0)
    for number, line in enumerate(lines, first):
        indent, bare = len(line) - len(line.lstrip()), line.strip()
        if skipped is not None and (not bare or indent > skipped):
            found.append((number, ""))
            continue
        skipped = None
        if heading := _HEADINGS.match(line):
            section = heading[1]
        if bare.startswith(">>>"):
            margin = indent  # code and its output, up to the next empty line
        elif not bare:
            margin = None
        named = section in _FIELDS and indent == base and number > first
        if (
            heading
            or margin is not None
            or named
            or not bare.strip("-=")
            or re.match(r"\.\. (math|code)", bare)
        ):
            found.append((number, ""))
        else:
            found.append((number, bare.removesuffix("::")))
        if bare.endswith("::"):
            skipped = indent
    return without_code(found)


def prose_of_page(text: str) -> list[Line]:
    """Keep the prose of a page: no code, table, picture, directive or formula, and links by their
    texts.
    """
    found: list[Line] = []
    fence = ""
    for number, line in enumerate(text.split("\n"), 1):
        bare = line.strip()
        mark = re.match(r"(`{3,}|:{3,}|\${2})", bare)
        if fence:
            if bare.endswith(fence) and (fence == "$$" or not bare.strip(fence[0])):
                fence = ""
            bare = ""
        elif mark and not (mark[1] == "$$" and bare.count("$$") > 1):
            fence = "" if mark[1][0] == ":" else mark[1]  # the text within ::: is prose
            bare = ""
        elif bare.startswith(("|", "<", "![", "[!", "#", "%", ":")):
            bare = ""
        bare = re.sub(r"!?\[([^\]]*)\](\([^)]*\))?", r"\1", bare)
        if re.match(r"([-*+]|\d+\.) ", bare):  # every item begins a sentence
            found.append((number, ""))
        found.append((number, bare))
    return without_code(found)


def sentences(lines: list[Line]) -> Iterator[int]:
    """Yield the number of words of every sentence."""
    paragraph: list[str] = []
    for _, line in [*lines, (0, "")]:
        if line:
            paragraph.append(line)
            continue
        for sentence in re.split(r"(?<=[.!?])[*_)]*\s+(?=[^a-z\s])", " ".join(paragraph)):
            if words := len(re.findall(r"[^\W_][\w'’.-]*", sentence)):
                yield words
        paragraph = []


def words_of(path: str, lines: list[Line]) -> Iterator[Finding]:
    """Yield the private terms, also those that run over the end of a line."""
    text = "\n".join(line for _, line in lines)
    in_a_row = re.sub(r"\s", " ", text)
    for pattern, then in _WORDS.items():
        for match in pattern.finditer(in_a_row):
            number = lines[text.count("\n", 0, match.start())][0]
            yield Finding(path, number, match[0], f"say {then}")


def first_word(path: str, line: int, text: str) -> Iterator[Finding]:
    """Yield what is wrong with the beginning of a docstring."""
    summary = text.strip().split("\n\n")[0]
    word = re.sub(r"[^\w'-].*", "", summary.split()[0]) if summary else ""
    if not word or word.lower() in NEVER_FIRST:
        advice = "a docstring begins with a verb, or with a noun of the field"
        yield Finding(path, line, word or "(empty)", advice)
    if summary.rstrip().endswith("?"):
        yield Finding(path, line, "?", "a docstring is no question")


class Module:
    """Prose of a file of the package, in its three kinds."""

    def __init__(self, path: str, source: str) -> None:
        self.path, self.docstrings, self.findings = path, [], []
        nodes, own = list(ast.walk(ast.parse(source))), set()
        for node in nodes:
            body = getattr(node, "body", None)
            if (
                not isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))
                or not body
                or not isinstance(body[0], ast.Expr)
                or not isinstance(body[0].value, ast.Constant)
            ):
                continue
            doc = body[0].value
            if isinstance(doc.value, str):
                own.add(id(doc))
                self.docstrings.append(prose_of_docstring(doc.value, doc.lineno))
                self.findings += first_word(path, doc.lineno, doc.value)
        self.messages = list(self._messages(nodes, own))
        self.comments = [
            [
                (
                    token.start[0],
                    re.sub(r"^#:?\s*|\bfmt: skip|\b(noqa|type: ignore).*", "", token.string),
                )
            ]
            for token in tokenize.generate_tokens(io.StringIO(source).readline)
            if token.type == tokenize.COMMENT
        ]
        for lines in (*self.docstrings, *self.messages, *map(without_code, self.comments)):
            self.findings += words_of(path, lines)
        self.findings += names_of(path, source)

    @staticmethod
    def _messages(nodes: list[ast.AST], docstrings: set[int]) -> Iterator[list[Line]]:
        inside: set[int] = set()
        for node in nodes:
            if isinstance(node, ast.JoinedStr):
                inside |= {id(part) for part in ast.walk(node)} - {id(node)}
                text = "".join(
                    str(part.value) if isinstance(part, ast.Constant) else "X"
                    for part in node.values
                )
            elif (
                isinstance(node, ast.Constant)
                and isinstance(node.value, str)
                and id(node) not in docstrings | inside
            ):
                text = node.value
            else:
                continue
            if text.strip().count(" ") > 0:
                yield without_code([(node.lineno, line) for line in text.split("\n")])


def names_of(path: str, source: str) -> Iterator[Finding]:
    """Yield old names, wherever they are."""
    for number, line in enumerate(source.split("\n"), 1):
        for match in _NAMES.finditer(line):
            yield Finding(path, number, match[0], f"the name is now {NAMES[match[0]]}")


def too_long(path: str, lengths: list[int]) -> Iterator[Finding]:
    """Yield a finding if the mean sentence of a page or a room is too long."""
    mean = sum(lengths) / max(len(lengths), 1)
    if mean >= LONGEST:
        yield Finding(path, 1, f"{mean:.1f} words in the mean sentence", f"less than {LONGEST:.0f}")


def findings(root: Path = ROOT, parts: tuple[str, ...] = ("",)) -> list[Finding]:
    """Check the package, the pages and the README below a folder, as far as their paths hold one of
    the parts.
    """
    found: list[Finding] = []
    rooms: dict[str, list[int]] = {}
    for file in sorted((root / "skfem_contact").rglob("*.py")):
        path = file.relative_to(root).as_posix()
        if any(part in path for part in parts):
            module = Module(path, file.read_text(encoding="utf-8"))
            found += module.findings
            room = path if path.count("/") == 1 else path.rsplit("/", 1)[0]
            rooms.setdefault(room, []).extend(
                n for lines in module.docstrings for n in sentences(lines)
            )
    for room, lengths in rooms.items():
        found += too_long(room, lengths)
    for file in (*sorted(root.glob("*.md")), *sorted((root / "docs").rglob("*.md"))):
        path = file.relative_to(root).as_posix()
        if (
            any(part in path for part in parts)
            and path not in _RECORDS
            and not path.startswith(_GENERATED)
        ):
            source = file.read_text(encoding="utf-8")
            lines = prose_of_page(source)
            found += [
                *words_of(path, lines),
                *names_of(path, source),
                *too_long(path, list(sentences(lines))),
            ]
    return sorted(set(found))


def main(arguments: list[str]) -> int:
    """Print the findings, and return the exit status."""
    root = Path(arguments[0]) if arguments and Path(arguments[0]).is_dir() else None
    found = findings(root or ROOT, tuple(arguments[root is not None :]) or ("",))
    print(*found, sep="\n", end="\n" if found else "")
    print(f"{len(found)} findings", file=sys.stderr)
    return bool(found)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
