"""Slides of bodies from rest to rest in a stage in time, and how well its steps follow them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy import ndarray

from ..contact import ContactState
from ..contact.laws import Status

#: Error of the slip after a slide of n steps, times n squared: a rigid block after a pulse of 40 ms
#: errs by 16 % with 7 steps, 5 % with 15, 1.5 % with 30 and 0.5 % with 59. After 24 pulses of
#: other shapes the factor was 11 in the median and at most 17. Loads that jump within a step err by
#: 1 / n: 5 % with 23 steps.
_ERROR = 9.0
#: Error that is remarked on. With 14 to 21 steps, of which it is 2 to 5 %, ten slides erred by 0.5
#: to 11 %.
_TOLD = 0.02


@dataclass(frozen=True)
class _Slide:
    """A slide so far, or one that has ended.

    Attributes
    ----------
    slip, steps
        Slip and number of steps so far.
    way
        Slip of the last step, (dim - 1,).
    """

    slip: float = 0.0
    steps: int = 0
    way: ndarray | None = None


class Slides:
    """Slides of the contact pairs of a stage: all closed points slip, between steps of rest."""

    def __init__(self) -> None:
        self._now: dict[str, _Slide] = {}
        self._ended: dict[str, list[_Slide]] = {}

    def add(self, name: str, before: ContactState, after: ContactState) -> None:
        """Add a step of a pair with its states at both ends."""
        # A slide begins after closed points that stick, and ends before them.
        slide = self._now.pop(name, None)
        if slide is None and _rests(before):
            slide = _Slide()
        if slide is None:
            return
        if not _slips(after):
            if _rests(after):
                self._end(name, slide)
            return

        # Add the slip of the step; a slide the other way is another one.
        way = np.zeros(len(after.slip))
        if after.slip.shape == before.slip.shape:
            way = (after.slip - before.slip).mean(axis=1)
        if slide.way is not None and slide.way @ way < 0.0:
            self._end(name, slide)
            slide = _Slide()
        slip = slide.slip + float(np.linalg.norm(way))
        self._now[name] = _Slide(slip, slide.steps + 1, way)

    def _end(self, name: str, slide: _Slide) -> None:
        """Keep a slide that has ended."""
        if slide.steps:
            self._ended.setdefault(name, []).append(slide)

    def remarks(self) -> Iterator[tuple[str, str]]:
        """Yield names of pairs and texts on slides of few steps."""
        for name, slides in self._ended.items():
            slips = [slide.slip for slide in slides]
            if not sum(slips):
                continue
            steps = float(np.average([slide.steps for slide in slides], weights=slips))
            error = min(_ERROR / steps**2, 1.0)
            if error > _TOLD:
                yield (
                    name,
                    f"bodies slide for {steps:.2g} steps at a time, by which slips err by about "
                    f"{error:.0%}, more if loads jump: take shorter steps, or "
                    "Dynamic(tolerance=1e-3)",
                )


def _slips(state: ContactState) -> bool:
    """Return True if all closed points slip against friction."""
    closed = state.status != Status.OPEN
    rubs = np.any(state.traction[1:] != 0.0)
    return bool(rubs and (state.status[closed] == Status.SLIP).all())


def _rests(state: ContactState) -> bool:
    """Return True if a closed point sticks."""
    return bool((state.status == Status.STICK).any())
