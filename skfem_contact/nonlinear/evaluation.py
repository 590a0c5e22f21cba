"""What the forms answer to a vector of unknowns, and what is raised where there is no equilibrium."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray

from ..forms.base import Response


@dataclass(frozen=True)
class Evaluation:
    """What the forms answer to a vector of unknowns.

    Attributes
    ----------
    z, responses
        Layout: displacements, and whatever else is sought; answers of the forms.
    residual
        Load less internal forces, zero at the fixed unknowns, (N,).
    norm
        Its norm, relative to the largest norm among the load and the forms' forces, without what is hidden.
    lag
        How much the unknowns differ from what is prescribed.
    hidden
        Part that the norm leaves out because it may be round-off.
    scale
        What the equations are multiplied by, (N,), where there are several fields.
    """

    z: ndarray
    responses: dict[str, Response]
    residual: ndarray
    norm: float
    lag: float = 0.0
    hidden: float = 0.0
    scale: ndarray | None = None

    @property
    def size(self) -> float:
        """Norm of the residual itself, in scaled equations."""
        return float(np.linalg.norm(self.residual if self.scale is None else self.scale * self.residual))

    @property
    def active(self) -> tuple[bytes, ...]:
        """Active sets of the forms."""
        return tuple(response.active for response in self.responses.values())

    @property
    def worst(self) -> int:
        """Unknown with the largest unbalanced force."""
        return int(np.argmax(np.abs(self.residual)))

    @property
    def states(self) -> dict[str, Any]:
        """Candidate states."""
        return {name: response.state for name, response in self.responses.items()}
