"""Runs that go on by themselves with new meshes: supports, contact, failures and refusals."""

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc

STIFF = sc.LinearElastic(E=100.0, nu=0.3)
CLAY = sc.Tresca(E=200.0, nu=0.49, c=1.0)


def model_of(mesh, material=STIFF, sides=("left", "right", "bottom", "top")):
    """Return the model of a block whose sides are held."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    body = sc.SolidForm(basis, material, kinematics="finite")
    return sc.Model({"body": body}, basis.get_dofs(list(sides)).all())


def block(n=2):
    return MeshTri().refined(n).with_defaults()


def stage_of(model, name, field, **options):
    """Return a stage with displacements of a field (2, n) of coordinates."""
    basis = model.forms["body"].basis
    u = np.zeros(basis.N)
    u[0::2], u[1::2] = field(basis.doflocs[:, 0::2])
    return sc.Stage(name, prescribed=u, **options)


def test_supports_follow_linear_fields():
    """[X] Displacements of supports that vary along sides are carried over: the strain is uniform.

    The stretch is diagonal and the second one on top of the first one, so that logarithmic strains
    add up; stresses count the volume of the new mesh, hence one that stays.
    """
    model = model_of(block())
    first = stage_of(model, "first", lambda x: np.stack((0.25 * x[0], -0.2 * x[1])))
    second = stage_of(model, "second", lambda x: np.stack((0.6 * x[0], -0.375 * x[1])))
    remesh = sc.Remeshing(model_of, 0.3, every=1)
    result = model.run([first, second], remesh=remesh, progress=False)
    assert [stage.name for stage in result] == ["first", "mesh 1", "second"]
    stage = result["second"]
    form = stage.forms["body"]
    stress = form.cauchy(stage.states["body"]).reshape(4, -1)
    strain = np.array([np.log(1.6), -np.log(1.6), 0.0])
    exact = STIFF.E / (1 + STIFF.nu) * strain
    assert np.abs(stress[:3] - exact[:, None]).max() < 1e-8 * exact[0]
    corner = form.basis.doflocs[:, 0::2] + stage.x.reshape(-1, 2).T
    assert corner.max(axis=1) == pytest.approx([1.6, 0.625], rel=1e-12)


def test_same_as_the_loop():
    """[X] The run is the loop around remeshed and start, to the last digit."""
    model = model_of(block(), CLAY, ("bottom", "top"))

    def slid(way):
        return lambda x: np.stack((way * (x[1] > 1 - 1e-9), 0 * x[0]))

    stages = [stage_of(model, f"{way}", slid(way), increments=2) for way in (0.2, 0.3)]
    build = lambda mesh: model_of(mesh, CLAY, ("bottom", "top"))  # noqa: E731
    result = model.run(stages, remesh=sc.Remeshing(build, 0.3, every=1), progress=False)

    last = model.run(stages[:1], progress=False)[-1]
    new = sc.remeshed(last, 0.3)
    again = build(new.mesh)
    start = new.start(again)
    on = stage_of(again, "on", slid(0.3 - 0.2), increments=2)
    end = again.run([on], start=start, progress=False)["on"]
    assert np.abs(result["0.3"].x - end.x).max() < 1e-12
    assert result["mesh 1"].series["loss"] == pytest.approx(start[-1].series["loss"])


def test_new_meshes_where_elements_are_bad():
    """[X] A sheared block gets meshes by itself, yields at its strength, and no remark is left."""
    model = model_of(block(), CLAY, ("bottom", "top", "left", "right"))
    ways = 0.25 * np.arange(1, 17)
    stages = []
    for way in ways:
        sheared = lambda x, way=way: np.stack((way * x[1], 0 * x[0]))  # noqa: E731
        stages.append(stage_of(model, f"{way}", sheared, increments=5))
    build = lambda mesh: model_of(mesh, CLAY)  # noqa: E731
    result = model.run(stages, remesh=sc.Remeshing(build, 0.3), progress=False)
    names = [stage.name for stage in result if stage.name.startswith("mesh")]
    assert 1 <= len(names) <= 4
    stage = result["4.0"]
    shear = stage.forms["body"].cauchy(stage.states["body"])[3]
    assert shear == pytest.approx(1.0, abs=1e-3)  # steps of .05 in the return
    assert not any(remark for stage in result for remark in stage.remarks)


def fragile():
    """Model, stages, function that builds models, and its calls: the first mesh fails when far."""
    calls = []

    class Fragile(sc.LinearElastic):
        """Material that fails far on the first mesh."""

        def update(self, strain, stress, internal):
            if len(calls) == 0 and np.abs(stress).max() > 20.0:
                raise sc.errors.NotConverged("too much")
            return super().update(strain, stress, internal)

    material = Fragile(E=100.0, nu=0.3)

    def build(mesh):
        calls.append(mesh)
        return model_of(mesh, material)

    model = model_of(block(1), material)
    stages = []
    for way in (0.1, 0.3):
        stretched = lambda x, way=way: np.stack((way * x[0], 0 * x[1]))  # noqa: E731
        stages.append(stage_of(model, f"{way}", stretched, increments=4))
    return model, stages, build, calls


def test_a_failed_stage_begins_anew_on_a_new_mesh():
    """A stage whose elements turn over on a used mesh passes on a new one; else its error stays."""
    model, stages, build, calls = fragile()
    result = model.run(stages, remesh=sc.Remeshing(build, 0.5, every=9), progress=False)
    assert [stage.name for stage in result] == ["0.1", "mesh 1", "0.3"]
    with pytest.raises(sc.errors.NotConverged) as caught:
        calls.clear()
        model.run(stages[1:], remesh=sc.Remeshing(build, 0.5), progress=False)
    assert caught.value.result is not None


def below_a_tool(mesh, penalty=5e3):
    """Return the model of a block below a round tool that stays."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
    circle = sc.rigid.circle((0.5, 1.75), 0.75)
    forms = {
        "body": sc.SolidForm(basis, CLAY, kinematics="finite"),
        "tool": sc.ContactPair(basis, "top", circle, sc.Coulomb(), 3, penalty),
    }
    return sc.Model(forms, basis.get_dofs("bottom").all())


