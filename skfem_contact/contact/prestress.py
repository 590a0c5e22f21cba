"""Contact that carries given forces from the first moment on: pre-stressed in equilibrium."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array, hstack
from scipy.sparse.linalg import lsqr

from .kinematics import variations
from .laws import Status
from .pair import ContactPair
from .state import ContactState

_ACCURACY = 1e-14
_MOST = 10_000


def prestressed(pairs: Mapping[str, ContactPair], x: ndarray, states: Mapping[str, ContactState], force: ndarray,
                where: ndarray | None = None, guess: Mapping[str, ndarray] | None = None) -> dict[str, ContactState]:
    """States in which pairs carry given nodal forces.

    Of all tractions with these nodal forces those of least norm are taken, or those nearest to a guess. Gap and
    slip then begin where the penalty answers with these tractions, less what multipliers carry: nothing moves.
    What the law does not allow, such as tension, is left out.

    Parameters
    ----------
    pairs
        Contact pairs by name, with penalties.
    x
        Displacements, (N,).
    states
        Their states; points that are not open take part.
    force
        Internal forces that the pairs are to exert together, (N,).
    where
        Unknowns at which the forces count; by default all.
    guess
        Stresses (xx, yy, zz, xy) at the points whose tractions to be near to, (4, n_points), by pair.
    """
    where = np.arange(len(force)) if where is None else where
    acting = {name: _Tractions(pair, x, states[name]) for name, pair in pairs.items()}
    near = {name: np.zeros(a.forces.shape[1]) if guess is None else a.of_stress(guess[name])
            for name, a in acting.items()}
    left = force - sum(acting[name].forces @ near[name] for name in pairs)
    operator = csr_matrix(hstack([a.forces @ diags_array(a.scale) for a in acting.values()]))[where]
    found = lsqr(operator, left[where], atol=_ACCURACY, btol=_ACCURACY, conlim=0.0, iter_lim=_MOST)[0]
    ends = np.cumsum([0] + [len(a.scale) for a in acting.values()])
    return {name: a.state_with(near[name] + a.scale * found[ends[k]:ends[k + 1]])
            for k, (name, a) in enumerate(acting.items())}


class _Tractions:
    """Tractions at the points of a pair, and their nodal forces.

    Attributes
    ----------
    forces
        Matrix from normal and tangential tractions at all points, (2 n_points,), to nodal forces (N,).
    scale
        Tractions for each of which the integral of the square is one, (2 n_points,).
    """

    def __init__(self, pair: ContactPair, x: ndarray, state: ContactState) -> None:
        self._pair, self._x, self._state = pair, x, state
        self._points = points = pair.points(state)
        slave, nodes = pair._places(x)
        positions = points.positions(slave)
        found = pair._project(points, nodes, positions, state.facet)
        at = np.flatnonzero(found.found & (state.status != Status.OPEN))
        frame = variations(points, pair.slave, pair.master, at, found, positions, state.stick_point, nodes)
        self._at, self._normal, self._tangent = at, frame.normal, frame.tangent
        self._stretch = np.ones(len(points.weight))
        self._stretch[at] = frame.stretch

        weight = (pair.share * points.weight[at])[:, None]
        values = np.concatenate((weight * frame.gap_gradient, weight * frame.tangential))
        rows, n = np.tile(frame.dofs, (2, 1)), len(points.weight)
        columns = np.broadcast_to(np.concatenate((at, at + n))[:, None], rows.shape)
        moving = rows >= 0
        self.forces = coo_matrix((values[moving], (rows[moving], columns[moving])), shape=(pair.n, 2 * n)).tocsr()
        self.scale = np.tile(1.0 / np.sqrt(points.weight), 2)

    def of_stress(self, stress: ndarray) -> ndarray:
        """Tractions of a field of stresses at the points."""
        xx, yy, _, xy = stress[:, self._at]
        nx, ny = self._normal.T
        vector = np.stack((xx * nx + xy * ny, xy * nx + yy * ny), axis=1)
        tractions = np.zeros((2, len(self._stretch)))
        tractions[:, self._at] = (vector * self._normal).sum(axis=1), (vector * self._tangent).sum(axis=1)
        return tractions.ravel()

    def state_with(self, tractions: ndarray) -> ContactState:
        """The state in which the pair carries them."""
        pair, state, points = self._pair, self._state, self._points
        normal, tangential = tractions.reshape(2, -1)
        if pair.enforcement is not None:
            at_points = np.repeat(np.arange(len(normal)), points.nodes.shape[1])
            shapes = csr_matrix((points.values.ravel(), (at_points, points.nodes.ravel())))
            nodal = [lsqr(shapes, part, atol=_ACCURACY, btol=_ACCURACY)[0] for part in (normal, tangential)]
            state = replace(state, multiplier=np.stack(nodal))
            normal, tangential = normal - shapes @ nodal[0], tangential - shapes @ nodal[1]
        by_gap, by_slip = pair.penalties(state)
        offset = np.where(state.status != Status.OPEN, state.gap - normal / by_gap, state.offset)
        stick_point = state.position - tangential / by_slip / self._stretch
        return pair.assemble(self._x, replace(state, offset=offset, stick_point=stick_point)).state
