"""Optional parts of a form: stages, steps in time, reduction of strength, regularisation."""
from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np
from numpy import ndarray

from ..errors import Failure, Remark
from .states import arrays_of

Self = TypeVar("Self")


class Staged:
    """Stages: what a form does where bodies become active, inactive or other ones.

    Attributes
    ----------
    carries
        Dofs of fields for which the form has equations; None: all of its fields.
    joins
        Dofs that the form couples to each other, -1 among them for a rigid obstacle; None: it may hold any dof.
    acts_on
        Dofs that the form acts on, all of which must be active; None: any of them.
    elastic_stiffness
        Stiffness (N, N) by which penalties are chosen and new bodies are placed.
    nodes
        Dofs, (n,), and the coordinates that the form takes these to have, (dim, n).
    """

    carries: ndarray | None = None
    joins: ndarray | None = None
    acts_on: ndarray | None = None
    elastic_stiffness: Any = None
    nodes: tuple[ndarray, ndarray] | None = None

    def completed(self: Self, forms: Mapping[str, Any]) -> Self:
        """Return the form with what it takes from the others, such as a penalty from their stiffness."""
        return self

    def own_weight(self, acceleration: ndarray) -> ndarray | None:
        """Return the load vector of the weight under an acceleration over that of gravity, (dim,), or None."""
        return None

    def pressure_at_nodes(self, x: ndarray) -> ndarray | None:
        """Return the pore pressure that the form adds to the ground, at the nodes of the displacements, (N/dim,)."""

    def continues(self: Self, old: Any) -> Self:
        """Return the form as it replaces an old one, from whose state it goes on.

        Raises
        ------
        ValueError
            The form cannot go on from the state of the old one.
        """
        if type(self) is not type(old):
            raise ValueError(f"{type(old).__name__} cannot become {type(self).__name__}")
        return self

    def inherits(self, old: Any, state: Any) -> Any:
        """Return the state of an old form as this one goes on from it."""
        return state

    def fits(self, state: Any) -> bool:
        """Return True if a state has the shapes of the initial state."""
        given, initial = arrays_of(state), arrays_of(self.initial_state())  # type: ignore[attr-defined]
        return {k: np.shape(a) for k, a in given.items()} == {k: np.shape(a) for k, a in initial.items()}

    def check_start(self, x: ndarray, state: Any) -> None:
        """Raise a ``ValueError`` if the form cannot go on from a state of other settings."""

    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterable[Remark]:
        """Return remarks on supports, inactive dofs, and the time since the last change to the end of a stage."""
        return ()

    def replaces(self, old: Any) -> bool:
        """Return True if the form takes over the forces of an old one, in whose place it becomes active."""
        return False

    def tractions_at(self, x: ndarray, state: Any) -> Any | None:
        """Return how tractions make nodal forces, where the form can begin with given ones, or None."""

    def rebased(self, x: ndarray, state: Any) -> Any:
        """Return the state once displacements are counted from x on."""
        return state


class InTime:
    """Steps in time.

    Attributes
    ----------
    second_order
        True if a step can be taken in two parts, see :meth:`extrapolated`.
    """

    second_order: bool = False

    def over(self: Self, duration: float) -> Self:
        """Return the form of a step in time; itself where time does not matter."""
        return self

    def extrapolated(self, before: Any, found: Any, ratio: float) -> Any:
        """Return the state `ratio` times as far from an earlier state as the one that was found."""

    def time_error(self, middle: Any, after: Any) -> tuple[float, float]:
        """Return the error of a step over the tolerance, and the quantity that it is compared with."""
        return 0.0, 0.0


class Reducible:
    """Search for a collapse: strength that can be reduced, and geometry that is held.

    Attributes
    ----------
    materials
        Materials by the name of their region.
    strengths
        Names of the parts whose strength can be reduced, ``""`` for the form as a whole.
    """

    materials: Mapping[str, Any] = MappingProxyType({})
    strengths: tuple[str, ...] = ()

    def reduced(self: Self, factor: float, flow: str, names: Collection[str]) -> Self:
        """Return the form with some of its :attr:`strengths` divided by a factor, and with a flow rule."""
        return self

    def fixed_geometry(self, x: ndarray, state: Any) -> tuple[Any, Any]:
        """Return the form whose geometry is held as it is at the displacements x, and its state."""
        return self, state

    def released(self, x: ndarray, state: Any) -> tuple[Any, Any]:
        """Return the form whose geometry is not held, and its state: the inverse of :meth:`fixed_geometry`."""
        return self, state

    def yielding(self, before: Any, after: Any) -> tuple[int, int]:
        """Return the number of points of solids that have flowed from one state to another, and of all points."""
        return 0, 0

    def shear_strain(self, x: ndarray) -> ndarray | None:
        """Return the largest shear strain of displacements at the points of a solid, (n_elements, n_points)."""


class Regularised:
    """Regularisation: easier forms by which Newton's method comes to the form as it is given.

    Attributes
    ----------
    unilateral
        True if the form opens, closes and slips: on the way to equilibrium the residual may rise now and then.
    changing
        Dofs at which the tangent may change while Newton's method iterates; None: anywhere.
    """

    unilateral: bool = False
    changing: ndarray | None = None

    def begin(self: Self, accepted: Any, failure: Failure | None = None) -> Self:
        """Return a regularised form to begin an increment with, whose family ends at this form.

        Parameters
        ----------
        accepted, failure
            The accepted state; how Newton's method failed, None before the first attempt.
        """
        return self

    def outer(self, x: ndarray, accepted: Any, found: Any) -> tuple[Any, Any] | None:
        """Return the form and accepted state with which the increment is to be solved once more, or None.

        Parameters
        ----------
        x, found
            Displacements and state of the equilibrium that was found.
        accepted
            The accepted state, at the start of the increment.
        """

    @property
    def reason(self) -> str:
        """Reason why there may be no equilibrium but of this regularised form, for a message."""
        return ""
