"""Contact that carries given forces from the first moment on: pre-stressed in equilibrium."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy import ndarray
from scipy.sparse import block_diag, coo_matrix, csr_matrix, diags_array, hstack
from scipy.sparse.linalg import lsqr

from ..materials.coulomb import Status
from .kinematics import variations
from .pair import ContactPair
from .state import ContactState

_ACCURACY = 1e-14
_MOST = 10_000


def prestressed(pairs: Mapping[str, ContactPair], x: ndarray, states: Mapping[str, ContactState], force: ndarray,
                where: ndarray | None = None, guess: Mapping[str, ndarray] | None = None) -> dict[str, ContactState]:
    """States in which pairs carry given nodal forces.

    Of all tractions with these nodal forces those of least norm are taken, or those nearest to a guess. Gap and
    slip then begin where the penalty answers with these tractions, or the multipliers are these: nothing moves.
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
        Normal and tangential tractions, (2, n_points), by pair.
    """
    where = np.arange(len(force)) if where is None else where
    acting = {name: _Tractions(pair, x, states[name]) for name, pair in pairs.items()}
    near = {name: np.zeros(a.forces.shape[1]) if guess is None else guess[name].ravel() for name, a in acting.items()}
    left = force - sum(acting[name].forces @ near[name] for name in pairs)
    operator = csr_matrix(hstack([a.forces @ a.shapes for a in acting.values()]))[where]
    found = lsqr(operator, left[where], atol=_ACCURACY, btol=_ACCURACY, conlim=0.0, iter_lim=_MOST)[0]
    ends = np.cumsum([0] + [a.shapes.shape[1] for a in acting.values()])
    return {name: a.state_with(near[name] + a.shapes @ found[ends[k]:ends[k + 1]])
            for k, (name, a) in enumerate(acting.items())}


class _Tractions:
    """Tractions at the points of a pair: their nodal forces, and the functions that they are made of.

    Attributes
    ----------
    forces
        Matrix from normal and tangential tractions at all points, (2 n_points,), to nodal forces (N,).
    shapes
        Matrix to these tractions from what is sought: themselves, weighted so that their norm is their mean
        square, or values at the slave's nodes where multipliers take them.
    """

    def __init__(self, pair: ContactPair, x: ndarray, state: ContactState) -> None:
        self._pair, self._x, self._state = pair, x, state
        self._points = points = pair.points(state)
        slave, nodes = pair._places(x)
        positions = points.positions(slave)
        found = pair._project(points, nodes, positions, state.segment)
        at = np.flatnonzero(found.found & (state.status != Status.OPEN))
        rho = pair.master.curve(found.segment[at], found.xi[at], nodes)[1]
        elastic = np.zeros(len(at))
        frame = variations(points, pair.slave, pair.master, at, found, positions[at] - rho[0], elastic, nodes)
        metric = pair.master.arc(found.segment[at], found.xi[at])[1]
        self._stretch = np.ones(len(points.weight))
        self._stretch[at] = np.linalg.norm(rho[1], axis=1) / metric

        weight = (pair.share * points.weight[at])[:, None]
        values = np.concatenate((weight * frame.gap_gradient, weight * frame.tangential))
        rows, n = np.tile(frame.dofs, (2, 1)), len(points.weight)
        columns = np.broadcast_to(np.concatenate((at, at + n))[:, None], rows.shape)
        moving = rows >= 0
        self.forces = coo_matrix((values[moving], (rows[moving], columns[moving])), shape=(pair.n, 2 * n)).tocsr()

        if pair.enforcement is None:
            one = diags_array(1.0 / np.sqrt(points.weight))
        else:
            at_points = np.repeat(np.arange(n), points.nodes.shape[1])
            one = coo_matrix((points.values.ravel(), (at_points, points.nodes.ravel())))
        self.shapes = csr_matrix(block_diag((one, one)))

    def state_with(self, tractions: ndarray) -> ContactState:
        """The state in which the pair carries them."""
        pair, state = self._pair, self._state
        if pair.enforcement is None:
            normal, tangential = tractions.reshape(2, -1) / np.array(pair.penalties(state))[:, None]
            offset = np.where(state.status != Status.OPEN, state.gap - normal, state.offset)
            new = replace(state, offset=offset, stick_point=state.arc - tangential / self._stretch)
        else:
            nodal = lsqr(self.shapes, tractions, atol=_ACCURACY, btol=_ACCURACY)[0].reshape(2, -1)
            new = replace(state, normal_multiplier=nodal[0], tangential_multiplier=nodal[1])
        return pair.assemble(self._x, new).state
