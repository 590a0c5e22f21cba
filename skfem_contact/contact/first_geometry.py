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

from ..forms import Form, Response
from .kinematics import Kinematics, tangents, variations
from .laws import Status
from .state import ContactState, closest

if TYPE_CHECKING:
    from .pair import ContactPair


@dataclass(frozen=True, kw_only=True)
class HeldState(ContactState):
    """State of contact in its first geometry: that of any contact, and the motion since the first moment.

    Attributes
    ----------
    moved
        Tangential motion of the points since the first moment, (n,).
    stick
        Motion from which the elastic slip counts, (n,).
    """

    moved: ndarray
    stick: ndarray


class FirstGeometry(Form):
    """A contact pair whose geometry is held as it is at some displacements.

    Parameters
    ----------
    pair
        The pair.
    x
        Displacements of the first moment, (N,).
    state
        State of the pair there.
    """

    unilateral = True

    def __init__(self, pair: ContactPair, x: ndarray, state: ContactState) -> None:
        self.pair, self.size, self.strengths = pair, pair.size, pair.strengths
        self.joins, self.changing = pair.joins, pair.changing
        slave, nodes = pair._places(x)
        self._points = points = pair.points(state)
        positions = points.positions(slave)
        found = pair._project(points, nodes, positions, state.facet)
        self._at = at = np.flatnonzero(found.found)
        seen = variations(points, pair.slave, pair.master, at, found, positions, state.stick_point, nodes)
        self._kinematics = seen._replace(slip_gradient=seen.tangential)
        penalties = pair.penalties(state)
        closing = state.offset - points.at(state.multiplier[0]) / penalties[0]
        self._gap = (found.gap - closing)[at]
        self._elastic = seen.stretch * seen.elastic_arc + points.at(state.multiplier[1])[at] / penalties[1]
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
        zero = np.zeros(len(state.gap))
        stick = zero.copy()
        stick[self._at] = -self._elastic
        return HeldState(**{field.name: getattr(state, field.name) for field in fields(state)}, moved=zero, stick=stick)

    def released(self, x: ndarray, state: HeldState) -> tuple[ContactPair, ContactState]:
        """The pair that follows the bodies, and the state that it has there: with the same tractions."""
        slave, nodes = self.pair._places(x)
        found = self.pair._project(self._points, nodes, self._points.positions(slave))
        facet, position = closest(self.pair.master, found)
        own = {field.name: getattr(state, field.name) for field in fields(ContactState)}
        elastic = np.where(state.status == Status.OPEN, 0.0, state.moved - state.stick)
        own |= {"position": position, "facet": facet, "stick_point": position - elastic}
        return self.pair, ContactState(**own)

    def reduced(self, factor: float, flow: str, names: Collection[str]) -> FirstGeometry:
        """The same contact with the strength of its law divided by a factor."""
        new = copy(self)
        new.pair = self.pair.reduced(factor, flow, names)
        return new

    def assemble(self, x: ndarray, state: HeldState) -> Response:
        """Contact force, tangent and candidate state at the displacements ``x``, (N,), from an accepted state."""
        pair, all_ = self.pair, self._kinematics
        change = np.where(all_.dofs < 0, 0.0, x.take(all_.dofs.clip(0)) - self._first)
        gap = self._gap + (all_.gap_gradient * change).sum(axis=1)
        moved = (all_.tangential * change).sum(axis=1)
        internal, closed = pair.seen(state).internal, state.status != int(Status.OPEN)
        law, all_at = pair.law, self._at
        on = np.flatnonzero(law.take(self._points.take(all_at)).reaches(gap, internal[:, all_at], closed[all_at]))
        at = all_at[on]
        jump = np.stack((gap[on], moved[on] - state.stick[at]))
        update = law.take(self._points.take(at)).update(jump, internal[:, at], pair.penalties(state))
        kinematics = _of(all_, on)
        weight = pair.share * self._points.weight[at]
        force = ((weight * update.traction[0])[:, None] * kinematics.gap_gradient
                 + (weight * update.traction[1])[:, None] * kinematics.tangential)

        def candidate() -> HeldState:
            motion, stick, gaps, new = state.moved.copy(), state.stick.copy(), state.gap.copy(), internal.copy()
            motion[self._at], gaps[self._at] = moved, gap + state.offset[self._at]
            stick[self._at] = moved
            stick[at] -= update.elastic_slip[0]
            traction, status = np.zeros_like(state.traction), np.full(len(gaps), int(Status.OPEN))
            traction[:, at], status[at], new[:, at] = update.traction, update.status, update.internal
            slip = np.where(status == Status.OPEN, 0.0, state.slip + motion - state.moved)
            return replace(state, gap=gaps, slip=slip, traction=traction, status=status, internal=new, moved=motion,
                           stick=stick)

        return Response(pair._gathering.force(kinematics.dofs, force), candidate,
                        lambda: pair._gathering.matrix(kinematics.dofs,
                                                      tangents(kinematics, update, False) * weight[:, None, None]))


def _of(kinematics: Kinematics, on: ndarray) -> Kinematics:
    """The variations of some points; what the geometric tangent needs is left behind."""
    names = (name for name in Kinematics._fields if name != "second")
    return kinematics._replace(**{name: getattr(kinematics, name)[on] for name in names})
