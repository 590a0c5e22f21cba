"""Checks of input: each returns the checked value, or raises an error that names the argument."""

from __future__ import annotations

import difflib
import functools
import inspect
import sys
from collections import ChainMap
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import cycle
from threading import local
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
from skfem.quadrature import get_quadrature

T = TypeVar("T")
#: Likeness of names, of 1, from which a message suggests one: "lft" and "left" have .86, "fill"
#: and "hill" .75, "clay" and "sand" .25.
_ALIKE = 0.7
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
    """Return True for a number between two others: no array, no truth value, no NaN."""
    if not isinstance(value, _NUMBERS) or isinstance(value, bool | np.bool_):
        return False
    return bool(low < value < high)


def number(value: Any, name: str, low: float = -np.inf, high: float = np.inf) -> float:
    """Return a finite number between two others, both excluded."""
    if not is_number(value, low, high):
        limits = []
        if np.isfinite(low):
            limits.append(f" above {low:g}")
        if np.isfinite(high):
            limits.append(f" below {high:g}")
        raise ValueError(f"{name} must be a finite number{' and'.join(limits)}, not {value!r}")
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
    real = numbers.dtype.kind in "iuf" and not np.ma.isMaskedArray(value)
    if not real or not np.isfinite(numbers).all():
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
    direction = np.asarray(value, dtype=float)
    length = np.linalg.norm(direction)
    if direction.shape != (size,) or not np.isclose(length, 1.0, rtol=0.0, atol=1e-6):
        raise ValueError(f"{name} must be a unit vector with {size} components, not {value!r}")
    return direction


def check_upright(gravity: Sequence[float] | ndarray, what: str, otherwise: str = "") -> None:
    """Refuse what needs gravity against the last axis where it acts otherwise."""
    if gravity[-1] != -1.0:
        raise ValueError(
            f"{what} gravity against the last axis, not {np.asarray(gravity).tolist()}: rotate the "
            f"mesh{otherwise}"
        )


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
    if isinstance(given, str):
        return (given,)
    return tuple(given)


def look_up(name: str, existing: Mapping[str, T], kind: str) -> T:
    """Return the value of a name; the ValueError lists the existing names."""
    if not isinstance(name, str) or name not in existing:
        listed = ", ".join(sorted(existing)) or "none at all"
        raise ValueError(
            f"there is no {kind} '{name}'; existing: {listed}{nearest(name, existing)}"
        )
    return existing[name]


def one_line(error: BaseException) -> str:
    """Return the text of an error of another package in one line, or its class without a text."""
    return " ".join(str(error).split()) or type(error).__name__


def tags_with(some: ArrayLike, tags: Mapping[str, ndarray] | None) -> list[str]:
    """Return the names of the tags that hold some of the elements or facets, for a message."""
    return [name for name, part in (tags or {}).items() if np.isin(part, some).any()]


def nearest(name: Any, existing: Iterable[str]) -> str:
    """Return the existing names like a wrong one, for a message; empty if none is."""
    if not isinstance(name, str):
        return ""
    folded: dict[str, str] = {}
    for one in existing:
        if isinstance(one, str):
            folded.setdefault(one.lower(), one)
    found = difflib.get_close_matches(name.lower(), folded, n=2, cutoff=_ALIKE)
    names = " or ".join(f"'{folded[one]}'" for one in found)
    if names:
        return f"; did you mean {names}?"
    return ""


def check_size(x: ndarray, size: int) -> None:
    """Refuse displacements of another mesh."""
    if np.shape(x) != (size,):
        raise ValueError(f"there are {np.size(x)} displacements for {size} dofs")


def check_no_mask(numbers: ArrayLike, what: str) -> None:
    """Refuse a mask where numbers of facets or elements are expected."""
    if np.asarray(numbers).dtype == bool:
        raise ValueError(f"{what} is a mask: give numbers, np.flatnonzero(mask)")


def facets_of(mesh: Mesh, boundary: str) -> ndarray:
    """Return the facets of a named boundary: at least one, and each of them once."""
    given = look_up(boundary, mesh.boundaries or {}, "boundary")
    facets = np.asarray(given)
    if len(facets) == 0:
        raise ValueError(f"boundary '{boundary}' is empty")
    check_no_mask(facets, f"boundary '{boundary}'")
    # The two sides of an inner facet are different.
    sides = 2 * facets + getattr(given, "ori", 0)
    twice = len(facets) - len(np.unique(sides))
    if twice:
        raise ValueError(
            f"boundary '{boundary}' names {twice} facets more than once, where loads and contact "
            "would count double: name them once, np.unique(facets)"
        )
    return facets


