"""Element tests of Mohr-Coulomb against closed forms, driven by Newton with its own tangent."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.materials import MohrCoulomb
from tests.oracles.mohr_coulomb import deviatoric_radius, simple_shear_strength, triaxial_strength
from tests.tools.material_points import Specimen

COMPONENTS = pytest.mark.parametrize("ncomp", [4, 6])


@COMPONENTS
def test_triaxial_compression(ncomp: int) -> None:
    """[X] Drained triaxial test of code_aster SSNV232A: strength to 13 digits, volume by
    dilatancy.
    """
    bulk, shear = 516.2e6, 238.2e6
    material = MohrCoulomb(
        E=9 * bulk * shear / (3 * bulk + shear),
        nu=(3 * bulk - 2 * shear) / (6 * bulk + 2 * shear),
        c=1e3,
        phi=33.0,
        psi=27.0,
    )
    specimen = Specimen(material, [-50e3, -50e3, -50e3, 0.0], ncomp)
    for _ in range(5):
        specimen.step({1: -3e-4 / 5}, {0: -50e3, 2: -50e3})
    assert specimen.stress[1, 0] == pytest.approx(
        -173289.54160409, rel=1e-13
    )  # all its printed digits
    assert triaxial_strength(1e3, 33.0, 50e3) == pytest.approx(173289.54160409, rel=1e-13)

    dilatancy = np.sin(np.radians(27.0))
    axial = -specimen.plastic_strain[1]
    volume = specimen.plastic_strain[:3].sum()
    # relative to the plastic strain, which is the difference of strains some ten times larger
    assert volume == pytest.approx(axial * 2 * dilatancy / (1 - dilatancy), rel=1e-11)
    assert volume == pytest.approx(
        1.6784461e-4, rel=5e-6
    )  # [P] code_aster perturbs a lateral stress by 1e-6
    assert specimen.internal[0, 0] == pytest.approx(axial + volume / 3, rel=1e-11)


@COMPONENTS
@pytest.mark.parametrize("compression", [True, False])
def test_triaxial_strength(compression: bool, ncomp: int) -> None:
    """[X] Compression and extension at a cell pressure of 100: c = 10, phi = 30 degrees."""
    specimen = Specimen(
        MohrCoulomb(1e4, 0.3, c=10.0, phi=30.0, psi=5.0), [-100.0, -100.0, -100.0, 0.0], ncomp
    )
    for _ in range(20):
        specimen.step({1: -2e-3 if compression else 2e-3}, {0: -100.0, 2: -100.0})
    assert -specimen.stress[1, 0] == pytest.approx(
        334.6410161513775 if compression else 21.78632794955, rel=1e-11
    )


def test_deviatoric_section() -> None:
    """[X] The section at fixed pressure is the hexagon of the closed form, six-fold symmetric."""
    material = MohrCoulomb(1e4, 0.2, c=5.0, phi=35.0)
    angle = np.radians(np.arange(0.0, 360.0, 1.0))
    trial = 1000 * np.cos(angle + 2 * np.pi / 3 * np.arange(3)[:, None]) - 40.0
    stress = np.vstack((trial, np.zeros_like(angle)))
    result = material.update(np.zeros_like(stress), stress, np.zeros((1, 360))).stress
    # psi = 0 keeps the pressure; the round-off is that of the trial stress, 1e3
    np.testing.assert_allclose(result[:3].mean(axis=0), -40.0, atol=1e-11)
    deviator = result[:3] - result[:3].mean(axis=0)
    major, middle, minor = np.sort(-deviator, axis=0)[::-1]
    lode = np.degrees(np.arctan2(2 * middle - major - minor, np.sqrt(3) * (major - minor)))
    radius = np.sqrt((deviator**2).sum(axis=0) / 2)
    np.testing.assert_allclose(radius, deviatoric_radius(5.0, 35.0, 40.0, -lode), rtol=1e-12)
    np.testing.assert_allclose(radius, np.roll(radius, 120), rtol=1e-12)
    np.testing.assert_allclose(radius, np.roll(radius[::-1], 1), rtol=1e-12)
    sine = np.sin(np.radians(35.0))
    assert radius.min() / radius.max() == pytest.approx((3 - sine) / (3 + sine), rel=1e-12)


@pytest.mark.parametrize(
    "psi, printed", [(0.0, 26.732051), (10.0, 28.828981), (20.0, 30.301828), (30.0, 30.867513)]
)
@COMPONENTS
@pytest.mark.one_in(2)
def test_simple_shear(psi: float, printed: float, ncomp: int) -> None:
    """[X] Plane-strain simple shear at constant normal stress (Davis 1968)."""
    specimen = Specimen(
        MohrCoulomb(1e4, 0.3, c=2.0, phi=30.0, psi=psi), [-25.0, -50.0, -25.0, 0.0], ncomp
    )
    for _ in range(100):
        specimen.step({3: 4e-3}, {1: -50.0})
    ultimate = simple_shear_strength(2.0, 30.0, psi, 50.0)
    assert ultimate == pytest.approx(printed, abs=1e-6)  # its digits
    # the path approaches the ultimate state exponentially with the shear strain, 0.4 here
    assert specimen.stress[3, 0] == pytest.approx(ultimate, rel=1e-9)


@pytest.mark.parametrize("nu", [0.1, 0.3, 0.49])
def test_biaxial(nu: float) -> None:
    """[X] Plane-strain compression: the stress out of plane is elastic, then frozen on the face."""
    material = MohrCoulomb(1e4, nu, c=5.0, phi=30.0)
    specimen = Specimen(material, [-50.0, -50.0, -50.0, 0.0])
    at_yield = None
    for _ in range(200):
        specimen.step({1: -2e-4}, {0: -50.0})
        if at_yield is None and specimen.internal[0, 0] > 0:
            at_yield = specimen.stress[2, 0]
    strength = 3 * 50.0 + 2 * 5.0 * np.sqrt(3)
    assert -specimen.stress[1, 0] == pytest.approx(strength, rel=1e-12)
    assert at_yield == pytest.approx(-50.0 - nu * (strength - 50.0), rel=1e-11)
    assert specimen.stress[2, 0] == pytest.approx(at_yield, rel=1e-11)


def test_biaxial_onto_the_edge() -> None:
    """[X] A specimen loose out of plane yields there first, until its lateral stresses are
    equal.
    """
    specimen = Specimen(MohrCoulomb(1e4, 0.1, c=0.0, phi=30.0), [-50.0, -50.0, -20.0, 0.0])
    for _ in range(200):
        specimen.step({1: -2e-4}, {0: -50.0})
    np.testing.assert_allclose(specimen.stress[:, 0], [-50.0, -150.0, -50.0, 0.0], rtol=1e-12)


@COMPONENTS
@pytest.mark.parametrize("c", [10.0, 0.0])
def test_isotropic_extension(c: float, ncomp: int) -> None:
    """[X] The mean stress stays at c cot(phi), zero without cohesion; unloading is elastic at
    once.
    """
    material = MohrCoulomb(1e4, 0.25, c=c, phi=30.0, psi=10.0)
    specimen = Specimen(material, [0.0] * 4, ncomp)
    apex = c * np.sqrt(3)
    for _ in range(3):
        specimen.step({0: 1e-3, 1: 1e-3, 2: 1e-3}, {})
        assert (apex == 0) or specimen.stress[0, 0] <= apex * (1 + 1e-15)
    np.testing.assert_allclose(specimen.stress[:3, 0], apex, rtol=1e-15, atol=0)
    assert not specimen.stress[3:].any()
    specimen.step({0: -1e-4, 1: -1e-4, 2: -1e-4}, {})
    bulk = 1e4 / (3 * (1 - 2 * 0.25))
    np.testing.assert_allclose(specimen.stress[:3, 0], apex - 3e-4 * bulk, rtol=1e-14)


@COMPONENTS
def test_tresca_has_no_apex(ncomp: int) -> None:
    """[X] phi = 0: hydrostatic loading is elastic for ever, and no strength at all is a fluid."""
    specimen = Specimen(MohrCoulomb(1e4, 0.25, c=1.0, phi=0.0), [0.0] * 4, ncomp)
    specimen.step({0: 1.0, 1: 1.0, 2: 1.0}, {})
    np.testing.assert_allclose(specimen.stress[:3, 0], 3 * 1e4 / 1.5, rtol=1e-15)
    fluid = Specimen(MohrCoulomb(1e4, 0.25, c=0.0, phi=0.0), [0.0] * 4, ncomp)
    fluid.step({0: 0.3, 1: 0.1, 2: -0.1, 3: 0.5}, {})
    # deviators of 1e3 vanish up to their round-off
    np.testing.assert_allclose(fluid.stress[:, 0], [2e3, 2e3, 2e3] + [0] * (ncomp - 3), atol=1e-12)
