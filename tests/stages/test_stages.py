"""Stages: increments, their cutting, partial results, resuming, and what a user is warned of."""

from __future__ import annotations

import logging
import re
import warnings

import numpy as np
import pytest
from scipy.sparse import identity
from skfem import FacetBasis, LinearForm

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from tests.tools.helpers import Springs, dofs_at, grid, unknowns_of, vector_basis

QUIET = {"progress": False}
#: Fewer iterations than by default: stages that fail try many increments.
QUICK = sc.Newton(max_iterations=10)


def column(material=None, element: str = "Q1"):
    """A column between smooth walls, 1 x 2, and its fixed unknowns."""
    basis = vector_basis(grid(element, np.linspace(0, 1, 3), np.linspace(0, 2, 5)), element)
    form = sc.SolidForm(basis, material or sc.LinearElastic(E=1e3, nu=0.25))
    fixed = np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    return basis, {"column": form}, fixed


def pressed(basis, force: float) -> np.ndarray:
    """Load of a pressure on the top."""
    return LinearForm(lambda v, w: -force * v[1]).assemble(
        FacetBasis(basis.mesh, basis.elem, facets="top")
    )


def brace(strength: float = 10.0):
    """A soil sample between rough plates: the upper one is free to sink, so that a load may be too
    large.
    """
    basis = vector_basis(grid("Q1", np.linspace(0, 1, 5), np.linspace(0, 1, 5)), "Q1", intorder=2)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=strength, phi=0.0)
    return basis, {"soil": sc.SolidForm(basis, soil, "b_bar")}, basis.get_dofs("bottom").all()


