r"""Stretches, logarithmic strains and their derivatives in the plane and in axial symmetry.

Tensors of two axes have closed forms: with :math:`J = \det F`, :math:`\tau = \sqrt{\mathrm{tr}\,C
+ 2 J}` (Hoger and Carlson 1984),

.. math::

    U = \frac{C + J 1}{\tau}, \qquad U^{-1} = \frac{\mathrm{adj}\,U}{J}, \qquad
    \ln X = \tfrac12 \ln\det X\, 1 + \frac{\mathrm{artanh}(r / m)}{r}\, \mathrm{dev} X

with the mean m and the radius r of Mohr's circle of X. The axis zz is apart. Tensors near one
are stored as differences from one, so that small strains keep their relative precision.
"""

from __future__ import annotations

import numpy as np
from numpy import ndarray

#: Square of r / m below which differences of artanh are summed as a series: the closed form loses
#: the digits of its inverse.
_SMALL = 0.02
#: Coefficients of that series: k / (2 k + 1), ten of which leave 1e-18 of the sum.
_SERIES = tuple(k / (2.0 * k + 1.0) for k in range(1, 11))


def inverse(a: ndarray, growth: ndarray) -> ndarray:
    """Return ``U^-1 - 1``, (3, m) as xx, yy, xy, by ``U - 1`` and ``det U - 1``."""
    J = 1.0 + growth
    return np.stack(((a[1] - growth) / J, (a[0] - growth) / J, -a[2] / J))


def _sandwich(V: tuple[ndarray, ndarray, ndarray], T: ndarray) -> ndarray:
    """Return ``V T V`` of symmetric tensors of components xx, yy, xy."""
    Vx, Vy, Vxy = V
    # (V T V)_ij = V_ik T_kl V_lj
    by_x = 2.0 * Vx * T[2] + Vxy * T[1]
    by_y = 2.0 * Vy * T[2] + Vxy * T[0]
    xx = Vx * Vx * T[0] + Vxy * by_x
    yy = Vy * Vy * T[1] + Vxy * by_y
    xy = Vxy * (Vx * T[0] + Vy * T[1]) + (Vx * Vy + Vxy * Vxy) * T[2]
    return np.stack((xx, yy, xy))


def _squared(a: ndarray) -> ndarray:
    """Return ``(1 + a)^2 - 1`` of a symmetric tensor of components xx, yy, xy."""
    off = a[2] * a[2]
    xx = a[0] * (2.0 + a[0]) + off
    yy = a[1] * (2.0 + a[1]) + off
    return np.stack((xx, yy, a[2] * (2.0 + a[0] + a[1])))


