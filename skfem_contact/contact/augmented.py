"""Augmented Lagrangian enforcement: an outer loop over the same contact forms (Uzawa)."""
from __future__ import annotations

import logging
from dataclasses import dataclass, replace

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csc_matrix, diags_array
from scipy.sparse.linalg import spsolve

from ..errors import is_number
from .laws import Status
from .quadrature import SlavePoints
from .state import ContactState

logger = logging.getLogger("skfem_contact")

#: Penalty over the stiffness of the surfaces that the method goes to from whatever it was given, and the one that it
#: goes to where the corrections hardly become less: in a tie of 3 elements with 7 of a body 14 times as stiff by a
#: tenth each time, so that 30 equilibria are not enough; with the second one 26 iterations are.
_WANTED, _HARDEST = 10.0, 100.0
#: ... and the softest one that it starts from: with less, bodies might sink into each other by more than an element.
_SOFTEST = 0.1
#: Share of the largest entry that is added to the products of the shape functions: fewer points than nodes, as two on
#: a quadratic facet, leave combinations of multipliers that nothing tells, and that are kept.
_INDIFFERENT = 1e-10
#: Share of the largest traction below which the mean at a node is none: beside a corner, where the halves of an open
#: element cancel, the last bits would decide.
_ROUND_OFF = 1e-12
#: A correction that has not become less by this factor so many times in a row will not do so.
_PROGRESS, _PATIENCE = 0.7, 2


@dataclass(frozen=True)
class Progress:
    """How the corrections of an increment have gone.

    What the multipliers were corrected by the last time, over the penalties, (dim, n_nodes); how many times in a row
    that had not become less, (dim, n_nodes); and the largest error of the tractions that was corrected.
    """

    correction: ndarray | float = np.inf
    stalls: ndarray | int = 0
    error: float = np.inf

    def after(self, correction: ndarray, unfinished: ndarray, error: float) -> Progress:
        """With one more correction; those that are small enough do not count."""
        no_less = unfinished & (np.abs(correction) > _PROGRESS * np.abs(self.correction))
        stalls = np.where(no_less, self.stalls + 1, 0)
        if (left := (stalls == _PATIENCE).any(axis=0)).any():
            logger.info("augmented method: corrections at the nodes %s of the slave do not become less; the penalty "
                        "acts there", np.flatnonzero(left))
        return Progress(correction, stalls, error)