def pressed(model, name, way, **options):
    """Return a stage in which the bottom of a block rises."""
    u = np.zeros(model.layout.size)
    u[model.forms["body"].basis.get_dofs("bottom").all("u^2")] = way
    return sc.Stage(name, prescribed=u, **options)


def test_remarks_of_a_run_are_told_once_and_not_on_curves_of_new_meshes():
    """The largest penetration of all meshes; errors of new curves are no overlaps of bodies."""

    def build(mesh):
        return below_a_tool(mesh, penalty=1000.0)

    model = build(block(2))
    stages = [pressed(model, f"{way}", way) for way in (0.03, 0.06, 0.09)]
    with pytest.warns(sc.AnalysisWarning) as told:
        result = model.run(stages, remesh=sc.Remeshing(build, 0.25, every=1), progress=False)
    texts = [str(warning.message) for warning in told]
    soft = [text for text in texts if "too soft for this load" in text]
    shares = []
    for stage in result:
        shares += [r.split("by ")[1].split("%")[0] for r in stage.remarks if "too soft" in r]
    assert len(shares) == 3
    assert [text.split("by ")[1].split("%")[0] for text in soft] == [max(shares, key=float)]
    assert not [text for text in texts if "overlap" in text]


@pytest.mark.slow
def test_closed_points_stay_on_a_round_tool():
    """[X] New meshes without any motion change neither gaps nor forces of a round tool.

    With gaps of the new curves the clearances would grow by their errors at each mesh. The first
    mesh of the same size takes 8 % of the force, since interpolated stresses are out of balance.
    """
    model = below_a_tool(block(3))
    stages = [pressed(model, "pressed", 0.1, increments=4)]
    stages += [pressed(model, f"rest {k}", 0.1) for k in range(3)]
    result = model.run(stages, remesh=sc.Remeshing(below_a_tool, 0.125, every=1), progress=False)
    forces = []
    for name in ("pressed", "rest 0", "rest 1", "rest 2"):
        stage = result[name]
        state = stage.states["tool"]
        closed = state.status != 0
        assert np.abs(state.gap[closed]).max() < 2e-3  # the penetration
        dofs = stage.forms["body"].basis.get_dofs("bottom").all("u^2")
        forces.append(stage.reactions()[dofs].sum())
    assert forces[1] == pytest.approx(forces[0], rel=0.1)
    assert forces[2:] == pytest.approx([forces[1]] * 2, rel=2e-3)


