"""Meshes of scikit-fem from the content of files, with subdomains and boundaries."""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array
from skfem import Mesh

from ..errors import warn
from .boundaries import Boundaries, Sides
from .content import FACES_OF_27, Content, middles_of, without_doubles
from .find_sides import named_sides, sides_between
from .kinds import KINDS, Integers, from_vtk
from .split import split as split_elements

#: Largest height of a plane mesh, as a share of its size.
_FLAT = 1e-9
#: Coordinates of the file that become x and y, by the plane of a section.
_AXES = {"xy": [0, 1], "xz": [0, 2], "yz": [1, 2]}
#: Corners that are marked at once, and number of points that are looked up instead.
_PIECE = 1 << 20
_FEW = 4
#: Kinds whose middle nodes are added, and the complete kinds.
_INCOMPLETE = {"quad8": "quad9", "hexahedron20": "hexahedron27"}


def mesh_of(
    content: Content,
    plane: str,
    factor: float,
    split: bool,
    file: str,
) -> Mesh:
    """Return the mesh of a content.

    Plane meshes lie in a plane of the coordinates, which are multiplied by a factor. Elements of
    several kinds are divided on request. Errors of sides, which are found later, name the file.
    """
    content.check()
    if content.dim < 2:
        raise ValueError(f"the mesh has no elements; {_supported()}")
    if content.dim == 2:
        _lay_flat(content, plane)
    elif plane != "xy":
        raise ValueError(f"the mesh is solid: plane='{plane}' is for sections")
    content.points = content.points * factor
    for kind, complete in _INCOMPLETE.items():
        if kind in content.cells and KINDS[kind].dim == content.dim:
            _complete(content, kind, complete)
    kind = _kind_of(content, split)
    # Corners by corners, as the mesh has them, elements are read several times faster.
    content.cells[kind] = np.asfortranarray(content.cells[kind], dtype=np.int32)
    without_doubles(content, kind)

    # Number the nodes by scikit-fem, and tag elements and sides.
    straight = _straight_mesh(content, kind)
    mesh, node = _bare_mesh(content, kind, straight)
    content.cells[kind] = content.cells[kind][:1].copy()  # one for its kind: the mesh has them all
    names = _names_of_sides(content)
    of_nodes = _sides_of_nodes(content, mesh, node, names)
    _tell_left_out(content)
    # No tags are None
    mesh._subdomains = _subdomains(content, kind) or None
    if names or of_nodes:
        bare = copy(straight)

        def find() -> dict[str, Sides]:
            """Return the sides of all names, which are the same by the nodes of the file."""
            try:
                return {**_sides_of_elements(content, bare, names), **of_nodes}
            except ValueError as error:
                raise ValueError(f"{file}: {error}") from error

        mesh._boundaries = Boundaries.of(mesh, [*names, *of_nodes], find)
    return mesh


def _subdomains(content: Content, kind: str) -> dict[str, Integers]:
    """Return the elements of all groups of bodies."""
    subdomains: dict[str, Integers] = {}
    for name, group in content.groups.items():
        members = group.get(kind)
        if members is not None and len(members):
            subdomains[name] = members.astype(np.int32, copy=False)
    return subdomains


def _lay_flat(content: Content, plane: str) -> None:
    """Turn a section into the x-y plane."""
    used = np.unique(
        np.concatenate([cells.ravel() for kind, cells in content.cells.items() if KINDS[kind].dim])
    )
    extent = np.ptp(content.points[used], axis=0)
    axes = _AXES[plane]
    (normal,) = set(range(3)) - set(axes)
    if extent[normal] > _FLAT * extent[axes].max():
        flat = []
        for name, kept in _AXES.items():
            if extent[3 - sum(kept)] <= _FLAT * extent.max():
                flat.append(name)
        remedy = ": rotate it, or add the volumes, if it is the surface of a body"
        if flat:
            remedy = f": pass plane='{flat[0]}'"
        raise ValueError(f"the mesh does not lie in the {plane[0]}-{plane[1]} plane{remedy}")
    height = np.zeros(len(content.points))
    content.points = np.column_stack((content.points[:, axes], height))


def _complete(content: Content, kind: str, complete: str) -> None:
    """Add the nodes in the middle of elements of 8 or 20 nodes, which keep their shape."""
    cells = content.cells.pop(kind)
    middles = middles_of(content.points[cells], kind)
    count = len(content.points)
    if kind == "quad8":
        points = middles[:, 0]
        number = count + np.arange(len(cells))[:, None]
    else:
        # Number the middles of sides once, and then the middles of the bodies
        corners = np.array(FACES_OF_27)[:, :4]
        sides = np.sort(cells[:, corners].reshape(-1, 4), axis=1)
        _, first, same = np.unique(sides, axis=0, return_index=True, return_inverse=True)
        points = np.concatenate((middles[:, :6].reshape(-1, 3)[first], middles[:, 6]))
        inner = len(first) + np.arange(len(cells))
        number = count + np.column_stack((same.reshape(-1, 6), inner))
    content.points = np.concatenate((content.points, points))
    numbers = content.add_cells(complete, np.hstack((cells, number)))
    for name, group in content.groups.items():
        if kind in group:
            content.add(name, complete, numbers[group.pop(kind)])


def _kind_of(content: Content, split: bool) -> str:
    """Return the only kind of elements of the highest dimension, after a division on request."""
    # Count the elements of each kind.
    counts = {}
    for kind, cells in content.cells.items():
        if KINDS[kind].dim == content.dim and len(cells):
            counts[kind] = len(cells)
    only = ""
    if len(counts) == 1:
        only = next(iter(counts))
    if only and KINDS[only].mesh is not None:
        return only
    # Divide several kinds into one, or refuse them with the remedy.
    if split:
        return split_elements(content)
    found = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    remedy = "; split=True divides them"
    if content.dim == 2 and len(counts) > 1:
        remedy += (
            "; in Gmsh, recombine all surfaces or none (Mesh.SubdivisionAlgorithm = 1 makes quads "
            "only)"
        )
    raise ValueError(f"the mesh has {found}; {_supported()}{remedy}")


