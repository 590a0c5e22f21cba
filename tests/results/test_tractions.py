"""Tractions and reports of contact pairs: resultants, signs, angles, errors."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.interface import ContactState
from skfem_contact.contact.laws import Status
from skfem_contact.results import Tractions
from skfem_contact.results.tractions import contact_report, interfaces, tractions
from tests.tools.helpers import body_along, facing, grid, rough_pair, vector_basis

LAW = sc.Coulomb(mu=0.3, adhesion=0.2)


def sliding_block(
    shift: float, down: float = 1e-3, adhesion: float = 0.0
) -> tuple[sc.ContactPair, np.ndarray, ContactState]:
    """A block on a base, pressed down and moved sideways."""
    base, block = grid("Q1", np.linspace(0, 4, 9), [0, 1]), grid("Q1", np.linspace(1, 2, 4), [1, 2])
    mesh = sc.join_bodies({"base": base, "block": block})
    basis = vector_basis(mesh, "Q1")
    law = sc.Coulomb(mu=0.3, adhesion=adhesion)
    pair = sc.ContactPair(basis, "block:bottom", "base:top", law, quadrature="nodal", penalty=1e4)
    x = basis.zeros()
    nodes = basis.nodal_dofs[:, np.unique(mesh.t[:, mesh.subdomains["block"]])]
    x[nodes[0]], x[nodes[1]] = shift, -down
    return pair, x, pair.assemble(x, pair.initial_state()).state


def test_facets_whose_points_differ_have_the_status_of_most_of_the_closed_area() -> None:
    """[X] Gauss weights 5/18, 8/18, 5/18: the first point slips or is open, the others stick."""
    base, block = grid("Q1", [0, 3], [0, 1]), grid("Q1", [1, 2], [1, 2])
    mesh = sc.join_bodies({"base": base, "block": block})
    basis = vector_basis(mesh, "Q1")
    pair = sc.ContactPair(
        basis, "block:bottom", "base:top", sc.Coulomb(mu=0.3), quadrature=3, penalty=1e4
    )
    forms = {"body": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.0)), "joint": pair}
    model = sc.Model(forms, np.arange(basis.N))
    nodes = basis.nodal_dofs[:, np.unique(mesh.t[:, mesh.subdomains["block"]])]
    far = mesh.p[0, nodes[0] // 2] - 1.0

    stages = []
    for gap in (2e-4, 0.0):  # at the left end; the right end penetrates by 1e-3 more
        x = basis.zeros()
        x[nodes[0]] = 5e-5  # a trial friction of 0.5, 0.3 of a penetration of 1.7e-4
        x[nodes[1]] = gap - 1e-3 * far
        stages.append(sc.Stage(f"{gap}", prescribed=x))
    in_part, whole = (
        next(iter(interfaces(model.run([stage], progress=False)[0]).values())) for stage in stages
    )
    np.testing.assert_array_equal(np.sort(in_part.tractions.status), [0, 1, 1])
    np.testing.assert_array_equal(np.sort(whole.tractions.status), [1, 1, 2])
    for facet, closed in ((in_part.on_facets(), 13 / 18), (whole.on_facets(), 1.0)):
        assert facet["closed"] == pytest.approx(closed)
        assert facet["status"] == Status.STICK


@pytest.mark.parametrize("shift", [0.1, -0.1])
def test_signs_of_a_sliding_block(shift):
    """[X] Pressure 10, friction 3: the block drags the base along, the base holds the block
    back.
    """
    pair, x, state = sliding_block(shift)
    joint = tractions(pair, state)
    way = np.sign(shift)  # the top of the base runs from left to right: its body is on the right
    np.testing.assert_allclose(joint.pressure, 10.0)
    np.testing.assert_allclose(joint.shear, way * 3.0)
    np.testing.assert_allclose(joint.slip, shift)
    np.testing.assert_allclose(joint.gap, -1e-3)
    assert (joint.status == Status.SLIP).all()
    np.testing.assert_allclose(joint.weight.sum(), 1.0)
    np.testing.assert_allclose(
        joint.arc, 2.0 - joint.x
    )  # the block's bottom runs from right to left
    np.testing.assert_allclose(joint.y, 1.0)

    report = contact_report(pair, x, state)
    np.testing.assert_allclose(report.normal, (0, 10), atol=1e-12)
    np.testing.assert_allclose(report.tangential, (-way * 3, 0), atol=1e-12)
    assert (report.open, report.stick, report.slip) == (0, 0, 4)
    assert report.mobilised == pytest.approx(0.3)
    assert report.penetration == pytest.approx(3e-3)  # of a third
    assert "0 stick, 4 slip, 0 open" in str(report)


def test_friction_of_a_joint_without_pressure() -> None:
    """[X] Adhesion alone holds a joint: it has friction, and no ratio of it to the pressure."""
    pair, x, state = sliding_block(1e-6, down=0.0, adhesion=0.2)
    report = contact_report(pair, x, state)
    assert report.friction == pytest.approx(0.01)
    assert (report.stick, report.pressure, report.mobilised) == (4, 0.0, 0.0)


@pytest.mark.parametrize("element", ["Q1", "Q2"])
@pytest.mark.parametrize("quadrature", ["nodal", 3, "segments"])
@pytest.mark.parametrize("options", [{}, {"share": 0.5}])
def test_resultant_is_the_sum_of_nodal_forces(element, quadrature, options, rng):
    """[X] On a bent, displaced interface with open, sticking and slipping points."""
    _, pair, x, state = rough_pair(element, quadrature, LAW, rng, **options)
    out = pair.assemble(x, state)
    report = contact_report(pair, x, out.state)
    on_slave = -pair.assemble(x, out.state).force[pair.slave.dofs].sum(axis=0)
    tolerance = 1e-9
    if (
        element == "Q2"
    ):  # friction works on the master's curve, at a distance of the gap times its curvature
        tolerance = 0.01
    if quadrature == "segments":  # the stick points are interpolated to the new cuts
        tolerance = 0.05
    np.testing.assert_allclose(report.force, on_slave, atol=tolerance * np.abs(on_slave).max())
    joint = tractions(pair, out.state)
    np.testing.assert_allclose(report.pressure, (joint.weight * joint.pressure).sum())
    np.testing.assert_allclose(report.friction, (joint.weight * np.abs(joint.raw_shear)).sum())
    assert report.open + report.stick + report.slip == len(joint.arc)


def test_force_around_a_corner():
    """[X] A point whose closest point is a vertex is pressed along the line between them."""
    corner = body_along([(-1, -1), (0, 0), (1, -1)])
    flat = body_along([(0.5, 0.05), (-0.5, 0.05)])
    basis = facing(flat, corner)
    pair = sc.ContactPair(
        basis, "slave:face", "master:face", sc.Coulomb(mu=0.5), quadrature=1, penalty=1e3
    )
    x = basis.zeros()
    x[pair.slave.dofs[:, 1]] = -0.06
    x[pair.slave.dofs[:, 0]] = 0.002
    out = pair.assemble(x, pair.initial_state())
    assert out.force.any()
    report = contact_report(pair, x, out.state)
    np.testing.assert_allclose(report.force, -out.force[pair.slave.dofs].sum(axis=0), atol=1e-9)


def test_central_angle_runs_clockwise_from_the_crown():
    x, y = np.array([0.0, 1.0, 0.0, -1.0]) + 5.0, np.array([1.0, 0.0, -1.0, 0.0]) - 2.0
    zero = np.zeros(4)
    joint = Tractions(zero, x, y, *[zero] * 9)
    np.testing.assert_allclose(joint.central_angle((5.0, -2.0)), [0, 90, 180, 270])


def test_state_of_another_form_is_refused():
    pair, x, state = sliding_block(0.1)
    basis = facing(body_along([(3, 0), (2, 0), (1, 0)]), body_along([(0, 0), (4, 0)]))
    other = sc.ContactPair(basis, "slave:face", "master:face", LAW, quadrature=3)
    with pytest.raises(
        ValueError, match="the state of 'skin' belongs to another form: ContactState"
    ):
        sc.results.of({"skin": other}, x, {"skin": state})
    with pytest.raises(
        ValueError, match=rf"displacements of 'skin' have shape \({pair.size - 2},\)"
    ):
        sc.results.of({"skin": pair}, x[:-2], {"skin": state})
    with pytest.raises(ValueError, match="'skin' is no form"):
        sc.results.of({"skin": "skin"}, x, {"skin": state})


@pytest.mark.parametrize("element", ["Q1", "Q2"])
@pytest.mark.parametrize("quadrature", [2, 4, "segments"])
@pytest.mark.one_in(2)
def test_pressure_does_not_ripple(element, quadrature):
    """[X] On a rigid circle raw tractions ripple within facets, by 4 % and more; those that the
    elements see do not.

    They make the same nodal forces, and change nothing where points of a facet differ in their
    status.
    """
    x = np.linspace(-1, 1, 81)
    basis = vector_basis(
        sc.join_bodies({"block": grid(element, x, -(np.linspace(0, 1, 13)[::-1] ** 1.5))}), element
    )
    forms = {
        "block": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(
            basis, "block:top", sc.rigid.circle((0.0, 5.0), 5.0), sc.Coulomb(), quadrature
        ),
    }
    up, bottom = basis.zeros(), basis.get_dofs("block:bottom")
    up[bottom.all("u^2")] = 0.02
    state = (
        sc.Model(forms, bottom.all())
        .run([sc.Stage("press", basis.zeros(), up)], progress=False)[0]
        .states["joint"]
    )
    joint, points = tractions(forms["joint"], state), forms["joint"].points(state)

    def forces(pressure):
        share = points.values * (points.weight * pressure)[:, None]
        return np.bincount(points.nodes.ravel(), share.ravel())

    expected = forces(joint.raw_pressure)
    np.testing.assert_allclose(forces(joint.pressure), expected, atol=1e-12 * expected.max())
    np.testing.assert_array_equal(joint.pressure > 0.0, joint.raw_pressure > 0.0)
    inner = np.abs(joint.x) < 0.15  # half of the contact; p^2 of Hertz is a parabola
    t = joint.x[inner] ** 2

    def ripple(pressure):
        p = pressure[inner]
        return np.abs(p / np.sqrt(np.polyval(np.polyfit(t, p**2, 2), t)) - 1.0).max()

    assert ripple(joint.pressure) < 0.002  # measured 0.1 % and less
    if (element, quadrature) in (("Q1", 4), ("Q1", "segments")):
        assert ripple(joint.raw_pressure) > 0.03


@pytest.mark.parametrize(("n", "place"), [(3, 0.0), (8, 0.0), (3, 1e3)])
@pytest.mark.parametrize("enforcement", [None, sc.AugmentedLagrangian(), sc.DualMultipliers()])
def test_pressure_balances_an_eccentric_load(enforcement, n, place):
    """[X] Force 10 and moment 1 by equilibrium: the load is 10 + 12 x over a column of width 1, at
    the origin or far from it.
    """
    width = np.linspace(place - 0.5, place + 0.5, n + 1)
    mesh = sc.join_bodies({"column": grid("Q1", width, [0, 1, 2])})
    basis = vector_basis(mesh, "Q1", intorder=2)
    floor = sc.rigid.line((place - 2.0, 0.0), (place + 2.0, 0.0))
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.0)),
        "joint": sc.ContactPair(
            basis, "column:bottom", floor, sc.Coulomb(mu=1.0), enforcement=enforcement
        ),
    }
    model = sc.Model(forms)
    load = model.traction(
        "column:top", lambda x: np.array([0.0 * x[0], -10.0 - 12.0 * (x[0] - place)])
    )
    joint = model.run([sc.Stage("press", load)], progress=False)["press"].tractions("joint")
    for pressure in (joint.pressure, joint.raw_pressure):
        assert (pressure * joint.weight).sum() == pytest.approx(10.0, rel=1e-6)
        assert (pressure * joint.weight * (joint.x - place)).sum() == pytest.approx(1.0, rel=1e-3)
