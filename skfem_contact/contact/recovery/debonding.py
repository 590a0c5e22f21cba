"""Bonds that break: points that open and close in turn go on without adhesion."""
from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy import ndarray

from ..laws import InterfaceLaw, Status, Traction
from ..state import ContactState

logger = logging.getLogger("skfem_contact")


def broken(state: ContactState, candidates: Sequence[ContactState], slave: str, law: InterfaceLaw) -> ContactState:
    """The state with broken bonds at points that open and close, or the same one where there is none to break.

    Adhesion and tension jump to zero as a point opens.  Then there may be no equilibrium: with its bond the point is
    drawn open, and without it pressed on.  Without the bond, for good, tractions do not jump.

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
    closed = np.array([candidate.status != Status.OPEN for candidate in candidates])
    breaks = closed.any(axis=0) & ~closed.all(axis=0) & ~state.broken
    if unbonded(law) == law or not breaks.any():
        return state
    logger.info("points %s of '%s' open and close in turn: their bond breaks", np.flatnonzero(breaks), slave)
    return replace(state, broken=state.broken | breaks)


def tractions(law: InterfaceLaw, bond_is_broken: ndarray, gap: ndarray, slip: ndarray,
              penalties: tuple[float, float]) -> Traction:
    """Tractions of the law where the bond is whole, and of the law without a bond where it is broken."""
    whole = law.update(gap, slip, *penalties)
    if not bond_is_broken.any():
        return whole
    without = unbonded(law).update(gap, slip, *penalties)
    return Traction(*(np.where(bond_is_broken, *both) for both in zip(without, whole, strict=True)))


def unbonded(law: InterfaceLaw) -> InterfaceLaw:
    """The law without a bond; one that knows of none is its own."""
    without: InterfaceLaw = getattr(law, "unbonded", law)
    return without
