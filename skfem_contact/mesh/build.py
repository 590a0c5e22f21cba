"""Meshes of scikit-fem from the content of files, with subdomains and boundaries."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from skfem import Mesh
from skfem.generic_utils import OrientedBoundary

from ..errors import warn
from .content import FACES_OF_27, Content, middles_of, without_doubles
from .facets import number_facets
from .kinds import KINDS, Floats, Integers, from_vtk
from .split import split as split_elements

#: Largest height of a plane mesh, as a share of its size.
_FLAT = 1e-9
#: Coordinates of the file that become x and y, by the plane of a section.
_AXES = {"xy": [0, 1], "xz": [0, 2], "yz": [1, 2]}
#: Kinds whose middle nodes are added, and the complete kinds.
_INCOMPLETE = {"quad8": "quad9", "hexahedron20": "hexahedron27"}
#: Words for groups of sides, by the dimension of the mesh.
_SIDES = {2: ("lines", "curve", "sides"), 3: ("faces", "surface", "sides")}


def mesh_of(content: Content, plane: str = "xy", factor: float = 1.0, split: bool = False) -> Mesh:
    """Return the mesh of a content.

    Plane meshes lie in a plane of the coordinates, which are multiplied by a factor. Elements of
    several kinds are divided on request.
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
    without_doubles(content, kind)

    # Number the nodes by scikit-fem, and tag elements and sides
    mesh, node = _bare_mesh(content, kind)
    content.cells[kind] = content.cells[kind][:1].copy()  # one for its kind: the mesh has them all
    subdomains = {}
    for name, group in content.groups.items():
        if kind in group and len(group[kind]):
            group[kind] = group[kind].astype(np.int32)
            subdomains[name] = group[kind]
    boundaries = _boundaries(content, mesh, node)
    _tell_left_out(content, boundaries)
    # No tags are None; a copy by `replace` would lose the facets
    mesh._boundaries = boundaries or None
    mesh._subdomains = subdomains or None
    return mesh


def _lay_flat(content: Content, plane: str) -> None:
    """Turn a section into the x-y plane."""
    used = np.unique(
        np.concatenate([cells.ravel() for kind, cells in content.cells.items() if KINDS[kind].dim])
    )
    extent = np.ptp(content.points[used], axis=0)
    axes = _AXES[plane]
    (normal,) = set(range(3)) - set(axes)
    if extent[normal] > _FLAT * extent[axes].max():
        flat = [
            name for name, kept in _AXES.items() if extent[3 - sum(kept)] <= _FLAT * extent.max()
        ]
        remedy = f": pass plane='{flat[0]}'" if flat else ": rotate it"
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
    known = content.cells.get(complete)
    completed = np.hstack((cells, number))
    first_number = 0 if known is None else len(known)
    content.cells[complete] = completed if known is None else np.concatenate((known, completed))
    for name, group in content.groups.items():
        if kind in group:
            content.add(name, complete, first_number + group.pop(kind))


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


def _bare_mesh(content: Content, kind: str) -> tuple[Mesh, Integers]:
    """Return the mesh without tags, and the new numbers of the nodes of the file, -1 for others."""
    shape = KINDS[kind]
    cells = content.cells[kind]
    if kind.startswith("hexahedron"):
        cells = cells[:, from_vtk(cells.shape[1])]
    corners = cells[:, : shape.corners].T
    used = np.zeros(len(content.points), dtype=bool)
    used[corners] = True
    node = np.cumsum(used, dtype=np.int32) - 1
    node[~used] = -1
    t = np.ascontiguousarray(node[corners])
    points = np.ascontiguousarray(content.points[used, : shape.dim].T)
    kind_of_mesh = shape.mesh
    assert kind_of_mesh is not None
    if shape.order == 1:
        return kind_of_mesh(points, t), node

    # Put the nodes between corners where scikit-fem numbers them
    template = kind_of_mesh()
    straight = replace(
        template, doflocs=np.zeros((shape.dim, points.shape[1])), t=t, validate=False
    )
    numbers = straight.dofs.element_dofs
    doflocs = np.zeros((shape.dim, straight.dofs.N))
    doflocs[:, numbers] = content.points[cells.T, : shape.dim].transpose(2, 0, 1)
    return replace(straight, doflocs=doflocs, validate=True), node


def _boundaries(content: Content, mesh: Mesh, node: Integers) -> dict[str, Integers]:
    """Return the facets of all groups of sides and of nodes."""
    boundaries: dict[str, Integers] = {}
    named: dict[str, list[OrientedBoundary]] = {}
    # Skip the numbering of facets where no side has a name.
    if not any(KINDS[kind].dim < content.dim for kind in content.cells) and not content.node_groups:
        return boundaries
    number_facets(mesh)
    finder = _Finder(mesh)
    # Find the facets of the elements of sides.
    for kind, cells in content.cells.items():
        groups = {name: group[kind] for name, group in content.groups.items() if kind in group}
        if KINDS[kind].dim == content.dim - 1 and groups:
            sides = node[cells[:, : KINDS[kind].corners]]
            for name, part in finder.facets(sides, groups).items():
                named.setdefault(name, []).append(part)
    # Keep the order of the file.
    for name in content.groups:
        if name in named:
            boundaries[name] = _joined(named[name])
    # A set of nodes names the sides between them, unless it has all nodes.
    for name, nodes in content.node_groups.items():
        found = finder.between(node[nodes])
        if len(found):
            boundaries.setdefault(name, found)
        elif len(nodes) < len(content.points):
            content.left_out.append(f"node set '{name}', between which there is no side")
    return boundaries


