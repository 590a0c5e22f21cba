"""Receding contact: a layer that lifts off."""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.helpers import grid, traction, vector_basis


@pytest.mark.slow
@pytest.mark.parametrize(("element", "n"), [("Q1", 16), ("Q2", 10)])
@pytest.mark.parametrize("quadrature", [4, "segments"])
def test_receding_contact(quadrature, element: str, n: int) -> None:
    """[X] A layer lifts off where it is not loaded: in one increment, over a length that the load
    does not change.

    Newton's method needs more iterations than it is given, for almost each of them finds another
    active set.
    """
    steps = 1.15 ** np.arange(27)
    x = np.concatenate((np.linspace(0, 2, 2 * n + 1), 2 + 8 * np.cumsum(steps) / steps.sum()))
    mesh = grid(element, x, np.linspace(0, 1, n + 1))
    mesh = mesh.with_boundaries(
        {"strip": lambda p: (p[1] > 1 - 1e-9) & (p[0] < 0.25)}, boundaries_only=False
    )
    basis = vector_basis(mesh, element, intorder=4)
    floor = sc.rigid.line((-5.0, 0.0), (20.0, 0.0))
    forms = {
        "layer": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3)),
        "floor": sc.ContactPair(basis, "bottom", floor, sc.Coulomb(), quadrature),
    }
    ends = []
    for load in (1e-4, 1e-6):
        force = traction(basis, "strip", (0.0, -load))
        stage = sc.Model(forms, basis.get_dofs("left").all("u^1")).run(
            [sc.Stage("press", force)], progress=False
        )["press"]
        assert len(stage.iterations) == 1
        joint = stage.tractions("floor")
        ends.append(joint.x[joint.pressure > 1e-3 * joint.pressure.max()].max())
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)  # the same points
    # the same end for all rules and elements to half an element
    assert ends[0] == pytest.approx(0.875, abs=0.5 / n)


@pytest.mark.parametrize("element", ["Q1", "Q2"])
def test_half_width_under_a_point_load(element: str) -> None:
    """[A] .857 of the height (L. M. Keer, J. Dundurs, K. C. Tsai 1972), to half an element."""
    steps = np.cumsum(1.15 ** np.arange(21))
    x = np.concatenate((np.linspace(0, 2, 33), 2 + 8 * steps / steps[-1]))
    mesh = sc.join_bodies({"layer": grid(element, x, np.linspace(0, 1, 9))})
    basis = vector_basis(mesh, element, intorder=4)
    floor = sc.rigid.line((-5.0, 0.0), (20.0, 0.0))
    method = sc.DualMultipliers()
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3)),
        "joint": sc.ContactPair(basis, "layer:bottom", floor, sc.Coulomb(), enforcement=method),
    }
    load = basis.zeros()
    loaded = np.flatnonzero((basis.doflocs == [[0.0], [1.0]]).all(axis=0))
    load[loaded[1]] = -0.5e-5
    model = sc.Model(forms, basis.get_dofs("layer:left").all("u^1"))
    stage = model.run([sc.Stage("press", load)], progress=False)["press"]
    joint = stage.tractions("joint")
    assert joint.x[joint.pressure > 0.0].max() == pytest.approx(0.857, abs=0.03)
    assert sum(stage.iterations) <= 25
