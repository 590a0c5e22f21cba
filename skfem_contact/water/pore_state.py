"""What the water in the ground remembers."""
from __future__ import annotations

from dataclasses import dataclass

from numpy import ndarray


@dataclass(frozen=True)
class PoreState:
    """What the water in the ground around the nodes remembers, (n,) each, of all vertices of the mesh.

    Attributes
    ----------
    stored
        Volume of water, more than in undeformed ground.
    first
        The same when the ground became active.
    entered
        Water that has entered at the nodes since: not zero only where pressures are given, or other ground begins.
    pressure
        Excess pore pressure, positive in compression.
    """

    stored: ndarray
    first: ndarray
    entered: ndarray
    pressure: ndarray
