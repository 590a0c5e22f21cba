"""Exact and semi-analytic solutions of waves in the elastic half-plane.

Displacements of a surface under a load exp(i w t) follow from its transform along x,

    u(k) = U(k) p(k),   U = -k_s^2 n_p / (mu R),   R = (2 k^2 - k_s^2)^2 - 4 k^2 n_p n_s,
    n_p^2 = k^2 - k_p^2,   n_s^2 = k^2 - k_s^2,

(K. F. Graff 1975, Wave Motion in Elastic Solids, section 6.2), with n = k for k = 0 statics:
U -> (1 - nu) / (mu k).
"""

from __future__ import annotations

import numpy as np
from numpy import ndarray
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import jv


def reflected(kind: str, angle: float, vp: float, vs: float, free: bool = False) -> float:
    """Return the reflected share of the energy of a plane wave on a boundary with dashpots.

    With the slowness s along the boundary y = 0 the wave u = d f(t - s x - q y) meets the tractions
    (rho vs v_x, rho vp v_y). Both reflected waves balance them: two linear equations. For a free
    surface everything returns.

    Parameters
    ----------
    kind
        ``"P"`` or ``"S"``.
    angle
        Between the direction of the wave and the normal, in radians.
    """
    velocity = {"P": vp, "S": vs}
    s = np.sin(angle) / velocity[kind]
    q = {name: np.sqrt(complex(c**-2 - s**2)) for name, c in velocity.items()}

    def unbalanced(name: str, sign: float) -> ndarray:
        # d is along the slowness (s, sign q) for P and across it for S; v = d f', per density
        along = np.array([s, sign * q[name]]) * velocity[name]
        d = along if name == "P" else np.array([-along[1], along[0]])
        slow = np.array([s, sign * q[name]])
        # stresses are -f' times these
        shear = vs**2 * (d[0] * slow[1] + d[1] * slow[0])
        normal = (vp**2 - 2.0 * vs**2) * (d @ slow) + 2.0 * vs**2 * d[1] * slow[1]
        dashpots = np.zeros(2) if free else np.array([vs * d[0], vp * d[1]])
        return np.array([-shear, -normal]) + dashpots

    back = np.column_stack((unbalanced("P", -1.0), unbalanced("S", -1.0)))
    found = np.linalg.solve(back, -unbalanced(kind, 1.0))
    # energy that passes a unit of the boundary: rho c^2 q |u'|^2 / 2
    flow = {name: velocity[name] ** 2 * q[name].real for name in "PS"}
    returned = sum(abs(a) ** 2 * flow[name] for a, name in zip(found, "PS", strict=True))
    return float(returned / flow[kind])


def lamb(x: float, times: ndarray, force, vp: float, vs: float, density: float) -> ndarray:
    """Return the surface's displacement in the direction of a line load that begins at t = 0.

    H. Lamb (1904): with q = t / x, a^2 = q^2 - vp^-2, b^2 = vs^-2 - q^2 the response to an impulse
    is

        g = -a (vs^-2 - 2 q^2)^2 / |(vs^-2 - 2 q^2)^2 + 4 i q^2 a b|^2      before the shear wave,
        g = -a / ((vs^-2 - 2 q^2)^2 - 4 q^2 a |b|)                          after it,

    over pi mu vs^2 x. It has a pole at the velocity of Rayleigh's wave, where the principal value
    counts.
    """
    first, second = 1.0 / vp, 1.0 / vs

    def rayleigh(q):
        a, b = np.sqrt(q**2 - first**2), np.sqrt(np.abs(second**2 - q**2))
        return (second**2 - 2.0 * q**2) ** 2 - 4.0 * q**2 * a * b

    pole = brentq(rayleigh, second * (1.0 + 1e-9), 1.5 * second)

    def g(q):
        a, b = np.sqrt(q**2 - first**2), np.sqrt(np.abs(second**2 - q**2))
        square = (second**2 - 2.0 * q**2) ** 2
        if q < second:
            return -a * square / (square**2 + (4.0 * q**2 * a * b) ** 2)
        return -a / (square - 4.0 * q**2 * a * b)

    found = []
    for t in times:
        end = t / x
        value = 0.0
        low, high = 0.5 * (second + pole), pole + 0.5 * (pole - second)

        def smooth(q, t=t):
            return force(t - q * x) * g(q)

        def times_distance(q, t=t):
            return force(t - q * x) * g(q) * (q - pole) if q != pole else 0.0

        for begin, stop in ((first, second), (second, low), (high, max(end, high))):
            if end > begin:
                value += quad(smooth, begin, min(stop, end), limit=200)[0]
        if end > low:
            # the load vanishes at its beginning: the integrand goes to zero at the end
            value += quad(times_distance, low, high, weight="cauchy", wvar=pole, limit=200)[0]
        found.append(value / (np.pi * density * vs**4))
    return np.array(found)


def impedance(a0: float, nu: float, n: int = 5) -> complex:
    """Return the vertical force over the displacement of a rigid smooth strip, over mu.

    The pressures are Chebyshev polynomials over sqrt(b^2 - x^2), whose transforms are Bessel
    functions; the displacement is projected on them. The path of integration passes above the poles
    and branch points on the real axis.

    Parameters
    ----------
    a0
        Angular frequency times half of the width over vs.
    n
        Number of polynomials.
    """
    ks = a0
    kp = a0 * np.sqrt((1.0 - 2.0 * nu) / (2.0 * (1.0 - nu)))

    def U(k):
        n_p, n_s = np.sqrt(k**2 - kp**2), np.sqrt(k**2 - ks**2)
        return -(ks**2) * n_p / ((2.0 * k**2 - ks**2) ** 2 - 4.0 * k**2 * n_p * n_s)

    def integral(values, weights, path, m, p):
        return np.sum(weights * path * U(values) * jv(2 * m, values) * jv(2 * p, values))

    # an arch up to 3 ks, then pieces of the real axis
    nodes, weights = np.polynomial.legendre.leggauss(400)
    angle = 0.5 * np.pi * (nodes + 1.0)
    radius = 1.5 * ks
    arch = radius * (1.0 - np.cos(angle)) + 0.3j * ks * np.sin(angle)
    slope = 0.5 * np.pi * (radius * np.sin(angle) + 0.3j * ks * np.cos(angle))
    far = 400.0
    pieces = np.linspace(2.0 * radius, far, 400)
    short, by = np.polynomial.legendre.leggauss(12)
    half = 0.5 * np.diff(pieces)
    line = (pieces[:-1, None] + half[:, None] * (short + 1.0)).ravel() + 0j
    on_line = (half[:, None] * by).ravel()
    A = np.zeros((n, n), complex)
    for m in range(n):
        for p in range(n):
            value = integral(arch, weights, slope, m, p) + integral(line, on_line, 1.0, m, p)
            # beyond, the mean of J_2m J_2p is (-1)^(m+p) / (pi k), and U = (1 - nu) / k
            value += (-1.0) ** (m + p) * (1.0 - nu) / (np.pi * far)
            A[m, p] = (-1.0) ** (m + p) * value
    right = np.zeros(n)
    right[0] = 1.0
    return complex(np.pi * np.linalg.solve(A, right)[0])
