"""Kratos' mesh files, .mdpa."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from ..content import (
    Content,
    check_names,
    decoded,
    from_vtk,
    members_by_tag,
    numbers_of,
    parsed,
    point_text,
    read_text,
    rows,
    table_text,
    to_vtk,
    whole,
)
from ..kinds import BY_NODES, KINDS, UPRIGHT_FIRST, Integers

#: Kratos' nodes in the order of VTK, where the two differ: upright edges come before upper ones.
_ORDER = {
    "hexahedron20": UPRIGHT_FIRST["hexahedron20"],
    "hexahedron27": [*UPRIGHT_FIRST["hexahedron20"], 24, 22, 21, 23, 20, 25, 26],
}
#: Blocks of elements, whose numbers are counted apart.
_TABLES = ("Elements", "Conditions", "Geometries")
_BLOCK = re.compile(rb"^[ \t]*(Begin|End)[ \t]+(\w+)[ \t]*(.*)$", re.MULTILINE)


def read(path: str) -> Content:
    """Read nodes, elements, conditions, geometries and sub-model parts."""
    # Drop comments, and check that it has blocks.
    text = read_text(path)
    if b"//" in text:
        text = re.sub(rb"//.*", b"", text)
    if not _BLOCK.search(text):
        raise ValueError("it is not a file of Kratos: it has no block that begins")
    ids = np.zeros(0, int)
    content = Content(np.zeros((0, 3)), {})
    numbers: dict[str, dict[str, list[Integers]]] = {}
    properties: dict[str, list[Integers]] = {}
    parts: list[tuple[str, str, Integers]] = []
    open_parts: list[str] = []
    for word, name, body in _blocks(text):
        # Follow the beginning and the end of sub-model parts.
        if word == "SubModelPart":
            open_parts.append(name)
        elif word == "End SubModelPart":
            del open_parts[-1:]
        # Read nodes, elements, or members of sub-model parts.
        elif word == "Nodes":
            table = rows(parsed(body, "the lines of Nodes"), 4, "Nodes")
            ids = np.concatenate((ids, whole(table[:, 0], "node")))
            content.points = np.concatenate((content.points, table[:, 1:]))
        elif word in _TABLES:
            _read_elements(
                content,
                word,
                name,
                body,
                ids,
                numbers,
                properties,
            )
        elif word.removeprefix("SubModelPart") in ("Nodes", *_TABLES) and open_parts:
            members = np.asarray(parsed(body, f"the lines of {word}", np.int64))
            parts.append((".".join(open_parts), word.removeprefix("SubModelPart"), members))
    if open_parts:
        raise ValueError(f"it is not complete: it ends within the sub-model part {open_parts[-1]}")
    _name_parts(content, ids, parts, numbers, properties)
    return content


def _blocks(text: bytes) -> Iterator[tuple[str, str, bytes]]:
    """Yield the words, names and texts of blocks; sub-model parts begin and end without a text."""
    position = 0
    while match := _BLOCK.search(text, position):
        position = match.end()
        word = match[2].decode()
        name = decoded(match[3]).strip()
        if match[1] == b"End":
            yield f"End {word}", name, b""
        elif word == "SubModelPart":
            yield word, name, b""
        else:
            # Take the text up to the end of the block.
            end = re.compile(rb"^[ \t]*End[ \t]+" + match[2] + rb"\b", re.M).search(text, position)
            if end is None:
                raise ValueError(
                    f"it is not complete: it ends within the block {word} {name}".rstrip()
                )
            position = end.end()
            yield word, name, text[match.end() : end.start()]


def _read_elements(
    content: Content,
    word: str,
    name: str,
    body: bytes,
    ids: Integers,
    numbers: dict[str, dict[str, list[Integers]]],
    properties: dict[str, list[Integers]],
) -> None:
    """Read one block, whose name ends with dimension and number of nodes, "Element2D3N"."""
    first_line = body.lstrip().partition(b"\n")[0].split()
    if not first_line:
        return
    head = 2
    if word == "Geometries":
        head = 1
    table = rows(parsed(body, f"the lines of {name}", np.int64), len(first_line), name)
    kind = _kind_of(word, name, table.shape[1] - head)
    if not kind:
        content.left_out.append(f"{len(table)} {word.lower()} {name}")
        return
    nodes = numbers_of(ids, table[:, head:], "node")
    nodes = to_vtk(nodes, _ORDER.get(kind))
    known = content.cells.get(kind)
    content.cells[kind] = nodes if known is None else np.concatenate((known, nodes))
    # Numbers of elements, conditions and geometries are counted apart
    for other in _TABLES:
        if other == word:
            own = table[:, 0]
        else:
            own = np.full(len(table), -1)
        numbers.setdefault(kind, {}).setdefault(other, []).append(own)
    if head == 2 and word == "Elements":
        tags = table[:, 1]
    else:
        tags = np.zeros(len(table), int)
    properties.setdefault(kind, []).append(tags)


def _kind_of(word: str, name: str, n_nodes: int) -> str:
    """Return the kind of elements of a name, or nothing for points, joints, unknown shapes.

    "2D" in the name of an element is the space; conditions have a dimension less than the space.
    """
    if "Interface" in name:  # joints, whose sides coincide
        return ""
    space = 2
    if "3D" in name:
        space = 3
    dim = space - (word == "Conditions")
    if word == "Geometries":
        flat = ("Triangle", "Quadrilateral")
        dim = 3
        if name.startswith("Line"):
            dim = 1
        elif name.startswith(flat):
            dim = 2
    elif name.startswith(("Line", "Triangle", "Quadrilateral", "Tetra", "Hexa", "Prism", "Point")):
        shapes = {"Point": 0, "Line": 1, "Triangle": 2, "Quadrilateral": 2}
        dim = next((d for start, d in shapes.items() if name.startswith(start)), 3)
    elif re.search(r"Shell|Membrane|Surface|Face3D", name):
        dim = 2
    elif re.search(r"Line|Truss|Beam|Cable", name):
        dim = 1
    return BY_NODES.get((dim, n_nodes), "")


def _name_parts(
    content: Content,
    ids: Integers,
    parts: list[tuple[str, str, Integers]],
    numbers: dict[str, dict[str, list[Integers]]],
    properties: dict[str, list[Integers]],
) -> None:
    """Name elements by their sub-model parts, or by their properties if no part has bodies."""
    # Join the blocks of each kind.
    joined = {}
    for kind, kinds in numbers.items():
        joined[kind] = {word: np.concatenate(found) for word, found in kinds.items()}
    # Sub-model parts with elements need no nodes.
    with_sides = {name for name, what, members in parts if what != "Nodes" and len(members)}
    for name, what, members in parts:
        if what != "Nodes":
            _add_part(content, name, members, {kind: words[what] for kind, words in joined.items()})
        elif name not in with_sides and len(members):
            content.node_groups[name] = numbers_of(ids, members, "node")
    _name_bodies(content, properties)


def _name_bodies(content: Content, properties: Mapping[str, list[Integers]]) -> None:
    """Name elements by their properties where no group has elements of the highest dimension."""
    bodies = {kind for kind in content.cells if KINDS[kind].dim == content.dim}
    if any(bodies.intersection(group) for group in content.groups.values()):
        return
    for kind in bodies:
        for tag, found in members_by_tag(np.concatenate(properties[kind])).items():
            if tag > 0:
                content.add(f"property {tag}", kind, found)


def _add_part(
    content: Content,
    name: str,
    members: Integers,
    numbers: Mapping[str, Integers],
) -> None:
    """Name the elements of a sub-model part in all kinds."""
    for kind, known in numbers.items():
        found = np.flatnonzero(np.isin(known, members))
        if len(found):
            content.add(name, kind, found)


#: Names of elements and conditions that are written, without the number of nodes.
_NAMES = {
    ("triangle", 2): "Element2D",
    ("quad", 2): "Element2D",
    ("tetra", 3): "Element3D",
    ("hexahedron", 3): "Element3D",
    ("line", 2): "LineCondition2D",
    ("triangle", 3): "SurfaceCondition3D",
    ("quad", 3): "SurfaceCondition3D",
}


def write(content: Content, path: str) -> None:
    """Write nodes, elements, named sides as conditions, and a sub-model part for each name."""
    # Write the head and the nodes.
    check_names(content, " .\n", "Kratos' files")
    lines = [
        "Begin ModelPartData",
        "End ModelPartData",
        "",
        "Begin Properties 0",
        "End Properties",
        "",
    ]
    lines += ["Begin Nodes", point_text(content.points).rstrip(), "End Nodes", ""]
    # Count elements and conditions separately.
    first = {"Elements": 1, "Conditions": 1}
    start = {}
    for kind, cells in content.cells.items():
        word = "Conditions"
        if KINDS[kind].dim == content.dim:
            word = "Elements"
        name = _NAMES[re.sub(r"\d+$", "", kind), content.dim]
        nodes = from_vtk(cells, _ORDER.get(kind))
        start[kind] = (word, first[word])
        ids = first[word] + np.arange(len(cells))
        first[word] += len(cells)
        table = np.column_stack((ids, np.zeros(len(cells), int), nodes + 1))
        lines += [
            f"Begin {word} {name}{cells.shape[1]}N",
            table_text(table).rstrip(),
            f"End {word}",
            "",
        ]
    # Name nodes, elements and conditions by sub-model parts.
    for name, group in content.groups.items():
        parts = [content.cells[kind][members].ravel() for kind, members in group.items()]
        every = np.unique(np.concatenate(parts)) + 1
        lines += [f"Begin SubModelPart {name}", "Begin SubModelPartNodes"]
        lines += [*map(str, every.tolist()), "End SubModelPartNodes"]
        for kind, members in group.items():
            word, number = start[kind]
            lines += [f"Begin SubModelPart{word}", *map(str, (members + number).tolist())]
            lines.append(f"End SubModelPart{word}")
        lines += ["End SubModelPart", ""]
    Path(path).write_text("\n".join(lines), encoding="utf-8")
