"""How much less permeable ground is where its pores hold air: functions of the pressure head."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy import ndarray

from ..errors import is_number

#: The slope of van Genuchten's curve is that of this relative suction where there is less.
_STEEPEST = 1e-9


class Retention(Protocol):
    """Permeability of partly saturated ground, relative to that of saturated ground."""

    def relative(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        """Relative permeability and its slope.

        Parameters
        ----------
        suction
            Elevation less head, a length: positive above the water table.
        size
            Heights of the elements that the points lie in, broadcast against `suction`.
        """

    def softer(self, factor: float) -> Retention:
        """The same law with a transition that is so many times as wide: Newton's method begins with it."""


@dataclass(frozen=True)
class Ramp:
    r"""A free surface: ground is saturated below it and nearly impermeable above it.

    The relative permeability goes from 1 to `least` as the cubic :math:`3s^2 - 2s^3` over a suction head of `width`
    heights of the element. This transition is centred on zero pressure: what flows above the free surface makes up for
    what is missing below it, and the discharge is not biased by the width.

    Parameters
    ----------
    width
        Of the transition, in heights of the element in which it lies.
    least
        Relative permeability of dry ground.

    Raises
    ------
    ValueError
        A width that is not positive, or a `least` outside of (0, 1).

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> sc.water.Ramp(width=1., least=.1).relative(np.array([-.5, 0., .5]), np.ones(3))[0]
    array([1.  , 0.55, 0.1 ])
    """

    width: float = 0.5
    least: float = 1e-3

    def __post_init__(self) -> None:
        if not is_number(self.width, 0.0, np.inf):
            raise ValueError(f"width must be positive, not {self.width!r}")
        if not is_number(self.least, 0.0, 1.0):
            raise ValueError(f"least must lie between 0 and 1, not {self.least!r}")

    def relative(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        """Relative permeability and its slope, see :class:`Retention`."""
        width = self.width * size
        s = np.clip(0.5 - suction / width, 0.0, 1.0)
        change = 1.0 - self.least
        return self.least + change * s * s * (3.0 - 2.0 * s), -change * 6.0 * s * (1.0 - s) / width

    def softer(self, factor: float) -> Ramp:
        """A wider ramp."""
        return replace(self, width=self.width * factor)


@dataclass(frozen=True)
class VanGenuchten:
    r"""Flow above the water table too, by Mualem's model with van Genuchten's curve.

    With the suction head :math:`s`, :math:`m = 1 - 1/n` and the effective saturation
    :math:`S = (1 + (\alpha s)^n)^{-m}` the relative permeability is :math:`\sqrt S\,(1 - (1 - S^{1/m})^m)^2`
    (M. Th. van Genuchten, Soil Sci. Soc. Am. J. 44 (1980) 892-898, eqs. 3, 8 and 9).

    Parameters
    ----------
    alpha
        One over a length: about the inverse of the height to which the pores suck water.
    n
        More than 1: large for pores of one size.
    least
        Relative permeability that is not fallen short of.

    Raises
    ------
    ValueError
        Parameters out of their ranges.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> sand = sc.water.VanGenuchten(alpha=2., n=3.)
    >>> sand.relative(np.array([-1., 0., .5]), np.ones(3))[0].round(4)
    array([1.    , 1.    , 0.1087])
    """

    alpha: float
    n: float
    least: float = 1e-6

    def __post_init__(self) -> None:
        if not is_number(self.alpha, 0.0, np.inf):
            raise ValueError(f"alpha must be positive, not {self.alpha!r}")
        if not is_number(self.n, 1.0, np.inf):
            raise ValueError(f"n must be more than 1, not {self.n!r}")
        if not is_number(self.least, 0.0, 1.0):
            raise ValueError(f"least must lie between 0 and 1, not {self.least!r}")

    def relative(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        """Relative permeability and its slope, see :class:`Retention`."""
        m = 1.0 - 1.0 / self.n
        s = np.maximum(self.alpha * suction, np.finfo(float).tiny)
        x = s**self.n
        filled = (1.0 + x) ** (-0.5 * m)  # square root of the saturation
        rest = 1.0 - (x / (1.0 + x)) ** m
        k = filled * rest**2
        # slope of (x / (1 + x))^m: infinite at s = 0 for n < 2
        steep = (self.n - 1.0) * np.maximum(s, _STEEPEST) ** (self.n - 2.0) * (1.0 + x) ** (-m - 1.0)
        slope = -filled * rest * (0.5 * m * self.n * rest * x / s / (1.0 + x) + 2.0 * steep)
        changing = (suction > 0.0) & (k > self.least)
        return np.where(suction > 0.0, np.maximum(k, self.least), 1.0), np.where(changing, self.alpha * slope, 0.0)

    def softer(self, factor: float) -> VanGenuchten:
        """Ground that sucks higher."""
        return replace(self, alpha=self.alpha / factor)
