"""Hoek-Brown strength of rock masses: the return of Mohr-Coulomb to the tangent that touches at the
returned stress.

With s1 >= s2 >= s3, tension positive, the yield function is s1 - s3 - sigma_ci t^a with t = s - m_b
s1 / sigma_ci. The return runs along a line, on an edge of the meeting stresses' mean, on which t
and s1 - s3 are linear. With u = t^a the yield condition is u + b u^(1/a) = A: it is convex, and
Newton's method from u = A falls to the root. Stress, edge, apex and tangent are then those of
Mohr-Coulomb's pyramid with sin(phi) and the strength of the tangent there.
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
from .pyramid import PyramidConstants, pyramid_return
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
    """Floats, or arrays over elements or points; ``sin_psi`` is the dilatancy, ``ci`` is
    sigma_ci.
    """

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
    r"""Linear elasticity, perfect plasticity with the generalised Hoek-Brown strength, flow of
    Mohr-Coulomb.

    With the principal stresses :math:`\sigma_1 \ge \sigma_2 \ge \sigma_3`, tension positive, the
    strength is
    :math:`\sigma_1 - \sigma_3 = \sigma_{ci} (s - m_b \sigma_1 / \sigma_{ci})^a`. The friction angle
    of its tangent falls with the pressure, and the dilatancy angle is capped by it. A strength
    reduction divides the shear strength on every plane, so that c and tan(phi) of every tangent are
    divided; bounds have chords and tangents. E. Hoek, C. Carranza-Torres, B. Corkum, Proc.
    NARMS-TAC (2002) 267-273; J. Clausen, L. Damkilde, Int. J. Rock Mech. Min. Sci. 45 (2008)
    831-847.

    Parameters
    ----------
    E, nu : float or ndarray
        As those of :class:`LinearElastic`.
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
        for name in ("sigma_ci", "m_b"):
            require(name, getattr(self, name), np.greater(getattr(self, name), 0), "be positive")
        require(
            "s",
            self.s,
            np.greater_equal(self.s, 0) & np.less_equal(self.s, 1),
            "lie between 0 and 1",
        )
        require("a", self.a, np.greater_equal(self.a, 0.5) & np.less(self.a, 1), "lie in [0.5, 1)")
        require(
            "psi",
            self.psi,
            np.greater_equal(self.psi, 0) & np.less(self.psi, 90),
            "lie in [0, 90) degrees",
        )
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
            As those of the class.
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
        index, D = np.asarray(gsi, dtype=float), np.asarray(disturbance, dtype=float)
        require("gsi", index, (index > 0) & (index <= 100), "be above 0 and at most 100")
        require("disturbance", D, (D >= 0) & (D <= 1), "lie between 0 and 1")
        require("m_i", m_i, np.greater(m_i, 0), "be positive")
        m_b = np.asarray(m_i) * np.exp((index - 100) / (28 - 14 * D))
        a = 0.5 + (np.exp(-index / 15) - np.exp(-20 / 3)) / 6
        return cls(E, nu, sigma_ci, m_b, np.exp((index - 100) / (9 - 3 * D)), a, psi)

    @override
    def reduced(self, factor: float, flow: Flow = "given") -> HoekBrown:
        check_reduction(factor, flow, self)
        if flow not in ("given", "associated"):
            raise ValueError(
                f"flow '{flow}' needs one friction angle: HoekBrown has 'given' and 'associated'"
            )
        return self._with(
            factor=self.factor * factor, psi=self.psi if flow == "given" else _ASSOCIATED
        )

    @override
    def lines(
        self, stress: float, inner: bool = True, flow: Flow = "associated"
    ) -> tuple[Array, Array]:
        return lines_of(_Constants(*map(np.atleast_1d, self.constants())), stress, inner, flow)

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
        return 0.5 * (largest - smallest), 0.5 * (
            largest - smallest - _excess(largest, smallest, k)
        )

    @override
    def constants(self) -> _Constants:
        return _Constants(
            *self.lame,
            np.sin(np.radians(self.psi)),
            self.sigma_ci,
            self.m_b,
            self.s,
            self.a,
            self.factor,
        )

    @override
    def yield_bound(self, stress: Array, constants: _Constants) -> Array:
        return _excess(*extremes(stress), constants)

    @override
    def yield_function(self, values: Array, constants: _Constants) -> Array:
        return _excess(values[0], values[2], constants)

    @override
    def return_map(self, trial: Array, constants: _Constants) -> Return:
        cone, weights, t = _tangent_cone(trial, constants)
        new = pyramid_return(trial, cone)
        largest = np.maximum(trial[0], -trial[2])
        off = np.abs(_excess(new.values[0], new.values[2], constants)) > _ADMITTED * largest
        off &= new.values[0] - new.values[2] > ROUND_OFF * largest
        if (
            off.any()
        ):  # near the apex the strength is steep: its error is that of s1 times the slope
            error = np.abs(_excess(new.values[0], new.values[2], constants))
            off &= error > _ADMITTED * (1 + _slope(t, constants)) * largest
        if off.any():
            raise IncrementTooLarge(
                f"the return to the strength of Hoek and Brown fails at {off.sum()} points"
            )
        return Return(
            new.values, lambda: _with_capped_flow(new, trial, cone, constants, weights, t)
        )


def _excess(largest: Array, smallest: Array, k: _Constants) -> Array:
    """Return the yield function of the extreme principal stresses, beyond the apex with the
    distance to it.
    """
    t = k.s - k.m_b * largest / k.ci
    if np.all(np.equal(k.factor, 1.0)):
        strength = k.ci * np.maximum(t, 0.0) ** k.a
    else:
        apart = falling_root(lambda t: tangent(t, k).s1 - largest, np.maximum(t, APEX))
        strength = np.where(t > 0, largest - tangent(apart, k).s3, 0.0)
    return largest - smallest - strength + np.maximum(-t, 0.0) * k.ci / k.m_b


