"""Accelerated iterations: a way to equilibrium where the tangent leads nowhere.

Far from equilibrium the tangent of soil that flows without dilating is no guide: Newton's method
neither converges nor runs away. A matrix that mixes the tangent with the elastic stiffness does
not point to the solution either, but its steps, combined so that the linearised residual is least,
approach it.
"""

from __future__ import annotations

import logging
from collections.abc import Callable

import numpy as np
from numpy import ndarray

from ..arrays import row_norms
from ..errors import NotConverged
from ..solvers.direct import SingularSystem, Solve
from .newton import Evaluation, Problem

logger = logging.getLogger("skfem_contact")

#: Numbers of differences that are kept, and of iterations for which a preconditioner is.
_MEMORY = 20
_RENEWED = 5
#: Relative residual of the linear solutions: a footing in space takes as many iterations with .01.
_ROUGH = 0.1
#: Share of the residual that is left when Newton's method takes over again.
_LEFT = 0.1
#: Newton's method ends after so many steps that do not leave the second share of the residual. Such
#: a step is tried with the third length, and not taken if it does not leave the fourth share.
_SLOW = 2
_HALF = 0.5
_SHORTER = 0.4
_NO_FALL = 0.98
#: The iterations end when so many have not brought the smallest residual down to this share, and
#: after this number in all. Newton's method finds equilibrium from there: footings of 27,783 and
#: 98,304 dofs (phi 40, psi 0; phi 30, psi 5) take 58 and 29 iterations in a stage, and 117 and 63
#: with 40 in place of 10.
_STALLED = 10
_PROGRESS = 0.9
_MOST = 200
#: A step is halved, at most so many times, where its residual exceeds the largest of the last few
#: ones so many times.
_HALVINGS = 4
_GROWTH = 2.0
_LAST = 4
#: A combination leaves out what round-off decides.
_ROUND_OFF = 1e-12


class Anderson:
    r"""Combination of the last steps for which the linearised residual is least.

    With the differences :math:`\Delta x_i` of displacements and :math:`\Delta r_i` of residuals,

    .. math:: \gamma = \arg\min |r - \sum_i \gamma_i \Delta r_i|, \qquad
        \Delta x = -\sum_i \gamma_i \Delta x_i + M^{-1} (r - \sum_i \gamma_i \Delta r_i)

    where M is the preconditioner.

    References
    ----------
    D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965) 547-560.
    H. F. Walker, P. Ni, Anderson acceleration for fixed-point iterations, SIAM J. Numer. Anal. 49
    (2011) 1715-1735.
    """

    def __init__(self) -> None:
        self._steps: list[ndarray] = []
        self._changes: list[ndarray] = []

    def record(self, before: Evaluation, now: Evaluation) -> None:
        """Record the difference of two evaluations, and forget the oldest one."""
        change = now.residual - before.residual
        if not change.any():
            return
        self._steps.append(now.z - before.z)
        self._changes.append(change)
        if len(self._steps) > _MEMORY:
            del self._steps[0]
            del self._changes[0]

    def combine(self, residual: ndarray) -> tuple[ndarray, ndarray]:
        """Return the combined step and the linearised residual after it."""
        if not self._steps:
            return np.zeros_like(residual), residual

        # solve the normal equations with differences of unit length
        changes = np.array(self._changes)
        length = row_norms(changes)
        changes /= length[:, None]
        gram = changes @ changes.T
        gram[np.diag_indices_from(gram)] += _ROUND_OFF
        factor = np.linalg.solve(gram, changes @ residual)
        step = -(factor / length) @ np.array(self._steps)
        return step, residual - factor @ changes


class Accelerated:
    """Anderson's iterations that alternate with Newton's method.

    Parameters
    ----------
    problem
        The equations.
    preconditioner
        Function that returns the solver of a matrix that is regular where the tangent leads
        nowhere.
    tolerance
        Norm of the residual that is an equilibrium.
    note
        Function that records the evaluation after each iteration.
    """

    def __init__(
        self,
        problem: Problem,
        preconditioner: Callable[[Evaluation], Solve],
        tolerance: float,
        note: Callable[[Evaluation], None],
    ) -> None:
        self._problem = problem
        self._preconditioner = preconditioner
        self._tolerance = tolerance
        self._note = note
        self._anderson = Anderson()
        self._made = 0

    def solve(self, now: Evaluation) -> Evaluation:
        """Iterate to equilibrium; where the iterations stall, return the best evaluation."""
        while now.norm > self._tolerance:
            nearer = self._newton(self._approach(now))
            if not nearer.norm < _HALF * now.norm:
                logger.info(
                    "accelerated iterations stall at a residual of %.1e after %d iterations",
                    nearer.norm,
                    self._made,
                )
                return nearer
            now = nearer
        return now

    def _approach(self, now: Evaluation) -> Evaluation:
        """Return the best of iterations down to a tenth of the residual, or until they stall."""
        target = max(_LEFT * now.norm, self._tolerance)
        best = now
        sizes = [now.norm]
        since = 0  # iterations without progress
        while now.norm > target and since < _STALLED and self._made < _MOST:
            try:
                if (len(sizes) - 1) % _RENEWED == 0:
                    solve = self._preconditioner(now)
                combined, reduced = self._anderson.combine(now.residual)
                step = combined + solve(reduced, _ROUGH)
                new = self._shortened(now, step, _GROWTH * max(sizes[-_LAST:]))
            except (NotConverged, SingularSystem) as error:
                logger.info("accelerated iterations end: %s", error)
                return best
            if not np.isfinite(new.norm):
                return best
            self._record(now, new)
            if new.norm < _PROGRESS * best.norm:
                since = 0
            else:
                since = since + 1
            if new.norm < best.norm:
                best = new
            sizes.append(new.norm)
            now = new
        return best

    def _shortened(self, now: Evaluation, step: ndarray, largest: float) -> Evaluation:
        """Return the evaluation after a step that is halved where the residual grows too much."""
        new = self._problem.evaluate(now.z + step)
        for _ in range(_HALVINGS):
            if new.norm < largest:
                break
            step = 0.5 * step
            new = self._problem.evaluate(now.z + step)
        return new

    def _newton(self, now: Evaluation) -> Evaluation:
        """Return the evaluation after steps of Newton's method, as long as these get on."""
        slow = 0
        while now.norm > self._tolerance and slow < _SLOW:
            try:
                step = self._problem.direction(now, damped=False)
                new = self._full_or_shorter(now, step)
            except (NotConverged, SingularSystem):
                return now
            if not new.norm < _NO_FALL * now.norm:
                return now
            slow = 0 if new.norm < _HALF * now.norm else slow + 1
            self._record(now, new)
            now = new
        return now

    def _full_or_shorter(self, now: Evaluation, step: ndarray) -> Evaluation:
        """Return the evaluation after a full step, or after a shorter one that is better."""
        full = self._problem.evaluate(now.z + step)
        if full.norm < _HALF * now.norm:
            return full
        shorter = self._problem.evaluate(now.z + _SHORTER * step)
        if shorter.norm < full.norm:
            return shorter
        return full

    def _record(self, before: Evaluation, now: Evaluation) -> None:
        """Record an iteration."""
        self._made += 1
        self._anderson.record(before, now)
        self._note(now)
        logger.debug("accelerated iteration %d: residual %.3e", self._made, now.norm)
