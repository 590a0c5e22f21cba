"""Contact in balance: accepted stages, and the resultants of reports."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.penalty import choose_penalties
from tests.tools.helpers import grid, unknowns_of, vector_basis


def kinked_blocks(phase: float, mu: float):
    """A block that overlaps a base by .01, both along a wave whose joints turn, pressed and then
    sheared.
    """

    def bent(bottom, x0, x1, low):
        mesh = grid("Q1", np.linspace(x0, x1, 5), np.array([bottom, bottom + 0.6]))
        share = (mesh.p[1] - bottom) / 0.6
        up = (share if low else 1 - share) * 0.05 * np.sin(5 * mesh.p[0] + phase)
        return replace(mesh, doflocs=mesh.p + np.stack((0 * up, up)))

    bodies = {"base": bent(-0.6, -0.5, 1.5, True), "block": bent(-0.01, 0.0, 1.0, False)}
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(
            basis,
            "block:bottom",
            "base:top",
            sc.Coulomb(mu),
            quadrature="nodal",
            initial="adjusted",
        ),
    }
    top, stages = basis.get_dofs("block:top"), []
    for name, along, down in (("press", 0.0, 0.0154), ("shear", 0.0055, 0.0092)):
        x = basis.zeros()
        x[top.all("u^1")], x[top.all("u^2")] = along, -down
        stages.append(sc.Stage(name, basis.zeros(), x))
    return forms, stages, np.union1d(basis.get_dofs("base:bottom").all(), top.all())


@pytest.mark.slow
@pytest.mark.parametrize(("phase", "mu"), [(0.8, 1.0), (2.4, 0.6)])
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_what_is_accepted_balances(phase: float, mu: float) -> None:
    """[X] Equilibrium: forces assembled again at every accepted stage balance, and a run goes on
    from there.

    Locked to facets that they have left, points were in balance only until they were free.
    """
    forms, stages, fixed = kinked_blocks(phase, mu)
    try:
        # fewer iterations than by default: the stages that fail try hundreds of increments
        result = sc.Model(forms, fixed, newton=sc.Newton(max_iterations=8)).run(
            stages, progress=False
        )
    except sc.NotConverged as error:
        result = error.result
        assert phase != 0.8  # where points rest on facets
    assert len(result) >= 1
    for stage in result:
        left = stage.reactions()
        # ten times the tolerance of Newton's method, which the accepted increment met
        assert np.abs(np.delete(left, fixed)).max() <= 1e-7 * np.abs(left[fixed]).max()
        again = sc.Model(forms, fixed).run(
            [sc.Stage("nothing", stage.load, stage.x)], start=stage, progress=False
        )
        np.testing.assert_allclose(again[-1].x, stage.x, atol=1e-9)


@pytest.mark.parametrize(
    ("initial", "gap"), [("as meshed", 0.0), ("adjusted", 0.01), ("adjusted", -0.01)]
)
@pytest.mark.parametrize("quadrature", ["nodal", "segments"])
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
def test_resultant_of_the_report_is_that_of_nodal_forces(
    quadrature, initial: str, gap: float
) -> None:
    """[X] On a coarse bent floor that is smoothed, where gaps lengthen the arm of friction."""

    def bent(bottom, x0, x1, low):
        mesh = grid("Q1", np.linspace(x0, x1, 4), np.array([bottom, bottom + 0.6]))
        share = (mesh.p[1] - bottom) / 0.6
        up = (share if low else 1 - share) * 0.08 * np.sin(6 * mesh.p[0] + 5)
        return replace(mesh, doflocs=mesh.p + np.stack((0 * up, up)))

    bodies = {"base": bent(-0.6, -0.5, 1.5, True), "block": bent(gap, 0.0, 1.0, False)}
    basis = vector_basis(sc.join_bodies(bodies), "Q1", intorder=2)
    forms = choose_penalties(
        {
            "solid": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
            "joint": sc.ContactPair(
                basis,
                "block:bottom",
                "base:top",
                sc.Coulomb(0.6),
                quadrature,
                smoothing=0.3,
                initial=initial,
            ),
        }
    )
    top, x = basis.get_dofs("block:top"), basis.zeros()
    x[top.all("u^1")], x[top.all("u^2")] = -0.045, -0.026
    fixed = np.union1d(basis.get_dofs("base:bottom").all(), top.all())
    stage = sc.Model(forms, fixed).run([sc.Stage("pressed", basis.zeros(), x)], progress=False)[
        "pressed"
    ]
    nodal = (
        -forms["joint"]
        .assemble(stage.x, stage.states["joint"])
        .force[unknowns_of(basis, "block")]
        .sum(axis=0)
    )
    report = stage.contact("joint")
    np.testing.assert_allclose(report.force, nodal, rtol=1e-12)
