"""Layout of an analysis: displacements first, then whatever else forms bring; their places and rigid motions.

The displacements of a node follow each other, component by component: this file is where that is known.
"""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree
from skfem import CellBasis, Element, ElementHex1, ElementQuad1, ElementTetP1, ElementTriP1, Mesh

from .errors import finite, look_up, place

if TYPE_CHECKING:
    from .forms.base import Form

#: Linear elements by the numbers of dimensions and of corners.
_LINEAR = {(2, 3): ElementTriP1, (2, 4): ElementQuad1, (3, 4): ElementTetP1, (3, 8): ElementHex1}
#: A node lies at a place if it is nearer than this share of the mesh.
_AT = 1e-6


@dataclass(frozen=True, eq=False)
class Field:
    """Layout of one kind that a form brings, numbered behind those of another.

    Parameters
    ----------
    name
        What they are, such as ``"pore pressure"``: residuals are measured field by field.
    places
        Where they are, (dim, n): an elimination order and messages need to know.
    first
        Number of the first one: ``basis.N``, or the :attr:`end` of the field before.
    scale
        How much of the unknown goes with a unit of displacement: E/h for a pressure, 1/h for a rotation. Linear systems
        are solved in scaled unknowns: without it a direct solver pivots off its order.
    moves
        Whether they are motions, which :meth:`Result.reset` sets to zero: pressures are not.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.layout import Field
    >>> Field("pore pressure", np.zeros((2, 5)), first=18, scale=1e4).end
    23
    """

    name: str
    places: ndarray
    first: int
    scale: float = 1.0
    moves: bool = True

    @property
    def end(self) -> int:
        """Number of the unknown behind the last one."""
        return self.first + self.places.shape[1]

    @property
    def numbers(self) -> ndarray:
        """Numbers of its unknowns."""
        return np.arange(self.first, self.end)


@dataclass(frozen=True, eq=False)
class Layout:
    """All unknowns of an analysis: its fields in their order, without gaps; the first are the displacements."""

    fields: tuple[Field, ...]

    @classmethod
    def of(cls, displacements: ndarray, fields: Iterable[Field]) -> Layout:
        """Displacements at their places, (dim, N), and the fields that forms bring, which may leave no gap."""
        brought = {(field.name, field.first, field.end): field for field in fields}  # parts of the ground share theirs
        given = sorted(brought.values(), key=lambda field: field.first)
        known = [Field("displacement", displacements, 0)]
        for field in given:
            if field.first != known[-1].end:
                raise ValueError(f"the field '{field.name}' begins with unknown {field.first}, but '{known[-1].name}' "
                                 f"ends before {known[-1].end}: number one field behind the other")
            known.append(field)
        return cls(tuple(known))

    @property
    def size(self) -> int:
        """Number of all unknowns."""
        return self.fields[-1].end

    @property
    def places(self) -> ndarray:
        """Where they are, (dim, N)."""
        if len(self.fields) == 1:
            return self.fields[0].places
        return np.concatenate([field.places for field in self.fields], axis=1)

    @property
    def scale(self) -> ndarray | None:
        """Scales of all unknowns, (N,); None where there are displacements only."""
        if len(self.fields) == 1:
            return None
        return np.concatenate([np.full(field.end - field.first, field.scale) for field in self.fields])

    @property
    def brought(self) -> ndarray:
        """Layout that are no displacements."""
        return np.arange(self.fields[0].end, self.size)

    @property
    def parts(self) -> tuple[slice, ...]:
        """The fields as parts of a vector of unknowns."""
        return tuple(slice(field.first, field.end) for field in self.fields)


def nodes(basis: CellBasis) -> ndarray:
    """Nodes of all elements, (n_elements, n_nodes): corners, middles of edges and faces, centre."""
    dim = basis.mesh.dim()
    return np.asarray(basis.element_dofs[0::dim].T) // dim


def elements_of(basis: CellBasis) -> ndarray:
    """Numbers in the mesh of the elements of a basis, whole or restricted, (n_elements,)."""
    return np.arange(basis.mesh.nelements) if basis.tind is None else np.asarray(basis.tind)


def first_behind(basis: CellBasis, after: Form | None) -> int:
    """Number of the first unknown behind the displacements, or behind those that another form brings."""
    return int(basis.N) if after is None or not after.fields else after.fields[-1].end


def linear_element(mesh: Mesh) -> Element:
    """The linear element of a mesh, straight or curved: one unknown at each vertex."""
    return _LINEAR[mesh.dim(), len(mesh.t)]()


