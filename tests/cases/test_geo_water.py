"""Slopes under and beside water: cases H5 and H6, examples 5 and 6 of Griffiths and Lane (1999)."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

import skfem_contact as sc
from tests.tools.helpers import analysis
from tests.tools.slope_meshes import HEIGHT, crossed_below, held, pieces, reduced_slope, slope_mesh

WATER = 9.81
#: The dam: both faces, the crest between them, height above the ground, thickness of the ground,
#: and beyond the toes.
UPSTREAM, CREST, DOWNSTREAM, DAM, GROUND, BEYOND = 66.33, 7.3, 50.77, 21.3, 7.3, 33.5
#: Level of the reservoir above the ground.
RESERVOIR = 17.1


def under_water(mesh: MeshTri, soil, unit_weight: float, table, **settings) -> float:
    """Factor of safety with water below and above a "surface"."""
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    water = sc.water_load(basis, sc.hydrostatic(table, unit_weight=WATER), "surface")
    forms = {"soil": sc.SolidForm(basis, soil)}
    load = sc.weight(basis, unit_weight) + water
    result = analysis("strength_reduction", forms, held(basis), load, progress=False, **settings)
    assert result.stop.kind == "plateau"
    return result.factor


def slope(n: int) -> MeshTri:
    """The slope of example 1, 2 to 1 on its base."""
    mesh = slope_mesh(20.0, 12.0, 0.0, 0.0, n)
    return mesh.with_boundaries({"surface": lambda x: x[1] > np.minimum(-x[0] / 2, HEIGHT) - 1e-9})


SOIL = sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0)


def test_slope_under_water():
    """[X] Case H5: no matter how far under water, the factor is that of a slope of its weight in
    water.
    """
    dry = reduced_slope(slope(5), SOIL, 20.0 - WATER).factor
    for above in (0.0, 50.0):
        # the pressure is linear and its loads exact, but what Newton leaves is a share of another
        # load
        assert under_water(slope(5), SOIL, 20.0, HEIGHT + above) == pytest.approx(dry, abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(("level", "published"), [(0.0, 1.85), (0.4, 1.40), (0.7, 1.30)])
def test_slow_drawdown(level, published):
    """[P] Case H5: the water has fallen by a share of the height; the least factor is at 0.7 of it.

    Extrapolated from two meshes. The published values are read off a figure, without dilatancy, and
    their unit weights are not known.
    """
    coarse, fine = (
        under_water(slope(n), SOIL, 20.0, (1 - level) * HEIGHT, tolerance=0.004) for n in (5, 10)
    )
    assert fine < coarse
    assert 2 * fine - coarse == pytest.approx(published, rel=0.03)


def dam(n: int) -> MeshTri:
    """A dam with n elements along each face, on its ground."""
    toe, crest = UPSTREAM + CREST, UPSTREAM + CREST + DOWNSTREAM

    def surface(x):
        return np.interp(x, [0.0, UPSTREAM, toe, crest], [0.0, DAM, DAM, 0.0])

    x = pieces(
        (-BEYOND, 0.0, 2 * BEYOND / n),
        (0.0, UPSTREAM, UPSTREAM / n),
        (UPSTREAM, toe, CREST),
        (toe, crest, DOWNSTREAM / n),
        (crest, crest + BEYOND, 2 * BEYOND / n),
    )
    y = pieces((-GROUND, 0.0, 3 * GROUND / n), (0.0, DAM, DAM / n))
    mesh = crossed_below(x, y, surface)
    return mesh.with_boundaries({"surface": lambda x: x[1] > surface(x[0]) - 1e-9})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("filled", "published"), [(False, (2.40, 2.42)), (True, (1.87, 1.90))], ids=["dry", "full"]
)
def test_dam(filled, published):
    """[P] Case H6: an earth dam before and after filling; the downstream face fails.

    The free surface falls in a line from the reservoir to the downstream toe, and the pressure is
    that of the depth below it. Published factors of finite elements, without dilatancy, and of
    slices differ by 1 and 2 %; the extrapolation is worth 1 %.
    """
    soil = sc.MohrCoulomb(E=1e5, nu=0.3, c=13.8, phi=37.0, psi=37.0)
    shore = RESERVOIR / DAM * UPSTREAM
    free = [(shore, RESERVOIR), (UPSTREAM + CREST + DOWNSTREAM, 0.0)] if filled else -GROUND
    coarse, fine = (under_water(dam(n), soil, 18.2, free, tolerance=0.008) for n in (5, 10))
    assert fine < coarse
    assert 0.98 * published[0] < 2 * fine - coarse < 1.02 * published[1]
