"""Moments and curvatures of reinforced sections, for the stiffness and the limits of beams."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike

from ..checks import finite, number, positive
from ..display import Table

#: Layers of concrete of a section: the moment of a rectangle at its limit is exact to 1e-4.
_LAYERS = 200
#: Points of the curve.
_POINTS = 60
#: Bisections for the strain of the axis.
_BISECTIONS = 80


@dataclass(frozen=True)
class MomentCurvature:
    """Curve of moment over curvature of a section; printed as a table.

    Attributes
    ----------
    curvature, moment : ndarray, shape (n,)
        From zero to the limit of the concrete or of the steel.
    normal
        Normal force, tension positive.
    cracking
        Moment at which the concrete cracks.
    largest
        Largest moment: `Mp` of a :class:`~skfem_contact.Beam`.
    stiffness
        Secant stiffness at half of the largest moment: `EI` of a cracked beam.
    """

    curvature: ndarray
    moment: ndarray
    normal: float
    cracking: float
    largest: float
    stiffness: float

    def table(self) -> Table:
        """Return the table of curvatures and moments."""
        columns = {"curvature": self.curvature, "M": self.moment}
        return Table.of(columns, f"N = {self.normal:g}", {"M": "moment"})

    def __str__(self) -> str:
        return str(self.table())

    __repr__ = __str__


def moment_curvature(
    width: float,
    height: float,
    steel: Sequence[ArrayLike],
    *,
    f_c: float,
    f_y: float,
    normal: float = 0.0,
    f_t: float = 0.0,
    E_s: float = 2e8,
    eps_c: float = 0.002,
    eps_cu: float = 0.0035,
    eps_su: float = 0.025,
) -> MomentCurvature:
    r"""Return the curve of moment over curvature of a reinforced rectangle.

    Plane sections remain plane. Concrete follows the parabola and the rectangle of Eurocode 2,
    :math:`\sigma = f_c (1 - (1 - \varepsilon / \varepsilon_c)^2)` up to :math:`\varepsilon_c`, and
    resists tension up to `f_t`; steel is elastic and ideally plastic. A positive moment compresses
    the top.

    Parameters
    ----------
    width, height
        Sizes of the section.
    steel
        Areas and depths below the top of the layers of bars: (area, depth) each.
    f_c, f_y
        Strengths of concrete in compression and of steel; design values for a design.
    normal
        Normal force, tension positive, in the middle of the section.
    f_t
        Tensile strength of concrete, with the stiffness of its compression.
    E_s
        Modulus of steel, 2e8 in kPa.
    eps_c, eps_cu, eps_su
        Strains of concrete at its strength and at its limit, and of steel at its limit.

    Raises
    ------
    ValueError
        Sizes or strengths that are not positive, bars outside of the section, a normal force that
        the section does not resist.

    Examples
    --------
    A wall of 0.6 m with bars on one side: the moment is :math:`A_s f_y z` with the lever of the
    parabola and the rectangle, which fills 0.8095 of the compressed depth at 0.416 of it:

    >>> import skfem_contact as sc
    >>> found = sc.moment_curvature(1., .6, [(2e-3, .54)], f_c=20e3, f_y=435e3)
    >>> depth = 2e-3 * 435e3 / (.8095 * 20e3)
    >>> f"{found.largest:.0f} {2e-3 * 435e3 * (.54 - .416 * depth):.0f}"
    '450 450'
    """
    # Check the section.
    b = positive(width, "width")
    h = positive(height, "height")
    for name, value in {"f_c": f_c, "f_y": f_y, "E_s": E_s, "eps_c": eps_c}.items():
        positive(value, name)
    if not eps_cu > eps_c or not eps_su > 0.0 or not f_t >= 0.0:
        raise ValueError("eps_cu must exceed eps_c, eps_su be positive, and f_t not negative")
    bars = np.atleast_2d(finite(steel, "steel"))
    inside = bars.shape[1] == 2 and (bars > 0.0).all()
    if not inside or (bars[:, 1] >= h).any():
        raise ValueError(f"steel is pairs (area, depth) with depths between 0 and {h:g}")
    section = _Section(
        b,
        h,
        bars,
        f_c,
        f_y,
        f_t,
        E_s,
        eps_c,
    )
    number(normal, "normal")

    _check_normal(section, normal)

    # Follow the curve, closely at its beginning.
    largest_curvature = _last_curvature(section, normal, eps_cu, eps_su)
    curvature = largest_curvature * np.linspace(0.0, 1.0, _POINTS) ** 2
    moments = []
    for k in curvature:
        axis = section.axis(k, normal)
        moments.append(section.forces(axis, k)[1])
    moment = np.array(moments)
    # The secant at half of the largest moment is the stiffness.
    largest = float(moment.max())
    rising = slice(0, int(moment.argmax()) + 1)
    at_half = float(np.interp(0.5 * largest, moment[rising], curvature[rising]))
    elastic = b * h**2 / 6.0 * (f_t - normal / (b * h))
    cracking = 0.0
    if f_t > 0.0 or normal < 0.0:
        cracking = max(elastic, 0.0)
    return MomentCurvature(
        curvature,
        moment,
        float(normal),
        cracking=float(cracking),
        largest=largest,
        stiffness=0.5 * largest / at_half,
    )


@dataclass(frozen=True)
class _Section:
    """Section in layers, with its laws."""

    b: float
    h: float
    bars: ndarray  # areas and depths, (n, 2)
    f_c: float
    f_y: float
    f_t: float
    E_s: float
    eps_c: float

    def forces(self, axis: float, curvature: float) -> tuple[float, float]:
        """Return normal force and moment of the strain of the axis and the curvature."""
        # Strains grow downwards under a positive curvature: the top is compressed.
        y = (np.arange(_LAYERS) + 0.5) / _LAYERS * self.h - 0.5 * self.h  # below the axis
        thickness = self.h / _LAYERS * self.b
        concrete = self.concrete(axis + curvature * y) * thickness
        depth = self.bars[:, 1] - 0.5 * self.h
        strain = axis + curvature * depth
        stress = np.clip(self.E_s * strain, -self.f_y, self.f_y)
        force = self.bars[:, 0] * (stress - self.concrete(strain))
        N = concrete.sum() + force.sum()
        M = (concrete * y).sum() + (force * depth).sum()
        return float(N), float(M)

    def concrete(self, strain: ndarray) -> ndarray:
        """Return stresses of concrete, tension positive."""
        share = np.clip(-strain / self.eps_c, 0.0, 1.0)
        stress = -self.f_c * (1.0 - (1.0 - share) ** 2)
        pulled = 2.0 * self.f_c / self.eps_c * strain
        holds = (strain > 0.0) & (pulled <= self.f_t)
        return np.where(holds, pulled, stress)

    def axis(self, curvature: float, normal: float) -> float:
        """Return the strain of the axis that gives a normal force."""
        low = -1.0
        high = 1.0
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            if self.forces(middle, curvature)[0] < normal:
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)


def _check_normal(section: _Section, normal: float) -> None:
    """Refuse normal forces that the section does not resist."""
    low = section.forces(-section.eps_c, 0.0)[0]
    high = float((section.bars[:, 0]).sum() * section.f_y)
    if not low < normal < high:
        raise ValueError(
            f"the section resists normal forces between {low:.4g} and {high:.4g}, not {normal:g}"
        )


def _last_curvature(section: _Section, normal: float, eps_cu: float, eps_su: float) -> float:
    """Return the largest curvature that neither concrete nor steel exceeds."""
    top = section.h / 2.0
    deepest = section.bars[:, 1].max()
    most = (eps_cu + eps_su) / deepest
    least = 0.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (least + most)
        axis = section.axis(middle, normal)
        crushed = -(axis - middle * top) > eps_cu
        torn = axis + middle * (deepest - top) > eps_su
        if crushed or torn:
            most = middle
        else:
            least = middle
    return least
