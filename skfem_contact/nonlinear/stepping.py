"""Sizes of increments, and extrapolation from one increment to the next."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy import ndarray

from ..errors import NoEquilibrium, NotConverged
from ..solvers.direct import SingularSystem

#: Changes of the load that differ by less than this share are in proportion.
_PROPORTIONAL = 1e-6
#: An increment that fails at this share of the stage has failed for good.
_SMALLEST = 1.0 / 1024.0
#: An increment with so few iterations to an equilibrium may be followed by a larger one.
_EASY = 8
#: Share that remains of an increment that failed with recoveries, and of one that failed without.
_QUARTER = 0.25
_HALF = 0.5
#: So many failures of increments of different sizes at one dof, by a tangent that is singular at
#: their beginning.
_AGAIN = 3
#: Share of the stage up to which increments are tried with recoveries.
_SMALL = 1.0 / 128.0
#: Distance from the last equilibrium to a collapse, as a share of what was reached, at which the
#: limit is found.
_NARROW = 0.02
_ROUND_OFF = 1e-9
#: Steps in time keep their length, and with it their matrix, until they may be longer by this, and
#: at most this much.
_WORTH = 2.0
_MOST = 4.0
#: Growth of increments without time.
_TWICE = 2.0
#: Share taken of the step whose estimated error is just allowed, and the least share of a step
#: tried.
_SAFE = 0.9
_LEAST = 0.1


class Stepping:
    """Sizes of the increments: cut where they fail, growing where few iterations are needed.

    Recoveries are tried in the first increment of a stage. Once a load has failed in spite of them,
    it is approached by attempts without recovery, until it is passed or the increments are small.

    Parameters
    ----------
    increments
        Number of increments to begin with.
    first
        Share of the first increment, at most; a step in time that was long enough before.
    """

    def __init__(self, increments: int, first: float = np.inf) -> None:
        self._size = self._largest = 1.0 / increments
        if first < self._size:
            self._size = 1.0 / np.ceil(_SAFE / first)
        self._reached = 0.0
        self._failed = np.inf
        self._collapsed = np.inf
        self._shortest = 1.0
        #: True if the last attempt failed.
        self.cut = False
        self._growth = self._lasting_growth = np.inf
        self._last = 0.0
        self._compared: dict[str, float] = {}
        self._same: int | None = None
        self._times = 0
        self._loose = False

    @property
    def fraction(self) -> float:
        """Share of the stage's load to be tried next."""
        fraction = self._reached + self._size
        if 1.0 - fraction > _ROUND_OFF:
            return fraction
        return 1.0

    @property
    def size(self) -> float:
        """Size of the increment to be tried next."""
        return self._size

    @property
    def allowed(self) -> float:
        """Share that the error of the last step allows for the next one, or infinity."""
        return self._lasting_growth * self._last

    @property
    def try_recovery(self) -> bool:
        """True if recoveries are to be tried."""
        new = self.fraction < self._failed - _ROUND_OFF and not self.cut
        return new or self._reached == 0.0 or self._size <= _SMALL

    @property
    def exhausted(self) -> bool:
        """True if smaller increments would show no more."""
        smallest = self._size < _SMALLEST * self._shortest
        return smallest or self._limited or self._hopeless or self._loose

    @property
    def _hopeless(self) -> bool:
        """True if nothing resists a motion at the same dof, however small the increment is."""
        return self._times >= _AGAIN

    @property
    def _limited(self) -> bool:
        """True if an equilibrium and a collapse lie close together."""
        return self._collapsed - self._reached <= _NARROW * self._reached

    def too_long(
        self,
        errors: Mapping[str, tuple[float, float]],
        in_stage: Mapping[str, tuple[float, float]] = MappingProxyType({}),
    ) -> bool:
        """Return True if errors in time demand that the step is repeated with a shorter length.

        An error is compared with the largest value of its measure in the stage, see
        :meth:`~skfem_contact.roles.Timed.time_error`. Errors that count in the stage alone say
        nothing of the first step of the next one.
        """
        self._lasting_growth = self._allowed_growth(errors)
        self._growth = min(self._lasting_growth, self._allowed_growth(in_stage))
        if self._growth < _SAFE:
            self._size = self._even(self._growth * (self.fraction - self._reached), self._reached)
            self._shortest = min(self._shortest, self._size)
        return self._growth < _SAFE

    def _allowed_growth(self, errors: Mapping[str, tuple[float, float]]) -> float:
        """Return the length of a step of the allowed errors over the length of this one."""
        worst = 0.0
        for name, (error, size) in errors.items():
            largest = max(size, self._compared.get(name, 0.0))
            self._compared[name] = largest
            if error > 0.0:
                worst = max(worst, error / largest)

        # The error of a step is of second order in its length.
        if worst > 0.0:
            return max(_SAFE / float(np.sqrt(worst)), _LEAST)
        return np.inf

    def accept(self, fraction: float, iterations: int, equilibria: int = 1) -> None:
        """Record an equilibrium, or several in a row."""
        # Forget failures that have been passed.
        self._last = fraction - self._reached
        self._reached = fraction
        self.cut = False
        self._times = 0
        if not self._failed > fraction + _ROUND_OFF:
            self._failed = np.inf
        if not self._collapsed > fraction + _ROUND_OFF:
            self._collapsed = np.inf
        # Grow or shrink the increment by the iterations it took.
        if self._growth < 1.0:
            self._size = self._even(self._growth * self._size, fraction)
        elif iterations <= _EASY * equilibria and self._growth >= _WORTH:
            if np.isinf(self._growth):
                most = _TWICE
            else:
                most = min(_MOST, self._growth)
            larger = min(most * self._size, self._largest)
            if larger > self._size:
                self._size = self._even(larger, fraction)

    def _even(self, size: float, reached: float) -> float:
        """Return a size of steps in time, so that equal steps lead to the end of the stage."""
        remaining = 1.0 - reached
        if np.isinf(self._growth) or remaining <= 0.0:
            return size
        return float(remaining / np.ceil(remaining / size * (1.0 - _ROUND_OFF)))

    def reject(self, error: NotConverged, held: float = 1.0) -> None:
        """Record a failure, where contact may hold a share of the increment at most."""
        self._loose = held * self._size < _SMALLEST
        share = _HALF
        if self.try_recovery:
            share = _QUARTER
        at_first = isinstance(error.__cause__, SingularSystem) and len(error.residuals) == 1
        if self.try_recovery and at_first:
            if error.dof == self._same:
                self._times = self._times + 1
            else:
                self._times = 1
            self._same = error.dof
        self._failed = self.fraction
        if isinstance(error, NoEquilibrium):
            self._collapsed = self.fraction
        self._size = share * (self.fraction - self._reached)
        self.cut = True

    def __str__(self) -> str:
        reached = f"stopped at {self._reached:.2%} of its load"
        if self._hopeless:
            advice = "(hold the body, or close its contact)"
            return f"{reached}, where nothing resists a motion in any increment {advice}"
        if self._loose:
            return (
                f"{reached}, for no contact forces hold more of it where bodies are: they slide or "
                "turn as rigid ones (hold them, or more friction)"
            )
        if self._limited:
            return f"{reached}, the displacements run away at {self._collapsed:.2%}"
        return reached


