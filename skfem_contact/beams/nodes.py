"""Nodes of beams and reinforcement: their dofs, loads on them, and contact of their sides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
import scipy
from numpy import ndarray
from numpy.typing import ArrayLike
from skfem import CellBasis

from ..checks import finite, format_point, is_number, vector
from ..contact import ContactPair
from ..contact.laws import InterfaceLaw
from ..forms.base import Form, Forms, Kinematics
from ..forms.roles import Body, Couples, Loaded, Staged, having, with_force_kept
from ..layout import Field, FieldDofs
from ..surfaces.surface import Surface
from ..units import Extent
from .lines import touching

#: Largest distance of coordinates from the node that they name, as a share of the beam.
AT = 1e-6
#: Names of the dofs of a node.
DofName = Literal["u^1", "u^2", "u^3", "theta", "theta^1", "theta^2", "theta^3"]


def check_values(
    Mp: float, Np: float, unit_weight: float, thickness: float, **positive: float
) -> None:
    """Refuse stiffnesses and strengths that are not positive."""
    for name, value in {**positive, "Mp": Mp, "Np": Np}.items():
        if not (is_number(value, 0.0, np.inf) or (name in ("Mp", "Np") and value == np.inf)):
            raise ValueError(f"{name} of a beam must be positive, not {value!r}")
    if np.isfinite(Np) and not np.isfinite(Mp):
        raise ValueError("Np of a beam needs Mp: its hinges flow by moment and normal force")
    if min(unit_weight, thickness) < 0.0:
        raise ValueError(
            f"unit_weight and thickness must not be negative, not {unit_weight!r} and {thickness!r}"
        )


def stiffest(forms: Forms) -> ndarray | None:
    """Return the elasticity, (4, 4), of the stiffest material of the forms; None without one."""
    result = None
    for body in having(forms, Body).values():
        for material in body.materials.values():
            C = material.elasticity(4).reshape(-1, 4, 4)  # (points, 4, 4)
            stiff = C[C[:, -1, -1].argmax()]
            if result is None or stiff[-1, -1] > result[-1, -1]:
                result = stiff
    return result


class Nodes(Form, Couples, Loaded, Staged):
    """Form of nodes with displacements, with or without rotations.

    Attributes
    ----------
    points : ndarray, shape (n, dim)
        Coordinates of the nodes.
    shared : ndarray, shape (n, dim)
        Displacements of the basis that the nodes have; None for nodes of their own.
    displacement, rotation
        Fields of nodes of their own, and of the rotations.
    """

    #: The structure in messages.
    kind = "beam"
    kinematics: Kinematics = "small"

    points: ndarray
    shared: ndarray | None
    displacement: Field
    rotation: Field
    _dofs: ndarray | None = None

    @property
    def dim(self) -> int:
        """Number of coordinates."""
        return int(self.points.shape[1])

    @property
    def _names(self) -> tuple[DofName, ...]:
        """Names of the dofs of a node."""
        if self.dim == 2:
            return "u^1", "u^2", "theta"
        return "u^1", "u^2", "u^3", "theta^1", "theta^2", "theta^3"

    @property
    def turns(self) -> int:
        """Number of rotations of a node."""
        return len(self._names) - self.dim

    def node(self, at: ArrayLike) -> int:
        """Return the number of the node at coordinates (dim,)."""
        point = vector(at, self.dim, "at")
        distance, node = scipy.spatial.cKDTree(self.points).query(point)
        if distance > AT * np.ptp(self.points, axis=0).max():
            raise ValueError(
                f"the {self.kind} has no node at {format_point(point)}; the nearest one is at "
                f"{format_point(self.points[node])}"
            )
        return int(node)

    def dofs(self, at: ArrayLike, names: Sequence[DofName] | None = None) -> list[Any]:
        """Return dofs of the node at coordinates (dim,), by default all, for supports of a model.

        In space the rotations are ``"theta^1"``, ``"theta^2"`` and ``"theta^3"``. At a hinge
        ``"theta"`` is the rotation of the first element at it.
        """
        node = self.node(at)
        known = self._names
        dofs: list[Any] = []
        for name in known if names is None else names:
            if name not in known:
                raise ValueError(
                    f"a node of the {self.kind} has the dofs {', '.join(known)}, not {name!r}"
                )
            # Count the dofs of rotations, of nodes of its own, or of shared nodes.
            k = known.index(name)
            if k >= self.dim:
                turn = self.turns * node + k - self.dim
                dofs.append(FieldDofs(self.rotation, np.array([turn])))
            elif self.shared is None:
                dofs.append(FieldDofs(self.displacement, np.array([self.dim * node + k])))
            else:
                dofs.append(self.shared[node, [k]])
        return dofs

    def at(self, points: ArrayLike) -> ndarray | FieldDofs:
        """Return nodes at coordinates (n, 2) or (2,) as ends of :class:`~skfem_contact.Bar`.

        Examples
        --------
        >>> import skfem_contact as sc
        >>> wall = sc.Beam(None, [[0., 0.], [0., -4.]], EI=1e4, EA=1e6)
        >>> sc.Bar(None, wall.at((0., 0.)), (5., -5.), EA=1e5, fixed_end=True, spacing=2.)
        <Bar 1 bars, EA/L 1.414e+04 to 1.414e+04>
        """
        nodes = np.array([self.node(point) for point in np.atleast_2d(finite(points, "points"))])
        if self.shared is not None:
            return self.points[nodes]
        return FieldDofs(self.displacement, self.dim * nodes[:, None] + np.arange(self.dim))

    def numbers(self, at: ArrayLike) -> ndarray:
        """Return all dofs of the node at coordinates (dim,) in a model, rotations last."""
        node = self.node(at)
        moves = self.dim * node + np.arange(self.dim)
        turns = self.dim * len(self.points) + self.turns * node + np.arange(self.turns)
        return self._of_model()[np.append(moves, turns)]

    def load(self, force: ArrayLike, at: ArrayLike, moment: ArrayLike = 0.0) -> ndarray:
        """Return the load vector of a force and a moment at a node in a model.

        The moment is anticlockwise, in space a vector (3,). With `spacing` both are those of one
        member over it, and on a shell of revolution per radian: a ring load times its radius.
        """
        load = np.zeros(self._of_model().max() + 1)
        turn = finite(moment, "moment")
        if turn.ndim:
            turn = vector(turn, self.turns, "moment")
        turns = np.broadcast_to(turn, (self.turns,))
        load[self.numbers(at)] = [*vector(force, self.dim, "force"), *turns]
        return load

    def _of_model(self) -> ndarray:
        if self._dofs is None:
            raise ValueError(
                f"the dofs of the {self.kind} are not numbered yet: take it from the model, "
                f'model.forms["{self.kind}"]'
            )
        return self._dofs

    def _numbers(self, numbers: Mapping[Field, ndarray]) -> ndarray:
        """Return the dofs of the nodes: displacements, then rotations."""
        turns = numbers[self.rotation]
        if self.shared is not None:
            return np.append(self.shared, turns)
        return np.append(numbers[self.displacement], turns)

    def _own(self, x: ndarray) -> ndarray:
        """Return the dofs of the structure."""
        if self._dofs is None:
            return x
        return x[self._dofs]


class BeamNodes(Nodes):
    """Nodes of lines: beams and reinforcement.

    Attributes
    ----------
    cells : ndarray, shape (m, 3)
        Nodes of the elements: start, end and middle.
    spacing
        Distance of the members of a row; 1 without rows.
    thickness
        Distance of the two sides.
    parameters
        Stiffnesses and strengths by their names.
    """

    _same = ("points", "cells", "_rows", "coordinates", "thickness")
    cells: ndarray
    spacing: float
    thickness: float
    parameters: Mapping[str, Any]
    _rows: ndarray

    @property
    def strains(self) -> tuple[ndarray, ndarray]:
        """Strains of numbered elements by their dofs, (m, q, n), and these, (m, n)."""
        raise NotImplementedError

    @property
    def extent(self) -> Extent:  # type: ignore[override]
        """Extent of the stiffnesses: in the plane rows without a spacing have no single members."""
        if self.dim == 3 or self.parameters["spacing"] is not None:
            return "member"
        return "length"

    def inherits(self, old: Any, state: Any) -> Any:
        """Return the state of an old form; a new stiffness alone changes no force."""
        return with_force_kept(state, old.stretched_by(state), self.stretched_by(state))

    def stretched_by(self, state: Any) -> ndarray:
        """Return the deformation by the force of a state."""
        raise NotImplementedError

    def rotations(self, at: ArrayLike) -> tuple[list[int], list[int]]:
        """Return the rotations, in their field, of elements that end at a node, and that begin.

        These are the same but at hinges.
        """
        node = self.node(at)
        turn = self._rows[:, 3 * self.dim :: self.turns] - self.dim * len(self.points)
        ends = np.unique(turn[self.cells[:, 1] == node, 1])
        begins = np.unique(turn[self.cells[:, 0] == node, 0])
        return ends.tolist(), begins.tolist()

    def _distributed(self, forces: ndarray) -> ndarray:
        """Return the load vector of forces (n, 3, dim) on the nodes of all elements in turn."""
        dofs = self._of_model()
        load = np.zeros(dofs.max() + 1)
        rows = self._rows[:, : forces[0].size]
        repeated = np.tile(rows, (len(forces) // len(rows), 1))
        np.add.at(load, dofs[repeated], forces.reshape(len(forces), -1))
        return load

    def contact(
        self,
        basis: CellBasis,
        law: InterfaceLaw,
        boundaries: str | Sequence[str] | None = None,
        **options: Any,
    ) -> dict[str, ContactPair]:
        """Return contact pairs of the sides, half a thickness off the axis, by boundary.

        Parameters
        ----------
        basis, law
            Basis and law of :class:`~skfem_contact.ContactPair`.
        boundaries
            Boundaries that touch the beam, each one side; by default all that lie on a side.
        options
            Further arguments of the pairs; ``quadrature=2`` unless it is given.

        Raises
        ------
        ValueError
            A bonded beam; a thick beam with hinges; boundaries that do not lie on a side, that
            share facets, or none.
        """
        if self.coordinates == "space":
            raise ValueError("contact of a beam is in the plane")
        if self.shared is not None:
            raise ValueError("a bonded beam has no contact: give it nodes of its own, bonded=False")
        if self.thickness and self.rotation.n > len(self.points):
            raise ValueError("contact of a beam with hinges is on its axis: thickness=0")
        # Each boundary touches the side that faces it.
        sides = touching(basis.mesh, boundaries, self.points[self.cells], 0.5 * self.thickness)
        options = {"quadrature": 2, **options}
        return {
            name: ContactPair(basis, name, self._side(side), law, **options)
            for name, side in sides.items()
        }

    def _side(self, sign: int) -> Surface:
        """Return the left side, 1, or the right side, -1."""
        nodes = np.arange(len(self.points))
        cells = self.cells
        name = "left side of a beam"
        if sign < 0:
            cells = cells[:, [1, 0, 2]]
            name = "right side of a beam"
        return Surface.from_cells(
            self.points,
            (self.displacement, np.arange(2 * len(nodes)).reshape(-1, 2)),
            cells=cells,
            name=name,
            rotations=(self.rotation, nodes) if self.turns else None,
            thickness=self.thickness,
        )
