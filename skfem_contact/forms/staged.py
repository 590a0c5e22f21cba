"""Optional parts of a form: stages, steps in time, reduction of strength, regularisation."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from copy import copy
from dataclasses import fields, is_dataclass, replace
from types import MappingProxyType
from typing import Any, Literal, TypeVar

import numpy as np
from numpy import ndarray

from ..errors import Failure, Remark

Self = TypeVar("Self")


def arrays_of(state: Any) -> dict[str, Any]:
    """Return the parts of a state: fields of a dataclass, items of a tuple, an array or number, or
    nothing.
    """
    if is_dataclass(state):
        return {field.name: getattr(state, field.name) for field in fields(state)}
    if isinstance(state, tuple):
        return {str(k): values for k, values in enumerate(state)}
    return {} if state is None else {"values": state}


def with_arrays(like: Any, arrays: Mapping[str, ndarray]) -> Any:
    """Return a state like another one of these arrays; the inverse of :func:`arrays_of`."""
    if is_dataclass(like):
        return type(like)(**arrays)  # type: ignore[misc]
    if isinstance(like, tuple):
        return type(like)(*arrays.values()) if hasattr(like, "_fields") else tuple(arrays.values())
    return arrays.get("values")


class Staged:
    """Stages: activation, deactivation and replacement of bodies.

    Attributes
    ----------
    carries
        Dofs of fields for which the form has equations; None: all of its fields.
    joins
        Dofs that the form couples to each other, -1 among them for a rigid obstacle; None: it may
        hold any dof.
    acts_on
        Dofs that the form acts on, all of which must be active; None: any of them.
    elastic_stiffness
        Stiffness (N, N) by which penalties are chosen and new bodies are placed.
    nodes
        Dofs, (n,), and the coordinates that the form takes these to have, (dim, n).
    parameters
        Stiffnesses, strengths and other parameters by their names, for reports.
    suction
        Largest suction with which the pressures of the form begin.
    leaks
        Vertices of the ground at which the form lets water out, (n,); None: it lets none out.
    """

    carries: ndarray | None = None
    joins: ndarray | None = None
    acts_on: ndarray | None = None
    elastic_stiffness: Any = None
    nodes: tuple[ndarray, ndarray] | None = None
    parameters: Mapping[str, Any] = MappingProxyType({})
    suction: float = 0.0
    leaks: ndarray | None = None

    #: What a form that replaces another one has in common with it, and what it brings; without the
    #: latter, all of it.
    _same: tuple[str, ...] = ()
    _brought: tuple[str, ...] = ()

    def completed(self: Self, forms: Mapping[str, Any]) -> Self:
        """Return the form with what it takes from the others, such as a penalty from their
        stiffness.
        """
        return self

    def own_weight(self, acceleration: ndarray) -> ndarray | None:
        """Return the load vector of the weight under an acceleration over that of gravity, (dim,),
        or None.
        """
        return None

    def water_load(
        self, pressure: Callable[[ndarray, ndarray, ndarray], ndarray]
    ) -> ndarray | None:
        """Return the load vector of water on sides that are no facets, or None.

        Its pressure, (n,), is a function of points and outward normals, (n, dim) each, and sizes,
        (n,).
        """

    def pressure_at_nodes(self, x: ndarray) -> ndarray | None:
        """Return the pore pressure that the form adds to the ground, at the nodes of the
        displacements, (N/dim,).
        """

    def line_forces(self, state: Any) -> tuple[Any, ...] | None:
        """Return positions along a beam, x, y, N, V and M there, (n,) each, or None where the form
        is no beam.
        """

    def line_points(self, x: ndarray, state: Any) -> tuple[ndarray, dict[str, ndarray]] | None:
        """Return start, end and middle of a beam's elements, (3 m, dim), with values there, or
        None.
        """

    def members(self, state: Any) -> dict[str, ndarray]:
        """Return coordinates and forces of bars, or of points along a line, by the columns of a
        table, (n,) each.
        """
        return {}

    def continues(self, old: Any) -> Any:
        """Return the form as it replaces an old one and continues from the old state; by default of
        the same class.

        Raises
        ------
        ValueError
            The form cannot continue from the state of the old one.
        """
        if type(self) is not type(old):
            raise ValueError(f"{type(old).__name__} cannot become {type(self).__name__}")
        if not all(np.array_equal(getattr(self, name), getattr(old, name)) for name in self._same):
            raise ValueError("its nodes, ends or hinges are others")
        if not self._brought:
            return self
        new = copy(old)
        vars(new).update({name: getattr(self, name) for name in self._brought})
        return new

    def inherits(self, old: Any, state: Any) -> Any:
        """Return the state of an old form from which this one continues; a new stiffness alone
        changes no force.
        """
        before, now = old.stretched(state), self.stretched(state)
        if before is None or now is None or before.shape != now.shape or (before == now).all():
            return state
        return replace(state, free=state.free + before - now)

    def stretched(self, state: Any) -> ndarray | None:
        """Return what the force of a state adds to its deformation ``free`` of force; None for
        states without them.
        """

    def fits(self, state: Any) -> bool:
        """Return True if a state has the shapes of the initial state."""
        given, initial = arrays_of(state), arrays_of(self.initial_state())  # type: ignore[attr-defined]
        return {k: np.shape(a) for k, a in given.items()} == {
            k: np.shape(a) for k, a in initial.items()
        }

    def check_start(self, x: ndarray, state: Any) -> None:
        """Raise a ``ValueError`` if the form cannot continue from a state of other settings."""

    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterable[Remark]:
        """Return remarks on supports, inactive dofs, and the time since the last change to the end
        of a stage.
        """
        return ()

    def idle(self, fixed: ndarray) -> ndarray:
        """Return dofs of the form's own fields that do nothing between supports, and are held as
        well.
        """
        return np.zeros(0, int)

    def remarks_on(self, x: ndarray, states: Mapping[str, Any]) -> Iterable[Remark]:
        """Return remarks on the accepted states of other forms."""
        return ()

    def replaces(self, old: Any) -> bool:
        """Return True if the form takes over the forces of an old one, instead of which it becomes
        active.
        """
        return False

    def tractions_at(self, x: ndarray, state: Any) -> Any | None:
        """Return the map from tractions to nodal forces, where the form can start with given
        tractions, or None.
        """

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

    def undrained(self: Self) -> Self:
        """Return the form of a change so quick that no water flows."""
        return self

    def time_error(self, middle: Any, after: Any) -> tuple[float, float]:
        """Return the error of a step over the tolerance, and the quantity that it is compared
        with.
        """
        return 0.0, 0.0


class Reducible:
    """Search for a collapse: strength that can be reduced, and geometry that is held.

    Attributes
    ----------
    materials
        Materials of a solid by the name of their region; empty for other forms.
    law
        Law of a contact pair; None for other forms.
    strengths
        Names of the parts whose strength can be reduced, ``""`` for the form as a whole.
    """

    materials: Mapping[str, Any] = MappingProxyType({})
    law: Any = None
    strengths: tuple[str, ...] = ()

    def reduced(self: Self, factor: float, flow: str, names: Collection[str]) -> Self:
        """Return the form with some of its :attr:`strengths` divided by a factor, and with a flow
        rule.
        """
        return self

    def fixed_geometry(self, x: ndarray, state: Any) -> tuple[Any, Any]:
        """Return the form whose geometry is held as it is at the displacements x, and its state."""
        return self, state

    def released(self, x: ndarray, state: Any) -> tuple[Any, Any]:
        """Return the form whose geometry is not held, and its state: the inverse of
        :meth:`fixed_geometry`.
        """
        return self, state

    def with_resistance(self: Self) -> Self:
        """Return the form with damped tangents in which friction resists further slip."""
        return self

    def yielding(self, before: Any, after: Any) -> tuple[int, int]:
        """Return the number of points of solids that have flowed from one state to another, and of
        all points.
        """
        return 0, 0

    def shear_strain(self, x: ndarray) -> ndarray | None:
        """Return the largest shear strain of displacements at the points of a solid, (n_elements,
        n_points).
        """


class Regularised:
    """Regularisation: forms by which Newton's method reaches equilibrium of the form as given.

    Attributes
    ----------
    unilateral
        True if the form opens, closes and slips: on the way to equilibrium the residual may rise
        now and then.
    changing
        Dofs at which the tangent may change while Newton's method iterates; None: anywhere.
    saddle: bool
        True if multipliers change with the displacements: equilibrium then is no minimum of the
        energy along a step.
    outer_after: "near", "exact" or None
        State in which :meth:`outer` changes the form: near equilibrium, where it only follows the
        displacements; in exact equilibrium, beside other forms as well; None where it changes
        nothing.
    """

    unilateral: bool = False
    saddle: bool = False
    outer_after: Literal["near", "exact"] | None = None
    changing: ndarray | None = None

    def begin(self: Self, accepted: Any, failure: Failure | None = None) -> Self:
        """Return the form to begin an increment with: this form, or a regularised one that leads to
        it.

        Parameters
        ----------
        accepted, failure
            The accepted state; the failure of Newton's method, None before the first attempt.
        """
        return self

    def foreseen(
        self, start: ndarray, x: ndarray, before: ndarray | None, accepted: Any
    ) -> ndarray:
        """Return displacements to start from, with better values where the form knows some.

        Parameters
        ----------
        start, x, before : ndarray, shape (N,)
            Extrapolated displacements, the accepted ones, and those before; None for displacements
            after the first step of Newton's method from the accepted ones.
        accepted
            The accepted state.
        """
        return start

    def outer(self, x: ndarray, accepted: Any, found: Any) -> tuple[Any, Any] | None:
        """Return form and accepted state with which the increment must be solved once more, or
        None.

        Parameters
        ----------
        x, found
            Displacements and state of the equilibrium.
        accepted
            The accepted state, at the start of the increment.
        """

    @property
    def reason(self) -> str:
        """Reason why only this regularised form may have an equilibrium, for a message."""
        return ""
