"""Return to the yield surface of Modified Cam Clay, with elasticity by either of two laws.

Inside this file compression is positive, p holds the attraction, e is the deviator of the stress
over 2 g p, and E = e:e: the stress is p (1 + 2 g e), the stress ratio eta = q / p = sqrt(6 g^2 E).
The pressure of an increment with the volume strain v, D of it plastic, is p = p_0 exp(z). Where
Poisson's ratio is constant the shear modulus g p follows the pressure. Of a volume strain that
grows evenly its mean is g p r, and the elastic trial of the increment with the deviator de is

    z = k (v - D),    e = exp(-z) e_0 + r de,    r = (1 - exp(-z)) / z

exact for every elastic strain in a fixed direction. The conservative law has the free energy (p_a /
k) exp(k v_e + k g E) of the elastic strain (v_e, e): p = p_a exp(k v_e + k g E) and the stress p (1
+ 2 g e), so that (G. T. Houlsby, A. Amorosi, E. Rojas, Geotechnique 55 (2005) 383-392, exponent 1)

    z = k (v - D) + k g (E x^2 - E_0),    e = e_0 + de,    r = 1

With the associated flow of q^2 / M^2 + p (p - pc) the deviator keeps the direction of its trial, is
smaller by x = 1 / (1 + y), and the plastic volume strain is D = y (M^2 - eta^2) / (6 g r) with eta
of x e. The yield condition is one equation in y >= 0:

    F = ln(p_0 / pc) + z - D / (lambda - kappa) + ln(1 + eta^2 / M^2) = 0

Newton's method solves it for y together with the equation of z. Where this fails, y is bracketed,
and z follows from y by a Newton's method of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import IncrementTooLarge
from .base import Array, Parameter
from .local_newton import bracketed_root, damped_newton, take
from .spectral import deviator, product, square

#: Excess of the yield condition in ln(p) that is round-off: its terms are some tens with errors of
#: 1e-15.
_ROUND_OFF = 1e-13
#: Iterations for y and z together, of which 2 to 7 are needed for strain increments of 1e-6 to
#: 5e-3, and halvings of a step; error of both equations whose square is round-off.
_JOINT = 12
_HALVINGS = 3
_LAST_JOINT = 1e-9
#: Iterations in a bracket: 3 to 10 are needed for strain increments of 1e-6 to 1e-1, bisections
#: included. The last one changes 1 + y by this share.
_MOST = 80
_LAST = 4e-15
#: Bounds of ln(p / p_0), beyond the change at which an increment is refused; the change of the last
#: iteration, whose square is round-off; steps, of which 1 to 4 are needed, and iterations that may
#: bisect.
_FARTHEST = 40.0
_LAST_PRESSURE = 3e-8
_STEPS = 6
_MOST_PRESSURE = 120
#: Change of ln(p) below which a series replaces the quotient.
_SMALL = 1e-4
#: Square of the elastic deviator without a direction.
_ROUND = 1e-24


class CamClayConstants(NamedTuple):
    """Floats, or arrays over points: moduli over p, hardening, critical state and attraction."""

    conservative: bool
    k: Parameter
    g: Parameter
    hardening: Parameter
    M: Parameter
    extension: Parameter
    attraction: Parameter


class Trial(NamedTuple):
    """Start and strain of increments at points: ln(p_0 / pc), volume strain, e_0 and de.

    The last array, (3, n), has e_0:e_0, e_0:de and de:de.
    """

    base: Array
    volume: Array
    e0: Array
    de: Array
    c: CamClayConstants
    products: Array


class Plastic(NamedTuple):
    """Increments at points with a plastic strain y and a pressure z: names of the module."""

    y: Array
    z: Array
    x: Array
    r: Parameter
    slope: Parameter  # d ln(r) / dz
    stiff: Parameter  # 6 g r
    E: Array
    E_z: Array
    M: Parameter
    M_z: Parameter
    dM: Array | None  # dM / d strain at a given z, None where M is constant
    h: Array  # eta^2
    D: Array
    D_y: Array  # at a given z
    D_z: Array
    gap: Array  # of the equation of z
    gap_y: Array
    gap_z: Array


class Course(NamedTuple):
    """Yield condition F, F_z of it at a given y, and the derivatives of F, D, z and M by y."""

    F: Array
    F_z: Array
    F_y: Array
    D_y: Array
    z_y: Array
    M_y: Parameter


class Rate(NamedTuple):
    """Plastic strain y and pressure z of an increment, and the weights of the equation of y.

    The derivatives of this equation are the derivatives of the yield condition F, of the volume
    strain D and of the logarithm of the isotropic rate, times these weights.
    """

    y: Array
    z: Array
    of_condition: Parameter = 1.0
    of_volume: Parameter = 0.0
    of_isotropic: Parameter = 0.0


def elastic_strain(stress: Array, c: CamClayConstants) -> tuple[Array, Array, Array]:
    """Return p, the deviator e of the elastic strain with tensor shears, and E = e:e."""
    p = c.attraction - stress[:3].mean(axis=0)
    e = -stress / (2 * c.g * np.where(p > 0, p, 1.0))
    e[:3] -= e[:3].mean(axis=0)
    return p, e, square(e)


def elastic_moduli(p: Array, e: Array, k: Parameter, g: Parameter) -> Array:
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
    sine = np.clip(3 * np.sqrt(6) * determinant / cube, -1, 1)
    sine = np.where(directed, sine, 0.0)
    a = np.asarray(c.extension) ** 4
    base = 1 + a - (1 - a) * sine
    M = c.M * (2 * a / base) ** 0.25

    # differentiate M by the deviator
    slope = 0.25 * M * (1 - a) / base * 3 * np.sqrt(6) / cube
    slope = np.where(directed, slope, 0.0)
    gradient = minors[: len(e)]
    gradient[:3] -= gradient[:3].mean(axis=0)
    return M, slope * (gradient - 3 * determinant / square * e)


def trial_of(strain: Array, base: Array, e0: Array, c: CamClayConstants) -> Trial:
    """Return the trial of engineering strains that are positive in compression."""
    volume = strain[:3].sum(axis=0)
    de = 0.5 * strain
    de[:3] += 0.5 * strain[:3] - volume / 3
    products = np.array((square(e0), product(e0, de), square(de)))
    return Trial(base, volume, e0, de, c, products)


def _shares(z: Array, conservative: bool) -> tuple[Parameter, Parameter, Parameter, Parameter]:
    """Return the shares a and r of e_0 and de in the trial, with their derivatives by z."""
    if conservative:
        return 1.0, 0.0, 1.0, 0.0
    small = np.abs(z) < _SMALL
    safe = np.where(small, 1.0, z)
    decay = np.expm1(-z)
    a = 1 + decay
    r = np.where(small, 1 - z / 2 + z * z / 6, -decay / safe)
    r_z = np.where(small, -0.5 + z / 3 - z * z / 8, (a - r) / safe)
    return a, -a, r, r_z


def deviators(z: Array, trial: Trial) -> tuple[Array, Array]:
    """Return the deviator e of the elastic trial, and its derivative by z."""
    a, a_z, r, r_z = _shares(z, trial.c.conservative)
    return a * trial.e0 + r * trial.de, a_z * trial.e0 + r_z * trial.de


def at_pressure(y: Array, z: Array, trial: Trial) -> Plastic:
    """Return increments with the plastic strain y and the pressure p_0 exp(z)."""
    c = trial.c
    k = c.k
    g = c.g

    # compute the square of the elastic trial, and M in its direction
    a, a_z, r, r_z = _shares(z, c.conservative)
    start, mixed, change = trial.products
    E = np.maximum(a * a * start + 2 * a * r * mixed + r * r * change, 0.0)
    E_z = 2 * (a * a_z * start + (a * r_z + a_z * r) * mixed + r * r_z * change)
    M: Parameter = c.M
    dM: Array | None = None
    M_z: Parameter = 0.0
    if not np.all(c.extension == 1.0):
        e, e_z = deviators(z, trial)
        M, gradient = critical(e, E, c)
        dM = np.asarray(gradient)
        by_shear = (dM[3:] * e_z[3:]).sum(axis=0)
        M_z = (dM[:3] * e_z[:3]).sum(axis=0) + 2 * by_shear

    # compute D = y (M^2 - h) / (6 g r), h = 6 g^2 E x^2
    x = 1 / (1 + y)
    ratio = 6 * g**2 * x * x
    h = ratio * E
    slope = r_z / r
    stiff = 6 * g * r
    rate = (M**2 - h) / stiff
    D = y * rate
    D_y = rate + 2 * y * h * x / stiff
    D_z = y * (2 * M * M_z - ratio * E_z) / stiff - D * slope

    # compare z with the elastic volume strain
    gap = z - k * (trial.volume - D)
    gap_y = k * D_y
    if c.conservative:
        gap = gap - k * g * (E * x * x - start)
        gap_y = gap_y + 2 * k * g * E * x**3
    gap_z = 1 + k * D_z
    return Plastic(
        y,
        z,
        x,
        r,
        slope,
        stiff,
        E,
        E_z,
        M,
        M_z,
        dM,
        h,
        D,
        D_y,
        D_z,
        gap,
        gap_y,
        gap_z,
    )


def pressure(y: Array, trial: Trial, start: Array | None = None) -> Array:
    """Return z = ln(p / p_0) of increments with the plastic strain y, from a start."""
    elastic = np.clip(trial.c.k * trial.volume, -_FARTHEST, _FARTHEST)
    if trial.c.conservative:
        return elastic - at_pressure(y, elastic, trial).gap

    # take steps of Newton's method, which are enough at nearly all points
    z = elastic if start is None else start
    remaining = np.ones(z.shape, bool)
    for _ in range(_STEPS):
        at = at_pressure(y, z, trial)
        step = at.gap / at.gap_z
        z = np.clip(z - step, -_FARTHEST, _FARTHEST)
        remaining = ~(np.abs(step) < _LAST_PRESSURE)
        if not remaining.any():
            return z

    # bisect at the others
    def function(z: Array, y: Array, trial: Trial) -> tuple[Array, Array, float]:
        at = at_pressure(y, z, trial)
        return -at.gap, -at.gap_z, _LAST_PRESSURE

    points = np.flatnonzero(remaining)
    data = take((y, trial), points)
    low = np.full(points.size, -_FARTHEST)
    z[points], _ = bracketed_root(function, elastic[points], low, -low, data, _MOST_PRESSURE)
    return z


def course(at: Plastic, trial: Trial) -> Course:
    """Return the parts of an equation of y."""
    c = trial.c

    # differentiate z, D and M along the solution of the equation of z
    z_y = -at.gap_y / at.gap_z
    D_y = at.D_y + at.D_z * z_y
    M_y = at.M_z * z_y

    # F = base + z - H D + ln(1 + h / M^2)
    square = at.M**2
    most = square + at.h
    F = trial.base + at.z - c.hardening * at.D + np.log1p(at.h / square)
    h_z = 6 * c.g**2 * at.x**2 * at.E_z
    h_by_M = h_z - 2 * at.h * at.M_z / at.M
    F_z = 1 - c.hardening * at.D_z + h_by_M / most
    F_y = F_z * z_y - c.hardening * at.D_y - 2 * at.h * at.x / most
    return Course(F, F_z, F_y, D_y, z_y, M_y)


class Search:
    """Increments at points whose pressures are kept from one iteration of y to the next."""

    def __init__(self, trial: Trial) -> None:
        self.data = np.arange(trial.base.size), trial
        self._z = np.clip(trial.c.k * trial.volume, -_FARTHEST, _FARTHEST)

    def at(self, y: Array, points: NDArray[np.intp], trial: Trial) -> Plastic:
        """Return increments of some points with the plastic strain y."""
        z = pressure(y, trial, self._z[points])
        self._z[points] = z
        return at_pressure(y, z, trial)


def joint_step(
    at: Plastic,
    now: Course,
    value: Array,
    by_z: Parameter,
    by_y: Array,
) -> tuple[Array, Array]:
    """Return Newton's step (dy, dz), (2, n), of the equations of y and of z, and their error.

    ``by_z`` is the derivative of the value at a given y, ``by_y`` that along the equation of z.
    """
    dz = -at.gap / at.gap_z
    dy = -(value + by_z * dz) / by_y
    return np.array((dy, dz + now.z_y * dy)), np.abs(value) + np.abs(at.gap)


def joint_root(
    function: Callable[..., tuple[Array, Array]],
    start: Array,
    least: float,
    trial: Trial,
    data: tuple[Any, ...] = (),
) -> tuple[Array, Array, NDArray[np.intp]]:
    """Return the root of a function of y and z, from a start and a least value of y.

    The call ``function(x, trial, *data)`` returns Newton's step and the error. Points at which the
    method fails are the last return value.
    """
    elastic = np.clip(trial.c.k * trial.volume, -_FARTHEST, _FARTHEST)
    first = np.array((start, elastic))
    lowest = np.array([[least], [-_FARTHEST]])
    points = trial, *data
    (y, z), failed = damped_newton(
        function,
        first,
        points,
        _LAST_JOINT,
        _JOINT,
        _HALVINGS,
        lowest,
    )
    return y, z, failed


def plastic(trial: Trial) -> Rate:
    """Return y and z that fulfil the yield condition, y = 0 in elastic points."""
    # find the points outside of the yield surface
    c = trial.c
    y = np.zeros_like(trial.base)
    z = np.clip(c.k * trial.volume, -_FARTHEST, _FARTHEST)
    if c.conservative:
        z = pressure(y, trial)
    at = at_pressure(y, z, trial)
    excess = course(at, trial).F
    points = np.flatnonzero(excess > _ROUND_OFF * (1 + np.abs(trial.base)))
    if points.size:
        y[points], z[points] = _yielding(*take((trial, at), points))
    return Rate(y, z)


def _yielding(trial: Trial, elastic: Plastic) -> tuple[Array, Array]:
    """Return y and z of points outside of the yield surface, from their elastic trials.

    Beyond the critical state, y_M = eta_trial / M - 1, F falls and has one root at most.
    Before it Newton's method may jump between several roots. F(y_M) < 0 shows that the root is one
    in (0, y_M), dry of the critical state.
    """
    # solve for y and z together
    with np.errstate(all="ignore"):
        y, z, failed = joint_root(_joint, elastic.y, 0.0, trial)

    # look at the critical state where the root is before it
    at_critical = np.maximum(np.sqrt(elastic.h) / elastic.M - 1, 0.0)
    doubtful = y < at_critical
    before = np.flatnonzero(doubtful)
    if before.size:
        doubtful[before] = _condition(at_critical[before], take(trial, before)) > 0
    doubtful[failed] = True

    # search again, within a bracket
    again = np.flatnonzero(doubtful)
    if again.size:
        y[again], z[again] = _bracketed(at_critical[again], take(trial, again))
    return y, z


def _joint(x: Array, trial: Trial) -> tuple[Array, Array]:
    """Return Newton's step of y and z, (2, n), and the error of the yield condition and of z."""
    y, z = x
    at = at_pressure(y, z, trial)
    now = course(at, trial)
    return joint_step(at, now, now.F, now.F_z, now.F_y)


