"""Modified Cam Clay: closed forms of its tests, its tangent and its yield condition at random
points, refusals.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import skfem_contact as sc
from skfem_contact.errors import IncrementTooLarge
from skfem_contact.laboratory import PathStep, isotropic, oedometer, triaxial
from skfem_contact.materials import cam_clay_return
from skfem_contact.testing import check_material
from tests.tools.helpers import grid, vector_basis

KAPPA, LAMBDA, M, NU, P = 0.02, 0.1, 1.2, 0.25, 100.0
#: Ratio of shear modulus to mean stress.
SHEAR = 1.5 * (1 - 2 * NU) / (1 + NU) / KAPPA
QUIET = {"progress": False}


def clay(OCR=1.0, extension=1.0, unit=1.0, **others):
    """Clay of these parameters with another history, shape, or unit of stress."""
    return sc.CamClay(KAPPA, LAMBDA, M, NU, P * unit, OCR, extension=extension, **others)


@pytest.mark.parametrize("increments", [1, 10])
def test_isotropic(increments):
    """[X] Compression to the fourfold pressure and back to half of that; single increments are as
    good as ten.
    """
    test = sc.element_test(
        clay(), -P, [isotropic(-4 * P, increments), isotropic(-2 * P, increments)]
    )
    volumes = -LAMBDA * np.log(4), -LAMBDA * np.log(4) + KAPPA * np.log(2)
    np.testing.assert_allclose(
        test.volume[[increments, -1], 0], volumes, rtol=1e-9
    )  # ten times Newton's tolerance
    np.testing.assert_allclose(test.variable("preconsolidation pressure")[-1], 4 * P, rtol=1e-9)


def undrained_pressure(eta, OCR, conservative):
    """Mean stress on the yield surface of an undrained path from isotropic stress, in closed
    form.
    """
    plastic = np.log(OCR) - np.log(1 + eta**2 / M**2)
    stored = eta**2 / (6 * SHEAR) if conservative else 0.0  # elastic volume strain of shear
    return P * np.exp((stored + (LAMBDA - KAPPA) * plastic) / LAMBDA)


@pytest.mark.parametrize("conservative", [False, True])
@pytest.mark.parametrize("increments", [50, 200])
@pytest.mark.parametrize("OCR", [1.0, 1.5])
@pytest.mark.one_in(2)
def test_undrained_path(OCR, increments, conservative):
    """[X] Undrained compression: the path in p and q does not depend on the increments."""
    law = clay(OCR, conservative=conservative)
    test = sc.element_test(law, -P, triaxial(-0.3, drained=False, increments=increments))
    yielding = test.variable("plastic strain")[:, 0] > 1e-6
    p, eta = test.p[yielding, 0], test.q[yielding, 0] / test.p[yielding, 0]
    np.testing.assert_allclose(p, undrained_pressure(eta, OCR, conservative), rtol=1e-7)
    assert p[-1] / undrained_pressure(M, OCR, conservative) == pytest.approx(
        1.0, abs=2e-3
    )  # eta approaches M as exp(-strain)
    assert test.iterations.max() <= 6


@pytest.mark.parametrize("nu", [0.0, 0.2, 0.35])
def test_undrained_strength(nu):
    """[X] M p / 2 (OCR / 2)^(1 - kappa / lambda) for every Poisson's ratio; the conservative law is
    stronger by the factor of its docstring.
    """
    OCR, strain = np.array([1.0, 2.0, 10.0]), np.array([0.3, 0.3, 0.6])
    strength = 0.5 * M * P * (OCR / 2) ** (1 - KAPPA / LAMBDA)
    factor = np.exp(KAPPA * (1 + nu) * M**2 / (9 * (1 - 2 * nu) * LAMBDA))
    for conservative, exact in ((False, strength), (True, factor * strength)):
        law = sc.CamClay(KAPPA, LAMBDA, M, nu, P, OCR, conservative=conservative)
        path = triaxial(-strain, drained=False, increments=100)
        test = sc.element_test(law, -P * np.ones(3), path)
        assert test.q[-1] / 2 == pytest.approx(exact, rel=1e-3)  # eta is near M at the end


def test_elastic_strain_in_one_increment():
    """[X] Compression and shear inside the yield surface at once: ds = 2 G de with G = g p, whose
    mean is known, in any number of increments.
    """
    law, volume = clay(50.0), 0.02
    strain = {"xx": -volume / 3 + 0.01, "yy": -volume / 3 - 0.01, "zz": -volume / 3, "xy": 0.004}
    mean = P * np.expm1(volume / KAPPA) / (volume / KAPPA)
    for increments in (1, 7):
        test = sc.element_test(law, -P, PathStep(strain=strain, increments=increments))
        stress = test.stress[-1, :, 0]
        assert test.p[-1, 0] == pytest.approx(P * np.exp(volume / KAPPA), rel=1e-9)
        assert stress[0] - stress[1] == pytest.approx(2 * SHEAR * mean * 0.02, rel=1e-9)
        assert stress[3] == pytest.approx(SHEAR * mean * 0.004, rel=1e-9)


def strain_of_drained_path(eta, conservative):
    """Shear strain of drained compression from isotropic normal consolidation, by quadrature.

    The elastic part is the integral of dq / (3 G) with dq = p 3 deta / (3 - eta), or eta / (3 g).
    """

    def rate(x):
        return (1 / (3 - x) + 2 * x / (M**2 + x**2)) * 2 * x / (M**2 - x**2)

    elastic = eta / 3 if conservative else np.log(3 / (3 - eta))
    return (LAMBDA - KAPPA) * quad(rate, 0, eta, epsabs=1e-12)[0] + elastic / SHEAR


@pytest.mark.slow
@pytest.mark.parametrize("conservative", [False, True])
def test_drained_path(conservative):
    """[N] Drained compression: stress ratio by quadrature within 2e-3 at 200 increments, of first
    order.
    """
    errors = []
    law = clay(conservative=conservative)
    for increments in (100, 200):
        test = sc.element_test(law, -P, triaxial(-0.1, increments=increments))
        eta = test.q[-1, 0] / test.p[-1, 0]
        np.testing.assert_allclose(test.p[-1], 3 * P / (3 - eta), rtol=1e-9)
        shear = -(test.axial[-1, 0] - test.volume[-1, 0] / 3)
        exact = brentq(
            lambda x, s=shear: strain_of_drained_path(x, conservative) - s, 0.1, M - 1e-6
        )
        errors.append(abs(eta / exact - 1))
    assert errors[1] < 2e-3 and 1.8 < errors[0] / errors[1] < 2.2


@pytest.mark.slow
def test_critical_state():
    """[X] Compression and extension end at the stress ratios of their own M, overconsolidated clay
    from above.
    """
    ratio = 0.75
    OCR, sense = np.array([1.0, 1.0, 4.0, 4.0]), np.array([-1, 1, -1, 1])
    law = clay(OCR, ratio)
    path = triaxial(sense * 0.6, drained=False, increments=300)
    test = sc.element_test(law, -P * np.ones(4), path)
    exact = np.where(sense < 0, M, ratio * M)
    assert test.q[-1] / test.p[-1] == pytest.approx(exact, rel=1e-3)
    shear, limit = law.mobilised(test.stress[-1][:, :, None], test.internal[-1][:, :, None])
    assert shear / limit == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("ncomp", [4, 6])
@pytest.mark.parametrize("extension", [1.0, 0.71])
@pytest.mark.parametrize("strain", [1e-5, 1e-4, 1e-3])
@pytest.mark.parametrize("conservative", [False, True])
@pytest.mark.one_in(3)
def test_contract(ncomp, extension, strain, conservative):
    """Shapes, admissibility, and tangent within 1e-6 of the largest modulus at smooth points."""
    law = clay(1.3, extension, attraction=1.0, conservative=conservative)
    assert (
        check_material(
            law, strain, ncomp=ncomp, dissipation=False, initial_stress=-P, tolerance=1e-6
        )
        < 1e-6
    )


@pytest.mark.parametrize("size", 10.0 ** np.arange(-6, 0))
@pytest.mark.parametrize(("extension", "conservative"), [(1.0, False), (0.71, False), (0.71, True)])
@pytest.mark.one_in(3)
def test_yield_condition_and_dissipation_at_random_points(size, extension, conservative):
    """20,000 points: a zero increment changes nothing, flow dissipates; points without a solution
    are told.
    """
    rng, n = np.random.default_rng(3), 20_000
    law = clay(1.0 + 9.0 * rng.random(n) ** 2, extension, conservative=conservative)
    stress = np.zeros((6, n, 1))
    stress[:3] = -P * 10.0 ** rng.uniform(-1, 1, n)[:, None]
    stress += 0.2 * stress[0] * rng.standard_normal(stress.shape)
    internal = law.initial_internal(stress)
    increment = size * rng.standard_normal(stress.shape)
    told = np.zeros(n, bool)
    try:
        new = law.update(increment, stress, internal)
    except IncrementTooLarge as error:  # at single points: leave them out
        assert size >= 1e-2 and "the mean stress changes" in str(error)
        told = np.abs(increment[:3].sum(axis=0)[:, 0]) > 0.15
        assert told.mean() < 0.6
        increment[:, told] = 0.0
        new = law.update(increment, stress, internal)
    pressure = -new.stress[:3].mean(axis=0)
    again = law.update(np.zeros_like(increment), new.stress, new.internal)
    assert (np.abs(again.stress - new.stress) / pressure).max() < 1e-8
    assert (np.abs(again.internal[1] / new.internal[1] - 1)).max() < 1e-8
    q = np.sqrt(
        1.5 * ((new.stress[:3] + pressure) ** 2).sum(axis=0) + 3 * (new.stress[3:] ** 2).sum(axis=0)
    )
    if extension == 1.0:  # admissible: not outside of the ellipse
        assert (q**2 / M**2 / pressure + pressure - new.internal[1]).max() < 1e-9 * new.internal[
            1
        ].max()
    # work = change of the free energy p / k and dissipation; the work of an increment by its end
    # stress is no less
    plastic_volume = np.log(new.internal[1] / internal[1]) * (LAMBDA - KAPPA)
    shear = np.sqrt(np.maximum((new.internal[0] - internal[0]) ** 2 - plastic_volume**2, 0.0))
    assert (pressure * plastic_volume + q * shear).min() > -1e-12 * P


def test_no_work_in_an_elastic_cycle():
    """[X] Closed cycles of strain inside the yield surface of the conservative law: less than 1e-5
    of the work is left.
    """
    law, n = clay(50.0, conservative=True), 400
    angle = np.linspace(0, 2 * np.pi, n + 1)
    path = 1e-3 * np.stack((np.cos(angle) - 1, np.sin(2 * angle), np.sin(angle), np.sin(3 * angle)))
    stress = np.array([-P, -P, -P, 0.0])[:, None, None]
    internal, work, done = law.initial_internal(stress), 0.0, 0.0
    first = stress
    for change in np.diff(path, axis=1).T:
        new = law.update(change[:, None, None], stress, internal)
        part = float(0.5 * ((stress + new.stress)[:, 0, 0] @ change))
        work, done, stress = work + part, done + abs(part), new.stress
    np.testing.assert_allclose(stress, first, rtol=0, atol=1e-10 * P)
    assert abs(work) < 1e-5 * done  # the trapezoidal rule at 400 increments
    assert np.array_equal(new.internal, internal)


@pytest.mark.slow
def test_units_and_overconsolidation():
    """[X] All stresses scale with the unit; every overconsolidation ratio reaches the end in 400
    increments.
    """
    OCR = np.array([1.0, 2.0, 10.0, 50.0])
    whole = sc.element_test(
        clay(OCR), -P * np.ones(4), triaxial(-0.4, drained=False, increments=400)
    )
    np.testing.assert_allclose(whole.q[-1] / whole.p[-1], M, rtol=0.02)
    path = triaxial(-0.1, drained=False, increments=100)
    base = sc.element_test(clay(OCR), -P * np.ones(4), path)
    for unit in (0.01, 1e3):
        test = sc.element_test(clay(OCR, unit=unit), -P * unit * np.ones(4), path)
        np.testing.assert_allclose(test.stress / unit, base.stress, rtol=1e-8, atol=1e-8)


def test_reversed_cycles():
    """60 cycles of undrained strain: the yield condition holds to the end and nothing drifts."""
    law = clay(2.0)
    path = [triaxial(sign * 2e-3, drained=False, increments=4) for sign in [-1, 1] * 60]
    test = sc.element_test(law, -P, path)
    q, p, pc = test.q[:, 0], test.p[:, 0], test.variable("preconsolidation pressure")[:, 0]
    assert (q**2 / M**2 / p + p - pc).max() < 1e-8 * P
    np.testing.assert_allclose(test.volume, 0.0, atol=1e-12)
    np.testing.assert_allclose(test.stress[-8:], test.stress[-16:-8], rtol=1e-3, atol=1e-3 * P)


def test_history():
    """[X] Preconsolidation pressure from OCR and POP at an anisotropic stress; arrays have one
    value an element.
    """
    stress = np.array([-60.0, -100.0, -60.0, 0.0])[:, None, None] * np.ones((1, 2, 3))
    law = clay(np.array([1.0, 2.0]), POP=5.0, attraction=10.0)
    p, q = 220 / 3 + 10.0, 40.0
    expected = np.array([1.0, 2.0])[:, None] * (p + q**2 / (M**2 * p)) + 5.0
    internal = law.initial_internal(stress)
    np.testing.assert_allclose(internal[1], expected * np.ones((2, 3)), rtol=1e-12)
    moduli = law.elasticity(4, stress, internal)
    assert moduli.shape == (2, 3, 4, 4)
    np.testing.assert_allclose(moduli, np.swapaxes(moduli, 2, 3), rtol=1e-12)


def test_bad_input():
    """Parameters out of range and stresses in tension are refused with the figure."""
    for message, changes in [
        ("lambda_ must exceed kappa, got 0.01", {"lambda_": 0.01}),
        ("M must be positive", {"M": 0.0}),
        ("kappa must be positive", {"kappa": 0.0}),
        ("OCR must not be less than 1, got 0.9", {"OCR": 0.9}),
        ("nu must lie", {"nu": 0.5}),
        ("extension must lie", {"extension": 0.5}),
        ("p_ref must be", {"p_ref": 0.0}),
        ("attraction must not be neg", {"attraction": -1.0}),
        ("POP must not be neg", {"POP": -1.0}),
        ("conservative must be True or False, not 1.0", {"conservative": 1.0}),
    ]:
        given = {"kappa": KAPPA, "lambda_": LAMBDA, "M": M, "nu": NU, "p_ref": P} | changes
        with pytest.raises(ValueError, match=message):
            sc.CamClay(**given)
    with pytest.raises(ValueError, match=r"attraction is -10 at point 1 \(1 of 2 points\)"):
        sc.element_test(clay(), [-100.0, 10.0], isotropic(-1.0))
    with pytest.raises(ValueError, match="neither stiffness nor strength without pressure"):
        sc.element_test(clay(), 0.0, isotropic(-1.0))
    with pytest.raises(ValueError, match="no strength to reduce"):
        clay().reduced(2.0)


@pytest.mark.parametrize("stress", [(1.0, 1.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)])
def test_initial_stress_without_pressure_is_refused(stress):
    """Tension and shear without pressure have no yield surface; no stress at all has an empty
    one.
    """
    points = np.array([(-1.0, -1.0, -1.0, 0.0), stress]).T[:, None]
    with pytest.raises(ValueError, match=r"at point 1 \(1 of 2 points\)"):
        clay().initial_internal(points)
    assert not clay().initial_internal(0.0 * points).any()


def test_unloading_to_zero_is_told():
    """The mean stress never falls to zero: an element test names the end, and keeps what was
    reached.
    """
    with pytest.raises(sc.NotConverged, match="stops after") as caught:
        sc.element_test(clay(), -P, isotropic(10.0, increments=22))
    assert caught.value.result.p[-1, 0] == pytest.approx(5.0)
    test = sc.element_test(clay(attraction=20.0), -P, isotropic(10.0, increments=22))
    assert test.volume[-1, 0] == pytest.approx(KAPPA * np.log(120 / 10), rel=1e-9)


def test_column_on_normally_consolidated_clay():
    """[N] A column from K0: settlement of a load is that of the oedometer, in at most five
    iterations an increment.
    """
    law = clay(1.2, attraction=1.0)
    basis = vector_basis(grid("Q2", [0.0, 1.0], np.linspace(0.0, 1.0, 3)), "Q2")
    model = sc.Model({"clay": sc.SolidForm(basis, law)}, sc.box_supports(basis, base="rollers"))
    load = model.traction("top", (0.0, -1.0))
    start = model.k0_state(P * load, unit_weights=0.0, K0=0.6, surcharge=P)
    result = model.run([sc.Stage("fill", 3 * P * load, increments=10)], start=start, **QUIET)
    stress = np.array([-60.0, -100.0, -60.0, 0.0])[:, None]
    test = sc.element_test(law, stress, oedometer(stress=-3 * P, increments=10))
    top = result["fill"].x[basis.get_dofs("top").all("u^2")]
    np.testing.assert_allclose(top, test.axial[-1, 0], rtol=1e-7)
    assert max(result["fill"].iterations) <= 5


def test_undrained_column():
    """[N] Undrained(CamClay) with stiff water follows constant volume; its water's modulus follows
    the pressure.
    """
    soil = sc.Undrained(clay(1.5), nu_undrained=0.4999)
    water = sc.element_test(soil, -P, triaxial(-0.05, increments=50))
    constant = sc.element_test(clay(1.5), -P, triaxial(-0.05, drained=False, increments=50))
    np.testing.assert_allclose(
        water.q, constant.q, atol=3e-3 * P
    )  # the water takes 0.9995 of the volume
    np.testing.assert_allclose(water.pore_pressure, constant.pore_pressure, atol=3e-3 * P)


def test_undrained_block():
    """[N] A block of Undrained(CamClay) under a load follows the sample of the laboratory."""
    soil = sc.Undrained(clay(1.5), nu_undrained=0.499)
    basis = vector_basis(grid("Q2", [0.0, 1.0], [0.0, 1.0]), "Q2")
    ground = sc.SolidForm(basis, clay(1.5), coordinates="axisymmetric")
    model = sc.Model(
        {"clay": ground}, [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    )
    load = P * (model.traction("top", (0.0, -1.0)) + model.traction("right", (-1.0, 0.0)))
    start = model.initial_state(
        load, stress=lambda x: -P * np.array([1.0, 1.0, 1.0, 0.0])[:, None, None] + 0 * x[0]
    )
    quick = sc.Model({"clay": ground.with_materials({"all": soil})}, model.fixed)
    more = load + model.traction("top", (0.0, -0.5 * P))
    stage = quick.run([sc.Stage("quick", more, increments=5)], start=start, **QUIET)["quick"]
    test = sc.element_test(soil, -P, triaxial(stress=-1.5 * P, increments=5))
    top = stage.x[basis.get_dofs("top").all("u^2")]
    np.testing.assert_allclose(
        top, test.axial[-1, 0], rtol=1e-6
    )  # increments end at Newton's tolerance
    np.testing.assert_allclose(stage.pore_pressure("clay"), test.pore_pressure[-1, 0], rtol=1e-6)


@pytest.mark.slow
def test_increment_too_large_is_cut_in_a_model():
    """A pull that empties the pressure in one increment: the run cuts it, and stops in words where
    no soil is left.
    """
    basis = vector_basis(grid("Q1", [0.0, 1.0], [0.0, 1.0]), "Q1")
    model = sc.Model({"clay": sc.SolidForm(basis, clay())}, sc.box_supports(basis, base="rollers"))
    load = model.traction("top", (0.0, -1.0))
    start = model.k0_state(P * load, unit_weights=0.0, K0=1.0, surcharge=P)
    # fewer iterations than by default: the pull tries many increments
    quick = sc.Model(model.forms, model.fixed, newton=sc.Newton(max_iterations=8))
    with pytest.raises(sc.NotConverged) as caught:
        quick.run([sc.Stage("pull", -P * load)], start=start, **QUIET)
    assert caught.value.result is not None
    eased = model.run([sc.Stage("ease", 0.1 * P * load)], start=start, **QUIET)["ease"]
    assert eased.states["clay"].stress[1].max() == pytest.approx(-0.1 * P, rel=1e-6)


def test_searches_are_refused_in_words():
    """No strength reduction and no bounds: the messages name the material."""
    basis = vector_basis(grid("Q1", [0.0, 1.0], [0.0, 1.0]), "Q1")
    model = sc.Model(
        {"clay": sc.SolidForm(basis, clay(attraction=1.0))}, sc.box_supports(basis, base="rollers")
    )
    load = model.traction("top", (0.0, -1.0))
    with pytest.raises(ValueError, match="strength"):
        model.strength_reduction(load, **QUIET)
    with pytest.raises(ValueError, match="CamClay"):
        model.bounds(weight=20.0)


def test_starts_changes_and_files(tmp_path):
    """Gravity with and without K0, a change from Mohr-Coulomb, saved and resumed: in equilibrium,
    in few iterations.
    """
    law = clay(1.5, attraction=20.0)
    basis = vector_basis(grid("Q2", np.linspace(0.0, 2.0, 3), np.linspace(0.0, 4.0, 4)), "Q2")
    load = sc.weight(basis, 20.0)
    push = sc.traction(basis, "top", (0.0, -30.0))
    model = sc.Model({"clay": sc.SolidForm(basis, law)}, sc.box_supports(basis))
    at_rest = model.gravity_state(load, K0=0.6)
    np.testing.assert_allclose(
        at_rest["initial"].states["clay"].stress[0],
        0.6 * at_rest["initial"].states["clay"].stress[1],
        rtol=1e-6,
        atol=1e-6,
    )
    free = model.gravity_state(load)
    assert free["initial"].residual < 1e-8
    loaded = model.run([sc.Stage("fill", load + push, increments=4)], start=at_rest, **QUIET)
    assert max(loaded["fill"].iterations) <= 5
    loaded.save(tmp_path / "clay")
    again = sc.load_result(tmp_path / "clay", model)
    back, resumed = (
        model.run([sc.Stage("off", load)], start=start, **QUIET)["off"] for start in (loaded, again)
    )
    np.testing.assert_array_equal(back.x, resumed.x)
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=5.0, phi=30.0)
    other = sc.Model({"clay": sc.SolidForm(basis, soil)}, sc.box_supports(basis))
    start = other.k0_state(load, unit_weights=20.0, K0=0.6)
    stage = other.run(
        [sc.Stage("change", load, change={"clay": model.forms["clay"]})], start=start, **QUIET
    )["change"]
    assert np.abs(stage.x).max() < 1e-9 and stage.iterations[-1] <= 1
    pressure = stage.forms["clay"].variable("preconsolidation pressure", stage.states["clay"])
    np.testing.assert_allclose(
        pressure, law.initial_internal(stage.states["clay"].stress)[1], rtol=1e-8
    )


@pytest.mark.parametrize(
    ("choice", "told"), [({}, True), ({"exclude": "clay"}, False), ({"reduce": "sand"}, False)]
)
def test_strength_that_is_not_reduced(choice: dict, told: bool):
    """A factor of safety beside Cam Clay is that of the other ground alone, which is told where it
    was not chosen.
    """
    mesh = grid("P2", np.linspace(0, 2, 5), np.linspace(0, 2, 5))
    mesh = mesh.with_subdomains({"clay": lambda x: x[1] < 1, "sand": lambda x: x[1] > 1})
    basis = vector_basis(mesh, "P2", intorder=2)
    sand = sc.MohrCoulomb(E=1e4, nu=0.3, c=8.0, phi=30.0, psi=30.0)
    soils = {"clay": sc.CamClay(KAPPA, LAMBDA, M, NU, P, attraction=P), "sand": sand}
    fixed = [basis.get_dofs("bottom").all(), basis.get_dofs("left").all("u^1")]
    model = sc.Model({"ground": sc.SolidForm(basis, soils, unit_weight=18.0)}, fixed)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model.strength_reduction(tolerance=0.2, progress=False, **choice)
    assert (
        any("ground.clay, CamClay: this law keeps its strength" in str(w.message) for w in caught)
        == told
    )


@pytest.mark.parametrize("conservative", [False, True])
def test_search_within_bounds_finds_the_roots_of_newton(conservative, monkeypatch, rng):
    """[N] The same stresses if Newton's method is taken to fail at all points, wet and dry of the
    critical state.
    """
    n = 200
    law = clay(rng.uniform(1.0, 8.0, n), conservative=conservative)
    start = -P * np.array([[1.0], [1.0], [1.0], [0.0]]) * np.ones(n)
    strain = 0.03 * rng.standard_normal((4, n))
    strain[:3] -= 0.9 * strain[:3].mean(axis=0)
    internal = law.initial_internal(start)
    found = law.update(strain, start, internal)
    newton = cam_clay_return.joint_root

    def failing(*arguments):
        y, z, _ = newton(*arguments)
        return np.zeros_like(y), np.zeros_like(z), np.arange(y.size)

    monkeypatch.setattr(cam_clay_return, "joint_root", failing)
    again = law.update(strain, start, internal)
    np.testing.assert_allclose(again.stress, found.stress, rtol=1e-8, atol=1e-6 * P)


def test_points_that_yield_by_shear_or_by_volume() -> None:
    """Flow changes the plastic strain, the preconsolidation pressure, or both of them; points where
    neither has changed are elastic.
    """
    law = sc.CamClay(KAPPA, LAMBDA, M, NU, P, OCR=2.0)
    before = law.initial_internal(np.tile(-np.array([[P], [P], [P], [0.0]]), 4))
    after = before.copy()
    after[0] += [0.0, 1e-3, 0.0, 1e-3]
    after[1] *= [1.0, 1.0, 1.1, 1.1]
    assert law.yielding(before, after).tolist() == [False, True, True, True]
