"""What a result says: contact tractions, section forces, reactions, reports, fields and files."""
from .fields import nodal_field
from .files import export_pvd, export_vtu, to_frame, to_pyvista
from .report import ContactReport, contact_report, reactions
from .resultants import SectionForces, SpaceSectionForces
from .sections import Sections, line_sections, ring_sections, section_forces
from .strength import PointStatus, pore_pressure, undrained_strength
from .tractions import Tractions, tractions

__all__ = [
    "ContactReport", "PointStatus", "SectionForces", "Sections", "SpaceSectionForces", "Tractions", "contact_report",
    "export_pvd", "export_vtu", "line_sections", "nodal_field", "pore_pressure", "reactions", "ring_sections",
    "section_forces", "to_frame", "to_pyvista", "tractions", "undrained_strength",
]
