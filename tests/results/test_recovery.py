"""Recovered stresses: fibres of beams, a thick ring, the surface of ground, regions that stay
apart.
"""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementHex1, ElementQuad1, ElementVector, MeshHex, MeshQuad, MeshTri

import skfem_contact as sc
from skfem_contact.demo import culvert
from skfem_contact.forms.solid import SolidState
from skfem_contact.results import StageResult
from skfem_contact.results.patch_recovery import recovered, recovered_together, region_mesh
from skfem_contact.results.strength import PointStatus, mobilised, point_status
from tests.tools.helpers import distorted, rotation, traction, vector_basis

INTORDER = {"P1": 1, "Q1": 2, "P2": 4, "Q2": 4, "QuadS2": 4}


def beam(element, layers, columns, strain="full", nu=0.0):
    """A cantilever of 10 x 1 with the force 1 at its end: the fibre on top of midspan has 6 M / h^2
    = 30.
    """
    kind = MeshTri if element.startswith("P") else MeshQuad
    x, y = np.linspace(0, 10, columns * layers + 1), np.linspace(-0.5, 0.5, layers + 1)
    mesh = kind.init_tensor(x, y).with_defaults()
    basis = vector_basis(mesh, element, intorder=INTORDER[element])
    forms = {"beam": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=nu), strain=strain)}
    load = traction(basis, "right", (0.0, -1.0))
    return forms, sc.Model(forms, basis.get_dofs("left").all()).run(
        [sc.Stage("load", load)], progress=False
    )["load"]


def node_at(basis, x, y):
    return int(np.argmin(np.hypot(basis.doflocs[0, 0::2] - x, basis.doflocs[1, 0::2] - y)))


# elements as long as high would be the natural choice of columns, 10; full integration is too stiff
# with these (2.8 % with four layers), and B-bar too soft in elements that are twice as high as long
# (1.3 %)
@pytest.mark.parametrize("layers", [1, 2, 3, 4])
@pytest.mark.parametrize(
    "element, columns, strain",
    [
        ("Q1", 20, "full"),
        ("Q1", 16, "b_bar"),
        ("Q2", 10, "full"),
        ("QuadS2", 10, "full"),
        ("P2", 20, "full"),
    ],
)
@pytest.mark.one_in(3)
def test_fibre_of_a_beam(element, columns, strain, layers):
    """[X] 30.0 within 1 % for one to four layers of elements; what is free of load has next to no
    stress across it.
    """
    forms, stage = beam(element, layers, columns, strain)
    at = node_at(forms["beam"].basis, 5.0, 0.5)
    assert stage.field("sxx")[at] == pytest.approx(30.0, rel=0.01)
    if layers > 1:
        assert abs(stage.field("syy")[at]) < 0.1


def test_crown_of_a_thick_ring():
    """[X] The inner fibre of the culvert's crown within 4 % of the theory of curved beams
    (Winkler): four layers.
    """
    model = culvert()
    stage = model.result["surcharge"]
    inner, outer = 0.72, 0.90
    cut = stage.section_forces("culvert", sc.Cuts.ring((0.0, 0.0), inner, outer, n=72))
    depth, middle = outer - inner, 0.5 * (inner + outer)
    neutral = depth / np.log(outer / inner)
    # the stress of a moment is M y / (A e r) with y from the neutral axis and e its distance from
    # the middle
    fibre = cut.N[0] / depth - cut.M[0] * (neutral - inner) / (depth * (middle - neutral) * inner)
    x, y = model.basis.doflocs[:, 0::2]
    crown = np.flatnonzero(np.abs(np.hypot(x, y) - inner) < 1e-3)
    crown = crown[np.argmax(y[crown])]
    assert stage.field("sxx")[crown] == pytest.approx(fibre, rel=0.04)


