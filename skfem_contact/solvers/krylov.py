"""Krylov methods with a preconditioner: conjugate gradients and FGMRES."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from scipy.linalg import eigh, solve_triangular
from scipy.sparse import spmatrix

from ..arrays import max_abs
from .in_threads import InThreads

#: Directions of FGMRES that are kept, two vectors each.
RESTART = 100
#: Share of a vector that is left of it by projections, below which round-off asks for others.
_LEFT = 0.7
#: Directions that are kept for the next solution, and iterations of a solution from which on they
#: are: their products with the matrix take as long as 3 iterations of multigrid.
_KEPT = 20
_FEW = 20
#: Share of the largest length below which directions depend on each other.
_DEPENDENT = 1e-12

Preconditioner = Callable[[ndarray], ndarray]


def conjugate_gradients(
    A: spmatrix | InThreads,
    b: ndarray,
    cycle: Preconditioner,
    tolerance: float,
    most: int,
) -> tuple[ndarray, int]:
    """Return the solution and the number of iterations; an A that is not definite ends them.

    The residual follows the recursion.  Recomputed from x every few iterations, the residual
    stagnates at 1e-7 on slender beams and then grows.
    """
    x = np.zeros_like(b)
    residual = b.copy()
    target = tolerance * np.linalg.norm(b)
    direction = np.zeros_like(b)
    product = np.inf
    for count in range(most):
        # make the direction conjugate to the last one, A d . d_last = 0
        preconditioned = cycle(residual)
        last = product
        product = float(residual @ preconditioned)
        direction = preconditioned + product / last * direction
        image = A @ direction
        curvature = float(direction @ image)
        if not curvature > 0.0:
            return x, count

        # minimise the energy along the direction
        length = product / curvature
        x += length * direction
        residual -= length * image
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
        self,
        A: spmatrix | InThreads,
        b: ndarray,
        cycle: Preconditioner,
        tolerance: float,
        most: int,
    ) -> tuple[ndarray, int]:
        """Return the solution and the number of iterations."""
        if self.forgets or self._slow.shape[1] != len(b):
            self._slow = np.zeros((0, len(b)))
        x = np.zeros_like(b)
        residual = b
        target = tolerance * float(np.linalg.norm(b))
        count = 0
        while count < most and float(np.linalg.norm(residual)) > target:
            # iterate in the space without the slow directions
            space = _Space.of(A, self._slow)
            first, residual = space.projected(residual)
            step, taken = space.arnoldi(A, residual, cycle, target, min(most - count, RESTART))

            # keep the directions that have slowed the iterations
            if taken >= _FEW and not self.forgets:
                self._slow = space.slowest()
            if taken == 0 or not np.isfinite(step).all():
                x = x + first
                break

            # recompute the residual
            x = x + first + step
            count += taken
            residual = b - A @ x
        return x, count


@dataclass(eq=False)
class _Space:
    """Some directions, and a Krylov space whose images are orthogonal to their images.

    The images of the steps are A steps^T = images^T shares + V R, with an orthonormal basis V.
    """

    directions: ndarray  # (n, N)
    images: ndarray  # A times the directions, orthonormal, (n, N)
    steps: ndarray  # of the Krylov space, (k, N)
    shares: ndarray  # of the directions' images, (n, k)
    R: ndarray  # triangular, (k, k)

    @classmethod
    def of(cls, A: spmatrix | InThreads, directions: ndarray) -> _Space:
        """Return the space of directions alone."""
        Q, R = np.linalg.qr(A @ directions.T)
        none = np.zeros((0, 0))
        least = _DEPENDENT * max_abs(R)
        independent = np.abs(np.diagonal(R)) > least
        if len(R) == 0 or not independent.all():
            directions = directions[:0]
            images = directions[:0]
        else:
            directions = solve_triangular(R, directions, trans="T", check_finite=False)
            images = np.ascontiguousarray(Q.T)
        return cls(directions, images, none, none, none)

    def projected(self, residual: ndarray) -> tuple[ndarray, ndarray]:
        """Return the step along the directions that reduces a residual most, and its residual."""
        along = self.images @ residual
        return along @ self.directions, residual - along @ self.images

    def arnoldi(
        self,
        A: spmatrix | InThreads,
        b: ndarray,
        cycle: Preconditioner,
        target: float,
        most: int,
    ) -> tuple[ndarray, int]:
        """Return the step of least residual, and the iterations, until it is small enough."""
        basis = np.empty((most + 1, len(b)))  # memory is taken as they are filled
        steps = np.empty((most, len(b)))
        R = np.zeros((most, most))
        shares = np.zeros((len(self.images), most))
        right = np.zeros(most + 1)
        right[0] = np.linalg.norm(b)
        basis[0] = b / right[0]
        turns: list[tuple[float, float]] = []
        k = 0
        while k < most and abs(right[k]) > target:
            # make the image of the next step orthogonal to the others
            steps[k] = cycle(basis[k])
            vector = A @ steps[k]
            shares[:, k] = self.images @ vector
            vector -= shares[:, k] @ self.images
            along, length = _orthogonal(basis[: k + 1], vector)

            # turn its column by Givens rotations
            column = np.append(along, length)
            for i, (cosine, sine) in enumerate(turns):
                column[i : i + 2] = (
                    cosine * column[i] + sine * column[i + 1],
                    cosine * column[i + 1] - sine * column[i],
                )
            diagonal = float(np.hypot(column[k], length))
            if not diagonal > 0.0:  # the cycle returned nothing new
                break
            cosine = column[k] / diagonal
            sine = length / diagonal
            turns.append((cosine, sine))
            R[:k, k] = column[:k]
            R[k, k] = diagonal
            right[k : k + 2] = cosine * right[k], -sine * right[k]
            k += 1
            if length > 0.0:
                basis[k] = vector / length

        # combine the steps, without the part of their images along the directions
        self.steps = steps[:k]
        self.shares = shares[:, :k]
        self.R = R[:k, :k]
        weights = solve_triangular(self.R, right[:k], check_finite=False)
        return weights @ self.steps - (self.shares @ weights) @ self.directions, k

    def slowest(self) -> ndarray:
        """Return the unit directions that the matrix changes least: harmonic Ritz vectors."""
        # compute products of directions and steps, of unit length, and of their images
        n, k = self.shares.shape
        images = np.block([[np.eye(n), self.shares], [np.zeros((k, n)), self.R]])
        own = self.directions @ self.directions.T
        mixed = self.directions @ self.steps.T
        stepped = self.steps @ self.steps.T
        lengths = np.block([[own, mixed], [mixed.T, stepped]])
        scale = 1.0 / np.sqrt(np.diagonal(lengths))
        lengths = scale[:, None] * lengths * scale
        lengths = lengths + _DEPENDENT * np.eye(len(scale))
        images = images * scale

        # minimise |A x| / |x|
        first = (0, _KEPT - 1)
        _, weights = eigh(images.T @ images, lengths, subset_by_index=first)
        weights = scale[:, None] * weights
        slow = weights[:n].T @ self.directions
        slow = slow + weights[n:].T @ self.steps
        size = np.linalg.norm(slow, axis=1)
        return np.asarray(slow / size[:, None])


def _orthogonal(basis: ndarray, vector: ndarray) -> tuple[ndarray, float]:
    """Make a vector orthogonal to a basis in place; return its shares of it, and its length."""
    before = float(np.linalg.norm(vector))
    along = basis @ vector
    vector -= along @ basis
    length = float(np.linalg.norm(vector))
    if length < _LEFT * before:
        again = basis @ vector
        vector -= again @ basis
        along = along + again
        length = float(np.linalg.norm(vector))
    return along, length
