"""Forms of a user's own, matrices, springs and bars: alone, with soil and contact, in every kind of
analysis.
"""

from __future__ import annotations

import pickle
from copy import copy

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from skfem import (
    BilinearForm,
)
from skfem.models.elasticity import lame_parameters, linear_elasticity

import skfem_contact as sc
from skfem_contact.layout import FieldDofs
from tests.tools.helpers import grid, traction, vector_basis

QUIET = {"progress": False}


class TenLines(sc.Form):
    """A spring to the ground without any role."""

    def __init__(self, n, unknown, stiffness):
        self.size = n
        self.K = csr_matrix(([stiffness], ([unknown], [unknown])), shape=(n, n))

    def initial_state(self, x=None):
        return None

    def assemble(self, x, state):
        return sc.Response(self.K @ x, lambda: state, lambda: self.K)


def column(material=None, x=(0.0, 1.0, 5), y=(0.0, 2.0, 9)):
    """A column on rollers, and its load from above."""
    basis = vector_basis(grid("Q1", np.linspace(*x), np.linspace(*y)), "Q1", intorder=2)
    solid = sc.SolidForm(basis, material or sc.LinearElastic(E=1e3, nu=0.0), strain="b_bar")
    return basis, solid, traction(basis, "top", (0.0, -1.0))


def test_a_form_of_ten_lines_alone(tmp_path):
    """[X] u = F / k: run, saved, loaded and gone on from, though its state is None and nobody says
    where it is.
    """
    forms = {"spring": TenLines(3, 1, 20.0)}
    stages = [
        sc.Stage(name, np.array([0.0, force, 0.0]))
        for name, force in (("pull", 5.0), ("more", 8.0))
    ]
    first = sc.Model(forms, [0, 2]).run(stages[:1], **QUIET)
    first.save(tmp_path / "spring")
    again = sc.load_result(tmp_path / "spring", forms)
    assert again["pull"].states["spring"] is None
    result = sc.Model(forms, [0, 2]).run(stages[1:], start=again, **QUIET)
    np.testing.assert_allclose(
        [s.x[1] for s in result], [0.25, 0.4], rtol=1e-12
    )  # linear: round-off
    np.testing.assert_allclose(result["more"].reactions()[[0, 2]], 0.0, atol=1e-12)
    assert pickle.loads(pickle.dumps(result))["more"].x[1] == result["more"].x[1]


def test_a_matrix_alone():
    """[X] A bilinear form of scikit-fem in the place of the solid: the same displacements."""
    basis, solid, load = column()
    K = BilinearForm(linear_elasticity(*lame_parameters(1e3, 0.0)).form).assemble(basis)
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    stages = [sc.Stage("load", load)]
    own = sc.Model({"matrix": sc.MatrixForm(K)}, fixed).run(stages, **QUIET)["load"].x
    np.testing.assert_allclose(
        own, sc.Model({"solid": solid}, fixed).run(stages, **QUIET)["load"].x, atol=1e-15
    )


def scene(own):
    """A yielding column that rests on a rough base by contact, held by an own form at its
    corner.
    """
    base = grid("Q1", np.linspace(-1, 2, 10), np.linspace(-1, 0, 4))
    top = grid("Q1", np.linspace(0, 1, 5), np.linspace(0, 2, 9))
    basis = vector_basis(sc.join_bodies({"base": base, "column": top}), "Q1", intorder=2)
    corner = np.flatnonzero((basis.doflocs[0] == 1.0) & (basis.doflocs[1] == 2.0))[0]
    soil = sc.MohrCoulomb(E=1e3, nu=0.3, c=5.0, phi=0.0)
    forms = {
        "base": sc.SolidForm(basis.with_elements("base"), sc.LinearElastic(E=1e5, nu=0.3)),
        "column": sc.SolidForm(basis.with_elements("column"), soil, strain="b_bar"),
        "joint": sc.ContactPair(
            basis, "column:bottom", "base:top", sc.Coulomb(mu=0.5), quadrature=2
        ),
        "own": own(basis, int(corner)),
    }
    load = traction(basis, "column:top", (0.0, -4.0))
    fixed = np.append(basis.get_dofs("base:bottom").all(), basis.get_dofs("column:left").all("u^1"))
    return basis, forms, load, fixed, int(corner)


