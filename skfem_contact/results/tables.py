"""Tables of results: forces along a form, and one row for each stage."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray

from ..arrays import max_abs, row_norms
from ..checks import format_point, look_up
from ..contact.laws import Status
from ..display import Table
from ..forms.base import Form, Forms
from ..forms.roles import Touching, materials_of
from ..units import kind_of, kind_per
from .cuts import Cuts, SectionForces
from .fields import basis_of, has_solids, nodal_field
from .files import StageData
from .sections import section_forces
from .tractions import tractions

#: Columns of contact tractions.
_CONTACT = ("arc", "x", "y", "z", "pressure", "shear", "gap", "slip", "status")
#: Columns whose largest values the table of all stages has.
_FORCES = ("N", "V", "M", "T", "N_hoop", "M_hoop", "pressure", "shear", "force", "skin")
#: Forces and moments per length of shells, which are columns as well.
_OF_SHELLS = ("n_1", "n_2", "n_12", "m_1", "m_2", "m_12")
#: Magnitudes that differ by less than this share are equal: the first of them counts.
_EQUAL = 1e-6
#: Coordinates are zero below this share of the largest one.
_ZERO = 1e-12


@dataclass(frozen=True)
class Envelope:
    """Smallest and largest section forces over stages; printed as a table.

    Attributes
    ----------
    smallest, largest
        Extreme section forces at each section.
    stages
        Names of the stages with the smallest and the largest values: ``stages["M"]``, shape (2, n).
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

        # Find the stages of the extremes at every section.
        names = np.array(list(forces))
        first = next(iter(forces.values()))
        sections = np.arange(len(first.position))
        smallest = {}
        largest = {}
        stages = {}
        for key in first.names:
            values = np.array([getattr(part, key) for part in forces.values()])  # (n_stages, n)
            lowest = values.argmin(axis=0)
            highest = values.argmax(axis=0)
            smallest[key] = values[lowest, sections]
            largest[key] = values[highest, sections]
            stages[key] = names[np.array([lowest, highest])]
        return cls(replace(first, **smallest), replace(first, **largest), stages)

    def __str__(self) -> str:
        lines = []
        for key in self.smallest.names:
            low = getattr(self.smallest, key)
            high = getattr(self.largest, key)
            extremes = (low, low.argmin()), (high, high.argmax())
            for (values, i), names in zip(extremes, self.stages[key], strict=True):
                position = self.smallest.position[i]
                lines.append(f"{key} {values[i]:10.4g} at {position:<8.4g} {names[i]}")
        return "\n".join(lines)


def of_form(stage: StageData, name: str, sections: Cuts | None = None) -> Table:
    """Return the forces along a beam, a contact pair or bars as a table with their coordinates.

    Parameters
    ----------
    name
        Name of a form. Beams and reinforcement have columns of :class:`SectionForces`, contact
        pairs columns of :class:`Tractions`, bars their ends and ``force``, embedded beams
        and springs along piles ``deflection`` and ``resistance`` by ``kind``: p, t and q.
    sections
        Cuts through a solid, as for :meth:`section_forces`.

    Raises
    ------
    ValueError
        A form that does not exist or has no such forces.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> beam = sc.Beam(None, [[0., 0.], [1., 0.], [2., 0.]], EI=100., EA=1e4)
    >>> model = sc.Model({"beam": beam}, beam.dofs((0., 0.)))
    >>> load = model.forms["beam"].load((0., -3.), at=(2., 0.))
    >>> stage = model.run([sc.Stage("tip", load)])["tip"]
    >>> print(stage.table("beam"))
    beam, tip
    position  x  y  N  V   M
           0  0  0  0  -3  6
           1  1  0  0  -3  3
           1  1  0  0  -3  3
           2  2  0  0  -3  0
    """
    form = look_up(name, stage.forms, f"form in stage '{stage.name}'")
    along = _along(stage, name, sections)
    if not along:
        others = [key for key in stage.forms if key != name and _along(stage, key, None)]
        raise ValueError(
            f"'{name}' is a {type(form).__name__}, which has no forces for a table; give "
            f"`sections` of a solid, or one of {others}"
        )

    # Give each component of a vector its column, but leave out the axis.
    columns = {}
    for key, values in along.items():
        if np.ndim(values) < 2:
            columns[key] = values
        elif key != "axis":
            columns |= {f"{key} {axis}": part for axis, part in zip("xyz", values.T)}
    kinds = _kinds(columns, "z" in columns) | _own_kinds(form, along)
    return Table.of(columns, f"{name}, {stage.name}", kinds)


