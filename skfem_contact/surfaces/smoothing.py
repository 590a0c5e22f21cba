"""Hermite smoothing of a faceted master surface (eqs 23 and 24 of the paper, mended).

At the joint x3 of the facets x2-x3 and x3-x4 a cubic runs from ``x_a`` to ``x_b``, both at the
share alpha of their facet's length from the joint, with the end tangents ``x3 - x_a`` and ``x_b -
x3`` (eq. 23).  The curve is linear in the three nodes; collinear facets are reproduced exactly and
all joints are C1.
"""

from __future__ import annotations

import numpy as np
from numpy import ndarray

from ..checks import is_number
from .surface import Surface
from .topology import following

# Hermite polynomials of eq. 24 in the powers of xi; the last one ends with -1.
_HERMITE = np.array([[2, -3, 0, 1], [2, 3, 0, -1], [1, -1, -1, 1], [-1, -1, 1, 1]]) / 4.0


def smoothed(surface: Surface, alpha: float = 0.5, corner: float = 45.0) -> Surface:
    """Return a chain of straight facets with its joints rounded by Hermite cubics.

    Parameters
    ----------
    surface : Surface
        Chain of straight facets.
    alpha : float
        Share of each facet that the curve takes at its end, 0 < alpha <= 1/2.
    corner : float
        Angle in degrees; joints that turn by more stay sharp.
    """
    if surface.dim != 2:
        raise ValueError(
            f"smoothing: '{surface.name}' is a surface in space; use elements of second order there"
        )
    if not (alpha == 0.5 or is_number(alpha, 0.0, 0.5)):
        raise ValueError(f"smoothing: alpha must lie in (0, 0.5], not {alpha!r}")
    if surface.facets.shape[1] != 2:
        raise ValueError(
            f"smoothing: the facets of '{surface.name}' are curved already; smooth linear elements "
            f"only"
        )
    before = np.arange(len(surface.facets))
    after = (before + 1) % len(before)
    if not surface.closed:
        before, after = before[:-1], after[:-1]
    along = surface.nodes[surface.facets[:, 1]] - surface.nodes[surface.facets[:, 0]]
    direction = np.arctan2(along[:, 1], along[:, 0])
    turn = np.abs((direction[after] - direction[before] + np.pi) % (2 * np.pi) - np.pi)
    soft = np.rad2deg(turn) <= corner + 1e-6  # all joints of an octagon alike
    before, after = before[soft], after[soft]

    start, end = np.zeros(len(along)), np.ones(len(along))
    end[before], start[after] = 1.0 - alpha, alpha
    straight = np.flatnonzero(end - start > 1e-12)
    nodes = np.concatenate(
        (
            surface.facets[straight][:, [0, 1, 1]],
            np.column_stack((surface.facets[before], surface.facets[after, 1])),
        )
    )
    coefficients = np.concatenate(
        (
            _straight(start[straight], end[straight]),
            np.broadcast_to(_rounded(alpha), (len(before), 3, 4)),
        )
    )
    order = np.argsort(np.concatenate((straight, before + 0.5)), kind="stable")
    shape = surface.shape.of(coefficients[order], np.arange(4)[:, None])
    return surface.with_facets(nodes[order], shape, following(len(order), surface.closed))


def _straight(start: ndarray, end: ndarray) -> ndarray:
    middle, half = 0.5 * (start + end), 0.5 * (end - start)
    coefficients = np.zeros((len(start), 3, 4))
    coefficients[:, 0, 0], coefficients[:, 0, 1] = 1.0 - middle, -half
    coefficients[:, 1, 0], coefficients[:, 1, 1] = middle, half
    return coefficients


def _rounded(alpha: float) -> ndarray:
    ends = np.array(
        [
            [alpha, 1 - alpha, 0],
            [0, 1 - alpha, alpha],  # x_a, x_b
            [-alpha, alpha, 0],
            [0, -alpha, alpha],
        ]
    )  # tangents, eq. 23
    return np.asarray(ends.T @ _HERMITE)
