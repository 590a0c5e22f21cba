"""Steps in time: of second order in two parts where a form knows them, and as long as their estimated error allows.

Both parts of a step are of Euler's backward method over the same time, so that they have the same matrix (R. Alexander
1977: diagonally implicit, stable in a strong sense and as accurate at the end as anywhere). No pressures or flows at
the beginning are asked for: loads may jump there.
"""
from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from .increment import solve_increment
from .newton import Newton
from .system import Equilibrium, System

#: Share of a step that its first part takes, and as much of the second one (Alexander 1977, p. 1012).
PART = 1.0 - np.sqrt(0.5)
#: Digits of the share of a stage that a step takes: equal steps then are so to the last bit, and share their factor.
_DIGITS = 12

#: Load and prescribed values at a share of a stage.
Path = Callable[[float], tuple[ndarray, ndarray]]


def solve_step(system: System, x: ndarray, states: Mapping[str, Any], path: Path, span: tuple[float, float],
               duration: float, newton: Newton, start: ndarray | None, try_recovery: bool
               ) -> tuple[Equilibrium, dict[str, tuple[float, float]]]:
    """Equilibrium at the end of a step, and the allowed and the compared errors in time of its forms by name.

    The step goes from one share of the stage to another (`span`); where the stage has no duration it is a plain
    increment, see :func:`solve_increment`.
    """
    begin, end = span
    duration *= round(end - begin, _DIGITS)
    second_order = {name for name, form in system.forms.items() if form.second_order}
    if not second_order or not duration > 0.0:
        step = system.over(duration)
        return solve_increment(step, x, states, *path(end), newton, start, try_recovery), {}
    first = system.over(PART * duration)
    towards = None if start is None else x + PART * (start - x)
    middle = solve_increment(first, x, states, *path(begin + PART * (end - begin)), newton, towards, try_recovery)
    second = first.with_forms({name: first.forms[name] if name in second_order
                               else form.over((1.0 - PART) * duration) for name, form in system.forms.items()})
    begun = {name: first.forms[name].extrapolated(states[name], state, 1.0 / PART - 1.0) if name in second_order
             else state for name, state in middle.states.items()}
    last = solve_increment(second, middle.x, begun, *path(end), newton, None, try_recovery)
    errors = {name: first.forms[name].time_error(middle.states[name], last.states[name]) for name in second_order}
    return Equilibrium(last.x, last.states, middle.residuals + last.residuals[1:],
                       middle.equilibria + last.equilibria), errors
