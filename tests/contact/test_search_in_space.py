"""Surfaces in space: closest points on facets, edges and vertices, pieces of facets, rigid
obstacles, bad input.
"""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementTetP1,
    ElementTetP2,
    ElementVector,
    ElementWedge1,
    MeshHex,
    MeshTet,
    MeshTet2,
    MeshWedge1,
)
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

import skfem_contact as sc
from skfem_contact import rigid
from skfem_contact.contact.neighbours import NeighbourList, Pairs
from skfem_contact.contact.quadrature import _points_on, gauss, nodal, piecewise
from skfem_contact.contact.search import on_sides, project
from skfem_contact.surfaces.smoothing import smoothed
from skfem_contact.surfaces.surface import EXTENSION, Surface
from tests.tools import space
from tests.tools.helpers import IN_SPACE, vector_basis


def bumpy_ball() -> Surface:
    """A closed surface of triangles, convex and concave in turn."""
    mesh = MeshTet.init_ball(3)
    u = mesh.p / np.maximum(np.linalg.norm(mesh.p, axis=0), 1e-9)
    bumps = 1 + 0.12 * np.sin(5 * u[0] + 1) * np.cos(6 * u[1]) * np.sin(4 * u[2] + 2)
    mesh = MeshTet(mesh.p * bumps, mesh.t)
    mesh = mesh.with_boundaries({"skin": mesh.boundary_facets()})
    return Surface.from_boundary(Basis(mesh, ElementVector(ElementTetP1())), "skin")


def found(surface: Surface, points: np.ndarray, depth: float = np.inf):
    return project(surface, surface.nodes, points, np.full(len(points), depth))


def nearest_on_triangles(surface: Surface, points: np.ndarray) -> np.ndarray:
    """Distance to all triangles, to their edges where the foot is outside (C. Ericson, 2005)."""
    best = np.full(len(points), np.inf)
    for a, b, c in surface.nodes[surface.facets]:
        ab, ac = b - a, c - a
        normal = np.cross(ab, ac) / np.linalg.norm(np.cross(ab, ac))
        along = np.stack(((points - a) @ ab, (points - a) @ ac))
        share = np.linalg.solve([[ab @ ab, ab @ ac], [ab @ ac, ac @ ac]], along)
        inside = (share >= 0).all(axis=0) & (share.sum(axis=0) <= 1)
        distance = np.where(inside, np.abs((points - a) @ normal), np.inf)
        for u, v in ((a, b), (b, c), (c, a)):
            s = np.clip((points - u) @ (v - u) / ((v - u) @ (v - u)), 0, 1)
            distance = np.minimum(
                distance, np.linalg.norm(points - u - s[:, None] * (v - u), axis=1)
            )
        best = np.minimum(best, distance)
    return best


def inside(surface: Surface, points: np.ndarray) -> np.ndarray:
    """Solid angle of all triangles (A. Van Oosterom and J. Strackee, 1983)."""
    total = np.zeros(len(points))
    for corners in surface.nodes[surface.facets]:
        a, b, c = corners[:, None] - points
        la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        below = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        total += 2 * np.arctan2((a * np.cross(b, c)).sum(axis=1), below)
    return total > 2 * np.pi


def test_random_points_around_a_bumpy_ball(rng):
    """Distance and side of points, by a search over all facets and a solid angle; all kinds of
    features are met.
    """
    surface = bumpy_ball()
    assert surface.closed
    points = rng.uniform(-1.6, 1.6, (1000, 3))
    where = found(surface, points)
    assert where.found.all() and len(np.unique(where.feature)) == 5
    np.testing.assert_allclose(np.abs(where.gap), nearest_on_triangles(surface, points), atol=1e-14)
    assert np.array_equal(where.gap < 0, inside(surface, points))
    feet = surface.at(where.facet, where.xi, surface.nodes).x[0]
    np.testing.assert_allclose(np.linalg.norm(points - feet, axis=1), np.abs(where.gap), atol=1e-14)
    order = rng.permutation(len(points))
    for a, b in zip(where, found(surface, points[order]), strict=True):
        assert np.array_equal(a[order], b)


