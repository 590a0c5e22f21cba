"""Tables of a report: parameters, loads and reactions, stresses at rest, water, supports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from typing import Any

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..display import Table
from ..forms.base import solids_of
from ..forms.roles import Loaded, having, materials_of
from ..loads.water_at_rest import SteadyFlow, loads_at_rest
from ..materials.base import as_given
from ..results.fields import basis_of, has_solids, solids
from ..results.result import Result
from ..results.stage import StageResult
from ..units import Extent, unit_of, unit_of_parameter
from .model import Shade

#: Vertical stress, as a share of the largest one, below which its ratio to the horizontal is left
#: out.
_SMALL = 0.02
#: Values of the table of loads below this share of the largest one are round-off.
_ZERO = 1e-9


def written(value: Any) -> str:
    """Return a parameter as text."""
    if value is None:
        return "none"
    if isinstance(value, ndarray) and value.ndim:
        return f"{value.min():.4g} to {value.max():.4g}"
    if callable(value):
        return "by coordinates"
    if is_dataclass(value):
        inner = []
        for part in fields(value):
            inner.append(f"{part.name} {written(getattr(value, part.name))}")
        return f"{type(value).__name__}({', '.join(inner)})"
    if isinstance(value, tuple):
        return " and ".join(map(written, value))
    if isinstance(value, bool):
        if value:
            return "yes"
        return "no"
    if isinstance(value, int | float | np.number):
        return f"{value:.6g}"
    return str(value)


def parameters(result: Result, colors: Mapping[str, Shade]) -> Table:
    """Return all parameters of materials and other forms, with units and defaults."""
    # List materials, then other forms.
    rows: list[tuple[str, str, str, str, str]] = []
    for shade in colors.values():
        own = as_given(shade.material)
        names = ", ".join(shade.names)
        for name, value, is_default in _fields(own):
            rows.append(_parameter(names, name, value, is_default))
    others: dict[str, Mapping[str, Any]] = {}
    extents: dict[str, Extent] = {}
    for stage in result:
        for name, form in stage.forms.items():
            if not materials_of(form):
                others[name] = dict(stage.outputs(name).parameters)
                extents[name] = form.extent
    for form_name, values in others.items():
        for name, value in values.items():
            if is_dataclass(value) and not isinstance(value, type):
                for inner, part, is_default in _fields(value):
                    rows.append(_parameter(form_name, inner, part, is_default))
            else:
                rows.append(_parameter(form_name, name, value, False, extents[form_name]))
    return Table(("part", "parameter", "value", "unit", "remark"), tuple(rows))


def _fields(thing: Any) -> Iterable[tuple[str, Any, bool]]:
    """Yield names and values of a law, and whether they are the defaults."""
    if not is_dataclass(thing):
        return
    for part in fields(thing):
        if part.init and not part.name.startswith("_"):
            value = getattr(thing, part.name)
            default = part.default
            same = default is not MISSING and np.ndim(value) == 0 and not callable(value)
            yield part.name, value, bool(same and value == default)


def _parameter(
    owner: str,
    name: str,
    value: Any,
    is_default: bool,
    extent: Extent = "member",
) -> tuple[str, str, str, str, str]:
    unit = unit_of_parameter(name, extent) if value is not None else ""
    return owner, name, written(value), unit, "default" if is_default else ""


def loads(result: Result) -> Table:
    """Return resultants of weights, water, other loads and reactions of each stage."""
    rows: list[tuple[Any, ...]] = []
    for stage in result:
        found = _resultants(stage)
        largest = max(max_abs(part) for _, part, _ in found)
        for what, force, where in found:
            force = np.where(np.abs(force) < _ZERO * largest, 0.0, force)
            at = where if force[-1] else ""
            rows.append((stage.name, what, *force.tolist(), at))
    dim = len(rows[0]) - 3
    what = "resultant of"
    unit = unit_of("force" if dim == 3 else "line")
    if any(form.coordinates == "axisymmetric" for form in solids_of(result[-1].forms).values()):
        what = "resultant per radian of"
        unit = unit_of("force")
    head = ("stage", what, *(f"F{axis}" for axis in "xyz"[:dim]), "vertical one at")
    return Table(head, tuple(rows), units=("", "", *[unit] * dim, ""))


def _resultants(stage: StageResult) -> list[tuple[str, ndarray, str]]:
    """Return names, forces, (dim,), and coordinates of the vertical ones."""
    # Take known parts off the load.
    total = stage.load
    rest = np.array(total)
    parts: list[tuple[str, ndarray]] = []
    if stage.gravity is not None:
        weight = _own_weights(stage)
        if weight.any():
            parts.append(("weight", weight))
            rest = rest - weight
    water = _water(stage, len(total))
    if water is not None and water.any():
        parts.append(("water", water))
        rest = rest - water
    # What is left has other causes.
    if stage.gravity is None:
        others = "all loads"
    else:
        others = "other loads"
    parts.append((others, rest))
    parts.append(("reactions", stage.reactions()))
    # Moments, volumes of water and multipliers are no forces.
    points, dofs = _displacements(stage)
    dofs = dofs[dofs < len(total)]
    return [(name, *_resultant(vector[dofs], points[dofs])) for name, vector in parts]


def _displacements(stage: StageResult) -> tuple[ndarray, ndarray]:
    """Return the coordinates of all dofs, (N, dim), and the dofs that are displacements."""
    if stage.layout is not None:
        return np.asarray(stage.layout.coordinates).T, stage.layout.displacements
    points = np.asarray(basis_of(stage).doflocs).T
    return points, np.arange(len(points))


def _resultant(vector: ndarray, points: ndarray) -> tuple[ndarray, str]:
    """Return the sum of forces at nodes, and the centre of its vertical components."""
    dim = points.shape[1]
    forces = vector.reshape(-1, dim)
    total = forces.sum(axis=0)
    size = float(np.abs(forces[:, -1]).sum())
    if abs(total[-1]) <= 1e-6 * size or size == 0.0:
        return total, ""
    center = forces[:, -1] @ points[::dim, : dim - 1] / total[-1]
    center = np.where(np.abs(center) < _ZERO * np.abs(points).max(), 0.0, center)
    return total, ", ".join(
        f"{axis} = {value:.4g}" for axis, value in zip("xy", center, strict=False)
    )


def _own_weights(stage: StageResult) -> ndarray:
    """Return the load vector of all own weights."""
    gravity = np.asarray(stage.gravity)
    total = np.zeros(len(stage.load))
    for name, form in having(stage.forms, Loaded).items():
        if name in stage.states:
            weight = form.own_weight(gravity)
            if weight is not None:
                total[: len(weight)] += weight
    return total


def _water(stage: StageResult, n: int) -> ndarray | None:
    """Return the load of the stage's water, None where it is not known any more."""
    if stage.water is None or stage.water is False or isinstance(stage.water, str):
        return None
    active = {name: stage.forms[name] for name in stage.states}
    loaded = having(active, Loaded).values()
    total = np.zeros(n)
    for part in loads_at_rest(solids_of(active), loaded, stage.water, stage.water_unit_weight):
        total[: len(part)] += part
    return total


