"""Steps on the way to a collapse."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from ..errors import NotConverged
from ..forms import Form
from .continuation import Point, kind_of
from .result import Step


class SearchLog:
    """Collects the steps of a search and shows them in a progress bar.

    Parameters
    ----------
    forms
        The forms, that tell what yields.
    bar
        A ``tqdm`` progress bar.
    """

    def __init__(self, forms: Mapping[str, Form], bar: Any) -> None:
        self.steps: list[Step] = []
        self._forms, self._bar, self._origin = forms, bar, np.zeros(0)
        self._states: Mapping[str, Any] = {}

    def begin(self, point: Point) -> None:
        """Where displacements and flow are counted from."""
        self._origin, self._states = point.x, point.states

    def accept(self, point: Point) -> None:
        """An equilibrium."""
        self._add(Step(point.parameter, "equilibrium", point.iterations, point.residuals[-1],
                       self._moved(point.x), self._yielding(point.states), point.work))
        self._states = point.states

    def reject(self, parameter: float, error: NotConverged, work: float) -> None:
        """A step without equilibrium."""
        self._add(Step(parameter, kind_of(error), max(len(error.residuals) - 1, 0),
                       error.residuals[-1] if error.residuals else np.nan, self._moved(error.x), np.nan, work))

    @property
    def ever_yielding(self) -> bool:
        """Whether anything has flowed."""
        return any(step.yielding > 0.0 for step in self.steps)

    def _moved(self, x: ndarray | None) -> float:
        return np.nan if x is None else float(np.abs(x - self._origin).max(initial=0.0))

    def _yielding(self, states: Mapping[str, Any]) -> float:
        """Share of the points of all solids that have flowed since the last equilibrium."""
        counts = [form.yielding(self._states[name], states[name]) for name, form in self._forms.items()]
        flowed, points = (sum(numbers) for numbers in zip(*counts, strict=True))
        return flowed / points if points else 0.0

    def _add(self, step: Step) -> None:
        self.steps.append(step)
        iterations = sum(s.iterations for s in self.steps)
        self._bar.set_postfix_str(f"{step.parameter:.4f} {step.outcome}, {iterations} iterations")
