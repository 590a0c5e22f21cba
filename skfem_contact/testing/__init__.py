"""Checks of own materials, interface laws and forms: what an analysis relies on, tried on random states.

A law that passes gives Newton's method the right tangent and changes nothing behind its back.  The checks raise
:class:`CheckFailed`, an ``AssertionError``, that says what is violated and where.
"""
from .form import check_form
from .interface_law import check_interface_law
from .material import check_material
from .tools import CheckFailed

__all__ = ["CheckFailed", "check_form", "check_interface_law", "check_material"]
