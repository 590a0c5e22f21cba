"""Steps of linear models: the same as by Newton's method, with one factor and few assemblies."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve
from skfem import (
    Basis,
    ElementHex1,
    ElementQuad1,
    ElementQuad2,
    ElementVector,
    MeshHex,
    MeshQuad,
)

import skfem_contact as sc
from skfem_contact.dynamics.linear import is_linear
from skfem_contact.solvers import direct
from tests.dynamics.cases import QUIET


class Nothing(sc.Form):
    """A form without force, whose tangent may change: models with it are not linear."""

    def __init__(self, n):
        self.size = n
        self._K = csr_matrix((n, n))

    def assemble(self, x, state):
        return sc.Response(np.zeros(self.size), lambda: state, lambda: self._K)


def ground():
    """Return a box of two soils, of which one is damped, and its supports."""
    parts = {"lower": lambda x: x[1] < 2.0, "upper": lambda x: x[1] > 2.0}
    mesh = MeshQuad.init_tensor(np.linspace(0, 8, 9), np.linspace(0, 4, 5)).with_defaults()
    basis = Basis(mesh.with_subdomains(parts), ElementVector(ElementQuad1()), intorder=2)
    soils = {"lower": sc.LinearElastic(E=2e4, nu=0.3), "upper": sc.LinearElastic(E=5e3, nu=0.2)}
    return sc.SolidForm(basis, soils, unit_weight=20.0), basis, sc.box_supports(basis)


@pytest.mark.parametrize("rho_inf", [1.0, 0.6, 0.0])
@pytest.mark.parametrize("mass", ["lumped", "consistent"])
def test_linear_steps_are_the_same(rho_inf, mass):
    """[N] Newton's method with assembly in every step: the same to its tolerance."""
    solid, basis, fixed = ground()
    push = sc.traction(basis, "top", lambda x: (3.0 * (x[0] < 2.0), -5.0 * (x[0] < 2.0)))
    settings = sc.Dynamic(
        0.01,
        rho_inf=rho_inf,
        mass=mass,
        damping={"lower": sc.Rayleigh(0.05, f=(2.0, 9.0))},
        points=[(0.0, 4.0)],
    )

    def moved(t):
        x = basis.zeros()
        x[0::2] = 1e-3 * np.sin(9.0 * t)
        return x

    # more steps than between two renewals, the last ones with supports that move
    stages = [
        sc.Stage("weight"),
        sc.Stage("push", lambda t: push * np.cos(7.0 * t), duration=0.8, dynamic=settings),
        sc.Stage("move", duration=0.1, prescribed=moved, dynamic=settings),
    ]
    found = []
    for more in ({}, {"nothing": Nothing(basis.N)}):
        model = sc.Model(
            {"solid": solid, **more},
            fixed,
            gravity_acceleration=9.81,
            newton=sc.Newton(tolerance=1e-12),
        )
        with pytest.warns(sc.AnalysisWarning, match="it has no load, and the load before"):
            found.append(model.run(stages, **QUIET))
    for stage, other in zip(*found, strict=True):
        np.testing.assert_allclose(stage.x, other.x, atol=1e-9 * np.abs(other.x).max())
        if other.velocity is not None:
            for name in ("velocity", "acceleration", "inertial"):
                values = getattr(other, name)
                size = np.abs(values).max()
                np.testing.assert_allclose(getattr(stage, name), values, atol=1e-8 * size)
            for column in ("kinetic", "elastic", "damping", "work"):
                values = other.energy[column]
                size = np.abs(values).max()
                np.testing.assert_allclose(stage.energy[column], values, atol=1e-8 * size)
        reactions = other.reactions()[fixed]
        np.testing.assert_allclose(
            stage.reactions()[fixed], reactions, atol=1e-8 * np.abs(reactions).max()
        )


