"""Plane sections from a sketch of outlines and lines, which Gmsh meshes with all names."""

from ..checks import guard
from .borehole import Borehole, borehole
from .drawing import Drawing, from_dxf
from .outline import Outline, circle, rectangle
from .recipes import (
    embankment,
    footing,
    layers,
    pile,
    pit,
    retaining_wall,
    slope,
    three_centres,
    trench,
    tunnel,
)
from .section import Section

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
