"""Newton's method: evaluations, line searches, and iterations."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..checks import is_number
from ..errors import NoEquilibrium, NotConverged
from ..forms.base import Response
from ..forms.predicted_stress import PredictedStress
from ..solvers.direct import SingularSystem

logger = logging.getLogger("skfem_contact")
#: The tangent is damped when so many iterations have not halved the residual.
_PATIENCE = 6
#: Accelerated iterations begin when so many iterations have not halved the residual. A footing of
#: 98,304 dofs (phi 30, psi 5) takes 11 iterations in its second stage, and 29 with 4.
_SLOW = 5
#: So many iterations, all of them with so many times the smallest residual that has been reached,
#: lead nowhere.
_ASTRAY = 10
_TIMES = 2.0
#: With contact, so many without a smaller residual do, or so many with so many times the smallest
#: one: a strut prestressed against a wall in sand takes 15 to 24 iterations for 22 to 32. Soil
#: alone comes back from there.
_CYCLE = 8
_AWAY = 2
_MANY = 10.0
#: Residuals of more than so many times the forces are those of iterations that run away.
_AWAY_FROM_ALL = 1e8
#: Active sets of contact that return so many times, with a residual of more than this share of the
#: one that they had before, may do so for ever: points of a brittle bond open with it, and close
#: without it.
_RETURNS = 2
_NO_LESS = 0.9
#: Iterations that leave less than this share of the residual continue beyond their largest number:
#: they are few, and end in equilibrium. A footing of 285,660 dofs begins anew with a residual of
#: 4e-7 after 25 iterations otherwise.
_FALLS = 0.25
#: Along the energy, so many residuals that differ by so little and are so many times the smallest
#: one.
_STUCK = 6
_SAME = 0.8
_WORSE = 5.0
#: Round-off of the forces, as a share of the residual, that is mentioned where the iterations fail.
_NOISE = 0.1
#: Times as many iterations as asked for while the active set of contact is one that has not been
#: met: layers that lift off need 1 to 2 times as many, a point or two in each.
_MOVING = 4
#: Displacements of so many times the elastic ones are those of a collapse.
FAR = 100.0
#: The line search accepts what is not worse than the worst of this many last residuals: contact
#: that opens, closes and slips on its way to the solution raises the residual now and then.
_MEMORY = 4
_SHORTEST = 1.0 / 16.0
#: The search along the energy accepts a step that leaves at most this share of the slope.
_SLOPE = 0.5
_PROBES = 8
#: Share of the remaining lengths that interpolation of the work goes up, at least and at most.
_SHARES = 0.1, 0.5
#: Halvings of a full step that turns an element inside out, or changes strains of an elastic body
#: by more than this: rubber of very different stiffnesses found an equilibrium of four times the
#: force by such steps.
_HALVINGS = 4
_STRAIN = 0.5

#: Measure of a line search: the norm of the residual, or its work along the step. Along the energy
#: a search may go beyond the step, by its work alone ("step") no further. "either" takes what the
#: work or the norm admits. "full" takes every step: where a slender body bends, the residual rises
#: a thousand times in one step and falls in the next ones, which searches turn into 51 iterations
#: instead of 7.
Search = Literal["residual", "energy", "step", "either", "full"]


@dataclass(frozen=True)
class Newton:
    """Settings of Newton's method.

    Parameters
    ----------
    tolerance
        Norm of the residual over the largest norm among the load and the forms' forces.
    max_iterations
        Number of iterations after which the increment has failed. Iterations continue while each of
        them leaves less than a quarter of the smallest residual before. Along the energy,
        iterations that find a new active set of contact do not count, up to four times as many.

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
        if not (
            isinstance(self.max_iterations, (int, np.integer))
            and is_number(self.max_iterations, 0.0, np.inf)
        ):
            raise ValueError(
                f"max_iterations must be a whole number, at least 1, not {self.max_iterations!r}"
            )


