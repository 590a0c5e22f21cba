"""Parameters of the materials: what is refused, and how the message says so."""

from __future__ import annotations

import numpy as np
import pytest

from skfem_contact.materials import LinearElastic, MohrCoulomb

GOOD = {"E": 1e4, "nu": 0.3, "c": 10.0, "phi": 30.0, "psi": 10.0}


@pytest.mark.parametrize(
    "bad, message",
    [
        ({"E": 0.0}, "E must be positive, got 0.0"),
        ({"E": -1.0}, "E must be positive, got -1.0"),
        ({"E": np.array([1.0, -2.0])}, "E must be positive, got -2.0 in element 1"),
        ({"nu": 0.5}, "nu must lie between -1 and 0.5, got 0.5"),
        ({"nu": -1.0}, "nu must lie between -1 and 0.5, got -1.0"),
        ({"c": -1e-9}, "c must not be negative, got -1e-09"),
        ({"phi": -1.0}, r"phi must lie in \[0, 90\) degrees, got -1.0"),
        ({"phi": 90.0}, r"phi must lie in \[0, 90\) degrees, got 90.0"),
        ({"psi": -0.1}, "psi must not be negative, got -0.1"),
        ({"psi": 31.0}, "psi must not exceed phi, got 31.0"),
        ({"phi": np.array([30.0, 5.0])}, "psi must not exceed phi, got 10.0 in element 1"),
        (
            {"c": np.nan},
            "c must be a finite number or an array of real numbers or a function, not nan",
        ),
        ({"phi": np.array([30.0, np.inf])}, "phi must be finite numbers, not array"),
        (
            {"E": "stiff"},
            "E must be a finite number or an array of real numbers or a function, not 'stiff'",
        ),
        (
            {"E": np.ones((2, 2))},
            r"E must be a number or one number an element, got shape \(2, 2\)",
        ),
        ({"E": np.ones(2), "c": np.ones(3)}, "one value an element: E has 2, c has 3"),
    ],
)
def test_bad_parameters(bad: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        MohrCoulomb(**(GOOD | bad))


@pytest.mark.parametrize("material", [LinearElastic(1e4, 0.3), MohrCoulomb(**GOOD)])
@pytest.mark.parametrize(
    "strain, stress",
    [((4, 5), (4, 6)), ((3, 5), (3, 5)), ((4,), (4,))],
    ids=["differ", "3 components", "no points"],
)
def test_bad_fields(material: LinearElastic | MohrCoulomb, strain: tuple, stress: tuple) -> None:
    with pytest.raises(ValueError, match=r"\(4 or 6, n_elements, ...\)"):
        material.update(
            np.zeros(strain), np.zeros(stress), np.zeros((material.n_internal, *stress[1:]))
        )


def test_parameter_array_of_wrong_length() -> None:
    material = MohrCoulomb(**(GOOD | {"c": np.ones(3)}))
    with pytest.raises(ValueError, match="3 values for 5 elements"):
        material.update(np.zeros((4, 5, 2)), np.zeros((4, 5, 2)), np.zeros((1, 5, 2)))


def test_parameters_are_owned_and_frozen() -> None:
    """A caller's array may change afterwards; the material's may not."""
    cohesion = np.ones(2)
    material = MohrCoulomb(**(GOOD | {"c": cohesion, "E": 10000}))
    cohesion[0] = -1
    assert isinstance(material.E, float)
    np.testing.assert_array_equal(material.c, 1)
    with pytest.raises(ValueError, match="read-only"):
        material.c[0] = -1


@pytest.mark.parametrize("ncomp", [4, 6])
def test_linear_elastic_is_its_stiffness(ncomp: int) -> None:
    """[X] The update is the product with the stiffness; uniaxial stress gives E and nu back."""
    material = LinearElastic(E=np.array([1e4, 2e4, 3e4]), nu=np.array([-0.5, 0.0, 0.45]))
    stiffness = material.elasticity(ncomp)
    rng = np.random.default_rng(0)
    strain, stress = rng.normal(size=(2, ncomp, 3, 4))
    result = material.update(strain, stress, np.zeros((0, 3, 4)))
    np.testing.assert_allclose(
        result.stress, stress + np.einsum("eij,jeq->ieq", stiffness, strain), rtol=1e-12
    )
    assert result.plastic.size == 0
    assert result.tangent().shape == (0, ncomp, ncomp)
    compliance = np.linalg.inv(stiffness)
    np.testing.assert_allclose(1 / compliance[:, 0, 0], material.E, rtol=1e-13)
    np.testing.assert_allclose(-compliance[:, 1, 0] * material.E, material.nu, atol=1e-13)
