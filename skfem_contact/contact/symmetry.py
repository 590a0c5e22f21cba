"""Planes of symmetry at which a slave ends, as supports show them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy import ndarray

from ..surfaces.surface import Surface
from ..surfaces.vectors import frame, unit
from .quadrature import ON_PLANE

#: Square of the cosine between a direction of slip and supports that hold it.
_ALONG = 0.99
#: Square of the cosine between a normal and a support across which the surface may continue.
_ACROSS = 0.5


class Plane(NamedTuple):
    """A plane of symmetry across an axis at which some nodes of a slave lie.

    Tractions across it are odd: their mirror images have the other sign, a mask (dim,).
    """

    axis: int
    coordinate: float
    odd: ndarray
    nodes: ndarray

    def now(self, positions: ndarray) -> tuple[int, float]:
        """Return axis and coordinate at present positions of the slave's nodes, (n_nodes, dim)."""
        return self.axis, float(positions[self.nodes, self.axis].mean())


@dataclass(frozen=True, eq=False)
class Symmetry:
    """Nodes of a slave that supports hold along the surface, as the master on the same plane.

    Across a plane of symmetry nothing slips, and no friction acts: a multiplier would act on the
    master's inside alone, and its equations would nearly be equations of its neighbours. Supports
    that move the two sides apart are no such plane.

    Attributes
    ----------
    along : ndarray, shape (dim - 1, n_nodes)
        Mask of the directions of slip that are held.
    own, opposite : ndarray, shape (n_nodes, dim)
        Dofs of these nodes, and dofs of the master opposite them; -1 where they are not held.
    planes : tuple of Plane
        Planes at which the slave ends.
    """

    along: ndarray
    own: ndarray
    opposite: ndarray
    planes: tuple[Plane, ...]

    @classmethod
    def of(cls, slave: Surface, master: Surface, fixed: ndarray) -> Symmetry:
        """Return the nodes that fixed dofs hold."""
        reach = max(slave.spacing, master.spacing)
        own = np.where(np.isin(slave.dofs, fixed), slave.dofs, -1)
        opposite = np.full(own.shape, -1)

        # Find held nodes of the master on the same plane, direction by direction
        for i in range(slave.dim):
            members = np.flatnonzero((master.dofs[:, i] >= 0) & np.isin(master.dofs[:, i], fixed))
            if len(members) == 0:
                continue
            distance, nearest = scipy.spatial.cKDTree(master.nodes[members]).query(slave.nodes)
            beside = members[nearest]
            apart = np.abs(master.nodes[beside, i] - slave.nodes[:, i])
            on_plane = (distance < reach) & (apart < ON_PLANE * reach)
            opposite[on_plane, i] = master.dofs[beside[on_plane], i]
        held = (own >= 0) & (opposite >= 0)

        # Normals of the whole surface lie in the plane, but at corners that are wholly held
        crosses = held & (slave.normals**2 < _ACROSS)
        crosses[crosses.all(axis=1)] = False
        normals = unit(np.where(crosses, 0.0, slave.normals))
        directions = frame(normals, np.broadcast_to(slave.directions[0], slave.nodes.shape))
        along = (directions**2 * held[:, None]).sum(axis=2) > _ALONG
        return cls(
            along=along.T,
            own=np.where(held, own, -1),
            opposite=np.where(held, opposite, -1),
            planes=tuple(_planes(slave, held, directions)),
        )

    def slides(self, x: ndarray, round_off: float) -> ndarray:
        """Return a mask of nodes, (n_nodes,), that supports have moved along the master."""
        held = self.own >= 0
        apart = np.where(held, x[self.own] - x[self.opposite], 0.0)
        return np.asarray((np.abs(apart) > round_off).any(axis=1))


def mirrored(surface: Surface, fixed: ndarray, axisymmetric: bool) -> Iterator[tuple[int, ndarray]]:
    """Yield axes and nodes of planes of symmetry at which a surface of a body ends.

    Supports hold all nodes across the plane, and let them move along it.
    """
    held = np.isin(surface.dofs, fixed)
    clamped = np.asarray(held.all(axis=1))
    for i, _, nodes in _ends(surface):
        on_axis = axisymmetric and i == 0
        if on_axis or clamped[nodes].any() or not held[nodes, i].all():
            continue
        beside = np.isin(surface.facets, nodes).any(axis=1)
        if (surface.centres.normal[beside, i] ** 2 < _ACROSS).all():
            yield i, nodes


def _planes(slave: Surface, held: ndarray, directions: ndarray) -> Iterator[Plane]:
    """Yield the planes on which all nodes are held, (n_nodes, dim), across one direction."""
    for i, end, nodes in _ends(slave):
        across = (directions[nodes, :, i] ** 2 > _ALONG).all(axis=0)
        if across.any() and held[nodes, i].all():
            yield Plane(i, end, np.append(False, across), nodes)


def _ends(surface: Surface) -> Iterator[tuple[int, float, ndarray]]:
    """Yield axis, coordinate and nodes of the ends of a surface along each axis."""
    near = ON_PLANE * surface.spacing
    for i, coordinates in enumerate(surface.nodes.T):
        for end in (coordinates.min(), coordinates.max()):
            yield i, float(end), np.flatnonzero(np.abs(coordinates - end) <= near)
