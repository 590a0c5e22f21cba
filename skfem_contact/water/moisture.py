"""Water of partly saturated ground by its excess pressure: heads, contents and relative flow."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from .darcy import DarcyFlow
from .retention import Laws
from .storage import StoringFlow


class Filling(NamedTuple):
    """Water at the corners of the elements, with slopes over the pressure, (n_elements, n_p) each.

    These are Bishop's pressure, the content of undeformed ground, and the content over the content
    of full pores.
    """

    bishop: ndarray
    content: ndarray
    share: ndarray
    bishop_slope: ndarray
    content_slope: ndarray
    share_slope: ndarray


class Moisture:
    """Retention of the ground, with pressures from which the excess counts, (n_vertices,)."""

    def __init__(
        self,
        pressures: CellBasis,
        mobility: ndarray,
        laws: Laws,
        start: ndarray,
        unit_weight: float,
        axisymmetric: bool,
    ) -> None:
        self._laws = laws
        self._start = start
        self._unit_weight = unit_weight
        datum = float(pressures.mesh.p[-1, : pressures.N].mean())
        no_storage = np.zeros(pressures.nelems)
        tensors = mobility * unit_weight
        self._flow = StoringFlow(pressures, tensors, laws, no_storage, axisymmetric, datum)
        self._least = self._flow.least
        self._most = self._flow.most
        #: (n_elements, n_p): volume of ground that belongs to each corner
        self.corners = self._flow.corners
        #: Filling at the start.
        self.before = self.filling(np.zeros(pressures.N))
        content = self.before.content
        if not ((content >= 0.0) & (content <= self._most)).all():
            raise ValueError(
                f"the contents of water at the start, from {content.min():.3g} to "
                f"{content.max():.3g}, are not between 0 and the saturated one"
            )

    def head(self, pressure: ndarray) -> ndarray:
        """Return the heads above the datum under an excess pressure, (n_vertices,)."""
        return np.asarray(self._flow.elevation + (self._start + pressure) / self._unit_weight)

    def filling(self, pressure: ndarray) -> Filling:
        """Return the water of the elements under an excess pressure."""
        # S_e and its slope over the pressure u
        filled, falling = self._flow.filled(self.head(pressure), self._laws)
        slope = -falling / self._unit_weight
        total = (self._start + pressure)[self._flow.dofs]
        span = self._most - self._least
        content = self._least + span * filled
        content_slope = span * slope
        return Filling(
            bishop=filled * total,
            content=content,
            share=content / self._most,
            bishop_slope=filled + slope * total,
            content_slope=content_slope,
            share_slope=content_slope / self._most,
        )

    def initial(self) -> ndarray:
        """Return Bishop's pressure at the start, (n_vertices,)."""
        return self._flow.gathered(self.before.bishop) / self._flow.volume

    def leaving(self, pressure: ndarray) -> ndarray:
        """Return the water that leaves the corners of the elements, (n_elements, n_p)."""
        head = self.head(pressure)
        return self._flow.by_element(head, self._flow.relative(head, self._laws)[0])

    def passing(self, pressure: ndarray) -> ndarray:
        """Return the slope of the flow over the pressures, (n_elements, n_p, n_p)."""
        head = self.head(pressure)
        relative, slope = self._flow.relative(head, self._laws)
        return self._flow.by_corner(relative, slope, head) / self._unit_weight

    def round_off(self, pressure: ndarray) -> ndarray:
        """Estimate the round-off of the flow through the nodes, (n_vertices,)."""
        saturated = np.ones((1, self._flow.basis.dx.shape[1]))
        return DarcyFlow.round_off(self._flow, self.head(pressure), saturated)

    def gathered(self, corners: ndarray) -> ndarray:
        """Return the integral around each node of values at the corners, (n_vertices,)."""
        return self._flow.gathered(corners)
