"""Distributed loads, as they are given: by name, or as load vectors that they add up to."""
from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import Basis, CellBasis

from ..errors import AnalysisWarning, look_up, place
from ..layout import linear_element
from ..loads import Pressure, by_element, traction, water_load, weight
from .triangles import Tag

#: A traction or a pressure: a function of places (2, n).
Field = Callable[[ndarray], ndarray]
#: A traction: (t_x, t_y), or a function of places (2, n) with values (2, n).
TractionLike = ArrayLike | Callable[[ndarray], ndarray]
#: What distributed loads may leave of a vector, as a share of it: other rules of integration do.
_LEFT = 1e-8
#: Share of a load's part in the vector below which it is none.
_NONE = 1e-10


class Site(NamedTuple):
    """Where loads act: a basis, the elements of the solids and those of them with pores, and unknowns that are held."""

    basis: CellBasis
    elements: ndarray
    porous: ndarray
    fixed: ndarray


class Traction(NamedTuple):
    """A traction on named facets, (2, n) at places (2, n), and whether it is multiplied."""

    tag: Tag
    value: Field
    live: bool


class Distributed(NamedTuple):
    """Loads in any units, by elements and places of the mesh.

    Attributes
    ----------
    dead, live
        Body forces that are fixed, and multiplied, (n_elements, 2).
    tractions
        On boundaries.
    water
        Pressure in the pores, positive: everything but rigid bodies has pores.
    wetted
        Boundaries that the water presses on from outside.
    remarks
        What was simplified.
    """

    dead: ndarray
    live: ndarray
    tractions: tuple[Traction, ...] = ()
    water: Field | None = None
    wetted: tuple[Tag, ...] = ()
    remarks: tuple[str, ...] = ()

    def scaled(self, centre: ndarray, size: float, stress: float) -> Distributed:
        """The same at places from a centre, in units of a size and of a stress."""
        def field(value: Field) -> Field:
            return lambda x: np.asarray(value(centre[:, None] + size * x)) / stress

        tractions = tuple(one._replace(value=field(one.value)) for one in self.tractions)
        water = None if self.water is None else field(self.water)
        unit = size / stress
        return self._replace(dead=self.dead * unit, live=self.live * unit, tractions=tractions, water=water)


@dataclass(frozen=True)
class Loads:
    """Loads as they are given to :func:`~skfem_contact.bounds`."""

    weight: float | Mapping[str, float]
    seismic: float
    tractions: Mapping[str, TractionLike]
    water: Pressure | None
    wetted: tuple[str, ...]
    live: tuple[str, ...]

    @property
    def multiplied(self) -> bool:
        """Whether a load is multiplied; otherwise the strength is reduced."""
        return bool(self.live)

    def on(self, site: Site) -> Distributed:
        """The loads on a mesh, checked."""
        basis = site.basis
        known = {"weight", *self.tractions}
        for name in self.live:
            if name not in known:
                raise ValueError(f"there is no load '{name}' to multiply; existing: {', '.join(sorted(known))}")
        for name in (*self.tractions, *self.wetted):
            look_up(name, basis.mesh.boundaries or {}, "boundary")
        body = by_element(basis.mesh, self.weight)[:, None] * np.array([self.seismic, -1.0])
        nothing = np.zeros_like(body)
        dead, live = (nothing, body) if "weight" in self.live else (body, nothing)
        tractions = tuple(Traction(name, _traction(name, value), name in self.live)
                          for name, value in self.tractions.items())
        water = None if self.water is None else pressure(self.water, basis)
        if not body.any() and not tractions and water is None:
            raise ValueError("there is no load: give `weight`, `tractions` or `water`")
        linear = any(callable(value) for value in self.tractions.values())
        remarks = ("tractions are linear along every facet",) * linear
        return Distributed(dead, live, tractions, water, self.wetted, remarks)


def _traction(name: str, value: TractionLike) -> Field:
    """A traction as a function of places, checked."""
    if callable(value):
        def field(x: ndarray) -> ndarray:
            result = np.asarray(value(x), dtype=float)
            if result.shape != x.shape or not np.isfinite(result).all():
                raise ValueError(f"the traction on '{name}' must be finite and of shape {x.shape}, like the places")
            return result
        return field
    constant = np.asarray(value, dtype=float)
    if constant.shape != (2,) or not np.isfinite(constant).all():
        raise ValueError(f"the traction on '{name}' must be (t_x, t_y) or a function of places, not {value!r}")
    return lambda x: np.broadcast_to(constant[:, None], x.shape)


def pressure(water: Pressure, basis: CellBasis) -> Field:
    """Pressure of water as a function of places."""
    if callable(water):
        return lambda x: np.asarray(water(x), dtype=float)
    mesh = basis.mesh
    if np.shape(water) != (mesh.nvertices,):
        raise ValueError(f"the water has shape {np.shape(water)}; the mesh has {mesh.nvertices} nodes")
    return Basis(mesh, linear_element(mesh)).interpolator(np.asarray(water, dtype=float))