def _condition(y: Array, trial: Trial) -> Array:
    """Return the yield condition F of the plastic strain y."""
    return course(at_pressure(y, pressure(y, trial), trial), trial).F


def _bracketed(at_critical: Array, trial: Trial) -> tuple[Array, Array]:
    """Return y and z of points outside of the yield surface, from y at the critical state.

    Dry of it, the root lies in (0, y_M) if F(y_M) < 0. At y_M the plastic volume strain is zero,
    and z is that of the elastic trial.
    """
    # bracket the root: it lies beyond the critical state, or before it
    F = _condition(at_critical, trial)
    beyond = F > 0
    farthest = np.maximum(_farthest(np.where(beyond, F, 0.0), trial), at_critical)
    low = np.where(beyond, at_critical, 0.0)
    high = np.where(beyond, farthest, at_critical)

    # solve for it
    search = Search(trial)

    def function(y: Array, points: NDArray[np.intp], trial: Trial) -> tuple[Array, Array, Array]:
        now = course(search.at(y, points, trial), trial)
        return now.F, now.F_y, _LAST * (1 + y)

    y, failed = bracketed_root(function, low, low, high, search.data, _MOST)
    if failed.size:
        raise IncrementTooLarge(
            f"the return to the yield surface of Cam Clay fails at {failed.size} points"
        )
    return y, pressure(y, trial)


