"""Every enforcement with every element, dimension, law, start and kind of supports: two blocks
under uniform stress, whose force and pressure are known in closed form.

Cells are chosen so that each element meets every pair of method, law, start and supports, and in
the slow part every three of them.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import astuple, dataclass

import numpy as np
import pytest
from skfem import Mesh

import skfem_contact as sc
from tests.tools.helpers import ELEMENTS, IN_SPACE, vector_basis

PLANE = {"Tri3": "P1", "Tri6": "P2", "Quad4": "Q1", "Quad8": "QuadS2", "Quad9": "Q2"}
SPACE = {"Tet4": "P1", "Tet10": "P2", "Hex8": "Q1", "Hex20": "S2", "Hex27": "Q2"}
METHODS = {
    "penalty": None,
    "augmented": sc.AugmentedLagrangian(),
    "multipliers": sc.DualMultipliers(),
}
#: Pressures err by the rotation of the joint under shear, P / E, with the penalty; by the tolerance
#: of the augmented method; by multipliers beyond the motions of a rigid slave.
ACCURACY = {"penalty": 1e-6, "augmented": 1e-3, "multipliers": 1e-5}
LAWS = {
    "friction": sc.Coulomb(0.5),
    "bond": sc.Coulomb(0.5, adhesion=8.0, tension=20.0),
    "tied": sc.Tied(),
}
STARTS = ("as meshed", "fit", "gap")
ENDS = ("free", "held", "rigid")
E, PRESSURE, SHEAR = 1e6, 10.0, 3.0
GAP, FIT = 1e-4, 2e-5
#: Approach of the far ends in two stages; at the end only bonds have a traction.
APPROACHES = (2e-5, -8e-6)


@dataclass(frozen=True)
class Cell:
    """A block of two elements below one of other elements, with the joint between them."""

    element: str
    dimension: str
    method: str
    law: str
    start: str
    ends: str

    def __str__(self) -> str:
        return "-".join(astuple(self))

    @property
    def dim(self) -> int:
        return 3 if self.dimension == "space" else 2

    @property
    def nu(self) -> float:
        return 0.0 if self.ends == "rigid" else 0.3

    @property
    def bonded(self) -> bool:
        return self.law != "friction"

    @property
    def modulus(self) -> float:
        """Modulus of a block between its ends, whose sides are free or held."""
        nu = self.nu
        if self.ends == "held":
            return E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
        return E / (1 - nu**2) if self.dimension == "plane" else E

    @property
    def shear(self) -> float:
        """Uniform shear stress besides the pressure, where such a state exists."""
        exists = self.ends == "free" and self.dimension != "axisymmetric"
        return SHEAR if exists and self.start == "as meshed" else 0.0

    @property
    def refused(self) -> bool:
        """True for facets of eight nodes, whose corners have negative areas."""
        return self.element == "Hex20" and self.method != "penalty"


def cells(slow: bool) -> Iterator[Cell]:
    """Yield an orthogonal array for each element: nine cells for pairs, or further ones, of 27."""
    kinds = [*itertools.product(PLANE, ("plane", "axisymmetric"))]
    kinds += itertools.product(SPACE, ("space",))
    for number, kind in enumerate(kinds):
        first, second = divmod(number, 3)
        pairs = [
            (a, b, (a + b + first) % 3, (a + 2 * b + second) % 3)
            for a, b in itertools.product(range(3), repeat=2)
        ]
        threes = [
            (a, b, c, (number - a - b - c) % 3) for a, b, c in itertools.product(range(3), repeat=3)
        ]
        for a, b, c, d in [row for row in threes if row not in pairs] if slow else pairs:
            yield Cell(*kind, list(METHODS)[a], list(LAWS)[b], STARTS[c], ENDS[d])


def block(cell: Cell, n: tuple[int, ...], low: float, high: float) -> Mesh:
    """One layer of elements between two heights, n of them along each side."""
    name = (PLANE | SPACE)[cell.element]
    kind = (ELEMENTS if cell.dim == 2 else IN_SPACE)[name][0]
    mesh = kind.init_tensor(*[np.linspace(0, 1, k + 1) for k in n], np.array([low, high]))
    up = cell.dim - 1
    planes = {"left": (0, 0.0), "right": (0, 1.0), "bottom": (up, low), "top": (up, high)}
    if cell.dim == 3:
        planes |= {"front": (1, 0.0), "back": (1, 1.0)}
    return mesh.with_boundaries(
        {side: lambda x, i=i, at=at: np.abs(x[i] - at) < 1e-9 for side, (i, at) in planes.items()}
    )


def supports(cell: Cell, basis, top: float) -> list[np.ndarray]:
    """Dofs that hold the blocks from below, from the sides or at single nodes, without stress."""
    names = [f"u^{i + 1}" for i in range(cell.dim)]
    held = [basis.get_dofs("low:bottom").all(names[-1])]
    sides = {"left": 0, "right": 0, "front": 1, "back": 1} if cell.ends == "held" else {}
    if cell.dimension == "axisymmetric":
        sides |= {"left": 0}
    for side, component in sides.items():
        if cell.dim == 3 or component == 0:
            both = {f"low:{side}", f"up:{side}"}
            held.append(basis.get_dofs(both).all(names[component]))
    if sides:
        return held

    # Hold a corner of each block, the upper one by friction under shear; in space against turning
    for height in (-1.0,) if cell.shear else (-1.0, top):
        corners = {0: (0.0, 0.0, height), 1: (1.0, 0.0, height)} if cell.dim == 3 else {}
        corner = (0.0, 0.0, height) if cell.dim == 3 else (0.0, height)
        for point, components in (
            (corner, range(cell.dim - 1)),
            *[(p, (1,)) for p in corners.values()],
        ):
            distance = np.linalg.norm(basis.doflocs.T - point, axis=1)
            dofs = np.flatnonzero(distance < 1e-9)
            held.extend(dofs[[i]] for i in components)
    return held


def pressed(cell: Cell):
    """The model, its stages, and the pressure and shear after each of them."""
    gap = GAP if cell.start == "gap" else 0.0
    upper = (1, 2) if cell.dim == 3 else (3,)
    bodies = {
        "low": block(cell, (2, 1)[: cell.dim - 1], -1.0, 0.0),
        "up": block(cell, upper, gap, 1.0 + gap),
    }
    basis = vector_basis(sc.join_bodies(bodies), (PLANE | SPACE)[cell.element], intorder=4)
    options = {"coordinates": "axisymmetric"} if cell.dimension == "axisymmetric" else {}
    joint = sc.ContactPair(
        basis,
        "up:bottom",
        "low:top",
        LAWS[cell.law],
        enforcement=METHODS[cell.method],
        initial=FIT if cell.start == "fit" else "as meshed",
    )
    forms = {
        "solid": sc.SolidForm(basis, sc.LinearElastic(E=E, nu=cell.nu), **options),
        "joint": joint,
    }
    if cell.ends == "rigid":
        rotates = cell.dimension != "axisymmetric"
        forms["rigid"] = sc.RigidBoundary(basis, "up:bottom", rotates=rotates)
    held = supports(cell, basis, 1.0 + gap)
    top = basis.get_dofs("up:top").all(f"u^{cell.dim}")
    if cell.start != "as meshed":
        held.append(top)
    model = sc.Model(forms, np.unique(np.concatenate(held)))

    # Loads give the stress
    if cell.start == "as meshed":
        expected = [(PRESSURE, cell.shear), ((-0.4 if cell.bonded else 0.7) * PRESSURE, cell.shear)]
        loads = [uniform(model, cell, *stress) for stress in expected]
        stages = [sc.Stage(f"{k}", load) for k, load in enumerate(loads)]
        return model, basis, stages, expected

    # Given displacements compress both blocks, and the penalty between them
    compliance = 2.0 / cell.modulus
    if cell.method == "penalty":
        compliance += 1.0 / model.forms["joint"].penalty[0]
    start = FIT if cell.start == "fit" else -GAP
    if cell.start == "gap" and cell.law == "tied":
        start = 0.0
    stages, expected = [], []
    for k, approach in enumerate(APPROACHES):
        x = basis.zeros()
        x[top] = start - approach
        stages.append(sc.Stage(f"{k}", prescribed=x))
        acts = approach > 0.0 or cell.bonded
        expected.append((approach / compliance if acts else 0.0, 0.0))
    return model, basis, stages, expected


def uniform(model: sc.Model, cell: Cell, pressure: float, shear: float) -> np.ndarray:
    """Tractions on all sides by which both blocks have the same uniform stress."""
    up, along = np.eye(cell.dim)[-1], np.eye(cell.dim)[0]
    load = model.traction("up:top", tuple(shear * along - pressure * up))
    if shear:
        load = load - model.traction("low:bottom", tuple(shear * along))
        for body in ("low", "up"):
            load = load + model.traction(f"{body}:right", tuple(shear * up))
            load = load - model.traction(f"{body}:left", tuple(shear * up))
    return load


def check(cell: Cell) -> None:
    """Compare tractions, resultants and reactions of all stages with the exact ones, or refuse."""
    if cell.refused:
        with pytest.raises(ValueError, match=r"facets of eight nodes.*or the penalty method"):
            pressed(cell)
        return
    model, basis, stages, expected = pressed(cell)
    area = 0.5 if cell.dimension == "axisymmetric" else 1.0  # per radian
    for stage, (pressure, shear) in zip(model.run(stages, progress=False), expected, strict=True):
        joint, report = stage.tractions("joint"), stage.contact("joint")
        sheared = joint.shear if cell.dim == 2 else np.linalg.norm(joint.shear, axis=1)
        bottom = basis.get_dofs("low:bottom").all(f"u^{cell.dim}")
        found = {
            "pressure": (joint.pressure, pressure),
            "shear": (np.abs(sheared), shear),
            "force": (joint.weight @ joint.pressure, pressure * area),
            "report": (np.abs(report.force[cell.dim - 1]), abs(pressure) * area),
            "reaction": (stage.reactions()[bottom].sum(), pressure * area),
        }
        for name, (value, exact) in found.items():
            np.testing.assert_allclose(
                value, exact, atol=ACCURACY[cell.method] * PRESSURE, rtol=0.0, err_msg=name
            )


@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize("cell", list(cells(slow=False)), ids=str)
def test_uniform_stress_in_every_pair_of_settings(cell: Cell) -> None:
    """[X] Pressure, shear, force and reactions of uniform stress, in compression and then less of
    it, in tension or apart; or one sentence that refuses.
    """
    check(cell)


@pytest.mark.slow
@pytest.mark.exhaustive
@pytest.mark.filterwarnings("ignore::skfem_contact.AnalysisWarning")
@pytest.mark.parametrize("cell", list(cells(slow=True)), ids=str)
def test_uniform_stress_in_every_three_settings(cell: Cell) -> None:
    """[X] The same for further combinations."""
    check(cell)


def test_all_pairs_are_among_the_cells() -> None:
    """Every two of all settings meet, at least 300 times in all."""
    fast, slow = set(cells(slow=False)), set(cells(slow=True))
    assert len(fast) == 135 and len(fast | slow) >= 300
    settings = {
        "element": [*PLANE, *SPACE],
        "dimension": ["plane", "axisymmetric", "space"],
        "method": list(METHODS),
        "law": list(LAWS),
        "start": STARTS,
        "ends": ENDS,
    }
    for (one, values), (other, others) in itertools.combinations(settings.items(), 2):
        met = {(getattr(cell, one), getattr(cell, other)) for cell in fast}
        possible = set(itertools.product(values, others))
        if (one, other) == ("element", "dimension"):
            possible = {(e, d) for e, d in possible if (e in SPACE) == (d == "space")}
        assert met == possible
