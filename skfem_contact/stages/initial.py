"""Initial states: the stresses of the ground before anything is built."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import scipy
from numpy import ndarray

from ..arrays import max_abs
from ..checks import finite, format_point, look_up, tags_with
from ..contact.prestress import prestressed
from ..errors import warn
from ..forms.base import Forms, States, internal_force, summaries
from ..forms.roles import Touching, having, joined_by
from ..layout import elements_in, linear_element, others
from ..loads import by_element
from ..loads.water_at_rest import as_pressure
from ..materials import LinearElastic, Material
from ..nonlinear.newton import Evaluation
from ..nonlinear.system import System
from ..results.result import Result
from ..results.stage import StageResult
from .plan import acts_on, check_contacts, own_arrays
from .run import run
from .setup import Setup, dofs_of
from .stage import AtRest, Force, Stage

#: Largest K0 without a warning: the passive pressure of a soil with 55 degrees.
_LARGEST_K0 = 10.0
#: Heights and pressures that count as the same, as a share of the largest.
_SAME = 1e-6
#: Forces out of balance, as a share of the load, of which a warning is given.
_BALANCED = 1e-6
#: ... and how often bodies may come back: beside a pile with nodal contact 6e-2, 4e-5, 8e-8 are
#: left, else 3e-4, 4e-9.
_RETURNS = 4

#: Change of a given stress, as a share of the largest, from which on a warning is given.
_RETURNED = 1e-3

#: Stress at coordinates (2, ...) in elements of the mesh.
_StressField = Callable[[ndarray, ndarray], ndarray]


def initial_state(
    setup: Setup,
    load: Force = None,
    *,
    stress: Callable[[ndarray], ndarray],
    water: AtRest = None,
    name: str = "initial",
) -> Result:
    """Return a start with a given field of stresses; nothing has moved.

    Where a stress is not admissible it is returned to the yield surface, and counted as
    yielded. Contact pairs get the tractions that balance the stresses on both sides.

    Parameters
    ----------
    load
        External forces besides the weight of the forms, (N,): stresses, weight and these are in
        equilibrium.
    stress
        Stress (xx, yy, zz, xy), tension positive, at coordinates (2, n_elements, n_points): (4,
        n_elements, n_points); in three dimensions 6 components at coordinates (3, n_elements,
        n_points).
    water
        Water at rest, as in :class:`Stage`.
    name
        Name of the state in the result.

    Returns
    -------
    Result
        A start for :meth:`run`, with the residual of its equilibrium. A stage with the same
        load, a *null step*, removes the rest.

    Warns
    -----
    AnalysisWarning
        The forces out of balance exceed 1e-6 of the load.
    """
    whole = _whole(setup, load, water)
    return _wet(setup, _balanced(setup, whole, lambda x, elements: stress(x), name), water)


def k0_state(
    setup: Setup,
    load: Force = None,
    *,
    K0: float | Mapping[str, float],
    unit_weights: float | Mapping[str, float] | None = None,
    surcharge: float = 0.0,
    water: AtRest = None,
    name: str = "initial",
) -> Result:
    """Return the K0 state of level ground.

    The vertical stress follows from the weight above, the horizontal stress is K0 times it.
    Where the surface or the layers are not level use :meth:`gravity_state`.

    Parameters
    ----------
    load, name
        As for :meth:`initial_state`.
    K0
        Ratio of the effective stresses: one number, or by subdomain.
    unit_weights
        Unit weights, one number or by subdomain; by default the forms' own. Subdomains that
        are not named are weightless.
    surcharge
        Pressure on the surface, with the water above it.
    water
        Water at rest: its level, points of it, or the pore pressure as a function of the
        coordinates or at the vertices, (n_vertices,). Stresses are then effective, everywhere.
        A wall that is wished in place begins as ground. Where the forms have unit weights the
        load of the water is added, otherwise `load` holds it.

    Raises
    ------
    ValueError
        Unknown subdomain, elements without K0, different unit weights at the same height (the
        ground is not level), or gravity that is not against the last axis.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(1).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> soil = sc.MohrCoulomb(E=1e4, nu=.3, c=1., phi=30.)
    >>> ground = sc.SolidForm(basis, soil, unit_weight=20.)
    >>> start = sc.Model({"ground": ground}, sc.box_supports(basis)).k0_state(K0=.5)
    >>> stress = start["initial"].states["ground"].stress
    >>> bool(np.allclose(stress[0], .5 * stress[1])), bool(start["initial"].residual < 1e-12)
    (True, True)
    """
    # Vertical stresses by the weight of the layers above.
    setup.check_upright("the K0 procedure needs", ", or take gravity_state")
    solids = setup.solids
    mesh = next(iter(solids.values())).basis.mesh
    elements = elements_in(solids.values())
    overburden = _overburden(mesh, _layers(setup, elements, unit_weights))
    ratios = _ratios(mesh, elements, K0)
    pressure = _pressure_field(setup, mesh, elements, water, surcharge)

    def stress(x: ndarray, elements: ndarray) -> ndarray:
        # sigma_v' = -(q + int gamma dz) + p,  sigma_h' = K0 sigma_v', tension positive
        vertical = -surcharge - overburden(x[-1])
        if pressure is not None:
            vertical = vertical + pressure(x, elements)
        horizontal = ratios[elements] * vertical
        none = np.zeros_like(vertical)
        if len(x) == 2:
            return np.stack((horizontal, vertical, horizontal, none))
        return np.stack((horizontal, horizontal, vertical, none, none, none))

    weighs = any(form.unit_weight is not None for form in solids.values())
    kept = water if weighs else None
    return _wet(setup, _balanced(setup, _whole(setup, load, kept), stress, name), kept)


def _ratios(mesh: Any, elements: ndarray, K0: float | Mapping[str, float]) -> ndarray:
    """Return K0 of all elements of the mesh, NaN outside of the given ones."""
    # Every element of the ground has a ratio.
    ratios = by_element(mesh, K0, "K0", np.nan)
    missing = elements[np.isnan(ratios[elements])]
    if len(missing):
        tags = tags_with(missing, mesh.subdomains)
        raise ValueError(f"{len(missing)} elements have no K0; they lie in the subdomains {tags}")
    # Check the ratios.
    given = ratios[elements]
    if not ((given >= 0.0) & (given < np.inf)).all():
        raise ValueError(f"K0 must be a number, not negative, unlike {K0!r}")
    if given.max() > _LARGEST_K0:
        warn(
            f"K0 is {given.max():.4g}: it is the ratio of horizontal to vertical stress, not in "
            "per cent"
        )
    return ratios


def _pressure_field(
    setup: Setup,
    mesh: Any,
    elements: ndarray,
    water: Any,
    surcharge: float,
) -> Callable[[ndarray, ndarray], ndarray] | None:
    """Return the water pressure as a function of coordinates and elements; None without water."""
    if water is None or water is False:
        return None
    # Evaluate the pressure at the corners, to compare it with the surface.
    pressure = as_pressure(water, mesh, setup.water_unit_weight)
    vertices = np.unique(mesh.t[:, elements])
    corners = mesh.p[:, vertices]
    if callable(pressure):
        _check_surface(corners, pressure(corners), surcharge)
        return lambda x, elements: pressure(x)
    # Pressures at the vertices are linear in the elements.
    if np.shape(pressure) != (mesh.nvertices,):
        raise ValueError(
            "water of the K0 procedure must be a level, points of it, a function of the "
            "coordinates such as that of a seepage, water.pressure_at, or pressures at the vertices"
        )
    nodal = np.asarray(pressure)
    _check_surface(corners, nodal[vertices], surcharge)
    return lambda x, elements: _linear(mesh, nodal, x, elements)


def gravity_state(
    setup: Setup,
    load: Force = None,
    *,
    K0: float | Mapping[str, float] | None = None,
    water: AtRest = None,
    name: str = "initial",
    increments: int = 1,
) -> Result:
    """Turn gravity on in ground of any shape; the displacements are then set to zero.

    Contact has followed the bodies: where it does not balance once it is back, equilibrium is
    found from this state.

    Parameters
    ----------
    load, water, name
        As for :meth:`initial_state`. Excess pressures of :class:`PoreWater` are zero.
    K0
        Where it is given, for all regions or by the name of a region, gravity first acts on
        elastic ground with Poisson's ratio K0 / (1 + K0), which gives this ratio under a level
        surface; then the ground's own materials find their equilibrium.
    increments
        Number of increments to begin with.

    Raises
    ------
    ValueError
        K0 outside (0, 1), or of a region that does not exist.
    """
    whole = _whole(setup, load, water)
    _check_inactive(setup, whole)
    dry, kept = _without_still_fields(setup)
    dry_load = whole[kept]
    first = None
    if K0 is not None:
        elastic = _with(dry, {**dry.forms, **_elastic_bodies(dry, K0)})
        first = _loaded(elastic, f"{name}, elastic", dry_load, 1, None)
    result = _at_rest(dry, _loaded(dry, name, dry_load, increments, first))
    return _wet(setup, _among_all(setup, kept, result), water)


def _elastic_bodies(setup: Setup, K0: float | Mapping[str, float]) -> dict[str, Any]:
    """Return the solids with elastic regions whose lateral stress is K0 times the vertical one."""
    solids = setup.solids
    regions = {region: None for form in solids.values() for region in form.materials}
    for region in K0 if isinstance(K0, Mapping) else ():
        look_up(region, regions, "region of the solids")
    # nu = K0 / (1 + K0) gives the ratio in one-dimensional compression.
    found = {}
    for key, form in solids.items():
        if isinstance(K0, Mapping):
            ratios = K0
        else:
            ratios = dict.fromkeys(form.materials, K0)
        given = {}
        for region, material in form.materials.items():
            if region in ratios:
                given[region] = _elastic(material, ratios[region])
        found[key] = form.with_materials(given)
    return found


def _loaded(
    setup: Setup,
    name: str,
    load: ndarray,
    increments: int,
    start: StageResult | None,
) -> StageResult:
    """Run a stage of a whole load."""
    stage = Stage(name, load, increments=increments)
    return run(setup, [stage], start=start, progress=False)[name]


def _whole(setup: Setup, load: Any, water: Any) -> ndarray:
    """Return the load on top, the weights of all forms and the load of water, (N,)."""
    return setup.load(load) + setup.weights(setup.forms) + setup.water_on(setup.forms, water)


def _wet(setup: Setup, result: Result, water: Any) -> Result:
    """Return a result that knows the water of its load: the first stage that follows keeps it."""
    known = {"water": own_arrays(water), "water_unit_weight": setup.water_unit_weight}
    return Result(tuple(replace(stage, **known) for stage in result))


def _with(setup: Setup, forms: Forms) -> Setup:
    """Return the set-up with other forms on the same dofs."""
    new = copy(setup)
    new.forms = new.own = dict(forms)
    vars(new).pop("solids", None)
    return new


def _at_rest(setup: Setup, last: StageResult) -> Result:
    """Return a stage without its displacements, in equilibrium.

    Contact has followed the bodies, and comes back.
    """
    name = last.name
    iterations = tuple(last.iterations)
    for remaining in reversed(range(_RETURNS)):
        # Keep stresses and forces, drop displacements, and look at the balance.
        start = Result((replace(last, name=f"{name}, moved"),)).reset()
        rest = start[-1]
        system = setup.checked_system(rest.forms, setup.fixed)
        now = system.evaluate(rest.x, rest.states, rest.load)
        if now.norm <= _BALANCED or remaining == 0:
            break
        last = _loaded(setup, name, rest.load, 1, start[-1])
        iterations += tuple(last.iterations)
    _check_balance(now, system)
    return Result((replace(rest, name=name, iterations=iterations, residual=now.norm),))


def _without_still_fields(setup: Setup) -> tuple[Setup, ndarray]:
    """Return the weightless set-up without pressures and multipliers, and its dofs."""
    still = setup.layout.still
    # Keep the forms that act on displacements alone.
    names = []
    for key, form in setup.forms.items():
        joins = joined_by(form)
        moves = all(field.moves for field in form.fields)
        if moves and (joins is None or not np.isin(joins, still).any()):
            names.append(key)
    for key in set(having(setup.forms, Touching)).difference(names):
        raise ValueError(
            f"'{key}' has DualMultipliers: initial states of the ground are for the penalty method "
            "and AugmentedLagrangian()"
        )
    dry, kept = setup.restricted(names)
    dry.gravity = 0.0 * setup.gravity
    return dry, kept


def _among_all(setup: Setup, kept: ndarray, result: Result) -> Result:
    """Return a result of the forms that move, of all forms and among all dofs."""
    # Forms that do not move keep their initial states.
    last = result[-1]
    forms = {key: last.forms.get(key, form) for key, form in setup.forms.items()}
    states = {key: last.states.get(key, form.initial_state()) for key, form in forms.items()}
    # Spread the vectors over all dofs.
    x = np.zeros(setup.layout.size)
    load = np.zeros(setup.layout.size)
    x[kept] = last.x
    load[kept] = last.load
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
                gravity=tuple(float(part) for part in setup.gravity),
                before=None,
                changed={},
                supports=None,
                supports_given=False,
            ),
        )
    )


def _check_inactive(setup: Setup, load: ndarray) -> ndarray:
    """Return the dofs of inactive bodies, on which neither load nor contact may act."""
    solids = setup.solids
    away = others(setup.layout.size, dofs_of(setup.forms, setup.layout))
    known = elements_in(solids.values())
    mesh = next(iter(solids.values())).basis.mesh
    check_contacts(setup.forms, away, np.setdiff1d(np.arange(mesh.nelements), known))
    if acts_on(load, away):
        raise ValueError(
            f"a part of the load acts on inactive bodies; the solids are {list(solids)}"
        )
    return away


def _balanced(setup: Setup, load: ndarray, stress: _StressField, name: str) -> Result:
    """Return a result with given stresses, tractions that balance them, and the residual."""
    inactive = _check_inactive(setup, load)
    system = setup.checked_system(setup.forms, np.union1d(setup.fixed, inactive))
    # Begin without displacements.
    x = np.zeros(system.size)
    states = {key: form.initial_state() for key, form in system.forms.items()}

    # Give the solids their stresses.
    solids = setup.solids
    for key, form in solids.items():
        points = np.asarray(form.basis.global_coordinates())
        values = np.array(stress(points, form.elements[:, None]), dtype=float)
        shape = states[key].stress.shape
        if values.shape != shape or not np.isfinite(values).all():
            raise ValueError(
                f"the stress of '{key}' must be finite and of shape {shape}; its shape is "
                f"{values.shape}"
            )
        states[key] = form.assemble(x[: form.size], form.initial_state(stress=values)).state
        _warn_of_returned(key, points, values, states[key].stress)

    # Give the contact pairs the tractions that balance the stresses.
    operators = {}
    for key, pair in having(system.forms, Touching).items():
        operator = pair.tractions_at(x[: pair.size], states[key])
        if operator is not None:
            operators[key] = operator
    if operators:
        force = internal_force(solids, x, states)
        near = {}
        for key, operator in operators.items():
            near[key] = _stress_at(operator.coordinates, stress, solids)
        states.update(prestressed(operators, load - force, system.free, near))
    now = system.evaluate(x, states, load)
    _check_balance(now, system)
    return Result((state_of(name, system, now, load, states),))


def state_of(
    name: str,
    system: System,
    now: Evaluation,
    load: ndarray,
    states: States,
) -> StageResult:
    """Return the stage of an initial state, from its evaluation."""
    return StageResult(
        name,
        now.z,
        load=load,
        states=states,
        iterations=(),
        residual=now.norm,
        summary=summaries(system.forms, now.z, states),
        forms=system.forms,
        layout=system.layout,
    )


def _warn_of_returned(name: str, points: ndarray, given: ndarray, borne: ndarray) -> None:
    """Warn of given stresses, (n_components, n_elements, n_points), that a solid cannot resist."""
    change = np.abs(borne - given).max(axis=0)
    largest = max_abs(given)
    returned = change > _RETURNED * largest
    if returned.any():
        worst = np.unravel_index(change.argmax(), change.shape)
        point = format_point(points[(slice(None), *worst)])
        warn(
            f"the stresses of '{name}' are beyond its strength at {returned.mean():.0%} of its "
            f"points: they are returned to the yield surface, and change by up to "
            f"{change[worst] / largest:.2g} of the largest, at {point}"
        )


def _check_balance(now: Evaluation, system: System) -> None:
    """Warn about forces that do not balance, at the level of the caller of the model's method."""
    if now.norm <= _BALANCED:
        return
    names = []
    for key, response in now.responses.items():
        if response.force[now.worst] != 0.0:
            names.append(key)
    warn(
        f"the initial stresses are out of balance by {now.norm:.2g} of the load, most "
        f"{system.layout.describe(now.worst)} of {names}: begin with a stage of the same load "
        "to let them find equilibrium"
    )


