"""Newton's method for the equations of many material points at once.

Points are independent of each other. A point whose equations are solved leaves the iteration, and
the arrays shrink: functions receive the data of the remaining points.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from .base import Array, Parameter

Data = TypeVar("Data")


def take(data: Data, points: NDArray[np.intp] | slice) -> Data:
    """Return the data of some points: arrays (..., n), or tuples of them; numbers stay."""
    result: Any = data
    if isinstance(data, np.ndarray):
        if isinstance(points, slice):
            result = data[..., points]
        else:
            result = data.take(points, axis=-1)
    elif isinstance(data, tuple):
        values = [take(value, points) for value in data]
        if type(data) is tuple:
            result = tuple(values)
        else:
            result = type(data)(*values)
    return result


def bracketed_root(
    function: Callable[..., tuple[Array, Array, Parameter]],
    start: Array,
    low: Array,
    high: Array,
    data: tuple[Any, ...],
    iterations: int,
) -> tuple[Array, NDArray[np.intp]]:
    """Return the roots x of f between bounds, f(low) > 0 > f(high), and the points without one.

    Newton's method bisects where its step leaves the bounds or f does not fall. The call
    ``function(x, *data)`` returns f, its slope, and the change of x that is the last one, (n,).
    """
    result = start.copy()
    active = np.arange(start.size)
    x = start
    for _ in range(iterations):
        if not active.size:
            break
        # narrow the bounds by the sign of f
        value, slope, last = function(x, *data)
        low = np.where(value > 0, x, low)
        high = np.where(value > 0, high, x)

        # take Newton's step where it is usable, otherwise bisect
        newton = x - value / slope
        inside = (newton > low) & (newton < high)
        usable = (slope < 0) & (inside | (newton == x))
        new = np.where(usable, newton, 0.5 * (low + high))
        result[active] = new

        # continue with the points that have moved
        remaining = np.flatnonzero(np.abs(new - x) > last)
        x = new
        if remaining.size < active.size:
            active, x, low, high, data = take((active, x, low, high, data), remaining)
    return result, active


def damped_newton(
    function: Callable[..., tuple[Array, Array]],
    start: Array,
    data: tuple[Any, ...],
    last: float,
    iterations: int,
    halvings: int,
    least: Array | float = -np.inf,
) -> tuple[Array, NDArray[np.intp]]:
    """Return the solutions x of systems, (m, n), from a start, and the points without one.

    A step is halved until the residual falls, but not more than `halvings` times, and does not lead
    below the `least` values, (m, 1). The call ``function(x, *data)`` returns Newton's step, (m, n),
    and the size of the residual at x, (n,). From a size below `last` the step is the last one.
    """
    result = start.copy()
    active = np.arange(start.shape[1])
    x = base = start
    step = np.zeros_like(start)
    smallest = np.full(active.size, np.inf)
    halved = np.zeros(active.size, int)
    for _ in range(iterations):
        if not active.size:
            break
        # take Newton's step from a smaller residual, otherwise half of the last step
        newton, error = function(x, *data)
        falls = (error < smallest) | (halved >= halvings)
        step = np.where(falls, newton, 0.5 * step)
        base = np.where(falls, x, base)
        halved = np.where(falls, 0, halved + 1)
        smallest = np.where(falls, error, smallest)
        x = np.maximum(base + step, least)

        # continue with the points that are not solved
        remaining = np.flatnonzero(~(error < last))
        if remaining.size < active.size:
            result[:, active] = x
            active, x, base, step, halved, smallest, data = take(
                (active, x, base, step, halved, smallest, data), remaining
            )
    result[:, active] = x
    return result, active
