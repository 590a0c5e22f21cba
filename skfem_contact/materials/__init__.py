"""Constitutive laws: pure functions of strain increment and accepted state on arrays of points."""

from .base import Material, Update
from .drucker_prager import DruckerPrager
from .elastic import LinearElastic
from .mohr_coulomb import MohrCoulomb
from .tresca import Tresca
from .von_mises import VonMises

__all__ = ["DruckerPrager", "LinearElastic", "Material", "MohrCoulomb", "Tresca", "Update", "VonMises"]
