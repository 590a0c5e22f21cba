"""Self-contact: facets of a folded surface that a point may touch, by their distance along it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import dijkstra

from ..arrays import row_norms
from ..surfaces.surface import Surface

#: Distance along the surface, as a multiple of the largest penetration, within which facets are
#: neighbours of a point: a point that shortens to a third of it still does not take its neighbours
#: for another wall.
_REACH = 3.0
_AT_ONCE = 1000  # nodes whose distances to all others are in memory


@dataclass(frozen=True, eq=False)
class Fold:
    """Facets of a master that adjoin each facet of a slave of the same nodes.

    Attributes
    ----------
    n_facets : int
        Number of the master's facets.
    keys : ndarray
        Pairs ``slave facet * n_facets + master facet``, ascending.
    """

    n_facets: int
    keys: ndarray

    @classmethod
    def of(cls, slave: Surface, master: Surface) -> Fold:
        """Return the neighbours within :data:`_REACH`, along the undeformed surface.

        Raises
        ------
        ValueError
            No facet has another one out of reach.
        """
        # Find the nodes within reach of each facet's nodes
        reach = _REACH * np.maximum(slave.size, slave.spacing)
        at_nodes = _largest_at_nodes(slave, reach)
        near = _within(slave, at_nodes)

        # Relate them to facets on both sides
        own = _incidence(slave)
        other = _incidence(master)
        pairs = coo_matrix(own @ near @ other.T)
        keys = np.unique(pairs.row.astype(np.int64) * len(master.facets) + pairs.col)
        if len(keys) == len(slave.facets) * len(master.facets):
            total = float(slave.area.sum())
            raise ValueError(
                f"'{slave.name}' cannot touch itself: all of its {len(slave.facets)} facets lie "
                f"within {float(reach.max()):.3g} of each other along the surface of size "
                f"{total:.3g}, and are neighbours; refine the mesh there, or take a longer boundary"
            )
        return cls(len(master.facets), keys)

    def adjoins(self, own: ndarray, facet: ndarray) -> ndarray:
        """Return a mask of pairs of the slave's and the master's facets that are neighbours."""
        key = own.astype(np.int64) * self.n_facets + facet
        at = np.searchsorted(self.keys, key).clip(max=len(self.keys) - 1)
        return np.asarray(self.keys[at] == key)

    def beside(self, surface: Surface, own: ndarray, facet: ndarray, feature: ndarray) -> ndarray:
        """Return a mask of closest points at sides beyond which neighbours lie.

        There the part of the surface that a point may touch ends, as at a rim.
        """
        beyond = surface.neighbours[facet]  # (n, n_sides)
        n_sides = beyond.shape[1]
        ends = np.zeros(beyond.shape, bool)
        for side in range(n_sides):
            exists = beyond[:, side] >= 0
            ends[:, side] = exists & self.adjoins(own, beyond[:, side].clip(0))
        at_side = np.arange(1, n_sides + 1) == feature[:, None]
        at_corner = (feature > n_sides)[:, None]
        return np.asarray((ends & (at_side | at_corner)).any(axis=1))


@dataclass(frozen=True, eq=False)
class Beside:
    """Neighbours of points that lie on facets of the slave."""

    fold: Fold
    own: ndarray

    def __call__(self, row: ndarray, facet: ndarray) -> ndarray:
        """Return a mask of pairs (point, facet of the master) that are neighbours."""
        return self.fold.adjoins(self.own[row], facet)


def _incidence(surface: Surface) -> csr_matrix:
    """Return the matrix of facets by their nodes, with ones."""
    m, k = surface.facets.shape
    rows = np.repeat(np.arange(m), k)
    shape = (m, len(surface.nodes))
    return csr_matrix((np.ones(m * k), (rows, surface.facets.ravel())), shape=shape)


def _largest_at_nodes(surface: Surface, values: ndarray) -> ndarray:
    """Return the largest value of the facets at each node."""
    result = np.zeros(len(surface.nodes))
    np.maximum.at(result, surface.facets.ravel(), np.repeat(values, surface.facets.shape[1]))
    return result


def _within(surface: Surface, reach: ndarray) -> csr_matrix:
    """Return ones at pairs of nodes whose distance along facets is within the first one's reach."""
    # Connect all nodes of each facet
    k = surface.facets.shape[1]
    first, second = np.triu_indices(k, 1)
    start = surface.facets[:, first].ravel()
    end = surface.facets[:, second].ravel()
    length = row_norms(surface.nodes[start] - surface.nodes[end])
    n = len(surface.nodes)
    pairs = np.sort(np.stack((start, end)), axis=0)
    once = np.unique(pairs, axis=1, return_index=True)[1]
    graph = csr_matrix((length[once], (start[once], end[once])), shape=(n, n))

    # Walk along them, some nodes at once
    rows = []
    columns = []
    for some in np.array_split(np.arange(n), n // _AT_ONCE + 1):
        away = dijkstra(graph, directed=False, indices=some, limit=float(reach.max()))
        row, column = np.nonzero(away <= reach[some, None])
        rows.append(some[row])
        columns.append(column)
    row = np.concatenate(rows)
    column = np.concatenate(columns)
    ones = np.ones(len(row))
    return csr_matrix((ones, (row, column)), shape=(n, n))
