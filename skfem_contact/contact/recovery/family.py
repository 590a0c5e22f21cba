"""What the families of easier forms have in common."""
from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING

from numpy import ndarray

from ...errors import Failure
from ..laws import InterfaceLaw
from ..state import ContactState

if TYPE_CHECKING:
    from ..pair import ContactPair


class Recovery:
    """A member of a family: how an easier contact pair differs from the one that is given.

    Attributes
    ----------
    reason
        Why there may be no equilibrium without it, for a message.
    """

    reason: str = ""

    @classmethod
    def begin(cls, pair: ContactPair, accepted: ContactState, failure: Failure | None) -> Recovery | None:
        """The member to begin an increment with, or None where the family does not help.

        Parameters
        ----------
        pair, accepted
            The pair, which may be an easier one already, and its accepted state.
        failure
            How Newton's method failed; None before the first attempt.
        """
        raise NotImplementedError

    def law(self, law: InterfaceLaw) -> InterfaceLaw:
        """The law of the easier pair."""
        return law

    def seen(self, state: ContactState, law: InterfaceLaw) -> ContactState:
        """The accepted state as the easier pair sees it."""
        return state

    def slip(self, at: ndarray) -> ndarray | float:
        """What is added to the slips of points, given by their numbers."""
        return 0.0

    def proceed(self, pair: ContactPair, accepted: ContactState, found: ContactState) -> Recovery | None:
        """The next member, once an equilibrium is found; None for the pair as given, this one where nothing is left.

        Parameters
        ----------
        pair
            The pair.
        accepted, found
            State at the start of the increment, and at the equilibrium that this member has found.
        """
        return self

    def at(self, points: ndarray) -> Recovery:
        """The same for other points of the slave, which are nearest to these old ones."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]  # of a dataclass
        arrays = {name: value[..., points] for name, value in values.items() if isinstance(value, ndarray)}
        return replace(self, **arrays) if arrays else self  # type: ignore[type-var]
