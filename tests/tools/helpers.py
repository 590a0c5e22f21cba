"""Meshes, bodies along a line, and finite differences, shared by the tests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementHexS2,
    ElementQuad1,
    ElementQuad2,
    ElementQuadS2,
    ElementTetP1,
    ElementTetP2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    LinearForm,
    Mesh,
    MeshHex,
    MeshQuad,
    MeshTet,
    MeshTri,
)

import skfem_contact as sc
from skfem_contact.contact.interface import ContactState
from skfem_contact.contact.search import Projection, project
from skfem_contact.surfaces.material_points import MaterialPoints, along_chain

#: Every supported element with a mesh that it lives on, in the plane and in space.
ELEMENTS = {
    "P1": (MeshTri, ElementTriP1),
    "P2": (MeshTri, ElementTriP2),
    "Q1": (MeshQuad, ElementQuad1),
    "Q2": (MeshQuad, ElementQuad2),
    "QuadS2": (MeshQuad, ElementQuadS2),
}
IN_SPACE = {
    "P1": (MeshTet, ElementTetP1),
    "P2": (MeshTet, ElementTetP2),
    "Q1": (MeshHex, ElementHex1),
    "Q2": (MeshHex, ElementHex2),
    "S2": (MeshHex, ElementHexS2),
}


def vector_basis(mesh: Mesh, element: str, **options) -> Basis:
    """Displacements in elements of a name of :data:`ELEMENTS`, or of :data:`IN_SPACE`."""
    names = ELEMENTS if mesh.dim() == 2 else IN_SPACE
    return Basis(mesh, ElementVector(names[element][1]()), **options)


def grid(element: str, x: ndarray, y: ndarray) -> Mesh:
    """A tensor grid with the boundaries left, right, bottom and top."""
    return (
        ELEMENTS[element][0].init_tensor(np.asarray(x, float), np.asarray(y, float)).with_defaults()
    )


def traction(basis: Basis, facets: str, force) -> ndarray:
    """Load vector of a uniform traction (dim,) on a boundary."""
    form = LinearForm(lambda v, w: sum(f * v[k] for k, f in enumerate(force)))
    return form.assemble(FacetBasis(basis.mesh, basis.elem, facets=facets))


@dataclass(frozen=True)
class Springs(sc.Form):
    """Linear springs between unknowns, or to the ground."""

    matrix: csr_matrix

    def assemble(self, x, state):
        return sc.Response(self.matrix @ x, lambda: None, lambda: self.matrix)


def distorted(mesh: Mesh, rng: np.random.Generator, amount: float) -> Mesh:
    """The mesh with every node moved at random."""
    return replace(mesh, doflocs=mesh.doflocs + amount * rng.uniform(-1, 1, mesh.doflocs.shape))


def line_normals(line: ndarray, closed: bool = False) -> ndarray:
    """Unit normals to the left of a line at its nodes, (n, 2)."""
    before, after = np.roll(line, 1, axis=0), np.roll(line, -1, axis=0)
    if not closed:
        before[0], after[-1] = line[0], line[-1]
    tangent = after - before
    return (
        np.stack((-tangent[:, 1], tangent[:, 0]), axis=1) / np.linalg.norm(tangent, axis=1)[:, None]
    )


def body_along(
    line: ndarray, element: str = "Q1", thickness: float = 1.0, closed: bool = False
) -> Mesh:
    """One layer of elements to the right of a line, which becomes the boundary "face".

    Parameters
    ----------
    line
        Points of the line, (n, 2); the outward normal of the face is on its left.
    element
        Name of :data:`ELEMENTS`; triangles are quadrilaterals cut in two.
    thickness
        Of the layer.
    closed
        Whether the last point is joined to the first.
    """
    line = np.asarray(line, float)
    n = len(line)
    inner = line - thickness * line_normals(line, closed)
    a = np.arange(n if closed else n - 1)
    b = (a + 1) % n
    p = np.vstack((line, inner)).T
    quads = np.stack((a, b, b + n, a + n))
    if ELEMENTS[element][0] is MeshTri:
        mesh = MeshTri(p, np.hstack((quads[[0, 1, 2]], quads[[0, 2, 3]])))
    else:
        mesh = MeshQuad(p, quads)
    face = np.flatnonzero((mesh.facets < n).all(axis=0))
    return mesh.with_boundaries({"face": face})


def facing(slave: Mesh, master: Mesh, element: str = "Q1") -> Basis:
    """A basis of two bodies with the boundaries "slave:face" and "master:face"."""
    return vector_basis(sc.join_bodies({"slave": slave, "master": master}), element)


def unknowns_of(basis: Basis, body: str) -> ndarray:
    """The unknowns of a subdomain, (n, dim): one row a node."""
    dofs = np.unique(basis.element_dofs[:, basis.mesh.subdomains[body]])
    return dofs.reshape(-1, basis.mesh.dim())


def dofs_at(basis: Basis, body: str, point: tuple[float, float]) -> ndarray:
    """The two unknowns of the node of a body at a place."""
    dofs = unknowns_of(basis, body)
    distance = np.linalg.norm(basis.doflocs[:, dofs[:, 0]].T - np.asarray(point), axis=1)
    assert distance.min() < 1e-9, f"no node of '{body}' at {point}"
    return dofs[np.argmin(distance)]


def rotation(degrees: float) -> ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])


def moved_rigidly(
    basis: Basis, degrees: float, shift: tuple[float, float], x: ndarray | None = None
) -> ndarray:
    """Displacements that turn everything, displaced by x already, about the origin and shift it."""
    x = basis.zeros() if x is None else x
    present = basis.doflocs[:, ::2].T + x.reshape(-1, 2)
    return (present @ rotation(degrees).T + shift - basis.doflocs[:, ::2].T).ravel()


def rough_pair(
    element: str,
    quadrature: str | int,
    law: sc.Coulomb | sc.Tied,
    rng: np.random.Generator,
    **options,
) -> tuple[Basis, sc.ContactPair, ndarray, ContactState]:
    """Two bodies that overlap along a bent line, displaced at random, with stick points at random.

    The master of five segments is both convex and concave; the slave's four segments lie within its
    ends.
    """
    t = np.linspace(0, 3, 6)
    floor = np.stack((t, 0.25 * np.sin(2.2 * t)), axis=1)
    s = np.linspace(2.55, 0.4, 5)
    roof = np.stack((s, 0.25 * np.sin(2.2 * s) - 0.06), axis=1)
    basis = facing(body_along(roof, element, 0.6), body_along(floor, element, 0.6), element)
    options = {"penalty": (1e3, 7e2), **options}
    pair = sc.ContactPair(basis, "slave:face", "master:face", law, quadrature, **options)
    x = 0.02 * rng.standard_normal(basis.N)
    return basis, pair, x, slipped(pair.initial_state(), 0.05, rng)


def slipped(state: ContactState, amount: float, rng: np.random.Generator) -> ContactState:
    """The state with its stick points moved at random, by about an amount where facets have the
    length one.
    """
    return replace(
        state, stick_point=state.stick_point + 2 * amount * rng.standard_normal(state.slip.shape)
    )


def arcs(pair: sc.ContactPair, points: MaterialPoints) -> ndarray:
    """Arc positions of material points of a pair's master in the plane, NaN of those that are
    none.
    """
    return np.where(points.exist, along_chain(pair.master, *points), np.nan)


def sticking_at(pair: sc.ContactPair, state: ContactState, arc: ndarray) -> ContactState:
    """The state with stick points at arc positions of a master with straight facets."""
    length = pair.master.area
    start = np.concatenate(([0.0], np.cumsum(length)[:-1]))
    facet = np.clip(np.searchsorted(start, arc, side="right") - 1, 0, len(start) - 1)
    return state.with_stick(
        MaterialPoints(facet, (2 * (arc - start[facet]) / length[facet] - 1)[:, None])
    )


def closest(pair: sc.ContactPair, state: ContactState, x: ndarray) -> Projection:
    """Closest points on the master of the points of a state at the displacements x, at any
    depth.
    """
    points = pair.points(state).positions(pair.slave.positions(x))
    depth = np.full(len(points), np.inf)
    return project(pair.master, pair.master.positions(x), points, depth, state.facet)


def directional_error(
    force: Callable[[ndarray], ndarray], K, x: ndarray, directions: ndarray, h: float
) -> float:
    """Largest difference of ``K d`` and the central difference of the force over the largest ``K
    d``.
    """
    exact = np.array([K @ d for d in directions])
    numeric = np.array([(force(x + h * d) - force(x - h * d)) / (2 * h) for d in directions])
    return float(np.abs(exact - numeric).max() / np.abs(exact).max())


def resultant(basis: Basis, x: ndarray, force: ndarray) -> ndarray:
    """Sum of nodal forces and their moment about the origin in the current configuration, (3,), or
    (6,) in space.
    """
    dim = basis.mesh.dim()
    f, present = force.reshape(-1, dim), basis.doflocs[:, ::dim].T + x.reshape(-1, dim)
    moment = present[:, 0] * f[:, 1] - present[:, 1] * f[:, 0] if dim == 2 else np.cross(present, f)
    return np.append(f.sum(axis=0), moment.sum(axis=0))


def analysis(name: str, /, forms: dict, fixed, *load, newton=None, solver=None, **settings):
    """Result of a method of the model of some forms and supports."""
    return getattr(sc.Model(forms, fixed, newton=newton, solver=solver), name)(*load, **settings)


def run_stages(forms: dict, stages: list, fixed, newton=None, solver=None, **settings):
    """Result of the stages of a scene."""
    return sc.Model(forms, fixed, newton=newton, solver=solver).run(stages, **settings)


def bounds_of(forms: dict, fixed, **settings):
    """Bounds of the model of some forms and supports."""
    return sc.Model(forms, fixed).bounds(**settings)


class PlainLaw:
    """A law behind a class that knows nothing of the package, with memory by number alone."""

    n_internal = 1

    def __init__(self, law):
        self._law = law

    def elasticity(self, ncomp):
        return self._law.elasticity(ncomp)

    def update(self, strain_increment, stress, internal):
        return self._law.update(strain_increment, stress, internal)


def two_soils(element: str) -> Basis:
    """A square of two subdomains, a to the left of b."""
    kind = MeshTri if element[0] == "P" else MeshQuad
    mesh = (
        kind.init_tensor(np.linspace(0, 1, 4), np.linspace(0, 1, 4))
        .with_defaults()
        .with_subdomains({"a": lambda x: x[0] < 0.5, "b": lambda x: x[0] >= 0.5})
    )
    return vector_basis(mesh, element, intorder=4)


def check_tangent_of_water(water, E: float, coordinates: str) -> tuple[sc.Form, ndarray]:
    """Compare the tangent of water in elastic soil with central differences; return its form and
    the displacements.
    """
    basis, rng = water.ground, np.random.default_rng(0)
    solid = sc.SolidForm(basis, sc.LinearElastic(E=E, nu=0.2), coordinates=coordinates)
    form = (
        sc.Model({"soil": solid, "water": water}, basis.get_dofs("bottom").all())
        .forms["water"]
        .over(0.7)
    )
    scale = np.append(np.full(form.first, 1e-2), np.full(form.size - form.first, 3.0))
    x, along = scale * rng.standard_normal((2, form.size))
    state, step = form.initial_state(0.3 * x), 1e-6
    ahead, behind = (form.assemble(x + sign * step * along, state).force for sign in (1, -1))
    expected, found = (ahead - behind) / (2 * step), form.assemble(x, state).stiffness @ along
    for part in (slice(0, form.first), slice(form.first, None)):
        np.testing.assert_allclose(
            found[part], expected[part], atol=1e-7 * np.abs(expected[part]).max()
        )
    return form, x


def counted(monkeypatch: pytest.MonkeyPatch, owner: object, name: str) -> list[int]:
    """Count the calls of a function: the length of the list."""
    calls: list[int] = []
    function: Callable = getattr(owner, name)

    def call(*args, **kwargs):
        calls.append(1)
        return function(*args, **kwargs)

    monkeypatch.setattr(owner, name, call)
    return calls
