"""Darcy's law on a mesh: permeability, and the flow for given heads."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix, csr_matrix
from skfem import Basis, CellBasis, FacetBasis

from ..checks import format_point, look_up
from ..errors import warn
from ..layout import elements_of, linear_element
from .retention import Laws, Retention

T = TypeVar("T")
#: Permeability of a region: a number, one number for each axis, or a symmetric tensor (dim, dim).
Tensor = ArrayLike
#: Largest ratio of permeabilities: the flow through a dam is known to 5e-4 with a core 1e10 times
#: as permeable as the rest, and the matrix is singular with 1e12.
_MOST = 1e10
#: Error of a sum of some ten products of heads and conductances, relative to the largest.
_ROUND_OFF = 16 * np.finfo(float).eps
#: Ground is dry below the first relative permeability and wet above the second one.
_DRY, _WET = 0.01, 0.5
#: Share of the flow through dry ground from which a warning is given.
_SHARE = 0.05


def regions(basis: CellBasis, values: T | Mapping[str, T], what: str) -> list[tuple[ndarray, T]]:
    """Return elements of a basis and their value, given for all or by subdomain."""
    here = elements_of(basis)
    if not isinstance(values, Mapping):
        return [(np.arange(len(here)), values)]
    count = np.zeros(len(here), dtype=int)
    found = []
    for name, value in values.items():
        part = np.flatnonzero(
            np.isin(here, look_up(name, basis.mesh.subdomains or {}, "subdomain"))
        )
        count[part] += 1
        found.append((part, value))
    for wrong, text in ((count == 0, f"have no {what}"), (count > 1, f"have more than one {what}")):
        if wrong.any():
            names = [
                name
                for name, part in (basis.mesh.subdomains or {}).items()
                if np.isin(part, here[wrong]).any()
            ]
            raise ValueError(f"{wrong.sum()} elements {text}; they lie in the subdomains {names}")
    return found


def laws_with_content(basis: CellBasis, retention: Retention | Mapping[str, Retention]) -> Laws:
    """Return elements of a basis and their retention, which must know the content of water."""
    laws = regions(basis, retention, "retention")
    if any(law.content is None for _, law in laws):
        raise ValueError(
            "retention has no content: give the residual and the saturated content of water, "
            "content=(0.05, 0.4)"
        )
    return laws


def permeability_tensors(basis: CellBasis, permeability: Tensor | Mapping[str, Tensor]) -> ndarray:
    """Return the permeability of every element of a basis, (n_elements, dim, dim)."""
    dim = basis.mesh.dim()
    tensors = np.empty((basis.nelems, dim, dim))
    found: list[float] = []
    for part, value in regions(basis, permeability, "permeability"):
        tensor = tensors[part] = _tensor(value, dim)
        found += np.linalg.eigvalsh(tensor).tolist() if len(part) else []
    if max(found) > _MOST * min(found):
        raise ValueError(
            f"the permeabilities from {min(found):.3g} to {max(found):.3g} are too far apart: "
            f"round-off "
            "would hide the flow through the tightest ground; leave that out of the basis"
        )
    return tensors


def _tensor(value: object, dim: int) -> ndarray:
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        array = np.full(0, np.nan)
    if array.shape not in ((), (dim,), (dim, dim)):
        raise ValueError(
            f"a permeability is a number, {dim} numbers along the axes or a tensor ({dim}, {dim}), "
            f"not {value!r}"
        )
    tensor = array if array.ndim == 2 else array * np.eye(dim)
    if (
        not np.isfinite(tensor).all()
        or not np.allclose(tensor, tensor.T, rtol=1e-12, atol=0.0)
        or np.linalg.eigvalsh(tensor).min() <= 0.0
    ):
        raise ValueError(
            f"a permeability must be positive and finite in all directions, not {value!r}; leave "
            f"elements "
            "that no water enters out of the basis"
        )
    return tensor


def head_basis(basis: CellBasis, order: int = 2) -> CellBasis:
    """Return the linear basis of heads on the elements of any basis: one dof at each vertex of the
    mesh.
    """
    return Basis(
        basis.mesh, linear_element(basis.mesh), intorder=order, elements=elements_of(basis)
    )


def radius(basis: CellBasis | FacetBasis, axisymmetric: bool) -> ndarray | float:
    """Return the factor by which integrals are per radian about the axis x = 0, at the integration
    points, or 1.
    """
    if not axisymmetric:
        return 1.0
    x = np.asarray(basis.global_coordinates())[0]
    if (x < 0.0).any():
        raise ValueError(
            f"axial symmetry needs x >= 0, but there are elements at x = {x.min():.4g}"
        )
    return x


class DarcyFlow:
    """Flow of water through the elements of a :func:`head_basis`, by their permeability,
    (n_elements, dim, dim).

    Heads and elevations, the last coordinates of the nodes, count from a datum: near it, for the
    sake of round-off.
    """

    def __init__(
        self, basis: CellBasis, tensors: ndarray, axisymmetric: bool = False, datum: float = 0.0
    ) -> None:
        functions = [basis.basis[j][0] for j in range(basis.Nbfun)]
        self._gradients = np.stack([np.asarray(f.grad) for f in functions])
        self._shape = np.stack(
            [np.broadcast_to(np.asarray(f), basis.dx.shape)[0] for f in functions], axis=1
        )
        self.basis, self.axisymmetric, self.datum = basis, axisymmetric, datum
        self._tensors = tensors
        self._weight = basis.dx * radius(basis, axisymmetric)
        #: (n_elements, n_points, a, b): water that enters at corner a for a head 1 at corner b
        self._conductance = np.einsum(
            "aieq,eij,bjeq,eq->eqab",
            self._gradients,
            tensors,
            self._gradients,
            self._weight,
            optimize=True,
        )
        self.dofs = np.ascontiguousarray(basis.element_dofs.T)
        self.elevation = basis.mesh.p[-1, : basis.N] - datum
        self._size = np.ptp(self.elevation[self.dofs], axis=1)[:, None]
        corners = self.dofs.shape[1]
        #: (n_elements, n_corners): volume of ground that belongs to each corner
        self.corners = self._weight @ self._shape
        self._rows, self._columns = (
            np.repeat(self.dofs, corners, axis=1).ravel(),
            np.tile(self.dofs, corners).ravel(),
        )

    @cached_property
    def saturated(self) -> csr_matrix:
        """Tangent of saturated ground, (N, N), symmetric."""
        one = np.ones_like(self._weight)
        return DarcyFlow.tangent(self, self.elevation, one, np.zeros(1))

    def relative(self, head: ndarray, laws: Laws) -> tuple[ndarray, ndarray]:
        """Return the relative permeability, (n_elements, n_points), and its slope over the heads of
        the corners.
        """
        suction = (self.elevation - head)[self.dofs] @ self._shape.T
        relative, slope = np.ones_like(suction), np.zeros_like(suction)
        for part, law in laws:
            relative[part], falling = law.relative(suction[part], self._size[part])
            slope[part] = -falling
        return relative, slope[:, :, None] * self._shape

    def filled(self, head: ndarray, laws: Laws) -> tuple[ndarray, ndarray]:
        """Return the effective saturation and its slope over the suction at the corners,
        (n_elements, n_corners).
        """
        suction = (self.elevation - head)[self.dofs]
        filled, slope = np.ones_like(suction), np.zeros_like(suction)
        for part, law in laws:
            filled[part], slope[part] = law.saturation(suction[part], self._size[part])
        return filled, slope

    def gathered(self, corners: ndarray) -> ndarray:
        """Return the integral around each node of values at the corners, (N,)."""
        return np.bincount(
            self.dofs.ravel(), (self.corners * corners).ravel(), minlength=len(self.elevation)
        )

    def moved(self, head: ndarray, change: ndarray, laws: Laws) -> ndarray:
        """Return the heads after a change by Newton's method; nodes stop at the free surface before
        they cross it.
        """
        new, z = head + change, self.elevation
        return np.where((head - z) * (new - z) < 0.0, z, new) if laws else new

    def scale(self, head: ndarray, inflow: ndarray) -> float:
        """Return the amount of water against which the water out of balance is small."""
        return float(np.linalg.norm(inflow))

    def by_element(self, head: ndarray, relative: ndarray) -> ndarray:
        """Return the water that enters every element at its corners, (n_elements, n_corners)."""
        return np.einsum(
            "eq,eqab,eb->ea", relative, self._conductance, head[self.dofs], optimize=True
        )

    def inflow(self, head: ndarray, relative: ndarray) -> ndarray:
        """Return the water that enters at the nodes, (N,)."""
        return np.bincount(
            self.dofs.ravel(), self.by_element(head, relative).ravel(), minlength=len(head)
        )

    def round_off(self, head: ndarray, relative: ndarray) -> ndarray:
        """Estimate the round-off of the inflow, (N,)."""
        element = (
            np.einsum("eq,eqaa->ea", relative, self._conductance)
            * np.abs(head[self.dofs]).max(axis=1)[:, None]
        )
        return _ROUND_OFF * np.bincount(self.dofs.ravel(), element.ravel(), minlength=len(head))

    def by_corner(self, relative: ndarray, slope: ndarray, head: ndarray) -> ndarray:
        """Return the derivative of the inflow of every element over the heads, (n_elements,
        n_corners, n_corners).
        """
        element = np.einsum("eq,eqab->eab", relative, self._conductance)
        if slope.any():
            through = np.einsum("eqab,eb->eqa", self._conductance, head[self.dofs])
            element += np.einsum("eqa,eqb->eab", through, slope)
        return np.asarray(element)

    def tangent(self, head: ndarray, relative: ndarray, slope: ndarray) -> csr_matrix:
        """Return the derivative of the inflow over the heads, (N, N)."""
        element, n = self.by_corner(relative, slope, head), len(head)
        return coo_matrix((element.ravel(), (self._rows, self._columns)), shape=(n, n)).tocsr()

    def velocity(self, head: ndarray, relative: ndarray) -> ndarray:
        """Return the mean Darcy velocity of the elements, (dim, n_elements): discharge per area of
        ground.
        """
        gradient = np.einsum("aieq,ea->ieq", self._gradients, head[self.dofs])
        weight = self._weight * relative / self._weight.sum(axis=1, keepdims=True)
        return -np.einsum("eij,jeq,eq->ie", self._tensors, gradient, weight)


def warn_of_dry_ground(
    basis: CellBasis, tensors: ndarray, relative: ndarray, velocity: ndarray
) -> None:
    """Report water that flows off through dry ground that conducts better than wet ground
    elsewhere.
    """
    # A dam whose core is 1e-2, 1e-3, 1e-4 and 1e-6 times as permeable as its shell leaks .6, .7, -5
    # and -7 % too much with 20 elements over the height if dry ground keeps 1e-3 of its
    # permeability. In the last two cases .26 of the flow is of this kind; where the discharge is
    # right to 1 % less than .005 is.
    k = np.trace(tensors, axis1=1, axis2=2) / basis.mesh.dim()
    wet, left = (relative >= _WET).any(axis=1), relative.min(axis=1) * k
    draining = (relative < _DRY).all(axis=1) & (left > 1.5 * k[wet].min(initial=np.inf))
    flow = np.linalg.norm(velocity, axis=0) * basis.dx.sum(axis=1)
    if flow[draining].sum() > _SHARE * flow.sum():
        x = np.asarray(basis.global_coordinates())[:, np.where(draining, flow, 0.0).argmax()].mean(
            axis=1
        )
        warn(
            f"water flows off through dry ground at {format_point(x)}, which conducts better than "
            f"the wet ground "
            "from which it comes: the free surface there is several per cent off; leave drained "
            "ground out "
            "of the basis and name the boundary towards it in seepage_face=, or give a smaller "
            "`least` in "
            "retention="
        )
