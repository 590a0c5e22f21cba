"""Soft Soil Creep: Cam Clay whose plastic strain takes time.

The volume of normally consolidated clay under a constant stress falls with the logarithm of time (P. A. Vermeer, H. P.
Neher, A soft soil model that accounts for creep, Beyond 2000 in Computational Geotechnics, 1999, 249-261). With the
notation of :mod:`.cam_clay`, R = (p + q^2 / (M^2 p)) / pc and beta = (lambda - kappa) / mu, the plastic volume strain D
of an isotropic stress has the rate mu / tau R^beta; that of other stresses is smaller by 1 - eta^2 / M^2, so that
the shear strain has a finite rate at the critical state. Since pc hardens with D, an increment under constant stress is

    exp(D / mu) - 1 = (1 - eta^2 / M^2) dt / tau R_0^beta

with R_0 of the pc at its start. The increments of the analysis use this relation with the stress at their end: they are
exact while the stress stays, however long.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from typing_extensions import override

from .base import Array, Parameter, Update, along_elements, require
from .cam_clay import CamClay, CamClayConstants, Rate, condition, volume_strain

# Logarithms of the smallest y, below which there is no creep, and of the largest.
_LEAST, _MOST = -80.0, 20.0
# Iterations: 5 to 12 are needed, bisections from the bounds 60.
_ITERATIONS = 120


@dataclass(frozen=True, eq=False)
class SoftSoilCreep(CamClay):
    """Clay that creeps: Modified Cam Clay with secondary compression.

    The parameters are those of :class:`CamClay`, whose yield surface becomes the surface on which normally
    consolidated clay creeps at the rate ``mu / tau``. Within it clay creeps slower, by the power (lambda - kappa) / mu
    of the stress over the preconsolidation. An analysis needs durations: without them the clay is elastic.

    Parameters
    ----------
    kappa, lambda_, M, nu, p_ref, OCR, POP, extension, attraction : float or ndarray
        Parameters of :class:`CamClay`.
    mu : float or ndarray
        Creep index: compression of the logarithm of the volume by that of time, 0 < mu < lambda - kappa. The index
        C_alpha of void ratio e on the common logarithm of time is 2.3 (1 + e) mu.
    tau : float or ndarray
        Time at which normally consolidated clay of that preconsolidation was loaded, usually one day: the unit of all
        durations.

    Examples
    --------
    Isotropic stress for 1,000 days: the volume shrinks by mu ln(1 + t / tau).

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> clay = sc.SoftSoilCreep(0.02, 0.1, 1.2, 0.25, 100.0, mu=0.004, tau=1.0)
    >>> held = sc.laboratory.PathStep(stress={"xx": None, "yy": None, "zz": None}, strain={"xy": 0.0}, increments=3,
    ...                               duration=1000.0)
    >>> test = sc.element_test(clay, -100.0, held)
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
        require("tau", self.tau, np.greater(self.tau, 0), "be positive")

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array, dt: float = 0.0) -> Update:
        mu, tau = (np.broadcast_to(along_elements(value, stress.shape), stress.shape[1:]).ravel()
                   for value in (self.mu, self.tau))

        def creep(base: Array, E: Array, c: CamClayConstants, at: slice) -> Rate:
            return _creep(base, E, c, mu[at], dt / tau[at])

        return self._update(strain_increment, stress, internal, creep)


def _creep(base: Array, E: Array, c: CamClayConstants, mu: Array, time: Array) -> Rate:
    """Return y after a time over tau, and the weights of its derivative."""
    beta, log_time = 1 / (c.hardening * mu), np.log(np.maximum(time, 1e-300))
    low, high = np.full(E.shape, _LEAST), np.full(E.shape, _MOST)

    def excess(log_y: Array) -> tuple[Array, Array]:
        y = np.exp(log_y)
        value, slope = condition(y, base, E, c)
        D, by_y = volume_strain(y, E, c)
        grown, ratio = _growth(D / mu)
        isotropic = y * c.M**2 / (6 * c.g * mu)
        return (beta * (value + c.hardening * D) - np.log(isotropic) - grown + log_time,
                y * (beta * (slope + c.hardening * by_y) - ratio * by_y / mu) - 1)

    at = np.clip(log_time + beta * base, _LEAST, 0.0)
    for _ in range(_ITERATIONS):
        value, slope = excess(at)
        low, high = np.where(value > 0, at, low), np.where(value > 0, high, at)
        step = at - value / slope
        new = np.where((slope < 0) & (step > low) & (step < high), step, 0.5 * (low + high))
        done = np.abs(new - at).max(initial=0.0) < 1e-14 * -_LEAST
        at = new
        if done:
            break
    y = np.where((time > 0) & (at > _LEAST + 1), np.exp(at), 0.0)
    ratio = _growth(volume_strain(y, E, c)[0] / mu)[1]
    return Rate(y, beta, (1 - ratio) / mu, -1 / np.where(y > 0, y, 1.0), -2 / c.M)


def _growth(z: Array) -> tuple[Array, Array]:
    """Return ln((exp(z) - 1) / z) and its derivative."""
    small = np.abs(z) < 1e-4
    safe = np.where(small, 1.0, z)
    lost = -np.expm1(-np.abs(safe))
    value = np.maximum(safe, 0.0) + np.log(lost / np.abs(safe))
    slope = np.where(safe > 0, 1.0, 1.0 - lost) / lost * np.sign(safe) - 1 / safe
    return np.where(small, z / 2 + z * z / 24, value), np.where(small, 0.5 + z / 12, slope)
