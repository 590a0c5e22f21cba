"""Springs that resist rotations: joints of segments, connections of members, elastic clamps."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix
from typing_extensions import override

from ..checks import finite, format_point, is_number
from ..forms.base import Form, Outputs, Response, counted
from ..forms.roles import Couples, Staged, with_force_kept
from ..layout import Field
from ..sparse import Gathering
from .beam import Beam

#: Stiffness of springs at their yield moment, as a share of the elastic one, in damped tangents.
_KEPT = 1e-3


@dataclass(frozen=True)
class RotationState:
    """State of rotation springs, arrays (n,).

    Attributes
    ----------
    moment
        Moment of one member, with the sign of M in the beam.
    free
        Rotation without moment.
    """

    moment: ndarray
    free: ndarray


class RotationSpring(Form, Couples, Staged):
    r"""Springs that resist the rotation in hinges of a beam, or of a beam at the ground.

    The moment is :math:`M = -k (\theta_a - \theta_b)`, with the rotations of the element that
    begins at the node and of the one that ends at it. It has the sign of M in the beam.

    Parameters
    ----------
    beam
        :class:`~skfem_contact.Beam` in the plane.
    at
        Coordinates of its nodes, (n, 2) or (2,).
    stiffness
        Moment per rotation of one member, one number or (n,). The joint between two segments of
        concrete, of width b and height h in contact, has :math:`b h^2 E / 12` (P. Janssen,
        Tragverhalten von Tunnelausbauten mit Gelenktuebbings, Braunschweig 1983).
    to
        By default the beam itself, across its hinges at these nodes; another beam, to which
        `hinges` of the beam connect it; or ``"ground"``, which does not turn.
    yield_moment
        Largest moment; beyond it the springs flow.

    Raises
    ------
    ValueError
        A beam in space or a shell of revolution; no node, no hinge, or more than two members at
        these coordinates; a stiffness or a yield moment that is not positive.

    Examples
    --------
    A cantilever on a foot that turns by ``F L / k`` moves by ``F L**2 / k`` more at its tip:

    >>> import skfem_contact as sc
    >>> mast = sc.Beam(None, [[0., 0.], [0., 4.]], EI=100., EA=1e6, GA=1e6)
    >>> foot = sc.RotationSpring(mast, (0., 0.), stiffness=50., to="ground")
    >>> model = sc.Model({"mast": mast, "foot": foot}, mast.dofs((0., 0.), ["u^1", "u^2"]))
    >>> push = model.forms["mast"].load((1., 0.), at=(0., 4.))
    >>> stage = model.run([sc.Stage("push", push)])["push"]
    >>> top = model.forms["mast"].numbers((0., 4.))[0]
    >>> f"{stage.x[top]:.3f} {4**3 / 300. + 4 / 1e6 + 4**2 / 50.:.3f}"
    '0.533 0.533'
    >>> stage.table("foot")["moment"].round(6).tolist()
    [4.0]
    """

    symmetric = True
    _same = ("_where", "_signs")
    _brought = ("parameters", "_stiffness", "_limit")
    _dofs: ndarray
    _rows: ndarray
    _gathering: Gathering

    def __init__(
        self,
        beam: Beam,
        at: ArrayLike,
        stiffness: ArrayLike,
        *,
        to: Beam | Literal["ground"] | None = None,
        yield_moment: float = np.inf,
    ) -> None:
        if beam.coordinates != "plane" or (isinstance(to, Beam) and to.coordinates != "plane"):
            raise ValueError(
                "rotation springs are of beams in the plane, not of shells or in space"
            )
        points = np.atleast_2d(finite(at, "at"))
        k = finite(stiffness, "stiffness")
        if k.shape not in ((), (len(points),)) or not (k > 0.0).all():
            raise ValueError(
                f"stiffness must be positive, one number or ({len(points)},), not {stiffness!r}"
            )
        if yield_moment != np.inf and not is_number(yield_moment, 0.0, np.inf):
            raise ValueError(f"yield_moment must be positive, not {yield_moment!r}")
        self.parameters = {"stiffness": stiffness, "yield_moment": yield_moment}
        self.kinematics = beam.kinematics

        # Pairs of rotations: of the member before and of the one behind.
        other = beam
        if isinstance(to, Beam):
            other = to
        self._fields = (beam.rotation, other.rotation)
        self.borrowed = tuple(dict.fromkeys(self._fields))
        turns = []
        signs = []
        for point in points:
            pair, weights = _pair(beam, point, to)
            turns.append(pair)
            signs.append(weights)
        self._pairs = np.array(turns)  # (n, 2): of the beam, and of the other one
        self._signs = np.array(signs)
        self._where = points
        # Stiffness of a row per unit of length
        self._spacing = beam.spacing
        self._stiffness = np.broadcast_to(k, len(points)).astype(float)
        self._limit = yield_moment
        self.joins = np.zeros(0, int)

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> RotationSpring:
        new = copy(self)
        columns = []
        for field, turns in zip(self._fields, self._pairs.T, strict=True):
            columns.append(numbers[field][turns])
        dofs = np.column_stack(columns)
        new._dofs, rows = np.unique(dofs, return_inverse=True)
        new._rows = rows.reshape(dofs.shape)
        new._gathering = Gathering(len(new._dofs))
        new.acts_on = new._dofs
        if np.isfinite(self._limit):
            new.changing = new._dofs
        else:
            new.changing = np.zeros(0, int)
        return new

    def __repr__(self) -> str:
        k = self._stiffness
        return f"<RotationSpring {len(k)} springs, stiffness {k.min():.4g} to {k.max():.4g}>"

    def _rotation(self, x: ndarray) -> ndarray:
        """Return the rotation of each spring, theta_b - theta_a, (n,)."""
        moves = x[self._dofs][self._rows]
        return np.asarray((self._signs * moves).sum(axis=1))

    @override
    def initial_state(self, x: ndarray | None = None) -> RotationState:
        zero = np.zeros(len(self._where))
        return RotationState(zero, zero if x is None else self._rotation(x))

    @override
    def assemble(self, x: ndarray, state: RotationState) -> Response:
        # M = k (rotation - free) up to the yield moment
        k = self._stiffness
        rotation = self._rotation(x)
        elastic = k * (rotation - state.free)
        moment = np.clip(elastic, -self._limit, self._limit)
        acts = moment == elastic

        def tangent(kept: float = 0.0) -> csr_matrix:
            slope = np.where(acts, k, kept * k) / self._spacing
            both = self._signs[:, :, None] * self._signs[:, None]
            return self._gathering.matrix(self._rows, slope[:, None, None] * both)

        forces = moment[:, None] / self._spacing * self._signs
        return Response(
            self._gathering.force(self._rows, forces),
            lambda: RotationState(moment, np.where(acts, state.free, rotation - moment / k)),
            tangent,
            lambda: tangent(_KEPT),
            active=acts.tobytes(),
            dofs=self._dofs,
        )

    @override
    def inherits(self, old: RotationSpring, state: RotationState) -> RotationState:
        # a new stiffness changes no moment
        before = state.moment / old._stiffness
        return with_force_kept(state, before, state.moment / self._stiffness)

    @override
    def rebased(self, x: ndarray, state: RotationState) -> RotationState:
        return RotationState(state.moment, state.free - self._rotation(x))

    @override
    def outputs(self, x: ndarray, state: RotationState) -> Outputs:
        members: dict[str, Any] = dict(zip("xy", self._where.T, strict=True))
        members |= {"rotation": self._rotation(x), "moment": state.moment}
        return Outputs(
            summary=f"moments {state.moment.min():.4g} to {state.moment.max():.4g}",
            parameters=self.parameters,
            members=members,
            yielding=lambda before: counted(before.free != state.free),
        )


def _pair(
    beam: Beam, point: ndarray, to: Beam | Literal["ground"] | None
) -> tuple[tuple[int, int], tuple[float, float]]:
    """Return the rotations of the beam and of the other side at a node, and their signs.

    A spring turns by the rotation of the member before the node less the one behind.
    """
    where = format_point(point)
    before, behind = beam.rotations(point)
    if to is None:
        if len(before) != 1 or len(behind) != 1 or before == behind:
            raise ValueError(
                f"two members of the beam must meet in a hinge at {where}: name it in `hinges`, or "
                'give `to`, another beam or "ground"'
            )
        return (before[0], behind[0]), (1.0, -1.0)

    # One side of the spring is the beam, which begins or ends there.
    own = {*before, *behind}
    if len(own) != 1:
        raise ValueError(f"the beam has a hinge, or is in the middle of an element, at {where}")
    turn = own.pop()
    sign = 1.0 if before else -1.0
    if isinstance(to, str):
        return (turn, turn), (sign, 0.0)
    others = {turn for side in to.rotations(point) for turn in side}
    if len(others) != 1:
        raise ValueError(f"the other beam has a hinge, or no end of an element, at {where}")
    if any(turn in indices for indices, _ in beam.rotation.taken):
        raise ValueError(
            f"the beams are joined rigidly at {where}: name the point in `hinges` of the one that "
            "is joined to the other"
        )
    return (turn, others.pop()), (sign, -sign)
