"""Checks of own materials and interface laws on random states, and tools of all checks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..contact.laws import InterfaceLaw, Status
from ..contact.laws import LawUpdate as Traction
from ..materials.base import Material, Update, as_material, updated
from ..materials.elastic import refuse_functions

#: Steps of the differences, relative to the size of what is varied.
STEP = 1e-6
#: What counts as round-off, relative to the size of the values.
EXACT = 1e-9
#: Second differences above this share of the first ones show a kink, where there is no tangent.
_KINK = 1e-3


class CheckFailed(AssertionError):
    """Violation of a property that an analysis relies on."""


def differences(function: Callable[[float], ndarray], h: float) -> tuple[ndarray, ndarray]:
    """Return the central difference, and by how much the one-sided ones differ."""
    forward, backward, middle = function(h), function(-h), function(0.0)
    return (forward - backward) / (2 * h), np.abs(forward - 2 * middle + backward) / h


def largest_error(
    error: ndarray, kink: ndarray, tolerance: float, message: str, kinks: float = 0.1
) -> float:
    """Return the largest error at smooth points; at most the share `kinks` of the points may be
    others.
    """
    smooth = kink <= _KINK
    require(
        smooth.mean() >= 1.0 - kinks,
        f"{np.sum(~smooth)} of {smooth.size} derivatives jump and cannot be checked",
    )
    require_all(
        ~smooth | (error <= tolerance), f"{message}, by {error[smooth].max(initial=0.0):.1e}"
    )
    return float(error[smooth].max(initial=0.0))


def same_twice(function: Callable[[], Any], arguments: tuple[ndarray, ...], name: str) -> Any:
    """Return the value of a function, which must be the same twice; arguments must not change."""
    before = [a.copy() for a in arguments]
    first, second = function(), function()
    require(
        all(
            np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
            for a, b in zip(arguments, before, strict=True)
        ),
        f"{name} changes its arguments",
    )
    for a, b in zip(
        *((first, second) if isinstance(first, tuple) else ((first,), (second,))), strict=True
    ):
        same = callable(a) or np.array_equal(a, b, equal_nan=np.asarray(a).dtype.kind == "f")
        require(same, f"{name} returns other values the second time")
    return first


def require(holds: Any, message: str) -> None:
    """Raise :class:`CheckFailed` unless the condition holds."""
    if not holds:
        raise CheckFailed(message)


def require_all(holds: ndarray, message: str) -> None:
    """Raise :class:`CheckFailed` with the number of points where the condition does not hold."""
    if not np.all(holds):
        raise CheckFailed(f"{message} ({np.sum(~holds)} of {np.size(holds)} points)")


def check_material(
    material: Material,
    strain: float = 1e-3,
    shape: tuple[int, int] = (50, 4),
    ncomp: Literal[4, 6] = 4,
    steps: int = 5,
    dissipation: bool = True,
    tolerance: float = 1e-5,
    seed: int = 0,
    initial_stress: float = 0.0,
) -> float:
    """Check a material on random strain paths.

    Shapes are right, a second call returns the same, and arguments do not change.  The returned
    stress is admissible: a zero increment does not change it.  Points that `plastic` does not name
    are elastic.  The tangent agrees with central differences wherever the step has no kink.
    Plastic flow dissipates.

    Parameters
    ----------
    material
        The material.
    strain
        Size of the strain increments, large enough for all branches of the material: 1e-3 for stiff
        soil.
    shape
        Numbers of elements and of points in each; parameters that are arrays have one value per
        element.
    ncomp
        4 components (xx, yy, zz, xy) or 6.
    steps
        Length of the paths.
    dissipation
        True if plastic strain must do work on the stress in every step. The plastic strain is that
        of the accepted stiffness: pass False for a hyperelastic law, whose stiffness changes in the
        step.
    tolerance
        Error of the tangent, relative to the largest elastic modulus.
    seed
        Seed of the random numbers.
    initial_stress
        Isotropic stress from which the paths start, tension positive.

    Returns
    -------
    float
        Largest error of the tangent.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.testing.check_material(sc.MohrCoulomb(E=1e4, nu=.3, c=5., phi=30., psi=10.)) < 1e-6
    True
    """
    rng, material = np.random.default_rng(seed), as_material(material)
    refuse_functions(material)
    D = np.asarray(material.elasticity(ncomp))
    require(
        D.shape in ((ncomp, ncomp), (shape[0], ncomp, ncomp)), f"elasticity has the shape {D.shape}"
    )
    require(
        np.abs(D - np.swapaxes(D, -1, -2)).max() <= EXACT * np.abs(D).max(),
        "the elasticity is not symmetric",
    )
    require(np.linalg.eigvalsh(D).min() > 0, "the elasticity is not positive definite")
    stress = np.zeros((ncomp, *shape))
    stress[:3] = initial_stress
    internal = material.initial_internal(stress)
    worst = 0.0
    for _ in range(steps):
        increment = strain * rng.standard_normal((ncomp, *shape)) * rng.uniform(0, 1, shape)
        D = _moduli(material, stress, internal)
        new = same_twice(
            lambda e=increment, s=stress, i=internal: updated(material, e, s, i, 0.0),  # type: ignore[misc]
            (increment, stress, internal),
            "material.update",
        )
        _check_update(new, internal.shape, stress.shape)
        again = updated(material, np.zeros_like(increment), new.stress, new.internal, 0.0)
        require_all(
            np.abs(again.stress - new.stress).max(axis=0) <= 1e-7 * np.abs(new.stress).max(),
            "the stress is not admissible: a zero increment changes it",
        )
        elastic = np.linalg.solve(D, np.moveaxis(new.stress - stress, 0, -1)[..., None])[..., 0]
        flow = increment - np.moveaxis(elastic, -1, 0)
        plastic = np.zeros(shape, bool)
        plastic.ravel()[new.plastic] = True
        require_all(
            plastic | (np.abs(flow).max(axis=0) <= EXACT * strain),
            "points that are not named in `plastic` are not elastic",
        )
        if dissipation:
            require_all(
                (new.stress * flow).sum(axis=0) >= -EXACT * np.abs(new.stress).max() * strain,
                "plastic flow dissipates a negative work",
            )
        worst = max(
            worst,
            _material_tangent(material, increment, stress, internal, new, D, strain, tolerance),
        )
        stress, internal = new.stress, new.internal
    return worst


def _moduli(material: Material, stress: ndarray, internal: ndarray) -> ndarray:
    """Return the elastic stiffness at the points of a state, (n_elements, n_points, ncomp,
    ncomp).
    """
    ncomp = len(stress)
    if material.stress_dependent:
        return material.elasticity(ncomp, stress, internal)
    D = np.asarray(material.elasticity(ncomp))
    return np.broadcast_to(D if D.ndim == 2 else D[:, None], (*stress.shape[1:], ncomp, ncomp))


def _check_update(new: Update, internal: tuple[int, ...], stress: tuple[int, ...]) -> None:
    require(
        new.stress.shape == stress, f"the stress has the shape {new.stress.shape}, not {stress}"
    )
    require(
        np.isfinite(new.stress).all() and np.isfinite(new.internal).all(),
        "the values are not finite",
    )
    n, points = len(new.plastic), int(np.prod(stress[1:]))
    require(
        new.internal.shape == internal,
        f"the internal variables have the shape {new.internal.shape}, not {internal}",
    )
    require(
        n == len(np.unique(new.plastic))
        and (n == 0 or 0 <= new.plastic.min() <= new.plastic.max() < points),
        "`plastic` must hold different indices of points",
    )
    tangent = new.tangent()
    wanted = (n, stress[0], stress[0])
    require(
        n == 0 or tangent.shape == wanted,
        f"the tangent has the shape {tangent.shape}, not {wanted}",
    )


def _material_tangent(
    material: Material,
    increment: ndarray,
    stress: ndarray,
    internal: ndarray,
    new: Update,
    D: ndarray,
    strain: float,
    tolerance: float,
) -> float:
    """Return the largest error of the tangent at smooth points."""
    ncomp, h, modulus = len(stress), STEP * strain, np.abs(D).max()
    tangent = D.reshape(-1, ncomp, ncomp).copy()
    if len(new.plastic):
        tangent[new.plastic] = new.tangent()

    def stress_at(j: int, step: float) -> ndarray:
        moved = increment.copy()
        moved[j] += step
        return updated(material, moved, stress, internal, 0.0).stress

    slopes = [differences(lambda step, j=j: stress_at(j, step), h) for j in range(ncomp)]  # type: ignore[misc]
    slope = np.stack([s for s, _ in slopes]).reshape(ncomp, ncomp, -1).transpose(2, 1, 0)
    kinks = np.stack([k for _, k in slopes]).reshape(ncomp * ncomp, -1).max(axis=0)
    return largest_error(
        np.abs(slope - tangent).max(axis=(1, 2)) / modulus,
        kinks / modulus,
        tolerance,
        "the tangent differs from the differences of the stress",
    )


def check_interface_law(
    law: InterfaceLaw,
    penalties: tuple[float, float] = (1e4, 1e4),
    size: float = 1e-3,
    n: int = 500,
    tolerance: float = 1e-6,
    seed: int = 0,
    dimensions: tuple[int, ...] = (2, 3),
) -> float:
    """Check an interface law on random gaps and slips, in the plane and in space.

    Shapes are right, a second call returns the same, and arguments do not change.  Open points are
    out of reach, and closed points of zero gap resist pressure.  The tangent agrees with
    differences.  The returned traction is admissible: the elastic slip with the new internal
    variables gives the same traction.  Slip dissipates, opposite directions are alike, and pressure
    does not fall with penetration.  All of this holds with initial internal variables and with
    those that the law returns.

    Parameters
    ----------
    law
        The interface law, with numbers as parameters.
    penalties
        Normal and tangential penalty.
    size
        Size of gaps and slips.
    n
        Number of random points.
    tolerance
        Error of the derivatives, relative to the larger penalty.
    seed
        Seed of the random numbers.
    dimensions
        Dimensions of use: in 3 the slip has two components.

    Returns
    -------
    float
        Largest error of the derivatives.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.testing.check_interface_law(sc.Coulomb(mu=.3, adhesion=2.)) < 1e-8
    True
    """
    require(isinstance(law, InterfaceLaw), "the law is no InterfaceLaw")
    require(isinstance(law.bonds, bool), "`bonds` must be True or False")
    rng, worst = np.random.default_rng(seed), 0.0
    for dim in dimensions:
        internal = np.zeros((law.n_internal, n))
        for _ in range(3):  # initial internal variables, and twice those that the law returned
            jump = size * np.concatenate(
                (rng.uniform(-1, 1, (1, n)), rng.standard_normal((dim - 1, n)))
            )
            jump[1:, : n // 10] = 0.0
            reached = _check_reach(law, jump[0], internal, rng.random(n) < 0.5)
            new = _check_traction(law, jump[:, reached], internal[:, reached], penalties, size)
            worst = max(
                worst,
                _law_tangent(
                    law, jump[:, reached], internal[:, reached], penalties, size, tolerance
                ),
            )
            internal[:, reached] = new.internal
        _check_touching(law, penalties, dim)
    return worst


def _check_reach(law: InterfaceLaw, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
    """Return the points within reach: none that was open and still is, except by its internal
    variables.
    """
    reached = same_twice(
        lambda: law.reaches(gap, internal, closed), (gap, internal, closed), "law.reaches"
    )
    require(
        np.shape(reached) == gap.shape and np.asarray(reached).dtype == bool,
        "`reaches` must return (n,) booleans",
    )
    untouched = (internal == 0.0).all(axis=0)
    require_all(
        ~(reached & ~closed & (gap > 0.0) & untouched),
        "`reaches` names points that were open and still are",
    )
    return np.asarray(reached)


def _check_traction(
    law: InterfaceLaw, jump: ndarray, internal: ndarray, penalties: tuple[float, float], size: float
) -> Traction:
    """Check shapes, signs and admissibility of the traction, and return the update."""

    def updated(slip: ndarray, before: ndarray) -> Traction:
        return law.update(np.concatenate((jump[:1], slip)), before, penalties)

    new = same_twice(lambda: law.update(jump, internal, penalties), (jump, internal), "law.update")
    dim, n = jump.shape
    shapes = {
        "traction": (dim, n),
        "internal": (law.n_internal, n),
        "tangent": (dim, dim, n),
        "elastic_slip": (dim - 1, n),
        "status": (n,),
    }
    for name, shape in shapes.items():
        value = getattr(new, name)
        require(np.shape(value) == shape, f"{name} has the shape {np.shape(value)}, not {shape}")
        require(np.isfinite(value).all(), f"{name} is not finite")
    require_all(
        np.isin(new.status, [int(s) for s in Status]), "`status` has values that are no Status"
    )
    force = max(float(np.abs(new.traction).max(initial=0.0)), 1e-300)
    again = updated(new.elastic_slip, new.internal).traction
    require_all(
        (np.abs(again - new.traction) <= EXACT * force).all(axis=0),
        "the traction is not admissible: the elastic slip gives another one",
    )
    opposite = updated(-jump[1:], internal).traction
    require_all(
        (np.abs(opposite[1:] + new.traction[1:]) <= EXACT * force).all(axis=0),
        "the opposite slip gives no opposite traction",
    )
    work = (new.traction[1:] * (jump[1:] - new.elastic_slip)).sum(axis=0)
    require_all(work >= -EXACT * force * size, "sliding dissipates negative work")
    require_all((new.tangent[0, 0] >= 0) | (jump[0] > 0), "the pressure falls with the penetration")
    return new


def _law_tangent(
    law: InterfaceLaw,
    jump: ndarray,
    internal: ndarray,
    penalties: tuple[float, float],
    size: float,
    tolerance: float,
) -> float:
    """Return the largest difference between tangent and differences, component by component."""

    def traction(by: int) -> Callable[[float], ndarray]:
        unit = np.eye(len(jump))[by][:, None]
        return lambda d: law.update(jump + d * unit, internal, penalties).traction

    tangent, scale, worst = law.update(jump, internal, penalties).tangent, max(penalties), 0.0
    for by in range(len(jump)):
        slope, kink = differences(traction(by), STEP * size)
        for of in range(len(jump)):
            worst = max(
                worst,
                largest_error(
                    np.abs(slope[of] - tangent[of, by]) / scale,
                    kink[of] / scale,
                    tolerance,
                    f"tangent[{of}, {by}] differs from the differences",
                    kinks=0.5,
                ),
            )
    return worst


def _check_touching(law: InterfaceLaw, penalties: tuple[float, float], dim: int) -> None:
    """Check that points of zero gap are closed: bodies in contact as meshed need them."""
    jump, internal = np.zeros((dim, 1)), np.zeros((law.n_internal, 1))
    require(
        np.all(law.reaches(jump[0], internal, np.ones(1, bool))),
        "closed points of zero gap are out of reach: bodies in contact as meshed would be loose",
    )
    require(
        np.all(law.update(jump, internal, penalties).tangent[0, 0] > 0),
        "closed points of zero gap have no stiffness: bodies in contact as meshed would be loose",
    )
