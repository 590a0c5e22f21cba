"""Solid bodies: regions and their order, states, shared data of changed materials, own weight."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from scipy.integrate import trapezoid
from skfem import Basis, ElementQuad2, ElementVector, LinearForm, MeshQuad

import skfem_contact as sc
from skfem_contact.materials import Update
from tests.tools.helpers import ELEMENTS, distorted, grid, rotation, vector_basis

# Sums of some hundred terms in another order.
ROUND_OFF = 1e-13
SOIL = sc.MohrCoulomb(E=100.0, nu=0.3, c=0.5, phi=30.0, psi=5.0)


def layered(element: str = "Q1", rng: np.random.Generator | None = None):
    """A plate whose elements belong to three regions in stripes across the element numbers."""
    mesh = grid(element, np.linspace(0, 2, 7), np.linspace(0, 1, 5))
    if rng is not None:
        mesh = distorted(mesh, rng, 0.03)
    number = np.arange(mesh.nelements) % 3
    return mesh.with_subdomains({name: np.flatnonzero(number == k) for k, name in enumerate("abc")})


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("order", ["abc", "cab"])
@pytest.mark.parametrize("restricted", [False, True])
def test_states_follow_the_order_of_the_basis(element, order, restricted, rng):
    """[X] form.basis.tind names the element of every column: strain of scikit-fem, stress of its
    region.
    """
    basis = vector_basis(layered(element, rng), element)
    if restricted:
        order = order[:2]
        basis = basis.with_elements(tuple(order))
    moduli = {name: 10.0 ** (k + 1) for k, name in enumerate("abc")}
    form = sc.SolidForm(basis, {name: sc.LinearElastic(E=moduli[name], nu=0.2) for name in order})
    x = rng.standard_normal(basis.N)
    state = form.assemble(x, form.initial_state()).state

    tind = np.arange(basis.mesh.nelements) if form.basis.tind is None else form.basis.tind
    region = np.array(list("abc"))[tind % 3]
    assert sorted(tind) == sorted(
        np.flatnonzero(
            np.isin(np.arange(basis.mesh.nelements) % 3, ["abc".index(n) for n in order])
        )
    )
    g = np.asarray(basis.with_elements(tind).interpolate(x).grad)
    expected = np.stack((g[0, 0], g[1, 1], 0 * g[0, 0], g[0, 1] + g[1, 0]))
    np.testing.assert_allclose(state.strain, expected, atol=ROUND_OFF * np.abs(expected).max())
    E = np.array([moduli[name] for name in region])[:, None]
    np.testing.assert_allclose(state.stress[3], E / 2.4 * expected[3], rtol=1e-12, atol=1e-12)


def test_parameter_arrays_follow_the_elements_of_their_region(rng):
    """[X] An array gives the same as one region for every element."""
    mesh = layered("Q1", rng)
    single = {f"e{k}": np.array([k]) for k in range(mesh.nelements)}
    basis = vector_basis(mesh.with_subdomains(single), "Q1")
    E = rng.uniform(1, 9, mesh.nelements)
    by_array = sc.SolidForm(
        basis, {n: sc.LinearElastic(E=E[mesh.subdomains[n]], nu=0.3) for n in "cab"}
    )
    by_region = sc.SolidForm(
        basis, {f"e{k}": sc.LinearElastic(E=E[k], nu=0.3) for k in range(mesh.nelements)}
    )
    difference = abs(by_array.elastic_stiffness - by_region.elastic_stiffness).max()
    assert difference <= ROUND_OFF * abs(by_region.elastic_stiffness).max()


def test_result_does_not_depend_on_the_order_of_the_regions(rng):
    """[X] Another order of the materials: the same force and tangent."""
    basis = vector_basis(layered("Q1", rng), "Q1")
    materials = {
        "a": SOIL,
        "b": sc.LinearElastic(E=50.0, nu=0.2),
        "c": sc.LinearElastic(E=900.0, nu=0.1),
    }
    x = 0.01 * rng.standard_normal(basis.N)
    outs = []
    for names in ("abc", "cba"):
        form = sc.SolidForm(basis, {n: materials[n] for n in names})
        outs.append(form.assemble(x, form.initial_state()))
    scale = np.abs(outs[0].force).max()
    np.testing.assert_allclose(outs[0].force, outs[1].force, atol=ROUND_OFF * scale)
    assert (
        abs(outs[0].stiffness - outs[1].stiffness).max() <= ROUND_OFF * abs(outs[0].stiffness).max()
    )


@pytest.mark.parametrize("element", ELEMENTS)
def test_rigid_motion_exerts_no_force(element, rng):
    """[X] Two translations and the small rotation, on a distorted mesh."""
    basis = vector_basis(layered(element, rng), element)
    form = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.3))
    modes = np.zeros((3, basis.N))
    modes[0, ::2] = modes[1, 1::2] = 1
    modes[2, ::2], modes[2, 1::2] = -basis.doflocs[1, ::2], basis.doflocs[0, 1::2]
    scale = abs(form.elastic_stiffness).max()
    for mode in modes:
        assert (
            np.abs(form.assemble(mode, form.initial_state()).force).max() < ROUND_OFF * scale * 10
        )


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("strain", ["full", "b_bar"])
def test_patch_test(element, strain, rng):
    """[X] A linear displacement field has constant strains, and no force acts on the inner
    nodes.
    """
    basis = vector_basis(layered(element, rng), element)
    form = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.3), strain)
    gradient = np.array([[0.1, -0.3], [0.2, 0.4]])
    x = (basis.doflocs[:, ::2].T @ gradient.T).ravel()
    out = form.assemble(x, form.initial_state())
    # the sum over the out-of-plane row of B-bar vanishes: strains are of order one
    assert np.abs(out.state.strain - np.array([0.1, 0.4, 0, -0.1])[:, None, None]).max() < 1e-12
    inner = np.setdiff1d(np.arange(basis.N), basis.get_dofs(basis.mesh.boundary_facets()).all())
    assert np.abs(out.force[inner]).max() < 1e-12 * np.abs(out.force).max()


def test_assemble_changes_nothing(rng):
    """[X] State and displacements are the same afterwards, and a second call answers the same
    bits.
    """
    basis = vector_basis(layered("P2", rng), "P2")
    form = sc.SolidForm(basis, SOIL)
    first = form.assemble(0.01 * rng.standard_normal(basis.N), form.initial_state()).state
    x = 0.01 * rng.standard_normal(basis.N)
    before = [a.copy() for a in (x, first.strain, first.stress, first.internal)]
    out, again = form.assemble(x, first), form.assemble(x, first)
    out.stiffness  # noqa: B018  computing the tangent must change nothing either
    for old, now in zip(before, (x, first.strain, first.stress, first.internal), strict=True):
        assert np.array_equal(old, now)
    assert np.array_equal(out.force, again.force) and np.array_equal(
        out.state.internal, again.state.internal
    )
    assert np.array_equal(out.stiffness.data, again.stiffness.data)


def test_states_go_on_from_the_accepted_one(rng):
    """[X] The stress of an elastic body depends on the last displacement only; a plastic one
    remembers.
    """
    basis = vector_basis(layered("Q1", rng), "Q1")
    x, y = 0.05 * rng.standard_normal((2, basis.N))
    elastic = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.3))
    once = elastic.assemble(y, elastic.initial_state())
    twice = elastic.assemble(y, elastic.assemble(x, elastic.initial_state()).state)
    # stresses are summed up over two increments of strain of order 1: E eps = 100 times round-off
    np.testing.assert_allclose(twice.state.stress, once.state.stress, atol=1e-12)
    plastic = sc.SolidForm(basis, SOIL)
    there = plastic.assemble(x, plastic.initial_state()).state
    back = plastic.assemble(basis.zeros(), there).state
    assert np.abs(back.stress).max() > 0.1  # residual stresses
    assert (back.internal >= there.internal).all() and back.internal.max() > 0
    assert (
        plastic.outputs(x, back).summary.endswith("yielded")
        and plastic.outputs(x, plastic.initial_state()).summary == ""
    )


@dataclass(frozen=True)
class Counting:
    """Elastic, but every point claims a tangent of its own; counts how often that is computed."""

    E: float = 10.0
    calls: list = field(default_factory=list)
    n_internal: int = 0

    def elasticity(self, ncomp):
        return self.E * np.eye(ncomp)

    def update(self, strain_increment, stress, internal):
        n = strain_increment[0].size

        def tangent():
            self.calls.append(1)
            return np.broadcast_to(self.E * np.eye(4), (n, 4, 4))

        return Update(stress + self.E * strain_increment, internal, np.arange(n), tangent)


def test_line_search_never_pays_for_a_tangent():
    """[X] The material's tangent is computed at the first access of the stiffness, and once."""
    basis = vector_basis(layered(), "Q1")
    material = Counting()
    form = sc.SolidForm(basis, material)
    out = form.assemble(np.ones(basis.N), form.initial_state())
    assert material.calls == []
    first = out.stiffness
    assert out.stiffness is first and material.calls == [1]
    assert abs(first - form.elastic_stiffness).max() == 0  # the correction D - D is exactly zero


