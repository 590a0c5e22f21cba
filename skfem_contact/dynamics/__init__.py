"""Analyses in time: inertia, damping, records of earthquakes and natural frequencies."""

from .settings import Dynamic, Rayleigh

__all__ = ["Dynamic", "Rayleigh"]
