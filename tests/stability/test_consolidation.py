"""Consolidation where it is hard: contrasts, tiny and huge steps, drained and sealed ground, units,
mirrors.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from skfem import MeshQuad, MeshTri

import skfem_contact as sc
from tests.tools.helpers import vector_basis

pytestmark = pytest.mark.filterwarnings("ignore:stage")
ELEMENTS = {"P2": MeshTri, "Q2": MeshQuad, "Q1": MeshQuad, "P1": MeshTri}
E, NU = 1e4, 0.25


def footing(
    element: str = "P2",
    k=1e-4,
    storage=0.0,
    length: float = 1.0,
    stress: float = 1.0,
    side: float = 1.0,
    soil=None,
):
    """Half of a strip on a layer with a seam, its forms, supports and load; k over the unit weight
    of water.
    """
    x, y = side * np.linspace(0, 4, 9), np.linspace(-2, 0, 7)
    mesh = (
        ELEMENTS[element]
        .init_tensor(length * np.sort(x), length * y)
        .with_boundaries(
            {
                "strip": lambda x: (x[1] > -1e-9 * length) & (abs(x[0]) < 1.01 * length),
                "top": lambda x: x[1] > -1e-9 * length,
            }
        )
    )
    mesh = mesh.with_subdomains(
        {
            "seam": lambda x: abs(x[1] + length) < 0.34 * length,
            "clay": lambda x: abs(x[1] + length) > 0.34 * length,
        }
    )
    basis = vector_basis(mesh, element, intorder=4 if element[1] == "2" else 2)
    strain = "b_bar" if element == "Q1" else "full"
    soil = sc.LinearElastic(E=E * stress, nu=NU) if soil is None else soil
    forms = {
        "ground": sc.SolidForm(basis, soil, strain=strain),
        "water": sc.PoreWater(basis, k, unit_weight=1.0, storage=storage),
    }
    fixed = [sc.box_supports(basis), forms["water"].dofs("top")]
    return basis, forms, fixed, sc.traction(basis, "strip", (0.0, -100.0 * stress))


def consolidated(forms, fixed, load, durations=(1e-2, 0.3), **options):
    stages = [sc.Stage(f"{k}", load, duration=duration) for k, duration in enumerate(durations)]
    return sc.Model(forms, fixed).run(stages, progress=False, **options)


def check(forms, result, lost: float = 1e-8) -> None:
    """Nothing is lost: water that has entered is stored."""
    water, state = forms["water"], result[-1].states["water"]
    assert np.isfinite(result[-1].x).all()
    assert abs(water.inflow(state) - water.volume(state)) <= lost * np.abs(state.stored).sum()


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("seam", [1e-8, 1e8])
def test_permeability_contrast(element, seam):
    """[X] A tight seam keeps the pressure below it, an open one equalises it."""
    basis, forms, fixed, load = footing(element, {"clay": 1e-4, "seam": 1e-4 * seam})
    result = consolidated(forms, fixed, load, (1e-2, 20.0))
    check(
        forms, result, 1e-8 if seam < 1 else 1e-6
    )  # round-off of flows that are 1e8 times as large as what is stored
    p, (_, y) = result[-1].forms["water"].pressure(result[-1].x), basis.mesh.p
    if seam < 1:
        assert (
            np.abs(p[y < -1.5]).mean() > 1.0 and np.abs(p[y > -0.6]).max() < 0.05 * np.abs(p).max()
        )
    else:
        inside = p[np.isclose(y, -1.0)]
        assert np.ptp(inside) < 1e-3 * 100.0


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("duration", [1e-8, 1.0, 1e8])
@pytest.mark.parametrize("storage", [0.0, 1e-9, 1e-4])
@pytest.mark.one_in(3)
def test_steps_of_any_length(element, duration, storage):
    """[X] From undrained ground to the end of consolidation, which is elastic ground without water,
    in one stage.
    """
    basis, forms, fixed, load = footing(element, storage=storage)
    result = consolidated(forms, fixed, load, (duration,))
    check(forms, result)
    assert len(result[-1].iterations) < 60
    if duration == 1e8:
        dry = sc.Model({"ground": forms["ground"]}, sc.box_supports(basis)).run(
            [sc.Stage("dry", load)], progress=False
        )
        np.testing.assert_allclose(
            result[-1].x[: basis.N], dry["dry"].x, atol=1e-5 * np.abs(dry["dry"].x).max()
        )


@pytest.mark.parametrize("element", ELEMENTS)
def test_pressed_at_once(element):
    """[X] Pressures of undrained ground are those of the nearly incompressible solid, but beside
    the drain.
    """
    basis, forms, fixed, load = footing(element)
    result = consolidated(forms, fixed, load, (1e-6,))
    volume = forms["water"].volume(result[-1].states["water"])
    stiffness = E * (1 - NU) / (1 + NU) / (1 - 2 * NU)
    # no more than half an element beside the drain can give way at once, below the strip of 1 m
    assert abs(volume) < 100.0 / stiffness * (0.5 / 3.0)
    p = result[-1].forms["water"].pressure(result[-1].x)
    assert 0.0 < p[np.isclose(basis.mesh.p[1], -2.0)].max() < 100.0 * 1.2


@pytest.mark.parametrize("element", ELEMENTS)
def test_drained_everywhere(element):
    """[X] Pressures that are all held make no difference to the ground."""
    basis, forms, _, load = footing(element)
    result = consolidated(forms, [sc.box_supports(basis), forms["water"].dofs()], load)
    dry = sc.Model({"ground": forms["ground"]}, sc.box_supports(basis)).run(
        [sc.Stage("dry", load)], progress=False
    )
    np.testing.assert_allclose(result[-1].x[: basis.N], dry["dry"].x, atol=1e-12)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("storage", [0.0, 1e-6])
def test_sealed_everywhere(element, storage):
    """[X] No water leaves, however long it takes; where it cannot be compressed the volume
    stays.
    """
    _, forms, fixed, load = footing(element, storage=storage)
    result = consolidated(forms, fixed[:1], load, (1.0, 1e4))
    state = result[-1].states["water"]
    assert abs(forms["water"].inflow(state)) < 1e-10 and abs(forms["water"].volume(state)) < 1e-10
    if not storage:
        p = result[-1].forms["water"].pressure(result[-1].x)
        assert np.ptp(p) < 1e-2 * p.mean()  # in the end it is the same everywhere


@cache
def in_metres(element):
    _, forms, fixed, load = footing(element)
    return consolidated(forms, fixed, load)


@pytest.mark.parametrize("element", ["P2", "Q1"])
@pytest.mark.parametrize(
    ("length", "stress", "time"), [(1e3, 1e-6, 1.0), (1.0, 1e3, 86400.0), (1e-3, 1e6, 1e-3)]
)
def test_units(element, length, stress, time):
    """[X] Millimetres and megapascals, days and seconds: the same digits."""
    one = in_metres(element)
    basis, forms, fixed, load = footing(
        element, 1e-4 * length**2 / stress / time, length=length, stress=stress
    )
    other = consolidated(forms, fixed, load, (1e-2 * time, 0.3 * time))
    n, first = basis.N, one[-1].forms["water"].first
    np.testing.assert_allclose(
        other[-1].x[:n] / length, one[-1].x[:n], atol=1e-8 * np.abs(one[-1].x[:n]).max()
    )
    np.testing.assert_allclose(other[-1].x[first:] / stress, one[-1].x[first:], atol=1e-8 * 100.0)
    assert [len(a.iterations) for a in one] == [len(b.iterations) for b in other]


@pytest.mark.parametrize("psi", [0.0, 25.0])
def test_mirrored(psi):
    """[X] Yielding ground on quadrilaterals gives the same to the left and to the right."""
    soil = sc.MohrCoulomb(E=5e3, nu=0.3, c=20.0, phi=25.0, psi=psi)
    found = []
    for side in (1.0, -1.0):
        basis, forms, fixed, load = footing("Q2", side=side, soil=soil)
        result = consolidated(forms, fixed, 0.8 * load, (0.1, 1.0))
        check(forms, result)
        p = result[-1].forms["water"].pressure(result[-1].x)
        order = np.lexsort((basis.mesh.p[1], side * basis.mesh.p[0].round(9)))
        found.append((p[order], -result[-1].x[1 : basis.N : 2].min()))
    np.testing.assert_allclose(
        found[0][0], found[1][0], atol=1e-4 * 100.0
    )  # residuals of 1e-8 where much yields
    assert found[0][1] == pytest.approx(found[1][1], rel=1e-5)
