"""Line searches: how far to go along a Newton step."""
from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy import ndarray

from .evaluation import Evaluation

#: The line search accepts what is not worse than the worst of this many last residuals: contact that opens,
#: closes and slips on its way to the solution raises the residual now and then.
_MEMORY = 4
_SHORTEST = 1.0 / 16.0
#: The search along the energy accepts a step that leaves at most this share of the slope.
_SLOPE = 0.5
_PROBES = 8


#: What the line search looks at: the norm of the residual, or the work of the residual along the step.  Along the
#: energy it goes as far as that takes, and otherwise no further than the step itself.
Search = Literal["residual", "energy", "step"]


def bisect_work(now: Evaluation, step: ndarray, evaluate: Callable[[ndarray], Evaluation], farthest: float
                ) -> Evaluation:
    """Go along the step until the residual has lost half of its work along it, by doubling and bisection.

    The displacements come first among the unknowns; what follows them does no work.  At the farthest length more
    of the work may be left.
    """
    along = step[:len(now.residual)]
    slope = abs(now.residual @ along)
    least, best, length, shortest, longest = np.inf, now, 1.0, 0.0, np.inf
    for _ in range(_PROBES):
        new = evaluate(now.z + length * step)
        work = float(new.residual @ along) if np.isfinite(new.norm) else -np.inf
        if abs(work) < least:
            least, best = abs(work), new
        if abs(work) <= _SLOPE * slope or new.norm <= _SLOPE * now.norm or (work > 0.0 and length >= farthest):
            return new
        if work > 0.0:
            shortest = length
        else:
            longest = length
        length = 2.0 * length if np.isinf(longest) else 0.5 * (shortest + longest)
    return best


def unbalanced(new: Evaluation) -> float:
    """Norm of the unbalanced forces themselves, less round-off.

    The residual is relative to the largest forces of its own evaluation: where a step presses bodies into each
    other it is 1 however far they are pressed, and a line search by it lets everything pass.
    """
    whole = new.norm + new.hidden
    if whole == 0.0 or not np.isfinite(whole):
        return whole
    return new.size * new.norm / whole


def backtrack(now: Evaluation, step: ndarray, sizes: list[float], evaluate: Callable[[ndarray], Evaluation]
              ) -> Evaluation:
    """Halve the step while the residual is worse than all of the last few."""
    bound = np.inf if now.lag else max(sizes[-_MEMORY:])
    best = new = evaluate(now.z + step)
    length = 1.0
    while not unbalanced(new) <= bound and length > _SHORTEST:
        length *= 0.5
        new = evaluate(now.z + length * step)
        if unbalanced(new) < unbalanced(best) or np.isnan(best.norm):
            best = new
    return best
