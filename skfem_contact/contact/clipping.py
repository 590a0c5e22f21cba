"""Clipping of the slave's facets by those of the master: cuts in the plane, points on the pieces in space.

On every piece gap and shape functions are smooth on both sides, so that the contact work is integrated as exactly
as the rule is: the patch test is passed.  In space, facet by facet, the polygon of the master's corners is clipped by
that of the slave's in the mean plane of the slave's facet (I. E. Sutherland and G. W. Hodgman, 1974).
"""
from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from ..surfaces.shape import rule
from ..surfaces.surface import Surface
from ..surfaces.vectors import across, determinant, dot, solve, unit
from .neighbours import NeighbourList
from .search import NEWTON_STEPS, project

#: Pieces smaller than this share of the slave's facet are left out.
_SLIVER = 1e-9
#: Corners nearer to an edge than this share of its length lie on it: on edges along each other last bits would decide.
_ON_EDGE = 1e-9
#: Corners that lie deeper than a facet's size behind the plane, or as far before it, do not face it.
_FACING = 1.0
#: ... nor do facets whose normals are less opposed than this: the walls of a corner, which strains tilt a little.
_OPPOSED = 0.2
_LAST_STEP = 1e-9  # of Newton's method: the error is its square


def common_cuts(slave: Surface, slave_nodes: ndarray, master: Surface, master_nodes: ndarray, facing: NeighbourList
                ) -> ndarray:
    """Return chain coordinates of the ends of the slave's facets and, projected, of the master's."""
    m = len(master.facets)
    ends = master.at(np.arange(m), -np.ones((m, 1)), master_nodes, 0).x[0]
    if not master.closed:
        ends = np.concatenate((ends, master.at(np.array([m - 1]), np.ones((1, 1)), master_nodes, 0).x[0]))
    near = np.full(len(ends), slave.spacing)
    found = project(slave, slave_nodes, ends, near, among=facing.at(slave_nodes, ends))
    hit = found.found & ~found.vertex & (np.abs(found.xi[:, 0]) < 1.0) & (found.gap < near)
    inner = found.facet[hit] + 0.5 * (1.0 + found.xi[hit, 0])
    cuts = np.unique(np.concatenate((np.arange(len(slave.facets) + 1.0), inner)))
    tiny = np.diff(cuts) < _SLIVER
    drop = np.flatnonzero(tiny) + np.where(cuts[1:][tiny] % 1.0 == 0.0, 0, 1)  # keep the segments' own ends
    return np.delete(cuts, drop)


def piecewise(slave: Surface, slave_nodes: ndarray, master: Surface, master_nodes: ndarray) -> ndarray:
    """Return points on all pieces of the slave's facets at present coordinates, a row each, shape (n, 5).

    A row holds the slave's facet, two local coordinates, the weight in their measure, and the facet of the master that
    the piece faces, -1 on facets that face none.
    """
    own, facing = _pairs(slave, slave_nodes, master, master_nodes)
    centre, axes = _mean_planes(_corners(slave, slave_nodes))
    behind = _mean_planes(_corners(master, master_nodes))[1][:, 2]
    flat = _in_plane(_corners(slave, slave_nodes)[own], centre[own], axes[own])
    other = _in_plane(_corners(master, master_nodes)[facing][:, ::-1], centre[own], axes[own])
    reach = _FACING * slave.size[own]
    near = (np.abs(other[:, :, 2]).min(axis=1) < reach) & (dot(axes[own, 2], behind[facing]) < -_OPPOSED)
    own, facing, flat, other = own[near], facing[near], flat[near, :, :2], other[near, :, :2]
    polygon, corners = _clipped(other, flat)
    piece, triangles = _fans(polygon, corners)
    size = _area(triangles)
    large = size > _SLIVER * slave.area[own[piece]]
    piece, triangles, size = piece[large], triangles[large], size[large]

    order = int(slave.shape.exponents.max())
    xi, w = get_quadrature(RefTri, 2 * order if slave.shape.triangular else 4 + 2 * order)
    shapes = np.stack((1.0 - xi.sum(axis=0), *xi), axis=1)
    places, area = (shapes @ triangles).reshape(-1, 2), (2.0 * size[:, None] * w).ravel()
    piece = np.repeat(piece, len(w))
    facet, facing = own[piece], facing[piece]
    local, slope = _back(slave, slave_nodes, facet, centre[facet], axes[facet], places)
    return _with_the_others(slave, facet, local, area / slope, facing)


def _corners(surface: Surface, nodes: ndarray) -> ndarray:
    return np.asarray(nodes[surface.facets[:, : len(surface.shape.corners)]])


def _pairs(slave: Surface, slave_nodes: ndarray, master: Surface, master_nodes: ndarray) -> tuple[ndarray, ndarray]:
    """Return facets whose enclosing spheres are near each other, searched by classes of size."""
    (at, reach), (place, radius) = (_spheres(_corners(s, x)) for s, x in ((slave, slave_nodes), (master, master_nodes)))
    reach = reach + _FACING * slave.size
    level, own, facing = np.floor(np.log2(radius)).astype(int), [], []
    for one in np.unique(level):
        members = np.flatnonzero(level == one)
        found = cKDTree(place[members]).query_ball_point(at, reach + radius[members].max())
        count = np.array([len(row) for row in found])
        own.append(np.repeat(np.arange(len(at)), count))
        facing.append(members[np.concatenate(found).astype(int)] if count.sum() else np.zeros(0, int))
    return np.concatenate(own), np.concatenate(facing)


def _spheres(corners: ndarray) -> tuple[ndarray, ndarray]:
    centre = corners.mean(axis=1)
    return centre, np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)


