"""Tractions at points, projected onto the shape functions of their facets."""

from __future__ import annotations

import numpy as np
from numpy import ndarray

from .base import ContactBase
from .interface import ContactState

#: Eigenvalues of a facet's mass below this share of the largest one count as zero: the points are
#: too few.
_SINGULAR = 1e-10


def consistent(pair: ContactBase, state: ContactState, values: ndarray) -> ndarray:
    """Return values at points projected onto the slave's shape functions, facet by facet.

    Facets whose points have different status keep their values, which have kinks:

        t = N M^+ integral of N t,  M = integral of N N^T .
    """
    points = pair.points(state)
    facet = points.facet
    N = points.values
    k = N.shape[1]
    if k == 1:
        return values

    # Project on each facet.
    n = len(pair.slave.facets)
    mass = np.zeros((n, k, k))  # (facets, nodes, nodes)
    moments = np.zeros((n, k, *values.shape[1:]))  # (facets, nodes, ...)
    weighted = points.weight[:, None] * N
    np.add.at(mass, facet, weighted[:, :, None] * N[:, None])
    np.add.at(moments, facet, np.einsum("nk,n...->nk...", weighted, values))
    inverse = np.linalg.pinv(mass, rcond=_SINGULAR, hermitian=True)
    nodal = np.einsum("fij,fj...->fi...", inverse, moments)
    projected = np.einsum("nk,nk...->n...", N, nodal[facet])

    # Keep the values on facets with several kinds of status.
    lowest = np.full(n, np.iinfo(int).max)
    highest = np.full(n, -1)
    np.minimum.at(lowest, facet, state.status)
    np.maximum.at(highest, facet, state.status)
    smooth = (lowest == highest)[facet]
    if values.ndim == 2:
        smooth = smooth[:, None]
    return np.asarray(np.where(smooth, projected, values))
