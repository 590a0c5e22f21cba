"""Half models beside whole ones: a round body is pressed onto a block, and released in part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.spatial import cKDTree
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementQuad1,
    ElementQuad2,
    ElementTetP1,
    ElementTetP2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    Mesh,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.results import StageResult
from skfem_contact.results.tractions import Tractions

from .cases import Case, Check, apart

KINDS = {
    "Q1": (MeshQuad, ElementQuad1),
    "Q2": (MeshQuad, ElementQuad2),
    "P1": (MeshTri, ElementTriP1),
    "P2": (MeshTri, ElementTriP2),
    "Hex8": (MeshHex, ElementHex1),
    "Hex27": (MeshHex, ElementHex2),
    "Tet4": (MeshTet, ElementTetP1),
    "Tet10": (MeshTet, ElementTetP2),
}
SECOND_ORDER = ("Q2", "P2", "Hex27", "Tet10")
METHODS = {
    "penalty": None,
    "augmented": sc.AugmentedLagrangian(),
    "multipliers": sc.DualMultipliers(),
}
#: Half the width of the block and of the body, and its height.
BLOCK, BODY, HEIGHT = 4.0, 3.0, 2.0


@dataclass(frozen=True)
class Pressed:
    """A body of a radius on a block, with friction; numbers of elements along both, of a half."""

    element: str
    method: str
    mu: float
    radius: float
    stiffer: float
    depth: float
    elements: tuple[int, int]

    def __str__(self) -> str:
        return (
            f"half of a body of radius {self.radius:.1f} pressed by {self.depth:.3f}, "
            f"{self.elements[0]} on {self.elements[1]}, mu {self.mu:.2f}, {self.element}, "
            f"{self.method}, stiffer by {self.stiffer:.1f}"
        )

    @property
    def dim(self) -> int:
        return KINDS[self.element][0].elem.refdom.dim()

    def grid(self, half: float, n: int, low: float, layers: int, mirrored: bool) -> Mesh:
        """Mesh of one body: the half at positive x, with its image if asked for."""
        kind = KINDS[self.element][0]
        across = [np.linspace(0.0, half, n + 1)] * (self.dim - 1)
        mesh = kind.init_tensor(*across, np.linspace(low, low + HEIGHT, layers + 1))
        if mirrored:
            image = mesh.mirrored(tuple(np.eye(self.dim)[0]))
            exact = np.hstack((mesh.p, image.p)).T
            mesh = mesh + image  # scikit-fem rounds to eight decimals
            nearest = cKDTree(exact).query(mesh.p.T)[1]
            mesh = replace(mesh, doflocs=exact[nearest].T.copy())
        ends = {"bottom": low, "top": low + HEIGHT}
        return mesh.with_boundaries(
            {name: lambda x, z=z: np.abs(x[-1] - z) < 1e-9 for name, z in ends.items()}
        )

    def model(self, whole: bool) -> tuple[Basis, dict[str, sc.Form], np.ndarray]:
        """Basis, forms and supports: the top of the body and the bottom of the block, and planes of
        symmetry; the whole model is held across at the ends of its middle alone.
        """
        body = self.grid(BODY, self.elements[0], 0.0, 2, whole)
        share = 1.0 - body.p[-1] / HEIGHT
        round_one = body.p.copy()
        round_one[-1] += share * (body.p[:-1] ** 2).sum(axis=0) / (2.0 * self.radius)
        block = self.grid(BLOCK, self.elements[1], -HEIGHT, 3, whole)
        mesh = sc.join_bodies({"block": block, "body": replace(body, doflocs=round_one)})
        order = 4 if self.element in SECOND_ORDER else 2
        basis = Basis(mesh, ElementVector(KINDS[self.element][1]()), intorder=order)
        soft, stiff = (sc.LinearElastic(E=1e4 * factor, nu=0.3) for factor in (1.0, self.stiffer))
        forms = {
            "solid": sc.SolidForm(basis, {"block": soft, "body": stiff}),
            "joint": sc.ContactPair(
                basis,
                "body:bottom",
                "block:top",
                sc.Coulomb(self.mu),
                enforcement=METHODS[self.method],
            ),
        }

        up = f"u^{self.dim}"
        fixed = [basis.get_dofs(side).all(up) for side in ("body:top", "block:bottom")]
        for k in range(self.dim - 1):
            dofs = basis.get_dofs(elements=True).all(f"u^{k + 1}")
            places = basis.doflocs[:, dofs]
            held = np.abs(places[k]) < 1e-9
            if whole and k == 0:
                held &= np.abs(places[-1]) > HEIGHT - 1e-9
            fixed.append(dofs[held])
        return basis, forms, np.unique(np.concatenate(fixed))

    def stages(self, whole: bool) -> tuple[Basis, list[StageResult]]:
        """Press the body down, and take back a third."""
        basis, forms, fixed = self.model(whole)
        model = sc.Model(forms, fixed)
        x = basis.zeros()
        x[basis.get_dofs("body:top").all(f"u^{self.dim}")] = -self.depth
        path = [sc.Stage("press", prescribed=x, increments=2), sc.Stage("back", prescribed=x / 1.5)]
        return basis, list(model.run(path, progress=False))


def half(seed: int, rng: np.random.Generator) -> Case:
    """Draw a body that is pressed onto a block."""
    most_elements = {"Q1": 18, "Q2": 9, "P1": 18, "P2": 9, "Hex8": 5}
    element = str(rng.choice(list(most_elements), p=[0.25, 0.2, 0.2, 0.2, 0.15]))
    most = most_elements[element]
    radius, width = float(rng.uniform(10.0, 60.0)), float(rng.uniform(1.2, 2.2))
    n, below = (int(rng.integers(most // 2 + 1, most + 1)) for _ in range(2))
    drawn = Pressed(
        element=element,
        method=str(rng.choice(list(METHODS))),
        mu=float(rng.uniform(0.1, 0.8)),
        radius=radius,
        stiffer=float(10 ** rng.uniform(-0.5, 2.0)),
        depth=width**2 / radius,
        elements=(n, below),
    )
    return Case(seed, str(drawn), partial(same, drawn))


def same(drawn: Pressed) -> Iterator[Check]:
    """Twice the forces, the same displacements and pressures, and no more shear at the plane.

    Both have the same penalties and cuts, so that tolerances are left: measured 5e-6 of the
    displacements, 3e-5 of the friction and 8e-6 of the shear in 60 scenes.
    """
    (part, halves), (whole, wholes) = (drawn.stages(k) for k in (False, True))
    image = half_of(part, whole)
    for one, both in zip(halves, wholes, strict=True):
        size = np.abs(both.x[: whole.N]).max()
        yield Check("half", np.abs(one.x[: part.N] - both.x[image]).max() / size, 1e-3)
        found, right = one.contact("joint"), both.contact("joint")
        force = right.force[-1]
        yield Check("half force", apart(2.0 * found.force[-1], force), 1e-3)
        friction = abs(2.0 * found.friction - right.friction)
        yield Check("half friction", friction / (drawn.mu * force), 5e-3)
        joint, beside = one.tractions("joint"), both.tractions("joint")
        largest = beside.pressure.max()
        yield Check("half pressure", apart(joint.pressure.max(), largest), 1e-2)
        more = _shear_on_plane(joint) - _shear_on_plane(beside)
        yield Check("half shear", more / (drawn.mu * largest), 1e-2)


def _shear_on_plane(joint: Tractions) -> float:
    """Return the largest shear across the plane beside it."""
    near = np.abs(joint.x) < 0.1
    return float(np.abs(joint.shear.reshape(len(near), -1)[near, 0]).max(initial=0.0))


def half_of(part: Basis, whole: Basis) -> np.ndarray:
    """Return the number in the whole model of each dof of the half."""
    numbers = {row: k for k, row in enumerate(_rows(whole))}
    return np.array([numbers[row] for row in _rows(part)])


def _rows(basis: Basis) -> list[tuple[float, ...]]:
    """Return coordinates, component and body of each dof."""
    component, body = np.zeros(basis.N), np.zeros(basis.N)
    for k in range(len(basis.doflocs)):
        component[basis.get_dofs(elements=True).all(f"u^{k + 1}")] = k
    body[basis.get_dofs(elements="body").all()] = 1
    rows = np.vstack((basis.doflocs.round(6) + 0.0, component, body)).T
    return [tuple(row) for row in rows.tolist()]
