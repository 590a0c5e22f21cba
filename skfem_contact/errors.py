"""Errors, warnings and remarks."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

from numpy import ndarray


class AnalysisWarning(UserWarning):
    """Analysis that was done but should be checked."""


def warn(text: str, kind: type[Warning] = AnalysisWarning) -> None:
    """Warn at the line outside the package whose call led here."""
    ours = (__name__.partition(".")[0], "contextlib")
    level = 1
    frame = sys._getframe()
    while frame.f_back is not None:
        package = frame.f_globals.get("__name__", "").partition(".")[0]
        if package not in ours:
            break
        level += 1
        frame = frame.f_back
    warnings.warn(text, kind, stacklevel=level)


class NotConverged(RuntimeError):
    """Failure of Newton's method to find an equilibrium, which may exist all the same.

    Attributes
    ----------
    result
        Stages and increments that were accepted before.
    x
        Displacements that were reached, (N,).
    residuals
        History of the residual.
    dof
        Dof of the largest unbalanced force, or the first one that can move freely.
    cycle
        Displacements between which the iterations went back and forth, if they did.
    """

    result: Any = None

    def __init__(
        self,
        message: str,
        x: ndarray | None = None,
        residuals: Sequence[float] = (),
        dof: int | None = None,
        cycle: Sequence[ndarray] = (),
    ) -> None:
        super().__init__(message)
        self.x = x
        self.residuals = tuple(residuals)
        self.dof = dof
        self.cycle = tuple(cycle)


class NoEquilibrium(NotConverged):
    """Collapse under a load: displacements grow without bound.

    With associated flow the residual is the gradient of a convex potential. A line search along
    this energy finds the minimum. At collapse no minimum exists, and the search runs away along
    the mechanism: displacements of a hundred times the elastic ones count as collapse. With
    friction and non-associated flow no potential exists, but the mechanism is found in the same
    way.
    """


def saying(error: NotConverged, message: str) -> NotConverged:
    """Return a failure of the same class and state with another message."""
    return type(error)(message, error.x, error.residuals, error.dof, error.cycle)


@dataclass(frozen=True)
class Failure:
    """Failure of Newton's method, for a form that may return a regularised one.

    See :meth:`Form.begin`.

    Attributes
    ----------
    loose
        True if bodies can move freely, or ran away.
    seen
        Candidate states of the form between which the iterations chatter, if any.
    """

    loose: bool
    seen: tuple[Any, ...] = ()


class InadmissibleStress(ValueError):
    """Initial stress that a material does not admit.

    `point` is the flat index (C order) of the worst point.
    """

    def __init__(self, message: str, point: int) -> None:
        super().__init__(message)
        self.point = point


class IncrementTooLarge(RuntimeError):
    """Error of a material's update or of :meth:`Form.outer`: the increment must be cut."""


@dataclass(frozen=True)
class Remark:
    """Remark on an accepted state; of each kind a run reports the remark of the largest figure.

    A remark that is made before the state is known may have a condition on its displacements, (N,).
    """

    kind: str
    figure: float
    text: str
    holds: Callable[[ndarray], bool] = lambda x: True


class Remarks:
    """Remarks on stages, which become warnings when the run ends, even if it fails.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as caught, Remarks() as remarks:
    ...     for stage, share in (("dig", 2), ("load", 30), ("unload", 4)):
    ...         remark = Remark("penetration", share, f"the slave penetrates by {share} %")
    ...         remarks.add(stage, "joint", [remark])
    >>> [str(warning.message) for warning in caught]
    ["stage 'load', joint: the slave penetrates by 30 %"]
    """

    def __init__(self) -> None:
        self._worst: dict[tuple[str, str], tuple[float, str]] = {}

    def add(self, stage: str, form: str, remarks: Iterable[Remark]) -> None:
        """Add remarks of a form on a stage."""
        for remark in remarks:
            kind = form, remark.kind
            if kind not in self._worst or remark.figure > self._worst[kind][0]:
                self._worst[kind] = remark.figure, f"stage '{stage}', {form}: {remark.text}"

    def __enter__(self) -> Remarks:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for _, text in self._worst.values():
            warn(text)
