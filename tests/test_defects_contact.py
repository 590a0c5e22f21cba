"""Scenes from outside that contact once answered wrongly, or not at all, with what is known of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from helpers import grid, traction, vector_basis

import skfem_contact as sc


def kinked_blocks(phase: float, mu: float):
    """A block that overlaps a base by .01, both along a wave whose joints turn, pressed and then sheared."""

    def bent(bottom, x0, x1, low):
        mesh = grid("Q1", np.linspace(x0, x1, 5), np.array([bottom, bottom + 0.6]))
        share = (mesh.p[1] - bottom) / 0.6
        up = (share if low else 1 - share) * 0.05 * np.sin(5 * mesh.p[0] + phase)
        return replace(mesh, doflocs=mesh.p + [0 * up, up])

    bodies = {"base": bent(-0.6, -0.5, 1.5, True), "block": bent(-0.01, 0.0, 1.0, False)}
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(
            basis, "block:bottom", "base:top", sc.Coulomb(mu), quadrature="nodal", initial="adjusted"
        ),
    }
    top, stages = basis.get_dofs("block:top"), []
    for name, along, down in (("press", 0.0, 0.0154), ("shear", 0.0055, 0.0092)):
        x = basis.zeros()
        x[top.all("u^1")], x[top.all("u^2")] = along, -down
        stages.append(sc.Stage(name, basis.zeros(), x))
    return forms, stages, np.union1d(basis.get_dofs("base:bottom").all(), top.all())


@pytest.mark.parametrize(("phase", "mu"), [(0.8, 1.0), (1.6, 1.0), (2.4, 0.6)])
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_what_is_accepted_balances(phase: float, mu: float) -> None:
    """[X] Equilibrium: forces assembled again at every accepted stage balance, and a run goes on from there.

    Locked to facets that they have left, points were in balance only until they were free.
    """
    forms, stages, fixed = kinked_blocks(phase, mu)
    try:
        result = sc.run(forms, stages, fixed, progress=False)
    except sc.NotConverged as error:
        result = error.result
        assert phase != 0.8  # where points rest on facets
    assert len(result) >= 1
    for stage in result:
        left = sc.reactions(forms, stage)
        # ten times the tolerance of Newton's method, which the accepted increment met
        assert np.abs(np.delete(left, fixed)).max() <= 1e-7 * np.abs(left[fixed]).max()
        again = sc.run(forms, [sc.Stage("nothing", stage.load, stage.x)], fixed, start=stage, progress=False)
        np.testing.assert_allclose(again[-1].x, stage.x, atol=1e-9)


@pytest.mark.parametrize(("element", "n"), [("Q1", 16), ("Q2", 10)])
@pytest.mark.parametrize("quadrature", [4, "segments"])
def test_receding_contact(quadrature, element: str, n: int) -> None:
    """[X] A layer lifts off where it is not loaded: in one increment, over a length that the load does not change.

    Newton's method needs more iterations than it is given, for almost each of them finds another active set.
    """
    steps = 1.15 ** np.arange(27)
    x = np.concatenate((np.linspace(0, 2, 2 * n + 1), 2 + 8 * np.cumsum(steps) / steps.sum()))
    mesh = grid(element, x, np.linspace(0, 1, n + 1))
    mesh = mesh.with_boundaries({"strip": lambda p: (p[1] > 1 - 1e-9) & (p[0] < 0.25)}, boundaries_only=False)
    basis = vector_basis(mesh, element, intorder=4)
    floor = sc.rigid_line((-5.0, 0.0), (20.0, 0.0))
    forms = {
        "layer": sc.SolidForm(basis, sc.LinearElastic(E=1.0, nu=0.3)),
        "floor": sc.ContactPair(basis, "bottom", floor, sc.Coulomb(), quadrature),
    }
    ends = []
    for load in (1e-4, 1e-6):
        force = traction(basis, "strip", (0.0, -load))
        stage = sc.run(forms, [sc.Stage("press", force)], basis.get_dofs("left").all("u^1"), progress=False)["press"]
        assert len(stage.iterations) == 1
        joint = sc.tractions(forms["floor"], stage.states["floor"])
        ends.append(joint.x[joint.pressure > 1e-3 * joint.pressure.max()].max())
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)  # the same points
    # the same end for all rules and elements to half an element
    assert ends[0] == pytest.approx(0.875, abs=0.5 / n)
