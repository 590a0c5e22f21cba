"""Modified Cam Clay.

The return to the yield surface is in :mod:`.cam_clay_return`. Inside this file compression is
positive, p holds the attraction, e is the deviator of the stress over 2 g p and E = e:e. The stress
alone is the elastic state, and p is always positive.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from ..errors import InadmissibleStress, IncrementTooLarge
from .base import (
    PLASTIC_STRAIN,
    Array,
    Internal,
    Material,
    Parameter,
    Update,
    along_elements,
    as_parameters,
    require,
)
from .cam_clay_return import (
    CamClayConstants,
    Rate,
    at_pressure,
    critical,
    deviators,
    elastic_moduli,
    elastic_strain,
    plastic,
    tangent,
    trial_of,
)
from .local_newton import take
from .plastic import BLOCK

#: Change of ln(p) in an increment beyond which it is refused: the pressure changes by a factor of
#: 5e8.
_LARGEST = 20.0
#: Share of the attraction below which round-off decides the pressure.
_LEAST = 1e-8
#: Convexity of the surface in the deviatoric plane, see :class:`CamClay`.
_LEAST_EXTENSION = 0.6


@dataclass(frozen=True, eq=False)
class CamClay(Material):
    r"""Modified Cam Clay: stiffness that grows with pressure, compression, and critical state.

    The logarithm of the specific volume falls with ln(p) of the effective pressure p by ``kappa``
    inside the yield surface :math:`q^2 / M^2 + p (p - p_c) = 0` and by ``lambda_`` on it, without
    an elastic range of pressures where p is zero: ground without stress needs an `attraction`.
    Poisson's ratio is constant, as in other programs: the undrained strength of a sample from
    isotropic stress is M p / 2 (OCR / 2)^(1 - kappa / lambda).

    Parameters
    ----------
    kappa, lambda_ : float or ndarray
        Swelling and compression index of ln(volume) on ln(p), 0 < kappa < lambda: the indices of
        void ratio e on the common logarithm are larger by 2.3 (1 + e). Like all parameters a float
        or one value an element.
    M : float or ndarray
        Slope q / p of the critical state in triaxial compression, 6 sin(phi) / (3 - sin(phi)).
    nu : float or ndarray
        Poisson's ratio; with `conservative` at isotropic stress.
    p_ref : float or ndarray
        Typical mean stress. Penalties and elastic estimates follow from its stiffness, stresses do
        not.
    OCR : float or ndarray
        Preconsolidation pressure p_c over the equivalent pressure p + q^2 / (M^2 p) of the initial
        stress, at least 1.
    POP : float or ndarray
        Stress that is added to that preconsolidation pressure.
    extension : float or ndarray
        M in triaxial extension over that in compression, 0.6 to 1; (3 - sin(phi)) / (3 + sin(phi))
        for Mohr-Coulomb. Between them follows D. Sheng, S. W. Sloan, H. S. Yu, Comput. Mech. 26
        (2000) 185-196.
    attraction : float or ndarray
        Isotropic stress that is added to every stress, such as c cot(phi).
    conservative : bool
        Take the stiffness from a free energy, so that closed cycles of elastic strain do no work
        (G. T. Houlsby, A. Amorosi, E. Rojas, Geotechnique 55 (2005) 383-392). Shearing then raises
        the pressure, and the undrained strength is larger by the factor exp(kappa (1 + nu) M^2 / (9
        (1 - 2 nu) lambda)): 1.05 for kappa = lambda / 5, M = 1.2 and nu = 0.25, 1.08 for nu = 0.33.

    Examples
    --------
    Isotropic compression to the fourfold pressure: the volume shrinks by lambda ln 4.

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> clay = sc.CamClay(kappa=0.02, lambda_=0.1, M=1.2, nu=0.25, p_ref=100.0)
    >>> test = sc.element_test(clay, -100.0, sc.laboratory.isotropic(-400.0, increments=1))
    >>> (test.volume[-1] / np.log(4.0)).round(9)
    array([-0.1])
    """

    kappa: Parameter
    lambda_: Parameter
    M: Parameter
    nu: Parameter
    p_ref: Parameter
    OCR: Parameter = 1.0
    POP: Parameter = 0.0
    extension: Parameter = 1.0
    attraction: Parameter = 0.0
    conservative: bool = False

    internal = (Internal(PLASTIC_STRAIN), Internal("preconsolidation pressure", unit="stress"))
    stress_dependent = True

    def __post_init__(self) -> None:
        as_parameters(self)
        self._positive("kappa", "M", "p_ref")
        self._not_negative("POP", "attraction")
        require("lambda_", self.lambda_, np.greater(self.lambda_, self.kappa), "exceed kappa")
        possible = np.greater(self.nu, -1) & np.less(self.nu, 0.5)
        require("nu", self.nu, possible, "lie between -1 and 0.5")
        require("OCR", self.OCR, np.greater_equal(self.OCR, 1), "not be less than 1")
        convex = np.greater_equal(self.extension, _LEAST_EXTENSION)
        convex &= np.less_equal(self.extension, 1)
        require("extension", self.extension, convex, f"lie between {_LEAST_EXTENSION} and 1")

    def _constants(self, shape: tuple[int, ...]) -> CamClayConstants:
        """Return the constants at the points of a stress of a shape, flattened."""
        k = 1 / self.kappa
        g = 1.5 * (1 - 2 * self.nu) / (1 + self.nu) * k
        hardening = 1 / (self.lambda_ - self.kappa)
        values = []
        for value in (k, g, hardening, self.M, self.extension, self.attraction):
            spread = along_elements(value, shape)
            values.append(spread.ravel() if isinstance(spread, np.ndarray) else spread)
        return CamClayConstants(self.conservative, *values)

    @override
    def elasticity(
        self,
        ncomp: int,
        stress: Array | None = None,
        internal: Array | None = None,
    ) -> Array:
        if stress is None:
            p = np.asarray(self.p_ref + 0 * self.kappa + 0 * self.nu)
            isotropic = np.zeros((ncomp, *p.shape))
            k = 1 / self.kappa
            g = 1.5 * (1 - 2 * self.nu) / (1 + self.nu) / self.kappa
            return elastic_moduli(p, isotropic, k, g)
        c = self._constants(stress.shape)
        p, e, _ = elastic_strain(stress.reshape(ncomp, -1), c)
        self._check_pressure(p, p <= 0)
        if not self.conservative:
            e = 0 * e
        moduli = elastic_moduli(p, e, c.k, c.g)
        return moduli.reshape(*stress.shape[1:], ncomp, ncomp)

    @override
    def initial_internal(self, stress: Array) -> Array:
        c = self._constants(stress.shape)
        p, e, E = elastic_strain(stress.reshape(len(stress), -1), c)
        sheared = (p == 0) & (E > 0)
        self._check_pressure(p, (p < 0) | sheared)

        # p_c = OCR (p + q^2 / (M^2 p)) + POP
        M = critical(e, E, c)[0]
        equivalent = p * (1 + 6 * c.g**2 * E / M**2)
        equivalent = equivalent.reshape(stress.shape[1:])
        pc = along_elements(self.OCR, stress.shape) * equivalent
        pc += along_elements(self.POP, stress.shape)
        return np.stack((np.zeros_like(pc), pc))

    def _check_pressure(self, p: Array, wrong: NDArray[np.bool_]) -> None:
        """Refuse points without a positive pressure."""
        if wrong.any():
            worst = int(np.argmin(np.where(wrong, p, np.inf)))
            raise InadmissibleStress(
                f"{self.label} has neither stiffness nor strength without pressure, but p plus the "
                f"attraction is {p[worst]:.4g} at point {worst} ({wrong.sum()} of {p.size} "
                "points): begin with compressive initial stresses, or give `attraction`",
                worst,
            )

    @override
    def yielding(self, before: Array, after: Array) -> NDArray[np.bool_]:
        return np.any(after[:2] != before[:2], axis=0)

    @override
    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        c = self._constants(stress.shape)
        p, e, E = elastic_strain(stress.reshape(len(stress), -1), c)
        q = np.sqrt(6 * E) * c.g * p
        limit = critical(e, E, c)[0] * p
        shape = stress.shape[1:]
        return q.reshape(shape), limit.reshape(shape)

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        return self._update(strain_increment, stress, internal, plastic)

    def _update(
        self,
        strain_increment: Array,
        stress: Array,
        internal: Array,
        rate: Callable[..., Rate],
        data: tuple[Array, ...] = (),
    ) -> Update:
        """Update points in blocks; ``rate`` returns their plastic strain from a trial and data."""
        # give all arrays one axis of points
        increment = strain_increment.reshape(len(strain_increment), -1)
        start = stress.reshape(len(stress), -1)
        before = internal.reshape(len(internal), -1)
        n = start.shape[1]
        points = increment, start, before, self._constants(stress.shape), data

        # update block by block, which the cache holds
        new = np.empty_like(start)
        memory = np.empty((2, n))
        tangents = []
        for first in range(0, max(n, 1), BLOCK):
            block = slice(first, first + BLOCK)
            new[:, block], memory[:, block], tangent = self._updated(*take(points, block), rate)
            tangents.append(tangent)
        return Update(
            new.reshape(stress.shape),
            memory.reshape(2, *stress.shape[1:]),
            np.arange(n),
            lambda: np.concatenate([tangent() for tangent in tangents]),
        )

    def _updated(
        self,
        increment: Array,
        stress: Array,
        internal: Array,
        c: CamClayConstants,
        data: tuple[Array, ...],
        rate: Callable[..., Rate],
    ) -> tuple[Array, Array, Callable[[], Array]]:
        """Return stresses (ncomp, n), internal variables (2, n) and tangent of a block."""
        # begin at any pressure where points without pressure keep their strain
        p0, e0, _ = elastic_strain(stress, c)
        strain = -increment
        pc = internal[1]
        unstressed = p0 <= 0
        if unstressed.any():
            self._check_pressure(p0, unstressed & strain.any(axis=0))
            p0 = np.where(unstressed, 1.0, p0)
            pc = np.where(unstressed, 1.0, pc)

        # solve for the plastic strain and the pressure
        trial = trial_of(strain, np.log(p0 / pc), e0, c)
        flow = rate(trial, *data)
        change = flow.z
        p = p0 * np.exp(change)
        refused = (np.abs(change) > _LARGEST) | (p < _LEAST * c.attraction)
        if refused.any():
            raise IncrementTooLarge(
                f"{self.label}: the mean stress changes from {p0[refused][0]:.3g} to "
                f"{p[refused][0]:.3g} or further ({refused.sum()} of {p.size} points)"
            )

        # compute stress = -p (1 + 2 g x e), accumulated plastic strain and p_c
        at = at_pressure(flow.y, change, trial)
        new = -2 * c.g * p * at.x * deviators(change, trial)[0]
        new[:3] += c.attraction - p
        new[:, unstressed] = stress[:, unstressed]
        shear = flow.y * at.x * np.sqrt(2 * at.E / 3) / at.r
        strained = internal[0] + np.hypot(shear, at.D)
        hardened = np.where(unstressed, internal[1], pc * np.exp(c.hardening * at.D))

        def moduli() -> Array:
            self._check_pressure(np.where(unstressed, 0.0, p0), unstressed)
            return tangent(flow, at, trial, p)

        return new, np.stack((strained, hardened)), moduli
