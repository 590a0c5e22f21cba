"""Content of a file of a mesh: points, elements of any kinds, and named groups of them."""

from __future__ import annotations

import codecs
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import max_abs
from .kinds import KINDS, Floats, Integers

#: Random odd number of 64 bits, which is added to nodes in the key of an element.
_ODD = np.uint64(0x9E3779B97F4A7C15)
#: Lower half of a short key.
_HALF = np.uint32(16)
#: Elements of a piece, the temporary arrays of which stay in the cache.
_ROWS = 1 << 15
#: Runs of equal numbers that are copied at once.
_RUNS = 256
#: Distance of a node in the middle from its regular position, over the size of the element, up to
#: which the shape is the same: round-off of coordinates.
_SAME = 1e-9
#: Below this number a table of real numbers has whole numbers exactly.
_EXACT = 2.0**53
#: Bytes of a piece of a text.
_PIECE = 1 << 22
#: Numbers below this one, and their differences, have room in four bytes.
_ROOM = 2**30
#: Corners and edges around the nodes in the middle of the sides of a hexahedron, in their order.
FACES_OF_27 = (
    (0, 4, 7, 3, 16, 15, 19, 11),
    (1, 2, 6, 5, 9, 18, 13, 17),
    (0, 1, 5, 4, 8, 17, 12, 16),
    (2, 3, 7, 6, 10, 19, 14, 18),
    (0, 1, 2, 3, 8, 9, 10, 11),
    (4, 5, 6, 7, 12, 13, 14, 15),
)


@dataclass
class Content:
    """Points, elements and names of a file.

    Attributes
    ----------
    points
        Coordinates, (n, 3).
    cells
        Nodes of the elements, (n, n_nodes), by meshio's kinds, in the order of VTK.
    groups
        Numbers of the elements of each group by kinds, by the names of the groups. A group with
        elements of the highest dimension is a subdomain, with their sides a boundary.
    node_groups
        Numbers of the nodes of each group, by name.
    left_out
        Parts of the file that are not read, in words.
    keys
        Short keys of elements whose nodes the reader has checked, twice, (2, n); see
        :func:`short_keys`.
    """

    points: Floats
    cells: dict[str, Integers]
    groups: dict[str, dict[str, Integers]] = field(default_factory=dict)
    node_groups: dict[str, Integers] = field(default_factory=dict)
    left_out: list[str] = field(default_factory=list)
    keys: dict[str, NDArray[np.uint32]] = field(default_factory=dict)

    def add(self, name: str, kind: str, members: Integers) -> None:
        """Add elements to a group."""
        group = self.groups.setdefault(name, {})
        known = group.get(kind)
        group[kind] = members if known is None else np.union1d(known, members)

    def add_cells(self, kind: str, cells: Integers) -> Integers:
        """Add elements, (n, n_nodes), and return their numbers."""
        known = self.cells.get(kind)
        first = 0
        if known is not None:
            first = len(known)
            cells = np.concatenate((known, cells))
        self.cells[kind] = cells
        self.keys.pop(kind, None)
        return np.arange(first, len(cells))

    def add_sides(self, name: str, kind: str, sides: Integers) -> None:
        """Add sides, (n, corners), as elements of their own to a group."""
        if kind in self.cells:
            self.cells[kind] = self.cells[kind][:, : sides.shape[1]]
        self.add(name, kind, self.add_cells(kind, sides))

    @property
    def dim(self) -> int:
        """Highest number of dimensions of elements."""
        return max((KINDS[kind].dim for kind, cells in self.cells.items() if len(cells)), default=0)

    def check(self) -> None:
        """Refuse coordinates that are not finite, and nodes that do not exist."""
        for kind, cells in self.cells.items():
            if kind not in self.keys:
                check_nodes(cells, len(self.points), kind)
        # Points of no element do no harm.
        if np.isfinite(self.points.sum()) or np.isfinite(self.points).all():
            return
        for cells in self.cells.values():
            if not np.isfinite(self.points[cells]).all():
                raise ValueError("the mesh has coordinates that are not finite")


def side_kind(corners: int, dim: int) -> str:
    """Return the kind of a side with so many corners, of an element of so many dimensions."""
    if dim == 2:
        return "line"
    if corners == 3:
        return "triangle"
    return "quad"


def unsigned(numbers: Integers) -> Integers:
    """Return a view of whole numbers in which negative ones are the largest."""
    return numbers.view(f"{numbers.dtype.byteorder}u{numbers.itemsize}")


