"""Every format, plane and in space, of both orders: names, areas, volumes and lengths arrive.

The files are made by Gmsh, by meshio, or as text of the format's own manual.
"""

from __future__ import annotations

import itertools
import re
from importlib import resources
from importlib.util import find_spec

import meshio
import numpy as np
import pytest
from skfem import Basis, FacetBasis, MeshHex, MeshQuad, MeshTet

import skfem_contact as sc
from skfem_contact.errors import AnalysisWarning
from skfem_contact.mesh import check_mesh, load_mesh, save_mesh
from skfem_contact.mesh.formats import abaqus, kratos, med, nastran
from skfem_contact.mesh.formats import gmsh as own_gmsh
from skfem_contact.mesh.formats.abaqus import _kind_of
from skfem_contact.mesh.kinds import BY_NODES, KINDS, N_NODES, UPRIGHT_FIRST, signed_size

FILE = resources.files("skfem_contact") / "data" / "culvert.msh"
gmsh = pytest.importorskip("gmsh", exc_type=(ImportError, OSError))

FORMATS = ("msh 2.2", "msh 4.1", "inp", "vtu", "med", "mdpa", "f3grid")
NAMES = ("areas", "sides", "overlapping", "unnamed")
#: Two boxes, x from 0 to 1 and from 1 to 3, 1 high (and 1 deep): sizes of their groups.
GROUPS = {
    "areas": ({"west": 1.0, "east": 2.0}, {}),
    "sides": ({"west": 1.0, "east": 2.0}, {"bottom": 3.0, "middle": 1.0}),
    "overlapping": ({"west": 1.0, "east": 2.0, "all of it": 3.0}, {"bottom": 3.0, "rim": 4.0}),
    "unnamed": ({}, {}),
}
WORDS = {2: ("surface", "curve"), 3: ("volume", "surface")}


def size_of(mesh, name):
    """Area or volume of a subdomain."""
    return Basis(mesh, mesh.elem(), elements=name, intorder=4).dx.sum()


def side_of(mesh, name):
    """Length or area of a boundary with straight sides.

    The diagonals of a quadrilateral, whose corners are in no order, have the largest product.
    """
    x = mesh.p[:, mesh.facets[:, mesh.boundaries[name]]].transpose(1, 2, 0)
    if len(x) == 2:
        return np.linalg.norm(x[1] - x[0], axis=1).sum()
    if len(x) == 3:
        return 0.5 * np.linalg.norm(np.cross(x[1] - x[0], x[2] - x[0]), axis=1).sum()
    pairs = ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2))
    products = [np.linalg.norm(np.cross(x[b] - x[a], x[d] - x[c]), axis=1) for a, b, c, d in pairs]
    return 0.5 * np.max(products, axis=0).sum()


def boxes(dim, order, kind, hexahedra=False):
    """Build the model in Gmsh; return the tags of its groups by dimension and name."""
    cad = gmsh.model.occ
    if dim == 2:
        boxes = [cad.addRectangle(0, 0, 0, 1, 1), cad.addRectangle(1, 0, 0, 2, 1)]
    else:
        boxes = [cad.addBox(0, 0, 0, 1, 1, 1), cad.addBox(1, 0, 0, 2, 1, 1)]
    (west, east), _ = cad.fragment([(dim, boxes[0])], [(dim, boxes[1])])[0], None
    cad.synchronize()
    sides = {"bottom": [], "middle": [], "rim": []}
    for _, tag in gmsh.model.getEntities(dim - 1):
        x, y, z = cad.getCenterOfMass(dim - 1, tag)
        low = y if dim == 2 else z
        if low < 1e-9:
            sides["bottom"].append(tag)
        if abs(x - 1.0) < 1e-9:
            sides["middle"].append(tag)
        if low < 1e-9 or abs(x - 3.0) < 1e-9:
            sides["rim"].append(tag)
    areas = {"west": [west[1]], "east": [east[1]], "all of it": [west[1], east[1]]}
    wanted_areas, wanted_sides = GROUPS[kind]
    for name in wanted_areas:
        gmsh.model.addPhysicalGroup(dim, areas[name], name=name)
    for name in wanted_sides:
        gmsh.model.addPhysicalGroup(dim - 1, sides[name], name=name)
    if kind == "unnamed":
        gmsh.model.addPhysicalGroup(dim, areas["west"], 7)
        gmsh.model.addPhysicalGroup(dim, areas["east"], 8)
        gmsh.model.addPhysicalGroup(dim - 1, sides["bottom"], 9)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.9)
    gmsh.option.setNumber("Mesh.ElementOrder", order)
    if hexahedra:
        for _, curve in gmsh.model.getEntities(1):
            gmsh.model.mesh.setTransfiniteCurve(curve, 3)
        for _, surface in gmsh.model.getEntities(2):
            gmsh.model.mesh.setTransfiniteSurface(surface)
            gmsh.model.mesh.setRecombine(2, surface)
        for _, volume in gmsh.model.getEntities(3):
            gmsh.model.mesh.setTransfiniteVolume(volume)
    gmsh.model.mesh.generate(dim)


@pytest.fixture
def model():
    """Run Gmsh for one test."""
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    yield gmsh
    gmsh.finalize()


def as_meshio(path, gmsh):
    """The present mesh of Gmsh through its format 4.1, and its groups as masks of cells."""
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.write(str(path / "between.msh"))
    file = meshio.read(path / "between.msh")
    groups = {}
    for name, parts in file.cell_sets.items():
        if not name.startswith("gmsh:"):
            groups[name] = [
                np.isin(np.arange(len(block.data)), [] if part is None else part).astype(np.int8)
                for block, part in zip(file.cells, parts)
            ]
    return file.points, [(block.type, block.data) for block in file.cells], groups


def write_vtu(path, points, cells, groups):
    """Masks of cells as data."""
    used = [k for k, (kind, _) in enumerate(cells) if kind != "vertex"]
    data = {name: [masks[k] for k in used] for name, masks in groups.items()}
    meshio.Mesh(points, [cells[k] for k in used], cell_data=data).write(path, file_format="vtu")


def write_mdpa(path, points, cells, groups):
    """Elements, conditions, and a sub-model part for every group, as Kratos' manual has them."""
    dim = max(KINDS[kind].dim for kind, _ in cells)
    text = "Begin ModelPartData\nEnd ModelPartData\nBegin Properties 1 // soil\nEnd Properties\n"
    text += "Begin Nodes\n"
    for number, x in enumerate(points.tolist(), start=1):
        text += f"  {number} {x[0]!r} {x[1]!r} {x[2]!r}\n"
    text += "End Nodes\n"
    ids = []
    counts = {"Elements": 0, "Conditions": 0}
    for kind, nodes in cells:
        word = "Elements" if KINDS[kind].dim == dim else "Conditions"
        ids.append((word, counts[word] + 1 + np.arange(len(nodes))))
        if KINDS[kind].dim < dim - 1:
            continue
        shape = "" if word == "Elements" else ("Line" if dim == 2 else "Surface")
        text += f"Begin {word} {shape}{word[:-1]}{dim}D{nodes.shape[1]}N\n"
        if kind == "hexahedron27":  # upright edges before upper ones; sides from below to above
            upright = [16, 17, 18, 19]
            faces = [24, 22, 21, 23, 20, 25]  # below, front, right, back, left, above
            nodes = nodes[:, [*range(12), *upright, 12, 13, 14, 15, *faces, 26]]
        for row in nodes.tolist():
            counts[word] += 1
            text += f"{counts[word]} 1 {' '.join(str(node + 1) for node in row)}\n"
        text += f"End {word}\n"
    text += "Begin SubModelPart everything\n"
    for name, masks in groups.items():
        text += f"  Begin SubModelPart {name.replace(' ', '_')}\n"
        for (word, numbers), mask in zip(ids, masks):
            members = numbers[mask == 1]
            if len(members):
                text += f"    Begin SubModelPart{word}\n"
                text += "".join(f"      {number}\n" for number in members)
                text += f"    End SubModelPart{word}\n"
        text += "  End SubModelPart\n"
    path.write_text(text + "End SubModelPart\n")


def write_f3grid(path, points, cells, groups):
    """Tetrahedra, faces and groups in slots, as FLAC3D exports them."""
    text = "* FLAC3D grid produced by a test\n"
    for number, x in enumerate(points.tolist(), start=1):
        text += f"G {number} {x[0]!r} {x[1]!r} {x[2]!r}\n"
    letters = {"tetra": ("Z", "T4"), "triangle": ("F", "T3")}
    ids = []
    counts = {"Z": 0, "F": 0}
    for kind, nodes in cells:
        letter, word = letters.get(kind, ("", ""))
        first = counts.get(letter, 0) + 1
        ids.append((letter, first + np.arange(len(nodes))))
        for row in nodes.tolist() if letter else ():
            counts[letter] += 1
            text += f"{letter} {word} {counts[letter]} {' '.join(str(n + 1) for n in row)}\n"
    for slot, (name, masks) in enumerate(groups.items(), start=1):
        for (letter, numbers), mask in zip(ids, masks):
            if letter and mask.any():
                text += f'{letter}GROUP "{name}" SLOT {slot}\n'
                text += " ".join(map(str, numbers[mask == 1])) + "\n"
    path.write_text(text)


