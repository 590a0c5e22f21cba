"""Beams that end in a plane of symmetry."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import (
    Basis,
    ElementQuad2,
    ElementVector,
    MeshQuad,
)

import skfem_contact as sc

QUIET = {"progress": False}


ELASTIC = sc.LinearElastic(E=1e4, nu=0.3)


def strip(left, right=6.0, **options):
    """The moment in the axis of a beam from -2 to 2 on the ground under its ends, or of a half."""
    mesh = MeshQuad.init_tensor(
        np.linspace(left, right, 2 * int(right - left) + 1), np.linspace(-4, 0, 9)
    ).with_boundaries({"beam": lambda x: (x[1] > -1e-9) & (abs(x[0]) < 2.0)})
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    beam = sc.Beam(basis, "beam", EI=2e4, EA=1e6)
    held = beam.dofs((0.0, 0.0), options["names"]) if options else []
    model = sc.Model(
        {"ground": sc.SolidForm(basis, ELASTIC), "beam": beam}, [sc.box_supports(basis), *held]
    )
    load = sum(
        model.forms["beam"].load((0.0, -30.0), at=(x, 0.0))
        for x in (-2.0, 2.0)
        if left <= x <= right
    )
    forces = model.run([sc.Stage("ends", load)], **QUIET)["ends"].section_forces("beam")
    return forces.M[np.argmin(abs(forces.x))]


def test_beam_that_ends_in_a_plane_of_symmetry(recwarn):
    """[X] Either half of a footing as the whole one; a rotation that the supports of the ground
    leave free is told.
    """
    whole = strip(-6.0)
    for half in ((0.0, 6.0), (-6.0, 0.0)):
        assert strip(*half, names=["theta"]) == pytest.approx(whole, rel=1e-9)
    assert not recwarn.list
    for half in ((0.0, 6.0), (-6.0, 0.0)):
        with pytest.warns(
            sc.AnalysisWarning, match=r"its end at \(0, 0\) is held along the beam and may turn"
        ):
            assert abs(strip(*half)) < 1e-9  # 16.7 is right
