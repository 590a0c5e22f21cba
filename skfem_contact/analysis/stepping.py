"""How large the increments of a stage are, and how much is tried to find an equilibrium in each."""
from __future__ import annotations

import numpy as np

from .newton import Collapse, NotConverged

#: An increment that fails at this share of the stage has failed for good.
_SMALLEST = 1.0 / 1024.0
#: An increment with so few iterations to an equilibrium may be followed by a larger one.
_EASY = 8
#: What remains of an increment that failed although everything was tried, and of one for which little was tried.
_QUARTER, _HALF = 0.25, 0.5
#: Share of the stage from which on everything is tried in every increment.
_SMALL = 1.0 / 128.0
#: Distance from the last equilibrium to a collapse, as a share of what was reached, at which the limit is found.
_NARROW = 0.02
_ROUND_OFF = 1e-9


class Stepping:
    """Sizes of the increments: cut where they fail, growing where they are easy.

    Everything is tried in the first increment of a stage.  Later on, a load that failed although everything was tried
    is approached by attempts that cost little, until these have passed it or the increments are small.

    Parameters
    ----------
    increments
        Number of increments to begin with.

    Examples
    --------
    >>> from skfem_contact import Collapse
    >>> stepping = Stepping(1)
    >>> stepping.reject(Collapse("collapse"))
    >>> stepping.fraction, stepping.thorough
    (0.25, True)
    >>> stepping.accept(stepping.fraction, iterations=5)
    >>> stepping.fraction
    0.75
    """

    def __init__(self, increments: int) -> None:
        self._size = self._largest = 1.0 / increments
        self._reached, self._failed, self._collapsed = 0.0, np.inf, np.inf
        #: Whether the attempt before this one failed.
        self.cut = False

    @property
    def fraction(self) -> float:
        """Share of the stage's load to be tried next."""
        fraction = self._reached + self._size
        return fraction if 1.0 - fraction > _ROUND_OFF else 1.0

    @property
    def size(self) -> float:
        """Size of the increment to be tried next."""
        return self._size

    @property
    def thorough(self) -> bool:
        """Whether everything is to be tried."""
        new = self.fraction < self._failed - _ROUND_OFF and not self.cut
        return new or self._reached == 0.0 or self._size <= _SMALL

    @property
    def exhausted(self) -> bool:
        """Whether smaller increments would tell no more."""
        return self._size < _SMALLEST or self._limited

    @property
    def _limited(self) -> bool:
        """Whether an equilibrium and a collapse are next to each other."""
        return self._collapsed - self._reached <= _NARROW * self._reached

    def accept(self, fraction: float, iterations: int, equilibria: int = 1) -> None:
        """An equilibrium was found, or several in a row."""
        self._reached, self.cut = fraction, False
        self._failed, self._collapsed = (f if f > fraction + _ROUND_OFF else np.inf
                                         for f in (self._failed, self._collapsed))
        if iterations <= _EASY * equilibria:
            self._size = max(self._size, min(2.0 * self._size, self._largest))

    def reject(self, error: NotConverged) -> None:
        """None was found."""
        share = _QUARTER if self.thorough else _HALF
        self._failed = self.fraction
        if isinstance(error, Collapse):
            self._collapsed = self.fraction
        self._size, self.cut = share * (self.fraction - self._reached), True

    def __str__(self) -> str:
        told = f"stopped at {self._reached:.2%} of its load"
        return f"{told}, the displacements run away at {self._collapsed:.2%}" if self._limited else told
