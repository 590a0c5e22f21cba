"""Water in the ground: seepage, steady or in time, confined or with a free surface, and
consolidation.
"""

from .compacting import CompactingPoreWater
from .consolidation import PoreWater
from .inflow import Inflow
from .porous import PoreState
from .retention import BrooksCorey, Ramp, Retention, VanGenuchten
from .seepage import Seepage, seepage
from .seepage_face import SeepageFace
from .transient import TransientSeepage, transient_seepage
from .unsaturated import UnsaturatedPoreWater

__all__ = [
    "BrooksCorey",
    "CompactingPoreWater",
    "Inflow",
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
