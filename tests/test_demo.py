"""The demonstration: what the paper says of its culvert, equilibrium, files, machines without
graphics.
"""

from __future__ import annotations

import re
import runpy
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import meshio
import numpy as np
import pytest
from numpy import ndarray

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.contact.laws import Status
from skfem_contact.demo import Culvert, culvert, main
from skfem_contact.results import SectionForces, StageResult, Tractions

ROOT = Path(__file__).parents[1]
STAGES = ("gravity", "surcharge")
PICTURES = {"culvert.png", "pressure.png", "friction.png", "moment.png", "thrust.png"}
FILES = {"gravity.vtu", "surcharge.vtu", "culvert.npz"}
INNER, OUTER = 0.72, 0.90  # radii of the pipe


class Check(NamedTuple):
    """A statement about the result: its title, the computed value, the expected one, and whether it
    holds.
    """

    what: str
    ours: str
    expected: str
    holds: bool


def checks(model: Culvert) -> list[Check]:
    """Compare the result with the statements of the paper, equilibrium and symmetry."""
    stages = list(model.result)
    skin = [clockwise(model, stage) for stage in stages]
    points = len(skin[0].pressure)
    weight = abs(model.gravity[pipe(model)].sum())
    lifted = max(np.abs(carried(model, stage) - (0.0, weight)).max() / weight for stage in stages)
    missing = max(out_of_balance(model, stage) for stage in stages)
    uneven = [np.abs(p.pressure[1:] - p.pressure[:0:-1]).max() / p.pressure.max() for p in skin]
    stick = [np.count_nonzero(p.status == Status.STICK) for p in skin]
    opened = [np.count_nonzero(p.status == Status.OPEN) for p in skin]
    lowest = skin[1].central_angle()[skin[1].pressure.argmin()]
    waves = [np.fft.rfft(section_forces(model, stage).M) for stage in stages]
    rhythm = [int(np.abs(wave[1:]).argmax()) + 1 for wave in waves]
    turned = float(np.degrees(np.angle(waves[0][2] / waves[1][2]))) / 2.0
    return [
        Check(what, ours, expected, bool(holds))
        for what, ours, expected, holds in (
            (
                "contact forces on the pipe less its weight",
                f"{lifted:.0e}",
                "< 1e-6 of it",
                lifted < 1e-6,
            ),
            ("section forces against the tractions", f"{missing:.2%}", "< 1 %", missing < 0.01),
            ("gravity: asymmetry of the pressure", f"{uneven[0]:.0e}", "< 1e-6", uneven[0] < 1e-6),
            (
                "surcharge: asymmetry of the pressure",
                f"{uneven[1]:.0%}",
                "not symmetric",
                uneven[1] > 0.05,
            ),
            (
                "points that stick, in both stages",
                f"{stick[0]}, {stick[1]}",
                f"{points}",
                min(stick) == points,
            ),
            (
                "points that are open, in both stages",
                f"{opened[0]}, {opened[1]}",
                "none",
                max(opened) == 0,
            ),
            (
                "surcharge: smallest pressure at",
                f"{lowest:.0f} degrees",
                "90 degrees",
                abs(lowest - 90) < 6,
            ),
            (
                "waves of the moment in both stages",
                f"{rhythm[0]}, {rhythm[1]}",
                "same",
                rhythm[0] == rhythm[1],
            ),
            (
                "surcharge: shift of the moment",
                f"{turned:.1f} degrees",
                "shifted",
                abs(turned) > 1.0,
            ),
        )
    ]


def section_forces(model: Culvert, stage: StageResult) -> SectionForces:
    """Return section forces of the pipe at cuts through its nodes, from the crown clockwise."""
    return stage.section_forces("culvert", sc.Cuts.ring((0.0, 0.0), INNER, OUTER, n=72))


def carried(model: Culvert, stage: StageResult) -> ndarray:
    """Return the sum of the contact forces on the pipe's nodes, (2,); a form's force is what the
    nodes must hold.
    """
    force = model.forms["skin"].assemble(stage.x, stage.states["skin"]).force
    return -force[pipe(model)].reshape(-1, 2).sum(axis=0)


def out_of_balance(model: Culvert, stage: StageResult) -> float:
    """Check equilibrium of the parts of the ring from the crown to every cut: tractions, weight and
    section forces.

    Return the largest missing force as a share of the largest thrust, or the largest missing moment
    as a share of the largest moment, whichever is greater.
    """
    points, ring = clockwise(model, stage), section_forces(model, stage)
    weight = abs(model.gravity[pipe(model)].sum()) / len(points.pressure)
    angle = np.radians(ring.position)
    out = np.stack((np.sin(angle), np.cos(angle)))
    along = np.stack((np.cos(angle), -np.sin(angle)))
    middle = 0.5 * (INNER + OUTER)

    # what acts at a point; a point on the cut counts by half
    load = points.weight * (points.shear * along - points.pressure * out) - weight * np.array(
        [[0.0], [1.0]]
    )
    moment = (
        points.weight * points.shear * OUTER + weight * middle * out[0]
    )  # about the centre, clockwise
    section = np.vstack((ring.N * along + ring.V * out, ring.M + middle * ring.N))
    acting = np.vstack((load, moment))
    between = np.cumsum(acting, axis=1) - 0.5 * (acting + acting[:, :1])
    missing = np.abs(section - section[:, :1] + between).max(axis=1)
    return float(max(missing[:2].max() / np.abs(ring.N).max(), missing[2] / np.abs(ring.M).max()))


def pipe(model: Culvert) -> ndarray:
    """Return the dofs of the pipe."""
    return np.unique(model.forms["culvert"].basis.element_dofs)


