"""Every mesh that no analysis can work on gets one clear error."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementVector,
    MeshHex1,
    MeshHex2,
    MeshLine,
    MeshQuad1,
    MeshQuad1DG,
    MeshQuad2,
    MeshTet1,
    MeshTet2,
    MeshTri1,
    MeshTri2,
    MeshWedge1,
)
from skfem.generic_utils import OrientedBoundary

import skfem_contact as sc
from skfem_contact.mesh import check_mesh, join_bodies
from skfem_contact.mesh.connections import lies_on, loose_links, outside_of, touching_sides
from skfem_contact.mesh.content import side_kind

KINDS = [MeshQuad1, MeshQuad2, MeshTri1, MeshTri2]
SQUARE = np.array([[0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0]])
ONE = np.array([[0], [1], [2], [3]])


def grid(kind):
    """A unit square, 4 x 4."""
    mesh = MeshQuad1.init_tensor(np.linspace(0, 1, 5), np.linspace(0, 1, 5))
    mesh = mesh if issubclass(kind, MeshQuad1) else mesh.to_meshtri()
    return mesh if type(mesh) is kind else kind.from_mesh(mesh)


def moved(mesh, node, x):
    """The mesh with a node somewhere else."""
    doflocs = mesh.doflocs.copy()
    doflocs[:, node] = x
    return type(mesh)(doflocs, mesh.t)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("flip", [1.0, -1.0])
@pytest.mark.parametrize("stretch", [1.0, 1e5])
def test_good_meshes_pass(kind, flip, stretch):
    """Either way round, of any size, far away, and as needles."""
    check_mesh(grid(kind).scaled((flip * stretch, 1.0)))
    check_mesh(grid(kind).scaled((1e-6, 1e-6 * flip)))
    check_mesh(grid(kind).translated((1e3, -1e3)))


def test_both_ways_round_in_one_mesh_pass():
    tidy = grid(MeshTri1)
    (ax, bx), (ay, by) = tidy.p[:, tidy.t[1:]] - tidy.p[:, tidy.t[:1]]
    assert set(np.sign(ax * by - ay * bx)) == {-1.0, 1.0}
    check_mesh(tidy)


@pytest.mark.parametrize("kind", KINDS)
def test_flat_element(kind):
    mesh = grid(kind)
    flat = moved(mesh, mesh.t[:, 5], mesh.p[:, mesh.t[:, 5]] * [[1.0], [0.0]])
    with pytest.raises(
        ValueError, match=r"flat elements, \d+ in all: .*element 5 at \(0\.\d+, 0\)"
    ):
        check_mesh(flat)


def test_quadrilateral_with_three_corners_in_a_line():
    with pytest.raises(ValueError, match=r"flat elements, 1 in all: element 0 at \(0.625, 0.375\)"):
        check_mesh(MeshQuad1(np.array([[0, 1, 1, 0.5], [0, 0, 1, 0.5]]), ONE))


@pytest.mark.parametrize("kind", [MeshQuad1, MeshQuad2])
@pytest.mark.parametrize("order", [[0, 2, 1, 3], [0, 1, 3, 2]])
def test_bow_tie(kind, order):
    mesh = MeshQuad1(SQUARE[:, order], ONE)
    with pytest.raises(
        ValueError, match=r"(inverted|flat) elements, 1 in all: element 0 at \(0.5, 0.5\)"
    ):
        check_mesh(mesh if kind is MeshQuad1 else kind.from_mesh(mesh))


def test_corner_inside_the_opposite_triangle():
    with pytest.raises(ValueError, match=r"inverted elements, 1 in all: element 0"):
        check_mesh(MeshQuad1(np.array([[0, 1, 0.3, 0], [0, 0, 0.3, 1]]), ONE))


@pytest.mark.parametrize("kind", KINDS)
def test_corner_moved_across_the_opposite_side(kind):
    """Neither triangle is inverted, for they run either way round; but they cover each other."""
    corners = np.array([[0, 1, 0.5, 0.5], [0, 0, -0.5, -1.0]])
    folded = MeshTri1(corners, np.array([[0, 1, 2], [0, 3, 1]]).T)
    if kind in (MeshQuad1, MeshQuad2):
        p = np.array([[0, 1, 1, 0, 0, 1], [0, 0, 1, 1, 0.5, 0.5]])
        folded = MeshQuad1(p, np.array([[0, 1, 2, 3], [0, 1, 5, 4]]).T)
    mesh = folded if kind in (MeshTri1, MeshQuad1) else kind.from_mesh(folded)
    with pytest.raises(ValueError, match=r"folded over their neighbours, 2 in all: element 0"):
        check_mesh(mesh)


@pytest.mark.parametrize("kind", [MeshQuad2, MeshTri2])
def test_side_bent_through_the_element(kind):
    mesh = grid(kind)
    side = mesh.dofs.element_dofs[len(mesh.t), 3]
    with pytest.raises(ValueError, match="inverted elements"):
        check_mesh(moved(mesh, side, mesh.doflocs[:, side] + 0.24))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_coordinates_that_are_not_finite(kind, value):
    with pytest.raises(ValueError, match=r"not finite, 1 in all: node 7 at \((nan|inf), 0.5\)"):
        check_mesh(moved(grid(kind), 7, (value, 0.5)))


def test_free_nodes_are_named_but_join_bodies_drops_them():
    mesh = grid(MeshQuad1)
    loose = MeshQuad1(np.hstack((mesh.p, [[2.0, 3.0], [0.5, np.nan]])), mesh.t)
    with pytest.raises(
        ValueError, match=r"nodes of no element .*2 in all: node 25 at \(2, 0.5\), node 26"
    ):
        check_mesh(loose)
    check_mesh(join_bodies({"square": loose}))


def test_long_lists_are_cut():
    mesh = grid(MeshQuad1)
    with pytest.raises(ValueError) as caught:
        check_mesh(mesh.scaled((1.0, 0.0)))
    assert "flat elements, 16 in all" in str(caught.value)
    assert str(caught.value).count("element ") == 5
    assert str(caught.value).endswith("...")


@pytest.mark.parametrize(
    "mesh", [MeshWedge1(), MeshLine(), MeshQuad1DG.init_tensor([0, 1], [0, 1])]
)
def test_other_kinds(mesh):
    message = (
        f"{type(mesh).__name__} is not supported; supported are MeshTri1, MeshTri2, MeshQuad1,"
    )
    for check in (check_mesh, join_bodies):
        with pytest.raises(ValueError, match=message):
            check(mesh)


def test_no_elements():
    with pytest.raises(ValueError, match="no elements"):
        check_mesh(MeshQuad1(SQUARE, np.zeros((4, 0), dtype=int)))


@pytest.mark.parametrize("node", [4, -1])
def test_nodes_that_do_not_exist(node):
    with pytest.raises(ValueError, match="4 nodes, but its elements need"):
        check_mesh(MeshQuad1(SQUARE, np.array([[0], [1], [2], [node]])))


@pytest.mark.parametrize("kind", KINDS)
def test_surface_saved_twice(kind):
    first_order = MeshQuad1 if issubclass(kind, MeshQuad1) else MeshTri1
    mesh = grid(first_order)
    double = first_order(mesh.p, np.hstack((mesh.t, mesh.t[:, :1])))
    with pytest.raises(ValueError, match="elements on top of each other"):
        check_mesh(double if kind is first_order else kind.from_mesh(double))


@pytest.mark.parametrize("numbers", [[0, 40], [-1, 3]])
def test_tags_of_another_mesh(numbers):
    mesh = grid(MeshQuad1)
    with pytest.raises(ValueError, match=r"boundary 'edge' has numbers outside 0..39; is it"):
        check_mesh(mesh.with_boundaries({"edge": np.array(numbers)}))
    with pytest.raises(ValueError, match=r"subdomain 'part' has numbers outside 0..15"):
        check_mesh(mesh.with_subdomains({"part": np.array(numbers)}))


def test_part_of_an_oriented_boundary():
    """Indexing an oriented boundary leaves its orientations behind."""
    mesh = grid(MeshQuad1)
    rim = mesh.facets_around(np.array([5, 6]))
    check_mesh(mesh.with_boundaries({"rim": rim}))
    assert isinstance(rim[:2], OrientedBoundary)
    with pytest.raises(ValueError, match="boundary 'rim' has 2 facets, but 6 orientations"):
        check_mesh(mesh.with_boundaries({"rim": rim[:2]}))


def test_empty_tags_are_allowed():
    empty = np.zeros(0, dtype=int)
    check_mesh(grid(MeshQuad1).with_boundaries({"none": empty}).with_subdomains({"nothing": empty}))


@pytest.mark.parametrize("kind", [MeshHex1, MeshHex2, MeshTet1, MeshTet2])
@pytest.mark.parametrize("flip", [1.0, -1.0])
def test_columns_in_space_may_be_sheared_by_more_than_their_height(kind, flip):
    """Heights z + 16 x y: layers a quarter high whose sides rise by up to four; the Jacobian is one
    everywhere.
    """
    mesh = (
        MeshHex1.init_tensor(*3 * [np.linspace(0, 1, 5)])
        if issubclass(kind, MeshHex1)
        else MeshTet1.init_tensor(*3 * [np.linspace(0, 1, 5)])
    )
    mesh = mesh if type(mesh) is kind else kind.from_mesh(mesh)
    x, y, z = mesh.doflocs
    check_mesh(type(mesh)(np.array([flip * x, y, z + 16 * x * y]), mesh.t))


@pytest.mark.parametrize("kind", [MeshHex1, MeshHex2, MeshTet1, MeshTet2])
def test_elements_folded_in_space(kind):
    """The second of two elements is mirrored at the facet between them: it covers the first."""
    if issubclass(kind, MeshHex1):
        mesh = MeshHex1.init_tensor(
            np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0]), np.array([0.0, 1.0])
        )
        folded = MeshHex1(
            np.array([1 - abs(mesh.p[0] - 1) * np.where(mesh.p[0] > 1, 0.5, 1.0), *mesh.p[1:]]),
            mesh.t,
        )
    else:
        folded = MeshTet1(
            np.array([[0, 1, 0, 0, 0.2], [0, 0, 1, 0, 0.2], [0, 0, 0, 1, 0.5]]),
            np.array([[0, 1, 2, 3], [0, 1, 2, 4]]).T,
        )
    with pytest.raises(ValueError, match=r"folded over their neighbours, 2 in all: element 0"):
        check_mesh(folded if kind in (MeshHex1, MeshTet1) else kind.from_mesh(folded))


def test_hexahedron_inverted_between_its_corners():
    """Its top is turned half round and stretched: its Jacobian is 1 at all corners, and -1/8 at
    half its height.
    """
    mesh = MeshHex1()
    top = np.where(mesh.p[2] == 1, [[-2.0], [-0.5], [1.0]], 1.0)
    with pytest.raises(
        ValueError, match=r"inverted elements, 1 in all: element 0 at \(-0.25, 0.125, 0.5\)"
    ):
        check_mesh(MeshHex1(mesh.p * top, mesh.t))


HANGING = MeshQuad1(
    np.array([[0, 1, 1, 0, 1, 2, 2, 2], [0, 0, 1, 1, 0.5, 0, 0.5, 1.0]]),
    np.array([[0, 1, 2, 3], [1, 5, 6, 4], [4, 6, 7, 2]]).T,
)


def told(mesh, joined=None):
    """Texts of the warnings of a check."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_mesh(mesh, joined)
    return [str(warning.message) for warning in caught]


