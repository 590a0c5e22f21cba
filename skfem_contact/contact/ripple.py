"""Remarks on pressures that ripple, or have peaks, where facets of two surfaces do not match.

The pressure of a facet is compared with a quadratic polynomial through the pressures of all facets
within a few of the coarser mesh.  The same for the gaps of the mesh, times the stiffness of
surfaces and penalty in series, shows whether facets may be the cause. Multipliers of a slave that
deforms less than they demand have peaks between open points: with E2 / E1 from 1 to 200,000 and 1
to 4 nodes on a facet of the master, pressures of Hertz contact err by 0 to 23 % where the
difference is below .3, and by 42 to 560 % where it is above.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

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
_MOST = 400
_LEAST = 6.0
#: Difference of pressures of multipliers, over their mean, that is remarked on as peaks, and the
#: least extent of the contact, likewise; the edge of a body, with its own peak, is left out.
_PEAK = 0.3
_FEW = 3.0


def on_ripple(pair: ContactBase, state: ContactState, meshed: ndarray) -> Iterator[Remark]:
    """Yield a remark on ripples that facets cause, with gaps of the mesh, shape (n,)."""
    points = pair.points(state)
    pressure = consistent(pair, state, -state.traction[0])
    total = float(points.weight @ np.abs(pressure))
    if points.nodes.shape[1] == 1 or total == 0.0:
        return
    if points.weight @ pressure < 0.0:  # a bond in tension ripples as one in compression
        pressure = -pressure
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
    values = np.stack((pressure, in_series * gap), axis=1)
    found, cause = _compared(pair, state, values, size).ripples
    if min(found, cause) > _RIPPLE:
        yield Remark(
            "ripple",
            found,
            f"the pressure of '{pair.slave.name}' ripples by about {found:.0%} of its mean, since "
            f"its facets and those of '{pair.facets.name}' do not match, and gape and overlap in "
            "the mesh: take matching nodes, smaller facets or curved ones",
        )


def on_peaks(pair: ContactBase, state: ContactState) -> Iterator[Remark]:
    """Yield a remark on peaks of the pressure, beside which points are open or nearly so.

    The slave is stiffer or finer than the master, and has more multipliers than motions. Beams and
    rigid masters are left out, which do not deform beside a peak, and surfaces that touch
    themselves.
    """
    if pair.folds or pair.facets.rigid or not pair.facets.meshed:
        return
    points = pair.points(state)
    pressure = consistent(pair, state, np.maximum(-state.traction[0], 0.0))
    size = max(pair.slave.spacing, pair.facets.spacing)
    loaded = points.positions(pair.slave.nodes)[pressure > 0.0]
    few = len(loaded) == 0 or np.ptp(loaded, axis=0).max() < _FEW * size
    if few or points.nodes.shape[1] == 1 or _is_smooth(pair, state, pressure):
        return

    # Compare the pressures with their means, away from the edges of both bodies
    compared = _compared(pair, state, pressure[:, None], size)
    away = compared.away_from(_edges(pair, size), _AROUND * size)
    if not away.inside.any() or not away.ripples[0] > _PEAK:
        return
    ratio = away.largest_ratio
    if not ratio > 1.0 + _PEAK:
        return
    yield Remark(
        "peaks",
        ratio,
        f"the pressure of '{pair.slave.name}' has peaks of {ratio:.1f} times its mean around them, "
        f"since it is stiffer or finer than '{pair.facets.name}', whose displacements cannot "
        f"follow: make '{pair.facets.name}' the slave, or refine it",
    )


def _is_smooth(pair: ContactBase, state: ContactState, pressure: ndarray) -> bool:
    """Return True if pressures of facets hardly differ from their mean: none can have peaks."""
    points = pair.points(state)
    n = len(pair.slave.facets)
    area = np.bincount(points.facet, points.weight, n)
    force = np.bincount(points.facet, points.weight * pressure, n)
    loaded = force > 0.0
    total = float(area[loaded].sum())
    mean = force.sum() / max(total, np.finfo(float).tiny)
    return bool(pressure.max(initial=0.0) <= (1.0 + _PEAK) * mean)


def _edges(pair: ContactBase, size: float) -> ndarray:
    """Return the nodes at edges of one body that press into the other, (n, dim).

    Where both surfaces end, as on a plane of symmetry, nothing does.
    """
    rims = []
    for surface in (pair.slave, pair.facets):
        nodes = surface.facets[surface.at_rim.any(axis=1)]
        rims.append(surface.nodes[np.unique(nodes)])
    edges = []
    for own, other in (rims, rims[::-1]):
        if len(other):
            own = own[scipy.spatial.cKDTree(other).query(own)[0] > 2.0 * size]
        edges.append(own)
    return np.concatenate(edges)


@dataclass(frozen=True)
class _Compared:
    """Values at points beside polynomials through the values around.

    Attributes
    ----------
    x, weight, values, rest
        Coordinates of the points, areas, values, and what the polynomials leave of them, (n, ...).
    inside
        Mask of the points that count.
    """

    x: ndarray
    weight: ndarray
    values: ndarray
    rest: ndarray
    inside: ndarray

    @property
    def ripples(self) -> ndarray:
        """Root mean squares of the differences over the mean of the first values."""
        weight = self.weight[self.inside]
        area = max(float(weight.sum()), np.finfo(float).tiny)
        mean = float(weight @ self.values[self.inside, 0]) / area
        squares = weight @ self.rest[self.inside] ** 2 / area
        if not mean > 0.0:  # only open points
            return np.zeros(len(squares))
        return np.asarray(np.sqrt(squares) / mean)

    @property
    def largest_ratio(self) -> float:
        """The largest first value over the polynomial there."""
        values = np.where(self.inside, self.values[:, 0], -np.inf)
        at = int(np.argmax(values))
        smooth = values[at] - self.rest[at, 0]
        return float(values[at] / max(smooth, np.finfo(float).tiny))

    def away_from(self, nodes: ndarray, distance: float) -> _Compared:
        """Return the points that are so far from some nodes."""
        if len(nodes) == 0:
            return self
        nearest, _ = scipy.spatial.cKDTree(nodes).query(self.x)
        return replace(self, inside=self.inside & (nearest > distance))


def _compared(pair: ContactBase, state: ContactState, values: ndarray, size: float) -> _Compared:
    """Return pressures and other values, (n, k), beside polynomials around each facet."""
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
    middles = centres.x[0]
    tree = scipy.spatial.cKDTree(coordinates)
    around = tree.query_ball_point(middles[chosen], reach)
    rest = np.full(values.shape, np.nan)
    level = np.full(m, -np.inf)
    for facet, near in zip(chosen, around, strict=True):
        at = np.array(near, int)
        offset = coordinates[at] - middles[facet]
        local = offset @ tangents[facet].T / reach
        terms = _quadratic(local)
        root = np.sqrt(points.weight[at])[:, None]
        factors = np.linalg.lstsq(root * terms, root * values[at], rcond=1e-10)[0]
        own = points.facet[at] == facet
        rest[at[own]] = values[at[own]] - terms[own] @ factors
        level[facet] = float(factors[0, 0])

    # Leave out facets beyond the edge of the contact
    loaded_facets = level > _INSIDE * level.max(initial=0.0)
    inside = loaded_facets[points.facet] & np.isfinite(rest[:, 0])
    return _Compared(coordinates, points.weight, values, rest, inside)


def _quadratic(local: ndarray) -> ndarray:
    """Return the monomials to the second degree at local coordinates, (n, dim - 1)."""
    columns = [np.ones(len(local)), *local.T]
    for i, first in enumerate(local.T):
        for second in local.T[i:]:
            columns.append(first * second)
    return np.stack(columns, axis=1)
