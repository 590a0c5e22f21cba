"""Reports: what they hold, templates, early ends, files, and what a browser makes of them."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import warnings
from base64 import b64decode
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
import pyvista
from skfem import Basis, ElementQuad1, ElementQuad2, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.errors import AnalysisWarning
from skfem_contact.plot.model import shades
from skfem_contact.results import Result

DOCS = Path(__file__).parents[2] / "docs"


def pit() -> tuple[sc.Model, Result]:
    """Ground of two layers with a wall and an anchor <&>: at rest, dug, and loaded on wet
    ground.
    """
    mesh = (
        MeshQuad.init_tensor(np.linspace(0, 8, 9), np.linspace(0, 6, 7))
        .with_defaults()
        .with_subdomains(
            {
                "rock": lambda x: x[1] < 2,
                "sand": lambda x: (x[1] > 2) & ((x[0] > 4) | (x[1] < 4)),
                "lift": lambda x: (x[0] < 4) & (x[1] > 4),
            }
        )
        .with_boundaries({"wall": lambda x: (x[0] == 4) & (x[1] > 2)}, False)
    )
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    soil = {
        "rock": sc.LinearElastic(E=1e6, nu=0.2),
        "sand": sc.MohrCoulomb(E=2e4, nu=0.3, c=20.0, phi=30.0),
    }
    ground = sc.SolidForm(
        basis.with_elements(["rock", "sand"]), soil, unit_weight={"rock": 22.0, "sand": 18.0}
    )
    lift = sc.SolidForm(basis.with_elements("lift"), soil["sand"], unit_weight=18.0)
    wall = sc.Beam(basis, "wall", EI=5e4, EA=5e6)
    nail = sc.Beam(None, np.linspace((4.4, 4.9), (7.4, 4.3), 4), EI=10.0, EA=1e5)
    anchor = sc.Bar(basis, (8.0, 6.0), (4.0, 6.0), EA=1e4, spacing=2.0)
    forms = {
        "ground": ground,
        "lift": lift,
        "wall": wall,
        "nail": nail,
        "skin": sc.Embedded(basis, nail, T_max=30.0),
        "anchor <&>": anchor,
    }
    model = sc.Model(forms, sc.box_supports(basis), water_unit_weight=10.0)
    return model, model.run(
        [
            sc.Stage("at rest", deactivate=["wall", "nail", "skin", "anchor <&>"]),
            sc.Stage("wall", activate=["wall", "nail", "skin", "anchor <&>"]),
            sc.Stage(
                "dig & pull",
                model.traction("right", (-5.0, 0.0)),
                deactivate="lift",
                water=1.0,
                increments=2,
            ),
        ]
    )


@pytest.fixture(scope="module")
def result() -> Result:
    return pit()[1]


@pytest.fixture(scope="module")
def report(result, tmp_path_factory) -> Path:
    """The report of the pit, with a picture of one's own."""
    plot.set_units("kN", "m")
    figure, _ = plt.subplots()
    before = plt.get_fignums()
    file = result.report(
        tmp_path_factory.mktemp("report") / "pit.html",
        title="Pit <A>",
        pictures={"A long name " * 12: figure},
    )
    plot.set_units()
    assert len(plt.get_fignums()) == len(before) - 1  # none of the report's own stays open
    return file


def cantilever() -> Result:
    """A result without solids, whose report has no picture of VTK."""
    beam = sc.Beam(None, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], EI=100.0, EA=1e4)
    model = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0)))
    return model.run([sc.Stage("tip", model.forms["beam"].load((0.0, -3.0), at=(2.0, 0.0)))])


def pictures(html: str) -> list[bytes]:
    """Contents of the pictures of a page."""
    return [b64decode(data) for data in re.findall(r'src="data:image/png;base64,([^"]+)"', html)]


@pytest.mark.slow
def test_report_holds_model_stages_and_figures(result, report) -> None:
    """Materials with parameters, every stage with two pictures, values of the table, versions;
    nothing from outside.
    """
    html = report.read_text(encoding="utf-8")
    for text in (
        "Pit &lt;A&gt;",
        "E 1e+06, nu 0.2",
        "c 20, phi 30",
        "22",
        "EI 50000",
        "dig &amp; pull",
        "anchor &lt;&amp;&gt;",
        "removed: lift",
        "new: wall, nail, skin, anchor",
        "wall M [kNm/m]",
        sc.__version__,
    ):
        assert text in html, text
    table = result.table()
    assert f"<td>{table['wall M'][2]:.4g}<small>" in html
    assert f"<b>{table['displacement'].max():.4g}</b><span>largest displacement [m]</span>" in html
    # two of each stage, the section forces of wall and nail, and one that was given
    assert len(pictures(html)) == 3 * 2 + 2 + 1
    assert all(picture.startswith(b"\x89PNG") for picture in pictures(html))
    assert not re.search(r'(src|href)="(?!data:|#)', html) and "<script" not in html
    assert html.count("<section") == len(result) and "$" not in html


