"""Augmented Lagrangian enforcement: an outer loop over the same contact forms (Uzawa)."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray

from ..materials.coulomb import Status
from .quadrature import SlavePoints
from .state import ContactState

#: Penalty over the stiffness of the surfaces that the method goes to from whatever it was given.
_WANTED = 10.0
_LARGEST_FACTOR = 1e3


@dataclass(frozen=True)
class AugmentedLagrangian:
    r"""Multipliers that take over the tractions until nothing penetrates: no penalty needs to be chosen.

    After an increment has converged, the tractions become multipliers,
    :math:`\lambda_N \leftarrow \lambda_N + \epsilon_N \bar g`, and the increment is solved again: each time the
    penetration shrinks by the factor :math:`1 / (1 + \epsilon_N / k)`, where k is the stiffness of the bodies'
    surfaces.  What is left of gap and elastic slip, times k, is the error of the tractions.

    The multipliers live at the slave's nodes and gaps enter as their weighted means there: multipliers at every
    Gauss point would constrain more than the nodes can follow.  A penalty that was chosen badly is replaced after
    the first solution.

    Parameters
    ----------
    tolerance
        Error of the tractions, relative to the largest one, that is small enough.

    Raises
    ------
    ValueError
        Tolerance outside (0, 1).

    Examples
    --------
    >>> from skfem_contact import AugmentedLagrangian
    >>> AugmentedLagrangian().tolerance
    0.0001
    """

    tolerance: float = 1e-4

    def __post_init__(self) -> None:
        if not 0 < self.tolerance < 1:
            raise ValueError(f"AugmentedLagrangian: tolerance must lie in (0, 1), not {self.tolerance!r}")

    def augment(self, accepted: ContactState, candidate: ContactState, points: SlavePoints,
                penalties: tuple[float, float], stiffness: float) -> ContactState | None:
        """The accepted state with improved multipliers, or None where they are good enough.

        Parameters
        ----------
        accepted, candidate
            State at the start of the increment, and the one that has been found.
        points
            The slave's points.
        penalties
            Normal and tangential penalty.
        stiffness
            Traction per displacement of the bodies' surfaces.
        """
        normal = np.minimum(_improved(points, candidate.normal, accepted.normal_multiplier), 0.0)
        tangential = _improved(points, candidate.tangential, accepted.tangential_multiplier)
        # a sliding point's traction follows from the normal one; only where it sticks is its elastic slip an error
        sticks = _nodal_mean(points, candidate.status == Status.STICK) > 0.99
        error = stiffness * max(
            np.abs(normal - accepted.normal_multiplier).max() / penalties[0],
            np.abs(tangential - accepted.tangential_multiplier)[sticks].max(initial=0.0) / penalties[1])
        if error <= self.tolerance * np.abs(candidate.normal).max(initial=0.0):
            return None
        factor = float(np.clip(_WANTED * stiffness / penalties[0], 1.0 / _LARGEST_FACTOR, _LARGEST_FACTOR))
        return replace(accepted, normal_multiplier=normal, tangential_multiplier=tangential,
                       stiffening=accepted.stiffening * factor,
                       stick_point=accepted.arc - (accepted.arc - accepted.stick_point) / factor)


def _improved(points: SlavePoints, traction: ndarray, multiplier: ndarray) -> ndarray:
    """Multipliers raised by the weighted means of what the tractions exceed them by."""
    return multiplier + _nodal_mean(points, traction - points.at(multiplier))


def _nodal_mean(points: SlavePoints, values: ndarray) -> ndarray:
    """Means of values at the points, weighted by the shape functions of each slave node."""
    share = points.values * points.weight[:, None]
    n = points.nodes.max() + 1
    return np.asarray(np.bincount(points.nodes.ravel(), (share * values[:, None]).ravel(), n)
                      / np.bincount(points.nodes.ravel(), share.ravel(), n))
