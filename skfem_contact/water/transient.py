"""Flow of water through saturated and unsaturated ground in time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..errors import NotConverged
from ..nonlinear.increment import PART
from ..solvers.direct import SingularSystem
from .balance import Balance, Unbalanced, WaterBalance, warn_of_dry_wells
from .boundary import NodalConditions, screens_and_ties, sourced
from .conditions import Conditions
from .darcy import DarcyFlow
from .retention import Laws
from .seepage import Seepage, described
from .storage import StoringFlow

#: The first and the shortest step over the whole time.
_FIRST = 1e-5
_SHORTEST = 1e-11
#: Steps grow and shrink by these factors at most; the error of a step aims at this share of the
#: limit.
_GROWTH = 2.0
_CUT = 0.2
_AIM = 0.8
#: Share of a step before its end at which rates are taken.
_JUST = 1e-9


@dataclass(frozen=True, eq=False)
class TransientSeepage(Sequence[Seepage]):
    """Flow of water at chosen times, a sequence of :class:`Seepage`; printed as a table.

    Attributes
    ----------
    times : ndarray, shape (n_times,)
        Chosen times, the first that of the start.
    content : ndarray, shape (n_times, n_nodes)
        Water per volume of ground, with what compressible ground has taken.
    stored, entered : ndarray, shape (n_times,)
        Volume of water in the ground, and that which has entered since the start.
    steps
        Number of steps in time.
    """

    times: ndarray
    content: ndarray
    stored: ndarray
    entered: ndarray
    steps: int
    _states: tuple[Seepage, ...]

    def __len__(self) -> int:
        return len(self._states)

    def __getitem__(self, i: Any) -> Any:
        return self._states[i]

    def __str__(self) -> str:
        rows = [
            f"seepage in {self.steps} steps, error of the balance {self.balance_error:.1e}",
            f"{'time':>12} {'stored':>12} {'entered':>12}",
        ]
        for time, stored, entered in zip(self.times, self.stored, self.entered, strict=True):
            rows.append(f"{time:>12.5g} {stored:>12.5g} {entered:>12.5g}")
        return "\n".join(rows)

    __repr__ = __str__

    @property
    def balance_error(self) -> float:
        """Largest difference between entered and additional stored water, over the stored."""
        error = max_abs(self.stored - self.stored[0] - self.entered)
        return float(error / self.stored.max())


class _Part(NamedTuple):
    """End of a part of a step: stored volumes and their rates, (2, N), and nodes not held, (N,)."""

    balance: Balance
    leaking: ndarray
    stored: ndarray
    rate: ndarray
    free: ndarray
    entered: float


class March:
    """Steps in time of second order, as long as their error allows.

    Both parts of a step are of Euler's backward method (R. Alexander 1977, see :data:`PART`), the
    second from stored volumes extrapolated from the first. Where no ground can hold these, at
    fronts, a step ends with its first part.
    """

    def __init__(
        self,
        flow: StoringFlow,
        conditions: Conditions,
        laws: Laws,
        connected: Sequence[tuple[str, str]],
        head: ndarray,
        times: ndarray,
        error: float,
    ) -> None:
        self.flow = flow
        self.laws = laws
        self.times = times
        self._conditions = conditions
        self._error = error
        self._known: dict[float, tuple[NodalConditions, ndarray]] = {}
        # Begin with the conditions at the start.
        given, first = self._at_nodes(float(times[0]))
        tie = screens_and_ties(flow.basis, connected, given.held, first)
        self._balance = WaterBalance(flow, given, tie, flow.basis.mesh.p[:, : flow.basis.N])
        self._length = float(times[-1] - times[0])
        self._step = _FIRST * self._length
        self.steps = 0
        # Store the water at the start.
        self.head = tie @ head
        self.leaking = np.zeros(len(head), dtype=bool)
        self._start = self.head
        self._stored = flow.stored(self.head)
        self._rate = 0.0 * self._stored
        self.entered = 0.0
        self._check_room()

    def _at_nodes(self, time: float) -> tuple[NodalConditions, ndarray]:
        """Return the conditions at a time, of which the last ones are kept."""
        key = time
        if self._conditions.constant:
            key = 0.0
        if key not in self._known:
            given = self._conditions.at_nodes(self.flow.basis, self.flow.axisymmetric, time)
            self._known = {key: given}
        return self._known[key]

    def run(self, unit_weight: float) -> TransientSeepage:
        """Return the flow at all times."""
        # Begin with the flow at the first time.
        relative = self.flow.relative(self.head, self.laws)[0]
        inflow = self._balance.tie.T @ DarcyFlow.inflow(self.flow, self.head, relative)
        start = Balance(self.head, inflow, relative, (0,))
        time = float(self.times[0])
        rows = [self._row(start, time, unit_weight)]
        for target in map(float, self.times[1:]):
            balance = start
            while time < target:
                # Divide the rest of the time into equal steps.
                count = np.ceil((target - time) / self._step * (1.0 - 1e-12))
                if count <= 1:
                    end = target
                else:
                    end = time + (target - time) / count
                step = self._tried(time, end)
                if step is None:
                    continue
                time, reached = step
                iterations = balance.iterations + reached.iterations
                balance = reached._replace(iterations=iterations)
            rows.append(self._row(balance, target, unit_weight))
        # Collect the rows by column.
        states, content, stored, entered = zip(*rows, strict=True)
        wells = self._conditions.values("wells", time)
        warn_of_dry_wells(self.flow.basis, wells, states[-1].head)
        return TransientSeepage(
            times=self.times,
            content=np.array(content),
            stored=np.array(stored),
            entered=np.array(entered),
            steps=self.steps,
            _states=states,
        )

    def _row(
        self,
        balance: Balance,
        time: float,
        unit_weight: float,
    ) -> tuple[Seepage, ndarray, float, float]:
        """Return the flow, the content of the nodes, and the stored and entered water."""
        flow = self.flow
        sources = self._conditions.values("sources", time)
        state = described(
            flow,
            balance,
            given=self._at_nodes(time)[0],
            laws=self.laws,
            flux=self._conditions.values("flux", time),
            from_sources=self._balance.tie.T @ sourced(flow.basis, sources, flow.axisymmetric),
            unit_weight=unit_weight,
        )
        content = self._stored.sum(axis=0) / flow.volume
        return state, content, float(self._stored.sum()), self.entered

    def _tried(self, time: float, end: float) -> tuple[float, Balance] | None:
        """Take a step, or its first part, and return its end; or shorten it and return None."""
        step = end - time
        part = PART * step
        try:
            first = self._part(time + part, part, self._stored, self.head, self.leaking)
            # The first part, continued, is what the whole step would store.
            further = self._stored + (1.0 / PART - 1.0) * (first.stored - self._stored)
            if self.flow.beyond(further, self._span(first.balance.head)) > self._error:
                return self._accepted(time + part, step, part, [first], self._rate)
            # Rates may jump at the end of a step: those before it hold.
            before = end - _JUST * step
            second = self._part(before, part, further, first.balance.head, first.leaking)
        except (Unbalanced, SingularSystem) as failed:
            self._shorten(time, step, failed)
            return None
        return self._accepted(end, step, part, [first, second], first.rate)

    def _shorten(self, time: float, step: float, failed: Unbalanced | SingularSystem) -> None:
        """Shorten a step that failed, or raise NotConverged."""
        self._step = _CUT * step
        if self._step >= _SHORTEST * self._length:
            return
        hint = ""
        if not isinstance(failed, Unbalanced) or not self.flow.room(self.head) > 0.0:
            hint = (
                "; ground that is full and sealed has no definite pressure: give a storage or a "
                "seepage face"
            )
        raise NotConverged(
            f"the water does not balance at the time {time:.6g} in steps of {step:.2g}: {failed}"
            + hint,
            self.head + self.flow.datum,
        ) from failed

    def _part(
        self,
        time: float,
        length: float,
        before: ndarray,
        head: ndarray,
        leaking: ndarray,
    ) -> _Part:
        """Return the balance at a time after a step of first order from stored volumes."""
        given = self._at_nodes(time)[0].above(self.flow.datum)
        flow = self.flow.over(length, before)
        balance, leaking = self._balance.step(flow, given, head, leaking, self.laws)
        stored = self.flow.stored(balance.head)
        free = ~(given.held | leaking)
        entering = np.where(free, self._balance.tie.T @ given.supply, balance.inflow)
        return _Part(
            balance=balance,
            leaking=leaking,
            stored=stored,
            rate=(stored - before) / length,
            free=free,
            entered=length * float(entering.sum()),
        )

    def _span(self, head: ndarray) -> ndarray:
        """Return the volumes that nodes can store, by saturation and pressure, (2, N)."""
        pressed = np.maximum(head - self.flow.elevation, 0.0)
        before = np.maximum(self._start - self.flow.elevation, 0.0)
        return self.flow.span(max_abs(pressed - before))

    def _accepted(
        self,
        end: float,
        step: float,
        part: float,
        parts: list[_Part],
        rate: ndarray,
    ) -> tuple[float, Balance] | None:
        """Accept a step if its error is small; shorten it else."""
        # Estimate the error by the change of the rate.
        last = parts[-1]
        span = self._span(last.balance.head)
        storing = last.free & (span > 0.0)
        change = 0.5 * part * np.abs(last.rate - rate)[storing]
        error = float((change / span[storing]).max(initial=1e-300))
        better = _AIM * np.sqrt(self._error / error)
        if error > self._error and step > 10 * _SHORTEST * self._length:
            self._step = step * max(_CUT, better)
            return None
        self._step = step * float(np.clip(better, _CUT, _GROWTH))
        # Continue from the end of the step.
        shares = [1.0]
        if len(parts) == 2:
            shares = [1.0 / PART - 1.0, 1.0]
        self.entered += sum(share * each.entered for share, each in zip(shares, parts, strict=True))
        self.head = last.balance.head
        self.leaking = last.leaking
        self._rate = last.rate
        self._stored = last.stored
        self.steps += 1
        iterations = sum((each.balance.iterations for each in parts), start=())
        return end, last.balance._replace(iterations=iterations)

    def _check_room(self) -> None:
        """Refuse sources in ground that water cannot leave and that cannot store it."""
        given = [self._at_nodes(float(time))[0] for time in self.times[1:]]
        rates = np.array([each.supply.sum() for each in given])
        room = self.flow.room(self.head)
        volume = float(rates @ np.diff(self.times))
        sealed = not any(each.held.any() or each.face.any() for each in given)
        if volume > room and sealed:
            raise ValueError(
                f"the ground is sealed, and {rates.max():.4g} enter per time, {volume:.4g} in all, "
                f"where {room:.4g} find room: give a head, a seepage face, or a storage"
            )
