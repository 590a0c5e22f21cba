"""Strength of the ground: what of it is used, what points do, pore pressure and strength without drainage."""
from __future__ import annotations

from enum import IntEnum
from typing import Any

import numpy as np
from numpy import ndarray

from ..forms.solid import SolidForm, SolidState
from ..materials import Undrained, spectral

#: Points this close to their strength count as yielding: stresses return to it up to round-off.
_AT_YIELD = 1e-6


class PointStatus(IntEnum):
    """What an integration point does."""

    ELASTIC = 0
    YIELDS = 1
    TENSION = 2


def principal(stress: ndarray) -> ndarray:
    """Principal stresses (3, ...) of (4 or 6, ...) in descending order."""
    return spectral.principal(stress.reshape(len(stress), -1)).values.reshape(3, *stress.shape[1:])


def mises(stress: ndarray) -> ndarray:
    """Von Mises' equivalent of stresses (4 or 6, ...)."""
    return np.sqrt(3.0) * spectral.mean_and_shear(stress)[1]


def plastic_strain(form: SolidForm, state: Any) -> ndarray:
    """Equivalent plastic strain of a solid's points, (n_elements, n_points)."""
    return state.internal[0] if len(state.internal) else np.zeros(state.stress.shape[1:])


def mobilised(form: SolidForm, state: Any) -> ndarray:
    """Share of the shear strength that is used at the points of a solid, 0 to 1, (n_elements, n_points).

    With Mohr's circle it is the radius over the distance of its centre from the yield line; zero where a material has
    no strength.
    """
    shear, strength = _shear_and_strength(form, state)
    ratio = np.divide(shear, strength, out=np.ones_like(shear), where=strength > 0.0)
    return np.where(np.isfinite(strength), np.clip(ratio, 0.0, 1.0), 0.0)


def point_status(form: SolidForm, state: Any) -> ndarray:
    """:class:`PointStatus` of the points of a solid, (n_elements, n_points)."""
    status = np.where(mobilised(form, state) > 1.0 - _AT_YIELD, PointStatus.YIELDS, PointStatus.ELASTIC)
    stress = _effective(form, state)
    for region in form.regions:
        if (limit := _tension_limit(soil_of(region.material))) is not None:
            largest = principal(stress[:, region.elements])[0]
            scale = np.abs(stress[:3, region.elements]).max(initial=0.0)
            torn = largest >= _by_element(limit) - _AT_YIELD * (scale + _by_element(limit))
            status[region.elements][torn] = PointStatus.TENSION
    return status


def _shear_and_strength(form: SolidForm, state: Any) -> tuple[ndarray, ndarray]:
    """Shear measure of the laws and its limit at every point; the limit is infinite where there is none."""
    shear = np.zeros(state.stress.shape[1:])
    strength, effective = np.full_like(shear, np.inf), _effective(form, state)
    for region in form.regions:
        law = soil_of(region.material)
        part = region.elements
        stress = effective[:, part]
        if hasattr(law, "c"):  # Mohr and Coulomb, or Tresca: there is no friction
            largest, _, smallest = principal(stress)
            c, phi = _cohesion_and_friction(law, state.internal[:1, part])
            shear[part] = 0.5 * (largest - smallest)
            strength[part] = c * np.cos(phi) - 0.5 * (largest + smallest) * np.sin(phi)
        elif hasattr(law, "alpha"):  # Drucker and Prager
            shear[part] = mises(stress) / np.sqrt(3.0)
            strength[part] = _by_element(law.k) - _by_element(law.alpha) * stress[:3].sum(axis=0)
        elif hasattr(law, "strength"):
            shear[part], strength[part] = mises(stress), _by_element(law.strength)
    return shear, strength


def _effective(form: SolidForm, state: Any) -> ndarray:
    """Stresses without the excess pore pressure."""
    pressure = pore_pressure(form, state)
    return np.concatenate((state.stress[:3] + pressure, state.stress[3:]))


def _cohesion_and_friction(law: Any, internal: ndarray) -> tuple[Any, Any]:
    """Cohesion and friction angle (radians) at points, which may have hardened or softened."""
    c, phi = _by_element(law.c), np.radians(_by_element(getattr(law, "phi", 0.0)))
    if hasattr(law, "strain_end") and len(internal):
        way = np.minimum(internal[0] / _by_element(law.strain_end), 1.0)
        c = c + way * (_by_element(law.c_end) - c)
        phi = phi + way * (np.radians(_by_element(law.phi_end)) - phi)
    return c, phi


def _tension_limit(law: Any) -> Any:
    """Tensile strength: the cut-off, or the apex of Mohr and Coulomb's pyramid; None if there is neither."""
    cut_off = getattr(law, "tension", None)
    if cut_off is not None:
        return cut_off
    if not hasattr(law, "phi"):
        return None
    with np.errstate(divide="ignore"):
        return law.c / np.tan(np.radians(law.phi)) if np.all(np.asarray(law.phi) > 0.0) else None


def _by_element(value: Any) -> Any:
    """A parameter beside arrays (n_elements, n_points)."""
    return value[:, None] if np.ndim(value) else value


def pore_pressure(form: SolidForm, state: SolidState) -> ndarray:
    """Return the excess pore pressure in regions of :class:`Undrained` soil, (n_elements, n_points), zero elsewhere."""
    pressure = np.zeros(form.weight.shape)
    for region in form.regions:
        if isinstance(region.material, Undrained) and len(state.internal) >= region.material.n_internal:
            pressure[region.elements] = state.internal[region.material.n_internal - 1, region.elements]
    return pressure


def soil_of(material: Any) -> Any:
    """The law in effective stresses of a material: that of the soil where the ground is :class:`Undrained`."""
    return material.soil if isinstance(material, Undrained) else material


def undrained_strength(form: SolidForm, state: SolidState) -> dict[str, ndarray]:
    """Return the undrained shear strength of a plane solid by region with `c` and `phi`, (n_elements,) each."""
    if len(state.stress) != 4:
        raise ValueError("the undrained strength is that of plane strain; this solid is in space")
    mean = -0.5 * (state.stress[0] + state.stress[1]) + pore_pressure(form, state)
    mean = (mean * form.weight).sum(axis=1) / form.weight.sum(axis=1)
    strength = {}
    for region in form.regions:
        soil = soil_of(region.material)
        if hasattr(soil, "c") and hasattr(soil, "phi"):
            phi = np.radians(soil.phi)
            strength[region.name] = np.maximum(soil.c * np.cos(phi) + mean[region.elements] * np.sin(phi), 0.0)
    if not strength:
        raise ValueError(f"no region has c and phi; the regions are {list(form.materials)}")
    return strength
