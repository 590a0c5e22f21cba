"""Initial states: the stresses of the ground before anything is built."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

from ..checks import finite, format_point, look_up
from ..contact.prestress import prestressed
from ..errors import warn
from ..forms.base import Form, internal_force, summaries
from ..forms.roles import Touching, having, joined_by
from ..layout import linear_element, others
from ..loads import by_element
from ..loads.water_at_rest import as_pressure
from ..materials import LinearElastic, Material
from ..nonlinear.newton import Evaluation
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult
from .plan import acts_on, check_contacts
from .run import run
from .setup import Setup, dofs_of
from .stage import Stage

#: Largest K0 without a warning: the passive pressure of a soil with 55 degrees.
_LARGEST_K0 = 10.0
#: Heights and pressures that count as the same, as a share of the largest.
_SAME = 1e-6
#: Forces out of balance, as a share of the load, of which a warning is given.
_BALANCED = 1e-6
#: ... and how often bodies may come back: beside a pile with nodal contact 6e-2, 4e-5, 8e-8 are
#: left, else 3e-4, 4e-9.
_RETURNS = 4

#: Stress at coordinates (2, ...) in elements of the mesh.
_StressField = Callable[[ndarray, ndarray], ndarray]


def initial_state(
    setup: Setup, load: Any, stress: Callable[[ndarray], ndarray], water: Any, name: str
) -> Result:
    """Return a given field of stresses, see :meth:`skfem_contact.Model.initial_state`."""
    return _wet(
        setup,
        _balanced(setup, _whole(setup, load, water), lambda x, elements: stress(x), name),
        water,
    )


def k0_state(
    setup: Setup,
    load: Any,
    K0: float | Mapping[str, float],
    unit_weights: float | Mapping[str, float] | None,
    surcharge: float,
    water: Any,
    name: str,
) -> Result:
    """Return the state of the K0 procedure, see :meth:`skfem_contact.Model.k0_state`."""
    solids = setup.solids
    mesh = next(iter(solids.values())).basis.mesh
    elements = np.concatenate([form.elements for form in solids.values()])
    overburden, ratios = (
        _overburden(mesh, _layers(setup, elements, unit_weights)),
        by_element(mesh, K0, "K0", np.nan),
    )
    missing = elements[np.isnan(ratios[elements])]
    if len(missing):
        tags = [
            tag for tag, part in (mesh.subdomains or {}).items() if np.isin(part, missing).any()
        ]
        raise ValueError(f"{len(missing)} elements have no K0; they lie in the subdomains {tags}")
    if not ((ratios[elements] >= 0.0) & (ratios[elements] < np.inf)).all():
        raise ValueError(f"K0 must be a number, not negative, unlike {K0!r}")
    if ratios[elements].max() > _LARGEST_K0:
        warn(
            f"K0 is {ratios[elements].max():.4g}: it is the ratio of horizontal to vertical "
            f"stress, not in per cent"
        )
    pressure = (
        None
        if water is None or water is False
        else as_pressure(water, mesh, setup.water_unit_weight)
    )
    if pressure is not None and not callable(pressure) and np.shape(pressure) != (mesh.nvertices,):
        raise ValueError(
            "water of the K0 procedure must be a level, points of it, a function of the "
            "coordinates such "
            "as that of a seepage, water.pressure_at, or pressures at the vertices"
        )
    if pressure is not None:
        vertices = np.unique(mesh.t[:, elements])
        given = (
            pressure(mesh.p[:, vertices]) if callable(pressure) else np.asarray(pressure)[vertices]
        )
        _check_surface(mesh.p[:, vertices], given, surcharge)

    def stress(x: ndarray, elements: ndarray) -> ndarray:
        vertical = -surcharge - overburden(x[-1])
        if pressure is not None:
            vertical = vertical + (
                pressure(x) if callable(pressure) else _linear(mesh, pressure, x, elements)
            )
        horizontal, none = ratios[elements] * vertical, np.zeros_like(vertical)
        plane = (horizontal, vertical, horizontal, none)
        return np.stack(
            plane if len(x) == 2 else (horizontal, horizontal, vertical, none, none, none)
        )

    carried = water if any(form.unit_weight is not None for form in solids.values()) else None
    return _wet(setup, _balanced(setup, _whole(setup, load, carried), stress, name), carried)


def gravity_state(
    setup: Setup,
    load: Any,
    K0: float | Mapping[str, float] | None,
    water: Any,
    name: str,
    increments: int,
) -> Result:
    """Turn gravity on in ground of any shape, see :meth:`skfem_contact.Model.gravity_state`."""
    whole = _whole(setup, load, water)
    _check_inactive(setup, whole)
    dry, kept = _without_still_fields(setup)
    load = whole[kept]
    if K0 is None:
        return _wet(
            setup,
            _among_all(setup, kept, _at_rest(dry, _loaded(dry, name, load, increments, None))),
            water,
        )
    elastic = dict(dry.forms)
    regions = {region for form in dry.solids.values() for region in form.materials}
    for region in K0 if isinstance(K0, Mapping) else ():
        look_up(region, dict.fromkeys(regions), "region of the solids")
    for key, form in dry.solids.items():
        ratios = K0 if isinstance(K0, Mapping) else dict.fromkeys(form.materials, K0)
        given = {
            region: _elastic(m, ratios[region])
            for region, m in form.materials.items()
            if region in ratios
        }
        elastic[key] = form.with_materials(given)
    first = _loaded(_with(dry, elastic), f"{name}, elastic", load, 1, None)
    return _wet(
        setup,
        _among_all(setup, kept, _at_rest(dry, _loaded(dry, name, load, increments, first))),
        water,
    )


def _loaded(
    setup: Setup, name: str, load: ndarray, increments: int, start: StageResult | None
) -> StageResult:
    """Run a stage of a whole load."""
    return run(setup, [Stage(name, load, increments=increments)], start, progress=False)[name]


def _whole(setup: Setup, load: Any, water: Any) -> ndarray:
    """Return the load on top, the weights of all forms and the load of water, (N,)."""
    return setup.load(load) + setup.weights(setup.forms) + setup.water_on(setup.forms, water)


def _wet(setup: Setup, result: Result, water: Any) -> Result:
    """Return a result that knows the water of its load: the first stage that follows keeps it."""
    return Result(
        tuple(
            replace(stage, water=water, water_unit_weight=setup.water_unit_weight)
            for stage in result
        )
    )


def _with(setup: Setup, forms: Mapping[str, Form]) -> Setup:
    """Return the set-up with other forms on the same dofs."""
    new = copy(setup)
    new.forms = new.own = dict(forms)
    vars(new).pop("solids", None)
    return new


def _at_rest(setup: Setup, last: StageResult) -> Result:
    """Return a stage without its displacements, in equilibrium: contact has followed the bodies,
    and comes back.
    """
    name, iterations = last.name, last.iterations
    for left in reversed(range(_RETURNS)):
        start = Result((replace(last, name=f"{name}, moved"),)).reset()
        rest = start[-1]
        system = setup.checked_system(rest.forms, setup.fixed)
        now = system.evaluate(rest.x, rest.states, rest.load)
        if now.norm <= _BALANCED or left == 0:
            break
        last = _loaded(setup, name, rest.load, 1, start[-1])
        iterations += last.iterations
    _check_balance(now, system)
    return Result((replace(rest, name=name, iterations=iterations, residual=now.norm),))


def _without_still_fields(setup: Setup) -> tuple[Setup, ndarray]:
    """Return the set-up, weightless, without forms that bring fields that do not move or act on
    these, and its dofs.
    """
    still = setup.layout.still
    names = []
    for key, form in setup.forms.items():
        joins = joined_by(form)
        moves = all(field.moves for field in form.fields)
        if moves and (joins is None or not np.isin(joins, still).any()):
            names.append(key)
    for key in set(having(setup.forms, Touching)).difference(names):
        raise ValueError(
            f"'{key}' has DualMultipliers: initial states of the ground are for the penalty method "
            f"and "
            "AugmentedLagrangian()"
        )
    dry, kept = setup.restricted(names)
    dry.gravity = 0.0 * setup.gravity
    return dry, kept


def _among_all(setup: Setup, kept: ndarray, result: Result) -> Result:
    """Return a result of the forms that move, of all forms and among all dofs."""
    last = result[-1]
    forms = {key: last.forms.get(key, form) for key, form in setup.forms.items()}
    states = {key: last.states.get(key, form.initial_state()) for key, form in forms.items()}
    x, load = np.zeros(setup.layout.size), np.zeros(setup.layout.size)
    x[kept], load[kept] = last.x, last.load
    summary = summaries(forms, x, states)
    return Result(
        (
            replace(
                last,
                x=x,
                load=load,
                states=states,
                summary=summary,
                forms=forms,
                layout=setup.layout,
                before=None,
                changed={},
                supports=None,
            ),
        )
    )


def _check_inactive(setup: Setup, load: ndarray) -> ndarray:
    """Return the dofs of inactive bodies, on which neither load nor contact may act."""
    solids = setup.solids
    away = others(setup.layout.size, dofs_of(setup.forms, setup.layout))
    check_contacts(setup.forms, away)
    if acts_on(load, away):
        raise ValueError(
            f"a part of the load acts on inactive bodies; the solids are {list(solids)}"
        )
    return away


def _balanced(setup: Setup, load: ndarray, stress: _StressField, name: str) -> Result:
    """Return a result with given stresses, tractions that balance them, and the residual that is
    left.
    """
    away = _check_inactive(setup, load)
    system = setup.checked_system(setup.forms, np.union1d(setup.fixed, away))
    x = np.zeros(system.size)
    states = {key: form.initial_state() for key, form in system.forms.items()}
    solids = setup.solids
    for key, form in solids.items():
        values = np.array(
            stress(np.asarray(form.basis.global_coordinates()), form.elements[:, None]), dtype=float
        )
        if values.shape != states[key].stress.shape or not np.isfinite(values).all():
            raise ValueError(
                f"the stress of '{key}' must be finite and of shape {states[key].stress.shape}; "
                f"its shape "
                f"is {values.shape}"
            )
        states[key] = form.assemble(x[: form.size], form.initial_state(stress=values)).state
    tractions = {
        key: pair.tractions_at(x[: pair.size], states[key])
        for key, pair in having(system.forms, Touching).items()
    }
    operators = {key: operator for key, operator in tractions.items() if operator is not None}
    if operators:
        force = internal_force(solids, x, states)
        near = {
            key: _stress_at(operator.coordinates, stress, solids)
            for key, operator in operators.items()
        }
        states.update(prestressed(operators, load - force, system.free, near))
    now = system.evaluate(x, states, load)
    _check_balance(now, system)
    summary = summaries(system.forms, x, states)
    return Result(
        (
            StageResult(
                name, x, load, states, (), now.norm, 1.0, summary, system.forms, layout=setup.layout
            ),
        )
    )


def _check_balance(now: Evaluation, system: System) -> None:
    """Warn about forces that do not balance, at the level of the caller of the model's method."""
    if now.norm > _BALANCED:
        names = [key for key, response in now.responses.items() if response.force[now.worst] != 0.0]
        warn(
            f"the initial stresses are out of balance by {now.norm:.2g} of the load, most "
            f"{system.layout.describe(now.worst)} of {names}: begin with a stage of the same load "
            f"to let "
            "them find equilibrium"
        )


