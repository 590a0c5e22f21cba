"""Tresca plasticity: soil without drainage, with one shear strength."""

from __future__ import annotations

from dataclasses import dataclass

from .base import Parameter
from .pyramid import PyramidConstants, PyramidPlasticity
from .reduction import Flow, check_reduction


@dataclass(frozen=True, eq=False)
class Tresca(PyramidPlasticity):
    """Linear elasticity, perfect plasticity where the largest shear stress is c, no change of volume.

    Parameters
    ----------
    E, nu : float or ndarray
        As those of :class:`LinearElastic`.
    c : float or ndarray
        Shear strength (stress), not negative; a float or one value an element.

    Raises
    ------
    ValueError
        If a parameter is out of its range, not finite, or arrays differ in length.

    Notes
    -----
    It is the limit phi = 0 of `MohrCoulomb` and runs through the same return mapping, without an apex.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.materials import Tresca
    >>> clay = Tresca(E=1000.0, nu=0.25, c=5.0)
    >>> shear_strain = np.array([[0.0], [0.0], [0.0], [0.1]])
    >>> clay.update(shear_strain, np.zeros((4, 1)), np.zeros((1, 1))).stress.ravel()
    array([0., 0., 0., 5.])
    """

    c: Parameter

    def __post_init__(self) -> None:
        super().__post_init__()
        self._not_negative("c")

    def reduced(self, factor: float, flow: Flow = "given") -> Tresca:
        """The material with its shear strength divided by a positive factor.

        The flow, one of those of :meth:`MohrCoulomb.reduced`, has no effect: the volume never changes.

        Examples
        --------
        >>> Tresca(E=1e4, nu=0.3, c=10.0).reduced(2.0).c
        5.0
        """
        check_reduction(factor, flow)
        return self._with(c=self.c / factor)

    def _constants(self) -> PyramidConstants:
        return PyramidConstants(*self.lame, sin_phi=0.0, sin_psi=0.0, strength=2 * self.c)
