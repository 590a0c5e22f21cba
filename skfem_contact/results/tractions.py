"""Contact tractions along the interface, their means over facets, and their resultants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..arrays import quotient
from ..contact import ContactPair, ContactState
from ..contact.consistent import consistent
from ..contact.laws import Status
from ..forms.roles import Touching, having
from ..surfaces.material_points import along_chain
from ..surfaces.vectors import frame
from .files import StageData


@dataclass(frozen=True)
class Tractions:
    """Tractions of a contact pair, arrays, shape (n_points,).

    In the plane points are in the order of the slave's chain.

    Attributes
    ----------
    arc
        Position along the slave's chain in the plane, empty in space. The chain has its body to the
        right: it runs clockwise around a body, anticlockwise around a hole.
    x, y, z
        Coordinates of the points in the undeformed slave; z is zero in the plane.
    pressure
        Normal traction, compression positive. Where all points of a facet have one status, it is
        projected onto the shape functions of the slave, with the same nodal forces. Other facets
        keep the values of their points, which at the edge of contact are off by 5 to 40 % of the
        largest pressure.
    shear
        Friction of the slave on the master, likewise projected: in the plane positive along the
        master's chain, clockwise around a pipe; in space vectors, shape (n_points, 3), on the
        undeformed slave.
    gap
        Normal gap beyond the clearance: negative where the penalty lets the point penetrate,
        infinite where no master is near.
    slip
        Slip along the master's chain; in space vectors, shape (n_points, 3).
    status
        Status of the points: 0 open, 1 stick or elastic slip, 2 slip at the friction bound.
    weight
        Length or area of surface times the pair's share: ``(weight * pressure).sum()`` is a force.
    raw_pressure, raw_shear
        Tractions at the points themselves. They have the same nodal forces, but ripple within
        facets, by 10 % and more on curved masters.
    """

    arc: ndarray
    x: ndarray
    y: ndarray
    z: ndarray
    pressure: ndarray
    shear: ndarray
    gap: ndarray
    slip: ndarray
    status: ndarray
    weight: ndarray
    raw_pressure: ndarray
    raw_shear: ndarray

    def central_angle(self, center: ArrayLike = (0.0, 0.0)) -> ndarray:
        """Return the angle about a centre in degrees, from the crown clockwise, 0 to 360."""
        x, y = np.asarray(center, float)
        return np.degrees(np.arctan2(self.x - x, self.y - y)) % 360.0


def tractions(pair: ContactPair, state: ContactState, x: ndarray | None = None) -> Tractions:
    """Return tractions, gaps and slips of a state.

    With displacements, (N,), those of bodies of finite kinematics are per present area.
    """
    # Take the points, their coordinates and their pressure.
    points = pair.points(state)
    slave = pair.slave
    coordinates = points.positions(slave.nodes)
    traction = pair.enforcement.tractions(pair, state)
    stretch: ndarray | float = 1.0
    if pair.finite and x is not None:
        nodes, _ = pair.interface.positions(x)
        stretch = pair.stretch(nodes, points).values
        traction = traction / stretch
    pressure = -traction[0]

    # Give friction and slip a sign in the plane, and components in space.
    if slave.dim == 2:
        arc = along_chain(slave, points.facet, points.xi)
        coordinates = np.pad(coordinates, ((0, 0), (0, 1)))
        shear = traction[1]
        slip = state.slip[0]
    else:
        arc = np.zeros(0)
        normal = -slave.at(points.facet, points.xi, slave.nodes).normal
        tangents = frame(normal, points.direction(slave, slave.nodes))
        shear = np.einsum("in,nic->nc", traction[1:], tangents)
        slip = np.einsum("in,nic->nc", state.slip, tangents)

    # Project the tractions on the shape functions.
    x, y, z = coordinates.T
    return Tractions(
        arc,
        x,
        y,
        z,
        pressure=consistent(pair, state, pressure),
        shear=consistent(pair, state, shear),
        gap=state.gap - state.clearance,
        slip=slip,
        status=state.status,
        weight=pair.share * points.weight * stretch,
        raw_pressure=pressure,
        raw_shear=shear,
    )


class ContactFacets(NamedTuple):
    """Points and facets of a contact pair in a stage."""

    tractions: Tractions
    normal: ndarray  # at points, (n, dim)
    nodes: ndarray  # of the facets of points, (n, k)
    shares: ndarray  # shape functions of these nodes, (n, k)
    facets: ndarray  # nodes of all facets, (n_facets, k)
    members: ndarray  # facets and their points in pairs, (2, m)

    def moved_by(self, u: ndarray) -> ndarray:
        """Return displacements of the points, (n, dim), from all nodes, (n_nodes, dim)."""
        return np.einsum("nk,nkc->nc", self.shares, u[self.nodes])

    def on_facets(self) -> dict[str, ndarray]:
        """Return means over the facets, shares of their areas that are closed, and their status.

        The status is open where all points are, else what most of the closed area has.
        """
        facet, point = self.members
        t = self.tractions
        # Means by area; points without a value count as gaps.
        weight = np.bincount(facet, t.weight[point])
        data = {}
        for name in ("pressure", "shear", "gap", "slip"):
            values = getattr(t, name)
            values = np.where(np.isfinite(values), values, np.nan)
            total = np.zeros((len(self.facets), *values.shape[1:]))
            np.add.at(total, facet, (t.weight * values.T).T[point])
            data[name] = (total.T / weight).T
        # Compare the areas of each status; facets without points have none.
        areas = np.zeros((len(self.facets), len(Status)))
        np.add.at(areas, (facet, t.status[point]), t.weight[point])
        closed = areas[:, Status.STICK :]
        data["closed"] = closed.sum(axis=1) / weight
        of_closed = Status.STICK + closed.argmax(axis=1)
        status = np.where(closed.any(axis=1), of_closed, Status.OPEN)
        return data | {"status": np.where(areas.any(axis=1), status, -1)}


def interfaces(stage: StageData) -> dict[str, ContactFacets]:
    """Return the contact pairs of a stage."""
    found = {}
    for name, form in having(stage.forms, Touching).items():
        if name in stage.states and form.slave.meshed:
            found[name] = _interface(form, stage.states[name], stage.x[: form.size])
    return found


def _interface(pair: ContactPair, state: ContactState, x: ndarray) -> ContactFacets:
    """Return the points and facets of a contact pair."""
    points = pair.points(state)
    slave = pair.slave
    node = slave.dofs[:, 0] // slave.dim

    # Pair the facets with their points.
    if points.nodes.shape[1] > 1:
        members = np.stack((points.facet, np.arange(len(points.facet))))
    else:
        # Points are nodes, which belong to all of their facets.
        number = np.full(len(node), -1)
        number[points.nodes[:, 0]] = np.arange(len(points.nodes))
        facet = np.repeat(np.arange(len(slave.facets)), slave.facets.shape[1])
        point = number[slave.facets.ravel()]
        members = np.stack((facet, point))[:, point >= 0]
    return ContactFacets(
        tractions(pair, state, x),
        slave.at(points.facet, points.xi, slave.nodes).normal,
        nodes=node[points.nodes],
        shares=points.values,
        facets=node[slave.facets],
        members=members,
    )


@dataclass(frozen=True)
class ContactReport:
    """Resultants and status of a contact pair; ``print`` shows them as text.

    Attributes
    ----------
    name
        Slave and master.
    normal, tangential : ndarray, shape (dim,)
        Resultants of the contact pressure and of the friction on the slave.
    pressure, friction
        Integrals of the pressure and of the magnitude of the friction over the surface.
    mobilised, penetration
        Largest ratio of friction to pressure of a point, and largest penetration as a share of the
        slave's segment.
    open, stick, slip
        Number of points of each status.
    """

    name: str
    normal: ndarray
    tangential: ndarray
    pressure: float
    friction: float
    mobilised: float
    penetration: float
    open: int
    stick: int
    slip: int

    @property
    def force(self) -> ndarray:
        """Resultant of all contact tractions on the slave, shape (dim,)."""
        return self.normal + self.tangential

    def __str__(self) -> str:
        lines = [f"contact of {self.name}: {self.stick} stick, {self.slip} slip, {self.open} open"]
        parts = (
            ("pressure", self.pressure, self.normal),
            ("friction", self.friction, self.tangential),
        )
        for part, total, vector in parts:
            resultant = ", ".join(f"{component:.5g}" for component in vector)
            lines.append(f"  {part:8} {total:12.5g}   resultant on the slave ({resultant})")
        lines.append(
            f"  friction over pressure at most {self.mobilised:.3f}, "
            f"penetration at most {self.penetration:.2%} of a segment"
        )
        return "\n".join(lines)


def contact_report(pair: ContactPair, x: ndarray, state: ContactState) -> ContactReport:
    """Return resultants, status and penetration of a contact pair."""
    # Take the tractions and weights of closed points.
    closed = state.status != Status.OPEN
    weight = pair.share * pair.points(state).weight[closed]
    normal = state.traction[0, closed]
    friction = np.linalg.norm(state.traction[1:, closed], axis=0)

    # Sum up forces, status and mobilised friction.
    resultants = _resultants(pair, x, state)
    counts = np.bincount(state.status, minlength=3)
    mobilised = quotient(friction, -normal)
    return ContactReport(
        name=f"{pair.slave.name} on {pair.master.name}",
        normal=resultants[0],
        tangential=resultants[1],
        pressure=-float(weight @ normal),
        friction=float(weight @ friction),
        mobilised=float(mobilised.max(initial=0.0)),
        penetration=pair.penetration(state),
        open=int(counts[Status.OPEN]),
        stick=int(counts[Status.STICK]),
        slip=int(counts[Status.SLIP]),
    )


def _resultants(pair: ContactPair, x: ndarray, state: ContactState) -> list[ndarray]:
    """Return the sums of the nodal forces on the slave from pressure and from friction."""
    forces = pair.enforcement.nodal_forces(pair, x, state)
    return [0.0 - force[pair.slave.dofs].sum(axis=0) for force in forces]
