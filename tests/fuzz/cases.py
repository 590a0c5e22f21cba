"""Scenes of other kinds, each with a check of its own beside the oracles of all stages."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .frames import as_drawn
from .model import Model
from .oracles import Finding, of_stage


class Check(NamedTuple):
    """Name of a check, by how much it does not hold, and by how much it may not."""

    oracle: str
    error: float
    tolerance: float


@dataclass(frozen=True)
class Case:
    """A scene of a kind other than the pressed blocks of :class:`~.scenes.Scene`.

    Attributes
    ----------
    seed
        Of the scene.
    words
        What it is.
    look
        Analysis, and what was looked at.
    """

    seed: int
    words: str
    look: Callable[[], Iterator[Check | Finding]]

    def __str__(self) -> str:
        return self.words

    def findings(self) -> Iterator[Finding]:
        """Findings of the analysis; those of the case itself belong to no stage."""
        for found in self.look():
            yield (
                found
                if isinstance(found, Finding)
                else Finding(found.oracle, "", *map(float, found[1:]))
            )


@dataclass(frozen=True)
class Setting:
    """What the oracles of a stage ask of a scene."""

    kind: str = "plane"
    element: str = "Q1"
    quadrature: str = "segments"
    dim: int = 2
    b_bar: bool = False
    smoothing: float | None = None


def of_run(model, result, setting: Setting | None = None) -> Iterator[Finding]:
    """Everything that must hold in the stages of a run of ``sc.Model`` by themselves."""
    ours = Model(model.forms, [], model.fixed, as_drawn(2))
    for k in range(len(result)):
        yield from of_stage(setting or Setting(), ours, result, k)


def apart(found: float, exact: float) -> float:
    """Relative difference; NaN and infinities differ."""
    return abs(found - exact) / abs(exact) if np.isfinite(found) else np.inf