def test_hanging_node_in_the_plane():
    """[X] One square beside two rectangles: the node between these lies on the square's side."""
    (text,) = told(HANGING)
    assert text.startswith("hanging nodes")
    assert text.endswith("1 in all: node 4 at (1, 0.5)")


@pytest.mark.parametrize("tetrahedra", [False, True])
def test_hanging_nodes_in_space(tetrahedra):
    """[X] A cube beside eight small ones: four nodes on edges of the common side and one inside."""
    line = np.array([0.0, 1.0])
    fine = MeshHex1.init_tensor(np.linspace(1, 2, 3), np.linspace(0, 1, 3), np.linspace(0, 1, 3))
    coarse = MeshHex1.init_tensor(line, line, line)
    if tetrahedra:
        fine = fine.to_meshtet()
        coarse = coarse.to_meshtet()
    welded = coarse + fine
    (text,) = told(welded)
    assert text.startswith("hanging nodes")
    assert "5 in all" in text


@pytest.mark.parametrize("shift", [0.0, 0.25])
def test_sides_on_each_other_are_told_where_nothing_joins_them(shift):
    """[X] Two blocks above each other whose nodes are doubled, matching or not."""
    upper = grid(MeshQuad1).translated((shift, 1.0))
    lower = grid(MeshTri1) if shift else grid(MeshQuad1)
    if shift:
        upper = upper.to_meshtri()
    both = type(lower)(
        np.hstack((lower.p, upper.p)), np.hstack((lower.t, upper.t + lower.p.shape[1]))
    )
    count = 8 if shift == 0.0 else 6
    (text,) = told(both)
    assert text.startswith("outer sides lie on each other without contact")
    assert f"{count} in all" in text
    # Nodes that contact joins, and boundaries with names, which it can join
    assert not told(both, np.flatnonzero(both.p[1] == 1.0))
    assert not told(both.with_boundaries({"seam": lambda x: x[1] == 1.0}))


