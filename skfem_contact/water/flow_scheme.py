"""Flow of water in a step in time: backward Euler, or with inertia generalised-alpha.

The water w that the nodes store grows by the rate r = -L(p), with the water L that leaves them at
the pressures p. The generalised-alpha method of first order (K. E. Jansen, C. H. Whiting and G. M.
Hulbert 2000, Comput. Methods Appl. Mech. Eng. 190, 305) has

    alpha r_(n+1) + (1 - alpha) r_n + gamma L(p_(n+1)) + (1 - gamma) L(p_n) = 0
    w_(n+1) = w_n + h ((1 - gamma) r_n + gamma r_(n+1))

with alpha = (3 - rho) / (2 + 2 rho) and gamma = 1 / (1 + rho). It averages pressures like the
method of second order for displacements with the same rho_inf. Without rates at the end,

    w_(n+1) - w_n + t ((1 - alpha / gamma) r_n + gamma L(p_(n+1)) + (1 - gamma) L(p_n)) = 0

with t = gamma h / alpha. Backward Euler is alpha = gamma = 1.
"""

from __future__ import annotations

from typing import NamedTuple

from numpy import ndarray


class FlowScheme(NamedTuple):
    """Parameters of a step."""

    alpha: float = 1.0
    gamma: float = 1.0

    @classmethod
    def of(cls, rho_inf: float) -> FlowScheme:
        """Return the parameters of a spectral radius at infinity."""
        return cls((3.0 - rho_inf) / (2.0 + 2.0 * rho_inf), 1.0 / (1.0 + rho_inf))

    def implicit(self, duration: float) -> float:
        """Return the time for which the flow by the pressures at the end counts."""
        return self.gamma**2 * duration / self.alpha

    def step(
        self,
        duration: float,
        rate: ndarray,
        before: ndarray,
        after: ndarray,
    ) -> tuple[ndarray, ndarray]:
        """Return the water that leaves the nodes in a step, and the rate at its end.

        Parameters
        ----------
        duration
            Length of the step.
        rate
            Rate at its start.
        before, after
            Water that leaves the nodes in a unit of time at the pressures of both ends.
        """
        alpha, gamma = self
        mean = gamma * after + (1.0 - gamma) * before
        left = (gamma * duration / alpha) * ((1.0 - alpha / gamma) * rate + mean)
        return left, -((1.0 - alpha) * rate + mean) / alpha
