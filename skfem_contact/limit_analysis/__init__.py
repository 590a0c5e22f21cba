"""Certified bounds: a factor of safety or a limit load between two proven numbers (finite element limit analysis)."""
from .bounds import beside, bounds
from .result import Bounds

__all__ = ["Bounds", "beside", "bounds"]