def made(path, gmsh, form, dim):
    """Write the present mesh of Gmsh in a format; None where the format has no such mesh."""
    if form.startswith("msh"):
        gmsh.option.setNumber("Mesh.MshFileVersion", float(form[4:]))
        gmsh.write(str(path / "boxes.msh"))
        return path / "boxes.msh"
    if form == "med":
        pytest.importorskip("h5py")
    file = path / f"boxes.{form}"
    if form in ("inp", "med"):
        gmsh.option.setNumber("Mesh.SaveGroupsOfElements", 1)
        gmsh.write(str(file))
        return file
    points, cells, groups = as_meshio(path, gmsh)
    if form == "f3grid" and (dim == 2 or cells[-1][0] != "tetra"):
        return None
    {"vtu": write_vtu, "mdpa": write_mdpa, "f3grid": write_f3grid}[form](
        file, points, cells, groups
    )
    return file


@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.one_in(2)
def test_names_and_sizes_of_every_format(tmp_path, model, form, dim, order, names):
    """[X] Areas, volumes and lengths of two boxes, to round-off of coordinates of 17 digits."""
    boxes(dim, order, names)
    path = made(tmp_path, model, form, dim)
    if path is None:
        pytest.skip("FLAC3D has zones of first order in space alone")
    mesh = load_mesh(path)
    check_mesh(mesh)
    total = Basis(mesh, mesh.elem(), intorder=4).dx.sum()
    assert total == pytest.approx(3.0, rel=1e-12)
    areas, sides = GROUPS[names]
    if names == "unnamed":
        # Formats without names have numbers; the others had no group to write
        found = {name: size_of(mesh, name) for name in mesh.subdomains or {}}
        if form.startswith("msh"):
            assert found == {
                f"{WORDS[dim][0]} 7": pytest.approx(1.0, rel=1e-12),
                f"{WORDS[dim][0]} 8": pytest.approx(2.0, rel=1e-12),
            }
            assert side_of(mesh, f"{WORDS[dim][1]} 9") == pytest.approx(3.0, rel=1e-12)
        return
    known = own_names(mesh, form)
    for name, size in areas.items():
        assert size_of(mesh, known[name]) == pytest.approx(size, rel=1e-12)
    for name, size in sides.items():
        assert side_of(mesh, known[name]) == pytest.approx(size, rel=1e-12)


def own_names(mesh, form):
    """Names of the mesh by the names of the model."""
    names = {*(mesh.subdomains or {}), *(mesh.boundaries or {})}
    known = {name: name for name in names}
    if form == "mdpa":  # parts of a part, without blanks
        known = {name.rpartition(".")[2].replace("_", " "): name for name in names}
    if form == "inp":  # Gmsh writes names without blanks
        known |= {name.replace("_", " "): name for name in names}
    return known


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("form", FORMATS)
def test_quadrilaterals_and_hexahedra(tmp_path, model, form, dim, order):
    """[X] The same boxes with four and eight corners."""
    boxes(dim, order, "sides", hexahedra=True)
    if form == "f3grid":
        return
    path = made(tmp_path, model, form, dim)
    mesh = load_mesh(path)
    assert len(mesh.t) == (4 if dim == 2 else 8)
    known = own_names(mesh, form)
    for name, size in GROUPS["sides"][0].items():
        assert size_of(mesh, known[name]) == pytest.approx(size, rel=1e-12)
    for name, size in GROUPS["sides"][1].items():
        assert side_of(mesh, known[name]) == pytest.approx(size, rel=1e-12)


ENDS = [".msh", ".inp", ".vtu", ".mdpa", ".f3grid"]
if find_spec("h5py"):
    ENDS.append(".med")


@pytest.mark.parametrize("hexahedra", [False, True])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("dim", [2, 3])
def test_saved_meshes_come_back(tmp_path, model, dim, order, hexahedra):
    """[X] The same nodes, names and directions of sides from every format that is written."""
    boxes(dim, order, "overlapping", hexahedra)
    model.option.setNumber("Mesh.MshFileVersion", 4.1)
    model.write(str(tmp_path / "boxes.msh"))
    mesh = load_mesh(tmp_path / "boxes.msh")
    mesh = renamed(mesh, {"all of it": "all:of:it"})
    for end in ENDS:
        path = tmp_path / f"again{end}"
        if end == ".f3grid" and (dim == 2 or order == 2):
            with pytest.raises(ValueError, match="zones of first order in space"):
                save_mesh(mesh, path)
            continue
        save_mesh(mesh, path)
        again = load_mesh(path)
        assert type(again) is type(mesh)
        assert set(again.subdomains) == set(mesh.subdomains)
        assert set(again.boundaries) == set(mesh.boundaries)
        for name in mesh.subdomains:
            assert size_of(again, name) == pytest.approx(size_of(mesh, name), rel=1e-12)
        for name in mesh.boundaries:
            assert side_of(again, name) == pytest.approx(side_of(mesh, name), rel=1e-12)
            assert (again.boundaries[name].ori == 0).all()  # outer sides


def renamed(mesh, names):
    """A mesh whose subdomains have other names."""
    mesh._subdomains = {names.get(name, name): part for name, part in mesh.subdomains.items()}
    return mesh


def test_gmsh_reads_what_is_saved(tmp_path, model):
    """[N] Gmsh's own reader has the groups and volumes of a saved mesh of second order."""
    boxes(3, 2, "overlapping", hexahedra=True)
    model.option.setNumber("Mesh.MshFileVersion", 4.1)
    model.write(str(tmp_path / "boxes.msh"))
    save_mesh(load_mesh(tmp_path / "boxes.msh"), tmp_path / "saved.msh")
    model.clear()
    model.merge(str(tmp_path / "saved.msh"))
    groups = {}
    for dim, tag in model.model.getPhysicalGroups():
        name = model.model.getPhysicalName(dim, tag)
        measure = 0.0
        for entity in model.model.getEntitiesForPhysicalGroup(dim, tag):
            kinds, numbers, _ = model.model.mesh.getElements(dim, entity)
            for kind, of_kind in zip(kinds, numbers):
                points, weights = model.model.mesh.getIntegrationPoints(kind, "Gauss4")
                determinants = model.model.mesh.getJacobians(kind, points, entity)[1]
                by_element = determinants.reshape(len(of_kind), -1)
                assert dim < 3 or by_element.min() > 0.0
                measure += (np.abs(by_element) @ weights).sum()
        groups[name] = measure
    areas, sides = GROUPS["overlapping"]
    assert groups == {
        name: pytest.approx(size, rel=1e-9) for name, size in {**areas, **sides}.items()
    }


@pytest.mark.parametrize("end", [".msh", ".inp", ".mdpa", ".f3grid"])
def test_texts_are_read_in_pieces(tmp_path, monkeypatch, end):
    """[X] Pieces of a few lines give what the whole text gives."""
    from skfem import MeshTet1

    line = np.linspace(0, 1, 4)
    mesh = MeshTet1.init_tensor(line, line, line).with_defaults()
    save_mesh(mesh.with_subdomains({"low": lambda x: x[2] < 0.5}), tmp_path / f"cube{end}")
    whole = load_mesh(tmp_path / f"cube{end}")
    monkeypatch.setattr("skfem_contact.mesh.content._PIECE", 50)
    again = load_mesh(tmp_path / f"cube{end}")
    np.testing.assert_array_equal(again.p, whole.p)
    np.testing.assert_array_equal(again.t, whole.t)
    for name, facets in whole.boundaries.items():
        np.testing.assert_array_equal(again.boundaries[name], facets)
    np.testing.assert_array_equal(again.subdomains["low"], whole.subdomains["low"])


def test_numbers_without_room_in_four_bytes(tmp_path):
    """[X] Nodes are numbered from four thousand millions on."""
    first = 4 * 10**9
    text = "*NODE\n" + "".join(
        f"{first + k}, {x}, {y}, 0\n" for k, (x, y) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1)))
    )
    nodes = ", ".join(str(first + k) for k in range(4))
    (tmp_path / "far.inp").write_text(f"{text}*ELEMENT, TYPE=CPE4, ELSET=soil\n1, {nodes}\n")
    mesh = load_mesh(tmp_path / "far.inp")
    assert size_of(mesh, "soil") == pytest.approx(1.0, rel=1e-12)
    wrong = nodes.replace(str(first), "1")
    (tmp_path / "far.inp").write_text(f"{text}*ELEMENT, TYPE=CPE4, ELSET=soil\n1, {wrong}\n")
    with pytest.raises(ValueError, match=r"far.inp: node 1 does not exist, 1 in all"):
        load_mesh(tmp_path / "far.inp")


@pytest.mark.parametrize("end", ENDS)
def test_names_of_joined_bodies(tmp_path, end):
    """[X] Both sides of an interface, with colons and bars in their names."""
    line = np.linspace(0, 1, 4)
    from skfem import MeshHex1

    cube = MeshHex1.init_tensor(line, line, line).with_defaults()
    cube = cube.with_subdomains({"low": lambda x: x[2] < 0.5, "high": lambda x: x[2] > 0.5})
    mesh = sc.join_bodies(cube, {"low": "low", "high": "high"})
    if end == ".mdpa":
        with pytest.raises(ValueError, match="names in Kratos"):
            save_mesh(renamed(mesh, {"low": "soft clay"}), tmp_path / "cubes.mdpa")
        return
    save_mesh(mesh, tmp_path / f"cubes{end}")
    again = load_mesh(tmp_path / f"cubes{end}")
    assert set(again.boundaries) == set(mesh.boundaries)
    sizes = {name: side_of(again, name) for name in again.boundaries}
    assert sizes == {name: pytest.approx(side_of(mesh, name)) for name in mesh.boundaries}
    assert again.nvertices == mesh.nvertices  # not welded


