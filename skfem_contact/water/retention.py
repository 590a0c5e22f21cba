"""Retention of water by partly saturated ground: its permeability and its content by suction."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy import ndarray
from typing_extensions import override

from ..checks import number, positive, vector

#: A change of suction leaves so much of the saturation at least.
_DRIER = 0.1
#: Relative permeability of ground that has lost all its water.
_NONE = 1e-300
#: Part of its steepest slope from which a ramp is never flat.
_FLATTEST = 0.99
#: Van Genuchten's curve has the slope of this relative suction at smaller ones.
_STEEPEST = 1e-9


class Retention(Protocol):
    """Relative permeability and water of partly saturated ground."""

    content: tuple[float, float] | None

    def relative(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        """Return the relative permeability and its slope over the suction.

        The suction is a length: elevation less head. The size is the height of the elements in
        which the points lie, broadcast against the suction.
        """

    def softer(self, factor: float) -> Retention:
        """Return the law with a wider transition, with which Newton's method begins."""

    def saturation(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        """Return the effective saturation, from 0 to 1, and its slope over the suction."""

    def moved(self, suction: ndarray, change: ndarray, size: ndarray, flat: ndarray) -> ndarray:
        """Return the suction after a change by Newton's method.

        The change is made in the saturation where its slope is not `flat`. From that slope of the
        saturation on, ground stores more water than flows off by a change of suction (K. Brenner
        and C. Cancès, SIAM J. Numer. Anal. 55 (2017) 1760-1785).
        """
        return suction + change


#: Elements and their retention.
Laws = Sequence[tuple[ndarray, Retention]]


class _Limited(Retention):
    """Retention with a lower limit of the relative permeability, between 0 and 1."""

    least: float
    content: tuple[float, float] | None

    def __post_init__(self) -> None:
        number(self.least, "least", 0.0, 1.0)
        if self.content is not None:
            least, most = vector(self.content, 2, "content")
            if not 0.0 <= least < most <= 1.0:
                raise ValueError(
                    f"content is the residual and the saturated content of water, 0 <= residual < "
                    f"saturated <= 1, not {self.content!r}"
                )

    def limited(self, k: ndarray, slope: ndarray, dry: ndarray) -> tuple[ndarray, ndarray]:
        """Return the relative permeability and its slope, 1 in wet ground, and above the limit."""
        changing = dry & (k > self.least)
        k = np.where(dry, np.maximum(k, self.least), 1.0)
        return k, np.where(changing, slope, 0.0)


@dataclass(frozen=True)
class Ramp(_Limited):
    r"""Sharp free surface: ground is saturated below it and nearly impermeable above it.

    The relative permeability falls from 1 to `least` as the cubic :math:`3s^2 - 2s^3` over a
    suction head of `width` heights of the element. The transition is centred on zero pressure, so
    that its width does not bias the discharge.

    Parameters
    ----------
    width
        Width of the transition, in heights of the element in which it lies.
    least
        Relative permeability of dry ground, between 0 and 1.
    content
        Volume of water per volume of ground, the least that suction leaves and that of saturated
        ground: for :meth:`Flow.in_time`.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> sc.water.Ramp(width=1., least=.1).relative(np.array([-.5, 0., .5]), np.ones(3))[0]
    array([1.  , 0.55, 0.1 ])
    """

    width: float = 0.5
    least: float = 1e-3
    content: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        positive(self.width, "width")

    @override
    def relative(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        width = self.width * size
        # k = k_0 + (1 - k_0) (3 s² - 2 s³)
        s = np.clip(0.5 - suction / width, 0.0, 1.0)
        change = 1.0 - self.least
        k = self.least + change * s * s * (3.0 - 2.0 * s)
        return k, -change * 6.0 * s * (1.0 - s) / width

    @override
    def saturation(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        return replace(self, least=_NONE).relative(suction, size)

    @override
    def moved(self, suction: ndarray, change: ndarray, size: ndarray, flat: ndarray) -> ndarray:
        width = self.width * size
        # Find the part of the ramp, |t| <= half, on which the saturation is steeper than flat.
        half = 0.5 * np.sqrt(1.0 - np.minimum(flat * width / 1.5, _FLATTEST))
        most = half * (1.5 - 2.0 * half**2)
        # Change the saturation less a half, 1.5 t - 2 t³, and its tangents beyond that part.
        t = -suction / width
        inner = np.clip(t, -half, half)
        slope = 1.5 - 6.0 * inner**2
        new = inner * (1.5 - 2.0 * inner**2) + slope * (t - inner - change / width)
        # Return to the suction: 3 sin a - 4 sin³ a = sin 3a.
        filled = np.clip(new, -most, most)
        beyond = (new - filled) / (1.5 - 6.0 * half**2)
        moved = -width * (np.sin(np.arcsin(2.0 * filled) / 3.0) + beyond)
        # Changes along one tangent have less round-off in the suction.
        return np.where((t - inner) * (new - filled) > 0.0, suction + change, moved)

    @override
    def softer(self, factor: float) -> Ramp:
        return replace(self, width=self.width * factor)


@dataclass(frozen=True)
class VanGenuchten(_Limited):
    r"""Capillary fringe above the water table, by Mualem's model with van Genuchten's curve.

    With the suction head :math:`s`, :math:`m = 1 - 1/n` and the effective saturation
    :math:`S = (1 + (\alpha s)^n)^{-m}` the relative permeability is
    :math:`\sqrt S\,(1 - (1 - S^{1/m})^m)^2` (M. Th. van Genuchten, Soil Sci. Soc. Am. J. 44 (1980)
    892-898, eqs. 3, 8 and 9).

    Parameters
    ----------
    alpha
        One over a length: about the inverse of the height of the capillary fringe.
    n
        Exponent, more than 1: large for pores of one size.
    least
        Lower limit of the relative permeability, between 0 and 1.
    content
        Volume of water per volume of ground, the least that suction leaves and that of saturated
        ground: for :meth:`Flow.in_time`.

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
    content: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        positive(self.alpha, "alpha")
        number(self.n, "n", 1.0)

    @override
    def relative(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        m = self._m
        s = np.maximum(self.alpha * suction, np.finfo(float).tiny)
        x = s**self.n
        filled = (1.0 + x) ** (-0.5 * m)  # square root of the saturation
        rest = 1.0 - (x / (1.0 + x)) ** m
        k = filled * rest**2
        # slope of (x / (1 + x))^m: infinite at s = 0 for n < 2
        from_zero = np.maximum(s, _STEEPEST) ** (self.n - 2.0)
        steep = (self.n - 1.0) * from_zero * (1.0 + x) ** (-m - 1.0)
        by_filled = 0.5 * m * self.n * rest * x / s / (1.0 + x)
        slope = -filled * rest * (by_filled + 2.0 * steep)
        return self.limited(k, self.alpha * slope, suction > 0.0)

    @override
    def saturation(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        m = self._m
        s = np.maximum(self.alpha * suction, np.finfo(float).tiny)
        x = s**self.n
        filled = (1.0 + x) ** -m
        return filled, -self.alpha * m * self.n * x / s / (1.0 + x) * filled

    @override
    def moved(self, suction: ndarray, change: ndarray, size: ndarray, flat: ndarray) -> ndarray:
        m = self._m
        steepest = m ** (1.0 / self.n) / self.alpha  # at x = m
        relative = flat / (self.alpha * m * self.n)
        turn = relative ** (1.0 / (self.n - 1.0)) / self.alpha

        def suction_of(filled: ndarray) -> ndarray:
            power = np.expm1(-np.log(filled) / m)
            return np.asarray(power ** (1.0 / self.n) / self.alpha)

        turn = np.clip(turn, _STEEPEST * steepest, steepest)
        return _by_saturation(self, turn, suction_of, suction, change, flat)

    @property
    def _m(self) -> float:
        return 1.0 - 1.0 / self.n

    @override
    def softer(self, factor: float) -> VanGenuchten:
        return replace(self, alpha=self.alpha / factor)


@dataclass(frozen=True)
class BrooksCorey(_Limited):
    r"""Ground that stays saturated up to a suction at which air enters.

    Beyond the suction head :math:`s_b` the effective saturation is :math:`S = (s_b / s)^\lambda`
    and the relative permeability :math:`S^{3 + 2 / \lambda}` (R. H. Brooks and A. T. Corey,
    Hydrology Papers 3, Colorado State University 1964, by the model of N. T. Burdine).

    Parameters
    ----------
    entry
        Suction head at which air enters, a length.
    index
        Exponent :math:`\lambda`: large for pores of one size.
    least
        Lower limit of the relative permeability, between 0 and 1.
    content
        Volume of water per volume of ground, the least that suction leaves and that of saturated
        ground: for :meth:`Flow.in_time`.

    Examples
    --------
    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> sand = sc.water.BrooksCorey(entry=.2, index=2.)
    >>> sand.saturation(np.array([0., .2, .4]), np.ones(3))[0]
    array([1.  , 1.  , 0.25])
    >>> sand.relative(np.array([.1, .4]), np.ones(2))[0]
    array([1.       , 0.00390625])
    """

    entry: float
    index: float
    least: float = 1e-6
    content: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        positive(self.entry, "entry")
        positive(self.index, "index")

    @override
    def relative(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        power = 3.0 * self.index + 2.0
        s = np.maximum(suction / self.entry, 1.0)
        k = s**-power
        return self.limited(k, -power * k / s / self.entry, suction >= self.entry)

    @override
    def saturation(self, suction: ndarray, size: ndarray) -> tuple[ndarray, ndarray]:
        s = np.maximum(suction / self.entry, 1.0)
        filled = s**-self.index
        return filled, np.where(suction >= self.entry, -self.index * filled / s / self.entry, 0.0)

    @override
    def moved(self, suction: ndarray, change: ndarray, size: ndarray, flat: ndarray) -> ndarray:
        def suction_of(filled: ndarray) -> ndarray:
            return np.asarray(self.entry * filled ** (-1.0 / self.index))

        turn = np.full_like(suction, self.entry)
        return _by_saturation(self, turn, suction_of, suction, change, flat)

    @override
    def softer(self, factor: float) -> BrooksCorey:
        return replace(self, entry=self.entry * factor)


def _by_saturation(
    law: Retention,
    turn: ndarray,
    suction_of: Callable[[ndarray], ndarray],
    suction: ndarray,
    change: ndarray,
    flat: ndarray,
) -> ndarray:
    """Return the suction after a change in saturation, or in a line up to the suction `turn`.

    The line has the flat slope.
    """
    size = np.ones(1)
    wet = np.minimum(suction - turn, 0.0)
    most, steep = law.saturation(turn, size)
    filled, slope = law.saturation(suction - wet, size)
    # Change the saturation, or the line where the ground is wet.
    steep = np.maximum(steep, -flat)
    now = filled + steep * wet
    step = np.where(wet < 0.0, steep, slope) * change
    new = np.maximum(now + step, _DRIER * now)
    # Return to the suction.
    along_line = turn + (new - most) / steep
    moved = np.where(new < most, suction_of(np.minimum(new, most)), along_line)
    # Changes along the line have less round-off in the suction.
    return np.where((wet < 0.0) & (new > most), suction + change, moved)
