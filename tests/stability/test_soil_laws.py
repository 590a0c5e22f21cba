"""Cam Clay, Soft Soil Creep and Hardening Soil under bad conditions: histories, pressures,
surfaces, cycles, units.
"""

from __future__ import annotations

import numpy as np
import pytest

import skfem_contact as sc
from skfem_contact.laboratory import PathStep, isotropic, oedometer, simple_shear, triaxial
from tests.tools.helpers import grid, vector_basis

M, PHI, EXTENSION = 1.2, 30.0, 0.75
QUIET = {"progress": False}
PRESSURES = 10.0 ** np.arange(5)


def clay(unit: float = 1.0, **changes):
    """Modified Cam Clay, with `unit` for one kPa."""
    return sc.CamClay(
        **{"kappa": 0.02, "lambda_": 0.1, "M": M, "nu": 0.25, "p_ref": 100.0 * unit} | changes
    )


def sand(unit: float = 1.0, **changes):
    """Hardening Soil."""
    moduli = {"E50_ref": 2e4, "Eoed_ref": 2e4, "Eur_ref": 6e4, "p_ref": 100.0, "c": 0.0}
    return sc.HardeningSoil(
        **{name: unit * value for name, value in moduli.items()} | {"m": 0.5, "phi": PHI} | changes
    )


def stiff(unit: float = 1.0, **changes):
    """Hardening Soil with small-strain stiffness."""
    return sand(unit, G0_ref=8e4 * unit, gamma_07=2e-4, **changes)


def creeping(**changes):
    """Soft Soil Creep, which has a day for every step that gives no other duration."""
    return sc.SoftSoilCreep(
        **{
            "kappa": 0.02,
            "lambda_": 0.1,
            "M": M,
            "nu": 0.25,
            "p_ref": 100.0,
            "mu": 0.004,
            "tau": 1.0,
        }
        | changes
    )


# -- histories and pressures


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sense", "drained", "most"),
    [
        (-1, True, 50.0),
        (-1, False, 50.0),
        (1, True, 1.5),
        (1, False, 50.0),
    ],
)
def test_clay_of_any_history_at_any_pressure(sense, drained, most):
    """[X] Stresses are in proportion to the pressure from 1 to 1e4, and end at the critical state.

    Drained extension of clay with a larger OCR ends in tension of its axis: no soil does that.
    """
    ocr, p0 = (a.ravel() for a in np.meshgrid([1.0, 1.5, 10.0, 50.0], PRESSURES))
    p0, law = p0[ocr <= most], clay(OCR=ocr[ocr <= most], extension=EXTENSION)
    test = sc.element_test(law, -p0, triaxial(0.5 * sense, drained=drained, increments=50))
    q = (test.q / p0).reshape(51, 5, -1)
    np.testing.assert_allclose(
        q, q[:, [0] * 5], rtol=1e-6, atol=1e-8
    )  # Newton's tolerance, 50 times
    ratio = M if sense < 0 else M * EXTENSION
    np.testing.assert_allclose(
        test.q[-1] / test.p[-1], ratio, rtol=0.06
    )  # the strain decides how near it comes


@pytest.mark.parametrize(
    ("law", "sense", "ocr"), [(sand, -1, 1.0), (stiff, -1, 50.0), (sand, 1, 3.0)]
)
def test_sand_of_any_history_at_any_pressure(law, sense, ocr):
    """[X] Compression and extension end at the strength of Mohr and Coulomb from 1 to 1e4."""
    test = sc.element_test(
        law(OCR=ocr), -PRESSURES, triaxial(sense * 0.015 * PRESSURES**0.5, increments=5)
    )
    ratio = 3.0 if sense < 0 else 1 / 3  # (1 + sin phi) / (1 - sin phi)
    np.testing.assert_allclose(-test.stress[-1, 1] / PRESSURES, ratio, rtol=1e-6)


@pytest.mark.parametrize(
    "law", [sand(c=1.0), stiff(c=1.0), clay(attraction=2.0), creeping(attraction=2.0)]
)
def test_unloading_to_nothing_and_loading_again(law):
    """[X] A sample that lost its pressure takes it again: its volume comes back within what the
    surface has moved.
    """
    held = isotropic(-100.0, increments=5)
    test = sc.element_test(
        law, -100.0, [isotropic(0.0, increments=5), held, isotropic(0.0, increments=5), held]
    )
    assert np.abs(test.stress[[5, 15], :3]).max() < 1e-7  # Newton's tolerance of the stress before
    np.testing.assert_allclose(test.volume[[10, 20]], 0.0, atol=2e-4 * test.volume.max())
    assert test.volume[5, 0] > 0


# -- cycles


@pytest.mark.parametrize(
    ("law", "tolerance"),
    [
        (sand(c=1.0), 1e-8),
        (stiff(c=1.0), 1e-8),
        (clay(attraction=2.0, OCR=50.0), 1e-8),
    ],
)
def test_reversed_cycles_do_not_drift(law, tolerance):
    """[X] Shear to and fro 200 times between the same strains: the last cycles are the third
    one.
    """
    stress = -100.0 * np.array([0.5, 1.0, 0.5, 0.0])[:, None, None]
    internal, ends = law.initial_internal(stress), []
    for _ in range(200):
        for sign in (1.0, -1.0):
            strain = sign * 4e-4 * np.array([0.0, 0.0, 0.0, 1.0])[:, None, None]
            new = law.update(strain, stress, internal)
            stress, internal = new.stress, new.internal
        ends.append(stress)
    assert np.abs(ends[-1] - ends[2]).max() < tolerance * 100.0


