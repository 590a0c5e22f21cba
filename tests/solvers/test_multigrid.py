"""Algebraic multigrid: agreement with the direct solver, few iterations, its failures, when it is
chosen.
"""

from __future__ import annotations

import logging
import sys
from importlib.util import find_spec

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import eigsh
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementTetP2,
    ElementVector,
    MeshHex,
    MeshQuad,
    MeshTet,
)

import skfem_contact as sc
from skfem_contact.errors import NotConverged
from skfem_contact.layout import rigid_modes
from skfem_contact.solvers import choice, multigrid
from skfem_contact.solvers import levels as levels_of
from skfem_contact.solvers.choice import as_solver
from skfem_contact.solvers.direct import DirectSolver, SingularSystem
from skfem_contact.solvers.multigrid import AmgSolver
from skfem_contact.solvers.schur import SchurSolver
from tests.tools.helpers import run_stages

needs_pyamg = pytest.mark.skipif(find_spec("pyamg") is None, reason="pyamg is not installed")
ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)
# The residual is 1e-10 of the load; the condition of these small systems makes more of it.
SAME = 1e-8
COARSEST = levels_of.COARSEST


def cantilever(n: int = 4, element=ElementHex1, kind=MeshHex, material=ELASTIC, length: int = 2):
    """A beam some times longer than wide, clamped at x = 0 and on rollers at y = 0."""
    mesh = kind.init_tensor(*(np.linspace(0, side, side * n + 1) for side in (length, 1, 1)))
    basis = Basis(mesh, ElementVector(element()), intorder=2)
    fixed = np.union1d(
        basis.get_dofs(lambda x: x[0] == 0).all(), basis.get_dofs(lambda x: x[1] == 0).all("u^2")
    )
    return basis, {"beam": sc.SolidForm(basis, material, "full")}, fixed


def free_of(basis: Basis, fixed: np.ndarray) -> np.ndarray:
    return np.setdiff1d(np.arange(basis.N), fixed)


def blocks(n: int = 12, mu: float = 0.3):
    """Two plane blocks that are pressed together and slide."""
    side = np.linspace(0, 1, n + 1)
    lower = MeshQuad.init_tensor(side, side).with_defaults()
    mesh = sc.join_bodies({"lower": lower, "upper": lower.translated((0.0, 1.0))})
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {
        "blocks": sc.SolidForm(basis, ELASTIC),
        "joint": sc.ContactPair(
            basis, "upper:bottom", "lower:top", sc.Coulomb(mu=mu), quadrature=2
        ),
    }
    x = basis.zeros()
    top = basis.get_dofs("upper:top")
    x[top.all("u^2")], x[top.all("u^1")] = -1e-2, 4e-3
    return (
        forms,
        [sc.Stage("pressed", basis.zeros(), prescribed=x, increments=2)],
        basis.get_dofs({"lower:bottom", "upper:top"}).all(),
    )


@pytest.fixture(autouse=True)
def levels_of_small_bodies(monkeypatch):
    """The bodies of these tests are so small that they would be factored as a whole."""
    monkeypatch.setattr(levels_of, "COARSEST", 10)


@pytest.fixture
def iterations(monkeypatch):
    """Numbers of iterations of all solutions."""
    counts = []
    iterated = multigrid._iterated

    def counted(*args):
        found = iterated(*args)
        counts.append(found.count)
        return found

    monkeypatch.setattr(multigrid, "_iterated", counted)
    return counts


@pytest.fixture
def levels(monkeypatch):
    """Numbers of unknowns on the finest level whenever levels are made."""
    made, built = [], AmgSolver._built
    monkeypatch.setattr(
        AmgSolver, "_built", lambda self, *A: made.append(A[0].shape[0]) or built(self, *A)
    )
    return made


# -- agreement


@needs_pyamg
@pytest.mark.parametrize("element, kind", [(ElementHex1, MeshHex), (ElementTetP2, MeshTet)])
def test_same_as_direct(element, kind, iterations, rng):
    """[N] Random loads; unknowns that are held one by one stay zero, and 25 iterations are
    enough.
    """
    basis, forms, fixed = cantilever(3, element, kind)
    K, free, b = (
        forms["beam"].elastic_stiffness,
        free_of(basis, fixed),
        rng.standard_normal(basis.N),
    )
    x = as_solver("amg", basis.doflocs, free).factor(K, symmetric=True)(b)
    expected = DirectSolver(basis.doflocs, free, "superlu").factor(K)(b)
    np.testing.assert_allclose(x, expected, atol=SAME * np.abs(expected).max())
    assert not x[fixed].any()
    assert 1 < iterations[0] <= 25


