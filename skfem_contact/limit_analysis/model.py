"""A limit-analysis model on straight triangles, and its discretisation for either bound."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from .contact import Contact, Joint, joints, tied_velocities
from .elements import Elements
from .normal_matrix import Block
from .program import Program
from .strength import Soil
from .triangles import Tag, Triangles, outward_normals
from .unknowns import Unknowns

#: A traction or a pressure: a function of places (2, n).
Field = Callable[[ndarray], ndarray]


class Traction(NamedTuple):
    """A traction on named facets, (2, n) at places (2, n), and whether it is multiplied."""

    tag: Tag
    value: Field
    live: bool


class Water(NamedTuple):
    """Pressure, positive, of places (2, n); elements with pores, (n_first,); facets that it presses on from outside."""

    pressure: Field
    porous: ndarray
    wetted: tuple[Tag, ...]


@dataclass(frozen=True)
class Model:
    """What carries and what loads; lengths and stresses are of order one.

    All arrays have one value for each element of the first mesh, (n_first,): triangles know their `origin`.

    Attributes
    ----------
    triangles
        The first mesh; facets that are held are tagged ``("held", component)``.
    c, t, tension
        Strength; of rigid elements it has no meaning.
    reduced
        Whether the factor acts.
    rigid
        Number of the rigid body that an element belongs to, -1 for none.
    dead, live
        Body forces that are fixed, and multiplied, (n_first, 2).
    tractions, water, contacts
        On facets, by tags.
    """

    triangles: Triangles
    c: ndarray
    t: ndarray
    tension: ndarray
    reduced: ndarray
    rigid: ndarray
    dead: ndarray
    live: ndarray
    tractions: tuple[Traction, ...] = ()
    water: Water | None = None
    contacts: tuple[Contact, ...] = ()

    def loads(self, triangles: Triangles, elements: Elements) -> tuple[ndarray, ndarray]:
        """Power of the fixed and of the multiplied loads, (n,) each."""
        none = np.zeros(0, int), np.zeros((0, 2, 2))
        total = [elements.load(body[triangles.origin], *none) for body in (self.dead, self.live)]
        weightless = np.zeros((len(triangles.origin), 2))
        for tag, value, live in self.tractions:
            facets = triangles.tags[tag]
            places = triangles.mesh.p[:, triangles.mesh.facets[:, facets]]  # (2, 2 ends, n)
            values = np.asarray(value(places.reshape(2, -1))).reshape(places.shape).T
            total[live] += elements.load(weightless, facets, values)
        if self.water is not None:
            total[0] += _power_of_water(self.water, triangles, elements)
        return total[0], total[1]


class Discretisation(NamedTuple):
    """A program, the elements it is made of, and their unknowns."""

    program: Program
    elements: Elements
    unknowns: Unknowns
    soft: ndarray  # elements that can yield, in the order of their points
    joints: tuple[Joint, ...]  # in the order of their points, which follow


def discretise(model: Model, triangles: Triangles, kind: type[Elements]) -> Discretisation:
    """The program of one bound on a mesh.

    Parameters
    ----------
    model
        What carries and what loads.
    triangles
        A refinement of its first mesh, with contacts that match.
    kind
        :class:`~.elements.StressElements` or :class:`~.elements.VelocityElements`.
    """
    elements = kind(triangles.mesh)
    rigid = model.rigid[triangles.origin]
    soft = np.flatnonzero(rigid < 0)
    points = 3 * np.arange(len(soft))[:, None] + np.arange(3)
    parts = [(elements.B[soft], points, elements.dofs[soft])]
    strengths: list = [_soil(model, triangles.origin[soft])]
    first = points.size
    found = tuple(joints(model.contacts, triangles, elements))
    for joint in found:
        n = len(joint.strength.reduced)
        parts.append((joint.B, first + np.arange(n).reshape(len(joint.B), -1), joint.dofs))
        strengths.append(joint.strength)
        first += n
    held = [elements.on_facets(triangles.tags["held", k])[..., k].ravel() for k in (0, 1)]
    bodies = [elements.of_elements(np.flatnonzero(rigid == b)) for b in range(model.rigid.max() + 1)]
    used = np.concatenate([dofs.ravel() for _, _, dofs in parts])
    unknowns = Unknowns.of(elements, used, np.concatenate(held), tied_velocities(model.contacts, triangles, elements),
                           bodies)
    blocks: list[Block] = [block for part in parts for block in unknowns.reduced(*part)]
    dead, live = (unknowns.matrix.T @ f for f in model.loads(triangles, elements))
    return Discretisation(Program(blocks, strengths, unknowns.places, dead, live), elements, unknowns, soft,
                          found)


def _soil(model: Model, origin: ndarray) -> Soil:
    """Strength at the corners of triangles."""
    return Soil(*(np.repeat(x[origin], 3) for x in (model.c, model.t, model.tension, model.reduced)))


def _power_of_water(water: Water, triangles: Triangles, elements: Elements) -> ndarray:
    r"""Power of water: :math:`\int u\, {\rm div}\, v` in the pores less :math:`\int u\, n v` where it presses.

    The pressure is interpolated linearly in every triangle; by parts, it is a body force -grad u and a traction u n on
    all facets that bound the pores.
    """
    mesh = triangles.mesh
    u = water.pressure(mesh.p)
    porous = water.porous[triangles.origin]
    body = -np.einsum("ie,eic->ec", u[mesh.t], elements.gradient) * porous[:, None]
    inside = np.where(mesh.f2t >= 0, porous[mesh.f2t], False)
    edge = np.flatnonzero(inside[0] != inside[1])
    wetted = np.concatenate([np.zeros(0, int), *(triangles.tags[tag] for tag in water.wetted)])
    power = np.zeros(elements.n)
    for facets, sign, side in ((edge, 1.0, inside[1, edge].astype(int)), (wetted, -1.0, np.zeros(len(wetted), int))):
        normal = outward_normals(mesh, facets, mesh.f2t[side, facets])
        values = sign * u[mesh.facets[:, facets]].T[:, :, None] * normal.T[:, None]
        power += elements.load(body if facets is edge else 0 * body, facets, values)
    return power
