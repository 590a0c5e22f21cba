"""What carries load: the calls that solids, contact pairs and forms of a user answer."""
from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..errors import Failure, Remark
from ..layout import Field, elements_of
from ..sparse import padded
from .states import arrays_of


class Response:
    """What a form answers: the internal force and, computed at their first access only, candidate state and tangent.

    Parameters
    ----------
    force
        Internal force, shape (N,).
    state
        Function that gives the state that holds once the step is accepted.
    stiffness
        Function that computes the tangent ``d force / d x``.
    damped
        Function that computes a matrix near the tangent with which Newton's method is less prone to stall; by
        default the tangent itself.
    round_off
        Norm of the forces that round-off may leave: equilibrium is not asked to be better.
    active
        Active set, which points are closed and which slide: the method may go on while it still finds new ones.
    measure
        Forces (N,) that unbalanced ones are compared with, where `force` is itself a difference that vanishes.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> from skfem_contact import Response
    >>> Response(np.zeros(2), lambda: None, lambda: csr_matrix(np.eye(2))).stiffness.shape
    (2, 2)
    """

    def __init__(self, force: ndarray, state: Callable[[], Any], stiffness: Callable[[], csr_matrix],
                 damped: Callable[[], csr_matrix] | None = None, round_off: float = 0.0, active: bytes = b"",
                 measure: ndarray | None = None) -> None:
        self.force, self.round_off, self.active = force, round_off, active
        self.measure = force if measure is None else measure
        self._state = state
        self._stiffness = stiffness
        self._damped = damped

    @cached_property
    def state(self) -> Any:
        """Candidate state; accepting a step is an assignment."""
        return self._state()

    @cached_property
    def stiffness(self) -> csr_matrix:
        """Tangent stiffness, a ``csr_matrix`` of shape (N, N)."""
        return self._stiffness()

    @cached_property
    def damped(self) -> csr_matrix:
        """The tangent, or a matrix near it with which Newton's method is less prone to stall."""
        return self.stiffness if self._damped is None else self._damped()

    def among(self, n: int) -> Response:
        """The answer among n unknowns, of which the form knows the first ones."""
        if len(self.force) == n:
            return self
        more = (0, n - len(self.force))
        return Response(np.pad(self.force, more), lambda: self.state, lambda: padded(self.stiffness, n),
                        lambda: padded(self.damped, n), self.round_off, self.active, np.pad(self.measure, more))


