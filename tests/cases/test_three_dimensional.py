"""Bodies in space: strains of six components, collapse, closed forms, agreement with plane strain,
and refusals.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import pyvista
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementHexS2,
    ElementQuad1,
    ElementTetP1,
    ElementTetP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshHex,
    MeshHex2,
    MeshQuad,
    MeshTet,
    MeshTet2,
)
from skfem.models.elasticity import lame_parameters, linear_elasticity

import skfem_contact as sc
from skfem_contact import plot
from skfem_contact.forms.assembly import strain_operator
from skfem_contact.results import StageResult
from skfem_contact.results.sections import section_forces

#: Elements, their meshes and rules that integrate the stiffness of a box exactly.
ELEMENTS = {
    "TetP1": (MeshTet, ElementTetP1, 2),
    "TetP2": (MeshTet, ElementTetP2, 2),
    "Hex1": (MeshHex, ElementHex1, 2),
    "Hex2": (MeshHex, ElementHex2, 4),
    "HexS2": (MeshHex, ElementHexS2, 4),
}
ELASTIC = sc.LinearElastic(E=100.0, nu=0.3)
# Sums of some hundred terms in another order.
ROUND_OFF = 1e-12


def box(element: str, n: int = 3, shake: float = 0.0, rng=None) -> Basis:
    """The unit cube; nodes inside are moved by up to `shake`."""
    kind, elem, intorder = ELEMENTS[element]
    mesh = kind.init_tensor(*3 * [np.linspace(0, 1, n + 1)])
    p = mesh.p.copy()
    inside = ((p > 0) & (p < 1)).all(axis=0)
    if shake:
        p[:, inside] += rng.uniform(-shake, shake, (3, inside.sum()))
    return Basis(kind(p, mesh.t).with_defaults(), ElementVector(elem()), intorder=intorder)


def symmetry_planes(basis: Basis) -> np.ndarray:
    """The displacement across x = 0, y = 0 and z = 0 is held."""
    component = np.arange(basis.N) % 3
    return np.flatnonzero(
        np.any([(component == i) & (basis.doflocs[i] == 0) for i in range(3)], axis=0)
    )


def traction(basis: Basis, facets, force) -> np.ndarray:
    """Load vector of a traction on facets: a function of the fields at them."""
    form = LinearForm(lambda v, w: np.einsum("c...,c...->...", force(w), np.asarray(v)))
    return form.assemble(FacetBasis(basis.mesh, basis.elem, facets=facets, intorder=4))


# -- kernels


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("strain", ["full", "b_bar"])
def test_patch_test(element, strain, rng):
    """[X] A linear displacement field on a distorted mesh has constant strains and leaves inner
    nodes in balance.
    """
    basis = box(element, shake=0.05, rng=rng)
    form = sc.SolidForm(basis, ELASTIC, strain)
    g = rng.standard_normal((3, 3))
    out = form.assemble((basis.doflocs[:, ::3].T @ g.T).ravel(), form.initial_state())
    s = g + g.T
    expected = np.array([g[0, 0], g[1, 1], g[2, 2], s[0, 1], s[1, 2], s[2, 0]])
    assert np.abs(out.state.strain - expected[:, None, None]).max() < ROUND_OFF
    inner = np.setdiff1d(np.arange(basis.N), basis.get_dofs(basis.mesh.boundary_facets()).all())
    assert len(inner) > 0
    assert np.abs(out.force[inner]).max() < ROUND_OFF * np.abs(out.force).max()


@pytest.mark.parametrize("element, kind", [("Hex2", MeshHex2), ("TetP2", MeshTet2)])
def test_patch_test_of_curved_elements(element, kind):
    """[X] Isoparametric elements of second order with curved faces have the constant strains as
    well.
    """
    mesh = kind.from_mesh(box(element).mesh)
    mesh = replace(mesh, doflocs=mesh.doflocs * (1 + 0.1 * mesh.doflocs[0] * mesh.doflocs[1]))
    sc.mesh.check_mesh(mesh)
    basis = Basis(mesh, ElementVector(ELEMENTS[element][1]()), intorder=4)
    form = sc.SolidForm(basis, ELASTIC, "full")
    x = (basis.doflocs[:, ::3].T * [1.0, 2.0, 3.0]).ravel()
    strain = form.assemble(x, form.initial_state()).state.strain
    assert np.abs(strain - np.array([1, 2, 3, 0, 0, 0])[:, None, None]).max() < ROUND_OFF


@pytest.mark.parametrize("element", ELEMENTS)
def test_stiffness_is_that_of_scikit_fem(element, rng):
    """[N] Entry by entry, on a distorted mesh."""
    basis = box(element, shake=0.05, rng=rng)
    K = linear_elasticity(*lame_parameters(100.0, 0.3)).assemble(basis)
    difference = abs(sc.SolidForm(basis, ELASTIC, "full").elastic_stiffness - K).max()
    assert difference < ROUND_OFF * abs(K).max()


def test_b_bar_has_one_volume_strain_an_element(rng):
    """[X] The mean volumetric strain stays, its variation over an element goes."""
    basis = box("Hex1", shake=0.05, rng=rng)
    full, averaged = (strain_operator(basis, strain, "space") for strain in ("full", "b_bar"))
    volumetric = averaged.B[:, :, :3].sum(axis=2)
    assert np.abs(np.ptp(volumetric, axis=1)).max() < ROUND_OFF * np.abs(volumetric).max()
    means = [np.einsum("eq,eqcb->eb", op.weight, op.B[:, :, :3]) for op in (full, averaged)]
    np.testing.assert_allclose(*means, atol=ROUND_OFF)


@pytest.mark.parametrize("psi", [30.0, 5.0])
@pytest.mark.parametrize("element", ["TetP2", "Hex1"])
def test_form_of_yielding_soil(element, psi, rng):
    """[N] Tangent against differences of the force, balance of forces and moments, no resistance to
    rigid motions.
    """
    basis = box(element, n=2)
    form = sc.SolidForm(basis, sc.MohrCoulomb(E=100.0, nu=0.3, c=0.5, phi=30.0, psi=psi), "full")
    x = 0.02 * rng.standard_normal(basis.N)
    state = form.initial_state()
    assert (form.assemble(x, state).state.internal > 0).mean() > 0.3
    sc.testing.check_form(form, x, state, basis.doflocs)
    assert form.symmetric == (psi == 30.0)


def test_weight_acts_downwards():
    """[X] Against z by default, else where it is told to."""
    basis = box("Hex1")
    np.testing.assert_allclose(
        sc.weight(basis, 20.0).reshape(-1, 3).sum(axis=0), [0, 0, -20], atol=1e-12
    )
    np.testing.assert_allclose(
        sc.weight(basis, 20.0, direction=(0.6, 0, -0.8)).reshape(-1, 3).sum(axis=0),
        [12, 0, -16],
        atol=1e-12,
    )


# -- analyses


@pytest.mark.parametrize(
    "element, n, psi", [("TetP2", 1, 30.0), ("TetP2", 1, 0.0), ("Hex1", 2, 10.0)]
)
def test_collapse_of_a_cube(element, n, psi):
    """[X] Uniaxial compression ends at 2 c tan(45 + phi/2), whatever the dilation."""
    basis = box(element, n=n)
    form = sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0, psi=psi), "full")
    load = traction(
        basis,
        basis.mesh.facets_satisfying(lambda x: x[2] == 1),
        lambda w: -np.eye(3)[2][:, None, None],
    )
    limit = sc.Model({"cube": form}, symmetry_planes(basis)).limit_load(load, step=10.0)
    # the stress is uniform: all flows at once, and the load is bracketed by `tol` = .005
    exact = 20.0 * np.tan(np.radians(60.0))
    assert limit.multiplier == pytest.approx(exact, rel=5e-3) and limit.multiplier <= exact * (
        1 + 1e-6
    )
    assert limit.bands["cube"].min() > 0


@pytest.mark.slow
def test_stage_beyond_collapse():
    """[X] Below the limit the cube is elastic; a load above it is followed up to the limit."""
    basis = box("Hex1", n=1)
    form = sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0, psi=30.0), "full")
    top = basis.mesh.facets_satisfying(lambda x: x[2] == 1)
    loads = [
        traction(basis, top, lambda w, p=p: -p * np.eye(3)[2][:, None, None]) for p in (34.6, 34.7)
    ]
    forms, fixed = {"cube": form}, symmetry_planes(basis)
    start = sc.Model(forms, fixed).run([sc.Stage("below", loads[0])])
    stress = start["below"].states["cube"].stress
    np.testing.assert_allclose(
        stress, -34.6 * np.eye(6)[2][:, None, None] * np.ones_like(stress), atol=1e-9
    )
    # fewer iterations than by default: the stage tries many increments
    model = sc.Model(forms, fixed, newton=sc.Newton(max_iterations=10))
    with pytest.raises(sc.NotConverged) as stopped:
        model.run([sc.Stage("above", loads[1])], start=start)
    limit = (20.0 * np.tan(np.radians(60.0)) - 34.6) / 0.1
    # the search ends where an equilibrium and a collapse are 2 % of the way apart: which increments
    # lie between them hangs on the last bits.  A residual of 1e-8 of the load is 3e-6 of the step
    assert limit - 0.02 * limit <= stopped.value.result["above"].fraction <= limit + 1e-5


def sphere_errors(n: int) -> tuple[float, float]:
    """Largest errors, relative to the largest displacement and stress, of a hollow sphere under
    pressure inside.

    A quarter of the rays through the face x = 1 of a cube; y = 0 and z = 0 are planes of symmetry,
    and on the sides y = x and z = x the displacements are Lamé's.
    """
    angle = np.tan(np.linspace(0, np.pi / 4, n + 1))
    grid = MeshHex.init_tensor(np.linspace(1, 2, n + 1), angle, angle)
    ray = np.array([np.ones(grid.nvertices), grid.p[1], grid.p[2]])
    mesh = MeshHex(grid.p[0] * ray / np.linalg.norm(ray, axis=0), grid.t)
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    inside = np.flatnonzero((np.linalg.norm(mesh.p[:, mesh.facets], axis=0) < 1 + 1e-9).all(axis=0))

    E, nu, shrink = 100.0, 0.3, 1.0 / (2.0**3 - 1.0)
    radius, component = np.linalg.norm(basis.doflocs, axis=0), np.arange(basis.N) % 3
    radial = shrink / E * ((1 - 2 * nu) * radius + 4.0 * (1 + nu) / radius**2)
    exact = radial * basis.doflocs[component, np.arange(basis.N)] / radius
    x, y, z = basis.doflocs
    side = np.minimum(np.abs(y - x), np.abs(z - x)) < 1e-9
    fixed = np.flatnonzero(side | ((component == 1) & (y == 0)) | ((component == 2) & (z == 0)))

    form = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu), "full")
    load = traction(basis, inside, lambda w: -np.asarray(w.n))
    stage = sc.Stage("pressure", load, prescribed=exact)
    result = sc.Model({"sphere": form}, fixed).run([stage])["pressure"]
    mean = result.states["sphere"].stress[:3].mean(axis=0)  # the same everywhere
    return float(np.abs(result.x - exact).max() / exact.max()), float(
        np.abs(mean - shrink).max() / shrink
    )


def test_hollow_sphere():
    """[X] Lamé: displacements converge with the second order, the mean stress at the points with
    the first.
    """
    coarse, fine = sphere_errors(4), sphere_errors(8)
    assert np.log2(coarse[0] / fine[0]) > 1.8  # not yet quite 2 on four elements along the radius
    assert np.log2(coarse[1] / fine[1]) > 0.8
    assert fine[0] < 0.01


def _means(form, state):
    """Means over the elements, ordered by place: stresses of the plane and the plastic strain."""
    mesh = form.basis.mesh
    order = np.lexsort(mesh.p[:2, mesh.t].mean(axis=1).round(9))
    return [values.mean(axis=1)[order] for values in (*state.stress[:4], state.internal[0])]


@pytest.mark.parametrize("psi", [25.0, 0.0])
def test_plane_strain_is_a_slice_of_space(psi):
    """[N] A strip footing on yielding soil: one layer of hexahedra between held faces answers as
    the plane does.
    """
    x, y = np.linspace(0, 3, 10), np.linspace(-2, 0, 7)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=25.0, psi=psi)
    results = []
    for mesh, element in (
        (MeshQuad.init_tensor(x, y), ElementQuad1()),
        (MeshHex.init_tensor(x, y, np.array([0.0, 1.0])), ElementHex1()),
    ):
        dim = mesh.dim()
        basis = Basis(mesh, ElementVector(element), intorder=2)
        forms = {"soil": sc.SolidForm(basis, soil, "full")}
        down = -np.eye(dim)[1]
        footing = mesh.facets_satisfying(lambda p: (p[1] == 0) & (p[0] < 1))
        weight = sc.weight(basis, 20.0, direction=down)
        pressed = weight + 100.0 * traction(basis, footing, lambda w, d=down: d[:, None, None])
        component, (px, py) = np.arange(basis.N) % dim, basis.doflocs[:2]
        sides = (component == 0) & ((px == 0) | (px == 3))
        fixed = np.flatnonzero(sides | (py == -2) | (component == 2))
        stages = [sc.Stage("weight", weight), sc.Stage("footing", pressed, increments=3)]
        result = sc.Model(forms, fixed, newton=sc.Newton(tolerance=1e-12)).run(stages)
        nodes = np.lexsort(basis.doflocs[:2, ::dim])
        values = [result["footing"].field(q)[nodes] for q in ("ux", "uy", "u")]
        values += [
            np.repeat(v, dim - 1) for v in _means(forms["soil"], result["footing"].states["soil"])
        ]
        results.append((values, [stage.iterations for stage in result]))
    (plane, iterations), (space, same) = results
    assert (plane[-1] > 0).mean() > 0.2
    assert same == iterations
    for a, b in zip(plane, space, strict=True):  # both faces of the slice
        np.testing.assert_allclose(
            b.reshape(-1, 2), np.stack((a, a), axis=1), atol=1e-10 * np.abs(a).max(), rtol=0
        )


def test_factor_of_safety_of_a_column():
    """[X] The strength of the cube over its load: reduction of cohesion and tan(phi) down to
    collapse.
    """
    basis = box("Hex1", n=1)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0)
    top = basis.mesh.facets_satisfying(lambda x: x[2] == 1)
    factor = 1.5
    phi = np.arctan(np.tan(np.radians(30.0)) / factor)
    load = traction(
        basis,
        top,
        lambda w: -20.0 / factor * np.tan(np.pi / 4 + phi / 2) * np.eye(3)[2][:, None, None],
    )
    forms = {"cube": sc.SolidForm(basis, soil, "full")}
    found = sc.Model(forms, symmetry_planes(basis)).strength_reduction(load, reduce=["cube"])
    assert found.factor == pytest.approx(factor, rel=1e-3)


@pytest.mark.parametrize("element", ["Hex1", "TetP1"])
def test_stages(element):
    """[X] A layer is placed on ground and taken away; elastic ground is then as before, under the
    layer it is not.
    """
    mesh = box(element, n=2).mesh.with_subdomains(
        {"ground": lambda x: x[2] < 0.5, "fill": lambda x: x[2] > 0.5}
    )
    basis = Basis(mesh, ElementVector(ELEMENTS[element][1]()), intorder=2)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), ELASTIC, "full") for name in mesh.subdomains
    }
    ground, both = sc.weight(basis, {"ground": 20.0}), sc.weight(basis, 20.0)
    stages = [
        sc.Stage("ground", ground),
        sc.Stage("filled", both, activate="fill"),
        sc.Stage("cleared", ground, deactivate="fill"),
    ]
    result = sc.Model(forms, basis.get_dofs(lambda x: x[2] == 0).all()).run(stages)
    surface = basis.get_dofs(elements="ground").all()
    first, filled, last = (result[stage.name].x[surface] for stage in stages)
    np.testing.assert_allclose(last, first, atol=1e-7 * np.abs(first).max())  # Newton's tolerance
    assert filled.min() < 2.0 * first.min()


@pytest.mark.parametrize("element", ["TetP1", "HexS2"])
def test_ground_at_rest_under_water(element):
    """[X] Effective stresses of level ground whose water stands above it, with a joint in it."""
    lower, upper = box(element, n=2).mesh, box(element, n=3).mesh
    mesh = sc.join_bodies({"ground": lower, "block": upper.translated((0.0, 0.0, 1.0))})
    basis = Basis(mesh, box(element, n=1).elem, intorder=4)
    water = sc.hydrostatic(3.0, unit_weight=10.0)
    forms = {
        "soil": sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=30.0), "full"),
        "joint": sc.ContactPair(basis, "block:front", "ground:back", sc.Coulomb(mu=0.5)),
    }
    wet = [
        name for name in mesh.boundaries if ":" in name
    ]  # both sides of the joint too: front and back are z
    load = sc.weight(basis, 20.0) + sc.water_load(basis, water, wet)
    fixed = sc.box_supports(basis)
    start = sc.Model(forms, fixed).k0_state(
        load, unit_weights=20.0, K0=0.5, surcharge=10.0, water=water
    )["initial"]
    z = np.asarray(forms["soil"].basis.global_coordinates())[2]
    vertical = -10.0 * (2.0 - z)  # 20 a metre less 10 of water
    stress = [0.5 * vertical, 0.5 * vertical, vertical, 0 * z, 0 * z, 0 * z]
    np.testing.assert_allclose(start.states["soil"].stress, stress, atol=1e-12)
    assert start.residual < 1e-8  # the joint's tractions are found by an iteration
    np.testing.assert_allclose(start.tractions("joint").pressure, 10.0, rtol=1e-6)


def test_bodies_taken_apart():
    """[X] Nodes of the face between two bodies become double, and both sides of it get names."""
    mesh = box("Hex1", n=2).mesh.with_subdomains(
        {"low": lambda x: x[2] < 0.5, "high": lambda x: x[2] > 0.5}
    )
    joined = sc.join_bodies(mesh, bodies={"base": "low", "cover": "high"})
    assert joined.nvertices == mesh.nvertices + 9
    for name in ("base|cover", "cover|base"):
        facets = joined.boundaries[name]
        np.testing.assert_array_equal(joined.p[2, joined.facets[:, facets]], 0.5)
        assert len(facets) == 4
    assert not np.intersect1d(joined.boundaries["base|cover"], joined.boundaries["cover|base"]).size


# -- results


def test_results_are_saved_and_resumed(tmp_path):
    """[X] States of six components come back from a file, and the analysis goes on from them."""
    basis = box("Hex1", n=2)
    forms = {"cube": sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=1.0, phi=20.0), "full")}
    fixed = basis.get_dofs(lambda x: x[2] == 0).all()
    first, second = (
        sc.Stage(name, sc.weight(basis, gamma)) for name, gamma in (("first", 2.0), ("second", 3.0))
    )
    whole = sc.Model(forms, fixed).run([first, second])
    sc.Model(forms, fixed).run([first]).save(tmp_path / "result.npz")
    resumed = sc.Model(forms, fixed).run(
        [second], start=sc.load_result(tmp_path / "result.npz", forms)
    )
    np.testing.assert_allclose(
        resumed[-1].x, whole[-1].x, atol=1e-7 * np.abs(whole[-1].x).max()
    )  # Newton's tolerance


@pytest.mark.parametrize("element", ELEMENTS)
def test_files(element, tmp_path):
    """[X] VTK finds cells of positive volume, one in all, with the stresses of six components."""
    basis = box(element, n=2)
    forms = {"cube": sc.SolidForm(basis, ELASTIC, "full")}
    x = np.zeros(basis.N)
    x[1::3] = 1e-3 * basis.doflocs[2, 1::3]  # u_y = z: yz alone is strained
    state = forms["cube"].assemble(x, forms["cube"].initial_state()).state
    step = StageResult("sheared", x, 0 * x, {"cube": state}, (), 0.0, forms=forms)
    step.to_vtu(tmp_path / "cube.vtu")
    grid = pyvista.read(tmp_path / "cube.vtu")
    volumes = grid.compute_cell_sizes()["Volume"]
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(1.0)
    shear = 1e-3 * 100.0 / 2.6
    np.testing.assert_allclose(
        grid["stress"], np.tile([0, 0, 0, 0, shear, 0], (grid.n_cells, 1)), atol=1e-12
    )
    np.testing.assert_allclose(grid["displacement"][:, 1], 1e-3 * grid.points[:, 2], atol=1e-9)
    np.testing.assert_allclose(step.field("syz"), shear)
    np.testing.assert_allclose(step.field("s3"), -shear)
    np.testing.assert_allclose(step.field("mises"), np.sqrt(3) * shear)
    np.testing.assert_allclose(step.field("uz"), 0.0)


@pytest.mark.parametrize("element", ["TetP1", "HexS2"])
def test_section_forces_of_a_pile(element):
    """[X] Statics of a column under forces at its head and its weight: exact, however coarse the
    mesh.

    The weight of tetrahedra has no centre on the axis.
    """
    kind, elem, intorder = ELEMENTS[element]
    mesh = kind.init_tensor(
        np.linspace(-0.5, 0.5, 3), np.linspace(-0.5, 0.5, 3), np.linspace(0.0, 4.0, 6)
    )
    basis = Basis(mesh, ElementVector(elem()), intorder=intorder)
    forms = {"pile": sc.SolidForm(basis, ELASTIC, "full")}
    head = mesh.facets_satisfying(lambda x: x[2] > 4.0 - 1e-9)
    gamma = 5.0 if kind is MeshHex else 0.0
    at_head = traction(
        basis, head, lambda w: [2.0 - 6 * w.x[1], 1.0 + 6 * w.x[0], -30.0 + 0 * w.x[0]]
    )
    load = sc.weight(basis, gamma) + at_head
    step = sc.Model(forms, basis.get_dofs(lambda x: x[2] < 1e-9).all()).run(
        [sc.Stage("load", load)], progress=False
    )["load"]
    z = np.array([0.8, 1.6, 2.5, 3.2])  # on layers of nodes, and between them
    found = step.section_forces("pile", sc.Cuts.line((0, 0, 0.8), (0, 0, 3.2), depth=1.5, n=4))
    z = 0.8 + found.position
    np.testing.assert_allclose(found.N, -30.0 - gamma * (4.0 - z), rtol=1e-9)
    np.testing.assert_allclose(found.T, 1.0, rtol=1e-9)  # 6 (x^2 + y^2) over the head
    np.testing.assert_allclose(found.V, np.tile([2.0, 1.0, 0.0], (4, 1)), atol=1e-9)
    np.testing.assert_allclose(
        found.M, np.stack((-1.0 * (4 - z), 2.0 * (4 - z), 0 * z), axis=1), atol=1e-8
    )
    side = found.towards((-1, 0, 0))  # pushed to the right the fibres on the left are in tension
    np.testing.assert_allclose(side.M, 2.0 * (4 - z), atol=1e-8)
    np.testing.assert_allclose(side.V, np.gradient(side.M, found.position), atol=1e-8)  # V = dM/ds
    with pytest.raises(ValueError, match="across its axis"):
        found.towards((0, 0, 1))


# -- bad input


def test_other_plane_things():
    """Pictures of the plane refuse bodies in space, and cuts in the plane do not cut them."""
    basis = box("Hex1", n=1)
    form = sc.SolidForm(basis, ELASTIC, "full")
    forms, state = {"cube": form}, form.initial_state()
    step = StageResult(
        "none", np.zeros(basis.N), np.zeros(basis.N), {"cube": state}, (), 0.0, forms=forms
    )
    with pytest.raises(
        ValueError, match=r"plot\.contour is for plane bodies, but this is a MeshHex1 in three dim"
    ):
        plot.contour(step, "ux")
    with pytest.raises(ValueError, match="these sections have 2 coordinates, the body has 3"):
        section_forces(form, state, sc.Cuts.line((0.0, 0.0), (1.0, 0.0), 1.0))


def test_strain_of_other_dimension():
    plane = Basis(MeshQuad(), ElementVector(ElementQuad1()), intorder=2)
    for wrong in ("plane", "axisymmetric"):
        with pytest.raises(
            ValueError, match=f"coordinates of a MeshHex1 must be 'space', not '{wrong}'"
        ):
            sc.SolidForm(box("Hex1"), ELASTIC, coordinates=wrong)
    with pytest.raises(
        ValueError,
        match="coordinates of a MeshQuad1 must be 'plane' or 'axisymmetric', not 'space'",
    ):
        sc.SolidForm(plane, ELASTIC, coordinates="space")
    with pytest.raises(ValueError, match="no strain 'b_bar' in axial symmetry"):
        sc.SolidForm(plane, ELASTIC, "b_bar", coordinates="axisymmetric")
    with pytest.raises(
        ValueError, match="strain must be one of 'full', 'b_bar', 'f_bar' or None, not 'plane'"
    ):
        sc.SolidForm(plane, ELASTIC, "plane")


@pytest.mark.parametrize("element", ["Hex1", "TetP2", "Hex2", "HexS2"])
def test_too_few_points(element):
    """One point for linear and quadratic elements; eight are enough for 20 nodes, not for 27."""
    kind, elem, _ = ELEMENTS[element]
    middle = np.full((3, 1), 0.25), np.ones(1) / (6 if kind is MeshTet else 1)
    rule = {"intorder": 2} if element == "Hex2" else {"quadrature": middle}
    with pytest.raises(ValueError, match=f"integration points are too few for Element{element}"):
        sc.SolidForm(Basis(kind(), ElementVector(elem()), **rule), ELASTIC, "full")


def test_eight_points_are_enough_for_twenty_nodes():
    """[X] Reduced integration leaves single elements modes without strain, but not an assembly of
    them.
    """
    kind, elem, _ = ELEMENTS["HexS2"]
    basis = Basis(kind.init_tensor(*3 * [np.linspace(0, 1, 3)]), ElementVector(elem()), intorder=2)
    form = sc.SolidForm(basis, ELASTIC, "full")
    stiffness = np.linalg.eigvalsh(form.elastic_stiffness.toarray())
    assert (stiffness > 1e-9 * stiffness[-1]).sum() == basis.N - 6


@pytest.mark.parametrize("held, left", [((), 6), (("u^1", "u^2"), 3), (("u^3",), 3)])
def test_loose_body(held, left):
    """A face z = 0 that is held in some directions leaves the other rigid motions free."""
    basis = box("Hex1", n=1)
    forms = {"cube": sc.SolidForm(basis, ELASTIC, "full")}
    face = basis.get_dofs(lambda x: x[2] == 0)
    fixed = np.concatenate([face.all(name) for name in held]) if held else np.zeros(0, int)
    with pytest.raises(ValueError, match=f"is not held: .* leaves {left} of 6 rigid motions free"):
        sc.Model(forms, fixed).run([sc.Stage("weight", sc.weight(basis, 1.0))])


def test_body_that_floats_beside_another():
    mesh = sc.join_bodies(
        {"a": box("TetP1").mesh, "b": box("TetP1").mesh.translated((2.0, 0.0, 0.0))}
    )
    basis = Basis(mesh, ElementVector(ElementTetP1()), intorder=2)
    forms = {"both": sc.SolidForm(basis, ELASTIC, "full")}
    with pytest.raises(ValueError, match="body 'b' is not held: 0 of the dofs are fixed"):
        sc.Model(forms, basis.get_dofs("a:left").all()).run(
            [sc.Stage("weight", sc.weight(basis, 1.0))]
        )


def test_bad_meshes():
    """Inverted and flat elements are found in space as in the plane."""
    cubes = MeshHex.init_tensor(*3 * [np.linspace(0, 1, 3)])
    middle = np.flatnonzero((cubes.p == 0.5).all(axis=0))
    moved = cubes.p.copy()
    moved[:, middle] = 0.02
    sc.mesh.check_mesh(cubes)
    sc.mesh.check_mesh(cubes.scaled((1e-6, 1e-6, -1e-6)))
    with pytest.raises(
        ValueError, match=r"inverted elements, 1 in all: element \d at \(0.\d+, 0.\d+, 0.\d+\)"
    ):
        sc.mesh.check_mesh(MeshHex(moved, cubes.t))
    with pytest.raises(ValueError, match="flat elements, 8 in all"):
        sc.mesh.check_mesh(cubes.scaled((1.0, 1.0, 0.0)))
