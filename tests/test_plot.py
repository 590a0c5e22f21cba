"""Pictures show the values they are given, and a machine without OpenGL gets a warning instead of a crash."""

from __future__ import annotations

import os
import subprocess
import sys
from io import BytesIO
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from helpers import ELEMENTS, grid, vector_basis

import skfem_contact as sc
from skfem_contact import plot
from skfem_contact.plot import contours

matplotlib.use("Agg")
ROOT = Path(__file__).parents[1]
needs_opengl = pytest.mark.skipif(not contours._can_render(), reason="VTK cannot draw on this machine")


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    plt.close("all")


def block(element="Q1"):
    """A stretched plate of 2 x 1: u_x = x / 10."""
    basis = vector_basis(grid(element, np.linspace(0, 2, 5), np.linspace(0, 1, 3)), element)
    forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0))}
    x = basis.zeros()
    x[0::2] = 0.1 * basis.doflocs[0, 0::2]
    states = {"block": forms["block"].assemble(x, forms["block"].initial_state()).state}
    return forms, sc.StageResult("now", x, 0 * x, states, (), 0.0)


def colored(image):
    """Pixels that are neither grey nor white."""
    return np.ptp(image[..., :3].astype(int), axis=2) > 30


@needs_opengl
@pytest.mark.parametrize("element", ELEMENTS)
def test_contour_shows_the_field(element, tmp_path):
    """A field that rises from left to right: dark violet on the left, yellow on the right; the file is written."""
    forms, step = block(element)
    plotter = plot.contour(forms, step, "ux", file=tmp_path / "ux.png", edges=False)
    image = plt.imread(tmp_path / "ux.png")
    height, width = image.shape[:2]
    body = image[: height - 120, :, :3]
    assert width == 1400
    np.testing.assert_allclose(height - 120, 700, atol=2)  # the plate is twice as wide as high; pixels are whole
    row = body[len(body) // 2]
    assert row[60, 2] > row[60, 1] + 0.2  # violet
    assert row[-60, 0] > 0.9 > 0.3 > row[-60, 2]  # yellow
    assert plotter.scalar_bar.GetLookupTable().GetTableRange() == (0.0, pytest.approx(0.2))


@needs_opengl
def test_deformed_body_leaves_its_outline(tmp_path):
    """Ten times a tenth: the body becomes as wide again; its outline stays where it was."""
    forms, step = block()
    plot.contour(forms, step, "sxx", deformed=10.0, file=tmp_path / "sxx.png", limits=(0.0, 200.0), edges=False)
    image = (255 * plt.imread(tmp_path / "sxx.png")).astype(int)
    body = image[: len(image) - 120]
    share = colored(body).any(axis=0).mean()
    assert share == pytest.approx(1 / 1.04, abs=0.01)  # the frame's margin is 2 % on each side
    assert body.shape[1] / body.shape[0] == pytest.approx(4, rel=0.01)
    middle = body[len(body) // 2]
    inside = np.arange(100, body.shape[1] - 100)
    (line,) = np.flatnonzero(np.abs(middle[inside, 0] - np.median(middle[inside, 0])) > 90)
    assert inside[line] == pytest.approx(body.shape[1] / 2, abs=2)  # the right side of the undeformed plate


@needs_opengl
def test_window_and_constant_field(tmp_path):
    forms, step = block()
    plotter = plot.contour(forms, step, "uy", window=(0.5, 1.0, 0.0, 1.0))
    image = plotter.screenshot(None, return_img=True)
    plotter.close()
    assert image.shape[0] / image.shape[1] == pytest.approx((1000 + 120) / 700, rel=0.01)
    assert colored(image[:900]).mean() > 0.6  # half as wide as high, in the least width of 700


@needs_opengl
def test_bodies_that_are_not_there_are_not_drawn():
    """The right of two plates has gone: the picture is that of the left one."""
    plate = grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3))
    basis = vector_basis(sc.join_bodies({"a": plate, "b": plate.translated((1.0, 0.0))}), "Q1")
    forms = {name: sc.SolidForm(basis.with_elements(name), sc.LinearElastic(E=1e3, nu=0.0)) for name in "ab"}
    step = sc.StageResult("now", basis.zeros(), basis.zeros(), {"a": forms["a"].initial_state()}, (), 0.0)
    image = plot.contour(forms, step, "uy", edges=False).screenshot(None, return_img=True)
    assert image.shape[:2] == (1000 + 120, 1000)  # a square of the largest height; two plates would be 1400 wide


