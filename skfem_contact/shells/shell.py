"""Thin shells in space as a form: stiffness, weight, loads, forces and moments per length."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import override

from ..beams.joints import joined, taken_by
from ..beams.nodes import Nodes
from ..beams.thrust import counts
from ..checks import facets_of, finite, is_number, positive, vector
from ..forms.base import Form, Outputs, Response
from ..forms.roles import Slender, with_force_kept
from ..layout import Field
from ..sparse import Gathering, constant
from ..surfaces.topology import facets_and_dofs
from ..surfaces.vectors import unit
from .corners import at_corners, averages
from .element import (
    BENDING,
    MEMBRANE,
    Triangles,
    divided,
    elasticity,
    lost_stiffness,
    n_corners,
    normals,
)
from .orientation import check_alike, turned

#: Round-off of forces, as a share of the stiffness times the displacements.
_ROUND_OFF = 4 * np.finfo(float).eps
#: Forces and moments per length.
_RESULTANTS = ("n_1", "n_2", "n_12", "m_1", "m_2", "m_12")
#: Sine of the least angle between the axis by default and every normal.
_CLEAR = 0.5


@dataclass(frozen=True)
class ShellState:
    """State of a shell.

    Attributes
    ----------
    force
        Forces per length n_1, n_2, n_12, moments per length m_1, m_2, m_12 at three points, and
        moments about the normal, of each triangle, (m, 15).
    free
        Strains without force, (m, 15).
    """

    force: ndarray
    free: ndarray


class Shell(Nodes, Slender):
    r"""Thin elastic plate or shell in space: a raft, a slab, a tank, a wall.

    Flat triangles of constant membrane strains and discrete Kirchhoff bending, of small
    displacements and without shear strains: the thickness is below a tenth of the span. The shell
    is bonded to the nodes of facets of a mesh, or has nodes of its own.

    The table of a stage, ``stage.table("raft")``, has forces and moments per length at the centre
    x, y, z of each triangle: ``n_1``, ``n_2``, ``n_12``, tension positive, and ``m_1``, ``m_2``,
    ``m_12``. A positive ``m_1`` stretches fibres along axis 1 on the side to which the normal
    points.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh in space; None for a shell alone.
    facets
        Name of facets of the mesh, on its boundary or inside: the shell has their nodes. Or
        coordinates of nodes of its own, (n, 3).
    E, nu, thickness
        Young's modulus, Poisson's ratio and thickness.
    cells
        Nodes of the facets of a shell with nodes of its own, (m, k), k = 3, 4, 6, 8 or 9: corners
        first, anticlockwise seen from the side to which the normal points.
    axis
        Axis 1 is the part in the shell of this direction, axis 2 lies 90 degrees anticlockwise of
        it. By default x, or the first of y and z that is nowhere nearly normal to the shell.
    unit_weight
        Weight per volume.
    joined_to
        Beams and shells whose nodes this shell shares where both have one, rigidly: a wall on its
        slab. Without it, shells on facets of one mesh are hinged where they meet.

    Attributes
    ----------
    areas : ndarray, shape (m,)
        Areas that the rows of the table stand for.

    Raises
    ------
    ValueError
        A mesh in the plane, unknown facets, a stiffness that is not positive, an axis normal to
        the shell, neighbouring cells whose normals point to opposite sides, no node in common with
        a form that the shell is joined to.

    Notes
    -----
    Normals of facets on a boundary point out of the body. Connected facets inside, also
    round corners, have theirs on one side: upwards in the mean, or where they are level along y or
    x, or out of a ring or shaft. Where three facets meet in an edge, each side has its own.

    Facets with middle nodes are divided at them, quadrilaterals along both diagonals. Moments
    converge with the square of the elements' size.

    Examples
    --------
    A square plate on simple supports under q = 1, whose centre moves by 0.00406 q L**4 / D:

    >>> import numpy as np
    >>> from skfem import MeshQuad
    >>> import skfem_contact as sc
    >>> mesh = MeshQuad.init_tensor(np.linspace(0, 1, 17), np.linspace(0, 1, 17))
    >>> points = np.column_stack((*mesh.p, 0 * mesh.p[0]))
    >>> plate = sc.Shell(None, points, E=12e3, nu=.3, thickness=.1, cells=mesh.t.T)
    >>> rim = [p for p in points if p[:2].min() == 0. or p[:2].max() == 1.]
    >>> fixed = [dof for p in rim for dof in plate.dofs(p, ["u^1", "u^2", "u^3"])]
    >>> model = sc.Model({"plate": plate}, fixed)
    >>> load = model.forms["plate"].area_load((0., 0., -1.))
    >>> stage = model.run([sc.Stage("load", load)])["load"]
    >>> w = -stage.x[model.forms["plate"].numbers((.5, .5, 0.))[2]]
    >>> D = 12e3 * .1**3 / 12 / (1 - .3**2)
    >>> f"{w * D:.5f}"
    '0.00405'
    """

    kind = "shell"
    symmetric = True
    coordinates = "space"
    _same = ("points", "_rows")
    _brought = ("parameters", "_elasticity", "_weight", "_matrices")

    def __init__(
        self,
        basis: CellBasis | None,
        facets: Any,
        *,
        E: float,
        thickness: float,
        nu: float = 0.0,
        cells: ArrayLike | None = None,
        axis: ArrayLike | None = None,
        unit_weight: float = 0.0,
        joined_to: Form | Sequence[Form] = (),
    ) -> None:
        positive(E, "E of a shell")
        positive(thickness, "thickness of a shell")
        if not is_number(nu, -1.0, 0.5) or unit_weight < 0.0:
            raise ValueError(
                "a shell has nu between -1 and 0.5 and a unit_weight that is not negative, not "
                f"nu={nu!r} and unit_weight={unit_weight!r}"
            )
        self.parameters = {
            "E": E,
            "nu": nu,
            "thickness": thickness,
            "unit_weight": unit_weight,
        }

        # Find nodes, facets and their triangles
        if isinstance(facets, str):
            self.shared, self.points, cells = _bonded(basis, facets, cells)
        else:
            self.shared = None
            self.points, cells = _of_its_own(facets, cells)
        corners, shares, self._covering = divided(cells)
        points = self.points[corners]
        if axis is None:
            self._triangles = _with_default_axis(points, shares)
        else:
            self._triangles = Triangles(points, shares, vector(axis, 3, "axis"))
        self.areas = self._triangles.areas

        # Take dofs of beams and shells at common nodes
        moved, turned_with, _ = taken_by(
            self.points,
            self.shared is not None,
            hinges=np.zeros(0, int),
            others=joined(joined_to, self.kind),
            kind=self.kind,
        )

        # Number the dofs: displacements of all nodes, then rotations
        n = len(self.points)
        places = np.repeat(self.points, 3, axis=0).T
        size = float(np.sqrt(np.median(self.areas)))
        self.displacement = Field("displacement of a shell", places, taken=moved)
        self.rotation = Field(
            "rotation of a shell", places, kind="rotation", scale=1.0 / size, taken=turned_with
        )
        self.fields = (self.displacement, self.rotation)
        if self.shared is not None:
            self.fields = (self.rotation,)
        moves = (3 * corners[:, :, None] + np.arange(3)).reshape(-1, 9)
        self._rows = np.hstack((moves, 3 * n + moves))
        self._corners = corners
        self._gathering = Gathering(6 * n)

        # Stiffness of each triangle: S^T A C S
        self._elasticity = elasticity(E, nu, thickness)
        self._weight = unit_weight * thickness
        strains = self._triangles.strains
        forces = self._elasticity @ strains * self.areas[:, None, None]
        self._matrices = strains.transpose(0, 2, 1) @ forces
        self.joins = None

    def __repr__(self) -> str:
        return f"<Shell {len(self._corners)} triangles, area {self.areas.sum():.4g}>"

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Shell:
        new = copy(self)
        new._dofs = new.acts_on = self._numbers(numbers)
        new.changing = np.zeros(0, int)
        return new

    @property
    def rotations(self) -> ndarray:
        """Rotations of the nodes of a model's shell, (n, 3)."""
        return self._of_model()[3 * len(self.points) :].reshape(-1, 3)

    def _strains(self, x: ndarray) -> ndarray:
        """Return the strains of the triangles, (m, 15)."""
        u = self._own(x)[self._rows]
        return np.asarray(np.einsum("msj,mj->ms", self._triangles.strains, u))

    @override
    def initial_state(self, x: ndarray | None = None) -> ShellState:
        zero = np.zeros((len(self._corners), 15))
        return ShellState(zero, zero if x is None else self._strains(x))

    @override
    def assemble(self, x: ndarray, state: ShellState) -> Response:
        # f = S^T A C (S u - free)
        force = (self._strains(x) - state.free) @ self._elasticity
        on_nodes = np.einsum("msj,ms->mj", self._triangles.strains, force * self.areas[:, None])
        u = np.abs(self._own(x)[self._rows])
        round_off = _ROUND_OFF * np.einsum("mij,mj->mi", np.abs(self._matrices), u)

        def gathered(forces: ndarray) -> ndarray:
            return self._gathering.force(self._rows, forces)

        return Response(
            gathered(on_nodes),
            lambda: ShellState(force, state.free),
            lambda: self._stiffness,
            round_off=gathered(round_off),
            measure=gathered(np.abs(on_nodes)),
            dofs=self._dofs,
        )

    @cached_property
    def _stiffness(self) -> csr_matrix:
        """Stiffness among the dofs of the shell."""
        return constant(self._gathering.matrix(self._rows, self._matrices))

    @cached_property
    def _averages(self) -> csr_matrix:
        """Shares of the corners of triangles in the value at a corner."""
        return averages(self._corners, self._triangles)

    @override
    def inherits(self, old: Shell, state: ShellState) -> ShellState:
        # another stiffness alone changes no force
        before = state.force @ np.linalg.inv(old._elasticity)
        return with_force_kept(state, before, state.force @ np.linalg.inv(self._elasticity))

    @override
    def rebased(self, x: ndarray, state: ShellState) -> ShellState:
        return ShellState(state.force, state.free - self._strains(x))

    @override
    def lost_by_thrust(self, state: ShellState, share: float) -> tuple[ndarray, csr_matrix] | None:
        n = state.force[:, MEMBRANE]
        # smallest principal force
        least = 0.5 * (n[:, 0] + n[:, 1]) - np.hypot(0.5 * (n[:, 0] - n[:, 1]), n[:, 2])
        EI = self.parameters["E"] * self.parameters["thickness"] ** 3 / 12.0
        if not counts(self.points, least, EI, share):
            return None
        lost = lost_stiffness(self._triangles, n)
        return self._of_model(), self._gathering.matrix(self._rows, lost)

    @override
    def own_weight(self, acceleration: ndarray) -> ndarray | None:
        if not self._weight:
            return None
        return self.area_load(self._weight * acceleration)

    def area_load(self, force: ArrayLike | Callable[[ndarray], ArrayLike]) -> ndarray:
        """Return the load vector of a force per area, (3,), on a model's shell.

        It may be a function of coordinates (3, n) that returns (3, n).
        """
        centres = self._triangles.centres
        if callable(force):
            values = finite(force(centres.T), "force").T
        else:
            values = np.broadcast_to(vector(force, 3, "force"), centres.shape)
        return self._on_nodes(values)

    def pressure_load(self, pressure: float | Callable[[ndarray], ArrayLike]) -> ndarray:
        """Return the load vector of a pressure against the normals of a model's shell.

        It may be a function of coordinates (3, n) that returns (n,): of water in a tank.
        """
        centres = self._triangles.centres
        values = finite(pressure(centres.T) if callable(pressure) else pressure, "pressure")
        against = -np.broadcast_to(values, len(centres))
        return self._on_nodes(against[:, None] * self._triangles.axes[:, 2])

    def _on_nodes(self, values: ndarray) -> ndarray:
        """Return the load vector of forces per area, (m, 3), a third of which each corner takes."""
        dofs = self._of_model()
        thirds = values * self.areas[:, None] / 3.0
        forces = np.repeat(thirds, 3, axis=0).reshape(-1, 9)
        return np.bincount(dofs[self._rows[:, :9]].ravel(), forces.ravel(), dofs.max() + 1)

    @override
    def outputs(self, x: ndarray, state: ShellState) -> Outputs:
        # elasticity has a third of the moments at each of three points
        n = state.force[:, MEMBRANE]
        m = state.force[:, BENDING].reshape(-1, 3, 3).sum(axis=1)
        values = dict(zip(_RESULTANTS, np.hstack((n, m)).T, strict=True))

        def members() -> dict[str, ndarray]:
            centres = self._triangles.centres
            return dict(zip("xyz", centres.T, strict=True)) | values

        def triangles() -> tuple[ndarray, dict[str, ndarray]]:
            once = self._covering
            found = at_corners(state.force, self._averages)[once].reshape(-1, 6)
            u = self._own(x)[self._rows[once, :9]].reshape(-1, 3)
            points = self._triangles.points[once].reshape(-1, 3)
            return points, dict(zip(_RESULTANTS, found.T, strict=True)) | {"displacement": u}

        return Outputs(
            summary=lambda: (
                f"m_1 {m[:, 0].min():.4g} to {m[:, 0].max():.4g}, "
                f"m_2 {m[:, 1].min():.4g} to {m[:, 1].max():.4g}"
            ),
            parameters=self.parameters,
            triangles=triangles,
            members=members,
        )


