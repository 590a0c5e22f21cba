"""Loads: ordinary load vectors of scikit-fem, and water at rest."""

from .masses import weight_matrix
from .vectors import (
    Domain,
    by_element,
    hydrostatic,
    traction,
    weight,
    weight_of_water,
    weightless,
)
from .water_at_rest import Pressure, water_load

__all__ = [
    "Domain",
    "Pressure",
    "by_element",
    "hydrostatic",
    "traction",
    "water_load",
    "weight",
    "weight_matrix",
    "weight_of_water",
    "weightless",
]
