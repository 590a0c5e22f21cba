"""Pictures show the values they are given, and a machine without OpenGL gets a warning instead of a
crash.
"""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact import plot
from skfem_contact.contact.laws import Status
from skfem_contact.plot import sheet
from skfem_contact.plot.diagram import _ordinates
from skfem_contact.plot.scene import Cutaway, Scene, _volumes
from skfem_contact.plot.sheet import make_scale
from skfem_contact.results import Result, SectionForces, StageResult, Tractions
from tests.tools.helpers import ELEMENTS, IN_SPACE, grid, vector_basis

contour = sys.modules["skfem_contact.plot.contour"]  # the module; the package has its function
matplotlib.use("Agg")
ROOT = Path(__file__).parents[2]
needs_opengl = pytest.mark.skipif(not sheet._can_render(), reason="VTK cannot draw on this machine")
FOOT = sheet._FOOT


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    plt.close("all")
    plot.set_units()


def block(element="Q1"):
    """A stretched plate of 2 x 1: u_x = x / 10."""
    basis = vector_basis(grid(element, np.linspace(0, 2, 5), np.linspace(0, 1, 3)), element)
    forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0))}
    x = basis.zeros()
    x[0::2] = 0.1 * basis.doflocs[0, 0::2]
    states = {"block": forms["block"].assemble(x, forms["block"].initial_state()).state}
    return forms, StageResult("now", x, 0 * x, states, (), 0.0, forms=forms)


def shot(plotter):
    return plotter.screenshot(None, return_img=True)


def colored(image):
    """Pixels that are neither grey nor white."""
    return np.ptp(image[..., :3].astype(int), axis=2) > 12


# -- scales


def ones(values):
    return np.ones(len(values))


def test_levels_are_round_and_zero_is_one_of_them():
    values = np.linspace(-0.37, 1.13, 50)
    scale = make_scale(values, ones(values), None, 10, None)
    np.testing.assert_allclose(scale.levels, np.arange(-4, 13, 2) / 10, atol=1e-12)
    assert 0.0 in scale.levels and scale.extend == "neither"


def test_a_corner_does_not_spoil_the_scale():
    """A hundredth of the area at a thousand times the stress is beyond the arrow."""
    values = np.append(np.linspace(0.0, 10.0, 999), 5000.0)
    scale = make_scale(values, ones(values), None, 10, None)
    assert scale.levels[-1] <= 11.0 and scale.extend == "max"
    smooth = np.linspace(0.0, 10.0, 1000) ** 1.5
    assert make_scale(smooth, ones(smooth), None, 10, None).extend == "neither"


def test_both_signs_have_both_colors_and_zero_between_them():
    values = np.linspace(-2.0, 4.0, 40)
    scale = make_scale(values, ones(values), None, 10, None)
    colors = np.asarray(scale.colors.colors)
    below = scale.levels[:-1] < 0.0
    assert (colors[below, 2] > colors[below, 0]).all()  # blue
    assert (colors[~below, 0] > colors[~below, 2]).all()  # red
    pressed = make_scale(-values - 10.0, ones(values), None, 10, None)
    shades = np.asarray(pressed.colors.colors)[:, :3].sum(axis=1)
    assert (np.diff(shades) > 0).all()  # of one sign: the larger the darker


def test_given_limits_are_kept():
    values = np.linspace(0.0, 10.0, 20)
    scale = make_scale(values, ones(values), (0.5, 3.3), 10, None)
    assert (scale.levels[0], scale.levels[-1], scale.extend) == (0.5, 3.3, "both")
    for limits in ((3.0, 3.0), (0.0, np.nan)):
        with pytest.raises(ValueError, match="limits are two finite numbers"):
            make_scale(values, ones(values), limits, 10, None)


def test_constant_fields_have_a_scale():
    for value in (0.0, 7.0):
        levels = make_scale(np.full(5, value), np.ones(5), None, 10, None).levels
        assert levels[0] <= value <= levels[-1] and (np.diff(levels) > 0).all()


# -- contours


@needs_opengl
def test_names_in_capitals_give_the_same_files(tmp_path):
    """A picture is the same file, to the byte, whatever the case of its ending."""
    _, step = block(next(iter(ELEMENTS)))
    files = []
    for name in ("ux.png", "UX.PNG"):
        plot.contour(step, "ux", file=tmp_path / name)
        files.append((tmp_path / name).read_bytes())
    assert files[0] == files[1]


