"""Curved strength of Hoek and Brown: its tangents, and lines inside and outside of it.

A reduction divides the shear strength on every plane, the envelope of Mohr's circles, by its
factor: cohesion and tan(phi) of each tangent are divided, which touches at the same normal stress
n. The circle that touches at n has the centre n + tau tan(phi) / F^2 and the radius tau / F sqrt(1
+ tan^2(phi) / F^2).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from .base import Array, Flow
from .elastic import davis_factor

#: t below which the tangent stays, at the apex it would be vertical: 1 - sin(phi) is 2e-7 then,
#: with an error of 5e-10.
APEX = 1e-14
#: Change of t, as a share, at which the root with a reduced or capped strength is found.
_FOUND = 1e-13
#: Iterations after which steps that do not shrink are round-off: near the apex it is large.
_NOISE = 12
#: Imaginary step, as a share of t, of derivatives.
IMAGINARY = 1e-30
#: Lines of bounds: with 12 the factor of a slope is off by .5 %.
_LINES = 12
#: First line, as a share of s, the t of the uniaxial strength.
_NEAR = 0.3
#: Stress of the last line over the bearing capacity of two wedges.
_BEYOND = 3.0
#: End of the last chord, as a multiple of the t of the last line.
_FAR = 1e3
#: Iterations for a root: 5 to 15 are needed.
_MOST = 100


class Tangent(NamedTuple):
    """Principal stresses where a tangent touches, and the sine of its friction angle."""

    s1: Array
    s3: Array
    sine: Array


def tangent(t: Any, k: Any) -> Tangent:
    """Return the tangent of the reduced strength by t of the whole strength, which may be complex.

    With t = s - m_b s1 / ci the whole strength is s1 - s3 = ci t^a.
    """
    power = t**k.a
    slope = k.a * k.m_b * power / t  # d (s1 - s3) / d (-s1)
    radius = 0.5 * k.ci * power
    if np.all(np.equal(k.factor, 1.0)):
        s1 = (k.s - t) * k.ci / k.m_b
        return Tangent(s1, s1 - 2 * radius, slope / (2 + slope))

    # Divide the shear stress and tan(phi) at the normal stress where the tangent touches.
    root = np.sqrt(1 + slope)
    shear = 2 * radius * root / (2 + slope) / k.factor
    friction = slope / (2 * root) / k.factor
    normal = (t - k.s) * k.ci / k.m_b + radius - radius * slope / (2 + slope)

    # Find the circle that touches there.
    centre = normal + shear * friction
    secant = np.sqrt(1 + friction**2)
    radius = shear * secant
    return Tangent(radius - centre, -radius - centre, friction / secant)


def falling_root(function: Callable[[Any], Array], start: Array) -> Array:
    """Return the zero of an analytic function that falls with t, from the apex on.

    Newton's method, with the derivative of an imaginary step, is safeguarded by a bracket.
    """
    # Bracket the zero.
    low = np.full(start.shape, APEX)
    high = np.maximum(start, 2 * APEX)
    short = function(high) > 0
    while short.any():
        low = np.where(short, high, low)
        high = np.where(short, 4 * high, high)
        short = function(high) > 0
    high = np.where(function(low) > 0, high, low)

    # Step by Newton's method where it stays in the bracket, else to the geometric mean.
    t = high
    last = np.full(t.shape, np.inf)
    for count in range(_MOST):
        value = function(t * (1 + IMAGINARY * 1j))
        above = value.real > 0
        low = np.where(above, t, low)
        high = np.where(above, high, t)
        new = t - value.real * t * IMAGINARY / value.imag
        between = (new >= low) & (new <= high)
        new = np.where(between, new, np.sqrt(low * high))
        step = np.abs(new - t)
        t = new
        solved = step <= _FOUND * t
        if count > _NOISE:
            solved |= step >= last
        if solved.all():
            break
        last = step
    return t


def lines_of(k: Any, stress: float, inner: bool, flow: Flow) -> tuple[Array, Array]:
    """Return lines inside or outside of the strength, and the compression up to which they hold.

    Tangents are outside, chords between the points where the tangents touch, from the apex on, are
    inside.
    """
    # Choose the points where tangents touch.
    uniaxial = k.ci * k.s**k.a
    two_wedges = uniaxial + k.ci * (k.m_b * uniaxial / k.ci + k.s) ** k.a  # their bearing capacity
    highest = k.s + k.m_b * np.maximum(_BEYOND * two_wedges, stress) / k.ci
    t = np.geomspace(np.maximum(_NEAR * k.s, 1e-4 * highest), highest, _LINES)
    if inner:
        t = np.concatenate((t, _FAR * t[-1:]))

    # Compute normal stress and shear stress at the points, (n_lines, n).
    s1, s3, sine = tangent(t, k)
    cosine = np.sqrt(1 - sine**2)
    radius = 0.5 * (s1 - s3)
    normal = -0.5 * (s1 + s3) - radius * sine
    shear = radius * cosine

    # Put a line through each point.
    if inner:
        apex = -np.broadcast_to(k.s * k.ci / k.m_b, normal[:1].shape)
        normal = np.concatenate((apex, normal))
        shear = np.concatenate((0 * apex, shear))
        slope = np.diff(shear, axis=0) / np.diff(normal, axis=0)
        most = normal[-1]
        normal = normal[:-1]
        shear = shear[:-1]
    else:
        slope = sine / cosine
        most = np.full(normal.shape[1], np.inf)
    lines = np.stack((shear - normal * slope, slope), axis=1)  # (n_lines, 2, n)

    # Divide the strength by Davis where the flow is not associated.
    if flow != "associated":
        friction = np.arctan(slope)
        dilatancy = np.minimum(np.arcsin(k.sin_psi), friction)
        beta: Any = davis_factor(friction, dilatancy)
        lines *= beta[:, None]
    return lines, most
