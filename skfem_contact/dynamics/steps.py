"""Lengths of the steps of a stage in time, by failures, by their error and by contact.

A step of the length h errs by the difference of Newmark's displacement and the series of Taylor,

    e = |beta + (alpha_m - alpha_f) / 2 - 1/6| h^2 |a_(n+1) - a_n|,

where (alpha_m - alpha_f) h is the time by which the accelerations of the generalised-alpha method
lag behind (the estimate of O. C. Zienkiewicz and Y. M. Xie 1991, Earthq. Eng. Struct. Dyn. 20, 871,
for rho_inf = 1). It is measured in the norm of the masses, |e|^2 = e^T M e, and compared with the
largest displacement of the stage so far. It falls with h^3.
"""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..errors import NotConverged, saying
from .scheme import Motion, Scheme

#: Parts of the longest step; a step without equilibrium is cut to a quarter.
PARTS = 1024
_CUT = 4
#: Share of the tolerance that a new length aims at. Steps grow to twice their length once the last
#: few have asked for no shorter ones, so that factors of matrices are kept.
_SAFE = 0.7
_PATIENCE = 4
#: Share of the points of a contact pair that a step may close or open before it must be short.
CHANGED = 0.2


class Steps:
    """Steps of a stage in time: halves, quarters, ... of the longest one.

    Parameters
    ----------
    longest, number
        Length of the longest step, and number of such steps in the stage.
    tolerance
        Error of a step as a share of the largest displacement; None for steps that only failures
        shorten.
    scheme, M
        Parameters of the method and masses, (N, N), which measure errors.
    start : ndarray, shape (N,)
        Displacements at the start of the stage.
    transit
        Time of a wave through an element: the length of steps in which contact closes and opens.

    Attributes
    ----------
    failed
        True after a step that has found no equilibrium.
    """

    def __init__(
        self,
        longest: float,
        number: int,
        tolerance: float | None,
        scheme: Scheme,
        M: csr_matrix,
        start: ndarray,
        transit: float = np.inf,
    ) -> None:
        self._longest = longest
        self._end = number * PARTS
        self._tolerance = tolerance
        self._error = scheme.error
        self._M = M
        self._start = start
        self._transit = transit
        self._done = 0
        self._size = PARTS
        self._waits = 0
        self._far = 0.0
        self.failed = False

    @property
    def finished(self) -> bool:
        """True at the end of the stage."""
        return self._done >= self._end

    @property
    def length(self) -> float:
        """Length of the next step."""
        return self._longest * self._size / PARTS

    @property
    def time(self) -> float:
        """Time at the end of the next step, since the start of the stage."""
        return self._longest * ((self._done + self._size) / PARTS)

    @property
    def fraction(self) -> float:
        """Share of the stage that is done."""
        return self._done / self._end

    def cut(self, error: NotConverged, where: str) -> None:
        """Shorten the next step after a failure; `where` says at which time, for a message."""
        self._size //= _CUT
        self._waits = _PATIENCE
        self.failed = True
        if self._size == 0:
            raise saying(
                error,
                f"{where}, {self.fraction:.2%} of its duration, where steps of 1/{PARTS} of "
                f"{self._longest:g} find no equilibrium: {error}",
            ) from error

    def refuses(self, before: Motion, after: Motion, changed: float) -> bool:
        """Return True if a step must be shorter, with a new length.

        Parameters
        ----------
        before, after
            Motions at its ends.
        changed
            Share of the points of a contact pair that it has closed or opened.
        """
        if self._tolerance is None:
            return False
        # Measure the error
        self._far = max(self._far, self._norm(after.x - self._start))
        error = self._error * self.length**2 * self._norm(after.acceleration - before.acceleration)
        allowed = self._tolerance * self._far
        size = self._size

        # Shorten the step, but not below a part
        if error > allowed:
            factor = (_SAFE * allowed / error) ** (1.0 / 3.0)
            size = _power_of_two(max(1.0, factor * size))
        if changed > CHANGED and self.length > self._transit:
            size = min(size, _power_of_two(max(1.0, PARTS * self._transit / self._longest)))
        if size < self._size:
            self._size = size
            self._waits = _PATIENCE
            return True
        if 8.0 * error > _SAFE * allowed:
            self._waits = _PATIENCE
        return False

    def accept(self) -> None:
        """Continue with the next step, twice as long where it may be."""
        self._done += self._size
        self._waits -= 1
        self.failed = False
        patient = self._tolerance is not None and self._waits > 0
        if self._size < PARTS and not patient and self._done % (2 * self._size) == 0:
            self._size *= 2
            self._waits = _PATIENCE

    def _norm(self, values: ndarray) -> float:
        """Return the norm of displacements by the masses."""
        return float(np.sqrt(values @ (self._M @ values)))


def _power_of_two(size: float) -> int:
    """Return the largest power of two that is not above a size."""
    return int(2 ** np.floor(np.log2(size)))
