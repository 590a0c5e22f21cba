"""Contact pair: force, tangent and state of two surfaces with a law and a quadrature rule."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import override

from ..checks import check_size
from ..errors import Failure, IncrementTooLarge
from ..forms.base import Form, Outputs, Response
from ..forms.roles import arrays_of
from . import regularisation
from .base import ContactBase, initial_clearance
from .diagnosis import remarks
from .growth import foreseen
from .interface import RECUTS, ROUND_OFF, ContactState
from .kinematics import Kinematics, dragged, tangents, variations
from .laws import InterfaceLaw, LawUpdate, Status, resisting
from .multipliers import Nodes, idle, respond
from .penalty import AugmentedLagrangian, Progress
from .prestress import LinearisedContact, TractionOperator

#: Largest tractions in the damped tangent's geometric part, over those at which the surfaces yield
#: by a segment.
_LARGEST_TRACTION = 0.1
#: Tractions that differ by this share come from another penalty; and the share of the largest one
#: that counts.
_SAME, _COUNTS = 1e-6, 1e-3


class ContactPair(ContactBase):
    """Frictional contact with finite sliding between two surfaces, of which one may be rigid.

    Parameters
    ----------
    basis : Basis or None
        Basis of the mesh that holds the bodies; None where both sides are surfaces.
    slave, master : str or Surface
        Names of boundaries, in the plane each a single chain, or any :class:`Surface`: of a beam or
        shell, or rigid, such as ``rigid.line(...)``.  The paper's advice: the softer body is the
        slave.
    law : InterfaceLaw
        :class:`Coulomb`, :class:`Tied`, or your own :class:`~skfem_contact.InterfaceLaw`.
    quadrature : "segments", "nodal" or int
        ``"segments"``: Gauss points between cuts by both meshes, which pass the patch test.  A
        number: Gauss points on each slave segment (surface-to-surface), or on equal pieces no
        longer than the distance of the master's nodes. ``"nodal"``: the paper's node-to-segment
        with tributary lengths; across meshes that do not match its stresses err by 6 to 29 % in a
        patch test.
    penalty : float or tuple, optional
        Traction per penetration: one number for both directions, or (normal, tangential); by
        default chosen from the stiffness and the size of the elements on both sides.
    smoothing : float, optional
        Share alpha of the facets that Hermite curves round off at the master's joints (0 < alpha <=
        1/2); joints of more than 45 degrees stay sharp.  ``None``: a node that faces a joint
        belongs to the facet before it, which costs the mirror symmetry of meshes that match; a
        smoothing of 0.1 restores it.
    enforcement : AugmentedLagrangian or DualMultipliers, optional
        ``None``: penalty; :class:`DualMultipliers`, which know none; or
        :class:`AugmentedLagrangian`, whose result does not depend on it.
    initial : str or float
        ``"as meshed"``: gaps and overlaps count; ``"adjusted"``: points within half a segment touch
        exactly; ``"ramped"``: overlaps are resolved in steps; a number: an interference of adjusted
        bodies.
    share : float
        Share of the contact work, 1/2 for each pair of :meth:`two_pass`.
    tangent : "exact" or "primary"
        ``"exact"``, or ``"primary"``: the paper's eqs 20 to 22 without the rotation and curvature
        parts.  Where the iterations make no progress these parts are limited: tractions of bodies
        that overlap would turn the facets.

    Raises
    ------
    ValueError
        Unknown boundary, no single chain, slave and master that share nodes, penalty not positive,
        alpha out of range.

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
    >>> out = pair.assemble(x, pair.initial_state())
    >>> out.state.traction[0].round(9).tolist()
    [-10.0, -10.0, -10.0]
    """

    _progress, _recuts = Progress(), 0

    @classmethod
    def two_pass(
        cls, basis: CellBasis, a: str, b: str, law: InterfaceLaw, **options: Any
    ) -> dict[str, ContactPair]:
        """Return two pairs with the roles swapped, each with half of the contact work: contact
        without bias.

        Parameters
        ----------
        basis, law
            Basis and law of :class:`ContactPair`.
        a, b : str
            Names of the boundaries; the forms are named ``"a on b"`` and ``"b on a"``.
        options
            Further arguments of :class:`ContactPair`; ``quadrature="nodal"`` unless it is given.

        Examples
        --------
        >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
        >>> import skfem_contact as sc
        >>> block = MeshQuad().refined(1).with_defaults()
        >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
        >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
        >>> list(sc.ContactPair.two_pass(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=.3)))
        ['upper:bottom on lower:top', 'lower:top on upper:bottom']
        """
        options = {"quadrature": "nodal", **options}
        return {
            f"{slave} on {master}": cls(basis, slave, master, law, share=0.5, **options)
            for slave, master in ((a, b), (b, a))
        }

    @override
    def initial_state(self, x: ndarray | None = None) -> ContactState:
        """Return the state of points that stick to their initial closest points (eq. 7, ``xi_0 =
        xi_c``).

        Parameters
        ----------
        x : ndarray, shape (N,), optional
            Displacements at which the pair becomes active. Gaps are still those of the mesh, or as
            adjusted: bodies are built to fit into displaced surfaces, and touch them without
            traction.
        """
        cuts = self.interface.cuts(x)
        points, found = self.interface.points(cuts), self.interface.closest(x, cuts)
        meshed = found if x is None else self.interface.closest(None, cuts)
        clearance = initial_clearance(
            found.gap, meshed.gap, points.size, self.initial, self.law.bonds
        )
        n, nodal, dim, closest = (
            len(found.gap),
            len(self.slave.nodes),
            self.slave.dim,
            found.closest,
        )
        status = np.where(found.gap <= clearance, int(Status.STICK), int(Status.OPEN))
        factor = np.ones(2)
        if (
            isinstance(self.enforcement, AugmentedLagrangian)
            and self.penalty
            and self.stiffness is not None
        ):
            factor = self.enforcement.start(self.penalty, self.stiffness)
        closed = (
            np.zeros(nodal, bool)
            if not self.dual
            else status[Nodes.of(self.slave, points).point] != Status.OPEN
        )
        return ContactState(
            facet=closest.facet,
            position=closest.xi.T,
            stick_facet=closest.facet,
            stick_point=closest.xi.T,
            gap=found.gap,
            slip=np.zeros((dim - 1, n)),
            closing_slip=np.zeros(n),
            traction=np.zeros((dim, n)),
            status=status,
            internal=np.zeros((self.law.n_internal, n)),
            multiplier=np.zeros((dim, nodal)),
            penalty_factor=factor,
            clearance=clearance,
            closed=closed,
            cuts=cuts,
        )

    @override
    def assemble(self, x: ndarray, state: ContactState) -> Response:
        check_size(x, self.size)
        if self.dual:
            if len(self.multipliers) == 0:
                raise ValueError(
                    "the multipliers are dofs of a model: take the pair from Model(forms).forms"
                )
            return respond(self, x, state)
        slave, nodes = self.interface.positions(x)
        points, exact = self.points(state), ROUND_OFF * float(np.abs(nodes).max())
        accepted, state, law = state, self.effective(state), self.law
        depth = (
            np.full(len(points.weight), np.inf) if law.reaches_far else self.interface.depth(points)
        )
        penalties = self.penalties(state)
        closing = state.clearance - points.at(state.multiplier[0]) / penalties[0]
        found, everywhere = self.interface.near(slave, nodes, state, closing + exact, depth)
        gap = found.gap - closing
        gap = np.where(np.abs(gap) <= exact, 0.0, gap)
        closed = state.status != Status.OPEN
        at = np.flatnonzero(found.found & law.take(points).reaches(gap, state.internal, closed))
        closing_points = points.take(at)
        kinematics = variations(
            closing_points,
            self.slave,
            self.master,
            found.take(at),
            slave,
            nodes,
            state.stick.take(at),
        )
        multiplied = closing_points.at(state.multiplier[1:].T).T / penalties[1]
        slip = kinematics.slip.T + multiplied
        if self.slip_shift is not None:
            slip = slip + self.slip_shift[:, at]
        update = law.take(closing_points).update(
            np.stack((gap[at], *slip)), state.internal[:, at], penalties
        )

        weight = self.share * closing_points.weight
        force = weight[:, None] * np.einsum(
            "in,nim->nm", update.traction, kinematics.expanded(kinematics.work)
        )
        elastic = np.where(update.status == Status.OPEN, 0.0, update.elastic_slip - multiplied)

        def candidate() -> ContactState:
            stick, closest = (
                dragged(kinematics, self.master, nodes, state.stick.take(at), elastic),
                everywhere(),
            )
            slip = accepted.slip + self.interface.slid(accepted, closest.closest)
            return state.after(closest, at, update, stick, slip)

        return Response(
            self.gathering.force(kinematics.dofs, force),
            candidate,
            lambda: self._stiffness(kinematics, update, weight),
            lambda: self._stiffness(kinematics, self._limited(update, slip), weight),
            round_off=max(penalties) * exact * float(np.linalg.norm(weight)),
            active=at.tobytes() + update.status.tobytes(),
        )

    def _stiffness(self, kinematics: Kinematics, update: LawUpdate, weight: ndarray) -> csr_matrix:
        K = tangents(
            kinematics, weight * update.traction, weight * update.tangent, self.tangent == "exact"
        )
        return self.gathering.matrix(kinematics.dofs, K)

    @property
    def largest_traction(self) -> float:
        """Largest traction in the damped tangent's geometric part."""
        return (
            np.inf
            if self.stiffness is None
            else _LARGEST_TRACTION * self.stiffness * self.slave.spacing
        )

    def _limited(self, update: LawUpdate, slip: ndarray) -> LawUpdate:
        """Return the update with tractions limited to what the bodies resist; without any a round
        body turns freely.
        """
        limited = np.clip(update.traction, -self.largest_traction, self.largest_traction)
        return resisting(update, slip)._replace(traction=limited)

    @override
    def outer(
        self, x: ndarray, accepted: ContactState, found: ContactState
    ) -> tuple[ContactPair, ContactState] | None:
        """Return the pair and the accepted state with which the increment must be solved once more,
        or None.

        A regularised pair proceeds to the next one, the augmented method improves its multipliers,
        and the cuts of ``quadrature="segments"`` follow the bodies.

        Raises
        ------
        IncrementTooLarge
            Points have passed through the master.
        """
        points = self.points(accepted)
        if passed := self.interface.passed_through(x, accepted, found):
            raise IncrementTooLarge(
                f"{passed} of {len(points.weight)} points of '{self.slave.name}' have passed "
                f"through '{self.master.name}', or the penalty, "
                f"{self.penalties(accepted)[0]:.3g}, is soft"
            )
        if (new := regularisation.proceed(self, accepted, found)) is not self:
            return new, accepted
        changes: dict[str, Any] = {}
        state = accepted
        if isinstance(self.enforcement, AugmentedLagrangian):
            stiffness = self.penalty[0] if self.stiffness is None else self.stiffness  # type: ignore[index]
            state, changes["_progress"] = self.enforcement.augment(
                accepted, found, points, self.penalties(accepted), stiffness, self._progress
            )
            if (
                harder := state.penalty_factor[1] / accepted.penalty_factor[1]
            ) != 1.0:  # with the same tractions
                state = self.interface.with_elastic_slip(
                    state, self.interface.elastic_slip(state) / harder
                )
        cut = self.interface.follow(state, x) if self._recuts < RECUTS else None
        if cut is not None:
            at = self.interface.nearest(points, self.points(cut))
            state, changes["_recuts"] = cut, self._recuts + 1
            changes |= {
                name: values[..., at]
                for name in ("clearance", "slip_shift", "debonded")
                if (values := getattr(self, name)) is not None
            }
        return None if state is accepted else (self.with_(**changes), state)

    @override
    def begin(self, accepted: ContactState, failure: Failure | None = None) -> ContactPair:
        return regularisation.begin(self, accepted, failure)

    @override
    def idle(self, fixed: ndarray) -> ndarray:
        return idle(self, fixed) if self.dual else super().idle(fixed)

    @override
    def foreseen(
        self, start: ndarray, x: ndarray, before: ndarray | None, accepted: ContactState
    ) -> ndarray:
        return foreseen(self, start, x, before, accepted) if self.dual else start

    @override
    def continues(self, old: Form) -> ContactPair:
        if not isinstance(old, ContactPair) or (
            old.slave.name,
            old.facets.name,
            old.quadrature,
        ) != (self.slave.name, self.facets.name, self.quadrature):
            raise ValueError("its surfaces are others")
        if self.dual != old.dual:
            raise ValueError("it has multipliers, or the old one has: keep the enforcement")
        new = (
            self
            if self.complete or not old.complete
            else self._about_axis(old.axisymmetric).with_(complete=True)
        )
        if new.penalty is not None or old.penalty is None:
            return new
        return new.with_penalty(*old.penalty, stiffness=old.stiffness)

    @override
    def replaces(self, old: Form) -> bool:
        return isinstance(old, ContactPair) and {old.slave.name, old.facets.name} == {
            self.slave.name,
            self.facets.name,
        }

    @override
    def fits(self, state: ContactState) -> bool:
        """Return True if a state has the points of this pair; internal variables may be those of
        another law.
        """
        if self.quadrature == "segments":
            return self.interface.fits(state.cuts)
        initial = arrays_of(self.initial_state())
        return all(
            np.shape(values) == np.shape(initial[name])
            for name, values in arrays_of(state).items()
            if name != "internal"
        )

    @override
    def check_start(self, x: ndarray, state: ContactState) -> None:
        new, pressure = self.assemble(x, state).state, state.traction[0]
        both = (new.status != Status.OPEN) & (
            np.abs(pressure) > _COUNTS * np.abs(pressure).max(initial=0.0)
        )
        # points at the ends of cuts that have followed the bodies may differ by themselves
        if both.any() and np.median(np.abs(new.traction[0][both] / pressure[both] - 1.0)) > _SAME:
            raise ValueError(
                "its penalty is another one than in the start: give `penalty=`, or build "
                "both models from the same forms"
            )

    @override
    def tractions_at(self, x: ndarray, state: ContactState) -> TractionOperator:
        return TractionOperator(self, x, state)

    @override
    def rebased(self, x: ndarray, state: ContactState) -> ContactState:
        home, face = self.initial_state(), self.interface
        old, new = self.points(state), self.points(home)
        elastic = face.elastic_slip(state)
        if self.quadrature == "segments":
            excess = np.where(np.isfinite(state.gap), state.gap - state.clearance, 0.0)
            excess, elastic = face.interpolated(old, new, (excess, elastic))
            state = replace(
                face.transferred(state, home.cuts, None),
                clearance=np.zeros(len(excess)),
                gap=excess,
            )
        near = np.isfinite(home.gap) & np.isfinite(state.gap)
        clearance = np.where(near, home.gap - (state.gap - state.clearance), 0.0)
        state = replace(
            state,
            facet=home.facet,
            position=home.position,
            gap=home.gap,
            clearance=clearance,
            slip=np.zeros_like(state.slip),
            closing_slip=np.zeros_like(state.gap),
        )
        return face.with_elastic_slip(state.with_stick(home.stick), elastic)

    @override
    def fixed_geometry(
        self, x: ndarray, state: ContactState
    ) -> tuple[LinearisedContact, ContactState]:
        if self.dual:
            raise ValueError(
                f"contact of '{self.slave.name}' has DualMultipliers: searches for a collapse are "
                f"for the "
                "penalty method and AugmentedLagrangian()"
            )
        held = LinearisedContact(self, x, state)
        return held, held.held(state)

    @override
    def outputs(self, x: ndarray, state: ContactState) -> Outputs:
        counts = np.bincount(state.status, minlength=3)
        stick, slip, opened = counts[Status.STICK], counts[Status.SLIP], counts[Status.OPEN]
        return Outputs(
            summary=f"{stick} stick, {slip} slip, {opened} open",
            remarks=lambda: remarks(self, x, state),
            parameters=self._parameters,
        )
