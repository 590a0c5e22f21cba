"""Points that go to and fro between the states of Newton's iterations: what calms them in the increment."""
from __future__ import annotations

from collections.abc import Sequence

from ..laws import InterfaceLaw
from ..state import ContactState
from ..surface import Surface
from .debonding import debonded
from .facet_lock import frozen
from .soft_stick import softened


def calmed(state: ContactState, candidates: Sequence[ContactState], slave: str, master: Surface, law: InterfaceLaw,
           hardness: float) -> ContactState:
    """The state with the first remedy that is left to try, or the same one where no point goes to and fro.

    Points are frozen to their facet (:func:`frozen`), stick softly (:func:`softened`) or lose their bond
    (:func:`debonded`).

    Parameters
    ----------
    state
        Accepted state.
    candidates
        States between which Newton's method goes to and fro.
    slave, master
        Name of the slave, for the log; the master.
    law
        The interface law.
    hardness
        Tangential penalty over the stiffness of the surfaces.
    """
    new = frozen(state, candidates, slave)
    new = softened(state, candidates, slave, master, hardness) if new is state else new
    return debonded(state, candidates, slave, law) if new is state else new
