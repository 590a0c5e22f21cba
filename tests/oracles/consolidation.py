"""Exact solutions of consolidation by series, for water and grains without compressibility."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.optimize import brentq


def terzaghi(T, z=None, n: int = 2000) -> ndarray:
    """Degree of consolidation at times T, or pressures (times, places) at depths z, 1 at the tight
    end (Terzaghi).
    """
    m = np.pi * (np.arange(n) + 0.5)
    decay = np.exp(-np.outer(T, m**2))
    return 1.0 - decay @ (2.0 / m**2) if z is None else (decay * 2.0 / m) @ np.sin(np.outer(m, z))


def mandel(T, x, nu: float, n: int = 100) -> ndarray:
    """Pressure (times, places) in a block between rigid plates over that at first, drained at x = 1
    (Mandel 1953).
    """
    r = (1.0 - nu) / (0.5 - nu)
    a = np.array(
        [
            brentq(
                lambda a: np.sin(a) - r * a * np.cos(a),
                max(i * np.pi, 1e-3),
                (i + 0.5) * np.pi - 1e-12,
            )
            for i in range(n)
        ]
    )
    share = 2.0 * np.sin(a) / (a - np.sin(a) * np.cos(a))
    return np.exp(-np.outer(T, a**2)) @ (
        share[:, None] * (np.cos(np.outer(a, x)) - np.cos(a)[:, None])
    )
