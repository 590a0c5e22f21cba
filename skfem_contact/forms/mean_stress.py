r"""Mean stresses that iterations predict, where volumes hardly change at large strains.

A step of Newton's method changes volumes by squares of its strains. The law turns these into mean
stresses of the bulk modulus, many times the strength of soft clay, and the geometric part of the
next tangent leads astray. As in a mixed formulation, iterations therefore have a mean stress p of
their own at each point. A step :math:`\delta u` of length a predicts it,

.. math::

    \delta p = p_c - p + k\, F^{-T} : \nabla \delta u, \qquad p \leftarrow p + a\, \delta p ,

where :math:`p_c` is the one of the law and k the bulk modulus. The tangent has p in place of
:math:`p_c`; eliminating :math:`\delta p` leaves the residual of the law on the right-hand side, and
no further dofs. In equilibrium both agree. This is the iteration of D. Magisano, L. Leonetti and
G. Garcea (Computer Methods in Applied Mechanics and Engineering 313, 2017, 986-1005) with mean
stresses alone: other parts of the stress are bounded where soil and metals yield.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray

if TYPE_CHECKING:
    from .finite import Deformation


class MeanStress:
    """Mean stresses of the points of a body at some displacements.

    Parameters
    ----------
    deformation
        Deformation of the displacements.
    stress : ndarray, shape (n_components, n_elements, n_points)
        Stresses of the law.
    accepted : ndarray, shape (n_components, n_elements, n_points)
        Stresses of the last accepted state.
    bulk : ndarray, shape (n_elements, 1)
        Bulk moduli; zero where mean stresses are the ones of the law.
    """

    def __init__(
        self,
        deformation: Deformation,
        stress: ndarray,
        accepted: ndarray,
        bulk: ndarray,
    ) -> None:
        self._deformation = deformation
        self._stress = stress
        self._accepted = accepted
        self._bulk = bulk
        self._predicted = bulk > 0.0
        self._of_law = stress[:3].mean(axis=0)
        self._mean = self._of_law
        self._change: tuple[ndarray, ndarray] | None = None  # of a step

    @property
    def stress(self) -> ndarray:
        """Stresses of the law with the mean stress of the iterations."""
        if self._mean is self._of_law:
            return self._stress
        stress = self._stress.copy()
        stress[:3] += self._mean - self._of_law
        return stress

    def begin(self, x: ndarray, before: ndarray | None = None, share: float = 0.0) -> None:
        """Take the mean stresses of the last accepted state, at displacements `x`.

        If displacements `before` are known, a share of the change from there follows.
        """
        mean = self._accepted[:3].mean(axis=0)
        if before is not None:
            growth = self._deformation.log_growth
            mean += share * self._bulk * (growth(x) - growth(before))
        self._mean = np.where(self._predicted, mean, self._of_law)

    def follow(self, before: MeanStress, step: ndarray, length: float) -> None:
        """Take the mean stresses that a step predicts."""
        mean = before._mean + length * before.change(step)
        self._mean = np.where(self._predicted, mean, self._of_law)

    def change(self, step: ndarray) -> ndarray:
        """Return the change of p in a whole step, (n_elements, n_points)."""
        if self._change is None or self._change[0] is not step:
            linear = self._bulk * self._deformation.growth_of(step)
            self._change = (step, self._of_law - self._mean + linear)
        return self._change[1]

    def force(self) -> ndarray:
        """Return the internal force, (N,), of the mean stresses less the ones of the law."""
        return self._deformation.force_of_pressure(self._mean - self._of_law)

    def work(self, change: ndarray) -> float:
        r"""Return :math:`\int (p_c - p) \delta p / k`: the equation of p along a change."""
        missing = self._of_law - self._mean  # zero where there is no prediction
        strain = np.divide(missing, self._bulk, out=np.zeros_like(missing), where=self._predicted)
        return self._deformation.integral(strain * change)
