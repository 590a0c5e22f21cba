"""Element tests: Newton's method for stress and strain of a point under prescribed components."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..arrays import max_abs
from ..checks import finite
from ..errors import IncrementTooLarge, NotConverged
from ..materials import Material
from ..materials.base import EXCESS_PRESSURE, Update, as_material, updated
from ..materials.elastic import refuse_functions
from .paths import COMPONENTS, PathStep
from .result import ElementTest

#: Residual as a share of the stresses; round-off is about 1e-15 of largest modulus times strain.
_TOLERANCE = 1e-10
#: Newton iterations: 3 to 6 are needed, 12 where an increment crosses an edge of the yield surface.
_MOST = 25
#: An increment is halved this often: a thousandth of it remains.
_HALVINGS = 10
#: Change of the initial stress without strain, as a share, that shows a stress outside the yield
#: surface.
_DRIFT = 1e-8


class _State(NamedTuple):
    """State of the samples, components first."""

    strain: ndarray
    stress: ndarray
    internal: ndarray


class _Conditions(NamedTuple):
    """Conditions ``S stress = stresses`` and ``E strain = strains`` of an increment."""

    S: ndarray
    E: ndarray
    stresses: ndarray
    strains: ndarray


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
        :func:`laboratory.triaxial`, :func:`laboratory.simple_shear`, or any other
        :class:`laboratory.PathStep`.

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
    law = as_material(material)
    refuse_functions(law)
    # start each sample at a stress that the material admits
    start = _components(stress)
    internal = law.initial_internal(start[:, :, None])[:, :, 0]
    state = _State(np.zeros_like(start), start, internal)
    _check_start(law, state)

    pressure = np.zeros(start.shape[1])
    history = [(*state, pressure, -1, 0)]
    for number, step in enumerate([path] if isinstance(path, PathStep) else path):
        # Go from the values of the conditions at the start of the step to their targets.
        S, E = step.conditions(len(start))
        origin = S @ state.stress, E @ state.strain
        targets = step.targets(state.stress, state.strain)
        before = state.stress
        # Water of earlier steps stays where a total stress stays, and has drained otherwise.
        held = np.where(step.keeps_total, pressure, 0.0)
        for k in range(step.increments):
            share = (k + 1) / step.increments
            stresses, strains = (a + share * (b - a) for a, b in zip(origin, targets))
            conditions = _Conditions(S, E, stresses, strains)
            try:
                state, count = _increment(law, state, conditions, step.duration / step.increments)
            except (_NoEquilibrium, IncrementTooLarge) as error:
                failure = NotConverged(
                    f"step {number} of the element test stops after {k} of {step.increments} "
                    f"increments: {error}{_advice(step, error)}; `result` of this error holds the "
                    "states before"
                )
                failure.result = _result(law, history)
                raise failure from error

            # The total stress stays: the change of the effective stress is that of the pressure.
            pressure = held
            if step.total is not None:
                row = COMPONENTS.index(step.total)
                pressure = held + state.stress[row] - before[row]
            history.append((*state, pressure, number, count))
    return _result(law, history)


class _NoEquilibrium(Exception):
    """Failure of Newton's method in an increment."""


def _advice(step: PathStep, error: Exception) -> str:
    """Return advice where two normal stresses are prescribed."""
    given = [name for name in COMPONENTS[:3] if name in step.stress]
    if len(given) != 2 or not isinstance(error.__cause__, np.linalg.LinAlgError):
        return ""
    return (
        f". Between the stresses {given[0]} and {given[1]}, where they are equal, the yield "
        "condition leaves the strains free: laboratory.triaxial prescribes one of the lateral "
        "stresses and equal lateral strains, stress={'xx': None}, strain={'xx-zz': 0}"
    )


def _increment(
    law: Material,
    state: _State,
    conditions: _Conditions,
    dt: float,
    halvings: int = _HALVINGS,
) -> tuple[_State, int]:
    """Return the state that fulfils the conditions, and the iterations; halve if it fails."""
    try:
        return _newton(law, state, conditions, dt)
    except (_NoEquilibrium, IncrementTooLarge):
        if halvings == 0:
            raise

    # go half of the way, then the whole
    S, E, stresses, strains = conditions
    middle = conditions._replace(
        stresses=(S @ state.stress + stresses) / 2, strains=(E @ state.strain + strains) / 2
    )
    half, first = _increment(law, state, middle, dt / 2, halvings - 1)
    whole, second = _increment(law, half, conditions, dt / 2, halvings - 1)
    return whole, first + second


