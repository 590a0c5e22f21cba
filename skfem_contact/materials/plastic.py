"""Update of isotropic plastic laws: elastic predictor, and return mapping in principal stresses."""

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
    """Result of a return mapping in principal stresses.

    Attributes
    ----------
    values : ndarray, shape (3, n)
        Returned principal stresses, in the (descending) order of the trial stresses.
    moduli : callable
        ``moduli()`` computes d principal stress / d principal strain, (3, 3, n).
    growth : ndarray, shape (n,), optional
        Growth of the plastic strain, if the law solved for it; else it follows from the stresses.
    relief : callable, optional
        ``relief()`` computes the loss of returned stress (3, n) by a unit rise of the yield
        function.
    """

    values: Array
    moduli: Callable[[], Array]
    growth: Array | None = None
    relief: Callable[[], Array] | None = None


@dataclass(frozen=True, eq=False)
class IsotropicPlasticity(Isotropic):
    """Base of the plastic laws.

    A law adds its constants, its yield function and its return mapping. The plastic strain is the
    accumulated equivalent shear strain, the sum of sqrt(2/3 e_p : e_p) with the deviator e_p of the
    plastic strain increments.
    """

    internal = (Internal(PLASTIC_STRAIN),)

    @abstractmethod
    def constants(self) -> Any:
        """Return the constants of the law, a NamedTuple that has ``lam`` and ``mu``."""

    def at_state(self, constants: Any, internal: Array) -> Any:
        """Return the constants at an accepted plastic strain; laws that harden override this."""
        return constants

    @abstractmethod
    def yield_bound(self, stress: Array, constants: Any) -> Array:
        """Return an upper bound of the yield function from Cartesian components (ncomp, ...)."""

    @abstractmethod
    def yield_function(self, values: Array, constants: Any) -> Array:
        """Return the yield function (a stress) of descending principal stresses (3, n)."""

    @abstractmethod
    def return_map(self, trial: Array, constants: Any) -> Return:
        """Return descending principal trial stresses (3, n), all outside, to the yield surface."""

    @override
    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        # Compute the elastic predictor.
        result = self.elastic_stress(strain_increment, stress)
        internal = internal.copy()

        # Select the points that can lie outside of the yield surface.
        constants = _map(lambda value: along_elements(value, result.shape), self.constants())
        bound = self.yield_bound(result, self.at_state(constants, internal[0]))
        candidates = np.flatnonzero(bound > 0)

        # Return the points outside to the surface.
        blocks = []
        for start in range(0, candidates.size, BLOCK):
            points = candidates[start : start + BLOCK]
            blocks.append(self._return_block(result, internal, points, constants))
        plastic = np.concatenate([candidates[:0], *(block.points for block in blocks)])

        def tangent() -> Array:
            return _tangent(blocks, plastic.size, len(result))

        return Update(result, internal, plastic, tangent)

    def _return_block(
        self,
        stress: Array,
        internal: Array,
        points: NDArray[np.intp],
        constants: Any,
    ) -> _ReturnedBlock:
        """Return points outside to the surface; change stress and internal variable in place."""
        stress = stress.reshape(len(stress), -1)
        equivalent = internal.reshape(-1)
        constants = self.at_state(chosen(constants, points), equivalent[points])

        # Keep the points outside in principal stresses.
        frame = principal(stress[:, points])
        excess = self.yield_function(frame.values, constants)
        largest = np.maximum(frame.values[0], -frame.values[2])
        plastic = excess > ROUND_OFF * largest
        if not plastic.all():
            kept = np.flatnonzero(plastic)
            points = points[kept]
            frame = frame.take(kept)
            constants = chosen(constants, kept)

        # Return them, and turn the stress back.
        returned = self.return_map(frame.values, constants)
        stress[:, points] = frame.stress(returned.values)
        growth = returned.growth
        if growth is None:
            growth = equivalent_shear_strain(frame.values - returned.values, constants.mu)
        equivalent[points] += growth
        return _ReturnedBlock(points, frame, returned, constants.mu)


class _ReturnedBlock(NamedTuple):
    """Returned points, and the data of their tangent."""

    points: NDArray[np.intp]
    trial: Frame
    returned: Return
    mu: Parameter


def _tangent(blocks: list[_ReturnedBlock], n_plastic: int, ncomp: int) -> Array:
    """Compute the consistent tangent (n_plastic, ncomp, ncomp) at the points of all blocks."""
    result = np.empty((n_plastic, ncomp, ncomp))
    start = 0
    for block in blocks:
        stop = start + block.points.size
        moduli = block.returned.moduli()
        result[start:stop] = block.trial.tangent(moduli, block.returned.values, block.mu)
        start = stop
    return result


def chosen(constants: Any, points: NDArray[np.intp]) -> Any:
    """Return the constants at some points, by their flat indices."""

    def choose(value: Parameter) -> Parameter:
        if isinstance(value, np.ndarray):
            return value.reshape(-1)[points]
        return value

    return _map(choose, constants)


def _map(function: Callable[[Parameter], Parameter], constants: Any) -> Any:
    """Return the constants with the function applied to each."""
    return type(constants)(*map(function, constants))


def equivalent_shear_strain(relaxed: Array, mu: Parameter) -> Array:
    """Return sqrt(2/3 e : e) of the plastic strain that relaxes principal stresses (3, n)."""
    s1, s2, s3 = relaxed
    squares = (s1 - s2) ** 2 + (s2 - s3) ** 2 + (s3 - s1) ** 2
    return np.sqrt(squares) / (np.sqrt(18) * mu)
