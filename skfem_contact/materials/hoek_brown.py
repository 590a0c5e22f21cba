"""Hoek-Brown strength of rock masses: return of Mohr-Coulomb to a tangent.

With s1 >= s2 >= s3, tension positive, the yield function is s1 - s3 - sigma_ci t^a with t = s - m_b
s1 / sigma_ci. The return runs along a line, on an edge of the meeting stresses' mean, on which t
and s1 - s3 are linear. With u = t^a the yield condition is u + b u^(1/a) = A: it is convex, and
Newton's method from u = A falls to the root. The tangent touches at the returned stress; its
sin(phi) and strength define the pyramid of Mohr-Coulomb that gives stress, edge, apex and moduli.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from typing_extensions import override

from ..errors import IncrementTooLarge
from .base import (
    Array,
    Flow,
    Given,
    Parameter,
    along_elements,
    check_reduction,
    require,
    warn_of_radians,
)
from .curved import APEX, IMAGINARY, Tangent, falling_root, lines_of, tangent
from .plastic import ROUND_OFF, IsotropicPlasticity, Return, chosen
from .pyramid import PyramidConstants, edge_weights, pyramid_return
from .spectral import extremes, principal_stresses

#: Iterations for the root: 2 to 4 are needed for strain increments of 1e-6 to 1e-1, 12 where the
#: dilatancy is capped.
_MOST = 100
#: A step of the root by this share is the last: the next one would be its square, 1e-16.
_LAST = 1e-8
#: Excess over the yield surface after a return, as a share of the largest trial stress, that is
#: refused.
_ADMITTED = 1e-9
#: Dilatancy in degrees that the cap always replaces by the friction of the tangent.
_ASSOCIATED = 89.999999


class _Constants(NamedTuple):
    """Constants of the law: floats, or arrays over elements or points; ``ci`` is sigma_ci."""

    lam: Parameter
    mu: Parameter
    sin_psi: Parameter
    ci: Parameter
    m_b: Parameter
    s: Parameter
    a: Parameter
    factor: Parameter  # of the reduction


class _Line(NamedTuple):
    """Return line of averaged stresses: the extremes of the trial, and the weights of the edge."""

    s1: Array
    s3: Array
    w1: Parameter
    w3: Parameter


@dataclass(frozen=True, eq=False)
class HoekBrown(IsotropicPlasticity):
    r"""Linear elasticity, perfect plasticity with the generalised Hoek-Brown strength.

    With the principal stresses :math:`\sigma_1 \ge \sigma_2 \ge \sigma_3`, tension positive, the
    strength is
    :math:`\sigma_1 - \sigma_3 = \sigma_{ci} (s - m_b \sigma_1 / \sigma_{ci})^a`. The flow follows
    Mohr-Coulomb's potential; the friction angle of the tangent falls with the pressure, and caps
    the dilatancy angle. A strength reduction divides the shear strength on every plane, so that c
    and tan(phi) of every tangent are divided; bounds have chords and tangents. E. Hoek, C.
    Carranza-Torres, B. Corkum, Proc. NARMS-TAC (2002) 267-273; J. Clausen, L. Damkilde, Int. J.
    Rock Mech. Min. Sci. 45 (2008) 831-847.

    Parameters
    ----------
    E, nu : float or ndarray
        As in :class:`LinearElastic`.
    sigma_ci : float or ndarray
        Uniaxial compressive strength of the intact rock (stress); like all parameters a float or
        one value an element.
    m_b, s, a : float or ndarray
        Constants of the rock mass, m_b > 0, 0 <= s <= 1 and 0.5 <= a < 1.
    psi : float or ndarray
        Dilatancy angle in degrees, 0 <= psi < 90.

    Examples
    --------
    >>> import skfem_contact as sc
    >>> rock = sc.HoekBrown(E=5.7e6, nu=0.25, sigma_ci=30e3, m_b=1.7, s=0.0039, a=0.51)
    >>> test = sc.element_test(rock, -1e3, sc.laboratory.triaxial(-0.01))
    >>> test.q[-1].round(3)
    array([7178.942])
    """

    sigma_ci: Given
    m_b: Given
    s: Given
    a: Given = 0.5
    psi: Given = 0.0
    factor: float = field(default=1.0, init=False, repr=False)  # of the reduction

    @override
    def _check(self) -> None:
        super()._check()
        self._positive("sigma_ci", "m_b")
        s_in_range = np.greater_equal(self.s, 0) & np.less_equal(self.s, 1)
        require("s", self.s, s_in_range, "lie between 0 and 1")
        a_in_range = np.greater_equal(self.a, 0.5) & np.less(self.a, 1)
        require("a", self.a, a_in_range, "lie in [0.5, 1)")
        self._angle("psi")
        warn_of_radians(psi=self.psi)

    @classmethod
    def from_gsi(
        cls,
        E: Parameter,
        nu: Parameter,
        sigma_ci: Parameter,
        m_i: Parameter,
        gsi: Parameter,
        disturbance: Parameter = 0.0,
        psi: Parameter = 0.0,
    ) -> HoekBrown:
        """Return the rock mass of a geological strength index by the equations of 2002.

        Parameters
        ----------
        E, nu, sigma_ci, psi
            As in the class.
        m_i
            Constant of the intact rock, 4 to 33.
        gsi
            Geological strength index, above 0 and at most 100.
        disturbance
            Factor D of blasting and relaxation, 0 to 1.

        Examples
        --------
        >>> import skfem_contact as sc
        >>> rock = sc.HoekBrown.from_gsi(E=5.7e6, nu=0.25, sigma_ci=30e3, m_i=10.0, gsi=50.0)
        >>> round(rock.m_b, 4), round(rock.s, 6), round(rock.a, 4)
        (1.6768, 0.003866, 0.5057)
        """
        index = np.asarray(gsi, dtype=float)
        D = np.asarray(disturbance, dtype=float)
        known = (index > 0) & (index <= 100)
        require("gsi", index, known, "be above 0 and at most 100")
        require("disturbance", D, (D >= 0) & (D <= 1), "lie between 0 and 1")
        require("m_i", m_i, np.greater(m_i, 0), "be positive")

        # Equations 3 to 5 of Hoek, Carranza-Torres and Corkum (2002)
        fractured = index - 100
        m_b = np.asarray(m_i) * np.exp(fractured / (28 - 14 * D))
        s = np.exp(fractured / (9 - 3 * D))
        decay = np.exp(-index / 15) - np.exp(-20 / 3)
        a = 0.5 + decay / 6
        return cls(
            E,
            nu,
            sigma_ci,
            m_b,
            s,
            a,
            psi,
        )

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> HoekBrown:
        check_reduction(factor, flow, self)
        if flow not in ("given", "associated"):
            raise ValueError(
                f"flow '{flow}' needs one friction angle: HoekBrown has 'given' and 'associated'"
            )
        psi = _ASSOCIATED
        if flow == "given":
            psi = self.psi
        return self._with(factor=self.factor * factor, psi=psi)

    @override
    def lines(
        self,
        stress: float,
        inner: bool = True,
        flow: Flow = "associated",
    ) -> tuple[Array, Array]:
        constants = _Constants(*map(np.atleast_1d, self.constants()))
        return lines_of(constants, stress, inner, flow)

    @property
    @override
    def dilates(self) -> bool:
        return bool(np.any(np.greater(self.psi, 0.0)))

    @property
    @override
    def dilates_less(self) -> bool:
        return bool(np.any(np.less(self.psi, _ASSOCIATED)))

    @property
    @override
    def tensile_strength(self) -> Parameter:
        return self.s * self.sigma_ci / self.m_b

    @override
    def mobilised(self, stress: Array, internal: Array) -> tuple[Array, Array]:
        largest, _, smallest = principal_stresses(stress)
        k = _Constants(*(along_elements(value, stress.shape) for value in self.constants()))
        difference = largest - smallest
        return 0.5 * difference, 0.5 * (difference - _excess(largest, smallest, k))

    @override
    def constants(self) -> _Constants:
        return _Constants(
            *self.lame,
            sin_psi=np.sin(np.radians(self.psi)),
            ci=self.sigma_ci,
            m_b=self.m_b,
            s=self.s,
            a=self.a,
            factor=self.factor,
        )

    @override
    def yield_bound(self, stress: Array, constants: _Constants) -> Array:
        return _excess(*extremes(stress), constants)

    @override
    def yield_function(self, values: Array, constants: _Constants) -> Array:
        return _excess(values[0], values[2], constants)

    @override
    def return_map(self, trial: Array, constants: _Constants) -> Return:
        # Return to the pyramid of the tangent.
        cone, weights, t = _tangent_cone(trial, constants)
        new = pyramid_return(trial, cone)

        # Refuse stresses that are not on the strength.
        first, _, last = new.values
        largest = np.maximum(trial[0], -trial[2])
        error = np.abs(_excess(first, last, constants))
        failed = error > _ADMITTED * largest
        failed &= first - last > ROUND_OFF * largest
        if failed.any():
            # Near the apex the strength is steep: its error is the error of s1 times the slope.
            slope = constants.a * constants.m_b * np.maximum(t, APEX) ** (constants.a - 1)
            failed &= error > _ADMITTED * (1 + slope) * largest
        if failed.any():
            raise IncrementTooLarge(
                f"the return to the strength of Hoek and Brown fails at {failed.sum()} points"
            )

        def moduli() -> Array:
            result = new.moduli()
            points = np.flatnonzero(cone.sin_psi < constants.sin_psi)
            if points.size:
                change = _change_of_flow(
                    trial[:, points],
                    new.values[:, points],
                    sine=np.asarray(cone.sin_psi)[points],
                    weights=(weights[0][points], weights[1][points]),
                    t=t[points],
                    k=chosen(constants, points),
                )
                result[:, :, points] += change[:, None] * result[0][:, points]
            return result

        return Return(new.values, moduli)


def _excess(largest: Array, smallest: Array, k: _Constants) -> Array:
    """Return the yield function of extreme stresses, beyond the apex with the distance to it."""
    t = k.s - k.m_b * largest / k.ci
    if np.all(np.equal(k.factor, 1.0)):
        strength = k.ci * np.maximum(t, 0.0) ** k.a
    else:

        def beyond(t: Any) -> Array:
            return tangent(t, k).s1 - largest

        # Find the tangent that touches at the largest stress.
        touching = tangent(falling_root(beyond, np.maximum(t, APEX)), k)
        strength = np.where(t > 0, largest - touching.s3, 0.0)
    beyond_apex = np.maximum(-t, 0.0) * k.ci / k.m_b
    return largest - smallest - strength + beyond_apex


def _directions(line: _Line, sine: Array, k: _Constants) -> tuple[Array, Array]:
    """Return by how much a unit of flow with a dilatancy lowers s1 and s3."""
    volume = 2 * k.lam * sine
    d1 = volume + 2 * k.mu * (1 + sine) * line.w1
    d3 = volume - 2 * k.mu * (1 - sine) * line.w3
    return d1, d3


def _middle(first: Array, middle: Parameter, last: Array, weights: tuple[Array, Array]) -> Array:
    """Return values of the middle stress, which on an edge equals the first or the last one."""
    w1, w3 = weights
    return np.where(w3 < 1, last, np.where(w1 < 1, first, middle))


def _convex_root(A: Array, b: Array, a: Parameter) -> Array:
    """Return the root u of u + b u^(1/a) = A, from the root for a = 1/2 by Newton's method."""
    u = 2 * A / (1 + np.sqrt(1 + 4 * b * A))
    if np.all(np.equal(a, 0.5)):
        return u
    for _ in range(_MOST):
        power = b * u ** (1 / a - 1)
        step = (u + power * u - A) / (1 + power / a)
        u = np.maximum(u - step, 0.0)
        if np.all(np.abs(step) <= _LAST * u):
            break
    return u


