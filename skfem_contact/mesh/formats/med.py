"""Files of Salome and code_aster, .med, which are HDF5."""

from __future__ import annotations

from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...checks import look_up
from ...errors import warn
from ..content import (
    Content,
    cached,
    check_names,
    check_nodes,
    combinations,
    decoded,
    from_vtk,
    members_by_tag,
    short_keys,
    to_vtk,
)
from ..kinds import KINDS, N_NODES, Integers

#: Kinds of elements by their names in the file.
_KINDS = {
    "PO1": "vertex",
    "SE2": "line",
    "SE3": "line3",
    "TR3": "triangle",
    "TR6": "triangle6",
    "QU4": "quad",
    "QU8": "quad8",
    "QU9": "quad9",
    "TE4": "tetra",
    "T10": "tetra10",
    "HE8": "hexahedron",
    "H20": "hexahedron20",
    "H27": "hexahedron27",
    "PY5": "pyramid",
    "P13": "pyramid13",
    "PE6": "wedge",
    "P15": "wedge15",
}


#: Nodes in the order of VTK, where the two differ but for their direction: middles of sides.
_ORDER = {"hexahedron27": [*range(20), 24, 22, 21, 23, 20, 25, 26]}
#: Numbers of the shapes in the file: of corners or nodes, and of dimensions.
_SHAPES = {
    "line": 102,
    "line3": 103,
    "triangle": 203,
    "triangle6": 206,
    "quad": 204,
    "quad9": 209,
    "tetra": 304,
    "tetra10": 310,
    "hexahedron": 308,
    "hexahedron27": 327,
}
#: Coordinate systems but the cartesian one, 0.
_SYSTEMS = {1: "cylindrical", 2: "spherical"}
#: Steps of a mesh that does not move in time, and length of names.
_NO_STEP = -1
_LENGTH = 80


def read(path: str, name: str | None = None) -> Content:
    """Read the only mesh of a file, or the one of a name, with the groups of its families."""
    # Open the file.
    try:
        import h5py
    except ImportError as error:
        raise ImportError("h5py reads files of MED: pip install h5py") from error
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise ValueError("it is not a file of MED, or not complete") from error
    with file:
        try:
            octets: NDArray[np.uint8] = np.memmap(path, mode="r")
            if file.userblock_size:  # data sets are not counted from the first byte
                octets = octets[:0]
            return _read(file, name, octets)
        except (OSError, RuntimeError, AttributeError, TypeError) as error:  # damaged links
            raise ValueError(f"it is damaged or not complete ({error})") from error


def _read(file: Any, name: str | None, octets: NDArray[np.uint8]) -> Content:
    """Read a mesh of an open file, whose bytes are also in `octets`."""
    chosen = _chosen(file, name)
    mesh = file["ENS_MAA"][chosen]
    if chosen in file.get("FAS", {}):
        families = file["FAS"][chosen]
    else:
        families = {}
    # Coordinates along an axis or round a point are no x, y, z.
    system = int(mesh.attrs.get("REP", 0))
    if system != 0:
        raise ValueError(
            f"the mesh '{chosen}' has {_SYSTEMS.get(system, 'unknown')} coordinates: save it with "
            "cartesian ones"
        )
    steps = [step for step in mesh.values() if "NOE" in step]
    if len(steps) > 1:
        warn(
            f"the mesh '{chosen}' has {len(steps)} steps in time: the first one with elements is "
            "read"
        )
    # Take the first step of it that has nodes and elements.
    for step in (mesh, *mesh.values()):
        if "NOE" in step and "MAI" in step:
            return _content(step, int(mesh.attrs["ESP"]), families, octets)
    raise ValueError(f"the mesh '{chosen}' has no nodes or no elements")


def _chosen(file: Any, name: str | None) -> str:
    """Return the name of the mesh to read."""
    if "ENS_MAA" not in file:
        raise ValueError("it is not a file of MED: it has no mesh")
    meshes = list(file["ENS_MAA"])
    if not meshes:
        raise ValueError("it has no mesh")
    if name is not None:
        look_up(name, dict.fromkeys(meshes), "mesh")
        return name
    if len(meshes) > 1:
        raise ValueError(f"it has {len(meshes)} meshes, {', '.join(meshes)}: give one as name=")
    return str(meshes[0])


