"""Links: matrices of scikit-fem, springs, and bars such as anchors and struts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix, csr_matrix, sparray, spmatrix
from skfem import CellBasis
from typing_extensions import override

from ..arrays import row_norms
from ..checks import finite, is_number, positive
from ..layout import Field, FieldDofs, dofs_at
from ..sparse import Gathering
from ..units import Extent
from .base import Form, Kinematics, Outputs, Response
from .roles import Couples, Regularised, Staged, Stiff, with_force_kept

#: Share of a member by which a number of members may miss a whole one, by rounded angles.
_WHOLE = 1e-3


class MatrixForm(Form, Stiff, Couples, Staged):
    """Linear form of any matrix, such as the matrix of a ``BilinearForm``.

    Parameters
    ----------
    K
        Stiffness, (N, N), sparse; in axial symmetry per radian, as all forces are.

    Raises
    ------
    ValueError
        A matrix that is not square, or not finite.

    Examples
    --------
    An elastic foundation under a square:

    >>> import numpy as np
    >>> from skfem import Basis, BilinearForm, ElementQuad1, ElementVector, FacetBasis, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(2).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> bottom = FacetBasis(basis.mesh, basis.elem, facets="bottom")
    >>> subgrade = BilinearForm(lambda u, v, w: 100. * (u[0] * v[0] + u[1] * v[1])).assemble(bottom)
    >>> square = sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.))
    >>> model = sc.Model({"square": square, "ground": sc.MatrixForm(subgrade)})
    >>> result = model.run([sc.Stage("weight", sc.weight(basis, 20.))])
    >>> [float(f"{u:.4f}") for u in result["weight"].x[basis.get_dofs("bottom").all("u^2")]]
    [-0.2, -0.2, -0.2, -0.2, -0.2]
    """

    def __init__(self, K: spmatrix | sparray | ndarray) -> None:
        shape = np.shape(K)  # type: ignore[arg-type]
        if len(shape) != 2:
            raise ValueError(f"K must be a square matrix, not an array of shape {shape}")
        K = csr_matrix(K, copy=True)  # type: ignore[arg-type]
        if shape[0] != shape[1] or not np.isfinite(K.data).all():
            raise ValueError(f"K must be a square matrix of finite numbers, not {K.shape}")
        largest = 0.0
        if K.nnz:
            largest = abs(K).max()
        self.elastic_stiffness = K
        self.size: int = int(shape[1])
        self.symmetric = abs(K - K.T).max() <= 1e-12 * largest
        self.changing = np.zeros(0, int)
        self.acts_on = K.indices

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.size} dofs, {self.elastic_stiffness.nnz} entries>"

    @override
    def initial_state(self, x: ndarray | None = None) -> ndarray:  # displacements without force
        if x is None:
            return np.zeros(self.size)
        return x[: self.size].copy()

    @override
    def assemble(self, x: ndarray, state: ndarray) -> Response:
        force = self.elastic_stiffness @ (x - state)
        return Response(force, lambda: state, lambda: self.elastic_stiffness)

    @override
    def rebased(self, x: ndarray, state: ndarray) -> ndarray:
        return state - x[: self.size]


class Spring(MatrixForm):
    """Linear springs at nodes, to the ground or to other nodes.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh.
    coordinates
        Nodes of the mesh, (n, dim) or (dim,).
    stiffness
        Force per displacement in each direction, (dim,), or one number for all: per unit of length
        out of the plane, or per radian in axial symmetry.
    to
        Nodes at the other ends, by default the ground, which does not move.
    part, to_part
        Subdomains of the nodes, where nodes of two bodies coincide.

    Raises
    ------
    ValueError
        Coordinates without a node or with nodes of two bodies, or a stiffness that is negative or
        not finite.

    Examples
    --------
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad(), ElementVector(ElementQuad1()))
    >>> sc.Spring(basis, (0., 1.), stiffness=(0., 50.))
    <Spring 8 dofs, 1 entries>
    """

    def __init__(
        self,
        basis: CellBasis,
        coordinates: ArrayLike,
        stiffness: float | Sequence[float],
        to: ArrayLike | None = None,
        part: str | None = None,
        to_part: str | None = None,
    ) -> None:
        dim = basis.mesh.dim()
        # A number is the stiffness in each direction.
        k = finite(stiffness, "stiffness")
        if k.ndim == 0:
            k = np.broadcast_to(k, (dim,))
        if k.shape != (dim,) or (k < 0.0).any() or not k.any():
            raise ValueError(
                "stiffness must be positive, in each direction or in one of them, not "
                f"{stiffness!r}"
            )
        # Springs to the ground: k on the diagonal.
        first = dofs_at(basis, coordinates, part)
        data = np.broadcast_to(k, first.shape).ravel()
        rows = columns = first.ravel()
        if to is not None:
            # k (u_1 - u_2) at the first end, and the opposite force at the second
            a = rows
            b = np.broadcast_to(dofs_at(basis, to, to_part), first.shape).ravel()
            rows = np.concatenate((a, a, b, b))
            columns = np.concatenate((a, b, a, b))
            data = np.concatenate((data, -data, -data, data))
        K = coo_matrix((data, (rows, columns)), shape=(basis.N, basis.N)).tocsr()
        K.eliminate_zeros()
        super().__init__(K)


@dataclass(frozen=True)
class BarState:
    """State of bars, arrays (n,).

    Attributes
    ----------
    force
        Normal force of one member, tension positive.
    free
        Elongation without force.
    """

    force: ndarray
    free: ndarray


class Bar(Form, Couples, Staged, Regularised):
    """Bars of one kind between nodes, or between nodes and the ground: anchors, struts, ties.

    By default for small displacements: a bar keeps its direction.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh; None where both ends are at beams, or fixed.
    start, end
        Coordinates of the ends, (n, dim) or (dim,), nodes of the mesh; or nodes of a beam,
        :meth:`Beam.at`.
    EA
        Axial stiffness: force per strain, in the plane per unit of length out of it, in axial
        symmetry per radian; ``n EA / (2 pi)`` for n members round the axis.
    fixed_end
        True if ground far away holds the ends: they do not move, and need be no nodes.
    yield_force
        Largest normal force; beyond it bars flow.
    tension_only, compression_only
        True if bars, such as ropes, resist no thrust; or, such as struts on corbels, no tension.
    part, end_part
        Subdomains of the nodes, where nodes of two bodies coincide.
    spacing
        Distance of the members of a row in the plane, or angle between them in axial symmetry,
        ``2 pi / n``: EA, forces and strength are then of one member.
    kinematics
        ``"finite"`` for displacements of any size: a bar turns with its ends, and its strain is the
        change of its length over the length before.

    Raises
    ------
    ValueError
        Coordinates without a node or with nodes of two bodies, bars without length, EA or a yield
        force not positive, an angle between members that is no part of the circle.

    Notes
    -----
    A bar is prestressed in a stage by :meth:`prestressed`: the force then does not depend on the
    displacements. The bar is locked in the next stage, where it continues from that force
    (``Stage(change={"anchor": bar})``).

    Examples
    --------
    A rope of two metres holds a block and is stretched by the weight of 20:

    >>> import numpy as np
    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> basis = Basis(MeshQuad().with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> rope = sc.Bar(basis, (0., 1.), (0., 3.), EA=1e3, fixed_end=True, tension_only=True)
    >>> forms = {"block": sc.SolidForm(basis, sc.LinearElastic(E=1e9, nu=0.)), "rope": rope}
    >>> load = basis.zeros()
    >>> load[basis.get_dofs("left").all("u^2")] = -10.
    >>> fixed = basis.get_dofs().all("u^1")
    >>> state = sc.Model(forms, fixed).run([sc.Stage("hang", load)])["hang"].states["rope"]
    >>> state.force.round(6), (state.force * 2. / 1e3).round(6)
    (array([20.]), array([0.04]))
    """

    _same = ("_where",)
    _by_angle = False

    def __init__(
        self,
        basis: CellBasis | None,
        start: ArrayLike | FieldDofs,
        end: ArrayLike | FieldDofs,
        EA: float,
        fixed_end: bool = False,
        yield_force: float = np.inf,
        tension_only: bool = False,
        part: str | None = None,
        end_part: str | None = None,
        *,
        compression_only: bool = False,
        spacing: float | None = None,
        kinematics: Kinematics = "small",
    ) -> None:
        self.kinematics = kinematics
        self._set_strength(EA, yield_force, tension_only, compression_only)
        a, b = np.broadcast_arrays(_points(start, "start", basis), _points(end, "end", basis))
        length = row_norms(b - a)
        if not (length > 0.0).all():
            raise ValueError("the ends of a bar must lie apart, and be finite")
        self.symmetric = True
        self._where = np.hstack((a, b))
        self._length = length
        self._spacing = 1.0 if spacing is None else positive(spacing, "spacing")
        self._in_row = spacing is not None
        self._stiffness = EA / length
        self._jack: float | None = None
        self.parameters = {
            "EA": EA,
            "yield_force": yield_force,
            "spacing": self._spacing,
            "tension_only": tension_only,
            "compression_only": compression_only,
        }

        # elongation = axis . (u_end - u_start), without the end that is fixed
        axis = (b - a) / length[:, None]
        self._ends = [_end_dofs(basis, start, a, part)]
        self._axis = -axis
        if not fixed_end:
            self._ends.append(_end_dofs(basis, end, b, end_part))
            self._axis = np.hstack((-axis, axis))
        fields = [dofs.field for dofs in self._ends if isinstance(dofs, FieldDofs)]
        self.borrowed = tuple(dict.fromkeys(fields))
        if not self.borrowed:
            self._connect({})

    def _set_strength(
        self,
        EA: float,
        yield_force: float,
        tension_only: bool,
        compression_only: bool,
    ) -> None:
        """Set the range of the force."""
        yields = yield_force == np.inf or is_number(yield_force, 0.0, np.inf)
        if not is_number(EA, 0.0, np.inf) or not yields:
            raise ValueError(f"EA and yield_force must be positive, not {EA!r} and {yield_force!r}")
        if tension_only and compression_only:
            raise ValueError("a bar of tension_only and compression_only resists nothing")
        self.unilateral = tension_only or compression_only
        self._least = 0.0 if tension_only else -yield_force
        self._most = 0.0 if compression_only else yield_force

    def _connect(self, numbers: Mapping[Field, ndarray]) -> None:
        """Set the dofs of both ends."""
        n = len(self._axis)
        # Collect the dofs of both ends, one row a bar.
        columns = []
        for end in self._ends:
            if isinstance(end, FieldDofs):
                dofs = numbers[end.field][end.indices]
            else:
                dofs = end
            each = self._axis.shape[1] // len(self._ends)
            columns.append(np.broadcast_to(dofs, (n, each)))
        self._dofs = np.hstack(columns)
        # Number the dofs that occur.
        self._at, rows = np.unique(self._dofs, return_inverse=True)
        self._rows = rows.reshape(self._dofs.shape)
        self._gathering = Gathering(len(self._at))
        self.changing = self._at
        self.acts_on = self._at

    @override
    def completed(self, forms: Mapping[str, Form]) -> Bar:
        if any(form.coordinates == "axisymmetric" for form in forms.values()):
            return self._round_axis()
        return self

    @override
    def continues(self, old: Bar) -> Bar:
        new: Bar = super().continues(old)
        if old._by_angle:
            return new._round_axis()
        return new

    def _round_axis(self) -> Bar:
        """Return the bars with a spacing that is an angle, of which whole numbers make a circle."""
        members = 2.0 * np.pi / self._spacing
        whole = abs(members - np.rint(members)) <= _WHOLE * members
        if self._in_row and not whole:
            raise ValueError(
                f"a spacing of {self._spacing:g} makes {members:.4g} members round the axis: in "
                "axial symmetry it is the angle between them in radians, 2 * pi over their number"
            )
        new = copy(self)
        new._by_angle = True
        return new

    @property
    @override
    def extent(self) -> Extent:  # type: ignore[override]
        """Extent of a bar's force: a row in the plane without a spacing has no single members."""
        if self._in_row or self._where.shape[1] == 6:
            return "member"
        return "radian" if self._by_angle else "length"

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Bar:
        new = copy(self)
        new._connect(numbers)
        return new

    def __repr__(self) -> str:
        k = self._stiffness
        return f"<Bar {len(k)} bars, EA/L {k.min():.4g} to {k.max():.4g}>"

    def prestressed(self, force: float) -> Bar:
        """Return the bars with a jack that keeps their force (tension positive) constant."""
        if not self._least <= force <= self._most:
            raise ValueError(
                f"the force of a jack must lie between {self._least:g} and {self._most:g}"
            )
        new = copy(self)
        new._jack = float(force)
        new.parameters = {**self.parameters, "jack": new._jack}
        return new

    def _stretched(self, x: ndarray) -> tuple[ndarray, ndarray, ndarray]:
        """Return elongations, axes by the dofs of the ends, and lengths."""
        u = x[self._dofs]
        if self.kinematics == "small":
            return np.einsum("nm,nm->n", self._axis, u), self._axis, self._length
        # Vectors from start to end, L before and l now: l - L = (2 L + du) . du / (l + L)
        n = len(u)
        dim = self._where.shape[1] // 2
        moves = u.reshape(n, -1, dim)
        moved = -moves[:, 0]
        if moves.shape[1] == 2:
            moved = moves[:, 1] - moves[:, 0]
        before = self._where[:, dim:] - self._where[:, :dim]
        now = before + moved
        length = row_norms(now)
        elongation = ((before + now) * moved).sum(axis=1) / (length + self._length)
        axis = now / length[:, None]
        ends = np.hstack((-axis, axis))
        return elongation, ends[:, : u.shape[1]], length

    @override
    def initial_state(self, x: ndarray | None = None) -> BarState:
        zero = np.zeros(len(self._axis))
        return BarState(zero, zero if x is None else self._stretched(x)[0])

    @override
    def assemble(self, x: ndarray, state: BarState) -> Response:
        k = self._stiffness
        elongation, axis, length = self._stretched(x)
        if self._jack is not None:
            force = np.full_like(elongation, self._jack)
            slack = np.zeros(len(k), bool)
            tangent = np.zeros(len(k))
        else:
            # slack ropes and bars that flow have no stiffness
            elastic = k * (elongation - state.free)
            force = np.clip(elastic, self._least, self._most)
            slack = force == 0.0
            tangent = np.where(force == elastic, k, 0.0)

        n = len(self._at)
        forces = force[:, None] / self._spacing * axis
        return Response(
            np.bincount(self._rows.ravel(), forces.ravel(), minlength=n),
            lambda: BarState(force, np.where(slack, state.free, elongation - force / k)),
            stiffness=lambda: self._matrix(tangent, axis, force / length),
            dofs=self._at,
        )

    def _matrix(self, tangent: ndarray, a: ndarray, pull: ndarray) -> csr_matrix:
        """Return the stiffness among the dofs of the bars.

        Parameters
        ----------
        tangent
            Forces by elongations, (n,).
        a
            Axes, by the dofs of the ends.
        pull
            Forces over lengths, (n,), which turning bars move.
        """
        # k a a^T of every bar
        k = tangent[:, None, None] / self._spacing
        along = a[:, :, None] * a[:, None, :]
        K = k * along
        if self.kinematics == "finite":
            # N / l (1 - e e^T) across the axis e, with opposite signs at the two ends
            dim = self._where.shape[1] // 2
            ends = a.shape[1] // dim
            signs = np.array([-1.0, 1.0])[:ends]
            unit = np.kron(np.outer(signs, signs), np.eye(dim))
            K = K + pull[:, None, None] / self._spacing * (unit - along)
        return self._gathering.matrix(self._rows, K)

    @override
    def inherits(self, old: Bar, state: BarState) -> BarState:
        # a new stiffness changes no force
        before = state.force / old._stiffness
        return with_force_kept(state, before, state.force / self._stiffness)

    @override
    def rebased(self, x: ndarray, state: BarState) -> BarState:
        if self.kinematics == "finite":
            raise ValueError("a bar of finite kinematics keeps its displacements")
        return BarState(state.force, state.free - self._stretched(x)[0])

    @override
    def outputs(self, x: ndarray, state: BarState) -> Outputs:
        axes = "xyz"[: self._where.shape[1] // 2]
        names = [*axes, *(f"end {axis}" for axis in axes)]
        members = dict(zip(names, self._where.T))
        parameters = dict(self.parameters)
        if self._by_angle:
            parameters["angle of spacing"] = parameters.pop("spacing")
        return Outputs(
            summary=f"forces {state.force.min():.4g} to {state.force.max():.4g}",
            parameters=parameters,
            members=members | {"force": state.force},
        )


def _points(end: ArrayLike | FieldDofs, name: str, basis: CellBasis | None) -> ndarray:
    """Return the coordinates of the ends of bars, (n, dim)."""
    if isinstance(end, FieldDofs):
        return end.field.coordinates[:, end.indices[:, 0]].T
    points = np.atleast_2d(finite(end, name))
    dim = points.shape[-1] if basis is None else basis.mesh.dim()
    if points.ndim != 2 or points.shape[1] != dim:
        raise ValueError(f"the ends of a bar must be points of {dim} coordinates, not {end!r}")
    return points


def _end_dofs(
    basis: CellBasis | None,
    end: ArrayLike | FieldDofs,
    points: ndarray,
    part: str | None,
) -> ndarray | FieldDofs:
    """Return the dofs of ends of bars: nodes of the mesh, (n, dim), or of a beam."""
    if isinstance(end, FieldDofs):
        return end
    if basis is None:
        raise ValueError("a bar between nodes of the mesh needs its basis")
    return dofs_at(basis, points, part)
