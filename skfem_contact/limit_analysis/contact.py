"""Contacts of both bounds: joints between facets that coincide, which the other side's nodes are put into first."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree
from skfem import MeshTri

from .elements import Elements
from .strength import Interface
from .triangles import Triangles, facet_lengths, outward_normals

#: Distance of two nodes, as a share of a facet, that are made one place.
_SAME = 1e-3
#: Largest distance of a node from the other side's facet, as a share of it, that is closed: chords of curved faces.
_GAP = 0.1


@dataclass(frozen=True)
class Contact:
    """Two boundaries that touch; adhesion, friction and tensile strength; `tied` ones do not part at all.

    Attributes
    ----------
    slave, master
        Tags of the facets.
    """

    slave: str
    master: str
    a: float = 0.0
    mu: float = 0.0
    tension: float = 0.0
    reduced: bool = False
    tied: bool = False


def matched(contacts: tuple[Contact, ...], triangles: Triangles) -> Triangles:
    """Triangles whose contacts match: each side has got the nodes of the other one."""
    for contact in contacts:
        for one, other in ((contact.slave, contact.master), (contact.master, contact.slave)):
            while (cuts := _missing(triangles, one, other)) is not None:
                triangles = triangles.halved(*cuts)
        triangles = _closed(triangles, contact)
    return triangles


def _missing(triangles: Triangles, one: str, other: str) -> tuple[ndarray, ndarray] | None:
    """Facets of one side that hold a node of the other, and the one that is nearest to the middle of each."""
    mesh, facets = triangles.mesh, triangles.tags[one]
    nodes = np.unique(mesh.facets[:, triangles.tags[other]])
    along, away = _local(triangles, facets, nodes)
    inside = (along > _SAME) & (along < 1 - _SAME) & (np.abs(away) < _GAP)
    distance = np.where(inside, np.abs(along - 0.5), np.inf)
    nearest = distance.argmin(axis=1)
    cut = inside.any(axis=1)
    return (facets[cut], mesh.p[:, nodes[nearest[cut]]]) if cut.any() else None


def _local(triangles: Triangles, facets: ndarray, nodes: ndarray) -> tuple[ndarray, ndarray]:
    """Places of nodes along facets and away from them, as shares of their lengths, (n_facets, n_nodes)."""
    mesh = triangles.mesh
    a, b = mesh.p[:, mesh.facets[:, facets]].transpose(1, 0, 2)
    d = b - a
    x = mesh.p[:, None, nodes] - a[:, :, None]
    square = (d**2).sum(axis=0)[:, None]
    along = (x * d[:, :, None]).sum(axis=0) / square
    return along, (d[0][:, None] * x[1] - d[1][:, None] * x[0]) / square


def _closed(triangles: Triangles, contact: Contact) -> Triangles:
    """The slave's nodes moved onto those of the master that they nearly coincide with."""
    mesh = triangles.mesh
    slave, master = (np.unique(mesh.facets[:, triangles.tags[tag]]) for tag in (contact.slave, contact.master))
    distance, nearest = map(np.asarray, cKDTree(mesh.p[:, master].T).query(mesh.p[:, slave].T))
    size = facet_lengths(mesh)[triangles.tags[contact.slave]].min(initial=np.inf)
    near = (distance > 0) & (distance <= 2 * _SAME * size)
    if not near.any():
        return triangles
    p = mesh.p.copy()
    p[:, slave[near]] = p[:, master[nearest[near]]]
    return replace(triangles, mesh=MeshTri(p, mesh.t, validate=False))


def pairs(contact: Contact, triangles: Triangles) -> tuple[ndarray, ndarray, ndarray]:
    """Facets of slave and master that coincide, and whether the master's run the other way."""
    mesh, one, other = triangles.mesh, triangles.tags[contact.slave], triangles.tags[contact.master]
    if not len(one) or not len(other):
        return np.zeros(0, int), np.zeros(0, int), np.zeros(0, bool)
    middle, length = mesh.p[:, mesh.facets].mean(axis=1), facet_lengths(mesh)[one]
    distance, nearest = map(np.asarray, cKDTree(middle[:, other].T).query(middle[:, one].T))
    found = distance <= 1e-9 * length
    one, other = one[found], other[nearest[found]]
    ends = mesh.p[:, mesh.facets[0, one]] - mesh.p[:, mesh.facets[0, other]]
    return one, other, np.linalg.norm(ends, axis=0) > 0.5 * length[found]


class Joint(NamedTuple):
    """Facets of slave and master that coincide, (n,), operators, unknowns and strength; the normal is the slave's."""

    slave: ndarray
    master: ndarray
    B: ndarray
    dofs: ndarray
    strength: Interface


def joined(contacts: tuple[Contact, ...], triangles: Triangles, elements: Elements) -> tuple[list[Joint], ndarray]:
    """Contacts that can part or slip; and of the others the pairs of velocities that are the same, (2, n)."""
    joints, tied = [], [np.zeros((2, 0), int)]
    for contact in contacts:
        one, other, turned = pairs(contact, triangles)
        sides = elements.facets[one], elements.on_facets(other, turned)
        if contact.tied:
            tied.append(np.stack([dofs.ravel() for dofs in sides]))
        elif len(one):
            jump = _jumps(contact, triangles, elements, one)
            of_points = (np.full(jump.shape[0] * jump.shape[1], x)
                         for x in (contact.a, contact.mu, contact.tension, contact.reduced))
            joints.append(Joint(one, other, np.concatenate([-jump, jump], axis=3),
                                np.hstack([dofs.reshape(len(one), -1) for dofs in sides]), Interface(*of_points)))
    return joints, np.hstack(tied)


def _jumps(contact: Contact, triangles: Triangles, elements: Elements, slave: ndarray) -> ndarray:
    """Opening, slip and nothing times weight, of the master's velocities, (n, n_points, 3, n_local)."""
    normal = outward_normals(triangles.mesh, slave, triangles.mesh.f2t[0, slave])
    tangent = np.stack([-normal[1], normal[0]])
    smooth = contact.a == 0 and contact.mu == 0
    axes = np.stack([normal, 0.0 * tangent if smooth else tangent, 0 * normal]).transpose(2, 0, 1)
    weight = facet_lengths(triangles.mesh)[slave] / len(elements.jump)
    jump = np.einsum("pl,fic,f->fpilc", elements.jump, axes, weight)
    return jump.reshape(*jump.shape[:3], -1)
