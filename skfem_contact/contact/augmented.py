"""Augmented Lagrangian method: multipliers at the slave's nodes take over the tractions."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix, diags_array
from scipy.sparse.linalg import lsqr, spsolve
from typing_extensions import override

from ..arrays import max_abs
from ..checks import is_number
from ..errors import Remark
from ..surfaces.surface import Surface
from .compliance import on_gaps_between_nodes, on_penetration, on_round_off
from .enforcement import check_corners
from .interface import ContactState
from .laws import InterfaceLaw, Status
from .penalty import Penalty
from .quadrature import SlavePoints

logger = logging.getLogger("skfem_contact")

#: Penalty over the stiffness of the surfaces that the method goes to from whatever it was given,
#: and the one that it goes to where the corrections hardly become less: in a tie of 3 elements with
#: 7 of a body 14 times as stiff by a tenth each time, so that 30 equilibria are not enough; with
#: the second one 26 iterations are.
_WANTED = 10.0
_HARDEST = 100.0
#: ... and the softest one that it starts from: with less, bodies might sink into each other by more
#: than an element.
_SOFTEST = 0.1
#: Share of the largest entry that is added to the products of the shape functions: fewer points
#: than nodes, as two on a quadratic facet, leave combinations of multipliers undetermined, which
#: are kept.
_INDIFFERENT = 1e-10
#: Share of the largest traction below which the mean at a node is none: beside a corner, where the
#: halves of an open element cancel, the last bits would decide.
_ROUND_OFF = 1e-12
#: A correction that has not become less by this factor so many times in a row will not do so.
_PROGRESS = 0.7
_PATIENCE = 2
_ACCURACY = 1e-14
#: Error of the tractions, as a share of the largest one, with which bonds may break: an accurate
#: equilibrium before each break takes 12 solutions, and 30 are allowed in an increment.
_SETTLED = 1e-3
#: Bonds with this share of the largest overload break together with the one that has it, and so do
#: all bonds with this overload: the increment is too large for an order.
_TOGETHER = 0.9
_FAR = 2.0
_NONE = np.zeros((1, 1), bool)  # mask of no multipliers


@dataclass(frozen=True)
class Progress:
    """Corrections over the penalties and their stalls, (dim, n_nodes), and the tractions' error."""

    correction: ndarray | float = np.inf
    stalls: ndarray | int = 0
    error: float = np.inf

    def after(self, correction: ndarray, unfinished: ndarray, error: float) -> Progress:
        """Return the progress after one more correction; finished corrections do not count."""
        no_less = unfinished & (np.abs(correction) > _PROGRESS * np.abs(self.correction))
        stalls = np.where(no_less, self.stalls + 1, 0)
        given_up = (stalls == _PATIENCE).any(axis=0)
        if given_up.any():
            logger.info(
                "augmented method: corrections at the nodes %s of the slave do not become less; "
                "the penalty acts there",
                np.flatnonzero(given_up),
            )
        return Progress(correction, stalls, error)


#: Progress at the start of further corrections in an increment.
_AGAIN = Progress(error=np.finfo(float).max)


