"""Newton's iterations with a line search; they tell a stall from a collapse."""
from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy import ndarray

from ..checks import is_number
from ..errors import NoEquilibrium, NotConverged
from ..solvers.direct import SingularSystem
from .evaluation import Evaluation
from .line_search import Search, backtrack, bisect_work, unbalanced

logger = logging.getLogger("skfem_contact")
#: The tangent is damped when so many iterations have not halved the residual.
_PATIENCE = 6
#: So many iterations, all of them with so many times the smallest residual that has been reached, lead nowhere.
_ASTRAY, _TIMES = 10, 2.0
#: Along the energy, so many residuals that differ by so little and are so many times the smallest one.
_STUCK, _SAME, _WORSE = 6, 0.8, 5.0
#: Round-off of the forces, as a share of the residual, that is mentioned where the iterations fail.
_NOISE = 0.1
#: Times as many iterations as asked for while the active set of contact is one that has not been met: layers that lift
#: off need 1 to 2 times as many, a point or two in each.
_MOVING = 4
#: Displacements of so many times the elastic ones are those of a collapse.
FAR = 100.0


@dataclass(frozen=True)
class Newton:
    """Settings of Newton's method.

    Parameters
    ----------
    tolerance
        Norm of the residual over the largest norm among the load and the forms' forces.
    max_iterations
        After so many iterations the increment has failed; along the energy those do not count that find an active set
        of contact that is new, up to four times as many.

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
        if not is_number(self.tolerance, 0.0, np.inf):
            raise ValueError(f"tolerance must be positive, not {self.tolerance!r}")
        if not (isinstance(self.max_iterations, (int, np.integer)) and is_number(self.max_iterations, 0.0, np.inf)):
            raise ValueError(f"max_iterations must be a whole number, at least 1, not {self.max_iterations!r}")


def iterate(now: Evaluation, evaluate: Callable[[ndarray], Evaluation],
            direction: Callable[[Evaluation, bool], ndarray],
            settings: Newton, search: Search = "residual", far: Callable[[Evaluation], bool] = lambda now: False,
            at_least: int = 0, damp: bool = False) -> tuple[Evaluation, tuple[float, ...]]:
    """Newton's iterations: from an evaluation to one without residual, and the history of the residual.

    The last figure of the history is the whole residual, with what may be round-off.

    Parameters
    ----------
    direction
        Newton step at an evaluation, with the tangent or with the damped one.
    far
        Whether one is so far away that the search along the energy shows a collapse.
    at_least
        Number of iterations even if the residual is small from the start.
    damp
        Damp the tangent from the start, not only where the iterations make no progress.
    """
    norms, sizes, damped = [now.norm], [unbalanced(now)], damp
    met, counted = {now.active}, 0
    while len(norms) <= at_least or not (now.norm <= settings.tolerance and now.lag == 0.0):
        if max(counted, (len(norms) - 1) / _MOVING) >= settings.max_iterations or not now.norm < 1e8 \
                or (_stuck(norms) if search == "energy" else _hopeless(norms)):
            raise NotConverged(f"no equilibrium after {len(norms) - 1} iterations; {_why(now, norms)}",
                               now.z, norms, now.worst)
        try:
            step = direction(now, damped)
            new = backtrack(now, step, sizes, evaluate) if search == "residual" else \
                bisect_work(now, step, evaluate, 1.0 if search == "step" else np.inf)
        except SingularSystem as error:
            raise NotConverged(str(error), now.z, norms,
                               int(error.dofs[0])) from error
        except NotConverged as error:  # no answer there: say where the last one was
            raise NotConverged(str(error), now.z, norms, now.worst) from error
        if not np.isfinite(new.norm):
            raise NotConverged(f"the iterations run away; {_why(now, norms)}", now.z, norms, now.worst)
        now = new
        norms.append(now.norm)
        counted += search != "energy" or now.active in met
        met.add(now.active)
        sizes.append(unbalanced(now))
        logger.debug("iteration %d: residual %.3e", len(norms) - 1, now.norm)
        if search == "energy" and now.norm > settings.tolerance and far(now):
            raise NoEquilibrium(f"collapse: after {len(norms) - 1} iterations the displacements exceed {FAR:g} times "
                                f"the elastic ones; {_why(now, norms)}", now.z, norms, now.worst)
        stagnates = len(norms) > _PATIENCE and now.norm > 0.5 * norms[-1 - _PATIENCE]
        damped = damp or stagnates
    return now, (*norms[:-1], now.norm + now.hidden)


def _hopeless(norms: list[float]) -> bool:
    """Whether the iterations have run away; the first residual is that of the increment and says nothing of them.

    Along the energy this is not asked: there it may be the way to a collapse.  See :func:`_stuck`.
    """
    least = min(norms[1:], default=np.inf)
    return len(norms) > _ASTRAY and min(norms[-_ASTRAY:]) > _TIMES * least


def _stuck(norms: list[float]) -> bool:
    """Whether the residual has hardly changed for long, and was much smaller before.

    A collapse shows in fewer iterations, for the steps towards it are doubled again and again.
    """
    last = norms[-_STUCK:]
    return len(norms) > _STUCK and min(last) > max(_WORSE * min(norms[1:]), _SAME * max(last))


def _why(now: Evaluation, norms: list[float]) -> str:
    """Where the iterations stand, for a message."""
    worst = now.worst
    names = [k for k, r in now.responses.items() if r.force[worst] != 0.0]
    history = ", ".join(f"{v:.1e}" for v in norms[-5:])
    round_off = sum(r.round_off for r in now.responses.values())
    noise = f"; round-off alone may leave {round_off:.1e}: the displacements are lost in the coordinates" \
        if round_off > _NOISE * now.size else ""
    return (f"the residual went {history}; the largest unbalanced force, {now.residual[worst]:.3g}, acts on "
            f"unknown {worst} of {names}{noise}")
