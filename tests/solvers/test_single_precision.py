"""Factors in single precision: residuals of double precision, and double precision where matrices
are not firm.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import diags
from skfem import Basis, ElementHex1, ElementVector, MeshHex
from skfem.models.elasticity import lame_parameters, linear_elasticity

import skfem_contact as sc
from skfem_contact.solvers import direct
from skfem_contact.solvers.direct import DirectSolver, SingularSystem


@pytest.fixture(params=["superlu", "pardiso"])
def engine(request):
    if request.param == "pardiso":
        pytest.importorskip("pypardiso")
    return request.param


@pytest.fixture(autouse=True)
def small_ones_too(monkeypatch):
    """Systems of these tests are small."""
    monkeypatch.setattr(direct, "SINGLE", 1)


def block(length=1.0, n=4):
    """Stiffness of a block on a base, its coordinates and free dofs."""
    mesh = MeshHex.init_tensor(
        np.linspace(0.0, 1.0, n), np.linspace(0.0, 1.0, n), length * np.linspace(0.0, 1.0, n)
    )
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    K = linear_elasticity(*lame_parameters(1e4, 0.3)).assemble(basis)
    return K, basis.doflocs, basis.complement_dofs(basis.get_dofs(lambda x: x[2] == 0.0).all())


def kinds(monkeypatch, engine):
    """Types of the numbers of all matrices that an engine factors from now on."""
    found, factor = [], direct.ENGINES[engine].factor

    def counted(self, A, symmetric, careful=False):
        found.append(A.dtype.type)
        return factor(self, A, symmetric, careful)

    monkeypatch.setattr(direct.ENGINES[engine], "factor", counted)
    return found


@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("units", [1.0, 1e-40, 1e40])
def test_residual_of_double_precision(engine, symmetric, units, monkeypatch):
    """[N] Refined solutions equal dense ones, in units whose numbers single precision does not
    have, too.
    """
    K, locations, free = block()
    b = np.random.default_rng(0).standard_normal(K.shape[0])
    used = kinds(monkeypatch, engine)
    x = DirectSolver(locations, free, engine, single=True).factor(units * K, symmetric)(
        units**2 * b
    )
    assert used == [np.float32]
    dense = np.linalg.solve(K[free][:, free].toarray(), b[free])
    np.testing.assert_allclose(
        x[free], units * dense, rtol=0.0, atol=1e-12 * units * np.abs(dense).max()
    )


def test_soft_structures_have_double_precision_and_keep_it(engine, monkeypatch):
    """[N] A column 100 times as high as wide is not firm; neither it nor what follows is factored
    in single.
    """
    K, locations, free = block(100.0)
    b, used = np.random.default_rng(0).standard_normal(K.shape[0]), kinds(monkeypatch, engine)
    solver = DirectSolver(locations, free, engine, single=True)
    x = solver.factor(K)(b)
    assert used == [np.float32, np.float64]
    dense = np.linalg.solve(K[free][:, free].toarray(), b[free])
    np.testing.assert_allclose(x[free], dense, rtol=0.0, atol=1e-9 * np.abs(dense).max())
    solver.factor(2.0 * K)(b)
    assert used[2:] == [np.float64]


def test_solutions_that_stay_inaccurate_have_double_precision(engine, monkeypatch):
    """[N] A factor whose refinement leads nowhere is replaced before its solution is used."""
    K, locations, free = block()
    b, used = np.random.default_rng(0).standard_normal(K.shape[0]), kinds(monkeypatch, engine)
    monkeypatch.setattr(direct, "REFINEMENTS", 0)
    solver = DirectSolver(locations, free, engine, single=True)
    x = solver.factor(K)(b)
    assert used == [np.float32, np.float64]
    assert np.linalg.norm((b - K @ x)[free]) < 1e-12 * np.linalg.norm(b)
    solver.factor(2.0 * K)(b)
    assert used[2:] == [np.float64]


def test_single_precision_returns_after_a_matrix_that_is_not_firm(engine, monkeypatch):
    """[N] One tangent near a mechanism has double precision, and so has the next one; from then on
    firm ones have single precision again.
    """
    K, locations, free = block()
    b, used = np.random.default_rng(0).standard_normal(K.shape[0]), kinds(monkeypatch, engine)

    # take the stiffness of one dof away but for a share of 1e-7
    first = free[:1]
    others = np.setdiff1d(free, first)
    pulled = np.linalg.solve(K[others][:, others].toarray(), K[others][:, first].toarray())
    own = float((K[first][:, first] - K[first][:, others] @ pulled)[0, 0])
    lost = (1.0 - 1e-7) * own * np.isin(np.arange(K.shape[0]), first)
    soft = (K - diags(lost)).tocsr()

    solver = DirectSolver(locations, free, engine, single=True)
    for matrix in (K, soft, 2.0 * K, 3.0 * K):
        solver.factor(matrix)(b)
    single, double = np.float32, np.float64
    assert used == [single, single, double, double, single]


def test_stiffness_that_stays_has_double_precision(engine, monkeypatch):
    """[N] Factors of elastic bodies serve many solutions, whose refinements would take longer;
    those of soil do not.
    """
    mesh = MeshHex().refined(1).with_defaults()
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    elastic, yields = sc.LinearElastic(E=1e4, nu=0.3), sc.Tresca(E=1e4, nu=0.3, c=1e3)
    for material, kind in ((elastic, np.float64), (yields, np.float32)):
        model = sc.Model(
            {"block": sc.SolidForm(basis, material)}, basis.get_dofs("bottom").all(), solver=engine
        )
        used = kinds(monkeypatch, engine)
        model.run([sc.Stage("weight", model.weight(10.0))], progress=False)
        assert set(used) == {kind}


@pytest.mark.parametrize("weak", [0.0, 1e-20])
def test_loose_bodies_are_named(engine, weak):
    """[X] Round-off of single precision holds no body: nearly all dofs of a floating block move
    without force.
    """
    K, locations, _ = block()
    with pytest.raises(SingularSystem) as found:
        DirectSolver(locations, np.arange(K.shape[0]), engine, single=True).factor(
            K + diags(weak * K.diagonal())
        )
    assert (
        len(found.value.dofs) > 0.9 * K.shape[0]
    )  # some are near the axis of the rotation that is found


def test_the_plane_has_double_precision(engine, monkeypatch):
    """[N] In the plane refinements take as long as single precision saves."""
    K, locations, free = block()
    used = kinds(monkeypatch, engine)
    DirectSolver(locations[:2], free, engine, single=True).factor(K)
    assert used == [np.float64]
