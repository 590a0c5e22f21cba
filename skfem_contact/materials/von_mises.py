"""Von Mises plasticity: metals, and soil without drainage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .base import Parameter
from .cone import ConeConstants, ConePlasticity
from .reduction import Flow, check_reduction


@dataclass(frozen=True, eq=False)
class VonMises(ConePlasticity):
    """Linear elasticity, perfect plasticity where the equivalent stress sqrt(3 J2) reaches the strength.

    Parameters
    ----------
    E, nu : float or ndarray
        As those of :class:`LinearElastic`.
    strength : float or ndarray
        Yield stress in uniaxial tension, not negative; a float or one value an element. A soil of shear
        strength c in plane strain has sqrt(3) c.

    Raises
    ------
    ValueError
        If a parameter is out of its range, not finite, or arrays differ in length.

    Notes
    -----
    It is the limit alpha = 0 of `DruckerPrager` and runs through the same (radial) return mapping.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.materials import VonMises
    >>> steel = VonMises(E=210e3, nu=0.3, strength=235.0)
    >>> strain = np.array([[0.0], [0.0], [0.0], [0.01]])
    >>> steel.update(strain, np.zeros((4, 1)), np.zeros((1, 1))).stress.ravel().round(3)
    array([  0.   ,   0.   ,   0.   , 135.677])
    """

    strength: Parameter

    def __post_init__(self) -> None:
        super().__post_init__()
        self._not_negative("strength")

    def reduced(self, factor: float, flow: Flow = "given") -> VonMises:
        """The material with its strength divided by a positive factor.

        The flow, one of those of :meth:`MohrCoulomb.reduced`, has no effect: the volume never changes.

        Examples
        --------
        >>> VonMises(E=1e4, nu=0.3, strength=10.0).reduced(2.0).strength
        5.0
        """
        check_reduction(factor, flow)
        return self._with(strength=self.strength / factor)

    def _constants(self) -> ConeConstants:
        return ConeConstants(*self.lame, alpha=0.0, beta=0.0, k=self.strength / np.sqrt(3))
