"""Return mapping to the circular cone of Drucker and Prager, and its limit, the cylinder of von Mises.

The yield function is sqrt(J2) + alpha I1 - k with the first invariant I1 of the stress (tension positive) and
the second invariant J2 of its deviator; the plastic potential is the same with beta for alpha. The return is
radial in the deviator, to the cone or to its apex I1 = k / alpha.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .base import Array, Parameter
from .plastic import IsotropicPlasticity, Return, chosen
from .spectral import mean_and_shear


class ConeConstants(NamedTuple):
    """Constants of the cone: floats, or arrays over elements or points."""

    lam: Parameter
    mu: Parameter
    alpha: Parameter
    beta: Parameter
    k: Parameter


@dataclass(frozen=True, eq=False)
class ConePlasticity(IsotropicPlasticity):
    """Base of the laws with a circular cone or cylinder; a law adds its parameters and constants."""

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is symmetric: the flow is associated."""
        constants = self._constants()
        return bool(np.all(constants.alpha == constants.beta))

    def _yield_bound(self, stress: Array, constants: ConeConstants) -> Array:
        return _excess(*mean_and_shear(stress), constants)

    def _yield_function(self, values: Array, constants: ConeConstants) -> Array:
        return _excess(*mean_and_shear(values), constants)

    def _return_map(self, trial: Array, constants: ConeConstants) -> Return:
        return cone_return(trial, constants)


def cone_return(trial: Array, constants: ConeConstants) -> Return:
    """Return principal trial stresses (3, n), all of them outside, to the cone.

    The deviator follows from the yield condition in the end, so that this holds to the round-off of the
    returned stress, however large the trial stress was.
    """
    lam, mu, alpha, beta, k = constants
    bulk = lam + 2 / 3 * mu
    mean, shear = mean_and_shear(trial)
    multiplier = _excess(mean, shear, constants) / (mu + 9 * bulk * alpha * beta)
    apex = np.flatnonzero(mu * (3 * alpha * mean - k) > 9 * bulk * alpha * beta * shear)

    direction = (trial - mean) / np.where(shear > 0, shear, 1)
    returned_mean = mean - 3 * bulk * beta * multiplier
    returned_shear = np.maximum(k - 3 * alpha * returned_mean, 0)
    values = returned_mean + returned_shear * direction
    if apex.size:
        at_apex = chosen(constants, apex)
        values[:, apex] = at_apex.k / (3 * at_apex.alpha)

    def moduli() -> Array:
        result = np.empty((3, *trial.shape))
        kept = returned_shear / np.where(shear > 0, shear, 1)
        for i in range(3):
            drop = (3 * bulk * beta + mu * direction[i]) / (mu + 9 * bulk * alpha * beta)
            for j in range(3):
                deviatoric = (2.0 * (i == j) - 2 / 3) * kept + (1 - kept) * direction[i] * direction[j]
                result[i, j] = bulk + mu * deviatoric - drop * (3 * bulk * alpha + mu * direction[j])
        result[:, :, apex] = 0
        return result

    return Return(values, moduli)


def _excess(mean: Array, shear: Array, k: ConeConstants) -> Array:
    """Yield function of the mean stress and sqrt(J2)."""
    excess = 3 * k.alpha * mean
    excess += shear
    excess -= k.k
    return excess
