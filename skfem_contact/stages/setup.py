"""From forms and supports to a system that can be solved."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from ..contact.penalty import choose_penalties
from ..errors import look_up
from ..forms.base import Form, as_forms, solids_of
from ..layout import Layout
from ..nonlinear.system import System
from ..results.result import StageResult
from ..solvers.choice import linear_solver
from .supports import all_unknowns, as_unknowns, check_supports


def build_system(forms: Mapping[str, Any], fixed: ndarray, unknowns: Layout | None = None, solver: Any = None
                 ) -> System:
    """The system of some forms, completed, once their supports are checked; by default among their own unknowns."""
    given, fixed = as_forms(forms), as_unknowns(fixed)
    unknowns = unknowns or all_unknowns(given)
    check_supports(given, fixed, unknowns)
    return system_of(given, fixed, unknowns, solver)


def system_of(forms: Mapping[str, Form], fixed: ndarray, unknowns: Layout, solver: Any) -> System:
    """The system of forms and supports that have been checked."""
    there = choose_penalties(forms)
    free = np.setdiff1d(np.arange(unknowns.size), fixed)
    return System(there, unknowns, fixed, linear_solver(there, solver, unknowns.places, free))


def forms_there(stage: StageResult, forms: Mapping[str, Form], what: str = "stage") -> dict[str, Form]:
    """The forms that a stage holds, with penalties chosen from all; a ``ValueError`` where one is not given."""
    for name in stage.states:
        look_up(name, forms, f"form, though the {what} holds it,")
    return {name: form for name, form in choose_penalties(forms).items() if name in stage.states}


def unknowns_of(forms: Mapping[str, Form]) -> ndarray:
    """Layout of the solids, and those that other forms bring."""
    found = [np.unique(form.basis.element_dofs) for form in solids_of(forms).values()]
    found += [form.carries for form in forms.values() if form.carries is not None]
    found += [field.numbers for form in forms.values() if form.carries is None for field in form.fields]
    return np.unique(np.concatenate(found)) if found else np.zeros(0, int)


def not_there(forms: Mapping[str, Form], there: Mapping[str, Form], unknowns: Layout) -> ndarray:
    """Layout that some of the forms would carry, or that fields have, but nothing carries that is there."""
    return np.setdiff1d(np.union1d(unknowns_of(forms), unknowns.brought), unknowns_of(there))


def on_all(values: Any, unknowns: Layout, what: str) -> ndarray:
    """Values of all unknowns, or of the displacements and zeros behind them; a ``ValueError`` for others, or NaN."""
    if np.ma.isMaskedArray(values) or np.iscomplexobj(values):
        raise ValueError(f"{what} must be an array of real numbers, not masked and not complex")
    values = np.asarray(values, dtype=float)
    if values.shape not in ((unknowns.size,), (unknowns.fields[0].end,)):
        raise ValueError(f"{what} has shape {values.shape}, not ({unknowns.fields[0].end},)")
    if not np.isfinite(values).all():
        raise ValueError(f"{what} holds NaN or infinite values")
    return values if len(values) == unknowns.size else np.pad(values, (0, unknowns.size - len(values)))