@dataclass(frozen=True)
class AugmentedLagrangian(Penalty):
    r"""Augmented Lagrangian method: multipliers take over the tractions until nothing penetrates.

    After an increment has converged, the tractions become multipliers,
    :math:`\lambda_N \leftarrow \lambda_N + \epsilon_N \bar g`, and the increment is solved again:
    each time the penetration shrinks by the factor :math:`1 / (1 + \epsilon_N / k)` with the
    stiffness k of the bodies' surfaces. The remaining gap and elastic slip, times k, are the error
    of the tractions.

    Multipliers live at the slave's nodes and are interpolated between them: multipliers at every
    Gauss point would constrain more than the nodes can follow.  At closed nodes they become the
    projection of the tractions onto these functions, which exerts the same nodal forces.  A node
    whose correction does not become less is left to the penalty, and the log names it.  A node that
    supports hold on both sides, as at the end of an interface on a fixed base, follows its
    neighbours.

    A given penalty is only the start.  It is brought between k/10 and 10 k before the first
    solution, to 10 k after it, and to 100 k where the corrections hardly become less and no point
    is open, or nodes have been left to the penalty.  Between the
    nodes facets that do not match gape and overlap, which is left to that penalty.

    Parameters
    ----------
    tolerance : float
        Error of the tractions, relative to the largest one, that is small enough; between 0 and 1.

    Examples
    --------
    >>> from skfem_contact import AugmentedLagrangian
    >>> AugmentedLagrangian().tolerance
    0.0001
    """

    tolerance: float = 1e-4

    keeps_penalty = False
    outer_after = "exact"

    def __post_init__(self) -> None:
        if not is_number(self.tolerance, 0.0, 1.0):
            raise ValueError(
                f"AugmentedLagrangian: tolerance must lie in (0, 1), not {self.tolerance!r}"
            )

    @override
    def check(self, slave: Surface, law: InterfaceLaw, quadrature: Any, share: float) -> None:
        check_corners(slave)

    @override
    def start(self, pair: Any, state: ContactState) -> ContactState:
        """Return the state with factors that bring the penalties into the range of the start."""
        if pair.penalty is None or pair.stiffness is None:
            return state
        lowest = _SOFTEST * pair.stiffness
        highest = _WANTED * pair.stiffness
        return replace(state, penalty_factor=np.clip(pair.penalty, lowest, highest) / pair.penalty)

    @override
    def start_with(
        self,
        pair: Any,
        state: ContactState,
        tractions: ndarray,
    ) -> tuple[ContactState, ndarray]:
        points = pair.points(state)
        rows = np.repeat(np.arange(len(points.weight)), points.nodes.shape[1])
        shapes = csr_matrix((points.values.ravel(), (rows, points.nodes.ravel())))
        nodal = []
        for part in tractions:
            multiplier, *_ = lsqr(shapes, part, atol=_ACCURACY, btol=_ACCURACY)
            nodal.append(multiplier)
        multipliers = np.stack(nodal)
        return replace(state, multiplier=multipliers), tractions - multipliers @ shapes.T

    @override
    def law_in_increment(self, pair: Any) -> InterfaceLaw:
        """Return the law whose bonds hold: they break between equilibria alone.

        A new multiplier adds to the traction at the start of a solution, up to twice of it.
        """
        return pair.law.unbreakable()

    @override
    def after_equilibrium(
        self,
        pair: Any,
        accepted: ContactState,
        found: ContactState,
    ) -> tuple[ContactState, dict[str, Any]]:
        if pair.stiffness is None:
            stiffness = pair.penalty[0]
        else:
            stiffness = pair.stiffness
        state, progress = self._augment(
            accepted,
            found,
            pair.points(accepted),
            pair.penalties(accepted),
            stiffness,
            pair.progress,
            _kept(pair),
            _followed(pair),
        )

        # Break the most overloaded bonds once their tractions are known accurately enough
        margin = _ROUND_OFF
        settled = state is accepted
        if not settled:
            margin = 10.0 * _SETTLED
            settled = progress.error <= _SETTLED * max_abs(found.traction[0])
        if settled:
            overload = pair.law.take(pair.points(accepted)).overload(found.traction, found.internal)
            worst = overload.max(initial=0.0)
            if worst > 1.0 + margin:
                broken = overload >= max(1.0, min(_TOGETHER * worst, _FAR))
                if pair.debonded is not None:
                    broken |= pair.debonded
                return replace(accepted), {"progress": _AGAIN, "debonded": broken}

        # Keep the tractions where the tangential penalty has become harder
        harder = state.penalty_factor[1] / accepted.penalty_factor[1]
        if harder != 1.0:
            elastic = pair.interface.elastic_slip(state)
            state = pair.interface.with_elastic_slip(state, elastic / harder)
        return state, {"progress": progress}

    @override
    def remarks(
        self,
        pair: Any,
        x: ndarray,
        state: ContactState,
        meshed: ndarray,
    ) -> Iterator[Remark]:
        penalties = pair.penalties(state)
        stiffness = pair.stiffness or penalties[0]
        error = self.error(
            state, pair.points(state), penalties, stiffness, _kept(pair), _followed(pair)
        )
        if error > self.tolerance:
            yield Remark(
                "multipliers",
                error,
                f"the multipliers of '{pair.slave.name}' leave an error of {error:.2%} of the "
                "largest traction: at some nodes they do not converge, and the penalty acts there",
            )
        yield from on_gaps_between_nodes(pair, x, state, meshed)
        yield from on_penetration(pair, state)
        yield from on_round_off(pair, state)

    def error(
        self,
        state: ContactState,
        points: SlavePoints,
        penalties: tuple[float, float],
        stiffness: float,
        kept: ndarray,
        followed: csr_matrix | None,
    ) -> float:
        """Return the error of the tractions of an accepted state, relative to the largest one."""
        moves = np.broadcast_to(~kept, state.multiplier.shape)
        _, _, error = self._corrected(
            state, state.multiplier, points, penalties, stiffness, moves, followed
        )
        error = np.where(kept, 0.0, error)
        largest = max_abs(state.traction[0])
        return float(error.max() / max(largest, np.finfo(float).tiny))

    def _augment(
        self,
        accepted: ContactState,
        found: ContactState,
        points: SlavePoints,
        penalties: tuple[float, float],
        stiffness: float,
        progress: Progress,
        kept: ndarray,
        followed: csr_matrix | None,
    ) -> tuple[ContactState, Progress]:
        """Return the accepted state, with better multipliers unless these suffice, and progress."""
        # Find the multipliers whose error is too large
        moves = np.broadcast_to((progress.stalls < _PATIENCE) & ~kept, accepted.multiplier.shape)
        after, correction, error = self._corrected(
            found, accepted.multiplier, points, penalties, stiffness, moves, followed
        )
        limit = self.tolerance * max_abs(found.traction[0])
        unfinished = (error > limit) & ~kept
        if progress.error == np.inf:
            # Take up again multipliers left to the penalty before, where they have changed: errors
            # of nodes that slid before and stick now as well
            before = self._corrected(
                accepted, accepted.multiplier, points, penalties, stiffness, moves, followed
            )[1]
            left = stiffness * np.abs(before) > limit
            changed = stiffness * np.abs(correction - before) > limit
            unfinished &= ~left | changed
        if not (unfinished & moves).any():
            return accepted, progress

        # Improve them, with a harder penalty where the error hardly becomes less; beside open
        # points, where that makes peaks, only if nodes have been given up
        worst = float(error[moves].max())
        opened = (found.status == Status.OPEN) & np.isfinite(found.gap)
        needed = not opened.any() or np.max(progress.stalls) >= _PATIENCE
        hardly = needed and worst > _PROGRESS * progress.error
        hardest = (_HARDEST if hardly else _WANTED) * stiffness
        factors = np.clip(penalties, hardest, _HARDEST * stiffness) / penalties
        improved = replace(
            accepted,
            multiplier=np.where(moves, after, accepted.multiplier),
            penalty_factor=accepted.penalty_factor * factors,
        )
        return improved, progress.after(correction, unfinished, worst)

    @staticmethod
    def _corrected(
        found: ContactState,
        before: ndarray,
        points: SlavePoints,
        penalties: tuple[float, float],
        stiffness: float,
        moves: ndarray,
        followed: csr_matrix | None,
    ) -> tuple[ndarray, ndarray, ndarray]:
        """Return improved multipliers, corrections over the penalties, and errors of tractions."""
        # Project the tractions where nodes are closed; a mean of tractions is no larger than the
        # largest one, which is zero where nothing pulls
        pressure = found.traction[0]
        largest = pressure.max(initial=0.0)
        size = _nodal_mean(points, np.abs(pressure))
        none = _ROUND_OFF * max_abs(pressure)
        closed = size > 0.0
        if largest <= none:
            closed = before[0] + _excess(points, pressure, before[0]) < largest - none
        after = _improved(points, found.traction, before, closed & moves, followed)
        after[0] = np.minimum(after[0], largest)

        # Without tractions around a node its multiplier would vanish by halves
        after[:, size == 0.0] = 0.0

        # A sliding point's traction follows from the normal one: only where a node sticks is its
        # elastic slip an error
        n_shear = len(before) - 1
        eps = np.array([penalties[0], *penalties[1:] * n_shear])
        correction = (after - before) / eps[:, None]
        sticks = _nodal_mean(points, found.status == Status.STICK) > 0.99
        counts = np.stack((np.ones(len(sticks)), *[sticks] * n_shear))
        return after, correction, stiffness * np.abs(correction) * counts


