"""Base class of forms, and functions of all forms of an analysis."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cached_property
from typing import Any, Literal, TypeVar

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..checks import names_of
from ..errors import Remark
from ..layout import Field, elements_of
from ..sparse import padded, scattered
from .staged import InTime, Reducible, Regularised, Staged

Self = TypeVar("Self")
#: Coordinate systems.
Coordinates = Literal["plane", "axisymmetric", "space"]


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
        Active set: the points that are closed and those that slide. Iterations continue while they
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
        self.force, self.round_off, self.active = force, round_off, active
        self.measure = force if measure is None else measure
        self._state, self._stiffness, self._damped, self._dofs = state, stiffness, damped, dofs

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
        return self.stiffness if self._damped is None else self._damped()

    @property
    def local(self) -> bool:
        """True for a response of some dofs only."""
        return self._dofs is not None

    def padded(self, n: int) -> Response:
        """Return the response among n dofs."""
        dofs = self._dofs
        if dofs is None and len(self.force) == n:
            return self

        def spread(values: ndarray) -> ndarray:
            if dofs is None:
                return np.concatenate((values, np.zeros(n - len(values))))
            return np.bincount(dofs, values, minlength=n)

        def among(K: csr_matrix) -> csr_matrix:
            return padded(K, n) if dofs is None else scattered(K, dofs, n)

        return Response(
            spread(self.force),
            lambda: self.state,
            lambda: among(self.stiffness),
            lambda: among(self.damped),
            _each(self.round_off, spread),
            self.active,
            spread(self.measure),
        )

    def lost(self, part: slice) -> float:
        """Return the norm of the forces that round-off may leave on some dofs."""
        if isinstance(self.round_off, np.ndarray):
            return float(np.linalg.norm(self.round_off[part]))
        return self.round_off if part.start == 0 else 0.0


def _each(round_off: float | ndarray, change: Callable[[ndarray], ndarray]) -> float | ndarray:
    """Return round-off with its forces changed, if it is given by dofs."""
    return change(round_off) if isinstance(round_off, np.ndarray) else round_off


class Form(Staged, InTime, Reducible, Regularised):
    """Base class of solids, contact pairs, bars, and forms of a user's own.

    A form defines :meth:`assemble` and :meth:`initial_state`. All other members have defaults, here
    or in one of the four base classes, each of which holds one optional part.

    Attributes
    ----------
    size
        Number of dofs that the form knows, the first ones of the analysis; None: all of them.
    basis
        Basis of the elements that the form gives stiffness to.
    fields
        Dofs that the form brings besides the displacements, see :class:`Field`.
    borrowed
        Fields of other forms that this form acts on.
    coordinates
        Coordinate system: ``"plane"``, ``"axisymmetric"`` (forces per radian about the axis x = 0)
        or ``"space"``; None where the form has no opinion.
    symmetric
        True if the tangent is symmetric.

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
    basis: Any = None
    fields: tuple[Field, ...] = ()
    borrowed: tuple[Field, ...] = ()
    coordinates: Coordinates | None = None
    symmetric: bool = False

    def assemble(self, x: ndarray, state: Any) -> Response:
        """Return the response to displacements from an accepted state."""
        raise NotImplementedError

    def initial_state(self, x: ndarray | None = None) -> Any:
        """Return the state of unstrained bodies, or of those active from displacements x on; None:
        no memory.
        """
        return None

    @property
    def elements(self) -> ndarray:
        """Numbers in the mesh of the elements that the form gives stiffness to, (n_elements,)."""
        return elements_of(self.basis)

    def numbered(self: Self, numbers: Mapping[Field, ndarray]) -> Self:
        """Return the form with the dofs of its fields and of the borrowed ones, ``numbers[field]``,
        (n,).
        """
        return self

    def summary(self, state: Any) -> str:
        """Return one line for the table of a result."""
        return ""

    def remarks(self, x: ndarray, state: Any) -> Iterable[Remark]:
        """Return remarks on an accepted state and its displacements."""
        return ()


