"""Plane sections from a sketch: outlines, lines and sizes by name, from which Gmsh makes a mesh with all names."""
from ..checks import guard
from .outline import Outline, circle, rectangle
from .section import Section

__all__ = ["Outline", "Section", "circle", "rectangle"]

guard(__name__)
