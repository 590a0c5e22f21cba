"""Element tests: closed forms of elastic and perfectly plastic soils, mixed control, cut
increments, failures.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.errors import IncrementTooLarge
from skfem_contact.laboratory import PathStep, isotropic, oedometer, simple_shear, triaxial

E, NU, C, PHI = 2e4, 0.25, 5.0, 30.0
SINE = np.sin(np.radians(PHI))


def isotropically(stress, ncomp):
    """Isotropic stress in components."""
    return np.r_[np.full(3, stress), np.zeros(ncomp - 3)][:, None]


@pytest.mark.parametrize("ncomp", [4, 6])
@pytest.mark.parametrize("sense", [-1, 1])
def test_triaxial_strength(ncomp, sense):
    """[X] Mohr-Coulomb: strength in compression and extension at a constant cell pressure, and
    dilatancy after it.
    """
    psi = 10.0
    soil = sc.MohrCoulomb(E, NU, C, PHI, psi)
    test = sc.element_test(soil, isotropically(-100.0, ncomp), triaxial(sense * 0.02))
    flow = (1 + SINE) / (1 - SINE)
    strength = (
        100 * flow + 2 * C * np.sqrt(flow) if sense < 0 else 100 / flow - 2 * C / np.sqrt(flow)
    )
    np.testing.assert_allclose(
        -test.stress[-1, 1], strength, rtol=1e-9
    )  # ten times the tolerance of the increments
    np.testing.assert_allclose(test.stress[:, [0, 2]], -100.0, rtol=1e-9)
    sine = np.sin(np.radians(psi))
    ratio = (
        2 * sine / (1 - sine) if sense < 0 else 2 * sine / (1 + sine)
    )  # volume over axial plastic strain
    change = test.volume[-1] - test.volume[-2], test.axial[-1] - test.axial[-2]
    np.testing.assert_allclose(
        change[0], ratio * abs(change[1]), rtol=1e-6
    )  # a hundredth of the strains are changes
    assert test.q[-1] == pytest.approx(abs(strength - 100), rel=1e-9)
    assert test.iterations.max() <= 3 and test.stress.shape == (101, ncomp, 1)


def test_oedometer_and_isotropic():
    """[X] Elastic moduli; stresses are those at the end of a step, strains add up."""
    soil = sc.LinearElastic(E, NU)
    bulk, stiff = E / (3 * (1 - 2 * NU)), E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
    path = [isotropic(-60.0, 3), oedometer(stress=-90.0, increments=2), oedometer(strain=1e-3)]
    test = sc.element_test(soil, 0.0, path)
    np.testing.assert_allclose(test.p[3], 60.0, rtol=1e-12)
    np.testing.assert_allclose(test.volume[3], -60 / bulk, rtol=1e-12)
    np.testing.assert_allclose(test.axial[5], -20 / bulk - 30 / stiff, rtol=1e-12)
    np.testing.assert_allclose(test.stress[-1, 1], -90 + 1e-3 * stiff, rtol=1e-12)
    assert test.step.tolist() == [-1] + [0] * 3 + [1] * 2 + [2] * 100


@pytest.mark.parametrize("drained", [True, False])
def test_simple_shear(drained):
    """[X] Elastic rise from isotropic stress, then the shear strength of Mohr's circle without
    dilatancy.
    """
    test = sc.element_test(
        sc.MohrCoulomb(E, NU, C, PHI), -100.0, simple_shear(0.1, drained, increments=50)
    )
    c, phi = C, np.radians(PHI)
    strength = c * np.cos(phi) + 100 * np.sin(
        phi
    )  # stress ratios stay as they were: no volume changes with psi = 0
    assert test.stress[-1, 3] == pytest.approx(strength, rel=1e-9)
    np.testing.assert_allclose(test.volume, 0.0, atol=1e-14)
    np.testing.assert_allclose(test.pore_pressure, 0.0, atol=1e-9 * strength)
    shear = E / (2 * (1 + NU))
    assert test.stress[1, 3] == pytest.approx(shear * 0.002, rel=1e-12)


def test_pore_pressure_of_constant_volume_and_of_water():
    """[X] Constant volume and nearly incompressible water: strength at the constant mean stress, u
    = q / 3.
    """
    soil = sc.MohrCoulomb(E, NU, C, PHI)
    flow = 6 * SINE / (3 - SINE)
    strength = flow * 100 + 6 * C * np.cos(np.radians(PHI)) / (3 - SINE)
    constant = sc.element_test(soil, -100.0, triaxial(-0.03, drained=False))
    assert constant.q[-1] == pytest.approx(strength, rel=1e-9)
    assert constant.pore_pressure[-1] == pytest.approx(strength / 3, rel=1e-9)
    share = 1e-6
    water = E / (3 * (1 - 2 * NU)) / share
    total = sc.element_test(sc.Undrained(soil, bulk_modulus_water=water), -100.0, triaxial(-0.03))
    np.testing.assert_allclose(total.q, constant.q, rtol=2 * share, atol=1e-6)  # the water's share
    np.testing.assert_allclose(
        total.pore_pressure, constant.pore_pressure, rtol=2 * share, atol=2e-4
    )
    np.testing.assert_allclose(total.p, 100.0, rtol=3 * share)


def test_pore_pressure_goes_on_in_later_steps():
    """[X] Two undrained steps are one; drained ones keep the total cell pressure, 100 in all.

    An elastic sample has u = q / 3, and its drained strength at the effective cell pressure p' is
    that of Mohr-Coulomb.
    """
    soil = sc.MohrCoulomb(E, NU, C, PHI)
    shear, again = triaxial(-0.001, drained=False), triaxial(-0.001, drained=False)
    once = sc.element_test(soil, -100.0, triaxial(-0.002, drained=False))
    twice = sc.element_test(soil, -100.0, [shear, again])
    back = sc.element_test(soil, -100.0, [shear, triaxial(0.001, drained=False)])
    assert once.pore_pressure[-1] == pytest.approx(once.q[-1] / 3, rel=1e-9)
    assert twice.pore_pressure[-1] == pytest.approx(once.pore_pressure[-1], rel=1e-9)
    assert back.pore_pressure[-1] == pytest.approx(0.0, abs=1e-9)
    # Drained afterwards, the sample shears against the pressure as against a back pressure.
    opened = sc.element_test(soil, -100.0, [again, triaxial(-0.05)])
    np.testing.assert_allclose(opened.pore_pressure - opened.stress[:, 0], 100.0, rtol=1e-9)
    cell = 100.0 - opened.pore_pressure[-1]
    passive = (1 + SINE) / (1 - SINE)
    strength = (passive - 1) * cell + 2 * C * np.sqrt(passive)
    assert opened.q[-1] == pytest.approx(strength, rel=1e-9)
    # Consolidated again, it begins without an excess.
    path = [again, isotropic(-150.0), triaxial(-0.001, drained=False)]
    consolidated = sc.element_test(soil, -100.0, path)
    assert consolidated.pore_pressure[200] == 0.0
    assert consolidated.pore_pressure[-1] == pytest.approx(consolidated.q[-1] / 3, rel=1e-9)


def test_many_samples_are_single_ones():
    """[X] Samples with stresses and strengths of their own: each as it would be alone."""
    stresses, angles = np.array([-50.0, -100.0, -400.0]), np.array([25.0, 30.0, 35.0])
    path = [
        isotropic(2 * stresses, 5),
        triaxial(-0.05),
        PathStep({"p": None, "q": 10.0}, {"xx-zz": 0.0}),
    ]
    several = sc.element_test(sc.MohrCoulomb(E, NU, C, angles), stresses, path)
    for k in range(3):
        alone = [isotropic(2 * stresses[k], 5), *path[1:]]
        single = sc.element_test(sc.MohrCoulomb(E, NU, C, float(angles[k])), stresses[k], alone)
        np.testing.assert_allclose(
            several.stress[:, :, k], single.stress[:, :, 0], rtol=1e-9, atol=1e-7
        )
    np.testing.assert_allclose(several.stress[-1, 0] - several.stress[-1, 1], 10.0, rtol=1e-9)


@dataclass(frozen=True, eq=False)
class Cautious(sc.LinearElastic):
    """Elastic law that refuses increments of strain above a limit, and all beyond a strain."""

    largest: float = 1e-3
    strongest: float = 1e9
    internal = (sc.Internal("steps"),)

    def update(self, strain_increment, stress, internal):
        new = super().update(strain_increment, stress, internal)
        if (
            np.abs(strain_increment).max() > self.largest
            or np.abs(new.stress).max() > self.strongest
        ):
            raise IncrementTooLarge("a strain increment is refused")
        return new._replace(internal=internal + 1)


def test_increments_are_halved():
    """[X] An increment 5 times too large is halved three times; the end is the same."""
    test = sc.element_test(Cautious(E, NU), -10.0, oedometer(strain=-5e-3, increments=1))
    assert test.variable("steps")[-1] == 8
    stiff = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
    assert test.stress[-1, 1] == pytest.approx(-10.0 - 5e-3 * stiff, rel=1e-12)


def test_failure_keeps_what_was_reached():
    """A law that cannot go on: the error says where, and holds the states before."""
    with pytest.raises(
        sc.NotConverged, match=r"step 1 of the .* stops after 4 of 10 .* is refused"
    ) as caught:
        sc.element_test(
            Cautious(E, NU, strongest=121.0),
            -10.0,
            [isotropic(-20.0, 5), oedometer(stress=-260.0, increments=10)],
        )
    kept = caught.value.result
    assert kept.stress[-1, 1] == pytest.approx(-116.0) and len(kept.p) == 10


def test_a_stress_beyond_the_strength():
    """A prescribed stress that perfect plasticity does not resist is refused in words."""
    with pytest.raises(
        sc.NotConverged, match=r"prescribe a strain instead|no equilibrium"
    ) as caught:
        sc.element_test(
            sc.MohrCoulomb(E, NU, C, PHI), -100.0, triaxial(stress=-500.0, increments=20)
        )
    flow = (1 + SINE) / (1 - SINE)
    assert -caught.value.result.stress[-1, 1] == pytest.approx(
        100 * flow + 2 * C * np.sqrt(flow), rel=0.06
    )  # 1 step


@pytest.mark.slow
def test_both_lateral_stresses_are_advised_against():
    """Both lateral stresses of a compression leave the strain between them free at yield:
    `triaxial` prescribes it.
    """
    step = sc.laboratory.PathStep(stress={"xx": None, "zz": None}, strain={"yy": -0.05})
    sand = sc.MohrCoulomb(E=2e4, nu=0.25, c=5.0, phi=30.0, psi=5.0)
    with pytest.raises(
        sc.NotConverged,
        match=r"stresses xx and zz, .* laboratory.triaxial .* strain=\{'xx-zz': 0\}",
    ):
        sc.element_test(sand, -100.0, step)
    assert sc.element_test(sand, -100.0, sc.laboratory.triaxial(-0.05)).q[-1] > 200.0


def test_bad_input():
    """Wrong conditions, stresses and samples are refused with what is there."""
    soil = sc.MohrCoulomb(E, NU, C, PHI)
    wrong = isotropically(-100.0, 4)
    wrong[1] = -500.0
    cases = [
        (
            "sample 0, xx = -100, yy = -500.* outside the yield surface",
            soil,
            wrong,
            isotropic(-1.0),
        ),
        ("outside the yield surface", soil, 100.0, isotropic(-1.0)),
        ("needs 4 conditions.*\\['xx'\\]", soil, -1.0, PathStep({"xx": -1.0})),
        (
            "needs 4 conditions",
            soil,
            -1.0,
            PathStep({"yz": -1.0}, {"xx": 0.0, "yy": 0.0, "zz": 0.0}),
        ),
        ("of shape", soil, np.zeros((3, 2)), isotropic(-1.0)),
        ("stress must be finite", soil, np.nan, isotropic(-1.0)),
    ]
    for message, law, stress, path in cases:
        with pytest.raises(ValueError, match=message):
            sc.element_test(law, stress, path)
    with pytest.raises(ValueError, match="no component of a step 'axial'"):
        PathStep({"axial": 1.0})
    with pytest.raises(ValueError, match="either a stress or a strain"):
        oedometer()
    with pytest.raises(ValueError, match="increments must be positive"):
        isotropic(-1.0, increments=0)


def test_frame_and_diagrams(monkeypatch):
    """A row for each state of each sample; four diagrams; a clear word without pandas."""
    test = sc.element_test(
        sc.MohrCoulomb(E, NU, C, PHI), [-50.0, -100.0], triaxial(-0.02, increments=10)
    )
    table = test.to_frame()
    assert table.shape[0] == 22 and table.loc[(1, 10), "q"] == pytest.approx(test.q[10, 1])
    assert {"plastic strain", "stress yy", "strain xy", "step", "pore_pressure"} <= set(
        table.columns
    )
    figure = test.plot(beside={"shear": np.array([0.0, 0.01]), "q": np.array([0.0, 100.0])})
    assert [len(axes.lines) for axes in figure.axes] == [3, 2, 2, 2]
    assert figure.axes[3].get_xscale() == "log"
    np.testing.assert_allclose(figure.axes[0].lines[1].get_ydata(), test.q[:, 1])
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="to_frame needs pandas: pip install pandas"):
        test.to_frame()
