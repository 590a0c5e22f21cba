"""Checks of meshes, whose errors name the elements and their coordinates."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray
from skfem import ElementHex2, MappingIsoparametric, Mesh
from skfem.generic_utils import OrientedBoundary

from ..arrays import max_abs
from ..checks import check_no_mask, format_point, tags_with
from ..errors import warn
from .connections import (
    Outside,
    doubled_elements,
    hanging_nodes,
    loose_links,
    outside_of,
    touching_sides,
)
from .facets import number_facets

Indices = NDArray[np.integer]

_MESH_TYPES = (
    skfem.MeshTri1,
    skfem.MeshTri2,
    skfem.MeshQuad1,
    skfem.MeshQuad2,
    skfem.MeshTet1,
    skfem.MeshTet2,
    skfem.MeshHex1,
    skfem.MeshHex2,
)
#: Jacobian of a flat element over its size squared (cubed in space): far below any shape of use (a
#: needle of aspect ratio 1e6 has 1e-6), and above the round-off of coordinates (1e-13 at a distance
#: of 1000 element sizes).
_FLAT = 1e-10
#: Number of wrong nodes or elements that a message names.
_SHOWN = 5
#: Distance from the origin over the size of elements: squares fail from 3200 diagonals on, where
#: Newton's method of scikit-fem for points in them does not reach 1e-12, and `with_defaults` takes
#: wrong facets from 35,000 on.
_FAR = 2000.0
#: Names that `with_defaults` gives to the ends of the axes.
_ENDS = (("left", "right"), ("bottom", "top"), ("front", "back"))
#: Extent of a side along an axis over its size, below which it is normal to the axis.
_NORMAL = 1e-6


def check_mesh(mesh: Mesh, joined: ArrayLike | None = None) -> None:
    """Raise a ValueError with the first wrong elements or nodes of a mesh unfit for an analysis.

    A mesh is fit if it consists of triangles, quadrilaterals, tetrahedra or hexahedra of first or
    second order.  No elements may be duplicate, flat, inverted or folded.  All coordinates are
    finite, all nodes belong to elements, and tags name existing elements and facets.

    An element is inverted if its Jacobian changes sign between its nodes; a hexahedron is checked
    at 27 nodes.  The sign itself is arbitrary in scikit-fem.  The check is sharp for other elements
    of first order.  An element is folded if a neighbour lies on the same side of the facet between
    the two.

    A ``Model`` checks its mesh with the nodes of its contact pairs and of other forms that join
    bodies.

    Parameters
    ----------
    mesh
        Mesh of scikit-fem.
    joined
        Nodes, by their numbers, that contact or other forms join to each other: outer sides on
        which they lie may touch. By default the nodes of named boundaries, which contact pairs can
        join.

    Raises
    ------
    ValueError
        The first of these faults.

    Warns
    -----
    AnalysisWarning
        The mesh is fit, but it holds together in another way than it seems: nodes lie inside of
        sides of other elements, outer sides lie on each other without contact, elements lie on top
        of others, or parts are connected by single nodes.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import MeshQuad
    >>> check_mesh(MeshQuad())
    >>> check_mesh(MeshQuad(np.array([[0, 1, .2, 0], [0, 0, .2, 1]]), np.array([[0, 1, 2, 3]]).T))
    Traceback (most recent call last):
    ...
    ValueError: inverted elements, 1 in all: element 0 at (0.3, 0.3)
    """
    check_elements(mesh)
    if joined is None:
        named = [np.zeros(0, int), *own_tags(mesh.boundaries).values()]
        joined = mesh.facets[:, np.concatenate(named)].ravel()
    nodes = np.asarray(joined)
    if nodes.ndim != 1 or (nodes.size and nodes.dtype.kind not in "iu"):
        raise ValueError(f"joined must be numbers of nodes, (n,), not {joined!r}")
    check_connections(mesh, nodes.astype(int))


def check_elements(mesh: Mesh) -> None:
    """Check nodes, and the shape of elements."""
    check_topology(mesh)
    nodes = np.arange(mesh.doflocs.shape[1])
    unused = np.setdiff1d(nodes, mesh.dofs.element_dofs)
    if len(unused):
        raise _error("nodes of no element (join_bodies drops them)", "node", unused, mesh.doflocs)
    infinite = nodes[~np.isfinite(mesh.doflocs).all(axis=0)]
    if len(infinite):
        raise _error("coordinates that are not finite", "node", infinite, mesh.doflocs)

    # Compare the Jacobian at the nodes with the size of the elements, and its signs
    corners = mesh.p[:, mesh.t]  # (dim, corners, elements)
    centres = corners.mean(axis=1)
    hexahedra = mesh.dim() == 3 and len(mesh.t) == 8
    points = (ElementHex2() if hexahedra else mesh.elem()).doflocs.T
    J = _derivatives(mesh, points)
    jacobian = (J[:, 0] * _cofactors(J)[0]).sum(axis=0)  # (elements, points)
    size = np.linalg.norm(np.ptp(corners, axis=1), axis=0)
    flat = np.flatnonzero(np.abs(jacobian).min(axis=1) <= _FLAT * size ** mesh.dim())
    if len(flat):
        raise _error("flat elements", "element", flat, centres)
    inverted = np.flatnonzero(jacobian.min(axis=1) * jacobian.max(axis=1) < 0)
    if len(inverted):
        raise _error("inverted elements", "element", inverted, centres)

    middle = corners.mean(axis=(1, 2))
    if max_abs(middle) > _FAR * size.max():
        warn(
            f"the mesh lies at {format_point(middle)}, more than {_FAR:g} of its elements from the "
            "origin, where `with_defaults` takes wrong facets and quadrilaterals fail: move it by "
            "`mesh.translated` before"
        )
    folded = _folded(mesh, np.sign(jacobian[:, 0]))
    if len(folded):
        raise _error("elements folded over their neighbours", "element", folded, centres)
    check_ends(mesh)


def check_ends(mesh: Mesh) -> None:
    """Warn of ends of one axis that `with_defaults` has found among the sides of another one.

    It takes the sides whose middles are nearer to an end than a hundredth of the elements' lengths.
    """
    tags = own_tags(mesh.boundaries)
    corners = mesh.p[:, mesh.facets]  # (dim, corners, facets)
    extents = np.ptp(corners, axis=1)
    normal = extents <= _NORMAL * extents.max(axis=0)  # (dim, facets)
    # Find the sides at the ends of each axis that are normal to it, and those that are not.
    right: list[Indices] = []
    wrong: dict[str, Indices] = {}
    for axis, ends in enumerate(_ENDS[: mesh.dim()]):
        for name in tags:
            if name.rpartition(":")[2] not in ends:
                continue
            facets = np.asarray(tags[name])
            is_normal = normal[axis, facets]
            right.append(facets[is_normal])
            if is_normal.any():
                wrong[name] = facets[~is_normal]
    # Sides at the ends of two axes belong to the one that they are normal to.
    of_both = {
        name: np.intersect1d(facets, np.concatenate(right)) for name, facets in wrong.items()
    }
    names = [name for name, facets in of_both.items() if len(facets)]
    if names:
        _tell(
            f"the boundaries {names} contain sides along their axis, for `with_defaults` takes all "
            "within a hundredth of the length of the elements from the end (name boundaries by "
            "`with_boundaries`)",
            "side",
            np.unique(np.concatenate([of_both[name] for name in names])),
            corners.mean(axis=1),
        )


def check_connections(mesh: Mesh, joined: Indices, elements: Indices | None = None) -> None:
    """Warn of elements that are connected in another way than it seems.

    Outer sides of the `elements`, by default of all, may lie on each other at nodes that are
    joined.
    """
    # Compare elements with each other.
    doubled = doubled_elements(mesh)
    if len(doubled):
        middles = mesh.p[:, mesh.t].mean(axis=1)
        _tell("elements on top of others, each of which is stiff", "element", doubled, middles)
    # Find nodes inside of sides of other elements.
    outside = outside_of(mesh)
    hanging = hanging_nodes(outside, mesh.p.T)
    if len(hanging):
        _tell(
            "hanging nodes, inside of the side of another element, which does not follow them "
            "(divide that element)",
            "node",
            hanging,
            mesh.p,
        )
    # Outer sides of solids must not lie on each other without contact.
    if elements is not None:
        solid = np.isin(mesh.f2t[0, outside.facets], elements)
        outside = outside.part(solid)
    _check_touching(mesh, outside, hanging, joined)
    # Report parts that hinge on nodes.
    links = loose_links(mesh)
    if len(links) and not len(hanging):
        _tell(
            "parts of the mesh share no side but nodes, which act as hinges (join_bodies separates "
            "them)",
            "node",
            links,
            mesh.p,
        )


def _check_touching(mesh: Mesh, outside: Outside, hanging: Indices, joined: Indices) -> None:
    """Warn of outer sides on each other whose nodes do not hang and are not all joined."""
    first, second = touching_sides(outside)
    # Leave out sides that contact or hanging nodes explain.
    are_joined = np.isin(outside.nodes, joined)
    hang = np.isin(outside.nodes, hanging)
    unknown = ~np.any(hang, axis=1) & ~np.all(are_joined, axis=1)
    free = unknown[first] & unknown[second]
    # Name the subdomains at these sides.
    if free.any():
        sides = np.unique(np.concatenate((first[free], second[free])))
        element = mesh.f2t[0, outside.facets[sides]]
        names = tags_with(element, own_tags(mesh.subdomains))
        of = f" of {', '.join(names)}" if names else ""
        _tell(
            f"outer sides{of} lie on each other without contact, and part or penetrate freely "
            "(weld their nodes, or add a ContactPair)",
            "side",
            outside.facets[sides],
            mesh.p[:, mesh.facets].mean(axis=1),
        )


def _tell(problem: str, kind: str, numbers: Indices, x: NDArray[np.float64]) -> None:
    """Warn of nodes or elements."""
    warn(str(_error(problem, kind, numbers, x)))


def check_topology(mesh: Mesh) -> None:
    """Check element type and numbers of nodes, facets and tags, which new numbers rely on."""
    # Check the type.
    if type(mesh) not in _MESH_TYPES:
        names = ", ".join(kind.__name__ for kind in _MESH_TYPES)
        raise ValueError(
            f"{type(mesh).__name__} is not supported; supported are {names}, one type in all"
        )
    # Check the numbers of nodes.
    if mesh.t.size == 0:
        raise ValueError("the mesh has no elements")
    n_nodes = mesh.doflocs.shape[1]
    if mesh.t.min() < 0 or n_nodes < mesh.dofs.N:
        raise ValueError(
            f"the mesh has {n_nodes} nodes, but its elements need {mesh.dofs.N} "
            f"and have the corners {mesh.t.min()} to {mesh.t.max()}"
        )
    # A side belongs to one or two elements.
    number_facets(mesh)
    crowded = np.flatnonzero(np.bincount(mesh.t2f.ravel()) > 2)
    if len(crowded):
        elements = np.flatnonzero(np.isin(mesh.t2f, crowded).any(axis=0))
        problem = (
            "elements on top of each other (three or more share a side; was a surface saved twice?)"
        )
        raise _error(problem, "element", elements, mesh.p[:, mesh.t].mean(axis=1))
    check_tags(mesh)


def own_tags(tags: Mapping[str, Indices] | None) -> dict[str, Indices]:
    """Return the tags without the bookkeeping of Gmsh."""
    own = dict(tags or {})
    for name in tags or {}:
        if name.startswith("gmsh:"):
            del own[name]
    return own


def _derivatives(mesh: Mesh, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return dx_i/dX_j at points of the reference element: (dim, dim, n_elements, n_points)."""
    mapping = MappingIsoparametric(mesh, mesh.elem())
    axes = range(mesh.dim())
    return np.array([[mapping.J(i, j, points) for j in axes] for i in axes])