def clockwise(model: Culvert, stage: StageResult) -> Tractions:
    """Return tractions on the pipe from the crown clockwise."""
    points = stage.tractions("skin")
    order = np.argsort(points.central_angle())
    return replace(points, **{name: values[order] for name, values in vars(points).items()})


@pytest.fixture(scope="module")
def model() -> Culvert:
    return culvert()


def test_checks_hold(model: Culvert) -> None:
    """[P], [X] The paper's statements, equilibrium and symmetry."""
    assert [check.what for check in checks(model) if not check.holds] == []


def test_check_fails_for_another_load(model: Culvert) -> None:
    """[X] A pipe that is told to be heavier than it was is not carried by the ground, nor in
    equilibrium.
    """
    heavier = model._replace(gravity=1.5 * model.gravity)
    failed = [check.what for check in checks(heavier) if not check.holds]
    assert failed == [
        "contact forces on the pipe less its weight",
        "section forces against the tractions",
    ]


@pytest.mark.parametrize("stage", STAGES)
def test_supports_and_contact_carry_the_loads(model: Culvert, stage: str) -> None:
    """[X] Internal and contact forces balance the load at every free unknown, so their sums balance
    as a whole.
    """
    step = model.result[stage]
    force = sum(
        form.assemble(step.x, step.states[name]).force for name, form in model.forms.items()
    )
    at_bottom = model.basis.get_dofs("bottom").all("u^2")
    # Newton stops at 1e-8 of the load
    np.testing.assert_allclose(
        force[at_bottom].sum() - step.load[at_bottom].sum(), -step.load[1::2].sum(), rtol=1e-7
    )


def test_pipe_carries_more_after_the_surcharge(model: Culvert) -> None:
    """[P] Moment and thrust keep their rhythm and grow: the strip lies above the pipe's right
    half.
    """
    cuts = sc.Cuts.ring((0.0, 0.0), 0.72, 0.90, n=72)
    before, after = (model.result[k].section_forces("culvert", cuts) for k in STAGES)
    assert np.ptp(after.M) > 1.2 * np.ptp(before.M)
    assert after.N.min() < 1.1 * before.N.min() < 0.0


def test_tutorial_is_the_same_analysis(model: Culvert, monkeypatch: pytest.MonkeyPatch) -> None:
    """The flat script of the tutorial and the demonstration describe one model."""
    script = str(ROOT / "examples" / "6_tunnels_and_pipes" / "plot_buried_culvert.py")
    monkeypatch.setattr(sys, "argv", [script])
    monkeypatch.setattr(plt, "show", lambda: None)
    monkeypatch.setattr(plot, "contour", lambda *_, **__: None)
    tutorial = runpy.run_path(script)["result"]
    plt.close("all")
    for stage in STAGES:
        # two runs of the same steps: round-off
        np.testing.assert_allclose(tutorial[stage].x, model.result[stage].x, atol=1e-12)


@pytest.mark.slow
def test_command_line_writes_all_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Tables in the terminal, pictures and files in the folder, and the saved result is the
    computed one.
    """
    out = tmp_path / "a" / "b"
    assert main(["--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == PICTURES | FILES
    text = capsys.readouterr().out
    assert "72 stick, 0 slip, 0 open" in text
    assert all(name in text for name in (str(out), *PICTURES, *FILES))

    model = culvert()
    saved = sc.load_result(out / "culvert.npz", model.forms)
    np.testing.assert_allclose(
        saved["surcharge"].x, model.result["surcharge"].x, atol=1e-12
    )  # round-off
    nodes = [
        np.unique(model.basis.mesh.t[:, model.basis.mesh.subdomains[soil]])
        for soil in ("soft", "stiff")
    ]
    border = len(np.intersect1d(*nodes))  # regions share no points
    assert (
        len(meshio.read(out / "gravity.vtu").points)
        == model.basis.N // 2 + border
        > model.basis.N // 2
    )


@pytest.mark.slow
def test_without_graphics_everything_else_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A machine without OpenGL costs one picture, and one line says so."""
    monkeypatch.setattr(
        plot, "contour", lambda *_, **__: warnings.warn("VTK cannot draw", stacklevel=2)
    )
    assert main(["--out", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == (PICTURES | FILES) - {"culvert.png"}
    printed = capsys.readouterr()
    assert [line for line in printed.out.splitlines() if "culvert.png" in line] == [
        "No culvert.png: VTK cannot draw on this machine, it needs OpenGL."
    ]
    assert "Warning" not in printed.err


@pytest.mark.slow
def test_slope_is_shown_and_others_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """[P] Griffiths and Lane (1999), example 2: a factor of 1.4; its report and curve are
    written.
    """
    out = tmp_path / "slope"
    assert main(["slope", "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == {"slope.html", "curve.png"}
    printed = capsys.readouterr().out
    # published with two digits
    assert 1.35 < float(re.search(r"factor of safety (\d\.\d+),", printed)[1]) < 1.45
    assert "culvert         a buried culvert" in printed.split("also shows:")[1]
    with pytest.raises(SystemExit):
        main(["tunnel"])
    assert "'culvert', 'slope'" in capsys.readouterr().err.replace(
        "culvert, slope", "'culvert', 'slope'"
    )


def test_folder_that_is_a_file_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file is not overwritten by a folder."""
    file = tmp_path / "notes.txt"
    file.write_text("mine")
    with pytest.raises(SystemExit) as stop:
        main(["--out", str(file)])
    assert stop.value.code == 2
    assert "is a file" in capsys.readouterr().err
    assert file.read_text() == "mine"
