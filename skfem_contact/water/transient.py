"""Flow of water through saturated and unsaturated ground in time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..checks import finite, number
from ..errors import NotConverged
from ..forms.assembly import strain_of
from ..forms.base import Coordinates
from ..loads import weight_of_water
from ..nonlinear.increment import PART
from ..solvers.direct import SingularSystem
from .balance import Balance, Unbalanced, WaterBalance, warn_of_dry_wells
from .boundary import (
    Conditions,
    Given,
    conditions,
    nodes_on,
    pumped,
    screens_and_ties,
    sourced,
    values_at,
)
from .darcy import Tensor, head_basis, laws_with_content, permeability_tensors, regions
from .retention import Laws, Retention
from .seepage import Seepage, described
from .storage import StoringFlow

_NOTHING: Mapping[str, float] = MappingProxyType({})
#: Values by boundary or subdomain, or a function of time that returns them.
Varying = Mapping[str, Given] | Callable[[float], Mapping[str, Given]]
#: The first and the shortest step over the whole time.
_FIRST, _SHORTEST = 1e-5, 1e-11
#: Steps grow and shrink by these factors at most; the error of a step aims at this share of the
#: limit.
_GROWTH, _CUT, _AIM = 2.0, 0.2, 0.8
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
    _states: tuple[Seepage, ...] = field(repr=False)

    def __len__(self) -> int:
        return len(self._states)

    def __getitem__(self, i: Any) -> Any:
        return self._states[i]

    def __str__(self) -> str:
        rows = zip(self.times, self.stored, self.entered, strict=True)
        return "\n".join(
            (
                f"seepage in {self.steps} steps, error of the balance {self.balance_error:.1e}\n"
                f"{'time':>12} {'stored':>12} {'entered':>12}",
                *("".join(f"{value:>13.5g}" for value in row)[1:] for row in rows),
            )
        )

    __repr__ = __str__

    @property
    def balance_error(self) -> float:
        """Largest difference between the water that has entered and the growth of the stored, over
        the stored.
        """
        return float(np.abs(self.stored - self.stored[0] - self.entered).max() / self.stored.max())


def transient_seepage(
    basis: CellBasis,
    permeability: Tensor | Mapping[str, Tensor],
    head: Varying = _NOTHING,
    *,
    retention: Retention | Mapping[str, Retention],
    times: Sequence[float] | ndarray,
    start: Seepage | Given,
    unit_weight: float,
    seepage_face: str | Sequence[str] = (),
    flux: Varying = _NOTHING,
    suction: Varying = _NOTHING,
    wells: Varying = _NOTHING,
    sources: Varying = _NOTHING,
    connected: Sequence[tuple[str, str]] = (),
    storage: float | Mapping[str, float] = 0.0,
    coordinates: Coordinates | None = None,
    error: float = 1e-2,
) -> TransientSeepage:
    r"""Solve the flow of water through saturated and unsaturated ground in time (L. A. Richards
    1931).

    Parameters
    ----------
    basis, permeability, unit_weight, seepage_face, connected, coordinates
        As for :func:`seepage`.
    head, flux, wells, sources
        As for :func:`seepage`, or a function of the time that returns such a mapping, with the same
        names at all times: ``flux=lambda t: {"surface": 1e-6 if t < 3600 else 0.}``. None is
        needed.
    retention
        :class:`VanGenuchten`, :class:`BrooksCorey` or :class:`Ramp` with a `content`, for all
        ground or by subdomain.
    times
        Increasing times for the result. The first is that of the start.
    start
        Heads at the start: a :class:`Seepage`, also one of an earlier result, a number, or a
        function of the coordinates (dim, ...). Ground under a suction s has the head z - s.
    suction
        Suction by boundary, a length: less the pressure head. It is kept like a head.
    storage
        Specific storage (1 / length) of saturated ground, by subdomain too: water per volume and
        head that compresses.
    error
        Limit of the error of a step in the content of any node, over its range, and in the water
        that compressible ground takes, over the largest change. The steps, of second order, are cut
        and grow with its estimate.

    Raises
    ------
    NotConverged
        The water does not balance in the shortest step.

    Examples
    --------
    Rain on a column of sand. Nothing is lost:

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> from skfem import Basis, ElementQuad1, MeshQuad
    >>> column = Basis(MeshQuad.init_tensor(np.array([0., 1.]), np.linspace(0, 2, 21)).with_defaults(), ElementQuad1())
    >>> sand = sc.water.VanGenuchten(alpha=2., n=3., content=(.05, .4))
    >>> water = sc.water.transient_seepage(column, 1e-4, {"bottom": 0.}, retention=sand, times=[0., 3600.], start=0.,
    ...                                    flux={"top": 1e-5}, unit_weight=9.81)
    >>> round(float(water.entered[-1]), 6), bool(water.balance_error < 1e-9)
    (0.036, True)
    """
    weight_of_water(unit_weight)
    number(error, "error", 0.0, 1.0)
    at = finite(times, "times")
    if at.ndim != 1 or len(at) < 2 or (np.diff(at) <= 0.0).any():
        raise ValueError(
            f"times must increase, from that of the start to at least one more, not {times!r}"
        )
    axisymmetric = strain_of(basis, None, coordinates, False)[1] == "axisymmetric"
    porous = head_basis(basis)
    given = _Given(
        porous,
        {"head": head, "flux": flux, "wells": wells, "sources": sources, "suction": suction},
        seepage_face,
        axisymmetric,
    )
    laws = laws_with_content(porous, retention)
    specific = np.zeros(porous.nelems)
    for part, value in regions(porous, storage, "storage"):
        specific[part] = number(value, "storage", -1e-300)
    heads = (
        start.head
        if isinstance(start, Seepage)
        else values_at(start, porous.mesh.p[:, : porous.N], "start")
    )
    if (
        np.shape(heads) != (porous.N,)
        or not np.isfinite(np.asarray(heads)[np.unique(porous.element_dofs)]).all()
    ):
        raise ValueError("the start is a seepage of another mesh, or of other ground")
    datum = float(porous.mesh.p[-1].mean())
    flow = StoringFlow(
        porous, permeability_tensors(porous, permeability), laws, specific, axisymmetric, datum
    )
    march = _March(flow, given, laws, connected, np.nan_to_num(heads, nan=datum) - datum, at, error)
    return march.run(unit_weight)


class _Given:
    """Conditions at the nodes at any time."""

    def __init__(
        self,
        basis: CellBasis,
        given: Mapping[str, Varying],
        faces: str | Sequence[str],
        axisymmetric: bool,
    ) -> None:
        self.basis, self._given, self._faces, self._axisymmetric = basis, given, faces, axisymmetric
        self._constant = not any(callable(each) for each in given.values())
        self._known: dict[float, tuple[Conditions, ndarray]] = {}

    def values(self, what: str, time: float) -> Mapping[str, Any]:
        """Return the values by name at a time."""
        value = self._given[what]
        found = value(time) if callable(value) else value
        if not isinstance(found, Mapping):
            raise ValueError(
                f"{what} at the time {time:g} is {found!r}: give {{name: value}}, or a function of "
                f"time "
                "that returns it"
            )
        return found

    def at(self, time: float) -> tuple[Conditions, ndarray]:
        """Return the conditions, and the first node of the well for each of its nodes, itself else,
        (N,).
        """
        key = 0.0 if self._constant else time
        if key not in self._known:
            self._known = {key: self._at(time)}
        return self._known[key]

    def _at(self, time: float) -> tuple[Conditions, ndarray]:
        head, flux, wells, sources = (
            self.values(what, time) for what in ("head", "flux", "wells", "sources")
        )
        found = conditions(self.basis, head, self._faces, flux, sources, self._axisymmetric)
        held, heads, passing = found.held.copy(), found.head.copy(), dict(found.passing)
        for name, suction in self.values("suction", time).items():
            nodes = nodes_on(self.basis, name)
            nodes = nodes[~found.held[nodes]]
            x = self.basis.mesh.p[:, nodes]
            heads[nodes], held[nodes] = (
                x[-1] - values_at(suction, x, f"suction of boundary '{name}'"),
                True,
            )
            passing[name] = np.asarray(self.basis.mesh.boundaries[name])
        found = replace(found, held=held, head=heads, face=found.face & ~held, passing=passing)
        return pumped(self.basis, wells, found)


class _Part(NamedTuple):
    """Balance at the end of a part of a step; stored volumes and their rates, (2, N), and nodes
    that are not held.
    """

    found: Balance
    head: ndarray
    leaking: ndarray
    stored: ndarray
    rate: ndarray
    free: ndarray
    entered: float


class _March:
    """Steps in time of second order, as long as their error allows.

    Both parts of a step are of Euler's backward method (R. Alexander 1977, see :data:`PART`), the
    second from stored volumes extrapolated from the first. Where no ground can hold these, at
    fronts, a step ends with its first part.
    """

    def __init__(
        self,
        flow: StoringFlow,
        given: _Given,
        laws: Laws,
        connected: Sequence[tuple[str, str]],
        head: ndarray,
        times: ndarray,
        error: float,
    ) -> None:
        self.flow, self.given, self.laws, self.times, self._error = flow, given, laws, times, error
        first, wells = given.at(times[0])
        tie = screens_and_ties(flow.basis, connected, first.held, wells)
        self._balance = WaterBalance(flow, first, tie, flow.basis.mesh.p[:, : flow.basis.N])
        self._length = float(times[-1] - times[0])
        self._step, self.steps = _FIRST * self._length, 0
        self.head, self.leaking = tie @ head, np.zeros(len(head), dtype=bool)
        self._start, self._stored = self.head, flow.stored(self.head)
        self._rate = 0.0 * self._stored
        self.entered = 0.0
        self._check_room()

    def run(self, unit_weight: float) -> TransientSeepage:
        """Return the flow at all times."""
        relative = self.flow.relative(self.head, self.laws)[0]
        still = Balance(
            self.head,
            self._balance.tie.T @ super(StoringFlow, self.flow).inflow(self.head, relative),
            relative,
            (0,),
        )
        rows, time = [self._row(still, self.times[0], unit_weight)], float(self.times[0])
        for target in map(float, self.times[1:]):
            last = still
            while time < target:
                count = np.ceil((target - time) / self._step * (1.0 - 1e-12))
                end = target if count <= 1 else time + (target - time) / count
                if (found := self._tried(time, end)) is not None:
                    time, last = (
                        found[0],
                        found[1]._replace(iterations=last.iterations + found[1].iterations),
                    )
            rows.append(self._row(last, target, unit_weight))
        states, content, stored, entered = zip(*rows, strict=True)
        warn_of_dry_wells(self.flow.basis, self.given.values("wells", time), states[-1].head)
        return TransientSeepage(
            self.times, np.array(content), np.array(stored), np.array(entered), self.steps, states
        )

    def _row(
        self, found: Balance, time: float, unit_weight: float
    ) -> tuple[Seepage, ndarray, float, float]:
        flux, sources = self.given.values("flux", time), self.given.values("sources", time)
        state = described(
            self.flow,
            found,
            self.given.at(time)[0],
            self.laws,
            flux,
            self._balance.tie.T @ sourced(self.flow.basis, sources, self.flow.axisymmetric),
            unit_weight,
        )
        return (
            state,
            self._stored.sum(axis=0) / self.flow.volume,
            float(self._stored.sum()),
            self.entered,
        )

    def _tried(self, time: float, end: float) -> tuple[float, Balance] | None:
        """Take a step, or its first part, and return its end; or shorten it and return None."""
        step, part = end - time, PART * (end - time)
        try:
            first = self._part(time + part, part, self._stored, self.head, self.leaking)
            further = self._stored + (1.0 / PART - 1.0) * (first.stored - self._stored)
            if self.flow.beyond(further, self._span(first)) > self._error:
                return self._accepted(time + part, step, part, [first], self._rate)
            # a rate may jump at the end of a step: what holds is that before it
            second = self._part(end - _JUST * step, part, further, first.head, first.leaking)
        except (Unbalanced, SingularSystem) as failed:
            self._step = _CUT * step
            if self._step < _SHORTEST * self._length:
                hint = (
                    ""
                    if self.flow.room(self.head) > 0.0 and isinstance(failed, Unbalanced)
                    else "; ground that is full and sealed has no definite pressure: give a "
                    "storage or a seepage face"
                )
                raise NotConverged(
                    f"the water does not balance at the time {time:.6g} in steps of {step:.2g}: "
                    f"{failed}" + hint,
                    self.head + self.flow.datum,
                ) from failed
            return None
        return self._accepted(end, step, part, [first, second], first.rate)

    def _part(
        self, time: float, length: float, before: ndarray, head: ndarray, leaking: ndarray
    ) -> _Part:
        """Return the balance at a time after a step of first order from stored volumes."""
        given = self.given.at(time)[0]
        lowered = replace(given, head=given.head - self.flow.datum)
        found, leaking = self._balance.step(
            self.flow.over(length, before), lowered, head, leaking, self.laws
        )
        stored, free = self.flow.stored(found.head), ~(given.held | leaking)
        entered = length * float(
            np.where(free, self._balance.tie.T @ given.supply, found.inflow).sum()
        )
        return _Part(found, found.head, leaking, stored, (stored - before) / length, free, entered)

    def _span(self, part: _Part) -> ndarray:
        """Return what nodes can store, by saturation and by the largest change of pressure so far,
        (2, N).
        """
        pressed, before = (
            np.maximum(head - self.flow.elevation, 0.0) for head in (part.head, self._start)
        )
        return self.flow.span(float(np.abs(pressed - before).max()))

    def _accepted(
        self, end: float, step: float, part: float, parts: list[_Part], rate: ndarray
    ) -> tuple[float, Balance] | None:
        """Accept a step if its error, estimated by the change of the rate, is small; shorten it
        else.
        """
        last, span = parts[-1], self._span(parts[-1])
        at = last.free & (span > 0.0)
        off = float((0.5 * part * np.abs(last.rate - rate)[at] / span[at]).max(initial=1e-300))
        better = _AIM * np.sqrt(self._error / off)
        if off > self._error and step > 10 * _SHORTEST * self._length:
            self._step = step * max(_CUT, better)
            return None
        self._step = step * float(np.clip(better, _CUT, _GROWTH))
        shares = (1.0 / PART - 1.0, 1.0) if len(parts) == 2 else (1.0,)
        self.entered += sum(share * each.entered for share, each in zip(shares, parts, strict=True))
        self.head, self.leaking, self._rate, self._stored = (
            last.head,
            last.leaking,
            last.rate,
            last.stored,
        )
        self.steps += 1
        iterations = sum((each.found.iterations for each in parts), start=())
        return end, last.found._replace(iterations=iterations)

    def _check_room(self) -> None:
        """Refuse sources in ground that water cannot leave and that cannot store it."""
        given = [self.given.at(float(time))[0] for time in self.times[1:]]
        rates, room = np.array([each.supply.sum() for each in given]), self.flow.room(self.head)
        volume = float(rates @ np.diff(self.times))
        if volume > room and not any(each.held.any() or each.face.any() for each in given):
            raise ValueError(
                f"the ground is sealed, and {rates.max():.4g} enter per time, {volume:.4g} in all, "
                f"where "
                f"{room:.4g} find room: give a head, a seepage face, or a storage"
            )
