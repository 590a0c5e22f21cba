"""Where the tangent is symmetric, PARDISO factors half of it; the analysis knows where."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import diags, kronsum

import skfem_contact as sc
from skfem_contact.contact.regularisation import Stabilised
from skfem_contact.nonlinear.system import System
from skfem_contact.solvers.direct import ENGINES, as_engine
from tests.tools.helpers import grid, rough_pair, run_stages, vector_basis

ASSOCIATED = {
    "elastic": sc.LinearElastic(E=1e3, nu=0.3),
    "Mohr-Coulomb": sc.MohrCoulomb(E=1e3, nu=0.3, c=1.0, phi=30.0, psi=30.0),
    "with cut-off": sc.MohrCoulomb(E=1e3, nu=0.3, c=1.0, phi=30.0, psi=30.0, tension=0.3),
    "Tresca": sc.Tresca(E=1e3, nu=0.3, c=1.0),
    "von Mises": sc.VonMises(E=1e3, nu=0.3, strength=1.0),
    "Drucker-Prager": sc.DruckerPrager.plane_strain(E=1e3, nu=0.3, c=1.0, phi=30.0, psi=30.0),
}
OTHERS = {
    "Mohr-Coulomb": sc.MohrCoulomb(E=1e3, nu=0.3, c=1.0, phi=30.0, psi=10.0),
    "Drucker-Prager": sc.DruckerPrager.plane_strain(E=1e3, nu=0.3, c=1.0, phi=30.0, psi=10.0),
}


def skewness(material, rng: np.random.Generator) -> float:
    """Largest difference of a tangent and its transpose at random points, relative to Young's
    modulus.
    """
    shape = (4, 2000, 1)
    internal = np.zeros((material.n_internal, *shape[1:]))
    tangent = material.update(
        3e-3 * rng.standard_normal(shape), np.zeros(shape), internal
    ).tangent()
    return float(np.abs(tangent - tangent.transpose(0, 2, 1)).max(initial=0.0)) / material.E


@pytest.mark.parametrize("name", ASSOCIATED)
def test_associated_flow_has_a_symmetric_tangent(name: str, rng: np.random.Generator) -> None:
    """[X] On faces, edges, the apex and the cut-off (round-off of the principal directions:
    1e-9).
    """
    assert ASSOCIATED[name].symmetric
    assert skewness(ASSOCIATED[name], rng) < 1e-9


@pytest.mark.parametrize("name", OTHERS)
def test_other_flow_has_not(name: str, rng: np.random.Generator) -> None:
    """[X] What is not symmetric does not say so."""
    assert not OTHERS[name].symmetric
    assert skewness(OTHERS[name], rng) > 1e-3


def slope(material):
    """A layer that yields under a strip load."""
    basis = vector_basis(
        grid("Q1", np.linspace(-3, 3, 19), np.linspace(-2, 0, 7)), "Q1", intorder=2
    )
    forms = {"layer": sc.SolidForm(basis, material, strain="b_bar")}
    load = basis.zeros()
    top = basis.get_dofs("top").all("u^2")
    load[top[np.abs(basis.doflocs[0, top]) < 1.0]] = -1.5
    fixed = np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    return forms, [sc.Stage("load", load, increments=2)], fixed


def test_forms_that_say_nothing_are_not_symmetric() -> None:
    """Contact with friction has no symmetric tangent, whatever the bodies."""
    forms, _, fixed = slope(ASSOCIATED["Mohr-Coulomb"])
    model = sc.Model(forms, fixed)
    system = model.checked_system(model.forms, model.fixed)
    assert system.symmetric
    assert not system.with_forms({**forms, "more": sc.Form()}).symmetric
    assert not system.with_forms(slope(OTHERS["Mohr-Coulomb"])[0]).symmetric


def contact_skewness(law, quadrature, rng: np.random.Generator, springs: float = 0.0, **options):
    """A contact pair of bent surfaces in random states, and its largest difference of tangent and
    transpose, relative.

    Parameters
    ----------
    springs
        Share of the penalty with which open points are held.
    """
    worst = 0.0
    for element in ("Q1", "P2"):
        for _ in range(2):
            _, pair, x, state = rough_pair(element, quadrature, law, rng, **options)
            pair = pair.with_law(Stabilised(pair.law, springs)) if springs else pair
            K = pair.assemble(x, state).stiffness
            worst = max(worst, abs(K - K.T).max() / abs(K).max())
    return pair, worst


@pytest.mark.parametrize("quadrature", ["nodal", 4, "segments"])
@pytest.mark.parametrize("tangent", ["exact", "primary"])
@pytest.mark.one_in(2)
def test_contact_without_friction_has_a_symmetric_tangent(
    quadrature, tangent, rng: np.random.Generator
) -> None:
    """[X] Second derivatives of an energy, to round-off: at facets and vertices, held by springs,
    augmented.
    """
    for law in (sc.Coulomb(), sc.Coulomb(tension=5.0)):
        for options in ({}, {"enforcement": sc.AugmentedLagrangian()}, {"springs": 1e-4}):
            pair, skew = contact_skewness(law, quadrature, rng, tangent=tangent, **options)
            assert pair.symmetric
            assert skew < 1e-14
    assert not pair.with_law(sc.Coulomb(0.3)).symmetric


@pytest.mark.parametrize("quadrature", ["nodal", 4, "segments"])
@pytest.mark.parametrize(
    "law", [sc.Coulomb(0.3), sc.Coulomb(1e6), sc.Coulomb(adhesion=1e6), sc.Tied()], ids=repr
)
def test_contact_with_shear_has_not(law, quadrature, rng: np.random.Generator) -> None:
    """[X] Nor have points that stick: the slip is measured in the master's material, the shear acts
    in space.
    """
    pair, skew = contact_skewness(law, quadrature, rng)
    assert not pair.symmetric
    assert skew > 1e-3


def pressed_layer():
    """A layer that yields under a block in frictionless contact."""
    meshes = {
        "layer": grid("Q1", np.linspace(-3, 3, 19), np.linspace(-2, 0, 7)),
        "block": grid("Q1", np.linspace(-1, 1, 9), np.linspace(0, 1, 4)),
    }
    basis = vector_basis(sc.join_bodies(meshes), "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(
            basis, {"layer": ASSOCIATED["Mohr-Coulomb"], "block": ASSOCIATED["elastic"]}
        ),
        "contact": sc.ContactPair(basis, "block:bottom", "layer:top", sc.Coulomb(), "segments"),
    }
    down, top = basis.zeros(), basis.get_dofs("block:top").all()
    down[basis.get_dofs("block:top").all("u^2")] = -0.02
    sides = basis.get_dofs({"layer:left", "layer:right"}).all("u^1")
    fixed = np.concatenate((basis.get_dofs("layer:bottom").all(), sides, top))
    return forms, [sc.Stage("press", basis.zeros(), down, 2)], fixed


SCENES = {
    "elastic": lambda: slope(ASSOCIATED["elastic"]),
    "Mohr-Coulomb": lambda: slope(ASSOCIATED["Mohr-Coulomb"]),
    "with cut-off": lambda: slope(ASSOCIATED["with cut-off"]),
    "in contact": pressed_layer,
}


@pytest.mark.parametrize("name", SCENES)
def test_half_of_the_tangent_gives_the_same(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the whole matrix PARDISO finds the same displacements (residuals of 1e-12 times the
    conditioning).
    """
    pytest.importorskip("pypardiso")
    from skfem_contact.solvers import pardiso

    kinds, analysis = [], pardiso._Analysis.__init__

    def spy(self, library, pattern, A, kind, options):
        kinds.append(kind != pardiso.UNSYMMETRIC)
        analysis(self, library, pattern, A, kind, options)

    monkeypatch.setattr(pardiso._Analysis, "__init__", spy)
    scene, newton = SCENES[name](), sc.Newton(tolerance=1e-12)
    half = run_stages(*scene, newton=newton, solver="pardiso")[-1]
    assert kinds and all(kinds)  # as contact closes, new patterns may be analysed
    kinds.clear()
    monkeypatch.setattr(System, "symmetric", False)
    whole = run_stages(*scene, newton=newton, solver="pardiso")[-1]
    assert kinds and not any(kinds)
    assert half.iterations == whole.iterations
    np.testing.assert_allclose(half.x, whole.x, rtol=0, atol=1e-9 * np.abs(whole.x).max())


