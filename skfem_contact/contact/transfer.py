"""Transfer of values from points of a slave to others, where cuts have followed the bodies."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy import ndarray

from ..surfaces.material_points import along_chain
from ..surfaces.surface import Surface
from .quadrature import SlavePoints

#: Weight of a point in space, over the largest one on its facet, below which new points inherit
#: nothing from it.
_SLIVER = 0.01


@dataclass(frozen=True, eq=False)
class Transfer:
    """Transfer of values between points of an undeformed slave: interpolated in the plane.

    In space points have the values of the nearest old one.
    """

    slave: Surface
    old: SlavePoints
    new: SlavePoints

    @cached_property
    def at(self) -> ndarray:
        """Number of the old point nearest to each new one, shape (n,)."""
        if self.slave.dim == 2:
            before, after = self._arcs
            return np.asarray(np.abs(after[:, None] - before).argmin(axis=1))
        # Slivers face facets beyond an edge, and know little about the points beside them
        old = self.old
        largest = np.zeros(len(self.slave.facets))
        np.maximum.at(largest, old.facet, old.weight)
        known = np.flatnonzero(old.weight >= _SLIVER * largest[old.facet])
        tree = scipy.spatial.cKDTree(self._positions_and_normals(old.take(known)))
        return known[tree.query(self._positions_and_normals(self.new))[1]]

    def of(self, values: ndarray) -> ndarray:
        """Return values (..., n_old) at the new points, (..., n)."""
        if self.slave.dim == 3:
            return np.asarray(values[..., self.at])
        before, after = self._arcs
        rows = values.reshape(-1, len(before))
        interpolated = np.array([np.interp(after, before, row) for row in rows])
        return interpolated.reshape(*values.shape[:-1], len(after))

    @cached_property
    def _arcs(self) -> tuple[ndarray, ndarray]:
        """Arc positions of old and new points along a chain."""
        before = along_chain(self.slave, self.old.facet, self.old.xi)
        return before, along_chain(self.slave, self.new.facet, self.new.xi)

    def _positions_and_normals(self, points: SlavePoints) -> ndarray:
        """Return coordinates in which points on facets of other directions are far away."""
        normal = self.slave.at(points.facet, points.xi, self.slave.nodes).normal
        return np.hstack((points.positions(self.slave.nodes), self.slave.spacing * normal))
