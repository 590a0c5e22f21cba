"""Results: access, the printed table, saving and loading."""

from __future__ import annotations

from dataclasses import replace
from zlib import crc32

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from skfem import Basis, ElementQuad1, ElementVector, FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.results import Result
from skfem_contact.results.files import _settings
from tests.tools.helpers import grid, vector_basis


def blocks(quadrature="nodal", element: str = "Q1", n: int = 3, enforcement=None):
    """Two blocks and a result of two stages."""
    mesh = sc.join_bodies(
        {
            "lower": grid(element, np.linspace(-0.5, 1.5, 2 * n + 2), np.linspace(-0.5, 0, 3)),
            "upper": grid(element, np.linspace(0, 1, n + 2), np.linspace(0, 0.5, 3)),
        }
    )
    basis = vector_basis(mesh, element)
    materials = {
        "lower": sc.MohrCoulomb(E=1e4, nu=0.3, c=3.0, phi=20.0),
        "upper": sc.LinearElastic(E=1e4, nu=0.2),
    }
    forms = {
        "blocks": sc.SolidForm(basis, materials),
        "joint": sc.ContactPair(
            basis,
            "upper:bottom",
            "lower:top",
            sc.Coulomb(0.4),
            quadrature,
            penalty=1e6,
            enforcement=enforcement,
        ),
    }
    top = LinearForm(lambda v, w: -20.0 * v[1] + v[0]).assemble(
        FacetBasis(mesh, basis.elem, facets="upper:top")
    )
    return (
        basis,
        forms,
        basis.get_dofs("lower:bottom").all(),
        [sc.Stage("half", 0.5 * top), sc.Stage("full", top, None, 3)],
    )


@pytest.fixture(scope="module")
def example():
    basis, forms, fixed, stages = blocks()
    return basis, forms, sc.Model(forms, fixed).run(stages, progress=False)


def test_access(example):
    """[X] By name, by number, in order."""
    *_, result = example
    assert len(result) == 2 and [s.name for s in result] == ["half", "full"]
    assert result["half"] is result[0] and result["full"] is result[1] and result[-1] is result[1]
    with pytest.raises(KeyError, match=r"no stage 'quarter'; existing: \['half', 'full'\]"):
        result["quarter"]


def test_what_a_notebook_shows(example):
    """A table and one line, not the arrays of all stages."""
    *_, result = example
    assert repr(result) == str(result)
    assert (
        repr(result[0]).startswith("<StageResult 'half', 100% of its load, ")
        and len(repr(result[0])) < 100
    )


def test_going_on_from_a_stage_that_is_not_the_last(example):
    """[X] The second stage once more, from the first: the same as it was."""
    _, _, fixed, (_, full) = blocks()
    _, forms, result = example
    again = sc.Model(forms, fixed).run([full], start=result["half"], progress=False)
    assert [stage.name for stage in again] == ["half", "full"]
    # round-off of the first step, which is not predicted from a step before
    np.testing.assert_allclose(
        again["full"].x, result["full"].x, atol=1e-10 * np.abs(result["full"].x).max()
    )


def test_file_without_its_end_or_of_another_kind(example, tmp_path):
    _, forms, result = example
    result.save(tmp_path / "out")
    assert len(sc.load_result(tmp_path / "out", forms)) == 2
    np.savez(tmp_path / "other.npz", x=np.zeros(3))
    with pytest.raises(ValueError, match=r"other\.npz cannot be read as a result"):
        sc.load_result(tmp_path / "other.npz", forms)


def test_contents(example):
    """[X] Displacements, loads and states hold what the forms answer at them."""
    basis, forms, result = example
    full = result["full"]
    assert full.x.shape == (basis.N,) and set(full.states) == {"blocks", "joint"}
    np.testing.assert_allclose(result["half"].load * 2, full.load)
    assert full.fraction == 1.0 and len(full.iterations) == 3 and full.residual <= 1e-8
    again = forms["joint"].assemble(full.x, full.states["joint"]).state
    np.testing.assert_allclose(again.traction[0], full.states["joint"].traction[0], atol=1e-9)


