r"""Curves of the ground along piles: API RP 2GEO, ISO 19901-4.

Each curve is an array (m, 2) of displacements and resistances that begins with (0, 0). Lateral and
skin resistances are forces per length of the pile, the resistance of the tip is a force.
"""

from __future__ import annotations

import numpy as np
from numpy import ndarray

from ..checks import number, positive

__all__ = ["clay_p_y", "clay_t_z", "q_z", "sand_factors", "sand_p_y", "sand_t_z"]

#: Displacement over y_c, and share of the resistance, of soft clay under static load.
_CLAY = np.array([[0.0, 0.0], [0.1, 0.23], [0.3, 0.33], [1.0, 0.5], [3.0, 0.72], [8.0, 1.0]])
#: Displacement over the diameter, and share of the skin friction, of clay.
_SKIN_OF_CLAY = np.array(
    [[0.0, 0.0], [0.0016, 0.3], [0.0031, 0.5], [0.0057, 0.75], [0.008, 0.9], [0.01, 1.0]]
)
#: Displacement over the diameter, and share of the resistance, of the tip.
_TIP = np.array([[0.0, 0.0], [0.002, 0.25], [0.013, 0.5], [0.042, 0.75], [0.073, 0.9], [0.1, 1.0]])
#: Arguments of tanh at the points of a curve in sand.
_STEPS = np.array([0.0, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0, 1.25, 1.5, 1.8, 2.2, 2.7, 3.4])
#: Ratio K0 in the lateral resistance of sand.
_K0 = 0.4


def clay_p_y(
    depth: float,
    diameter: float,
    *,
    su: float,
    unit_weight: float,
    eps50: float = 0.01,
    J: float = 0.5,
) -> ndarray:
    r"""Return the lateral curve of soft clay under static load (Matlock).

    The limit is :math:`p_u = \min(3 + \gamma' z / s_u + J z / D,\ 9)\, s_u D`, and
    :math:`y_c = 2.5\, \varepsilon_{50} D`.

    Parameters
    ----------
    depth
        Depth below the ground surface.
    diameter
        Diameter of the pile.
    su, unit_weight
        Undrained strength and effective unit weight.
    eps50, J
        Strain at half of the strength, and Matlock's constant, 0.25 to 0.5.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.curves.clay_p_y(20., 1., su=30., unit_weight=8.)[-1].tolist()
    [0.2, 270.0]
    """
    z = number(depth, "depth", -1e-9)
    D = positive(diameter, "diameter")
    c = positive(su, "su")
    overburden = positive(unit_weight, "unit_weight") * z
    factor = min(3.0 + overburden / c + J * z / D, 9.0)
    limit = factor * c * D
    return _CLAY * (2.5 * positive(eps50, "eps50") * D, limit)


def sand_p_y(
    depth: float,
    diameter: float,
    *,
    phi: float,
    unit_weight: float,
    k: float,
    cyclic: bool = False,
) -> ndarray:
    r"""Return the lateral curve of sand.

    :math:`p = A p_u \tanh(k z y / (A p_u))` with :math:`A = \max(3 - 0.8 z / D,\ 0.9)`, and 0.9
    under cyclic load;
    :math:`p_u = \min((C_1 z + C_2 D)\, \gamma' z,\ C_3 D \gamma' z)`.

    Parameters
    ----------
    depth
        Depth below the ground surface. At the surface sand has no resistance.
    diameter
        Diameter of the pile.
    phi, unit_weight
        Friction angle in degrees, and effective unit weight.
    k
        Rate at which the initial modulus grows with depth: a force per volume.
    cyclic
        True for cyclic load.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> curve = sc.curves.sand_p_y(10., 1., phi=35., unit_weight=10., k=22e3)
    >>> f"{curve[-1, 1]:.0f}"   # 0.9 (C1 z + C2 D) gamma' z, C1 = 2.97, C2 = 3.42
    '2981'
    """
    z = number(depth, "depth", -1e-9)
    D = positive(diameter, "diameter")
    k = positive(k, "k")
    weight = positive(unit_weight, "unit_weight")
    C1, C2, C3 = sand_factors(phi)
    # p_u: a wedge near the surface, flow around the pile below
    ultimate = min((C1 * z + C2 * D) * weight * z, C3 * D * weight * z)
    # p = A p_u tanh(k z y / (A p_u)), A = 0.9 or 3 - 0.8 z / D
    A = 0.9
    if not cyclic:
        A = max(3.0 - 0.8 * z / D, 0.9)
    limit = A * ultimate
    if limit <= 0.0:
        return np.array([[0.0, 0.0], [D, 0.0]])
    shares = np.tanh(_STEPS)
    shares[-1] = 1.0
    return np.column_stack((_STEPS * limit / (k * z), shares * limit))


def sand_factors(phi: float) -> tuple[float, float, float]:
    r"""Return C1, C2 and C3 of the lateral resistance of sand.

    With :math:`\alpha = \varphi/2`, :math:`\beta = 45° + \varphi/2`.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> [round(C, 2) for C in sc.curves.sand_factors(35.)]
    [2.97, 3.42, 53.79]
    """
    f = np.radians(number(phi, "phi", 0.0, 60.0))
    # alpha = phi / 2, beta = 45 degrees + phi / 2
    a = 0.5 * f
    b = np.pi / 4.0 + a
    Ka = np.tan(np.pi / 4.0 - a) ** 2
    slope = np.tan(b - f)
    # C1 = tan^2 b tan a / tan(b - phi) + K0 (sides + front)
    wedge = np.tan(b) ** 2 * np.tan(a) / slope
    sides = np.tan(f) * np.sin(b) / (np.cos(a) * slope)
    front = np.tan(b) * (np.tan(f) * np.sin(b) - np.tan(a))
    C1 = wedge + _K0 * (sides + front)
    C2 = np.tan(b) / slope - Ka
    C3 = Ka * (np.tan(b) ** 8 - 1.0) + _K0 * np.tan(f) * np.tan(b) ** 4
    return float(C1), float(C2), float(C3)


def sand_t_z(friction: float, diameter: float, *, peak: float = 0.0025) -> ndarray:
    """Return the curve of skin friction in sand: linear up to a displacement, then level.

    Parameters
    ----------
    friction
        Skin friction (stress).
    diameter
        Diameter of the pile.
    peak
        Displacement at which the friction is reached; 2.5 mm in metres.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.curves.sand_t_z(50., 1. / 3.14159265).round(3).tolist()
    [[0.0, 0.0], [0.003, 50.0]]
    """
    D = positive(diameter, "diameter")
    limit = positive(friction, "friction") * np.pi * D
    return np.array([[0.0, 0.0], [positive(peak, "peak"), limit]])


def clay_t_z(friction: float, diameter: float) -> ndarray:
    """Return the curve of skin friction in clay, reached at a hundredth of the diameter.

    Parameters
    ----------
    friction
        Skin friction (stress).
    diameter
        Diameter of the pile.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.curves.clay_t_z(50., .5)[-1].round(3).tolist()
    [0.005, 78.54]
    """
    D = positive(diameter, "diameter")
    return _SKIN_OF_CLAY * (D, positive(friction, "friction") * np.pi * D)


def q_z(resistance: float, diameter: float) -> ndarray:
    """Return the curve of the tip, whose resistance is reached at a tenth of the diameter.

    Parameters
    ----------
    resistance
        Resistance of the tip (force).
    diameter
        Diameter of the pile.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> sc.curves.q_z(900., .5)[-1].tolist()
    [0.05, 900.0]
    """
    return _TIP * (positive(diameter, "diameter"), positive(resistance, "resistance"))
