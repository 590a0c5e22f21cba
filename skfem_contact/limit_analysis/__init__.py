"""Certified bounds of factors of safety and limit loads: finite element limit analysis."""

from .bounds import at_hand, beside, bounds
from .result import Bounds

__all__ = ["Bounds", "at_hand", "beside", "bounds"]
