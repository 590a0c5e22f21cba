r"""Velocities of both bounds, and the cone program that they make.

Elements of the lower bound have stresses that jump, those of the upper bound continuous velocities.
 Both are operators
:math:`B` from velocities to strains times weight at the corners of straight triangles, so that
:math:`\sum \sigma : B v` is the power of the stresses (A. Makrodimopoulos, C. M. Martin,
International Journal for Numerical Methods in Engineering 66 (2006) 604-634; International Journal
for Numerical and Analytical Methods in Geomechanics 31 (2007) 835-865).  Components are xx, yy, xy;
shear strains are engineering strains.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.linalg import null_space
from scipy.sparse import coo_matrix, csr_matrix, hstack
from scipy.sparse.csgraph import connected_components
from skfem import CellBasis, ElementTriP2, ElementVector, MeshTri

from ..forms.assembly import strain_operator
from ..layout import rigid_modes
from ..solvers.direct import as_engine
from ..sparse import FreeBlock, Gathering, Total
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
    inside: (
        ndarray  # dofs that take equal parts of a body force, (n_elements, n_nodes, 2 components)
    )
    # forces at the nodes of a facet by linear tractions at its ends, over its length, (n_nodes, 2)
    ends: ndarray
    # weights of the strength at the corners of a triangle for that of each corner, (3, 3)
    strength: ndarray
    # Bernstein coefficients of a jump along a facet by its nodes, of equal weight, (n_points,
    # n_nodes)
    jump: ndarray

    @property
    def statical(self) -> bool:
        """True for the lower bound, whose strength is that of each corner."""
        return not self.strength[0, 1]

    @property
    def n(self) -> int:
        """Number of velocities."""
        return self.coordinates.shape[1]

    def of_body(self, forces: ndarray) -> ndarray:
        """Return the power of body forces (n_elements, 2), (n,)."""
        power, area = np.zeros(self.n), gradients(self.mesh)[1]
        part = (forces * area[:, None] / self.inside.shape[1])[:, None]
        np.add.at(power, self.inside, np.broadcast_to(part, self.inside.shape))
        return power

    def of_tractions(self, facets: ndarray, tractions: ndarray) -> ndarray:
        """Return the power of tractions (n_facets, 2 ends, 2), linear on each facet, (n,)."""
        power, lengths = np.zeros(self.n), facet_lengths(self.mesh)[facets]
        np.add.at(
            power, self.facets[facets], np.einsum("pe,fec,f->fpc", self.ends, tractions, lengths)
        )
        return power

    def on_facets(self, facets: ndarray, turned: ndarray) -> ndarray:
        """Return dofs of some facets, with their ends exchanged where turned."""
        found = self.facets[facets]
        found[turned, :2] = found[turned, 1::-1]
        return found


def stress_elements(mesh: MeshTri) -> Elements:
    """Return elements of the lower bound: linear stresses in equilibrium in triangles and at both
    ends of facets.

    Velocities are the multipliers of these equations, two of a triangle and four of a facet: linear
    tractions do the work of a rigid motion on its velocities (2 v_a + v_b) / 3 and (v_a + 2 v_b) /
    3.
    """
    ne, nf = mesh.nelements, mesh.nfacets
    gradient, area = gradients(mesh)
    B = np.zeros((ne, 3, 3, 14))
    B[..., :2] = -_strain(gradient[:, :, None] * area[:, None, None, None])  # -div sigma
    for m, ends in enumerate(_ENDS):
        normal = -gradient[:, 3 - sum(ends)] * area[:, None]  # outward, times half the length
        for slot, corner in enumerate(ends):
            B[:, corner, :, 2 + 4 * m + 2 * slot :][..., :2] = _strain(normal[:, None])
    facets = np.arange(4 * nf).reshape(nf, 2, 2)
    inside = 4 * nf + np.arange(2 * ne).reshape(ne, 1, 2)
    a, b = mesh.p[:, mesh.facets].transpose(1, 0, 2)
    thirds = np.stack([2 * a + b, a + 2 * b], axis=2).reshape(2, -1) / 3
    coordinates = np.repeat(np.hstack([thirds, mesh.p[:, mesh.t].mean(axis=1)]), 2, axis=1)
    dofs = np.hstack([inside[:, 0], facets[mesh.t2f.T].reshape(ne, 12)])
    return Elements(
        mesh,
        B,
        dofs,
        coordinates,
        facets,
        inside,
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
    basis = CellBasis(mesh, ElementVector(ElementTriP2()), quadrature=(_CORNERS, np.full(3, 1 / 6)))
    B, weight = strain_operator(basis, "full", "plane")
    ends, middles = basis.nodal_dofs.T[mesh.facets.T], basis.facet_dofs.T
    dofs = basis.element_dofs.T
    return Elements(
        mesh,
        B[:, :, [0, 1, 3]] * weight[:, :, None, None],
        dofs,
        basis.doflocs,
        facets=np.concatenate([ends, middles[:, None]], axis=1),
        inside=dofs[:, 6:].reshape(-1, 3, 2),
        ends=np.array([[1, 0], [0, 1], [2, 2]]) / 6,
        strength=(np.ones((3, 3)) + np.eye(3)) / 4,
        jump=np.array([[1, 0, 0], [0, 1, 0], [-0.5, -0.5, 2]]),
    )


def _strain(gradient: ndarray) -> ndarray:
    """Return rows xx, yy, xy of strain from gradients (..., n, 2) of n shape functions, (..., 3, 2
    n).
    """
    B = np.zeros((*gradient.shape[:-2], 3, gradient.shape[-2], 2))
    B[..., 0, :, 0] = B[..., 2, :, 1] = gradient[..., 0]
    B[..., 1, :, 1] = B[..., 2, :, 0] = gradient[..., 1]
    return B.reshape(*B.shape[:-2], -1)


class Block(NamedTuple):
    """Operators of equal shape; a dof of -1 is none."""

    B: ndarray  # (n, n_points, 3, n_local)
    points: ndarray  # (n, n_points)
    dofs: ndarray  # (n, n_local)

    def stiffness(self, D: ndarray) -> ndarray:
        """Return the sum of B^T D B over the points of each operator, (n, n_local, n_local); D is
        (n_points, 3, 3).
        """
        n, width = self.dofs.shape
        DB = np.matmul(D[self.points], self.B).reshape(n, -1, width)
        return np.matmul(self.B.reshape(n, -1, width).transpose(0, 2, 1), DB)


class Reduction(NamedTuple):
    """Reduction of all velocities of the elements, (n,), to the free dofs, (m,); motions are the
    last dofs.
    """

    number: ndarray  # free dof of each velocity, (n,); -1 where it is held or in a rigid body
    motions: ndarray  # velocities of the free motions of the rigid bodies, (n, n_motions)
    coordinates: ndarray  # of the free dofs, (2, m)

    @classmethod
    def of(
        cls, elements: Elements, used: ndarray, held: ndarray, tied: ndarray, rigid: ndarray
    ) -> Reduction:
        """Reduce to used velocities that are not held; pairs (2, n) are tied, triangles of rigid >=
        0 are bodies.
        """
        n = elements.n
        same = connected_components(
            coo_matrix((np.ones(tied.shape[1]), tuple(tied)), shape=(n, n)), directed=False
        )[1]
        fixed, body = np.isin(same, same[held]), np.full(n, -1)
        for b in range(rigid.max() + 1):
            body[np.isin(same, same[elements.dofs[rigid == b]])] = b
        plain = np.zeros(n, bool)
        plain[used] = True
        plain = np.flatnonzero(plain & ~fixed & (body < 0))
        number = np.full(n, -1)
        _, first, number[plain] = np.unique(same[plain], return_index=True, return_inverse=True)
        motions, coordinates = [np.zeros((n, 0))], [elements.coordinates[:, plain[first]]]
        for b in range(rigid.max() + 1):
            mine = np.flatnonzero(body == b)
            whole = rigid_modes(elements.coordinates, mine)
            free = (
                whole @ null_space(whole[fixed[mine]], rcond=_FREE) if fixed[mine].any() else whole
            )
            motions.append(np.zeros((n, free.shape[1])))
            motions[-1][mine] = free
            coordinates.append(
                np.repeat(
                    elements.coordinates[:, mine].mean(axis=1, keepdims=True), free.shape[1], 1
                )
            )
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
        single = csr_matrix((np.ones(len(plain)), (plain, self.number[plain])), shape=shape)
        return csr_matrix(hstack([single, csr_matrix(self.motions)]))

    def reduced(self, B: ndarray, points: ndarray, dofs: ndarray) -> list[Block]:
        """Return operators of the free dofs; those at rigid bodies have more columns and are a
        block of their own.
        """
        touching = np.isin(dofs, np.flatnonzero(self.motions.any(axis=1))).any(axis=1)
        blocks = [Block(B[~touching], points[~touching], self.number[dofs[~touching]])]
        B, points, dofs = B[touching], points[touching], dofs[touching]
        motion = self.motions[dofs]  # (n, n_local, n_motions)
        last = np.arange(self.size - motion.shape[2], self.size)
        reduced = np.hstack([self.number[dofs], np.where(motion.any(axis=1), last, -1)])
        blocks.append(
            Block(
                np.concatenate([B, np.einsum("epsl,elk->epsk", B, motion)], axis=3), points, reduced
            )
        )
        return [block for block in blocks if len(block.B)]


class Joint(NamedTuple):
    """Facets of slave and master that coincide, (n,), with operators, dofs and strength; the normal
    is the slave's.
    """

    slave: ndarray
    master: ndarray
    B: ndarray
    dofs: ndarray
    strength: Strength


@dataclass(eq=False)
class Program:
    r"""Stresses in equilibrium with loads, within the strength.

    .. math:: A \sigma = f_0 + \theta f_1, \qquad h - G \sigma \in Q

    with :math:`A = \sum B^T` over all points and a product Q of second-order cones.  Of the lower
    bound
    :math:`\sigma` is the solution and of the upper one the dual, the velocities.
    """

    blocks: list[Block]  # operators of triangles and joints
    strengths: list[
        Strength
    ]  # of the points by number: three of every triangle that can yield, then of the joints
    reduction: Reduction
    dead: ndarray  # fixed loads, (m,)
    live: ndarray  # multiplied loads, (m,)
    soft: ndarray  # triangles that can yield
    joints: list[Joint]

    _ordered: FreeBlock | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        self.starts = np.cumsum([0, *(len(s.reduced) for s in self.strengths)])
        self.n_points, self.size = int(self.starts[-1]), self.reduction.size
        cones = [strength.cones(int(first)) for strength, first in zip(self.strengths, self.starts)]
        self.cones = Cones.join([one for one, _ in cones] + [two for _, two in cones])
        #: Gathering and order of the normal matrix, a stiffness matrix, are found once for all D.
        self._gatherings, self._total = [Gathering(self.size) for _ in self.blocks], Total()
        self._engine = as_engine()

    def of_fixed_loads(self) -> Program:
        """Return the program of the fixed loads alone, where all strength is reduced."""
        strengths: list[Strength] = [
            replace(s, reduced=np.ones(len(s.reduced), bool)) for s in self.strengths
        ]
        return replace(self, strengths=strengths, live=np.zeros(self.size))

    def factor(self, D: ndarray) -> Callable[[ndarray], ndarray]:
        """Return the solution of A D A^T y = b for any b (m,), with D (n_points, 3, 3);
        ArithmeticError without one.
        """
        K = self._total.of(
            [
                gathering.matrix(block.dofs, block.stiffness(D))
                for gathering, block in zip(self._gatherings, self.blocks)
            ]
        )
        if not np.isfinite(K.data).all():
            raise ArithmeticError("the normal matrix is not finite")
        if self._ordered is None:
            self._ordered = FreeBlock(self._engine.order(K, self.reduction.coordinates))
        A, order = self._ordered.gather(K), self._ordered.order
        diagonal = A.diagonal()
        share = np.where(
            diagonal > 0.0, diagonal, diagonal.max()
        )  # nothing resists what has zero: a smooth joint

        def solve(b: ndarray) -> ndarray:
            y = np.empty_like(b)
            y[order] = inverse(np.ascontiguousarray(b[order]))
            return y

        for shift in _SHIFTS:
            A.setdiag(diagonal + shift * share)
            try:
                inverse = self._engine.factor(A, symmetric=True)
            except RuntimeError:
                continue
            return solve
        raise ArithmeticError("the normal matrix is singular")

    @cached_property
    def matrix(self) -> csr_matrix:
        """Matrix A, (m, 3 n_points)."""
        rows, columns, data = [], [], []
        for B, points, dofs in self.blocks:
            column = 3 * points[:, :, None, None] + np.arange(3)[:, None]
            row = np.broadcast_to(dofs[:, None, None], B.shape)
            used = (row >= 0) & (B != 0)
            rows.append(row[used])
            columns.append(np.broadcast_to(column, B.shape)[used])
            data.append(B[used])
        entries = np.concatenate(rows), np.concatenate(columns)
        return csr_matrix((np.concatenate(data), entries), shape=(self.size, 3 * self.n_points))

    @cached_property
    def transposed(self) -> csr_matrix:
        """Matrix A^T."""
        return self.matrix.T.tocsr()

    def forces(self, stress: ndarray) -> ndarray:
        """Return A times stresses (n_points, 3), (m,)."""
        return self.matrix @ stress.ravel()

    def strains(self, velocity: ndarray) -> ndarray:
        """Return strains times weight of velocities (m,), (n_points, 3)."""
        return (self.transposed @ velocity).reshape(-1, 3)

    def round_off(self, velocity: ndarray) -> ndarray:
        """Return the round-off of the strains at every point, (n_points,)."""
        size = (abs(self.transposed) @ np.abs(velocity)).reshape(-1, 3)
        return 8 * np.finfo(float).eps * size.max(axis=1)

    def of_points(self, function: Callable[[Strength, slice], ndarray]) -> ndarray:
        """Return values of a function of strength and its points, for all points."""
        parts = [
            function(s, slice(a, b))
            for s, a, b in zip(self.strengths, self.starts, self.starts[1:])
        ]
        return np.concatenate(parts)

    def of_triangles(self, values: ndarray) -> ndarray:
        """Return values (n_points, ...) at the corners of the triangles that can yield, (n_soft, 3,
        ...).
        """
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
