"""What is seen while an analysis runs: bars, log lines, pictures, early ends, and a notebook that
is interrupted.
"""

from __future__ import annotations

import logging
import re
import sys

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
import skfem_contact.display as display
import skfem_contact.plot as plot
import skfem_contact.stages.run as running

#: A column that consolidates nothing and yields nowhere: increments are as many as asked for.
CELLS = (
    """import os, signal, sys
sys.modules["ipywidgets"] = None  # bars are text without widgets
import skfem_contact as sc, skfem_contact.plot as plot
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
soil = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=.3, c=50., phi=0.), unit_weight=20.)
model = sc.Model({"soil": soil}, basis.get_dofs("bottom").all())""",
    """live = plot.live("uy", seconds=0.)
result = model.run([sc.Stage("weight", increments=3)], on_increment=live)
result""",
    "result.table()",
    """def stop(stage):
    if stage.name == "slow" and len(stage.iterations) == 2:
        os.kill(os.getpid(), signal.SIGINT)  # the button of a notebook
slow = sc.Stage("slow", model.traction("top", (0., -10.)), increments=5)
model.run([sc.Stage("first"), slow], on_increment=stop)""",
    """kept = sys.last_value.result
print([(stage.name, round(stage.fraction, 3), len(stage.iterations)) for stage in kept])""",
)


def column(E: float = 1e3) -> sc.Model:
    """A square of soil on its bottom."""
    basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    return sc.Model(
        {"soil": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.3), unit_weight=20.0)},
        basis.get_dofs("bottom").all(),
    )


@pytest.mark.slow
def test_notebook_shows_bars_tables_and_pictures_and_keeps_what_was_accepted() -> None:
    """A notebook is executed cell by cell; the last cell reads what an interrupted run has
    accepted.
    """
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    nbclient.NotebookClient(book, timeout=600, allow_errors=True).execute()
    outputs = [cell["outputs"] for cell in book.cells]
    assert not any(part["output_type"] == "error" for k in (0, 1, 2, 4) for part in outputs[k]), (
        outputs
    )
    bars = "".join(part.get("text", "") for part in outputs[1] if part["output_type"] == "stream")
    assert (
        "weight (1/1)" in bars
        and "3 increments" in bars
        and "displacement" in bars
        and "left" in bars
    )
    pictures = [part for part in outputs[1] if "image/png" in part.get("data", {})]
    assert len(pictures) == 1  # one that has changed
    assert any("<table" in part.get("data", {}).get("text/html", "") for part in outputs[1])
    assert "displacement at" in outputs[2][0]["data"]["text/html"]
    assert [part["ename"] for part in outputs[3] if part["output_type"] == "error"] == [
        "KeyboardInterrupt"
    ]
    printed = "".join(part["text"] for part in outputs[4] if part["output_type"] == "stream")
    assert "[('first', 1.0, 1), ('slow', 0.4, 2)]" in printed


def test_log_has_a_line_now_and_then(caplog, monkeypatch) -> None:
    """Without bars: the end of every stage, and increments when some seconds have passed since the
    last line.
    """
    stages = [
        sc.Stage("one", increments=4),
        sc.Stage("two", column().traction("top", (0.0, -5.0)), increments=2),
    ]
    with caplog.at_level(logging.INFO, logger="skfem_contact"):
        column().run(stages, progress=False)
        ends = [r.getMessage() for r in caplog.records if "left" in r.getMessage()]
        caplog.clear()
        monkeypatch.setattr(display, "_SELDOM", -1.0)
        monkeypatch.setattr(running, "_SHOWN", -1.0)  # however fast increments are
        column().run(stages, progress=False)
        every = [r.getMessage() for r in caplog.records if "left" in r.getMessage()]
        caplog.clear()
        column().run(stages, progress=True)
        shown = [r for r in caplog.records if "left" in r.getMessage()]
    assert [line[:24] for line in ends] == ["stage 'one' (1 of 2): 10", "stage 'two' (2 of 2): 10"]
    assert len(every) == 6
    assert re.match(
        r"stage 'one' \(1 of 2\): 50%, 2 increments, \d iterations, displacement 0\.0\d+, 00:0\d",
        every[1],
    )
    assert ends[-1].endswith("00:00 left") and shown == []


