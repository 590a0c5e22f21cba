"""Kernels against scikit-fem's forms: stiffness, force, B-bar, the sparsity pattern and lazy
tangents.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    BilinearForm,
    ElementHex1,
    ElementHex2,
    ElementQuad1,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    LinearForm,
    MeshHex,
    MeshQuad,
    MeshQuad2,
    MeshTri2,
    condense,
    solve,
)
from skfem.models.elasticity import lame_parameters, linear_elasticity

import skfem_contact as sc
from skfem_contact.forms.assembly import Pattern, element_stiffness, force_matrix, strain_operator
from tests.tools.helpers import ELEMENTS, directional_error, distorted, grid, vector_basis

# Both sides sum the same products in another order: some hundred roundings of 1e-16.
ROUND_OFF = 1e-13

SOFT, HARD = sc.LinearElastic(E=3.0, nu=0.3), sc.LinearElastic(E=700.0, nu=0.15)


def _strains(u):
    """Strains xx, yy, zz, xy of a field of scikit-fem."""
    g = np.asarray(u.grad)
    return np.stack((g[0, 0], g[1, 1], np.zeros_like(g[0, 0]), g[0, 1] + g[1, 0]))


@BilinearForm
def reference_stiffness(u, v, w):
    """Virtual work of the moduli ``w.D`` (4, 4, elements, points)."""
    D = np.asarray(w.D)
    return np.einsum("iep,ijep,jep->ep", _strains(v), D, _strains(u))


@LinearForm
def reference_force(v, w):
    """Virtual work of the stresses ``w.stress`` (4, elements, points)."""
    return np.einsum("iep,iep->ep", _strains(v), np.asarray(w.stress))


def moduli(form: sc.SolidForm) -> np.ndarray:
    """Elastic moduli at all points of a form, element by element from the mesh's subdomains."""
    D = np.empty((4, 4, form.basis.nelems, form.basis.dx.shape[1]))
    tind = np.arange(form.basis.nelems) if form.basis.tind is None else form.basis.tind
    for k, element in enumerate(tind):
        names = [
            n for n in form.materials if n == "all" or element in form.basis.mesh.subdomains[n]
        ]
        D[:, :, k] = form.materials[names[0]].elasticity(4)[:, :, None]
    return D


def assert_equal_matrices(K, reference) -> None:
    difference = abs(K - reference).max()
    assert difference <= ROUND_OFF * abs(reference).max()


