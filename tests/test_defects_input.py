"""What cannot be meant is refused, what changes nothing is remarked on, and what is saved is what
is read.
"""

from __future__ import annotations

import json
import os
import warnings
import zipfile
from concurrent.futures import ThreadPoolExecutor
from zlib import crc32

import numpy as np
import pytest
import threadpoolctl
from scipy.sparse import csr_matrix

import skfem_contact as sc
from tests.tools.helpers import grid, run_stages, vector_basis

SQUARE = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
2
1 2 2 1 1 1 2 3
2 2 2 1 1 1 3 4
$EndElements
"""


def model(shift=0.0, stretch=1.0):
    """A block that rests on another one."""
    base = grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 1, 3))
    block = grid("Q1", np.linspace(1, 3, 6), np.linspace(1, 2, 3))
    mesh = (
        sc.join_bodies({"base": base, "block": block})
        .scaled((1.0, stretch))
        .translated((shift, 0.0))
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(basis, "block:bottom", "base:top", sc.Coulomb(0.4), quadrature=2),
    }
    return (
        basis,
        forms,
        sc.weight(basis, {"base": 0.0, "block": 20.0}),
        basis.get_dofs("base:bottom").all(),
    )


def ground():
    basis = vector_basis(grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 2, 5)), "Q1", intorder=2)
    forms = {"ground": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))}
    return basis, forms, sc.weight(basis, 20.0), basis.get_dofs("bottom").all()


# -- what changes nothing
# -------------------------------------------------------------------------------------------


def test_stages_that_change_nothing():
    _, forms, load, fixed = ground()
    none = np.zeros(0, int)
    with pytest.warns(
        sc.AnalysisWarning,
        match="stage 'strut', the stage: `fixed` holds what is supported already",
    ):
        stages = [
            sc.Stage("weight", load),
            sc.Stage("strut", 0.5 * load, fixed=np.append(fixed, none)),
        ]
        sc.Model(forms, fixed).run(stages, progress=False)
    with pytest.warns(sc.AnalysisWarning, match="stage 'b', the stage: it changes nothing"):
        sc.Model(forms, fixed).run([sc.Stage("a", load), sc.Stage("b", load)], progress=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sc.Model(forms, fixed).run([sc.Stage("a", load), sc.Stage("b", 2.0 * load)], progress=False)


def test_water_that_presses_on_nothing():
    basis, *_ = ground()
    basis.mesh.boundaries["nowhere"] = np.zeros(0, int)
    with pytest.raises(ValueError, match=r"boundaries \['nowhere'\]: they are empty"):
        sc.water_load(basis, sc.hydrostatic(1.0, unit_weight=10.0), ["nowhere"])
    with pytest.warns(sc.AnalysisWarning, match="there is no water"):
        sc.water_load(basis, sc.hydrostatic(-5.0, unit_weight=10.0), ["top"])


def test_angles_in_radians():
    with pytest.warns(sc.AnalysisWarning, match=r"phi is 0.5236: angles are given in degrees"):
        sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=np.radians(30))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert (
            sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=30.0).reduced(50.0).phi < 1.0
        )  # derived, and meant


# -- files
# ----------------------------------------------------------------------------------------------------------


@pytest.fixture
def saved(tmp_path):
    _, forms, load, fixed = model()
    file = tmp_path / "good.npz"
    sc.Model(forms, fixed).run([sc.Stage("weight", load)], progress=False).save(file)
    return file, forms


@pytest.mark.parametrize(
    "content", [lambda d: b"", lambda d: d[: len(d) // 2], lambda d: b"hello", lambda d: d[:-900]]
)
def test_broken_files(saved, content):
    file, forms = saved
    file.write_bytes(content(file.read_bytes()))
    with pytest.raises(ValueError, match=r"good.npz cannot be read as a result"):
        sc.load_result(file, forms)


@pytest.mark.parametrize("key", ["0/x", "0/bodies/stress", "0/joint/status"])
def test_altered_files(saved, key):
    """A number that is not what was written, wherever."""
    file, forms = saved
    with np.load(file) as data:
        arrays = {name: data[name].copy() for name in data.files}
    arrays[key].flat[0] += 1
    np.savez_compressed(file, **arrays)
    with pytest.raises(
        ValueError, match=rf"good.npz cannot be read .*\['{key}'\] are not what was written"
    ):
        sc.load_result(file, forms)


@pytest.mark.parametrize(
    ("key", "value"),
    [("0/x", np.nan), ("0/load", np.inf), ("0/bodies/stress", np.nan), ("0/joint/status", 7)],
)
def test_altered_numbers_with_their_checksum(saved, key, value):
    """Values are checked, not only whether they are those that were written."""
    file, forms = saved
    with np.load(file) as data:
        arrays = {name: data[name].copy() for name in data.files}
    head = json.loads(str(arrays["head"]))
    arrays[key].flat[0] = value
    head["sums"][key] = crc32(arrays[key].tobytes())
    np.savez_compressed(file, **{**arrays, "head": np.array(json.dumps(head))})
    with pytest.raises(ValueError, match=rf"good.npz cannot be read .*'{key.split('/')[-1]}' of "):
        sc.load_result(file, forms)


def test_shorter_displacements_with_their_checksum(saved):
    file, forms = saved
    with np.load(file) as data:
        arrays = {name: data[name].copy() for name in data.files}
    head = json.loads(str(arrays["head"]))
    arrays["0/x"] = arrays["0/x"][:-1]
    head["sums"]["0/x"] = crc32(arrays["0/x"].tobytes())
    np.savez_compressed(file, **{**arrays, "head": np.array(json.dumps(head))})
    with pytest.raises(
        ValueError, match=r"good.npz cannot be read .*displacements and loads of shapes"
    ):
        sc.load_result(file, forms)


def test_flipped_bits(saved):
    """Whatever the damage breaks, the error names the file; a bit that nothing reads may be
    another.
    """
    file, forms = saved
    written, rng = file.read_bytes(), np.random.default_rng(1)
    refused = 0
    for at, bit in zip(
        rng.integers(len(written), size=100), rng.integers(8, size=100), strict=True
    ):
        flipped = bytearray(written)
        flipped[at] ^= 1 << int(bit)
        file.write_bytes(flipped)
        try:
            sc.load_result(file, forms)
        except ValueError as error:
            assert "good.npz" in str(error)
            refused += 1
    assert refused > 50


def test_size_beyond_the_memory(saved, tmp_path):
    file, forms = saved
    with zipfile.ZipFile(file) as old, zipfile.ZipFile(tmp_path / "huge.npz", "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "0/x.npy":
                start, end = content.index(b"(") + 1, content.index(b",)")
                shape = str(2**50).encode()
                content = (
                    content[:start]
                    + shape
                    + content[end:].replace(b" " * (len(shape) - end + start), b"", 1)
                )
            new.writestr(name, content)
    with pytest.raises(ValueError, match=r"huge.npz cannot be read as a result"):
        sc.load_result(tmp_path / "huge.npz", forms)


@pytest.mark.skipif(os.name == "nt", reason="modes and links are those of POSIX")
def test_saving_keeps_mode_and_link(saved, tmp_path):
    file, forms = saved
    other = tmp_path / "new.npz"
    other.touch()
    usual = other.stat().st_mode
    result = sc.load_result(file, forms)
    assert file.stat().st_mode == usual
    file.chmod(0o640)
    link = tmp_path / "link.npz"
    link.symlink_to(file)
    result.save(link)
    assert link.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o640
    assert sorted(path.name for path in tmp_path.iterdir()) == ["good.npz", "link.npz", "new.npz"]


@pytest.mark.parametrize(("shift", "stretch"), [(100.0, 1.0), (0.0, 2.0)])
def test_another_mesh_of_the_same_size(saved, shift, stretch):
    with pytest.raises(ValueError, match="'bodies' has another mesh"):
        sc.load_result(saved[0], model(shift, stretch)[1])


def test_an_older_layout(saved):
    """It is refused with the version that wrote it."""
    file, forms = saved
    np.savez_compressed(file, head=np.array('[{"name": "weight"}]'))
    with pytest.raises(
        ValueError, match=r"version 0\.1\.0 of this library wrote it, with another layout"
    ):
        sc.load_result(file, forms)


def test_a_file_is_replaced_when_the_new_one_is_complete(saved, monkeypatch):
    file, forms = saved
    before, result = file.read_bytes(), sc.load_result(file, forms)

    def full(*args, **kwargs):
        raise OSError("no space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(OSError, match="no space"):
        result.save(file)
    assert file.read_bytes() == before and [f.name for f in file.parent.iterdir()] == ["good.npz"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda s: "".join(
                f"{a} {b} 0 {c}\n"
                if len(p := line.split()) == 4
                and line[0] in "1234"
                and (a := p[0], b := p[1], c := p[2])
                else line + "\n"
                for line in s.splitlines()
            ),
            "x-y plane",
        ),
        (lambda s: s.replace("1 3 4\n", "1 3 9\n"), "out of bounds"),
        (lambda s: s.replace("2 1 0 0", "2 nan 0 0"), "not finite"),
    ],
)
def test_meshes_that_would_be_flattened_or_wrong(tmp_path, change, message):
    """The file is named."""
    file = tmp_path / "some.msh"
    file.write_text(change(SQUARE))
    with pytest.raises(ValueError, match=rf"some.msh: .*{message}"):
        sc.load_mesh(file)


# -- input
# ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"stages": lambda load: [sc.Stage("a", np.ma.masked_array(load, mask=load < 0))]},
            "not masked",
        ),
        ({"stages": lambda load: [sc.Stage("a", load + 1j)]}, "real numbers"),
        (
            {"stages": lambda load: (sc.Stage(n, load) for n in "ab")},
            "stages must be several values, each a Stage",
        ),
        ({"stages": lambda load: ["a"]}, "each a Stage"),
        ({"start": "x"}, "start must be a Result"),
        ({"newton": "x"}, "newton must be a Newton"),
    ],
)
def test_input_of_a_run(options, message):
    _, forms, load, fixed = model()
    make = options.pop("stages", lambda load: [sc.Stage("a", load)])
    with pytest.raises(ValueError, match=message):
        stages = make(load)
        run_stages(forms, stages, fixed, progress=False, **options)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sc.Newton(max_iterations=np.nan), "whole number"),
        (lambda: sc.Newton(tolerance="x"), "tolerance must be a finite number"),
        (lambda: sc.MohrCoulomb(E=1e4, nu=0.3, c=None, phi=30.0), "c must be a finite number"),
        (lambda: sc.join_bodies({1: grid("Q1", [0, 1], [0, 1])}), "bodies have names"),
        (lambda: ground()[1]["ground"].assemble(np.zeros(3), None), "3 displacements for 90 dofs"),
        (lambda: assembled_contact(-2), "88 displacements for 90 dofs"),
        (lambda: assembled_contact(50), "140 displacements for 90 dofs"),
    ],
)
def test_settings(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def assembled_contact(longer):
    """A contact pair is asked with displacements of a wrong length."""
    basis, forms, *_ = model()
    return forms["joint"].assemble(np.zeros(basis.N + longer), forms["joint"].initial_state())


#: Settings that are as they should be, by the class that takes them.
SETTINGS = {
    sc.Coulomb: {"mu": 0.3, "adhesion": 1.0, "tension": 1.0},
    sc.AugmentedLagrangian: {"tolerance": 1e-4},
    sc.Newton: {"tolerance": 1e-8, "max_iterations": 25},
    sc.LinearElastic: {"E": 1e3, "nu": 0.3},
    sc.MohrCoulomb: {"E": 1e3, "nu": 0.3, "c": 1.0, "phi": 30.0, "psi": 5.0},
    sc.Tresca: {"E": 1e3, "nu": 0.3, "c": 1.0},
    sc.VonMises: {"E": 1e3, "nu": 0.3, "strength": 1.0},
    sc.DruckerPrager: {"E": 1e3, "nu": 0.3, "k": 1.0, "alpha": 0.1, "beta": 0.1},
    sc.HardeningMohrCoulomb: {
        "E": 1e3,
        "nu": 0.3,
        "c": 1.0,
        "c_end": 0.5,
        "phi": 30.0,
        "phi_end": 20.0,
        "strain_end": 0.1,
        "psi": 5.0,
    },
    sc.HardeningSoil: {
        "E50_ref": 37e3,
        "Eoed_ref": 29.6e3,
        "Eur_ref": 90e3,
        "m": 0.5,
        "c": 1.0,
        "phi": 41.0,
        "psi": 14.0,
    },
    sc.Undrained: {"nu_undrained": 0.495},
    sc.water.VanGenuchten: {"alpha": 2.0, "n": 3.0, "least": 1e-6},
    sc.water.Ramp: {"width": 0.5, "least": 1e-3},
}
SOIL = sc.LinearElastic(E=1e3, nu=0.3)


@pytest.mark.parametrize("cls", SETTINGS, ids=lambda cls: cls.__name__)
@pytest.mark.parametrize(
    "wrong",
    [
        None,
        "x",
        np.nan,
        np.inf,
        -1.0,
        [1, "a"],
        [[1.0], [1.0, 2.0]],
        1j,
        True,
        np.ma.masked_array([0.5], mask=[True]),
    ],
    ids=str,
)
def test_settings_of_a_wrong_kind(cls, wrong):
    """One ValueError, which names the setting, for every field of every class of settings."""
    good = SETTINGS[cls]
    first = (SOIL,) if cls is sc.Undrained else ()
    cls(*first, **good)
    for name in good:
        with pytest.raises(ValueError, match=rf"{name}|either"):
            cls(*first, **{**good, name: wrong})


@pytest.mark.parametrize(
    "setting",
    [
        "slave",
        "master",
        "law",
        "quadrature",
        "penalty",
        "smoothing",
        "enforcement",
        "initial",
        "share",
        "tangent",
    ],
)
@pytest.mark.parametrize("wrong", ["x", np.nan, -1.0, [1, "a"], 1j], ids=str)
def test_settings_of_contact_of_a_wrong_kind(setting, wrong):
    basis, *_ = model()
    good = {"slave": "block:bottom", "master": "base:top", "law": sc.Coulomb(0.3)}
    with pytest.raises(ValueError):
        sc.ContactPair(basis, **{**good, setting: wrong})


@pytest.mark.parametrize(
    "setting", ["start", "end", "EA", "fixed_end", "yield_force", "tension_only", "part"]
)
@pytest.mark.parametrize("wrong", ["x", np.nan, [1, "a"], 1j], ids=str)
def test_settings_of_bars_of_a_wrong_kind(setting, wrong):
    basis, *_ = ground()
    good = {"start": (0.0, 2.0), "end": (0.0, 5.0), "EA": 1e3, "fixed_end": True}
    sc.Bar(basis, **good)
    with pytest.raises(ValueError):
        sc.Bar(basis, **{**good, setting: wrong})


class Impatient(sc.Form):
    """A user who stops the run when it has been asked so many times."""

    def __init__(self, n, calls):
        self.K, self.calls = csr_matrix((n, n)), calls

    def assemble(self, x, state):
        self.calls -= 1
        if self.calls < 0:
            raise KeyboardInterrupt
        return sc.Response(self.K @ x, lambda: None, lambda: self.K)


def test_a_run_that_is_stopped_by_hand():
    """Ctrl-C carries what was accepted."""
    basis, forms, load, fixed = model()
    forms["user"] = Impatient(basis.N, 40)
    with pytest.raises(KeyboardInterrupt) as stop:
        sc.Model(forms, fixed).run(
            [sc.Stage("first", load), sc.Stage("long", 2 * load, increments=1000)], progress=False
        )
    assert 0.0 < stop.value.result["long"].fraction < 1.0


def test_strains_that_round_off_hides():
    """They converge, or the message says why not."""
    _, forms, load, fixed = model()
    with pytest.raises(sc.NotConverged, match="round-off alone may leave"):
        sc.Model(forms, fixed, newton=sc.Newton(max_iterations=8)).run(
            [sc.Stage("a", 1e-8 * load)], progress=False
        )


def test_threads_are_given_back():
    """Runs side by side leave the number of threads as it was."""

    def threads():
        return [
            pool["num_threads"]
            for pool in threadpoolctl.threadpool_info()
            if pool["user_api"] == "blas"
        ]

    def job(n):
        _, forms, load, fixed = ground()
        return sc.Model(forms, fixed).run([sc.Stage("weight", load)], progress=False)

    job(0)
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        before = threads()
        with ThreadPoolExecutor(3) as pool:
            list(pool.map(job, range(9)))
        assert threads() == before
