"""Frictional contact, soil plasticity and staged analysis for scikit-fem."""

from .collapse.flow import reduced_strength
from .collapse.limit_load import LimitLoad, limit_load
from .collapse.strength import StrengthReduction, strength_reduction
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
from .errors import AnalysisWarning
from .forms import Response
from .loads import hydrostatic, water_load, weight
from .materials import DruckerPrager, HardeningMohrCoulomb, LinearElastic, MohrCoulomb, Tresca, VonMises
from .mesh.check import check_mesh
from .mesh.join import bodies, join_bodies
from .mesh.read import load_mesh
from .nonlinear.evaluation import NoEquilibrium, NotConverged
from .nonlinear.newton import Newton
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
from .stages.initial import given_state, gravity_state, k0_state
from .stages.reset import reset_displacements
from .stages.result import Result, StageResult, load_result
from .stages.run import run
from .stages.stage import Stage
from .strain import StrainOperator, axisymmetric, b_bar, plane_strain, three_dimensional
from .testing import CheckFailed, check_form, check_interface_law, check_material

__version__ = "0.1.0"

__all__ = [
    "AnalysisWarning",
    "AugmentedLagrangian",
    "CheckFailed",
    "ContactPair",
    "ContactReport",
    "ContactState",
    "Coulomb",
    "DruckerPrager",
    "HardeningMohrCoulomb",
    "InterfaceLaw",
    "LimitLoad",
    "LinearElastic",
    "MohrCoulomb",
    "Newton",
    "NoEquilibrium",
    "NotConverged",
    "Response",
    "Result",
    "SectionForces",
    "Sections",
    "SolidForm",
    "SolidState",
    "Stage",
    "StageResult",
    "Status",
    "StrainOperator",
    "StrengthReduction",
    "Surface",
    "Tied",
    "Tractions",
    "Tresca",
    "VonMises",
    "axisymmetric",
    "b_bar",
    "bodies",
    "check_form",
    "check_interface_law",
    "check_material",
    "check_mesh",
    "choose_penalties",
    "contact_report",
    "export_vtu",
    "given_state",
    "gravity_state",
    "hydrostatic",
    "join_bodies",
    "k0_state",
    "limit_load",
    "line_sections",
    "load_mesh",
    "load_result",
    "nodal_field",
    "plane_strain",
    "reactions",
    "reduced_strength",
    "reset_displacements",
    "rigid_circle",
    "rigid_cone",
    "rigid_cylinder",
    "rigid_level_set",
    "rigid_line",
    "rigid_plane",
    "rigid_polyline",
    "rigid_sphere",
    "rigid_surface",
    "ring_sections",
    "run",
    "section_forces",
    "strength_reduction",
    "three_dimensional",
    "tractions",
    "two_pass",
    "water_load",
    "weight",
]
