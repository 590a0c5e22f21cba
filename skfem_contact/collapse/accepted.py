"""Searches that do not come to their end: the states that they have accepted."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from types import TracebackType
from typing import Any

import numpy as np

from ..forms.base import dilate_less
from ..results.stage import StageResult
from .continuation import Branch, SearchStart
from .mechanism import describe_mesh
from .result import CollapseResult, Point, SearchLog, Stop, released


@contextmanager
def kept_in_errors(stage: StageResult) -> Iterator[None]:
    """Give errors a stage as their attribute ``result``."""
    try:
        yield
    except BaseException as error:
        error.result = stage  # type: ignore[attr-defined]
        raise


class Accepted:
    """Equilibria that a search has accepted: whatever ends the search takes them with it.

    Used as a context, in which an error gets the attribute ``result``.
    """

    def __init__(self, what: str, begun: SearchStart, water: Any = None) -> None:
        self.found: CollapseResult | None = None  # the search is over, and bounds are proven
        self._what = what
        self._begun = begun
        self._water = water
        self._branch: Branch | None = None
        self._log: SearchLog | None = None
        self._flow = "given"
        self._reduced: tuple[str, ...] = ()
        self._davis: CollapseResult | None = None

    def follow(
        self,
        branch: Branch,
        log: SearchLog,
        flow: str,
        reduced: tuple[str, ...] = (),
        davis: CollapseResult | None = None,
    ) -> None:
        """Take the equilibria from the log of a search."""
        self._branch = branch
        self._log = log
        self._flow = flow
        self._reduced = reduced
        self._davis = davis

    def __enter__(self) -> Accepted:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if error is not None:
            result = self.found or self._begun.ended(self._partial(error), self._water)
            error.result = result  # type: ignore[attr-defined]

    def _partial(self, error: BaseException) -> CollapseResult:
        """Return the known part of the limit, without a mechanism."""
        # find the equilibrium of the largest parameter
        steps = () if self._log is None else tuple(self._log.steps)
        points = [] if self._log is None else self._log.points
        last = max(points, key=lambda point: point.parameter, default=self._begun.origin)
        value = last.parameter
        path = [(point.parameter, point.x) for point in points]

        # collect the result
        return CollapseResult(
            what=self._what,
            value=value,
            bracket=(value, np.inf),
            stop=Stop("interrupted", f"{type(error).__name__} {error}".strip()),
            flow=self._flow,
            reduced=self._reduced,
            mesh=describe_mesh(self._begun.system.forms),
            steps=steps,
            end=self._end(last, steps),
            mechanism=np.zeros_like(last.x),
            bands={},
            added=np.nan,
            path=tuple(path),
            dilates_less=dilate_less(self._begun.system.forms),
            davis=self._davis,
        )

    def _end(self, last: Point, steps: tuple[Any, ...]) -> StageResult:
        """Return the stage of an equilibrium, or else of the start."""
        end = replace(self._begun.begins, name=self._what, layout=self._begun.system.layout)
        if self._branch is None or last is self._begun.origin:
            return end
        try:
            system, load = self._branch.at(last.parameter)
            forms, states = released(system.forms, last)
        except Exception:  # the form or law that has ended the search
            return replace(end, x=last.x, states=last.states)
        iterations = sum(step.iterations for step in steps)
        return replace(
            end, x=last.x, load=load, states=states, iterations=(iterations,), forms=forms
        )
