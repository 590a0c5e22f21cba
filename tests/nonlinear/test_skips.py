"""What a scene does not need is skipped, and the result is the same as without the skip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.sparse import block_diag, diags

import skfem_contact as sc
from skfem_contact.contact import interface, neighbours
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.forms import assembly, solid
from skfem_contact.nonlinear.stepping import Predictor
from skfem_contact.nonlinear.system import System
from skfem_contact.results import Result
from skfem_contact.solvers import direct, schur, superlu
from skfem_contact.solvers.choice import as_solver
from skfem_contact.solvers.direct import SingularSystem
from skfem_contact.solvers.schur import SchurSolver
from skfem_contact.sparse import Gathering
from skfem_contact.stages import run, setup
from tests.tools.helpers import counted, grid, run_stages, vector_basis

#: Displacements of two analyses whose residuals are below 1e-12 of the load, relative: conditioning
#: times that.
SAME = 1e-9
NEWTON = sc.Newton(tolerance=1e-12)


def pressed(
    material: sc.MohrCoulomb | sc.LinearElastic,
    load: float = 40.0,
    above: float = 0.0,
    enforcement=None,
):
    """A rigid-like block pressed and pushed onto a layer from some way above, analysed in three
    increments.
    """
    layer = grid("Q1", np.linspace(-3, 3, 25), np.linspace(-2, 0, 9))
    block = grid("Q1", np.linspace(-1, 1, 10), np.linspace(above, above + 1, 5))
    basis = vector_basis(sc.join_bodies({"layer": layer, "block": block}), "Q1", intorder=2)
    forms = {
        "layer": sc.SolidForm(basis.with_elements("layer"), material),
        "block": sc.SolidForm(basis.with_elements("block"), sc.LinearElastic(E=1e6, nu=0.2)),
        "joint": sc.ContactPair(
            basis,
            "layer:top",
            "block:bottom",
            sc.Coulomb(mu=0.3),
            quadrature=2,
            enforcement=enforcement,
        ),
    }
    fixed = np.concatenate(
        (basis.get_dofs("layer:bottom").all(), basis.get_dofs("block:top").all())
    )
    x = basis.zeros()
    x[basis.get_dofs("block:top").all("u^2")] = -1e-4 * load - above
    x[basis.get_dofs("block:top").all("u^1")] = 0.5e-4 * load
    return forms, [sc.Stage("pressed", basis.zeros(), prescribed=x, increments=3)], fixed


def analysed(*scene) -> Result:
    return run_stages(*scene, newton=NEWTON)


def assert_same(one: Result, other: Result) -> None:
    a, b = one[-1], other[-1]
    assert a.iterations == b.iterations
    np.testing.assert_allclose(a.x, b.x, rtol=0, atol=SAME * np.abs(b.x).max())
    pressure = b.states["joint"].traction[0]
    np.testing.assert_allclose(
        a.states["joint"].traction[0], pressure, rtol=0, atol=SAME * np.abs(pressure).max()
    )


def assert_same_state(one: Result, other: Result) -> None:
    a, b = one[-1], other[-1]
    np.testing.assert_allclose(a.x, b.x, rtol=0, atol=SAME * np.abs(b.x).max())
    for new, old in zip(
        *((*s.traction, s.slip) for s in (a.states["joint"], b.states["joint"])), strict=True
    ):
        np.testing.assert_allclose(new, old, rtol=0, atol=10 * SAME * np.abs(old).max())
    np.testing.assert_array_equal(a.states["joint"].status, b.states["joint"].status)


def assert_identical(one: Result, other: Result) -> None:
    """To the last bit, what open points remember included."""
    a, b = one[-1], other[-1]
    assert a.iterations == b.iterations
    np.testing.assert_array_equal(a.x, b.x)
    for name, values in vars(a.states["joint"]).items():
        np.testing.assert_array_equal(values, getattr(b.states["joint"], name), err_msg=name)


soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=25.0, psi=5.0)
rock = sc.LinearElastic(E=1e4, nu=0.3)


def test_elastic_stiffness_is_assembled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """One batch of element matrices a body in the whole analysis; afresh for every tangent gives
    the same.
    """
    calls = counted(monkeypatch, solid, "element_stiffness")
    once = analysed(*pressed(rock))
    assert len(calls) == 2
    monkeypatch.setattr(
        sc.SolidForm, "elastic_stiffness", property(sc.SolidForm.elastic_stiffness.func)
    )
    assert_same(once, analysed(*pressed(rock)))
    assert len(calls) > 2 + 2 * sum(once[-1].iterations)


@dataclass(frozen=True, eq=False)
class Everywhere(sc.MohrCoulomb):
    """Soil that hands out its tangent at every point."""

    def update(self, strain_increment, stress, internal):
        answer = super().update(strain_increment, stress, internal)
        moduli = np.tile(self.elasticity(4), (stress[0].size, 1, 1))
        moduli[answer.plastic] = answer.tangent()
        return answer._replace(plastic=np.arange(stress[0].size), tangent=lambda: moduli)


def test_only_elements_that_yield_are_assembled(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tangent of all elements is that of the elastic body with those corrected that hold a
    plastic point.
    """
    sizes: list[int] = []
    stiffness = solid.element_stiffness
    monkeypatch.setattr(
        solid, "element_stiffness", lambda B, D: (sizes.append(len(B)), stiffness(B, D))[1]
    )
    part = analysed(*pressed(soil))
    assert 0 < max(sizes[2:]) < 0.5 * max(sizes)
    assert_same(part, analysed(*pressed(Everywhere(E=1e4, nu=0.3, c=10.0, phi=25.0, psi=5.0))))


