"""Drucker-Prager and von Mises: Koiter's conditions, tangent, strength in plane strain."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.materials import DruckerPrager, VonMises
from tests.tools.material_points import (
    Specimen,
    assert_history,
    assert_tangent,
    random_points,
    update,
)

COMPONENTS = pytest.mark.parametrize("ncomp", [4, 6])
LAWS = {
    "associated": DruckerPrager(2e4, 0.3, k=10.0, alpha=0.2, beta=0.2),
    "dilatant": DruckerPrager(2e4, 0.3, k=10.0, alpha=0.3, beta=0.1),
    "beta = 0": DruckerPrager(2e4, 0.3, k=10.0, alpha=0.2),
    "cohesionless": DruckerPrager(2e4, 0.3, k=0.0, alpha=0.2, beta=0.05),
    "von Mises": VonMises(2e4, 0.3, strength=15.0),
}
ALL_LAWS = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def constants(law: DruckerPrager | VonMises) -> tuple[float, float, float]:
    """k, alpha and beta."""
    return (
        (law.strength / np.sqrt(3), 0.0, 0.0)
        if isinstance(law, VonMises)
        else (law.k, law.alpha, law.beta)
    )


def tensors(stress: np.ndarray, shear: float = 1.0) -> np.ndarray:
    """Tensors (n, 3, 3); ``shear`` is 2 for engineering shear strains."""
    six = np.vstack(
        (stress[:3], stress[3:] / shear, np.zeros((6 - len(stress), *stress.shape[1:])))
    )
    return np.moveaxis(six[[[0, 3, 5], [3, 1, 4], [5, 4, 2]]], -1, 0)


def excess(law: DruckerPrager | VonMises, stress: np.ndarray) -> np.ndarray:
    k, alpha, _ = constants(law)
    tensor = tensors(stress)
    trace = np.trace(tensor, axis1=1, axis2=2)
    deviator = tensor - trace[:, None, None] / 3 * np.eye(3)
    return np.sqrt(np.einsum("nij,nij->n", deviator, deviator) / 2) + alpha * trace - k


@COMPONENTS
@ALL_LAWS
def test_koiter_conditions(law: DruckerPrager | VonMises, ncomp: int) -> None:
    """[X] Plastic strain along the potential's normal, or in its cone at the apex; stress on the
    surface.
    """
    k, alpha, beta = constants(law)
    strain = random_points(20_000, ncomp, np.random.default_rng(1))
    result = update(law, strain)
    compliance = np.linalg.inv(law.elasticity(ncomp))
    # round-off of trial stresses of some 100, in strains
    tolerance = 1e-12 * 100 / law.E
    elastic = np.setdiff1d(np.arange(strain.shape[1]), result.plastic)
    assert (excess(law, result.stress) <= 1e-11).all()
    np.testing.assert_allclose(
        compliance @ result.stress[:, elastic], strain[:, elastic], atol=tolerance
    )

    stress = result.stress[:, result.plastic]
    np.testing.assert_allclose(excess(law, stress), 0, atol=1e-11)
    plastic = tensors(strain[:, result.plastic] - compliance @ stress, shear=2)
    volume = np.trace(plastic, axis1=1, axis2=2)
    shape = plastic - volume[:, None, None] / 3 * np.eye(3)
    size = np.sqrt(np.einsum("nij,nij->n", shape, shape))
    tensor = tensors(stress)
    deviator = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    radius = np.sqrt(np.einsum("nij,nij->n", deviator, deviator))
    apex = radius <= 1e-9
    assert apex.any() == (alpha > 0) and not apex.all()
    # on the cone: coaxial, ratio of volume to shape 3 beta to 1 / sqrt(2)
    aligned = deviator * (size / np.where(apex, 1, radius))[:, None, None]
    np.testing.assert_allclose(shape[~apex], aligned[~apex], atol=tolerance)
    np.testing.assert_allclose(volume[~apex], np.sqrt(18) * beta * size[~apex], atol=tolerance)
    # in the apex: more volume than that
    assert (volume[apex] >= np.sqrt(18) * beta * size[apex] - tolerance).all()
    if alpha > 0:
        np.testing.assert_allclose(
            tensor[apex], np.broadcast_to(k / alpha / 3 * np.eye(3), tensor[apex].shape), atol=1e-12
        )


@COMPONENTS
@ALL_LAWS
def test_tangent(law: DruckerPrager | VonMises, ncomp: int) -> None:
    """[X] Finite differences, equal principal stresses included."""
    assert_tangent(law, random_points(5000, ncomp, np.random.default_rng(2)))


@COMPONENTS
@ALL_LAWS
def test_random_history(law: DruckerPrager | VonMises, ncomp: int) -> None:
    """[X] Dissipation, no excess, no drift."""
    assert_history(law, lambda stress, _: excess(law, stress), ncomp)


@COMPONENTS
def test_von_mises_is_drucker_prager_without_friction(ncomp: int) -> None:
    """[X] Bit for bit, since it is the same return mapping."""
    strain = random_points(2000, ncomp, np.random.default_rng(3))
    mises, prager = (
        update(LAWS["von Mises"], strain),
        update(DruckerPrager(2e4, 0.3, k=15 / np.sqrt(3), alpha=0.0), strain),
    )
    np.testing.assert_array_equal(mises.stress, prager.stress)
    np.testing.assert_array_equal(mises.tangent(), prager.tangent())


@COMPONENTS
def test_uniaxial_tension_of_von_mises(ncomp: int) -> None:
    """[X] The strength is the yield stress of a bar."""
    specimen = Specimen(VonMises(1e4, 0.3, strength=15.0), [0.0] * 4, ncomp)
    for _ in range(5):
        specimen.step({0: 1e-3}, {1: 0.0, 2: 0.0})
    np.testing.assert_allclose(specimen.stress[:, 0], [15.0] + [0.0] * (ncomp - 1), atol=1e-11)


@pytest.mark.parametrize("psi", [0.0, 10.0, 30.0])
@COMPONENTS
@pytest.mark.one_in(2)
def test_plane_strain_match(psi: float, ncomp: int) -> None:
    """[X] Plane-strain compression ends at the Mohr-Coulomb strength and flows with the dilatancy
    angle.
    """
    specimen = Specimen(
        DruckerPrager.plane_strain(1e4, 0.3, c=5.0, phi=30.0, psi=psi),
        [-50.0, -50.0, -50.0, 0.0],
        ncomp,
    )
    for _ in range(150):
        specimen.step({1: -3e-3}, {0: -50.0})
    # the stress out of plane approaches its ultimate value exponentially with the strain, 0.45 here
    assert -specimen.stress[1, 0] == pytest.approx(3 * 50.0 + 2 * 5.0 * np.sqrt(3), rel=1e-9)
    before = specimen.strain.copy()
    specimen.step({1: -1e-3}, {0: -50.0})
    xx, yy = (specimen.strain - before)[:2, 0]
    assert (xx + yy) / (xx - yy) == pytest.approx(np.sin(np.radians(psi)), abs=1e-7)


def test_parameters_of_each_element() -> None:
    """[X] Arrays of parameters give what the elements give one by one."""
    rng = np.random.default_rng(4)
    parameters = {
        "E": [1e4, 2e4],
        "nu": [0.2, 0.3],
        "k": [5.0, 10.0],
        "alpha": [0.0, 0.3],
        "beta": [0.0, 0.1],
    }
    strain = rng.normal(size=(4, 2, 30)) * 3e-3
    whole = update(DruckerPrager(**parameters), strain)
    tangent = np.zeros((2, 30, 4, 4))
    tangent.reshape(-1, 4, 4)[whole.plastic] = whole.tangent()
    for i in range(2):
        part = update(
            DruckerPrager(**{name: value[i] for name, value in parameters.items()}), strain[:, i]
        )
        assert part.plastic.size
        np.testing.assert_allclose(whole.stress[:, i], part.stress, rtol=1e-13, atol=1e-12)
        np.testing.assert_allclose(tangent[i, part.plastic], part.tangent(), rtol=1e-12, atol=1e-8)


@pytest.mark.parametrize(
    "bad, message",
    [
        ({"k": -1.0}, r"k must not be negative, got -1\.0"),
        ({"alpha": -0.1}, r"alpha must not be negative, got -0\.1"),
        ({"beta": -0.1}, r"beta must not be negative, got -0\.1"),
        ({"beta": 0.3}, r"beta must not exceed alpha, got 0\.3"),
    ],
)
def test_bad_parameters(bad: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        DruckerPrager(**({"E": 1e4, "nu": 0.3, "k": 10.0, "alpha": 0.2, "beta": 0.1} | bad))


def test_flow_rules_of_angles_are_refused_where_the_cone_has_none() -> None:
    """With dilatancy below friction; an associated cone has the same with any rule."""
    cone = DruckerPrager(1e4, 0.3, k=10.0, alpha=0.2, beta=0.1)
    with pytest.raises(ValueError, match="flow 'davis_b' needs cohesion and friction angle"):
        cone.reduced(2.0, "davis_b")
    assert cone.reduced(2.0).beta == 0.1
    assert cone.reduced(4.0).beta == 0.05
    assert cone.reduced(2.0, "associated").beta == 0.1
    assert cone.reduced(0.5, "associated").beta == 0.4
    associated = DruckerPrager(1e4, 0.3, k=10.0, alpha=0.2, beta=0.2).reduced(0.5, "davis_b")
    assert (associated.alpha, associated.beta) == (0.4, 0.4)


def test_cohesion_of_a_strength_that_varies() -> None:
    """[X] Bounds take that of the cone, s / sqrt(3), at points; a constant one is no function."""
    points = np.array([[0.0, 1.0], [-2.0, -4.0]])
    law = VonMises(1e4, 0.3, strength=lambda x: 3.0 - x[1])
    np.testing.assert_allclose(law.cohesion_at(points), [5.0 / np.sqrt(3), 7.0 / np.sqrt(3)])
    cone = VonMises(1e4, 0.3, strength=5.0).cone()
    assert law.cohesion_at(points)[0] == pytest.approx(cone[0])
    assert LAWS["von Mises"].cohesion_at(points) is None


def test_reduced_strength() -> None:
    law = DruckerPrager(1e4, 0.3, k=10.0, alpha=[0.2, 0.2], beta=[0.2, 0.15]).reduced(2.0)
    assert law.k == 5.0
    np.testing.assert_array_equal(law.alpha, 0.1)
    np.testing.assert_array_equal(law.beta, 0.1)
    assert VonMises(1e4, 0.3, strength=10.0).reduced(2.0).strength == 5.0
    with pytest.raises(ValueError, match="strength must not be negative"):
        VonMises(1e4, 0.3, strength=-1.0)
