"""Mohr-Coulomb: exact return, consistent tangent, element tests, dissipation."""

from __future__ import annotations

from fractions import Fraction as F

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.materials import MohrCoulomb, pyramid
from tests.oracles.koiter import pyramid_return
from tests.oracles.mohr_coulomb import rational_return
from tests.tools.material_points import (
    assert_history,
    assert_tangent,
    components,
    principal_stresses,
    random_points,
    random_strains,
    rotations,
    update,
)

# Principal trial strains and the exact stresses for sin psi = 0, 1/4 and 1/2; E = 1000, nu = 1/4,
# sin phi = 1/2, 2 c cos phi = 10.
TABLE = {
    "face": ("1/100 -1/200 -3/100", "-4 -14 -32", "-22/5 -72/5 -166/5", "-14/3 -44/3 -34"),
    "face, far": ("1/50 0 -1/20", "-7 -12 -41", "-46/5 -71/5 -238/5", "-32/3 -47/3 -52"),
    "edge s1 = s2, equal": (
        "1/100 1/100 -1/20",
        "-8 -8 -44",
        "-48/5 -48/5 -244/5",
        "-32/3 -32/3 -52",
    ),
    "edge s1 = s2": (
        "1/100 9/1000 -1/20",
        "-42/5 -42/5 -226/5",
        "-246/25 -246/25 -1238/25",
        "-54/5 -54/5 -262/5",
    ),
    "edge s2 = s3, equal": (
        "1/50 -1/50 -1/50",
        "0 -20 -20",
        "-40/37 -860/37 -860/37",
        "-40/23 -580/23 -580/23",
    ),
    "edge s2 = s3": (
        "3/100 -19/1000 -1/50",
        "22/7 -74/7 -74/7",
        "30/37 -650/37 -650/37",
        "-14/23 -502/23 -502/23",
    ),
    "apex, equal": ("1/50 1/50 1/50", "10 10 10", "10 10 10", "10 10 10"),
    "apex": ("3/100 1/50 1/100", "10 10 10", "10 10 10", "10 10 10"),
    "elastic, equal": ("-1/50 -1/50 -2/25", None, None, None),
    "elastic": ("-1/100 -1/100 -3/200", None, None, None),
}
COMPONENTS = pytest.mark.parametrize("ncomp", [4, 6])
# phi, psi, c; E = 2e4, nu = 0.3 in all random tests.
LAWS = {
    "associated": (30.0, 30.0, 10.0),
    "dilatant": (35.0, 10.0, 10.0),
    "psi = 0": (30.0, 0.0, 10.0),
    "Tresca": (0.0, 0.0, 10.0),
    "cohesionless": (38.0, 8.0, 0.0),
    "steep": (60.0, 5.0, 10.0),
}
RANDOM_LAWS = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def soil(law: tuple[float, float, float] = LAWS["dilatant"]) -> MohrCoulomb:
    phi, psi, c = law
    return MohrCoulomb(E=2e4, nu=0.3, c=c, phi=phi, psi=psi)


def excess(material: MohrCoulomb, stress: np.ndarray) -> np.ndarray:
    """Yield function from the eigenvalues of numpy."""
    s = principal_stresses(stress)
    sine, cosine = np.sin(np.radians(material.phi)), np.cos(np.radians(material.phi))
    return (1 + sine) * s[..., 2] - (1 - sine) * s[..., 0] - 2 * material.c * cosine


@COMPONENTS
@pytest.mark.parametrize("case", TABLE)
def test_exact_table(case: str, ncomp: int) -> None:
    """[X] Returns in rational numbers (table F1), for stresses in random directions."""
    strain = [F(x) for x in TABLE[case][0].split()]
    trial = [400 * sum(strain) + 800 * e for e in strain]
    rotation = rotations(20, ncomp, np.random.default_rng(1))
    for sine, printed in zip((F(0), F(1, 4), F(1, 2)), TABLE[case][1:]):
        exact = rational_return(trial, 400, 400, F(1, 2), sine, 10)
        assert exact == ([F(x) for x in printed.split()] if printed else trial)
        phi = np.degrees(np.arcsin(0.5))
        material = MohrCoulomb(
            1000.0,
            0.25,
            c=5 / np.cos(np.radians(phi)),
            phi=phi,
            psi=min(phi, np.degrees(np.arcsin(float(sine)))),
        )
        result = update(
            material, components(np.array([strain] * 20, float), rotation, ncomp, shear=2)
        )
        expected = components(np.array([exact] * 20, float), rotation, ncomp)
        # a dozen roundings of stresses up to 52
        np.testing.assert_allclose(result.stress, expected, atol=1e-13 * 52)


