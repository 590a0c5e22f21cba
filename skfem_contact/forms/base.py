"""Base class of forms, and functions of all forms of an analysis."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal, TypeVar

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..checks import names_of
from ..errors import Remark
from ..layout import Field
from ..sparse import Scattering
from ..units import Extent
from .law_calls import together
from .predicted_stress import PredictedStress
from .roles import Body, Reducible, having, materials_of, missing_roles

Self = TypeVar("Self")
#: Coordinate systems.
Coordinates = Literal["plane", "axisymmetric", "space"]
#: Kinematics of bodies.
Kinematics = Literal["small", "finite"]
#: Points, (n, dim), and values there by name, (n,) each.
Points = tuple[ndarray, dict[str, ndarray]]


class Response:
    """Internal force of a form, with lazily evaluated state and tangent.

    Parameters
    ----------
    force : ndarray, shape (N,) or (n,)
        Internal force; (n,) where `dofs` are given.
    state
        Function that returns the state that holds once the step is accepted.
    stiffness
        Function that returns the tangent ``d force / d x``.
    damped
        Function that returns a matrix near the tangent with which Newton's method is less prone to
        stall; by default the tangent itself.
    round_off
        Norm of the forces on displacements that round-off may leave, or these forces like `force`:
        equilibrium is no better than that.
    active
        Active set: the closed points and the sliding ones. Iterations continue while they
        find new sets.
    measure : ndarray
        Forces that unbalanced ones are compared with, where `force` is itself a difference that
        vanishes.
    dofs : ndarray, shape (n,)
        Dofs of a local response; by default the first ones.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> import skfem_contact as sc
    >>> sc.Response(np.zeros(2), lambda: None, lambda: csr_matrix(np.eye(2))).stiffness.shape
    (2, 2)
    """

    #: Stresses of a body, where the iterations predict them.
    prediction: PredictedStress | None = None

    def __init__(
        self,
        force: ndarray,
        state: Callable[[], Any],
        stiffness: Callable[[], csr_matrix],
        damped: Callable[[], csr_matrix] | None = None,
        round_off: float | ndarray = 0.0,
        active: bytes = b"",
        measure: ndarray | None = None,
        dofs: ndarray | None = None,
    ) -> None:
        self.force = force
        self.round_off = round_off
        self.active = active
        self.measure = force if measure is None else measure
        self._state = state
        self._stiffness = stiffness
        self._damped = damped
        self._dofs = dofs

    @cached_property
    def state(self) -> Any:
        """Candidate state; accepting a step is an assignment."""
        return self._state()

    @cached_property
    def stiffness(self) -> csr_matrix:
        """Tangent stiffness, a ``csr_matrix``."""
        return self._stiffness()

    @cached_property
    def damped(self) -> csr_matrix:
        """Tangent, or a matrix near it with which Newton's method is less prone to stall."""
        if self._damped is None:
            return self.stiffness
        return self._damped()

    @property
    def local(self) -> bool:
        """True for a response of some dofs only."""
        return self._dofs is not None

    def padded(self, n: int, scattering: Scattering | None = None) -> Response:
        """Return the response among n dofs; `scattering` keeps the slots of its matrices."""
        dofs = self._dofs
        if dofs is None and len(self.force) == n:
            return self

        # Vectors and matrices are spread over n dofs.
        def spread(values: ndarray) -> ndarray:
            if dofs is None:
                return np.concatenate((values, np.zeros(n - len(values))))
            return np.bincount(dofs, values, minlength=n)

        # Matrices are spread when they are asked for.
        slots = scattering or Scattering()
        round_off = self.round_off
        force = spread(self.force)
        response = Response(
            force,
            lambda: self.state,
            stiffness=lambda: slots.of(self.stiffness, dofs, n),
            damped=lambda: slots.of(self.damped, dofs, n),
            round_off=spread(round_off) if isinstance(round_off, np.ndarray) else round_off,
            active=self.active,
            measure=force if self.measure is self.force else spread(self.measure),
        )
        response.prediction = self.prediction
        return response


