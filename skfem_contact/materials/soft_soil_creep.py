"""Soft Soil Creep: Cam Clay whose plastic strain takes time.

The volume of normally consolidated clay under a constant stress falls with the logarithm of time
(P. A. Vermeer, H. P. Neher, A soft soil model that accounts for creep, Beyond 2000 in Computational
Geotechnics, 1999, 249-261). With the notation of :mod:`.cam_clay`, R = (p + q^2 / (M^2 p)) / pc and
beta = (lambda - kappa) / mu, the plastic volume strain D of an isotropic stress has the rate mu /
tau R^beta; the rate under other stresses is smaller by 1 - eta^2 / M^2, so that the shear strain
has a finite rate at the critical state. Since pc hardens with D, an increment under constant stress
is

    exp(D / mu) - 1 = (1 - eta^2 / M^2) dt / tau R_0^beta

with R_0 of the pc at its start. Where the stress changes, R_0^beta dt becomes an integral over the
increment. R_0 that grows is linear in time, as under an even load; R_0^beta that falls is a power
of the time, -(lambda - kappa) / lambda, as where isotropic stress relaxes at constant volume.
Increments are then exact however long they are. Increments of other paths have an error of second
order in the change of R_0.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from .base import Array, Parameter, Update, along_elements, require
from .cam_clay import CamClay
from .cam_clay_return import (
    CamClayConstants,
    Course,
    Plastic,
    Rate,
    Search,
    Trial,
    at_pressure,
    course,
    critical,
    elastic_strain,
    isotropic,
    joint_root,
    joint_step,
    pressure,
)
from .local_newton import bracketed_root, take

# Logarithms of the smallest y, below which nothing creeps, and of the largest.
_LEAST = -80.0
_MOST = 20.0
# Iterations: 5 to 12 are needed, bisections from the bounds 60. The last one changes ln(y) by less.
_ITERATIONS = 120
_LAST = 8e-13


@dataclass(frozen=True, eq=False)
class SoftSoilCreep(CamClay):
    """Clay that creeps: Modified Cam Clay with secondary compression.

    The yield surface of :class:`CamClay` becomes the surface on which normally consolidated clay
    creeps at the rate ``mu / tau``. Within it clay creeps slower, by the power (lambda - kappa) /
    mu of the stress over the preconsolidation. An analysis needs durations: without them the clay
    is elastic.

    Parameters
    ----------
    kappa, lambda_, M, nu, p_ref, OCR, POP, extension, attraction : float or ndarray
        Parameters of :class:`CamClay`.
    mu : float or ndarray
        Creep index: compression of ln(volume) by ln(time), 0 < mu < lambda - kappa. The index
        C_alpha of void ratio e on the common logarithm of time is 2.3 (1 + e) mu.
    tau : float or ndarray
        Time since normally consolidated clay reached its preconsolidation, usually one day: the
        unit of all durations.

    Examples
    --------
    Isotropic stress for 1,000 days: the volume shrinks by mu ln(1 + t / tau).

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> clay = sc.SoftSoilCreep(0.02, 0.1, 1.2, 0.25, 100.0, mu=0.004, tau=1.0)
    >>> constant = {"xx": None, "yy": None, "zz": None}
    >>> rest = sc.laboratory.PathStep(constant, {"xy": 0.0}, increments=3, duration=1000.0)
    >>> test = sc.element_test(clay, -100.0, rest)
    >>> bool(abs(test.volume[-1, 0] / (0.004 * np.log(1001.0)) + 1.0) < 1e-9)
    True
    """

    mu: Parameter = field(kw_only=True)
    tau: Parameter = field(kw_only=True)

    time_dependent = True

    @override
    def __post_init__(self) -> None:
        super().__post_init__()
        inside = np.greater(self.mu, 0) & np.less(self.mu, np.subtract(self.lambda_, self.kappa))
        require("mu", self.mu, inside, "lie between 0 and lambda - kappa")
        self._positive("tau")

    @override
    def update(
        self,
        strain_increment: Array,
        stress: Array,
        internal: Array,
        dt: float = 0.0,
    ) -> Update:
        shape = stress.shape
        mu, tau = (
            np.broadcast_to(along_elements(value, shape), shape[1:]).ravel()
            for value in (self.mu, self.tau)
        )

        # compute R at the start, 1 where stress and creep are none
        c = self._constants(shape)
        p, e, E = elastic_strain(stress.reshape(len(stress), -1), c)
        M = critical(e, E, c)[0]
        pressed = p > 0
        pc = np.where(pressed, internal[1].ravel(), 1.0)
        R = p / pc * (1 + 6 * c.g**2 * E / M**2)
        begin = np.log(np.where(pressed, R, 1.0))
        data = mu, dt / tau, begin
        return self._update(strain_increment, stress, internal, _creep, data)


def _creep(trial: Trial, mu: Array, time: Array, begin: Array) -> Rate:
    """Return the plastic strain y after a time over tau, from ln(R) at its start."""
    # Scale of the creep rate: β = 1 / (hardening μ*).
    c = trial.c
    beta = 1 / (c.hardening * mu)
    passed = np.maximum(time, 1e-300)
    log_time = np.log(passed)
    times = mu, beta, log_time, begin

    # Solve for log y, as y spans many powers of ten, and z; begin from the creep of a constant
    # stress.
    base = trial.base + c.k * trial.volume
    start = np.clip(log_time + beta * base, _LEAST, 0.0)
    with np.errstate(all="ignore"):
        log_y, z, failed = joint_root(_joint, start, _LEAST, trial, (times,))

    # Search again where this fails, within bounds.
    if failed.size:
        log_y[failed], z[failed] = _bracketed(start[failed], *take((trial, times), failed))

    # Points that do not creep keep y = 0.
    creeps = (time > 0) & (log_y > _LEAST + 1)
    y = np.where(creeps, np.exp(log_y), 0.0)
    at = at_pressure(np.exp(log_y), z, trial)
    _, _, of_condition, of_volume = _equation(at, course(at, trial), trial, *times)
    z = np.where(creeps, z, pressure(y, trial, z))
    return Rate(y, z, of_condition, of_volume, of_isotropic=-1.0)


def _joint(x: Array, trial: Trial, times: tuple[Array, ...]) -> tuple[Array, Array]:
    """Return Newton's step of ln(y) and z, (2, n), and the error of their equations."""
    y = np.exp(x[0])
    at = at_pressure(y, x[1], trial)
    now = course(at, trial)
    value, slope, of_condition, of_volume = _equation(at, now, trial, *times)
    by_z = of_condition * now.F_z + of_volume * at.D_z - 2 * at.M_z / at.M + at.slope
    step, error = joint_step(at, now, value, by_z, slope / y)
    step[0] /= y
    return step, error