@COMPONENTS
@RANDOM_LAWS
def test_random_returns_against_active_sets(law: tuple[float, float, float], ncomp: int) -> None:
    """[X] 1e4 random points in all regions: stress of the active-set search, no excess, same
    directions.
    """
    rng = np.random.default_rng(2)
    n = 10_000 if ncomp == 4 else 8_000
    material = soil(law)
    principal = random_strains(n, rng)
    rotation = rotations(n, ncomp, rng)
    result = update(material, components(principal, rotation, ncomp, shear=2))

    lam, mu = material.lame
    trial = lam * principal.sum(axis=1, keepdims=True) + 2 * mu * principal
    phi, psi = np.radians(law[:2])
    strength = 2 * material.c * np.cos(phi)
    expected, region = pyramid_return(trial, lam, mu, np.sin(phi), np.sin(psi), strength)
    assert set(region) == ({0, 1, 2, 3} if law[0] > 0 else {0, 1, 2})
    edges = np.sort(expected[region == 2], axis=1)
    assert all((edges[:, i + 1] - edges[:, i] < 1e-10).any() for i in (0, 1))

    # The strains give trial stresses up to 600, 60 times the cohesion; their round-off is 1e-13.
    scale = max(material.c, 10.0)
    error = np.abs(result.stress - components(expected, rotation, ncomp)) / scale
    assert error.max() <= 1e-11
    assert excess(material, result.stress).max() <= 1e-11 * scale
    np.testing.assert_array_equal(result.plastic, np.flatnonzero(region > 0))


@COMPONENTS
@RANDOM_LAWS
def test_tangent_against_finite_differences(law: tuple[float, float, float], ncomp: int) -> None:
    """[X] Consistent tangent, equal principal stresses included; kinks within the step are left
    out.
    """
    assert_tangent(soil(law), random_points(5000, ncomp, np.random.default_rng(3)))


@COMPONENTS
def test_any_parameters_in_exact_arithmetic(ncomp: int) -> None:
    """[X] Each element its own parameters, up to their bounds, and stresses over nine orders of
    magnitude.
    """
    rng = np.random.default_rng(4)
    n = 1000
    phi = rng.choice([0.0, 1e-6, 20.0, 45.0, 85.0, 89.9], n)
    psi = phi * rng.choice([0.0, 1e-6, 0.5, 1.0], n)
    material = MohrCoulomb(
        E=10 ** rng.uniform(0, 6, n),
        nu=rng.choice([-0.9, 0.0, 0.3, 0.499], n),
        c=rng.choice([0.0, 1.0], n),
        phi=phi,
        psi=psi,
    )
    trial = np.sort(rng.normal(size=(n, 3)) * 10 ** rng.uniform(-3, 6, (n, 1)), axis=1)[:, ::-1]
    trial[::7, 1] = trial[::7, 0]
    trial[::9, 2] = trial[::9, 1]
    rotation = rotations(n, ncomp, rng)
    stress = components(trial, rotation, ncomp)
    result = update(material, np.zeros_like(stress), stress).stress

    constants = zip(
        *material.lame,
        np.sin(np.radians(phi)),
        np.sin(np.radians(psi)),
        2 * material.c * np.cos(np.radians(phi)),
    )
    exact = [rational_return([F(t) for t in row], *map(F, k)) for row, k in zip(trial, constants)]
    expected = components(np.array(exact, float), rotation, ncomp)
    # Round-off of the trial stress; at phi = 89.9 degrees it is magnified along the flat edge to
    # the apex.
    error = np.abs(result - expected).max(axis=0) / np.abs(trial).max(axis=1)
    assert error.max() <= 1e-12
    assert (
        excess(material, result) <= 1e-13 * np.maximum(np.abs(expected).max(axis=0), material.c)
    ).all()


@COMPONENTS
@RANDOM_LAWS
def test_random_history(law: tuple[float, float, float], ncomp: int) -> None:
    """[X] 1e5 random increments: dissipation, no excess, no drift, hardening variable from its
    definition.
    """
    material = soil(law)
    assert_history(material, lambda stress, _: excess(material, stress), ncomp)


@COMPONENTS
def test_point_on_the_surface_is_elastic_without_increment(ncomp: int) -> None:
    """[X] A returned stress returns to itself: no plastic point, no change but round-off."""
    rng = np.random.default_rng(6)
    strain = random_points(20_000, ncomp, rng)
    first = update(soil(), strain)
    again = update(soil(), np.zeros_like(strain), first.stress)
    assert first.plastic.size > 10_000
    assert again.plastic.size == 0
    np.testing.assert_array_equal(again.stress, first.stress)


@COMPONENTS
def test_closed_elastic_cycle(ncomp: int) -> None:
    """[X] Inside the surface no work is lost."""
    rng = np.random.default_rng(7)
    stress = np.zeros((ncomp, 50))
    stress[:3] = -100.0
    increment = rng.normal(size=stress.shape) * 1e-4
    out = update(soil(), increment, stress)
    back = update(soil(), -increment, out.stress)
    assert out.plastic.size == back.plastic.size == 0
    np.testing.assert_allclose(back.stress, stress, atol=1e-13 * 100)


