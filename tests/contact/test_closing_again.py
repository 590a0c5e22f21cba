"""Bodies that lift off lose their tractions, and touch again where they come down."""

from __future__ import annotations

from copy import copy

import numpy as np
import pytest
from scipy.sparse import diags

import skfem_contact as sc
from skfem_contact.sparse import Gathering
from tests.tools.helpers import grid, vector_basis

METHODS = [None, sc.AugmentedLagrangian(), sc.DualMultipliers()]
IDS = ["penalty", "augmented", "dual"]
G = 40.0


class Inertia(sc.Form, sc.roles.Timed):
    """Inertia of a diagonal mass by Newmark's trapezoidal rule, with velocities at the start."""

    symmetric = True

    def __init__(self, mass: np.ndarray, velocity: np.ndarray) -> None:
        self.mass, self.velocity = mass, velocity
        self.size, self.dt = len(mass), 0.0

    def over(self, duration: float) -> Inertia:
        new = copy(self)
        new.dt = duration
        return new

    def initial_state(self, x=None):
        zero = np.zeros(self.size)
        return zero, self.velocity, zero

    def assemble(self, x, state):
        u, v, a = state
        new_a = 4.0 / self.dt**2 * (x - u - self.dt * v) - a
        new_v = v + 0.5 * self.dt * (a + new_a)
        K = diags(4.0 / self.dt**2 * self.mass).tocsr()
        return sc.Response(self.mass * new_a, lambda: (x, new_v, new_a), lambda: K)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize("enforcement", METHODS, ids=IDS)
def test_bouncing_block(enforcement) -> None:
    """[X] A block that hits a plate flies off, and hits it again instead of falling through:
    momentum is balanced.
    """
    # The wave speed is 100: in touch for .02, then in the air for .2 while the weight grows
    mesh = grid("Q1", [0.0, 0.1], np.linspace(0.0, 1.0, 6))
    basis = vector_basis(mesh, "Q1", intorder=2)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.0), unit_weight=G)
    upright = basis.get_dofs().all("u^2")
    mass, velocity = basis.zeros(), basis.zeros()
    mass[upright] = -sc.weight(solid, 1.0)[upright]
    velocity[upright] = -1.0
    floor = sc.rigid.line((-1.0, 0.0), (2.0, 0.0))
    forms = {
        "block": solid,
        "inertia": Inertia(mass, velocity),
        "joint": sc.ContactPair(basis, "bottom", floor, sc.Coulomb(), enforcement=enforcement),
    }
    model = sc.Model(forms, basis.get_dofs().all("u^1"))
    increments, dt = 120, 2e-3
    stage = sc.Stage("bounce", model.weight(0.0), duration=increments * dt, increments=increments)
    found = []
    model.run([stage], progress=False, on_increment=found.append)

    # Nothing penetrates but what the penalty lets in: rho c v = 100 on 1.2e5 with 5 elements
    bottom = basis.get_dofs("bottom").all("u^2")
    depth = -min(part.x[bottom].min() for part in found)
    assert depth < (5e-3 if enforcement is METHODS[0] else 1e-4)

    # It touches, flies without any traction, and touches again
    force = np.array([part.contact("joint").force[1] for part in found])
    touches = np.abs(force) > 0.0
    assert np.count_nonzero(np.diff(touches.astype(int)) == 1) >= 1  # the first touch is before
    assert not any(found[k].states["joint"].traction.any() for k in np.flatnonzero(~touches))
    assert not any(found[k].states["joint"].multiplier.any() for k in np.flatnonzero(~touches))

    # The trapezoidal rule conserves momentum: m (v - v_0) = impulse of contact - m G T / 2
    whole = mass.sum()
    v = found[-1].states["inertia"][1]
    impulse = dt * (np.abs(force).sum() - 0.5 * abs(force[-1]))
    weight = 0.5 * whole * G * increments * dt
    assert mass @ (v - velocity) == pytest.approx(impulse - weight, abs=1e-5 * whole)


@pytest.mark.filterwarnings("ignore:.*no slave point|.*penalty compliance")
@pytest.mark.parametrize("height", [1e-3, 0.3, 3.0])
@pytest.mark.parametrize("element", ["Q1", "Q2", "P2"])
@pytest.mark.parametrize("enforcement", METHODS, ids=IDS)
@pytest.mark.one_in(3)
def test_lifted_and_pressed_again(enforcement, element: str, height: float) -> None:
    """[X] No tractions while a block is lifted, also beyond reach, and the same ones as at first
    once it is back.
    """
    low = grid(element, np.linspace(0, 1, 3), [-1.0, 0.0])
    up = grid(element, np.linspace(0, 1, 4), [0.0, 1.0])
    basis = vector_basis(sc.join_bodies({"low": low, "up": up}), element, intorder=4)
    law = sc.Coulomb(0.2)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.0)),
        "joint": sc.ContactPair(basis, "up:bottom", "low:top", law, enforcement=enforcement),
    }
    top = basis.get_dofs("up:top").all("u^2")
    sides = basis.get_dofs({"low:left", "up:left"}).all("u^1")
    fixed = np.unique(np.concatenate((basis.get_dofs("low:bottom").all("u^2"), top, sides)))
    stages = []
    for name, level in (("press", -0.02), ("lift", height), ("again", -0.02)):
        x = basis.zeros()
        x[top] = level
        stages.append(sc.Stage(name, prescribed=x))
    model = sc.Model(forms, fixed)
    result = model.run(stages, progress=False)
    lifted, first, again = result["lift"], result["press"], result["again"]
    state = lifted.states["joint"]
    assert not state.traction.any() and not state.multiplier.any()
    forces = lifted.reactions()[basis.get_dofs("low:bottom").all("u^2")]
    np.testing.assert_allclose(forces, 0.0, atol=1e-9)  # round-off of E times the height

    # E times the mean strain, in series with the default penalty
    pressures = [stage.tractions("joint").pressure for stage in (first, again)]
    assert pressures[0].min() > 8.0
    # Within the tolerance of the method: 1e-4 of displacements makes 3e-4 of pressures
    accuracy = 1e-3 if isinstance(enforcement, sc.AugmentedLagrangian) else 1e-4
    np.testing.assert_allclose(pressures[1], pressures[0].mean(), rtol=accuracy)
    if enforcement is not METHODS[0]:
        np.testing.assert_allclose(pressures[0], 10.0, rtol=accuracy)


def test_forces_of_no_points_are_no_integers() -> None:
    """[X] Sums over nothing can hold any number."""
    force = Gathering(3).force(np.zeros((0, 2), int), np.zeros((0, 2)))
    assert force.dtype == float and force.tolist() == [0.0, 0.0, 0.0]