@pytest.mark.parametrize("element, strain", [("Q1", "b_bar"), ("P2", "full")])
def test_stress_of_the_ground_is_zero_at_its_surface(element, strain):
    """[X] Linear with depth, up to both ends: means of elements would be off by half of an
    element.
    """
    kind = MeshTri if element.startswith("P") else MeshQuad
    mesh = kind.init_tensor(np.linspace(0, 1, 5), np.linspace(0, 1, 5)).with_defaults()
    basis = vector_basis(mesh, element, intorder=INTORDER[element])
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), strain=strain)}
    fixed = np.hstack(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    stage = sc.Model(forms, fixed).run(
        [sc.Stage("weight", sc.weight(basis, 20.0))], progress=False
    )["weight"]
    found = stage.field("syy")
    # the stresses themselves, means of elements, have a weight of a hundredth beside the forces
    np.testing.assert_allclose(found, -20.0 * (1.0 - basis.doflocs[1, 0::2]), atol=0.01)


@pytest.mark.parametrize("element", list(INTORDER))
def test_linear_stress_is_met_on_distorted_meshes(element, rng):
    """[X] A linear field of all components, in every element and at the boundary."""
    kind = MeshTri if element.startswith("P") else MeshQuad
    mesh = distorted(kind.init_tensor(np.linspace(0, 2, 6), np.linspace(0, 1, 4)), rng, 0.03)
    basis = vector_basis(mesh, element, intorder=4)
    form = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3))
    slope = rng.standard_normal((4, 3))

    def exact(x):
        return np.einsum("ck,k...->c...", slope, np.concatenate((np.ones((1, *x.shape[1:])), x)))

    found = recovered(form, exact(np.asarray(basis.global_coordinates())), balanced=True)
    np.testing.assert_allclose(found, exact(basis.doflocs[:, ::2]), atol=1e-8)


@pytest.mark.parametrize("element", ["P1", "Q1", "P2", "QuadS2"])
def test_stresses_turn_with_the_mesh(element, rng):
    """[X] Stresses that vary at random among the points, turned by 33 degrees with their mesh,
    have the same principal stresses at the nodes.
    """
    kind = MeshTri if element.startswith("P") else MeshQuad
    mesh = distorted(kind.init_tensor(np.linspace(0, 2, 6), np.linspace(0, 1, 4)), rng, 0.03)
    R = rotation(33.0)
    principal = []
    for turn in (np.eye(2), R):
        basis = vector_basis(kind(turn @ mesh.p, mesh.t), element, intorder=4)
        form = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3))
        if turn is not R:
            xx, yy, zz, xy = rng.standard_normal((4, *form.weight.shape))
        tensor = np.einsum("ij,jkep,lk->ilep", turn, np.array([[xx, xy], [xy, yy]]), turn)
        stress = np.stack((tensor[0, 0], tensor[1, 1], zz, tensor[0, 1]))
        a, b, _, shear = recovered(form, stress, balanced=True)
        tensors = np.array([[a, shear], [shear, b]]).transpose(2, 0, 1)
        principal.append(np.linalg.eigvalsh(tensors))
    np.testing.assert_allclose(principal[1], principal[0], atol=1e-8)


def test_linear_stress_in_space():
    """[X] The same for B-bar hexahedra: the averaged volume strain has forces that linear fields do
    not have.
    """
    basis = Basis(
        MeshHex.init_tensor(*3 * [np.linspace(0, 1, 4)]), ElementVector(ElementHex1()), intorder=2
    )
    form = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), strain="full")
    x = np.asarray(basis.global_coordinates())
    found = recovered(form, np.stack([1.0 + x[i % 3] for i in range(6)]), balanced=True)
    places = basis.doflocs[:, ::3]
    np.testing.assert_allclose(found, np.stack([1.0 + places[i % 3] for i in range(6)]), atol=1e-8)


def two_layers():
    mesh = (
        MeshQuad.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 2, 5))
        .with_defaults()
        .with_subdomains({"lower": lambda x: x[1] < 1, "upper": lambda x: x[1] > 1})
    )
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soils = {"lower": sc.LinearElastic(E=1e3, nu=0.3), "upper": sc.LinearElastic(E=4e3, nu=0.3)}
    return basis, sc.SolidForm(basis, soils)


def test_regions_stay_apart():
    """[X] Uniform strain: stresses jump at the border of two materials, and each side has its
    own.
    """
    basis, form = two_layers()
    x = basis.zeros()
    x[1::2] = -1e-3 * basis.doflocs[1, 1::2]
    stress = form.assemble(x, form.initial_state()).state.stress
    found, mesh = recovered(form, stress, balanced=True)[1], region_mesh(form)
    for region, E in enumerate((1e3, 4e3)):
        np.testing.assert_allclose(
            found[mesh.cells[mesh.region == region]], -1e-3 * E * 0.7 / (1.3 * 0.4)
        )


