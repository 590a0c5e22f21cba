"""Krylov methods with a preconditioner: conjugate gradients and FGMRES."""
from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy import ndarray
from scipy.linalg import solve_triangular
from scipy.sparse import csr_matrix

#: Directions of FGMRES that are kept, two vectors each.
RESTART = 100
#: Share of a vector that is left of it by projections, below which round-off asks for others.
_LEFT = 0.7

Preconditioner = Callable[[ndarray], ndarray]


def conjugate_gradients(A: csr_matrix, b: ndarray, cycle: Preconditioner, tolerance: float, most: int
                        ) -> tuple[ndarray, int]:
    """Return the solution and the number of iterations; an A that is not definite ends them.

    The residual follows the recursion.  Recomputed from x every few iterations, the residual stagnates at 1e-7 on
    slender beams and then grows.
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


def fgmres(A: csr_matrix, b: ndarray, cycle: Preconditioner, tolerance: float, most: int) -> tuple[ndarray, int]:
    """Return the solution and the number of iterations.

    Y. Saad, A flexible inner-outer preconditioned GMRES algorithm, SIAM J. Sci. Comput. 14 (1993) 461-469.
    """
    x, residual, target, count = np.zeros_like(b), b, tolerance * float(np.linalg.norm(b)), 0
    while count < most and float(np.linalg.norm(residual)) > target:
        step, taken = _arnoldi(A, residual, cycle, target, min(most - count, RESTART))
        if taken == 0 or not np.isfinite(step).all():
            break
        x, count = x + step, count + taken
        residual = b - A @ x
    return x, count


def _arnoldi(A: csr_matrix, b: ndarray, cycle: Preconditioner, target: float, most: int) -> tuple[ndarray, int]:
    """Return the step of least residual in a Krylov space, which grows until the residual is small enough."""
    basis, steps = np.empty((most + 1, len(b))), np.empty((most, len(b)))  # memory is taken as they are filled
    R, right = np.zeros((most, most)), np.zeros(most + 1)
    right[0] = np.linalg.norm(b)
    basis[0], k = b / right[0], 0
    turns: list[tuple[float, float]] = []
    while k < most and abs(right[k]) > target:
        steps[k] = cycle(basis[k])
        vector = A @ steps[k]
        along, left = _orthogonal(basis[:k + 1], vector)
        column = np.append(along, left)
        for i, (cosine, sine) in enumerate(turns):  # Givens rotations
            column[i:i + 2] = cosine * column[i] + sine * column[i + 1], cosine * column[i + 1] - sine * column[i]
        length = float(np.hypot(column[k], left))
        if not length > 0.0:  # the cycle returned nothing new
            break
        turns.append((column[k] / length, left / length))
        R[:k, k], R[k, k] = column[:k], length
        right[k:k + 2] = turns[k][0] * right[k], -turns[k][1] * right[k]
        k += 1
        if left > 0.0:
            basis[k] = vector / left
    return solve_triangular(R[:k, :k], right[:k], check_finite=False) @ steps[:k], k


def _orthogonal(basis: ndarray, vector: ndarray) -> tuple[ndarray, float]:
    """Make a vector orthogonal to a basis in place; return what was along the basis, and the length that is left."""
    before = float(np.linalg.norm(vector))
    along = basis @ vector
    vector -= along @ basis
    left = float(np.linalg.norm(vector))
    if left < _LEFT * before:
        again = basis @ vector
        vector -= again @ basis
        along, left = along + again, float(np.linalg.norm(vector))
    return along, left
