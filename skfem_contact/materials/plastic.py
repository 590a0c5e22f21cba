"""The course of all isotropic plastic laws: predict elastically, return in principal stresses, turn back."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .base import Array, Parameter, Update, along_elements
from .elastic import Isotropic
from .spectral import Frame, principal

# Excess over the yield surface and differences of principal stresses below this fraction of the largest trial
# stress are round-off: about a hundred times the error of turning a stress to principal axes and back.
ROUND_OFF = 1e-13
# Points returned at a time: their arrays stay in the processor's cache.
BLOCK = 16384


class Return(NamedTuple):
    """Outcome of a return mapping at n points.

    Attributes
    ----------
    values : ndarray, shape (3, n)
        Principal stresses, in the (descending) order of the trial stresses.
    moduli : callable
        ``moduli()`` returns d principal stress / d principal strain, shape (3, 3, n).
    growth : ndarray, shape (n,), optional
        Growth of the internal variable where the law solved for it; otherwise it follows from the stresses.
    """

    values: Array
    moduli: Callable[[], Array]
    growth: Array | None = None


@dataclass(frozen=True, eq=False)
class IsotropicPlasticity(Isotropic):
    """Base of the plastic laws; a law adds its constants, its yield function and its return mapping.

    The internal variable is the accumulated equivalent plastic shear strain, the sum of
    sqrt(2/3 e_p : e_p) with the deviator e_p of the plastic strain increments.
    """

    @property
    def n_internal(self) -> int:
        """One internal variable: the accumulated equivalent plastic shear strain."""
        return 1

    @abstractmethod
    def _constants(self) -> Any:
        """Constants of the law as a NamedTuple of parameters, with ``lam`` and ``mu`` among them."""

    def _at_state(self, constants: Any, internal: Array) -> Any:
        """The constants at an accepted internal variable; the same ones unless the law hardens."""
        return constants

    @abstractmethod
    def _yield_bound(self, stress: Array, constants: Any) -> Array:
        """Upper bound of the yield function (a stress) from the Cartesian components (ncomp, ...)."""

    @abstractmethod
    def _yield_function(self, values: Array, constants: Any) -> Array:
        """Yield function (a stress) of descending principal stresses (3, n)."""

    @abstractmethod
    def _return_map(self, trial: Array, constants: Any) -> Return:
        """Return descending principal trial stresses (3, n), all of them outside, to the yield surface."""

    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        """Stress, internal variable and tangent after a strain increment, see :meth:`Material.update`."""
        result = self.elastic_stress(strain_increment, stress)
        internal = internal.copy()
        constants = self._constants()
        spread = self._at_state(
            _map(lambda value: along_elements(value, result.shape), constants), internal[0]
        )
        candidates = np.flatnonzero(self._yield_bound(result, spread) > 0)
        blocks = [
            self._return_block(result, internal, candidates[start : start + BLOCK], constants)
            for start in range(0, candidates.size, BLOCK)
        ]
        plastic = np.concatenate([candidates[:0], *(block.points for block in blocks)])
        return Update(result, internal, plastic, lambda: _tangent(blocks, plastic.size, len(result)))

    def _return_block(
        self, stress: Array, internal: Array, points: NDArray[np.intp], constants: Any
    ) -> _ReturnedBlock:
        """Return those of the points that are outside the surface; changes stress and internal in place."""
        constants = chosen(constants, points // stress[0, 0].size)
        stress, equivalent = stress.reshape(len(stress), -1), internal.reshape(-1)
        constants = self._at_state(constants, equivalent[points])
        frame = principal(stress[:, points])
        excess = self._yield_function(frame.values, constants)
        plastic = excess > ROUND_OFF * np.maximum(frame.values[0], -frame.values[2])
        if not plastic.all():
            kept = np.flatnonzero(plastic)
            points, frame, constants = points[kept], frame.take(kept), chosen(constants, kept)
        values, moduli, growth = self._return_map(frame.values, constants)
        stress[:, points] = frame.stress(values)
        if growth is None:
            growth = equivalent_shear_strain(frame.values - values, constants.mu)
        equivalent[points] += growth
        return _ReturnedBlock(points, frame, values, moduli, constants.mu)


class _ReturnedBlock(NamedTuple):
    """Points after their return, with what their tangent needs."""

    points: NDArray[np.intp]
    trial: Frame
    values: Array
    moduli: Callable[[], Array]
    mu: Parameter


def _tangent(blocks: list[_ReturnedBlock], n_plastic: int, ncomp: int) -> Array:
    """Consistent tangent (n_plastic, ncomp, ncomp) at the points of all blocks."""
    result = np.empty((n_plastic, ncomp, ncomp))
    start = 0
    for block in blocks:
        stop = start + block.points.size
        result[start:stop] = block.trial.tangent(block.moduli(), block.values, block.mu)
        start = stop
    return result


def chosen(constants: Any, points: NDArray[np.intp]) -> Any:
    """The constants at some of their points."""
    return _map(lambda value: value[points] if isinstance(value, np.ndarray) else value, constants)


def _map(function: Callable[[Parameter], Parameter], constants: Any) -> Any:
    """The constants with the function applied to each."""
    return type(constants)(*map(function, constants))


def equivalent_shear_strain(relaxed: Array, mu: Parameter) -> Array:
    """sqrt(2/3 e : e) of the plastic strain that relaxes the principal stresses by ``relaxed``."""
    s1, s2, s3 = relaxed
    return np.sqrt((s1 - s2) ** 2 + (s2 - s3) ** 2 + (s3 - s1) ** 2) / (np.sqrt(18) * mu)