@pytest.mark.parametrize("element", IN_SPACE)
@pytest.mark.one_in(2)
def test_kept_neighbours_serve_as_new_ones(element, rng):
    """While points and surface move, projections among kept neighbours are those among all;
    clearances hold.
    """
    line = np.linspace(0, 1, 6) ** 1.5
    mesh = space.moved(
        space.block(element, line, line, [-0.3, 0.0]), lambda p: 0.02 * np.sin(9 * p[[1, 2, 0]])
    )
    surface = Surface.from_boundary(vector_basis(mesh, element), "top")
    nodes, points = surface.nodes, rng.uniform(-0.1, 1.1, (200, 3)) * [1, 1, 0.5]
    around, searches, last = NeighbourList(surface), 0, None
    for _ in range(8):
        nodes = nodes + 2e-3 * rng.standard_normal(nodes.shape)
        points = points + 2e-3 * rng.standard_normal(points.shape)
        near = around.at(nodes, points)
        searches, last = searches + (near.candidates is not last), near.candidates
        one = project(surface, nodes, points, np.full(200, np.inf), among=near.pairs)
        other = project(surface, nodes, points, np.full(200, np.inf))
        np.testing.assert_allclose(one.gap, other.gap, rtol=0, atol=1e-11)
        assert (near.clearance <= np.abs(other.gap)).all()
    assert searches < 8


@pytest.mark.parametrize("element", IN_SPACE)
@pytest.mark.one_in(2)
def test_points_of_pieces_stay_on_their_facets_without_a_search(element, rng):
    """[N] Their projections are those among all facets, also beyond their sides, while points and
    surface move.
    """
    line = np.linspace(0, 1, 6) ** 1.2
    mesh = space.moved(
        space.block(element, line, line, [-0.3, 0.0]), lambda p: 0.01 * np.sin(5 * p[[1, 2, 0]])
    )
    surface = Surface.from_boundary(vector_basis(mesh, element), "top")
    nodes, own = surface.nodes, rng.integers(0, len(surface.facets), 300)
    corners, centre = surface.shape.corners, surface.shape.centre
    xi = centre + 2.0 * (rng.dirichlet(np.ones(len(corners)), 300) @ corners - centre)
    mapping = surface.at(own, xi, nodes)
    points = (
        mapping.x[0] + mapping.normal * (surface.size[own] * rng.uniform(-0.2, 0.3, 300))[:, None]
    )
    own[:30] = -1
    around, searches, last, m = NeighbourList(surface), 0, None, len(surface.facets)
    everything = Pairs(np.repeat(np.arange(300), m), np.tile(np.arange(m), 300))
    for _ in range(12):
        nodes = nodes + 1e-3 * rng.standard_normal(nodes.shape)
        points = points + 1e-3 * rng.standard_normal(points.shape)
        near = around.at(nodes, points, own)
        searches, last = searches + (near.candidates is not last), near.candidates
        one, other = (
            project(surface, nodes, points, np.full(300, np.inf), own, own >= 0, among)
            for among in (near.pairs, everything)
        )
        np.testing.assert_array_equal(one.found, other.found)
        np.testing.assert_allclose(one.gap, other.gap, rtol=0, atol=1e-13)
        np.testing.assert_array_equal(one.facet[other.found], other.facet[other.found])
        assert (near.clearance <= np.abs(other.gap) + 1e-15).all()  # that of flat facets is the gap
    assert 1 < searches < 12
    assert np.mean(np.bincount(near.pairs.point)[30:] == 1) > 0.1  # the others are beyond
    assert (
        around.at(nodes, points, np.roll(own, 1)).candidates is not last
    )  # other pieces, other neighbours


def test_the_rim_reaches_a_little_farther():
    """A point beside the rim finds the surface within the extension, and nothing beyond it, at
    sides and corners.
    """
    mesh = space.block("Q1", [0, 1, 2], [0, 1, 2], [-1, 0])
    surface = Surface.from_boundary(vector_basis(mesh, "Q1"), "top")
    for s in (0.5, 1.0, 1.5):
        off = np.array([-0.9, -1.1]) * EXTENSION
        points = np.array(
            [
                (x, y, -0.02)
                for o in off
                for x, y in ((o, s), (s, o), (2 - o, s), (s, 2 - o), (o, o))
            ]
        )
        where = found(surface, points)
        assert where.found.tolist() == [True] * 5 + [False] * 5
        np.testing.assert_allclose(where.gap[:5], -0.02, atol=1e-15)