class Form:
    """Whatever carries load: solids, contact pairs, bars, and forms of a user's own.

    A form offers :meth:`assemble` and :meth:`initial_state`; whatever else an analysis asks has an answer here that
    fits a form between some unknowns: derive from this class, and give your own answer where another one fits better.

    Attributes
    ----------
    size
        Number of unknowns that it knows, the first ones of the analysis; None: however many there are.
    basis
        Basis of the elements that it gives stiffness to, where there are any.
    fields
        Layout that it brings besides displacements, see :class:`~skfem_contact.layout.Field`.
    carries
        Those of them that it has equations for; None: all.
    second_order
        Whether a step in time can be taken in two parts, see :meth:`extrapolated`.
    symmetric
        Whether its tangent is symmetric.
    unilateral
        Whether it opens, closes and slips: on the way to equilibrium the residual may then rise now and then.
    changing
        Layout at which its tangent may change while Newton's method iterates; None: anywhere.
    joins
        Layout that it couples to each other, -1 among them for a rigid obstacle; None: it may hold any of them.
    acts_on
        Layout that it acts on, all of which must be there; None: any of them.
    elastic_stiffness
        Stiffness (N, N) by which penalties are chosen and new bodies placed.
    nodes
        Layout, (n,), and the places that it takes these to have, (dim, n), where it knows any.
    axisymmetric
        Whether its forces are per radian about the axis x = 0.
    materials
        Materials by the name of their region.
    strengths
        Names of the parts whose strength can be reduced, ``""`` for the form as a whole.

    Examples
    --------
    A spring between an unknown and the ground:

    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> import skfem_contact as sc
    >>> class Spring(sc.Form):
    ...     def __init__(self, n, unknown, stiffness):
    ...         self.K = csr_matrix(([stiffness], ([unknown], [unknown])), shape=(n, n))
    ...     def initial_state(self, x=None):
    ...         return None
    ...     def assemble(self, x, state):
    ...         return sc.Response(self.K @ x, lambda: state, lambda: self.K)
    >>> result = sc.Model({"spring": Spring(1, 0, 20.)}).run([sc.Stage("pull", np.array([5.]))])
    >>> result["pull"].x
    array([0.25])
    """

    size: int | None = None
    basis: Any = None
    fields: tuple[Field, ...] = ()
    carries: ndarray | None = None
    second_order: bool = False
    symmetric: bool = False
    unilateral: bool = False
    changing: ndarray | None = None
    joins: ndarray | None = None
    acts_on: ndarray | None = None
    elastic_stiffness: Any = None
    nodes: tuple[ndarray, ndarray] | None = None
    axisymmetric: bool = False
    materials: Mapping[str, Any] = MappingProxyType({})
    strengths: tuple[str, ...] = ()

    # -- what every form offers ------------------------------------------------------------------------------

    def assemble(self, x: ndarray, state: Any) -> Response:
        """Answer to displacements from an accepted state."""
        raise NotImplementedError

    def initial_state(self, x: ndarray | None = None) -> Any:
        """State of unstrained bodies, or of those that become active when the displacements are x already."""
        raise NotImplementedError

    # -- before the analysis ---------------------------------------------------------------------------------

    @property
    def elements(self) -> ndarray:
        """Numbers of the elements in the mesh that it gives stiffness to, (n_elements,)."""
        return elements_of(self.basis)

    def completed(self, forms: Mapping[str, Form]) -> Form:
        """The form with what it takes from the others, such as a penalty from their stiffness."""
        return self

    def continues(self, old: Form) -> Form:
        """The form, complete, as it comes in the place of an old one, from whose state it goes on.

        Raises
        ------
        ValueError
            The state of the old one is none for it.
        """
        if type(self) is not type(old):
            raise ValueError(f"{type(old).__name__} cannot become {type(self).__name__}")
        return self

    def inherits(self, old: Form, state: Any) -> Any:
        """The state of an old form as this one goes on from it in its place."""
        return state

    def fits(self, state: Any) -> bool:
        """Whether a state may be one of this form: by default, whether its arrays have their initial shapes."""
        given, initial = arrays_of(state), arrays_of(self.initial_state())
        return {k: np.shape(a) for k, a in given.items()} == {k: np.shape(a) for k, a in initial.items()}

    def check_start(self, x: ndarray, state: Any) -> None:
        """Refuse to go on from a state of other settings, by a ``ValueError``."""

    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterable[Remark]:
        """Remarks on supports, what is not there, and time since the last change to a stage's end; or a ValueError."""
        return ()

    # -- in an increment -------------------------------------------------------------------------------------

    def over(self, duration: float) -> Form:
        """The form of a step in time; itself where time does not matter."""
        return self

    def extrapolated(self, before: Any, found: Any, ratio: float) -> Any:
        """State `ratio` times as far from one before as what was found, from which the second part of a step starts."""

    def time_error(self, middle: Any, after: Any) -> tuple[float, float]:
        """Error of a step from the states after its parts, over what is allowed, and what it is compared with."""
        return 0.0, 0.0

    def begin(self, accepted: Any, failure: Failure | None = None) -> Form:
        """An easier form to begin an increment with, whose family ends at this one; itself where it knows none.

        Parameters
        ----------
        accepted, failure
            The accepted state; how Newton's method failed, None before the first attempt.
        """
        return self

    def outer(self, x: ndarray, accepted: Any, found: Any) -> tuple[Form, Any] | None:
        """Form and accepted state with which the increment is to be solved once more, or None.

        Multipliers are improved here, and an easier form makes room for the next one of its family.

        Parameters
        ----------
        x, found
            Displacements and state of the equilibrium that was found.
        accepted
            The accepted state, at the start of the increment.
        """

    @property
    def reason(self) -> str:
        """Why there may be no equilibrium but of this easier form, for a message."""
        return ""

    # -- between stages --------------------------------------------------------------------------------------

    def replaces(self, old: Form) -> bool:
        """Whether it takes over the forces of an old form, in whose place it becomes active."""
        return False

    def tractions_at(self, x: ndarray, state: Any) -> Any | None:
        """How tractions at its points make nodal forces, where it can begin with given ones (see contact.prestress)."""

    def rebased(self, x: ndarray, state: Any) -> Any:
        """The state once displacements are counted from x on."""
        return state

    # -- in a search for a collapse --------------------------------------------------------------------------

    def reduced(self, factor: float, flow: str, names: Collection[str]) -> Form:
        """The form with some of its :attr:`strengths` divided by a factor, and with the flow that is assumed."""
        return self

    def fixed_geometry(self, x: ndarray, state: Any) -> tuple[Form, Any]:
        """The form with its geometry held as it is at some displacements, and its state: for contact, which follows."""
        return self, state

    def released(self, x: ndarray, state: Any) -> tuple[Form, Any]:
        """The form whose geometry is not held, and its state: the inverse of :meth:`fixed_geometry`."""
        return self, state

    def yielding(self, before: Any, after: Any) -> tuple[int, int]:
        """Number of points of solids that have flowed from one state to another, and of all of them."""
        return 0, 0

    def shear_strain(self, x: ndarray) -> ndarray | None:
        """Largest shear strain of displacements at the points of a solid, (n_elements, n_points)."""

    def pressure_at_nodes(self, x: ndarray) -> ndarray | None:
        """Pore pressure that it adds to the ground, at the nodes of the displacements, (N/dim,)."""

    # -- what it says ----------------------------------------------------------------------------------------

    def summary(self, state: Any) -> str:
        """One line for the table of a result."""
        return ""

    def remarks(self, x: ndarray, state: Any) -> Iterable[Remark]:
        """What a user should know of an accepted state, and of its displacements."""
        return ()


