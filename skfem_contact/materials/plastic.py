"""The course of all isotropic plastic laws: predict elastically, return in principal stresses, turn back."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .base import Array, Parameter, Update, along_elements, at_points
from .elastic import Isotropic
from .spectral import principal

# Excess over the yield surface and differences of principal stresses below this fraction of the largest trial
# stress are round-off: about a hundred times the error of turning a stress to principal axes and back.
ROUND_OFF = 1e-13


class Return(NamedTuple):
    """Outcome of a return mapping at n points.

    Attributes
    ----------
    values : ndarray, shape (3, n)
        Principal stresses, in the (descending) order of the trial stresses.
    moduli : callable
        ``moduli()`` returns d principal stress / d principal strain, shape (3, 3, n).
    """

    values: Array
    moduli: Callable[[], Array]


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
        """Stress, internal variable and tangent after a strain increment.

        Parameters
        ----------
        strain_increment : ndarray, shape (ncomp, n_elements, ...)
            With engineering shear strains; 4 components (xx, yy, zz, xy) or 6 (xx, yy, zz, xy, yz, zx).
        stress : ndarray, same shape
            Accepted stress, tension positive.
        internal : ndarray, shape (1, n_elements, ...)
            Accepted accumulated equivalent plastic shear strain.

        Returns
        -------
        Update

        Raises
        ------
        ValueError
            If the shapes do not fit each other or the parameters.
        """
        result = self.elastic_stress(strain_increment, stress)
        constants = self._constants()
        spread = _map(lambda value: along_elements(value, result.shape), constants)
        outside = np.flatnonzero(self._yield_bound(result, spread) > 0)

        flat = result.reshape(len(result), -1)
        frame = principal(flat[:, outside])
        local = _map(lambda value: at_points(value, outside, result.shape), constants)
        excess = self._yield_function(frame.values, local)
        plastic = excess > ROUND_OFF * np.abs(frame.values).max(axis=0)
        if not plastic.all():
            kept = np.flatnonzero(plastic)
            outside, frame, local = outside[kept], frame.take(kept), chosen(local, kept)

        values, moduli = self._return_map(frame.values, local)
        flat[:, outside] = frame.stress(values)
        internal = internal.copy()
        internal.reshape(1, -1)[0, outside] += _equivalent_shear_strain(frame.values - values, local.mu)
        return Update(result, internal, outside, lambda: frame.tangent(moduli(), values, local.mu))


def chosen(constants: Any, points: NDArray[np.intp]) -> Any:
    """The constants at some of their points."""
    return _map(lambda value: value[points] if isinstance(value, np.ndarray) else value, constants)


def _map(function: Callable[[Parameter], Parameter], constants: Any) -> Any:
    """The constants with the function applied to each."""
    return type(constants)(*map(function, constants))


def _equivalent_shear_strain(relaxed: Array, mu: Parameter) -> Array:
    """sqrt(2/3 e : e) of the plastic strain that relaxes the principal stresses by ``relaxed``."""
    deviator = relaxed - relaxed.mean(axis=0)
    return np.sqrt(2 / 3 * (deviator * deviator).sum(axis=0)) / (2 * mu)
