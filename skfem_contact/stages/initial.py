"""Initial states: the stresses that the ground has before anything is built."""
from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

from ..contact.penalty import choose_penalties
from ..contact.prestress import prestressed
from ..errors import AnalysisWarning, check_basis, look_up, place
from ..forms.base import Form, as_forms, carried, solids_of
from ..loads import by_element
from ..materials.elastic import LinearElastic
from ..nonlinear.evaluation import Evaluation
from ..nonlinear.system import System
from ..results.result import Result, StageResult
from .activation import acts_on, among, check_contacts
from .run import Stage, run
from .setup import build_system, on_all, unknowns_of
from .supports import all_unknowns, as_unknowns

#: Forces out of balance, as a share of the load, of which a warning is given.
_BALANCED = 1e-6
#: ... and how often bodies may come back: beside a pile with nodal contact 6e-2, 4e-5, 8e-8 are left, else 3e-4, 4e-9.
_RETURNS = 4

#: Stress at places (2, ...) in elements of the mesh.
_Field = Callable[[ndarray, ndarray], ndarray]


def given_state(forms: Mapping[str, Form], load: ndarray, fixed: ndarray, stress: Callable[[ndarray], ndarray],
                name: str = "initial") -> Result:
    """Start from a given field of stresses; nothing has moved.

    Where a material cannot bear a stress it is returned to the yield surface, and counted as yielded. Contact
    pairs get the tractions that balance the stresses on both sides.

    Parameters
    ----------
    forms
        Solids and contact pairs that are there at first. Other bodies of the mesh stay where they are.
    load
        External forces that the stresses are in equilibrium with, (N,).
    fixed
        Layout that are held.
    stress
        Stress (xx, yy, zz, xy), tension positive, at places (2, n_elements, n_points): (4, n_elements, n_points); in
        three dimensions 6 components at places (3, n_elements, n_points).
    name
        Name of the state in the result.

    Returns
    -------
    Result
        A start for :func:`run`; its residual tells how good the equilibrium is. A stage with the same load, a *null
        step*, removes what is left of it.

    Raises
    ------
    ValueError
        A field of another shape or with NaN, and whatever :func:`run` refuses.

    Warns
    -----
    AnalysisWarning
        The forces out of balance exceed 1e-6 of the load.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=.3))}
    >>> fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    >>> above = lambda x: 20. * (x[1] - 1.)
    >>> start = sc.Model(forms, fixed).initial_state(sc.weight(basis, 20.), stress=lambda x: np.stack((.5 * above(x), above(x), .5 * above(x), 0. * above(x))))
    >>> print(sc.Model(forms, fixed).run([sc.Stage("null step", sc.weight(basis, 20.))], start=start))
    stage            increments  iterations  residual  load    state
    initial                   0           0   ...  100%
    null step                 1           0   ...  100%
    """
    return _balanced(forms, load, fixed, lambda x, elements: stress(x), name)


def k0_state(forms: Mapping[str, Form], load: ndarray, fixed: ndarray, unit_weights: float | Mapping[str, float],
             K0: float | Mapping[str, float], surcharge: float = 0.0, water: Callable[[ndarray], ndarray] | None = None,
             name: str = "initial") -> Result:
    """K0 procedure for level ground: vertical stress from the weight above, horizontal stress K0 times as much.

    Where the surface or the layers are not level use :func:`gravity_state`.

    Parameters
    ----------
    forms, fixed, name
        As for :func:`given_state`.
    load
        External forces: weight, surcharge and :func:`water_load`, (N,).
    unit_weights
        As for :func:`weight`: one number, or by subdomain; subdomains that are not named are weightless.
    K0
        Ratio of the effective stresses: one number, or by subdomain.
    surcharge
        Pressure on the surface, that of water above it included.
    water
        Pore pressure as a function of the place, for instance :func:`hydrostatic`; with it stresses are effective,
        everywhere. A wall that is wished in place, which has no pores, begins as the ground in its place: with that
        weight and with :func:`water_load` on it too. Both become its own in the next stage.

    Returns
    -------
    Result
        As of :func:`given_state`.

    Raises
    ------
    ValueError
        Unknown subdomain, elements without K0, different unit weights at the same height (the ground is not level).

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"ground": sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=.3, c=1., phi=30.))}
    >>> fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    >>> start = sc.Model(forms, fixed).k0_state(sc.weight(basis, 20.), unit_weights=20., K0=.5)
    >>> stress = start["initial"].states["ground"].stress
    >>> bool(np.allclose(stress[0], .5 * stress[1])), bool(start["initial"].residual < 1e-12)
    (True, True)
    """
    forms = as_forms(forms)
    basis = next(iter(_solids(forms).values())).basis
    check_basis(basis)
    mesh = basis.mesh
    elements = np.concatenate([form.elements for form in _solids(forms).values()])
    overburden, ratios = _overburden(mesh, elements, unit_weights), by_element(mesh, K0, "K0", np.nan)
    missing = elements[np.isnan(ratios[elements])]
    if len(missing):
        tags = [tag for tag, part in (mesh.subdomains or {}).items() if np.isin(part, missing).any()]
        raise ValueError(f"{len(missing)} elements have no K0; they lie in the subdomains {tags}")
    if not ((ratios[elements] >= 0.0) & (ratios[elements] < np.inf)).all():
        raise ValueError(f"K0 must be a number, not negative, unlike {K0!r}")

    def stress(x: ndarray, elements: ndarray) -> ndarray:
        vertical = -surcharge - overburden(x[-1])
        if water is not None:
            vertical = vertical + water(x)
        horizontal, none = ratios[elements] * vertical, np.zeros_like(vertical)
        plane = (horizontal, vertical, horizontal, none)
        return np.stack(plane if len(x) == 2 else (horizontal, horizontal, vertical, none, none, none))

    return _balanced(forms, load, fixed, stress, name)