@needs_pyamg
def test_body_that_moves_in_one_direction(rng):
    """[N] One of two bodies may only settle: some rigid motions of its aggregates are held, and
    have no stiffness.
    """
    box = MeshHex.init_tensor(
        *(np.linspace(0, side, 4 * side + 1) for side in (2, 1, 1))
    ).with_defaults()
    basis = Basis(
        sc.join_bodies({"one": box, "up": box.translated((0.0, 0.0, 2.0))}),
        ElementVector(ElementHex1()),
    )
    K = sc.SolidForm(basis, ELASTIC, "full").elastic_stiffness
    fixed = np.concatenate(
        [
            basis.get_dofs({"one:left", "up:left"}).all(),
            basis.get_dofs(elements="up").all(["u^1", "u^2"]),
        ]
    )
    free, b = free_of(basis, fixed), rng.standard_normal(basis.N)
    x = as_solver("amg", basis.doflocs, free).factor(K, symmetric=True)(b)
    expected = DirectSolver(basis.doflocs, free, "superlu").factor(K)(b)
    np.testing.assert_allclose(x, expected, atol=SAME * np.abs(expected).max())


@needs_pyamg
def test_direct_solver_takes_over_from_a_singular_coarse_matrix(caplog):
    """A body without supports: the direct solver finds its free motions."""
    basis, forms, _ = cantilever()
    solver = multigrid.AmgOrDirect(basis.doflocs, np.arange(basis.N), most=50)
    with caplog.at_level(logging.INFO, "skfem_contact"), pytest.raises(SingularSystem):
        solver.factor(forms["beam"].elastic_stiffness, symmetric=True)(np.ones(basis.N))
    assert "a direct solver takes over" in caplog.text


@needs_pyamg
def test_iterations_do_not_grow_with_the_mesh(iterations):
    """[N] From 1,100 to 15,000 unknowns of a beam with rollers: not half as many again."""
    for n in (5, 12):
        basis, forms, fixed = cantilever(n)
        sc.Model(forms, fixed, solver="amg").run([sc.Stage("weight", sc.weight(basis, 20.0))])
    coarse, fine = iterations
    assert fine < 1.5 * coarse


@needs_pyamg
@pytest.mark.parametrize(
    "n, length, element, kind",
    [(4, 30, ElementHex1, MeshHex), (3, 100, ElementHex1, MeshHex), (2, 30, ElementTetP2, MeshTet)],
)
@pytest.mark.one_in(3)
def test_slender_beam(n, length, element, kind, iterations, monkeypatch):
    """[N] Cantilevers of 1:30 and 1:100, of which round-off leaves residuals of 1e-8: 40 iterations
    are enough.
    """
    monkeypatch.setattr(levels_of, "COARSEST", COARSEST)
    basis, forms, _ = cantilever(n, element, kind, length=length)
    free = free_of(basis, basis.get_dofs(lambda x: x[0] == 0).all())
    K, b = forms["beam"].elastic_stiffness, sc.weight(basis, 20.0)
    x = AmgSolver(basis.doflocs, free).factor(K, symmetric=True)(b)
    expected = DirectSolver(basis.doflocs, free, "superlu").factor(K)(b)
    # both have the round-off of a matrix of condition 1e8 to 1e10
    np.testing.assert_allclose(x, expected, atol=1e-5 * np.abs(expected).max())
    assert 1 < iterations[0] <= 40


@needs_pyamg
def test_bodies_of_different_size_far_apart(iterations, rng):
    """[N] Rigid motions are those of every body: one of a hundredth of the size, far away, costs
    nothing.
    """
    cube = MeshHex.init_tensor(*3 * [np.linspace(0, 1, 7)])
    mesh = sc.join_bodies({"large": cube, "small": cube.scaled(0.01).translated((50.0, 0.0, 0.0))})
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    K = sc.SolidForm(basis, ELASTIC, "full").elastic_stiffness
    free, b = (
        free_of(basis, basis.get_dofs(lambda x: x[2] == 0).all()),
        rng.standard_normal(basis.N),
    )
    x = as_solver("amg", basis.doflocs, free).factor(K, symmetric=True)(b)
    expected = DirectSolver(basis.doflocs, free, "superlu").factor(K)(b)
    for name in mesh.subdomains:
        there = basis.get_dofs(elements=name).all()
        np.testing.assert_allclose(
            x[there], expected[there], atol=SAME * np.abs(expected[there]).max()
        )
    assert iterations[0] <= 25


