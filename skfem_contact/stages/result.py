"""Results of stages: printed as a table, saved to one file and resumed from it."""
from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy import ndarray

from ..contact.penalty import choose_penalties
from ..errors import look_up
from ..forms import Form, arrays_of, as_forms, with_arrays

if TYPE_CHECKING:
    from ..post import ContactReport, SectionForces, Sections, Tractions

#: Layout of saved files: another number for other states.
_LAYOUT = 1


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
    forms
        The forms themselves, as they are in the stage.
    """

    name: str
    x: ndarray
    load: ndarray
    states: Mapping[str, Any]
    iterations: tuple[int, ...]
    residual: float
    fraction: float = 1.0
    summary: Mapping[str, str] = field(default_factory=dict)
    forms: Mapping[str, Form] = field(default_factory=dict, repr=False)

    def _form(self, name: str) -> Any:
        return look_up(name, self.forms, f"form in stage '{self.name}'")

    def reactions(self) -> ndarray:
        """Forces of the supports, see :func:`~skfem_contact.reactions`."""
        from ..post import reactions  # what a stage shows stands above it, and is called from here for short

        return reactions(self.forms, self)

    def tractions(self, pair: str) -> Tractions:
        """Contact tractions of a pair, see :func:`~skfem_contact.tractions`."""
        from ..post import tractions

        return tractions(self._form(pair), self.states[pair])

    def report(self, pair: str) -> ContactReport:
        """Resultants and status of a contact pair, see :func:`~skfem_contact.contact_report`."""
        from ..post import contact_report

        return contact_report(self._form(pair), self.x, self.states[pair])

    def section_forces(self, solid: str, sections: Sections) -> SectionForces:
        """Section forces of a body, see :func:`~skfem_contact.section_forces`."""
        from ..post import section_forces

        return section_forces(self._form(solid), self.states[solid], sections)

    def contour(self, quantity: str, **options: Any) -> Any:
        """A picture of a field, see :func:`~skfem_contact.plot.contour`."""
        from ..plot import contour

        return contour(self.forms, self, quantity, **options)

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
        arrays, stages = {}, []
        for i, stage in enumerate(self.stages):
            stages.append({"name": stage.name, "iterations": stage.iterations, "residual": stage.residual,
                           "fraction": stage.fraction, "summary": dict(stage.summary), "forms": list(stage.states)})
            arrays[f"{i}/x"], arrays[f"{i}/load"] = stage.x, stage.load
            for name, state in stage.states.items():
                for k, values in enumerate(arrays_of(state)):
                    arrays[f"{i}/{name}/{k}"] = values
        head = {"layout": _LAYOUT, "version": version("skfem-contact"), "stages": stages}
        np.savez_compressed(file, head=np.array(json.dumps(head)), **arrays)  # type: ignore[arg-type]  # in the stubs


def load_result(file: str | Path, forms: Mapping[str, Any]) -> Result:
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
        The file is no result, another version of this library wrote it, it speaks of other forms, or their sizes
        differ.

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
    given = choose_penalties(as_forms(forms))
    with np.load(path, allow_pickle=False) as data:
        for i, head in enumerate(_stages_in(data, path)):
            if not set(head["forms"]) <= set(given):
                raise ValueError(f"the file holds the forms {head['forms']}, not {list(given)}")
            there = {name: given[name] for name in head["forms"]}  # those that were active
            states = {name: _state_in(data, f"{i}/{name}", form) for name, form in there.items()}
            stages.append(StageResult(head["name"], data[f"{i}/x"], data[f"{i}/load"], states,
                                      tuple(head["iterations"]), head["residual"], head["fraction"], head["summary"],
                                      there))
    return Result(tuple(stages))


def _stages_in(data: Any, path: str) -> list[dict[str, Any]]:
    """What a file says of its stages."""
    if "head" not in data:
        raise ValueError(f"{path} is not a saved result")
    head = json.loads(str(data["head"]))
    layout, writer = (head["layout"], head["version"]) if isinstance(head, dict) else (0, "0.1.0")
    if layout != _LAYOUT:
        raise ValueError(f"{path} was written by version {writer} of this library, with another layout than that of "
                         f"{version('skfem-contact')}: read it there, or compute it anew")
    return list(head["stages"])


def _state_in(data: Any, key: str, form: Form) -> Any:
    """The state of a form in a file."""
    initial, name = form.initial_state(), key.partition("/")[2]
    arrays = [data[f"{key}/{k}"] for k in range(len(arrays_of(initial))) if f"{key}/{k}" in data]
    if len(arrays) != len(arrays_of(initial)):
        raise ValueError(f"'{name}' in the file has {len(arrays)} arrays, not {len(arrays_of(initial))}: it was "
                         "another form")
    state = with_arrays(initial, arrays)
    if not form.fits(state):
        raise ValueError(f"'{name}' in the file has another size: the mesh or the element differs")
    return state
