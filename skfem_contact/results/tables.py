"""Tables of results: forces along a form, and one row for each stage."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from numpy import ndarray

from ..checks import format_point, look_up
from ..contact.laws import Status
from ..display import Table
from ..forms.base import Form, solids_of
from .cuts import SectionForces, Sections
from .fields import basis_of, nodal_field
from .files import StageData
from .sections import section_forces
from .tractions import tractions

#: Columns of contact tractions.
_CONTACT = ("arc", "x", "y", "z", "pressure", "shear", "gap", "slip", "status")
#: Columns whose largest values the table of all stages has.
_FORCES = ("N", "V", "M", "T", "N_hoop", "M_hoop", "pressure", "shear", "force", "skin")
#: Magnitudes that differ by less than this share are equal: the first of them counts.
_EQUAL = 1e-6
#: Coordinates are zero below this share of the largest one.
_ZERO = 1e-12


@dataclass(frozen=True)
class Envelope:
    """Smallest and largest section forces over stages, whose names are ``stages["M"]``, (2, n);
    printed as a table.
    """

    smallest: SectionForces
    largest: SectionForces
    stages: dict[str, Any]

    @classmethod
    def of(cls, forces: Mapping[str, SectionForces]) -> Envelope:
        """Return the envelope of section forces by the names of their stages."""
        if any(part.axis is not None for part in forces.values()):
            raise ValueError(
                "section forces in space are vectors: an envelope is that of one plane of bending, "
                "results.Envelope.of({stage.name: stage.section_forces(...).towards((1, 0, 0)), "
                "...})"
            )
        names, first = np.array(list(forces)), next(iter(forces.values()))
        values = {
            key: np.array([getattr(part, key) for part in forces.values()]) for key in first.names
        }
        low, high = (
            {key: v[at(v, axis=0), range(v.shape[1])] for key, v in values.items()}
            for at in (np.argmin, np.argmax)
        )
        stages = {
            key: names[np.array([v.argmin(axis=0), v.argmax(axis=0)])] for key, v in values.items()
        }
        return cls(replace(first, **low), replace(first, **high), stages)

    def __str__(self) -> str:
        both = enumerate((self.smallest, self.largest))
        ends = [
            (key, getattr(part, key), k) for key, (k, part) in product(self.smallest.names, both)
        ]
        return "\n".join(
            f"{key} {v[i]:10.4g} at {self.smallest.position[i]:<8.4g} {self.stages[key][k, i]}"
            for key, v, k in ends
            for i in [v.argmax() if k else v.argmin()]
        )


def of_form(stage: StageData, name: str, sections: Sections | None = None) -> Table:
    """Return the forces along a form as a table, see
    :meth:`~skfem_contact.results.StageResult.table`.
    """
    form = look_up(name, stage.forms, f"form in stage '{stage.name}'")
    along = _along(form, stage.states[name], sections)
    if not along:
        others = [
            key
            for key, other in stage.forms.items()
            if key != name and _along(other, stage.states[key], None)
        ]
        raise ValueError(
            f"'{name}' is a {type(form).__name__}, which has no forces for a table; give "
            f"`sections` of a "
            f"solid, or one of {others}"
        )
    columns = {
        f"{key} {axis}" if np.ndim(values) == 2 else key: part
        for key, values in along.items()
        if key != "axis"
        for axis, part in zip("xyz", np.atleast_2d(np.transpose(values)))
    }
    return Table.of(columns, f"{name}, {stage.name}")


def of_stages(
    stages: Collection[StageData],
    names: Collection[str],
    sections: Mapping[str, Sections],
    searches: Mapping[str, Any],
) -> Table:
    """Return one row for each stage, see :meth:`~skfem_contact.results.Result.table`."""
    there = {name: form for stage in stages for name, form in stage.forms.items()}
    for name in (*names, *sections):
        if look_up(name, there, "form").materials and name not in sections:
            raise ValueError(
                f"'{name}' is a {type(there[name]).__name__}: give sections={{'{name}': "
                f"Sections.line()}}"
            )
    for name, found in searches.items():
        look_up(name, {stage.name: stage for stage in stages}, "stage")
        if getattr(found, "stop", None) is None:
            raise ValueError(
                f"searches are results of strength_reduction or limit_load, not {found!r}"
            )
    chosen = names or [name for name, form in there.items() if form.law is None]
    rows = [
        _row(
            stage, [*chosen, *(name for name in sections if name not in chosen)], sections, searches
        )
        for stage in stages
    ]
    head = dict.fromkeys(key for row in rows for key in row)
    nothing = [key for key in head if f"{key} at" in head and not any(row.get(key) for row in rows)]
    head = {key: None for key in head if key.removesuffix(" at") not in nothing}
    return Table.of(
        {key: [row.get(key, "" if key.endswith(" at") else np.nan) for row in rows] for key in head}
    )


def _row(
    stage: StageData,
    names: Iterable[str],
    sections: Mapping[str, Sections],
    searches: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the displacement, forces and the result of a search of a stage by the names of
    columns.
    """
    row: dict[str, Any] = {"stage": stage.name}
    if stage.time:
        row["time"] = stage.time
    if (moved := _moved(stage)) is not None:
        row["displacement"], row["displacement at"] = _largest(*moved)
    for name in names:
        if name not in stage.states:
            continue
        along = _along(stage.forms[name], stage.states[name], sections.get(name))
        points = (
            np.column_stack([along[axis] for axis in "xyz" if axis in along])
            if along
            else np.zeros((0, 2))
        )
        for key in (key for key in _FORCES if key in along):
            title = name if key == "force" else f"{name} {key}"
            row[title], row[f"{title} at"] = _largest(along[key], points)
    if stage.name in searches:
        found = searches[stage.name]
        row[found.what] = found.value if found.stop.shows_limit else f">= {found.value:.4g}"
    return row