def _stress_at(points: ndarray, stress: _StressField, solids: Mapping[str, Any]) -> ndarray:
    """Return a field of stresses at coordinates, (4 or 6, n_points).

    Their elements are the elements of the nearest integration points.
    """
    elements = []
    for form in solids.values():
        elements.append(np.broadcast_to(form.elements[:, None], form.weight.shape).ravel())
    here = np.concatenate(elements)[nearest_points(points, solids)]
    values = stress(points.T[:, :, None], here[:, None])
    return np.asarray(values)[:, :, 0]


def nearest_points(points: ndarray, solids: Mapping[str, Any]) -> ndarray:
    """Return the numbers of the nearest integration points of all solids, for points (n, dim)."""
    inside = []
    for form in solids.values():
        coordinates = np.asarray(form.basis.global_coordinates())
        inside.append(coordinates.reshape(points.shape[1], -1).T)
    return np.asarray(scipy.spatial.cKDTree(np.concatenate(inside)).query(points)[1])


def _linear(mesh: Any, nodal: ndarray, x: ndarray, elements: ndarray) -> ndarray:
    """Return values at the vertices, (n_vertices,), at points in elements of the mesh.

    The points have the shape (dim, n, ...), the elements (n, 1).
    """
    here = elements[:, 0]
    element = linear_element(mesh)
    local = mesh.mapping().invF(x, tind=here)
    values = np.zeros(x.shape[1:])
    for i, vertices in enumerate(mesh.t[:, here]):
        values = values + element.lbasis(local, i)[0] * nodal[vertices][:, None]
    return values


