"""How bodies fit together where they become active: gaps and overlaps as meshed, adjusted or ramped."""
from __future__ import annotations

from typing import Literal

import numpy as np
from numpy import ndarray

#: What becomes of gaps and overlaps; a number: they touch exactly, and interfere by that much.
NamedFit = Literal["as meshed", "adjusted", "ramped"]
Fit = NamedFit | float

#: Gaps of the mesh below this share of the slave segment are round-off: such bodies touch.
TOUCHING = 1e-8
#: Gaps below this share of it are those of one surface meshed twice.
_ADJUSTED = 0.5


def touching(gap: ndarray, meshed: ndarray, size: ndarray, fit: Fit, bonded: bool) -> ndarray:
    """Gaps that count as touching, (n,).

    Parameters
    ----------
    gap, meshed
        Gaps where the bodies are when they become active, and where they are meshed: bodies are built to fit into
        displaced surfaces, so that gaps are still those of the mesh.
    size
        Lengths of the slave segments.
    fit
        What becomes of gaps and overlaps.
    bonded
        Whether what is near is bonded as it is meshed.
    """
    with np.errstate(invalid="ignore"):  # nothing near, neither now nor in the mesh: inf - inf
        # a change of more than this is no displacement: other surfaces have come to face each other
        moved = np.where(np.abs(gap - meshed) <= 0.5 * size, gap - meshed, 0.0)
    ramped = fit == "ramped" or not isinstance(fit, str)
    if ramped:
        moved = np.zeros_like(gap)
    nothing = (_ADJUSTED if bonded or fit == "adjusted" or not isinstance(fit, str) else TOUCHING) * size
    offset = np.where(np.abs(gap - moved) <= nothing, gap, moved)
    return np.minimum(gap, offset) if ramped else offset
