"""Values at points, along lines and through stages."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pytest
from skfem import Basis, ElementQuad2, ElementTriP1, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot
from tests.results.test_fields import step_of, stretched
from tests.tools.helpers import ELEMENTS, IN_SPACE, distorted, grid, vector_basis


@pytest.fixture
def column():
    """A column of 1 by 2 with two soils under its weight and a load, in increments that are
    kept.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 5), np.linspace(0, 2, 9)).with_defaults()
    mesh = mesh.with_subdomains({"low": lambda x: x[1] < 1, "high": lambda x: x[1] > 1})
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    soils = {
        "low": sc.LinearElastic(E=1e3, nu=0.0),
        "high": sc.LinearElastic(E=5e2, nu=0.0),
    }
    ground = sc.SolidForm(basis, soils, unit_weight=20.0)
    model = sc.Model({"ground": ground}, basis.get_dofs("bottom").all())
    load = model.traction("top", (0.0, -10.0))
    stages = [sc.Stage("weight"), sc.Stage("load", load, increments=4, keep="all")]
    return model.run(stages)


@pytest.mark.parametrize("element", ELEMENTS)
def test_linear_fields_are_exact_within_elements(element):
    """[X] Displacements and stresses of a constant strain, also between the nodes; the reference is
    linear in the coordinates.
    """
    line = np.linspace(0, 1, 5)
    mesh = distorted(grid(element, line, line), np.random.default_rng(2), 0.04)
    basis = vector_basis(mesh, element, intorder=4)
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0))
    stage = step_of({"body": body}, stretched(basis))
    points = np.random.default_rng(1).uniform(0.05, 0.95, (200, 2))
    found = stage.at(points, "ux", "sxx", "exy")
    x, y = points.T
    assert np.allclose(found["ux"], 1e-3 * x + 6e-4 * y, rtol=0.0, atol=1e-12)
    assert np.allclose(found["sxx"], 1.0, rtol=1e-9)
    assert np.allclose(found["exy"], 6e-4, rtol=1e-9)


@pytest.mark.parametrize("element", ["P2", "Q1"])
def test_points_in_space(element):
    """[X] The same in space: u = (z, 0, 0) / 1000."""
    line = np.linspace(0, 1, 3)
    mesh = IN_SPACE[element][0].init_tensor(line, line, line)
    basis = vector_basis(mesh, element, intorder=4)
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0))
    x = np.zeros(basis.N)
    x[0::3] = 1e-3 * basis.doflocs[2, 0::3]
    found = step_of({"body": body}, x).at([(0.2, 0.3, 0.7), (0.9, 0.1, 0.05)], "ux", "szx")
    assert np.allclose(found["ux"], [7e-4, 5e-5], rtol=1e-9)
    assert np.allclose(found["szx"], 0.5, rtol=1e-9)


def test_nodes_have_the_values_of_fields(column):
    """[X] At nodes within a region the values are those of `stage.field`."""
    stage = column["load"]
    basis = stage.forms["ground"].basis
    points = basis.mesh.p.T
    inside = points[:, 1] != 1.0
    for name in ("uy", "syy", "s3", "gamma", "mises"):
        field = stage.field(name)[: len(points)]
        assert np.allclose(stage.at(points[inside], name)[name], field[inside], atol=1e-12)


def test_regions_on_their_border(column):
    """[X] Strains jump between two soils: -30/E below, -30/2E above; the first region counts."""
    stage = column["load"]
    point = (0.3, 1.0)
    low = stage.at(point, "eyy", of="low")["eyy"][0]
    high = stage.at(point, "eyy", of="high")["eyy"][0]
    # nodal values of strains are fits within a region: exact for the linear strain
    assert np.allclose([low, high], [-30e-3, -60e-3], rtol=1e-9)
    assert stage.at(point, "eyy")["eyy"][0] == low
    changed = stage.at(point, "eyy", of="low", since=column["weight"])["eyy"][0]
    assert np.isclose(changed, -10e-3, rtol=1e-9)


