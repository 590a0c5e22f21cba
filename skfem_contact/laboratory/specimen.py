"""Element tests: Newton's method for stress and strain of a point under prescribed components."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..checks import finite
from ..errors import IncrementTooLarge, NotConverged
from ..materials import Material
from ..materials.base import EXCESS_PRESSURE, Update, as_material, updated
from ..materials.elastic import refuse_functions
from .paths import COMPONENTS, PathStep
from .result import ElementTest

#: Residual as a share of the stresses; round-off of an update is some 1e-15 of the largest modulus
#: times the strain.
_TOLERANCE = 1e-10
#: Newton iterations: 3 to 6 are needed, 12 where an increment crosses an edge of the yield surface.
_MOST = 25
#: An increment is halved this often: 1e-6 of it is left.
_HALVINGS = 20
#: Change of the initial stress without strain, as a share, that shows a stress outside the yield
#: surface.
_DRIFT = 1e-8

#: Strain, stress, internal variables.
_State = tuple[ndarray, ndarray, ndarray]


def element_test(
    material: Material, stress: ArrayLike, path: PathStep | Sequence[PathStep]
) -> ElementTest:
    """Follow a material along a path of prescribed stresses and strains at a point.

    Parameters
    ----------
    material
        The material. A parameter that is an array has one value for each sample.
    stress
        Initial effective stress, tension positive: a number for an isotropic one, one number a
        sample, or components in rows, (4, n_samples) or (6, n_samples).
    path
        One step or several: :func:`laboratory.isotropic`, :func:`laboratory.oedometer`,
        :func:`laboratory.triaxial`,
        :func:`laboratory.simple_shear`, or any other :class:`laboratory.PathStep`.

    Returns
    -------
    ElementTest
        Histories of stress, strain and internal variables.

    Raises
    ------
    NotConverged
        Where the material cannot follow; its `result` holds the states before.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sand = sc.MohrCoulomb(E=2e4, nu=0.25, c=0.0, phi=[30.0, 35.0])
    >>> path = [sc.laboratory.isotropic(-200.0), sc.laboratory.triaxial(strain=-0.05)]
    >>> sc.element_test(sand, [-100.0, -100.0], path).q[-1].round(3)
    array([400.   , 538.034])
    """
    law, start = as_material(material), _components(stress)
    refuse_functions(law)
    state = np.zeros_like(start), start, law.initial_internal(start[:, :, None])[:, :, 0]
    _check_start(law, state)
    history = [(*state, np.zeros(start.shape[1]), -1, 0)]
    for number, step in enumerate([path] if isinstance(path, PathStep) else path):
        before, targets, rows = state, step.targets(state[1], state[0]), step.conditions(len(start))
        origin = rows[0] @ state[1], rows[1] @ state[0]
        for k in range(step.increments):
            goal = tuple(a + (k + 1) / step.increments * (b - a) for a, b in zip(origin, targets))
            try:
                state, count = _increment(law, state, rows, goal, step.duration / step.increments)
            except (_NoEquilibrium, IncrementTooLarge) as error:
                failure = NotConverged(
                    f"step {number} of the element test stops after {k} of {step.increments} "
                    f"increments: {error}{_advice(step, error)}; `result` of this error holds the "
                    "states before"
                )
                failure.result = _result(law, history)
                raise failure from error
            row = None if step.total is None else COMPONENTS.index(step.total)
            held = np.zeros(start.shape[1]) if row is None else state[1][row] - before[1][row]
            history.append((*state, held, number, count))
    return _result(law, history)


class _NoEquilibrium(Exception):
    """Failure of Newton's method in an increment."""


def _advice(step: PathStep, error: Exception) -> str:
    """Return what helps where two normal stresses are prescribed."""
    given = [name for name in COMPONENTS[:3] if name in step.stress]
    if len(given) != 2 or not isinstance(error.__cause__, np.linalg.LinAlgError):
        return ""
    return (
        f". Between the stresses {given[0]} and {given[1]}, where they are equal, the yield "
        f"condition leaves the "
        "strains free: laboratory.triaxial prescribes one of the lateral stresses and equal "
        "lateral strains, "
        "stress={'xx': None}, strain={'xx-zz': 0}"
    )


def _increment(
    law: Material,
    state: _State,
    rows: tuple[ndarray, ndarray],
    goal: tuple[ndarray, ...],
    dt: float,
    halvings: int = _HALVINGS,
) -> tuple[_State, int]:
    """Return the state at the goals of stress and strain, and the iterations; halve an increment
    that fails.
    """
    try:
        return _newton(law, state, rows, goal, dt)
    except (_NoEquilibrium, IncrementTooLarge):
        if halvings == 0:
            raise
    (S, E), (strain, stress, _) = rows, state
    middle = (S @ stress + goal[0]) / 2, (E @ strain + goal[1]) / 2
    half, first = _increment(law, state, rows, middle, dt / 2, halvings - 1)
    whole, second = _increment(law, half, rows, goal, dt / 2, halvings - 1)
    return whole, first + second