def _bonded(basis: CellBasis | None, name: str, cells: Any) -> tuple[ndarray, ndarray, ndarray]:
    """Return the dofs and coordinates of the nodes of named facets, (n, 3), and the facets."""
    if basis is None or basis.mesh.dim() != 3:
        raise ValueError(f"a shell on the facets '{name}' needs the basis of a mesh in space")
    if cells is not None:
        raise ValueError(f"the facets '{name}' of the mesh are the cells of the shell: give none")
    facets = np.unique(facets_of(basis.mesh, name))
    dofs = facets_and_dofs(basis, facets)[1]
    first, numbers = np.unique(dofs[..., 0], return_inverse=True)
    shared = first[:, None] + np.arange(3)
    points = basis.doflocs[:, first].T.copy()
    cells = numbers.reshape(len(facets), -1)

    # Normals on a boundary point outwards; those of facets inside are made alike
    inside = np.flatnonzero(basis.mesh.f2t[1, facets] >= 0)
    wrong = inside[turned(points, cells[inside])]
    cells[wrong] = _mirrored(cells[wrong])
    return shared, points, cells


def _mirrored(cells: ndarray) -> ndarray:
    """Return facets whose corners go round the other way."""
    n = n_corners(cells)
    corners = cells[:, :n][:, ::-1]
    # the side behind corner k of n is now between corners n - 2 - k and n - 1 - k
    sides = np.roll(cells[:, n : 2 * n][:, ::-1], -1, axis=1)
    return np.hstack((corners, sides, cells[:, 2 * n :]))