def test_materials_that_are_equal_have_one_colour(result) -> None:
    """The lift is of the sand, though of another form: two colours in all."""
    found = shades(result)
    assert [shade.names for shade in found.values()] == [("rock",), ("sand", "lift")]
    assert len({shade.color for shade in found.values()}) == 2
    figure = plot.model(result["dig & pull"])
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [
        "rock: LinearElastic",
        "sand: MohrCoulomb",
        "water table",
        "wall",
        "nail",
        "anchor <&>",
    ]
    (water,) = [line for line in figure.axes[0].lines if line.get_linestyle() == "--"]
    np.testing.assert_allclose(water.get_ydata(), 1.0, atol=1e-9)
    plt.close("all")


def test_remarks_are_kept_and_saved(tmp_path) -> None:
    """A block that is far too soft: its warning stands in the result, in the file and in the
    report.
    """
    basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    block = sc.SolidForm(basis, sc.LinearElastic(E=60.0, nu=0.3), unit_weight=20.0)
    model = sc.Model({"block": block}, basis.get_dofs("bottom").all())
    with pytest.warns(AnalysisWarning, match="strains of up to"):
        result = model.run([sc.Stage("weight")])
    assert (
        len(result["weight"].remarks) == 1
        and "block: strains of up to" in result["weight"].remarks[0]
    )
    assert result["weight"].seconds > 0.0
    result.save(tmp_path / "block.npz")
    again = sc.load_result(tmp_path / "block.npz", model)
    assert (
        again["weight"].remarks == result["weight"].remarks
        and again["weight"].seconds == result["weight"].seconds
    )
    html = again.report(tmp_path / "block.html").read_text(encoding="utf-8")
    assert result["weight"].remarks[0] in html


def test_analysis_that_stopped_is_reported(tmp_path) -> None:
    """A cantilever that flows at M = 10 under F L = 40: the report says how far it came, 25 %."""
    beam = sc.Beam(None, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], EI=100.0, EA=1e4, Mp=10.0)
    model = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0)))
    with warnings.catch_warnings(), pytest.raises(sc.NotConverged) as error:
        warnings.simplefilter("ignore")
        model.run(
            [sc.Stage("heavy", model.forms["beam"].load((0.0, -20.0), at=(2.0, 0.0)), increments=8)]
        )
    html = error.value.result.report(tmp_path / "stop.html").read_text(encoding="utf-8")
    assert "stopped at 25% of &#x27;heavy&#x27;" in html


def test_own_template(tmp_path) -> None:
    """A template of one's own takes what it wants; wrong names are refused with those that
    exist.
    """
    result = cantilever()
    template = tmp_path / "own.html"
    template.write_text("<p>$title costs 5 $$</p>$table", encoding="utf-8")
    html = result.report(tmp_path / "a.html", title="Pit", template=template).read_text(
        encoding="utf-8"
    )
    assert html.startswith("<p>Pit costs 5 $</p><table") and "<h2" not in html
    for wrong in ("$nonsense", "5 $"):
        template.write_text(wrong, encoding="utf-8")
        with pytest.raises(
            ValueError, match=r"template is wrong.*\$title, \$facts.*\$\$ is a dollar sign"
        ):
            result.report(tmp_path / "b.html", template=template)
    assert not (tmp_path / "b.html").exists()


@pytest.mark.slow
def test_searches_and_sections_of_solids(tmp_path) -> None:
    """[X] A column, F = 2 c / q, N = -q b: factor, mechanism and curve, and section forces of a
    solid.
    """
    basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    column = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=0.0))
    model = sc.Model(
        {"soil": column}, [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    )
    result = model.run([sc.Stage("load", model.traction("top", (0.0, -10.0)))])
    found = model.strength_reduction(start=result)
    cuts = sc.Cuts.line((0.5, 1.0), (0.5, 0.0), depth=1.0, n=5)
    html = result.report(
        tmp_path / "c.html", searches={"load": found}, sections={"soil": cuts}
    ).read_text("utf-8")
    assert (
        f"<b>{found.factor:.3f}</b><span>factor of safety, load" in html and ">-10<small>" in html
    )
    assert f"stopped by {found.stop.kind}" in html and len(pictures(html)) == 2 + 1 + 2


def test_bodies_in_space(tmp_path, monkeypatch) -> None:
    """Bodies in space are drawn cut open, without a picture of the model."""
    from skfem import ElementHex1, MeshHex

    basis = Basis(MeshHex().refined(1), ElementVector(ElementHex1()), intorder=2)
    block = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3), unit_weight=20.0)
    result = sc.Model({"block": block}, sc.box_supports(basis)).run([sc.Stage("weight")])
    monkeypatch.setattr(pyvista, "BUILDING_GALLERY", True)  # which shows all plotters that it knows
    known = set(pyvista.plotting.plotter._ALL_PLOTTERS)
    html = result.report(tmp_path / "space.html", quantity="uz").read_text(encoding="utf-8")
    assert set(pyvista.plotting.plotter._ALL_PLOTTERS) == known
    assert len(pictures(html)) == 1 and "weight: uz" in html
    with pytest.raises(ValueError, match="plane"):
        plot.model(result["weight"])


