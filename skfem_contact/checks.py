"""One clear error before the analysis starts."""
from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from skfem import (
    CellBasis,
    ElementQuad1,
    ElementQuad2,
    ElementQuadS2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
)

T = TypeVar("T")
_SUPPORTED = (ElementTriP1, ElementTriP2, ElementQuad1, ElementQuad2, ElementQuadS2)


class AnalysisWarning(UserWarning):
    """Something that was done but should be looked at."""


def look_up(name: str, existing: Mapping[str, T], kind: str) -> T:
    """The value of a name, or a ``ValueError`` that lists the names that exist."""
    if name not in existing:
        listed = ", ".join(sorted(existing)) or "none at all"
        raise ValueError(f"there is no {kind} '{name}'; existing: {listed}")
    return existing[name]


def check_basis(basis: CellBasis) -> None:
    """Refuse what the kernels do not support: only plane vector elements of order 1 and 2 are."""
    if not isinstance(basis, CellBasis):
        raise ValueError(f"a Basis of elements is needed, not {type(basis).__name__}")
    elem = basis.elem
    if not isinstance(elem, ElementVector) or elem.dim != 2 or type(elem.elem) not in _SUPPORTED:
        names = ", ".join(f"ElementVector({cls.__name__}())" for cls in _SUPPORTED)
        name = type(elem).__name__
        if isinstance(elem, ElementVector):
            name = f"{name}({type(elem.elem).__name__}()) with {elem.dim} components"
        raise ValueError(f"unsupported element {name}; supported are {names}")


def check_quadrature(basis: CellBasis) -> None:
    """Refuse rules with so few points that elements can deform without strain (hourglass modes).

    A point sees three strains; an element has all but three of its unknowns to strain.  One mode more is allowed:
    that of the serendipity element with 2 x 2 points does not spread from element to element.
    """
    points = basis.X.shape[-1]
    if 3 * points < basis.Nbfun - 4:
        raise ValueError(f"{points} integration points are too few for {type(basis.elem.elem).__name__}: it would "
                         f"deform without strain; pass a higher `intorder` to Basis")