@needs_opengl
@pytest.mark.parametrize("element", ELEMENTS)
def test_contour_shows_the_field(element, tmp_path):
    """Eight bands from pale to dark over a field that rises from left to right; the file is
    written.
    """
    _, step = block(element)
    plot.contour(step, "ux", file=tmp_path / "ux.png", mesh=False, limits=(0.0, 0.2), levels=8)
    image = plt.imread(tmp_path / "ux.png")
    height, width = image.shape[:2]
    body = image[: height - FOOT, :, :3]
    assert width == 1400
    # the plate is twice as wide as high, with margins of 2.5 % of its length; pixels are whole
    np.testing.assert_allclose(height - FOOT, 1400 * 1.1 / 2.1, atol=2)
    row = body[len(body) // 2, 60:-60]
    shades = [color for color, left in itertools.pairwise(row) if np.array_equal(color, left)]
    bands = [shades[0]] + [b for a, b in itertools.pairwise(shades) if np.abs(a - b).max() > 0.03]
    assert len(bands) == 8
    assert (np.diff([band.sum() for band in bands]) < 0).all()  # darker and darker


@needs_opengl
def test_deformed_body_leaves_its_outline(tmp_path):
    """Ten times a tenth: the body becomes as wide again; its outline stays where it was."""
    _, step = block()
    plot.contour(
        step,
        "sxx",
        deformed=10.0,
        file=tmp_path / "sxx.png",
        limits=(0.0, 1e3),
        levels=1,
        mesh=False,
    )
    image = (255 * plt.imread(tmp_path / "sxx.png")).astype(int)
    body = image[: len(image) - FOOT]
    assert colored(body).any(axis=0).mean() == pytest.approx(1 / 1.05, abs=0.01)
    middle = body[len(body) // 3]
    inside = np.arange(100, body.shape[1] - 100)
    found = np.flatnonzero(np.abs(middle[inside, 0] - np.median(middle[inside, 0])) > 40)
    assert inside[found].mean() == pytest.approx(
        body.shape[1] / 2, abs=2
    )  # the right side of the undeformed plate


def test_automatic_factors_are_round():
    _, step = block()
    scene = Scene(step, "auto")
    assert scene.factor == pytest.approx(0.2)  # 4 % of 2 over 0.2 is 0.4, and 1, 2 and 5 are round
    assert Scene(replace(step, name="still", x=0 * step.x), "auto").factor == 1.0


@needs_opengl
def test_a_factor_of_one_is_not_written(bars):
    _, step = block()
    plot.set_units("kN", "m")
    plot.contour(step, "sxx", deformed=1.0)
    plot.contour(step, "ux", since=step, deformed=20.0)
    assert [texts[:2] for texts in bars] == [
        ("Horizontal stress [kPa]", "now"),
        ("Change of horizontal displacement [m]", "now, since now, displacements × 20"),
    ]


@needs_opengl
def test_extremes_stand_beside_the_colour_bar(bars):
    """[X] The corners of a block that is stretched evenly: values, coordinates before it moved, and
    stages.
    """
    forms, step = block()
    still = replace(
        step, name="before", x=0 * step.x, states={"block": forms["block"].initial_state()}
    )
    u = step.field("ux")
    plot.contour(step, "ux", deformed=20.0)
    plot.stages([still, step], "ux")
    x = step.forms["block"].basis.doflocs[:, 2 * int(u.argmax())]
    assert bars[0][2].endswith(f"largest {u.max():.4g} at ({x[0]:.4g}, {x[1]:.4g})")
    assert bars[1][2].endswith(" in now") and bars[1][2].startswith("smallest 0 at (")
    plot.contour(still, "ux")
    assert bars[2][2] == "0 everywhere"


@needs_opengl
def test_window_and_constant_field():
    _, step = block()
    image = shot(plot.contour(step, "uy", window=(0.5, 1.0, 0.0, 1.0)))
    assert image.shape[0] == 1000 + FOOT
    body = image[:1000, :, :3].reshape(-1, 3)
    assert (body != 255).any(axis=1).mean() > 0.9  # nothing but the plate is seen
    with pytest.raises(ValueError, match="a window is"):
        plot.contour(step, "uy", window=(1.0, 0.5, 0.0, 1.0))


@needs_opengl
def test_bodies_that_are_not_there_are_not_drawn():
    """The right of two plates has gone: the picture is that of the left one."""
    plate = grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3))
    basis = vector_basis(sc.join_bodies({"a": plate, "b": plate.translated((1.0, 0.0))}), "Q1")
    forms = {
        name: sc.SolidForm(basis.with_elements(name), sc.LinearElastic(E=1e3, nu=0.0))
        for name in "ab"
    }
    states = {"a": forms["a"].initial_state()}
    step = StageResult(
        "now", basis.zeros(), basis.zeros(), states, (), 0.0, forms={"a": forms["a"]}
    )
    image = shot(plot.contour(step, "uy", mesh=False))
    assert image.shape[:2] == (
        1000 + FOOT,
        1000,
    )  # a square of the largest height; two plates would be 1400 wide


