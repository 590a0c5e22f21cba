"""Closed form of a saturated layer on a rigid, tight base under a harmonic load on its drained top.

With exp(i w t), the total stress M u' - p, the flow q of water relative to the ground and its
permeability b = k / gamma_w:

    (M u' - p)' + w^2 (rho u + rho_w q) = 0
    u' + q' + S p = 0
    -p' + w^2 (rho_w u + rho_w / n q) - i w q / b = 0

M. A. Biot (1956) has all terms; u-p leaves out those with rho_w. Both have solutions exp(l z) with
two values of l^2; u and q are odd in z, p is even.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Layer:
    """Height, oedometric modulus, density, porosity, storage and permeability over gamma_w."""

    height: float = 10.0
    M: complex = 1e5
    rho: complex = 2.0
    n: float = 0.4
    S: float = 2e-7
    b: float = 1e-4
    rho_w: float = 1.0

    def under(self, omega, z, biot=False):
        """Displacements and pressures at heights z under a pressure of 1 on the top, (2, n)."""
        rho_w = self.rho_w if biot else 0.0
        d = omega**2 * rho_w / self.n - 1j * omega / self.b
        share = omega**2 * rho_w / d
        # q = (p' - w^2 rho_w u) / d; the determinant is a polynomial in l^2
        a0 = omega**2 * (self.rho - rho_w * share)
        squares = np.roots([self.M / d, self.M * self.S + a0 / d + (1 - share) ** 2, a0 * self.S])
        rate = np.sqrt(squares.astype(complex))
        ratio = -rate * (1 - share) / (rate**2 / d + self.S)  # of p over u

        def odd(z, sign):
            return 0.5 * (
                np.exp(rate * (z - self.height)) + sign * np.exp(-rate * (z + self.height))
            )

        top = self.height
        stress = self.M * rate * odd(top, 1)
        A = np.linalg.solve([stress, ratio * odd(top, 1)], [-1.0, 0.0])
        u = [A @ odd(each, -1) for each in z]
        p = [(A * ratio) @ odd(each, 1) for each in z]
        return np.array([u, p])
