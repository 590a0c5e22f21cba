"""Stiffness that beams lose by their thrust: second-order effects, which the beams leave out."""

from __future__ import annotations

import numpy as np
from numpy import ndarray

from .element import GAUSS, BeamElements, shapes


def counts(points: ndarray, N: ndarray, EI: float, share: float) -> bool:
    """Return True if the largest thrust of N, tension positive, may be a share of a buckling load.

    The buckling load is at least that of a cantilever of the whole extent L of points (n, dim),
    pi^2 EI / (2 L)^2, in shells of a strip: N and EI are per width.
    """
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    least = np.pi**2 * EI / (2.0 * extent) ** 2
    return bool(-N.min() > share * least)


def lost_stiffness(elements: BeamElements, N: ndarray) -> ndarray:
    """Return the stiffness that normal forces take away, (m, dofs, dofs), tension positive.

    It is the integral of -N w' (1 - t t') w' of the displacements w, with N (m, 2) at start and
    end.
    """
    m, _, dim = elements.points.shape
    n_dofs = elements.strains.shape[2]
    lost = np.zeros((m, n_dofs, n_dofs))
    for g, xi in enumerate(GAUSS):
        slope = shapes(xi)[1] / elements.weights[:, [g]]
        t = np.einsum("mk,mkc->mc", slope, elements.points)
        force = 0.5 * ((1.0 - xi) * N[:, 0] + (1.0 + xi) * N[:, 1])
        # K = integral of P (dN_i / ds) (dN_j / ds) across the axis, compression positive.
        across = np.eye(dim) - t[:, :, None] * t[:, None]  # (m, dim, dim)
        blocks = np.einsum("mi,mj,mcd->micjd", slope, slope, across)
        size = -force * elements.weights[:, g]
        moves = slice(0, 3 * dim)
        blocks = blocks.reshape(m, 3 * dim, 3 * dim)
        lost[:, moves, moves] += size[:, None, None] * blocks
    return lost
