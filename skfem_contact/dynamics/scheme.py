"""Inertia and damping as a further form, by the generalised-alpha method.

The internal forces F of all other forms are averaged between the ends of a step (J. Chung and
G. M. Hulbert 1993, J. Appl. Mech. 60, 371). With r = F - load,

    M a_(n+1-am) + C v_(n+1-af) + (1 - af) r_(n+1) + af r_n = 0.

The last accepted balance says r_n = -f_n, with the force f_n of this form. The balance at the end
of the step is then F_(n+1) + f_(n+1) = load_(n+1) with

    f_(n+1) = [M a_(n+1-am) + C v_(n+1-af) - af f_n] / (1 - af),

so that other forms are met only at the ends of steps. Accelerations and velocities are Newmark's,

    a_(n+1) = (u_(n+1) - u_n - h v_n) / (beta h^2) - (1 / (2 beta) - 1) a_n
    v_(n+1) = v_n + h ((1 - gamma) a_n + gamma a_(n+1)).
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix
from typing_extensions import Self, override

from ..forms.base import Form, Response
from ..forms.roles import Timed
from ..sparse import constant

#: Round-off of accelerations: differences of displacements over the square of a step.
_ROUND_OFF = 4 * np.finfo(float).eps


class Scheme(NamedTuple):
    """Parameters of the generalised-alpha method."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float

    @classmethod
    def of(cls, rho_inf: float) -> Scheme:
        """Return the parameters of a spectral radius at infinity (Chung and Hulbert, eq. 25)."""
        alpha_m = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0)
        alpha_f = rho_inf / (rho_inf + 1.0)
        beta = 0.25 * (1.0 - alpha_m + alpha_f) ** 2
        gamma = 0.5 - alpha_m + alpha_f
        return cls(alpha_m, alpha_f, beta, gamma)

    @property
    def error(self) -> float:
        """Error of the displacement of a step over h^3 times the rate of the acceleration."""
        return abs(self.beta + 0.5 * (self.alpha_m - self.alpha_f) - 1.0 / 6.0)


@dataclass(frozen=True)
class Motion:
    """Motion at the end of a step, arrays (N,).

    Attributes
    ----------
    x, velocity, acceleration
        Displacements, velocities and accelerations.
    force
        Force of inertia and damping that the other forms balance.
    damped
        Work of damping since the start of the stage.
    """

    x: ndarray
    velocity: ndarray
    acceleration: ndarray
    force: ndarray
    damped: float = 0.0


class Inertia(Form, Timed):
    """Forces of inertia and damping in a step in time.

    Parameters
    ----------
    M, C : csr_matrix, shape (N, N)
        Mass and damping.
    scheme
        Parameters of the method.

    Attributes
    ----------
    still : ndarray
        Dofs without mass and damping, whose velocities are means of a step.
    """

    symmetric = True

    def __init__(self, M: csr_matrix, C: csr_matrix, scheme: Scheme) -> None:
        self.M = M
        self.C = C
        self.scheme = scheme
        self.changing = np.zeros(0, int)
        self.symmetric = abs(C - C.T).max() <= 1e-12 * abs(C).max()
        self._step = 0.0
        self._K = csr_matrix(M.shape)
        self._diagonal = np.zeros(M.shape[0])
        # Dofs without mass and damping, which have no motion of their own.
        massless = np.diff(M.indptr) == 0
        undamped = np.diff(C.indptr) == 0
        self.still = np.flatnonzero(massless & undamped)

    @override
    def over(self, duration: float) -> Self:
        if duration == self._step:
            return self
        new = copy(self)
        am, af, beta, gamma = self.scheme
        new._step = duration
        per_mass = (1.0 - am) / ((1.0 - af) * beta * duration**2)
        new._K = constant(csr_matrix(per_mass * self.M + gamma / (beta * duration) * self.C))
        new._diagonal = new._K.diagonal()
        return new

    @property
    def stiffness(self) -> csr_matrix:
        """Tangent of the force, (N, N)."""
        return self._K

    @override
    def assemble(self, x: ndarray, state: Motion) -> Response:
        # Newmark's rule at the end of the step, then the averages
        h = self._step
        am, af, beta, gamma = self.scheme
        moved = x - state.x
        v_0 = state.velocity
        a_0 = state.acceleration
        a = (moved - h * v_0) / (beta * h**2) - (0.5 / beta - 1.0) * a_0
        v = v_0 + h * ((1.0 - gamma) * a_0 + gamma * a)
        # Forces between the two ends: (1 - am) a + am a_0, (1 - af) v + af v_0.
        viscous = self.C @ ((1.0 - af) * v + af * v_0)
        inertial = self.M @ ((1.0 - am) * a + am * a_0)
        force = (inertial + viscous - af * state.force) / (1.0 - af)

        def new() -> Motion:
            a[self.still] = 0.0
            v[self.still] = moved[self.still] / self._step
            return Motion(x, v, a, force, state.damped + float(viscous @ moved))

        return Response(force, new, lambda: self._K, round_off=self.lost(x))

    def lost(self, x: ndarray) -> float:
        """Return the norm of forces that displacements of finite digits leave."""
        return _ROUND_OFF * float(np.linalg.norm(self._diagonal * x))