def test_a_model_tells_sides_without_contact():
    """[X] The same blocks in a model, without and with a contact pair."""
    mesh = join_bodies(
        {
            "low": grid(MeshQuad1).with_defaults(),
            "up": grid(MeshQuad1).translated((0, 1)).with_defaults(),
        }
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {"blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2))}
    with pytest.warns(sc.AnalysisWarning, match="sides of low, up lie on each other without"):
        sc.Model(forms)
    forms["joint"] = sc.ContactPair(basis, "up:bottom", "low:top", sc.Coulomb(0.3))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sc.Model(forms)

    # A pair that leaves out the last sides, one node of which it joins
    parts = {f"{side} part": rest_of(mesh, side) for side in ("up:bottom", "low:top")}
    basis = Basis(mesh.with_boundaries(parts), ElementVector(ElementQuad1()), intorder=2)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2)),
        "joint": sc.ContactPair(basis, "up:bottom part", "low:top part", sc.Coulomb(0.3)),
    }
    with pytest.warns(sc.AnalysisWarning, match="without contact, .* 2 in all"):
        sc.Model(forms)


def rest_of(mesh, name):
    """The facets of a level boundary but the last one."""
    facets = np.asarray(mesh.boundaries[name])
    middles = mesh.p[0, mesh.facets[:, facets]].mean(axis=0)
    return np.delete(facets, middles.argmax())