class Predictor:
    """Extrapolation from the last two accepted increments.

    It holds while loads and supports change in proportion. Sliding contact and yielding soil then
    hardly change their state within an increment, and few iterations remain.

    Parameters
    ----------
    fixed
        Dofs whose values are prescribed.
    """

    def __init__(self, fixed: ndarray) -> None:
        self._fixed = fixed
        self._accepted: tuple[tuple[ndarray, ndarray, float], ...] = ()

    @property
    def time(self) -> float:
        """Time of the last accepted increment."""
        if self._accepted:
            return self._accepted[-1][2]
        return 0.0

    @property
    def before(self) -> ndarray:
        """Displacements before the last accepted ones."""
        return self._accepted[0][0]

    def accept(self, x: ndarray, load: ndarray, time: float = 0.0) -> None:
        """Record displacements, load and time of an accepted increment."""
        self._accepted = (*self._accepted[-1:], (x, load, time))

    def start(self, load: ndarray, prescribed: ndarray, time: float = 0.0) -> ndarray | None:
        """Return displacements to start from under a load, or None.

        None stands for changes that are not in proportion.
        """
        if len(self._accepted) < 2:
            return None
        # The last two equilibria must lie on a proportional path.
        (x_before, load_before, then), (x, load_last, last) = self._accepted
        moved = x - x_before
        held = self._fixed
        changes = (
            (load_last - load_before, load - load_last),
            (moved[held], prescribed - x[held]),
            (np.array([last - then]), np.array([time - last])),
        )
        ratios = [float(old @ new / (old @ old)) for old, new in changes if old.any()]
        if not ratios or not ratios[0] > 0.0:
            return None
        for old, new in changes:
            if np.linalg.norm(new - ratios[0] * old) > _PROPORTIONAL * np.linalg.norm(new):
                return None
        # Continue in proportion.
        start = x + ratios[0] * moved
        start[held] = prescribed
        return start