SPLIT = {
    "wedge": [[0, 1, 2, 6, 7, 8], [0, 2, 3, 6, 8, 9]],
    "pyramid": [[6, 7, 8, 9, 10]],
    "hexahedron": [[1, 4, 5, 2, 7, 11, 12, 8]],
}


def test_wedges_pyramids_and_hexahedra_are_split(tmp_path):
    """[X] A cube of two wedges, a pyramid above and a cube beside it: tetrahedra that conform."""
    p = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]]
    p += [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [0.5, 0.5, 2], [2, 0, 1], [2, 1, 1]]
    cells = [*SPLIT.items(), ("quad", [[0, 1, 2, 3], [1, 4, 5, 2]]), ("triangle", [[6, 7, 10]])]
    data = {
        "tip": [[0, 0], [1], [0], [0, 0], [0]],
        "block": [[0, 0], [0], [1], [0, 0], [0]],
        "floor": [[0, 0], [0], [0], [1, 1], [0]],
        "roof": [[0, 0], [0], [0], [0, 0], [1]],
    }
    data = {name: [np.array(part, dtype=np.int8) for part in parts] for name, parts in data.items()}
    file = tmp_path / "mixed.vtu"
    cells = [(kind, np.array(nodes)) for kind, nodes in cells]
    meshio.Mesh(np.array(p, float), cells, cell_data=data).write(file)
    with pytest.raises(ValueError, match=r"2 wedge, 1 pyramid, 1 hexahedron; .*split=True divides"):
        load_mesh(file)
    mesh = load_mesh(file, split=True)
    assert mesh.nelements == 3 + 3 + 2 + 6
    check_mesh(mesh)
    total = Basis(mesh, mesh.elem()).dx.sum()
    assert total == pytest.approx(2.0 + 1 / 3, rel=1e-12)
    assert size_of(mesh, "tip") == pytest.approx(1 / 3, rel=1e-12)
    assert size_of(mesh, "block") == pytest.approx(1.0, rel=1e-12)
    assert side_of(mesh, "floor") == pytest.approx(2.0, rel=1e-12)
    assert side_of(mesh, "roof") == pytest.approx(np.sqrt(5) / 4, rel=1e-12)
    # Every inner side has two tetrahedra: the outside has the area of the shape
    outside = FacetBasis(mesh, mesh.elem()).dx.sum()
    assert outside == pytest.approx(9.0 + 4 * np.sqrt(5) / 4, rel=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_mixed_triangles_and_quadrilaterals_are_split(tmp_path, model, order):
    """[X] A plate with a quadrilateral part: sizes and names stay."""
    boxes(2, order, "sides")
    model.mesh = model.model.mesh
    model.model.mesh.clear()
    model.model.mesh.setRecombine(2, model.model.getEntities(2)[0][1])
    model.model.mesh.generate(2)
    model.option.setNumber("Mesh.MshFileVersion", 4.1)
    model.write(str(tmp_path / "mixed.msh"))
    with pytest.raises(ValueError, match="split=True"):
        load_mesh(tmp_path / "mixed.msh")
    mesh = load_mesh(tmp_path / "mixed.msh", split=True)
    check_mesh(mesh)
    for name, size in GROUPS["sides"][0].items():
        assert size_of(mesh, name) == pytest.approx(size, rel=1e-12)
    for name, size in GROUPS["sides"][1].items():
        assert side_of(mesh, name) == pytest.approx(size, rel=1e-12)


def test_random_grids_are_split_into_conforming_tetrahedra(tmp_path):
    """[X] A grid of hexahedra numbered at random: volume, and the area of the outside."""
    line = np.linspace(0, 1, 4)
    from skfem import MeshHex1

    cube = MeshHex1.init_tensor(line, line, line)
    order_of = np.random.default_rng(5).permutation(cube.nvertices)
    points = np.empty((cube.nvertices, 3))
    points[order_of] = cube.p.T
    from skfem.io.meshio import HEX_MAPPING

    nodes = order_of[cube.t[HEX_MAPPING[:8]].T]
    wedges = np.concatenate((nodes[:5, [0, 1, 2, 4, 5, 6]], nodes[:5, [0, 2, 3, 4, 6, 7]]))
    file = tmp_path / "grid.vtu"
    meshio.Mesh(points, [("hexahedron", nodes[5:]), ("wedge", wedges)]).write(file)
    mesh = load_mesh(file, split=True)
    check_mesh(mesh)
    assert Basis(mesh, mesh.elem()).dx.sum() == pytest.approx(1.0, rel=1e-12)
    assert FacetBasis(mesh, mesh.elem()).dx.sum() == pytest.approx(6.0, rel=1e-12)


def test_sections_in_other_planes_and_units(tmp_path):
    """[X] A section drawn in x-z in millimetres."""
    p = np.array([[0, 0, 0], [2000, 0, 0], [2000, 0, 1000], [0, 0, 1000.0]])
    file = tmp_path / "section.vtu"
    meshio.Mesh(p, [("quad", np.array([[0, 1, 2, 3]]))]).write(file)
    with pytest.raises(ValueError, match=r"section.vtu: .*x-y plane: pass plane='xz'"):
        load_mesh(file)
    mesh = load_mesh(file, plane="xz", factor=1e-3)
    assert Basis(mesh, mesh.elem()).dx.sum() == pytest.approx(2.0, rel=1e-12)
    np.testing.assert_allclose(mesh.p.max(axis=1), [2.0, 1.0])
    with pytest.raises(ValueError, match="plane must be one of 'xy'"):
        load_mesh(file, plane="zx")
    with pytest.raises(ValueError, match="factor must be"):
        load_mesh(file, factor=0.0)


DECK = """** a deck of two instances
*Part, name=Block
*Node
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*Element, type=CPE4R, elset=Soil
7, 1, 2, 3, 4
*Nset, nset=Base
1, 2
*Elset, elset=All, generate
1, 9, 2
*Surface, name=Top, type=ELEMENT
Soil, S3
*End Part
*Assembly, name=Assembly
*Instance, name=Left, part=Block
*End Instance
*Instance, name=Right, part=Block
3., 0., 0.
3., 0., 0., 3., 0., 1., 90.
*End Instance
*Nset, nset=Foot, instance=Left
1,
2
*Elset, elset=Pair
LEFT.Soil, right.soil
*End Assembly
*Material, name=Sand
*Elastic
1e4, 0.3
*Step
*Node print, nset=Foot
U
*End Step
"""


def test_instances_of_a_deck(tmp_path):
    """[X] The second of two instances is moved by 3, then turned by 90 degrees about (3, 0)."""
    file = tmp_path / "deck.inp"
    file.write_text(DECK)
    mesh = load_mesh(file)
    assert mesh.nelements == 2
    assert set(mesh.subdomains) >= {"Left", "Right", "Soil", "All", "Pair", "Left.Soil"}
    assert size_of(mesh, "Soil") == pytest.approx(2.0)
    assert size_of(mesh, "Right") == pytest.approx(1.0)
    assert size_of(mesh, "Pair") == pytest.approx(2.0)
    assert side_of(mesh, "Foot") == pytest.approx(1.0)
    # The top of the second is its left side, at x = 2
    middles = mesh.p[:, mesh.facets[:, mesh.boundaries["Top"]]].mean(axis=1)
    np.testing.assert_allclose(np.sort(middles, axis=1), [[0.5, 2.0], [0.5, 1.0]], atol=1e-12)


def test_numbers_of_instances_and_unions_of_surfaces(tmp_path):
    """[X] "Instance.number" names nodes and elements of an assembly; a surface joins others."""
    file = tmp_path / "deck.inp"
    more = (
        "*Nset, nset=Foot of both\nLeft.1, left.2, RIGHT.1, RIGHT.2\n"
        "*Surface, name=One\nRight.7, S1\n*Surface, name=Two\nLeft.7, S1\nLeft.7, S2\n"
        "*Surface, name=Three, combine=union\nOne, Two\n*End Assembly"
    )
    file.write_text(DECK.replace("*End Assembly", more, 1))
    mesh = load_mesh(file)
    for name, length in (("Foot of both", 2.0), ("One", 1.0), ("Two", 2.0), ("Three", 3.0)):
        assert side_of(mesh, name) == pytest.approx(length)
    middles = mesh.p[:, mesh.facets[:, mesh.boundaries["One"]]].mean(axis=1)
    np.testing.assert_allclose(middles.ravel(), [3.0, 0.5], atol=1e-12)
    # Other combinations are refused, and so are parts that are not placed.
    file.write_text(DECK.replace("*End Assembly", more.replace("=union", "=difference"), 1))
    with pytest.raises(ValueError, match="'Three' is made by COMBINE=DIFFERENCE, which is not"):
        load_mesh(file)
    file.write_text(DECK.split("*Assembly", 1)[0])
    with pytest.raises(ValueError, match=r"its parts BLOCK have no \*INSTANCE: add one"):
        load_mesh(file)


def test_elements_of_a_deck_that_are_not_in_the_mesh(tmp_path):
    """[X] Springs, masses and connectors are told with their sets; cohesive ones are refused."""
    file = tmp_path / "deck.inp"
    more = "*ELEMENT, TYPE=SPRINGA, ELSET=anchors\n8, 1, 5\n*ELEMENT, TYPE=CONN3D2\n9, 1, 5\n"
    file.write_text(PIECES + more)
    with pytest.warns(sc.AnalysisWarning, match="elements CONN3D2, elements SPRINGA of 'anchors'"):
        assert load_mesh(file).nelements == 2
    file.write_text(PIECES + "*ELEMENT, TYPE=COH3D6, ELSET=joint\n8, 1, 2, 3, 1, 2, 3\n")
    with pytest.raises(ValueError, match="type COH3D6 are not read: delete their lines, or export"):
        load_mesh(file)


def test_internal_sets_of_surfaces_are_no_names(tmp_path):
    """[X] Abaqus/CAE writes the elements of a surface as a set that nobody named."""
    file = tmp_path / "deck.inp"
    surface = (
        "*Elset, elset=_Top_S3, internal, instance=Left\n7,\n"
        "*Surface, type=ELEMENT, name=Roof\n_Top_S3, S3\n*End Assembly"
    )
    assert "*End Assembly" in DECK
    file.write_text(DECK.replace("*End Assembly", surface, 1))
    mesh = load_mesh(file)
    assert side_of(mesh, "Roof") == pytest.approx(1.0)
    assert not [name for name in mesh.subdomains if "_Top_S3" in name]
    # Likewise in a part, whose sets have the name of the instance before them
    inside = "*Elset, elset=_E_S1, internal\n7,\n*Surface, name=Under\n_E_S1, S1\n*End Part"
    file.write_text(DECK.replace("*End Part", inside, 1))
    mesh = load_mesh(file)
    assert side_of(mesh, "Under") == pytest.approx(2.0)
    assert not [name for name in mesh.subdomains if "_E_S1" in name]


PIECES = """*NODE, NSET=NALL
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
5, 1, 1, 1
*ELEMENT, TYPE=C3D4, ELSET=EALL
1, 1, 2, 3, 4
2, 5, 2, 3, 4
*SURFACE, NAME=S
1, S1
EALL, S3
"""


def test_faces_of_tetrahedra_in_a_deck(tmp_path):
    """[X] Face 1 is 1-2-3, face 3 is 2-4-3 (of both elements one side); NALL is no boundary."""
    file = tmp_path / "deck.inp"
    file.write_text(PIECES)
    mesh = load_mesh(file)
    assert side_of(mesh, "S") == pytest.approx(0.5 + 2 * np.sqrt(3) / 2)
    assert list(mesh.boundaries) == ["S"]
    file.write_text(PIECES.replace("*SURFACE", "*NGEN\n1,2\n*SURFACE"))
    with pytest.raises(ValueError, match=r"deck.inp: it makes nodes or elements by \*NGEN"):
        load_mesh(file)
    file.write_text(PIECES.replace("EALL, S3", "OTHER, S3"))
    with pytest.raises(ValueError, match="names the set 'OTHER', which does not exist"):
        load_mesh(file)


def test_included_files(tmp_path):
    """[X] A deck that includes the file of its mesh."""
    (tmp_path / "mesh.inc").write_text(PIECES)
    (tmp_path / "deck.inp").write_text("*HEADING\n*INCLUDE, INPUT=mesh.inc\n*NODE PRINT\n*NODE\n")
    assert load_mesh(tmp_path / "deck.inp").nelements == 2
    (tmp_path / "mesh.inc").write_text("*INCLUDE, INPUT=mesh.inc\n*NODE\n")
    with pytest.raises(ValueError, match="nested more than"):
        load_mesh(tmp_path / "deck.inp")


def small(*fields):
    """A line with fields of eight columns."""
    return "".join(f"{field:<8}" for field in fields).rstrip() + "\n"


BULK = (
    '$HMNAME COMP                   3"clay"\nBEGIN BULK\n'
    + small("GRID", 1, "", "0.0", "0.0", "0.0")
    + "GRID,2,,1.0,0.0,0.0\n"
    + f"{'GRID*':<8}{3:<16}{'':<16}{'1.0':<16}{'1.0':<16}\n{'*':<8}{'0.0':<16}\n"
    + small("GRID", 4, "", "0.", "1.+0", "0.")
    + small("GRID", 5, "", "2.", "0.", "0.")
    + small("GRID", 6, "", "20.-1", "1.0E0", "0.")
    + small("CQUAD4", 1, 3, 1, 2, 3, 4)
    + "CQUAD4,2,4,2,5,6,3\nENDDATA\n"
)


def test_bulk_data_of_nastran(tmp_path):
    """[X] Free, small and large fields; properties with and without names."""
    file = tmp_path / "bulk.bdf"
    file.write_text(BULK)
    mesh = load_mesh(file)
    assert {name: size_of(mesh, name) for name in mesh.subdomains} == {
        "clay": pytest.approx(1.0),
        "property 4": pytest.approx(1.0),
    }
    file.write_text(BULK.replace("GRID,2,,", "GRID,2,5,"))
    with pytest.raises(ValueError, match="coordinates of the system 5"):
        load_mesh(file)


@pytest.mark.parametrize(
    ("comments", "names"),
    [
        ("$ Femap with NX Nastran Property 2 : stiff clay \nPSOLID,2,1\n", ["stiff clay"]),
        ("$ FEMAP Property 2 : clay\n$ FEMAP Property 3 : sand\n", ["clay", "sand"]),
        ("$ Femap Property 2 : Untitled\n$ Femap Property 3 : Untitled\n", ["Untitled 2"]),
        ("$ANSA_NAME_COMMENT;2;MAT1;other;;NO;\n$ANSA_NAME_COMMENT;2;PSOLID;clay;;NO;\n", ["clay"]),
        (
            "$ Elements and Element Properties for region : clay\nPSOLID   2       1\n"
            "$ Elements and Element Properties for region : sand\n$ more\nPSOLID*  3\n",
            ["clay", "sand"],
        ),
        ("$*  Property: clay\nPSOLID   2       1\n", ["clay", "property 3"]),
        ('$HMNAME PROP 2"solid"\n$HMNAME COMP 2"clay"\n', ["clay"]),
    ],
)
def test_names_of_properties_of_nastran(tmp_path, comments, names):
    """[X] Names in the comments of preprocessors; the same name of two is never one group."""
    file = tmp_path / "one.bdf"
    points = "".join(f"GRID,{i},,{x},0.,0.\n" for i, x in enumerate((0.0, 1.0, 2.0), start=1))
    points += "".join(f"GRID,{i},,{x},1.,0.\n" for i, x in enumerate((0.0, 1.0, 2.0), start=4))
    cells = "CQUAD4,1,2,1,2,5,4\nCQUAD4,2,3,2,3,6,5\n"
    file.write_text(f"BEGIN BULK\n{comments}{points}{cells}ENDDATA\n")
    mesh = load_mesh(file)
    assert len(mesh.subdomains) == 2
    assert set(names) <= set(mesh.subdomains)


def test_second_order_of_gmsh_in_bulk_data(tmp_path, model):
    """[X] CHEXA of 27 nodes, and CQUAD9 as lines of their own, are not of Nastran."""
    box = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [box])
    gmsh.model.addPhysicalGroup(2, [1])
    gmsh.model.mesh.setTransfiniteAutomatic()
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    file = str(tmp_path / "bulk.bdf")
    gmsh.write(file)
    with pytest.raises(ValueError, match=r"has more than 20 nodes.*SecondOrderIncomplete = 1"):
        load_mesh(file)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    gmsh.model.mesh.setOrder(1)
    gmsh.model.mesh.setOrder(2)
    gmsh.write(file)
    mesh = load_mesh(file)
    assert size_of(mesh, "property 1") == pytest.approx(1.0)
    text = (tmp_path / "bulk.bdf").read_text().replace("CQUAD8 ", "CQUAD9 ")
    (tmp_path / "bulk.bdf").write_text(text)
    with pytest.warns(sc.AnalysisWarning, match=r"left out of the mesh.* elements CQUAD9"):
        assert load_mesh(file).boundaries is None


