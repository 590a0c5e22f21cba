"""Points that go to and fro between the states of Newton's iterations: what calms them in the increment."""
from __future__ import annotations

from collections.abc import Sequence

from ..materials.coulomb import InterfaceLaw
from .bonds import broken
from .freezing import frozen
from .softening import softened
from .state import ContactState


def calmed(state: ContactState, candidates: Sequence[ContactState], slave: str, law: InterfaceLaw) -> ContactState:
    """The state with the first remedy that is left to try, or the same one where no point goes to and fro.

    Points are frozen to their facet (:func:`frozen`), stick softly (:func:`softened`) or lose their bond
    (:func:`broken`).

    Parameters
    ----------
    state
        Accepted state.
    candidates
        States between which Newton's method goes to and fro.
    slave
        Name of the slave, for the log.
    law
        The interface law.
    """
    new = frozen(state, candidates, slave)
    new = softened(state, candidates, slave) if new is state else new
    return broken(state, candidates, slave, law) if new is state else new
