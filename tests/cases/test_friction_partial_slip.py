"""Partial slip of two cylinders: cases C1, C2, C9, S2, S24 and S25."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.results import Result, Tractions
from tests.oracles.halfplane import contact_modulus, hertz
from tests.oracles.partial_slip import PartialSlip, loaded, unloaded
from tests.tools.helpers import grid, vector_basis

#: Case B1 (ii): two cylinders, R = 8, E = 200, under P = 10.  Stiffer and flatter by the same
#: factor they have the same tractions, and displacements that are as small as the theory has them.
STIFFER = 1000.0
E, NU, RADIUS, FORCE, MU, SHEAR = 200.0 * STIFFER, 0.3, 4.0 * STIFFER, 10.0, 0.2, 0.93616
A, PEAK = hertz(FORCE, RADIUS, contact_modulus(E, NU, E, NU))
RATIO = SHEAR / (MU * FORCE)
LOADED = loaded(PEAK, A, MU, RATIO)


class Cylinders:
    """Two boxes whose edges move as those of two half-planes do: nothing is cut off."""

    def __init__(self, n: int, ratio: float = 0.8, **options) -> None:
        mesh = sc.join_bodies({"lower": box(round(ratio * n)), "upper": turned(box(n))})
        self.basis = vector_basis(mesh, "Q1", intorder=2)
        E_upper = options.pop("E_upper", E)
        options = {"law": sc.Coulomb(MU), "quadrature": 4, **options}
        self.pair = sc.ContactPair(self.basis, "upper:top", "lower:top", **options)
        materials = {
            "lower": sc.LinearElastic(E=E, nu=NU),
            "upper": sc.LinearElastic(E=E_upper, nu=NU),
        }
        solid = sc.SolidForm(self.basis, materials)
        self.forms = choose_penalties({"bodies": solid, "contact": self.pair})
        sides = {
            f"{body}:{side}" for body in ("lower", "upper") for side in ("left", "right", "bottom")
        }
        self.fixed = self.basis.get_dofs(sides).all()

    def stage(self, name: str, exact: PartialSlip, increments: int = 1) -> sc.Stage:
        """Displacements of the edges under the exact tractions, such that the middles of both
        surfaces meet.
        """
        x = self.basis.zeros()
        middle = field(exact, np.zeros(1), np.zeros(1))
        for body, sign in (("lower", 1.0), ("upper", -1.0)):
            dofs = np.unique(self.basis.element_dofs[:, self.basis.mesh.subdomains[body]]).reshape(
                -1, 2
            )
            place = sign * self.basis.doflocs[:, dofs[:, 0]]
            # the same field, turned by 180 degrees, for the body above
            x[dofs] = sign * (field(exact, *place) - middle).T
        return sc.Stage(name, self.basis.zeros(), x, increments)

    def run(self, stages: list[sc.Stage], **options) -> Result:
        """The analysis."""
        return sc.Model(self.forms, self.fixed, newton=sc.Newton(tolerance=1e-10)).run(
            stages, progress=False, **options
        )


def field(exact: PartialSlip, x, y):
    """Displacements of the lower half-plane, (2, n)."""
    return exact.potential.displacement(x, np.minimum(y, -1e-12), E, NU)


def box(n: int):
    """3 a to both sides and 4 a deep, with n elements in a; its top is half of the gap's
    parabola.
    """
    half = np.concatenate(
        (np.linspace(0, 1.2, round(1.2 * n) + 1), np.geomspace(1.2, 3, n // 2 + 1)[1:])
    )
    y = np.concatenate((np.linspace(0, 1, n + 1), np.geomspace(1, 4, n // 2 + 1)[1:]))
    mesh = grid("Q1", A * np.concatenate((-half[:0:-1], half)), -A * y[::-1])
    x, y = mesh.p
    return replace(mesh, doflocs=np.stack((x, y - x**2 / (4 * RADIUS) * (1 + y / (4 * A)))))


def turned(mesh):
    return replace(mesh, doflocs=-mesh.doflocs)


# -- C1 and C2: there and back

PRESSED = PartialSlip(PEAK, A)
WAY = [loaded(PEAK, A, MU, share * RATIO) for share in (0.25, 0.5, 0.75, 1.0)]
BACK = [unloaded(PEAK, A, MU, RATIO, share * RATIO) for share in (0.5, 0.0, -0.5, -1.0)]


def there_and_back(cylinders: Cylinders) -> list[sc.Stage]:
    """Pressed, shifted in four steps, and back in four steps to the opposite shear force."""
    named = [("press", PRESSED)]
    named += [(f"shift {k}", exact) for k, exact in enumerate(WAY)]
    named += [(f"back {k}", exact) for k, exact in enumerate(BACK)]
    return [cylinders.stage(*one) for one in named]


@pytest.fixture(scope="module", params=[1.0, 0.8], ids=["matching", "not matching"])
def cycle(request) -> tuple[float, list[Tractions]]:
    """The meshes' ratio and the tractions after every stage, 20 elements in the half-width."""
    cylinders = Cylinders(20, request.param)
    result = cylinders.run(there_and_back(cylinders))
    return request.param, [stage.tractions("contact") for stage in result]


