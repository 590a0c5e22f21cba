"""Newton's iterations with a line search; they tell a stall from a collapse."""
from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..assembly import Response
from .linear import SingularSystem

logger = logging.getLogger("skfem_contact")

#: The line search accepts what is not worse than the worst of this many last residuals: contact that opens,
#: closes and slips on its way to the solution raises the residual now and then.
_MEMORY = 4
_SHORTEST = 1.0 / 16.0
#: The search along the energy accepts a step that leaves at most this share of the slope.
_SLOPE = 0.5
_PROBES = 8
#: The tangent is damped when so many iterations have not halved the residual.
_PATIENCE = 6
#: So many iterations, all of them with twice the smallest residual that has been reached, lead nowhere; neither do
#: so many with forces that have lost any relation to the load.
_ASTRAY, _LOST = 10, 3
_TIMES, _NOTHING, _HALF = 2.0, 0.95, 0.5
#: Along the energy, so many residuals that differ by so little and are so many times the smallest one.
_STUCK, _SAME, _WORSE = 6, 0.8, 5.0
#: Displacements of so many times the elastic ones are those of a collapse.
FAR = 100.0

#: What the line search looks at: the norm of the residual, or the work of the residual along the step.  Along the
#: energy it goes as far as that takes, and otherwise no further than the step itself.
Search = Literal["residual", "energy", "step"]


class NotConverged(RuntimeError):
    """Newton's method found no equilibrium; whether there is one remains open.

    Attributes
    ----------
    result
        The stages and increments that were accepted before, as far as they came.
    x
        The displacements that were reached, (N,).
    residuals
        History of the residual.
    unknown
        Where the largest unbalanced force acts, or the first unknown that can move freely.
    """

    result: Any = None

    def __init__(self, message: str, x: ndarray | None = None, residuals: Sequence[float] = (),
                 unknown: int | None = None) -> None:
        super().__init__(message)
        self.x, self.residuals, self.unknown = x, tuple(residuals), unknown


class Collapse(NotConverged):
    """The bodies collapse under this load: they move on and on, and the load does more work than they resist.

    With associated flow the residual is the gradient of a convex potential.  A line search along this energy
    finds its minimum if there is one; where there is none, which is what collapse means, it runs away along the
    mechanism.  A hundred times the elastic displacements are taken for that.  With friction and
    non-associated flow there is no potential, but the mechanism is found in the same way.
    """


@dataclass(frozen=True)
class Newton:
    """Settings of Newton's method.

    Parameters
    ----------
    tolerance
        Norm of the residual over the largest norm among the load and the forms' forces.
    max_iterations
        After so many iterations the increment has failed.

    Raises
    ------
    ValueError
        A tolerance that is not positive, or no iteration.

    Examples
    --------
    >>> from skfem_contact import Newton
    >>> Newton(tolerance=1e-10).max_iterations
    25
    """

    tolerance: float = 1e-8
    max_iterations: int = 25

    def __post_init__(self) -> None:
        if not 0 < self.tolerance < np.inf:
            raise ValueError(f"tolerance must be positive, not {self.tolerance!r}")
        if self.max_iterations < 1:
            raise ValueError(f"max_iterations must be at least 1, not {self.max_iterations!r}")


@dataclass(frozen=True)
class Trial:
    """What the forms answer to a vector of unknowns.

    Attributes
    ----------
    z
        Unknowns: displacements, and whatever else is sought.
    responses
        Answers of the forms.
    residual
        Load less internal forces, zero at the fixed unknowns, (N,).
    norm
        Its norm, relative to the largest norm among the load and the forms' forces, without what is hidden.
    lag
        How much the unknowns differ from what is prescribed.
    hidden
        Part that the norm leaves out because it may be round-off.
    """

    z: ndarray
    responses: dict[str, Response]
    residual: ndarray
    norm: float
    lag: float = 0.0
    hidden: float = 0.0

    @property
    def worst(self) -> int:
        """Unknown with the largest unbalanced force."""
        return int(np.argmax(np.abs(self.residual)))

    @property
    def states(self) -> dict[str, Any]:
        """Candidate states."""
        return {name: response.state for name, response in self.responses.items()}


