"""SuperLU as an engine of the direct solver: scipy's factors in an order of our own."""

from __future__ import annotations

from collections.abc import Callable

from numpy import ndarray
from scipy.sparse import csc_matrix, csr_matrix
from scipy.sparse.linalg import splu

from .ordering import nested_dissection

DRIFT = 1.15  # growth of the factors from which the unknowns are ordered anew


class SuperLU:
    """Engine of scipy: `splu` in the order of a nested dissection.

    The rows are handed over as columns, since a csr_matrix is the transposed csc_matrix without a copy.
    """

    name = "SuperLU with nested dissection"

    def __init__(self) -> None:
        self._first_fill: int | None = None  # with the present order
        self._fill = 0

    def order(self, graph: csr_matrix, locations: ndarray) -> ndarray:
        """Order of elimination of the unknowns of `graph`."""
        self._first_fill = None
        return nested_dissection(graph, locations)

    def outdated(self) -> bool:
        """Whether contacts have moved so far that the order has lost its quality."""
        return self._first_fill is not None and self._fill > DRIFT * self._first_fill

    def factor(self, A: csr_matrix, symmetric: bool, careful: bool = False) -> Callable[[ndarray], ndarray]:
        """Solution of A x = b; `careful` pivots for accuracy rather than for sparsity.

        `symmetric` is PARDISO's concern: SuperLU has no factor for it.
        """
        transposed = csc_matrix((A.data, A.indices, A.indptr), shape=A.shape)
        transposed.has_canonical_format = True
        threshold, options = (1.0, {}) if careful else (0.01, {"SymmetricMode": True})
        lu = splu(transposed, permc_spec="NATURAL", diag_pivot_thresh=threshold, options=options)
        if not careful:
            self._fill = lu.nnz
            self._first_fill = self._first_fill or lu.nnz
        return lambda b: lu.solve(b, trans="T")  # type: ignore[call-overload]  # missing in the stubs