def shear_error(joint: Tractions, exact: PartialSlip) -> float:
    """Error of the shear traction in the L2 norm, over the norm of the friction mu p."""
    difference = (joint.shear - exact.shear(joint.x)) ** 2 @ joint.weight
    return float(np.sqrt(difference / ((MU * exact.pressure(joint.x)) ** 2 @ joint.weight)))


def test_figures_of_the_oracle() -> None:
    """[X] C1: the numbers of the case: c / a, q(0) and q(c)."""
    c = LOADED.ellipses[1][1]
    assert c == pytest.approx(0.496511, rel=2e-6) and c / A == pytest.approx(0.729328, rel=2e-6)
    assert LOADED.shear(np.array([0.0, c])) == pytest.approx([0.506229, 1.279571], rel=2e-6)
    x = np.linspace(-A, A, 20001)
    assert np.trapezoid(LOADED.shear(x), x) == pytest.approx(SHEAR, rel=1e-5)
    assert np.trapezoid(BACK[1].shear(x), x) == pytest.approx(0, abs=1e-5)  # locked in, in balance


def test_cattaneo_mindlin(cycle) -> None:
    """[X] C1: shear force, traction and width of the stick zone, pushed step by step under a
    constant pressure.
    """
    ratio, joints = cycle
    for joint, exact in zip(joints[1:5], WAY, strict=True):
        # the kinks at c and a lie inside of elements, whose length is a / 20
        assert shear_error(joint, exact) < (0.03 if ratio == 1.0 else 0.05)
    joint = joints[4]
    assert joint.pressure @ joint.weight == pytest.approx(FORCE, rel=5e-3)  # order h^1.5: 0.2 %
    assert joint.shear @ joint.weight == pytest.approx(SHEAR, rel=5e-3)
    middle = np.abs(joint.x) < 0.1 * A
    assert joint.shear[middle] == pytest.approx(LOADED.shear(joint.x[middle]), rel=0.03)
    stuck = np.abs(joint.x[joint.status == Status.STICK])
    assert stuck.max() == pytest.approx(
        LOADED.ellipses[1][1], abs=A / 20 / ratio
    )  # an element of the coarser mesh


def test_way_back(cycle) -> None:
    """[X] C2: slip comes back from the edges, the middle keeps what it was sheared to."""
    _, joints = cycle
    for joint, exact in zip(joints[5:], BACK, strict=True):
        # three kinks, and twice the height of those of the way there
        assert shear_error(joint, exact) < 0.06
    locked = joints[6]
    assert abs(locked.shear @ locked.weight) < 2e-3 * MU * FORCE
    assert locked.shear.max() > 0.2 * MU * PEAK and locked.shear.min() < -0.2 * MU * PEAK


def test_opposite_force_has_the_opposite_traction(cycle) -> None:
    """[X] C2: at Q = -Qmax all that came before is forgotten."""
    ratio, joints = cycle
    there, back = joints[4], joints[8]
    # on meshes that do not match, pressing leaves tractions, 4 % of the friction at these sizes,
    # which stay where the bodies never slip
    difference = np.sqrt(
        (there.shear + back.shear) ** 2 @ there.weight / ((MU * there.pressure) ** 2 @ there.weight)
    )
    assert difference < (2e-3 if ratio == 1.0 else 0.05)
    assert back.shear @ back.weight == pytest.approx(-there.shear @ there.weight, rel=1e-3)


# -- C9: similar bodies


def pressed(E_upper: float, quadrature, mu: float) -> Tractions:
    """Cylinders of which the upper one has another stiffness, pressed together."""
    cylinders = Cylinders(10, 1.0, law=sc.Coulomb(mu), quadrature=quadrature, E_upper=E_upper)
    result = cylinders.run([cylinders.stage("press", PRESSED)])
    return result[0].tractions("contact")