def test_elastic_moduli_are_computed_only_where_a_law_gives_no_tangent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """[N] A law that gives tangents at all points is asked for no elastic moduli of its stress, and
    the stiffness is the slope of the force; where it gives them at half of the points, it is asked.
    """
    basis = vector_basis(grid("Q1", [0, 1, 2], [0, 1, 2]), "Q1")
    form = sc.SolidForm(basis, sc.HardeningSoil(2e4, 2e4, 6e4, 0.5, c=5.0, phi=30.0))
    stress = np.zeros((4, *form.weight.shape))
    stress[:3] = -100.0
    state = form.initial_state(stress=stress)
    moved = np.zeros(basis.N)
    moved[basis.nodal_dofs] = [[2e-4], [-1e-3]] * basis.mesh.p
    assert form.elastic_stiffness.nnz  # of no stress, once a body
    calls = counted(monkeypatch, sc.HardeningSoil, "elasticity")
    stiffness = form.assemble(moved, state).stiffness
    assert not calls
    change = 1e-4 * moved
    rise = form.assemble(moved + change, state).force - form.assemble(moved - change, state).force
    # central differences of a share of 1e-4: their error is the square of it, and round-off
    np.testing.assert_allclose(2.0 * stiffness @ change, rise, atol=1e-6 * np.abs(rise).max())

    # give tangents at half of the points
    update = sc.HardeningSoil.update

    def halved(self, strain_increment, stress, internal):
        answer = update(self, strain_increment, stress, internal)
        half = answer.plastic[::2]
        return answer._replace(plastic=half, tangent=lambda: answer.tangent()[half])

    monkeypatch.setattr(sc.HardeningSoil, "update", halved)
    assert form.assemble(moved, state).stiffness.nnz
    assert calls


