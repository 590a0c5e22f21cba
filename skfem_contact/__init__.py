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
from .forms.base import Form, Response
from .forms.links import Bar, BarState, MatrixForm, RigidBoundary, Spring
from .forms.solid import SolidForm, SolidState
from .forms.strain import StrainOperator, axisymmetric, b_bar, plane_strain, three_dimensional
from .layout import Field, box_supports, dofs_at
from .limit_analysis import Bounds, bounds
from .loads import hydrostatic, traction, water_load, weight
from .materials import DruckerPrager, HardeningMohrCoulomb, LinearElastic, MohrCoulomb, Tresca, Undrained, VonMises
from .materials.reduction import reduced_strength
from .mesh.check import check_mesh
from .mesh.join import bodies, join_bodies
from .mesh.read import load_mesh
from .nonlinear.newton import Newton
from .results import Sections, load_result
from .stages.initial import given_state, gravity_state, k0_state
from .stages.run import Stage, run
from .testing import CheckFailed, check_form, check_interface_law, check_material
from .water import PoreWater, Ramp, Seepage, SeepageFace, VanGenuchten, seepage

__version__ = "0.1.0"

__all__ = [
    "AnalysisWarning",
    "AugmentedLagrangian",
    "Bar",
    "BarState",
    "Bounds",
    "CheckFailed",
    "CollapseResult",
    "ContactPair",
    "ContactState",
    "Coulomb",
    "DruckerPrager",
    "Failure",
    "Field",
    "Form",
    "HardeningMohrCoulomb",
    "InterfaceLaw",
    "LinearElastic",
    "MatrixForm",
    "MohrCoulomb",
    "Newton",
    "NoEquilibrium",
    "NotConverged",
    "PoreWater",
    "Ramp",
    "Response",
    "RigidBoundary",
    "Sections",
    "Seepage",
    "SeepageFace",
    "SolidForm",
    "SolidState",
    "Spring",
    "Stage",
    "Status",
    "StrainOperator",
    "Surface",
    "Tied",
    "Tresca",
    "Undrained",
    "VanGenuchten",
    "VonMises",
    "axisymmetric",
    "b_bar",
    "bodies",
    "bounds",
    "box_supports",
    "check_form",
    "check_interface_law",
    "check_material",
    "check_mesh",
    "choose_penalties",
    "dofs_at",
    "given_state",
    "gravity_state",
    "hydrostatic",
    "join_bodies",
    "k0_state",
    "limit_load",
    "load_mesh",
    "load_result",
    "plane_strain",
    "reduced_strength",
    "rigid_circle",
    "rigid_cone",
    "rigid_cylinder",
    "rigid_level_set",
    "rigid_line",
    "rigid_plane",
    "rigid_polyline",
    "rigid_sphere",
    "rigid_surface",
    "run",
    "seepage",
    "stands",
    "strength_reduction",
    "three_dimensional",
    "traction",
    "two_pass",
    "water_load",
    "weight",
]