def _content(step: Any, dim: int, families: Any, octets: NDArray[np.uint8]) -> Content:
    """Read nodes and elements, which are stored component by component."""
    coordinates = np.array(_values(step["NOE"]["COO"].id, octets)).reshape(dim, -1)
    if dim < 3:
        coordinates = np.pad(coordinates, ((0, 3 - dim), (0, 0)))
    content = Content(coordinates.T, {})
    names = _names(families.get("ELEME", {}), octets)
    for word, block in step["MAI"].items():
        _add_elements(content, word, block, names, octets)
    if "FAM" in step["NOE"]:
        names = _names(families.get("NOEUD", {}), octets)
        _add_node_groups(content, _values(step["NOE"]["FAM"].id, octets), names)
    return content


def _add_elements(
    content: Content,
    word: str,
    block: Any,
    names: dict[int, list[str]],
    octets: NDArray[np.uint8],
) -> None:
    """Add the elements of a type, with the groups of their families."""
    if word not in _KINDS:
        raise ValueError(f"it has elements of type {word}, which are not read")
    kind = _KINDS[word]
    nodes = block["NOD"]
    _add_nodes(content, kind, _values(nodes.id, octets), int(nodes.attrs["NBR"]))
    if "FAM" in block:
        for number, members in members_by_tag(_values(block["FAM"].id, octets)).items():
            for name in names.get(number, ()):
                content.add(name, kind, members)


def _add_node_groups(content: Content, family: Integers, names: dict[int, list[str]]) -> None:
    """Add the groups of nodes, but ones whose name elements have as well."""
    for number, group in names.items():
        found = np.flatnonzero(family == number)
        for name in group:
            known = content.node_groups.get(name, found)
            content.node_groups[name] = np.union1d(known, found)
    for name in list(content.node_groups):
        named = any(KINDS[kind].dim for kind in content.groups.get(name, {}))
        if named or len(content.node_groups[name]) == 0:
            del content.node_groups[name]


def _values(data: Any, octets: NDArray[np.uint8]) -> Any:
    """Return the values of the id of a data set, without a copy where the file has them as such."""
    offset = data.get_offset()
    dtype = data.dtype
    shape = data.shape
    if offset is None or dtype.hasobject or len(octets) == 0:
        from h5py import Dataset

        return Dataset(data)[()]
    if offset + prod(shape) * dtype.itemsize > len(octets):
        raise ValueError("it is not complete: a data set ends behind the file")
    return np.ndarray(shape, dtype, octets, offset)


def _add_nodes(content: Content, kind: str, numbers: Integers, count: int) -> None:
    """Add the nodes of elements, (count, n_nodes), from zero on, with four bytes each."""
    # Refuse other numbers than nodes of so many elements.
    if numbers.dtype.kind not in "iu":
        raise ValueError(f"the nodes of a {kind} are no whole numbers")
    if len(numbers) != count * N_NODES[kind]:
        raise ValueError(
            f"it has {len(numbers)} numbers of nodes for {count} {kind}, which have "
            f"{N_NODES[kind]} each"
        )
    # The file has the first nodes of all elements, then the second ones, and so on.
    numbers = numbers.reshape(N_NODES[kind], count)
    nodes = np.empty(numbers.shape, dtype=np.int32)
    keys = np.empty((2, count), dtype=np.uint32)
    for piece in cached(count):
        part = numbers[:, piece] - 1
        check_nodes(part, len(content.points), kind)
        nodes[:, piece] = part
        short_keys(nodes[:, piece].T, keys[:, piece])
    content.cells[kind] = to_vtk(nodes.T, _ORDER.get(kind))
    content.keys[kind] = keys


def _names(families: Any, octets: NDArray[np.uint8]) -> dict[int, list[str]]:
    """Return the names of the groups of every family by its number."""
    from h5py import h5a, h5d

    found: dict[int, list[str]] = {}
    if not families:
        return found
    # The lower level of h5py takes a fifth of the time, and names are bytes in any letters.
    for path in families.id:
        if not families.id.links.exists(path + b"/GRO"):
            continue
        attribute = h5a.open(families.id, b"NUM", obj_name=path)
        number = np.empty(attribute.shape, dtype=np.int64)
        attribute.read(number)
        lines = _values(h5d.open(families.id, path + b"/GRO/NOM"), octets)
        texts = [line.astype(np.int8).tobytes().rstrip(b"\0 ") for line in lines]
        found[number.item()] = [decoded(text) for text in texts]
    return found


