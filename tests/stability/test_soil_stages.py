"""Soil through many stages under bad conditions: contrasts, units, reversals, large steps, turned
axes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import skfem_contact as sc
import skfem_contact.stages.run as running
from tests.tools.helpers import grid, rotation, vector_basis

QUIET = {"progress": False}
#: Fewer iterations than by default: stages that fail try many increments.
QUICK = sc.Newton(max_iterations=10)


def pit(
    scale: float = 1.0,
    stiff: float = 1.0,
    force: float = 1.0,
    soil: dict | None = None,
    degrees: float = 0.0,
):
    """Ground of two layers, the upper one with a pit that is dug and filled; units of length and
    force to choose.
    """
    tags = {
        "low": lambda x: x[1] < 3,
        "high": lambda x: (x[1] > 3) & (x[0] > 2),
        "pit": lambda x: (x[1] > 3) & (x[0] < 2),
    }
    mesh = grid("Q1", np.linspace(0, 6, 13), np.linspace(0, 5, 11)).with_subdomains(tags)
    turned = rotation(degrees)
    mesh = replace(mesh, doflocs=scale * (turned @ mesh.doflocs))
    basis = vector_basis(mesh, "Q1", intorder=2)
    stress = force / scale**2
    given = {
        "E": 2e4 / min(stiff, 1.0) * stress,
        "nu": 0.3,
        "c": 10.0 * stress,
        "phi": 25.0,
        **(soil or {}),
    }
    weak = sc.MohrCoulomb(**given)
    base = sc.MohrCoulomb(**{**given, "E": given["E"] * stiff})
    forms = {
        "low": sc.SolidForm(basis.with_elements("low"), base, "b_bar"),
        "high": sc.SolidForm(basis.with_elements("high"), weak, "b_bar"),
        "pit": sc.SolidForm(basis.with_elements("pit"), weak, "b_bar"),
    }
    fixed = np.concatenate([basis.get_dofs(side).all() for side in ("bottom", "left", "right")])
    down = tuple(turned @ [0.0, -1.0])
    gamma = 20.0 * force / scale**3
    loads = [
        sc.weight(basis, dict.fromkeys(names, gamma), down)
        for names in (("low", "high"), tuple(tags))
    ]
    return basis, forms, fixed, loads


def dig(loads, increments: int = 4, cycles: int = 1):
    """Gravity, then digging and filling, as often as wanted."""
    without, whole = loads
    stages = [sc.Stage("gravity", whole)]
    for k in range(cycles):
        stages.append(sc.Stage(f"dug {k}", without, deactivate="pit", increments=increments))
        stages.append(sc.Stage(f"filled {k}", whole, activate="pit", increments=increments))
    return stages


def out_of_balance(forms, stage, fixed) -> float:
    """Residual of a stage, computed anew from its states, over the load."""
    force = sum(forms[name].assemble(stage.x, state).force for name, state in stage.states.items())
    carried = np.unique(
        np.concatenate([forms[name].basis.element_dofs.ravel() for name in stage.states])
    )
    free = np.setdiff1d(carried, fixed)
    return float(np.linalg.norm((force - stage.load)[free]) / np.linalg.norm(stage.load))


def worst_yield(form, state) -> float:
    """Largest excess over the yield surface, in units of the largest stress."""
    again = form.regions[0].material.update(
        np.zeros_like(state.stress), state.stress, state.internal
    )
    return float(np.abs(again.stress - state.stress).max() / np.abs(state.stress).max())


def assert_equilibria(forms, result, fixed) -> None:
    """Forces that balance and admissible stresses in all stages, and no displacement of a
    runaway.
    """
    for stage in result:
        # settlement of elastic columns: no stage moves the ground by much more
        column = 100.0 * 25.0 / min(form.materials["all"].E for form in forms.values())
        assert np.abs(stage.x).max() < 2 * column
        assert (
            out_of_balance(forms, stage, fixed) < 1e-7
        )  # Newton's 1e-8 are of the largest force, mostly the load
        for name, state in stage.states.items():
            assert worst_yield(forms[name], state) < 1e-9


@pytest.mark.parametrize("stiff", [1e-4, 1.0, 1e4])
@pytest.mark.parametrize(
    "soil",
    [
        {"psi": 25.0},
        {"nu": 0.499, "psi": 25.0},
        {"phi": 0.0, "c": 40.0},
        {"phi": 50.0, "c": 5.0, "psi": 50.0},
    ],
)
@pytest.mark.one_in(3)
def test_contrasts_and_parameters(stiff, soil):
    """[X] Cases S4, S5: moduli of the layers 1e4 apart either way.

    The ground at rest is admissible and the pit not as deep as it could be, so with associated flow
    equilibrium exists whatever the stiffness (safe theorem): it must be found.
    """
    _, forms, fixed, loads = pit(stiff=stiff, soil=soil)
    assert_equilibria(forms, sc.Model(forms, fixed).run(dig(loads), **QUIET), fixed)


@pytest.mark.parametrize("stiff", [1.0, 1e4])
@pytest.mark.parametrize("soil", [{}, {"nu": 0.499}, {"phi": 50.0, "c": 5.0}])
def test_contrasts_without_dilatancy(stiff, soil):
    """[X] Cases S4, S5: the same with psi = 0."""
    _, forms, fixed, loads = pit(stiff=stiff, soil=soil)
    assert_equilibria(forms, sc.Model(forms, fixed).run(dig(loads), **QUIET), fixed)


@pytest.mark.slow
@pytest.mark.parametrize("soil", [{"nu": 0.499}, {"phi": 50.0, "c": 5.0}])
def test_crust_without_dilatancy_on_soft_ground(soil):
    """[X] Case S5: a crust 1e4 times stiffer than what it lies on yields all over before that
    carries anything.

    Without dilatancy no theorem grants an equilibrium.  What counts is that no other answer passes
    for one: what is not found is warned of, and what was reached before is in balance.
    """
    _, forms, fixed, loads = pit(stiff=1e-4, soil=soil)
    try:
        result = sc.Model(forms, fixed, newton=QUICK).run(dig(loads), **QUIET)
    except sc.NotConverged as error:
        assert "of its load" in str(error)
        result = error.result
    assert_equilibria(forms, result, fixed)


def test_stage_that_fails_at_once_is_in_balance(monkeypatch) -> None:
    """[X] Where a pit is dug and no increment is found, the load holds the forces of the removed
    soil; a run that begins there ends as one that was not interrupted.
    """
    _, forms, fixed, loads = pit()
    model = sc.Model(forms, fixed)
    gravity, dug, _ = dig(loads)
    whole = model.run([gravity, dug], **QUIET)

    def fail(*args):
        raise sc.NotConverged("no increment is tried")

    with monkeypatch.context() as patch:
        patch.setattr(running, "solve_step", fail)
        with pytest.raises(sc.NotConverged, match="no increment is tried") as info:
            model.run([dug], start=whole["gravity"], **QUIET)
    stopped = info.value.result
    assert stopped["dug 0"].fraction == 0.0
    assert_equilibria(forms, stopped, fixed)
    with pytest.warns(sc.AnalysisWarning, match="the start ends at 0% of its stage 'dug 0'"):
        again = model.run([sc.Stage("again", loads[0], increments=4)], start=stopped, **QUIET)
    # Newton's tolerance of 1e-8, of settlements of .1
    np.testing.assert_allclose(again["again"].x, whole["dug 0"].x, atol=1e-9)


def test_runaway_is_no_equilibrium():
    """[X] Soil that yields everywhere, sheared by 1e12: the round-off of such displacements does
    not hide the load.
    """
    basis, forms, fixed, loads = pit()
    model = sc.Model(forms, fixed)
    system = model.checked_system(model.forms, model.fixed)
    states = {name: form.initial_state() for name, form in forms.items()}
    x = basis.zeros()
    x[0::2] = 1e12 * basis.doflocs[1, 0::2]
    assert (
        system.evaluate(x, states, loads[1]).norm > 0.9
    )  # uniform stress: the weight is not carried at all


@pytest.mark.parametrize("strength", [1e-3, 1e3])
def test_contrast_of_cohesion(strength):
    """[X] A layer with 1e-3 or 1e3 times the cohesion of the other."""
    _, forms, fixed, loads = pit(soil={"psi": 25.0})
    weak = forms["low"].materials["all"]
    forms["low"] = forms["low"].with_materials({"all": replace(weak, c=strength * weak.c)})
    assert_equilibria(forms, sc.Model(forms, fixed).run(dig(loads), **QUIET), fixed)


@pytest.mark.parametrize("scale", [1e-6, 1e3, 1e6])
@pytest.mark.parametrize("force", [1e-6, 1e6])
@pytest.mark.one_in(2)
def test_units(scale, force):
    """[X] Units of length and force change numbers, not answers."""
    reference = None
    for unit, newton in ((1.0, 1.0), (scale, force)):
        _, forms, fixed, loads = pit(unit, force=newton)
        result = sc.Model(forms, fixed).run(dig(loads), **QUIET)
        x = np.array([stage.x / unit for stage in result])
        assert [len(stage.iterations) for stage in result] == [1, 4, 4]
        reference = x if reference is None else reference
    np.testing.assert_allclose(
        x, reference, atol=1e-7 * np.abs(reference).max()
    )  # Newton's tolerance of 1e-8


def test_turned_axes():
    """[X] At 37 degrees: the same displacements, turned."""
    moved = []
    for degrees in (0.0, 37.0):
        _, forms, fixed, loads = pit(degrees=degrees)
        result = sc.Model(forms, fixed).run(dig(loads), **QUIET)
        moved.append(result[-1].x.reshape(-1, 2) @ rotation(degrees))
    np.testing.assert_allclose(moved[1], moved[0], atol=1e-7 * np.abs(moved[0]).max())


def test_digging_and_filling_again_and_again():
    """[X] In elastic ground cycles leave nothing behind; in soil that yields every cycle ends in
    equilibrium.
    """
    _, forms, fixed, loads = pit()
    elastic = {
        name: sc.SolidForm(form.basis, sc.LinearElastic(E=2e4, nu=0.3))
        for name, form in forms.items()
    }
    result = sc.Model(elastic, fixed).run(dig(loads, 1, 5), **QUIET)
    ground = np.unique(elastic["low"].basis.element_dofs)
    for k in range(1, 5):
        np.testing.assert_allclose(
            result[f"dug {k}"].x[ground], result["dug 0"].x[ground], atol=1e-12
        )
    soil = sc.Model(forms, fixed).run(dig(loads, 2, 4), **QUIET)
    assert max(out_of_balance(forms, stage, fixed) for stage in soil) < 1e-7


@pytest.mark.parametrize("increments", [1, 3, 50])
@pytest.mark.one_in(3)
def test_sizes_of_steps(increments):
    """[X] One step or fifty: the same pit within what the path may change."""
    _, forms, fixed, loads = pit()
    one, many = (
        sc.Model(forms, fixed).run(dig(loads, n), **QUIET)["dug 0"].x for n in (4, increments)
    )
    np.testing.assert_allclose(many, one, atol=0.02 * np.abs(one).max())


def test_pit_that_cannot_stand():
    """[X] Without strength the side of the pit fails while it is dug: an error with the share that
    was reached.
    """
    _, forms, fixed, loads = pit(soil={"c": 2.0, "phi": 10.0})
    with pytest.raises(
        sc.NotConverged, match=r"stage 'dug 0' stopped at \d+\.\d+% of its load"
    ) as error:
        sc.Model(forms, fixed, newton=QUICK).run(dig(loads), **QUIET)
    partial = error.value.result
    last = partial["dug 0"]
    assert 0.0 < last.fraction < 1.0 and "pit" not in last.states
    assert (
        out_of_balance(forms, last, fixed) < 1e-7
    )  # the load of a partial stage holds what is not released yet
    assert np.isfinite(last.x).all()


def test_slivers():
    """[X] A layer a hundred times thinner than wide is dug through: equilibrium."""
    heights = np.concatenate((np.linspace(0, 3, 7), [3.005], np.linspace(3.5, 5, 4)))
    tags = {
        "low": lambda x: x[1] < 3,
        "thin": lambda x: (x[1] > 3) & (x[1] < 3.005),
        "high": lambda x: x[1] > 3.005,
    }
    mesh = grid("Q1", np.linspace(0, 6, 13), heights).with_subdomains(tags)
    basis = vector_basis(mesh, "Q1", intorder=2)
    soil = sc.MohrCoulomb(E=2e4, nu=0.3, c=10.0, phi=25.0)
    forms = {name: sc.SolidForm(basis.with_elements(name), soil, "b_bar") for name in tags}
    fixed = np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    loads = [
        sc.weight(basis, dict.fromkeys(names, 20.0)) for names in (tags, ("low", "thin"), ("low",))
    ]
    stages = [
        sc.Stage("all", loads[0]),
        sc.Stage("1", loads[1], deactivate="high"),
        sc.Stage("2", loads[2], deactivate="thin"),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    assert max(out_of_balance(forms, stage, fixed) for stage in result) < 1e-7
