r"""Yield surfaces of soil and of interfaces: as cones for the solver, and in closed form for the certificates.

Soil of cohesion c, :math:`t = \tan\phi` and tensile strength T in plane strain, with the mean p and the radius r of
Mohr's circle, both c and t and T divided by the factor F:

.. math:: \sqrt{F^2 + t^2}\, r \le c - t p, \qquad p + r \le T / F.

An interface with adhesion a, friction :math:`\mu` and tensile strength T:
:math:`F |t_t| \le a - \mu t_n`, :math:`F t_n \le T`.
"""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray

#: Friction below this is none: the change of volume is then prescribed and not bounded (measured in tan phi).
FLAT = 1e-3
#: Change of volume of what must keep it, as a share of the largest shear: round-off of its projection.
INCOMPRESSIBLE = 1e-12
#: Lack of opening, as a share of what the slip asks for, up to which an interface yields at some larger factor: with
#: all of it taken out the yielding ones of a pile in the ground moved so much that no upper bound was left.
_YIELDING = 0.01


@dataclass(frozen=True)
class Cones:
    r"""Second-order cones: with the stress of a point, s = (h - q k.stress, R stress), and s_0 >= \|(s_1, s_2)\|.

    Attributes
    ----------
    at
        Point of every cone; the first are one for every point, the others are the second of theirs.
    c, t
        h = c g and q = g with g = 1 / sqrt(F^2 + t^2).
    k, R
        (n, 3) and (n, 2, 3).
    whole
        Whether q is one whatever the factor: a bound of tension.
    reduced
        Whether the factor acts.
    """

    at: ndarray
    c: ndarray
    t: ndarray
    k: ndarray
    R: ndarray
    whole: ndarray
    reduced: ndarray

    @classmethod
    def join(cls, parts: list[Cones]) -> Cones:
        """Cones of several blocks of points."""
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in cls.__annotations__))

    def taken(self, which: ndarray) -> Cones:
        """Some of them, in a given order."""
        return Cones(*(getattr(self, name)[which] for name in self.__annotations__))

    def at_factor(self, factor: float, fixed: float) -> tuple[ndarray, ndarray, ndarray, ndarray]:
        """G (n, 3, 3) and h (n,) of s = h - G stress, and the derivatives of h and of q (n,) by the factor.

        Parameters
        ----------
        factor
            By which the strength is divided.
        fixed
            The same for strength that is not reduced.
        """
        F = np.where(self.reduced, factor, fixed)
        g = 1.0 / np.sqrt(F**2 + self.t**2)
        by_factor = np.where(self.reduced, -F * g**3, 0.0)
        q = np.where(self.whole, 1.0, g)
        G = np.concatenate([(q[:, None] * self.k)[:, None], -self.R], axis=1)
        return G, self.c * g, self.c * by_factor, np.where(self.whole, 0.0, by_factor)


