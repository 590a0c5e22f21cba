"""Files of results: one compressed archive, or records that are appended while an analysis runs."""

from __future__ import annotations

import io
import json
import os
import shutil
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, TypeVar
from uuid import uuid4
from zlib import crc32

import numpy as np
from numpy import ndarray
from skfem import Mesh, MeshTri1, MeshTri2
from typing_extensions import Self

from ..contact.base import ContactBase
from ..contact.laws import Status
from ..contact.penalty import choose_penalties
from ..errors import warn
from ..forms.base import Form, Forms, Outputs, States
from ..forms.roles import (
    Body,
    Couples,
    Touching,
    arrays_of,
    fits,
    materials_of,
    with_arrays,
)
from ..layout import Layout
from ..versions import own_version

#: Layout of saved arrays: another number for other states.
_LAYOUT = 2
#: Fields of a stage that are saved as text, by their keys in the head of a file. Older files lack
#: some of them: these fields have their defaults.
_TEXTS = {
    "name": "name",
    "iterations": "iterations",
    "residual": "residual",
    "fraction": "fraction",
    "time": "time",
    "summary": "summary",
    "water": "water",
    "water unit weight": "water_unit_weight",
    "remarks": "remarks",
    "seconds": "seconds",
    "next_step": "next_step",
    "gravity": "gravity",
}
#: Fields of a stage that are vectors, (N,), and the keys of the vectors of the increment before.
_VECTORS = ("x", "load", "unreleased", "velocity", "acceleration", "inertial")
_BEFORE = ("x before", "load before")
#: Parts of states that may hold NaN: memory of own laws, and of points of a slave that face no
#: facet.
_FREE = {"internal", "position", "stick_point", "gap", "clearance", "cuts"}
#: Parts of states, with defaults, that older files lack.
_ADDED = {"rate", "rounded"}
#: First bytes of a file of records.
_MAGIC = b"skfem-contact records\n"
#: Length and checksum before each record.
_PREFIX = struct.Struct("<QI")


@dataclass(frozen=True, repr=False)
class StageData:
    """Data at the end of a stage or increment, see :class:`~skfem_contact.results.StageResult`."""

    name: str
    x: ndarray
    load: ndarray
    states: States
    iterations: Sequence[int]
    residual: float
    fraction: float = 1.0
    summary: Mapping[str, str] = field(default_factory=dict)
    forms: Forms = field(default_factory=dict)
    time: float = 0.0
    increments: tuple[Self, ...] = ()
    unreleased: ndarray | None = None
    layout: Layout | None = None
    water: Any = None
    water_unit_weight: float | None = None
    placed: Mapping[str, ndarray] = field(default_factory=dict)
    next_step: float = np.inf
    remarks: tuple[str, ...] = ()
    seconds: float = 0.0
    changed: Forms = field(default_factory=dict)
    supports: ndarray | None = None
    supports_given: bool = False
    before: tuple[ndarray, ndarray, float] | None = None
    velocity: ndarray | None = None
    acceleration: ndarray | None = None
    inertial: ndarray | None = None
    series: Mapping[str, ndarray] = field(default_factory=dict)
    gravity: tuple[float, ...] | None = None
    new_mesh: Mesh | None = None

    def outputs(self, name: str) -> Outputs:
        """Return values of a form for tables and pictures, see :class:`skfem_contact.Outputs`."""
        form = self.forms[name]
        return form.outputs(self.x[: form.size], self.states[name])


_Stage = TypeVar("_Stage", bound=StageData)


