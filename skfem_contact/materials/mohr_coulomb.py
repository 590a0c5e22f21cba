"""Mohr-Coulomb plasticity, its limit Tresca, and its associated substitutes.

With psi < phi collapse loads depend on mesh and path. Davis (1968) replaces the soil by an
associated soil of less strength, c* = beta c and tan phi* = beta tan phi with beta = cos psi cos
phi / (1 - sin psi sin phi): the shear strength on a plane along which the soil shears without
extension. The procedures A, B and C take beta of different angles (F. Tschuchnigg, H. F. Schweiger,
S. W. Sloan, Computers and Geotechnics 70 (2015) 169-177 and 178-189).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from typing_extensions import override

from .base import (
    Array,
    Flow,
    Given,
    Material,
    Parameter,
    Update,
    along_elements,
    check_reduction,
    require,
    warn_of_radians,
)
from .elastic import angle_over, at_points, davis_factor, reduced_dilatancy
from .plastic import IsotropicPlasticity, Return
from .pyramid import PyramidConstants, cut_off_excess, return_with_cut_off
from .spectral import extremes, principal_stresses

#: Share of the strength without pressure that remains in tension, beyond the apex of the soil.
_LEAST = 0.1


class CohesiveFrictional(Material):
    """Results of the laws with cohesion and friction angle by Mohr's circle."""

    c: Given
    phi: Given
    psi: Given
    tension: Given | None = None

    def strength_at(self, internal: Array) -> tuple[Parameter, Parameter]:
        """Return cohesion and friction angle (radians) at the points of internal variables."""
        c = along_elements(self.c, internal.shape)
        phi = along_elements(np.radians(self.phi), internal.shape)
        return c, phi

    @property
    @override
    def dilates(self) -> bool:
        return bool(np.any(np.greater(self.psi, 0.0)))

    @property
    @override
    def dilates_less(self) -> bool:
        return bool(np.any(self.psi < self.phi))

    @property
    @override
    def tensile_strength(self) -> Parameter | None:
        if self.tension is not None or not np.all(np.greater(self.phi, 0)):
            return self.tension
        return self.c / np.tan(np.radians(self.phi))

    @override
    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        largest, _, smallest = principal_stresses(stress)
        c, phi = self.strength_at(internal)
        radius = 0.5 * (largest - smallest)
        mean = 0.5 * (largest + smallest)
        return radius, c * np.cos(phi) - mean * np.sin(phi)

    @override
    def undrained_strength(self, mean: Array, internal: Array) -> Array:
        c, phi = self.strength_at(internal)
        return np.maximum(c * np.cos(phi) + mean * np.sin(phi), 0.0)

    @override
    def associated_bound(self, factor: float) -> float:
        if not self.dilates_less:
            return factor
        substitute: Any = self.reduced(factor, "davis_b")
        friction = np.tan(np.radians(self.phi))
        ratio = friction / np.tan(np.radians(substitute.phi))
        return float(np.max(ratio, initial=factor, where=np.greater(friction, 0.0)))


@dataclass(frozen=True, eq=False)
class MohrCoulomb(CohesiveFrictional, IsotropicPlasticity):
    """Linear elasticity, perfect plasticity on the Mohr-Coulomb surface, non-associated flow.

    With principal stresses s1 >= s2 >= s3 (tension positive) the yield function is
    ``(1 + sin phi) s1 - (1 - sin phi) s3 - 2 c cos phi``, and the plastic potential is the same
    with psi. Trial stresses return exactly to a face, an edge (s1 = s2 or s2 = s3) or the apex by
    Koiter's rule: W. T. Koiter, Quart. Appl. Math. 11 (1953) 350-354; J. Clausen, L. Damkilde, L.
    Andersen, Computers & Structures 85 (2007) 1795-1807.

    Parameters
    ----------
    E, nu : float, ndarray or callable
        As in :class:`LinearElastic`.
    c : float, ndarray or callable
        Cohesion (stress), not negative; like all parameters a float, one value an element, or a
        function of the coordinates (dim, ...).
    phi, psi : float, ndarray or callable
        Friction angle in degrees, 0 <= phi < 90, and dilatancy angle, 0 <= psi <= phi.
    tension : float, ndarray or callable, optional
        Tensile strength, not negative: no principal stress exceeds it, with associated flow. None,
        or a value above the apex c cot(phi), is no cut-off.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.materials import MohrCoulomb
    >>> sand = MohrCoulomb(E=1000.0, nu=0.25, c=0.0, phi=30.0)
    >>> strain = np.array([[0.001], [-0.01], [-0.001], [0.0]])
    >>> sand.update(strain, np.zeros((4, 1)), np.zeros((1, 1))).stress.ravel().round(3)
    array([ -3.8, -11.4,  -4.8,   0. ])
    """

    c: Given
    phi: Given
    psi: Given = 0.0
    tension: Given | None = None

    @override
    def _check(self) -> None:
        super()._check()
        self._not_negative("c", "psi", "tension")
        self._angle("phi")
        require("psi", self.psi, np.less_equal(self.psi, self.phi), "not exceed phi")
        warn_of_radians(phi=self.phi)

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> MohrCoulomb | AssociatedSubstitute:
        check_reduction(factor, flow, self)
        if flow == "associated":
            return self._with(psi=self.phi)._divided(factor)
        if flow == "davis_a":
            return self._davis(self.psi)._divided(factor)
        weaker = self._divided(factor)
        if flow == "davis_b":
            return weaker._davis(weaker.psi)
        if flow == "davis_c":
            psi = angle_over(self.psi, factor)
            return weaker._davis(np.minimum(psi, weaker.phi))
        if flow == "lagged" and not weaker.symmetric:
            return AssociatedSubstitute(weaker)
        return weaker

    def _divided(self, factor: float) -> MohrCoulomb:
        """Return the soil with c, tan(phi) and tensile strength divided by a factor."""
        phi = angle_over(self.phi, factor)
        psi = reduced_dilatancy(self.psi, self.phi, phi)
        if self.tension is None:
            tension = None
        else:
            tension = self.tension / factor
        return self._with(c=self.c / factor, phi=phi, psi=psi, tension=tension)

    def _davis(self, psi: Parameter) -> MohrCoulomb:
        """Return Davis' associated soil for a dilatancy angle."""
        friction = np.radians(self.phi)
        beta = davis_factor(friction, np.radians(psi))
        phi = np.degrees(np.arctan(beta * np.tan(friction)))
        return self._with(c=beta * self.c, phi=phi, psi=phi)

    @override
    def cone(self, flow: Flow = "associated") -> tuple[Parameter, Parameter, Parameter] | None:
        if flow != "associated":
            return self.reduced(1.0, flow).cone()
        tension = np.inf if self.tension is None else self.tension
        return self.c, np.tan(np.radians(self.phi)), tension

    @override
    def cohesion_at(self, x: Array) -> Array | None:
        if callable(self.c):
            return at_points("c", self.c, x)
        return None

    @override
    def constants(self) -> PyramidConstants:
        phi = np.radians(self.phi)
        psi = np.radians(self.psi)
        strength = 2 * self.c * np.cos(phi)
        return PyramidConstants(*self.lame, np.sin(phi), np.sin(psi), strength, self.tension)

    @property
    @override
    def symmetric(self) -> bool:
        constants = self.constants()
        return bool(np.all(constants.sin_phi == constants.sin_psi))

    @override
    def yield_bound(self, stress: Array, constants: PyramidConstants) -> Array:
        return cut_off_excess(*extremes(stress), constants)

    @override
    def yield_function(self, values: Array, constants: PyramidConstants) -> Array:
        return cut_off_excess(values[0], values[2], constants)

    @override
    def return_map(self, trial: Array, constants: PyramidConstants) -> Return:
        return return_with_cut_off(trial, constants)


