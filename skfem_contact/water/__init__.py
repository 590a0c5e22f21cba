"""Water in the ground: seepage, steady or in time, and consolidation."""

from .conditions import Conditions
from .conductivity import Permeability
from .flow import Flow
from .inflow import Inflow, SeepageFace
from .pore_water import PoreWater
from .porous import PoreState
from .retention import BrooksCorey, Ramp, Retention, VanGenuchten
from .seepage import Seepage
from .transient import TransientSeepage

__all__ = [
    "BrooksCorey",
    "Conditions",
    "Flow",
    "Inflow",
    "Permeability",
    "PoreState",
    "PoreWater",
    "Ramp",
    "Retention",
    "Seepage",
    "SeepageFace",
    "TransientSeepage",
    "VanGenuchten",
]
