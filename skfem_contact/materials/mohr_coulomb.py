"""Mohr-Coulomb plasticity with an exact return mapping."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .base import Parameter, reduced_dilatancy, require, warn_of_radians
from .pyramid import PyramidConstants, PyramidPlasticity
from .reduction import Flow, check_reduction, without_dilatancy
from .substitute import AssociatedSubstitute


@dataclass(frozen=True, eq=False)
class MohrCoulomb(PyramidPlasticity):
    """Linear elasticity, perfect plasticity on the Mohr-Coulomb surface, non-associated flow.

    With principal stresses s1 >= s2 >= s3 (tension positive) the yield function is
    ``(1 + sin phi) s1 - (1 - sin phi) s3 - 2 c cos phi``, and the plastic potential is the same with psi.
    Evaluation stresses return exactly to a face, an edge (s1 = s2 or s2 = s3) or the apex. phi = 0 is the Tresca
    surface.

    Parameters
    ----------
    E, nu : float or ndarray
        As those of :class:`LinearElastic`.
    c : float or ndarray
        Cohesion (stress), not negative; a float or one value an element.
    phi : float or ndarray
        Friction angle in degrees, 0 <= phi < 90; a float or one value an element.
    psi : float or ndarray, optional
        Dilatancy angle in degrees, 0 <= psi <= phi; a float or one value an element.
    tension : float or ndarray, optional
        Tensile strength, not negative: no principal stress exceeds it, with associated flow. None, or a value
        above the apex c cot(phi), is no cut-off.

    Raises
    ------
    ValueError
        If a parameter is out of its range, not finite, or arrays differ in length.

    Notes
    -----
    The return mapping follows Koiter's rule in principal stresses: W. T. Koiter, Quart. Appl. Math. 11 (1953)
    350-354; J. Clausen, L. Damkilde, L. Andersen, Computers & Structures 85 (2007) 1795-1807.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.materials import MohrCoulomb
    >>> sand = MohrCoulomb(E=1000.0, nu=0.25, c=0.0, phi=30.0)
    >>> strain = np.array([[0.001], [-0.01], [-0.001], [0.0]])
    >>> sand.update(strain, np.zeros((4, 1)), np.zeros((1, 1))).stress.ravel().round(3)
    array([ -3.8, -11.4,  -4.8,   0. ])
    """

    c: Parameter
    phi: Parameter
    psi: Parameter = 0.0
    tension: Parameter | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self._not_negative("c", "psi", "tension")
        in_range = np.greater_equal(self.phi, 0) & np.less(self.phi, 90)
        require("phi", self.phi, in_range, "lie in [0, 90) degrees")
        require("psi", self.psi, np.less_equal(self.psi, self.phi), "not exceed phi")
        warn_of_radians(phi=self.phi)

    def reduced(self, factor: float, flow: Flow = "given") -> MohrCoulomb | AssociatedSubstitute:
        """The material with its strength, c, tan(phi) and tension, divided by a factor.

        Where the flow is associated (psi = phi) it stays so; elsewhere the new psi is the smaller of psi and
        the new phi.

        Parameters
        ----------
        factor : float
            Positive.
        flow : str
            The flow that is assumed, see `reduced_strength`.

        Returns
        -------
        MohrCoulomb or AssociatedSubstitute
            The latter with a flow that lags.

        Raises
        ------
        ValueError
            If the factor is not positive, or the flow unknown.

        Examples
        --------
        >>> soil = MohrCoulomb(E=1e4, nu=0.3, c=10.0, phi=45.0, psi=30.0).reduced(2.0)
        >>> print(f"{soil.c:.3f} {soil.phi:.3f} {soil.psi:.3f}")
        5.000 26.565 26.565
        """
        check_reduction(factor, flow)
        if flow == "associated":
            return self._with(psi=self.phi)._divided(factor)
        if flow == "davis_a":
            return self._davis(self.psi)._divided(factor)
        weaker = self._divided(factor)
        if flow == "davis_b":
            return weaker._davis(weaker.psi)
        if flow == "davis_c":
            psi = np.degrees(np.arctan(np.tan(np.radians(self.psi)) / factor))
            return weaker._davis(np.minimum(psi, weaker.phi))
        return AssociatedSubstitute(weaker) if flow == "lagged" and not weaker.symmetric else weaker

    def _divided(self, factor: float) -> MohrCoulomb:
        phi = np.degrees(np.arctan(np.tan(np.radians(self.phi)) / factor))
        return self._with(
            c=self.c / factor,
            phi=phi,
            psi=reduced_dilatancy(self.psi, self.phi, phi),
            tension=None if self.tension is None else self.tension / factor,
        )

    def _davis(self, psi: Parameter) -> MohrCoulomb:
        c, phi = without_dilatancy(self.c, self.phi, psi)
        return self._with(c=c, phi=phi, psi=phi)

    def _constants(self) -> PyramidConstants:
        phi, psi = np.radians(self.phi), np.radians(self.psi)
        strength = 2 * self.c * np.cos(phi)
        return PyramidConstants(*self.lame, np.sin(phi), np.sin(psi), strength, self.tension)