def _kept(pair: Any) -> ndarray:
    """Return multipliers that stay zero, (dim, n_nodes) or less: of slip that supports hold.

    They would act on the master's inside alone, next to a plane of symmetry without friction. Ends
    that are held across the surface as well are no such plane.
    """
    if pair.symmetry is None:
        return _NONE
    along = pair.symmetry.along & ~pair.symmetry.across
    return np.concatenate((np.zeros((1, along.shape[1]), bool), along))


def _followed(pair: Any) -> csr_matrix | None:
    """Return means of neighbours for nodes that supports hold across the surface, or None."""
    return None if pair.symmetry is None else pair.symmetry.followed


def _improved(
    points: SlavePoints,
    traction: ndarray,
    multiplier: ndarray,
    closed: ndarray,
    followed: csr_matrix | None,
) -> ndarray:
    """Return multipliers with the tractions' nodal forces at closed nodes, means at the others."""
    excess = []
    forces = []
    for own, other in zip(traction, multiplier, strict=True):
        excess.append(_excess(points, own, other))
        forces.append(_integral(points, own - points.at(other), points.values))
    change = np.stack(excess)
    force = np.stack(forces)
    mass = _mass(points)
    diagonal = mass.diagonal()
    indifferent = np.full_like(diagonal, _INDIFFERENT * diagonal.max())
    mass = csc_matrix(mass + diags_array(indifferent))

    # Factor once for all directions with the same closed nodes, mostly all of them
    for nodes in np.unique(closed, axis=0):
        rows = np.flatnonzero((closed == nodes).all(axis=1))
        # Functions of nodes that follow others belong to these
        led = np.zeros(len(nodes), bool)
        spread = mass
        if followed is not None:
            led = nodes & (np.diff(followed.indptr) > 0)
            spread = csc_matrix(mass + mass @ (diags_array(led.astype(float)) @ followed))
        at = np.flatnonzero(nodes & ~led)
        of_nodes = spread[at][:, at].tocsc()
        solution = spsolve(of_nodes, force[rows][:, at].T)
        change[rows[:, None], at] = solution.reshape(len(at), len(rows)).T
        if followed is not None and led.any():
            mean = (multiplier + change)[rows] @ followed.T
            change[np.ix_(rows, led)] = (mean - multiplier[rows])[:, led]
    return multiplier + change


