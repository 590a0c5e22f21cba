"""Numbers of iterations of small analyses against those that are on record: they must not creep up.

Write the present numbers down, after a change that is meant to alter them, with::

    python -m tests.nonlinear.test_iterations_on_record
"""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from skfem import FacetBasis, LinearForm, MeshQuad

import skfem_contact as sc
from skfem_contact.results import Result
from tests.tools.helpers import grid, vector_basis

BASELINE = Path(__file__).parent / "baseline" / "iterations.json"
#: Growth that is let pass: round-off on another machine may cost an iteration in ten.
GROWTH = 1.1


def blocks(quadrature: str | int) -> int:
    """A block is pressed onto another one and pushed along it until it slips."""
    base = grid("Q1", np.linspace(0, 4, 25), np.linspace(0, 1, 7))
    block = grid("Q1", np.linspace(1, 2.5, 14), np.linspace(1, 2, 9))
    basis = vector_basis(sc.join_bodies({"base": base, "block": block}), "Q1", intorder=2)
    forms = {
        "blocks": sc.SolidForm(basis, sc.LinearElastic(E=1e5, nu=0.3)),
        "joint": sc.ContactPair(
            basis, "block:bottom", "base:top", sc.Coulomb(mu=0.3), quadrature=quadrature
        ),
    }
    top = basis.get_dofs("block:top")
    down = basis.zeros()
    down[top.all("u^2")] = -0.01
    along = down.copy()
    along[top.all("u^1")] = 0.012
    stages = [
        sc.Stage("pressed", basis.zeros(), prescribed=down),
        sc.Stage("pushed", basis.zeros(), prescribed=along, increments=6),
    ]
    return total(
        sc.Model(forms, basis.get_dofs({"base:bottom", "block:top"}).all(), solver="superlu").run(
            stages
        )
    )


def culvert() -> int:
    """The culvert of the tutorial, both stages."""
    welded = sc.load_mesh(files("skfem_contact") / "data" / "culvert.msh")
    mesh = sc.join_bodies(welded, bodies={"ground": ["soft", "stiff"], "culvert": "culvert"})
    basis = vector_basis(mesh, "Q1", intorder=2)
    soils = {
        "soft": sc.MohrCoulomb(E=1e4, nu=0.40, c=5.0, phi=25.0),
        "stiff": sc.MohrCoulomb(E=5e4, nu=0.35, c=10.0, phi=35.0),
    }
    forms = {
        "ground": sc.SolidForm(basis.with_elements("ground"), soils, strain="b_bar"),
        "culvert": sc.SolidForm(basis.with_elements("culvert"), sc.LinearElastic(E=2.8e7, nu=0.2)),
        "skin": sc.ContactPair(
            basis,
            "ground|culvert",
            "culvert|ground",
            sc.Coulomb(mu=0.6),
            "nodal",
            smoothing=0.5,
            initial="adjusted",
        ),
    }
    gravity = sc.weight(basis, {"soft": 18.0, "stiff": 20.0, "culvert": 25.0})
    surface = FacetBasis(mesh, basis.elem, facets="surface")
    strip = LinearForm(lambda v, w: -35.0 * v[1] * (w.x[0] > 0.0) * (w.x[0] < 1.8)).assemble(
        surface
    )
    fixed = np.concatenate(
        (basis.get_dofs("bottom").all(), basis.get_dofs({"left", "right"}).all("u^1"))
    )
    stages = [sc.Stage("gravity", gravity), sc.Stage("surcharge", gravity + strip)]
    return total(sc.Model(forms, fixed, solver="superlu").run(stages))


def cylinder() -> int:
    """An elastic arch is pressed onto a block of the same stiffness (Hertz)."""
    s = np.linspace(-1, 1, 41)
    arch = grid("Q1", s, np.linspace(0, 1, 9))
    arch = arch.morphed(lambda p: p[0], lambda p: p[1] + (1.0 - p[1]) * (0.002 + 0.125 * p[0] ** 2))
    block = grid("Q1", np.linspace(-1, 1, 33), np.linspace(-1, 0, 9))
    basis = vector_basis(sc.join_bodies({"block": block, "arch": arch}), "Q1", intorder=2)
    forms = {
        "bodies": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.3)),
        "joint": sc.ContactPair(
            basis, "arch:bottom", "block:top", sc.Coulomb(mu=0.0), quadrature=2
        ),
    }
    x = basis.zeros()
    x[basis.get_dofs("arch:top").all("u^2")] = -0.03
    fixed = basis.get_dofs({"block:bottom", "arch:top"}).all()
    stage = sc.Stage("pressed", basis.zeros(), prescribed=x, increments=4)
    return total(sc.Model(forms, fixed, solver="superlu").run([stage]))


