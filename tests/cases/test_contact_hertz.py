"""Hertz' contact: cases B1, B2 and B5."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from skfem import FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
from skfem_contact.nonlinear.step import Step, _Balance
from tests.oracles.halfplane import contact_modulus, elliptic, hertz
from tests.tools.curved import curved, graded
from tests.tools.helpers import ELEMENTS, vector_basis
from tests.tools.indentation import NU, E, displacement, pressed

RADIUS, FORCE = 10.0, 10.0  # case B1 (iii)
#: The exact solution is that of small displacements: radius and force of the tests are divided and
#: multiplied by this.
SHALLOW = 1e-4
A, PEAK = hertz(FORCE, RADIUS, contact_modulus(E, NU))


def box(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Lines of the box of 3 a by 4 a: the contact ends in the middle of an element, n of them are
    within it.
    """
    x = A / (n + 0.5) * np.arange(2 * n + 1)
    x = np.concatenate((x, np.linspace(x[-1], 3 * A, n // 2 + 1)[1:]))
    y = -A * np.concatenate((np.linspace(0, 1, n + 1), np.linspace(1, 4, n + 1)[1:]))
    return x, y[::-1]


def parabola(exact, scale: float) -> sc.Surface:
    """The punch where it stands in the exact solution; it reaches beyond the contact."""
    place = displacement(exact, 0.0, 0.0, -4 * A)[1]
    height = A**2 / (2 * RADIUS) * scale
    window = (-A / 2, 1.5 * A, place - 0.1 * height, place + 2 * height)
    return sc.rigid.level_set(lambda x, y: place + scale * x**2 / (2 * RADIUS) - y, window)


def shallow(element: str, n: int, **options):
    """The box under the shallow parabola, and the exact solution."""
    exact = elliptic(SHALLOW * PEAK, A)
    return pressed(element, *box(n), exact, parabola(exact, SHALLOW), **options), exact


def pressure(scale: float):
    """Hertz' pressure."""
    return lambda x: scale * PEAK * np.sqrt(np.maximum(0.0, 1 - (x / A) ** 2))


def test_numbers_of_the_half_plane():
    """[X] B1 (iii), B2: what is printed there, from the potential."""
    exact = elliptic(PEAK, A)
    assert pytest.approx((0.340389, 18.702703), rel=1e-6) == (A, PEAK)  # digits printed
    stress = exact.stress(A * np.array([0, 1, 2]), -A * np.array([0.5, 1, 3])).T
    printed = [
        [-6.389606, -16.728206, 0.0],
        [-3.599554, -6.575451, 4.063852],
        [-1.255444, -3.076068, 1.901114],
    ]
    np.testing.assert_allclose(stress, printed, atol=5e-7)
    moved = displacement(exact, A * np.array([0, 1]), -A * np.array([0.5, 1]), -4 * A)
    moved = moved - displacement(exact, np.zeros(1), -4 * A * np.ones(1), -4 * A)
    np.testing.assert_allclose(
        moved.T, [[0.0, -0.008892034], [0.000570771, -0.004200855]], atol=5e-10
    )
    across, down, _ = exact.stress(0.0, -0.78615 * A)
    assert (across - down) / 2 == pytest.approx(0.300283 * PEAK, rel=1e-6)


#: Least orders of the force, of the pressure as a whole and on 80 % of the contact, and of the
#: displacements, for measured ones of 2.2, 1.04, 2.2, 2.1 (Q1), 2.2, 1.19, 1.5, 2.0 (P1), 2.4,
#: 1.01, 2.7, 2.5 (Q2), 2.3, 1.01, 3.1, 2.4 (QuadS2) and 2.7, 1.02, 1.6, 2.9 (P2).
ORDERS = {
    "Q1": (1.8, 0.95, 1.8, 1.8),
    "P1": (1.8, 0.95, 1.2, 1.8),
    "Q2": (1.8, 0.95, 2.3, 2.0),
    "QuadS2": (1.8, 0.95, 2.3, 2.0),
    "P2": (1.8, 0.95, 1.3, 2.0),
}


@pytest.mark.slow
@pytest.mark.parametrize("element", ELEMENTS)
def test_order_of_convergence(element):
    """[X] B2: a Signorini problem with an exact solution, 4 to 16 elements in the half-width of the
    contact.

    At its edge the pressure falls like a root to zero within an element: the error of the whole is
    of the first order for every element, with smaller factors for the quadratic ones; away from the
    edge their order is higher.
    """
    errors = []
    for n in (4, 8, 16):
        run, exact = shallow(element, n)
        whole, inner = (
            run.pressure_error(pressure(SHALLOW), within) for within in (3 * A, 0.8 * A)
        )
        errors.append(
            [abs(run.force / (SHALLOW * FORCE) - 1), whole, inner, run.displacement_error(exact)]
        )
    orders = np.log(np.array(errors[0]) / errors[-1]) / np.log(16.5 / 4.5)
    assert (orders >= ORDERS[element]).all()
    assert errors[-1][0] < 3e-3  # of the force; P1 2.4e-3, all others below 6e-4


@pytest.mark.parametrize(("element", "error"), [("Q1", 0.04), ("Q2", 0.002)])
def test_stresses_in_the_box(element, error):
    """[X] B2: at all points below a quarter of the half-width; measured 0.028 and 0.0010 of the
    largest pressure.
    """
    run, exact = shallow(element, 16)
    place = run.basis.global_coordinates()
    inside = place[1] < -0.25 * A
    difference = run.stage.states["box"].stress[[0, 1, 3]] - exact.stress(*place)
    assert np.abs(difference[:, inside]).max() < error * SHALLOW * PEAK


def round_punch(element: str, n: int, **options):
    """The punch of case B1 (iii), a circle, on the box."""
    exact = elliptic(PEAK, A)
    place = displacement(exact, 0.0, 0.0, -4 * A)[1]
    return pressed(
        element, *box(n), exact, sc.rigid.circle((0.0, place + RADIUS), RADIUS), **options
    )


@pytest.mark.parametrize("element", ["Q1", "Q2"])
def test_rigid_cylinder(element):
    """[X] B1 (iii): strains of 2 % and a circle instead of a parabola leave 1 % (measured 0.7 %) of
    the force.
    """
    run = round_punch(element, 12)
    x, _, computed = run.pressure
    assert run.force == pytest.approx(FORCE, rel=0.01)
    assert computed[np.argmin(x)] == pytest.approx(
        PEAK, rel=0.005
    )  # stated: 1 to 3 %; measured 0.1 %
    assert x[computed > 0.02 * PEAK].max() == pytest.approx(A, abs=A / 12)  # an element
    assert run.pressure_error(pressure(1.0), 3 * A) < 0.03


def newton_steps(monkeypatch: pytest.MonkeyPatch) -> list[list[tuple[float, np.ndarray]]]:
    """Of every equilibrium that will be found: residuals and active sets (status and segment) of
    its iterations.
    """
    steps: list[list[tuple[float, np.ndarray]]] = []
    direction, equilibrium = _Balance.direction, Step.equilibrium

    def active(states):
        return np.stack((states["punch"].status, states["punch"].facet))

    def iteration(self, now, damped):
        steps[-1].append((now.norm, active(now.states)))
        return direction(self, now, damped)

    def whole(self, *args):
        steps.append([])
        found = equilibrium(self, *args)
        now = self.system.evaluate(found.x, self.states, self.load)
        steps[-1].append((now.norm, active(found.states)))
        return found

    monkeypatch.setattr(_Balance, "direction", iteration)
    monkeypatch.setattr(Step, "equilibrium", whole)
    return steps


@pytest.mark.parametrize("quadrature", ["nodal", 4])
@pytest.mark.parametrize("element", ["Q1", "Q2"])
def test_order_of_newton(element, quadrature, monkeypatch):
    """[X] B5: B1 (iii) in three steps of at most eight iterations; once the active set has settled,
    r_new <= r^2.

    That holds for all iterations from there on, down to round-off; the residual then is 1e-3 to
    0.2, so that these are one to three.  Longer sequences, of large displacements, are those of
    ``test_quadratic_convergence``.
    """
    steps = newton_steps(monkeypatch)
    newton = sc.Newton(tolerance=1e-13)  # no end before round-off
    round_punch(element, 8, increments=3, quadrature=quadrature, enforcement=None, newton=newton)
    assert len(steps) == 3
    for step in steps:
        norms, sets = zip(*step, strict=True)
        assert len(norms) <= 9 and norms[-1] < 1e-10
        settled = next(
            k for k in range(len(sets)) if all(np.array_equal(a, sets[-1]) for a in sets[k:])
        )
        assert norms[settled] > 1e-4  # far above round-off, which is 1e-13 of the largest force
        assert all(after <= max(before**2, 1e-13) for before, after in pairwise(norms[settled:]))


def cylinder_on_block(n: int):
    """Case B1 (i), half of it: curved elements, n of the cylinder and 0.8 n of the block in the
    half-width.
    """
    radius, force = 50.0, 35000.0
    a, peak = hertz(force, radius, contact_modulus(210e3, 0.3, 70e3, 0.3))

    def rounded(x, y):
        profile = radius - np.sqrt(radius**2 - x**2)
        return x, profile + (1 - profile / radius) * y

    meshes = {}
    for name, h, width, sign, depth, shape in (
        ("cylinder", a / n, 45.0, 1, radius, rounded),
        ("block", 1.25 * a / n, 100.0, -1, 200.0, lambda x, y: (x, y)),
    ):
        y = np.sort(sign * graded(h, 0.6 * a, depth))
        meshes[name] = curved(
            MeshQuad.init_tensor(graded(h, 1.4 * a, width), y).with_defaults(), shape
        )
    basis = vector_basis(sc.join_bodies(meshes), "Q2")
    steel, aluminium = sc.LinearElastic(E=210e3, nu=0.3), sc.LinearElastic(E=70e3, nu=0.3)
    forms = {
        "bodies": sc.SolidForm(basis, {"cylinder": steel, "block": aluminium}),
        "contact": sc.ContactPair(basis, "cylinder:bottom", "block:top", sc.Coulomb(), "segments"),
    }
    top = FacetBasis(basis.mesh, basis.elem, facets="cylinder:top")
    load = LinearForm(lambda v, w: -0.5 * force / 45.0 * v[1]).assemble(top)
    return basis, forms, load, a, peak


def test_two_bodies():
    """[X] B1 (i), NAFEMS: a steel cylinder on a block of aluminium: p0 = 3585.362, a = 6.214628."""
    n = 10
    basis, forms, load, a, peak = cylinder_on_block(n)
    assert (a, peak) == pytest.approx((6.214628, 3585.362), rel=1e-6)  # digits printed
    symmetry = basis.get_dofs({"cylinder:left", "block:left"}).all("u^1")
    fixed = np.union1d(symmetry, basis.get_dofs("block:bottom").all("u^2"))
    # set down first, as a press does; then the load holds the cylinder
    top, down = basis.get_dofs("cylinder:top").all("u^2"), basis.zeros()
    down[top] = -1.0
    stages = [sc.Stage("set down", basis.zeros(), down), sc.Stage("press", load, fixed=fixed)]
    result = sc.Model(forms, np.union1d(fixed, top)).run(stages, progress=False)
    joint = result["press"].tractions("contact")
    exact = peak * np.sqrt(np.maximum(0.0, 1 - (joint.x / a) ** 2))
    assert joint.weight @ joint.pressure == pytest.approx(
        17500.0, rel=0.005
    )  # normals tilt by a / R = 0.12
    assert joint.pressure[np.argmin(joint.x)] == pytest.approx(peak, rel=0.01)  # stated: 1 to 3 %
    assert joint.x[joint.pressure > 0.02 * peak].max() == pytest.approx(a, abs=a / n)  # an element
    assert np.sqrt(joint.weight @ (joint.pressure - exact) ** 2 / (joint.weight @ exact**2)) < 0.03


@pytest.mark.slow
def test_cylinder_that_the_load_alone_holds():
    """[X] B1 (i), S10: pressed by the load from the start, which nothing but the contact to come
    can bear.

    The gap beside the contact grows to 28 mm, many times what the bodies approach each other by.
    """
    basis, forms, load, _, peak = cylinder_on_block(4)
    symmetry = basis.get_dofs({"cylinder:left", "block:left"}).all("u^1")
    fixed = np.union1d(symmetry, basis.get_dofs("block:bottom").all("u^2"))
    result = sc.Model(forms, fixed).run([sc.Stage("press", load)], progress=False)["press"]
    assert len(result.iterations) == 1  # nothing was cut
    joint = result.tractions("contact")
    assert joint.weight @ joint.pressure == pytest.approx(17500.0, rel=0.005)
    assert joint.pressure[np.argmin(joint.x)] == pytest.approx(peak, rel=0.01)  # measured 0.07 %
