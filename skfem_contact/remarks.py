"""What a run tells at its end: every remark of a form once, for the stage where it is worst; a search that stalled."""
from __future__ import annotations

import re
import warnings
from collections.abc import Iterable
from types import TracebackType

from .errors import AnalysisWarning

_NUMBERS = re.compile(r"\[[\d\s]*\]")
_FIGURE = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


class Remarks:
    """Collects remarks on stages, and warns of them when the run ends, even if it fails.

    Remarks of a form that differ by their figures alone are one: the one with the largest figures is told, and with
    lists of points the longest.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as told, Remarks(stacklevel=2) as remarks:
    ...     for stage, share in (("dig", 2), ("load", 30), ("unload", 4)):
    ...         remarks.add(stage, "joint", [f"the slave penetrates by {share} %"])
    >>> [str(warning.message) for warning in told]
    ["stage 'load', joint: the slave penetrates by 30 %"]
    """

    def __init__(self, stacklevel: int) -> None:
        self._stacklevel = stacklevel + 1
        self._worst: dict[tuple[str, str], tuple[list[float], str]] = {}

    def add(self, stage: str, form: str, remarks: Iterable[str]) -> None:
        """Remarks of a form on a stage."""
        for remark in remarks:
            counted = _NUMBERS.sub(lambda found: str(len(found[0][1:-1].split())), remark)
            figures = [abs(float(figure)) for figure in _FIGURE.findall(counted)]
            kind = form, _FIGURE.sub("", counted)
            if kind not in self._worst or figures > self._worst[kind][0]:
                self._worst[kind] = figures, f"stage '{stage}', {form}: {remark}"

    def __enter__(self) -> Remarks:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
                 ) -> None:
        for _, text in self._worst.values():
            warnings.warn(text, AnalysisWarning, stacklevel=self._stacklevel)
