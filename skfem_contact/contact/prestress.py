"""Contact that carries given forces from the first moment on: pre-stressed in equilibrium."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy import ndarray
from scipy.sparse import coo_matrix, csr_matrix, diags_array, hstack
from scipy.sparse.linalg import lsqr

from ..surfaces.material_points import MaterialPoints, behind
from .laws import Status
from .state import ContactState

if TYPE_CHECKING:
    from .pair import ContactPair

#: Components of a stress at their places in the tensor.
_TENSOR = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
_ACCURACY = 1e-14
_MOST = 10_000


def prestressed(operators: Mapping[str, TractionOperator], force: ndarray, where: ndarray | None = None,
                guess: Mapping[str, ndarray] | None = None) -> dict[str, ContactState]:
    """States in which pairs carry given nodal forces.

    Of all tractions with these nodal forces those of least norm are taken, or those nearest to a guess. Gap and
    slip then begin where the penalty answers with these tractions, less what multipliers carry: nothing moves.
    What the law does not allow, such as tension, is left out.

    Parameters
    ----------
    operators
        How the tractions of each pair make nodal forces (:meth:`ContactPair.tractions_at`), by name.
    force
        Internal forces that the pairs are to exert together, (N,).
    where
        Layout at which the forces count; by default all.
    guess
        Stresses (xx, yy, zz, xy, in space yz, zx too) at the points whose tractions to be near to, (4 or 6, n_points),
        by pair.
    """
    where = np.arange(len(force)) if where is None else where
    near = {name: np.zeros(a.forces.shape[1]) if guess is None else a.of_stress(guess[name])
            for name, a in operators.items()}
    left = force - sum(a.forces @ near[name] for name, a in operators.items())
    operator = csr_matrix(hstack([a.forces @ diags_array(a.scale) for a in operators.values()]))[where]
    found = lsqr(operator, left[where], atol=_ACCURACY, btol=_ACCURACY, conlim=0.0, iter_lim=_MOST)[0]
    ends = np.cumsum([0] + [len(a.scale) for a in operators.values()])
    return {name: a.state_with(near[name] + a.scale * found[ends[k]:ends[k + 1]])
            for k, (name, a) in enumerate(operators.items())}


class TractionOperator:
    """Tractions at the points of a pair, and their nodal forces.

    Attributes
    ----------
    forces
        Matrix from the tractions at all points, (dim n_points,), the normal ones first, to nodal forces (N,).
    scale
        Tractions for each of which the integral of the square is one, (dim n_points,).
    places
        Where the points are in the mesh, (n_points, dim).
    """

    def __init__(self, pair: ContactPair, x: ndarray, state: ContactState) -> None:
        self._pair, self._x, self._state = pair, x, state
        self._points = points = pair.points(state)
        found = pair.interface.closest(x, state.cuts, state.facet)
        self._at = at = np.flatnonzero(found.found & (state.status != Status.OPEN))
        self._frame = frame = pair.interface.variations(x, state, found, at)
        self.places = points.positions(pair.slave.nodes)
        n, dim, weight = len(points.weight), pair.slave.dim, pair.share * points.weight[at]
        values = weight[:, None, None] * frame.work
        rows = np.broadcast_to(frame.dofs[:, None], values.shape)
        columns = np.broadcast_to((at[:, None] + n * np.arange(dim))[:, :, None], values.shape)
        moving = rows >= 0
        self.forces = coo_matrix((values[moving], (rows[moving], columns[moving])), shape=(pair.size, dim * n)).tocsr()
        self.scale = np.tile(1.0 / np.sqrt(points.weight), dim)

    def of_stress(self, stress: ndarray) -> ndarray:
        """Tractions of a field of stresses at the points."""
        frame, dim = self._frame, self._pair.slave.dim
        vector = np.einsum("ijn,nj->ni", stress[:, self._at][_TENSOR[:dim, :dim]], frame.normal)
        tractions = np.zeros((dim, len(self._points.weight)))
        tractions[0, self._at] = np.einsum("nc,nc->n", vector, frame.normal)
        tractions[1:, self._at] = np.einsum("nic,nc->in", frame.tangents, vector)
        return tractions.ravel()

    def state_with(self, tractions: ndarray) -> ContactState:
        """The state in which the pair carries them."""
        pair, state, points = self._pair, self._state, self._points
        tractions = tractions.reshape(pair.slave.dim, -1)
        if pair.enforcement is not None:
            at_points = np.repeat(np.arange(len(points.weight)), points.nodes.shape[1])
            shapes = csr_matrix((points.values.ravel(), (at_points, points.nodes.ravel())))
            nodal = np.stack([lsqr(shapes, part, atol=_ACCURACY, btol=_ACCURACY)[0] for part in tractions])
            state = replace(state, multiplier=nodal)
            tractions = tractions - nodal @ shapes.T
        by_gap, by_slip = pair.penalties(state)
        offset = np.where(state.status != Status.OPEN, state.gap - tractions[0] / by_gap, state.offset)
        at, stick = self._at, MaterialPoints(state.stick_facet.copy(), state.stick_point.T.copy())
        nodes = pair.interface.places(self._x)[1]
        stick.facet[at], stick.xi[at] = behind(pair.master, nodes, self._frame.tangents, self._frame.closest,
                                               tractions[1:, at].T / by_slip)
        return pair.assemble(self._x, replace(state, offset=offset).with_stick(stick)).state


def rebased(pair: ContactPair, state: ContactState) -> ContactState:
    """The state of a pair whose bodies are back in their places, with all it carries."""
    home = pair.initial_state()
    old, new = pair.points(state), pair.points(home)
    face = pair.interface
    elastic = face.elastic_slip(state)
    if pair.quadrature == "segments":
        excess = face.interpolated(old, new, np.where(np.isfinite(state.gap), state.gap - state.offset, 0.0))
        elastic = face.interpolated(old, new, elastic)
        state = replace(face.transferred(state, home.cuts, None), offset=np.zeros(len(excess)), gap=excess)
    near = np.isfinite(home.gap) & np.isfinite(state.gap)
    offset = np.where(near, home.gap - (state.gap - state.offset), 0.0)
    state = replace(state, facet=home.facet, position=home.position, gap=home.gap, slip=np.zeros_like(state.slip),
                    offset=offset)
    return face.with_elastic_slip(state.with_stick(home.stick), elastic)