def two_materials(element: str, rng: np.random.Generator):
    """A distorted mesh whose elements belong to two regions in random order."""
    mesh = distorted(grid(element, np.linspace(0, 2, 8), np.linspace(0, 1, 6)), rng, 0.03)
    first = np.sort(rng.permutation(mesh.nelements)[: mesh.nelements // 3])
    return mesh.with_subdomains(
        {"hard": first, "soft": np.setdiff1d(np.arange(mesh.nelements), first)}
    )


@pytest.mark.parametrize("intorder", [None, 4, 5])
@pytest.mark.parametrize("element", ELEMENTS)
def test_stiffness_and_force_are_those_of_scikit_fem(element, intorder, rng):
    """[X] Distorted meshes, two materials in random elements, several quadrature rules."""
    basis = vector_basis(two_materials(element, rng), element, intorder=intorder)
    form = sc.SolidForm(basis, {"soft": SOFT, "hard": HARD})
    x = rng.standard_normal(basis.N)
    out = form.assemble(x, form.initial_state())
    assert_equal_matrices(out.stiffness, reference_stiffness.assemble(form.basis, D=moduli(form)))
    reference = reference_force.assemble(form.basis, stress=out.state.stress)
    assert np.abs(out.force - reference).max() <= ROUND_OFF * np.abs(reference).max()
    assert np.abs(out.force - out.stiffness @ x).max() <= ROUND_OFF * np.abs(reference).max()


@pytest.mark.parametrize("element", ELEMENTS)
def test_restricted_basis(element, rng):
    """[X] A form on some elements has their stiffness only, in the numbering of the whole mesh."""
    whole = vector_basis(two_materials(element, rng), element)
    some = rng.permutation(whole.mesh.nelements)[:11]
    parts = [
        sc.SolidForm(whole.with_elements("soft"), SOFT),
        sc.SolidForm(whole.with_elements(some), HARD),
    ]
    for part, D in zip(parts, (SOFT.elasticity(4), HARD.elasticity(4)), strict=True):
        D = np.broadcast_to(D[:, :, None, None], (4, 4, *part.basis.dx.shape))
        assert_equal_matrices(part.elastic_stiffness, reference_stiffness.assemble(part.basis, D=D))
        assert part.elastic_stiffness.shape == (whole.N, whole.N)


def test_more_elements_than_one_batch(rng):
    """[X] The batches of the kernel join without a seam."""
    mesh = distorted(grid("P1", np.linspace(0, 1, 20), np.linspace(0, 1, 30)), rng, 0.01)
    form = sc.SolidForm(vector_basis(mesh, "P1"), HARD)
    assert form.basis.nelems > 1024
    assert_equal_matrices(
        form.elastic_stiffness, reference_stiffness.assemble(form.basis, D=moduli(form))
    )


@pytest.mark.parametrize(
    "mesh_type, element", [(MeshTri2, ElementTriP2), (MeshQuad2, ElementQuad2)]
)
def test_curved_elements(mesh_type, element, rng):
    """[X] Second-order geometry: all nodes moved, those in the middle of sides as well."""
    straight = grid(
        "P1" if mesh_type is MeshTri2 else "Q1", np.linspace(0, 2, 5), np.linspace(0, 1, 4)
    )
    mesh = mesh_type.from_mesh(straight)
    mesh = replace(mesh, doflocs=mesh.doflocs + 0.02 * rng.uniform(-1, 1, mesh.doflocs.shape))
    basis = Basis(mesh, ElementVector(element()), intorder=6)
    form = sc.SolidForm(basis, HARD)
    assert_equal_matrices(
        form.elastic_stiffness, reference_stiffness.assemble(basis, D=moduli(form))
    )
    # the volume strain of u = x is 2 everywhere: its integral is twice the area
    x = basis.doflocs[np.arange(basis.N) % 2, np.arange(basis.N)]
    strain = form.assemble(x, form.initial_state()).state.strain
    # isoparametric elements reproduce linear fields exactly
    np.testing.assert_allclose(strain[0] + strain[1], 2.0, atol=1e-12)


def reference_b_bar(mesh, E: float, nu: float) -> np.ndarray:
    """Dense stiffness of four-node quadrilaterals with Hughes' B-bar, written down element by
    element.
    """
    lam, mu = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    D = lam * np.outer([1, 1, 1, 0], [1, 1, 1, 0]) + mu * np.diag([2, 2, 2, 1])
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    K = np.zeros((2 * mesh.p.shape[1],) * 2)
    for nodes in mesh.t.T:
        B, dV = [], []
        for xi, eta in corner / np.sqrt(3):
            N = np.array([[a * (1 + b * eta), b * (1 + a * xi)] for a, b in corner]) / 4
            J = mesh.p[:, nodes] @ N
            g = N @ np.linalg.inv(J)
            row = np.zeros((4, 8))
            row[0, ::2] = row[3, 1::2] = g[:, 0]
            row[1, 1::2] = row[3, ::2] = g[:, 1]
            B.append(row)
            dV.append(abs(np.linalg.det(J)))
        mean = sum(b[:3].sum(axis=0) * v for b, v in zip(B, dV, strict=True)) / sum(dV)
        dofs = np.stack((2 * nodes, 2 * nodes + 1), axis=1).ravel()
        for b, v in zip(B, dV, strict=True):
            dilation = np.outer([1, 1, 1, 0], (mean - b[:3].sum(axis=0)) / 3)
            K[np.ix_(dofs, dofs)] += (b + dilation).T @ D @ (b + dilation) * v
    return K


def test_b_bar_is_hughes_b_bar(rng):
    """[X] The same formula with our own shape functions and loops, on distorted quadrilaterals."""
    mesh = distorted(MeshQuad.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 1, 4)), rng, 0.05)
    basis = vector_basis(mesh, "Q1", intorder=2)
    form = sc.SolidForm(basis, sc.LinearElastic(E=5.0, nu=0.49), strain="b_bar")
    reference = reference_b_bar(mesh, 5.0, 0.49)
    error = np.abs(form.elastic_stiffness.toarray() - reference).max()
    assert error <= ROUND_OFF * np.abs(reference).max()
    # its force is consistent: the tangent of the linear body
    x = rng.standard_normal(basis.N)
    np.testing.assert_allclose(
        form.assemble(x, form.initial_state()).force,
        reference @ x,
        atol=ROUND_OFF * np.abs(reference @ x).max() * 10,
    )


