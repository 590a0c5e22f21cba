"""Correlations of strength, stiffness and unit weight with cone resistances, by their names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray

#: Atmospheric pressure, kPa, and unit weight of water, kN/m³.
_ATMOSPHERE = 100.0
_WATER = 9.81
#: Index of soil behaviour between drained and undrained penetration.
_CLAY = 2.6


@dataclass(frozen=True)
class Profile:
    """Parameter by depth that a correlation gives: it is estimated, not measured.

    Attributes
    ----------
    parameter
        Its name.
    unit
        Its unit.
    correlation
        Formula, constants and source.
    depth
        Depths in m, (n,).
    values
        Values, (n,), NaN where nothing was measured or the correlation is not meant for the soil.
    """

    parameter: str
    unit: str
    correlation: str
    depth: ndarray
    values: ndarray

    def between(self, upper: float, lower: float) -> float:
        """Return the median between two depths; half of the values are below it."""
        inside = (self.depth >= upper) & (self.depth <= lower) & np.isfinite(self.values)
        if not inside.any():
            raise ValueError(
                f"there is no {self.parameter} between the depths {upper:g} and {lower:g}"
            )
        return float(np.median(self.values[inside]))


@dataclass(frozen=True)
class Correlation:
    """Formula with its constants and its source.

    Attributes
    ----------
    parameter, unit
        Name and unit of the result.
    formula, source
        Formula and publication.
    constants
        Constants that may be given, with their defaults.
    compute
        Function of a sounding, its behaviour and the constants.
    """

    parameter: str
    unit: str
    formula: str
    source: str
    constants: Mapping[str, float]
    compute: Callable[[Any, Mapping[str, ndarray], Mapping[str, float]], ndarray]

    def values(
        self,
        sounding: Any,
        behaviour: Mapping[str, ndarray],
        constants: Mapping[str, float],
    ) -> ndarray:
        """Return the values at the depths of a sounding."""
        strange = [name for name in constants if name not in self.constants]
        if strange:
            known = ", ".join(self.constants) or "none"
            raise ValueError(f"'{self.parameter}' has no constant '{strange[0]}'; known: {known}")
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.compute(sounding, behaviour, {**self.constants, **constants})

    def applied(
        self,
        sounding: Any,
        behaviour: Mapping[str, ndarray],
        constants: Mapping[str, float],
    ) -> Profile:
        """Return the profile of a sounding."""
        values = self.values(sounding, behaviour, constants)
        used = {**self.constants, **constants}
        numbers = "".join(f", {name} = {value:g}" for name, value in used.items())
        text = f"{self.formula}{numbers} ({self.source})"
        return Profile(self.parameter, self.unit, text, sounding.depth, values)


def _unit_weight(
    sounding: Any, behaviour: Mapping[str, ndarray], constants: Mapping[str, float]
) -> ndarray:
    usable = sounding.measured & (sounding.cone > 0.0) & (sounding.sleeve > 0.0)
    resistance = np.where(usable, sounding.resistance, np.nan)
    ratio = 100.0 * sounding.sleeve / resistance
    weight = 0.27 * np.log10(ratio) + 0.36 * np.log10(resistance / _ATMOSPHERE) + 1.236
    return np.asarray(constants["water"] * weight)


def _friction_angle(
    sounding: Any, behaviour: Mapping[str, ndarray], constants: Mapping[str, float]
) -> ndarray:
    sand = behaviour["I_c"] <= _CLAY
    return np.where(sand, 17.6 + 11.0 * np.log10(behaviour["Q_tn"]), np.nan)


def _undrained_strength(
    sounding: Any, behaviour: Mapping[str, ndarray], constants: Mapping[str, float]
) -> ndarray:
    clay = behaviour["I_c"] > _CLAY
    net = sounding.resistance - behaviour["total"]
    return np.where(clay, net / constants["N_kt"], np.nan)


def _stiffness(
    sounding: Any, behaviour: Mapping[str, ndarray], constants: Mapping[str, float]
) -> ndarray:
    sand = behaviour["I_c"] <= _CLAY
    factor = 0.015 * 10.0 ** (0.55 * behaviour["I_c"] + 1.68)
    return np.where(sand, factor * (sounding.resistance - behaviour["total"]), np.nan)


#: Correlations by their parameters.
CORRELATIONS = {
    "unit_weight": Correlation(
        "unit_weight",
        "kN/m³",
        "gamma = gamma_w (0.27 lg R_f + 0.36 lg(q_t/p_a) + 1.236)",
        "Robertson & Cabal 2010",
        {"water": _WATER},
        _unit_weight,
    ),
    "phi": Correlation(
        "phi",
        "degrees",
        "phi' = 17.6 + 11 lg Q_tn where I_c <= 2.6",
        "Kulhawy & Mayne 1990",
        {},
        _friction_angle,
    ),
    "su": Correlation(
        "su",
        "kPa",
        "s_u = (q_t - sigma_v0)/N_kt where I_c > 2.6",
        "Lunne, Robertson & Powell 1997",
        {"N_kt": 14.0},
        _undrained_strength,
    ),
    "E": Correlation(
        "E",
        "kPa",
        "E' = 0.015 10^(0.55 I_c + 1.68) (q_t - sigma_v0) where I_c <= 2.6",
        "Robertson 2009",
        {},
        _stiffness,
    ),
}
