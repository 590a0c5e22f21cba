"""Meshes: bodies joined without welding, files of other programs, checks of meshes."""

from .check import check_mesh
from .join import bodies, join_bodies
from .read import load_mesh
from .write import save_mesh

__all__ = ["bodies", "check_mesh", "join_bodies", "load_mesh", "save_mesh"]