@needs_opengl
def test_only_some_bodies_are_drawn():
    """One of two plates is asked for: the picture is that of it alone; other names are refused."""
    plate = grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3))
    basis = vector_basis(sc.join_bodies({"a": plate, "b": plate.translated((1.0, 0.0))}), "Q1")
    forms = {
        name: sc.SolidForm(basis.with_elements(name), sc.LinearElastic(E=1e3, nu=0.0))
        for name in "ab"
    }
    states = {name: form.initial_state() for name, form in forms.items()}
    step = StageResult("now", basis.zeros(), basis.zeros(), states, (), 0.0, forms=forms)
    assert shot(plot.contour(step, "uy", mesh=False)).shape[1] == 1400
    assert shot(plot.contour(step, "uy", mesh=False, bodies="b")).shape[:2] == (1000 + FOOT, 1000)
    with pytest.raises(ValueError, match="no solid 'c'; existing: a, b"):
        plot.contour(step, "uy", bodies=("a", "c"))


@needs_opengl
def test_borders_of_materials_are_sharp():
    """[X] Uniform strain in two materials: two colours with nothing between them."""
    basis = vector_basis(
        grid("Q1", np.linspace(0, 2, 5), np.linspace(0, 1, 3)).with_subdomains(
            {"left": lambda x: x[0] < 1, "right": lambda x: x[0] > 1}
        ),
        "Q1",
    )
    soils = {"left": sc.LinearElastic(E=1e3, nu=0.0), "right": sc.LinearElastic(E=4e3, nu=0.0)}
    forms = {"block": sc.SolidForm(basis, soils)}
    x = basis.zeros()
    x[0::2] = 0.1 * basis.doflocs[0, 0::2]
    states = {"block": forms["block"].assemble(x, forms["block"].initial_state()).state}
    step = StageResult("now", x, 0 * x, states, (), 0.0, forms=forms)
    image = shot(plot.contour(step, "sxx", mesh=False, limits=(0.0, 450.0), levels=9))
    row = image[350, 60:-60, :3].astype(int)
    _kinds, count = np.unique(row, axis=0, return_counts=True)
    assert (count > 100).sum() == 2


@needs_opengl
def test_marks_are_drawn_where_they_belong():
    """Supports below, loads above, the water table in the middle; without them nothing is outside
    of the plate.
    """
    forms, step = block()
    basis = forms["block"].basis
    load = basis.zeros()
    load[basis.get_dofs("top").all("u^2")] = -1.0
    plain = shot(plot.contour(step, "uy"))
    image = shot(
        plot.contour(
            step,
            "uy",
            supports=basis.get_dofs("bottom").all(),
            loads=load,
            water=sc.hydrostatic(0.5, unit_weight=9.81),
            vectors=True,
        )
    )
    height = len(image) - FOOT
    blue = (image[:height, :, 2].astype(int) - image[:height, :, 0] > 60).any(axis=1)
    assert np.flatnonzero(blue).mean() == pytest.approx(height / 2, rel=0.1)
    pink = (image[:height, :, 0].astype(int) - image[:height, :, 1] > 100).any(axis=1)
    assert np.flatnonzero(pink).max() < 0.35 * height
    dark = (image[:height, :, :3].max(axis=2) < 110).any(axis=1)
    margin = (plain[: len(plain) - FOOT, :, :3].max(axis=2) < 110).any(axis=1)
    # below the plate there is a margin of 8 % of its length with loads, and of 2.5 % on the plain
    # picture
    assert np.flatnonzero(dark).max() > (1.16 / 1.32 + 0.01) * height
    assert np.flatnonzero(margin).max() < (1.05 / 1.10 + 0.01) * (len(plain) - FOOT)


@pytest.mark.slow
@needs_opengl
def test_free_surface_is_the_water_table():
    """A seepage, its pressure and water at rest are drawn alike; the bar tells what the pore
    pressure is.
    """
    forms, step = block()
    basis = forms["block"].basis
    height = np.ptp(basis.mesh.p[1])
    water = sc.water.Flow(basis, 1.0, unit_weight=9.81).steady(
        sc.water.Conditions(head={"left": 0.5 * height})
    )
    pictures = [
        shot(plot.contour(step, "pore", water=given, mesh=False, colors="Greys"))
        for given in (sc.hydrostatic(0.5 * height, unit_weight=9.81), water, water.pressure_at)
    ]
    at_rest = replace(step, water_unit_weight=9.81)
    line = [(-100.0, 0.5 * height), (100.0, 0.5 * height)]
    for given in (0.5 * height, line):
        values = at_rest.field("pore", water=given)
        np.testing.assert_allclose(values, step.field("pore", water=water.pressure_at), atol=1e-9)
        picture = shot(plot.contour(at_rest, "pore", water=given, mesh=False, colors="Greys"))
        np.testing.assert_array_equal(picture, pictures[0])
    np.testing.assert_array_equal(
        shot(plot.contour(step, "uy", water=False)), shot(plot.contour(step, "uy"))
    )
    with pytest.raises(ValueError, match="give water=True"):
        step.field("pore", water=False)
    blue = [picture[:-FOOT, :, 2].astype(int) - picture[:-FOOT, :, 0] > 60 for picture in pictures]
    rows = [np.flatnonzero(marked.sum(axis=1) > 0.3 * marked.shape[1]).mean() for marked in blue]
    # the transition between wet and dry is a part of an element wide
    assert (
        rows[1]
        == rows[2]
        == pytest.approx(rows[0], abs=5)
        == pytest.approx(len(blue[0]) / 2, rel=0.1)
    )
    assert contour._headline(step, "pore", None, water) == "Pore pressure"
    assert contour._headline(step, "pore", None) == "Excess pore pressure"


