"""A thick elastic ring in an infinite elastic ground under a biaxial far field, by Michell's
harmonics.

Plane strain, tension positive; theta anticlockwise from the horizontal axis (springline), r
outward.  For the harmonic n: sigma_rr, sigma_tt, u_r ~ cos(n theta) and sigma_rt, u_t ~ sin(n
theta); here n = 0 and n = 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


def michell(n, r, shear, kappa):
    """Amplitudes (srr, stt, srt, ur, ut) of the unit potentials at a radius, one column each.

    The potentials are r^n, r^(n+2), r^-n, r^(2-n) for n >= 2, and ln r, r^2 for n = 0.
    """
    g = 2 * shear
    if n == 0:
        columns = [[1 / r**2, -1 / r**2, 0, -1 / (g * r), 0], [2, 2, 0, (kappa - 1) * r / g, 0]]
        return np.array(columns, float).T
    p, q = kappa - n, kappa + n
    columns = [
        [n * (1 - n) / r**2, n * (n - 1) / r**2, n * (n - 1) / r**2, -n / (g * r), n / (g * r)],
        [-(n + 1) * (n - 2), (n + 2) * (n + 1), n * (n + 1), (p - 1) * r / g, (q + 1) * r / g],
        [-n * (n + 1) / r**2, n * (n + 1) / r**2, -n * (n + 1) / r**2, n / (g * r), n / (g * r)],
        [-(n - 1) * (n + 2), (n - 2) * (n - 1), -n * (n - 1), (q - 1) * r / g, -(p + 1) * r / g],
    ]
    return np.array(columns, float).T * np.array([r**n, r**n, r**-n, r**-n])


@dataclass(frozen=True)
class RingInGround:
    """Ring ``a < r < b``, its inner face free, in ground that is loaded at infinity once the ring
    is in.

    ``vertical`` and ``horizontal`` are the pressures at infinity; ``slip`` is a smooth interface,
    without it ring and ground are bonded.
    """

    a: float
    b: float
    E_ring: float
    nu_ring: float
    E_ground: float
    nu_ground: float
    vertical: float
    horizontal: float
    slip: bool = False

    def elastic(self, ring):
        """Shear modulus and Kolosov's constant."""
        E, nu = (self.E_ring, self.nu_ring) if ring else (self.E_ground, self.nu_ground)
        return E / (2 * (1 + nu)), 3 - 4 * nu

    def coefficients(self, n):
        """Factors of the potentials in the ring and in the ground, the far field included."""
        a, b = self.a, self.b
        mean, half = (
            -0.5 * (self.vertical + self.horizontal),
            0.5 * (self.vertical - self.horizontal),
        )
        far = np.array([0, mean / 2]) if n == 0 else np.array([-half / 2, 0, 0, 0])
        decaying = [0] if n == 0 else [2, 3]
        at_a, at_b = michell(n, a, *self.elastic(True)), michell(n, b, *self.elastic(True))
        whole = michell(n, b, *self.elastic(False))
        ground, loaded = whole[:, decaying], whole @ far
        none, nothing = np.zeros(ground.shape[1]), np.zeros(at_b.shape[1])
        rows = [
            (at_a[0], none, 0),
            (at_b[0], -ground[0], loaded[0]),
            (at_b[3], -ground[3], loaded[3]),
        ]
        if n:
            rows.append((at_a[2], none, 0))
            if self.slip:
                rows += [(at_b[2], none, 0), (nothing, ground[2], -loaded[2])]
            else:
                rows += [(at_b[2], -ground[2], loaded[2]), (at_b[4], -ground[4], loaded[4])]
        matrix = np.array([np.concatenate(row[:2]) for row in rows])
        found = np.linalg.solve(matrix, np.array([row[2] for row in rows], float))
        ground_factors = far.copy()
        ground_factors[decaying] = found[at_b.shape[1] :]
        return found[: at_b.shape[1]], ground_factors

    def field(self, r, theta, ring):
        """Stresses and displacements (srr, stt, srt, ur, ut) at points of the ring or of the
        ground.
        """
        r, theta = np.broadcast_arrays(np.asarray(r, float), theta)
        total = np.zeros((5, *r.shape))
        for n in (0, 2):
            factors = self.coefficients(n)[0 if ring else 1]
            amplitude = np.stack(
                [michell(n, q, *self.elastic(ring)) @ factors for q in r.ravel()], axis=1
            )
            cos, sin = np.cos(n * theta), np.sin(n * theta)
            wave = np.array([cos, cos, sin, cos, sin])
            total += amplitude.reshape(total.shape) * wave
        return total

    def interface(self, theta):
        """Contact pressure and shear ``sigma_rt`` at the ring's outer face."""
        stress = self.field(self.b, theta, ring=True)
        return -stress[0], stress[2]

    def section_forces(self, theta):
        """Normal force (tension positive) and moment (positive: outer fibres in tension), by
        quadrature.
        """
        t, w = np.polynomial.legendre.leggauss(20)
        middle, half = 0.5 * (self.a + self.b), 0.5 * (self.b - self.a)
        hoop = self.field(middle + half * t[:, None], np.asarray(theta)[None], ring=True)[1]
        return half * w @ hoop, half**2 * (w * t) @ hoop