def as_forms(forms: Mapping[str, Any]) -> dict[str, Form]:
    """The forms of an analysis; those that do not derive from :class:`Form` get its answers to what they do not answer.

    Raises
    ------
    ValueError
        No dictionary, or a form that lacks what every form must offer; it is named.
    """
    if not isinstance(forms, Mapping):
        raise ValueError(f"forms must be a dictionary {{name: form}}, not {type(forms).__name__}")
    for name, form in forms.items():
        given = {call: getattr(form, call, None) for call in ("assemble", "initial_state")}
        missing = [name for name, call in given.items()
                   if not callable(call) or getattr(call, "__func__", None) is getattr(Form, name)]
        if missing or isinstance(form, type):
            raise ValueError(f"'{name}' is no form: {form!r} has no {' and no '.join(missing) or 'values'}; every form "
                             "has assemble(x, state) and initial_state()")
    return {name: form if isinstance(form, Form) else _Completed(form) for name, form in forms.items()}


class _Completed(Form):
    """A form that does not derive from :class:`Form`: what it does not answer has the answers from there."""

    def __init__(self, form: Any) -> None:
        self._form = form
        for name in dir(Form):
            if not name.startswith("_") and hasattr(form, name):
                setattr(self, name, getattr(form, name))

    def __repr__(self) -> str:
        return repr(self._form)


def solids_of(forms: Mapping[str, Form]) -> dict[str, Any]:
    """The forms that give stiffness to elements."""
    return {name: form for name, form in forms.items() if form.basis is not None}


def answers(forms: Mapping[str, Form], x: ndarray, states: Mapping[str, Any]) -> dict[str, Response]:
    """What the forms answer to all unknowns, of which each knows the first ones."""
    return {name: form.assemble(x[:form.size], states[name]).among(len(x)) for name, form in forms.items()}


def carried(forms: Mapping[str, Form], x: ndarray, states: Mapping[str, Any]) -> ndarray:
    """Sum of the internal forces of all forms, (N,)."""
    return sum((response.force for response in answers(forms, x, states).values()), start=np.zeros(len(x)))