@pytest.mark.parametrize("dtype", ["<i4", "<i8", ">i4", ">i8"])
@pytest.mark.parametrize("compression", [None, "gzip"])
def test_med_files_store_numbers_in_several_ways(tmp_path, dtype, compression):
    """[X] The same mesh from data sets of 4 and 8 bytes, of either order, whole and compressed."""
    h5py = pytest.importorskip("h5py")
    cube = MeshTet().refined(2)
    top = cube.facets_satisfying(lambda x: x[2] == 1.0)
    west = cube.elements_satisfying(lambda x: x[0] < 0.5)
    cube = cube.with_subdomains({"west": west}).with_boundaries({"top": top})
    path = tmp_path / "cube.med"
    save_mesh(cube, path)
    first = load_mesh(path)
    with h5py.File(path, "r+") as file:
        (step,) = file["ENS_MAA/mesh"].values()
        for name in ("MAI/TE4/NOD", "MAI/TE4/FAM", "MAI/TR3/NOD", "MAI/TR3/FAM"):
            values = step[name][()].astype(dtype)
            number = step[name].attrs["NBR"]
            del step[name]
            step.create_dataset(name, data=values, compression=compression).attrs["NBR"] = number
    mesh = load_mesh(path)
    np.testing.assert_array_equal(mesh.t, first.t)
    np.testing.assert_array_equal(np.sort(mesh.t, axis=0), np.sort(cube.t, axis=0))
    np.testing.assert_array_equal(mesh.p, cube.p)
    np.testing.assert_array_equal(mesh.subdomains["west"], np.sort(west))
    np.testing.assert_array_equal(np.sort(mesh.boundaries["top"]), np.sort(top))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (np.full(4, 9), "tetra has the node 9 of 4: the number is out of bounds"),
        (np.array([1, 2, 3, 0]), "tetra has the node 0 of 4: the number is out of bounds"),
        (np.array([1, 2, 3, 2**40]), "tetra has the node 1099511627776 of 4: the number is out"),
        (np.array([1.0, 2.0, 3.0, 4.0]), "the nodes of a tetra are no whole numbers"),
        (np.array([1, 2, 3]), "3 numbers of nodes for 1 tetra, which have 4 each"),
        (np.array([1, 2, 3, 4, 1]), "5 numbers of nodes for 1 tetra, which have 4 each"),
    ],
)
def test_med_files_with_wrong_nodes(tmp_path, values, message):
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "one.med"
    save_mesh(MeshTet.init_tensor(*[[0.0, 1.0]] * 3), path)
    with h5py.File(path, "r+") as file:
        (step,) = file["ENS_MAA/mesh"].values()
        del step["MAI/TE4/NOD"], step["MAI/TE4/FAM"], step["NOE/COO"]
        step["NOE/COO"] = np.eye(3, 4).ravel()
        step["MAI/TE4"].create_dataset("NOD", data=values).attrs["NBR"] = 1
    with pytest.raises(ValueError, match=rf"one.med: .*{message}"):
        load_mesh(path)


