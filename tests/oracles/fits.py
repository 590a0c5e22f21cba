"""Round bodies in round holes without friction: press fit, disc in a ring, pin in a plate.  Plane
strain.
"""

from __future__ import annotations

import numpy as np

from tests.oracles.rings import michell


def press_fit(interference, a, b, c, inner, outer):
    """Lame: pressure between the ring ``a < r < b`` and the ring ``b < r < c``; materials are (E,
    nu).
    """
    (E1, nu1), (E2, nu2) = ((E / (1 - nu**2), nu / (1 - nu)) for E, nu in (inner, outer))
    within, around = (b**2 + a**2) / (b**2 - a**2), (c**2 + b**2) / (c**2 - b**2)
    return interference / (b * ((around + nu2) / E2 + (within - nu1) / E1))


def disc_in_ring(n, b, c, E, nu, pressure):
    """Amplitudes (contact pressure, u_r at b, u_r at c) under the pressure cos(n theta) on a ring
    ``b < r < c``.

    The disc within it is of the same material, the interface smooth and closed.  By Michell's
    potentials, n = 0 or 2.
    """
    elastic = E / (2 * (1 + nu)), 3 - 4 * nu
    at_b, at_c = michell(n, b, *elastic), michell(n, c, *elastic)
    disc = at_b[:, [1]] if n == 0 else at_b[:, :2]  # bounded at the centre
    nothing_in_disc, nothing_in_ring = np.zeros(disc.shape[1]), np.zeros(at_b.shape[1])
    rows = [(disc[0], -at_b[0]), (disc[3], -at_b[3]), (nothing_in_disc, at_c[0])]
    known = [0.0, 0.0, -pressure]
    if n:
        rows += [(disc[2], nothing_in_ring), (nothing_in_disc, at_b[2]), (nothing_in_disc, at_c[2])]
        known += [0.0, 0.0, 0.0]
    found = np.linalg.solve(np.array([np.concatenate(row) for row in rows]), np.array(known))
    ring = found[disc.shape[1] :]
    return -at_b[0] @ ring, at_b[3] @ ring, at_c[3] @ ring


def persson_load(degrees):
    """Persson: load Q over E* dR on a pin in a hole, both of one material, that touch within an
    angle to each side.
    """
    b = np.tan(np.radians(degrees) / 2) ** 2
    return 2 * np.pi * b * (b + 1) / (2 - np.log(b + 1) - 2 * b**2)
