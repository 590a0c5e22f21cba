"""Checks of input: each returns the checked value, or raises a ValueError that names the
argument.
"""

from __future__ import annotations

import functools
import inspect
import sys
from collections import ChainMap
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import cycle
from types import FunctionType, NoneType, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    NamedTuple,
    NoReturn,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np
import skfem
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis, ElementVector, Mesh

T = TypeVar("T")
_NUMBERS = (int, float, np.integer, np.floating)
_SUPPORTED = (
    skfem.ElementTriP1,
    skfem.ElementTriP2,
    skfem.ElementQuad1,
    skfem.ElementQuad2,
    skfem.ElementQuadS2,
    skfem.ElementTetP1,
    skfem.ElementTetP2,
    skfem.ElementHex1,
    skfem.ElementHex2,
    skfem.ElementHexS2,
)
#: Strains of a point, rigid motions, and admissible modes without strain, by the number of
#: dimensions.
_MODES = {2: (3, 3, 1), 3: (6, 6, 6)}


def is_number(value: Any, low: float = -np.inf, high: float = np.inf) -> bool:
    """Return True for a number between two others, both excluded: no array, no truth value, no
    NaN.
    """
    return (
        isinstance(value, _NUMBERS)
        and not isinstance(value, bool | np.bool_)
        and bool(low < value < high)
    )


def number(value: Any, name: str, low: float = -np.inf, high: float = np.inf) -> float:
    """Return a finite number between two others, both excluded."""
    if not is_number(value, low, high):
        limits = [f" above {low:g}", f" below {high:g}"]
        kept = " and".join(
            text for text, limit in zip(limits, (low, high), strict=True) if np.isfinite(limit)
        )
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
    if (
        np.ma.isMaskedArray(value)
        or numbers.dtype.kind not in "iuf"
        or not np.isfinite(numbers).all()
    ):
        raise ValueError(f"{name} must be finite numbers, not {value!r}")
    return numbers.astype(float)


def vector(value: Any, size: int, name: str) -> ndarray:
    """Return a vector of finite numbers, (size,)."""
    numbers = finite(value, name)
    if numbers.shape != (size,):
        raise ValueError(f"{name} must have the shape ({size},), not {numbers.shape}")
    return numbers


def unit_vector(value: Any, size: int, name: str) -> ndarray:
    """Return a direction, (size,); a ``ValueError`` for vectors of another length than 1."""
    found = np.asarray(value, dtype=float)
    if found.shape != (size,) or not np.isclose(np.linalg.norm(found), 1.0, rtol=0.0, atol=1e-6):
        raise ValueError(f"{name} must be a unit vector with {size} components, not {value!r}")
    return found


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


def format_point(x: ndarray) -> str:
    """Format the coordinates of a point for a message."""
    return f"({', '.join(f'{value:.4g}' for value in x)})"


def check_basis(basis: CellBasis) -> None:
    """Refuse all but vector elements of first and second order."""
    if not isinstance(basis, CellBasis):
        raise ValueError(f"basis must be a CellBasis, not {type(basis).__name__}")
    elem = basis.elem
    if (
        not isinstance(elem, ElementVector)
        or type(elem.elem) not in _SUPPORTED
        or elem.dim != elem.elem.dim
    ):
        names = ", ".join(f"ElementVector({cls.__name__}())" for cls in _SUPPORTED)
        name = type(elem).__name__
        if isinstance(elem, ElementVector):
            name = f"{name}({type(elem.elem).__name__}()) with {elem.dim} components"
        raise ValueError(f"unsupported element {name}; supported are {names}")


def check_plane(basis: CellBasis, name: str) -> None:
    """Refuse bodies in three dimensions where only plane ones are supported."""
    check_basis(basis)
    if basis.mesh.dim() != 2:
        raise ValueError(
            f"{name} is for plane bodies, but this is a {type(basis.mesh).__name__} in three "
            f"dimensions"
        )


