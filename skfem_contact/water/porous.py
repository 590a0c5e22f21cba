"""Porous ground: coupling of pressures with displacements, storage and flow, element by element."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array
from skfem import CellBasis, FacetBasis
from typing_extensions import Self

from ..arrays import max_abs
from ..forms.assembly import strain_operator
from ..forms.base import Coordinates
from ..layout import elements_of
from .darcy import radius

#: Conductance of connected boundaries over the conductance of the elements at them: their pressures
#: differ by a thousandth of the drop in one element.
_OPEN = 1e3
#: A pressure of one everywhere that strains nothing beyond this share of its effect without
#: supports is undetermined.
_RIGID = 1e-12


class Numbered:
    """Flow or storage of water whose pressures begin at a dof, `first`."""

    first: int

    def numbered(self, first: int) -> Self:
        """Return the same with pressures that begin at a dof."""
        new = copy(self)
        new.first = first
        return new


@dataclass(frozen=True, eq=False)
class Porous:
    """Matrices of the elements, with displacements and linear pressures at the same points.

    Attributes
    ----------
    coupling : ndarray, shape (n_elements, n_u, n_p)
        Volume strain weighted with the shape functions of the pressure.
    mass, spread, flow : ndarray, shape (n_elements, n_p, n_p)
        Products of these shape functions; of their differences from the mean over the element; and
        of their gradients with the permeability.
    conductance : ndarray, shape (N,)
        Water that leaves the nodes by a pressure of one there.
    across : coo_matrix, shape (N, N)
        Water that leaves the nodes through connected boundaries, by pressures.
    open
        Nodes of connected boundaries.
    """

    basis: CellBasis
    pressures: CellBasis
    coupling: ndarray
    mass: ndarray
    spread: ndarray
    flow: ndarray
    conductance: ndarray
    across: coo_matrix
    open: ndarray

    @classmethod
    def of(
        cls,
        basis: CellBasis,
        pressures: CellBasis,
        measure: tuple[str, Coordinates],
        mobility: ndarray,
        apart: csr_matrix,
        facets: ndarray,
    ) -> Porous:
        """Integrate the matrices.

        The mobility is the permeability over the unit weight of water, (n_elements, dim, dim).
        Water between connected boundaries, with the pressures `apart` and these facets, presses on
        both and fills the gap by which they open.
        """
        B, weight = strain_operator(basis, *measure)
        shapes = [pressures.basis[j][0] for j in range(pressures.Nbfun)]
        N = np.stack([np.broadcast_to(np.asarray(shape), weight.shape) for shape in shapes])
        gradients = np.stack([np.asarray(shape.grad) for shape in shapes])  # (n_p, dim, n, n_q)
        # Volume strain by displacements times pressures; storage; its part that the mean leaves.
        volumetric = B[:, :, :3].sum(axis=2)
        coupling = np.einsum("eqb,jeq,eq->ebj", volumetric, N, weight)
        mass = np.einsum("ieq,jeq,eq->eij", N, N, weight, optimize=True)
        mean = np.einsum("ieq,eq->ei", N, weight)
        volume = weight.sum(axis=1)[:, None, None]
        spread = mass - mean[:, :, None] * mean[:, None, :] / volume
        # grad N . k grad N
        flow = np.einsum(
            "ikeq,ekl,jleq,eq->eij", gradients, mobility, gradients, weight, optimize=True
        )
        conductance = _gathered(pressures, np.einsum("eii->ei", flow))
        # An open joint passes water across.
        across = coo_matrix(apart.T @ diags_array(_OPEN * conductance) @ apart)
        if len(facets):
            coupling = coupling - _swept(basis, pressures, facets, measure[1])
        return cls(
            basis=basis,
            pressures=pressures,
            coupling=coupling,
            mass=mass,
            spread=spread,
            flow=flow,
            conductance=conductance,
            across=across,
            open=np.unique(basis.mesh.facets[:, facets]),
        )

    @property
    def linear(self) -> bool:
        """True if displacements and pressures have the same nodes: such pairs are not stable."""
        return self.basis.Nbfun == self.basis.mesh.dim() * self.pressures.Nbfun

    @property
    def corners(self) -> ndarray:
        """Pressures of the elements, (n_elements, n_p)."""
        return np.asarray(self.pressures.element_dofs.T)

    @cached_property
    def growth(self) -> ndarray:
        """Mean volume strain of the elements by their dofs, (n_elements, n_u)."""
        volume = self.mass.sum(axis=(1, 2))[:, None]
        return np.asarray(self.coupling.sum(axis=2) / volume)

    def matrix(
        self,
        first: int,
        coupling: ndarray,
        water: ndarray,
        across: float = 0.0,
        squeezed: ndarray | None = None,
    ) -> csr_matrix:
        """Return the matrix of all dofs with pressures from `first` on, always of one pattern.

        The matrix contains `across` times the flow through connected boundaries. The water that
        displacements squeeze out is by default the water of the coupling.
        """
        u = self.basis.element_dofs.T
        p = first + self.corners
        if squeezed is None:
            squeezed = coupling
        # Add the blocks of displacements and pressures, and of pressures alone.
        rows = []
        columns = []
        data = []
        for row, column, values in (
            (u, p, coupling),
            (p, u, squeezed.transpose(0, 2, 1)),
            (p, p, water),
        ):
            rows.append(np.broadcast_to(row[:, :, None], values.shape).ravel())
            columns.append(np.broadcast_to(column[:, None], values.shape).ravel())
            data.append(values.ravel())
        # Add the exchange between both sides of connected boundaries.
        rows.append(first + self.across.row)
        columns.append(first + self.across.col)
        data.append(across * self.across.data)
        # Sum up by rows and columns.
        n = first + self.pressures.N
        indices = (np.concatenate(rows), np.concatenate(columns))
        return csr_matrix(coo_matrix((np.concatenate(data), indices), (n, n)))

    def gathered(self, corners: ndarray) -> ndarray:
        """Sum values at the corners of the elements, (n_elements, n_p), at the nodes, (N,)."""
        return _gathered(self.pressures, corners)

    def at_nodes(self, density: ndarray) -> ndarray:
        """Integrate a density of the elements, (n_elements,), over the share of each node, (N,)."""
        return self.gathered(self.mass.sum(axis=2) * density[:, None])

    def strains(self, fixed: ndarray) -> bool:
        """Return True if a uniform pressure strains the ground with these fixed displacements."""
        dofs = self.basis.element_dofs.T.ravel()
        by_element = self.coupling.sum(axis=2).ravel()
        thrust = np.abs(np.bincount(dofs, by_element, minlength=self.basis.N))
        largest = max(thrust.max(), max_abs(self.coupling))
        thrust[fixed] = 0.0
        return bool(thrust.max() > _RIGID * largest)


def _gathered(basis: CellBasis, corners: ndarray) -> ndarray:
    return np.bincount(basis.element_dofs.T.ravel(), corners.ravel(), minlength=basis.N)


def _swept(basis: CellBasis, pressures: CellBasis, facets: ndarray, coordinates: str) -> ndarray:
    """Return the volume that displacements sweep at facets, weighted as :attr:`Porous.coupling`."""
    sides = FacetBasis(basis.mesh, basis.elem, facets=facets)
    wet = FacetBasis(basis.mesh, pressures.elem, facets=facets, quadrature=sides.quadrature)
    weight = sides.dx * radius(sides, coordinates == "axisymmetric")
    # Move the facets by each displacement along their normals.
    moved = []
    for (displacement,) in sides.basis:
        moved.append(np.einsum("ifq,ifq->fq", displacement, sides.normals))
    shapes = [np.broadcast_to(shape, weight.shape) for (shape,) in wet.basis]
    swept = np.einsum("bfq,jfq,fq->fbj", np.stack(moved), np.stack(shapes), weight)
    # Add the volume to the elements of the facets.
    number = np.zeros(basis.mesh.nelements, int)
    number[elements_of(basis)] = np.arange(basis.nelems)
    result = np.zeros((basis.nelems, basis.Nbfun, pressures.Nbfun))
    np.add.at(result, number[basis.mesh.f2t[0, facets]], swept)
    return result


@dataclass(frozen=True)
class PoreState:
    """State of the water around the nodes, (n_vertices,) each.

    Attributes
    ----------
    stored, first
        Volume of water, more than in undeformed ground; the same when the ground became active.
    entered
        Water that has entered since: not zero only where pressures are given, or other ground
        begins.
    pressure
        Excess pore pressure, positive in compression.
    rate
        Water that flows to the nodes in a unit of time; by default zero.
    """

    stored: ndarray
    first: ndarray
    entered: ndarray
    pressure: ndarray
    rate: ndarray = field(default_factory=lambda: np.zeros(0), kw_only=True)

    def __post_init__(self) -> None:
        if len(self.rate) != len(self.stored):
            object.__setattr__(self, "rate", np.zeros_like(self.stored))


@dataclass(frozen=True)
class CompactedState(PoreState):
    """State of the water around the nodes, and the volume strain of the elements, (n_elements,).

    Attributes
    ----------
    strain
        Mean volume strain since the water became active.
    before
        Part of it that displacements do not contain, because they were reset or the ground was
        active before.
    """

    strain: ndarray
    before: ndarray
