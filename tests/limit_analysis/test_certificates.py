"""Certificates refuse stresses that are no proof."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from skfem_contact.limit_analysis import certify, search
from skfem_contact.limit_analysis.strength import Strength
from tests.tools.helpers import analysis
from tests.tools.scenes import sliding_blocks

SOIL = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0)


def column(material) -> tuple[dict, np.ndarray]:
    """A square that can spread between its base and a smooth left side."""
    basis = Basis(MeshTri().refined(2).with_defaults(), ElementVector(ElementTriP2()), intorder=2)
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    return {"ground": sc.SolidForm(basis, material)}, fixed


def test_loads_that_nothing_bears_are_no_proof_of_safety() -> None:
    """[X] A column pulled beyond its apex c cot(phi) collapses at every factor."""
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=1.0, phi=30.0, psi=30.0)
    with pytest.raises(ValueError, match="at any strength the loads exceed"):
        analysis(
            "bounds", *column(soil), tractions={"top": (0.0, 10.0)}, elements=200, progress=False
        )


def test_the_certificate_refuses_half_a_percent(monkeypatch: pytest.MonkeyPatch) -> None:
    """[X] Above the largest multiplier of a mesh no stress in equilibrium is admissible: it proves
    nothing.
    """
    given = []
    monkeypatch.setattr(
        search, "prove_lower", lambda *args: given.append(args) or certify.prove_lower(*args)
    )
    forms, fixed = sliding_blocks(0.0, SOIL, SOIL, sc.Coulomb(mu=0.5, adhesion=2.5))
    loads = {
        "weight": {"block": 25.0},
        "tractions": {"block:left": (1.0, 0.0)},
        "live": "block:left",
    }
    sc.Model(forms, fixed).bounds(**loads, gap=0.9, elements=100, progress=False)
    program, found, live = given[0]
    assert certify.prove_lower(program, found, live).value == pytest.approx(found.theta, rel=1e-12)
    assert (
        certify.prove_lower(program, replace(found, theta=1.005 * found.theta), live).value
        == -np.inf
    )


def test_a_multiple_of_stresses_is_no_more_than_admissible() -> None:
    """[X] Cohesive soil that can spread carries 2 c; without fixed loads the stresses may be
    multiplied as a whole.
    """
    found = analysis(
        "bounds",
        *column(sc.Tresca(1e3, 0.3, c=10.0)),
        tractions={"top": (0.0, -1.0)},
        live="top",
        elements=200,
        progress=False,
    )
    assert 19.99 < found.lower <= 20.0 * (1 + 1e-12)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("factor", [0.8, 1.3])
def test_power_of_a_strength_of_three_lines(size: float, factor: float) -> None:
    """[N] The largest p dV + r dg of the stresses with t p + sqrt(F^2 + t^2) r <= c for every line,
    by linear programming, for strains of any size.
    """
    cohesion, slope = np.array([2.0, 3.0, 5.0]), np.array([1.5, 0.8, 0.3])
    # Strains from pure opening to slopes between those of two lines
    share = np.array([1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4])
    n = len(share)
    soil = Strength(
        np.full(n, cohesion[0]),
        np.full(n, slope[0]),
        tension=np.full(n, np.inf),
        reduced=np.ones(n, bool),
        lines=np.tile(np.stack((cohesion[1:], slope[1:]), axis=1), (n, 1, 1)),
    )
    dilation, shear = size * share, size * np.sqrt(1.0 - share**2)
    strain = 0.5 * np.stack((dilation + shear, dilation - shear, 0.0 * shear), axis=1)
    rows = np.stack((slope, np.hypot(factor, slope)), axis=1)
    powers = []
    for rates in zip(-dilation, -shear):
        found = linprog(rates, rows, cohesion, bounds=[(None, None), (0.0, None)])
        powers.append(-found.fun)
    assert soil.dissipation(strain, factor) == pytest.approx(np.array(powers), rel=1e-9)
