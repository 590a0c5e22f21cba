"""Constitutive laws: pure functions of strain increment and accepted state on arrays of points."""

from .base import Material, Update
from .elastic import LinearElastic
from .mohr_coulomb import MohrCoulomb
from .tresca import Tresca

__all__ = ["LinearElastic", "Material", "MohrCoulomb", "Tresca", "Update"]