def _excess(points: SlavePoints, traction: ndarray, multiplier: ndarray) -> ndarray:
    """Return nodal means of tractions less the interpolated multipliers."""
    return _nodal_mean(points, traction - points.at(multiplier))


def _mass(points: SlavePoints) -> csc_matrix:
    """Return integrals of products of the nodes' shape functions, shape (n_nodes, n_nodes)."""
    N = points.values
    n = points.nodes.max() + 1
    k = N.shape[1]
    products = points.weight[:, None, None] * N[:, :, None] * N[:, None, :]  # (n_points, k, k)
    rows = np.repeat(points.nodes, k, axis=1)
    columns = np.tile(points.nodes, (1, k))
    entries = (products.ravel(), (rows.ravel(), columns.ravel()))
    return coo_matrix(entries, shape=(n, n)).tocsc()


def _nodal_mean(points: SlavePoints, values: ndarray) -> ndarray:
    """Return nodal means of values at the points, weighted by the size of the shape functions.

    With their sign the functions of a quadratic element have no weight on an axis of symmetry.
    """
    size = np.abs(points.values)
    weight = _integral(points, np.ones(len(values)), size)
    return _integral(points, values, size) / np.where(weight > 0.0, weight, np.inf)


def _integral(points: SlavePoints, values: ndarray, shapes: ndarray) -> ndarray:
    """Return integrals of values times the nodes' functions, shape (n_nodes,)."""
    share = shapes * (points.weight * values)[:, None]
    count = points.nodes.max() + 1
    return np.asarray(np.bincount(points.nodes.ravel(), share.ravel(), count))