def ten_lines(basis, corner):
    return TenLines(basis.N, corner, 30.0)


def matrix(basis, corner):
    return sc.MatrixForm(ten_lines(basis, corner).K)


def spring(basis, corner):
    return sc.Spring(basis, (1.0, 2.0), (30.0, 0.0))


@pytest.mark.parametrize("own", [ten_lines, matrix, spring])
def test_with_soil_and_contact(own, tmp_path):
    """[X] The same spring in three spellings: equilibrium, saved and resumed, staged, pickled."""
    basis, forms, load, fixed, corner = scene(own)
    stages = [sc.Stage("load", load), sc.Stage("without", load, deactivate="own")]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    free = np.setdiff1d(np.arange(basis.N), fixed)
    assert (
        np.abs(result["load"].reactions()[free]).max() < 1e-6 * np.abs(load).max()
    )  # tolerance of the iterations
    assert result["without"].x[corner] > result["load"].x[corner] > 0.0
    result.save(tmp_path / "result")
    resumed = sc.Model(forms, fixed).run(
        stages[1:], start=sc.load_result(tmp_path / "result", forms)["load"], **QUIET
    )
    np.testing.assert_array_equal(resumed["without"].x, result["without"].x)
    assert pickle.loads(pickle.dumps(result))["load"].tractions("joint").pressure.shape
    sc.testing.check_form(
        forms["own"],
        np.random.default_rng(0).standard_normal(basis.N),
        forms["own"].initial_state(),
    )


@pytest.mark.parametrize("own", [ten_lines, matrix, spring])
def test_searches_for_a_collapse(own):
    """[X] A column that can spread collapses at q = 2 c / F; one of the nodes beside it is held by
    a stiff spring.
    """
    basis, solid, load = column(
        sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=0.0), x=(0.0, 1.0, 3), y=(0.0, 1.0, 3)
    )
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    held = basis.nodal_dofs[0, (basis.mesh.p == [[0.0], [1.0]]).all(axis=0)][0]
    stiff = {
        ten_lines: lambda: TenLines(basis.N, held, 1e8),
        matrix: lambda: sc.MatrixForm(TenLines(basis.N, held, 1e8).K),
        spring: lambda: sc.Spring(basis, (0.0, 1.0), (1e8, 0.0)),
    }
    forms, fixed = {"soil": solid, "own": stiff[own]()}, np.setdiff1d(fixed, held)
    assert (
        abs(sc.Model(forms, fixed).strength_reduction(10.0 * load, **QUIET).factor - 2.0) < 0.02
    )  # twice its `tol`
    assert (
        abs(sc.Model(forms, fixed).limit_load(load, **QUIET).multiplier - 20.0) < 0.2
    )  # ... of 0.005


def test_what_is_no_form():
    """Refused by name, before anything is computed."""
    basis, solid, load = column()

    class Half:
        def initial_state(self, x=None):
            return None

    class Duck:
        def assemble(self, x, state):
            return None

    class Ageing(sc.Form):
        def assemble(self, x, state):
            return None

        def over(self, duration):
            return self

    class Talking(sc.Form):
        def assemble(self, x, state):
            return None

        def summary(self, state):
            return "N = 5"

    wrongs = {
        Half(): "'own' is no form: .* has no assemble",
        Half: "'own' is no form: .* has no values",
        sc.Form(): "'own' is no form: .* has no assemble",
        Duck(): "'own' is no form: Duck has assemble, but does not derive from skfem_contact.Form",
        Ageing(): "'own' has `over`, .* derive Ageing from skfem_contact.roles.Timed as well",
        Talking(): "'own' has `summary`, .* return it from outputs",
    }
    for wrong, message in wrongs.items():
        with pytest.raises(ValueError, match=message):
            sc.Model({"solid": solid, "own": wrong}, basis.get_dofs("bottom").all()).run(
                [sc.Stage("load", load)]
            )


# -- bars


SOFT = 0.1


def pulled(bar, forces, basis):
    """Force in a bar at the corner of a rigid block that rolls along x, and how far it has
    moved.
    """
    forms = {
        "block": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.0)),
        "bar": bar,
        "soft": sc.Spring(basis, (0.0, 0.0), (SOFT, 0.0)),
    }
    stages = []
    for k, force in enumerate(forces):
        load = basis.zeros()
        load[basis.get_dofs("left").all("u^1")] = 0.5 * force
        stages.append(sc.Stage(f"{k}", load))
    return sc.Model(forms, basis.get_dofs().all("u^2")).run(stages, **QUIET)