@needs_opengl
@pytest.mark.slow
def test_points_that_yield_and_contact_are_in_the_legend():
    from skfem_contact.demo import culvert
    from skfem_contact.plot.marks import Marks

    stage = culvert().result["surcharge"]
    marks = Marks(stage, points=True, contact=True)
    assert [label for label, _ in marks.legend()] == ["yields", "contact sticks"]
    with_marks = shot(
        plot.contour(stage, "mobilised", points=True, contact=True, window=(-1, 1, -1, 1))
    )
    without = shot(plot.contour(stage, "mobilised", window=(-1, 1, -1, 1)))
    assert (
        np.abs(with_marks[:-FOOT].astype(int) - without[:-FOOT]).max(axis=2).astype(bool).mean()
        > 0.005
    )


def test_stages_share_the_factor_of_the_one_that_has_moved_most():
    """A stage that has not moved at all does not count."""
    forms, step = block()
    still = replace(
        step, name="before", x=0 * step.x, states={"block": forms["block"].initial_state()}
    )
    less = replace(step, name="less", x=0.1 * step.x)
    views = contour.contours([still, less, step], "ux", deformed="auto").views
    assert [view.scene.factor for view in views] == [pytest.approx(0.2)] * 3


@pytest.mark.slow
@needs_opengl
def test_stages_share_a_scale_and_a_film_has_frames(tmp_path):
    forms, step = block()
    still = replace(
        step, name="before", x=0 * step.x, states={"block": forms["block"].initial_state()}
    )
    image = shot(plot.stages([still, step], "ux"))
    half = image.shape[1] // 2
    body = image[: len(image) - FOOT]
    assert len(np.unique(body[200, 40 : half - 40, :3], axis=0)) < 6  # one colour and mesh lines
    assert len(np.unique(body[200, half + 40 : -40, :3], axis=0)) > 6
    pytest.importorskip("imageio")
    import imageio.v3

    file = plot.animate([still, step], "ux", tmp_path / "film.gif", deformed=1.0, frames=4)
    assert imageio.v3.improps(file).n_images >= 3  # equal ones are kept as one
    with pytest.raises(ValueError, match=r"a film is a \.gif or an \.mp4 file"):
        plot.animate([step], "ux", tmp_path / "film.avi")
    with pytest.raises(ValueError, match="no stage to draw"):
        plot.stages([], "ux")


@needs_opengl
def test_views_stand_apart_below_their_titles():
    """[X] White columns of the gap's width between views that fill their windows; titles, also long
    ones, above.
    """
    _, step = block()
    names = ("short", "a name that is too long for one of three views side by side", "last")
    steps = [replace(step, name=name) for name in names]
    image = shot(plot.stages(steps, "ux", window=(0.5, 1.5, 0.2, 0.8)))[:-FOOT]
    white = (image[..., :3] == 255).all(axis=(0, 2))
    begins, ends = (
        np.flatnonzero(np.diff(white.astype(int)) == 1),
        np.flatnonzero(np.diff(white.astype(int)) == -1),
    )
    assert len(begins) == len(ends) == 2
    np.testing.assert_allclose(ends - begins, sheet._GAP, atol=2)  # parts of a pixel on both sides
    titles = image[: sheet._HEAD - 1]
    assert not colored(titles).any() and colored(image[sheet._HEAD + 1 :])[:, ~white].mean() > 0.9
    dark = (titles[..., :3] < 100).all(axis=2).any(axis=0)
    assert dark[: begins[0]].any() and dark[ends[0] : begins[1]].any() and dark[ends[1] :].any()


@needs_opengl
def test_a_notebook_shows_the_picture():
    _, step = block()
    plotter = plot.contour(step, "ux", mesh=False)
    shown = plt.imread(BytesIO(plotter._repr_png_()))
    assert shown.shape[:2] == shot(plotter).shape[:2]
    assert colored(255 * shown).mean() > 0.3


@needs_opengl
def test_a_window_without_a_display_is_warned_of_and_the_file_written(tmp_path, monkeypatch):
    monkeypatch.setattr(sheet, "_has_windows", lambda: False)
    _, step = block()
    with pytest.warns(UserWarning, match="this machine has no display"):
        plot.contour(step, "ux", file=tmp_path / "ux.png", show=True)
    assert (tmp_path / "ux.png").stat().st_size > 1000


