"""Roles: abilities that a form adds to :class:`~skfem_contact.Form`, for some analyses.

A form derives from :class:`~skfem_contact.Form` and from the roles that it has. An analysis selects
the forms that have a role with :func:`having`, and never asks for a class of forms.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from copy import copy
from dataclasses import fields, is_dataclass, replace
from types import MappingProxyType
from typing import Any, Literal, TypeVar

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..errors import Failure, Remark
from ..layout import Field, elements_of

__all__ = [
    "Absorbing",
    "Body",
    "Couples",
    "Dissipating",
    "Draining",
    "Loaded",
    "Reducible",
    "Regularised",
    "Slender",
    "Staged",
    "Stiff",
    "Timed",
    "Touching",
    "Wet",
    "having",
]

Self = TypeVar("Self")


def having(forms: Mapping[str, Any], role: type) -> dict[str, Any]:
    """Return the forms that have a role.

    Parameters
    ----------
    forms
        Forms by name.
    role
        A class of this module.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> class Drag(sc.Form, sc.roles.Timed):
    ...     pass
    >>> list(sc.roles.having({"drag": Drag(), "other": sc.Form()}, sc.roles.Timed))
    ['drag']
    """
    return {name: form for name, form in forms.items() if isinstance(form, role)}


def changed(forms: Mapping[str, Any], role: type, change: Callable[[Any], Any]) -> dict[str, Any]:
    """Return all forms, with a change of the forms that have a role."""
    changed = {name: change(form) for name, form in having(forms, role).items()}
    return {**forms, **changed}


class Stiff:
    """Linear stiffness by which penalties are chosen and new bodies are placed.

    Attributes
    ----------
    elastic_stiffness
        Stiffness of the unyielded form, a ``csr_matrix`` of shape (N, N).
    """

    elastic_stiffness: Any = None

    @property
    def elastic_moduli(self) -> ndarray:
        """Elastic moduli of the elements, (n_elements, r, r): normal ones first, shear last."""
        raise NotImplementedError

    def scaled_stiffness(self, factors: Mapping[str, float]) -> csr_matrix:
        """Return the elastic stiffness with factors by region, zero for others, (N, N)."""
        values = set(factors.values()) or {0.0}
        if len(values) > 1:
            raise NotImplementedError("the regions of this form have one factor")
        return csr_matrix(values.pop() * self.elastic_stiffness)


class Loaded:
    """Loads that follow from the form itself."""

    def own_weight(self, acceleration: ndarray) -> ndarray | None:
        """Return the load vector of the weight, or None where the form is weightless.

        The acceleration, (dim,), is relative to the acceleration of gravity.
        """

    def water_load(
        self, pressure: Callable[[ndarray, ndarray, ndarray], ndarray]
    ) -> ndarray | None:
        """Return the load vector of water on sides that are no facets, or None.

        Its pressure, (n,), is a function of points and outward normals, (n, dim) each, and sizes,
        (n,).
        """

    def weight_matrix(
        self, consistent: bool, factors: Mapping[str, float] | None = None
    ) -> csr_matrix | None:
        """Return the matrix of masses times the acceleration of gravity, or None.

        None stands for the sums of :meth:`own_weight` at the nodes.

        Parameters
        ----------
        consistent
            False for a diagonal matrix.
        factors
            Factors by region; by default 1.
        """


class Body(Stiff, Loaded):
    """Elements of a mesh to which the form gives stiffness.

    Attributes
    ----------
    basis
        Basis of the elements.
    materials
        Materials by the names of their regions.
    """

    basis: Any = None
    materials: Mapping[str, Any] = MappingProxyType({})

    @property
    def quadrature_advice(self) -> str:
        """Advice on the rule of quadrature where it lets searches stall; "" without one."""
        return ""

    @property
    def elements(self) -> ndarray:
        """Numbers of the elements in the mesh, (n_elements,)."""
        return elements_of(self.basis)

    def on(self: Self, basis: Any) -> Self | None:
        """Return the body on the basis of a finer mesh with the same names, None if it cannot be.

        Parameters of its materials are numbers or functions of the coordinates.
        """

    def shear_strain(self, x: ndarray) -> ndarray | None:
        """Return the largest shear strain of displacements, (n_elements, n_points), or None."""


def materials_of(form: Any) -> Mapping[str, Any]:
    """Return the materials of a form by the names of their regions; none where it is no body."""
    if isinstance(form, Body):
        return form.materials
    return {}


class Couples:
    """Dofs of bodies or of other forms that the form acts on.

    Attributes
    ----------
    joins
        Dofs that the form couples to each other, -1 among them for a rigid obstacle; None: it may
        hold any dof.
    acts_on
        Dofs that the form acts on, all of which must be active; None: any of them.
    borrowed
        Fields of other forms that the form acts on.
    nodes
        Dofs, (n,), and the coordinates that the form takes their nodes to have, (dim, n).
    """

    joins: ndarray | None = None
    acts_on: ndarray | None = None
    borrowed: tuple[Field, ...] = ()
    nodes: tuple[ndarray, ndarray] | None = None

    def mirrored(self: Self, forms: Mapping[str, Any], fixed: ndarray) -> Self:
        """Return the form as it is in the whole model of which supports leave a half.

        Its penalty then is the same in both.
        """
        return self

    def let_go(self: Self, inactive: ndarray, gone: ndarray) -> Self:
        """Return the form without its parts on inactive dofs and on elements that are gone."""
        return self


def borrowed_by(form: Any) -> tuple[Field, ...]:
    """Return the fields of other forms that a form acts on."""
    if isinstance(form, Couples):
        return form.borrowed
    return ()


def joined_by(form: Any) -> ndarray | None:
    """Return the dofs that a form couples to each other; None where it may hold any dof."""
    if isinstance(form, Couples):
        return form.joins
    if isinstance(form, Body):
        return np.zeros(0, int)
    return None


class Touching(Couples):
    """Contact of two surfaces.

    Attributes
    ----------
    law
        Interface law.
    has_friction
        True if the law may have friction.
    saddle
        True if multipliers change with the displacements: equilibrium then is no minimum of the
        energy along a step.
    """

    law: Any = None
    has_friction: bool = True
    saddle: bool = False

    def replaces(self, old: Any) -> bool:
        """Return True if the pair takes over the forces of an old one when it becomes active."""
        return False

    def tractions_at(self, x: ndarray, state: Any) -> Any | None:
        """Return the map from tractions to nodal forces, or None.

        A pair that has such a map can start with given tractions.
        """

    def check_start(self, x: ndarray, state: Any) -> None:
        """Raise a ``ValueError`` if the pair cannot continue from a state of other settings."""


class Staged:
    """Activation, deactivation and replacement by stages."""

    #: Attributes that a form has in common with the one that it replaces, and those that it brings;
    #: without the latter it brings all of them.
    _same: tuple[str, ...] = ()
    _brought: tuple[str, ...] = ()

    def continues(self, old: Any) -> Any:
        """Return the form as it replaces an old one and continues from the old state.

        Raises
        ------
        ValueError
            The form cannot continue from the state of the old one.
        """
        check_class(self, old)
        if not all(np.array_equal(getattr(self, name), getattr(old, name)) for name in self._same):
            raise ValueError("its nodes, ends or hinges are others")
        if not self._brought:
            return self
        new = copy(old)
        vars(new).update({name: getattr(self, name) for name in self._brought})
        return new

    def inherits(self, old: Any, state: Any) -> Any:
        """Return the state of an old form from which this one continues."""
        return state

    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterable[Remark]:
        """Return remarks on a stage.

        Parameters
        ----------
        fixed, held
            Supported dofs and inactive ones.
        duration
            Time from the last change to the end of the stage.
        """
        return ()

    def fits(self, state: Any) -> bool:
        """Return True if a state has the shapes of the initial state."""
        return same_shapes(state, self.initial_state())  # type: ignore[attr-defined]

    def supported(self, fixed: ndarray) -> tuple[Any, ndarray]:
        """Return the form between supports, and dofs of its own fields that do nothing there."""
        return self, np.zeros(0, int)

    def rebased(self, x: ndarray, state: Any) -> Any:
        """Return the state once displacements are counted from x on."""
        return state


def continued(new: Any, old: Any) -> Any:
    """Return the form as it replaces an old one and continues from the old state."""
    if isinstance(new, Staged):
        return new.continues(old)
    check_class(new, old)
    return new


def fits(form: Any, state: Any) -> bool:
    """Return True if a form can continue from a state, by its shapes."""
    if isinstance(form, Staged):
        return form.fits(state)
    return same_shapes(state, form.initial_state())


def check_class(new: Any, old: Any) -> None:
    """Refuse a form that replaces a form of another class."""
    if type(new) is not type(old):
        raise ValueError(f"{type(old).__name__} cannot become {type(new).__name__}")


def with_force_kept(state: Any, before: ndarray, now: ndarray) -> Any:
    """Return the state with the same force where only the stiffness has changed.

    Parameters
    ----------
    state
        State with the deformation ``free`` of force.
    before, now
        Deformations by the force of the state, with the old and with the new stiffness.
    """
    if before.shape != now.shape or (before == now).all():
        return state
    return replace(state, free=state.free + before - now)


class Timed:
    """Steps in time.

    Attributes
    ----------
    second_order
        True if a step can be taken in two parts, see :meth:`extrapolated`.
    """

    second_order: bool = False

    def over(self: Self, duration: float) -> Self:
        """Return the form of a step in time."""
        return self

    def extrapolated(self, before: Any, found: Any, ratio: float) -> Any:
        """Return the state `ratio` times as far from an earlier state as the one that was found."""

    def undrained(self: Self) -> Self:
        """Return the form of a change so quick that no water flows."""
        return self

    def time_error(self, middle: Any, after: Any) -> tuple[float, float]:
        """Return the error of a step over the tolerance, and the quantity to compare it with."""
        return 0.0, 0.0


class Dissipating:
    """Energy that a form does not give back: plastic flow, friction."""

    def dissipated(self, before: Any, after: Any, work: float) -> float:
        """Return the energy that is dissipated between two accepted states.

        Parameters
        ----------
        before, after
            The states.
        work
            Work of the internal forces of the form between them.
        """
        return 0.0


class Reducible:
    """Search for a collapse: strength that can be reduced, and geometry that is fixed.

    Attributes
    ----------
    strengths
        Names of the parts whose strength can be reduced, ``""`` for the form as a whole.
    """

    strengths: tuple[str, ...] = ()

    def reduced(self: Self, factor: float, flow: str, names: Collection[str]) -> Self:
        """Return the form with some of its :attr:`strengths` over a factor, and a flow rule."""
        return self

    def fixed_geometry(self, x: ndarray, state: Any) -> tuple[Any, Any]:
        """Return the form with the geometry of the displacements x, and its state."""
        return self, state

    def released(self, x: ndarray, state: Any) -> tuple[Any, Any]:
        """Return the form whose geometry follows again, and its state.

        This is the inverse of :meth:`fixed_geometry`.
        """
        return self, state

    def with_resistance(self: Self) -> Self:
        """Return the form with damped tangents in which friction resists further slip."""
        return self


class Regularised:
    """Regularisation: forms by which Newton's method reaches equilibrium of the form as given.

    Attributes
    ----------
    unilateral
        True if the form opens, closes and slips: on the way to equilibrium the residual may rise
        now and then.
    outer_after: "near", "exact" or None
        State in which :meth:`outer` changes the form: near equilibrium, where it only follows the
        displacements; in exact equilibrium; None where it changes nothing.
    """

    unilateral: bool = False
    outer_after: Literal["near", "exact"] | None = None

    def begin(self: Self, accepted: Any, failure: Failure | None = None) -> Self:
        """Return the form to begin an increment with: this form, or a regularised one.

        Parameters
        ----------
        accepted, failure
            The accepted state; the failure of Newton's method, None before the first attempt.
        """
        return self

    def foreseen(
        self,
        start: ndarray,
        x: ndarray,
        before: ndarray | None,
        accepted: Any,
    ) -> ndarray:
        """Return displacements to start from, with better values where the form knows some.

        Parameters
        ----------
        start, x, before : ndarray, shape (N,)
            Extrapolated displacements, the accepted ones, and the ones before; None for
            displacements after the first step of Newton's method from the accepted ones.
        accepted
            The accepted state.
        """
        return start

    def outer(self, x: ndarray, accepted: Any, found: Any) -> tuple[Any, Any] | None:
        """Return form and accepted state to solve the increment with once more, or None.

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


