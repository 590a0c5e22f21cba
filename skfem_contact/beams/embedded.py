"""Beams embedded in the ground: nails, rows of piles, and the grouted bodies of anchors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix, csr_matrix, hstack
from skfem import CellBasis, Mesh, MeshQuad1, MeshTri1
from typing_extensions import override

from ..checks import check_basis, finite, format_point, is_number, positive
from ..forms.base import Form, Response
from ..layout import Field
from .element import shapes
from .nodes import BeamNodes, stiffest

#: Points of an element of the beam where the skin acts, and their weights; at the nodes of
#: reinforcement, which then moves across with the ground: at Gauss points springs across resisted
#: without limit where a slope slid past a nail.
_GAUSS, _NODES = (
    np.polynomial.legendre.leggauss(3),
    (np.array([-1.0, 0.0, 1.0]), np.array([1.0, 4.0, 1.0]) / 3.0),
)
#: Stiffness of the skin by default, over the shear modulus of the ground and the length of the
#: beam's elements: the settlement of a pile of 10 m under 0.4 of its limit falls by 3 % from 10 to
#: 87.
_STIFF = 10.0
#: ... in space, over the shear modulus, and the number of points on the circle about the beam. A
#: pile of 25 diameters settles by 9.04 and 9.05 mm in elements of 4 and 2 diameters, a solid one by
#: 9.32 mm; at a line 10.6 and 12.2 mm.
_STIFF_IN_SPACE, _ON_CIRCLE = 1e3, 16
#: Shares of the stiffness that the skin keeps where it slips, in the tangent, as nothing else holds
#: a beam pulled out, and in the damped one: with 1e-6 nails of 1 kN/m in a slope of 8 m find no
#: equilibrium, with 1e-4 a search takes 267 iterations, with 1e-3 122, with 1e-2 167.
_KEPT, _DAMPED = 1e-6, 1e-3


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

    Springs join the beam to the ground at three points of each of its elements. Along the beam they
    yield at ``T_max``. Across a beam they are elastic, so that no ground flows between the members
    of a row; across
    :class:`~skfem_contact.Reinforcement` there is no force.

    Parameters
    ----------
    basis
        ``Basis`` of the ground.
    beam
        Beam or :class:`~skfem_contact.Reinforcement` with nodes of its own; its `spacing` is that
        of the members.
    T_max
        Skin resistance of one member per length: a number, or a function of the distances from the
        start of the beam.
    F_max
        Resistance of the foot, the end of the beam, against compression; by default there is none.
    stiffness
        Stiffness of the skin of one member: force per length and displacement. By default 10 times
        the shear modulus of the stiffest ground, times `spacing`, over the length of the beam's
        elements.
    radius
        Radius of a beam in space. The ground moves with the beam on the mean over a circle: that of
        the shaft, or half an element wide where this is more; springs stand for the ground in
        between. The beam replaces ground: take ``EA = (E_beam - E_soil) * area``. A mesh that is
        cut along the axis has a half or a quarter of the beam, whose stiffnesses and resistances
        are given.

    Raises
    ------
    ValueError
        A beam that is bonded or leaves the mesh, resistances or a stiffness that are negative, a
        beam in space without radius.

    Notes
    -----
    Strength reduction leaves `T_max` and `F_max` as they are; `bounds` refuses embedded beams. In
    the plane the settlement grows with the logarithm of the mesh size, as that of a line load.

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
    _k: ndarray
    _across: ndarray
    _at_foot: float
    _dofs: ndarray
    _same, _brought = ("_where", "_given", "radius"), ("parameters", "T_max", "F_max")

    def __init__(
        self,
        basis: CellBasis,
        beam: BeamNodes,
        T_max: float | Callable[[ndarray], ArrayLike],
        F_max: float = 0.0,
        stiffness: float | None = None,
        radius: float | None = None,
    ) -> None:
        check_basis(basis)
        if (dim := beam.points.shape[1]) != basis.mesh.dim():
            raise ValueError(f"the beam has {dim} coordinates, the ground {basis.mesh.dim()}")
        if (dim == 3) == (radius is None) or not (radius is None or is_number(radius, 0.0, np.inf)):
            raise ValueError(
                f"a beam in space, and no other, has a radius, not {radius!r}: beside a line the "
                f"ground "
                "moves without bounds as the mesh becomes finer"
            )
        self.coordinates, self.radius = ("plane", "space")[dim - 2], radius
        if not any(field.kind == "displacement" for field in beam.fields):
            raise ValueError(
                "the beam is bonded to the ground along a line: embed one with nodes of its own"
            )
        if not is_number(F_max, -1e-300, np.inf):
            raise ValueError(f"F_max must not be negative, not {F_max!r}")
        self._spacing, self._EA, self.borrowed = beam.spacing, beam._EA, beam.fields[:1]
        self._given = None if stiffness is None else positive(stiffness, "stiffness")
        self.positions, points, self._along, self._weight, of_beam = _points(beam)
        self._where = points[:-1]
        self._lengths = self._weight.reshape(len(beam.cells), -1).sum(axis=1)
        n = len(self.positions)
        limit = finite(T_max(self.positions) if callable(T_max) else T_max, "T_max")
        if limit.shape not in ((), self.positions.shape) or not (limit >= 0.0).all():
            raise ValueError(
                "T_max must be a skin resistance that is finite and not negative, or a function of "
                "the "
                f"distances, (n,), not {T_max!r}"
            )
        self.T_max, self.F_max = np.broadcast_to(limit, n), float(F_max)
        self.parameters = {
            "T_max": limit if limit.ndim else float(limit),
            "F_max": float(F_max),
            "radius": radius,
        }
        if radius is None:
            of_ground = _values_at(basis, points)
        else:
            self._wide = np.maximum(radius, 0.5 * _sizes(basis, points, self._along))
            of_ground, self._part = _around(basis, points, self._along, self._wide)
        self._ground = np.unique(of_ground.indices)
        self._jump = csr_matrix(hstack((of_ground[:, self._ground], -of_beam)))
        self.joins = np.zeros(0, int)
        self.acts_on = self.changing = self._ground

    @override
    def completed(self, forms: Mapping[str, Form]) -> Embedded:
        new = copy(self)
        C = stiffest(forms)
        if C is None and (self._given is None or self.radius is not None):
            raise ValueError("an embedded beam needs ground: a SolidForm among the forms")
        C = np.zeros((4, 4)) if C is None else C
        G, length = C[-1, -1], float(np.median(self._lengths))
        k = self._given or (
            _STIFF * G * self._spacing / length if self.radius is None else _STIFF_IN_SPACE * G
        )
        ones = np.ones(len(self.positions))
        new._k, new._across, new._at_foot = k * ones, k * ones, k * self._lengths[-1]
        if (
            self.radius is not None
        ):  # the ground between the shaft and the circle as springs in series
            part, nu = (
                np.log(self._wide / self.radius) / (2.0 * np.pi * G),
                C[0, 1] / (C[0, 0] + C[0, 1]),
            )
            new._k, new._across = (
                self._part[:-1] / (1.0 / k + share * part[:-1])
                for share in (1.0, (3.0 - 4.0 * nu) / (4.0 - 4.0 * nu))
            )
            own = 2.0 * (1.0 + nu) * G * np.pi * self.radius**2 * float(self._part.mean())
            if own > self._EA:
                raise ValueError(
                    f"EA={self._EA:g} of the embedded beam is less than that of the ground it "
                    f"replaces, "
                    f"{own:g}: check units, and that `radius` is that of the shaft"
                )
            base = (1.0 - nu) / (4.0 * G) * (1.0 / self.radius - 1.0 / self._wide[-1])
            new._at_foot = self._part[-1] / (1.0 / new._at_foot + base)
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
        """Return displacements of the ground against the beam at the points, (n, 2), and along it
        at the foot.
        """
        jump = (self._jump @ x[self._dofs]).reshape(len(self._along), -1)
        return jump[:-1], float(jump[-1] @ self._along[-1])

    @override
    def initial_state(self, x: ndarray | None = None) -> EmbeddedState:
        n = len(self.positions)
        jump, foot = (np.zeros((n, self._along.shape[1])), 0.0) if x is None else self._jumps(x)
        return EmbeddedState(np.zeros(n), jump, np.array([0.0, foot]))

    @override
    def assemble(self, x: ndarray, state: EmbeddedState) -> Response:
        jump, foot = self._jumps(x)
        t, k, at_foot, dim = self._along[:-1], self._k, self._at_foot, self._along.shape[1]
        moved = jump - state.free
        slip = (moved * t).sum(axis=1)
        skin = np.clip(k * slip, -self.T_max, self.T_max)
        slips = skin != k * slip
        thrust = at_foot * (foot - state.foot[1])
        force = np.clip(thrust, -self.F_max, 0.0)
        stands, crushed = thrust == force and self.F_max > 0.0, thrust < force
        q = (
            self._across[:, None] * (moved - slip[:, None] * t) + skin[:, None] * t
        ) * self._weight[:, None]
        forces = np.append(q, force * self._along[-1]) / self._spacing

        def after() -> EmbeddedState:
            free = state.free + (slip - skin / k)[:, None] * t
            return EmbeddedState(
                skin, free, np.array([force, foot - force / at_foot if crushed else state.foot[1]])
            )

        def stiffness(kept: float = _KEPT) -> csr_matrix:
            tt = t[:, :, None] * t[:, None]
            blocks = self._weight[:, None, None] * (
                self._across[:, None, None] * (np.eye(dim) - tt)
                + (np.where(slips, kept, 1.0) * k)[:, None, None] * tt
            )
            own = at_foot * (1.0 if stands else kept) * np.outer(self._along[-1], self._along[-1])
            blocks = np.concatenate((blocks, own[None])) / self._spacing
            at = dim * np.arange(len(blocks))[:, None] + np.arange(dim)
            rows, columns = np.broadcast_arrays(at[:, :, None], at[:, None, :])
            D = csr_matrix(
                (blocks.ravel(), (rows.ravel(), columns.ravel())),
                shape=(at.max() + 1, at.max() + 1),
            )
            return csr_matrix(self._jump.T @ D @ self._jump)

        active, measure = slips.tobytes() + bytes([int(stands)]), abs(self._jump).T @ abs(forces)
        return Response(
            self._jump.T @ forces,
            after,
            stiffness,
            lambda: stiffness(_DAMPED),
            active=active,
            measure=measure,
            dofs=self._dofs,
        )

    @override
    def rebased(self, x: ndarray, state: EmbeddedState) -> EmbeddedState:
        jump, foot = self._jumps(x)
        return EmbeddedState(state.skin, state.free - jump, state.foot - [0.0, foot])

    @override
    def yielding(self, before: EmbeddedState, after: EmbeddedState) -> tuple[int, int]:
        return int((before.free != after.free).any(axis=1).sum()), len(self.positions)

    def _used(self, state: EmbeddedState) -> ndarray:
        return np.divide(
            abs(state.skin), self.T_max, out=np.zeros(len(self.T_max)), where=self.T_max > 0.0
        )

    @override
    def members(self, state: EmbeddedState) -> dict[str, ndarray]:
        return {
            "position": self.positions,
            **dict(zip("xyz", self._where.T)),
            "skin": state.skin,
            "share": self._used(state),
        }

    @override
    def summary(self, state: EmbeddedState) -> str:
        return (
            f"skin up to {self._used(state).max():.0%} of its resistance, foot {state.foot[0]:.4g}"
        )


def _points(beam: BeamNodes) -> tuple[ndarray, ndarray, ndarray, ndarray, csr_matrix]:
    """Return distances and lengths, (n,); coordinates, tangents and displacements of the beam, also
    of its foot.
    """
    corners, m = beam.points[beam.cells], len(beam.cells)
    at, weight = _GAUSS if any(field.kind == "rotation" for field in beam.fields) else _NODES
    values, slopes = (
        np.array(parts) for parts in zip(*map(shapes, at), strict=True)
    )  # (3 points, 3 nodes)
    way = np.einsum("qk,mkc->mqc", slopes, corners)
    weights = weight * np.linalg.norm(way, axis=2)
    lengths = weights.sum(axis=1)
    begin = np.cumsum(lengths) - lengths
    s = begin[:, None] + 0.5 * (1.0 + at) * lengths[:, None]
    dim = beam.points.shape[1]
    t = np.vstack((way.reshape(-1, dim), np.einsum("k,kc->c", shapes(1.0)[1], corners[-1])))
    N = np.vstack((np.tile(values, (m, 1)), shapes(1.0)[0]))
    cells = np.vstack((np.repeat(beam.cells, len(at), axis=0), beam.cells[-1]))
    row, column = (
        dim * at[..., None] + np.arange(dim) for at in (np.arange(len(N))[:, None], cells)
    )
    row, column, value = np.broadcast_arrays(row, column, N[:, :, None])
    of_beam = csr_matrix(
        (value.ravel(), (row.ravel(), column.ravel())), shape=(dim * len(N), dim * len(beam.points))
    )
    points = np.einsum("pk,pkc->pc", N, beam.points[cells])
    return s.ravel(), points, t / np.linalg.norm(t, axis=1)[:, None], weights.ravel(), of_beam


def _values_at(basis: CellBasis, points: ndarray) -> csr_matrix:
    """Return the displacements of the ground at points, (dim n, N)."""
    try:
        P = _probes(basis.with_element(basis.elem.elem), points)
    except ValueError:
        if len(outside := points[_elements_at(basis.mesh, points) < 0]):
            raise ValueError(
                f"the embedded beam leaves the mesh at {format_point(outside[0])}"
            ) from None
        raise
    dim = basis.mesh.dim()
    row, column = (dim * number[:, None] + np.arange(dim) for number in (P.row, P.col))
    return csr_matrix(
        (np.repeat(P.data, dim), (row.ravel(), column.ravel())), shape=(dim * len(points), basis.N)
    )


def _probes(basis: CellBasis, points: ndarray) -> coo_matrix:
    """Return the values of a scalar field at points, (n, N), also in elements of second order.

    Those with a curved side are found by its chord: between the two the values of an element
    continue.
    """
    cells = _finder(basis.mesh)(*points.T)
    local = basis.mapping.invF(points.T[:, :, None], tind=cells)
    values = [
        basis.elem.gbasis(basis.mapping, local, k, tind=cells)[0].value.ravel()
        for k in range(basis.Nbfun)
    ]
    rows = np.tile(np.arange(len(points)), basis.Nbfun)
    return coo_matrix(
        (np.concatenate(values), (rows, basis.dofs.element_dofs[:, cells].ravel())),
        shape=(len(points), basis.N),
    )


def _finder(mesh: Mesh) -> Callable[..., ndarray]:
    """Return the function that finds the elements at coordinates, by the chords of curved sides."""
    straight = {"MeshTri2": MeshTri1, "MeshQuad2": MeshQuad1}.get(type(mesh).__name__)
    return (straight.from_mesh(mesh) if straight else mesh).element_finder()


def _elements_at(mesh: Mesh, points: ndarray) -> ndarray:
    """Return the numbers of the elements at points, (n,); -1 outside of the mesh."""
    finder, found = _finder(mesh), np.full(len(points), -1)
    for k, point in enumerate(points):
        with suppress(ValueError):
            found[k] = finder(*point[:, None])[0]
    return found


def _across(along: ndarray) -> tuple[ndarray, ndarray]:
    """Return two directions across unit tangents, (n, 3) each."""
    first = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)])
    first /= np.linalg.norm(first, axis=1)[:, None]
    return first, np.cross(along, first)


def _sizes(basis: CellBasis, points: ndarray, along: ndarray) -> ndarray:
    """Return the sizes across the beam of the elements at points, (n,)."""
    mesh, elements = basis.mesh, _elements_at(basis.mesh, points)
    if (elements < 0).any():
        raise ValueError(
            f"the embedded beam leaves the mesh at {format_point(points[elements < 0][0])}"
        )
    corners = mesh.p[:, mesh.t[:, elements]].transpose(2, 1, 0)  # (n, corners, 3)
    widths = [np.ptp(np.einsum("nkc,nc->nk", corners, axis), axis=1) for axis in _across(along)]
    return np.asarray(np.max(widths, axis=0))


def _around(
    basis: CellBasis, points: ndarray, along: ndarray, radius: ndarray
) -> tuple[csr_matrix, ndarray]:
    """Return means of the displacements of the ground over circles about points, (3 n, N), and
    parts in the mesh, (n,).

    Points of a circle that lie outside of the mesh are left out: it is then cut along a plane of
    symmetry.
    """
    first, second = _across(along)
    angle = 2.0 * np.pi * (np.arange(_ON_CIRCLE) + 0.5) / _ON_CIRCLE
    rim = points[:, None] + radius[:, None, None] * (
        np.cos(angle)[:, None] * first[:, None] + np.sin(angle)[:, None] * second[:, None]
    )
    inside = _elements_at(basis.mesh, rim.reshape(-1, 3)).reshape(rim.shape[:2]) >= 0
    if not inside.any(axis=1).all():
        raise ValueError(
            f"the embedded beam leaves the mesh at {format_point(points[~inside.any(axis=1)][0])}"
        )
    share = (inside / inside.sum(axis=1, keepdims=True))[inside]
    row = np.repeat(3 * np.nonzero(inside)[0], 3) + np.tile(np.arange(3), len(share))
    mean = csr_matrix(
        (np.repeat(share, 3), (row, np.arange(3 * len(share)))),
        shape=(3 * len(points), 3 * len(share)),
    )
    return csr_matrix(mean @ _values_at(basis, rim[inside])), inside.mean(axis=1)
