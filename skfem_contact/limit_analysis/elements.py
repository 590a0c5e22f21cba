r"""Velocities of both bounds, and which are free: elements of stresses that jump, and of velocities that do not.

Both are operators :math:`B` from unknown velocities to strains times weight at the corners of straight triangles, so
that :math:`\sum \sigma : B v` is the power of the stresses (A. Makrodimopoulos, C. M. Martin, International Journal for
Numerical Methods in Engineering 66 (2006) 604-634; International Journal for Numerical and Analytical Methods in
Geomechanics 31 (2007) 835-865).  Components are xx, yy, xy; shear strains are engineering ones.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.linalg import null_space
from scipy.sparse import coo_matrix, csr_matrix, hstack
from scipy.sparse.csgraph import connected_components
from skfem import CellBasis, ElementTriP2, ElementVector, MeshTri

from ..forms.strain import strain_operator
from ..layout import rigid_modes
from .triangles import facet_lengths

#: Corners at the ends of the three facets of a triangle.
_ENDS = ((0, 1), (1, 2), (0, 2))
#: The corners of the reference triangle.
_CORNERS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
#: Of a rigid body's motions, those that its supports resist by less than this share are free.
_FREE = 1e-9


@dataclass(frozen=True)
class Elements:
    """Velocities on a mesh of triangles, and what strains and loads make of them.

    Attributes
    ----------
    mesh
        Straight triangles.
    B
        Strains times weight by velocities, (n_elements, 3 corners, 3, n_local).
    dofs
        Layout of every triangle, (n_elements, n_local); x and y take turns.
    places
        Where each unknown lives, (2, n): motions of rigid bodies are velocities there.
    facets
        Layout of all facets, (n_facets, n_places, 2 components): at their ends first.
    inside
        Those that take equal parts of a body force, (n_elements, n_places, 2 components).
    ends
        Forces at the places of a facet by linear tractions at its ends, as shares of its length, (n_places, 2).
    jump
        Points of a jump along a facet, of equal weight: shares of its places in them, (n_points, n_places).
    """

    mesh: MeshTri
    B: ndarray
    dofs: ndarray
    places: ndarray
    facets: ndarray
    inside: ndarray
    ends: ndarray
    jump: ndarray

    @property
    def n(self) -> int:
        """Number of unknown velocities."""
        return self.places.shape[1]

    def of_body(self, forces: ndarray) -> ndarray:
        """Power of body forces (n_elements, 2), (n,)."""
        power, area = np.zeros(self.n), gradients(self.mesh)[1]
        part = (forces * area[:, None] / self.inside.shape[1])[:, None]
        np.add.at(power, self.inside, np.broadcast_to(part, self.inside.shape))
        return power

    def of_tractions(self, facets: ndarray, tractions: ndarray) -> ndarray:
        """Power of tractions (n_facets, 2 ends, 2), linear on each facet, (n,)."""
        power, lengths = np.zeros(self.n), facet_lengths(self.mesh)[facets]
        np.add.at(power, self.facets[facets], np.einsum("pe,fec,f->fpc", self.ends, tractions, lengths))
        return power

    def on_facets(self, facets: ndarray, turned: ndarray) -> ndarray:
        """Layout of some facets, those at the ends exchanged where turned."""
        found = self.facets[facets]
        found[turned, :2] = found[turned, 1::-1]
        return found


def stress_elements(mesh: MeshTri) -> Elements:
    """Lower bound: linear stresses in equilibrium within every triangle and at both ends of every facet.

    The unknown velocities are the multipliers of these equations, two of a triangle and four of a facet: linear
    tractions do the work of a rigid motion on its velocities (2 v_a + v_b) / 3 and (v_a + 2 v_b) / 3.
    """
    ne, nf = mesh.nelements, mesh.nfacets
    gradient, area = gradients(mesh)
    B = np.zeros((ne, 3, 3, 14))
    B[..., :2] = -_strain(gradient[:, :, None] * area[:, None, None, None])  # -div sigma
    for m, ends in enumerate(_ENDS):
        normal = -gradient[:, 3 - sum(ends)] * area[:, None]  # outward, times half the length
        for slot, corner in enumerate(ends):
            B[:, corner, :, 2 + 4 * m + 2 * slot:][..., :2] = _strain(normal[:, None])
    facets = np.arange(4 * nf).reshape(nf, 2, 2)
    inside = 4 * nf + np.arange(2 * ne).reshape(ne, 1, 2)
    a, b = mesh.p[:, mesh.facets].transpose(1, 0, 2)
    thirds = np.stack([2 * a + b, a + 2 * b], axis=2).reshape(2, -1) / 3
    places = np.repeat(np.hstack([thirds, mesh.p[:, mesh.t].mean(axis=1)]), 2, axis=1)
    dofs = np.hstack([inside[:, 0], facets[mesh.t2f.T].reshape(ne, 12)])
    return Elements(mesh, B, dofs, places, facets, inside, ends=np.eye(2) / 2, jump=np.eye(2))


def velocity_elements(mesh: MeshTri) -> Elements:
    """Upper bound: quadratic velocities; flow rule and dissipation at the corners hold for the whole triangle.

    Strains are linear, the flow rule is convex, and so is the dissipation: its mean at the corners is not less than the
    integral.  Jumps are given by their Bernstein coefficients: where these obey a convex rule, the jump does all along.
    """
    basis = CellBasis(mesh, ElementVector(ElementTriP2()), quadrature=(_CORNERS, np.full(3, 1 / 6)))
    B, weight = strain_operator(basis, "full", "plane")
    ends, middles = basis.nodal_dofs.T[mesh.facets.T], basis.facet_dofs.T
    dofs = basis.element_dofs.T
    return Elements(mesh, B[:, :, [0, 1, 3]] * weight[:, :, None, None], dofs, basis.doflocs,
                    facets=np.concatenate([ends, middles[:, None]], axis=1), inside=dofs[:, 6:].reshape(-1, 3, 2),
                    ends=np.array([[1, 0], [0, 1], [2, 2]]) / 6, jump=np.array([[1, 0, 0], [0, 1, 0], [-0.5, -0.5, 2]]))


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


class Block(NamedTuple):
    """Operators of equal shape: B (n, n_points, 3, n_local), its points (n, n_points) and unknowns (n, n_local).

    An unknown of -1 is none.
    """

    B: ndarray
    points: ndarray
    dofs: ndarray

    def stiffness(self, D: ndarray) -> ndarray:
        """Sum of B^T D B over the points of each, (n, n_local, n_local), with D (n_points, 3, 3) of all points."""
        n, width = self.dofs.shape
        DB = np.matmul(D[self.points], self.B).reshape(n, -1, width)
        return np.matmul(self.B.reshape(n, -1, width).transpose(0, 2, 1), DB)


class Layout(NamedTuple):
    """Reduction of all velocities of the elements, (n,), to the free ones, (m,), of which the motions are the last.

    Attributes
    ----------
    number
        Free unknown of each velocity, (n,); -1 where it is held or in a rigid body.
    motions
        Velocities of the free motions of the rigid bodies, (n, n_motions).
    places
        Where the free unknowns live, (2, m).
    """

    number: ndarray
    motions: ndarray
    places: ndarray

    @classmethod
    def of(cls, elements: Elements, used: ndarray, held: ndarray, tied: ndarray, rigid: ndarray) -> Layout:
        """Free are those that are used and not held; pairs (2, n) are tied, triangles of rigid >= 0 bodies."""
        n = elements.n
        same = connected_components(coo_matrix((np.ones(tied.shape[1]), tuple(tied)), shape=(n, n)), directed=False)[1]
        fixed, body = np.isin(same, same[held]), np.full(n, -1)
        for b in range(rigid.max() + 1):
            body[np.isin(same, same[elements.dofs[rigid == b]])] = b
        plain = np.zeros(n, bool)
        plain[used] = True
        plain = np.flatnonzero(plain & ~fixed & (body < 0))
        number = np.full(n, -1)
        _, first, number[plain] = np.unique(same[plain], return_index=True, return_inverse=True)
        motions, places = [np.zeros((n, 0))], [elements.places[:, plain[first]]]
        for b in range(rigid.max() + 1):
            mine = np.flatnonzero(body == b)
            whole = rigid_modes(elements.places, mine)
            free = whole @ null_space(whole[fixed[mine]], rcond=_FREE) if fixed[mine].any() else whole
            motions.append(np.zeros((n, free.shape[1])))
            motions[-1][mine] = free
            places.append(np.repeat(elements.places[:, mine].mean(axis=1, keepdims=True), free.shape[1], 1))
        return cls(number, np.hstack(motions), np.hstack(places))

    @property
    def size(self) -> int:
        """Number of free unknowns."""
        return self.places.shape[1]

    @property
    def matrix(self) -> csr_matrix:
        """All velocities from the free ones, (n, m)."""
        plain = np.flatnonzero(self.number >= 0)
        shape = len(self.number), self.size - self.motions.shape[1]
        single = csr_matrix((np.ones(len(plain)), (plain, self.number[plain])), shape=shape)
        return csr_matrix(hstack([single, csr_matrix(self.motions)]))

    def reduced(self, B: ndarray, points: ndarray, dofs: ndarray) -> list[Block]:
        """Operators of the free unknowns; those at rigid bodies have more columns and are a block of their own."""
        touching = np.isin(dofs, np.flatnonzero(self.motions.any(axis=1))).any(axis=1)
        blocks = [Block(B[~touching], points[~touching], self.number[dofs[~touching]])]
        B, points, dofs = B[touching], points[touching], dofs[touching]
        motion = self.motions[dofs]  # (n, n_local, n_motions)
        last = np.arange(self.size - motion.shape[2], self.size)
        unknowns = np.hstack([self.number[dofs], np.where(motion.any(axis=1), last, -1)])
        blocks.append(Block(np.concatenate([B, np.einsum("epsl,elk->epsk", B, motion)], axis=3), points, unknowns))
        return [block for block in blocks if len(block.B)]
