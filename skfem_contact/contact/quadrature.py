"""Quadrature on the slave surface: nodes, Gauss points, and points on clipped pieces.

On pieces, ``quadrature="segments"``, gap and shape functions are smooth on both sides, so that the
contact work is integrated as exactly as the rule is: the patch test is passed.  In space, facet by
facet, the polygon of the master's corners is clipped by the slave's polygon in the mean plane of
the slave's facet (I. E. Sutherland and G. W. Hodgman, 1974) and cut into triangles.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import scipy
from numpy import ndarray
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from ..arrays import cross_in_plane, max_abs, row_norms
from ..surfaces.shape import Shape, divided_rule, gauss_points, rule
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
#: Distance from a plane of symmetry, over the size of a facet, that is none.
ON_PLANE = 1e-3
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
        # Multiply areas |x_,1 x x_,2| by the weights of the rule, and by the radius about an axis.
        mapping = surface.at(facet, xi, surface.nodes)
        x, a = mapping.x[:2]
        area = row_norms(across(a))
        if surface.axisymmetric:
            area = area * x[:, 0]
        return cls(
            facet=facet,
            xi=xi,
            nodes=surface.facets[facet],
            values=mapping.shapes[0],
            weight=area * weight,
            size=surface.size[facet],
            along=_along(surface, facet, mapping),
            facing=np.full(len(facet), -1),
        )

    def take(self, chosen: ndarray) -> SlavePoints:
        """Return some of the points."""
        return SlavePoints(**{name: part[chosen] for name, part in vars(self).items()})

    def positions(self, nodes: ndarray) -> ndarray:
        """Return coordinates of the points, (n, dim), from coordinates of the slave's nodes."""
        return np.asarray(np.einsum("nk,nkc->nc", self.values, nodes.take(self.nodes, axis=0)))

    def direction(self, slave: Surface, nodes: ndarray) -> ndarray:
        """Return the slave's direction, which moves with its material, (n, dim); 0 in the plane."""
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
    """Return the paper's node-to-segment rule: nodes with their tributary lengths or areas.

    The weight turns the traction of a node into its force, so that a penalty does not depend on the
    mesh. On triangles of second order the nodes on the sides have all of the area.
    """
    # Integrate the shape functions for the tributary areas
    points = _repeated(surface, np.arange(len(surface.facets)), *rule(surface.shape, 3))
    values = points.values
    if len(surface.shape.nodes) == 6:
        values = _of_sides(surface.shape, points.xi)
    shares = points.weight[:, None] * values
    weight = np.bincount(points.nodes.ravel(), shares.ravel())
    weight[np.abs(weight) < _EQUAL * weight.max()] = 0.0
    if (weight < 0.0).any():
        raise ValueError(
            f"'{surface.name}': the corners of facets of eight nodes have negative areas: use "
            'Gauss points or quadrature="segments" instead of "nodal"'
        )

    # Locate each node on the first of its facets
    k = surface.facets.shape[1]
    size = np.zeros(len(weight))
    np.maximum.at(size, surface.facets.ravel(), np.repeat(surface.size, k))
    _, first = np.unique(surface.facets.ravel(), return_index=True)
    facet, local = np.divmod(first, k)
    xi = surface.shape.nodes[local]
    along = _along(surface, facet, surface.at(facet, xi, surface.nodes))

    # Take the nodes with an area, in the plane in the order of the chain
    order = np.arange(len(weight))
    if surface.dim == 2:
        order = np.argsort(facet + 0.5 * xi[:, 0])
    order = order[weight[order] > 0.0]
    return SlavePoints(
        facet=facet[order],
        xi=xi[order],
        nodes=order[:, None],
        values=np.ones((len(order), 1)),
        weight=weight[order],
        size=size[order],
        along=along[order],
        facing=np.full(len(order), -1),
    )


def _of_sides(shape: Shape, xi: ndarray) -> ndarray:
    """Return functions of Crouzeix and Raviart of triangles of six nodes, shape (n, 6).

    Those of the sides are linear, one at their node and zero at the two others. On flat triangles
    they have the integrals of the shape functions, a third for each side. On curved ones those of
    the corners are small and have either sign.
    """
    linear = np.column_stack([np.ones(len(xi)), xi])
    at_sides = np.column_stack([np.ones(3), shape.nodes[3:]])
    return np.column_stack([np.zeros((len(xi), 3)), linear @ np.linalg.inv(at_sides)])