def test_bar_by_its_law():
    """[X] EA/L, yielding, and thrust that a rope does not carry."""
    basis = vector_basis(grid("Q1", [0, 1], [0, 1]), "Q1", intorder=2)
    right = basis.nodal_dofs[0, 1]
    rod = sc.Bar(basis, (0.0, 0.0), (-2.0, 0.0), EA=100.0, fixed_end=True)
    result, k = pulled(rod, (3.0, -3.0), basis), 50.0
    share = k / (k + SOFT)
    np.testing.assert_allclose(
        [s.states["bar"].force[0] for s in result], (3.0 * share, -3.0 * share), rtol=1e-6
    )
    np.testing.assert_allclose(
        result["0"].x[right], 3.0 / (k + SOFT), rtol=1e-3
    )  # the block is not rigid
    rope = sc.Bar(basis, (0.0, 0.0), (-2.0, 0.0), EA=100.0, fixed_end=True, tension_only=True)
    result = pulled(rope, (3.0, -1e-2, 3.0), basis)
    np.testing.assert_allclose(
        [s.states["bar"].force[0] for s in result], (3.0 * share, 0.0, 3.0 * share), rtol=1e-6
    )
    np.testing.assert_allclose(result["1"].x[right], -1e-2 / SOFT, rtol=1e-4)
    weak = sc.Bar(basis, (0.0, 0.0), (-2.0, 0.0), EA=100.0, fixed_end=True, yield_force=2.0)
    result = pulled(weak, (2.1, 0.0), basis)
    np.testing.assert_allclose(result["0"].states["bar"].force, 2.0, rtol=1e-12)
    np.testing.assert_allclose(result["0"].x[right], 0.1 / SOFT, rtol=1e-4)
    flow = 0.1 / SOFT - 2.0 / k
    np.testing.assert_allclose(result["0"].states["bar"].free[0], flow, rtol=1e-4)
    np.testing.assert_allclose(
        result["1"].x[right], flow * share, rtol=1e-4
    )  # unloaded along its own stiffness


