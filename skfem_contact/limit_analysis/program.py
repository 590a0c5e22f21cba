"""One cone program for both bounds, and the matrix of its normal equations."""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix

from ..solvers.direct import as_engine
from ..sparse import FreeBlock, Gathering, Total
from .contact import Joint
from .elements import Block, Layout
from .strength import Cones, Strength

#: Shares of the diagonal that are added, one after the other, until the matrix has a factor: equations of the lower
#: bound depend on each other where two straight lines cross at a node.
_SHIFTS = (1e-14, 1e-11, 1e-8)


@dataclass(eq=False)
class Program:
    r"""Stresses in equilibrium with loads, within the strength.

    .. math:: A \sigma = f_0 + \theta f_1, \qquad h - G \sigma \in Q

    with :math:`A = \sum B^T` over all points and a product Q of second-order cones.  Of the lower bound
    :math:`\sigma` is the solution and of the upper one the dual, the velocities.

    Attributes
    ----------
    blocks
        Operators of triangles and interfaces.
    strengths
        Strength of the points in the order of their numbers: those of the triangles, three each, then of the joints.
    unknowns
        The free velocities, (m,).
    dead, live
        Loads that are fixed, and multiplied, (m,).
    soft, joints
        Triangles that can yield, and joints, in the order of their points.
    """

    blocks: list[Block]
    strengths: list[Strength]
    unknowns: Layout
    dead: ndarray
    live: ndarray
    soft: ndarray
    joints: list[Joint]

    def __post_init__(self) -> None:
        self.starts = np.cumsum([0, *(len(s.reduced) for s in self.strengths)])
        self.n_points, self.size = int(self.starts[-1]), self.unknowns.size
        cones = [strength.cones(int(first)) for strength, first in zip(self.strengths, self.starts)]
        self.cones = Cones.join([one for one, _ in cones] + [two for _, two in cones])

    def of_fixed_loads(self) -> Program:
        """The fixed loads alone, where all strength is reduced: its factor says whether anything stands at all."""
        strengths: list[Strength] = [replace(s, reduced=np.ones(len(s.reduced), bool)) for s in self.strengths]
        return replace(self, strengths=strengths, live=np.zeros(self.size))

    @cached_property
    def normal(self) -> NormalMatrix:
        """The matrix of the normal equations."""
        return NormalMatrix(self.blocks, self.unknowns.places)

    @cached_property
    def matrix(self) -> csr_matrix:
        """The matrix A, (m, 3 n_points)."""
        rows, columns, data = [], [], []
        for B, points, dofs in self.blocks:
            column = 3 * points[:, :, None, None] + np.arange(3)[:, None]
            row = np.broadcast_to(dofs[:, None, None], B.shape)
            used = (row >= 0) & (B != 0)
            rows.append(row[used])
            columns.append(np.broadcast_to(column, B.shape)[used])
            data.append(B[used])
        place = np.concatenate(rows), np.concatenate(columns)
        return csr_matrix((np.concatenate(data), place), shape=(self.size, 3 * self.n_points))

    @cached_property
    def transposed(self) -> csr_matrix:
        """The matrix A^T."""
        return self.matrix.T.tocsr()

    def forces(self, stress: ndarray) -> ndarray:
        """A times stresses (n_points, 3), (m,)."""
        return self.matrix @ stress.ravel()

    def strains(self, velocity: ndarray) -> ndarray:
        """Strains times weight of velocities (m,), (n_points, 3)."""
        return (self.transposed @ velocity).reshape(-1, 3)

    def round_off(self, velocity: ndarray) -> ndarray:
        """Round-off of the strains at every point, (n_points,)."""
        size = (abs(self.transposed) @ np.abs(velocity)).reshape(-1, 3)
        return 8 * np.finfo(float).eps * size.max(axis=1)

    def of_points(self, function: Callable[[Strength, slice], ndarray]) -> ndarray:
        """What a function of strength and its points gives, for all points."""
        parts = [function(s, slice(a, b)) for s, a, b in zip(self.strengths, self.starts, self.starts[1:])]
        return np.concatenate(parts)

    def of_triangles(self, values: ndarray) -> ndarray:
        """Values of all points, (n_points, ...), at the corners of those that can yield, (n_soft, 3, ...)."""
        n = len(self.soft)
        return values[:3 * n].reshape(n, 3, *values.shape[1:])

    @cached_property
    def volume(self) -> ndarray:
        """Component of strain that is the change of volume or the opening, (n_points, 3)."""
        return self.of_points(lambda s, points: np.broadcast_to(s.volume, (points.stop - points.start, 3)))


class NormalMatrix:
    """Sum of B^T D B over all points, for many D (n_points, 3, 3): a stiffness matrix, whose order is found once."""

    def __init__(self, blocks: list[Block], places: ndarray) -> None:
        self.blocks, self._places = blocks, places
        self._gatherings, self._total = [Gathering(places.shape[1]) for _ in blocks], Total()
        self._engine = as_engine()
        self._ordered: FreeBlock | None = None

    def factor(self, D: ndarray) -> Callable[[ndarray], ndarray]:
        """Solution of (sum of B^T D B) y = b for any b (m,); ArithmeticError where there is no factor."""
        K = self._total.of([gathering.matrix(block.dofs, block.stiffness(D))
                            for gathering, block in zip(self._gatherings, self.blocks)])
        if not np.isfinite(K.data).all():
            raise ArithmeticError("the normal matrix is not finite")
        if self._ordered is None:
            self._ordered = FreeBlock(self._engine.order(K, self._places))
        A, order = self._ordered.gather(K), self._ordered.order
        diagonal = A.diagonal()

        def solve(b: ndarray) -> ndarray:
            y = np.empty_like(b)
            y[order] = inverse(np.ascontiguousarray(b[order]))
            return y

        for shift in _SHIFTS:
            A.setdiag(diagonal * (1.0 + shift))
            try:
                inverse = self._engine.factor(A, symmetric=True)
            except RuntimeError:
                continue
            return solve
        raise ArithmeticError("the normal matrix is singular")
