"""Section forces: equilibrium on any mesh, signs, rings, and what must not be mixed up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad1,
    ElementQuad2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshHex,
    MeshQuad,
    MeshQuad2,
)

import skfem_contact as sc
from skfem_contact import plot
from skfem_contact.results.sections import section_forces
from tests.oracles.rings import RingInGround, michell
from tests.tools.helpers import ELEMENTS, distorted, grid, rotation, vector_basis

# Sums of some thousand nodal forces that cancel.
ROUND_OFF = 1e-10
STEEL = sc.LinearElastic(E=1e4, nu=0.25)


def solved(form, load, fixed):
    """State of a loaded body."""
    stage = sc.Model({"body": form}, fixed).run([sc.Stage("load", load)], progress=False)["load"]
    return stage.states["body"]


def annulus(radii, n, curved=False):
    """Quadrilaterals between concentric circles, with the boundaries "inner" and "outer"."""
    angle = 2 * np.pi * np.arange(n) / n
    p = np.stack((np.outer(radii, np.cos(angle)).ravel(), np.outer(radii, np.sin(angle)).ravel()))
    i, j = (k.ravel() for k in np.indices((len(radii) - 1, n)))
    corner = [i * n + j, (i + 1) * n + j, (i + 1) * n + (j + 1) % n, i * n + (j + 1) % n]
    mesh = MeshQuad(p, np.stack(corner))
    facets = mesh.boundary_facets()
    middle = np.hypot(*mesh.p)[mesh.facets[:, facets]].mean(axis=0)
    sides = {
        "inner": facets[middle < 1.001 * radii[0]],
        "outer": facets[middle > 0.999 * radii[-1]],
    }
    if curved:
        straight = MeshQuad2.from_mesh(mesh)
        turn = (np.arctan2(straight.doflocs[1], straight.doflocs[0]) * n / (2 * np.pi)) % 1.0
        off = np.abs(turn - 0.5) < 0.25
        mesh = replace(straight, doflocs=straight.doflocs / np.where(off, np.cos(np.pi / n), 1.0))
    return mesh.with_boundaries(sides)


@pytest.mark.parametrize("element", ELEMENTS)
def test_loaded_at_its_tip(element, rng):
    """[X] Cantilever at an angle: forces follow from equilibrium on a distorted mesh, wherever it
    is cut.
    """
    turn = rotation(33.0)
    mesh = distorted(grid(element, np.linspace(0, 4, 17), np.linspace(-0.5, 0.5, 4)), rng, 0.03)
    tip = np.array([0.7, -1.3])  # along and across
    mesh = replace(mesh, doflocs=turn @ mesh.doflocs)
    form = sc.SolidForm(vector_basis(mesh, element), STEEL)
    ends = FacetBasis(mesh, form.basis.elem, facets="right")
    force = turn @ tip
    load = LinearForm(lambda v, w: force[0] * v[0] + force[1] * v[1]).assemble(ends)
    total = load.reshape(-1, 2).sum(axis=0)
    places = form.basis.doflocs[:, ::2].T
    state = solved(form, load, form.basis.get_dofs("left").all())

    start, end = turn @ (0.2, 0.05), turn @ (3.8, 0.05)
    section = section_forces(form, state, sc.Cuts.line(start, end, depth=1.2, n=37))
    expected = (total @ turn[:, 0], total @ turn[:, 1])
    np.testing.assert_allclose(section.N, expected[0], rtol=ROUND_OFF)
    np.testing.assert_allclose(section.V, expected[1], rtol=ROUND_OFF)
    arm = places[None] - np.column_stack((section.x, section.y))[:, None]
    f = load.reshape(-1, 2)
    moment = (arm[..., 1] * f[:, 0] - arm[..., 0] * f[:, 1]).sum(axis=1)
    np.testing.assert_allclose(section.M, moment, atol=ROUND_OFF * np.abs(moment).max())
    np.testing.assert_allclose(np.gradient(section.M, section.position), section.V, rtol=ROUND_OFF)


@pytest.mark.parametrize("element", ["Q1", "Q2", "QuadS2"])
def test_own_weight_between_lines_of_nodes(element):
    """[X] A hanging bar carries the weight below every cut, also between two lines of nodes."""
    mesh = grid(element, [0.0, 0.5, 1.0], np.linspace(0, 10, 21))
    form = sc.SolidForm(vector_basis(mesh, element), sc.LinearElastic(E=1e4, nu=0.0))
    state = solved(form, sc.weight(form.basis, 20.0), form.basis.get_dofs("top").all())
    cuts = sc.Cuts.line((0.5, 9.7), (0.5, 0.3), depth=1.0, n=41)
    section = section_forces(form, state, cuts)
    np.testing.assert_allclose(section.N, 20.0 * section.y, rtol=ROUND_OFF)
    np.testing.assert_allclose(section.M, 0.0, atol=1e-8)  # of a weight of 200


def test_ends_of_a_body_carry_what_acts_there():
    """[X] At both ends of a bar the forces are those of its last layer."""
    mesh = grid("Q1", np.linspace(0, 4, 9), np.linspace(-0.5, 0.5, 3))
    form = sc.SolidForm(vector_basis(mesh, "Q1"), STEEL)
    pull = LinearForm(lambda v, w: 3.0 * v[0] - 2.0 * v[1]).assemble(
        FacetBasis(mesh, form.basis.elem, facets="right")
    )
    state = solved(form, pull, form.basis.get_dofs("left").all())
    section = section_forces(form, state, sc.Cuts.line((0, 0), (4, 0), depth=1.0, n=5))
    np.testing.assert_allclose(section.N, 3.0, rtol=ROUND_OFF)
    np.testing.assert_allclose(section.V, -2.0, rtol=ROUND_OFF)
    np.testing.assert_allclose(section.M, 2.0 * (4 - section.position), atol=1e-9)


def test_positive_moment_stretches_the_left_fibres():
    """[X] u_x = k x y bends a beam: tension above a rightward axis, below a leftward one."""
    mesh = grid("Q2", np.linspace(0, 4, 9), np.linspace(-0.5, 0.5, 3))
    form = sc.SolidForm(vector_basis(mesh, "Q2"), sc.LinearElastic(E=1200.0, nu=0.0))
    x, y = form.basis.doflocs[:, ::2]
    bent = np.column_stack((1e-3 * x * y, -0.5e-3 * x**2)).ravel()
    state = form.assemble(bent, form.initial_state()).state
    for start, end, sign in (((0.5, 0), (3.5, 0), 1.0), ((3.5, 0), (0.5, 0), -1.0)):
        section = section_forces(form, state, sc.Cuts.line(start, end, depth=1.0, n=6))
        np.testing.assert_allclose(section.M, sign * 0.1, rtol=1e-9)  # E I k, I = 1/12
        np.testing.assert_allclose(section.N, 0.0, atol=1e-12)


@pytest.mark.parametrize("curved", [False, True])
def test_ring_under_pressure(curved):
    """[X] Thrust of the polygon and of the circle; moment of Lame's stresses about the middle of
    the wall.
    """
    inner, outer, p, n = 0.72, 0.9, 100.0, 48
    mesh = annulus(np.linspace(inner, outer, 5), n, curved)
    element = ElementVector(ElementQuad2() if curved else ElementQuad1())
    form = sc.SolidForm(Basis(mesh, element, intorder=4), sc.LinearElastic(E=2.8e7, nu=0.2))
    pressure = LinearForm(lambda v, w: -p * (w.n[0] * v[0] + w.n[1] * v[1]))
    load = pressure.assemble(FacetBasis(mesh, element, facets="outer", intorder=4))
    right, top, left = form.basis.nodal_dofs[:, [0, n // 4, n // 2]].T
    state = solved(form, load, np.array([right[1], top[0], left[1]]))
    section = section_forces(form, state, sc.Cuts.ring((0, 0), inner, outer, n))
    if curved:  # half an element to both sides: a quarter of the polygon's angle, squared
        np.testing.assert_allclose(section.N, -p * outer, rtol=(np.pi / n) ** 2)
    else:  # bars along the facets that balance the facets' loads at the corners
        np.testing.assert_allclose(section.N, -p * outer * np.cos(np.pi / n) ** 2, rtol=1e-9)
    np.testing.assert_allclose(section.V, 0.0, atol=1e-3)
    between = section_forces(
        form, state, sc.Cuts.ring((0, 0), inner, outer, 50)
    )  # two on lines of nodes
    for name in ("N", "M"):  # the same all around, up to the round-off of the linear solver
        np.testing.assert_allclose(getattr(between, name), getattr(section, name)[0], rtol=1e-6)

    lame = np.linalg.solve(
        np.array([michell(0, r, 1.0, 2.2)[0] for r in (inner, outer)]), [0.0, -p]
    )
    t, w = np.polynomial.legendre.leggauss(10)
    half = 0.5 * (outer - inner)
    hoop = [michell(0, 0.5 * (inner + outer) + half * s, 1.0, 2.2)[1] @ lame for s in t]
    moment = half**2 * (w * t) @ hoop
    # the thrust runs along chords: off the circle by its radius times half the square of half an
    # angle
    sagitta = 0.5 * (np.pi / n) ** 2 * outer * (0.1 if curved else 1.0)
    np.testing.assert_allclose(section.M, moment, atol=p * outer * sagitta)
    assert abs(moment) > 1.5 * p * outer * sagitta


def test_cuts_of_a_ring_reach_from_circle_to_circle():
    """[X] Clockwise from the crown, with the outer circle to the left."""
    center, inner, outer, n = np.array([3.0, 1.0]), 1.0, 3.0, 8
    cuts = sc.Cuts.ring(center, inner, outer, n)
    angle = np.radians(cuts.position)
    outward = np.column_stack((np.sin(angle), np.cos(angle)))
    np.testing.assert_allclose(cuts.position, np.arange(n) * 45.0)
    for radius, side in ((inner, -1.0), (outer, 1.0)):
        s, offset = cuts.local(np.arange(n), center + radius * outward)
        np.testing.assert_allclose(s, 0.0, atol=1e-12)
        np.testing.assert_allclose(offset, side * cuts.half_depth, rtol=1e-12)
    np.testing.assert_allclose(cuts.curvature, 0.5)


def test_cuts_off_the_lines_of_nodes_interpolate():
    """[X] Ring under the exact tractions of bonded ground: odd angles are as good as lines of
    nodes.
    """
    exact = RingInGround(0.72, 0.9, 2.8e7, 0.2, 3e4, 0.3, 100.0, 50.0)
    mesh = annulus(np.linspace(0.72, 0.9, 5), 72)
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    form = sc.SolidForm(basis, sc.LinearElastic(E=2.8e7, nu=0.2))
    r, theta = np.hypot(*mesh.p), np.arctan2(mesh.p[1], mesh.p[0])
    stress = exact.field(r, theta, ring=True)
    load = basis.zeros()
    outer = np.flatnonzero(r > 0.8999)
    t = stress[[0, 2]][:, outer] * (2 * np.pi * 0.9 / 72)  # traction times tributary length
    cos, sin = np.cos(theta[outer]), np.sin(theta[outer])
    load[basis.nodal_dofs[0, outer]] = t[0] * cos - t[1] * sin
    load[basis.nodal_dofs[1, outer]] = t[0] * sin + t[1] * cos
    three = np.array([basis.nodal_dofs[1, 0], basis.nodal_dofs[0, 18], basis.nodal_dofs[1, 36]])
    state = solved(form, load, three)

    errors = []
    for offset in (0.0, 0.3, 0.5):  # of an element
        cuts = sc.Cuts.ring((0, 0), 0.72, 0.9, 72)
        turn = rotation(-offset * 5.0)
        cuts = replace(
            cuts,
            position=cuts.position + offset * 5.0,
            center=cuts.center @ turn.T,
            axis=cuts.axis @ turn.T,
        )
        section = section_forces(form, state, cuts)
        N, M = exact.section_forces(np.radians(90.0 - section.position))
        errors.append(
            (np.abs(section.N / N - 1).max(), np.abs(section.M - M).max() / np.abs(M).max())
        )
    # second order in an element's angle of 5 degrees; a chord is off the circle by 0.7 mm: 0.6 % of
    # M
    assert np.max(errors, axis=0)[0] < 0.002
    assert np.max(errors, axis=0)[1] < 0.0065


@pytest.mark.parametrize("far", [2.0, 20.0], ids=["small elements", "larger than the ring"])
def test_bodies_of_one_form_are_told_apart(far):
    """[X] A solid with two rings, one in the other: the cuts of the inner one see the inner one
    only, at their own side.
    """
    parts = {
        "ring": annulus(np.linspace(0.72, 0.9, 4), 36),
        "ground": annulus(np.linspace(0.9, far, 6), 24),
    }
    mesh = sc.join_bodies(parts)
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    x = 1e-3 * np.random.default_rng(1).standard_normal(basis.N)
    both = sc.SolidForm(basis, dict.fromkeys(parts, STEEL))
    ring = sc.SolidForm(basis.with_elements("ring"), STEEL)
    cuts = sc.Cuts.ring((0, 0), 0.72, 0.9, 50)
    of_both, of_ring = (
        section_forces(form, form.assemble(x, form.initial_state()).state, cuts)
        for form in (both, ring)
    )
    for name in ("N", "V", "M"):
        np.testing.assert_allclose(getattr(of_both, name), getattr(of_ring, name), atol=1e-9)
    assert np.abs(of_ring.N).min() > 0


def test_what_is_no_solid_is_refused():
    basis = vector_basis(grid("Q1", [0, 1, 2], [0, 1]), "Q1")
    bar = sc.Bar(basis, (0, 0), (2, 0), EA=1.0)
    stage = sc.results.of({"bar": bar}, basis.zeros(), {"bar": bar.initial_state()})
    with pytest.raises(ValueError, match=r"'bar' is a Bar, no SolidForm; there are \[\]"):
        stage.section_forces("bar", sc.Cuts.line((0, 0.5), (2, 0.5), depth=1.0))


def test_a_cut_beside_the_body_is_refused():
    form = sc.SolidForm(vector_basis(grid("Q1", [0, 1, 2], [0, 1]), "Q1"), STEEL)
    with pytest.raises(ValueError, match=r"2 of 4 sections cut no element .* \(3, 0.5\)"):
        section_forces(form, form.initial_state(), sc.Cuts.line((1, 0.5), (4, 0.5), depth=1.0, n=4))
    for inner, outer in ((0.9, 0.72), (0.0, 1.0), (np.nan, 1.0)):
        with pytest.raises(ValueError, match=r"inner < outer|must be a finite number"):
            sc.Cuts.ring((0, 0), inner, outer)
    with pytest.raises(ValueError, match="different ends"):
        sc.Cuts.line((0, 0), (0, 0), depth=1.0)


@pytest.mark.parametrize("n", [0, 1, 2.5])
def test_a_number_of_cuts_that_is_none_is_refused(n):
    """At a single cut of a line nothing would tell its two ends."""
    with pytest.raises(ValueError, match=r"integer, at least 2, not|n must be a whole number"):
        sc.Cuts.line((0, 0), (1, 0), depth=1.0, n=n)
    assert len(sc.Cuts.ring((0, 0), 0.5, 1.0, n=1).position) == 1
    with pytest.raises(ValueError, match=r"integer, at least 1, not|n must be a whole number"):
        sc.Cuts.ring((0, 0), 0.5, 1.0, n=n if n != 1 else -1)


@pytest.mark.parametrize("point", [(0, 0, 0), 1.0, (0, np.nan)])
def test_points_that_are_not_in_the_plane_are_refused(point):
    for cut in (
        lambda: sc.Cuts.line(point, (1, 0), 1.0),
        lambda: sc.Cuts.line((1, 0), point, 1.0),
        lambda: sc.Cuts.ring(point, 0.5, 1.0),
    ):
        with pytest.raises(
            ValueError, match=r"of the sections must be a finite \(x, y|must be finite numbers"
        ):
            cut()


def test_coordinates_of_the_plane_and_of_space_are_named():
    """A ring lies in the plane; a line in space has an end in space."""
    with pytest.raises(ValueError, match=r"must be a finite \(x, y\), not \(0, 0, 0\)"):
        sc.Cuts.ring((0, 0, 0), 0.5, 1.0)
    with pytest.raises(ValueError, match=r"must be a finite \(x, y, z\), not \(1, 0\)"):
        sc.Cuts.line((0, 0, 0), (1, 0), 1.0)


def test_cuts_at_the_faces_of_walls():
    """[X] A portal frame: shear at the faces of its walls and thrust below its roof follow from
    statics.
    """
    q, span, depth = 50.0, 2.4, 0.3
    across = np.concatenate(
        (np.linspace(-1.5, -1.2, 4), np.linspace(-1.2, 1.2, 25)[1:], np.linspace(1.2, 1.5, 4)[1:])
    )
    mesh = MeshQuad.init_tensor(
        across, np.append(np.linspace(0, 2, 21), np.linspace(2.0, 2.3, 4)[1:])
    ).to_meshtri()
    middle = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.remove_elements(np.flatnonzero((abs(middle[0]) < 1.2) & (middle[1] < 2.0)))
    mesh = mesh.with_boundaries({"top": lambda x: x[1] > 2.3 - 1e-9, "feet": lambda x: x[1] < 1e-9})
    basis = vector_basis(mesh, "P2")
    forms = {"frame": sc.SolidForm(basis, sc.LinearElastic(E=3e7, nu=0.2))}
    load = sc.traction(basis, "top", (0.0, -q))
    stage = sc.Model(forms, basis.get_dofs("feet").all()).run(
        [sc.Stage("q", load)], progress=False
    )["q"]
    roof = stage.section_forces("frame", sc.Cuts.line((-1.2, 2.15), (1.2, 2.15), depth, n=25))
    uneven = roof.V[
        12
    ]  # a mesh whose triangles are not symmetric: the walls carry .03 % more and less than half
    assert abs(uneven) < 4e-4 * q * span
    # the load of a facet at the face is shared by the nodes of both sides: a sixth of .1
    np.testing.assert_allclose(
        np.abs(roof.V[[0, -1]] - uneven), q * (span / 2 - 0.1 / 6), rtol=1e-6
    )
    np.testing.assert_allclose(
        np.abs(roof.V - uneven)[1:-1], q * np.abs(np.linspace(-1.2, 1.2, 25)[1:-1]), atol=1e-5
    )
    wall = stage.section_forces("frame", sc.Cuts.line((-1.35, 2.0), (-1.35, 0.0), depth, n=21))
    np.testing.assert_allclose(wall.N, -q * (span / 2 + depth), rtol=4e-4)
    np.testing.assert_allclose(wall.N, wall.N[10], rtol=1e-6)


def stretched(materials):
    """Return a plate of 4 by 1 that is stretched with the stress 3."""
    mesh = grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 1, 5)).with_subdomains(
        {"core": lambda x: abs(x[1] - 0.5) < 0.25, "skin": lambda x: abs(x[1] - 0.5) > 0.25}
    )
    basis = vector_basis(mesh, "Q1")
    form = sc.SolidForm(basis, materials)
    x = basis.zeros()
    x[basis.nodal_dofs[0]] = mesh.p[0]
    E, nu = STEEL.E, STEEL.nu
    x *= 3.0 / (E * (1 - nu) / (1 + nu) / (1 - 2 * nu))  # no strain across
    return form, form.assemble(x, form.initial_state()).state


def test_cuts_through_a_part_of_a_body_are_told(recwarn):
    """[X] A cut through half of a plate has half of its thrust, also at its ends, and a warning."""
    form, state = stretched(STEEL)
    assert np.allclose(section_forces(form, state, sc.Cuts.line((0, 0.5), (4, 0.5), 1.0, 5)).N, 3.0)
    assert not recwarn
    for axis, depth in ((0.5, 0.5), (0.0, 1.0)):
        with pytest.warns(
            sc.AnalysisWarning, match=r"at 5 of 5 .* position 0, the body continues beside the cut"
        ):
            part = section_forces(form, state, sc.Cuts.line((0, axis), (4, axis), depth, 5))
        assert np.allclose(part.N, 1.5)


def test_ends_of_a_body_that_is_welded_into_another(recwarn):
    """[X] The core of a plate ends where the plate does: thrust there is that of the core; nothing
    is remarked.
    """
    form, state = stretched({"core": STEEL, "skin": STEEL})
    core = section_forces(form, state, sc.Cuts.line((0, 0.5), (4, 0.5), 0.5, 5))
    assert np.allclose(core.N, 1.5) and not recwarn


def test_envelopes_in_space_are_those_of_a_plane():
    """[X] Section forces in space are vectors: extremes of their components at different stages are
    no forces.
    """
    mesh = MeshHex.init_tensor(
        np.linspace(0, 4, 5), np.linspace(-0.5, 0.5, 3), np.linspace(-0.5, 0.5, 3)
    )
    basis = vector_basis(
        mesh.with_boundaries({"root": lambda x: x[0] == 0.0, "tip": lambda x: x[0] == 4.0}), "Q2"
    )
    model = sc.Model({"bar": sc.SolidForm(basis, STEEL)}, basis.get_dofs("root").all())
    tip = model.traction("tip", (0.0, 0.0, 1.0))
    result = model.run([sc.Stage("up", tip), sc.Stage("down", -2.0 * tip)], progress=False)
    cuts = sc.Cuts.line((0, 0, 0), (4, 0, 0), depth=1.5, n=3)
    with pytest.raises(
        ValueError, match=r"vectors: an envelope is that of one plane of bending.*towards"
    ):
        result.envelope("bar", cuts)
    bent = {stage.name: stage.section_forces("bar", cuts).towards((0, 0, 1)) for stage in result}
    found = sc.results.Envelope.of(bent)
    np.testing.assert_allclose(found.smallest.M, [-4.0, -2.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(found.largest.M, [8.0, 4.0, 0.0], atol=1e-6)
    assert found.stages["M"][:, 0].tolist() == ["up", "down"]


def test_wall_of_a_cylinder() -> None:
    """[X] Lame: a pressure of 10 inside of a wall of radii 1 and 1.2, and 3 on its top; forces per
    length.
    """
    mesh = MeshQuad.init_tensor(np.linspace(1, 1.2, 3), np.linspace(0, 2, 9)).with_defaults()
    form = sc.SolidForm(
        Basis(mesh, ElementVector(ElementQuad2()), intorder=4), STEEL, coordinates="axisymmetric"
    )
    model = sc.Model({"body": form}, form.basis.get_dofs("bottom").all("u^2"))
    load = model.traction("left", (10.0, 0.0)) + model.traction("top", (0.0, -3.0))
    cuts = sc.Cuts.line((1.1, 1.5), (1.1, 0.3), depth=0.2, n=4)
    result = model.run([sc.Stage("in", load), sc.Stage("out", -2.0 * load)], progress=False)
    found = result["in"].section_forces("body", cuts)
    np.testing.assert_allclose(found.N, -3.0 * 0.22 / 1.1, rtol=1e-9)  # the half of 1.2^2 - 1
    np.testing.assert_allclose(
        found.M, -3.0 * (0.728 / 3 - 1.1 * 0.22) / 1.1, atol=1e-5
    )  # two elements across
    np.testing.assert_allclose(found.V, 0.0, atol=1e-4)
    np.testing.assert_allclose(found.N_hoop, 10.0, rtol=1e-5)  # the pressure times the inner radius
    mean = 10.0 / 0.44  # sigma = mean (1 + 1.44 / r^2)
    np.testing.assert_allclose(
        found.M_hoop, mean * (1.44 * (np.log(1.2) - 1.1 * (1 - 1 / 1.2))), rtol=1e-3
    )
    over = result.envelope("body", cuts)
    np.testing.assert_allclose(
        (over.smallest.N_hoop, over.largest.N_hoop), [[-20.0] * 4, [10.0] * 4], rtol=1e-5
    )
    assert over.stages["N_hoop"][:, 0].tolist() == ["out", "in"]


def test_circular_plate() -> None:
    """[X] Kirchhoff: moments of an even load on a plate that is simply supported, at its centre as
    well.
    """
    radius, depth, nu = 5.0, 0.25, STEEL.nu
    mesh = MeshQuad.init_tensor(
        np.linspace(0, radius, 31), np.linspace(0, depth, 3)
    ).with_defaults()
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    form = sc.SolidForm(basis, STEEL, coordinates="axisymmetric")
    edge = sc.dofs_at(basis, (radius, 0.5 * depth)).ravel()[1]
    model = sc.Model({"body": form}, [basis.get_dofs("left").all("u^1"), edge])
    stage = model.run([sc.Stage("even", model.traction("top", (0.0, -1.0)))], progress=False)[
        "even"
    ]
    cuts = sc.Cuts.line((0.0, 0.5 * depth), (4.0, 0.5 * depth), depth=depth, n=5)
    found, r = stage.section_forces("body", cuts), cuts.position
    # thick by a twentieth of its radius: shear adds less than half a percent
    np.testing.assert_allclose(found.M, -(3 + nu) / 16 * (radius**2 - r**2), rtol=5e-3)
    np.testing.assert_allclose(
        found.M_hoop, -((3 + nu) * radius**2 - (1 + 3 * nu) * r**2) / 16, rtol=5e-3
    )
    np.testing.assert_allclose(found.V, 0.5 * r, atol=1e-3)
    np.testing.assert_array_equal(stage.table("body", sections=cuts)["M_hoop"], found.M_hoop)


def test_pile_on_the_axis_of_revolution(request) -> None:
    """[X] A load of 7 on a cylinder of radius 0.5, and a weight of 2: a normal force per radian,
    nothing else.
    """
    mesh = MeshQuad.init_tensor(np.linspace(0, 0.5, 4), np.linspace(0, 3, 10)).with_defaults()
    form = sc.SolidForm(
        vector_basis(mesh, "Q2"), STEEL, coordinates="axisymmetric", unit_weight=2.0
    )
    model = sc.Model(
        {"body": form},
        [form.basis.get_dofs("bottom").all(), form.basis.get_dofs("left").all("u^1")],
    )
    result = model.run([sc.Stage("top", model.traction("top", (0.0, -7.0)))], progress=False)
    stage = result["top"]
    found = stage.section_forces("body", sc.Cuts.line((0.0, 2.0), (0.0, 1.0), depth=1.0, n=4))
    np.testing.assert_allclose(
        found.N, -0.125 * (7.0 + 2.0 * np.array([1.0, 4 / 3, 5 / 3, 2.0])), rtol=1e-9
    )
    assert not found.V.any() and not found.M.any()
    cuts = {"body": sc.Cuts.line((0.0, 2.0), (0.0, 1.0), depth=1.0, n=4)}
    request.addfinalizer(sc.set_units)
    sc.set_units("kN", "m")
    assert "N [kN/rad]" in stage.table("body", sections=cuts["body"]).titles
    assert "body N [kN/rad]" in result.table(sections=cuts).titles
    assert plot.diagram(found, "N").axes[0].get_ylabel() == "normal force N [kN/rad]"


def test_elements_within_the_depth():
    """[X] A strip of 1 within a plate of 2 under tension of 3 has N = 3; the plate goes on, which
    is told.
    """
    basis = vector_basis(grid("Q1", np.linspace(0, 4, 9), np.linspace(0, 2, 41)), "Q1")
    form = sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0))
    held = [*basis.get_dofs("left").all("u^1"), *basis.get_dofs("bottom").all("u^2")]
    model = sc.Model({"plate": form}, held)
    load = model.traction("right", (3.0, 0.0))
    stage = model.run([sc.Stage("pull", load)], progress=False)["pull"]
    cut = sc.Cuts.line((1.1, 1.0), (2.9, 1.0), depth=1.0, n=3)
    with pytest.warns(sc.AnalysisWarning, match="depth is 1: forces are those of the elements"):
        found = stage.section_forces("plate", cut)
    np.testing.assert_allclose(found.N, 3.0, rtol=1e-9)
