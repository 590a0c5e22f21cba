"""A scene is analysed, and everything that must hold is looked at."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

import skfem_contact as sc
from skfem_contact.results import Result

from .cases import Case
from .comparisons import COMPARISONS, of_result
from .frames import as_drawn
from .kinds import drawn
from .model import build
from .oracles import Finding, of_stage
from .scenes import Scene

#: Comparisons that a scene is put to, of all that there are: each costs an analysis or two.
DRAWN = 2


@dataclass(frozen=True)
class Trial:
    """What became of a scene.

    Attributes
    ----------
    scene
        The scene.
    findings
        What was looked at.
    remarks
        Warnings of the analysis, and how it failed where it did.
    gave_up
        Whether it stopped before the end of the path, and said so.
    crash
        What was raised that nobody expects.
    """

    scene: Scene | Case
    findings: tuple[Finding, ...] = ()
    remarks: tuple[str, ...] = ()
    gave_up: bool = False
    crash: str = ""

    @property
    def violations(self) -> tuple[Finding, ...]:
        """What does not hold."""
        return tuple(finding for finding in self.findings if not finding.holds)

    @property
    def silent(self) -> tuple[Finding, ...]:
        """What does not hold, of which not a word was said."""
        return () if self.remarks else self.violations


def trial(seed: int, comparisons: int = DRAWN, kind: str | None = None) -> Trial:
    """The scene of a seed, analysed and looked at."""
    scene = drawn(seed, kind)
    try:
        return _of_case(scene) if isinstance(scene, Case) else _of_scene(scene, comparisons)
    except Exception as error:
        return Trial(scene, crash=f"{type(error).__name__}: {error}")


def _of_case(case: Case) -> Trial:
    """A case with checks of its own."""
    findings: list[Finding] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            findings.extend(case.findings())
            failure = ""
        except sc.NotConverged as error:
            failure = str(error)
    return Trial(
        case, tuple(findings), _told(caught) + ((failure,) if failure else ()), bool(failure)
    )


def _of_scene(scene: Scene, comparisons: int) -> Trial:
    """Blocks that are pressed, and compared with the same ones seen otherwise."""
    model = build(scene, as_drawn(scene.dim))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            result, failure = model.run(), ""
        except sc.NotConverged as error:
            result, failure = error.result, str(error)
    remarks = _told(caught)
    reached = Result(tuple(stage for stage in result if stage.fraction > 0.0))
    findings = [
        finding for k in range(len(reached)) for finding in of_stage(scene, model, reached, k)
    ]
    chosen = (
        np.random.default_rng(scene.seed).permutation(list(COMPARISONS))[:comparisons]
        if not failure
        else ()
    )
    findings += [
        finding for name in chosen for finding in of_result(scene, model, result, name, remarks)
    ]
    return Trial(scene, tuple(findings), remarks + ((failure,) if failure else ()), bool(failure))


def _told(caught: list[warnings.WarningMessage]) -> tuple[str, ...]:
    return tuple(
        str(warning.message) for warning in caught if warning.category is sc.AnalysisWarning
    )
