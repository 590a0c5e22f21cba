"""Values in wrong units or with wrong signs: what is refused by name, and what is told."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad, MeshTri

import skfem_contact as sc
import skfem_contact.plot as plot
from skfem_contact.plot import report_tables
from tests.tools.helpers import grid, vector_basis


def test_angles_in_radians():
    with pytest.warns(sc.AnalysisWarning, match=r"phi is 0.5236: angles are given in degrees"):
        sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=np.radians(30))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert (
            sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=30.0).reduced(50.0).phi < 1.0
        )  # derived, and meant


ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: sc.rigid.level_set(lambda x, y: x + y, (-1.0, 1.0, -1.0, 1.0), resolution=0),
            "at least 2, not 0",
        ),
        (
            lambda: sc.MatrixForm(np.ones((2, 3, 4))),
            r"square matrix, not an array of shape \(2, 3, 4\)",
        ),
        (lambda: column().k0_state(K0=0.5, unit_weights={}), "unit_weights names no subdomain"),
        (lambda: sc.testing.check_material(ELASTIC, ncomp=0), "ncomp must be one of 4, 6, not 0"),
        (
            lambda: (
                column()
                .run([sc.Stage("w")])[-1]
                .section_forces("soil", sc.Cuts.line((9, 1), (9, 0), 1))
            ),
            "at .9, 1",
        ),
        (
            lambda: column(gravity=(0.0, -9.81)),
            r"gravity must be a unit vector with 2 components, not \(0.0, -9.81\)",
        ),
        (lambda: column(seismic=(0.1, 0.1)), "seismic must be finite, with at most 1 components"),
        (lambda: column("axisymmetric", seismic=0.1), "weights act along the axis"),
        (lambda: column("axisymmetric", gravity=(0.6, -0.8)), "weights act along the axis"),
    ],
)
def test_nothing_given(call, message):
    """Grids without points, no weights, sections elsewhere, gravity of 9.81 or across an axis:
    refused by name.
    """
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sc.Coulomb(mu=20.0), "mu is 20: it is the tangent of the angle"),
        (
            lambda: sc.hydrostatic(2.0, unit_weight=1000.0),
            "unit weight of water is 1000, which is its density",
        ),
        (
            lambda: sc.PoreWater(column().forms["soil"].basis, 1e-4, unit_weight=1e3),
            "water is 1000, which is its density",
        ),
        (
            lambda: sc.water.Flow(column().forms["soil"].basis, 1e-5, unit_weight=1025.0).steady(
                sc.water.Conditions(head={"left": 1.0})
            ),
            "water is 1025",
        ),
        (lambda: column().k0_state(K0=50.0), "K0 is 50: it is the ratio"),
        (
            lambda: column(E=1.0).run([sc.Stage("weight")]),
            "small; are E and the loads in the same units",
        ),
        (
            lambda: column(seismic=-10.0),
            "seismic is -10.0: it is the acceleration over that of gravity",
        ),
        (lambda: column(unit_weight={"all": -18.0}), "unit weights are positive"),
        (
            lambda: sc.mesh.check_mesh(MeshTri().translated((5e3, 5e4))),
            r"lies at \(5000, 5e\+04\), .* move it by",
        ),
    ],
)
def test_slips_are_told(make, message):
    """Angles for coefficients, densities for weights, per cent for ratios, MPa beside kN."""
    with pytest.warns(sc.AnalysisWarning, match=message):
        make()


def column(
    coordinates: str = "plane", E: float = 1e4, unit_weight: float | dict | None = 20.0, **options
):
    """Model of a body of 1 m under its own weight."""
    mesh = grid("Q1", np.linspace(0, 1, 3), np.linspace(0, 1, 3)).with_subdomains(
        {"all": lambda x: x[0] > 0.0}
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    soil = sc.SolidForm(
        basis, sc.LinearElastic(E, 0.3), coordinates=coordinates, unit_weight=unit_weight
    )
    return sc.Model({"soil": soil}, sc.box_supports(basis), **options)


def test_sound_input_is_not_told(recwarn):
    sc.Coulomb(mu=[0.2, 5.0])
    sc.Coulomb(mu=1e6)
    sc.hydrostatic(2.0, unit_weight=9810.0)
    column(seismic=0.9)
    sc.mesh.check_mesh(MeshTri().translated((1e3, -1e3)))
    column().k0_state(K0=3.0)
    column().run([sc.Stage("weight")])
    assert not recwarn.list


def _without_weight(unit: float) -> None:
    """A load that lacks the weight before."""
    model = column(E=1e4 * unit, unit_weight=None)
    own = model.weight(20.0 * unit)
    model.run([sc.Stage("weight", own), sc.Stage("push", model.traction("top", (0.0, -unit)))])


def _removed(unit: float) -> None:
    """A stage with inertia and without a load, after a load."""
    model = column(E=1e4 * unit, unit_weight=20.0 * unit, gravity_acceleration=9.81)
    stages = [
        sc.Stage("push", model.traction("top", (0.0, -unit))),
        sc.Stage("swing", duration=0.1, dynamic=sc.Dynamic(step=0.05)),
    ]
    model.run(stages)


def _lifted(unit: float) -> None:
    """Water with a pressure of 5 at the base of tight ground, under a plate that presses by 2."""
    steps = np.linspace(0, 1, 3)
    bodies = {"clay": grid("Q1", steps, steps), "plate": grid("Q1", steps, 1.0 + 0.1 * steps)}
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    clay = basis.with_elements("clay")
    water = sc.PoreWater(clay, 1e-3, unit_weight=10.0 * unit)
    soil = sc.LinearElastic(1e4 * unit, 0.3)
    forms = {
        "clay": sc.SolidForm(clay, soil),
        "plate": sc.SolidForm(basis.with_elements("plate"), soil),
        "water": water,
        "joint": sc.ContactPair(basis, "plate:bottom", "clay:top", sc.Coulomb(0.0)),
    }
    sides = [f"{body}:{side}" for body in bodies for side in ("left", "right")]
    fixed = [basis.get_dofs("clay:bottom").all(), basis.get_dofs(sides).all("u^1")]
    model = sc.Model(forms, [np.unique(np.concatenate(fixed)), water.dofs("clay:bottom")])
    load = model.traction("plate:top", (0.0, -2.0 * unit))
    rise = model.forms["water"].prescribed({"clay:bottom": 5.0 * unit})
    model.run(
        [sc.Stage("press", load, duration=100.0), sc.Stage("rise", load, rise, duration=100.0)]
    )


@pytest.mark.parametrize(
    ("scene", "told"),
    [
        (_without_weight, "lacks the weight of 'soil', about"),
        (_removed, "the load before, of up to # is removed"),
        (_lifted, "the water presses with up to # and contact transfers # there"),
    ],
)
def test_remarks_do_not_depend_on_the_unit_of_force(scene, told):
    """Forces a million times smaller have the same remarks, up to numbers with units."""
    texts = []
    for unit in (1.0, 1e-6):
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always")
            scene(unit)
        texts.append([re.sub(r"\d\S*", "#", str(warning.message)) for warning in found])
    assert texts[0] == texts[1]
    assert any(told in text for text in texts[0])


@pytest.fixture
def without_units():
    yield
    sc.set_units()


@pytest.mark.parametrize(
    ("units", "message"),
    [
        (("kNN", "m"), "no unit of force 'kNN' that is known.*did you mean 'kN'"),
        (("KN", "m"), "no unit of force 'KN' that is known.*did you mean 'kN'"),
        (("kN", "M"), "no unit of length 'M' that is known.*did you mean 'm'"),
        (("kN", "m", "KPa"), "no unit of stress 'KPa' that is known.*did you mean 'kPa'"),
    ],
)
def test_units_that_resemble_known_ones_are_told(units, message, without_units):
    with pytest.warns(sc.AnalysisWarning, match=message):
        sc.set_units(*units)


@pytest.mark.parametrize(
    ("units", "message"),
    [
        (("m", "kN"), "'m' is a unit of length, not of force"),
        (("kPa", "m"), "'kPa' is a unit of stress, not of force"),
        (("kN", "m", "N"), "'N' is a unit of force, not of stress"),
        (("kN", "m", "MPa"), "stresses are kPa with kN and m, not MPa"),
        (("N", "mm", "kPa"), "stresses are MPa with N and mm, not kPa"),
    ],
)
def test_units_of_something_else_are_refused(units, message, without_units):
    sc.set_units("kN", "m")
    with pytest.raises(ValueError, match=message):
        sc.set_units(*units)
    assert plot.labelled("stress", "stress") == "stress [kPa]"  # the units before stay


@pytest.mark.parametrize(
    "units",
    [("lb", "ft", "psf"), ("stone", "cubit"), ("kN", "m", "kN/m²"), ("N", "mm", "N/mm2")],
)
def test_units_are_yours(units, without_units, recwarn):
    sc.set_units(*units)
    force, length, *stress = units
    (written,) = stress or [f"{force}/{length}²"]
    assert plot.labelled("stress", "stress") == f"stress [{written}]"
    assert not recwarn.list


def test_both_ends_of_a_bar_have_the_unit_of_length(without_units):
    """Columns of coordinates, with a word before the axis or without one."""
    beam = sc.Beam(None, [(0.0, 0.0), (0.0, -2.0)], EI=10.0, EA=1e3)
    bar = sc.Bar(None, beam.at((0.0, 0.0)), (4.0, 3.0), EA=75.0, fixed_end=True)
    model = sc.Model({"beam": beam, "bar": bar}, beam.dofs((0.0, -2.0)))
    push = model.forms["beam"].load((1.0, 0.0), at=(0.0, 0.0))
    stage = model.run([sc.Stage("push", push)], progress=False)["push"]
    sc.set_units("kN", "m")
    titles = stage.table("bar").titles
    assert titles[:4] == ("x [m]", "y [m]", "end x [m]", "end y [m]")


@pytest.mark.parametrize(
    "spacing, coordinates, unit",
    [
        (None, "plane", "kN/m"),
        (2.0, "plane", "kN"),
        (None, "axisymmetric", "kN/rad"),
        (np.pi, "axisymmetric", "kN"),
    ],
)
def test_forces_of_bars_are_of_a_member_or_of_a_length(
    spacing, coordinates, unit, without_units
) -> None:
    """With a spacing forces are of one member, else per length out of the plane or per radian."""
    basis = Basis(MeshQuad().translated((1.0, 0.0)), ElementVector(ElementQuad1()), intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(1e4, 0.0), coordinates=coordinates)
    tie = sc.Bar(basis, (2.0, 1.0), (2.0, 3.0), EA=1e3, fixed_end=True, spacing=spacing)
    model = sc.Model({"block": solid, "tie": tie}, basis.get_dofs().all("u^1"))
    result = model.run([sc.Stage("hang", model.weight(20.0))], progress=False)
    sc.set_units("kN", "m")
    assert f"force [{unit}]" in result["hang"].table("tie").titles
    assert f"tie [{unit}]" in result.table().titles
    rows = report_tables.parameters(result, {}).rows
    units = {name: written for part, name, _, written, _ in rows if part == "tie"}
    assert units["EA"] == units["yield_force"] == unit


def test_stiffnesses_of_beams_are_of_a_member_or_of_a_length(without_units) -> None:
    sc.set_units("kN", "m")
    ends = [(0.0, 0.0), (0.0, -4.0)]
    forms = {
        "wall": sc.Beam(None, ends, EI=1e3, EA=1e6, Mp=9.0),
        "row": sc.Beam(None, ends, EI=1e3, EA=1e6, Mp=9.0, spacing=2.0),
    }
    fixed = [dofs for beam in forms.values() for dofs in beam.dofs((0.0, -4.0))]
    result = sc.Model(forms, fixed).run([sc.Stage("none")], progress=False)
    units = {}
    for part, name, _, unit, _ in report_tables.parameters(result, {}).rows:
        units[part, name] = unit
    assert [units["wall", name] for name in ("EI", "EA", "Mp")] == ["kNm²/m", "kN/m", "kNm/m"]
    assert [units["row", name] for name in ("EI", "EA", "Mp")] == ["kNm²", "kN", "kNm"]


def test_section_forces_in_space_are_forces_and_moments(without_units):
    """Of a whole member; in the plane they are those of a unit of length."""
    sc.set_units("kN", "m")
    mast = sc.Beam(None, [(0.0, 0.0, 0.0), (0.0, 0.0, 4.0)], EI=1e3, EA=1e6, GJ=1e3)
    model = sc.Model({"mast": mast}, mast.dofs((0.0, 0.0, 0.0)))
    push = model.forms["mast"].load((1.0, 2.0, -3.0), at=(0.0, 0.0, 4.0), moment=(0.0, 0.0, 1.0))
    result = model.run([sc.Stage("push", push)], progress=False)
    titles = set(result["push"].table("mast").titles)
    assert {"N [kN]", "V x [kN]", "M y [kNm]", "T [kNm]", "z [m]"} <= titles
    assert {"mast N [kN]", "mast M [kNm]", "mast T [kNm]"} <= set(result.table().titles)
    bent = result["push"].section_forces("mast").towards((-1.0, 0.0, 0.0))
    figure = plot.diagram(bent, "M")
    assert figure.axes[0].get_ylabel() == "moment M [kNm]"
    wall = sc.Beam(None, [(0.0, 0.0), (0.0, -4.0)], EI=1e3, EA=1e6)
    model = sc.Model({"wall": wall}, wall.dofs((0.0, -4.0)))
    push = model.forms["wall"].load((1.0, -3.0), at=(0.0, 0.0))
    result = model.run([sc.Stage("push", push)], progress=False)
    assert {"wall N [kN/m]", "wall M [kNm/m]"} <= set(result.table().titles)
