r"""Strength of soil and of joints: cones for the solver, closed forms for the certificates.

Both obey two conditions on a mean stress p = k . s and a shear stress r = \|R s\|, with the factor
F of strength:

.. math:: \sqrt{F^2 + w t^2}\, r \le c - t p, \qquad F (p + w r) \le T.

Soil in plane strain has :math:`w = 1`, the centre p and the radius r of Mohr's circle,
:math:`t = \tan\phi`.  A joint has :math:`w = 0`, its normal and tangential tractions, and the
friction t = mu.  A curved strength is replaced by several lines, each with its c and t: chords are
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
#: Change of volume of incompressible flow, as a share of the largest strain: round-off of its
#: projection. Beside a joint that slips by 1, clay at rest has a shear of 1e-8. Dilation that is
#: not reduced may lack the same share.
INCOMPRESSIBLE = 1e-12


@dataclass(frozen=True)
class Cones:
    r"""Second-order cones s_0 >= \|(s_1, s_2)\| of s = (h - q k.stress, R stress).

    Here h = c g and g = 1 / sqrt(F^2 + t^2).
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
        columns = ([getattr(part, name) for part in parts] for name in cls.__annotations__)
        return cls(*map(np.concatenate, columns))

    def taken(self, which: ndarray) -> Cones:
        """Return some of the cones, in a given order."""
        return Cones(*(getattr(self, name)[which] for name in self.__annotations__))

    def at_factor(self, factor: float, fixed: float) -> tuple[ndarray, ndarray, ndarray, ndarray]:
        """Return G (n, 3, 3), h, dh/dF and dq/dF of s = h - G stress at a factor F.

        Strength that is not reduced has the factor `fixed`, and its apex is nearer by that.
        """
        # g = 1 / sqrt(F^2 + t^2), and dg/dF
        F = np.where(self.reduced, factor, fixed)
        g = 1.0 / np.sqrt(F**2 + self.t**2)
        dg = np.where(self.reduced, -F * g**3, 0.0)
        q = np.where(self.whole, 1.0, g)
        dq = np.where(self.whole, 0.0, dg)

        # the first row of G acts on the mean stress, the others on the shear
        mean = q[:, None] * self.k
        G = np.concatenate([mean[:, None], -self.R], axis=1)  # (n, 3, 3)
        divisor = np.where(self.reduced, 1.0, fixed)
        c = self.c / divisor
        return G, c * g, c * dg, dq


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
    # c and t of further lines, the steepest first, (n, n_lines, 2); c = inf: none
    lines: ndarray | None = None
    # compression up to which all lines are inside of a curved strength, (n,)
    most: ndarray | None = None

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
        return Strength(
            self.c[points],
            self.t[points],
            tension=self.tension[points],
            reduced=self.reduced[points],
            joint=self.joint,
            lines=None if self.lines is None else self.lines[points],
            most=None if self.most is None else self.most[points],
        )

    def over(self, stress: float) -> Strength:
        """Return the strength in another unit of stress."""
        return replace(
            self,
            c=self.c / stress,
            tension=self.tension / stress,
            lines=None if self.lines is None else self.lines / (stress, 1.0),
            most=None if self.most is None else self.most / stress,
        )

    @property
    def _all_lines(self) -> tuple[ndarray, ndarray]:
        """Return cohesion and friction of all lines, (n_lines, n) each: the first is c, t."""
        if self.lines is None:
            return self.c[None], self.t[None]
        c, t = self.lines.transpose(2, 1, 0)
        return np.concatenate((self.c[None], c)), np.concatenate((self.t[None], t))

    def cones(self, first: int) -> tuple[Cones, Cones]:
        """Return one cone for every point, numbered from `first`, and the second cones."""
        n = len(self.c)
        at = first + np.arange(n)
        zero = np.zeros(n)
        no = np.zeros(n, bool)
        if self.joint:
            k = self.volume
            shear = np.eye(3)[1:]
        else:
            k = 0.5 * self.volume
            shear = np.array([[0.5, -0.5, 0.0], [0.0, 0.0, 1.0]])
        R = np.broadcast_to(shear, (n, 2, 3))

        # a smooth joint has no shear traction: a cone of some size holds its idle dofs
        size = np.where(self.smooth & self.joint, 1.0, self.c)
        friction = self.t
        if self.joint:
            friction = zero
        every = Cones(
            at,
            size,
            friction,
            self.t[:, None] * k,
            R,
            whole=no,
            reduced=self.reduced,
        )

        # a tensile strength and further lines of the strength have cones of their own
        tension = Cones(
            at,
            self.tension,
            zero,
            k=np.broadcast_to(k, (n, 3)),
            R=R * (not self.joint),
            whole=~no,
            reduced=self.reduced,
        )
        second = [tension.taken(np.flatnonzero(self.cut))]
        for c, t in zip(*(values[1:] for values in self._all_lines)):
            line = Cones(
                at,
                c,
                t,
                t[:, None] * k,
                R,
                whole=no,
                reduced=self.reduced,
            )
            second.append(line.taken(np.flatnonzero(np.isfinite(c))))
        return every, Cones.join(second)

    def _invariants(self, values: ndarray) -> tuple[ndarray, ndarray]:
        """Return change of volume and largest shear of strains (n, 3), or opening and slip."""
        if self.joint:
            return values[:, 0], np.abs(values[:, 1])
        volume = values[:, 0] + values[:, 1]
        shear = np.hypot(values[:, 0] - values[:, 1], values[:, 2])
        return volume, shear

    def factor(self, stress: ndarray, round_off: float) -> ndarray:
        """Return the largest factor that every stress (n, 3) admits: 0 for none, inf for all.

        Strength that is not reduced admits a stress at all factors or at none.
        """
        # centre and radius of Mohr's circle, or normal and tangential traction
        p, r = self._invariants(stress)
        if self.joint:
            r = np.where(self.smooth, 0.0, r)
        else:
            p = 0.5 * p
            r = np.hypot(0.5 * (stress[:, 0] - stress[:, 1]), stress[:, 2])

        # F^2 = ((c - t p)^2 - w (t r)^2) / r^2 of the line that admits least
        result = np.full(len(p), np.inf)
        for c, t in zip(*self._all_lines):
            resistance = c - t * p
            square = resistance**2
            if not self.joint:
                square -= (t * r) ** 2
            root = np.sqrt(np.maximum(square, 0.0))
            factor = np.where(resistance > 0, _ratio(root, r), 0.0)
            unloaded = (r <= round_off) & (resistance >= -round_off)
            result = np.minimum(result, np.where(unloaded, np.inf, factor))
        if self.most is not None:
            result = np.where(r - p <= self.most, result, 0.0)

        # F = T / (p + w r)
        pull = p
        if not self.joint:
            pull = p + r
        torn = np.minimum(result, _ratio(self.tension, pull))
        result = np.where((pull > round_off) & self.cut, torn, result)
        return np.where(self.reduced, result, np.where(result >= 1.0, np.inf, 0.0))

    def flow_factor(self, strain: ndarray, round_off: ndarray, largest: float) -> ndarray:
        """Return the smallest factor at which every strain (n, 3) is a plastic flow, 0 to inf.

        Round-off of changes of volume is a share of the largest strain, of soil and joints.
        The flow of soil has F volume >= t sqrt(shear^2 - volume^2), of a joint F opening >= t slip.
        """
        volume, shear = self._invariants(strain)
        root = shear
        if not self.joint:
            square = (shear - volume) * (shear + volume)
            root = np.sqrt(np.maximum(square, 0.0))
        flattest = self.t
        if self.lines is not None:
            c, t = self._all_lines
            flattest = np.where(np.isfinite(c), t, np.inf).min(axis=0)

        # with friction, with a tensile strength, and of constant volume
        steep = np.where(volume > 0, _ratio(flattest * root, volume), np.inf)
        opening = np.where(volume >= -round_off, 0.0, np.inf)
        isochoric = np.abs(volume) <= INCOMPRESSIBLE * largest
        flat = np.where(isochoric, 0.0, np.inf)
        factor = np.where(self.cut, opening, flat)
        factor = np.where(self.t > 0, steep, factor)

        # no flow but round-off
        size = shear
        if self.joint:
            size = np.where(self.t > 0, self.t * shear, shear)
        none = (size <= round_off) & (volume >= -round_off)
        factor = np.where(none, 0.0, factor)
        at_all = np.where(factor <= 1.0 + INCOMPRESSIBLE, 0.0, np.inf)
        return np.where(self.reduced, factor, at_all)

    def overlap(self, strain: ndarray, factor: float, lack: float) -> ndarray:
        """Return twice the opening that jumps (n, 3) lack, beyond a share of it; 0 in soil."""
        if not self.joint:
            return np.zeros(len(strain))
        opening, slip = self._invariants(strain)
        missing = self.t / np.where(self.reduced, factor, 1.0) * slip - opening
        return np.where(missing > lack * self.t * slip, 2.0 * missing, 0.0)

    def dissipation(self, strain: ndarray, factor: float) -> ndarray:
        r"""Return the largest power of admissible stresses on plastic strains (n, 3), at a factor.

        A line dissipates :math:`c / t\, \dot\varepsilon_V`, or :math:`c / F\, \dot\gamma` without
        friction. With a tensile strength it is the power at the corner of line and limit,
        :math:`p\, \dot\varepsilon_V + r\, \dot\gamma`.
        """
        # dissipate by one line, or by further lines
        volume, shear = self._invariants(strain)
        F = np.where(self.reduced, factor, 1.0)
        steep = self.t > 0
        t = np.where(steep, self.t, 1.0)
        sheared = np.where(steep, self.c / t * volume, self.c / F * shear)
        if self.lines is not None:
            inside = volume >= self.t / np.hypot(F, self.t) * shear
            first = np.where(inside, sheared, np.inf)
            sheared = np.minimum(first, self._of_lines(volume, shear, F))

        # dissipate at the tensile strength
        limit = np.where(self.cut, self.tension, 0.0) / F
        if self.joint:
            torn = limit * volume + (self.c - self.t * limit) / F * shear
        else:
            a = np.sqrt(F**2 + self.t**2)
            p = (a * limit - self.c) / (a - self.t)  # at the corner, where r = limit - p
            at_corner = p * volume + (limit - p) * shear
            torn = np.maximum(at_corner, limit * volume)
        return np.where(self.cut, torn, sheared)

    def _of_lines(self, volume: ndarray, shear: ndarray, F: ndarray) -> ndarray:
        """Return the least dissipation by one line or two neighbours, inf for none.

        Each belongs to a larger strength: to the apex of a line, or to the corner of two.
        """
        # sort the lines by their slopes
        c, t = self._all_lines
        order = np.argsort(t, axis=0)
        c = np.take_along_axis(c, order, 0)
        t = np.take_along_axis(t, order, 0)
        a = np.hypot(F, t)
        c1, t1, a1 = (values[:-1] for values in (c, t, a))
        c2, t2, a2 = (values[1:] for values in (c, t, a))
        with np.errstate(invalid="ignore", divide="ignore"):
            # the apex of a line, p = c / t, has no shear
            steeper = volume * a >= t * shear
            apex = np.where(steeper, c / t * volume, np.inf)

            # the corner of two lines lies on both, a r = c - t p
            p = (c1 * a2 - c2 * a1) / (t1 * a2 - t2 * a1)
            r = (c1 - t1 * p) / a1
            between = steeper[:-1] & (volume * a2 <= t2 * shear)
            corner = np.where(between, p * volume + r * shear, np.inf)
        powers = np.concatenate((apex, corner))
        return np.nanmin(powers, axis=0)


def _ratio(above: ndarray, below: ndarray) -> ndarray:
    """Return a quotient, inf where the divisor is zero."""
    result = np.full(np.broadcast(above, below).shape, np.inf)
    return np.divide(above, below, out=result, where=below != 0)


class Profile(NamedTuple):
    """Cohesion that varies with the coordinates, linear in every triangle."""

    elements: ndarray  # of the first mesh, (n_first,): True where it varies
    # of coordinates (2, n, 3) and elements (n,) of the first mesh
    cohesion: Callable[[ndarray, ndarray], ndarray]

    def at(self, triangles: Triangles, some: ndarray) -> tuple[ndarray, ndarray]:
        """Return positions among some triangles where the cohesion varies, and corner values."""
        origin = triangles.origin[some]
        varies = np.flatnonzero(self.elements[origin])
        corners = triangles.mesh.t[:, some[varies]]
        x = triangles.mesh.p[:, corners].swapaxes(1, 2)  # (2, n, 3)
        return varies, self.cohesion(x, origin[varies])

    def vanishes(self, triangles: Triangles) -> bool:
        """Return True if the cohesion is zero at some corner."""
        return not self.at(triangles, np.arange(len(triangles.origin)))[1].all()
