"""Bounds beside a factor of safety or a limit load that a search has found."""
from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy import ndarray

from .bounds import bracket, check_settings, names_of
from .reading import read
from .result import Bounds
from .vectors import Vectors

#: What may be asked for besides: arguments of :func:`~skfem_contact.bounds`.
_OPTIONS: dict[str, Any] = {"water": None, "wetted": (), "gap": 0.01, "elements": 20_000, "seconds": np.inf}


def beside(certify: bool | Mapping[str, Any], forms: Mapping[str, Any], fixed: ndarray, dead: ndarray,
           live: ndarray | None, reduce: str | Collection[str] | None = None, exclude: str | Collection[str] = (),
           flow: str = "given", progress: bool | None = None) -> Bounds | None:
    """Bounds of what a search looks for; None unless they are asked for.

    Parameters
    ----------
    certify
        Whether, or arguments of :func:`~skfem_contact.bounds`: water, wetted, gap, elements, seconds.
    forms, fixed, reduce, exclude, flow, progress
        As for the search.
    dead, live
        Load vectors, fixed and multiplied, (N,); live is None where the strength is reduced.

    Raises
    ------
    ValueError
        As :func:`~skfem_contact.bounds`; other arguments; loads that are not distributed, see :class:`Vectors`.
    """
    if certify is False:
        return None
    if certify is not True and (not isinstance(certify, Mapping) or set(certify) - set(_OPTIONS)):
        raise ValueError(f"certify must be True, or arguments of bounds among {', '.join(_OPTIONS)}, not {certify!r}")
    given = _OPTIONS | (dict(certify) if isinstance(certify, Mapping) else {})
    check_settings(given["gap"], given["elements"], given["seconds"])
    vectors = Vectors(dead, live, given["water"], names_of(given["wetted"]))
    problem = read(forms, fixed, vectors, reduce, exclude, flow == "associated")
    return bracket(problem, given["gap"], given["elements"], given["seconds"], progress, stacklevel=6)
