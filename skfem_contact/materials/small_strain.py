"""Small-strain stiffness of the Hardening Soil: shear modulus that falls with the strain since the
last reversal.

In the history of a point, deviators have engineering shear strains. The shear strain of a deviator
e is sqrt(3/2 e : e), the difference of the principal strains of a triaxial test. An increment
follows the hyperbola of Hardin and Drnevich in the form of Santos and Correia, G = G_0 / (1 + 0.385
gamma / gamma_07), from the share of the history along its direction, and never below G_ur (T. Benz,
Small-strain stiffness of soils and its numerical consequences, University of Stuttgart, 2007).
After a reversal the hyperbola is twice as large (Masing), until the shear strain exceeds its
largest of the past.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .base import Array, Internal

#: Memory: strain since the start and since the last reversal, and the largest shear strain.
SMALL_STRAIN = (
    *(
        Internal(f"{name} {component}")
        for name in ("deviatoric strain", "strain since reversal")
        for component in ("xx", "yy", "zz", "xy", "yz", "zx")
    ),
    Internal("largest shear strain"),
)
# Share of the largest shear strain from which an increment continues the first loading.
_FIRST = 1.0 - 1e-9


class Stiffening(NamedTuple):
    """Ratio of the modulus of an increment to that of unloading, its derivative by the strain, and
    the new memory.
    """

    factor: Array
    slope: Array
    memory: Array


class SmallStrain(NamedTuple):
    """Ratio G_0 / G_ur at the same stress, and the threshold shear strain gamma_07."""

    ratio: float
    gamma_07: float

    def stiffening(self, strain: Array, memory: Array) -> Stiffening:
        """Return the stiffening over increments (ncomp, n) from a memory (13, n)."""
        e = np.zeros((6, strain.shape[1]))
        e[: len(strain)] = strain
        e[:3] -= e[:3].mean(axis=0)
        start, since, largest = memory[:6], memory[6:12], memory[12]
        first = _shear(start) >= _FIRST * largest
        history, length, travelled = np.where(first, start, since), _norm(e), _norm(start)
        direction = e / np.where(length > 0, length, 1.0)
        along = np.where(
            length > 0, _product(history, direction), _norm(history)
        )  # without an increment it continues
        ahead = np.maximum(along, 0.0)
        share = np.where(first, ahead / np.where(travelled > 0, travelled, 1.0), 0.0)
        share = np.where(first & (travelled == 0), 1.0, share)
        rate = 0.385 / self.gamma_07 * np.sqrt(1.5)
        scale = 0.5 * rate * (1 + np.minimum(share, 1.0))
        factor, by_begin, by_end = self._secant(scale * ahead, scale * (ahead + length))
        turns = first & (along > 0) & (travelled > 0)
        turned = np.where(turns, 0.5 * rate / np.where(turns, travelled, 1.0), 0.0)
        by_along = (by_begin + by_end) * (
            np.where(along > 0, scale, 0.0) + turned * ahead
        ) + by_end * turned * length
        across = (history - along * direction) / np.where(length > 0, length, np.inf)
        slope = _covector(by_along * across + by_end * scale * direction)[: len(strain)]
        history = history - np.minimum(along, 0.0) * direction + e
        new = np.concatenate(
            (
                start + e,
                np.where(length > 0, history, since),
                np.maximum(largest, _shear(start + e))[None],
            )
        )
        return Stiffening(factor, slope, new)

    def _secant(self, begin: Array, end: Array) -> tuple[Array, Array, Array]:
        """Return the mean ratio of the tangent moduli between two strains over that of G_0, and its
        derivatives.
        """
        limit, gap = np.sqrt(self.ratio) - 1, end - begin
        above = np.where(begin < limit, 1.0, 0.0), np.where(end < limit, 1.0, 0.0)
        a, b = np.minimum(begin, limit), np.minimum(end, limit)
        some = np.where(gap > 0, gap, 1.0)
        share = np.where(gap > 0, (b - a) / some, above[0])
        secant = self.ratio / ((1 + a) * (1 + b))
        turn = np.where(gap > 0, (secant - 1) / some, 0.0)
        return (
            1 + (secant - 1) * share,
            -above[0] * secant / (1 + a) * share + turn * (share - above[0]),
            -above[1] * secant / (1 + b) * share + turn * (above[1] - share),
        )


def _product(a: Array, b: Array) -> Array:
    """Return the product of deviators with engineering shear strains, (6, n)."""
    return (a[:3] * b[:3]).sum(axis=0) + 0.5 * (a[3:] * b[3:]).sum(axis=0)


def _norm(e: Array) -> Array:
    """Return the norm of deviators."""
    return np.sqrt(_product(e, e))


def _shear(e: Array) -> Array:
    """Return the shear strain of deviators."""
    return np.sqrt(1.5) * _norm(e)


def _covector(e: Array) -> Array:
    """Return the gradient by engineering strains of the product with a deviator."""
    return np.concatenate((e[:3], 0.5 * e[3:]))
