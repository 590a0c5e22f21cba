"""Enforcement of contact: the questions that a pair asks the method that enforces its law."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal

import numpy as np
from numpy import ndarray

from ..errors import Remark
from ..forms.base import Response
from ..layout import Field
from ..surfaces.surface import Surface
from .interface import ContactState
from .laws import InterfaceLaw

#: Nodes of facets whose corners have negative areas: where a facet is closed in part, multipliers
#: there double the pressure at the edge of the contact, of a sphere on a block with 4 elements in
#: its half-width.
_NEGATIVE = 8


class Enforcement:
    """Base of the methods that enforce contact.

    Attributes
    ----------
    keeps_penalty : bool
        True if the penalty remains as it was given.
    saddle : bool
        True if multipliers change with the displacements.
    outer_after : "exact" or None
        Equilibrium after which :meth:`after_equilibrium` changes the accepted state.
    """

    keeps_penalty: bool = False
    saddle: bool = False
    outer_after: Literal["exact"] | None = None

    def check(self, slave: Surface, law: InterfaceLaw, quadrature: Any, share: float) -> None:
        """Refuse pairs that the method does not serve."""

    def check_collapse(self, slave: Surface) -> None:
        """Refuse searches for a collapse where the method does not serve them."""

    def fields(self, slave: Surface) -> tuple[Field, ...]:
        """Return the fields whose dofs the method adds to the model."""
        return ()

    def penalties(self, pair: Any, state: ContactState) -> tuple[float, float]:
        """Return the normal and the tangential penalty in a state."""
        normal, tangential = pair.penalty * state.penalty_factor
        return float(normal), float(tangential)

    def start(self, pair: Any, state: ContactState) -> ContactState:
        """Return the initial state of a pair with the method's own variables."""
        return state

    def start_with(
        self,
        pair: Any,
        state: ContactState,
        tractions: ndarray,
    ) -> tuple[ContactState, ndarray]:
        """Return a state with multipliers of tractions (dim, n), and the penalty's part of them."""
        return state, tractions

    def respond(self, pair: Any, x: ndarray, accepted: ContactState) -> Response:
        """Return the response of a pair."""
        raise NotImplementedError

    def after_equilibrium(
        self,
        pair: Any,
        accepted: ContactState,
        found: ContactState,
    ) -> tuple[ContactState, dict[str, Any]]:
        """Return the accepted state to solve the increment with once more, and the pair's changes.

        The state is the same object where nothing is left to do.
        """
        return accepted, {}

    def remarks(
        self,
        pair: Any,
        x: ndarray,
        state: ContactState,
        meshed: ndarray,
    ) -> Iterator[Remark]:
        """Yield remarks on the accuracy; `meshed` are the gaps of the mesh, shape (n,)."""
        yield from ()

    def tractions(self, pair: Any, state: ContactState) -> ndarray:
        """Return the tractions at the points, (dim, n), with the resultants of the nodal forces."""
        return state.traction

    def nodal_forces(self, pair: Any, x: ndarray, state: ContactState) -> list[ndarray]:
        """Return the internal forces of pressure and of friction in a state, shape (N,) each."""
        operator = pair.tractions_at(x, state).forces
        pressure = np.zeros_like(state.traction)
        pressure[0] = state.traction[0]
        friction = state.traction - pressure
        return [operator @ pressure.ravel(), operator @ friction.ravel()]

    def foreseen(
        self,
        pair: Any,
        start: ndarray,
        x: ndarray,
        before: ndarray | None,
        accepted: ContactState,
    ) -> ndarray:
        """Return displacements to start an increment from."""
        return start


def check_corners(slave: Surface) -> None:
    """Refuse facets whose corners have negative areas, for methods with multipliers at nodes."""
    if slave.facets.shape[1] == _NEGATIVE:
        raise ValueError(
            f"multipliers are not for facets of eight nodes, as '{slave.name}' has them: the "
            "corners have negative areas; take ElementHex2 or ElementHex1, or the penalty method"
        )