@pytest.mark.parametrize("element", IN_SPACE)
def test_weights_of_the_points(element, rng):
    """Every rule integrates the area; Gauss rules integrate polynomials on flat facets."""
    line = np.array([0.0, 0.5, 0.8, 2.0])
    surface = Surface.from_boundary(
        vector_basis(space.block(element, line, line, [-1, 0]), element), "top"
    )
    for n in (1, 2, 3):
        points = gauss(surface, surface, n)
        x, y, z = points.positions(surface.nodes).T
        assert np.abs(z).max() == 0.0
        for i in range(2 * n):
            for j in range(2 * n - i):
                exact = 2 ** (i + 1) / (i + 1) * 2 ** (j + 1) / (j + 1)
                assert (points.weight * x**i * y**j).sum() == pytest.approx(exact, rel=1e-13)
    if element == "S2":
        with pytest.raises(ValueError, match="negative areas"):
            nodal(surface)
    else:
        assert nodal(surface).weight.sum() == pytest.approx(4.0, rel=1e-14)


def test_areas_of_nodes_of_a_round_ball() -> None:
    """[A] Triangles with nodes on the ball: those on the sides have the whole area, and its
    first moments are zero.
    """
    mesh = MeshTet2.from_mesh(MeshTet.init_ball(2))
    radius = np.linalg.norm(mesh.doflocs, axis=0)
    mesh = mesh.with_boundaries({"skin": mesh.boundary_facets()})
    onto = np.unique(Basis(mesh, ElementTetP2()).get_dofs("skin").all())
    mesh.doflocs[:, onto] /= radius[onto]
    surface = Surface.from_boundary(Basis(mesh, ElementVector(ElementTetP2())), "skin")
    points = nodal(surface)
    corners = np.unique(surface.facets[:, :3])
    assert not np.isin(points.nodes, corners).any()
    area = gauss(surface, surface, 4).weight.sum()
    assert points.weight.sum() == pytest.approx(area, rel=1e-3)
    assert area == pytest.approx(4 * np.pi, rel=1e-3)
    assert points.weight.min() > 0.3 * points.weight.max()
    first = points.weight @ surface.nodes[points.nodes[:, 0]]
    assert np.abs(first).max() < 1e-12


def test_pieces_of_round_facets_leave_no_strips() -> None:
    """[X] A ball in a hole of its size: pieces have the whole area, where the sides of curved
    triangles bulge by 3 % of their length.
    """
    mesh = MeshTet2.from_mesh(MeshTet.init_ball(2))
    radius = np.linalg.norm(mesh.doflocs, axis=0)
    mesh = mesh.with_boundaries({"skin": mesh.boundary_facets()})
    onto = np.unique(Basis(mesh, ElementTetP2()).get_dofs("skin").all())
    mesh.doflocs[:, onto] /= radius[onto]
    slave = Surface.from_boundary(Basis(mesh, ElementVector(ElementTetP2())), "skin")
    facet, xi, weight, facing = pieces(slave, rigid.sphere((0.0, 0.0, 0.0), 1.0, hole=True))
    assert (facing >= 0).all()
    # straight edges of the other facets leave less than a tenth of the strips, 1.8 %
    assert weight @ slave.density(facet, xi) == pytest.approx(4 * np.pi, rel=2e-3)


def pieces(slave: Surface, master: Surface, away=(0, 0, 0)):
    """Facets, local coordinates, weights of the points on pieces, and facets that they face."""
    facet, xi, weight, facing = np.split(
        piecewise(slave, slave.nodes + away, master, master.nodes), [1, 3, 4], axis=1
    )
    return facet[:, 0].astype(int), xi, weight[:, 0], facing[:, 0].astype(int)


