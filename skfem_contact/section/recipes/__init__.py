"""Ready sections from a few numbers each; heights are measured from the ground, y = 0."""

from .builder import layers
from .earthworks import embankment, pit, slope
from .structures import footing, pile, retaining_wall, three_centres, trench, tunnel

__all__ = [
    "embankment",
    "footing",
    "layers",
    "pile",
    "pit",
    "retaining_wall",
    "slope",
    "three_centres",
    "trench",
    "tunnel",
]