def check_quadrature(basis: CellBasis) -> None:
    """Refuse rules with so few points that elements can deform without strain (hourglass modes).

    A point has three strains, or six in space, and an element must strain in all but its rigid
    motions.  The modes of serendipity elements with 2 x 2 (x 2) points are admitted: they do not
    spread from element to element.
    """
    points = basis.X.shape[-1]
    strains, rigid, allowed = _MODES[basis.mesh.dim()]
    if strains * points < basis.Nbfun - rigid - allowed:
        raise ValueError(
            f"{points} integration points are too few for {type(basis.elem.elem).__name__}: it "
            f"would "
            f"deform without strain; pass a higher `intorder` to Basis"
        )


class Kind(NamedTuple):
    """Kind of values that an annotation allows: its name in messages, and a test."""

    name: str
    holds: Callable[[Any], bool]


def _are_numbers(value: Any) -> bool:
    try:
        return finite(value, "").dtype.kind == "f"
    except ValueError:
        return False


def _is_array(value: Any) -> bool:  # an array may hold NaN for what is not known
    return (
        value.dtype.kind in "biuf"
        if isinstance(value, ndarray)
        else isinstance(value, list) and _are_numbers(value)
    )


#: Base classes of a user's own objects, which need not derive from them.
_OWN = ("Form", "InterfaceLaw", "Material")
_KINDS = {
    Any: Kind("any value", lambda value: True),
    object: Kind("any value", lambda value: True),
    NoneType: Kind("None", lambda value: value is None),
    bool: Kind("True or False", lambda value: isinstance(value, bool | np.bool_)),
    int: Kind(
        "a whole number",
        lambda value: isinstance(value, int | np.integer) and not isinstance(value, bool),
    ),
    float: Kind("a finite number", is_number),
    str: Kind("a string", lambda value: isinstance(value, str)),
    ndarray: Kind("an array of real numbers", _is_array),
    Callable: Kind("a function", lambda value: callable(value) and not isinstance(value, type)),
}


#: Kind of numbers whose default is infinite.
_INFINITE = Kind(
    "a number", lambda value: is_number(value) or (isinstance(value, float) and value == np.inf)
)


def kind_of(hint: Any) -> Kind:
    """Return the kind of values that an annotation allows."""
    origin, inner = get_origin(hint), get_args(hint)
    numeric = all(one in inner for one in get_args(ArrayLike))
    if hint in _KINDS or origin in _KINDS:
        return _KINDS[hint if hint in _KINDS else origin]
    if origin is Annotated:  # types of what is given, where the attribute has others
        return kind_of(inner[1])
    if origin is Literal:
        return Kind(
            f"one of {', '.join(map(repr, inner))}",
            lambda value: any(type(value) is type(one) and value == one for one in inner),
        )
    if origin in (Union, UnionType):
        kinds = [Kind("finite numbers", _are_numbers)] * numeric
        kinds += [
            kind_of(one) for one in inner if not numeric or one not in (float, *get_args(ArrayLike))
        ]
        return Kind(
            " or ".join(dict.fromkeys(kind.name for kind in kinds)),
            _any_of([kind.holds for kind in kinds]),
        )
    if isinstance(origin, type) and issubclass(origin, Mapping):
        item = kind_of(inner[1])
        each = "" if item is _KINDS[Any] else f", each {item.name}"
        return Kind(
            f"a dictionary of names{each}",
            lambda value: isinstance(value, Mapping) and all(map(item.holds, value.values())),
        )
    if isinstance(origin, type) and issubclass(origin, Iterable):
        return _sequence(origin, inner)
    cls = origin or hint
    if not isinstance(cls, type) or cls.__name__ in _OWN:
        return _KINDS[Any]
    name = f"a{'n' * (cls.__name__[0] in 'AEIOU')} {cls.__name__}"
    if getattr(cls, "_is_protocol", False) and cls.__module__ != "os":
        calls = [call for call in vars(cls) if call[0] != "_"]
        return Kind(
            name,
            lambda value: (
                not isinstance(value, type) and all(hasattr(value, call) for call in calls)
            ),
        )
    return Kind(name, lambda value: isinstance(value, cls))


def _any_of(tests: list[Callable[[Any], bool]]) -> Callable[[Any], bool]:
    """Return the test that holds where one of several does; the loop is faster than `any`."""

    def holds(value: Any) -> bool:
        for test in tests:  # noqa: SIM110
            if test(value):
                return True
        return False

    return holds


