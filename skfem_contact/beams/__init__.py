"""Beams as walls, linings and frames, with plastic hinges or in contact; reinforcement."""

from .beam import Beam
from .embedded import Embedded
from .lines import split_along
from .reinforcement import Reinforcement
from .rotation import RotationSpring
from .sections import MomentCurvature, moment_curvature
from .springs import PileSprings

__all__ = [
    "Beam",
    "Embedded",
    "MomentCurvature",
    "PileSprings",
    "Reinforcement",
    "RotationSpring",
    "moment_curvature",
    "split_along",
]