def _of_its_own(points: Any, cells: Any) -> tuple[ndarray, ndarray]:
    """Return coordinates and facets of a shell with nodes of its own."""
    nodes = finite(points, "facets")
    numbers = np.asarray(() if cells is None else cells)
    if nodes.ndim != 2 or nodes.shape[1] != 3:
        raise ValueError(
            "facets of a shell must be a name, or coordinates of nodes, (n, 3), with `cells`"
        )
    whole = numbers.dtype.kind in "iu" and numbers.ndim == 2 and len(numbers) > 0
    if not whole or numbers.shape[1] not in (3, 4, 6, 8, 9):
        raise ValueError("cells of a shell must be numbers of 3, 4, 6, 8 or 9 nodes of each facet")
    if numbers.min() < 0 or numbers.max() >= len(nodes):
        raise ValueError(f"cells of a shell must be numbers of its {len(nodes)} nodes")
    if len(np.unique(numbers)) < len(nodes):
        raise ValueError("every node of a shell must belong to one of its cells")
    check_alike(nodes, numbers)
    return nodes, numbers


def _with_default_axis(points: ndarray, shares: ndarray) -> Triangles:
    """Return triangles whose axis 1 lies along the first of x, y and z that is clear of normals."""
    normal = unit(normals(points))
    for axis in np.eye(3):
        sine = np.sqrt(np.maximum(1.0 - (normal @ axis) ** 2, 0.0))
        if (sine > _CLEAR).all():
            return Triangles(points, shares, axis)
    raise ValueError("x, y and z are all normal to a part of the shell: give its `axis`")
