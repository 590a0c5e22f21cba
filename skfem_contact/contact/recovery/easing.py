"""How an easier contact pair differs from the one that is given: by members of several families at once."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from numpy import ndarray

from ...errors import Failure
from ..laws import InterfaceLaw
from ..state import ContactState
from .debonding import Debonding
from .facet_lock import FacetLock
from .family import Recovery
from .interference import Interference
from .soft_stick import SoftStick
from .stabilisation import Stabilisation

if TYPE_CHECKING:
    from ..pair import ContactPair

#: In the order in which they are tried.
_FAMILIES: tuple[type[Recovery], ...] = (Interference, Stabilisation, FacetLock, SoftStick, Debonding)


@dataclass(frozen=True)
class Easing:
    """Members of families of easier pairs; those of a pair as given are none.

    Parameters
    ----------
    members
        At most one of each family.
    """

    members: tuple[Recovery, ...] = ()

    def of(self, family: type[Any]) -> Any:
        """The member of a family, or None."""
        return next((member for member in self.members if isinstance(member, family)), None)

    def begin(self, pair: ContactPair, accepted: ContactState, failure: Failure | None) -> Easing:
        """With a member of the first family that helps; this one where none does."""
        for family in _FAMILIES:
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
        """The law of the easier pair."""
        for member in self.members:
            law = member.law(law)
        return law

    def seen(self, state: ContactState, law: InterfaceLaw) -> ContactState:
        """An accepted state as the easier pair sees it."""
        for member in self.members:
            state = member.seen(state, law)
        return state

    def slip(self, at: ndarray) -> ndarray | float:
        """What is added to the slips of points, given by their numbers, (dim - 1, n)."""
        return sum(member.slip(at) for member in self.members)

    @property
    def reason(self) -> str:
        """Why there may be no equilibrium without it, for a message."""
        return "; ".join(filter(None, (member.reason for member in self.members)))

    def at(self, points: ndarray) -> Easing:
        """The same for other points of the slave, which are nearest to these old ones."""
        return Easing(tuple(member.at(points) for member in self.members))
