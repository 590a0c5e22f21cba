"""Undrained behaviour of an effective-stress material with nearly incompressible pore water."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from ..errors import warn
from .base import (
    EXCESS_PRESSURE,
    Array,
    Flow,
    Internal,
    Material,
    Parameter,
    Update,
    along_elements,
    as_material,
    as_parameter,
    bulk_modulus_of,
    check_reduction,
    require,
    updated,
)


@dataclass(frozen=True, eq=False)
class Undrained(Material):
    r"""Soil whose pores are full of water that cannot leave.

    The soil takes the strain with its own, effective parameters; the water resists its volume part.
    With the bulk modulus :math:`K_w` of the water over the porosity the excess pore pressure,
    positive in compression, grows by
    :math:`-K_w\,\Delta\varepsilon_v`, and the stress of this material is the effective stress less
    that pressure. It is the last internal variable, see
    :meth:`~skfem_contact.results.StageResult.pore_pressure`.

    Parameters
    ----------
    soil : Material
        The law in effective stresses: any material.
    bulk_modulus_water : float or ndarray, optional
        Bulk modulus :math:`K_w` of the water over the porosity (stress), not negative; a float or
        one value an element.
    nu_undrained : float or ndarray, optional
        Poisson's ratio :math:`\nu_u` of the soil and its water, for instance 0.495, instead of
        `bulk_modulus_water`:
        :math:`K_w = 2 G (1 + \nu_u) / (3 (1 - 2 \nu_u)) - K`. With stress-dependent elasticity
        :math:`K_w` follows the accepted stress.

    Examples
    --------
    Isotropic compression by 1: nearly all of it is taken by the water.

    >>> import numpy as np
    >>> from skfem_contact.materials import LinearElastic, Undrained
    >>> clay = Undrained(LinearElastic(E=3., nu=0.), bulk_modulus_water=99.)
    >>> strain = np.array([[-.01], [0.], [0.], [0.]])
    >>> new = clay.update(strain, np.zeros((4, 1)), np.zeros((1, 1)))
    >>> new.stress[:3].mean().round(12), new.internal[-1].round(12)
    (np.float64(-1.0), array([0.99]))
    """

    soil: Material
    bulk_modulus_water: Parameter | None = None
    nu_undrained: Parameter | None = None
    undrained = True

    def __post_init__(self) -> None:
        soil = self._effective_soil()

        # add the excess pressure to the variables of the soil
        unnamed = (Internal(f"variable {k}") for k in range(len(soil.internal), soil.n_internal))
        derived = {
            "soil": soil,
            "internal": (*soil.internal, *unnamed, Internal(EXCESS_PRESSURE, unit="stress")),
            "time_dependent": soil.time_dependent,
            "stress_dependent": soil.stress_dependent,
        }

        # convert and check the parameters of the water
        for name in ("bulk_modulus_water", "nu_undrained"):
            value = getattr(self, name)
            if value is not None:
                derived[name] = as_parameter(name, value)
        for name, value in derived.items():
            object.__setattr__(self, name, value)
        if not soil.functions:
            self._check()

    def _effective_soil(self) -> Material:
        """Return the soil as a material, which must not be undrained itself."""
        if (self.bulk_modulus_water is None) == (self.nu_undrained is None):
            raise ValueError("an undrained soil needs either bulk_modulus_water or nu_undrained")
        try:
            soil = as_material(self.soil)
        except ValueError as error:
            raise ValueError(
                f"the soil must be a material in effective stresses: {error}"
            ) from error
        if soil.undrained:
            raise ValueError(
                f"the soil must be a material in effective stresses, not {self.soil!r}"
            )
        return soil

    def _check(self) -> None:
        """Check the ranges of the parameters, and warn of a soil that dilates."""
        name = "bulk_modulus_water"
        if self.nu_undrained is not None:
            name = "bulk_modulus_water (from nu_undrained)"
            below = np.less(self.nu_undrained, 0.5)
            require("nu_undrained", self.nu_undrained, below, "be less than 0.5")
        water = self.bulk_modulus
        require(name, water, np.greater_equal(water, 0), "not be negative")
        if self.soil.dilates:
            warn(
                "a soil that dilates, psi > 0, gets stronger without end where its water cannot "
                "leave; undrained soils take psi=0"
            )

    @property
    def bulk_modulus(self) -> Parameter:
        """Bulk modulus of the water over the porosity, typical with stress-dependent elasticity."""
        if self.bulk_modulus_water is not None:
            return self.bulk_modulus_water
        return as_parameter("bulk_modulus_water", self._bulk_modulus(self.soil.elasticity(4)))

    def _bulk_modulus(self, D: Array) -> Any:
        """Return the bulk modulus of the water by `nu_undrained` and an elastic stiffness."""
        shear = D[..., 3, 3]
        bulk = bulk_modulus_of(D)
        nu_u = np.asarray(self.nu_undrained, dtype=float)
        if nu_u.ndim:
            # One value an element: let it follow the points of the stiffness.
            ones = (1,) * (shear.ndim - nu_u.ndim)
            nu_u = nu_u.reshape(nu_u.shape + ones)
        undrained_bulk = 2 * shear * (1 + nu_u) / (3 * (1 - 2 * nu_u))
        return undrained_bulk - bulk

    def _water(self, effective: Array, internal: Array) -> Parameter:
        """Return the bulk modulus of the water at the points of an accepted state of the soil."""
        if self.stress_dependent and self.bulk_modulus_water is None:
            return self._bulk_modulus(self.soil.elasticity(len(effective), effective, internal))
        return along_elements(self.bulk_modulus, effective.shape)

    @property
    @override
    def functions(self) -> tuple[str, ...]:
        return self.soil.functions

    @override
    def at(self, x: Array) -> Undrained:
        if self.functions:
            return replace(self, soil=self.soil.at(x))
        return self

    @property
    @override
    def symmetric(self) -> bool:
        return self.soil.symmetric

    @property
    @override
    def reducible(self) -> bool:
        return self.soil.reducible

    @property
    @override
    def slips_on_planes(self) -> bool:
        return self.soil.slips_on_planes

    @property
    @override
    def axisymmetric(self) -> bool:
        return self.soil.axisymmetric

    @property
    @override
    def tensile_strength(self) -> Parameter | None:
        return self.soil.tensile_strength

    @override
    def elasticity(
        self,
        ncomp: int,
        stress: Array | None = None,
        internal: Array | None = None,
    ) -> Array:
        if stress is None or internal is None or not self.stress_dependent:
            water = np.asarray(self.bulk_modulus)
            stiffness = self.soil.elasticity(ncomp) + np.zeros((*water.shape, 1, 1))
        else:
            effective, own = self._effective(stress, internal)
            water = np.broadcast_to(self._water(effective, own), stress.shape[1:])
            stiffness = self.soil.elasticity(ncomp, effective, own).copy()
        stiffness[..., :3, :3] += water[..., None, None]
        return stiffness

    @override
    def initial_internal(self, stress: Array) -> Array:
        pressure = np.zeros((1, *stress.shape[1:]))
        return np.concatenate((self.soil.initial_internal(stress), pressure))

    @override
    def update(
        self,
        strain_increment: Array,
        stress: Array,
        internal: Array,
        dt: float = 0.0,
    ) -> Update:
        effective, own = self._effective(stress, internal)
        # Compute the stiffness of the water only where it is needed: the soil may begin without.
        water = cache(lambda: self._water(effective, own))

        # Let the pressure grow with the compression.
        growth = strain_increment[:3].sum(axis=0)
        pressure = internal[-1].copy()
        if growth.any():
            pressure -= water() * growth

        # Add the pressure to the effective stress of the soil.
        new = updated(self.soil, strain_increment, effective, own, dt)
        total = new.stress.copy()
        total[:3] -= pressure
        variables = np.concatenate((new.internal, pressure[None]))

        def tangent() -> Array:
            result = new.tangent().copy()
            bulk = np.broadcast_to(water(), pressure.shape).reshape(-1)
            result[:, :3, :3] += bulk[new.plastic, None, None]
            return result

        return Update(total, variables, new.plastic, tangent)

    @override
    def yielding(self, before: Array, after: Array) -> NDArray[np.bool_]:
        return self.soil.yielding(before[:-1], after[:-1])

    @override
    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array] | None:
        return self.soil.mobilised(*self._effective(stress, internal))

    @override
    def undrained_strength(self, mean: Array, internal: Array) -> Array | None:
        return self.soil.undrained_strength(mean, internal[:-1])

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> Undrained:
        check_reduction(factor, flow)
        return replace(self, soil=self.soil.reduced(factor))

    @override
    def drained(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        effective, _ = self._effective(stress, internal)
        variables = internal.copy()
        variables[self.n_internal - 1] = 0.0
        return effective, variables

    def _effective(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        """Return effective stress and internal variables of the soil."""
        last = self.n_internal - 1
        effective = stress.copy()
        effective[:3] += internal[last]
        return effective, internal[:last]
