"""Meshes to the files of other programs, with all their names."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike, fspath
from pathlib import Path

import numpy as np
from skfem import Mesh
from skfem.generic_utils import OrientedBoundary

from .check import check_topology, own_tags
from .content import Content
from .formats import abaqus, flac, gmsh, kratos, med, vtk
from .kinds import HEXAHEDRON, KINDS, Integers, oriented

#: Writers by the ends of names.
_WRITERS: dict[str, Callable[[Content, str], None]] = {
    ".msh": gmsh.write,
    ".inp": abaqus.write,
    ".vtu": vtk.write,
    ".med": med.write,
    ".mdpa": kratos.write,
    ".f3grid": flac.write,
}
#: Corners of the edges whose middles are nodes of elements of second order, in their order.
_EDGES = {
    "triangle6": KINDS["triangle6"].sides,
    "quad9": KINDS["quad9"].sides,
    "tetra10": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "hexahedron27": (
        *((0, 1), (1, 2), (2, 3), (3, 0)),
        *((4, 5), (5, 6), (6, 7), (7, 4)),
        *((0, 4), (1, 5), (2, 6), (3, 7)),
    ),
}
#: Number of the node in the middle of each side of a hexahedron, in the order of its sides.
_FACE_NODES = (24, 25, 22, 21, 23, 20)


def save_mesh(mesh: Mesh, path: str | PathLike[str]) -> None:
    """Save a mesh with its subdomains and boundaries, for other programs and for `load_mesh`.

    Elements have positive areas and volumes. Names may have colons, which ``Mesh.save`` and
    ``Mesh.load`` cut.

    Parameters
    ----------
    mesh
        Mesh of first or second order.
    path
        File of Gmsh (``.msh``, format 4.1), Abaqus or CalculiX (``.inp``, with plane strain), VTK
        (``.vtu``), Salome (``.med``, with h5py installed), Kratos (``.mdpa``) or FLAC3D
        (``.f3grid``). An existing file is replaced.

    Raises
    ------
    ValueError
        If the format has no such elements, or no such names: nothing is written.

    See Also
    --------
    load_mesh : Load the mesh of a file.

    Examples
    --------
    >>> import os, tempfile
    >>> from skfem import MeshTri
    >>> from skfem_contact.mesh import load_mesh
    >>> mesh = MeshTri().with_boundaries({"block:left": lambda x: x[0] == 0.0})
    >>> file = os.path.join(tempfile.mkdtemp(), "mesh.inp")
    >>> save_mesh(mesh, file)
    >>> list(load_mesh(file).boundaries)
    ['block:left']
    """
    name = fspath(path)
    writer = _WRITERS.get(Path(name).suffix.lower())
    if writer is None:
        raise ValueError(
            f"path must be the name of a file that ends with {', '.join(_WRITERS)}, not {name!r}"
        )
    check_topology(mesh)
    try:
        writer(content_of(mesh), name)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error


def content_of(mesh: Mesh) -> Content:
    """Return elements, named sides and groups of a mesh, in the order of VTK."""
    kind = next(name for name, shape in KINDS.items() if shape.mesh is type(mesh))
    shape = KINDS[kind]
    cells = mesh.dofs.element_dofs.T.astype(int)
    if kind.startswith("hexahedron"):
        cells = cells[:, HEXAHEDRON[: cells.shape[1]]]
    points = np.zeros((mesh.doflocs.shape[1], 3))
    points[:, : shape.dim] = mesh.doflocs.T
    cells = oriented(points, cells, kind)
    content = Content(points, {kind: cells})
    for name, members in own_tags(mesh.subdomains).items():
        content.add(name, kind, np.unique(members))

    # Give every named side its nodes, once, and the direction in which it is seen
    boundaries = own_tags(mesh.boundaries)
    if boundaries:
        facets = np.unique(np.concatenate([np.asarray(part) for part in boundaries.values()]))
        owners = _owners(mesh, boundaries, facets)
        sides, side_kind = _sides_of(mesh, cells, kind, facets, owners)
        content.cells[side_kind] = sides
        for name, members in boundaries.items():
            own = np.unique(np.asarray(members))
            content.add(name, side_kind, np.searchsorted(facets, own))
    return content


def _owners(mesh: Mesh, boundaries: dict[str, Integers], facets: Integers) -> Integers:
    """Return the elements from which facets are seen: of the last boundary with directions."""
    owners = mesh.f2t[0, facets]
    for part in boundaries.values():
        if isinstance(part, OrientedBoundary):
            numbers = np.asarray(part)
            second = (part.ori == 1) & (mesh.f2t[1, numbers] >= 0)
            place = np.searchsorted(facets, numbers)
            owners[place] = np.where(second, mesh.f2t[1, numbers], mesh.f2t[0, numbers])
    return owners


def _sides_of(
    mesh: Mesh,
    cells: Integers,
    kind: str,
    facets: Integers,
    owners: Integers,
) -> tuple[Integers, str]:
    """Return the nodes of facets, which go round as seen from outside of their owners."""
    # Find the side of its element with the same corners.
    shape = KINDS[kind]
    wanted = np.sort(mesh.facets[:, facets].T, axis=1)
    lists = _side_nodes(kind)
    sides = np.zeros((len(facets), len(lists[0])), dtype=int)
    for local, nodes in zip(shape.sides, lists):
        corners = np.sort(cells[owners][:, list(local)], axis=1)
        here = (corners == wanted).all(axis=1)
        sides[here] = cells[owners[here]][:, nodes]
    # Name the kind by its nodes.
    names = {
        (2, 2): "line",
        (2, 3): "line3",
        (3, 3): "triangle",
        (3, 6): "triangle6",
        (3, 4): "quad",
        (3, 9): "quad9",
    }
    return sides, names[shape.dim, sides.shape[1]]


def _side_nodes(kind: str) -> list[list[int]]:
    """Return the numbers of the nodes of every side: corners, edges, and the middle."""
    shape = KINDS[kind]
    if shape.order == 1:
        return [list(side) for side in shape.sides]
    number = {frozenset(edge): shape.corners + k for k, edge in enumerate(_EDGES[kind])}
    found = []
    for position, side in enumerate(shape.sides):
        count = 1
        if shape.dim == 3:
            count = len(side)
        middles = []
        for k in range(count):
            ends = frozenset((side[k], side[(k + 1) % len(side)]))
            middles.append(number[ends])
        nodes = [*side, *middles]
        if len(side) == 4:
            nodes.append(_FACE_NODES[position])
        found.append(nodes)
    return found
