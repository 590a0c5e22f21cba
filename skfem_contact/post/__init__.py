"""What a result says: contact tractions, section forces, reactions, reports, fields and files."""
from .fields import nodal_field
from .files import export_pvd, export_vtu, to_frame, to_pyvista
from .reactions import reactions
from .report import ContactReport, contact_report
from .sections import SectionForces, Sections, line_sections, ring_sections, section_forces
from .strength import PointStatus
from .tractions import Tractions, tractions

__all__ = [
    "ContactReport", "PointStatus", "SectionForces", "Sections", "Tractions", "contact_report", "export_pvd",
    "export_vtu", "line_sections", "nodal_field", "reactions", "ring_sections", "section_forces", "to_frame",
    "to_pyvista", "tractions",
]