def _newton(law: Material, state: _State, conditions: _Conditions, dt: float) -> tuple[_State, int]:
    """Solve the conditions for the strain increment; return the state and the iterations."""
    S, E, stresses, strains = conditions
    elasticity = elasticity_at(law, state.stress, state.internal)
    scale = max_abs(elasticity)
    strain_rows = np.broadcast_to(E, (len(elasticity), *E.shape))  # (n_samples, n, ncomp)
    # A goal of zero is reached within the tolerance of the stress before.
    known = np.abs(np.concatenate((stresses, state.stress))).max(axis=0, initial=1e-300)
    increment = np.zeros_like(state.strain)
    for count in range(_MOST):
        # Evaluate the conditions.
        new = _updated(law, increment, state, dt)
        stress = new.stress[:, :, 0]
        strain = state.strain + increment
        missing_stress = stresses - S @ stress
        missing_strain = strains - E @ strain

        # Stop where each sample is in equilibrium.
        largest = np.maximum(np.abs(stress).max(axis=0), known)
        errors = np.concatenate((missing_stress / largest, missing_strain * scale / largest))
        error = np.abs(errors).max(axis=0)
        if not np.isfinite(error).all():
            break
        if count and error.max() < _TOLERANCE:
            return _State(strain, stress, new.internal[:, :, 0]), count

        # Solve [S D; E] change = missing.
        rows = np.concatenate((S @ tangent_at(elasticity, new), strain_rows), axis=1)
        missing = np.concatenate((missing_stress, missing_strain))
        try:
            change = np.linalg.solve(rows, missing.T[:, :, None])[:, :, 0]
        except np.linalg.LinAlgError as failure:
            raise _NoEquilibrium(
                "the stiffness under these conditions is singular: a stress is prescribed that the "
                "material does not resist, so prescribe a strain instead"
            ) from failure
        increment = increment + change.T

    # report the sample with the largest error
    worst = int(np.argmax(np.nan_to_num(error, nan=np.inf)))
    raise _NoEquilibrium(
        f"no equilibrium in {count + 1} iterations, {error[worst]:.1e} of the stress is out of "
        f"balance in sample {worst}, {_listed(state.stress[:, worst])}"
    )


def _updated(law: Material, increment: ndarray, state: _State, dt: float) -> Update:
    """Return the response of the samples, each an element of one point."""
    stress = state.stress[:, :, None]
    internal = state.internal[:, :, None]
    return updated(law, increment[:, :, None], stress, internal, dt)


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
    state: tuple[ndarray, ...] = ()
    if law.stress_dependent:
        state = (stress[:, :, None], internal[:, :, None])
    moduli = np.asarray(law.elasticity(ncomp, *state))
    if moduli.ndim > 2:
        return moduli.reshape(samples, ncomp, ncomp)
    return np.broadcast_to(moduli, (samples, ncomp, ncomp))


def _components(stress: ArrayLike) -> ndarray:
    """Return initial stresses (ncomp, n_samples) from numbers or components."""
    values = finite(stress, "stress")
    if values.ndim < 2:
        components = np.zeros((4, values.size))
        components[:3] = values
        return components
    if values.ndim > 2 or len(values) not in (4, 6):
        raise ValueError(
            "stress must be a number, one number a sample, or of shape (4, n_samples) or (6, "
            f"n_samples), not {values.shape}"
        )
    return values


def _check_start(law: Material, state: _State) -> None:
    """Refuse initial stresses that the material does not admit."""
    new = _updated(law, state.strain, state, 0.0)
    drift = np.abs(new.stress[:, :, 0] - state.stress).max(axis=0)
    worst = int(np.argmax(drift))
    stress = state.stress[:, worst]
    if drift[worst] > _DRIFT * max_abs(stress):
        raise ValueError(
            f"{law.label} does not admit the initial stress of sample {worst}, {_listed(stress)}: "
            f"it lies outside the yield surface, by {drift[worst]:.3g} in a component"
        )


def _listed(stress: ndarray) -> str:
    """Return the components of a stress by their names."""
    return ", ".join(f"{name} = {value:.4g}" for name, value in zip(COMPONENTS, stress))


def _result(law: Material, history: Sequence[tuple[Any, ...]]) -> ElementTest:
    """Return the histories; stresses of an undrained material become effective."""
    strain, stress, internal, pressure, numbers, counts = map(np.array, zip(*history))
    own = law.variable(EXCESS_PRESSURE, internal.swapaxes(0, 1))
    if own is not None:
        pressure = pressure + own
    if law.undrained:
        effective, _ = law.drained(stress.swapaxes(0, 1), internal.swapaxes(0, 1))
        stress = effective.swapaxes(0, 1)
    return ElementTest(
        law,
        stress,
        strain,
        internal,
        pressure,
        numbers,
        counts,
    )
