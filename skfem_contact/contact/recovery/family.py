"""How an easier contact pair differs from the one that is given: by members of several families at once."""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from numpy import ndarray

from ...errors import Failure
from ..laws import InterfaceLaw
from ..state import ContactState

if TYPE_CHECKING:
    from ..pair import ContactPair


@dataclass(frozen=True, eq=False)
class Recovery:
    """A member of a family: one way in which an easier pair differs; here in none."""

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

    def proceed(self, pair: ContactPair, accepted: ContactState, found: ContactState) -> Recovery | None:
        """The next member, once an equilibrium is found; None for the pair as given, this one where nothing is left."""
        return self

    def law(self, law: InterfaceLaw) -> InterfaceLaw:
        """The law of the easier pair."""
        return law

    def seen(self, state: ContactState) -> ContactState:
        """The accepted state as the easier pair sees it."""
        return state

    def slip(self, at: ndarray) -> ndarray | float:
        """What is added to the slips of points, given by their numbers, (dim - 1, n)."""
        return 0.0

    @property
    def reason(self) -> str:
        """Why there may be no equilibrium without it, for a message."""
        return ""

    def at(self, points: ndarray) -> Recovery:
        """The same for other points of the slave, which are nearest to these old ones."""
        return replace(self, **{name: value[..., points] for name, value in vars(self).items()
                                if isinstance(value, ndarray)})


@dataclass(frozen=True)
class Easing(Recovery):
    """Members of families of easier pairs, at most one of each; those of a pair as given are none."""

    members: tuple[Recovery, ...] = ()

    def of(self, family: type[Any]) -> Any:
        """The member of a family, or None."""
        return next((member for member in self.members if isinstance(member, family)), None)

    def begun(self, families: Iterable[type[Recovery]], pair: ContactPair, accepted: ContactState,
              failure: Failure | None) -> Easing:
        """With a member of the first family that helps; this one where none does."""
        for family in families:
            if (member := family.begin(pair, accepted, failure)) is not None:
                return self._with(member, self.of(family))
        return self

    def proceed(self, pair: ContactPair, accepted: ContactState, found: ContactState) -> Easing:
        """With the next member of the first family that goes on; this one where all have come to their end."""
        for member in self.members:
            if (after := member.proceed(pair, accepted, found)) is not member:
                return self._with(after, member)
        return self

    def _with(self, member: Recovery | None, before: Recovery | None) -> Easing:
        return Easing(tuple(m for m in (*(m for m in self.members if m is not before), member) if m is not None))

    def law(self, law: InterfaceLaw) -> InterfaceLaw:
        """As one after the other changes it."""
        for member in self.members:
            law = member.law(law)
        return law

    def seen(self, state: ContactState) -> ContactState:
        """As one after the other sees it."""
        for member in self.members:
            state = member.seen(state)
        return state

    def slip(self, at: ndarray) -> ndarray | float:
        """Of all."""
        return sum(member.slip(at) for member in self.members)

    @property
    def reason(self) -> str:
        """Of all."""
        return "; ".join(filter(None, (member.reason for member in self.members)))

    def at(self, points: ndarray) -> Easing:
        """All of them."""
        return Easing(tuple(member.at(points) for member in self.members))