def test_unknown_field_is_refused_before_anything_is_drawn():
    _, step = block()
    with pytest.raises(ValueError, match="no field 'pressure'; existing"):
        plot.contour(step, "pressure")


def test_no_opengl_is_said_once_and_clearly(monkeypatch):
    monkeypatch.setattr(sheet, "_can_render", lambda: False)
    _, step = block()
    with pytest.warns(
        UserWarning, match=r"no picture of 'Horizontal displacement': .* needs OpenGL"
    ):
        assert plot.contour(step, "ux") is None


def test_displays_that_vtk_has_opened_are_not_tried_in_another_process(monkeypatch):
    monkeypatch.setattr(sheet, "_kind_of_window", lambda: "vtkEGLRenderWindow")
    monkeypatch.setattr(sheet, "subprocess", None)
    assert sheet._can_render.__wrapped__()


@pytest.mark.parametrize(
    "missing",
    [
        {"VTK_DEFAULT_OPENGL_WINDOW": "vtkOSOpenGLRenderWindow"},
        {"__EGL_VENDOR_LIBRARY_FILENAMES": "missing", "DISPLAY": ""},
        {"MESA_GL_VERSION_OVERRIDE": "2.1", "DISPLAY": ""},
    ],
)
@pytest.mark.one_in(3)
def test_missing_opengl_library_does_not_crash(tmp_path, missing):
    """VTK is made to use a library that most machines lack, which kills the process that tries to
    draw.
    """
    code = (
        "import skfem_contact.plot as plot; from tests.plot.test_plot import block; _, step = "
        f"block(); print('drawn' if plot.contour(step, 'ux', file={str(tmp_path / 'ux.png')!r}) "
        "else 'no picture')"
    )
    environment = {**os.environ, **missing, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() in ("drawn", "no picture")
    assert ("no picture of 'Horizontal displacement'" in done.stderr) == (
        done.stdout.strip() == "no picture"
    )


def test_ring_diagram_is_closed_and_styled(tmp_path):
    angle = np.array([270.0, 0.0, 90.0, 180.0])
    first, second = np.array([4.0, 1.0, 2.0, 3.0]), np.array([40.0, -10.0, 20.0, 30.0])
    series = {"gravity": first, "surcharge": second}
    figure = plot.diagram(series, "moment [kNm/m]", angle=angle, file=tmp_path / "m.png")
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
    status = np.array([Status.STICK, Status.SLIP, Status.OPEN])
    pressure, shear = np.array([3.0, 2.0, 0.0]), np.array([-1.0, 1.0, 0.0])
    joint = Tractions(
        y + 3.0, zero, y, zero, pressure, shear, zero, zero, status, zero, pressure, shear
    )
    figure = plot.diagram({"failure": joint}, along="y")
    for axes, values in zip(figure.axes, (pressure, shear)):
        line, circles = axes.lines
        np.testing.assert_array_equal(line.get_xdata(), values)
        np.testing.assert_array_equal(line.get_ydata(), y)
        np.testing.assert_array_equal(circles.get_xydata(), [[values[1], -2.0]])
    lying = plot.diagram({"failure": joint})
    np.testing.assert_array_equal(lying.axes[0].lines[0].get_xdata(), y + 3.0)


def test_section_diagram_runs_downwards():
    s = np.array([0.0, 1.0, 2.0])
    forces = SectionForces(s, 0 * s, -s, N=-s, V=2 * s, M=3 * s)
    figure = plot.diagram({"pile": forces}, upright=True)
    assert all(axes.yaxis_inverted() for axes in figure.axes)
    for axes, values in zip(figure.axes, (-s, 2 * s, 3 * s)):
        np.testing.assert_array_equal(axes.lines[0].get_xdata(), values)
    assert not plot.diagram({"wall": forces}).axes[0].yaxis_inverted()
    (axes,) = plot.diagram(forces, "M").axes
    assert axes.get_ylabel() == "moment M" and axes.get_legend() is None
    with pytest.raises(ValueError, match="not of ndarray"):
        plot.diagram({"wall": s})


def cut():
    """The collapse of a vertical cut in clay under its weight."""
    basis = vector_basis(grid("P2", np.linspace(0, 5, 7), np.linspace(0, 5, 7)), "P2", intorder=2)
    forms = {"cut": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.3, c=10.0))}
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("right").all("u^1"))
    return forms, sc.Model(forms, fixed).limit_load(sc.weight(basis, 5.0), progress=False)


@needs_opengl
def test_mechanism_has_its_factor_in_the_title(bars):
    _, found = cut()
    image = shot(plot.mechanism(found, vectors=False))
    title = f"Limit load {found.value:.4g}, about {found.added:.1%} too high: shear strain"
    assert bars[0][0].startswith(title) and bars[0][1] == ""
    body = image[: len(image) - FOOT].astype(int)
    red = (body[..., 0] - body[..., 2] > 150) & (body[..., 1] < 100)
    rows, columns = np.nonzero(red)
    assert len(rows) > 500
    # the band falls from the right towards the foot on the left: image rows count downwards
    assert np.corrcoef(rows, columns)[0, 1] < -0.5