class Later(Response):
    """Response that is computed when something of it is first asked for."""

    def __init__(self, response: Callable[[], Response]) -> None:
        self._find = response

    def __getattr__(self, name: str) -> Any:
        # An AttributeError of a law would make a cached property ask for itself again
        if name == "_found":
            self._found = self._find()
            return self._found
        return getattr(self._found, name)


Value = TypeVar("Value")


class Outputs:
    """Values of a form for tables, reports and pictures.

    Every value may be given as a function without arguments, which is called at first access.

    Parameters
    ----------
    summary : str
        One line for the table of a result.
    remarks : iterable of Remark
        Remarks on the accepted state.
    parameters : dict
        Stiffnesses, strengths and other parameters by their names, for reports.
    lines : tuple
        Coordinates x and y along a beam, and N, V and M, (n,) each.
    points : tuple
        Start, end and middle of the elements of a beam, (3 m, dim), and their values by name.
    triangles : tuple
        Corners of the triangles of a shell, (3 m, 3), and their values by name.
    members : dict
        Coordinates and forces of bars, or of points along a line, by the columns of a table, (n,)
        each.
    yielding
        Function of an earlier state that returns the number of points that have flowed since, and
        of all points.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.Outputs(summary=lambda: f"N = {2 * 5.}").summary
    'N = 10.0'
    """

    def __init__(
        self,
        summary: str | Callable[[], str] = "",
        remarks: Iterable[Remark] | Callable[[], Iterable[Remark]] = (),
        parameters: Mapping[str, Any] | Callable[[], Mapping[str, Any]] = MappingProxyType({}),
        lines: tuple[Any, ...] | Callable[[], tuple[Any, ...]] | None = None,
        points: Points | Callable[[], Points] | None = None,
        triangles: Points | Callable[[], Points] | None = None,
        members: Mapping[str, ndarray] | Callable[[], Mapping[str, ndarray]] | None = None,
        yielding: Callable[[Any], tuple[int, int]] | None = None,
    ) -> None:
        self._summary = summary
        self._remarks = remarks
        self._parameters = parameters
        self._lines = lines
        self._points = points
        self._triangles = triangles
        self._members = members
        self._yielding = yielding

    @cached_property
    def summary(self) -> str:
        """One line for the table of a result."""
        return _value(self._summary)

    @cached_property
    def remarks(self) -> tuple[Remark, ...]:
        """Remarks on the accepted state."""
        return tuple(_value(self._remarks))

    @cached_property
    def parameters(self) -> Mapping[str, Any]:
        """Parameters by their names."""
        return _value(self._parameters)

    @cached_property
    def lines(self) -> tuple[Any, ...] | None:
        """Coordinates and section forces along a beam; None where the form is no beam."""
        return _value(self._lines)

    @cached_property
    def points(self) -> Points | None:
        """Points of a beam with their values; None where the form is no beam."""
        return _value(self._points)

    @cached_property
    def triangles(self) -> Points | None:
        """Corners of triangles with their values; None where the form is no shell."""
        return _value(self._triangles)

    @cached_property
    def members(self) -> Mapping[str, ndarray]:
        """Coordinates and forces of bars, empty where the form has none."""
        return _value(self._members) or {}

    def yielding(self, before: Any) -> tuple[int, int]:
        """Return the number of points that have flowed since an earlier state, and of all."""
        if self._yielding is None:
            return (0, 0)
        return self._yielding(before)


def counted(flowed: ndarray) -> tuple[int, int]:
    """Return the number of points of a mask, (n,), and of all: values of `Outputs.yielding`."""
    return int(flowed.sum()), flowed.size


def _value(given: Any) -> Any:
    """Return a value that may be given as a function."""
    if callable(given):
        return given()
    return given


