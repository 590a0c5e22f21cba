"""Interface laws: Coulomb friction with penalties (eqs 4 to 10 of the paper), and ties."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy import ndarray
from typing_extensions import override

from ..checks import finite, is_number
from ..errors import warn
from .quadrature import SlavePoints

#: Round-off of a traction on the friction cone, as a share of it.
_ON_CONE = 1e-9
#: Strength of bonds that do not break; infinity times a shape function of zero is no number.
_ENDLESS = 1e100
#: Share of the secant in a damped tangent. A pit of 6 m beside a sheet pile that slides along both
#: faces: the search for its factor, 3.30, takes 254 iterations with .3 and 543 with 1; it stalls at
#: 3.20 with .1, and without, in the first try of every search, at 2.65 after 140. A wall of which 5
#: m are dug free in an increment takes 27 iterations with .3 and with 1, 28 with .2, 31 without.
_SECANT = 0.3


class Status(IntEnum):
    """Status of a contact point: open, elastic slip, or slip at the friction bound."""

    OPEN = 0
    STICK = 1
    SLIP = 2


class LawUpdate(NamedTuple):
    """Result of an interface law at ``n`` points; the plane has ``dim = 2``, space 3.

    Attributes
    ----------
    traction : ndarray, shape (dim, n)
        Normal traction, negative in compression, then the shear tractions, work conjugate to gap
        and slip.
    internal : ndarray, shape (n_internal, n)
        New internal variables.
    tangent : ndarray, shape (dim, dim, n)
        Derivative ``tangent[i, j]`` of traction i by jump j.
    elastic_slip : ndarray, shape (dim - 1, n)
        Recoverable part of the slip: the distance from the new stick point.
    status : ndarray, shape (n,)
        0 open, 1 stick, 2 slip.
    """

    traction: ndarray
    internal: ndarray
    tangent: ndarray
    elastic_slip: ndarray
    status: ndarray


def resisting(update: LawUpdate, slip: ndarray) -> LawUpdate:
    """Add a share of the secant, shear traction over slip, to the tangent where points slide.

    A wall that slides along all of its faces has no stiffness along its axis. The secant decreases
    as the slip grows.
    """
    shear = _length(update.traction[1:])
    size = _length(slip)
    slides = (update.status == int(Status.SLIP)) & (size > 0.0)
    secant = np.where(slides, shear, 0.0) / np.where(slides, size, 1.0)
    identity = np.eye(len(slip))[..., None]
    tangent = update.tangent.copy()
    tangent[1:, 1:] += _SECANT * secant * identity
    return update._replace(tangent=tangent)


def _length(vectors: ndarray) -> ndarray:
    """Return the lengths of vectors, shape (dim, n)."""
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=0)))


class InterfaceLaw:
    """Base of interface laws; a law of your own overrides :meth:`update` and other defaults.

    A law is a frozen dataclass of parameters.  An array parameter has one value for each node of
    the slave, ``pair.slave.nodes``, and is interpolated between them.

    Attributes
    ----------
    n_internal : int
        Number of internal variables of a point; they are zero at first.
    reaches_far : bool
        True if points at any distance from the master may have traction; by default points within
        an element may.
    bonds : bool
        True if points near the master are bonded to it as they are meshed.
    symmetric : bool
        True if the tangent of contact is symmetric.
    """

    n_internal: int = 0
    reaches_far: bool = False
    bonds: bool = False
    symmetric: bool = False

    def take(self, points: SlavePoints) -> InterfaceLaw:
        """Return the law at points of the slave, with interpolated array parameters."""
        arrays = {}
        for name, value in vars(self).items():
            if isinstance(value, ndarray):
                arrays[name] = points.at(value)
        return replace(self, **arrays) if arrays else self  # type: ignore[type-var]

    def reaches(self, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
        """Return a mask, shape (n,), of points that may have traction; all others are open.

        Only these points get an update.

        Parameters
        ----------
        gap : ndarray, shape (n,)
            Normal gap, negative in penetration.
        internal : ndarray, shape (n_internal, n)
            Accepted internal variables.
        closed : ndarray, shape (n,)
            True at points that were closed in the accepted state.
        """
        return gap <= 0.0

    def update(self, jump: ndarray, internal: ndarray, penalty: tuple[float, float]) -> LawUpdate:
        """Return tractions, tangent and new internal variables, without side effects.

        Parameters
        ----------
        jump : ndarray, shape (dim, n)
            Normal gap, negative in penetration, then the slip from the stick point.
        internal : ndarray, shape (n_internal, n)
            Accepted internal variables.
        penalty : tuple
            Traction per penetration and per elastic slip.
        """
        raise NotImplementedError(f"{type(self).__name__} has no `update`")

    def reduced(self, factor: float) -> InterfaceLaw:
        """Return the law with its strength divided by a factor.

        Laws that do not override this method have no strength.
        """
        raise NotImplementedError(f"{type(self).__name__} has no `reduced`")

    @property
    def per_area(self) -> bool:
        """True if the law has strengths per area, such as an adhesion."""
        return False

    def on_area(self, stretch: ndarray) -> InterfaceLaw:
        """Return the law whose strengths per area are multiplied at points, (n,).

        Tractions are per undeformed area. Bodies of finite kinematics ask for this law where their
        area has grown.
        """
        return self

    def debonded(self, internal: ndarray) -> ndarray:
        """Return the internal variables of points whose bond is broken; by default the same."""
        return internal

    def unbreakable(self) -> InterfaceLaw:
        """Return the law with bonds that transfer any tension; by default the same."""
        return self

    def overload(self, traction: ndarray, internal: ndarray) -> ndarray:
        """Return the tension of unbroken bonds over their strength, (n,); 0 without bonds."""
        return np.zeros(traction.shape[1])


@dataclass(frozen=True, eq=False)
class Coulomb(InterfaceLaw):
    r"""Regularised Coulomb friction: an elastic stick and the return to the friction cone.

    .. math:: t_N = \epsilon_N \min(g, 0), \qquad |t_T| \le a + \mu |t_N|

    Adhesion and tension are a brittle bond.  A closed point that opens breaks it for good, unless
    the bond heals.

    Parameters
    ----------
    mu : float or ndarray, shape (n_nodes,)
        Coefficient of friction; array parameters have one value for each node of the slave.
    adhesion : float or ndarray
        Shear strength ``a`` at zero pressure of closed points, in units of stress.
    tension : float or ndarray
        Tension cut-off: a closed point opens when its normal traction exceeds this stress.
    heals : bool
        True: a point that closes again has its bond again. Soft clay that flows round a rough tool
        resists with its undrained strength, ``Coulomb(adhesion=su, heals=True)``, where it touches.

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
    heals: bool = False

    n_internal = 1

    def __post_init__(self) -> None:
        for name in ("mu", "adhesion", "tension"):
            value = finite(getattr(self, name), f"Coulomb: {name}")
            if value.ndim > 1 or (value < 0.0).any():
                raise ValueError(
                    f"Coulomb: {name} must be a non-negative number, or one for each node of the "
                    f"slave, not {getattr(self, name)!r}"
                )
            object.__setattr__(self, name, value if value.ndim else float(value))
        # Warn of angles: these are 84 to 89.4 degrees; more is meant as no slip
        if 10.0 < np.max(self.mu, initial=0.0) < 90.0:
            warn(
                f"mu is {np.max(self.mu):.4g}: it is the tangent of the angle of friction, which "
                "is given in degrees for soils only"
            )

    @classmethod
    def from_soil(cls, soil: Any, ratio: float) -> Coulomb:
        """Return the law of an interface with a share of a soil's strength.

        Parameters
        ----------
        soil
            Material with a cohesion `c` and an angle of friction `phi` in degrees.
        ratio : float
            Share of the strength, in (0, 1].

        Examples
        --------
        >>> import skfem_contact as sc
        >>> sand = sc.MohrCoulomb(E=1e4, nu=.3, c=3., phi=30.)
        >>> sc.Coulomb.from_soil(sand, 2 / 3)
        Coulomb(mu=0.3849001794597505, adhesion=2.0, tension=0.0, heals=False)
        """
        c: Any = getattr(soil, "c", None)
        phi = getattr(soil, "phi", 0.0)
        uniform = is_number(c) and is_number(phi)
        if not (0.0 < ratio <= 1.0 and uniform):
            raise ValueError(
                f"ratio must lie in (0, 1], and the soil have one c and phi, not {ratio!r} and "
                f"{soil!r}"
            )
        friction = float(np.tan(np.radians(phi)))
        return cls(mu=ratio * friction, adhesion=ratio * c)

    @override
    def reduced(self, factor: float) -> Coulomb:
        """Return the law with friction, adhesion and tension cut-off divided by a factor > 0."""
        if not factor > 0.0:
            raise ValueError(f"the factor must be positive, not {factor!r}")
        # Copy, because the constructor would warn of a friction that a search tries
        new = copy(self)
        for strength in ("mu", "adhesion", "tension"):
            object.__setattr__(new, strength, getattr(self, strength) / factor)
        return new

    @property
    @override
    def per_area(self) -> bool:
        return self._has_bond

    @override
    def on_area(self, stretch: ndarray) -> Coulomb:
        new = copy(self)
        for strength in ("adhesion", "tension"):
            object.__setattr__(new, strength, getattr(self, strength) * stretch)
        return new

    @property
    def symmetric(self) -> bool:  # type: ignore[override]
        """True without shear: the pressure has a potential."""
        return not (np.any(self.mu) or np.any(self.adhesion))

    @property
    def _has_bond(self) -> bool:
        return bool(np.any(self.adhesion) or np.any(self.tension))

    @override
    def reaches(self, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
        if self._has_bond:
            return (gap <= 0.0) | (closed & (internal[0] == 0.0))
        return gap <= 0.0

    @override
    def update(self, jump: ndarray, internal: ndarray, penalty: tuple[float, float]) -> LawUpdate:
        eps_N, eps_T = penalty
        gap = jump[0]
        slip = jump[1:]

        # Eq. 4: t_N = eps_N g; an unbroken bond transfers tension
        t_N = eps_N * gap
        pulls = gap > 0.0
        whole = internal[0] == 0.0
        opens = pulls & ~(whole & (t_N <= self.tension))

        # Eq. 8: trial traction T = eps_T s, with its length and direction
        trial = eps_T * slip
        size = _length(trial)
        length = np.where(size > 0.0, size, 1.0)
        direction = trial / length

        # Eq. 5: Phi = |T| - (a + mu |t_N|); a point that slid to the cone lies on it up to
        # round-off, and sticks until it is dragged further
        adhesion = np.where(whole, self.adhesion, 0.0)
        limit = adhesion + self.mu * np.maximum(-t_N, 0.0)
        stick = (size <= (1.0 + _ON_CONE) * limit) & (adhesion + self.mu > 0.0)

        # Eq. 9: return to the cone along the trial traction
        t_T = np.where(stick, trial, direction * limit)
        traction = np.where(opens, 0.0, np.concatenate((t_N[None], t_T)))

        # Differentiate by gap and slip, eqs 20 to 22; the radial return turns with the slip
        identity = np.eye(len(slip))[..., None]
        returned = limit * eps_T / length * (identity - direction[:, None] * direction)
        tangent = np.zeros((len(jump), *jump.shape))  # (dim, dim, n)
        tangent[0, 0] = eps_N
        tangent[1:, 0] = np.where(stick | pulls, 0.0, -direction * self.mu * eps_N)
        tangent[1:, 1:] = np.where(stick, eps_T * identity, returned)

        closed = np.where(stick, int(Status.STICK), int(Status.SLIP))
        breaks = opens & (not self.heals)
        return LawUpdate(
            traction,
            internal=np.where(breaks, 1.0, internal),
            tangent=np.where(opens, 0.0, tangent),
            elastic_slip=traction[1:] / eps_T,  # eq. 10
            status=np.where(opens, int(Status.OPEN), closed),
        )

    @override
    def debonded(self, internal: ndarray) -> ndarray:
        if self._has_bond:
            return np.ones_like(internal)
        return internal

    @override
    def unbreakable(self) -> Coulomb:
        if not np.any(self.tension):
            return self
        new = copy(self)
        tension = np.where(self.tension, _ENDLESS, 0.0)
        object.__setattr__(new, "tension", tension if tension.ndim else _ENDLESS)
        return new

    @override
    def overload(self, traction: ndarray, internal: ndarray) -> ndarray:
        whole = (internal[0] == 0.0) & (np.asarray(self.tension) > 0.0)
        strength = np.where(whole, self.tension, np.inf)
        return np.asarray(np.maximum(traction[0], 0.0) / strength)


@dataclass(frozen=True, eq=False)
class Tied(InterfaceLaw):
    r"""Bond of bodies that are meshed apart: :math:`t_N = \epsilon_N g` both ways, and no slip.

    Slave points that lie within half a segment of the master at the start are tied as they are
    meshed.

    Examples
    --------
    >>> import numpy as np
    >>> from skfem_contact import Tied
    >>> jump = np.array([[1e-3], [0.]])
    >>> float(Tied().update(jump, np.zeros((0, 1)), (1e4, 1e4)).traction[0, 0])
    10.0
    """

    bonds = True

    @override
    def reaches(self, gap: ndarray, internal: ndarray, closed: ndarray) -> ndarray:
        return closed

    @override
    def update(self, jump: ndarray, internal: ndarray, penalty: tuple[float, float]) -> LawUpdate:
        dim, n = jump.shape
        stiffness = np.empty_like(jump)
        stiffness[0], stiffness[1:] = penalty
        tangent = np.zeros((dim, dim, n))
        tangent[np.arange(dim), np.arange(dim)] = stiffness
        status = np.full(n, int(Status.STICK))
        return LawUpdate(stiffness * jump, internal, tangent, jump[1:].copy(), status)
