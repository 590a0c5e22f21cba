"""Surfaces of bodies: named boundaries as facets that know their outward side, in the plane and in space.

A facet is ``rho(xi) = sum_b M_b(xi) x_b`` with polynomials ``M_b`` of dim - 1 local coordinates (eq. 18 of the paper,
with the orientation of eq. 17: in the plane ``xi = -1`` at the first node).  Its nodes are ordered so that the outward
normal is the tangent turned by +90 degrees in the plane, and the cross product of the two tangents in space.
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from skfem import CellBasis

from ..errors import check_basis, facets_of
from .shape import Shape
from .topology import adjacent, following, ordered
from .vectors import across, unit

#: A surface goes on beyond its rim for this share of its last facet: a slave corner that starts flush with
#: the master's end must not lose contact to the lateral strain of the bodies.
EXTENSION = 0.05
#: Square of the cosine of the angle to a normal from which on an axis is no direction along a facet.
_NORMAL = 0.8


class Place(NamedTuple):
    """Points of a surface.

    Attributes
    ----------
    shapes
        Shape functions of the facets' nodes and their derivatives: (n, k), (n, dim - 1, k), ...
    x
        Places and their derivatives: (n, dim), (n, dim - 1, dim), ...
    """

    shapes: list[ndarray]
    x: list[ndarray]

    @property
    def normal(self) -> ndarray:
        """Outward unit normals, (n, dim)."""
        return unit(across(self.x[1]))


@dataclass(frozen=True, eq=False)
class Surface:
    """Facets on the boundary of a body.

    Attributes
    ----------
    name
        Name of the boundary, for messages.
    dofs
        Displacement unknowns of its nodes, (n_nodes, dim); -1 where they are rigid.
    nodes
        Reference coordinates of its nodes, (n_nodes, dim).
    facets
        Node numbers of every facet, (n_facets, k); in the plane in the order of the chain.
    shape
        Their shape functions.
    neighbours
        Facets beyond the sides of every facet, -1 beyond the rim, (n_facets, n_sides).
    area
        Area of the facets, or length in the plane, in the reference configuration, (n_facets,).
    extension
        Share of a facet by which the surface goes on beyond its rim.
    axisymmetric
        Whether what it carries counts per radian about the axis x = 0.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> from skfem_contact import Surface
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()))
    >>> top = Surface.from_boundary(basis, "top")
    >>> len(top.facets), top.closed, round(float(top.area.sum()), 12)
    (4, False, 1.0)
    """

    name: str
    dofs: ndarray
    nodes: ndarray
    facets: ndarray
    shape: Shape
    neighbours: ndarray
    area: ndarray
    extension: float = EXTENSION
    axisymmetric: bool = False

    @classmethod
    def from_boundary(cls, basis: CellBasis, name: str) -> Surface:
        """The facets of a named boundary of the basis' mesh.

        Raises
        ------
        ValueError
            Unknown or empty boundary, facets inside the mesh; a boundary that is no single chain in the plane, and in
            space one with edges that belong to more than two facets.
        """
        check_basis(basis)
        mesh = basis.mesh
        facets = np.unique(facets_of(mesh, name))
        if (mesh.f2t[1, facets] >= 0).any():
            raise ValueError(f"boundary '{name}' lies inside the mesh: its facets have elements on both sides; "
                             "separate the bodies with join_bodies")
        corners = _outward(mesh.p, mesh.t, mesh.facets[:, facets], mesh.f2t[0, facets])
        if mesh.dim() == 2:
            order = ordered(corners, name)
            facets, corners = facets[order], corners[:, order]
            neighbours = following(len(facets), bool(corners[0, 0] == corners[1, -1]))
        else:
            neighbours = adjacent(corners.T, name)
        dofs = _unknowns(basis, facets, corners)
        unique, numbers = np.unique(dofs[..., 0], return_inverse=True)
        at_nodes = unique[:, None] + np.arange(mesh.dim())
        return cls.of(name, at_nodes, basis.doflocs[:, unique].T.copy(), numbers.reshape(len(facets), -1),
                      Shape.of_facets(basis.elem.elem), neighbours)

    @classmethod
    def of(cls, name: str, dofs: ndarray, nodes: ndarray, facets: ndarray, shape: Shape, neighbours: ndarray
           ) -> Surface:
        """A surface from its facets; their areas are computed.

        Raises
        ------
        ValueError
            Facets without area.
        """
        surface = cls(name, dofs, nodes - nodes[0], facets, shape, neighbours, np.ones(len(facets)))
        xi, weight = rule(shape, 5)
        everywhere = np.repeat(np.arange(len(facets)), len(weight)), np.tile(xi, (len(facets), 1))
        area = surface.density(*everywhere).reshape(len(facets), -1) @ weight
        if (flat := area <= 0.0).any():
            places = nodes[facets[flat]].mean(axis=1)[:3].round(6).tolist()
            raise ValueError(f"'{name}': facets without area at {places}")
        return replace(surface, nodes=nodes, area=area)

    @property
    def dim(self) -> int:
        """Number of dimensions, 2 or 3."""
        return self.nodes.shape[1]

    @property
    def closed(self) -> bool:
        """Whether it has no rim."""
        return bool((self.neighbours >= 0).all())

    @property
    def rigid(self) -> bool:
        """Whether no unknown moves it."""
        return bool((self.dofs < 0).all())

    @cached_property
    def size(self) -> ndarray:
        """Length of the facets' sides, (n_facets,): the length of a facet in the plane."""
        if self.dim == 2:
            return self.area
        return np.asarray(np.sqrt(self.area * (2.0 if self.shape.triangular else 1.0)))

    @cached_property
    def spacing(self) -> float:
        """Size of a typical facet, the median of all."""
        return float(np.median(self.size))

    @cached_property
    def middle(self) -> ndarray:
        """Mean of the nodes in the reference configuration, (dim,)."""
        return np.asarray(self.nodes.mean(axis=0))

    @cached_property
    def centres(self) -> Place:
        """The facets' centres in the reference configuration."""
        m = len(self.facets)
        return self.at(np.arange(m), np.tile(self.shape.centre, (m, 1)), self.nodes)

    @cached_property
    def directions(self) -> ndarray:
        """Axes from which the facets' tangents are counted in space, (n_facets, dim).

        It is the one that lies most nearly along the surface; facets that it is normal to have another one.
        """
        squares = self.centres.normal**2
        axis = np.argmin(np.round(self.area @ squares / self.area.sum(), 6))
        return np.eye(self.dim)[np.where(squares[:, axis] > _NORMAL, np.argmin(np.round(squares, 6), axis=1), axis)]

    @cached_property
    def at_rim(self) -> ndarray:
        """Sides of the facets without a neighbour, (n_facets, n_sides)."""
        return self.neighbours < 0

    @cached_property
    def reach(self) -> ndarray:
        """How far the facets go on beyond their sides in local coordinates, (n_facets, n_sides): only at the rim."""
        return 2.0 * self.extension * self.at_rim

    @cached_property
    def rank(self) -> ndarray:
        """Which of the facets at a side a point there belongs to, (n_facets, n_sides): the one of the largest.

        In the plane it is the one before, in space the one of the lowest number.
        """
        if self.dim == 2:
            return np.tile([0.0, 1.0], (len(self.facets), 1))
        m, sides = self.neighbours.shape
        return np.repeat(1.0 - np.arange(m)[:, None] / m, sides, axis=1)

    def facing(self, slave: Surface) -> Surface:
        """The surface as a slave meets it: off its rim it goes on for a share of the slave's facets, if smaller.

        The table of a single facet does not reach farther beyond its edge than one of many facets.
        """
        if self.closed:
            return self
        last = float(self.size[self.at_rim.any(axis=1)].max())
        return replace(self, extension=EXTENSION * min(1.0, slave.spacing / last))

    def positions(self, x: ndarray | None, origin: ndarray | float = 0.0) -> ndarray:
        """Coordinates of the nodes at the displacements x, None for none, seen from an origin, (n_nodes, dim)."""
        moved = 0.0 if x is None else np.where(self.dofs >= 0, x.take(self.dofs), 0.0)
        return np.asarray(self.nodes - origin + moved)

    def at(self, facet: ndarray, xi: ndarray, nodes: ndarray, derivatives: int = 1) -> Place:
        """Points given by facet, (n,), and local coordinates, (n, dim - 1), where the nodes are now."""
        shapes = self.shape.at(facet, xi, derivatives)
        places = nodes[self.facets[facet]]
        return Place(shapes, [np.einsum("n...k,nkc->n...c", M, places) for M in shapes])

    def density(self, facet: ndarray, xi: ndarray) -> ndarray:
        """Area of a unit of the local coordinates in the reference configuration, (n,)."""
        return np.asarray(np.linalg.norm(across(self.at(facet, xi, self.nodes).x[1]), axis=1))