@pytest.mark.parametrize("kind", KINDS)
def test_element_on_top_of_another_with_nodes_of_its_own(kind):
    """[X] Two copies of a square."""
    mesh = join_bodies({"a": grid(kind), "b": grid(kind)})
    assert any(text.startswith("elements on top of others") for text in told(mesh))


def test_squares_that_share_a_corner():
    """[X] Two squares with one common node."""
    p = np.array([[0, 1, 1, 0, 2, 2, 1], [0, 0, 1, 1, 1, 2, 2.0]])
    mesh = MeshQuad1(p, np.array([[0, 1, 2, 3], [2, 4, 5, 6]]).T)
    (text,) = told(mesh)
    assert "act as hinges" in text
    assert text.endswith("1 in all: node 2 at (1, 1)")


@pytest.mark.parametrize("kind", [*KINDS, MeshHex1, MeshTet1])
def test_whole_meshes_are_told_nothing(kind):
    """[X] No message for a conforming mesh, nor for two bodies side by side."""
    line = np.linspace(0, 1, 4)
    mesh = kind.init_tensor(line, line, line) if kind in (MeshHex1, MeshTet1) else grid(kind)
    assert not told(mesh)
    assert not told(join_bodies({"a": mesh, "b": mesh.translated(np.full(mesh.dim(), 1.1))}))


