"""Tables of results: forces along beams, contact and bars, and one row for each stage."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
from skfem_contact.demo import culvert
from skfem_contact.results import Result, Table

#: Displacement of the end of the cantilever by a force there, L³ / 3 EI + L / GA.
FLEXIBILITY = 4.0**3 / (3 * 200.0) + 4.0 / 300.0
CUTS = sc.Cuts.ring((0.0, 0.0), 0.72, 0.90)


@pytest.fixture(scope="module")
def pipe() -> Result:
    """The demonstration: contact around a pipe, two stages."""
    return culvert().result


def beam_and_bars() -> tuple[sc.Model, Result]:
    """A cantilever that a bar holds at its end, first without, then with the bar."""
    beam = sc.Beam(None, np.linspace((0.0, 0.0), (4.0, 0.0), 9), EI=200.0, EA=1e4, GA=300.0)
    bar = sc.Bar(None, beam.at((4.0, 0.0)), (4.0, 3.0), EA=75.0, fixed_end=True)
    model = sc.Model({"beam": beam, "bar": bar}, beam.dofs((0.0, 0.0)))
    load = model.forms["beam"].load((0.0, -10.0), at=(4.0, 0.0))
    return model, model.run(
        [sc.Stage("free", load, deactivate="bar"), sc.Stage("more", 2 * load, activate="bar")]
    )


def test_forces_of_a_propped_cantilever() -> None:
    """[X] M = P (L - x); the bar takes the second load by its share, k / (k + 1 / f), of it."""
    _, result = beam_and_bars()
    share = 25.0 / (25.0 + 1.0 / FLEXIBILITY)
    table = result["more"].table("beam")
    # Newton's tolerance is 1e-8 of the forces
    np.testing.assert_allclose(table["M"], (20.0 - 10.0 * share) * (4.0 - table["x"]), atol=1e-5)
    assert result["more"].table("bar")["force"] == pytest.approx([10.0 * share], rel=1e-6)
    assert result["more"].table("bar").head == ("x", "y", "end x", "end y", "force")


def test_stages_and_where_the_largest_values_are() -> None:
    """[X] Largest moment at the clamp, largest displacement at the tip; no bar in the first stage,
    and no N at all.
    """
    _, result = beam_and_bars()
    table = result.table()
    assert table["stage"].tolist() == ["free", "more"]
    np.testing.assert_allclose(table["displacement"][0], 10.0 * FLEXIBILITY, rtol=1e-6)
    assert table["displacement at"].tolist() == ["(4, 0)"] * 2
    np.testing.assert_allclose(table["beam M"][0], 40.0, rtol=1e-6)
    assert table["beam M at"][0] == "(0, 0)"
    assert np.isnan(table["bar"][0]) and table["bar at"].tolist() == ["", "(4, 0)"]
    assert "beam N" not in table.head
    assert result.table("bar").head == ("stage", "displacement", "displacement at", "bar", "bar at")


def test_contact_and_sections_of_solids(pipe: Result) -> None:
    """[N] The same figures as of the functions that return arrays."""
    stage, table = pipe["surcharge"], pipe.table("skin", sections={"culvert": CUTS})
    along, forces = stage.tractions("skin"), stage.section_forces("culvert", CUTS)
    assert table["skin pressure"][1] == along.pressure.max()
    assert table["culvert M"][1] == forces.M[np.abs(forces.M).argmax()]
    assert table["culvert N"][1] == forces.N.min()
    # both walls of a symmetric pipe have the same moment but for round-off: the first cut of the
    # two counts
    assert table["culvert M at"][0] == "(0.81, 0)"
    contact = stage.table("skin")
    assert set(contact["status"]) == {"stick"}
    np.testing.assert_array_equal(contact["pressure"], along.pressure)
    np.testing.assert_array_equal(stage.table("culvert", CUTS)["V"], forces.V)


def test_vectors_in_space_have_columns_of_their_own() -> None:
    """[X] A cantilever in space with a force across: two components of V and M, and no torque."""
    beam = sc.Beam(None, np.linspace((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 3), EI=1e3, EA=1e5)
    model = sc.Model({"beam": beam}, beam.dofs((0.0, 0.0, 0.0)))
    result = model.run(
        [sc.Stage("tip", model.forms["beam"].load((0.0, 3.0, 4.0), at=(2.0, 0.0, 0.0)))]
    )
    table = result["tip"].table("beam")
    assert {"x", "y", "z", "N", "V y", "V z", "M y", "M z", "T"} <= set(table.head)
    np.testing.assert_allclose(np.hypot(table["M y"], table["M z"])[0], 10.0)
    np.testing.assert_allclose(result.table()["beam M"], [10.0])
    np.testing.assert_allclose(result.table()["beam V"], [5.0])


def test_skin_of_a_nail() -> None:
    """[X] Half of the resistance of 60 pulls a nail of 4 m whose skin bears 15: 30 kN along it,
    less at its end.
    """
    mesh = MeshTri.init_tensor(np.linspace(0.0, 6.0, 7), np.linspace(0.0, 3.0, 4)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    nail = sc.Beam(None, np.linspace((0.3, 1.6), (4.3, 1.6), 5), EI=10.0, EA=1e5)
    forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=3e4, nu=0.3)), "nail": nail}
    model = sc.Model(
        {**forms, "skin": sc.Embedded(basis, nail, T_max=15.0)}, basis.get_dofs("bottom").all()
    )
    stage = model.run([sc.Stage("pull", model.forms["nail"].load((-30.0, 0.0), at=(0.3, 1.6)))])[
        "pull"
    ]
    table = stage.table("skin")
    along = table["kind"] == "t"
    weights = model.forms["skin"]._weight
    skin = table["resistance"][along]
    assert abs(weights @ skin) == pytest.approx(30.0, rel=1e-7)  # Newton's tolerance
    np.testing.assert_allclose(table["share"][along], abs(skin) / 15.0)
    np.testing.assert_allclose(table["x"], 0.3 + table["position"])


def test_factors_stand_beside_their_stages() -> None:
    """[X] A column of soil, F = 2 c / q; a search that does not show a limit says what it has
    reached.
    """
    basis = Basis(MeshQuad().refined(1).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    column = sc.SolidForm(basis, sc.MohrCoulomb(E=1e3, nu=0.3, c=10.0, phi=0.0))
    model = sc.Model(
        {"soil": column}, [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    )
    result = model.run(
        [
            sc.Stage("light", model.traction("top", (0.0, -5.0))),
            sc.Stage("heavy", model.traction("top", (0.0, -10.0))),
        ]
    )
    found = model.strength_reduction(start=result)
    assert result.table(searches={"heavy": found})["factor of safety"].tolist() == [
        pytest.approx(np.nan, nan_ok=True),
        found.factor,
    ]
    with pytest.warns(sc.AnalysisWarning, match="no collapse was shown"):
        open_end = model.strength_reduction(start=result, max_value=1.2)
    assert "| >= 1.2" in result.table(searches={"heavy": open_end}).to_markdown()


def test_table_survives_files(pipe: Result, tmp_path) -> None:
    """[X] Comma-separated values have all digits, pandas has the same, and a saved result has the
    same table.
    """
    table = pipe["surcharge"].table("skin")
    text = table.to_csv(tmp_path / "skin.csv")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "skin.csv").read_text(encoding="utf-8"))))
    assert text.count("\n") == len(table) + 1
    assert [float(row["pressure"]) for row in rows] == table["pressure"].tolist()
    pipe.save(tmp_path / "pipe.npz")
    again = sc.load_result(tmp_path / "pipe.npz", culvert().forms)
    assert str(again.table(sections={"culvert": CUTS})) == str(
        pipe.table(sections={"culvert": CUTS})
    )
    pandas = pytest.importorskip("pandas")
    assert isinstance(table.to_frame(), pandas.DataFrame)
    assert table.to_frame()["shear"].tolist() == table["shear"].tolist()


def test_text_of_tables() -> None:
    """Figures have four digits and stand on the right, nothing is a dash, and names cannot break
    the format.
    """
    table = Table(
        ("name", "value"), (("a | b <c>", -12345.678), ("none", float("nan")), ("tiny", -1e-6))
    )
    assert table.to_markdown().splitlines()[1:3] == ["|:--|--:|", "| a \\| b <c> | -12346 |"]
    assert "| none | – |" in table.to_markdown()
    assert "a | b &lt;c&gt;" in table._repr_html_() and 'right">-1e-06' in table._repr_html_()
    assert table.to_csv().splitlines()[2] == "none,"
    assert str(Table(("a",), ())) == "a" and len(Table(("a",), ())) == 0
    with pytest.raises(KeyError, match=r"no column 'x'.*\['name', 'value'\]"):
        table["x"]


@pytest.mark.parametrize(
    "ask, message",
    [
        (lambda r: r.table("wall"), r"'wall'.*ground"),
        (lambda r: r.table(searches={"dig": None}), r"'dig'.*gravity"),
        (
            lambda r: r.table(searches={"gravity": 1.3}),
            "results of strength_reduction or limit_load, not 1.3",
        ),
        (lambda r: r.table("culvert"), "'culvert' is a SolidForm: give sections="),
        (lambda r: r["gravity"].table("ground"), r"'ground' is a SolidForm.*sections.*\['skin'\]"),
        (lambda r: r["gravity"].table("skin", CUTS), "SolidForm"),
    ],
)
def test_what_cannot_be_tabulated_is_named(pipe: Result, ask, message) -> None:
    with pytest.raises(ValueError, match=message):
        ask(pipe)
