"""Bodies that only soft springs hold."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import skfem_contact as sc
from tests.tools.helpers import grid, vector_basis


def test_a_disc_that_springs_hold_does_not_fall_through() -> None:
    """[X] Without contact it would sink by 4 radii, where nothing of its round side lies opposite
    the base any more.
    """
    disc = grid("Q1", np.linspace(-np.pi / 2, np.pi / 2, 25), np.linspace(0.5, 1.0, 4))
    angle, radius = disc.p
    disc = replace(disc, doflocs=np.stack((radius * np.sin(angle), 1.0 - radius * np.cos(angle))))
    disc = disc.with_boundaries({"round": disc.boundaries["top"]})
    base = grid("Q1", np.linspace(-2, 2, 41), np.linspace(-2, 0, 11))
    basis = vector_basis(sc.join_bodies({"disc": disc, "base": base}), "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3)),
        "joint": sc.ContactPair(basis, "base:top", "disc:round", sc.Coulomb()),
        "held": sc.Spring(basis, [(-1.0, 1.0), (1.0, 1.0)], stiffness=1.0),
    }
    load = sc.weight(basis, {"base": 0.0, "disc": 7.0})
    stage = sc.Model(forms, basis.get_dofs("base:bottom").all()).run(
        [sc.Stage("weight", load)], progress=False
    )["weight"]
    assert abs(stage.contact("joint").force[1]) == pytest.approx(
        -load.sum(), rel=0.01
    )  # the springs carry a little
