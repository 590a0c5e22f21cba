"""Contact pair: force, tangent and state of two surfaces with a law and a quadrature rule."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy import ndarray
from skfem import CellBasis
from typing_extensions import override

from ..arrays import max_abs
from ..checks import check_size
from ..errors import Failure, IncrementTooLarge
from ..forms.base import Form, Outputs, Response
from ..forms.roles import arrays_of
from . import regularisation
from .augmented import Progress
from .base import ContactBase, initial_clearance
from .diagnosis import remarks
from .interface import RECUTS, ContactState
from .laws import InterfaceLaw, Status
from .prestress import LinearisedContact, TractionOperator
from .quadrature import SlavePoints
from .search import Projection
from .symmetry import Symmetry

#: Tractions that differ by this share come from another penalty; and the share of the largest one
#: that counts.
_SAME, _COUNTS = 1e-6, 1e-3
#: Parts of a state whose shape is free: settings may differ, and files of older versions lack some.
_FREE = {"internal", "rounded"}
#: Smooth curves touch where their gap is below this share of the gap between facets: curves through
#: 26 and 32 nodes of one circle are .5 % apart, through 40 and 64 .16 %.
_TOUCHING = 0.01
#: Pressure of changes of the clearance between round facets, as a share of the largest one, that
#: are left: each equilibrium leaves a thirtieth of the change before, of pins with flat facets.
#: Displacements of a wavy joint without friction, in 1 to 12 increments, differ by 3e-3 with 2e-3
#: left, where a point is open or not, and by 8e-4 with this, in a fifth more iterations.
_ROUNDED = 5e-4
#: The same where facets match, whose clearance is none: what penetrations show of one.
_MATCHED = 2e-3
#: Clearance of facets that match, as a share of their size.
_NONE = 1e-9


class ContactPair(ContactBase):
    """Frictional contact with finite sliding between two surfaces, of which one may be rigid.

    Parameters
    ----------
    basis : Basis or None
        Basis of the mesh that holds the bodies; None where both sides are surfaces.
    slave, master : str or Surface
        Names of boundaries, in the plane each a single chain, or any :class:`Surface`: of a beam or
        shell, or rigid, such as ``rigid.line(...)``.  The paper's advice: the softer body is the
        slave.  The same name twice is self-contact: the surface folds and touches itself.  Facets
        within three facets of a point along the surface are its neighbours, and no contact; each
        wall is slave and master with half of the work.
    law : InterfaceLaw
        :class:`Coulomb`, :class:`Tied`, or your own :class:`~skfem_contact.InterfaceLaw`.
    quadrature : "segments", "nodal" or int
        ``"segments"``: Gauss points between cuts by both meshes, which pass the patch test.  A
        number: Gauss points on each slave segment (surface-to-surface), or on equal pieces no
        longer than the distance of the master's nodes. ``"nodal"``: the paper's node-to-segment
        with tributary lengths; across meshes that do not match its stresses err by 6 to 29 % in a
        patch test.  Self-contact takes numbers, and by default five points in the plane and three
        in each direction in space.
    penalty : float or tuple, optional
        Traction per penetration: one number for both directions, or (normal, tangential); by
        default chosen from the stiffness and the size of the elements on both sides, to which the
        mirror images at planes of symmetry among the supports of the model belong.
    smoothing : float, optional
        Share alpha of the facets that Hermite curves round off at the master's joints (0 < alpha <=
        1/2); joints of more than 45 degrees stay sharp.  ``None``: a node that faces a joint
        belongs to the facet before it, which costs the mirror symmetry of meshes that match; a
        smoothing of 0.1 restores it.
    enforcement : Penalty, AugmentedLagrangian or DualMultipliers, optional
        By default the penalty method; :class:`DualMultipliers`, which know no penalty; or
        :class:`AugmentedLagrangian`, whose result does not depend on it.
    initial : str or float
        ``"as meshed"``: gaps and overlaps count, between round surfaces in the plane as smooth
        curves have them; ``"adjusted"``: points within half a segment touch exactly; ``"ramped"``:
        overlaps are resolved in steps; a number: an interference of adjusted bodies.
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
        alpha out of range; self-contact of a surface that is too short to fold, or with
        :class:`DualMultipliers`.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> block = MeshQuad().refined(1).with_defaults()
    >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> law = sc.Coulomb(mu=.3)
    >>> pair = sc.ContactPair(basis, "upper:bottom", "lower:top", law, "nodal", penalty=1e4)
    >>> x = basis.zeros()
    >>> upper = mesh.t[:, mesh.subdomains["upper"]]
    >>> x[basis.nodal_dofs[1, upper]] = -1e-3     # press the upper block down
    >>> out = pair.assemble(x, pair.initial_state())
    >>> out.state.traction[0].round(9).tolist()
    [-10.0, -10.0, -10.0]
    """

    progress = Progress()  # of the augmented method in an increment
    _recuts = 0
    _rounds = 0

    @classmethod
    def two_pass(
        cls, basis: CellBasis, a: str, b: str, law: InterfaceLaw, **options: Any
    ) -> dict[str, ContactPair]:
        """Return two pairs with the roles swapped, each with half of the contact work.

        Such contact has no bias.

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
            f"{a} on {b}": cls(basis, a, b, law, share=0.5, **options),
            f"{b} on {a}": cls(basis, b, a, law, share=0.5, **options),
        }

    @override
    def initial_state(self, x: ndarray | None = None) -> ContactState:
        """Return the state of points that stick to their closest points (eq. 7, ``xi_0 = xi_c``).

        Parameters
        ----------
        x : ndarray, shape (N,), optional
            Displacements at which the pair becomes active. Gaps remain as in the mesh, or as
            adjusted: bodies are built to fit into displaced surfaces, and touch them without
            traction.
        """
        cuts = self.interface.cuts(x)
        points = self.interface.points(cuts)
        meshed = self.interface.in_mesh(cuts)
        found = meshed if x is None else self.interface.closest(x, cuts)
        closest = found.closest
        rounded, gap = self._between_curves(points, found)
        if x is None:
            meshed_gap = gap
        else:
            meshed_gap = self._between_curves(points, meshed)[1]
        clearance = initial_clearance(gap, meshed_gap, points.size, self.initial, self.law.bonds)
        # the clearance between smooth curves decides: the sum with `rounded` has round-off
        status = np.where(gap <= clearance, int(Status.STICK), int(Status.OPEN))
        clearance = clearance + rounded
        n = len(found.gap)
        n_nodes = len(self.slave.nodes)
        dim = self.slave.dim
        state = ContactState(
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
            multiplier=np.zeros((dim, n_nodes)),
            penalty_factor=np.ones(2),
            clearance=clearance,
            closed=np.zeros(n_nodes, bool),
            cuts=cuts,
            rounded=rounded,
        )
        return self.enforcement.start(self, state)

    @override
    def assemble(self, x: ndarray, state: ContactState) -> Response:
        check_size(x, self.size)
        return self.enforcement.respond(self, x, state)

    @override
    def outer(
        self, x: ndarray, accepted: ContactState, found: ContactState
    ) -> tuple[ContactPair, ContactState] | None:
        """Return the pair and the accepted state to solve the increment with once more, or None.

        A regularised pair proceeds to the next one, the augmented method improves its multipliers,
        and the cuts of ``quadrature="segments"`` follow the bodies.

        Raises
        ------
        IncrementTooLarge
            Points have passed through the master.
        """
        points = self.points(accepted)
        passed = self.interface.passed_through(x, accepted, found)
        if passed:
            raise IncrementTooLarge(
                f"{passed} of {len(points.weight)} points of '{self.slave.name}' have passed "
                f"through '{self.master.name}', or the penalty, "
                f"{self.penalties(accepted)[0]:.3g}, is soft"
            )
        regularised = regularisation.proceed(self, accepted, found)
        if regularised is not self:
            return regularised, accepted
        state, changes = self.enforcement.after_equilibrium(self, accepted, found)

        # Let the cuts follow the bodies
        moved = None
        if self._recuts < RECUTS:
            moved = self.interface.follow(state, found, x)
        if moved is not None:
            state, transfer = moved
            changes = self._at_cuts(accepted, state, transfer.at, changes)
        elif self._rounds < RECUTS:
            # Let the clearance between round facets follow
            rounded = self._rounded_anew(accepted, found)
            if rounded is not None:
                change = rounded - state.rounded
                state = replace(state, clearance=state.clearance + change, rounded=rounded)
                changes["_rounds"] = self._rounds + 1
                if self.clearance is not None:
                    changes["clearance"] = self.clearance + change
        if state is accepted:
            return None
        return (self.with_(**changes), state)

    def _at_cuts(
        self, accepted: ContactState, cut: ContactState, at: ndarray, changes: dict[str, Any]
    ) -> dict[str, Any]:
        """Return changes of the pair with its own values, of the points `at`, between new cuts."""
        changes = {**changes, "_recuts": self._recuts + 1}
        for name in ("slip_shift", "debonded"):
            values = changes.get(name, getattr(self, name))
            if values is not None:
                changes[name] = values[..., at]
        if self.clearance is not None:
            without = (self.clearance - accepted.rounded)[..., at]
            further = self.interface.clearance_between(accepted.cuts, cut.cuts, at)
            changes["clearance"] = without + further + cut.rounded
        return changes

    def _between_curves(self, points: SlavePoints, found: Projection) -> tuple[ndarray, ndarray]:
        """Return gaps of facets whose smooth curves touch, and gaps between the curves, (n,) each.

        Curves that are closer than their own error touch.
        """
        rounded = self.interface.faceting(points, found.closest)
        gap = found.gap - rounded
        touching = np.abs(gap) < _TOUCHING * np.abs(rounded)
        return np.where(touching, found.gap, rounded), np.where(touching, 0.0, gap)

    def _rounded_anew(self, accepted: ContactState, found: ContactState) -> ndarray | None:
        """Return that part of the clearance at found positions, (n,); None where it suffices."""
        if not self.interface.smooth:
            return None
        rounded = self.interface.faceting(self.points(accepted), found.closest)
        pressure = np.abs(found.traction[0])
        change = np.abs(rounded - accepted.rounded)[pressure > 0.0].max(initial=0.0)
        stiffness = self.stiffness or self.penalties(accepted)[0]
        matched = max_abs(accepted.rounded) <= _NONE * self.slave.size.max()
        left = _MATCHED if matched else _ROUNDED
        if stiffness * change <= left * pressure.max(initial=0.0):
            return None
        return rounded

    @override
    def begin(self, accepted: ContactState, failure: Failure | None = None) -> ContactPair:
        return regularisation.begin(self.choosing_facets(accepted), accepted, failure)

    @override
    def supported(self, fixed: ndarray) -> tuple[ContactPair, ndarray]:
        symmetry = Symmetry.of(self.slave, self.facets, fixed)
        if self.saddle:
            idle = self.multipliers[1:][symmetry.along]
        else:
            idle = np.zeros(0, int)
        interface = self.interface
        ends = [plane[:2] for plane in symmetry.planes]
        if ends != [plane[:2] for plane in interface.planes]:
            interface = replace(interface, planes=symmetry.planes)
        return self.with_(symmetry=symmetry, interface=interface), idle

    @override
    def foreseen(
        self, start: ndarray, x: ndarray, before: ndarray | None, accepted: ContactState
    ) -> ndarray:
        return self.enforcement.foreseen(self, start, x, before, accepted)

    @override
    def continues(self, old: Form) -> ContactPair:
        if not isinstance(old, ContactPair) or self._rule != old._rule:
            raise ValueError("its surfaces are others")
        if self.saddle != old.saddle:
            raise ValueError("it has multipliers, or the old one has: keep the enforcement")
        new = self._about_axis(old.axisymmetric).with_(complete=old.complete, finite=old.finite)
        if new.penalty is not None or old.penalty is None:
            return new
        return new.with_penalty(*old.penalty, stiffness=old.stiffness)

    @property
    def _rule(self) -> tuple[Any, ...]:
        """Surfaces and quadrature, which a pair that continues another one shares with it."""
        return self.slave.name, self.facets.name, self.quadrature

    @override
    def replaces(self, old: Form) -> bool:
        return isinstance(old, ContactPair) and {old.slave.name, old.facets.name} == {
            self.slave.name,
            self.facets.name,
        }

    @override
    def fits(self, state: ContactState) -> bool:
        """Return True if a state has this pair's points; internal variables may differ."""
        if self.quadrature == "segments":
            return self.interface.fits(state.cuts)
        initial = arrays_of(self.initial_state())
        for name, values in arrays_of(state).items():
            if name not in _FREE and np.shape(values) != np.shape(initial[name]):
                return False
        return True

    @override
    def check_start(self, x: ndarray, state: ContactState) -> None:
        new = self.assemble(x, state).state
        pressure = state.traction[0]
        counts = np.abs(pressure) > _COUNTS * max_abs(pressure)
        both = (new.status != Status.OPEN) & counts
        if not both.any():
            return
        # Points at the ends of cuts that have followed the bodies may differ by themselves
        change = np.abs(new.traction[0][both] / pressure[both] - 1.0)
        if np.median(change) > _SAME:
            raise ValueError(
                "its penalty is another one than in the start: give `penalty=`, or build "
                "both models from the same forms"
            )

    @override
    def tractions_at(self, x: ndarray, state: ContactState) -> TractionOperator:
        return TractionOperator(self, x, state)

    @override
    def rebased(self, x: ndarray, state: ContactState) -> ContactState:
        home = self.initial_state()
        interface = self.interface
        elastic = interface.elastic_slip(state)

        # Take the state to the cuts of the mesh
        if self.quadrature == "segments":
            transfer = interface.transfer(state.cuts, home.cuts)
            excess = np.where(np.isfinite(state.gap), state.gap - state.clearance, 0.0)
            excess = transfer.of(excess)
            elastic = transfer.of(elastic)
            state = replace(
                interface.transferred(transfer, state, home.cuts),
                clearance=np.zeros(len(excess)),
                rounded=interface.faceting(transfer.new, home.closest),
                gap=excess,
            )

        # Keep penetration and elastic slip at the closest points in the mesh
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
        return interface.with_elastic_slip(state.with_stick(home.stick), elastic)

    @override
    def fixed_geometry(
        self, x: ndarray, state: ContactState
    ) -> tuple[LinearisedContact, ContactState]:
        self.enforcement.check_collapse(self.slave)
        fixed = LinearisedContact(self, x, state)
        return fixed, fixed.held(state)

    @override
    def outputs(self, x: ndarray, state: ContactState) -> Outputs:
        counts = np.bincount(state.status, minlength=3)
        stick, slip, opened = counts[Status.STICK], counts[Status.SLIP], counts[Status.OPEN]
        return Outputs(
            summary=f"{stick} stick, {slip} slip, {opened} open",
            remarks=lambda: remarks(self, x, state),
            parameters=self._parameters,
        )