@needs_pyamg
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_contact(mu):
    """[N] Plane blocks that slide: the same iterations and displacements, K symmetric without
    friction only.
    """
    direct, multigrid = (run_stages(*blocks(mu=mu), solver=solver)[-1] for solver in (None, "amg"))
    assert multigrid.iterations == direct.iterations
    np.testing.assert_allclose(multigrid.x, direct.x, atol=SAME * np.abs(direct.x).max())


@needs_pyamg
@pytest.mark.parametrize("psi", [30.0, 0.0])
def test_yielding_soil(psi):
    """[N] A block that yields, K symmetric with associated flow only: the same displacements."""
    basis, forms, fixed = cantilever(
        material=sc.MohrCoulomb(E=1e4, nu=0.3, c=20.0, phi=30.0, psi=psi)
    )
    fixed = basis.get_dofs(lambda x: x[2] == 0).all()
    stages = [
        sc.Stage("weight", sc.weight(basis, 20.0)),
        sc.Stage("tilted", sc.weight(basis, 20.0, direction=(0.8, 0.0, -0.6)), increments=2),
    ]
    newton = sc.Newton(tolerance=1e-11)
    direct, multigrid = (
        sc.Model(forms, fixed, solver=solver, newton=newton).run(stages)[-1]
        for solver in (None, "amg")
    )
    assert (direct.states["beam"].internal > 0).any()
    np.testing.assert_allclose(multigrid.x, direct.x, atol=SAME * np.abs(direct.x).max())


def footing(n: int = 5, solver=None, psi: float = 0.0, **settings):
    """A rigid footing on a corner of soil on rollers, pressed until some of the soil yields; its
    load.
    """
    mesh = MeshHex.init_tensor(*3 * [np.linspace(0, 1, n + 1)]).with_boundaries(
        {"footing": lambda x: (x[2] == 1) & (x[0] <= 0.5) & (x[1] <= 0.5)}
    )
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    soil, foot = (
        sc.MohrCoulomb(E=1e4, nu=0.3, c=20.0, phi=30.0, psi=psi),
        basis.get_dofs("footing").all("u^3"),
    )
    forms, x = {"soil": sc.SolidForm(basis, soil)}, basis.zeros()
    x[foot] = -1e-2
    model = sc.Model(forms, np.union1d(sc.box_supports(basis), foot), solver=solver, **settings)
    stage = model.run([sc.Stage("pressed", prescribed=x)])[-1]
    return stage, forms["soil"].assemble(stage.x, stage.states["soil"]).force[foot].sum()


@needs_pyamg
@pytest.mark.parametrize("psi", [30.0, 0.0])
def test_inexact_directions(psi, iterations):
    """[N] The load of a footing on yielding soil, with a third of the iterations of accurate
    solutions.
    """
    (direct, expected), (_, load) = footing(psi=psi), footing(solver="amg", psi=psi)
    assert (direct.states["soil"].internal > 0).any()
    assert load == pytest.approx(expected, rel=1e-7)  # ten times the tolerance of the residual
    few, accurate = len(iterations), sum(direct.iterations)
    assert few <= 1.5 * accurate
    assert max(iterations) <= 12  # accurate solutions take 20


@needs_pyamg
def test_same_twice_and_random_numbers_of_the_user_stay():
    """[X] The same bits in two runs; pyamg draws random numbers, but the user's go on as if it did
    not.
    """
    basis, forms, fixed = cantilever(3)
    K, free, b = forms["beam"].elastic_stiffness, free_of(basis, fixed), sc.weight(basis, 1.0)
    np.random.seed(1)  # noqa: NPY002
    expected = np.random.rand()  # noqa: NPY002
    np.random.seed(1)  # noqa: NPY002
    first, second = (
        as_solver("amg", basis.doflocs, free).factor(K, symmetric=True)(b) for _ in range(2)
    )
    assert np.random.rand() == expected  # noqa: NPY002
    np.testing.assert_array_equal(first, second)