@dataclass(frozen=True)
class Evaluation:
    """Responses of the forms to a vector of dofs.

    Attributes
    ----------
    z, responses
        Dofs, and the parameter of a search for a collapse; responses of the forms.
    residual : ndarray, shape (N,)
        Load less internal forces, zero at the fixed dofs.
    norm
        Norm of the residual over the largest norm among the load and the forms' forces, less
        `hidden`.
    lag
        Largest difference of the fixed dofs from the prescribed values.
    hidden
        Part of the norm that may be round-off.
    scale : ndarray, shape (N,)
        Factors of the equations, where there are several fields.
    predicted : ndarray, shape (N,)
        Residual with the stresses that the iterations predict, where they do.
    """

    z: ndarray
    responses: dict[str, Response]
    residual: ndarray
    norm: float
    lag: float = 0.0
    hidden: float = 0.0
    scale: ndarray | None = None
    predicted: ndarray | None = None

    @property
    def size(self) -> float:
        """Norm of the residual that line searches reduce, in scaled equations."""
        residual = self._searched
        return float(np.linalg.norm(residual if self.scale is None else self.scale * residual))

    @property
    def _searched(self) -> ndarray:
        return self.residual if self.predicted is None else self.predicted

    @cached_property
    def predictions(self) -> dict[str, PredictedStress]:
        """Stresses that the iterations predict, by form."""
        found = {name: response.prediction for name, response in self.responses.items()}
        return {name: each for name, each in found.items() if each is not None}

    def strained(self, now: Evaluation) -> float:
        """Return the largest change of a strain since another evaluation, where it is known."""
        changes = [p.strained(now.predictions[name]) for name, p in self.predictions.items()]
        return max(changes, default=0.0)

    def work(self, step: ndarray, now: Evaluation) -> float:
        """Return the work of the residual along a step that begins at another evaluation.

        Only the leading dofs, where the residual is, do work.
        """
        work = float(self._searched @ step[: len(self.residual)])
        for name, prediction in self.predictions.items():
            work -= prediction.work(now.predictions[name], step)
        return work

    @property
    def active(self) -> tuple[bytes, ...]:
        """Active sets of the forms."""
        return tuple(response.active for response in self.responses.values())

    @property
    def worst(self) -> int:
        """Dof of the largest unbalanced force."""
        return int(np.argmax(np.abs(self.residual)))

    @property
    def states(self) -> dict[str, Any]:
        """Candidate states."""
        return {name: response.state for name, response in self.responses.items()}


class Problem:
    """Equations that :func:`iterate` solves."""

    def evaluate(self, z: ndarray) -> Evaluation:
        """Return the evaluation at a vector of dofs."""
        raise NotImplementedError

    def along(self, now: Evaluation, step: ndarray, length: float) -> Evaluation:
        """Return the evaluation after a step of some length."""
        return self.evaluate(now.z + length * step)

    def direction(self, now: Evaluation, damped: bool) -> ndarray:
        """Return the Newton step at an evaluation, with the tangent or with the damped one."""
        raise NotImplementedError

    def accelerated(self, now: Evaluation, note: Callable[[Evaluation], None]) -> Evaluation:
        """Return the evaluation after accelerated iterations, each of which is noted."""
        return now

    def far(self, now: Evaluation) -> bool:
        """Return True if displacements along the energy are so large that they show a collapse."""
        return False

    def leaves(self, visited: list[ndarray]) -> bool:
        """Return True if forms know a way out of displacements that contact returns to."""
        return False

    def improved(self, new: Evaluation) -> Evaluation:
        """Return the evaluation after the first step, improved where forms know better."""
        return new


def bisect_work(now: Evaluation, step: ndarray, problem: Problem, farthest: float) -> Evaluation:
    """Double and bisect the step until the residual has lost half of its work along the step.

    At the farthest length more of the work may remain.
    """
    slope = abs(now.work(step, now))
    best = now
    least = np.inf  # smallest work so far
    length = 1.0
    shortest = 0.0
    longest = np.inf
    for _ in range(_PROBES):
        new = problem.along(now, step, length)
        work = -np.inf
        if np.isfinite(new.norm):
            work = new.work(step, now)
        if abs(work) < least:
            least = abs(work)
            best = new
        reduced = abs(work) <= _SLOPE * slope or new.norm <= _SLOPE * now.norm
        if reduced or (work > 0.0 and length >= farthest):
            return new
        if work > 0.0:
            shortest = length
        else:
            longest = length
        if np.isinf(longest):
            length = 2.0 * length
        else:
            length = 0.5 * (shortest + longest)
    return best


