"""Contact between bodies: closest points, kinematics, interface laws and the contact pair."""

from ..surfaces.surface import Surface
from .interface import ContactState
from .laws import InterfaceLaw, LawUpdate
from .pair import ContactPair
from .penalty import AugmentedLagrangian, DualMultipliers, choose_penalties

__all__ = [
    "AugmentedLagrangian",
    "ContactPair",
    "ContactState",
    "DualMultipliers",
    "InterfaceLaw",
    "LawUpdate",
    "Surface",
    "choose_penalties",
]