@needs_pyamg
def test_levels_are_kept_while_they_serve(levels, iterations):
    """[X] New values alone make no new levels; contact that closes does, once solutions take many
    more iterations.
    """
    basis, forms, fixed = cantilever(3)
    K, free, b = forms["beam"].elastic_stiffness, free_of(basis, fixed), sc.weight(basis, 1.0)
    solver = as_solver("amg", basis.doflocs, free)
    for matrix, symmetric in ((K, True), (K.copy(), True), (2.0 * K, True), (2.0 * K, False)):
        solver.factor(matrix, symmetric)(b)
    assert len(levels) == 1
    other = np.flatnonzero(basis.doflocs[0] > 1.0)
    spring = csr_matrix(
        (np.full(len(other), 1e6), (other, other)), shape=K.shape
    )  # a hundred times as stiff
    before = len(iterations)
    for matrix in (K + spring, 1.1 * (K + spring)):
        solver.factor(matrix, True)(b)
    stopped, continued, new = iterations[before:]
    assert len(levels) == 2
    assert stopped <= iterations[0] + multigrid.KEPT + 1  # other levels would have cost no more
    assert new < stopped + continued
    rough = as_solver("amg", basis.doflocs, free)
    rough.factor(K)(b, 1e-2)
    assert iterations[-1] < 0.5 * iterations[0]


@needs_pyamg
def test_coarse_matrices_are_computed_anew(rng):
    """[X] Of a hundred times the stiffness the aggregates are the same: its levels with new
    matrices are those of K.
    """
    basis, forms, fixed = cantilever(3)
    solver = AmgSolver(basis.doflocs, free_of(basis, fixed))
    K = solver._nodes.gather(forms["beam"].elastic_stiffness)
    blocks, r = K.tobsr((3, 3)), rng.standard_normal(K.shape[0])
    own, other = solver._built(K, blocks), solver._built(K, 100.0 * blocks)
    expected = own.cycle(K, blocks)(r)
    assert np.abs(other.cycle(K, blocks)(r) - expected).max() > 0.1 * np.abs(expected).max()
    other.update(blocks)
    other._largest = None  # the largest eigenvalue is estimated from the same vector
    np.testing.assert_allclose(
        other.cycle(K, blocks)(r), expected, atol=1e-10 * np.abs(expected).max()
    )


@needs_pyamg
@pytest.mark.parametrize("symmetric", [True, False])
def test_only_fgmres_smooths_in_single_precision(symmetric, monkeypatch):
    """[X] Conjugate gradients need a cycle that is symmetric to round-off of double precision."""
    basis, forms, fixed = cantilever()
    made, smoother = [], levels_of.SingleSmoother
    monkeypatch.setattr(
        levels_of, "SingleSmoother", lambda *matrices: made.append(1) or smoother(*matrices)
    )
    solver = AmgSolver(basis.doflocs, free_of(basis, fixed))
    solver.factor(forms["beam"].elastic_stiffness, symmetric)
    assert len(made) == (0 if symmetric else 1)


def test_rigid_modes_meet_no_resistance():
    """[X] Six independent motions of a body in space, three in the plane."""
    for kind, element, strain, count in (
        (MeshHex, ElementHex1, "full", 6),
        (MeshQuad, ElementQuad1, "full", 3),
    ):
        basis = Basis(kind().refined(2), ElementVector(element()), intorder=2)
        K = sc.SolidForm(basis, ELASTIC, strain).elastic_stiffness
        modes = rigid_modes(basis.doflocs, np.arange(basis.N))
        assert modes.shape == (basis.N, count)
        assert np.linalg.matrix_rank(modes) == count
        assert np.abs(K @ modes).max() < 1e-13 * abs(K).max() * 10  # sums of some ten terms


# -- failures


@needs_pyamg
def test_loose_body():
    """A load on a body that can move is not balanced by any displacement; the direct solver names
    the dofs.
    """
    basis, forms, _ = cantilever(2)
    K, free = forms["beam"].elastic_stiffness, np.arange(3, basis.N)
    with pytest.raises(
        sc.NotConverged, match=r"algebraic multigrid does not converge, .* bodies may be loose"
    ):
        AmgSolver(basis.doflocs, free).factor(K, True)(sc.weight(basis, 1.0))
    with pytest.raises(SingularSystem, match="the system is singular"):
        as_solver("amg", basis.doflocs, free).factor(K, True)(sc.weight(basis, 1.0))


