"""Closed forms of contact on elastic half-spaces: Hertz, Mindlin, punches, torsion.

K. L. Johnson, Contact Mechanics (Cambridge, 1985), by section; the torsion is that of J. L. Lubkin,
J. Appl. Mech. 18 (1951) 183. Two bodies count by their ``modulus`` E* and, sideways, by their
``compliance``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc


def modulus(young: float, poisson: float, bodies: int = 1) -> float:
    """E* of a body on a rigid one, or of two alike."""
    return young / (1 - poisson**2) / bodies


def dome(r: ndarray, a: float) -> ndarray:
    """sqrt(1 - r^2/a^2) within a, and zero outside."""
    return np.sqrt(np.maximum(0.0, 1 - (r / a) ** 2))


def hertz(force: float, radius: float, modulus: float) -> tuple[float, float]:
    """Radius a of the contact of a ball and its largest pressure (section 4.2); the approach is a^2
    / R.
    """
    a = (0.75 * force * radius / modulus) ** (1 / 3)
    return a, 1.5 * force / (np.pi * a**2)


def hertz_ellipse(
    force: float, flat: float, steep: float, modulus: float
) -> tuple[float, float, float, float]:
    """Semi-axes a > b, largest pressure and approach for the gap A x^2 + B y^2 with A < B (section
    4.2).
    """

    def integrals(k: float) -> tuple[float, float]:
        return ellipk(1 - k**2), ellipe(1 - k**2)

    def ratio(k: float) -> float:
        K, E = integrals(k)
        return (E / k**2 - K) / (K - E) - steep / flat

    k = brentq(ratio, 1e-4, 1 - 1e-9)
    K, E = integrals(k)
    a = (1.5 * force * (K - E) / (np.pi * modulus * flat * (1 - k**2))) ** (1 / 3)
    peak = 1.5 * force / (np.pi * k * a**2)
    return a, k * a, peak, peak * k * a * K / modulus


@dataclass(frozen=True)
class Mindlin:
    """A ball that is pressed and then sheared (Cattaneo 1938, Mindlin 1949; section 7.2).

    Attributes
    ----------
    friction
        Coefficient of friction times the normal force.
    shear
        Force sideways.
    radius
        That of the contact.
    compliance
        Sum of (2 - nu) / G over both bodies.
    """

    friction: float
    shear: float
    radius: float
    compliance: float

    @property
    def _left(self) -> float:
        return 1 - self.shear / self.friction

    @property
    def stick_radius(self) -> float:
        """Radius of the zone that sticks."""
        return self.radius * self._left ** (1 / 3)

    @property
    def shift(self) -> float:
        """Approach of far points sideways."""
        return (
            3 * self.friction / (16 * self.radius) * self.compliance * (1 - self._left ** (2 / 3))
        )

    def traction(self, r: ndarray) -> ndarray:
        """Shear traction: friction less what the stick zone takes back."""
        c, a = self.stick_radius, self.radius
        return 1.5 * self.friction / (np.pi * a**2) * (dome(r, a) - c / a * dome(r, c))

    @property
    def loss(self) -> float:
        """Energy of a cycle between plus and minus the shear force."""
        x, left = 1 - self._left, self._left
        shape = 1 - left ** (5 / 3) - 5 * x / 6 * (1 + left ** (2 / 3))
        return 0.9 * self.friction**2 * self.compliance / self.radius * shape


def flat_punch(
    r: ndarray, depth: float, a: float, modulus: float
) -> tuple[float, ndarray, ndarray]:
    """Force on a rigid cylinder, its pressure and the settlement of the surface (section 3.8)."""
    inside = np.minimum(r / a, 1 - 1e-15)
    pressure = np.where(r < a, depth * modulus / (np.pi * a * np.sqrt(1 - inside**2)), 0.0)
    surface = np.where(r < a, depth, 2 * depth / np.pi * np.arcsin(a / np.maximum(r, a)))
    return 2 * modulus * a * depth, pressure, surface


def cone(r: ndarray, a: float, slope: float, modulus: float) -> tuple[float, float, ndarray]:
    """Force on a rigid cone in contact for r < a, its depth and pressure (section 5.2)."""
    pressure = 0.5 * modulus * slope * np.arccosh(np.maximum(a / np.maximum(r, 1e-12 * a), 1.0))
    return 0.5 * np.pi * modulus * slope * a**2, 0.5 * np.pi * slope * a, pressure


def lubkin(r: ndarray, stick: float, friction: float, a: float) -> ndarray:
    """Shear traction around the axis under a ball that is turned, with the stick radius `stick`
    a.
    """
    x, m = np.minimum(r / a, 1.0), 1 - stick**2
    within = np.clip((stick**2 - x**2) / np.maximum(1 - x**2, 1e-300), 0.0, None)
    angle = np.arcsin(np.clip(np.sqrt(within) / stick, 0.0, 1.0))
    K, E = ellipk(m), ellipe(m)
    sticks = np.pi / 2 + (K - E) * ellipkinc(angle, stick**2) - K * ellipeinc(angle, stick**2)
    return (
        3
        * friction
        / (np.pi * a) ** 2
        * np.sqrt(1 - x**2)
        * np.where(x >= stick, np.pi / 2, sticks)
    )


def lubkin_twist(stick: float, friction: float, a: float, shear_modulus: float) -> float:
    """Angle by which the half-space is turned against a rigid ball."""
    return (
        3
        * friction
        / (4 * np.pi * shear_modulus * a**2)
        * (ellipk(1 - stick**2) - ellipe(1 - stick**2))
    )


def lubkin_torque(stick: float, friction: float, a: float) -> float:
    """Torque: the integral of the traction, by Gauss points whose ends take the roots."""
    t, weight = np.polynomial.legendre.leggauss(100)
    total = 0.0
    for low, high in ((0.0, stick), (stick, 1.0)):
        r = a * (low + (high - low) * np.sin(np.pi / 4 * (t + 1)))
        dr = a * (high - low) * np.cos(np.pi / 4 * (t + 1)) * np.pi / 4 * weight
        total += float(2 * np.pi * r**2 * lubkin(r, stick, friction, a) @ dr)
    return total


def far_field(points: ndarray, force: float, young: float, poisson: float) -> ndarray:
    """Displacements (3, n) below a force at the origin that acts downwards, -z (Boussinesq; section
    3.2).
    """
    x, y, z = points[0], points[1], -points[2]
    r, R = np.hypot(x, y), np.sqrt(x**2 + y**2 + z**2)
    scale = force * (1 + poisson) / (2 * np.pi * young * R)
    outwards = scale * (z / R**2 - (1 - 2 * poisson) / (R + z)) * r
    direction = np.stack((x, y)) / np.maximum(r, 1e-300)
    return np.concatenate((outwards * direction, [-scale * (z**2 / R**2 + 2 * (1 - poisson))]))