def write(content: Content, path: str) -> None:
    """Write nodes and elements; every combination of names is a family."""
    try:
        import h5py
    except ImportError as error:
        raise ImportError("h5py writes files of MED: pip install h5py") from error
    # Refuse names that do not fit.
    check_names(content, "\n", "files of MED")
    long = [name for name in content.groups if len(name.encode()) > _LENGTH]
    if long:
        raise ValueError(f"names in files of MED have {_LENGTH} letters: shorten '{long[0]}'")
    families: dict[tuple[str, ...], int] = {}
    # Write the head, the nodes and the elements.
    with h5py.File(path, "w") as file:
        head = file.create_group("INFOS_GENERALES")
        for name, value in (("MAJ", 4), ("MIN", 1), ("REL", 0)):
            head.attrs[name] = np.int32(value)
        step = _mesh_group(file, content.dim)
        step.attrs["CGT"] = np.int32(1)
        _write_points(step.create_group("NOE"), content)
        cells = step.create_group("MAI")
        cells.attrs["CGT"] = np.int32(1)
        for kind in content.cells:
            _write_cells(cells, content, kind, families)
        _write_families(file, families)


def _mesh_group(file: Any, dim: int) -> Any:
    """Create the group of the mesh, and return the group of its only step."""
    mesh = file.create_group("ENS_MAA/mesh")
    texts = {"DES": b"mesh", "NOM": b"X".ljust(16) + b"Y".ljust(16) + b"Z".ljust(16), "UNI": b""}
    for name, text in (*texts.items(), ("UNT", b"")):
        mesh.attrs[name] = np.bytes_(text)
    numbers = {"DIM": dim, "ESP": dim, "REP": 0, "SRT": 1, "TYP": 0, "NXI": -1, "NXT": -1}
    for name, value in numbers.items():
        mesh.attrs[name] = np.int32(value)
    step = mesh.create_group(f"{_NO_STEP:020d}{_NO_STEP:020d}")
    for name in ("NDT", "NOR", "NXI", "NXT", "PVI", "PVT"):
        step.attrs[name] = np.int32(_NO_STEP)
    step.attrs["PDT"] = 0.0
    return step


def _write_points(group: Any, content: Content) -> None:
    group.attrs["CGT"] = np.int32(1)
    group.attrs["CGS"] = np.int32(1)
    group.attrs["PFL"] = np.bytes_(b"MED_NO_PROFILE_INTERNAL")
    points = content.points[:, : content.dim]
    data = group.create_dataset("COO", data=points.T.ravel())
    data.attrs["CGT"] = np.int32(1)
    data.attrs["NBR"] = np.int32(len(points))


def _write_cells(
    parent: Any,
    content: Content,
    kind: str,
    families: dict[tuple[str, ...], int],
) -> None:
    """Write elements of one kind, bodies in the direction of the format."""
    # Bodies are numbered the other way round.
    cells = content.cells[kind]
    if KINDS[kind].dim == 3:
        cells = cells[:, list(KINDS[kind].mirrored)]
    cells = from_vtk(cells, _ORDER.get(kind))
    words = {known: word for word, known in _KINDS.items()}
    group = parent.create_group(words[kind])
    group.attrs["CGT"] = np.int32(1)
    group.attrs["CGS"] = np.int32(1)
    group.attrs["GEO"] = np.int32(_SHAPES[kind])
    group.attrs["PFL"] = np.bytes_(b"MED_NO_PROFILE_INTERNAL")
    # Elements with the same names are a family.
    family = np.zeros(len(cells), dtype=int)
    for names, members in combinations(content, kind):
        if names:
            family[members] = families.setdefault(names, -len(families) - 1)
    # Write the arrays with their sizes.
    for name, values in (("NOD", (cells + 1).T.ravel()), ("FAM", family)):
        data = group.create_dataset(name, data=values)
        data.attrs["CGT"] = np.int32(1)
        data.attrs["NBR"] = np.int32(len(cells))


def _write_families(file: Any, families: dict[tuple[str, ...], int]) -> None:
    """Write the names of the families, as rows of 80 bytes."""
    parent = file.create_group("FAS/mesh")
    parent.create_group("FAMILLE_ZERO").attrs["NUM"] = np.int32(0)
    if not families:
        return
    elements = parent.create_group("ELEME")
    for names, number in families.items():
        family = elements.create_group(f"FAM_{number}")
        family.attrs["NUM"] = np.int32(number)
        groups = family.create_group("GRO")
        groups.attrs["NBR"] = np.int32(len(names))
        letters = []
        for name in names:
            letters.append(np.frombuffer(name.encode().ljust(_LENGTH, b"\0"), np.int8))
        kind = np.dtype((np.int8, (_LENGTH,)))
        data = groups.create_dataset("NOM", (len(names),), dtype=kind)
        data[...] = np.array(letters)
