"""Pictures of results: contours by pyvista, diagrams by matplotlib.

Import it by itself, ``import skfem_contact.plot as plot``: the solver needs no graphics library.  Every
function takes forms, stage and quantity in this order, returns what it has drawn and writes it to ``file`` if one is
given.
"""
from .contours import animate, contour, stages
from .cutaway import cutaway
from .diagrams import contact_diagram, history, load_curve, ring_diagram, section_diagram
from .mechanism import mechanism
from .structures import diagram_on
from .units import labelled, set_units
from .water import flow_diagram

__all__ = ["animate", "contact_diagram", "contour", "cutaway", "diagram_on", "flow_diagram", "history", "labelled",
           "load_curve", "mechanism", "ring_diagram", "section_diagram", "set_units", "stages"]