def _first_unknowns(basis: CellBasis, part: str | None) -> ndarray:
    """Layout of the first component at all nodes, or at those of a subdomain."""
    elements = slice(None) if part is None else look_up(part, basis.mesh.subdomains or {}, "subdomain")
    return np.unique(basis.dofs.element_dofs[::basis.mesh.dim(), elements])


def dofs_at(basis: CellBasis, places: ArrayLike, part: str | None = None) -> ndarray:
    """Layout of the nodes at some places.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh.
    places
        Where the nodes are, (n, dim) or (dim,).
    part
        Subdomain to which they belong, where bodies touch and a place alone does not tell.

    Returns
    -------
    ndarray
        Layout of the components, (n, dim).

    Raises
    ------
    ValueError
        No node at a place, or several; places that are not finite.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> from skfem_contact.layout import dofs_at
    >>> dofs_at(Basis(MeshQuad(), ElementVector(ElementQuad1())), (1., 0.)).tolist()
    [[2, 3]]
    """
    dim = basis.mesh.dim()
    x = np.atleast_2d(finite(places, "places"))
    if x.ndim != 2 or x.shape[1] != dim:
        raise ValueError(f"places must be finite points of {dim} coordinates, not {places!r}")
    numbers = _first_unknowns(basis, part)
    tree, near = cKDTree(basis.doflocs[:, numbers].T), _AT * float(np.ptp(basis.doflocs, axis=1).max())
    for point, found in zip(x, tree.query_ball_point(x, near)):
        if len(found) != 1:
            at = place(basis.doflocs[:, numbers[tree.query(point)[1]]])
            raise ValueError(f"there are {len(found)} nodes at {place(point)}" + (
                "; tell by `part` which body is meant" if found else f"; the nearest one is at {at}"))
    return numbers[tree.query(x)[1]][:, None] + np.arange(dim)


def box_supports(basis: CellBasis, part: str | None = None, base: Literal["fixed", "rollers"] = "fixed") -> ndarray:
    """Layout that the supports of a box of ground hold: its base, and its sides across.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh; the last axis is upright.
    part
        Subdomain whose lowest nodes are the base and whose outermost ones are the sides; by default the whole mesh.
    base
        ``"fixed"``: nothing moves there; ``"rollers"``: the base holds upright only.

    Returns
    -------
    ndarray
        Layout, ascending.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().refined(1), ElementVector(ElementQuad1()))
    >>> len(sc.box_supports(basis)), len(sc.box_supports(basis, base="rollers"))      # of 18 unknowns
    (10, 9)
    """
    if base not in ("fixed", "rollers"):
        raise ValueError(f"base is 'fixed' or 'rollers', not {base!r}")
    dim = basis.mesh.dim()
    numbers = _first_unknowns(basis, part)
    x = basis.doflocs[:, numbers]
    near = _AT * float(np.ptp(basis.doflocs, axis=1).max())
    low, high = x.min(axis=1), x.max(axis=1)
    bottom = numbers[x[-1] < low[-1] + near]
    held = [bottom + (dim - 1)] if base == "rollers" else [bottom + c for c in range(dim)]
    held += [numbers[(x[c] < low[c] + near) | (x[c] > high[c] - near)] + c for c in range(dim - 1)]
    return np.unique(np.concatenate(held))


def rigid_modes(locations: ndarray, unknowns: ndarray) -> ndarray:
    """Small rigid motions of a body: translations, then rotations about its centre, scaled by its size.

    From the places of all unknowns, (dim, N), and the n numbers of the body's: displacements, (n, 3), in space (n, 6).

    Examples
    --------
    >>> import numpy as np
    >>> rigid_modes(np.array([[0., 0., 2., 2.], [0., 0., 0., 0.]]), np.arange(4))
    array([[ 1. ,  0. , -0. ],
           [ 0. ,  1. , -0.5],
           [ 1. ,  0. , -0. ],
           [ 0. ,  1. ,  0.5]])
    """
    x = locations[:, unknowns]
    dim = len(x)
    component = np.eye(dim)[unknowns % dim]
    centre = x.mean(axis=1, keepdims=True) if len(unknowns) else 0.0
    arm = ((x - centre) / max(float(np.ptp(locations)), 1e-300)).T
    planes = [(i, j) for i in range(dim) for j in range(i + 1, dim)]
    turns = [component[:, j] * arm[:, i] - component[:, i] * arm[:, j] for i, j in planes]
    return np.column_stack((component, *turns))