def _sequence(origin: type, inner: tuple[Any, ...]) -> Kind:
    """Return the kind of several values: in an order unless a collection will do, a tuple of a
    known length.
    """
    items = [kind_of(one) for one in inner if one is not ...]
    kept = Sequence if issubclass(origin, Sequence) else Collection
    several = len(items) if origin is tuple and ... not in inner else None

    def holds(value: Any) -> bool:
        listed = value.ndim > 0 if isinstance(value, ndarray) else isinstance(value, kept)
        return (
            listed
            and not isinstance(value, str | bytes)
            and several in (None, len(value))
            and all(
                item.holds(one)
                for item, one in zip(items if several else cycle(items), value, strict=False)
            )
        )

    return Kind(
        f"{several or 'several'} values, each {' and '.join(dict.fromkeys(i.name for i in items))}",
        holds,
    )


@functools.cache
def _kinds(function: Any, owner: type | None) -> tuple[list[tuple[str, Kind]], dict[str, Kind]]:
    """Return the positional parameters of a function in their order, and all by name, with their
    kinds.
    """
    modules = [
        vars(sys.modules[base.__module__]) for base in getattr(owner, "__mro__", ())
    ]  # of inherited fields
    hints, kinds = (
        get_type_hints(function, localns=ChainMap({"Self": Any}, *modules), include_extras=True),
        {},
    )
    given = {
        k: p
        for k, p in inspect.signature(function).parameters.items()
        if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
    }
    for name in hints.keys() & given:
        infinite = isinstance(default := given[name].default, float) and np.isinf(default)
        kinds[name] = _INFINITE if infinite else kind_of(hints[name])
    return [
        (k, kinds.get(k, _KINDS[Any])) for k, p in given.items() if p.kind != p.KEYWORD_ONLY
    ], kinds


def _check_arguments(
    function: Any, owner: type | None, args: tuple[Any, ...], named: dict[str, Any]
) -> None:
    """Refuse arguments that the annotations of a function do not allow."""
    in_order, kinds = _kinds(function, owner)
    for (name, kind), value in zip(in_order, args, strict=False):
        if not kind.holds(value):
            _refuse(name, kind, value)
    for name, value in named.items():
        if name in kinds and not kinds[name].holds(value):
            _refuse(name, kinds[name], value)


def _refuse(name: str, kind: Kind, value: Any) -> NoReturn:
    """Raise the error of a value of another kind."""
    text = repr(value)
    shown = text if len(text) < 80 and "\n" not in text else type(value).__name__
    raise ValueError(f"{name} must be {kind.name}, not {shown}")


@functools.cache
def _checked(function: Any, owner: type | None = None) -> Any:
    """Return a function that checks its arguments first."""
    check = _check_arguments

    def checked(*args: Any, **named: Any) -> Any:
        check(function, owner, args, named)
        return function(*args, **named)

    # doctest finds functions by their globals
    own = FunctionType(
        checked.__code__, function.__globals__, function.__name__, None, checked.__closure__
    )
    return functools.update_wrapper(own, function)


def guard(*modules: str) -> None:
    """Check the arguments of all that modules export, functions and methods, against their
    annotations.
    """
    for module in map(sys.modules.__getitem__, modules):
        for name in module.__all__:
            public = getattr(module, name)
            if isinstance(public, FunctionType):
                function = inspect.unwrap(public)
                for owner in (module, sys.modules[function.__module__]):
                    setattr(owner, name, _checked(function))
            elif isinstance(public, type) and name not in _OWN:
                _guard_methods(public)


def _guard_methods(public: type) -> None:
    """Check the arguments of constructors and methods; overrides are called by the package
    itself.
    """
    for name, member in list(vars(public).items()):
        function = getattr(member, "__func__", member)
        if (
            (name[0] != "_" or name in ("__init__", "__getitem__"))
            and isinstance(function, FunctionType)
            and not hasattr(function, "__wrapped__")
            and not getattr(function, "__override__", False)
        ):
            new = _checked(function, public)
            setattr(public, name, new if member is function else type(member)(new))
    for base in public.__bases__:
        if (
            base.__module__.partition(".")[0] == __name__.partition(".")[0]
            and base.__name__ not in _OWN
        ):
            _guard_methods(base)