def _repeated(surface: Surface, facets: ndarray, xi: ndarray, weight: ndarray) -> SlavePoints:
    """Return the points of one rule on each of some facets."""
    m = len(facets)
    facet = np.repeat(facets, len(weight))
    return SlavePoints.on(surface, facet, np.tile(xi, (m, 1)), np.tile(weight, m))


def gauss(slave: Surface, master: Surface, n: int) -> SlavePoints:
    """Return n Gauss points in each direction on every slave facet.

    Triangles have the rule of degree 2n - 2.  The master's shape functions have kinks at its nodes,
    which Gauss points smear. So where these nodes lie closer than the slave's facets are long, the
    facets are divided.
    """
    pieces = max(1, int(np.ceil(slave.spacing / _node_distance(master) - _EQUAL)))
    return _repeated(slave, np.arange(len(slave.facets)), *divided_rule(slave.shape, n, pieces))


def _node_distance(master: Surface) -> float:
    """Return the typical distance between nodes of the master; infinite for a rigid one."""
    if master.rigid:
        return np.inf
    if master.dim == 3:
        intervals = len(master.facets) * int(master.shape.exponents.max()) ** 2
    else:
        intervals = len(master.nodes) - (0 if master.closed else 1)
    return float(master.spacing * (len(master.facets) / intervals) ** (1 / (master.dim - 1)))


def between(surface: Surface, cuts: ndarray, n: int) -> SlavePoints:
    """Return ``n`` Gauss points on every piece of a surface in the plane between two cuts.

    The cuts ascend: facet number plus the share ``(1 + xi) / 2``; facets' ends, whole numbers, are
    among them.
    """
    t, w = gauss_points(n)
    half = 0.5 * np.diff(cuts)
    middle = cuts[:-1] + half
    coordinate = (middle[:, None] + half[:, None] * t).ravel()
    facet = np.repeat(np.floor(middle).astype(int), n)
    xi = 2.0 * (coordinate - facet)[:, None] - 1.0
    weight = (2.0 * half[:, None] * w).ravel()
    return SlavePoints.on(surface, facet, xi, weight)


def common_cuts(
    slave: Surface,
    slave_nodes: ndarray,
    master: Surface,
    master_nodes: ndarray,
    facing: NeighbourList,
    mirrored: tuple[bool, bool] = (False, False),
) -> ndarray:
    """Return the cuts of the slave in the plane, as chain coordinates.

    The cuts are the ends of the slave's facets, the projected ends of the master's facets, and a
    further cut next to each edge of the joint. A slave that is `mirrored` at its begin or its end
    has no edge at this end.
    """
    # Project the ends of the master's facets onto the slave
    m = len(master.facets)
    n = len(slave.facets)
    ends = master.at(np.arange(m), -np.ones((m, 1)), master_nodes, 0).x[0]
    if not master.closed:
        last = master.at(np.array([m - 1]), np.ones((1, 1)), master_nodes, 0).x[0]
        ends = np.concatenate((ends, last))
    near = np.full(len(ends), slave.spacing)
    found = project(slave, slave_nodes, ends, near, among=facing.at(slave_nodes, ends).pairs)
    opposite = found.found & (found.gap < near)
    hit = opposite & ~found.vertex & (np.abs(found.xi[:, 0]) < 1.0)
    projected = found.facet + 0.5 * (1.0 + found.xi[:, 0])

    # Cut once more inside of the joint's edges; the chains run in opposite directions
    first_and_last = [-1, 0]
    ends_here = opposite[first_and_last] & (not master.closed)
    edges = np.where(ends_here, projected[first_and_last], (0.0, n))
    further = edges + np.array([_EDGE, -_EDGE])
    is_edge = (ends_here | (not slave.closed)) & ~np.array(mirrored)
    further = further[(further > 0.0) & (further < n) & is_edge]
    cuts = np.unique(np.concatenate((np.arange(n + 1.0), projected[hit], further)))

    # Drop one end of each tiny piece, but not the ends of the slave's facets
    tiny = np.flatnonzero(np.diff(cuts) < _SLIVER)
    drop = tiny + np.where(cuts[tiny + 1] % 1.0 == 0.0, 0, 1)
    return np.delete(cuts, drop)