def format_point(x: ndarray) -> str:
    """Format the coordinates of a point for a message."""
    return f"({', '.join(f'{value:.4g}' for value in x)})"


def check_basis(basis: CellBasis) -> None:
    """Refuse all but vector elements of first and second order."""
    if not isinstance(basis, CellBasis):
        raise ValueError(f"basis must be a CellBasis, not {type(basis).__name__}")
    elem = basis.elem
    name = type(elem).__name__
    if isinstance(elem, ElementVector):
        if type(elem.elem) in _SUPPORTED and elem.dim == elem.elem.dim:
            return
        name = f"{name}({type(elem.elem).__name__}()) with {elem.dim} components"
    supported = ", ".join(f"ElementVector({cls.__name__}())" for cls in _SUPPORTED)
    raise ValueError(f"unsupported element {name}; supported are {supported}")


def check_plane(basis: CellBasis, name: str) -> None:
    """Refuse bodies in three dimensions where only plane ones are supported."""
    check_basis(basis)
    if basis.mesh.dim() != 2:
        raise ValueError(
            f"{name} is for plane bodies, but this is a {type(basis.mesh).__name__} in three "
            "dimensions"
        )


def check_quadrature(basis: CellBasis) -> None:
    """Refuse rules with so few points that elements can deform without strain (hourglass modes).

    A point has three strains, or six in space, and an element must strain in all but its rigid
    motions.  The modes of serendipity elements with 2 x 2 (x 2) points are admitted: they do not
    spread from element to element.
    """
    points = basis.X.shape[-1]
    if _holds(basis, points):
        return
    order = 1
    while not _holds(basis, len(get_quadrature(basis.elem.refdom, order)[1])):
        order += 1
    raise ValueError(
        f"{points} integration points are too few for {type(basis.elem.elem).__name__}: it "
        f"would deform without strain; pass a higher `intorder` to Basis, at least {order}"
    )


def _holds(basis: CellBasis, points: int) -> bool:
    """Return True if a number of integration points leaves no element without stiffness."""
    strains, rigid, allowed = _MODES[basis.mesh.dim()]
    return strains * points >= basis.Nbfun - rigid - allowed


def positive_order(basis: CellBasis) -> int:
    """Return the least order of quadrature with enough points, all of positive weights."""
    order = 1
    while True:
        order += 1
        weights = get_quadrature(basis.elem.refdom, order)[1]
        if _holds(basis, len(weights)) and weights.min() > 0.0:
            return order


class Kind(NamedTuple):
    """Kind of values that an annotation allows: its name in messages, and a test."""

    name: str
    holds: Callable[[Any], bool]


def _are_numbers(value: Any) -> bool:
    """Return True for finite numbers."""
    try:
        finite(value, "")
    except ValueError:
        return False
    return True


def _is_array(value: Any) -> bool:
    """Return True for an array, which may hold NaN for unknown values, or a list of numbers."""
    if isinstance(value, ndarray):
        return value.dtype.kind in "biuf"
    return isinstance(value, list) and _are_numbers(value)


