"""Forms that change between stages, and runs in parts."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementTriP2,
    ElementVector,
    MeshTri,
)

import skfem_contact as sc
from tests.tools.scenes import disc, pit

QUIET = {"progress": False}


ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


@pytest.mark.slow
def test_run_that_is_split_goes_on_with_what_stages_have_changed():
    """[X] One run as two, the second from the end of the first; searches as those of a model of the
    changed forms.
    """
    model, weak, stages = pit()
    whole = model.run(stages, **QUIET)
    for k in range(1, len(stages)):
        rest = model.run(stages[k:], start=model.run(stages[:k], **QUIET), **QUIET)
        assert np.array_equal(rest[-1].x, whole[-1].x)
    other = sc.Model(weak, whole["held"].supports, water_unit_weight=10.0)
    settings = {"start": whole["held"], "tolerance": 0.05, "certify": False, **QUIET}
    with pytest.warns(sc.AnalysisWarning, match="refine the mesh"):
        found = [every.strength_reduction(**settings) for every in (model, other)]
    assert found[0].factor == pytest.approx(found[1].factor, rel=1e-9)
    load = stages[-1].load
    limits = [every.limit_load(load, start=whole["held"], **QUIET) for every in (model, other)]
    assert limits[0].multiplier == pytest.approx(limits[1].multiplier, rel=1e-9)
    for end in (found[0].end, limits[0].end):
        assert end.water == -3.5 and end.changed["ground"].materials["all"].c == 10.0
        assert np.array_equal(end.supports, whole["held"].supports)
    fresh = other.run([sc.Stage("again", load)], start=model.run(stages[:1], **QUIET), **QUIET)
    assert fresh["again"].forms["ground"].materials["all"].c == 10.0  # another model: its own forms


def test_changed_wall_keeps_its_water_and_skin_its_stiffness():
    """[X] A wall in a slit between two levels that becomes softer, and a skin that resists less,
    move nothing else.
    """
    mesh = MeshTri.init_tensor(np.linspace(-4, 4, 9), np.linspace(-4, 0, 5)).with_boundaries(
        {
            "wall": lambda x: (x[0] == 0.0) & (x[1] > -3.0),
            "low": lambda x: (x[1] == 0.0) & (x[0] < 0.0),
            "high": lambda x: (x[1] == 0.0) & (x[0] > 0.0),
        },
        boundaries_only=False,
    )
    basis = Basis(sc.split_along(mesh, "wall"), ElementVector(ElementTriP2()), intorder=2)
    flow = sc.water.Flow(basis, permeability=1e-4, unit_weight=10.0).steady(
        sc.water.Conditions(head={"low": 0.0, "high": 2.0})
    )
    nodes = np.linspace((-2.0, -0.5), (-3.5, -2.5), 4)
    wall, soft = (sc.Beam(basis, "wall|left", EI=EI, EA=1e6, bonded=False) for EI in (1e5, 1e4))
    pile, slack = (sc.Beam(None, nodes, EI=EI, EA=1e5) for EI in (1e2, 1e1))
    forms = {
        "ground": sc.SolidForm(basis, ELASTIC, unit_weight=20.0),
        "wall": wall,
        "pile": pile,
        "skin": sc.Embedded(basis, pile, T_max=50.0),
        **wall.contact(basis, sc.Coulomb(mu=0.3)),
    }
    model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=10.0)
    start = model.k0_state(K0=0.5, water=0.0)
    change = {"wall": soft, "pile": slack, "skin": sc.Embedded(basis, pile, T_max=40.0)}
    stages = [sc.Stage("flows", water=flow), sc.Stage("soft", change=change)]
    _, flows, softer = model.run(stages, start=start, **QUIET)
    assert np.allclose(softer.x, flows.x, rtol=0.0, atol=1e-9)
    for stage in (flows, softer):
        sides = (stage.contact(name).force[0] for name in ("wall|left", "wall|right"))
        assert abs(sum(sides)) > 20.0  # of the water, which the contact on both sides resists
    assert softer.forms["skin"].T_max[0] == 40.0
    elsewhere = sc.Beam(None, nodes + 0.1, EI=1e2, EA=1e5)
    with pytest.raises(ValueError, match="its nodes, ends or hinges are others"):
        model.run([sc.Stage("moved", change={"pile": elsewhere})], start=start, **QUIET)


def test_new_stiffness_of_structures_moves_nothing():
    """[X] Forces stay where a stiffness is another one; what is loaded later moves by the new one
    alone.
    """
    basis, fixed = disc()
    mesh = basis.mesh.with_boundaries({"grid": lambda x: x[1] == 0.5}, boundaries_only=False)
    basis = Basis(mesh, basis.elem, intorder=4)
    frame = [(0.0, 5.0), (0.0, 6.0), (1.0, 7.0)]

    def forms(share):
        return {
            "beam": sc.Beam(None, frame, EI=share * 1e3, EA=share * 1e5, GA=share * 1e4),
            "bar": sc.Bar(basis, (0.0, 1.0), (0.0, 3.0), EA=share * 1e3, fixed_end=True),
            "grid": sc.Reinforcement(basis, "grid", EA=share * 500.0),
        }

    old, new = forms(1.0), forms(0.1)
    model = sc.Model(
        {"disc": sc.SolidForm(basis, ELASTIC), **old}, [fixed, *old["beam"].dofs((0.0, 5.0))]
    )
    load = [
        model.traction("top", (0.0, -10.0)),
        model.forms["beam"].load((3.0, 1.0), at=(1.0, 7.0)),
    ]
    stages = [
        sc.Stage("old", load),
        sc.Stage("new", load, change=new),
        sc.Stage("more", [2.0 * f for f in load]),
    ]
    one, two, more = model.run(stages, **QUIET)
    assert np.allclose(two.x, one.x, rtol=0.0, atol=1e-12) and two.iterations == (0,)
    for name in ("beam", "grid"):
        forces = (stage.section_forces(name) for stage in (one, two))
        assert np.allclose(*(np.hstack((part.N, part.M)) for part in forces), rtol=0.0, atol=1e-9)
    assert two.states["bar"].force == pytest.approx(one.states["bar"].force, rel=1e-12)
    assert more.states["bar"].force != pytest.approx(2.0 * one.states["bar"].force, rel=0.1)
    tip = model.forms["beam"].numbers((1.0, 7.0))
    assert np.allclose((more.x - two.x)[tip], 10.0 * one.x[tip], rtol=1e-9)


def test_undrained_ground_that_becomes_softer_keeps_its_pressure():
    """[X] Undrained before and after: total and excess stresses stay, nothing moves."""
    mesh = MeshTri.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 1, 3)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    before, after = (
        sc.SolidForm(basis, sc.Undrained(sc.LinearElastic(E=E, nu=0.3), bulk_modulus_water=1e6))
        for E in (1e4, 5e3)
    )
    model = sc.Model({"clay": before}, sc.box_supports(basis))
    load = model.traction("top", (0.0, -100.0))
    stages = [sc.Stage("load", load), sc.Stage("softer", load, change={"clay": after})]
    result = model.run(stages, **QUIET)
    pressures = [stage.pore_pressure("clay") for stage in result]
    assert pressures[0].min() > 95.0
    np.testing.assert_allclose(pressures[1], pressures[0], rtol=1e-9)
    np.testing.assert_allclose(result[1].x, result[0].x, rtol=1e-9, atol=1e-12)
