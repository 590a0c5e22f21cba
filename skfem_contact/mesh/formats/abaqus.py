"""Input files of Abaqus and CalculiX: nodes, elements, sets, surfaces, parts and instances."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ..content import (
    Content,
    check_names,
    decoded,
    numbers_of,
    parsed,
    point_text,
    read_included,
    read_text,
    rows,
    to_vtk,
    whole,
    without_middles,
)
from ..find_sides import normals
from ..kinds import BY_NODES, KINDS, Floats, Integers

#: Nodes of bodies of 27 nodes in the order of VTK: the middle comes before the faces.
_ORDER = {"hexahedron27": [*range(20), 26, 24, 23, 25, 21, 22, 20]}
#: Dimensions of the elements of families, which are known by the start of their type.
_FAMILIES = (
    (r"C3D|DC3D|AC3D|SC[68]", 3),
    (r"CP[ES]|CGAX|CAX|CPEG|AC2D|DC2D|DCAX|STRI|SFM3D|M3D|S[3468]|R3D[34]|WARP2D|DS", 2),
    (r"T[23]D|B[23]|R2D|RAX|SAX|MAX", 1),
)
#: Local nodes of the faces of elements, by kind, from face 1 on (corners only, counted from 0).
_FACES = {
    "triangle": KINDS["triangle"].sides,
    "quad": KINDS["quad"].sides,
    "tetra": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "pyramid": ((0, 1, 2, 3), (0, 4, 1), (1, 4, 2), (2, 4, 3), (3, 4, 0)),
    "wedge": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
    "hexahedron": (
        (0, 1, 2, 3),
        (4, 7, 6, 5),
        (0, 4, 5, 1),
        (1, 5, 6, 2),
        (2, 6, 7, 3),
        (3, 7, 4, 0),
    ),
}
#: Cards that make nodes or elements of others, or in other coordinates.
_MAKERS = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBSTRUCTURE")
#: Cards whose lines may be in a file of their own.
_LISTS = ("NODE", "ELEMENT", "NSET", "ELSET", "SURFACE")
_DEEPEST = 8
#: Most numbers of a line of a set that is generated.
_MOST = 10**8


@dataclass
class _Card:
    """Keyword with its parameters, and its lines of data."""

    keyword: str
    options: Mapping[str, str]
    data: bytes

    def flag(self, name: str) -> bool:
        """Return True if a parameter is given."""
        return name in self.options


@dataclass
class _Part:
    """Nodes, elements, sets and surfaces of a part or of the whole file."""

    ids: list[Integers] = field(default_factory=list)
    points: list[Floats] = field(default_factory=list)
    elements: list[tuple[str, Integers, Integers]] = field(default_factory=list)
    node_sets: dict[str, list[Integers]] = field(default_factory=dict)
    element_sets: dict[str, list[Integers]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    internal: set[str] = field(default_factory=set)
    left_out: set[str] = field(default_factory=set)
    spelled: dict[str, str] = field(default_factory=dict)

    def key(self, name: str) -> str:
        """Return a name without regard to capitals, and keep how it is spelled first."""
        name = name.strip().strip('"')
        self.spelled.setdefault(name.upper(), name)
        return name.upper()

    def named(self, sets: Mapping[str, list[Integers]]) -> Iterator[tuple[str, Integers]]:
        """Yield names and members of sets, without empty ones and internal ones of Abaqus."""
        for key, parts in sets.items():
            members = np.unique(np.concatenate([np.zeros(0, int), *parts]))
            if len(members) and key not in self.internal:
                yield self.spelled[key], members

    def coordinates(self) -> tuple[Integers, Floats]:
        """Return the numbers of the nodes and their coordinates."""
        if not self.ids:
            return np.zeros(0, int), np.zeros((0, 3))
        return np.concatenate(self.ids), np.concatenate(self.points)


#: Instances by name in capitals: shift of their numbers, and nodes and elements.
_Instances = Mapping[str, tuple[int, _Part]]


def read(path: str) -> Content:
    """Read an input file."""
    text = read_text(path)
    if not re.search(
        rb"^\s*\*NODE\b(?!\s*(PRINT|FILE|OUTPUT))", text, re.MULTILINE | re.IGNORECASE
    ):
        raise ValueError("it is not an input file of Abaqus or CalculiX: it has no *NODE")
    last = re.sub(rb"^\s*\*", b"", text[text.rfind(b"\n*") + 1 :])
    if not text.endswith(b"\n") and re.match(rb"(?i)(NODE|ELEMENT|NSET|ELSET|SURFACE)\b", last):
        raise ValueError(
            "it ends within a line of the mesh: it is not complete, or needs an empty line"
        )
    whole = _assembled(_cards(text, Path(path).parent, 0))
    return _content(whole)


def _cards(text: bytes, folder: Path, depth: int) -> Iterator[_Card]:
    """Yield the cards of a file, and of files that it includes."""
    if depth > _DEEPEST:
        raise ValueError(f"its *INCLUDE are nested more than {_DEEPEST} times")
    # Find the cards; lines of comments begin with two stars.
    text = _without_comments(text)
    marks = list(re.finditer(rb"^[ \t]*\*(?=[A-Za-z])", text, flags=re.MULTILINE))
    ends = [*(mark.start() for mark in marks[1:]), len(text)]
    for mark, end in zip(marks, ends):
        # Separate the line of a card from its data; a comma at its end continues it.
        line = text.find(b"\n", mark.end(), end)
        if line < 0:
            line = end
        head = text[mark.end() : line]
        data = text[line + 1 : end]
        while head.rstrip().endswith(b","):
            more, _, data = data.partition(b"\n")
            head += more
        # Read the keyword and its options.
        keyword, *parts = decoded(head).split(",")
        options = {}
        for part in parts:
            name, _, value = part.partition("=")
            options["".join(name.upper().split())] = value.strip()
        keyword = " ".join(keyword.upper().split())
        # Follow other files, of cards or of the lines of one.
        if keyword == "INCLUDE":
            yield from _cards(_included(folder, options), folder, depth + 1)
        elif keyword in _LISTS and "INPUT" in options:
            lines = _without_comments(_included(folder, options))
            yield _Card(keyword, options, lines + b"\n" + data)
        elif keyword in _MAKERS:
            raise ValueError(
                f"it makes nodes or elements by *{keyword}, which is not read: write the nodes and "
                "elements themselves"
            )
        else:
            yield _Card(keyword, options, data)


def _included(folder: Path, options: Mapping[str, str]) -> bytes:
    """Return the text of the file that a card names."""
    return read_included(folder / options.get("INPUT", "").strip('"'))


def _without_comments(text: bytes) -> bytes:
    """Return the lines of a text that are no comments, with ends as of Unix."""
    return re.sub(rb"^\*\*.*\n?", b"", text.replace(b"\r", b""), flags=re.MULTILINE)


def _assembled(cards: Iterator[_Card]) -> _Part:
    """Return the nodes and elements of a file, with the instances of its parts, moved."""
    whole = _Part()
    parts: dict[str, _Part] = {}
    instances: dict[str, tuple[int, _Part]] = {}
    target = whole
    shift = 0
    # Collect the parts, then place their instances.
    for card in cards:
        if card.keyword == "PART":
            target = parts[card.options.get("NAME", "").strip('"').upper()] = _Part()
        elif card.keyword in ("END PART", "END INSTANCE"):
            target = whole
        elif card.keyword == "INSTANCE":
            name = card.options.get("NAME", "").strip('"')
            part = parts.get(card.options.get("PART", "").strip('"').upper())
            if part is None:
                raise ValueError(f"the part of instance '{name}' does not exist")
            moved = _moved(part, card.data)
            shift = _append(whole, moved, name, shift)
            instances[name.upper()] = (shift, moved)
            shift += _span(moved)
        else:
            _read_card(target, card, instances)
    if parts and not instances and not whole.elements:
        raise ValueError(f"its parts {', '.join(parts)} have no *INSTANCE: add one to an *ASSEMBLY")
    return whole


def _span(part: _Part) -> int:
    """Return a number above all numbers of nodes and elements of a part."""
    numbers = [*part.ids, *(ids for _, ids, _ in part.elements)]
    return 1 + max((int(ids.max()) for ids in numbers if len(ids)), default=0)


def _moved(part: _Part, data: bytes) -> _Part:
    """Return a part moved by the lines of an instance: a translation, then a rotation.

    The rotation is by an angle in degrees about the axis from one point to another.
    """
    lines = [line for line in data.split(b"\n") if line.strip()]
    points = [np.array(x) for x in part.points]
    if lines:
        first = np.zeros(3)
        values = parsed(lines[0], "the lines of an instance", commas=True)
        first[: len(values)] = values[:3]
        points = [x + first for x in points]
    if len(lines) > 1:
        values = parsed(lines[1], "the lines of an instance", commas=True)
        if len(values) != 7:
            raise ValueError("the rotation of an instance needs two points and an angle")
        points = [_turned(x, values[:3], values[3:6], np.deg2rad(values[6])) for x in points]
    return replace(part, points=points)


def _turned(x: Floats, start: Floats, end: Floats, angle: float) -> Floats:
    """Return points turned about an axis, by the formula of Rodrigues."""
    axis = (end - start) / np.linalg.norm(end - start)
    r = x - start
    along = np.outer(r @ axis, axis)
    return start + along + np.cos(angle) * (r - along) + np.sin(angle) * np.cross(axis, r)


def _append(whole: _Part, part: _Part, name: str, shift: int) -> int:
    """Append an instance with numbers above all others; return the shift of its numbers.

    Its sets are known by their own names and by "instance.set".
    """
    # Number nodes and elements above all others.
    if whole.ids:
        shift = max(shift, _span(whole))
    whole.ids += [ids + shift for ids in part.ids]
    whole.points += part.points
    whole.elements += [(kind, ids + shift, nodes + shift) for kind, ids, nodes in part.elements]
    # The elements of an instance are a set, too.
    every = [ids + shift for _, ids, _ in part.elements]
    whole.element_sets.setdefault(whole.key(name), []).extend(every)
    # Sets have the name as given, and the name behind that of the instance.
    for own, known in (
        (part.node_sets, whole.node_sets),
        (part.element_sets, whole.element_sets),
    ):
        for key, members in own.items():
            moved = [numbers + shift for numbers in members]
            known.setdefault(whole.key(part.spelled[key]), []).extend(moved)
            known.setdefault(whole.key(f"{name}.{part.spelled[key]}"), []).extend(moved)
    whole.left_out |= part.left_out
    whole.internal |= part.internal | {f"{name}.{key}".upper() for key in part.internal}
    # Surfaces refer to moved elements, or to sets of the instance.
    for key, lines in part.surfaces.items():
        moved_lines = [(_moved_entry(entry, name, shift), face) for entry, face in lines]
        whole.surfaces.setdefault(whole.key(part.spelled[key]), []).extend(moved_lines)
    return shift


def _moved_entry(entry: str, name: str, shift: int) -> str:
    """Return the number of an element, or the name of a set, of an instance."""
    if entry.isdigit():
        return str(int(entry) + shift)
    return f"{name}.{entry}"


def _read_card(part: _Part, card: _Card, instances: _Instances) -> None:
    """Read a card with nodes, elements, a set or a surface; others say nothing of the mesh."""
    options = card.options
    if card.keyword == "NODE":
        _read_nodes(part, card)
    elif card.keyword == "ELEMENT":
        _read_elements(part, card)
    elif card.keyword in ("NSET", "ELSET"):
        sets = part.element_sets
        if card.keyword == "NSET":
            sets = part.node_sets
        shift = instances.get(options.get("INSTANCE", "").strip('"').upper(), (0, part))[0]
        if card.keyword == "NSET" and card.options.get("ELSET"):
            members = _nodes_of(part, card.options["ELSET"])
        else:
            members = _members(sets, part, card, shift, instances)
        key = part.key(options.get(card.keyword, ""))
        sets.setdefault(key, []).append(members)
        # Sets that Abaqus makes for its surfaces have no name of their own.
        if card.flag("INTERNAL"):
            part.internal.add(key)
    elif card.keyword == "SURFACE":
        _read_surface(part, card, instances)


def _read_nodes(part: _Part, card: _Card) -> None:
    """Read numbers and coordinates, of which plane files have two."""
    if card.options.get("SYSTEM", "R").upper() != "R":
        raise ValueError(
            f"its *NODE, SYSTEM={card.options['SYSTEM']} are not in Cartesian coordinates, which "
            "alone are read: write x, y and z"
        )
    data = card.data.strip()
    if not data:
        return
    # All lines have the columns of the first one, unless coordinates are left out.
    lines = 1 + data.count(b"\n")
    width = 1 + data.split(b"\n", 1)[0].count(b",")
    numbers = parsed(data, "the lines of *NODE", commas=True)
    if data.count(b",") != (width - 1) * lines or len(numbers) != width * lines:
        numbers = _completed(data)
        width = 4
    table = rows(numbers, width, "*NODE")
    points = np.zeros((len(table), 3))
    points[:, : min(width - 1, 3)] = table[:, 1:4]
    ids = whole(table[:, 0], "node")
    part.ids.append(ids)
    part.points.append(points)
    # A card may name its nodes.
    if card.options.get("NSET"):
        part.node_sets.setdefault(part.key(card.options["NSET"]), []).append(ids)


def _completed(data: bytes) -> Floats:
    """Return lines of a number and three coordinates, of which the ones left out are zero."""
    found = []
    for line in data.split(b"\n"):
        words = [word.strip() or b"0" for word in line.split(b",")]
        if any(len(word.split()) > 1 for word in words):
            raise ValueError(f"a line of *NODE has blanks between numbers: '{decoded(line)}'")
        if line.strip():
            found.append(b" ".join([*words, b"0", b"0", b"0"][:4]))
    return np.asarray(parsed(b"\n".join(found), "the lines of *NODE"))


def _read_elements(part: _Part, card: _Card) -> None:
    """Read elements of one type, each with as many nodes as the type says."""
    name = card.options.get("TYPE", "").upper()
    numbers = parsed(card.data, f"the lines of *ELEMENT, TYPE={name}", np.int64, commas=True)
    if len(numbers) == 0:
        return
    kind, n_nodes = _kind_of(name)
    if not kind:
        label = card.options.get("ELSET", "")
        part.left_out.add(f"elements {name}" + (f" of '{label}'" if label else ""))
        return
    table = rows(numbers, 1 + n_nodes, f"*ELEMENT, TYPE={name}")
    ids = table[:, 0]
    nodes = table[:, 1:]
    if kind == "line3":
        nodes = nodes[:, [0, 2, 1]]  # the second node lies in the middle
    nodes = to_vtk(nodes, _ORDER.get(kind))
    part.elements.append((kind, ids, nodes))
    if card.options.get("ELSET"):
        part.element_sets.setdefault(part.key(card.options["ELSET"]), []).append(ids)


def _kind_of(name: str) -> tuple[str, int]:
    """Return kind and number of nodes of a type such as "CPE8R"; none of springs, masses."""
    digits = re.findall(r"\d+", re.sub(r"(2D|3D)(?=\d)|^B(?=\d{2})", "", name))
    for pattern, dim in _FAMILIES:
        if re.match(pattern, name) and digits:
            n_nodes = int(digits[0])
            if name.startswith("B") and n_nodes > 9:
                n_nodes = 2 + (n_nodes % 10 == 2)
            if (dim, n_nodes) in BY_NODES:
                return BY_NODES[dim, n_nodes], n_nodes
            raise _not_read(name)
    if re.match(r"C(?!ONN)|S\d|M\d", name):
        raise _not_read(name)
    return "", 0


def _not_read(name: str) -> ValueError:
    return ValueError(
        f"elements of type {name} are not read: delete their lines, or export without them"
    )


def _of_instance(word: str, instances: _Instances) -> int | None:
    """Return the number in the file of "instance.number", None for other words."""
    name, _, number = word.strip().strip('"').rpartition(".")
    name = name.strip('"').upper()
    if name in instances and number.isdigit():
        return int(number) + instances[name][0]
    return None


def _members(
    sets: Mapping[str, list[Integers]],
    part: _Part,
    card: _Card,
    shift: int,
    instances: _Instances,
) -> Integers:
    """Return the numbers of a set, which may name other sets, or steps of a sequence."""
    if card.flag("GENERATE"):
        return shift + _generated(card.data)
    # Most sets have numbers alone.
    if not re.search(rb"[A-Za-z_]", card.data):
        return shift + np.asarray(parsed(card.data, "the set", np.int64, commas=True))
    # Other sets may be among the members.
    words = [word.strip() for word in re.split(rb"[,\n]", card.data) if word.strip()]
    parts = [np.zeros(0, int)]
    for word in words:
        if word.lstrip(b"-").isdigit():
            parts.append(np.array([int(word) + shift]))
            continue
        number = _of_instance(decoded(word), instances)
        if number is not None:
            parts.append(np.array([number]))
            continue
        other = part.key(decoded(word))
        if other not in sets:
            raise ValueError(f"the set '{part.spelled[other]}' does not exist")
        parts += sets[other]
    return np.concatenate(parts)


def _nodes_of(part: _Part, name: str) -> Integers:
    """Return the nodes of the elements of a set."""
    key = part.key(name)
    if key not in part.element_sets:
        raise ValueError(f"the set '{part.spelled[key]}' does not exist")
    members = np.concatenate(part.element_sets[key])
    found = [nodes[np.isin(ids, members)].ravel() for _, ids, nodes in part.elements]
    return np.unique(np.concatenate([np.zeros(0, int), *found]))


def _generated(data: bytes) -> Integers:
    """Return the numbers of lines "first, last, step"."""
    found = [np.zeros(0, int)]
    for line in data.replace(b",", b" ").split(b"\n"):
        bounds = [int(word) for word in line.split()]
        if not bounds:
            continue
        first, last, *step = bounds
        if last - first > _MOST:
            raise ValueError(f"a set counts from {first} to {last}: these are too many")
        found.append(np.arange(first, last + 1, *step[:1]))
    return np.concatenate(found)


def _read_surface(part: _Part, card: _Card, instances: _Instances) -> None:
    """Read the lines "set or element, face" of a surface, the nodes of one, or a union."""
    key = part.key(card.options.get("NAME", ""))
    union = card.options.get("COMBINE", "").upper()
    if union not in ("", "UNION"):
        raise ValueError(
            f"surface '{part.spelled[key]}' is made by COMBINE={union}, which is not read: write "
            "its elements and faces"
        )
    by_nodes = card.options.get("TYPE", "ELEMENT").upper() == "NODE"
    for line in decoded(card.data).split("\n"):
        words = [word.strip().strip('"') for word in line.split(",")]
        if not words[0]:
            continue
        if union:
            for other in filter(None, words):
                if other.upper() not in part.surfaces:
                    raise ValueError(f"the surface '{other}' does not exist")
                part.surfaces.setdefault(key, []).extend(part.surfaces[other.upper()])
            continue
        number = _of_instance(words[0], instances)
        if number is not None:
            words[0] = str(number)
        face = ""
        if by_nodes:
            face = "NODE"
        elif len(words) > 1:
            face = words[1].upper()
        part.surfaces.setdefault(key, []).append((words[0], face))


def _content(whole: _Part) -> Content:
    """Return the content of the whole file with its groups."""
    ids, points = whole.coordinates()
    content = Content(points, {}, left_out=sorted(whole.left_out))
    cells: dict[str, list[Integers]] = {}
    place: dict[str, list[Integers]] = {}
    # Join the elements of each kind.
    for kind, numbers, nodes in whole.elements:
        cells.setdefault(kind, []).append(numbers_of(ids, nodes, "node"))
        place.setdefault(kind, []).append(numbers)
    content.cells = {kind: np.concatenate(parts) for kind, parts in cells.items()}
    numbers_by_kind = {kind: np.concatenate(parts) for kind, parts in place.items()}
    # Name sets of elements and of nodes as they are spelled, then surfaces.
    for name, members in whole.named(whole.element_sets):
        for kind, numbers in numbers_by_kind.items():
            found = np.flatnonzero(np.isin(numbers, members))
            if len(found):
                content.add(name, kind, found)
    for name, members in whole.named(whole.node_sets):
        content.node_groups[name] = numbers_of(ids, members, "node")
    for key, lines in whole.surfaces.items():
        for face, behind in _members_by_face(whole, whole.spelled[key], lines).items():
            _add_face(content, numbers_by_kind, ids, whole.spelled[key], face, behind)
    return content


def _members_by_face(whole: _Part, name: str, lines: list[tuple[str, str]]) -> dict[str, Integers]:
    """Return the elements of a surface by their faces, or its nodes; lines may name sets."""
    single: dict[str, list[int]] = {}
    found: dict[str, list[Integers]] = {}
    for entry, face in lines:
        sets = whole.element_sets
        if face == "NODE":
            sets = whole.node_sets
        if entry.isdigit():
            single.setdefault(face, []).append(int(entry))
        elif entry.upper() in sets:
            found.setdefault(face, []).extend(sets[entry.upper()])
        else:
            raise ValueError(f"surface '{name}' names the set '{entry}', which does not exist")
    for face, numbers in single.items():
        found.setdefault(face, []).append(np.array(numbers))
    return {face: np.unique(np.concatenate(parts)) for face, parts in found.items()}


def _add_face(
    content: Content,
    numbers_by_kind: Mapping[str, Integers],
    ids: Integers,
    name: str,
    face: str,
    members: Integers,
) -> None:
    """Add one face of some elements to a surface."""
    # Surfaces of nodes are sets of nodes.
    if face == "NODE":
        nodes = numbers_of(ids, members, "node")
        known = content.node_groups.get(name, np.zeros(0, int))
        content.node_groups[name] = np.union1d(known, nodes).astype(int)
        return
    # Other surfaces name faces by number.
    number = re.fullmatch(r"S(\d)", face)
    if number is None:
        content.left_out.append(f"face {face or 'of no number'} of surface '{name}'")
        return
    # Take the nodes of this face from each kind of elements.
    for kind, numbers in numbers_by_kind.items():
        if KINDS[kind].dim < 2:
            continue
        faces = _FACES[_straight(kind)]
        found = np.flatnonzero(np.isin(numbers, members))
        position = int(number[1]) - 1
        if len(found) and position < len(faces):
            sides = content.cells[kind][found][:, list(faces[position])]
            side_kind = {2: "line", 3: "triangle", 4: "quad"}[sides.shape[1]]
            content.add_sides(name, side_kind, sides)


def _straight(kind: str) -> str:
    """Return the kind of first order of the same shape."""
    return re.sub(r"\d+$", "", kind)


#: Types of elements that are written.
_TYPES = {
    "triangle": "CPE3",
    "triangle6": "CPE6",
    "quad": "CPE4",
    "quad8": "CPE8",
    "tetra": "C3D4",
    "tetra10": "C3D10",
    "hexahedron": "C3D8",
    "hexahedron20": "C3D20",
}
#: Numbers of a set on one line, and characters of a line of an element.
_ON_A_LINE = 12


def write(content: Content, path: str) -> None:
    """Write nodes, elements, element sets, and surfaces of elements and faces."""
    check_names(content, ',=*\n"', "input files")
    # Names differ by more than capitals.
    folded: dict[str, str] = {}
    for name in content.groups:
        other = folded.setdefault(name.upper(), name)
        if other != name:
            raise ValueError(f"'{other}' and '{name}' are one name in input files: rename one")
    without_middles(content, "Abaqus")
    kind = next(kind for kind in content.cells if KINDS[kind].dim == content.dim)
    cells = content.cells[kind]
    # Write nodes and elements, on lines of limited length.
    lines = ["*NODE", point_text(content.points, ", ").rstrip(), f"*ELEMENT, TYPE={_TYPES[kind]}"]
    for number, nodes in enumerate((cells + 1).tolist(), start=1):
        words = [str(number), *map(str, nodes)]
        lines.append(", ".join(words[:_ON_A_LINE]) + ("," if len(words) > _ON_A_LINE else ""))
        if len(words) > _ON_A_LINE:
            lines.append(", ".join(words[_ON_A_LINE:]))
    # Write the sets of elements, then the surfaces.
    for name, group in content.groups.items():
        members = group.get(kind, np.zeros(0, int)) + 1
        if len(members):
            lines.append(f"*ELSET, ELSET={name}")
            for start in range(0, len(members), _ON_A_LINE):
                lines.append(", ".join(map(str, members[start : start + _ON_A_LINE].tolist())))
    lines += _surfaces(content, kind)
    Path(path).write_text("\n".join([*lines, ""]), encoding="utf-8")


def _surfaces(content: Content, kind: str) -> list[str]:
    """Return the cards of the groups of sides, as elements and numbers of faces."""
    # List all faces of all elements.
    straight = _straight(kind)
    cells = content.cells[kind][:, : KINDS[kind].corners]
    faces = [np.sort(cells[:, list(face)], axis=1) for face in _FACES[straight]]
    number = np.repeat(np.arange(1, len(faces) + 1), len(cells))
    element = np.tile(np.arange(1, len(cells) + 1), len(faces))
    every = np.concatenate(faces)
    lines = []
    # Find each side among them.
    for name, group in content.groups.items():
        for side_kind, members in group.items():
            if KINDS[side_kind].dim != content.dim - 1 or len(members) == 0:
                continue
            sides = content.cells[side_kind][members]
            behind = _behind(content, cells, every, element, sides, KINDS[side_kind].corners)
            lines.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
            lines += [f"{element[k]}, S{number[k]}" for k in behind]
    return lines


def _behind(
    content: Content,
    cells: Integers,
    every: Integers,
    element: Integers,
    sides: Integers,
    corners: int,
) -> Integers:
    """Return the faces, by their positions in `every`, of the elements behind sides."""
    # Compare the faces whose corners all belong to the sides: equal ones have equal keys
    chosen = np.zeros(len(content.points), dtype=bool)
    chosen[sides[:, :corners]] = True
    near = np.flatnonzero(chosen[every].all(axis=1))
    ends = np.sort(sides[:, :corners], axis=1)
    faces = np.concatenate((every[near], ends))
    keys = np.unique(faces, axis=0, return_inverse=True)[1].ravel()
    own = keys[: len(near)]
    wanted = keys[len(near) :]
    order = np.argsort(own, kind="stable")
    first = np.searchsorted(own, wanted, sorter=order)
    last = np.searchsorted(own, wanted, side="right", sorter=order) - 1
    # Of two elements take the one from which the normal of the side points away
    choice = near[order[first]]
    other = near[order[last]]
    points = content.points[:, : content.dim].T
    x = points[:, sides[:, :corners]]  # (dim, n, corners)
    middle = points[:, cells[element[choice] - 1]].mean(axis=2)
    outward = ((x.mean(axis=2) - middle) * normals(x)).sum(axis=0) > 0
    return np.where(outward, choice, other)
