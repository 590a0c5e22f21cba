"""Exact fields of an elastic half-plane ``y <= 0`` under tractions on its surface, by
Muskhelishvili's potentials.

Plane strain, stresses positive in tension.  On ``y = 0`` the body is pressed: sigma_yy = -p(x),
sigma_xy = 0.  All displacements contain the same arbitrary rigid shift.  Prescribed on the edges of
a finite box they make the problem of the half-plane one of the box, without any error of
truncation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np


@dataclass(frozen=True)
class Potential:
    """``Phi(z) = int p / (t - z) dt / (2 pi i)``, its derivative and its antiderivative."""

    Phi: Callable
    dPhi: Callable
    phi: Callable

    def stress(self, x, y):
        """Stresses (sxx, syy, sxy), (3, ...)."""
        z = np.asarray(x) + 1j * np.asarray(y)
        trace = 4 * self.Phi(z).real
        t = self.Phi(z) - self.Phi(z.conj()) + (z - z.conj()) * self.dPhi(z).conj()
        return np.stack((trace - t.real, t.real, -t.imag))

    def displacement(self, x, y, E, nu):
        """Displacements, (2, ...)."""
        z = np.asarray(x) + 1j * np.asarray(y)
        w = (3 - 4 * nu) * self.phi(z) + self.phi(z.conj()) - (z - z.conj()) * self.Phi(z).conj()
        w = w * (1 + nu) / E
        return np.stack((w.real, w.imag))


def _root(z, a):
    """sqrt(z^2 - a^2), like z at infinity, with its cut on [-a, a]."""
    return np.sqrt(z - a) * np.sqrt(z + a)


def elliptic(peak, a):
    """Hertz: p = peak sqrt(1 - x^2 / a^2)."""
    c = 0.5j * peak / a
    return Potential(
        lambda z: c * (z - _root(z, a)),
        lambda z: c * (1 - z / _root(z, a)),
        lambda z: 0.5 * c * (z**2 - z * _root(z, a) + a**2 * np.log(z + _root(z, a))),
    )


def flat_punch(force, a):
    """Sadowsky: p = force / (pi sqrt(a^2 - x^2))."""
    c = 0.5j * force / np.pi
    return Potential(
        lambda z: c / _root(z, a),
        lambda z: -c * z / _root(z, a) ** 3,
        lambda z: c * np.log(z + _root(z, a)),
    )


def line_loads(t, force):
    """Line loads at the places ``t``: the quadrature of any pressure."""
    c = np.asarray(force) / (2j * np.pi)

    def summed(function):
        return lambda z: function(t - np.asarray(z)[..., None]) @ c

    return Potential(
        summed(lambda d: 1 / d),
        summed(lambda d: 1 / d**2),
        summed(lambda d: -np.log(d.astype(complex))),
    )


def quadrature(pressure, *ends):
    """Line loads, (n,) and (n,), that stand for a pressure which is singular at the given places.

    At the surface itself, displacements are those of the pressure at these places only.
    """
    t, w = np.polynomial.legendre.leggauss(8)
    t, w = 0.5 * (t + 1), 0.5 * w
    graded = np.concatenate(
        ([0.0], 0.5 ** np.arange(40, 0, -1.0))
    )  # to 1e-12 of half of the length
    places, weights = [], []
    for a, b in pairwise(ends):
        for start, length in ((a, 0.5 * (b - a)), (b, 0.5 * (a - b))):
            cuts = start + 2 * length * graded
            places.append((cuts[:-1, None] + np.diff(cuts)[:, None] * t).ravel())
            weights.append((np.abs(np.diff(cuts))[:, None] * w).ravel())
    place = np.concatenate(places)
    return place, np.concatenate(weights) * pressure(place)


def contact_modulus(E1, nu1, E2=np.inf, nu2=0.0):
    """E*: 1/E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2."""
    return 1 / ((1 - nu1**2) / E1 + (1 - nu2**2) / E2)


def hertz(force, radius, modulus):
    """Half of the contact's width, and the largest pressure."""
    a = np.sqrt(4 * force * radius / (np.pi * modulus))
    return a, 2 * force / (np.pi * a)


def rounded_punch(b, a, radius, modulus):
    """Schtaerman: flat for |x| < b, parabolic beyond, in contact for |x| < a; the force and
    p(x).
    """
    f0 = np.arcsin(b / a)
    D = np.pi - 2 * f0 - np.sin(2 * f0)
    force = modulus * a**2 * D / (4 * radius)

    def pressure(x):
        f = np.arcsin(np.clip(np.asarray(x, float) / a, -1, 1))
        bulk = (np.pi - 2 * f0) * np.cos(f)
        edges = np.sin(f) * np.log(np.abs(np.sin(f + f0) / np.sin(f - f0)))
        edges = edges + np.sin(f0) * np.log(np.abs(np.tan((f + f0) / 2) * np.tan((f - f0) / 2)))
        return 2 * force / (np.pi * a * D) * (bulk + edges)

    return force, pressure


def wedge(degrees, a, modulus):
    """A blunt wedge whose faces slope by an angle, in contact for |x| < a; the force and p(x)."""
    slope = np.tan(np.radians(degrees))
    return modulus * a * slope, lambda x: modulus * slope / np.pi * np.arccosh(a / np.abs(x))
