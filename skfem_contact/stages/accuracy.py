"""Errors of increments in soil whose stiffness depends on stress: they are followed once more in
parts.

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
_PARTS = 3
#: Stiffness of the ground around a point as a share of its elastic one: it keeps strains finite
#: where points fail.
_AROUND = 0.01
#: Iterations, of which 2 to 8 are needed; unbalanced stress as a share of its largest change. No
#: step is longer than this share of the largest increment.
_MOST, _BALANCED, _LONGEST = 10, 1e-3, 0.5
#: Error that is remarked on, and the largest that is given as a figure.
_ERROR, _LARGE = 0.05, 1.0
#: Share of the largest strain below which strains count as held, as in a layer.
_HELD = 1e-6


class _Point(NamedTuple):
    """Strain, stress and internal variables at points, (ncomp, n) or (n_internal, n), and their
    time.
    """

    strain: ndarray
    stress: ndarray
    memory: ndarray
    time: float


class _Sample(NamedTuple):
    """Points of a region, by their number there, with their share of its volume, and their states
    in a stage.
    """

    material: Material
    at: ndarray
    weight: ndarray
    states: list[_Point]

    def work(self, begin: int, end: int) -> ndarray:
        """Return the work of the change of stress between two states, (n,)."""
        a, b = self.states[begin], self.states[end]
        return self.weight * ((b.stress - a.stress) * (b.strain - a.strain)).sum(axis=0)


class Parts:
    """Accepted increments of a stage, to be followed in parts; `driven` is true where supports
    move.
    """

    def __init__(self, driven: bool) -> None:
        self._driven, self._samples = driven, dict[str, dict[str, _Sample]]()

    def add(self, before: StageResult, after: StageResult) -> None:
        """Record an accepted increment."""
        for name, form in having(after.forms, Body).items():
            if not any(material.stress_dependent for material in form.materials.values()):
                continue
            old, new = before.states[name], after.states[name]
            if not self._samples.get(name):  # nothing has moved so far
                self._samples[name] = _chosen(form, old, new)
                _record(self._samples[name], form, old, before.time)
            _record(self._samples[name], form, new, after.time)

    def remarks(self, name: str) -> Iterator[Remark]:
        """Yield a remark on the estimated error of a body, of all increments if that of the largest
        one is large.
        """
        samples = list(self._samples.get(name, {}).values())
        if not samples:
            return
        last = len(samples[0].states) - 1
        largest = int(
            np.argmax([sum(np.abs(s.work(k, k + 1)).sum() for s in samples) for k in range(last)])
        )
        try:
            with np.errstate(all="ignore"):  # at points that fail, which do not count
                error = _error(samples, largest, largest + 1, self._driven)
                if error > _ERROR and last > 1:
                    error = _error(samples, 0, last, self._driven)
        except (
            IncrementTooLarge,
            InadmissibleStress,
            np.linalg.LinAlgError,
        ):  # of parts without an equilibrium
            return
        if error > _ERROR:
            size = f"about {error:.0%}" if error < _LARGE else f"more than {_LARGE:.0%}"
            what = "forces at the moved supports" if self._driven else "displacements"
            yield Remark(
                "increments",
                error,
                f"{what} are off by {size}, as estimated from parts of the {last} "
                "increments: stiffness and strains change much within them; give the stage more "
                "`increments`",
            )


def _chosen(form: Any, old: Any, new: Any) -> dict[str, _Sample]:
    """Return samples of the regions, in which points occur in proportion to their work in an
    increment.
    """
    work = np.abs(form.weight * ((new.stress - old.stress) * (new.strain - old.strain)).sum(axis=0))
    samples = {}
    for region in form.regions:
        sums = np.cumsum(own := work[region.elements].ravel())
        if region.material.stress_dependent and sums[-1] > 0.0:
            marks = (np.arange(_POINTS) + 0.5) / _POINTS * sums[-1]
            at, count = np.unique(np.searchsorted(sums, marks), return_counts=True)
            share = count * sums[-1] / _POINTS / own[at]
            samples[region.name] = _Sample(
                region.material, at, share * form.weight[region.elements].ravel()[at], []
            )
    return samples


def _record(samples: dict[str, _Sample], form: Any, state: Any, time: float) -> None:
    """Add a state of a body to its samples."""
    for region, stress, memory in form.at_regions(state):
        if region.name in samples:
            at = samples[region.name].at
            strain, stress, memory = (
                values.reshape(len(values), stress[0].size)[:, at]
                for values in (state.strain[:, region.elements], stress, memory)
            )
            samples[region.name].states.append(_Point(strain, stress, memory, time))


def _error(samples: Sequence[_Sample], begin: int, end: int, driven: bool) -> float:
    """Return the estimated error of increments from one state to another, as a share of what they
    change.
    """
    total, more = 0.0, 0.0
    for sample in samples:
        a, b = sample.states[begin], sample.states[end]
        strain, stress, solved = _followed(sample.material, sample.states[begin : end + 1], driven)
        lost = (
            (stress - b.stress) * (b.strain - a.strain)
            if driven
            else (b.strain - strain) * (b.stress - a.stress)
        )
        total += sample.work(begin, end)[solved].sum()
        more += _PARTS / (_PARTS - 1.0) * (sample.weight * lost.sum(axis=0))[solved].sum()
    return abs(more / total) if total else 0.0


def _followed(
    material: Material, states: Sequence[_Point], driven: bool
) -> tuple[ndarray, ndarray, ndarray]:
    """Return strain and stress after parts of increments, and where they are in equilibrium,
    (n,).
    """
    now, solved = states[0], np.ones(states[0].strain.shape[1], bool)
    sizes = _sizes([state.strain for state in states]), _sizes([state.stress for state in states])
    changes = np.abs(np.diff([state.strain for state in states], axis=0)).max(axis=(0, 2))
    rows = np.flatnonzero(changes > _HELD * changes.max())
    for a, b in pairwise(states):
        base = now.stress if driven else a.stress
        for share in (np.arange(_PARTS) + 1.0) / _PARTS:
            time = a.time + share * (b.time - a.time)
            goal = _Point(a.strain + share * (b.strain - a.strain), base, now.memory, time)
            now, balanced = _part(
                material, now, goal, b.stress - a.stress, share, rows, sizes, driven
            )
            solved &= balanced
    return now.strain, now.stress, solved


def _sizes(values: Sequence[ndarray]) -> ndarray:
    """Return the sizes of the largest changes, (n,)."""
    return np.linalg.norm(np.diff(values, axis=0), axis=1).max(axis=0)


def _part(
    material: Material,
    now: _Point,
    goal: _Point,
    change: ndarray,
    share: float,
    rows: ndarray,
    sizes: tuple[ndarray, ndarray],
    driven: bool,
) -> tuple[_Point, ndarray]:
    """Return the state after a part of an increment, and where it is in equilibrium.

    The stress of the goal and a share of the change of stress are reached. Either this share is
    known or the strain along the change. Newton's method halves its step where the residual has not
    fallen.
    """
    target, elastic, n = (
        change[rows].T,
        elasticity_at(material, now.stress, now.memory),
        change.shape[1],
    )
    around, known = (
        _AROUND * elastic[:, rows[:, None], rows],
        np.column_stack((goal.strain[rows].T, np.full(n, share))),
    )
    last = np.column_stack((target if driven else 0.0 * target, np.full(n, 0.0 if driven else 1.0)))
    z, best, least, step = known, known, np.full(n, np.inf), np.zeros_like(known)
    for _ in range(_MOST):
        increment = np.zeros_like(change)
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
        size = np.linalg.norm(missing, axis=1) / sizes[1]
        worse = ~(size < least)
        least, best = np.where(worse, least, size), np.where(worse[:, None], best, z)
        if size.max() < _BALANCED:
            break
        K = np.concatenate((np.zeros((n, len(rows), len(rows) + 1)), last[:, None]), axis=1)
        K[:, :-1, :-1] = tangent_at(elastic, new)[:, rows[:, None], rows] + around
        K[:, :-1, -1] = -target
        right = np.column_stack((missing, ((known - z) * last).sum(axis=1)))
        newton = np.linalg.solve(K, right[:, :, None])[:, :, 0]
        length = np.linalg.norm(newton[:, :-1], axis=1) / (_LONGEST * sizes[0])
        step = np.where(worse[:, None], 0.5 * step, newton / np.maximum(length, 1.0)[:, None])
        z = best + step
    return _Point(
        now.strain + increment, new.stress[:, :, 0], new.internal[:, :, 0], goal.time
    ), size < 10 * _BALANCED
