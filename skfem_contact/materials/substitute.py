"""A soil of less dilatancy than friction whose increments are associated: its friction lags behind by a step.

K. Krabbenhoft, M. R. Karim, A. V. Lyamin, S. W. Sloan, Int. J. Numer. Meth. Engng 90 (2012) 1089-1117.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .base import Array, Parameter, Update, along_elements
from .spectral import extremes

if TYPE_CHECKING:
    from .mohr_coulomb import MohrCoulomb

#: Share of the strength without pressure that is left in tension, where the soil would be beyond its apex.
_LEAST = 0.1


@dataclass(frozen=True, eq=False)
class AssociatedSubstitute:
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
    >>> from skfem_contact.materials import MohrCoulomb
    >>> soil = MohrCoulomb(E=1000.0, nu=0.25, c=1.0, phi=30.0)
    >>> shear = np.array([[0.01], [-0.01], [0.0], [0.0]])
    >>> stress = soil.update(shear, np.array([[-1.0], [-1.0], [-1.0], [0.0]]), np.zeros((1, 1))).stress
    >>> again = AssociatedSubstitute(soil).update(shear, stress, np.zeros((1, 1))).stress
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
        substitute = replace(
            soil,
            E=at_points(soil.E),
            nu=at_points(soil.nu),
            c=strength / (2 * np.cos(psi)),
            phi=at_points(soil.psi),
            psi=at_points(soil.psi),
            tension=None if soil.tension is None else at_points(soil.tension),
        )
        flat = substitute.update(*(a.reshape(len(a), -1) for a in (strain_increment, stress, internal)))
        return Update(
            flat.stress.reshape(stress.shape), flat.internal.reshape(internal.shape), flat.plastic, flat.tangent
        )
