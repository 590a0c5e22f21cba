"""How much of its strength a material uses, and what a point does: it is elastic, it yields, or it is torn."""
from __future__ import annotations

from enum import IntEnum
from typing import Any

import numpy as np
from numpy import ndarray

from ..solid import SolidForm
from .quantities import mises, principal

#: Points this close to their strength count as yielding: stresses return to it up to round-off.
_AT_YIELD = 1e-6


class PointStatus(IntEnum):
    """What an integration point does."""

    ELASTIC = 0
    YIELDS = 1
    TENSION = 2


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
    for region in form.regions:
        if (limit := _tension_limit(region.material)) is not None:
            largest = principal(state.stress[:, region.elements])[..., 2]
            scale = np.abs(state.stress[:3, region.elements]).max(initial=0.0)
            torn = largest >= _by_element(limit) - _AT_YIELD * (scale + _by_element(limit))
            status[region.elements][torn] = PointStatus.TENSION
    return status


def _shear_and_strength(form: SolidForm, state: Any) -> tuple[ndarray, ndarray]:
    """Shear measure of the laws and its limit at every point; the limit is infinite where there is none."""
    shear = np.zeros(state.stress.shape[1:])
    strength = np.full_like(shear, np.inf)
    for region in form.regions:
        law: Any = region.material
        part = region.elements
        stress = state.stress[:, part]
        if hasattr(law, "c"):  # Mohr and Coulomb, or Tresca: there is no friction
            values = principal(stress)
            c, phi = _cohesion_and_friction(law, state.internal[:1, part])
            shear[part] = 0.5 * (values[..., 2] - values[..., 0])
            strength[part] = c * np.cos(phi) - 0.5 * (values[..., 2] + values[..., 0]) * np.sin(phi)
        elif hasattr(law, "alpha"):  # Drucker and Prager
            shear[part] = mises(stress) / np.sqrt(3.0)
            strength[part] = _by_element(law.k) - _by_element(law.alpha) * stress[:3].sum(axis=0)
        elif hasattr(law, "strength"):
            shear[part], strength[part] = mises(stress), _by_element(law.strength)
    return shear, strength


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