def unbalanced(new: Evaluation) -> float:
    """Return the norm of the unbalanced forces themselves, less round-off.

    The relative norm is no measure for a line search: where a step presses bodies into each other,
    it is 1 at any depth.
    """
    whole = new.norm + new.hidden
    if whole == 0.0 or not np.isfinite(whole):
        return whole
    return new.size * new.norm / whole


def _bound(now: Evaluation, sizes: list[float]) -> float:
    """Return the residual that a step may leave: the largest of the last few."""
    if now.lag:
        return np.inf
    return max(sizes[-_MEMORY:])


def backtrack(now: Evaluation, step: ndarray, sizes: list[float], problem: Problem) -> Evaluation:
    """Halve the step while the residual is worse than all of the last few."""
    bound = _bound(now, sizes)
    best = new = problem.along(now, step, 1.0)
    length = 1.0
    while not unbalanced(new) <= bound and length > _SHORTEST:
        length *= 0.5
        new = problem.along(now, step, length)
        if unbalanced(new) < unbalanced(best) or np.isnan(best.norm):
            best = new
    return best


def shorten(now: Evaluation, step: ndarray, sizes: list[float], problem: Problem) -> Evaluation:
    """Shorten the step until the residual has lost half of its work along the step, or of its norm.

    The lengths are interpolated. Instead of short steps that do neither, the longest one whose
    residual is no worse than all of the last few is taken: where soil yields next to contact, the
    norm alone admits steps far along a mechanism, and the work alone no progress near equilibrium.
    Ten times the last residuals are too far.
    """
    bound = _bound(now, sizes)
    slope = abs(now.work(step, now))
    lengths = _Lengths(now, slope)
    acceptable: Evaluation | None = None
    length = 1.0
    for _ in range(_PROBES):
        new = problem.along(now, step, length)
        work = _work(new, step, now, bound)

        # End at half of the work or of the norm, and where the whole step is too short.
        if abs(work) <= _SLOPE * slope or new.norm <= _SLOPE * now.norm:
            return new
        if work > 0.0 and length == 1.0:
            return new

        # Keep the longest step that is no worse, in place of very short ones.
        no_worse = work > -np.inf and unbalanced(new) <= bound
        if no_worse and acceptable is None:
            acceptable = new
        if acceptable is not None and length <= _SHORTEST:
            return acceptable
        length = lengths.after(length, work, new)
    return acceptable or lengths.best


def _work(new: Evaluation, step: ndarray, now: Evaluation, bound: float) -> float:
    """Return the work of a residual along a step; -inf where the residual is far too large."""
    if not np.isfinite(new.norm) or not unbalanced(new) <= _MANY * bound:
        return -np.inf
    return new.work(step, now)


class _Lengths:
    """Lengths of a step, between which the work of the residual changes its sign."""

    def __init__(self, now: Evaluation, slope: float) -> None:
        self.best = now  # evaluation with the least work so far
        self._least = np.inf
        self._short, self._above = 0.0, slope  # a length that is too short, and the work there
        self._long, self._below = 1.0, -np.inf  # a length that is too long, and the work there

    def after(self, length: float, work: float, new: Evaluation) -> float:
        """Return the next length, after an evaluation."""
        if abs(work) < self._least:
            self._least = abs(work)
            self.best = new
        if work > 0.0:
            self._short = length
            self._above = work
        else:
            self._long = length
            self._below = work
        share = float(np.clip(self._above / (self._above - self._below), *_SHARES))
        return self._short + share * (self._long - self._short)


def full_step(now: Evaluation, step: ndarray, problem: Problem) -> Evaluation:
    """Take the step, halved only where bodies have no response to it, or strain much in it."""
    for halvings in range(_HALVINGS):
        try:
            new = problem.along(now, step, 0.5**halvings)
        except NotConverged as error:
            logger.debug("step halved: %s", error)
            continue
        strained = new.strained(now)
        if strained <= _STRAIN:
            return new
        logger.debug("step halved: it changes strains by %.3g", strained)
    return problem.along(now, step, 0.5**_HALVINGS)


def _along(
    search: Search,
    now: Evaluation,
    step: ndarray,
    sizes: list[float],
    problem: Problem,
) -> Evaluation:
    """Return the evaluation that a line search accepts."""
    if search == "full":
        return full_step(now, step, problem)
    if search == "residual":
        return backtrack(now, step, sizes, problem)
    if search == "either":
        return shorten(now, step, sizes, problem)
    return bisect_work(now, step, problem, 1.0 if search == "step" else np.inf)


