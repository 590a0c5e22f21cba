"""Results of stages: printed as a table, saved to one file and resumed from it, counted anew."""
from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile
from zlib import crc32

import numpy as np
from numpy import ndarray

from ..contact.penalty import choose_penalties
from ..display import html_table
from ..errors import look_up
from ..forms.base import Form, as_forms
from ..forms.states import arrays_of, with_arrays

if TYPE_CHECKING:
    from ..results import ContactReport, SectionForces, Sections, Tractions

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
    time
        Time at the end: the durations of all stages so far.
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
    time: float = 0.0

    def _form(self, name: str) -> Any:
        return look_up(name, self.forms, f"form in stage '{self.name}'")

    def reactions(self) -> ndarray:
        """Forces of the supports, see :func:`~skfem_contact.reactions`."""
        from ..results import reactions  # what a stage shows stands above it, and is called from here for short

        return reactions(self.forms, self)

    def tractions(self, pair: str) -> Tractions:
        """Contact tractions of a pair, see :func:`~skfem_contact.tractions`."""
        from ..results import tractions

        return tractions(self._form(pair), self.states[pair])

    def report(self, pair: str) -> ContactReport:
        """Resultants and status of a contact pair, see :func:`~skfem_contact.contact_report`."""
        from ..results import contact_report

        form = self._form(pair)
        return contact_report(form, self.x[:form.size], self.states[pair])

    def section_forces(self, solid: str, sections: Sections) -> SectionForces:
        """Section forces of a body, see :func:`~skfem_contact.section_forces`."""
        from ..results import section_forces

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

    def _repr_html_(self) -> str:
        rows = [(s.name, len(s.iterations), sum(s.iterations), f"{s.residual:.1e}", f"{s.fraction:.0%}",
                 "; ".join(f"{k}: {v}" for k, v in s.summary.items() if v)) for s in self.stages]
        return html_table(("stage", "increments", "iterations", "residual", "load", "what the bodies carry"), rows)

    def save(self, file: str | Path) -> None:
        """Write all stages to one compressed file, from which :func:`load_result` resumes; it gets the end ``.npz``.

        A file of that name is replaced once the new one is complete.
        """
        arrays, stages = {}, []
        for i, stage in enumerate(self.stages):
            stages.append({"name": stage.name, "iterations": stage.iterations, "residual": stage.residual,
                           "fraction": stage.fraction, "time": stage.time, "summary": dict(stage.summary),
                           "forms": list(stage.states),
                           "meshes": {name: _fingerprint(form) for name, form in stage.forms.items()}})
            arrays[f"{i}/x"], arrays[f"{i}/load"] = stage.x, stage.load
            for name, state in stage.states.items():
                arrays |= {f"{i}/{name}/{key}": np.asarray(values) for key, values in arrays_of(state).items()}
        head = {"layout": _LAYOUT, "version": _version(), "stages": stages,
                "sums": {key: _checksum(values) for key, values in arrays.items()}}
        path = Path(_with_end(file))
        with NamedTemporaryFile(dir=path.parent, suffix=".npz", delete=False) as part:
            try:
                np.savez_compressed(part, head=np.array(json.dumps(head)), **arrays)  # type: ignore[arg-type]
            except BaseException:
                os.unlink(part.name)
                raise
        os.replace(part.name, path)


def _version() -> str:
    try:
        return version("skfem-contact")
    except PackageNotFoundError:  # not installed, but found in a folder
        return "unknown"


def _with_end(file: str | Path) -> str:
    return str(file) if str(file).endswith(".npz") else f"{file}.npz"


def _checksum(values: Any) -> int:
    return crc32(np.ascontiguousarray(values).tobytes())