def check_nodes(cells: Integers, count: int, kind: str) -> None:
    """Refuse nodes that are not among so many."""
    if cells.size == 0 or unsigned(cells).max() < count:
        return
    wrong = cells[unsigned(cells) >= count].item(0)
    raise ValueError(f"a {kind} has the node {wrong + 1} of {count}: the number is out of bounds")


def cached(count: int) -> Iterator[slice]:
    """Yield pieces of so many elements, the temporary arrays of which stay in the cache."""
    for start in range(0, count, _ROWS):
        yield slice(start, start + _ROWS)


def node_keys(cells: Integers) -> Any:
    """Return a key of every element, (n,): the same for the same nodes in any order.

    It is the product of its nodes, each plus a large odd number, modulo 2**64. Of 1e6 different
    elements two have the same key with a probability of 1e-7.
    """
    keys = np.empty(len(cells), dtype=np.uint64)
    for piece in cached(len(cells)):
        product = keys[piece]
        product[:] = cells[piece, 0]
        product += _ODD
        for nodes in cells[piece, 1:].T:
            factors = nodes.astype(np.uint64)
            factors += _ODD
            product *= factors
    return keys


def short_keys(cells: Integers, out: NDArray[np.uint32]) -> None:
    """Compute keys of a few elements twice, (2, n): sums of cubes of their nodes, modulo 2**32.

    They are computed and sorted in less than half of the time of long keys. In meshes of 1e6
    elements a few hundred have the key of another one, in regular ones up to a few per cent.
    """
    nodes = unsigned(cells).T
    np.einsum("ij,ij,ij->j", nodes, nodes, nodes, out=out[0], casting="unsafe")
    out[1] = out[0]


def without_doubles(content: Content, kind: str) -> None:
    """Leave out elements of a kind that are repeated with the same nodes, as in Gmsh's 2.2."""
    cells = content.cells[kind]
    short = content.keys.pop(kind, None)
    if short is None:
        short = np.empty((2, len(cells)), dtype=np.uint32)
        for piece in cached(len(cells)):
            short_keys(cells[piece], short[:, piece])
    keys = node_keys(cells.T.take(_maybe_repeated(*short), axis=1).T)
    keys.sort()
    if not (keys[1:] == keys[:-1]).any():
        return
    # Keep the first of each, and number the members of groups anew.
    _, first, same = np.unique(node_keys(cells), return_index=True, return_inverse=True)
    kept = np.sort(first)
    number = np.searchsorted(kept, first)[same.ravel()]
    content.cells[kind] = cells[kept]
    for group in content.groups.values():
        if kind in group:
            group[kind] = np.unique(number[group[kind]])


def _maybe_repeated(keys: NDArray[np.uint32], ordered: NDArray[np.uint32]) -> Integers:
    """Return the numbers of a few elements, among which all are whose short keys occur twice.

    The second array has the keys as well, and is sorted.
    """
    # Mark the upper halves of such keys, and find the elements that have them.
    ordered.sort()
    marked = np.zeros(1 << 16, dtype=bool)
    for piece in cached(len(keys)):
        part = ordered[piece.start : piece.stop + 1]
        twice = part[np.flatnonzero(part[1:] == part[:-1])]
        marked[twice >> _HALF] = True
    found = [np.zeros(0, dtype=np.intp)]
    for piece in cached(len(keys)):
        upper = (keys[piece] >> _HALF).astype(np.intp)
        found.append(piece.start + np.flatnonzero(marked[upper]))
    return np.concatenate(found)


def numbers_of(ids: Integers, wanted: Integers, what: str) -> Integers:
    """Return the positions of wanted numbers among the ids of a file, in any shape."""
    if len(ids) == 0:
        raise ValueError(f"the file has no {what}")
    # Numbers mostly count from a first one on
    wanted = compact(wanted)
    first = int(ids[0])
    if first == ids[0] and ids[-1] - first == len(ids) - 1 and (np.diff(ids) == 1).all():
        positions = wanted - (first if 0 <= first < _ROOM else np.int64(first))
        wrong: Any = False
        if wanted.size and (positions.min() < 0 or positions.max() >= len(ids)):
            wrong = (positions < 0) | (positions >= len(ids))
    else:
        order = np.argsort(ids, kind="stable")
        found = np.searchsorted(ids, wanted, sorter=order)
        positions = order[np.minimum(found, len(ids) - 1)]
        wrong = ids[positions] != wanted
    if np.any(wrong):
        missing = np.unique(np.asarray(wanted)[wrong])
        raise ValueError(
            f"{what} {missing[0]} does not exist, {len(missing)} in all: it is out of bounds, or "
            "the file is not complete"
        )
    return positions.astype(np.int32, copy=False)


