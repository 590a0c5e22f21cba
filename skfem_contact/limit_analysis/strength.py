r"""Strength of soil and of joints: second-order cones for the solver, closed forms for the
certificates.

Both obey two conditions on a mean stress p = k . s and a shear stress r = \|R s\|, with the factor
F of strength:

.. math:: \sqrt{F^2 + w t^2}\, r \le c - t p, \qquad F (p + w r) \le T.

Soil in plane strain has :math:`w = 1`, the centre p and the radius r of Mohr's circle,
:math:`t = \tan\phi`.  A joint has :math:`w = 0`, its normal and tangential tractions, and the
friction t = mu.  A curved strength is that of several lines, each with its c and t: chords are
inside of it, tangents outside.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy import ndarray

from .triangles import Triangles

#: Friction below this is none: the change of volume is then prescribed and not bounded (measured in
#: tan phi).
FLAT = 1e-3
#: Change of volume of incompressible flow, as a share of the largest shear: round-off of its
#: projection.
INCOMPRESSIBLE = 1e-12
#: Lack of opening, as a share of the opening that the slip demands, up to which a joint yields at
#: some larger factor: corrections of all yielding joints of a pile in the ground moved it so much
#: that no upper bound was left.
_YIELDING = 0.01


@dataclass(frozen=True)
class Cones:
    r"""Second-order cones s_0 >= \|(s_1, s_2)\| of s = (h - q k.stress, R stress); h = c g, g = 1 /
    sqrt(F^2 + t^2).
    """

    at: ndarray  # point of every cone: first one cone for every point, then the second cones
    c: ndarray
    t: ndarray
    k: ndarray  # (n, 3)
    R: ndarray  # (n, 2, 3)
    whole: ndarray  # bounds of tension: q = 1 at every factor, otherwise q = g
    reduced: ndarray  # divided by the factor

    @classmethod
    def join(cls, parts: list[Cones]) -> Cones:
        """Join cones of several blocks of points."""
        return cls(
            *(
                np.concatenate([getattr(part, name) for part in parts])
                for name in cls.__annotations__
            )
        )

    def taken(self, which: ndarray) -> Cones:
        """Return some of the cones, in a given order."""
        return Cones(*(getattr(self, name)[which] for name in self.__annotations__))

    def at_factor(self, factor: float, fixed: float) -> tuple[ndarray, ndarray, ndarray, ndarray]:
        """Return G (n, 3, 3) and h of s = h - G stress, and the derivatives of h and q by the
        factor.

        Strength that is not reduced has the factor `fixed`, and its apex is nearer by that.
        """
        F = np.where(self.reduced, factor, fixed)
        g = 1.0 / np.sqrt(F**2 + self.t**2)
        by_factor = np.where(self.reduced, -F * g**3, 0.0)
        q = np.where(self.whole, 1.0, g)
        G = np.concatenate([(q[:, None] * self.k)[:, None], -self.R], axis=1)
        c = self.c / np.where(self.reduced, 1.0, fixed)
        return G, c * g, c * by_factor, np.where(self.whole, 0.0, by_factor)


@dataclass(frozen=True)
class Strength:
    """Cohesion c, friction t and tensile strength (inf: none) of n points of soil, or of one joint.

    Stresses of soil are xx, yy, xy.  Tractions of a joint are normal (tension positive),
    tangential, and an idle one.
    """

    c: ndarray
    t: ndarray
    tension: ndarray
    reduced: ndarray  # divided by the factor
    joint: bool = False
    lines: ndarray | None = (
        None  # c and t of further lines, the steepest first, (n, n_lines, 2); c = inf: none
    )
    most: ndarray | None = (
        None  # compression up to which all lines are inside of a curved strength, (n,)
    )

    @property
    def rigid(self) -> ndarray:
        """Points that never yield: c = inf."""
        return np.isinf(self.c)

    @property
    def smooth(self) -> ndarray:
        """Points that resist no shear."""
        return (self.c == 0) & (self.t == 0)

    @property
    def cut(self) -> ndarray:
        """Points whose tensile strength matters: it is below the apex c / t."""
        finite = np.isfinite(self.tension)
        below = self.t * np.where(finite, self.tension, 0.0) < self.c * (1 - 1e-12)
        return finite & (below | self.smooth)

    @property
    def resists_nothing(self) -> ndarray:
        """Points without any strength where they are free of stress."""
        return (self._all_lines[0] == 0).any(axis=0)

    @property
    def incompressible(self) -> ndarray:
        """Points whose volume is constant."""
        return (self.t == 0) & ~self.cut

    @property
    def volume(self) -> ndarray:
        """Component of strain that is the change of volume, or the opening, (3,)."""
        return np.array([1.0, 0.0 if self.joint else 1.0, 0.0])

    def at(self, points: ndarray) -> Strength:
        """Return the strength of some points."""
        lines, most = (
            None if values is None else values[points] for values in (self.lines, self.most)
        )
        return Strength(
            self.c[points],
            self.t[points],
            self.tension[points],
            self.reduced[points],
            self.joint,
            lines,
            most,
        )

    def over(self, stress: float) -> Strength:
        """Return the strength in another unit of stress."""
        lines = None if self.lines is None else self.lines / (stress, 1.0)
        most = None if self.most is None else self.most / stress
        return replace(
            self, c=self.c / stress, tension=self.tension / stress, lines=lines, most=most
        )

    @property
    def _all_lines(self) -> tuple[ndarray, ndarray]:
        """Return cohesion and friction of all lines, (n_lines, n) each: the first is c, t."""
        if self.lines is None:
            return self.c[None], self.t[None]
        c, t = self.lines.transpose(2, 1, 0)
        return np.concatenate((self.c[None], c)), np.concatenate((self.t[None], t))

    def cones(self, first: int) -> tuple[Cones, Cones]:
        """Return one cone for every point, and the second cones; the points' numbers begin at
        `first`.
        """
        n, no, zero = len(self.c), np.zeros(len(self.c), bool), np.zeros(len(self.c))
        at, k = first + np.arange(n), self.volume * (1.0 if self.joint else 0.5)
        shear = np.eye(3)[1:] if self.joint else np.array([[0.5, -0.5, 0.0], [0.0, 0.0, 1.0]])
        R = np.broadcast_to(shear, (n, 2, 3))
        # a smooth joint has no shear traction in its operator: a cone of some size holds the idle
        # dofs
        size = np.where(self.smooth & self.joint, 1.0, self.c)
        one = Cones(
            at, size, zero if self.joint else self.t, self.t[:, None] * k, R, no, self.reduced
        )
        two = Cones(
            at,
            self.tension,
            zero,
            np.broadcast_to(k, (n, 3)),
            R * (not self.joint),
            ~no,
            self.reduced,
        )
        rest = [two.taken(np.flatnonzero(self.cut))]
        for c, t in zip(*(values[1:] for values in self._all_lines)):
            line = Cones(at, c, t, t[:, None] * k, R, no, self.reduced)
            rest.append(line.taken(np.flatnonzero(np.isfinite(c))))
        return one, Cones.join(rest)

    def _invariants(self, values: ndarray) -> tuple[ndarray, ndarray]:
        """Return change of volume and largest shear of strains (n, 3), or opening and slip."""
        if self.joint:
            return values[:, 0], np.abs(values[:, 1])
        return values[:, 0] + values[:, 1], np.hypot(values[:, 0] - values[:, 1], values[:, 2])

    def factor(self, stress: ndarray, round_off: float) -> ndarray:
        """Return the largest factor that every stress (n, 3) admits: 0 for none, inf for all.

        Strength that is not reduced admits a stress at all factors or at none.
        """
        p, r = self._invariants(stress)
        if self.joint:
            r = np.where(self.smooth, 0.0, r)
        else:
            p, r = 0.5 * p, np.hypot(0.5 * (stress[:, 0] - stress[:, 1]), stress[:, 2])
        found = np.full(len(p), np.inf)
        for c, t in zip(*self._all_lines):
            left = c - t * p
            rest = left**2 - (0.0 if self.joint else (t * r) ** 2)
            none = (r <= round_off) & (left >= -round_off)
            one = np.where(left > 0, _ratio(np.sqrt(np.maximum(rest, 0.0)), r), 0.0)
            found = np.minimum(found, np.where(none, np.inf, one))
        if self.most is not None:
            found = np.where(r - p <= self.most, found, 0.0)
        pull = p if self.joint else p + r
        found = np.where(
            (pull > round_off) & self.cut, np.minimum(found, _ratio(self.tension, pull)), found
        )
        return np.where(self.reduced, found, np.where(found >= 1.0, np.inf, 0.0))

    def flow_factor(self, strain: ndarray, round_off: ndarray) -> ndarray:
        """Return the smallest factor for which every strain (n, 3) is a plastic flow: 0 for all,
        inf for none.
        """
        volume, shear = self._invariants(strain)
        root = (
            shear if self.joint else np.sqrt(np.maximum((shear - volume) * (shear + volume), 0.0))
        )
        c, t = self._all_lines
        flattest = (
            np.where(np.isfinite(c), t, np.inf).min(axis=0) if self.lines is not None else self.t
        )
        steep = np.where(volume > 0, _ratio(flattest * root, volume), np.inf)
        flat = np.where(np.abs(volume) <= INCOMPRESSIBLE * shear.max(initial=0.0), 0.0, np.inf)
        opening = np.where(volume >= -round_off, 0.0, np.inf)
        found = np.where(self.t > 0, steep, np.where(self.cut, opening, flat))
        size = np.where(self.t > 0, self.t * shear, shear) if self.joint else shear
        found = np.where((size <= round_off) & (volume >= -round_off), 0.0, found)
        return np.where(self.reduced, found, np.where(found <= 1.0, 0.0, np.inf))

    def overlap(self, strain: ndarray, factor: float) -> ndarray:
        """Return twice the opening that jumps (n, 3) lack at a factor, where they lack much; 0 in
        soil.
        """
        if not self.joint:
            return np.zeros(len(strain))
        opening, slip = self._invariants(strain)
        missing = self.t / np.where(self.reduced, factor, 1.0) * slip - opening
        return np.where(missing > _YIELDING * self.t * slip, 2.0 * missing, 0.0)

    def dissipation(self, strain: ndarray, factor: float) -> ndarray:
        """Return the largest power of admissible stresses on plastic strains (n, 3), at a
        factor.
        """
        volume, shear = self._invariants(strain)
        F = np.where(self.reduced, factor, 1.0)
        steep = self.t > 0
        sheared = np.where(
            steep, self.c / np.where(steep, self.t, 1.0) * volume, self.c / F * shear
        )
        limit = np.where(self.cut, self.tension, 0.0) / F
        if self.lines is not None:
            sheared = np.minimum(
                np.where(volume >= self.t / np.hypot(F, self.t) * shear, sheared, np.inf),
                self._of_lines(volume, shear, F),
            )
        if self.joint:
            both = limit * volume + (self.c - self.t * limit) / F * shear
        else:
            a = np.sqrt(F**2 + self.t**2)
            p = (a * limit - self.c) / (a - self.t)
            both = np.maximum(p * volume + (limit - p) * shear, limit * volume)
        return np.where(self.cut, both, sheared)

    def _of_lines(self, volume: ndarray, shear: ndarray, F: ndarray) -> ndarray:
        """Return the least dissipation that is found for a line or for two that follow each other;
        inf for none.

        Each is that of a larger strength: of the apex of a line, or of the corner of two.
        """
        c, t = self._all_lines
        order = np.argsort(t, axis=0)
        c, t = np.take_along_axis(c, order, 0), np.take_along_axis(t, order, 0)
        a = np.hypot(F, t)
        with np.errstate(invalid="ignore", divide="ignore"):
            apex = np.where(volume * a >= t * shear, c / t * volume, np.inf)
            p = (c[:-1] * a[1:] - c[1:] * a[:-1]) / (t[:-1] * a[1:] - t[1:] * a[:-1])
            r = (c[:-1] - t[:-1] * p) / a[:-1]
            between = (volume * a[:-1] >= t[:-1] * shear) & (volume * a[1:] <= t[1:] * shear)
            corner = np.where(between, p * volume + r * shear, np.inf)
        return np.nanmin(np.concatenate((apex, corner)), axis=0)


def _ratio(above: ndarray, below: ndarray) -> ndarray:
    """Return a quotient, inf where the divisor is zero."""
    return np.divide(
        above, below, out=np.full(np.broadcast(above, below).shape, np.inf), where=below != 0
    )


class Profile(NamedTuple):
    """Cohesion that varies with the coordinates, linear in every triangle."""

    elements: ndarray  # of the first mesh, (n_first,): True where it varies
    cohesion: Callable[
        [ndarray, ndarray], ndarray
    ]  # of coordinates (2, n, 3) and elements (n,) of the first mesh

    def at(self, triangles: Triangles, some: ndarray) -> tuple[ndarray, ndarray]:
        """Return those of some triangles where the cohesion varies, by position, and its values at
        their corners.
        """
        origin = triangles.origin[some]
        here = np.flatnonzero(self.elements[origin])
        x = triangles.mesh.p[:, triangles.mesh.t[:, some[here]]].swapaxes(1, 2)
        return here, self.cohesion(x, origin[here])

    def vanishes(self, triangles: Triangles) -> bool:
        """Return True if there is no cohesion at some corner."""
        return not self.at(triangles, np.arange(len(triangles.origin)))[1].all()
