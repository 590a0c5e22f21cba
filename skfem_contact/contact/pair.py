"""The contact pair: two surfaces, a law and a quadrature rule that answer like any other form."""
from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix
from skfem import CellBasis

from ..assembly import Response
from ..checks import check_basis
from ..materials.coulomb import Coulomb, Status, Traction
from . import quadrature as rules
from .kinematics import Kinematics, geometric_tangent, variations
from .search import Projection, project
from .surface import Surface

#: Round-off of a gap, as a share of the slave segment: bodies that touch exactly are in contact.
_TOUCHING = 1e-9
#: Penetration, as a share of the slave segment, from which the user is told.
_PENETRATION = 0.01


@dataclass(frozen=True)
class ContactState:
    """What the points of a contact pair remember, arrays (n_points,).

    Attributes
    ----------
    stick_point
        Arc position on the undeformed master to which each point sticks; NaN where it has no counterpart.
    gap, slip
        Normal gap (negative: penetration, inf: nothing near) and slip from the initial stick point.
    normal, tangential
        Tractions: normal negative in compression; tangential opposes the slip.
    status
        :class:`~skfem_contact.Status`.
    arc
        Arc position of the closest point on the master.
    """

    stick_point: ndarray
    gap: ndarray
    slip: ndarray
    normal: ndarray
    tangential: ndarray
    status: ndarray
    arc: ndarray


