"""Meshes: bodies joined without welding, Gmsh files with their tags, checks of meshes."""

from .check import check_mesh
from .join import bodies, join_bodies
from .read import load_mesh

__all__ = ["bodies", "check_mesh", "join_bodies", "load_mesh"]
