"""Fields at nodes and VTU files: exact where the field is linear, bodies apart, nodes in VTK's
order.
"""

from __future__ import annotations

import meshio
import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    MeshQuad,
    MeshQuad2,
    MeshTri,
    MeshTri2,
)

import skfem_contact as sc
from skfem_contact.results import Result, StageResult
from skfem_contact.results.fields import nodal_field
from tests.tools.helpers import ELEMENTS, IN_SPACE, distorted, grid, vector_basis

# Strain xx, yy, xy (engineering) of a linear field.
STRAIN = np.array([1e-3, -4e-4, 6e-4])


def stretched(basis, scale=1.0):
    """Displacements of a constant strain."""
    x, y = basis.doflocs[:, ::2]
    e = scale * STRAIN
    return np.column_stack((e[0] * x + e[2] * y, e[1] * y)).ravel()


def step_of(forms, x):
    """The stage that these displacements would be."""
    states = {name: form.assemble(x, form.initial_state()).state for name, form in forms.items()}
    return StageResult("now", x, 0 * x, states, (), 0.0, forms=forms)


def two_bodies(element):
    """Two plates side by side, with materials of their own, and a third without any."""
    plate = grid(element, [0, 0.5, 1], [0, 0.5, 1])
    mesh = sc.join_bodies(
        {"a": plate, "b": plate.translated((1.0, 0.0)), "c": plate.translated((3.0, 0.0))}
    )
    basis = vector_basis(mesh, element, intorder=4)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), sc.LinearElastic(E=E, nu=0.3))
        for name, E in (("a", 1e3), ("b", 5e3))
    }
    return basis, forms


@pytest.mark.parametrize("element", ELEMENTS)
def test_constant_stress_is_met_at_every_node(element):
    """[X] Hooke's law in both bodies, nothing averaged between them, and invariants of the full
    tensor.
    """
    basis, forms = two_bodies(element)
    step = step_of(forms, stretched(basis))
    nodes = {
        name: np.unique(basis.element_dofs[::2, basis.mesh.subdomains[name]]) // 2 for name in "abc"
    }
    strain = np.array([[STRAIN[0], STRAIN[2] / 2, 0], [STRAIN[2] / 2, STRAIN[1], 0], [0, 0, 0]])
    for name, E in (("a", 1e3), ("b", 5e3)):
        lam, mu = E * 0.3 / (1.3 * 0.4), E / 2.6
        stress = lam * np.trace(strain) * np.eye(3) + 2 * mu * strain
        deviator = stress - np.trace(stress) / 3 * np.eye(3)
        s3, s2, s1 = np.linalg.eigvalsh(stress)
        expected = {
            "sxx": stress[0, 0],
            "syy": stress[1, 1],
            "szz": stress[2, 2],
            "sxy": stress[0, 1],
            "s1": s1,
            "s2": s2,
            "s3": s3,
            "mean": np.trace(stress) / 3,
            "plastic": 0.0,
            "mises": np.sqrt(1.5 * (deviator**2).sum()),
        }
        for quantity, value in expected.items():
            field = step.field(quantity)
            np.testing.assert_allclose(field[nodes[name]], value, rtol=1e-10, err_msg=quantity)
            assert np.isnan(field[nodes["c"]]).all()
    u = step.x.reshape(-1, 2)
    for quantity, value in (("ux", u[:, 0]), ("uy", u[:, 1]), ("u", np.hypot(*u.T))):
        field = step.field(quantity)
        inside = np.concatenate((nodes["a"], nodes["b"]))
        np.testing.assert_array_equal(field[inside], value[inside])
        assert np.isnan(field[nodes["c"]]).all()


def test_plastic_strain_of_soil_beside_an_elastic_body():
    basis, forms = two_bodies("Q1")
    forms["a"] = sc.SolidForm(
        basis.with_elements("a"), sc.MohrCoulomb(E=1e3, nu=0.3, c=0.01, phi=20.0)
    )
    step = step_of(forms, stretched(basis))
    field = step.field("plastic")
    np.testing.assert_allclose(np.nanmax(field), step.states["a"].internal[0].max())
    assert np.nanmin(field) == 0.0 < np.nanmax(field)