@needs_pyamg
def test_direct_solver_takes_over_where_multigrid_was_asked_for(monkeypatch, caplog):
    """[X] The result is the direct solver's, and the log says so."""
    basis, forms, fixed = cantilever(3)
    stages = [sc.Stage("weight", sc.weight(basis, 20.0))]
    expected = sc.Model(forms, fixed).run(stages)[-1].x
    monkeypatch.setattr(multigrid, "MOST", 1)
    with caplog.at_level(logging.INFO, logger="skfem_contact"):
        x = sc.Model(forms, fixed, solver="amg").run(stages)[-1].x
    np.testing.assert_array_equal(x, expected)
    assert sum(r.getMessage().endswith("a direct solver takes over") for r in caplog.records) == 1


@needs_pyamg
def test_rough_solutions_end(monkeypatch, rng):
    """[X] Rough solutions end early, later after a bad one, and must leave less than a tenth in the
    end.
    """
    basis, forms, fixed = cantilever(3)
    K, free, b = (
        forms["beam"].elastic_stiffness,
        free_of(basis, fixed),
        rng.standard_normal(basis.N),
    )
    monkeypatch.setattr(multigrid, "_EARLY", 1)
    monkeypatch.setattr(multigrid, "_FAR", 1e-3)
    solver, taken, left = multigrid.AmgSolver(basis.doflocs, free), [], []
    for rtol in (1e-3, 1e-3, 1e-3, 0.5, 1e-3, 1e-4):
        x = solver.factor(K)(b, rtol)
        taken.append(solver.iterations)
        left.append(np.linalg.norm((b - K @ x)[free]) / np.linalg.norm(b[free]))
    assert taken[:5] == [1, 2, 2, 1, 1] and taken[5] > 4  # the fourth one is close
    assert left[0] > 0.1 > left[1] > 1e-3 and left[5] < 1e-4
    limited = multigrid.AmgSolver(basis.doflocs, free, most=2)
    for _ in range(2):  # the second one may take the largest number of iterations
        limited.factor(K)(b, 1e-3)
    monkeypatch.setattr(multigrid, "ENOUGH", 1e-3)
    with pytest.raises(NotConverged, match="after 2 iterations"):
        limited.factor(K)(b, 1e-3)


@needs_pyamg
def test_bad_matrices():
    basis, forms, fixed = cantilever(2)
    K, solver = (
        forms["beam"].elastic_stiffness,
        as_solver("amg", basis.doflocs, free_of(basis, fixed)),
    )
    with pytest.raises(ValueError, match="the right-hand side has entries that are not finite"):
        solver.factor(K)(np.full(basis.N, np.nan))
    with pytest.raises(ValueError, match="the stiffness has entries that are not finite"):
        solver.factor(K + np.nan * K)
    with pytest.raises(SingularSystem, match="dofs meet no stiffness"):
        solver.factor(0.0 * K)


@needs_pyamg
def test_nothing_to_solve_for():
    basis, forms, _ = cantilever(2)
    solve = as_solver("amg", basis.doflocs, np.zeros(0, int)).factor(
        forms["beam"].elastic_stiffness
    )
    assert not solve(np.ones(basis.N)).any()


def test_pyamg_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyamg", None)
    with pytest.raises(
        ImportError, match=r'solver="amg" needs pyamg: pip install "skfem-contact\[amg\]"'
    ):
        as_solver("amg", np.zeros((3, 3)), np.arange(3))


def test_name_that_does_not_exist():
    with pytest.raises(ValueError, match="one of pardiso, superlu, amg, or a function"):
        as_solver("cholmod", np.zeros((3, 3)), np.arange(3))


# -- choice


def chosen(forms, basis, fixed, solver=None):
    return choice.linear_solver(forms, solver, basis.doflocs, free_of(basis, fixed))


