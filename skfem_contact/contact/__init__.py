"""Contact between bodies: surfaces, closest point projection, kinematics, and the pair form."""
from .pair import ContactPair, ContactState
from .penalty import choose_penalties
from .surface import Surface

__all__ = ["ContactPair", "ContactState", "Surface", "choose_penalties"]
