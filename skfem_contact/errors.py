"""Errors, warnings and remarks, and checks of input."""
from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any, TypeVar

import numpy as np
from numpy import ndarray
from skfem import (
    CellBasis,
    ElementHex1,
    ElementHex2,
    ElementHexS2,
    ElementQuad1,
    ElementQuad2,
    ElementQuadS2,
    ElementTetP1,
    ElementTetP2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    Mesh,
)

T = TypeVar("T")
_SUPPORTED = (ElementTriP1, ElementTriP2, ElementQuad1, ElementQuad2, ElementQuadS2,
              ElementTetP1, ElementTetP2, ElementHex1, ElementHex2, ElementHexS2)
#: Strains of a point, rigid motions, and modes without strain that are allowed, by the number of dimensions.
_MODES = {2: (3, 3, 1), 3: (6, 6, 6)}


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


def is_number(value: Any, low: float, high: float) -> bool:
    """Whether a value is a number between two others, not one of them: no array, no truth value, no NaN.

    Examples
    --------
    >>> is_number(0.5, 0.0, 1.0), is_number("0.5", 0.0, 1.0), is_number(True, 0.0, 2.0)
    (True, False, False)
    """
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool) \
        and bool(low < value < high)


def finite(value: Any, what: str) -> ndarray:
    """Numbers as an array of floats, or a ``ValueError`` where some are masked, complex, not finite, or no numbers.

    Examples
    --------
    >>> finite([1, 2], "lengths")
    array([1., 2.])
    """
    try:
        numbers = np.asarray(value)
    except ValueError:
        numbers = np.asarray(None)  # a list of lists of different lengths
    if np.ma.isMaskedArray(value) or numbers.dtype.kind not in "iuf" or not np.isfinite(numbers).all():
        raise ValueError(f"{what} must be finite numbers, not {value!r}")
    return numbers.astype(float)


def check_size(x: ndarray, size: int) -> None:
    """Refuse displacements of another mesh."""
    if np.shape(x) != (size,):
        raise ValueError(f"there are {np.size(x)} displacements for {size} unknowns")


def look_up(name: str, existing: Mapping[str, T], kind: str) -> T:
    """The value of a name, or a ``ValueError`` that lists the names that exist."""
    if not isinstance(name, str) or name not in existing:
        listed = ", ".join(sorted(existing)) or "none at all"
        raise ValueError(f"there is no {kind} '{name}'; existing: {listed}")
    return existing[name]


def names_of(given: str | Iterable[str]) -> tuple[str, ...]:
    """One name, or several."""
    return (given,) if isinstance(given, str) else tuple(given)


def facets_of(mesh: Mesh, boundary: str) -> ndarray:
    """The facets of a named boundary, or a ``ValueError`` where there are none."""
    facets = np.asarray(look_up(boundary, mesh.boundaries or {}, "boundary"))
    if len(facets) == 0:
        raise ValueError(f"boundary '{boundary}' is empty")
    return facets


def place(x: ndarray) -> str:
    """Coordinates of a point, for a message."""
    return f"({', '.join(f'{value:.4g}' for value in x)})"


def check_basis(basis: CellBasis) -> None:
    """Refuse what the kernels do not support: only vector elements of order 1 and 2 are."""
    if not isinstance(basis, CellBasis):
        raise ValueError(f"a Basis of elements is needed, not {type(basis).__name__}")
    elem = basis.elem
    if not isinstance(elem, ElementVector) or type(elem.elem) not in _SUPPORTED or elem.dim != elem.elem.dim:
        names = ", ".join(f"ElementVector({cls.__name__}())" for cls in _SUPPORTED)
        name = type(elem).__name__
        if isinstance(elem, ElementVector):
            name = f"{name}({type(elem.elem).__name__}()) with {elem.dim} components"
        raise ValueError(f"unsupported element {name}; supported are {names}")


def check_plane(basis: CellBasis, what: str) -> None:
    """Refuse bodies in three dimensions where only plane ones are supported."""
    check_basis(basis)
    if basis.mesh.dim() != 2:
        raise ValueError(f"{what} is for plane bodies, but this is a {type(basis.mesh).__name__} in three dimensions")


def check_quadrature(basis: CellBasis) -> None:
    """Refuse rules with so few points that elements can deform without strain (hourglass modes).

    A point sees three strains, or six in space; an element has all but its rigid motions to strain.  The modes of the
    serendipity elements with 2 x 2 (x 2) points are allowed: they do not spread from element to element.
    """
    points = basis.X.shape[-1]
    strains, rigid, allowed = _MODES[basis.mesh.dim()]
    if strains * points < basis.Nbfun - rigid - allowed:
        raise ValueError(f"{points} integration points are too few for {type(basis.elem.elem).__name__}: it would "
                         f"deform without strain; pass a higher `intorder` to Basis")


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
