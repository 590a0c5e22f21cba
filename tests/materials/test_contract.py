"""Contract of materials: declared memory, initial values, time, stress-dependent elasticity, laws
of a user.
"""

from __future__ import annotations

import ast
import copy
import pickle
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad2,
    ElementTriP2,
    ElementVector,
    MeshQuad,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact import plot
from skfem_contact.materials import Update
from tests.materials.test_laws_in_scenes import LAWS
from tests.tools.helpers import PlainLaw, grid, vector_basis
from tests.tools.material_points import components, principal_stresses, random_strains, rotations

QUIET = {"progress": False}


@dataclass(frozen=True, eq=False)
class CapClay(sc.VonMises):
    """Von Mises' cylinder with a cap on the pressure, which hardens by its preconsolidation
    pressure.
    """

    hardening: float = 2e3
    ocr: float = 1.5
    internal = (
        sc.Internal("plastic strain"),
        sc.Internal("preconsolidation pressure", 10.0, "stress"),
    )

    def initial_internal(self, stress):
        values = super().initial_internal(stress)
        values[1] = np.maximum(-self.ocr * stress[:3].mean(axis=0), values[1])
        return values

    def update(self, strain_increment, stress, internal):
        sheared = super().update(strain_increment, stress, internal[:1])
        bulk = self.lame[0] + 2 / 3 * self.lame[1]
        volume = np.maximum(-sheared.stress[:3].mean(axis=0) - internal[1], 0.0) / (
            bulk + self.hardening
        )
        new = sheared.stress.copy()
        new[:3] += bulk * volume
        memory = np.stack((sheared.internal[0] + volume, internal[1] + self.hardening * volume))
        capped = volume.ravel() > 0
        plastic = np.union1d(sheared.plastic, np.flatnonzero(capped))

        def tangent():
            moduli = np.tile(self.elasticity(len(stress)), (capped.size, 1, 1))
            moduli[sheared.plastic] = sheared.tangent()
            moduli[capped, :3, :3] -= bulk**2 / (bulk + self.hardening)
            return moduli[plastic]

        return Update(new, memory, plastic, tangent)


CLAY = CapClay(E=6e3, nu=0.25, strength=1e3)
BULK, SHEAR = CLAY.E / (3 * (1 - 2 * CLAY.nu)), CLAY.E / (2 * (1 + CLAY.nu))


def column(material, element="Q2", n=3):
    """A column between smooth walls, its supports, and the load of a pressure of one on top."""
    basis = vector_basis(grid(element, [0.0, 1.0], np.linspace(0.0, 1.0, n)), element)
    form = sc.SolidForm(basis, material)
    return (
        {"clay": form},
        sc.box_supports(basis, base="rollers"),
        sc.traction(basis, "top", (0.0, -1.0)),
    )


def consolidated(material=CLAY):
    """The column in a state of K0 under a pressure of 100."""
    forms, fixed, load = column(material)
    return (
        forms,
        fixed,
        load,
        sc.Model(forms, fixed).k0_state(100 * load, unit_weights=0.0, K0=0.5, surcharge=100.0),
    )


def test_memory_follows_from_the_initial_stress():
    """[X] The preconsolidation pressure is 1.5 times the pressure of K0; the settlement bends where
    it is reached.
    """
    forms, fixed, load, start = consolidated()
    state = start["initial"].states["clay"]
    pressure = 100 * (1 + 2 * 0.5) / 3
    np.testing.assert_allclose(
        forms["clay"].variable("preconsolidation pressure", state), 1.5 * pressure
    )
    assert start["initial"].summary["clay"] == "" and start["initial"].residual < 1e-12
    stage = sc.Model(forms, fixed).run(
        [sc.Stage("fill", 250 * load, increments=3)], start=start, **QUIET
    )["fill"]
    elastic = 0.5 * pressure / BULK
    rest = 150 - (BULK + 4 / 3 * SHEAR) * elastic
    strain = elastic + rest / (BULK * CLAY.hardening / (BULK + CLAY.hardening) + 4 / 3 * SHEAR)
    np.testing.assert_allclose(stage.states["clay"].strain[1], -strain, rtol=1e-10)
    assert stage.summary["clay"] == "100.0% yielded"