class Slender:
    """Members that a thrust may buckle, in a theory of first order."""

    def lost_by_thrust(self, state: Any, share: float) -> tuple[ndarray, Any] | None:
        """Return n dofs and the stiffness that thrusts take away, a ``csr_matrix`` (n, n).

        None stands for thrusts below a share of the smallest buckling load, whatever the supports.
        """


class Wet:
    """Water in the pores of bodies.

    Attributes
    ----------
    carries
        Dofs of fields for which the form has equations; None: all of its fields.
    suction
        Largest suction with which the pressures begin.
    elements
        Numbers in the mesh of the elements with water, (n_elements,).
    """

    carries: ndarray | None = None
    suction: float = 0.0
    elements: Any = None

    def pressure_at_nodes(self, x: ndarray) -> ndarray:
        """Return the pore pressure at the nodes of the displacements, (N/dim,)."""
        raise NotImplementedError

    def remarks_on(self, x: ndarray, states: Mapping[str, Any]) -> Iterable[Remark]:
        """Return remarks on the accepted states of other forms."""
        return ()

    def with_inertia(self: Self, rho_inf: float, density: ndarray) -> tuple[Self, float]:
        """Return the form in a stage with inertia, and the time in which its water speeds up.

        Parameters
        ----------
        rho_inf
            Share of the amplitude of the highest frequencies that a step leaves.
        density
            Density of the ground by elements of the mesh, (n_elements,).

        Raises
        ------
        ValueError
            Water that inertia is not supported with.
        """
        raise ValueError("inertia is not supported with this water")