@dataclass(frozen=True)
class Soil:
    """Mohr-Coulomb soil in plane strain, of n points or elements; stresses are xx, yy, xy.

    Attributes
    ----------
    c, t, tension
        Cohesion, tan phi, and tensile strength (inf without), (n,).
    reduced
        Whether the factor acts, (n,).
    """

    c: ndarray
    t: ndarray
    tension: ndarray
    reduced: ndarray

    volume = np.array([1.0, 1.0, 0.0])
    _shear = np.array([[0.5, -0.5, 0.0], [0.0, 0.0, 1.0]])

    @property
    def rigid(self) -> ndarray:
        """Where nothing makes it yield: c = inf."""
        return np.isinf(self.c)

    def at(self, points: ndarray) -> Soil:
        """That of some of its points."""
        return Soil(self.c[points], self.t[points], self.tension[points], self.reduced[points])

    def over(self, stress: float) -> Soil:
        """The same in another unit of stress."""
        return replace(self, c=self.c / stress, tension=self.tension / stress)

    @property
    def cut(self) -> ndarray:
        """Where the tensile strength matters: it is below the apex c / tan phi."""
        return _below_apex(self.tension, self.t, self.c)

    def cones(self, first: int) -> tuple[Cones, Cones]:
        """One for every point, and the second ones; the points' numbers begin at `first`."""
        n, cut = len(self.c), self.cut
        mean, no = np.array([0.5, 0.5, 0.0]), np.zeros(n, bool)
        shear = np.broadcast_to(self._shear, (n, 2, 3))
        at = first + np.arange(n)
        one = Cones(at, self.c, self.t, self.t[:, None] * mean, shear, no, self.reduced)
        two = Cones(at, self.tension, np.zeros(n), np.broadcast_to(mean, (n, 3)), shear, ~no, self.reduced)
        return one, two.taken(np.flatnonzero(cut))

    def factor(self, stress: ndarray, round_off: float) -> ndarray:
        """Largest factor that every stress (n, 3) admits: 0 for none, inf for all; of fixed strength 0 or inf."""
        p, r = 0.5 * (stress[:, 0] + stress[:, 1]), np.hypot(0.5 * (stress[:, 0] - stress[:, 1]), stress[:, 2])
        left = self.c - self.t * p
        rest = left**2 - (self.t * r) ** 2
        none = (r <= round_off) & (left >= -round_off)
        found = np.where(none, np.inf, _ratio(np.sqrt(np.maximum(rest, 0.0)), r) * (left > 0))
        pulled = (p + r > round_off) & self.cut
        found = np.where(pulled, np.minimum(found, _ratio(self.tension, p + r)), found)
        return np.where(self.reduced, found, np.where(found >= 1.0, np.inf, 0.0))

    def flow_factor(self, strain: ndarray, round_off: ndarray) -> ndarray:
        """Smallest factor for which every strain (n, 3) is a plastic flow: 0 for all, inf for none."""
        volume, shear = _circle(strain)
        none = (shear <= round_off) & (volume >= -round_off)
        root = np.sqrt(np.maximum((shear - volume) * (shear + volume), 0.0))
        steep = np.where(volume > 0, _ratio(self.t * root, volume), np.inf)
        flat = np.where(np.abs(volume) <= INCOMPRESSIBLE * shear.max(initial=0.0), 0.0, np.inf)
        opening = np.where(volume >= -round_off, 0.0, np.inf)
        found = np.where(self.t >= FLAT, steep, np.where(self.cut, opening, flat))
        found = np.where(none, 0.0, found)
        return np.where(self.reduced, found, np.where(found <= 1.0, 0.0, np.inf))

    def overlap(self, strain: ndarray, factor: float) -> ndarray:
        """None: triangles do not part."""
        return np.zeros(len(strain))

    def dissipation(self, strain: ndarray, factor: float) -> ndarray:
        """Largest power of admissible stresses on plastic strains (n, 3), at a factor."""
        volume, shear = _circle(strain)
        F = np.where(self.reduced, factor, 1.0)
        steep = self.t >= FLAT
        sheared = np.where(steep, self.c / np.where(steep, self.t, 1.0) * volume, self.c / F * shear)
        a, limit = np.sqrt(F**2 + self.t**2), np.where(self.cut, self.tension, 0.0) / F
        p = (a * limit - self.c) / (a - self.t)
        both = np.maximum(p * volume + (limit - p) * shear, limit * volume)
        return np.where(self.cut, both, sheared)


