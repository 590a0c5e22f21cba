"""Frictional contact, soil plasticity and staged analysis for scikit-fem."""

from . import design, ground, laboratory, mesh, results, section, testing, water
from .beams import (
    Beam,
    Embedded,
    MomentCurvature,
    PileSprings,
    Reinforcement,
    RotationSpring,
    curves,
    moment_curvature,
    split_along,
)
from .checks import guard
from .contact import AugmentedLagrangian, ContactPair, DualMultipliers, Surface
from .contact.laws import Coulomb, InterfaceLaw, Tied
from .dynamics import Bedrock, Dynamic, FreeField, Rayleigh, Record, Spectrum, ViscousBoundary
from .errors import AnalysisWarning, NoEquilibrium, NotConverged, warn
from .forms import roles
from .forms.base import Form, Outputs, Response
from .forms.links import Bar, MatrixForm, Spring
from .forms.pressure import Pressure
from .forms.rigid_boundary import RigidBoundary
from .forms.solid import SolidForm
from .laboratory import element_test
from .layout import Field, box_supports, dofs_at
from .loads import hydrostatic, traction, water_load, weight
from .materials import (
    CamClay,
    DruckerPrager,
    HardeningMohrCoulomb,
    HardeningSoil,
    HoekBrown,
    Internal,
    JointedRock,
    LinearElastic,
    Material,
    MohrCoulomb,
    NeoHooke,
    NgiAdp,
    SoftSoilCreep,
    Tresca,
    Undrained,
    VonMises,
)
from .materials.jointed_rock import Joint
from .mesh import join_bodies, load_mesh, save_mesh
from .model import Model
from .nonlinear.newton import Newton
from .results import Cuts, load_result
from .shells import Shell
from .solvers.petsc import Petsc
from .stages.new_meshes import Remeshing
from .stages.remeshing import remeshed
from .stages.stage import Stage
from .surfaces import rigid
from .units import set_units
from .versions import show_versions
from .water import PoreWater

__version__ = "0.3.0"

__all__ = [
    "AnalysisWarning",
    "AugmentedLagrangian",
    "Bar",
    "Beam",
    "Bedrock",
    "CamClay",
    "ContactPair",
    "Coulomb",
    "Cuts",
    "DruckerPrager",
    "DualMultipliers",
    "Dynamic",
    "Embedded",
    "Field",
    "Form",
    "FreeField",
    "HardeningMohrCoulomb",
    "HardeningSoil",
    "HoekBrown",
    "InterfaceLaw",
    "Internal",
    "Joint",
    "JointedRock",
    "LinearElastic",
    "Material",
    "MatrixForm",
    "Model",
    "MohrCoulomb",
    "MomentCurvature",
    "NeoHooke",
    "Newton",
    "NgiAdp",
    "NoEquilibrium",
    "NotConverged",
    "Outputs",
    "Petsc",
    "PileSprings",
    "PoreWater",
    "Pressure",
    "Rayleigh",
    "Record",
    "Reinforcement",
    "Remeshing",
    "Response",
    "RigidBoundary",
    "RotationSpring",
    "Shell",
    "SoftSoilCreep",
    "SolidForm",
    "Spectrum",
    "Spring",
    "Stage",
    "Surface",
    "Tied",
    "Tresca",
    "Undrained",
    "ViscousBoundary",
    "VonMises",
    "box_supports",
    "curves",
    "design",
    "dofs_at",
    "element_test",
    "ground",
    "hydrostatic",
    "join_bodies",
    "load_mesh",
    "load_result",
    "mesh",
    "moment_curvature",
    "remeshed",
    "results",
    "rigid",
    "roles",
    "save_mesh",
    "section",
    "set_units",
    "show_versions",
    "split_along",
    "testing",
    "traction",
    "water",
    "water_load",
    "weight",
]

#: Names of former versions, which warn, and their successors.
_FORMER = {"Rock": "Bedrock", "Sections": "Cuts"}


def __getattr__(name: str) -> object:
    """Return the successor of a former name."""
    if name not in _FORMER:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    warn(f"sc.{name} is deprecated: use sc.{_FORMER[name]}", DeprecationWarning)
    return globals()[_FORMER[name]]


guard(
    __name__,
    curves.__name__,
    design.__name__,
    ground.__name__,
    laboratory.__name__,
    mesh.__name__,
    results.__name__,
    rigid.__name__,
    section.__name__,
    testing.__name__,
    water.__name__,
)