@pytest.mark.parametrize(
    "options, message",
    [
        ({"pictures": {"a": 5}}, "'a' is a int"),
        ({"pictures": {"a": "nowhere.png"}}, "nowhere.png is no file"),
        ({"quantity": "nonsense"}, "nonsense"),
        ({"searches": {"later": None}}, "later"),
    ],
)
def test_wrong_reports_are_refused(result, tmp_path, options, message) -> None:
    with pytest.raises(ValueError, match=message):
        result.report(tmp_path / "no.html", **options)
    with pytest.raises(ValueError, match="a stage"):
        Result(()).report(tmp_path / "no.html")
    plt.close("all")


@pytest.mark.skipif(
    shutil.which("chromium") is None or shutil.which("chromedriver") is None,
    reason="needs Chromium",
)
def test_browser_shows_and_prints_the_report(report, tmp_path) -> None:
    """Nothing is cut, broken or wider than 1,300 or 400 pixels, and Chromium prints it to PDF."""
    pytest.importorskip("selenium")
    command = [
        sys.executable,
        str(DOCS / "check_pages.py"),
        str(report),
        "--out",
        str(tmp_path / "shots"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr
    assert json.loads(done.stdout.splitlines()[-1]) == {"pages": 1, "wrong": 0}
    pdf = tmp_path / "pit.pdf"
    subprocess.run(
        [
            str(shutil.which("chromium")),
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            f"--print-to-pdf={pdf}",
            report.as_uri(),
        ],
        capture_output=True,
        timeout=240,
        check=True,
    )
    assert pdf.read_bytes().startswith(b"%PDF")


@pytest.mark.slow
def test_report_has_loads_supports_and_parameters(result, report) -> None:
    """[X] Weights, water and reactions hold each other; defaults are marked; units are written.

    At rest: 18 kN/m3 on 8 x 4 and 22 on 8 x 2, by hand.
    """
    html = report.read_text(encoding="utf-8")
    for text in ("other loads", "reactions", "Fy [kN/m]", "left", "level 1 m", "default"):
        assert text in html, text
    from skfem_contact.plot import report_tables

    loads = report_tables.loads(result)
    first = [row for row in loads.rows if row[0] == "at rest"]
    weight, others, reactions = first
    assert weight[1] == "weight" and np.isclose(weight[3], -(18.0 * 32 + 22.0 * 16))
    assert others[3] == 0.0 and np.isclose(reactions[3], -weight[3])
    assert weight[4] == "x = 4"
    last = {row[1]: row for row in loads.rows if row[0] == "dig & pull"}
    assert np.isclose(last["other loads"][2], -30.0)
    total = sum(row[3] for row in last.values())
    assert abs(total) < 1e-6 * abs(last["weight"][3])
    rows = report_tables.parameters(result, shades(result)).rows
    assert ("sand, lift", "psi", "0", "°", "default") in rows
    assert ("sand, lift", "c", "20", "", "") in rows  # no units outside of the fixture
    held = report_tables.supports(result).rows
    assert ("at rest, wall, dig & pull", "bottom", "x, y") in held


def test_resultants_of_loads_count_forces_alone() -> None:
    """[X] A moment on a beam and water that drains are no forces; round-off is no coordinate."""
    from skfem_contact.plot import report_tables

    mesh = MeshTri.init_tensor(np.linspace(-4, 4, 9), np.linspace(-4, 0, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = sc.PoreWater(basis, 1e-3, unit_weight=10.0)
    forms = {
        "soil": sc.SolidForm(basis, sc.LinearElastic(1e4, 0.3), unit_weight=20.0),
        "raft": sc.Beam(basis, "top", EI=500.0, EA=1e5),
        "water": water,
    }
    model = sc.Model(forms, [sc.box_supports(basis), water.dofs("top")])
    load = model.forms["raft"].load((30.0, -50.0), at=(1.0, 0.0), moment=200.0)
    result = model.run([sc.Stage("load", load, duration=5.0)], progress=False)
    rows = {row[1]: row[2:] for row in report_tables.loads(result).rows}
    np.testing.assert_allclose(rows["other loads"][:2], (30.0, -50.0))
    np.testing.assert_allclose(rows["reactions"][:2], (-30.0, 690.0), rtol=1e-9)
    assert rows["weight"][2] == "x = 0" and rows["other loads"][2] == "x = 1"
    dry = sc.Model({"soil": forms["soil"]}, sc.box_supports(basis), water_unit_weight=9.81)
    result = dry.run([sc.Stage("wet", water=[(-4.0, -0.3), (4.0, 0.7)])], progress=False)
    nothing = report_tables.loads(result).rows[2]
    assert nothing[1:] == ("other loads", 0.0, 0.0, "")
    at_rest = report_tables.loads(dry.gravity_state()).rows
    assert at_rest[0][1] == "weight" and at_rest[0][3] == pytest.approx(-640.0)


def test_resultants_of_axial_symmetry_are_per_radian(request) -> None:
    """[X] The weight of a disc, 20 * 3 * 2**2 / 2, as a force and not as a force per length."""
    from skfem_contact.plot import report_tables

    mesh = MeshQuad.init_tensor(np.linspace(0, 2, 3), np.linspace(0, 3, 4)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    disc = sc.SolidForm(
        basis, sc.LinearElastic(1e4, 0.3), coordinates="axisymmetric", unit_weight=20.0
    )
    result = sc.Model({"disc": disc}, sc.box_supports(basis)).run([sc.Stage("rest")])
    request.addfinalizer(sc.set_units)
    sc.set_units("kN", "m")
    table = report_tables.loads(result)
    assert table.titles[1:4] == ("resultant per radian of", "Fx [kN]", "Fy [kN]")
    np.testing.assert_allclose(table["Fy"][0], -120.0)


def test_stresses_at_rest_and_water_in_words() -> None:
    """[X] K0 of a level ground is the given one; water is told as it was given."""
    from skfem_contact.plot import report_tables

    mesh = MeshQuad().refined(2).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0)
    ground = sc.SolidForm(basis, soil, unit_weight=20.0)
    model = sc.Model({"ground": ground}, sc.box_supports(basis), water_unit_weight=10.0)
    table = report_tables.at_rest(model.k0_state(K0=0.45, water=0.5))
    assert table.rows[0][0] == "ground" and np.allclose(table.rows[0][1:4], 0.45)
    assert report_tables.in_words(2.5) == "level 2.5"
    assert report_tables.in_words([(0.0, 1.0), (2.0, 3.0)]) == "through (0, 1), (2, 3)"
    assert report_tables.in_words({"clay": 1.0}) == "clay: level 1"
    assert report_tables.in_words(lambda x: x[1]) == "a function of the coordinates"
    assert report_tables.in_words(np.zeros(4)) == "pressures at the vertices"


@pytest.mark.slow
def test_word_document(result, tmp_path) -> None:
    """A .docx file has the same tables and pictures; other formats are refused."""
    docx = pytest.importorskip("docx")
    figure, _ = plt.subplots()
    file = result.report(tmp_path / "pit.docx", title="Pit <A>", pictures={"own": figure})
    text = docx.Document(str(file))
    words = [paragraph.text for paragraph in text.paragraphs]
    assert words[0] == "Pit <A>"
    for heading in ("Model", "Supports", "dig & pull", "Loads and reactions", "Run"):
        assert heading in words
    cells = {cell.text for table in text.tables for row in table.rows for cell in row.cells}
    for content in ("psi", "default", "reactions", "wall M"):
        assert content in cells, content
    assert len(text.inline_shapes) == 3 * 2 + 2 + 1
    for wrong in ("pit.pdf", "pit"):
        with pytest.raises(ValueError, match=r"an \.html file"):
            result.report(tmp_path / wrong)
        assert not (tmp_path / wrong).exists()


def test_search_without_solids_is_reported(tmp_path) -> None:
    """[X] A cantilever with a plastic moment: the report holds its limit load and no mechanism."""
    beam = sc.Beam(None, np.linspace((0.0, 0.0), (2.0, 0.0), 3), EI=100.0, EA=1e4, Mp=6.0)
    model = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0)))
    tip = model.forms["beam"].load((0.0, -1.0), at=(2.0, 0.0))
    result = model.run([sc.Stage("tip", tip)], progress=False)
    found = model.limit_load(tip, progress=False)
    text = result.report(tmp_path / "beam.html", searches={"tip": found}).read_text("utf-8")
    assert "limit load, tip" in text
    assert "Mechanism" not in text
