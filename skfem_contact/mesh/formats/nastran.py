"""Bulk data of Nastran: .bdf, .nas, .dat."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ..content import Content, decoded, members_by_tag, numbers_of, read_included, read_text, to_vtk
from ..kinds import UPRIGHT_FIRST

#: Kinds of elements by card and number of nodes.
_CARDS = {
    "CTRIA3": {3: "triangle"},
    "CTRIA6": {6: "triangle6"},
    "CTRIAR": {3: "triangle"},
    "CPLSTN3": {3: "triangle"},
    "CPLSTN4": {4: "quad"},
    "CPLSTN6": {6: "triangle6"},
    "CPLSTN8": {8: "quad8"},
    "CQUAD4": {4: "quad"},
    "CQUADR": {4: "quad"},
    "CQUAD8": {8: "quad8"},
    "CQUAD": {4: "quad", 8: "quad8", 9: "quad9"},
    "CTETRA": {4: "tetra", 10: "tetra10"},
    "CPYRAM": {5: "pyramid", 13: "pyramid13"},
    "CPENTA": {6: "wedge", 15: "wedge15"},
    "CHEXA": {8: "hexahedron", 20: "hexahedron20"},
    "CBAR": {2: "line"},
    "CBEAM": {2: "line"},
    "CROD": {2: "line"},
}
#: Starts of the names of cards of elements.
_STARTS = ("CTRI", "CTRAX", "CPLST", "CQUAD", "CTETRA", "CPYR", "CPENTA", "CHEX")
#: Files that are included, in quotation marks or without, and how deep.
_INCLUDE = re.compile(r"""^[ \t]*INCLUDE[ \t]+['"]?([^'"\n]+)['"]?[ \t]*$""", re.M | re.I)
_DEEPEST = 8
#: Names of properties in comments: of HyperMesh, whose components precede properties, of ANSA, of
#: Femap, and of Patran and Simcenter, which write the name before the card.
_NAMES = tuple(
    re.compile(pattern, re.M | re.I)
    for pattern in (
        r'^\$HMNAME\s+COMP\s+(?P<number>\d+)\s*"(?P<name>[^"]+)"',
        r'^\$HMNAME\s+PROP\s+(?P<number>\d+)\s*"(?P<name>[^"]+)"',
        r"^\$ANSA_NAME_COMMENT;(?P<number>\d+);P\w+;(?P<name>[^;\n]+)",
        r"^\$ *FEMAP\b[^:\n]*\bProperty +(?P<number>\d+) *: *(?P<name>.*\S)",
        r"^\$(?: Elements and Element Properties for region|\* +Property) *: *(?P<name>.*\S)\s*\n"
        r"(?:\$.*\n)*P\w+\*?[ ,]+(?P<number>\d+)",
    )
)
#: Numbers of corners of bodies.
_CORNERS = {"CTETRA": 4, "CPYRAM": 5, "CPENTA": 6, "CHEXA": 8}


def read(path: str) -> Content:
    """Read grid points and elements; properties are groups."""
    text = _text(read_text(path), Path(path), 0)
    ids = []
    points = []
    cells: dict[str, list[list[int]]] = {}
    properties: dict[str, list[int]] = {}
    left_out: set[str] = set()
    # Read points and elements.
    for card in _cards(text):
        if card[0] == "GRID":
            ids.append(_integer(card[1]))
            points.append(_point(card))
        elif card[0] in _CARDS:
            kind, nodes = _nodes(card)
            cells.setdefault(kind, []).append(nodes)
            properties.setdefault(kind, []).append(_integer(card[2] or card[1]))
        elif card[0] == "GRDSET":
            _check_system(card, "GRDSET gives")
        elif card[0].startswith("="):
            raise ValueError(f"it repeats cards by '{card[0]}', which is not read: write them out")
        elif card[0].startswith(_STARTS):
            left_out.add(f"elements {card[0]}")
    if not ids or not cells:
        raise ValueError("it is not bulk data of Nastran: it has no GRID or no elements")
    # Number the nodes, and name elements by their properties.
    names = _names(text)
    content = Content(np.array(points), {}, left_out=sorted(left_out))
    for kind, rows_of in cells.items():
        numbers = numbers_of(np.array(ids), np.array(rows_of, dtype=int), "grid point")
        content.cells[kind] = to_vtk(numbers, UPRIGHT_FIRST.get(kind))
        for tag, members in members_by_tag(np.array(properties[kind])).items():
            content.add(names.get(tag, f"property {tag}"), kind, members)
    return content


def _text(text: bytes, path: Path, depth: int) -> str:
    """Return the text of a file with the texts of the files that it includes."""
    if depth > _DEEPEST:
        raise ValueError(f"its INCLUDE are nested more than {_DEEPEST} times")

    def included(match: re.Match[str]) -> str:
        other = path.parent / match[1].strip()
        return _text(read_included(other), other, depth + 1)

    return _INCLUDE.sub(included, decoded(text).replace("\r\n", "\n"))


def _names(text: str) -> dict[int, str]:
    """Return the names of properties, which preprocessors write into comments."""
    names: dict[int, str] = {}
    for pattern in _NAMES:
        for match in pattern.finditer(text):
            names.setdefault(int(match["number"]), match["name"].strip())
    # A name of several properties, as "Untitled", has their numbers behind it.
    count = Counter(names.values())
    for number, name in names.items():
        if count[name] > 1:
            names[number] = f"{name} {number}"
    return names


def _point(card: list[str]) -> list[float]:
    """Return the coordinates of a grid point."""
    _check_system(card, f"grid point {card[1]} has")
    coordinates = [*card[3:6], "", "", ""][:3]
    return [_number(word) for word in coordinates]


def _check_system(card: list[str], subject: str) -> None:
    if card[2] not in ("", "0"):
        raise ValueError(
            f"{subject} coordinates of the system {card[2]}; only the basic system is read: "
            "write the grid points in it"
        )


def _cards(text: str) -> Iterator[list[str]]:
    """Yield the fields of every card; a continuation begins with blanks, "+" or "*"."""
    # Begin after the case control.
    begin = re.search(r"^\s*BEGIN\s+(BULK|SUPER).*$", text, re.M | re.I)
    if begin:
        text = text[begin.end() :]
    lines = text.split("\n")
    card: list[str] = []
    for line in lines:
        # Drop comments, and end at the last card.
        line = line.split("$", 1)[0].rstrip()
        if not line.strip():
            continue
        if line.strip().upper().startswith("ENDDATA"):
            break
        fields = _fields(line)
        # A continuation adds to the card before.
        if fields[0] in ("", "+", "*") or fields[0][0] in "+*":
            card += fields[1:]
            continue
        if card:
            yield card
        card = [fields[0].upper().rstrip("*"), *fields[1:]]
    if card:
        yield card


def _fields(line: str) -> list[str]:
    """Return the name and the fields of a line: free, or in columns of 8 or 16."""
    if "," in line:
        words = [word.strip() for word in line.split(",")]
        count = 8
        if "*" in words[0]:
            count = 4
        return [*words, *[""] * count][: 1 + count]
    line = line.expandtabs(8)
    width = 8
    if "*" in line[:8]:
        width = 16
    count = 8
    if width == 16:
        count = 4
    words = [line[8 + k * width : 8 + (k + 1) * width].strip() for k in range(count)]
    return [line[:8].strip(), *words]


def _nodes(card: list[str]) -> tuple[str, list[int]]:
    """Return kind and nodes of an element; nodes in the middle of edges may be blank."""
    name = card[0]
    kinds = _CARDS[name]
    most = max(kinds)
    if name in _CORNERS and any(card[3 + most :]):
        raise ValueError(
            f"{name} {card[1]} has more than {most} nodes, which is no Nastran: in Gmsh, set "
            "Mesh.SecondOrderIncomplete = 1"
        )
    # Elements have the nodes of all edges, or of none.
    words = [*card[3:], *[""] * most][:most]
    given = sum(map(bool, words))
    count = _CORNERS.get(name, min(kinds))
    if given == most or (name == "CQUAD" and given in kinds):
        count = given
    if not all(words[:count]):
        raise ValueError(f"{name} {card[1]} has {given} nodes, but needs {count}")
    if given != count and name in _CORNERS:
        raise ValueError(f"{name} {card[1]} has some, but not all of the nodes of its edges")
    return kinds[count], [_integer(word) for word in words[:count]]


def _integer(word: str) -> int:
    if not word.lstrip("+-").isdigit():
        raise ValueError(f"'{word}' is not a whole number")
    return int(word)


def _number(word: str) -> float:
    """Return a number, whose exponent may have no letter: "1.5-3"."""
    if not word:
        return 0.0
    text = re.sub(r"(?<=[\d.])([+-]\d+)$", r"e\1", word.lower().replace("d", "e"))
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"'{word}' is not a number") from None
