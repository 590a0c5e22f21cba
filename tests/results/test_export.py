"""Files of results, read by other programs: integrals, cuts and surfaces of what they hold."""

from __future__ import annotations

import warnings

import meshio
import numpy as np
import pytest
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementQuad1,
    ElementQuad2,
    ElementTetP1,
    ElementTetP2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    MeshHex,
    MeshHex2,
    MeshQuad,
    MeshQuad2,
    MeshTet,
    MeshTet2,
    MeshTri,
    MeshTri2,
)

import skfem_contact as sc
from skfem_contact.mesh.kinds import KINDS, oriented, signed_size

pyvista = pytest.importorskip("pyvista")
vtk = pytest.importorskip("vtk")

CASES = {
    "triangles": (MeshTri, None, ElementTriP1),
    "triangles of second order": (MeshTri, MeshTri2, ElementTriP2),
    "quadrilaterals": (MeshQuad, None, ElementQuad1),
    "quadrilaterals of second order": (MeshQuad, MeshQuad2, ElementQuad2),
    "tetrahedra": (MeshTet, None, ElementTetP1),
    "tetrahedra of second order": (MeshTet, MeshTet2, ElementTetP2),
    "hexahedra": (MeshHex, None, ElementHex1),
    "hexahedra of second order": (MeshHex, MeshHex2, ElementHex2),
}


def column(first, second, element, flip=1.0):
    """A unit square or cube that stands under its weight of 10 and cannot widen: szz is -10 (1 - z)
    and the settlement 10/E (z - z^2/2).
    """
    dim = 3 if first in (MeshTet, MeshHex) else 2
    mesh = first.init_tensor(*[np.linspace(0, 1, 3)] * dim)
    mesh = mesh.scaled((flip, *[1.0] * (dim - 1))).with_boundaries({"base": lambda x: x[-1] == 0.0})
    if second is not None:
        mesh = second.from_mesh(mesh).with_boundaries({"base": lambda x: x[-1] == 0.0})
    basis = Basis(mesh, ElementVector(element()))
    upright = np.arange(basis.N) % dim == dim - 1
    fixed = np.union1d(basis.get_dofs("base").all(), np.flatnonzero(~upright))
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0), unit_weight=10.0)
    return sc.Model({"column": solid}, fixed).run([sc.Stage("weight")], progress=False)["weight"]


@pytest.mark.parametrize("flip", [1.0, -1.0])
@pytest.mark.parametrize("case", CASES)
@pytest.mark.one_in(2)
def test_integrals_of_what_pyvista_reads(tmp_path, case, flip):
    """[X] Volume 1, mean stress -5, and mean settlement 10/(3 E), of elements of either sign."""
    stage = column(*CASES[case], flip)
    stage.to_vtu(tmp_path / "column.vtu")
    grid = pyvista.read(tmp_path / "column.vtu")
    size = grid.compute_cell_sizes()
    dim = 3 if "hedra" in case else 2
    sizes = size["Volume"] if dim == 3 else size["Area"]
    assert sizes.min() > 0.0
    assert sizes.sum() == pytest.approx(1.0, rel=1e-12)

    # Fields of second order are integrated by VTK over linear pieces: means of elements are right
    mean = (grid.cell_data["stress"] * sizes[:, None]).sum(axis=0)
    assert mean[dim - 1] == pytest.approx(-5.0, rel=1e-6)
    assert grid.point_data["displacement"].shape[1] == 3
    if case in ("triangles", "tetrahedra"):
        return  # their settlement is not exact
    top = grid.points[:, dim - 1] == 1.0
    np.testing.assert_allclose(grid.point_data["displacement"][top, dim - 1], -5e-4, rtol=1e-6)