def piecewise(
    slave: Surface,
    slave_nodes: ndarray,
    master: Surface,
    master_nodes: ndarray,
    adjusted: float = 0.0,
    planes: Iterable[tuple[int, float]] = (),
) -> ndarray:
    """Return points on all pieces of the slave's facets at present coordinates, shape (n, 5).

    A row holds the slave's facet, two local coordinates, the weight in their measure, and the facet
    of the master that the piece faces, -1 on facets that are not near any. Gaps up to the share
    `adjusted` of a facet count as none. Planes of symmetry are given by their axis and coordinate.
    """
    # Draw the corners of each pair of facets in the mean plane of the slave's facet
    slave_corners = _corners(slave, slave_nodes)
    master_corners, facets = _with_images(_corners(master, master_nodes), planes)
    own, facing = _pairs(slave_corners, slave.size, master_corners)
    centre, axes = _mean_planes(slave_corners)
    _, master_axes = _mean_planes(master_corners)
    clip = _in_plane(slave_corners[own], centre[own], axes[own])
    polygon = _in_plane(master_corners[facing][:, ::-1], centre[own], axes[own])

    # Choose the pairs that face each other and are near
    close = np.abs(polygon[:, :, 2]).min(axis=1) < _FACING * slave.size[own]
    opposed = dot(axes[own, 2], master_axes[facing, 2]) < -_OPPOSED
    near = np.flatnonzero(close & _overlap(polygon, clip) & opposed)
    limit = (adjusted + _NEAR) * slave.size
    height = _heights(polygon[near], polygon[near, :, :2]).min(axis=1)
    near = near[height < limit[own[near]]]
    own = own[near]
    facing = facing[near]
    clip = clip[near]
    polygon = polygon[near]

    # Clip the master's facets by the slave's, and leave out slivers and pieces that are far
    pieces, corners = _clipped(polygon[:, :, :2], clip[:, :, :2])
    number = np.arange(max(pieces.shape[1], 4))
    number = np.minimum(number, corners[:, None] - 1).clip(0)  # the last corner is repeated
    pieces = np.take_along_axis(pieces, number[..., None], axis=1)
    height = _heights(polygon, pieces).min(axis=1)
    kept = (_area(pieces) > _SLIVER * slave.area[own]) & (height < limit[own])
    own = own[kept]
    facing = facing[kept]

    # Put points on every piece, and map them back to the slave's facets
    order = int(slave.shape.exponents.max())
    degree = 2 * order if slave.shape.triangular else 4 + 2 * order
    piece, points, area = _points_on(pieces[kept], corners[kept], degree)
    facet = own[piece]
    local, slope = _back(clip[kept][piece, :, :2], points)
    return _with_the_others(slave, facet, local, area / slope, facets[facing[piece]])


def _corners(surface: Surface, nodes: ndarray) -> ndarray:
    """Return coordinates of the facets' corners, shape (n_facets, corners, dim)."""
    return np.asarray(nodes[surface.facets[:, : len(surface.shape.corners)]])


def _with_images(corners: ndarray, planes: Iterable[tuple[int, float]]) -> tuple[ndarray, ndarray]:
    """Add the mirror images of facets at planes of symmetry; return corners and facets.

    The facets of a round body are inclined where they end at the plane, and face a part of the
    master's image.
    """
    facets = np.arange(len(corners))
    near = ON_PLANE * _spheres(corners)[1].mean()
    for axis, coordinate in planes:
        ends = (np.abs(corners[:, :, axis] - coordinate) < near).any(axis=1)
        image = corners[ends, ::-1].copy()
        image[:, :, axis] = 2.0 * coordinate - image[:, :, axis]
        corners = np.concatenate((corners, image))
        facets = np.concatenate((facets, facets[ends]))
    return corners, facets


def _pairs(
    slave_corners: ndarray, slave_size: ndarray, master_corners: ndarray
) -> tuple[ndarray, ndarray]:
    """Return pairs of facets of slave and master whose spheres touch, by sizes of the master's."""
    slave_centre, slave_radius = _spheres(slave_corners)
    centre, radius = _spheres(master_corners)
    reach = slave_radius + _FACING * slave_size
    levels = np.floor(np.log2(radius)).astype(int)
    own = []
    facing = []
    for level in np.unique(levels):
        members = np.flatnonzero(levels == level)
        tree = scipy.spatial.cKDTree(centre[members])
        found = tree.query_ball_point(slave_centre, reach + radius[members].max())
        count = [len(row) for row in found]
        own.append(np.repeat(np.arange(len(slave_centre)), count))
        facing.append(members[np.concatenate(found).astype(int)])
    return np.concatenate(own), np.concatenate(facing)


def _spheres(corners: ndarray) -> tuple[ndarray, ndarray]:
    """Return centres and radii of spheres that contain facets."""
    centre = corners.mean(axis=1)
    return centre, np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)


