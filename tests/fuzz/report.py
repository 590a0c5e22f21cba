"""The table of many trials."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .comparisons import COMPARISONS
from .oracles import ORACLES
from .trial import Trial


def table(trials: Sequence[Trial]) -> str:
    """A line for every oracle: how often it was asked, what it found, and its worst figure over the
    tolerance.
    """
    lines = [f"{'oracle':16}{'asked':>7}{'violated':>10}{'silent':>8}{'worst':>10}  scene"]
    named = [*(oracle.__name__ for oracle in ORACLES), *COMPARISONS]
    named += sorted({finding.oracle for trial in trials for finding in trial.findings} - set(named))
    for name in named:
        found = [
            (finding, trial)
            for trial in trials
            for finding in trial.findings
            if finding.oracle == name
        ]
        wrong = [(finding, trial) for finding, trial in found if not finding.holds]
        silent = sum(not trial.remarks for _, trial in wrong)
        worst, where = max(
            ((_share(f.error, f.tolerance), t.scene.seed) for f, t in found), default=(0.0, "")
        )
        lines.append(f"{name:16}{len(found):7d}{len(wrong):10d}{silent:8d}{worst:10.1e}  {where}")
    gave_up, crashed = sum(t.gave_up for t in trials), [t for t in trials if t.crash]
    lines.append(f"{len(trials)} scenes: {gave_up} gave up and said so, {len(crashed)} crashed")
    return "\n".join(lines)


def _share(error: float, tolerance: float) -> float:
    return error / tolerance if tolerance > 0.0 else 0.0 if error == 0.0 else float("inf")


def details(trials: Iterable[Trial]) -> str:
    """What every scene that violates something is, and what it violates."""
    lines = []
    for trial in trials:
        if trial.crash or trial.violations:
            lines.append(f"scene {trial.scene.seed}: {trial.scene}")
            lines += [f"    {finding}" for finding in trial.violations]
            lines += [f"    crashed: {trial.crash}"] if trial.crash else []
            lines += [f"    remark: {text[:100]}" for text in trial.remarks]
    return "\n".join(lines)


def verdict(trials: Sequence[Trial]) -> tuple[int, int]:
    """Scenes that violate something, or crash, and those among them of which nothing was said."""
    violations = sum(bool(trial.violations or trial.crash) for trial in trials)
    return violations, sum(bool(trial.silent) for trial in trials)
