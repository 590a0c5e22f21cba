r"""Bearing resistance of footings: EN 1997-1:2004, annex D.

Drained,

.. math:: R / A' = c' N_c s_c i_c + q' N_q s_q i_q + \tfrac12 \gamma' B' N_\gamma s_\gamma i_\gamma,

with :math:`N_q = e^{\pi \tan\varphi} \tan^2(45° + \varphi/2)`,
:math:`N_c = (N_q - 1) \cot\varphi`, :math:`N_\gamma = 2 (N_q - 1) \tan\varphi`; undrained
:math:`R / A' = (\pi + 2) c_u s_c i_c + q`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..checks import number, positive


@dataclass(frozen=True)
class BearingResistance:
    """Bearing resistance with its factors.

    Attributes
    ----------
    resistance
        Vertical resistance, a force; per length for a strip.
    pressure
        The same over the effective area.
    capacity
        Factors of capacity Nc, Nq and Ngamma.
    shape, inclination
        Factors of shape and of inclination, in the same order.
    """

    resistance: float
    pressure: float
    capacity: tuple[float, float, float]
    shape: tuple[float, float, float]
    inclination: tuple[float, float, float]


def bearing_resistance(
    width: float,
    *,
    vertical: float,
    horizontal: float = 0.0,
    length: float = np.inf,
    c: float = 0.0,
    phi: float = 0.0,
    unit_weight: float = 0.0,
    surcharge: float = 0.0,
) -> BearingResistance:
    r"""Return the bearing resistance of a horizontal base, after EN 1997-1:2004, annex D.

    Parameters
    ----------
    width
        Effective width B' = B - 2 e.
    vertical, horizontal
        Forces on the base, per length for a strip; the horizontal one acts along the width.
    length
        Effective length L', infinite for a strip.
    c, phi
        Effective cohesion, and friction angle in degrees. With ``phi=0`` c is the undrained
        strength.
    unit_weight
        Effective unit weight of the ground below the base.
    surcharge
        Pressure next to the footing at the depth of its base, effective where `phi` is not zero.

    Raises
    ------
    ValueError
        A negative value, a width or a force that is not positive, ground without strength, or a
        horizontal force that the ground cannot take.

    Examples
    --------
    A strip on sand of 30 degrees, without and with an inclined load:

    >>> import skfem_contact as sc
    >>> found = sc.design.bearing_resistance(2., vertical=200., phi=30., unit_weight=18.)
    >>> [round(N, 2) for N in found.capacity], round(found.resistance, 1)
    ([30.14, 18.4, 20.09], 723.4)
    >>> inclined = sc.design.bearing_resistance(
    ...     2., vertical=200., horizontal=40., phi=30., unit_weight=18.)
    >>> round(inclined.resistance / found.resistance, 3)   # (1 - 40 / 200)^3
    0.512
    """
    B = positive(width, "width")
    V = positive(vertical, "vertical")
    H = abs(number(horizontal, "horizontal"))
    for name, value in {"c": c, "unit_weight": unit_weight, "surcharge": surcharge}.items():
        if not value >= 0.0 or not np.isfinite(value):
            raise ValueError(f"{name} must not be negative, but is {value!r}")
    if not 0.0 <= phi < 60.0:
        raise ValueError(f"phi is an angle between 0 and 60 degrees, not {phi!r}")
    if length < B or not length > 0.0:
        raise ValueError(f"the length, {length!r}, must be at least the width, {B:g}")
    if phi == 0.0:
        return _undrained(B, length, H, c, surcharge)
    return _drained(
        B,
        length,
        V,
        H,
        c,
        phi,
        unit_weight,
        surcharge,
    )


def _undrained(B: float, L: float, H: float, cu: float, q: float) -> BearingResistance:
    """Return the resistance of the undrained strength, (D.1)."""
    # Check the strength against sliding.
    area = B if np.isinf(L) else B * L
    if not cu > 0.0:
        raise ValueError("the ground has no strength: give c, or phi as well")
    if area * cu < H:
        raise ValueError(
            f"the horizontal force {H:g} is larger than the shear resistance {area * cu:g} of the "
            "effective area: the footing slides"
        )
    # Factors of shape and inclination, EN 1997-1 D.3.
    sc = 1.0 if np.isinf(L) else 1.0 + 0.2 * B / L
    ic = 0.5 * (1.0 + np.sqrt(1.0 - H / (area * cu)))
    pressure = (np.pi + 2.0) * cu * sc * ic + q
    factors = (np.pi + 2.0, 1.0, 0.0)
    return BearingResistance(
        pressure * area, pressure, factors, (sc, 1.0, 1.0), (float(ic), 1.0, 1.0)
    )


def _drained(
    B: float,
    L: float,
    V: float,
    H: float,
    c: float,
    phi: float,
    weight: float,
    q: float,
) -> BearingResistance:
    """Return the resistance of the drained strength, (D.2)."""
    # Factors of capacity.
    friction = np.tan(np.radians(phi))
    passive = np.tan(np.radians(45.0 + 0.5 * phi)) ** 2
    Nq = np.exp(np.pi * friction) * passive
    Nc = (Nq - 1.0) / friction
    Ny = 2.0 * (Nq - 1.0) * friction

    # Factors of shape.
    ratio = 0.0 if np.isinf(L) else B / L
    sq = 1.0 + ratio * np.sin(np.radians(phi))
    sy = 1.0 - 0.3 * ratio
    s_c = (sq * Nq - 1.0) / (Nq - 1.0)

    # Factors of inclination.
    area = B if np.isinf(L) else B * L
    m = (2.0 + ratio) / (1.0 + ratio)
    taken = 1.0 - H / (V + area * c / friction)
    if taken <= 0.0:
        raise ValueError(
            f"the horizontal force {H:g} is larger than the vertical one and the cohesion can "
            f"take, {V + area * c / friction:g}"
        )
    iq = taken**m
    iy = taken ** (m + 1.0)
    i_c = iq - (1.0 - iq) / (Nc * friction)

    cohesion = c * Nc * s_c * i_c
    surcharge = q * Nq * sq * iq
    own_weight = 0.5 * weight * B * Ny * sy * iy
    pressure = cohesion + surcharge + own_weight
    return BearingResistance(
        resistance=float(pressure * area),
        pressure=float(pressure),
        capacity=(float(Nc), float(Nq), float(Ny)),
        shape=(float(s_c), float(sq), float(sy)),
        inclination=(float(i_c), float(iq), float(iy)),
    )