def pin() -> int:
    """A pin falls through its clearance into a hole; the first trials press it in far too deep."""
    mesh = sc.join_bodies({"pin": ring(0.2, 1.0, 90), "plate": ring(1.02, 3.0, 108)})
    around = {"skin": (0.99, 1.01), "hole": (1.01, 1.03), "rim": (2.9, 3.0)}
    mesh = mesh.with_boundaries(
        {
            name: lambda x, a=a, b=b: (a < np.hypot(*x)) & (np.hypot(*x) < b)
            for name, (a, b) in around.items()
        }
    )
    basis = vector_basis(mesh, "Q1", intorder=2)
    forms = {
        "steel": sc.SolidForm(basis, sc.LinearElastic(E=2e5, nu=0.3), strain="b_bar"),
        "joint": sc.ContactPair(basis, "skin", "hole", sc.Coulomb(mu=0.2), quadrature=2),
    }
    stage = sc.Stage("pull", sc.weight(basis, {"pin": 200.0}))
    return total(sc.Model(forms, basis.get_dofs("rim").all(), solver="superlu").run([stage]))


def ring(inner: float, outer: float, n: int) -> MeshQuad:
    """A ring of elements, `n` around and eight across."""
    i, j = np.meshgrid(np.arange(8), np.arange(n), indexing="ij")
    corners = [(i + a) * n + (j + b) % n for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    r, angle = np.meshgrid(
        np.geomspace(inner, outer, 9), 2 * np.pi * np.arange(n) / n, indexing="ij"
    )
    places = np.stack((r * np.cos(angle), r * np.sin(angle)))
    return MeshQuad(places.reshape(2, -1), np.stack(corners).reshape(4, -1))


def slope() -> int:
    """The slope of Griffiths and Lane on a coarse mesh, its strength reduced to collapse."""
    square = grid("P2", np.linspace(0, 1, 15), np.linspace(0, 1, 8))
    mesh = square.morphed(lambda p: p[0] * (32.0 - 20.0 * p[1]), lambda p: 10.0 * p[1])
    basis = vector_basis(mesh, "P2", intorder=2)
    forms = {
        "slope": sc.SolidForm(basis, sc.MohrCoulomb(E=1e5, nu=0.3, c=10.0, phi=20.0, psi=20.0))
    }
    fixed = np.concatenate((basis.get_dofs("bottom").all(), basis.get_dofs("left").all("u^1")))
    found = sc.Model(forms, fixed, solver="superlu").strength_reduction(sc.weight(basis, 20.0))
    return found.iterations


def total(result: Result) -> int:
    return sum(sum(stage.iterations) for stage in result)


SCENES: dict[str, Callable[[], int]] = {
    "blocks, nodal": lambda: blocks("nodal"),
    "blocks, two Gauss points": lambda: blocks(2),
    "blocks, segments": lambda: blocks("segments"),
    "culvert": culvert,
    "cylinder": cylinder,
    "pin": pin,
    "slope, strength reduction": slope,
}


@pytest.mark.parametrize("scene", SCENES)
def test_no_more_iterations_than_on_record(scene: str) -> None:
    """[N] At most a tenth more iterations than when they were written down."""
    recorded = json.loads(BASELINE.read_text())[scene]
    assert SCENES[scene]() <= GROWTH * recorded


def test_every_record_has_its_scene() -> None:
    """The record is that of these scenes."""
    assert set(json.loads(BASELINE.read_text())) == set(SCENES)


if __name__ == "__main__":
    BASELINE.parent.mkdir(exist_ok=True)
    BASELINE.write_text(
        json.dumps({name: scene() for name, scene in SCENES.items()}, indent=2) + "\n"
    )
