"""What every material offers, and the handling of its parameters."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import AnalysisWarning

Array = NDArray[np.float64]
Parameter = float | Array


class Update(NamedTuple):
    """Answer of a material to a strain increment.

    Attributes
    ----------
    stress : ndarray, shape (ncomp, ...)
        New stress, tension positive; 4 components (xx, yy, zz, xy) or 6 (xx, yy, zz, xy, yz, zx).
    internal : ndarray, shape (n_internal, ...)
        New internal variables.
    plastic : ndarray of int, shape (n_plastic,)
        Flat (C-order) indices of the points whose tangent differs from elasticity.
    tangent : callable
        ``tangent()`` returns the consistent tangent d stress / d strain (engineering shear strains) at these
        points, shape (n_plastic, ncomp, ncomp). It is computed only when it is called.
    """

    stress: Array
    internal: Array
    plastic: NDArray[np.intp]
    tangent: Callable[[], Array]


class Material(Protocol):
    """Constitutive law: a pure function of strain increment and accepted state; it holds parameters only."""

    @property
    def n_internal(self) -> int:
        """Number of internal variables a point."""

    def elasticity(self, ncomp: int) -> Array:
        """Elastic stiffness, (ncomp, ncomp), or (n_elements, ncomp, ncomp) where a parameter is an array."""

    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        """Stress, internal variables and tangent after a strain increment.

        Parameters
        ----------
        strain_increment : ndarray, shape (ncomp, n_elements, ...)
            With engineering shear strains; 4 components (xx, yy, zz, xy) or 6 (xx, yy, zz, xy, yz, zx).
        stress : ndarray, same shape
            Accepted stress, tension positive.
        internal : ndarray, shape (n_internal, n_elements, ...)
            Accepted internal variables.

        Raises
        ------
        ValueError
            If the shapes do not fit each other or the parameters.
        """


def as_parameter(name: str, value: ArrayLike) -> Parameter:
    """A finite float, or a read-only array with one finite value an element.

    Examples
    --------
    >>> as_parameter("E", 10)
    10.0
    >>> as_parameter("E", [10, 20])
    array([10., 20.])
    """
    try:
        array = np.array(value)
    except ValueError:
        array = np.array(None)  # a list of lists of different lengths
    if np.ma.isMaskedArray(value) or array.dtype.kind not in "iuf":
        raise ValueError(f"{name} must be a number or one number an element, got {value!r}")
    array = array.astype(np.float64)
    if array.ndim > 1 or array.size == 0:
        raise ValueError(f"{name} must be a number or one number an element, got shape {array.shape}")
    require(name, array, np.isfinite(array), "be finite")
    if array.ndim == 0:
        return float(array)
    array.flags.writeable = False
    return array


def require(name: str, value: Parameter, holds: Any, demand: str) -> None:
    """Raise a ValueError that names the first element where a demand on a parameter does not hold.

    Examples
    --------
    >>> require("E", -1.0, False, "be positive")
    Traceback (most recent call last):
    ...
    ValueError: E must be positive, got -1.0
    """
    if np.all(holds):
        return
    first = int(np.argmin(np.atleast_1d(holds)))
    values = np.atleast_1d(value)
    where = f" in element {first}" if np.size(holds) > 1 else ""
    raise ValueError(f"{name} must {demand}, got {values[first if values.size > 1 else 0]}{where}")


def warn_of_radians(**angles: Parameter) -> None:
    """Warn of angles that may have been meant in radians: all of them less than a right angle is there."""
    for name, angle in angles.items():
        largest = float(np.max(angle))
        if 0.0 < largest < np.pi / 2:
            warnings.warn(f"{name} is {largest:.4g}: angles are given in degrees", AnalysisWarning, stacklevel=4)


def require_same_length(**parameters: Parameter | None) -> None:
    """Raise a ValueError if arrays among the parameters do not have one common length."""
    lengths = {name: value.size for name, value in parameters.items() if isinstance(value, np.ndarray)}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} has {length}" for name, length in lengths.items())
        raise ValueError(f"parameter arrays must have one value an element: {listed}")


def along_elements(value: Parameter, shape: tuple[int, ...]) -> Parameter:
    """Parameter at the points of a field of the given shape (ncomp, n_elements, ...); a float stays one.

    Examples
    --------
    >>> along_elements(np.array([1.0, 2.0]), (4, 2, 9)).shape
    (2, 9)
    """
    if not isinstance(value, np.ndarray):
        return value
    if np.size(value) != shape[1]:
        raise ValueError(f"a parameter array has {np.size(value)} values for {shape[1]} elements")
    return np.repeat(value, int(np.prod(shape[2:]))).reshape(shape[1:])


def reduced_dilatancy(dilatancy: Parameter, friction: Parameter, reduced_friction: Parameter) -> Parameter:
    """Dilatancy that belongs to a reduced friction.

    It equals the reduced friction where it equalled the friction (associated flow); elsewhere it is capped
    by it.

    Examples
    --------
    >>> reduced_dilatancy(np.array([30.0, 5.0]), np.array([30.0, 30.0]), np.array([20.0, 20.0]))
    array([20.,  5.])
    """
    associated = np.equal(dilatancy, friction)
    return np.where(associated, reduced_friction, np.minimum(dilatancy, reduced_friction))
