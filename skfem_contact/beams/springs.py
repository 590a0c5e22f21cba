"""Springs by curves of the ground along a pile: p-y, t-z and q-z."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix
from typing_extensions import override

from ..arrays import left_of, row_norms
from ..checks import finite
from ..forms.base import Form, Outputs, Response
from ..forms.roles import Couples, Staged
from ..layout import Field
from .nodes import BeamNodes

#: Curve of displacements and resistances, (m, 2), or a function of the distance from the head.
Curve = ArrayLike | Callable[[float], ArrayLike]
#: Shares of the length of an element at its ends and its middle (Simpson).
_SHARES = np.array([1.0, 1.0, 4.0]) / 6.0
#: Growth of the slope of a curve, as a share of the first one, that is round-off.
_CONCAVE = 1e-9
#: Stiffness of springs at their limit, as a share of the first one, in damped tangents.
_KEPT = 1e-3


@dataclass(frozen=True)
class SpringState:
    """State of springs.

    Attributes
    ----------
    force
        Forces of the ground on the pile, less their sign: (n,), positive with the displacement.
    slip
        Displacement at which each part of a spring has no force, (n, m).
    """

    force: ndarray
    slip: ndarray


class PileSprings(Form, Couples, Staged):
    r"""Ground along a pile as springs by curves, without elements of ground.

    Every curve is followed on first loading. Unloading begins with the first slope, and loops
    close (Masing): a curve is the sum of springs in parallel that yield one after the other,
    :math:`p(y) = \sum_i k_i \min(y, r_i / k_i)`.

    Parameters
    ----------
    pile
        :class:`~skfem_contact.Beam` in the plane, from its head to its tip.
    p_y
        Resistance across the pile: forces of one pile per length. A curve (m, 2) of displacements
        and forces from (0, 0) on, or a function of the distance from the head that returns one,
        see :mod:`skfem_contact.curves`.
    t_z
        Resistance of the skin along the pile, likewise.
    q_z
        Resistance of the tip against compression, a force: a curve.

    Raises
    ------
    ValueError
        A curve that does not begin at (0, 0), that falls, or whose slope grows; no curve at all.

    Examples
    --------
    A long pile in a ground of k = 1e4 per length and displacement, pushed by 100 at its head,
    moves by :math:`2 H \beta / k` with :math:`\beta^4 = k / (4 EI)`:

    >>> import numpy as np
    >>> import skfem_contact as sc
    >>> pile = sc.Beam(None, np.linspace((0., 0.), (0., -20.), 41), EI=4e4, EA=1e7, GA=1e9)
    >>> ground = sc.PileSprings(pile, p_y=[(0., 0.), (1., 1e4)], t_z=[(0., 0.), (1., 1e4)])
    >>> model = sc.Model({"pile": pile, "ground": ground})
    >>> push = model.forms["pile"].load((100., 0.), at=(0., 0.))
    >>> stage = model.run([sc.Stage("push", push)])["push"]
    >>> head = stage.table("ground")["deflection"][0]
    >>> beta = (1e4 / 4 / 4e4) ** .25
    >>> f"{head:.5f} {2 * 100. * beta / 1e4:.5f}"
    '0.01000 0.01000'
    """

    kinematics = "small"
    symmetric = True
    _dofs: ndarray
    _same = ("_where",)
    _brought = ("parameters", "_stiffness", "_limit")

    def __init__(
        self,
        pile: BeamNodes,
        p_y: Curve | None = None,
        t_z: Curve | None = None,
        q_z: Curve | None = None,
    ) -> None:
        _check_pile(pile)
        self.coordinates = "plane"
        self.borrowed = (pile.displacement,)
        self.parameters = {}
        for name, curve in {"p_y": p_y, "t_z": t_z, "q_z": q_z}.items():
            if curve is not None:
                self.parameters[name] = curve
        if not self.parameters:
            raise ValueError("springs along a pile need a curve: p_y, t_z or q_z")

        # Find the nodes in their order, their directions and the lengths that belong to them.
        order, position, along, length = _along(pile)
        across = left_of(along)
        rows = [
            (p_y, across, length, "p"),
            (t_z, along, length, "t"),
        ]
        nodes: list[ndarray] = []
        directions: list[ndarray] = []
        curves: list[ndarray] = []
        kinds: list[str] = []
        lengths: list[ndarray] = []
        for curve, direction, share, kind in rows:
            if curve is None:
                continue
            for k in range(len(order)):
                known = checked(curve, float(position[k]), f"{kind} curve")
                curves.append(known * (1.0, share[k]))
            nodes.append(order)
            directions.append(direction)
            lengths.append(share)
            kinds += [kind] * len(order)
        if q_z is not None:
            curves.append(checked(q_z, float(position[-1]), "q curve"))
            nodes.append(order[-1:])
            directions.append(along[-1:])
            lengths.append(np.ones(1))
            kinds.append("q")
        self._nodes = np.concatenate(nodes)
        self._direction = np.concatenate(directions)  # (n, 2)
        self._length = np.concatenate(lengths)
        self._kinds = np.array(kinds)
        self._where = pile.points[self._nodes]
        where = {int(node): s for node, s in zip(order, position, strict=True)}
        self._position = np.array([where[int(node)] for node in self._nodes])
        self._stiffness, self._limit = in_parallel(curves)
        self._stiffness = self._stiffness / pile.spacing
        self._limit = self._limit / pile.spacing
        self._spacing = pile.spacing
        self._local = 2 * self._nodes[:, None] + np.arange(2)
        self.joins = np.zeros(0, int)

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> PileSprings:
        new = copy(self)
        new._dofs = numbers[self.borrowed[0]][self._local]  # (n, 2)
        new.acts_on = new.changing = np.unique(new._dofs)
        return new

    def __repr__(self) -> str:
        return f"<PileSprings {len(self._nodes)} springs, curves: {', '.join(self.parameters)}>"

    def _moved(self, x: ndarray) -> ndarray:
        """Return the displacements along the springs, (n,)."""
        return np.asarray((x[self._dofs] * self._direction).sum(axis=1))

    @override
    def initial_state(self, x: ndarray | None = None) -> SpringState:
        n, m = self._stiffness.shape
        free = np.zeros(n) if x is None else self._moved(x)
        return SpringState(np.zeros(n), np.tile(free[:, None], (1, m)))

    @override
    def assemble(self, x: ndarray, state: SpringState) -> Response:
        # f_i = clip(k_i (y - s_i), -r_i, r_i); the tip has no tension
        moved = self._moved(x)
        elastic = self._stiffness * (moved[:, None] - state.slip)
        at_tip = (self._kinds == "q")[:, None]
        low = np.where(at_tip, 0.0, -self._limit)
        parts = np.clip(elastic, low, self._limit)
        acts = parts == elastic
        force = parts.sum(axis=1)

        def after() -> SpringState:
            k = np.where(self._stiffness > 0.0, self._stiffness, 1.0)
            slid = moved[:, None] - parts / k
            # a tip that has lifted off comes back to where it left
            lifted = at_tip & (elastic < 0.0)
            slip = np.where(acts | lifted, state.slip, slid)
            return SpringState(force, slip)

        def tangent(kept: float = 0.0) -> csr_matrix:
            # K = k d d^T
            each = np.where(acts, self._stiffness, kept * self._stiffness)
            k = each.sum(axis=1)
            d = self._direction
            blocks = k[:, None, None] * d[:, :, None] * d[:, None]
            rows = np.repeat(self._dofs, 2, axis=1).ravel()
            columns = np.tile(self._dofs, (1, 2)).ravel()
            N = len(x)
            return csr_matrix((blocks.ravel(), (rows, columns)), shape=(N, N))

        vector = np.zeros(len(x))
        np.add.at(vector, self._dofs, force[:, None] * self._direction)
        return Response(vector, after, tangent, lambda: tangent(_KEPT), active=acts.tobytes())

    @override
    def rebased(self, x: ndarray, state: SpringState) -> SpringState:
        return SpringState(state.force, state.slip - self._moved(x)[:, None])

    @override
    def outputs(self, x: ndarray, state: SpringState) -> Outputs:
        def summary() -> str:
            limit = self._limit.sum(axis=1)
            share = np.divide(
                np.abs(state.force), limit, out=np.zeros(len(limit)), where=limit > 0.0
            )
            return f"springs up to {share.max():.0%} of their resistance"

        def members() -> dict[str, ndarray]:
            found: dict[str, Any] = {
                "kind": self._kinds,
                "position": self._position,
                "x": self._where[:, 0],
                "y": self._where[:, 1],
                "deflection": self._moved(x),
                "resistance": self._spacing * state.force / self._length,
            }
            return found

        return Outputs(summary=summary, parameters=self.parameters, members=members)


def checked(curve: Curve, position: float, name: str) -> ndarray:
    """Return the curve at a distance from the head, (m, 2); refuse curves that fall or stiffen."""
    # A curve begins at the origin.
    points = finite(curve(position) if callable(curve) else curve, f"a {name}")
    where = f"a {name} at {position:.4g} from the head"
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or points[0].any():
        raise ValueError(
            f"{where} must be pairs of displacement and resistance that begin with (0, 0), not of "
            f"shape {points.shape}"
        )
    # Displacements grow, and the resistance does not fall.
    steps = np.diff(points, axis=0)
    if not (steps[:, 0] > 0.0).all():
        raise ValueError(f"{where}: displacements must grow, unlike {points[:, 0].tolist()}")
    if (steps[:, 1] < 0.0).any():
        raise ValueError(f"{where}: the resistance must not fall, unlike {points[:, 1].tolist()}")
    # Slopes fall: springs in parallel have no softer start.
    slopes = steps[:, 1] / steps[:, 0]
    if (np.diff(slopes) > _CONCAVE * slopes[0]).any():
        raise ValueError(
            f"{where}: the slope must not grow, unlike {slopes.round(6).tolist()}; leave out "
            "points below the line through their neighbours"
        )
    return points


def in_parallel(curves: list[ndarray]) -> tuple[ndarray, ndarray]:
    """Return stiffnesses and limits of the springs in parallel of each curve, (n, m) each.

    Beyond its last point a curve is level.
    """
    m = max(len(curve) for curve in curves)
    stiffness = np.zeros((len(curves), m))
    limit = np.zeros((len(curves), m))
    for row, curve in enumerate(curves):
        # Each bend of the curve is a spring that slips there.
        steps = np.diff(curve, axis=0)
        slopes = np.append(steps[:, 1] / steps[:, 0], 0.0)
        k = slopes[:-1] - slopes[1:]
        stiffness[row, : len(k)] = k
        limit[row, : len(k)] = k * curve[1:, 0]
    return stiffness, limit


def _along(pile: BeamNodes) -> tuple[ndarray, ndarray, ndarray, ndarray]:
    """Return nodes from the head on, distances, directions, (n, 2), and lengths of nodes, (n,)."""
    corners = pile.points[pile.cells]  # (m, 3, 2)
    chord = corners[:, 1] - corners[:, 0]
    size = row_norms(chord)
    n = len(pile.points)
    total = np.zeros(n)
    direction = np.zeros((n, 2))
    np.add.at(total, pile.cells, size[:, None] * _SHARES)
    np.add.at(direction, pile.cells, np.repeat(chord[:, None], 3, axis=1))
    direction /= row_norms(direction)[:, None]

    # Follow the elements from the head.
    start = np.concatenate(([0.0], np.cumsum(size)[:-1]))
    position = np.zeros(n)
    position[pile.cells[:, 0]] = start
    position[pile.cells[:, 2]] = start + 0.5 * size
    position[pile.cells[:, 1]] = start + size
    order = np.argsort(position, kind="stable")
    return order, position[order], direction[order], total[order]


def _check_pile(pile: BeamNodes) -> None:
    """Refuse piles in space and piles that share the nodes of the ground."""
    if pile.dim != 2:
        raise ValueError("springs along a pile are in the plane")
    if pile.shared is not None:
        raise ValueError("springs need a beam with nodes of its own, Beam(None, points, ...)")
