"""What carries load: the calls that solids, contact pairs and forms of a user answer."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

from numpy import ndarray
from scipy.sparse import csr_matrix


class IncrementTooLarge(RuntimeError):
    """What a form's ``outer`` raises where it cannot tell what happened during an increment: it must be cut.

    Examples
    --------
    >>> from skfem_contact.forms import IncrementTooLarge
    >>> issubclass(IncrementTooLarge, RuntimeError)
    True
    """


class Response:
    """What a form answers: the internal force and, when asked for, the candidate state and the tangent.

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

    Notes
    -----
    The functions are called at the first access of :attr:`state`, :attr:`stiffness` and :attr:`damped` only, so
    that a line search pays for the force alone.

    Examples
    --------
    >>> import numpy as np
    >>> from scipy.sparse import csr_matrix
    >>> from skfem_contact import Response
    >>> Response(np.zeros(2), lambda: None, lambda: csr_matrix(np.eye(2))).stiffness.shape
    (2, 2)
    """

    def __init__(self, force: ndarray, state: Callable[[], Any], stiffness: Callable[[], csr_matrix],
                 damped: Callable[[], csr_matrix] | None = None, round_off: float = 0.0) -> None:
        self.force, self.round_off = force, round_off
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


@dataclass(frozen=True)
class Failure:
    """How Newton's method failed, for a form that is asked for an easier one to begin with.

    Attributes
    ----------
    loose
        Whether bodies can move freely, or ran away.
    seen
        Candidate states of the form between which the iterations chatter, if any.
    """

    loose: bool
    seen: tuple[Any, ...] = ()


class Form(Protocol):
    """Whatever carries load: solids and contact pairs answer the same calls."""

    def initial_state(self, x: ndarray | None = None) -> Any:
        """State of unstrained bodies, or of those that become active when the displacements are x already."""

    def assemble(self, x: ndarray, state: Any) -> Response:
        """Answer to displacements from an accepted state."""

    def outer(self, x: ndarray, accepted: Any, found: Any) -> tuple[Form, Any] | None:
        """Form and accepted state with which the increment is to be solved once more, or None."""

    def summary(self, state: Any) -> str:
        """One line for the table of a result."""

    def remarks(self, state: Any) -> list[str]:
        """What a user should know of a state."""


def are_symmetric(forms: Mapping[str, Any]) -> bool:
    """Whether the tangents of all forms are symmetric: they say so by an attribute `symmetric`."""
    return all(getattr(form, "symmetric", False) for form in forms.values())
