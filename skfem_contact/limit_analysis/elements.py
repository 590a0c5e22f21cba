r"""Velocities of both bounds, and the cone program that they make.

Elements of the lower bound have stresses that jump, elements of the upper bound continuous
velocities. Both are operators :math:`B` from velocities to strains times weight at the corners of
straight triangles, so that :math:`\sum \sigma : B v` is the power of the stresses
(A. Makrodimopoulos, C. M. Martin, International Journal for Numerical Methods in Engineering 66
(2006) 604-634; International Journal for Numerical and Analytical Methods in Geomechanics 31 (2007)
835-865). Components are xx, yy, xy; shear strains are engineering strains.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.linalg import null_space
from scipy.sparse import csr_matrix, hstack
from skfem import CellBasis, ElementTriP2, ElementVector, MeshTri

from ..forms.assembly import strain_operator
from ..layout import rigid_modes
from ..solvers.direct import as_engine
from ..sparse import FreeBlock, Gathering, Total, parts_of
from .strength import Cones, Strength
from .triangles import facet_lengths, gradients

#: Corners at the ends of the three facets of a triangle.
_ENDS = ((0, 1), (1, 2), (0, 2))
#: The corners of the reference triangle.
_CORNERS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
#: Of a rigid body's motions, those that its supports resist by less than this share are free.
_FREE = 1e-9
#: Shares of the diagonal that are added, one after the other, until the matrix has a factor:
#: equations of the lower bound depend on each other where two straight lines cross at a node.
_SHIFTS = (1e-14, 1e-11, 1e-8)


@dataclass(frozen=True)
class Elements:
    """Velocities on a mesh of straight triangles, and their operators for strains and loads."""

    mesh: MeshTri
    B: ndarray  # strains times weight by velocities, (n_elements, 3 corners, 3, n_local)
    dofs: ndarray  # of every triangle, (n_elements, n_local); x and y alternate
    coordinates: ndarray  # of each dof, (2, n): motions of rigid bodies are velocities there
    facets: ndarray  # dofs of all facets, (n_facets, n_nodes, 2 components): at their ends first
    # dofs that take equal parts of a body force, (n_elements, n_nodes, 2 components)
    inside: ndarray
    # forces at the nodes of a facet by linear tractions at its ends, over its length, (n_nodes, 2)
    ends: ndarray
    # weights of the strength at all corners of a triangle for its strength at each corner, (3, 3)
    strength: ndarray
    # Bernstein coefficients of a jump along a facet by its nodes, of equal weight, (n_points,
    # n_nodes)
    jump: ndarray

    @property
    def statical(self) -> bool:
        """True for the lower bound, whose corners have their own strength."""
        return not self.strength[0, 1]

    @property
    def n(self) -> int:
        """Number of velocities."""
        return self.coordinates.shape[1]

    def of_body(self, forces: ndarray) -> ndarray:
        """Return the power of body forces (n_elements, 2), (n,)."""
        power = np.zeros(self.n)
        area = gradients(self.mesh)[1]
        part = (forces * area[:, None] / self.inside.shape[1])[:, None]
        np.add.at(power, self.inside, np.broadcast_to(part, self.inside.shape))
        return power

    def of_tractions(self, facets: ndarray, tractions: ndarray) -> ndarray:
        """Return the power of tractions (n_facets, 2 ends, 2), linear on each facet, (n,)."""
        power = np.zeros(self.n)
        lengths = facet_lengths(self.mesh)[facets]
        forces = np.einsum("pe,fec,f->fpc", self.ends, tractions, lengths)  # (n_facets, n_nodes, 2)
        np.add.at(power, self.facets[facets], forces)
        return power

    def on_facets(self, facets: ndarray, turned: ndarray) -> ndarray:
        """Return dofs of some facets, with their ends exchanged where turned."""
        dofs = self.facets[facets]
        dofs[turned, :2] = dofs[turned, 1::-1]
        return dofs


def stress_elements(mesh: MeshTri) -> Elements:
    """Return elements of the lower bound: linear stresses in equilibrium.

    Equilibrium holds in triangles and at both ends of facets. Velocities are the multipliers of
    these equations, two of a triangle and four of a facet: linear tractions do the work of a rigid
    motion on its velocities (2 v_a + v_b) / 3 and (v_a + 2 v_b) / 3.
    """
    ne = mesh.nelements
    nf = mesh.nfacets
    gradient, area = gradients(mesh)
    B = np.zeros((ne, 3, 3, 14))  # (n_elements, 3 corners, 3, n_local)

    # -div sigma in triangles
    scaled = gradient[:, :, None] * area[:, None, None, None]
    B[..., :2] = -_strain(scaled)

    # sigma n at the ends of facets
    for m, ends in enumerate(_ENDS):
        opposite = 3 - sum(ends)
        normal = -gradient[:, opposite] * area[:, None]  # outward, times half the length
        for slot, corner in enumerate(ends):
            column = 2 + 4 * m + 2 * slot
            B[:, corner, :, column : column + 2] = _strain(normal[:, None])

    # number the velocities of facets, then of triangles
    facets = np.arange(4 * nf).reshape(nf, 2, 2)  # (n_facets, 2 ends, 2 components)
    inside = 4 * nf + np.arange(2 * ne).reshape(ne, 1, 2)  # (n_elements, 1, 2 components)
    around = facets[mesh.t2f.T].reshape(ne, 12)
    dofs = np.hstack([inside[:, 0], around])
    a, b = mesh.p[:, mesh.facets].transpose(1, 0, 2)
    thirds = np.stack([2 * a + b, a + 2 * b], axis=2)  # three times, (2, n_facets, 2 ends)
    thirds = thirds.reshape(2, -1) / 3
    middles = mesh.p[:, mesh.t].mean(axis=1)
    return Elements(
        mesh,
        B,
        dofs,
        coordinates=np.repeat(np.hstack([thirds, middles]), 2, axis=1),
        facets=facets,
        inside=inside,
        ends=np.eye(2) / 2,
        strength=np.eye(3),
        jump=np.eye(2),
    )


def velocity_elements(mesh: MeshTri) -> Elements:
    """Return elements of the upper bound: quadratic velocities, whose strains are linear.

    The flow rule and the dissipation are convex: values at the corners hold for the whole triangle.
    Jumps are given by Bernstein coefficients: a convex rule that the coefficients obey holds along
    the facet.
    """
    element = ElementVector(ElementTriP2())
    at_corners = (_CORNERS, np.full(3, 1 / 6))
    basis = CellBasis(mesh, element, quadrature=at_corners)
    strain, weight = strain_operator(basis, "full", "plane")
    B = strain[:, :, [0, 1, 3]] * weight[:, :, None, None]  # (n_elements, 3 corners, 3, 12)
    dofs = basis.element_dofs.T
    ends = basis.nodal_dofs.T[mesh.facets.T]
    middles = basis.facet_dofs.T
    return Elements(
        mesh,
        B,
        dofs,
        coordinates=basis.doflocs,
        facets=np.concatenate([ends, middles[:, None]], axis=1),
        inside=dofs[:, 6:].reshape(-1, 3, 2),
        ends=np.array([[1, 0], [0, 1], [2, 2]]) / 6,
        strength=(np.ones((3, 3)) + np.eye(3)) / 4,
        jump=np.array([[1, 0, 0], [0, 1, 0], [-0.5, -0.5, 2]]),
    )


def _strain(gradient: ndarray) -> ndarray:
    """Return strain operators (..., 3, 2 n) from gradients (..., n, 2) of n shape functions."""
    *points, n, _ = gradient.shape
    B = np.zeros((*points, 3, n, 2))
    B[..., 0, :, 0] = B[..., 2, :, 1] = gradient[..., 0]
    B[..., 1, :, 1] = B[..., 2, :, 0] = gradient[..., 1]
    return B.reshape(*B.shape[:-2], -1)


class Block(NamedTuple):
    """Operators of equal shape; a dof of -1 is none."""

    B: ndarray  # (n, n_points, 3, n_local)
    points: ndarray  # (n, n_points)
    dofs: ndarray  # (n, n_local)

    def stiffness(self, D: ndarray) -> ndarray:
        """Return B^T D B summed over points, (n, n_local, n_local), for D (n_points, 3, 3)."""
        n, width = self.dofs.shape
        B = self.B.reshape(n, -1, width)
        DB = np.matmul(D[self.points], self.B).reshape(n, -1, width)
        return np.matmul(B.transpose(0, 2, 1), DB)


class Reduction(NamedTuple):
    """Reduction of all velocities of the elements, (n,), to the free dofs, (m,).

    Motions of rigid bodies are the last dofs.
    """

    number: ndarray  # free dof of each velocity, (n,); -1 where it is held or in a rigid body
    motions: ndarray  # velocities of the free motions of the rigid bodies, (n, n_motions)
    coordinates: ndarray  # of the free dofs, (2, m)

    @classmethod
    def of(
        cls,
        elements: Elements,
        used: ndarray,
        held: ndarray,
        tied: ndarray,
        rigid: ndarray,
    ) -> Reduction:
        """Reduce to used velocities that are not held.

        Pairs (2, n) are tied; triangles with rigid >= 0 belong to rigid bodies.
        """
        # number tied velocities alike, and assign velocities to supports and bodies
        n = elements.n
        n_bodies = rigid.max() + 1
        same = parts_of(n, *tied)
        fixed = np.isin(same, same[held])
        body = np.full(n, -1)
        for b in range(n_bodies):
            dofs = elements.dofs[rigid == b]
            body[np.isin(same, same[dofs])] = b

        # number the free velocities outside of bodies
        is_used = np.zeros(n, bool)
        is_used[used] = True
        plain = np.flatnonzero(is_used & ~fixed & (body < 0))
        number = np.full(n, -1)
        _, first, number[plain] = np.unique(same[plain], return_index=True, return_inverse=True)

        # add the motions of bodies that their supports leave free
        motions = [np.zeros((n, 0))]
        coordinates = [elements.coordinates[:, plain[first]]]
        for b in range(n_bodies):
            own = np.flatnonzero(body == b)
            free = rigid_modes(elements.coordinates, own)
            if fixed[own].any():
                at_supports = free[fixed[own]]
                free = free @ null_space(at_supports, rcond=_FREE)
            motion = np.zeros((n, free.shape[1]))
            motion[own] = free
            motions.append(motion)
            centre = elements.coordinates[:, own].mean(axis=1, keepdims=True)
            coordinates.append(np.repeat(centre, free.shape[1], 1))
        return cls(number, np.hstack(motions), np.hstack(coordinates))

    @property
    def size(self) -> int:
        """Number of free dofs."""
        return self.coordinates.shape[1]

    @property
    def matrix(self) -> csr_matrix:
        """Matrix of all velocities by the free dofs, (n, m)."""
        plain = np.flatnonzero(self.number >= 0)
        shape = len(self.number), self.size - self.motions.shape[1]
        columns = self.number[plain]
        single = csr_matrix((np.ones(len(plain)), (plain, columns)), shape=shape)
        return csr_matrix(hstack([single, csr_matrix(self.motions)]))

    def reduced(self, B: ndarray, points: ndarray, dofs: ndarray) -> list[Block]:
        """Return operators of the free dofs.

        Operators of velocities of rigid bodies have more columns and are a block of their own.
        """
        moving = np.flatnonzero(self.motions.any(axis=1))
        at_body = np.isin(dofs, moving).any(axis=1)
        plain = Block(B[~at_body], points[~at_body], self.number[dofs[~at_body]])

        # append the motions to the columns: B_motion = B motion
        motion = self.motions[dofs[at_body]]  # (n, n_local, n_motions)
        last = np.arange(self.size - motion.shape[2], self.size)
        moved = np.where(motion.any(axis=1), last, -1)
        by_motion = np.einsum("epsl,elk->epsk", B[at_body], motion)  # (n, n_points, 3, n_motions)
        bodies = Block(
            np.concatenate([B[at_body], by_motion], axis=3),
            points[at_body],
            np.hstack([self.number[dofs[at_body]], moved]),
        )
        return [block for block in (plain, bodies) if len(block.B)]


class Joint(NamedTuple):
    """Facets of slave and master that coincide, (n,), with the slave's normal."""

    slave: ndarray
    master: ndarray
    B: ndarray
    dofs: ndarray
    strength: Strength


