"""Checks of own materials and interface laws on random states, and tools of all checks."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..contact.laws import InterfaceLaw, Status
from ..contact.laws import LawUpdate as Traction
from ..materials.base import Material, Update, as_material, updated
from ..materials.elastic import refuse_functions

#: Steps of the differences, relative to the size of the varied values.
STEP = 1e-6
#: Largest round-off, relative to the size of the values.
EXACT = 1e-9
#: Second differences above this share of the first ones show a kink, which has no tangent.
_KINK = 1e-3


class CheckFailed(AssertionError):
    """Violation of a property that an analysis relies on."""


def differences(function: Callable[[float], ndarray], h: float) -> tuple[ndarray, ndarray]:
    """Return the central difference, and the gap between the one-sided ones."""
    forward = function(h)
    backward = function(-h)
    middle = function(0.0)
    return (forward - backward) / (2 * h), np.abs(forward - 2 * middle + backward) / h


def largest_error(
    error: ndarray,
    kink: ndarray,
    tolerance: float,
    message: str,
    kinks: float = 0.1,
) -> float:
    """Return the largest error at smooth points; a share `kinks` of the points may be others."""
    smooth = kink <= _KINK
    enough = smooth.mean() >= 1.0 - kinks
    require(enough, f"{np.sum(~smooth)} of {smooth.size} derivatives jump and cannot be checked")
    largest = float(error[smooth].max(initial=0.0))
    require_all(~smooth | (error <= tolerance), f"{message}, by {largest:.1e}")
    return largest


def same_twice(function: Callable[[], Any], arguments: tuple[ndarray, ...], name: str) -> Any:
    """Return the value of a function, which must be the same twice; arguments must not change."""
    before = [array.copy() for array in arguments]
    first = function()
    second = function()
    unchanged = all(map(_equal, arguments, before))
    require(unchanged, f"{name} changes its arguments")
    single = not isinstance(first, tuple)
    firsts = (first,) if single else first
    seconds = (second,) if single else second
    for a, b in zip(firsts, seconds, strict=True):
        require(callable(a) or _equal(a, b), f"{name} returns other values the second time")
    return first


def _equal(a: Any, b: Any) -> bool:
    """Return True for equal arrays; floats that are not numbers are equal."""
    return np.array_equal(a, b, equal_nan=np.asarray(a).dtype.kind == "f")


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
    are elastic.  The tangent agrees with central differences where the step has no kink. Plastic
    flow dissipates.

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
        True if plastic strain must do work on the stress in every step. The plastic strain is
        computed with the accepted stiffness: pass False for a hyperelastic law, whose stiffness
        changes in the step.
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
    # Check the elasticity, and start from the initial stress.
    rng = np.random.default_rng(seed)
    material = as_material(material)
    refuse_functions(material)
    _check_elasticity(np.asarray(material.elasticity(ncomp)), ncomp, shape[0])
    stress = np.zeros((ncomp, *shape))
    stress[:3] = initial_stress
    internal = material.initial_internal(stress)
    worst = 0.0
    for _ in range(steps):
        # Update twice by a random increment.
        increment = strain * rng.standard_normal((ncomp, *shape)) * rng.uniform(0, 1, shape)
        update = partial(updated, material, stress=stress, internal=internal, dt=0.0)
        new = same_twice(
            partial(update, increment), (increment, stress, internal), "material.update"
        )
        _check_update(new, internal.shape, stress.shape)

        # Repeat the update without strain.
        again = updated(material, np.zeros_like(increment), new.stress, new.internal, 0.0)
        drift = np.abs(again.stress - new.stress).max(axis=0)
        largest = max_abs(new.stress)
        message = "the stress is not admissible: a zero increment changes it"
        require_all(drift <= 1e-7 * largest, message)

        # Compare the plastic strain with the points that have flowed, and compute its work.
        D = _moduli(material, stress, internal)
        change = np.moveaxis(new.stress - stress, 0, -1)
        elastic = np.linalg.solve(D, change[..., None])[..., 0]
        flow = increment - np.moveaxis(elastic, -1, 0)
        plastic = np.zeros(shape, bool)
        plastic.ravel()[new.plastic] = True
        rigid = np.abs(flow).max(axis=0) <= EXACT * strain
        require_all(plastic | rigid, "points that are not named in `plastic` are not elastic")
        if dissipation:
            work = (new.stress * flow).sum(axis=0)
            least = -EXACT * largest * strain
            require_all(work >= least, "plastic flow dissipates a negative work")

        # Compare the tangent with differences.
        tangent = D.reshape(-1, ncomp, ncomp).copy()
        if len(new.plastic):
            tangent[new.plastic] = new.tangent()
        error = _material_tangent(update, increment, tangent, max_abs(D), strain, tolerance)
        worst = max(worst, error)
        stress = new.stress
        internal = new.internal
    return worst


def _check_elasticity(D: ndarray, ncomp: int, n_elements: int) -> None:
    """Check shape, symmetry and sign of an elastic stiffness."""
    shapes = (ncomp, ncomp), (n_elements, ncomp, ncomp)
    require(D.shape in shapes, f"elasticity has the shape {D.shape}")
    skew = max_abs(D - np.swapaxes(D, -1, -2))
    require(skew <= EXACT * max_abs(D), "the elasticity is not symmetric")
    require(np.linalg.eigvalsh(D).min() > 0, "the elasticity is not positive definite")


def _moduli(material: Material, stress: ndarray, internal: ndarray) -> ndarray:
    """Return the elastic stiffness at the points, (n_elements, n_points, ncomp, ncomp)."""
    ncomp = len(stress)
    if material.stress_dependent:
        return material.elasticity(ncomp, stress, internal)
    D = np.asarray(material.elasticity(ncomp))
    if D.ndim == 3:
        D = D[:, None]
    return np.broadcast_to(D, (*stress.shape[1:], ncomp, ncomp))


def _check_update(new: Update, internal: tuple[int, ...], stress: tuple[int, ...]) -> None:
    """Check the shapes and indices of an update."""
    _check_shape("the stress has", new.stress, stress)
    finite = np.isfinite(new.stress).all() and np.isfinite(new.internal).all()
    require(finite, "the values are not finite")
    _check_shape("the internal variables have", new.internal, internal)
    n = len(new.plastic)
    points = np.arange(np.prod(stress[1:]))
    different = len(np.unique(new.plastic)) == n and np.isin(new.plastic, points).all()
    require(different, "`plastic` must hold different indices of points")
    tangent = new.tangent()
    if n:
        _check_shape("the tangent has", tangent, (n, stress[0], stress[0]))


def _check_shape(name: str, array: Any, shape: tuple[int, ...]) -> None:
    """Check the shape of an array, whose name comes with its verb."""
    actual = np.shape(array)
    require(actual == shape, f"{name} the shape {actual}, not {shape}")


def _material_tangent(
    update: Callable[[ndarray], Update],
    increment: ndarray,
    tangent: ndarray,
    modulus: float,
    strain: float,
    tolerance: float,
) -> float:
    """Return the largest error of the tangent at smooth points."""
    # Compare each column with differences of the stress.
    ncomp = len(increment)

    def stress_at(step: float, j: int) -> ndarray:
        moved = increment.copy()
        moved[j] += step
        return update(moved).stress

    error = np.zeros(len(tangent))
    kink = np.zeros(len(tangent))
    for j in range(ncomp):
        slope, gap = differences(partial(stress_at, j=j), STEP * strain)
        difference = np.abs(slope.reshape(ncomp, -1) - tangent[:, :, j].T)
        error = np.maximum(error, difference.max(axis=0))
        kink = np.maximum(kink, gap.reshape(ncomp, -1).max(axis=0))
    # Judge differences at kinks by the size of the kink.
    message = "the tangent differs from the differences of the stress"
    return largest_error(error / modulus, kink / modulus, tolerance, message)


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
    does not fall with penetration.  All of this holds with initial internal variables and with the
    variables that the law returns.

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
    rng = np.random.default_rng(seed)
    worst = 0.0
    for dim in dimensions:
        internal = np.zeros((law.n_internal, n))
        for _ in range(3):  # initial internal variables, and twice the returned ones
            # Draw gaps and slips, some of them without slip.
            gap = rng.uniform(-1, 1, (1, n))
            slip = rng.standard_normal((dim - 1, n))
            slip[:, : n // 10] = 0.0
            jump = size * np.concatenate((gap, slip))
            reached = _check_reach(law, jump[0], internal, rng.random(n) < 0.5)

            # Check traction and tangent of the points within reach.
            some = jump[:, reached], internal[:, reached]
            new = _check_traction(law, *some, penalties, size)
            worst = max(worst, _law_tangent(law, *some, penalties, size, tolerance))
            internal[:, reached] = new.internal
        _check_touching(law, penalties, dim)
    return worst


def _check_reach(law: InterfaceLaw, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
    """Return the points within reach; points without internal variables must not stay open."""
    arguments = gap, internal, closed
    # Check the type of the return value.
    reached = np.asarray(same_twice(partial(law.reaches, *arguments), arguments, "law.reaches"))
    booleans = reached.shape == gap.shape and reached.dtype == bool
    require(booleans, "`reaches` must return (n,) booleans")

    # Refuse points that were open and still are.
    untouched = (internal == 0.0).all(axis=0)
    open_still = reached & ~closed & (gap > 0.0) & untouched
    require_all(~open_still, "`reaches` names points that were open and still are")
    return reached


def _check_traction(
    law: InterfaceLaw,
    jump: ndarray,
    internal: ndarray,
    penalties: tuple[float, float],
    size: float,
) -> Traction:
    """Check shapes, signs and admissibility of the traction, and return the update."""

    def traction(slip: ndarray, before: ndarray) -> ndarray:
        return law.update(np.concatenate((jump[:1], slip)), before, penalties).traction

    # Check shapes and values.
    update = partial(law.update, jump, internal, penalties)
    new = same_twice(update, (jump, internal), "law.update")
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
        _check_shape(f"{name} has", value, shape)
        require(np.isfinite(value).all(), f"{name} is not finite")
    known = np.isin(new.status, [int(status) for status in Status])
    require_all(known, "`status` has values that are no Status")

    # Check that the elastic slip gives the same traction, and the opposite slip the opposite one.
    force = max(max_abs(new.traction), 1e-300)
    again = traction(new.elastic_slip, new.internal)
    drift = np.abs(again - new.traction).max(axis=0)
    message = "the traction is not admissible: the elastic slip gives another one"
    require_all(drift <= EXACT * force, message)
    opposite = traction(-jump[1:], internal)
    skew = np.abs(opposite[1:] + new.traction[1:]).max(axis=0)
    require_all(skew <= EXACT * force, "the opposite slip gives no opposite traction")

    # Check the signs of work and stiffness.
    plastic_slip = jump[1:] - new.elastic_slip
    work = (new.traction[1:] * plastic_slip).sum(axis=0)
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
    # Compare each column with differences of the traction.
    units = np.eye(len(jump))[:, :, None]

    def traction(step: float, j: int) -> ndarray:
        return law.update(jump + step * units[j], internal, penalties).traction

    tangent = law.update(jump, internal, penalties).tangent
    scale = max(penalties)
    worst = 0.0
    for j in range(len(jump)):
        slope, kink = differences(partial(traction, j=j), STEP * size)
        for i in range(len(jump)):
            error = np.abs(slope[i] - tangent[i, j]) / scale
            message = f"tangent[{i}, {j}] differs from the differences"
            largest = largest_error(error, kink[i] / scale, tolerance, message, kinks=0.5)
            worst = max(worst, largest)
    return worst


def _check_touching(law: InterfaceLaw, penalties: tuple[float, float], dim: int) -> None:
    """Check that points of zero gap are closed: bodies in contact as meshed need them."""
    jump = np.zeros((dim, 1))
    internal = np.zeros((law.n_internal, 1))
    reached = law.reaches(jump[0], internal, np.ones(1, bool))
    require(
        np.all(reached),
        "closed points of zero gap are out of reach: bodies in contact as meshed would be loose",
    )
    stiffness = law.update(jump, internal, penalties).tangent[0, 0]
    require(
        np.all(stiffness > 0),
        "closed points of zero gap have no stiffness: bodies in contact as meshed would be loose",
    )
