"""Contact between bodies: closest points, kinematics, interface laws and the contact pair."""

from ..surfaces.surface import Surface
from .augmented import AugmentedLagrangian
from .dual import DualMultipliers
from .interface import ContactState
from .laws import InterfaceLaw, LawUpdate
from .pair import ContactPair
from .penalty import Penalty, choose_penalties

__all__ = [
    "AugmentedLagrangian",
    "ContactPair",
    "ContactState",
    "DualMultipliers",
    "InterfaceLaw",
    "LawUpdate",
    "Penalty",
    "Surface",
    "choose_penalties",
]
