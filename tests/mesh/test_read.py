"""Gmsh files: what is named in them must arrive."""

from __future__ import annotations

import re

import numpy as np
import pytest
from skfem import Basis, FacetBasis, Mesh, MeshQuad1, MeshQuad2, MeshTri1, MeshTri2

import skfem_contact as sc
from skfem_contact import join_bodies
from skfem_contact.mesh import load_mesh

BODIES = {"inner": "disc", "outer": "plate"}
KINDS = {(1, False): MeshTri1, (1, True): MeshQuad1, (2, False): MeshTri2, (2, True): MeshQuad2}

# Two squares side by side, the curve "middle" between them, a free node first; the numbers of
# groups are used twice.
TWO_SQUARES = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
1 1 "middle"
1 2 "top"
2 1 "west"
2 2 "east"
$EndPhysicalNames
$Nodes
7
1 9 9 0
2 0 0 0
3 1 0 0
4 2 0 0
5 0 1 0
6 1 1 0
7 2 1 0
$EndNodes
$Elements
5
1 1 2 1 1 3 6
2 1 2 2 2 5 6
3 1 2 2 2 6 7
4 3 2 1 1 2 3 6 5
5 3 2 2 2 3 4 7 6
$EndElements
"""


WEST, EAST = "4 3 2 1 1 2 3 6 5\n", "5 3 2 2 2 3 4 7 6"


@pytest.fixture
def write(tmp_path):
    """A function that writes a text to a file."""

    def write(text):
        path = tmp_path / "mesh.msh"
        path.write_text(text)
        return path

    return write


def area(mesh, subdomain):
    return Basis(mesh, mesh.elem(), elements=subdomain).dx.sum()


def length(mesh, boundary):
    return FacetBasis(mesh, mesh.elem(), facets=boundary).dx.sum()


def test_format_2_with_a_curve_between_two_surfaces(write):
    mesh = load_mesh(write(TWO_SQUARES))
    assert type(mesh) is MeshQuad1 and mesh.p.shape == (2, 6)
    assert {name: part.tolist() for name, part in mesh.subdomains.items()} == {
        "west": [0],
        "east": [1],
    }
    assert set(mesh.boundaries) == {"middle", "top"}
    middles = {
        name: mesh.p[:, mesh.facets[:, part]].mean(axis=1) for name, part in mesh.boundaries.items()
    }
    np.testing.assert_array_equal(middles["middle"], [[1], [0.5]])
    np.testing.assert_array_equal(middles["top"], [[0.5, 1.5], [1, 1]])
    apart = join_bodies(mesh, {"west": "west", "east": "east"})
    assert set(apart.boundaries) == {"top", "west:middle", "east:middle", "west|east", "east|west"}


def test_mesh_load_loses_the_curve_between_two_surfaces(write):
    """The reason for load_mesh; should scikit-fem learn it, the docstring must say so."""
    assert "middle" not in Mesh.load(write(TWO_SQUARES)).boundaries


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("1 1 2 1 1 3 6", "1 1 2 1 1 3 5", "1 of 1 lines of curve 'middle'"),
        ("2 1 2 2 2 5 6", "2 1 2 2 2 1 6", "1 of 2 lines of curve 'top'"),
    ],
)
def test_curve_that_is_no_side(write, old, new, message):
    """The first use of any boundary refuses it, by the name of the file, and so do all others."""
    path = write(TWO_SQUARES.replace(old, new))
    mesh = load_mesh(path)
    assert sorted(mesh.boundaries) == ["middle", "top"]
    for name in ("top", "middle", "top"):
        with pytest.raises(
            ValueError, match=f"^{re.escape(str(path))}: {message} are not sides of elements"
        ):
            mesh.boundaries[name]
    with pytest.raises(ValueError, match="are not sides of elements"):
        mesh.refined()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            EAST,
            "5 2 2 2 2 3 4 7",
            "1 quad, 1 triangle; supported is one type.*recombine all surfaces",
        ),
        (WEST + EAST, "4 1 2 1 1 2 3\n5 1 2 1 1 3 4", "no elements; supported is"),
        (WEST + EAST, "4 6 2 1 1 2 3 6 5 4 7\n5 6 2 1 1 3 4 7 6 5 2", "2 wedge; supported is"),
    ],
)
def test_elements_that_are_not_supported(write, old, new, message):
    with pytest.raises(ValueError, match=message):
        load_mesh(write(TWO_SQUARES.replace(old, new)))


def test_files_that_are_no_gmsh_files(write, tmp_path):
    with pytest.raises(ValueError, match=r"mesh.msh: it is not a Gmsh mesh"):
        load_mesh(write("solid\n"))
    with pytest.raises(FileNotFoundError):
        load_mesh(tmp_path / "missing.msh")


def disc_in_plate(path, version, order=1, quads=False, mixed=False, **options):
    """Write a quarter of a disc in a square plate; the disc's centre is a node, the arc is called
    "skin".
    """
    gmsh = pytest.importorskip("gmsh", exc_type=(ImportError, OSError))
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        geo = gmsh.model.geo
        places = ((0, 0), (1, 0), (0, 1), (2, 0), (2, 2), (0, 2))
        centre, a, b, c, d, e = (geo.addPoint(x, y, 0) for x, y in places)
        skin, right = geo.addCircleArc(a, centre, b), geo.addLine(c, d)
        around_disc = [geo.addLine(centre, a), skin, geo.addLine(b, centre)]
        around_plate = [geo.addLine(a, c), right, geo.addLine(d, e), geo.addLine(e, b), -skin]
        disc, plate = (
            geo.addPlaneSurface([geo.addCurveLoop(loop)]) for loop in (around_disc, around_plate)
        )
        geo.synchronize()
        groups = {"skin": (1, skin), "right": (1, right), "disc": (2, disc), "plate": (2, plate)}
        for name, (dimension, entity) in groups.items():
            gmsh.model.addPhysicalGroup(dimension, [entity], name=name)
        for surface in (disc, plate) if quads else (plate,) if mixed else ():
            gmsh.model.mesh.setRecombine(2, surface)
        settings = {"MeshSizeMax": 0.5, "SubdivisionAlgorithm": int(quads), "ElementOrder": order}
        for name, value in {**settings, "MshFileVersion": version, **options}.items():
            gmsh.option.setNumber(f"Mesh.{name}", value)
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return path


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("quads", [False, True])
def test_what_gmsh_writes(tmp_path, version, binary, order, quads):
    mesh = load_mesh(disc_in_plate(tmp_path / "disc.msh", version, order, quads, Binary=binary))
    assert type(mesh) is KINDS[order, quads]
    apart = join_bodies(mesh, BODIES)
    # A chord of a first-order mesh is by a share of h^2/24 shorter than its arc; h is 0.5 and,
    # halved, 0.25 here. A second-order side is off by the order of h^4.
    share = 0.02 if order == 1 else 1e-3
    assert area(apart, "inner") == pytest.approx(np.pi / 4, rel=share)
    assert area(apart, "disc") + area(apart, "plate") == pytest.approx(4.0, rel=1e-12)  # round-off
    assert length(apart, "right") == pytest.approx(2.0, rel=1e-12)
    for name in ("inner:skin", "outer:skin", "inner|outer", "outer|inner"):
        assert length(apart, name) == pytest.approx(np.pi / 2, rel=share)


@pytest.mark.parametrize("quads", [False, True])
def test_mesh_load_agrees_where_it_works(tmp_path, quads):
    path = disc_in_plate(tmp_path / "disc.msh", 4.1, 1, quads)
    ours, theirs = load_mesh(path), Mesh.load(path)
    np.testing.assert_array_equal(ours.p, theirs.p)
    np.testing.assert_array_equal(ours.t, theirs.t)
    for name in ("skin", "right"):
        np.testing.assert_array_equal(ours.boundaries[name], theirs.boundaries[name])
        np.testing.assert_array_equal(ours.boundaries[name].ori, theirs.boundaries[name].ori)
    for name in ("disc", "plate"):
        np.testing.assert_array_equal(ours.subdomains[name], theirs.subdomains[name])


def test_gmsh_meshes_that_are_not_supported(tmp_path):
    path = tmp_path / "disc.msh"
    with pytest.raises(
        ValueError, match=r"\d+ triangle, \d+ quad; .*recombine all surfaces or none"
    ):
        load_mesh(disc_in_plate(path, 4.1, mixed=True))


def test_quadrilaterals_without_a_node_in_the_middle_keep_their_shape(tmp_path):
    """[X] Eight nodes give the same areas, and a node in the middle where the functions put it."""
    path = tmp_path / "disc.msh"
    whole = load_mesh(disc_in_plate(path, 4.1, 2, True))
    mesh = load_mesh(disc_in_plate(path, 4.1, 2, True, SecondOrderIncomplete=1))
    assert type(mesh) is MeshQuad2
    assert mesh.nelements == whole.nelements
    total = area(mesh, "disc") + area(mesh, "plate")
    assert total == pytest.approx(4.0, rel=1e-12)  # round-off
    x = mesh.doflocs[:, mesh.dofs.element_dofs]
    middle = -0.25 * x[:, :4].sum(axis=1) + 0.5 * x[:, 4:8].sum(axis=1)
    np.testing.assert_allclose(x[:, 8], middle, atol=1e-14)


SQUARE = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
2
1 2 2 1 1 1 2 3
2 2 2 1 1 1 3 4
$EndElements
"""


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda s: "".join(
                f"{a} {b} 0 {c}\n"
                if len(p := line.split()) == 4
                and line[0] in "1234"
                and (a := p[0], b := p[1], c := p[2])
                else line + "\n"
                for line in s.splitlines()
            ),
            "x-y plane",
        ),
        (lambda s: s.replace("1 3 4\n", "1 3 9\n"), "out of bounds"),
        (lambda s: s.replace("2 1 0 0", "2 nan 0 0"), "not finite"),
    ],
)
def test_meshes_that_would_be_flattened_or_wrong(tmp_path, change, message):
    """The file is named."""
    file = tmp_path / "some.msh"
    file.write_text(change(SQUARE))
    with pytest.raises(ValueError, match=rf"some.msh: .*{message}"):
        sc.load_mesh(file)