@needs_pyamg
def test_choice(monkeypatch, caplog):
    """Multigrid is for large bodies in space alone, by what is installed beside it, and what solves
    is told.
    """
    basis, forms, fixed = cantilever(3)
    soil = cantilever(3, material=sc.MohrCoulomb(E=1e4, nu=0.3, c=20.0, phi=30.0, psi=0.0))[1]
    assert isinstance(chosen(forms, basis, fixed), DirectSolver)  # small
    monkeypatch.setattr(multigrid, "PER_ITERATION_YIELDING", {"pardiso": 1, "superlu": 1})
    assert isinstance(
        chosen(soil, basis, fixed), multigrid.AmgOrDirect
    )  # it may yield, and has no symmetric tangent
    assert isinstance(chosen(forms, basis, fixed), DirectSolver)  # it stays elastic
    monkeypatch.setattr(multigrid, "PER_ITERATION", {"pardiso": 1, "superlu": 1})
    with caplog.at_level(logging.INFO, logger="skfem_contact"):
        assert isinstance(chosen(forms, basis, fixed), multigrid.AmgOrDirect)
    assert [r.getMessage() for r in caplog.records] == [
        "linear solver: algebraic multigrid (pyamg)"
    ]
    assert isinstance(chosen(forms, basis, fixed, "superlu"), DirectSolver)  # as it was told
    plane, _, held = blocks()
    assert not isinstance(chosen(plane, plane["blocks"].basis, held)._solver, multigrid.AmgOrDirect)
    monkeypatch.setitem(multigrid.PER_ITERATION, "superlu", 20)
    monkeypatch.setattr(choice, "fastest_engine", lambda: "superlu")
    assert isinstance(
        chosen(forms, basis, fixed), DirectSolver
    )  # less than 20 iterations would pay
    monkeypatch.setitem(multigrid.PER_ITERATION, "superlu", 1)
    monkeypatch.setattr(multigrid, "find_spec", lambda name: None)
    assert isinstance(chosen(forms, basis, fixed), DirectSolver)  # no pyamg


@needs_pyamg
def test_choice_of_bodies_in_contact(monkeypatch):
    """Elastic ones in contact are factored once, but very large ones."""
    forms, basis, fixed = cubes()
    monkeypatch.setattr(multigrid, "PER_ITERATION", {"pardiso": 1, "superlu": 1})
    kept = chosen(forms, basis, fixed)
    assert isinstance(kept, SchurSolver)
    assert isinstance(kept._solver, multigrid.AmgOrDirect)
    monkeypatch.setattr(choice, "FACTORED_ONCE", 100)
    assert isinstance(chosen(forms, basis, fixed), multigrid.AmgOrDirect)


@needs_pyamg
def test_direct_solver_takes_over(monkeypatch, caplog):
    """Where multigrid was not asked for its failure costs time, not the result, and only once."""
    basis, forms, fixed = cantilever(3)
    stages = [
        sc.Stage(name, sc.weight(basis, gamma)) for name, gamma in (("one", 10.0), ("two", 20.0))
    ]
    expected = sc.Model(forms, fixed).run(stages)
    monkeypatch.setattr(
        multigrid, "PER_ITERATION", {"pardiso": 200, "superlu": 200}
    )  # two iterations would pay
    monkeypatch.setattr(multigrid, "FEWEST", 1)
    with caplog.at_level(logging.INFO, logger="skfem_contact"):
        result = sc.Model(forms, fixed).run(stages)
    np.testing.assert_array_equal(result[-1].x, expected[-1].x)
    lines = [r.getMessage() for r in caplog.records]
    assert sum("multigrid does not converge" in line for line in lines) == 1
    assert sum(line.startswith("linear solver:") for line in lines) == 2


# -- contact in space


def cubes(n: int = 5, mu: float = 0.0, ratio: float = 10.0):
    """A cube on another one of a coarser mesh, held at bottom and top, with a penalty of so many
    times E/h.
    """

    def cube(m, low):
        mesh = MeshHex.init_tensor(
            *2 * [np.linspace(0, 1, m + 1)], np.linspace(low, low + 1, m + 1)
        )
        return mesh.with_boundaries(
            {"bottom": lambda x: x[2] == low, "top": lambda x: x[2] == low + 1}
        )

    basis = Basis(
        sc.join_bodies({"lower": cube(n - 1, 0), "upper": cube(n, 1)}),
        ElementVector(ElementHex1()),
        intorder=2,
    )
    pair = sc.ContactPair(
        basis, "upper:bottom", "lower:top", sc.Coulomb(mu=mu), 2, penalty=ratio * 1e4 * n
    )
    forms = {"cubes": sc.SolidForm(basis, ELASTIC, "full"), "joint": pair}
    return forms, basis, basis.get_dofs({"lower:bottom", "upper:top"}).all()


