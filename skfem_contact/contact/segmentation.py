"""Where a slave is cut by the segments of a master in the plane, and how far cuts move."""
from __future__ import annotations

import numpy as np
from numpy import ndarray

from ..surfaces.surface import Surface
from .neighbours import NeighbourList
from .search import project

#: Pieces shorter than this share of a segment are left out.
_SLIVER = 1e-9


def common_cuts(slave: Surface, slave_nodes: ndarray, master: Surface, master_nodes: ndarray, facing: NeighbourList
                ) -> ndarray:
    """Chain coordinates at which the slave is cut: by its own segments' ends and by those of the master.

    Between the cuts gap and shape functions are smooth on both sides, so that Gauss points on the pieces integrate
    the contact work exactly on flat interfaces: the patch test is passed.
    """
    m = len(master.facets)
    ends = master.at(np.arange(m), -np.ones((m, 1)), master_nodes, 0).x[0]
    if not master.closed:
        ends = np.concatenate((ends, master.at(np.array([m - 1]), np.ones((1, 1)), master_nodes, 0).x[0]))
    near = np.full(len(ends), slave.spacing)
    found = project(slave, slave_nodes, ends, near, among=facing.at(slave_nodes, ends))
    hit = found.found & ~found.vertex & (np.abs(found.xi[:, 0]) < 1.0) & (found.gap < near)
    inner = found.facet[hit] + 0.5 * (1.0 + found.xi[hit, 0])
    cuts = np.unique(np.concatenate((np.arange(len(slave.facets) + 1.0), inner)))
    tiny = np.diff(cuts) < _SLIVER
    drop = np.flatnonzero(tiny) + np.where(cuts[1:][tiny] % 1.0 == 0.0, 0, 1)  # keep the segments' own ends
    return np.delete(cuts, drop)


def moved(old: ndarray, new: ndarray) -> float:
    """Largest distance of a cut, old or new, from the nearest one among the others; in space, change of an area."""
    if old.ndim == 2:
        return _area_changed(old, new)

    def farthest(a: ndarray, b: ndarray) -> float:
        right = np.clip(np.searchsorted(b, a), 1, len(b) - 1)
        return float(np.minimum(np.abs(a - b[right - 1]), np.abs(a - b[right])).max())

    return max(farthest(old, new), farthest(new, old))


def _area_changed(old: ndarray, new: ndarray) -> float:
    """Largest change of what a facet has in common with one of the master, over the largest such area."""
    pairs, number = np.unique(np.concatenate((old, new))[:, [0, 4]], axis=0, return_inverse=True)
    before, after = (np.bincount(rows, cuts[:, 3], minlength=len(pairs)) for rows, cuts in (
        (number.ravel()[:len(old)], old), (number.ravel()[len(old):], new)))
    return float(np.abs(after - before).max() / before.max())
