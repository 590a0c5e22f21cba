"""What a run says at its end: every kind of remark once, for the stage where its figure is largest."""
from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from types import TracebackType

from .errors import AnalysisWarning


@dataclass(frozen=True)
class Remark:
    """What a user should know of an accepted state: of each kind a run gives one remark, that of the largest figure."""

    kind: str
    figure: float
    text: str


class Remarks:
    """Collects remarks on stages, and warns of them when the run ends, even if it fails.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as caught, Remarks(stacklevel=2) as remarks:
    ...     for stage, share in (("dig", 2), ("load", 30), ("unload", 4)):
    ...         remarks.add(stage, "joint", [Remark("penetration", share, f"the slave penetrates by {share} %")])
    >>> [str(warning.message) for warning in caught]
    ["stage 'load', joint: the slave penetrates by 30 %"]
    """

    def __init__(self, stacklevel: int) -> None:
        self._stacklevel = stacklevel + 1
        self._worst: dict[tuple[str, str], tuple[float, str]] = {}

    def add(self, stage: str, form: str, remarks: Iterable[Remark]) -> None:
        """Remarks of a form on a stage."""
        for remark in remarks:
            kind = form, remark.kind
            if kind not in self._worst or remark.figure > self._worst[kind][0]:
                self._worst[kind] = remark.figure, f"stage '{stage}', {form}: {remark.text}"

    def __enter__(self) -> Remarks:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
                 ) -> None:
        for _, text in self._worst.values():
            warnings.warn(text, AnalysisWarning, stacklevel=self._stacklevel)
