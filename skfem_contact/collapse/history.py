"""SearchLog on the way to a collapse, and its mechanism."""
from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray

from ..errors import AnalysisWarning, NoEquilibrium, NotConverged
from ..materials.spectral import extremes
from ..solid import SolidForm, SolidState
from .continuation import Point


@dataclass(frozen=True)
class Step:
    """A step of a search.

    Attributes
    ----------
    parameter
        Factor of safety or load multiplier.
    outcome
        ``"equilibrium"``, ``"collapse"`` or ``"stall"``.
    iterations
        Number of tangents factored.
    residual
        Relative residual at the end.
    displacement
        Largest displacement since the start.
    yielding
        Share of the points of all solids that flowed in this step.
    work
        Work of the reference load since the start.
    """

    parameter: float
    outcome: str
    iterations: int
    residual: float
    displacement: float
    yielding: float
    work: float


class SearchLog:
    """Collects the steps of a search and shows them in a progress bar.

    Parameters
    ----------
    bar
        A ``tqdm`` progress bar.
    """

    def __init__(self, bar: Any) -> None:
        self.steps: list[Step] = []
        self._bar, self._origin = bar, np.zeros(0)
        self._states: Mapping[str, Any] = {}

    def begin(self, point: Point) -> None:
        """Where displacements and flow are counted from."""
        self._origin, self._states = point.x, point.states

    def accept(self, point: Point) -> None:
        """An equilibrium."""
        self._add(Step(point.parameter, "equilibrium", point.iterations, point.residuals[-1],
                            self._moved(point.x), yielding_share(self._states, point.states), point.work))
        self._states = point.states

    def reject(self, parameter: float, error: NotConverged, work: float) -> None:
        """A step without equilibrium."""
        self._add(Step(parameter, "collapse" if isinstance(error, NoEquilibrium) else "stall",
                            max(len(error.residuals) - 1, 0), error.residuals[-1] if error.residuals else np.nan,
                            self._moved(error.x), np.nan, work))

    def _moved(self, x: ndarray | None) -> float:
        return np.nan if x is None else float(np.abs(x - self._origin).max(initial=0.0))

    def _add(self, step: Step) -> None:
        self.steps.append(step)
        iterations = sum(s.iterations for s in self.steps)
        self._bar.set_postfix_str(f"{step.parameter:.4f} {step.outcome}, {iterations} iterations")


def yielding_share(before: Mapping[str, Any], after: Mapping[str, Any]) -> float:
    """Share of the points of all solids whose plastic strain has grown."""
    flowed = points = 0
    for name, state in after.items():
        if isinstance(state, SolidState):
            points += state.stress[0].size
            if len(state.internal):
                earlier = before[name].internal
                flowed += int((state.internal[0] > (earlier[0] if len(earlier) else 0.0)).sum())
    return flowed / points if points else 0.0


def shear_bands(forms: Mapping[str, Any], mechanism: ndarray) -> dict[str, ndarray]:
    """Largest shear strain, of plane bodies that in their plane, at the points of every solid, (n_elements, n_points).

    Parameters
    ----------
    forms
        Forms by name.
    mechanism
        Displacement increment, (N,).
    """
    bands = {}
    for name, form in forms.items():
        if isinstance(form, SolidForm):
            strain = form.assemble(mechanism, form.initial_state()).state.strain
            if len(strain) == 4:
                bands[name] = np.hypot(strain[0] - strain[1], strain[3])
            else:
                largest, smallest = extremes(np.concatenate((strain[:3], 0.5 * strain[3:])))
                bands[name] = largest - smallest
    return bands


def describe_mesh(forms: Mapping[str, Any]) -> str:
    """Elements and unknowns in one line, such as ``576 ElementTriP2, 2442 unknowns``."""
    bases = [form.basis for form in forms.values() if isinstance(form, SolidForm)]
    count = Counter[str]()
    for basis in bases:
        count[type(basis.elem.elem).__name__] += basis.nelems
    elements = " and ".join(f"{n} {kind}" for kind, n in count.items())
    return f"{elements}, {bases[0].N} unknowns"


def table(steps: tuple[Step, ...], symbol: str) -> str:
    """The steps as lines of a table; displacements and yielding only where there is equilibrium."""
    lines = [f"{symbol:>10}  outcome      iterations  residual  displacement  yielding"]
    for s in steps:
        found = s.outcome == "equilibrium"
        moved, yielding = (f"{s.displacement:.4g}", f"{s.yielding:.1%}") if found else ("–", "–")
        lines.append(f"{s.parameter:10.5f}  {s.outcome:11}  {s.iterations:10d}  {s.residual:8.1e}  {moved:>12}  "
                     f"{yielding:>8}")
    return "\n".join(lines)


def warn_of_stall(what: str, value: float, criterion: str) -> None:
    """Warn that a search ended where Newton's method failed, and not at a collapse.

    Where the stiffness of an equilibrium is singular, all that can yield does: that is a collapse.
    """
    if criterion.startswith("stall") and "singular" not in criterion:
        warnings.warn(f"no collapse was shown: the search for the {what} ended at {value:.4g} with a {criterion}",
                      AnalysisWarning, stacklevel=4)
