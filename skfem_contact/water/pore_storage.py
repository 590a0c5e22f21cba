"""Water that the pores of deforming ground hold: full pores, or partly filled ones."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import Self

from ..sparse import with_data
from .conductivity import Slopes
from .darcy import radius
from .moisture import Filling, Moisture
from .porous import Numbered, Porous

#: Round-off of the water in an element, as a share of the water that its pores hold.
_ROUND_OFF = 4 * np.finfo(float).eps


class Held(NamedTuple):
    """Water at the nodes, (n_vertices,), beyond the water of undeformed ground at the start.

    The force is the force of the water on the dofs before the pressures, (n_u,).
    """

    volume: ndarray
    force: ndarray
    filling: Filling | None


class Storage(Protocol):
    """Water that deforming ground holds, by displacements and excess pressures x."""

    linear: bool

    def numbered(self, first: int) -> Self:
        """Return the storage with pressures that begin at a dof."""

    def held(self, x: ndarray) -> Held:
        """Return the water in the ground."""

    def thrust(self, pressure: ndarray) -> ndarray:
        """Return the force of the water on the dofs before the pressures, (n_u,)."""

    def by_displacements(self, x: ndarray) -> ndarray:
        """Return the part of the water that displacements make room for, (n_vertices,)."""

    def movable(self, pressure: ndarray) -> float:
        """Return the water that an excess pressure can move."""

    def round_off(self, water: Held) -> float | ndarray:
        """Return the round-off of the water where it is more than the round-off of forces."""

    def tangent(self, x: ndarray, water: Held, flow: Slopes, duration: float) -> csr_matrix:
        """Return the tangent of forces and of the water at the nodes after a step."""


class FullPores(Numbered):
    """Storage of saturated ground: the volume strain, and water that is compressed.

    Pressures of elements of corner nodes alone are stabilised by a storage of 1 / 2G for their
    differences from the mean over the element.
    """

    linear = True

    def __init__(
        self,
        porous: Porous,
        specific: ndarray,
        shear: ndarray,
        capacity: ndarray,
    ) -> None:
        self._porous = porous
        self._capacity = capacity
        self._by_pressure = specific[:, None, None] * porous.mass  # (n_elements, n_p, n_p)
        if porous.linear:
            self._by_pressure = self._by_pressure + _stabilisation(porous, shear)

    @cached_property
    def matrix(self) -> csr_matrix:
        """Negative storage, with the coupling between pressures and displacements: symmetric."""
        return self._porous.matrix(self.first, -self._porous.coupling, -self._by_pressure)

    def held(self, x: ndarray) -> Held:
        """Return the water in the ground."""
        product = self.matrix @ x
        return Held(-product[self.first :], product[: self.first], None)

    def thrust(self, pressure: ndarray) -> ndarray:
        """Return the force of the water on the dofs before the pressures, (n_u,)."""
        return self.held(np.append(np.zeros(self.first), pressure)).force

    def by_displacements(self, x: ndarray) -> ndarray:
        """Return the part of the water that displacements make room for, (n_vertices,)."""
        moved = x.copy()
        moved[self.first :] = 0.0
        return self.held(moved).volume

    def movable(self, pressure: ndarray) -> float:
        """Return the water that an excess pressure can move."""
        return float(self._capacity @ np.abs(pressure))

    def round_off(self, water: Held) -> float:
        """Return no round-off beyond the round-off of forces."""
        return 0.0

    def tangent(self, x: ndarray, water: Held, flow: Slopes, duration: float) -> csr_matrix:
        """Return the tangent of forces and of the water at the nodes after a step."""
        leaving = self._porous.matrix(
            self.first,
            0.0 * self._porous.coupling,
            water=-duration * flow.by_pressure,
            across=-duration,
            squeezed=None if flow.by_strain is None else -duration * flow.by_strain,
        )
        return with_data(self.matrix, self.matrix.data + leaving.data)


class PartlyFilledPores(Numbered):
    """Storage of ground with air in its pores; steps balance differences of contents."""

    linear = False

    def __init__(
        self,
        porous: Porous,
        specific: ndarray,
        shear: ndarray,
        softness: ndarray,
        moisture: Moisture,
        unit_weight: float,
        axisymmetric: bool,
    ) -> None:
        self._porous = porous
        self._specific = specific
        self._softness = softness
        self._moisture = moisture
        self._weight = unit_weight * _upward(porous.basis, porous.pressures, axisymmetric)
        self._spread = None
        if porous.linear:
            self._spread = _stabilisation(porous, shear)

    def held(self, x: ndarray) -> Held:
        """Return the water in the ground."""
        water = self._moisture.filling(x[self.first :])
        return Held(self._volume(x, water), self._force(water), water)

    def thrust(self, pressure: ndarray) -> ndarray:
        """Return the force of the water on the dofs before the pressures, (n_u,)."""
        return self._force(self._moisture.filling(pressure))

    def by_displacements(self, x: ndarray) -> ndarray:
        """Return the part of the water that displacements make room for, (n_vertices,)."""
        water = self._moisture.filling(x[self.first :])
        undeformed = x.copy()
        undeformed[: self.first] = 0.0
        return self._volume(x, water) - self._volume(undeformed, water)

    def movable(self, pressure: ndarray) -> float:
        """Return the water that an excess pressure can move, by saturation and compression."""
        water = self._moisture.filling(pressure)
        before = self._moisture.before
        by_content = np.abs(water.content - before.content)
        by_pressure = np.abs(water.bishop - before.bishop)
        corners = by_content + self._softness[:, None] * by_pressure
        return float((self._moisture.corners * corners).sum())

    def round_off(self, water: Held) -> ndarray:
        """Return the round-off of the water at the nodes, (n_vertices,)."""
        assert water.filling is not None
        return _ROUND_OFF * self._moisture.gathered(water.filling.content)

    def tangent(self, x: ndarray, water: Held, flow: Slopes, duration: float) -> csr_matrix:
        """Return the tangent of forces and of the water at the nodes after a step."""
        now = water.filling
        assert now is not None
        parts = self._porous
        # d stored / d p: water that is compressed, stabilisation, and contents
        stored = (now.share * self._specific[:, None])[:, :, None] * parts.mass
        if self._spread is not None:
            stored = stored + self._spread * now.bishop_slope[:, None, :]
        corner = np.arange(stored.shape[1])
        by_content = self._moisture.corners * now.content_slope
        stored[:, corner, corner] += by_content + now.share_slope * self._growth(x)
        # d force / d p: weight of the water, and Bishop's pressure
        weight = self._weight * now.content_slope[:, None, :]
        thrust = weight - parts.coupling * now.bishop_slope[:, None, :]
        # d stored / d u
        squeezed = parts.coupling * now.share[:, None, :]
        if flow.by_strain is not None:
            squeezed = squeezed + duration * flow.by_strain
        return parts.matrix(
            self.first,
            thrust,
            water=-stored - duration * flow.by_pressure,
            across=-duration,
            squeezed=-squeezed,
        )

    def _force(self, water: Filling) -> ndarray:
        before = self._moisture.before
        heavier = np.einsum("ebj,ej->eb", self._weight, water.content - before.content)
        pressed = np.einsum("ebj,ej->eb", self._porous.coupling, water.bishop - before.bishop)
        dofs = self._porous.basis.element_dofs.T
        return np.bincount(dofs.ravel(), (heavier - pressed).ravel(), minlength=self.first)

    def _volume(self, x: ndarray, water: Filling) -> ndarray:
        before = self._moisture.before
        corners = self._moisture.corners * (water.content - before.content)
        corners = corners + water.share * self._growth(x)
        if self._spread is not None:
            corners += np.einsum("eij,ej->ei", self._spread, water.bishop - before.bishop)
        return self._porous.gathered(corners)

    def _growth(self, x: ndarray) -> ndarray:
        """Return the growth of the pores and of the water by compression, (n_elements, n_p)."""
        parts = self._porous
        pressure = x[self.first :][parts.corners]
        compressed = self._specific[:, None] * np.einsum("eij,ej->ei", parts.mass, pressure)
        grown = np.einsum("ebj,eb->ej", parts.coupling, x[parts.basis.element_dofs.T])
        return np.asarray(grown + compressed)


def _stabilisation(porous: Porous, shear: ndarray) -> ndarray:
    """Return the storage of differences of pressures in an element, (n_elements, n_p, n_p)."""
    return np.asarray(porous.spread / (2.0 * shear)[:, None, None])


def _upward(basis: CellBasis, pressures: CellBasis, axisymmetric: bool) -> ndarray:
    """Return the forces of an upward unit weight 1 by corner, (n_elements, n_u, n_p)."""
    weight = np.asarray(basis.dx * radius(basis, axisymmetric))
    up = [np.asarray(displacement)[-1] for (displacement,) in basis.basis]
    corner = [np.asarray(shape) for (shape,) in pressures.basis]
    of_ground = np.stack([np.broadcast_to(values, weight.shape) for values in up])
    of_corners = np.stack([np.broadcast_to(values, weight.shape) for values in corner])
    forces = np.einsum("beq,jeq,eq->ebj", of_ground, of_corners, weight, optimize=True)
    return np.asarray(forces)
