"""Flow of water through ground that stores it: the water balance of a step in time."""

from __future__ import annotations

from copy import copy

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags
from skfem import CellBasis
from typing_extensions import override

from ..arrays import quotient
from .darcy import DarcyFlow
from .retention import Laws


class StoringFlow(DarcyFlow):
    r"""Flow with the rate of the stored water, :math:`(\theta(h) - \theta_0) / \Delta t`.

    The form is mixed. The water is stored at the corners of the elements (lumped), so that a front
    neither over- nor undershoots. The permeability is that of the corners too, interpolated: water
    enters dry ground whatever its suction. The storage, (n_elements,), is the water that saturated
    ground takes per volume and head.
    """

    def __init__(
        self,
        basis: CellBasis,
        tensors: ndarray,
        laws: Laws,
        storage: ndarray,
        axisymmetric: bool,
        datum: float,
    ) -> None:
        super().__init__(basis, tensors, axisymmetric, datum)
        self._laws = laws
        self._storage = storage[:, None]
        #: residual and saturated content of water, (n_elements, 1)
        self.least = np.zeros((basis.nelems, 1))
        self.most = np.zeros((basis.nelems, 1))
        for part, law in laws:
            assert law.content is not None
            self.least[part], self.most[part] = law.content
        self._range = self.most - self.least
        self._duration = np.inf
        self._before = np.zeros((2, basis.N))
        #: volume of ground that belongs to each node, (N,), 1 where there is none
        self.volume = self.gathered(np.ones((1, 1)))
        self.volume[self.volume == 0.0] = 1.0

    def over(self, duration: float, before: ndarray) -> StoringFlow:
        """Return the flow of a step from stored volumes at the nodes, (2, N)."""
        new = copy(self)
        new._duration = duration
        new._before = before
        return new

    def stored(self, head: ndarray) -> ndarray:
        """Return the volume of water at the nodes, by saturation and by compression, (2, N)."""
        filled = self.filled(head, self._laws)[0]
        pressed = np.maximum(head - self.elevation, 0.0)[self.dofs]
        by_saturation = self.gathered(self.least + self._range * filled)
        return np.stack((by_saturation, self.gathered(self._storage * pressed)))

    def span(self, change: float) -> ndarray:
        """Return the volumes from dry to saturated, and by a change of pressure head, (2, N)."""
        return np.stack((self.gathered(self._range), self.gathered(self._storage * change)))

    def beyond(self, stored: ndarray, span: ndarray) -> float:
        """Return how far stored volumes, (2, N), exceed the possible ones, over the span."""
        least = self.gathered(self.least)
        off = np.maximum(least - stored[0], stored[0] - least - span[0])
        share = quotient(off, span[0])
        return float(share.max(initial=0.0))

    def room(self, head: ndarray) -> float:
        """Return the volume of water that makes the ground saturated; infinite with storage."""
        free = self.corners * self._range * (1.0 - self.filled(head, self._laws)[0])
        return float(np.inf if (self._storage > 0.0).any() else free.sum())

    @override
    def relative(self, head: ndarray, laws: Laws) -> tuple[ndarray, ndarray]:
        suction = (self.elevation - head)[self.dofs]
        relative, slope = self._by_laws(laws, "relative", suction)
        return relative @ self._shape.T, -slope[:, None, :] * self._shape

    @override
    def inflow(self, head: ndarray, relative: ndarray) -> ndarray:
        rate = (self.stored(head) - self._before).sum(axis=0) / self._duration
        return super().inflow(head, relative) + rate

    @override
    def round_off(self, head: ndarray, relative: ndarray) -> ndarray:
        stored = (self._before + self.span(0.0)).sum(axis=0) / self._duration
        return super().round_off(head, relative) + 1e-15 * stored

    @override
    def tangent(self, head: ndarray, relative: ndarray, slope: ndarray) -> csr_matrix:
        pressed = (head > self.elevation)[self.dofs]
        capacity = self._storage * pressed - self._range * self.filled(head, self._laws)[1]
        storing = diags(self.gathered(capacity) / self._duration)
        return (super().tangent(head, relative, slope) + storing).tocsr()

    @override
    def moved(self, head: ndarray, change: ndarray, laws: Laws) -> ndarray:
        new = head + change
        suction = self.elevation - head
        size = np.zeros(len(head))
        # Find the slope of the saturation from which on ground stores more than flows off.
        ranges, pressed = self.span(1.0)
        flat = (pressed + self._duration * self.saturated.diagonal()) / np.where(
            ranges > 0.0, ranges, 1.0
        )
        # Change the suction by the law of the nodes.
        for part, law in laws:
            nodes = np.unique(self.dofs[part])
            size[self.dofs[part]] = self._size[part]
            drier = law.moved(suction[nodes], -change[nodes], size[nodes], flat[nodes])
            moved = self.elevation[nodes] - drier
            new[nodes] = np.where(change[nodes] == 0.0, head[nodes], moved)
        return new

    @override
    def scale(self, head: ndarray, inflow: ndarray) -> float:
        stored = np.linalg.norm(self.stored(head) - self._before) / self._duration
        return float(np.linalg.norm(inflow) + stored)
