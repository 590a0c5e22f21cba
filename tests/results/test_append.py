"""Increments that are appended to a file while an analysis runs, and read after it was killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.results import Append, Result, StageResult

#: Where processes find the tests.
ROOT = Path(__file__).parents[2]
#: A process that runs a stage for each increment, appends it, says so, and then hangs in the middle
#: of a record.
SCRIPT = """
    import sys, time
    from dataclasses import replace
    from tests.results.test_append import block, increments
    import skfem_contact as sc
    append = sc.results.Append({file!r})
    for increment in increments(*block()):
        append(increment)
        print("accepted", increment.name, increment.fraction, flush=True)
    with open({file!r}, "ab") as stream:
        stream.write(b"0123456789abcdef")
        stream.flush()
        print("writing", flush=True)
        time.sleep(60.)
"""


def block():
    basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    forms = {"soil": sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=0.3, c=5.0, phi=30.0))}
    return forms, sc.weight(basis, 20.0), basis.get_dofs("bottom").all()


def increments(forms, load, fixed):
    """Two increments of a first stage, three of a second one."""
    stages = [sc.Stage(str(k), k / 5 * load) for k in range(1, 6)]
    names = [("fill", 0.5), ("fill", 1.0), ("dig", 1 / 3), ("dig", 2 / 3), ("dig", 1.0)]
    for stage, (name, fraction) in zip(
        sc.Model(forms, fixed).run(stages, progress=False), names, strict=True
    ):
        yield replace(stage, name=name, fraction=fraction)


def same(stage, other):
    np.testing.assert_array_equal(stage.x, other.x)
    for key, values in vars(other.states["soil"]).items():
        np.testing.assert_array_equal(getattr(stage.states["soil"], key), values)
    assert (stage.name, stage.fraction, stage.iterations) == (
        other.name,
        other.fraction,
        other.iterations,
    )


@pytest.mark.skipif(os.name == "nt", reason="there is no SIGKILL")
def test_killed_run_leaves_all_accepted_increments(tmp_path):
    """[X] After kill -9 in the middle of a record the file holds all increments before it."""
    file = tmp_path / "run.records"
    script = textwrap.dedent(SCRIPT.format(file=str(file)))
    with subprocess.Popen(
        [sys.executable, "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as process:
        lines = []
        while "writing" not in (line := process.stdout.readline()):
            assert line, "the process ended"
            lines.append(line)
        process.send_signal(signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL and len(lines) == 5
    forms, load, fixed = block()
    expected = list(increments(forms, load, fixed))
    result = sc.load_result(file, forms)
    assert [stage.name for stage in result] == ["fill", "dig"]
    assert [len(stage.increments) for stage in result] == [2, 3]
    for part, other in zip(
        [*result["fill"].increments, *result["dig"].increments], expected, strict=True
    ):
        assert (part.name, part.fraction) == (other.name, other.fraction)
        np.testing.assert_allclose(
            part.x, other.x, atol=1e-12
        )  # another process may differ by round-off
        for key, values in vars(other.states["soil"]).items():
            np.testing.assert_allclose(
                getattr(part.states["soil"], key), values, rtol=1e-9, atol=1e-9
            )
    again = sc.Model(forms, fixed).run([sc.Stage("next", load)], start=result, progress=False)
    np.testing.assert_allclose(again["next"].x, expected[-1].x, atol=1e-12)


def test_every_cut_of_the_file_leaves_whole_increments(tmp_path):
    """[X] Wherever the last record ends, those before it are read; a new observer goes on behind
    them.
    """
    forms, load, fixed = block()
    append, sizes = Append(tmp_path / "run.records"), []
    parts = list(increments(forms, load, fixed))
    for part in parts[:3]:
        append(part)
        sizes.append(append.file.stat().st_size)
    whole = append.file.read_bytes()
    for size in (sizes[1] + 1, sizes[1] + 11, sizes[1] + 12, sizes[1] + 13, sizes[2] - 1):
        append.file.write_bytes(whole[:size])
        (fill,) = sc.load_result(append.file, forms)
        assert [part.fraction for part in fill.increments] == [0.5, 1.0]
    append.file.write_bytes(whole[: sizes[2] - 1] + b"!")  # the last record was damaged
    assert len(sc.load_result(append.file, forms)) == 1
    append = Append(append.file)
    for part in parts[2:]:
        append(part)
    assert [len(stage.increments) for stage in sc.load_result(append.file, forms)] == [2, 3]


def test_a_stage_that_is_run_again_replaces_the_older_one(tmp_path):
    forms, load, fixed = block()
    append = Append(tmp_path / "run.records")
    parts = list(increments(forms, load, fixed))
    for part in (*parts, parts[0]):
        append(part)
    (fill,) = sc.load_result(append.file, forms)
    assert len(fill.increments) == 1
    for part in parts[1:4]:
        append(part)
    assert [len(stage.increments) for stage in sc.load_result(append.file, forms)] == [2, 2]


def test_damage_before_the_last_record_is_told(tmp_path):
    """The records before the damage are read, and others follow them; a copy keeps the rest."""
    forms, load, fixed = block()
    append = Append(tmp_path / "run.records")
    parts = list(increments(forms, load, fixed))
    sizes = []
    for part in parts:
        append(part)
        sizes.append(append.file.stat().st_size)
    damaged = bytearray(append.file.read_bytes())
    damaged[sizes[1] + 100] ^= 255
    append.file.write_bytes(damaged)
    with pytest.warns(sc.AnalysisWarning, match="record 2 of .* is not what was written"):
        (fill,) = sc.load_result(append.file, forms)
    assert [part.fraction for part in fill.increments] == [0.5, 1.0]
    with pytest.warns(sc.AnalysisWarning, match=r"record 2 of .* new ones follow them"):
        append = Append(append.file)
    assert (tmp_path / "run.records.damaged").read_bytes() == damaged
    for part in parts[2:]:
        append(part)
    assert [len(stage.increments) for stage in sc.load_result(append.file, forms)] == [2, 3]


def test_other_files_are_not_appended_to(tmp_path):
    other = tmp_path / "other.npz"
    Result(()).save(other)
    with pytest.raises(
        ValueError, match=r"other\.npz is no file of appended increments: give it another name"
    ):
        Append(other)


@pytest.mark.skipif(os.name == "nt", reason="limits of file sizes are of POSIX")
@pytest.mark.parametrize("space", [5, 500])
def test_record_that_finds_no_space_is_taken_back(tmp_path, space):
    """[X] The disk is full within a record: the records before are there, and more follow later."""
    import resource

    forms, load, fixed = block()
    append = Append(tmp_path / "run.records")
    parts = list(increments(forms, load, fixed))
    for part in parts[:2]:
        append(part)
    size = append.file.stat().st_size
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size + space, limits[1]))
    try:
        with pytest.raises(OSError):
            append(parts[2])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, ignored)
    assert append.file.stat().st_size == size
    for part in parts[2:]:
        append(part)
    assert [len(stage.increments) for stage in sc.load_result(append.file, forms)] == [2, 3]


def test_kept_increments_are_saved(tmp_path):
    """[X] Increments of a stage come back from a file, the series for ParaView holds them with
    their times.
    """
    forms, load, fixed = block()
    parts = tuple(increments(forms, load, fixed))
    stage = replace(
        parts[1], time=2.0, increments=(replace(parts[0], time=1.0), replace(parts[1], time=2.0))
    )
    Result((stage,)).save(tmp_path / "kept")
    read = sc.load_result(tmp_path / "kept", forms)["fill"]
    assert isinstance(read, StageResult) and [part.time for part in read.increments] == [1.0, 2.0]
    for part, other in zip(read.increments, parts[:2], strict=True):
        same(part, other)
    series, *files = Result((read,)).to_pvd(tmp_path / "kept.pvd")
    assert (
        len(files) == 2
        and 'timestep="1"' in series.read_text()
        and 'timestep="2"' in series.read_text()
    )


RUN = """
    import sys, time
    from tests.results.test_append import block
    import skfem_contact as sc
    forms, load, fixed = block()
    append, seen = sc.results.Append({file!r}), []

    def observe(increment):
        append(increment)
        seen.append(increment)
        if len(seen) == 40:
            print("forty", flush=True)
            time.sleep(60.)

    stages = [sc.Stage("fill", load, increments=100)]
    sc.Model(forms, fixed).run(stages, on_increment=observe, progress=False)
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="there is no SIGKILL")
def test_run_of_a_hundred_increments_is_killed(tmp_path):
    """[X] All 40 increments that were accepted are in the file, and the analysis goes on from the
    last of them.
    """
    file = tmp_path / "run.records"
    script = textwrap.dedent(RUN.format(file=str(file)))
    with subprocess.Popen(
        [sys.executable, "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "forty\n"
        process.send_signal(signal.SIGKILL)
    forms, load, fixed = block()
    model = sc.Model(forms, fixed)
    last = sc.load_result(file, model)["fill"]
    np.testing.assert_allclose(
        [part.fraction for part in last.increments], np.arange(1, 41) / 100, atol=1e-12
    )
    whole = model.run([sc.Stage("fill", load, increments=100)], progress=False)["fill"]
    again = model.run([sc.Stage("rest", load, increments=60)], start=last, progress=False)["rest"]
    np.testing.assert_allclose(
        again.x, whole.x, atol=1e-6 * np.abs(whole.x).max()
    )  # tolerance of the iterations
