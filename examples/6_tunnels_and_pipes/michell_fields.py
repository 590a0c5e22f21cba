r"""Michell's elementary fields of plane strain in rings and around holes.

Radial stress, hoop stress and radial displacement are a constant plus a multiple of
:math:`\cos 2\theta`, the shear stress and the tangential displacement a multiple of
:math:`\sin 2\theta`, with :math:`\theta` from the springline.
"""

from __future__ import annotations

import numpy as np

WAVY = np.array([0, 0, 1, 1, 1, 1])  # which of the fields go with 2 theta
DECAYING = [0, 4, 5]


def michell(r, material):
    """Amplitudes of the six fields at a radius: rows srr, stt, srt, ur, ut."""
    k, g = 3 - 4 * material.nu, material.E / (1 + material.nu)
    return np.array(
        [
            [r**-2, 2, -2, 0, -6 * r**-4, -4 * r**-2],
            [-(r**-2), 2, 2, 12 * r**2, 6 * r**-4, 0],
            [0, 0, 2, 6 * r**2, -6 * r**-4, -2 * r**-2],
            [
                -1 / (g * r),
                (k - 1) * r / g,
                -2 * r / g,
                (k - 3) * r**3 / g,
                2 * r**-3 / g,
                (k + 1) / (g * r),
            ],
            [0, 0, 2 * r / g, (k + 3) * r**3 / g, 2 * r**-3 / g, (1 - k) / (g * r)],
        ]
    )


def harmonics(row, factors):
    """Constant and amplitude of the wave of a row of Michell's fields."""
    return np.array([row @ ((1 - WAVY) * factors), row @ (WAVY * factors)])


def thrust_and_moment(inner, outer, material, factors):
    """Constant and wave of the thrust and of the moment of a ring: integrals of the hoop stress
    over its wall.
    """
    t, w = np.polynomial.legendre.leggauss(12)
    half = (outer - inner) / 2
    hoop = np.array(
        [harmonics(michell((inner + outer) / 2 + half * s, material)[1], factors) for s in t]
    )
    return half * w @ hoop, half**2 * (w * t) @ hoop
