"""Results of stages and all that follows from them: fields, tractions, section forces, reports, files."""
from .files import Append
from .result import Result, StageResult, load_result, of
from .sections import Envelope, SectionForces, Sections
from .tractions import ContactReport, Tractions

__all__ = ["Append", "ContactReport", "Envelope", "Result", "SectionForces", "Sections", "StageResult", "Tractions",
           "load_result", "of"]