@pytest.mark.parametrize("element", IN_SPACE)
def test_pieces_cover_both_surfaces(element):
    """Areas of the pieces add up to the facets of the slave and of the master, skewed as they
    are.
    """
    lines = [np.linspace(0, 1, n + 1) for n in (4, 6)]

    def skew(p):
        return 0.12 * np.sin(np.pi * p[0]) * np.sin(np.pi * p[1]) * np.array([[1.0], [-0.7], [0.0]])

    lower = space.block(element, lines[0], lines[0], [-1, 0])
    upper = space.moved(space.block(element, lines[1], lines[1], [0, 1]), skew)
    master = Surface.from_boundary(vector_basis(lower, element), "top")
    slave = Surface.from_boundary(vector_basis(upper, element), "bottom")
    facet, xi, weight, facing = pieces(slave, master)
    area = weight * slave.density(facet, xi)
    np.testing.assert_allclose(np.bincount(facet, area), slave.area, atol=1e-15)
    np.testing.assert_allclose(np.bincount(facing, area), master.area, atol=1e-14)


@pytest.mark.parametrize("n", [2, 3])
@pytest.mark.parametrize("element", ["P1", "Q1"])
def test_pieces_turn_with_the_bodies(rng, element, n):
    """Edges along each other, as the diagonals of meshes that match, are cut at the same places
    however they lie.
    """
    lines = [np.linspace(0, 1, m + 1) for m in (n, 3)]
    slave, master = (
        Surface.from_boundary(
            space.vector_basis(space.block(element, line, line, z), element), side
        )
        for line, z, side in zip(lines, ([0, 1], [-1, 0]), ("bottom", "top"), strict=True)
    )
    rows = piecewise(slave, slave.nodes, master, master.nodes)
    for _ in range(10):
        Q = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        Q *= np.sign(np.linalg.det(Q))
        turned = piecewise(slave, slave.nodes @ Q.T, master, master.nodes @ Q.T)
        np.testing.assert_allclose(
            turned, rows, atol=1e-12
        )  # coordinates, weights, numbers: some roundings


def test_pieces_of_bodies_apart():
    """Where the master is far, or faces away, the facets keep their Gauss points, which face
    none.
    """
    line = np.linspace(0, 1, 4)
    master = Surface.from_boundary(
        vector_basis(space.block("Q1", line, line, [-1, 0]), "Q1"), "top"
    )
    slave = Surface.from_boundary(
        vector_basis(space.block("Q1", line, line, [0, 1]), "Q1"), "bottom"
    )
    for away in ((0, 0, 1.0), (5.0, 0, 0)):
        facet, xi, weight, facing = pieces(slave, master, away)
        assert (facing == -1).all()
        np.testing.assert_allclose(
            np.bincount(facet, weight * slave.density(facet, xi)), slave.area, rtol=1e-14
        )
    *_, facing = pieces(slave, master, (0.5, 0, 0))
    assert (facing == -1).any() and (facing >= 0).any()
    for adjusted, cut in ((0.0, False), (0.5, True)):  # a gap of .3 of the size
        rows = piecewise(slave, slave.nodes + np.array([0, 0, 0.1]), master, master.nodes, adjusted)
        assert (rows[:, 4] >= 0).all() if cut else (rows[:, 4] == -1).all()


def test_rigid_obstacles_are_round(rng):
    """Distances to sphere, hole, cylinder, cone and plane, to 1e-6 of the radius: that of
    second-order facets.
    """
    points = np.array([1.0, 2.0, 3.0]) + rng.uniform(-2.5, 2.5, (500, 3))
    centre, radius = np.array([1.0, 2.0, 3.0]), 1.5
    distance = np.linalg.norm(points - centre, axis=1) - radius
    near = np.abs(distance) < 1.0
    for hole in (False, True):
        gap = found(sc.rigid.sphere(centre, radius, hole=hole), points).gap
        np.testing.assert_allclose(gap[near], (-1 if hole else 1) * distance[near], atol=2e-6)
    axis = np.array([1.0, 2.0, 2.0]) / 3
    along = (points - centre) @ axis
    distance = np.linalg.norm(points - centre - np.outer(along, axis), axis=1) - radius
    near = (np.abs(along) < 3.5) & (np.abs(distance) < 1.0)
    gap = found(sc.rigid.cylinder(centre - 4 * axis, centre + 4 * axis, radius), points).gap
    np.testing.assert_allclose(gap[near], distance[near], atol=2e-6)
    points = rng.uniform(-1, 1, (500, 3)) * [1, 1, 0.3]
    r = np.hypot(*points[:, :2].T)
    gap = found(sc.rigid.cone((0, 0, 0), (0, 0, 1), slope=0.1, radius=2.0), points).gap
    exact = (0.1 * r - points[:, 2]) / np.sqrt(1.01)
    near = r + 0.1 * points[:, 2] > 0.1
    np.testing.assert_allclose(gap[near], exact[near], atol=1e-5)
    gap = found(sc.rigid.plane((0, 0, 0.1), (0, 0.6, 0.8), width=9.0), points).gap
    np.testing.assert_allclose(gap, points @ [0, 0.6, 0.8] - 0.08, atol=1e-14)


