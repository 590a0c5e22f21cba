"""Planes of symmetry at which a slave ends, as supports show them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array

from ..surfaces.surface import Surface
from ..surfaces.vectors import frame, unit
from .quadrature import ON_PLANE
from .search import project

#: Square of the cosine between a direction and supports that hold it.
_HELD = 0.99
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

    Where supports hold both sides of an end across the surface, no equilibrium fixes the multiplier
    of the node: its nodal force acts on supports alone, and so it does where a node is held above a
    rigid master. Tractions would ripple from there into the joint. It follows its neighbours
    instead, as at the ends of mortar spaces (B. I. Wohlmuth, SIAM J. Numer. Anal. 38 (2000)
    989-1012). On facets whose nodes supports hold in all directions no traction moves anything, and
    none closes an overlap: they have none.

    Attributes
    ----------
    along : ndarray, shape (dim - 1, n_nodes)
        Mask of the directions of slip that are held.
    across : ndarray, shape (n_nodes,)
        Mask of the nodes that are held across the surface.
    clamped : ndarray, shape (n_nodes,)
        Mask of the nodes that are held in all directions.
    followed : csr_matrix, shape (n_nodes, n_nodes), or None
        Means of the neighbours of these nodes; None without such nodes.
    own, opposite : ndarray, shape (n_nodes, dim)
        Dofs of these nodes, and dofs of the master opposite them; -1 where they are not held.
    planes : tuple of Plane
        Planes at which the slave ends.
    """

    along: ndarray
    across: ndarray
    clamped: ndarray
    followed: csr_matrix | None
    own: ndarray
    opposite: ndarray
    planes: tuple[Plane, ...]

    @classmethod
    def of(cls, slave: Surface, master: Surface, fixed: ndarray) -> Symmetry:
        """Return the nodes that fixed dofs hold."""
        own = np.where(np.isin(slave.dofs, fixed), slave.dofs, -1)
        opposite = np.full(own.shape, -1)
        at = np.flatnonzero((own >= 0).any(axis=1))
        if len(at) and not master.rigid:
            opposite[at] = _opposite(master.facing(slave), slave.nodes[at], fixed)
        held = (own >= 0) & (opposite >= 0)

        # Normals of the whole surface lie in the plane, but at corners that are wholly held
        crosses = held & (slave.normals**2 < _ACROSS)
        crosses[crosses.all(axis=1)] = False
        normals = unit(np.where(crosses, 0.0, slave.normals))
        directions = frame(normals, np.broadcast_to(slave.directions[0], slave.nodes.shape))
        along = (directions**2 * held[:, None]).sum(axis=2) > _HELD
        if master.rigid:
            stays = own >= 0
        else:
            stays = held
        across = np.asarray((stays * slave.normals**2).sum(axis=1) > _HELD)
        return cls(
            along=along.T,
            across=across,
            clamped=np.asarray(stays.all(axis=1)),
            followed=_followed(slave, across),
            own=np.where(held, own, -1),
            opposite=np.where(held, opposite, -1),
            planes=tuple(_planes(slave, held, directions)),
        )

    def slides(self, x: ndarray, round_off: float) -> ndarray:
        """Return a mask of nodes, (n_nodes,), that supports have moved along the master."""
        held = self.own >= 0
        apart = np.where(held, x[self.own] - x[self.opposite], 0.0)
        return np.asarray((np.abs(apart) > round_off).any(axis=1))


def _opposite(master: Surface, points: ndarray, fixed: ndarray) -> ndarray:
    """Return dofs of the master opposite points, (n, dim), or -1.

    They count where supports hold all nodes that move the point opposite. On a rim these are the
    ends of a side, which need not be opposite nodes.
    """
    unlimited = np.full(len(points), np.inf)
    closest = project(master, master.nodes, points, unlimited)
    nodes = master.facets[closest.facet]
    N = np.abs(master.shape.at(closest.facet, closest.xi, 0)[0])
    dofs = master.dofs[nodes]  # (n, k, dim)
    is_held = (dofs >= 0) & np.isin(dofs, fixed)
    stands = (is_held | (N <= ON_PLANE)[:, :, None]).all(axis=1) & closest.found[:, None]
    return np.where(stands, dofs[np.arange(len(N)), N.argmax(axis=1)], -1)


def _followed(slave: Surface, held: ndarray) -> csr_matrix | None:
    """Return the means of the neighbours of nodes that are held, or None without any."""
    beside = slave.facets[held[slave.facets].any(axis=1)]
    if not len(beside):
        return None

    # Pairs of a held node and another one of a facet
    row = np.repeat(beside, beside.shape[1], axis=1).ravel()
    column = np.tile(beside, (1, beside.shape[1])).ravel()
    counts = held[row] & ~held[column]
    ones = np.ones(int(counts.sum()))
    n = len(slave.nodes)
    links = csr_matrix((ones, (row[counts], column[counts])), shape=(n, n))
    number = np.asarray(links.sum(axis=1)).ravel()
    return csr_matrix(diags_array(1.0 / np.maximum(number, 1.0)) @ links)


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
        across = (directions[nodes, :, i] ** 2 > _HELD).all(axis=0)
        if across.any() and held[nodes, i].all():
            yield Plane(i, end, np.append(False, across), nodes)


def _ends(surface: Surface) -> Iterator[tuple[int, float, ndarray]]:
    """Yield axis, coordinate and nodes of the ends of a surface along each axis."""
    near = ON_PLANE * surface.spacing
    for i, coordinates in enumerate(surface.nodes.T):
        for end in (coordinates.min(), coordinates.max()):
            yield i, float(end), np.flatnonzero(np.abs(coordinates - end) <= near)
