"""A string over a drum, node by node: case C8."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.sparse import coo_matrix

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.results import Result, StageResult
from tests.tools.helpers import body_along, vector_basis


@dataclass(frozen=True)
class String(sc.Form):
    """Straight, elastic bars that turn with their ends.

    Attributes
    ----------
    dofs, line
        Layout and places of the nodes in their order, (n, 2).
    n_unknowns
        Number of all unknowns.
    stiffness, pretension
        Tension per strain, and without any.
    """

    dofs: np.ndarray
    line: np.ndarray
    n_unknowns: int
    stiffness: float
    pretension: float

    def bars(self, x):
        """Directions, lengths and tensions, (n - 1, 2) and (n - 1,)."""
        length = np.linalg.norm(np.diff(self.line, axis=0), axis=1)
        way = np.diff(self.line + x[self.dofs], axis=0)
        now = np.linalg.norm(way, axis=1)
        return way / now[:, None], now, self.pretension + self.stiffness * (now / length - 1)

    def assemble(self, x, state):
        direction, length, tension = self.bars(x)
        pull = tension[:, None] * direction
        force = np.bincount(self.dofs[:-1].ravel(), -pull.ravel(), self.n_unknowns)
        force += np.bincount(self.dofs[1:].ravel(), pull.ravel(), self.n_unknowns)
        return sc.Response(force, lambda: None, lambda: self._stiffness(direction, length, tension))

    def _stiffness(self, direction, length, tension):
        along = direction[:, :, None] * direction[:, None, :]
        reference = np.linalg.norm(np.diff(self.line, axis=0), axis=1)
        block = (self.stiffness / reference)[:, None, None] * along
        block += (tension / length)[:, None, None] * (np.eye(2) - along)
        K = np.block([[block, -block], [-block, block]])
        dofs = np.concatenate((self.dofs[:-1], self.dofs[1:]), axis=1)
        rows, columns = np.repeat(dofs, 4, axis=1), np.tile(dofs, (1, 4))
        return coo_matrix(
            (K.ravel(), (rows.ravel(), columns.ravel())), shape=(self.n_unknowns,) * 2
        ).tocsr()


class Capstan:
    """A weight of one hangs on the left end of the string, which lies over an angle of a drum of
    radius one.

    n nodes on the drum, where the string turns by theta / n each, and tails that lie along the
    tangents at the ends of the angle.  The right end is pulled along its tail.  By default the
    string is so stiff, and the drum so hard, that it is stretched by 1e-7 and sinks in by 1e-8 of
    the radius: all kinks keep their angle.
    """

    def __init__(
        self,
        n: int,
        mu: float,
        theta: float,
        stiffness: float = 1e7,
        penalty: float = 1e8,
        pretension: float = 0.0,
    ) -> None:
        kink = theta / n
        angle = (np.arange(n) + 0.5) * kink
        line = np.stack((-np.cos(angle), np.sin(angle)), axis=1)
        tail = 3.0  # its end lies farther from the drum than what is adjusted to touch it
        self.end = np.array([np.sin(theta), np.cos(theta)])
        line = np.vstack((line[0] - [0, tail], line, line[-1] + tail * self.end))
        # boundaries belong to bodies: a strip along the string, of next to no stiffness, is held at
        # its other side
        mesh = body_along(line[::-1], thickness=0.1)
        basis = vector_basis(mesh, "Q1")
        distance = np.linalg.norm(mesh.p[:, :, None] - line.T[:, None, :], axis=0)
        self.string = String(
            basis.nodal_dofs[:, distance.argmin(axis=0)].T, line, basis.N, stiffness, pretension
        )
        drum = sc.rigid.circle((0.0, 0.0), 1.0)
        pair = sc.ContactPair(
            basis, "face", drum, sc.Coulomb(mu), quadrature="nodal", initial="adjusted"
        )
        self.forms = {
            "string": self.string,
            "drum": pair.with_penalty(penalty, penalty, stiffness=1.0),
            "strip": sc.SolidForm(basis, sc.LinearElastic(E=1e-14 * stiffness, nu=0.0)),
        }
        held = np.setdiff1d(np.arange(basis.N), self.string.dofs)
        self.fixed = np.concatenate((held, self.string.dofs[-1]))
        self.weight = basis.zeros()
        self.weight[self.string.dofs[0, 1]] = -1.0

    def run(self, pull: float, increments: int) -> Result:
        """Hung up, and pulled."""
        x = np.zeros_like(self.weight)
        x[self.string.dofs[-1]] = pull * self.end
        stages = [sc.Stage("hang", self.weight), sc.Stage("pull", self.weight, x, increments)]
        # round-off of the places times the penalty is 1e-8
        newton = sc.Newton(tolerance=1e-7, max_iterations=40)
        return sc.Model(self.forms, self.fixed, newton=newton).run(stages, progress=False)

    def tensions(self, stage: StageResult) -> np.ndarray:
        """Tension in the bars, from the weight on."""
        return self.string.bars(stage.x)[2]

    def ratio(self, stage: StageResult, mu: float | np.ndarray) -> float:
        """Exact ratio of the last tension to the first where all nodes slide to the right, as they
        lie.

        With a bar that falls off by a from the tangent at a node, and the one after it by b: T2 cos
        b - T1 cos a = mu N and N = T1 sin a + T2 sin b.  Friction does its work along the drum's
        surface: a node that has sunk in to the radius r moves by r times as much, and is held by mu
        N / r.
        """
        direction = self.string.bars(stage.x)[0]
        place = (self.string.line + stage.x[self.string.dofs])[1:-1]
        radius = np.linalg.norm(place, axis=1)
        normal, mu = place / radius[:, None], mu / radius
        before, after = direction[:-1], direction[1:]
        sin_a, cos_a = (
            (before * normal).sum(axis=1),
            before[:, 0] * normal[:, 1] - before[:, 1] * normal[:, 0],
        )
        sin_b, cos_b = (
            -(after * normal).sum(axis=1),
            after[:, 0] * normal[:, 1] - after[:, 1] * normal[:, 0],
        )
        return float(np.prod((cos_a + mu * sin_a) / (cos_b - mu * sin_b)))


def equal_kinks(n: int, mu: float, theta: float) -> float:
    """Ratio of the tensions over n equal kinks with bisecting normals."""
    half = theta / (2 * n)
    return float(((np.cos(half) + mu * np.sin(half)) / (np.cos(half) - mu * np.sin(half))) ** n)


def test_figures_of_the_case() -> None:
    """[X] C8: the numbers of the case, and the order of the discrete value."""
    values = [equal_kinks(n, 0.3, np.pi) for n in (8, 16, 32, 64)]
    assert values == pytest.approx([2.601050, 2.574854, 2.568453, 2.566862], abs=5e-7)
    error = np.array(values) - np.exp(0.3 * np.pi)
    assert np.log2(error[:-1] / error[1:]) == pytest.approx(2, abs=0.04)


@pytest.mark.parametrize(("mu", "theta"), [(0.3, np.pi), (0.5, np.pi / 2)])
@pytest.mark.parametrize("n", [8, 16, 32, 64])
def test_equal_kinks(n: int, mu: float, theta: float) -> None:
    """[X] C8: the exact value of the string with n kinks: hung up it slides one way, then it is
    pulled the other.
    """
    capstan = Capstan(n, mu, theta)
    hung, pulled = capstan.run(2e-6, 1)
    exact = equal_kinks(n, mu, theta)
    for stage, value in ((hung, 1 / exact), (pulled, exact)):
        tension = capstan.tensions(stage)
        assert (stage.states["drum"].status[1:-1] == Status.SLIP).all()
        assert (stage.states["drum"].status[[0, -1]] == Status.OPEN).all()
        # the slide of 2e-6 of the radius turns the normals by as much
        assert tension[-1] / tension[0] == pytest.approx(value, rel=1e-6)
        # from kink to kink
        np.testing.assert_allclose(tension[1:] / tension[:-1], value ** (1 / n), rtol=1e-6)


@pytest.mark.parametrize(("mu", "theta"), [(0.3, np.pi), (0.5, np.pi / 2)])
def test_finite_slide(mu: float, theta: float) -> None:
    """[X] C8: slid by 0.4 of the way to the next node, the string has the exact ratio for the kinks
    that it has.
    """
    capstan = Capstan(16, mu, theta, stiffness=1e3, penalty=1e4, pretension=1.0)
    result = capstan.run(0.4 * theta / 16, 20)
    tension = capstan.tensions(result[-1])
    assert (result[-1].states["drum"].status[1:-1] == Status.SLIP).all()
    exact = capstan.ratio(result[-1], mu)
    assert (
        abs(exact / equal_kinks(16, mu, theta) - 1) > 1e-3
    )  # the tails leave the drum at other angles
    assert tension[-1] / tension[0] == pytest.approx(exact, rel=1e-6)
