"""Figures of arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def max_abs(values: ArrayLike) -> float:
    """Return the largest magnitude of some values, zero of none."""
    return float(np.abs(values).max(initial=0.0))
