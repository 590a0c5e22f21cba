"""Contact tractions as arrays along the interface, and as means over facets."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..contact import ContactPair, ContactState
from ..stages.result import StageResult
from ..surfaces.material_points import along_chain
from ..surfaces.vectors import frame

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
    """Contact tractions, gaps and slips of a state.

    Parameters
    ----------
    pair
        The pair; it needs no penalty.
    state
        Its state, ``result["gravity"].states["skin"]`` for a pair that is named ``"skin"`` among the forms.

    Raises
    ------
    ValueError
        No contact pair, or the state of another form.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> block = MeshQuad().refined(1).with_defaults()
    >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> pair = sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=.3), "nodal", penalty=1e4)
    >>> x = basis.zeros()
    >>> x[basis.nodal_dofs[1, mesh.t[:, mesh.subdomains["upper"]]]] = -1e-3     # press the upper block down
    >>> joint = sc.tractions(pair, pair.assemble(x, pair.initial_state()).state)
    >>> joint.pressure.round(9).tolist(), float((joint.weight * joint.pressure).sum().round(9))
    ([10.0, 10.0, 10.0], 10.0)
    """
    check_state(pair, state)
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


def check_state(pair: ContactPair, state: ContactState) -> None:
    """Refuse what is no contact pair, and the state of another form."""
    if not isinstance(pair, ContactPair):
        raise ValueError(f"{type(pair).__name__} is no contact pair")
    if not isinstance(state, ContactState):
        raise ValueError(f"{type(state).__name__} is not the state of a contact pair; "
                         "pass result[stage].states[name of the pair]")
    if len(state.gap) != (n := len(pair.points(state).weight)):
        raise ValueError(f"the state holds {len(state.gap)} points and the pair {n}: "
                         "it belongs to another pair")


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


def interfaces(forms: Mapping[str, Any], step: StageResult) -> dict[str, Interface]:
    """The contact pairs that are there in a stage."""
    return {name: _interface(form, step, name) for name, form in forms.items()
            if isinstance(form, ContactPair) and name in step.states}


def _interface(pair: ContactPair, step: StageResult, name: str) -> Interface:
    state = step.states[name]
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