def gravity_state(forms: Mapping[str, Form], load: ndarray, fixed: ndarray,
                  K0: float | Mapping[str, float] | None = None, name: str = "initial", increments: int = 1) -> Result:
    """Turn gravity on in ground of any shape; the displacements are then set to zero.

    Contact has followed the bodies: where it does not balance once it is back, equilibrium is found from there.

    Parameters
    ----------
    forms, load, fixed, name
        As for :func:`given_state`. Excess pressures of :class:`PoreWater` are zero.
    K0
        Where it is given, for all regions or by the name of a region, gravity first acts on elastic ground with
        Poisson's ratio K0 / (1 + K0), which gives this ratio under a level surface; then the ground's own
        materials find their equilibrium.
    increments
        Number of increments to begin with.

    Returns
    -------
    Result
        A start for :func:`run`.

    Raises
    ------
    ValueError
        K0 outside (0, 1), or of a region that does not exist.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> forms = {"ground": sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=.3, c=10., phi=30.))}
    >>> fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    >>> start = sc.Model(forms, fixed).gravity_state(sc.weight(basis, 20.), K0=.5)
    >>> stress = start["initial"].states["ground"].stress
    >>> bool(np.allclose(stress[0], .5 * stress[1])), bool(start["initial"].x.any())
    (True, False)
    """
    wet = as_forms(forms)
    fixed, forms = _held(wet, load, fixed), _without_water(wet)
    n = all_unknowns(forms).size
    load, fixed = np.asarray(load)[:n], fixed[fixed < n]
    stages = [Stage(name, load, increments=increments)]
    if K0 is None:
        return _with_water(wet, _at_rest(forms, run(forms, stages, fixed, progress=False)[name], fixed))
    forms = choose_penalties(forms)  # the same for elastic ground
    elastic = dict(forms)
    regions = {region for form in _solids(forms).values() for region in form.materials}
    for region in K0 if isinstance(K0, Mapping) else ():
        look_up(region, dict.fromkeys(regions), "region of the solids")
    for key, form in _solids(forms).items():
        ratios = K0 if isinstance(K0, Mapping) else dict.fromkeys(form.materials, K0)
        given = {region: _elastic(m, ratios[region]) for region, m in form.materials.items() if region in ratios}
        elastic[key] = form.with_materials(given)
    first = run(elastic, [Stage(f"{name}, elastic", load)], fixed, progress=False)
    last = run(forms, stages, fixed, start=first, progress=False)[name]
    return _with_water(wet, _at_rest(forms, last, fixed))


def _at_rest(forms: Mapping[str, Form], last: StageResult, fixed: ndarray) -> Result:
    """A stage without its displacements, in equilibrium there: contact has followed the bodies, and comes back."""
    name, iterations = last.name, last.iterations
    for left in reversed(range(_RETURNS)):
        start = Result((replace(last, name=f"{name}, moved"),)).reset()
        rest = start[-1]
        system = build_system(rest.forms, fixed)
        now = system.evaluate(rest.x, rest.states, rest.load)
        if now.norm <= _BALANCED or left == 0:
            break
        last = run(forms, [Stage(name, rest.load)], fixed, start=start, progress=False)[name]
        iterations += last.iterations
    _check_balance(now, system)
    return Result((replace(rest, name=name, iterations=iterations, residual=now.norm),))


def _without_water(forms: Mapping[str, Form]) -> dict[str, Form]:
    """The forms but those that bring fields that do not move, or act on these."""
    still = {key: field.numbers for key, form in forms.items() for field in form.fields if not field.moves}
    return {key: form for key, form in forms.items() if key not in still and not any(
        np.isin(form.joins, numbers).any() for numbers in still.values() if form.joins is not None)}


def _with_water(forms: Mapping[str, Form], result: Result) -> Result:
    """A result of the forms without water, of all of them and among all unknowns."""
    last, given = result[-1], choose_penalties(forms)
    if len(given) == len(last.states):
        return result
    everything = {key: last.forms.get(key, form) for key, form in given.items()}
    states = {key: last.states.get(key, form.initial_state()) for key, form in everything.items()}
    summary = {key: form.summary(states[key]) for key, form in everything.items()}
    last = among(last, all_unknowns(forms))
    return Result((*result.stages[:-1], replace(last, states=states, summary=summary, forms=everything)))


