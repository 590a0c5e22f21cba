"""Bodies in space that face each other, shared by the tests."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy import ndarray
from skfem import (
    Basis,
    ElementHex1,
    ElementHex2,
    ElementHexS2,
    ElementTetP1,
    ElementTetP2,
    ElementVector,
    Mesh,
    MeshHex,
    MeshTet,
)

import skfem_contact as sc

#: Every supported element in space with a mesh that it lives on.
ELEMENTS = {
    "P1": (MeshTet, ElementTetP1),
    "P2": (MeshTet, ElementTetP2),
    "Q1": (MeshHex, ElementHex1),
    "Q2": (MeshHex, ElementHex2),
    "S2": (MeshHex, ElementHexS2),
}


def vector_basis(mesh: Mesh, element: str, **options) -> Basis:
    """Displacements in elements of a name of :data:`ELEMENTS`."""
    return Basis(mesh, ElementVector(ELEMENTS[element][1]()), **options)


def block(element: str, x: ndarray, y: ndarray, z: ndarray) -> Mesh:
    """A block with the boundaries left, right, front, back, bottom, top: scikit-fem's names for x, y, z."""
    mesh = ELEMENTS[element][0].init_tensor(*(np.asarray(c, float) for c in (x, y, z)))
    (x0, y0, z0), (x1, y1, z1) = mesh.p.min(axis=1), mesh.p.max(axis=1)
    return mesh.with_boundaries({
        "left": lambda p: np.isclose(p[0], x0), "right": lambda p: np.isclose(p[0], x1),
        "front": lambda p: np.isclose(p[1], y0), "back": lambda p: np.isclose(p[1], y1),
        "bottom": lambda p: np.isclose(p[2], z0), "top": lambda p: np.isclose(p[2], z1),
    })  # fmt: skip


def moved(mesh: Mesh, motion) -> Mesh:
    """The mesh with its nodes moved, (3, n) to displacements (3, n)."""
    return replace(mesh, doflocs=mesh.doflocs + motion(mesh.doflocs))


def facing(element: str, rng: np.random.Generator, n: int = 2, m: int = 3, bump: float = 0.03) -> Basis:
    """A rough block of m^3 elements upon another one of n^3, within its rim: "upper:bottom" on "lower:top"."""
    line = np.linspace(0.0, 1.0, n + 1)
    lower = block(element, line, line, line)
    upper = block(element, np.linspace(0.13, 0.87, m + 1), np.linspace(0.17, 0.83, m + 1), np.linspace(1, 2, m + 1))
    lower, upper = (moved(mesh, lambda p: bump * rng.standard_normal(p.shape)) for mesh in (lower, upper))
    return vector_basis(sc.join_bodies({"lower": lower, "upper": upper}), element)


def unknowns_of(basis: Basis, body: str) -> ndarray:
    """The unknowns of a subdomain, (n, 3): one row a node."""
    return np.unique(basis.element_dofs[:, basis.mesh.subdomains[body]]).reshape(-1, 3)


def resultant(basis: Basis, x: ndarray, force: ndarray) -> ndarray:
    """Sum of nodal forces and their moment about the origin in the current configuration, (6,)."""
    f = force.reshape(-1, 3)
    place = basis.doflocs[:, ::3].T + x.reshape(-1, 3)
    return np.concatenate((f.sum(axis=0), np.cross(place, f).sum(axis=0)))


def turned(basis: Basis, rotation: ndarray, x: ndarray) -> ndarray:
    """Displacements that turn everything, displaced by x already, about the origin."""
    places = basis.doflocs[:, ::3].T + x.reshape(-1, 3)
    return (places @ rotation.T - basis.doflocs[:, ::3].T).ravel()
