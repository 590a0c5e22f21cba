"""Laws that several bodies share are called once for all of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad

import skfem_contact as sc
from skfem_contact.errors import IncrementTooLarge
from skfem_contact.forms.base import responses_of
from skfem_contact.materials import Update


class Counted(sc.MohrCoulomb):
    """Soil that counts the points of its calls."""

    def update(self, strain_increment: Any, stress: Any, internal: Any) -> Update:
        sizes.append(stress[0].size)
        return super().update(strain_increment, stress, internal)


sizes: list[int] = []


def bodies(*laws: sc.Material) -> tuple[dict[str, sc.SolidForm], np.ndarray]:
    """Return columns of a block, and displacements at which they yield."""
    mesh = MeshQuad().refined(3)
    edges = np.linspace(0.0, 1.0, len(laws) + 1)
    parts = {
        f"body {k}": lambda p, k=k: (p[0] > edges[k]) & (p[0] < edges[k + 1])
        for k in range(len(laws))
    }
    mesh = mesh.with_subdomains(parts)
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    forms = {
        name: sc.SolidForm(basis.with_elements(name), law)
        for name, law in zip(parts, laws, strict=True)
    }
    x = 2e-3 * np.random.default_rng(1).standard_normal(basis.N)
    return forms, x


def test_one_call_has_the_responses_of_calls_by_body() -> None:
    """[X] Force, state, tangent and damped tangent are those of each body alone."""
    soil = Counted(E=1e4, nu=0.3, c=5.0, phi=25.0)
    forms, x = bodies(soil, soil, sc.LinearElastic(E=1e4, nu=0.2), soil)
    states = {name: form.initial_state() for name, form in forms.items()}
    sizes.clear()
    found = responses_of(forms, x, states)
    assert sizes == [192]  # of 48 elements
    for name, form in forms.items():
        alone = form.assemble(x, states[name])
        np.testing.assert_allclose(found[name].force, alone.force, rtol=1e-12, atol=1e-12)
        for part in ("stress", "strain", "internal"):
            values = getattr(found[name].state, part), getattr(alone.state, part)
            np.testing.assert_allclose(*values, rtol=1e-12, atol=1e-12)
        for part in ("stiffness", "damped"):
            difference = abs(getattr(found[name], part) - getattr(alone, part)).max()
            assert difference < 1e-12 * abs(alone.stiffness).max()
    yielded = [(found[name].state.internal[0] > 0).any() for name in forms if name != "body 2"]
    assert all(yielded)


def test_other_laws_and_parameters_by_element_are_called_alone() -> None:
    """[X] Equal laws are one only where they are one object, of single numbers."""
    one, other = (Counted(E=1e4, nu=0.3, c=5.0, phi=25.0) for _ in range(2))
    by_element = Counted(E=np.full(16, 1e4), nu=0.3, c=5.0, phi=25.0)
    forms, x = bodies(one, other, by_element, by_element)
    sizes.clear()
    responses_of(forms, x, {name: form.initial_state() for name, form in forms.items()})
    assert sizes == [64] * 4


def test_law_that_fails_for_one_body_fails_for_the_evaluation() -> None:
    """[X] The next evaluation is not burdened with it."""

    class Brittle(sc.MohrCoulomb):
        def update(self, strain_increment: Any, stress: Any, internal: Any) -> Update:
            if np.abs(strain_increment).max() > 1.0:
                raise IncrementTooLarge("too much")
            return super().update(strain_increment, stress, internal)

    soil = Brittle(E=1e4, nu=0.3, c=5.0, phi=25.0)
    forms, x = bodies(soil, soil)
    states = {name: form.initial_state() for name, form in forms.items()}
    with pytest.raises(IncrementTooLarge, match="too much"):
        responses_of(forms, 1e4 * x, states)
    assert np.isfinite(responses_of(forms, x, states)["body 0"].force).all()