class Append:
    """Observer of an analysis that appends every accepted increment to a file.

    :func:`~skfem_contact.load_result` reads the file at any time, also after the analysis was
    killed: a record that was not completed is ignored. Records of a stage that is run again replace
    the older ones. Where a record cannot be written, because the disk is full, the file ends with
    the record before.

    Parameters
    ----------
    file
        Name of the file; new records follow the existing ones.

    Warns
    -----
    AnalysisWarning
        A record of an existing file is damaged: new records follow the one before, and the file as
        it was is kept with the end ``.damaged``.

    Examples
    --------
    >>> import os, tempfile
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.))}
    >>> model = sc.Model(forms, basis.get_dofs("bottom").all())
    >>> result = model.run([sc.Stage("weight", sc.weight(basis, 20.))])
    >>> append = sc.results.Append(os.path.join(tempfile.mkdtemp(), "run.records"))
    >>> append(result["weight"])
    >>> len(sc.load_result(append.file, forms)["weight"].increments)
    1
    """

    def __init__(self, file: str | Path) -> None:
        self.file = Path(file)
        if self.file.exists() and self.file.stat().st_size > len(_MAGIC):
            with self.file.open("rb+") as stream:
                records, end, damaged = _records(stream)
                if damaged:
                    copy = self.file.with_name(f"{self.file.name}.damaged")
                    shutil.copyfile(self.file, copy)
                    warn(f"{_damage(self.file, records)}: new ones follow them, {copy} has all")
                stream.truncate(end)  # without a record that was not completed
        else:
            self.file.write_bytes(_MAGIC)

    def __call__(self, stage: StageData) -> None:
        """Append an increment; it is on the disk when the call returns."""
        payload = io.BytesIO()
        _write_arrays(payload, [replace(stage, increments=())])
        record = payload.getvalue()
        remaining = memoryview(_PREFIX.pack(len(record), crc32(record)) + record)
        with self.file.open("ab", buffering=0) as stream:
            end = stream.tell()
            try:
                while remaining:
                    remaining = remaining[stream.write(remaining) :]
                os.fsync(stream.fileno())
            except BaseException:
                stream.truncate(end)  # without a part of a record, behind which nothing is read
                raise


