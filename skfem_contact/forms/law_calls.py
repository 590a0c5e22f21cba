"""Calls of material laws, those of several regions and bodies together.

A pit that is dug in lifts has a body of a few elements for each. An update of a hundred points
costs as much as one of ten, so that the small bodies would take as long as the ground. While the
forms of an analysis are evaluated their calls wait, and the first result that is asked for computes
all calls of one law.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy import ndarray

from ..materials import Material, Update
from ..materials.base import parameters_of, updated

#: Points of a region from which on it is called alone: copies cost more than calls.
_MANY = 16384

_Waiting = dict[tuple[Any, ...], list["LawCall"]]
_waiting: ContextVar[_Waiting | None] = ContextVar("calls that wait", default=None)


@contextmanager
def together() -> Iterator[None]:
    """Let the calls that are made inside wait for each other."""
    token = _waiting.set({})
    try:
        yield
    finally:
        _waiting.reset(token)


@dataclass(eq=False)
class LawCall:
    """Strain increment of a region from an accepted state, and the response of its law.

    Attributes
    ----------
    increment, stress : ndarray, shape (ncomp, n_elements, n_points)
        Strain increment and accepted stress.
    internal : ndarray, shape (n_internal, n_elements, n_points)
        Accepted internal variables.
    duration
        Time of the increment.
    elastic
        Elastic strains after the increment, for a hyperelastic law.
    waits
        True if calls of other regions may join this one.
    """

    law: Material
    increment: ndarray
    stress: ndarray
    internal: ndarray
    duration: float
    elastic: ndarray | None = None

    def __post_init__(self) -> None:
        waiting = _waiting.get()
        self.waits = waiting is not None and self._shares
        self._calls = [self]
        if waiting is not None and self.waits:
            kind = id(self.law), len(self.stress), self.stress.shape[2], self.duration
            self._calls = waiting.setdefault(kind, [])
            self._calls.append(self)

    @property
    def _shares(self) -> bool:
        """True if other points can follow these ones in a call."""
        if self.elastic is not None:
            return False
        if not self.law.n_internal or self.stress[0].size > _MANY:
            return False
        values = parameters_of(self.law).values()
        return all(value is None or isinstance(value, (int, float)) for value in values)

    @cached_property
    def update(self) -> Update:
        """Response of the law."""
        if self.elastic is not None:
            return self.law.at_strain(self.elastic, self.internal)
        calls = list(self._calls)
        self._calls.clear()  # where the law fails each call is made again by itself
        if len(calls) < 2:
            return updated(self.law, self.increment, self.stress, self.internal, self.duration)

        # call the law once
        internal = np.concatenate([call.internal for call in calls], axis=1)
        whole = updated(
            self.law,
            np.concatenate([call.increment for call in calls], axis=1),
            np.concatenate([call.stress for call in calls], axis=1),
            internal,
            self.duration,
        )

        # give each call its elements
        tangent = cache(whole.tangent)
        n_points = self.stress.shape[2]
        start = 0
        for call in calls:
            part = slice(start, start + call.stress.shape[1])
            own = whole.internal[:, part]
            if whole.internal is internal:
                own = call.internal
            vars(call)["update"] = Update(
                whole.stress[:, part],
                own,
                *_within(whole.plastic, tangent, n_points * part.start, n_points * part.stop),
            )
            start = part.stop
        return vars(self)["update"]


def _within(plastic: ndarray, tangent: Any, start: int, stop: int) -> tuple[ndarray, Any]:
    """Return the plastic points between two numbers, and the function of their tangents."""
    inside = np.flatnonzero((plastic >= start) & (plastic < stop))
    return plastic[inside] - start, lambda: tangent()[inside]
