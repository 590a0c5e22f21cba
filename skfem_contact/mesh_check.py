"""Is a mesh fit for an analysis? Complaints name the elements and where they are."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from skfem import MappingIsoparametric, Mesh, MeshQuad1, MeshQuad2, MeshTri1, MeshTri2

#: The mesh types that the package works with.
MESH_TYPES = (MeshTri1, MeshTri2, MeshQuad1, MeshQuad2)

# An element counts as flat when its Jacobian falls below this part of its size squared: far below any useful shape
# (a needle of aspect ratio 1e6 has 1e-6), far above the round-off of coordinates (1e-13 for |x| = 1000 sizes).
FLAT = 1e-10
SHOWN = 5


def check_mesh(mesh: Mesh) -> None:
    """Raise an error if no analysis can work on this mesh.

    Checked are the type (triangles or quadrilaterals, first or second order), node and facet numbers, coordinates
    that are not finite, nodes without an element, elements that overlap or are inverted or flat. The Jacobian of an
    element is looked at in its nodes: for first-order elements that is sufficient, for curved ones it is only
    necessary. Its sign is of no interest, since scikit-fem's meshes run either way round, but it must not change.

    Parameters
    ----------
    mesh
        The mesh to check.

    Raises
    ------
    ValueError
        With the first few elements or nodes that are wrong, and their coordinates.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import MeshQuad
    >>> check_mesh(MeshQuad())
    >>> check_mesh(MeshQuad(np.array([[0, 1, .2, 0], [0, 0, .2, 1.]]), np.array([[0, 1, 2, 3]]).T))
    Traceback (most recent call last):
    ...
    ValueError: 1 element inverted: its Jacobian changes sign between its nodes: element 0 around (0.3, 0.3)
    """
    check_topology(mesh)
    _check_coordinates(mesh)
    _check_shapes(mesh)


def check_topology(mesh: Mesh) -> None:
    """The part of :func:`check_mesh` that needs no coordinates; a mesh that fails it cannot even be renumbered."""
    if type(mesh) not in MESH_TYPES:
        names = ", ".join(kind.__name__ for kind in MESH_TYPES)
        raise ValueError(f"{type(mesh).__name__} is not supported; supported are {names}, one type at a time")
    if mesh.t.size == 0:
        raise ValueError("the mesh has no elements")
    if mesh.t.min() < 0 or mesh.dofs.N > mesh.doflocs.shape[1]:
        raise ValueError(
            f"the elements use nodes {mesh.t.min()} to {mesh.t.max()} and need {mesh.dofs.N} nodes in all, but the "
            f"mesh has {mesh.doflocs.shape[1]}"
        )
    users = np.bincount(mesh.t2f.ravel())
    crowded = np.flatnonzero(users > 2)
    if len(crowded):
        elements = np.flatnonzero(np.isin(mesh.t2f, crowded).any(axis=0))
        raise ValueError(
            f"{len(crowded)} element sides are used by more than two elements, so elements lie on top of each other "
            f"(was a surface saved twice?): {_where(mesh, elements, 'element')}"
        )
    for kind, tags, count in (
        ("boundary", mesh.boundaries, mesh.nfacets),
        ("subdomain", mesh.subdomains, mesh.nelements),
    ):
        for name, part in (tags or {}).items():
            if not name.startswith("gmsh:") and len(part) and not (0 <= np.min(part) and np.max(part) < count):
                raise ValueError(f"{kind} {name!r} holds numbers outside 0..{count - 1}: was it made for another mesh?")


def _check_coordinates(mesh: Mesh) -> None:
    used = np.zeros(mesh.doflocs.shape[1], dtype=bool)
    used[mesh.dofs.element_dofs] = True
    if not used.all():
        nodes = np.flatnonzero(~used)
        raise ValueError(
            f"{len(nodes)} nodes belong to no element (join_bodies drops them): "
            + _list(f"node {n} at {_point(mesh.doflocs[:, n])}" for n in nodes)
        )
    wrong = np.flatnonzero(~np.isfinite(mesh.doflocs).all(axis=0))
    if len(wrong):
        raise ValueError("coordinates are not finite: " + _list(f"node {n}, {_point(mesh.doflocs[:, n])}" for n in wrong))


def _check_shapes(mesh: Mesh) -> None:
    """Inverted and flat elements."""
    element = mesh.elem()
    jacobian = MappingIsoparametric(mesh, element).detDF(element.doflocs.T)
    corners = mesh.p[:, mesh.t]
    size = np.linalg.norm(np.ptp(corners, axis=1), axis=0)
    flat = np.flatnonzero(np.abs(jacobian).min(axis=1) <= FLAT * size**2)
    if len(flat):
        raise ValueError(f"{_count(flat)} flat: no area at a node: {_where(mesh, flat, 'element')}")
    inverted = np.flatnonzero(jacobian.min(axis=1) * jacobian.max(axis=1) < 0)
    if len(inverted):
        raise ValueError(
            f"{_count(inverted)} inverted: its Jacobian changes sign between its nodes: "
            f"{_where(mesh, inverted, 'element')}"
        )


def _count(elements: NDArray[np.intp]) -> str:
    return "1 element" if len(elements) == 1 else f"{len(elements)} elements"


def _where(mesh: Mesh, elements: NDArray[np.intp], what: str) -> str:
    return _list(f"{what} {n} around {_point(mesh.p[:, mesh.t[:, n]].mean(axis=1))}" for n in elements)


def _list(items: Iterable[str]) -> str:
    items = list(items)
    return ", ".join(items[:SHOWN]) + (", ..." if len(items) > SHOWN else "")


def _point(x: NDArray[np.float64]) -> str:
    return f"({x[0]:.4g}, {x[1]:.4g})"