def _mean_planes(corners: ndarray) -> tuple[ndarray, ndarray]:
    """Return centres of facets, and axes, shape (n, 3, 3), of which the last is their normal."""
    if corners.shape[1] == 3:
        diagonals = corners[:, 1:] - corners[:, :1]
    else:
        first_diagonal = corners[:, 2] - corners[:, 0]
        second_diagonal = corners[:, -1] - corners[:, 1]
        diagonals = np.stack((first_diagonal, second_diagonal), axis=1)
    normal = unit(across(diagonals))
    side = unit(corners[:, 1] - corners[:, 0])
    first = unit(side - dot(side, normal)[:, None] * normal)
    return corners.mean(axis=1), np.stack((first, cross(normal, first), normal), axis=1)


def _in_plane(points: ndarray, centre: ndarray, axes: ndarray) -> ndarray:
    """Return points, shape (n, m, 3), in coordinates of planes; the last one is the height."""
    return np.asarray((points - centre[:, None]) @ axes.transpose(0, 2, 1))


def _heights(polygons: ndarray, points: ndarray) -> ndarray:
    """Return heights of the mean planes of polygons (n, corners, 3) at points (n, m, 2)."""
    centre, axes = _mean_planes(polygons)
    along = (points - centre[:, None, :2]) @ axes[:, 2, :2, None]
    return np.asarray(centre[:, None, 2] - along[:, :, 0] / axes[:, None, 2, 2])


def _overlap(polygons: ndarray, others: ndarray) -> ndarray:
    """Return a mask of pairs of polygons (n, corners, 3) whose boxes in the plane overlap."""
    first = polygons[:, :, :2]
    second = others[:, :, :2]
    begins_before = first.min(axis=1) < second.max(axis=1)
    ends_after = second.min(axis=1) < first.max(axis=1)
    return np.asarray((begins_before & ends_after).all(axis=1))


def _area(polygons: ndarray) -> ndarray:
    """Return areas of anticlockwise polygons, shape (n, corners, 2)."""
    after = np.roll(polygons, -1, axis=1)
    return np.asarray(0.5 * cross_in_plane(polygons, after).sum(axis=1))


def _clipped(polygons: ndarray, clips: ndarray) -> tuple[ndarray, ndarray]:
    """Clip convex anticlockwise polygons, (n, corners, 2); return these and numbers of corners."""
    count = np.full(len(polygons), polygons.shape[1])
    n_clips = clips.shape[1]
    for k in range(n_clips):
        n, corners, _ = polygons.shape
        start = clips[:, k, None]
        along = (clips[:, (k + 1) % n_clips] - clips[:, k])[:, None]

        # Find the side of the clipping edge on which each corner lies: positive inside
        number = np.arange(corners)
        valid = number < count[:, None]
        offset = polygons - start
        side = cross_in_plane(along, offset)
        side[np.abs(side) <= _ON_EDGE * (along**2).sum(axis=2)] = 0.0

        # Intersect the polygon's edges with the clipping edge
        after = np.where(number + 1 < count[:, None], number + 1, 0)
        side_after = np.take_along_axis(side, after, axis=1)
        corner_after = np.take_along_axis(polygons, after[..., None], axis=1)
        crosses = valid & (side * side_after < 0.0)
        share = side / np.where(crosses, side - side_after, 1.0)
        crossing = polygons + share[..., None] * (corner_after - polygons)

        # Keep corners inside and intersections, in their order
        both = np.stack((polygons, crossing), axis=2).reshape(n, 2 * corners, 2)
        kept = np.stack((valid & (side >= 0.0), crosses), axis=2).reshape(n, 2 * corners)
        count = kept.sum(axis=1)
        order = np.argsort(~kept, axis=1, kind="stable")[:, : max(count.max(initial=0), 1)]
        polygons = np.take_along_axis(both, order[..., None], axis=1)
    return polygons, count


