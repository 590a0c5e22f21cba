"""Beams as a form: stiffness, plastic hinges, weight, loads, section forces and contact."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.sparse import csr_matrix
from skfem import CellBasis
from typing_extensions import override

from ..arrays import max_abs, row_norms
from ..checks import finite, format_point, vector
from ..errors import Remark
from ..forms.base import Form, Forms, Kinematics, Outputs, Response, counted
from ..forms.roles import Slender, Touching, having
from ..layout import Field
from ..sparse import Gathering, constant
from .corotation import Turned
from .element import BeamElements, Flow, Hinges, ShellElements, SpaceElements
from .joints import (
    Taken,
    frame_of,
    loose_motion,
    of_a_line,
    rotations_of,
    swinging,
    taken_by,
    taken_elsewhere,
    turning_ends,
)
from .joints import (
    joined as joined_forms,
)
from .lines import nodes_of
from .nodes import BeamNodes, check_values, stiffest
from .thrust import counts, lost_stiffness

#: Round-off of a displacement or a rotation, as a share of it.
_ROUND_OFF = 2e-16
#: Displacements over rotations, in a motion without strain, up to which a beam only spins: they are
#: 1e-13 for piles of 1 to 60 m, and the length of the beam where it moves as a whole.
_SPIN = 1e-6


@dataclass(frozen=True)
class BeamState:
    """State of beams: arrays (m, 9) of the dofs of m elements.

    Attributes
    ----------
    force
        Forces and moments on the nodes.
    free
        Displacements and rotations without force: where the beam was built, and plastic flow.
    """

    force: ndarray
    free: ndarray


class Beam(BeamNodes, Slender):
    """Beams: a wall, a lining or a frame of Timoshenko elements, elastic or with plastic hinges.

    Small displacements and rotations by default, without second-order moments: a stage warns of
    thrusts beyond a tenth of the load at which the structure buckles. The beam has nodes of its
    own, or is bonded to the nodes of a line of the mesh. Section forces act on the nodes, see
    :meth:`~skfem_contact.results.StageResult.section_forces`; with finite kinematics their axes
    have turned with the elements.

    Parameters
    ----------
    basis
        ``Basis`` of the mesh; None for beams alone.
    line
        Coordinates of the nodes, (n, 2), in space (n, 3); or the name of a line of facets, on the
        boundary or inside, of a plane mesh with elements of second order. A named line begins at
        its upper end, a level one at its left end, and goes clockwise where it is closed.
    EI, EA, GA
        Stiffness against bending, stretching and shear. By default ``GA = EA / 3``, as for a
        rectangle with nu = 0.25. In plane strain a wall of thickness t has ``EI = E t**3 / 12 / (1
        - nu**2)``.
    spacing
        Distance of the members of a row: stiffnesses, strengths and weights belong to one member.
        By default they are per unit of length out of the plane, as section forces always are.
    cells
        Nodes of the elements, (m, 2): start and end; or (m, 3): start, end and middle, which lies
        on the curve. By default the nodes are the ends of a chain of straight elements.
    hinges
        Coordinates of nodes, (k, dim) or (dim,), that transfer no moment between their elements,
        nor to other beams; in space no torque either. :class:`RotationSpring` resists there.
    Mp, Np
        Plastic moment and plastic normal force: hinges flow at nodes where ``|M| / Mp + |N| / Np``
        reaches 1.
    unit_weight
        Weight per length of the beam.
    bonded
        False if a beam along a named line has nodes of its own. True if a beam along given
        points is bonded to the ground: the points are vertices of the mesh, and the edges of the
        mesh along this polyline the elements, in the plane or in space.
    joined_to
        Beams and shells whose nodes this beam shares where both have one: rigidly, or by a hinge
        where `hinges` names the node.
    thickness
        Distance of the two sides, for contact.
    coordinates, nu
        ``"axisymmetric"`` for a shell of revolution about x = 0 with this Poisson's ratio:
        stiffnesses and section forces are per width, with ``EI = E t**3 / 12 / (1 - nu**2)`` and
        ``EA = E t / (1 - nu**2)``. Forces on nodes are per radian.
    GJ
        Stiffness against twist of a beam in space, whose line has points (n, 3) and whose section
        is round; by default ``0.8 * EI``, for nu = 0.25.
    kinematics
        ``"finite"`` for displacements and rotations of any size, with second-order moments and
        buckling: elements in the plane turn with their ends, strains stay small. All forms of the
        model have the same kinematics.

    Raises
    ------
    ValueError
        Stiffness or strength that is not positive, a line that is no chain or off the mesh,
        elements without length, a hinge where no elements meet, hinges that make a mechanism, no
        node in common with a beam it is joined to; finite kinematics of a shell or in space.

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
        "_elastic",
        "_section",
        "_hinges",
        "_weight",
        "_shear",
        "_warm",
    )
    _warm: ndarray | float = 0.0
    _frame: Sequence[Beam] = ()
    _touched: Sequence[Field] = ()
    _ground: float | None = None
    _wet = False
    _parts: Sequence[tuple[ndarray, ndarray]] = ()
    _stiff: ndarray
    _moves: ndarray
    _where: Mapping[int, tuple[ndarray, str]]

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
        joined_to: Form | Sequence[Form] = (),
        thickness: float = 0.0,
        coordinates: Literal["plane", "axisymmetric"] = "plane",
        nu: float = 0.0,
        GJ: float | None = None,
        kinematics: Kinematics = "small",
    ) -> None:
        # With nu = .25: 5/6 G A of a rectangle, and 2 G I of a circle.
        if GA is None:
            GA = EA / 3.0
        if GJ is None:
            GJ = 0.8 * EI
        distance = 1.0 if spacing is None else spacing
        check_values(
            Mp,
            Np,
            unit_weight,
            thickness,
            EI=EI,
            EA=EA,
            GA=GA,
            GJ=GJ,
            spacing=distance,
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

        # Find the nodes and the elements
        self.kinematics = kinematics
        self.shared, self.points, self.cells = nodes_of(basis, line, cells, bonded)
        if self.dim == 3:
            self.coordinates = "space"
        else:
            self.coordinates = coordinates
        corners = self.points[self.cells]
        shell = coordinates == "axisymmetric"
        self._elements = _elements_of(corners, shell, nu, spacing, Mp, thickness)
        _check_kinematics(kinematics, self.coordinates)

        # Number the dofs, some of which are dofs of other beams
        given = np.atleast_2d(finite(hinges, "hinges"))
        if given.size and (given.ndim, given.shape[1]) != (2, self.dim):
            raise ValueError(f"hinges of a beam must be points of its line, not {hinges!r}")
        pins = np.array([self.node(point) for point in given if given.size], int)
        moves, turned, joined = taken_by(
            self.points, self.shared is not None, pins, joined_forms(joined_to, self.kind)
        )
        self._lay_out(rotations_of(self.points, self.cells, pins, joined), moves, turned)

        # Find stiffness and strength of a row per unit of length
        self.thickness = thickness
        self.spacing = distance
        self._weight = unit_weight / self.spacing
        self._root = self._elements.root(*(value / self.spacing for value in (EA, GA, EI, GJ)))
        self._stiffness = self._root @ self._root.transpose(0, 2, 1)
        self._section = self._elements.section(self._root, EA / self.spacing, EI / self.spacing)
        self._shear = GA / EI
        self._hinges = None
        if np.isfinite(Mp):
            self._hinges = Hinges(
                self._section,
                self._root,
                nodes=self.cells[:, :2],
                joined=joined,
                Mp=Mp / self.spacing,
                Np=Np / self.spacing,
            )

    def _lay_out(self, turn: ndarray, moved: Taken, turned: Taken) -> None:
        """Give numbers to the dofs of the beam alone: displacements, then rotations."""
        # Fields of displacements and of rotations, (m, 3) by element
        dim = self.dim
        turns = self.turns
        n_turns = int(turn.max()) + 1
        places = np.zeros((n_turns, dim))
        places[turn] = self.points[self.cells]
        self.displacement = Field(
            "displacement of a beam", np.repeat(self.points, dim, axis=0).T, taken=moved
        )
        self.rotation = Field(
            "rotation of a beam",
            np.repeat(places, turns, axis=0).T,
            kind="rotation",
            scale=1.0 / float(np.median(self._elements.length)),
            taken=turned,
        )
        self.fields = (self.displacement, self.rotation)
        if self.shared is not None:
            self.fields = (self.rotation,)

        # Dofs of the elements, and of their middle nodes among them
        n = dim * len(self.points)
        m = len(self.cells)
        u = dim * self.cells[:, :, None] + np.arange(dim)
        theta = n + turns * turn[:, :, None] + np.arange(turns)
        self._rows = np.hstack((u.reshape(m, -1), theta.reshape(m, -1)))
        self._middle = np.append(
            np.arange(2 * dim, 3 * dim), 3 * dim + np.arange(2 * turns, 3 * turns)
        )
        self._gathering = Gathering(n + turns * n_turns)

    def heated(self, strain: float, curvature: float = 0.0) -> Beam:
        """Return the beam with a strain and a curvature by temperature, which are free of force.

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
        if self.coordinates == "axisymmetric" or (curvature and self.coordinates == "space"):
            raise ValueError(
                "a shell of revolution has no free strain, and a beam in space no free curvature"
            )
        # Find the displacements of each element with the strains (eps, gamma, kappa, ...)
        wanted = np.zeros((2, self._elements.strains.shape[1] // 2))
        wanted[:, 0] = strain
        if curvature:
            wanted[:, 2] = -curvature
        new = copy(self)
        new._warm = np.linalg.pinv(self._elements.strains) @ wanted.ravel()
        new.parameters = {**self.parameters, "free_strain": strain, "free_curvature": curvature}
        return new

    def __repr__(self) -> str:
        return f"<Beam {len(self.cells)} elements, {self._elements.length.sum():.4g} long>"

    @override
    def numbered(self, numbers: Mapping[Field, ndarray]) -> Beam:
        new = copy(self)
        new._dofs = new.acts_on = new.changing = self._numbers(numbers)
        if not self._hinges and not self._finite:
            new.changing = np.zeros(0, int)

        # Strains, stiff dofs and coordinates of the frame, for the search of mechanisms
        stiff = [np.zeros(0, int), *(numbers[field] for field in self._touched)]
        new._parts = []
        new._where = {}
        moves = [np.zeros(0, int)]
        dim = self.dim
        for beam in self._frame:
            dofs = beam._numbers(numbers)
            new._parts.append((beam._elements.strains, dofs[beam._rows]))
            x = np.hstack((beam.displacement.coordinates, beam.rotation.coordinates)).T
            names = self._names[:dim] * len(beam.points)
            names += self._names[dim:] * (beam.rotation.n // beam.turns)
            new._where.update(zip(dofs.tolist(), zip(x, names, strict=True), strict=True))
            moves.append(dofs[: beam.displacement.n])
            if beam.shared is not None:
                stiff.append(beam.shared.ravel())
            stiff += [numbers[field][taken] for field, taken in taken_elsewhere(beam, self._frame)]
        new._stiff = np.concatenate(stiff)
        new._moves = np.concatenate(moves)
        return new

    @override
    def completed(self, forms: Forms) -> Beam:
        # Find joined beams, and whether contact is on a side
        new = copy(self)
        new._frame, new._touched = frame_of(self, forms)
        fields = chain.from_iterable(beam.fields for beam in new._frame if beam is not self)
        new.borrowed = tuple(fields)
        new._wet = False
        for pair in having(forms, Touching).values():
            if self.displacement in pair.borrowed:
                new._wet = True

        # Find the shear modulus of ground to which it is bonded in space
        new._ground = None
        if self.shared is not None and self.coordinates == "space":
            C = stiffest(forms)
            if C is not None:
                new._ground = float(C[-1, -1])
        return new

    @property
    @override
    def strains(self) -> tuple[ndarray, ndarray]:
        assert self._dofs is not None  # a beam of a model
        return self._elements.strains, self._dofs[self._rows]

    @override
    def check_stage(self, fixed: ndarray, held: ndarray, duration: float) -> Sequence[Any]:
        remarks: list[Remark] = self._elements.remarks(self._shear)
        if not self._parts:
            return remarks
        # Hinges and supports may leave a motion without force.
        loose = loose_motion(self._parts, np.concatenate((fixed, held, self._stiff)))
        if loose is not None:
            raise ValueError(self._mechanism(*loose))
        if self.shared is not None and self.coordinates == "plane":
            # An end that supports fix along the beam alone may turn.
            corners = self.points[self.cells]
            met = np.concatenate([dofs[:, 6:8].ravel() for _, dofs in self._parts])
            remarks += turning_ends(corners, self._parts[0][1], met, fixed)
        return remarks

    def _mechanism(self, dofs: ndarray, motion: ndarray) -> str:
        """Return a message on the displacements of some dofs in a motion without force."""
        size = np.abs(motion)
        where, name = self._where[int(dofs[np.argmax(size)])]
        at = format_point(where)
        moved = size[np.isin(dofs, self._moves)]
        if self.coordinates == "space" and max_abs(moved) < _SPIN * max_abs(motion):
            return (
                f"the beam spins about its axis at {at}, which nothing resists: hold one rotation "
                f'of one node, such as *beam.dofs({at}, ["{name}"]), or take a bar between hinges'
            )
        return (
            "the beam is a mechanism: its supports and hinges leave a motion without force, "
            f"the largest at {at}"
        )

    @property
    def _finite(self) -> bool:
        return self.kinematics == "finite"

    @override
    def initial_state(self, x: ndarray | None = None) -> BeamState:
        zero = np.zeros(self._rows.shape)
        if x is None:
            return BeamState(zero, zero)
        u = self._own(x)[self._rows]
        if self._finite:
            u = Turned(self._elements.points, u).motions
        return BeamState(zero, u)

    @override
    def assemble(self, x: ndarray, state: BeamState) -> Response:
        u = self._own(x)[self._rows]
        turned = None
        if self._finite:
            turned = Turned(self._elements.points, u)
            u = turned.motions
        # Elastic forces of the motions less the plastic and the warm ones.
        moved = u - state.free - self._warm
        # Subtract the motion of the middle node as a rigid body, for the digits: it has no force.
        rigid = np.einsum("mij,mj->mi", self._elements.rigid, moved[:, self._middle])
        force = np.einsum("mij,mj->mi", self._stiffness, moved - rigid)
        size = np.abs(u) + np.abs(state.free)
        if turned is not None:
            size += turned.sizes
        round_off = _ROUND_OFF * np.einsum("mij,mj->mi", np.abs(self._stiffness), size)

        # Let hinges flow
        free = state.free
        flows: list[Flow] = []
        if self._hinges:
            flows = list(self._hinges.flows(force))
            free = free.copy()
        active = []
        for e, flow, faces in flows:
            free[e] += flow
            force[e] -= self._stiffness[e] @ flow
            active.append(bytes([*e.to_bytes(4, "big"), *(faces != 0.0).sum(axis=0)]))

        def gathered(forces: ndarray) -> ndarray:
            return self._gathering.force(self._rows, forces)

        on_nodes = force
        if turned is not None:
            on_nodes = turned.force(force)
        return Response(
            gathered(on_nodes),
            lambda: BeamState(force, free),
            lambda: self._tangent(flows, turned, force),
            round_off=gathered(round_off),
            active=b"".join(active),
            measure=gathered(np.abs(on_nodes)),
            dofs=self._dofs,
        )

    def _tangent(self, flows: list[Flow], turned: Turned | None, force: ndarray) -> csr_matrix:
        if not self._hinges and turned is None:
            return self._elastic
        stiffness = self._stiffness
        if self._hinges:
            stiffness = self._hinges.tangent(stiffness, flows)
        if turned is not None:
            stiffness = turned.tangent(stiffness, force)
        return self._gathering.matrix(self._rows, stiffness)

    @cached_property
    def _elastic(self) -> csr_matrix:
        """Elastic stiffness among the dofs of the beam."""
        return constant(self._gathering.matrix(self._rows, self._stiffness))

    @override
    def stretched_by(self, state: BeamState) -> ndarray:
        # Rigid motions have 1e-16 of the largest singular value, bending next to stretching 1e-3
        inverse = np.linalg.pinv(self._root, rcond=1e-12)
        return np.asarray(np.einsum("mqj,mqk,mk->mj", inverse, inverse, state.force))

    @override
    def rebased(self, x: ndarray, state: BeamState) -> BeamState:
        if self._finite:
            raise ValueError("a beam of finite kinematics keeps its displacements")
        return BeamState(state.force, state.free - self._own(x)[self._rows])

    @override
    def outputs(self, x: ndarray, state: BeamState) -> Outputs:
        return Outputs(
            summary=lambda: self._summary(state),
            remarks=lambda: self._remarks(x, state),
            parameters=self.parameters,
            lines=lambda: self._lines(state),
            points=lambda: self._line_points(x, state),
            yielding=lambda before: counted((before.free != state.free).any(axis=1)),
        )

    def _remarks(self, x: ndarray, state: BeamState) -> Iterator[Remark]:
        if self.shared is None:
            return
        moved = self._own(x)[self._rows[:, : 3 * self.dim]]
        length = self._elements.length
        N, V = self._lines(state)[3:5]
        V = row_norms(V.reshape(len(N), -1))
        strain = _ROUND_OFF * max_abs(moved) / length.min()
        round_off = strain * self.parameters["EA"] / self.spacing
        yield from swinging(self.cells, N.reshape(-1, 2), V.reshape(-1, 2), round_off)
        if self._ground is not None:
            yield from of_a_line(length, self.cells, state.force[:, :9], moved, self._ground)

    def _summary(self, state: BeamState) -> str:
        N, _, M = self._lines(state)[3:6]
        if M.ndim == 2:
            M = row_norms(M)
        return f"N {N.min():.4g} to {N.max():.4g}, M {M.min():.4g} to {M.max():.4g}"

    @override
    def lost_by_thrust(self, state: BeamState, share: float) -> tuple[ndarray, csr_matrix] | None:
        if self.coordinates == "axisymmetric" or self._finite:
            return None
        N = self._lines(state)[3].reshape(-1, 2)
        ends = self._elements.points.reshape(-1, self.dim)
        if not counts(ends, N, self.parameters["EI"] / self.spacing, share):
            return None
        lost = lost_stiffness(self._elements, N)
        assert self._dofs is not None  # a beam of a model
        return self._dofs, self._gathering.matrix(self._rows, lost)

    @override
    def own_weight(self, acceleration: ndarray) -> ndarray | None:
        if not self._weight:
            return None
        return self.line_load(self._weight * acceleration)

    @override
    def water_load(
        self, pressure: Callable[[ndarray, ndarray, ndarray], ndarray]
    ) -> ndarray | None:
        if not self._wet:  # no side touches the ground
            return None
        points, normals, lengths, shares = self._elements.sides(0.5 * self.thickness)
        force = -(pressure(points, normals, lengths) * lengths)[:, None] * normals
        return self._distributed(shares[:, :, None] * force[:, None])

    def _lines(self, state: BeamState) -> tuple[Any, ...]:
        # Section forces at start and end of each element in turn
        ends = np.cumsum(self._elements.length)
        position = np.column_stack((np.append(0.0, ends[:-1]), ends)).ravel()
        x, y, *z = self.points[self.cells[:, :2].ravel()].T
        forces = np.einsum("merj,mj->mer", self._section, state.force).reshape(len(position), -1)
        if not z:
            N, V, M, *hoop = forces.T
            if not hoop:
                return position, x, y, N, V, M
            return position, x, y, N, V, M, None, None, None, *hoop

        # In space: normal force and torque along the tangent, shear and moment across it
        t = self._elements.tangents().reshape(-1, 3)
        force = forces[:, :3]
        moment = forces[:, 3:]
        N = np.einsum("nc,nc->n", force, t)
        T = np.einsum("nc,nc->n", moment, t)
        V = force - N[:, None] * t
        M = moment - T[:, None] * t
        return position, x, y, N, V, M, z[0], T, t

    def _line_points(self, x: ndarray, state: BeamState) -> tuple[ndarray, dict[str, ndarray]]:
        values = {}
        # Section forces at the ends, and their means at the middles.
        for key, forces in zip("NVM", self._lines(state)[3:6], strict=True):
            ends = forces.reshape(len(self.cells), 2, -1)
            middle = ends.mean(axis=1, keepdims=True)
            nodes = np.concatenate((ends, middle), axis=1)
            values[key] = nodes.reshape(-1, *forces.shape[1:])
        moves = self._rows[:, : 3 * self.dim]
        values["displacement"] = self._own(x)[moves].reshape(-1, self.dim)
        return self._elements.points.reshape(-1, self.dim), values

    def line_load(self, force: ArrayLike | Callable[[ndarray], ArrayLike]) -> ndarray:
        """Return the load vector of a force per length, (dim,), on all elements of a model's beam.

        It may be a function of coordinates (dim, n) that returns (dim, n). On a shell it is a force
        per area.
        """
        points, lengths, shares = self._elements.gauss()
        if callable(force):
            values = finite(force(points.T), "force").T
        else:
            values = vector(force, self.dim, "force")
        of_elements = values * lengths[:, None]
        return self._distributed(shares[:, :, None] * of_elements[:, None])


def _elements_of(
    corners: ndarray,
    shell: bool,
    nu: float,
    spacing: float | None,
    Mp: float,
    thickness: float,
) -> BeamElements:
    """Return elements in the plane, of a shell or in space, and refuse values they have not."""
    # Only shells have nu, and rows and hinges are in the plane.
    of_row_or_hinged = spacing is not None or bool(np.isfinite(Mp))
    wrong = nu != 0.0
    if shell:
        wrong = of_row_or_hinged or not -1.0 < nu <= 0.5
    if wrong:
        raise ValueError(
            f"nu={nu!r} is for a shell of revolution, -1 < nu <= 0.5; it has no spacing and no Mp"
        )
    # Choose the elements by dimension and symmetry.
    if corners.shape[2] == 3:
        if shell or of_row_or_hinged or thickness:
            raise ValueError("a beam in space has no spacing, Mp or thickness, and is no shell")
        return SpaceElements.of(corners)
    if shell:
        return ShellElements.about_axis(corners, nu)
    return BeamElements.of(corners)


def _check_kinematics(kinematics: Kinematics, coordinates: str) -> None:
    """Refuse finite kinematics of shells and of beams in space."""
    if kinematics == "finite" and coordinates != "plane":
        raise ValueError(
            "beams with kinematics='finite' lie in the plane: shells of revolution and beams in "
            "space are of small rotations"
        )
