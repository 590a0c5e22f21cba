"""Return mapping to the tension cut-off of the pyramid: no principal stress exceeds the tensile strength.

The three planes s_i = tension have associated flow and are combined with the faces of the pyramid by
Koiter's rule. The returned stress lies on one, two or three of the planes, or where they cut the pyramid;
there s1 and s3 are given, and s2 is free, or equals one of them at the end of that line.
"""

from __future__ import annotations

import numpy as np

from .base import Array, Parameter
from .plastic import Return


def tension_return(
    trial: Array, lam: Parameter, mu: Parameter, tension: Parameter, lateral: Parameter
) -> Return:
    """Return principal trial stresses whose return to the pyramid alone exceeds the tensile strength.

    Parameters
    ----------
    trial : ndarray, shape (3, n)
        Descending.
    lam, mu : float or ndarray
        Lamé's constants.
    tension : float or ndarray
        Tensile strength, below the apex of the pyramid.
    lateral : float or ndarray
        Smallest principal stress that the pyramid admits beside a largest one of ``tension``.
    """
    s1, s2, s3 = trial
    poisson = lam / (2 * (lam + mu))
    constrained = lam / (lam + 2 * mu)

    middle = s2 - constrained * (s1 - tension)
    two_planes = middle > tension
    smallest = np.where(two_planes, s3 - poisson * (s1 + s2 - 2 * tension), s3 - constrained * (s1 - tension))
    sheared = smallest < lateral
    between = s2 - poisson * (s1 - tension + s3 - lateral)
    middle = np.where(sheared, np.maximum(between, lateral), middle)
    values = np.stack(
        (
            np.broadcast_to(tension, s1.shape),
            np.minimum(middle, tension),
            np.clip(smallest, lateral, tension),
        )
    )

    def moduli() -> Array:
        result = np.zeros((3, *trial.shape))
        one_plane = ~two_planes & ~sheared
        result[1, 1] = result[2, 2] = np.where(one_plane, lam + 2 * mu - lam * constrained, 0)
        result[1, 2] = result[2, 1] = np.where(one_plane, lam - lam * constrained, 0)
        young = 2 * mu * (1 + poisson)
        result[2, 2] += np.where(two_planes & ~sheared & (smallest < tension), young, 0)
        result[1, 1] += np.where(sheared & (lateral < between) & (between < tension), young, 0)
        return result

    return Return(values, moduli)
