"""Beams as a form: stiffness, plastic hinges, weight, loads, section forces and sides in
contact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import override

from ..checks import finite, format_point, vector
from ..errors import Remark
from ..forms.base import Form, Response
from ..layout import Field
from ..sparse import Gathering
from .element import BeamElements, Flow, Hinges, ShellElements, SpaceElements
from .joints import Taken, frame_of, loose_dof, of_a_line, rotations_of, taken_by, turning_ends
from .lines import nodes_of
from .nodes import BeamNodes, check_values, stiffest

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

    Small displacements and rotations. The beam has nodes of its own, or those of a line of the
    mesh, to which it is bonded. Section forces are those on the nodes, see
    :meth:`~skfem_contact.results.StageResult.section_forces`.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh; None where there are beams only.
    line
        Coordinates of the nodes, (n, 2), in space (n, 3); or the name of a line of facets, on the
        boundary or inside, of a plane mesh with elements of second order. A named line begins at
        its upper end, a level one at its left end, and goes clockwise where it is closed.
    EI, EA, GA
        Stiffness against bending, stretching and shear. By default ``GA = EA / 3``, that of a
        rectangle with nu = 0.25. In plane strain a wall of thickness t has ``EI = E t**3 / 12 / (1
        - nu**2)``.
    spacing
        Distance of the members of a row: the stiffnesses, strengths and weights are those of one of
        them. By default they are those per unit of length out of the plane. Section forces are per
        unit of length.
    cells
        Nodes of the elements, (m, 2): start and end; or (m, 3): start, end and middle, which lies
        on the curve. By default the nodes are the ends of a chain of straight elements.
    hinges
        Coordinates of nodes, (k, dim) or (dim,), that transfer no moment between their elements,
        nor to other beams; in space no torque either.
    Mp, Np
        Plastic moment and plastic normal force: hinges flow at nodes where ``|M| / Mp + |N| / Np``
        reaches 1.
    unit_weight
        Weight per length of the beam.
    bonded
        False if a beam along a named line has nodes of its own there. True if a beam along given
        points is bonded to the ground: the points are vertices of the mesh, and the edges of the
        mesh along this polyline the elements, in the plane or in space.
    joined_to
        Beams whose nodes this beam shares where both have one: rigidly, or by a hinge where
        `hinges` names the node.
    thickness
        Distance of the two sides, for contact.
    coordinates, nu
        ``"axisymmetric"`` for a shell of revolution about x = 0 with this Poisson's ratio:
        stiffnesses and section forces are per width, with ``EI = E t**3 / 12 / (1 - nu**2)`` and
        ``EA = E t / (1 - nu**2)``. Forces on nodes are per radian.
    GJ
        Stiffness against twist of a beam in space, whose line has points (n, 3) and whose section
        is round; by default ``0.8 * EI``, for nu = 0.25.

    Raises
    ------
    ValueError
        Stiffness or strength that is not positive, a line that is no chain or off the mesh,
        elements without length, a hinge where no elements meet, hinges that make a mechanism, no
        node in common with a beam it is joined to.

    Notes
    -----
    A beam bonded to a line of a solid in space moves the more the finer the mesh, without bounds. A
    warning says how much more the next mesh gives. Piles need :class:`Embedded` with a radius.

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
    _brought = (
        "parameters",
        "spacing",
        "_elements",
        "_root",
        "_stiffness",
        "_section",
        "_hinges",
        "_weight",
        "_EA",
        "_shear",
        "_warm",
    )
    _warm: ndarray | float = 0.0
    _frame: Sequence[Beam] = ()
    _touched: Sequence[Field] = ()
    _ground: float | None = None
    _parts: Sequence[tuple[ndarray, ndarray]] = ()
    _stiff: ndarray
    _where: Mapping[int, ndarray]

    def __init__(
        self,
        basis: CellBasis | None,
        line: Any,
        EI: float,
        EA: float,
        GA: float | None = None,
        *,
        spacing: float | None = None,
        cells: ArrayLike | None = None,
        hinges: ArrayLike = (),
        Mp: float = np.inf,
        Np: float = np.inf,
        unit_weight: float = 0.0,
        bonded: bool | None = None,
        joined_to: Beam | Sequence[Beam] = (),
        thickness: float = 0.0,
        coordinates: Literal["plane", "axisymmetric"] = "plane",
        nu: float = 0.0,
        GJ: float | None = None,
    ) -> None:
        GA, GJ = EA / 3.0 if GA is None else GA, 0.8 * EI if GJ is None else GJ
        check_values(
            Mp, Np, unit_weight, thickness, EI=EI, EA=EA, GA=GA, GJ=GJ, spacing=spacing or 1.0
        )
        self.parameters = {
            "EI": EI,
            "EA": EA,
            "GA": GA,
            "Mp": Mp,
            "Np": Np,
            "spacing": spacing,
            "unit_weight": unit_weight,
            "thickness": thickness,
        }
        self._shared, self.points, self.cells = nodes_of(basis, line, cells, bonded)
        self.coordinates, corners, shell = (
            coordinates,
            self.points[self.cells],
            coordinates == "axisymmetric",
        )
        if (shell and (not -1.0 < nu <= 0.5 or spacing is not None or np.isfinite(Mp))) or (
            not shell and nu
        ):
            raise ValueError(
                f"nu={nu!r} is for a shell of revolution, -1 < nu <= 0.5; it has no spacing and no "
                f"Mp"
            )
        if space := corners.shape[2] == 3:
            self.coordinates = "space"
            if shell or spacing is not None or np.isfinite(Mp) or thickness:
                raise ValueError("a beam in space has no spacing, Mp or thickness, and is no shell")
        self._elements = (
            ShellElements.about_axis(corners, nu)
            if shell
            else (SpaceElements if space else BeamElements).of(corners)
        )
        given = np.atleast_2d(finite(hinges, "hinges"))
        if given.size and (given.ndim, given.shape[1]) != (2, self.points.shape[1]):
            raise ValueError(f"hinges of a beam must be points of its line, not {hinges!r}")
        pins = np.array([self.node(at) for at in given if given.size], int)
        others = (joined_to,) if isinstance(joined_to, BeamNodes) else tuple(joined_to)
        moves, turned, joined = taken_by(self.points, self._shared is not None, pins, others)
        self.thickness, self.spacing, self._weight = (
            thickness,
            spacing or 1.0,
            unit_weight / (spacing or 1.0),
        )
        self._lay_out(rotations_of(self.points, self.cells, pins, joined), moves, turned)
        self._root = self._elements.root(*(value / self.spacing for value in (EA, GA, EI, GJ)))
        self._stiffness = self._root @ self._root.transpose(0, 2, 1)
        self._section = self._elements.section(self._root, EA / self.spacing, EI / self.spacing)
        self._hinges = (
            Hinges(
                self._section,
                self._root,
                self.cells[:, :2],
                joined,
                Mp / self.spacing,
                Np / self.spacing,
            )
            if np.isfinite(Mp)
            else None
        )
        self._wet, self._EA, self._shear = False, EA, GA / EI

    def _lay_out(self, turn: ndarray, moved: Taken, turned: Taken) -> None:
        """Number the dofs: displacements, then rotations, as if the beam were alone."""
        dim, turns = self.points.shape[1], 1 if self.points.shape[1] == 2 else 3
        n, n_turns = dim * len(self.points), turns * (int(turn.max()) + 1)
        at = np.zeros((int(turn.max()) + 1, dim))
        at[turn] = self.points[self.cells]
        scale = 1.0 / float(np.median(self._elements.length))
        self._displacement = Field(
            "displacement of a beam", np.repeat(self.points, dim, axis=0).T, taken=moved
        )
        self._rotation = Field(
            "rotation of a beam", np.repeat(at, turns, axis=0).T, "rotation", scale, taken=turned
        )
        self.fields = (
            (self._rotation,) if self._shared is not None else (self._displacement, self._rotation)
        )
        u, theta = (
            k * cells[:, :, None] + np.arange(k) for k, cells in ((dim, self.cells), (turns, turn))
        )
        self._rows = np.hstack(
            (u.reshape(len(self.cells), -1), n + theta.reshape(len(self.cells), -1))
        )
        self._middle = np.append(
            np.arange(2 * dim, 3 * dim), 3 * dim + np.arange(2 * turns, 3 * turns)
        )
        self._size, self._gathering = n + n_turns, Gathering(n + n_turns)

    def heated(self, strain: float, curvature: float = 0.0) -> Beam:
        """Return the beam with a strain and a curvature that it has free of force at a temperature.

        They count from the beam as built. An elastic one between fixed ends has N = -EA strain and
        M = -EI curvature.

        Parameters
        ----------
        strain
            Strain of the axis: coefficient of expansion times the mean change of temperature.
        curvature
            Curvature in the plane, positive where the left side becomes longer: coefficient of
            expansion times the change of temperature on the left less that on the right, over the
            thickness.

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
        wanted[:: len(wanted) // 2] = strain
        if self.coordinates == "axisymmetric" or (curvature and self.coordinates == "space"):
            raise ValueError(
                "a shell of revolution has no free strain, and a beam in space no free curvature"
            )
        if curvature:
            wanted[2 :: len(wanted) // 2] = -curvature
        new = copy(self)
        new._warm = np.linalg.pinv(self._elements.strains) @ wanted
        return new

    def __repr__(self) -> str:
        return f"<Beam {len(self.cells)} elements, {self._elements.length.sum():.4g} long>"

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Beam:
        new = copy(self)
        new._dofs = self._numbers(numbers)
        new.acts_on, new.changing = new._dofs, new._dofs if self._hinges else np.zeros(0, int)
        frame = {beam: beam._numbers(numbers) for beam in self._frame}
        new._parts = [(beam._elements.strains, dofs[beam._rows]) for beam, dofs in frame.items()]
        new._stiff = np.concatenate(
            [
                np.zeros(0, int),
                *(numbers[field] for field in self._touched),
                *(beam._shared.ravel() for beam in frame if beam._shared is not None),
            ]
        )
        new._where = {
            dof: x
            for beam, dofs in frame.items()
            for dof, x in zip(
                dofs.tolist(),
                np.hstack((beam._displacement.coordinates, beam._rotation.coordinates)).T,
                strict=True,
            )
        }
        return new

    def _numbers(self, numbers: Mapping[Field, ndarray]) -> ndarray:
        """Return the dofs of the nodes: displacements, then rotations."""
        own = numbers[self._displacement] if self._shared is None else self._shared.ravel()
        return np.concatenate((own, numbers[self._rotation]))

    @override
    def completed(self, forms: Mapping[str, Form]) -> Beam:
        new = copy(self)
        new._frame, new._touched = frame_of(self, forms)
        new.borrowed = tuple(
            field for beam in new._frame for field in beam.fields if beam is not self
        )
        ground = (
            stiffest(forms) if self._shared is not None and self.coordinates == "space" else None
        )
        new._ground = None if ground is None else float(ground[-1, -1])
        new._wet = any(
            form.law is not None and self._displacement in form.borrowed for form in forms.values()
        )
        return new

    @override
    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Sequence[Any]:
        loose = (
            loose_dof(self._parts, np.concatenate((fixed, held, self._stiff)))
            if self._parts
            else None
        )
        if loose is not None:
            raise ValueError(
                "the beam is a mechanism: its supports and hinges leave a motion without force, "
                "the "
                f"largest at {format_point(self._where[loose])}"
            )
        return [*self._elements.remarks(self._shear), *turning_ends(self, fixed)]

    @override
    def initial_state(self, x: ndarray | None = None) -> BeamState:
        zero = np.zeros(self._rows.shape)
        return BeamState(zero, zero if x is None else self._own(x)[self._rows])

    @override
    def assemble(self, x: ndarray, state: BeamState) -> Response:
        u = self._own(x)[self._rows]
        moved = u - state.free - self._warm
        lost = _ROUND_OFF * np.einsum(
            "mij,mj->mi", np.abs(self._stiffness), np.abs(u) + np.abs(state.free)
        )
        moved = moved - np.einsum(
            "mij,mj->mi", self._elements.rigid, moved[:, self._middle]
        )  # of large rigid motions
        force = np.einsum("mij,mj->mi", self._stiffness, moved)
        free, flows = state.free, list(self._hinges.flows(force)) if self._hinges else []
        if flows:
            free = free.copy()
            for e, flow, _ in flows:
                free[e] += flow
                force[e] -= self._stiffness[e] @ flow
        total, measure, lost = (
            self._gathering.force(self._rows, f) for f in (force, np.abs(force), lost)
        )
        active = b"".join(
            bytes([*e.to_bytes(4, "big"), *(faces != 0.0).sum(axis=0)]) for e, _, faces in flows
        )
        return Response(
            total,
            lambda: BeamState(force, free),
            lambda: self._tangent(flows),
            None,
            lost,
            active,
            measure,
            dofs=self._dofs,
        )

    def _tangent(self, flows: list[Flow]) -> csr_matrix:
        blocks = self._hinges.tangent(self._stiffness, flows) if self._hinges else self._stiffness
        return self._gathering.matrix(self._rows, blocks)

    def _own(self, x: ndarray) -> ndarray:
        return x if self._dofs is None else x[self._dofs]

    @override
    def stretched(self, state: BeamState) -> ndarray:
        inverse = np.linalg.pinv(
            self._root, rcond=1e-12
        )  # rigid motions have 1e-16, bending beside stretching 1e-3
        return np.asarray(np.einsum("mqj,mqk,mk->mj", inverse, inverse, state.force))

    @override
    def rebased(self, x: ndarray, state: BeamState) -> BeamState:
        return BeamState(state.force, state.free - self._own(x)[self._rows])

    @override
    def yielding(self, before: BeamState, after: BeamState) -> tuple[int, int]:
        return int((before.free != after.free).any(axis=1).sum()), len(self.cells)

    @override
    def remarks(self, x: ndarray, state: BeamState) -> Iterable[Remark]:
        moved, G = self._own(x)[self._rows[:, :9]], self._ground
        return (
            ()
            if G is None
            else of_a_line(self._elements.length, self.cells, state.force[:, :9], moved, G)
        )

    @override
    def summary(self, state: BeamState) -> str:
        N, _, M = self.line_forces(state)[3:6]
        M = np.linalg.norm(M, axis=1) if M.ndim == 2 else M
        return f"N {N.min():.4g} to {N.max():.4g}, M {M.min():.4g} to {M.max():.4g}"

    @override
    def own_weight(self, acceleration: ndarray) -> ndarray | None:
        return self.line_load(self._weight * acceleration) if self._weight else None

    @override
    def water_load(
        self, pressure: Callable[[ndarray, ndarray, ndarray], ndarray]
    ) -> ndarray | None:
        if not self._wet:  # no side touches the ground
            return None
        points, normals, lengths, shares = self._elements.sides(0.5 * self.thickness)
        force = -(pressure(points, normals, lengths) * lengths)[:, None] * normals
        return self._distributed(shares[:, :, None] * force[:, None])

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
        return (
            position,
            x,
            y,
            N,
            forces[:, :3] - N[:, None] * t,
            forces[:, 3:] - T[:, None] * t,
            z[0],
            T,
            t,
        )

    @override
    def line_points(self, x: ndarray, state: BeamState) -> tuple[ndarray, dict[str, ndarray]]:
        dim, values = self.points.shape[1], {}
        for key, ends in zip("NVM", self.line_forces(state)[3:6], strict=True):
            both = ends.reshape(len(self.cells), 2, -1)
            values[key] = np.concatenate((both, both.mean(axis=1, keepdims=True)), axis=1).reshape(
                -1, *ends.shape[1:]
            )
        values["displacement"] = self._own(x)[self._rows[:, : 3 * dim]].reshape(-1, dim)
        return self._elements.points.reshape(-1, dim), values

    def line_load(self, force: ArrayLike | Callable[[ndarray], ArrayLike]) -> ndarray:
        """Return the load vector of a force per length, (dim,), on all elements, of a model's beam.

        It may be a function of coordinates (dim, n) that returns (dim, n). On a shell it is a force
        per area.
        """
        points, lengths, shares = self._elements.gauss()
        values = (
            finite(force(points.T), "force").T
            if callable(force)
            else vector(force, points.shape[1], "force")
        )
        return self._distributed(shares[:, :, None] * (values * lengths[:, None])[:, None])
