"""Identities of penalty, multipliers, closest points and smoothing: cases A1, A2, A6 and A8."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import ElementTriP2, FacetBasis, LinearForm

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.search import Projection, project
from skfem_contact.surfaces.shape import Shape
from skfem_contact.surfaces.smoothing import smoothed
from skfem_contact.surfaces.topology import following
from tests.tools.helpers import grid, vector_basis

MODULUS, FORCE, GAP = 1000.0, 100.0, 0.05


def found(surface: sc.Surface, points) -> Projection:
    """Closest points at any depth."""
    points = np.atleast_2d(np.asarray(points, float))
    return project(surface, surface.nodes, points, np.full(len(points), np.inf))


def column(quadrature, penalty: float):
    """A column that closes a gap against a rigid stop; ten times the stiffness, the penalty is
    never changed.
    """
    basis = vector_basis(grid("Q1", np.linspace(0, 1, 4), np.linspace(0, 1, 5)), "Q1")
    solid = sc.SolidForm(basis, sc.LinearElastic(E=MODULUS, nu=0.0))
    stop = sc.ContactPair(
        basis,
        "bottom",
        sc.rigid.line((-1.0, -GAP), (2.0, -GAP)),
        sc.Coulomb(),
        quadrature,
        enforcement=sc.AugmentedLagrangian(1e-12),
    ).with_penalty(penalty, penalty, stiffness=penalty / 10)
    fixed = np.concatenate(
        (basis.get_dofs("top").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    load = LinearForm(lambda v, w: -FORCE * v[1]).assemble(
        FacetBasis(basis.mesh, basis.elem, facets="bottom")
    )
    return {"column": solid, "stop": stop}, load, fixed


@pytest.mark.parametrize("eps", [1e3, 1e4, 1e5])
@pytest.mark.parametrize("quadrature", ["nodal", 2])
def test_rate_of_the_augmented_method(quadrature, eps):
    """[X] Cases A1, A2: the error of the multiplier shrinks by 1 / (1 + eps L / E) in each
    augmentation.

    Without one, the force errs by that share of its exact value F - EA g / L = 50.
    """
    forms, load, fixed = column(quadrature, eps)
    states = {name: form.initial_state() for name, form in forms.items()}
    x, exact, rate = np.zeros(len(load)), FORCE - MODULUS * GAP, 1 / (1 + eps / MODULUS)
    errors = [1.0]  # of no multiplier at all
    for _ in range(3):
        # the linear problem with closed contact, from closed contact
        x[1::2] = -1.1 * GAP
        x[fixed] = 0.0
        for _ in range(2):
            out = {name: form.assemble(x, states[name]) for name, form in forms.items()}
            residual = load - sum(o.force for o in out.values())
            free = np.setdiff1d(np.arange(len(x)), fixed)
            K = sum(o.stiffness for o in out.values()).toarray()[np.ix_(free, free)]
            x[free] += np.linalg.solve(K, residual[free])
        reached = forms["stop"].assemble(x, states["stop"])
        forms["stop"], states["stop"] = forms["stop"].outer(x, states["stop"], reached.state)
        np.testing.assert_allclose(states["stop"].penalty_factor, 1.0, rtol=1e-12)
        multiplier = states["stop"].multiplier[0]
        np.testing.assert_allclose(multiplier, multiplier.mean(), rtol=1e-10)
        errors.append(abs(-multiplier.mean() / exact - 1))
    # 1e-10 of the mass keeps multipliers that no point tells, in every augmentation
    np.testing.assert_allclose(errors[1:], rate ** np.arange(1, 4), rtol=0.0, atol=3e-10)


def test_open_nodes_get_no_multiplier():
    """[X] Case A2: what is open, is not augmented."""
    forms, load, fixed = column("nodal", 1e4)
    with pytest.warns(sc.AnalysisWarning, match="gap is"):
        result = sc.Model(forms, fixed).run([sc.Stage("pull", -load)], progress=False)["pull"]
    assert (result.states["stop"].status == Status.OPEN).all()
    assert not result.states["stop"].multiplier.any()


def test_multipliers_vanish_where_a_body_lifts_off():
    """[X] A block is pressed unevenly, then lifted: nothing presses on it, which takes one
    increment.
    """
    basis = vector_basis(grid("Q1", np.linspace(0, 2, 5), np.linspace(0, 1, 3)), "Q1")
    line, augmented = sc.rigid.line((-1, 0), (3, 0)), sc.AugmentedLagrangian()
    pair = sc.ContactPair(basis, "bottom", line, sc.Coulomb(), enforcement=augmented)
    top = basis.get_dofs("top")
    upwards, down, up = top.all("u^2"), basis.zeros(), basis.zeros()
    down[upwards], up[upwards] = -0.01 * (1 + basis.doflocs[0, upwards]), 0.01
    model = sc.Model(
        {"body": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)), "stop": pair}, top.all()
    )
    with pytest.warns(sc.AnalysisWarning, match="gap is"):
        stages = [sc.Stage("press", prescribed=down), sc.Stage("lift", prescribed=up)]
        lifted = model.run(stages, progress=False)["lift"]
    assert (lifted.states["stop"].status == Status.OPEN).all() and len(lifted.iterations) == 1
    assert not lifted.states["stop"].multiplier.any()


@pytest.mark.parametrize("radius", [0.5, 3.0])
def test_foot_on_a_parabola(radius, rng):
    """[X] Case A6: on y = x^2 / 2R the foot solves x^3 / 2R^2 + x (1 - y0 / R) - x0 = 0; one root
    for y0 < R.
    """
    ends = np.linspace(2, -2, 5) * radius  # three-node segments are parabolas; the body lies above
    middle = 0.5 * (ends[1:] + ends[:-1])
    x = np.concatenate((ends, middle))
    nodes = np.stack((x, x**2 / (2 * radius)), axis=1)
    number = np.arange(4)
    segments = np.stack((number, number + 1, number + 5), axis=1)
    surface = sc.Surface.of(
        "parabola",
        np.full((9, 2), -1),
        nodes,
        segments,
        Shape.of_facets(ElementTriP2()),
        following(4, closed=False),
    )
    points = radius * np.stack((rng.uniform(-1.2, 1.2, 200), rng.uniform(-1.0, 0.95, 200)), axis=1)
    where = found(surface, points)
    foot = surface.at(where.facet, where.xi, surface.nodes).x[0]
    for (x0, y0), place, gap in zip(points, foot, where.gap, strict=True):
        roots = np.roots([1 / (2 * radius**2), 0, 1 - y0 / radius, -x0])
        exact = roots[np.argmin(np.abs(roots.imag))].real
        assert place[0] == pytest.approx(
            exact, abs=1e-7 * radius
        )  # flat minimum near the centre of curvature
        distance = np.hypot(x0 - exact, y0 - exact**2 / (2 * radius))
        below = y0 < x0**2 / (2 * radius)
        assert gap == pytest.approx(distance if below else -distance, abs=1e-12 * radius)
    # at the centre of curvature the three roots are one, to which Newton's method goes in small
    # steps; the distance is right up to the fourth power of what is left
    where = found(surface, [0.0, radius])
    assert where.gap[0] == pytest.approx(-radius, rel=1e-4)


def test_centre_of_a_circle():
    """[X] Case A6: no unique foot; any point of the circle is one, at the distance R."""
    for hole, sign in ((False, -1), (True, 1)):
        where = found(sc.rigid.circle((2.0, 1.0), 3.0, hole), [[2.0, 1.0], [2.0 + 1e-14, 1.0]])
        np.testing.assert_allclose(
            where.gap, sign * 3.0, rtol=1e-9
        )  # the radius of the smoothed polygon ripples so


def test_smoothed_polygon():
    """[X] Case A8: joints at R cos(pi/n), middles at R/2 + R cos^2(pi/n) / 2; ripples for n =
    16.
    """
    n = 16
    angle, c = -2 * np.pi / n * np.arange(n), np.cos(np.pi / n)
    facets = sc.rigid.polyline(np.stack((np.cos(angle), np.sin(angle)), axis=1), closed=True)
    curve = smoothed(facets)
    each = np.arange(n)
    for xi, radius in ((-1.0, c), (0.0, 0.5 + 0.5 * c**2), (1.0, c)):
        rho = curve.at(each, np.full((n, 1), xi), curve.nodes).x[0]
        np.testing.assert_allclose(np.linalg.norm(rho, axis=1), radius, rtol=1e-14)
    assert 0.5 * (1 - c) ** 2 == pytest.approx(1.85e-4, abs=5e-7)  # as printed
    assert 1 - c == pytest.approx(1.92e-2, abs=5e-5)


@pytest.mark.parametrize("alpha", [0.1, 0.3, 0.5])
def test_tangents_at_the_joints(alpha, rng):
    """[X] Case A8: C1 on any chain, whatever the lengths of its facets: unit tangents equal to
    1e-14.
    """
    turn = np.cumsum(rng.uniform(-40, 40, 12))  # below the 45 degrees of real corners
    steps = rng.uniform(0.2, 2.0, 12)[:, None] * np.stack(
        (np.cos(np.radians(turn)), np.sin(np.radians(turn))), axis=1
    )
    curve = smoothed(sc.rigid.polyline(np.cumsum(steps, axis=0)), alpha)
    each, one = np.arange(len(curve.facets)), np.ones((len(curve.facets), 1))
    end, start = (curve.at(each, side * one, curve.nodes).x for side in (1, -1))
    np.testing.assert_allclose(end[0][:-1], start[0][1:], atol=1e-13)  # places of size 10
    unit = [rho[1] / np.linalg.norm(rho[1], axis=1)[:, None] for rho in (end, start)]
    np.testing.assert_allclose(
        unit[0][:-1], unit[1][1:], atol=1e-14 * 10
    )  # stated; differences of places of size 10
