"""Plates and shells in space: rafts, slabs, tanks and walls."""

from .shell import Shell

__all__ = ["Shell"]