@dataclass(frozen=True, eq=False)
class Tresca(MohrCoulomb):
    """Mohr-Coulomb plasticity without friction: undrained soil with the shear strength c.

    Plastic flow does not change the volume.

    Parameters
    ----------
    E, nu, c : float, ndarray or callable
        As in :class:`MohrCoulomb`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.Tresca(E=1000.0, nu=0.25, c=10.0).reduced(2.0)
    Tresca(E=1000.0, nu=0.25, c=5.0)

    A strength that rises with the depth below y = 0, by 2 per unit of length, and a stiffness of
    500 times as much:

    >>> def strength(x):
    ...     return 10.0 - 2.0 * x[1]
    >>> clay = sc.Tresca(E=lambda x: 500.0 * strength(x), nu=0.49, c=strength)
    >>> clay.functions
    ('E', 'c')
    """

    phi: Given = field(default=0.0, init=False, repr=False)
    psi: Given = field(default=0.0, init=False, repr=False)
    tension: Given | None = field(default=None, init=False, repr=False)


@dataclass(frozen=True, eq=False)
class AssociatedSubstitute(Material):
    """Mohr-Coulomb soil with the friction of the last accepted stress.

    Its flow is associated, so that its increments have a convex potential. In tension the strength
    does not fall below a tenth of ``2 c cos(phi)``. K. Krabbenhoft, M. R. Karim, A. V. Lyamin,
    S. W. Sloan, Int. J. Numer. Meth. Engng 90 (2012) 1089-1117.

    Parameters
    ----------
    soil : MohrCoulomb
        Soil of less dilatancy than friction.
    """

    soil: MohrCoulomb
    internal = MohrCoulomb.internal

    @override
    def elasticity(
        self,
        ncomp: int,
        stress: Array | None = None,
        internal: Array | None = None,
    ) -> Array:
        return self.soil.elasticity(ncomp)

    @override
    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        return self.soil.mobilised(stress, internal)

    @property
    @override
    def tensile_strength(self) -> Parameter | None:
        return self.soil.tensile_strength

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        def spread(value: Parameter) -> Parameter:
            value = along_elements(value, stress.shape)
            if isinstance(value, np.ndarray):
                return value.ravel()
            return value

        def flat(values: Array) -> Array:
            return values.reshape(len(values), -1)

        # Compute the strength at the accepted stress, by
        # (1 + sin phi) s1 - (1 - sin phi) s3 = (1 + sin psi) s1 - (1 - sin psi) s3
        #                                       + (sin phi - sin psi) (s1 + s3).
        soil = self.soil
        phi = np.radians(spread(soil.phi))
        psi = np.radians(spread(soil.psi))
        largest, smallest = (extreme.ravel() for extreme in extremes(stress))
        unloaded = 2 * spread(soil.c) * np.cos(phi)
        strength = unloaded - (np.sin(phi) - np.sin(psi)) * (largest + smallest)
        strength = np.maximum(strength, _LEAST * unloaded)

        # Update the associated soil of this strength, with one element a point.
        angle = spread(soil.psi)
        substitute = replace(
            soil,
            E=spread(soil.E),
            nu=spread(soil.nu),
            c=strength / (2 * np.cos(psi)),
            phi=angle,
            psi=angle,
            tension=None if soil.tension is None else spread(soil.tension),
        )
        new = substitute.update(flat(strain_increment), flat(stress), flat(internal))
        return new._replace(
            stress=new.stress.reshape(stress.shape), internal=new.internal.reshape(internal.shape)
        )
