"""Where Newton's method starts in an increment: the last increment goes on if the loads do."""
from __future__ import annotations

import numpy as np
from numpy import ndarray

#: Changes of the load that differ by less than this share are in proportion.
_PROPORTIONAL = 1e-6


class Predictor:
    """Extrapolates from the last two accepted increments while loads and supports move on in proportion.

    Sliding contact and yielding soil then hardly change their state within an increment, and few iterations are left.

    Parameters
    ----------
    fixed
        Unknowns whose values are prescribed.

    Examples
    --------
    >>> import numpy as np
    >>> predictor = Predictor(fixed=np.array([0]))
    >>> for step in (0.0, 1.0):
    ...     predictor.accept(x=step * np.array([1.0, 0.4]), load=np.zeros(2))
    >>> predictor.start(load=np.zeros(2), prescribed=np.array([3.0]))
    array([3. , 1.2])
    >>> predictor.start(load=np.zeros(2), prescribed=np.array([0.5])) is None   # on the way back bodies stick at first
    True
    """

    def __init__(self, fixed: ndarray) -> None:
        self._fixed = fixed
        self._accepted: tuple[tuple[ndarray, ndarray], ...] = ()

    def accept(self, x: ndarray, load: ndarray) -> None:
        """Remember displacements and load of an accepted increment."""
        self._accepted = (*self._accepted[-1:], (x, load))

    def start(self, load: ndarray, prescribed: ndarray) -> ndarray | None:
        """Displacements to start from under a load, or None where the last increment does not tell."""
        if len(self._accepted) < 2:
            return None
        (x_before, load_before), (x, load_last) = self._accepted
        moved, held = x - x_before, self._fixed
        changes = ((load_last - load_before, load - load_last), (moved[held], prescribed - x[held]))
        ratios = [float(old @ new / (old @ old)) for old, new in changes if old.any()]
        if not ratios or not ratios[0] > 0.0:
            return None
        if any(np.linalg.norm(new - ratios[0] * old) > _PROPORTIONAL * np.linalg.norm(new) for old, new in changes):
            return None
        start = x + ratios[0] * moved
        start[held] = prescribed
        return start