def _touch(line: _Line, k: _Constants) -> tuple[Array, Array, Tangent]:
    """Return t, the sine of the dilatancy and the tangent where the return along a line ends.

    On the line s1 - s3 = ci (A - b t), and on the strength ci u with u = t^a.
    """
    # Return to the whole strength with the given dilatancy.
    sine = np.broadcast_to(k.sin_psi, line.s1.shape)
    d1, d3 = _directions(line, sine, k)
    t = k.s - k.m_b * line.s1 / k.ci
    b = (d1 - d3) / (k.m_b * d1)
    A = np.maximum((line.s1 - line.s3) / k.ci + b * t, 0.0)
    t = _convex_root(A, b, k.a) ** (1 / k.a)
    touching = tangent(np.maximum(t, APEX), k)

    # Return anew where the strength is reduced, or the dilatancy exceeds the friction.
    reduced = np.not_equal(k.factor, 1.0)
    points = np.flatnonzero(reduced | (sine > touching.sine))
    if points.size:
        sine = sine.copy()
        some = chosen(line, points)
        t[points], sine[points] = _touch_capped(some, t[points], chosen(k, points))
        touching = tangent(np.maximum(t, APEX), k)
    return t, sine, touching


def _touch_capped(line: _Line, start: Array, k: _Constants) -> tuple[Array, Array]:
    """Return t and the sine of the dilatancy, at most the friction, from a start nearby."""

    def capped(t: Any) -> Array:
        sine = tangent(t, k).sine
        return np.where(sine.real < k.sin_psi, sine, k.sin_psi)

    def beyond(t: Any) -> Array:
        d1, d3 = _directions(line, capped(t), k)
        touching = tangent(t, k)
        return (line.s1 - touching.s1) * d3 - (line.s3 - touching.s3) * d1

    t = falling_root(beyond, start)
    return t, capped(t)


