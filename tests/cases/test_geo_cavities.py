"""Tunnels and cavities in axial symmetry against exact solutions: cases I1 to I3, G8."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import BilinearForm, FacetBasis, LinearForm

import skfem_contact as sc
from tests.tools.helpers import Springs, grid, vector_basis

END = 8.0


def cavity(soil: sc.MohrCoulomb, far: float, pressures, n: int = 40):
    """Inward displacements of the wall of a hole of radius 1, form and result, at pressures one
    after the other.
    """
    basis = vector_basis(grid("Q2", np.geomspace(1, END, n + 1), [0, 0.1]), "Q2", intorder=4)
    wall, end = (FacetBasis(basis.mesh, basis.elem, facets=side) for side in ("left", "right"))
    inside = LinearForm(lambda v, w: w.x[0] * v[0]).assemble(wall)
    outside = LinearForm(lambda v, w: -w.x[0] * v[0]).assemble(end)
    spring = soil.E / (1 + soil.nu) / END  # elastic ground beyond the mesh: exactly 2 G u / R
    springs = BilinearForm(lambda u, v, w: spring * w.x[0] * u[0] * v[0]).assemble(end)
    forms = {
        "ground": sc.SolidForm(basis, soil, coordinates="axisymmetric"),
        "far": Springs(springs.tocsr()),
    }
    fixed = np.flatnonzero(np.arange(basis.N) % 2 == 1)
    homogeneous = np.array([-far, -far, -far, 0.0])[:, None, None]
    start = sc.Model(forms, fixed).initial_state(
        far * (inside + outside), stress=lambda x: homogeneous * np.ones_like(x[0])
    )
    assert start[0].residual < 1e-12
    stages = [sc.Stage(f"{p:g}", p * inside + far * outside) for p in pressures]
    result = sc.Model(forms, fixed).run(stages, start=start, progress=False)
    at = basis.get_dofs("left").all("u^1")
    return -np.array([stage.x[at].mean() for stage in result.stages[1:]]), forms["ground"], result


@pytest.mark.parametrize(
    ("psi", "wall"), [(0.0, 0.012271610), (15.0, 0.016466941), (30.0, 0.028572708)]
)
def test_hole_in_rock(psi, wall):
    """[N] Case I1, with the edge zone beside the wall that the closed form leaves out.

    The closed form gives 0.01216712, 0.01624959 and 0.02810346. The displacements here are those of
    the differential equation with the flow of both faces; plastic radius and stresses are those of
    the case.
    """
    rock = sc.MohrCoulomb(E=6.77793e9, nu=0.210345, c=3.45e6, phi=30.0, psi=psi)
    moved, form, result = cavity(rock, 30e6, [0.0])
    assert moved[0] == pytest.approx(wall, rel=2e-3)  # 40 elements
    state = result[-1].states["ground"]
    r = np.asarray(form.basis.global_coordinates())[0]
    yielded = state.internal[0] > 0
    assert r[yielded].max() < 1.7350 < r[~yielded].min() * 1.02 and r[yielded].max() > 1.70
    for at, radial, hoop in (
        (1.2, 2.629253, 19.838910),
        (1.5, 7.469469, 34.359558),
        (2.0, 16.463207, 43.536793),
        (3.0, 23.983648, 36.016352),
    ):
        order = np.argsort(r.ravel())
        for component, exact in ((0, radial), (2, hoop)):
            value = np.interp(at, r.ravel()[order], -state.stress[component].ravel()[order])
            assert value / 1e6 == pytest.approx(
                exact, rel=0.01, abs=0.1
            )  # between points of elements


def test_ground_reaction_curve():
    """[X] Case I2: support lowered in stages; one step gives the same."""
    pressures = (150, 100, 80, 60, 40, 20)
    exact = {
        0.0: (1.3e-3, 2.6e-3, 3.168095e-3, 4.102378e-3, 5.833782e-3, 9.655445e-3),
        30.0: (1.3e-3, 2.6e-3, 3.219927e-3, 4.689699e-3, 8.506990e-3, 20.990765e-3),
    }
    for psi, walls in exact.items():
        soil = sc.MohrCoulomb(E=5e4, nu=0.3, c=10.0, phi=30.0, psi=psi)
        moved, *_ = cavity(soil, 200.0, pressures)
        np.testing.assert_allclose(moved[:2], walls[:2], rtol=1e-4)  # elastic
        np.testing.assert_allclose(moved[2:], walls[2:], rtol=4e-3)
        at_once = cavity(soil, 200.0, (20,))[0]
        assert at_once[-1] == pytest.approx(moved[-1], rel=2e-3)  # the path to the edge differs


def test_cavity_expansion():
    """[X] Case I3: a cylindrical cavity is pressed apart; onset at 150."""
    exact = {
        0.0: (3.962015e-3, 8.185185e-3),
        10.0: (3.952325e-3, 7.869417e-3),
        30.0: (3.940444e-3, 7.511111e-3),
    }
    for psi, walls in exact.items():
        soil = sc.MohrCoulomb(E=2e4, nu=0.3, c=0.0, phi=30.0, psi=psi)
        moved, _, result = cavity(soil, 100.0, (149, 160, 200))
        assert result["149"].summary["ground"] == "" and result["160"].summary["ground"] != ""
        np.testing.assert_allclose(-moved[1:], walls, rtol=2e-3)


@pytest.mark.parametrize("coordinates", ["plane", "axisymmetric"])
@pytest.mark.parametrize("element", ["Q2", "P2"])
def test_column_in_compression(coordinates, element):
    """[X] Case G8: a column bears 2 c tan(45 + phi / 2), a cylinder too; both are free at the
    side.
    """
    basis = vector_basis(
        grid(element, np.linspace(0, 1, 3), np.linspace(0, 2, 4)), element, intorder=4
    )
    soil = sc.MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=30.0, psi=30.0)
    form = sc.SolidForm(basis, soil, coordinates=coordinates)
    top = basis.get_dofs("top").all("u^2")
    fixed = np.concatenate(
        (basis.get_dofs("left").all("u^1"), basis.get_dofs("bottom").all("u^2"), top)
    )
    x = basis.zeros()
    x[top] = -0.05
    step = sc.Model({"column": form}, fixed).run(
        [sc.Stage("s", basis.zeros(), x, 4)], progress=False
    )["s"]
    area = 0.5 if coordinates == "axisymmetric" else 1.0
    force = form.assemble(step.x, step.states["column"]).force[top].sum()
    assert -force / area == pytest.approx(20 * np.tan(np.radians(60)), rel=1e-8)


def test_clay_in_tension():
    """[X] Case G8: a plate of Tresca's material in plane strain is torn at 2 c."""
    basis = vector_basis(grid("Q2", np.linspace(0, 1, 3), np.linspace(0, 2, 4)), "Q2", intorder=4)
    form = sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.3, c=10.0))
    top = basis.get_dofs("top").all("u^2")
    fixed = np.concatenate(
        (basis.get_dofs("left").all("u^1"), basis.get_dofs("bottom").all("u^2"), top)
    )
    x = basis.zeros()
    x[top] = 0.05
    step = sc.Model({"plate": form}, fixed).run(
        [sc.Stage("s", basis.zeros(), x, 4)], progress=False
    )["s"]
    assert form.assemble(step.x, step.states["plate"]).force[top].sum() == pytest.approx(
        20.0, rel=1e-8
    )
