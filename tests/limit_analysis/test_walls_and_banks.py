"""Bounds of walls and banks: passive pressure, soil without tension, earthquakes."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc


@pytest.mark.parametrize("c", [1.0, 0.1, 0.0])
def test_passive_earth_pressure(c: float) -> None:
    """[X] Rankine's passive earth pressure on a smooth wall, K_p gamma h / 2 + 2 c sqrt(K_p); sand
    has no lower one.
    """
    expected = 3.0 * 20.0 / 2.0 + 2.0 * c * np.sqrt(3.0)
    ground = MeshTri.init_tensor(np.linspace(0, 6, 13), np.linspace(-1, 0, 5)).with_defaults()
    wall = MeshTri.init_tensor(np.linspace(-0.3, 0, 2), np.linspace(-1, 0, 5)).with_defaults()
    basis = Basis(
        sc.join_bodies({"ground": ground, "wall": wall}), ElementVector(ElementTriP2()), intorder=2
    )
    soil = sc.MohrCoulomb(1e5, 0.3, c=c, phi=30.0, psi=30.0)
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soil),
        "wall": sc.SolidForm(basis.with_elements("wall"), sc.LinearElastic(1e7, 0.2)),
        "joint": sc.ContactPair(basis, "wall:right", "ground:left", sc.Coulomb(mu=0.0)),
    }
    fixed = [
        basis.get_dofs({"ground:bottom", "wall:bottom"}).all("u^2"),
        basis.get_dofs("ground:right").all("u^1"),
    ]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = sc.Model(forms, fixed).bounds(
            weight={"ground": 20.0},
            tractions={"wall:left": (1.0, 0.0)},
            live="wall:left",
            gap=0.05,
            elements=300,
            progress=False,
        )
    assert expected * (1 - 1e-12) <= found.upper < 1.001 * expected
    if c:
        assert 0.999 * expected < found.lower <= expected * (1 + 1e-12)
    else:
        assert found.lower == -np.inf and "give it a small cohesion" in str(told[-1].message)


def test_soil_without_tension() -> None:
    """The missing lower bound is explained by the missing tension."""
    mesh = MeshTri.init_tensor(np.linspace(-2, 0, 3), np.linspace(0, 2, 3)).with_boundaries(
        {"base": lambda x: x[1] < 1e-9, "sides": lambda x: x[0] < -2 + 1e-9}
    )
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    fixed = np.append(basis.get_dofs("base").all(), basis.get_dofs("sides").all("u^1"))
    soil = sc.SolidForm(basis, sc.MohrCoulomb(1e5, 0.3, c=32.0, phi=10.0, psi=10.0, tension=0.0))
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = sc.Model({"soil": soil}, fixed).bounds(
            weight=20.0, gap=0.1, elements=60, progress=False
        )
    assert found.lower > 1.0 or any("a small tension" in str(one.message) for one in told)


def test_bounds_take_the_earthquake_of_the_model() -> None:
    """[X] A model's horizontal acceleration is that of its bounds; gravity in another direction is
    refused.
    """
    mesh = MeshTri.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 2, 5)).with_defaults()
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    soil = sc.SolidForm(
        basis, sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=20.0, psi=20.0), unit_weight=20.0
    )
    bottom = basis.get_dofs("bottom").all()
    shaken = sc.Model({"soil": soil}, bottom, seismic=0.3).bounds(elements=100, gap=0.5)
    asked = sc.Model({"soil": soil}, bottom).bounds(elements=100, gap=0.5, seismic=0.3)
    assert (shaken.lower, shaken.upper) == (asked.lower, asked.upper)
    with pytest.raises(ValueError, match="rotate the mesh"):
        sc.Model({"soil": soil}, bottom, gravity=(0.6, -0.8)).bounds()


def test_a_bank_that_needs_six_times_its_strength() -> None:
    """[X] A bank of 4 m on a smooth base, c = .5, phi = 30 degrees: at most .1812, the factor of a
    wedge.
    """
    basis = Basis(
        MeshTri.init_tensor(np.linspace(0, 8, 17), np.linspace(0, 4, 9)).with_defaults(),
        ElementVector(ElementTriP2()),
        intorder=2,
    )
    soil = sc.SolidForm(
        basis, sc.MohrCoulomb(E=2e4, nu=0.3, c=0.5, phi=30.0, psi=30.0), unit_weight=18.0
    )
    model = sc.Model(
        {"soil": soil}, [basis.get_dofs("bottom").all("u^2"), basis.get_dofs("right").all("u^1")]
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sc.AnalysisWarning)  # the gap
        found = model.bounds(elements=300, progress=False)
    assert 0.13 < found.lower < found.upper < 0.1812


@pytest.mark.slow
def test_a_wall_that_falls_without_its_thrust() -> None:
    """[X] A wall hangs on the ground by its friction, from a thrust of G cot(delta): few elements
    show that one, more of them a lower bound of the largest one.
    """
    ground = MeshTri.init_tensor(np.linspace(0, 6, 13), np.linspace(-2, 0, 9)).with_boundaries(
        {
            "bottom": lambda x: x[1] < -2 + 1e-9,
            "right": lambda x: x[0] > 6 - 1e-9,
            "behind": lambda x: (x[0] < 1e-9) & (x[1] > -1),
            "below": lambda x: (x[0] < 1e-9) & (x[1] < -1),
        }
    )
    wall = MeshTri.init_tensor(np.linspace(-0.3, 0, 2), np.linspace(-1, 0, 5)).with_defaults()
    basis = Basis(
        sc.join_bodies({"ground": ground, "wall": wall}), ElementVector(ElementTriP2()), intorder=2
    )
    soil = sc.MohrCoulomb(1e5, 0.3, c=0.1, phi=30.0, psi=30.0)
    friction = sc.Coulomb(mu=np.tan(np.radians(20.0)))
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soil),
        "wall": sc.SolidForm(basis.with_elements("wall"), sc.LinearElastic(1e7, 0.2)),
        "joint": sc.ContactPair(basis, "wall:right", "ground:behind", friction),
    }
    fixed = [
        basis.get_dofs("ground:bottom").all(),
        basis.get_dofs({"ground:right", "ground:below"}).all("u^1"),
    ]
    found = {}
    for elements in (240, 400):
        with pytest.warns(sc.AnalysisWarning) as told:
            found[elements] = sc.Model(forms, fixed).bounds(
                weight={"ground": 20.0, "wall": 24.0},
                tractions={"wall:left": (1.0, 0.0)},
                live="wall:left",
                flow="associated",
                elements=elements,
                progress=False,
            )
        if elements == 240:
            text = str(told[-1].message)
    least = float(text.partition("a multiplier of at least ")[2].partition(", ")[0])
    exact = 24.0 * 0.3 / np.tan(np.radians(20.0))
    assert 0.99 * exact < least < exact  # of a mechanism: the thrust may have to be larger
    assert found[240].lower == -np.inf
    assert exact < found[400].lower < found[400].upper < found[240].upper