def _slope(t: Array, k: _Constants) -> Array:
    """Return d (s1 - s3) / d (-s1) of the strength."""
    return k.a * k.m_b * np.maximum(t, APEX) ** (k.a - 1)


def _directions(line: _Line, sine: Array, k: _Constants) -> tuple[Array, Array]:
    """Return by how much a unit of flow with a dilatancy lowers s1 and s3."""
    volume = 2 * k.lam * sine
    return volume + 2 * k.mu * (1 + sine) * line.w1, volume - 2 * k.mu * (1 - sine) * line.w3


def _touch(line: _Line, k: _Constants) -> tuple[Array, Array, Tangent]:
    """Return t, the sine of the dilatancy and the tangent where the return along a line ends."""
    sine = np.broadcast_to(k.sin_psi, line.s1.shape)
    d1, d3 = _directions(line, sine, k)
    t0, b = k.s - k.m_b * line.s1 / k.ci, (d1 - d3) / (k.m_b * d1)
    A = np.maximum((line.s1 - line.s3) / k.ci + b * t0, 0.0)
    u = 2 * A / (1 + np.sqrt(1 + 4 * b * A))  # the root for a = 1/2
    for _ in range(_MOST if np.any(np.not_equal(k.a, 0.5)) else 0):
        power = b * u ** (1 / k.a - 1)
        step = (u + power * u - A) / (1 + power / k.a)
        u = np.maximum(u - step, 0.0)
        if np.all(np.abs(step) <= _LAST * u):
            break
    t = u ** (1 / k.a)
    touching = tangent(np.maximum(t, APEX), k)
    other = np.flatnonzero(np.not_equal(k.factor, 1.0) | (sine > touching.sine))
    if other.size:
        t, sine = t.copy(), sine.copy()
        t[other], sine[other] = _touch_other(
            _Line(*chosen(line, other)), t[other], chosen(k, other)
        )
        touching = tangent(np.maximum(t, APEX), k)
    return t, sine, touching


def _touch_other(line: _Line, start: Array, k: _Constants) -> tuple[Array, Array]:
    """Return t, from one nearby, and the dilatancy where the strength is reduced or the dilatancy
    that of friction.
    """

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
    """Return the tangent at the returned stresses as constants of a pyramid, weights of faces and
    edges, and t.
    """
    one = np.ones(trial.shape[1])
    line = _Line(trial[0], trial[2], one, one)
    t, sine, (first, last, sin_phi) = _touch(line, k)
    d1, d3 = _directions(line, sine, k)
    length = (trial[0] - first) / d1
    s1, s2, s3 = (
        trial[0] - length * d1,
        trial[1] - length * 2 * k.lam * sine,
        trial[2] - length * d3,
    )
    w1, w3 = one.copy(), one.copy()
    edge = np.flatnonzero((s1 <= s2) | (s2 <= s3))
    if edge.size:
        at, some, psi = trial[:, edge], chosen(k, edge), sine[edge]
        minor = (at[1] - at[2]) * (1 + psi) <= (at[0] - at[1]) * (1 - psi)
        w1[edge], w3[edge] = np.where(minor, 1.0, 0.5), np.where(minor, 0.5, 1.0)
        a, c = w1[edge], w3[edge]
        averaged = _Line(a * at[0] + (1 - a) * at[1], c * at[2] + (1 - c) * at[1], a, c)
        sine = np.array(sine)
        t[edge], sine[edge], (first[edge], last[edge], sin_phi[edge]) = _touch(averaged, some)
    strength = (1 + sin_phi) * first - (1 - sin_phi) * last
    return PyramidConstants(k.lam, k.mu, sin_phi, sine, strength), (w1, w3), t


def _with_capped_flow(
    new: Return,
    trial: Array,
    cone: PyramidConstants,
    k: _Constants,
    weights: tuple[Array, Array],
    t: Array,
) -> Array:
    """Return the moduli; where the dilatancy is that of the tangent, it changes with the returned
    stress.

    With the flow d(sin psi) the returned stress changes by dL d + L d' (d sin psi / d s1) d s1, and
    stays on the tangent: a change of rank one.
    """
    moduli = new.moduli()
    points = np.flatnonzero(cone.sin_psi < k.sin_psi)
    if not points.size:
        return moduli
    values, k, w1, w3 = (
        new.values[:, points],
        chosen(k, points),
        weights[0][points],
        weights[1][points],
    )
    sine, s1 = np.asarray(cone.sin_psi)[points], w1 * trial[0, points] + (1 - w1) * trial[1, points]
    d1, d3 = _directions(_Line(s1, s1, w1, w3), sine, k)
    e1, e3 = 2 * k.lam + 2 * k.mu * w1, 2 * k.lam + 2 * k.mu * w3  # their derivatives by the sine
    middle = np.where(w3 < 1, d3, np.where(w1 < 1, d1, 2 * k.lam * sine))
    d = np.stack((d1, middle, d3))
    e = np.stack(np.broadcast_arrays(e1, np.where(w3 < 1, e3, np.where(w1 < 1, e1, 2 * k.lam)), e3))
    along_t = tangent(np.maximum(t[points], APEX) * (1 + IMAGINARY * 1j), k)
    rate = along_t.sine.imag / along_t.s1.imag * (s1 - values[0]) / d1
    share = rate / (1 + rate * e1)
    resisting, along = ((1 + sine) * v[0] - (1 - sine) * v[2] for v in (d, e))
    change = -share * e + (d - share * d1 * e) * share * along / (resisting - share * d1 * along)
    moduli[:, :, points] += change[:, None] * moduli[0][:, points]
    return moduli