@lru_cache
def gauss_points(n: int) -> tuple[ndarray, ndarray]:
    """Gauss points from -1 to 1 and their weights; pieces of facets ask for them in every iteration."""
    t, w = np.polynomial.legendre.leggauss(n)
    t.flags.writeable = w.flags.writeable = False
    return t, w


def rule(shape: Shape, n: int) -> tuple[ndarray, ndarray]:
    """Points (q, dim - 1) and weights, all positive, of a rule with n Gauss points a direction.

    It is exact to the degree 2n - 1; on triangles to 2n - 2, that of two shape functions' product: rules of the degrees
    3 and 7 have points of negative area.
    """
    t, w = gauss_points(n)
    if shape.dim == 1:
        return t[:, None], w
    if shape.triangular:
        from skfem.quadrature import get_quadrature
        from skfem.refdom import RefTri

        points, weights = get_quadrature(RefTri, max(1, 2 * n - 2))
        return points.T, weights
    return np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2), np.outer(w, w).ravel()


def _outward(p: ndarray, t: ndarray, corners: ndarray, element: ndarray) -> ndarray:
    """Turn every facet so that its element's centroid lies inside (nothing else tells its side)."""
    x = p[:, corners].transpose(2, 1, 0)  # (n, corners, dim)
    inward = p[:, t[:, element]].mean(axis=1).T - x[:, 0]
    tangents = x[:, [1]] - x[:, [0]] if len(p) == 2 else np.stack((x[:, 1] - x[:, 0], x[:, -1] - x[:, 0]), axis=1)
    inside_out = np.einsum("nc,nc->n", across(tangents), inward) > 0
    return np.where(inside_out, corners[::-1], corners)


def _unknowns(basis: CellBasis, facets: ndarray, corners: ndarray) -> ndarray:
    """Displacement unknowns of the facets' nodes, (n_facets, k, dim): corners, edges in space, the facet itself."""
    mesh, dim = basis.mesh, basis.mesh.dim()
    dofs = [basis.nodal_dofs[:, corners]]
    if dim == 3 and len(basis.edge_dofs):
        n = np.int64(mesh.p.shape[1])
        ends = np.sort(np.stack((corners, np.roll(corners, -1, axis=0))), axis=0)
        key = mesh.edges.min(axis=0) * n + mesh.edges.max(axis=0)
        order = np.argsort(key)
        edge = order[np.searchsorted(key[order], ends[0] * n + ends[1])]
        dofs.append(basis.edge_dofs[:dim, edge])
    if basis.facet_dofs is not None and len(basis.facet_dofs):
        dofs.append(basis.facet_dofs[:dim, facets][:, None])
    return np.asarray(np.concatenate(dofs, axis=1).transpose(2, 1, 0))