def _points_on(
    polygons: ndarray, corners: ndarray, degree: int
) -> tuple[ndarray, ndarray, ndarray]:
    """Return points of rules on convex polygons with so many corners: polygon, point and area.

    Polynomials of the degree are integrated exactly. The points do not depend on the first corner,
    so that mirror images have mirrored points: quadrilaterals have a product rule, polygons of more
    corners are cut into triangles about their centres.
    """
    # Put a rule on triangles
    of_many, parts = _about_centres(polygons, corners)
    three = np.flatnonzero(corners == 3)
    triangles = np.concatenate((polygons[three, :3], parts))
    xi, w = get_quadrature(RefTri, degree)
    shapes = np.stack((1.0 - xi.sum(axis=0), *xi), axis=1)
    in_triangles = shapes @ triangles
    areas = 2.0 * _area(triangles)[:, None] * w

    # Put a rule on quadrilaterals, whose area |x_,1 x x_,2| has one degree more
    four = np.flatnonzero(corners == 4)
    bilinear = Shape.of_cells(3, 4)
    xi, w = rule(bilinear, degree // 2 + 1)
    values, slopes = bilinear.at(np.zeros(len(xi), int), xi, 1)
    in_four = values @ polygons[four, :4]
    tangents = np.einsum("qak,nkc->nqac", slopes, polygons[four, :4])
    areas_of_four = determinant(tangents.reshape(-1, 2, 2)) * np.tile(w, len(four))

    # Join both
    piece = np.concatenate(
        (
            np.repeat(np.concatenate((three, of_many)), areas.shape[1]),
            np.repeat(four, len(w)),
        )
    )
    points = np.concatenate((in_triangles.reshape(-1, 2), in_four.reshape(-1, 2)))
    return piece, points, np.concatenate((areas.ravel(), areas_of_four))


def _about_centres(polygons: ndarray, corners: ndarray) -> tuple[ndarray, ndarray]:
    """Cut polygons of more than four corners about their centres; return polygon and corners."""
    many = np.flatnonzero(corners > 4)
    x = polygons[many]
    after = np.roll(x, -1, axis=1)
    twice = cross_in_plane(x, after)
    moment = ((x + after) * twice[..., None]).sum(axis=1)
    centre = moment / (3.0 * twice.sum(axis=1))[:, None]
    polygon, side = np.nonzero((x != after).any(axis=2))
    triangles = np.stack((centre[polygon], x[polygon, side], after[polygon, side]), axis=1)
    return many[polygon], triangles


def _back(corners: ndarray, points: ndarray) -> tuple[ndarray, ndarray]:
    """Return xi of points in polygons (n, corners, 2), and area in the plane per unit of xi.

    Facets of second order have the points at the same xi, whose curved sides would leave strips
    beside the polygons without points.
    """
    shape = Shape.of_cells(3, corners.shape[1])
    facet = np.zeros(len(points), int)
    xi = np.tile(shape.centre, (len(points), 1))
    for _ in range(NEWTON_STEPS):
        values, slopes = shape.at(facet, xi, 1)
        position = np.einsum("nk,nkc->nc", values, corners)
        jacobian = slopes @ corners
        step = solve(jacobian.transpose(0, 2, 1), points - position)
        xi = xi + step
        if max_abs(step) < _LAST_STEP:
            break
    return xi, np.abs(determinant(jacobian))


def _with_the_others(
    slave: Surface, facet: ndarray, xi: ndarray, weight: ndarray, facing: ndarray
) -> ndarray:
    """Return rows of points on pieces, and of a rule on the facets without any, facet by facet."""
    alone = np.setdiff1d(np.arange(len(slave.facets)), facet)
    inner, w = rule(slave.shape, int(slave.shape.exponents.max()) + 1)
    m = len(alone)
    facet = np.concatenate((facet, np.repeat(alone, len(w))))
    xi = np.concatenate((xi, np.tile(inner, (m, 1))))
    weight = np.concatenate((weight, np.tile(w, m)))
    facing = np.concatenate((facing, np.full(m * len(w), -1)))
    rows = np.column_stack((facet, xi, weight, facing))
    return rows[np.argsort(facet, kind="stable")]


def changed(old: ndarray, new: ndarray) -> float:
    """Return the largest distance of a cut from the others; in space the change of an area."""
    if old.ndim == 2:
        return _area_changed(old, new)
    return max(_farthest(old, new), _farthest(new, old))


def _farthest(cuts: ndarray, others: ndarray) -> float:
    """Return the largest distance of ascending cuts from the nearest one among others."""
    right = np.clip(np.searchsorted(others, cuts), 1, len(others) - 1)
    to_left = np.abs(cuts - others[right - 1])
    to_right = np.abs(cuts - others[right])
    return float(np.minimum(to_left, to_right).max())


def _area_changed(old: ndarray, new: ndarray) -> float:
    """Return the largest change of the weight between two facets, as a share of the largest."""
    facet, facing = np.concatenate((old, new))[:, [0, 4]].astype(int).T
    pairs, number = np.unique(facet * (facing.max() + 2) + facing, return_inverse=True)
    n = len(old)
    before = np.bincount(number[:n], old[:, 3], minlength=len(pairs))
    after = np.bincount(number[n:], new[:, 3], minlength=len(pairs))
    return float(max_abs(after - before) / before.max())