def test_memory_follows_from_elastic_gravity():
    """[X] `gravity_state` takes K0 and the elasticity of an own law, and fills its memory from the
    stresses.
    """
    forms, fixed, _ = column(CLAY)
    load = sc.weight(forms["clay"].basis, 20.0)
    state = sc.Model(forms, fixed).gravity_state(load, K0=0.5)["initial"].states["clay"]
    np.testing.assert_allclose(state.stress[0], 0.5 * state.stress[1], rtol=1e-8, atol=1e-10)
    pressure = -state.stress[:3].mean(axis=0)
    np.testing.assert_allclose(
        forms["clay"].variable("preconsolidation pressure", state),
        np.maximum(1.5 * pressure, 10.0),
        rtol=1e-8,
    )


def test_memory_is_saved_and_resumed(tmp_path):
    """[X] A resumed analysis ends with the same bits."""
    forms, fixed, load, start = consolidated()
    first = sc.Model(forms, fixed).run([sc.Stage("fill", 200 * load)], start=start, **QUIET)
    first.save(tmp_path / "clay.npz")
    read = sc.load_result(tmp_path / "clay.npz", forms)
    more = [sc.Stage("more", 300 * load)]
    ends = [
        sc.Model(forms, fixed).run(more, start=begun, **QUIET)["more"] for begun in (first, read)
    ]
    for name in ("stress", "internal"):
        np.testing.assert_array_equal(*(getattr(end.states["clay"], name) for end in ends))
    assert (ends[0].states["clay"].internal[1] > first["fill"].states["clay"].internal[1]).all()


@pytest.mark.slow
def test_own_law_is_checked_reduced_and_drawn(tmp_path):
    """[X] A block of shear strength k under the pressure q stands with the factor of safety 2 k /
    q.
    """
    soft = CapClay(E=6e3, nu=0.25, strength=20 * np.sqrt(3), ocr=100.0)
    assert (
        sc.testing.check_material(soft, strain=1e-2) < 1e-6
        and sc.testing.check_material(soft, strain=1e-2, ncomp=6) < 1e-6
    )
    basis = vector_basis(grid("Q2", [0.0, 1.0], [0.0, 1.0]), "Q2")
    forms = {"block": sc.SolidForm(basis, soft)}
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    load = sc.traction(basis, "top", (0.0, -22.0))
    found = sc.Model(forms, fixed).strength_reduction(load, **QUIET)
    assert found.factor == pytest.approx(2 * 20 / 22, rel=0.01)
    stage = sc.Model(forms, fixed).run([sc.Stage("press", load)], **QUIET)["press"]
    for quantity in ("plastic", "mobilised"):
        plot.contour(stage, quantity, file=tmp_path / f"{quantity}.png")
        assert (tmp_path / f"{quantity}.png").stat().st_size > 1000
    mises = 22 * np.sqrt(1 - 0.25 + 0.25**2)  # elastic, in plane strain
    np.testing.assert_allclose(stage.field("mobilised"), mises / soft.strength, rtol=1e-9)


def test_memory_of_a_new_material_starts_from_the_stress():
    """[X] Variables of the same name go on; others start as if the ground had always been of the
    new material.
    """
    forms, fixed, load = column(sc.Tresca(E=6e3, nu=0.25, c=20.0))
    press = sc.Model(forms, fixed).run([sc.Stage("press", 100 * load)], **QUIET)
    old = press["press"].states["clay"]
    change = {"clay": forms["clay"].with_materials({"all": CLAY})}
    stages = [sc.Stage("clay", 100 * load, change=change)]
    new = sc.Model(forms, fixed).run(stages, start=press, **QUIET)["clay"].states["clay"]
    assert old.internal[0].min() > 0
    np.testing.assert_array_equal(new.internal[0], old.internal[0])
    np.testing.assert_allclose(new.internal[1], -1.5 * old.stress[:3].mean(axis=0))


class Maxwell:
    """A fluid that creeps; by the contract's two calls alone."""

    time_dependent = True
    law, time = sc.LinearElastic(E=1e3, nu=0.3), 2.0

    def elasticity(self, ncomp):
        return self.law.elasticity(ncomp)

    def update(self, strain_increment, stress, internal, dt):
        kept = 1 / (1 + dt / self.time)
        new = kept * self.law.update(strain_increment, stress, internal).stress
        points = np.arange(stress[0].size)
        return Update(
            new,
            internal,
            points,
            lambda: np.tile(kept * self.elasticity(len(stress)), (len(points), 1, 1)),
        )