class Absorbing:
    """Boundaries in motion: masses and viscosity beside those of bodies.

    Attributes
    ----------
    of_rock
        True if the motion of the base arrives here, from the rock below.
    absorbs_at
        Facets of the mesh through which waves leave: of one boundary alone.
    """

    of_rock: bool = False
    absorbs_at: ndarray = np.zeros(0, int)

    def matrices(self, given: Any) -> tuple[csr_matrix, csr_matrix]:
        """Return mass and damping, (N, N) each.

        `given` has the acceleration of gravity, the kind of masses and the damping of regions.
        """
        raise NotImplementedError

    def in_motion(self: Self) -> Self:
        """Return the form in a stage with inertia."""
        return self

    def begun(self, states: Mapping[str, Any], state: Any) -> Any:
        """Return the state at the start of such a stage, from the states of all forms."""
        return state


class Draining:
    """Drains through which water leaves the ground.

    Attributes
    ----------
    leaks
        Vertices of the ground at which water leaves, (n,).
    """

    leaks: ndarray = np.zeros(0, int)


#: All roles.
ROLES: tuple[type, ...] = (
    Stiff,
    Loaded,
    Body,
    Couples,
    Touching,
    Staged,
    Timed,
    Reducible,
    Regularised,
    Slender,
    Wet,
    Absorbing,
    Dissipating,
    Draining,
)
#: Members that forms may also have for themselves, without any role.
_COMMON = {"basis", "elements", "law", "materials", "nodes", "reason"}


