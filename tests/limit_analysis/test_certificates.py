"""Certificates refuse stresses that are no proof."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from skfem_contact.limit_analysis import certify, search
from skfem_contact.limit_analysis.reading import _STRONG, _strong
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


def pushed_block(monkeypatch: pytest.MonkeyPatch) -> tuple:
    """Program and stresses of a block that is pushed, of which a lower bound was to be proven."""
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
    return given[0]


def test_the_certificate_refuses_half_a_percent(monkeypatch: pytest.MonkeyPatch) -> None:
    """[X] Above the largest multiplier of a mesh no stress in equilibrium is admissible: it proves
    nothing.
    """
    program, found, live = pushed_block(monkeypatch)
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


def strengths(c, t, tension, *, joint=False, reduced=True) -> Strength:
    """Points with cohesion, friction and tensile strength."""
    values = np.broadcast_arrays(*np.atleast_1d(c, t, tension))
    return Strength(*(v.astype(float) for v in values), np.full(len(values[0]), reduced), joint)


def test_kinds_of_strength() -> None:
    """[X] A tensile strength matters below the apex c / t, and wherever nothing resists shear;
    volume is constant without friction and without such a tensile strength.
    """
    inf = np.inf
    kinds = strengths(  # clay, clay that tears, sand, beyond and below its apex, liquid, rigid
        [10.0, 10.0, 10.0, 10.0, 10.0, 0.0, 0.0, inf],
        [0.0, 0.0, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0],
        [inf, 3.0, inf, 20.0, 19.9, inf, 0.0, inf],
    )
    assert kinds.cut.tolist() == [False, True, False, False, True, False, True, False]
    assert kinds.incompressible.tolist() == [True] + 4 * [False] + [True, False, True]
    assert kinds.smooth.tolist() == 5 * [False] + [True, True, False]
    assert kinds.rigid.tolist() == 7 * [False] + [True]
    assert kinds.resists_nothing.tolist() == 5 * [False] + [True, True, False]


@pytest.mark.parametrize("joint", [False, True])
def test_factor_of_a_stress_brings_it_to_the_reduced_strength(joint: bool) -> None:
    """[X] Soil: r = c / F cos - p sin with tan = t / F, or p + r = T / F; joints: (c - t p) / F, or
    p = T / F. A strength that is not reduced admits a stress or not.
    """
    c, t, tension, p, r = np.array(
        [
            (10.0, 0.0, np.inf, -5.0, 4.0),
            (10.0, 0.0, np.inf, -5.0, 25.0),
            (10.0, 0.5, np.inf, -30.0, 8.0),
            (10.0, 0.5, np.inf, 5.0, 4.0),
            (10.0, 0.5, 6.0, 4.0, 1.0),
            (10.0, 0.0, 6.0, 9.0, 1.0),
        ]
    ).T
    # Principal stresses turned by 35 degrees, or tractions
    angle = np.radians(70.0)
    circle = np.stack((p + r * np.cos(angle), p - r * np.cos(angle), r * np.sin(angle)), axis=1)
    traction = np.stack((p, r, 0.0 * p), axis=1)
    stress = traction if joint else circle
    F = strengths(c, t, tension, joint=joint).factor(stress, 1e-9)
    if joint:
        sheared = (c - t * p) / F - r
        torn = tension / F - p
    else:
        phi = np.arctan(t / F)
        sheared = c / F * np.cos(phi) - p * np.sin(phi) - r
        torn = tension / F - p - r
    np.testing.assert_allclose(np.minimum(sheared, torn), 0.0, atol=1e-12)
    assert ((F > 1.0) == [True, False, True, True, True, False]).all()
    fixed = strengths(c, t, tension, joint=joint, reduced=False).factor(stress, 1e-9)
    np.testing.assert_array_equal(fixed, np.where(F > 1.0, np.inf, 0.0))
    # Nothing and pressure alone are admitted at all factors, tension beyond the apex at none
    sand = strengths(10.0, 0.5, np.inf, joint=joint)
    for pressure, factor in ((0.0, np.inf), (-3.0, np.inf), (21.0, 0.0)):
        across = 0.0 if joint else pressure
        assert sand.factor(np.array([[pressure, across, 0.0]]), 1e-9) == factor


@pytest.mark.parametrize("joint", [False, True])
def test_factor_of_a_flow_makes_its_dilation_that_of_the_reduced_strength(joint: bool) -> None:
    """[X] Soil: volume = shear sin with tan = t / F, joints: opening = slip t / F. Any factor will
    do for clay of constant volume, for what tears and opens, and for no flow; none for others.
    """
    inf = np.inf
    cases = np.array(
        [  # t, tension, volume or opening, shear or slip, factor
            (0.5, inf, 1.0, 3.0, np.nan),
            (0.5, inf, 1.0, 1.05, np.nan),
            (0.5, inf, -1.0, 3.0, inf),
            (0.5, inf, 0.0, 3.0, inf),
            (0.0, inf, 0.0, 3.0, 0.0),
            (0.0, inf, 1.0, 3.0, inf),
            (0.0, inf, -1.0, 3.0, inf),
            (0.0, 6.0, 1.0, 3.0, 0.0),
            (0.0, 6.0, -1.0, 3.0, inf),
            (0.5, inf, 0.0, 0.0, 0.0),
            (0.5, inf, -1e-8, 0.0, inf),
        ]
    )
    t, tension, volume, shear, wanted = cases.T
    if joint:
        strain = np.stack((volume, -shear, 0.0 * shear), axis=1)
        dilating = t[:2] * shear[:2] / volume[:2]
    else:
        across = shear * np.sin(0.4)
        along = shear * np.cos(0.4)
        strain = np.stack((0.5 * (volume + along), 0.5 * (volume - along), across), axis=1)
        dilating = t[:2] / np.tan(np.arcsin(volume[:2] / shear[:2]))
    wanted[:2] = dilating
    round_off = np.full(len(t), 1e-9)
    found = strengths(10.0, t, tension, joint=joint).flow_factor(strain, round_off, 3.0)
    np.testing.assert_allclose(found, wanted, rtol=1e-12)
    assert found[0] > 1.0 > found[1]
    fixed = strengths(10.0, t, tension, joint=joint, reduced=False).flow_factor(
        strain, round_off, 3.0
    )
    np.testing.assert_array_equal(fixed, np.where(wanted <= 1.0, 0.0, inf))


def test_soils_that_are_much_stronger_than_others_by_the_stress_they_carry() -> None:
    """[X] c + t p, beyond a multiple of the least one of the elements that count; rigid ones are
    not strong, they are rigid.
    """
    c = np.array([10.0, 10.0, 0.0, 1e4, np.inf])
    soil = strengths(c, [0.0, 0.5, 10.0, 0.0, 0.0], np.inf)
    strong = [
        _strong(soil, 2.0 * _STRONG, elements).tolist() for elements in (np.r_[:5], np.r_[1:5])
    ]
    # strengths of 10, 40, 600, 1e4: more than 300 and 1200
    assert _STRONG == 30.0
    assert strong[0] == [False, False, True, True, False]
    assert strong[1] == [False, False, False, True, False]


def test_earlier_stresses_that_cannot_be_balanced_do_not_end_the_proof(monkeypatch) -> None:
    """[X] Of three earlier stresses round-off spoils the last, and the second proves the load."""
    program, found, live = pushed_block(monkeypatch)
    beyond = replace(found, theta=1.005 * found.theta)
    spoiled = 0.9 * found.theta
    kept = [
        found.inner[-1]._replace(theta=part * found.theta, stress=part * found.stress)
        for part in (0.8, 1.0, 0.9)
    ]
    balanced = certify._balanced

    def with_noise(program, found, theta, plain):
        stress, residual = balanced(program, found, theta, plain)
        return stress, 2 * certify.UNBALANCED if theta == spoiled else residual

    monkeypatch.setattr(certify, "_balanced", with_noise)
    proof = certify.prove_lower(program, replace(beyond, inner=kept), live)
    assert proof.value == pytest.approx(found.theta, rel=1e-12)
    # where no earlier stresses prove anything, the last ones stay
    proof = certify.prove_lower(program, replace(beyond, inner=kept[2:]), live)
    assert proof.value == -np.inf
    assert proof.residual <= certify.UNBALANCED