class _History:
    """Residuals, displacements and active sets of contact of the iterations so far."""

    def __init__(self, first: Evaluation, settings: Newton, search: Search) -> None:
        self._settings = settings
        self._search = search
        self.now = first
        self.firm = first  # the first iteration, or the last one that halved the smallest residual
        self.norms = [first.norm]
        self._recent = [first.norm]  # since the last accelerated iterations
        self.sizes = [unbalanced(first)]
        self._sets = [first.active]
        self._visited = [first.z]
        self._counted = 0
        self._returns = 0
        self._since = 0  # iteration from which on the active sets return

    @property
    def iterations(self) -> int:
        """Number of iterations."""
        return len(self.norms) - 1

    def add(self, new: Evaluation) -> None:
        """Record an iteration."""
        # along the energy new active sets do not count
        self._counted += self._search != "energy" or new.active in self._sets
        self._recent.append(new.norm)
        self.note(new)

    def note(self, new: Evaluation) -> None:
        """Record an iteration that does not count."""
        self.now = new
        self.norms.append(new.norm)
        self.sizes.append(unbalanced(new))
        self._sets.append(new.active)
        self._visited.append(new.z)
        if self.iterations == 1 or unbalanced(new) < 0.5 * unbalanced(self.firm):
            self.firm = new

    def restart(self, now: Evaluation) -> None:
        """Begin anew at an evaluation."""
        self.now = now
        self.sizes = [unbalanced(now)]
        self._recent = [now.norm]

    def check(self, problem: Problem) -> None:
        """End iterations that lead nowhere, or whose active sets go back and forth."""
        if self.ends():
            raise self.failure(f"no equilibrium after {self.iterations} iterations")
        cycle = self.cycle()
        if cycle and problem.leaves(cycle):
            raise self.failure("the active sets of contact return without progress", cycle)

    def ends(self) -> bool:
        """Return True if further iterations would lead nowhere."""
        if _too_many(self._recent, self._counted, self._settings.max_iterations):
            return True
        if not self.now.norm < _AWAY_FROM_ALL:
            return True
        if self._search == "energy":
            return _stuck(self._recent)
        return _hopeless(self._recent, any(self.now.active))

    def cycle(self) -> list[ndarray]:
        """Return the displacements between which the active sets go back and forth, if they do."""
        if self._search == "energy":
            return []
        back = _came_back(self._sets, self.norms)
        if not back:
            return []
        if self._returns:
            self._since = min(self._since, back)
        else:
            self._since = back
        self._returns += 1
        if self._returns >= _RETURNS:
            return self._visited[self._since :]
        return []

    def stagnates(self, iterations: int = _PATIENCE) -> bool:
        """Return True if the last iterations have not halved the residual."""
        if len(self._recent) <= iterations:
            return False
        return self.now.norm > 0.5 * self._recent[-1 - iterations]

    def failure(self, text: str, cycle: Sequence[ndarray] = ()) -> NotConverged:
        """Return the error of the last evaluation."""
        why = _why(self.now, self.norms)
        return NotConverged(f"{text}; {why}", self.now.z, self.norms, self.now.worst, cycle)

    def collapse(self) -> NoEquilibrium:
        """Return the error of displacements that grow without end."""
        why = _why(self.now, self.norms)
        return NoEquilibrium(
            f"collapse: after {self.iterations} iterations the displacements exceed {FAR:g} times "
            f"the elastic ones; {why}",
            self.now.z,
            self.norms,
            self.now.worst,
        )