def test_time_is_passed_to_a_law_that_asks_for_it():
    """[X] Relaxation by Euler's backward method in four steps; without duration nothing creeps."""
    forms, fixed, load = column(Maxwell())
    basis = forms["clay"].basis
    top = basis.get_dofs("top").all("u^2")
    x = basis.zeros()
    x[top] = -0.01
    stages = [
        sc.Stage("press", 0 * load, prescribed=x),
        sc.Stage("wait", 0 * load, prescribed=x, duration=3.0, increments=4),
    ]
    result = sc.Model(forms, np.union1d(fixed, top)).run(stages, **QUIET)
    first, last = (stage.states["clay"].stress for stage in result)
    np.testing.assert_allclose(first[1], -0.01 * Maxwell().elasticity(4)[1, 1], rtol=1e-12)
    np.testing.assert_allclose(last, first / (1 + 0.75 / 2) ** 4, rtol=1e-12, atol=1e-15)


class Janbu(sc.Material):
    """Elastic ground whose stiffness grows with the accepted pressure; one variable counts for
    nothing.
    """

    stress_dependent = True
    law = sc.LinearElastic(E=1e3, nu=0.25)

    def elasticity(self, ncomp, stress=None, internal=None):
        D = self.law.elasticity(ncomp)
        return D if stress is None else (1 - stress[:3].mean(axis=0) / 50)[..., None, None] * D

    def update(self, strain_increment, stress, internal):
        D = self.elasticity(len(stress), stress, internal)
        new = stress + np.einsum("...ab,b...->a...", D, strain_increment)
        return Update(
            new, internal, np.zeros(0, int), lambda: np.zeros((0, len(stress), len(stress)))
        )


@pytest.mark.parametrize("material", [Janbu(), sc.Undrained(Janbu(), nu_undrained=0.49)])
def test_stiffness_is_that_of_the_stress(material):
    """[X] The law is linear in an increment: the tangent is exact, one iteration ends it; so does
    pore water.
    """
    assert sc.testing.check_material(material) < 1e-6
    forms, fixed, load, start = consolidated(material)
    form, state = forms["clay"], start["initial"].states["clay"]
    x = 1e-3 * np.random.default_rng(0).standard_normal(form.size)
    out, rest = form.assemble(x, state), form.assemble(0 * x, state)
    np.testing.assert_allclose(out.force - rest.force, out.stiffness @ x, rtol=1e-9, atol=1e-12)
    assert (
        abs(out.damped - out.stiffness).max() < 1e-9
        and abs(out.stiffness - form.elastic_stiffness).max() > 100
    )
    stage = sc.Model(forms, fixed).run([sc.Stage("fill", 150 * load)], start=start, **QUIET)["fill"]
    assert stage.iterations == (1,)
    drained = (1 + 200 / 3 / 50) * Janbu.law.elasticity(4)
    if material.undrained:  # Poisson's ratio of soil and water is that at every stress
        shear, nu = drained[3, 3], 0.49
        np.testing.assert_allclose(
            -50 / stage.states["clay"].strain[1], 2 * shear * (1 - nu) / (1 - 2 * nu), rtol=1e-9
        )
    else:
        np.testing.assert_allclose(-50 / stage.states["clay"].strain[1], drained[1, 1], rtol=1e-9)


class Forgetful(sc.LinearElastic):
    """Returns a variable that it has not declared."""

    def update(self, strain_increment, stress, internal):
        return (
            super()
            .update(strain_increment, stress, internal)
            ._replace(internal=np.zeros((1, *stress.shape[1:])))
        )


class Misshapen(Forgetful):
    """... and one of another shape than it declares."""

    internal = (sc.Internal("void ratio", 0.8),)

    def update(self, strain_increment, stress, internal):
        return super().update(strain_increment, stress, internal)._replace(internal=internal[0])


