"""Errors, warnings and remarks, and checks of input."""
from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

from numpy import ndarray


class AnalysisWarning(UserWarning):
    """Something that was done but should be looked at."""


class NotConverged(RuntimeError):
    """Newton's method found no equilibrium; whether there is one remains open.

    Attributes
    ----------
    result
        The stages and increments that were accepted before, as far as they came.
    x
        The displacements that were reached, (N,).
    residuals
        History of the residual.
    dof
        Dof of the largest unbalanced force, or the first one that can move freely.
    """

    result: Any = None

    def __init__(self, message: str, x: ndarray | None = None, residuals: Sequence[float] = (),
                 dof: int | None = None) -> None:
        super().__init__(message)
        self.x, self.residuals, self.dof = x, tuple(residuals), dof


class NoEquilibrium(NotConverged):
    """The bodies collapse under this load: they move on and on, and the load does more work than they resist.

    With associated flow the residual is the gradient of a convex potential.  A line search along this energy
    finds its minimum if there is one; where there is none, which is what collapse means, it runs away along the
    mechanism.  A hundred times the elastic displacements are taken for that.  With friction and
    non-associated flow there is no potential, but the mechanism is found in the same way.
    """


@dataclass(frozen=True)
class Failure:
    """How Newton's method failed, for a form that is asked for an easier one to begin with.

    Attributes
    ----------
    loose
        Whether bodies can move freely, or ran away.
    seen
        Candidate states of the form between which the iterations chatter, if any.

    Examples
    --------
    Contact of which nothing is closed yet answers with soft springs, see :meth:`Form.begin`:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> floor = sc.rigid.line((-1., -.1), (2., -.1))
    >>> pair = sc.ContactPair(basis, "bottom", floor, sc.Coulomb(), penalty=1e4)
    >>> eased = pair.begin(pair.initial_state(), Failure(loose=True))
    >>> bool(eased.assemble(basis.zeros(), pair.initial_state()).force.any())
    True
    """

    loose: bool
    seen: tuple[Any, ...] = ()


class IncrementTooLarge(RuntimeError):
    """What a form's ``outer`` raises where it cannot tell what happened during an increment: it must be cut."""


@dataclass(frozen=True)
class Remark:
    """What a user should know of an accepted state: of each kind a run gives one remark, that of the largest figure."""

    kind: str
    figure: float
    text: str


class Remarks:
    """Collects remarks on stages, and warns of them when the run ends, even if it fails.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as caught, Remarks(stacklevel=2) as remarks:
    ...     for stage, share in (("dig", 2), ("load", 30), ("unload", 4)):
    ...         remarks.add(stage, "joint", [Remark("penetration", share, f"the slave penetrates by {share} %")])
    >>> [str(warning.message) for warning in caught]
    ["stage 'load', joint: the slave penetrates by 30 %"]
    """

    def __init__(self, stacklevel: int) -> None:
        self._stacklevel = stacklevel + 1
        self._worst: dict[tuple[str, str], tuple[float, str]] = {}

    def add(self, stage: str, form: str, remarks: Iterable[Remark]) -> None:
        """Remarks of a form on a stage."""
        for remark in remarks:
            kind = form, remark.kind
            if kind not in self._worst or remark.figure > self._worst[kind][0]:
                self._worst[kind] = remark.figure, f"stage '{stage}', {form}: {remark.text}"

    def __enter__(self) -> Remarks:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
                 ) -> None:
        for _, text in self._worst.values():
            warnings.warn(text, AnalysisWarning, stacklevel=self._stacklevel)
