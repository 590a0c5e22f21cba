"""Friction from the pressure at the start of an increment: non-associated soil that flows in an associated way.

With psi < phi the tangent of Mohr and Coulomb's law is not symmetric, increments have several solutions or none, and
Newton's method fails long before the collapse.  Within an increment the law is therefore replaced by one whose yield
surface has the slope of the flow, and whose strength is that of the pressure at the start of the increment:

    (1 + sin psi) s1 - (1 - sin psi) s3 <= 2 c cos phi - (sin phi - sin psi) (s1 + s3)_start.

At the start of the increment both surfaces meet in the stress point.  The accepted stresses satisfy this surface, not
that of Mohr and Coulomb: their strength is off by what the pressure changes within the increment, less in smaller
ones.  It is no solution of the law as it is: with that law the residual after a step was 2 to 40 % of the load.
The capacity of a footing (phi = 30, psi = 0 degrees) was within 2 % of the given law's with short steps, and 1 to 4 %
more with steps that grew to the end.

K. Krabbenhoft, M. R. Karim, A. V. Lyamin, S. W. Sloan, Int. J. Numer. Methods Eng. 90 (2012) 1089-1117.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .base import Array, Parameter, Update, along_elements
from .mohr_coulomb import MohrCoulomb
from .spectral import extremes

#: Share of the strength without pressure that is left in tension, where the soil would be beyond its apex.
_LEAST = 0.1


def lagged(soil: Any) -> Any:
    """The soil with the friction of the pressure at the start of an increment; associated flow stays as it is.

    Raises
    ------
    ValueError
        For another law than :class:`MohrCoulomb`.
    """
    if not isinstance(soil, MohrCoulomb):
        raise ValueError(f"flow 'lagged' is known for MohrCoulomb, not for {type(soil).__name__}")
    return soil if np.all(soil.psi == soil.phi) else LaggedFriction(soil)


@dataclass(frozen=True, eq=False)
class LaggedFriction:
    """Mohr-Coulomb soil with the friction of the last accepted stress; its increments have a convex potential.

    Parameters
    ----------
    soil : MohrCoulomb
        The soil; with psi = phi nothing changes.

    Notes
    -----
    In tension the strength does not fall below a tenth of ``2 c cos(phi)``.

    Examples
    --------
    A stress on the yield surface stays there as long as the pressure does:

    >>> import numpy as np
    >>> soil = MohrCoulomb(E=1000.0, nu=0.25, c=1.0, phi=30.0)
    >>> shear = np.array([[0.01], [-0.01], [0.0], [0.0]])
    >>> stress = soil.update(shear, np.array([[-1.0], [-1.0], [-1.0], [0.0]]), np.zeros((1, 1))).stress
    >>> again = LaggedFriction(soil).update(shear, stress, np.zeros((1, 1))).stress
    >>> bool(np.allclose(again, stress))
    True
    """

    soil: MohrCoulomb

    @property
    def n_internal(self) -> int:
        """That of the soil."""
        return self.soil.n_internal

    def elasticity(self, ncomp: int) -> Array:
        """Elastic stiffness of the soil."""
        return self.soil.elasticity(ncomp)

    def update(self, strain_increment: Array, stress: Array, internal: Array) -> Update:
        """Stress, internal variable and tangent after a strain increment; see :meth:`MohrCoulomb.update`."""

        def at_points(value: Parameter) -> Parameter:
            value = along_elements(value, stress.shape)
            return value.ravel() if isinstance(value, np.ndarray) else value

        soil = self.soil
        phi, psi = np.radians(at_points(soil.phi)), np.radians(at_points(soil.psi))
        largest, smallest = (extreme.ravel() for extreme in extremes(stress))
        alone = 2 * at_points(soil.c) * np.cos(phi)
        strength = np.maximum(alone - (np.sin(phi) - np.sin(psi)) * (largest + smallest), _LEAST * alone)
        substitute = MohrCoulomb(
            at_points(soil.E),
            at_points(soil.nu),
            c=strength / (2 * np.cos(psi)),
            phi=at_points(soil.psi),
            psi=at_points(soil.psi),
            tension=None if soil.tension is None else at_points(soil.tension),
        )
        flat = substitute.update(*(a.reshape(len(a), -1) for a in (strain_increment, stress, internal)))
        return Update(
            flat.stress.reshape(stress.shape), flat.internal.reshape(internal.shape), flat.plastic, flat.tangent
        )