def _along(form: Form, state: Any, sections: Sections | None) -> dict[str, ndarray]:
    """Return coordinates and forces of a form by the names of columns, (n,) or (n, 3); empty where
    it has none.
    """
    if sections is not None:
        if not form.materials:
            raise ValueError(f"sections cut a SolidForm, not a {type(form).__name__}")
        found: Any = section_forces(form, state, sections)  # type: ignore[arg-type]
    elif form.law is not None:
        found = tractions(form, state)  # type: ignore[arg-type]
    elif along := form.line_forces(state):
        found = SectionForces(*along)
    else:
        return form.members(state)
    values = {key: part for key, part in vars(found).items() if part is not None}
    if form.law is None:
        return values
    plane = len(found.arc) > 0
    status = np.array([str(kind.name).lower() for kind in Status])[found.status]
    return {
        key: status if key == "status" else values[key]
        for key in _CONTACT
        if key != ("z" if plane else "arc")
    }


def _moved(stage: StageData) -> tuple[ndarray, ndarray] | None:
    """Return displacements and coordinates of the nodes of all solids, or else of the beams."""
    if any(form.materials for form in solids_of(stage.forms).values()):
        basis = basis_of(stage)
        return nodal_field(stage, "u"), basis.doflocs[:, :: basis.mesh.dim()].T
    lines = [
        line
        for name, state in stage.states.items()
        if (line := stage.forms[name].line_points(stage.x, state)) is not None
    ]
    if not lines:
        return None
    points, values = zip(*lines)
    return np.concatenate([part["displacement"] for part in values]), np.concatenate(points)


def _largest(values: ndarray, points: ndarray) -> tuple[float, str]:
    """Return the value of the largest magnitude, the length of a vector, and where it is."""
    values = np.linalg.norm(values, axis=1) if values.ndim == 2 else values
    at, where = located(np.abs(values), points)
    return float(values[at]), where if values[at] else ""


def located(values: ndarray, points: ndarray) -> tuple[int, str]:
    """Return the number of the largest value, the first of equal ones, and its coordinates as
    text.
    """
    known = np.where(np.isfinite(values), values, -np.inf)
    at = int(np.argmax(known >= known.max() - _EQUAL * np.abs(known.max())))
    return at, format_point(
        np.where(np.abs(points[at]) < _ZERO * np.abs(points).max(), 0.0, points[at])
    )