def test_jack_and_lock():
    """[X] A strut between two blocks: jacked to a force, locked, and unloaded by as much as the
    blocks are pushed.
    """
    boxes = {"a": grid("Q1", [0, 1], [0, 1]), "b": grid("Q1", [3, 4], [0, 1])}
    basis = vector_basis(sc.join_bodies(boxes), "Q1", intorder=2)
    strut = sc.Bar(basis, [(1.0, 0.0), (1.0, 1.0)], [(3.0, 0.0), (3.0, 1.0)], EA=50.0)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=100.0, nu=0.0)),
        "strut": strut.prestressed(-4.0),
    }
    fixed = np.concatenate(
        (basis.get_dofs({"a:left", "b:right"}).all("u^1"), basis.get_dofs().all("u^2"))
    )
    pull = basis.zeros()
    pull[basis.get_dofs("a:right").all("u^1")] = 2.0
    stages = [
        sc.Stage("jack", basis.zeros()),
        sc.Stage("lock", basis.zeros(), change={"strut": strut}),
        sc.Stage("pull", pull),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    np.testing.assert_allclose(result["jack"].states["strut"].force, -4.0)
    np.testing.assert_allclose(result["lock"].x, result["jack"].x, atol=1e-12)
    k, block = 25.0, 50.0  # of a strut, and of half a block
    share = k * block / (k + block) / (block + k * block / (k + block))
    np.testing.assert_allclose(result["pull"].states["strut"].force, -4.0 - 2.0 * share, rtol=1e-6)
    x = 1e-2 * np.random.default_rng(0).standard_normal(basis.N)
    sc.testing.check_form(strut, x, strut.initial_state(), basis.doflocs)


def test_displacements_counted_anew():
    """[X] Bars and springs keep their forces: nothing moves in a stage of the same load."""
    basis, solid, load = column()
    bar = sc.Bar(basis, (0.0, 2.0), (0.0, 5.0), EA=30.0, fixed_end=True)
    forms = {
        "column": solid,
        "bar": bar,
        "spring": sc.Spring(basis, (1.0, 2.0), 5.0),
        "own": TenLines(basis.N, 0, 0.0),
    }
    fixed = basis.get_dofs("bottom").all()
    start = sc.Model(forms, fixed).run([sc.Stage("load", load)], **QUIET).reset()
    again = sc.Model(forms, fixed).run([sc.Stage("null", load)], start=start, **QUIET)
    assert np.abs(again["null"].x).max() < 1e-12
    np.testing.assert_allclose(
        again["null"].states["bar"].force, start["load"].states["bar"].force, rtol=1e-12
    )


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda b: sc.Spring(b, (0.3, 0.3), 1.0),
            r"0 nodes at \(0.3, 0.3\); the nearest one is at",
        ),
        (lambda b: sc.Spring(b, (1.0, 0.0), 1.0), r"2 nodes at \(1, 0\); say by `part`"),
        (lambda b: sc.Spring(b, (1.0, 0.0), 1.0, part="c"), "no subdomain 'c'; existing: a, b"),
        (lambda b: sc.Spring(b, (0.0, 0.0), -1.0), "stiffness must be positive"),
        (lambda b: sc.Spring(b, (np.nan, 0.0), 1.0), "coordinates must be finite"),
        (lambda b: sc.Bar(b, (0.0, 0.0), (0.0, 0.0), 1.0, fixed_end=True), "must lie apart"),
        (
            lambda b: sc.Bar(b, (0.0, 0.0), (0.0, 9.0), 0.0, fixed_end=True),
            "EA and yield_force must be positive",
        ),
        (
            lambda b: sc.Bar(b, (0.0, 0.0), (0.0, 9.0), 1.0, True, yield_force=2.0).prestressed(
                3.0
            ),
            "between -2 and 2",
        ),
        (lambda b: sc.MatrixForm(csr_matrix((2, 3))), "must be a square matrix"),
    ],
)
def test_bad_input(make, message):
    basis = vector_basis(
        sc.join_bodies({"a": grid("Q1", [0, 1], [0, 1]), "b": grid("Q1", [1, 2], [0, 1])}), "Q1"
    )
    with pytest.raises(ValueError, match=message):
        make(basis)


# -- unknowns beyond the displacements, and time


class Rod(sc.Form):
    """A rigid ruler along the top edge that can turn about a point: one rotation, tied by
    multipliers of its own.
    """

    def __init__(self, basis, stiffness, angle_scale=1.0):
        self.size, self.top = basis.N, basis.get_dofs("top").all("u^2")
        places = basis.doflocs[:, self.top]
        self.arm = places[0] - places[0].mean()
        self.fields = (
            sc.Field("rotation", places.mean(axis=1)[:, None], "rotation", angle_scale),
            sc.Field("multiplier", places, "multiplier", stiffness),
        )

    def numbered(self, numbers):
        new = copy(self)
        (angle,), ties = (numbers[field] for field in self.fields)
        new.dofs = np.concatenate((self.top, [angle], ties))
        m = len(ties)
        C = np.hstack((np.eye(m), -self.arm[:, None]))
        new.K = csr_matrix(np.block([[np.zeros((m + 1, m + 1)), C.T], [C, np.zeros((m, m))]]))
        new.size = None
        return new

    def assemble(self, x, state):
        return sc.Response(self.K @ x[self.dofs], lambda: None, lambda: self.K, dofs=self.dofs)


