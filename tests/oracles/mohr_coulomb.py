"""Mohr-Coulomb return mapping in exact arithmetic, and closed forms of element tests.

Tension positive. A yield function is ``f_ij = (1 + sin phi) s_i - (1 - sin phi) s_j - strength``
with ``strength = 2 c cos phi``, for every ordered pair of principal stresses; its flow direction
has psi for phi.
"""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np

PAIRS = tuple(itertools.permutations(range(3), 2))
# Active pairs for trial stresses in descending order: face, edge s2 = s3, edge s1 = s2.
ACTIVE_SETS = (((0, 2),), ((0, 2), (0, 1)), ((0, 2), (1, 2)))


def rational_return(trial, lam, mu, sin_phi, sin_psi, strength):
    """Principal stresses after the return, in exact arithmetic; descending trial stresses."""
    elastic = lambda v: [lam * sum(v) + 2 * mu * x for x in v]  # noqa: E731
    normal = lambda i, j, s: [(k == i) * (1 + s) - (k == j) * (1 - s) for k in range(3)]  # noqa: E731
    excess = lambda s, i, j: (1 + sin_phi) * s[i] - (1 - sin_phi) * s[j] - strength  # noqa: E731
    if max(excess(trial, *pair) for pair in PAIRS) <= 0:
        return list(trial)
    for pairs in ACTIVE_SETS:
        drops = [elastic(normal(*pair, sin_psi)) for pair in pairs]
        matrix = [[excess(drop, *pair) + strength for drop in drops] for pair in pairs]
        right = [excess(trial, *pair) for pair in pairs]
        if len(pairs) == 1:
            multipliers = [right[0] / matrix[0][0]]
        else:
            (a, b), (c, d) = matrix
            det = a * d - b * c
            multipliers = [(d * right[0] - b * right[1]) / det, (a * right[1] - c * right[0]) / det]
        stress = [
            t - sum(m * drop[k] for m, drop in zip(multipliers, drops)) for k, t in enumerate(trial)
        ]
        if min(multipliers) >= 0 and max(excess(stress, *pair) for pair in PAIRS) <= 0:
            return stress
    return [Fraction(strength, 2) / sin_phi] * 3


def triaxial_strength(c, phi, cell):
    """Axial compression at failure under a cell pressure (both positive)."""
    passive = math.tan(math.radians(45 + phi / 2)) ** 2
    return passive * cell + 2 * c * math.sqrt(passive)


def simple_shear_strength(c, phi, psi, pressure):
    """Shear stress of plastic flow on a plane without extension under a normal pressure (Davis
    1968).
    """
    phi, psi = math.radians(phi), math.radians(psi)
    cohesive, frictional = c * math.cos(phi), pressure * math.sin(phi)
    return (cohesive + frictional) * math.cos(psi) / (1 - math.sin(phi) * math.sin(psi))


def deviatoric_radius(c, phi, pressure, lode):
    """sqrt(J2) on the surface at a mean pressure; Lode angle in degrees, 30 in triaxial
    compression.
    """
    phi, lode = math.radians(phi), np.radians(lode)
    frictional = c * math.cos(phi) + pressure * math.sin(phi)
    return frictional / (np.cos(lode) - np.sin(lode) * math.sin(phi) / math.sqrt(3))