def _stress_at(points: ndarray, stress: _StressField, solids: Mapping[str, Any]) -> ndarray:
    """Return a field of stresses at coordinates, (4 or 6, n_points); their elements are those of
    the nearest points.
    """
    inside = [
        np.asarray(form.basis.global_coordinates()).reshape(points.shape[1], -1).T
        for form in solids.values()
    ]
    elements = [
        np.broadcast_to(form.elements[:, None], form.weight.shape).ravel()
        for form in solids.values()
    ]
    nearest = cKDTree(np.concatenate(inside)).query(points)[1]
    return np.asarray(stress(points.T[:, :, None], np.concatenate(elements)[nearest][:, None]))[
        :, :, 0
    ]


def _linear(mesh: Any, nodal: ndarray, x: ndarray, elements: ndarray) -> ndarray:
    """Return values at the vertices, (n_vertices,), at points (dim, n, ...) in elements of the
    mesh, (n, 1).
    """
    here, element = elements[:, 0], linear_element(mesh)
    local = mesh.mapping().invF(x, tind=here)
    return sum(
        (
            element.lbasis(local, i)[0] * np.asarray(nodal)[at][:, None]
            for i, at in enumerate(mesh.t[:, here])
        ),
        start=np.zeros(x.shape[1:]),
    )


