"""The names of bodies, and what is said when they make no sense."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshQuad, MeshQuad1, MeshTri1

from skfem_contact.mesh import bodies, join_bodies

LAYERS = {"base": ["clay", "sand"], "cover": "slab"}


def plate():
    """A plate in three layers: 6 elements of clay, 6 of sand, 12 of a slab."""
    return (
        MeshQuad1.init_tensor(np.linspace(0, 3, 7), np.linspace(0, 2, 5))
        .with_defaults()
        .with_subdomains(
            {
                "clay": lambda x: x[1] < 0.5,
                "sand": lambda x: (x[1] > 0.5) & (x[1] < 1),
                "slab": lambda x: x[1] > 1,
            }
        )
    )


def test_names_of_bodies():
    square = MeshQuad1()
    named = square.with_subdomains({"pile": np.array([0])})
    mesh = join_bodies({"soil": square.refined(), "left": named, "right": named.translated((3, 0))})
    piles = np.concatenate((mesh.subdomains["left"], mesh.subdomains["right"]))
    mesh = mesh.with_subdomains({"piles": piles, "wet": np.array([0])})
    nameless = MeshQuad1(mesh.p, mesh.t)
    assert list(bodies(nameless)) == ["body 1", "body 2", "body 3"]
    only_piles = nameless.with_subdomains({"pile": piles})
    assert list(bodies(only_piles)) == ["body", "pile 1", "pile 2"]
    layered = nameless.with_subdomains({"clay": np.array([0, 1]), "sand": np.array([2, 3])})
    assert list(bodies(layered)) == ["clay+sand", "body 1", "body 2"]
    assert list(bodies(mesh)) == ["soil", "left:pile", "right:pile"]


@pytest.mark.parametrize(
    ("groups", "message"),
    [
        ({"a": "clay", "b": "rock"}, "no subdomain 'rock'; existing: clay, sand, slab"),
        ({"a": ["clay", "sand"]}, "12 elements belong to no body.*: slab"),
        (
            {"a": ["clay", "sand"], "b": ["sand", "slab"]},
            "6 elements belong both to 'a' and to 'b'",
        ),
        ({"clay": ["clay", "sand"], "b": "slab"}, "body 'clay' is not the subdomain 'clay'"),
        ({"a": [], "b": ["clay", "sand", "slab"]}, "body 'a' has no elements"),
        ({}, "24 elements belong to no body"),
        (None, "one connected body.*existing: clay, sand, slab"),
    ],
)
def test_bodies_that_make_no_sense(groups, message):
    with pytest.raises(ValueError, match=message):
        join_bodies(plate(), groups)


def test_names_that_collide():
    mesh = plate()
    with pytest.raises(ValueError, match=r"'base\|cover' is not unique"):
        join_bodies(mesh.with_boundaries({"base|cover": mesh.boundaries["left"]}), LAYERS)
    square = MeshQuad1().with_subdomains({"b": np.array([0])})
    with pytest.raises(ValueError, match="'a:b' is not unique"):
        join_bodies({"a": square, "a:b": MeshQuad1()})


def test_meshes_that_cannot_be_joined():
    with pytest.raises(ValueError, match=r"different types.*'a': MeshQuad1, 'b': MeshTri1"):
        join_bodies({"a": MeshQuad1(), "b": MeshTri1()})
    with pytest.raises(ValueError, match="no mesh"):
        join_bodies({})
    with pytest.raises(ValueError, match="bodies= is for a single mesh"):
        join_bodies({"a": MeshQuad1()}, bodies={"a": "clay"})
    with pytest.raises(ValueError, match="mesh must be a Mesh or a dictionary"):
        join_bodies([MeshQuad1(), MeshTri1()])
    untagged = MeshQuad1().refined()
    with pytest.raises(ValueError, match="existing: none at all"):
        join_bodies(untagged)
    with pytest.raises(ValueError, match="no subdomain 'soil'; existing: none at all"):
        join_bodies(untagged, {"a": "soil"})


def test_sides_of_subdomains_are_named_beside_those_of_bodies():
    """The side of a body of two layers, and that of each layer; the facets of the layers are those
    of the body.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 3, 4), np.linspace(0, 2, 3)).with_subdomains(
        {
            "lower": lambda x: (x[1] < 1) & (x[0] < 2),
            "upper": lambda x: (x[1] > 1) & (x[0] < 2),
            "concrete": lambda x: x[0] > 2,
        }
    )
    joined = join_bodies(mesh, bodies={"ground": ["lower", "upper"], "wall": "concrete"})
    assert set(joined.boundaries) == {"ground|wall", "wall|ground", "lower|wall", "upper|wall"}
    parts = [joined.boundaries["lower|wall"], joined.boundaries["upper|wall"]]
    np.testing.assert_array_equal(
        np.sort(np.concatenate(parts)), np.sort(joined.boundaries["ground|wall"])
    )
    heights = [joined.p[1, joined.facets[:, np.asarray(part)]].mean() for part in parts]
    np.testing.assert_allclose(heights, (0.5, 1.5))