def test_limited_fields_stay_within_the_points(rng):
    _, form = two_layers()
    values = rng.uniform(size=(1, *form.weight.shape))
    for node, value in enumerate(recovered(form, values, limited=True)[0]):
        around = values[0, (region_mesh(form).cells == node).any(axis=1)]
        assert around.min() <= value <= around.max()


@pytest.mark.parametrize("balanced", [True, False])
def test_fields_that_are_recovered_together_are_those_recovered_alone(rng, balanced):
    """The same patches serve all fields; only the stresses are balanced."""
    _, form = two_layers()
    stress, strain = rng.standard_normal((2, 4, *form.weight.shape))
    plastic = rng.uniform(size=(1, *form.weight.shape))
    together = recovered_together(form, stress, strain, plastic, balanced=balanced)
    alone = recovered(form, stress, balanced=balanced), recovered(form, strain)
    for found, expected in zip(together, (*alone, recovered(form, plastic)), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-11)


def test_change_since_a_stage_strains_and_pore_pressure():
    """[X] Uniform strains: changes of strains are those of the displacements."""
    basis, form = two_layers()
    forms, stages = {"soil": form}, []
    for number, amount in enumerate((1e-3, 3e-3)):
        x = basis.zeros()
        x[0::2], x[1::2] = amount * basis.doflocs[1, 0::2], -amount * basis.doflocs[1, 1::2]
        states = {"soil": form.assemble(x, form.initial_state()).state}
        stages.append(StageResult(str(number), x, 0 * x, states, (), 0.0, forms=forms))
    expected = {"exy": 2e-3, "eyy": -2e-3, "exx": 0.0, "ev": -2e-3, "gamma": np.hypot(2e-3, 2e-3)}
    for quantity, value in expected.items():
        field = stages[1].field(quantity, since=stages[0])
        np.testing.assert_allclose(field, value, atol=1e-15)
    water = sc.hydrostatic(1.0, unit_weight=10.0)
    np.testing.assert_allclose(
        stages[0].field("pore", water=water), 10.0 * np.maximum(1.0 - basis.mesh.p[1], 0.0)
    )
    with pytest.raises(ValueError, match="give water="):
        stages[0].field("pore")


@pytest.mark.parametrize(
    "law, stress, share",
    [
        (sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=0.0), [-20.0, -30.0, -25.0, 0.0], 0.5),
        (sc.MohrCoulomb(E=1e4, nu=0.3, c=0.0, phi=30.0), [-10.0, -30.0, -20.0, 0.0], 1.0),
        (sc.Tresca(E=1e4, nu=0.3, c=10.0), [0.0, 0.0, 0.0, 4.0], 0.4),
        (sc.VonMises(E=1e4, nu=0.3, strength=10.0), [5.0, 0.0, 0.0, 0.0], 0.5),
        (sc.DruckerPrager(E=1e4, nu=0.3, k=5.0, alpha=0.1), [-10.0, -10.0, -10.0, 4.0], 0.5),
        (sc.LinearElastic(E=1e4, nu=0.3), [-20.0, -30.0, -25.0, 0.0], 0.0),
    ],
)
def test_mobilised_strength(law, stress, share):
    """[X] Mohr's circle by hand, and the cones."""
    basis, _ = two_layers()
    form = sc.SolidForm(basis, law)
    state = form.initial_state()
    state = SolidState(state.strain, state.stress + np.array(stress)[:, None, None], state.internal)
    np.testing.assert_allclose(mobilised(form, state), share)
    expected = PointStatus.YIELDS if share == 1.0 else PointStatus.ELASTIC
    assert (point_status(form, state) == expected).all()


def test_tension_points():
    """A point at the cut-off is torn, not yielding."""
    basis, _ = two_layers()
    form = sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0, tension=2.0))
    state = form.assemble(
        1e-2 * basis.doflocs[0] * (np.arange(basis.N) % 2 == 0), form.initial_state()
    ).state
    assert (point_status(form, state) == PointStatus.TENSION).all()


