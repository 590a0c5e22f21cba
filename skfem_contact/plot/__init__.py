"""Pictures of results: contours by pyvista, diagrams by matplotlib.

Import it by itself, ``import skfem_contact.plot as plot``: the solver needs no graphics library.
Functions take a stage and a quantity, return the picture and write it to ``file`` if one is given.
"""

from ..checks import guard
from ..units import labelled
from ..units import set_units as set_units
from .contour import animate, contour, cutaway, stages
from .diagram import diagram, history
from .flow import flow_diagram
from .live import live
from .mechanism import load_curve, mechanism
from .model import model
from .motion import motion
from .points import values
from .report import report
from .shells import shells
from .sketch import sketch
from .soundings import soundings

__all__ = [
    "animate",
    "contour",
    "cutaway",
    "diagram",
    "flow_diagram",
    "history",
    "labelled",
    "live",
    "load_curve",
    "mechanism",
    "model",
    "motion",
    "report",
    "shells",
    "sketch",
    "soundings",
    "stages",
    "values",
]

guard(__name__)