def test_b_bar_of_constant_strain_triangles_changes_nothing():
    """[X] With one strain an element there is nothing to average."""
    basis = vector_basis(grid("P1", np.linspace(0, 1, 4), np.linspace(0, 1, 3)), "P1")
    plain, averaged = sc.SolidForm(basis, HARD), sc.SolidForm(basis, HARD, strain="b_bar")
    # B-bar fills the zz row with (mean - local)/3, which is round-off here
    assert_equal_matrices(averaged.elastic_stiffness, plain.elastic_stiffness)


def cook(element: str, n: int, nu: float, strain="full") -> float:
    """Deflection of the upper corner of Cook's membrane, plane strain, E = 250, shear load 100."""
    order = 2 if element == "Q1" else None
    mesh = grid(element, np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    mesh = mesh.morphed(lambda x: 48 * x[0], lambda x: 44 * x[0] + x[1] * (44 - 28 * x[0]))
    basis = vector_basis(mesh, element, intorder=order)
    K = sc.SolidForm(basis, sc.LinearElastic(E=250.0, nu=nu), strain).elastic_stiffness
    load = LinearForm(lambda v, w: 100 / 16 * v[1]).assemble(basis.boundary("right"))
    u = solve(*condense(K, load, D=basis.get_dofs("left").all()))
    corner = np.flatnonzero(np.abs(basis.doflocs - [[48.0], [60.0]]).max(axis=0) < 1e-9)
    return float(u[corner[1]])


def test_b_bar_does_not_lock():
    """[N] Cook's membrane at nu = 0.4999; 7.77 extrapolates quadratic elements, 24, 48 and 96 a
    side.
    """
    # 16 linear elements a side miss 3 % at the clamped corner's singularity, at nu = 1/3 as well
    assert cook("Q1", 16, 0.4999, "b_bar") == pytest.approx(7.77, rel=0.03)
    assert cook("Q2", 16, 0.4999) == pytest.approx(7.77, rel=0.03)
    assert cook("Q1", 16, 0.4999) < 0.4 * 7.77  # what the averaging mends


def smooth_punch(strain, n: int = 10) -> float:
    """Mean pressure under a smooth strip of half-width 1 that sinks into undrained clay, c = 1."""
    mesh = grid("Q1", np.linspace(0, 5, 5 * n // 2 + 1), np.linspace(-2.5, 0, n + 1))
    basis = vector_basis(mesh, "Q1", intorder=2)
    form = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=0.49, c=1.0, phi=0.0), strain)
    strip = basis.get_dofs(lambda x: (x[1] > -1e-9) & (x[0] < 1 + 1e-9)).all("u^2")
    fixed = np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"), strip)
    )
    sunk = basis.zeros()
    sunk[strip] = -0.08
    stage = sc.Model({"clay": form}, fixed).run(
        [sc.Stage("sink", basis.zeros(), sunk, increments=8)], progress=False
    )["sink"]
    return float(-form.assemble(stage.x, stage.states["clay"]).force[strip].sum())


def test_plastic_flow_at_constant_volume_does_not_lock():
    """[X] Prandtl's strip footing, 2 + pi: a coarse mesh is near it with B-bar, and locks
    without.
    """
    averaged, plain = smooth_punch("b_bar"), smooth_punch("full")
    # a quarter element (0.0625) of the width is the nodes' share beyond the edge, and the mesh is
    # coarse: 9 %
    assert 2 + np.pi < averaged < 1.12 * (2 + np.pi)
    assert plain > 2 * averaged