def test_with_materials_shares_what_does_not_change(rng):
    """[X] Strength alone: even the elastic stiffness is shared. Stiffness: it is computed anew, for
    both.
    """
    basis = vector_basis(layered("Q1", rng), "Q1")
    form = sc.SolidForm(basis, {"a": SOIL, "b": SOIL, "c": sc.LinearElastic(E=1e3, nu=0.2)})
    elastic = form.elastic_stiffness
    weaker = form.with_materials({"a": SOIL.reduced(2.0)})
    assert weaker._B is form._B and weaker.weight is form.weight and weaker.basis is form.basis
    assert weaker.elastic_stiffness is elastic
    assert (
        weaker.materials["a"] is not SOIL
        and form.materials["a"] is SOIL
        and weaker.materials["b"] is SOIL
    )

    stiffer = form.with_materials({"c": sc.LinearElastic(E=5e3, nu=0.2)})
    assert stiffer._B is form._B
    new = sc.SolidForm(basis, {"a": SOIL, "b": SOIL, "c": sc.LinearElastic(E=5e3, nu=0.2)})
    assert abs(stiffer.elastic_stiffness - new.elastic_stiffness).max() == 0
    assert form.elastic_stiffness is elastic
    x = 0.01 * rng.standard_normal(basis.N)
    ours, theirs = (f.assemble(x, f.initial_state()) for f in (stiffer, new))
    assert np.array_equal(ours.force, theirs.force)
    assert np.array_equal(ours.stiffness.data, theirs.stiffness.data)


