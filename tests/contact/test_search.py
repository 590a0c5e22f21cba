"""Surfaces and closest points: orientation, all kinds of corners, ends of chains, far and deep
points.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementQuad2,
    ElementTetP1,
    ElementTriP1,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshQuad2,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.neighbours import NeighbourList
from skfem_contact.contact.quadrature import between, common_cuts, gauss, nodal
from skfem_contact.contact.search import project
from skfem_contact.surfaces.material_points import along_chain
from skfem_contact.surfaces.smoothing import smoothed
from skfem_contact.surfaces.surface import EXTENSION
from tests.tools.helpers import ELEMENTS, arcs, body_along, rotation, vector_basis


def found(surface: sc.Surface, points, depth: float = np.inf):
    """Projection of points in the reference configuration."""
    points = np.atleast_2d(np.asarray(points, float))
    return project(surface, surface.nodes, points, np.full(len(points), depth))


def feet(surface: sc.Surface, where) -> np.ndarray:
    """Places of closest points."""
    return surface.at(where.facet, where.xi, surface.nodes).x[0]


def nearest_on_facets(surface: sc.Surface, points: np.ndarray) -> np.ndarray:
    """Distance to a chain of straight facets: the smallest one over all of them."""
    a, b = surface.nodes[surface.facets[:, 0]], surface.nodes[surface.facets[:, 1]]
    along = b - a
    share = ((points[:, None] - a) * along).sum(axis=2) / (along**2).sum(axis=1)
    foot = a + np.clip(share, 0, 1)[..., None] * along
    return np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1)


def inside(polygon: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Winding number of a polygon around points."""
    to = polygon[None] - points[:, None]
    angle = np.arctan2(to[..., 1], to[..., 0])
    turn = (np.diff(angle, axis=1, append=angle[:, :1]) + np.pi) % (2 * np.pi) - np.pi
    return np.abs(turn.sum(axis=1)) > np.pi


def star(n: int = 14) -> np.ndarray:
    """Corners of a star, clockwise: convex and concave in turn."""
    radius = np.where(np.arange(n) % 2, 1.0, 0.6)
    angle = -2 * np.pi / n * np.arange(n)
    return radius[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)


def test_random_points_around_a_star(rng):
    """[X] Case A6: distance and side of 2000 points, by a search over all facets and a winding
    number.
    """
    corners = star()
    surface = sc.rigid.polyline(corners, closed=True)
    points = rng.uniform(-1.6, 1.6, (2000, 2))
    where = found(surface, points)
    assert where.found.all()
    distance = nearest_on_facets(surface, points)
    # coordinates of order one: a few roundings
    np.testing.assert_allclose(np.abs(where.gap), distance, atol=1e-14)
    np.testing.assert_allclose(
        np.linalg.norm(points - feet(surface, where), axis=1), distance, atol=1e-14
    )
    assert np.array_equal(where.gap < 0, inside(corners, points))
    # orthogonal, except at vertices
    rho1 = surface.at(where.facet, where.xi, surface.nodes).x[1][:, 0]
    cosine = ((points - feet(surface, where)) * rho1).sum(axis=1)
    assert (
        np.abs(cosine[~where.vertex]).max() < 1e-14
        and (np.abs(where.xi[where.vertex, 0]) == 1).all()
    )
    assert 0.02 < where.vertex.mean() < 0.98


def test_order_of_the_points_does_not_matter(rng):
    """[X] Case S24: each point is found for itself."""
    surface = sc.rigid.polyline(star(), closed=True)
    points = rng.uniform(-1.6, 1.6, (300, 2))
    order = rng.permutation(300)
    for a, b in zip(found(surface, points), found(surface, points[order]), strict=True):
        assert np.array_equal(a[order], b)