@pytest.mark.parametrize("element", ELEMENTS)
def test_plastic_tangent_is_full_assembly(element, rng):
    """[X] The elastic stiffness corrected in yielding elements is the sum over all points."""
    basis = vector_basis(two_materials(element, rng), element)
    soil = sc.MohrCoulomb(E=100.0, nu=0.3, c=1.0, phi=30.0, psi=5.0)
    form = sc.SolidForm(basis, {"hard": HARD, "soft": soil}, "full")
    x = 0.01 * rng.standard_normal(basis.N) * (basis.doflocs[0] < 1)  # the right half stays elastic
    state = form.initial_state()
    out = form.assemble(x, state)
    D = moduli(form)
    region = next(r for r in form.regions if r.name == "soft")
    update = soil.update(
        out.state.strain[:, region.elements],
        state.stress[:, region.elements],
        state.internal[:, region.elements],
    )
    here = np.zeros(D.shape[2:], bool)
    here[region.elements] = np.isin(np.arange(here[region.elements].size), update.plastic).reshape(
        -1, D.shape[3]
    )
    assert 0.1 < here[region.elements].mean() < 0.9
    D[:, :, here] = np.moveaxis(update.tangent(), 0, -1)
    assert_equal_matrices(out.stiffness, reference_stiffness.assemble(form.basis, D=D))


def test_plastic_tangent_is_the_derivative_of_the_force(rng):
    """[X] Central differences."""
    basis = vector_basis(two_materials("Q1", rng), "Q1")
    form = sc.SolidForm(
        basis, {"hard": HARD, "soft": sc.MohrCoulomb(E=100.0, nu=0.3, c=1.0, phi=30.0)}, "b_bar"
    )
    x, state = 0.01 * rng.standard_normal(basis.N), form.initial_state()
    out = form.assemble(x, state)
    error = directional_error(
        lambda y: form.assemble(y, state).force,
        out.stiffness,
        x,
        rng.standard_normal((5, basis.N)),
        1e-8,
    )
    # differences with h = 1e-8 carry 1e-8 of round-off; a point that passes a kink would show as
    # 1e-3
    assert error < 1e-6


def dense_pattern(basis) -> np.ndarray:
    """Which unknowns meet in an element."""
    meets = np.zeros((basis.N, basis.N), bool)
    for dofs in basis.element_dofs.T:
        meets[np.ix_(dofs, dofs)] = True
    return meets


@pytest.mark.parametrize("element", ELEMENTS)
def test_pattern_is_that_of_the_elements_whatever_the_values(element):
    """[X] Zeros are kept: the pattern is the same for nu = 0 and for a plastic tangent."""
    basis = vector_basis(grid(element, [0, 1, 2, 3], [0, 1, 2]), element)
    pattern = Pattern.of(basis)
    rows = np.repeat(np.arange(basis.N), np.diff(pattern.indptr))
    expected = dense_pattern(basis)
    assert np.array_equal(np.stack((rows, pattern.indices)), np.stack(np.nonzero(expected)))
    soil = sc.MohrCoulomb(E=1.0, nu=0.0, c=1e-3, phi=20.0)
    form = sc.SolidForm(basis, soil)
    elastic = form.assemble(basis.zeros(), form.initial_state()).stiffness
    plastic = form.assemble(np.sin(np.arange(basis.N)), form.initial_state()).stiffness
    assert abs(elastic - plastic).max() > 0.01
    for K in (elastic, plastic):
        assert np.array_equal(K.indptr, pattern.indptr) and np.array_equal(
            K.indices, pattern.indices
        )
        assert K.has_canonical_format


def test_matrices_that_share_a_pattern_are_independent(rng):
    """[X] Arithmetic with one tangent leaves the others alone."""
    basis = vector_basis(two_materials("Q1", rng), "Q1")
    form = sc.SolidForm(basis, SOFT)
    K = form.assemble(basis.zeros(), form.initial_state()).stiffness
    before = K.toarray()
    total = K + K
    total.data *= 3.0
    condense(K, basis.zeros(), D=np.arange(4))
    assert np.array_equal(
        form.assemble(basis.zeros(), form.initial_state()).stiffness.toarray(), before
    )


