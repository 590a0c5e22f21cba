"""Checks of own materials, interface laws and forms on random states.

A form or law that passes gives Newton's method the right tangent and does not change its arguments.
A violation raises :class:`CheckFailed`, an ``AssertionError``.
"""

from .form import check_form
from .laws import CheckFailed, check_interface_law, check_material

__all__ = ["CheckFailed", "check_form", "check_interface_law", "check_material"]