def _joined(parts: list[OrientedBoundary]) -> OrientedBoundary:
    """Return several boundaries as one."""
    if len(parts) == 1:
        return parts[0]
    orientations = np.concatenate([part.ori for part in parts])
    return OrientedBoundary(np.concatenate(parts), orientations)


class _Finder:
    """Facets of a mesh by their corners."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh

    def facets(self, sides: Integers, groups: dict[str, Integers]) -> dict[str, OrientedBoundary]:
        """Return the facets of groups of sides, whose corners are (n, corners)."""
        used = np.unique(np.concatenate(list(groups.values())))
        numbers = np.full(len(sides), -1)
        numbers[used] = self._numbers(sides[used])
        found = {}
        for name, members in groups.items():
            stray = np.count_nonzero(numbers[members] < 0)
            if stray:
                words = _SIDES[self.mesh.dim()]
                raise ValueError(
                    f"{stray} of {len(members)} {words[0]} of {words[1]} '{name}' are not "
                    f"{words[2]} of elements"
                )
            found[name] = self._seen(numbers[members], sides[members])
        return found

    def _seen(self, found: Integers, sides: Integers) -> OrientedBoundary:
        """Return facets as they are seen from the element behind them.

        The outward normal of that element points to the right of a line in the plane, and to where
        the corners go round anticlockwise in space.
        """
        normal = self._normals(sides)
        mesh = self.mesh
        first, second = mesh.f2t[:, found]
        middle = mesh.p[:, mesh.t[:, first]].mean(axis=1).T
        outward = mesh.p[:, mesh.facets[:, found]].mean(axis=1).T - middle
        seen_from_second = ((normal * outward).sum(axis=1) < 0) & (second >= 0)
        return OrientedBoundary(found.astype(np.int32), seen_from_second.astype(int))

    def between(self, nodes: Integers) -> Integers:
        """Return the facets all of whose corners are among nodes: outer ones if possible."""
        mesh = self.mesh
        chosen = np.zeros(mesh.nvertices, dtype=bool)
        chosen[nodes[nodes >= 0]] = True
        if chosen.all():
            return np.zeros(0, np.int32)
        found = np.flatnonzero(chosen[mesh.facets].all(axis=0))
        outer = found[mesh.f2t[1, found] < 0]
        return (outer if len(outer) else found).astype(np.int32)

    def _normals(self, sides: Integers) -> Floats:
        x = self.mesh.p[:, sides]  # (dim, n, corners)
        if self.mesh.dim() == 2:
            along = x[:, :, 1] - x[:, :, 0]
            return np.column_stack((along[1], -along[0]))
        last = sides.shape[1] - 1
        if last == 2:
            return np.cross((x[:, :, 1] - x[:, :, 0]).T, (x[:, :, 2] - x[:, :, 0]).T)
        return np.cross((x[:, :, 2] - x[:, :, 0]).T, (x[:, :, 3] - x[:, :, 1]).T)

    def _numbers(self, sides: Integers) -> Integers:
        """Return the numbers of the facets with these corners, or -1."""
        mesh = self.mesh
        found = np.full(len(sides), -1)
        if sides.shape[1] != len(mesh.facets):
            return found
        # Compare only facets all of whose corners occur.
        chosen = np.zeros(mesh.nvertices, dtype=bool)
        chosen[sides[sides >= 0]] = True
        known = np.flatnonzero(chosen[mesh.facets].all(axis=0))
        keys = _keys(np.vstack((mesh.facets[:, known].T, sides)), mesh.nvertices)
        own, wanted = keys[: len(known)], keys[len(known) :]
        # Look up the keys of the sides among those of the facets.
        order = np.argsort(own)
        place = np.searchsorted(own, wanted, sorter=order)
        inside = place < len(own)
        candidates = order[place[inside]]
        same = own[candidates] == wanted[inside]
        found[np.flatnonzero(inside)[same]] = known[candidates[same]]
        return found


def _keys(rows: Integers, count: int) -> Integers:
    """Return one number for every set of nodes, (n,); pairs are combined column by column."""
    ordered = np.sort(rows, axis=1).astype(np.int64)
    key = ordered[:, 0]
    for column in ordered.T[1:]:
        key = np.unique(key, return_inverse=True)[1].ravel() * (count + 1) + column
    return key


def _tell_left_out(content: Content, boundaries: dict[str, Integers]) -> None:
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
