"""Natural frequencies and modes by shift-invert Lanczos on the factor of the package."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy import ndarray
from scipy.linalg import cholesky, eigh
from scipy.sparse import csr_matrix, diags_array
from scipy.sparse.linalg import LinearOperator, eigsh

from ..solvers.direct import SingularSystem
from ..sparse import within

#: Up to so many masses, or so many for each mode, the whole flexibility is computed.
_FEW = 60
_EACH = 4
#: Shift of bodies that move freely, as a share of the largest ratio of stiffness to mass on the
#: diagonals; squares of frequencies below a hundred times the round-off of this ratio are zero.
_SHIFT = 1e-8
_ZERO = 1e-13

#: Factor of a matrix: function of a right-hand side, zero at supports.
Factor = Callable[[csr_matrix], Callable[[ndarray], ndarray]]


def modes_of(
    K: csr_matrix,
    M: csr_matrix,
    fixed: ndarray,
    factor: Factor,
    n: int,
) -> tuple[ndarray, ndarray]:
    """Return the lowest solutions of K x = w^2 M x.

    Parameters
    ----------
    K, M
        Stiffness, symmetric, and mass, (N, N).
    fixed
        Supported dofs.
    factor
        Function that factors a matrix.
    n
        Number of modes.

    Returns
    -------
    squares, shapes : ndarray, shapes (n,) and (N, n)
        Squares of angular frequencies, ascending, and modes with x^T M x = 1.

    Raises
    ------
    ValueError
        The model has fewer modes.
    """
    # Leave the mass of supports out
    free = np.ones(K.shape[0])
    free[fixed] = 0.0
    M = csr_matrix(diags_array(free) @ M @ diags_array(free))
    M.eliminate_zeros()
    massive = np.flatnonzero(M.diagonal() > 0.0)
    if n > len(massive):
        raise ValueError(f"there are {len(massive)} masses that are free to move, not {n} modes")

    # Factor K, or K with a little mass where bodies move freely
    ratio = K.diagonal()[massive] / M.diagonal()[massive]
    shift = 0.0
    try:
        solve = factor(K)
        solve(M @ np.ones(K.shape[0]))
    except SingularSystem:
        shift = _SHIFT * float(ratio.max())
        solve = factor(csr_matrix(K + shift * M))
    if len(massive) <= max(_FEW, _EACH * n):
        values, shapes = _dense(M, massive, solve, n)
        values = values - shift
    else:
        # Lanczos on K^-1 M: the largest values of 1 / (w^2 + shift)
        # with its type, which scipy would find by a vector of whole numbers
        inverse = LinearOperator(K.shape, lambda b: solve(np.ravel(b)), dtype=K.dtype)
        begin = solve(M @ np.random.default_rng(0).standard_normal(K.shape[0]))
        values, shapes = eigsh(
            K,
            n,
            M,
            sigma=-shift,
            OPinv=inverse,
            v0=begin,
            tol=1e-10,
        )
    order = np.argsort(values)
    squares = values[order]
    squares[np.abs(squares) < _ZERO * ratio.max()] = 0.0
    shapes = shapes[:, order]
    sizes = np.sqrt(np.einsum("nk,nk->k", shapes, M @ shapes))
    return squares, shapes / sizes


def _dense(
    M: csr_matrix,
    massive: ndarray,
    solve: Callable[[ndarray], ndarray],
    n: int,
) -> tuple[ndarray, ndarray]:
    """Return values and shapes of a few masses by their flexibility G: L^T G L y = y / w^2."""
    size = M.shape[0]
    # M = L L^T
    L = cholesky(within(M, massive).toarray(), lower=True)
    columns = np.zeros((size, len(massive)))
    for k in range(len(massive)):
        force = np.zeros(size)
        force[massive] = L[:, k]
        columns[:, k] = solve(force)
    # L^T G L by one solution for each mass
    flexibility = L.T @ columns[massive]
    inverse, y = eigh(0.5 * (flexibility + flexibility.T))
    chosen = np.argsort(inverse)[::-1][:n]
    return 1.0 / inverse[chosen], columns @ y[:, chosen]