def water(result: Result) -> Table:
    """Return the water at rest of each stage in words."""
    rows = []
    for stage in result:
        if stage.water is not None and stage.water is not False:
            rows.append((stage.name, in_words(stage.water), _weight_of(stage)))
    return Table(("stage", "water", "unit weight"), tuple(rows))


def _weight_of(stage: StageResult) -> str:
    weight = stage.water_unit_weight
    if weight is None:
        return ""
    return f"{weight:g} {unit_of('weight')}".strip()


def in_words(given: Any) -> str:
    """Return water at rest in words: its level, points, regions, or kind."""
    # Say the kind of water, or its values.
    if isinstance(given, str):
        return given
    if isinstance(given, Mapping):
        return "; ".join(f"{name}: {in_words(part)}" for name, part in given.items())
    if isinstance(given, SteadyFlow):
        return "steady flow"
    if callable(given):
        return "a function of the coordinates"
    values = np.asarray(given)
    if values.ndim == 0:
        return f"level {float(values):g} {unit_of('length')}".strip()
    if values.ndim == 2:
        corners = ", ".join(f"({x:g}, {y:g})" for x, y in values)
        return f"through {corners}"
    return "pressures at the vertices"


def at_rest(result: Result) -> Table:
    """Return the ratios of horizontal and vertical effective stress by region in the first stage.

    Each has the mean over the elements, weighted by their sizes, and the range of the middle 90 %.
    """
    # Ratios are known once a stage has stresses.
    stage = next((one for one in result if has_solids(one)), None)
    head = ("region", "K0, mean", "5 %", "95 %", "stage")
    if stage is None:
        return Table(head, ())
    rows = []
    for form_name, form in solids(stage).items():
        state = stage.states[form_name]
        dim = form.basis.mesh.dim()
        # Only soils have a K0, at points with vertical pressure.
        for region, stress, internal in form.at_regions(state):
            if not region.material.n_internal:
                continue
            effective, _ = region.material.drained(stress, internal)
            vertical = effective[dim - 1]
            counts = vertical < -_SMALL * max_abs(vertical)
            if counts.any():
                ratio = (effective[0] / np.where(counts, vertical, -1.0))[counts]
                weight = form.weight[region.elements][counts]
                low, high = np.quantile(ratio, (0.05, 0.95))
                name = region.name
                if region.name == "all":
                    name = form_name
                mean = float(ratio @ weight / weight.sum())
                rows.append((name, mean, float(low), float(high), stage.name))
    return Table(head, tuple(rows))


def supports(result: Result) -> Table:
    """Return the supported components of each named boundary, and of other nodes."""
    head = ("stages", "boundary", "held")
    rows: list[tuple[str, str, str]] = []
    texts: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for stage in result:
        if stage.supports is not None and has_solids(stage):
            texts.setdefault(tuple(_held(stage)), []).append(stage.name)
    for found, names in texts.items():
        for boundary, held in found:
            rows.append((", ".join(names), boundary, held))
    return Table(head, tuple(rows))


def _held(stage: StageResult) -> Iterable[tuple[str, str]]:
    """Yield boundaries and their supported components."""
    # Mark supported dofs, and take off those of named boundaries.
    basis = basis_of(stage)
    mesh = basis.mesh
    dim = mesh.dim()
    fixed = np.zeros(max(basis.N, len(stage.x)), bool)
    fixed[np.asarray(stage.supports, int)] = True
    left = fixed.copy()
    left[basis.N :] = False
    for name, facets in (mesh.boundaries or {}).items():
        if len(facets) == 0:
            continue
        dofs = basis.get_dofs(np.asarray(facets)).all().reshape(-1, dim)
        held = [axis for axis, part in zip("xyz", fixed[dofs].T, strict=False) if part.all()]
        if held:
            yield name, ", ".join(held)
        for axis, part in zip("xyz", dofs.T, strict=False):
            if axis in held:
                left[part] = False
    # Report the rest by number.
    if left.any():
        yield "other nodes", f"{left.sum()} dofs"
    others = int(fixed[basis.N :].sum())
    if others:
        yield "other fields", f"{others} dofs"