def test_only_some_nodes_are_recovered_with_the_same_values(column):
    """[X] A point alone has the value that it has among all points."""
    stage = column["load"]
    points = np.random.default_rng(0).uniform((0, 0), (1, 2), (50, 2))
    all_of_them = stage.at(points, "s1", "plastic")
    for k in (0, 17, 49):
        alone = stage.at(points[k], "s1", "plastic")
        assert np.isclose(alone["s1"][0], all_of_them["s1"][k], rtol=1e-12)


def test_along_a_line_with_a_corner(column):
    """[X] Positions are distances along the line, its corners are among the points."""
    found = column["load"].along([(0.5, 0.0), (0.5, 1.5), (1.0, 1.5)], "syy", n=5)
    assert np.allclose(found["position"], [0.0, 0.5, 1.0, 1.5, 2.0])
    assert np.allclose(found["syy"], [-50.0, -40.0, -30.0, -20.0, -20.0])
    corner = column["load"].along([(0.5, 0.0), (0.5, 0.7), (1.0, 0.7)], "syy", n=3)
    assert np.allclose(corner["position"], [0.0, 0.6, 0.7, 1.2])


def test_histories_with_all_increments(column):
    """[X] The top settles by 2 w L / (2 E) of the weight and then in proportion to the load."""
    ends = column.at({"top": (0.4, 2.0)}, "uy")
    by_hand = [-(30e-3 + 20e-3), -(30e-3 + 20e-3) - 10e-3 - 20e-3]
    assert np.allclose(ends["uy"], by_hand, rtol=1e-9)
    assert list(ends["stage"]) == ["weight", "load"]
    every = column.at({"top": (0.4, 2.0), "low": (0.4, 0.5)}, "uy", increments=True)
    top = every["point"] == "top"
    assert np.allclose(every["uy"][top], by_hand[0] - 0.03 * np.array([0, 0.25, 0.5, 0.75, 1]))
    assert np.allclose(every["load"][top], [1.0, 0.25, 0.5, 0.75, 1.0])


