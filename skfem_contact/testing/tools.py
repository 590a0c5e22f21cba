"""What the checks have in common: differences, and functions that change nothing."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy import ndarray

#: Steps of the differences, relative to the size of what is varied.
STEP = 1e-6
#: What counts as round-off, relative to the size of the values.
EXACT = 1e-9
#: Second differences above this share of the first ones show a kink, where there is no tangent.
_KINK = 1e-3


class CheckFailed(AssertionError):
    """A law or a form does not do what an analysis relies on.

    Examples
    --------
    >>> from skfem_contact import CheckFailed
    >>> issubclass(CheckFailed, AssertionError)
    True
    """


def differences(function: Callable[[float], ndarray], h: float) -> tuple[ndarray, ndarray]:
    """Central difference, and by how much the one-sided ones differ."""
    forward, backward, middle = function(h), function(-h), function(0.0)
    return (forward - backward) / (2 * h), np.abs(forward - 2 * middle + backward) / h


def largest_error(error: ndarray, kink: ndarray, tolerance: float, what: str, kinks: float = 0.1) -> float:
    """Largest error where there is a tangent; at most the share `kinks` of the points may have none."""
    smooth = kink <= _KINK
    require(smooth.mean() >= 1.0 - kinks, f"{np.sum(~smooth)} of {smooth.size} derivatives jump and cannot be checked")
    require_all(~smooth | (error <= tolerance), f"{what}, by {error[smooth].max(initial=0.0):.1e}")
    return float(error[smooth].max(initial=0.0))


def same_twice(function: Callable[[], Any], arguments: tuple[ndarray, ...], what: str) -> Any:
    """The answer of a function that is the same twice and leaves its arguments as they are."""
    before = [a.copy() for a in arguments]
    first, second = function(), function()
    require(all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in zip(arguments, before, strict=True)),
             f"{what} changes its arguments")
    answers = (first,), (second,)
    for a, b in zip(*((first, second) if isinstance(first, tuple) else answers), strict=True):
        same = callable(a) or np.array_equal(a, b, equal_nan=np.asarray(a).dtype.kind == "f")
        require(same, f"{what} answers differently the second time")
    return first


def require(holds: Any, message: str) -> None:
    """Raise a :class:`CheckFailed` unless the condition holds."""
    if not holds:
        raise CheckFailed(message)


def require_all(holds: ndarray, message: str) -> None:
    """Raise a :class:`CheckFailed` that counts the points where the condition does not hold."""
    if not np.all(holds):
        raise CheckFailed(f"{message} ({np.sum(~holds)} of {np.size(holds)} points)")
