"""Hardening Soil: closed forms of its tests, random increments, failure and bad input."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from skfem import Basis, ElementQuad2, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.errors import IncrementTooLarge
from skfem_contact.laboratory import oedometer, triaxial
from skfem_contact.materials import hardening_return
from skfem_contact.materials.hardening_stiffness import Points, elastic_scale, likely_modes
from skfem_contact.materials.spectral import principal_stresses

#: Dense Hostun sand.
HOSTUN: dict[str, Any] = {
    "E50_ref": 37e3,
    "Eoed_ref": 29.6e3,
    "Eur_ref": 90e3,
    "m": 0.5,
    "phi": 41.0,
    "nu_ur": 0.2,
    "R_f": 0.9,
    "K0nc": 0.34,
}


def sand(c: float = 0.0, psi: float = 14.0, **changes: Any) -> sc.HardeningSoil:
    return sc.HardeningSoil(c=c, psi=psi, **(HOSTUN | changes))


def stresses(n: int, ncomp: int, seed: int = 1) -> np.ndarray:
    """Random stresses inside of the failure surface, (ncomp, n, 1)."""
    rng = np.random.default_rng(seed)
    result, vertical = np.zeros((ncomp, n, 1)), rng.uniform(5.0, 400.0, n)
    for row, share in zip(
        result, (rng.uniform(0.4, 1, n), np.ones(n), rng.uniform(0.4, 1, n)), strict=False
    ):
        row[:, 0] = -share * vertical
    return result


def test_cap_and_dilatancy_in_closed_form() -> None:
    """Figures of Hostun sand to their printed digits; they depend neither on cohesion nor on the
    units.
    """
    for law in (sand(), sand(c=7.0), sand(E50_ref=37e6, Eoed_ref=29.6e6, Eur_ref=90e6, p_ref=1e5)):
        assert law.constants.cap_slope == pytest.approx(5.32012, abs=5e-6)
        assert law.constants.cap_modulus * 37e3 / law.E50_ref == pytest.approx(54381, abs=0.5)
        assert law.constants.sin_cv == pytest.approx(0.49227, abs=5e-6)


@pytest.mark.parametrize("increments", [4, 20])
def test_hyperbola_is_exact_where_cap_and_dilatancy_rest(increments: int) -> None:
    test = sc.element_test(sand(psi=0.0, OCR=20.0), -300.0, triaxial(-0.04, increments=increments))
    failure = 300 * 2 * np.sin(np.radians(41)) / (1 - np.sin(np.radians(41)))
    strain, initial = -test.axial[:, 0], 2 * 37e3 / 1.1 * 3**0.5
    exact = np.minimum(strain / (1 / initial + strain * 0.9 / failure), failure)
    assert np.abs(test.q[:, 0] - exact).max() < 1e-9 * failure  # Newton's tolerance


@pytest.mark.parametrize(
    ("share", "changes", "softer"),
    [
        (0.5, {}, 0.104),
        (0.8, {}, 0.002),  # Rowe's rule dilates from half of the failure load on
        (0.5, {"Eoed_ref": 20e3, "K0nc": None}, 0.273),
    ],
)
def test_cap_of_normally_consolidated_samples_is_softer_than_E50(
    share: float, changes: dict[str, Any], softer: float
) -> None:
    """[X] The axial strain is the sum of three parts, of which the hyperbola lacks the cap.

    The cell pressure c3 and so the stiffness are constant. With f = q^2 / M^2 + p^2 = p_p^2,

        elastic  q / E_ur
        shear    integral of (1 - sin(psi_m)) / 2 d gamma
        cap      integral of (1 / 3 + q / (M^2 p)) d eps_v, d eps_v = d p_p / (H p_p^m)

    where the flow normal to the cap has d eps_1 / d eps_v = (2 p / 3 + 2 q / M^2) / (2 p).
    """
    law = sand(**changes)
    k = law.constants
    least = 100.0
    failure = k.failure * least
    load = share * failure
    rate = k.cap_modulus / k.reference**k.m

    def gamma_by_q(q: float) -> float:
        return 2 / (k.initial * (1 - q / (k.asymptote * least)) ** 2) - 2 / k.unloading

    def strain_by_q(q: float) -> float:
        mobilised = q / (2 * least + q)
        rowe = (mobilised - k.sin_cv) / (1 - mobilised * k.sin_cv)
        sine = min(max(rowe, 0.0), k.sin_psi)
        p = least + q / 3
        cap = np.sqrt(q * q / k.cap_slope + p * p)
        volume_by_q = (q / k.cap_slope + p / 3) / cap / (rate * cap**k.m)
        pressed = (1 / 3 + q / (k.cap_slope * p)) * volume_by_q
        return 1 / k.unloading + (1 - sine) / 2 * gamma_by_q(q) + pressed

    exact = quad(strain_by_q, 0.0, load, epsrel=1e-10)[0]
    strains = []
    for increments in (10, 20):
        path = triaxial(stress=-(least + load), increments=increments)
        strains.append(-sc.element_test(law, -least, path).axial[-1, 0])
    extrapolated = 2 * strains[1] - strains[0]  # the error of increments is of first order
    assert extrapolated == pytest.approx(exact, rel=5e-4)
    hyperbola = load / (k.initial * (1 - load / (k.asymptote * least)))
    assert 1 - hyperbola / extrapolated == pytest.approx(softer, abs=1e-3)  # figures of the page


@pytest.mark.parametrize(
    ("m", "tolerance"), [(0.5, 1e-9), pytest.param(0.8, 3e-4, marks=pytest.mark.slow)]
)
def test_oedometer_meets_its_modulus_and_K0(m: float, tolerance: float) -> None:
    """[X] The power law of the oedometer: to Newton's tolerance with m = 0.5, else of second
    order.
    """
    start, errors = -np.array([[6.8], [20.0], [6.8], [0.0]]), []
    for increments in (5, 20) if m == 0.5 else (20, 80):
        test = sc.element_test(sand(m=m), start, oedometer(-200.0, increments=increments))
        exact = (200 ** (1 - m) - 20 ** (1 - m)) / (1 - m) * 100**m / 29.6e3
        errors.append(abs(-test.axial[-1, 0] / exact - 1))
        assert test.stress[-1, 0, 0] / test.stress[-1, 1, 0] == pytest.approx(0.34, rel=1e-3)
    assert errors[1] < tolerance  # 3.0e-4 at 80 increments with m = 0.8
    assert m == 0.5 or errors[1] < errors[0] / 3.6


def increments(size: float, shape: tuple[int, ...]) -> np.ndarray:
    return size * np.random.default_rng(2).standard_normal(shape)


@pytest.mark.parametrize(
    ("size", "ncomp", "c", "n", "smooth"),
    [
        (1e-6, 4, 0.0, 5_000, 1.0),
        (1e-5, 4, 5.0, 5_000, 1.0),
        (1e-4, 4, 0.0, 1_000, 0.95),
        (1e-4, 6, 5.0, 100, 0.9),
        (1e-3, 4, 0.0, 200, 0.95),
        (1e-2, 4, 5.0, 60, 0.95),
        (1e-2, 6, 0.0, 12, 0.9),
    ],
)
def test_random_increments(size: float, ncomp: int, c: float, n: int, smooth: float) -> None:
    """[N] The answer is admissible, dissipates, and has its tangent at every point; none is
    refused.
    """
    law, stress, strain = sand(c), stresses(n, ncomp), increments(size, (ncomp, n, 1))
    internal = law.initial_internal(stress)
    new = law.update(strain, stress, internal)
    again = law.update(np.zeros_like(strain), new.stress, new.internal)
    shift = c / np.tan(np.radians(41))
    mean = np.maximum(
        shift - new.stress[:3].mean(axis=0), 1e-3
    )  # the floor of the stiffness is at 0.1
    assert (np.abs(again.stress - new.stress) / mean).max() <= 1e-8
    assert (new.internal >= internal).all()

    ends = law.elasticity(ncomp, stress, internal), law.elasticity(ncomp, new.stress, new.internal)
    elastic = (ends[0] + ends[1])[:, 0] / 2
    relaxed = np.linalg.solve(elastic, (new.stress - stress)[:, :, 0].T[:, :, None])[:, :, 0].T
    work = (new.stress[:, :, 0] * (strain[:, :, 0] - relaxed)).sum(axis=0)
    assert (work >= -1e-10 * np.abs(new.stress).max() * np.abs(strain).max()).all()

    tangent, h, largest = new.tangent(), 1e-5 * size, elastic.max(axis=(1, 2))
    steps = np.concatenate((h * np.eye(ncomp), -h * np.eye(ncomp)))[
        :, :, None, None
    ]  # all of them in one update
    ends = law.update(
        np.concatenate(strain + steps, axis=1),
        *(np.tile(given, (1, len(steps), 1)) for given in (stress, internal)),
    ).stress
    change = (
        ends.reshape(ncomp, 2, ncomp, n).transpose(1, 3, 0, 2) - new.stress[:, :, 0].T[:, :, None]
    )
    ahead, behind = change[0] / h, -change[1] / h
    error = np.abs(tangent - (ahead + behind) / 2).max(axis=(1, 2)) / largest
    kink = np.abs(ahead - behind).max(axis=(1, 2)) / largest
    away = kink < 1e-3  # the step crosses no kink, nor bends by more
    assert away.mean() >= smooth
    assert error[away].max() < 1e-6


@pytest.mark.parametrize("scale", [1.0, 1e3])
def test_units(scale: float) -> None:
    law = sand(
        2.0 * scale,
        E50_ref=37e3 * scale,
        Eoed_ref=29.6e3 * scale,
        Eur_ref=90e3 * scale,
        p_ref=100 * scale,
    )
    one, stress = sand(2.0), stresses(500, 4)
    strain = increments(1e-4, stress.shape)
    expected = one.update(strain, stress, one.initial_internal(stress)).stress
    found = law.update(strain, scale * stress, law.initial_internal(scale * stress)).stress
    assert (
        np.abs(found / scale - expected).max() < 1e-9 * np.abs(expected).max()
    )  # Newton's last step


@pytest.mark.parametrize("m", [0.0, 0.5, 1.0])
@pytest.mark.one_in(3)
def test_reversed_cycles_do_not_drift(m: float) -> None:
    """After the first cycle 100 more between the same strains, in three increments each, are
    elastic.

    One point is sheared, the other is compressed.
    """
    law = sand(m=m, K0nc=None)
    stress = np.repeat(np.array([-60.0, -100.0, -60.0, 0.0])[:, None, None], 2, axis=1)
    internal = law.initial_internal(stress)
    step, ends = np.zeros((4, 2, 1)), []
    step[3, 0], step[1, 1] = 2e-4 / 3, -1e-4 / 3
    for _ in range(101):
        for sign in (1, 1, 1, -1, -1, -1):
            new = law.update(sign * step, stress, internal)
            stress, internal = new.stress, new.internal
        ends.append((stress.copy(), internal.copy()))
    assert (
        np.abs(ends[-1][0] - ends[1][0]).max() < 1e-10 * 100
    )  # 1.3e-9 measured: round-off of 1,200 updates, twice as many as here
    np.testing.assert_allclose(ends[-1][1][1:], ends[1][1][1:], rtol=1e-10)


@pytest.mark.parametrize("ocr", [1.0, 5.0, 50.0])
@pytest.mark.one_in(3)
def test_triaxial_test_ends_on_the_failure_surface(ocr: float) -> None:
    p0 = np.array([1.0, 100.0, 1e4])
    test = sc.element_test(sand(OCR=ocr), -p0, triaxial(-0.5 * (p0 / 100) ** 0.5, increments=25))
    np.testing.assert_allclose(test.q[-1], p0 * 3.814951, rtol=1e-6)  # 2 sin phi / (1 - sin phi)


@pytest.mark.slow
def test_extension_and_unloading_towards_zero() -> None:
    extension = sc.element_test(sand(), -100.0, triaxial(0.05, increments=40))
    assert extension.stress[-1, 1, 0] == pytest.approx(
        -100 / 4.814951, rel=1e-6
    )  # the active pressure
    unloaded = sc.element_test(
        sand(c=1.0), -np.array([[34.0], [100.0], [34.0], [0.0]]), oedometer(-0.5)
    )
    assert unloaded.stress[-1, 1, 0] == pytest.approx(-0.5, abs=1e-9)


def test_strength() -> None:
    """Strength reduction and bounds are those of Mohr-Coulomb."""
    law, mohr = sand(5.0), sc.MohrCoulomb(37e3, 0.2, c=5.0, phi=41.0, psi=14.0)
    assert law.cone() == mohr.cone() and law.cone("davis_b") == mohr.cone("davis_b")
    reduced, expected = law.reduced(1.5), mohr.reduced(1.5)
    assert isinstance(reduced, sc.MohrCoulomb) and isinstance(expected, sc.MohrCoulomb)
    assert (reduced.c, reduced.phi, reduced.psi) == (expected.c, expected.phi, expected.psi)
    stress = stresses(5, 4)
    for found, known in zip(
        law.mobilised(stress, stress), mohr.mobilised(stress, stress), strict=True
    ):
        assert np.array_equal(found, known)
    internal = law.initial_internal(stress)
    new = law.update(np.array([0, -1e-3, 0, 0])[:, None, None] + 0 * stress, stress, internal)
    assert law.yielding(internal, new.internal).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"m": 1.5}, "m must lie in 0..1, got 1.5"),
        ({"OCR": 0.5}, "OCR must be at least 1"),
        ({"psi": 50.0}, "psi must lie between 0 and phi"),
        ({"Eur_ref": 5e4}, "exceed the initial modulus 67272"),
        ({"Eoed_ref": 9e4}, "cannot both be met"),
        ({"K0nc": 0.1}, "beyond failure, which begins at 0.2077"),
        ({"E50_ref": [1e4, 2e4]}, "E50_ref must be a finite number"),
        ({"R_f": 1.0}, "R_f must lie between"),
    ],
)
def test_bad_parameters(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sand(**changes)


def test_moduli_in_gigapascal() -> None:
    """[X] Small numbers are moduli as well: the same law as in kPa, with 1e-6 of its moduli."""
    small = {name: 1e-6 * value for name, value in HOSTUN.items() if name.endswith("_ref")}
    law = sc.HardeningSoil(**(HOSTUN | small), c=5e-6, psi=14.0)
    assert law.Eur_ref == 1e-6 * HOSTUN["Eur_ref"]


def test_bad_initial_stress() -> None:
    inside = stresses(6, 4)
    outside, torn = inside.copy(), inside.copy()
    outside[:, 4, 0], torn[:, 3, 0] = (-10.0, -100.0, -30.0, 0.0), (1.0, -1.0, 0.0, 0.0)
    with pytest.raises(ValueError, match=r"outside the failure surface by 51.8.* most at point 4"):
        sand().initial_internal(outside)
    with pytest.raises(ValueError, match="in tension at 1 of 6 points, most at point 3"):
        sand().initial_internal(torn)
    with pytest.warns(sc.AnalysisWarning, match=r"less than 0.1,.* give a small cohesion"):
        sand().initial_internal(1e-4 * inside)


@pytest.mark.parametrize("least", [1.0, 100.0, 1e4])
def test_initial_stress_at_failure_within_round_off(least: float) -> None:
    """[X] s1 / s3 = (1 + sin(phi)) / (1 - sin(phi)), and a share of 1e-7 more, of every size."""
    sine = np.sin(np.radians(HOSTUN["phi"]))
    largest = least * (1.0 + sine) / (1.0 - sine)
    law = sand(c=0.1)
    shift = 0.1 / np.tan(np.radians(HOSTUN["phi"]))
    stress = np.array([-least, -(1.0 + 1e-7) * largest, -least, 0.0])
    stress[:3] += shift
    assert law.initial_internal(stress[:, None, None]).shape[1:] == (1, 1)
    stress[1] = shift - 1.01 * largest
    with pytest.raises(ValueError, match="outside the failure surface"):
        law.initial_internal(stress[:, None, None])


def test_preconsolidation() -> None:
    """The cap goes through the largest stress of the past, on the line of normal consolidation."""
    stress = -np.array([34.0, 100.0, 34.0, 0.0])[:, None, None]
    cap = {
        name: law.initial_internal(stress)[2].item()
        for name, law in {"normal": sand(), "OCR": sand(OCR=2.0), "POP": sand(POP=100.0)}.items()
    }
    assert cap["OCR"] == pytest.approx(2 * cap["normal"], rel=1e-12)
    assert cap["POP"] == pytest.approx(cap["OCR"], rel=1e-12)


def test_preconsolidation_by_element() -> None:
    """[X] Arrays of OCR and POP: in each element the memory of the law with its two numbers."""
    stress = -np.array([34.0, 100.0, 34.0, 0.0])[:, None, None] * np.ones((1, 3, 2))
    ratio, more = np.array([1.0, 2.0, 3.0]), np.array([0.0, 100.0, 20.0])
    memory = sand(OCR=ratio, POP=more).initial_internal(stress)
    for e in range(3):
        alone = sand(OCR=ratio[e], POP=more[e]).initial_internal(stress[:, e : e + 1])
        np.testing.assert_array_equal(memory[:, e : e + 1], alone)
    with pytest.raises(ValueError, match=r"OCR must be at least 1, .* in element 1"):
        sand(OCR=[1.0, 0.9])
    with pytest.raises(ValueError, match="2 values for 3 elements"):
        sand(OCR=[1.0, 2.0]).initial_internal(stress)


def test_preconsolidation_in_extension() -> None:
    """[X] With two equal largest compressions the cap's measure of shear is delta (s1 - s3), where
    delta = (3 + sin(phi)) / (3 - sin(phi)) (Schanz, Vermeer and Bonnier 1999).
    """
    stress = -np.array([300.0, 300.0, 100.0, 0.0])[:, None, None]
    sin = np.sin(np.radians(41.0))
    q = (3 + sin) / (3 - sin) * 200.0
    exact = np.sqrt(q**2 / sand().constants.cap_slope + (700.0 / 3.0) ** 2)
    assert sand().initial_internal(stress)[2].item() == pytest.approx(exact, rel=1e-12)


def body(increments: int) -> tuple[sc.Model, Any, list[sc.Stage]]:
    """A pit beside a smooth wall."""
    mesh = MeshQuad.init_tensor(np.linspace(0, 12, 13), np.linspace(0, 8, 9)).with_defaults()
    mesh = mesh.with_subdomains(
        {"ground": lambda x: (x[1] < 5) | (x[0] > 4), "pit": lambda x: (x[1] > 5) & (x[0] < 4)}
    )
    basis = Basis(mesh, ElementVector(ElementQuad2()), intorder=4)
    wall = basis.get_dofs(lambda x: (np.abs(x[0] - 4) < 1e-9) & (x[1] > 5 - 1e-9)).all("u^1")
    soil = sc.HardeningSoil(E50_ref=2e4, Eoed_ref=2e4, Eur_ref=6e4, m=0.5, c=5.0, phi=30.0)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), soil, unit_weight=20.0)
        for name in ("ground", "pit")
    }
    model = sc.Model(forms, np.union1d(sc.box_supports(basis), wall))
    return (
        model,
        model.k0_state(K0=0.55),
        [sc.Stage("dig", deactivate="pit", increments=increments)],
    )


def test_pit_in_stages(tmp_path: Path) -> None:
    """At most 5 iterations an increment, none cut; the result comes back from a file."""
    model, start, stages = body(8)
    result = model.run(stages, start=start, progress=False)
    assert len(result["dig"].iterations) == 8 and max(result["dig"].iterations) <= 5
    heave = result["dig"].x[1::2].max()
    assert heave == pytest.approx(
        6.0266e-3, rel=0.02
    )  # of an independent one, whose stiffness is that of the start
    result.save(tmp_path / "pit.npz")
    again = sc.load_result(tmp_path / "pit.npz", model)
    assert np.array_equal(
        again["dig"].states["ground"].internal, result["dig"].states["ground"].internal
    )


def test_undrained_pit() -> None:
    """Undrained unloading heaves less, at most 5 iterations an increment."""
    model, start, stages = body(4)
    dug = model.run(stages, start=start, progress=False)["dig"]
    wet = {
        name: form.with_materials(
            {key: sc.Undrained(law, nu_undrained=0.49) for key, law in form.materials.items()}
        )
        for name, form in model.forms.items()
    }
    undrained = sc.Model(wet, model.fixed)
    after = undrained.run(stages, start=undrained.k0_state(K0=0.55), progress=False)["dig"]
    assert len(after.iterations) == 4 and max(after.iterations) <= 5
    assert (
        after.x[1::2].max() < dug.x[1::2].max() == pytest.approx(6.1154e-3, rel=2e-3)
    )  # of eight increments


def test_increments_without_an_answer_are_halved(monkeypatch: pytest.MonkeyPatch) -> None:
    """[X] Points without a result in one step have that of two halves, and the tangent of both."""
    law, stress = sand(), stresses(20, 4)
    internal, strain = law.initial_internal(stress), increments(1e-3, stress.shape)
    halves = law.update(0.5 * strain, stress, internal)
    halves = law.update(0.5 * strain, halves.stress, halves.internal)
    whole = hardening_return.hardening_return
    sizes: list[int] = []

    def refuse(t: Any, k: Any) -> Any:
        sizes.append(t.gamma.size)
        found = whole(t, k)
        return found._replace(failed=np.arange(t.gamma.size)) if len(sizes) == 1 else found

    monkeypatch.setattr("skfem_contact.materials.hardening_soil.hardening_return", refuse)
    new = law.update(strain, stress, internal)
    assert len(sizes) == 3
    np.testing.assert_allclose(new.stress[:, :, 0], halves.stress[:, :, 0], rtol=1e-12, atol=1e-9)
    step = 1e-7 * np.array([1.0, -1.0, 0.5, 0.7])[:, None, None]
    far = law.update(0.5 * (strain + step), stress, internal)
    far = law.update(0.5 * (strain + step), far.stress, far.internal)
    expected = (far.stress - halves.stress)[:, :, 0]
    found = np.einsum("nij,jn->in", new.tangent(), step[:, 0, 0][:, None] * np.ones(20))
    np.testing.assert_allclose(
        found, expected, atol=1e-3 * np.abs(expected).max()
    )  # the step bends by 1e-4


def test_increment_without_an_answer_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("skfem_contact.materials.hardening_return._ITERATIONS", 1)
    monkeypatch.setattr("skfem_contact.materials.hardening_soil._HALVINGS", 2)
    law, stress = replace(sand(), OCR=1.0), stresses(20, 4)
    with pytest.raises(IncrementTooLarge, match="have no admissible stress"):
        law.update(increments(1e-2, stress.shape), stress, law.initial_internal(stress))


def points(law: sc.HardeningSoil, stress: list[float], change: list[float]) -> Points:
    """Return a normally consolidated point with a change of its stress at the accepted
    stiffness.
    """
    k, column = law.constants, np.array(stress)[:, None]
    scale = k.scale(k.shift - principal_stresses(column)[0])
    return Points(
        column,
        np.array(change)[:, None] / scale,
        np.full(1, 1e-3),
        np.full(1, 50.0),
        scale,
        np.ones(1),
        np.ones(1),
    )


@pytest.mark.parametrize(
    "change", [[34.7049645, -32.09585327, 0.52182225, -15.9498705], [30.0, 40.0, 30.0, 0.0]]
)
def test_stiffness_of_elastic_unloading_to_the_free_surface(change: list[float]) -> None:
    """[X] It is the mean of both ends to round-off, where Newton's steps alone go to and fro across
    the least one.
    """
    law = sc.HardeningSoil(45e3, 45e3, 180e3, m=0.5, c=1.0, phi=35.0, psi=5.0, K0nc=0.4264)
    at, k = (
        points(law, [-20.99127941, -50.87700597, -22.46477771, -4.78686413], change),
        law.constants,
    )
    scale = elastic_scale(at, k)
    reached = k.scale(k.shift - at.trial(scale).values[0])
    np.testing.assert_allclose(
        scale, 0.5 * (at.scale + reached), rtol=1e-13
    )  # bisection ends at 1e-13


def test_mode_of_a_point_without_stress() -> None:
    """[X] The first guess of a return has a number everywhere, and no multiplier inside of the
    yield surface.
    """
    law = sand()
    with np.errstate(all="raise"):
        _, start = likely_modes(points(law, [0.0] * 4, [0.0] * 4), law.constants)
    assert not start[:2].any()
    assert 0.0 <= start[2] <= law.constants.sin_psi


def test_first_guess_of_a_small_isotropic_compression() -> None:
    """[X] The cap's multiplier is C = dp / (2 p (K + H)) to first order, with the bulk modulus K
    and the modulus H = d p_p / d eps_v of the cap; no shear.
    """
    law = sand()
    p, dp = 100.0, 1e-3
    k = law.constants
    at = points(law, [-p, -p, -p, 0.0], [-dp, -dp, -dp, 0.0])
    at = at._replace(cap=np.array([p]))
    _, (shear, multiplier, _, _) = likely_modes(at, k)
    bulk = k.lam + 2.0 / 3.0 * k.mu
    hardening = k.hardened(at.cap, np.zeros(1))[1] / at.scale
    assert shear == 0.0
    np.testing.assert_allclose(multiplier, dp / (2.0 * p * (bulk + hardening)), rtol=1e-4)
