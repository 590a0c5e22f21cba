"""Rigid boundaries: footings, caps and platens that are much stiffer than the ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import copy
from dataclasses import replace

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.linalg import null_space
from scipy.sparse import coo_matrix, csr_matrix
from skfem import CellBasis
from typing_extensions import override

from ..arrays import max_abs
from ..checks import check_basis, facets_of, vector
from ..errors import Remark
from ..layout import Field, rigid_modes
from .base import Forms, Outputs, Response, solids_of
from .links import MatrixForm

#: Coordinates that count as the same, as a share of the mesh, and the least turn that counts.
_SAME = 1e-9
_TURNS = 1e-6
#: Motion that is not rigid, as a share of all displacements, beyond the tolerance of equilibrium.
_BENT = 1e-6


class RigidBoundary(MatrixForm):
    """A boundary that moves as a rigid body, such as below a footing, a cap or a platen.

    Small displacements: it may sink and turn, and the ground sticks to it. Multipliers, dofs
    besides the displacements, keep all of its motions at zero but the rigid ones; to prescribe one
    of these, hold a single node. In axial symmetry it moves along the axis alone.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh.
    boundary
        Its name.
    rotates
        True if it may turn; else it is guided and moves parallel to itself, as in half a model that
        ends in a plane of symmetry.

    Raises
    ------
    ValueError
        The boundary does not exist or is empty; where it is run: it belongs to no solid.

    Examples
    --------
    A footing of one metre, loaded at a third of its width from its end, tilts so far that the other
    end stays:

    >>> from skfem import Basis, ElementQuad1, ElementVector, MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad().refined(2).with_defaults()
    >>> basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    >>> footing = sc.RigidBoundary(basis, "top")
    >>> forms = {"soil": sc.SolidForm(basis, sc.LinearElastic(E=1e3, nu=0.)), "footing": footing}
    >>> stage = sc.Stage("load", footing.load((0., -10.), at=(1 / 3, 1.)))
    >>> x = sc.Model(forms, basis.get_dofs("bottom").all()).run([stage])["load"].x
    >>> [f"{footing.motion(x, at)[1]:.4f}" for at in ((0., 1.), (1., 1.))]
    ['-0.0197', '-0.0003']
    """

    kinematics = "small"

    _multipliers: ndarray  # numbered by the model

    def __init__(self, basis: CellBasis, boundary: str, rotates: bool = True) -> None:
        check_basis(basis)
        facets = facets_of(basis.mesh, boundary)
        self._dofs = np.unique(basis.get_dofs(facets).all())  # node by node
        self._coordinates = basis.doflocs[:, self._dofs]
        self._modes = slice(None) if rotates else slice(basis.mesh.dim())
        self._displacements = int(basis.N)
        self._locations = basis.doflocs
        self._tie()
        super().__init__(csr_matrix((self._displacements, self._displacements)))

    def __repr__(self) -> str:
        return f"<RigidBoundary {len(self._dofs)} displacements>"

    def _tie(self) -> None:
        """Put multipliers on an orthonormal basis of all motions that are not rigid."""
        self._rigid, _ = self._motions(self._coordinates[:, 0])
        self._others = null_space(self._rigid.T)
        where = self._coordinates[:, : self._others.shape[1]]
        self.fields = (Field("force of a rigid boundary", where, "multiplier"),)

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> RigidBoundary:
        multipliers = numbers[self.fields[0]]
        size = max(self._displacements, int(multipliers.max(initial=-1)) + 1)
        # The ties couple the displacements with the multipliers, symmetrically.
        ties = _block(self._others, self._dofs, multipliers, size)
        new = copy(self)
        MatrixForm.__init__(new, ties + ties.T)
        new._multipliers = multipliers
        return new

    @override
    def completed(self, forms: Forms) -> RigidBoundary:
        largest = 0.0
        for solid in solids_of(forms).values():
            diagonal = solid.elastic_stiffness.diagonal()
            largest = max(largest, float(diagonal[self._dofs].max()))
        if largest == 0.0:
            raise ValueError(
                "a rigid boundary rests on nothing: its boundary belongs to no solid among the "
                "forms"
            )
        new = copy(self)
        if any(solid.coordinates == "axisymmetric" for solid in solids_of(forms).values()):
            new._modes = slice(1, 2)  # other motions stretch circumferences
            new._tie()
        new.fields = (replace(new.fields[0], scale=largest),)
        return new

    @override
    def supported(self, fixed: ndarray) -> tuple[RigidBoundary, ndarray]:
        none = np.zeros(0, int)
        held = np.isin(self._dofs, fixed)
        if not held.any():
            return self, none
        # Find motions of supported dofs alone that are not rigid: supports keep them at zero.
        by_supports = self._others[held].T @ null_space(self._rigid[held].T)
        if by_supports.size == 0:
            return self, none
        # Keep their multipliers at zero, as no equation of a free dof has them.
        idle = by_supports @ by_supports.T / self.fields[0].scale
        ties = self.elastic_stiffness
        new = copy(self)
        multipliers = self._multipliers
        MatrixForm.__init__(new, ties - _block(idle, multipliers, multipliers, ties.shape[0]))
        return new, none

    @override
    def outputs(self, x: ndarray, state: ndarray) -> Outputs:
        return Outputs(remarks=lambda: self._remarks((x[: self.size] - state)[self._dofs]))

    def _remarks(self, moved: ndarray) -> Iterator[Remark]:
        """Report prescribed displacements that are no rigid motion."""
        bent = self._others @ (self._others.T @ moved)
        share = max_abs(bent) / max(max_abs(moved), 1e-300)
        if share > _BENT:
            yield Remark(
                "bent",
                share,
                f"it does not stay rigid, by {share:.1%} of its displacements, for several of its "
                "nodes are supported and moved otherwise: hold a single node",
            )

    @override
    def assemble(self, x: ndarray, state: ndarray) -> Response:
        response = super().assemble(x, state)
        own = self._multipliers
        # motions that are not rigid are compared with the displacements that cancel in them
        response.measure = response.force.copy()
        response.measure[own] = (abs(self.elastic_stiffness) @ abs(x - state))[own]
        return response

    @override
    def rebased(self, x: ndarray, state: ndarray) -> ndarray:
        moved = super().rebased(x, state)
        moved[self._multipliers] = state[self._multipliers]
        return moved

    @override
    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Iterator[Remark]:
        for axis in range(len(self._coordinates)):
            plane = self._plane_of_symmetry(axis, fixed)
            if plane is not None and self._turns_out_of(axis, fixed):
                yield Remark(
                    "turns",
                    0.0,
                    f"it ends at {'xyz'[axis]} = {plane:.4g}, where supports hold it across, and "
                    "may turn there: in a plane of symmetry give rotates=False",
                )

    def _turns_out_of(self, axis: int, fixed: ndarray) -> bool:
        """Return True if a motion that supports leave turns a plane across an axis."""
        dim, n = self._coordinates.shape
        # Append the two ends of an axis to the nodes: rigid modes show how it turns.
        first = self._coordinates[:, 0]
        ends = np.stack((first, first), axis=1)
        ends[axis, 1] += np.ptp(self._coordinates[axis])
        of_ends = np.repeat(ends, dim, axis=1)
        coordinates = np.column_stack((self._coordinates, of_ends))
        every = np.arange(n + 2 * dim)
        modes = rigid_modes(coordinates, every)[:, self._modes]
        # Keep the modes that the supports leave.
        at_supports = np.isin(self._dofs, fixed)
        free = null_space(modes[:n][at_supports])
        first_end = modes[n : n + dim]
        second_end = modes[n + dim :]
        turn = (second_end - first_end) @ free
        return max_abs(turn) > _TURNS

    def _plane_of_symmetry(self, axis: int, fixed: ndarray) -> float | None:
        """Return the coordinate of a plane at one end, held across beside the boundary as well."""
        dim = len(self._coordinates)
        # Find the one end at which supports hold the boundary across.
        across = self._dofs % dim == axis
        x = self._coordinates[axis, across]
        held = np.isin(self._dofs[across], fixed)
        ends = set()
        for end in (x.min(), x.max()):
            if held[x == end].any():
                ends.add(float(end))
        if len(ends) != 1 or x.min() == x.max():
            return None
        (end,) = ends
        # Nothing of the body lies beyond, and other nodes there are held as well.
        others = np.setdiff1d(fixed[fixed < self._displacements], self._dofs)
        others = others[others % dim == axis]
        size = np.ptp(self._locations[axis])
        near = np.abs(self._locations[axis] - end) < _SAME * size
        last = max_abs(self._locations[axis] - end) > (1.0 - _SAME) * size
        if last and near[others].any():
            return end
        return None

    def load(self, force: ArrayLike, at: ArrayLike) -> ndarray:
        """Return the load vector, (N,), of a force, (dim,), at coordinates, (dim,), anywhere."""
        load = np.zeros(self._displacements)
        load[self._dofs] = self._spread(at) @ vector(force, len(self._coordinates), "force")
        return load

    def motion(self, x: ndarray, at: ArrayLike) -> ndarray:
        """Return the displacement, (dim,), of the rigid body at coordinates, (dim,).

        It follows from all displacements x, (N,).
        """
        return self._spread(at).T @ x[self._dofs]

    def _spread(self, at: ArrayLike) -> ndarray:
        """Return the map, (n, dim), from a force at a point to forces on the dofs."""
        modes, modes_there = self._motions(vector(at, len(self._coordinates), "at"))
        return np.linalg.pinv(modes).T @ modes_there.T

    def _motions(self, point: ndarray) -> tuple[ndarray, ndarray]:
        """Return rigid motions of the dofs, (n, modes), and at a point, (dim, modes)."""
        dim, n = self._coordinates.shape
        point_dofs = np.tile(point[:, None], dim)
        coordinates = np.column_stack((self._coordinates, point_dofs))
        modes = rigid_modes(coordinates, np.arange(n + dim))[:, self._modes]
        return modes[:n], modes[n:]


def _block(values: ndarray, rows: ndarray, columns: ndarray, size: int) -> csr_matrix:
    """Return a matrix, (size, size), that is zero but for a full block of some dofs."""
    row, column = np.broadcast_arrays(rows[:, None], columns)
    entries = values.ravel(), (row.ravel(), column.ravel())
    return coo_matrix(entries, shape=(size, size)).tocsr()
