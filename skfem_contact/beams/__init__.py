"""Beams as walls, linings and frames, with plastic hinges or in contact; reinforcement."""

from .beam import Beam
from .embedded import Embedded
from .lines import split_along
from .reinforcement import Reinforcement

__all__ = ["Beam", "Embedded", "Reinforcement", "split_along"]