@pytest.mark.parametrize("enforcement", [None, sc.DualMultipliers()])
def test_factors_are_kept_while_only_the_interface_changes(
    monkeypatch: pytest.MonkeyPatch, enforcement
) -> None:
    """Elastic bodies in contact: one factorisation instead of one each."""
    kept, each = counted(monkeypatch, schur._Base, "of"), counted(monkeypatch, superlu, "splu")
    scene = pressed(rock, enforcement=enforcement)
    result = run_stages(*scene, newton=NEWTON, solver="superlu")
    assert (len(kept), len(each)) == (1, 1)
    monkeypatch.setattr(setup, "linear_solver", lambda forms, *args: as_solver(*args))
    assert_same(result, run_stages(*scene, newton=NEWTON, solver="superlu"))
    assert len(each) > 5


def test_factors_are_not_kept_where_bodies_yield(monkeypatch: pytest.MonkeyPatch) -> None:
    """There they would be of no use."""
    kept = counted(monkeypatch, schur._Base, "of")
    analysed(*pressed(soil))
    assert not kept


@pytest.mark.parametrize("engine", ["superlu", "pardiso"])
def test_interface_solver_solves_as_a_new_factor_does(engine: str) -> None:
    """[N] Solutions with kept factors have small residuals, whatever changes on the interface."""
    if engine == "pardiso":
        pytest.importorskip("pypardiso")
    forms, _, fixed = pressed(rock)
    forms = choose_penalties(forms)
    basis = forms["block"].basis
    free = np.setdiff1d(np.arange(basis.N), fixed)
    joint, rng = forms["joint"], np.random.default_rng(3)
    inner = as_solver(engine, basis.doflocs, free)
    solver = SchurSolver(inner, basis.doflocs, free, joint.changing, engine)
    bodies = forms["layer"].elastic_stiffness + forms["block"].elastic_stiffness
    for depth in (1e-3, 2e-3, 3e-3, 1e-2):
        x = basis.zeros()
        x[basis.get_dofs(elements="block").all("u^2")] = -depth
        K = (
            bodies
            + joint.assemble(
                x + 1e-4 * rng.standard_normal(basis.N), joint.initial_state()
            ).stiffness
        )
        b = rng.standard_normal(basis.N)
        residual = (K @ solver.factor(K)(b) - b)[free]
        assert np.linalg.norm(residual) < 1e-9 * np.linalg.norm(b)  # refined from 1e-10 on
    assert solver._base is not None


@pytest.mark.parametrize("engine", ["superlu", "pardiso"])
def test_interface_that_lets_a_body_slide_is_left_to_the_other_solver(engine: str) -> None:
    """[X] A body that only the interface holds moves freely once it loses its shear stiffness."""
    if engine == "pardiso":
        pytest.importorskip("pypardiso")
    forms, _, fixed = pressed(rock)
    basis, joint = forms["block"].basis, choose_penalties(forms)["joint"]
    bodies = forms["layer"].elastic_stiffness + forms["block"].elastic_stiffness
    # nothing but the joint holds the block
    held = np.setdiff1d(fixed, basis.get_dofs(elements="block").all())
    free = np.setdiff1d(np.arange(basis.N), held)
    own = np.intersect1d(joint.changing, basis.get_dofs(elements="block").all())
    upwards = np.intersect1d(own, basis.get_dofs(elements="block").all("u^2"))
    inner = as_solver(engine, basis.doflocs, free)
    solver = SchurSolver(inner, basis.doflocs, free, joint.changing, engine)
    springs = np.zeros(basis.N)
    springs[own] = 1e3
    down = basis.zeros()
    down[basis.get_dofs(elements="block").all("u^2")] = -1.0  # nothing pushes it sideways
    solver.factor(bodies + diags(springs, format="csr"))(down)
    assert solver._base is not None
    springs[np.setdiff1d(own, upwards)] = 0.0
    with pytest.raises(SingularSystem):
        solver.factor(bodies + diags(springs, format="csr"))(down)


