"""Drucker-Prager plasticity with an exact return mapping."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .base import Parameter, reduced_dilatancy, require
from .cone import ConeConstants, ConePlasticity
from .mohr_coulomb import MohrCoulomb
from .reduction import Flow, check_reduction


@dataclass(frozen=True, eq=False)
class DruckerPrager(ConePlasticity):
    """Linear elasticity, perfect plasticity on the Drucker-Prager cone, non-associated flow.

    The yield function is ``sqrt(J2) + alpha I1 - k`` (tension positive), and the plastic potential is the
    same with beta. Evaluation stresses return exactly to the cone or its apex. Where c and phi are known, use
    :meth:`plane_strain`: k, alpha and beta are not cohesion and angles.

    Parameters
    ----------
    E, nu : float or ndarray
        As those of :class:`LinearElastic`.
    k : float or ndarray
        Shear strength sqrt(J2) without mean stress, not negative; a float or one value an element.
    alpha : float or ndarray
        Friction, not negative, below 1/3 for soil in plane strain; a float or one value an element.
    beta : float or ndarray, optional
        Dilatancy, 0 <= beta <= alpha; a float or one value an element.

    Raises
    ------
    ValueError
        If a parameter is out of its range, not finite, or arrays differ in length.

    Notes
    -----
    D. C. Drucker, W. Prager, Quart. Appl. Math. 10 (1952) 157-165.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact.materials import DruckerPrager
    >>> soil = DruckerPrager(E=1000.0, nu=0.25, k=5.0, alpha=0.2)
    >>> shear_strain = np.array([[0.0], [0.0], [0.0], [0.1]])
    >>> soil.update(shear_strain, np.zeros((4, 1)), np.zeros((1, 1))).stress.ravel()
    array([0., 0., 0., 5.])
    """

    k: Parameter
    alpha: Parameter
    beta: Parameter = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._not_negative("k", "alpha", "beta")
        require("beta", self.beta, np.less_equal(self.beta, self.alpha), "not exceed alpha")

    @classmethod
    def plane_strain(
        cls, E: Parameter, nu: Parameter, c: Parameter, phi: Parameter, psi: Parameter = 0.0
    ) -> DruckerPrager:
        """The cone that collapses at the Mohr-Coulomb strength in plane strain.

        At collapse the strain out of plane is plastic and vanishes, which fixes the stress out of plane by
        the plastic potential; then the strength in the plane is that of c and phi, and the flow has the
        angle psi.

        Parameters
        ----------
        E, nu, c, phi, psi : float or ndarray
            As those of `MohrCoulomb`.

        Examples
        --------
        >>> soil = DruckerPrager.plane_strain(E=1e4, nu=0.3, c=10.0, phi=30.0, psi=30.0)
        >>> print(f"{soil.k:.4f} {soil.alpha:.4f} {soil.beta:.4f}")
        8.3205 0.1601 0.1601
        """
        model = MohrCoulomb(E, nu, c, phi, psi)
        phi, psi = np.radians(model.phi), np.radians(model.psi)
        beta = np.sin(psi) / np.sqrt(9 + 3 * np.sin(psi) ** 2)
        scale = np.sqrt(1 - 3 * beta**2) + beta * np.sin(phi)
        alpha = np.where(np.equal(psi, phi), beta, np.sin(phi) / (3 * scale))
        return cls(E, nu, k=model.c * np.cos(phi) / scale, alpha=alpha, beta=beta)

    def reduced(self, factor: float, flow: Flow = "given") -> DruckerPrager:
        """The material with its strength k and alpha divided by a factor.

        Where the flow is associated (beta = alpha) it stays so; elsewhere the new beta is the smaller of
        beta and the new alpha.

        Parameters
        ----------
        factor : float
            Positive.
        flow : str
            ``"given"``, or ``"associated"``: beta = alpha. A cone of less dilatancy has no other: Davis' strength is
            that of c and phi on a plane.

        Raises
        ------
        ValueError
            If the factor is not positive, or the cone does not have the flow.

        Examples
        --------
        >>> soil = DruckerPrager(E=1e4, nu=0.3, k=10.0, alpha=0.2).reduced(2.0)
        >>> soil.k, soil.alpha
        (5.0, 0.1)
        """
        check_reduction(factor, flow)
        if flow not in ("given", "associated") and not self.symmetric:
            raise ValueError(
                f"flow '{flow}' needs cohesion and friction angle, which a DruckerPrager cone with beta < alpha has "
                "not: use MohrCoulomb, or flow 'given' or 'associated'"
            )
        alpha = self.alpha / factor
        beta = alpha if flow == "associated" else reduced_dilatancy(self.beta, self.alpha, alpha)
        return self._with(k=self.k / factor, alpha=alpha, beta=beta)

    def _constants(self) -> ConeConstants:
        return ConeConstants(*self.lame, self.alpha, self.beta, self.k)
