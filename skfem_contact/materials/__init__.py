"""Constitutive laws: pure functions of strain increment and accepted state on arrays of points."""

from .base import Material, Update
from .drucker_prager import DruckerPrager
from .elastic import LinearElastic
from .hardening import HardeningMohrCoulomb
from .mohr_coulomb import MohrCoulomb
from .tresca import Tresca
from .undrained import Undrained
from .von_mises import VonMises

__all__ = [
    "DruckerPrager",
    "HardeningMohrCoulomb",
    "LinearElastic",
    "Material",
    "MohrCoulomb",
    "Tresca",
    "Undrained",
    "Update",
    "VonMises",
]
