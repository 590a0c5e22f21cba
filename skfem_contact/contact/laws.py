"""Coulomb friction between bodies with a penalty in both directions (eqs 4 to 10 of the paper)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import NamedTuple, Protocol

import numpy as np
from numpy import ndarray

#: Round-off of a traction on the friction cone, as a share of it.
_ON_CONE = 1e-9


class Status(IntEnum):
    """Status of a contact point; arrays of states and :class:`~skfem_contact.Tractions` hold its numbers.

    Attributes
    ----------
    OPEN
        0: no traction, for nothing is opposite or the gap is open.
    STICK
        1: closed; slip is elastic.
    SLIP
        2: closed; the shear traction has reached its bound.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import Status
    >>> np.bincount([2, 2, 1], minlength=3)[Status.SLIP].item()
    2
    """

    OPEN = 0
    STICK = 1
    SLIP = 2


class Traction(NamedTuple):
    """Tractions of an interface law and their derivatives, arrays (n,).

    Attributes
    ----------
    normal, tangential
        ``t_N`` (negative in compression) and ``t_T`` (positive when the slave is dragged back from a
        positive slip): work conjugate to gap and slip.
    normal_by_gap, tangential_by_gap, tangential_by_slip
        Derivatives.
    elastic_slip
        Part of the slip that would be recovered: the distance from the new stick point.
    status
        :class:`Status` of every point.
    """

    normal: ndarray
    tangential: ndarray
    normal_by_gap: ndarray
    tangential_by_gap: ndarray
    tangential_by_slip: ndarray
    elastic_slip: ndarray
    status: ndarray


class InterfaceLaw(Protocol):
    """What a contact pair asks of a law: pure functions of gap and slip."""

    @property
    def bonds(self) -> bool:
        """Whether points near the master are bonded to it as they are meshed."""

    def reaches(self, gap: ndarray, normal_penalty: float, closed: ndarray) -> ndarray:
        """Which points may carry traction; ``closed`` are those that did in the accepted state."""

    def update(self, gap: ndarray, slip: ndarray, normal_penalty: float, tangential_penalty: float) -> Traction:
        """Tractions at the points that :meth:`reaches` names."""


@dataclass(frozen=True)
class Coulomb:
    r"""Regularised Coulomb friction: an elastic stick and the return to the friction cone.

    .. math:: t_N = \epsilon_N \min(g, 0), \qquad |t_T| \le a + \mu |t_N|

    Parameters
    ----------
    mu
        Coefficient of friction.
    adhesion
        Shear strength ``a`` at zero pressure, in units of stress; it acts while the point is closed.  A point that
        opens with its adhesion and closes without it loses it for good; a remark names it.
    tension
        Tension cut-off: a closed point opens when its normal traction exceeds this stress, for good (brittle).

    Raises
    ------
    ValueError
        Negative or NaN parameters.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import Coulomb
    >>> out = Coulomb(mu=.5).update(np.array([-1e-3]), np.array([2e-3]), 1e4, 1e4)
    >>> float(out.normal[0]), float(out.tangential[0]), int(out.status[0])   # slips at 0.5 * 10
    (-10.0, 5.0, 2)
    """

    mu: float = 0.0
    adhesion: float = 0.0
    tension: float = 0.0

    def __post_init__(self) -> None:
        for name in ("mu", "adhesion", "tension"):
            if not getattr(self, name) >= 0.0 or not np.isfinite(getattr(self, name)):
                raise ValueError(f"Coulomb: {name} must be a non-negative number, not {getattr(self, name)!r}")

    def reduced(self, factor: float) -> Coulomb:
        """The law with friction, adhesion and tension cut-off divided by a factor.

        Raises
        ------
        ValueError
            The factor is not positive.

        Examples
        --------
        >>> from skfem_contact import Coulomb
        >>> Coulomb(mu=.6, adhesion=10.).reduced(2.)
        Coulomb(mu=0.3, adhesion=5.0, tension=0.0)
        """
        if not factor > 0.0:
            raise ValueError(f"the factor must be positive, not {factor!r}")
        return replace(self, mu=self.mu / factor, adhesion=self.adhesion / factor, tension=self.tension / factor)

    @property
    def bonds(self) -> bool:
        """No bond: contact is where the bodies meet."""
        return False

    @property
    def symmetric(self) -> bool:
        """Whether the tangent of contact is symmetric: there is no shear, and the pressure has a potential."""
        return self.mu == 0.0 and self.adhesion == 0.0

    @property
    def unbonded(self) -> Coulomb:
        """The law of a point whose bond is broken: friction alone."""
        return replace(self, adhesion=0.0, tension=0.0)

    def reaches(self, gap: ndarray, normal_penalty: float, closed: ndarray) -> ndarray:
        """Penetrating points, and closed ones up to the tension cut-off."""
        return (gap <= 0.0) | (closed & (normal_penalty * gap <= self.tension) & (self.tension > 0.0))

    def update(self, gap: ndarray, slip: ndarray, normal_penalty: float, tangential_penalty: float) -> Traction:
        """Return mapping of the tangential traction (eqs 8 to 10); a pure function.

        Parameters
        ----------
        gap
            Normal gap, negative in penetration, (n,).
        slip
            Slip from the stick point, (n,).
        normal_penalty, tangential_penalty
            Traction per penetration and per elastic slip.
        """
        normal = normal_penalty * gap  # eq. 4
        trial = tangential_penalty * slip  # eq. 8
        limit = self.adhesion + self.mu * np.maximum(-normal, 0.0)
        direction = np.sign(trial)
        # a point that slid to the cone lies on it up to round-off, and sticks until it is dragged further
        stick = (np.abs(trial) <= (1.0 + _ON_CONE) * limit) & (self.mu + self.adhesion > 0.0)
        tangential = np.where(stick, trial, direction * limit)  # eq. 9
        return Traction(
            normal=normal,
            tangential=tangential,
            normal_by_gap=np.full_like(gap, normal_penalty),
            tangential_by_gap=np.where(stick | (gap > 0.0), 0.0, -direction * self.mu * normal_penalty),
            tangential_by_slip=np.where(stick, tangential_penalty, 0.0),
            elastic_slip=tangential / tangential_penalty,  # eq. 10
            status=np.where(stick, int(Status.STICK), int(Status.SLIP)),
        )


@dataclass(frozen=True)
class Tied:
    r"""A bond of what is meshed apart: :math:`t_N = \epsilon_N g` in both directions, and no slip.

    Slave points that lie within half a segment of the master at the start are tied as they are meshed.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import Tied
    >>> one = np.ones(1)
    >>> float(Tied().update(1e-3 * one, 0. * one, 1e4, 1e4).normal[0])
    10.0
    """

    @property
    def bonds(self) -> bool:
        """Points near the master are bonded to it."""
        return True

    def reaches(self, gap: ndarray, normal_penalty: float, closed: ndarray) -> ndarray:
        """What was tied at the start."""
        return closed

    def update(self, gap: ndarray, slip: ndarray, normal_penalty: float, tangential_penalty: float) -> Traction:
        """Linear springs in both directions; arguments as for :meth:`Coulomb.update`."""
        zero = np.zeros_like(gap)
        return Traction(
            normal_penalty * gap,
            tangential_penalty * slip,
            zero + normal_penalty,
            zero,
            zero + tangential_penalty,
            slip,
            np.full(len(gap), int(Status.STICK)),
        )