def iterate(now: Trial, evaluate: Callable[[ndarray], Trial], direction: Callable[[Trial, bool], ndarray],
            settings: Newton, search: Search = "residual", far: Callable[[Trial], bool] = lambda trial: False,
            at_least: int = 0, damp: bool = False) -> tuple[Trial, tuple[float, ...]]:
    """Newton's iterations: from a trial to one without residual, and the history of the residual.

    The last figure of the history is the whole residual, with what may be round-off.

    Parameters
    ----------
    now
        Where to start.
    evaluate
        Trial at some unknowns.
    direction
        Newton step at a trial, with the tangent or with the damped one.
    settings
        Tolerance and number of iterations.
    search
        Line search.
    far
        Whether a trial is so far away that the search along the energy shows a collapse.
    at_least
        Number of iterations even if the residual is small from the start.
    damp
        Damp the tangent from the start, not only where the iterations make no progress.

    Raises
    ------
    Collapse, NotConverged
        There is no solution; none was found.
    """
    norms, sizes, damped = [now.norm], [_size(now)], damp
    while len(norms) <= at_least or not (now.norm <= settings.tolerance and now.lag == 0.0):
        if len(norms) > settings.max_iterations or not now.norm < 1e8 \
                or (_stuck(norms) if search == "energy" else _hopeless(norms)):
            raise NotConverged(f"no equilibrium after {len(norms) - 1} iterations; {_why(now, norms)}",
                               now.z, norms, now.worst)
        try:
            step = direction(now, damped)
            new = _search(now, step, sizes, evaluate) if search == "residual" else \
                _along(now, step, evaluate, 1.0 if search == "step" else np.inf)
        except SingularSystem as error:
            raise NotConverged(str(error), now.z, norms,
                               int(error.unknowns[0])) from error
        except NotConverged as error:  # no answer at the trial: say where the last one was
            raise NotConverged(str(error), now.z, norms, now.worst) from error
        if not np.isfinite(new.norm):
            raise NotConverged(f"the iterations run away; {_why(now, norms)}", now.z, norms, now.worst)
        now = new
        norms.append(now.norm)
        sizes.append(_size(now))
        logger.debug("iteration %d: residual %.3e", len(norms) - 1, now.norm)
        if search == "energy" and now.norm > settings.tolerance and far(now):
            raise Collapse(f"collapse: after {len(norms) - 1} iterations the displacements exceed {FAR:g} times the "
                           f"elastic ones; {_why(now, norms)}", now.z, norms, now.worst)
        stagnates = len(norms) > _PATIENCE and now.norm > 0.5 * norms[-1 - _PATIENCE]
        damped = damp or stagnates
    return now, (*norms[:-1], now.norm + now.hidden)


def _hopeless(norms: list[float]) -> bool:
    """Whether the iterations have run away; the first residual is that of the increment and says nothing of them.

    Along the energy this is not asked: there it may be the way to a collapse.  See :func:`_stuck`.
    """
    least = min(norms[1:], default=np.inf)
    astray = len(norms) > _ASTRAY and min(norms[-_ASTRAY:]) > _TIMES * least
    return astray or (len(norms) > _LOST and min(norms[-_LOST:]) > _NOTHING and least < _HALF)


def _stuck(norms: list[float]) -> bool:
    """Whether the residual has hardly changed for long, and was much smaller before.

    A collapse shows in fewer iterations, for the steps towards it are doubled again and again.
    """
    last = norms[-_STUCK:]
    return len(norms) > _STUCK and min(last) > max(_WORSE * min(norms[1:]), _SAME * max(last))


def _along(now: Trial, step: ndarray, evaluate: Callable[[ndarray], Trial], farthest: float) -> Trial:
    """Go along the step until the residual has lost half of its work along it, by doubling and bisection.

    The displacements come first among the unknowns; what follows them does no work.  At the farthest length more
    of the work may be left.
    """
    along = step[:len(now.residual)]
    slope = abs(now.residual @ along)
    least, best, length, shortest, longest = np.inf, now, 1.0, 0.0, np.inf
    for _ in range(_PROBES):
        trial = evaluate(now.z + length * step)
        work = float(trial.residual @ along) if np.isfinite(trial.norm) else -np.inf
        if abs(work) < least:
            least, best = abs(work), trial
        if abs(work) <= _SLOPE * slope or trial.norm <= _SLOPE * now.norm or (work > 0.0 and length >= farthest):
            return trial
        if work > 0.0:
            shortest = length
        else:
            longest = length
        length = 2.0 * length if np.isinf(longest) else 0.5 * (shortest + longest)
    return best


def _size(trial: Trial) -> float:
    """Norm of the unbalanced forces themselves, less round-off.

    The residual is relative to the largest forces of its own trial: where a step presses bodies into each other it is
    1 however far they are pressed, and a line search by it lets everything pass.
    """
    whole = trial.norm + trial.hidden
    if whole == 0.0 or not np.isfinite(whole):
        return whole
    return float(np.linalg.norm(trial.residual)) * trial.norm / whole


def _search(now: Trial, step: ndarray, sizes: list[float], evaluate: Callable[[ndarray], Trial]) -> Trial:
    """Halve the step while the residual is worse than all of the last few."""
    bound = np.inf if now.lag else max(sizes[-_MEMORY:])
    best = trial = evaluate(now.z + step)
    length = 1.0
    while not _size(trial) <= bound and length > _SHORTEST:
        length *= 0.5
        trial = evaluate(now.z + length * step)
        if _size(trial) < _size(best) or np.isnan(best.norm):
            best = trial
    return best


def _why(now: Trial, norms: list[float]) -> str:
    worst = now.worst
    names = [k for k, r in now.responses.items() if r.force[worst] != 0.0]
    history = ", ".join(f"{v:.1e}" for v in norms[-5:])
    return (f"the residual went {history}; the largest unbalanced force, {now.residual[worst]:.3g}, acts on "
            f"unknown {worst} of {names}")