def test_rigid_surface_of_a_mesh():
    """A boundary of a mesh as an obstacle: no unknowns, the same facets."""
    mesh = space.block("Q1", [0, 1, 2], [0, 1], [-1, 0])
    rigid = sc.rigid.mesh(mesh, "top")
    assert (
        rigid.rigid
        and len(rigid.facets) == 2
        and rigid.area == pytest.approx([1.0, 1.0], rel=1e-14)
    )
    with pytest.raises(ValueError, match=r"there is no boundary 'roof'; existing: .*top"):
        sc.rigid.mesh(mesh, "roof")


def test_bad_surfaces_in_space():
    """One clear error each."""
    with pytest.raises(ValueError, match="surface in space"):
        smoothed(sc.rigid.plane((0, 0, 0), (0, 0, 1), 1.0))
    with pytest.raises(ValueError, match="radius must be positive"):
        sc.rigid.sphere((0, 0, 0), -1.0)
    with pytest.raises(ValueError, match="finite"):
        sc.rigid.plane((0, np.nan, 0), (0, 0, 1), 1.0)
    with pytest.raises(ValueError, match="must have a length"):
        sc.rigid.cylinder((0, 0, 1), (0, 0, 1), 1.0)


def skin(mesh: MeshHex | MeshTet, facets=None) -> Surface:
    """The whole boundary of a mesh, or some facets."""
    mesh = mesh.with_boundaries({"skin": mesh.boundary_facets() if facets is None else facets})
    return sc.rigid.mesh(mesh, "skin")


def cubes(*corners) -> MeshHex:
    """Unit cubes that share the nodes in one place."""
    both = sc.join_bodies({str(at): MeshHex().translated(at) for at in corners})
    p, number = np.unique(both.p.round(9), axis=1, return_inverse=True)
    return MeshHex(p, number.ravel()[both.t])


def prisms() -> Basis:
    return Basis(MeshWedge1(), ElementVector(ElementWedge1()), intorder=2)


def collapsed(kind: str) -> Surface:
    """A facet without area: a triangle with its corners on a line, and a quadrilateral in one
    place.
    """
    if kind == "triangle":
        p = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 1.0]]).T
        return skin(MeshTet(p, np.array([[0, 1, 2, 3]]).T), lambda x: x[2] < 0.1)
    mesh = MeshHex().refined(1)
    p, right = mesh.p.copy(), np.isclose(mesh.p[2], 1) & (mesh.p[0] > 0.4)
    p[:, right] = [[1.0], [0.0], [1.0]]
    return skin(MeshHex(p, mesh.t), lambda x: x[2] > 0.95)


#: What is no surface of a contact pair in space, and what is said of it.
NO_SURFACE = {
    "an edge of four facets": (
        lambda: skin(cubes((0, 0, 0), (1, 1, 0))),
        "'skin' is no surface: an edge belongs to",
    ),
    "a pinched corner": (
        lambda: skin(cubes((0, 0, 0), (1, 1, 1))),
        "'skin' is no surface: parts .* at 1 nodes",
    ),
    "a chequerboard": (
        lambda: skin(
            cubes((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)),
            lambda x: np.isclose(x[2], 1) & ((x[0] - 1) * (x[1] - 1) > 0),
        ),
        "parts of it meet only at a corner",
    ),
    "mixed facets": (
        lambda: sc.ContactPair(prisms(), "top", "bottom", sc.Coulomb()),
        "unsupported element .*Wedge.*supported are",
    ),
    "mixed bodies": (
        lambda: sc.join_bodies({"a": MeshTet(), "b": MeshHex()}),
        "different types cannot be joined",
    ),
    "a slave that is master": (
        lambda: sc.ContactPair(
            space.facing("Q1", np.random.default_rng(1)), "lower:top", "lower:top", sc.Coulomb()
        ),
        "all facets of 'lower:top' face the same way",
    ),
    "a slave beside its master": (
        lambda: sc.ContactPair(
            space.facing("P2", np.random.default_rng(1)), "lower:top", "lower:left", sc.Coulomb()
        ),
        "leave the facets there out of one of them",
    ),
    "a flat triangle": (lambda: collapsed("triangle"), r"'skin': facets without area at \[\[1"),
    "a flat quadrilateral": (
        lambda: collapsed("quadrilateral"),
        r"'skin': facets without area at \[\[1",
    ),
}