def whole(values: Floats, what: str) -> Integers:
    """Return numbers of a table as whole numbers."""
    if len(values) and not (np.abs(values) < _EXACT).all():
        raise ValueError(f"a {what} has a number that is too large")
    numbers = values.astype(np.int64)
    if (numbers != values).any():
        wrong = values[np.argmax(numbers != values)]
        raise ValueError(f"a {what} has the number {wrong:g}, which is not whole")
    return numbers


def compact(numbers: Integers) -> Integers:
    """Return whole numbers with four bytes each, where they have room."""
    if numbers.dtype.itemsize <= 4 or numbers.size == 0:
        return numbers
    if unsigned(numbers).max() >= _ROOM:
        return numbers
    return numbers.astype(np.int32)


def rows(numbers: Any, width: int, what: str) -> Any:
    """Return numbers as rows of so many columns."""
    if numbers.size % width:
        raise ValueError(f"the file ends within {what}, or a line of them has too few numbers")
    return numbers.reshape(-1, width)


def parsed(text: bytes, what: str, dtype: type = float, commas: bool = False) -> Any:
    """Return the numbers of a text between blanks, or between commas and blanks, (n,).

    A long text is read in pieces, so that it is never copied as a whole.
    """
    import warnings

    found = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Parse pieces, which are small beside the file.
        for piece in pieces(text):
            words = piece
            if commas:
                words = piece.replace(b",", b" ")
            try:
                numbers: Any = np.fromstring(words, dtype=dtype, sep=" ")
            except (DeprecationWarning, ValueError) as error:
                raise ValueError(f"{what} are not all numbers") from error
            found.append(numbers if dtype is float else compact(numbers))
    if not found:
        return np.zeros(0, dtype)
    if len(found) == 1:
        return found[0]
    return np.concatenate(found)


def to_vtk(nodes: Integers, order: Sequence[int] | None) -> Integers:
    """Return nodes of elements, (n, k), in the order of VTK, which a format has as `order`."""
    if order is None:
        return nodes
    return nodes[:, order]


def from_vtk(nodes: Integers, order: Sequence[int] | None) -> Integers:
    """Return nodes in the order of VTK, (n, k), in the order of a format; see :func:`to_vtk`."""
    if order is None:
        return nodes
    return nodes[:, np.argsort(order)]


def read_text(path: str | PathLike[str]) -> bytes:
    """Return a text of a file without the mark that editors put before its first letter."""
    return Path(path).read_bytes().removeprefix(codecs.BOM_UTF8)


def read_included(path: Path) -> bytes:
    """Return the text of a file that another one includes."""
    if not path.is_file():
        raise ValueError(f"it includes the file {path}, which does not exist")
    return read_text(path)


def decoded(text: bytes) -> str:
    """Return a text in UTF-8, or in the letters of Windows where it is none."""
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("cp1252", "replace")


def pieces(text: bytes) -> Iterator[bytes]:
    """Yield a text in pieces of whole lines, without blank ones."""
    start = 0
    while start < len(text):
        end = text.find(b"\n", start + _PIECE)
        if end < 0:
            end = len(text)
        piece = text[start:end]
        start = end + 1
        if piece and not piece.isspace():
            yield piece


def check_count(count: int, size: int, what: str) -> int:
    """Refuse a number of entries for which a file of so many bytes is too short."""
    if count < 0 or count > size:
        raise ValueError(f"the file announces {count} {what}, but has {size} bytes: not complete")
    return int(count)


def members_by_tag(tags: Integers) -> dict[int, Integers]:
    """Return the ascending positions of every number among tags, by ascending numbers."""
    if len(tags) == 0:
        return {}
    # Sort runs of the same number by it, small numbers by digits.
    first = _begins(tags)
    of_run = tags[first]
    low = int(of_run.min())
    span = int(of_run.max()) - low
    small = np.empty(len(of_run), np.min_scalar_type(span))
    np.subtract(of_run, low, out=small, casting="unsafe")
    order = np.argsort(small, kind="stable")
    # Put the positions of the runs behind each other.
    count = np.diff(first, append=len(tags))[order]
    ends = np.append(0, np.cumsum(count))
    shift = (first[order] - ends[:-1]).astype(np.int32)
    positions = np.empty(len(tags), dtype=np.int32)
    for start in range(0, len(order), _RUNS):
        stop = min(start + _RUNS, len(order))
        part = slice(ends[start], ends[stop])
        positions[part] = np.repeat(shift[start:stop], count[start:stop])
        positions[part] += np.arange(ends[start], ends[stop], dtype=np.int32)
    # Cut them where the next number begins.
    ordered = small[order]
    begins = _begins(ordered)
    parts = np.split(positions, ends[begins[1:]])
    return {int(ordered[start]) + low: part for start, part in zip(begins, parts)}


