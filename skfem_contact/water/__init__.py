"""Water in the ground: steady seepage, confined or with a free surface."""

from .retention import Ramp, Retention, VanGenuchten
from .seepage import Seepage, seepage

__all__ = ["Ramp", "Retention", "Seepage", "VanGenuchten", "seepage"]
