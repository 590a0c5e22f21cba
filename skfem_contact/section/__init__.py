"""Plane sections from a sketch: outlines, lines and sizes by name, from which Gmsh makes a mesh
with all names.
"""

from ..checks import guard
from .borehole import Borehole, borehole
from .drawing import Drawing, from_dxf
from .earthworks import embankment, layers, pit, slope
from .outline import Outline, circle, rectangle
from .section import Section
from .structures import footing, pile, retaining_wall, three_centres, trench, tunnel

__all__ = [
    "Borehole",
    "Drawing",
    "Outline",
    "Section",
    "borehole",
    "circle",
    "embankment",
    "footing",
    "from_dxf",
    "layers",
    "pile",
    "pit",
    "rectangle",
    "retaining_wall",
    "slope",
    "three_centres",
    "trench",
    "tunnel",
]

guard(__name__)
