r"""Algebra of second-order cones in three dimensions, :math:`s_0 \ge |(s_1, s_2)|`, for arrays (n, 3) of them.

After Nesterov and Todd, as in F. Alizadeh, D. Goldfarb, Mathematical Programming 95 (2003) 3-51.
"""
from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import ndarray

_SIGNS = np.array([1.0, -1.0, -1.0])


def determinant(x: ndarray) -> ndarray:
    """s_0^2 - s_1^2 - s_2^2, factored so that little is lost at the surface."""
    radius = np.hypot(x[:, 1], x[:, 2])
    return (x[:, 0] - radius) * (x[:, 0] + radius)


def product(x: ndarray, y: ndarray) -> ndarray:
    """The product of Jordan's algebra."""
    return np.column_stack([(x * y).sum(1), x[:, :1] * y[:, 1:] + y[:, :1] * x[:, 1:]])


def quotient(y: ndarray, x: ndarray) -> ndarray:
    """What times `x` is `y`."""
    first = (_SIGNS * x * y).sum(1) / determinant(x)
    return np.column_stack([first, (y[:, 1:] - first[:, None] * x[:, 1:]) / x[:, :1]])


def longest_step(x: ndarray, d: ndarray) -> float:
    """Largest step from inner points x in the directions d that leaves all of them inside."""
    a, b, c = determinant(d), (_SIGNS * x * d).sum(1), determinant(x)
    inside = b * b - a * c
    below = np.sqrt(np.maximum(inside, 0.0)) - b
    leaves = (inside >= -1e-12 * b * b) & (below > 0)  # along an axis it is zero, to round-off
    return float(np.min(c[leaves] / below[leaves], initial=np.inf))


class Scaling(NamedTuple):
    """The symmetric W with W z = W^-1 s: it and its inverse, the inverse squared, (n, 3, 3), and that point (n, 3)."""

    W: ndarray
    inverse: ndarray
    squared: ndarray
    point: ndarray


def scaling(s: ndarray, z: ndarray) -> Scaling:
    """Scaling of Nesterov and Todd of inner points s and z; ArithmeticError where one is not."""
    squares = determinant(s), determinant(z)
    if not all((square > 0).all() for square in squares):
        raise ArithmeticError("a point has reached the surface of its cone")
    size_s, size_z = np.sqrt(squares)
    unit_s, unit_z = s / size_s[:, None], z / size_z[:, None]
    w = (unit_s + _SIGNS * unit_z) / np.sqrt(2 * (1 + (unit_s * unit_z).sum(1)))[:, None]
    V = np.empty((len(s), 3, 3))
    V[:, 0], V[:, 1:, 0] = w, w[:, 1:]
    V[:, 1:, 1:] = np.eye(2) + w[:, 1:, None] * w[:, None, 1:] / (1 + w[:, 0])[:, None, None]
    ratio = np.sqrt(size_s / size_z)[:, None, None]
    W, turned = ratio * V, _SIGNS * w
    squared = (2 * turned[:, :, None] * turned[:, None] - np.diag(_SIGNS)) / ratio**2
    return Scaling(W, V * np.outer(_SIGNS, _SIGNS) / ratio, squared, np.einsum("nij,nj->ni", W, z))