def test_with_materials_names_an_unknown_region():
    form = sc.SolidForm(vector_basis(layered(), "Q1"), dict.fromkeys("abc", SOIL))
    with pytest.raises(ValueError, match=r"no region of this solid 'clay'; existing: a, b, c"):
        form.with_materials({"clay": SOIL})


def test_from_elastic_to_plastic(rng):
    """[X] A body that was elastic so far goes on with a plastic law, from the stresses that it
    carries.
    """
    basis = vector_basis(layered("Q1", rng), "Q1")
    elastic = sc.SolidForm(basis, {n: sc.LinearElastic(E=100.0, nu=0.3) for n in "abc"})
    x = 1e-4 * rng.standard_normal(basis.N)
    state = elastic.assemble(x, elastic.initial_state()).state
    plastic = elastic.with_materials({"b": SOIL})
    out = plastic.assemble(x, state)
    assert out.state.internal.shape == plastic.initial_state().internal.shape
    np.testing.assert_allclose(out.force, elastic.assemble(x, state).force, atol=1e-14)
    # loaded on, it yields as if it had been plastic from the start: the first part was elastic
    always = plastic.assemble(x, plastic.initial_state()).state
    ours, theirs = (plastic.assemble(300 * x, s).state for s in (state, always))
    assert ours.internal.max() > 0
    np.testing.assert_allclose(ours.stress, theirs.stress, atol=1e-12)
    np.testing.assert_allclose(ours.internal, theirs.internal, atol=1e-14)


