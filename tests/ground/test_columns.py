"""Sections between columns of layers."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis

import skfem_contact as sc

Column = sc.ground.Column
gmsh = pytest.importorskip("gmsh", exc_type=(ImportError, OSError))


def sizes(section):
    """Areas of a meshed section by name."""
    mesh = section.mesh()
    return {name: Basis(mesh, mesh.elem(), elements=name).dx.sum() for name in section.areas}


def test_a_layer_that_is_wedged_out():
    """[X] Sand of 3 m at the first column and of none at the second, 10 m away."""
    west = Column("B1", (0.0,), 2.0, (("sand", -1.0), ("clay", -9.0)))
    east = Column("B2", (10.0,), 2.0, (("clay", -8.0),))
    found = sizes(sc.ground.section([east, west], size=2.0))
    assert found == {"sand": pytest.approx(15.0), "clay": pytest.approx(85.0)}
    wide = sizes(sc.ground.section([east, west], size=2.0, width=5.0, bottom=-10.0))
    assert wide == {"sand": pytest.approx(30.0), "clay": pytest.approx(210.0)}


def test_three_columns_with_a_layer_that_is_missing_in_the_middle():
    """[X] Peat at both ends is cut into two parts, each a wedge of 10 m with 2 m."""
    columns = [
        Column("B1", (0.0,), 0.0, (("fill", -1.0), ("peat", -3.0), ("clay", -10.0))),
        Column("B2", (10.0,), 0.0, (("fill", -2.0), ("clay", -10.0))),
        Column("B3", (20.0,), 1.0, (("fill", -1.0), ("peat", -3.0), ("clay", -10.0))),
    ]
    found = sizes(sc.ground.section(columns, size=2.0))
    assert found["peat"] == pytest.approx(20.0)
    assert sum(found.values()) == pytest.approx(205.0)


def test_columns_are_projected_on_a_line():
    """[X] The line from west to east; a column beside it keeps its easting."""
    columns = [
        Column("B1", (500.0, 200.0), 0.0, (("clay", -5.0),)),
        Column("B2", (505.0, 207.0), 1.0, (("clay", -5.0),)),
        Column("B3", (510.0, 200.0), 0.0, (("clay", -5.0),)),
    ]
    mesh = sc.ground.section(columns, size=2.0).mesh()
    assert mesh.p.min(axis=1) == pytest.approx([0.0, -5.0])
    assert mesh.p.max(axis=1) == pytest.approx([10.0, 1.0])
    top = mesh.p[:, np.argmax(mesh.p[1])]
    assert top == pytest.approx([5.0, 1.0])


def test_wrong_columns():
    """[X] Messages name the columns and the layers."""
    one = Column("B1", (0.0,), 0.0, (("sand", -1.0), ("clay", -5.0)))
    other = Column("B2", (8.0,), 0.0, (("clay", -1.0), ("sand", -5.0)))
    with pytest.raises(ValueError, match="layers sand, clay come in different orders"):
        sc.ground.section([one, other], size=1.0)
    section = sc.ground.section([one, other.renamed({"clay": "crust"})], size=1.0)
    assert list(section.areas) == ["crust", "sand", "clay"]
    with pytest.raises(ValueError, match="needs two columns or more, not 1"):
        sc.ground.section([one], size=1.0)
    with pytest.raises(ValueError, match="columns lie at one point of the section: B1, B1"):
        sc.ground.section([one, one], size=1.0)
    with pytest.raises(ValueError, match="'B3': the layer 'clay' ends at 1, which is not below 0"):
        Column("B3", (0.0,), 0.0, (("clay", 1.0),))


def test_layers_of_one_name_that_meet_are_joined():
    """[X] Renaming joins; a repeated soil has a number."""
    column = Column("B1", (0.0,), 0.0, (("a", -1.0), ("b", -2.0), ("a", -3.0)))
    assert column.soils == ("a", "b", "a 2")
    assert column.renamed({"b": "a"}).layers == (("a", -3.0),)
