"""Water in the ground: seepage, steady or in time, confined or with a free surface, and consolidation."""

from .consolidation import PoreWater
from .darcy import Ramp, Retention, VanGenuchten
from .inflow import Inflow
from .porous import PoreState
from .seepage import Seepage, seepage
from .seepage_face import SeepageFace
from .transient import TransientSeepage, transient_seepage

__all__ = ["Inflow", "PoreState", "PoreWater", "Ramp", "Retention", "Seepage", "SeepageFace", "TransientSeepage",
           "VanGenuchten", "seepage", "transient_seepage"]
