"""Remark on pressures that ripple where facets of two surfaces do not match.

The pressure of a facet is compared with a quadratic polynomial through the pressures of all facets
within a few of the coarser mesh.  The same for the gaps of the mesh, times the stiffness of
surfaces and penalty in series, shows whether facets may be the cause.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy
from numpy import ndarray

from ..errors import Remark
from ..surfaces.vectors import frame
from .base import ContactBase
from .consistent import consistent
from .interface import ContactState

#: Distance from a facet's centre, over the size of the coarser facets, of points that count.
_AROUND = 2.5
#: Ripple of the pressure over its mean that is remarked on, and the least part of it that facets
#: would cause between rigid surfaces.
_RIPPLE = 0.1
#: Pressure, as a share of the largest mean, below which a facet lies outside of the contact.
_INSIDE = 0.05
#: Facets that are looked at, at most; and the least extent of the contact, over the size of the
#: coarser facets: Hertz contacts of fewer seem to ripple.
_MOST, _LEAST = 400, 6.0


def on_ripple(pair: ContactBase, state: ContactState, meshed: ndarray) -> Iterator[Remark]:
    """Yield a remark on ripples that facets cause, with gaps of the mesh, shape (n,)."""
    points = pair.points(state)
    pressure = consistent(pair, state, -state.traction[0])
    total = float(points.weight @ np.abs(pressure))
    if points.nodes.shape[1] == 1 or total == 0.0:
        return
    size = max(pair.slave.spacing, pair.facets.spacing)
    touching = np.unique(points.facet[pressure != 0.0])
    if pair.slave.area[touching].sum() < _LEAST * size ** (pair.slave.dim - 1):
        return

    # Look at the gaps first: surfaces that match, or are flat, have none that ripple
    penalty = pair.penalties(state)[0]
    in_series = 1.0 / (1.0 / penalty + 1.0 / (pair.stiffness or penalty))
    loaded = (pressure != 0.0) & np.isfinite(meshed)
    mean = total / float(points.weight[loaded].sum() or np.inf)
    if not loaded.any() or in_series * np.ptp(meshed[loaded]) < _RIPPLE * mean:
        return
    gap = np.where(np.isfinite(meshed), meshed, meshed[loaded].max())
    found, cause = _ripples(pair, state, np.stack((pressure, in_series * gap), axis=1), size)
    if min(found, cause) > _RIPPLE:
        yield Remark(
            "ripple",
            found,
            f"the pressure of '{pair.slave.name}' ripples by about {found:.0%} of its mean, since "
            f"its facets and those of '{pair.facets.name}' do not match, and gape and overlap in "
            "the mesh: take matching nodes, smaller facets or curved ones",
        )


def _ripples(
    pair: ContactBase, state: ContactState, values: ndarray, size: float
) -> tuple[float, float]:
    """Return ripples of pressures and of other values, (n, 2), over the mean pressure."""
    points = pair.points(state)
    slave = pair.slave
    m = len(slave.facets)
    coordinates = points.positions(slave.nodes)
    reach = _AROUND * size
    centres = slave.centres
    tangents = frame(centres.normal, slave.directions)  # (m, dim - 1, dim)

    # Facet by facet, fit a polynomial around, and take what is left at its own points
    loaded = np.unique(points.facet[values[:, 0] != 0.0])
    chosen = loaded[:: len(loaded) // _MOST + 1]
    around = scipy.spatial.cKDTree(coordinates).query_ball_point(centres.x[0][chosen], reach)
    rest = np.full(values.shape, np.nan)
    level = np.full(m, -np.inf)
    for facet, near in zip(chosen, around, strict=True):
        at = np.array(near, int)
        local = (coordinates[at] - centres.x[0][facet]) @ tangents[facet].T / reach
        terms = _quadratic(local)
        root = np.sqrt(points.weight[at])[:, None]
        factors = np.linalg.lstsq(root * terms, root * values[at], rcond=1e-10)[0]
        own = points.facet[at] == facet
        rest[at[own]] = values[at[own]] - terms[own] @ factors
        level[facet] = float(factors[0, 0])

    # Leave out facets beyond the edge of the contact
    inside = (level > _INSIDE * level.max(initial=0.0))[points.facet] & np.isfinite(rest[:, 0])
    weight = points.weight[inside]
    mean = float(weight @ values[inside, 0]) / float(weight.sum())
    squares = weight @ rest[inside] ** 2 / weight.sum()
    pressure, other = np.sqrt(squares) / max(mean, np.finfo(float).tiny)
    return float(pressure), float(other)


def _quadratic(local: ndarray) -> ndarray:
    """Return the monomials to the second degree at local coordinates, (n, dim - 1)."""
    columns = [np.ones(len(local)), *local.T]
    for i, first in enumerate(local.T):
        for second in local.T[i:]:
            columns.append(first * second)
    return np.stack(columns, axis=1)
