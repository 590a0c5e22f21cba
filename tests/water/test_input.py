"""One clear error for every mistake in a seepage analysis, before anything is computed."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementQuad1, ElementTriP1, FacetBasis, MeshQuad, MeshTri

import skfem_contact as sc
from tests.tools.flows import steady

MESH = (
    MeshTri.init_tensor(np.linspace(0, 4, 5), np.linspace(0, 2, 3))
    .with_defaults()
    .with_subdomains({"a": lambda x: x[0] < 2, "b": lambda x: x[0] > 2, "b, c": lambda x: x[0] > 1})
)
BASIS = Basis(MESH, ElementTriP1())
BODIES = Basis(sc.join_bodies({"p": MESH, "q": MESH.translated((4.0, 0.0))}), ElementTriP1())
HEADS = {"left": 2.0, "right": 1.0}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"basis": "mesh"}, "basis must be a CellBasis, not 'mesh'"),
        ({"basis": FacetBasis(MESH, ElementTriP1())}, "basis must be a CellBasis, not FacetBasis"),
        (
            {"permeability": 0.0},
            "permeability must be positive and finite in all directions, not 0.0; leave elements",
        ),
        ({"permeability": -1e-5}, "permeability must be positive"),
        ({"permeability": np.nan}, "permeability must be (positive and finite|finite numbers)"),
        ({"permeability": (1.0, 0.0)}, "permeability must be positive"),
        ({"permeability": [[1.0, 2.0], [2.0, 1.0]]}, "permeability must be positive"),
        ({"permeability": [[1.0, 0.2], [0.1, 1.0]]}, "permeability must be positive"),
        (
            {"permeability": (1.0, 1.0, 1.0)},
            r"a number, 2 numbers along the axes or a tensor \(2, 2\)",
        ),
        (
            {"permeability": "clay"},
            "(a permeability is a number|permeability must be finite numbers)",
        ),
        (
            {"permeability": {"a": 1e-12, "b": 1.0}},
            "the permeabilities from 1e-12 to 1 are too far apart",
        ),
        ({"permeability": (1e12, 1.0)}, "too far apart"),
        (
            {"permeability": {"a": 1.0}},
            r"8 elements have no permeability; they lie in the subdomains \['b', 'b, c'\]",
        ),
        (
            {"permeability": {"a": 1.0, "b": 1.0, "b, c": 1.0}},
            "12 elements have more than one permeability",
        ),
        ({"permeability": {"a": 1.0, "bb": 1.0}}, "no subdomain 'bb'; existing: a, b"),
        ({"head": {}}, "there is no head"),
        ({"head": 2.0}, "head must be a dictionary of names"),
        ({"head": {"lefft": 2.0}}, "no boundary 'lefft'; existing: bottom, left, right, top"),
        (
            {"head": {"left": np.nan}},
            "each a finite number or a function or a function, not {'left': nan}",
        ),
        (
            {"head": {"left": lambda x: np.ones(7)}},
            "the head of boundary 'left' must be a finite number",
        ),
        (
            {"head": {"left": 2.0, "top": 1.0}},
            "head of boundary 'top', 1 at most, is below all of it, from 2 up",
        ),
        (
            {"head": {"left": 3.0, "top": 2.0}},
            r"'left' and 'top' share the node at \(0, 2\) and give it different heads",
        ),
        ({"seepage_face": "rigth"}, "no boundary 'rigth'"),
        ({"seepage_face": ["right", "none"]}, "no boundary 'none'"),
        ({"retention": {"a": sc.water.Ramp()}}, "8 elements have no retention"),
        ({"unit_weight": 0.0}, "unit_weight must be a finite number above 0"),
        ({"unit_weight": np.inf}, "unit_weight must be a finite number, not inf"),
        ({"connected": ["left"]}, "connected must be several values, each 2 values, each a string"),
        ({"connected": [("left", "rihgt")]}, "no boundary 'rihgt'"),
        (
            {"connected": [("bottom", "top")]},
            "the boundaries 'bottom' and 'top' are nowhere next to each other",
        ),
        (
            {"basis": BODIES, "head": {"p:left": 2.0}},
            r"no head is given in the part of the ground around \(4, 0\), 15",
        ),
        (
            {
                "basis": BODIES,
                "head": {"p:left": 2.0},
                "connected": [("p:right", "q:left"), ("q:left", "p:right")],
            },
            "in a circle",
        ),
        (
            {
                "basis": Basis(MESH.translated((-1.0, 0.0)), ElementTriP1()),
                "coordinates": "axisymmetric",
            },
            "axial symmetry needs x >= 0, but there are elements at x = -",
        ),
        (
            {"basis": BASIS.with_elements("a"), "head": {"right": 1.0}},
            "'right' has no node of the porous ground",
        ),
    ],
)
def test_bad_input(changes, message):
    arguments = {"basis": BASIS, "permeability": 1e-5, "head": HEADS, "unit_weight": 9.81} | changes
    with pytest.raises(ValueError, match=message):
        steady(**arguments)


@pytest.mark.parametrize(
    ("law", "options", "message"),
    [
        (sc.water.Ramp, {"width": 0.0}, "width must be a finite number above 0"),
        (sc.water.Ramp, {"width": np.nan}, "width must be a finite number, not nan"),
        (sc.water.Ramp, {"least": 0.0}, "least must be a finite number above 0 and below 1"),
        (sc.water.VanGenuchten, {"alpha": -1.0, "n": 2.0}, "alpha must be a finite number above 0"),
        (sc.water.VanGenuchten, {"alpha": 1.0, "n": 1.0}, "n must be a finite number above 1"),
        (
            sc.water.VanGenuchten,
            {"alpha": 1.0, "n": 2.0, "least": 2.0},
            "least must be a finite number above 0 and below",
        ),
    ],
)
def test_bad_retention(law, options, message):
    with pytest.raises(ValueError, match=message):
        law(**options)


def test_bad_questions_to_a_result():
    water = sc.water.Flow(BASIS, 1e-5, unit_weight=9.81).steady(sc.water.Conditions(head=HEADS))
    with pytest.raises(ValueError, match="no boundary 'wall'; existing: bottom, left, right, top"):
        water.discharge("wall")
    with pytest.raises(ValueError, match="no subdomain 'c'; existing: a, b"):
        water.discharge("left", of="c")
    with pytest.raises(
        ValueError, match="no boundary through which water passes 'top'; existing: left, right"
    ):
        water.flux("top")
    with pytest.raises(
        ValueError, match=r"1 points lie outside of the porous ground, the first is \(5, 1\)"
    ):
        water.head_at(np.array([[1.0, 5.0], [1.0, 1.0]]))


def test_ends_of_long_elements_are_told() -> None:
    """Heads at ends that `with_defaults` names wrongly would shorten the way of the water."""
    long = MeshQuad.init_tensor(np.arange(5.0), np.array([0.0, 100.0])).with_defaults()
    with pytest.warns(sc.AnalysisWarning, match="contain sides along their axis"):
        sc.water.Flow(Basis(long, ElementQuad1()), 1e-4, unit_weight=10.0)
