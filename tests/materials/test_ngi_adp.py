"""NGI-ADP: strengths in closed form, mobilisation, tangent, profiles by depth, stages and searches,
bad input.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.laboratory import PathStep, simple_shear, triaxial
from skfem_contact.materials.adp_return import measure
from tests.tools.helpers import grid, vector_basis

ACTIVE, DSS, PASSIVE = 20.0, 14.0, 8.0
QUIET = {"progress": False}
#: Earth pressure at rest: a shear stress of 10 is mobilised.
AT_REST = -np.array([[60.0], [80.0], [60.0], [0.0]])


def clay(**changes: Any) -> sc.NgiAdp:
    given = {
        "s_uA": ACTIVE,
        "s_uDSS": DSS / ACTIVE,
        "s_uP": PASSIVE / ACTIVE,
        "G_ur": 500.0,
        "gamma_A": 0.01,
        "gamma_DSS": 0.02,
        "gamma_P": 0.04,
    }
    return sc.NgiAdp.from_ratios(**(given | changes))


def biaxial(strain: float, increments: int = 15) -> PathStep:
    """Vertical strain in plane strain at constant horizontal stress."""
    return PathStep(stress={"xx": None}, strain={"yy": strain, "zz": 0.0}, increments=increments)


@pytest.mark.parametrize(("start", "perfect"), [(0.0, False), (AT_REST, False), (AT_REST, True)])
def test_strengths(start: Any, perfect: bool) -> None:
    """[X] Active, passive and simple shear, and triaxial compression, from two initial stresses."""
    law = clay(triaxial=0.98)
    law = law.reduced(1.0) if perfect else law
    active, passive = (
        sc.element_test(law, start, biaxial(strain)).stress[-1, :, 0] for strain in (-0.2, 0.4)
    )
    sheared = sc.element_test(law, start, simple_shear(0.3, drained=False, increments=15)).stress[
        -1, :, 0
    ]
    # the stress across the plane approaches its own as the exponential of the strain
    assert (active[0] - active[1]) / 2 == pytest.approx(ACTIVE, rel=1e-6)
    assert (passive[1] - passive[0]) / 2 == pytest.approx(PASSIVE, rel=1e-6)
    assert sheared[3] == pytest.approx(DSS, rel=1e-6)
    assert (sheared[0] - sheared[1]) / 2 == pytest.approx((ACTIVE - PASSIVE) / 2, rel=1e-3)
    compressed = sc.element_test(law, start, triaxial(-0.2, increments=15))
    assert compressed.q[-1, 0] / 2 == pytest.approx(0.98 * ACTIVE, rel=1e-9)
    assert law.mobilised(active[:, None], np.zeros((8, 1)))[0] == pytest.approx(
        (ACTIVE + PASSIVE) / 2, rel=1e-6
    )


def test_strength_in_any_direction_is_an_ellipse() -> None:
    """[X] Strains in all directions of the plane end on the ellipse of the three strengths."""
    law, angle = clay(), np.linspace(0, 2 * np.pi, 24, endpoint=False)
    step = (
        4e-3 * np.stack((np.cos(angle), -np.cos(angle), 0 * angle, 2 * np.sin(angle)))[:, :, None]
    )
    stress = np.repeat(AT_REST, 24, axis=1)[:, :, None]
    internal = law.initial_internal(stress)
    for _ in range(80):
        new = law.update(step, stress, internal)
        stress, internal = new.stress, new.internal
    t, tau = (stress[0] - stress[1])[:, 0] / 2, stress[3, :, 0]
    radius = (ACTIVE + PASSIVE) / 2
    np.testing.assert_allclose(
        ((t - (ACTIVE - PASSIVE) / 2) / radius) ** 2 + (tau / DSS) ** 2, 1.0, rtol=1e-5
    )
    assert (internal[1] > 1).all()
    np.testing.assert_allclose(
        stress[:3].sum(axis=0), AT_REST[:3].sum(), rtol=1e-9
    )  # no change of volume


@pytest.mark.parametrize(
    ("sense", "failure", "strength"), [(-1, 0.01, ACTIVE), (0, 0.02, DSS), (1, 0.04, PASSIVE)]
)
def test_mobilisation_and_strain_at_failure(sense: int, failure: float, strength: float) -> None:
    """[X] From the middle of the strengths the stress follows kappa = 2 sqrt(w) / (1 + w) up to the
    failure strain.
    """
    middle = (ACTIVE - PASSIVE) / 2
    begin = -np.array([[60.0], [60.0 + 2 * middle], [60.0], [0.0]])
    strain = {
        "xx": -sense * failure,
        "yy": sense * failure,
        "zz": 0.0,
        "xy": (sense == 0) * 2 * failure,
    }
    test = sc.element_test(clay(), begin, PathStep(strain=strain, increments=50))
    stress, plastic, w = test.stress[:, :, 0], test.internal[:, 0, 0], test.internal[:, 1, 0]
    reached = np.abs((stress[:, 0] - stress[:, 1]) / 2 - middle) + stress[:, 3]
    np.testing.assert_allclose(w, plastic / failure, rtol=1e-9, atol=1e-14)
    kappa = np.where(w < 1, 2 * np.sqrt(w) / (1 + w), 1.0)
    span = strength + sense * middle if sense else DSS
    np.testing.assert_allclose(reached, kappa * span, rtol=1e-8, atol=1e-9)
    total = np.hypot(test.strain[:, 0, 0] - test.strain[:, 1, 0], test.strain[:, 3, 0])
    np.testing.assert_allclose(total, plastic + reached / (500.0 * ACTIVE), rtol=1e-9, atol=1e-14)
    assert w[20] < 1 < w[-1]


def states(law: sc.NgiAdp, ncomp: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Stresses and memories after random strains from an initial stress at rest."""
    stress = np.zeros((ncomp, n, 1))
    stress[:3], stress[1 if ncomp == 4 else 2] = -60.0, -80.0
    strain = 3e-3 * np.random.default_rng(1).standard_normal(stress.shape)
    new = law.update(strain, stress, law.initial_internal(stress))
    return new.stress, new.internal