def of_stages(
    stages: Collection[StageData],
    names: Collection[str],
    sections: Mapping[str, Cuts],
    searches: Mapping[str, Any],
) -> Table:
    """Return one row for each stage, see :meth:`~skfem_contact.results.Result.table`."""
    forms: dict[str, Form] = {}
    for stage in stages:
        forms |= stage.forms
    _check_names(forms, stages, (*names, *sections), sections, searches)
    if not names:  # all but solids and contact pairs
        names = []
        for name, form in forms.items():
            if not isinstance(form, Touching):
                names.append(name)
    chosen = dict.fromkeys((*names, *sections))
    own_kinds: dict[str, str] = {}
    rows = [_row(stage, chosen, sections, searches, own_kinds) for stage in stages]
    columns = _columns(rows)
    moved = next(filter(None, map(_moved, stages)), None)
    in_space = moved is not None and moved[1].shape[1] == 3
    return Table.of(columns, kinds=_kinds(columns, in_space) | own_kinds)


def _kinds(columns: Iterable[str], in_space: bool) -> dict[str, str]:
    """Return the kinds of the units of columns; components of vectors have those of the vector.

    In space section forces are those of a whole member, in the plane those of a unit of length.
    """
    kinds = {}
    for name in columns:
        vector, _, axis = name.rpartition(" ")
        kinds[name] = kind_of(name, in_space)
        if axis in ("x", "y", "z") and kind_of(vector):
            kinds[name] = kind_of(vector, in_space)
    return kinds


def _title(name: str, key: str) -> str:
    """Return the title of a force of a form."""
    return f"{name} {key}".removesuffix(" force")


def _own_kinds(form: Form, along: Mapping[str, Any]) -> dict[str, str]:
    """Return the kinds of the units that follow from a form, by the names of its columns."""
    kinds = {}
    if "force" in along:
        kinds["force"] = kind_per("force", form.extent)
    if "N_hoop" in along:
        kinds["N"] = SectionForces(**along).kind("N")
    return kinds


def _columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """Return the columns of rows, without forces that are zero in all rows."""
    titles: dict[str, None] = {}
    for row in rows:
        titles |= dict.fromkeys(row)
    columns = {}
    for title in titles:
        value = title.removesuffix(" at")
        is_force = f"{value} at" in titles
        if not is_force or any(row.get(value) for row in rows):
            missing = "" if title.endswith(" at") else np.nan
            columns[title] = [row.get(title, missing) for row in rows]
    return columns


def _check_names(
    forms: Forms,
    stages: Iterable[StageData],
    names: Iterable[str],
    sections: Mapping[str, Cuts],
    searches: Mapping[str, Any],
) -> None:
    """Refuse unknown forms, solids without sections, and searches from unknown stages."""
    for name in names:
        form = look_up(name, forms, "form")
        if materials_of(form) and name not in sections:
            raise ValueError(
                f"'{name}' is a {type(form).__name__}: give sections={{'{name}': Cuts.line()}}"
            )
    for name, search in searches.items():
        look_up(name, {stage.name: stage for stage in stages}, "stage")
        if getattr(search, "stop", None) is None:
            raise ValueError(
                f"searches are results of strength_reduction or limit_load, not {search!r}"
            )


