"""Darcy's law on a mesh: permeability, and the water that enters the ground at the nodes for given heads."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix, csr_matrix
from skfem import Basis, CellBasis

from ..checks import look_up
from ..layout import elements_of, linear_element
from .retention import Retention

T = TypeVar("T")
#: Permeability of a region: a number, one number for each axis, or a symmetric tensor (dim, dim).
Permeability = ArrayLike
#: Largest ratio of permeabilities: the flow through a dam is known to 5e-4 with a core 1e10 times as permeable as the
#: rest, and the matrix is singular with 1e12.
_MOST = 1e10
#: Error of a sum of some ten products of heads and conductances, relative to the largest.
_ROUND_OFF = 16 * np.finfo(float).eps


def regions(basis: CellBasis, values: T | Mapping[str, T], what: str) -> list[tuple[ndarray, T]]:
    """Which elements of a basis have which value, where one is given for all or one for each subdomain."""
    here = elements_of(basis)
    if not isinstance(values, Mapping):
        return [(np.arange(len(here)), values)]
    count = np.zeros(len(here), dtype=int)
    found = []
    for name, value in values.items():
        part = np.flatnonzero(np.isin(here, look_up(name, basis.mesh.subdomains or {}, "subdomain")))
        count[part] += 1
        found.append((part, value))
    for wrong, text in ((count == 0, f"have no {what}"), (count > 1, f"have more than one {what}")):
        if wrong.any():
            names = [name for name, part in (basis.mesh.subdomains or {}).items() if np.isin(part, here[wrong]).any()]
            raise ValueError(f"{wrong.sum()} elements {text}; they lie in the subdomains {names}")
    return found


def permeability_tensors(basis: CellBasis, k: Permeability | Mapping[str, Permeability]) -> ndarray:
    """Tensor of permeability of every element of a basis, (n_elements, dim, dim)."""
    dim = basis.mesh.dim()
    tensors = np.empty((basis.nelems, dim, dim))
    found: list[float] = []
    for part, value in regions(basis, k, "permeability"):
        tensor = tensors[part] = _tensor(value, dim)
        found += np.linalg.eigvalsh(tensor).tolist() if len(part) else []
    if max(found) > _MOST * min(found):
        raise ValueError(f"the permeabilities from {min(found):.3g} to {max(found):.3g} are too far apart: round-off "
                         "would hide the flow through the tightest ground; leave that out of the basis")
    return tensors


def _tensor(value: object, dim: int) -> ndarray:
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        array = np.full(0, np.nan)
    if array.shape not in ((), (dim,), (dim, dim)):
        raise ValueError(f"a permeability is a number, {dim} numbers along the axes or a tensor ({dim}, {dim}), "
                         f"not {value!r}")
    tensor = array if array.ndim == 2 else array * np.eye(dim)
    if not np.isfinite(tensor).all() or not np.allclose(tensor, tensor.T, rtol=1e-12, atol=0.0) \
            or np.linalg.eigvalsh(tensor).min() <= 0.0:
        raise ValueError(f"a permeability must be positive and finite in all directions, not {value!r}; leave elements "
                         "that no water enters out of the basis")
    return tensor


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