def test_dofs_without_mass_have_no_acceleration():
    """[X] Weightless ground on heavy ground: the velocity of its nodes is that of the step."""
    parts = {"lower": lambda x: x[1] < 2.0, "upper": lambda x: x[1] > 2.0}
    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 3), np.linspace(0, 4, 5)).with_defaults()
    basis = Basis(mesh.with_subdomains(parts), ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(
        basis, sc.LinearElastic(E=2e4, nu=0.3), unit_weight={"lower": 20.0, "upper": 0.0}
    )
    model = sc.Model({"solid": solid}, sc.box_supports(basis), gravity_acceleration=9.81)
    push = sc.traction(basis, "top", (0.0, -5.0))
    shaken = [
        sc.Stage(name, push, duration=0.01, dynamic=sc.Dynamic(0.01, mass="lumped"))
        for name in ("first", "second")
    ]
    first, second = model.run(shaken, **QUIET)
    light = basis.get_dofs("top").all("u^2")
    assert not second.acceleration[light].any()
    assert np.abs(second.acceleration).max() > 1.0
    np.testing.assert_allclose(second.velocity[light], (second.x - first.x)[light] / 0.01)


def test_one_factor_and_few_assemblies(monkeypatch):
    """[X] A linear stage factors once and assembles the bodies at its start and its end."""
    solid, _, fixed = ground()
    model = sc.Model({"solid": solid}, fixed, gravity_acceleration=9.81)
    start = model.run([sc.Stage("weight")], **QUIET)
    counts = {"factors": 0, "assemblies": 0}
    factor = direct._Factor.__init__
    assemble = sc.SolidForm.assemble

    def counted_factor(self, *args, **options):
        counts["factors"] += 1
        factor(self, *args, **options)

    def counted_assemble(self, x, state):
        counts["assemblies"] += 1
        return assemble(self, x, state)

    monkeypatch.setattr(direct._Factor, "__init__", counted_factor)
    monkeypatch.setattr(sc.SolidForm, "assemble", counted_assemble)
    stage = sc.Stage("wait", duration=2.0, dynamic=sc.Dynamic(0.01), keep=100)
    result = model.run([stage], start=start, **QUIET)
    assert counts["factors"] == 1
    # at the start, five to try whether the model is linear, and at the end
    assert counts["assemblies"] <= 8
    assert len(result["wait"].increments) == 2
    assert result["wait"].increments[0].states["solid"].stress.shape[0] == 4
    assert counts["assemblies"] <= 9


def test_steps_without_drift():
    """[X] Undamped steps of 1e-6 to 100 periods keep the energy to round-off."""
    solid, basis, fixed = ground()
    solid = sc.SolidForm(basis, sc.LinearElastic(E=2e4, nu=0.3), unit_weight=20.0)
    model = sc.Model({"solid": solid}, fixed, gravity_acceleration=9.81)
    shortest = 1.0 / model.frequencies(3)[0]
    v = basis.zeros()
    v[:] = np.random.default_rng(1).standard_normal(basis.N)
    start = model.run([sc.Stage("weight")], **QUIET)
    for periods, n in ((1e-6, 500), (0.05, 2000), (1.0, 500), (100.0, 500)):
        h = periods * shortest
        stage = sc.Stage("move", duration=n * h, dynamic=sc.Dynamic(h, rho_inf=1.0, velocity=v))
        energy = model.run([stage], start=start, **QUIET)["move"].energy
        assert np.abs(energy["missing"]).max() < 1e-9 * energy["kinetic"][0], periods


def test_memory_is_not_linear():
    """[X] A form with a constant tangent and a memory is told from a linear one."""

    class Creeps(sc.Form):
        size = 2
        changing = np.zeros(0, int)
        symmetric = True

        def initial_state(self, x=None):
            return np.zeros(2)

        def assemble(self, x, state):
            # half of each displacement is forgotten
            K = csr_matrix(3.0 * np.eye(2))
            return sc.Response(3.0 * (x - state), lambda: 0.5 * x, lambda: K)

    form = Creeps()
    assert not is_linear({"form": form}, np.zeros(2), {"form": np.zeros(2)})
    spring = sc.MatrixForm(3.0 * np.eye(2))
    assert is_linear({"form": spring}, np.zeros(2), {"form": spring.initial_state()})
    assert not is_linear({"form": Nothing(2)}, np.zeros(2), {"form": None})


def test_soil_beside_a_spring_is_not_linear():
    """[X] Soil that is elastic near the state may yield elsewhere."""
    basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    soil = sc.SolidForm(basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=1e9, phi=20.0))
    forms = {"soil": soil, "spring": sc.MatrixForm(3.0 * np.eye(basis.N))}
    states = {name: form.initial_state() for name, form in forms.items()}
    assert not is_linear(forms, basis.zeros(), states)
    assert is_linear({"spring": forms["spring"]}, basis.zeros(), states)


