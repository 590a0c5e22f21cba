"""Interface laws: Coulomb friction with a penalty in all directions (eqs 4 to 10 of the paper), and ties."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from ..errors import finite
from .quadrature import SlavePoints

#: Round-off of a traction on the friction cone, as a share of it.
_ON_CONE = 1e-9


class Status(IntEnum):
    """Status of a contact point; arrays of states and :class:`~skfem_contact.results.Tractions` hold its numbers.

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


class Update(NamedTuple):
    """Answer of an interface law at ``n`` points; the plane has ``dim = 2``, space 3.

    Attributes
    ----------
    traction
        Normal traction, negative in compression, then the shear tractions, positive where the slave is dragged back
        from a positive slip: work conjugate to gap and slip, (dim, n).
    internal
        New internal variables, (n_internal, n).
    tangent
        ``tangent[i, j]`` is the derivative of traction i by jump j, (dim, dim, n).
    elastic_slip
        Part of the slip that would be recovered: the distance from the new stick point, (dim - 1, n).
    status
        :class:`Status` of every point, (n,).
    """

    traction: ndarray
    internal: ndarray
    tangent: ndarray
    elastic_slip: ndarray
    status: ndarray


class InterfaceLaw:
    """What a contact pair asks of a law; a law of your own writes :meth:`update`, and what differs from here.

    A law is a frozen dataclass of parameters.  A parameter that is an array has one value for each node of the slave,
    ``pair.slave.nodes``, and is interpolated between them.

    Attributes
    ----------
    n_internal
        Number of internal variables of a point; they are zero at first.
    reaches_far
        Whether points at any distance from the master may carry traction: by default those within an element may.
    bonds
        Whether points near the master are bonded to it as they are meshed.
    symmetric
        Whether the tangent of contact is symmetric.
    """

    n_internal: int = 0
    reaches_far: bool = False
    bonds: bool = False
    symmetric: bool = False

    def take(self, points: SlavePoints) -> InterfaceLaw:
        """The law at points of the slave: parameters that are arrays are interpolated there."""
        arrays = {name: points.at(value) for name, value in vars(self).items() if isinstance(value, ndarray)}
        return replace(self, **arrays) if arrays else self  # type: ignore[type-var]

    def reaches(self, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
        """Points that may carry traction, (n,): :meth:`update` is asked for these; all others are open.

        Parameters
        ----------
        gap
            Normal gap, negative in penetration, (n,).
        internal
            Accepted internal variables, (n_internal, n).
        closed
            Points that were closed in the accepted state, (n,).
        """
        return gap <= 0.0

    def update(self, jump: ndarray, internal: ndarray, penalty: tuple[float, float]) -> Update:
        """Tractions, a pure function.

        Parameters
        ----------
        jump
            Normal gap, negative in penetration, then the slip from the stick point, (dim, n).
        internal
            Accepted internal variables, (n_internal, n).
        penalty
            Traction per penetration and per elastic slip.
        """
        raise NotImplementedError(f"{type(self).__name__} has no `update`")

    def debonded(self, internal: ndarray) -> ndarray:
        """Internal variables of points that have lost what holds them together; the same ones where nothing does."""
        return internal


@dataclass(frozen=True, eq=False)
class Coulomb(InterfaceLaw):
    r"""Regularised Coulomb friction: an elastic stick and the return to the friction cone.

    .. math:: t_N = \epsilon_N \min(g, 0), \qquad |t_T| \le a + \mu |t_N|

    Parameters
    ----------
    mu
        Coefficient of friction; this and the others a number, or one for each node of the slave.
    adhesion
        Shear strength ``a`` at zero pressure, in units of stress; it acts while the point is closed.
    tension
        Tension cut-off: a closed point opens when its normal traction exceeds this stress.

    Raises
    ------
    ValueError
        Negative or NaN parameters.

    Notes
    -----
    Adhesion and tension are a brittle bond.  A closed point that opens breaks it for good, which is the law's only
    internal variable: 1 where the bond is broken.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import Coulomb
    >>> jump, whole = np.array([[-1e-3], [2e-3]]), np.zeros((1, 1))
    >>> out = Coulomb(mu=.5).update(jump, whole, (1e4, 1e4))
    >>> out.traction[:, 0].tolist(), int(out.status[0])   # slips at 0.5 * 10
    ([-10.0, 5.0], 2)
    """

    mu: float | ndarray = 0.0
    adhesion: float | ndarray = 0.0
    tension: float | ndarray = 0.0

    n_internal = 1

    def __post_init__(self) -> None:
        for name in ("mu", "adhesion", "tension"):
            value = finite(getattr(self, name), f"Coulomb: {name}")
            if value.ndim > 1 or (value < 0.0).any():
                raise ValueError(f"Coulomb: {name} must be a non-negative number, or one for each node of the slave, "
                                 f"not {getattr(self, name)!r}")
            object.__setattr__(self, name, value if value.ndim else float(value))

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
    def symmetric(self) -> bool:  # type: ignore[override]
        """Whether the tangent of contact is symmetric: there is no shear, and the pressure has a potential."""
        return not (np.any(self.mu) or np.any(self.adhesion))

    @property
    def _has_bond(self) -> bool:
        return bool(np.any(self.adhesion) or np.any(self.tension))

    def reaches(self, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
        """Penetrating points, and closed ones with a bond, which may hold or break."""
        return (gap <= 0.0) | (closed & (internal[0] == 0.0)) if self._has_bond else gap <= 0.0

    def update(self, jump: ndarray, internal: ndarray, penalty: tuple[float, float]) -> Update:
        """Return mapping of the shear traction onto the cone (eqs 8 to 10); arguments as of a law."""
        gap, slip, (by_gap, by_slip) = jump[0], jump[1:], penalty
        normal, pulls = by_gap * gap, gap > 0.0  # eq. 4
        whole = internal[0] == 0.0
        opens = pulls & ~(whole & (normal <= self.tension))
        adhesion = np.where(whole, self.adhesion, 0.0)
        limit = adhesion + self.mu * np.maximum(-normal, 0.0)
        trial = by_slip * slip  # eq. 8
        size = np.sqrt((trial * trial).sum(axis=0))
        length = np.where(size > 0.0, size, 1.0)
        direction = trial / length
        # a point that slid to the cone lies on it up to round-off, and sticks until it is dragged further
        stick = (size <= (1.0 + _ON_CONE) * limit) & (adhesion + self.mu > 0.0)
        shear = np.where(stick, trial, direction * limit)  # eq. 9

        tangent = np.zeros((len(jump), *jump.shape))
        tangent[0, 0] = by_gap
        tangent[1:, 0] = np.where(stick | pulls, 0.0, -direction * self.mu * by_gap)
        along = np.eye(len(slip))[..., None]
        returned = limit * by_slip / length  # the radial return turns with the slip
        tangent[1:, 1:] = np.where(stick, by_slip * along, returned * (along - direction[:, None] * direction))
        traction = np.where(opens, 0.0, np.concatenate((normal[None], shear)))
        status = np.where(opens, int(Status.OPEN), np.where(stick, int(Status.STICK), int(Status.SLIP)))
        return Update(traction, np.where(opens, 1.0, internal), np.where(opens, 0.0, tangent),
                      traction[1:] / by_slip, status)  # eq. 10

    def debonded(self, internal: ndarray) -> ndarray:
        """The bond is broken."""
        return np.ones_like(internal) if self._has_bond else internal


@dataclass(frozen=True, eq=False)
class Tied(InterfaceLaw):
    r"""A bond of what is meshed apart: :math:`t_N = \epsilon_N g` in both directions, and no slip.

    Slave points that lie within half a segment of the master at the start are tied as they are meshed.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import Tied
    >>> jump = np.array([[1e-3], [0.]])
    >>> float(Tied().update(jump, np.zeros((0, 1)), (1e4, 1e4)).traction[0, 0])
    10.0
    """

    bonds = True

    def reaches(self, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
        """What was tied at the start."""
        return closed

    def update(self, jump: ndarray, internal: ndarray, penalty: tuple[float, float]) -> Update:
        """Linear springs in all directions; arguments as of a law."""
        stiffness, tangent = np.ones_like(jump), np.zeros((len(jump), *jump.shape))
        stiffness[0], stiffness[1:] = penalty
        tangent[np.arange(len(jump)), np.arange(len(jump))] = stiffness
        return Update(stiffness * jump, internal, tangent, jump[1:].copy(), np.full(jump.shape[1], int(Status.STICK)))