def _fingerprint(form: Form) -> list[float]:
    """Numbers by which a mesh is known again: its nodes, and means of their places with uneven weights."""
    places = np.zeros((1, 0)) if form.basis is None else form.basis.doflocs
    places = places if form.nodes is None else form.nodes[1]
    weights = 1.0 + np.arange(places.shape[1]) % 7
    return [float(places.shape[1]), *(float(mean) for mean in places @ weights / max(weights.sum(), 1.0))]


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
        The file is no result or damaged, another version of this library wrote it, or it speaks of other forms or
        meshes.

    Examples
    --------
    >>> import os, tempfile
    >>> from skfem_contact import Result, load_result
    >>> file = os.path.join(tempfile.mkdtemp(), "empty.npz")
    >>> Result(()).save(file)
    >>> len(load_result(file, {}))
    0
    """
    path, given = _with_end(file), choose_penalties(forms)
    try:
        head, arrays = _contents(path)
        return Result(tuple(_stage_in(arrays, i, stage, given) for i, stage in enumerate(head["stages"])))
    except FileNotFoundError:
        raise
    except (ValueError, OSError, EOFError, BadZipFile, KeyError, TypeError) as error:
        raise ValueError(f"{path} cannot be read as a result of these forms: {error}") from error


def _contents(path: str) -> tuple[dict[str, Any], dict[str, ndarray]]:
    """What a file says of its stages, and its arrays, as they were written."""
    with np.load(path, allow_pickle=False) as data:
        head = json.loads(str(data["head"]))
        layout, writer = (head["layout"], head["version"]) if "layout" in head else (0, "0.1.0")
        if layout != _LAYOUT:
            raise ValueError(f"version {writer} of this library wrote it, with another layout than that of "
                             f"{_version()}: read it there, or compute it anew")
        arrays = {key: data[key] for key in head["sums"]}
    if damaged := [key for key, values in arrays.items() if _checksum(values) != head["sums"][key]]:
        raise ValueError(f"{damaged} are not what was written")
    return head, arrays


def _stage_in(arrays: Mapping[str, ndarray], i: int, head: Mapping[str, Any], given: Mapping[str, Form]) -> StageResult:
    """A stage of a file."""
    if not set(head["forms"]) <= set(given):
        raise ValueError(f"it holds the forms {head['forms']}, not {list(given)}")
    there = {name: given[name] for name in head["forms"]}  # those that were active
    states: dict[str, Any] = {}
    for name, form in there.items():
        if not np.allclose(head["meshes"].get(name, _fingerprint(form)), _fingerprint(form), rtol=1e-9, atol=0.0):
            raise ValueError(f"'{name}' stands on another mesh")
        initial = form.initial_state()
        found = {key: arrays[f"{i}/{name}/{key}"] for key in arrays_of(initial) if f"{i}/{name}/{key}" in arrays}
        if set(found) != set(arrays_of(initial)) or not form.fits(states.setdefault(name, with_arrays(initial, found))):
            raise ValueError(f"'{name}' is another form there: its mesh, its element or its settings differ")
    return StageResult(head["name"], arrays[f"{i}/x"], arrays[f"{i}/load"], states, tuple(head["iterations"]),
                       head["residual"], head["fraction"], head["summary"], there, head.get("time", 0.0))


def reset_displacements(forms: Mapping[str, Form], result: Result) -> Result:
    """Count displacements from the end of a result on: they become zero, and all that is carried stays.

    Contact has followed the bodies and comes back with them: a stage of the same load finds the equilibrium there.

    Parameters
    ----------
    forms
        The forms of the analysis; those that the last stage does not hold are left out.
    result
        Its result.

    Returns
    -------
    Result
        The same stages; the last one has no displacements.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))}
    >>> fixed = basis.get_dofs("bottom").all()
    >>> gravity = [sc.Stage("gravity", sc.weight(basis, 20.))]
    >>> start = sc.reset_displacements(forms, sc.run(forms, gravity, fixed))
    >>> bool(start["gravity"].x.any()), bool(start["gravity"].states["ground"].stress.any())
    (False, True)
    """
    last = result[-1]
    given = as_forms(forms)
    states = {name: look_up(name, given, "form").completed(given).rebased(last.x, state)
              for name, state in last.states.items()}
    x = np.zeros_like(last.x)
    for still in (each.numbers for form in given.values() for each in form.fields if not each.moves):
        x[still] = last.x[still]
    return Result((*result.stages[:-1], replace(last, x=x, states=states)))