class ContactPair:
    """Frictional contact with finite sliding between two named boundaries.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh that holds both bodies.
    slave, master
        Names of the boundaries; each must be a single chain.  The paper's advice: the softer body is the slave.
    law
        Interface law, e.g. :class:`Coulomb`.
    quadrature
        ``"nodal"``, the paper's node-to-segment with tributary lengths, or the number of Gauss points on each
        slave segment (surface-to-surface).
    penalty
        Traction per penetration: one number for both directions, or (normal, tangential); by default
        :func:`choose_penalties` takes it from the stiffness and the size of the elements on both sides.
    tangent
        ``"exact"``, or ``"primary"``: the paper's eqs 20 to 22 without the rotation and curvature parts.

    Raises
    ------
    ValueError
        Unknown boundary, no single chain, slave and master that share nodes, penalty not positive.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> block = MeshQuad().refined(1).with_defaults()
    >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> pair = sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=.3), penalty=1e4)
    >>> x = basis.zeros()
    >>> x[basis.nodal_dofs[1, mesh.t[:, mesh.subdomains["upper"]]]] = -1e-3     # press the upper block down
    >>> out = pair.assemble(x, pair.initial_state())
    >>> out.state.normal.round(9).tolist()
    [-10.0, -10.0, -10.0]
    """

    def __init__(self, basis: CellBasis, slave: str, master: str, law: Coulomb,
                 quadrature: Literal["nodal"] | int = "nodal",
                 penalty: float | tuple[float, float] | None = None,
                 tangent: Literal["exact", "primary"] = "exact") -> None:
        check_basis(basis)
        self.slave = Surface.from_boundary(basis, slave)
        self.master = Surface.from_boundary(basis, master)
        if slave == master or np.isin(self.slave.dofs[:, 0], self.master.dofs[:, 0]).any():
            raise ValueError(f"slave '{slave}' and master '{master}' share nodes: a body cannot touch itself "
                             "there; separate the bodies with join_bodies")
        if tangent not in ("exact", "primary"):
            raise ValueError(f"tangent must be 'exact' or 'primary', not {tangent!r}")
        self.law, self.quadrature, self.tangent = law, quadrature, tangent
        self.points = _points(self.slave, quadrature)
        self.n = basis.N
        self.penalty = None if penalty is None else self._checked(penalty)
        # what penetrates deeper than an element or so belongs to the other side of the body
        self._depth = np.maximum(self.points.size, float(np.median(self.master.length)))

    def __repr__(self) -> str:
        return (f"<ContactPair {self.slave.name} on {self.master.name}, {len(self.points.weight)} points "
                f"({self.quadrature}), {self.law!r}>")

    def _checked(self, penalty: float | tuple[float | ndarray, float | ndarray]) -> tuple[ndarray, ndarray]:
        values = penalty if isinstance(penalty, tuple) else (penalty, penalty)
        normal, tangential = (np.broadcast_to(np.asarray(v, float), self.points.weight.shape) for v in values)
        if not (normal > 0).all() or not (tangential > 0).all():
            raise ValueError(f"penalties must be positive, not {penalty!r}")
        return normal, tangential

    def with_penalty(self, normal: float | ndarray, tangential: float | ndarray) -> ContactPair:
        """The same pair with other penalties (traction per penetration and per elastic slip)."""
        new = copy(self)
        new.penalty = self._checked((normal, tangential))
        return new

    def with_law(self, law: Coulomb) -> ContactPair:
        """The same pair with another interface law."""
        new = copy(self)
        new.law = law
        return new

    def initial_state(self) -> ContactState:
        """Nothing has moved: each point sticks to its initial closest point (eq. 7, ``xi_0 = xi_c``)."""
        nodes = self.master.nodes
        found = self._project(nodes, self.points.positions(self.slave.nodes))
        arc = self._arc(found)
        zero = np.zeros(len(arc))
        return ContactState(arc, found.gap, zero, zero, zero, np.full(len(arc), int(Status.OPEN)), arc)

    def assemble(self, x: ndarray, state: ContactState) -> Response:
        """Contact force, tangent and candidate state at the displacements ``x``.

        Parameters
        ----------
        x
            Displacements, (N,).
        state
            The last accepted state.
        """
        if self.penalty is None:
            raise ValueError(f"contact of '{self.slave.name}' on '{self.master.name}' has no penalty yet: give "
                             "`penalty=`, or call choose_penalties(forms), which `run` does for you")
        nodes = self.master.positions(x)
        positions = self.points.positions(self.slave.positions(x))
        found = self._project(nodes, positions)
        arc = self._arc(found)
        at = np.flatnonzero(found.gap <= _TOUCHING * self.points.size)
        rho = self.master.curve(found.segment[at], found.xi[at], nodes)[1]
        elastic_arc = self._along(arc[at] - np.where(np.isnan(state.stick_point[at]), arc[at], state.stick_point[at]))
        kinematics = variations(self.points, self.slave, self.master, at, found, positions[at] - rho[0],
                                elastic_arc, nodes)
        stretch = np.linalg.norm(rho[1], axis=1) / self.master.arc(found.segment[at], found.xi[at])[1]
        traction = self.law.update(np.minimum(found.gap[at], 0.0), stretch * elastic_arc,
                                   self.penalty[0][at], self.penalty[1][at])
        weight = self.points.weight[at]
        force = (weight * traction.normal)[:, None] * kinematics.gap_gradient \
            + (weight * traction.tangential)[:, None] * kinematics.tangential
        new = self._candidate(state, found, arc, at, traction, traction.elastic_slip / stretch)
        return Response(np.bincount(kinematics.dofs.ravel(), force.ravel(), minlength=self.n), new,
                        lambda: self._stiffness(kinematics, traction, weight))

    def summary(self, state: ContactState) -> str:
        """Counts of open, sticking and slipping points, for the table of a result."""
        counts = np.bincount(state.status, minlength=3)
        return f"{counts[Status.STICK]} stick, {counts[Status.SLIP]} slip, {counts[Status.OPEN]} open"

    def penetration(self, state: ContactState) -> float:
        """Largest penetration as a share of the slave segment there."""
        closed = state.status != Status.OPEN
        return float(np.max(-state.gap[closed] / self.points.size[closed], initial=0.0))

    def remarks(self, state: ContactState) -> list[str]:
        """What a user should know of an accepted state: a penetration of more than 1 % of the segment."""
        share = self.penetration(state)
        if share <= _PENETRATION:
            return []
        return [f"the slave penetrates by {share:.1%} of its segment length: the penalty "
                f"(median {np.median(self.penalty[0]):.3g}) is too soft for this load"]  # type: ignore[index]

    def _project(self, nodes: ndarray, positions: ndarray) -> Projection:
        return project(self.master, nodes, positions, self._depth, reach=float(self._depth.max()))

    def _arc(self, found: Projection) -> ndarray:
        arc = np.full(len(found.gap), np.nan)
        arc[found.found] = self.master.arc(found.segment[found.found], found.xi[found.found])[0]
        return arc

    def _along(self, difference: ndarray) -> ndarray:
        """Differences of arc positions; on a closed chain the short way round."""
        if not self.master.closed:
            return difference
        total = self.master.total_length
        return (difference + 0.5 * total) % total - 0.5 * total

    def _candidate(self, state: ContactState, found: Projection, arc: ndarray, at: ndarray, traction: Traction,
                   elastic_arc: ndarray) -> ContactState:
        """Open points take their closest point along as stick point, sliding ones drag it behind (eq. 10)."""
        zero = np.zeros(len(arc))
        stick_point, normal, tangential = arc.copy(), zero.copy(), zero.copy()
        status = np.full(len(arc), int(Status.OPEN))
        stick_point[at] -= elastic_arc
        normal[at], tangential[at], status[at] = traction.normal, traction.tangential, traction.status
        moved = self._along(arc - state.arc)
        slip = np.where(status == Status.OPEN, 0.0, state.slip + np.where(np.isnan(moved), 0.0, moved))
        return ContactState(stick_point, found.gap, slip, normal, tangential, status, arc)

    def _stiffness(self, kinematics: Kinematics, traction: Traction, weight: ndarray) -> csr_matrix:
        """Eqs 14 to 16, exact; the primary part alone is eqs 20 to 22."""
        G, T, S = kinematics.gap_gradient, kinematics.tangential, kinematics.slip_gradient
        dN = traction.normal_by_gap[:, None] * G
        dT = traction.tangential_by_gap[:, None] * G + traction.tangential_by_slip[:, None] * S
        K = G[:, :, None] * dN[:, None, :] + T[:, :, None] * dT[:, None, :]
        if self.tangent == "exact":
            K += geometric_tangent(kinematics, traction.normal, traction.tangential)
        K *= weight[:, None, None]
        rows = np.repeat(kinematics.dofs, K.shape[2], axis=1)
        columns = np.tile(kinematics.dofs, (1, K.shape[1]))
        return coo_matrix((K.ravel(), (rows.ravel(), columns.ravel())), shape=(self.n, self.n)).tocsr()


def _points(slave: Surface, quadrature: str | int) -> rules.SlavePoints:
    if quadrature == "nodal":
        return rules.nodal(slave)
    if isinstance(quadrature, int) and quadrature > 0:
        return rules.gauss(slave, quadrature)
    raise ValueError(f"quadrature must be 'nodal' or a positive number of Gauss points, not {quadrature!r}")
