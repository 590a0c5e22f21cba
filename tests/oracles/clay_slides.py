"""Upper bounds of the factor of safety of layered clay (phi = 0): a circle, and three blocks on a
broken line.

Any mechanism bounds the factor from above: the work that the clay's strength dissipates over that
of the weight. Strength is a function of places (2, n); slopes go down to the right.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy import ndarray

Strength = Callable[[ndarray], ndarray]
#: Points of the midpoint rule along a line; strength jumps between them.
_POINTS = 4000


def _resistance(line: ndarray, strength: Strength) -> float:
    """Integral of the strength along a line of points, (2, n)."""
    return float(strength((line[:, 1:] + line[:, :-1]) / 2) @ np.linalg.norm(np.diff(line), axis=0))


def circle(
    centre: tuple[float, float], radius: float, surface: ndarray, gamma: float, strength: Strength
) -> float:
    """Bound by rotation of what lies above a circle and below the centre.

    Parameters
    ----------
    centre, radius
        Of the circle.
    surface
        Points of the ground's surface from left to right, (n, 2), which the circle crosses twice.
    gamma
        Unit weight.
    strength
        Undrained strength.
    """
    x = centre[0] + radius * np.linspace(-1, 1, _POINTS + 1)
    depth = (
        np.interp(x, *surface.T)
        - centre[1]
        + np.sqrt(np.maximum(radius**2 - (x - centre[0]) ** 2, 0.0))
    )
    inside = (depth > 0) & (np.interp(x, *surface.T) < centre[1])
    moment = gamma * ((centre[0] - x) * depth)[inside].sum() * (x[1] - x[0])
    ends = x[inside][[0, -1]] - centre[0]
    angle = np.linspace(*np.pi + np.arccos(-ends / radius), _POINTS + 1)
    arc = np.array(centre)[:, None] + radius * np.array([np.cos(angle), np.sin(angle)])
    return radius * _resistance(arc, strength) / moment


def blocks(
    base: ndarray, tops: tuple[float, float], surface: ndarray, gamma: float, strength: Strength
) -> float:
    """Bound by three blocks that slide on the parts of a broken line.

    Parameters
    ----------
    base
        The four points of the line from left to right, (4, 2), the first and the last on the
        surface.
    tops
        Where the joints between the blocks, which start at the inner points, reach the surface.
    surface, gamma, strength
        As for :func:`circle`.
    """
    along = np.diff(base, axis=0) / np.linalg.norm(np.diff(base, axis=0), axis=1)[:, None]
    heads = np.stack((tops, np.interp(tops, *surface.T)), axis=1)
    velocity = [along[0]]
    for direction, joint in zip(along[1:], heads - base[1:3]):
        normal = np.array([joint[1], -joint[0]])
        velocity.append(direction * (velocity[-1] @ normal) / (direction @ normal))
    velocities = np.array(velocity)
    slides = [(base[k], base[k + 1], velocities[k]) for k in range(3)]
    slides += [(base[k + 1], heads[k], velocities[k + 1] - velocities[k]) for k in range(2)]
    share = np.linspace(0, 1, _POINTS + 1)[:, None]
    dissipated = sum(
        _resistance((a + share * (b - a)).T, strength) * np.linalg.norm(jump)
        for a, b, jump in slides
    )
    ends = np.vstack((base[:1], heads, base[3:]))
    work = 0.0
    for k in range(3):
        over = surface[(surface[:, 0] > ends[k, 0]) & (surface[:, 0] < ends[k + 1, 0])]
        below = base[k : k + 2]
        x, y = np.vstack((ends[k], over, ends[k + 1], below[::-1])).T  # clockwise
        area = 0.5 * (np.roll(x, -1) @ y - np.roll(y, -1) @ x)
        assert area > 0
        work -= gamma * area * velocities[k, 1]
    return float(dissipated / work)
