"""A zero increment after a random one changes nothing, for all laws of soils; ``POINTS=20000``
takes as many points.
"""

from __future__ import annotations

import os

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.errors import IncrementTooLarge
from skfem_contact.materials import Material

SOME = "POINTS" not in os.environ
POINTS = int(os.environ.get("POINTS", "60"))
DECADES = tuple(10.0**-k for k in range(6, 0, -1))
# Laws with their attraction: pressures count from there.
LAWS: dict[str, tuple[Material, float]] = {
    "MohrCoulomb": (
        sc.MohrCoulomb(E=2e4, nu=0.3, c=5.0, phi=30.0, psi=5.0),
        5 / np.tan(np.radians(30)),
    ),
    "HoekBrown": (sc.HoekBrown(2e4, 0.3, sigma_ci=100.0, m_b=2.0, s=0.1, a=0.51), 5.0),
    "CamClay": (sc.CamClay(0.02, 0.1, 1.2, 0.25, 100.0, OCR=1.3, attraction=5.0), 5.0),
    "CamClay, Lode": (
        sc.CamClay(0.02, 0.1, 1.2, 0.25, 100.0, OCR=1.3, extension=0.75, attraction=5.0),
        5.0,
    ),
    "SoftSoilCreep": (
        sc.SoftSoilCreep(0.02, 0.1, 1.2, 0.25, 100.0, mu=4e-3, tau=1.0, OCR=1.3, attraction=5.0),
        5.0,
    ),
    "HardeningSoil": (
        sc.HardeningSoil(37e3, 29.6e3, 90e3, 0.5, c=5.0, phi=41.0, psi=14.0, K0nc=0.34),
        5 / np.tan(np.radians(41)),
    ),
    "HardeningSoil, small strains": (
        sc.HardeningSoil(
            37e3,
            29.6e3,
            90e3,
            0.5,
            c=5.0,
            phi=41.0,
            psi=14.0,
            K0nc=0.34,
            G0_ref=1.2e5,
            gamma_07=2e-4,
        ),
        5 / np.tan(np.radians(41)),
    ),
    "NgiAdp": (
        sc.NgiAdp(
            1e5,
            0.45,
            s_uA=110.0,
            s_uDSS=90.0,
            s_uP=70.0,
            gamma_A=0.01,
            gamma_DSS=0.02,
            gamma_P=0.04,
        ),
        100.0,
    ),
}


def updated(
    law: Material, strain: np.ndarray, stress: np.ndarray, before: np.ndarray
) -> tuple[list[np.ndarray], int]:
    """Return drifts relative to the pressure with an attraction of zero, and the number of points
    that are told.
    """
    time = (1.0,) if law.time_dependent else ()
    try:
        new = law.update(strain, stress, before, *time)
    except IncrementTooLarge:
        if (n := strain.shape[1]) == 1:
            return [], 1
        parts = [
            updated(law, strain[:, at], stress[:, at], before[:, at])
            for at in (slice(n // 2), slice(n // 2, n))
        ]
        return [drift for drifts, _ in parts for drift in drifts], sum(told for _, told in parts)
    again = law.update(np.zeros_like(strain), new.stress, new.internal, *(0.0 for _ in time))
    return [
        np.stack((np.abs(again.stress - new.stress).max(axis=0), -new.stress[:3].mean(axis=0)))
    ], 0


@pytest.mark.parametrize("size", DECADES)
@pytest.mark.parametrize("name", LAWS)
def test_zero_increment_after_a_random_one(name: str, size: float) -> None:
    """[X] The stress stays to 1e-8 of the pressure at every point, and hardly a point is told to be
    too far.
    """
    law, attraction = LAWS[name]
    n = (
        6 if SOME and size == DECADES[-1] and name.startswith("Hardening") else POINTS
    )  # half a second a point
    rng = np.random.default_rng(3)
    stress = -rng.uniform(20, 400, n) * np.array([0.5, 1.0, 0.5, 0.0])[:, None]
    found, told = updated(
        law, size * rng.standard_normal((4, n)), stress, law.initial_internal(stress)
    )
    drift, pressure = np.concatenate(found, axis=1)
    size_of = (
        np.abs(pressure) + attraction
        if name == "NgiAdp"
        else np.maximum(pressure + attraction, 1e-3)
    )
    worst = (drift / size_of).max()  # the strength of undrained clay knows no pressure
    print(f"{name} {size:g}: {n} points, drift {worst:.1e}, {told} told")
    assert worst <= 1e-8
    assert told <= 0.05 * n * (size == DECADES[-1])
