"""How a contact state goes on: from the accepted one to what is found, and from the slave's old points to new ones."""
from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy import ndarray
from scipy.spatial import cKDTree

from ..surfaces.chain import Chain
from ..surfaces.material_points import MaterialPoints, apart, behind, shifted
from ..surfaces.surface import Surface
from ..surfaces.vectors import frame
from .kinematics import Kinematics
from .laws import Status, Update
from .quadrature import SlavePoints
from .search import Projection
from .state import ContactState

#: Round-off of an elastic slip, as a share of it.
_SAME_SLIP = 1e-9


def follow(seen: ContactState, found: Projection, at: ndarray, update: Update, stick: MaterialPoints, slip: ndarray
           ) -> ContactState:
    """The state that is found; open points take their closest point along as stick point.

    Parameters
    ----------
    seen
        Accepted state, as the pair sees it.
    found
        Closest points of all points.
    at, update, stick
        Points that the law reaches, its answer for them and their stick points.
    slip
        Slip of all points since they closed, (dim - 1, n), if they have not opened.
    """
    closest, traction, internal = found.closest, np.zeros_like(seen.traction), seen.internal.copy()
    facet, xi, status = closest.facet.copy(), closest.xi.copy(), np.full(len(found.gap), int(Status.OPEN))
    facet[at], xi[at] = stick
    traction[:, at], status[at], internal[:, at] = update.traction, update.status, update.internal
    return replace(seen, facet=closest.facet, position=closest.xi.T, stick_facet=facet, stick_point=xi.T,
                   gap=found.gap, slip=np.where(status == Status.OPEN, 0.0, slip), traction=traction, status=status,
                   internal=internal)


def dragged(kinematics: Kinematics, master: Surface, nodes: ndarray, stick: MaterialPoints, elastic: ndarray
            ) -> MaterialPoints:
    """Stick points after a step: those that slide drag them behind by their elastic slip, (dim - 1, n) (eq. 10)."""
    left = np.abs(elastic.T - kinematics.slip).max(axis=1)
    stays = stick.exist & (left <= _SAME_SLIP * np.abs(elastic).max(axis=0))
    after = behind(master, nodes, kinematics.tangents, kinematics.closest, elastic.T)
    return MaterialPoints(np.where(stays, stick.facet, after.facet), np.where(stays[:, None], stick.xi, after.xi))


def tangents_at(points: SlavePoints, slave: Surface, slave_nodes: ndarray, master: Surface, nodes: ndarray,
                closest: MaterialPoints) -> ndarray:
    """Unit tangents of the master at material points, (n, dim - 1, dim), counted as those of slips are."""
    normal = master.at(closest.facet, closest.known, nodes).normal
    return frame(normal, points.direction(slave, slave_nodes))


def elastic_slip(points: SlavePoints, slave: Surface, master: Surface, state: ContactState,
                 found: ContactState | None = None) -> ndarray:
    """Slip of the closest points from the stick points along the undeformed master, (dim - 1, n).

    Parameters
    ----------
    found
        State with the closest points, if it is not the one with the stick points.
    """
    closest = (found or state).closest
    tangents = tangents_at(points, slave, slave.nodes, master, master.nodes, closest)
    return apart(master, master.nodes, tangents, closest, state.stick).T


def slid(points: SlavePoints, slave: Surface, master: Surface, closest: MaterialPoints, before: MaterialPoints
         ) -> ndarray:
    """Way of closest points on the undeformed master, (dim - 1, n): along its chain, or straight in space."""
    if slave.dim == 2:
        return Chain.of(master).way(closest, before)[None]
    tangents = tangents_at(points, slave, slave.nodes, master, master.nodes, closest)
    return apart(master, master.nodes, tangents, closest, before).T


def with_elastic_slip(points: SlavePoints, slave: Surface, master: Surface, state: ContactState, slip: ndarray
                      ) -> ContactState:
    """The state with stick points so far behind the closest points, (dim - 1, n), along the undeformed master."""
    tangents = tangents_at(points, slave, slave.nodes, master, master.nodes, state.closest)
    return state.with_stick(behind(master, master.nodes, tangents, state.closest, slip.T))


def nearest(slave: Surface, old: SlavePoints, new: SlavePoints) -> ndarray:
    """Number of the old point nearest to each new one in the undeformed slave."""
    if slave.dim == 2:
        before, after = along_chain(slave, old, new)
        return np.asarray(np.abs(after[:, None] - before).argmin(axis=1))
    before, after = (_places_and_normals(slave, points) for points in (old, new))
    return np.asarray(cKDTree(before).query(after)[1])


def _places_and_normals(slave: Surface, points: SlavePoints) -> ndarray:
    """Where points of a slave in space lie, and which way they look: not round a corner, (n, 6)."""
    normal = slave.at(points.facet, points.xi, slave.nodes).normal
    return np.hstack((points.positions(slave.nodes), slave.spacing * normal))


def along_chain(slave: Surface, *points: SlavePoints) -> list[ndarray]:
    """Arc positions of points of a slave in the plane."""
    chain = Chain.of(slave)
    return [chain.arc(some.facet, some.xi) for some in points]


def interpolated(slave: Surface, old: SlavePoints, new: SlavePoints, values: ndarray) -> ndarray:
    """Fields, (..., n), at new points: interpolated along the slave in the plane, of the nearest old point in space."""
    if slave.dim == 3:
        return np.asarray(values[..., nearest(slave, old, new)])
    before, after = along_chain(slave, old, new)
    rows = [np.interp(after, before, row) for row in values.reshape(-1, values.shape[-1])]
    return np.array(rows).reshape(*values.shape[:-1], len(after))


def transferred(state: ContactState, slave: Surface, slave_nodes: ndarray, master: Surface, nodes: ndarray,
                old: SlavePoints, new: SlavePoints) -> ContactState:
    """The state at new points; positions on the master, and what is no smooth field, come from the nearest old point.

    Parameters
    ----------
    state
        State at the old points.
    slave, slave_nodes, master, nodes
        The surfaces, and where their nodes are now.
    old, new
        The slave's points.
    """
    at = nearest(slave, old, new)
    slip, traction, offset, elastic = (interpolated(slave, old, new, values) for values in (
        state.slip, state.traction, state.offset, elastic_slip(old, slave, master, state)))
    motion = new.positions(slave_nodes) - old.positions(slave_nodes)[at]
    closest = shifted(master, nodes, state.closest.take(at), motion)
    state = replace(state, facet=closest.facet, position=closest.xi.T, gap=state.gap[at], status=state.status[at],
                    internal=state.internal[:, at], slip=slip, traction=traction, offset=offset,
                    stick_facet=closest.facet, stick_point=closest.xi.T)
    return with_elastic_slip(new, slave, master, state, elastic)
