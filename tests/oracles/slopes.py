"""Closed forms of slopes and footings, and Chen's log-spiral upper bound of homogeneous slopes."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq, minimize

#: Value of angles that are no mechanism.
_NO_MECHANISM = 1e6


def infinite_slope(beta: float, c: float, phi: float, gamma: float, depth: float) -> float:
    """Factor of safety of a layer of some vertical depth that slides on its base, inclined by beta
    degrees.
    """
    b, friction = np.radians(beta), np.tan(np.radians(phi))
    normal, shear = gamma * depth * np.cos(b) ** 2, gamma * depth * np.sin(b) * np.cos(b)
    return (c + normal * friction) / shear


def without_dilatancy(factor: float, phi: float) -> float:
    """Factor of the same slide if psi = 0 (Davis 1968): F = F_associated cos(phi*), tan(phi*) =
    tan(phi) / F.
    """
    friction = np.tan(np.radians(phi))
    return float(np.sqrt(factor**2 - friction**2))


def bearing_capacity(phi: float) -> float:
    """Prandtl's N_c of a strip footing."""
    if phi == 0.0:
        return 2 + np.pi
    f = np.radians(phi)
    return float((np.exp(np.pi * np.tan(f)) * np.tan(np.pi / 4 + f / 2) ** 2 - 1) / np.tan(f))


def stability_number(beta: float, phi: float) -> float:
    """Smallest gamma H / c of Chen's rotational log-spiral mechanisms, an upper bound of the
    critical one.

    The slope of beta degrees has a level crest.  With r(theta) = r0 exp((theta - theta0) tan(phi))
    the unknowns are the angles at which the spiral starts in the crest and ends on the level of the
    toe, and the inclination of the line from there to the edge of the crest (W. F. Chen, Limit
    Analysis and Soil Plasticity, 1975, ch. 9).
    """
    slope, t = np.radians(beta), np.tan(np.radians(phi))

    def number(angles: np.ndarray) -> float:
        start, end, lower = angles
        if not (0 < start < end < np.pi and 0 < lower <= slope):
            return _NO_MECHANISM
        growth = np.exp((end - start) * t)
        height = np.sin(end) * growth - np.sin(start)  # over r0
        length = np.cos(start) - np.cos(end) * growth - height / np.tan(lower)
        if height <= 0 or length < 0:
            return _NO_MECHANISM
        cubic = growth**3
        whole = (
            (3 * t * np.cos(end) + np.sin(end)) * cubic - 3 * t * np.cos(start) - np.sin(start)
        ) / (3 + 27 * t * t)
        crest = length / 6 * (2 * np.cos(start) - length) * np.sin(start)
        chord = (
            growth
            / 6
            * (np.sin(end - start) - length * np.sin(end))
            * (np.cos(start) - length + np.cos(end) * growth)
        )
        face = (
            height**2
            * np.sin(slope - lower)
            / (2 * np.sin(slope) * np.sin(lower))
            * (np.cos(start) - length - height / 3 * (1 / np.tan(lower) + 1 / np.tan(slope)))
        )
        weight = whole - crest - chord - face
        dissipated = (growth**2 - 1) / (2 * t) if t > 0 else end - start
        return height * dissipated / weight if weight > 0 else _NO_MECHANISM

    guesses = [
        (start, end, share * slope)
        for start in (0.4, 0.9)
        for end in (1.5, 1.9)
        for share in (0.6, 0.99)
    ]
    settings = {"xatol": 1e-9, "fatol": 1e-11, "maxiter": 3000}
    return min(
        float(minimize(number, g, method="Nelder-Mead", options=settings).fun) for g in guesses
    )


def log_spiral_factor(beta: float, phi: float, c_over_weight: float) -> float:
    """Upper bound of the factor of safety of a homogeneous slope with c / (gamma H), by strength
    reduction.
    """
    friction = np.tan(np.radians(phi))

    def margin(factor: float) -> float:
        return (
            stability_number(beta, np.degrees(np.arctan(friction / factor)))
            * c_over_weight
            / factor
            - 1.0
        )

    return float(brentq(margin, 0.5, 4.0, xtol=1e-5))
