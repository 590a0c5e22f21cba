"""Design by partial factors: sets of Eurocode 7, design models, checks of footings and walls."""

from .bearing import BearingResistance, bearing_resistance
from .check import BaseCheck, check
from .factored import factored
from .factors import EC7, PartialFactors

__all__ = [
    "EC7",
    "BaseCheck",
    "BearingResistance",
    "PartialFactors",
    "bearing_resistance",
    "check",
    "factored",
]
