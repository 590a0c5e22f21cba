"""Krylov methods with a preconditioner: conjugate gradients and FGMRES."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.linalg import eigh, solve_triangular
from scipy.sparse import csr_matrix

#: Directions of FGMRES that are kept, two vectors each.
RESTART = 100
#: Share of a vector that is left of it by projections, below which round-off asks for others.
_LEFT = 0.7
#: Directions that are kept for the next solution, and iterations of a solution from which on they
#: are: their products with the matrix take as long as 3 iterations of multigrid.
_KEPT, _FEW = 20, 20
#: Share of the largest length below which directions depend on each other.
_DEPENDENT = 1e-12

Preconditioner = Callable[[ndarray], ndarray]


def conjugate_gradients(
    A: csr_matrix, b: ndarray, cycle: Preconditioner, tolerance: float, most: int
) -> tuple[ndarray, int]:
    """Return the solution and the number of iterations; an A that is not definite ends them.

    The residual follows the recursion.  Recomputed from x every few iterations, the residual
    stagnates at 1e-7 on slender beams and then grows.
    """
    x, residual, target = np.zeros_like(b), b.copy(), tolerance * np.linalg.norm(b)
    direction, product = np.zeros_like(b), np.inf
    for count in range(most):
        preconditioned = cycle(residual)
        product, last = float(residual @ preconditioned), product
        direction = preconditioned + product / last * direction
        image = A @ direction
        curvature = float(direction @ image)
        if not curvature > 0.0:
            return x, count
        x += product / curvature * direction
        residual -= product / curvature * image
        if np.linalg.norm(residual) <= target:
            return x, count + 1
    return x, most


class Fgmres:
    """FGMRES that begins with the directions in which the solution before was slow.

    Tangents of Newton's method resemble each other: a mechanism that is nearly free to move in one
    is so in the next. Of a footing with 285,660 dofs near equilibrium solutions take 87, 32 and 48
    iterations for 128, 94 and 78 without.

    References
    ----------
    Y. Saad, A flexible inner-outer preconditioned GMRES algorithm, SIAM J. Sci. Comput. 14 (1993)
    461-469. M. L. Parks, E. de Sturler, G. Mackey, D. D. Johnson, S. Maiti, Recycling Krylov
    subspaces for sequences of linear systems, SIAM J. Sci. Comput. 28 (2006) 1651-1674.
    """

    def __init__(self) -> None:
        self.forgets = False
        self._slow = np.zeros((0, 0))

    def __call__(
        self, A: csr_matrix, b: ndarray, cycle: Preconditioner, tolerance: float, most: int
    ) -> tuple[ndarray, int]:
        """Return the solution and the number of iterations."""
        if self.forgets or self._slow.shape[1] != len(b):
            self._slow = np.zeros((0, len(b)))
        x, residual, target, count = np.zeros_like(b), b, tolerance * float(np.linalg.norm(b)), 0
        while count < most and float(np.linalg.norm(residual)) > target:
            space = _Space.of(A, self._slow)
            first, residual = space.projected(residual)
            step, taken = space.arnoldi(A, residual, cycle, target, min(most - count, RESTART))
            if taken >= _FEW and not self.forgets:
                self._slow = space.slowest()
            if taken == 0 or not np.isfinite(step).all():
                x = x + first
                break
            x, count = x + first + step, count + taken
            residual = b - A @ x
        return x, count


@dataclass(eq=False)
class _Space:
    """Krylov space beside some directions.

    Attributes
    ----------
    directions, images : ndarray, shape (n, N)
        Directions, and what the matrix makes of them, which is orthonormal.
    steps : ndarray, shape (k, N)
        Steps of the Krylov space; A times them is made of the images, by `beside`, and of an
        orthonormal basis.
    R : ndarray, shape (k, k)
        Triangular factor of the coefficients of this basis.
    """

    directions: ndarray
    images: ndarray
    steps: ndarray
    beside: ndarray
    R: ndarray

    @classmethod
    def of(cls, A: csr_matrix, directions: ndarray) -> _Space:
        """Return the space of directions alone."""
        Q, R = np.linalg.qr(A @ directions.T)
        independent = np.abs(np.diagonal(R)) > _DEPENDENT * np.abs(R).max(initial=0.0)
        if not independent.all():
            directions, Q, R = directions[:0], Q[:, :0], R[:0, :0]
        none = np.zeros((0, 0))
        return cls(
            solve_triangular(R, directions, trans="T", check_finite=False)
            if len(R)
            else directions,
            np.ascontiguousarray(Q.T),
            none,
            none,
            none,
        )

    def projected(self, residual: ndarray) -> tuple[ndarray, ndarray]:
        """Return the step along the directions that reduces a residual most, and the residual that
        it leaves.
        """
        along = self.images @ residual
        return along @ self.directions, residual - along @ self.images

    def arnoldi(
        self, A: csr_matrix, b: ndarray, cycle: Preconditioner, target: float, most: int
    ) -> tuple[ndarray, int]:
        """Return the step of least residual, and the iterations, in a space that grows until this
        is small enough.
        """
        basis, steps = (
            np.empty((most + 1, len(b))),
            np.empty((most, len(b))),
        )  # memory is taken as they are filled
        R, right, beside = (
            np.zeros((most, most)),
            np.zeros(most + 1),
            np.zeros((len(self.images), most)),
        )
        right[0] = np.linalg.norm(b)
        basis[0], k = b / right[0], 0
        turns: list[tuple[float, float]] = []
        while k < most and abs(right[k]) > target:
            steps[k] = cycle(basis[k])
            vector = A @ steps[k]
            beside[:, k] = self.images @ vector
            vector -= beside[:, k] @ self.images
            along, left = _orthogonal(basis[: k + 1], vector)
            column = np.append(along, left)
            for i, (cosine, sine) in enumerate(turns):  # Givens rotations
                column[i : i + 2] = (
                    cosine * column[i] + sine * column[i + 1],
                    cosine * column[i + 1] - sine * column[i],
                )
            length = float(np.hypot(column[k], left))
            if not length > 0.0:  # the cycle returned nothing new
                break
            turns.append((column[k] / length, left / length))
            R[:k, k], R[k, k] = column[:k], length
            right[k : k + 2] = turns[k][0] * right[k], -turns[k][1] * right[k]
            k += 1
            if left > 0.0:
                basis[k] = vector / left
        self.steps, self.beside, self.R = steps[:k], beside[:, :k], R[:k, :k]
        shares = solve_triangular(self.R, right[:k], check_finite=False)
        return shares @ self.steps - (self.beside @ shares) @ self.directions, k

    def slowest(self) -> ndarray:
        """Return the directions that the matrix changes least, over their length: harmonic Ritz
        vectors.
        """
        n, k = self.beside.shape
        images = np.block([[np.eye(n), self.beside], [np.zeros((k, n)), self.R]])
        mixed = self.directions @ self.steps.T
        lengths = np.block(
            [[self.directions @ self.directions.T, mixed], [mixed.T, self.steps @ self.steps.T]]
        )
        scale = 1.0 / np.sqrt(np.diagonal(lengths))
        lengths = scale[:, None] * lengths * scale + _DEPENDENT * np.eye(len(scale))
        images = images * scale
        shares = (
            scale[:, None] * eigh(images.T @ images, lengths, subset_by_index=(0, _KEPT - 1))[1]
        )
        found = shares[:n].T @ self.directions + shares[n:].T @ self.steps
        return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])


def _orthogonal(basis: ndarray, vector: ndarray) -> tuple[ndarray, float]:
    """Make a vector orthogonal to a basis in place; return what was along the basis, and the length
    that is left.
    """
    before = float(np.linalg.norm(vector))
    along = basis @ vector
    vector -= along @ basis
    left = float(np.linalg.norm(vector))
    if left < _LEFT * before:
        again = basis @ vector
        vector -= again @ basis
        along, left = along + again, float(np.linalg.norm(vector))
    return along, left