@dataclass(frozen=True)
class Interface:
    """Coulomb friction with adhesion at n points; tractions are normal (tension positive), tangential, and an idle one.

    Attributes
    ----------
    a, mu, tension
        Adhesion, coefficient of friction and tensile strength, (n,).
    reduced
        Whether the factor acts, (n,).
    """

    a: ndarray
    mu: ndarray
    tension: ndarray
    reduced: ndarray

    volume = np.array([1.0, 0.0, 0.0])

    @property
    def smooth(self) -> ndarray:
        """Where no shear traction is borne at all."""
        return (self.a == 0) & (self.mu == 0)

    @property
    def t(self) -> ndarray:
        """What bounds the opening by the slip."""
        return np.where(self.smooth, 0.0, self.mu)

    @property
    def cut(self) -> ndarray:
        """Where the tensile strength matters."""
        return _below_apex(self.tension, self.mu, self.a) | self.smooth

    def cones(self, first: int) -> tuple[Cones, Cones]:
        """One for every point, and the second ones; the points' numbers begin at `first`."""
        n, cut, no = len(self.a), self.cut, np.zeros(len(self.a), bool)
        at, zero = first + np.arange(n), np.zeros(n)
        k, R = self.mu[:, None] * self.volume, np.broadcast_to(np.eye(3)[1:], (n, 2, 3))
        # what is smooth has no shear traction in its operator: a cone of some size holds the idle unknowns
        size = np.where(self.smooth, 1.0, self.a)
        one = Cones(at, size, zero, k, R, no, self.reduced)
        normal = np.broadcast_to(self.volume, (n, 3))
        two = Cones(at, self.tension, zero, normal, np.zeros((n, 2, 3)), ~no, self.reduced)
        return one, two.taken(np.flatnonzero(cut))

    def factor(self, stress: ndarray, round_off: float) -> ndarray:
        """Largest factor that every traction (n, 3) admits: 0 for none, inf for all; of fixed strength 0 or inf."""
        normal, shear = stress[:, 0], np.where(self.smooth, 0.0, np.abs(stress[:, 1]))
        left = self.a - self.mu * normal
        none = (shear <= round_off) & (left >= -round_off)
        found = np.where(none, np.inf, np.maximum(_ratio(left, shear), 0.0))
        pulled = (normal > round_off) & self.cut
        found = np.where(pulled, np.minimum(found, _ratio(self.tension, normal)), found)
        return np.where(self.reduced, found, np.where(found >= 1.0, np.inf, 0.0))

    def flow_factor(self, strain: ndarray, round_off: ndarray) -> ndarray:
        """Smallest factor for which every jump (n, 3) is a plastic flow: 0 for all, inf for none."""
        opening, slip = strain[:, 0], np.where(self.smooth, 0.0, np.abs(strain[:, 1]))
        needed = self.t * slip
        found = np.where(needed > round_off, np.where(opening > 0, _ratio(needed, opening), np.inf), 0.0)
        found = np.where(opening < -round_off, np.inf, found)
        return np.where(self.reduced, found, np.where(found <= 1.0, 0.0, np.inf))

    def overlap(self, strain: ndarray, factor: float) -> ndarray:
        """Twice the opening that jumps (n, 3) lack at a factor; where they lack little the factor of the flow rises."""
        slip = np.where(self.smooth, 0.0, np.abs(strain[:, 1]))
        missing = self.t / np.where(self.reduced, factor, 1.0) * slip - strain[:, 0]
        return np.where(missing > _YIELDING * self.t * slip, 2.0 * missing, 0.0)

    def dissipation(self, strain: ndarray, factor: float) -> ndarray:
        """Largest power of admissible tractions on plastic jumps (n, 3), at a factor."""
        opening, slip = strain[:, 0], np.abs(strain[:, 1])
        F = np.where(self.reduced, factor, 1.0)
        limit = np.where(self.cut, self.tension, 0.0) / F
        both = limit * opening + np.where(self.smooth, 0.0, (self.a - self.mu * limit) / F * slip)
        return np.where(self.cut, both, self.a / np.where(self.mu > 0, self.mu, 1.0) * opening)


Strength = Soil | Interface


def _below_apex(tension: ndarray, friction: ndarray, cohesion: ndarray) -> ndarray:
    """Where a tensile strength is less than cohesion over friction."""
    finite = np.where(np.isfinite(tension), tension, 0.0)
    return np.isfinite(tension) & (friction * finite < cohesion * (1 - 1e-12))


def _circle(strain: ndarray) -> tuple[ndarray, ndarray]:
    """Change of volume and diameter of Mohr's circle of strains (n, 3)."""
    return strain[:, 0] + strain[:, 1], np.hypot(strain[:, 0] - strain[:, 1], strain[:, 2])


def _ratio(above: ndarray, below: ndarray) -> ndarray:
    """A quotient, inf where nothing is below."""
    return np.divide(above, below, out=np.full(np.broadcast(above, below).shape, np.inf), where=below != 0)
