"""The contact pair: two surfaces, a law and a quadrature rule that answer like any other form; and two of them."""
from __future__ import annotations

from copy import copy
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis

from ..errors import Failure, IncrementTooLarge, check_basis, check_size, is_number
from ..forms.base import Response
from ..sparse import Gathering
from ..surfaces.smoothing import smoothed
from ..surfaces.surface import Surface
from .answers import Answers
from .augmented import AugmentedLagrangian, Progress
from .diagnosis import ROUND_OFF
from .interface import RECUTS, Interface
from .kinematics import Kinematics, dragged, tangents, variations
from .laws import InterfaceLaw, Status, Update
from .quadrature import SlavePoints
from .recovery import FAMILIES
from .recovery.chatter import FacetLock
from .recovery.family import Easing
from .settings import Fit, check_law, check_settings, check_surfaces, touching
from .state import ContactState

#: Largest tractions in the damped tangent's geometric part, over those at which the surfaces give way by a segment.
_LARGEST_TRACTION = 0.1


class ContactPair(Answers):
    """Frictional contact with finite sliding between two boundaries, or a boundary and a rigid obstacle.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh that holds the bodies.
    slave, master
        Names of the boundaries; in the plane each must be a single chain.
        The paper's advice: the softer body is the slave.
        The master may be a rigid obstacle, e.g. :func:`rigid_line`.
    law
        Interface law: :class:`Coulomb`, :class:`Tied`, or your own :class:`~skfem_contact.InterfaceLaw`.
    quadrature
        ``"segments"``, Gauss points between cuts by both meshes, which passes the patch test; the number of Gauss
        points on each slave segment (surface-to-surface), or on each of the equal pieces that are no longer than the
        distance of the master's nodes; or ``"nodal"``, the paper's node-to-segment with tributary lengths: across
        meshes that do not match its stresses err by 6 to 29 % in a patch test, and where they match see `smoothing`.
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
        ``"ramped"``: overlaps are resolved in steps; a number: an interference of adjusted bodies, too.
    share
        Share of the contact work, 1/2 for each of two pairs with the roles swapped (:func:`two_pass`).
    tangent
        ``"exact"``, or ``"primary"``: the paper's eqs 20 to 22 without the rotation and curvature parts.  Where the
        iterations make no progress these parts are limited: bodies that overlap on the way to the solution exert
        tractions that would turn the facets.
    axisymmetric
        Forces per radian about the axis x = 0, for solids with ``strain=axisymmetric``.

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
    >>> pair = sc.ContactPair(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=.3), "nodal", penalty=1e4)
    >>> x = basis.zeros()
    >>> x[basis.nodal_dofs[1, mesh.t[:, mesh.subdomains["upper"]]]] = -1e-3     # press the upper block down
    >>> out = pair.assemble(x, pair.initial_state())
    >>> out.state.traction[0].round(9).tolist()
    [-10.0, -10.0, -10.0]
    """

    def __init__(self, basis: CellBasis, slave: str, master: str | Surface, law: InterfaceLaw,
                 quadrature: Literal["nodal", "segments"] | int = "segments",
                 penalty: float | tuple[float, float] | None = None,
                 smoothing: float | None = None, enforcement: AugmentedLagrangian | None = None,
                 initial: Fit = "as meshed", share: float = 1.0, tangent: Literal["exact", "primary"] = "exact",
                 axisymmetric: bool = False) -> None:
        check_basis(basis)
        self.slave = replace(Surface.from_boundary(basis, slave), axisymmetric=axisymmetric)
        self.facets = master if isinstance(master, Surface) else Surface.from_boundary(basis, master)
        self.master = (self.facets if smoothing is None else smoothed(self.facets, smoothing)).facing(self.slave)
        check_surfaces(self.slave, self.master)
        check_settings(self.slave, quadrature, enforcement, initial, share, tangent)
        check_law(law, len(self.slave.nodes))
        self.law, self.quadrature, self.tangent, self.axisymmetric = law, quadrature, tangent, axisymmetric
        self.interface, self._gathering = Interface(self.slave, self.master, quadrature), Gathering(basis.N)
        self.enforcement, self.initial, self.share = enforcement, initial, share
        self.size: int = int(basis.N)
        self.penalty, self.stiffness = None, None
        self.easing, self._progress, self._recuts = Easing(), Progress(), 0
        if penalty is not None:
            both = penalty if isinstance(penalty, tuple) and len(penalty) == 2 else (penalty, penalty)
            self.penalty = self.with_penalty(*both).penalty

    def __repr__(self) -> str:
        return (f"<ContactPair {self.slave.name} on {self.master.name}, {len(self.slave.facets)} facets, "
                f"quadrature {self.quadrature}, {self.law!r}>")

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
            if not is_number(value, 0.0, np.inf):
                raise ValueError(f"penalties must be positive numbers, not {value!r}")
        new = copy(self)
        new.penalty, new.stiffness = (float(normal), float(tangential)), stiffness
        return new

    def with_law(self, law: InterfaceLaw) -> ContactPair:
        """The same pair with another interface law."""
        check_law(law, len(self.slave.nodes))
        new = copy(self)
        new.law = law
        return new

    def points(self, state: ContactState) -> SlavePoints:
        """The slave's points at which a state holds."""
        return self.interface.points(state.cuts)

    def initial_state(self, x: ndarray | None = None) -> ContactState:
        """Nothing has moved: each point sticks to its initial closest point (eq. 7, ``xi_0 = xi_c``).

        Parameters
        ----------
        x
            Displacements, (N,), that the bodies have when the pair becomes active. Gaps are still those of the mesh,
            or as adjusted: bodies are built to fit into displaced surfaces, and touch them without traction.
        """
        cuts = self.interface.cuts(x)
        points, found = self.interface.points(cuts), self.interface.closest(x, cuts)
        meshed = found if x is None else self.interface.closest(None, cuts)
        offset = touching(found.gap, meshed.gap, points.size, self.initial, self.law.bonds)
        n, nodal, dim, closest = len(found.gap), len(self.slave.nodes), self.slave.dim, found.closest
        status = np.where(found.gap <= offset, int(Status.STICK), int(Status.OPEN))
        factor = np.ones(2)
        if self.enforcement is not None and self.penalty is not None and self.stiffness is not None:
            factor = self.enforcement.start(self.penalty, self.stiffness)
        return ContactState(facet=closest.facet, position=closest.xi.T, stick_facet=closest.facet,
                            stick_point=closest.xi.T, gap=found.gap, slip=np.zeros((dim - 1, n)),
                            traction=np.zeros((dim, n)), status=status,
                            internal=np.zeros((self.law.n_internal, n)), multiplier=np.zeros((dim, nodal)),
                            penalty_factor=factor, offset=offset, cuts=cuts)

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
        check_size(x, self.size)
        slave, nodes = self.interface.places(x)
        points, exact = self.points(state), ROUND_OFF * float(np.abs(nodes).max())
        accepted, state, law, lock = state, self.seen(state), self.easing.law(self.law), self.easing.of(FacetLock)
        depth = np.full(len(points.weight), np.inf) if law.reaches_far else self.interface.depth(points)
        penalties = self.penalties(state)
        closing = state.offset - points.at(state.multiplier[0]) / penalties[0]
        found, everywhere = self.interface.near(slave, nodes, state, closing + exact, depth, lock and lock.points)
        gap = found.gap - closing
        gap = np.where(np.abs(gap) <= exact, 0.0, gap)
        closed = state.status != Status.OPEN
        at = np.flatnonzero(found.found & law.take(points).reaches(gap, state.internal, closed))
        closing_points = points.take(at)
        kinematics = variations(closing_points, self.slave, self.master, found.take(at), slave, nodes,
                                state.stick.take(at))
        multiplied = closing_points.at(state.multiplier[1:].T).T / penalties[1]
        slip = kinematics.slip.T + multiplied + self.easing.slip(at)
        update = law.take(closing_points).update(np.stack((gap[at], *slip)), state.internal[:, at], penalties)

        weight = self.share * closing_points.weight
        force = weight[:, None] * np.einsum("in,nim->nm", update.traction, kinematics.work)
        elastic = np.where(update.status == Status.OPEN, 0.0, update.elastic_slip - multiplied)

        def candidate() -> ContactState:
            stick, closest = dragged(kinematics, self.master, nodes, state.stick.take(at), elastic), everywhere()
            slip = accepted.slip + self.interface.slid(accepted, closest.closest)
            return state.after(closest, at, update, stick, slip)

        return Response(self._gathering.force(kinematics.dofs, force), candidate,
                        lambda: self._stiffness(kinematics, update, weight, self.tangent == "exact"),
                        lambda: self._stiffness(kinematics, self._limited(update), weight, self.tangent == "exact"),
                        round_off=max(penalties) * exact * float(np.linalg.norm(weight)),
                        active=at.tobytes() + update.status.tobytes())

    def seen(self, state: ContactState) -> ContactState:
        """An accepted state as the pair sees it; internal variables that it lacks are zero, as before any update."""
        missing = self.law.n_internal - len(state.internal)
        if missing:
            rows = np.pad(state.internal, ((0, max(missing, 0)), (0, 0)))
            state = replace(state, internal=rows[:self.law.n_internal])
        return self.easing.seen(state)

    def penalties(self, state: ContactState) -> tuple[float, float]:
        """Normal and tangential penalty in a state."""
        if self.penalty is None:
            raise ValueError(f"contact of '{self.slave.name}' on '{self.master.name}' has no penalty yet: give "
                             "`penalty=`, or call choose_penalties(forms), which `run` does for you")
        normal, tangential = self.penalty * state.penalty_factor
        return float(normal), float(tangential)

    def _stiffness(self, kinematics: Kinematics, update: Update, weight: ndarray, exact: bool) -> csr_matrix:
        K = tangents(kinematics, update.traction, update.tangent, exact) * weight[:, None, None]
        return self._gathering.matrix(kinematics.dofs, K)

    def _limited(self, update: Update) -> Update:
        """The tractions as far as the bodies could bear them, for without any a round body could turn freely."""
        if self.stiffness is None:
            return update
        largest = _LARGEST_TRACTION * self.stiffness * self.slave.spacing
        return update._replace(traction=np.clip(update.traction, -largest, largest))

    # -- increments that take more than one equilibrium ---------------------------------------------------------

    def outer(self, x: ndarray, accepted: ContactState, found: ContactState
              ) -> tuple[ContactPair, ContactState] | None:
        """Pair and accepted state with which the increment must be solved once more; None where nothing is left to do.

        An easier pair makes room for the next one of its family, the augmented method improves its multipliers, and
        the cuts of ``quadrature="segments"`` follow the bodies.

        Raises
        ------
        IncrementTooLarge
            Points have passed through the master.
        """
        points = self.points(accepted)
        if passed := self.interface.passed_through(x, accepted, found):
            raise IncrementTooLarge(f"{passed} of {len(points.weight)} points of '{self.slave.name}' have passed "
                                    f"through '{self.master.name}', or the penalty, "
                                    f"{self.penalties(accepted)[0]:.3g}, is soft")
        new, state = copy(self), accepted
        new.easing = self.easing.proceed(self, accepted, found)
        if new.easing is not self.easing:
            return new, accepted
        if self.enforcement is not None:
            stiffness = self.penalty[0] if self.stiffness is None else self.stiffness  # type: ignore[index]
            state, new._progress = self.enforcement.augment(accepted, found, points, self.penalties(accepted),
                                                            stiffness, self._progress)
            if (harder := state.penalty_factor[1] / accepted.penalty_factor[1]) != 1.0:  # with the same tractions
                state = self.interface.with_elastic_slip(state, self.interface.elastic_slip(state) / harder)
        cut = self.interface.follow(state, x) if self._recuts < RECUTS else None
        if cut is not None:
            nearest = self.interface.nearest(points, self.points(cut))
            state, new._recuts, new.easing = cut, self._recuts + 1, self.easing.at(nearest)
        return None if state is accepted else (new, state)

    def begin(self, accepted: ContactState, failure: Failure | None = None) -> ContactPair:
        """An easier pair to begin an increment with, whose family ends at this one; itself where none is known."""
        new = copy(self)
        new.easing = self.easing.begun(FAMILIES, self, accepted, failure)
        return self if new.easing is self.easing else new

    @property
    def reason(self) -> str:
        """Why there may be no equilibrium but of an easier pair, for a message."""
        return self.easing.reason


def two_pass(basis: CellBasis, a: str, b: str, law: InterfaceLaw, **options: object) -> dict[str, ContactPair]:
    """Two pairs with the roles swapped, each with half of the contact work: node-to-segment without bias.

    Parameters
    ----------
    basis, law
        As for :class:`ContactPair`.
    a, b
        Names of the boundaries.
    options
        Further arguments of :class:`ContactPair`; ``quadrature="nodal"`` unless it is given.

    Returns
    -------
    dict
        The two forms, named ``"a on b"``.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> block = MeshQuad().refined(1).with_defaults()
    >>> mesh = sc.join_bodies({"lower": block, "upper": block.translated((0., 1.))})
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> list(sc.two_pass(basis, "upper:bottom", "lower:top", sc.Coulomb(mu=.3)))
    ['upper:bottom on lower:top', 'lower:top on upper:bottom']
    """
    options = {"quadrature": "nodal", **options}
    return {f"{slave} on {master}": ContactPair(basis, slave, master, law, share=0.5, **options)  # type: ignore[arg-type]
            for slave, master in ((a, b), (b, a))}
