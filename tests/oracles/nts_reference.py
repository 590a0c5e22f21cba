"""Node-to-segment contact of one node and one straight segment, written apart from the package.

The unknowns are ordered ``[xs, ys, x2, y2, x1, y1]`` and the segment is
``rho(xi) = (1 - xi)/2 x2 + (1 + xi)/2 x1``, so that xi = -1 at x2; the normal is on the left of the
way from x2 to x1. Everything is written with analytic functions of the coordinates: a derivative is
``Im f(x + i h) / h``, exact to round-off, with the status (open, stick, slip) frozen.
"""

from __future__ import annotations

import numpy as np

X0 = np.array([0.3, -0.01, 0.1, 0.05, 1.1, -0.10])
#: Arguments of :func:`residual`, and its value as printed with the cases A3 and A4.
CASES = {
    "frictionless": {"eps_n": 1e4},
    "stick": {"eps_n": 1e4, "eps_t": 500.0, "mu": 0.6, "traction": 0.0, "xi_n": -0.62},
    "slip": {"eps_n": 1e4, "eps_t": 5e4, "mu": 0.3, "traction": 2.0, "xi_n": -0.70},
}
PRINTED = {
    "frictionless": "-44.0097799511 -293.3985330073 35.0141378877 233.4275859183 8.9956420634 "
    "59.970947089",
    "stick": "-36.8092909535 -294.478606357 29.317125077 234.4981525098 7.4921658766 59.9804538471",
    "slip": "44.0097799511 -306.6014669927 -34.6267657415 246.5143082598 -9.3830142096 "
    "60.0871587329",
}


def residual(x, eps_n, eps_t=0.0, mu=0.0, traction=0.0, xi_n=0.0, status=None):
    """Internal force (6,), status, contravariant tangential traction and xi.

    Parameters
    ----------
    x
        Coordinates, real or complex.
    eps_n, eps_t
        Penalties; ``eps_t`` is contravariant traction per xi.
    mu
        Coefficient of friction.
    traction, xi_n
        Contravariant tangential traction and xi of the last step.
    status
        To freeze it; else it is found from the real parts.
    """
    x = np.asarray(x)
    slave, x2, x1 = x[0:2], x[2:4], x[4:6]
    rho1 = 0.5 * (x1 - x2)
    metric = rho1 @ rho1
    length = np.sqrt(metric)
    xi = (slave - 0.5 * (x1 + x2)) @ rho1 / metric
    normal = np.array([-rho1[1], rho1[0]]) / length
    gap = (slave - 0.5 * (1 - xi) * x2 - 0.5 * (1 + xi) * x1) @ normal
    if gap.real >= 0:
        return np.zeros(6, x.dtype), "open", 0.0, xi
    pressure = eps_n * gap
    # d(slave - rho) at fixed xi, and d(rho1)
    moved, turned = np.zeros((2, 6), x.dtype), np.zeros((2, 6), x.dtype)
    for c in range(2):
        moved[c, c::2] = [1.0, -0.5 * (1 - xi), -0.5 * (1 + xi)]
        turned[c, c::2] = [0.0, -0.5, 0.5]
    dxi = (rho1 @ moved + gap * (normal @ turned)) / metric
    trial = traction - eps_t * (xi - xi_n)
    limit = mu * (-pressure) / length
    if status is None:
        status = "frictionless" if mu == 0 else "stick" if abs(trial.real) <= limit.real else "slip"
    tangential = {"frictionless": 0.0, "stick": trial, "slip": np.sign(trial.real) * limit}[status]
    return pressure * (normal @ moved) - tangential * metric * dxi, status, tangential, xi


def tangent(x, **arguments):
    """Derivative of the residual by complex steps, (6, 6)."""
    status = residual(np.array(x, complex), **arguments)[1]
    K = np.zeros((6, 6))
    for j in range(6):
        z = np.array(x, complex)
        z[j] += 1e-30j
        K[:, j] = residual(z, **arguments, status=status)[0].imag / 1e-30
    return K
