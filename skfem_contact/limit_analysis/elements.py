r"""Elements of both bounds: linear stresses that jump, and quadratic velocities that do not.

Both are operators :math:`B` from unknown velocities to strains times weight at the corners of straight triangles, so
that :math:`\sum \sigma : B v` is the power of the stresses (A. Makrodimopoulos, C. M. Martin, International Journal for
Numerical Methods in Engineering 66 (2006) 604-634; International Journal for Numerical and Analytical Methods in
Geomechanics 31 (2007) 835-865).  Components are xx, yy, xy; shear strains are engineering ones.
"""
from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy import ndarray
from skfem import MeshTri

from .triangles import facet_lengths

#: Corners at the ends of the three facets of a triangle.
_ENDS = ((0, 1), (1, 2), (0, 2))


class Elements(ABC):
    """What both kinds share.

    Attributes
    ----------
    n
        Number of unknown velocities.
    B
        Strains times weight by velocities, (n_elements, 3 corners, 3, n_local).
    dofs
        Unknowns of every triangle, (n_elements, n_local).
    places
        Where each unknown lives, (2, n).
    """

    n: int
    B: ndarray
    dofs: ndarray
    places: ndarray

    def __init__(self, mesh: MeshTri) -> None:
        self.mesh, self.lengths = mesh, facet_lengths(mesh)
        self.gradient, self.area = gradients(mesh)

    @abstractmethod
    def load(self, body: ndarray, facets: ndarray, tractions: ndarray) -> ndarray:
        """Power of body forces (n_elements, 2) and of tractions (n_facets, 2 ends, 2), linear on each facet, (n,)."""

    @abstractmethod
    def on_facets(self, facets: ndarray, turned: ndarray | None = None) -> ndarray:
        """Unknowns of facets, (n_facets, n_places, 2 components); the ends come first, exchanged where turned."""

    @abstractmethod
    def of_elements(self, elements: ndarray) -> ndarray:
        """All unknowns that act on some triangles."""

    @abstractmethod
    def rigid_motions(self, centre: ndarray) -> ndarray:
        """Unknowns of the motions of a rigid body: along x, along y and about a centre, (n, 3)."""

    @abstractmethod
    def jumps(self, facets: ndarray) -> tuple[ndarray, ndarray]:
        """Points of a jump along facets: shares (n_points, n_places) of the places in them, and weight (n_facets,)."""


class StressElements(Elements):
    """Lower bound: linear stresses in equilibrium within every triangle and at both ends of every facet.

    The unknown velocities are the multipliers of these equations, two of a triangle and four of a facet.
    """

    def __init__(self, mesh: MeshTri) -> None:
        super().__init__(mesh)
        ne, nf = mesh.nelements, mesh.nfacets
        self.n = 4 * nf + 2 * ne
        self.B = np.zeros((ne, 3, 3, 14))
        self.B[..., :2] = -_strain(self.gradient[:, :, None] * self.area[:, None, None, None])  # -div sigma
        for m, ends in enumerate(_ENDS):
            normal = -self.gradient[:, 3 - sum(ends)] * self.area[:, None]  # outward, times half the length
            for slot, corner in enumerate(ends):
                self.B[:, corner, :, 2 + 4 * m + 2 * slot:][..., :2] = _strain(normal[:, None])
        inside = 4 * nf + 2 * np.arange(ne)[:, None] + [0, 1]
        self.dofs = np.hstack([inside, (4 * mesh.t2f.T[:, :, None] + np.arange(4)).reshape(ne, 12)])
        middles = mesh.p[:, mesh.facets].mean(axis=1), mesh.p[:, mesh.t].mean(axis=1)
        self.places = np.hstack([np.repeat(middles[0], 4, 1), np.repeat(middles[1], 2, 1)])

    def load(self, body: ndarray, facets: ndarray, tractions: ndarray) -> ndarray:
        """Power of the loads."""
        f = np.zeros(self.n)
        f[4 * self.mesh.nfacets:] = (body * self.area[:, None]).ravel()
        np.add.at(f, self.on_facets(facets), 0.5 * self.lengths[facets, None, None] * tractions)
        return f

    def on_facets(self, facets: ndarray, turned: ndarray | None = None) -> ndarray:
        """Unknowns of facets."""
        return 4 * facets[:, None, None] + 2 * _slots(facets, turned)[:, :, None] + [0, 1]

    def of_elements(self, elements: ndarray) -> ndarray:
        """Unknowns of triangles and of their facets."""
        return np.unique(self.dofs[elements])

    def rigid_motions(self, centre: ndarray) -> ndarray:
        """Motions such that linear tractions do the right work: (2 v_a + v_b) / 3 and (v_a + 2 v_b) / 3 at the ends."""
        ends = self.mesh.p[:, self.mesh.facets]  # (2, 2 ends, nf)
        shares = np.array([[2, 1], [1, 2]]) / 3
        slots = np.einsum("se,cef->cfs", shares, ends).reshape(2, -1)
        return _motions(np.hstack([slots, self.mesh.p[:, self.mesh.t].mean(axis=1)]), centre)

    def jumps(self, facets: ndarray) -> tuple[ndarray, ndarray]:
        """The tractions at both ends."""
        return np.eye(2), self.lengths[facets] / 2


