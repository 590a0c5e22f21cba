"""Reduced strength with the flow that is assumed: as given, associated, after Davis, or lagging.

With psi < phi collapse loads depend on mesh and path.  Davis (1968) replaces the soil by an associated one of less
strength, c* = beta c and tan phi* = beta tan phi with

    beta = cos psi cos phi / (1 - sin psi sin phi),

the shear strength on a plane along which the soil shears without extension.  How the reduction enters beta
distinguishes the procedures A, B and C (F. Tschuchnigg, H. F. Schweiger, S. W. Sloan, Computers and Geotechnics 70
(2015) 169-177 and 178-189).
"""

from __future__ import annotations

from typing import Any, Literal, get_args

import numpy as np

from .base import Parameter, require

Flow = Literal["given", "associated", "davis_a", "davis_b", "davis_c", "lagged"]
FLOWS: tuple[str, ...] = get_args(Flow)


def reduced_strength(material: Any, factor: float, flow: str = "given") -> Any:
    """A material with its strength divided by a factor: ``material.reduced(factor, flow)``.

    Parameters
    ----------
    material
        Material with a method ``reduced``; one that has a single flow ignores the second argument.
    factor
        Strength reduction factor, positive.
    flow
        ``"given"``: c and tan phi are divided, psi stays unless it exceeds the new phi; ``"associated"``: psi = phi;
        ``"davis_a"``: beta of the unreduced soil; ``"davis_b"``: beta of the reduced soil with its psi;
        ``"davis_c"``: the same with tan psi divided as well; ``"lagged"``: as given, with the friction of the pressure
        at the start of each step (see :class:`~.substitute.AssociatedSubstitute`).

    Raises
    ------
    ValueError
        Unknown flow or one that the material does not have, factor not positive, or a material without strength.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> soil = sc.MohrCoulomb(E=1e5, nu=.3, c=10., phi=20., psi=0.)
    >>> weaker = reduced_strength(soil, 1.0, "davis_a")
    >>> print(f"{weaker.c:.4f} {weaker.phi:.4f} {weaker.psi:.4f}")
    9.3969 18.8816 18.8816
    """
    if not hasattr(material, "reduced"):
        raise ValueError(f"{type(material).__name__} has no strength to reduce: no method reduced(factor, flow)")
    return material.reduced(factor, flow)


def check_reduction(factor: float, flow: str) -> None:
    """A ``ValueError`` for a factor that is not positive or an unknown flow.

    Examples
    --------
    >>> check_reduction(1.5, "davis")
    Traceback (most recent call last):
    ...
    ValueError: flow must be one of given, associated, davis_a, davis_b, davis_c, lagged, not 'davis'
    """
    require("factor", factor, np.isfinite(factor) and factor > 0, "be positive")
    if flow not in FLOWS:
        raise ValueError(f"flow must be one of {', '.join(FLOWS)}, not {flow!r}")


def without_dilatancy(c: Parameter, phi: Parameter, psi: Parameter) -> tuple[Parameter, Parameter]:
    """Cohesion and friction angle, in degrees, of the associated soil of Davis.

    Examples
    --------
    >>> c, phi = without_dilatancy(10.0, 30.0, 30.0)
    >>> print(f"{c:.9g} {phi:.9g}")  # associated soil stays as it is
    10 30
    """
    friction, dilatancy = np.radians(phi), np.radians(psi)
    beta = np.cos(dilatancy) * np.cos(friction) / (1 - np.sin(dilatancy) * np.sin(friction))
    return beta * c, np.degrees(np.arctan(beta * np.tan(friction)))


def dilates_less(material: Any) -> bool:
    """Whether a material has an angle of friction and a smaller one of dilatancy.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> dilates_less(sc.MohrCoulomb(E=1e5, nu=.3, c=10., phi=20., psi=0.)), dilates_less(sc.Tresca(E=1e5, nu=.3, c=10.))
    (True, False)
    """
    return hasattr(material, "psi") and bool(np.any(material.psi < material.phi))


def associated_bound(material: Any, factor: float) -> float:
    """Factor from which the associated material has no more strength than that of Davis (B) at another factor.

    Where the soils of Davis collapse at ``factor``, associated ones cannot stand at the largest bound of all materials,
    for they have less strength; nor can any with less dilatancy (Radenkovic's theorem).

    Examples
    --------
    >>> import skfem_contact as sc
    >>> soil = sc.MohrCoulomb(E=1e5, nu=.3, c=10., phi=20., psi=0.)
    >>> bound = associated_bound(soil, 1.2)
    >>> print(f"{soil.reduced(bound, 'associated').c:.6f} {soil.reduced(1.2, 'davis_b').c:.6f}")
    7.973640 7.973640
    """
    if not dilates_less(material):
        return factor
    friction, reduced = np.radians(material.phi), np.radians(material.reduced(factor, "davis_b").phi)
    return float(np.max(np.tan(friction) / np.tan(reduced), initial=factor, where=np.greater(friction, 0.0)))