@pytest.mark.parametrize("perfect", [False, True])
@pytest.mark.parametrize("ncomp", [4, 6])
@pytest.mark.parametrize("size", 10.0 ** np.arange(-6, -1, 2))
@pytest.mark.one_in(3)
def test_random_increments(size: float, ncomp: int, perfect: bool) -> None:
    """[N] Admissible, dissipating, and with the tangent of differences; a zero increment changes
    nothing.
    """
    law, n = clay(), 200
    law = law.reduced(1.1) if perfect else law
    stress, internal = states(law, ncomp, n)
    strain = size * np.random.default_rng(2).standard_normal(stress.shape)
    new = law.update(strain, stress, internal)
    again = law.update(np.zeros_like(strain), new.stress, new.internal)
    assert np.abs(again.stress - new.stress).max() < 1e-8 * 60.0
    elastic = law.elasticity(ncomp)
    plastic = strain - np.einsum("ij,jnq->inq", np.linalg.inv(elastic), new.stress - stress)
    assert np.abs(plastic[:3].sum(axis=0)).max() < 1e-9 * size + 1e-15
    assert len(new.plastic) > 0.3 * n and (new.internal[:2] >= internal[:2]).all()
    tangent, h, error = np.tile(elastic, (n, 1, 1)), 1e-4 * size, np.zeros(n)
    tangent[new.plastic] = new.tangent()
    for j in range(ncomp):
        step = np.zeros_like(strain)
        step[j] = h
        ahead, behind = (law.update(strain + sign * step, stress, internal) for sign in (1, -1))
        slope = (ahead.stress - behind.stress)[:, :, 0] / (2 * h)
        kink = (ahead.internal[0] > internal[0]) != (
            behind.internal[0] > internal[0]
        )  # at the yield surface
        error = np.maximum(
            error, np.where(kink[:, 0], 0.0, np.abs(slope - tangent[:, :, j].T).max(axis=0))
        )
    assert error.max() < 1e-6 * elastic.max()


@pytest.mark.parametrize("out_of_plane", [1.0, 1e-4])
@pytest.mark.parametrize("ncomp", [4, 6])
def test_derivatives_of_the_measure_of_shear(ncomp: int, out_of_plane: float) -> None:
    """[N] Differences of measure and gradient, with and without a third invariant."""
    s = np.random.default_rng(2).standard_normal((ncomp, 50))
    s[2] *= out_of_plane
    s[4:] *= out_of_plane
    s[:2] -= s[:3].sum(axis=0) / 2
    k = clay(triaxial=0.95)._constants((50,))
    gradient, hessian = measure(s, k).slopes()
    for j in range(ncomp):
        step = np.zeros((ncomp, 1))
        step[j] = 1e-6
        ahead, behind = (measure(s + sign * step, k) for sign in (1, -1))
        quotient = (ahead.value - behind.value) / 2e-6
        np.testing.assert_allclose(gradient[j], quotient, atol=1e-8)
        quotient = (ahead.slopes()[0] - behind.slopes()[0]) / 2e-6
        np.testing.assert_allclose(hessian[:, j], quotient, rtol=1e-6, atol=1e-6)