@needs_opengl
def test_mechanism_of_bounds_is_drawn_on_its_own_mesh(bars):
    """[X] A cut of 5 m in clay: the title has both bounds, and the shear strain is that of the
    quadratic velocities.
    """
    from skfem_contact.plot.mechanism import _upper_bound

    forms, _ = cut()
    basis = forms["cut"].basis
    fixed = np.append(basis.get_dofs("bottom").all(), basis.get_dofs("right").all("u^1"))
    found = sc.Model(forms, fixed).bounds(weight=5.0, gap=0.3, elements=300, progress=False)
    plot.mechanism(found)
    assert bars[0][0].startswith(f"Factor of safety in [{found.lower:.4g}, {found.upper:.4g}]")
    stage, _ = _upper_bound(found)
    at_corners = stage.x[stage.forms["mechanism"].basis.nodal_dofs]
    np.testing.assert_array_equal(at_corners, found.mechanism[:, : found.mesh.nvertices])


def test_curve_ends_at_the_limit():
    _, found = cut()
    (axes,) = plot.load_curve(found).axes
    assert axes.lines[0].get_ydata()[-1] == pytest.approx(found.value, rel=0.02)
    assert axes.get_ylabel() == "limit load"
    # the curve begins without load and displacement
    assert axes.lines[0].get_xydata()[0].tolist() == [0.0, 0.0] and axes.get_ylim()[0] == 0.0


def test_history_shows_the_nearest_nodes():
    forms, step = block()
    still = replace(
        step, name="before", x=0 * step.x, states={"block": forms["block"].initial_state()}
    )
    plot.set_units("N", "mm")
    (axes,) = plot.history(
        Result((still, step)), "ux", {"right": (2.0, 1.0), "middle": (1.01, 0.5)}
    ).axes
    np.testing.assert_allclose([line.get_ydata() for line in axes.lines], [[0.0, 0.2], [0.0, 0.1]])
    assert axes.get_ylabel() == "horizontal displacement [mm]"
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["before", "now"]


def test_history_of_the_water_of_stages():
    """[X] The pressure of each stage's own water at a point 2 m below the first level, which then
    falls.
    """
    basis = vector_basis(grid("Q1", [0.0, 1.0, 2.0], [0.0, 1.0, 2.0]), "Q1", intorder=2)
    model = sc.Model(
        {"soil": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3))},
        sc.box_supports(basis),
        water_unit_weight=10.0,
    )
    result = model.run([sc.Stage("full", water=2.0), sc.Stage("low", water=0.5)], progress=False)
    (axes,) = plot.history(result, "pore", {"base": (0.0, 0.0)}, water=True).axes
    np.testing.assert_allclose(axes.lines[0].get_ydata(), [20.0, 5.0])
    assert axes.get_ylabel().startswith("pore pressure")


def test_history_refuses_points_outside_and_tells_of_bodies_that_touch():
    """[X] Two plates of their own motion that touch at x = 1: nodes there have one value or the
    other.
    """
    mesh = sc.join_bodies(
        {"left": grid("Q1", [0, 0.5, 1], [0, 1]), "right": grid("Q1", [1, 2], [0, 1])}
    )
    basis = vector_basis(mesh, "Q1")
    forms = {
        name: sc.SolidForm(basis.with_elements(name), sc.LinearElastic(E=1e3, nu=0.0))
        for name in mesh.subdomains
    }
    states = {name: form.initial_state() for name, form in forms.items()}
    x = basis.zeros()
    x[basis.nodal_dofs[0]] = np.where(
        np.isin(np.arange(mesh.nvertices), mesh.t[:, mesh.subdomains["left"]]), 1.0, 3.0
    )
    result = Result((StageResult("now", x, 0 * x, states, (), 0.0, forms=forms),))
    with pytest.warns(
        sc.AnalysisWarning, match="at point 'joint' bodies touch whose values differ by up to 2:"
    ):
        plot.history(result, "ux", {"joint": (1, 0)})
    figure = plot.history(result, "ux", {"left": (0.4, 0), "a little outside": (3, 1)})
    assert [float(line.get_ydata()[0]) for line in figure.axes[0].lines] == [1.0, 3.0]
    with pytest.raises(
        ValueError,
        match=r"'far' lies outside the bodies: the nearest node, at \(2, 1\), is 1.5 away",
    ):
        plot.history(result, "ux", {"far": (2, 2.5)})
    with pytest.raises(ValueError, match="point 'here' has 2"):
        plot.history(result, "ux", {"here": (0, 0, 0)})
    with pytest.raises(ValueError, match="there is no field 'settlement'; existing: "):
        plot.history(result, "settlement", {"here": (0, 0)})


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"levels": 0}, "at least one level .* not levels=0"),
        ({"colors": "rainbows"}, "a colour map of matplotlib.* colors='rainbows'"),
        (
            {"window": (4, 5, 0, 1)},
            r"the window \(4, 5, 0, 1\) shows nothing of the bodies, .* \(0, 0\) and \(2, 1\)",
        ),
        ({"loads": np.zeros(3)}, "loads have 3 dofs, the bodies 30"),
    ],
)
@needs_opengl
def test_arguments_of_pictures_that_draw_nothing_are_refused(wrong, message):
    with pytest.raises(ValueError, match=message):
        plot.contour(block()[1], "ux", **wrong)


