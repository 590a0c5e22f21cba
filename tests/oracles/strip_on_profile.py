"""Smooth strip footing on clay whose strength rises with depth, by slip lines.

With the angle t of the major stress from the surface and the mean stress p, along the lines at t -
45 and t + 45 degrees dp - 2 c dt + rho dx = 0 and dp + 2 c dt - rho dx = 0.
E. H. Davis, J. R. Booker, Geotechnique 23 (1973) 551-563.
"""

from __future__ import annotations

import numpy as np

_Node = tuple[float, float, float, float]  # x, depth, mean stress, angle


def _crossing(one: _Node, other: _Node, c0: float, rho: float) -> _Node:
    """Return the node where the first line through one node meets the second line through
    another.
    """
    (x, z, p, t), (X, Z, P, T) = one, other
    xn, zn, tn, pn = x, z, 0.5 * (t + T), p
    for _ in range(60):
        a, b = 0.5 * (t + tn) - np.pi / 4, 0.5 * (T + tn) + np.pi / 4
        length = np.linalg.solve(
            [[np.cos(a), -np.cos(b)], [np.sin(a), -np.sin(b)]], [X - x, Z - z]
        )[0]
        before, (xn, zn) = (xn, zn), (x + length * np.cos(a), z + length * np.sin(a))
        c, C = c0 + 0.5 * rho * (z + zn), c0 + 0.5 * rho * (Z + zn)
        left, right = p - 2 * c * t - rho * (xn - x), P + 2 * C * T + rho * (xn - X)
        tn = (right - left) / (2 * (c + C))
        pn = left + 2 * c * tn
        if abs(xn - before[0]) + abs(zn - before[1]) < 1e-13:
            break
    return xn, zn, pn, tn


def _contact(length: float, c0: float, rho: float, n: int) -> np.ndarray:
    """Return distances from the edge and pressures under the footing, for a passive zone of a
    length, (n + 1, 2).
    """
    angles = np.linspace(0, np.pi / 2, n + 1)
    before = [(0.0, 0.0, c0 * (1 + 2 * t), t) for t in angles]
    found = [(0.0, c0 * (2 + np.pi))]
    for x in length * np.arange(1, n + 1) / n:
        line = [(x, 0.0, c0, 0.0)]
        for other in before:
            line.append(_crossing(line[-1], other, c0, rho))
        x, z, p, t = line[-1]
        end = x - z / np.tan(0.5 * (t + np.pi / 2) - np.pi / 4)
        p = p + 2 * (c0 + 0.5 * rho * z) * (np.pi / 2 - t) - rho * (end - x)
        line.append((end, 0.0, p, np.pi / 2))
        found.append((-end, p + c0))
        before = line
    return np.array(found)


def mean_pressure(c0: float, rho: float, width: float, n: int = 16) -> float:
    """Return the bearing capacity of the strip for the strength c0 + rho z."""
    half, last, length = 0.5 * width, 0.5 * width, 0.4 * width
    miss = [_contact(x, c0, rho, n)[-1, 0] - half for x in (last, length)]
    while abs(miss[1]) > 1e-10 * half:
        last, length = length, length - miss[1] * (length - last) / (miss[1] - miss[0])
        miss = [miss[1], _contact(length, c0, rho, n)[-1, 0] - half]
    x, q = _contact(length, c0, rho, n).T
    return float(np.sum(0.5 * (q[1:] + q[:-1]) * np.diff(x)) / half)
