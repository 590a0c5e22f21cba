"""Equilibria and failures on the way to a collapse."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..errors import NoEquilibrium, NotConverged
from ..forms.base import Form


class Fall(NotConverged):
    """An equilibrium was found, but below the last one: the step was too long, or the curve has a peak."""


@dataclass(frozen=True)
class Point:
    """An equilibrium on the curve of parameter over work: displacements, (N,), and states; as in :class:`Step`."""

    x: ndarray
    states: Mapping[str, Any]
    parameter: float
    work: float = 0.0
    residuals: tuple[float, ...] = (0.0,)

    @property
    def iterations(self) -> int:
        """Number of tangents factored on the way from the last point to this one."""
        return len(self.residuals) - 1


def kind_of(error: NotConverged) -> Literal["collapse", "peak", "stall"]:
    """How a step failed."""
    return "collapse" if isinstance(error, NoEquilibrium) else "peak" if isinstance(error, Fall) else "stall"


@dataclass(frozen=True)
class Step:
    """A step of a search.

    Attributes
    ----------
    parameter
        Factor of safety or load multiplier.
    outcome
        ``"equilibrium"``, ``"collapse"``, ``"stall"``, or ``"peak"``: an equilibrium below the last one.
    iterations, residual
        Number of tangents factored, and relative residual at the end.
    displacement
        Largest displacement since the start.
    yielding
        Share of the points of all solids that flowed in this step.
    work
        Work of the reference load since the start.
    """

    parameter: float
    outcome: Literal["equilibrium", "collapse", "peak", "stall"]
    iterations: int
    residual: float
    displacement: float
    yielding: float
    work: float


class SearchLog:
    """Collects the steps of a search from some origin and shows them in a progress bar; the forms tell what yields."""

    def __init__(self, forms: Mapping[str, Form], bar: Any, origin: Point) -> None:
        self.steps: list[Step] = []
        self._forms, self._bar = forms, bar
        self.begin(origin)

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
