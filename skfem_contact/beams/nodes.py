"""Nodes of beams and reinforcement: their dofs for supports and bars, loads on them, and contact of
their sides.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy import ndarray
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree
from skfem import CellBasis

from ..checks import finite, format_point, is_number, vector
from ..contact import ContactPair
from ..contact.laws import InterfaceLaw
from ..forms.base import Form
from ..layout import Field, FieldDofs
from ..surfaces.surface import Surface
from .lines import touching

#: Coordinates are those of a node if they are nearer than this share of the beam.
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


def stiffest(forms: Mapping[str, Form]) -> ndarray | None:
    """Return the elasticity, (4, 4), of the stiffest material of the forms; None without one."""
    found = [
        m.elasticity(4).reshape(-1, 4, 4)
        for form in forms.values()
        for m in form.materials.values()
    ]
    return max(
        (C[C[:, -1, -1].argmax()] for C in found), key=lambda C: float(C[-1, -1]), default=None
    )


class BeamNodes(Form):
    """Form of nodes with displacements, its own or those of the ground, and with or without
    rotations.
    """

    _same = ("points", "cells", "_rows", "coordinates", "thickness")
    points: ndarray
    cells: ndarray
    spacing: float
    thickness: float
    _shared: ndarray | None
    _displacement: Field
    _rotation: Field
    _EA: float
    _rows: ndarray
    _dofs: ndarray | None = None

    @property
    def _names(self) -> tuple[DofName, ...]:
        """Names of the dofs of a node."""
        if self.points.shape[1] == 2:
            return "u^1", "u^2", "theta"
        return "u^1", "u^2", "u^3", "theta^1", "theta^2", "theta^3"

    def node(self, at: ArrayLike) -> int:
        """Return the number of the node at coordinates (dim,)."""
        point = vector(at, self.points.shape[1], "at")
        distance, node = cKDTree(self.points).query(point)
        if distance > AT * np.ptp(self.points, axis=0).max():
            raise ValueError(
                f"the beam has no node at {format_point(point)}; the nearest one is at "
                f"{format_point(self.points[node])}"
            )
        return int(node)

    def dofs(self, at: ArrayLike, names: Sequence[DofName] | None = None) -> list[Any]:
        """Return the dofs of the node at coordinates (dim,), by default all, for the supports of a
        model.

        In space the rotations are ``"theta^1"``, ``"theta^2"`` and ``"theta^3"``. At a hinge
        ``"theta"`` is that of the first element that meets there.
        """
        node, dim = self.node(at), self.points.shape[1]
        found: list[Any] = []
        for name in self._names if names is None else names:
            if name not in self._names:
                raise ValueError(
                    f"a node of the beam has the dofs {', '.join(self._names)}, not {name!r}"
                )
            k, turns = self._names.index(name), len(self._names) - dim
            if k >= dim:
                found.append(FieldDofs(self._rotation, np.array([turns * node + k - dim])))
            else:
                found.append(
                    FieldDofs(self._displacement, np.array([dim * node + k]))
                    if self._shared is None
                    else self._shared[node, [k]]
                )
        return found

    def at(self, points: ArrayLike) -> ndarray | FieldDofs:
        """Return nodes at coordinates (n, 2) or (2,) as ends of bars: ``Bar(basis, wall.at((0.,
        -1.5)), ...)``.

        Examples
        --------
        >>> import skfem_contact as sc
        >>> wall = sc.Beam(None, [[0., 0.], [0., -4.]], EI=1e4, EA=1e6)
        >>> sc.Bar(None, wall.at((0., 0.)), (5., -5.), EA=1e5, fixed_end=True, spacing=2.)
        <Bar 1 bars, EA/L 1.414e+04 to 1.414e+04>
        """
        nodes = np.array([self.node(point) for point in np.atleast_2d(finite(points, "points"))])
        if self._shared is not None:
            return self.points[nodes]
        dim = self.points.shape[1]
        return FieldDofs(self._displacement, dim * nodes[:, None] + np.arange(dim))

    def numbers(self, at: ArrayLike) -> ndarray:
        """Return the numbers of all dofs of the node at coordinates (dim,), displacements first, of
        a model's beam.
        """
        node, dim = self.node(at), self.points.shape[1]
        turns = len(self._names) - dim
        return self._of_model()[
            [
                *(dim * node + np.arange(dim)),
                *(dim * len(self.points) + turns * node + np.arange(turns)),
            ]
        ]

    def load(self, force: ArrayLike, at: ArrayLike, moment: ArrayLike = 0.0) -> ndarray:
        """Return the load vector of a force and a moment, anticlockwise or (3,), at a node, of a
        model's beam.
        """
        load, dim = np.zeros(self._of_model().max() + 1), self.points.shape[1]
        turn = np.broadcast_to(finite(moment, "moment"), (len(self._names) - dim,))
        load[self.numbers(at)] = [*vector(force, dim, "force"), *turn]
        return load

    def _distributed(self, forces: ndarray) -> ndarray:
        """Return the load vector of forces (n, 3, dim) on the nodes of all elements in turn."""
        load, rows = np.zeros(self._of_model().max() + 1), self._rows[:, : forces[0].size]
        np.add.at(
            load,
            self._of_model()[np.tile(rows, (len(forces) // len(rows), 1))],
            forces.reshape(len(forces), -1),
        )
        return load

    def _of_model(self) -> ndarray:
        if self._dofs is None:
            raise ValueError(
                "the dofs of the beam are not numbered yet: take it from the model, "
                'model.forms["beam"]'
            )
        return self._dofs

    def contact(
        self,
        basis: CellBasis,
        law: InterfaceLaw,
        boundaries: str | Sequence[str] | None = None,
        **options: Any,
    ) -> dict[str, ContactPair]:
        """Return contact pairs of the sides, half a thickness off the axis, by the names of the
        boundaries there.

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
            A bonded beam; a thick beam with hinges; boundaries that do not lie on a side, that
            share facets, or none.
        """
        if self.coordinates == "space":
            raise ValueError("contact of a beam is in the plane")
        if self._shared is not None:
            raise ValueError("a bonded beam has no contact: give it nodes of its own, bonded=False")
        if self.thickness and self._rotation.n > len(self.points):
            raise ValueError("contact of a beam with hinges is on its axis: thickness=0")
        found = touching(basis.mesh, boundaries, self.points[self.cells], 0.5 * self.thickness)
        options = {"quadrature": 2, **options}
        return {
            name: ContactPair(basis, name, self._side(side), law, **options)
            for name, side in found.items()
        }

    def _side(self, sign: int) -> Surface:
        """Return the left side, 1, or the right side, -1."""
        n = len(self.points)
        turned = (self._rotation, np.arange(n)) if "theta" in self._names else None
        return Surface.from_cells(
            self.points,
            (self._displacement, np.arange(2 * n).reshape(n, 2)),
            self.cells if sign > 0 else self.cells[:, [1, 0, 2]],
            f"{'left' if sign > 0 else 'right'} side of a beam",
            rotations=turned,
            thickness=self.thickness,
        )