def test_table(example):
    """[X] One line a stage: increments, iterations, residual, share of the load, and every form in
    a few words.
    """
    *_, result = example
    lines = str(result).splitlines()
    assert len(lines) == 3 and lines[0].split()[:4] == [
        "stage",
        "increments",
        "iterations",
        "residual",
    ]
    words = lines[2].split()
    assert (
        words[0] == "full" and words[1] == "3" and int(words[2]) == sum(result["full"].iterations)
    )
    assert "100%" in words and "joint:" in words and "stick," in words and "open" in words
    state = result["full"].states["joint"]
    assert f"{(state.status == Status.STICK).sum()} stick" in lines[2]
    share = (result["full"].states["blocks"].internal[0] > 0).mean()
    assert share > 0 and f"blocks: {share:.1%} yielded" in lines[2]


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
@pytest.mark.parametrize("element", ["Q1", "P2"])
def test_save_and_load(tmp_path, quadrature, element):
    """[X] Case S25: everything comes back bit by bit, with its types."""
    _, forms, fixed, stages = blocks(quadrature, element)
    result = sc.Model(forms, fixed).run(stages, progress=False)
    file = tmp_path / "result.npz"
    result.save(file)
    loaded = sc.load_result(file, forms)
    assert str(loaded) == str(result)
    for a, b in zip(result, loaded, strict=True):
        assert (a.name, a.iterations, a.residual, a.fraction) == (
            b.name,
            b.iterations,
            b.residual,
            b.fraction,
        )
        assert np.array_equal(a.x, b.x) and np.array_equal(a.load, b.load)
        for name, state in a.states.items():
            assert type(b.states[name]) is type(state)
            for key, value in vars(state).items():
                other = getattr(b.states[name], key)
                assert other.dtype == value.dtype and np.array_equal(other, value, equal_nan=True)


@pytest.mark.parametrize("quadrature", ["nodal", 2, "segments"])
def test_load_with_multipliers_and_go_on(tmp_path, quadrature):
    """[X] Multipliers are those of the file as of memory."""
    _, forms, fixed, (half, full) = blocks(quadrature, enforcement=sc.AugmentedLagrangian())
    result = sc.Model(forms, fixed).run([half], progress=False)
    assert result["half"].states["joint"].multiplier.any()
    result.save(tmp_path / "result.npz")
    loaded = sc.load_result(tmp_path / "result.npz", forms)
    again, direct = (
        sc.Model(forms, fixed).run([full], start=start, progress=False)["full"]
        for start in (loaded, result)
    )
    np.testing.assert_array_equal(again.x, direct.x)


def test_load_for_other_forms(example, tmp_path):
    """One error that names what differs."""
    _, forms, result = example
    file = tmp_path / "result.npz"
    result.save(file)
    with pytest.raises(
        ValueError, match=r"it holds the forms \['blocks', 'joint'\], not \['blocks'\]"
    ):
        sc.load_result(file, {"blocks": forms["blocks"]})
    finer = blocks(n=4)[1]
    with pytest.raises(ValueError, match="'blocks' has another mesh"):
        sc.load_result(file, finer)
    other = blocks(quadrature="segments")[1]
    with pytest.raises(ValueError, match="'joint' is another form there"):
        sc.load_result(file, other)
    swapped = {"blocks": forms["joint"], "joint": forms["blocks"]}
    with pytest.raises(ValueError, match=r"'blocks' has another mesh"):
        sc.load_result(file, swapped)


def test_other_materials_than_in_the_file_are_told(tmp_path, recwarn):
    """[X] A stage changes the ground: stages are named that the given forms do not fit."""
    basis, forms, fixed, (half, _) = blocks()
    ground = forms["blocks"]
    weaker = ground.with_materials({"lower": sc.MohrCoulomb(E=1e4, nu=0.3, c=3.0, phi=18.0)})
    smooth = sc.ContactPair(
        basis, "upper:bottom", "lower:top", sc.Coulomb(0.3), "nodal", penalty=1e6
    )
    stages = [half, sc.Stage("weaker", half.load, change={"blocks": weaker})]
    result = sc.Model(forms, fixed).run(stages, progress=False)
    result.save(tmp_path / "run.npz")
    for given, told in (
        (forms, {"weaker": "'blocks'"}),
        ({**forms, "blocks": weaker}, {"half": "'blocks'"}),
        ({**forms, "joint": smooth}, {"half": "'joint'", "weaker": "'blocks', 'joint'"}),
    ):
        recwarn.clear()
        sc.load_result(tmp_path / "run.npz", given)
        texts = [
            f"stage '{name}' was computed with other materials or laws of {names} than"
            for name, names in told.items()
        ]
        assert [
            str(warning.message).startswith(text)
            for warning, text in zip(recwarn, texts, strict=True)
        ] == [True] * len(texts)


