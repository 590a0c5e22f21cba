"""Files of results: one compressed archive, or records that are appended while an analysis runs."""

from __future__ import annotations

import io
import json
import os
import shutil
import struct
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, TypeVar
from uuid import uuid4
from zlib import crc32

import numpy as np
from numpy import ndarray
from typing_extensions import Self

from ..contact.laws import Status
from ..contact.penalty import choose_penalties
from ..errors import warn
from ..forms.base import Form
from ..forms.staged import arrays_of, with_arrays
from ..layout import Layout
from ..versions import own_version

#: Layout of saved arrays: another number for other states.
_LAYOUT = 2
#: Parts of states that may hold NaN: memory of own laws, and of points of a slave that face no
#: facet.
_FREE = {"internal", "position", "stick_point", "gap", "clearance", "cuts"}
#: First bytes of a file of records, and the length and checksum before each of them.
_MAGIC, _PREFIX = b"skfem-contact records\n", struct.Struct("<QI")


@dataclass(frozen=True)
class StageData:
    """Data at the end of a stage or of an increment; :class:`~skfem_contact.results.StageResult`
    documents them.
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
    increments: tuple[Self, ...] = field(default=(), repr=False)
    unreleased: ndarray | None = field(default=None, repr=False)
    layout: Layout | None = field(default=None, repr=False)
    water: Any = field(default=None, repr=False)
    water_unit_weight: float | None = field(default=None, repr=False)
    placed: Mapping[str, ndarray] = field(default_factory=dict, repr=False)
    next_step: float = np.inf
    remarks: tuple[str, ...] = field(default=(), repr=False)
    seconds: float = field(default=0.0, repr=False)
    changed: Mapping[str, Form] = field(default_factory=dict, repr=False)
    supports: ndarray | None = field(default=None, repr=False)
    before: tuple[ndarray, ndarray, float] | None = field(default=None, repr=False)


_Stage = TypeVar("_Stage", bound=StageData)


class Append:
    """Observer of an analysis that appends every accepted increment to a file.

    :func:`~skfem_contact.load_result` reads the file at any time, also after the analysis was
    killed: a record that was not completed is ignored. Records of a stage that is run again replace
    the older ones.

    Parameters
    ----------
    file
        Name of the file; records are appended to those that it holds.

    Examples
    --------
    >>> import os, tempfile
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.))}
    >>> result = sc.Model(forms, basis.get_dofs("bottom").all()).run([sc.Stage("weight", sc.weight(basis, 20.))])
    >>> append = sc.results.Append(os.path.join(tempfile.mkdtemp(), "run.records"))
    >>> append(result["weight"])
    >>> len(sc.load_result(append.file, forms)["weight"].increments)
    1
    """

    def __init__(self, file: str | Path) -> None:
        self.file = Path(file)
        if self.file.exists() and self.file.stat().st_size > len(_MAGIC):
            with self.file.open("rb+") as stream:
                stream.truncate(_records(stream)[1])  # without a record that was not completed
        else:
            self.file.write_bytes(_MAGIC)

    def __call__(self, stage: StageData) -> None:
        """Append an increment; it is on the disk when the call returns."""
        payload = io.BytesIO()
        _write_arrays(payload, [replace(stage, increments=())])
        record = payload.getvalue()
        with self.file.open("ab") as stream:
            stream.write(_PREFIX.pack(len(record), crc32(record)) + record)
            stream.flush()
            os.fsync(stream.fileno())


def write(file: str | Path, stages: Iterable[StageData]) -> None:
    """Write stages to one compressed archive, which replaces an older one of the same mode once it
    is complete.
    """
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


def read(file: str | Path, forms: Any, make: Callable[..., _Stage]) -> tuple[_Stage, ...]:
    """Read the stages of a file, made by a class of stages."""
    path = str(file) if Path(file).is_file() else _with_end(file)
    given, layout = choose_penalties(getattr(forms, "forms", forms)), getattr(forms, "layout", None)
    make = partial(make, layout=layout)
    try:
        with open(path, "rb") as stream:
            appended = stream.read(len(_MAGIC)) == _MAGIC
            records = _records(stream)[0] if appended else []
        if appended:
            return _grouped(
                [
                    stage
                    for record in records
                    for stage in _read_arrays(io.BytesIO(record), given, make)
                ]
            )
        return tuple(_read_arrays(path, given, make))
    except FileNotFoundError:
        raise
    except (
        Exception
    ) as error:  # damage shows as errors of many kinds: of zip, zlib, json, memory or the system
        raise ValueError(f"{path} cannot be read as a result of these forms: {error}") from error


def _records(stream: BinaryIO) -> tuple[list[bytes], int]:
    """Return the complete records of a file, and the position behind the last one."""
    stream.seek(0)
    if stream.read(len(_MAGIC)) != _MAGIC:
        raise ValueError(f"{stream.name} is no file of appended increments: give it another name")
    records: list[bytes] = []
    end = len(_MAGIC)
    size = os.fstat(stream.fileno()).st_size
    while len(prefix := stream.read(_PREFIX.size)) == _PREFIX.size:
        length, checksum = _PREFIX.unpack(prefix)
        record = stream.read(min(length, size))
        if len(record) < length or (crc32(record) != checksum and stream.tell() == size):
            break
        if crc32(record) != checksum:
            raise ValueError(f"record {len(records)} is not what was written")
        records.append(record)
        end = stream.tell()
    return records, end


def _grouped(increments: list[_Stage]) -> tuple[_Stage, ...]:
    """Return the last increment of every stage, with all of them as its increments."""
    stages: dict[str, list[_Stage]] = {}
    for increment in increments:
        name = increment.name
        if name in stages and (
            name != next(reversed(stages)) or increment.fraction <= stages[name][-1].fraction
        ):
            names = list(
                stages
            )  # the stage was run again: the older one and those behind it do not count
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
    """Return what describes a stage, and add its arrays and those of its increments."""
    arrays[f"{key}/x"], arrays[f"{key}/load"] = stage.x, stage.load
    if stage.unreleased is not None:
        arrays[f"{key}/unreleased"] = stage.unreleased
    if (
        stage.before is not None and "." not in key
    ):  # those of kept increments are the increments before
        arrays[f"{key}/x before"], arrays[f"{key}/load before"] = stage.before[:2]
    arrays |= {f"{key}/placed of {name}": x for name, x in stage.placed.items()}
    for name, state in stage.states.items():
        arrays |= {
            f"{key}/{name}/{part}": np.asarray(values) for part, values in arrays_of(state).items()
        }
    return {
        "name": stage.name,
        "iterations": stage.iterations,
        "residual": stage.residual,
        "fraction": stage.fraction,
        "time": stage.time,
        "summary": dict(stage.summary),
        "forms": list(stage.states),
        "meshes": {name: _fingerprint(form) for name, form in stage.forms.items()},
        "settings": {name: _settings(form) for name, form in stage.forms.items()},
        "water": _in_words(stage.water),
        "water unit weight": stage.water_unit_weight,
        "placed": list(stage.placed),
        "remarks": stage.remarks,
        "seconds": stage.seconds,
        "next_step": stage.next_step,
        "time before": stage.before[2] if stage.before else 0.0,
        "increments": [
            _described(part, f"{key}.{k}", arrays) for k, part in enumerate(stage.increments)
        ],
    }


def _read_arrays(
    source: Any, given: Mapping[str, Form], make: Callable[..., _Stage]
) -> list[_Stage]:
    """Read the stages of an archive."""
    with np.load(source, allow_pickle=False) as data:
        head = json.loads(str(data["head"]))
        layout, writer = (head["layout"], head["version"]) if "layout" in head else (0, "0.1.0")
        if layout != _LAYOUT:
            raise ValueError(
                f"version {writer} of this library wrote it, with another layout than that of "
                f"{own_version()}: read it there, or compute it anew"
            )
        arrays = {key: data[key] for key in head["sums"]}
    if damaged := [key for key, values in arrays.items() if _checksum(values) != head["sums"][key]]:
        raise ValueError(f"{damaged} are not what was written")
    return [_stage(arrays, str(i), stage, given, make) for i, stage in enumerate(head["stages"])]


def _stage(
    arrays: Mapping[str, ndarray],
    key: str,
    head: Mapping[str, Any],
    given: Mapping[str, Form],
    make: Callable[..., _Stage],
) -> _Stage:
    """Make a stage of its description and arrays."""
    if not set(head["forms"]) <= set(given):
        raise ValueError(f"it holds the forms {head['forms']}, not {list(given)}")
    forms = {name: given[name] for name in head["forms"]}
    states: dict[str, Any] = {}
    for name, form in forms.items():
        both = zip(
            head["meshes"].get(name, ()), _fingerprint(form), strict=False
        )  # older files: without elements
        if not all(np.isclose(a, b, rtol=1e-9, atol=0.0) for a, b in both):
            raise ValueError(
                f"'{name}' has another mesh, or another order of the elements, which follow its "
                f"materials"
            )
        initial = form.initial_state()
        keys = {part: f"{key}/{name}/{part}" for part in arrays_of(initial)}
        parts = {part: arrays[path] for part, path in keys.items() if path in arrays}
        if set(parts) != set(arrays_of(initial)) or not form.fits(
            states.setdefault(name, with_arrays(initial, parts))
        ):
            raise ValueError(
                f"'{name}' is another form there: its mesh, its element or its settings differ"
            )
        if form.materials or form.law is not None:
            _check_numbers(
                f"'{name}'", {k: a for k, a in arrays_of(states[name]).items() if k not in _FREE}
            )
    if (
        others := [
            name
            for name, form in forms.items()
            if not _alike(head.get("settings", {}).get(name), _settings(form))
        ]
    ) and "." not in key:
        warn(
            f"stage '{head['name']}' was computed with other materials or laws of "
            f"{', '.join(map(repr, others))} than "
            "those given, with which mobilised strength is computed and runs continue: files hold "
            "states alone"
        )
    vectors = {
        part: arrays[f"{key}/{part}"]
        for part in ("x", "load", "unreleased", "x before", "load before")
        if f"{key}/{part}" in arrays
    }
    before = tuple(vectors[part] for part in ("x before", "load before") if part in vectors)
    placed = {name: arrays[f"{key}/placed of {name}"] for name in head.get("placed", ())}
    _check_numbers("the stage", {**vectors, **placed})
    shapes = {np.shape(values) for values in (*vectors.values(), *placed.values())}
    x = vectors["x"]
    if len(shapes) > 1 or x.ndim != 1 or any(len(x) < (form.size or 0) for form in forms.values()):
        raise ValueError(
            f"stage '{head['name']}' has displacements and loads of shapes {sorted(shapes)}"
        )
    increments = tuple(
        _stage(arrays, f"{key}.{k}", part, given, make)
        for k, part in enumerate(head.get("increments", ()))
    )
    return make(
        head["name"],
        x,
        vectors["load"],
        states,
        tuple(head["iterations"]),
        head["residual"],
        head["fraction"],
        head["summary"],
        forms,
        head.get("time", 0.0),
        increments,
        vectors.get("unreleased"),
        water=head.get("water"),
        water_unit_weight=head.get("water unit weight"),
        placed=placed,
        next_step=head.get("next_step", np.inf),
        remarks=tuple(head.get("remarks", ())),
        seconds=head.get("seconds", 0.0),
        before=(*before, head["time before"]) if before else None,
    )


def _check_numbers(whose: str, arrays: Mapping[str, Any]) -> None:
    """Raise a ``ValueError`` where values are not finite numbers, or a contact point has no known
    status.
    """
    for part, values in arrays.items():
        kind = np.asarray(values).dtype.kind
        if kind not in "biuf" or not np.isfinite(values).all():
            raise ValueError(f"'{part}' of {whose} has values that are not finite numbers")
        if part == "status" and not np.isin(values, list(Status)).all():
            raise ValueError(
                f"'status' of {whose} has values other than {[int(status) for status in Status]}"
            )


def _in_words(water: Any) -> Any:
    """Return levels and pressures of water as lists; functions are not saved, but a text that
    stages refuse.
    """
    try:
        return json.loads(json.dumps(water, default=np.ndarray.tolist))
    except TypeError:
        return "a function or a seepage, which files do not hold"


def _with_end(file: str | Path) -> str:
    return str(file) if str(file).endswith(".npz") else f"{file}.npz"


def _checksum(values: Any) -> int:
    return crc32(np.ascontiguousarray(values).tobytes())


def _fingerprint(form: Form) -> list[float]:
    """Return numbers that identify a mesh: nodes and elements, and means of their coordinates with
    uneven weights.
    """
    coordinates = np.zeros((1, 0)) if form.basis is None else form.basis.doflocs
    coordinates = coordinates if form.nodes is None else form.nodes[1]
    found = _means(coordinates, 1.0 + np.arange(coordinates.shape[1]) % 7)
    if form.nodes is not None or form.basis is None:
        return found
    centres = coordinates[:, form.basis.element_dofs].mean(axis=1)
    return found + _means(
        centres, np.sqrt(1.0 + np.arange(centres.shape[1]))
    )  # none alike: regions may swap


def _settings(form: Form) -> list[float]:
    """Return numbers that identify the materials of a solid, or the law of a contact pair."""
    laws = list(form.materials.values()) if form.materials else [form.law]
    return [number for law in laws for number in _parameters(law)]


def _parameters(thing: Any) -> list[float]:
    """Return the parameters of a material or law by its fields, behind a number of its kind;
    functions have none.
    """
    found = [float(crc32(type(thing).__name__.encode()))]
    for name in (part.name for part in fields(thing)) if is_dataclass(thing) else ():
        value = getattr(thing, name)
        if is_dataclass(value):
            found += _parameters(value)
        elif isinstance(value, (int, float, ndarray)):
            found += _means(
                np.ravel(value)[None].astype(float), np.sqrt(1.0 + np.arange(np.size(value)))
            )
    return found


def _alike(saved: list[float] | None, now: list[float]) -> bool:
    """Return True if numbers are the same, or older files have none."""
    return saved is None or (
        len(saved) == len(now) and np.allclose(saved, now, rtol=1e-9, atol=0.0, equal_nan=True)
    )


def _means(coordinates: ndarray, weights: ndarray) -> list[float]:
    """Return the number of points, (dim, n), and weighted means of their coordinates."""
    return [
        float(coordinates.shape[1]),
        *(float(mean) for mean in coordinates @ weights / max(weights.sum(), 1.0)),
    ]
