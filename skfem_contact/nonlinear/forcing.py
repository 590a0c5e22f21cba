"""Accuracy of the linear solutions that Newton's method needs on its way."""

from __future__ import annotations

from ..solvers.direct import REFINE
from .newton import Evaluation

#: Relative residual of a linear solution far from equilibrium, and the largest one below a residual
#: of the third number: a footing of 36,501 dofs in space takes 36 iterations and 271 of the linear
#: solver, one of 98,301 takes 57 and 524. With terms of Eisenstat and Walker from the start the
#: first takes 36 and 266, with .01 for .03 38 and 349.
_LOOSEST = 3e-2
_LOOSE = 1e-2
_NEAR = 1e-3
#: Residual of a linear solution over the square of the last reduction, and over the final
#: tolerance.
_SQUARE = 0.9
_FINAL = 0.1


class Forcing:
    """Forcing terms of an inexact Newton method: relative residuals of its linear solutions.

    Near equilibrium they follow the square of the last reduction of the residual, so that the
    convergence stays quadratic, and are no smaller than the final tolerance needs.

    References
    ----------
    S. C. Eisenstat, H. F. Walker, Choosing the forcing terms in an inexact Newton method, SIAM J.
    Sci. Comput. 17 (1996) 16-32, equation 2.6.
    """

    def __init__(self, tolerance: float) -> None:
        self._tolerance = tolerance
        self._last: float | None = None

    def at(self, now: Evaluation) -> float:
        """Return the relative residual that the Newton step at an evaluation may leave."""
        last, self._last = self._last, now.norm if now.lag == 0.0 else None
        if last is None or now.lag != 0.0 or now.norm > _NEAR:
            return _LOOSEST
        term = max(_SQUARE * (now.norm / last) ** 2, _FINAL * self._tolerance / now.norm)
        return min(max(term, REFINE), _LOOSE)
