"""Isotropic linear elasticity, alone and as the elastic part of the plastic laws."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from .base import Array, Parameter, Update, along_elements, as_parameter, require, require_same_length


@dataclass(frozen=True, eq=False)
class Isotropic:
    """Parameters of isotropic elasticity and what follows from them; the laws derive from it.

    Parameters are floats, or arrays with one value an element of the region. Two materials are equal only if
    they are the same object, because parameters may be arrays.
    """

    E: Parameter
    nu: Parameter

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None or field.default is not None:
                object.__setattr__(self, field.name, as_parameter(field.name, value))
        require_same_length(**{field.name: getattr(self, field.name) for field in fields(self)})
        require("E", self.E, np.greater(self.E, 0), "be positive")
        require("nu", self.nu, np.greater(self.nu, -1) & np.less(self.nu, 0.5), "lie between -1 and 0.5")

    def _not_negative(self, *names: str) -> None:
        """Refuse negative values of some parameters."""
        for name in names:
            if (value := getattr(self, name)) is not None:
                require(name, value, np.greater_equal(value, 0), "not be negative")

    def _with(self, **changes: Parameter | None) -> Any:
        """The material with other parameters, which need not be checked: they follow from those that were."""
        new = copy(self)
        for name, value in changes.items():
            object.__setattr__(new, name, None if value is None else as_parameter(name, value))
        return new

    @property
    def lame(self) -> tuple[Parameter, Parameter]:
        """Lamé's constants (lambda, mu)."""
        return self.E * self.nu / ((1 + self.nu) * (1 - 2 * self.nu)), self.E / (2 * (1 + self.nu))

    def elasticity(self, ncomp: int) -> Array:
        """Elastic stiffness d stress / d strain.

        Parameters
        ----------
        ncomp : int
            4 (xx, yy, zz, xy) or 6 (xx, yy, zz, xy, yz, zx) components.

        Returns
        -------
        ndarray
            Shape (ncomp, ncomp), or (n_elements, ncomp, ncomp) where E or nu is an array.

        Examples
        --------
        >>> LinearElastic(E=2.5, nu=0.25).elasticity(4)
        array([[3., 1., 1., 0.],
               [1., 3., 1., 0.],
               [1., 1., 3., 0.],
               [0., 0., 0., 1.]])
        """
        lam, mu = np.broadcast_arrays(*self.lame)
        stiffness = np.zeros((*lam.shape, ncomp, ncomp))
        stiffness[..., :3, :3] = lam[..., None, None] + 2 * mu[..., None, None] * np.eye(3)
        stiffness[..., 3:, 3:] = mu[..., None, None] * np.eye(ncomp - 3)
        return stiffness

    def elastic_stress(self, strain_increment: Array, stress: Array) -> Array:
        """Stress if the strain increment is elastic: a new array, shape (ncomp, ...)."""
        if strain_increment.shape != stress.shape or stress.ndim < 2 or stress.shape[0] not in (4, 6):
            raise ValueError(
                "strain increment and stress must share a shape (4 or 6, n_elements, ...), "
                f"got {strain_increment.shape} and {stress.shape}"
            )
        lam, mu = (along_elements(value, stress.shape) for value in self.lame)
        result = np.empty(stress.shape)
        pressure = strain_increment[0] + strain_increment[1]
        pressure += strain_increment[2]
        pressure *= lam
        np.multiply(strain_increment[:3], 2 * mu, out=result[:3])
        np.multiply(strain_increment[3:], mu, out=result[3:])
        result[:3] += pressure
        result += stress
        return result


@dataclass(frozen=True, eq=False)
class LinearElastic(Isotropic):
    """Isotropic linear elasticity.

    Parameters
    ----------
    E : float or ndarray
        Young's modulus (stress), positive; a float or one value an element.
    nu : float or ndarray
        Poisson's ratio, -1 < nu < 0.5; a float or one value an element.

    Raises
    ------
    ValueError
        If a parameter is out of its range, not finite, or arrays differ in length.

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
    def n_internal(self) -> int:
        """No internal variables."""
        return 0

    @property
    def symmetric(self) -> bool:
        """The tangent is symmetric."""
        return True

    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        """Stress after a strain increment, see :meth:`Material.update`; no point is ever plastic."""
        new, tangent = self.elastic_stress(strain_increment, stress), np.empty((0, len(stress), len(stress)))
        return Update(new, internal, np.empty(0, dtype=np.intp), lambda: tangent)