def _check_surface(x: ndarray, pressure: ndarray, surcharge: float) -> None:
    """Refuse water that presses more than the surcharge on the highest of some nodes, (dim, n)."""
    given = finite(pressure, "the pressure")
    highest = x[-1] > x[-1].max() - _SAME * np.ptp(x[-1])
    values = np.where(highest, given, 0.0)
    k = values.argmax()
    if values[k] - surcharge > _SAME * max_abs(given):
        raise ValueError(
            f"water presses with {values[k]:.4g} on the surface at {format_point(x[:, k])}, where "
            f"the surcharge is {surcharge:.4g}: it counts water above the ground too, give "
            f"surcharge={values[k]:.4g} and what else presses there"
        )


def _layers(
    setup: Setup, elements: ndarray, unit_weights: float | Mapping[str, float] | None
) -> list[tuple[str, ndarray, float]]:
    """Return name, elements and unit weight of every layer, given or of the solids themselves."""
    mesh = next(iter(setup.solids.values())).basis.mesh
    if unit_weights is not None and not isinstance(unit_weights, Mapping):
        return [("the solids", elements, unit_weights)]
    if unit_weights is not None:
        if not unit_weights:
            raise ValueError(
                "unit_weights names no subdomain: leave it out to use the unit weights of the forms"
            )
        known = mesh.subdomains or {}
        return [(k, look_up(k, known, "subdomain"), gamma) for k, gamma in unit_weights.items()]
    return _own_layers(setup, mesh)


