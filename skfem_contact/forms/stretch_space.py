r"""Stretches, logarithmic strains and their derivatives in space, by eigenvalues and eigenvectors.

With eigenvalues :math:`\lambda_i` and eigenvectors N of U, and :math:`x_i` and M of X, derivatives
are products of components in these frames:

.. math::

    dU_{ij} = \frac{2\, dE_{ij}}{\lambda_i + \lambda_j}, \qquad
    de_{ij} = \frac{\ln x_i - \ln x_j}{2 (x_i - x_j)} dX_{ij}

Tensors near one are stored as differences from one, so that small strains keep their relative
precision.
"""

from __future__ import annotations

import numpy as np
from numpy import ndarray

from ..materials.spectral import COLUMN, ROW, TENSOR, rotation

#: Relative difference of eigenvalues below which the slope of the logarithm is a series.
_CLOSE = 1e-7
_ONE = np.eye(3)


def _tensor(a: ndarray, shear: float = 1.0) -> ndarray:
    """Return tensors, (m, 3, 3), of components, (6, m)."""
    T = a[TENSOR]
    if shear != 1.0:
        for i, j in zip(ROW[3:], COLUMN[3:]):
            T[i, j] *= shear
            T[j, i] *= shear
    return np.ascontiguousarray(T.transpose(2, 0, 1))


def _components(T: ndarray, shear: float = 1.0) -> ndarray:
    """Return components, (6, m), of tensors, (m, 3, 3)."""
    a = T[:, ROW, COLUMN].T.copy()
    a[3:] *= shear
    return a


def _built(values: ndarray, vectors: ndarray) -> ndarray:
    """Return tensors of eigenvalues and eigenvectors."""
    return (vectors * values[:, None, :]) @ vectors.transpose(0, 2, 1)


class SpaceStretch:
    """Stretch of the displacement gradient at points, and maps that depend on it.

    Parameters
    ----------
    gradient : ndarray, shape (9, m)
        ``F - 1``, row by row.
    """

    #: Components of a displacement gradient, and the transposed ones.
    transposed = (0, 3, 6, 1, 4, 7, 2, 5, 8)

    def __init__(self, gradient: ndarray) -> None:
        self._gradient = gradient
        # C - 1 = H + H^T + H^T H = N (lambda^2 - 1) N^T
        H = np.ascontiguousarray(gradient.T).reshape(-1, 3, 3)
        Ht = H.transpose(0, 2, 1)
        w, N = np.linalg.eigh(H + Ht + Ht @ H)
        self._lambda = np.sqrt(1.0 + w)
        self._N = N
        # U - 1 and U^-1 - 1, without differences of close numbers.
        self._u = _built(w / (1.0 + self._lambda), N)
        self._v = _built(-w / (1.0 + self._lambda) / self._lambda, N)
        self._V = _ONE + self._v

    @staticmethod
    def growth(gradient: ndarray) -> ndarray:
        """Return ``det F - 1``, (m,)."""
        xx, xy, xz, yx, yy, yz, zx, zy, zz = gradient
        # det(1 + H) - 1 = tr H + sum of principal minors + det H
        minors = xx * yy - xy * yx + yy * zz - yz * zy + xx * zz - xz * zx
        last = xx * (yy * zz - yz * zy) - xy * (yx * zz - yz * zx) + xz * (yx * zy - yy * zx)
        return xx + yy + zz + minors + last

    @staticmethod
    def growth_of(gradient: ndarray, change: ndarray) -> ndarray:
        """Return the change of ln det F by a change of the gradient, linearised, (m,)."""
        # d ln J = F^-T : dF, with the cofactors of F
        x, y, z = gradient.reshape(3, 3, -1) + np.eye(3)[:, :, None]
        cofactors = np.stack([np.cross(a, b, axis=0) for a, b in ((y, z), (z, x), (x, y))])
        J = (x * cofactors[0]).sum(axis=0)
        return (cofactors * change.reshape(3, 3, -1)).sum(axis=(0, 1)) / J

    def inverse_plastic(self, elastic: ndarray) -> ndarray:
        r"""Return :math:`U^{-1} \exp(2 e) U^{-1} - 1`, (6, m), of elastic strains e, (6, m)."""
        # exp(2 e) - 1
        w, M = np.linalg.eigh(_tensor(elastic, 0.5))
        b = _built(np.expm1(2.0 * w), M)
        v = self._v
        V = self._V
        return _components(2.0 * v + v @ v + V @ b @ V)

    def log_strain(self, plastic: ndarray | None = None) -> ndarray:
        """Return ``ln(U Cp^-1 U) / 2``, (6, m) with engineering shear, by ``Cp^-1 - 1``, (6, m)."""
        u = self._u
        # X - 1 = U Cp^-1 U - 1
        X = 2.0 * u + u @ u
        if plastic is not None:
            U = _ONE + u
            p = _tensor(plastic)
            self._A = U + p @ U
            X = X + U @ p @ U
        self._x, self._M = np.linalg.eigh(X)
        return _components(_built(0.5 * np.log1p(self._x), self._M), 2.0)

    def log_strain_of(self, change: ndarray) -> ndarray:
        """Return the change of :meth:`log_strain` by one of the gradient, (9, m), linearised."""
        # dE = sym(F^T dF)
        F = _ONE + self._gradient.T.reshape(-1, 3, 3)
        product = F.transpose(0, 2, 1) @ change.T.reshape(-1, 3, 3)
        dE = 0.5 * (product + product.transpose(0, 2, 1))
        # dU in the axes of U, dX = dU A + A^T dU, and de in the axes of X
        lam = self._lambda
        dU = _in_axes(dE, self._N, 2.0 / (lam[:, :, None] + lam[:, None]))
        half = dU @ self._A
        de = _in_axes(half + half.transpose(0, 2, 1), self._M, 0.5 * _slopes(self._x)[:, TENSOR])
        return _components(de, 2.0)

    def second(self, stress: ndarray) -> ndarray:
        """Return ``S = U^-1 t U^-1``, (6, m)."""
        return _components(self._V @ _tensor(stress) @ self._V)

    def moduli(self, D: ndarray, S: ndarray) -> ndarray:
        """Return ``dS / dE``, (m, 6, 6), by the moduli ``dt / de``, (m, 6, 6).

        Called after :meth:`log_strain`.
        """
        # dU by engineering strains
        lam = self._lambda
        R = rotation(self._N)
        factors = 2.0 / (lam[:, ROW] + lam[:, COLUMN])
        dU = _back(R) @ (factors[:, :, None] * R)
        dU[:, :, 3:] *= 0.5

        # dX = dU A + A^T dU, and de in the axes of X
        dX = _products(self._A) @ dU
        R = rotation(self._M)
        theta = 0.5 * _slopes(self._x)
        de = _back(R) @ (theta[:, :, None] * (R @ dX))
        de[:, 3:] *= 2.0

        # dS = U^-1 dt U^-1 - (U^-1 dU S + S dU U^-1)
        V = self._V
        dS = _between(V, V) @ (D @ de)
        S = _tensor(S)
        dS -= (_between(V, S) + _between(S, V)) @ dU
        return dS


