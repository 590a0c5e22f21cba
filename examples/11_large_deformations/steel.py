"""Steel whose yield stress hardens and saturates, for two examples (Simo and Armero 1992)."""

from dataclasses import dataclass

import numpy as np

import skfem_contact as sc
from skfem_contact.materials import Update


@dataclass(frozen=True, eq=False)
class Steel(sc.Material):
    """Von Mises' law with ``y(k) = y0 + H k + (y_inf - y0) (1 - exp(-d k))``, in GPa."""

    K: float = 164.206
    G: float = 80.1938
    y0: float = 0.45
    y_inf: float = 0.715
    H: float = 0.12924
    d: float = 16.93
    internal = (sc.Internal("plastic strain"),)
    symmetric = True

    def elasticity(self, ncomp, stress=None, internal=None):
        """Return the stiffness of bulk and shear modulus."""
        D = np.diag([2.0 * self.G] * 3 + [self.G] * (ncomp - 3))
        D[:3, :3] += self.K - 2.0 * self.G / 3.0
        return D

    def yield_stress(self, k):
        """Return yield stress and its slope."""
        fall = np.exp(-self.d * k)
        more = self.y_inf - self.y0
        return self.y0 + self.H * k + more * (1.0 - fall), self.H + more * self.d * fall

    def update(self, strain_increment, stress, internal):
        """Return stresses on the yield surface radially, by Newton's method for k."""
        n = len(stress)
        trial = stress + np.tensordot(self.elasticity(n), strain_increment, 1)
        p = trial[:3].mean(axis=0)
        s = trial.copy()
        s[:3] -= p
        q = np.sqrt(1.5 * ((s[:3] ** 2).sum(axis=0) + 2.0 * (s[3:] ** 2).sum(axis=0)))
        k = internal[0]
        flows = q > self.yield_stress(k)[0] * (1.0 + 1e-12)
        new = k.copy()
        for _ in range(30):
            y, slope = self.yield_stress(new)
            missing = np.where(flows, q - 3.0 * self.G * (new - k) - y, 0.0)
            new = new + missing / (3.0 * self.G + slope)
            if np.abs(missing).max(initial=0.0) < 1e-13 * self.y0:
                break
        y, slope = self.yield_stress(new)
        size = np.where(q > 0.0, q, 1.0)
        share = np.where(flows, y / size, 1.0)
        result = s * share
        result[:3] += p
        points = np.flatnonzero(flows)

        def tangent():
            """Return the moduli of the flowing points."""
            normal = (s / size).reshape(n, -1)[:, points]
            shear = 2.0 * self.G * share.ravel()[points]
            D = np.zeros((len(points), n, n))
            D[:, :3, :3] += (self.K - shear / 3.0)[:, None, None]
            for c in range(n):
                D[:, c, c] += shear if c < 3 else shear / 2.0
            factor = 9.0 * self.G**2 * ((new - k) / size - 1.0 / (3.0 * self.G + slope))
            return D + factor.ravel()[points, None, None] * np.einsum("in,jn->nij", normal, normal)

        return Update(result, new[None], points, tangent)
