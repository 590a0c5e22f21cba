"""Frictional contact, soil plasticity and staged analysis for scikit-fem."""

from .analysis.newton import Newton, NotConverged
from .analysis.result import Result, StageResult, load_result
from .analysis.stages import AnalysisWarning, Stage, run
from .assembly import Response, StrainOperator, b_bar, plane_strain
from .contact import ContactPair, ContactState, Surface, choose_penalties
from .loads import weight
from .materials import LinearElastic, MohrCoulomb
from .materials.coulomb import Coulomb, Status, Traction
from .mesh import bodies, join_bodies
from .mesh_check import check_mesh
from .solid import SolidForm, SolidState

__version__ = "0.1.0"

__all__ = [
    "AnalysisWarning", "ContactPair", "ContactState", "Coulomb", "LinearElastic", "MohrCoulomb", "Newton",
    "NotConverged", "Response", "Result", "SolidForm", "SolidState", "Stage", "StageResult", "Status",
    "StrainOperator", "Surface", "Traction", "b_bar", "bodies", "check_mesh", "choose_penalties", "join_bodies",
    "load_result", "plane_strain", "run", "weight",
]
