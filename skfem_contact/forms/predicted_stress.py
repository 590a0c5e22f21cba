r"""Stresses that iterations predict at large strains.

A step of Newton's method changes strains by squares of its rotations and strains. The law turns
these into stresses, and the geometric part of the next tangent leads astray: along the axis of a
slender elastic body, which has hardly turned when it is stretched by its whole stiffness, and in
the mean stress of clay, many times its strength. As in a mixed formulation, iterations therefore
have stresses t of their own at the points. A step :math:`\delta u` of length a predicts them,

.. math::

    \delta t = t_c - t + D : \delta e(\delta u), \qquad t \leftarrow t + a\, \delta t ,

where :math:`t_c` are the ones of the law, D its moduli, and :math:`\delta e` the linearised change
of strain. The tangent has t in place of :math:`t_c`; eliminating :math:`\delta t` leaves the
residual of the law on the right-hand side, and no further dofs. In equilibrium both agree. This is
the iteration of D. Magisano, L. Leonetti and G. Garcea (Computer Methods in Applied Mechanics and
Engineering 313, 2017, 986-1005).

Elastic bodies predict whole stresses, but for systems with contact, which decides on the number of
iterations. Where volumes hardly change, the mean stress p alone is predicted, with the bulk modulus
k in place of D: other stresses are bounded where soil and metals yield.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray
from typing_extensions import override

from ..arrays import max_abs

if TYPE_CHECKING:
    from .finite import Deformation


class PredictedStress:
    """Stresses of the points of a body at some displacements, of the law or predicted.

    Parameters
    ----------
    deformation
        Deformation of the displacements.
    strain, stress : ndarray, shape (n_components, n_elements, n_points)
        Strains of an elastic body, None where some material may flow; stresses of the law.
    accepted : ndarray, shape (n_components, n_elements, n_points)
        Stresses of the last accepted state.
    of_law : ndarray, shape (..., n_elements, n_points)
        The part of the law's stresses that is predicted.
    """

    #: True where iterations need predictions in spite of contact.
    beside_contact = True

    def __init__(
        self,
        deformation: Deformation,
        strain: ndarray | None,
        stress: ndarray,
        accepted: ndarray,
        of_law: ndarray,
    ) -> None:
        self._deformation = deformation
        self._strain = strain
        self._stress = stress
        self._accepted = accepted
        self._of_law = of_law
        self._values = of_law
        self._change: tuple[ndarray, ndarray] | None = None  # of a step

    def strained(self, before: PredictedStress) -> float:
        """Return the largest change of a strain of an elastic body since another evaluation."""
        if self._strain is None or before._strain is None:
            return 0.0
        return float(max_abs(self._strain - before._strain))

    @property
    def made(self) -> bool:
        """True if the stresses are predicted ones."""
        return self._values is not self._of_law

    @property
    def stress(self) -> ndarray:
        """Stresses of the iterations."""
        raise NotImplementedError

    def begin(self, x: ndarray, before: ndarray | None = None, share: float = 0.0) -> None:
        """Take stresses that follow the ones of the last accepted state, at displacements `x`.

        If displacements `before` are known, a share of the change from there is added.
        """
        raise NotImplementedError

    def follow(self, before: PredictedStress, step: ndarray, length: float) -> None:
        """Take the stresses that a step predicts."""
        self._take(before._values + length * before.change(step))

    def _take(self, values: ndarray) -> None:
        self._values = values

    def change(self, step: ndarray) -> ndarray:
        """Return the change of the predicted stresses in a whole step."""
        if self._change is None or self._change[0] is not step:
            self._change = step, self._of_law - self._values + self._linear(step)
        return self._change[1]

    def _linear(self, step: ndarray) -> ndarray:
        """Return the stresses of the linearised change of strain in a step."""
        raise NotImplementedError

    def force(self) -> ndarray:
        """Return the internal force, (N,), of the predicted stresses less the ones of the law."""
        raise NotImplementedError

    def work(self, before: PredictedStress, step: ndarray) -> float:
        r"""Return :math:`\int (t_c - t) : D^{-1} : \delta t`: the equation of t along a step."""
        if not self.made:
            return 0.0
        return self._deformation.integral(self._work(before.change(step)))

    def _work(self, change: ndarray) -> ndarray:
        """Return the integrand. Whole stresses have none: full steps ask for no work."""
        raise NotImplementedError


class MeanStress(PredictedStress):
    """Mean stresses of a body whose volume hardly changes.

    Parameters
    ----------
    deformation, strain, stress, accepted
        As for :class:`PredictedStress`.
    bulk : ndarray, shape (n_elements, 1)
        Bulk moduli; zero where mean stresses are the ones of the law.
    """

    def __init__(
        self,
        deformation: Deformation,
        strain: ndarray | None,
        stress: ndarray,
        accepted: ndarray,
        bulk: ndarray,
    ) -> None:
        super().__init__(deformation, strain, stress, accepted, stress[:3].mean(axis=0))
        self._bulk = bulk
        self._predicted = bulk > 0.0

    @property
    @override
    def stress(self) -> ndarray:
        if not self.made:
            return self._stress
        stress = self._stress.copy()
        stress[:3] += self._values - self._of_law
        return stress

    @override
    def begin(self, x: ndarray, before: ndarray | None = None, share: float = 0.0) -> None:
        mean = self._accepted[:3].mean(axis=0)
        if before is not None:
            growth = self._deformation.log_growth
            mean += share * self._bulk * (growth(x) - growth(before))
        self._take(mean)

    @override
    def _take(self, values: ndarray) -> None:
        self._values = np.where(self._predicted, values, self._of_law)

    @override
    def _linear(self, step: ndarray) -> ndarray:
        return self._bulk * self._deformation.growth_of(step)

    @override
    def force(self) -> ndarray:
        return self._deformation.force_of_pressure(self._values - self._of_law)

    @override
    def _work(self, change: ndarray) -> ndarray:
        missing = self._of_law - self._values  # zero where there is no prediction
        strain = np.divide(missing, self._bulk, out=np.zeros_like(missing), where=self._predicted)
        return strain * change


class WholeStress(PredictedStress):
    """Stresses of an elastic body that changes its volume.

    Parameters
    ----------
    deformation, strain, stress, accepted
        As for :class:`PredictedStress`.
    moduli
        Return the function of the moduli dt / de at the points of some elements, in acting rows.
    strain_at
        Function of the elastic strains at displacements.
    """

    beside_contact = False

    def __init__(
        self,
        deformation: Deformation,
        strain: ndarray | None,
        stress: ndarray,
        accepted: ndarray,
        *,
        moduli: Callable[[], Callable[[slice], ndarray]],
        strain_at: Callable[[ndarray], ndarray],
    ) -> None:
        super().__init__(deformation, strain, stress, accepted, stress)
        self._moduli = moduli
        self._strain_at = strain_at

    @property
    @override
    def stress(self) -> ndarray:
        return self._values

    @override
    def begin(self, x: ndarray, before: ndarray | None = None, share: float = 0.0) -> None:
        # Bent bodies far from the accepted state must not begin with its stresses.
        if before is not None:
            last = self._strain_at(x) - self._strain_at(before)
            self._take(self._accepted + share * self._stress_of(last))

    @override
    def _linear(self, step: ndarray) -> ndarray:
        return self._stress_of(self._deformation.strain_of(step))

    def _stress_of(self, strain: ndarray) -> ndarray:
        """Return ``D : e``, zero in rows that do no work."""
        stress = np.zeros_like(strain)
        acting = self._deformation.acting
        moduli = self._moduli()
        for part in self._deformation.parts:
            e = strain[acting, part]
            t = np.matmul(moduli(part), e.reshape(len(acting), -1).T[:, :, None])
            stress[acting, part] = t[:, :, 0].T.reshape(e.shape)
        return stress

    @override
    def force(self) -> ndarray:
        return self._deformation.force(self._values - self._of_law)
