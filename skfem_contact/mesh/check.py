"""Is a mesh fit for an analysis? A complaint names the elements and where they are."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from skfem import (
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

    An element is inverted if its Jacobian changes sign between its nodes. The sign itself means nothing,
    since scikit-fem's meshes run either way round. For first-order elements the test is sharp, for
    second-order ones an inversion between the nodes remains unseen. It is folded if a neighbour lies on the same side
    of the facet between them, as that of a triangle whose corner has been moved across the opposite side.

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
    jacobian = _jacobian_at_nodes(mesh)
    size = np.linalg.norm(np.ptp(corners, axis=1), axis=0)
    flat = np.flatnonzero(np.abs(jacobian).min(axis=1) <= _FLAT * size ** mesh.dim())
    if len(flat):
        raise _error("flat elements", "element", flat, corners.mean(axis=1))
    inverted = np.flatnonzero(jacobian.min(axis=1) * jacobian.max(axis=1) < 0)
    if len(inverted):
        raise _error("inverted elements", "element", inverted, corners.mean(axis=1))
    folded = _folded(mesh)
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


def _jacobian_at_nodes(mesh: Mesh) -> NDArray[np.float64]:
    """The determinant of the mapping at the nodes of every element, zeros included: (n_elements, n_nodes)."""
    element = mesh.elem()
    mapping = MappingIsoparametric(mesh, element)
    axes = range(mesh.dim())
    J = np.array([[mapping.J(i, j, element.doflocs.T) for j in axes] for i in axes])
    if len(J) == 2:
        return J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
    return np.einsum("i...,i...->...", J[0], np.cross(J[1], J[2], axis=0))


def _folded(mesh: Mesh) -> Indices:
    """Elements that lie on the same side of a facet as their neighbour."""
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    start, *others = (mesh.p[:, corner] for corner in mesh.facets[: mesh.dim(), inner])
    along, *across = (other - start for other in others)
    normal = np.cross(along, across[0], axis=0) if across else np.array([-along[1], along[0]])
    centroids = mesh.p[:, mesh.t].mean(axis=1)[:, mesh.f2t[:, inner]]  # of the two neighbours
    sides = np.einsum("ci,csi->si", normal, centroids - start[:, None])
    return np.unique(mesh.f2t[:, inner[sides[0] * sides[1] > 0]])


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