def _farthest(F: Array, trial: Trial) -> Array:
    """Return y beyond the yield surface, from F > 0 at the critical state.

    Beyond it F is less than the value there less (k + H) D, and D > y M^2 / (6 g r) - g E / (4 r)
    with the largest r and E, at the smallest pressure.
    """
    c = trial.c
    volume = F / (c.k + c.hardening)
    z = np.clip(c.k * (trial.volume - volume), -_FARTHEST, _FARTHEST)
    a, _, r, _ = _shares(z, c.conservative)
    E = (a * np.sqrt(trial.products[0]) + r * np.sqrt(trial.products[2])) ** 2
    smallest = c.M * c.extension
    farthest = 6 * c.g / smallest**2 * (r * volume + c.g * E / 4)
    return farthest * (1 + 1e-9) + 1e-12


def tangent(flow: Rate, at: Plastic, trial: Trial, p: Array) -> Array:
    """Return the tangent, (n, ncomp, ncomp), at pressures p.

    d stress / d strain = (sigma + 2 g p x e_z) (x) dz + 2 g p (e (x) dx + x r I_dev)
    """
    c = trial.c
    y = at.y
    x = at.x
    M = at.M
    e, e_z = deviators(at.z, trial)
    ncomp = len(e)
    unit = np.r_[1.0, 1.0, 1.0, np.zeros(ncomp - 3)][:, None]

    # differentiate D, then z, by the strain at a given y
    dE = 2 * at.r * e
    dD = -y * c.g * x * x / at.r * dE
    dM = np.zeros_like(y)
    if at.dM is not None:
        dM = at.r * at.dM
        dD += y * M / (3 * c.g * at.r) * dM
    dgap = c.k * (dD - unit)
    if c.conservative:
        dgap -= c.k * c.g * x * x * dE
    dz = -dgap / at.gap_z
    dD += at.D_z * dz
    dM = dM + at.M_z * dz
    dh = 6 * c.g**2 * x * x * (dE + at.E_z * dz)

    # differentiate the equation that y solves; ln(y M^2 / (6 g r)) is the isotropic rate
    now = course(at, trial)
    dh_by_M = dh - 2 * at.h / M * dM
    dF = dz - c.hardening * dD + dh_by_M / (M**2 + at.h)
    by_strain = flow.of_condition * dF + flow.of_volume * dD
    by_strain += flow.of_isotropic * (2 * dM / M - at.slope * dz)
    by_y = flow.of_condition * now.F_y + flow.of_volume * now.D_y
    isotropic_by_y = isotropic(at, now)[1]
    by_y = by_y + flow.of_isotropic * isotropic_by_y
    dy = np.where(y > 0, -by_strain / by_y, 0.0)
    dx = -x * x * dy
    dz += now.z_y * dy

    # collect the changes of the pressure and of the deviator
    shear = 2 * c.g * p * x
    spherical = p * unit + shear * (e + e_z)
    turned = 2 * c.g * p * e
    result = spherical.T[:, :, None] * dz.T[:, None, :]
    result += turned.T[:, :, None] * dx.T[:, None, :]
    return result + (shear * at.r)[:, None, None] * deviator(ncomp)


def isotropic(at: Plastic, now: Course) -> tuple[Array, Array]:
    """Return ln(y M^2 / (6 g r)), D of the same y without shear, and its derivative by y."""
    y = np.where(at.y > 0, at.y, 1.0)
    value = np.log(y * at.M**2 / at.stiff)
    return value, 1 / y + 2 * now.M_y / at.M - at.slope * now.z_y