def test_creep_does_not_care_how_often_a_stress_is_held():
    """[X] A stress that is held 50 times for 4 days is one that is held for 200 days."""

    def held(days, increments):
        return PathStep(
            stress=dict.fromkeys(("xx", "yy", "zz")),
            strain={"xy": 0.0},
            increments=increments,
            duration=days,
        )

    once, often = (sc.element_test(creeping(), -100.0, held(200.0, n)).volume[-1] for n in (1, 50))
    np.testing.assert_allclose(often, once, rtol=1e-7)


# -- bodies


def footing(soil, length: float = 1.0, force: float = 1.0, n: int = 3):
    """Model of ground with a free surface, and the load of a strip on it."""
    mesh = grid("Q2", length * np.linspace(0, 4, n + 2), length * np.linspace(0, 3, n + 1))
    mesh = mesh.with_boundaries(
        {"strip": lambda x: (x[1] > 2.999 * length) & (x[0] < 1.61 * length)}
    )
    basis = vector_basis(mesh, "Q2", intorder=4)
    ground = sc.SolidForm(basis, soil, unit_weight=20.0 * force / length**3)
    model = sc.Model({"ground": ground}, sc.box_supports(basis))
    return model, sc.traction(basis, "strip", (0.0, -30.0 * force / length**2))


def loaded(soil, length: float = 1.0, force: float = 1.0):
    """Displacements over the length, and iterations: the strip is loaded, unloaded and loaded
    again.
    """
    model, load = footing(soil, length, force)
    steps = {"load": load, "off": None, "again": load}
    stages = [sc.Stage(name, force, increments=3) for name, force in steps.items()]
    result = model.run(stages, start=model.k0_state(K0=0.6), **QUIET)
    return [stage.x / length for stage in result.stages[1:]], [
        stage.iterations for stage in result.stages[1:]
    ]


@pytest.mark.filterwarnings("ignore:.*(rotate by up to|are taken for small)")
@pytest.mark.filterwarnings("ignore:.*compressed by less than")
@pytest.mark.parametrize(
    "soil", [sand(), stiff(), clay(), sand(c=2.0, OCR=50.0), clay(attraction=5.0, OCR=50.0)]
)
@pytest.mark.one_in(3)
def test_free_surface_that_is_loaded_unloaded_and_loaded(soil):
    """A free surface without cohesion: no increment is cut, and loading again ends where loading
    did.
    """
    (load, off, again), iterations = loaded(soil)
    assert [len(counts) for counts in iterations] == [3, 3, 3] and max(map(max, iterations)) <= 8
    size = np.abs(load).max()
    assert np.abs(off).max() < size and np.abs(again - load).max() < 0.02 * size


@pytest.mark.filterwarnings("ignore:.*(rotate by up to|are taken for small)")
@pytest.mark.parametrize(("length", "force"), [(1e3, 1e3), (1.0, 1e-3)], ids=["N, mm", "MN, m"])
@pytest.mark.parametrize(
    "law", [lambda unit: sand(unit, c=5.0 * unit), lambda unit: clay(unit, attraction=5.0 * unit)]
)
@pytest.mark.one_in(2)
def test_units(law, length, force):
    """[X] Displacements over the length and iterations are those in kN and m."""
    (known, counts), (found, others) = (
        loaded(law(1.0)),
        loaded(law(force / length**2), length, force),
    )
    assert counts == others
    for a, b in zip(known, found, strict=True):
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-9 * np.abs(known[0]).max())


# -- what is told


def test_free_surface_without_cohesion_is_told():
    """Sand at a thin free surface: the floor of its stiffness is told with the figure; an
    attraction ends that.
    """
    basis = vector_basis(grid("Q2", [0.0, 1.0], [0.0, 0.99, 1.0]), "Q2")

    def start(soil):
        ground = sc.SolidForm(basis, soil, unit_weight=20.0)
        return sc.Model({"ground": ground}, sc.box_supports(basis)).k0_state(K0=0.5)

    with pytest.warns(
        sc.AnalysisWarning,
        match=r"points of HardeningSoil are compressed by less than 0.1,.* cohesion",
    ):
        start(sand())
    start(sand(c=0.2))


def test_initial_stress_is_refused_with_its_place_and_figure():
    """Stresses in tension or outside the yield surface: the message names the point, its
    coordinates and its region.
    """

    def torn(x):
        return np.stack([-10.0 + 0 * x[0], 20.0 * (x[1] - 1.0), -10.0 + 0 * x[0], 0 * x[0]])

    for soil, message in (
        (sand(), r"in tension at .* principal stresses 37\.\d+ and -10 "),
        (clay(), r"attraction is -5\.\d+ at point "),
    ):
        model, _ = footing(soil)
        with pytest.raises(ValueError, match=message + r".* lies at \(\d\.\d+, 2\.\d+\) in 'all'"):
            model.initial_state(stress=torn)
    model, _ = footing(sand())
    with pytest.raises(
        ValueError, match=r"outside the failure surface by .* change K0.* lies at \(.*\) in 'all'"
    ):
        model.k0_state(K0=0.2)
    with pytest.raises(
        ValueError,
        match=r"does not admit the initial stress of sample 1.* outside the yield surface",
    ):
        sc.element_test(
            sc.MohrCoulomb(1e4, 0.3, 0.0, PHI),
            np.array([[-50.0, -10], [-100, -100], [-50, -10], [0, 0]]),
            simple_shear(0.01),
        )


@pytest.mark.slow
def test_extension_beyond_the_pressure_is_told():
    """A pull on soil without cohesion stops, with the increments before; none of its stresses is in
    tension.
    """
    for law in (sand(), clay()):
        with pytest.raises(sc.NotConverged, match="stops after") as caught:
            sc.element_test(law, -100.0, oedometer(stress=10.0, increments=6))
        assert (
            len(caught.value.result.stress) > 4 and caught.value.result.stress[:, :3].max() <= 1e-9
        )