def test_parameters_of_each_element() -> None:
    """[X] Arrays of parameters give what the elements give one by one; fields have any trailing
    shape.
    """
    rng = np.random.default_rng(8)
    parameters = {
        "E": rng.uniform(1e4, 3e4, 6),
        "nu": rng.uniform(0, 0.45, 6),
        "c": rng.uniform(0, 10, 6),
        "phi": rng.uniform(20, 40, 6),
        "psi": rng.uniform(0, 20, 6),
    }
    strain, stress = rng.normal(size=(4, 6, 9)) * 3e-3, rng.normal(size=(4, 6, 9))
    internal = rng.uniform(size=(1, 6, 9))
    whole = MohrCoulomb(**parameters)
    result = whole.update(strain, stress, internal)
    tangent = np.zeros((6, 9, 4, 4))
    tangent.reshape(-1, 4, 4)[result.plastic] = result.tangent()
    assert 20 < result.plastic.size < 54
    assert whole.elasticity(4).shape == (6, 4, 4)
    for i in range(6):
        single = MohrCoulomb(**{name: values[i] for name, values in parameters.items()})
        np.testing.assert_allclose(whole.elasticity(4)[i], single.elasticity(4), rtol=1e-15)
        part = single.update(strain[:, i], stress[:, i], internal[:, i])
        np.testing.assert_allclose(result.stress[:, i], part.stress, rtol=1e-13, atol=1e-12)
        np.testing.assert_allclose(result.internal[:, i], part.internal, rtol=1e-13)
        np.testing.assert_allclose(
            tangent[i, part.plastic], part.tangent(), rtol=1e-10, atol=1e-10 * single.E
        )


def test_update_is_pure_and_its_tangent_lazy(monkeypatch: pytest.MonkeyPatch) -> None:
    """[X] Arguments stay as they were; nothing of the tangent is computed before it is called."""
    rng = np.random.default_rng(9)
    arguments = [rng.normal(size=(4, 30)) * 5e-3, rng.normal(size=(4, 30)), np.zeros((1, 30))]
    copies = [a.copy() for a in arguments]
    calls = []
    fill = pyramid._moduli
    monkeypatch.setattr(pyramid, "_moduli", lambda *a: calls.append(1) or fill(*a))
    result = soil().update(*arguments)
    assert result.plastic.size and not calls
    np.testing.assert_array_equal(result.tangent(), result.tangent())
    assert calls
    for argument, copy in zip(arguments, copies):
        np.testing.assert_array_equal(argument, copy)


def test_reduced_strength() -> None:
    """[X] c and tan(phi) over the factor; associated stays associated, otherwise psi is capped by
    phi.
    """
    material = MohrCoulomb(1e4, 0.3, c=10.0, phi=np.array([30.0, 20.0]), psi=np.array([10.0, 20.0]))
    reduced = material.reduced(1.5)
    assert reduced.c == pytest.approx(10 / 1.5, rel=1e-15)
    np.testing.assert_allclose(
        np.tan(np.radians(reduced.phi)), np.tan(np.radians(material.phi)) / 1.5, rtol=1e-14
    )
    np.testing.assert_allclose(reduced.psi, [10.0, reduced.phi[1]], rtol=1e-15)
    raised = material.reduced(0.5)
    np.testing.assert_allclose(raised.psi, [10.0, raised.phi[1]], rtol=1e-15)
    associated = MohrCoulomb(1e4, 0.3, c=10.0, phi=30.0, psi=30.0)
    assert associated.reduced(2.0).psi == associated.reduced(2.0).phi < 30
    assert associated.reduced(0.5).psi == associated.reduced(0.5).phi > 30
    with pytest.raises(ValueError, match="factor must be positive, got 0"):
        material.reduced(0.0)


def test_one_soil_of_two_that_dilates_less_decides() -> None:
    """[X] The bound of associated flow is the largest of all elements: that of the soil whose
    dilation is smaller than its friction.
    """
    elastic = {"E": 1e4, "nu": 0.3, "c": 1.0}
    both = sc.MohrCoulomb(**elastic, phi=np.array([20.0, 30.0]), psi=np.array([20.0, 10.0]))
    first, second = (
        sc.MohrCoulomb(**elastic, phi=phi, psi=psi) for phi, psi in ((20.0, 20.0), (30.0, 10.0))
    )
    assert (both.dilates_less, first.dilates_less, second.dilates_less) == (True, False, True)
    assert first.associated_bound(1.2) == 1.2
    assert both.associated_bound(1.2) == second.associated_bound(1.2) > 1.2
