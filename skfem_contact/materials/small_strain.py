"""Small-strain stiffness of the Hardening Soil: it falls with the strain since the last reversal.

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
    """Ratio of the modulus of an increment to the modulus of unloading, and its slope."""

    factor: Array
    slope: Array  # derivative by the strain, (ncomp, n)
    memory: Array  # new memory


class SmallStrain(NamedTuple):
    """Ratio G_0 / G_ur at the same stress, and the threshold shear strain gamma_07."""

    ratio: float
    gamma_07: float

    def stiffening(self, strain: Array, memory: Array) -> Stiffening:
        """Return the stiffening over increments (ncomp, n) from a memory (13, n)."""
        # compute the deviator of the increment
        e = np.zeros((6, strain.shape[1]))
        e[: len(strain)] = strain
        e[:3] -= e[:3].mean(axis=0)
        length = _norm(e)
        moves = length > 0
        direction = e / np.where(moves, length, 1.0)

        # choose the history that the increment continues: the first loading, or the last reversal
        start = memory[:6]
        since = memory[6:12]
        largest = memory[12]
        first = _shear(start) >= _FIRST * largest
        history = np.where(first, start, since)
        along = np.where(moves, _product(history, direction), _norm(history))
        ahead = np.maximum(along, 0.0)

        # widen the hyperbola: once in the first loading, twice (Masing) after a reversal
        travelled = _norm(start)
        begun = travelled > 0
        share = np.where(first, ahead / np.where(begun, travelled, 1.0), 0.0)
        share = np.where(first & ~begun, 1.0, share)
        rate = 0.385 / self.gamma_07 * np.sqrt(1.5)
        scale = 0.5 * rate * (1 + np.minimum(share, 1.0))
        factor, by_begin, by_end = self._secant(scale * ahead, scale * (ahead + length))

        # differentiate the factor: by the share of the history along the increment, by its length
        turns = first & (along > 0) & begun
        way = np.where(turns, travelled, 1.0)
        turned = np.where(turns, 0.5 * rate / way, 0.0)
        by_ahead = np.where(along > 0, scale, 0.0) + turned * ahead
        by_along = (by_begin + by_end) * by_ahead + by_end * turned * length
        across = (history - along * direction) / np.where(moves, length, np.inf)
        by_strain = by_along * across + by_end * scale * direction
        slope = _covector(by_strain)[: len(strain)]

        # forget the history against the direction of the increment
        history = history - np.minimum(along, 0.0) * direction + e
        since = np.where(moves, history, since)
        largest = np.maximum(largest, _shear(start + e))
        return Stiffening(factor, slope, np.concatenate((start + e, since, largest[None])))

    def _secant(self, begin: Array, end: Array) -> tuple[Array, Array, Array]:
        """Return the mean ratio G / G_ur between two strains, and its derivatives.

        The strains are 0.385 gamma / gamma_07. The tangent modulus is G_0 / (1 + x)^2 up to G_ur,
        its integral from a to b has the mean G_0 / ((1 + a) (1 + b)).
        """
        limit = np.sqrt(self.ratio) - 1
        before = np.where(begin < limit, 1.0, 0.0)
        after = np.where(end < limit, 1.0, 0.0)
        a = np.minimum(begin, limit)
        b = np.minimum(end, limit)

        # compute the mean over the share of the increment before the limit
        gap = end - begin
        moves = gap > 0
        width = np.where(moves, gap, 1.0)
        share = np.where(moves, (b - a) / width, before)
        secant = self.ratio / ((1 + a) * (1 + b))
        turn = np.where(moves, (secant - 1) / width, 0.0)
        return (
            1 + (secant - 1) * share,
            -before * secant / (1 + a) * share + turn * (share - before),
            -after * secant / (1 + b) * share + turn * (after - share),
        )


def _product(a: Array, b: Array) -> Array:
    """Return the product of deviators with engineering shear strains, (6, n)."""
    normal = (a[:3] * b[:3]).sum(axis=0)
    shear = (a[3:] * b[3:]).sum(axis=0)
    return normal + 0.5 * shear


def _norm(e: Array) -> Array:
    """Return the norm of deviators."""
    return np.sqrt(_product(e, e))


def _shear(e: Array) -> Array:
    """Return the shear strain of deviators."""
    return np.sqrt(1.5) * _norm(e)


def _covector(e: Array) -> Array:
    """Return the gradient by engineering strains of the product with a deviator."""
    return np.concatenate((e[:3], 0.5 * e[3:]))
