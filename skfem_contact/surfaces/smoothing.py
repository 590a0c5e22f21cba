"""Hermite smoothing of a faceted master surface (eqs 23 and 24 of the paper, mended).

At the joint ``x3`` of the facets x2-x3 and x3-x4 a cubic runs from ``x_a`` to ``x_b``, both at the
share alpha of their facet's length from the joint.  Its end tangents are ``x3 - x_a`` and
``x_b - x3`` (eq. 23).  The curve is linear in the three nodes; collinear facets are reproduced
exactly, and all joints are C1.
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
            "only"
        )
    facets = surface.facets
    before, after = _soft_joints(surface, corner)

    # shorten the facets at rounded joints, and drop those without a straight part
    start = np.zeros(len(facets))
    end = np.ones(len(facets))
    start[after] = alpha
    end[before] = 1.0 - alpha
    straight = np.flatnonzero(end - start > 1e-12)

    # all new facets have three nodes: straight ones repeat their second
    lines = facets[straight][:, [0, 1, 1]]
    curves = np.column_stack((facets[before], facets[after, 1]))
    nodes = np.concatenate((lines, curves))
    rounded = np.broadcast_to(_rounded(alpha), (len(before), 3, 4))
    coefficients = np.concatenate((_straight(start[straight], end[straight]), rounded))

    # every curve follows the facet before its joint
    order = np.argsort(np.concatenate((straight, before + 0.5)), kind="stable")
    shape = surface.shape.of(coefficients[order], np.arange(4)[:, None])
    return surface.with_facets(nodes[order], shape, following(len(order), surface.closed))


def _soft_joints(surface: Surface, corner: float) -> tuple[ndarray, ndarray]:
    """Return the facets before and after the joints that turn by no more than an angle."""
    before = np.arange(len(surface.facets))
    after = (before + 1) % len(before)
    if not surface.closed:
        before = before[:-1]
        after = after[:-1]
    start, end = surface.nodes[surface.facets.T]
    x, y = (end - start).T
    direction = np.arctan2(y, x)
    # the change of direction, between -pi and pi
    change = direction[after] - direction[before]
    turn = np.abs((change + np.pi) % (2 * np.pi) - np.pi)
    soft = np.rad2deg(turn) <= corner + 1e-6  # all joints of an octagon alike
    return before[soft], after[soft]


def _straight(start: ndarray, end: ndarray) -> ndarray:
    """Return shape functions, (n, 3, 4), of straight parts of facets; the third is zero."""
    middle = 0.5 * (start + end)
    half = 0.5 * (end - start)
    coefficients = np.zeros((len(start), 3, 4))
    coefficients[:, 0, 0] = 1.0 - middle
    coefficients[:, 0, 1] = -half
    coefficients[:, 1, 0] = middle
    coefficients[:, 1, 1] = half
    return coefficients


def _rounded(alpha: float) -> ndarray:
    """Return shape functions, (3, 4), of the curve at a joint."""
    ends = np.array(
        [
            [alpha, 1 - alpha, 0],  # x_a
            [0, 1 - alpha, alpha],  # x_b
            [-alpha, alpha, 0],  # tangent at x_a, eq. 23
            [0, -alpha, alpha],  # tangent at x_b
        ]
    )
    return np.asarray(ends.T @ _HERMITE)
