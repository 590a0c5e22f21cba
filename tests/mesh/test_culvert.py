"""The mesh of the culvert that comes with the package."""

from __future__ import annotations

import runpy
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from skfem import Basis, FacetBasis, Mesh

from skfem_contact.mesh import bodies, join_bodies, load_mesh

DATA = files("skfem_contact") / "data"
SCRIPT = Path(__file__).parents[2] / "examples" / "6_tunnels_and_pipes" / "make_culvert.py"
BODIES = {"ground": ["soft", "stiff"], "culvert": "culvert"}
INNER, OUTER = 0.72, 0.90
DIGITS = 1e-6  # the coordinates in the file are rounded to six digits


@pytest.fixture(scope="module")
def mesh():
    return join_bodies(load_mesh(DATA / "culvert.msh"), BODIES)


def make(path, **options):
    """Run the script that makes the mesh."""
    pytest.importorskip("gmsh", exc_type=(ImportError, OSError))
    runpy.run_path(str(SCRIPT))["make_culvert"](str(path), **options)
    return load_mesh(path)


def scaled_jacobian(mesh):
    """The sine of the smallest corner angle of every quadrilateral."""
    x = mesh.p[:, mesh.t]
    after, before = np.roll(x, -1, axis=1) - x, np.roll(x, 1, axis=1) - x
    cross = after[0] * before[1] - after[1] * before[0]
    sine = cross / np.linalg.norm(after, axis=0) / np.linalg.norm(before, axis=0)
    return (sine * np.sign(sine[0])).min(axis=0)


def rows(x):
    """Points as a set."""
    return {tuple(point) for point in x.T.tolist()}


def corner_sets(x):
    """Elements or facets as a set of sets of points."""
    return {frozenset(rows(corners)) for corners in x.transpose(2, 0, 1)}


def test_size(mesh):
    assert (DATA / "culvert.msh").stat().st_size < 300_000
    assert 1500 <= mesh.nelements <= 3500
    assert {name: len(part) for name, part in bodies(mesh).items()} == {
        "culvert": 288,
        "ground": 1722,
    }
    through_the_wall = len(mesh.subdomains["culvert"]) / len(mesh.boundaries["culvert|ground"])
    assert through_the_wall == 4


def test_names(mesh):
    assert set(mesh.subdomains) == {"soft", "stiff", "culvert", "ground"}
    assert set(mesh.boundaries) == {
        "bottom",
        "left",
        "right",
        "surface",
        "culvert_inner",
        "ground:skin",
        "culvert:skin",
        "ground|culvert",
        "culvert|ground",
        "soft|culvert",
        "stiff|culvert",
    }
    with_mesh_load = join_bodies(Mesh.load(DATA / "culvert.msh"), BODIES)
    for name, facets in mesh.boundaries.items():
        np.testing.assert_array_equal(with_mesh_load.boundaries[name], facets)


def test_mirror_image_to_the_last_digit(mesh):
    assert rows(mesh.p * [[-1], [1]]) == rows(mesh.p)
    for part in mesh.subdomains.values():
        cells = mesh.p[:, mesh.t[:, part]]
        assert corner_sets(cells * [[[-1]], [[1]]]) == corner_sets(cells)
    image = {"left": "right", "right": "left"}
    for name, part in mesh.boundaries.items():
        partner = mesh.boundaries[image.get(name, name)]
        sides, mirrored = mesh.p[:, mesh.facets[:, part]], mesh.p[:, mesh.facets[:, partner]]
        assert corner_sets(mirrored * [[[-1]], [[1]]]) == corner_sets(sides)


def test_geometry(mesh):
    def length(name):
        return FacetBasis(mesh, mesh.elem(), facets=name).dx.sum()

    def area(name):
        return Basis(mesh, mesh.elem(), elements=name).dx.sum()

    def polygon(radius, n=72):
        return 0.5 * n * np.sin(2 * np.pi / n) * radius**2

    assert length("left") == pytest.approx(8.0, abs=DIGITS)
    assert length("right") == pytest.approx(8.0, abs=DIGITS)
    assert length("bottom") == pytest.approx(12.0, abs=DIGITS)
    assert length("surface") == pytest.approx(12.0, abs=DIGITS)
    assert area("culvert") == pytest.approx(polygon(OUTER) - polygon(INNER), abs=10 * DIGITS)
    assert area("soft") == pytest.approx(12 * 3.5 - polygon(OUTER) / 2, abs=10 * DIGITS)
    assert area("stiff") == pytest.approx(12 * 4.5 - polygon(OUTER) / 2, abs=10 * DIGITS)
    for name, radius in (
        ("culvert|ground", OUTER),
        ("ground|culvert", OUTER),
        ("culvert_inner", INNER),
    ):
        nodes = np.unique(mesh.facets[:, np.asarray(mesh.boundaries[name])])
        assert len(nodes) == 72
        np.testing.assert_allclose(np.hypot(*mesh.p[:, nodes]), radius, atol=DIGITS)
    assert mesh.p[1, mesh.t[:, mesh.subdomains["soft"]]].min() == 0.0
    assert mesh.p[1, mesh.t[:, mesh.subdomains["stiff"]]].max() == 0.0


def test_an_element_ends_where_the_strip_load_does(mesh):
    nodes = np.unique(mesh.facets[:, np.asarray(mesh.boundaries["surface"])])
    assert np.sum((mesh.p[0, nodes] == -1.0) & (mesh.p[1, nodes] == 3.5)) == 1


def test_quality(mesh):
    """No corner sharper than 40 degrees; elements at the skin about square."""
    assert scaled_jacobian(mesh).min() > np.sin(np.deg2rad(40))
    sides = np.linalg.norm(np.diff(mesh.p[:, mesh.facets], axis=1)[:, 0], axis=0)[mesh.t2f]
    at_skin = mesh.f2t[0, np.asarray(mesh.boundaries["ground|culvert"])]
    aspect = sides.max(axis=0) / sides.min(axis=0)
    assert aspect[at_skin].max() < 2.5
    assert aspect.max() < 6


def test_the_script_makes_this_mesh(tmp_path, mesh):
    again = join_bodies(make(tmp_path / "culvert.msh"), BODIES)
    assert again.t.shape == mesh.t.shape
    # Releases of Gmsh may number differently and end up on the other side of a rounding.
    order, expected = (np.lexsort(np.round(m.p, 5)) for m in (again, mesh))
    np.testing.assert_allclose(again.p[:, order], mesh.p[:, expected], atol=2 * DIGITS)


def test_meshed_apart(tmp_path):
    mesh = join_bodies(make(tmp_path / "apart.msh", ring=48, hole=40))
    assert len(bodies(mesh)) == 2
    assert rows(mesh.p * [[-1], [1]]) == rows(mesh.p)
    for name, count in (("hole", 40), ("culvert_outer", 48)):
        facets = np.asarray(mesh.boundaries[name])
        assert len(facets) == count
        assert (mesh.f2t[1, facets] == -1).all()
        np.testing.assert_allclose(np.hypot(*mesh.p[:, mesh.facets[:, facets]]), OUTER, atol=DIGITS)
