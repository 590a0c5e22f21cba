"""Three-node Timoshenko elements in the plane, straight or curved, and the lines that they follow.

Displacements and rotations are quadratic, and two Gauss points integrate all terms: no locking. The dofs of an element
are the displacements of its nodes (start, end, middle), then their rotations, anticlockwise. Strains do not depend on
the frame: with the tangent t, the normal n to its left and the derivative ' by the arc length,
eps = t . u', gamma = n . u' - theta, kappa = theta'.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csc_matrix, eye_array
from scipy.sparse.linalg import splu
from skfem import CellBasis

from ..checks import facets_of
from ..surfaces.topology import ordered

_GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
#: Share of the force on the middle node that a uniform load on the element leaves at either end.
_AT_END = 0.25
#: Length of an element, as a share of the size of the beam, that is none.
_NO_LENGTH = 1e-6
#: Squared strain of a motion, relative to the largest one, below which it is none: that of a chain of n elements is
#: about n**-4, that of a mechanism 1e-16.
_NO_STRAIN = 1e-13


def shapes(xi: float) -> tuple[ndarray, ndarray]:
    """Return the quadratic functions of the nodes (-1, 1, 0) at a point, and their derivatives."""
    return (np.array([0.5 * xi * (xi - 1.0), 0.5 * xi * (xi + 1.0), 1.0 - xi * xi]),
            np.array([xi - 0.5, xi + 0.5, -2.0 * xi]))


@dataclass(frozen=True, eq=False)
class BeamElements:
    """Geometry of m elements.

    Attributes
    ----------
    points : ndarray, shape (m, 3, 2)
        Coordinates of start, end and middle.
    strains : ndarray, shape (m, 6, 9)
        Strains (eps, gamma, kappa) at both Gauss points by the dofs.
    weights : ndarray, shape (m, 2)
        Lengths that the Gauss points stand for.
    """

    points: ndarray
    strains: ndarray
    weights: ndarray

    @classmethod
    def of(cls, points: ndarray) -> BeamElements:
        """Return the elements between nodes (m, 3, 2)."""
        strains, weights = np.zeros((len(points), 6, 9)), np.zeros((len(points), 2))
        for g, xi in enumerate(_GAUSS):
            N, dN = shapes(xi)
            along = np.einsum("k,mkc->mc", dN, points)
            chord = points[:, 1] - points[:, 0]
            if not ((along * chord).sum(axis=1) > _NO_LENGTH * np.ptp(points) * np.linalg.norm(chord, axis=1)).all():
                raise ValueError("an element of a beam has no length, or its middle lies beyond its ends")
            weights[:, g] = J = np.linalg.norm(along, axis=1)
            t = along / J[:, None]
            n = np.column_stack((-t[:, 1], t[:, 0]))
            slope = dN / J[:, None]
            for row, direction in enumerate((t, n)):
                strains[:, 3 * g + row, :6] = (slope[:, :, None] * direction[:, None]).reshape(-1, 6)
            strains[:, 3 * g + 1, 6:] = -N
            strains[:, 3 * g + 2, 6:] = slope
        return cls(points, strains, weights)

    def root(self, EA: float, GA: float, EI: float) -> ndarray:
        """Return the matrices R of the stiffness R R', (m, 9, 6)."""
        D = (self.weights[:, :, None] * np.array([EA, GA, EI])).reshape(-1, 6)
        return np.asarray(np.einsum("msi,ms->mis", self.strains, np.sqrt(D)))

    @property
    def length(self) -> ndarray:
        """Lengths, (m,)."""
        return np.asarray(self.weights.sum(axis=1))

    @property
    def rigid(self) -> ndarray:
        """Dofs in rigid motions of unit motions of the middle node, (m, 9, 3)."""
        motion = np.zeros((len(self.points), 9, 3))
        arm = self.points - self.points[:, [2]]
        motion[:, 0:6:2, 0] = motion[:, 1:6:2, 1] = motion[:, 6:, 2] = 1.0
        motion[:, 0:6:2, 2], motion[:, 1:6:2, 2] = -arm[:, :, 1], arm[:, :, 0]
        return motion

    @property
    def load(self) -> ndarray:
        """Share of every node in a uniform load, (m, 3)."""
        return np.asarray(sum(w[:, None] * shapes(xi)[0] for xi, w in zip(_GAUSS, self.weights.T, strict=True)))

    @property
    def resultants(self) -> ndarray:
        """N, V and M at start and end by the forces on the nodes, (m, 2, 3, 9); signs of ``SectionForces``.

        Of the forces on an end node, those count that the neighbour exerts: not the share of a load on the element,
        a quarter of the force on the middle node.
        """
        found = np.zeros((len(self.points), 2, 3, 9))
        for end, sign, xi in ((0, -1.0, -1.0), (1, 1.0, 1.0)):
            along = np.einsum("k,mkc->mc", shapes(xi)[1], self.points)
            t = along / np.linalg.norm(along, axis=1)[:, None]
            n = np.column_stack((-t[:, 1], t[:, 0]))
            for node, share in ((end, sign), (2, -sign * _AT_END)):
                found[:, end, 0, 2 * node:2 * node + 2] = share * t
                found[:, end, 1, 2 * node:2 * node + 2] = share * n
                found[:, end, 2, 6 + node] = -share
        return found


