"""Explicit steps in time: central differences with lumped masses.

With the internal forces F of all forms and the length h of a step,

    v_(n+1/2) = v_n + h / 2 a_n,    u_(n+1) = u_n + h v_(n+1/2)
    M a_(n+1) = load_(n+1) - F(u_(n+1)) - C v_(n+1/2),    v_(n+1) = v_(n+1/2) + h / 2 a_(n+1),

but for the diagonal of C, which acts with v_(n+1).

Steps must be shorter than 2 / w (sqrt(1 + z^2) - z), with the highest frequency w of the mesh and
its damping ratio z (T. Belytschko, W. K. Liu and B. Moran 2000, Nonlinear Finite Elements for
Continua and Structures, eq. 6.2.16).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import csr_matrix, diags_array
from scipy.sparse.linalg import eigsh

from ..errors import IncrementTooLarge, NotConverged
from ..forms.base import Form, Forms, Response, responses_of
from ..layout import Layout, others
from ..sparse import within
from .linear import is_linear
from .scheme import Motion

#: Accuracy of the highest frequency, which is found from below.
_ACCURATE = 1e-3
#: Displacements above this are those of unstable steps.
_ENDLESS = 1e100


def critical_step(K: csr_matrix, C: csr_matrix, m: ndarray, free: ndarray) -> float:
    """Return the longest stable step.

    Parameters
    ----------
    K, C
        Stiffness and damping, (N, N).
    m : ndarray, shape (N,)
        Lumped masses, positive at the free dofs.
    free
        Free dofs.
    """
    # Find the largest eigenvalue w^2 of M^-1/2 K M^-1/2.
    root = diags_array(1.0 / np.sqrt(m[free]))
    A = csr_matrix(root @ within(K, free) @ root)
    if A.nnz == 0:
        return np.inf
    if len(free) < 10:
        square = float(np.linalg.eigvalsh(A.toarray()).max())
        shape: ndarray = np.ones(len(free))
    else:
        begin = np.random.default_rng(0).standard_normal(len(free))
        values, vectors = eigsh(A, 1, which="LA", tol=_ACCURATE, v0=begin)
        square = float(values[0]) * (1.0 + _ACCURATE)
        shape = vectors[:, 0]
    if square <= 0.0:
        return np.inf
    # Damping z shortens the step: 2 (sqrt(1 + z^2) - z) / w.
    w = np.sqrt(square)
    x = root @ shape
    damped = float(x @ (within(C, free) @ x))
    z = damped / (2.0 * w * float(shape @ shape))
    return float(2.0 / w * (np.sqrt(1.0 + z**2) - z))


class Explicit:
    """Explicit steps of forms, of which linear ones need no assembly.

    Parameters
    ----------
    forms, layout
        Forms by name, and the numbers of all dofs.
    M, C
        Mass, diagonal, and damping, (N, N).
    fixed
        Supported dofs.
    start
        Stage that the steps start from.

    Attributes
    ----------
    length
        Length of a step.
    critical
        Longest stable step.
    states
        States of forms that are not linear.
    """

    length = 0.0

    def __init__(
        self,
        forms: Forms,
        layout: Layout,
        M: csr_matrix,
        C: csr_matrix,
        fixed: ndarray,
        start: Any,
    ) -> None:
        self._C = C
        self._drag = C.diagonal()
        self._fixed = fixed
        self._start = x = start.x
        states = start.states

        # Assemble linear forms once
        self._linear = {}
        for name, form in forms.items():
            alone = {name: states[name]}
            if is_linear({name: form}, x, alone):
                self._linear[name] = form
        self._others = {name: form for name, form in forms.items() if name not in self._linear}
        self._K = csr_matrix((layout.size, layout.size))
        self._force = np.zeros(layout.size)
        self.states: dict[str, Any] = {name: states[name] for name in self._others}
        for response in responses_of(self._linear, x, states).values():
            self._K = csr_matrix(self._K + response.stiffness)
            self._force = self._force + response.force

        # Check the masses, and find the longest step
        free = others(layout.size, fixed)
        m = M.diagonal()
        without = free[m[free] <= 0.0]
        if len(without):
            raise ValueError(
                f"explicit steps need a mass at every free dof: {len(without)} have none, the "
                f"first is {layout.describe(int(without[0]))}"
            )
        self._inverse = np.zeros(layout.size)
        self._inverse[free] = 1.0 / m[free]
        K = self._K
        for response in responses_of(self._others, x, self.states).values():
            K = csr_matrix(K + response.stiffness)
        self.critical = critical_step(K, C, m, free)

    @property
    def linear(self) -> dict[str, Form]:
        """Forms whose states are not needed on the way."""
        return self._linear

    def forces(self, x: ndarray) -> tuple[dict[str, ndarray], dict[str, Response]]:
        """Return the internal forces by form, all linear ones together, and other responses."""
        linear = self._K @ (x - self._start)
        linear += self._force
        forces = {"": linear}
        try:
            found = responses_of(self._others, x, self.states)
            for name, response in found.items():
                forces[name] = response.force
        except IncrementTooLarge as error:
            raise NotConverged(f"the step is too large: {error}", x) from error
        return forces, found

    def step(
        self,
        motion: Motion,
        load: ndarray,
        prescribed: ndarray,
    ) -> tuple[Motion, dict[str, ndarray]]:
        """Return the motion at the end of a step, and the internal forces by form.

        Parameters
        ----------
        motion
            Motion at its start.
        load, prescribed
            External forces and values of the fixed dofs at its end.
        """
        h = self.length
        fixed = self._fixed

        # Move by the velocity in the middle; temporary vectors cost as much as the forces
        half = (0.5 * h) * motion.acceleration
        half += motion.velocity
        half[fixed] = (prescribed - motion.x[fixed]) / h
        x = h * half
        x += motion.x
        x[fixed] = prescribed
        if not float(np.dot(x, x)) < _ENDLESS**2:
            raise NotConverged("the displacements run away: the steps are too long", motion.x)

        # Find the forces
        forces, found = self.forces(x)
        self.states.update({name: response.state for name, response in found.items()})
        inertial = load - forces[""]
        for name in found:
            inertial -= forces[name]
        if self._C.nnz == 0:
            a = self._inverse * inertial
            inertial[fixed] = 0.0
            v = (0.5 * h) * a
            v += half
            return Motion(x, v, a, inertial, 0.0), forces

        # The diagonal of C acts with the velocity at the end: dashpots then keep steps stable
        viscous = self._C @ half
        a = self._inverse * (inertial - viscous) / (1.0 + 0.5 * h * self._inverse * self._drag)
        viscous += (0.5 * h) * self._drag * a
        inertial[fixed] = viscous[fixed]
        damped = motion.damped + float(viscous @ (x - motion.x))
        return Motion(x, half + (0.5 * h) * a, a, inertial, damped), forces
