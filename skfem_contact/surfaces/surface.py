"""Surfaces of bodies: facets with an outward side, in the plane and in space.

A facet is ``rho(xi) = sum_b M_b(xi) x_b`` with polynomials ``M_b`` of dim - 1 local coordinates
(eq. 18 of the paper). The outward normal is the tangent turned by +90 degrees in the plane (eq.
17), and the cross product of the two tangents in space.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis

from .shape import Shape, rule
from .topology import Numbers, arms_of, boundary, joined_cells, numbers_of
from .vectors import across, unit

#: A surface continues beyond its rim for this share of its last facet: a slave corner that starts
#: flush with the master's end must not lose contact to the lateral strain of the bodies.
EXTENSION = 0.05
#: Square of the cosine of the angle to a normal from which on an axis is no direction along a
#: facet.
_NORMAL = 0.8


class FacetMapping(NamedTuple):
    """Mapping of facets at points: shape functions of the nodes, coordinates, and derivatives of
    both.
    """

    shapes: list[ndarray]
    x: list[ndarray]

    @property
    def normal(self) -> ndarray:
        """Outward unit normals, (n, dim)."""
        return unit(across(self.x[1]))


@dataclass(frozen=True, eq=False)
class Surface:
    """Facets of a boundary, of a beam or shell, or of a rigid obstacle.

    The displacement of a node is ``x[dofs] + arms @ x[rotations]``.

    Attributes
    ----------
    name : str
        Name of the boundary, for messages.
    dofs : ndarray, shape (n_nodes, dim)
        Displacement dofs of the nodes; -1 where they are rigid.
    nodes : ndarray, shape (n_nodes, dim)
        Reference coordinates of the nodes.
    facets : ndarray, shape (n_facets, k)
        Node numbers of every facet; in the plane in the order of the chain.
    neighbours : ndarray, shape (n_facets, n_sides)
        Facets beyond the sides of every facet, -1 beyond the rim.
    area : ndarray, shape (n_facets,)
        Area of the facets, or length in the plane, in the reference configuration.
    extension : float
        Share of a facet by which the surface continues beyond its rim.
    meshed : bool
        True if elements adjoin the facets, from whose stiffness a penalty can be chosen.
    stiffness : float, optional
        Traction per displacement of a surface without elements.
    rotations, arms : ndarray, shapes (n_nodes, q) and (n_nodes, dim, q), optional
        Dofs of rotations, -1 where they are held, and displacements of the nodes by unit rotations.
    unnumbered : tuple
        Pairs of ``"dofs"`` or ``"rotations"`` and the field in which these are numbers so far.

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
    meshed: bool = True
    stiffness: float | None = None
    rotations: ndarray | None = None
    arms: ndarray | None = None
    unnumbered: tuple[tuple[str, Hashable], ...] = ()

    @classmethod
    def from_boundary(cls, basis: CellBasis, name: str) -> Surface:
        """Return the facets of a named boundary of the basis' mesh, in the plane a single chain."""
        dofs, nodes, facets, neighbours = boundary(basis, name)
        return cls.of(name, dofs, nodes, facets, Shape.of_facets(basis.elem.elem), neighbours)

    @classmethod
    def from_cells(
        cls,
        coordinates: ArrayLike,
        dofs: Numbers,
        cells: ArrayLike,
        name: str = "surface",
        *,
        rotations: Numbers | None = None,
        thickness: float = 0.0,
        about: ArrayLike | None = None,
        stiffness: float | None = None,
    ) -> Surface:
        """Return a surface whose nodes have dofs of their own: of a beam, a shell or a rigid body.

        Parameters
        ----------
        coordinates : ndarray, shape (n_nodes, dim)
            Coordinates of the nodes, for beams and shells on the axis or middle surface.
        dofs : ndarray or (Field, ndarray), shape (n_nodes, dim)
            Global dofs of the displacements, or their numbers in a field that the model numbers;
            -1: held.
        cells : ndarray, shape (n_cells, k)
            Nodes of the facets, corners first.  The free side lies to the left of the way from the
            first to the second node in the plane, and where the corners go round anticlockwise in
            space.
        name : str
            Name for messages.
        rotations : ndarray or (Field, ndarray), shape (n_nodes,) or (n_nodes, 3), optional
            Dofs of small rotations, given like `dofs`.
        thickness : float
            Thickness of the beam or shell: the surface lies half of it off the nodes.
        about : array_like, shape (dim,) or (n_nodes, dim), optional
            Points about which the rotations turn: the centre of a rigid body; by default the nodes
            themselves.
        stiffness : float, optional
            Traction per displacement of the surface, for the default penalty; by default the other
            surface decides.

        Examples
        --------
        A beam of two elements above ground, with dofs 100 to 108:

        >>> import numpy as np
        >>> from skfem_contact import Surface
        >>> numbers = 100 + np.arange(9).reshape(3, 3)
        >>> beam = Surface.from_cells([[0., 1.], [1., 1.], [2., 1.]], numbers[:, :2], [[2, 1], [1, 0]], "beam",
        ...                           rotations=numbers[:, 2], thickness=.2)
        >>> beam.nodes[:, 1].tolist(), beam.arms[0, :, 0].round(12).tolist()      # its lower side
        ([0.9, 0.9, 0.9], [0.1, 0.0])
        """
        nodes, facets, neighbours, shape = joined_cells(coordinates, cells, name)
        n, dim = nodes.shape
        parts = {"dofs": (dofs, (n, dim)), "rotations": (rotations, (n, 1 if dim == 2 else 3))}
        given = {
            part: numbers_of(value, size, f"'{name}': {part}")
            for part, (value, size) in parts.items()
            if value is not None
        }
        surface = cls.of(name, given["dofs"][0], nodes, facets, shape, neighbours)
        if thickness:
            surface = cls.of(
                name,
                surface.dofs,
                nodes + 0.5 * thickness * surface.normals,
                facets,
                shape,
                neighbours,
            )
        arms = (
            None
            if rotations is None
            else arms_of(surface.nodes - (nodes if about is None else np.asarray(about)))
        )
        return replace(
            surface,
            meshed=False,
            stiffness=stiffness,
            arms=arms,
            rotations=None if rotations is None else given["rotations"][0],
            unnumbered=tuple(
                (part, field) for part, (_, field) in given.items() if field is not None
            ),
        )

    @classmethod
    def of(
        cls,
        name: str,
        dofs: ndarray,
        nodes: ndarray,
        facets: ndarray,
        shape: Shape,
        neighbours: ndarray,
    ) -> Surface:
        """Return a surface from its facets, with their areas; facets without area are refused."""
        surface = cls(name, dofs, nodes - nodes[0], facets, shape, neighbours, np.ones(len(facets)))
        xi, weight = rule(shape, 5)
        everywhere = np.repeat(np.arange(len(facets)), len(weight)), np.tile(xi, (len(facets), 1))
        area = surface.density(*everywhere).reshape(len(facets), -1) @ weight
        if (flat := area <= 0.0).any():
            centres = nodes[facets[flat]].mean(axis=1)[:3].round(6).tolist()
            raise ValueError(f"'{name}': facets without area at {centres}")
        return replace(surface, nodes=nodes, area=area)

    def with_facets(self, facets: ndarray, shape: Shape, neighbours: ndarray) -> Surface:
        """Return other facets between the same nodes."""
        new = Surface.of(self.name, self.dofs, self.nodes, facets, shape, neighbours)
        return replace(self, facets=facets, shape=shape, neighbours=neighbours, area=new.area)

    @property
    def fields(self) -> tuple[Hashable, ...]:
        """Fields that have not been numbered yet."""
        return tuple(field for _, field in self.unnumbered)

    def numbered(self, numbers: Mapping[Any, ndarray]) -> Surface:
        """Return the surface with global dofs, numbers[field] : ndarray, shape (n,)."""
        new: dict[str, Any] = {}
        for part, field in self.unnumbered:
            local = getattr(self, part)
            new[part] = np.where(local < 0, -1, np.asarray(numbers[field])[local.clip(0)])
        return replace(self, unnumbered=(), **new) if new else self

    @cached_property
    def all_dofs(self) -> ndarray:
        """Dofs of the surface, ascending, rotations included; -1 among them for rigid nodes."""
        if self.fields:
            return np.zeros(0, int)
        return np.unique(
            self.dofs if self.rotations is None else np.hstack((self.dofs, self.rotations))
        )

    @property
    def end(self) -> int:
        """Number after the last dof."""
        return int(self.all_dofs.max(initial=-1)) + 1

    def dofs_of(self, nodes: ndarray) -> ndarray:
        """Return the displacement dofs of nodes, shape (n, k, dim), -1 where a node is -1."""
        if nodes.min(initial=0) < 0:
            return np.where((nodes < 0)[:, :, None], -1, self.dofs[nodes])
        return self.dofs[nodes]

    def levers(self, nodes: ndarray) -> tuple[ndarray, ndarray]:
        """Return the rotations that move nodes, shape (n, q), and how they do, shape (n, k dim,
        q).
        """
        n, k = nodes.shape
        if self.arms is None or self.rotations is None:
            return np.zeros((n, 0), int), np.zeros((n, k * self.dim, 0))
        q = self.arms.shape[2]
        lever = np.zeros((n, k, self.dim, k, q))
        lever[:, np.arange(k), :, np.arange(k)] = self.arms[nodes].transpose(1, 0, 2, 3)
        dofs = np.where((nodes < 0)[:, :, None], -1, self.rotations[nodes])
        return dofs.reshape(n, k * q), lever.reshape(n, k * self.dim, k * q)

    @property
    def dim(self) -> int:
        """Number of dimensions, 2 or 3."""
        return self.nodes.shape[1]

    @property
    def closed(self) -> bool:
        """True if the surface has no rim."""
        return bool((self.neighbours >= 0).all())

    @property
    def rigid(self) -> bool:
        """True if no dof moves the surface."""
        return bool(
            (self.dofs < 0).all() and (self.rotations is None or (self.rotations < 0).all())
        )

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
    def centres(self) -> FacetMapping:
        """The facets' centres in the reference configuration."""
        m = len(self.facets)
        return self.at(np.arange(m), np.tile(self.shape.centre, (m, 1)), self.nodes)

    @cached_property
    def normals(self) -> ndarray:
        """Unit normals at the nodes, means of those of the facets there by area, shape (n_nodes,
        dim).
        """
        m, k = self.facets.shape
        normal = self.at(
            np.repeat(np.arange(m), k), np.tile(self.shape.nodes, (m, 1)), self.nodes
        ).normal
        total = np.zeros(self.nodes.shape)
        np.add.at(total, self.facets.ravel(), normal * np.repeat(self.area, k)[:, None])
        return unit(total)

    @cached_property
    def directions(self) -> ndarray:
        """Axes most nearly along the surface, for the facets' tangents in space; another one where
        this is normal.
        """
        squares = self.centres.normal**2
        axis = np.argmin(np.round(self.area @ squares / self.area.sum(), 6))
        return np.eye(self.dim)[
            np.where(squares[:, axis] > _NORMAL, np.argmin(np.round(squares, 6), axis=1), axis)
        ]

    @cached_property
    def at_rim(self) -> ndarray:
        """Sides of the facets without a neighbour, shape (n_facets, n_sides)."""
        return self.neighbours < 0

    @cached_property
    def reach(self) -> ndarray:
        """Extension of the facets beyond the rim in local coordinates, shape (n_facets,
        n_sides).
        """
        return 2.0 * self.extension * self.at_rim

    @cached_property
    def rank(self) -> ndarray:
        """Ranks of the facets at a side, shape (n_facets, n_sides): a point at a joint belongs to
        the larger one.
        """
        if self.dim == 2:
            return np.tile([0.0, 1.0], (len(self.facets), 1))
        m, sides = self.neighbours.shape
        return np.repeat(1.0 - np.arange(m)[:, None] / m, sides, axis=1)

    def facing(self, slave: Surface) -> Surface:
        """Return the surface extended off its rim by a share of the slave's facets, or of its own
        if smaller.
        """
        if self.closed:
            return self
        last = float(self.size[self.at_rim.any(axis=1)].max())
        return replace(self, extension=EXTENSION * min(1.0, slave.spacing / last))

    def positions(self, x: ndarray | None, origin: ndarray | float = 0.0) -> ndarray:
        """Return the coordinates of the nodes at displacements x or None, from an origin, shape
        (n_nodes, dim).
        """
        if x is None:
            return np.asarray(self.nodes - origin + 0.0)
        if self.fields:
            raise ValueError(
                f"the dofs of '{self.name}' are not numbered yet: use the pair that the model holds"
            )
        moved = np.where(self.dofs >= 0, x.take(self.dofs), 0.0)
        if self.arms is not None and self.rotations is not None:
            turns = np.where(self.rotations >= 0, x.take(self.rotations), 0.0)
            moved += np.einsum("ncq,nq->nc", self.arms, turns)
        return np.asarray(self.nodes - origin + moved)

    def at(self, facet: ndarray, xi: ndarray, nodes: ndarray, derivatives: int = 1) -> FacetMapping:
        """Return points given by facet, shape (n,), and local coordinates, shape (n, dim - 1), at
        present nodes.
        """
        shapes = self.shape.at(facet, xi, derivatives)
        coordinates = nodes.take(
            self.facets.take(facet, axis=0), axis=0
        )  # a fourth of the time of indexing
        return FacetMapping(shapes, [_combined(M, coordinates) for M in shapes])

    def density(self, facet: ndarray, xi: ndarray) -> ndarray:
        """Return the area of a unit of the local coordinates in the reference configuration, shape
        (n,).
        """
        return np.asarray(np.linalg.norm(across(self.at(facet, xi, self.nodes).x[1]), axis=1))


def _combined(factors: ndarray, coordinates: ndarray) -> ndarray:
    """Return combinations of the nodes' coordinates, (n, k, dim), with factors (n, ..., k).

    For derivatives in space matrix products take a quarter of the time of `einsum`, for all others
    three times as long.
    """
    if factors.ndim == 2 or coordinates.shape[2] == 2:
        return np.asarray(np.einsum("n...k,nkc->n...c", factors, coordinates))
    n, *among, k = factors.shape
    rows = factors.reshape(n, int(np.prod(among)), k)
    return np.asarray((rows @ coordinates).reshape(n, *among, coordinates.shape[2]))