def sheared(n=4, build=None):
    """Return a model, stages that shear it, and new meshes after each of them."""
    model = model_of(block(), CLAY, ("bottom", "top"))
    stages = []
    for way in 0.15 * np.arange(1, n + 1):
        slid = lambda x, way=way: np.stack((way * (x[1] > 1 - 1e-9), 0 * x[0]))  # noqa: E731
        stages.append(stage_of(model, f"{way:.2f}", slid, increments=2))
    build = build or (lambda mesh: model_of(mesh, CLAY, ("bottom", "top")))
    return model, stages, sc.Remeshing(build, 0.3, every=1)


def same(result, other):
    """Compare stages, displacements and stresses to round-off."""
    assert [stage.name for stage in other] == [stage.name for stage in result]
    for one, two in zip(result, other, strict=True):
        np.testing.assert_allclose(two.x, one.x, atol=1e-12)
        stresses = [stage.forms["body"].cauchy(stage.states["body"]) for stage in (one, two)]
        np.testing.assert_allclose(stresses[1], stresses[0], atol=1e-9)
        assert (two.new_mesh is None) == (one.new_mesh is None)


@pytest.fixture(scope="module")
def whole():
    """The result of all stages."""
    model, stages, remesh = sheared()
    return model.run(stages, remesh=remesh, progress=False)


@pytest.mark.parametrize("n_done", [1, pytest.param(2, marks=pytest.mark.slow), 3])
def test_saved_runs_are_read_and_continue(tmp_path, n_done, whole):
    """[X] Stages of three meshes are read, shown, and continue as if the run had not ended."""
    model, stages, remesh = sheared()
    half = model.run(stages[:n_done], remesh=remesh, progress=False)
    half.save(tmp_path / "half")
    read = sc.load_result(tmp_path / "half", model, remesh.model_of)
    same(half, read)
    resumed = model.run(stages[n_done:], start=read, remesh=remesh, progress=False)
    same(whole, resumed)
    assert len(read.to_pvd(tmp_path / "half.pvd")) == 1 + len(read)
    if n_done > 1:
        with pytest.raises(ValueError, match="give the whole result, whose stages hold the meshes"):
            model.run(stages[n_done:], start=read[-1], remesh=remesh, progress=False)
        assert read[1].new_mesh.boundaries.keys() == half[1].new_mesh.boundaries.keys()
        with pytest.raises(ValueError, match="continued with new meshes: give model_of"):
            sc.load_result(tmp_path / "half", model)
        with pytest.raises(ValueError, match="'body' has another mesh"):
            sc.load_result(tmp_path / "half", model, lambda mesh: model)


@pytest.mark.slow
def test_appended_runs_are_read_and_continue(tmp_path):
    """[X] A run that is stopped on its second mesh continues from the file of its increments."""
    model, stages, remesh = sheared(3)
    whole = model.run(stages, remesh=remesh, progress=False)
    append = sc.results.Append(tmp_path / "run.records")

    def stop(increment):
        append(increment)
        if increment.name == stages[2].name:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        model.run(stages, remesh=remesh, on_increment=stop, progress=False)
    read = sc.load_result(append.file, model, remesh.model_of)
    assert read[-1].name == stages[2].name and read[-1].fraction == 0.5
    done = read.completed()
    assert [stage.name for stage in done] == [stage.name for stage in whole][:-1]
    model.run(stages[2:], start=done, remesh=remesh, on_increment=append, progress=False)
    same(whole, sc.load_result(append.file, model, remesh.model_of))
    # the whole run once more, into the same file: its records replace those of the first mesh on
    model.run(stages[:1], remesh=remesh, on_increment=append, progress=False)
    again = sc.load_result(append.file, model, remesh.model_of)
    same(sc.results.Result(whole.stages[:1]), again)


def test_appended_stages_that_began_anew(tmp_path):
    """Increments of a stage that failed on the mesh before are left out."""
    model, stages, build, _ = fragile()
    append = sc.results.Append(tmp_path / "run.records")
    remesh = sc.Remeshing(build, 0.5, every=9)
    result = model.run(stages, remesh=remesh, on_increment=append, progress=False)
    assert [stage.name for stage in result] == ["0.1", "mesh 1", "0.3"]
    same(result, sc.load_result(append.file, model, build))