def test_ends_of_long_elements():
    """Elements of 1 x 100: the lower and upper sides of the first and the last one are named as
    left and right ends, too.
    """
    mesh = MeshQuad1.init_tensor(np.arange(5.0), np.array([0.0, 100.0]))
    (text,) = told(mesh.with_defaults())
    assert "['left', 'right'] contain sides along their axis" in text
    assert "4 in all: side 1 at (0.5, 0)" in text
    bodies = {"a": mesh.with_defaults(), "b": mesh.translated((9.0, 0.0)).with_defaults()}
    with pytest.warns(sc.AnalysisWarning, match=r"\['a:left', 'a:right', 'b:left', 'b:right'\]"):
        join_bodies(bodies)
    # Names by coordinates, sides of a slope and shorter elements are right.
    named = {"left": lambda x: x[0] < 1e-9, "top": lambda x: x[1] > 100 - 1e-9}
    assert not told(mesh.with_boundaries(named))
    assert not told(mesh.scaled((1.0, 0.1)).with_defaults())
    sloped = moved(grid(MeshTri1), 0, (-0.1, 0.0)).with_boundaries(
        {"left": lambda x: x[0] < 0.01, "bottom": lambda x: x[1] < 0.2}
    )
    assert not told(sloped)


def test_links_of_a_chain():
    """[X] Three squares in a row that share corners: two nodes link them, and no other."""
    square = MeshQuad1()
    chain = square + square.translated((1.0, 1.0)) + square.translated((2.0, 2.0))
    links = chain.p[:, loose_links(chain)]
    assert sorted(links[0]) == [1.0, 2.0]


def test_one_side_touches_no_other():
    """A single side has no pairs; both lists of them are empty."""
    outside = outside_of(MeshQuad1().refined(1))
    alone = outside.part(np.arange(len(outside.facets)) == 0)
    first, second = touching_sides(alone)
    assert len(first) == len(second) == 0


def test_two_sides_touch_each_other():
    """[X] The sides between two squares with nodes of their own are a pair, in both orders."""
    square = MeshQuad1()
    outside = outside_of(join_bodies({"a": square, "b": square.translated((1.0, 0.0))}))
    pair = outside.part(np.isclose(outside.middles[:, 0], 1.0))
    first, second = touching_sides(pair)
    assert sorted(zip(first, second, strict=True)) == [(0, 1), (1, 0)]


@pytest.mark.parametrize("length", [1e-3, 1.0, 1e3])
def test_ends_of_a_side_lie_on_it(length):
    """[X] Both ends do, up to round-off, and points beyond them or beside it do not."""
    ends = length * np.array([[0.3, 0.1], [1.1, 0.7]])
    share = np.array([0.0, 0.5, 1.0, 1.0 + 1e-12, 1.01, -0.01])
    points = ends[0] + share[:, None] * (ends[1] - ends[0])
    points = np.concatenate((points, points[1:2] + 0.01 * length))
    sides = np.tile(ends, (len(points), 1, 1))
    on = lies_on(points, sides, np.full(len(points), 0.5 * length))
    assert on.tolist() == [True, True, True, True, False, False, False]


def test_kinds_of_sides():
    """Elements in the plane have lines, those in space triangles or quadrilaterals."""
    assert [side_kind(*side) for side in ((2, 2), (3, 3), (4, 3))] == ["line", "triangle", "quad"]


@pytest.mark.parametrize("joined", [[0.0, 1.0], [[0, 1]], 3])
def test_joined_nodes_are_numbers(joined) -> None:
    """Neither coordinates nor tables."""
    with pytest.raises(ValueError, match="joined must be numbers of nodes"):
        check_mesh(MeshTri1(), joined=joined)
