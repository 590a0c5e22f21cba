"""Small-strain stiffness of the Hardening Soil: threshold, Masing's loops, tangent, limits, bad
input.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.laboratory import triaxial
from tests.materials.test_hardening_soil import HOSTUN, increments, stresses

G0, THRESHOLD = 110e3, 2e-4
UNLOADING = 90e3 / 2.4


def stiff(**changes: Any) -> sc.HardeningSoil:
    return sc.HardeningSoil(
        **(HOSTUN | {"c": 5.0, "psi": 14.0, "G0_ref": G0, "gamma_07": THRESHOLD} | changes)
    )


def sheared(
    law: sc.HardeningSoil, path: np.ndarray, component: int = 3, p: float = 100.0
) -> np.ndarray:
    """Stresses (n, 4) along strains of a component, deep inside of the yield surfaces."""
    stress = -np.array([p, p, p, 0.0])[:, None, None]
    internal = law.initial_internal(stress)
    internal[1], internal[2] = 1.0, 100 * p
    history = [stress]
    for change in np.diff(path):
        strain = np.zeros((4, 1, 1))
        strain[component] = change
        if component < 3:  # no change of volume
            strain[:3] -= change / 2
            strain[component] = change
        new = law.update(strain, stress, internal)
        stress, internal = new.stress, new.internal
        history.append(stress)
    assert internal[0] == 0.0
    return np.array(history)[:, :, 0, 0]


@pytest.mark.parametrize("increments", [1, 2, 3, 7])
def test_the_limit_is_crossed_in_any_increments(increments: int) -> None:
    """[X] Stress at twice the shear strain from where on the modulus is that of unloading."""
    limit = ((G0 / UNLOADING) ** 0.5 - 1) * THRESHOLD / 0.385
    path = np.linspace(0, -2 * limit / 1.5, increments + 1)
    stress = sheared(stiff(m=0.0), path, component=1, p=1e4)
    exact = -G0 * limit / (1 + 0.385 * limit / THRESHOLD) - UNLOADING * limit
    assert (stress[-1, 1] - stress[-1, 0]) / 2 == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("increments", [1, 7])
def test_secant_modulus_at_the_threshold(increments: int) -> None:
    """[X] 0.722 of G_0 at gamma_07, the difference of principal strains of a triaxial test, in any
    increments.
    """
    stress = sheared(stiff(m=0.0), np.linspace(0, -THRESHOLD * 2 / 3, increments + 1), component=1)
    secant = (stress[-1, 0] - stress[-1, 1]) / 2 / THRESHOLD
    assert secant / G0 == pytest.approx(1 / 1.385, rel=1e-9)
    stress = sheared(stiff(m=0.0), np.linspace(0, -0.05, increments + 1), component=1, p=1e5)
    last = (stress[-1, 1] - stress[-1, 0]) / 2
    limit = (
        ((G0 / UNLOADING) ** 0.5 - 1) * THRESHOLD / 0.385
    )  # from here on the modulus is that of unloading
    exact = -G0 * limit / (1 + 0.385 * limit / THRESHOLD) - UNLOADING * (0.075 - limit)
    assert last == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize(("m", "tolerance"), [(0.0, 1e-12), (0.5, 1e-6)])
def test_masing_loops_close(m: float, tolerance: float) -> None:
    """[X] A loop comes back to its tip, its other tip is the mirror image, and the first loading
    goes on from there.
    """
    n, size = 40, 1e-4
    up = np.linspace(0, size, n + 1)
    path = np.concatenate((up, up[-2::-1], -up[1:], -up[-2::-1], up[1:], size + up[1:]))
    law = stiff(m=m)
    shear, straight = (
        sheared(law, strains, p=1000.0)[:, 3]
        for strains in (path, np.linspace(0, 2 * size, 2 * n + 1))
    )
    assert shear[5 * n] == pytest.approx(shear[n], rel=tolerance)
    assert shear[3 * n] == pytest.approx(-shear[n], rel=tolerance)
    assert shear[-1] == pytest.approx(straight[-1], rel=tolerance)
    assert shear[2 * n] < -0.01 * shear[n]  # the loop is open


def test_small_reversals_do_not_stiffen_what_follows() -> None:
    """[X] After a reversal of a thousandth the first loading goes on."""
    law, size = stiff(m=0.0), 1e-4
    plain = sheared(law, np.array([0.0, size, 2 * size]))
    turned = sheared(law, np.array([0.0, size, 0.999 * size, size, 2 * size]))
    assert turned[-1, 3] == pytest.approx(plain[-1, 3], rel=1e-9)


@pytest.mark.parametrize(("size", "ncomp"), [(1e-5, 4), (1e-4, 4), (1e-4, 6), (1e-3, 4)])
def test_tangent(size: float, ncomp: int) -> None:
    """[N] Second increments, in random directions after a first one: differences of the stress."""
    n = 200
    law, stress, strain = stiff(), stresses(n, ncomp), increments(size, (ncomp, n, 1))
    first = law.update(0.5 * np.roll(strain, 1, axis=1), stress, law.initial_internal(stress))
    stress, internal = first.stress, first.internal
    new = law.update(strain, stress, internal)
    tangent, h, largest = (
        new.tangent(),
        1e-5 * size,
        law.elasticity(ncomp, stress, internal)[:, 0].max(axis=(1, 2)),
    )
    error, kink = np.zeros(n), np.zeros(n)
    for j in range(ncomp):
        step = np.zeros_like(strain)
        step[j] = h
        ahead, behind = (
            sign
            / h
            * (law.update(strain + sign * step, stress, internal).stress - new.stress)[:, :, 0].T
            for sign in (1, -1)
        )
        error = np.maximum(
            error, np.abs(tangent[:, :, j] - (ahead + behind) / 2).max(axis=1) / largest
        )
        kink = np.maximum(kink, np.abs(ahead - behind).max(axis=1) / largest)
    assert (kink < 1e-3).mean() > 0.9
    assert error[kink < 1e-3].max() < 1e-6


@pytest.mark.slow
def test_stiffness_of_first_loading() -> None:
    """At strains of 1e-6 nearly that of E_0, at large ones that of the soil without small-strain
    stiffness.
    """
    small, plain = (
        sc.element_test(law, -100.0, triaxial(-2e-6, increments=4))
        for law in (stiff(), stiff(G0_ref=None, gamma_07=None))
    )
    young = 2.4 * G0  # c cot(phi) raises the stress and the reference alike
    assert 0.75 * young < small.q[-1, 0] / 2e-6 < young
    assert plain.q[-1, 0] / 2e-6 < 0.3 * young
    ends = [
        sc.element_test(law, -100.0, triaxial(-0.2, increments=30)).q[-1, 0]
        for law in (stiff(), stiff(G0_ref=None, gamma_07=None))
    ]
    assert ends[0] == pytest.approx(ends[1], rel=1e-6)  # both fail


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"G0_ref": None}, "needs both G0_ref and gamma_07"),
        ({"gamma_07": None}, "needs both G0_ref and gamma_07"),
        ({"G0_ref": 3e4}, "G0_ref must exceed the shear modulus 37500 of Eur_ref"),
        ({"gamma_07": 0.0}, "gamma_07 must lie between 0 and 0.1"),
    ],
)
def test_bad_parameters(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        stiff(**changes)