PLATE = "1,0.,0.\n2,1.,0.\n3,1.,1.\n4,0.,1.\n5,2.,0.\n6,2.,1.\n"
TWO = "*ELEMENT, TYPE=CPE4, ELSET=soil\n1, 1,2,3,4\n2, 2,5,6,3\n"


@pytest.mark.parametrize(
    "nodes",
    [
        "1,,\n2,1.,\n3,1.,1.\n4,,1.\n5,2.,0.\n6,2.,1.\n",
        "1, , 0.\n2,1.\n3,1.,1.,0.\n4, ,1.,\n5,2.\n\n6,2.,1.,,\n",
    ],
)
def test_coordinates_that_abaqus_may_leave_out_are_zero(tmp_path, nodes):
    """[X] Blank ones and ones at the end of a line."""
    (tmp_path / "a.inp").write_text(f"*NODE\n{nodes}{TWO}")
    mesh = load_mesh(tmp_path / "a.inp")
    np.testing.assert_array_equal(mesh.p.T, [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]])
    (tmp_path / "a.inp").write_text(f"*NODE\n{nodes.replace('2,1.', '2 1.')}{TWO}")
    with pytest.raises(ValueError, match=r"blanks between numbers: '2 1.,?'"):
        load_mesh(tmp_path / "a.inp")


def test_lines_of_abaqus_in_files_of_their_own(tmp_path):
    """[X] Nodes and elements by INPUT, and the nodes of a set of elements."""
    (tmp_path / "nodes.txt").write_text("** far away\n" + PLATE)
    (tmp_path / "more.txt").write_text("2, 2,5,6,3\n")
    text = "*NODE, INPUT=nodes.txt\n*ELEMENT, TYPE=CPE4, ELSET=soil, INPUT=more.txt\n1, 1,2,3,4\n"
    text += "*ELSET, ELSET=first\n1\n*NSET, NSET=around, ELSET=first\n"
    (tmp_path / "a.inp").write_text(text)
    mesh = load_mesh(tmp_path / "a.inp")
    assert size_of(mesh, "soil") == pytest.approx(2.0)
    assert side_of(mesh, "around") == pytest.approx(3.0)
    (tmp_path / "a.inp").write_text(text.replace("ELSET=first\n1", "ELSET=other\n1"))
    with pytest.raises(ValueError, match="the set 'first' does not exist"):
        load_mesh(tmp_path / "a.inp")
    (tmp_path / "a.inp").write_text(text.replace("more.txt", "none.txt"))
    with pytest.raises(ValueError, match=r"it includes the file .*none.txt, which does not exist"):
        load_mesh(tmp_path / "a.inp")
    (tmp_path / "a.inp").write_text(f"*NODE, SYSTEM=C\n{PLATE}{TWO}")
    with pytest.raises(ValueError, match="SYSTEM=C are not in Cartesian coordinates"):
        load_mesh(tmp_path / "a.inp")


GRIDS = "GRID,1,,0.,0.,0.\nGRID*,2,,1.,0.,*G2\n*G2,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\n"


def test_nastran_files_that_include_others(tmp_path):
    """[X] Half of a plate in another file; systems by default and repeated cards are refused."""
    (tmp_path / "east.bdf").write_text("GRID,5,,2.,0.,0.\nGRID,6,,2.,1.,0.\nCQUAD4,2,1,2,5,6,3\n")
    text = f"BEGIN BULK\n{GRIDS}CQUAD4,1,1,1,2,3,4\nINCLUDE 'east.bdf'\nENDDATA\n"
    path = tmp_path / "plate.bdf"
    path.write_text(text)
    assert size_of(load_mesh(path), "property 1") == pytest.approx(2.0)
    for line, message in (
        ("INCLUDE 'west.bdf'", "it includes the file .*west.bdf, which does not exist"),
        ("INCLUDE plate.bdf", "INCLUDE are nested more than 8 times"),
        ("GRDSET,,5", "GRDSET gives coordinates of the system 5; only the basic system is read"),
        ("=,*(1),==", "repeats cards by '=', which is not read"),
    ):
        path.write_text(text.replace("INCLUDE 'east.bdf'", line))
        with pytest.raises(ValueError, match=message):
            load_mesh(path)


def test_joints_of_kratos_are_left_out(tmp_path):
    """[X] A joint without width between two squares has no area."""
    text = "Begin Nodes\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 2 1 0\n7 1 0 0\n8 1 1 0\n"
    text += "End Nodes\nBegin Elements UPwSmallStrainElement2D4N\n1 1 1 2 3 4\n2 1 7 5 6 8\n"
    text += "End Elements\nBegin Elements UPwSmallStrainInterfaceElement2D4N\n3 2 2 7 8 3\n"
    (tmp_path / "joint.mdpa").write_text(text + "End Elements\n")
    with pytest.warns(sc.AnalysisWarning, match="1 elements UPwSmallStrainInterfaceElement2D4N"):
        mesh = load_mesh(tmp_path / "joint.mdpa")
    assert mesh.nelements == 2


def test_vtk_files_of_several_pieces_are_refused(tmp_path):
    """Of two pieces meshio reads the last one alone."""
    mesh = meshio.Mesh(np.eye(3), [("triangle", np.array([[0, 1, 2]]))])
    mesh.write(tmp_path / "pieces.vtu", binary=False)
    text = (tmp_path / "pieces.vtu").read_text()
    begin, end = text.index("<Piece"), text.index("</Piece>") + len("</Piece>")
    (tmp_path / "pieces.vtu").write_text(text[:end] + text[begin:end] + text[end:])
    with pytest.raises(ValueError, match=r"2 cells, but 1 can be read: .* several pieces"):
        load_mesh(tmp_path / "pieces.vtu")


def test_med_files_with_a_head_and_with_families_in_other_letters(tmp_path):
    """[X] Data sets behind a block of the user, and a family named in the letters of Windows."""
    h5py = pytest.importorskip("h5py")
    cube = MeshTet().refined(1).with_subdomains({"west": lambda x: x[0] < 0.5})
    path = tmp_path / "cube.med"
    save_mesh(cube, path)
    moved = tmp_path / "moved.med"
    with h5py.File(path) as source, h5py.File(moved, "w", userblock_size=512) as file:
        for name in source:
            source.copy(name, file)
        families = file["FAS/mesh/ELEME"]
        (family,) = families
        families.id.links.move(family.encode(), families.id, "sürface".encode("cp1252"))
    for name in (path, moved):
        mesh = load_mesh(name)
        np.testing.assert_array_equal(mesh.p, cube.p)
        np.testing.assert_array_equal(mesh.subdomains["west"], cube.subdomains["west"])


@pytest.mark.parametrize("end", [".msh", ".inp", ".mdpa", ".f3grid"])
def test_texts_of_editors_on_windows(tmp_path, end):
    """[X] Ends of lines with two bytes, a mark before the first letter, and letters of Windows."""
    names = {"Böden": lambda x: x[0] < 0.5, "Bäden": lambda x: x[0] > 0.5}
    cube = MeshTet.init_tensor(*[[0.0, 0.5, 1.0]] * 3).with_subdomains(names)
    path = tmp_path / f"cube{end}"
    save_mesh(cube, path)
    lines = path.read_text(encoding="utf-8").replace("\n", "\r\n")
    for text in (lines.encode("utf-8-sig"), lines.encode("cp1252")):
        path.write_bytes(text)
        mesh = load_mesh(path)
        assert {name: size_of(mesh, name) for name in mesh.subdomains} == pytest.approx(
            {"Böden": 0.5, "Bäden": 0.5}, rel=1e-12
        )


def test_med_files_with_damaged_links(tmp_path):
    """Changed bytes give a mesh, or one sentence with the name of the file."""
    pytest.importorskip("h5py")
    path = tmp_path / "one.med"
    cube = MeshTet.init_tensor(*[[0.0, 1.0]] * 3).with_subdomains({"soil": lambda x: x[0] < 2})
    save_mesh(cube, path)
    whole = path.read_bytes()
    refused = 0
    for position in np.random.default_rng(2).integers(0, 4000, 150):
        path.write_bytes(whole[:position] + b"\x9e\x9e" + whole[position + 2 :])
        try:
            load_mesh(path)
        except ValueError as error:
            refused += "one.med" in str(error)
    assert refused > 20


