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

from ..checks import finite, is_number, positive
from ..layout import Field, FieldDofs, dofs_at
from .base import Form, Outputs, Response
from .roles import Couples, Regularised, Staged, Stiff, with_force_kept


class MatrixForm(Form, Stiff, Couples, Staged):
    """Linear form of any matrix, such as that of a ``BilinearForm``.

    Parameters
    ----------
    K
        Stiffness, (N, N), sparse.

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
    >>> basis = Basis(MeshQuad().refined(2).with_defaults(), ElementVector(ElementQuad1()), intorder=2)
    >>> bottom = FacetBasis(basis.mesh, basis.elem, facets="bottom")
    >>> subgrade = BilinearForm(lambda u, v, w: 100. * (u[0] * v[0] + u[1] * v[1])).assemble(bottom)
    >>> forms = {"square": sc.SolidForm(basis, sc.LinearElastic(E=1e6, nu=0.)), "ground": sc.MatrixForm(subgrade)}
    >>> result = sc.Model(forms).run([sc.Stage("weight", sc.weight(basis, 20.))])
    >>> [float(f"{u:.4f}") for u in result["weight"].x[basis.get_dofs("bottom").all("u^2")]]
    [-0.2, -0.2, -0.2, -0.2, -0.2]
    """

    def __init__(self, K: spmatrix | sparray | ndarray) -> None:
        shape = np.shape(K)  # type: ignore[arg-type]
        if len(shape) != 2:
            raise ValueError(f"K must be a square matrix, not an array of shape {shape}")
        self.elastic_stiffness = csr_matrix(K)  # type: ignore[arg-type]
        self.size: int = int(self.elastic_stiffness.shape[1])
        if (
            self.elastic_stiffness.shape[0] != self.size
            or not np.isfinite(self.elastic_stiffness.data).all()
        ):
            raise ValueError(
                f"K must be a square matrix of finite numbers, not {self.elastic_stiffness.shape}"
            )
        largest = abs(self.elastic_stiffness).max() if self.elastic_stiffness.nnz else 0.0
        self.symmetric = (
            abs(self.elastic_stiffness - self.elastic_stiffness.T).max() <= 1e-12 * largest
        )
        self.changing = np.zeros(0, int)
        self.acts_on = self.elastic_stiffness.indices

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.size} dofs, {self.elastic_stiffness.nnz} entries>"

    @override
    def initial_state(self, x: ndarray | None = None) -> ndarray:  # displacements without force
        return np.zeros(self.size) if x is None else x[: self.size].copy()

    @override
    def assemble(self, x: ndarray, state: ndarray) -> Response:
        return Response(
            self.elastic_stiffness @ (x - state), lambda: state, lambda: self.elastic_stiffness
        )

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
        Force per displacement in each direction, (dim,), or one number for all.
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
        k = finite(stiffness, "stiffness")
        k = np.broadcast_to(k, (basis.mesh.dim(),)) if k.ndim == 0 else k
        if not (k.shape == (basis.mesh.dim(),) and (k >= 0.0).all() and k.any()):
            raise ValueError(
                f"stiffness must be positive, in each direction or in one of them, not "
                f"{stiffness!r}"
            )
        ends = [dofs_at(basis, coordinates, part)]
        if to is not None:
            ends.append(dofs_at(basis, to, to_part))
        entries = [
            (sign_a * sign_b * k, a, b)
            for a, sign_a in zip(ends, (1, -1))
            for b, sign_b in zip(ends, (1, -1))
        ]
        data, rows, columns = (
            np.concatenate([np.broadcast_to(entry[i], ends[0].shape).ravel() for entry in entries])
            for i in range(3)
        )
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

    Small displacements: a bar keeps its direction.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh; None where both ends are at beams, or fixed.
    start, end
        Coordinates of the ends, (n, dim) or (dim,), nodes of the mesh; or nodes of a beam,
        :meth:`Beam.at`.
    EA
        Axial stiffness: force per strain, in the plane per unit of length out of it.
    fixed_end
        True if ground far away holds the ends: they do not move, and need be no nodes.
    yield_force
        Largest normal force; beyond it bars flow.
    tension_only, compression_only
        True if bars, such as ropes, resist no thrust; or, such as struts on corbels, no tension.
    part, end_part
        Subdomains of the nodes, where nodes of two bodies coincide.
    spacing
        Distance of the members of a row in the plane: EA, forces and strength are those of one of
        them.

    Raises
    ------
    ValueError
        Coordinates without a node or with nodes of two bodies, bars without length, EA or a yield
        force not positive.

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
        spacing: float = 1.0,
    ) -> None:
        if not (
            is_number(EA, 0.0, np.inf)
            and (yield_force == np.inf or is_number(yield_force, 0.0, np.inf))
        ):
            raise ValueError(f"EA and yield_force must be positive, not {EA!r} and {yield_force!r}")
        if tension_only and compression_only:
            raise ValueError("a bar of tension_only and compression_only resists nothing")
        a, b = np.broadcast_arrays(_points(start, "start", basis), _points(end, "end", basis))
        length = np.linalg.norm(b - a, axis=1)
        if not (length > 0.0).all():
            raise ValueError("the ends of a bar must lie apart, and be finite")
        axis = (b - a) / length[:, None]
        ends = [(start, a, part, -axis), *([] if fixed_end else [(end, b, end_part, axis)])]
        self._parameters = {
            "EA": EA,
            "yield_force": yield_force,
            "spacing": spacing,
            "tension_only": tension_only,
            "compression_only": compression_only,
        }
        self._where = np.hstack((a, b))
        self._axis = np.hstack([sign for *_, sign in ends])
        self._ends = [
            at if isinstance(at, FieldDofs) else _at(basis, points, name)
            for at, points, name, _ in ends
        ]
        self.borrowed = tuple({at.field: None for at in self._ends if isinstance(at, FieldDofs)})
        self.symmetric, self.unilateral = True, tension_only or compression_only
        self._spacing, self._stiffness = positive(spacing, "spacing"), EA / length
        self._least, self._most = (
            0.0 if tension_only else -yield_force,
            0.0 if compression_only else yield_force,
        )
        self._jack: float | None = None
        if not self.borrowed:
            self._connect({})

    def _connect(self, numbers: Mapping[Field, ndarray]) -> None:
        """Set the dofs of both ends."""
        self._dofs = np.hstack(
            [
                np.broadcast_to(
                    numbers[at.field][at.indices] if isinstance(at, FieldDofs) else at,
                    (len(self._axis), self._axis.shape[1] // len(self._ends)),
                )
                for at in self._ends
            ]
        )
        self._at, rows = np.unique(self._dofs, return_inverse=True)
        self._rows = rows.reshape(self._dofs.shape)
        self.changing = self.acts_on = self._at

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Bar:
        new = copy(self)
        new._connect(numbers)
        return new

    def __repr__(self) -> str:
        return f"<Bar {len(self._axis)} bars, EA/L {self._stiffness.min():.4g} to {self._stiffness.max():.4g}>"

    def prestressed(self, force: float) -> Bar:
        """Return the bars with a jack that keeps their force, tension positive, at any
        elongation.
        """
        if not self._least <= force <= self._most:
            raise ValueError(
                f"the force of a jack must lie between {self._least:g} and {self._most:g}"
            )
        new = copy(self)
        new._jack = float(force)
        new._parameters = {**self._parameters, "jack": new._jack}
        return new

    def _elongation(self, x: ndarray) -> ndarray:
        return np.einsum("nm,nm->n", self._axis, x[self._dofs])

    @override
    def initial_state(self, x: ndarray | None = None) -> BarState:
        zero = np.zeros(len(self._axis))
        return BarState(zero, zero if x is None else self._elongation(x))

    @override
    def assemble(self, x: ndarray, state: BarState) -> Response:
        k, elongation = self._stiffness, self._elongation(x)
        elastic = k * (elongation - state.free)
        force = (
            np.full_like(elastic, self._jack)
            if self._jack is not None
            else np.clip(elastic, self._least, self._most)
        )
        slack = (force == 0.0) & (self._jack is None)
        # slack ropes and bars that flow have no stiffness
        tangent = np.where((force == elastic) & (self._jack is None), k, 0.0)

        def stiffness() -> csr_matrix:
            blocks = (
                tangent[:, None, None]
                / self._spacing
                * self._axis[:, :, None]
                * self._axis[:, None, :]
            )
            rows, columns = np.broadcast_arrays(self._rows[:, :, None], self._rows[:, None, :])
            n = len(self._at)
            return coo_matrix(
                (blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n)
            ).tocsr()

        forces = force[:, None] / self._spacing * self._axis
        return Response(
            np.bincount(self._rows.ravel(), forces.ravel(), minlength=len(self._at)),
            lambda: BarState(force, np.where(slack, state.free, elongation - force / k)),
            stiffness,
            dofs=self._at,
        )

    @override
    def inherits(self, old: Bar, state: BarState) -> BarState:  # a new stiffness changes no force
        before = state.force / old._stiffness
        return with_force_kept(state, before, state.force / self._stiffness)

    @override
    def rebased(self, x: ndarray, state: BarState) -> BarState:
        return BarState(state.force, state.free - self._elongation(x))

    @override
    def outputs(self, x: ndarray, state: BarState) -> Outputs:
        axes = "xyz"[: self._where.shape[1] // 2]
        names = [*axes, *(f"end {axis}" for axis in axes)]
        return Outputs(
            summary=f"forces {state.force.min():.4g} to {state.force.max():.4g}",
            parameters=self._parameters,
            members=dict(zip(names, self._where.T)) | {"force": state.force},
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


def _at(basis: CellBasis | None, points: ndarray, part: str | None) -> ndarray:
    """Return the dofs of nodes of the mesh, (n, dim)."""
    if basis is None:
        raise ValueError("a bar between nodes of the mesh needs its basis")
    return dofs_at(basis, points, part)