@needs_opengl
def test_a_notebook_shows_the_picture():
    forms, step = block()
    plotter = plot.contour(forms, step, "ux", edges=False)
    shown = plt.imread(BytesIO(plotter._repr_png_()))
    assert shown.shape[:2] == plotter.screenshot(None, return_img=True).shape[:2]
    assert colored(255 * shown).mean() > 0.3


def test_unknown_field_is_refused_before_anything_is_drawn():
    forms, step = block()
    with pytest.raises(ValueError, match="no field 'pressure'; existing"):
        plot.contour(forms, step, "pressure")


def test_no_opengl_is_said_once_and_clearly(monkeypatch):
    monkeypatch.setattr(contours, "_can_render", lambda: False)
    forms, step = block()
    with pytest.warns(UserWarning, match=r"no picture of 'ux': .* needs OpenGL"):
        assert plot.contour(forms, step, "ux") is None


def test_missing_opengl_library_does_not_crash(tmp_path):
    """VTK is made to use a library that most machines lack, which kills the process that tries to draw."""
    code = (
        "import test_plot, skfem_contact.plot as plot; forms, step = test_plot.block(); "
        f"print('drawn' if plot.contour(forms, step, 'ux', file={str(tmp_path / 'ux.png')!r}) else 'no picture')"
    )
    environment = {**os.environ, "VTK_DEFAULT_OPENGL_WINDOW": "vtkOSOpenGLRenderWindow",
                   "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "tests")))}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() in ("drawn", "no picture")
    assert ("no picture of 'ux'" in done.stderr) == (done.stdout.strip() == "no picture")


def test_ring_diagram_is_closed_and_styled(tmp_path):
    angle = np.array([270.0, 0.0, 90.0, 180.0])
    first, second = np.array([4.0, 1.0, 2.0, 3.0]), np.array([40.0, -10.0, 20.0, 30.0])
    series = {"gravity": first, "surcharge": second}
    figure = plot.ring_diagram(angle, series, "moment [kNm/m]", file=tmp_path / "m.png")
    polar, plain = figure.axes
    assert (tmp_path / "m.png").stat().st_size > 0
    for axes in (polar, plain):
        dashed, solid = axes.lines[:2]
        assert (dashed.get_linestyle(), solid.get_linestyle()) == ("--", "-")
        np.testing.assert_array_equal(dashed.get_ydata(), [1, 2, 3, 4, 1])
        np.testing.assert_array_equal(solid.get_ydata(), [-10, 20, 30, 40, -10])
    np.testing.assert_array_equal(plain.lines[0].get_xdata(), [0, 90, 180, 270, 360])
    assert polar.get_theta_direction() == -1  # clockwise
    assert polar.get_theta_offset() == pytest.approx(np.pi / 2)  # from the crown
    assert polar.get_ylim()[0] < -10
    assert [text.get_text() for text in plain.get_legend().get_texts()] == ["gravity", "surcharge"]
    assert plain.get_ylabel() == "moment [kNm/m]"


def test_contact_diagram_marks_what_slips():
    y, zero = np.array([-3.0, -2.0, -1.0]), np.zeros(3)
    status = np.array([sc.Status.STICK, sc.Status.SLIP, sc.Status.OPEN])
    pressure, shear = np.array([3.0, 2.0, 0.0]), np.array([-1.0, 1.0, 0.0])
    joint = sc.Tractions(y + 3.0, zero, y, pressure, shear, zero, zero, status, zero)
    figure = plot.contact_diagram({"failure": joint}, along="y")
    for axes, values in zip(figure.axes, (pressure, shear)):
        line, circles = axes.lines
        np.testing.assert_array_equal(line.get_xdata(), values)
        np.testing.assert_array_equal(line.get_ydata(), y)
        np.testing.assert_array_equal(circles.get_xydata(), [[values[1], -2.0]])
    lying = plot.contact_diagram({"failure": joint})
    np.testing.assert_array_equal(lying.axes[0].lines[0].get_xdata(), y + 3.0)


def test_section_diagram_runs_downwards():
    s = np.array([0.0, 1.0, 2.0])
    forces = sc.SectionForces(s, 0 * s, -s, N=-s, V=2 * s, M=3 * s)
    figure = plot.section_diagram({"pile": forces}, upright=True)
    assert all(axes.yaxis_inverted() for axes in figure.axes)
    for axes, values in zip(figure.axes, (-s, 2 * s, 3 * s)):
        np.testing.assert_array_equal(axes.lines[0].get_xdata(), values)
    assert not plot.section_diagram({"wall": forces}).axes[0].yaxis_inverted()
