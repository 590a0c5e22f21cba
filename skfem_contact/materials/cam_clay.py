"""Modified Cam Clay with the hyperelasticity of Houlsby, Amorosi and Rojas.

Inside this file compression is positive, p holds the attraction, e is the deviator of the elastic
strain and E = e:e. The free energy (p_a / k) exp(k ev + k g E) gives p = p_a exp(k ev + k g E), the
stress p (1 + 2 g e) and the stress ratio eta = q / p = sqrt(6 g^2 E): p is always positive, and the
stress alone is the elastic state (G. T. Houlsby, A. Amorosi, E. Rojas, Geotechnique 55 (2005)
383-392, exponent 1).

With the associated flow of q^2 / M^2 + p (p - pc) the deviator keeps the direction of its trial,
eta = x eta_trial with x = 1 / (1 + y), and the plastic volume strain of an increment is D = y (M^2
- eta^2) / (6 g). The yield condition is one equation in y >= 0:

    F = ln(p / pc) + k dev - k g E_0 - (k + 1 / (lambda - kappa)) D + k g E x^2 + ln(1 + eta^2 /
    M^2) = 0
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

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
from .local_newton import bracketed_root, take
from .plastic import BLOCK
from .spectral import deviator, square

#: Excess of the yield condition in ln(p) that is round-off: its terms are some tens with errors of
#: 1e-15.
_ROUND_OFF = 1e-13
#: Iterations: 3 to 10 are needed for strain increments of 1e-6 to 1e-1, bisections included. The
#: last one changes 1 + y by this share.
_MOST, _LAST = 80, 4e-15
#: Change of ln(p) in an increment beyond which it is refused: the pressure changes by a factor of
#: 5e8.
_LARGEST = 20.0
#: Share of the attraction below which round-off decides the pressure.
_LEAST = 1e-8
#: Square of the elastic deviator without a direction.
_ROUND = 1e-24
#: Convexity of the surface in the deviatoric plane, see :class:`CamClay`.
_LEAST_EXTENSION = 0.6


class CamClayConstants(NamedTuple):
    """Floats, or arrays over points: moduli over p, hardening, critical state and attraction."""

    k: Parameter
    g: Parameter
    hardening: Parameter
    M: Parameter
    extension: Parameter
    attraction: Parameter


@dataclass(frozen=True, eq=False)
class CamClay(Material):
    r"""Modified Cam Clay: stiffness that grows with pressure, compression, and critical state.

    The logarithm of the specific volume falls with ln(p) of the effective pressure p by ``kappa``
    inside the yield surface :math:`q^2 / M^2 + p (p - p_c) = 0` and by ``lambda_`` on it, without
    an elastic range of pressures where p is zero: ground without stress needs an `attraction`.
    Elasticity is hyperelastic: closed cycles of strain do no work.

    Parameters
    ----------
    kappa, lambda_ : float or ndarray
        Swelling and compression index of ln(volume) on ln(p), 0 < kappa < lambda: the indices of
        void ratio e on the common logarithm are larger by 2.3 (1 + e). Like all parameters a float
        or one value an element.
    M : float or ndarray
        Slope q / p of the critical state in triaxial compression, 6 sin(phi) / (3 - sin(phi)).
    nu : float or ndarray
        Poisson's ratio at isotropic stress.
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

    internal = (Internal(PLASTIC_STRAIN), Internal("preconsolidation pressure", unit="stress"))
    stress_dependent = True

    def __post_init__(self) -> None:
        as_parameters(self)
        for name in ("kappa", "M", "p_ref", "POP", "attraction"):
            value = getattr(self, name)
            if name in ("POP", "attraction"):
                require(name, value, np.greater_equal(value, 0), "not be negative")
            else:
                require(name, value, np.greater(value, 0), "be positive")
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
        return CamClayConstants(*values)

    @override
    def elasticity(
        self, ncomp: int, stress: Array | None = None, internal: Array | None = None
    ) -> Array:
        if stress is None:
            p = np.asarray(self.p_ref + 0 * self.kappa + 0 * self.nu)
            isotropic = np.zeros((ncomp, *p.shape))
            k = 1 / self.kappa
            g = 1.5 * (1 - 2 * self.nu) / (1 + self.nu) / self.kappa
            return _elastic(p, isotropic, k, g)
        c = self._constants(stress.shape)
        p, e, _ = elastic_strain(stress.reshape(ncomp, -1), c)
        self._check_pressure(p, p <= 0)
        moduli = _elastic(p, e, c.k, c.g)
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
        return q.reshape(stress.shape[1:]), limit.reshape(stress.shape[1:])

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        return self._update(strain_increment, stress, internal, _plastic)

    def _update(
        self,
        strain_increment: Array,
        stress: Array,
        internal: Array,
        rate: Callable[..., Rate],
        data: tuple[Array, ...] = (),
    ) -> Update:
        """Update points in blocks; ``rate`` returns their plastic strain from trial and data."""
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
        p0, e0, E0 = elastic_strain(stress, c)
        strain = -increment
        pc = internal[1]
        unstressed = p0 <= 0
        if unstressed.any():
            self._check_pressure(p0, unstressed & strain.any(axis=0))
            p0 = np.where(unstressed, 1.0, p0)
            pc = np.where(unstressed, 1.0, pc)

        # add the increment to the elastic strain
        volume = strain[:3].sum(axis=0)
        e = e0 + 0.5 * strain
        e[:3] += 0.5 * strain[:3] - volume / 3
        E = square(e)
        M, dM = critical(e, E, c)
        c = c._replace(M=M)

        # solve for the plastic strain y; ln(p) changes by k dev - k g E_0 - k D + k g E x^2
        growth = c.k * (volume - c.g * E0)
        flow = rate(np.log(p0 / pc) + growth, E, c, *data)
        y = flow.y
        x = 1 / (1 + y)
        D = volume_strain(y, E, c)[0]
        change = growth - c.k * D + c.k * c.g * E * x * x
        p = p0 * np.exp(np.clip(change, -_LARGEST, _LARGEST))
        refused = (np.abs(change) > _LARGEST) | (p < _LEAST * c.attraction)
        if refused.any():
            raise IncrementTooLarge(
                f"{self.label}: the mean stress changes from {p0[refused][0]:.3g} to "
                f"{p[refused][0]:.3g} or further ({refused.sum()} of {p.size} points)"
            )

        # compute stress = -p (1 + 2 g x e), accumulated plastic strain and p_c
        new = -2 * c.g * p * x * e
        new[:3] += c.attraction - p
        new[:, unstressed] = stress[:, unstressed]
        strained = internal[0] + np.hypot(y * x * np.sqrt(2 * E / 3), D)
        hardened = np.where(unstressed, internal[1], pc * np.exp(c.hardening * D))

        def tangent() -> Array:
            self._check_pressure(np.where(unstressed, 0.0, p0), unstressed)
            return _tangent(flow, e, p, E, dM, c)

        return new, np.stack((strained, hardened)), tangent


