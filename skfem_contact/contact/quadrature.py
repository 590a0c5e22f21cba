"""Quadrature on the slave surface: nodes, Gauss points, and points on the pieces that the master's
facets clip.

On pieces, ``quadrature="segments"``, gap and shape functions are smooth on both sides, so that the
contact work is integrated as exactly as the rule is: the patch test is passed.  In space, facet by
facet, the polygon of the master's corners is clipped by that of the slave's in the mean plane of
the slave's facet (I. E. Sutherland and G. W. Hodgman, 1974) and cut into triangles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from ..surfaces.shape import divided_rule, gauss_points, rule
from ..surfaces.surface import FacetMapping, Surface
from ..surfaces.vectors import across, cross, determinant, dot, products, solve, unit
from .neighbours import NeighbourList
from .search import NEWTON_STEPS, project

#: Meshes whose sizes differ by less than this share are as fine as each other.
_EQUAL = 1e-6
#: Pieces smaller than this share of the slave's facet are left out.
_SLIVER = 1e-9
#: Corners nearer to an edge than this share of its length lie on it: on edges along each other last
#: bits would decide.
_ON_EDGE = 1e-9
#: Corners that lie deeper than a facet's size behind the plane, or as far before it, do not face
#: it.
_FACING = 1.0
#: ... nor do facets whose normals are less opposed than this: the walls of a corner, which strains
#: tilt a little.
_OPPOSED = 0.2
#: Pieces that are farther away than this share of the facet's size are not cut out: there contact
#: is not near. A paraboloid on a block has 11,504 points if all that face it are cut, 4,348 so, in
#: as many iterations.
_NEAR = 0.2
#: Distance of a further cut from the edges of a joint, as a share of the facet. A joint that opens
#: turns about its outermost point, .113 of a piece inside the edge: an arch of 12 blocks with 4
#: facets in a joint collapses under a load 10.6 % below the exact one without these cuts, and 3.2,
#: 1.1 and .6 % with .3, .1 and .05. With .05 a block on an incline finds no equilibrium .02 degrees
#: before it slides.
_EDGE = 0.1
_LAST_STEP = 1e-9  # of Newton's method: the error is its square


@dataclass(frozen=True)
class SlavePoints:
    """Points of the slave surface for quadrature.

    Attributes
    ----------
    facet, xi : ndarray, shapes (n,) and (n, dim - 1)
        Facet and local coordinates of each point; in the plane in the order of the chain.
    nodes, values : ndarray, shape (n, k)
        Nodes of the slave surface that move each point, and their shape functions.
    weight : ndarray, shape (n,)
        Area of each point in the reference configuration: length in the plane, in axial symmetry
        length times radius.
    size : ndarray, shape (n,)
        Size of the slave's facet at the point.
    along : ndarray, shape (n, k)
        Factors of the facet's nodes in the direction from which tangents are counted, see
        :meth:`direction`.
    facing : ndarray, shape (n,)
        Facets of the master that pieces of facets in space face; -1 for none, and for other points.
    """

    facet: ndarray
    xi: ndarray
    nodes: ndarray
    values: ndarray
    weight: ndarray
    size: ndarray
    along: ndarray
    facing: ndarray

    @classmethod
    def on(cls, surface: Surface, facet: ndarray, xi: ndarray, weight: ndarray) -> SlavePoints:
        """Return points given by facet and local coordinates, with weights in their measure."""
        mapping = surface.at(facet, xi, surface.nodes)
        area = np.linalg.norm(across(mapping.x[1]), axis=1) * (
            mapping.x[0][:, 0] if surface.axisymmetric else 1.0
        )
        return cls(
            facet,
            xi,
            surface.facets[facet],
            mapping.shapes[0],
            area * weight,
            surface.size[facet],
            _along(surface, facet, mapping),
            np.full(len(facet), -1),
        )

    def take(self, chosen: ndarray) -> SlavePoints:
        """Return some of the points."""
        return SlavePoints(**{name: part[chosen] for name, part in vars(self).items()})

    def positions(self, nodes: ndarray) -> ndarray:
        """Return coordinates of the points, shape (n, dim), from those of the slave nodes."""
        return np.asarray(np.einsum("nk,nkc->nc", self.values, nodes.take(self.nodes, axis=0)))

    def direction(self, slave: Surface, nodes: ndarray) -> ndarray:
        """Return the slave's direction, which moves with its material, shape (n, dim); zero in the
        plane.
        """
        if slave.dim == 2:
            return np.zeros((len(self.facet), 2))
        return np.asarray(np.einsum("nk,nkc->nc", self.along, nodes[slave.facets[self.facet]]))

    def at(self, nodal: ndarray) -> ndarray:
        """Interpolate a field of the slave nodes, shape (n_nodes, ...), at the points."""
        return np.asarray(np.einsum("nk,nk...->n...", self.values, nodal[self.nodes]))


def _along(surface: Surface, facet: ndarray, mapping: FacetMapping) -> ndarray:
    """Return factors of the facets' nodes in the surface's directions, shape (n, k)."""
    if surface.dim == 2:
        return np.zeros(mapping.shapes[0].shape)
    a = mapping.x[1]
    contravariant = solve(products(a, a), np.einsum("nac,nc->na", a, surface.directions[facet]))
    return np.asarray(np.einsum("na,nak->nk", contravariant, mapping.shapes[1]))


def nodal(surface: Surface) -> SlavePoints:
    """Return the paper's node-to-segment rule: the nodes themselves with their tributary lengths or
    areas.

    The weight turns the traction of a node into its force, so that a penalty does not depend on the
    mesh. On triangles of second order the nodes on the sides have all of the area.
    """
    m, k = surface.facets.shape
    xi, w = rule(surface.shape, 3)
    facet = np.repeat(np.arange(m), len(w))
    everywhere = SlavePoints.on(surface, facet, np.tile(xi, (m, 1)), np.tile(w, m))
    weight = np.bincount(
        everywhere.nodes.ravel(), (everywhere.weight[:, None] * everywhere.values).ravel()
    )
    weight[np.abs(weight) < _EQUAL * weight.max()] = 0.0
    if (weight < 0.0).any():
        raise ValueError(
            f"'{surface.name}': the corners of facets of eight nodes have negative areas: use "
            f"Gauss "
            'points or quadrature="segments" instead of "nodal"'
        )
    size = np.zeros(len(weight))
    np.maximum.at(size, surface.facets.ravel(), np.repeat(surface.size, k))
    _, first = np.unique(surface.facets.ravel(), return_index=True)
    facet, local = np.divmod(first, k)
    xi = surface.shape.nodes[local]
    order = np.argsort(facet + 0.5 * xi[:, 0]) if surface.dim == 2 else np.arange(len(weight))
    order = order[weight[order] > 0.0]
    along = _along(surface, facet, surface.at(facet, xi, surface.nodes))
    return SlavePoints(
        facet[order],
        xi[order],
        order[:, None],
        np.ones((len(order), 1)),
        weight[order],
        size[order],
        along[order],
        np.full(len(order), -1),
    )


def gauss(slave: Surface, master: Surface, n: int) -> SlavePoints:
    """Return n Gauss points in each direction on every slave facet, on triangles the rule of degree
    2n - 2.

    The master's shape functions have kinks at its nodes, which Gauss points smear. So where these
    nodes lie closer than the slave's facets are long, the facets are divided.
    """
    pieces = max(1, int(np.ceil(slave.spacing / _node_distance(master) - _EQUAL)))
    xi, w = divided_rule(slave.shape, n, pieces)
    m = len(slave.facets)
    return SlavePoints.on(
        slave, np.repeat(np.arange(m), len(w)), np.tile(xi, (m, 1)), np.tile(w, m)
    )


def _node_distance(master: Surface) -> float:
    if master.rigid:
        return np.inf
    intervals = len(master.nodes) - (0 if master.closed else 1)
    if master.dim == 3:
        intervals = len(master.facets) * int(master.shape.exponents.max()) ** 2
    return float(master.spacing * (len(master.facets) / intervals) ** (1 / (master.dim - 1)))


def between(surface: Surface, cuts: ndarray, n: int) -> SlavePoints:
    """Return ``n`` Gauss points on every piece of a surface in the plane between two cuts.

    The cuts ascend: facet number plus the share ``(1 + xi) / 2``; facets' ends, whole numbers, are
    among them.
    """
    t, w = gauss_points(n)
    half = 0.5 * np.diff(cuts)
    coordinate = ((cuts[:-1] + half)[:, None] + half[:, None] * t).ravel()
    facet = np.repeat(np.floor(cuts[:-1] + half).astype(int), n)
    return SlavePoints.on(
        surface, facet, 2.0 * (coordinate - facet)[:, None] - 1.0, (2.0 * half[:, None] * w).ravel()
    )


def common_cuts(
    slave: Surface,
    slave_nodes: ndarray,
    master: Surface,
    master_nodes: ndarray,
    facing: NeighbourList,
) -> ndarray:
    """Return chain coordinates of the ends of the slave's facets and, projected, of the master's,
    and beside edges.
    """
    m, n = len(master.facets), len(slave.facets)
    ends = master.at(np.arange(m), -np.ones((m, 1)), master_nodes, 0).x[0]
    if not master.closed:
        ends = np.concatenate(
            (ends, master.at(np.array([m - 1]), np.ones((1, 1)), master_nodes, 0).x[0])
        )
    near = np.full(len(ends), slave.spacing)
    found = project(slave, slave_nodes, ends, near, among=facing.at(slave_nodes, ends))
    opposite = found.found & (found.gap < near)
    hit = opposite & ~found.vertex & (np.abs(found.xi[:, 0]) < 1.0)
    inner = found.facet + 0.5 * (1.0 + found.xi[:, 0])
    ends_here = opposite[[-1, 0]] & (not master.closed)  # the chains run in opposite directions
    beside = np.where(ends_here, inner[[-1, 0]], (0.0, n)) + np.array([_EDGE, -_EDGE])
    beside = beside[(beside > 0.0) & (beside < n) & (ends_here | (not slave.closed))]
    cuts = np.unique(np.concatenate((np.arange(n + 1.0), inner[hit], beside)))
    tiny = np.diff(cuts) < _SLIVER
    drop = np.flatnonzero(tiny) + np.where(
        cuts[1:][tiny] % 1.0 == 0.0, 0, 1
    )  # keep the segments' own ends
    return np.delete(cuts, drop)


def piecewise(
    slave: Surface,
    slave_nodes: ndarray,
    master: Surface,
    master_nodes: ndarray,
    adjusted: float = 0.0,
) -> ndarray:
    """Return points on all pieces of the slave's facets at present coordinates, a row each, shape
    (n, 5).

    A row holds the slave's facet, two local coordinates, the weight in their measure, and the facet
    of the master that the piece faces, -1 on facets that are not near any. Gaps up to the share
    `adjusted` of a facet count as none.
    """
    own, facing = _pairs(slave, slave_nodes, master, master_nodes)
    centre, axes = _mean_planes(_corners(slave, slave_nodes))
    behind = _mean_planes(_corners(master, master_nodes))[1][:, 2]
    flat = _in_plane(_corners(slave, slave_nodes)[own], centre[own], axes[own])
    other = _in_plane(_corners(master, master_nodes)[facing][:, ::-1], centre[own], axes[own])
    near = np.flatnonzero(
        (np.abs(other[:, :, 2]).min(axis=1) < _FACING * slave.size[own])
        & _overlap(other, flat)
        & (dot(axes[own, 2], behind[facing]) < -_OPPOSED)
    )
    limit = (adjusted + _NEAR) * slave.size
    near = near[_heights(other[near], other[near, :, :2]).min(axis=1) < limit[own[near]]]
    own, facing, flat, other = own[near], facing[near], flat[near], other[near]
    polygon, corners = _clipped(other[:, :, :2], flat[:, :, :2])
    piece, triangles = _fans(polygon, corners)
    size, height = _area(triangles), _heights(other[piece], triangles).min(axis=1)
    kept = (size > _SLIVER * slave.area[own[piece]]) & (height < limit[own[piece]])
    piece, triangles, size = piece[kept], triangles[kept], size[kept]
    order = int(slave.shape.exponents.max())
    xi, w = get_quadrature(RefTri, 2 * order if slave.shape.triangular else 4 + 2 * order)
    shapes = np.stack((1.0 - xi.sum(axis=0), *xi), axis=1)
    points, area = (shapes @ triangles).reshape(-1, 2), (2.0 * size[:, None] * w).ravel()
    piece = np.repeat(piece, len(w))
    facet, facing = own[piece], facing[piece]
    local, slope = _back(slave, slave_nodes, facet, centre[facet], axes[facet], points)
    return _with_the_others(slave, facet, local, area / slope, facing)


def _corners(surface: Surface, nodes: ndarray) -> ndarray:
    return np.asarray(nodes[surface.facets[:, : len(surface.shape.corners)]])


def _pairs(
    slave: Surface, slave_nodes: ndarray, master: Surface, master_nodes: ndarray
) -> tuple[ndarray, ndarray]:
    (at, reach), (centre, radius) = (
        _spheres(_corners(surface, nodes))
        for surface, nodes in ((slave, slave_nodes), (master, master_nodes))
    )
    reach = reach + _FACING * slave.size
    level, own, facing = np.floor(np.log2(radius)).astype(int), [], []
    for one in np.unique(level):
        members = np.flatnonzero(level == one)
        found = cKDTree(centre[members]).query_ball_point(at, reach + radius[members].max())
        count = np.array([len(row) for row in found])
        own.append(np.repeat(np.arange(len(at)), count))
        facing.append(
            members[np.concatenate(found).astype(int)] if count.sum() else np.zeros(0, int)
        )
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
    return corners.mean(axis=1), np.stack((first, cross(normal, first), normal), axis=1)


def _in_plane(points: ndarray, centre: ndarray, axes: ndarray) -> ndarray:
    return np.asarray((points - centre[:, None]) @ axes.transpose(0, 2, 1))


def _heights(polygons: ndarray, points: ndarray) -> ndarray:
    """Return heights of the mean planes of polygons, shape (n, corners, 3), at points, shape (n, m,
    2).
    """
    centre, axes = _mean_planes(polygons)
    along = (points - centre[:, None, :2]) @ axes[:, 2, :2, None]
    return np.asarray(centre[:, None, 2] - along[:, :, 0] / axes[:, None, 2, 2])


def _overlap(polygons: ndarray, others: ndarray) -> ndarray:
    """Return a mask of pairs of polygons, shape (n, corners, 3), whose boxes in the plane
    overlap.
    """
    here, there = polygons[:, :, :2], others[:, :, :2]
    return np.asarray(
        ((here.min(axis=1) < there.max(axis=1)) & (there.min(axis=1) < here.max(axis=1))).all(
            axis=1
        )
    )


def _area(polygons: ndarray) -> ndarray:
    after = np.roll(polygons, -1, axis=1)
    return np.asarray(
        0.5 * (polygons[..., 0] * after[..., 1] - polygons[..., 1] * after[..., 0]).sum(axis=1)
    )


def _clipped(polygons: ndarray, clips: ndarray) -> tuple[ndarray, ndarray]:
    """Clip convex anticlockwise polygons, (n, corners, 2); return these and numbers of corners."""
    count = np.full(len(polygons), polygons.shape[1])
    for k in range(clips.shape[1]):
        start, along = (
            clips[:, k, None],
            (clips[:, (k + 1) % clips.shape[1]] - clips[:, k])[:, None],
        )
        number = np.arange(polygons.shape[1])
        valid = number < count[:, None]
        after = np.where(number + 1 < count[:, None], number + 1, 0)
        side = (
            along[..., 0] * (polygons - start)[..., 1] - along[..., 1] * (polygons - start)[..., 0]
        )
        side[np.abs(side) <= _ON_EDGE * (along**2).sum(axis=2)] = 0.0
        following = np.take_along_axis(side, after, axis=1)
        crosses = valid & (side * following < 0.0)
        share = side / np.where(crosses, side - following, 1.0)
        crossing = polygons + share[..., None] * (
            np.take_along_axis(polygons, after[..., None], axis=1) - polygons
        )
        both = np.stack((polygons, crossing), axis=2).reshape(
            len(polygons), 2 * polygons.shape[1], 2
        )
        kept = np.stack((valid & (side >= 0.0), crosses), axis=2).reshape(both.shape[:2])
        count = kept.sum(axis=1)
        order = np.argsort(~kept, axis=1, kind="stable")[:, : max(count.max(initial=0), 1)]
        polygons = np.take_along_axis(both, order[..., None], axis=1)
    return polygons, count


def _fans(polygons: ndarray, count: ndarray) -> tuple[ndarray, ndarray]:
    number = np.arange(1, max(polygons.shape[1] - 1, 1))
    polygon, second = np.nonzero(number + 1 < count[:, None])
    second = number[second]
    corners = np.stack((np.zeros_like(second), second, second + 1), axis=1)
    return polygon, polygons[polygon[:, None], corners]


def _back(
    slave: Surface, nodes: ndarray, facet: ndarray, centre: ndarray, axes: ndarray, points: ndarray
) -> tuple[ndarray, ndarray]:
    """Return local coordinates of points in the planes of facets, and area in the plane per
    unit.
    """
    xi = np.tile(slave.shape.centre, (len(facet), 1))
    for _ in range(NEWTON_STEPS):
        x = slave.at(facet, xi, nodes).x
        offset = points - ((x[0] - centre)[:, None] @ axes.transpose(0, 2, 1))[:, 0, :2]
        jacobian = x[1] @ axes.transpose(0, 2, 1)[:, :, :2]
        step = solve(jacobian.transpose(0, 2, 1), offset)
        xi = xi + step
        if np.abs(step).max(initial=0.0) < _LAST_STEP:
            break
    return xi, np.abs(determinant(jacobian))


def _with_the_others(
    slave: Surface, facet: ndarray, xi: ndarray, weight: ndarray, facing: ndarray
) -> ndarray:
    alone = np.setdiff1d(np.arange(len(slave.facets)), facet)
    inner, w = rule(slave.shape, int(slave.shape.exponents.max()) + 1)
    facets = np.concatenate((facet, np.repeat(alone, len(w))))
    rows = np.column_stack(
        (
            facets,
            np.concatenate((xi, np.tile(inner, (len(alone), 1)))),
            np.concatenate((weight, np.tile(w, len(alone)))),
            np.concatenate((facing, np.full(len(alone) * len(w), -1))),
        )
    )
    return rows[np.argsort(facets, kind="stable")]


def changed(old: ndarray, new: ndarray) -> float:
    """Return the largest distance of a cut from the nearest one among the others; in space, of an
    area.
    """
    if old.ndim == 2:
        return _area_changed(old, new)

    def farthest(a: ndarray, b: ndarray) -> float:
        right = np.clip(np.searchsorted(b, a), 1, len(b) - 1)
        return float(np.minimum(np.abs(a - b[right - 1]), np.abs(a - b[right])).max())

    return max(farthest(old, new), farthest(new, old))


def _area_changed(old: ndarray, new: ndarray) -> float:
    pairs = np.concatenate((old, new))[:, [0, 4]].astype(int)
    pairs, number = np.unique(
        pairs[:, 0] * (pairs[:, 1].max() + 2) + pairs[:, 1], return_inverse=True
    )
    before, after = (
        np.bincount(rows, cuts[:, 3], minlength=len(pairs))
        for rows, cuts in ((number[: len(old)], old), (number[len(old) :], new))
    )
    return float(np.abs(after - before).max() / before.max())