def _is_whole(value: Any) -> bool:
    """Return True for a whole number."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def _is_number_or_infinite(value: Any) -> bool:
    """Return True for a finite number, or a float that is infinite."""
    return is_number(value) or (isinstance(value, float) and value == np.inf)


def _instance_of(*classes: type) -> Callable[[Any], bool]:
    """Return the test for objects of some classes."""
    return lambda value: isinstance(value, classes)


#: Base classes of a user's own objects, which need not derive from them.
_OWN = ("Form", "InterfaceLaw", "Material")
_KINDS = {
    Any: Kind("any value", lambda value: True),
    object: Kind("any value", lambda value: True),
    NoneType: Kind("None", lambda value: value is None),
    bool: Kind("True or False", _instance_of(bool, np.bool_)),
    int: Kind("a whole number", _is_whole),
    float: Kind("a finite number", is_number),
    str: Kind("a string", _instance_of(str)),
    ndarray: Kind("an array of real numbers", _is_array),
    ArrayLike: Kind("finite numbers", _are_numbers),
    Callable: Kind("a function", lambda value: callable(value) and not isinstance(value, type)),
}
#: Kind of numbers whose default is infinite.
_INFINITE = Kind("a number", _is_number_or_infinite)


def kind_of(hint: Any) -> Kind:
    """Return the kind of values that an annotation allows."""
    if isinstance(hint, TypeVar):
        hint = hint.__bound__ or Any
    origin = get_origin(hint)
    inner = get_args(hint)
    known = _KINDS.get(hint) or _KINDS.get(origin)
    if known:
        return known
    alias = origin or hint
    if hasattr(alias, "__value__"):  # such as ``NDArray`` from numpy 2.5 on
        return kind_of(alias.__value__)
    if origin is Annotated:
        return kind_of(inner[1])  # types of the argument, where the attribute has others
    if origin is Literal:
        return _literal(inner)
    if origin in (Union, UnionType):
        return _union(inner)
    if not inner:
        return _class(hint)
    return _container(origin, inner)


def _literal(words: tuple[Any, ...]) -> Kind:
    """Return the kind of some words."""

    def holds(value: Any) -> bool:
        return any(type(value) is type(word) and value == word for word in words)

    return Kind(f"one of {', '.join(map(repr, words))}", holds)


def _union(hints: tuple[Any, ...]) -> Kind:
    """Return the kind of a union; numbers among ``ArrayLike`` need no mention."""
    # Before numpy 2.5 ``ArrayLike`` is a union, whose types are among the others.
    array_like = get_args(ArrayLike) or (ArrayLike,)
    if all(hint in hints for hint in array_like):
        others = [hint for hint in hints if hint not in (float, *array_like)]
        hints = (ArrayLike, *others)
    kinds = list(map(kind_of, hints))
    tests = [kind.holds for kind in kinds]

    def holds(value: Any) -> bool:
        for test in tests:  # noqa: SIM110, faster than `any`
            if test(value):
                return True
        return False

    return Kind(" or ".join(_distinct(kinds)), holds)


def _container(origin: type, inner: tuple[Any, ...]) -> Kind:
    """Return the kind of a dictionary, of several values, or of another class with parameters."""
    if issubclass(origin, Mapping):
        return _mapping(kind_of(inner[1]))
    if issubclass(origin, Iterable):
        return _sequence(origin, inner)
    return _class(origin)


def _mapping(item: Kind) -> Kind:
    """Return the kind of dictionaries with values of a kind."""

    def holds(value: Any) -> bool:
        return isinstance(value, Mapping) and all(map(item.holds, value.values()))

    each = "" if item is _KINDS[Any] else f", each {item.name}"
    return Kind(f"a dictionary of names{each}", holds)


def _class(cls: Any) -> Kind:
    """Return the kind of the objects of a class, or with the methods of a protocol."""
    if not isinstance(cls, type) or cls.__name__ in _OWN:
        return _KINDS[Any]
    article = "a"
    if cls.__name__[0] in "AEIOU":
        article = "an"
    name = f"{article} {cls.__name__}"
    if cls.__module__ == "os" or not getattr(cls, "_is_protocol", False):
        return Kind(name, _instance_of(cls))
    calls = [call for call in vars(cls) if call[0] != "_"]
    if cls.__name__[0] == "_":  # no user knows its name
        name = f"an object with {' and '.join(calls)}"

    def holds(value: Any) -> bool:
        return not isinstance(value, type) and all(hasattr(value, call) for call in calls)

    return Kind(name, holds)


def _distinct(kinds: Iterable[Kind]) -> list[str]:
    """Return the different names of kinds, in their order."""
    return list(dict.fromkeys(kind.name for kind in kinds))


def _sequence(origin: type, inner: tuple[Any, ...]) -> Kind:
    """Return the kind of several values: an order, any collection, or a tuple of a known length."""
    items = [kind_of(hint) for hint in inner if hint is not ...]
    container = Collection
    if issubclass(origin, Sequence):
        container = Sequence
    length = None
    if origin is tuple and ... not in inner:
        length = len(items)

    def holds(value: Any) -> bool:
        if not _is_several(value, container) or length not in (None, len(value)):
            return False
        kinds = items if length else cycle(items)
        return all(kind.holds(item) for kind, item in zip(kinds, value, strict=False))

    return Kind(f"{length or 'several'} values, each {' and '.join(_distinct(items))}", holds)


def _is_several(value: Any, container: Any) -> bool:
    """Return True for a container or an array of values, but no text."""
    if isinstance(value, ndarray):
        return value.ndim > 0
    return isinstance(value, container) and not isinstance(value, str | bytes)


@functools.cache
def _kinds(
    function: Any, owner: type | None
) -> tuple[list[tuple[str, Kind]], dict[str, Kind], tuple[str, ...] | None]:
    """Return the kinds of positional parameters in their order, and of all parameters by name.

    The third value has the names that a call may use, None for any.
    """
    # inherited fields have their types in the modules of the base classes
    bases = getattr(owner, "__mro__", ())
    modules = [vars(sys.modules[base.__module__]) for base in bases]
    names = ChainMap({"Self": Any}, *modules)
    hints = get_type_hints(function, localns=names, include_extras=True)
    in_order = []
    by_name = {}
    allowed: tuple[str, ...] | None = ()
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind == parameter.VAR_KEYWORD:
            allowed = None
        elif allowed is not None and parameter.kind in (
            parameter.KEYWORD_ONLY,
            parameter.POSITIONAL_OR_KEYWORD,
        ):
            allowed = (*allowed, name)
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            continue
        kind = _KINDS[Any]
        if name in hints:
            default = parameter.default
            infinite = isinstance(default, float) and np.isinf(default)
            kind = by_name[name] = _INFINITE if infinite else kind_of(hints[name])
        if parameter.kind != parameter.KEYWORD_ONLY:
            in_order.append((name, kind))
    return in_order, by_name, allowed


def _check_arguments(
    function: Any,
    owner: type | None,
    args: tuple[Any, ...],
    named: dict[str, Any],
) -> None:
    """Refuse arguments that the annotations of a function do not allow."""
    in_order, kinds, allowed = _kinds(function, owner)
    for (name, kind), value in zip(in_order, args, strict=False):
        if not kind.holds(value):
            _refuse(name, kind, value)
    for name, value in named.items():
        if allowed is not None and name not in allowed:
            listed = ", ".join(one for one in allowed if one != "self")
            raise TypeError(
                f"{function.__qualname__}() got an unexpected keyword argument '{name}'"
                f"; its arguments are {listed}{nearest(name, allowed)}"
            )
        if name in kinds and not kinds[name].holds(value):
            _refuse(name, kinds[name], value)


def _refuse(name: str, kind: Kind, value: Any) -> NoReturn:
    """Raise the error of a value of another kind."""
    text = repr(value)
    if len(text) < 80 and "\n" not in text:
        shown = text
    else:
        shown = type(value).__name__
    raise ValueError(f"{name} must be {kind.name}, not {shown}")


class _Calls(local):
    """Calls of this thread, whose arguments are trusted while iterations make them."""

    trusted = False


_calls = _Calls()


@contextmanager
def trusted_calls(trust: bool = True) -> Iterator[None]:
    """Trust the arguments of calls within the block, without checks.

    Iterations evaluate the same forms again and again, whose first evaluation was checked.
    """
    before = _calls.trusted
    _calls.trusted = before or trust
    try:
        yield
    finally:
        _calls.trusted = before


@functools.cache
def _checked(function: Any, owner: type | None = None) -> Any:
    """Return a function that checks its arguments first."""
    check = _check_arguments

    calls = _calls

    def checked(*args: Any, **named: Any) -> Any:
        if not calls.trusted:
            check(function, owner, args, named)
        return function(*args, **named)

    # doctest finds functions by their globals
    code = checked.__code__
    own = FunctionType(code, function.__globals__, function.__name__, None, checked.__closure__)
    functools.update_wrapper(own, function)
    vars(own)["is_checked"] = True
    return own


def guard(*modules: str) -> None:
    """Check the arguments of the functions and methods that modules export by their annotations."""
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
    """Check the arguments of constructors and methods, but for overrides.

    Overrides are called by the package itself.
    """
    for name, member in list(vars(public).items()):
        function = getattr(member, "__func__", member)
        if name.startswith("_") and name not in ("__init__", "__getitem__"):
            continue
        if not isinstance(function, FunctionType) or hasattr(function, "is_checked"):
            continue
        if not getattr(function, "__override__", False):
            new = _checked(function, public)
            setattr(public, name, new if member is function else type(member)(new))
    package = __name__.partition(".")[0]
    for base in public.__bases__:
        if base.__module__.partition(".")[0] == package and base.__name__ not in _OWN:
            _guard_methods(base)
