"""Bodies that only soft springs hold."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.contact.laws import Status
from skfem_contact.contact.regularisation import _start_soft_stick
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


def test_a_soft_stick_begins_where_points_chatter_and_none_has_begun():
    """[X] Points that slip in one solution and stick in another, or slip to both sides; not without
    them, within a soft stick, or with multipliers.
    """

    def seen(*slips):
        found = []
        for slip in slips:
            slip = np.array(slip)
            status = np.where(slip, Status.SLIP, Status.STICK)
            traction = np.stack((-np.ones(len(slip)), np.where(slip, slip, 1)))
            found.append(SimpleNamespace(status=status, traction=traction))
        return SimpleNamespace(seen=found)

    def begins(failure, **changes):
        pair = SimpleNamespace(
            softness=1.0,
            saddle=False,
            stiffness=None,
            slave=SimpleNamespace(name="top"),
            interface=SimpleNamespace(elastic_slip=lambda state: np.ones((1, 2))),
            with_=lambda **new: new,
        )
        vars(pair).update(changes)
        return _start_soft_stick(pair, None, failure)

    for chatter in (seen([0, 1], [1, 1]), seen([1, -1], [1, 1], [1, -1])):
        soft = begins(chatter)
        softness = soft["softness"]
        assert 0.0 < softness < 1.0
        # the traction of an elastic slip e is that of the whole penalty: s (e + d) = e
        np.testing.assert_allclose(softness * (1.0 + soft["slip_shift"]), 1.0, rtol=1e-12)
        assert begins(chatter, softness=0.5) is None
        assert begins(chatter, saddle=True) is None
    for failure in (None, seen(), seen([0, 1]), seen([0, 1], [0, 1])):
        assert begins(failure) is None