class PlaneStretch:
    """Stretch of the displacement gradient at points, and maps that depend on it.

    Parameters
    ----------
    gradient : ndarray, shape (5, m)
        ``F - 1``: components xx, yy, zz, xy, yx.
    """

    #: Components of a displacement gradient, and the transposed ones.
    transposed = (0, 1, 2, 4, 3)

    def __init__(self, gradient: ndarray) -> None:
        self._gradient = gradient
        xx, yy, zz, xy, yx = gradient
        # C - 1 = H + H^T + H^T H
        C = np.stack(
            (
                xx * (2.0 + xx) + yx * yx,
                yy * (2.0 + yy) + xy * xy,
                xy + yx + xx * xy + yx * yy,
            )
        )
        # tau^2 = tr C + 2 J
        growth = self._growth(gradient)
        total = C[0] + C[1] + 2.0 * growth
        self._tau = np.sqrt(4.0 + total)
        more = total / (self._tau + 2.0)  # tau - 2
        # U - 1 = (C - 1 + (J - 1) - (tau - 2)) / tau
        u = C / self._tau
        u[:2] += (growth - more) / self._tau
        v = inverse(u, growth)
        self._C = C
        self._growth_in_plane = growth
        self._u = u
        self._v = v
        self._U = (1.0 + u[0], 1.0 + u[1], u[2])
        self._V = (1.0 + v[0], 1.0 + v[1], v[2])
        self._zz = zz

    @staticmethod
    def _growth(gradient: ndarray) -> ndarray:
        xx, yy, _, xy, yx = gradient
        return xx + yy + xx * yy - xy * yx

    @classmethod
    def growth(cls, gradient: ndarray) -> ndarray:
        """Return ``det F - 1``, (m,)."""
        J = cls._growth(gradient)
        return J + gradient[2] * (1.0 + J)

    @classmethod
    def growth_of(cls, gradient: ndarray, change: ndarray) -> ndarray:
        """Return the change of ln det F by a change of the gradient, linearised, (m,)."""
        xx, yy, zz, xy, yx = change
        in_plane = (1.0 + gradient[1]) * xx + (1.0 + gradient[0]) * yy
        in_plane -= gradient[4] * xy + gradient[3] * yx
        return in_plane / (1.0 + cls._growth(gradient)) + zz / (1.0 + gradient[2])

    def inverse_plastic(self, elastic: ndarray) -> ndarray:
        r"""Return :math:`U^{-1} \exp(2 e) U^{-1} - 1`, (4, m), of elastic strains e, (4, m)."""
        # exponential: mean, and radius of Mohr's circle
        mean = elastic[0] + elastic[1]
        d = elastic[0] - elastic[1]
        o = elastic[3]
        r = np.hypot(d, o)
        scale = np.exp(mean)
        even = np.expm1(mean) + 2.0 * scale * np.sinh(0.5 * r) ** 2
        relative = np.divide(np.sinh(r), r, out=np.ones_like(r), where=r > 0.0)
        odd = scale * relative
        b = np.stack((even + odd * d, even - odd * d, odd * o))

        # transform back
        inner = _squared(self._v) + _sandwich(self._V, b)
        plastic_zz = 2.0 * elastic[2] - 2.0 * np.log1p(self._zz)
        zz = np.expm1(plastic_zz)
        return np.stack((inner[0], inner[1], zz, inner[2]))

    def log_strain(self, plastic: ndarray | None = None) -> ndarray:
        """Return ``ln(U Cp^-1 U) / 2``, (4, m) with engineering shear, by ``Cp^-1 - 1``, (4, m)."""
        # X - 1 = U Cp^-1 U - 1
        x = _squared(self._u)
        zz = self._zz * (2.0 + self._zz)
        if plastic is not None:
            p = plastic[[0, 1, 3]]
            x = x + _sandwich(self._U, p)
            zz = zz + (1.0 + zz) * plastic[2]
            self._p = p
            self._p_zz = plastic[2]
        # Mohr's circle of X: mean m, half difference d, shear o, radius squared s.
        m = 1.0 + 0.5 * (x[0] + x[1])
        d = 0.5 * (x[0] - x[1])
        o = x[2]
        s = d * d + o * o
        determinant = x[0] + x[1] + x[0] * x[1] - o * o  # - 1
        q = _slope(m, s)
        # e = ln(det X) / 4 + q / 2 dev X, with q = artanh(r / m) / r
        mean = 0.25 * np.log1p(determinant)
        self._circle = m, d, o, s, 1.0 + determinant, q
        half = 0.5 * q * d
        return np.stack((mean + half, mean - half, 0.5 * np.log1p(zz), q * o))

    def log_strain_of(self, change: ndarray) -> ndarray:
        """Return the change of :meth:`log_strain` by one of the gradient, (5, m), linearised."""
        xx, yy, zz, xy, yx = self._gradient
        dxx, dyy, dzz, dxy, dyx = change
        # dE = sym(F^T dF)
        E = np.stack(
            (
                (1.0 + xx) * dxx + yx * dyx,
                xy * dxy + (1.0 + yy) * dyy,
                (1.0 + xx) * dxy + yx * dyy + xy * dxx + (1.0 + yy) * dyx,
            )
        )
        dU = np.einsum("ikm,km->im", self._stretch_by_strain(), E)
        de = self._log_by_stretch(dU)
        return np.stack((de[0], de[1], dzz / (1.0 + zz), de[2]))

    def second(self, stress: ndarray) -> ndarray:
        """Return ``S = U^-1 t U^-1``, (4, m)."""
        S = _sandwich(self._V, stress[[0, 1, 3]])
        return np.stack((S[0], S[1], stress[2] / (1.0 + self._zz) ** 2, S[2]))

    def moduli(self, D: ndarray, S: ndarray) -> ndarray:
        """Return ``dS / dE``, (m, n, n), by the moduli ``dt / de``, (m, n, n).

        n = 3 in plane strain, rows xx, yy, xy, and 4 in axial symmetry. Called after
        :meth:`log_strain`.
        """
        n = D.shape[1]
        D = np.ascontiguousarray(D.transpose(1, 2, 0))
        plane = [0, 1, n - 1]
        # The chain: dE -> dU -> de -> dt -> dS.
        dU = self._stretch_by_strain()
        de = self._log_by_stretch(dU)
        if n == 3:
            dt = np.einsum("rsm,skm->rkm", D, de)
            dS = self._second_by_stress(dt) - self._second_by_stretch(dU, S)
            return np.ascontiguousarray(dS.transpose(2, 0, 1))

        # the axis zz beside the plane: de_zz = dE_zz / U_zz^2
        square = (1.0 + self._zz) ** 2
        all_de = np.zeros_like(D)
        all_de[np.ix_(plane, plane)] = de
        all_de[2, 2] = 1.0 / square
        dt = np.einsum("rsm,skm->rkm", D, all_de)
        dS = np.empty_like(D)
        dS[plane] = self._second_by_stress(dt[plane])
        dS[np.ix_(plane, plane)] -= self._second_by_stretch(dU, S)
        dS[2] = dt[2] / square
        dS[2, 2] -= 2.0 * S[2] / square
        return np.ascontiguousarray(dS.transpose(2, 0, 1))

    def _stretch_by_strain(self) -> ndarray:
        """Return dU / dE, (3, 3, m): columns of unit strains, engineering shear."""
        J = 1.0 + self._growth_in_plane
        C = self._C
        tau = self._tau
        g = np.stack(((1.0 + C[1]) / J, (1.0 + C[0]) / J, -C[2] / J))  # dJ
        h = g / tau  # d tau
        h[:2] += 1.0 / tau
        # dU = (2 dE + dJ - U dtau) / tau
        U = self._U
        dU = np.stack((g - U[0] * h, g - U[1] * h, -U[2] * h))
        dU[0, 0] += 2.0
        dU[1, 1] += 2.0
        dU[2, 2] += 1.0
        dU /= tau
        return dU

    def _log_by_stretch(self, dU: ndarray) -> ndarray:
        """Return de, (3, 3, m), with engineering shear, by dU: ``dX = dU A + A^T dU``."""
        Ux, Uy, Uxy = self._U
        p = self._p
        # A = Cp^-1 U = U + p U
        Axx = Ux + p[0] * Ux + p[2] * Uxy
        Axy = Uxy + p[0] * Uxy + p[2] * Uy
        Ayx = Uxy + p[2] * Ux + p[1] * Uxy
        Ayy = Uy + p[2] * Uxy + p[1] * Uy
        xx = Axx * dU[0] + Ayx * dU[2]  # half of dX
        yy = Axy * dU[2] + Ayy * dU[1]
        do = Axy * dU[0] + Ayx * dU[1] + (Axx + Ayy) * dU[2]
        dm = xx + yy
        dd = xx - yy
        # Derivatives of the mean and of q along the circle of X.
        m, d, o, s, determinant, q = self._circle
        ds = 2.0 * (d * dd + o * do)
        mean = (0.5 * m / determinant) * dm - (0.25 / determinant) * ds
        dq = (-1.0 / determinant) * dm + _curvature(m, s, determinant, q) * ds
        half = 0.5 * (q * dd + d * dq)
        return np.stack((mean + half, mean - half, q * do + o * dq))

    def _second_by_stress(self, dt: ndarray) -> ndarray:
        """Return ``U^-1 dt U^-1``."""
        return _sandwich(self._V, dt)

    def _second_by_stretch(self, dU: ndarray, S: ndarray) -> ndarray:
        """Return ``U^-1 dU S`` and its transpose, added."""
        Vx, Vy, Vxy = self._V
        Sx = S[0]
        Sy = S[1]
        Sxy = S[3]
        # W = U^-1 dU
        Wxx = Vx * dU[0] + Vxy * dU[2]
        Wxy = Vx * dU[2] + Vxy * dU[1]
        Wyx = Vxy * dU[0] + Vy * dU[2]
        Wyy = Vxy * dU[2] + Vy * dU[1]
        # W S + S W^T
        xx = 2.0 * (Wxx * Sx + Wxy * Sxy)
        yy = 2.0 * (Wyx * Sxy + Wyy * Sy)
        xy = Wxx * Sxy + Wxy * Sy + Wyx * Sx + Wyy * Sxy
        return np.stack((xx, yy, xy))


def _slope(m: ndarray, s: ndarray) -> ndarray:
    """Return artanh(r / m) / r, also where the radius r, the root of s, vanishes."""
    r = np.sqrt(s)
    return np.divide(np.arctanh(r / m), r, out=1.0 / m, where=r > 0.0)


def _curvature(m: ndarray, s: ndarray, determinant: ndarray, q: ndarray) -> ndarray:
    """Return the derivative of :func:`_slope` by s, ``(m / (m^2 - s) - q) / (2 s)``."""
    ratio = s / (m * m)
    series = np.zeros_like(s)
    for coefficient in reversed(_SERIES):
        series = series * ratio + coefficient
    series /= m**3
    far = ratio > _SMALL
    return np.divide(m / determinant - q, 2.0 * s, out=series, where=far)
