"""Grids of FLAC3D as text, .f3grid."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np

from ..content import (
    Content,
    check_names,
    decoded,
    numbers_of,
    parsed,
    pieces,
    point_text,
    read_text,
    rows,
    whole,
)
from ..kinds import KINDS, Integers

#: Kinds of zones and faces, and their nodes in the order of VTK (z upwards, right-handed).
_ZONES = {
    b"B8": ("hexahedron", [0, 1, 4, 2, 3, 6, 7, 5]),
    b"W6": ("wedge", [0, 1, 3, 2, 4, 5]),
    b"P5": ("pyramid", [0, 1, 4, 2, 3]),
    b"T4": ("tetra", [0, 1, 2, 3]),
    b"Q4": ("quad", [0, 1, 2, 3]),
    b"T3": ("triangle", [0, 1, 2]),
}
#: Numbers of a group on one line.
_ON_A_LINE = 12


def read(path: str) -> Content:
    """Read grid points, zones, faces and their groups."""
    groups: list[tuple[str, str]] = []
    tables: dict[bytes | int, list[np.ndarray]] = {}
    for piece in pieces(_text(path)):
        for head, lines in _sorted_lines(piece, groups).items():
            tables.setdefault(head, []).append(_table(head, lines, groups))
    if b"G" not in tables:
        raise ValueError("it is not a grid of FLAC3D, or has no points")

    # Join the points: number and coordinates
    table = np.concatenate(tables.pop(b"G"))
    ids = whole(table[:, 0], "grid point")
    content = Content(table[:, 1:], {})

    # Join zones and faces by their type, then name them by the groups, which may come first
    numbers: dict[tuple[str, str], Integers] = {}
    members: dict[int, Integers] = {}
    for head, parts in tables.items():
        if isinstance(head, int):
            members[head] = np.concatenate(parts)
            continue
        letter, _, word = head.partition(b" ")
        kind, order = _ZONES[word]
        cells = np.concatenate(parts)
        content.cells[kind] = numbers_of(ids, cells[:, 1:][:, order], "grid point")
        numbers[letter.decode(), kind] = cells[:, 0]
    for number, ids_of in members.items():
        _add_group(content, numbers, *groups[number], ids_of)
    return content


def _text(path: str) -> bytes:
    """Return the text of a file without its comments, once it is complete."""
    data = read_text(path)
    if b"\0" in data[:4096]:
        raise ValueError("it is a binary grid: export it from FLAC3D as text")
    if not data.endswith(b"\n"):
        raise ValueError("it ends within a line: it is not complete, or needs an empty line")
    if b"\r" in data:
        data = data.replace(b"\r", b"")
    return re.sub(rb"^[ \t]*[*;].*", b"", data, flags=re.MULTILINE)


def _sorted_lines(text: bytes, groups: list[tuple[str, str]]) -> dict[bytes | int, list[bytes]]:
    """Return lines by the type of their zone, or by the number of the group that they list.

    Letters and names of groups are appended to `groups`; its last one may continue.
    """
    lines: dict[bytes | int, list[bytes]] = {}
    for line in map(bytes.strip, text.split(b"\n")):
        if not line:
            continue
        # Sort by the first letters; lines of numbers belong to the last group.
        key = line[:1]
        if line[1:6] == b"GROUP":
            groups.append(_group(line))
        elif key in b"GZF":
            lines.setdefault(key if key == b"G" else line[:4], []).append(line)
        elif key.isdigit() and groups:
            lines.setdefault(len(groups) - 1, []).append(line)
        else:
            raise ValueError(
                f"it is not a grid of FLAC3D: '{line[:40].decode('ascii', 'replace')}'"
            )
    return lines


def _table(head: bytes | int, lines: list[bytes], groups: list[tuple[str, str]]) -> np.ndarray:
    """Return the numbers of points or zones, one a row, or the members of a group."""
    if isinstance(head, int):
        body = b" ".join(lines)
        return np.asarray(parsed(body, f"the members of group '{groups[head][1]}'", np.int64))
    body = b"\n".join(line[len(head) :] for line in lines)
    if head == b"G":
        return np.asarray(rows(parsed(body, "the lines of points"), 4, "the points"))
    word = head.partition(b" ")[2]
    if word not in _ZONES:
        raise ValueError(f"zones of type {head.decode('ascii', 'replace')} are not read")
    width = 1 + len(_ZONES[word][1])
    return np.asarray(rows(parsed(body, "the lines of zones", np.int64), width, "the zones"))


def _add_group(
    content: Content,
    numbers: dict[tuple[str, str], Integers],
    letter: str,
    name: str,
    members: Integers,
) -> None:
    """Name the zones or faces of a group in all their types."""
    for (other, kind), known in numbers.items():
        found = np.flatnonzero(np.isin(known, members))
        if other == letter and len(found):
            content.add(name, kind, found)


def _group(line: bytes) -> tuple[str, str]:
    """Return letter and name of a group; slots with names precede it, "slot:name"."""
    words = shlex.split(decoded(line))
    if len(words) < 2:
        raise ValueError("a group has no name")
    slot = "1"
    if len(words) > 3 and words[2].upper() == "SLOT":
        slot = words[3]
    plain = slot.isdigit() or slot == "Default"
    return words[0][0], words[1] if plain else f"{slot}:{words[1]}"


def write(content: Content, path: str) -> None:
    """Write grid points, zones, named faces and groups, with a slot for groups that overlap."""
    # Refuse what the format does not have.
    check_names(content, '"\n', "grids of FLAC3D")
    words = {kind: (word.decode(), order) for word, (kind, order) in _ZONES.items()}
    others = [kind for kind in content.cells if kind not in words]
    if content.dim < 3 or others:
        found = ", ".join(content.cells)
        raise ValueError(f"grids of FLAC3D have zones of first order in space, not {found}")
    # Write grid points, zones and faces.
    lines = ["* GRIDPOINTS"]
    lines += [f"G {line}" for line in point_text(content.points).rstrip().split("\n")]
    first = {}
    counts = {"Z": 1, "F": 1}
    for kind, cells in content.cells.items():
        letter = "F"
        if KINDS[kind].dim == 3:
            letter = "Z"
        word, order = words[kind]
        first[kind] = (letter, counts[letter])
        lines.append("* ZONES" if letter == "Z" else "* FACES")
        for nodes in (cells[:, np.argsort(order)] + 1).tolist():
            lines.append(f"{letter} {word} {counts[letter]} {' '.join(map(str, nodes))}")
            counts[letter] += 1
    lines += _group_lines(content, first)
    Path(path).write_text("\n".join([*lines, ""]), encoding="utf-8")


def _group_lines(content: Content, first: dict[str, tuple[str, int]]) -> list[str]:
    """Return the lines of all groups, by the letter and the first number of each kind.

    A zone is in one group of each slot.
    """
    lines = []
    taken: dict[str, list[Integers]] = {"Z": [], "F": []}
    for name, group in content.groups.items():
        for kind, members in group.items():
            letter, number = first[kind]
            slot = _free_slot(taken[letter], members + number)
            lines.append(f'{letter}GROUP "{name}" SLOT {slot}')
            ids = (members + number).tolist()
            for start in range(0, len(ids), _ON_A_LINE):
                lines.append(" ".join(map(str, ids[start : start + _ON_A_LINE])))
    return lines


def _free_slot(taken: list[Integers], members: Integers) -> int:
    """Return the first slot whose groups have none of the members; a zone has one in each."""
    for number, known in enumerate(taken):
        if not np.isin(members, known).any():
            taken[number] = np.concatenate((known, members))
            return number + 1
    taken.append(members)
    return len(taken)
