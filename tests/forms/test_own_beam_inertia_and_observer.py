"""Own forms, laws and observers of at most 40 lines: they run, are saved, resumed, reduced and
drawn.
"""

from __future__ import annotations

import inspect
import json
from copy import copy

import numpy as np
import pytest
from scipy.sparse import coo_matrix, csr_matrix

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis

QUIET = {"progress": False}
THICK = 0.2


class Beam(sc.Form):
    """Timoshenko beam of two-node elements along a line, with shear at one point, whose two sides
    can touch soil.
    """

    symmetric = True

    def __init__(self, points, EI, GA, EA, thickness):
        self.points, n = np.asarray(points, float), len(points)
        self.fields = (
            sc.Field("deflection", np.repeat(self.points, 2, axis=0).T),
            sc.Field("rotation", self.points.T, "rotation", scale=1.0 / thickness),
        )
        length = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        rows, columns, data = [], [], []
        for e, h in enumerate(length):
            t = (self.points[e + 1] - self.points[e]) / h
            q = np.array([-t[1], t[0]])
            stretch = np.concatenate((-t, t, [0.0, 0.0])) / h
            bend = np.array([0.0, 0.0, 0.0, 0.0, -1.0, 1.0]) / h
            shear = np.concatenate((-q / h, q / h, [-0.5, -0.5]))
            K = h * sum(s * np.outer(b, b) for s, b in ((EA, stretch), (EI, bend), (GA, shear)))
            dofs = np.r_[2 * e : 2 * e + 4, 2 * n + e, 2 * n + e + 1]
            rows, columns = [*rows, np.repeat(dofs, 6)], [*columns, np.tile(dofs, 6)]
            data.append(K.ravel())
        index = (np.concatenate(rows), np.concatenate(columns))
        self.K = coo_matrix((np.concatenate(data), index), shape=(3 * n, 3 * n)).tocsr()
        ends = np.column_stack((np.arange(n - 1), np.arange(1, n)))
        at = (self.fields[0], np.arange(2 * n).reshape(n, 2)), (self.fields[1], np.arange(n))
        left, right = (
            sc.Surface.from_cells(
                self.points, at[0], cells, name, rotations=at[1], thickness=thickness
            )
            for cells, name in ((ends, "left"), (ends[::-1, ::-1], "right"))
        )
        self.sides = {"left": left, "right": right}

    def numbered(self, numbers):
        new = copy(self)
        new.dofs = np.concatenate([numbers[field] for field in self.fields])
        return new

    def assemble(self, x, state):
        return sc.Response(self.K @ x[self.dofs], lambda: None, lambda: self.K, dofs=self.dofs)


def walled(soil, mu=0.2):
    """Two blocks of soil on rollers with a beam between them, from y = 0 to 2: model and beam."""
    y = np.linspace(0, 2, 9)
    blocks = {
        "low": grid("Q1", np.linspace(-1 - THICK / 2, -THICK / 2, 5), y),
        "high": grid("Q1", np.linspace(THICK / 2, 1 + THICK / 2, 5), y),
    }
    basis = vector_basis(sc.join_bodies(blocks), "Q1", intorder=2)
    beam = Beam(np.column_stack((0 * y, y)), EI=1e4, GA=1e6, EA=1e6, thickness=THICK)
    forms = {"soil": sc.SolidForm(basis, soil, "b_bar"), "beam": beam}
    for side, boundary in (("left", "low:right"), ("right", "high:left")):
        forms[side] = sc.ContactPair(basis, beam.sides[side], boundary, sc.Coulomb(mu=mu))
    foot = sc.layout.FieldDofs(beam.fields[0], np.array([1]))  # the foot does not sink
    fixed = [
        basis.get_dofs({"low:bottom", "high:bottom"}).all("u^2"),
        basis.get_dofs("high:right").all("u^1"),
        foot,
    ]
    return sc.Model(forms, fixed), beam