def test_histories_of_points_that_are_dug_away() -> None:
    """[X] A point has its settlement until it is dug away, and NaN from then on, which is told; a
    point that no stage holds is refused.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 1, 3), np.linspace(0, 2, 5))
    mesh = mesh.with_defaults().with_subdomains({"low": lambda x: x[1] < 1})
    mesh = mesh.with_subdomains({"high": lambda x: x[1] > 1})
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    soil = sc.LinearElastic(E=1e3, nu=0.0)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), soil, unit_weight=20.0)
        for name in ("low", "high")
    }
    model = sc.Model(forms, basis.get_dofs("bottom").all())
    result = model.run([sc.Stage("weight"), sc.Stage("dug", deactivate="high")])
    points = {"top": (0.4, 2.0), "middle": (0.4, 1.0)}
    with pytest.warns(sc.AnalysisWarning, match="1 of 2 points .* in stage 'dug': they have NaN"):
        found = result.at(points, "uy")
    # w L^2 / (2 E) of both halves, then of the lower one
    assert found["uy"] == pytest.approx([-0.04, -0.03, np.nan, -0.01], nan_ok=True)
    with pytest.raises(ValueError, match=r"1 of 2 points .* of all stages: the first is \(3, 1\)"):
        result.at([(0.4, 1.0), (3.0, 1.0)], "uy")


def test_pore_pressure_at_points(column):
    """[X] Hydrostatic pressure of a level of 1.5 is linear."""
    stage = column["load"]
    found = stage.at([(0.5, 0.5), (0.2, 1.25)], "pore", water=sc.hydrostatic(1.5, 10.0))
    assert np.allclose(found["pore"], [10.0, 2.5])


def test_tables_with_units(column, tmp_path):
    """Units stand in tables and files, names of columns have none."""
    sc.set_units("kN", "m")
    try:
        found = column["load"].at({"top": (0.4, 2.0)}, "uy", "syy")
        assert "uy [m]" in str(found) and "syy [kPa]" in found.to_markdown()
        assert found.to_csv(tmp_path / "a.csv").startswith("point,x [m],y [m],uy [m],syy [kPa]")
        assert (tmp_path / "a.csv").read_text(encoding="utf-8") == found.to_csv()
        pytest.importorskip("pandas")
        frame = found.to_frame()
        assert list(frame) == ["point", "x", "y", "uy", "syy"]
        assert frame.attrs["units"]["syy"] == "kPa"
    finally:
        sc.set_units()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda s: s.at((2.0, 1.0), "uy"), "1 of 1 points lie outside .* 1 from the nearest"),
        (lambda s: s.at((0.5, 0.5), "vy"), "there is no field 'vy'"),
        (lambda s: s.at((0.5, 0.5)), "name at least one field"),
        (lambda s: s.at((0.5, 0.5, 0.0), "uy"), r"points are \(x, y\)"),
        (lambda s: s.at([], "uy"), r"points are \(x, y\)"),
        (lambda s: s.at((np.nan, 0.5), "uy"), "finite"),
        (lambda s: s.at((0.5, 1.5), "uy", of="low"), "outside of 'low'"),
        (lambda s: s.at((0.5, 1.5), "uy", of="clay"), "existing: ground, high, low"),
        (lambda s: s.along([(0.5, 0.5)], "uy"), "two or more corners"),
        (lambda s: s.along([(0.5, 0.5), (0.5, 0.5)], "uy"), "two or more corners"),
        (lambda s: s.along([(0.5, 0.5), (0.5, 1.0)], "uy", n=1), "two points"),
    ],
)
def test_wrong_calls(column, call, message):
    """One sentence for each wrong call."""
    with pytest.raises(ValueError, match=message):
        call(column["load"])


def test_pictures(column):
    """[X] The curves of the pictures are the values, with units in the titles."""
    sc.set_units("kN", "m")
    try:
        upright = column["load"].along([(0.5, 0.0), (0.5, 2.0)], "syy", n=3).plot()
        (line,) = upright.axes[0].lines
        assert np.allclose(line.get_xdata(), [-50.0, -30.0, -10.0])
        assert np.allclose(line.get_ydata(), [0.0, 1.0, 2.0])
        assert upright.axes[0].get_xlabel() == "vertical stress [kPa]"
        history = column.at({"top": (0.4, 2.0), "low": (0.4, 0.5)}, "uy", increments=True).plot()
        assert len(history.axes[0].lines) == 2
        assert np.allclose(history.axes[0].lines[0].get_xdata(), [0.0, 0.25, 0.5, 0.75, 1.0])
        with pytest.raises(ValueError, match=r"stage\.along"):
            plot.values(column["load"].at((0.5, 0.5), "uy"))
    finally:
        sc.set_units()
        plt.close("all")


def test_units_that_are_none():
    """Empty units and a force without a length are refused."""
    with pytest.raises(ValueError, match="a unit is a text"):
        sc.set_units("", "m")
    with pytest.raises(ValueError, match="give that of the length"):
        sc.set_units("kN")


@pytest.mark.slow
def test_many_points_in_little_time():
    """1e5 points on 1e5 elements in .5 s of process time: 0.31 s on two cores of 2.5 GHz."""
    from time import process_time

    line = np.linspace(0, 1, 225)
    mesh = MeshTri.init_tensor(line, line).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP1()), intorder=2)
    body = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0))
    x = stretched(basis)
    stage = sc.results.of({"body": body}, x, {"body": body.initial_state()})
    points = np.random.default_rng(0).uniform(size=(100_000, 2))
    begin = process_time()
    found = stage.at(points, "ux")
    # half of the measured speed at least: other processes share the caches
    assert process_time() - begin < 1.0
    assert np.allclose(found["ux"], 1e-3 * points[:, 0] + 6e-4 * points[:, 1], atol=1e-12)