def test_what_does_not_exist_is_listed():
    basis, forms = two_bodies("Q1")
    step = step_of(forms, basis.zeros())
    with pytest.raises(ValueError, match=r"no field 'uz'; existing: .*mises.*ux"):
        step.field("uz")
    with pytest.raises(ValueError, match="no SolidForm in stage 'now'"):
        step_of({}, basis.zeros()).field("ux")


def curved(mesh):
    """The mesh with second-order geometry, bent."""
    second = (MeshTri2 if isinstance(mesh, MeshTri) else MeshQuad2).from_mesh(mesh)
    x, y = second.doflocs
    bent = np.stack((x, y + 0.2 * x**2))
    return type(second)(bent, second.t)


@pytest.mark.parametrize("element", [*ELEMENTS, "P2 curved", "Q2 curved"])
def test_vtu_holds_the_nodes_in_the_order_of_vtk(element, tmp_path, rng):
    """[X] Corners, then the middles of the sides between corner and next corner, then the
    centre. Elements whose corners run clockwise in the mesh run the other way in the file.
    """
    if "curved" in element:
        plain = MeshTri if element.startswith("P") else MeshQuad
        mesh = curved(plain.init_tensor(np.linspace(0, 1, 4), np.linspace(0, 1, 3)))
        basis = Basis(
            mesh, ElementVector(ElementTriP2() if plain is MeshTri else ElementQuad2()), intorder=4
        )
    else:
        mesh = distorted(grid(element, np.linspace(0, 1, 4), np.linspace(0, 1, 3)), rng, 0.03)
        basis = vector_basis(mesh, element, intorder=4)
    forms = {"plate": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3))}
    step = step_of(forms, stretched(basis))
    step.to_vtu(tmp_path / "plate.vtu")
    read = meshio.read(tmp_path / "plate.vtu")

    (block,) = read.cells
    names = {"P1": "triangle", "P2": "triangle6", "Q1": "quad", "Q2": "quad9", "QuadS2": "quad8"}
    assert block.type == names[element.split()[0]]
    places = read.points[block.data]
    n = basis.mesh.t.shape[0]
    corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1]] if n == 4 else [[0, 0], [1, 0], [0, 1]])
    first, second = basis.mesh.p[:, basis.mesh.t[[1, n - 1]]].transpose(1, 0, 2) - np.asarray(
        basis.mesh.p[:, basis.mesh.t[0]]
    )
    clockwise = first[0] * second[1] < first[1] * second[0]
    for turned, order in ((False, np.arange(n)), (True, -np.arange(n) % n)):
        # of the parametric element: sides are 0-1, 1-2, ...; the last local node of nine is the
        # centre
        own = corner[order].astype(float)
        sides = 0.5 * (own + np.roll(own, -1, axis=0))
        local = np.concatenate((own, sides, [[0.5, 0.5]]))[: places.shape[1]]
        elements = np.flatnonzero(clockwise == turned)
        if len(elements):
            expected = basis.mapping.F(local.T, elements).transpose(1, 2, 0)
            np.testing.assert_allclose(places[elements, :, :2], expected, atol=1e-12)
    x, y = read.points[:, 0], read.points[:, 1]
    u = np.column_stack((STRAIN[0] * x + STRAIN[2] * y, STRAIN[1] * y, 0 * x))
    np.testing.assert_allclose(read.point_data["displacement"], u, atol=1e-15)


def test_vtu_of_two_bodies(tmp_path):
    """[X] Bodies do not share points; stress, body and region of every cell; the third body is left
    out.
    """
    basis, forms = two_bodies("Q2")
    step = step_of(forms, stretched(basis))
    step.to_vtu(tmp_path / "two.vtu")
    read = meshio.read(tmp_path / "two.vtu")
    (block,) = read.cells
    assert len(read.points) == 50
    assert not np.intersect1d(block.data[:4], block.data[4:]).size
    np.testing.assert_array_equal(read.cell_data["body"][0], [0] * 4 + [1] * 4)
    np.testing.assert_array_equal(read.cell_data["region"][0], [0] * 4 + [1] * 4)
    sxx = read.cell_data["stress"][0][:, 0]
    np.testing.assert_allclose(sxx[4:], 5 * sxx[:4])
    np.testing.assert_allclose(read.cell_data["stress"][0][:, 4:], 0.0)


