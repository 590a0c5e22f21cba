"""Files of CalculiX 2.20 and comparisons with them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from skfem import Basis, ElementTetP2, ElementVector, MeshTet, MeshTet2

import skfem_contact as sc
from skfem_contact.testing import compare, read_dat, read_frd

FILES = Path(__file__).parents[2] / "examples" / "9_extending"


def cantilever(E=1e4):
    """The analysis from which the files are: a block of 2 m that is held at x = 0."""
    lines = (np.linspace(0.0, 2.0, 3), np.linspace(0.0, 1.0, 2), np.linspace(0.0, 1.0, 2))
    mesh = MeshTet2.from_mesh(MeshTet.init_tensor(*lines))
    basis = Basis(mesh, ElementVector(ElementTetP2()), intorder=2)
    block = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.3), unit_weight=20.0)
    fixed = basis.get_dofs(lambda x: x[0] == 0.0).all()
    return sc.Model({"block": block}, fixed).run([sc.Stage("weight")], progress=False)["weight"]


def test_comparison_with_calculix():
    """[P] Displacements and mean stresses of CalculiX 2.20, to the six digits of its files."""
    frd = read_frd(FILES / "cantilever.frd")
    dat = read_dat(FILES / "cantilever.dat")
    found = compare(cantilever(), frd, dat)
    assert found.displacement < 1e-5
    assert found.stress < 1e-5
    assert found.nodes == 45
    softer = compare(cantilever(E=0.5e4), frd, dat)
    assert softer.displacement == pytest.approx(1.0, rel=1e-3)  # twice as far
    assert softer.stress < 1e-5  # statics and nu alone


def test_fields_and_elements():
    """[X] Components in the order here, and the volume of the elements."""
    frd = read_frd(FILES / "cantilever.frd")
    ((time, fields),) = frd.steps
    assert time == 1.0
    assert fields["DISP"].shape == (45, 3) and fields["STRESS"].shape == (45, 6)
    corners = frd.points[frd.cells["tetra10"][:, :4]]
    edges = corners[:, 1:] - corners[:, :1]
    assert np.abs(np.linalg.det(edges)).sum() / 6 == pytest.approx(2.0)
    middles = frd.points[frd.cells["tetra10"]]
    np.testing.assert_allclose(middles[:, 4], 0.5 * (middles[:, 0] + middles[:, 1]))
    np.testing.assert_allclose(middles[:, 9], 0.5 * (middles[:, 2] + middles[:, 3]))


def test_shear_of_both_files_is_in_one_order():
    """[X] The text of the .dat file has xz before yz."""
    text = (FILES / "cantilever.dat").read_text()
    first = next(line for line in text[text.index("stresses") :].splitlines()[1:] if line.strip())
    numbers = [float(word) for word in first.split()]
    (block,) = (
        block for block in read_dat(FILES / "cantilever.dat") if block.quantity == "stresses"
    )
    assert block.ids[0].tolist() == [1, 1] and block.group == "BLOCK"
    assert block.values[0].tolist() == [*numbers[2:6], numbers[7], numbers[6]]


BRICK = """    1C
    2C                            20                                     1
{nodes} -3
    3C                             1                                     1
 -1         1    4    0    1
{order} -3
 9999
"""


def test_bricks_of_second_order_are_put_into_the_order_of_vtk(tmp_path):
    """[X] The last two groups of nodes are swapped in the file, as CalculiX 2.20 writes it."""
    corners = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1.0]]
    )
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
    edges += [(0, 4), (1, 5), (2, 6), (3, 7)]
    points = np.concatenate((corners, [(corners[a] + corners[b]) / 2 for a, b in edges]))
    rows = "".join(
        f" -1{k:10}{x:12.5E}{y:12.5E}{z:12.5E}\n" for k, (x, y, z) in enumerate(points, start=1)
    )
    numbers = [*range(1, 13), 17, 18, 19, 20, 13, 14, 15, 16]
    order = ""
    for line in (numbers[:10], numbers[10:]):
        order += " -2" + "".join(f"{number:10}" for number in line) + "\n"
    file = tmp_path / "brick.frd"
    file.write_text(BRICK.format(nodes=rows, order=order))
    frd = read_frd(file)
    (nodes,) = frd.cells["hexahedron20"]
    np.testing.assert_allclose(frd.points[nodes], points)


def test_wrong_files(tmp_path):
    """[X] One sentence with the name of the file, and what is missing in a comparison."""
    data = (FILES / "cantilever.frd").read_bytes()
    broken = tmp_path / "broken.frd"
    for text in (b"", b"hello\n", data[:1500], data[:6000]):
        broken.write_bytes(text)
        with pytest.raises(ValueError, match=r"broken\.frd"):
            read_frd(broken)
    broken.write_text(
        "    2C                            20                                     2\n"
    )
    with pytest.raises(ValueError, match=r"broken.frd: it is binary"):
        read_frd(broken)
    broken.write_text("nothing\n")
    with pytest.raises(ValueError, match="no printed results of CalculiX"):
        read_dat(broken)
    frd = read_frd(FILES / "cantilever.frd")
    stage = cantilever()
    forces = [block for block in read_dat(FILES / "cantilever.dat") if block.quantity != "stresses"]
    with pytest.raises(ValueError, match=r"have no stresses: add \*EL PRINT"):
        compare(stage, frd, forces)
    moved = sc.testing.Frd(frd.ids, frd.points + 0.1, frd.cells, frd.steps)
    with pytest.raises(ValueError, match=r"of 45 nodes are not in the result of CalculiX"):
        compare(stage, moved)
