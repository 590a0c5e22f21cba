"""Pictures of results: contours by pyvista, diagrams by matplotlib.

Import it by itself, ``import skfem_contact.plot as plot``: the solver needs no graphics library.  Every
function returns what it has drawn and writes it to ``file`` if one is given.
"""
from .contours import contour
from .diagrams import contact_diagram, ring_diagram, section_diagram
from .water import flow_diagram

__all__ = ["contact_diagram", "contour", "flow_diagram", "ring_diagram", "section_diagram"]
