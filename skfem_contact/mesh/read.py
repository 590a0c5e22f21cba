"""Gmsh files with all their physical groups."""

from __future__ import annotations

from os import PathLike, fspath

import meshio
import numpy as np
from numpy.typing import NDArray
from skfem import Mesh
from skfem.io.meshio import from_meshio

#: Supported elements by meshio's names: number of corners, name of the lines along their sides.
_ELEMENTS = {
    "triangle": (3, "line"),
    "triangle6": (3, "line3"),
    "quad": (4, "line"),
    "quad9": (4, "line3"),
}
#: Names of physical groups without a name, before their number, by dimension.
_KINDS = {1: "curve", 2: "surface"}
_LOWER = {"vertex", "line", "line3"}

Integers = NDArray[np.integer]
#: Largest height of a plane mesh, as a share of its size.
_FLAT = 1e-9


def load_mesh(path: str | PathLike[str]) -> Mesh:
    """Load the plane mesh of a Gmsh file, with its physical surfaces and curves.

    Physical surfaces become subdomains, and physical curves become boundaries. Groups without a
    name are ``"surface 1"`` or ``"curve 3"``, by their numbers.
    ``skfem.Mesh.load`` loses the curves of second-order meshes, the curves between two surfaces in
    format 2.2, and the quadrilaterals of meshes that have triangles as well.

    Parameters
    ----------
    path
        Gmsh file (MSH 2.2 or 4.1, text or binary) with triangles or quadrilaterals of first or
        second order.  Curves and surfaces must have different names.

    Returns
    -------
    Mesh
        ``MeshTri``, ``MeshTri2``, ``MeshQuad`` or ``MeshQuad2`` without the nodes that belong to no
        element.

    Raises
    ------
    ValueError
        If the file is not a Gmsh mesh, has elements of several or unsupported types, or has a
        physical curve that does not follow the sides of elements.

    Examples
    --------
    >>> from importlib.resources import files
    >>> mesh = load_mesh(files("skfem_contact") / "data" / "culvert.msh")
    >>> sorted(mesh.subdomains)
    ['culvert', 'soft', 'stiff']
    >>> sorted(mesh.boundaries)
    ['bottom', 'culvert_inner', 'left', 'right', 'skin', 'surface']
    """
    try:
        return _plane_mesh(meshio.gmsh.read(fspath(path)))
    except FileNotFoundError:
        raise
    except meshio.ReadError as error:
        raise ValueError(
            f"{fspath(path)} is not a Gmsh mesh{f': {error}' if str(error) else ''}"
        ) from error
    except (ValueError, KeyError, IndexError) as error:  # the last two: a truncated file
        raise ValueError(f"{fspath(path)}: {error}") from error


def _plane_mesh(file: meshio.Mesh) -> Mesh:
    """Return the mesh of a file."""
    kind = _element_type(file)
    n_corners, line = _ELEMENTS[kind]
    elements, groups = _without_doubles(file.cells_dict[kind], _physical_groups(file, 2, kind))
    lines = file.cells_dict.get(line, np.empty((0, 2), dtype=int))[:, :2]

    # Refuse points that are no plane mesh
    if not np.isfinite(file.points).all():
        raise ValueError("the mesh has coordinates that are not finite")
    if np.ptp(file.points[:, 2:]) > _FLAT * np.ptp(file.points[:, :2]):
        raise ValueError(
            "the mesh does not lie in the x-y plane: rotate it, or export the coordinates x and y"
        )
    if elements.max(initial=0) >= len(file.points):
        raise ValueError(
            f"an element names node {elements.max() + 1}, but there are {len(file.points)}"
        )
    curves = _physical_groups(file, 1, line)
    _check_curves(curves, lines, elements[:, :n_corners])

    # Number the nodes of elements, corners first, as scikit-fem wants it
    corners = np.unique(elements[:, :n_corners])
    kept = np.concatenate((corners, np.setdiff1d(elements, corners)))
    number = np.zeros(len(file.points), dtype=int)
    number[kept] = np.arange(len(kept))
    cell_sets = {name: [members, None] for name, members in curves.items()}
    for name, members in groups.items():
        cell_sets[name] = [None, members]
    cells = [("line", number[lines]), (kind, number[elements])]
    return from_meshio(meshio.Mesh(file.points[kept], cells, cell_sets=cell_sets))


def _without_doubles(
    elements: Integers, groups: dict[str, Integers]
) -> tuple[Integers, dict[str, Integers]]:
    """Return elements and groups, where format 2.2 repeats the elements of overlapping groups."""
    first, same = np.unique(
        np.sort(elements, axis=1), axis=0, return_index=True, return_inverse=True
    )[1:]
    kept = np.sort(first)
    number = np.searchsorted(kept, first)[same.ravel()]
    return elements[kept], {name: np.unique(number[part]) for name, part in groups.items()}


def _element_type(file: meshio.Mesh) -> str:
    """Return the only type of elements in the file."""
    counts = {kind: len(cells) for kind, cells in file.cells_dict.items() if kind not in _LOWER}
    if len(counts) == 1 and set(counts) <= set(_ELEMENTS):
        return next(iter(counts))
    found = ", ".join(f"{count} {kind}" for kind, count in counts.items()) or "no elements"
    remedy = ""
    if len(counts) > 1:
        remedy = (
            "; in Gmsh, recombine all surfaces or none (Mesh.SubdivisionAlgorithm = 1 makes quads "
            "only)"
        )
    elif "quad8" in counts:
        remedy = "; in Gmsh, set Mesh.SecondOrderIncomplete = 0"
    raise ValueError(
        f"the mesh has {found}; supported is one type out of {', '.join(_ELEMENTS)}{remedy}"
    )


def _physical_groups(file: meshio.Mesh, dimension: int, cell_type: str) -> dict[str, Integers]:
    """Return the cells of the physical groups of a dimension, by name or as ``"curve 1"``."""
    names = {tag: name for name, (tag, dim) in file.field_data.items() if dim == dimension}
    tags = file.cell_data_dict.get("gmsh:physical", {}).get(cell_type, np.empty(0, int))
    tags = np.abs(tags)  # negative where a group lists a curve with a minus sign
    groups: dict[str, Integers] = {}
    for tag in dict.fromkeys((*names, *np.unique(tags[tags > 0]).tolist())):
        members = np.flatnonzero(tags == tag)
        if file.cell_sets and tag in names:  # format 4.1, whose cells may be in several groups
            listed = file.cell_sets_dict[names[tag]].get(cell_type, np.empty(0, int))
            members = np.union1d(members, listed).astype(int)
        if len(members):
            groups[names.get(tag, f"{_KINDS[dimension]} {tag}")] = members
    return groups


def _check_curves(curves: dict[str, Integers], lines: Integers, corners: Integers) -> None:
    """Check that every line of a named curve is a side of an element."""
    # Give every pair of nodes a number
    size = 1 + max(corners.max(), lines.max(initial=0))

    def keys(pairs: Integers) -> Integers:
        return pairs.min(axis=-1) * size + pairs.max(axis=-1)

    sides = np.stack((corners, np.roll(corners, -1, axis=1)), axis=-1)  # (elements, sides, 2)
    is_side = np.isin(keys(lines), keys(sides))
    for name, members in curves.items():
        stray = np.sum(~is_side[members])
        if stray:
            raise ValueError(
                f"{stray} of {len(members)} lines of curve '{name}' are not sides of elements"
            )
