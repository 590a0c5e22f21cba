"""Ground data: boreholes and cone penetration tests to layers, parameters and sections."""

from ..checks import guard
from .columns import Column, section
from .correlations import CORRELATIONS, Profile
from .files import Site, read_ags, read_cpt
from .sounding import SOILS, Sounding

__all__ = [
    "CORRELATIONS",
    "SOILS",
    "Column",
    "Profile",
    "Site",
    "Sounding",
    "read_ags",
    "read_cpt",
    "section",
]

guard(__name__)
