"""Frictional contact, soil plasticity and staged analysis for scikit-fem."""

from .collapse.limit_load import limit_load
from .collapse.result import CollapseResult
from .collapse.stands import stands
from .collapse.strength import strength_reduction
from .contact import (
    AugmentedLagrangian,
    ContactPair,
    ContactState,
    Surface,
    choose_penalties,
    rigid_circle,
    rigid_cone,
    rigid_cylinder,
    rigid_level_set,
    rigid_line,
    rigid_plane,
    rigid_polyline,
    rigid_sphere,
    rigid_surface,
    two_pass,
)
from .contact.laws import Coulomb, InterfaceLaw, Status, Tied
from .errors import AnalysisWarning, Failure, NoEquilibrium, NotConverged
from .forms import Form, Response
from .limit_analysis import Bounds, bounds
from .links import Bar, BarState, MatrixForm, RigidFooting, Spring
from .loads import hydrostatic, traction, water_load, weight
from .materials import DruckerPrager, HardeningMohrCoulomb, LinearElastic, MohrCoulomb, Tresca, Undrained, VonMises
from .materials.reduction import reduced_strength
from .mesh.check import check_mesh
from .mesh.join import bodies, join_bodies
from .mesh.read import load_mesh
from .nonlinear.newton import Newton
from .post import (
    ContactReport,
    PointStatus,
    SectionForces,
    Sections,
    SpaceSectionForces,
    Tractions,
    contact_report,
    export_pvd,
    export_vtu,
    line_sections,
    nodal_field,
    pore_pressure,
    reactions,
    ring_sections,
    section_forces,
    to_frame,
    to_pyvista,
    tractions,
    undrained_strength,
)
from .solid import SolidForm, SolidState
from .stages.initial import given_state, gravity_state, k0_state
from .stages.result import Result, StageResult, load_result, reset_displacements
from .stages.run import Stage, run
from .strain import StrainOperator, axisymmetric, b_bar, plane_strain, three_dimensional
from .testing import CheckFailed, check_form, check_interface_law, check_material
from .unknowns import Field, rollers, unknowns_at
from .water import PoreWater, Ramp, Seepage, SeepageFace, VanGenuchten, seepage

__version__ = "0.1.0"

__all__ = [
    "AnalysisWarning", "AugmentedLagrangian", "Bar", "BarState", "Bounds", "CheckFailed", "CollapseResult",
    "ContactPair", "ContactReport", "ContactState", "Coulomb", "DruckerPrager", "Failure", "Field", "Form",
    "HardeningMohrCoulomb", "InterfaceLaw", "LinearElastic", "MatrixForm", "MohrCoulomb", "Newton", "NoEquilibrium",
    "NotConverged", "PointStatus", "PoreWater", "Ramp", "Response", "Result", "RigidFooting", "SectionForces",
    "Sections", "Seepage", "SeepageFace", "SolidForm", "SolidState", "SpaceSectionForces", "Spring", "Stage",
    "StageResult", "Status", "StrainOperator", "Surface", "Tied", "Tractions", "Tresca", "Undrained",
    "VanGenuchten", "VonMises", "axisymmetric", "b_bar", "bodies", "bounds", "check_form", "check_interface_law",
    "check_material", "check_mesh", "choose_penalties", "contact_report", "export_pvd", "export_vtu", "given_state",
    "gravity_state", "hydrostatic", "join_bodies", "k0_state", "limit_load", "line_sections", "load_mesh",
    "load_result", "nodal_field", "plane_strain", "pore_pressure", "reactions", "reduced_strength",
    "reset_displacements", "rigid_circle", "rigid_cone", "rigid_cylinder", "rigid_level_set", "rigid_line",
    "rigid_plane", "rigid_polyline", "rigid_sphere", "rigid_surface", "ring_sections", "rollers", "run",
    "section_forces", "seepage", "stands", "strength_reduction", "three_dimensional", "to_frame", "to_pyvista",
    "traction", "tractions", "two_pass", "undrained_strength", "unknowns_at", "water_load", "weight",
]
