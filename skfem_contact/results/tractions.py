"""Contact tractions along the interface, their means over facets, and their resultants."""
from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..contact import ContactPair, ContactState
from ..contact.laws import Status
from ..surfaces.material_points import along_chain
from ..surfaces.vectors import frame
from .files import StageData

#: Eigenvalues of a facet's mass below this share of the largest one are those of points that are too few.
_SINGULAR = 1e-10


@dataclass(frozen=True)
class Tractions:
    """What a contact pair transmits, arrays (n_points,), in the plane in the order of the slave's chain.

    Attributes
    ----------
    arc
        Position along the slave's chain in the plane, none in space; it has its body to the right: clockwise around a
        body, anticlockwise around a hole.
    x, y, z
        Place of the point in the undeformed slave; z is zero in the plane.
    pressure
        Normal traction, compression positive, as the slave's elements see it: projected onto their shape functions
        where all points of a facet have one status, which leaves the nodal forces as they are.
    shear
        Friction that the slave exerts on the master, likewise: in the plane positive along the master's chain,
        clockwise around a pipe; in space vectors, (n_points, 3), on the undeformed slave.
    gap
        Normal gap from what counts as touching; negative where the penalty lets the point penetrate,
        infinite where no master is near.
    slip
        Distance along the master's chain that the point has slid; in space vectors, (n_points, 3).
    status
        :class:`~skfem_contact.Status` of the point.
    weight
        Length of surface that belongs to it, times the pair's share: ``(weight * pressure).sum()`` is a
        force.
    raw_pressure, raw_shear
        What acts at the points themselves.  It makes the same nodal forces, but ripples within facets, by 10 % and
        more on curved masters: elements do not follow these, and the penalty answers to what gapes.
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
        """Angle about a centre in degrees, from the crown clockwise, 0 to 360."""
        x, y = np.asarray(center, float)
        return np.degrees(np.arctan2(self.x - x, self.y - y)) % 360.0


def tractions(pair: ContactPair, state: ContactState) -> Tractions:
    """Return tractions, gaps and slips of a state."""
    points = pair.points(state)
    places, shear, slip = points.positions(pair.slave.nodes), state.traction[1], state.slip[0]
    if pair.slave.dim == 2:
        arc = along_chain(pair.slave, points.facet, points.xi)
        places = np.column_stack((places, np.zeros(len(places))))
    else:
        arc, normal = np.zeros(0), -pair.slave.at(points.facet, points.xi, pair.slave.nodes).normal
        tangents = frame(normal, points.direction(pair.slave, pair.slave.nodes))
        shear, slip = (np.einsum("in,nic->nc", part, tangents) for part in (state.traction[1:], state.slip))
    x, y, z = places.T
    return Tractions(arc, x, y, z, pressure=_consistent(pair, state, -state.traction[0]),
                     shear=_consistent(pair, state, shear), gap=state.gap - state.offset, slip=slip,
                     status=state.status, weight=pair.share * points.weight, raw_pressure=-state.traction[0],
                     raw_shear=shear)


def _consistent(pair: ContactPair, state: ContactState, values: ndarray) -> ndarray:
    """Values at points, (n, ...), projected onto the slave's shape functions facet by facet: nodal forces stay.

    Facets with points of more than one status keep their values: there tractions have kinks.
    """
    points, m = pair.points(state), len(pair.slave.facets)
    N, k = points.values, points.nodes.shape[1]
    if k == 1:
        return values
    first, last = np.full(m, np.iinfo(int).max), np.full(m, -1)
    np.minimum.at(first, points.facet, state.status)
    np.maximum.at(last, points.facet, state.status)
    mass, moments = np.zeros((m, k, k)), np.zeros((m, k, *values.shape[1:]))
    weighted = points.weight[:, None] * N
    np.add.at(mass, points.facet, weighted[:, :, None] * N[:, None])
    np.add.at(moments, points.facet, np.einsum("nk,n...->nk...", weighted, values))
    nodal = np.einsum("fij,fj...->fi...", np.linalg.pinv(mass, rcond=_SINGULAR, hermitian=True), moments)
    projected = np.einsum("nk,nk...->n...", N, nodal[points.facet])
    smooth = (first == last)[points.facet]
    return np.asarray(np.where(smooth.reshape(-1, *[1] * (values.ndim - 1)), projected, values))


class Interface(NamedTuple):
    """A contact pair in a stage.

    Attributes
    ----------
    tractions
        At the points of the slave.
    normal
        Outward normals of the slave there, undeformed, (n, dim).
    nodes, shares
        Nodes that move each of them, and their shape functions, (n, k).
    facets
        Nodes of the slave's facets, (n_facets, k): ends, middle.
    members
        Facet and point of every pair of both, (2, m).
    """

    tractions: Tractions
    normal: ndarray
    nodes: ndarray
    shares: ndarray
    facets: ndarray
    members: ndarray

    def moved_by(self, u: ndarray) -> ndarray:
        """Displacements of the points, (n, dim), from those of all nodes, (n_nodes, dim)."""
        return np.einsum("nk,nkc->nc", self.shares, u[self.nodes])

    def on_facets(self) -> dict[str, ndarray]:
        """Means over the facets; the status is that of the point that carries most."""
        facet, point = self.members
        t = self.tractions
        weight = np.bincount(facet, t.weight[point])
        data = {}
        for name in ("pressure", "shear", "gap", "slip"):
            values = np.where(np.isfinite(v := getattr(t, name)), v, np.nan)
            total = np.zeros((len(self.facets), *values.shape[1:]))
            np.add.at(total, facet, (t.weight * values.T).T[point])
            data[name] = (total.T / weight).T
        status = np.full(len(self.facets), -1)
        np.maximum.at(status, facet, np.asarray(t.status)[point])
        return data | {"status": status}


def interfaces(stage: StageData) -> dict[str, Interface]:
    """Return the contact pairs of a stage."""
    return {name: _interface(form, stage.states[name]) for name, form in stage.forms.items()
            if isinstance(form, ContactPair)}


def _interface(pair: ContactPair, state: ContactState) -> Interface:
    points, slave = pair.points(state), pair.slave
    at = tractions(pair, state)
    node, normal = slave.dofs[:, 0] // slave.dim, slave.at(points.facet, points.xi, slave.nodes).normal
    members = np.stack((points.facet, np.arange(len(points.facet))))
    if points.nodes.shape[1] == 1:  # a node belongs to all of its facets
        number = np.full(len(node), -1)
        number[points.nodes[:, 0]] = np.arange(len(points.nodes))
        facet = np.repeat(np.arange(len(slave.facets)), slave.facets.shape[1])
        members = np.stack((facet, number[slave.facets.ravel()]))[:, number[slave.facets.ravel()] >= 0]
    return Interface(at, normal, node[points.nodes], points.values, node[slave.facets], members)


@dataclass(frozen=True)
class ContactReport:
    """Sums over a contact pair; ``print`` shows it as text.

    Attributes
    ----------
    name
        Slave and master.
    normal, tangential
        Resultants of the contact pressure and of the friction on the slave, (dim,).
    pressure, friction
        Integrals of the pressure and of the magnitude of the friction over the surface.
    mobilised
        Largest friction over pressure of a point.
    penetration
        Largest penetration as a share of the slave's segment there.
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
        """Resultant of all contact tractions on the slave, (dim,)."""
        return self.normal + self.tangential

    def __str__(self) -> str:
        lines = [f"contact of {self.name}: {self.stick} stick, {self.slip} slip, {self.open} open"]
        for what, total, vector in (("pressure", self.pressure, self.normal),
                                    ("friction", self.friction, self.tangential)):
            resultant = ", ".join(f"{part:.5g}" for part in vector)
            lines.append(f"  {what:8} {total:12.5g}   resultant on the slave ({resultant})")
        lines.append(f"  friction over pressure at most {self.mobilised:.3f}, "
                     f"penetration at most {self.penetration:.2%} of a segment")
        return "\n".join(lines)


