"""Curved strength of Hoek and Brown: its tangents, whole or reduced, and lines inside and outside
of it.

A reduction divides the shear strength on every plane, the envelope of Mohr's circles, by its
factor: cohesion and tan(phi) of each tangent are divided, which touches at the same normal stress
n. The circle that touches there has the centre n + tau tan(phi) / F^2 and the radius tau / F sqrt(1
+ tan^2(phi) / F^2).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .base import Array, Flow

#: t below which the tangent stays, at the apex it would be vertical: 1 - sin(phi) is 2e-7 then,
#: with an error of 5e-10.
APEX = 1e-14
#: Change of t, as a share, at which the root with a reduced or capped strength is found.
_FOUND = 1e-13
#: Iterations after which steps that do not shrink are round-off: near the apex it is that of s.
_NOISE = 12
#: Imaginary step, as a share of t, of derivatives.
IMAGINARY = 1e-30
#: Lines of bounds, their stresses: from a share of the uniaxial strength's t to so many times the
#: bearing capacity of two wedges; the last chord ends at so many times this t. With 12 lines the
#: factor of a slope is off by .5 %.
_LINES, _NEAR, _BEYOND, _FAR = 12, 0.3, 3.0, 1e3
#: Iterations for a root: 5 to 15 are needed.
_MOST = 100


class Tangent(NamedTuple):
    """Principal stresses where a tangent touches, and the sine of its friction angle."""

    s1: Array
    s3: Array
    sine: Array


def tangent(t: Any, k: Any) -> Tangent:
    """Return the tangent of the reduced strength that belongs to t of the whole one: analytic, t
    may be complex.
    """
    power = t**k.a
    slope, radius = k.a * k.m_b * power / t, 0.5 * k.ci * power
    if np.all(np.equal(k.factor, 1.0)):
        s1 = (k.s - t) * k.ci / k.m_b
        return Tangent(s1, s1 - 2 * radius, slope / (2 + slope))
    root = np.sqrt(1 + slope)
    shear, friction = 2 * radius * root / (2 + slope) / k.factor, slope / (2 * root) / k.factor
    centre = (t - k.s) * k.ci / k.m_b + radius - radius * slope / (2 + slope) + shear * friction
    secant = np.sqrt(1 + friction**2)
    return Tangent(shear * secant - centre, -shear * secant - centre, friction / secant)


def falling_root(function: Callable[[Any], Array], start: Array) -> Array:
    """Return the zero of an analytic function that falls with t, by Newton's method in a bracket
    from the apex on.
    """
    low, high = np.full(start.shape, APEX), np.maximum(start, 2 * APEX)
    while (short := function(high) > 0).any():
        low, high = np.where(short, high, low), np.where(short, 4 * high, high)
    t = np.where(function(low) > 0, high, low)
    high, last = t, np.full(t.shape, np.inf)
    for count in range(_MOST):
        value = function(t * (1 + IMAGINARY * 1j))
        above = value.real > 0
        low, high = np.where(above, t, low), np.where(above, high, t)
        new = t - value.real * t * IMAGINARY / value.imag
        new = np.where((new >= low) & (new <= high), new, np.sqrt(low * high))
        step, t = np.abs(new - t), new
        if np.all((step <= _FOUND * new) | ((step >= last) & (count > _NOISE))):
            break
        last = step
    return t


def lines_of(k: Any, stress: float, inner: bool, flow: Flow) -> tuple[Array, Array]:
    """Return lines inside or outside of the strength, and the compression up to which they are
    inside.

    Outside are tangents, inside chords between the points where they touch, from the apex on.
    """
    uniaxial = k.ci * k.s**k.a
    wedges = (
        uniaxial + k.ci * (k.m_b * uniaxial / k.ci + k.s) ** k.a
    )  # bearing capacity of two of them
    highest = k.s + k.m_b * np.maximum(_BEYOND * wedges, stress) / k.ci
    t = np.geomspace(np.maximum(_NEAR * k.s, 1e-4 * highest), highest, _LINES)
    if inner:
        t = np.concatenate((t, _FAR * t[-1:]))
    s1, s3, sine = tangent(t, k)
    radius, cosine = 0.5 * (s1 - s3), np.sqrt(1 - sine**2)
    normal, shear = -0.5 * (s1 + s3) - radius * sine, radius * cosine
    if inner:
        apex = -np.broadcast_to(k.s * k.ci / k.m_b, normal[:1].shape)
        normal, shear = np.concatenate((apex, normal)), np.concatenate((0 * apex, shear))
        slope, normal, most = (
            np.diff(shear, axis=0) / np.diff(normal, axis=0),
            normal[:-1],
            normal[-1],
        )
        shear = shear[:-1]
    else:
        slope, most = sine / cosine, np.full(normal.shape[1], np.inf)
    lines = np.stack((shear - normal * slope, slope), axis=1)
    if flow != "associated":
        friction, dilatancy = np.arctan(slope), np.minimum(np.arcsin(k.sin_psi), np.arctan(slope))
        lines *= (
            np.cos(dilatancy) * np.cos(friction) / (1 - np.sin(dilatancy) * np.sin(friction))
        )[:, None]
    return lines, most