def _check_surface(x: ndarray, pressure: ndarray, surcharge: float) -> None:
    """Refuse water that presses, (n,), more than the surcharge on the highest of some nodes, (dim,
    n).
    """
    given = finite(pressure, "the pressure")
    values = np.where(x[-1] > x[-1].max() - _SAME * np.ptp(x[-1]), given, 0.0)
    k = values.argmax()
    if values[k] - surcharge > _SAME * np.abs(given).max():
        raise ValueError(
            f"water presses with {values[k]:.4g} on the surface at {format_point(x[:, k])}, where "
            f"the "
            f"surcharge is {surcharge:.4g}: it counts water above the ground too, give "
            f"surcharge={values[k]:.4g} and what else presses there"
        )


def _layers(
    setup: Setup, elements: ndarray, unit_weights: float | Mapping[str, float] | None
) -> list[tuple[str, ndarray, float]]:
    """Return name, elements and unit weight of every layer: as given, or of the solids
    themselves.
    """
    mesh = next(iter(setup.solids.values())).basis.mesh
    if unit_weights is not None and not isinstance(unit_weights, Mapping):
        return [("the solids", elements, unit_weights)]
    if unit_weights is not None:
        if not unit_weights:
            raise ValueError(
                "unit_weights names no subdomain: leave it out to use the unit weights of the forms"
            )
        return [
            (name, look_up(name, mesh.subdomains or {}, "subdomain"), gamma)
            for name, gamma in unit_weights.items()
        ]
    layers = []
    for name, form in setup.solids.items():
        if form.unit_weight is None:
            raise ValueError(
                f"'{name}' has no unit weight: give the form `unit_weight`, or k0_state "
                f"`unit_weights`"
            )
        parts = (
            form.unit_weight if isinstance(form.unit_weight, Mapping) else {name: form.unit_weight}
        )
        for part, gamma in parts.items():
            inside = (
                form.elements
                if part == name and not isinstance(form.unit_weight, Mapping)
                else np.intersect1d(mesh.subdomains[part], form.elements)
            )
            layers.append((part, inside, float(gamma)))
    return [layer for layer in layers if len(layer[1])]  # a subdomain may lie in other bodies


