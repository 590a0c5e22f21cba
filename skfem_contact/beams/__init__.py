"""Beams: walls, linings and frames, with plastic hinges, alone or in contact with the ground."""
from .beam import Beam

__all__ = ["Beam"]
