"""Checks of consolidation: units, drains, fineness of the mesh at drains, and tight contact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import scipy
from numpy import ndarray
from skfem import CellBasis, Mesh

from ..arrays import max_abs
from ..errors import Remark
from ..layout import elements_of, facet_corners
from ..sparse import parts_of
from .surroundings import Ground

#: Ground so many times as permeable drains its neighbours: a column on a drained layer of the same
#: stiffness has up to 1.26 q with 100, 1.0 q with 10, once c_v t of the layer passes a tenth of its
#: height squared, and 1.003 q before.
_DRAINS = 100.0
_DRAINED = 0.1
#: Time over h² / c_v from which on elements at drains are fine enough: pressures in columns of 2, 4
#: and 8 elements are up to 1.40 q at a tenth of 1 / 6, 1.15 q at 1 / 6 (P. A. Vermeer and A.
#: Verruijt 1981), 1.04 q from 1 / 3 on.
_RESOLVED = 1.0 / 3.0
#: Before, under a load that grows evenly to q, they are up to 1.46 q (5 % of that time), 1.41 q (10
#: %), 1.30 q (25 %), 1.18 q (50 %) and 1.10 q (75 %): q and q / 2 times this power of the rest of
#: the time.
_POWER = 1.3
#: Share of the largest pressure up to which such an excess is not remarked on.
_EXCESS = 0.05
#: Ground so many times as permeable as its neighbour is a thin drained layer, if its depth is less
#: than this share of an element of the neighbour. Elements draw c h of water too much at once, and
#: c = a - b sqrt(t / T) until T = h² / 3 c_v: settlements of columns of 6 elements on layers of .1,
#: .25 and .5 h, 3 to 99 times as permeable, are 8 to 123 % too large, and 0.77 to 3.9 times as
#: much is estimated. What flows out of a half-space under a load that grows evenly is 4 / (3
#: sqrt(pi)) sqrt(c_v t).
_THIN = 0.75
_MORE = 3.0
_DRAWN = (0.2, 0.13)
_RAMP = 4.0 / (3.0 * np.sqrt(np.pi))
#: Share of the settlement up to which such an error is not remarked on.
_TOO_LARGE = 0.15
#: Pull on the ground under tight contact, as a share of the force of contact, that is remarked on.
_PULLED = 0.05
#: Degrees of consolidation, T = c_v t / H², that no stage of an analysis has in any sensible units.
_LEAST = 1e-10
_MOST = 1e8
#: From here on round-off of the pressures moves as much water as the ground holds.
_LOST = 1e12


def check_step(
    basis: CellBasis,
    grounds: Sequence[Ground],
    drained: ndarray,
    leaks: ndarray,
    duration: float,
    first: int,
) -> Iterator[Remark]:
    """Report ground without drains, and a duration too short for the elements at drains.

    The grounds are the elements of the basis, and further active ones. Drained nodes have given
    pressures, and water leaves by leaks. The pressures begin at the dof `first`.
    """
    # Water must be able to leave somewhere.
    own = grounds[0]
    ground = Ground(*map(np.hstack, zip(*grounds, strict=True)))
    if not np.isin(drained, ground.corners).any() and not len(leaks):
        yield Remark("sealed", 0.0, "no pore pressure is held: no water can leave the ground")
    # Thin layers drain their neighbours before these resolve it.
    open_nodes = np.union1d(drained, leaks)
    yield from _beside_thin(basis, ground, own, open_nodes, duration, first)
    # Elements beside drains resolve the change after h² / 3 c_v.
    element, size = _at_drains(basis, ground, own, open_nodes, duration)
    times = size**2 * _RESOLVED / own.diffusivity[element]
    shortest = float(times.max(initial=0.0))
    if duration >= shortest:
        return
    # Estimate the excess of the change in shorter stages, which counts where pressures differ.
    excess = 0.5 * np.clip(1.0 - duration / times, 0.0, None) ** _POWER

    def holds(x: ndarray) -> bool:
        p = x[first + own.corners]
        error = excess * np.ptp(p[:, element], axis=0)
        return float(error.max()) > _EXCESS * max_abs(p)

    yield Remark(
        "short",
        shortest / duration,
        f"it ends after {duration:.3g}, less than h² / 3 c_v = "
        f"{shortest:.3g} of the elements beside drains, where changes of pressure may be up to "
        f"{excess.max():.0%} too large at its end: refine them, or let it last longer",
        holds,
    )


def _at_drains(
    basis: CellBasis,
    ground: Ground,
    own: Ground,
    drained: ndarray,
    duration: float,
) -> tuple[ndarray, ndarray]:
    """Return own elements that drain through a facet, also to permeable ground, and their sizes."""
    mesh = basis.mesh
    n_nodes = mesh.nvertices
    sides = mesh.t2f[:, elements_of(basis)]  # (n_facets, n_elements)
    # Find the least permeable way through the nodes of each facet: drains are without resistance.
    best = _largest_at_nodes(ground, ground.mobility, n_nodes)
    best[drained] = np.inf
    through = best[mesh.facets].min(axis=0)[sides]
    result = [np.nonzero(np.isinf(through))]
    # Find permeable ground that is itself drained by now.
    permeable = np.isfinite(through) & (through >= _DRAINS * own.mobility)
    values = np.unique(own.mobility[permeable.any(axis=0)])
    if len(values):
        distance = _distances(mesh, drained)
    for value in values:
        drain = ground.mobility >= _DRAINS * value
        part = _parts(ground.corners[:, drain], n_nodes)
        spread = ground.diffusivity[drain].max(initial=0.0) * duration
        connected = np.isin(part, part[drained])
        open_ = connected & (_DRAINED * distance**2 <= spread)
        on_drain = open_[mesh.facets].all(axis=0)[sides]
        result.append(np.nonzero(on_drain & (own.mobility == value)))
    side, element = np.hstack(result)
    return element, _sizes(basis, sides[side, element], element)


def _largest_at_nodes(ground: Ground, values: ndarray, n_nodes: int) -> ndarray:
    """Return the largest value of elements, (n,), around each node, (n_nodes,)."""
    largest = np.zeros(n_nodes)
    np.maximum.at(largest, ground.corners.ravel(), np.tile(values, len(ground.corners)))
    return largest


def _distances(mesh: Mesh, drained: ndarray) -> ndarray:
    """Return the distances of the vertices from the nearest drained node, (n_nodes,)."""
    tree = scipy.spatial.cKDTree(mesh.p[:, drained].T)
    return np.asarray(tree.query(mesh.p[:, : mesh.nvertices].T)[0])


def _sizes(basis: CellBasis, facets: ndarray, elements: ndarray) -> ndarray:
    """Return the heights of elements over facets, (n,)."""
    mesh = basis.mesh
    # Divide the volume by the area: simplices have a third or half of the volume of a prism.
    simplex = len(mesh.t) == mesh.dim() + 1
    factor = 1
    if simplex:
        factor = mesh.dim()
    volume = basis.dx.sum(axis=1)[elements]
    return factor * volume / _areas(mesh, facets)


def _beside_thin(
    basis: CellBasis,
    ground: Ground,
    own: Ground,
    drained: ndarray,
    duration: float,
    first: int,
) -> Iterator[Remark]:
    """Report own elements thicker than a drained layer beside them, whose water counts too much."""
    mesh = basis.mesh
    n_nodes = mesh.nvertices
    if not len(drained):
        return
    # Find the most permeable ground at the nodes.
    mobility = _largest_at_nodes(ground, ground.mobility, n_nodes)
    # Take sides of elements that are less permeable, beside a drain but not at it.
    sides = mesh.t2f[:, elements_of(basis)]
    through = mobility[mesh.facets].min(axis=0)
    less = _MORE * own.mobility <= through[sides]
    side, element = np.nonzero(less & (through[sides] < _DRAINS * own.mobility))
    if not len(element):
        return
    facet = sides[side, element]
    depth = _distances(mesh, drained)[mesh.facets[:, facet]].max(axis=0)
    size = _sizes(basis, facet, element)
    diffusivity = _largest_at_nodes(ground, ground.diffusivity, n_nodes)
    spread = diffusivity[mesh.facets[:, facet]].min(axis=0)
    times = size**2 * _RESOLVED / own.diffusivity[element]
    passed = _DRAINED * depth**2 <= spread * duration
    chosen = (depth > 0) & (depth <= _THIN * size) & passed & (duration < times)
    # Estimate the water that elements draw too much, over that of layer and ground.
    start, decrease = _DRAWN
    share = start - decrease * np.sqrt(np.minimum(duration / times, 1.0))
    compressible = own.mobility[element] / own.diffusivity[element]
    flown = _RAMP * np.sqrt(own.diffusivity[element] * duration) * compressible
    flown += depth * through[facet] / spread
    excess = (1.0 - own.mobility[element] / through[facet]) * share * size * compressible / flown
    chosen &= excess > _TOO_LARGE
    if not chosen.any():
        return
    beside = own.corners[:, element[chosen]]

    def holds(x: ndarray) -> bool:
        p = x[first + own.corners]
        differs = np.ptp(x[first + beside], axis=0)
        return float(differs.max()) > _EXCESS * max_abs(p)

    longest = float(times[chosen].max())
    yield Remark(
        "thin",
        float(excess[chosen].max()),
        f"it ends after {duration:.3g}, less than h² / 3 c_v = {longest:.3g} of elements beside a "
        f"drained layer of {depth[chosen].min():.3g}, which is thinner than they are, where the "
        f"settlement since its start may be up to {excess[chosen].max():.0%} too large: refine "
        "them, or let it last longer",
        holds,
    )


def _parts(corners: ndarray, n_nodes: int) -> ndarray:
    """Return the number of the connected part of elements in which each node lies, (n_nodes,)."""
    first, others = np.broadcast_arrays(corners[:1], corners)
    return parts_of(n_nodes, first, others)


def _areas(mesh: Mesh, facets: ndarray) -> ndarray:
    """Return lengths or areas of facets, (n,)."""
    p = facet_corners(mesh, facets)  # (dim, n_corners, n)
    if mesh.dim() == 2:
        normal = p[:, 1] - p[:, 0]
    else:
        first_diagonal = p[:, 2] - p[:, 0]
        second_diagonal = p[:, -1] - p[:, 1]
        normal = 0.5 * np.cross(first_diagonal, second_diagonal, axis=0)
    return np.asarray(np.linalg.norm(normal, axis=0))


def pulled(
    name: str,
    pair: Any,
    state: Any,
    coordinates: ndarray,
    pressure: ndarray,
) -> Iterator[Remark]:
    """Report tight contact whose pressure is less than the excess pressure at nodes, (n,)."""
    # Compare the total pressure of contact with the water at the nearest node.
    points = pair.points(state)
    closed = state.status > 0
    positions = points.positions(pair.slave.nodes)[closed]
    near = scipy.spatial.cKDTree(coordinates.T).query(positions)[1]
    total = -state.traction[0, closed]
    weight = pair.share * points.weight[closed]
    pull = np.clip(pressure[near] - total, 0.0, None)
    if weight @ pull > _PULLED * np.abs(weight @ total):
        yield Remark(
            f"{name} pulled",
            float(weight @ pull),
            f"under '{name}' the water presses with up to {pressure[near].max():.4g}, and contact "
            f"transfers {total[pull.argmax()]:.4g} there in total: the ground is pulled, what lies "
            "on it would be lifted; drain the joint, or let the pressure act on the body above as "
            "well",
        )


def check_units(basis: CellBasis, diffusivity: ndarray, duration: float) -> Iterator[Remark]:
    """Report a degree of consolidation that no analysis has; refuse one lost in round-off."""
    nodes = np.unique(basis.mesh.t[:, elements_of(basis)])
    used = basis.mesh.p[:, nodes]
    length = float(np.ptp(used, axis=1).max())
    fastest = float(diffusivity.max()) * duration / length**2
    slowest = float(diffusivity.min()) * duration / length**2
    if fastest >= _LEAST and slowest <= _MOST:
        return
    worst = slowest
    if fastest < _LEAST:
        worst = fastest
    text = (
        f"the stage ends after {worst:.1e} times H² / c_v, with c_v from {diffusivity.min():.3g} "
        f"to {diffusivity.max():.3g}: are permeability, stiffness and duration in the same units?"
    )
    if worst > _LOST:
        raise ValueError(text)
    yield Remark("units", abs(np.log10(worst)), text)
