"""Beams: walls, linings and frames, with plastic hinges, alone or in contact with the ground."""
from .beam import Beam
from .embedded import Embedded
from .lines import split_along

__all__ = ["Beam", "Embedded", "split_along"]
