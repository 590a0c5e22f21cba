"""Bodies in space that face each other, shared by the tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy import ndarray
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementQuad1,
    ElementQuad2,
    ElementVector,
    Mesh,
    MeshHex,
)

import skfem_contact as sc
from skfem_contact.contact.penalty import choose_penalties
from skfem_contact.results import Result
from tests.tools.helpers import IN_SPACE, run_stages, vector_basis


def block(element: str, x: ndarray, y: ndarray, z: ndarray) -> Mesh:
    """A block with the boundaries left, right, front, back, bottom, top: scikit-fem's names for x,
    y, z.
    """
    mesh = IN_SPACE[element][0].init_tensor(*(np.asarray(c, float) for c in (x, y, z)))
    (x0, y0, z0), (x1, y1, z1) = mesh.p.min(axis=1), mesh.p.max(axis=1)
    return mesh.with_boundaries(
        {
            "left": lambda p: np.isclose(p[0], x0),
            "right": lambda p: np.isclose(p[0], x1),
            "front": lambda p: np.isclose(p[1], y0),
            "back": lambda p: np.isclose(p[1], y1),
            "bottom": lambda p: np.isclose(p[2], z0),
            "top": lambda p: np.isclose(p[2], z1),
        }
    )


def moved(mesh: Mesh, motion) -> Mesh:
    """The mesh with its nodes moved, (3, n) to displacements (3, n)."""
    return replace(mesh, doflocs=mesh.doflocs + motion(mesh.doflocs))


def facing(
    element: str, rng: np.random.Generator, n: int = 2, m: int = 3, bump: float = 0.03
) -> Basis:
    """A rough block of m^3 elements upon another one of n^3, within its rim: "upper:bottom" on
    "lower:top".
    """
    line = np.linspace(0.0, 1.0, n + 1)
    lower = block(element, line, line, line)
    upper = block(
        element,
        np.linspace(0.13, 0.87, m + 1),
        np.linspace(0.17, 0.83, m + 1),
        np.linspace(1, 2, m + 1),
    )
    lower, upper = (
        moved(mesh, lambda p: bump * rng.standard_normal(p.shape)) for mesh in (lower, upper)
    )
    return vector_basis(sc.join_bodies({"lower": lower, "upper": upper}), element)


def turned(basis: Basis, rotation: ndarray, x: ndarray) -> ndarray:
    """Displacements that turn everything, displaced by x already, about the origin."""
    places = basis.doflocs[:, ::3].T + x.reshape(-1, 3)
    return (places @ rotation.T - basis.doflocs[:, ::3].T).ravel()


# -- plane cases as slices: one element thick, held in their plane


def sliced(mesh: Mesh, thickness: float = 0.3) -> MeshHex:
    """A mesh of quadrilaterals as one layer of hexahedra; boundaries and subdomains keep their
    names.
    """
    n = mesh.p.shape[1]
    p = np.hstack([np.vstack((mesh.p, np.full((1, n), z))) for z in (0.0, thickness)])
    base, order = mesh.t, [(0, 0), (1, 0), (3, 0), (0, 1), (2, 0), (1, 1), (3, 1), (2, 1)]
    solid = MeshHex(p, np.array([base[corner] + level * n for corner, level in order]))
    ends = {frozenset(f): k for k, f in enumerate(solid.facets.T.tolist())}
    names = {
        name: [ends[frozenset((a, b, a + n, b + n))] for a, b in mesh.facets[:, facets].T.tolist()]
        for name, facets in mesh.boundaries.items()
    }
    solid = solid.with_boundaries({name: np.array(facets) for name, facets in names.items()})
    return solid.with_subdomains(mesh.subdomains) if mesh.subdomains else solid


#: Elements of a slice of others, and the shares of a load that its layers of nodes take.
_TWINS = {ElementQuad1: (ElementHex1, [1, 1]), ElementQuad2: (ElementHex2, [1, 4, 1])}


class Slice:
    """An analysis of quadrilaterals in plane strain, with contact, once more as a slice one element
    thick.

    Contact has the penalties that the plane has: elements are as stiff in both, but sizes of facets
    differ.
    """

    def __init__(self, forms: dict[str, sc.Form], thickness: float = 0.3) -> None:
        plane = next(form.basis for form in forms.values() if isinstance(form, sc.SolidForm))
        element, weights = _TWINS[type(plane.elem.elem)]
        points = round(np.sqrt(plane.dx.shape[1]))
        self.basis = Basis(
            sliced(plane.mesh, thickness), ElementVector(element()), intorder=2 * points - 1
        )
        # nodes of an element follow each other alike in all: those of one tell
        dofs, flat = self.basis.element_dofs, plane.element_dofs
        at, below = self.basis.doflocs[:2, dofs[:, 0]], plane.doflocs[:, flat[:, 0]]
        same = np.isclose(at[:, :, None], below[:, None]).all(axis=0) & (
            dofs[:, :1] % 3 == flat[:, 0] % 2
        )
        self.twin = np.full(self.basis.N, -1)
        self.twin[dofs[same.any(axis=1)]] = flat[same.argmax(axis=1)[same.any(axis=1)]]
        level = np.unique(self.basis.doflocs[2].round(9), return_inverse=True)[1]
        self.share = thickness * np.array(weights)[level] / sum(weights)
        self.forms = {name: self._form(form) for name, form in choose_penalties(forms).items()}

    def _form(self, form: sc.Form) -> sc.Form:
        if isinstance(form, sc.SolidForm):
            names = self.basis.mesh.subdomains or {}
            given = (
                form.materials if set(form.materials) <= set(names) else form.regions[0].material
            )
            return sc.SolidForm(self.basis, given, "b_bar" if form.strain == "b_bar" else "full")
        pair = sc.ContactPair(
            self.basis,
            form.slave.name,
            form.facets.name,
            form.law,
            form.quadrature,
            enforcement=form.enforcement,
            initial=form.initial,
            share=form.share,
        )
        return pair.with_penalty(*form.penalty, stiffness=form.stiffness)

    def lifted(self, plane: ndarray | None) -> ndarray | None:
        """Displacements in space of those in the plane."""
        return (
            None if plane is None else np.where(self.twin >= 0, np.asarray(plane)[self.twin], 0.0)
        )

    def run(self, stages: Sequence[sc.Stage], fixed: ndarray, **options) -> Result:
        """The analysis of the slice."""
        stages = [
            replace(
                stage,
                load=self.share * self.lifted(stage.load),
                prescribed=self.lifted(stage.prescribed),
            )
            for stage in stages
        ]
        fixed = np.flatnonzero(np.isin(self.twin, fixed) | (self.twin < 0))
        return run_stages(self.forms, stages, fixed, progress=False, **options)

    def compare(self, plane: Result, solid: Result, error: float) -> None:
        """Displacements of all stages are those of the plane, but for a share of the largest."""
        largest = max(np.abs(stage.x).max() for stage in plane)
        for one, other in zip(plane, solid, strict=True):
            np.testing.assert_allclose(
                other.x, self.lifted(one.x), rtol=0, atol=error * largest, err_msg=one.name
            )