def _bracketed(start: Array, trial: Trial, times: tuple[Array, ...]) -> tuple[Array, Array]:
    """Return ln(y) and z from a start of ln(y), between bounds of it."""
    search = Search(trial)

    def function(
        log_y: Array,
        points: NDArray[np.intp],
        trial: Trial,
        times: tuple[Array, ...],
    ) -> tuple[Array, Array, float]:
        at = search.at(np.exp(log_y), points, trial)
        return *_equation(at, course(at, trial), trial, *times)[:2], _LAST

    low = np.full(start.shape, _LEAST)
    high = np.full(start.shape, _MOST)
    data = *search.data, times
    log_y, _ = bracketed_root(function, start, low, high, data, _ITERATIONS)
    return log_y, search.at(np.exp(log_y), *search.data).z


def _equation(
    at: Plastic,
    now: Course,
    trial: Trial,
    mu: Array,
    beta: Array,
    log_time: Array,
    begin: Array,
) -> tuple[Array, Array, Array, Array]:
    """Return the equation of ln(y), its slope, and the weights of F and D in its derivatives.

    With D = y (M^2 - eta^2) / (6 g r) the logarithm of the increment's equation is

        ln(R^beta) + ln(mean(R_0^beta) / R^beta) + ln(dt / tau) - ln(y M^2 / (6 g r mu)) -
        ln((exp(D / mu) - 1) / (D / mu)) = 0
    """
    c = trial.c
    end = beta * (now.F + c.hardening * at.D)
    mean, share = _mean(end - beta * begin, beta, c)
    grown, ratio = _growth(at.D / mu)
    rate, rate_y = isotropic(at, now)
    value = end + mean - (rate - np.log(mu)) - grown + log_time
    of_condition = beta * share
    of_volume = (share - ratio) / mu
    slope = of_condition * now.F_y + of_volume * now.D_y - rate_y
    return value, at.y * slope, of_condition, of_volume


def _mean(change: Array, beta: Array, c: CamClayConstants) -> tuple[Array, Array]:
    """Return ln(mean of R_0^beta / its end), 1 + its derivative by the change of ln(R_0^beta)."""
    power = np.where(change > 0, -1 / beta, 1 + c.hardening / c.k)
    above, rise = _growth((power - 1) * change)
    below, fall = _growth(power * change)
    return above - below, 1 + (power - 1) * rise - power * fall


def _growth(z: Array) -> tuple[Array, Array]:
    """Return ln((exp(z) - 1) / z) and its derivative."""
    small = np.abs(z) < 1e-4
    safe = np.where(small, 1.0, z)
    size = np.abs(safe)
    decay = -np.expm1(-size)
    value = np.maximum(safe, 0.0) + np.log(decay / size)
    value = np.where(small, z / 2 + z * z / 24, value)
    share = np.where(safe > 0, 1.0, 1.0 - decay)
    slope = share / decay * np.sign(safe) - 1 / safe
    slope = np.where(small, 0.5 + z / 12, slope)
    return value, slope
