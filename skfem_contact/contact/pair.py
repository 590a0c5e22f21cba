"""The contact pair: two surfaces, a law and a quadrature rule that answer like any other form."""
from __future__ import annotations

from collections.abc import Collection, Mapping
from copy import copy
from dataclasses import fields, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis

from ..errors import IncrementTooLarge, check_basis
from ..forms import Form, Response
from ..remarks import Remark
from ..sparse import Gathering
from .augmented import AugmentedLagrangian
from .clearance import Fit, less_overlap, touching
from .diagnosis import ROUND_OFF, passed_through, penetration, remarks
from .first_geometry import FirstGeometry, HeldState
from .kinematics import Kinematics, tangents, variations
from .laws import InterfaceLaw, Status, Traction
from .neighbours import NeighbourList
from .penalty import with_chosen_penalty
from .prestress import TractionOperator, moved_back
from .quadrature import SlavePoints
from .recovery.chattering import calmed
from .recovery.debonding import tractions
from .recovery.soft_stick import hardened
from .recovery.stabilisation import Held, release, with_springs
from .search import Projection, merged, project
from .segmentation import Sampling
from .settings import check_settings
from .smoothing import smoothed
from .state import ContactState
from .surface import Surface

#: Largest tractions in the damped tangent's geometric part, over those at which the surfaces give way by a segment.
_LARGEST_TRACTION = 0.1
#: Tractions that differ by this share come from another penalty.
_SAME = 1e-6


