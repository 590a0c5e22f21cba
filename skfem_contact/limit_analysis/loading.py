"""Loads as they are distributed, by name."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import Basis, CellBasis

from ..errors import look_up
from ..loads import by_element
from ..unknowns import linear_element
from .triangles import Tag

#: A traction or a pressure: a function of places (2, n).
Field = Callable[[ndarray], ndarray]
#: A traction: (t_x, t_y), or a function of places (2, n) with values (2, n).
TractionLike = ArrayLike | Callable[[ndarray], ndarray]
#: A pressure of water, positive: a function of places (2, n), or values at the nodes of the mesh.
PressureLike = Callable[[ndarray], ndarray] | ndarray


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

        tractions = tuple(traction._replace(value=field(traction.value)) for traction in self.tractions)
        water = None if self.water is None else field(self.water)
        unit = size / stress
        return self._replace(dead=self.dead * unit, live=self.live * unit, tractions=tractions, water=water)


@dataclass(frozen=True)
class Loads:
    """Loads as they are given to :func:`~skfem_contact.bounds`."""

    weight: float | Mapping[str, float]
    seismic: float
    tractions: Mapping[str, TractionLike]
    water: PressureLike | None
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


def pressure(water: PressureLike, basis: CellBasis) -> Field:
    """Pressure of water as a function of places."""
    if callable(water):
        return lambda x: np.asarray(water(x), dtype=float)
    mesh = basis.mesh
    if np.shape(water) != (mesh.nvertices,):
        raise ValueError(f"the water has shape {np.shape(water)}; the mesh has {mesh.nvertices} nodes")
    return Basis(mesh, linear_element(mesh)).interpolator(np.asarray(water, dtype=float))
