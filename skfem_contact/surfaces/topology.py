"""Topology of surfaces: facets of boundaries and of given cells, their order and their
neighbours.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from skfem import CellBasis

from ..checks import check_basis, facets_of
from .shape import Shape
from .vectors import across

#: Global dofs, or a field and numbers in it.
Numbers = ArrayLike | tuple[Hashable, ArrayLike]


def boundary(basis: CellBasis, name: str) -> tuple[ndarray, ndarray, ndarray, ndarray]:
    """Return dofs and coordinates of the nodes of a named boundary, its facets and their
    neighbours.
    """
    check_basis(basis)
    mesh = basis.mesh
    facets = np.unique(facets_of(mesh, name))
    if (mesh.f2t[1, facets] >= 0).any():
        raise ValueError(
            f"boundary '{name}' lies inside the mesh: its facets have elements on both sides; "
            "separate the bodies with join_bodies"
        )
    corners = _outward(mesh.p, mesh.t, mesh.facets[:, facets], mesh.f2t[0, facets])
    if mesh.dim() == 2:
        order = ordered(corners, name)
        facets, corners = facets[order], corners[:, order]
        neighbours = following(len(facets), bool(corners[0, 0] == corners[1, -1]))
    else:
        neighbours = adjacent(corners.T, name)
    dofs = _dofs(basis, facets, corners)
    unique, numbers = np.unique(dofs[..., 0], return_inverse=True)
    at_nodes = unique[:, None] + np.arange(mesh.dim())
    return at_nodes, basis.doflocs[:, unique].T.copy(), numbers.reshape(len(facets), -1), neighbours


def joined_cells(
    coordinates: ArrayLike, cells: ArrayLike, name: str
) -> tuple[ndarray, ndarray, ndarray, Shape]:
    """Return nodes, facets, neighbours and shape functions of given cells."""
    nodes, facets = np.array(coordinates, float), np.array(cells)
    n, dim = nodes.shape if nodes.ndim == 2 else (0, 0)
    try:
        shape = Shape.of_cells(dim, *facets.shape[1:])
    except (KeyError, TypeError):
        shape = None
    if shape is None or not ((facets >= 0) & (facets < n)).all() or not np.isfinite(nodes).all():
        raise ValueError(
            f"'{name}': cells must be numbers of 2 or 3 of the {n} nodes in the plane, and of 3, "
            f"4, 6, 8 "
            f"or 9 in space, with finite coordinates, not of shape {facets.shape}"
        )
    if dim == 3:
        return nodes, facets, adjacent(facets[:, : len(shape.corners)], name), shape
    facets = facets[ordered(facets[:, :2].T, name)]
    return nodes, facets, following(len(facets), bool(facets[0, 0] == facets[-1, 1])), shape


def ordered(ends: ndarray, name: str) -> ndarray:
    """Return the order in which facets, given by their end nodes, shape (2, n), follow each other
    in one chain.
    """
    n = ends.shape[1]
    following = {int(node): k for k, node in enumerate(ends[0])}
    arriving = set(ends[1].tolist())
    if len(following) < n or len(arriving) < n:
        raise ValueError(f"boundary '{name}' is no single chain: it branches")
    first = [k for k in range(n) if int(ends[0, k]) not in arriving]
    if len(first) > 1:
        raise ValueError(
            f"boundary '{name}' is no single chain: it consists of {len(first)} pieces"
        )
    order = [first[0] if first else 0]
    while (k := following.get(int(ends[1, order[-1]]))) is not None and k != order[0]:
        order.append(k)
    if len(order) < n:
        raise ValueError(
            f"boundary '{name}' is no single chain: {n - len(order)} of {n} facets are "
            "not connected to the others"
        )
    return np.array(order)


def following(n: int, closed: bool) -> ndarray:
    """Return the neighbours of the n facets of a chain, shape (n, 2)."""
    number = np.arange(n)
    neighbours = np.column_stack((number - 1, number + 1))
    if closed:
        return neighbours % n
    neighbours[-1, 1] = -1
    return neighbours


def adjacent(corners: ndarray, name: str) -> ndarray:
    """Return facets beyond the sides of facets in space, shape (n_facets, n_sides), -1 beyond the
    rim.
    """
    m, n = corners.shape
    start = np.stack((corners, np.roll(corners, -1, axis=1)), axis=2).reshape(-1, 2)
    _, number = np.unique(np.concatenate((start, start[:, ::-1])), axis=0, return_inverse=True)
    first, last = number.reshape(2, -1)
    if len(np.unique(first)) < len(first):
        raise ValueError(
            f"boundary '{name}' is no surface: an edge belongs to more than two facets, or two "
            f"facets "
            "there have opposite outward sides"
        )
    begins = np.full(number.max() + 1, -1)
    begins[first] = np.repeat(np.arange(m), n)
    beyond = begins[last].reshape(m, n)
    if len(pinched := _pinched(corners, beyond)):
        raise ValueError(
            f"boundary '{name}' is no surface: parts of it meet only at a corner, at "
            f"{len(pinched)} "
            "nodes; give each part a boundary of its own"
        )
    return beyond


def _pinched(corners: ndarray, neighbours: ndarray) -> ndarray:
    m, n = corners.shape
    facet, side = np.nonzero(neighbours >= 0)
    beyond = neighbours[facet, side]
    there = np.argmax(corners[beyond] == corners[facet, side][:, None], axis=1)
    same = coo_matrix(
        (np.ones(len(facet)), (facet * n + side, beyond * n + there)), shape=(m * n, m * n)
    )
    _, fan = connected_components(same, directed=False)
    node, fans = np.unique(
        corners.ravel()[np.unique(fan, return_index=True)[1]], return_counts=True
    )
    return np.asarray(node[fans > 1])


def numbers_of(given: Any, shape: tuple[int, ...], what: str) -> tuple[ndarray, Hashable]:
    """Return numbers of dofs as an array of a shape, and the field that they count in, or None."""
    has_field = (
        isinstance(given, tuple)
        and len(given) == 2
        and not isinstance(given[0], (int, np.integer, list, tuple, np.ndarray))
    )
    field, values = given if has_field else (None, given)
    numbers = np.asarray(values)
    if (
        numbers.size != np.prod(shape)
        or numbers.dtype.kind not in "iu"
        or numbers.min(initial=0) < -1
    ):
        raise ValueError(f"{what} must be whole numbers from -1 of shape {shape}, not {values!r}")
    return numbers.reshape(shape), field


def arms_of(offset: ndarray) -> ndarray:
    """Return displacements by unit rotations of points at an offset, shape (n, dim, 1 or 3)."""
    if offset.shape[1] == 2:
        return np.stack((-offset[:, 1], offset[:, 0]), axis=1)[:, :, None]
    return np.stack([np.cross(axis, offset) for axis in np.eye(3)], axis=2)


def _outward(p: ndarray, t: ndarray, corners: ndarray, element: ndarray) -> ndarray:
    x = p[:, corners].transpose(2, 1, 0)  # (n, corners, dim)
    inward = p[:, t[:, element]].mean(axis=1).T - x[:, 0]
    tangents = (
        x[:, [1]] - x[:, [0]]
        if len(p) == 2
        else np.stack((x[:, 1] - x[:, 0], x[:, -1] - x[:, 0]), axis=1)
    )
    inside_out = np.einsum("nc,nc->n", across(tangents), inward) > 0
    return np.where(inside_out, corners[::-1], corners)


def _dofs(basis: CellBasis, facets: ndarray, corners: ndarray) -> ndarray:
    """Return the dofs of the facets' nodes, shape (n_facets, k, dim): corners, edges in space, the
    facet itself.
    """
    mesh, dim = basis.mesh, basis.mesh.dim()
    dofs = [basis.nodal_dofs[:, corners]]
    if dim == 3 and len(basis.edge_dofs):
        n = np.int64(mesh.p.shape[1])
        ends = np.sort(np.stack((corners, np.roll(corners, -1, axis=0))), axis=0)
        key = mesh.edges.min(axis=0) * n + mesh.edges.max(axis=0)
        order = np.argsort(key)
        edge = order[np.searchsorted(key[order], ends[0] * n + ends[1])]
        dofs.append(basis.edge_dofs[:dim, edge])
    if basis.facet_dofs is not None and len(basis.facet_dofs):
        dofs.append(basis.facet_dofs[:dim, facets][:, None])
    return np.asarray(np.concatenate(dofs, axis=1).transpose(2, 1, 0))
