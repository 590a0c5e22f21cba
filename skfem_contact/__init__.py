"""Frictional contact, soil plasticity and staged analysis for scikit-fem."""

from .analysis.davis import reduced_strength
from .analysis.initial import given_state, gravity_state, k0_state
from .analysis.limit_load import LimitLoad, limit_load
from .analysis.newton import Collapse, Newton, NotConverged
from .analysis.reset import reset_displacements
from .analysis.result import Result, StageResult, load_result
from .analysis.stages import Stage, run
from .analysis.strength import StrengthReduction, strength_reduction
from .assembly import Response, StrainOperator, axisymmetric, b_bar, plane_strain, three_dimensional
from .checks import AnalysisWarning
from .contact import (
    AugmentedLagrangian,
    ContactPair,
    ContactState,
    Surface,
    choose_penalties,
    rigid_circle,
    rigid_level_set,
    rigid_line,
    rigid_polyline,
    two_pass,
)
from .limit_analysis import Bounds, bounds
from .loads import hydrostatic, water_load, weight
from .materials import DruckerPrager, HardeningMohrCoulomb, LinearElastic, MohrCoulomb, Tresca, VonMises
from .materials.coulomb import Coulomb, Status, Tied, Traction
from .mesh import bodies, join_bodies
from .mesh_check import check_mesh
from .mesh_file import load_mesh
from .post import (
    ContactReport,
    SectionForces,
    Sections,
    Tractions,
    contact_report,
    export_vtu,
    line_sections,
    nodal_field,
    reactions,
    ring_sections,
    section_forces,
    tractions,
)
from .solid import SolidForm, SolidState
from .testing import CheckFailed, check_form, check_interface_law, check_material

__version__ = "0.1.0"

__all__ = [
    "AnalysisWarning", "AugmentedLagrangian", "Bounds", "CheckFailed", "Collapse", "ContactPair", "ContactReport",
    "ContactState", "Coulomb", "DruckerPrager", "HardeningMohrCoulomb", "LimitLoad", "LinearElastic",
    "MohrCoulomb", "Newton", "NotConverged", "Response", "Result", "SectionForces", "Sections", "SolidForm",
    "SolidState", "Stage", "StageResult", "Status", "StrainOperator", "StrengthReduction", "Surface", "Tied",
    "Traction", "Tractions", "Tresca", "VonMises", "axisymmetric", "b_bar", "bodies", "bounds",
    "check_form",
    "check_interface_law", "check_material", "check_mesh", "choose_penalties", "contact_report", "export_vtu",
    "given_state", "gravity_state", "hydrostatic", "join_bodies", "k0_state", "limit_load", "line_sections",
    "load_mesh", "load_result", "nodal_field", "plane_strain", "reactions", "reduced_strength",
    "reset_displacements", "rigid_circle", "rigid_level_set", "rigid_line", "rigid_polyline", "ring_sections",
    "run", "section_forces", "strength_reduction", "three_dimensional", "tractions", "two_pass", "water_load",
    "weight",
]