def test_interface_without_stiffness_is_left_to_the_other_solver() -> None:
    """[X] A multiplier whose row becomes zero makes the dense system singular: no warning, the
    other solver decides.
    """
    forms, _, fixed = pressed(rock)
    basis, joint = forms["block"].basis, choose_penalties(forms)["joint"]
    n, free = basis.N, np.setdiff1d(np.arange(basis.N + 1), fixed)
    bodies = forms["layer"].elastic_stiffness + forms["block"].elastic_stiffness
    asked: list[float] = []

    class Other:
        name = "other"

        def factor(self, K, symmetric=False):
            asked.append(K[n, n])
            return lambda b, rtol=1e-10: 0.0 * b

    solver = SchurSolver(
        Other(), np.c_[basis.doflocs, [[0.0], [0.0]]], free, np.append(joint.changing, n)
    )
    for stiffness in (1.0, 2.0, 0.0):
        solver.factor(block_diag([bodies, [[stiffness]]], "csr"))(np.ones(n + 1))
    assert asked == [0.0]


def test_bodies_in_equilibrium_inside_take_one_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is left to balance acts on the interface alone: one solution with the kept factors
    instead of two.
    """
    solutions: list[int] = []

    class Counted:
        def __init__(self, factors) -> None:
            self.factors = factors

        def __getattr__(self, name: str):
            if name == "solve":
                solutions.append(1)
            return getattr(self.factors, name)

    monkeypatch.setattr(
        superlu, "splu", lambda *args, splu=superlu.splu, **kwargs: Counted(splu(*args, **kwargs))
    )
    one = run_stages(*pressed(rock), newton=NEWTON, solver="superlu")
    few, iterations = len(solutions), sum(one[-1].iterations)
    monkeypatch.setattr(schur, "_NOTHING", 0.0)
    assert_same(one, run_stages(*pressed(rock), newton=NEWTON, solver="superlu"))
    probe = 2  # of the factors
    assert few - probe < 1.5 * iterations < len(solutions) - few


@pytest.mark.parametrize("above", [0.0, 0.4])
def test_far_points_are_never_projected(monkeypatch: pytest.MonkeyPatch, above: float) -> None:
    """Two thirds of the layer's points face nothing: they are looked at when a step is accepted,
    and only then.
    """
    projected: list[int] = []

    def counting(*args, project=interface.project, **named):
        among = named["among"]
        projected.append(len(np.unique(among.point)) if among is not None else 0)
        return project(*args, **named)

    monkeypatch.setattr(interface, "project", counting)
    near = analysed(*pressed(rock, above=above))
    few = sum(projected)
    projected.clear()
    at = neighbours.NeighbourList.at
    monkeypatch.setattr(
        neighbours.NeighbourList,
        "at",
        lambda *args: at(*args)._replace(clearance=np.full(len(args[2]), -np.inf)),
    )
    everywhere = analysed(*pressed(rock, above=above))
    assert_identical(near, everywhere)
    assert few < 0.8 * sum(projected)
    assert (near[-1].states["joint"].traction[0] < 0).any()


def test_places_of_contact_are_found_for_other_points_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the entries of the contact tangent go is found when other points touch; for every
    tangent the same.
    """
    finds, tangents = (
        counted(monkeypatch, Gathering, "_find"),
        counted(monkeypatch, Gathering, "matrix"),
    )
    once = analysed(*pressed(soil))
    few = len(finds)
    assert 0 < few < 0.5 * len(tangents)
    matrix = Gathering.matrix

    def afresh(gathering: Gathering, *args) -> object:
        gathering._dofs = None
        return matrix(gathering, *args)

    monkeypatch.setattr(Gathering, "matrix", afresh)
    assert_identical(once, analysed(*pressed(soil)))
    assert len(finds) - few == 0.5 * len(tangents)