@pytest.mark.parametrize("member", ["model_of", "observer"])
def test_whatever_ends_a_new_mesh_leaves_the_stages_before(member):
    """Errors of the function that builds models, and interrupts on a new mesh, lose no stage."""
    model = model_of(block())
    stages = [stage_of(model, name, lambda x: 0.0 * x) for name in ("still", "calm")]

    def build(mesh):
        if member == "model_of":
            raise KeyError("soil")
        return model_of(mesh)

    def observe(increment):
        if increment.name == "mesh 1" and member == "observer":
            raise KeyboardInterrupt

    with pytest.raises((KeyError, KeyboardInterrupt)) as caught:
        model.run(
            stages,
            remesh=sc.Remeshing(build, 0.3, every=1),
            on_increment=observe,
            progress=False,
        )
    assert next(iter(caught.value.result)).name == "still"


def test_refusals():
    """Each mistake has one sentence, before anything is computed."""
    model = model_of(block())
    still = stage_of(model, "still", lambda x: 0.0 * x)
    far = stage_of(model, "far", lambda x: 0.1 * x)

    def run(stages, build=model_of, **options):
        return model.run(stages, remesh=sc.Remeshing(build, 0.3, **options), progress=False)

    with pytest.raises(ValueError, match="'loaded' gives load, which new meshes do not take over"):
        run([still, sc.Stage("loaded", load=np.zeros(model.layout.size))])
    with pytest.raises(ValueError, match="gives prescribed as a function"):
        run([sc.Stage("turned", prescribed=lambda share: np.zeros(model.layout.size))])
    with pytest.raises(ValueError, match="gives activate"):
        run([sc.Stage("more", activate="body")])
    with pytest.raises(ValueError, match="every must be a whole number of stages, not 0"):
        run([still], every=0)
    with pytest.raises(ValueError, match="size must be a positive number or a function, not 0"):
        sc.Remeshing(model_of, 0)
    with pytest.raises(ValueError, match="model_of must be a function, not 3"):
        run([still], build=3)
    with pytest.raises(ValueError, match="two stages are named"):
        run([still, still])
    with pytest.raises(ValueError, match="'mesh 1' has the name of a new mesh"):
        run([still, stage_of(model, "mesh 1", lambda x: 0.0 * x)])
    strut = sc.Bar(model.forms["body"].basis, (0.0, 0.0), (0.0, 1.0), EA=1.0, kinematics="finite")
    braced = sc.Model({**model.forms, "strut": strut}, model.fixed)
    with pytest.raises(ValueError, match=r"\['strut'\] are no solids or contact"):
        braced.run([still], remesh=sc.Remeshing(model_of, 0.3), progress=False)

    with pytest.raises(ValueError, match="must return a Model, not NoneType") as caught:
        run([still, far], build=lambda mesh: None, every=1)
    assert [stage.name for stage in caught.value.result] == ["still"]

    def other(mesh):
        basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)
        return sc.Model({"other": sc.SolidForm(basis, STIFF, kinematics="finite")}, np.arange(4))

    with pytest.raises(ValueError, match=r"forms \['other'\], unlike \['body'\] before"):
        run([still, far], build=other, every=1)
    half = model_of(block(), STIFF, ("bottom", "top"))
    with pytest.raises(ValueError, match="lie on no boundary that is held as a whole"):
        remesh = sc.Remeshing(model_of, 0.3, every=1)
        half.run([still, stage_of(half, "on", lambda x: 0 * x)], remesh=remesh, progress=False)
    basis = model.forms["body"].basis
    corner = sc.Model({"body": sc.SolidForm(basis, STIFF, kinematics="finite")}, np.arange(4))
    with pytest.raises(ValueError, match="4 supported dofs lie on no boundary that is held"):
        corner.run([still], remesh=remesh, progress=False)
    small = sc.Model({"body": sc.SolidForm(basis, STIFF)}, model.fixed)
    with pytest.raises(ValueError, match="kinematics='finite', unlike"):
        small.run([still], remesh=remesh, progress=False)
    with pytest.raises(ValueError, match="'short': the prescribed displacement"):
        run([still, sc.Stage("short", prescribed=np.zeros(3))])
