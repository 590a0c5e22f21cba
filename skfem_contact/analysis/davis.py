"""Reduced strength with the flow that is assumed: as given, associated, or after Davis.

With psi < phi collapse loads depend on mesh and path.  Davis (1968) replaces the soil by an associated one of less
strength, c* = beta c and tan phi* = beta tan phi with

    beta = cos psi cos phi / (1 - sin psi sin phi),

the shear strength on a plane along which the soil shears without extension.  How the reduction enters beta
distinguishes the procedures A, B and C (F. Tschuchnigg, H. F. Schweiger, S. W. Sloan, Computers and Geotechnics 70
(2015) 169-177 and 178-189).
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal, get_args

import numpy as np

from ..materials.undrained import Undrained

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
    if isinstance(material, Undrained):
        return replace(material, soil=reduced_strength(material.soil, factor, flow))
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