def _mean_planes(corners: ndarray) -> tuple[ndarray, ndarray]:
    """Return centres of facets, and axes, shape (n, 3, 3), of which the last is their normal."""
    diagonals = np.stack((corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1]), axis=1)
    if corners.shape[1] == 3:
        diagonals = corners[:, 1:] - corners[:, :1]
    normal, first = unit(across(diagonals)), unit(corners[:, 1] - corners[:, 0])
    first = unit(first - dot(first, normal)[:, None] * normal)
    return corners.mean(axis=1), np.stack((first, np.cross(normal, first), normal), axis=1)


def _in_plane(places: ndarray, centre: ndarray, axes: ndarray) -> ndarray:
    return np.asarray((places - centre[:, None]) @ axes.transpose(0, 2, 1))


def _area(polygons: ndarray) -> ndarray:
    after = np.roll(polygons, -1, axis=1)
    return np.asarray(0.5 * (polygons[..., 0] * after[..., 1] - polygons[..., 1] * after[..., 0]).sum(axis=1))


def _clipped(polygons: ndarray, clips: ndarray) -> tuple[ndarray, ndarray]:
    """Clip convex anticlockwise polygons, (n, corners, 2); return these and numbers of corners."""
    count = np.full(len(polygons), polygons.shape[1])
    for k in range(clips.shape[1]):
        start, along = clips[:, k, None], (clips[:, (k + 1) % clips.shape[1]] - clips[:, k])[:, None]
        number = np.arange(polygons.shape[1])
        valid = number < count[:, None]
        after = np.where(number + 1 < count[:, None], number + 1, 0)
        side = along[..., 0] * (polygons - start)[..., 1] - along[..., 1] * (polygons - start)[..., 0]
        side[np.abs(side) <= _ON_EDGE * (along**2).sum(axis=2)] = 0.0
        following = np.take_along_axis(side, after, axis=1)
        crosses = valid & (side * following < 0.0)
        share = side / np.where(crosses, side - following, 1.0)
        crossing = polygons + share[..., None] * (np.take_along_axis(polygons, after[..., None], axis=1) - polygons)
        both = np.stack((polygons, crossing), axis=2).reshape(len(polygons), 2 * polygons.shape[1], 2)
        kept = np.stack((valid & (side >= 0.0), crosses), axis=2).reshape(both.shape[:2])
        count = kept.sum(axis=1)
        order = np.argsort(~kept, axis=1, kind="stable")[:, : max(count.max(initial=0), 1)]
        polygons = np.take_along_axis(both, order[..., None], axis=1)
    return polygons, count


def _fans(polygons: ndarray, count: ndarray) -> tuple[ndarray, ndarray]:
    """Return numbers of the polygons and their triangles, shape (n, 3, 2)."""
    number = np.arange(1, max(polygons.shape[1] - 1, 1))
    polygon, second = np.nonzero(number + 1 < count[:, None])
    second = number[second]
    corners = np.stack((np.zeros_like(second), second, second + 1), axis=1)
    return polygon, polygons[polygon[:, None], corners]


def _back(slave: Surface, nodes: ndarray, facet: ndarray, centre: ndarray, axes: ndarray, places: ndarray
          ) -> tuple[ndarray, ndarray]:
    """Return local coordinates of points in the planes of facets, and area in the plane per unit."""
    xi = np.tile(slave.shape.centre, (len(facet), 1))
    for _ in range(NEWTON_STEPS):
        x = slave.at(facet, xi, nodes).x
        offset = places - ((x[0] - centre)[:, None] @ axes.transpose(0, 2, 1))[:, 0, :2]
        jacobian = x[1] @ axes.transpose(0, 2, 1)[:, :, :2]
        step = solve(jacobian.transpose(0, 2, 1), offset)
        xi = xi + step
        if np.abs(step).max(initial=0.0) < _LAST_STEP:
            break
    return xi, np.abs(determinant(jacobian))


def _with_the_others(slave: Surface, facet: ndarray, xi: ndarray, weight: ndarray, facing: ndarray
                     ) -> ndarray:
    """Return the points by facet, with Gauss points on the facets that face nothing."""
    alone = np.setdiff1d(np.arange(len(slave.facets)), facet)
    inner, w = rule(slave.shape, int(slave.shape.exponents.max()) + 1)
    facets = np.concatenate((facet, np.repeat(alone, len(w))))
    rows = np.column_stack((facets, np.concatenate((xi, np.tile(inner, (len(alone), 1)))),
                            np.concatenate((weight, np.tile(w, len(alone)))),
                            np.concatenate((facing, np.full(len(alone) * len(w), -1)))))
    return rows[np.argsort(facets, kind="stable")]


def changed(old: ndarray, new: ndarray) -> float:
    """Return the largest distance of a cut from the nearest one among the others; in space, of an area."""
    if old.ndim == 2:
        return _area_changed(old, new)

    def farthest(a: ndarray, b: ndarray) -> float:
        right = np.clip(np.searchsorted(b, a), 1, len(b) - 1)
        return float(np.minimum(np.abs(a - b[right - 1]), np.abs(a - b[right])).max())

    return max(farthest(old, new), farthest(new, old))


def _area_changed(old: ndarray, new: ndarray) -> float:
    pairs, number = np.unique(np.concatenate((old, new))[:, [0, 4]], axis=0, return_inverse=True)
    before, after = (np.bincount(rows, cuts[:, 3], minlength=len(pairs)) for rows, cuts in (
        (number.ravel()[:len(old)], old), (number.ravel()[len(old):], new)))
    return float(np.abs(after - before).max() / before.max())
