"""Darcy's law on a mesh: the water that enters the ground at the nodes for given heads, and its tangent."""
from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix
from skfem import Basis, CellBasis

from ..unknowns import elements_of, linear_element
from .retention import Retention

#: Error of a sum of some ten products of heads and conductances, relative to the largest.
_ROUND_OFF = 16 * np.finfo(float).eps


def head_basis(basis: CellBasis) -> CellBasis:
    """Basis of heads on the elements of any basis: linear, one unknown at each vertex of the mesh."""
    return Basis(basis.mesh, linear_element(basis.mesh), intorder=2, elements=elements_of(basis))


class DarcyFlow:
    """Flow of water through elements of some permeability.

    Parameters
    ----------
    basis
        From :func:`head_basis`.
    tensors
        Permeability of its elements, (n_elements, dim, dim).
    axisymmetric
        Flow per radian about the axis x = 0.
    datum
        Height from which heads and elevations count: near them, for the sake of round-off.

    Attributes
    ----------
    elevation
        Of the nodes, (N,): the last coordinate.
    """

    def __init__(self, basis: CellBasis, tensors: ndarray, axisymmetric: bool = False,
                 datum: float = 0.0) -> None:
        functions = [basis.basis[j][0] for j in range(basis.Nbfun)]
        self._gradients = np.stack([np.asarray(f.grad) for f in functions])
        self._shape = np.stack([np.broadcast_to(np.asarray(f), basis.dx.shape)[0] for f in functions], axis=1)
        self._tensors = tensors
        self._weight = basis.dx * basis.global_coordinates()[0] if axisymmetric else basis.dx
        #: (n_elements, n_points, a, b): water that enters at corner a for a head 1 at corner b
        self._conductance = np.einsum("aieq,eij,bjeq,eq->eqab", self._gradients, tensors, self._gradients,
                                      self._weight, optimize=True)
        self.dofs = np.ascontiguousarray(basis.element_dofs.T)
        self.elevation = basis.mesh.p[-1, :basis.N] - datum
        self._size = np.ptp(self.elevation[self.dofs], axis=1)[:, None]
        corners = self.dofs.shape[1]
        self._rows, self._columns = np.repeat(self.dofs, corners, axis=1).ravel(), np.tile(self.dofs, corners).ravel()

    @cached_property
    def saturated(self) -> csr_matrix:
        """Tangent of saturated ground, (N, N): symmetric."""
        one = np.ones_like(self._weight)
        return self.tangent(self.elevation, one, 0.0 * one)

    def relative(self, head: ndarray, laws: Sequence[tuple[ndarray, Retention]]) -> tuple[ndarray, ndarray]:
        """Relative permeability at the integration points and its slope over the head, (n_elements, n_points)."""
        suction = (self.elevation - head)[self.dofs] @ self._shape.T
        relative, slope = np.ones_like(suction), np.zeros_like(suction)
        for part, law in laws:
            relative[part], falling = law.relative(suction[part], self._size[part])
            slope[part] = -falling
        return relative, slope

    def by_element(self, head: ndarray, relative: ndarray) -> ndarray:
        """Water that enters every element at its corners, (n_elements, n_corners)."""
        return np.einsum("eq,eqab,eb->ea", relative, self._conductance, head[self.dofs], optimize=True)

    def inflow(self, head: ndarray, relative: ndarray) -> ndarray:
        """Water that enters at the nodes, (N,): zero at those through which none does."""
        return np.bincount(self.dofs.ravel(), self.by_element(head, relative).ravel(), minlength=len(head))

    def round_off(self, head: ndarray, relative: ndarray) -> ndarray:
        """What round-off may leave of the inflow at the nodes, (N,)."""
        element = np.einsum("eq,eqaa->ea", relative, self._conductance) * np.abs(head[self.dofs]).max(axis=1)[:, None]
        return _ROUND_OFF * np.bincount(self.dofs.ravel(), element.ravel(), minlength=len(head))

    def tangent(self, head: ndarray, relative: ndarray, slope: ndarray) -> csr_matrix:
        """Derivative of the inflow over the heads, (N, N)."""
        element = np.einsum("eq,eqab->eab", relative, self._conductance)
        if slope.any():
            through = np.einsum("eqab,eb->eqa", self._conductance, head[self.dofs])
            element += np.einsum("eqa,eq,qb->eab", through, slope, self._shape, optimize=True)
        n = len(head)
        return coo_matrix((element.ravel(), (self._rows, self._columns)), shape=(n, n)).tocsr()

    def velocity(self, head: ndarray, relative: ndarray) -> ndarray:
        """Mean Darcy velocity of the elements, (dim, n_elements): discharge per area of ground."""
        gradient = np.einsum("aieq,ea->ieq", self._gradients, head[self.dofs])
        weight = self._weight * relative / self._weight.sum(axis=1, keepdims=True)
        return -np.einsum("eij,jeq,eq->ie", self._tensors, gradient, weight)