@pytest.mark.parametrize("scale", [1.0, 1e3])
def test_rotation_and_multipliers_beside_displacements(scale):
    """[X] A rigid plate turns on a column: its rotation is that of an elimination by hand, whatever
    the scales.
    """
    basis, solid, _ = column(y=(0.0, 2.0, 17))
    rod = Rod(basis, 1e3, scale)
    load = np.zeros(basis.N + 1 + len(rod.top))
    load[basis.N] = 1.0  # a moment about its middle
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    result = sc.Model({"column": solid, "plate": rod}, fixed).run(
        [sc.Stage("turn", load)], **QUIET
    )["turn"]
    theta, top = result.x[basis.N], basis.get_dofs("top")
    arm = basis.doflocs[0, top.all("u^2")] - 0.5
    np.testing.assert_allclose(result.x[top.all("u^2")], theta * arm, atol=1e-12)
    free = np.setdiff1d(np.arange(len(load)), fixed)
    assert np.abs(result.reactions()[free]).max() < 1e-9  # forces of one
    alone = solid.elastic_stiffness.toarray()  # the oracle: eliminated by hand
    keep = np.setdiff1d(np.arange(basis.N), np.append(fixed, top.all("u^2")))
    T = np.zeros((basis.N, 1))
    T[top.all("u^2"), 0] = arm
    basis_of = np.column_stack((np.eye(basis.N)[:, keep], T))
    K = basis_of.T @ alone @ basis_of
    np.testing.assert_allclose(
        theta, np.linalg.solve(K, np.append(np.zeros(len(keep)), 1.0))[-1], rtol=1e-9
    )
    short = sc.Model({"column": solid, "plate": rod}, fixed).run(
        [sc.Stage("rest", basis.zeros())], **QUIET
    )["rest"]
    assert len(short.x) == len(load) and not short.x.any()  # a load on the displacements alone


def test_fields_belong_to_one_form():
    """A form under two names, or dofs of a field that no form brings, are refused."""
    basis, solid, _ = column()
    rod, other = Rod(basis, 1e3), Rod(basis, 1e3)
    with pytest.raises(ValueError, match="'a' and 'b' are the same form: it acts twice"):
        sc.Model({"column": solid, "a": rod, "b": rod})
    with pytest.raises(ValueError, match="'a' and 'b' bring the same field 'rotation'"):
        sc.Model({"column": solid, "a": rod, "b": copy(rod)})
    assert sc.Model({"column": solid, "a": rod, "b": other}).layout.size == basis.N + 2 * (
        1 + len(rod.top)
    )
    with pytest.raises(
        ValueError, match="the field 'multiplier', which no form of the model brings"
    ):
        sc.Model({"column": solid, "a": rod}, [FieldDofs(other.fields[1], np.arange(2))])


class Dashpot(sc.Form, sc.roles.Timed):
    """A viscous damper at an unknown: its force is that of the velocity over a step in time."""

    def __init__(self, n, unknown, viscosity):
        self.n, self.unknown, self.viscosity, self.duration = n, unknown, viscosity, 0.0
        self.size = n

    def over(self, duration):
        new = copy(self)
        new.duration = duration
        return new

    def initial_state(self, x=None):
        return np.zeros(1) if x is None else x[[self.unknown]]

    def assemble(self, x, state):
        c = self.viscosity / self.duration if self.duration else 1e12
        K = csr_matrix(([c], ([self.unknown], [self.unknown])), shape=(self.n, self.n))
        force = np.zeros(self.n)
        force[self.unknown] = c * (x[self.unknown] - state[0])
        return sc.Response(force, lambda: x[[self.unknown]], lambda: K)


def test_time_of_a_stage():
    """[X] Kelvin and Voigt: u = F/k (1 - exp(-k t / c)), by backward Euler of first order in the
    steps.
    """
    k, c, force, duration = 2.0, 4.0, 1.0, 3.0
    errors = []
    for steps in (10, 20, 40):
        forms = {"spring": TenLines(1, 0, k), "damper": Dashpot(1, 0, c)}
        load = np.array([force])
        stages = [
            sc.Stage("jump", load),
            sc.Stage("wait", load, increments=steps, duration=duration),
        ]
        result = sc.Model(forms).run(stages, **QUIET)
        assert abs(result["jump"].x[0]) < 1e-9  # in no time the damper lets nothing move
        exact = force / k * (1.0 - np.exp(-k * duration / c))
        euler = force / k * (1.0 - (1.0 + k * duration / steps / c) ** -steps)
        np.testing.assert_allclose(
            result["wait"].x[0], euler, rtol=1e-6
        )  # the tolerance of the iterations
        errors.append(exact - result["wait"].x[0])
    np.testing.assert_allclose(
        np.log2(np.divide(errors[:-1], errors[1:])), 1.0, atol=0.1
    )  # of first order