@dataclass(eq=False)
class Program:
    r"""Stresses in equilibrium with loads, within the strength.

    .. math:: A \sigma = f_0 + \theta f_1, \qquad h - G \sigma \in Q

    with :math:`A = \sum B^T` over all points and a product Q of second-order cones. The solution
    :math:`\sigma` belongs to the lower bound and the dual, the velocities, to the upper one.
    """

    blocks: list[Block]  # operators of triangles and joints
    # of the points by number: three of every triangle that can yield, then of the joints
    strengths: list[Strength]
    reduction: Reduction
    dead: ndarray  # fixed loads, (m,)
    live: ndarray  # multiplied loads, (m,)
    soft: ndarray  # triangles that can yield
    joints: list[Joint]

    _ordered: FreeBlock | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        counts = [len(strength.reduced) for strength in self.strengths]
        self.starts = np.cumsum([0, *counts])
        self.n_points = int(self.starts[-1])
        self.size = self.reduction.size
        cones = []
        for strength, first in zip(self.strengths, self.starts):
            cones.append(strength.cones(int(first)))
        every, second = zip(*cones)
        self.cones = Cones.join([*every, *second])
        #: Gathering and order of the normal matrix, a stiffness matrix, are found once for all D.
        self._gatherings = [Gathering(self.size) for _ in self.blocks]
        self._total = Total()
        self._engine = as_engine()
        #: True until a matrix has no Cholesky factor: the later ones, nearer to the solution, have
        #: none either, and every change of the kind of factor costs an analysis.
        self._definite = self._engine.cholesky

    def of_fixed_loads(self) -> Program:
        """Return the program of the fixed loads alone, where all strength is reduced."""
        strengths: list[Strength] = [
            replace(s, reduced=np.ones(len(s.reduced), bool)) for s in self.strengths
        ]
        return replace(self, strengths=strengths, live=np.zeros(self.size))

    def factor(self, D: ndarray) -> Callable[[ndarray], ndarray]:
        """Return the solution of A D A^T y = b for any b (..., m), with D (n_points, 3, 3).

        A matrix without a factor raises an ArithmeticError.
        """
        # gather the normal matrix in its order of elimination
        parts = zip(self._gatherings, self.blocks)
        K = self._total.of(
            [gathering.matrix(block.dofs, block.stiffness(D)) for gathering, block in parts]
        )
        if not np.isfinite(K.data).all():
            raise ArithmeticError("the normal matrix is not finite")
        if self._ordered is None:
            self._ordered = FreeBlock(self._engine.order(K, self.reduction.coordinates))
        A = self._ordered.gather(K)
        order = self._ordered.order
        diagonal = A.diagonal()
        # nothing resists the idle dofs of a smooth joint: their diagonal is zero
        share = np.where(diagonal > 0.0, diagonal, diagonal.max())

        def solve(b: ndarray) -> ndarray:
            y = np.empty_like(b)
            y[..., order] = inverse(b[..., order].T).T
            return y

        # take Cholesky's factor, else raise the diagonal until another one exists
        attempts = [(shift, False) for shift in _SHIFTS]
        if self._definite:
            attempts.insert(0, (_SHIFTS[0], True))
        for shift, definite in attempts:
            A.setdiag(diagonal + shift * share)
            try:
                inverse = self._engine.factor(A, symmetric=True, definite=definite)
            except RuntimeError:
                self._definite = False
                continue
            return solve
        raise ArithmeticError("the normal matrix is singular")

    @cached_property
    def matrix(self) -> csr_matrix:
        """Matrix A, (m, 3 n_points)."""
        rows = []
        columns = []
        data = []
        for B, points, dofs in self.blocks:
            row = np.broadcast_to(dofs[:, None, None], B.shape)
            column = 3 * points[:, :, None, None] + np.arange(3)[:, None]
            column = np.broadcast_to(column, B.shape)
            used = (row >= 0) & (B != 0)
            rows.append(row[used])
            columns.append(column[used])
            data.append(B[used])
        entries = (np.concatenate(rows), np.concatenate(columns))
        shape = (self.size, 3 * self.n_points)
        return csr_matrix((np.concatenate(data), entries), shape=shape)

    @cached_property
    def transposed(self) -> csr_matrix:
        """Matrix A^T."""
        return self.matrix.T.tocsr()

    def forces(self, stress: ndarray) -> ndarray:
        """Return A times stresses (..., n_points, 3), (..., m)."""
        columns = stress.reshape(*stress.shape[:-2], -1).T
        return (self.matrix @ columns).T

    def strains(self, velocity: ndarray) -> ndarray:
        """Return strains times weight of velocities (..., m), (..., n_points, 3)."""
        columns = self.transposed @ velocity.T
        return columns.T.reshape(*velocity.shape[:-1], -1, 3)

    def round_off(self, velocity: ndarray) -> ndarray:
        """Return the round-off of the strains at every point, (n_points,)."""
        size = (abs(self.transposed) @ np.abs(velocity)).reshape(-1, 3)
        return 8 * np.finfo(float).eps * size.max(axis=1)

    def of_points(self, function: Callable[[Strength, slice], ndarray]) -> ndarray:
        """Return values of a function of strength and its points, for all points."""
        parts = []
        for s, a, b in zip(self.strengths, self.starts, self.starts[1:]):
            parts.append(function(s, slice(a, b)))
        return np.concatenate(parts)

    def of_triangles(self, values: ndarray) -> ndarray:
        """Return values (n_points, ...) of triangles that can yield, (n_soft, 3 corners, ...)."""
        n = len(self.soft)
        return values[: 3 * n].reshape(n, 3, *values.shape[1:])

    @cached_property
    def volume(self) -> ndarray:
        """Component of strain that is the change of volume or the opening, (n_points, 3)."""
        return self.of_points(
            lambda s, points: np.broadcast_to(s.volume, (points.stop - points.start, 3))
        )

    @cached_property
    def incompressible(self) -> ndarray:
        """Numbers of the points whose volume is constant."""
        return np.flatnonzero(self.of_points(lambda s, points: s.incompressible))
