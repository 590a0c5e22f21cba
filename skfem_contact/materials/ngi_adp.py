"""NGI-ADP: clay whose undrained strength depends on the direction of shearing.

The law is one of total stresses (G. Grimstad, L. Andresen, H. P. Jostad, Int. J. Numer. Anal. Meth.
Geomech. 36 (2012) 483-497). The strength is active with compression along the vertical axis,
passive with extension, and of direct simple shear on horizontal planes. In terms of the
mobilisation kappa, which grows from 0 at the initial stress s0 to 1 at failure, the modified
deviator of the stress s (tension positive) is

    S (s - (1 - kappa) s0 - kappa (A - P) (1/3, -2/3, 1/3)),

where S scales shear on horizontal planes by (A + P) / (2 D). The yield function F - kappa (A + P) /
2 has the measure F^2 = h J2 with h = (1 + cos(arccos(y) / 3)) / 2 and y = 1 - 2 a 27/4 J3^2 / J2^3:
with a = 1 it is Tresca's largest shear stress, with less it has no corners. In plane strain all of
them are one ellipse of (sxx - syy) / 2 and sxy, whose vertices are the strengths. Flow is
associated, without change of volume.

Mobilisation follows from w, the plastic shear strain over its value at failure, by kappa = 2
sqrt(w) / (1 + w).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from typing_extensions import override

from ..errors import InadmissibleStress, IncrementTooLarge
from .adp_return import ADPConstants, measure, mobilised_by, modified, returned
from .base import (
    PLASTIC_STRAIN,
    Array,
    Flow,
    Given,
    Internal,
    Update,
    along_elements,
    check_reduction,
    require,
)
from .elastic import Isotropic
from .local_newton import take

# Excess of the yield function that is round-off, as a share of the strength.
_ROUND_OFF = 1e-12
# Plastic shear strains at failure, and strengths.
_GAMMAS = ("gamma_A", "gamma_DSS", "gamma_P")
_STRENGTHS = ("s_uA", "s_uDSS", "s_uP")


@dataclass(frozen=True, eq=False)
class NgiAdp(Isotropic):
    """Undrained clay with active, direct simple shear and passive strength, in total stresses.

    The vertical axis is y in the plane and z in space, and models refuse gravity along others.
    Strengths are reached exactly in plane strain; in triaxial compression the strength is a little
    smaller than the active one, by ``triaxial``. Yielding begins at the initial stress, which the
    material remembers; unloading is elastic.

    Parameters
    ----------
    E, nu : float, ndarray or callable
        Young's modulus of unloading, 2 (1 + nu) G_ur, and Poisson's ratio, near 0.5; see
        :meth:`from_ratios`.
    s_uA, s_uDSS, s_uP : float, ndarray or callable
        Undrained shear strengths of active, direct simple, and passive shearing, positive; like all
        parameters floats, one value an element, or functions of the coordinates (dim, ...).
    gamma_A, gamma_DSS, gamma_P : float, ndarray or callable, optional
        Plastic engineering shear strains at failure; the elastic one comes on top, (s_u - tau_0) /
        G_ur. All of them None: perfectly plastic.
    triaxial : float
        Strength in triaxial compression over `s_uA`, below 1: corners of Tresca's hexagon are
        rounded by it.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> clay = sc.NgiAdp.from_ratios(
    ...     20.0, s_uDSS=0.7, s_uP=0.4, G_ur=500.0, gamma_A=0.01, gamma_DSS=0.02, gamma_P=0.04)
    >>> active = sc.laboratory.PathStep({"xx": None}, {"yy": -0.2, "zz": 0.0}, increments=20)
    >>> test = sc.element_test(clay, 0.0, active)
    >>> ((test.stress[-1, 0] - test.stress[-1, 1]) / 2.0).round(4)
    array([20.])
    """

    s_uA: Given
    s_uDSS: Given
    s_uP: Given
    gamma_A: Given | None = None
    gamma_DSS: Given | None = None
    gamma_P: Given | None = None
    triaxial: float = 0.99

    upright = True
    internal = (
        Internal(PLASTIC_STRAIN),
        Internal("share of failure"),
        *(
            Internal(f"initial stress {name}", unit="stress")
            for name in ("xx", "yy", "zz", "xy", "yz", "zx")
        ),
    )

    @classmethod
    def from_ratios(
        cls,
        s_uA: Given,
        s_uDSS: float,
        s_uP: float,
        G_ur: float,
        gamma_A: float,
        gamma_DSS: float,
        gamma_P: float,
        nu: float = 0.495,
        triaxial: float = 0.99,
    ) -> NgiAdp:
        """Return clay whose other strengths and shear modulus are ratios to the active strength.

        Parameters
        ----------
        s_uA : float, ndarray or callable
            Active strength: a number, one value an element, or a function of the coordinates.
        s_uDSS, s_uP, G_ur : float
            Strengths of direct simple and passive shearing, and shear modulus of unloading, over
            the active strength.
        gamma_A, gamma_DSS, gamma_P : float
            Plastic shear strains at failure.
        nu, triaxial : float
            Poisson's ratio, and strength in triaxial compression over the active one.

        Examples
        --------
        A strength that rises by 2 per unit of depth below y = 0:

        >>> import skfem_contact as sc
        >>> strength = lambda x: 10.0 - 2.0 * x[1]
        >>> sc.NgiAdp.from_ratios(strength, 0.7, 0.4, 500.0, 0.01, 0.02, 0.04).functions
        ('E', 's_uA', 's_uDSS', 's_uP')
        """

        # Ratios multiply a number or a function of coordinates.
        def times(ratio: float) -> Given:
            if callable(s_uA):
                return lambda x: ratio * np.asarray(s_uA(x))
            return ratio * np.asarray(s_uA)

        return cls(
            E=times(2 * (1 + nu) * G_ur),
            nu=nu,
            s_uA=s_uA,
            s_uDSS=times(s_uDSS),
            s_uP=times(s_uP),
            gamma_A=gamma_A,
            gamma_DSS=gamma_DSS,
            gamma_P=gamma_P,
            triaxial=triaxial,
        )

    @override
    def _check(self) -> None:
        super()._check()
        # check strengths and strains at failure
        self._positive(*_STRENGTHS)
        require("s_uP", self.s_uP, np.less_equal(self.s_uP, self.s_uA), "not exceed s_uA")
        missing = [name for name in _GAMMAS if getattr(self, name) is None]
        if not missing:
            self._positive(*_GAMMAS)
        elif len(missing) < len(_GAMMAS):
            raise ValueError(
                f"{' and '.join(missing)} missing: give the shear strains at failure of all three "
                "strengths, or none of them"
            )

        # bound the triaxial ratio, below which the surface has corners
        A = self.s_uA
        P = self.s_uP
        least = (0.5 * (A - P) + np.sqrt(0.1875) * (A + P)) / A
        inside = np.less(self.triaxial, 1) & np.greater_equal(self.triaxial, least)
        demand = f"lie between {float(np.max(least)):.4g}, without corners, and 1"
        require("triaxial", self.triaxial, inside, demand)

    def _constants(self, shape: tuple[int, ...]) -> ADPConstants:
        """Return the constants at the points of a stress of a shape, flattened to (n,)."""
        A = self.s_uA
        D = self.s_uDSS
        P = self.s_uP
        radius = 0.5 * (A + P)
        shift = A - P

        # round the corners so that triaxial compression fails at its strength
        cosine = np.sqrt(0.75) * radius / (self.triaxial * A - 0.5 * shift)
        angle = np.arccos(np.clip(cosine, -1, 1))
        rounding = 0.5 * (1 - np.cos(6 * angle))

        plastic = self.gamma_A is None
        gammas = (1.0, 1.0, 1.0) if plastic else (self.gamma_A, self.gamma_DSS, self.gamma_P)
        values = (*self.lame, radius, shift, radius / D, rounding, *gammas)
        flat = []
        for value in values:
            spread = np.broadcast_to(along_elements(value, shape), shape[1:])
            flat.append(spread.ravel())
        return ADPConstants(*flat, plastic)  # type: ignore[call-arg, arg-type]

    def _shear(self, stress: Array, k: ADPConstants) -> Array:
        """Return the measure of shear of stresses at full mobilisation, (n,)."""
        flat = stress.reshape(len(stress), -1)
        return measure(modified(flat, flat, np.ones(flat.shape[1]), k), k).value

    @override
    def initial_internal(self, stress: Array) -> Array:
        memory = np.zeros((self.n_internal, *stress.shape[1:]))
        memory[2 : 2 + len(stress)] = stress
        k = self._constants(stress.shape)
        excess = self._shear(stress, k) / k.radius
        wrong = excess > 1 + 1e-6
        if wrong.any():
            worst = int(np.argmax(excess))
            raise InadmissibleStress(
                f"initial stress of NgiAdp outside the failure surface at "
                f"{np.count_nonzero(wrong)} of {wrong.size} points: {excess[worst]:.4g} of the "
                f"strength is mobilised at point {worst}; change K0, or give more strength",
                worst,
            )
        return memory

    @override
    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        k = self._constants(stress.shape)
        shear = self._shear(stress, k)
        return shear.reshape(stress.shape[1:]), k.radius.reshape(stress.shape[1:])

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> NgiAdp:
        """Return perfectly plastic clay of the reduced strengths: hardening changes no collapse."""
        check_reduction(factor, flow, self)
        weaker = {name: getattr(self, name) / factor for name in _STRENGTHS}
        return self._with(**weaker, **dict.fromkeys(_GAMMAS))

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        # find the points where the elastic stress lies outside of the yield surface
        n = len(stress)
        trial = self.elastic_stress(strain_increment, stress)
        flat = trial.reshape(n, -1)
        k = self._constants(stress.shape)
        memory = internal.reshape(len(internal), -1).copy()
        share = memory[1]
        first = memory[2 : 2 + n]
        if k.plastic:
            kappa = np.ones_like(share)
        else:
            kappa = mobilised_by(np.sqrt(share))[0]
        shear = measure(modified(flat, first, kappa, k), k).value
        points = np.flatnonzero(shear > kappa * k.radius + _ROUND_OFF * k.radius)

        # return them
        new = returned(*take((flat, first, share, k), points))
        if new.failed.size:
            raise IncrementTooLarge(
                f"{new.failed.size} of {points.size} yielding points of NgiAdp have no solution: "
                f"the stress of the first would be {flat[:, points[new.failed[0]]]}"
            )
        flat[:, points] = new.stress
        memory[0, points] += new.strain
        memory[1, points] = new.share
        return Update(trial, memory.reshape(internal.shape), points, new.tangent)
