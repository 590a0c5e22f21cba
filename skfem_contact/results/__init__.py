"""Results of stages and all that follows from them: fields, tractions, section forces, reports, files."""
from .files import Append
from .result import Result, StageResult, load_result, of
from .sections import SectionForces, Sections
from .tractions import ContactReport, Tractions

__all__ = ["Append", "ContactReport", "Result", "SectionForces", "Sections", "StageResult", "Tractions", "load_result",
           "of"]