def friction_blocks(quadrature=2, mu: float = 0.3):
    """A block on a base, held by contact alone."""
    mesh = sc.join_bodies(
        {
            "base": grid("Q1", np.linspace(-0.5, 1.5, 9), np.linspace(-0.5, 0, 3)),
            "block": grid("Q1", np.linspace(0, 1, 6), np.linspace(0, 0.5, 4)),
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    materials = {
        "base": sc.MohrCoulomb(E=1e4, nu=0.3, c=12.0, phi=20.0),
        "block": sc.LinearElastic(E=1e4, nu=0.2),
    }
    forms = {
        "solid": sc.SolidForm(basis, materials, "b_bar"),
        "joint": sc.ContactPair(
            basis, "block:bottom", "base:top", sc.Coulomb(mu), quadrature, penalty=1e6
        ),
    }
    top = LinearForm(lambda v, w: -20.0 * v[1]).assemble(
        FacetBasis(mesh, basis.elem, facets="block:top")
    )
    side = LinearForm(lambda v, w: 1.0 * v[0]).assemble(
        FacetBasis(mesh, basis.elem, facets="block:left")
    )
    return basis, forms, basis.get_dofs("base:bottom").all(), top, side


def test_gravity_column():
    """[X] Case K1: settlement gamma H^2 / 2M, stresses gamma z and nu / (1 - nu) of it, with
    quadratic elements.
    """
    basis, forms, fixed = column(element="Q2")
    modulus = 1e3 * 0.75 / (1.25 * 0.5)
    result = sc.Model(forms, fixed).run([sc.Stage("gravity", sc.weight(basis, 20.0))], **QUIET)[
        "gravity"
    ]
    np.testing.assert_allclose(
        result.x[basis.get_dofs("top").all("u^2")], -20 * 4 / (2 * modulus), rtol=1e-10
    )
    depth = 2 - np.asarray(basis.global_coordinates())[1]
    stress = result.states["column"].stress
    np.testing.assert_allclose(stress[1], -20 * depth, atol=1e-9)
    np.testing.assert_allclose(stress[0], -20 * depth / 3, atol=1e-9)
    np.testing.assert_allclose(stress[2], -20 * depth / 3, atol=1e-9)
    assert result.fraction == 1.0 and result.iterations == (1,)
    np.testing.assert_array_equal(result.load, sc.weight(basis, 20.0))


@pytest.mark.parametrize("increments", [1, 2, 7, 16])
def test_linear_problem_takes_one_iteration(increments, rng):
    """[X] Loads and prescribed displacements of all sizes; the path does not matter, more
    increments are free.
    """
    basis, forms, _ = column()
    fixed = basis.get_dofs({"top", "bottom"}).all()
    places = [rng.standard_normal(basis.N) * 10.0 ** rng.integers(-6, 0, basis.N) for _ in range(3)]
    loads = rng.standard_normal((3, basis.N))
    stages = [
        sc.Stage(f"{k}", load, place, increments)
        for k, (load, place) in enumerate(zip(loads, places, strict=True))
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    K = forms["column"].elastic_stiffness
    free = np.setdiff1d(np.arange(basis.N), fixed)
    for stage, load, place in zip(result, loads, places, strict=True):
        assert stage.iterations == (1,) + (0,) * (increments - 1)
        # sums of increments: the round-off of the largest
        np.testing.assert_allclose(stage.x[fixed], place[fixed], atol=1e-15 * np.abs(places).max())
        assert np.abs((K @ stage.x - load)[free]).max() < 1e-9 * abs(K @ stage.x).max()


def test_prescribed_displacements_stay_where_they_are():
    """[X] A stage without any keeps those of the stage before; a stage with some moves from
    there.
    """
    basis, forms, fixed = column()
    top = basis.get_dofs("top").all("u^2")
    fixed = np.concatenate((fixed, top))
    down = basis.zeros()
    down[top] = -0.01
    stages = [
        sc.Stage("down", basis.zeros(), down),
        sc.Stage("load", sc.weight(basis, 5.0)),
        sc.Stage("up", sc.weight(basis, 5.0), basis.zeros(), 3),
    ]
    result = sc.Model(forms, fixed).run(stages, **QUIET)
    np.testing.assert_array_equal(result["down"].x[top], -0.01)
    np.testing.assert_array_equal(result["load"].x[top], -0.01)
    np.testing.assert_array_equal(result["up"].x[top], 0.0)


def test_values_at_free_unknowns_do_not_count(rng):
    """[X] Of a prescribed field the fixed unknowns alone are read."""
    basis, forms, fixed = column()
    field = rng.standard_normal(basis.N)
    field[fixed] = 0.0
    load = pressed(basis, 3.0)
    a, b = (
        sc.Model(forms, fixed).run([sc.Stage("s", load, p)], **QUIET)["s"].x for p in (None, field)
    )
    np.testing.assert_array_equal(a, b)


def test_one_step_equals_many_where_the_path_does_not_matter():
    """[X] Case S9: frictionless contact that closes on the way, 1, 3 and 40 increments."""
    results = []
    for increments in (1, 3, 40):
        basis, forms, fixed, top, _ = friction_blocks(mu=0.0)
        forms["solid"] = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))
        hold = basis.get_dofs("block:left").all("u^1")
        stages = [sc.Stage("load", top, None, increments)]
        results.append(
            sc.Model(forms, np.concatenate((fixed, hold)), newton=sc.Newton(1e-11)).run(
                stages, **QUIET
            )[0]
        )
        assert len(results[-1].iterations) == increments
    for other in results[1:]:
        np.testing.assert_allclose(other.x, results[0].x, atol=1e-9 * np.abs(results[0].x).max())
        np.testing.assert_allclose(
            other.states["joint"].traction[0], results[0].states["joint"].traction[0], atol=1e-7
        )


def test_increments_are_cut_and_grow_again(caplog):
    """[X] A stage that fails in one step is cut, the cuts are logged, and all of the load is
    reached.
    """
    _, forms, fixed, top, side = friction_blocks()
    load = top + 10.0 * side
    with caplog.at_level(logging.INFO, "skfem_contact"):
        few = sc.Newton(tolerance=1e-8, max_iterations=1)
        result = sc.Model(forms, fixed, newton=few).run(
            [sc.Stage("top", top), sc.Stage("push", load)], **QUIET
        )
    assert "cut to" in caplog.text
    assert result["push"].fraction == 1.0 and len(result["push"].iterations) > 1
    # two searches, each with up to four iterations where the active set is new
    assert max(result["push"].iterations) <= 2 * 4
    whole = sc.Model(forms, fixed).run([sc.Stage("top", top), sc.Stage("push", load)], **QUIET)
    # the path through the increments differs a little in friction and yielding
    np.testing.assert_allclose(
        result["push"].x, whole["push"].x, atol=0.02 * np.abs(whole["push"].x).max()
    )


@pytest.mark.slow
def test_failure_tells_how_far_where_and_why():
    """[X] A load beyond the strength: the error carries the last equilibrium, which is intact."""
    basis, forms, fixed = brace(strength=10.0)
    load = pressed(basis, 40.0)  # a sample of this strength bears some 20 to 30
    model = sc.Model(forms, fixed, newton=QUICK)
    with pytest.raises(sc.NotConverged) as error:
        model.run([sc.Stage("first", 0.25 * load), sc.Stage("second", load)], **QUIET)
    message = str(error.value)
    partial = error.value.result
    assert [s.name for s in partial] == ["first", "second"]
    last = partial["second"]
    assert 0.0 < last.fraction < 1.0
    assert f"stage 'second' stopped at {last.fraction:.2%} of its load" in message
    assert "iterations" in message or "singular" in message
    x, y = (
        float(v)
        for v in re.search(r", at \((\S+), (\S+)\)\. Accepted last: .*yielded", message).groups()
    )
    assert 0 <= x <= 1 and 0 <= y <= 1
    # between the strength of uniaxial compression and what rough plates add
    reached = 10 + 30 * last.fraction
    assert 20 <= reached < 30
    np.testing.assert_allclose(
        last.load, (0.25 + 0.75 * last.fraction) * load, rtol=1e-12, atol=1e-15
    )
    again = forms["soil"].assemble(last.x, last.states["soil"])
    residual = np.delete(again.force - last.load, fixed)
    assert np.linalg.norm(residual) < 1e-7 * np.linalg.norm(last.load)
    np.testing.assert_allclose(again.state.stress, last.states["soil"].stress, atol=1e-9)
    # and the analysis can go on from there with what it bears
    unload = sc.Model(forms, fixed).run([sc.Stage("unload", 0.0 * load)], start=partial, **QUIET)
    assert [s.name for s in unload] == ["first", "second", "unload"] and unload[
        "unload"
    ].fraction == 1.0


@pytest.mark.slow
def test_failure_before_anything_was_accepted():
    """[X] The partial result holds the stage with nothing of its load, and the state it began
    with.
    """
    basis, forms, fixed = brace(strength=1e-3)
    with pytest.raises(
        sc.NotConverged, match=r"stage 'all' stopped at 0\.00% of its load"
    ) as error:
        model = sc.Model(forms, fixed, newton=QUICK)
        model.run([sc.Stage("all", pressed(basis, 1e3))], **QUIET)
    partial = error.value.result
    assert len(partial) == 1 and partial["all"].fraction == 0.0 and partial["all"].iterations == ()
    assert not partial["all"].x.any() and not partial["all"].states["soil"].stress.any()


@pytest.mark.slow
def test_block_drawn_off_a_table():
    """[X] Case D6: W stays until the centre of gravity passes the edge; then no equilibrium, said
    so.
    """
    mesh = sc.join_bodies(
        {
            "table": grid("Q1", np.linspace(-2, 0, 9), np.linspace(-0.25, 0, 2)),
            "block": grid("Q1", np.linspace(-1.2, -0.2, 5), np.linspace(0, 0.4, 3)),
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(
            basis, {n: sc.LinearElastic(E=1e5, nu=0.2) for n in ("table", "block")}
        ),
        "joint": sc.ContactPair(
            basis, "block:bottom", "table:top", sc.Coulomb(0.2), 3, penalty=1e6
        ),
    }
    own = sc.weight(basis, {"block": 25.0})
    dragged = dofs_at(basis, "block", (-1.2, 0.0))[
        :1
    ]  # one corner: a side would keep the block upright
    fixed = np.concatenate((basis.get_dofs("table:bottom").all(), dragged))
    stages = []
    for k in range(1, 9):
        place = basis.zeros()
        place[dragged] = 0.1 * k
        stages.append(sc.Stage(f"{0.1 * k:.1f}", own, place))
    with pytest.raises(sc.NotConverged) as error:
        sc.Model(forms, fixed, newton=sc.Newton(max_iterations=10)).run(
            [sc.Stage("rest", own), *stages], **QUIET
        )
    partial = error.value.result
    for stage in partial:
        joint = stage.states["joint"]
        weight = forms["joint"].points(joint).weight
        force = forms["joint"].assemble(stage.x, joint).force
        # Newton's tolerance of 1e-8 is one of all forces together
        assert force[unknowns_of(basis, "block")[:, 1]].sum() == pytest.approx(-10, rel=1e-6)
        place = (
            forms["joint"].points(joint).positions(forms["joint"].slave.positions(stage.x))[:, 0]
        )
        # the resultant of the pressure stands under the centre of gravity, but for the couple of
        # the friction
        centre = -0.7 + stage.x[dragged].mean()
        friction = (weight * joint.traction[1]).sum()
        lever = (weight * joint.traction[0] * place).sum() / (weight * joint.traction[0]).sum()
        assert lever == pytest.approx(centre, abs=abs(friction) * 0.2 / 10 + 0.01)
    # the centre passes the edge at 0.7
    assert 0.55 <= partial[-1].x[dragged].mean() <= 0.72


def test_resuming_equals_going_on(tmp_path):
    """[X] Case S25: saved after the second stage, loaded and continued: the same bits of all
    states.
    """
    _, forms, fixed, top, side = friction_blocks("segments")
    stages = [
        sc.Stage("top", top),
        sc.Stage("push", top + 8 * side),
        sc.Stage("back", top - 8 * side, None, 2),
    ]
    whole = sc.Model(forms, fixed).run(stages, **QUIET)
    assert (whole["push"].states["joint"].status == Status.SLIP).any()
    half = sc.Model(forms, fixed).run(stages[:2], **QUIET)
    half.save(tmp_path / "half.npz")
    _, again, *_ = friction_blocks("segments")
    loaded = sc.load_result(tmp_path / "half.npz", again)
    resumed = sc.Model(again, fixed).run(stages[2:], start=loaded, **QUIET)
    assert [s.name for s in resumed] == ["top", "push", "back"]
    for a, b in zip(whole, resumed, strict=True):
        # a new factor of the same matrix may round differently
        np.testing.assert_allclose(b.x, a.x, atol=1e-12 * np.abs(a.x).max())
        for name, state in a.states.items():
            for key, value in vars(state).items():
                scale = np.nanmax(np.abs(value[np.isfinite(value)]), initial=1.0)
                np.testing.assert_allclose(getattr(b.states[name], key), value, atol=1e-10 * scale)


def test_two_runs_are_the_same():
    """[X] Case S24."""
    results = []
    for _ in range(2):
        _, forms, fixed, top, side = friction_blocks("segments")
        results.append(
            sc.Model(forms, fixed).run(
                [sc.Stage("a", top), sc.Stage("b", top + 8 * side)], **QUIET
            )["b"]
        )
    assert (
        np.array_equal(results[0].x, results[1].x)
        and results[0].iterations == results[1].iterations
    )
    assert np.array_equal(
        results[0].states["joint"].traction[1], results[1].states["joint"].traction[1]
    )


def test_run_changes_nothing_of_its_arguments():
    """[X] Forms without penalty stay so, loads and fixed unknowns are not written to."""
    basis, forms, fixed, top, _ = friction_blocks()
    forms["joint"] = sc.ContactPair(
        basis, "block:bottom", "base:top", sc.Coulomb(0.3), quadrature="nodal"
    )
    before = top.copy(), fixed.copy()
    result = sc.Model(forms, fixed).run([sc.Stage("top", top)], **QUIET)
    assert forms["joint"].penalty is None
    assert np.array_equal(top, before[0]) and np.array_equal(fixed, before[1])
    assert result["top"].load is not top or np.array_equal(result["top"].load, before[0])


def test_equal_numbers_of_fixed_unknowns_may_repeat():
    """[X] Corner nodes are listed twice where two boundaries meet."""
    basis, forms, fixed = column()
    load = pressed(basis, 1.0)
    a, b = (
        sc.Model(forms, f).run([sc.Stage("s", load)], **QUIET)["s"].x
        for f in (fixed, list(fixed) + list(fixed[:3]))
    )
    assert np.array_equal(a, b)


def test_progress_bar(capsys):
    """[X] Off it writes nothing; on it shows the stage."""
    basis, forms, fixed = column()
    sc.Model(forms, fixed).run([sc.Stage("gravity", sc.weight(basis, 1.0))], progress=False)
    out = capsys.readouterr()
    assert out.out == "" and out.err == ""
    sc.Model(forms, fixed).run([sc.Stage("gravity", sc.weight(basis, 1.0))])  # no terminal here
    assert capsys.readouterr().err == ""
    sc.Model(forms, fixed).run([sc.Stage("gravity", sc.weight(basis, 1.0))], progress=True)
    written = capsys.readouterr().err
    assert "gravity" in written
    assert "1 increments, 1 iterations, displacement 0.00" in written


def test_soft_penalty_is_warned_of():
    """[X] A penetration of more than 1 % of a segment is a warning, with the number in it; less is
    none.
    """
    _, forms, fixed, top, _ = friction_blocks()
    forms["joint"] = forms["joint"].with_penalty(1e3, 1e3)
    words = r"stage 'top', joint: the slave penetrates by 1\d\.\d%"
    with pytest.warns(sc.AnalysisWarning, match=words) as caught:
        sc.Model(forms, fixed).run([sc.Stage("top", top)], **QUIET)
    assert caught[0].filename == __file__  # it points at the caller's line
    hard = {**forms, "joint": forms["joint"].with_penalty(1e7, 1e7)}
    with warnings.catch_warnings(record=True) as others:
        warnings.simplefilter("always")
        sc.Model(hard, fixed).run([sc.Stage("top", top)], **QUIET)
    assert not any("penetrates" in str(other.message) for other in others)


def test_from_elastic_to_plastic_stage():
    """[X] Materials may change between runs: what was carried elastically yields in the next
    stage.
    """
    basis, forms, fixed = column()
    load = pressed(basis, 10.0)
    first = sc.Model(forms, fixed).run([sc.Stage("elastic", load)], **QUIET)
    plastic = {
        "column": forms["column"].with_materials(
            {"all": sc.MohrCoulomb(E=1e3, nu=0.25, c=1.0, phi=10.0)}
        )
    }
    second = sc.Model(plastic, fixed).run([sc.Stage("plastic", load)], start=first, **QUIET)
    assert not len(second["elastic"].states["column"].internal)
    assert second["plastic"].states["column"].internal.max() > 0
    # confined: sigma_h = K_a-like ratio of the yield condition, vertical stress in equilibrium
    stress = second["plastic"].states["column"].stress
    np.testing.assert_allclose(stress[1], -10, rtol=1e-6)
    sine, cosine = np.sin(np.radians(10)), np.cos(np.radians(10))
    np.testing.assert_allclose(
        (1 + sine) * stress[0], (1 - sine) * stress[1] + 2 * cosine, atol=1e-6
    )


def test_own_form_may_hold_a_body():
    """[X] Any object with the five calls is a form: springs under a body that nothing else
    holds.
    """
    basis = vector_basis(grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3)), "Q1")
    springs = Springs(7.0 * identity(basis.N, format="csr"))
    forms = {"body": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.2)), "springs": springs}
    load = np.ones(basis.N)
    result = sc.Model(forms, np.zeros(0, int)).run([sc.Stage("s", load)], **QUIET)["s"]
    np.testing.assert_allclose(result.x, 1 / 7, rtol=1e-9)