def test_forces_and_element_matrices(rng):
    """[X] Plain sums over random operators."""
    B, D = rng.standard_normal((3, 2, 4, 6)), rng.standard_normal((3, 2, 4, 4))
    dofs = rng.permutation(18).reshape(6, 3)
    stress, weight, force = rng.standard_normal((4, 3, 2)), rng.random((3, 2)), np.zeros(18)
    # sums of eight and 48 products of order one
    force[dofs] = np.einsum("eqcb,ceq,eq->be", B, stress, weight)
    np.testing.assert_allclose(
        force_matrix(B, weight, dofs, 18) @ stress.ravel(), force, atol=1e-14
    )
    np.testing.assert_allclose(
        element_stiffness(B, D), np.einsum("eqci,eqcd,eqdj->eij", B, D, B), atol=1e-13
    )


def test_response_computes_state_and_stiffness_once_and_only_when_asked():
    """[X] Counted calls."""
    calls = []
    response = sc.Response(
        np.zeros(2), lambda: calls.append("state") or 5, lambda: calls.append("K") or 7
    )
    assert calls == []
    assert response.stiffness == 7 and response.stiffness == 7 and calls == ["K"]
    assert response.state == 5 and response.state == 5 and calls == ["K", "state"]


@pytest.mark.parametrize("element", [ElementQuad1, ElementQuad2])
def test_b_bar_strain_operator_averages_volume(element, rng):
    """[X] One volume strain an element, the weighted mean of the plain one; the deviator is
    untouched.
    """
    mesh = distorted(MeshQuad.init_tensor(np.linspace(0, 1, 4), np.linspace(0, 1, 4)), rng, 0.05)
    basis = Basis(mesh, ElementVector(element()), intorder=4)
    plain, averaged = (strain_operator(basis, strain, "plane") for strain in ("full", "b_bar"))
    volume, mean = plain.B[:, :, :3].sum(axis=2), averaged.B[:, :, :3].sum(axis=2)
    weighted = np.einsum("eq,eqb->eb", basis.dx, volume) / basis.dx.sum(axis=1)[:, None]
    np.testing.assert_allclose(mean, np.broadcast_to(weighted[:, None], mean.shape), atol=1e-12)
    # B is of the order of 10
    deviator = plain.B[:, :, :2] - plain.B[:, :, [1, 2]]
    np.testing.assert_allclose(
        averaged.B[:, :, :2] - averaged.B[:, :, [1, 2]], deviator, atol=1e-12
    )
    assert np.array_equal(averaged.B[:, :, 3], plain.B[:, :, 3])
    np.testing.assert_array_equal(plain.weight, basis.dx)


@pytest.mark.parametrize("element", [ElementHex1(), ElementHex2()])
def test_stiffness_in_space_is_that_of_scikit_fem(element) -> None:
    """[X] A box that is stretched and sheared, with all six strains."""
    mesh = MeshHex.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 2, 3), np.linspace(0, 1, 2))
    shear = np.array([[1.0, 0.2, 0.1], [0.0, 1.3, 0.3], [0.2, 0.0, 0.8]])
    basis = Basis(MeshHex(shear @ mesh.p, mesh.t), ElementVector(element), intorder=4)
    E, nu = 1e4, 0.3
    form = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=nu))
    expected = linear_elasticity(*lame_parameters(E, nu)).assemble(basis)
    assert_equal_matrices(form.elastic_stiffness, expected)


def test_bodies_that_do_not_flow_keep_the_full_strain_in_large_deformations() -> None:
    """Quad1 and Hex1 have F-bar where they flow, other elements the full strain."""
    basis = vector_basis(grid("Q1", [0, 1, 2], [0, 1]), "Q1", intorder=2)
    elastic = sc.SolidForm(basis, HARD, kinematics="finite")
    flows = sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.3, c=10.0), kinematics="finite")
    assert (elastic.strain, flows.strain) == ("full", "f_bar")
