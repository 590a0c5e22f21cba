"""Constitutive laws: pure functions of strain increment and accepted state on arrays of points."""

from .base import Internal, Material, Update
from .cam_clay import CamClay
from .drucker_prager import DruckerPrager, VonMises
from .elastic import LinearElastic
from .hardening import HardeningMohrCoulomb
from .hardening_soil import HardeningSoil
from .hoek_brown import HoekBrown
from .jointed_rock import JointedRock
from .mohr_coulomb import MohrCoulomb, Tresca
from .neo_hooke import NeoHooke
from .ngi_adp import NgiAdp
from .soft_soil_creep import SoftSoilCreep
from .undrained import Undrained

__all__ = [
    "CamClay",
    "DruckerPrager",
    "HardeningMohrCoulomb",
    "HardeningSoil",
    "HoekBrown",
    "Internal",
    "JointedRock",
    "LinearElastic",
    "Material",
    "MohrCoulomb",
    "NeoHooke",
    "NgiAdp",
    "SoftSoilCreep",
    "Tresca",
    "Undrained",
    "Update",
    "VonMises",
]
