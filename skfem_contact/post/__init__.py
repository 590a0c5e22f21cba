"""What a result says: contact tractions, section forces, reactions, reports, fields and files."""
from .fields import nodal_field
from .files import export_vtu
from .reactions import reactions
from .report import ContactReport, contact_report
from .sections import SectionForces, Sections, line_sections, ring_sections, section_forces
from .tractions import Tractions, tractions
from .undrained import pore_pressure, undrained_strength

__all__ = [
    "ContactReport", "SectionForces", "Sections", "Tractions", "contact_report", "export_vtu",
    "line_sections", "nodal_field", "pore_pressure", "reactions", "ring_sections", "section_forces", "tractions",
    "undrained_strength",
]
