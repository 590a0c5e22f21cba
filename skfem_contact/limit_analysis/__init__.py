"""Certified bounds: a factor of safety or a limit load between two proven numbers (finite element
limit analysis).
"""

from .bounds import at_hand, beside, bounds
from .result import Bounds

__all__ = ["Bounds", "at_hand", "beside", "bounds"]
