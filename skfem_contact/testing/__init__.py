"""Checks of own materials, interface laws and forms on random states, and of other programs.

A form or law that passes gives Newton's method the right tangent and does not change its arguments.
A violation raises :class:`CheckFailed`, an ``AssertionError``. Results of CalculiX are read with
its own conventions.
"""

from .calculix import Comparison, Frd, Printed, compare, read_dat, read_frd
from .form import check_form
from .laws import CheckFailed, check_interface_law, check_material

__all__ = [
    "CheckFailed",
    "Comparison",
    "Frd",
    "Printed",
    "check_form",
    "check_interface_law",
    "check_material",
    "compare",
    "read_dat",
    "read_frd",
]
