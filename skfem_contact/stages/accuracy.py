"""Errors of increments in soil whose stiffness depends on stress, estimated from parts of them.

Stresses follow from the strain of an increment by Euler's backward method, of first order, and
strains change in proportion within it. At some points increments are done again in three parts of
their change of stress or, where supports move, of the strain along this change. That changes two
thirds of the error. The estimate is 0.35 to 1.7 times the true error, where this exceeds 3 %, of
displacements under loads and of loads at supports that move: triaxial tests, layers that are loaded
and unloaded, footings and pits, in one to ten increments. It is a tenth to a half of the error
under footings without drainage, where stresses are redistributed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray

from ..arrays import row_norms
from ..errors import InadmissibleStress, IncrementTooLarge, Remark
from ..forms.roles import Body, having
from ..laboratory.specimen import elasticity_at, tangent_at
from ..materials import Material
from ..materials.base import updated
from ..results.stage import StageResult

#: Points that stand for a region, chosen by their work in the first increment: 64 and 128 change
#: estimates by a tenth.
_POINTS = 32
#: Parts of an increment: with two the first may be elastic, and the second then ends where one part
#: does.
PARTS = 3
#: Stiffness of the ground around a point as a share of its elastic one: it keeps strains finite
#: where points fail.
_AROUND = 0.01
#: Iterations, of which 2 to 8 are needed; unbalanced stress as a share of its largest change. No
#: step is longer than this share of the largest increment.
_MOST = 10
_BALANCED = 1e-3
_LONGEST = 0.5
#: Error that is remarked on, and the largest that is given as a figure.
_ERROR = 0.05
_LARGE = 1.0
#: Share of the largest strain below which strains count as held, as in a layer.
_HELD = 1e-6


class Point(NamedTuple):
    """State at points: strain, stress and internal variables, (ncomp, n), and time."""

    strain: ndarray
    stress: ndarray
    memory: ndarray
    time: float


class Sample(NamedTuple):
    """Points of a region by their indices, with their share of its volume, and their states."""

    material: Material
    indices: ndarray
    weight: ndarray
    states: list[Point]

    def work(self, begin: int, end: int) -> ndarray:
        """Return the work of the change of stress between two states, (n,)."""
        old = self.states[begin]
        new = self.states[end]
        density = (new.stress - old.stress) * (new.strain - old.strain)
        return self.weight * density.sum(axis=0)


class Parts:
    """Accepted increments of a stage, to be followed in parts.

    `driven` is true where supports move.
    """

    def __init__(self, driven: bool) -> None:
        self._driven = driven
        self._samples: dict[str, dict[str, Sample]] = {}

    def add(self, before: StageResult, after: StageResult) -> None:
        """Record an accepted increment."""
        for name, form in having(after.forms, Body).items():
            timed = after.time > before.time
            if not any(_counts(material, timed) for material in form.materials.values()):
                continue
            old = before.states[name]
            new = after.states[name]
            if not self._samples.get(name):  # nothing has moved so far
                self._samples[name] = chosen(form, old, new)
                record(self._samples[name], form, old, before.time)
            record(self._samples[name], form, new, after.time)

    def remarks(self, name: str) -> Iterator[Remark]:
        """Yield a remark on the estimated error of a body.

        The error of all increments is estimated where the error of the largest one is large.
        """
        samples = list(self._samples.get(name, {}).values())
        if not samples:
            return
        last = len(samples[0].states) - 1
        works = []
        for k in range(last):
            works.append(sum(np.abs(sample.work(k, k + 1)).sum() for sample in samples))
        largest = int(np.argmax(works))
        try:
            with np.errstate(all="ignore"):  # at points that fail, which do not count
                error = _error(samples, largest, largest + 1, self._driven)
                if error > _ERROR and last > 1:
                    error = _error(samples, 0, last, self._driven)
        except (IncrementTooLarge, InadmissibleStress, np.linalg.LinAlgError):
            return  # parts without an equilibrium
        if error > _ERROR:
            if error < _LARGE:
                size = f"about {error:.0%}"
            else:
                size = f"more than {_LARGE:.0%}"
            what = "displacements"
            if self._driven:
                what = "forces at the moved supports"
            yield Remark(
                "increments",
                error,
                f"{what} are off by {size}, as estimated from parts of the {last} increments: "
                "stiffness and strains change much within them; give the stage more `increments`",
            )


def _counts(material: Material, timed: bool) -> bool:
    """Return True if increments of a material have errors; steps of creep are short enough."""
    if material.hyperelastic:
        return False
    return material.stress_dependent and not (timed and material.time_dependent)


def chosen(form: Any, old: Any, new: Any, creeping: bool = False) -> dict[str, Sample]:
    """Return samples of the regions, with points in proportion to their work in an increment.

    Of bodies that creep it is the work of the sizes of stress and strain, in regions that do.
    """
    # Weigh each point by its share of the work.
    stress = new.stress - old.stress
    strain = new.strain - old.strain
    if creeping:
        size = np.linalg.norm(stress, axis=0)
        work = form.weight * size * np.linalg.norm(strain, axis=0)
    else:
        work = np.abs(form.weight * (stress * strain).sum(axis=0))
    samples = {}
    for region in form.regions:
        own = work[region.elements].ravel()
        sums = np.cumsum(own)
        counts = region.material.stress_dependent
        if creeping:
            counts = region.material.time_dependent
        if counts and sums[-1] > 0.0:
            # Take points at equal shares of the work.
            marks = (np.arange(_POINTS) + 0.5) / _POINTS * sums[-1]
            indices, count = np.unique(np.searchsorted(sums, marks), return_counts=True)
            share = count * sums[-1] / _POINTS / own[indices]
            weight = share * form.weight[region.elements].ravel()[indices]
            samples[region.name] = Sample(region.material, indices, weight, [])
    return samples


def record(samples: dict[str, Sample], form: Any, state: Any, time: float) -> None:
    """Add a state of a body to its samples."""
    for region, stress, memory in form.at_regions(state):
        sample = samples.get(region.name)
        if sample is not None:
            # Take strain, stress and memory at the chosen points.
            n = stress[0].size
            strain = state.strain[:, region.elements].reshape(-1, n)[:, sample.indices]
            at_points = stress.reshape(-1, n)[:, sample.indices]
            inner = memory.reshape(len(memory), n)[:, sample.indices]
            sample.states.append(Point(strain, at_points, inner, time))


def _error(samples: Sequence[Sample], begin: int, end: int, driven: bool) -> float:
    """Return the estimated error of increments between two states, as a share of the change."""
    # Repeat the increments in parts, and compare what they end at.
    total = 0.0
    more = 0.0
    for sample in samples:
        old = sample.states[begin]
        new = sample.states[end]
        states = sample.states[begin : end + 1]
        # Follow the points again in smaller parts; the work of the difference is the error.
        strain, stress, solved = followed(sample.material, states, driven)
        if driven:
            lost = (stress - new.stress) * (new.strain - old.strain)
        else:
            lost = (new.strain - strain) * (new.stress - old.stress)
        # Parts that are PARTS times finer err PARTS times less.
        total += sample.work(begin, end)[solved].sum()
        of_points = sample.weight * lost.sum(axis=0)
        more += PARTS / (PARTS - 1.0) * of_points[solved].sum()
    if total:
        return abs(more / total)
    return 0.0


def followed(
    material: Material, states: Sequence[Point], driven: bool
) -> tuple[ndarray, ndarray, ndarray]:
    """Return strain and stress after parts of increments, and where they are in equilibrium."""
    # Find the components that change.
    strains = [state.strain for state in states]
    changes = np.abs(np.diff(strains, axis=0)).max(axis=(0, 2))
    rows = np.flatnonzero(changes > _HELD * changes.max())
    sizes = _sizes(strains), _sizes([state.stress for state in states])
    now = states[0]
    solved = np.ones(now.strain.shape[1], bool)
    # Follow each increment in parts, by strains or by stresses.
    for old, new in pairwise(states):
        base = old.stress
        if driven:
            base = now.stress
        for share in (np.arange(PARTS) + 1.0) / PARTS:
            strain = old.strain + share * (new.strain - old.strain)
            time = old.time + share * (new.time - old.time)
            goal = Point(strain, base, now.memory, time)
            part = _Part(goal, new.stress - old.stress, share, driven)
            now, balanced = _solve(material, now, part, rows, sizes)
            solved &= balanced
    return now.strain, now.stress, solved


def _sizes(values: Sequence[ndarray]) -> ndarray:
    """Return the sizes of the largest changes, (n,)."""
    steps = np.diff(values, axis=0)
    return row_norms(steps).max(axis=0)


class _Part(NamedTuple):
    """Part of an increment: its goal, the change of stress of the increment, and its share.

    Where supports are driven the strain along the change is known, else the share.
    """

    goal: Point
    change: ndarray
    share: float
    driven: bool


def _solve(
    material: Material,
    now: Point,
    part: _Part,
    rows: ndarray,
    sizes: tuple[ndarray, ndarray],
) -> tuple[Point, ndarray]:
    """Return the state after a part of an increment, and where it is in equilibrium.

    The dofs z are the strains of some rows and the share a of the change of stress, with
    sigma(z) = sigma_goal + a dsigma. Newton's method halves its step where the residual has not
    fallen.
    """
    # Solve for the free strains, and for the share of the change of stress.
    goal = part.goal
    n = part.change.shape[1]
    target = part.change[rows].T
    elastic = elasticity_at(material, now.stress, now.memory)
    around = _AROUND * elastic[:, rows[:, None], rows]  # (n, rows, rows)
    known = np.column_stack((goal.strain[rows].T, np.full(n, part.share)))

    # The last equation gives the work along the change of stress, or the share.
    if part.driven:
        last = np.column_stack((target, np.zeros(n)))
    else:
        last = np.column_stack((0.0 * target, np.ones(n)))
    z = best = known
    step = np.zeros_like(known)
    least = np.full(n, np.inf)
    for _ in range(_MOST):
        # Evaluate the unbalanced stress.
        increment = np.zeros_like(part.change)
        increment[rows] = z[:, :-1].T - now.strain[rows]
        new = updated(
            material,
            increment[:, :, None],
            now.stress[:, :, None],
            now.memory[:, :, None],
            goal.time - now.time,
        )
        missing = goal.stress[rows].T + z[:, -1:] * target - new.stress[rows, :, 0].T
        missing += np.einsum("nij,nj->ni", around, (known - z)[:, :-1])
        size = row_norms(missing) / sizes[1]
        worse = ~(size < least)
        least = np.where(worse, least, size)
        best = np.where(worse[:, None], best, z)
        if size.max() < _BALANCED:
            break

        # Solve for the step, and limit its length.
        K = np.concatenate((np.zeros((n, len(rows), len(rows) + 1)), last[:, None]), axis=1)
        K[:, :-1, :-1] = tangent_at(elastic, new)[:, rows[:, None], rows] + around
        K[:, :-1, -1] = -target
        right = np.column_stack((missing, ((known - z) * last).sum(axis=1)))
        newton = np.linalg.solve(K, right[:, :, None])[:, :, 0]
        longest = _LONGEST * sizes[0]
        length = row_norms(newton[:, :-1]) / longest
        limited = newton / np.maximum(length, 1.0)[:, None]
        step = np.where(worse[:, None], 0.5 * step, limited)
        z = best + step
    end = Point(now.strain + increment, new.stress[:, :, 0], new.internal[:, :, 0], goal.time)
    return end, size < 10 * _BALANCED