@pytest.mark.parametrize("name", ENGINES)
def test_definite_matrices_and_several_columns(name: str, rng: np.random.Generator) -> None:
    """[N] Solutions for one column, and for three at once, are those of numpy."""
    if name == "pardiso":
        pytest.importorskip("pypardiso")
    engine = as_engine(name)
    A = kronsum(*2 * [diags([-1.0, 2.2, -1.0], [-1, 0, 1], shape=(12, 12))]).tocsr()
    b = rng.standard_normal((144, 3))
    solve = engine.factor(A, symmetric=True, definite=True)
    exact = np.linalg.solve(A.toarray(), b)
    np.testing.assert_allclose(solve(b), exact, rtol=1e-12, atol=1e-13)  # condition below 1e2
    np.testing.assert_allclose(solve(b[:, 1]), exact[:, 1], rtol=1e-12, atol=1e-13)


def test_negative_pivots_are_told() -> None:
    """[X] A matrix that is not positive definite has no factor of Cholesky."""
    pytest.importorskip("pypardiso")
    A = diags([[-1.0] * 3, [2.0, 1.0, -2.0, 1.0], [-1.0] * 3], [-1, 0, 1]).tocsr()
    with pytest.raises(RuntimeError, match="PARDISO"):
        as_engine("pardiso").factor(A, symmetric=True, definite=True)