class ContactPair(Form):
    """Frictional contact with finite sliding between two boundaries, or a boundary and a rigid obstacle.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh that holds the bodies.
    slave, master
        Names of the boundaries; each must be a single chain.  The paper's advice: the softer body is the slave.
        The master may be a rigid obstacle, e.g. :func:`rigid_line`.
    law
        Interface law: :class:`Coulomb` or :class:`Tied`.
    quadrature
        ``"nodal"``, the paper's node-to-segment with tributary lengths (where meshes match, see `smoothing`); the
        number of Gauss points on each slave segment (surface-to-surface), or on each of the equal pieces that are no
        longer than the distance of the master's nodes; or ``"segments"``, Gauss points between cuts by both meshes,
        which passes the patch test.
    penalty
        Traction per penetration: one number for both directions, or (normal, tangential); by default
        :func:`choose_penalties` takes it from the stiffness and the size of the elements on both sides.
    smoothing
        Share alpha of the facets that Hermite curves round off at the master's joints (0 < alpha <= 1/2); joints
        of more than 45 degrees stay sharp.  ``None``: the facets as they are; a node that faces a joint then belongs
        to the facet before it, which costs the mirror symmetry of meshes that match: smoothing of 0.1 restores it.
    enforcement
        ``None``: penalty; or :class:`AugmentedLagrangian`, whose result does not depend on the penalty.
    initial
        ``"as meshed"``: gaps and overlaps count; ``"adjusted"``: what lies within half a segment touches exactly;
        ``"ramped"``: overlaps are resolved in steps (interference fits).
    share
        Share of the contact work, 1/2 for each of two pairs with the roles swapped (:func:`two_pass`).
    tangent
        ``"exact"``, or ``"primary"``: the paper's eqs 20 to 22 without the rotation and curvature parts.  Where the
        iterations make no progress these parts are limited: bodies that overlap on the way to the solution exert
        tractions that would turn the facets.

    Raises
    ------
    ValueError
        Unknown boundary, no single chain, slave and master that share nodes, penalty not positive, alpha out of range.

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

    def __init__(self, basis: CellBasis, slave: str, master: str | Surface, law: InterfaceLaw,
                 quadrature: Literal["nodal", "segments"] | int = "nodal",
                 penalty: float | tuple[float, float] | None = None,
                 smoothing: float | None = None, enforcement: AugmentedLagrangian | None = None,
                 initial: Fit = "as meshed", share: float = 1.0,
                 tangent: Literal["exact", "primary"] = "exact") -> None:
        check_basis(basis)
        self.slave = Surface.from_boundary(basis, slave)
        self.facets = master if isinstance(master, Surface) else Surface.from_boundary(basis, master)
        self.master = (self.facets if smoothing is None else smoothed(self.facets, smoothing)).facing(self.slave)
        if np.isin(self.slave.dofs[:, 0], self.master.dofs[:, 0]).any():
            raise ValueError(f"slave '{slave}' and master '{self.master.name}' share nodes: a body cannot touch "
                             "itself there; separate the bodies with join_bodies")
        check_settings(law, quadrature, enforcement, initial, share, tangent)
        self.law, self.quadrature, self.tangent = law, quadrature, tangent
        self._sampling = Sampling(self.slave, self.master, quadrature)
        self._neighbours, self._gathering = NeighbourList(self.master), Gathering(basis.N)
        self.enforcement, self.initial, self.share = enforcement, initial, share
        self.size: int = int(basis.N)
        self.penalty: tuple[float, float] | None = None
        self.stiffness: float | None = None
        if penalty is not None:
            both = penalty if isinstance(penalty, tuple) and len(penalty) == 2 else (penalty, penalty)
            self.penalty = self.with_penalty(*both).penalty

    def __repr__(self) -> str:
        return (f"<ContactPair {self.slave.name} on {self.master.name}, {len(self.slave.segments)} segments, "
                f"quadrature {self.quadrature}, {self.law!r}>")

    @cached_property
    def joins(self) -> ndarray:  # type: ignore[override]
        """The unknowns of the two surfaces; -1 among them for a rigid obstacle."""
        return np.unique(np.concatenate((self.slave.dofs.ravel(), self.facets.dofs.ravel())))

    unilateral = True

    @property
    def strengths(self) -> tuple[str, ...]:  # type: ignore[override]
        """``""``, the pair as a whole, where its law can be reduced."""
        return ("",) if hasattr(self.law, "reduced") else ()

    def reduced(self, factor: float, flow: str, names: Collection[str]) -> ContactPair:
        """The same pair with the strength of its law divided by a factor."""
        return self.with_law(self.law.reduced(factor)) if names else self  # type: ignore[attr-defined]

    def first_geometry(self, x: ndarray, state: ContactState) -> tuple[FirstGeometry, HeldState]:
        """The pair with its geometry held as it is at some displacements, and its state."""
        held = FirstGeometry(self, x, state)
        return held, held.held(state)

    @property
    def nodes(self) -> tuple[ndarray, ndarray]:  # type: ignore[override]
        """Unknowns of the slave's nodes, and their places."""
        return self.slave.dofs[:, 0], self.slave.nodes.T

    @cached_property
    def changing(self) -> ndarray:  # type: ignore[override]
        """The unknowns that the pair acts on."""
        return self.joins[self.joins >= 0]

    @property
    def symmetric(self) -> bool:  # type: ignore[override]
        """Whether the tangent is symmetric: the law has an attribute `symmetric` that says so.

        Points that stick have no symmetric tangent once they carry shear or have slipped elastically.
        """
        return getattr(self.law, "symmetric", False)

    # -- what is given once ---------------------------------------------------------------------------------

    def with_penalty(self, normal: float, tangential: float, stiffness: float | None = None) -> ContactPair:
        """The same pair with other penalties.

        Parameters
        ----------
        normal, tangential
            Traction per penetration and per elastic slip.
        stiffness
            Traction per displacement of the bodies' surfaces, about E/h: what the augmented method measures a
            penetration by.
        """
        for value in (normal, tangential):
            if not isinstance(value, (int, float, np.number)) or not 0 < value < np.inf:
                raise ValueError(f"penalties must be positive numbers, not {value!r}")
        new = copy(self)
        new.penalty, new.stiffness = (float(normal), float(tangential)), stiffness
        return new

    def with_law(self, law: InterfaceLaw) -> ContactPair:
        """The same pair with another interface law."""
        new = copy(self)
        new.law = law
        return new

    def points(self, state: ContactState) -> SlavePoints:
        """The slave's points at which a state holds."""
        return self._sampling.points(state.cuts)

    def initial_state(self, x: ndarray | None = None) -> ContactState:
        """Nothing has moved: each point sticks to its initial closest point (eq. 7, ``xi_0 = xi_c``).

        Parameters
        ----------
        x
            Displacements, (N,), that the bodies have when the pair becomes active. Gaps are still those of the mesh,
            or as adjusted: bodies are built to fit into displaced surfaces, and touch them without traction.
        """
        mesh = self._places(np.zeros(self.size))
        slave, master = mesh if x is None else self._places(x)
        cuts = self._sampling.cuts(slave, master)
        points = self._sampling.points(cuts)
        found = self._project(points, master, points.positions(slave))
        meshed = found if x is None else self._project(points, mesh[1], points.positions(mesh[0]))
        offset = touching(found.gap, meshed.gap, points.size, self.initial, self.law.bonds)
        arc, zero, nodal = self._arc(found), np.zeros(len(found.gap)), np.zeros(len(slave))
        never = np.zeros(len(arc), bool)
        status = np.where(found.gap <= offset, int(Status.STICK), int(Status.OPEN))
        stiffening = np.ones(2)
        if self.enforcement is not None and self.penalty is not None and self.stiffness is not None:
            stiffening = self.enforcement.start(self.penalty, self.stiffness)
        return ContactState(stick_point=arc, arc=arc, segment=_segments(found), gap=found.gap, slip=zero,
                            normal=zero, tangential=zero, status=status,
                            normal_multiplier=nodal, tangential_multiplier=nodal, stiffening=stiffening,
                            offset=offset, cuts=cuts, springs=np.zeros(1), frozen=never, recuts=np.zeros(1),
                            softness=np.ones(1), shift=zero, broken=never)

    # -- the form -------------------------------------------------------------------------------------------

    def assemble(self, x: ndarray, state: ContactState) -> Response:
        """Contact force, tangent and candidate state at the displacements ``x``.

        Parameters
        ----------
        x
            Displacements, (N,).
        state
            The last accepted state.
        """
        slave, nodes = self._places(x)
        points = self.points(state)
        positions = points.positions(slave)
        held = state.springs[0] > 0.0
        law = Held(self.law, float(state.springs[0])) if held else self.law
        depth = np.full(len(points.arc), np.inf) if held else self._depth(points)
        normal_penalty, tangential_penalty = penalties = self.penalties(state)
        closing = state.offset - points.at(state.normal_multiplier) / normal_penalty
        bonded = state.status != int(Status.OPEN)
        around = self._neighbours.at(nodes, positions)
        near = bonded | (around.clearance <= np.maximum(depth, closing))  # the others need not be projected

        def projected(chosen: ndarray) -> Projection:
            return project(self.master, nodes, positions, depth, state.segment, state.frozen, around.of(chosen))

        found = projected(near)
        gap = found.gap - closing
        exact = ROUND_OFF * float(np.abs(nodes).max())
        gap = np.where(np.abs(gap) <= exact, 0.0, gap)
        at = np.flatnonzero(found.found & law.reaches(gap, normal_penalty, bonded & ~state.broken))

        kinematics = variations(points, self.slave, self.master, at, found, positions,
                                state.stick_point - state.shift, nodes)
        shift = points.at(state.tangential_multiplier)[at] / tangential_penalty
        slip = kinematics.stretch * kinematics.elastic_arc + shift
        traction = tractions(law, state.broken[at], gap[at], slip, penalties)

        weight = self.share * points.weight[at]
        force = ((weight * traction.normal)[:, None] * kinematics.gap_gradient
                 + (weight * traction.tangential)[:, None] * kinematics.tangential)
        elastic = (traction.elastic_slip - shift) / kinematics.stretch
        return Response(self._gathering.force(kinematics.dofs, force),
                        lambda: self._candidate(state, merged(near, found, projected), at, traction, elastic),
                        lambda: self._stiffness(kinematics, traction, weight, self.tangent == "exact"),
                        lambda: self._stiffness(kinematics, self._limited(traction), weight, self.tangent == "exact"),
                        round_off=max(penalties) * exact * float(np.linalg.norm(weight)))

    def penalties(self, state: ContactState) -> tuple[float, float]:
        """Normal and tangential penalty in a state."""
        if self.penalty is None:
            raise ValueError(f"contact of '{self.slave.name}' on '{self.master.name}' has no penalty yet: give "
                             "`penalty=`, or call choose_penalties(forms), which `run` does for you")
        normal, tangential = self.penalty * state.stiffening
        return float(normal), float(tangential * state.softness[0])

    def _places(self, x: ndarray) -> tuple[ndarray, ndarray]:
        """Nodes of both surfaces, seen from the middle of the slave: large coordinates would cost digits."""
        origin = self.slave.middle
        return self.slave.positions(x, origin), self.master.positions(x, origin)

    def _project(self, points: SlavePoints, nodes: ndarray, positions: ndarray,
                 previous: ndarray | None = None) -> Projection:
        return project(self.master, nodes, positions, self._depth(points), previous)

    def _depth(self, points: SlavePoints) -> ndarray:
        """Largest penetration: what is deeper than an element or so belongs to the other side of the body."""
        return np.maximum(points.size, self.master.spacing)

    def _arc(self, found: Projection) -> ndarray:
        arc, at = np.full(len(found.gap), np.nan), np.isfinite(found.gap)
        arc[at] = self.master.arc(found.segment[at], found.xi[at])[0]
        return arc

    def _candidate(self, state: ContactState, found: Projection, at: ndarray, traction: Traction,
                   elastic_arc: ndarray) -> ContactState:
        """Open points take their closest point along as stick point, sliding ones drag it behind (eq. 10)."""
        arc, zero = self._arc(found), np.zeros(len(found.gap))
        stick_point, normal, tangential = arc.copy(), zero.copy(), zero.copy()
        status = np.full(len(arc), int(Status.OPEN))
        stick_point[at] -= elastic_arc
        normal[at], tangential[at], status[at] = traction.normal, traction.tangential, traction.status
        moved = self.master.along(arc - state.arc)
        slip = np.where(status == Status.OPEN, 0.0, state.slip + np.where(np.isnan(moved), 0.0, moved))
        return replace(state, stick_point=stick_point, arc=arc, segment=_segments(found), gap=found.gap, slip=slip,
                       normal=normal, tangential=tangential, status=status, frozen=np.zeros(len(arc), bool),
                       recuts=np.zeros(1))

    def _stiffness(self, kinematics: Kinematics, traction: Traction, weight: ndarray, exact: bool) -> csr_matrix:
        K = tangents(kinematics, traction, exact) * weight[:, None, None]
        return self._gathering.matrix(kinematics.dofs, K)

    def _limited(self, traction: Traction) -> Traction:
        """The tractions as far as the bodies could bear them, for without any a round body could turn freely."""
        if self.stiffness is None:
            return traction
        largest = _LARGEST_TRACTION * self.stiffness * self.slave.spacing
        return traction._replace(normal=np.clip(traction.normal, -largest, largest),
                                 tangential=np.clip(traction.tangential, -largest, largest))

    # -- what the analysis asks besides ---------------------------------------------------------------------

    def completed(self, forms: Mapping[str, Form]) -> ContactPair:
        """The pair with the stiffness of its surfaces, and a penalty that suits it where none is given."""
        return self if self.stiffness is not None else with_chosen_penalty(self, forms)

    def continues(self, old: Form) -> ContactPair:
        """The pair in the place of another one between the same surfaces, with its penalty unless it has its own."""
        if not isinstance(old, ContactPair) or (old.slave.name, old.facets.name, old.quadrature) \
                != (self.slave.name, self.facets.name, self.quadrature):
            raise ValueError("its surfaces are others")
        if self.penalty is not None or old.penalty is None:
            return self
        return self.with_penalty(*old.penalty, stiffness=old.stiffness)

    def replaces(self, old: Form) -> bool:
        """Whether an old form was a pair between the same surfaces."""
        return isinstance(old, ContactPair) and \
            {old.slave.name, old.facets.name} == {self.slave.name, self.facets.name}

    def fits(self, state: ContactState) -> bool:
        """Whether a state has the points of this pair."""
        if self.quadrature == "segments":
            return len(state.cuts) > 0 and state.cuts[-1] == len(self.slave.segments)
        changes = ("correction", "stalls")  # empty before multipliers are corrected
        initial = self.initial_state()
        return all(np.shape(getattr(state, f.name)) == np.shape(getattr(initial, f.name))
                   for f in fields(initial) if f.name not in changes)

    def check_start(self, x: ndarray, state: ContactState) -> None:
        """Refuse a state that another penalty has led to."""
        new = self.assemble(x, state).state
        both = (new.status != Status.OPEN) & (state.status != Status.OPEN)
        if np.abs(new.normal - state.normal)[both].max(initial=0.0) > _SAME * np.abs(state.normal).max(initial=0.0):
            raise ValueError("its penalty is another one than in the start: give `penalty=`, or use "
                             "choose_penalties(forms) of the same forms in both analyses")

    def tractions_at(self, x: ndarray, state: ContactState) -> TractionOperator:
        """How tractions at the points that are not open make nodal forces."""
        return TractionOperator(self, x, state)

    def moved_back(self, x: ndarray, state: ContactState) -> ContactState:
        """The state of bodies that are back in their places, with all it carries."""
        return moved_back(self, state)

    def outer(self, x: ndarray, accepted: ContactState, candidate: ContactState) -> ContactState | None:
        """State from which the same increment must be solved once more, or None where nothing is left to do.

        The cuts of ``quadrature="segments"`` follow the bodies here, the augmented method improves its multipliers,
        overlaps are resolved in steps, springs that held the bodies are taken away, and a soft stick is hardened.

        Raises
        ------
        IncrementTooLarge
            Points have passed through the master.
        """
        points = self.points(accepted)
        if passed := passed_through(self._depth(points), accepted, candidate):
            raise IncrementTooLarge(f"{passed} of {len(points.arc)} points of '{self.slave.name}' have passed through "
                                    f"'{self.master.name}', or the penalty, {self.penalties(accepted)[0]:.3g}, is soft")
        if accepted.springs.any():
            return release(accepted, candidate, points.weight)
        if accepted.softness[0] < 1.0:
            return hardened(accepted, candidate, self.master)
        if self.initial == "ramped" and accepted.offset.any():
            return replace(accepted, offset=less_overlap(accepted.offset, points.size))
        again = None
        if self.enforcement is not None:
            stiffness = self.penalty[0] if self.stiffness is None else self.stiffness  # type: ignore[index]
            again = self.enforcement.augment(accepted, candidate, points, self.penalties(accepted), stiffness)
        return self._sampling.follow(again or accepted, *self._places(x)) or again

    def hold(self, state: ContactState) -> ContactState:
        """The state with soft springs that close the gaps; :meth:`outer` takes them away again."""
        return state if self.law.bonds else with_springs(state)

    def calm(self, state: ContactState, *candidates: ContactState) -> ContactState:
        """The state with points that go to and fro frozen to their facet, sticking softly or without a bond."""
        hardness = 1.0 if self.stiffness is None else self.penalties(state)[1] / self.stiffness
        return calmed(state, candidates, self.slave.name, self.master, self.law, hardness)

    def summary(self, state: ContactState) -> str:
        """Counts of open, sticking and slipping points, for the table of a result."""
        counts = np.bincount(state.status, minlength=3)
        return f"{counts[Status.STICK]} stick, {counts[Status.SLIP]} slip, {counts[Status.OPEN]} open"

    def penetration(self, state: ContactState) -> float:
        """Largest penetration as a share of the slave segment there."""
        return penetration(self.points(state), state)

    def remarks(self, state: ContactState) -> list[Remark]:
        """What a user should know of an accepted state: contact that is not there, or not where it should be."""
        points = self.points(state)
        return list(remarks(self.slave, self.master, points, self._depth(points), self.penalties(state), state))


def _segments(found: Projection) -> ndarray:
    return np.where(found.found, found.segment, -1)