@pytest.mark.parametrize("end", [".vtu", ".msh", ".med"])
def test_names_of_all_letters(tmp_path, end):
    """[X] Characters that XML keeps for itself, blanks, commas and letters with accents."""
    names = [
        "shaft & tip",
        "a<b>c",
        "'quoted'",
        "Sohle, weich",
        "\u00e9tan\u00e7on",
        "p|q",
        "x:y",
        "a-b",
    ]
    if end == ".vtu":
        names.append('"double"')
    mesh = MeshQuad().refined(1)
    mesh = mesh.with_subdomains({name: np.array([0]) for name in names})
    mesh = mesh.with_boundaries({f"{name} side": np.array([0]) for name in names})
    save_mesh(mesh, tmp_path / f"names{end}")
    again = load_mesh(tmp_path / f"names{end}")
    assert sorted(again.subdomains) == sorted(names)
    assert sorted(again.boundaries) == sorted(f"{name} side" for name in names)


VOXEL = """<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="12" NumberOfCells="2"><Points>
<DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 2 0 0 2 1 0 2 0 1 2 1 1
</DataArray></Points><Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">
0 1 2 3 4 5 6 7 {nodes}
</DataArray><DataArray type="Int64" Name="offsets" format="ascii">8 16</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">12 {kind}</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>
"""


def test_voxels_are_not_left_out_of_files_of_vtk(tmp_path):
    """[X] Of a hexahedron and a voxel meshio reads the first one alone."""
    path = tmp_path / "two.vtu"
    path.write_text(VOXEL.format(nodes="1 8 9 2 5 10 11 6", kind=12))
    mesh = load_mesh(path)
    assert Basis(mesh, mesh.elem()).dx.sum() == pytest.approx(2.0, rel=1e-12)
    path.write_text(VOXEL.format(nodes="1 8 2 9 5 10 6 11", kind=11))
    with pytest.raises(ValueError, match=r"two.vtu: it announces 2 cells, but 1 can be .*voxels"):
        load_mesh(path)


def test_regions_of_gmsh_in_files_of_vtk(tmp_path, model):
    """[X] Gmsh writes the numbers of groups as data of cells in one column."""
    gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
    gmsh.model.occ.addRectangle(1, 0, 0, 2, 1)
    gmsh.model.occ.fragment([(2, 1)], [(2, 2)])
    gmsh.model.occ.synchronize()
    for dim, entity in (*gmsh.model.getEntities(2), *gmsh.model.getEntities(1)):
        gmsh.model.addPhysicalGroup(dim, [entity])
    gmsh.model.mesh.generate(2)
    gmsh.write(str(tmp_path / "mesh.vtk"))
    mesh = load_mesh(tmp_path / "mesh.vtk")
    sizes = sorted(size_of(mesh, name) for name in mesh.subdomains)
    np.testing.assert_allclose(sizes, [1.0, 2.0])
    assert len(mesh.boundaries) == 7
    assert all(name.startswith("CellEntityIds ") for name in mesh.boundaries)
    # meshio reads a file that ends within the types of its cells in part
    text = (tmp_path / "mesh.vtk").read_text().partition("CELL_DATA")[0]
    (tmp_path / "short.vtk").write_text(text.rstrip()[:-20])
    with pytest.raises(ValueError, match=r"short.vtk: it announces \d+ cells.*not complete"):
        load_mesh(tmp_path / "short.vtk")


@pytest.mark.parametrize("corners", [True, False])
def test_hexahedra_of_nastran_with_a_blank_continuation(tmp_path, corners):
    """[X] Eight nodes over two lines, the second of which begins with blanks."""
    line = "".join(
        f"GRID    {n:>8}        {x:8.1f}{y:8.1f}{z:8.1f}\n"
        for n, (z, y, x) in enumerate(itertools.product((0, 1), repeat=3), start=1)
    )
    line += "CHEXA          1       1       1       2       4       3       5       6\n"
    line += "               8       7\n"
    file = tmp_path / "bulk.nas"
    file.write_text("BEGIN BULK\n" + line + "ENDDATA\n")
    mesh = load_mesh(file)
    assert size_of(mesh, "property 1") == pytest.approx(1.0)


@pytest.mark.parametrize("kind", ["partitions", "save all", "parametric", "binary", "centre"])
@pytest.mark.parametrize("version", [2.2, 4.1])
def test_settings_of_gmsh(tmp_path, model, kind, version):
    """[X] Partitions, all elements, parametric nodes, binary numbers and nodes of no element."""
    boxes(2, 1, "sides")
    if kind == "partitions":
        model.model.mesh.partition(3)
    if kind == "centre":
        model.model.mesh.addNodes(0, model.model.addDiscreteEntity(0, 999), [9999], [5, 5, 5])
    model.option.setNumber("Mesh.SaveAll", kind == "save all")
    model.option.setNumber("Mesh.SaveParametric", kind == "parametric")
    model.option.setNumber("Mesh.Binary", kind == "binary")
    model.option.setNumber("Mesh.MshFileVersion", version)
    model.write(str(tmp_path / "boxes.msh"))
    if (kind, version) == ("parametric", 2.2):
        with pytest.raises(ValueError, match="SaveParametric = 0"):
            load_mesh(tmp_path / "boxes.msh")
        return
    mesh = load_mesh(tmp_path / "boxes.msh")
    assert Basis(mesh, mesh.elem()).dx.sum() == pytest.approx(3.0, rel=1e-12)
    check_mesh(mesh)
    if (kind, version) != ("save all", 2.2):  # where every tag is zero
        assert size_of(mesh, "west") == pytest.approx(1.0, rel=1e-12)
        assert side_of(mesh, "bottom") == pytest.approx(3.0, rel=1e-12)


@pytest.mark.parametrize("binary", [0, 1])
def test_files_of_single_partitions_are_refused(tmp_path, model, binary):
    """[X] One file of all partitions has the whole area, files of one partition a part of it."""
    gmsh.model.occ.addRectangle(0.0, 0.0, 0.0, 2.0, 1.0)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [1], name="plate")
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.partition(2)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.write(str(tmp_path / "all.msh"))
    assert size_of(load_mesh(tmp_path / "all.msh"), "plate") == pytest.approx(2.0, rel=1e-12)
    gmsh.option.setNumber("Mesh.PartitionSplitMeshFiles", 1)
    gmsh.write(str(tmp_path / "part.msh"))
    gmsh.option.setNumber("Mesh.PartitionSplitMeshFiles", 0)
    gmsh.option.setNumber("Mesh.Binary", 0)
    for number in (1, 2):
        with pytest.raises(ValueError, match=f"it has partition {number} of 2 alone: in Gmsh, set"):
            load_mesh(tmp_path / f"part_{number}.msh")


@pytest.mark.parametrize("ghosts", [0, 1])
@pytest.mark.parametrize("binary", [0, 1])
def test_single_partitions_of_format_22(tmp_path, model, binary, ghosts):
    """[X] The second partition is refused, the first one where ghosts name the second; else it may
    be all.
    """
    gmsh.model.occ.addRectangle(0.0, 0.0, 0.0, 2.0, 1.0)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(2, [1], name="plate")
    gmsh.model.mesh.generate(2)
    options = {"PartitionCreateGhostCells": ghosts, "MshFileVersion": 2.2, "Binary": binary}
    for name, value in options.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    gmsh.model.mesh.partition(2)
    gmsh.write(str(tmp_path / "all.msh"))
    gmsh.option.setNumber("Mesh.PartitionSplitMeshFiles", 1)
    gmsh.write(str(tmp_path / "part.msh"))
    for name, value in {"PartitionSplitMeshFiles": 0, "PartitionCreateGhostCells": 0}.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)

    assert size_of(load_mesh(tmp_path / "all.msh"), "plate") == pytest.approx(2.0, rel=1e-12)
    with pytest.raises(ValueError, match="it has partition 2 of at least 2 alone: in Gmsh, set"):
        load_mesh(tmp_path / "part_2.msh")
    if ghosts:
        with pytest.raises(ValueError, match="it has partition 1 of at least 2 alone"):
            load_mesh(tmp_path / "part_1.msh")
    else:
        with pytest.warns(AnalysisWarning, match="may be a part of the mesh"):
            load_mesh(tmp_path / "part_1.msh")


@pytest.mark.parametrize("end", ["vtu", "vtk"])
def test_joined_sets_that_cover_all_cells(tmp_path, end):
    """[X] Sets that meshio joins without a rest keep both names; masks with a hyphen stay masks."""
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]], float)
    cells = [("quad", np.array([[0, 1, 4, 3], [1, 2, 5, 4]]))]
    sets = {"clay": [np.array([0])], "sand": [np.array([1])]}
    meshio.Mesh(points, cells, cell_sets=sets).write(tmp_path / f"sets.{end}")
    with pytest.warns(AnalysisWarning, match="is read as the sets 'clay' and 'sand'"):
        mesh = load_mesh(tmp_path / f"sets.{end}")
    assert {name: len(part) for name, part in mesh.subdomains.items()} == {"clay": 1, "sand": 1}

    mask = {"clay-core": [np.array([0, 1], np.int8)]}
    meshio.Mesh(points, cells, cell_data=mask).write(tmp_path / "mask.vtu")
    assert set(load_mesh(tmp_path / "mask.vtu").subdomains) == {"clay-core"}


def test_med_with_steps_or_other_coordinates(tmp_path):
    """[X] The first step of a mesh that moves is read, with a warning; cylindrical coordinates are
    refused.
    """
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "mesh.med"
    mesh = MeshQuad()
    save_mesh(mesh, path)
    with h5py.File(path, "r+") as file:
        (steps,) = file["ENS_MAA"].values()
        (first,) = steps
        steps.copy(first, "0000000000000000001-0000000000000000001")
        steps["0000000000000000001-0000000000000000001/NOE/COO"][...] += 1.0
    with pytest.warns(AnalysisWarning, match="has 2 steps in time"):
        assert load_mesh(path).p.max() == mesh.p.max()
    with h5py.File(path, "r+") as file:
        next(iter(file["ENS_MAA"].values())).attrs["REP"] = 1
    with pytest.raises(ValueError, match="has cylindrical coordinates"):
        load_mesh(path)