@pytest.mark.parametrize("above", [0.0, 0.4])
def test_neighbours_are_searched_after_motion_only(
    monkeypatch: pytest.MonkeyPatch, above: float
) -> None:
    """One search in the mesh, one while the block hardly moves, a few while it comes down; more
    give the same.
    """
    searches = counted(monkeypatch, neighbours, "neighbours")
    once = analysed(*pressed(rock, above=above))
    few = len(searches)
    assert few == 2 if above == 0.0 else few > 2
    monkeypatch.setattr(neighbours, "_SLACK", 0.0)
    assert_identical(once, analysed(*pressed(rock, above=above)))
    assert len(searches) - few > few


def test_an_unchanged_matrix_is_not_factored_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three loads on an elastic body without contact: one factorisation, and the same result with
    three.
    """
    forms, _, fixed = pressed(rock)
    forms = {"block": forms["block"]}
    N = forms["block"].basis.N
    fixed = np.union1d(
        fixed, np.setdiff1d(np.arange(N), forms["block"].basis.get_dofs(elements="block").all())
    )
    down, along = np.zeros((2, N))
    free = np.setdiff1d(np.arange(N), fixed)
    down[free[free % 2 == 1]] = along[free[free % 2 == 0]] = 1.0
    stages = [sc.Stage("down", down), sc.Stage("along", down + along), sc.Stage("up", along)]
    calls = counted(monkeypatch, superlu, "splu")

    def displacements() -> np.ndarray:
        new = {"block": pressed(rock)[0]["block"]}
        return sc.Model(new, fixed, solver="superlu").run(stages)[-1].x

    once = displacements()
    assert len(calls) == 1
    monkeypatch.setattr(assembly, "constant", lambda K: K)
    monkeypatch.setattr(direct, "same_matrix", lambda A, B: False)
    np.testing.assert_array_equal(displacements(), once)
    assert len(calls) == 1 + 3


def test_a_line_search_pays_for_no_tangent(monkeypatch: pytest.MonkeyPatch) -> None:
    """As many tangents as linear systems, however often the force was asked for; none of the
    elastic block.
    """
    tangents = counted(monkeypatch, sc.SolidForm, "_tangent")
    forces = counted(monkeypatch, sc.SolidForm, "assemble")
    result = analysed(*pressed(soil, load=100.0))
    assert len(tangents) == sum(result[-1].iterations)
    assert len(forces) > 2 * len(tangents)


def test_bodies_are_not_evaluated_again_beside_another_contact(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A block slides over facets, which points choose between increments. Each equilibrium is
    checked with the contact as given; the bodies are as they were.
    """
    layer = grid("Q1", np.linspace(-2, 2, 17), np.linspace(-1, 0, 5))
    block = grid("Q1", np.linspace(-1, 0, 4), np.linspace(0, 1, 4))
    basis = vector_basis(sc.join_bodies({"layer": layer, "block": block}), "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, rock, kinematics="finite"),
        "joint": sc.ContactPair(
            basis, "layer:top", "block:bottom", sc.Coulomb(mu=0.3), quadrature=5
        ),
    }
    top = basis.get_dofs("block:top")
    x = basis.zeros()
    x[top.all("u^2")], x[top.all("u^1")] = -0.02, 0.5
    fixed = np.concatenate((basis.get_dofs("layer:bottom").all(), top.all()))
    scene = forms, [sc.Stage("pressed", basis.zeros(), prescribed=x, increments=3)], fixed

    bodies = counted(monkeypatch, sc.SolidForm, "assemble")
    contacts = counted(monkeypatch, sc.ContactPair, "assemble")
    once = analysed(*scene)
    assert len(bodies) < len(contacts)

    evaluate = System.evaluate
    monkeypatch.setattr(System, "evaluate", lambda self, *args: evaluate(self, *args[:3]))
    bodies.clear()
    contacts.clear()
    again = analysed(*scene)
    assert len(bodies) == len(contacts)
    assert_identical(once, again)