@pytest.mark.parametrize(
    ("law", "found"),
    [
        (
            Forgetful(E=1e3, nu=0.3),
            r"material of 'soft', Forgetful: update returns .* shape \(1, .*0 declared \(none\)",
        ),
        (
            Misshapen(E=1e3, nu=0.3),
            r"material of 'soft', Misshapen: update returns .*1 declared \(void ratio\)",
        ),
        (sc.Material(), r"material of 'soft': .* is no material: elasticity and update missing"),
        (sc.LinearElastic, r"material of 'soft': .* is no material"),
        (None, r"material of 'soft': None is no material"),
    ],
)
def test_bad_materials(law, found):
    """One ValueError that names region, law and what is wrong."""
    mesh = grid("Q2", [0.0, 1.0, 2.0], [0.0, 1.0]).with_subdomains({"soft": [0], "stiff": [1]})
    with pytest.raises(ValueError, match=found):
        sc.SolidForm(vector_basis(mesh, "Q2"), {"stiff": CLAY, "soft": law})


def test_law_that_does_not_derive_from_material(tmp_path):
    """[X] It computes the same; figures that it does not define are NaN or nothing, and can be
    drawn all the same.
    """
    known = sc.Tresca(E=1e3, nu=0.3, c=10.0)
    stages = []
    for law in (known, PlainLaw(known)):
        forms, fixed, load = column(law)
        stages.append(sc.Model(forms, fixed).run([sc.Stage("press", 50 * load)], **QUIET)["press"])
    one, other = (stage.states["clay"].stress for stage in stages)
    np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12)
    assert stages[0].summary["clay"] == "100.0% yielded" and stages[1].summary["clay"] == ""
    assert np.isnan(stages[1].field("mobilised")).all()
    assert not forms["clay"].strengths
    assert pickle.loads(pickle.dumps(copy.deepcopy(forms["clay"].materials["all"]))).n_internal == 1
    with pytest.raises(ValueError, match="PlainLaw has no strength to reduce"):
        forms["clay"].materials["all"].reduced(2.0)
    with pytest.raises(ValueError, match="no bounds for PlainLaw"):
        sc.Model(forms, fixed).bounds(weight=load)
    with pytest.raises(ValueError, match="no material of these bodies defines this field"):
        plot.contour(stages[1], "mobilised", file=tmp_path / "none.png")
    mesh = grid("Q2", [0.0, 1.0, 2.0], [0.0, 1.0]).with_subdomains({"plain": [0], "known": [1]})
    basis = vector_basis(mesh, "Q2")
    forms = {"both": sc.SolidForm(basis, {"plain": PlainLaw(known), "known": known})}
    load = sc.traction(basis, "top", (0.0, -15.0))
    stage = sc.Model(forms, sc.box_supports(basis, base="rollers")).run(
        [sc.Stage("press", load)], **QUIET
    )["press"]
    assert 0 < np.isnan(stage.field("mobilised")).mean() < 1
    plot.contour(stage, "mobilised", points=True, file=tmp_path / "half.png")
    assert len(stage.to_frame())


@pytest.mark.slow
def test_materials_are_asked():
    """Only `as_material` looks at the attributes or the class of a material; all others ask it."""
    kinds, names = (
        set(sc.materials.__all__) - {"Internal", "Update"},
        {"material", "law", "soil", "m"},
    )
    wrong = []
    for path in Path(sc.__file__).parent.rglob("*.py"):
        room = path.relative_to(Path(sc.__file__).parent).parts[0]
        if path.name == "base.py" and room == "materials":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and len(node.args) > 1
            ):
                asked = {n.id for n in ast.walk(node.args[0]) if isinstance(n, ast.Name)} | {
                    n.attr for n in ast.walk(node.args[0]) if isinstance(n, ast.Attribute)
                }
                classes = {n.id for n in ast.walk(node.args[1]) if isinstance(n, ast.Name)}
                if (
                    node.func.id in ("hasattr", "getattr") and asked & names and room != "contact"
                ) or (node.func.id == "isinstance" and classes & kinds):
                    wrong.append(f"{path.name}:{node.lineno}")
    assert not wrong


class Remembers(sc.LinearElastic):
    """An elastic law that remembers the largest strain."""

    internal = (sc.Internal("largest strain"),)

    def update(self, strain_increment, stress, internal):
        new = super().update(strain_increment, stress, internal[:0])
        return new._replace(internal=internal + np.abs(strain_increment[1:2]))


