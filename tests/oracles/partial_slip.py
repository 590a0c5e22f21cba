"""Cattaneo and Mindlin: bodies of the same material under a constant force P and a shear force Q
that comes and goes.

All tractions are sums of half ellipses, and so are their fields in the half-plane ``y <= 0``: with
p(x) the pressure on its surface and q(x) the shear traction on it, sigma_yy = -p and sigma_xy = q.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray

from tests.oracles.halfplane import Potential, elliptic


@dataclass(frozen=True)
class PartialSlip:
    """Tractions of the contact ``|x| < a``.

    Attributes
    ----------
    peak, a
        Hertz: largest pressure and half-width.
    ellipses
        Half ellipses of the shear traction: their heights and half-widths.
    """

    peak: float
    a: float
    ellipses: tuple[tuple[float, float], ...] = ()

    def pressure(self, x: ndarray) -> ndarray:
        """Hertz."""
        return self.peak * ellipse(x, self.a)

    def shear(self, x: ndarray) -> ndarray:
        """Shear traction."""
        return sum(
            (height * ellipse(x, width) for height, width in self.ellipses), np.zeros_like(x)
        )

    @property
    def potential(self) -> Potential:
        """Muskhelishvili's potential of both tractions."""
        parts = [elliptic(self.peak, self.a)] + [
            elliptic(1j * height, width) for height, width in self.ellipses
        ]
        return Potential(
            *(_sum([getattr(part, name) for part in parts]) for name in ("Phi", "dPhi", "phi"))
        )


def _sum(functions):
    return lambda z: sum(function(z) for function in functions)


def ellipse(x, a):
    """sqrt(1 - x^2/a^2) within a, and zero outside."""
    return np.sqrt(np.maximum(1 - (x / a) ** 2, 0.0))


def loaded(peak: float, a: float, mu: float, ratio: float) -> PartialSlip:
    """The shear force has grown to Q = ratio mu P: slip has come in from the edges to the
    half-width c.
    """
    c = a * np.sqrt(1 - ratio)
    return PartialSlip(peak, a, ((mu * peak, a), (-mu * peak * c / a, c)))


def unloaded(peak: float, a: float, mu: float, largest: float, ratio: float) -> PartialSlip:
    """The same after it has gone back from Q = largest mu P: reverse slip has come in to the
    half-width c'.
    """
    c, turned = a * np.sqrt(1 - largest), a * np.sqrt(1 - (largest - ratio) / 2)
    return PartialSlip(
        peak, a, ((-mu * peak, a), (2 * mu * peak * turned / a, turned), (-mu * peak * c / a, c))
    )