def _row(
    stage: StageData,
    names: Iterable[str],
    sections: Mapping[str, Cuts],
    searches: Mapping[str, Any],
    kinds: dict[str, str],
) -> dict[str, Any]:
    """Return displacement, forces and result of a search of a stage by the names of columns.

    Kinds of units that follow from forms are added to `kinds`.
    """
    row: dict[str, Any] = {"stage": stage.name}
    if stage.time:
        row["time"] = stage.time
    moved = _moved(stage)
    if moved is not None:
        row["displacement"], row["displacement at"] = _largest(*moved)

    # Add the largest forces of each form, and their coordinates.
    for name in names:
        if name not in stage.states:
            continue
        along = _along(stage, name, sections.get(name))
        for key in (*_FORCES, *_OF_SHELLS):
            if key in along:
                points = np.column_stack([along[axis] for axis in "xyz" if axis in along])
                title = _title(name, key)
                row[title], row[f"{title} at"] = _largest(along[key], points)
        for key, kind in _own_kinds(stage.forms[name], along).items():
            kinds[_title(name, key)] = kind

    # Add the factor of a search that starts from the stage.
    search = searches.get(stage.name)
    if search is not None:
        row[search.what] = search.value if search.stop.shows_limit else f">= {search.value:.4g}"
    return row


def _along(stage: StageData, name: str, sections: Cuts | None) -> dict[str, ndarray]:
    """Return coordinates and forces of a form by the names of columns, (n,) or (n, 3), or {}."""
    form = stage.forms[name]
    state = stage.states[name]
    if isinstance(form, Touching) and sections is None:
        return _contact_columns(vars(tractions(form, state, stage.x[: form.size])))  # type: ignore[arg-type]
    forces: SectionForces | None = None
    if sections is not None:
        if not materials_of(form):
            raise ValueError(f"sections cut a SolidForm, not a {type(form).__name__}")
        forces = section_forces(form, state, sections)  # type: ignore[arg-type]
    elif along := stage.outputs(name).lines:
        forces = SectionForces(*along)
    if forces is None:
        return dict(stage.outputs(name).members)
    return {key: part for key, part in vars(forces).items() if part is not None}


def _contact_columns(values: Mapping[str, ndarray]) -> dict[str, ndarray]:
    """Return the columns of contact tractions: with the arc in the plane, with z in space."""
    other_axis = "arc"
    if len(values["arc"]):
        other_axis = "z"
    columns = {key: values[key] for key in _CONTACT if key != other_axis}
    names = np.array([kind.name.lower() for kind in Status])
    return columns | {"status": names[columns["status"]]}


def _moved(stage: StageData) -> tuple[ndarray, ndarray] | None:
    """Return displacements and coordinates of all nodes of solids, or else of beams and shells."""
    if has_solids(stage):
        basis = basis_of(stage)
        return nodal_field(stage, "u"), basis.doflocs[:, :: basis.mesh.dim()].T
    values = []
    points = []
    for name in stage.states:
        outputs = stage.outputs(name)
        for nodes in (outputs.points, outputs.triangles):
            if nodes is not None:
                points.append(nodes[0])
                values.append(nodes[1]["displacement"])
    if points:
        return (np.concatenate(values), np.concatenate(points))
    return None


def _largest(values: ndarray, points: ndarray) -> tuple[float, str]:
    """Return the value of the largest magnitude, the length of a vector, and its coordinates."""
    if values.ndim == 2:
        values = row_norms(values)
    index, where = located(np.abs(values), points)
    return float(values[index]), where if values[index] else ""


def located(values: ndarray, points: ndarray) -> tuple[int, str]:
    """Return the number of the largest value, the first of equal ones, and its coordinates."""
    known = np.where(np.isfinite(values), values, -np.inf)
    largest = known.max()
    index = int(np.argmax(known >= largest - _EQUAL * np.abs(largest)))
    is_zero = np.abs(points[index]) < _ZERO * max_abs(points)
    return index, format_point(np.where(is_zero, 0.0, points[index]))