def squeezed_rubber() -> Result:
    """A block of rubber squeezed in two stages."""
    basis = vector_basis(grid("Q1", np.linspace(0, 1, 4), np.linspace(0, 1, 4)), "Q1", intorder=2)
    top, bottom = basis.get_dofs("top"), basis.get_dofs("bottom")
    body = sc.SolidForm(basis, sc.NeoHooke(E=1.0, nu=0.4), kinematics="finite")
    stages = []
    for depth in (0.1, 0.2):
        down = basis.zeros()
        down[top.all("u^2")] = -depth
        stages.append(sc.Stage(f"{depth}", prescribed=down, increments=3))
    model = sc.Model({"body": body}, np.concatenate([top.all(), bottom.all()]), newton=NEWTON)
    return model.run(stages, progress=False)


def test_elastic_strains_of_rubber_are_known(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are sought from stresses at the start only, and where the law is tried; the result is
    the same.
    """
    calls = counted(monkeypatch, sc.NeoHooke, "elastic_strain")
    once = squeezed_rubber()[-1]
    assert len(calls) == 3
    calls.clear()
    monkeypatch.setattr(sc.NeoHooke, "hyperelastic", False)
    again = squeezed_rubber()[-1]
    iterations = sum(once.iterations)
    assert len(calls) > 4 + iterations
    stress = again.states["body"].stress
    assert np.abs(once.states["body"].stress - stress).max() < SAME * np.abs(stress).max()


def test_arguments_are_checked_in_the_first_increment(monkeypatch: pytest.MonkeyPatch) -> None:
    """Later increments, and stages of the same forms, trust them."""
    trusted = []
    original = run.trusted_calls

    def recorded(trust: bool = True):
        trusted.append(trust)
        return original(trust)

    monkeypatch.setattr(run, "trusted_calls", recorded)
    result = squeezed_rubber()
    increments = sum(len(stage.iterations) for stage in result)
    assert trusted.count(False) == 1
    assert len(trusted) == 2 * increments


def test_an_order_of_elimination_serves_for_the_whole_analysis(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Bodies that yield are ordered once; ordered anew for every tangent they give the same."""
    monkeypatch.setattr(superlu, "KEPT", 0)
    monkeypatch.setattr(superlu, "_orders", {})
    orders = counted(monkeypatch, superlu, "nested_dissection")
    once = run_stages(*pressed(soil), newton=NEWTON, solver="superlu")
    assert len(orders) == 1
    monkeypatch.setattr(superlu.SuperLU, "outdated", lambda self: True)
    assert_same(once, run_stages(*pressed(soil), newton=NEWTON, solver="superlu"))
    assert len(orders) > sum(once[-1].iterations)


@pytest.mark.parametrize("material", [rock, soil], ids=["rock", "soil"])
def test_increments_start_where_the_last_one_leads(
    monkeypatch: pytest.MonkeyPatch, material
) -> None:
    """Pressed, and pushed until it slips: from extrapolated displacements fewer iterations lead to
    the same end.
    """
    forms, (down,), fixed = pressed(material)
    along = down.prescribed.copy()
    along[forms["block"].basis.get_dofs("block:top").all("u^1")] += 4e-3
    stages = [down, sc.Stage("pushed", down.load, prescribed=along, increments=8)]
    ahead = analysed(forms, stages, fixed)
    monkeypatch.setattr(Predictor, "start", lambda *args: None)
    afresh = analysed(forms, stages, fixed)
    assert_same_state(ahead, afresh)
    assert sum(ahead[-1].iterations) < 0.8 * sum(afresh[-1].iterations)
    assert (ahead[-1].states["joint"].status == Status.SLIP).any()


def test_an_increment_that_fails_ahead_starts_from_where_it_stands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A bad guess costs time, and nothing else."""
    afresh = analysed(*pressed(rock))
    start = Predictor.start

    def wild(*args) -> np.ndarray | None:
        x = start(*args)
        return None if x is None else 1e4 * x

    monkeypatch.setattr(Predictor, "start", wild)
    assert_same_state(analysed(*pressed(rock)), afresh)