def missing_roles(form: Any) -> dict[str, str]:
    """Return members of roles that a form has, with the name of the role that it lacks."""
    found = {}
    for role in ROLES:
        members = {name for name in vars(role) if not name.startswith("_")}
        for name in sorted(members - _COMMON):
            if not isinstance(form, role) and hasattr(form, name):
                found[name] = role.__name__
    return found


def arrays_of(state: Any) -> dict[str, Any]:
    """Return the parts of a state: fields of a dataclass, items of a tuple, or the state itself."""
    if is_dataclass(state):
        return {field.name: getattr(state, field.name) for field in fields(state)}
    if isinstance(state, tuple):
        return {str(k): values for k, values in enumerate(state)}
    if state is None:
        return {}
    return {"values": state}


def with_arrays(like: Any, arrays: Mapping[str, ndarray]) -> Any:
    """Return a state like another one of these arrays; the inverse of :func:`arrays_of`."""
    if is_dataclass(like):
        return type(like)(**arrays)  # type: ignore[misc]
    if isinstance(like, tuple):
        if hasattr(like, "_fields"):
            return type(like)(*arrays.values())
        return tuple(arrays.values())
    return arrays.get("values")


def same_shapes(state: Any, other: Any) -> bool:
    """Return True if the parts of two states have the same names and shapes."""
    shapes, wanted = (
        {name: np.shape(values) for name, values in arrays_of(one).items()}
        for one in (state, other)
    )
    return shapes == wanted