def pressed(forms, basis, sideways: float = 0.0):
    """Tangent of the upper cube in the lower one, displaced sideways."""
    upper, x = basis.get_dofs(elements="upper"), basis.zeros()
    x[upper.all("u^3")], x[upper.all("u^1")] = -1e-6, sideways
    return sum(form.assemble(x, form.initial_state()).stiffness for form in forms.values())


@needs_pyamg
@pytest.mark.parametrize(
    "mu, sideways", [(0.0, 0.0), (10.0, 1e-7), (0.3, 1e-5)], ids=["closed", "stick", "slip"]
)
def test_contact_costs_few_iterations(mu, sideways, iterations, rng):
    """[N] From the softest penalty to one a thousand times as hard, and against the bodies
    alone.
    """
    forms, basis, fixed = cubes()
    free, b = free_of(basis, fixed), rng.standard_normal(basis.N)
    AmgSolver(basis.doflocs, free).factor(forms["cubes"].elastic_stiffness, symmetric=True)(b)
    for ratio in (1.0, 30.0, 1000.0):
        forms = cubes(mu=mu, ratio=ratio)[0]
        K = pressed(forms, basis, sideways)
        solver = AmgSolver(basis.doflocs, free, forms["joint"].changing)
        x = solver.factor(K, symmetric=mu == 0.0)(b)
        expected = DirectSolver(basis.doflocs, free, "superlu").factor(K)(b)
        np.testing.assert_allclose(
            x, expected, atol=10 * SAME * np.abs(expected).max()
        )  # hard penalties cost digits
    alone, *together = iterations
    assert max(together) <= 1.2 * min(together) + 1  # of so few, one is a tenth
    assert (
        max(together) <= (1.2 if mu == 10.0 else 1.6) * alone
    )  # blocks that slide on each other are less stiff


@needs_pyamg
def test_indefinite_tangent(iterations, rng):
    """[N] Surfaces pressed far into each other have a tangent that is not definite: FGMRES takes
    over.
    """
    forms, basis, fixed = cubes(ratio=100.0)
    K, free, b = pressed(forms, basis), free_of(basis, fixed), rng.standard_normal(basis.N)
    inside = basis.get_dofs(elements="upper").all("u^3")
    K = K - csr_matrix((np.full(len(inside), 160.0), (inside, inside)), shape=K.shape)
    assert eigsh(K[free][:, free], 1, which="SA")[0][0] < 0.0
    x = AmgSolver(basis.doflocs, free, forms["joint"].changing).factor(K, symmetric=True)(b)
    expected = DirectSolver(basis.doflocs, free, "superlu").factor(K)(b)
    np.testing.assert_allclose(
        x, expected, atol=10 * SAME * np.abs(expected).max()
    )  # its condition is worse


@needs_pyamg
def test_worn_levels_are_made_anew(levels):
    """Where levels of another tangent lead nowhere, new ones do."""
    forms, basis, fixed = cubes()
    K, b = pressed(forms, basis), sc.weight(basis, 20.0)
    solver = AmgSolver(basis.doflocs, free_of(basis, fixed), most=25)
    solver.factor(forms["cubes"].elastic_stiffness, symmetric=True)(b)
    x = solver.factor(K, symmetric=True)(b)
    expected = DirectSolver(basis.doflocs, free_of(basis, fixed), "superlu").factor(K)(b)
    np.testing.assert_allclose(x, expected, atol=SAME * np.abs(expected).max())
    assert len(levels) == 2


@needs_pyamg
def test_another_library_as_given_solver():
    """[N] `solver=` takes any function (A, b) -> x: pyamg's own, as PETSc's would be, solves
    contact in space.
    """
    from pyamg import smoothed_aggregation_solver

    def solve(A, b):
        return smoothed_aggregation_solver(A).solve(b, tol=1e-10, maxiter=500, accel="cg")

    forms, basis, fixed = cubes(3)
    x = basis.zeros()
    x[basis.get_dofs("upper:top").all("u^3")] = -1e-2
    stage = sc.Stage("pressed", basis.zeros(), prescribed=x)
    given, direct = (
        sc.Model(forms, fixed, solver=solver).run([stage])[-1] for solver in (solve, "superlu")
    )
    assert given.iterations == direct.iterations
    np.testing.assert_allclose(given.x, direct.x, atol=SAME * np.abs(direct.x).max())
