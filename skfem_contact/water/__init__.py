"""Water in the ground: steady seepage, confined or with a free surface, and consolidation."""

from .drainage import SeepageFace
from .pore_water import PoreWater
from .porous import PoreState
from .retention import Ramp, Retention, VanGenuchten
from .seepage import Seepage, seepage

__all__ = ["PoreState", "PoreWater", "Ramp", "Retention", "Seepage", "SeepageFace", "VanGenuchten", "seepage"]