@pytest.mark.filterwarnings(
    "ignore:.*(divide|invalid value):RuntimeWarning"
)  # scikit-fem's, of flat elements
@pytest.mark.parametrize("name", NO_SURFACE)
def test_what_is_no_surface(name):
    """One clear error, before anything is computed."""
    mistake, message = NO_SURFACE[name]
    with pytest.raises(ValueError, match=message):
        mistake()


@pytest.mark.parametrize("corners", [3, 4, 5, 6])
def test_points_on_pieces_do_not_depend_on_the_first_corner(corners: int) -> None:
    """[X] The areas and moments of a polygon, cut about its first corner, to the degree of the
    rule.
    """
    angle = 2.0 * np.pi * np.arange(corners) / corners
    polygon = np.stack((np.cos(angle) + 0.3 * np.sin(angle), 0.7 * np.sin(angle + 0.1)), axis=1)
    turns = [np.roll(polygon, k, axis=0) for k in range(corners)]
    padded = np.array([np.vstack((turn, *[turn[-1:]] * (7 - corners))) for turn in turns])
    piece, points, area = _points_on(padded, np.full(corners, corners), 4)

    # Compare with triangles about the first corner
    xi, w = get_quadrature(RefTri, 4)
    exact = 0.0
    for k in range(1, corners - 1):
        a, b, c = polygon[[0, k, k + 1]]
        x = a + np.outer(xi[0], b - a) + np.outer(xi[1], c - a)
        size = np.linalg.det(np.stack((b - a, c - a)))
        exact += size * w @ _monomials(x)
    sums = [area[piece == k] @ _monomials(points[piece == k]) for k in range(corners)]
    assert np.array(sums) == pytest.approx(np.tile(exact, (corners, 1)), abs=1e-12)

    # All orders of the corners have the same points
    first = points[piece == 0]
    for k in range(1, corners):
        apart = np.linalg.norm(first[:, None] - points[piece == k], axis=2)
        assert apart.min(axis=1).max() < 1e-12


def _monomials(x: np.ndarray) -> np.ndarray:
    """Monomials to the fourth degree, (n, 15)."""
    return np.stack([x[:, 0] ** i * x[:, 1] ** j for i in range(5) for j in range(5 - i)], axis=1)


def test_sides_at_the_rim_end_at_the_reach_of_their_neighbours():
    """[X] Beyond two sides of a square the closest point is as far beyond each of them as the
    surface reaches there, whichever of them is looked at first.
    """
    basis = Basis(MeshHex().with_defaults(), ElementVector(ElementHex1()), intorder=2)
    surface = Surface.from_boundary(basis, "top")
    shape = surface.shape
    reach = np.array([[0.1, 0.2, 0.3, 0.4]])
    for side, (_, end) in enumerate(shape.side_corners):
        (following,) = [k for k, (start, _) in enumerate(shape.side_corners) if start == end]
        xi = shape.corners[[end]] + 0.9 * (shape.outward[[side]] + shape.outward[[following]])
        beyond = shape.beyond(xi)
        facet = np.zeros(1, int)
        points = surface.at(facet, xi, surface.nodes).x[0]
        found, feature, off = on_sides(surface, surface.nodes, points, facet, beyond, reach)
        both = [side, following]
        np.testing.assert_allclose(shape.beyond(found)[0, both], reach[0, both], rtol=1e-9)
        assert feature == 5 and off
