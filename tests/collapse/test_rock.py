"""Hoek-Brown rock in strength reductions and in bounds."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from skfem_contact.limit_analysis.strength import Strength
from tests.tools.slope_meshes import held, reduced_slope, slope_mesh

#: Slope of R. E. Hammah, T. E. Yacoub, B. Corkum, J. H. Curran, 40th U.S. Symposium on Rock
#: Mechanics (2005) 05-810.
SLOPE = sc.HoekBrown(E=5e6, nu=0.3, sigma_ci=30e3, m_b=0.067, s=2.5e-5, a=0.619)


def rock(**changes) -> sc.HoekBrown:
    return sc.HoekBrown(
        **({"E": 5.7e6, "nu": 0.25, "sigma_ci": 30e3, "m_b": 1.7, "s": 0.0039, "a": 0.51} | changes)
    )


def planes(law: sc.HoekBrown, n: int = 400_001) -> tuple[np.ndarray, np.ndarray]:
    """Cohesion and tan(phi) of tangents, by differences of the strength in principal stresses."""
    t = np.geomspace(1e-9, 10.0, n)
    slope = law.a * law.m_b * t ** (law.a - 1)
    s3, diameter = (t - law.s) * law.sigma_ci / law.m_b, law.sigma_ci * t**law.a
    sine = slope / (2 + slope)
    tan = sine / np.sqrt(1 - sine**2)
    return 0.5 * diameter * np.sqrt(1 - sine**2) - (s3 + 0.5 * diameter * (1 - sine)) * tan, tan


def least(c, tan, s3: float) -> float:
    """Largest compression beside s3 that all planes admit."""
    phi = np.arctan(tan)
    return float(
        (s3 * (1 + np.sin(phi)) / (1 - np.sin(phi)) + 2 * c * np.cos(phi) / (1 - np.sin(phi))).min()
    )


@pytest.mark.parametrize("factor", [0.7, 1.5, 3.0])
def test_reduced_strength(factor: float) -> None:
    """[N] Triaxial strength: the least of 400,000 tangents with c and tan(phi) divided, 1e-9 from
    their envelope.
    """
    law = rock().reduced(factor)
    test = sc.element_test(law, -1e3, sc.laboratory.triaxial(-0.02, increments=10))
    c, tan = planes(rock())
    assert test.q[-1, 0] + 1e3 == pytest.approx(least(c / factor, tan / factor, 1e3), rel=1e-8)
    measure, limit = law.mobilised(test.stress[-1][:, :, None], test.internal[-1][:, :, None])
    np.testing.assert_allclose(measure, limit, rtol=1e-9)


@pytest.mark.parametrize("psi", [0.0, 8.0, 45.0])
@pytest.mark.parametrize(
    ("factor", "flow"), [(0.7, "given"), (1.5, "given"), (1.5, "associated"), (3.0, "given")]
)
@pytest.mark.one_in(3)
def test_tangent_and_admissibility(factor: float, flow: str, psi: float) -> None:
    """[N] Differences and a zero increment; constant, capped and associated dilatancy."""
    law = rock(psi=psi).reduced(factor, flow)
    assert (
        sc.testing.check_material(law, initial_stress=-500.0, strain=1e-3) < 1e-7
    )  # of the differences
    assert law.reduced(1.0 / factor).factor == pytest.approx(1.0)


def test_slope() -> None:
    """[P] 1.15 of Hammah et al. (limit equilibrium 1.152): 2.6 % above it with associated flow and
    370 triangles.
    """
    found = reduced_slope(
        slope_mesh(10.0, 15.0, 10.0, 15.0, 4), SLOPE, 25.0, flow="associated", certify=False
    )
    assert found.stop.kind == "plateau"
    assert found.factor == pytest.approx(1.15, rel=0.03)


@pytest.mark.slow
def test_bounds_of_the_slope() -> None:
    """[P] The factor of Hammah et al. and that of the elements lie between the bounds."""
    basis = Basis(slope_mesh(10.0, 12.0, 6.0, 8.0, 1), ElementVector(ElementTriP2()), intorder=2)
    model = sc.Model({"rock": sc.SolidForm(basis, SLOPE, unit_weight=25.0)}, held(basis))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        found = model.bounds(elements=150, flow="associated", progress=False)
    assert 0.95 < found.lower < 1.15 < 1.17 < found.upper < 1.35


def bearing_capacity(law: sc.HoekBrown) -> float:
    """Strip without weight: the fan between two wedges turns by 90 degrees, int cos(phi) / (2 R) dp
    = pi / 2.
    """

    def circle(t: float) -> tuple[float, float, float]:
        slope, radius = law.a * law.m_b * t ** (law.a - 1), 0.5 * law.sigma_ci * t**law.a
        return (t - law.s) * law.sigma_ci / law.m_b + radius, radius, slope / (2 + slope)

    def turned(t: float) -> float:
        def rate(u: float) -> float:
            _, radius, sine = circle(u)
            growth = law.sigma_ci / law.m_b + 0.5 * law.sigma_ci * law.a * u ** (law.a - 1)
            return np.sqrt(1 - sine**2) / (2 * radius) * growth

        return quad(rate, law.s, t)[0]

    end = brentq(lambda t: turned(t) - np.pi / 2, law.s, 1e4 * law.s)
    centre, radius, _ = circle(end)
    return centre + radius


@pytest.mark.slow
@pytest.mark.exhaustive
def test_footing() -> None:
    """[X] Prandtl's fan with a curved strength lies between the bounds; Merifield, Lyamin, Sloan
    (2006) call it N.
    """
    x = np.array([-3.0, -2.0, -1.0, -0.5, 0.0])
    x = np.concatenate((x, -x[-2::-1]))
    mesh = MeshTri.init_tensor(x, np.array([-2.5, -1.5, -0.75, -0.3, 0.0])).with_boundaries(
        {
            "footing": lambda p: (p[1] > -1e-9) & (np.abs(p[0]) < 0.5),
            "base": lambda p: p[1] < -2.4,
            "sides": lambda p: np.abs(p[0]) > 2.9,
        }
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    law = sc.HoekBrown.from_gsi(E=1e6, nu=0.25, sigma_ci=1.0, m_i=10.0, gsi=60.0)
    fixed = np.concatenate((basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1")))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)
        found = sc.Model({"rock": sc.SolidForm(basis, law)}, fixed).bounds(
            tractions={"footing": (0.0, -1.0)},
            live="footing",
            elements=300,
            flow="associated",
            progress=False,
        )
    exact = bearing_capacity(law)
    assert 0.5 * exact < found.lower < exact < found.upper < 1.15 * exact  # 300 triangles


@pytest.mark.parametrize("side", [0.0, 0.05])
def test_confined_column(side: float) -> None:
    """[X] The strength itself lies between bounds with chords and with tangents, which are 1.5 and
    .9 % away.
    """
    law = sc.HoekBrown.from_gsi(E=1e6, nu=0.25, sigma_ci=1.0, m_i=10.0, gsi=60.0)
    basis = Basis(MeshTri().refined(1).with_defaults(), ElementVector(ElementTriP2()), intorder=2)
    fixed = [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("left").all("u^1")]
    found = sc.Model({"rock": sc.SolidForm(basis, law)}, fixed).bounds(
        tractions={"top": (0.0, -1.0), "right": (-side, 0.0)},
        live="top",
        elements=60,
        flow="associated",
        progress=False,
    )
    exact = side + law.sigma_ci * (law.m_b * side / law.sigma_ci + law.s) ** law.a
    assert 0.98 * exact < found.lower < exact < found.upper < 1.015 * exact


def points(lines: np.ndarray, most: np.ndarray, n: int) -> Strength:
    """Strength of n points with lines."""
    rest = np.repeat(lines[1:, :, 0][None], n, axis=0)
    c, t = (np.full(n, value) for value in lines[0, :, 0])
    return Strength(
        c, t, np.full(n, np.inf), np.ones(n, bool), lines=rest, most=np.full(n, most[0])
    )


@pytest.mark.parametrize("law", [rock(), SLOPE, rock(s=1.0, m_b=10.0, a=0.5), rock(s=0.0)])
def test_chords_are_inside_and_tangents_outside(law: sc.HoekBrown) -> None:
    """[X] What chords admit at a factor the reduced rock admits; what tangents just admit it does
    not.
    """
    rng, n = np.random.default_rng(2), 400
    centre = -np.geomspace(1e-4, 3.0, n) * law.sigma_ci
    radius = -centre * rng.uniform(0, 1, n)
    stress = np.stack((centre + radius, centre - radius, 0 * centre), axis=1)
    below, above = (
        points(*law.lines(0.1 * law.sigma_ci, inner), n).factor(stress, 0.0)
        for inner in (True, False)
    )
    assert (below <= above * (1 + 1e-12)).all()
    for i in np.flatnonzero(below > 0.05)[::10]:
        for factor, inside in ((below[i], True), (above[i], False)):
            full = np.array([centre[i] + radius[i], centre[i] - radius[i], centre[i], 0.0])[
                :, None, None
            ]
            measure, limit = law.reduced(factor).mobilised(full, np.zeros((1, 1, 1)))
            assert ((measure - limit) * (1 if inside else -1)).item() <= 1e-9 * radius[i]
    near = (below > 0.1) & (-centre > 2e-3 * law.sigma_ci) & (-centre < 0.05 * law.sigma_ci)
    assert (above[near] / below[near] - 1).max() < 0.035  # .014 to .033 with 12 lines


def test_dissipation_is_that_of_the_tangents() -> None:
    """[N] The largest power of stresses that all tangents admit, by a scan of the mean stress."""
    law, F, n = rock(), 1.3, 60
    lines, most = law.lines(5e3, False)
    soil = points(lines, most, n)
    shear = np.ones(n)
    volume = np.linspace(lines[-1, 1, 0] / np.hypot(F, lines[-1, 1, 0]) + 1e-3, 0.9, n)
    strain = np.stack((0.5 * (volume + shear), 0.5 * (volume - shear), 0 * volume), axis=1)
    p = np.linspace(-3e5, 2e3, 800_001)
    r = np.min([(c - t * p) / np.hypot(F, t) for c, t in lines[:, :, 0]], axis=0)
    scanned = [(p * v + r)[r >= 0].max() for v in volume]
    np.testing.assert_allclose(soil.dissipation(strain, F), scanned, rtol=1e-3)  # steps of the scan
    assert (soil.flow_factor(strain, np.zeros(n), 1.0) <= F).all()
