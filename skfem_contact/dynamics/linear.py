"""Steps of linear models in time: one factor, without assembly and without iterations.

The internal forces of all forms are F = F_0 + K (u - u_0), and the tangent of a step is constant.
With the changes d = u_(n+1) - u_n a step solves

    (K + K_g) d = load_(n+1) - F_n - g_n^0,

where g_n^0 is the force of inertia and damping at u_(n+1) = u_n. Accelerations follow from d
itself, not from differences of displacements, so that short steps lose no digits.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from functools import cached_property

import numpy as np
from numpy import ndarray
from scipy.linalg.blas import daxpy
from scipy.sparse import csr_matrix

from ..arrays import max_abs
from ..errors import NotConverged
from ..forms.base import Forms, Response, responses_of
from ..forms.roles import Regularised, having
from ..nonlinear.system import System
from ..solvers.direct import REFINE, UNCHECKED, SingularSystem
from ..sparse import Total, constant
from .mass import lumped
from .scheme import Inertia, Motion

#: Steps after which products of matrices are computed anew, and solutions checked.
_RENEWED = 64
#: Size of the displacements with which linearity is tried, as a share of the present ones, and the
#: error of forces that round-off may leave.
_TRIED = 1e-3
_SAME = 1e-9


def is_linear(forms: Forms, x: ndarray, states: Mapping[str, object]) -> bool:
    """Return True if the forces of all forms are linear and have no memory.

    Forms whose tangent never changes are tried: from the state after a displacement a second one
    must cause the same force as from the accepted state.
    """
    # Forms that change, or act on one side only, are not linear.
    if any(form.changing is None or len(form.changing) for form in forms.values()):
        return False
    if any(form.unilateral for form in having(forms, Regularised).values()):
        return False
    # Compare the forces at random displacements with the linear ones.
    random = np.random.default_rng(0)
    size = _TRIED * max(max_abs(x), 1.0)
    first = x + size * random.standard_normal(len(x))
    second = x + size * random.standard_normal(len(x))
    before = responses_of(forms, x, states)
    there = responses_of(forms, first, states)
    moved = {name: response.state for name, response in there.items()}
    from_there = responses_of(forms, second, moved)
    # Forces must not depend on the path, either.
    for name, direct in responses_of(forms, second, states).items():
        linear = before[name].force + before[name].stiffness @ (second - x)
        scale = _SAME * max_abs(linear)
        for other in (from_there[name].force, linear):
            if max_abs(direct.force - other) > scale:
                return False
    return True


class Linear:
    """Linear model of a stage, for steps of one length.

    A step costs one solution and one product C d: the products C v and C a follow Newmark's rule
    like v and a, and the change of the internal forces is K d = right side - K_g d. From time to
    time all of them are computed anew.

    Parameters
    ----------
    system
        The system with the form of inertia.
    inertia
        This form, for the length of a step.
    responses
        Responses of the other forms at the start.
    motion
        Motion at the start.
    step
        Length of a step.

    Attributes
    ----------
    length
        Length of a step.
    force
        Internal forces at the end of the last step.
    """

    def __init__(
        self,
        system: System,
        inertia: Inertia,
        responses: Mapping[str, Response],
        motion: Motion,
        step: float,
    ) -> None:
        self._system = system
        self._fixed = system.fixed
        # One stiffness for all steps.
        self._K = Total().of([response.stiffness for response in responses.values()])
        self._start = motion.x
        self._begun = np.sum([response.force for response in responses.values()], axis=0)
        self._M = inertia.M
        self._masses = lumped(inertia.M)
        self.force = self._begun
        self._factor(inertia, motion, step)

    def with_step(self, motion: Motion, step: float) -> Linear:
        """Return the model for steps of another length, with a factor of its own."""
        new = copy(self)
        new._factor(self._inertia.over(step), motion, step)
        return new

    def _factor(self, inertia: Inertia, motion: Motion, step: float) -> None:
        """Factor the matrix of a step."""
        self._inertia = inertia
        self.length = step
        self._whole = constant(Total().of([self._K, inertia.stiffness]))
        try:
            self._solve = self._system.factor(self._whole)
        except SingularSystem as error:
            raise NotConverged(str(error), motion.x, (), int(error.dofs[0])) from error
        self._count = 0
        self._renew(motion)

    def _renew(self, motion: Motion) -> None:
        """Compute products of matrices anew."""
        C = self._inertia.C
        self._damped = C.nnz > 0
        self._Cv = C @ motion.velocity
        self._Ca = C @ motion.acceleration
        self.force = self._begun + self._K @ (motion.x - self._start)

    def _times_mass(self, a: ndarray) -> ndarray:
        """Return mass times acceleration."""
        if self._masses is None:
            return self._M @ a
        return self._masses * a

    def step(self, motion: Motion, load: ndarray, prescribed: ndarray) -> Motion:
        """Return the motion at the end of a step; :attr:`force` then has the internal forces.

        Parameters
        ----------
        motion
            Motion at its start.
        load, prescribed
            External forces and values of the fixed dofs at its end.
        """
        h = self.length
        am, af, beta, gamma = self._inertia.scheme
        v = motion.velocity
        a = motion.acceleration
        fixed = self._fixed

        # Newmark's rule with the change d: a' = a_d d + a_v v + a_a a, v' = v_d d + v_v v + v_a a
        a_d = 1.0 / (beta * h**2)
        a_v = -1.0 / (beta * h)
        a_a = 1.0 - 0.5 / beta
        v_d = gamma / (beta * h)
        v_v = 1.0 - gamma / beta
        v_a = h * (1.0 - 0.5 * gamma / beta)

        # Force of inertia and damping where nothing moves
        new_force = (1.0 - am) * a_v * v
        _add(new_force, (1.0 - am) * a_a + am, a)
        new_force = self._times_mass(new_force)
        _add(new_force, -af, motion.force)
        if self._damped:
            _add(new_force, (1.0 - af) * v_v + af, self._Cv)
            _add(new_force, (1.0 - af) * v_a, self._Ca)
        new_force *= 1.0 / (1.0 - af)

        # Solve for the change of the displacements
        right = load - self.force
        right -= new_force
        d = np.zeros(0)
        lag = prescribed - motion.x[fixed]
        accuracy = UNCHECKED
        if self._count % _RENEWED == 0:
            accuracy = REFINE
        if lag.any():
            d = np.zeros(len(load))
            d[fixed] = lag
            d += self._solve(right - self._whole @ d, accuracy)
        else:
            d = self._solve(right, accuracy)

        # Follow Newmark's rule
        new_a = a_d * d
        _add(new_a, a_v, v)
        _add(new_a, a_a, a)
        new_v = v_d * d
        _add(new_v, v_v, v)
        _add(new_v, v_a, a)
        _add(new_force, (1.0 - am) / (1.0 - af) * a_d, self._times_mass(d))
        damped = motion.damped
        if self._damped:
            Cv = self._Cv
            Ca = self._Ca
            Cd = self._inertia.C @ d
            _add(new_force, v_d, Cd)
            # the work of the mean of C v at both ends
            before = float(Cv @ d)
            late = float(Ca @ d)
            after = v_d * float(Cd @ d) + v_v * before + v_a * late
            damped += (1.0 - af) * after + af * before
            new_Cv = v_d * Cd
            _add(new_Cv, v_v, Cv)
            _add(new_Cv, v_a, Ca)
            Cd *= a_d
            _add(Cd, a_v, Cv)
            _add(Cd, a_a, Ca)
            self._Cv = new_Cv
            self._Ca = Cd
        still = self._inertia.still
        if len(still):
            new_a[still] = 0.0
            new_v[still] = d[still] / h
        new = Motion(motion.x + d, new_v, new_a, new_force, damped)

        # The balance gives the internal forces of free dofs; supports need their product
        self._count += 1
        if self._count % _RENEWED == 0 or lag.any():
            self._renew(new)
        else:
            force = load - new_force
            force[fixed] = self.force[fixed] + self._at_supports @ d
            self.force = force
        return new

    @cached_property
    def _at_supports(self) -> csr_matrix:
        """Rows of the stiffness at supports."""
        return self._K[self._fixed]


def _add(y: ndarray, factor: float, x: ndarray) -> None:
    """Add a vector times a factor to another one in place."""
    daxpy(x, y, a=factor)