@pytest.mark.parametrize("case", ["tetrahedra", "tetrahedra of second order", "hexahedra"])
def test_surface_points_outwards_and_halves_are_halves(tmp_path, case):
    """[X] The volume by the divergence theorem, and the volume of a half that a plane cuts off."""
    stage = column(*CASES[case])
    grid = stage.to_pyvista()
    surface = grid.extract_surface(algorithm="dataset_surface").triangulate()
    assert surface.volume == pytest.approx(1.0, rel=1e-6)
    assert surface.area == pytest.approx(6.0, rel=1e-6)
    corners = surface.points[surface.faces.reshape(-1, 4)[:, 1:]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward = (normals * (corners.mean(axis=1) - 0.5)).sum(axis=1)
    assert (outward > 0.0).all()
    if "second" not in case:
        half = grid.clip("z", origin=(0.0, 0.0, 0.5), invert=True)
        assert half.volume == pytest.approx(0.5, rel=1e-6)


@pytest.mark.parametrize("case", CASES)
def test_volumes_of_what_meshio_reads(tmp_path, case):
    """[N] The elements of the file have positive areas or volumes that add up to one."""
    column(*CASES[case], flip=-1.0).to_vtu(tmp_path / "column.vtu")
    (block,) = meshio.read(tmp_path / "column.vtu").cells
    points = meshio.read(tmp_path / "column.vtu").points
    if KINDS[block.type].dim == 2:
        points = points[:, :2]
    sizes = signed_size(points, block.data, block.type)
    assert sizes.min() > 0.0
    assert sizes.sum() == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("kind", [name for name, kind in KINDS.items() if kind.mirrored])
def test_mirrored_elements_are_the_same_elements(kind):
    """[X] Mirrored twice every node is back, and VTK sees the same straight element."""
    shape = KINDS[kind]
    order = np.array(shape.mirrored)
    np.testing.assert_array_equal(order[order], np.arange(len(order)))
    if shape.dim < 2:
        return
    x = pyvista_element(kind)
    cells = np.arange(len(x))[None]
    plane = x[:, : shape.dim] if shape.dim == 2 else x
    assert signed_size(plane, cells, kind)[0] > 0.0
    turned = oriented(plane * [-1.0, *[1.0] * (shape.dim - 1)], cells, kind)
    np.testing.assert_array_equal(turned[0], order)


def pyvista_element(kind):
    """Nodes of an element of VTK's own parametric coordinates, (n, 3)."""
    types = {
        "triangle": 5,
        "triangle6": 22,
        "quad": 9,
        "quad8": 23,
        "quad9": 28,
        "tetra": 10,
        "tetra10": 24,
        "pyramid": 14,
        "wedge": 13,
        "hexahedron": 12,
        "hexahedron20": 25,
        "hexahedron27": 29,
    }
    cell = vtk.vtkGenericCell.InstantiateCell(types[kind])
    coordinates = cell.GetParametricCoords()
    n = cell.GetNumberOfPoints()
    return np.array([coordinates[k] for k in range(3 * n)]).reshape(n, 3)


def test_beams_of_what_meshio_reads(tmp_path):
    """[X] Cells of a beam have its own points, after those of the solid, with its deflection."""
    basis = Basis(MeshQuad(), ElementVector(ElementQuad1()), intorder=2)
    beam = sc.Beam(None, [[2.0, 0.0], [3.0, 0.0], [5.0, 0.0]], EI=1.0, EA=1e3, GA=1e9)
    forms = {"plate": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.0)), "beam": beam}
    model = sc.Model(forms, [*range(basis.N), *beam.dofs((2.0, 0.0))])
    load = model.forms["beam"].load((0.0, 0.01), at=(5.0, 0.0))
    stage = model.run([sc.Stage("tip", load)], progress=False)["tip"]
    stage.to_vtu(tmp_path / "beam.vtu")
    mesh = meshio.read(tmp_path / "beam.vtu")
    [cells] = [block.data for block in mesh.cells if block.type == "line3"]
    ends_and_middle = [[2.0, 3.0, 2.5], [3.0, 5.0, 4.0]]
    np.testing.assert_allclose(mesh.points[cells][:, :, 0], ends_and_middle)
    tip = mesh.point_data["displacement"][cells[1, 1], 1]
    assert tip == pytest.approx(0.01 * 3.0**3 / 3.0, rel=1e-6)


def test_pore_pressures_of_what_meshio_reads(tmp_path):
    """[X] Ground that cannot drain at once carries a load by its water: 100, and it has no key for
    water where there is none.
    """
    mesh = MeshTri.init_tensor(np.linspace(0, 1, 2), np.linspace(0, 1, 3)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2))
    forms = {"soil": soil, "water": sc.PoreWater(basis, 1e-3, unit_weight=10.0)}
    load = sc.traction(basis, "top", (0.0, -100.0))
    supports = sc.box_supports(basis, base="rollers")
    stages = [sc.Stage("load", load, duration=1.0)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)  # no water can leave
        wet = sc.Model(forms, supports).run(stages, progress=False)["load"]
    wet.to_vtu(tmp_path / "wet.vtu")
    pressure = meshio.read(tmp_path / "wet.vtu").point_data["pore_pressure"]
    np.testing.assert_allclose(pressure, 100.0, rtol=1e-6)
    dry = sc.Model({"soil": soil}, supports).run([sc.Stage("load", load)], progress=False)["load"]
    dry.to_vtu(tmp_path / "dry.vtu")
    assert "pore_pressure" not in meshio.read(tmp_path / "dry.vtu").point_data
