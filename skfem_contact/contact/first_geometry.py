"""Contact with its geometry held: gap and slip are linear in the displacements from a first moment on.

Solids of small strains have one geometry, contact of finite sliding follows the displaced bodies.  A search for a
collapse goes to any displacement: there the two are different theories, and what contact gains by following would make
the factor depend on how far the bodies have moved, that is on their stiffness.  In limit analysis all is taken in one
geometry.  So contact keeps its closest points, normals and tributary lengths, and its gap and slip

    g = g_0 + G . (u - u_0),    s = s_0 + T . (u - u_0)

grow with the variations G and T of the first moment (see :mod:`~skfem_contact.contact.kinematics`).
"""
from __future__ import annotations

from collections.abc import Collection
from copy import copy
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..forms.base import Form, Response
from ..surfaces.material_points import behind
from .laws import Status
from .state import ContactState

if TYPE_CHECKING:
    from .pair import ContactPair


@dataclass(frozen=True, kw_only=True)
class HeldState(ContactState):
    """State of contact in its first geometry: that of any contact, and the motion since the first moment.

    Attributes
    ----------
    moved
        Tangential motion of the points since the first moment, (dim - 1, n).
    origin
        Motion from which the elastic slip counts, (dim - 1, n).
    """

    moved: ndarray
    origin: ndarray


class FirstGeometry(Form):
    """A contact pair whose geometry is held as it is at the displacements x, (N,), of a first moment, in its state."""

    unilateral = True

    def __init__(self, pair: ContactPair, x: ndarray, state: ContactState) -> None:
        self.pair, self.size, self.strengths = pair, pair.size, pair.strengths
        self.joins, self.changing = pair.joins, pair.changing
        self._points = points = pair.points(state)
        found = pair.interface.closest(x, state.cuts, state.facet)
        self._at = at = np.flatnonzero(found.found)
        near, seen = points.take(at), pair.interface.variations(x, state, found, at)
        self._dofs, self._work = seen.dofs, seen.work
        penalties = pair.penalties(state)
        closing = state.offset - points.at(state.multiplier[0]) / penalties[0]
        self._gap, self._closing = (found.gap - closing)[at], closing[at]
        self._elastic = seen.slip.T + near.at(state.multiplier[1:].T).T / penalties[1]
        self._first = x.take(seen.dofs.clip(0))

    def __repr__(self) -> str:
        return f"<{self.pair!r} in its first geometry>"

    @property
    def symmetric(self) -> bool:  # type: ignore[override]
        """Whether the tangent is symmetric: that of the law is, for the geometry adds nothing."""
        return self.pair.symmetric

    def initial_state(self, x: ndarray | None = None) -> HeldState:
        """That of the pair, with the elastic slip of the first moment."""
        return self.held(self.pair.initial_state(x))

    def held(self, state: ContactState) -> HeldState:
        """A state of the first moment."""
        zero = np.zeros(state.slip.shape)
        origin = zero.copy()
        origin[:, self._at] = -self._elastic
        return HeldState(**vars(state), moved=zero, origin=origin)

    def released(self, x: ndarray, state: HeldState) -> tuple[ContactPair, ContactState]:
        """The pair that follows the bodies, and the state that it has there: with the same tractions."""
        pair, own = self.pair, {field.name: getattr(state, field.name) for field in fields(ContactState)}
        found = pair.interface.closest(x, state.cuts)
        on = np.flatnonzero((state.status != Status.OPEN) & found.found)
        seen, closest, offset = pair.interface.variations(x, state, found, on), found.closest, state.offset.copy()
        facet, xi = closest.facet.copy(), closest.xi.copy()
        offset[on] += found.gap[on] - state.gap[on]
        multiplied = self._points.at(state.multiplier[1:].T).T / pair.penalties(state)[1]
        facet[on], xi[on] = behind(pair.master, pair.interface.places(x)[1], seen.tangents, seen.closest,
                                   (state.moved - state.origin - multiplied)[:, on].T)
        own |= {"facet": closest.facet, "position": closest.xi.T, "stick_facet": facet, "stick_point": xi.T,
                "gap": found.gap, "offset": offset}
        return pair, ContactState(**own)

    def reduced(self, factor: float, flow: str, names: Collection[str]) -> FirstGeometry:
        """The same contact with the strength of its law divided by a factor."""
        new = copy(self)
        new.pair = self.pair.reduced(factor, flow, names)
        return new

    def assemble(self, x: ndarray, state: HeldState) -> Response:
        """Contact force, tangent and candidate state at the displacements ``x``, (N,), from an accepted state."""
        pair, near = self.pair, self._points.take(self._at)
        change = np.where(self._dofs < 0, 0.0, x.take(self._dofs.clip(0)) - self._first)
        gap, *moved = np.einsum("nim,nm->in", self._work, change)
        gap, moved = self._gap + gap, np.array(moved)
        internal, closed = pair.seen(state).internal, state.status != int(Status.OPEN)
        on = np.flatnonzero(pair.law.take(near).reaches(gap, internal[:, self._at], closed[self._at]))
        at, dofs, work = self._at[on], self._dofs[on], self._work[on]
        jump = np.stack((gap[on], *(moved[:, on] - state.origin[:, at])))
        update = pair.law.take(near.take(on)).update(jump, internal[:, at], pair.penalties(state))
        weight = pair.share * self._points.weight[at]

        def candidate() -> HeldState:
            motion, origin, gaps, new = state.moved.copy(), state.origin.copy(), state.gap.copy(), internal.copy()
            motion[:, self._at], gaps[self._at] = moved, gap + self._closing
            origin[:, self._at] = moved
            origin[:, at] -= update.elastic_slip
            traction, status = np.zeros_like(state.traction), np.full(len(gaps), int(Status.OPEN))
            traction[:, at], status[at], new[:, at] = update.traction, update.status, update.internal
            slip = np.where(status == Status.OPEN, 0.0, state.slip + motion - state.moved)
            return replace(state, gap=gaps, slip=slip, traction=traction, status=status, internal=new, moved=motion,
                           origin=origin)

        def stiffness() -> csr_matrix:
            K = work.transpose(0, 2, 1) @ (update.tangent.transpose(2, 0, 1) @ work)
            return pair._gathering.matrix(dofs, K * weight[:, None, None])

        force = weight[:, None] * np.einsum("in,nim->nm", update.traction, work)
        return Response(pair._gathering.force(dofs, force), candidate, stiffness)