def _in_axes(T: ndarray, axes: ndarray, factors: ndarray) -> ndarray:
    """Return tensors, (m, 3, 3), whose components along some axes are multiplied by factors."""
    back = axes.transpose(0, 2, 1)
    return axes @ (factors * (back @ T @ axes)) @ back


def _back(R: ndarray) -> ndarray:
    """Return the inverse of a rotation of components: shears count twice."""
    B = R.transpose(0, 2, 1).copy()
    B[:, :3, 3:] *= 2.0
    B[:, 3:, :3] *= 0.5
    return B


def _slopes(x: ndarray) -> ndarray:
    """Return the slopes of the logarithm between eigenvalues ``1 + x_i`` and ``1 + x_j``."""
    below = 1.0 + x[:, COLUMN]
    z = (x[:, ROW] - x[:, COLUMN]) / below
    slope = 1.0 - 0.5 * z
    far = np.abs(z) > _CLOSE
    return np.divide(np.log1p(z), z, out=slope, where=far) / below


def _products(A: ndarray) -> ndarray:
    """Return the map of T to ``T A + A^T T``, (m, 6, 6)."""
    # component (i, j): sum_k T_ik A_kj + A_ki T_kj
    out = np.zeros((len(A), 6, 6))
    for row, (i, j) in enumerate(zip(ROW, COLUMN)):
        for k in range(3):
            out[:, row, TENSOR[i, k]] += A[:, k, j]
            out[:, row, TENSOR[k, j]] += A[:, k, i]
    return out


def _between(V: ndarray, S: ndarray) -> ndarray:
    """Return the map of T to ``V T S``, (m, 6, 6), rows of its upper components."""
    first = V[:, ROW]
    second = S[:, COLUMN]
    out = first[:, :, ROW] * second[:, :, COLUMN]
    out[:, :, 3:] += first[:, :, COLUMN[3:]] * second[:, :, ROW[3:]]
    return out