def test_nothing_to_do_takes_no_iterations():
    """[X] No load, no displacement: the state is the same."""
    basis, forms, fixed = column()
    result = sc.Model(forms, fixed).run([sc.Stage("rest", basis.zeros())], **QUIET)["rest"]
    assert result.iterations == (0,) and not result.x.any() and result.residual == 0.0


def test_matching_blocks_under_their_weight():
    """[X] Case J9: sum of the base's reactions and of the joint's pressure are the weights
    above.
    """
    basis, forms, fixed, *_ = friction_blocks()
    load = sc.weight(basis, 20.0)
    result = sc.Model(forms, fixed, newton=sc.Newton(1e-11)).run(
        [sc.Stage("weight", load)], **QUIET
    )["weight"]
    internal = sum(f.assemble(result.x, result.states[k]).force for k, f in forms.items())
    assert internal[fixed][1::2].sum() - load[fixed][1::2].sum() == pytest.approx(
        20 * (0.5 + 1.0), rel=1e-9
    )
    pushed = forms["joint"].assemble(result.x, result.states["joint"]).force
    assert pushed[unknowns_of(basis, "block")[:, 1]].sum() == pytest.approx(-20 * 0.5, rel=1e-9)


@pytest.mark.parametrize("overlap", [1e-4, 0.02, 0.1])
@pytest.mark.parametrize("quadrature", ["nodal", 2])
def test_overlap_at_once_or_ramped(quadrature, overlap):
    """[X] Case S11: bodies meshed into each other, 0.1 to 60 % of an element: pushed apart, by
    either way the same.
    """
    results = []
    for initial in ("as meshed", "ramped"):
        mesh = sc.join_bodies(
            {
                "lower": grid("Q1", np.linspace(0, 1, 6), np.linspace(-0.5, overlap / 2, 4)),
                "upper": grid("Q1", np.linspace(0, 1, 6), np.linspace(-overlap / 2, 0.5, 4)),
            }
        )
        basis = vector_basis(mesh, "Q1", intorder=2)
        forms = {
            "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0)),
            "joint": sc.ContactPair(
                basis,
                "upper:bottom",
                "lower:top",
                sc.Coulomb(),
                quadrature,
                penalty=1e6,
                initial=initial,
            ),
        }
        smooth = basis.get_dofs({"lower:left", "lower:right", "upper:left", "upper:right"}).all(
            "u^1"
        )
        fixed = np.concatenate((basis.get_dofs({"lower:bottom", "upper:top"}).all(), smooth))
        results.append(
            sc.Model(forms, fixed, newton=sc.Newton(1e-11)).run(
                [sc.Stage("fit", basis.zeros())], **QUIET
            )["fit"]
        )
        # two columns of the length 0.5 + overlap / 2 and the penalty in series
        pressure = overlap / (2 * (0.5 + overlap / 2) / 1e4 + 1e-6)
        np.testing.assert_allclose(results[-1].states["joint"].traction[0], -pressure, rtol=1e-6)
    np.testing.assert_allclose(results[1].x, results[0].x, atol=1e-9 * overlap)


