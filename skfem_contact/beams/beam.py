"""Beams as a form: stiffness, plastic hinges, weight, loads, section forces and sides in contact."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import override

from ..checks import finite, format_point, is_number, vector
from ..contact import ContactPair
from ..contact.laws import InterfaceLaw
from ..forms.base import Form, Response
from ..layout import Field
from ..sparse import Gathering
from ..surfaces.surface import Surface
from .element import BeamElements, Flow, Hinges, ShellElements, loose_node
from .lines import nodes_of, touching
from .nodes import BeamNodes

#: Round-off of a displacement or a rotation, as a share of it.
_ROUND_OFF = 2e-16


@dataclass(frozen=True)
class BeamState:
    """State of beams, arrays (m, 9) of the dofs of the m elements.

    Attributes
    ----------
    force
        Forces and moments on the nodes.
    free
        Displacements and rotations without force: where the beam was built, and plastic flow.
    """

    force: ndarray
    free: ndarray


class Beam(BeamNodes):
    """Beams in the plane: a wall, a lining or a frame of Timoshenko elements, elastic or with plastic hinges.

    Small displacements and rotations. The beam has nodes of its own, or those of a line of the mesh, to which it is
    bonded. Section forces are those on the nodes, see :meth:`~skfem_contact.results.StageResult.section_forces`.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh; None where there are beams only.
    line
        Coordinates of the nodes, (n, 2); or the name of a line of facets, on the boundary or inside, of a mesh with
        elements of second order. A named line begins at its upper end, a level one at its left end, and goes clockwise
        where it is closed.
    EI, EA, GA
        Stiffness against bending, stretching and shear. By default ``GA = EA / 3``, that of a rectangle with nu = 0.25.
        In plane strain a wall of thickness t has ``EI = E t**3 / 12 / (1 - nu**2)``.
    spacing
        Distance of the members of a row: the stiffnesses, strengths and weights are those of one of them. By default
        they are those per unit of length out of the plane. Section forces are per unit of length.
    cells
        Nodes of the elements, (m, 2): start and end; or (m, 3): start, end and middle, which lies on the curve. By
        default the nodes are the ends of a chain of straight elements.
    hinges
        Coordinates of nodes, (k, 2) or (2,), that transfer no moment between their elements.
    Mp, Np
        Plastic moment and plastic normal force: hinges flow at nodes where ``|M| / Mp + |N| / Np`` reaches 1.
    unit_weight
        Weight per length of the beam.
    bonded
        False if a beam along a named line has nodes of its own there.
    thickness
        Distance of the two sides, for contact.
    coordinates, nu
        ``"axisymmetric"`` for a shell of revolution about x = 0 with this Poisson's ratio: stiffnesses and section
        forces are per width, with ``EI = E t**3 / 12 / (1 - nu**2)`` and ``EA = E t / (1 - nu**2)``. Forces on nodes
        are per radian.

    Raises
    ------
    ValueError
        Stiffness or strength that is not positive, a line that is no chain, elements without length, a hinge where no
        elements meet, hinges that make a mechanism where nothing but beams resists, a basis in space.

    Examples
    --------
    A cantilever with a force at its end, ``u = F L**3 / 3 EI + F L / GA``:

    >>> import skfem_contact as sc
    >>> beam = sc.Beam(None, [[0., 0.], [1., 0.], [2., 0.]], EI=100., EA=1e4, GA=1e3)
    >>> model = sc.Model({"beam": beam}, beam.dofs((0., 0.)))
    >>> tip = model.forms["beam"].load((0., -3.), at=(2., 0.))
    >>> result = model.run([sc.Stage("tip", tip)])
    >>> result["tip"].section_forces("beam").M.round(9).tolist()
    [6.0, 3.0, 3.0, -0.0]
    """

    symmetric = True

    def __init__(self, basis: CellBasis | None, line: Any, EI: float, EA: float, GA: float | None = None, *,
                 spacing: float | None = None, cells: ArrayLike | None = None, hinges: ArrayLike = (),
                 Mp: float = np.inf, Np: float = np.inf, unit_weight: float = 0.0, bonded: bool = True,
                 thickness: float = 0.0, coordinates: Literal["plane", "axisymmetric"] = "plane",
                 nu: float = 0.0) -> None:
        GA = EA / 3.0 if GA is None else GA
        for name, value in {"EI": EI, "EA": EA, "GA": GA, "Mp": Mp, "Np": Np, "spacing": spacing or 1.0}.items():
            if not (is_number(value, 0.0, np.inf) or (name in ("Mp", "Np") and value == np.inf)):
                raise ValueError(f"{name} of a beam must be positive, not {value!r}")
        if np.isfinite(Np) and not np.isfinite(Mp):
            raise ValueError("Np of a beam needs Mp: its hinges flow by moment and normal force")
        if min(unit_weight, thickness) < 0.0:
            raise ValueError(f"unit_weight and thickness must not be negative, not {unit_weight!r} and {thickness!r}")
        shared, self.points, self.cells = nodes_of(basis, line, cells)
        self.coordinates, corners = coordinates, self.points[self.cells]
        shell = coordinates == "axisymmetric"
        if (shell and (not -1.0 < nu <= 0.5 or spacing is not None or np.isfinite(Mp))) or (not shell and nu):
            raise ValueError(f"nu={nu!r} is for a shell of revolution, -1 < nu <= 0.5; it has no spacing and no Mp")
        self._elements = ShellElements.about_axis(corners, nu) if shell else BeamElements.of(corners)
        self._shared = shared if bonded else None
        given = np.atleast_2d(finite(hinges, "hinges"))
        if given.size and (given.ndim, given.shape[1]) != (2, 2):
            raise ValueError(f"hinges of a beam must be points (x, y), not {hinges!r}")
        turn = self._turns(given.reshape(-1, 2))
        self.thickness, self.spacing = thickness, spacing or 1.0
        self._weight = unit_weight / self.spacing
        self._lay_out(turn)
        self._root = self._elements.root(*(value / self.spacing for value in (EA, GA, EI)))
        self._stiffness = self._root @ self._root.transpose(0, 2, 1)
        self._section = self._elements.section(self._root, EA / self.spacing, EI / self.spacing)
        self._hinges = Hinges(self._section, self._root, self.cells[:, :2], Mp / self.spacing,
                              Np / self.spacing) if np.isfinite(Mp) else None
        self._alone = self._wet = False

    def _turns(self, hinges: ndarray) -> ndarray:
        """Return numbers of the rotations of the elements' nodes, (m, 3): beyond a hinge another one."""
        turn, last = self.cells.copy(), len(self.points)
        for node in (self.node(at) for at in hinges):
            met = np.argwhere(self.cells[:, :2] == node)
            if len(met) < 2:
                raise ValueError(f"no elements meet at the hinge at {format_point(self.points[node])}")
            for k, end in met[1:]:
                turn[k, end], last = last, last + 1
        return turn

    def _lay_out(self, turn: ndarray) -> None:
        """Number the dofs: displacements, then rotations, as if the beam were alone."""
        n, n_turns = 2 * len(self.points), int(turn.max()) + 1
        at = np.zeros((n_turns, 2))
        at[turn] = self.points[self.cells]
        scale = 1.0 / float(np.median(self._elements.length))
        self._displacement = Field("displacement of a beam", np.repeat(self.points, 2, axis=0).T)
        self._rotation = Field("rotation of a beam", at.T, "rotation", scale)
        self.fields = (self._rotation,) if self._shared is not None else (self._displacement, self._rotation)
        displacements = 2 * self.cells[:, :, None] + np.arange(2)
        self._rows = np.hstack((displacements.reshape(len(self.cells), -1), n + turn))
        self._size, self._gathering = n + n_turns, Gathering(n + n_turns)

    def __repr__(self) -> str:
        return f"<Beam {len(self.cells)} elements, {self._elements.length.sum():.4g} long>"

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Beam:
        new = copy(self)
        own = numbers[self._displacement] if self._shared is None else self._shared.ravel()
        new._dofs = np.concatenate((own, numbers[self._rotation]))
        new.acts_on = new._dofs
        new.changing = new._dofs if self._hinges else np.zeros(0, int)
        return new

    @override
    def completed(self, forms: Mapping[str, Form]) -> Beam:
        new = copy(self)
        new._alone = all(isinstance(form, Beam) for form in forms.values())
        new._wet = any(form.law is not None and self._displacement in form.borrowed for form in forms.values())
        return new

    @override
    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Sequence[Any]:
        if self._alone and self._dofs is not None:
            loose = loose_node(self._elements.strains, self._rows, ~np.isin(self._dofs, fixed))
            if loose is not None:
                at = np.hstack((self._displacement.coordinates, self._rotation.coordinates))[:, loose]
                raise ValueError("the beam is a mechanism: its supports and hinges leave a motion without force, "
                                 f"the largest at {format_point(at)}")
        return ()

    @override
    def initial_state(self, x: ndarray | None = None) -> BeamState:
        zero = np.zeros(self._rows.shape)
        return BeamState(zero, zero if x is None else self._own(x)[self._rows])

    @override
    def assemble(self, x: ndarray, state: BeamState) -> Response:
        u = self._own(x)[self._rows]
        moved = u - state.free
        lost = _ROUND_OFF * np.einsum("mij,mj->mi", np.abs(self._stiffness), np.abs(u) + np.abs(state.free))
        moved = moved - np.einsum("mij,mj->mi", self._elements.rigid, moved[:, [4, 5, 8]])  # of large rigid motions
        force = np.einsum("mij,mj->mi", self._stiffness, moved)
        free, flows = state.free, list(self._hinges.flows(force)) if self._hinges else []
        if flows:
            free = free.copy()
            for e, flow, _ in flows:
                free[e] += flow
                force[e] -= self._stiffness[e] @ flow
        total, measure, lost = (self._gathering.force(self._rows, f) for f in (force, np.abs(force), lost))
        active = b"".join(bytes([*e.to_bytes(4, "big"), *(faces != 0.0).sum(axis=0)]) for e, _, faces in flows)
        return Response(total, lambda: BeamState(force, free), lambda: self._tangent(flows), None, lost, active,
                        measure, dofs=self._dofs)

    def _tangent(self, flows: list[Flow]) -> csr_matrix:
        blocks = self._hinges.tangent(self._stiffness, flows) if self._hinges else self._stiffness
        return self._gathering.matrix(self._rows, blocks)

    def _own(self, x: ndarray) -> ndarray:
        return x if self._dofs is None else x[self._dofs]

    @override
    def rebased(self, x: ndarray, state: BeamState) -> BeamState:
        return BeamState(state.force, state.free - self._own(x)[self._rows])

    @override
    def yielding(self, before: BeamState, after: BeamState) -> tuple[int, int]:
        return int((before.free != after.free).any(axis=1).sum()), len(self.cells)

    @override
    def summary(self, state: BeamState) -> str:
        N, _, M, *_ = np.moveaxis(self._section_forces(state), 2, 0)
        return f"N {N.min():.4g} to {N.max():.4g}, M {M.min():.4g} to {M.max():.4g}"

    @override
    def own_weight(self, acceleration: ndarray) -> ndarray | None:
        return self.line_load(self._weight * acceleration) if self._weight else None

    @override
    def water_load(self, pressure: Callable[[ndarray, ndarray, ndarray], ndarray]) -> ndarray | None:
        if not self._wet:  # no side touches the ground
            return None
        points, normals, lengths, shares = self._elements.sides(0.5 * self.thickness)
        force = -(pressure(points, normals, lengths) * lengths)[:, None] * normals
        return self._distributed(np.tile(self._rows[:, :6], (4, 1)), shares[:, :, None] * force[:, None])

    def _distributed(self, rows: ndarray, forces: ndarray) -> ndarray:
        """Return the load vector of forces (n, 3, 2) on nodes, whose dofs are (n, 6)."""
        load = np.zeros(self._of_model().max() + 1)
        np.add.at(load, self._of_model()[rows], forces.reshape(-1, 6))
        return load

    @override
    def line_forces(self, state: BeamState) -> tuple[ndarray, ...]:
        ends = np.cumsum(self._elements.length)
        position = np.column_stack((np.append(0.0, ends[:-1]), ends)).ravel()
        x, y = self.points[self.cells[:, :2].ravel()].T
        forces = self._section_forces(state)
        N, V, M, *hoop = forces.reshape(-1, forces.shape[2]).T
        return (position, x, y, N, V, M, *((None, None, None, *hoop) if hoop else ()))

    @override
    def line_points(self, x: ndarray, state: BeamState) -> tuple[ndarray, dict[str, ndarray]]:
        ends = self._section_forces(state)
        forces = np.concatenate((ends, ends.mean(axis=1, keepdims=True)), axis=1).reshape(-1, ends.shape[2]).T
        moved = self._own(x)[self._rows[:, :6]].reshape(-1, 2)
        return self._elements.points.reshape(-1, 2), {"displacement": moved, **dict(zip("NVM", forces))}

    def _section_forces(self, state: BeamState) -> ndarray:
        """Return N, V and M at both ends of the elements, (m, 2, 3), of a shell also those of the hoop, (m, 2, 5)."""
        return np.asarray(np.einsum("merj,mj->mer", self._section, state.force))

    def line_load(self, force: ArrayLike | Callable[[ndarray], ArrayLike]) -> ndarray:
        """Return the load vector of a force per length, (2,), on all elements, of a model's beam.

        It may be a function of coordinates (2, n) that returns (2, n). On a shell it is a force per area.
        """
        if not callable(force):
            return self._distributed(self._rows[:, :6], self._elements.load[:, :, None] * vector(force, 2, "force"))
        points, _, lengths, shares = self._elements.sides(0.0)  # each point twice
        values = 0.5 * finite(force(points.T), "force").T * lengths[:, None]
        return self._distributed(np.tile(self._rows[:, :6], (4, 1)), shares[:, :, None] * values[:, None])

    def contact(self, basis: CellBasis, law: InterfaceLaw, boundaries: str | Sequence[str] | None = None,
                **options: Any) -> dict[str, ContactPair]:
        """Return contact pairs of the sides, half a thickness off the axis, by the names of the boundaries there.

        Parameters
        ----------
        basis, law
            Basis and law of :class:`~skfem_contact.ContactPair`.
        boundaries
            Boundaries that touch the beam, each one side; by default all that lie there.
        options
            Further arguments of the pairs; ``quadrature=2`` unless it is given.

        Raises
        ------
        ValueError
            A bonded beam; a thick beam with hinges; boundaries that do not lie on a side, that share facets, or none.
        """
        if self._shared is not None:
            raise ValueError("a bonded beam has no contact: give it nodes of its own, bonded=False")
        if self.thickness and self._rotation.n > len(self.points):
            raise ValueError("contact of a beam with hinges is on its axis: thickness=0")
        found = touching(basis.mesh, boundaries, self._elements.points, 0.5 * self.thickness)
        options = {"quadrature": 2, **options}
        return {name: ContactPair(basis, name, self._side(side), law, **options) for name, side in found.items()}

    def _side(self, sign: int) -> Surface:
        """Return the left side, 1, or the right side, -1."""
        n = len(self.points)
        return Surface.from_cells(self.points, (self._displacement, np.arange(2 * n).reshape(n, 2)),
                                  self.cells if sign > 0 else self.cells[:, [1, 0, 2]],
                                  f"{'left' if sign > 0 else 'right'} side of a beam",
                                  rotations=(self._rotation, np.arange(n)), thickness=self.thickness)
