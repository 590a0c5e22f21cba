"""Figures of arrays."""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike


def max_abs(values: ArrayLike) -> float:
    """Return the largest magnitude of some values, zero of none."""
    return float(np.abs(values).max(initial=0.0))


def quotient(values: ndarray, of: ndarray, otherwise: float = 0.0) -> ndarray:
    """Return values over others where these are positive, another value elsewhere."""
    positive = of > 0.0
    return np.where(positive, values / np.where(positive, of, 1.0), otherwise)


def cross_in_plane(u: ndarray, v: ndarray) -> ndarray:
    """Return the cross products of vectors in the plane, (..., 2) each."""
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def left_of(t: ndarray) -> ndarray:
    """Return the vectors to the left of others in the plane, (..., 2)."""
    return np.stack((-t[..., 1], t[..., 0]), axis=-1)


def row_norms(vectors: ndarray) -> ndarray:
    """Return the lengths of vectors, (n,), or norms along the second axis, of (n, dim, ...)."""
    return np.linalg.norm(vectors, axis=1)