def _solids(forms: Mapping[str, Form]) -> dict[str, Any]:
    if not (found := solids_of(forms)):
        raise ValueError("there is no SolidForm among the forms: nothing carries load")
    return found


def _held(forms: Mapping[str, Form], load: ndarray, fixed: ndarray) -> ndarray:
    """Supported unknowns, and those of bodies that are not there yet: neither load nor contact may act on these."""
    solids = _solids(forms)
    unknowns = all_unknowns(forms)
    load = on_all(load, unknowns, "the load")
    away = np.setdiff1d(np.arange(unknowns.size), unknowns_of(forms))
    check_contacts(forms, away)
    if acts_on(load, away):
        raise ValueError(f"a part of the load acts on bodies that are not there; the solids are {list(solids)}")
    return np.union1d(as_unknowns(fixed), away)


def _balanced(forms: Mapping[str, Form], load: ndarray, fixed: ndarray, stress: _Field, name: str) -> Result:
    """A result with these stresses, tractions to balance them, and the residual that is left."""
    forms = as_forms(forms)
    fixed = _held(forms, load, fixed)
    system = build_system(forms, fixed)
    load = on_all(load, system.unknowns, "the load")
    x = np.zeros(system.size)
    states = {key: form.initial_state() for key, form in system.forms.items()}
    solids = _solids(system.forms)
    for key, form in solids.items():
        values = np.array(stress(np.asarray(form.basis.global_coordinates()), form.elements[:, None]), dtype=float)
        if values.shape != states[key].stress.shape or not np.isfinite(values).all():
            raise ValueError(f"the stress of '{key}' must be finite and of shape {states[key].stress.shape}; its shape "
                             f"is {values.shape}")
        states[key] = form.assemble(x[:form.size], replace(states[key], stress=values)).state
    bearing = {key: form.tractions_at(x[:form.size], states[key]) for key, form in system.forms.items()}
    operators = {key: operator for key, operator in bearing.items() if operator is not None}
    if operators:
        force = carried(solids, x, states)
        near = {key: _stress_at(operator.places, stress, solids) for key, operator in operators.items()}
        states.update(prestressed(operators, load - force, system.free, near))
    now = system.evaluate(x, states, load)
    _check_balance(now, system)
    summary = {key: form.summary(states[key]) for key, form in system.forms.items()}
    return Result((StageResult(name, x, load, states, (), now.norm, 1.0, summary, system.forms),))


def _check_balance(now: Evaluation, system: System) -> None:
    """Warn of forces that do not balance, where what the user called has called the caller."""
    if now.norm > _BALANCED:
        at = place(system.unknowns.places[:, now.worst])
        names = [key for key, response in now.responses.items() if response.force[now.worst] != 0.0]
        warnings.warn(f"the initial stresses are out of balance by {now.norm:.2g} of the load, most at {at} of {names}"
                      ": begin with a stage of the same load to let them find equilibrium", AnalysisWarning,
                      stacklevel=4)


def _stress_at(places: ndarray, stress: _Field, solids: Mapping[str, Any]) -> ndarray:
    """A field of stresses at places, (4 or 6, n_points); their elements are those of the nearest points."""
    inside = [np.asarray(form.basis.global_coordinates()).reshape(places.shape[1], -1).T for form in solids.values()]
    elements = [np.broadcast_to(form.elements[:, None], form.weight.shape).ravel() for form in solids.values()]
    nearest = cKDTree(np.concatenate(inside)).query(places)[1]
    return np.asarray(stress(places.T[:, :, None], np.concatenate(elements)[nearest][:, None]))[:, :, 0]


def _overburden(mesh: Any, elements: ndarray, unit_weights: float | Mapping[str, float]
                ) -> Callable[[ndarray], ndarray]:
    """Weight above a height, from layers that must be level."""
    everything = {"the solids": elements}
    layers, subdomains = (unit_weights, mesh.subdomains or {}) if isinstance(unit_weights, Mapping) else (
        dict.fromkeys(everything, unit_weights), everything)
    extent = {}
    for name in layers:
        heights = mesh.p[-1, mesh.t[:, look_up(name, subdomains, "subdomain")]]
        extent[name] = float(heights.min()), float(heights.max())
    levels = np.unique(np.array([level for ends in extent.values() for level in ends]))
    weights = np.zeros(len(levels) - 1)
    for k, (bottom, top) in enumerate(pairwise(levels)):
        here = {name: layers[name] for name, (low, high) in extent.items() if low <= bottom and top <= high}
        if len(set(here.values())) > 1:
            raise ValueError(f"the ground is not level: from height {bottom:g} to {top:g} there are the unit weights "
                             f"{here}; use gravity_state, or equal weights now and the difference in a later stage")
        weights[k] = next(iter(here.values()), 0.0)
    above = np.append(np.cumsum((weights * np.diff(levels))[::-1])[::-1], 0.0)
    return lambda y: np.interp(y, levels, above)


def _elastic(material: Any, K0: float) -> LinearElastic:
    if not 0.0 < K0 < 1.0:
        raise ValueError(f"K0 must lie between 0 and 1 for elastic ground, not {K0!r}; k0_state has no such limit")
    return LinearElastic(E=material.E, nu=K0 / (1.0 + K0))
