"""A limit-analysis model on straight triangles, and its discretisation for either bound."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray

from .contact import Contact, joined
from .elements import Block, Elements, Layout, gradients
from .loading import Distributed
from .program import Program
from .strength import Soil, Strength
from .triangles import Triangles, outward_normals


@dataclass(frozen=True)
class Model:
    """What carries and what loads; lengths and stresses are of order one.

    All arrays have one value for each element of the first mesh, (n_first,): triangles know their `origin`.

    Attributes
    ----------
    triangles
        The first mesh; facets that are held are tagged ``("held", component)``.
    soil
        Strength.
    rigid
        Number of the rigid body that an element belongs to, -1 for none: these have pores.
    loads
        What acts.
    contacts
        Boundaries that touch.
    """

    triangles: Triangles
    soil: Soil
    rigid: ndarray
    loads: Distributed
    contacts: tuple[Contact, ...] = ()

    def power(self, triangles: Triangles, elements: Elements) -> tuple[ndarray, ndarray]:
        """Power of the fixed and of the multiplied loads, (n,) each."""
        total = [elements.of_body(forces[triangles.origin]) for forces in (self.loads.dead, self.loads.live)]
        for tag, value, live in self.loads.tractions:
            facets = triangles.tags[tag]
            places = triangles.mesh.p[:, triangles.mesh.facets[:, facets]]  # (2, 2 ends, n)
            values = np.asarray(value(places.reshape(2, -1))).reshape(places.shape).T
            total[live] += elements.of_tractions(facets, values)
        if self.loads.water is not None:
            total[0] += self._power_of_water(self.loads.water(triangles.mesh.p), triangles, elements)
        return total[0], total[1]

    def _power_of_water(self, u: ndarray, triangles: Triangles, elements: Elements) -> ndarray:
        r"""Power of water: :math:`\int u\, {\rm div}\, v` in the pores less :math:`\int u\, n v` where it presses.

        The pressure is interpolated linearly in every triangle; by parts, it is a body force -grad u and a traction u n
        on all facets that bound the pores.
        """
        mesh, porous = triangles.mesh, self.rigid[triangles.origin] < 0
        body = -np.einsum("ie,eic->ec", u[mesh.t], gradients(mesh)[0]) * porous[:, None]
        inside = np.where(mesh.f2t >= 0, porous[mesh.f2t], False)
        edge = np.flatnonzero(inside[0] != inside[1])
        wetted = np.concatenate([np.zeros(0, int), *(triangles.tags[tag] for tag in self.loads.wetted)])
        facets = np.append(edge, wetted)
        side = np.append(inside[1, edge], np.zeros(len(wetted), bool)).astype(int)
        sign = np.repeat([1.0, -1.0], (len(edge), len(wetted)))
        normal = outward_normals(mesh, facets, mesh.f2t[side, facets])
        pressed = (sign * u[mesh.facets[:, facets]]).T[:, :, None] * normal.T[:, None]
        return elements.of_body(body) + elements.of_tractions(facets, pressed)


def discretise(model: Model, triangles: Triangles, elements: Elements) -> Program:
    """The program of the bound that some elements give, on a refinement of the first mesh whose contacts match."""
    rigid = model.rigid[triangles.origin]
    soft = np.flatnonzero(rigid < 0)
    joints, tied = joined(model.contacts, triangles, elements)
    parts = [(elements.B[soft], elements.dofs[soft]), *((joint.B, joint.dofs) for joint in joints)]
    strengths: list[Strength] = [model.soil.at(np.repeat(triangles.origin[soft], 3)), *(j.strength for j in joints)]
    held = [elements.facets[triangles.tags["held", k], :, k].ravel() for k in (0, 1)]
    used = np.concatenate([dofs.ravel() for _, dofs in parts])
    unknowns = Layout.of(elements, used, np.concatenate(held), tied, rigid)
    blocks: list[Block] = []
    first = 0
    for B, dofs in parts:
        n, at_each = B.shape[:2]
        blocks += unknowns.reduced(B, first + np.arange(n * at_each).reshape(n, at_each), dofs)
        first += n * at_each
    dead, live = (unknowns.matrix.T @ f for f in model.power(triangles, elements))
    return Program(blocks, strengths, unknowns, dead, live, soft, joints)