def test_time_that_is_left(monkeypatch) -> None:
    """[X] Half of the second of four stages after 30 s: 30 s for 1.5 stages leave 50 s for 2.5."""
    clock = iter((0.0, 0.0, 30.0, 30.0))
    monkeypatch.setattr(display, "perf_counter", lambda: next(clock))
    seen: list[str] = []
    progress = display.Bars(False, 4)
    with progress.stage("one"):
        pass
    with progress.stage("two"):
        progress._bar.set_postfix_str = seen.append
        monkeypatch.setattr(display, "perf_counter", lambda: 30.0)
        progress.update(0.5, 7, 31, 0.01234)
    assert seen == ["7 increments, 31 iterations, displacement 0.0123, 00:50 left"]


def test_live_picture_is_written_outside_of_notebooks(tmp_path) -> None:
    """The file changes with the stages; without a notebook and without a file there is nothing to
    show.
    """
    with pytest.raises(ValueError, match="notebook; elsewhere give a file="):
        plot.live("uy")
    file, sizes = tmp_path / "live.png", []
    draw = plot.live("uy", file=file, seconds=1e9)

    def observe(stage) -> None:
        draw(stage)
        sizes.append((round(stage.fraction, 3), file.read_bytes()[:4]))

    column().run([sc.Stage("weight", increments=3)], on_increment=observe)
    assert [size[1] for size in sizes] == [b"\x89PNG"] * 3
    assert draw._next > 1e8  # no increment before is drawn again


def test_displacements_beyond_the_model_end_a_run() -> None:
    """A modulus in the wrong unit: the run ends in the third of forty increments, with a word on
    units.
    """
    message = r"displacements, .* exceed the size of the bodies, 1\.41.* same units"
    with pytest.raises(sc.NotConverged, match=message) as end:
        column(E=1.0).run([sc.Stage("weight", increments=40)])
    stage = end.value.result["weight"]
    assert stage.fraction == pytest.approx(len(stage.iterations) / 40)
    u = np.abs(stage.x).max()
    assert np.sqrt(2.0) < u < np.sqrt(2.0) * len(stage.iterations) / (len(stage.iterations) - 1.5)


def test_large_motions_of_supports_are_no_failure() -> None:
    """A block that is carried by its own supports over three times its size."""
    model = column()
    held = model.forms["soil"].basis.get_dofs("bottom").all("u^1")
    moved = np.zeros(model.layout.size)
    moved[held] = 5.0
    result = model.run([sc.Stage("carry", prescribed=moved, increments=4)])
    assert result["carry"].fraction == 1.0


def test_the_same_failure_three_times_ends_a_run() -> None:
    """A block that is glued to a smooth base is pushed: nothing resists it, and three increments
    show that. Without glue a linear program would show it after one.
    """
    base = MeshQuad.init_tensor(np.linspace(0, 6, 7), np.linspace(0, 3, 4)).with_defaults()
    block = MeshQuad.init_tensor(np.linspace(2, 4, 4), np.linspace(3, 5, 4)).with_defaults()
    basis = Basis(
        sc.join_bodies({"base": base, "block": block}), ElementVector(ElementQuad1()), intorder=2
    )
    bodies = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=20.0)
    glue = sc.Coulomb(mu=0.0, tension=1.0)
    joint = sc.ContactPair(basis, slave="block:bottom", master="base:top", law=glue)
    model = sc.Model({"bodies": bodies, "joint": joint}, basis.get_dofs("base:bottom").all())
    log = logging.getLogger("skfem_contact")
    cuts: list[str] = []
    handler = logging.Handler()
    handler.emit = lambda record: cuts.append(record.getMessage())  # type: ignore[method-assign]
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    try:
        with pytest.raises(sc.NotConverged, match="nothing resists a motion in any increment"):
            model.run([sc.Stage("push", model.traction("block:left", (5.0, 0.0)))])
    finally:
        log.removeHandler(handler)
        log.setLevel(logging.NOTSET)
    assert sum("failed, cut to" in text for text in cuts) == 3


def test_versions(capsys, monkeypatch) -> None:
    """The package, Python, what is used, what is not installed and what it is for, and threads."""
    sc.show_versions()
    text = capsys.readouterr().out
    lines = dict(line.split(None, 1) for line in text.splitlines())
    assert lines["skfem_contact"] == sc.__version__ and lines["numpy"] == np.__version__
    assert lines["Python"] == ".".join(map(str, sys.version_info[:3]))
    monkeypatch.setattr(
        "skfem_contact.versions._of", lambda name: None if name in ("gmsh", "numpy") else "1.0"
    )
    sc.show_versions()
    text = capsys.readouterr().out
    assert "not installed: meshes" in text and "threads" in text and "missing" in text