def block_in_space():
    """Return a block of hexahedra with its supports and a load."""
    mesh = MeshHex.init_tensor(*(np.linspace(0.0, 1.0, 4),) * 3).with_defaults()
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    load = sc.traction(basis, "right", (0.0, 1.0, -2.0))
    return {"solid": solid}, basis.get_dofs("left").all(), load


def disc():
    """Return a disc of revolution with its supports and a load."""
    mesh = MeshQuad.init_tensor(np.linspace(0.0, 2.0, 5), np.linspace(0.0, 1.0, 4)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    soil = sc.LinearElastic(E=1e4, nu=0.3)
    solid = sc.SolidForm(basis, soil, coordinates="axisymmetric", unit_weight=20.0)
    fixed = [basis.get_dofs("bottom").all(), basis.get_dofs("left").all("u^1")]
    return {"solid": solid}, fixed, sc.traction(solid, "top", (0.0, -3.0))


def block_with_mast():
    """Return a block with a mast inside, whose rotations have no mass."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 1, 3)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    line = [[1.0, 0.0], [1.0, 0.5], [1.0, 1.0]]
    mast = sc.Beam(basis, line, EI=50.0, EA=5e3, unit_weight=2.0, bonded=True)
    fixed = [basis.get_dofs("bottom").all(), *mast.dofs((1.0, 0.0))]
    return {"solid": solid, "mast": mast}, fixed, sc.traction(basis, "left", (3.0, 0.0))


@pytest.mark.parametrize("case", [block_in_space, disc, block_with_mast])
@pytest.mark.parametrize("solver", [None, spsolve])
def test_models_of_all_kinds(case, solver):
    """[N] In space, of revolution and with beams, linear steps are those of Newton's method."""
    forms, fixed, load = case()
    settings = sc.Dynamic(0.01, rho_inf=0.7, damping=sc.Rayleigh(0.02, f=(1.0, 20.0)))
    stages = [sc.Stage("weight"), sc.Stage("push", load, duration=0.7, dynamic=settings)]
    found = []
    for more in (False, True):
        model = sc.Model(forms, fixed, gravity_acceleration=9.81, solver=solver)
        if more:
            both = {**forms, "nothing": Nothing(forms["solid"].basis.N)}
            model = sc.Model(both, fixed, gravity_acceleration=9.81, solver=solver)
        found.append(model.run(stages, **QUIET)["push"])
    one, other = found
    np.testing.assert_allclose(one.x, other.x, atol=1e-7 * np.abs(other.x).max())
    values = other.velocity
    np.testing.assert_allclose(one.velocity, values, atol=1e-6 * np.abs(values).max())
    energy = one.energy
    # the damping of the scheme alone
    assert np.abs(energy["missing"]).max() < 0.2 * np.abs(energy["work"]).max()


def test_nodes_of_solids_and_of_beams_are_recorded():
    """A list of both; without a record, or coordinates without a solid, one sentence says so."""
    solid, basis, fixed = ground()
    mast = sc.Beam(basis, [[4.0, 4.0], [4.0, 5.0], [4.0, 6.0]], EI=1e3, EA=1e5, unit_weight=1.0)
    model = sc.Model(
        {"ground": solid, "mast": mast, "foot": sc.Spring(basis, (4.0, 4.0), 1.0)},
        [fixed, *mast.dofs((4.0, 4.0))],
        gravity_acceleration=10.0,
    )
    top = mast.at((4.0, 6.0))
    push = model.forms["mast"].load((1.0, 0.0), (4.0, 6.0))
    settings = sc.Dynamic(0.01, points=[(0.0, 4.0), top])
    stage = model.run([sc.Stage("push", push, duration=0.1, dynamic=settings)], **QUIET)["push"]
    for node, dofs in (
        ((0.0, 4.0), sc.dofs_at(basis, (0.0, 4.0))[0]),
        (top, model.forms["mast"].numbers((4.0, 6.0))[:2]),
    ):
        history = stage.history(node, "velocity")
        np.testing.assert_array_equal(history.values[-1], stage.velocity[dofs])
    assert abs(stage.history(top).values[-1, 0]) > 1e-4
    with pytest.raises(ValueError, match=r"the motion at \(4, 5\) was not recorded"):
        stage.history(mast.at((4.0, 5.0)))
    alone = sc.Model({"mast": mast}, mast.dofs((4.0, 4.0)), gravity_acceleration=10.0)
    settings = sc.Dynamic(0.01, points=[(4.0, 6.0)])
    with pytest.raises(ValueError, match="there is no solid: give nodes of beams"):
        alone.run([sc.Stage("push", duration=0.1, dynamic=settings)], **QUIET)


@pytest.mark.parametrize("points", [7.0, None, "top", [[np.nan, 0.0]]])
def test_recorded_nodes_that_are_no_points_are_refused(points):
    """A number, a name and coordinates that are not finite."""
    solid, _, fixed = ground()
    model = sc.Model({"ground": solid}, fixed, gravity_acceleration=10.0)
    settings = sc.Dynamic(0.01, points=points)
    with pytest.raises(ValueError, match="coordinates must be finite"):
        model.run([sc.Stage("push", duration=0.1, dynamic=settings)], **QUIET)


class StressAlone(sc.Material):
    """Perfect plasticity whose only memory is the stress."""

    def __init__(self, law):
        self.law = law

    def elasticity(self, ncomp):
        return self.law.elasticity(ncomp)

    def update(self, strain_increment, stress, internal):
        new = self.law.update(strain_increment, stress, self.law.initial_internal(stress))
        return new._replace(internal=internal)


@pytest.mark.parametrize("explicit", [False, True])
def test_laws_without_internal_variables_may_yield(explicit):
    """[N] A bar in mm that waves make yield: the same as with the package's law, which declares a
    memory. Small strains alone look linear.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 100, 11), np.linspace(0, 20, 3)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    steel = sc.VonMises(E=2e5, nu=0.3, strength=250.0)
    found = []
    for law in (steel, StressAlone(steel)):
        bar = sc.SolidForm(basis, law, unit_weight=7.8e-5)
        assert bar.strain == "b_bar"
        fixed = [basis.get_dofs("left").all("u^1"), basis.get_dofs("bottom").all("u^2")]
        model = sc.Model({"bar": bar}, fixed, gravity_acceleration=9810.0)
        settings = sc.Dynamic(explicit=True) if explicit else sc.Dynamic(2e-6)
        stage = sc.Stage(
            "pull", model.traction("right", (230.0, 0.0)), duration=5e-5, dynamic=settings
        )
        found.append(model.run([stage], **QUIET)["pull"].x)
    elastic = 230.0 / 2e5 * 100.0
    assert np.abs(found[0]).max() > 1.05 * elastic
    np.testing.assert_allclose(found[1], found[0], atol=1e-6 * np.abs(found[0]).max())