@dataclass(frozen=True)
class AugmentedLagrangian:
    r"""Multipliers that take over the tractions until nothing penetrates: no penalty needs to be chosen.

    After an increment has converged, the tractions become multipliers,
    :math:`\lambda_N \leftarrow \lambda_N + \epsilon_N \bar g`, and the increment is solved again: each time the
    penetration shrinks by the factor :math:`1 / (1 + \epsilon_N / k)`, where k is the stiffness of the bodies'
    surfaces.  What is left of gap and elastic slip, times k, is the error of the tractions.

    The multipliers live at the slave's nodes and are interpolated between them: multipliers at every Gauss point
    would constrain more than the nodes can follow.  Where the nodes are closed they become the projection of the
    tractions onto these functions, which exerts the same nodal forces.

    Where both bodies are held, as at the end of an interface on a fixed base, no multiplier closes what their meshes
    leave open: a node whose correction does not become less is left to the penalty, and the log names it.

    A given penalty is only the start.  It is brought between k/10 and 10 k before the first solution, where neither
    the bodies sink into each other nor Newton's method chatters, to 10 k after it, and to 100 k where the corrections
    hardly become less.  Between the nodes facets that do not match gape and overlap, which is left to that penalty:
    with 4 elements on 7 the displacements of the surfaces differ by 1 % between 10 k and 100 k.

    Parameters
    ----------
    tolerance
        Error of the tractions, relative to the largest one, that is small enough.

    Raises
    ------
    ValueError
        Tolerance outside (0, 1).

    Examples
    --------
    >>> from skfem_contact import AugmentedLagrangian
    >>> AugmentedLagrangian().tolerance
    0.0001
    """

    tolerance: float = 1e-4

    def __post_init__(self) -> None:
        if not is_number(self.tolerance, 0.0, 1.0):
            raise ValueError(f"AugmentedLagrangian: tolerance must lie in (0, 1), not {self.tolerance!r}")

    def start(self, penalties: tuple[float, float], stiffness: float) -> ndarray:
        """Factors, (2,), that bring the penalties into the range from which the first solution succeeds."""
        return np.clip(penalties, _SOFTEST * stiffness, _WANTED * stiffness) / penalties

    def augment(self, accepted: ContactState, found: ContactState, points: SlavePoints,
                penalties: tuple[float, float], stiffness: float, progress: Progress
                ) -> tuple[ContactState, Progress]:
        """The accepted state with improved multipliers, or the same one where they are good enough; the progress made.

        Parameters
        ----------
        accepted, found
            State at the start of the increment, and the one that has been found.
        penalties
            Normal and tangential penalty.
        stiffness
            Traction per displacement of the bodies' surfaces.
        """
        moves = np.broadcast_to(progress.stalls < _PATIENCE, accepted.multiplier.shape)
        after, correction, error = self._corrected(found, accepted.multiplier, points, penalties, stiffness, moves)
        unfinished = error > (limit := self.tolerance * np.abs(found.traction[0]).max(initial=0.0))
        if progress.error == np.inf:  # what was left to the penalty before is taken up again where it has changed
            _, left, before = self._corrected(accepted, accepted.multiplier, points, penalties, stiffness, moves)
            unfinished &= (before <= limit) | (stiffness * np.abs(correction - left) > limit)
        if not (unfinished & moves).any():
            return accepted, progress
        worst = float(error[moves].max())
        hardest = (_HARDEST if worst > _PROGRESS * progress.error else _WANTED) * stiffness
        factors = np.clip(penalties, hardest, _HARDEST * stiffness) / penalties
        improved = replace(accepted, multiplier=np.where(moves, after, accepted.multiplier),
                           penalty_factor=accepted.penalty_factor * factors)
        return improved, progress.after(correction, unfinished, worst)

    def error(self, state: ContactState, points: SlavePoints, penalties: tuple[float, float], stiffness: float
              ) -> float:
        """Largest error of the tractions of an accepted state, relative to the largest of them."""
        moves = np.ones(state.multiplier.shape, dtype=bool)
        _, _, error = self._corrected(state, state.multiplier, points, penalties, stiffness, moves)
        return float(error.max() / max(np.abs(state.traction[0]).max(initial=0.0), np.finfo(float).tiny))

    @staticmethod
    def _corrected(found: ContactState, before: ndarray, points: SlavePoints, penalties: tuple[float, float],
                   stiffness: float, moves: ndarray) -> tuple[ndarray, ndarray, ndarray]:
        """Improved multipliers, what that corrects over the penalties, and the error of the tractions."""
        pressure = found.traction[0]
        largest = pressure.max(initial=0.0)  # a mean of tractions is no larger; zero where nothing pulls
        none = largest - _ROUND_OFF * np.abs(pressure).max(initial=0.0)
        closed = before[0] + _excess(points, pressure, before[0]) < none
        after = np.stack([_improved(points, traction, multiplier, closed & moving)
                          for traction, multiplier, moving in zip(found.traction, before, moves, strict=True)])
        after[0] = np.minimum(after[0], largest)
        correction = (after - before) / np.array([penalties[0], *penalties[1:] * (len(before) - 1)])[:, None]
        # a sliding point's traction follows from the normal one; only where it sticks is its elastic slip an error
        sticks = _nodal_mean(points, found.status == Status.STICK) > 0.99
        error = stiffness * np.abs(correction) * np.stack((np.ones(len(sticks)), *[sticks] * (len(before) - 1)))
        return after, correction, error


def _improved(points: SlavePoints, traction: ndarray, multiplier: ndarray, closed: ndarray) -> ndarray:
    """Multipliers that exert the tractions' forces at the closed nodes, and are their means at the others."""
    excess = _excess(points, traction, multiplier)
    at, mass = np.flatnonzero(closed), _mass(points)
    mass = csc_matrix(mass + diags_array(np.full(mass.shape[0], _INDIFFERENT * mass.diagonal().max())))
    forces = _integral(points, traction - points.at(multiplier), points.values)
    excess[at] = spsolve(mass[at][:, at].tocsc(), forces[at])
    return multiplier + excess


def _excess(points: SlavePoints, traction: ndarray, multiplier: ndarray) -> ndarray:
    """Means at the nodes of what the tractions exceed the multipliers by."""
    return _nodal_mean(points, traction - points.at(multiplier))


def _mass(points: SlavePoints) -> csc_matrix:
    """Integrals of the products of the slave's shape functions, (n_nodes, n_nodes)."""
    N = points.values
    n, k = points.nodes.max() + 1, N.shape[1]
    products = points.weight[:, None, None] * N[:, :, None] * N[:, None, :]
    rows, columns = np.repeat(points.nodes, k, axis=1), np.tile(points.nodes, (1, k))
    return coo_matrix((products.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n)).tocsc()


def _nodal_mean(points: SlavePoints, values: ndarray) -> ndarray:
    """Means of values at the points, weighted by the shape functions of each slave node.

    They count by their size: with their sign those of a quadratic element have no weight on an axis of symmetry.  A
    node without points has the mean zero.
    """
    size = np.abs(points.values)
    weight = _integral(points, np.ones(len(values)), size)
    return _integral(points, values, size) / np.where(weight > 0.0, weight, np.inf)


def _integral(points: SlavePoints, values: ndarray, shapes: ndarray) -> ndarray:
    """Integrals of values at the points times functions of each slave node, (n_points, k)."""
    share = shapes * (points.weight * values)[:, None]
    return np.asarray(np.bincount(points.nodes.ravel(), share.ravel(), points.nodes.max() + 1))