def test_series_that_do_not_fit_are_refused():
    section = SectionForces(*np.zeros((6, 3)))
    for values, options, message in (
        ({}, {}, r"series of one kind, not \[\]"),
        ({"a": section, "b": np.zeros(3)}, {}, r"one kind, not \['SectionForces', 'ndarray'\]"),
        (
            {"a": np.zeros(5)},
            {"angle": np.zeros(4)},
            r"values of 'a', \(5,\), do not fit the angles, \(4,\)",
        ),
    ):
        with pytest.raises(ValueError, match=message):
            plot.diagram(values, "M", **options)
    for picture in (plot.mechanism, plot.load_curve):
        with pytest.raises(ValueError, match=r"result of strength_reduction .* not a StageResult"):
            picture(block()[1])


def test_diagram_stands_on_the_structure():
    """Ordinates to the left of the axis, the longest 28 % of its length; extremes are written."""
    _, step = block()
    s = np.linspace(0.0, 2.0, 5)
    forces = SectionForces(s, s, 0.5 + 0 * s, N=0 * s, V=0 * s, M=s * (2.0 - s) * 10.0)
    (axes,) = plot.diagram(forces, "M", on=step).axes
    tips = axes.lines[0].get_xydata()
    np.testing.assert_allclose(tips[:, 0], s)
    np.testing.assert_allclose(tips[:, 1], 0.5 + 0.28 * 2.0 * s * (2.0 - s))
    assert {text.get_text() for text in axes.texts} == {"10"}  # 0 is below 1 %
    with pytest.raises(
        ValueError, match="no quantity of SectionForces 'pressure'; existing: M, N, V"
    ):
        plot.diagram(forces, "pressure", on=step)


def test_tractions_are_drawn_as_the_slave_exerts_them():
    """[X] Their sum is the opposite of what the report says of the slave; normals are those of the
    undeformed slave.
    """
    from skfem_contact.demo import culvert
    from skfem_contact.results.tractions import interfaces

    model = culvert()
    stage = model.result["surcharge"]
    (interface,) = interfaces(stage).values()
    t, normal = interface.tractions, interface.normal
    against = np.column_stack((-normal[:, 1], normal[:, 0]))
    total = (t.weight[:, None] * (t.pressure[:, None] * normal + t.shear[:, None] * against)).sum(
        axis=0
    )
    report = stage.contact("skin")
    scale = (t.weight * t.pressure).sum()
    np.testing.assert_allclose(total / scale, -report.force / scale, atol=0.01)
    data = interface.on_facets()
    assert (
        len(data["pressure"]) == 72
        and np.isfinite(data["pressure"]).all()
        and (data["status"] == 1).all()
    )


@needs_opengl
def test_an_own_picture(tmp_path):
    """Principal strains as arrows, which no function here draws: from `to_pyvista` in a few
    lines.
    """
    import pyvista

    _, step = block()
    grid = step.to_pyvista()
    values, directions = np.linalg.eigh(
        [[[s[0], s[3] / 2], [s[3] / 2, s[1]]] for s in grid.point_data["strain"]]
    )
    grid["first"] = np.pad(values[:, -1:] * directions[:, :, -1], ((0, 0), (0, 1)))
    np.testing.assert_allclose(
        np.abs(grid["first"]), [[0.1, 0, 0]] * grid.n_points, atol=1e-12
    )  # u_x = x / 10
    plotter = pyvista.Plotter(off_screen=True, window_size=(300, 200))
    plotter.add_mesh(grid.glyph(orient="first", scale="first", factor=2.0), color="red")
    plotter.view_xy()
    plotter.screenshot(tmp_path / "own.png")
    plotter.close()
    assert colored(plt.imread(tmp_path / "own.png") * 255).any()


def cube(element):
    """A cube in space in two regions: u_z = z / 10."""
    mesh = IN_SPACE[element][0].init_tensor(*3 * [np.linspace(0, 1, 3)])
    mesh = mesh.with_subdomains({"low": lambda x: x[2] < 0.5, "high": lambda x: x[2] > 0.5})
    basis = vector_basis(mesh, element, intorder=4)
    materials = {name: sc.LinearElastic(E=1e3, nu=0.0) for name in ("low", "high")}
    forms = {"cube": sc.SolidForm(basis, materials, strain="full")}
    x = basis.zeros()
    x[2::3] = 0.1 * basis.doflocs[2, 2::3]
    states = {"cube": forms["cube"].assemble(x, forms["cube"].initial_state()).state}
    return forms, StageResult("now", x, 0 * x, states, (), 0.0, forms=forms)