def test_beam_touches_soil_on_both_sides(tmp_path):
    """[X] A uniform pressure goes through the beam, which does not bend; a force at its head is
    borne by both sides.
    """
    model, beam = walled(sc.LinearElastic(E=1e3, nu=0.0))
    push = model.traction("low:left", (10.0, 0.0))
    result = model.run([sc.Stage("push", push)], **QUIET)
    for side in ("left", "right"):
        np.testing.assert_allclose(result["push"].tractions(side).pressure, 10.0, rtol=1e-6)
    rotations = model.layout.numbers(beam.fields)[beam.fields[1]]
    assert np.abs(result["push"].x[rotations]).max() < 1e-9 * np.abs(result["push"].x).max()
    head = np.zeros(model.layout.size)
    head[model.layout.numbers(beam.fields)[beam.fields[0]][-2]] = 3.0
    result.save(tmp_path / "wall")
    again = sc.load_result(tmp_path / "wall", model)
    bent, resumed = (
        model.run([sc.Stage("head", [push, head])], start=start, **QUIET)["head"]
        for start in (result, again)
    )
    np.testing.assert_array_equal(bent.x, resumed.x)
    left, right = (bent.contact(side).force[0] for side in ("left", "right"))
    assert left + right == pytest.approx(-3.0, rel=1e-6)
    assert np.abs(bent.x[rotations]).max() > 1e-4
    bent.to_vtu(tmp_path / "wall.vtu")


@pytest.mark.slow
def test_beam_in_a_search():
    """[X] A load that the soil bears by 2 c: the factor with the beam between the blocks is that of
    the soil alone.
    """
    model, _ = walled(sc.Tresca(E=1e4, nu=0.3, c=10.0), mu=0.0)
    found = model.strength_reduction(
        model.traction("low:left", (10.0, 0.0)), reduce="soil", **QUIET
    )
    assert found.factor == pytest.approx(2.0, rel=0.02)  # twice the tolerance of the search


class Inertia(sc.Form, sc.roles.Timed):
    """Inertia of a diagonal mass by Newmark's trapezoidal rule."""

    symmetric = True

    def __init__(self, mass):
        self.mass, self.size, self.dt = np.asarray(mass, float), len(mass), 0.0

    def over(self, duration):
        new = copy(self)
        new.dt = duration
        return new

    def initial_state(self, x=None):
        zero = np.zeros(self.size)
        return (zero if x is None else x, zero, zero)

    def assemble(self, x, state):
        u, v, a = state
        new_a = 4.0 / self.dt**2 * (x - u - self.dt * v) - a
        new_v = v + 0.5 * self.dt * (a + new_a)
        K = csr_matrix(np.diag(4.0 / self.dt**2 * self.mass))
        return sc.Response(self.mass * new_a, lambda: (x, new_v, new_a), lambda: K)


def test_inertia():
    """[X] A mass on a spring under a sudden load: u = F / k (1 - cos w t), of second order in the
    step.
    """
    k, m, force, errors = 4.0, 1.0, 2.0, []
    for steps in (100, 200):
        forms = {"spring": sc.MatrixForm(csr_matrix([[k]])), "mass": Inertia([m])}
        model, load = sc.Model(forms), np.array([force])
        stages = [
            sc.Stage("jump", load, duration=1e-9),
            sc.Stage("swing", load, duration=2.0, increments=steps),
        ]
        x = model.run(stages, **QUIET)["swing"].x[0]
        errors.append(abs(x - force / k * (1.0 - np.cos(2.0 * np.sqrt(k / m)))))
    assert errors[1] < 2e-4 and 3.5 < errors[0] / errors[1] < 4.5


class Lines:
    """Observer that writes a line of JSON for every accepted increment."""

    def __init__(self, file):
        self.file = file

    def __call__(self, stage):
        with open(self.file, "a", encoding="utf-8") as stream:
            line = {
                "stage": stage.name,
                "share": stage.fraction,
                "largest": float(np.abs(stage.x).max()),
            }
            stream.write(json.dumps(line) + "\n")


def test_observer_and_kept_increments(tmp_path):
    """Ten increments: ten lines in the file, every second one kept; a load that is a function of
    the share.
    """
    forms = {"spring": sc.MatrixForm(csr_matrix([[2.0]]))}
    stage = sc.Stage("swell", lambda share: np.array([share**2]), increments=10, keep=2)
    result = sc.Model(forms).run([stage], on_increment=Lines(tmp_path / "log"), **QUIET)
    rows = [
        json.loads(line) for line in (tmp_path / "log").read_text(encoding="utf-8").splitlines()
    ]
    np.testing.assert_allclose(
        [row["largest"] for row in rows], 0.5 * (0.1 * np.arange(1, 11)) ** 2, rtol=1e-9
    )
    assert [round(part.fraction, 9) for part in result["swell"].increments] == [
        0.2,
        0.4,
        0.6,
        0.8,
        1.0,
    ]


@pytest.mark.parametrize("own", [Beam, Inertia, Lines])
def test_extensions_are_short(own):
    """At most 40 lines without docstrings and blank lines."""
    source = [
        line for line in inspect.getsource(own).splitlines() if line.strip() and '"""' not in line
    ]
    assert len(source) <= 40, len(source)
