"""Small vectors and matrices at many points at once; real or complex."""

from __future__ import annotations

import numpy as np
from numpy import ndarray

#: Sine of the angle to a normal below which a direction is normal.
_NORMAL = 1e-3


def unit(vectors: ndarray) -> ndarray:
    """Return vectors, shape (..., dim), of length one."""
    return np.asarray(vectors / np.sqrt(np.einsum("...c,...c->...", vectors, vectors))[..., None])


def dot(u: ndarray, v: ndarray) -> ndarray:
    """Return products of vectors, shape (n, dim), point by point."""
    return np.asarray(np.einsum("nc,nc->n", u, v))


def outer(u: ndarray, v: ndarray) -> ndarray:
    """Return dyads, shape (n, i, j), of vectors (n, i) and (n, j)."""
    return np.asarray(u[:, :, None] * v[:, None, :])


def across(tangents: ndarray) -> ndarray:
    """Return normals of tangents: one turned by +90 degrees, or the cross product of two."""
    if tangents.shape[1] == 1:
        return np.asarray(tangents[:, 0, ::-1] * (-1.0, 1.0))
    return cross(tangents[:, 0], tangents[:, 1])


def cross(u: ndarray, v: ndarray) -> ndarray:
    """Return cross products of vectors, shape (n, 3): `numpy.cross` takes three times as long."""
    result = np.empty(u.shape, np.result_type(u, v))
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        result[:, i] = u[:, j] * v[:, k] - u[:, k] * v[:, j]
    return result


def askew(direction: ndarray, normal: ndarray) -> ndarray:
    """Return directions, shape (n, 3), with an axis along the facet in place of normal ones."""
    # The part of the direction along the facet.
    aside = np.real(direction - dot(direction, normal)[:, None] * normal)
    real = direction.real
    is_normal = dot(aside, aside) <= _NORMAL**2 * dot(real, real)
    if not is_normal.any():
        return direction
    # The axis that lies most along the facet.
    least = np.argmin(np.abs(normal.real).round(6), axis=1)
    return np.where(is_normal[:, None], np.eye(3)[least], direction)


def frame(normal: ndarray, direction: ndarray) -> ndarray:
    """Return orthonormal tangents, shape (n, dim - 1, dim), in space the first along a direction.

    The direction, shape (n, 3), counts in space only.
    """
    if normal.shape[1] == 2:
        tangent = normal[:, ::-1] * (1.0, -1.0)
        return np.asarray(tangent[:, None])
    direction = askew(direction, normal)
    first = unit(direction - dot(direction, normal)[:, None] * normal)
    return np.stack((first, cross(normal, first)), axis=1)  # (n, 2, 3)


def products(a: ndarray, b: ndarray) -> ndarray:
    """Return products of vectors, shape (n, i, j), of (n, i, dim) and (n, j, dim).

    `matmul` takes twice as long.
    """
    rows = []
    for i in range(a.shape[1]):
        rows.append([dot(a[:, i], b[:, j]) for j in range(b.shape[1])])
    return np.array(rows).transpose(2, 0, 1)


def determinant(A: ndarray) -> ndarray:
    """Return determinants of matrices of one or two rows."""
    if A.shape[1] == 1:
        return np.asarray(A[:, 0, 0])
    return np.asarray(A[:, 0, 0] * A[:, 1, 1] - A[:, 0, 1] * A[:, 1, 0])


def inverse(A: ndarray) -> ndarray:
    """Return inverses of matrices of one or two rows."""
    if A.shape[1] == 1:
        return np.asarray(1.0 / A)
    # A^-1 = adj A / det A
    entries = (A[:, 1, 1], -A[:, 0, 1], -A[:, 1, 0], A[:, 0, 0])
    adjugate = np.stack(entries, axis=1).reshape(A.shape)
    return np.asarray(adjugate / determinant(A)[:, None, None])


def solve(A: ndarray, b: ndarray) -> ndarray:
    """Return solutions, shape (n, i), of systems of one or two equations."""
    return np.asarray(np.einsum("nij,nj->ni", inverse(A), b))


def lift(factors: ndarray, vectors: ndarray) -> ndarray:
    """Return ``A^T v`` for operators (n, i, nodes) or (n, 1, nodes) that act node by node."""
    product = factors[:, :, :, None] * vectors[:, :, None, :]  # (n, i, nodes, dim)
    return np.asarray(product.reshape(*product.shape[:2], product.shape[2] * product.shape[3]))
