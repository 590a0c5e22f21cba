"""Isotropic linear elasticity, alone and as the elastic part of the plastic laws."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from typing_extensions import override

from ..checks import finite
from .base import (
    Array,
    Flow,
    Given,
    Material,
    Parameter,
    Update,
    along_elements,
    as_parameter,
    as_parameters,
    check_shapes,
    require,
)

#: Parameters of which an element has one value, the mean over its points.
_BY_ELEMENT = ("E", "nu")


@dataclass(frozen=True, eq=False)
class Isotropic(Material):
    """Parameters of isotropic elasticity.

    Each is a float, an array with one value an element of the region, or a function of the
    coordinates. A ValueError refuses a parameter that is out of its range or not finite, and arrays
    that differ in length. Two materials are equal only if they are the same object.
    """

    E: Given
    nu: Given

    def __post_init__(self) -> None:
        as_parameters(self)
        if not self.functions:
            self._check()

    def _check(self) -> None:
        """Check the ranges of the parameters, which are numbers."""
        self._positive("E")
        in_range = np.greater(self.nu, -1) & np.less(self.nu, 0.5)
        require("nu", self.nu, in_range, "lie between -1 and 0.5")

    @property
    @override
    def functions(self) -> tuple[str, ...]:
        return tuple(field.name for field in fields(self) if callable(getattr(self, field.name)))

    @override
    def at(self, x: Array) -> Any:
        if not self.functions:
            return self
        changes: dict[str, Parameter] = {}
        for field in fields(self):
            name = field.name
            value = getattr(self, field.name)
            if callable(value):
                values = at_points(name, value, x)
                changes[name] = values.mean(axis=1) if name in _BY_ELEMENT else values
            elif np.ndim(value) == 1 and name not in _BY_ELEMENT:
                changes[name] = value[:, None]
        new = self._with(**changes)
        new._check()
        return new

    def _angle(self, name: str) -> None:
        """Refuse an angle in degrees that is negative, or 90 and more."""
        value = getattr(self, name)
        in_range = np.greater_equal(value, 0) & np.less(value, 90)
        require(name, value, in_range, "lie in [0, 90) degrees")

    def _with(self, **changes: Parameter | None) -> Any:
        """Return the material with other parameters, which follow from checked ones."""
        new = copy(self)
        for name, value in changes.items():
            object.__setattr__(new, name, None if value is None else as_parameter(name, value, 2))
        return new

    @property
    def lame(self) -> tuple[Parameter, Parameter]:
        """Lamé's constants (lambda, mu)."""
        confined = (1 + self.nu) * (1 - 2 * self.nu)
        lam = self.E * self.nu / confined
        mu = self.E / (2 * (1 + self.nu))
        return lam, mu

    @override
    def elasticity(
        self,
        ncomp: int,
        stress: Array | None = None,
        internal: Array | None = None,
    ) -> Array:
        lam, mu = np.broadcast_arrays(*self.lame)
        stiffness = np.zeros((*lam.shape, ncomp, ncomp))
        lam = lam[..., None, None]
        mu = mu[..., None, None]
        stiffness[..., :3, :3] = lam + 2 * mu * np.eye(3)
        stiffness[..., 3:, 3:] = mu * np.eye(ncomp - 3)
        return stiffness

    def elastic_stress(self, strain_increment: Array, stress: Array) -> Array:
        """Return the stress after an elastic strain increment, a new array (ncomp, ...)."""
        check_shapes(strain_increment, stress)
        lam, mu = (along_elements(value, stress.shape) for value in self.lame)
        volume = strain_increment[0] + strain_increment[1]
        volume += strain_increment[2]

        # stress + 2 mu strain + lam volume, in place
        result = np.empty(stress.shape)
        np.multiply(strain_increment[:3], 2 * mu, out=result[:3])
        np.multiply(strain_increment[3:], mu, out=result[3:])
        volume *= lam
        result[:3] += volume
        result += stress
        return result


@dataclass(frozen=True, eq=False)
class LinearElastic(Isotropic):
    """Isotropic linear elasticity.

    Parameters
    ----------
    E, nu : float, ndarray or callable
        Young's modulus (stress), positive, and Poisson's ratio, -1 < nu < 0.5: floats, one value an
        element each, or functions of the coordinates (dim, ...), of which an element takes the
        mean.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.materials import LinearElastic
    >>> steel = LinearElastic(E=210e6, nu=0.3)
    >>> strain = np.array([[1e-3], [0.0], [0.0], [0.0]])
    >>> steel.update(strain, np.zeros((4, 1)), np.zeros((0, 1))).stress.ravel().round()
    array([282692., 121154., 121154.,      0.])
    """

    @property
    @override
    def symmetric(self) -> bool:
        return True

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        result = self.elastic_stress(strain_increment, stress)
        plastic = np.empty(0, dtype=np.intp)
        tangent = np.empty((0, len(stress), len(stress)))
        return Update(result, internal, plastic, lambda: tangent)

    @override
    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        points = stress.shape[1:]
        return np.zeros(points), np.full(points, np.inf)

    @override
    def cone(self, flow: Flow = "associated") -> tuple[Parameter, Parameter, Parameter]:
        return np.inf, 0.0, np.inf


def at_points(name: str, function: Any, x: Array) -> Array:
    """Return a parameter that is a function of the coordinates, (n_elements, n_points)."""
    values = finite(function(x), f"{name}(x)")
    if values.shape not in ((), x.shape[1:]):
        raise ValueError(
            f"{name}(x) must return one number for each point, shape {x.shape[1:]}, not "
            f"{values.shape}"
        )
    return np.broadcast_to(values, x.shape[1:]).copy()


def refuse_functions(material: Material) -> None:
    """Refuse a material with functions of the coordinates at a point without coordinates."""
    if material.functions:
        raise ValueError(
            f"{' and '.join(material.functions)} of {material.label} vary with the coordinates, "
            "which a single point does not have: give numbers"
        )


def davis_factor(friction: Parameter, dilatancy: Parameter) -> Parameter:
    """Return Davis' beta = cos(psi) cos(phi) / (1 - sin(psi) sin(phi)) of angles in radians."""
    return np.cos(dilatancy) * np.cos(friction) / (1 - np.sin(dilatancy) * np.sin(friction))


def angle_over(angle: Parameter, factor: float) -> Parameter:
    """Return the angle in degrees whose tangent is divided by a factor."""
    return np.degrees(np.arctan(np.tan(np.radians(angle)) / factor))


def reduced_dilatancy(
    dilatancy: Parameter, friction: Parameter, reduced_friction: Parameter
) -> Parameter:
    """Return the dilatancy of a reduced friction: equal to it in associated flow, else at most."""
    associated = np.equal(dilatancy, friction)
    return np.where(associated, reduced_friction, np.minimum(dilatancy, reduced_friction))
