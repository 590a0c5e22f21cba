"""Update of isotropic plastic laws: elastic predictor, return mapping in principal stresses,
rotation back.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from .base import PLASTIC_STRAIN, Array, Internal, Parameter, Update, along_elements
from .elastic import Isotropic
from .spectral import Frame, principal

# Excess over the yield surface and differences of principal stresses below this fraction of the
# largest trial stress are round-off: about a hundred times the error of turning a stress to
# principal axes and back.
ROUND_OFF = 1e-13
# Points returned at a time: their arrays stay in the processor's cache.
BLOCK = 16384


class Return(NamedTuple):
    """Principal stresses (3, n) after a return mapping, in the (descending) order of the trial
    stresses.

    ``moduli()`` computes d principal stress / d principal strain, (3, 3, n), and ``relief()`` the
    loss of returned stress (3, n) for a unit rise of the yield function. The growth of the plastic
    strain follows from the stresses unless the law solved for it.
    """

    values: Array
    moduli: Callable[[], Array]
    growth: Array | None = None
    relief: Callable[[], Array] | None = None


@dataclass(frozen=True, eq=False)
class IsotropicPlasticity(Isotropic):
    """Base of the plastic laws; a law adds its constants, its yield function and its return
    mapping.

    The plastic strain is the accumulated equivalent shear strain, the sum of sqrt(2/3 e_p : e_p)
    with the deviator e_p of the plastic strain increments.
    """

    internal = (Internal(PLASTIC_STRAIN),)

    @abstractmethod
    def constants(self) -> Any:
        """Return the constants of the law, a NamedTuple of parameters with ``lam`` and ``mu`` among
        them.
        """

    def at_state(self, constants: Any, internal: Array) -> Any:
        """Return the constants at an accepted plastic strain; a law that hardens overrides this
        method.
        """
        return constants

    @abstractmethod
    def yield_bound(self, stress: Array, constants: Any) -> Array:
        """Return an upper bound of the yield function (a stress) from the Cartesian components
        (ncomp, ...).
        """

    @abstractmethod
    def yield_function(self, values: Array, constants: Any) -> Array:
        """Return the yield function (a stress) of descending principal stresses (3, n)."""

    @abstractmethod
    def return_map(self, trial: Array, constants: Any) -> Return:
        """Return descending principal trial stresses (3, n), all of them outside, to the yield
        surface.
        """

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        result = self.elastic_stress(strain_increment, stress)
        internal = internal.copy()
        constants = self.constants()
        constants = _map(lambda value: along_elements(value, result.shape), constants)
        spread = self.at_state(constants, internal[0])
        candidates = np.flatnonzero(self.yield_bound(result, spread) > 0)
        blocks = [
            self._return_block(result, internal, candidates[start : start + BLOCK], constants)
            for start in range(0, candidates.size, BLOCK)
        ]
        plastic = np.concatenate([candidates[:0], *(block.points for block in blocks)])
        return Update(
            result, internal, plastic, lambda: _tangent(blocks, plastic.size, len(result))
        )

    def _return_block(
        self, stress: Array, internal: Array, points: NDArray[np.intp], constants: Any
    ) -> _ReturnedBlock:
        """Return the points outside of the surface to it; change stress and internal variable in
        place.
        """
        constants = chosen(constants, points)
        stress, equivalent = stress.reshape(len(stress), -1), internal.reshape(-1)
        constants = self.at_state(constants, equivalent[points])
        frame = principal(stress[:, points])
        excess = self.yield_function(frame.values, constants)
        plastic = excess > ROUND_OFF * np.maximum(frame.values[0], -frame.values[2])
        if not plastic.all():
            kept = np.flatnonzero(plastic)
            points, frame, constants = points[kept], frame.take(kept), chosen(constants, kept)
        values, moduli, growth, _ = self.return_map(frame.values, constants)
        stress[:, points] = frame.stress(values)
        if growth is None:
            growth = equivalent_shear_strain(frame.values - values, constants.mu)
        equivalent[points] += growth
        return _ReturnedBlock(points, frame, values, moduli, constants.mu)


class _ReturnedBlock(NamedTuple):
    """Returned points, and the data of their tangent."""

    points: NDArray[np.intp]
    trial: Frame
    values: Array
    moduli: Callable[[], Array]
    mu: Parameter


def _tangent(blocks: list[_ReturnedBlock], n_plastic: int, ncomp: int) -> Array:
    """Compute the consistent tangent (n_plastic, ncomp, ncomp) at the points of all blocks."""
    result = np.empty((n_plastic, ncomp, ncomp))
    start = 0
    for block in blocks:
        stop = start + block.points.size
        result[start:stop] = block.trial.tangent(block.moduli(), block.values, block.mu)
        start = stop
    return result


def chosen(constants: Any, points: NDArray[np.intp]) -> Any:
    """Return the constants at some points, by their flat indices."""
    return _map(
        lambda value: value.reshape(-1)[points] if isinstance(value, np.ndarray) else value,
        constants,
    )


def _map(function: Callable[[Parameter], Parameter], constants: Any) -> Any:
    """Return the constants with the function applied to each."""
    return type(constants)(*map(function, constants))


def equivalent_shear_strain(relaxed: Array, mu: Parameter) -> Array:
    """Return sqrt(2/3 e : e) of the plastic strain that relaxes the principal stresses by
    ``relaxed``.
    """
    s1, s2, s3 = relaxed
    return np.sqrt((s1 - s2) ** 2 + (s2 - s3) ** 2 + (s3 - s1) ** 2) / (np.sqrt(18) * mu)
