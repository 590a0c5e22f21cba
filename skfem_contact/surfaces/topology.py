"""Topology of surfaces: facets of boundaries and of given cells, their order and neighbours."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis

from ..checks import check_basis, facets_of
from ..sparse import parts_of
from .shape import Shape
from .vectors import across, dot

#: Global dofs, or a field and numbers in it.
Numbers = ArrayLike | tuple[Hashable, ArrayLike]


def boundary(basis: CellBasis, name: str) -> tuple[ndarray, ndarray, ndarray, ndarray, ndarray]:
    """Return dofs, coordinates, facets, their neighbours and elements of a named boundary."""
    check_basis(basis)
    mesh = basis.mesh
    facets = np.unique(facets_of(mesh, name))
    if (mesh.f2t[1, facets] >= 0).any():
        raise ValueError(
            f"boundary '{name}' lies inside the mesh: its facets have elements on both sides; "
            "separate the bodies with join_bodies"
        )
    # Turn the facets so that the body lies on one side, and order them.
    corners, dofs_of = facets_and_dofs(basis, facets)
    if mesh.dim() == 2:
        order = ordered(corners, name)
        corners = corners[:, order]
        dofs_of = dofs_of[order]
        neighbours = following(len(facets), bool(corners[0, 0] == corners[1, -1]))
    else:
        neighbours = adjacent(corners.T, name)
    # number the nodes by their first displacement
    first_dofs = dofs_of[..., 0]
    unique, numbers = np.unique(first_dofs, return_inverse=True)
    dofs = unique[:, None] + np.arange(mesh.dim())
    nodes = basis.doflocs[:, unique].T.copy()
    elements = np.unique(mesh.f2t[0, facets])
    return dofs, nodes, numbers.reshape(len(facets), -1), neighbours, elements


def facets_and_dofs(basis: CellBasis, facets: ndarray) -> tuple[ndarray, ndarray]:
    """Return corners, (k, n), and dofs at the nodes of facets, (n, nodes, dim).

    Their normals point out of their first elements.
    """
    mesh = basis.mesh
    corners = _outward(mesh.p, mesh.t, mesh.facets[:, facets], mesh.f2t[0, facets])
    return corners, _dofs(basis, facets, corners)


def joined_cells(
    coordinates: ArrayLike, cells: ArrayLike, name: str
) -> tuple[ndarray, ndarray, ndarray, Shape]:
    """Return nodes, facets, neighbours and shape functions of given cells."""
    nodes = np.array(coordinates, float)
    facets = np.array(cells)
    n, dim = nodes.shape if nodes.ndim == 2 else (0, 0)
    # Find the shape by the number of nodes.
    try:
        shape = Shape.of_cells(dim, *facets.shape[1:])
    except (KeyError, TypeError):
        shape = None
    if shape is None or not ((facets >= 0) & (facets < n)).all() or not np.isfinite(nodes).all():
        raise ValueError(
            f"'{name}': cells must be numbers of 2 or 3 of the {n} nodes in the plane, and of 3, "
            f"4, 6, 8 or 9 in space, with finite coordinates, not of shape {facets.shape}"
        )
    # Order the facets of a line one after the other.
    if dim == 3:
        return nodes, facets, adjacent(facets[:, : len(shape.corners)], name), shape
    facets = facets[ordered(facets[:, :2].T, name)]
    closed = bool(facets[0, 0] == facets[-1, 1])
    return nodes, facets, following(len(facets), closed), shape


def ordered(ends: ndarray, name: str) -> ndarray:
    """Return the order in which facets of end nodes, shape (2, n), follow in one chain."""
    n = ends.shape[1]
    starts = ends[0].tolist()
    arrivals = ends[1].tolist()
    # Each node is the start of one facet at most, and the end of one.
    facet_from = {node: k for k, node in enumerate(starts)}
    reached = set(arrivals)
    if len(facet_from) < n or len(reached) < n:
        raise ValueError(
            f"boundary '{name}' is no single chain: it branches; name its branches apart"
        )
    first = [k for k in range(n) if starts[k] not in reached]
    if len(first) > 1:
        raise ValueError(
            f"boundary '{name}' is no single chain: it consists of {len(first)} pieces; name them "
            "apart, and give each a pair of its own"
        )
    # follow the chain to its end, or once round
    order = first or [0]
    for _ in range(n - 1):
        k = facet_from.get(arrivals[order[-1]], order[0])
        if k == order[0]:
            break
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
    """Return facets beyond the sides of facets in space, shape (n_facets, n_sides), -1 at rims."""
    m, n = corners.shape
    # number the edges, directed as their own facet goes round and as the facet beyond does
    edges = np.stack((corners, np.roll(corners, -1, axis=1)), axis=2).reshape(-1, 2)
    both = np.concatenate((edges, edges[:, ::-1]))
    _, number = np.unique(both, axis=0, return_inverse=True)
    own, opposite = number.reshape(2, -1)
    if len(np.unique(own)) < len(own):
        raise ValueError(
            f"boundary '{name}' is no surface: an edge belongs to more than two facets, or two "
            "facets there have opposite outward sides"
        )
    # The facet beyond an edge has the edge in the other direction.
    facet_of = np.full(number.max() + 1, -1)
    facet_of[own] = np.repeat(np.arange(m), n)
    neighbours = facet_of[opposite].reshape(m, n)
    pinched = _pinched(corners, neighbours)
    if len(pinched):
        raise ValueError(
            f"boundary '{name}' is no surface: parts of it meet only at a corner, at "
            f"{len(pinched)} nodes; give each part a boundary of its own"
        )
    return neighbours


def _pinched(corners: ndarray, neighbours: ndarray) -> ndarray:
    """Return nodes at which more than one fan of facets meets."""
    m, n = corners.shape
    # tie the corners of facets that share a side
    facet, side = np.nonzero(neighbours >= 0)
    beyond = neighbours[facet, side]
    corner_beyond = np.argmax(corners[beyond] == corners[facet, side][:, None], axis=1)
    fan = parts_of(m * n, facet * n + side, beyond * n + corner_beyond)
    # count the fans at every node
    _, first = np.unique(fan, return_index=True)
    node, fans = np.unique(corners.ravel()[first], return_counts=True)
    return np.asarray(node[fans > 1])


def numbers_of(given: Any, shape: tuple[int, ...], what: str) -> tuple[ndarray, Hashable]:
    """Return numbers of dofs as an array of a shape, and the field that they count in, or None."""
    field: Hashable = None
    values = given
    if isinstance(given, tuple) and len(given) == 2:
        number_like = (int, np.integer, list, tuple, np.ndarray)
        if not isinstance(given[0], number_like):
            field, values = given
    # Numbers from -1, which is a fixed dof.
    numbers = np.asarray(values)
    whole = numbers.dtype.kind in "iu"
    if numbers.size != np.prod(shape) or not whole or numbers.min(initial=0) < -1:
        raise ValueError(f"{what} must be whole numbers from -1 of shape {shape}, not {values!r}")
    return numbers.reshape(shape), field


def arms_of(offset: ndarray) -> ndarray:
    """Return displacements by unit rotations of points at an offset, shape (n, dim, 1 or 3)."""
    if offset.shape[1] == 2:
        arms = np.stack((-offset[:, 1], offset[:, 0]), axis=1)
        return arms[:, :, None]
    return np.stack([np.cross(axis, offset) for axis in np.eye(3)], axis=2)


def _outward(p: ndarray, t: ndarray, corners: ndarray, element: ndarray) -> ndarray:
    """Return the corners of facets in the order that turns their normals out of the elements."""
    x = p[:, corners].transpose(2, 1, 0)  # (n, corners, dim)
    vertices = t[:, element]
    centre = p[:, vertices].mean(axis=1).T
    inward = centre - x[:, 0]
    sides = [1] if len(p) == 2 else [1, -1]
    normal = across(x[:, sides] - x[:, [0]])
    inside_out = dot(normal, inward) > 0
    return np.where(inside_out, corners[::-1], corners)


def _dofs(basis: CellBasis, facets: ndarray, corners: ndarray) -> ndarray:
    """Return dofs at corners, edges and middles of facets, shape (n_facets, k, dim)."""
    mesh = basis.mesh
    dim = mesh.dim()
    dofs = [basis.nodal_dofs[:, corners]]
    if dim == 3 and len(basis.edge_dofs):
        # find the edges by a key of their two vertices
        n = np.int64(mesh.p.shape[1])
        following_corners = np.roll(corners, -1, axis=0)
        low = np.minimum(corners, following_corners)
        high = np.maximum(corners, following_corners)
        key = mesh.edges.min(axis=0) * n + mesh.edges.max(axis=0)
        order = np.argsort(key)
        edge = order[np.searchsorted(key[order], low * n + high)]
        dofs.append(basis.edge_dofs[:dim, edge])
    if basis.facet_dofs is not None and len(basis.facet_dofs):
        # Middles of facets come last.
        dofs.append(basis.facet_dofs[:dim, facets][:, None])
    return np.asarray(np.concatenate(dofs, axis=1).transpose(2, 1, 0))