def _tangent_cone(
    trial: Array, k: _Constants
) -> tuple[PyramidConstants, tuple[Array, Array], Array]:
    """Return the pyramid of the tangent at the returned stresses, weights of the edges, and t."""
    # Return to the face.
    w1 = np.ones(trial.shape[1])
    w3 = np.ones(trial.shape[1])
    face = _Line(trial[0], trial[2], w1, w3)
    t, sine, (first, last, sin_phi) = _touch(face, k)
    d1, d3 = _directions(face, sine, k)
    length = (trial[0] - first) / d1
    s1 = trial[0] - length * d1
    s2 = trial[1] - length * 2 * k.lam * sine
    s3 = trial[2] - length * d3

    # Return points whose order changes to an edge.
    edge = np.flatnonzero((s1 <= s2) | (s2 <= s3))
    if edge.size:
        s1, s2, s3 = trial[:, edge]
        a, c = edge_weights(trial[:, edge], sine[edge])
        most = a * s1 + (1 - a) * s2
        least = c * s3 + (1 - c) * s2
        averaged = _Line(most, least, a, c)
        sine = np.array(sine)
        t[edge], sine[edge], touching = _touch(averaged, chosen(k, edge))
        first[edge], last[edge], sin_phi[edge] = touching
        w1[edge] = a
        w3[edge] = c
    strength = (1 + sin_phi) * first - (1 - sin_phi) * last
    return PyramidConstants(k.lam, k.mu, sin_phi, sine, strength), (w1, w3), t