class VelocityElements(Elements):
    """Upper bound: quadratic velocities; flow rule and dissipation at the corners hold for the whole triangle.

    Strains are linear, the flow rule is convex, and so is the dissipation: its mean at the corners is not less than the
    integral.
    """

    def __init__(self, mesh: MeshTri) -> None:
        super().__init__(mesh)
        nv = mesh.nvertices
        self.n = 2 * (nv + mesh.nfacets)
        g, corner = self.gradient, np.eye(3)
        by_corner = [(4 * corner[:, i] - 1)[None, :, None] * g[:, None, i] for i in range(3)]
        by_middle = [4 * (corner[:, i, None] * g[:, None, j] + corner[:, j, None] * g[:, None, i]) for i, j in _ENDS]
        self.B = _strain(np.stack(by_corner + by_middle, axis=2)) * (self.area / 3)[:, None, None, None]
        nodes = np.vstack([mesh.t, nv + mesh.t2f]).T
        self.dofs = (2 * nodes[..., None] + np.arange(2)).reshape(mesh.nelements, 12)
        self.nodes = np.hstack([mesh.p, mesh.p[:, mesh.facets].mean(axis=1)])
        self.places = np.repeat(self.nodes, 2, axis=1)

    def load(self, body: ndarray, facets: ndarray, tractions: ndarray) -> ndarray:
        """Power of the loads."""
        f = np.zeros(self.n)
        third = (body * self.area[:, None] / 3)[:, None]
        np.add.at(f, self.dofs[:, 6:].reshape(-1, 3, 2), np.broadcast_to(third, (len(body), 3, 2)))
        ends = tractions * self.lengths[facets, None, None] / 6
        np.add.at(f, self.on_facets(facets), np.concatenate([ends, 2 * ends.sum(axis=1, keepdims=True)], axis=1))
        return f

    def on_facets(self, facets: ndarray, turned: ndarray | None = None) -> ndarray:
        """Unknowns of facets."""
        ends = np.take_along_axis(self.mesh.facets[:, facets].T, _slots(facets, turned), 1)
        return 2 * np.column_stack([ends, self.mesh.nvertices + facets])[:, :, None] + [0, 1]

    def of_elements(self, elements: ndarray) -> ndarray:
        """Unknowns of triangles."""
        return np.unique(self.dofs[elements])

    def rigid_motions(self, centre: ndarray) -> ndarray:
        """Motions of the nodes."""
        return _motions(self.nodes, centre)

    def jumps(self, facets: ndarray) -> tuple[ndarray, ndarray]:
        """Bernstein coefficients of the quadratic jump: where they obey a convex rule, the jump does all along."""
        return np.array([[1, 0, 0], [0, 1, 0], [-0.5, -0.5, 2.0]]), self.lengths[facets] / 3


def gradients(mesh: MeshTri) -> tuple[ndarray, ndarray]:
    """Gradients of the linear shape functions, (n_elements, 3 corners, 2), and areas."""
    x, y = mesh.p[:, mesh.t]
    twice = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    by_x = np.stack([y[1] - y[2], y[2] - y[0], y[0] - y[1]], 1)
    by_y = np.stack([x[2] - x[1], x[0] - x[2], x[1] - x[0]], 1)
    return np.stack([by_x, by_y], 2) / twice[:, None, None], np.abs(twice) / 2


def _strain(gradient: ndarray) -> ndarray:
    """Rows xx, yy, xy of strain from gradients (..., n, 2) of n shape functions, (..., 3, 2 n)."""
    B = np.zeros((*gradient.shape[:-2], 3, gradient.shape[-2], 2))
    B[..., 0, :, 0] = B[..., 2, :, 1] = gradient[..., 0]
    B[..., 1, :, 1] = B[..., 2, :, 0] = gradient[..., 1]
    return B.reshape(*B.shape[:-2], -1)


def _slots(facets: ndarray, turned: ndarray | None) -> ndarray:
    """Numbers of the ends of facets, (n_facets, 2)."""
    turned = np.zeros(len(facets), bool) if turned is None else turned
    return np.where(turned[:, None], [1, 0], [0, 1])


def _motions(places: ndarray, centre: ndarray) -> ndarray:
    """Rigid motions at places (2, n), both components of a place in turn, (2 n, 3)."""
    x, y = places - np.reshape(centre, (2, 1))
    one, zero = np.ones_like(x), np.zeros_like(x)
    return np.stack([np.stack([one, zero, -y]), np.stack([zero, one, x])]).transpose(2, 0, 1).reshape(-1, 3)