@pytest.mark.slow
def test_profile_stages_and_strength_reduction() -> None:
    """[X] A pulled block stands with 2 s_uP / q; strengths by depth, a strip on them, and bounds in
    words.
    """
    basis = vector_basis(grid("Q2", [0.0, 1.0], [0.0, 1.0]), "Q2")
    fixed = np.append(basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1"))
    model = sc.Model({"block": sc.SolidForm(basis, clay())}, fixed)
    result = model.run(
        [sc.Stage("pull", sc.traction(basis, "top", (0.0, 12.0)), increments=2)], **QUIET
    )
    assert max(result["pull"].iterations) <= 6
    found = model.strength_reduction(start=result, tolerance=0.02, **QUIET)
    assert found.factor == pytest.approx(2 * PASSIVE / 12.0, rel=0.01)
    deep = clay(s_uA=lambda x: 10.0 - 2.0 * x[1], gamma_A=0.02)
    mesh = grid("Q2", [0.0, 2.0, 4.0], [-4.0, -2.0, 0.0])
    basis = vector_basis(mesh, "Q2", intorder=4)
    ground = sc.Model(
        {"ground": sc.SolidForm(basis, deep, unit_weight=16.0)}, sc.box_supports(basis)
    )
    law, depth = ground.forms["ground"].materials["all"], -np.asarray(basis.global_coordinates())[1]
    np.testing.assert_allclose(law.s_uP, 0.4 * (10.0 + 2.0 * depth))
    np.testing.assert_allclose(law.E, (2.99 * 500.0 * (10.0 + 2.0 * depth)).mean(axis=1))
    start = ground.k0_state(K0=0.9)
    strip = basis.mesh.with_boundaries({"strip": lambda x: (x[1] > -1e-9) & (x[0] < 2.01)})
    load = sc.traction(vector_basis(strip, "Q2", intorder=4), "strip", (0.0, -25.0))
    stage = ground.run([sc.Stage("strip", load, increments=2)], start=start, **QUIET)["strip"]
    assert max(stage.iterations) <= 6 and len(stage.iterations) == 2
    with pytest.raises(ValueError, match="no bounds for NgiAdp"):
        ground.bounds(weight=16.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"s_uA": 0.0}, "E must be positive"),
        ({"s_uP": 1.2}, "s_uP must not exceed s_uA, got 24"),
        ({"s_uDSS": -1.0}, "s_uDSS must be positive"),
        ({"gamma_P": 0.0}, "gamma_P must be positive, got 0"),
        ({"triaxial": 1.0}, "triaxial must lie between 0.9062, without corners, and 1, got 1"),
        ({"gamma_A": None}, "gamma_A must be a finite number, not None"),
    ],
)
def test_bad_parameters(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        clay(**changes)


def test_bad_history() -> None:
    """Failure strains of one strength alone, and an initial stress beyond the strength."""
    with pytest.raises(
        ValueError, match="gamma_DSS and gamma_P missing: give the shear strains at failure"
    ):
        sc.NgiAdp(1e4, 0.49, 20.0, 14.0, 8.0, gamma_A=0.01)
    beyond = np.array([[-60.0, -60.0], [-80.0, -102.0], [-60.0, -60.0], [0.0, 0.0]])
    with pytest.raises(
        ValueError,
        match=r"outside the failure surface at 1 of 2 points: 1\.087 of the .* at point 1",
    ):
        sc.element_test(clay(), beyond, biaxial(-0.01))


def test_gravity_along_another_axis_is_refused() -> None:
    """The active strength is that of compression along the last axis, whatever gravity is: refused
    in a model, and where a stage brings the clay.
    """
    basis = vector_basis(grid("Q1", [0, 1], [0, 1]), "Q1", intorder=2)
    fixed = basis.get_dofs("left").all()
    forms = {"soil": sc.SolidForm(basis, clay(), unit_weight=18.0)}
    needs = r"the material of 'all' in 'soil' needs gravity against the last axis, not \[-1"
    with pytest.raises(ValueError, match=needs):
        sc.Model(forms, fixed, gravity=(-1.0, 0.0))
    elastic = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=1e4, nu=0.3), unit_weight=18.0)}
    model = sc.Model(elastic, fixed, gravity=(-1.0, 0.0))
    with pytest.raises(ValueError, match=needs):
        model.run([sc.Stage("clay", change=forms)], **QUIET)
    sc.Model(forms, fixed, seismic=0.1)
