"""Results of stages and all that follows from them: fields, tractions, section forces, reports,
files.
"""

from ..display import Table
from .cuts import SectionForces, Sections
from .files import Append
from .result import Result, load_result, of
from .stage import StageResult
from .tables import Envelope
from .tractions import ContactReport, Tractions

__all__ = [
    "Append",
    "ContactReport",
    "Envelope",
    "Result",
    "SectionForces",
    "Sections",
    "StageResult",
    "Table",
    "Tractions",
    "load_result",
    "of",
]
