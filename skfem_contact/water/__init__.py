"""Water in the ground: steady seepage, confined or with a free surface, and consolidation."""

from .face import SeepageFace
from .pore_state import PoreState
from .pore_water import PoreWater
from .retention import Ramp, Retention, VanGenuchten
from .seepage import Seepage, seepage

__all__ = ["PoreState", "PoreWater", "Ramp", "Retention", "Seepage", "SeepageFace", "VanGenuchten", "seepage"]