def test_a_curve_and_a_surface_of_one_name(tmp_path, model):
    """[X] Both are kept: subdomains and boundaries have names of their own."""
    boxes(2, 1, "unnamed")
    for dim in (1, 2):
        for _, tag in model.model.getPhysicalGroups(dim):
            model.model.setPhysicalName(dim, tag, f"part {tag % 7}")
    model.write(str(tmp_path / "boxes.msh"))
    mesh = load_mesh(tmp_path / "boxes.msh")
    assert set(mesh.subdomains) == {"part 0", "part 1"}
    assert set(mesh.boundaries) == {"part 2"}


@pytest.mark.parametrize("end", ENDS)
def test_damaged_files(tmp_path, end):
    """[X] Cut anywhere, empty, or of another kind: one sentence with the name of the file."""
    from skfem import MeshTet1

    line = np.linspace(0, 1, 3)
    mesh = MeshTet1.init_tensor(line, line, line).with_boundaries({"base": lambda x: x[2] == 0})
    file = tmp_path / f"whole{end}"
    save_mesh(mesh.with_subdomains({"soil": lambda x: x[0] < 2}), file)
    data = file.read_bytes()
    broken = tmp_path / f"broken{end}"
    for share in (0.0, 0.02, 0.2, 0.5, 0.7, 0.9):
        broken.write_bytes(data[: int(share * len(data))])
        try:
            got = load_mesh(broken)
        except ValueError as error:
            assert f"broken{end}" in str(error)
            assert len(str(error)) < 500
        else:  # cut within the names: elements are complete
            assert got.nelements == mesh.nelements
    broken.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 20)
    with pytest.raises(ValueError, match=f"broken{end}"):
        load_mesh(broken)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted((file.name, broken.name))


def test_other_versions_and_lies(tmp_path):
    """[X] Gmsh's 4.0, and a file that announces more than it has."""
    file = tmp_path / "old.msh"
    file.write_text("$MeshFormat\n4.0 0 8\n$EndMeshFormat\n")
    with pytest.raises(ValueError, match=r"old.msh: it has the Gmsh format 4.0; .*MshFileVersion"):
        load_mesh(file)
    text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n1 0 0 0\n$EndNodes\n"
    file.write_text(text.format(10**15) + "$Elements\n1\n1 15 0 1\n$EndElements\n")
    with pytest.raises(ValueError, match=r"old.msh: .*announces 10+ entries"):
        load_mesh(file)
    with pytest.raises(ValueError, match=r"path must be the name of a file that ends with .msh, "):
        load_mesh(tmp_path / "mesh.xyz")
    with pytest.raises(ValueError, match=r"ends with .msh, .inp, .*, not '.*mesh.xyz'"):
        save_mesh(load_mesh(FILE), tmp_path / "mesh.xyz")


def test_points_and_lines_that_are_left_out_are_told(tmp_path, model):
    """[X] A physical point has no side."""
    boxes(2, 1, "sides")
    model.model.addPhysicalGroup(0, [1], name="corner")
    model.write(str(tmp_path / "boxes.msh"))
    with pytest.warns(sc.AnalysisWarning, match=r"left out of the mesh.*'corner' \(vertex\)"):
        load_mesh(tmp_path / "boxes.msh")


def test_files_with_several_meshes(tmp_path):
    """[X] One is chosen by its name; a wrong name lists the ones that exist."""
    h5py = pytest.importorskip("h5py")
    from skfem import MeshQuad1

    file = tmp_path / "two.med"
    save_mesh(MeshQuad1().with_subdomains({"soil": lambda x: x[0] < 2}), file)
    with h5py.File(file, "a") as data:
        data.copy("ENS_MAA/mesh", "ENS_MAA/other")
        data.copy("FAS/mesh", "FAS/other")
    with pytest.raises(
        ValueError, match=r"two.med: it has 2 meshes, mesh, other: give one as name="
    ):
        load_mesh(file)
    assert list(load_mesh(file, name="other").subdomains) == ["soil"]
    with pytest.raises(ValueError, match=r"there is no mesh 'pit'; existing: mesh, other"):
        load_mesh(file, name="pit")


HEAD = "$MeshFormat\n{} {} 8\n{}$EndMeshFormat\n"
GRID = "BEGIN BULK\nGRID,{},,0.,0.,0.\nCTRIA3,1,1,1,2,3\n"
TRIANGLE = "*NODE\n1,0,0\n2,1,0\n3,0,1\n*ELEMENT,TYPE=CPE3,ELSET=A\n1,1,2,3\n*NSET,NSET=B"
PIECE = """<VTKFile type="UnstructuredGrid" version="{}"><UnstructuredGrid>
<Piece NumberOfPoints="{}" NumberOfCells="1"><Points><DataArray type="Float64"
NumberOfComponents="3" format="ascii">0 0 0</DataArray></Points><Cells><DataArray
Name="connectivity" type="Int64" format="ascii">0</DataArray></Cells></Piece></UnstructuredGrid>
</VTKFile>"""
LEGACY = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET {}\n"


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        # Other versions and kinds
        ("a.msh", HEAD.format("1.0", 0, ""), "Gmsh format 1.0; formats 2.2 and 4.1 are read: in"),
        ("a.msh", HEAD.format("4.1", 1, "\0\0\0\1\n"), "bytes of another machine: save it as"),
        ("a.vtu", PIECE.format("9.9", 1), "not a file of VTK that can be read"),
        ("a.vtk", LEGACY.format("POLYDATA"), "not a file of VTK that can be read"),
        ("a.mdpa", "solid\n", "not a file of Kratos"),
        ("a.f3grid", "\1\2\0\0" * 99, "a binary grid: export it from FLAC3D as text"),
        ("a.inp", "$MeshFormat\n", "not an input file of Abaqus or CalculiX: it has no"),
        ("a.bdf", "hello\n", "not bulk data of Nastran"),
        # Parts that are missing
        ("a.msh", HEAD.format("4.1", 0, "") + "$Nodes\n$EndNodes\n", "no nodes or no elements"),
        # Numbers that are too large, or not whole
        ("a.vtk", LEGACY.format("UNSTRUCTURED_GRID") + "POINTS 100000000000000 double\n", "memory"),
        ("a.mdpa", "Begin Nodes\n1e30 0 0 0\nEnd Nodes\n", "a node has a number that is too large"),
        ("a.mdpa", "Begin Nodes\n1.5 0 0 0\nEnd Nodes\n", "the number 1.5, which is not whole"),
        ("a.f3grid", "G 1 0 0 0\nZ T4 1 1 1 1 9999999999999\n", "point 9999999999999 does not"),
        ("a.inp", TRIANGLE + ",GENERATE\n1,999999999999\n", "counts from 1 to 999999999999: these"),
        ("a.bdf", GRID.format("9" * 30), "is damaged or not complete"),
        # Ends too early
        ("a.mdpa", "Begin Nodes\n1 0 0 0\n", "not complete: it ends within the block Nodes"),
        ("a.f3grid", "G 1 0 0 0\nG 2 0", "ends within a line"),
        ("a.bdf", GRID.format(1), "grid point 2 does not exist, 2 in all"),
        ("a.nas", "GRID,1,,0.,0.,0.\nCTRIA3,1,1,1", "CTRIA3 1 has 1 nodes, but needs 3"),
        *((f"a.{end}", "", "is empty") for end in ("msh", "inp", "vtu", "vtk", "med", "mdpa")),
        *((f"a.{end}", "", "is empty") for end in ("f3grid", "bdf", "nas", "dat")),
    ],
)
def test_files_that_are_refused(tmp_path, name, text, message):
    """[X] One sentence with the name of the file; nothing is written."""
    (tmp_path / name).write_bytes(text.encode("latin-1"))
    with pytest.raises(ValueError, match=rf"{name}.*{message}"):
        load_mesh(tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_files_of_salome_without_a_mesh(tmp_path):
    """[X] No mesh at all, and one without nodes."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "none.med", "w") as file:
        file.create_group("ENS_MAA")
    with pytest.raises(ValueError, match=r"none.med: it has no mesh"):
        load_mesh(tmp_path / "none.med")
    with h5py.File(tmp_path / "empty.med", "w") as file:
        file.create_group("ENS_MAA/pit").attrs["ESP"] = 3
    with pytest.raises(ValueError, match=r"empty.med: the mesh 'pit' has no nodes or no elements"):
        load_mesh(tmp_path / "empty.med")
    with pytest.raises(ValueError, match=r"culvert.msh: name= chooses a mesh of a file of Salome"):
        load_mesh(FILE, name="pit")


@pytest.mark.parametrize("options", [{}, {"file_format": "gmsh", "binary": False}])
def test_gmsh_files_of_scikit_fem(tmp_path, options):
    """[X] Sides and subdomains that `Mesh.save` writes as data of elements, in both forms."""
    from skfem import MeshQuad1

    mesh = MeshQuad1().refined(1).with_defaults().with_subdomains({"low": lambda x: x[1] < 0.5})
    file = tmp_path / "square.msh"
    mesh.save(file, **options)
    if options:  # meshio 5.3.5 writes whole numbers as np.int64(1)
        file.write_text(re.sub(r"np\.int64\((\d+)\)", r"\1", file.read_text()))
    again = load_mesh(file)
    assert {name: side_of(again, name) for name in again.boundaries} == {
        name: pytest.approx(1.0) for name in mesh.boundaries
    }
    assert sorted(again.subdomains) == ["low"]
    centres = again.p[:, again.t[:, again.subdomains["low"]]].mean(axis=1)
    np.testing.assert_allclose(sorted(map(tuple, centres.T)), [(0.25, 0.25), (0.75, 0.25)])


def test_files_of_scikit_fem_keep_names_with_colons(tmp_path):
    """[X] `Mesh.load` cuts the names of joined bodies at their colon; `load_mesh` reads them."""
    from skfem import Mesh, MeshQuad1

    square = MeshQuad1().refined(1).with_defaults()
    mesh = sc.join_bodies({"base": square, "block": square.translated((0.0, 1.0))})
    mesh.save(tmp_path / "joined.vtu")
    assert set(Mesh.load(tmp_path / "joined.vtu").boundaries) == {"base", "block"}
    again = load_mesh(tmp_path / "joined.vtu")
    lengths = {name: side_of(again, name) for name in again.boundaries}
    assert lengths == {name: pytest.approx(1.0) for name in mesh.boundaries}
    assert len(lengths) == 8


@pytest.mark.parametrize(
    ("key", "numbers", "expected"),
    [
        ("layer", [2, -1, 5], {"layer 2": 1, "layer 5": 1}),
        ("layer", [0, -1, 0], {"layer 0": 2}),
        ("sand-clay", [1, -1, 0], {"sand": 1, "clay": 1}),
        ("back-fill", [1, -1, 5], {"back-fill 1": 1, "back-fill 5": 1}),
    ],
)
def test_numbers_of_cells_name_groups(tmp_path, key, numbers, expected):
    """Every number of a cell from zero on is a group of its own; cells below zero have none.

    The names of sets that meshio joins are those of the numbers, if there are no others.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 3, 4), np.linspace(0, 1, 2))
    file = tmp_path / "numbered.vtu"
    points = np.vstack((mesh.p, np.zeros(8))).T
    data = {key: [np.array(numbers)]}
    meshio.Mesh(points, [("quad", mesh.t.T)], cell_data=data).write(file)
    parts = {name: len(part) for name, part in sc.load_mesh(file).subdomains.items()}
    assert parts == expected


