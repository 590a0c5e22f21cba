"""Is a mesh fit for an analysis? A complaint names the elements and where they are."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from skfem import (
    ElementHex2,
    MappingIsoparametric,
    Mesh,
    MeshHex1,
    MeshHex2,
    MeshQuad1,
    MeshQuad2,
    MeshTet1,
    MeshTet2,
    MeshTri1,
    MeshTri2,
)
from skfem.generic_utils import OrientedBoundary

from ..errors import place

Indices = NDArray[np.integer]

_MESH_TYPES = (MeshTri1, MeshTri2, MeshQuad1, MeshQuad2, MeshTet1, MeshTet2, MeshHex1, MeshHex2)
# An element is flat if its Jacobian is below this part of its size squared (cubed in space): far below any shape of
# use (a needle of aspect ratio 1e6 has 1e-6), and above the round-off of coordinates (1e-13 at a distance of 1000
# element sizes).
_FLAT = 1e-10
_SHOWN = 5


def check_mesh(mesh: Mesh) -> None:
    """Raise an error if a mesh is not fit for an analysis.

    It is not if it has elements other than triangles, quadrilaterals, tetrahedra or hexahedra of first or second
    order, elements on top of each other, flat, inverted or folded elements, coordinates that are not finite, nodes that
    belong to no element, or tags that name elements or facets that do not exist.

    An element is inverted if its Jacobian changes sign between its nodes; a hexahedron is asked at the 27 nodes of one
    of second order. The sign itself means nothing, since scikit-fem's meshes run either way round. For other elements
    of first order the test is sharp, else an inversion between these points remains unseen. An element is folded if a
    neighbour lies on the same side of the facet between them, as that of a triangle whose corner has been moved across
    the opposite side.

    Parameters
    ----------
    mesh
        The mesh to check.

    Raises
    ------
    ValueError
        With the first few elements or nodes that are wrong, and where they are.

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
    check_topology(mesh)
    nodes = np.arange(mesh.doflocs.shape[1])
    free = np.setdiff1d(nodes, mesh.dofs.element_dofs)
    if len(free):
        raise _error("nodes of no element (join_bodies drops them)", "node", free, mesh.doflocs)
    lost = nodes[~np.isfinite(mesh.doflocs).all(axis=0)]
    if len(lost):
        raise _error("coordinates that are not finite", "node", lost, mesh.doflocs)

    corners = mesh.p[:, mesh.t]
    points = (ElementHex2() if mesh.dim() == 3 and len(mesh.t) == 8 else mesh.elem()).doflocs.T
    J = _derivatives(mesh, points)
    jacobian = (J[:, 0] * _cofactors(J)[0]).sum(axis=0)  # (n_elements, n_points)
    size = np.linalg.norm(np.ptp(corners, axis=1), axis=0)
    flat = np.flatnonzero(np.abs(jacobian).min(axis=1) <= _FLAT * size ** mesh.dim())
    if len(flat):
        raise _error("flat elements", "element", flat, corners.mean(axis=1))
    inverted = np.flatnonzero(jacobian.min(axis=1) * jacobian.max(axis=1) < 0)
    if len(inverted):
        raise _error("inverted elements", "element", inverted, corners.mean(axis=1))
    folded = _folded(mesh, np.sign(jacobian[:, 0]))
    if len(folded):
        raise _error("elements folded over their neighbours", "element", folded, corners.mean(axis=1))


def check_topology(mesh: Mesh) -> None:
    """The part of :func:`check_mesh` that a mesh must pass before its nodes can be renumbered."""
    if type(mesh) not in _MESH_TYPES:
        names = ", ".join(kind.__name__ for kind in _MESH_TYPES)
        raise ValueError(f"{type(mesh).__name__} is not supported; supported are {names}, one type in all")
    if mesh.t.size == 0:
        raise ValueError("the mesh has no elements")
    n_nodes = mesh.doflocs.shape[1]
    if mesh.t.min() < 0 or n_nodes < mesh.dofs.N:
        raise ValueError(
            f"the mesh has {n_nodes} nodes, but its elements need {mesh.dofs.N} "
            f"and have the corners {mesh.t.min()} to {mesh.t.max()}"
        )
    crowded = np.flatnonzero(np.bincount(mesh.t2f.ravel()) > 2)
    if len(crowded):
        elements = np.flatnonzero(np.isin(mesh.t2f, crowded).any(axis=0))
        problem = "elements on top of each other (three or more share a side; was a surface saved twice?)"
        raise _error(problem, "element", elements, mesh.p[:, mesh.t].mean(axis=1))
    _check_tags(own_tags(mesh.boundaries), "boundary", mesh.nfacets)
    _check_tags(own_tags(mesh.subdomains), "subdomain", mesh.nelements)


def own_tags(tags: Mapping[str, Indices] | None) -> dict[str, Indices]:
    """The user's tags, without Gmsh's bookkeeping that scikit-fem takes for a tag."""
    return {name: part for name, part in (tags or {}).items() if not name.startswith("gmsh:")}


def _derivatives(mesh: Mesh, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The derivatives dx_i/dX_j of the mapping at points of the reference element: (dim, dim, n_elements, n_points)."""
    mapping, axes = MappingIsoparametric(mesh, mesh.elem()), range(mesh.dim())
    return np.array([[mapping.J(i, j, points) for j in axes] for i in axes])


def _cofactors(J: NDArray[np.float64]) -> NDArray[np.float64]:
    """Derivatives of the determinant of J by its columns, which come first: (dim, dim, n_elements, n_points)."""
    if len(J) == 2:
        return np.array([[J[1, 1], -J[0, 1]], [-J[1, 0], J[0, 0]]])
    return np.array([np.cross(J[:, k - 2], J[:, k - 1], axis=0) for k in range(3)])


def _folded(mesh: Mesh, sign: NDArray[np.float64]) -> Indices:
    """Elements on the same side of a facet as their neighbour: in its middle both have the same outward normal.

    By Nanson's formula the normal is that of the reference element times the cofactors of the derivatives; `sign` is
    that of the Jacobian of every element.
    """
    refdom = mesh.elem.refdom
    J = _derivatives(mesh, np.column_stack([refdom.p[:, corners].mean(axis=1) for corners in refdom.facets]))
    normals = sign[:, None] * np.einsum("jcef,fj->cef", _cofactors(J), refdom.normals)
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    first, second = (normals[:, element, np.argmax(mesh.t2f[:, element] == inner, axis=0)]
                     for element in mesh.f2t[:, inner])
    return np.unique(mesh.f2t[:, inner[(first * second).sum(axis=0) > 0]])


def _check_tags(tags: Mapping[str, Indices], kind: str, count: int) -> None:
    for name, part in tags.items():
        if np.min(part, initial=0) < 0 or np.max(part, initial=0) >= count:
            raise ValueError(f"{kind} '{name}' has numbers outside 0..{count - 1}; is it from another mesh?")
        if isinstance(part, OrientedBoundary) and np.shape(part.ori) != part.shape:
            raise ValueError(f"{kind} '{name}' has {len(part)} facets, but {np.size(part.ori)} orientations")


def _error(problem: str, kind: str, numbers: Indices, x: NDArray[np.float64]) -> ValueError:
    """An error that shows the first few of the nodes or elements with a problem, and where they are."""
    shown = [f"{kind} {n} at {place(x[:, n])}" for n in numbers[:_SHOWN]]
    dots = ", ..." if len(numbers) > _SHOWN else ""
    return ValueError(f"{problem}, {len(numbers)} in all: {', '.join(shown)}{dots}")
