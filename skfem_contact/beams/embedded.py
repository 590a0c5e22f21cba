"""Beams embedded in the ground: nails, rows of piles, and the grouted bodies of anchors."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix, csr_matrix, hstack
from skfem import CellBasis
from typing_extensions import override

from ..checks import check_plane, finite, format_point, is_number, positive
from ..forms.base import Form, Response
from ..layout import Field
from .beam import Beam
from .element import shapes

#: Points of an element of the beam where the skin acts, and their weights.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)
#: Stiffness of the skin by default, over the shear modulus of the ground and the length of the beam's elements: the
#: settlement of a pile of 10 m under 0.4 of its limit falls by 3 % from 10 to 87.
_STIFF = 10.0
#: Share of the stiffness that the skin keeps in the tangent where it slips: nothing else holds a beam pulled out.
_KEPT = 1e-6


@dataclass(frozen=True)
class EmbeddedState:
    """State of an embedded beam, of one member.

    Attributes
    ----------
    skin
        Force per length along the beam that the ground exerts on it at the points, (n,).
    free
        Displacements of the ground against the beam without force, (n, 2).
    foot
        Force on the foot, negative in compression, and displacement without force, (2,).
    """

    skin: ndarray
    free: ndarray
    foot: ndarray


class Embedded(Form):
    """Skin and foot of a beam inside the elements of the ground, whose mesh does not know the beam.

    Springs join the beam to the ground at three points of each of its elements. Along the beam they yield at
    ``T_max``; across they are elastic, so that no ground flows between the members of a row.

    Parameters
    ----------
    basis
        ``Basis`` of the ground.
    beam
        Beam with nodes of its own; its `spacing` is that of the members.
    T_max
        Skin resistance of one member per length: a number, or a function of the distances from the start of the beam.
    F_max
        Resistance of the foot, the end of the beam, against compression; by default there is none.
    stiffness
        Stiffness of the skin of one member: force per length and displacement. By default 10 times the shear modulus of
        the stiffest ground, times `spacing`, over the length of the beam's elements.

    Raises
    ------
    ValueError
        A beam that is bonded or leaves the mesh, resistances or a stiffness that are negative.

    Notes
    -----
    Strength reduction leaves `T_max` and `F_max` as they are; `bounds` refuses embedded beams. In the plane the
    settlement grows with the logarithm of the mesh size, as that of a line load.

    Examples
    --------
    A nail of 4 m with a skin resistance of 15 kN/m is pulled out by 60 kN:

    >>> import numpy as np
    >>> from skfem import Basis, ElementTriP2, ElementVector, MeshTri
    >>> import skfem_contact as sc
    >>> mesh = MeshTri.init_tensor(np.linspace(0., 6., 7), np.linspace(0., 3., 4)).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=2)
    >>> nail = sc.Beam(None, np.linspace((.3, 1.6), (4.3, 1.6), 5), EI=10., EA=1e5)
    >>> forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=3e4, nu=.3)), "nail": nail}
    >>> model = sc.Model({**forms, "skin": sc.Embedded(basis, nail, T_max=15.)}, basis.get_dofs("bottom").all())
    >>> pull = model.forms["nail"].load((-1., 0.), at=(.3, 1.6))
    >>> f"{model.limit_load(pull, step=20., progress=False).multiplier:.2f}"
    '60.00'
    """

    symmetric = unilateral = True
    coordinates = "plane"
    _dofs: ndarray

    def __init__(self, basis: CellBasis, beam: Beam, T_max: float | Callable[[ndarray], ArrayLike], F_max: float = 0.0,
                 stiffness: float | None = None) -> None:
        check_plane(basis, "Embedded")
        if beam.points.shape[1] != 2:
            raise ValueError("embedded beams are plane: along a line in space the settlement grows with any finer mesh")
        if len(beam.fields) < 2:
            raise ValueError("the beam is bonded to the ground along a line: embed one with nodes of its own")
        if not is_number(F_max, -1e-300, np.inf):
            raise ValueError(f"F_max must not be negative, not {F_max!r}")
        self._spacing, self.borrowed = beam.spacing, beam.fields[:1]
        self._given = None if stiffness is None else positive(stiffness, "stiffness")
        self.positions, points, self._along, self._weight, of_beam = _points(beam)
        self._lengths = self._weight.reshape(-1, len(_POINTS)).sum(axis=1)
        n = len(self.positions)
        limit = finite(T_max(self.positions) if callable(T_max) else T_max, "T_max")
        if limit.shape not in ((), self.positions.shape) or not (limit >= 0.0).all():
            raise ValueError("T_max must be a skin resistance that is finite and not negative, or a function of the "
                             f"distances, (n,), not {T_max!r}")
        self.T_max, self.F_max, self._k = np.broadcast_to(limit, n), float(F_max), self._given or 0.0
        of_ground = _values_at(basis, points)
        self._ground = np.unique(of_ground.indices)
        self._jump = csr_matrix(hstack((of_ground[:, self._ground], -of_beam)))
        self.joins = np.zeros(0, int)
        self.acts_on = self.changing = self._ground

    @override
    def completed(self, forms: Mapping[str, Form]) -> Embedded:
        new = copy(self)
        moduli = [m.elasticity(4)[..., -1, -1].max() for form in forms.values() for m in form.materials.values()]
        if self._given is None:
            if not moduli:
                raise ValueError("an embedded beam needs ground: a SolidForm among the forms")
            new._k = _STIFF * max(moduli) * self._spacing / float(np.median(self._lengths))
        return new

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Embedded:
        new = copy(self)
        new._dofs = np.concatenate((self._ground, numbers[self.borrowed[0]]))
        new.acts_on = new.changing = new._dofs
        return new

    def __repr__(self) -> str:
        return f"<Embedded {self.positions[-1]:.4g} long, T_max {self.T_max.min():.4g} to {self.T_max.max():.4g}>"

    def _jumps(self, x: ndarray) -> tuple[ndarray, float]:
        """Return displacements of the ground against the beam at the points, (n, 2), and along it at the foot."""
        jump = (self._jump @ x[self._dofs]).reshape(-1, 2)
        return jump[:-1], float(jump[-1] @ self._along[-1])

    @override
    def initial_state(self, x: ndarray | None = None) -> EmbeddedState:
        n = len(self.positions)
        jump, foot = (np.zeros((n, 2)), 0.0) if x is None else self._jumps(x)
        return EmbeddedState(np.zeros(n), jump, np.array([0.0, foot]))

    @override
    def assemble(self, x: ndarray, state: EmbeddedState) -> Response:
        jump, foot = self._jumps(x)
        t, k, at_foot = self._along[:-1], self._k, self._k * self._lengths[-1]
        moved = jump - state.free
        slip = (moved * t).sum(axis=1)
        skin = np.clip(k * slip, -self.T_max, self.T_max)
        slips = skin != k * slip
        thrust = at_foot * (foot - state.foot[1])
        force = np.clip(thrust, -self.F_max, 0.0)
        stands, crushed = thrust == force and self.F_max > 0.0, thrust < force
        q = (k * (moved - slip[:, None] * t) + skin[:, None] * t) * self._weight[:, None]
        forces = np.append(q, force * self._along[-1]) / self._spacing

        def after() -> EmbeddedState:
            free = state.free + (slip - skin / k)[:, None] * t
            return EmbeddedState(skin, free, np.array([force, foot - force / at_foot if crushed else state.foot[1]]))

        def stiffness() -> csr_matrix:
            across = np.eye(2) - t[:, :, None] * t[:, None]
            along = np.where(slips, _KEPT, 1.0)[:, None, None] * t[:, :, None] * t[:, None]
            blocks = k * self._weight[:, None, None] * (across + along)
            own = at_foot * (1.0 if stands else _KEPT) * np.outer(self._along[-1], self._along[-1])
            blocks = np.concatenate((blocks, own[None])) / self._spacing
            at = 2 * np.arange(len(blocks))[:, None] + np.arange(2)
            rows, columns = np.broadcast_arrays(at[:, :, None], at[:, None, :])
            D = csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(at.max() + 1, at.max() + 1))
            return csr_matrix(self._jump.T @ D @ self._jump)

        return Response(self._jump.T @ forces, after, stiffness, active=slips.tobytes() + bytes([int(stands)]),
                        measure=abs(self._jump).T @ abs(forces), dofs=self._dofs)

    @override
    def rebased(self, x: ndarray, state: EmbeddedState) -> EmbeddedState:
        jump, foot = self._jumps(x)
        return EmbeddedState(state.skin, state.free - jump, state.foot - [0.0, foot])

    @override
    def yielding(self, before: EmbeddedState, after: EmbeddedState) -> tuple[int, int]:
        return int((before.free != after.free).any(axis=1).sum()), len(self.positions)

    @override
    def summary(self, state: EmbeddedState) -> str:
        share = np.divide(abs(state.skin), self.T_max, out=np.zeros(len(self.T_max)), where=self.T_max > 0.0)
        return f"skin up to {share.max():.0%} of its resistance, foot {state.foot[0]:.4g}"


def _points(beam: Beam) -> tuple[ndarray, ndarray, ndarray, ndarray, csr_matrix]:
    """Return distances and lengths, (n,); coordinates, tangents and displacements of the beam, also of its foot."""
    corners, m = beam.points[beam.cells], len(beam.cells)
    values, slopes = (np.array(parts) for parts in zip(*map(shapes, _POINTS), strict=True))  # (3 points, 3 nodes)
    way = np.einsum("qk,mkc->mqc", slopes, corners)
    weights = _WEIGHTS * np.linalg.norm(way, axis=2)
    lengths = weights.sum(axis=1)
    begin = np.cumsum(lengths) - lengths
    s = begin[:, None] + 0.5 * (1.0 + _POINTS) * lengths[:, None]
    t = np.vstack((way.reshape(-1, 2), np.einsum("k,kc->c", shapes(1.0)[1], corners[-1])))
    N = np.vstack((np.tile(values, (m, 1)), shapes(1.0)[0]))
    cells = np.vstack((np.repeat(beam.cells, len(_POINTS), axis=0), beam.cells[-1]))
    row, column = 2 * np.arange(len(N))[:, None, None] + np.arange(2), 2 * cells[:, :, None] + np.arange(2)
    row, column, value = np.broadcast_arrays(row, column, N[:, :, None])
    of_beam = csr_matrix((value.ravel(), (row.ravel(), column.ravel())), shape=(2 * len(N), 2 * len(beam.points)))
    points = np.einsum("pk,pkc->pc", N, beam.points[cells])
    return s.ravel(), points, t / np.linalg.norm(t, axis=1)[:, None], weights.ravel(), of_beam


def _values_at(basis: CellBasis, points: ndarray) -> csr_matrix:
    """Return the displacements of the ground at points, (2 n, N)."""
    scalar = basis.with_element(basis.elem.elem)
    try:
        P = coo_matrix(scalar.probes(points.T))
    except ValueError:
        finder = basis.mesh.element_finder()
        for point in points:
            try:
                finder(*point[:, None])
            except ValueError:
                raise ValueError(f"the embedded beam leaves the mesh at {format_point(point)}") from None
        raise
    row, column = (2 * number[:, None] + np.arange(2) for number in (P.row, P.col))
    return csr_matrix((np.repeat(P.data, 2), (row.ravel(), column.ravel())), shape=(2 * len(points), basis.N))
