"""What a contact pair answers to an analysis besides forces and states."""
from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy import ndarray

from ..errors import Remark
from ..forms.base import Form
from ..forms.states import arrays_of
from ..surfaces.surface import Surface
from .diagnosis import remarks
from .first_geometry import FirstGeometry, HeldState
from .laws import InterfaceLaw, Status
from .penalty import with_chosen_penalty
from .prestress import TractionOperator, rebased
from .state import ContactState

if TYPE_CHECKING:
    from .pair import ContactPair

#: Tractions that differ by this share come from another penalty.
_SAME = 1e-6


class Answers(Form):
    """A form between two surfaces: what it couples, how it goes on from stage to stage, what a user should know."""

    slave: Surface
    master: Surface
    facets: Surface
    law: InterfaceLaw
    quadrature: Any
    penalty: tuple[float, float] | None
    stiffness: float | None

    unilateral = True

    @property
    def _pair(self) -> ContactPair:
        return cast("ContactPair", self)

    # -- what it is -----------------------------------------------------------------------------------------

    @cached_property
    def joins(self) -> ndarray:  # type: ignore[override]
        """The unknowns of the two surfaces; -1 among them for a rigid obstacle."""
        return np.unique(np.concatenate((self.slave.dofs.ravel(), self.facets.dofs.ravel())))

    @cached_property
    def changing(self) -> ndarray:  # type: ignore[override]
        """The unknowns that the pair acts on."""
        return self.joins[self.joins >= 0]

    @property
    def nodes(self) -> tuple[ndarray, ndarray]:  # type: ignore[override]
        """Layout of the slave's nodes, and their places."""
        return self.slave.dofs[:, 0], self.slave.nodes.T

    @property
    def symmetric(self) -> bool:  # type: ignore[override]
        """Whether the tangent is symmetric: the law says so.

        Points that stick have no symmetric tangent once they carry shear or have slipped elastically.
        """
        return self.law.symmetric

    @property
    def strengths(self) -> tuple[str, ...]:  # type: ignore[override]
        """``""``, the pair as a whole, where its law can be reduced."""
        return ("",) if hasattr(self.law, "reduced") else ()

    def reduced(self, factor: float, flow: str, names: Collection[str]) -> ContactPair:
        """The same pair with the strength of its law divided by a factor."""
        return self._pair.with_law(self.law.reduced(factor)) if names else self._pair  # type: ignore[attr-defined]

    def fixed_geometry(self, x: ndarray, state: ContactState) -> tuple[FirstGeometry, HeldState]:
        """The pair with its geometry held as it is at some displacements, and its state."""
        held = FirstGeometry(self._pair, x, state)
        return held, held.held(state)

    # -- from stage to stage --------------------------------------------------------------------------------

    def completed(self, forms: Mapping[str, Form]) -> ContactPair:
        """The pair with the stiffness of its surfaces, and a penalty that suits it where none is given."""
        return self._pair if self.stiffness is not None else with_chosen_penalty(self._pair, forms)

    def continues(self, old: Form) -> ContactPair:
        """The pair in the place of another one between the same surfaces, with its penalty unless it has its own."""
        if not isinstance(old, Answers) or (old.slave.name, old.facets.name, old.quadrature) \
                != (self.slave.name, self.facets.name, self.quadrature):
            raise ValueError("its surfaces are others")
        if self.penalty is not None or old.penalty is None:
            return self._pair
        return self._pair.with_penalty(*old.penalty, stiffness=old.stiffness)

    def replaces(self, old: Form) -> bool:
        """Whether an old form was a pair between the same surfaces."""
        return isinstance(old, Answers) and \
            {old.slave.name, old.facets.name} == {self.slave.name, self.facets.name}

    def fits(self, state: ContactState) -> bool:
        """Whether a state has the points of this pair; internal variables may be those of another law."""
        if self.quadrature == "segments":
            return self._pair.interface.fits(state.cuts)
        initial = arrays_of(self.initial_state())
        return all(np.shape(values) == np.shape(initial[name]) for name, values in arrays_of(state).items()
                   if name != "internal")

    def check_start(self, x: ndarray, state: ContactState) -> None:
        """Refuse a state that another penalty has led to."""
        new, pressure = self.assemble(x, state).state, state.traction[0]
        both = (new.status != Status.OPEN) & (state.status != Status.OPEN)
        if np.abs(new.traction[0] - pressure)[both].max(initial=0.0) > _SAME * np.abs(pressure).max(initial=0.0):
            raise ValueError("its penalty is another one than in the start: give `penalty=`, or use "
                             "choose_penalties(forms) of the same forms in both analyses")

    def tractions_at(self, x: ndarray, state: ContactState) -> TractionOperator:
        """How tractions at the points that are not open make nodal forces."""
        return TractionOperator(self._pair, x, state)

    def rebased(self, x: ndarray, state: ContactState) -> ContactState:
        """The state of bodies that are back in their places, with all it carries."""
        return rebased(self._pair, state)

    # -- what it says ---------------------------------------------------------------------------------------

    def summary(self, state: ContactState) -> str:
        """Counts of open, sticking and slipping points, for the table of a result."""
        counts = np.bincount(state.status, minlength=3)
        return f"{counts[Status.STICK]} stick, {counts[Status.SLIP]} slip, {counts[Status.OPEN]} open"

    def penetration(self, state: ContactState) -> float:
        """Largest penetration as a share of the slave segment there."""
        closed, size = state.status != Status.OPEN, self._pair.points(state).size
        return float(np.max((state.offset - state.gap)[closed] / size[closed], initial=0.0))

    def remarks(self, x: ndarray, state: ContactState) -> list[Remark]:
        """What a user should know of an accepted state: contact that is not there, or not where it should be."""
        return list(remarks(self._pair, x, state))