class SlackRope(sc.Form, sc.roles.Regularised):
    """A rope of stiffness 10 with a slack of 1, and a recovery of its own: a damper while nothing
    else resists.
    """

    size = 1

    def __init__(self, damping=0.0, at=0.0, given=None):
        self.damping, self.at, self.given = damping, at, given or self

    def initial_state(self, x=None):
        return np.zeros(1)

    def assemble(self, x, state):
        force = 10 * np.maximum(x - 1, 0) + self.damping * (x - self.at)
        return sc.Response(force, lambda: x, lambda: csr_matrix([10.0 * (x > 1) + self.damping]))

    def begin(self, accepted, failure=None):
        return SlackRope(1.0, accepted, self) if failure and failure.loose else self

    def outer(self, x, accepted, found):
        if self is self.given:
            return None
        moves = np.abs(x - self.at) > 1e-3
        return (SlackRope(1.0, x, self.given) if moves else self.given), accepted


class BareRope(SlackRope):
    """The same without the recovery."""

    def begin(self, accepted, failure=None):
        return self


def test_an_own_recovery():
    """[X] Newton's method fails on a slack rope; its own family of easier ones leads to the form as
    given.
    """
    stage = sc.Stage("pull", np.array([3.0]))
    result = sc.Model({"rope": SlackRope()}).run([stage], **QUIET)
    assert abs(result["pull"].x[0] - 1.3) < 1e-8  # linear once it is taut: no trace of the damper
    with pytest.raises(sc.NotConverged):
        sc.Model({"rope": BareRope()}).run([stage], **QUIET)


class Held(sc.Form):
    """A spring without `rebased`, as a user writes it first."""

    def __init__(self, n, dofs, stiffness):
        self.size, self.K = (
            n,
            csr_matrix((np.full(len(dofs), stiffness), (dofs, dofs)), shape=(n, n)),
        )

    def assemble(self, x, state):
        return sc.Response(self.K @ x, lambda: state, lambda: self.K)


def test_reset_of_an_own_form():
    """A form whose force would change when displacements are reset is refused by name."""
    basis = vector_basis(grid("Q1", np.linspace(0, 1, 5), np.linspace(0, 1, 5)), "Q1", intorder=2)
    forms = {
        "body": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0)),
        "spring": Held(basis.N, basis.get_dofs("bottom").all("u^2"), 100.0),
    }
    result = sc.Model(forms, basis.get_dofs().all("u^1")).run(
        [sc.Stage("weight", sc.weight(basis, 20.0))], **QUIET
    )
    with pytest.raises(ValueError, match=r"force of 'spring' changes .* rebased"):
        result.reset()


class Stressed(sc.Form):
    """A force of 100 that grows by 1e-8 with a displacement of one."""

    size = 1

    def assemble(self, x, state):
        return sc.Response(100.0 + 1e-8 * x, lambda: state, lambda: csr_matrix([[1e-8]]))


def test_reset_of_a_force_that_does_not_depend_on_displacements():
    """[X] A change by 1e-10 of the form's own force is none, without a load as well."""
    stage = sc.Stage("move", prescribed=np.array([1.0]))
    result = sc.Model({"stressed": Stressed()}, [0]).run([stage], **QUIET)
    assert result["move"].x == [1.0] and result.reset()["move"].x == [0.0]


def test_stiffness_with_a_factor():
    """[X] A form of one region takes one factor; without any its stiffness is zero."""
    K = np.array([[2.0, -1.0], [-1.0, 3.0]])
    form = sc.MatrixForm(K)
    assert np.array_equal(form.scaled_stiffness({"spring": 2.0}).toarray(), 2.0 * K)
    assert not form.scaled_stiffness({}).toarray().any()
    with pytest.raises(NotImplementedError, match="have one factor"):
        form.scaled_stiffness({"spring": 2.0, "other": 3.0})


class WithoutNumbers(sc.VonMises):
    """A law whose stresses are lost."""

    def update(self, strain_increment, stress, internal):
        found = super().update(strain_increment, stress, internal)
        return found._replace(stress=np.full_like(found.stress, np.nan))


def test_own_law_without_numbers_is_named():
    """The linear solver complained of its right-hand side."""
    basis, solid, load = column(WithoutNumbers(E=1e3, nu=0.0, strength=10.0))
    model = sc.Model({"column": solid}, basis.get_dofs("bottom").all())
    message = r"the forces of \['column'\] are not finite .*check_material"
    with pytest.raises(ValueError, match=message):
        model.run([sc.Stage("pressed", load)], **QUIET)