def wall_on_the_right():
    """A block whose stages take away a wall on its right, jack a prop, then load the top."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 4, 5), np.linspace(0, 2, 3)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {
        "block": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0),
        "prop": sc.Bar(basis, (4.0, 2.0), (8.0, 2.0), EA=1e4, fixed_end=True),
    }
    model = sc.Model(forms, sc.box_supports(basis))
    free = basis.get_dofs("bottom").all()
    stages = [
        sc.Stage("weight", deactivate="prop"),
        sc.Stage("free", fixed=free),
        sc.Stage("load", model.traction("top", (0.0, -50.0))),
    ]
    return model, stages


@pytest.mark.parametrize("by_forms", [False, True])
def test_files_keep_supports_that_a_stage_has_given(tmp_path, by_forms):
    """[X] A run that continues from a file has the supports of the stages before, as one run."""
    model, stages = wall_on_the_right()
    whole = model.run(stages, progress=False)
    model.run(stages[:2], progress=False).save(tmp_path / "part.npz")
    again, stages = wall_on_the_right()
    read = sc.load_result(tmp_path / "part.npz", again.forms if by_forms else again)
    assert np.array_equal(read["free"].supports, whole["free"].supports)
    rest = again.run(stages[2:], start=read, progress=False)
    assert np.array_equal(rest["load"].x, whole["load"].x)
    assert rest["load"].supports_given and len(rest["load"].supports) == len(stages[1].fixed)


def test_supports_of_the_model_are_those_of_the_model_that_continues(tmp_path):
    """[X] Where no stage gives supports, a run from a file has those of its model."""
    model, stages = wall_on_the_right()
    part = model.run(stages[:1], progress=False)
    assert not model.run(stages[2:], start=part, progress=False)["load"].supports_given
    part.save(tmp_path / "part.npz")
    other = sc.Model(model.forms, stages[1].fixed)
    read = sc.load_result(tmp_path / "part.npz", other)
    end = other.run(stages[2:], start=read, progress=False)["load"]
    assert np.array_equal(end.supports, other.fixed) and not end.supports_given


def test_another_model_continues_with_its_own_supports():
    """[X] Supports that a stage of one model has given are not those of another one."""
    model, stages = wall_on_the_right()
    part = model.run(stages[:2], progress=False)
    again, stages = wall_on_the_right()
    end = again.run(stages[2:], start=part, progress=False)["load"]
    assert np.array_equal(end.supports, again.fixed) and not end.supports_given


def test_damaged_supports_are_refused(tmp_path):
    """[X] Supports beyond the dofs of a stage are none."""
    model, stages = wall_on_the_right()
    end = model.run(stages[:1], progress=False)[0]
    sc.results.Result((replace(end, supports=np.array([len(end.x)])),)).save(tmp_path / "part.npz")
    with pytest.raises(ValueError, match="'weight' has supports that are no dofs of its 30"):
        sc.load_result(tmp_path / "part.npz", model)


def test_other_parameters_of_structures_than_at_the_end_of_a_file_are_told(tmp_path, recwarn):
    """[X] A jack and heat that files do not hold; a jack that was locked off needs no word."""
    model, stages = wall_on_the_right()
    prop = model.forms["prop"]
    jack = sc.Stage("jack", activate="prop", change={"prop": prop.prestressed(-40.0)})
    lock = sc.Stage("lock", change={"prop": prop})
    file = tmp_path / "part.npz"
    for given, told in (([stages[0], jack], ["prop"]), ([stages[0], jack, lock], [])):
        model.run(given, progress=False).save(file)
        recwarn.clear()
        sc.load_result(file, model)
        assert [str(one.message).split("'")[1] for one in recwarn] == told
    strut = sc.Beam(None, [(0.0, 0.0), (4.0, 0.0)], EI=100.0, EA=1e4)
    hot = sc.Model({"strut": strut}, [*strut.dofs((0.0, 0.0)), *strut.dofs((4.0, 0.0))])
    change = {"strut": strut.heated(1e-3)}
    hot.run([sc.Stage("hot", change=change)], progress=False).save(file)
    with pytest.warns(sc.AnalysisWarning, match="ends with other parameters of 'strut'"):
        sc.load_result(file, hot)


@pytest.mark.slow
def test_partial_result_can_be_saved(tmp_path):
    """[X] What NotConverged carries is a result like any other."""
    _, forms, fixed, stages = blocks()
    with pytest.raises(sc.NotConverged) as error:
        newton = sc.Newton(max_iterations=6)
        sc.Model(forms, fixed, newton=newton).run(
            [stages[0], sc.Stage("too much", 400 * stages[1].load)], progress=False
        )
    partial = error.value.result
    partial.save(tmp_path / "partial.npz")
    loaded = sc.load_result(tmp_path / "partial.npz", forms)
    assert loaded["too much"].fraction == partial["too much"].fraction < 1
    assert np.array_equal(loaded["too much"].x, partial["too much"].x)
    assert f"{partial['too much'].fraction:4.0%}" in str(loaded)


def test_empty_result(tmp_path):
    """[X] A table without lines, and a file of it."""
    assert len(Result(())) == 0 and len(str(Result(())).splitlines()) == 1
    Result(()).save(tmp_path / "empty.npz")
    assert len(sc.load_result(tmp_path / "empty.npz", {})) == 0


def test_save_and_load_after_sliding(tmp_path):
    """[X] The rule "segments" has other points after a slide: they come back, and the analysis goes
    on.
    """
    basis, forms, fixed, _ = blocks("segments")
    forms["blocks"] = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.2))
    fixed = np.concatenate((fixed, basis.get_dofs("upper:top").all()))
    stages = []
    for k in range(1, 5):
        moved = basis.zeros()
        moved[basis.get_dofs("upper:top").all("u^1")] = 0.07 * k
        moved[basis.get_dofs("upper:top").all("u^2")] = -1e-2
        stages.append(sc.Stage(f"{k}", basis.zeros(), moved))
    whole = sc.Model(forms, fixed).run(stages, progress=False)
    numbers = [len(s.states["joint"].gap) for s in whole]
    assert len(set(numbers)) > 1
    sc.Model(forms, fixed).run(stages[:3], progress=False).save(tmp_path / "three.npz")
    start = sc.load_result(tmp_path / "three.npz", forms)
    resumed = sc.Model(forms, fixed).run(stages[3:], start=start, progress=False)
    np.testing.assert_allclose(resumed["4"].x, whole["4"].x, atol=1e-12)
    assert (
        resumed["4"].iterations == whole["4"].iterations
    )  # extrapolated from the same two increments
    # forces of the order of one; a new factor of the same matrix rounds in another way
    one, other = (result["4"].states["joint"].traction[0] for result in (resumed, whole))
    np.testing.assert_allclose(one, other, atol=1e-9)


class _Anchor(sc.Form):
    """A spring to the ground without a state: its force is lost where displacements are counted
    anew.
    """

    def __init__(self, n, dofs, stiffness):
        self.K = csr_matrix((np.full(len(dofs), stiffness), (dofs, dofs)), shape=(n, n))

    def assemble(self, x, state):
        return sc.Response(self.K @ x, lambda: state, lambda: self.K)


class _RebasedAnchor(_Anchor, sc.roles.Staged):
    """The same with the displacements at which it began."""

    def initial_state(self, x=None):
        return np.zeros(self.K.shape[0])

    def assemble(self, x, state):
        return sc.Response(self.K @ (x - state), lambda: state, lambda: self.K)

    def rebased(self, x, state):
        return state - x


def test_reset_keeps_all_forces():
    """[X] A form that loses its force is named; with `rebased` of its own a stage of the same load
    moves nothing.
    """
    basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    fixed, load = basis.get_dofs().all("u^1"), sc.weight(basis, 20.0)
    for kind in (_Anchor, _RebasedAnchor):
        forms = {
            "body": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0)),
            "anchor": kind(basis.N, basis.get_dofs("bottom").all("u^2"), 100.0),
        }
        first = sc.Model(forms, fixed).run([sc.Stage("weight", load)], progress=False)
        if kind is _Anchor:
            with pytest.raises(
                ValueError,
                match=r"the force of 'anchor' changes by 4\.17 when .* rebased\(x, state\)",
            ):
                first.reset()
            continue
        null = sc.Model(forms, fixed).run(
            [sc.Stage("null", load)], start=first.reset(), progress=False
        )["null"]
        assert np.abs(null.x).max() < 1e-9 * np.abs(first["weight"].x).max()


@pytest.mark.parametrize("shape", [(3,), (8, 1), (0,)])
def test_displacements_of_another_shape(shape):
    """[X] Displacements of one's own have all dofs of the forms, in one row."""
    basis = vector_basis(grid("Q1", [0.0, 1.0], [0.0, 1.0]), "Q1", intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3))
    states = {"solid": solid.initial_state()}
    with pytest.raises(ValueError, match=r"displacements of 'solid' have shape .*, not \(8,\)"):
        sc.results.of({"solid": solid}, np.zeros(shape), states)
    assert not sc.results.of({"solid": solid}, np.zeros(8), states).x.any()


def test_parameters_of_a_law_are_told_apart_by_their_means():
    """[X] A number is itself, and arrays are means with the weights sqrt(1 .. n), which tell values
    of swapped elements apart: files of other versions have the same.
    """
    basis = vector_basis(grid("Q1", [0, 1, 2], [0, 1]), "Q1")

    def settings(E):
        return _settings(sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.3)))

    kind, *numbers = settings(2e4)
    assert kind == crc32(b"LinearElastic")
    assert numbers == pytest.approx([1.0, 2e4, 1.0, 0.3], rel=1e-15)
    root = np.sqrt(2.0)
    mean = (1e4 + 3e4 * root) / (1.0 + root)
    assert settings(np.array([1e4, 3e4]))[1:] == pytest.approx([2.0, mean, 1.0, 0.3], rel=1e-12)
    assert settings(np.array([3e4, 1e4]))[2] != pytest.approx(mean, rel=0.1)