@dataclass(frozen=True)
class Vectors:
    """Load vectors, fixed and multiplied (None: the strength is reduced), and the water whose forces they hold."""

    dead: ndarray
    live: ndarray | None
    water: Pressure | None = None
    wetted: tuple[str, ...] = ()

    @property
    def multiplied(self) -> bool:
        """Whether a load is multiplied; otherwise the strength is reduced."""
        return self.live is not None

    def on(self, site: Site) -> Distributed:
        """Weights of subdomains and tractions on boundaries that add up to the vectors."""
        basis, parts = site.basis, _Parts(site)
        dead, water = self.dead[:basis.N], None
        if self.water is not None:
            water = pressure(self.water, basis)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", AnalysisWarning)  # it was given with the load
                dead = dead - water_load(basis.with_elements(site.porous), self.water, self.wetted)
        body, tractions = parts.of(dead, False)
        if self.live is None:
            return Distributed(body, 0 * body, tractions, water, self.wetted)
        pulled, pushed = parts.of(self.live[:basis.N], True)
        return Distributed(body, pulled, tractions + pushed, water, self.wetted)


class _Parts:
    """Loads that bounds know, with their vectors: weights of subdomains, and tractions linear along boundaries."""

    def __init__(self, site: Site) -> None:
        self.site, self.mesh = site, site.basis.mesh
        self.free = np.setdiff1d(np.arange(site.basis.N), site.fixed)
        low, high = self.mesh.p.min(axis=1), self.mesh.p.max(axis=1)
        self._centre, self._size = 0.5 * (low + high), float((high - low).max())

    def of(self, load: ndarray, live: bool) -> tuple[ndarray, tuple[Traction, ...]]:
        """Body forces (n_elements, 2) and tractions: weights and as few boundaries as will do.

        Raises
        ------
        ValueError
            Such loads do not add up to the vector.
        """
        body, target = np.zeros((self.mesh.nelements, 2)), load[self.free]
        size = float(np.linalg.norm(target))
        names: list[str] = []
        left, share = self._fitted(names, target)
        while np.linalg.norm(left) > _LEFT * size and len(names) < len(self._tractions):
            fits = {name: self._fitted([*names, name], target) for name in self._tractions if name not in names}
            names.append(min(fits, key=lambda name: float(np.linalg.norm(fits[name][0]))))
            left, share = fits[names[-1]]
        if np.linalg.norm(left) > _LEFT * size:
            worst = self.site.basis.doflocs[:, self.free[np.abs(left).argmax()]]
            raise ValueError(
                "bounds need distributed loads, but the load vector is no sum of weights of subdomains and tractions "
                f"that are linear along named boundaries: {np.linalg.norm(left) / size:.2g} of it are left, most at "
                f"{place(worst)}; name the boundary that is loaded, give water by certify={{'water': ...}}, or call "
                "`bounds`")
        kinds = self._kinds
        n = 2 * (kinds.max() + 1)
        there = kinds >= 0
        body[there] = share[:n].reshape(-1, 2)[kinds[there]]
        return body, tuple(Traction(name, self._field(coefficients), live)
                           for name, coefficients in zip(names, share[n:].reshape(-1, 2, 3)))

    def _fitted(self, names: list[str], target: ndarray) -> tuple[ndarray, ndarray]:
        """What weights and the tractions on some boundaries leave of a vector, and their shares."""
        columns = np.column_stack([self._weights, *(self._tractions[name] for name in names)])
        scale = np.linalg.norm(columns, axis=0)
        scale[scale == 0] = 1.0
        share = np.linalg.lstsq(columns / scale, target, rcond=1e-10)[0]
        share[np.abs(share) < _NONE * np.linalg.norm(target)] = 0.0
        return target - (columns / scale) @ share, share / scale

    @cached_property
    def _kinds(self) -> ndarray:
        """Elements of the same subdomains have the same number, (n_elements,); -1 where there is no solid."""
        member = np.zeros((len(self.mesh.subdomains or {}) + 1, self.mesh.nelements), bool)
        for row, part in zip(member, (self.mesh.subdomains or {}).values()):
            row[part] = True
        kinds = np.full(self.mesh.nelements, -1)
        kinds[self.site.elements] = np.unique(member[:, self.site.elements], axis=1, return_inverse=True)[1].ravel()
        return kinds

    @cached_property
    def _weights(self) -> ndarray:
        """Vectors of unit weights in x and y of all kinds of elements, (n_free, 2 n_kinds)."""
        kinds, basis = self._kinds, self.site.basis
        parts = [basis.with_elements(np.flatnonzero(kinds == kind)) for kind in range(kinds.max() + 1)]
        axes = (1.0, 0.0), (0.0, 1.0)
        return np.column_stack([weight(part, 1.0, axis)[self.free] for part in parts for axis in axes])

    @cached_property
    def _tractions(self) -> dict[str, ndarray]:
        """Vectors of unit tractions in x and y, constant and linear in x and y, on boundaries of the solids."""
        found, count = {}, np.bincount(self.mesh.t2f[:, self.site.elements].ravel(), minlength=self.mesh.nfacets)
        for name, facets in (self.mesh.boundaries or {}).items():
            if len(facets) and (count[facets] == 1).all():
                units = np.eye(6).reshape(6, 2, 3)
                found[name] = np.column_stack([traction(self.site.basis, name, self._field(unit))[self.free]
                                               for unit in units])
        return found

    def _field(self, coefficients: ndarray) -> Field:
        """A traction of places, from its six coefficients (2, 3)."""
        def field(x: ndarray) -> ndarray:
            away = (x - self._centre.reshape(2, *(1,) * (x.ndim - 1))) / self._size
            return np.einsum("cs,s...->c...", coefficients, np.stack([np.ones_like(away[0]), *away]))

        return field
