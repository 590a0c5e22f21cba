"""Coulomb friction between bodies with a penalty in both directions (eqs 4 to 10 of the paper)."""
from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy import ndarray


class Status(IntEnum):
    """Status of a contact point."""

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


@dataclass(frozen=True)
class Coulomb:
    r"""Regularised Coulomb friction: an elastic stick and the return to the friction cone.

    .. math:: t_N = \epsilon_N \min(g, 0), \qquad |t_T| \le a + \mu |t_N|

    Parameters
    ----------
    mu
        Coefficient of friction.
    adhesion
        Shear strength ``a`` at zero pressure, in units of stress; it acts while the point is closed.

    Raises
    ------
    ValueError
        Negative or NaN parameters.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import Coulomb
    >>> out = Coulomb(mu=.5).update(np.array([-1e-3]), np.array([2e-3]), np.array([1e4]), np.array([1e4]))
    >>> float(out.normal[0]), float(out.tangential[0]), int(out.status[0])   # slips at 0.5 * 10
    (-10.0, 5.0, 2)
    """

    mu: float = 0.0
    adhesion: float = 0.0

    def __post_init__(self) -> None:
        for name in ("mu", "adhesion"):
            if not getattr(self, name) >= 0.0 or not np.isfinite(getattr(self, name)):
                raise ValueError(f"Coulomb: {name} must be a non-negative number, not {getattr(self, name)!r}")

    def update(self, gap: ndarray, slip: ndarray, normal_penalty: ndarray, tangential_penalty: ndarray) -> Traction:
        """Return mapping of the tangential traction (eqs 8 to 10); a pure function.

        Parameters
        ----------
        gap
            Normal gap, negative in penetration, (n,).
        slip
            Slip from the stick point, (n,).
        normal_penalty, tangential_penalty
            Traction per penetration and per elastic slip, (n,).
        """
        closed = gap <= 0.0
        normal = np.where(closed, normal_penalty * gap, 0.0)  # eq. 4
        trial = tangential_penalty * slip  # eq. 8
        limit = np.where(closed, self.adhesion + self.mu * np.abs(normal), 0.0)
        if self.mu == 0.0 and self.adhesion == 0.0:
            status = np.where(closed, Status.SLIP, Status.OPEN)
        else:
            status = np.where(closed, np.where(np.abs(trial) <= limit, Status.STICK, Status.SLIP), Status.OPEN)
        stick, direction = status == Status.STICK, np.sign(trial)
        tangential = np.where(stick, trial, direction * limit)  # eq. 9
        return Traction(
            normal=normal,
            tangential=tangential,
            normal_by_gap=np.where(closed, normal_penalty, 0.0),
            tangential_by_gap=np.where(status == Status.SLIP, -direction * self.mu * normal_penalty, 0.0),
            tangential_by_slip=np.where(stick, tangential_penalty, 0.0),
            elastic_slip=tangential / tangential_penalty,  # eq. 10
            status=status)