def _overburden(
    mesh: Any, layers: list[tuple[str, ndarray, float]]
) -> Callable[[ndarray], ndarray]:
    """Return the weight above a height, from layers that must be level."""
    extent = []
    for name, elements, gamma in layers:
        heights = mesh.p[-1, mesh.t[:, elements]]
        extent.append((name, gamma, float(heights.min()), float(heights.max())))
    levels = np.unique(np.array([level for layer in extent for level in layer[2:]]))
    weights = np.zeros(len(levels) - 1)
    for k, (bottom, top) in enumerate(pairwise(levels)):
        here = {name: gamma for name, gamma, low, high in extent if low <= bottom and top <= high}
        if len(set(here.values())) > 1:
            raise ValueError(
                f"the ground is not level: from height {bottom:g} to {top:g} there are the unit "
                f"weights "
                f"{here}; use gravity_state, or equal weights now and the difference in a later "
                f"stage"
            )
        weights[k] = next(iter(here.values()), 0.0)
    above = np.append(np.cumsum((weights * np.diff(levels))[::-1])[::-1], 0.0)
    return lambda y: np.interp(y, levels, above)


def _elastic(material: Material, K0: float) -> LinearElastic:
    """Return an elastic material of the same Young's modulus whose Poisson's ratio gives K0."""
    if not 0.0 < K0 < 1.0:
        raise ValueError(
            f"K0 must lie between 0 and 1 for elastic ground, not {K0!r}; k0_state has no such "
            f"limit"
        )
    E = np.asarray(1.0 / np.linalg.inv(material.elasticity(4))[..., 0, 0], dtype=float)
    return LinearElastic(E, nu=K0 / (1.0 + K0))