def _own_layers(setup: Setup, mesh: Any) -> list[tuple[str, ndarray, float]]:
    """Return name, elements and unit weight of every layer of the solids."""
    layers = []
    for name, form in setup.solids.items():
        if form.unit_weight is None:
            raise ValueError(
                f"'{name}' has no unit weight: give the form `unit_weight`, or k0_state "
                f"`unit_weights`"
            )
        if not isinstance(form.unit_weight, Mapping):
            layers.append((name, form.elements, float(form.unit_weight)))
            continue
        for part, gamma in form.unit_weight.items():
            inside = np.intersect1d(mesh.subdomains[part], form.elements)
            layers.append((part, inside, float(gamma)))
    return [layer for layer in layers if len(layer[1])]  # a subdomain may lie in other bodies


def _overburden(
    mesh: Any, layers: list[tuple[str, ndarray, float]]
) -> Callable[[ndarray], ndarray]:
    """Return the weight above a height, from layers that must be level."""
    # Find the upper and lower ends of the layers.
    extent = []
    for name, elements, gamma in layers:
        heights = mesh.p[-1, mesh.t[:, elements]]
        extent.append((name, gamma, float(heights.min()), float(heights.max())))
    levels = np.unique(np.array([layer[2:] for layer in extent]))
    weights = np.zeros(len(levels) - 1)
    # Layers at one height must have one unit weight.
    for k, (bottom, top) in enumerate(pairwise(levels)):
        here = {}
        for name, gamma, low, high in extent:
            if low <= bottom and top <= high:
                here[name] = gamma
        if len(set(here.values())) > 1:
            raise ValueError(
                f"the ground is not level: from height {bottom:g} to {top:g} there are the unit "
                f"weights {here}; use gravity_state, or equal weights now and the difference in a "
                "later stage"
            )
        weights[k] = next(iter(here.values()), 0.0)
    # Add up the weights from the top.
    of_layers = weights * np.diff(levels)
    above = np.append(np.cumsum(of_layers[::-1])[::-1], 0.0)
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