def test_tangents_change_where_one_region_of_several_yields(rng):
    """[X] Elastic regions alone have no dofs where the tangent changes; beside soil all may."""
    basis = vector_basis(layered("Q1", rng), "Q1")
    elastic = sc.SolidForm(basis, {n: sc.LinearElastic(E=100.0, nu=0.3) for n in "abc"})
    assert elastic.changing is not None and len(elastic.changing) == 0
    assert elastic.with_materials({"b": SOIL}).changing is None


def test_element_forces_sum_up_to_the_internal_force(rng):
    """[X] Scattered element by element."""
    basis = vector_basis(layered("P2", rng), "P2")
    form = sc.SolidForm(basis, dict.fromkeys("bca", SOIL), "b_bar")
    out = form.assemble(0.01 * rng.standard_normal(basis.N), form.initial_state())
    forces = form.element_forces(out.state.stress, np.arange(form.basis.nelems))
    total = np.bincount(form.basis.element_dofs.ravel(), forces.ravel(), minlength=basis.N)
    np.testing.assert_allclose(total, out.force, atol=ROUND_OFF * np.abs(out.force).max())
    np.testing.assert_array_equal(
        form.element_forces(out.state.stress, np.array([7, 3])), forces[:, [7, 3]]
    )


def test_turned_body_answers_the_turned_force(rng):
    """[X] Isotropy: the same body at 37 degrees, displaced by the turned displacements."""
    mesh = layered("Q2", rng)
    Q = rotation(37)
    turned = type(mesh)(Q @ mesh.p, mesh.t, _subdomains=mesh.subdomains)
    x = 0.01 * rng.standard_normal(vector_basis(mesh, "Q2").N)
    forces = []
    for m, y in ((mesh, x), (turned, (x.reshape(-1, 2) @ Q.T).ravel())):
        form = sc.SolidForm(vector_basis(m, "Q2"), dict.fromkeys("abc", SOIL))
        forces.append(form.assemble(y, form.initial_state()).force)
    expected = (forces[0].reshape(-1, 2) @ Q.T).ravel()
    # the plastic return amplifies round-off near its kinks a little
    np.testing.assert_allclose(forces[1], expected, atol=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize("element", ELEMENTS)
def test_own_weight(element, rng):
    """[X] scikit-fem's load vector; total weight by area; elements without a name are
    weightless.
    """
    mesh = layered(element, rng)
    basis = vector_basis(mesh, element)
    load = sc.weight(basis, {"a": 20.0, "c": 5.0})
    parts = [
        LinearForm(lambda v, w, g=g: -g * v[1]).assemble(basis.with_elements(n))
        for n, g in (("a", 20), ("c", 5))
    ]
    np.testing.assert_allclose(load, sum(parts), atol=ROUND_OFF)
    area = {n: basis.with_elements(n).dx.sum() for n in "ac"}
    assert load[1::2].sum() == pytest.approx(-20 * area["a"] - 5 * area["c"], rel=1e-13)
    assert np.abs(load[::2]).max() == 0
    sideways = sc.weight(basis, 3.0, direction=(0.6, -0.8))
    np.testing.assert_allclose(sideways[::2] / 0.6, sideways[1::2] / -0.8, atol=1e-14)
    assert sideways[::2].sum() == pytest.approx(0.6 * 3 * basis.dx.sum(), rel=1e-13)
    only = sc.weight(basis.with_elements("b"), 7.0)
    assert only[1::2].sum() == pytest.approx(-7 * basis.with_elements("b").dx.sum(), rel=1e-13)


def test_built_in_a_displaced_place(rng):
    """[X] A body that is built at some displacements is stress-free there, and answers to what
    comes after.
    """
    basis = vector_basis(layered("Q2", rng), "Q2")
    form = sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.3))
    x, y = 0.1 * rng.standard_normal((2, basis.N))
    state = form.initial_state(x)
    assert (
        np.abs(form.assemble(x, state).force).max() < 1e-12
    )  # E times strains of order 1 with round-off
    later = form.assemble(x + y, state).force
    expected = form.elastic_stiffness @ y
    np.testing.assert_allclose(later, expected, atol=1e-12 * np.abs(expected).max())


