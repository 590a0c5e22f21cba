"""Drucker-Prager plasticity, and its limit, the cylinder of von Mises.

The yield function is sqrt(J2) + alpha I1 - k with the first invariant I1 of the stress (tension
positive) and the second invariant J2 of its deviator; the plastic potential is the same with beta
for alpha. The return is radial in the deviator, to the cone or to its apex I1 = k / alpha.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from typing_extensions import override

from .base import Array, Flow, Given, Parameter, along_elements, check_reduction, require
from .elastic import at_points, reduced_dilatancy
from .mohr_coulomb import MohrCoulomb
from .plastic import IsotropicPlasticity, Return, chosen
from .spectral import mean_and_shear


class ConeConstants(NamedTuple):
    """Constants of the cone: floats, or arrays over elements or points."""

    lam: Parameter
    mu: Parameter
    alpha: Parameter
    beta: Parameter
    k: Parameter


@dataclass(frozen=True, eq=False)
class ConePlasticity(IsotropicPlasticity):
    """Base of the laws with a circular cone or cylinder, which add parameters and constants."""

    @property
    @override
    def symmetric(self) -> bool:
        constants = self.constants()
        return bool(np.all(constants.alpha == constants.beta))

    @override
    def yield_function(self, values: Array, constants: ConeConstants) -> Array:
        return _excess(*mean_and_shear(values), constants)

    @override
    def yield_bound(self, stress: Array, constants: ConeConstants) -> Array:
        return self.yield_function(stress, constants)

    @override
    def return_map(self, trial: Array, constants: ConeConstants) -> Return:
        return _cone_return(trial, constants)

    @override
    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        constants = self.constants()
        alpha = along_elements(constants.alpha, stress.shape)
        k = along_elements(constants.k, stress.shape)
        _, shear = mean_and_shear(stress)
        return shear, k - alpha * stress[:3].sum(axis=0)


@dataclass(frozen=True, eq=False)
class DruckerPrager(ConePlasticity):
    """Linear elasticity, perfect plasticity on the Drucker-Prager cone, non-associated flow.

    The yield function is ``sqrt(J2) + alpha I1 - k`` (tension positive), and the plastic potential
    is the same with beta (D. C. Drucker, W. Prager, Quart. Appl. Math. 10 (1952) 157-165). Where c
    and phi are known, use :meth:`plane_strain`: k, alpha and beta are not cohesion and angles. A
    reduction of strength divides k and alpha; its factor is lower than with c and tan(phi), 1.78
    instead of 1.95 for a slope with phi = 25 degrees.

    Parameters
    ----------
    E, nu : float or ndarray
        As in :class:`LinearElastic`.
    k, alpha, beta : float or ndarray
        Shear strength sqrt(J2) without mean stress; friction, below 1/3 for soil in plane strain;
        and dilatancy, at most alpha. None may be negative.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> soil = sc.DruckerPrager.plane_strain(E=1e4, nu=0.3, c=10.0, phi=30.0, psi=30.0)
    >>> print(f"{soil.k:.4f} {soil.alpha:.4f} {soil.beta:.4f}")
    8.3205 0.1601 0.1601
    """

    k: Given
    alpha: Given
    beta: Given = 0.0

    @override
    def _check(self) -> None:
        super()._check()
        self._not_negative("k", "alpha", "beta")
        require("beta", self.beta, np.less_equal(self.beta, self.alpha), "not exceed alpha")

    @classmethod
    def plane_strain(
        cls,
        E: Parameter,
        nu: Parameter,
        c: Parameter,
        phi: Parameter,
        psi: Parameter = 0.0,
    ) -> DruckerPrager:
        """Return the cone that collapses at the Mohr-Coulomb strength in plane strain.

        The parameters are as in :class:`MohrCoulomb`. At collapse the strain out of plane is
        plastic and vanishes, which fixes the stress out of plane by the plastic potential.
        """
        soil = MohrCoulomb(E, nu, c, phi, psi)
        phi = np.radians(soil.phi)
        sin_phi = np.sin(phi)
        sin_psi = np.sin(np.radians(soil.psi))
        beta = sin_psi / np.sqrt(9 + 3 * sin_psi**2)
        scale = np.sqrt(1 - 3 * beta**2) + beta * sin_phi
        alpha = sin_phi / (3 * scale)
        associated = np.equal(soil.psi, soil.phi)
        alpha = np.where(associated, beta, alpha)
        k = soil.c * np.cos(phi) / scale
        return cls(E, nu, k, alpha, beta)

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> DruckerPrager:
        check_reduction(factor, flow, self)
        if flow not in ("given", "associated") and not self.symmetric:
            raise ValueError(
                f"flow '{flow}' needs cohesion and friction angle, which a DruckerPrager cone with "
                "beta < alpha has not: use MohrCoulomb, or flow 'given' or 'associated'"
            )
        alpha = self.alpha / factor
        if flow == "associated":
            beta = alpha
        else:
            beta = reduced_dilatancy(self.beta, self.alpha, alpha)
        return self._with(k=self.k / factor, alpha=alpha, beta=beta)

    @override
    def constants(self) -> ConeConstants:
        return ConeConstants(*self.lame, self.alpha, self.beta, self.k)


@dataclass(frozen=True, eq=False)
class VonMises(ConePlasticity):
    """Drucker-Prager plasticity without friction: sqrt(3 J2) reaches the strength.

    Parameters
    ----------
    E, nu : float or ndarray
        As in :class:`LinearElastic`.
    strength : float or ndarray
        Yield stress in uniaxial tension, not negative. A soil of shear strength c in plane strain
        has sqrt(3) c.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.VonMises(E=210e3, nu=0.3, strength=235.0).reduced(2.0)
    VonMises(E=210000.0, nu=0.3, strength=117.5)
    """

    strength: Given

    @override
    def _check(self) -> None:
        super()._check()
        self._not_negative("strength")

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> VonMises:
        check_reduction(factor, flow, self)
        return self._with(strength=self.strength / factor)

    @override
    def cone(self, flow: Flow = "associated") -> tuple[Parameter, Parameter, Parameter]:
        # in plane strain the third stress of a flowing point is the mean of the others
        return self.strength / np.sqrt(3), 0.0, np.inf

    @override
    def cohesion_at(self, x: Array) -> Array | None:
        if not callable(self.strength):
            return None
        return at_points("strength", self.strength, x) / np.sqrt(3)

    @override
    def constants(self) -> ConeConstants:
        return ConeConstants(*self.lame, alpha=0.0, beta=0.0, k=self.strength / np.sqrt(3))


def _cone_return(trial: Array, constants: ConeConstants) -> Return:
    """Return principal trial stresses (3, n), all of them outside, to the cone."""
    lam, mu, alpha, beta, k = constants
    bulk = lam + 2 / 3 * mu
    mean, shear = mean_and_shear(trial)

    # Return to the cone along the potential.
    multiplier = _excess(mean, shear, constants) / (mu + 9 * bulk * alpha * beta)
    size = np.where(shear > 0, shear, 1)
    direction = (trial - mean) / size
    returned_mean = mean - 3 * bulk * beta * multiplier
    # from the yield condition, which then holds to the round-off of the returned stress
    returned_shear = np.maximum(k - 3 * alpha * returned_mean, 0)
    values = returned_mean + returned_shear * direction

    # Put stresses beyond the apex on it.
    apex = np.flatnonzero(mu * (3 * alpha * mean - k) > 9 * bulk * alpha * beta * shear)
    if apex.size:
        at_apex = chosen(constants, apex)
        values[:, apex] = at_apex.k / (3 * at_apex.alpha)

    def moduli() -> Array:
        result = np.empty((3, *trial.shape))  # (3, 3, n)
        kept = returned_shear / size
        for i in range(3):
            drop = (3 * bulk * beta + mu * direction[i]) / (mu + 9 * bulk * alpha * beta)
            for j in range(3):
                shearing = (2.0 * (i == j) - 2 / 3) * kept
                turning = (1 - kept) * direction[i] * direction[j]
                gradient = 3 * bulk * alpha + mu * direction[j]
                result[i, j] = bulk + mu * (shearing + turning) - drop * gradient
        result[:, :, apex] = 0
        return result

    return Return(values, moduli)


def _excess(mean: Array, shear: Array, k: ConeConstants) -> Array:
    """Return the yield function of the mean stress and sqrt(J2)."""
    excess = 3 * k.alpha * mean
    excess += shear
    excess -= k.k
    return excess