def test_solids_that_are_not_there_are_left_out(tmp_path):
    """What a stage has taken away, or has not got yet, has no values; the regions of the others
    keep their numbers.
    """
    basis, forms = two_bodies("Q1")
    step = step_of({"b": forms["b"]}, stretched(basis))
    there = np.unique(basis.element_dofs[::2, basis.mesh.subdomains["b"]]) // 2
    for quantity in ("ux", "sxx", "mises", "plastic"):
        field = step.field(quantity)
        np.testing.assert_array_equal(np.flatnonzero(np.isfinite(field)), there, err_msg=quantity)
    result = Result((step_of(forms, stretched(basis)), step))
    read = meshio.read(result.to_pvd(tmp_path / "two.pvd")[-1])
    np.testing.assert_array_equal(read.cell_data["region"][0], [1] * 4)
    with pytest.raises(
        ValueError, match=r"one stage is needed, result\[name of the stage\], not Result"
    ):
        nodal_field(result, "ux")


@pytest.mark.parametrize("element", IN_SPACE)
def test_contact_in_space_as_cells(element):
    """[X] The slave's facets are triangles and quadrilaterals of its area, which carry the
    pressure.
    """
    kind = IN_SPACE[element][0]
    lower = kind.init_tensor(*[np.linspace(0, 1, 3)] * 3).with_boundaries(
        {"top": lambda x: x[2] == 1.0}
    )
    upper = kind.init_tensor(*[np.linspace(0, 1, 4)] * 2, np.linspace(1, 2, 2)).with_boundaries(
        {"bottom": lambda x: x[2] == 1.0}
    )
    basis = vector_basis(sc.join_bodies({"lower": lower, "upper": upper}), element, intorder=4)
    pair = sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=0.3), penalty=1e4)
    forms = {"body": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)), "joint": pair}
    x = basis.zeros()
    x[2::3] = np.where(basis.doflocs[2, 2::3] >= 1.0, -1e-3, 0.0)
    states = {name: form.assemble(x, form.initial_state()).state for name, form in forms.items()}
    grid = StageResult("s", x, basis.zeros(), states, (), 0.0, forms=forms).to_pyvista()
    cells = grid.extract_cells(np.isfinite(grid.cell_data["pressure"]))
    assert cells.n_cells == len(pair.slave.facets)
    assert abs(cells.compute_cell_sizes()["Area"]).sum() == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["uy", "syy"])
def test_difference_to_a_stage_of_another_mesh(name):
    """It is refused by name, with the numbers of both meshes."""
    stages = []
    for n in (5, 4):
        mesh = MeshQuad.init_tensor(np.linspace(0, 2, n), np.linspace(0, 1, n)).with_defaults()
        basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
        ground = sc.SolidForm(basis, sc.LinearElastic(1e4, 0.3), unit_weight=20.0)
        model = sc.Model({"ground": ground}, sc.box_supports(basis))
        stages.append(model.run([sc.Stage("weight")], progress=False)["weight"])
    with pytest.raises(ValueError, match=r"of another mesh .*32 dofs and 9 elements.* 50 and 16"):
        stages[0].field(name, since=stages[1])


def test_displacements_that_are_no_numbers():
    """A result of a loop of one's own refuses NaN."""
    mesh = MeshQuad().with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    ground = sc.SolidForm(basis, sc.LinearElastic(1e4, 0.3))
    states = {"ground": ground.initial_state()}
    for given in ({"x": basis.zeros() * np.nan}, {"x": basis.zeros(), "load": np.full(8, np.inf)}):
        with pytest.raises(ValueError, match="must be finite"):
            sc.results.of({"ground": ground}, states=states, **given)
