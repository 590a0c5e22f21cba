"""Which facets of a surface follow each other, and meet at their sides."""
from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components


def ordered(ends: ndarray, name: str) -> ndarray:
    """Order in which facets, given by their end nodes (2, n), follow each other in one chain.

    Raises
    ------
    ValueError
        They branch, or consist of several pieces.
    """
    n = ends.shape[1]
    following = {int(node): k for k, node in enumerate(ends[0])}
    arriving = set(ends[1].tolist())
    if len(following) < n or len(arriving) < n:
        raise ValueError(f"boundary '{name}' is no single chain: it branches")
    first = [k for k in range(n) if int(ends[0, k]) not in arriving]
    if len(first) > 1:
        raise ValueError(f"boundary '{name}' is no single chain: it consists of {len(first)} pieces")
    order = [first[0] if first else 0]
    while (k := following.get(int(ends[1, order[-1]]))) is not None and k != order[0]:
        order.append(k)
    if len(order) < n:
        raise ValueError(f"boundary '{name}' is no single chain: {n - len(order)} of {n} facets are "
                         "not connected to the others")
    return np.array(order)


def following(n: int, closed: bool) -> ndarray:
    """Neighbours of the n facets of a chain, as :class:`Surface` has them, (n, 2)."""
    number = np.arange(n)
    neighbours = np.column_stack((number - 1, number + 1))
    if closed:
        return neighbours % n
    neighbours[-1, 1] = -1
    return neighbours


def adjacent(corners: ndarray, name: str) -> ndarray:
    """Facets in space beyond the sides of facets with these corners, (n_facets, n_sides), -1 beyond the rim.

    Raises
    ------
    ValueError
        A side belongs to more than two facets, neighbours have different outward sides, or parts in space meet only
        at a corner.
    """
    m, n = corners.shape
    start = np.stack((corners, np.roll(corners, -1, axis=1)), axis=2).reshape(-1, 2)
    _, number = np.unique(np.concatenate((start, start[:, ::-1])), axis=0, return_inverse=True)
    first, last = number.reshape(2, -1)
    if len(np.unique(first)) < len(first):
        raise ValueError(f"boundary '{name}' is no surface: an edge belongs to more than two facets, or two facets "
                         "there have opposite outward sides")
    begins = np.full(number.max() + 1, -1)
    begins[first] = np.repeat(np.arange(m), n)
    beyond = begins[last].reshape(m, n)
    if len(pinched := _pinched(corners, beyond)):
        raise ValueError(f"boundary '{name}' is no surface: parts of it meet only at a corner, at {len(pinched)} "
                         "nodes; give each part a boundary of its own")
    return beyond


def _pinched(corners: ndarray, neighbours: ndarray) -> ndarray:
    """Nodes whose facets do not all follow each other around them."""
    m, n = corners.shape
    facet, side = np.nonzero(neighbours >= 0)
    beyond = neighbours[facet, side]
    there = np.argmax(corners[beyond] == corners[facet, side][:, None], axis=1)
    same = coo_matrix((np.ones(len(facet)), (facet * n + side, beyond * n + there)), shape=(m * n, m * n))
    _, fan = connected_components(same, directed=False)
    node, fans = np.unique(corners.ravel()[np.unique(fan, return_index=True)[1]], return_counts=True)
    return np.asarray(node[fans > 1])
