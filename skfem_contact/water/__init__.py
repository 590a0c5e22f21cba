"""Water in the ground: seepage, steady or in time, and consolidation."""

from .conductivity import Permeability
from .deprecated import CompactingPoreWater, UnsaturatedPoreWater
from .inflow import Inflow
from .pore_water import PoreWater
from .porous import PoreState
from .retention import BrooksCorey, Ramp, Retention, VanGenuchten
from .seepage import Seepage, seepage
from .seepage_face import SeepageFace
from .transient import TransientSeepage, transient_seepage

__all__ = [
    "BrooksCorey",
    "CompactingPoreWater",
    "Inflow",
    "Permeability",
    "PoreState",
    "PoreWater",
    "Ramp",
    "Retention",
    "Seepage",
    "SeepageFace",
    "TransientSeepage",
    "UnsaturatedPoreWater",
    "VanGenuchten",
    "seepage",
    "transient_seepage",
]