def _change_of_flow(
    trial: Array,
    values: Array,
    sine: Array,
    weights: tuple[Array, Array],
    t: Array,
    k: _Constants,
) -> Array:
    """Return the change of stress (3, n) by returned s1 where the dilatancy follows the friction.

    With the flow d(sin psi) and its derivative e the returned stress changes by dL d + L e (d sin
    psi / d s1) d s1, and stays on the tangent: the moduli change by a dyad with d s1.
    """
    w1, w3 = weights
    s1 = w1 * trial[0] + (1 - w1) * trial[1]

    # Compute the flow d and its derivative e by the sine of the dilatancy.
    d1, d3 = _directions(_Line(s1, s1, w1, w3), sine, k)
    d2 = _middle(d1, 2 * k.lam * sine, d3, weights)
    d = np.stack((d1, d2, d3))
    e1 = 2 * k.lam + 2 * k.mu * w1
    e3 = 2 * k.lam + 2 * k.mu * w3
    e2 = _middle(e1, 2 * k.lam, e3, weights)
    e = np.stack((e1, e2, e3))

    # Compute L d sin(psi) / d s1 by an imaginary step of t.
    t = np.maximum(t, APEX)
    along_t = tangent(t * (1 + IMAGINARY * 1j), k)
    rate = along_t.sine.imag / along_t.s1.imag
    rate = rate * (s1 - values[0]) / d1

    # Eliminate dL by the condition that the stress stays on the tangent.
    share = rate / (1 + rate * e1)
    d_less = d - share * d1 * e
    by_d = (1 + sine) * d1 - (1 - sine) * d3
    by_e = (1 + sine) * e1 - (1 - sine) * e3
    return -share * e + d_less * share * by_e / (by_d - share * d1 * by_e)