class Form:
    """Base class of solids, contact pairs, bars, and forms of a user's own.

    A form defines :meth:`assemble` and, where it has a memory, :meth:`initial_state`. A form that
    can do more derives from the roles of :mod:`skfem_contact.roles` as well.

    Attributes
    ----------
    size
        Number of dofs that the form knows, the first ones of the analysis; None: all of them.
    fields
        Dofs that the form brings besides the displacements, see :class:`Field`.
    coordinates
        Coordinate system: ``"plane"``, ``"axisymmetric"`` (forces per radian about the axis x = 0)
        or ``"space"``; None where the form has no opinion.
    kinematics
        ``"finite"`` for a body whose rotations and strains may be large, ``"small"`` for a form
        that is wrong beside such a body; None where the form suits both.
    symmetric
        True if the tangent is symmetric.
    changing
        Dofs at which the tangent may change while Newton's method iterates; None: anywhere.
    extent
        Extent to which forces and stiffnesses in tables belong: ``"member"``, ``"length"`` out of
        the plane, or ``"radian"``.

    Examples
    --------
    A spring between a dof and the ground:

    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> import skfem_contact as sc
    >>> class Spring(sc.Form):
    ...     size = 1
    ...     def assemble(self, x, state):
    ...         return sc.Response(20. * x, lambda: state, lambda: csr_matrix([[20.]]))
    >>> result = sc.Model({"spring": Spring()}).run([sc.Stage("pull", np.array([5.]))])
    >>> result["pull"].x
    array([0.25])
    """

    size: int | None = None
    fields: tuple[Field, ...] = ()
    coordinates: Coordinates | None = None
    kinematics: Kinematics | None = None
    symmetric: bool = False
    changing: ndarray | None = None
    extent: Extent = "member"

    def assemble(self, x: ndarray, state: Any) -> Response:
        """Return the response to displacements from an accepted state."""
        raise NotImplementedError

    def initial_state(self, x: ndarray | None = None) -> Any:
        """Return the state of unstrained bodies, undeformed or active from displacements x on.

        None stands for a form without memory.
        """
        return None

    def numbered(self: Self, numbers: Mapping[Field, ndarray]) -> Self:
        """Return the form with the dofs of the fields that it brings or borrows.

        ``numbers[field]`` has the shape (n,).
        """
        return self

    def completed(self: Self, forms: Mapping[str, Any]) -> Self:
        """Return the form with properties of other forms, such as a penalty by stiffness."""
        return self

    def outputs(self, x: ndarray, state: Any) -> Outputs:
        """Return the values of displacements and an accepted state for tables and pictures."""
        return Outputs()


#: Forms, and states of forms, by name.
Forms = Mapping[str, Form]
States = Mapping[str, Any]


#: Members of forms of earlier versions, which :class:`Outputs` has now.
_FORMER = ("summary", "remarks", "line_forces", "line_points", "members", "yielding")


def as_forms(forms: Mapping[str, Any]) -> dict[str, Form]:
    """Validate forms.

    Raises
    ------
    ValueError
        No dictionary, an object that is no form, or a form with members of a role that it lacks;
        the form is named.
    """
    if not isinstance(forms, Mapping):
        raise ValueError(f"forms must be a dictionary {{name: form}}, not {type(forms).__name__}")
    for name, form in forms.items():
        _check_form(name, form)
    return dict(forms)


def _check_form(name: str, form: Any) -> None:
    """Refuse an object that is no form, or a form that lacks a role."""
    # Refuse classes, and objects without the call that every form has.
    if isinstance(form, type):
        raise ValueError(
            f"'{name}' is no form: {form!r} has no values; give an object of the class"
        )
    call = getattr(form, "assemble", None)
    if not callable(call) or getattr(call, "__func__", None) is Form.assemble:
        raise ValueError(
            f"'{name}' is no form: {form!r} has no assemble; every form has assemble(x, state)"
        )
    if not isinstance(form, Form):
        raise ValueError(
            f"'{name}' is no form: {type(form).__name__} has assemble, but does not derive from "
            "skfem_contact.Form"
        )
    # Refuse members whose role is missing.
    for member, role in missing_roles(form).items():
        raise ValueError(
            f"'{name}' has `{member}`, but not its role: derive {type(form).__name__} from "
            f"skfem_contact.roles.{role} as well, or choose another name"
        )
    # Refuse members of former versions.
    for member in _FORMER:
        if callable(getattr(form, member, None)):
            raise ValueError(
                f"'{name}' has `{member}`, which no analysis asks for: return it from "
                "outputs(x, state), see skfem_contact.Outputs, or choose another name"
            )


