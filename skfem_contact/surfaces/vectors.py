"""Small vectors and matrices at many points at once; real or complex."""
from __future__ import annotations

import numpy as np
from numpy import ndarray

#: Sine of the angle to a normal below which a direction is normal.
_NORMAL = 1e-3


def unit(vectors: ndarray) -> ndarray:
    """Vectors, (..., dim), of length one."""
    return np.asarray(vectors / np.sqrt(np.einsum("...c,...c->...", vectors, vectors))[..., None])


def dot(u: ndarray, v: ndarray) -> ndarray:
    """Products of vectors, (n, dim), point by point."""
    return np.asarray(np.einsum("nc,nc->n", u, v))


def outer(u: ndarray, v: ndarray) -> ndarray:
    """Dyads, (n, i, j), of vectors (n, i) and (n, j)."""
    return np.asarray(u[:, :, None] * v[:, None, :])


def across(tangents: ndarray) -> ndarray:
    """Normals of tangents, (n, dim - 1, dim): the one turned by +90 degrees, or the product of two."""
    if tangents.shape[1] == 1:
        return np.asarray(tangents[:, 0, ::-1] * (-1.0, 1.0))
    return np.cross(tangents[:, 0], tangents[:, 1])


def askew(direction: ndarray, normal: ndarray) -> ndarray:
    """Directions, (n, 3); where they are normal, as of a side on a floor, the axis that is least so."""
    aside = np.real(direction - dot(direction, normal)[:, None] * normal)
    lost = np.einsum("nc,nc->n", aside, aside) <= _NORMAL**2 * np.einsum("nc,nc->n", direction.real, direction.real)
    if not lost.any():
        return direction
    return np.where(lost[:, None], np.eye(3)[np.argmin(np.abs(normal.real).round(6), axis=1)], direction)


def frame(normal: ndarray, direction: ndarray) -> ndarray:
    """Orthonormal tangents, (n, dim - 1, dim): in space one along a direction, (n, 3), and the one across it."""
    if normal.shape[1] == 2:
        return np.asarray((normal[:, ::-1] * (1.0, -1.0))[:, None])
    direction = askew(direction, normal)
    first = unit(direction - dot(direction, normal)[:, None] * normal)
    return np.stack((first, np.cross(normal, first)), axis=1)


def products(a: ndarray, b: ndarray) -> ndarray:
    """Products of vectors with vectors, (n, i, j), of (n, i, dim) and (n, j, dim)."""
    return np.asarray(a @ b.transpose(0, 2, 1))


def determinant(A: ndarray) -> ndarray:
    """Determinants of matrices of one or two rows."""
    if A.shape[1] == 1:
        return np.asarray(A[:, 0, 0])
    return np.asarray(A[:, 0, 0] * A[:, 1, 1] - A[:, 0, 1] * A[:, 1, 0])


def inverse(A: ndarray) -> ndarray:
    """Inverses of matrices of one or two rows."""
    if A.shape[1] == 1:
        return np.asarray(1.0 / A)
    adjugate = np.stack((A[:, 1, 1], -A[:, 0, 1], -A[:, 1, 0], A[:, 0, 0]), axis=1).reshape(A.shape)
    return np.asarray(adjugate / determinant(A)[:, None, None])


def solve(A: ndarray, b: ndarray) -> ndarray:
    """Solutions, (n, i), of systems of one or two equations."""
    return np.asarray((inverse(A) @ b[:, :, None])[:, :, 0])


def lift(factors: ndarray, vectors: ndarray) -> ndarray:
    """``A^T v`` for operators that act node by node: (n, i, nodes) or (n, 1, nodes) and (n, i, dim) or (n, 1, dim)."""
    product = factors[:, :, :, None] * vectors[:, :, None, :]
    return np.asarray(product.reshape(*product.shape[:2], product.shape[2] * product.shape[3]))


def spread(factors: ndarray, operator: ndarray) -> ndarray:
    """``A^T B`` for an operator A that acts node by node: (n, nodes) and (n, dim, m) give (n, dim nodes, m)."""
    product = factors[:, :, None, None] * operator[:, None]
    return np.asarray(product.reshape(len(factors), factors.shape[1] * operator.shape[1], operator.shape[2]))