def _cofactors(J: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the derivatives of det J by its columns: (dim, dim, n_elements, n_points)."""
    if len(J) == 2:
        return np.array(
            [
                [J[1, 1], -J[0, 1]],
                [-J[1, 0], J[0, 0]],
            ]
        )
    rows = [np.cross(J[:, k - 2], J[:, k - 1], axis=0) for k in range(3)]
    return np.array(rows)


def _folded(mesh: Mesh, sign: NDArray[np.float64]) -> Indices:
    """Return the elements that lie on the same side of a facet as their neighbour.

    In the middle of such a facet both have the same outward normal: by Nanson's formula the normal
    of the reference element times the cofactors.  `sign` is the sign of each element's Jacobian.
    """
    refdom = mesh.elem.refdom
    middles = [refdom.p[:, corners].mean(axis=1) for corners in refdom.facets]
    cofactors = _cofactors(_derivatives(mesh, np.column_stack(middles)))
    normals = sign[:, None] * np.einsum("jcef,fj->cef", cofactors, refdom.normals)
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    first, second = (
        normals[:, element, np.argmax(mesh.t2f[:, element] == inner, axis=0)]
        for element in mesh.f2t[:, inner]
    )
    same_way = (first * second).sum(axis=0) > 0
    return np.unique(mesh.f2t[:, inner[same_way]])


def check_tags(mesh: Mesh) -> None:
    """Check the facets and elements that have names."""
    _check_numbers(own_tags(mesh.boundaries), "boundary", mesh.nfacets)
    _check_numbers(own_tags(mesh.subdomains), "subdomain", mesh.nelements)


def _check_numbers(tags: Mapping[str, Indices], kind: str, count: int) -> None:
    for name, part in tags.items():
        check_no_mask(part, f"{kind} '{name}'")
        if np.min(part, initial=0) < 0 or np.max(part, initial=0) >= count:
            raise ValueError(
                f"{kind} '{name}' has numbers outside 0..{count - 1}; is it from another mesh?"
            )
        if isinstance(part, OrientedBoundary) and np.shape(part.ori) != part.shape:
            raise ValueError(
                f"{kind} '{name}' has {len(part)} facets, but {np.size(part.ori)} orientations"
            )


def _error(problem: str, kind: str, numbers: Indices, x: NDArray[np.float64]) -> ValueError:
    """Create the error with the first few of the wrong nodes or elements and their coordinates."""
    shown = [f"{kind} {n} at {format_point(x[:, n])}" for n in numbers[:_SHOWN]]
    dots = ""
    if len(numbers) > _SHOWN:
        dots = ", ..."
    return ValueError(f"{problem}, {len(numbers)} in all: {', '.join(shown)}{dots}")