def contact_report(pair: ContactPair, x: ndarray, state: ContactState) -> ContactReport:
    """Return resultants, status and penetration of a contact pair."""
    closed = state.status != Status.OPEN
    weight = pair.share * pair.points(state).weight[closed]
    normal, friction = state.traction[0, closed], np.linalg.norm(state.traction[1:, closed], axis=0)
    resultants = _resultants(pair, x, state)
    counts = np.bincount(state.status, minlength=3)
    ratio = np.divide(friction, -normal, out=np.zeros(len(normal)), where=normal < 0)
    return ContactReport(
        name=f"{pair.slave.name} on {pair.master.name}",
        normal=resultants[0], tangential=resultants[1],
        pressure=-float(weight @ normal), friction=float(weight @ friction),
        mobilised=float(ratio.max(initial=0.0)), penetration=pair.penetration(state),
        open=int(counts[Status.OPEN]), stick=int(counts[Status.STICK]), slip=int(counts[Status.SLIP]))


def _resultants(pair: ContactPair, x: ndarray, state: ContactState) -> list[ndarray]:
    """Sums of the nodal forces on the slave from pressure and from friction, (dim,) each."""
    forces, normal = pair.tractions_at(x, state).forces, np.zeros_like(state.traction)
    normal[0] = state.traction[0]
    return [-(forces @ part.ravel())[pair.slave.dofs].sum(axis=0) + 0.0 for part in (normal, state.traction - normal)]
