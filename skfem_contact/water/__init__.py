"""Water in the ground: steady seepage, confined or with a free surface, and consolidation."""

from .pore_state import PoreState
from .pore_water import PoreWater
from .retention import Ramp, Retention, VanGenuchten
from .seepage import Seepage, seepage

__all__ = ["PoreState", "PoreWater", "Ramp", "Retention", "Seepage", "VanGenuchten", "seepage"]
