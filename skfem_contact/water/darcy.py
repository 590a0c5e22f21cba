"""Darcy's law on a mesh: permeability, and the flow for given heads."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Literal, TypeVar

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix, csr_matrix
from skfem import Basis, CellBasis, FacetBasis

from ..checks import format_point, look_up, tags_with
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
_DRY = 0.01
_WET = 0.5
#: Share of the flow through dry ground from which a warning is given.
_SHARE = 0.05


def regions(basis: CellBasis, values: T | Mapping[str, T], what: str) -> list[tuple[ndarray, T]]:
    """Return elements of a basis and their value, given for all or by subdomain."""
    here = elements_of(basis)
    if not isinstance(values, Mapping):
        return [(np.arange(len(here)), values)]
    # Count the values that every element is given.
    subdomains = basis.mesh.subdomains or {}
    count = np.zeros(len(here), dtype=int)
    result = []
    for name, value in values.items():
        part = np.flatnonzero(np.isin(here, look_up(name, subdomains, "subdomain")))
        count[part] += 1
        result.append((part, value))
    # Refuse elements with none or several.
    for wrong, text in ((count == 0, f"have no {what}"), (count > 1, f"have more than one {what}")):
        if wrong.any():
            names = tags_with(here[wrong], subdomains)
            raise ValueError(f"{wrong.sum()} elements {text}; they lie in the subdomains {names}")
    return result


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
    values: list[float] = []
    # Collect the principal values of all tensors.
    for part, value in regions(basis, permeability, "permeability"):
        tensor = _tensor(value, dim)
        tensors[part] = tensor
        if len(part):
            values += np.linalg.eigvalsh(tensor).tolist()
    # Refuse contrasts that round-off would hide.
    least = min(values)
    most = max(values)
    if most > _MOST * least:
        raise ValueError(
            f"the permeabilities from {least:.3g} to {most:.3g} are too far apart: round-off would "
            "hide the flow through the tightest ground; leave that out of the basis"
        )
    return tensors


def _tensor(value: object, dim: int) -> ndarray:
    # Anything that is no array of numbers is refused below.
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        array = np.full(0, np.nan)
    if array.shape not in ((), (dim,), (dim, dim)):
        raise ValueError(
            f"a permeability is a number, {dim} numbers along the axes or a tensor ({dim}, {dim}), "
            f"not {value!r}"
        )
    # A number or one for each axis is a diagonal tensor.
    tensor = array if array.ndim == 2 else array * np.eye(dim)
    symmetric = np.isfinite(tensor).all() and np.allclose(tensor, tensor.T, rtol=1e-12, atol=0.0)
    if not symmetric or np.linalg.eigvalsh(tensor).min() <= 0.0:
        raise ValueError(
            f"a permeability must be positive and finite in all directions, not {value!r}; leave "
            "elements that no water enters out of the basis"
        )
    return tensor


def head_basis(basis: CellBasis, order: int = 2) -> CellBasis:
    """Return the linear basis of heads on the elements of a basis, one dof at each vertex."""
    element = linear_element(basis.mesh)
    return Basis(basis.mesh, element, intorder=order, elements=elements_of(basis))


def radius(basis: CellBasis | FacetBasis, axisymmetric: bool) -> ndarray | float:
    """Return the distance from the axis x = 0 at integration points in axial symmetry, else 1."""
    if not axisymmetric:
        return 1.0
    x = np.asarray(basis.global_coordinates())[0]
    if (x < 0.0).any():
        raise ValueError(
            f"axial symmetry needs x >= 0, but there are elements at x = {x.min():.4g}"
        )
    return x


class DarcyFlow:
    """Flow of water through a :func:`head_basis` with a permeability, (n_elements, dim, dim).

    Heads and elevations, the last coordinates of the nodes, count from a datum: near it, for the
    sake of round-off.
    """

    def __init__(
        self,
        basis: CellBasis,
        tensors: ndarray,
        axisymmetric: bool = False,
        datum: float = 0.0,
    ) -> None:
        functions = [basis.basis[j][0] for j in range(basis.Nbfun)]
        shapes = [np.broadcast_to(np.asarray(f), basis.dx.shape)[0] for f in functions]
        self._gradients = np.stack([np.asarray(f.grad) for f in functions])  # (a, dim, n, n_q)
        self._shape = np.stack(shapes, axis=1)  # (n_points, a)
        self.basis = basis
        self.axisymmetric = axisymmetric
        self.datum = datum
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
        #: (n_elements, n_corners): volume of ground that belongs to each corner
        self.corners = self._weight @ self._shape
        n_corners = self.dofs.shape[1]
        self._rows = np.repeat(self.dofs, n_corners, axis=1).ravel()
        self._columns = np.tile(self.dofs, n_corners).ravel()

    @cached_property
    def saturated(self) -> csr_matrix:
        """Tangent of saturated ground, (N, N), symmetric."""
        whole = np.ones_like(self._weight)
        return DarcyFlow.tangent(self, self.elevation, whole, np.zeros(1))

    def relative(self, head: ndarray, laws: Laws) -> tuple[ndarray, ndarray]:
        """Return the relative permeability at the points and its slope over the heads."""
        suction = (self.elevation - head)[self.dofs] @ self._shape.T
        relative, slope = self._by_laws(laws, "relative", suction)
        return relative, -slope[:, :, None] * self._shape

    def filled(self, head: ndarray, laws: Laws) -> tuple[ndarray, ndarray]:
        """Return the effective saturation and its slope, (n_elements, n_corners)."""
        return self._by_laws(laws, "saturation", (self.elevation - head)[self.dofs])

    def _by_laws(
        self,
        laws: Laws,
        curve: Literal["relative", "saturation"],
        suction: ndarray,
    ) -> tuple[ndarray, ndarray]:
        """Return the values of a curve of the laws and their slopes over suctions."""
        values = np.ones_like(suction)
        slope = np.zeros_like(suction)
        for part, conductivity in laws:
            found = getattr(conductivity, curve)(suction[part], self._size[part])
            values[part], slope[part] = found
        return values, slope

    def gathered(self, corners: ndarray) -> ndarray:
        """Return the integral around each node of values at the corners, (N,)."""
        return np.bincount(
            self.dofs.ravel(), (self.corners * corners).ravel(), minlength=len(self.elevation)
        )

    def moved(self, head: ndarray, change: ndarray, laws: Laws) -> ndarray:
        """Return the heads after a change; nodes stop at the free surface before they cross it."""
        new = head + change
        z = self.elevation
        if laws:
            return np.where((head - z) * (new - z) < 0.0, z, new)
        return new

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
        largest = np.abs(head[self.dofs]).max(axis=1)[:, None]
        element = np.einsum("eq,eqaa->ea", relative, self._conductance) * largest
        return _ROUND_OFF * np.bincount(self.dofs.ravel(), element.ravel(), minlength=len(head))

    def by_corner(self, relative: ndarray, slope: ndarray, head: ndarray) -> ndarray:
        """Return the derivative of the inflow, (n_elements, n_corners, n_corners)."""
        element = np.einsum("eq,eqab->eab", relative, self._conductance)
        if slope.any():
            through = np.einsum("eqab,eb->eqa", self._conductance, head[self.dofs])
            element += np.einsum("eqa,eqb->eab", through, slope)
        return np.asarray(element)

    def tangent(self, head: ndarray, relative: ndarray, slope: ndarray) -> csr_matrix:
        """Return the derivative of the inflow over the heads, (N, N)."""
        n = len(head)
        values = self.by_corner(relative, slope, head).ravel()
        return coo_matrix((values, (self._rows, self._columns)), shape=(n, n)).tocsr()

    def velocity(self, head: ndarray, relative: ndarray) -> ndarray:
        """Return the mean discharge of the elements per area of ground, (dim, n_elements)."""
        gradient = np.einsum("aieq,ea->ieq", self._gradients, head[self.dofs])
        weight = self._weight * relative / self._weight.sum(axis=1, keepdims=True)
        return -np.einsum("eij,jeq,eq->ie", self._tensors, gradient, weight)


def warn_of_dry_ground(
    basis: CellBasis,
    tensors: ndarray,
    relative: ndarray,
    velocity: ndarray,
) -> None:
    """Report water that flows off through dry ground that conducts better than wet ground."""
    # A dam whose core is 1e-2, 1e-3, 1e-4 and 1e-6 times as permeable as its shell leaks .6, .7, -5
    # and -7 % too much with 20 elements over the height if dry ground keeps 1e-3 of its
    # permeability. In the last two cases .26 of the flow is of this kind; where the discharge is
    # right to 1 % less than .005 is.
    k = np.trace(tensors, axis1=1, axis2=2) / basis.mesh.dim()
    wet = (relative >= _WET).any(axis=1)
    dry = (relative < _DRY).all(axis=1)
    remaining = relative.min(axis=1) * k
    draining = dry & (remaining > 1.5 * k[wet].min(initial=np.inf))
    flow = np.linalg.norm(velocity, axis=0) * basis.dx.sum(axis=1)
    if flow[draining].sum() <= _SHARE * flow.sum():
        return
    strongest = np.where(draining, flow, 0.0).argmax()
    x = np.asarray(basis.global_coordinates())[:, strongest].mean(axis=1)
    warn(
        f"water flows off through dry ground at {format_point(x)}, which conducts better than the "
        "wet ground from which it comes: the free surface there is several per cent off; leave "
        "drained ground out of the basis and name the boundary towards it in seepage_face=, or "
        "give a smaller `least` in retention="
    )