def test_damped_tangent(rng):
    """[X] The tangent itself where flow is associated; else less skew, and with the same force."""
    basis = vector_basis(layered("Q1", rng), "Q1")
    x = 0.01 * rng.standard_normal(basis.N)
    skewness = {}
    for psi in (30.0, 0.0):
        form = sc.SolidForm(basis, sc.MohrCoulomb(E=100.0, nu=0.3, c=0.5, phi=30.0, psi=psi))
        out = form.assemble(x, form.initial_state())
        exact, damped = out.stiffness, out.damped
        skewness[psi] = [abs(K - K.T).max() / abs(K).max() for K in (exact, damped)]
        if psi == 30.0:
            assert abs(exact - damped).max() <= 1e-9 * abs(exact).max()
    assert skewness[30.0][0] < 1e-9
    assert 0 < skewness[0.0][1] < skewness[0.0][0]
    elastic = sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3))
    out = elastic.assemble(x, elastic.initial_state())
    assert abs(out.damped - out.stiffness).max() == 0


def test_parameters_follow_the_order_of_the_subdomain():
    """[X] A subdomain whose elements are in any order, and one twice: each element gets the value
    at its place.
    """
    mesh = grid("Q1", np.arange(6.0), [0, 1]).with_subdomains(
        {"a": np.array([4, 1, 4, 0]), "b": np.array([3, 2])}
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    x = basis.zeros()
    x[basis.nodal_dofs[0]] = mesh.p[0]  # strain 1
    form = sc.SolidForm(
        basis,
        {
            "a": sc.LinearElastic(E=np.array([40.0, 10.0, 1.0]), nu=0.0),
            "b": sc.LinearElastic(E=np.array([30.0, 20.0]), nu=0.0),
        },
    )
    stress = form.assemble(x, form.initial_state()).state.stress[0].mean(axis=1)
    left = np.floor(np.asarray(form.basis.global_coordinates())[0].mean(axis=1))
    np.testing.assert_allclose(stress, np.where(left == 0, 1.0, 10 * left))


@pytest.mark.parametrize(("angle", "warned"), [(2.0, False), (20.0, True)])
def test_rotations_that_are_not_small_are_remarked_on(angle, warned):
    """[X] A body that turns like a rigid one strains by 1 - cos(angle)."""
    basis = vector_basis(grid("Q1", [0, 1, 2], [0, 1]), "Q1", intorder=2)
    form = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3))
    places, turn = basis.doflocs[:, ::2], np.radians(angle)
    x = (
        (np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]) - np.eye(2))
        @ places
    ).T.ravel()
    remarks = form.outputs(x, form.assemble(x, form.initial_state()).state).remarks
    assert [remark.kind for remark in remarks] == (["rotation"] if warned else [])
    if warned:
        np.testing.assert_allclose(remarks[0].figure, np.sin(turn), rtol=1e-12)


# -- elements that lock


