"""Surfaces of bodies: facets with an outward side, in the plane and in space.

A facet is ``rho(xi) = sum_b M_b(xi) x_b`` with polynomials ``M_b`` of dim - 1 local coordinates
(eq. 18 of the paper). The outward normal is the tangent turned by +90 degrees in the plane (eq.
17), and the cross product of the two tangents in space.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis

from ..arrays import row_norms
from .shape import Shape, rule
from .topology import Numbers, arms_of, boundary, joined_cells, numbers_of
from .vectors import across, unit

#: A surface continues beyond its rim for this share of its last facet: a slave corner that starts
#: flush with the master's end must not lose contact to the lateral strain of the bodies.
EXTENSION = 0.05
#: Square of the cosine of the angle between an axis and a normal, above which it is no tangent.
_NORMAL = 0.8
#: Sum of the normals at a node, over that of parallel ones, below which facets lie back to back.
_OPPOSED = 1e-9


class FacetMapping(NamedTuple):
    """Mapping of facets at points: values and derivatives of the shapes and of the coordinates."""

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
    elements : ndarray, optional
        Elements of the mesh behind the facets, in any order; none of a surface without elements.
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
    elements: Sequence[int] | ndarray = ()
    unnumbered: tuple[tuple[str, Hashable], ...] = ()

    @classmethod
    def from_boundary(cls, basis: CellBasis, name: str) -> Surface:
        """Return the facets of a named boundary of the basis' mesh, in the plane a single chain."""
        dofs, nodes, facets, neighbours, elements = boundary(basis, name)
        shape = Shape.of_facets(basis.elem.elem)
        surface = cls.of(name, dofs, nodes, facets, shape, neighbours)
        return replace(surface, elements=elements)

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
        >>> axis = [[0., 1.], [1., 1.], [2., 1.]]
        >>> beam = Surface.from_cells(axis, numbers[:, :2], [[2, 1], [1, 0]], "beam",
        ...                           rotations=numbers[:, 2], thickness=.2)
        >>> beam.nodes[:, 1].tolist(), beam.arms[0, :, 0].round(12).tolist()      # its lower side
        ([0.9, 0.9, 0.9], [0.1, 0.0])
        """
        axis, facets, neighbours, shape = joined_cells(coordinates, cells, name)
        n, dim = axis.shape

        # separate numbers of dofs from the field in which they count
        numbers, field = numbers_of(dofs, (n, dim), f"'{name}': dofs")
        fields = [("dofs", field)]
        if rotations is not None:
            per_node = 3
            if dim == 2:
                per_node = 1
            turns, field = numbers_of(rotations, (n, per_node), f"'{name}': rotations")
            fields.append(("rotations", field))

        # move the facets off the axis
        surface = cls.of(name, numbers, axis, facets, shape, neighbours)
        if thickness:
            nodes = axis + 0.5 * thickness * surface.normals
            surface = cls.of(name, numbers, nodes, facets, shape, neighbours)

        unnumbered = tuple((part, field) for part, field in fields if field is not None)
        surface = replace(surface, meshed=False, stiffness=stiffness, unnumbered=unnumbered)
        if rotations is None:
            return surface
        centre = axis if about is None else np.asarray(about)
        return replace(surface, rotations=turns, arms=arms_of(surface.nodes - centre))

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
        m = len(facets)
        surface = cls(
            name,
            dofs,
            nodes - nodes[0],
            facets,
            shape,
            neighbours,
            np.ones(m),
        )
        # Integrate the density of area.
        xi, weight = rule(shape, 5)
        facet = np.repeat(np.arange(m), len(weight))
        density = surface.density(facet, np.tile(xi, (m, 1)))
        area = density.reshape(m, -1) @ weight
        flat = area <= 0.0
        if flat.any():
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
        if not self.unnumbered:
            return self
        new: dict[str, Any] = {}
        for part, field in self.unnumbered:
            local = getattr(self, part)
            own = np.asarray(numbers[field])
            new[part] = np.where(local < 0, -1, own[local.clip(0)])
        return replace(self, unnumbered=(), **new)

    @cached_property
    def all_dofs(self) -> ndarray:
        """Dofs of the surface, ascending, rotations included; -1 among them for rigid nodes."""
        if self.fields:
            return np.zeros(0, int)
        if self.rotations is None:
            return np.unique(self.dofs)
        return np.unique(np.hstack((self.dofs, self.rotations)))

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
        """Return rotations of nodes, shape (n, q), and displacements by them, (n, k dim, q)."""
        n, k = nodes.shape
        if self.arms is None or self.rotations is None:
            return np.zeros((n, 0), int), np.zeros((n, k * self.dim, 0))
        dim = self.dim
        q = self.arms.shape[2]
        missing = nodes < 0
        dofs = np.where(missing[:, :, None], -1, self.rotations[nodes])  # (n, k, q)
        # every node is moved by its own rotations alone
        arms = self.arms[nodes]  # (n, k, dim, q)
        lever = np.zeros((n, k, dim, k, q))
        for node in range(k):
            lever[:, node, :, node] = arms[:, node]
        return dofs.reshape(n, k * q), lever.reshape(n, k * dim, k * q)

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
        turns = self.rotations is not None and (self.rotations >= 0).any()
        return bool((self.dofs < 0).all()) and not turns

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
        xi = np.tile(self.shape.centre, (m, 1))
        return self.at(np.arange(m), xi, self.nodes)

    @cached_property
    def normals(self) -> ndarray:
        """Unit normals at the nodes: means over their facets, by area, shape (n_nodes, dim).

        At the tip of a slit, whose facets lie back to back, it is the normal of one of them.
        """
        m, k = self.facets.shape
        node = self.facets.ravel()
        facet = np.repeat(np.arange(m), k)
        xi = np.tile(self.shape.nodes, (m, 1))
        normal = self.at(facet, xi, self.nodes).normal
        area = np.repeat(self.area, k)
        # Sum normals by area, then normalise.
        total = np.zeros(self.nodes.shape)
        np.add.at(total, node, normal * area[:, None])
        around = np.bincount(node, area, minlength=len(total))
        opposed = (row_norms(total) <= _OPPOSED * around)[node]
        total[node[opposed]] = normal[opposed]
        return unit(total)

    @cached_property
    def directions(self) -> ndarray:
        """Axes along the facets, for their tangents in space, shape (n_facets, dim).

        The axis most nearly along the whole surface serves, but for facets nearly normal to it.
        """
        squares = self.centres.normal**2
        mean = self.area @ squares / self.area.sum()
        common = np.argmin(np.round(mean, 6))
        own = np.argmin(np.round(squares, 6), axis=1)
        axis = np.where(squares[:, common] > _NORMAL, own, common)
        return np.eye(self.dim)[axis]

    @cached_property
    def at_rim(self) -> ndarray:
        """Sides of the facets without a neighbour, shape (n_facets, n_sides)."""
        return self.neighbours < 0

    @cached_property
    def reach(self) -> ndarray:
        """Extension beyond the rim in local coordinates, shape (n_facets, n_sides)."""
        return 2.0 * self.extension * self.at_rim

    @cached_property
    def rank(self) -> ndarray:
        """Ranks of the facets at their sides, shape (n_facets, n_sides).

        A point at a joint belongs to the facet of the larger rank.
        """
        m, sides = self.neighbours.shape
        if self.dim == 2:
            return np.tile([0.0, 1.0], (m, 1))
        return np.repeat(1.0 - np.arange(m)[:, None] / m, sides, axis=1)

    def facing(self, slave: Surface) -> Surface:
        """Return the surface extended off its rim by a share of the smaller of both facets."""
        if self.closed:
            return self
        last = float(self.size[self.at_rim.any(axis=1)].max())
        return replace(self, extension=EXTENSION * min(1.0, slave.spacing / last))

    def positions(self, x: ndarray | None, origin: ndarray | float = 0.0) -> ndarray:
        """Return the nodes at displacements x or None, from an origin, shape (n_nodes, dim)."""
        if x is None:
            return np.asarray(self.nodes - origin + 0.0)
        if self.fields:
            raise ValueError(
                f"the dofs of '{self.name}' are not numbered yet: use the pair that the model holds"
            )
        # Fixed dofs are -1.
        moved = np.where(self.dofs >= 0, x.take(self.dofs), 0.0)
        if self.arms is not None and self.rotations is not None:
            # Rotations move the ends of arms: u += arm theta.
            turns = np.where(self.rotations >= 0, x.take(self.rotations), 0.0)
            moved += np.einsum("ncq,nq->nc", self.arms, turns)
        return np.asarray(self.nodes - origin + moved)

    def at(self, facet: ndarray, xi: ndarray, nodes: ndarray, derivatives: int = 1) -> FacetMapping:
        """Return the mapping at local coordinates, (n, dim - 1), of facets with given nodes."""
        shapes = self.shape.at(facet, xi, derivatives)
        # `take` needs a fourth of the time of indexing
        coordinates = nodes.take(self.facets.take(facet, axis=0), axis=0)  # (n, k, dim)
        return FacetMapping(shapes, [_combined(M, coordinates) for M in shapes])

    def density(self, facet: ndarray, xi: ndarray) -> ndarray:
        """Return reference area by unit of the local coordinates, shape (n,)."""
        tangents = self.at(facet, xi, self.nodes).x[1]
        return np.asarray(row_norms(across(tangents)))


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
