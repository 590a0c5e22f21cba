"""Increments of a stage along its path of equilibria, whose load may fall and rise."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator

import numpy as np
from numpy import ndarray

from ..errors import NotConverged
from ..forms.roles import Touching, having
from ..nonlinear.arc_length import Arc, OnPath
from ..nonlinear.increment import Path, solve_increment
from ..nonlinear.newton import Newton
from ..nonlinear.step import Equilibrium, Step
from ..nonlinear.system import System
from ..results.stage import StageResult

logger = logging.getLogger("skfem_contact")

#: Increments of a path that does not come to its load.
_MOST = 2000
#: Cuts of an increment in a row after which the path ends.
_CUTS = 12
#: Iterations of an increment after which the next one is as long.
_WANTED = 5
#: Growth of a length, and change of the share over the one asked for, at most.
_GROWTH = 2.0
_TOO_MUCH = 1.5
#: Cosine of the turn of a path in an increment, at least: a sharper one may be another path.
_STRAIGHT = 0.9
#: Cuts in a row after which a path of bodies in contact is tried with the tangent to more load (1)
#: and to less (-1), ever shorter: it has a kink where contact closes or opens. A truss that leaves
#: hard ground snaps back by a fifth of the load along the whole tangent, by .07 along half of it.
_KINKS = dict(enumerate((1.0, -1.0, 0.5, -0.5, 0.25, -0.25, 0.125, -0.125), start=6))

#: Function that returns the result of an increment: last result, step, equilibrium, and share.
Accept = Callable[[StageResult, Step, Equilibrium, float], StageResult]


def along_path(
    where: object,
    system: System,
    path: Path,
    increments: int,
    last: StageResult,
    newton: Newton,
    accept: Accept,
    onward: ndarray | None,
) -> Iterator[StageResult]:
    """Yield the accepted increments of a path, until it first reaches its whole load.

    Lengths follow the iterations; no increment changes the load by much more than the share asked
    for.

    Parameters
    ----------
    where
        Stage, for messages.
    increments
        Number of increments without limit points.
    last
        Start of the stage.
    onward : ndarray, shape (N,), optional
        Way of the last increment of a path that ended before its load and continues here.

    Raises
    ------
    ValueError
        Neither loads nor supports change.
    NotConverged
        The path ends, or does not come to its load.
    """
    if all(np.array_equal(a, b) for a, b in zip(path(0.0), path(1.0), strict=True)):
        raise ValueError(
            f"{where} changes neither loads nor supports and has no path: leave out arc_length"
        )
    largest = 1.0 / increments
    share = 0.0
    ahead: ndarray | None = None
    scale = 1.0
    cuts = 0
    kinks = _KINKS if having(system.forms, Touching) else {}
    for _ in range(_MOST):
        # Take the tangent at first, then the last increment, as far as the load allows.
        arc = Arc(system, path, last.x, last.states, share)
        kink = kinks.get(cuts)
        try:
            if ahead is None:
                ahead = _first(arc, largest, onward)
            step, cosine = _expected(arc, scale * ahead, largest, kink)
            new, ends = _next(arc, step, newton, largest)
            _check_turn(arc, new, ahead, cosine)
        except NotConverged as error:
            logger.info("%s: along the path from %.4f: %s", where, share, error)
            if kink is None:
                scale *= 0.5
            cuts += 1
            if cuts > _CUTS + len(kinks):
                raise NotConverged(
                    f"{where} stopped at {share:.2%} of its load along its path: {error}", last.x
                ) from error
            continue

        # Accept it, and choose the next length.
        found = new.found
        cuts = 0
        ahead = np.append(found.x - last.x, new.share - share)
        iterations = max(found.iterations / found.equilibria, 1.0)
        scale = float(np.clip(np.sqrt(_WANTED / iterations), 0.5, _GROWTH))
        share = 1.0 if ends else new.share
        load, prescribed = path(share)
        taken = Step(system, last.x, last.states, load, prescribed)
        last = accept(last, taken, found, share)
        yield last
        if ends:
            return
    raise NotConverged(
        f"{where} has not reached its load in {_MOST} increments along its path, the last one at "
        f"{share:.2%}: give another load, or fewer and longer increments",
        last.x,
    )


def _first(arc: Arc, largest: float, onward: ndarray | None) -> ndarray:
    """Return the tangent at the start, (N + 1,), to more load, or onward along a path."""
    ahead = arc.tangent(largest)
    if onward is not None and ahead[:-1] @ onward < 0.0:
        return -ahead
    return ahead


def _expected(
    arc: Arc, ahead: ndarray, largest: float, kink: float | None
) -> tuple[ndarray, float]:
    """Return the expected change, (N + 1,), as far as the load allows, and the least cosine.

    Where contact has changed, the path has a kink, and a tangent to more or less load.
    """
    least = _STRAIGHT
    if kink is not None:
        ahead = arc.tangent(kink * largest)
        least = -_STRAIGHT
    return ahead * min(1.0, largest / max(abs(ahead[-1]), 1e-300)), least


def _next(arc: Arc, ahead: ndarray, newton: Newton, largest: float) -> tuple[OnPath, bool]:
    """Return the next equilibrium on a path, and True where it has the whole load.

    Raises
    ------
    NotConverged
        None was found, or one that is too far from the last.
    """
    new = arc.solve(ahead, newton)
    moved = np.append(new.found.x - arc.x, new.share - arc.share)
    if abs(moved[-1]) > _TOO_MUCH * largest:
        raise NotConverged(f"the load changes by {moved[-1]:.2%} at once", arc.x)
    if new.share < 1.0 or arc.share >= 1.0:
        return new, False

    # End with the whole load, between the last two equilibria.
    part = (1.0 - arc.share) / moved[-1]
    load, prescribed = arc.path(1.0)
    start = arc.x + part * moved[:-1]
    start[arc.system.fixed] = prescribed
    step = Step(arc.system, arc.x, arc.states, load, prescribed, start)
    found = solve_increment(step, newton, try_recovery=False)
    if np.linalg.norm(found.x - start) > np.linalg.norm(moved[:-1]):
        raise NotConverged("the equilibrium under the whole load is one of another path", found.x)
    return OnPath(found, 1.0), True


def _check_turn(arc: Arc, new: OnPath, ahead: ndarray, least: float) -> None:
    """Refuse an increment that turns from the expected way by more than a cosine allows."""
    moves = arc.system.layout.displacements
    expected = ahead[:-1][moves]
    found = (new.found.x - arc.x)[moves]
    cosine = expected @ found / (np.linalg.norm(expected) * np.linalg.norm(found))
    if not cosine > least:
        raise NotConverged("the path turns sharply", arc.x)