@pytest.mark.parametrize("element", ["P1", "P2", "Q1", "Q2", "QuadS2"])
def test_strain_follows_from_element_and_material(element):
    """Volume strains are averaged where a quadrilateral of four nodes would lock, and nowhere
    else.
    """
    basis = vector_basis(grid(element, [0, 1], [0, 1]), element, intorder=4)
    clay = sc.Tresca(E=1e3, nu=0.3, c=1.0)
    assert sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)).strain == "full"
    assert sc.SolidForm(basis, clay).strain is ("b_bar" if element == "Q1" else "full")
    assert sc.SolidForm(basis, clay, "full").strain == "full"


@pytest.mark.parametrize("element", ["P1", "Q1", "P2"])
def test_tangent_where_a_part_of_the_points_yields(element, rng):
    """[N] Elements of elastic points, of yielding ones and of both, against central differences."""
    basis = vector_basis(grid(element, np.linspace(0, 2, 5), np.linspace(0, 1, 4)), element)
    clay = sc.SolidForm(basis, sc.Tresca(E=1e3, nu=0.3, c=1.0), "full")
    state = clay.initial_state()
    # Shear that grows from left to right
    x = basis.zeros()
    x[0::2] = 3e-3 * basis.doflocs[0, 0::2] * basis.doflocs[1, 0::2]
    response = clay.assemble(x, state)
    yields = response.state.internal[0] > 0.0
    assert 0.2 < yields.mean() < 0.8
    way = 1e-7 * rng.standard_normal(basis.N)
    change = clay.assemble(x + way, state).force - clay.assemble(x - way, state).force
    # curved in the steps by 1e-4; no point passes its yield surface
    assert response.stiffness @ way == pytest.approx(0.5 * change, abs=1e-4 * np.abs(change).max())


@pytest.mark.parametrize(("strain", "warned"), [(None, False), ("full", True)])
@pytest.mark.parametrize("load", [1.0, 4.0])
def test_locking_is_warned_of(strain, warned, load):
    """... once points yield in elements that lock; by default none do."""
    basis = vector_basis(grid("Q1", np.linspace(0, 2, 9), np.linspace(0, 1, 5)), "Q1", intorder=2)
    forms = {"clay": sc.SolidForm(basis, sc.Tresca(E=1e3, nu=0.3, c=1.0), strain)}
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("left").all("u^1"))
    strip = sc.traction(basis, "top", lambda x: np.stack((0 * x[0], -load * (x[0] < 0.5))))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stage = sc.Model(forms, fixed).run([sc.Stage("strip", strip)], progress=False)["strip"]
    yields = bool((stage.states["clay"].internal[0] > 0).any())
    assert yields == (load > 2.0)
    assert any(
        "too stiff and too strong where soil flows" in str(one.message) for one in caught
    ) == (warned and yields)


# Radii of a ring, of which the inner one is widened, and both after it at a constant volume.
INNER, OUTER, WAY = 1.0, 4.0, 0.2
PRESENT = INNER + WAY, np.sqrt(OUTER**2 + (INNER + WAY) ** 2 - INNER**2)


