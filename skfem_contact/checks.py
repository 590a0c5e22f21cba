"""Checks of input: each returns the checked value, or raises a ValueError that names the argument."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any, TypeVar

import numpy as np
import skfem
from numpy import ndarray
from skfem import CellBasis, ElementVector, Mesh

T = TypeVar("T")
_SUPPORTED = (skfem.ElementTriP1, skfem.ElementTriP2, skfem.ElementQuad1, skfem.ElementQuad2, skfem.ElementQuadS2,
              skfem.ElementTetP1, skfem.ElementTetP2, skfem.ElementHex1, skfem.ElementHex2, skfem.ElementHexS2)
#: Strains of a point, rigid motions, and admissible modes without strain, by the number of dimensions.
_MODES = {2: (3, 3, 1), 3: (6, 6, 6)}


def is_number(value: Any, low: float = -np.inf, high: float = np.inf) -> bool:
    """Return True for a number between two others, both excluded: no array, no truth value, no NaN."""
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, (bool, np.bool_)) \
        and bool(low < value < high)


def number(value: Any, name: str, low: float = -np.inf, high: float = np.inf) -> float:
    """Return a finite number between two others, both excluded."""
    if not is_number(value, low, high):
        limits = [f" above {low:g}", f" below {high:g}"]
        kept = " and".join(text for text, limit in zip(limits, (low, high), strict=True) if np.isfinite(limit))
        raise ValueError(f"{name} must be a finite number{kept}, not {value!r}")
    return float(value)


def positive(value: Any, name: str) -> float:
    """Return a finite number above zero."""
    return number(value, name, 0.0)


def finite(value: Any, name: str) -> ndarray:
    """Return an array of floats: no masked, complex or infinite numbers."""
    try:
        numbers = np.asarray(value)
    except ValueError:
        numbers = np.asarray(None)  # a list of lists of different lengths
    if np.ma.isMaskedArray(value) or numbers.dtype.kind not in "iuf" or not np.isfinite(numbers).all():
        raise ValueError(f"{name} must be finite numbers, not {value!r}")
    return numbers.astype(float)


def vector(value: Any, size: int, name: str) -> ndarray:
    """Return a vector of finite numbers, (size,)."""
    numbers = finite(value, name)
    if numbers.shape != (size,):
        raise ValueError(f"{name} must have the shape ({size},), not {numbers.shape}")
    return numbers


def unit_vector(value: Any, dim: int, name: str) -> ndarray:
    """Return a direction, (dim,), scaled to the length one."""
    direction = vector(value, dim, name)
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        raise ValueError(f"{name} must not be zero in all components")
    return direction / length


def one_of(value: T, choices: Collection[T], name: str) -> T:
    """Return a value that is among the choices."""
    if not any(type(value) is type(choice) and value == choice for choice in choices):
        raise ValueError(f"{name} must be one of {', '.join(map(repr, choices))}, not {value!r}")
    return value


def dofs(value: Any, size: int, name: str) -> ndarray:
    """Return numbers of dofs, each once, in ascending order: whole numbers from 0 to size - 1."""
    numbers = np.atleast_1d(np.asarray(value))
    if numbers.size == 0:
        return np.zeros(0, int)
    if numbers.dtype.kind not in "iu" or numbers.min() < 0 or numbers.max() >= size:
        raise ValueError(f"{name} must be numbers of dofs from 0 to {size - 1}, not {value!r}")
    return np.unique(numbers)


def names(given: str | Iterable[str], existing: Collection[str], kind: str) -> tuple[str, ...]:
    """Return one or several names, all of which exist."""
    listed = names_of(given)
    for name in listed:
        look_up(name, dict.fromkeys(existing), kind)
    return listed


def names_of(given: str | Iterable[str]) -> tuple[str, ...]:
    """Return one name or several as a tuple."""
    return (given,) if isinstance(given, str) else tuple(given)


def look_up(name: str, existing: Mapping[str, T], kind: str) -> T:
    """Return the value of a name; the ValueError lists the existing names."""
    if not isinstance(name, str) or name not in existing:
        listed = ", ".join(sorted(existing)) or "none at all"
        raise ValueError(f"there is no {kind} '{name}'; existing: {listed}")
    return existing[name]


def check_size(x: ndarray, size: int) -> None:
    """Refuse displacements of another mesh."""
    if np.shape(x) != (size,):
        raise ValueError(f"there are {np.size(x)} displacements for {size} dofs")


def facets_of(mesh: Mesh, boundary: str) -> ndarray:
    """Return the facets of a named boundary, which must not be empty."""
    facets = np.asarray(look_up(boundary, mesh.boundaries or {}, "boundary"))
    if len(facets) == 0:
        raise ValueError(f"boundary '{boundary}' is empty")
    return facets


def place(x: ndarray) -> str:
    """Format the coordinates of a point for a message."""
    return f"({', '.join(f'{value:.4g}' for value in x)})"


def check_basis(basis: CellBasis) -> None:
    """Refuse all but vector elements of first and second order."""
    if not isinstance(basis, CellBasis):
        raise ValueError(f"a Basis of elements is needed, not {type(basis).__name__}")
    elem = basis.elem
    if not isinstance(elem, ElementVector) or type(elem.elem) not in _SUPPORTED or elem.dim != elem.elem.dim:
        names = ", ".join(f"ElementVector({cls.__name__}())" for cls in _SUPPORTED)
        name = type(elem).__name__
        if isinstance(elem, ElementVector):
            name = f"{name}({type(elem.elem).__name__}()) with {elem.dim} components"
        raise ValueError(f"unsupported element {name}; supported are {names}")


def check_plane(basis: CellBasis, name: str) -> None:
    """Refuse bodies in three dimensions where only plane ones are supported."""
    check_basis(basis)
    if basis.mesh.dim() != 2:
        raise ValueError(f"{name} is for plane bodies, but this is a {type(basis.mesh).__name__} in three dimensions")


def check_quadrature(basis: CellBasis) -> None:
    """Refuse rules with so few points that elements can deform without strain (hourglass modes).

    A point has three strains, or six in space, and an element must strain in all but its rigid motions.  The modes of
    serendipity elements with 2 x 2 (x 2) points are admitted: they do not spread from element to element.
    """
    points = basis.X.shape[-1]
    strains, rigid, allowed = _MODES[basis.mesh.dim()]
    if strains * points < basis.Nbfun - rigid - allowed:
        raise ValueError(f"{points} integration points are too few for {type(basis.elem.elem).__name__}: it would "
                         f"deform without strain; pass a higher `intorder` to Basis")
