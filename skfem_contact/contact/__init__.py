"""Contact between bodies: surfaces, closest point projection, kinematics, and the pair form."""
from ..surfaces.rigid import rigid_circle, rigid_level_set, rigid_line, rigid_polyline
from ..surfaces.rigid_space import rigid_cone, rigid_cylinder, rigid_plane, rigid_sphere, rigid_surface
from ..surfaces.surface import Surface
from .augmented import AugmentedLagrangian
from .laws import InterfaceLaw, Update
from .pair import ContactPair, two_pass
from .penalty import choose_penalties
from .state import ContactState

__all__ = ["AugmentedLagrangian", "ContactPair", "ContactState", "InterfaceLaw", "Surface", "Update",
           "choose_penalties", "rigid_circle", "rigid_cone", "rigid_cylinder", "rigid_level_set", "rigid_line",
           "rigid_plane", "rigid_polyline", "rigid_sphere", "rigid_surface", "two_pass"]