def as_forms(forms: Mapping[str, Any]) -> dict[str, Form]:
    """Validate forms; wrap objects that do not derive from :class:`Form` with its defaults.

    Raises
    ------
    ValueError
        No dictionary, or a form that lacks what every form must offer; it is named.
    """
    if not isinstance(forms, Mapping):
        raise ValueError(f"forms must be a dictionary {{name: form}}, not {type(forms).__name__}")
    for name, form in forms.items():
        call = getattr(form, "assemble", None)
        missing = not callable(call) or getattr(call, "__func__", None) is Form.assemble
        if missing or isinstance(form, type):
            raise ValueError(
                f"'{name}' is no form: {form!r} has no {'assemble' if missing else 'values'}; "
                f"every form "
                "has assemble(x, state)"
            )
    return {
        name: form if isinstance(form, Form) else _Completed(form) for name, form in forms.items()
    }


class _Completed(Form):
    """Form that does not derive from :class:`Form`, with the defaults from there."""

    def __init__(self, form: Any) -> None:
        self._form = form
        for name in dir(Form):
            if not name.startswith("_") and hasattr(form, name):
                setattr(self, name, getattr(form, name))

    def __repr__(self) -> str:
        return repr(self._form)


def solids_of(forms: Mapping[str, Form]) -> dict[str, Any]:
    """Return the forms that give stiffness to elements."""
    return {name: form for name, form in forms.items() if form.basis is not None}


def pairs_of(forms: Mapping[str, Form]) -> dict[str, Any]:
    """Return the contact pairs."""
    return {name: form for name, form in forms.items() if form.law is not None}


def waters_of(forms: Mapping[str, Form]) -> dict[str, Form]:
    """Return the forms that bring pressures of water."""
    return {
        name: form
        for name, form in forms.items()
        if any(field.kind == "pressure" for field in form.fields)
    }


def responses_of(
    forms: Mapping[str, Form], x: ndarray, states: Mapping[str, Any]
) -> dict[str, Response]:
    """Return the responses of the forms among all dofs."""
    return {
        name: form.assemble(x[: form.size], states[name]).padded(len(x))
        for name, form in forms.items()
    }


def internal_force(forms: Mapping[str, Form], x: ndarray, states: Mapping[str, Any]) -> ndarray:
    """Return the sum of the internal forces of all forms, (N,)."""
    return sum(
        (response.force for response in responses_of(forms, x, states).values()),
        start=np.zeros(len(x)),
    )


def reduced_parts(
    forms: Mapping[str, Form], reduce: str | Collection[str] | None, exclude: str | Collection[str]
) -> dict[str, tuple[str, ...]]:
    """Return the parts to reduce by form, by default all: names of regions, or ``""`` for a form as
    a whole.

    Raises
    ------
    ValueError
        A name that does not exist or has no strength, or nothing to reduce.
    """
    exclude, named = set(names_of(exclude)), set(names_of(reduce or ()))
    known = sorted({*forms, *(region for form in forms.values() for region in form.materials)})
    for name in sorted(named | exclude):
        if name not in known:
            raise ValueError(
                f"there is no form or region '{name}' to reduce; existing: {', '.join(known)}"
            )
    targets = {}
    for name, form in forms.items():
        for region in named.intersection(form.materials).difference(form.strengths):
            raise ValueError(
                f"'{region}' cannot be reduced: {type(form.materials[region]).__name__} has no "
                f"strength"
            )
        if not form.materials and not form.strengths and name in named:
            raise ValueError(f"'{name}' cannot be reduced: {form!r} has no strength")
        parts = tuple(
            part
            for part in form.strengths
            if exclude.isdisjoint((name, part))
            and (reduce is None or not named.isdisjoint((name, part)))
        )
        if parts:
            targets[name] = parts
    if not targets:
        raise ValueError(
            "there is nothing to reduce: nothing among the forms has a strength that can be"
        )
    return targets


def dilate_less(forms: Mapping[str, Form]) -> bool:
    """Return True if a material of some forms dilates less than its friction."""
    return any(
        material.dilates_less for form in forms.values() for material in form.materials.values()
    )


def part_names(parts: Mapping[str, Collection[str]]) -> tuple[str, ...]:
    """Return names such as ``soil.clay`` of parts by form; a form as a whole has its own name."""
    return tuple(
        ".".join(filter(None, (name, part))) for name, given in parts.items() for part in given
    )
