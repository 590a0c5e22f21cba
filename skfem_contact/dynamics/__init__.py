"""Analyses in time: inertia, damping, records of earthquakes and natural frequencies."""

from .boundaries import Bedrock, ViscousBoundary
from .free_field import FreeField
from .record import Record
from .settings import Dynamic, Rayleigh
from .spectrum import Spectrum

__all__ = ["Bedrock", "Dynamic", "FreeField", "Rayleigh", "Record", "Spectrum", "ViscousBoundary"]
