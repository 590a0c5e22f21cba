"""Augmented Lagrangian enforcement: an outer loop over the same contact forms (Uzawa)."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray

from ..materials.coulomb import Status
from .state import ContactState

#: Share of the traction that one augmentation should at most leave open; a penalty that leaves more is raised.
_WANTED = 0.05
_LARGEST_FACTOR = 1e3


@dataclass(frozen=True)
class AugmentedLagrangian:
    r"""Multipliers that take over the tractions until nothing penetrates: no penalty needs to be chosen.

    After an increment has converged, the tractions become multipliers,
    :math:`\lambda_N \leftarrow \lambda_N + \epsilon_N g`, and the increment is solved again: each time the
    penetration shrinks by the factor :math:`1 / (1 + \epsilon_N / k)`, where k is the stiffness of the bodies' surfaces.
    What is left of gap and elastic slip, times k, is the error of the tractions.  Where it shows the penalty to be
    too soft for fast progress, the penalty is raised.

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

    def augment(self, accepted: ContactState, candidate: ContactState, penalties: tuple[ndarray, ndarray],
                stiffness: ndarray) -> ContactState | None:
        """The accepted state with the candidate's tractions as multipliers, or None where they are good enough.

        Parameters
        ----------
        accepted, candidate
            State at the start of the increment, and the one that has been found.
        penalties
            Normal and tangential penalty at the points.
        stiffness
            Traction per displacement of the bodies' surfaces at the points.
        """
        largest = np.abs(candidate.normal).max(initial=0.0)
        error = max(self._error(candidate.status != Status.OPEN, candidate.normal - accepted.normal_multiplier,
                                penalties[0], stiffness),
                    self._error(candidate.status == Status.STICK,
                                candidate.tangential - accepted.tangential_multiplier, penalties[1], stiffness))
        if error <= self.tolerance * largest:
            return None
        factor = np.clip(error / (_WANTED * largest), 1.0, _LARGEST_FACTOR)
        return replace(accepted, normal_multiplier=candidate.normal, tangential_multiplier=candidate.tangential,
                       stiffening=accepted.stiffening * factor,
                       stick_point=accepted.arc - (accepted.arc - accepted.stick_point) / factor)

    @staticmethod
    def _error(active: ndarray, change: ndarray, penalty: ndarray, stiffness: ndarray) -> float:
        """Tractions that the gap (or the elastic slip) behind a change of traction stands for."""
        return float(np.abs(change[active] / penalty[active] * stiffness[active]).max(initial=0.0))
