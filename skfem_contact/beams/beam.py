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
from ..forms.base import Form, Response
from ..layout import Field
from ..sparse import Gathering
from .element import BeamElements, Flow, Hinges, ShellElements, SpaceElements, loose_node
from .lines import nodes_of
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
    """Beams: a wall, a lining or a frame of Timoshenko elements, elastic or with plastic hinges.

    Small displacements and rotations. The beam has nodes of its own, or those of a line of the mesh, to which it is
    bonded. Section forces are those on the nodes, see :meth:`~skfem_contact.results.StageResult.section_forces`.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh; None where there are beams only.
    line
        Coordinates of the nodes, (n, 2), in space (n, 3); or the name of a line of facets, on the boundary or inside,
        of a plane mesh with elements of second order. A named line begins at its upper end, a level one at its left
        end, and goes clockwise where it is closed.
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
    GJ
        Stiffness against twist of a beam in space, whose line has points (n, 3) and whose section is round; by default
        ``0.8 * EI``, for nu = 0.25.

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
    _warm: ndarray | float = 0.0

    def __init__(self, basis: CellBasis | None, line: Any, EI: float, EA: float, GA: float | None = None, *,
                 spacing: float | None = None, cells: ArrayLike | None = None, hinges: ArrayLike = (),
                 Mp: float = np.inf, Np: float = np.inf, unit_weight: float = 0.0, bonded: bool = True,
                 thickness: float = 0.0, coordinates: Literal["plane", "axisymmetric"] = "plane",
                 nu: float = 0.0, GJ: float | None = None) -> None:
        GA, GJ = EA / 3.0 if GA is None else GA, 0.8 * EI if GJ is None else GJ
        for name, value in {"EI": EI, "EA": EA, "GA": GA, "GJ": GJ, "Mp": Mp, "Np": Np,
                            "spacing": spacing or 1.0}.items():
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
        if space := corners.shape[2] == 3:
            self.coordinates = "space"
            if shell or spacing is not None or np.isfinite(Mp) or np.size(hinges) or thickness:
                raise ValueError("a beam in space has no spacing, hinges, Mp or thickness, and is no shell")
        self._elements = ShellElements.about_axis(corners, nu) if shell else \
            (SpaceElements if space else BeamElements).of(corners)
        self._shared = shared if bonded else None
        given = np.atleast_2d(finite(hinges, "hinges"))
        if given.size and (given.ndim, given.shape[1]) != (2, 2):
            raise ValueError(f"hinges of a beam must be points (x, y), not {hinges!r}")
        turn = self._turns(given.reshape(-1, 2))
        self.thickness, self.spacing = thickness, spacing or 1.0
        self._weight = unit_weight / self.spacing
        self._lay_out(turn)
        self._root = self._elements.root(*(value / self.spacing for value in (EA, GA, EI, GJ)))
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
        dim, turns = self.points.shape[1], 1 if self.points.shape[1] == 2 else 3
        n, n_turns = dim * len(self.points), turns * (int(turn.max()) + 1)
        at = np.zeros((int(turn.max()) + 1, dim))
        at[turn] = self.points[self.cells]
        scale = 1.0 / float(np.median(self._elements.length))
        self._displacement = Field("displacement of a beam", np.repeat(self.points, dim, axis=0).T)
        self._rotation = Field("rotation of a beam", np.repeat(at, turns, axis=0).T, "rotation", scale)
        self.fields = (self._rotation,) if self._shared is not None else (self._displacement, self._rotation)
        moves, turned = (k * cells[:, :, None] + np.arange(k) for k, cells in ((dim, self.cells), (turns, turn)))
        self._rows = np.hstack((moves.reshape(len(self.cells), -1), n + turned.reshape(len(self.cells), -1)))
        self._middle = np.append(np.arange(2 * dim, 3 * dim), 3 * dim + np.arange(2 * turns, 3 * turns))
        self._size, self._gathering = n + n_turns, Gathering(n + n_turns)

    def heated(self, strain: float, curvature: float = 0.0) -> Beam:
        """Return the beam with a strain and a curvature that it has free of force at a temperature.

        They count from the beam as it was built. Where nothing yields, a beam whose ends are held has a normal force
        ``-EA * strain`` and a moment ``-EI * curvature``.

        Parameters
        ----------
        strain
            Strain of the axis: coefficient of expansion times the mean change of temperature.
        curvature
            Curvature in the plane, positive where the left side becomes longer: coefficient of expansion times the
            change of temperature on the left less that on the right, over the thickness.

        Raises
        ------
        ValueError
            A shell of revolution; a curvature in space.

        Examples
        --------
        A strut of concrete between rigid walls becomes 20 degrees warmer:

        >>> import skfem_contact as sc
        >>> strut = sc.Beam(None, [[0., 0.], [5., 0.]], EI=1e4, EA=1e6)
        >>> model = sc.Model({"strut": strut}, [*strut.dofs((0., 0.)), *strut.dofs((5., 0.))])
        >>> summer = sc.Stage("summer", change={"strut": strut.heated(1e-5 * 20.)})
        >>> model.run([summer])["summer"].section_forces("strut").N.round(9).tolist()
        [-200.0, -200.0]
        """
        wanted = np.zeros(self._elements.strains.shape[1])
        wanted[::len(wanted) // 2] = strain
        if self.coordinates == "axisymmetric" or (curvature and self.coordinates == "space"):
            raise ValueError("a shell of revolution has no free strain, and a beam in space no free curvature")
        if curvature:
            wanted[2::len(wanted) // 2] = -curvature
        new = copy(self)
        new._warm = np.linalg.pinv(self._elements.strains) @ wanted
        return new

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
        moved = u - state.free - self._warm
        lost = _ROUND_OFF * np.einsum("mij,mj->mi", np.abs(self._stiffness), np.abs(u) + np.abs(state.free))
        moved = moved - np.einsum("mij,mj->mi", self._elements.rigid, moved[:, self._middle])  # of large rigid motions
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
        N, _, M = self.line_forces(state)[3:6]
        M = np.linalg.norm(M, axis=1) if M.ndim == 2 else M
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
        return self._distributed(shares[:, :, None] * force[:, None])

    def _distributed(self, forces: ndarray) -> ndarray:
        """Return the load vector of forces (n, 3, dim) on the nodes of all elements in turn."""
        load, rows = np.zeros(self._of_model().max() + 1), self._rows[:, :forces[0].size]
        np.add.at(load, self._of_model()[np.tile(rows, (len(forces) // len(rows), 1))], forces.reshape(len(forces), -1))
        return load

    @override
    def line_forces(self, state: BeamState) -> tuple[Any, ...]:
        ends = np.cumsum(self._elements.length)
        position = np.column_stack((np.append(0.0, ends[:-1]), ends)).ravel()
        x, y, *z = self.points[self.cells[:, :2].ravel()].T
        forces = np.einsum("merj,mj->mer", self._section, state.force).reshape(len(position), -1)
        if not z:
            N, V, M, *hoop = forces.T
            return (position, x, y, N, V, M, *((None, None, None, *hoop) if hoop else ()))
        t = self._elements.tangents().reshape(-1, 3)
        N, T = (np.einsum("nc,nc->n", part, t) for part in (forces[:, :3], forces[:, 3:]))
        return position, x, y, N, forces[:, :3] - N[:, None] * t, forces[:, 3:] - T[:, None] * t, z[0], T, t

    @override
    def line_points(self, x: ndarray, state: BeamState) -> tuple[ndarray, dict[str, ndarray]]:
        dim, values = self.points.shape[1], {}
        for key, ends in zip("NVM", self.line_forces(state)[3:6], strict=True):
            both = ends.reshape(len(self.cells), 2, -1)
            values[key] = np.concatenate((both, both.mean(axis=1, keepdims=True)), axis=1).reshape(-1, *ends.shape[1:])
        values["displacement"] = self._own(x)[self._rows[:, :3 * dim]].reshape(-1, dim)
        return self._elements.points.reshape(-1, dim), values

    def line_load(self, force: ArrayLike | Callable[[ndarray], ArrayLike]) -> ndarray:
        """Return the load vector of a force per length, (dim,), on all elements, of a model's beam.

        It may be a function of coordinates (dim, n) that returns (dim, n). On a shell it is a force per area.
        """
        points, lengths, shares = self._elements.gauss()
        values = finite(force(points.T), "force").T if callable(force) else vector(force, points.shape[1], "force")
        return self._distributed(shares[:, :, None] * (values * lengths[:, None])[:, None])