@pytest.mark.parametrize(
    ("name", "kind"),
    [("B21", "line"), ("B22", "line3"), ("B31H", "line"), ("B32OS", "line3"), ("T3D2", "line")],
)
def test_types_of_bars_and_beams(name, kind):
    """[X] The last digit of a beam of Abaqus is its order, that of a bar its number of nodes."""
    assert _kind_of(name)[0] == kind


@pytest.mark.parametrize(
    ("word", "name", "n_nodes", "kind"),
    [
        ("Geometries", "Line3D2", 2, "line"),
        ("Geometries", "Triangle3D3", 3, "triangle"),
        ("Geometries", "Quadrilateral2D4", 4, "quad"),
        ("Geometries", "Tetrahedra3D4", 4, "tetra"),
        ("Elements", "SmallDisplacementElement2D4N", 4, "quad"),
        ("Elements", "SmallDisplacementElement3D4N", 4, "tetra"),
        ("Elements", "ShellThinElement3D3N", 3, "triangle"),
        ("Elements", "TrussLinearElement3D2N", 2, "line"),
        ("Conditions", "LineLoadCondition2D2N", 2, "line"),
        ("Conditions", "SurfaceLoadCondition3D4N", 4, "quad"),
        ("Conditions", "UPwFaceLoadCondition2D2N", 2, "line"),
        ("Conditions", "UPwNormalFluxCondition3D3N", 3, "triangle"),
        ("Elements", "UPwInterfaceElement2D4N", 4, ""),
    ],
)
def test_kinds_of_kratos_by_name_and_space(word, name, n_nodes, kind):
    """[X] Geometries have the dimension of their shape, conditions one less than the space."""
    assert kratos._kind_of(word, name, n_nodes) == kind


def test_zones_of_flac_count_from_one(tmp_path):
    """Zones and faces have numbers of their own."""
    file = tmp_path / "block.f3grid"
    save_mesh(MeshHex().with_boundaries({"bottom": lambda x: x[2] < 0.1}), file)
    words = [line.split()[:3] for line in file.read_text().splitlines()]
    assert [row[2] for row in words if row[:1] == ["Z"]] == ["1"]
    assert [row[2] for row in words if row[:1] == ["F"]] == ["1"]


def test_kinds_by_their_nodes():
    """[X] Dimension and nodes of each kind: its corners, or the number in its name."""
    for (dim, _), kind in BY_NODES.items():
        assert KINDS[kind].dim == dim, kind
    for kind, n_nodes in N_NODES.items():
        digits = kind.lstrip("abcdefghijklmnopqrstuvwxyz")
        assert n_nodes == (int(digits) if digits else KINDS[kind].corners), kind


def test_signed_sizes_of_elements():
    """[X] Areas of a triangle and a trapezoid, the volume of a tetrahedron, and mirrored ones."""
    plane = np.array([(0.0, 0.0), (3.0, 0.0), (2.0, 1.0), (1.0, 1.0)])
    space = np.array([(0.0, 0.0, 0.0), (3.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 1.0)])
    for kind, points, size in (
        ("triangle", plane, 1.5),
        ("quad", plane, 2.0),
        ("tetra", space, 1.0),
    ):
        cells = np.arange(KINDS[kind].corners)[None]
        assert signed_size(points, cells, kind) == pytest.approx([size])
        mirrored = cells[:, list(KINDS[kind].mirrored)]
        assert signed_size(points, mirrored, kind) == pytest.approx([-size])


def test_mirrored_kinds_twice_are_themselves():
    """[X] Mirroring permutes the nodes, first the corners among themselves; twice, it is undone."""
    for name, kind in KINDS.items():
        if not kind.mirrored:
            continue
        mirrored = np.array(kind.mirrored)
        corners = mirrored[: kind.corners]
        assert sorted(mirrored) == [*range(N_NODES[name])], name
        assert sorted(corners) == [*range(kind.corners)], name
        assert (mirrored[mirrored] == np.arange(len(mirrored))).all(), name


def test_kinds_that_follow_from_their_nodes():
    """Without points and two kinds of Gmsh alone, all do."""
    assert {*KINDS} - {*BY_NODES.values()} == {"vertex", "pyramid14", "wedge18"}


def test_bulk_data_begin_after_the_case_control():
    """In small letters and below other lines, up to the end of the data."""
    text = "SOL 101\nTITLE = PLATE\n begin bulk\nGRID,7,,0.,1.,2.\nENDDATA\nGRID,8\n"
    (card,) = nastran._cards(text)
    assert card[:2] == ["GRID", "7"]


def test_kinds_of_gmsh_are_those_of_its_library(model):
    """[P] Dimensions, order, corners and numbers of nodes of the first 19 types of Gmsh."""
    assert sorted(own_gmsh._KINDS) == list(range(1, 20))
    for number, kind in own_gmsh._KINDS.items():
        _, dim, order, nodes, _, corners = model.model.mesh.getElementProperties(number)
        shape = KINDS[kind]
        assert N_NODES[kind] == nodes
        assert (shape.dim, shape.corners) == (dim, corners)
        assert shape.order == max(order, 1)  # of a point Gmsh has 0


@pytest.mark.parametrize(
    "orders", [abaqus._ORDER, kratos._ORDER, med._ORDER, UPRIGHT_FIRST, own_gmsh._ORDER]
)
def test_orders_of_nodes_have_each_node_once(orders):
    """[X] They are permutations whose corners come first."""
    for kind, order in orders.items():
        assert sorted(order) == list(range(N_NODES[kind]))
        assert order[: KINDS[kind].corners] == list(range(KINDS[kind].corners))


def test_middles_of_edges_of_gmsh_lie_on_the_edges_of_vtk(model):
    """[P] Coordinates of Gmsh's nodes in the order of VTK: between the corners of each edge."""
    edges = {
        "tetra10": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
        "hexahedron20": [
            (0, 1),
            (1, 2),
            (2, 3),
            (3, 0),
            (4, 5),
            (5, 6),
            (6, 7),
            (7, 4),
            (0, 4),
            (1, 5),
            (2, 6),
            (3, 7),
        ],
    }
    numbers = {kind: number for number, kind in own_gmsh._KINDS.items()}
    for kind, pairs in edges.items():
        places = model.model.mesh.getElementProperties(numbers[kind])[4].reshape(-1, 3)
        places = places[own_gmsh._ORDER[kind]]
        first, second = np.transpose(pairs)
        middles = places[KINDS[kind].corners :]
        np.testing.assert_allclose(middles, 0.5 * (places[first] + places[second]), atol=1e-12)


def test_cards_of_nastran_have_the_nodes_of_their_kinds():
    """[X] Every number of nodes that a card may have."""
    for counts in nastran._CARDS.values():
        assert counts == {N_NODES[kind]: kind for kind in counts.values()}


@pytest.mark.parametrize("kind", abaqus._FACES)
def test_faces_of_abaqus_are_the_sides_of_the_element(kind):
    """[X] With the same corners, each side once."""
    faces = {frozenset(face) for face in abaqus._FACES[kind]}
    assert faces == {frozenset(side) for side in KINDS[kind].sides}
    assert len(faces) == len(abaqus._FACES[kind])
