"""Contacts of both bounds: joints between facets that coincide, which the other side's nodes are put into first."""
from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

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
    name
        For messages.
    slave, master
        Tags of the facets.
    """

    name: str
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
    distance, nearest = _nearest(mesh.p[:, slave], mesh.p[:, master])
    size = facet_lengths(mesh)[triangles.tags[contact.slave]].min(initial=np.inf)
    near = (distance > 0) & (distance <= 2 * _SAME * size)
    if not near.any():
        return triangles
    p = mesh.p.copy()
    p[:, slave[near]] = p[:, master[nearest[near]]]
    return triangles.moved(p)


def _nearest(points: ndarray, others: ndarray) -> tuple[ndarray, ndarray]:
    """Distance of every point from the nearest one of the others, and which one it is."""
    distance, which = cKDTree(others.T).query(points.T)
    return np.asarray(distance), np.asarray(which)


def pairs(contact: Contact, triangles: Triangles) -> tuple[ndarray, ndarray, ndarray]:
    """Facets of slave and master that coincide, and whether the master's run the other way."""
    mesh = triangles.mesh
    one, other = triangles.tags[contact.slave], triangles.tags[contact.master]
    middle = mesh.p[:, mesh.facets].mean(axis=1)
    if not len(one) or not len(other):
        return np.zeros((2, 0), int)[0], np.zeros(0, int), np.zeros(0, bool)
    distance, nearest = _nearest(middle[:, one], middle[:, other])
    found = distance <= 1e-9 * facet_lengths(mesh)[one]
    one, other = one[found], other[nearest[found]]
    ends = mesh.p[:, mesh.facets[0, one]] - mesh.p[:, mesh.facets[0, other]]
    return one, other, np.linalg.norm(ends, axis=0) > 0.5 * facet_lengths(mesh)[one]


class Joint(NamedTuple):
    """Facets of slave and master that coincide, (n,), operators, unknowns and strength; the normal is the slave's."""

    slave: ndarray
    master: ndarray
    B: ndarray
    dofs: ndarray
    strength: Interface


def joints(contacts: tuple[Contact, ...], triangles: Triangles, elements: Elements) -> Iterator[Joint]:
    """All contacts that can part or slip."""
    for contact in contacts:
        one, other, turned = pairs(contact, triangles)
        if contact.tied or not len(one):
            continue
        normal = outward_normals(triangles.mesh, one, triangles.mesh.f2t[0, one])
        tangent = np.stack([-normal[1], normal[0]])
        smooth = contact.a == 0 and contact.mu == 0
        axes = np.stack([normal, 0.0 * tangent if smooth else tangent, 0 * normal]).transpose(2, 0, 1)
        shares, weight = elements.jumps(one)
        jump = np.einsum("pl,fic,f->fpilc", shares, axes, weight).reshape(len(one), len(shares), 3, -1)
        dofs = [elements.on_facets(one).reshape(len(one), -1), elements.on_facets(other, turned).reshape(len(one), -1)]
        n = jump.shape[0] * jump.shape[1]
        strength = Interface(*(np.full(n, x) for x in (contact.a, contact.mu, contact.tension, contact.reduced)))
        yield Joint(one, other, np.concatenate([-jump, jump], axis=3), np.hstack(dofs), strength)


def tied_velocities(contacts: tuple[Contact, ...], triangles: Triangles, elements: Elements) -> ndarray:
    """Pairs of velocities that are the same, (2, n)."""
    tied = [np.zeros((2, 0), int)]
    for contact in contacts:
        if contact.tied:
            one, other, turned = pairs(contact, triangles)
            tied.append(np.stack([elements.on_facets(one).ravel(), elements.on_facets(other, turned).ravel()]))
    return np.unique(np.hstack(tied), axis=1)