def test_figures_of_own_laws():
    """A law that does not define its strength shows none, and an elastic law with memory has no
    point that yields.
    """
    basis = Basis(MeshTri().refined(2).with_defaults(), ElementVector(ElementTriP2()), intorder=2)
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    for law, push in (
        (PlainLaw(sc.Tresca(E=1e3, nu=0.3, c=10.0)), -19.9),
        (Remembers(E=1e3, nu=0.3), -1.0),
    ):
        model = sc.Model({"body": sc.SolidForm(basis, law)}, fixed)
        stage = model.run([sc.Stage("press", model.traction("top", (0.0, push)))], **QUIET)["press"]
        assert "yielded" not in stage.summary["body"]
        mobilised = stage.field("mobilised") if isinstance(law, Remembers) else np.zeros(1)
        assert not mobilised.any()  # an elastic body mobilises nothing
        if isinstance(law, PlainLaw):
            assert not np.isfinite(stage.field("mobilised")).any()


class Own:
    """Linear elasticity by the documented calls alone."""

    law = sc.LinearElastic(E=1e4, nu=0.3)

    def elasticity(self, ncomp):
        return self.law.elasticity(ncomp)

    def update(self, strain_increment, stress, internal):
        return self.law.update(strain_increment, stress, internal)


def test_gravity_with_an_own_material():
    """[X] Elastic ground with Poisson's ratio K0 / (1 + K0) has this ratio of stresses, whoever
    wrote the law.
    """
    basis = Basis(MeshQuad().refined(1), ElementVector(ElementQuad2()), intorder=4)
    model = sc.Model(
        {"ground": sc.SolidForm(basis, Own(), unit_weight=20.0)}, sc.box_supports(basis)
    )
    stress = model.gravity_state(K0=0.5)["initial"].states["ground"].stress
    np.testing.assert_allclose((stress[0] / stress[1]).mean(), 0.5, rtol=1e-6)


ISOTROPIC = {name: law for name, law in LAWS.items() if name != "NgiAdp"} | {
    "Tresca": sc.Tresca(2e4, 0.3, c=40.0),
    "VonMises": sc.VonMises(2e4, 0.3, strength=60.0),
    "DruckerPrager": sc.DruckerPrager(2e4, 0.3, k=5.0, alpha=0.2, beta=0.1),
    "no tension": sc.MohrCoulomb(2e4, 0.3, c=5.0, phi=30.0, psi=5.0, tension=0.0),
    "HardeningMohrCoulomb": sc.HardeningMohrCoulomb(
        2e4, 0.3, c=20.0, c_end=5.0, phi=30.0, phi_end=25.0, strain_end=0.01
    ),
}


@pytest.mark.parametrize("name", ISOTROPIC)
@pytest.mark.one_in(2)
def test_laws_do_not_depend_on_the_axes(name: str) -> None:
    """[X] Two increments along turned axes, which differ, give the same principal stresses and
    memory as along the first axes.
    """
    law, n = ISOTROPIC[name], 40
    rng = np.random.default_rng(5)
    strains = [random_strains(n, rng, size=1e-3) for _ in range(2)]
    tilts = [rotations(n, 6, rng) for _ in range(2)]
    duration = {"dt": 1.0} if law.time_dependent else {}
    found = []
    for turn in (np.broadcast_to(np.eye(3), (n, 3, 3)), rotations(n, 6, rng)):
        stress = np.zeros((6, n))
        stress[:3] = -100.0
        memory = law.initial_internal(stress)
        for strain, tilt in zip(strains, tilts):
            increment = components(strain, turn @ tilt, 6, shear=2.0)
            update = law.update(increment, stress, memory, **duration)
            stress, memory = update.stress, update.internal
        found.append((principal_stresses(stress), memory[:3]))  # a tensor follows
    (stress, memory), (turned, same) = found
    # iterations of the laws end at 1e-9 of the stresses or better
    np.testing.assert_allclose(turned, stress, rtol=1e-7, atol=1e-6)
    np.testing.assert_allclose(same, memory, rtol=1e-7, atol=1e-9)