def iterate(
    now: Evaluation,
    problem: Problem,
    settings: Newton,
    search: Search = "residual",
    at_least: int = 0,
    damp: bool = False,
) -> tuple[Evaluation, tuple[float, ...]]:
    """Iterate from an evaluation to equilibrium; return its evaluation and the residuals.

    The last residual is the whole one, round-off included.

    Parameters
    ----------
    now
        Evaluation to begin with.
    problem, settings, search
        The equations, settings of Newton's method, and the line search.
    at_least
        Number of iterations even if the residual is small from the start.
    damp
        Damp the tangent from the start, not only where the iterations make no progress.
    """
    history = _History(now, settings, search)
    damped = damp
    may_accelerate = search == "residual" and not damp
    while history.iterations < at_least or not (now.norm <= settings.tolerance and now.lag == 0.0):
        history.check(problem)

        # Take a step of a length that the line search accepts.
        now = _stepped(now, problem, search, history, damped)
        if history.iterations == 0:
            now = problem.improved(now)
        history.add(now)
        logger.debug("iteration %d: residual %.3e", history.iterations, now.norm)
        unsolved = now.norm > settings.tolerance
        if search == "energy" and unsolved and problem.far(now):
            raise history.collapse()

        # Accelerate once where the tangent leads nowhere.
        if may_accelerate and unsolved and history.stagnates(_SLOW):
            may_accelerate = False
            now = _accelerated(now, problem, history)
        damped = damp or history.stagnates()
    return now, (*history.norms[:-1], now.norm + now.hidden)


def _stepped(
    now: Evaluation,
    problem: Problem,
    search: Search,
    history: _History,
    damped: bool,
) -> Evaluation:
    """Return the evaluation after one step; an error has the last evaluation."""
    try:
        step = problem.direction(now, damped)
        new = _along(search, now, step, history.sizes, problem)
    except SingularSystem as error:
        raise NotConverged(str(error), now.z, history.norms, int(error.dofs[0])) from error
    except NotConverged as error:  # no response there
        cause = error.__cause__ or error
        raise NotConverged(str(error), now.z, history.norms, now.worst) from cause
    if not np.isfinite(new.norm):
        raise history.failure("the iterations run away")
    return new


def _accelerated(now: Evaluation, problem: Problem, history: _History) -> Evaluation:
    """Return the evaluation that accelerated iterations reach, or the present one."""
    made = history.iterations
    nearer = problem.accelerated(history.firm, history.note)
    if history.iterations == made:
        return now
    history.restart(nearer)
    return nearer


def _too_many(norms: list[float], counted: int, most: int) -> bool:
    """Return True if all iterations are made and the last one has not come much closer."""
    made = max(counted, (len(norms) - 1) / _MOVING)
    return made >= most and norms[-1] > _FALLS * min(norms[:-1])


def _came_back(sets: list[tuple[bytes, ...]], norms: list[float]) -> int:
    """Return the last iteration with the present active sets and no larger residual, or 0.

    Iterations with other active sets must have followed it.
    """
    for k in range(len(sets) - 3, 0, -1):
        returned = sets[k] == sets[-1] and sets[-1] != sets[k + 1]
        if returned and norms[-1] > _NO_LESS * norms[k]:
            return k
    return 0


def _hopeless(norms: list[float], contact: bool) -> bool:
    """Return True if the iterations have run away.

    The first residual is the one of the increment and does not count.
    """
    least = min(norms[1:], default=np.inf)
    limits = [(_ASTRAY, _TIMES)]
    if contact:
        limits = [(_CYCLE, 1.0), (_AWAY, _MANY)]
    for last, times in limits:
        if len(norms) > last + 1 and min(norms[-last:]) > times * least:
            return True
    return False


def _stuck(norms: list[float]) -> bool:
    """Return True if the residual has hardly changed for long, and was much smaller before.

    A collapse shows in fewer iterations, since the steps towards it are doubled again and again.
    """
    if len(norms) <= _STUCK:
        return False
    last = norms[-_STUCK:]
    return min(last) > max(_WORSE * min(norms[1:]), _SAME * max(last))


def _why(now: Evaluation, norms: list[float]) -> str:
    """Describe residual and largest unbalanced force for a message."""
    worst = now.worst
    names = [name for name, r in now.responses.items() if r.force[worst] != 0.0]
    history = ", ".join(f"{v:.1e}" for v in norms[-5:])
    text = (
        f"the residual went {history}; the largest unbalanced force, {now.residual[worst]:.3g}, "
        f"acts on dof {worst} of {names}"
    )
    round_off = sum(float(np.linalg.norm(r.round_off)) for r in now.responses.values())
    if round_off > _NOISE * now.size:
        text += (
            f"; round-off alone may leave {round_off:.1e}: the displacements are lost in the "
            "coordinates"
        )
    return text
