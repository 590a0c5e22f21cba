"""What the forms answer to a vector of unknowns, and what is raised where there is no equilibrium."""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray

from ..forms import Response


class NotConverged(RuntimeError):
    """Newton's method found no equilibrium; whether there is one remains open.

    Attributes
    ----------
    result
        The stages and increments that were accepted before, as far as they came.
    x
        The displacements that were reached, (N,).
    residuals
        History of the residual.
    unknown
        Where the largest unbalanced force acts, or the first unknown that can move freely.
    """

    result: Any = None

    def __init__(self, message: str, x: ndarray | None = None, residuals: Sequence[float] = (),
                 unknown: int | None = None) -> None:
        super().__init__(message)
        self.x, self.residuals, self.unknown = x, tuple(residuals), unknown


class NoEquilibrium(NotConverged):
    """The bodies collapse under this load: they move on and on, and the load does more work than they resist.

    With associated flow the residual is the gradient of a convex potential.  A line search along this energy
    finds its minimum if there is one; where there is none, which is what collapse means, it runs away along the
    mechanism.  A hundred times the elastic displacements are taken for that.  With friction and
    non-associated flow there is no potential, but the mechanism is found in the same way.
    """


@dataclass(frozen=True)
class Evaluation:
    """What the forms answer to a vector of unknowns.

    Attributes
    ----------
    z
        Unknowns: displacements, and whatever else is sought.
    responses
        Answers of the forms.
    residual
        Load less internal forces, zero at the fixed unknowns, (N,).
    norm
        Its norm, relative to the largest norm among the load and the forms' forces, without what is hidden.
    lag
        How much the unknowns differ from what is prescribed.
    hidden
        Part that the norm leaves out because it may be round-off.
    """

    z: ndarray
    responses: dict[str, Response]
    residual: ndarray
    norm: float
    lag: float = 0.0
    hidden: float = 0.0

    @property
    def worst(self) -> int:
        """Unknown with the largest unbalanced force."""
        return int(np.argmax(np.abs(self.residual)))

    @property
    def states(self) -> dict[str, Any]:
        """Candidate states."""
        return {name: response.state for name, response in self.responses.items()}
