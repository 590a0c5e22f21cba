"""Lists of neighbours: what they promise holds until they are searched anew."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

import skfem_contact as sc
import skfem_contact.contact.neighbours as search_list
from skfem_contact.contact.interface import Interface
from skfem_contact.contact.neighbours import NeighbourList, Pairs, neighbours
from skfem_contact.contact.search import project
from skfem_contact.surfaces.smoothing import smoothed
from skfem_contact.surfaces.surface import Surface
from tests.tools.helpers import body_along, rough_pair, vector_basis


def wavy(element: str, closed: bool) -> Surface:
    """A chain of segments of very different lengths."""
    s = np.linspace(0, 1, 25) ** 2
    if closed:
        angle = -2 * np.pi * s[:-1]
        line = np.stack((np.cos(angle), 0.7 * np.sin(angle)), axis=1)
    else:
        line = np.stack((6 * s - 3, 0.4 * np.sin(5 * s)), axis=1)
    mesh = body_along(line, element, 0.2, closed=closed)
    return Surface.from_boundary(vector_basis(mesh, element), "face")


@pytest.mark.parametrize("stretch", [1.0, 4.0])
def test_facets_that_have_grown_keep_the_nearest_one_among_their_neighbours(
    stretch: float, rng
) -> None:
    """[X] An ellipse that is pressed flat and drawn out: samples of the other side come nearer than
    those of the facet on which a point lies.
    """
    surface = wavy("P1", closed=True)
    x, y = surface.nodes.T
    nodes = np.stack((stretch * (x + 0.2 * y), 2e-3 * y), axis=1)
    points = rng.uniform((-stretch, -3e-3), (stretch, 3e-3), (500, 2))
    point, neighbour = neighbours(surface, nodes, points)[0].pairs
    found = set(zip(point.tolist(), neighbour.tolist(), strict=True))
    begin, end = nodes[surface.facets].transpose(1, 0, 2)
    along, away = end - begin, points[:, None] - begin
    share = np.clip((away * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
    nearest = np.linalg.norm(away - share[..., None] * along, axis=2).argmin(axis=1)
    assert all(pair in found for pair in enumerate(nearest.tolist()))


@pytest.mark.parametrize(
    ("element", "closed", "alpha"),
    [
        ("P1", False, None),
        ("P1", True, None),
        ("Q2", False, None),
        ("P1", False, 0.3),
    ],
)
@pytest.mark.one_in(2)
def test_kept_neighbours_serve_as_new_ones(
    element: str, closed: bool, alpha: float | None, rng
) -> None:
    """While points and surface move, projections among kept neighbours are those among all;
    clearances hold.

    On curved segments the iterations for the foot end with the slowest of all candidates: 1e-12 of
    the coordinates.
    """
    surface = wavy(element, closed)
    surface = surface if alpha is None else smoothed(surface, alpha)
    nodes, points = surface.nodes, rng.uniform(-3.5, 3.5, (300, 2))
    around, depth = NeighbourList(surface), np.full(300, np.inf)
    drift, searches, last = np.array([0.3, 0.1]), 0, None
    for _ in range(40):
        nodes = nodes + drift + 4e-3 * rng.standard_normal(nodes.shape)
        points = points + drift + 4e-3 * rng.standard_normal(points.shape)
        found = around.at(nodes, points)
        searches, last = searches + (found.candidates is not last), found.candidates
        one = project(surface, nodes, points, depth, among=found.pairs)
        other = project(surface, nodes, points, depth)
        np.testing.assert_array_equal(one.found, other.found)
        np.testing.assert_allclose(one.gap, other.gap, rtol=0, atol=1e-11)
        near = other.found
        np.testing.assert_array_equal(one.facet[near], other.facet[near])
        assert (found.clearance <= np.abs(other.gap)).all()
    assert 1 < searches < 30
    assert np.mean(np.abs(other.gap[near]) - found.clearance[near]) < 1.0  # they tell something


@pytest.mark.parametrize(("element", "closed"), [("P1", False), ("P1", True), ("Q2", False)])
def test_a_segment_that_is_torn_leaves_the_others_their_neighbours(
    element: str, closed: bool, rng
) -> None:
    """Where a trial throws one node far away, the gaps are those among all segments, and few pairs
    are added.
    """
    surface = wavy(element, closed)
    points = surface.nodes + 0.05 * rng.standard_normal(surface.nodes.shape)
    before = NeighbourList(surface).at(surface.nodes, points).pairs
    torn = surface.nodes.copy()
    torn[len(torn) // 2] += (0.0, 40.0)
    found = NeighbourList(surface).at(torn, points).pairs
    n, m = len(points), len(surface.facets)
    everything = Pairs(np.repeat(np.arange(n), m), np.tile(np.arange(m), n))
    one = project(surface, torn, points, np.full(n, np.inf), among=found)
    other = project(surface, torn, points, np.full(n, np.inf), among=everything)
    np.testing.assert_allclose(one.gap, other.gap, rtol=0, atol=1e-11)  # what polishing leaves
    assert (
        len(found.point) < 2 * len(before.point) + 2 * n
    )  # the two torn segments may be near to all points


def test_points_without_neighbours_are_not_projected() -> None:
    """What is not looked for is not found."""
    line = sc.rigid.line((0.0, 0.0), (1.0, 0.0))
    points = np.array([[0.25, 1.0], [0.75, 1.0]])
    found = NeighbourList(line).at(line.nodes, points)
    for chosen in ([True, False], [False, True], [False, False]):
        where = project(line, line.nodes, points, np.ones(2), among=found.of(np.array(chosen)))
        assert where.found.tolist() == chosen
        assert np.isinf(where.gap).tolist() == [not c for c in chosen]


def test_candidates_are_searched_for_points_that_are_asked_for(rng, monkeypatch) -> None:
    """[N] Trials of Newton's method throw points far away, where many facets are about as near:
    nothing is searched for points that cannot touch, and nothing twice.
    """
    drum = sc.rigid.cylinder((0.0, -1.0, 0.0), (0.0, 1.0, 0.0), 1.0)
    points = rng.uniform(-3.0, 3.0, (200, 3))
    own = np.where(np.arange(200) < 50, 7, -1)
    points[:50] = drum.at(np.full(50, 7), np.full((50, 2), 0.5), drum.nodes).x[0]
    searched = []

    def counting(tree, points, *others, around=search_list._around):
        searched.append(len(points))
        return around(tree, points, *others)

    monkeypatch.setattr(search_list, "_around", counting)
    whole = NeighbourList(drum).at(drum.nodes, points, own).pairs
    assert searched == [150]  # the others stay on their own facets
    searched.clear()

    around = NeighbourList(drum).at(drum.nodes, points, own)
    near = around.within(np.zeros(200), np.full(200, 0.1))
    assert not searched
    some = around.of(near)
    np.testing.assert_array_equal(np.unique(some.point), np.flatnonzero(near))
    assert searched == [near[50:].sum()]
    assert 0 < searched[0] < 30
    around.of(near)
    assert len(searched) == 1
    copied = pickle.loads(pickle.dumps(around))
    for one, other, third in zip(around.pairs, copied.pairs, whole, strict=True):
        np.testing.assert_array_equal(one, other)
        np.testing.assert_array_equal(one, third)


def test_points_known_to_lie_outside() -> None:
    """What has been projected outside is not near until it could have come near; what is inside
    always is.
    """
    line = sc.rigid.line((0.0, 0.0), (1.0, 0.0))
    around, points = NeighbourList(line), np.array([[0.25, 0.05], [0.75, -0.05], [0.5, 0.05]])
    gap, depth = np.zeros(3), np.full(3, 0.1)
    assert around.at(line.nodes, points).within(gap, depth).all()  # nothing is known yet
    found = project(line, line.nodes, points, np.full(3, np.inf))
    around.learn(np.array([True, True, False]), found.distance, found.gap)
    assert around.at(line.nodes, points).within(gap, depth).tolist() == [False, True, True]
    assert (
        around.at(line.nodes, points).within(gap, np.full(3, np.inf)).all()
    )  # a law that reaches any distance
    down = points - np.array([[0.04 * y] for y in (1.0, 0.0, 0.0)]) * (0.0, 1.0)
    assert not around.at(line.nodes, down).within(gap, depth)[0]
    assert around.at(line.nodes, points - [0.0, 0.06]).within(gap, depth).all()


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_other_multipliers_move_no_points(quadrature: str | int, rng, monkeypatch) -> None:
    """[N] At the same displacements points are not projected again; the response is that of a new
    pair.
    """
    basis, pair, x, state = rough_pair("Q1", quadrature, sc.Coulomb(0.3), rng)
    gap, searched, project = pair.assemble(x, state).state.gap, [], Interface.project
    monkeypatch.setattr(
        Interface, "project", lambda *given: searched.append(given) or project(*given)
    )
    state = replace(state, multiplier=state.multiplier - np.array([[30.0], [2.0]]))
    here, new = (
        one.assemble(x, state)
        for one in (pair, pair.with_surfaces(pair.slave, pair.facets, pair.master))
    )
    assert len(searched) == 1
    np.testing.assert_array_equal(here.force, new.force)
    np.testing.assert_array_equal(here.stiffness.toarray(), new.stiffness.toarray())
    np.testing.assert_array_equal(here.state.gap, gap)
    searched.clear()
    pair.assemble(x + 1e-3 * np.arange(basis.N) / basis.N, state)
    assert len(searched) == 1