def write(file: str | Path, stages: Iterable[StageData]) -> None:
    """Write stages to one compressed archive, which replaces an older one once it is complete."""
    path = Path(os.path.realpath(_with_end(file)))
    part = path.with_name(f"{path.stem}.{uuid4().hex}.npz")
    try:
        with part.open("xb") as stream:
            _write_arrays(stream, stages)
        if path.exists():
            shutil.copymode(path, part)
        os.replace(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


#: Kinds of meshes of :func:`~skfem_contact.remeshed`, by their names in a file.
_MESHES = {kind.__name__: kind for kind in (MeshTri1, MeshTri2)}


class _Models:
    """Forms of the meshes of a file: of the given mesh, and of the meshes that follow in it."""

    def __init__(self, forms: Any, model_of: Callable[[Mesh], Any] | None) -> None:
        self._model_of = model_of
        self._known: list[tuple[Forms, Layout | None]] = []
        self._add(forms)

    def _add(self, model: Any) -> None:
        forms = choose_penalties(getattr(model, "forms", model))
        self._known.append((forms, getattr(model, "layout", None)))

    def follow(self, mesh: Mesh) -> None:
        """Make the forms of a new mesh."""
        if self._model_of is None:
            raise ValueError(
                "the run continued with new meshes: give model_of, the function of a mesh that "
                "returns the model on it"
            )
        self._add(self._model_of(mesh))

    def of(self, head: Mapping[str, Any]) -> tuple[Forms, Layout | None]:
        """Return forms and layout on the mesh of a stage: the last ones that fit, or the last."""
        for forms, layout in reversed(self._known):
            if set(head["forms"]) <= set(forms) and not _on_another_mesh(head, forms):
                return forms, layout
        return self._known[-1]


def read(
    file: str | Path,
    forms: Any,
    make: Callable[..., _Stage],
    model_of: Callable[[Mesh], Any] | None = None,
) -> tuple[_Stage, ...]:
    """Read the stages of a file, made by a class of stages."""
    path = str(file) if Path(file).is_file() else _with_end(file)
    given = _Models(forms, model_of)
    try:
        with open(path, "rb") as stream:
            if stream.read(len(_MAGIC)) != _MAGIC:
                return tuple(_read_arrays(path, given, make))
            records, _, damaged = _records(stream)
        if damaged:
            warn(_damage(path, records))
        increments: list[_Stage] = []
        # Each record is an archive of increments.
        for number, record in enumerate(records, 1):
            increments += _read_arrays(io.BytesIO(record), given, make, number == len(records))
        return _grouped(increments)
    except FileNotFoundError:
        raise
    except Exception as error:
        # Damage shows as errors of many kinds: of zip, zlib, json, memory or the system.
        raise ValueError(f"{path} cannot be read as a result of these forms: {error}") from error


def _records(stream: BinaryIO) -> tuple[list[bytes], int, bool]:
    """Return the records of a file before any damage, their end, and True if others follow it.

    A last record that is not complete is no damage.
    """
    # Check the first bytes.
    stream.seek(0)
    if stream.read(len(_MAGIC)) != _MAGIC:
        raise ValueError(f"{stream.name} is no file of appended increments: give it another name")

    # Read records up to the first one that is incomplete.
    records: list[bytes] = []
    end = len(_MAGIC)
    size = os.fstat(stream.fileno()).st_size
    while True:
        prefix = stream.read(_PREFIX.size)
        if len(prefix) < _PREFIX.size:
            break
        length, checksum = _PREFIX.unpack(prefix)
        record = stream.read(min(length, size))
        if len(record) < length:
            break
        if crc32(record) != checksum:
            return records, end, stream.tell() < size
        records.append(record)
        end = stream.tell()
    return records, end, False


def _damage(file: str | Path, records: list[bytes]) -> str:
    """Return a message on a damaged record, and on the ones that are read."""
    return (
        f"record {len(records)} of {file} is not what was written: only the {len(records)} "
        "records before it are read"
    )


def _grouped(increments: list[_Stage]) -> tuple[_Stage, ...]:
    """Return the last increment of every stage, with all of them as its increments."""
    stages: dict[str, list[_Stage]] = {}
    for increment in increments:
        name = increment.name
        names = list(stages)
        if increment.new_mesh is not None and names and stages[names[-1]][-1].fraction < 1.0:
            # The stage failed, and began anew on this mesh.
            del stages[names.pop()]
        if name in stages:
            # Along a path the load may fall, but the list of iterations grows.
            last = stages[name][-1]
            grows = len(increment.iterations) > len(last.iterations)
            advances = grows or increment.fraction > last.fraction
            if name != names[-1] or not advances:
                # The stage was run again: drop the older run and all stages behind it.
                stages = {key: stages[key] for key in names[: names.index(name)]}
        stages.setdefault(name, []).append(increment)
    return tuple(replace(parts[-1], increments=tuple(parts)) for parts in stages.values())


def _write_arrays(stream: Any, stages: Iterable[StageData]) -> None:
    """Write stages as a compressed archive with checksums."""
    arrays: dict[str, ndarray] = {}
    heads = [_described(stage, str(i), arrays) for i, stage in enumerate(stages)]
    head = {
        "layout": _LAYOUT,
        "version": own_version(),
        "stages": heads,
        "sums": {key: _checksum(values) for key, values in arrays.items()},
    }
    np.savez_compressed(stream, head=np.array(json.dumps(head)), **arrays)  # type: ignore[arg-type]


def _described(stage: StageData, key: str, arrays: dict[str, ndarray]) -> dict[str, Any]:
    """Return the head of a stage, and add the arrays of the stage and of its increments."""
    # Collect the vectors; increments find the increment before in the file.
    is_stage = "." not in key
    for name, vector in _vectors_of(stage, with_before=is_stage).items():
        arrays[f"{key}/{name}"] = vector

    # Collect the parts of the states.
    for name, state in stage.states.items():
        for part, values in arrays_of(state).items():
            arrays[f"{key}/{name}/{part}"] = np.asarray(values)

    # Describe the stage, its forms and its increments.
    head = {text: getattr(stage, name) for text, name in _TEXTS.items()}
    head["iterations"] = list(stage.iterations)
    head["summary"] = dict(stage.summary)
    head["water"] = _in_words(stage.water)
    head["forms"] = list(stage.states)
    head["meshes"] = {}
    head["settings"] = {}
    head["parameters"] = {}
    head["penalties"] = {}
    for name, form in stage.forms.items():
        head["meshes"][name] = _fingerprint(form)
        head["settings"][name] = _settings(form)
        head["parameters"][name] = _parameters_of(form)
        if isinstance(form, ContactBase) and form.penalty is not None:
            head["penalties"][name] = [*form.penalty, form.stiffness]
    for name, values in stage.series.items():
        arrays[f"{key}/series of {name}"] = values
    head["series"] = list(stage.series)
    if stage.new_mesh is not None:
        head["new mesh"] = _described_mesh(stage.new_mesh, f"{key}/new mesh", arrays)
    if stage.supports is not None:
        arrays[f"{key}/supports"] = np.asarray(stage.supports)
        head["supports given"] = stage.supports_given
    head["placed"] = list(stage.placed)
    head["time before"] = 0.0 if stage.before is None else stage.before[2]
    head["increments"] = []
    for k, increment in enumerate(stage.increments):
        head["increments"].append(_described(increment, f"{key}.{k}", arrays))
    return head


def _described_mesh(mesh: Mesh, key: str, arrays: dict[str, ndarray]) -> dict[str, Any]:
    """Return the head of a mesh, and add its arrays."""
    arrays[f"{key}/nodes"] = mesh.doflocs
    arrays[f"{key}/elements"] = mesh.t
    groups = {"boundaries": mesh.boundaries or {}, "subdomains": mesh.subdomains or {}}
    for kind, members in groups.items():
        for name, numbers in members.items():
            arrays[f"{key}/{kind}/{name}"] = np.asarray(numbers)
    named = {kind: list(members) for kind, members in groups.items()}
    return {"kind": type(mesh).__name__, **named}


def _mesh(arrays: Mapping[str, ndarray], key: str, head: Mapping[str, Any]) -> Mesh:
    """Make a mesh of its head and arrays; the inverse of :func:`_described_mesh`."""
    groups = {}
    for kind in ("boundaries", "subdomains"):
        groups[f"_{kind}"] = {name: arrays[f"{key}/{kind}/{name}"] for name in head[kind]}
    return _MESHES[head["kind"]](arrays[f"{key}/nodes"], arrays[f"{key}/elements"], **groups)


def _vectors_of(stage: StageData, with_before: bool) -> dict[str, ndarray]:
    """Return the vectors of a stage by their names in a file."""
    vectors = {name: getattr(stage, name) for name in _VECTORS}
    if with_before and stage.before is not None:
        vectors |= zip(_BEFORE, stage.before[:2], strict=True)
    for name, vector in stage.placed.items():
        vectors[f"placed of {name}"] = vector
    return {name: vector for name, vector in vectors.items() if vector is not None}


def _read_arrays(
    source: Any, given: _Models, make: Callable[..., _Stage], ends: bool = True
) -> list[_Stage]:
    """Read the stages of an archive, with the last one of a file where it `ends`."""
    with np.load(source, allow_pickle=False) as data:
        head = _head_of(data)
        arrays = {key: data[key] for key in head["sums"]}
    damaged = [key for key, values in arrays.items() if _checksum(values) != head["sums"][key]]
    if damaged:
        raise ValueError(f"{damaged} are not what was written")

    # Make the stages, each of the forms on its mesh.
    stages = []
    for i, part in enumerate(head["stages"]):
        mesh = None
        if "new mesh" in part:
            mesh = _mesh(arrays, f"{i}/new mesh", part["new mesh"])
            given.follow(mesh)
        forms, layout = given.of(part)
        stage = _stage(arrays, str(i), part, forms, partial(make, layout=layout))
        stages.append(replace(stage, new_mesh=mesh))
    if stages and ends:
        _warn_of_other_members(head["stages"][-1], stages[-1].forms)
    return stages


def _head_of(data: Mapping[str, ndarray]) -> dict[str, Any]:
    """Return the head of an archive; refuse other layouts."""
    head: dict[str, Any] = json.loads(str(data["head"]))
    # The head of version 0.1.0 is a list of stages.
    is_old = "layout" not in head
    if is_old or head["layout"] != _LAYOUT:
        writer = "0.1.0" if is_old else head["version"]
        raise ValueError(
            f"version {writer} of this library wrote it, with another layout than that of "
            f"{own_version()}: read it there, or compute it anew"
        )
    return head


def _stage(
    arrays: Mapping[str, ndarray],
    key: str,
    head: Mapping[str, Any],
    given: Forms,
    make: Callable[..., _Stage],
) -> _Stage:
    """Make a stage of its head and arrays; the inverse of :func:`_described`."""
    # Read the states of the given forms.
    states = _states(arrays, key, head, given)
    forms = {name: _as_run(given[name], head, name) for name in states}
    if "." not in key:
        _warn_of_other_settings(head, forms)

    # Read the vectors.
    vectors = _known_arrays(arrays, key, (*_VECTORS, *_BEFORE))
    placed = {name: arrays[f"{key}/placed of {name}"] for name in head.get("placed", ())}
    _check_vectors(head["name"], vectors | placed, forms)
    before = None
    if vectors.keys() >= {*_BEFORE}:
        before = (*(vectors.pop(name) for name in _BEFORE), head["time before"])

    series = {name: arrays[f"{key}/series of {name}"] for name in head.get("series", ())}
    supports = arrays.get(f"{key}/supports")  # older files have none
    _check_supports(head["name"], supports, len(vectors["x"]))

    # Read the texts and the increments.
    texts = _texts_of(head)
    increments = []
    for k, part in enumerate(head.get("increments", ())):
        increments.append(_stage(arrays, f"{key}.{k}", part, given, make))
    return make(
        states=states,
        forms=forms,
        placed=placed,
        before=before,
        series=series,
        supports=supports,
        supports_given=head.get("supports given", False),
        increments=tuple(increments),
        **vectors,
        **texts,
    )


def _as_run(form: Form, head: Mapping[str, Any], name: str) -> Form:
    """Return a form with the penalty that the run chose, where no model brought its supports."""
    chosen = head.get("penalties", {}).get(name)  # older files have none
    if chosen is None or not isinstance(form, ContactBase) or not form.awaits_supports:
        return form
    normal, tangential, stiffness = chosen
    if form.given_penalty is not None:
        normal, tangential = form.given_penalty
    return form.with_penalty(normal, tangential, stiffness=stiffness)


def _states(
    arrays: Mapping[str, ndarray], key: str, head: Mapping[str, Any], given: Forms
) -> dict[str, Any]:
    """Make the states of the forms of a stage, and check that they fit to the given forms."""
    if not set(head["forms"]) <= set(given):
        raise ValueError(f"it holds the forms {head['forms']}, not {list(given)}")
    others = _on_another_mesh(head, given)
    if others:
        raise ValueError(
            f"'{others[0]}' has another mesh, or another order of the elements, which follow its "
            "materials"
        )
    states = {}
    for name in head["forms"]:
        states[name] = _state(name, given[name], arrays, f"{key}/{name}")
    return states


def _on_another_mesh(head: Mapping[str, Any], given: Forms) -> list[str]:
    """Return the forms of a stage whose mesh is not the one of the given forms."""
    others = []
    for name in head["forms"]:
        # Files of older versions identify no elements.
        both = zip(head["meshes"].get(name, ()), _fingerprint(given[name]), strict=False)
        if not all(np.isclose(a, b, rtol=1e-9, atol=0.0) for a, b in both):
            others.append(name)
    return others


def _known_arrays(
    arrays: Mapping[str, ndarray], key: str, names: Iterable[str]
) -> dict[str, ndarray]:
    """Return the arrays of a key that the file has, by name."""
    found = {}
    for name in names:
        if f"{key}/{name}" in arrays:
            found[name] = arrays[f"{key}/{name}"]
    return found


def _texts_of(head: Mapping[str, Any]) -> dict[str, Any]:
    """Return the texts and figures of a stage; lists become tuples."""
    texts = {name: head[text] for text, name in _TEXTS.items() if text in head}
    texts["iterations"] = tuple(texts.get("iterations", ()))
    texts["remarks"] = tuple(texts.get("remarks", ()))
    if texts.get("gravity") is not None:
        texts["gravity"] = tuple(texts["gravity"])
    return texts


def _state(name: str, form: Form, arrays: Mapping[str, ndarray], key: str) -> Any:
    """Make the state of a form of its arrays."""
    # Take the parts that the form expects; one that lacks a part is another form.
    initial = form.initial_state()
    parts = _known_arrays(arrays, key, arrays_of(initial))
    saved = [part for part in arrays if part.startswith(f"{key}/")]
    expected = set(arrays_of(initial)) - (_ADDED - set(parts))
    is_complete = len(parts) == len(expected) == len(saved)
    state = with_arrays(initial, parts) if is_complete else None
    if not is_complete or not fits(form, state):
        raise ValueError(
            f"'{name}' is another form there: its mesh, its element or its settings differ"
        )
    # Numbers must be finite, but where a state leaves them free.
    if materials_of(form) or isinstance(form, Touching):
        filled = {part: values for part, values in parts.items() if part not in _FREE}
        _check_numbers(f"'{name}'", filled)
    return state


def _warn_of_other_settings(head: Mapping[str, Any], forms: Forms) -> None:
    """Report given forms that have other materials or laws than the saved ones."""
    saved = head.get("settings", {})
    others = []
    for name, form in forms.items():
        if not _alike(saved.get(name), _settings(form)):
            others.append(name)
    if others:
        warn(
            f"stage '{head['name']}' was computed with other materials or laws of "
            f"{', '.join(map(repr, others))} than those given, with which mobilised strength is "
            "computed and runs continue: files hold states alone"
        )


def _warn_of_other_members(head: Mapping[str, Any], forms: Forms) -> None:
    """Report given structures whose parameters differ from the last ones of a file."""
    saved = head.get("parameters", {})
    others = []
    for name, form in forms.items():
        if not _alike(saved.get(name), _parameters_of(form)):
            others.append(name)
    if others:
        warn(
            f"the file ends with other parameters of {', '.join(map(repr, others))} than those "
            "given, with which runs continue: files hold states alone, so give a jack, a "
            "temperature or a stiffness of a stage again by Stage(change=...)"
        )


def _check_vectors(stage: str, vectors: Mapping[str, ndarray], forms: Forms) -> None:
    """Raise a ``ValueError`` where vectors of a stage differ in shape or are too short."""
    _check_numbers("the stage", vectors)
    shapes = {np.shape(values) for values in vectors.values()}
    x = vectors["x"]
    least = max([0, *(form.size or 0 for form in forms.values())])
    if len(shapes) > 1 or x.ndim != 1 or len(x) < least:
        raise ValueError(f"stage '{stage}' has displacements and loads of shapes {sorted(shapes)}")


def _check_supports(stage: str, supports: ndarray | None, size: int) -> None:
    """Raise a ``ValueError`` where supports are no dofs."""
    if supports is None:
        return
    if supports.ndim != 1 or supports.dtype.kind != "i" or not np.isin(supports, range(size)).all():
        raise ValueError(f"stage '{stage}' has supports that are no dofs of its {size}")


def _check_numbers(whose: str, arrays: Mapping[str, Any]) -> None:
    """Raise a ``ValueError`` where values are not finite or no status of contact is known."""
    for part, values in arrays.items():
        kind = np.asarray(values).dtype.kind
        if kind not in "biuf" or not np.isfinite(values).all():
            raise ValueError(f"'{part}' of {whose} has values that are not finite numbers")
        if part == "status" and not np.isin(values, list(Status)).all():
            raise ValueError(
                f"'status' of {whose} has values other than {[int(status) for status in Status]}"
            )


def _in_words(water: Any) -> Any:
    """Return water as numbers and lists; functions are not saved, but a text that stages refuse."""
    try:
        return json.loads(json.dumps(water, default=np.ndarray.tolist))
    except TypeError:
        return "a function or a seepage, which files do not hold"


def _with_end(file: str | Path) -> str:
    if str(file).endswith(".npz"):
        return str(file)
    return f"{file}.npz"


def _checksum(values: Any) -> int:
    return crc32(np.ascontiguousarray(values).tobytes())


def _fingerprint(form: Form) -> list[float]:
    """Return numbers that identify a mesh: numbers and weighted means of nodes and elements."""
    coordinates = np.zeros((1, 0))
    if isinstance(form, Body):
        coordinates = form.basis.doflocs
    elif isinstance(form, Couples) and form.nodes is not None:
        coordinates = form.nodes[1]
    result = _means(coordinates, 1.0 + np.arange(coordinates.shape[1]) % 7)
    if isinstance(form, Body):
        # Give all elements different weights, so that swapped regions are noticed.
        centres = coordinates[:, form.basis.element_dofs].mean(axis=1)
        result += _means(centres, np.sqrt(1.0 + np.arange(centres.shape[1])))
    return result


def _settings(form: Form) -> list[float]:
    """Return numbers that identify the materials of a solid, or the law of a contact pair."""
    laws = list(materials_of(form).values())
    if not laws:
        laws = [form.law if isinstance(form, Touching) else None]
    numbers = []
    for law in laws:
        numbers += _parameters(law)
    return numbers


def _parameters_of(form: Form) -> list[float]:
    """Return the numbers among the parameters of a structure."""
    return _numbers_in(getattr(form, "parameters", {}).values())


def _parameters(thing: Any) -> list[float]:
    """Return a number of the kind of a material or law and its parameters; functions have none."""
    result = [float(crc32(type(thing).__name__.encode()))]
    if not is_dataclass(thing):
        return result
    return result + _numbers_in(getattr(thing, part.name) for part in fields(thing))


def _numbers_in(values: Iterable[Any]) -> list[float]:
    """Return the numbers of values: arrays have their means, functions none."""
    result = []
    for value in values:
        if is_dataclass(value):
            result += _parameters(value)
        elif isinstance(value, (int, float, ndarray)):
            numbers = np.ravel(value)[None].astype(float)
            result += _means(numbers, np.sqrt(1.0 + np.arange(np.size(value))))
    return result


def _alike(saved: list[float] | None, now: list[float]) -> bool:
    """Return True if numbers are the same, or older files have none."""
    if saved is None:
        return True
    return len(saved) == len(now) and np.allclose(saved, now, rtol=1e-9, atol=0.0, equal_nan=True)


def _means(coordinates: ndarray, weights: ndarray) -> list[float]:
    """Return the number of points, (dim, n), and weighted means of their coordinates."""
    means = coordinates @ weights / max(weights.sum(), 1.0)
    return [float(coordinates.shape[1]), *means.tolist()]
