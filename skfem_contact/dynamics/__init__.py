"""Analyses in time: inertia, damping, records of earthquakes and natural frequencies."""

from .boundaries import Rock, ViscousBoundary
from .free_field import FreeField
from .record import Record
from .settings import Dynamic, Rayleigh
from .spectrum import Spectrum

__all__ = ["Dynamic", "FreeField", "Rayleigh", "Record", "Rock", "Spectrum", "ViscousBoundary"]
