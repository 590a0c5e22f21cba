"""Bearing capacity on weightless soil against Prandtl's solution: cases G1, G7, S4, S5."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
from tests.oracles.slopes import bearing_capacity
from tests.tools.footing_meshes import graded, ground
from tests.tools.helpers import analysis

ELEMENTS = {"P2": (ElementTriP2, 2, "full"), "Q1": (ElementQuad1, 2, "b_bar")}


def footing(soil, element: str = "P2", n: int = 4, rough: bool = False):
    """Forms, fixed unknowns and load of a unit pressure on the footing."""
    kind, intorder, strain = ELEMENTS[element]
    mesh = ground(n, 12.0, 6.0)
    mesh = mesh.to_meshtri(style="x") if element == "P2" else mesh
    basis = Basis(mesh, ElementVector(kind()), intorder=intorder)
    fixed = np.hstack([basis.get_dofs("bottom").all(), basis.get_dofs("sides").all("u^1")])
    below = basis.get_dofs("footing")
    if rough:
        fixed = np.union1d(fixed, below.all()[below.all() % 2 == 0])
    facets = FacetBasis(basis.mesh, basis.elem, facets="footing", intorder=4)
    pressure = LinearForm(lambda v, w: -v[1]).assemble(facets)
    return {"soil": sc.SolidForm(basis, soil, strain=strain)}, fixed, pressure


def soil(phi: float, psi: float | None = None, nu: float = 0.3, c: float = 1.0) -> sc.MohrCoulomb:
    return sc.MohrCoulomb(E=1e4, nu=nu, c=c, phi=phi, psi=phi if psi is None else psi)


@pytest.mark.parametrize("phi", [0.0, 20.0, 30.0])
@pytest.mark.parametrize("rough", [False, True], ids=["smooth", "rough"])
@pytest.mark.one_in(2)
def test_prandtl(phi, rough):
    """[X] Case G1: 5.1416, 14.835 and 30.140, smooth or rough; 1226 unknowns read 1 to 4 % more."""
    result = analysis("limit_load", *footing(soil(phi), rough=rough), progress=False)
    assert (
        bearing_capacity(phi)
        < result.multiplier
        < (1.05 if rough else 1.02) * bearing_capacity(phi)
    )
    assert result.stop.kind == "plateau"


@pytest.mark.slow
def test_finer_mesh_halves_the_error():
    """[X] Case G1: from above, in proportion to the size of the elements, as the edge is
    singular.
    """
    exact = bearing_capacity(20.0)
    coarse, fine = (
        analysis("limit_load", *footing(soil(20.0), n=n), progress=False).multiplier / exact - 1
        for n in (3, 6)
    )
    assert 0 < fine < 0.6 * coarse


def test_rigid_rough_footing_under_prescribed_settlement():
    """[X] Case G1: pushed down as a whole, in stages; the reaction ends at the same plateau and
    stays there.
    """
    forms, fixed, pressure = footing(soil(20.0), rough=True)
    down = np.flatnonzero(pressure)
    fixed = np.union1d(fixed, down)
    reactions = []
    stages = []
    for settlement in (0.01, 0.02, 0.03):
        x = np.zeros_like(pressure)
        x[down] = -settlement
        stages.append(sc.Stage(f"{settlement:g}", np.zeros_like(pressure), x, increments=2))
    for stage in sc.Model(forms, fixed, newton=sc.Newton(1e-6)).run(stages, progress=False):
        reactions.append(-forms["soil"].assemble(stage.x, stage.states["soil"]).force[down].sum())
    # 3.5 % more than exact under a uniform pressure on the same mesh; to move as a whole is one
    # constraint more
    assert bearing_capacity(20.0) < reactions[-1] < 1.06 * bearing_capacity(20.0)
    assert reactions[-1] == pytest.approx(reactions[-2], rel=2e-3)


@cache
def capacity_of_clay(element, n, nu):
    clay = soil(0.0, nu=nu)
    return analysis("limit_load", *footing(clay, element, n), progress=False).multiplier


@pytest.mark.parametrize("nu", [0.49, 0.499, 0.4999])
@pytest.mark.parametrize(("element", "n"), [("P2", 4), ("Q1", 8)])
@pytest.mark.one_in(2)
def test_nearly_incompressible(element, n, nu):
    """[X] Case S4: the capacity of clay does not depend on nu, and nothing locks; the curve's end
    is worth 0.2 %.
    """
    usual, stiff = capacity_of_clay(element, n, 0.3), capacity_of_clay(element, n, nu)
    assert stiff == pytest.approx(usual, rel=2e-3)
    assert bearing_capacity(0.0) < stiff < 1.04 * bearing_capacity(0.0)


@pytest.mark.parametrize(
    ("phi", "c"), [pytest.param(50.0, 1.0, marks=pytest.mark.slow), (45.0, 1e-6)]
)
def test_large_friction_angles(phi, c):
    """[X] Case S5: associated flow at phi = 50, and a cohesion next to nothing: 266.88 and 133.87
    times c.
    """
    forms, fixed, load = footing(soil(phi, c=c))
    result = sc.Model(forms, fixed).limit_load(load, step=c, progress=False)
    assert c * bearing_capacity(phi) < result.multiplier < 1.06 * c * bearing_capacity(phi)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:no collapse was shown")
def test_large_friction_angle_without_dilatancy():
    """[X] Case S5: phi = 50 and psi = 0 has no plateau that can be relied upon: less than the
    associated capacity.

    What comes out is an equilibrium of admissible stresses, and the criterion tells how the curve
    ended.
    """
    forms, fixed, load = footing(soil(50.0, 0.0), n=2)
    result = sc.Model(forms, fixed, newton=sc.Newton(1e-3, 15)).limit_load(load, progress=False)
    assert 0.1 * bearing_capacity(50.0) < result.multiplier < bearing_capacity(50.0)
    assert (
        result.stop.kind in ("plateau", "peak", "stall") and result.bracket[1] >= result.multiplier
    )
    inside = forms["soil"].assemble(result.x, result.states["soil"]).force - result.load
    free = np.setdiff1d(np.arange(len(load)), fixed)
    assert np.linalg.norm(inside[free]) < 2e-3 * np.linalg.norm(
        result.load
    )  # Newton's 1e-3, up to the path's states


@pytest.mark.slow
@pytest.mark.parametrize("beta", [30.0, 60.0])
def test_load_beside_a_slope(beta):
    """[X] Case G7: clay under c (2 + pi - 2 beta) up to a slope has the factor 1.000; 1962 unknowns
    +1.6 %.
    """
    c, width, depth, length, n = 10.0, 3.0, 4.0, 6.0, 9
    behind = np.concatenate(
        (graded(width, n), width + np.linspace(0, length - width, n // 2 + 1)[1:])
    )
    box = MeshQuad.init_tensor(-behind[::-1], -graded(depth, n)[::-1])
    cot = 1 / np.tan(np.radians(beta))
    mesh = MeshQuad(np.array([box.p[0] - cot * box.p[1], box.p[1]]), box.t).to_meshtri(style="x")
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    ends = basis.get_dofs(
        lambda p: np.isclose(p[0] + cot * p[1], -length) | np.isclose(p[1], -depth)
    ).all()
    loaded = mesh.facets_satisfying(lambda p: (p[1] > -1e-9) & (p[0] > -width))
    q = c * (2 + np.pi - 2 * np.radians(beta))
    load = LinearForm(lambda v, w: -q * v[1]).assemble(
        FacetBasis(mesh, basis.elem, facets=loaded, intorder=4)
    )
    forms = {"clay": sc.SolidForm(basis, sc.Tresca(E=1e4, nu=0.49, c=c))}
    result = sc.Model(forms, ends).strength_reduction(load, progress=False, tolerance=0.004)
    assert 0.999 < result.factor < 1.02


def test_footing_that_just_stands():
    """[X] Case G7: flat clay under (2 + pi) c; the factor is the error of the limit load on the
    same mesh.
    """
    forms, fixed, pressure = footing(soil(0.0))
    result = sc.Model(forms, fixed).strength_reduction(
        bearing_capacity(0.0) * pressure, progress=False, tolerance=0.004
    )
    limit = sc.Model(forms, fixed).limit_load(
        pressure, progress=False
    ).multiplier / bearing_capacity(0.0)
    assert result.factor == pytest.approx(
        limit, abs=0.003
    )  # both curves end up to 0.001 and 0.002 early
    assert 1.0 < result.factor < 1.02
