"""Response spectra, exact for accelerations that are linear between their values."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import ndarray

from ..arrays import max_abs
from ..checks import is_number
from ..display import Table


@dataclass(frozen=True)
class Spectrum:
    """Largest responses of oscillators to a motion of their base.

    Attributes
    ----------
    periods : ndarray, shape (n,)
        Natural periods.
    displacement : ndarray, shape (n,)
        Largest displacements relative to the base.
    ratio
        Damping ratio.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> time = np.arange(0., 40., .01)
    >>> record = sc.Record(.01, np.sin(2 * np.pi * time))
    >>> record.spectrum([1.], ratio=.05).acceleration.round(2)         # 1 / (2 z) at resonance
    array([9.99])
    """

    periods: ndarray
    displacement: ndarray
    ratio: float

    @property
    def velocity(self) -> ndarray:
        """Pseudo-velocities, (n,): displacements times the angular frequency."""
        return 2.0 * np.pi / self.periods * self.displacement

    @property
    def acceleration(self) -> ndarray:
        """Pseudo-accelerations, (n,): displacements times its square."""
        return (2.0 * np.pi / self.periods) ** 2 * self.displacement

    def table(self) -> Table:
        """Return the spectrum as a table."""
        columns = {
            "period": self.periods,
            "displacement": self.displacement,
            "velocity": self.velocity,
            "acceleration": self.acceleration,
        }
        return Table.of(columns, f"response spectrum, damping {self.ratio:.3g}")


def response_spectrum(step: float, values: ndarray, periods: ndarray, ratio: float) -> Spectrum:
    """Return the spectrum of accelerations at equal steps.

    Linear pieces are integrated exactly (N. C. Nigam and P. C. Jennings 1969, Bull. Seism. Soc. Am.
    59, 909).

    Raises
    ------
    ValueError
        Periods that are not positive, or a damping ratio outside of 0 to 1.
    """
    from scipy.signal import cont2discrete, lfilter, ss2tf

    periods = np.atleast_1d(periods)
    if periods.ndim != 1:
        raise ValueError(f"periods have the shape (n,), not {periods.shape}")
    if not (periods > 0.0).all():
        raise ValueError(f"periods must be positive, not {periods.min():g}")
    if ratio != 0.0 and not is_number(ratio, 0.0, 1.0):
        raise ValueError(f"the damping ratio must be between 0 and 1, not {ratio!r}")
    found = []
    for period in periods:
        # x'' + 2 z w x' + w^2 x = -a, by the response to linear pieces
        w = 2.0 * np.pi / period
        A = np.array(
            [
                [0.0, 1.0],
                [-(w**2), -2.0 * ratio * w],
            ]
        )
        system = (A, np.array([[0.0], [-1.0]]), np.array([[1.0, 0.0]]), np.zeros((1, 1)))
        Ad, Bd, Cd, Dd, _ = cont2discrete(system, step, "foh")
        b, a = ss2tf(Ad, Bd, Cd, Dd)
        found.append(max_abs(lfilter(b[0], a, values)))
    return Spectrum(periods, np.array(found), float(ratio))