def test_weight_that_a_load_lacks_is_told(recwarn):
    """Loads are whole loads: one that forgets the weight is told; none at all, and weight that
    stays, are not.
    """
    basis, forms, fixed = column(element="P2")
    model = sc.Model(forms, fixed)
    own, push = model.weight(20.0), pressed(basis, 5.0)
    held = own.copy()
    held[basis.get_dofs("top").all()] = 0.0

    def told(loads, start=None):
        recwarn.clear()
        stages = [sc.Stage(f"{len(start or ())}{k}", load) for k, load in enumerate(loads)]
        found = model.run(stages, start=start, **QUIET)
        text = "lacks the weight of 'column', about "
        return found, [warning for warning in recwarn if text in str(warning.message)]

    start, none = told([own])
    assert not none
    for loads, before in (
        ((own, push), None),
        ((push,), start),
        ((None,), start),
        ((own, own + push, push), None),
        ((2 * own, push + 1e-15 * own), None),  # round-off of a difference
    ):
        assert len(told(loads, before)[1]) == 1
    for loads, before in (
        ((own, own + push, own), None),
        ((0 * own,), start),
        ((push, 2 * push), None),
        ((own, held), None),  # a jack that bears the weight at the top alone
    ):
        assert not told(loads, before)[1]
    model = sc.Model(
        {"column": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.25), unit_weight=20.0)}, fixed
    )
    assert not told([None, push])[1]  # the weight of the solid stays


def test_form_under_two_names():
    """It would act twice, and is refused."""
    _, forms, fixed = column()
    with pytest.raises(ValueError, match="'column' and 'again' are the same form"):
        sc.Model({**forms, "again": forms["column"]}, fixed)
