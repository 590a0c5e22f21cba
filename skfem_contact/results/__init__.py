"""Results of stages: fields, tractions, section forces, tables, reports and files."""

from ..display import Table
from .cuts import Cuts, SectionForces
from .files import Append
from .modes import Buckling, Modes
from .motion import History
from .points import PointValues
from .result import Result, load_result, of
from .stage import StageResult
from .tables import Envelope
from .tractions import ContactReport, Tractions

__all__ = [
    "Append",
    "Buckling",
    "ContactReport",
    "Cuts",
    "Envelope",
    "History",
    "Modes",
    "PointValues",
    "Result",
    "SectionForces",
    "StageResult",
    "Table",
    "Tractions",
    "load_result",
    "of",
]
