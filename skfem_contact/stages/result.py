"""Results of stages: printed as a table, saved to one file and resumed from it."""
from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray

from ..contact.pair import ContactPair
from ..forms import Form
from ..solid import SolidForm


@dataclass(frozen=True)
class StageResult:
    """What the bodies carry at the end of a stage.

    Attributes
    ----------
    name
        Name of the stage.
    x
        Displacements, (N,).
    load
        External forces, (N,).
    states
        Accepted state of every form.
    iterations
        Newton iterations of every increment.
    residual
        Relative residual at the end.
    fraction
        Share of the stage's load that was reached: 1 unless the analysis failed.
    summary
        One line for every form.
    """

    name: str
    x: ndarray
    load: ndarray
    states: Mapping[str, Any]
    iterations: tuple[int, ...]
    residual: float
    fraction: float = 1.0
    summary: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        return (f"<StageResult '{self.name}', {self.fraction:.0%} of its load, {len(self.x)} unknowns, "
                f"forms: {', '.join(self.states)}>")


@dataclass(frozen=True)
class Result:
    """Stages in their order; ``result["gravity"]`` is one of them, ``print(result)`` a table.

    Examples
    --------
    >>> from skfem_contact import Result
    >>> print(Result(()))
    stage            increments  iterations  residual  load    what the bodies carry
    """

    stages: tuple[StageResult, ...]

    def __getitem__(self, key: str | int) -> StageResult:
        if isinstance(key, int):
            return self.stages[key]
        for stage in self.stages:
            if stage.name == key:
                return stage
        raise KeyError(f"there is no stage '{key}'; existing: {[s.name for s in self.stages]}")

    def __iter__(self) -> Iterator[StageResult]:
        return iter(self.stages)

    def __len__(self) -> int:
        return len(self.stages)

    def __str__(self) -> str:
        lines = ["stage            increments  iterations  residual  load    what the bodies carry"]
        for s in self.stages:
            lines.append(f"{s.name:16} {len(s.iterations):10d}  {sum(s.iterations):10d}  {s.residual:8.1e}  "
                         f"{s.fraction:4.0%}    " + "; ".join(f"{k}: {v}" for k, v in s.summary.items() if v))
        return "\n".join(lines)

    __repr__ = __str__  # the arrays of all stages would fill a notebook

    def save(self, file: str | Path) -> None:
        """Write all stages to one compressed file, from which :func:`load_result` resumes; it gets the end ``.npz``."""
        arrays, head = {}, []
        for i, stage in enumerate(self.stages):
            head.append({"name": stage.name, "iterations": stage.iterations, "residual": stage.residual,
                         "fraction": stage.fraction, "summary": dict(stage.summary), "forms": list(stage.states)})
            arrays[f"{i}/x"], arrays[f"{i}/load"] = stage.x, stage.load
            for name, state in stage.states.items():
                for f in fields(state):
                    arrays[f"{i}/{name}/{f.name}"] = getattr(state, f.name)
        np.savez_compressed(file, head=np.array(json.dumps(head)), **arrays)  # type: ignore[arg-type]  # in the stubs


def _fits(form: Form, state: Any, initial: Any) -> bool:
    """Whether a state belongs to a form; cuts of the slave and internal variables may be others than at first."""
    if isinstance(form, ContactPair) and form.quadrature == "segments":
        return form.fits_cuts(state.cuts)
    if isinstance(form, SolidForm):
        return np.shape(state.stress) == np.shape(initial.stress)
    names = {f.name for f in fields(initial)} - {"internal"}
    return all(np.shape(getattr(state, name)) == np.shape(getattr(initial, name)) for name in names)


def load_result(file: str | Path, forms: Mapping[str, Form]) -> Result:
    """Read a saved result.

    Parameters
    ----------
    file
        Name of the file that :meth:`Result.save` wrote, with or without its end ``.npz``.
    forms
        The forms of the analysis, by the same names; of those that were not active in a stage it holds no state.

    Raises
    ------
    ValueError
        The file is no result, speaks of other forms, or their sizes differ.

    Examples
    --------
    >>> import os, tempfile
    >>> from skfem_contact import Result, load_result
    >>> file = os.path.join(tempfile.mkdtemp(), "empty.npz")
    >>> Result(()).save(file)
    >>> len(load_result(file, {}))
    0
    """
    stages, path = [], str(file) if str(file).endswith(".npz") else f"{file}.npz"
    with np.load(path, allow_pickle=False) as data:
        if "head" not in data:
            raise ValueError(f"{path} is not a saved result")
        for i, head in enumerate(json.loads(str(data["head"]))):
            if not set(head["forms"]) <= set(forms):
                raise ValueError(f"the file holds the forms {head['forms']}, not {list(forms)}")
            states = {}
            for name in head["forms"]:  # those that were active
                form = forms[name]
                initial = form.initial_state()
                if missing := [f.name for f in fields(initial) if f"{i}/{name}/{f.name}" not in data]:
                    raise ValueError(f"'{name}' in the file has no {', '.join(missing)}: it was another form, "
                                     "or another version of this library wrote it")
                states[name] = type(initial)(**{f.name: data[f"{i}/{name}/{f.name}"] for f in fields(initial)})
                if not _fits(form, states[name], initial):
                    raise ValueError(f"'{name}' in the file has another size: the mesh or the element differs")
            stages.append(StageResult(head["name"], data[f"{i}/x"], data[f"{i}/load"], states,
                                      tuple(head["iterations"]), head["residual"], head["fraction"], head["summary"]))
    return Result(tuple(stages))