def solids_of(forms: Forms) -> dict[str, Any]:
    """Return the forms that give stiffness to elements."""
    return having(forms, Body)


def responses_of(
    forms: Forms,
    x: ndarray,
    states: States,
    slots: Mapping[str, Scattering] | None = None,
) -> dict[str, Response]:
    """Return the responses of the forms among all dofs, with the slots of their matrices."""
    if slots is None:
        slots = defaultdict(Scattering)
    # The laws of all forms are called together, before a response is asked for anything.
    responses = {}
    with together():
        for name, form in forms.items():
            responses[name] = form.assemble(x[: form.size], states[name])
    return {name: each.padded(len(x), slots[name]) for name, each in responses.items()}


def summaries(forms: Forms, x: ndarray, states: States) -> dict[str, str]:
    """Return the lines of all forms for the table of a result."""
    return {
        name: form.outputs(x[: form.size], states[name]).summary for name, form in forms.items()
    }


def internal_force(forms: Forms, x: ndarray, states: States) -> ndarray:
    """Return the sum of the internal forces of all forms, (N,)."""
    return sum(
        (response.force for response in responses_of(forms, x, states).values()),
        start=np.zeros(len(x)),
    )


def reduced_parts(
    forms: Forms, reduce: str | Collection[str] | None, exclude: str | Collection[str]
) -> dict[str, tuple[str, ...]]:
    """Return the parts to reduce by form, by default all.

    A part is the name of a region, or ``""`` for a form as a whole.

    Raises
    ------
    ValueError
        A name that does not exist or has no strength, or nothing to reduce.
    """
    # Check the names.
    excluded = set(names_of(exclude))
    named = set(names_of(reduce or ()))
    _check_reducible(forms, named, excluded)
    targets = {}
    # Take the parts that are named and not excluded.
    for name, form in having(forms, Reducible).items():
        parts = set(form.strengths)
        if reduce is not None and name not in named:
            parts &= named
        if name in excluded:
            parts.clear()
        parts -= excluded
        if parts:
            targets[name] = tuple(part for part in form.strengths if part in parts)
    if not targets:
        raise ValueError(
            "there is nothing to reduce: nothing among the forms has a strength that can be"
        )
    return targets


def _check_reducible(forms: Forms, named: set[str], excluded: set[str]) -> None:
    """Refuse names that do not exist, and names to reduce without a strength."""
    # Names must exist.
    known = set(forms).union(*(body.materials for body in having(forms, Body).values()))
    for name in sorted((named | excluded) - known):
        raise ValueError(
            f"there is no form or region '{name}' to reduce; existing: {', '.join(sorted(known))}"
        )
    # Those to reduce must have a strength.
    for name, form in forms.items():
        materials = materials_of(form)
        if isinstance(form, Reducible):
            strengths = form.strengths
        else:
            strengths = ()
        for region in named & set(materials) - set(strengths):
            law = type(materials[region]).__name__
            raise ValueError(f"'{region}' cannot be reduced: {law} has no strength")
        if name in named and not strengths and not materials:
            raise ValueError(f"'{name}' cannot be reduced: {form!r} has no strength")


def dilate_less(forms: Forms) -> bool:
    """Return True if a material of some forms dilates less than its friction."""
    bodies = having(forms, Body).values()
    return any(material.dilates_less for body in bodies for material in body.materials.values())


def part_names(parts: Mapping[str, Collection[str]]) -> tuple[str, ...]:
    """Return names such as ``soil.clay`` of parts by form; a form as a whole has its own name."""
    result = []
    for form, regions in parts.items():
        result += [f"{form}.{region}" if region else form for region in regions]
    return tuple(result)
