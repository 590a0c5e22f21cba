"""Boundaries of loaded meshes, whose facets are numbered when they are first used."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable, Mapping
from copy import copy
from typing import Any, NamedTuple

import numpy as np
from skfem import Mesh
from skfem.generic_utils import OrientedBoundary

from .facets import number_facets
from .kinds import Integers


class Sides(NamedTuple):
    """Sides of elements.

    Attributes
    ----------
    elements
        Numbers of the elements, (n,).
    local
        Numbers of the sides in their elements, (n,).
    oriented
        Whether the sides are seen from these elements; else only their facets are meant.
    """

    elements: Integers
    local: Integers
    oriented: bool

    def facets(self, mesh: Mesh) -> Integers:
        """Return the facets of the mesh."""
        facets = mesh.t2f[self.local, self.elements].astype(np.int32)
        if not self.oriented:
            return np.sort(facets)
        second = mesh.f2t[1, facets] == self.elements
        return OrientedBoundary(facets, second.astype(int))


#: Function that returns the sides of all boundaries by name.
_Find = Callable[[], Mapping[str, Sides]]


class Boundaries(dict[str, Any]):
    """Dict of the facets of boundaries, which are numbered when one of them is first used.

    The numbering of all facets takes longer than the reading of a file, and a mesh that is only
    looked at needs none. Keys are known from the beginning. Copies and pickles are plain dicts.
    """

    _pending: tuple[_Find, Mesh, Callable[[], Mesh | None]] | None = None

    @classmethod
    def of(cls, mesh: Mesh, names: Iterable[str], find: _Find) -> Boundaries:
        """Return boundaries of a mesh without tags, the sides of which a function finds."""
        boundaries = cls(dict.fromkeys(names))
        # A second mesh of the same arrays outlives the first one, to which a cycle would lead
        boundaries._pending = (find, copy(mesh), weakref.ref(mesh))
        return boundaries

    def number(self) -> None:
        """Look up the facets of all boundaries, unless this is done."""
        if self._pending is None:
            return
        find, bare, owner = self._pending
        dict.update(self, _facets_of(owner() or bare, find()))
        self._pending = None

    def __iter__(self) -> Any:
        # dict(boundaries) and {**boundaries} look values up one by one where this is overridden
        return dict.__iter__(self)

    def __reduce__(self) -> tuple[Any, ...]:
        if self._pending is None:
            return dict, (dict(self),)
        # A mesh that is being copied or pickled must not get facets meanwhile
        find, bare, owner = self._pending
        return dict, (_facets_of(copy(owner() or bare), find()),)


def _facets_of(mesh: Mesh, sides: Mapping[str, Sides]) -> dict[str, Integers]:
    """Return the facets of boundaries of a mesh, which are numbered."""
    number_facets(mesh)
    return {name: part.facets(mesh) for name, part in sides.items()}


def _numbered(name: str) -> Callable[..., Any]:
    """Return the method of a dict that numbers the facets first."""
    method = getattr(dict, name)

    def first_number(self: Boundaries, *args: Any, **kwargs: Any) -> Any:
        self.number()
        return method(self, *args, **kwargs)

    first_number.__name__ = name
    return first_number


# Number the facets before any value is read or replaced
for _name in (
    *("__getitem__", "get", "items", "values", "copy", "__eq__", "__ne__", "__repr__"),
    *("__setitem__", "__delitem__", "setdefault", "pop", "popitem", "update", "clear"),
    *("__or__", "__ror__", "__ior__"),
):
    setattr(Boundaries, _name, _numbered(_name))
