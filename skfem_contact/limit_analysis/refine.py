"""Where meshes are refined: where the dissipation exceeds the power of the stresses, and around singular points."""
from __future__ import annotations

import numpy as np
from numpy import ndarray

from .model import Model
from .triangles import Triangles

#: Share of the gap that lies in the triangles which are refined.
_SHARE = 0.5
#: Triangles around a singular point, at most: with 40 of them N_c comes to 0.2 % from below (4.50 of 5.14 with four).
_FAN = 40
#: Distance, of bodies of size one, below which nodes are at a singular point.
_HERE = 1e-9
#: Interior angle from which a corner of the ground is singular, in degrees, and at which loads and supports may change.
_REENTRANT, _LEVEL = 185.0, 150.0


def gap_of_elements(dissipation: ndarray, stress: ndarray, strain: ndarray) -> ndarray:
    """Dissipation less the power of the stresses of the lower bound, by triangle: their sum is the gap.

    All are values at the corners, (n, 3, ...); dissipation and strain times weight.
    """
    mass = (np.ones((3, 3)) + np.eye(3)) / 4  # of linear functions, over a third of the area
    return np.abs(dissipation.sum(axis=1) - np.einsum("evc,ewc,vw->e", stress, strain, mass))


def gap_of_facets(dissipation: ndarray, tractions: ndarray, jump: ndarray) -> ndarray:
    """The same by facet of a contact, with tractions (normal, tangential) at its ends, (n, 2, 2).

    Jumps are quadratic: they are given, times weight, by their Bernstein coefficients, (n, 3, 3).
    """
    mass = np.array([[0.75, 0.25, 0.5], [0.25, 0.75, 0.5]])
    return np.abs(dissipation.sum(axis=1) - np.einsum("fsc,fpc,sp->f", tractions, jump[..., :2], mass))


def marked(gap: ndarray) -> ndarray:
    """Triangles with the largest shares of the gap, which together hold a given share of it."""
    order = np.argsort(-gap, kind="stable")
    count = np.searchsorted(np.cumsum(gap[order]), _SHARE * gap.sum()) + 1
    return np.sort(order[:count])


def fanned(triangles: Triangles, points: ndarray) -> Triangles:
    """Twice as many triangles around singular points, (2, n), until there are enough."""
    mesh = triangles.mesh
    count = np.bincount(mesh.t.ravel(), minlength=mesh.nvertices)
    away = np.linalg.norm(mesh.p[:, None] - points[:, :, None], axis=0)  # (n_points, n_nodes); bodies have one each
    few = np.flatnonzero((away < _HERE).any(axis=0) & (count < _FAN))
    return triangles.fanned(few) if len(few) else triangles


def singular_points(model: Model, triangles: Triangles) -> ndarray:
    """Corners that point into the ground, and where loads or supports change along its surface, (2, n)."""
    mesh, rigid = triangles.mesh, model.rigid[triangles.origin]
    soft = np.where(mesh.f2t >= 0, rigid[mesh.f2t] < 0, False)
    edge = np.flatnonzero(soft[0] != soft[1])  # of what can yield
    kind = _kinds(model, triangles)[edge]
    order = np.argsort(mesh.facets[:, edge].ravel(), kind="stable")
    nodes, facet = mesh.facets[:, edge].ravel()[order], np.tile(np.arange(len(edge)), 2)[order]
    same = np.flatnonzero(nodes[1:] == nodes[:-1])
    vertex, one, other = nodes[same], facet[same], facet[same + 1]
    angle = _interior_angles(triangles, rigid)[vertex]
    differ = kind[one] != kind[other]
    pushed = differ[:, 2:-1].any(axis=1)  # a load or a contact ends
    changes = pushed | (differ.any(axis=1) & (angle > _LEVEL))
    return mesh.p[:, np.unique(vertex[changes | (angle > _REENTRANT)])]


def _kinds(model: Model, triangles: Triangles) -> ndarray:
    """What is given on every facet: which supports, loads and contacts, and a rigid body beside it."""
    mesh, tags = triangles.mesh, triangles.tags
    names = [("held", 0), ("held", 1), *(t.tag for t in model.loads.tractions)]
    names += [tag for contact in model.contacts for tag in (contact.slave, contact.master)]
    kinds = np.zeros((mesh.nfacets, len(names) + 1), bool)
    for i, name in enumerate(names):
        kinds[tags[name], i] = True
    kinds[:, -1] = (np.where(mesh.f2t >= 0, model.rigid[triangles.origin][mesh.f2t], -1) >= 0).any(axis=0)
    return kinds


def _interior_angles(triangles: Triangles, rigid: ndarray) -> ndarray:
    """Sum of the angles of all triangles that can yield at every vertex, in degrees."""
    t = triangles.mesh.t[:, rigid < 0]
    corner = triangles.mesh.p[:, t]
    (ax, ay), (bx, by) = (np.roll(corner, -k, axis=1) - corner for k in (1, 2))
    angle = np.degrees(np.arctan2(np.abs(ax * by - ay * bx), ax * bx + ay * by))
    return np.bincount(t.ravel(), angle.ravel(), minlength=triangles.mesh.nvertices)