@pytest.mark.parametrize("quadrature", ["nodal", 4])
def test_friction_plays_no_part_between_similar_bodies(quadrature) -> None:
    """[X] C9: Dundurs' beta is zero: the pressure does not feel the friction; it does where one
    body is stiffer.
    """
    without, with_friction = pressed(E, quadrature, 0.0), pressed(E, quadrature, 10.0)
    assert np.abs(with_friction.pressure - without.pressure).max() < 1e-6 * PEAK
    without, with_friction = pressed(3 * E, quadrature, 0.0), pressed(3 * E, quadrature, 10.0)
    assert np.abs(with_friction.pressure - without.pressure).max() > 0.02 * PEAK
    assert np.abs(with_friction.shear).max() > 0.2 * PEAK
    # the shear traction is antisymmetric but for nodes that face joints: these belong to one of the
    # two facets
    assert abs(with_friction.shear @ with_friction.weight) < 3e-5 * FORCE


# -- S2: the tangential penalty


def shifted(ratio: float, **options) -> tuple[float, float]:
    """Shear force over mu P, and error of the traction, with a tangential penalty of a ratio to the
    normal one.
    """
    cylinders = Cylinders(10, **options)
    pair = cylinders.forms["contact"]
    normal = pair.penalty[0]
    cylinders.forms["contact"] = pair.with_penalty(normal, ratio * normal, stiffness=pair.stiffness)
    stages = there_and_back(cylinders)[:5]
    joint = cylinders.run(stages)[-1].tractions("contact")
    return float(joint.shear @ joint.weight / (MU * FORCE)), shear_error(joint, LOADED)


@pytest.mark.slow
@pytest.mark.parametrize("quadrature", ["nodal", 4])
def test_soft_tangential_penalty(quadrature) -> None:
    """[X] S2: it converges from 1e-6 on. The softer the stick, the more of the shear force is
    missing.

    The bodies are shifted by what Q displaces them: 40 % of Q are missing at a hundredth of the
    normal penalty, 5 % at a tenth of it, and at the same penalty no more than the mesh costs.
    """
    force, error = np.array(
        [shifted(ratio, quadrature=quadrature) for ratio in (1e-6, 1e-4, 1e-2, 1e-1, 1.0)]
    ).T
    assert (np.diff(force) > 0).all() and (np.diff(error) < 0).all()
    assert force[1] == pytest.approx(
        100 * force[0], rel=0.05
    )  # next to nothing: rigid bodies on springs
    assert 0.5 * RATIO < force[2] < 0.7 * RATIO and 0.93 * RATIO < force[3] < 0.98 * RATIO
    assert force[4] == pytest.approx(RATIO, rel=5e-3)


@pytest.mark.slow
def test_augmented_shear_does_not_depend_on_the_penalty() -> None:
    """[X] S2: the augmented method gives one answer from 1e-6 to 1e6 times the normal penalty."""
    options = {"quadrature": 2, "enforcement": sc.AugmentedLagrangian()}
    force, error = np.array([shifted(10.0**k, **options) for k in (-6, -3, 0, 3, 6)]).T
    assert np.ptp(force) < 1e-3 * force.mean()  # ten times the method's tolerance
    assert (
        force == pytest.approx(RATIO, rel=0.01) and (error < 0.1).all()
    )  # ten elements in the half-width


# -- S24 and S25: the same again


@pytest.mark.slow
@pytest.mark.parametrize("quadrature", ["nodal", 4, "segments"])
def test_the_same_again(quadrature, tmp_path) -> None:
    """[X] S24, S25: two runs agree bit by bit; so do two continuations of the middle of the way
    back, one saved.
    """
    first, second = (Cylinders(10, quadrature=quadrature) for _ in range(2))
    whole, again = (cylinders.run(there_and_back(cylinders)) for cylinders in (first, second))
    assert_identical(whole, again)
    stages = there_and_back(first)
    middle = first.run(stages[:7])
    middle.save(tmp_path / "middle.npz")
    loaded_result = sc.load_result(tmp_path / "middle.npz", second.forms)
    continued, resumed = (
        first.run(stages[7:], start=middle),
        second.run(stages[7:], start=loaded_result),
    )
    assert_identical(continued, resumed)
    # a matrix that is factored anew rounds in another way
    np.testing.assert_allclose(resumed[-1].x, whole[-1].x, atol=1e-12 * np.abs(whole[-1].x).max())
    shear, other = (result[-1].states["contact"].traction[1] for result in (whole, resumed))
    np.testing.assert_allclose(shear, other, atol=1e-10 * PEAK)


def assert_identical(a: Result, b: Result) -> None:
    """Displacements and contact states agree bit by bit."""
    for one, other in zip(a, b, strict=True):
        assert np.array_equal(one.x, other.x) and one.iterations == other.iterations
        for name, value in vars(one.states["contact"]).items():
            assert np.array_equal(value, getattr(other.states["contact"], name), equal_nan=True)