def _begins(numbers: Integers) -> Integers:
    """Return the positions at which runs of the same number begin."""
    found = [np.zeros(1, dtype=np.intp)]
    for piece in cached(len(numbers)):
        part = numbers[piece.start : piece.stop + 1]
        found.append(piece.start + 1 + np.flatnonzero(part[1:] != part[:-1]))
    return np.concatenate(found)


def middles_of(x: Floats, kind: str) -> Floats:
    """Return the nodes in the middle, (n, 1 or 7, 3), of elements with nodes x, (n, n_nodes, 3).

    The functions of corners are -1/4 in the middle of a side and of the body, of edges 1/2
    and 1/4.
    """
    if kind.startswith("quad"):
        return _weighted(x[:, :8], 4, 0.5)[:, None]
    around = x[:, np.array(FACES_OF_27)]  # (n, faces, nodes, 3)
    faces = _weighted(around, 4, 0.5)
    body = _weighted(x[:, :20], 8, 0.25)
    return np.concatenate((faces, body[:, None]), axis=1)


def _weighted(x: Floats, corners: int, of_edge: float) -> Floats:
    """Return sums of nodes, (..., n_nodes, 3), corners by -1/4 and edges by a weight."""
    of_corners = x[..., :corners, :].sum(axis=-2)
    of_edges = x[..., corners:, :].sum(axis=-2)
    return np.asarray(of_edge * of_edges - 0.25 * of_corners)


def without_middles(content: Content, format_name: str) -> None:
    """Leave out nodes in the middle, for formats without them, where the shape stays the same."""
    # Only nodes in the middle between others may be left out.
    for kind, other, count in (("quad9", "quad8", 8), ("hexahedron27", "hexahedron20", 20)):
        cells = content.cells.pop(kind, None)
        if cells is None:
            continue
        if len(cells):
            x = content.points[cells]
            off = max_abs(x[:, count:] - middles_of(x, kind))
            if KINDS[kind].dim >= content.dim and off > _SAME * np.ptp(x, axis=1).max():
                raise ValueError(
                    f"{format_name} has no elements with nodes in the middle, and {off:.3g} is the "
                    "distance of one from where elements without it have it"
                )
        # The other elements have the same corners and edges.
        content.cells[other] = cells[:, :count]
        for group in content.groups.values():
            if kind in group:
                group[other] = group.pop(kind)
    _drop_unused_points(content)


def _drop_unused_points(content: Content) -> None:
    """Leave out points of no element."""
    used = np.zeros(len(content.points), dtype=bool)
    for cells in content.cells.values():
        used[cells] = True
    number = np.cumsum(used) - 1
    content.points = content.points[used]
    content.cells = {kind: number[cells] for kind, cells in content.cells.items()}


def check_names(content: Content, wrong: str, format_name: str) -> None:
    """Refuse names with characters that a format cannot have, and names without any."""
    for name in content.groups:
        found = []
        for letter in name:
            if letter in wrong or not letter.isprintable():
                found.append(letter)
        if found or not name.strip():
            raise ValueError(
                f"names in {format_name} have no {found[0] if found else 'blanks alone'!r}: rename "
                f"'{name}'"
            )


def table_text(numbers: Integers) -> str:
    """Return rows of whole numbers as lines."""
    return "".join(f"{' '.join(map(str, row))}\n" for row in numbers.tolist())


def point_text(points: Floats, separator: str = " ") -> str:
    """Return numbered points as lines, with all digits."""
    lines = []
    for number, x in enumerate(points.tolist(), start=1):
        lines.append(f"{number}{separator}{separator.join(map(repr, x))}\n")
    return "".join(lines)


def combinations(content: Content, kind: str) -> list[tuple[tuple[str, ...], Integers]]:
    """Return the elements of every combination of groups, with the names of the groups."""
    names = [name for name, group in content.groups.items() if kind in group]
    inside = np.zeros((len(content.cells[kind]), len(names)), dtype=bool)
    for column, name in enumerate(names):
        inside[content.groups[name][kind], column] = True
    # Number the combinations column by column, in the order of rows
    same = np.zeros(len(inside), dtype=np.int64)
    for chosen in inside.T:
        same = np.unique(2 * same + chosen, return_inverse=True)[1].ravel()
    found: list[tuple[tuple[str, ...], Integers]] = []
    for number in range(int(same.max(initial=-1)) + 1):
        members = np.flatnonzero(same == number)
        groups = tuple(name for name, has in zip(names, inside[members[0]]) if has)
        found.append((groups, members))
    return found