@needs_opengl
@pytest.mark.parametrize("element", IN_SPACE)
def test_cutaway(element, monkeypatch):
    """What is drawn of a cube of which a part is cut away: its volume, its field and lines on all
    of its faces.
    """
    drawn = []
    monkeypatch.setattr(Cutaway, "draw", lambda scene, *_: drawn.append(scene))
    _, step = cube(element)
    plot.cutaway(step, "uz", cuts=[((0, -1, 0), (0, 0.25, 0)), ((3, 0, 0), (0.5, 0, 0))])
    (scene,) = drawn
    volumes = np.abs(scene.kept.compute_cell_sizes()["Volume"])
    assert volumes.sum() == pytest.approx(0.5 * 0.75, rel=1e-6)  # VTK's points are single
    values, sizes = scene.samples
    np.testing.assert_allclose(values, 0.1 * scene.kept.points[:, 2], atol=1e-7)
    np.testing.assert_allclose(sizes.sum(), 0.5 * 0.75, rtol=1e-6)
    np.testing.assert_allclose(_volumes(scene.straight).sum(), 1.0, rtol=1e-6)
    scene.planes = scene.planes[:1]
    points = np.concatenate([lines.points for lines, _ in scene.edges(True)])
    assert points[:, 1].min() == 0.25 and np.any(
        (points[:, 1] == 0.25) & (points[:, 2] == 0.5)
    )  # also between regions


@pytest.mark.slow
@needs_opengl
def test_cutaway_is_seen():
    """The cube from the side is a square, the half that a cut leaves is twice as wide as high; both
    have colours.
    """
    _, step = cube("Q1")
    look = {"towards": (-1, 0.1, -0.1), "limits": (-0.1, 0.1)}
    whole = shot(plot.cutaway(step, "uz", **look))
    half = shot(plot.cutaway(step, "uz", cuts=[((0, 0, 1), (0, 0, 0.5))], mesh=False, **look))
    for image, ratio in ((whole, 1.0), (half, 0.5)):
        seen = np.argwhere(colored(image[:-FOOT]))
        wide, high = np.ptp(seen, axis=0)[::-1]
        assert high / wide == pytest.approx(ratio, rel=0.25)  # seen from a little above and aside
    for message, refused in {
        "normal": lambda: plot.cutaway(step, "uz", cuts=[((0, 0, 0), (0, 0, 0))]),
        "not zero": lambda: plot.cutaway(step, "uz", towards=(0, 0, 0)),
        "leave nothing": lambda: plot.cutaway(step, "uz", cuts=[((0, 0, 1), (0, 0, -1))]),
        "in space": lambda: plot.cutaway(block()[1], "uy"),
        "does not draw contact": lambda: plot.cutaway(step, "uz", contact=True),
    }.items():
        with pytest.raises(ValueError, match=message):
            refused()


def test_ordinates_at_a_node_of_a_ring_are_one_point():
    """[X] Geometry: M = 1 around a ring of radius 3 has all tips at the radius 2, one a node.

    At the corner of a frame both elements have their own ordinates, across each.
    """
    angle = np.linspace(0.0, 2.0 * np.pi, 25)
    ring = np.column_stack((3.0 * np.cos(angle), 3.0 * np.sin(angle)))
    corners = np.array([(0.0, 0.0), (0.0, 3.0), (3.0, 3.0)])
    for points, smooth in ((ring[:-1], True), (corners, False)):
        cells = np.column_stack((np.arange(len(points)), np.arange(1, len(points) + 1)))
        cells = cells % len(points) if smooth else cells[:-1]
        x, y = points[cells.ravel()].T
        lengths = np.linalg.norm(points[cells[:, 1]] - points[cells[:, 0]], axis=1)
        ends = np.cumsum(lengths)
        position = np.column_stack((ends - lengths, ends)).ravel()
        one = np.ones(len(x))
        forces = SectionForces(x=x, y=y, position=position, N=one, V=one, M=one)
        line = _ordinates(forces, "M")
        tips = (line.axis + line.ordinate[:, None] * line.left).reshape(-1, 2, 2)
        apart = np.linalg.norm(tips[1:, 0] - tips[:-1, 1], axis=1)
        assert line.closed == smooth
        if smooth:
            np.testing.assert_allclose(apart, 0.0, atol=1e-9)
            np.testing.assert_allclose(np.linalg.norm(tips, axis=2), 2.0, atol=1e-9)
        else:
            np.testing.assert_allclose(apart, np.sqrt(2.0), atol=1e-9)