def test_slice_in_space_is_the_plane():
    """[N] A layer of hexahedra held across has the stresses of its plane section, away from the
    clamp.
    """
    x, y = np.linspace(0, 3, 10), np.linspace(0, 1, 7)
    fields = []
    for mesh in (MeshQuad.init_tensor(x, y), MeshHex.init_tensor(x, y, np.linspace(0, 0.2, 2))):
        dim = mesh.dim()
        mesh = mesh.with_boundaries(
            {"end": lambda p: p[0] > 3 - 1e-9, "clamp": lambda p: p[0] < 1e-9}
        )
        basis = Basis(
            mesh, ElementVector(ElementQuad1() if dim == 2 else ElementHex1()), intorder=2
        )
        forms = {"beam": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), strain="b_bar")}
        across = np.arange(2, basis.N if dim == 3 else 0, 3)
        fixed = np.union1d(basis.get_dofs("clamp").all(), across)
        load = sc.traction(basis, "end", (0.0, -1.0, 0.0)[:dim])
        stage = sc.Model(forms, fixed).run([sc.Stage("load", load)], progress=False)["load"]
        chosen = np.flatnonzero((mesh.p[0] > 0.6) & ((dim == 2) | (mesh.p[-1] < 0.1)))
        chosen = chosen[np.lexsort(mesh.p[:2, chosen].round(9))]
        fields.append([stage.field(name)[chosen] for name in ("sxx", "syy", "sxy")])
    for plane, slice_ in zip(*fields, strict=True):
        assert np.abs(slice_ - plane).max() < 0.02 * max(np.abs(plane).max(), 1.0)


def test_frames_have_pore_pressures_where_there_are_any():
    """Those of undrained ground are a column of the frame; where nothing is undrained there is
    none.
    """
    pytest.importorskip("pandas")
    basis, _ = two_layers()
    soil = sc.LinearElastic(E=1e3, nu=0.2)
    for material, there in ((soil, False), (sc.Undrained(soil, nu_undrained=0.49), True)):
        forms = {"soil": sc.SolidForm(basis, material)}
        stages = [sc.Stage("load", sc.weight(basis, 10.0))]
        stage = sc.Model(forms, sc.box_supports(basis)).run(stages, progress=False)["load"]
        frame = stage.to_frame()
        assert ("pore" in frame.columns) == there
        if there:
            np.testing.assert_allclose(frame["pore"], stage.field("pore"))


def test_pore_pressure_of_the_stages_own_water(tmp_path):
    """[X] A level, a level by region and a flow in porous ground below concrete: their pressure at
    the nodes.
    """
    basis, _ = two_layers()
    mesh = basis.mesh
    forms = {
        name: sc.SolidForm(
            basis.with_elements(name), sc.LinearElastic(E=1e4, nu=0.3), porous=name == "lower"
        )
        for name in ("lower", "upper")
    }
    porous = np.unique(mesh.t[:, mesh.subdomains["lower"]])
    only = np.setdiff1d(porous, mesh.t[:, mesh.subdomains["upper"]])
    flow = sc.water.Flow(basis.with_elements("lower"), 1e-5, unit_weight=10.0).steady(
        sc.water.Conditions(head={"left": 3.0, "right": 2.5})
    )
    model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=10.0)
    stages = [
        sc.Stage("still", water=3.0),
        sc.Stage("parts", water={"lower": 0.6}),
        sc.Stage("flow", water=flow),
        sc.Stage("none", water=False),
    ]
    result = model.run(stages, progress=False)
    y = basis.doflocs[1, ::2]
    still = result["still"].field("pore", water=True)
    np.testing.assert_allclose(still[only], 10.0 * (3.0 - y[only]), rtol=1e-12)
    assert not still[np.setdiff1d(np.arange(len(y)), porous)].any()  # concrete has no pores
    lower = result["parts"].field("pore", water=True)
    np.testing.assert_allclose(
        lower[only], 10.0 * np.maximum(0.6 - y[only], 0.0), rtol=1e-12, atol=1e-12
    )
    np.testing.assert_allclose(
        result["parts"].field("pore", since=result["still"], water=True), lower - still
    )
    np.testing.assert_allclose(
        result["flow"].field("pore", water=True)[only], flow.pressure[only], rtol=1e-9
    )
    assert not result["none"].field("pore", water=True).any()
    result.save(tmp_path / "wet.npz")
    loaded = sc.load_result(tmp_path / "wet.npz", forms)
    np.testing.assert_array_equal(loaded["parts"].field("pore", water=True), lower)
    with pytest.raises(ValueError, match="the water of stage 'flow' is a function or a seepage"):
        loaded["flow"].field("pore", water=True)
    with pytest.raises(ValueError, match="give water=True"):
        result["still"].field("pore")