def test_shadow_of_a_convex_corner():
    """[X] Case A6: no orthogonal foot on either side; the corner is closest and the gap its
    distance.
    """
    roof = sc.rigid.polyline([(-1.0, 0.0), (0.0, 1.0), (1.0, 0.0)])
    points = np.array([[0.0, 1.5], [0.2, 1.4], [-0.3, 1.6]])
    where = found(roof, points)
    assert where.vertex.all()
    np.testing.assert_allclose(where.gap, np.linalg.norm(points - [0, 1], axis=1), rtol=1e-15)
    np.testing.assert_allclose(feet(roof, where), [[0.0, 1.0]] * 3, atol=1e-15)
    # inside, both sides have a foot: the closer one counts, once
    where = found(roof, [[0.1, 0.7], [-0.1, 0.7], [0.0, 0.7]])
    assert not where.vertex.any() and (where.gap < 0).all()
    assert where.facet[:2].tolist() == [1, 0]
    np.testing.assert_allclose(where.gap, -np.sqrt(0.5) * np.array([0.2, 0.2, 0.3]), rtol=1e-14)


def test_overlap_at_a_concave_corner():
    """[X] Case A6: two feet outside, the closer one counts; within the body the corner itself is
    closest.
    """
    groove = sc.rigid.polyline([(-1.0, 1.0), (0.0, 0.0), (1.0, 1.0)])
    where = found(groove, [[0.1, 0.5], [-0.1, 0.5], [0.0, 0.5]])
    assert not where.vertex.any() and (where.gap > 0).all()
    assert where.facet[:2].tolist() == [1, 0]
    where = found(groove, [[0.0, -0.2], [0.1, -0.3], [-0.05, -0.06]])
    assert where.vertex.all()
    np.testing.assert_allclose(where.gap, [-0.2, -np.sqrt(0.1), -np.sqrt(0.0061)], rtol=1e-14)


@pytest.mark.parametrize("offset", [0.0, 1e-16, -1e-16, 1e-12, -1e-12])
@pytest.mark.parametrize(
    "line", [[(-1, 0), (0, 0), (1, 0)], [(-1, 0), (0, 0.5), (1, 0)], [(-1, 0.5), (0, 0), (1, 0.5)]]
)
def test_node_at_a_master_vertex(line, offset):
    """[X] Case S12: a node within round-off of a flat, convex or concave vertex: finite forces."""
    wedge = np.array([[0.4, 1.0], [0.0, 0.0], [-0.4, 1.0]]) + np.array([0.0, line[1][1]])
    basis = vector_basis(body_along(wedge, "P1", 0.3), "P1")
    pair = sc.ContactPair(
        basis, "face", sc.rigid.polyline(line), sc.Coulomb(0.3), quadrature="nodal", penalty=1e4
    )
    node = np.flatnonzero(np.abs(basis.doflocs - [[0.0], [line[1][1]]]).max(axis=0) < 1e-12)
    for direction in (np.array([1.0, 0.0]), np.array([0.0, 1.0])):
        x = basis.zeros()
        x[node] = offset * direction
        with np.errstate(all="raise"):
            out = pair.assemble(x, pair.initial_state())
            K = out.stiffness
        assert np.isfinite(out.force).all() and np.isfinite(K.data).all()
        assert np.abs(out.force).max() < 1e-7  # 1e4 * 1e-12
        assert np.count_nonzero(out.state.status != Status.OPEN) <= 1


@pytest.mark.parametrize("graded", [1.0, 1.6, 3.0])
def test_candidates_of_a_graded_chain(graded, rng):
    """[X] Segments of very different length: no closest segment is missed."""
    steps = graded ** np.arange(12)
    s = np.concatenate(([0.0], np.cumsum(steps))) / steps.sum()
    line = np.stack((s, 0.1 * np.sin(9 * s)), axis=1)
    surface = sc.rigid.polyline(line[::-1] if graded == 1.6 else line)
    points = np.concatenate(
        (rng.uniform([0, -0.3], [1, 0.3], (1000, 2)), line + 1e-3 * rng.standard_normal(line.shape))
    )
    where = found(surface, points)
    assert where.found.mean() > 0.8
    # what is not found is closest to an end of the chain
    lost = points[~where.found, None] - surface.nodes[surface.facets[[0, -1], [0, 1]]]
    np.testing.assert_allclose(
        np.linalg.norm(lost, axis=2).min(axis=1),
        nearest_on_facets(surface, points)[~where.found],
        atol=1e-14,
    )
    within = np.abs(where.xi[:, 0]) <= 1
    assert (within | ~where.found).mean() > 0.98
    expected = nearest_on_facets(surface, points)[within & where.found]
    np.testing.assert_allclose(np.abs(where.gap[within & where.found]), expected, atol=1e-14)


