"""Gmsh's files: MSH 2.2 and 4.1, text and binary."""

from __future__ import annotations

import mmap
import re
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from ...errors import warn
from ..content import (
    Content,
    check_count,
    check_names,
    combinations,
    compact,
    decoded,
    from_vtk,
    members_by_tag,
    numbers_of,
    parsed,
    table_text,
    to_vtk,
    whole,
)
from ..kinds import KINDS, N_NODES, Floats, Integers
from .scikit_fem import add_encoded

#: Kinds of elements by their numbers in the file.
_KINDS = {
    1: "line",
    2: "triangle",
    3: "quad",
    4: "tetra",
    5: "hexahedron",
    6: "wedge",
    7: "pyramid",
    8: "line3",
    9: "triangle6",
    10: "quad9",
    11: "tetra10",
    12: "hexahedron27",
    13: "wedge18",
    14: "pyramid14",
    15: "vertex",
    16: "quad8",
    17: "hexahedron20",
    18: "wedge15",
    19: "pyramid13",
}
#: Gmsh's nodes in the order of VTK, where the two differ (section "Node ordering" of the manual).
_ORDER = {
    "tetra10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    "hexahedron20": [*range(8), 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
    "hexahedron27": [
        *[*range(8), 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
        *[22, 23, 21, 24, 20, 25, 26],
    ],
}
#: Head of data of elements: one name, one real and three whole numbers.
_DATA = re.compile(
    rb'\$ElementData\s+1\s+"(skfem:[^"]*)"\s+1\s+\S+\s+3\s+\d+\s+(\d+)\s+(\d+)[ \t\r]*\n'
)
#: Advice on files of single partitions.
_WHOLE = ": in Gmsh, set Mesh.PartitionSplitMeshFiles = 0, or merge all files"
_WORDS = {0: "point", 1: "curve", 2: "surface", 3: "volume"}


class _Blocks(NamedTuple):
    """Elements of one kind of an entity, or with their own tags."""

    kind: str
    nodes: Integers
    tags: tuple[Integers | int, ...]
    # partitions that own each element, then those that know it, of format 2.2: (n_elements, n)
    partitions: Integers = np.zeros((0, 0), int)


def read(path: str) -> Content:
    """Read a file of format 2.2 or 4.1."""
    with open(path, "rb") as file:
        if not file.read(1):
            raise ValueError("it is empty")
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            return _read(file, data)


def _read(file: BinaryIO, data: mmap.mmap) -> Content:
    """Read an open file, whose bytes are also in `data`."""
    sections = _sections(data)
    head = data[slice(*sections.get("MeshFormat", (0, 0)))].split(maxsplit=3)
    if len(head) < 3:
        raise ValueError("it is not a Gmsh mesh: it has no line with the format")
    version = head[0].decode("ascii", "replace")
    is_text = head[1] == b"0"
    if version not in ("2.2", "4.1"):
        raise ValueError(
            f"it has the Gmsh format {version}; formats 2.2 and 4.1 are read: in Gmsh, set "
            "Mesh.MshFileVersion"
        )
    if not is_text and head[3][:4] != b"\x01\x00\x00\x00":
        raise ValueError("its numbers have the bytes of another machine: save it as text")
    if "ParametricNodes" in sections:
        raise ValueError("its nodes have parameters of curves: set Mesh.SaveParametric = 0")
    if "Nodes" not in sections or "Elements" not in sections:
        raise ValueError("it has no nodes or no elements, or is not complete")

    # Read sections in the order of the file, so that one reader is at work at a time
    def reader(name: str) -> _Numbers:
        start, end = sections.get(name, (0, 0))
        return _Numbers(file, start, end, is_text)

    names = _names(data[slice(*sections.get("PhysicalNames", (0, 0)))])
    if version == "2.2":
        ids, points = _nodes_22(reader("Nodes"))
        blocks = _elements_22(reader("Elements"), data)
        _check_partitions_22(blocks)
    else:
        groups = _groups_of_entities(reader("Entities"))
        parts, partitions = _groups_of_partitions(reader("PartitionedEntities"))
        groups |= parts
        ids, points = _nodes_41(reader("Nodes"))
        blocks = _elements_41(reader("Elements"), groups, partitions)
    content = _content(ids, points, blocks, names)
    if "ElementData" in sections:
        add_encoded(content, _element_data(data, is_text))
    return content


def _sections(data: mmap.mmap) -> dict[str, tuple[int, int]]:
    """Return the first and the last byte of every section between $Name and $EndName."""
    sections: dict[str, tuple[int, int]] = {}
    position = 0
    while (start := data.find(b"$", position)) >= 0:
        line = data.find(b"\n", start)
        name = data[start + 1 : min(max(line, start), start + 40)].strip()
        # Elements are mostly the last section, and the largest
        find = data.rfind if name == b"Elements" else data.find
        end = find(b"$End" + name, max(line, start))
        if line < 0 or end < 0:
            text = name.decode("ascii", "replace")
            raise ValueError(f"it is not a Gmsh mesh, or not complete: it ends within '{text}'")
        sections.setdefault(name.decode("ascii", "replace"), (line + 1, end))
        position = end + len(name) + 4
    return sections


def _names(section: bytes) -> dict[tuple[int, int], str]:
    """Return the names of physical groups by dimension and number."""
    found = re.findall(rb'^\s*(\d+)\s+(\d+)\s+"(.*)"\s*$', section, flags=re.MULTILINE)
    return {(int(dim), int(tag)): decoded(name) for dim, tag, name in found}


#: Numbers of the groups or partitions of entities, by dimension and number.
_Tags = dict[tuple[int, int], Integers]


class _Numbers:
    """Numbers of a section, as text or binary."""

    def __init__(self, file: BinaryIO, start: int, end: int, is_text: bool) -> None:
        self.file = file
        self.start = start
        self.end = end
        self.size = end - start
        self.is_text = is_text
        file.seek(start)

    def ints(self, count: int) -> Integers:
        """Return the next whole numbers, which binary files have with 4 bytes."""
        return self._next(count, np.int64 if self.is_text else np.dtype("<i4"))

    def sizes(self, count: int) -> Integers:
        """Return the next numbers of things, which binary files have with 8 bytes."""
        return self._next(count, np.int64 if self.is_text else np.dtype("<i8"))

    def floats(self, count: int) -> Floats:
        """Return the next numbers."""
        return self._next(count, np.float64)

    def records(self, count: int) -> Any:
        """Return the next records of a number and three coordinates, of binary files."""
        return self._next(count, np.dtype([("id", "<i4"), ("x", "<f8", (3,))]))

    def size_of(self, what: str) -> int:
        """Return the next number of things, of which the section has room for so many."""
        return check_count(int(self.sizes(1)[0]), self.size, what)

    def count_of_22(self) -> int:
        """Return the number at the head of a section of format 2.2, which is text."""
        head = self.file.readline(32).split()
        if len(head) != 1 or not head[0].isdigit():
            raise ValueError("a section begins without its number of entries")
        return check_count(int(head[0]), self.size, "entries")

    def _next(self, count: int, dtype: Any) -> np.ndarray:
        check_count(int(count), self.size, "numbers")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # a text that ends too early
            sep = ""
            if self.is_text:
                sep = " "
            values = np.fromfile(self.file, dtype, int(count), sep)
        if len(values) < count or self.file.tell() > self.end:
            raise ValueError("it is not complete: a section has fewer numbers than it announces")
        return values


def _nodes_22(section: _Numbers) -> tuple[Integers, Floats]:
    count = section.count_of_22()
    if section.is_text:
        table = section.floats(4 * count).reshape(count, 4)
        return whole(table[:, 0], "node"), table[:, 1:]
    table = section.records(count)
    return table["id"].astype(int), table["x"]


def _elements_22(section: _Numbers, data: mmap.mmap) -> list[_Blocks]:
    """Return blocks of elements; runs with the same kind and number of tags are read at once.

    Texts have lines "id kind n_tags tags nodes". Binary files have blocks, mostly of one element:
    "kind n_elements n_tags", then "id tags nodes" of each element.
    """
    count = section.count_of_22()
    if section.is_text:
        text = data[section.file.tell() : section.end]
        numbers = np.asarray(parsed(text, "elements", np.int64))
    else:
        numbers = section.ints((section.end - section.file.tell()) // 4)
    # Kind and tags are in the same columns; the number of elements is one in a text, without a head
    first = int(section.is_text)
    blocks = []
    position = 0
    done = 0
    while done < count:
        head = numbers[position : position + 3]
        if len(head) < 3:
            raise ValueError("it is not complete: the section of elements ends too early")
        kind = _kind(int(head[first]))
        many = 1
        if not section.is_text:
            many = check_count(int(head[1]), section.size, "elements")
        n_tags = check_count(int(head[2]), section.size, "tags")
        before = 1 - first  # number of an element before its tags
        width = before + n_tags + N_NODES[kind]
        # Read the blocks that follow with the same head at once
        length = 3 + many * width
        longest = min((len(numbers) - position) // length, (count - done) // max(many, 1))
        if longest == 0:
            raise ValueError("it is not complete: an element has too few nodes")
        run = numbers[position : position + longest * length].reshape(longest, length)
        same = (run[:, first:3] == head[first:]).all(axis=1)
        repeated = longest if same.all() else int(np.argmin(same))
        table = run[:repeated, 3:].reshape(-1, width)[:, before:]
        tag = table[:, 0] if n_tags else np.zeros(len(table), int)
        blocks.append(_Blocks(kind, table[:, n_tags:], (tag,), np.abs(table[:, 3:n_tags])))
        position += repeated * length
        done += repeated * max(many, 1)
    return blocks


def _nodes_41(section: _Numbers) -> tuple[Integers, Floats]:
    n_blocks = section.size_of("blocks")
    section.sizes(3)
    ids = []
    points = []
    for _ in range(n_blocks):
        dim, _, parametric = section.ints(3).tolist()
        many = section.size_of("nodes")
        width = 3 + (dim if parametric else 0)
        ids.append(section.sizes(many))
        points.append(section.floats(many * width).reshape(many, width)[:, :3])
    if not ids:
        raise ValueError("it has no nodes")
    return np.concatenate(ids), np.concatenate(points)


def _elements_41(section: _Numbers, groups: _Tags, partitions: _Tags) -> list[_Blocks]:
    n_blocks = section.size_of("blocks")
    section.sizes(3)
    blocks = []
    found = set()
    for _ in range(n_blocks):
        dim, entity, number = section.ints(3).tolist()
        many = section.size_of("elements")
        kind = _kind(number)
        table = section.sizes(many * (1 + N_NODES[kind])).reshape(many, -1)
        tags = groups.get((dim, entity), np.zeros(0, int))
        blocks.append(_Blocks(kind, compact(table)[:, 1:], tuple(tags.tolist())))
        found.add((dim, entity))
    _check_partitions(partitions, groups, found)
    return blocks


def _groups_of_entities(section: _Numbers) -> _Tags:
    """Return the numbers of the physical groups of every entity, by dimension and number."""
    groups: _Tags = {}
    if section.size:
        for dim, count in enumerate(section.sizes(4)):
            for _ in range(check_count(int(count), section.size, "entities")):
                tag = int(section.ints(1)[0])
                groups[dim, tag] = _groups_of_entity(section, dim)
    return groups


def _groups_of_partitions(section: _Numbers) -> tuple[_Tags, _Tags]:
    """Return the numbers of the physical groups, and of the partitions, of parts of entities."""
    groups: _Tags = {}
    partitions: _Tags = {}
    if section.size:
        section.sizes(1)
        section.ints(2 * section.size_of("ghosts"))
        for dim, count in enumerate(section.sizes(4)):
            for _ in range(check_count(int(count), section.size, "entities")):
                tag = int(section.ints(3)[0])
                partitions[dim, tag] = section.ints(section.size_of("partitions"))
                groups[dim, tag] = _groups_of_entity(section, dim)
    return groups, partitions


def _check_partitions(partitions: _Tags, groups: _Tags, found: set[tuple[int, int]]) -> None:
    """Refuse a file with the elements of some partitions alone, found by their entities."""
    dim = max((dim for dim, _ in found), default=0)
    every = [key for key in partitions if key[0] == dim]
    # Entities without a group have no elements where others have groups.
    named = [key for key in every if len(groups[key])] or every
    wanted = _numbers_in(partitions[key] for key in named)
    there = _numbers_in(partitions[key] for key in found & set(every))
    _refuse_parts(there, wanted, f"{len(wanted)}")


def _numbers_in(parts: Iterable[Integers]) -> set[int]:
    """Return the different numbers of several arrays."""
    return set(np.concatenate([np.zeros(0, int), *(part.ravel() for part in parts)]).tolist())


def _refuse_parts(there: set[int], wanted: set[int], count: str) -> None:
    """Refuse a file that lacks partitions."""
    if wanted - there:
        numbers = ", ".join(map(str, sorted(there)))
        raise ValueError(f"it has partition {numbers} of {count} alone{_WHOLE}")


def _check_partitions_22(blocks: list[_Blocks]) -> None:
    """Refuse a file of format 2.2 that lacks partitions which its elements name.

    Partitions have the numbers from one. The file has no count of them: that the last ones are
    missing is known from ghost elements alone, and a single first one may be all.
    """
    dim = max((KINDS[block.kind].dim for block in blocks), default=0)
    parts = [block.partitions for block in blocks if KINDS[block.kind].dim == dim]
    there = _numbers_in(part[:, :1] for part in parts)
    last = max(_numbers_in(parts), default=0)
    _refuse_parts(there, set(range(1, last + 1)), f"at least {last}")
    if last == 1:
        warn(f"the file has partition 1, which may be a part of the mesh{_WHOLE}")


def _groups_of_entity(section: _Numbers, dim: int) -> Integers:
    """Read the box, the groups and the boundary of an entity; return the groups."""
    section.floats(3 if dim == 0 else 6)
    groups = np.abs(section.ints(section.size_of("groups")))
    if dim:
        section.ints(section.size_of("parts of a boundary"))
    return groups


def _kind(number: int) -> str:
    """Return the kind of elements with Gmsh's number."""
    if number not in _KINDS:
        raise ValueError(
            f"it has elements of Gmsh's type {number}; first and second order are read: set "
            "Mesh.ElementOrder to 1 or 2"
        )
    return _KINDS[number]


def _content(
    ids: Integers,
    points: Floats,
    blocks: list[_Blocks],
    names: Mapping[tuple[int, int], str],
) -> Content:
    """Join the blocks of every kind, and name the groups."""
    content = Content(np.array(points), {})
    parts: dict[str, list[_Blocks]] = {}
    for block in blocks:
        parts.setdefault(block.kind, []).append(block)
    for kind, same in parts.items():
        nodes = numbers_of(ids, np.concatenate([block.nodes for block in same]), "node")
        content.cells[kind] = to_vtk(nodes, _ORDER.get(kind))
        dim = KINDS[kind].dim
        members = _members(same)
        # Keep the order of the names in the file, then numbers without a name
        named = [tag for d, tag in names if d == dim and tag in members]
        for tag in dict.fromkeys((*named, *sorted(members))):
            name = names.get((dim, tag), f"{_WORDS[dim]} {tag}")
            content.add(name, kind, members[tag])
    return content


def _members(blocks: list[_Blocks]) -> dict[int, Integers]:
    """Return the elements of every group of a kind by its number."""
    found: dict[int, list[Integers]] = {}
    first = 0
    for block in blocks:
        every = np.arange(first, first + len(block.nodes), dtype=np.int32)
        for tags in block.tags:
            if isinstance(tags, int):
                found.setdefault(tags, []).append(every)
                continue
            for tag, members in members_by_tag(np.abs(tags)).items():
                if tag:
                    found.setdefault(tag, []).append(first + members)
        first += len(block.nodes)
    return {tag: np.concatenate(parts) for tag, parts in found.items()}


def _element_data(data: mmap.mmap, is_text: bool) -> dict[str, Integers]:
    """Return the data of elements that scikit-fem wrote, by name."""
    found = {}
    for match in _DATA.finditer(data):
        width = int(match[2])
        count = int(match[3])
        check_count(count * width, len(data), "values")
        if is_text:
            end = data.find(b"$EndElementData", match.end())
            values = np.asarray(parsed(data[match.end() : end], "values"))
            values = values.reshape(count, 1 + width)[:, 1]
        else:
            dtype = np.dtype([("id", "<i4"), ("value", "<f8", (width,))])
            end = match.end() + count * dtype.itemsize
            values = np.frombuffer(data[match.end() : end], dtype, count)["value"][:, 0]
        found[decoded(match[1])] = values.astype(int)
    return found


#: Kind, numbers of groups, and nodes of the elements of an entity.
_Entity = tuple[str, tuple[int, ...], Integers]


def write(content: Content, path: str) -> None:
    """Write a text of format 4.1, with an entity for every combination of groups."""
    check_names(content, '"', "Gmsh's files")
    names: dict[tuple[int, str], int] = {}
    entities: dict[int, list[_Entity]] = {0: [], 1: [], 2: [], 3: []}
    for kind, cells in content.cells.items():
        dim = KINDS[kind].dim
        nodes = from_vtk(cells, _ORDER.get(kind)) + 1
        for groups, members in combinations(content, kind):
            tags = tuple(names.setdefault((dim, name), len(names) + 1) for name in groups)
            entities[dim].append((kind, tags, nodes[members]))

    # Write the sections
    named = [f'{dim} {tag} "{name}"' for (dim, name), tag in names.items()]
    sections = {
        "MeshFormat": ["4.1 0 8"],
        "PhysicalNames": [str(len(names)), *named],
        "Entities": _entity_lines(content, entities),
        "Nodes": _node_lines(content),
        "Elements": _element_lines(entities),
    }
    lines = []
    for name, section in sections.items():
        lines += [f"${name}", *section, f"$End{name}"]
    Path(path).write_text("\n".join([*lines, ""]), encoding="utf-8")


def _entity_lines(content: Content, entities: Mapping[int, list[_Entity]]) -> list[str]:
    """Return the lines of all entities, with the box of the mesh and their groups."""
    box = [*content.points.min(axis=0).tolist(), *content.points.max(axis=0).tolist()]
    corners = " ".join(map(repr, box))
    lines = [" ".join(str(len(parts)) for parts in entities.values())]
    for parts in entities.values():
        for number, (_, tags, _) in enumerate(parts, start=1):
            groups_of = " ".join(map(str, (len(tags), *tags)))
            lines.append(f"{number} {corners} {groups_of} 0")
    return lines


def _node_lines(content: Content) -> list[str]:
    """Return the lines of the nodes, all of the first entity of the highest dimension."""
    count = len(content.points)
    lines = [f"1 {count} 1 {count}", f"{content.dim} 1 0 {count}"]
    lines += map(str, range(1, count + 1))
    lines += [" ".join(map(repr, x)) for x in content.points.tolist()]
    return lines


def _element_lines(entities: Mapping[int, list[_Entity]]) -> list[str]:
    """Return the lines of the elements of all entities, numbered from one."""
    lines = []
    first = 1
    numbers = {kind: number for number, kind in _KINDS.items()}
    for dim, parts in entities.items():
        for entity, (kind, _, nodes) in enumerate(parts, start=1):
            lines.append(f"{dim} {entity} {numbers[kind]} {len(nodes)}")
            ids = first + np.arange(len(nodes))
            lines.append(table_text(np.column_stack((ids, nodes))).rstrip())
            first += len(nodes)
    n_blocks = sum(map(len, entities.values()))
    return [f"{n_blocks} {first - 1} 1 {first - 1}", *lines]