def _supported() -> str:
    names = [name for name, kind in KINDS.items() if kind.mesh is not None]
    return f"supported is one type out of {', '.join(names)}"


def _in_order(content: Content, kind: str) -> Integers:
    """Return the nodes of elements, (n, n_nodes), in the order of scikit-fem."""
    cells = content.cells[kind]
    if kind.startswith("hexahedron"):
        return cells[:, from_vtk(cells.shape[1])]
    return cells


def _straight_mesh(content: Content, kind: str) -> Mesh:
    """Return the mesh of the corners of elements, with all nodes of the file."""
    shape = KINDS[kind]
    cells = _in_order(content, kind)
    t = np.ascontiguousarray(cells[:, : shape.corners].T)
    points = np.ascontiguousarray(content.points[:, : shape.dim].T)
    kind_of_mesh = shape.mesh
    assert kind_of_mesh is not None
    if shape.order > 1:
        t = t.copy()  # without the nodes between corners
    return kind_of_mesh(points, t)


def _used(t: Integers, n_points: int) -> NDArray[np.bool_]:
    """Return True for points that are corners of elements, t of (n_corners, n_elements).

    A sparse matrix marks them in half of the time of an assignment.
    """
    # Mark a corner of each element after the other. Inner ones of their order come first: in
    # regular meshes each of them has nearly all points. The last few points are looked up.
    used = np.zeros(n_points, dtype=bool)
    ones = np.ones(min(t.shape[1], _PIECE), dtype=bool)
    order = [*range(1, len(t)), 0]
    for done, corner in enumerate(order):
        others = np.flatnonzero(~used)
        if len(others) <= _FEW:
            for point in others:
                used[point] = any((t[left] == point).any() for left in order[done:])
            break
        for start in range(0, t.shape[1], _PIECE):
            nodes = t[corner, start : start + _PIECE]
            ends = np.array([0, len(nodes)], dtype=np.int32)
            used |= csc_array((ones[: len(nodes)], nodes, ends), shape=(n_points, 1)) @ ones[:1]
    return used


def _bare_mesh(content: Content, kind: str, straight: Mesh) -> tuple[Mesh, Integers]:
    """Return the mesh of used nodes, and their numbers by the nodes of the file, -1 for others."""
    # Number the corners in the order of the file; mostly these are all its nodes.
    used = _used(straight.t, len(content.points))
    node = np.arange(len(used), dtype=np.int32)
    if not used.all():
        node = np.cumsum(used, dtype=np.int32) - 1
        node[~used] = -1
        points = np.ascontiguousarray(straight.p[:, used])
        straight = replace(straight, doflocs=points, t=node[straight.t])
    if KINDS[kind].order == 1:
        return straight, node

    # Put the nodes between corners where scikit-fem numbers them.
    numbers = straight.dofs.element_dofs
    doflocs = np.zeros((len(straight.p), straight.dofs.N))
    cells = _in_order(content, kind)
    doflocs[:, numbers] = content.points[cells.T, : len(doflocs)].transpose(2, 0, 1)
    return replace(straight, doflocs=doflocs), node


def _names_of_sides(content: Content) -> list[str]:
    """Return the names of groups of sides, in the order of the file."""
    names = []
    for name, group in content.groups.items():
        if any(KINDS[kind].dim == content.dim - 1 for kind in group):
            names.append(name)
    return names


def _sides_of_elements(content: Content, mesh: Mesh, names: list[str]) -> dict[str, Sides]:
    """Return the sides of the elements behind those of groups."""
    named: dict[str, list[Sides]] = {}
    for kind, cells in content.cells.items():
        groups = {name: group[kind] for name, group in content.groups.items() if kind in group}
        if KINDS[kind].dim == content.dim - 1 and groups:
            corners = cells[:, : KINDS[kind].corners]
            for name, part in named_sides(mesh, corners, groups).items():
                named.setdefault(name, []).append(part)
    return {name: _joined(named[name]) for name in names}


def _sides_of_nodes(
    content: Content,
    mesh: Mesh,
    node: Integers,
    names: list[str],
) -> dict[str, Sides]:
    """Return the sides between the nodes of each group, unless it has all nodes or a known name."""
    sides: dict[str, Sides] = {}
    for name, nodes in content.node_groups.items():
        found = sides_between(mesh, node[nodes])
        if len(found.elements) == 0:
            if len(nodes) < len(content.points):
                content.left_out.append(f"node set '{name}', between which there is no side")
        elif name not in names:
            sides[name] = found
    return sides


def _joined(parts: list[Sides]) -> Sides:
    """Return the sides of several kinds together."""
    if len(parts) == 1:
        return parts[0]
    elements = np.concatenate([part.elements for part in parts])
    local = np.concatenate([part.local for part in parts])
    return Sides(elements, local, oriented=True)


def _tell_left_out(content: Content) -> None:
    """Warn of names and elements that are not in the mesh."""
    left_out = list(content.left_out)
    for name, group in content.groups.items():
        kinds = [kind for kind, members in group.items() if len(members)]
        lower = [kind for kind in kinds if KINDS[kind].dim < content.dim - 1]
        if lower and len(lower) == len(kinds):
            left_out.append(f"'{name}' ({', '.join(lower)})")
    if left_out:
        warn(
            "left out of the mesh, which names elements and their sides alone: "
            f"{', '.join(left_out[:10])}{', ...' if len(left_out) > 10 else ''}"
        )
