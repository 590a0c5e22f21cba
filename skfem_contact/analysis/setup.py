"""From forms and supports to a system that can be solved."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from ..contact.penalty import choose_penalties
from .interface import linear_solver
from .supports import as_unknowns, check_supports
from .system import Form, System


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
        See :func:`~skfem_contact.analysis.supports.check_supports`.
    """
    fixed = as_unknowns(fixed)
    locations = check_supports(forms, fixed)
    forms = choose_penalties(forms)
    free = np.setdiff1d(np.arange(locations.shape[1]), fixed)
    return System(forms, fixed, free, linear_solver(forms, solver, locations, free))


def check_load(load: Any, n: int, what: str = "load") -> ndarray:
    """A load vector, or a ``ValueError``: wrong size, NaN, or zero everywhere."""
    load = np.asarray(load, dtype=float)
    if load.shape != (n,):
        raise ValueError(f"the {what} has shape {load.shape}, not ({n},)")
    if not np.isfinite(load).all():
        raise ValueError(f"the {what} holds NaN or infinite values")
    if not load.any():
        raise ValueError(f"the {what} is zero: nothing drives a collapse")
    return load