@pytest.mark.parametrize("stretch", [0.05, 20.0])
def test_candidates_of_a_stretched_chain(stretch, rng):
    """[X] The search uses current lengths: a master that was stretched or squeezed unevenly."""
    t = np.linspace(0, 1, 30)
    surface = sc.rigid.polyline(np.stack((t, 0 * t), axis=1))
    nodes = np.stack((t * np.where(t < 0.5, 1, stretch), 0.05 * np.sin(20 * t)), axis=1)
    nodes[t >= 0.5, 0] += nodes[t < 0.5, 0].max() - nodes[t >= 0.5, 0].min() + 0.03
    deformed = sc.rigid.polyline(nodes)
    points = rng.uniform(nodes.min(axis=0) - 0.1, nodes.max(axis=0) + 0.1, (800, 2))
    where = project(surface, nodes, points, np.full(800, np.inf))
    ok = where.found & (np.abs(where.xi[:, 0]) <= 1)
    assert ok.mean() > 0.7
    np.testing.assert_allclose(
        np.abs(where.gap[ok]), nearest_on_facets(deformed, points)[ok], atol=1e-13
    )


def curve_distance(surface: sc.Surface, point: np.ndarray) -> float:
    """Distance to a curved chain by sampling every segment and polishing the best sample."""
    xi = np.linspace(-1, 1, 201)
    m = len(surface.facets)
    rho = surface.at(np.repeat(np.arange(m), 201), np.tile(xi, m)[:, None], surface.nodes).x[0]
    best = int(np.linalg.norm(rho - point, axis=1).argmin())
    segment, start = np.array([best // 201]), xi[best % 201]

    def distance(z):
        return float(
            np.linalg.norm(surface.at(segment, np.array([[z]]), surface.nodes).x[0][0] - point)
        )

    low, high = max(-1.0, start - 0.01), min(1.0, start + 0.01)
    return minimize_scalar(
        distance, bounds=(low, high), method="bounded", options={"xatol": 1e-12}
    ).fun


def quadratic_hole(n: int = 8) -> sc.Surface:
    """A round hole whose facets are parabolas."""
    angle = np.arange(n) * 2 * np.pi / n
    mesh = body_along(np.stack((np.cos(angle), np.sin(angle)), axis=1), "Q1", 0.5, closed=True)
    curved = MeshQuad2.from_mesh(mesh)
    x = curved.doflocs
    face = mesh.facets[:, mesh.boundaries["face"]]
    middle = 0.5 * (mesh.p[:, face[0]] + mesh.p[:, face[1]])
    for k in range(middle.shape[1]):
        at = np.abs(x - middle[:, [k]]).max(axis=0) < 1e-12
        x[:, at] = middle[:, [k]] / np.linalg.norm(middle[:, k])
    mesh = replace(curved, doflocs=x, _boundaries=mesh.boundaries)
    return sc.Surface.from_boundary(Basis(mesh, ElementVector(ElementQuad2())), "face")


def test_curved_segments(rng):
    """[X] Parabolas of a hole: distances by sampling and polishing; the radius to their order."""
    surface = quadratic_hole()
    assert surface.closed and len(surface.facets) == 8
    angle, radius = rng.uniform(0, 2 * np.pi, 60), rng.uniform(0.7, 1.3, 60)
    points = radius[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    where = found(surface, points)
    expected = [curve_distance(surface, p) for p in points]
    np.testing.assert_allclose(np.abs(where.gap), expected, atol=1e-9)  # what polishing leaves
    # the parabola through three points of a circle misses it by (pi/8)^4/ 8-odd: 1e-3
    np.testing.assert_allclose(where.gap, 1 - radius, atol=1.5e-3)


def test_rigid_circle(rng):
    """[X] Case A6: gap |x - O| - R of a smoothed polygon of 360 corners, whose radius ripples by
    1e-9.
    """
    centre, radius = np.array([2.0, -1.0]), 3.0
    for hole, sign in ((False, 1), (True, -1)):
        surface = sc.rigid.circle(tuple(centre), radius, hole)
        angle, r = rng.uniform(0, 2 * np.pi, 500), rng.uniform(2.5, 3.5, 500)
        points = centre + r[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=1)
        where = found(surface, points)
        np.testing.assert_allclose(where.gap, sign * (r - radius), atol=3e-9)
        assert not where.vertex.any()


@pytest.mark.parametrize(
    "window", [(1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 1.0, 0.0), (0.0, 1.0, 0.5, np.nan)]
)
def test_window_of_a_level_set_that_is_none(window):
    """Turned round it would put the body on the other side."""
    with pytest.raises(ValueError, match=r"xmin < xmax and ymin < ymax|each a finite number"):
        sc.rigid.level_set(lambda x, y: y - 0.5, window)


@pytest.mark.parametrize("n", [8, 16, 32])
def test_ripple_of_polygons_and_smoothed_polygons(n):
    """[X] Case A8: a polygon's radius ripples by e = R (1 - cos(pi/n)), the smoothed one's by e^2 /
    2 R.
    """
    angle = -np.arange(n) * 2 * np.pi / n
    facets = sc.rigid.polyline(np.stack((np.cos(angle), np.sin(angle)), axis=1), closed=True)
    curve = smoothed(facets)
    dense = np.linspace(-1, 1, 201)
    for surface, ripple in (
        (facets, 1 - np.cos(np.pi / n)),
        (curve, (1 - np.cos(np.pi / n)) ** 2 / 2),
    ):
        m = len(surface.facets)
        rho = surface.at(np.repeat(np.arange(m), 201), np.tile(dense, m)[:, None], surface.nodes).x[
            0
        ]
        r = np.linalg.norm(rho, axis=1)
        assert r.max() - r.min() == pytest.approx(ripple, rel=1e-6)
    # C1: the tangents at the joints are equal, and at right angles to the radius
    m = np.arange(len(curve.facets))
    end, start = (curve.at(m, np.full((len(m), 1), e), curve.nodes, 2).x for e in (1.0, -1.0))
    turn = np.roll(start[1][:, 0], -1, axis=0)
    np.testing.assert_allclose(
        end[1][:, 0, 0] * turn[:, 1] - end[1][:, 0, 1] * turn[:, 0], 0, atol=1e-14
    )
    np.testing.assert_allclose((end[0] * end[1][:, 0]).sum(axis=1), 0, atol=1e-14)


@pytest.mark.parametrize("alpha", [0.1, 0.5])
def test_smoothing_keeps_a_straight_chain(alpha):
    """[X] Case A8: collinear nodes of uneven spacing stay a line, with arc positions as before."""
    s = np.array([0.0, 0.3, 1.0, 1.1, 2.0])
    line = sc.rigid.polyline(np.stack((s, 0.5 * s), axis=1))
    curve = smoothed(line, alpha)
    assert curve.area.sum() == pytest.approx(line.area.sum(), rel=1e-14)
    t = np.linspace(0.01, 1.9, 50)
    points = np.stack((t, 0.5 * t + 0.2), axis=1)
    a, b = found(line, points), found(curve, points)
    np.testing.assert_allclose(a.gap, b.gap, atol=1e-14)
    np.testing.assert_allclose(
        along_chain(line, a.facet, a.xi), along_chain(curve, b.facet, b.xi), atol=1e-13
    )


def test_far_points_face_the_surface_without_touching_it():
    """[X] They know their gap and the place that they face; off the ends there is neither."""
    surface = sc.rigid.polyline([(-1.0, 0.0), (1.0, 0.0)])
    where = found(
        surface, [[0.0, 0.4], [0.5, 60.0], [0.0, -0.6], [1.6, 0.0], [50.0, 3.0]], depth=0.5
    )
    assert where.found.tolist() == [True, True, False, False, False]
    assert where.gap.tolist() == [0.4, 60.0, -0.6, np.inf, np.inf]
    basis = vector_basis(body_along(np.array([[1.5, 9.0], [-0.5, 9.0]]), "Q1"), "Q1")
    pair = sc.ContactPair(basis, "face", surface, sc.Coulomb(0.3), quadrature="nodal", penalty=1e3)
    out = pair.assemble(basis.zeros(), pair.initial_state())
    np.testing.assert_allclose(arcs(pair, out.state.stick), [np.nan, 0.5], atol=1e-15)
    assert not out.force.any() and out.stiffness.nnz == 0
    assert (out.state.status == Status.OPEN).all()


def test_depth_limits_the_penetration():
    """[X] A point deeper than its own limit is not found, not even at another place of the
    chain.
    """
    groove = sc.rigid.polyline([(-1.0, 1.0), (0.0, 0.0), (1.0, 1.0)])
    points = np.array([[0.0, -0.2], [0.0, -0.4], [0.5, 0.2], [0.5, -0.2]])
    where = project(groove, groove.nodes, points, np.full(4, 0.3))
    assert where.found.tolist() == [True, False, True, False]
    assert project(groove, groove.nodes, points, np.full(4, 0.6)).found.all()


def test_long_segment_beside_short_ones():
    """[X] The closest segment was stretched so far that points of another arm are closer than its
    ends.
    """
    s = np.linspace(0, 1, 33)
    surface = sc.rigid.polyline(np.stack((s, 0 * s), axis=1))
    nodes = np.stack((s, 0 * s), axis=1)
    nodes[-3:] = [[1.3, 0.0], [1.3, 0.4], [-0.2, 0.4]]  # there and back in one segment
    where = project(surface, nodes, np.array([[0.5, 0.3], [0.2, 0.25]]), np.full(2, np.inf))
    assert where.facet.tolist() == [31, 31]
    np.testing.assert_allclose(where.gap, [0.1, 0.15], atol=1e-15)


def test_deep_points_belong_to_the_other_side():
    """[X] A node below a thin plate is not in contact with the plate's top."""
    plate = body_along(np.array([[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]]), "Q1", 0.1)
    roof = body_along(np.array([[0.3, 0.2], [-0.3, 0.2]]), "Q1", 0.1)
    basis = vector_basis(sc.join_bodies({"slave": roof, "master": plate}), "Q1")
    pair = sc.ContactPair(
        basis, "slave:face", "master:face", sc.Coulomb(), quadrature="nodal", penalty=1e3
    )
    x = basis.zeros()
    dofs = np.unique(basis.element_dofs[:, basis.mesh.subdomains["slave"]])
    for depth, closed in ((0.1, 0), (0.3, 2), (2.0, 0)):
        x[dofs[1::2]] = -depth
        out = pair.assemble(x, pair.initial_state())
        assert (out.state.status != Status.OPEN).sum() == closed


@pytest.mark.parametrize("last", [1.0, 0.3, 0.05])
@pytest.mark.parametrize("side", [1, -1])
def test_no_contact_beyond_an_open_end(last, side):
    """[X] Case D6: the chain goes on for 5 % of its last segment; beyond, nothing, whatever its
    length.
    """
    line = np.array([[-3.0, 0.0], [-2.0, 0.0], [-1.0, 0.0], [-last, 0.0], [0.0, 0.0]])
    if last == 1.0:
        line = np.delete(line, 3, axis=0)
    surface = sc.rigid.polyline(line if side == 1 else (line * [-1, 1])[::-1])
    beyond = np.linspace(-0.1, 2.0, 400)
    for height in (-0.001, -0.05, -0.3, -0.9):
        points = np.stack((side * beyond, np.full(400, height)), axis=1)
        where = found(surface, points, depth=1.0)
        allowed = beyond <= EXTENSION * last * (1 + 1e-9)
        assert not (where.gap[~allowed] < 0).any()
        np.testing.assert_allclose(where.gap[allowed], height, atol=1e-15)


def test_mirrored_points_have_mirrored_feet(rng):
    """[X] Case S17: the search has no preferred side."""
    surface = sc.rigid.polyline(star(), closed=True)
    mirrored = sc.rigid.polyline((star() * [-1, 1])[::-1], closed=True)
    points = rng.uniform(-1.5, 1.5, (500, 2))
    a, b = found(surface, points), found(mirrored, points * [-1, 1])
    np.testing.assert_allclose(a.gap, b.gap, atol=1e-14)
    np.testing.assert_allclose(feet(surface, a), feet(mirrored, b) * [-1, 1], atol=1e-14)
    assert np.array_equal(a.vertex, b.vertex)


@pytest.mark.parametrize("clockwise", [True, False])
@pytest.mark.parametrize("element", ELEMENTS)
def test_chain_runs_with_the_body_on_its_right(element, clockwise, rng):
    """[X] Whatever the order of nodes, facets and elements: normals point outward."""
    line = (
        np.stack((np.linspace(0, 2, 7), 0.2 * np.sin(np.linspace(0, 3, 7))), axis=1)
        @ rotation(100).T
    )
    mesh = body_along(line, element, 0.4)
    numbers = rng.permutation(mesh.nvertices)
    place = np.argsort(numbers)
    t = place[mesh.t][:, rng.permutation(mesh.nelements)]
    t = t[::-1] if clockwise else t
    face = {tuple(sorted(place[f])) for f in mesh.facets[:, mesh.boundaries["face"]].T}
    mesh = type(mesh)(mesh.p[:, numbers], t)
    facets = [k for k, f in enumerate(mesh.facets.T) if tuple(sorted(f)) in face]
    mesh = mesh.with_boundaries({"face": rng.permutation(facets)})
    surface = sc.Surface.from_boundary(vector_basis(mesh, element), "face")
    assert not surface.closed and len(surface.facets) == 6
    ends = surface.nodes[surface.facets[:, :2]]
    np.testing.assert_allclose(ends[:, 0], line[:-1], atol=1e-15)
    np.testing.assert_allclose(ends[:, 1], line[1:], atol=1e-15)
    np.testing.assert_allclose(
        surface.area, np.linalg.norm(np.diff(line, axis=0), axis=1), rtol=1e-14
    )
    starts = along_chain(surface, np.arange(6), np.full((6, 1), -1.0))
    np.testing.assert_allclose(
        starts, np.concatenate(([0], np.cumsum(surface.area)[:-1])), atol=1e-14
    )
    x = rng.standard_normal(2 * len(surface.dofs) + 2 * mesh.nelements + surface.dofs.max() + 2)
    np.testing.assert_array_equal(surface.positions(x), surface.nodes + x[surface.dofs])


@pytest.mark.parametrize("element", ELEMENTS)
def test_weights_of_the_points(element):
    """[X] Every rule integrates one; Gauss rules integrate polynomials along a straight chain."""
    s = np.array([0.0, 0.5, 0.8, 1.7, 2.0])
    mesh = body_along(np.stack((s, 0 * s), axis=1), element, 0.3)
    surface = sc.Surface.from_boundary(vector_basis(mesh, element), "face")
    degree = surface.facets.shape[1] - 1
    for n in (0, 1, 2, 3, 5):
        points = gauss(surface, surface, n) if n else nodal(surface)
        assert points.weight.sum() == pytest.approx(2.0, rel=1e-14)
        place, along = (
            points.positions(surface.nodes),
            along_chain(surface, points.facet, points.xi),
        )
        np.testing.assert_allclose(place[:, 0], along, atol=1e-14)
        assert (np.diff(along) > 0).all()
        # the nodal rule is the trapezoidal one, or Simpson's
        order = 2 * n - 1 if n else (1 if degree == 1 else 3)
        if n:  # a quadratic master of the same size has a node in the middle of each slave segment
            assert len(points.weight) == n * len(surface.facets) * degree
        for k in range(order + 1):
            assert (points.weight * along**k).sum() == pytest.approx(
                2 ** (k + 1) / (k + 1), rel=1e-13
            )
    cuts = np.array([0, 0.25, 1, 1.5, 1.9, 2, 3, 4])
    points = between(surface, cuts, 2)
    along = along_chain(surface, points.facet, points.xi)
    assert len(points.weight) == 14
    assert (points.weight * along**3).sum() == pytest.approx(4.0, rel=1e-13)


@pytest.mark.parametrize(("n", "pieces"), [(1, 1), (2, 1), (3, 2), (4, 2), (5, 3)])
def test_gauss_points_are_as_dense_as_the_masters_nodes(n, pieces):
    """[X] Two slave segments before n of a master: pieces no longer than the master's. A rigid one
    does not matter.
    """
    lines = [np.stack((np.linspace(0, 2, k + 1), np.zeros(k + 1)), axis=1) for k in (2, n)]
    bases = [vector_basis(body_along(line, "Q1", 0.3), "Q1") for line in lines]
    slave, master = (sc.Surface.from_boundary(basis, "face") for basis in bases)
    assert len(gauss(slave, master, 3).weight) == 2 * 3 * pieces
    assert len(gauss(slave, sc.rigid.polyline(lines[1]), 3).weight) == 2 * 3


def test_cuts_by_both_meshes():
    """[X] The rule "segments" cuts the slave where a node of the master faces it, and beside the
    ends of the joint.
    """
    line = np.stack((np.array([0.0, 0.7, 1.4, 2.6, 3.0]), np.zeros(5)), axis=1)
    roof = np.stack((np.array([2.5, 1.5, 0.5]), np.zeros(3)), axis=1)
    slave, master = sc.rigid.polyline(roof), sc.rigid.polyline(line)
    cuts = common_cuts(slave, slave.nodes, master, master.nodes, NeighbourList(slave))
    # the slave runs from 2.5 to 0.5: 1.4 is 1.1 along, 0.7 is 1.8 along
    np.testing.assert_allclose(cuts, [0, 0.1, 1, 1.1, 1.8, 1.9, 2], atol=1e-14)


def test_boundary_of_a_restricted_basis():
    """[X] A pair may be made on a basis of some elements only: the chain is that of the mesh."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 1, 3)).with_defaults()
    whole = vector_basis(mesh, "Q1")
    part = whole.with_elements(np.arange(4))
    a, b = (sc.Surface.from_boundary(basis, "top") for basis in (whole, part))
    assert np.array_equal(a.dofs, b.dofs) and np.array_equal(a.nodes, b.nodes)


@pytest.mark.parametrize("mesh", [MeshTri, MeshQuad, MeshTet, MeshHex])
def test_points_within_facets_lie_on_no_side(mesh):
    """[X] Centres and points half the way to corners; not middles of sides and corners, nor points
    that face nothing.
    """
    both = mesh().with_defaults()
    dim = both.dim()
    mesh = sc.join_bodies({"low": both, "up": both.translated(np.eye(dim)[-1])})
    element = {2: {3: ElementTriP1, 4: ElementQuad1}, 3: {4: ElementTetP1, 8: ElementHex1}}
    basis = Basis(mesh, ElementVector(element[dim][len(mesh.t)]()), intorder=2)
    names = ("up:bottom", "low:top")
    pair = sc.ContactPair(basis, *names, sc.Coulomb(), "nodal", penalty=1e4)
    shape = pair.interface.master.shape
    centre = shape.centre
    corners = shape.corners
    inside = [centre, *(0.5 * (centre + corner) for corner in corners)]
    on_sides = [*corners, *(corners[sides].mean(axis=0) for sides in shape.side_corners)]
    xi = np.array([*inside, *on_sides, centre])
    facet = np.zeros(len(xi), int)
    facet[-1] = -1
    state = replace(pair.initial_state(), facet=facet, position=xi.T)
    within = pair.interface.within_facets(state)
    assert within.tolist() == [True] * len(inside) + [False] * (len(on_sides) + 1)