def test_groups_without_names_are_named_by_their_numbers(write):
    """[X] Without $PhysicalNames the groups are there all the same."""
    begin, end = (TWO_SQUARES.index(mark) for mark in ("$PhysicalNames", "$Nodes"))
    mesh = load_mesh(write(TWO_SQUARES[:begin] + TWO_SQUARES[end:]))
    assert sorted(mesh.subdomains) == ["surface 1", "surface 2"]
    assert sorted(mesh.boundaries) == ["curve 1", "curve 2"]
    assert length(mesh, "curve 2") == pytest.approx(2.0)


def test_elements_of_overlapping_groups_are_read_once(write):
    """[X] Format 2.2 repeats the western square for a third group, "all"."""
    text = TWO_SQUARES.replace("PhysicalNames\n4\n", 'PhysicalNames\n5\n2 3 "all"\n')
    text = text.replace("$Elements\n5\n", "$Elements\n7\n")
    text = text.replace(EAST, EAST + "\n6 3 2 3 1 2 3 6 5\n7 3 2 3 2 3 4 7 6")
    mesh = load_mesh(write(text))
    assert mesh.nelements == 2
    assert {name: area(mesh, name) for name in mesh.subdomains} == {
        "west": pytest.approx(1.0),
        "east": pytest.approx(1.0),
        "all": pytest.approx(2.0),
    }


@pytest.mark.parametrize("version", [2.2, 4.1])
def test_parts_of_a_group_with_a_minus_sign_belong_to_it(tmp_path, version):
    """[X] Curves 1 and -2 of one group are 2 long together."""
    gmsh = pytest.importorskip("gmsh", exc_type=(ImportError, OSError))
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        cad = gmsh.model.geo
        p = [cad.addPoint(x, y, 0, 0.5) for x, y in ((0, 0), (1, 0), (2, 0), (2, 1), (0, 1))]
        first, second = cad.addLine(p[0], p[1]), cad.addLine(p[2], p[1])
        others = [cad.addLine(p[k], p[(k + 1) % 5]) for k in (2, 3, 4)]
        soil = cad.addPlaneSurface([cad.addCurveLoop([first, -second, *others])])
        cad.synchronize()
        gmsh.model.addPhysicalGroup(2, [soil], name="soil")
        gmsh.model.addPhysicalGroup(1, [first, -second], name="bottom")
        gmsh.model.mesh.generate(2)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.write(str(tmp_path / "signs.msh"))
    finally:
        gmsh.finalize()
    assert length(load_mesh(tmp_path / "signs.msh"), "bottom") == pytest.approx(2.0)
