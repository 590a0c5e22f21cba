"""Joining and separating bodies: nodes, tags, sides of interfaces."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, FacetBasis, MeshQuad1, MeshQuad2, MeshTri1, MeshTri2
from skfem.generic_utils import OrientedBoundary

from skfem_contact.mesh import bodies, join_bodies

KINDS = [MeshQuad1, MeshQuad2, MeshTri1, MeshTri2]
LAYERS = {"base": ["clay", "sand"], "cover": "slab"}
ROUND_OFF = 1e-13  # sums of some hundred terms of the order one


def plate(kind, nx=6, ny=4):
    """A plate 3 x 2 in three layers, bent so that no side is straight, tagged on and off its
    interfaces.
    """
    mesh = MeshQuad1.init_tensor(np.linspace(0, 3, nx + 1), np.linspace(0, 2, ny + 1))
    mesh = mesh if issubclass(kind, MeshQuad1) else mesh.to_meshtri()
    mesh = mesh if type(mesh) is kind else kind.from_mesh(mesh)
    mesh = mesh.with_subdomains(
        {
            "clay": lambda x: x[1] < 0.5,
            "sand": lambda x: (x[1] > 0.5) & (x[1] < 1),
            "slab": lambda x: x[1] > 1,
        }
    )
    mesh = mesh.with_defaults().with_boundaries(
        {"skin": lambda x: x[1] == 1}, boundaries_only=False
    )
    return mesh.morphed(
        lambda x: x[0] + 0.2 * np.sin(2 * x[1]), lambda x: x[1] + 0.1 * np.sin(2 * x[0])
    )


def areas(mesh):
    """The area of every element."""
    return Basis(mesh, mesh.elem(), intorder=6).dx.sum(axis=1)


def flux(mesh, boundary):
    """Length of a boundary, and the integrals of its normal and of (x, y) times the normal."""
    basis = FacetBasis(mesh, mesh.elem(), facets=boundary, intorder=6)
    x, n = np.asarray(basis.global_coordinates()), np.asarray(basis.normals)
    return np.array([np.sum(part * basis.dx) for part in (1.0, *n, *(x * n))])


def middles(mesh, facets):
    """The midpoints of facets between their ends, as sorted columns."""
    x = mesh.p[:, mesh.facets[:, np.asarray(facets)]].mean(axis=1)
    return x[:, np.lexsort(x)]


def nodes_of(mesh, elements):
    return set(mesh.dofs.element_dofs[:, elements].ravel().tolist())


@pytest.mark.parametrize("kind", KINDS)
def test_nodes_of_an_interface_become_double(kind):
    before = plate(kind)
    after = join_bodies(before, LAYERS)
    on_interface = 13 if kind in (MeshQuad2, MeshTri2) else 7
    assert type(after) is kind
    assert after.doflocs.shape[1] == before.doflocs.shape[1] + on_interface
    base, cover = (nodes_of(after, after.subdomains[name]) for name in ("base", "cover"))
    assert not base & cover
    assert base | cover == set(range(after.doflocs.shape[1]))
    assert len({tuple(x) for x in after.doflocs.T}) == before.doflocs.shape[1]


@pytest.mark.parametrize("kind", KINDS)
def test_elements_keep_number_and_shape(kind):
    before = plate(kind)
    after = join_bodies(before, LAYERS)
    np.testing.assert_array_equal(
        after.doflocs[:, after.dofs.element_dofs], before.doflocs[:, before.dofs.element_dofs]
    )
    np.testing.assert_allclose(areas(after), areas(before), rtol=ROUND_OFF)


@pytest.mark.parametrize("kind", KINDS)
def test_interface_has_two_sides(kind):
    before = plate(kind)
    after = join_bodies(before, LAYERS)
    for one, other in (("base", "cover"), ("cover", "base")):
        facets = after.boundaries[f"{one}|{other}"]
        assert len(facets) == 6
        assert np.isin(after.f2t[0, facets], after.subdomains[one]).all()
        assert (after.f2t[1, facets] == -1).all()
        np.testing.assert_array_equal(
            middles(after, facets), middles(before, before.boundaries["skin"])
        )
        np.testing.assert_array_equal(np.sort(after.boundaries[f"{one}:skin"]), np.sort(facets))
    lower, upper = flux(after, "base|cover"), flux(after, "cover|base")
    np.testing.assert_allclose(upper[0], lower[0], rtol=ROUND_OFF)
    np.testing.assert_allclose(upper[1:], -lower[1:], rtol=ROUND_OFF)
    assert lower[2] > 2  # the base looks up


@pytest.mark.parametrize("kind", KINDS)
def test_every_body_has_a_closed_skin(kind):
    """Gauss: the normal integrates to nothing, (x, y) times the normal to the area, twice."""
    mesh = join_bodies(plate(kind), LAYERS)
    for name, elements in bodies(mesh).items():
        facets = mesh.boundary_facets()
        own = facets[np.isin(mesh.f2t[0, facets], elements)]
        _, nx, ny, xnx, yny = flux(mesh, own)
        area = areas(mesh)[elements].sum()
        np.testing.assert_allclose(
            [nx, ny, xnx, yny], [0, 0, area, area], atol=10 * ROUND_OFF, err_msg=name
        )


@pytest.mark.parametrize("kind", KINDS)
def test_tags_are_kept(kind):
    before = plate(kind)
    after = join_bodies(before, LAYERS)
    for name in ("clay", "sand", "slab"):
        np.testing.assert_array_equal(after.subdomains[name], before.subdomains[name])
    np.testing.assert_array_equal(
        after.subdomains["base"], np.union1d(before.subdomains["clay"], before.subdomains["sand"])
    )
    for name in ("left", "right", "bottom", "top"):
        np.testing.assert_array_equal(
            middles(after, after.boundaries[name]), middles(before, before.boundaries[name])
        )
        np.testing.assert_allclose(
            flux(after, name), flux(before, name), rtol=ROUND_OFF, atol=ROUND_OFF
        )
    assert set(after.boundaries) == {
        "left",
        "right",
        "bottom",
        "top",
        "base:skin",
        "cover:skin",
        "base|cover",
        "cover|base",
    }


def test_the_mesh_given_is_not_changed():
    mesh = plate(MeshQuad1)
    tags = {**mesh.boundaries, **mesh.subdomains}
    copies = {name: part.copy() for name, part in tags.items()}
    join_bodies(mesh, LAYERS)
    assert list({**mesh.boundaries, **mesh.subdomains}) == list(tags)
    for name, part in tags.items():
        np.testing.assert_array_equal(part, copies[name])


def test_tag_partly_on_an_interface_is_split():
    mesh = plate(MeshQuad1)
    side = np.intersect1d(mesh.t2f[:, mesh.subdomains["sand"]], mesh.boundaries["left"])
    both = np.concatenate((side, mesh.boundaries["skin"][:2]))
    after = join_bodies(mesh.with_boundaries({"drain": both}), LAYERS)
    assert "drain" not in after.boundaries
    np.testing.assert_array_equal(
        middles(after, after.boundaries["base:drain"]), middles(mesh, both)
    )
    np.testing.assert_array_equal(
        middles(after, after.boundaries["cover:drain"]), middles(mesh, mesh.boundaries["skin"][:2])
    )


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("flip", [False, True])
def test_oriented_boundary_within_a_body_keeps_its_side(kind, flip):
    mesh = plate(kind, 8, 8)
    rim = mesh.facets[:, np.concatenate((mesh.boundary_facets(), mesh.boundaries["skin"]))]
    inside = np.flatnonzero(~np.isin(mesh.t, rim).any(axis=0))
    mesh = mesh.with_subdomains({"lens": np.setdiff1d(inside, mesh.subdomains["slab"])})
    mesh = mesh.with_boundaries({"lens": mesh.facets_around("lens", flip=flip)})
    after = join_bodies(mesh, LAYERS)
    assert isinstance(after.boundaries["lens"], OrientedBoundary)
    np.testing.assert_allclose(
        flux(after, "lens"), flux(mesh, "lens"), rtol=ROUND_OFF, atol=ROUND_OFF
    )
    area = areas(mesh)[mesh.subdomains["lens"]].sum()
    np.testing.assert_allclose(
        flux(after, "lens")[3:], -area if flip else area, rtol=10 * ROUND_OFF
    )


def test_orientation_on_the_outer_boundary_is_of_no_effect():
    """scikit-fem's `facets_around(flip=True)` looks at outer facets from an element that does not
    exist.
    """
    mesh = plate(MeshQuad1)
    mesh = mesh.with_boundaries({"rim": mesh.facets_around(np.arange(mesh.nelements), flip=True)})
    after = join_bodies(mesh, LAYERS)
    np.testing.assert_array_equal(
        middles(after, after.boundaries["rim"]), middles(mesh, mesh.boundary_facets())
    )
    assert not after.boundaries["rim"].ori.any()


def test_oriented_boundary_on_an_interface():
    """Around the sand: its lower side stays inside the base, its upper side is split."""
    mesh = plate(MeshTri1)
    mesh = mesh.with_boundaries({"lens": mesh.facets_around("sand")})
    after = join_bodies(mesh, LAYERS)
    mine, theirs = after.boundaries["base:lens"], after.boundaries["cover:lens"]
    assert isinstance(mine, OrientedBoundary) and isinstance(theirs, OrientedBoundary)
    np.testing.assert_allclose(
        flux(after, "base:lens"), flux(mesh, "lens"), rtol=ROUND_OFF, atol=ROUND_OFF
    )
    np.testing.assert_array_equal(np.sort(theirs), np.sort(after.boundaries["cover|base"]))
    assert not theirs.ori.any()


def test_three_bodies_at_a_point():
    mesh = MeshQuad1.init_tensor(np.linspace(-1, 1, 5), np.linspace(-1, 1, 5)).with_subdomains(
        {
            "low": lambda x: x[1] < 0,
            "left": lambda x: (x[1] > 0) & (x[0] < 0),
            "right": lambda x: (x[1] > 0) & (x[0] > 0),
        }
    )
    after = join_bodies(mesh, {name: name for name in ("low", "left", "right")})
    assert np.sum((after.p == 0).all(axis=0)) == 3
    assert (
        after.p.shape[1] == mesh.p.shape[1] + 4 + 2 + 2
    )  # on y = 0, on x = 0, and in the point two more
    assert set(after.boundaries) == {
        "low|left",
        "left|low",
        "low|right",
        "right|low",
        "left|right",
        "right|left",
    }
    assert all(len(facets) == 2 for facets in after.boundaries.values())


@pytest.mark.parametrize("kind", KINDS)
def test_random_bodies(kind):
    """Whatever the shapes: nodes apart, elements in place, every interface facet seen from both
    sides.
    """
    rng = np.random.default_rng(1)
    mesh = plate(kind, 7, 6)
    number = rng.integers(0, 4, mesh.nelements)
    names = ["a", "b", "c", "d"]
    mesh = mesh.with_subdomains({name: np.flatnonzero(number == k) for k, name in enumerate(names)})
    after = join_bodies(mesh, {name: name for name in names})
    np.testing.assert_array_equal(
        after.doflocs[:, after.dofs.element_dofs], mesh.doflocs[:, mesh.dofs.element_dofs]
    )
    owner = np.full(after.doflocs.shape[1], -1)
    owner[after.dofs.element_dofs] = number
    assert (owner[after.dofs.element_dofs] == number).all()

    inner = mesh.f2t[1] >= 0
    sides = number[mesh.f2t]
    count = 0
    for i, a in enumerate(names):
        for j, b in enumerate(names):
            if i == j:
                continue
            facets = after.boundaries[f"{a}|{b}"]
            between = (np.sort(sides, axis=0) == np.sort([[i], [j]], axis=0)).all(axis=0)
            expected = np.flatnonzero(inner & between)
            np.testing.assert_array_equal(middles(after, facets), middles(mesh, expected))
            assert (number[after.f2t[0, facets]] == i).all()
            count += len(facets)
    assert count == 2 * np.sum(inner & (sides[0] != sides[1]))


def test_bodies_already_apart_stay_as_they_are():
    """Coincident but double nodes are not welded, names are not touched; a second call changes
    nothing.
    """
    once = join_bodies(plate(MeshQuad1), LAYERS)
    for again in (join_bodies(once), join_bodies(once, LAYERS)):
        np.testing.assert_array_equal(again.p, once.p)
        np.testing.assert_array_equal(again.t, once.t)
        for tags, expected in (
            (again.boundaries, once.boundaries),
            (again.subdomains, once.subdomains),
        ):
            assert list(tags) == list(expected)
            for name in expected:
                np.testing.assert_array_equal(tags[name], expected[name])


def test_refinement_keeps_bodies_and_tags():
    mesh = join_bodies(plate(MeshQuad1), LAYERS)
    fine = mesh.refined()
    assert {name: len(part) for name, part in bodies(fine).items()} == {"base": 48, "cover": 48}
    np.testing.assert_allclose(flux(fine, "base|cover"), flux(mesh, "base|cover"), rtol=ROUND_OFF)


@pytest.mark.parametrize("kind", KINDS)
def test_several_meshes(kind):
    lower, upper = plate(kind), plate(kind, 5, 2).translated((0.1, 2.0))
    upper = upper.with_boundaries({"skin": OrientedBoundary(upper.boundaries["skin"], np.ones(5))})
    mesh = join_bodies({"base": lower, "block": upper})
    assert type(mesh) is kind
    assert mesh.doflocs.shape[1] == lower.doflocs.shape[1] + upper.doflocs.shape[1]
    np.testing.assert_allclose(
        areas(mesh), np.concatenate((areas(lower), areas(upper))), rtol=ROUND_OFF
    )
    assert {name: len(part) for name, part in bodies(mesh).items()} == {
        "base": lower.nelements,
        "block": upper.nelements,
    }
    for prefix, part, first in (("base", lower, 0), ("block", upper, lower.nelements)):
        np.testing.assert_array_equal(mesh.subdomains[prefix], first + np.arange(part.nelements))
        for name, elements in part.subdomains.items():
            np.testing.assert_array_equal(mesh.subdomains[f"{prefix}:{name}"], first + elements)
        for name in part.boundaries:
            np.testing.assert_allclose(
                flux(mesh, f"{prefix}:{name}"), flux(part, name), rtol=ROUND_OFF, atol=ROUND_OFF
            )
    assert isinstance(mesh.boundaries["block:skin"], OrientedBoundary)
    assert len(mesh.boundaries) == 10 and len(mesh.subdomains) == 8


def test_coincident_meshes_are_not_welded():
    square = MeshQuad1().with_defaults()
    mesh = join_bodies({"one": square, "two": square, "three": square.translated((1, 0))})
    assert mesh.p.shape[1] == 12
    assert list(bodies(mesh)) == ["one", "two", "three"]


def test_triangles_in_any_order():
    """scikit-fem sorts the corners of a triangle, if not told otherwise: sides must not be mixed
    up.
    """
    tidy = plate(MeshTri1)
    untidy = MeshTri1(tidy.p, tidy.t[[2, 0, 1]], tidy.boundaries, tidy.subdomains, sort_t=False)
    for parts in ({"tidy": tidy, "untidy": untidy}, {"untidy": untidy, "tidy": tidy}):
        mesh = join_bodies(parts)
        for name in parts:
            np.testing.assert_array_equal(
                middles(mesh, mesh.boundaries[f"{name}:skin"]),
                middles(tidy, tidy.boundaries["skin"]),
            )
    after = join_bodies(untidy, LAYERS)
    np.testing.assert_array_equal(after.p[:, after.t], untidy.p[:, untidy.t])


def test_free_nodes_and_gmsh_tags_are_dropped():
    mesh = plate(MeshQuad1)
    shifted = MeshQuad1(np.hstack(([[9.0], [9.0]], mesh.p, [[8.0], [8.0]])), mesh.t + 1)
    shifted = shifted.with_subdomains(mesh.subdomains).with_boundaries(mesh.boundaries)
    shifted = shifted.with_subdomains({"gmsh:bounding_entities": np.array([1, 10**6])})
    expected, found = join_bodies(mesh, LAYERS), join_bodies(shifted, LAYERS)
    np.testing.assert_array_equal(found.p, expected.p)
    assert list(found.subdomains) == list(expected.subdomains)
    for name in expected.boundaries:
        np.testing.assert_array_equal(found.boundaries[name], expected.boundaries[name])
    assert join_bodies({"only": shifted}).p.shape == mesh.p.shape