def elastic_strain(stress: Array, c: CamClayConstants) -> tuple[Array, Array, Array]:
    """Return p, the deviator e of the elastic strain with tensor shears, and E = e:e."""
    p = c.attraction - stress[:3].mean(axis=0)
    e = -stress / (2 * c.g * np.where(p > 0, p, 1.0))
    e[:3] -= e[:3].mean(axis=0)
    return p, e, square(e)


def _elastic(p: Array, e: Array, k: Parameter, g: Parameter) -> Array:
    """Return the elastic moduli at pressures (...) and deviators (ncomp, ...).

    Their form is p k (1 + 2 g e) (x) (1 + 2 g e) + 2 p g I_dev, (..., ncomp, ncomp).
    """
    ratio = 2 * g * e
    ratio[:3] += 1
    ratio = np.moveaxis(ratio, 0, -1)
    dyad = ratio[..., :, None] * ratio[..., None, :]
    stiff, shear = np.broadcast_arrays(p * k, p * g)
    volumetric = stiff[..., None, None] * dyad
    return volumetric + 2 * shear[..., None, None] * deviator(len(e))


def critical(e: Array, E: Array, c: CamClayConstants) -> tuple[Array, Array | None]:
    """Return M at the Lode angle of a deviator, and dM / d strain, None where M is constant.

    M = M_c (2 a / (1 + a - (1 - a) sin(3 theta)))^(1/4) with a = extension^4 and sin(3 theta) =
    3 sqrt(6) det(e) / E^(3/2).
    """
    if np.all(c.extension == 1.0):
        return np.broadcast_to(np.asarray(c.M, dtype=float), E.shape), None

    # compute det(e) from the minors of the deviator, its gradient
    xx, yy, zz, xy = e[:4]
    yz, zx = e[4:] if len(e) == 6 else (0 * xx, 0 * xx)
    minors = np.array(
        [
            yy * zz - yz * yz,
            zz * xx - zx * zx,
            xx * yy - xy * xy,
            yz * zx - xy * zz,
            xy * zx - xx * yz,
            xy * yz - yy * zx,
        ]
    )
    determinant = xx * minors[0] + xy * minors[3] + zx * minors[5]

    # compute M; isotropic strains, without a Lode angle, have the mean value
    directed = E > _ROUND
    square = np.where(directed, E, 1.0)
    cube = square**1.5
    sine = np.where(directed, np.clip(3 * np.sqrt(6) * determinant / cube, -1, 1), 0.0)
    a = np.asarray(c.extension) ** 4
    base = 1 + a - (1 - a) * sine
    M = c.M * (2 * a / base) ** 0.25

    # differentiate M by the deviator
    slope = np.where(directed, 0.25 * M * (1 - a) / base * 3 * np.sqrt(6) / cube, 0.0)
    gradient = minors[: len(e)]
    gradient[:3] -= gradient[:3].mean(axis=0)
    return M, slope * (gradient - 3 * determinant / square * e)