def widened(element, order, law, kinematics):
    """Force per angle on the bore of a ring that is widened, and if it is told that it locks."""
    lines = np.geomspace(INNER, OUTER, 9), np.linspace(0.0, 0.5 * np.pi, 9)
    radius, angle = grid(element, *lines).p
    polar = radius * np.stack((np.cos(angle), np.sin(angle)))
    mesh = replace(grid(element, *lines), doflocs=polar)
    basis = vector_basis(mesh, element, intorder=order)
    form = sc.SolidForm(basis, law, kinematics=kinematics)
    bore = basis.get_dofs("left").all()
    sides = basis.get_dofs("bottom").all("u^2"), basis.get_dofs("top").all("u^1")
    model = sc.Model({"ring": form}, np.unique(np.concatenate((bore, *sides))))
    u = basis.zeros()
    outward = basis.doflocs[bore % 2, bore] / INNER
    u[bore] = WAY * outward
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stages = [sc.Stage("widened", prescribed=u, increments=10)]
        stage = model.run(stages, progress=False)["widened"]
    told = any("points, which lock" in str(one.message) for one in caught)
    return stage.reactions()[bore] @ outward / (0.5 * np.pi), told


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize(
    ("element", "order", "locks"), [("Q2", 4, True), ("QuadS2", 2, False), ("P2", 2, False)]
)
def test_a_ring_of_clay_that_locks_is_told(element, order, locks, kinematics):
    """[X] Clay without drainage yields under 2 c ln(b / a), of its present radii where strains are
    finite, but not in trapezoids of nine points, which say so.
    """
    c = 1.0
    clay = sc.Undrained(sc.MohrCoulomb(E=200.0, nu=0.3, c=c, phi=0.0, psi=0.0), 1e6)
    force, told = widened(element, order, clay, kinematics)
    a, b = PRESENT if kinematics == "finite" else (INNER, OUTER)
    exact = 2.0 * c * np.log(b / a) * a
    # sides of 11 degrees, eight layers
    assert force == pytest.approx(exact, rel=0.02) or locks
    assert (force > 1.5 * exact) == locks
    assert told == locks


@pytest.mark.parametrize(
    ("element", "order", "locks"), [("Q2", 4, True), ("QuadS2", 2, False), ("P2", 2, False)]
)
def test_a_ring_of_rubber_that_locks_is_told(element, order, locks):
    """[X] Rubber that keeps its volume needs p = int mu (l^2 - l^-2) dr / r, with l = r / R; nine
    points of a trapezoid add 2 %, and say that they lock.
    """
    mu = 1.0
    force, told = widened(element, order, sc.NeoHooke(E=3.0 * mu, nu=0.4999), "finite")
    a, b = PRESENT
    r = np.linspace(a, b, 2001)
    square = r**2 / (r**2 - a**2 + INNER**2)
    exact = trapezoid(mu * (square - 1.0 / square) / r, r) * a
    # sides of 11 degrees, eight layers
    assert force == pytest.approx(exact, rel=0.01) or locks
    assert (force > 1.015 * exact) == locks
    assert told == locks


@pytest.mark.parametrize(
    ("element", "nu_undrained", "told"),
    [("P1", 0.499, True), ("P1", None, False), ("P2", 0.499, False), ("Q1", 0.499, False)],
)
def test_locking_at_constant_volume(element, nu_undrained, told):
    """[N] A strip on undrained ground: triangles of three nodes settle half as much as the others,
    and are told of.
    """
    mesh = grid(element, np.linspace(0, 8, 17), np.linspace(-8, 0, 17))
    basis, soil = vector_basis(mesh, element, intorder=2), sc.LinearElastic(E=1e4, nu=0.3)
    clay = soil if nu_undrained is None else sc.Undrained(soil, nu_undrained=nu_undrained)
    model = sc.Model({"clay": sc.SolidForm(basis, clay)}, sc.box_supports(basis))
    load = model.traction("top", lambda x: np.stack((0 * x[0], -50.0 * (x[0] < 2.0))))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        stage = model.run([sc.Stage("strip", load)], progress=False)["strip"]
    assert any("elements of corner nodes alone lock" in str(one.message) for one in caught) == told
    if (
        nu_undrained is not None
    ):  # P2 9.718e-3, Q1 9.736e-3; on meshes twice as fine 9.719e-3 and 9.726e-3
        assert -stage.x[1::2].min() == pytest.approx(5.00e-3 if told else 9.72e-3, rel=0.01)


def test_message_on_too_few_points_names_the_order():
    """Nine-node quadrilaterals with four points have three motions without strain."""
    basis = Basis(MeshQuad().refined(1), ElementVector(ElementQuad2()), intorder=2)
    with pytest.raises(ValueError, match=r"4 integration points .* at least 4$"):
        sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
    basis = Basis(MeshQuad().refined(1), ElementVector(ElementQuad2()), intorder=4)
    sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
