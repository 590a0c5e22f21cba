"""The demonstration: what the paper says of its culvert, equilibrium, files, machines without graphics."""

from __future__ import annotations

import runpy
import sys
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import meshio
import numpy as np
import pytest

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.demo import Culvert, checks, culvert, main

ROOT = Path(__file__).parents[1]
STAGES = ("gravity", "surcharge")
PICTURES = {"culvert.png", "pressure.png", "friction.png", "moment.png", "thrust.png"}
FILES = {"gravity.vtu", "surcharge.vtu", "culvert.npz"}


@pytest.fixture(scope="module")
def model() -> Culvert:
    return culvert()


def test_checks_hold(model: Culvert) -> None:
    """[P], [X] The paper's statements, equilibrium and symmetry, as the demonstration prints them."""
    assert [check.what for check in checks(model) if not check.holds] == []


def test_check_fails_for_another_load(model: Culvert) -> None:
    """[X] A pipe that is told to be heavier than it was is not carried by the ground, nor in equilibrium."""
    heavier = model._replace(gravity=1.5 * model.gravity)
    failed = [check.what for check in checks(heavier) if not check.holds]
    assert failed == ["contact forces on the pipe less its weight", "section forces against the tractions"]


@pytest.mark.parametrize("stage", STAGES)
def test_supports_and_contact_carry_the_loads(model: Culvert, stage: str) -> None:
    """[X] Internal and contact forces balance the load at every free unknown, so their sums balance as a whole."""
    step = model.result[stage]
    force = sum(form.assemble(step.x, step.states[name]).force for name, form in model.forms.items())
    at_bottom = model.basis.get_dofs("bottom").all("u^2")
    # Newton stops at 1e-8 of the load
    np.testing.assert_allclose(force[at_bottom].sum() - step.load[at_bottom].sum(), -step.load[1::2].sum(), rtol=1e-7)


def test_pipe_carries_more_after_the_surcharge(model: Culvert) -> None:
    """[P] Moment and thrust keep their rhythm and grow: the strip lies above the pipe's right half."""
    cuts = sc.Sections.ring((0.0, 0.0), 0.72, 0.90, n=72)
    before, after = (model.result[k].section_forces("culvert", cuts) for k in STAGES)
    assert np.ptp(after.M) > 1.2 * np.ptp(before.M)
    assert after.N.min() < 1.1 * before.N.min() < 0.0


def test_tutorial_is_the_same_analysis(model: Culvert, monkeypatch: pytest.MonkeyPatch) -> None:
    """The flat script of the tutorial and the demonstration describe one model."""
    script = str(ROOT / "examples" / "3_geotechnics" / "plot_buried_culvert.py")
    monkeypatch.setattr(sys, "argv", [script])
    monkeypatch.setattr(plt, "show", lambda: None)
    monkeypatch.setattr(plot, "contour", lambda *_, **__: None)
    tutorial = runpy.run_path(script)["result"]
    plt.close("all")
    for stage in STAGES:
        # two runs of the same steps: round-off
        np.testing.assert_allclose(tutorial[stage].x, model.result[stage].x, atol=1e-12)


def test_command_line_writes_all_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Tables in the terminal, pictures and files in the folder, and the saved result is the computed one."""
    out = tmp_path / "a" / "b"
    assert main(["--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == PICTURES | FILES
    text = capsys.readouterr().out
    assert "72 stick, 0 slip, 0 open" in text
    assert "FAILED" not in text
    assert all(name in text for name in (str(out), *PICTURES, *FILES))

    model = culvert()
    saved = sc.load_result(out / "culvert.npz", model.forms)
    np.testing.assert_allclose(saved["surcharge"].x, model.result["surcharge"].x, atol=1e-12)  # round-off
    nodes = [np.unique(model.basis.mesh.t[:, model.basis.mesh.subdomains[soil]]) for soil in ("soft", "stiff")]
    border = len(np.intersect1d(*nodes))  # regions share no points
    assert len(meshio.read(out / "gravity.vtu").points) == model.basis.N // 2 + border > model.basis.N // 2


def test_without_graphics_everything_else_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A machine without OpenGL costs one picture, and one line says so."""
    monkeypatch.setattr(plot, "contour", lambda *_, **__: warnings.warn("VTK cannot draw", stacklevel=2))
    assert main(["--out", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == (PICTURES | FILES) - {"culvert.png"}
    printed = capsys.readouterr()
    assert [line for line in printed.out.splitlines() if "culvert.png" in line] == [
        "No culvert.png: VTK cannot draw on this machine, it needs OpenGL."]
    assert "Warning" not in printed.err


def test_folder_that_is_a_file_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A file is not overwritten by a folder."""
    file = tmp_path / "notes.txt"
    file.write_text("mine")
    with pytest.raises(SystemExit) as stop:
        main(["--out", str(file)])
    assert stop.value.code == 2
    assert "is a file" in capsys.readouterr().err
    assert file.read_text() == "mine"
