"""Analyses in time: inertia, damping, records of earthquakes and natural frequencies."""

from .record import Record
from .settings import Dynamic, Rayleigh
from .spectrum import Spectrum

__all__ = ["Dynamic", "Rayleigh", "Record", "Spectrum"]
