"""From forms and supports to a system that can be solved."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from ..contact.penalty import choose_penalties
from ..errors import look_up
from ..forms import Form, as_forms
from ..nonlinear.system import System
from ..solid import SolidForm
from ..solvers.choice import linear_solver
from .result import StageResult
from .supports import as_unknowns, check_supports


def build_system(forms: Mapping[str, Form], fixed: ndarray, solver: Any = None) -> System:
    """Give contact pairs their penalties, check the supports and choose a linear solver.

    Parameters
    ----------
    forms
        Solids and contact pairs by name.
    fixed
        Unknowns that are held.
    solver
        A scikit-fem linear solver ``(A, b) -> x``; by default a direct one.

    Raises
    ------
    ValueError
        See :func:`~skfem_contact.stages.supports.check_supports`.
    """
    fixed = as_unknowns(fixed)
    locations = check_supports(forms, fixed)
    forms = as_forms(choose_penalties(forms))
    free = np.setdiff1d(np.arange(locations.shape[1]), fixed)
    return System(forms, fixed, free, linear_solver(forms, solver, locations, free))


def left_by(start: StageResult | None, forms: Mapping[str, Form], fixed: ndarray) -> tuple[dict[str, Form], ndarray]:
    """The forms that a stage has left there, and the unknowns that are held: nodes of what is gone stay where they are.

    Parameters
    ----------
    start
        The stage that is gone on from; with none all forms are there.
    forms
        Solids and contact pairs by name. Penalties are chosen from all of them, as the stages do.
    fixed
        Unknowns that are supported.

    Raises
    ------
    ValueError
        The stage holds forms that are not given.
    """
    if start is None:
        return dict(forms), as_unknowns(fixed)
    there = forms_there(start, forms, "start")
    return there, np.union1d(as_unknowns(fixed), np.setdiff1d(unknowns_of(forms), unknowns_of(there)))


def forms_there(stage: StageResult, forms: Mapping[str, Form], what: str = "stage") -> dict[str, Form]:
    """The forms that a stage holds, with penalties chosen from all; a ``ValueError`` where one is not given."""
    for name in stage.states:
        look_up(name, forms, f"form, though the {what} holds it,")
    return {name: form for name, form in choose_penalties(forms).items() if name in stage.states}


def unknowns_of(forms: Mapping[str, Form]) -> ndarray:
    """Unknowns of the solids."""
    found = [np.unique(f.basis.element_dofs) for f in forms.values() if isinstance(f, SolidForm)]
    return np.unique(np.concatenate(found)) if found else np.zeros(0, int)


def check_load(load: Any, n: int) -> ndarray:
    """A load vector, or a ``ValueError``: wrong size, NaN, or zero everywhere."""
    load = np.asarray(load, dtype=float)
    check_vector(load, n, "the load")
    if not load.any():
        raise ValueError("the load is zero: nothing drives a collapse")
    return load


def check_vector(values: Any, n: int, what: str) -> None:
    """A ``ValueError`` unless the values are as many as the unknowns, and finite."""
    if np.shape(values) != (n,):
        raise ValueError(f"{what} has shape {np.shape(values)}, not ({n},)")
    if not np.isfinite(values).all():
        raise ValueError(f"{what} holds NaN or infinite values")
