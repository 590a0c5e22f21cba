"""Whether a structure stands, yes or no."""

from __future__ import annotations

from contextlib import nullcontext, suppress

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from tests.tools.helpers import analysis


def slope(material):
    """A slope of 1 to 2 on ground as deep as it is high."""
    flat = MeshTri.init_tensor(np.linspace(0, 60, 16), np.linspace(0, 1, 6))
    ground = np.interp(flat.p[0], [20, 40], [20, 10])
    basis = Basis(
        MeshTri(np.stack((flat.p[0], ground * flat.p[1])), flat.t),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    return {"slope": sc.SolidForm(basis, material)}, sc.box_supports(basis), sc.weight(basis, 20.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "material",
    [
        lambda factor: sc.Tresca(E=1e5, nu=0.3, c=40.0 / factor),
        lambda factor: sc.MohrCoulomb(E=1e5, nu=0.3, c=15.0, phi=20.0, psi=20.0).reduced(
            factor, "associated"
        ),
        lambda factor: sc.MohrCoulomb(E=1e5, nu=0.3, c=15.0, phi=20.0, psi=0.0).reduced(
            factor, "given"
        ),
    ],
    ids=["clay", "psi = phi", "psi = 0"],
)
def test_as_strength_reduction(material):
    """[N] It stands below the factor of safety and does not above it; with psi = 0 there may be no
    answer above it.
    """
    found = analysis("strength_reduction", *slope(material(1.0)), tolerance=0.01, progress=False)
    low, high = found.bracket
    margin = 0.02 if found.davis is None else 0.1
    assert analysis("is_stable", *slope(material(low * (1 - margin))))
    with nullcontext() if found.davis is None else suppress(sc.NotConverged):
        assert not analysis("is_stable", *slope(material(high * (1 + margin))))


@pytest.mark.slow
def test_from_a_stage():
    """[N] A surcharge on a slope that carries its weight: below and above its limit load."""
    forms, fixed, weight = slope(sc.Tresca(E=1e5, nu=0.3, c=40.0))
    start = sc.Model(forms, fixed).run([sc.Stage("weight", weight)], progress=False)
    basis = forms["slope"].basis
    crest = np.flatnonzero(
        (basis.doflocs[1] > 20 - 1e-9) & (basis.doflocs[0] > 10) & (np.arange(basis.N) % 2 == 1)
    )
    surcharge = basis.zeros()
    surcharge[crest] = -1.0
    limit = (
        sc.Model(forms, fixed)
        .limit_load(surcharge, start=start, tolerance=0.01, step=20.0, progress=False)
        .multiplier
    )
    assert sc.Model(forms, fixed).is_stable(weight + 0.97 * limit * surcharge, start=start)
    assert not sc.Model(forms, fixed).is_stable(weight + 1.05 * limit * surcharge, start=start)


def test_neither_is_warned_of():
    """Too few iterations are no collapse."""
    with pytest.raises(sc.NotConverged, match="no equilibrium after 2 iterations"):
        analysis(
            "is_stable",
            *slope(sc.Tresca(E=1e5, nu=0.3, c=40.0)),
            newton=sc.Newton(max_iterations=2),
        )
    forms, fixed, _ = slope(sc.Tresca(E=1e5, nu=0.3, c=40.0))
    with pytest.raises(ValueError, match="there is no load"):
        sc.Model(forms, fixed).is_stable()
