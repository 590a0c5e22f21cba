"""What helps where Newton's method fails on contact: families of easier forms that end at the form as given."""
from .chatter import Debonding, FacetLock, SoftStick
from .start import Interference, Stabilisation

#: In the order in which they are tried.
FAMILIES = (Interference, Stabilisation, FacetLock, SoftStick, Debonding)