def line_of(basis: CellBasis, name: str) -> tuple[ndarray, ndarray, ndarray]:
    """Return dofs of the nodes, (n, 2), coordinates and elements of a named line, on the boundary or inside.

    It begins at its upper end, a level one at its left end, and goes clockwise where it is closed.
    """
    mesh, facets = basis.mesh, np.unique(facets_of(basis.mesh, name))
    if len(basis.facet_dofs) != 2:
        raise ValueError(f"'{name}': beams have three nodes: take a basis of second order")
    ends = _one_way(mesh.facets[:, facets], name)
    order = ordered(ends, name)
    facets, ends = facets[order], ends[:, order]
    x, closed = mesh.p[:, ends], ends[0, 0] == ends[1, -1]
    area = (x[0, 0] * x[1, 1] - x[0, 1] * x[1, 0]).sum()
    high = x[1, 1, -1] - x[1, 0, 0], x[0, 0, 0] - x[0, 1, -1]
    if area > 0.0 if closed else (high[0] or high[1]) > 0.0:
        facets, ends = facets[::-1], ends[::-1, ::-1]
    if closed:
        top = int(np.argmax((mesh.p[1] - _NO_LENGTH * mesh.p[0])[ends[0]]))
        facets, ends = np.roll(facets, -top), np.roll(ends, -top, axis=1)
    nodal, middle = basis.nodal_dofs[0, ends], basis.facet_dofs[0, facets]
    first, cells = np.unique(np.vstack((nodal, middle)).T, return_inverse=True)
    return first[:, None] + np.arange(2), basis.doflocs[:, first].T, cells.reshape(-1, 3)


def _one_way(ends: ndarray, name: str) -> ndarray:
    """Return end nodes of facets, (2, n), turned so that each facet begins where another one ends."""
    ends = ends.copy()
    at: dict[int, list[int]] = {}
    for k, pair in enumerate(ends.T):
        for node in pair.tolist():
            at.setdefault(node, []).append(k)
    if branch := next((node for node, there in at.items() if len(there) > 2), None):
        raise ValueError(f"'{name}' is no single chain: it branches at node {branch}")
    single = [node for node, there in at.items() if len(there) == 1]
    node, left = (single or list(at))[0], set(range(ends.shape[1]))
    while here := [k for k in at[node] if k in left]:
        k = here[0]
        left.discard(k)
        if ends[0, k] != node:
            ends[:, k] = ends[::-1, k]
        node = int(ends[1, k])
    if left:
        raise ValueError(f"'{name}' is no single chain: {len(left)} of its {ends.shape[1]} facets lie apart")
    return ends


def loose_node(strains: ndarray, rows: ndarray, free: ndarray) -> int | None:
    """Return the dof that moves most in a motion without strain of the free dofs, (n,), or None if there is none."""
    size = np.linalg.norm(strains, axis=2, keepdims=True)
    blocks = strains / size
    row = np.broadcast_to(np.arange(blocks[..., 0].size).reshape(*blocks.shape[:2], 1), blocks.shape)
    column = np.broadcast_to(rows[:, None], blocks.shape)
    B = coo_matrix((blocks.ravel(), (row.ravel(), column.ravel())), shape=(row.max() + 1, len(free))).tocsc()[:, free]
    K = csc_matrix(B.T @ B)
    solve = splu(csc_matrix(K + _NO_STRAIN * eye_array(K.shape[0])), permc_spec="MMD_AT_PLUS_A")
    motion = np.random.default_rng(0).standard_normal(K.shape[0])
    for _ in range(3):
        motion = solve.solve(motion)
        motion /= np.linalg.norm(motion)
    if motion @ (K @ motion) > 2.0 * _NO_STRAIN:
        return None
    return int(np.flatnonzero(free)[np.argmax(np.abs(motion))])
