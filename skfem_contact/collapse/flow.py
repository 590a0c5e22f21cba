"""Reduced strength with the flow that is assumed: as given, associated, or after Davis.

With psi < phi collapse loads depend on mesh and path.  Davis (1968) replaces the soil by an associated one of less
strength, c* = beta c and tan phi* = beta tan phi with

    beta = cos psi cos phi / (1 - sin psi sin phi),

the shear strength on a plane along which the soil shears without extension.  How the reduction enters beta
distinguishes the procedures A, B and C (F. Tschuchnigg, H. F. Schweiger, S. W. Sloan, Computers and Geotechnics 70
(2015) 169-177 and 178-189).
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np

from ..materials.base import Array, Parameter, Update, along_elements
from ..materials.mohr_coulomb import MohrCoulomb
from ..materials.spectral import extremes

#: Share of the strength without pressure that is left in tension, where the soil would be beyond its apex.
_LEAST = 0.1
Flow = Literal["given", "associated", "davis_a", "davis_b", "davis_c"]
FLOWS: tuple[str, ...] = get_args(Flow)


def reduced_strength(material: Any, factor: float, flow: Flow = "given") -> Any:
    """A material with its strength divided by a factor.

    Parameters
    ----------
    material
        Material with a method ``reduced``.  Laws without a dilatancy ``psi`` flow as they are.
    factor
        Strength reduction factor.
    flow
        ``"given"``: c and tan phi are divided, psi stays unless it exceeds the new phi; ``"associated"``: psi = phi;
        ``"davis_a"``: beta of the unreduced soil; ``"davis_b"``: beta of the reduced soil with its psi;
        ``"davis_c"``: the same with tan psi divided as well.

    Raises
    ------
    ValueError
        Unknown flow.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> soil = sc.MohrCoulomb(E=1e5, nu=.3, c=10., phi=20., psi=0.)
    >>> weaker = reduced_strength(soil, 1.0, "davis_a")
    >>> print(f"{weaker.c:.4f} {weaker.phi:.4f} {weaker.psi:.4f}")
    9.3969 18.8816 18.8816
    """
    if flow not in FLOWS:
        raise ValueError(f"flow must be one of {', '.join(FLOWS)}, not {flow!r}")
    if flow == "given" or not hasattr(material, "psi"):
        return material.reduced(factor)
    if flow == "associated":
        return replace(material, psi=material.phi).reduced(factor)
    if flow == "davis_a":
        return _davis(material).reduced(factor)
    weaker = material.reduced(factor)
    if flow == "davis_c":
        psi = np.degrees(np.arctan(np.tan(np.radians(material.psi)) / factor))
        weaker = replace(weaker, psi=np.minimum(psi, weaker.phi))
    return _davis(weaker)


def _davis(material: Any) -> Any:
    """The associated material of Davis; parameters may be arrays."""
    phi, psi = np.radians(material.phi), np.radians(material.psi)
    beta = np.cos(psi) * np.cos(phi) / (1 - np.sin(psi) * np.sin(phi))
    angle = np.degrees(np.arctan(beta * np.tan(phi)))
    return replace(material, c=beta * material.c, phi=angle, psi=angle)


def associated_substitute(soil: Any) -> Any:
    """The soil with the friction of the pressure at the start of an increment; associated flow stays as it is.

    Raises
    ------
    ValueError
        For another law than :class:`MohrCoulomb`.
    """
    if not isinstance(soil, MohrCoulomb):
        raise ValueError(f"flow 'lagged' is known for MohrCoulomb, not for {type(soil).__name__}")
    return soil if np.all(soil.psi == soil.phi) else AssociatedSubstitute(soil)


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