def _newton(
    law: Material,
    state: _State,
    rows: tuple[ndarray, ndarray],
    goal: tuple[ndarray, ...],
    dt: float,
) -> tuple[_State, int]:
    """Solve the conditions ``S stress = goal[0]`` and ``E strain = goal[1]`` for the strain
    increment.
    """
    (S, E), (strain, stress, internal) = rows, state
    elasticity = elasticity_at(law, stress, internal)
    scale, step, sizes = np.abs(elasticity).max(), np.zeros_like(strain), []
    strains = np.broadcast_to(E, (stress.shape[1], *E.shape))
    for count in range(_MOST):
        new = updated(law, step[:, :, None], stress[:, :, None], internal[:, :, None], dt)
        reached = new.stress[:, :, 0]
        missing = goal[0] - S @ reached, goal[1] - E @ (strain + step)
        largest = np.maximum(
            np.abs(reached).max(axis=0), np.abs(goal[0]).max(axis=0, initial=1e-300)
        )
        errors = np.concatenate((missing[0] / largest, missing[1] * scale / largest))
        sizes.append(np.abs(errors).max(axis=0))
        if not np.isfinite(sizes[-1]).all():
            break
        if count and sizes[-1].max() < _TOLERANCE:
            return (strain + step, reached, new.internal[:, :, 0]), count
        tangent = tangent_at(elasticity, new)
        try:
            change = np.linalg.solve(
                np.concatenate((S @ tangent, strains), axis=1),
                np.concatenate(missing).T[:, :, None],
            )[:, :, 0]
        except np.linalg.LinAlgError as error:
            raise _NoEquilibrium(
                "the stiffness under these conditions is singular: a stress is prescribed that the "
                "material does not resist, so prescribe a strain instead"
            ) from error
        step = step + change.T
    worst = int(np.argmax(np.nan_to_num(sizes[-1], nan=np.inf)))
    raise _NoEquilibrium(
        f"no equilibrium in {len(sizes)} iterations, {sizes[-1][worst]:.1e} of the stress is out "
        f"of "
        f"balance in sample {worst}, {_listed(stress[:, worst])}"
    )


def tangent_at(elasticity: ndarray, new: Update) -> ndarray:
    """Return d stress / d strain at all samples, (n_samples, ncomp, ncomp)."""
    if len(new.plastic) == 0:
        return elasticity
    tangent = elasticity.copy()
    tangent[new.plastic] = new.tangent()
    return tangent


def elasticity_at(law: Material, stress: ndarray, internal: ndarray) -> ndarray:
    """Return the elastic stiffness of the samples, (n_samples, ncomp, ncomp)."""
    ncomp, samples = stress.shape
    state = (stress[:, :, None], internal[:, :, None]) if law.stress_dependent else ()
    moduli = np.asarray(law.elasticity(ncomp, *state))
    return (
        moduli.reshape(samples, ncomp, ncomp)
        if moduli.ndim > 2
        else np.broadcast_to(moduli, (samples, ncomp, ncomp))
    )


def _components(stress: ArrayLike) -> ndarray:
    """Return initial stresses (ncomp, n_samples) from numbers or components."""
    values = finite(stress, "stress")
    if values.ndim < 2:
        return np.concatenate((np.tile(values, (3, 1)).reshape(3, -1), np.zeros((1, values.size))))
    if values.ndim > 2 or len(values) not in (4, 6):
        raise ValueError(
            f"stress must be a number, one number a sample, or of shape (4, n_samples) or (6, "
            f"n_samples), "
            f"not {values.shape}"
        )
    return values


def _check_start(law: Material, state: _State) -> None:
    """Refuse initial stresses that the material does not admit."""
    strain, stress, internal = state
    new = updated(law, strain[:, :, None], stress[:, :, None], internal[:, :, None], 0.0)
    drift = np.abs(new.stress[:, :, 0] - stress).max(axis=0)
    worst = int(np.argmax(drift))
    if drift[worst] > _DRIFT * np.abs(stress[:, worst]).max():
        raise ValueError(
            f"{law.label} does not admit the initial stress of sample {worst}, "
            f"{_listed(stress[:, worst])}: it lies outside the yield surface, by "
            f"{drift[worst]:.3g} in a "
            "component"
        )


def _listed(stress: ndarray) -> str:
    """Return the components of a stress by their names."""
    return ", ".join(f"{name} = {value:.4g}" for name, value in zip(COMPONENTS, stress))


def _result(law: Material, history: Sequence[tuple[Any, ...]]) -> ElementTest:
    """Return the histories; stresses of an undrained material become effective."""
    strain, stress, internal, pressure, numbers, counts = map(np.array, zip(*history))
    if (own := law.variable(EXCESS_PRESSURE, internal.swapaxes(0, 1))) is not None:
        pressure = pressure + own
    if law.undrained:
        stress = law.drained(stress.swapaxes(0, 1), internal.swapaxes(0, 1))[0].swapaxes(0, 1)
    return ElementTest(law, stress, strain, internal, pressure, numbers, counts)