class Rate(NamedTuple):
    """Plastic strain y of an increment, and the weights of the equation that it solves.

    The derivatives of this equation are the derivatives of the yield condition F and of the volume
    strain D times ``of_condition`` and ``of_volume``, and ``of_y`` and ``of_M`` by y and M.
    """

    y: Array
    of_condition: Parameter = 1.0
    of_volume: Parameter = 0.0
    of_y: Parameter = 0.0
    of_M: Parameter = 0.0


def volume_strain(y: Array, E: Array, c: CamClayConstants) -> tuple[Array, Array]:
    """Return the plastic volume strain D, positive in compression, and its derivative by y."""
    x = 1 / (1 + y)
    rate = (c.M**2 - 6 * c.g**2 * E * x * x) / (6 * c.g)
    return y * rate, rate + 2 * y * c.g * E * x**3


def condition(y: Array, base: Array, E: Array, c: CamClayConstants) -> tuple[Array, Array]:
    """Return the yield condition F and its derivative.

    F = base - B D + k g E x^2 + ln(1 + h / M^2) with h = eta^2 = 6 g^2 E x^2.
    """
    x = 1 / (1 + y)
    B = c.k + c.hardening
    m2 = c.M**2
    square = E * x * x
    h = 6 * c.g**2 * square
    g = c.g
    BD = B * y * (m2 - h) / (6 * g)
    value = base - BD + c.k * g * square + np.log1p(h / m2)
    D_y = (m2 - h) / (6 * g) + 2 * y * g * square * x
    slope = -B * D_y - 2 * c.k * g * square * x
    slope = slope - 2 * h * x / (m2 + h)
    return value, slope


def _plastic(base: Array, E: Array, c: CamClayConstants) -> Rate:
    """Return the plastic strain y that fulfils the yield condition, zero in elastic points.

    Beyond the critical state, y_M = eta_trial / M - 1, F falls. Dry of it, the root lies in (0,
    y_M) if F(y_M) < 0; without this bracket Newton's method jumps between several roots.
    """
    # find the points outside of the yield surface
    y = np.zeros_like(E)
    excess = condition(y, base, E, c)[0]
    points = np.flatnonzero(excess > _ROUND_OFF * (1 + np.abs(base)))
    base, E, c, excess = take((base, E, c, excess), points)

    # bracket the root: it lies beyond the critical state, or before it
    at_critical = np.maximum(np.sqrt(6 * E) * c.g / c.M - 1, 0.0)
    beyond = condition(at_critical, base, E, c)[0] > 0
    farthest = 6 * c.g / c.M**2 * (excess / (c.k + c.hardening) + c.g * E / 4)
    farthest = farthest * (1 + 1e-9) + 1e-12
    low = np.where(beyond, at_critical, 0.0)
    high = np.where(beyond, np.maximum(farthest, at_critical), at_critical)

    def function(y: Array, *data: Any) -> tuple[Array, Array, Array]:
        return *condition(y, *data), _LAST * (1 + y)

    y[points], failed = bracketed_root(function, low, low, high, (base, E, c), _MOST)
    if failed.size:
        raise IncrementTooLarge(
            f"the return to the yield surface of Cam Clay fails at {failed.size} points"
        )
    return Rate(y)


def _tangent(
    flow: Rate, e: Array, p: Array, E: Array, dM: Array | None, c: CamClayConstants
) -> Array:
    """Return the tangent, (n, ncomp, ncomp).

    d stress / d strain = sigma (x) d ln(p) + 2 g p (e (x) dx + x I_dev)
    """
    y = flow.y
    k, g, _, M, *_ = c
    B = k + c.hardening
    x = 1 / (1 + y)
    h = 6 * g**2 * E * x * x

    # differentiate F and D by y and by the strain
    F_y = condition(y, np.zeros_like(E), E, c)[1]
    D_y = volume_strain(y, E, c)[1]
    ncomp = len(e)
    unit = np.r_[1.0, 1.0, 1.0, np.zeros(ncomp - 3)][:, None]
    by_E = (B * y + k) * g * x * x + 6 * g**2 * x * x / (M**2 + h)
    dF = k * unit + by_E * 2 * e
    dD = -y * g * x * x * 2 * e
    if dM is not None:
        by_M = -B * y * M / (3 * g) - 2 * h / (M * (M**2 + h))
        dF += by_M * dM
        dD += y * M / (3 * g) * dM

    # differentiate the equation that y solves
    by_y = flow.of_condition * F_y + flow.of_volume * D_y + flow.of_y
    by_strain = flow.of_condition * dF + flow.of_volume * dD
    if dM is not None:
        by_strain += flow.of_M * dM
    dy = np.where(y > 0, -by_strain / by_y, 0.0)
    dx = -x * x * dy

    # collect the changes of the pressure and of the deviator
    dlnp = k * (unit - dD - D_y * dy + 2 * g * x * x * e + 2 * g * E * x * dx)
    stress = p * (unit + 2 * g * x * e)
    turned = 2 * g * p * e
    shear = 2 * g * p * x
    result = stress.T[:, :, None] * dlnp.T[:, None, :]
    result += turned.T[:, :, None] * dx.T[:, None, :]
    return result + shear[:, None, None] * deviator(ncomp)
